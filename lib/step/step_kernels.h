/*
 * The inner loops of a query of a step that are compiled for several instruction sets.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef SC_STEP_KERNELS_H
#define SC_STEP_KERNELS_H

#include "step/moving_projection.h"

typedef struct sc_step_kernels {
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
