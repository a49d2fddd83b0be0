/*
 * The inner loops of a query of a step that are compiled for several instruction sets.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef SC_STEP_KERNELS_H
#define SC_STEP_KERNELS_H

#include "step/moving_contour.h"

/* The points of sixteen candidates of a kind, as the narrow phase takes them. */
typedef struct sc_candidate_points {
    uint32_t point[4][16];
} sc_candidate_points;

typedef struct sc_step_kernels {
    /* Stages, see query/lists.h: box tests of what nodes leave; from pairs of patches to rows of
       leaf clusters; from these to pairs of leaf clusters; what slabs leave of those by themselves,
       and of pairs; which pairs of theirs do not stay apart. */
    void (*leave_pairs)(sc_worker *w, uint32_t most);
    void (*open_pairs)(sc_worker *w, uint32_t most);
    void (*list_rows)(sc_worker *w, uint32_t most);
    void (*compare_leaves)(sc_worker *w, uint32_t most);
    void (*compare_clusters)(sc_worker *w, uint32_t most);
    void (*list_faces)(sc_worker *w, uint32_t most);
    void (*list_edges)(sc_worker *w, uint32_t most);
    /* The normal cone of 1 to SC_LEAF_MAX triangles given by their corners that holds throughout
       the step. */
    uint32_t (*cone)(const sc_motion *motion, const uint32_t *corner, uint32_t count);
    /* Projects the listed points of a contour, given by all points in the unit box; sets its
       error. */
    void (*project)(sc_moving_contour *contour, const float *unit);
    /* Whether sc_moving_contour_are_clear is true of all pairs of edges. */
    int (*are_edges_clear)(sc_moving_contour *contour);
} sc_step_kernels;

#endif
