/*
 * Axis-aligned boxes in single precision that bound double coordinates, stored as six arrays, and
 * the test of one against another.
 *
 * SPDX-License-Identifier: MIT
 *
 * A box is closed. Rounding goes outwards, so that boxes of sets that meet overlap.
 */
#ifndef SC_BASE_BOXES_H
#define SC_BASE_BOXES_H

#include <float.h>
#include <stdint.h>

#include "base/bounds.h"

/* Boxes that sixteen-wide reads may start at must be followed by this many readable ones. */
enum { SC_BOXES_PADDING = 16 };

/* Six arrays of equal length: lower bounds x, y, z, upper bounds x, y, z. */
typedef struct sc_boxes {
    float *side[6];
} sc_boxes;

/*
 * A float not above (below) d: see SC_BOUNDS_STEP. Beyond the range of float the clamp gives
 * FLT_MAX on the inner side and the step infinity on the outer.
 */
static inline float sc_boxes_clamp(double d)
{
    return d > (double)FLT_MAX ? FLT_MAX : d < (double)-FLT_MAX ? -FLT_MAX : (float)d;
}

static inline float sc_boxes_below(double d)
{
    float f = sc_boxes_clamp(d);
    return f - ((f < 0 ? -f : f) * SC_BOUNDS_STEP + FLT_MIN);
}

static inline float sc_boxes_above(double d)
{
    float f = sc_boxes_clamp(d);
    return f + ((f < 0 ? -f : f) * SC_BOUNDS_STEP + FLT_MIN);
}

static inline int sc_boxes_overlap(const sc_boxes *a, uint64_t i, const sc_boxes *b, uint64_t j)
{
    return (a->side[0][i] <= b->side[3][j]) & (b->side[0][j] <= a->side[3][i]) &
           (a->side[1][i] <= b->side[4][j]) & (b->side[1][j] <= a->side[4][i]) &
           (a->side[2][i] <= b->side[5][j]) & (b->side[2][j] <= a->side[5][i]);
}

#endif
