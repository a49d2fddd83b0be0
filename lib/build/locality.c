/*
 * Renumbering along a space-filling curve. See locality.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "build/locality.h"

#include <math.h>

#include "base/sort.h"

/* Cells along each axis: 2 to the power of this. */
enum { CELL_BITS = 10 };

/* The bits of a cell number, two zeros between each two. */
static uint32_t spread(uint32_t cell)
{
    cell = (cell | cell << 16) & 0x030000ffu;
    cell = (cell | cell << 8) & 0x0300f00fu;
    cell = (cell | cell << 4) & 0x030c30c3u;
    return (cell | cell << 2) & 0x09249249u;
}

/*
 * Turns a cell into the one in whose place along the Z-shaped curve it comes along Hilbert's. J.
 * Skilling, "Programming the Hilbert curve", 2004: from the halves of the box down, what lies in
 * the upper half of an axis is mirrored along the first axis, and what lies in the lower half has
 * that axis exchanged with the first; then the bits of each level, as a Gray code, are its place
 * among eight. Without branches, which no processor could foresee.
 */
static void turn_to_hilbert(uint32_t cell[3])
{
    uint32_t half, k, x = cell[0], flip;
    for (half = 1u << (CELL_BITS - 1); half > 1; half >>= 1) {
        uint32_t below = half - 1;
        x ^= below & (0u - ((x & half) != 0));
        for (k = 1; k < 3; k++) {
            uint32_t upper = 0u - ((cell[k] & half) != 0); /* all ones in the upper half */
            flip = (x ^ cell[k]) & below & ~upper;
            x ^= flip | (below & upper);
            cell[k] ^= flip;
        }
    }
    cell[1] ^= x;
    cell[2] ^= cell[1];
    for (flip = 0, half = 1u << (CELL_BITS - 1); half > 1; half >>= 1)
        flip ^= (half - 1) & (0u - ((cell[2] & half) != 0));
    cell[0] = cell[2] ^ flip; /* the first axis weighs most */
    cell[2] = x ^ flip;
    cell[1] ^= flip;
}

/* low and factor of each axis: a center c is in cell (c - low) * factor. Eighths of coordinates, so
   that nothing overflows. */
static void measure_box(const sc_points *points, double low[3], double *factor)
{
    double high[3], size = 0;
    uint64_t i;
    int k;
    for (k = 0; k < 3; k++) low[k] = HUGE_VAL, high[k] = -HUGE_VAL;
    for (i = 0; i < points->point_count; i++)
        for (k = 0; k < 3; k++) {
            double x = points->rest[3 * i + (uint64_t)k] / 8;
            if (x < low[k]) low[k] = x;
            if (x > high[k]) high[k] = x;
        }
    for (k = 0; k < 3; k++) {
        if (high[k] - low[k] > size) size = high[k] - low[k];
        low[k] *= 3;
    }
    *factor = (1 << CELL_BITS) / (3 * size);
}

static void list_keys(const sc_points *points, int curve, sc_pair *keys)
{
    double low[3], factor;
    uint32_t t, k;
    measure_box(points, low, &factor);
    for (t = 0; t < points->triangle_count; t++) {
        const uint32_t *corner = points->triangles + 3 * (uint64_t)t;
        const double *p = points->rest + 3 * (uint64_t)corner[0];
        const double *q = points->rest + 3 * (uint64_t)corner[1];
        const double *r = points->rest + 3 * (uint64_t)corner[2];
        uint32_t cell[3];
        for (k = 0; k < 3; k++) {
            double at = (p[k] / 8 + q[k] / 8 + r[k] / 8 - low[k]) * factor;
            cell[k] = 0; /* as well if at is NaN: a mesh as small as rounding */
            if (at > 0) cell[k] = at < (1 << CELL_BITS) - 1 ? (uint32_t)at : (1 << CELL_BITS) - 1;
        }
        if (curve == SC_LOCALITY_HILBERT) turn_to_hilbert(cell);
        keys[t].a = spread(cell[0]) | spread(cell[1]) << 1 | spread(cell[2]) << 2;
        keys[t].b = t;
    }
}

/* Puts the triangles in the order of the keys, and numbers points anew. */
static void renumber_along(sc_points *points, const sc_pair *keys, uint32_t *triangles,
                           uint32_t *number, double *rest)
{
    uint32_t t, k, v, next = 0;
    for (t = 0; t < points->triangle_count; t++)
        for (k = 0; k < 3; k++) {
            uint32_t p = points->triangles[3 * (uint64_t)keys[t].b + k];
            if (number[p] == SC_NONE) {
                const double *from = points->rest + 3 * (uint64_t)p;
                double *to = rest + 3 * (uint64_t)next;
                to[0] = from[0];
                to[1] = from[1];
                to[2] = from[2];
                number[p] = next++;
            }
            triangles[3 * (uint64_t)t + k] = number[p];
        }
    for (t = 0; t < points->triangle_count; t++) points->id[t] = keys[t].b;
    for (v = 0; v < points->vertex_count; v++)
        if (points->slot[v] < SC_SLOT_WELDED) points->slot[v] = number[points->slot[v]];
}

sc_status sc_locality_sort(sc_points *points, int curve, sc_scratch *scratch)
{
    uint32_t count = points->triangle_count, *triangles, *number;
    sc_pair *keys, *spare;
    double *rest;
    keys = (sc_pair *)sc_scratch_take(scratch, count, sizeof *keys);
    triangles = (uint32_t *)sc_scratch_take(scratch, 3 * (uint64_t)count, sizeof *triangles);
    if (!keys || !triangles) return SC_ERROR_MEMORY;
    spare = (sc_pair *)(void *)triangles; /* until the keys are sorted */
    list_keys(points, curve, keys);
    sc_sort_by_digits(keys, spare, count, 3 * CELL_BITS);
    rest = (double *)sc_scratch_take(scratch, 3 * (uint64_t)points->point_count, sizeof *rest);
    number = (uint32_t *)sc_scratch_take_filled(scratch, points->point_count, sizeof *number, 0xff);
    if (!rest || !number) return SC_ERROR_MEMORY;
    renumber_along(points, keys, triangles, number, rest);
    sc_scratch_give(scratch, keys);
    sc_scratch_give(scratch, number);
    sc_scratch_give(scratch, points->triangles);
    sc_scratch_give(scratch, points->rest);
    points->triangles = triangles;
    points->rest = rest;
    return SC_OK;
}
