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
    /* Box recursion on two patches of a level, and on one. */
    void (*patch_pair)(sc_worker *w, uint32_t patch_a, uint32_t patch_b);
    void (*patch_itself)(sc_worker *w, uint32_t patch);
    /* The vertices, edges and triangles of two leaf clusters, and of one. */
    void (*leaf_pair)(sc_worker *w, uint32_t leaf_a, uint32_t leaf_b);
    void (*leaf_itself)(sc_worker *w, uint32_t leaf);
    /* Bits of candidates that certainly do not collide; split: points before are one, the others
       the other. */
    unsigned (*stay_apart)(const sc_motion *motion, const sc_candidate_points *points, int split);
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
