/*
 * The inner loops over a pose that are compiled for several instruction sets.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef SC_POSE_KERNELS_H
#define SC_POSE_KERNELS_H

#include "pose/frame.h"

/*
 * Where nothing can be culled, as in heaps of rods, cones are a waste: those of a group of leaf
 * clusters that follow each other are made only if one of its first few has one. Else the others
 * count as having none: nothing is culled that should not be, and a patch that holds one of those
 * few has no cone anyway.
 */
enum { SC_CONES_GROUP = 16, SC_CONES_SAMPLE = 4 };

typedef struct sc_pose_kernels {
    /* The box of positions, packed or stride bytes apart, see pose/positions.h. */
    int (*extent_of_doubles)(const double *positions, uint64_t count, double low[3],
                             double high[3]);
    int (*extent_of_floats)(const float *positions, uint64_t count, double low[3], double high[3]);
    int (*extent_of_apart_doubles)(const double *positions, uint64_t stride, uint64_t count,
                                   double low[3], double high[3]);
    int (*extent_of_apart_floats)(const float *positions, uint64_t stride, uint64_t count,
                                  double low[3], double high[3]);
    /* Fills point_at of leaf clusters first to end - 1, and their masks if cones; see pose/dnc.h.
       Groups may be cut. */
    void (*load_leaves)(const sc_model *model, sc_frame *frame, uint32_t first, uint32_t end,
                        int cones);
    /* The normal cone of one cluster's points, as in point_at, and SC_LEAF_MAX triangles given as
       in leaf_corner. */
    uint32_t (*cone)(const float *at, const uint8_t *where);
    /* Boxes of leaf clusters, then of patches of one level by those of their children; see
       pose/refit.h. */
    void (*refit_leaves)(const sc_model *model, sc_frame *frame, uint32_t first, uint32_t end);
    void (*refit_patches)(const sc_model *model, sc_frame *frame, uint32_t first, uint32_t end);
} sc_pose_kernels;

#endif
