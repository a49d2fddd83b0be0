/*
 * The built-in cut: across the direction in which a patch is longest.
 *
 * SPDX-License-Identifier: MIT
 *
 * Linear: a pass for the direction, one for places along it, one to count them in buckets, and one to
 * deal out; only the bucket in which the cut falls is sorted.
 */
#ifndef SC_BUILD_STRAIGHT_CUT_H
#define SC_BUILD_STRAIGHT_CUT_H

#include "starcontour.h"

/* The direction in which the centers (three floats a triangle) of some triangles spread most. */
void sc_straight_cut_direction(const float *centers, const uint32_t *triangles, uint32_t count,
                               float direction[3]);

static inline float sc_straight_cut_along(const float *center, const float direction[3])
{
    return center[0] * direction[0] + center[1] * direction[1] + center[2] * direction[2];
}

/* label[t] becomes low for the left_target triangles that are lowest in that direction, low + 1 for
   the others. along and keys: room for count each. */
void sc_straight_cut_run(const float *centers, const uint32_t *triangles, uint32_t count,
                         uint32_t left_target, float *along, uint64_t *keys, uint32_t *label,
                         uint32_t low);

#endif
