/*
 * The built-in cut: across a direction of the patch.
 *
 * SPDX-License-Identifier: MIT
 *
 * Linear: a pass for the direction, one for places along it, one to count them in buckets, and one
 * to deal out; only the bucket in which the cut falls is sorted.
 */
#ifndef SC_BUILD_STRAIGHT_CUT_H
#define SC_BUILD_STRAIGHT_CUT_H

#include "build/direction.h"

/* label[t] becomes low for the left_target triangles whose centers are lowest in
   build/direction.h's direction, low + 1 for the others. along and keys: room for count each. */
void sc_straight_cut_run(const sc_facets *facets, const uint32_t *triangles, uint32_t count,
                         uint32_t left_target, float *along, uint64_t *keys, uint32_t *label,
                         uint32_t low);

#endif
