/*
 * Counts triangles that are near each other; see near_pairs.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "near_pairs.h"

#include <math.h>
#include <stdlib.h>

/* Of the axis of the sweep, low and high are the first. */
typedef struct near_box {
    double low[3], high[3];
    const uint32_t *corners;
} near_box;

static int compare_lows(const void *left, const void *right)
{
    const double a = ((const near_box *)left)->low[0], b = ((const near_box *)right)->low[0];
    return a < b ? -1 : a > b;
}

/* The axis along which the corners' positions differ most. */
static size_t longest_axis(const uint32_t *triangles, size_t corner_count, const double *positions)
{
    size_t axis = 0;
    double longest = -1.0;
    for (size_t k = 0; k < 3; k++) {
        double low = HUGE_VAL, high = -HUGE_VAL;
        for (size_t i = 0; i < corner_count; i++) {
            low = fmin(low, positions[3 * (size_t)triangles[i] + k]);
            high = fmax(high, positions[3 * (size_t)triangles[i] + k]);
        }
        if (high - low <= longest) continue;
        longest = high - low;
        axis = k;
    }
    return axis;
}

static void fill_box(near_box *box, const uint32_t *corners, const double *positions, size_t axis)
{
    box->corners = corners;
    for (size_t k = 0; k < 3; k++) {
        const size_t from = (axis + k) % 3;
        const double a = positions[3 * (size_t)corners[0] + from];
        const double b = positions[3 * (size_t)corners[1] + from];
        const double c = positions[3 * (size_t)corners[2] + from];
        box->low[k] = fmin(a, fmin(b, c));
        box->high[k] = fmax(a, fmax(b, c));
    }
}

static bool share_vertex(const uint32_t *a, const uint32_t *b)
{
    for (int i = 0; i < 3; i++) {
        if (a[i] == b[0] || a[i] == b[1] || a[i] == b[2]) return true;
    }
    return false;
}

bool near_pairs_count(const uint32_t *triangles, uint32_t triangle_count, const double *positions,
                      uint64_t *count)
{
    near_box *const boxes = (near_box *)malloc(triangle_count * sizeof *boxes);
    if (!boxes) return false;
    const size_t axis = longest_axis(triangles, 3 * (size_t)triangle_count, positions);
    for (size_t t = 0; t < triangle_count; t++) {
        fill_box(&boxes[t], triangles + 3 * t, positions, axis);
    }
    qsort(boxes, triangle_count, sizeof *boxes, compare_lows);
    *count = 0;
    for (size_t i = 0; i < triangle_count; i++) {
        const near_box *const a = &boxes[i];
        for (size_t j = i + 1; j < triangle_count && boxes[j].low[0] <= a->high[0]; j++) {
            const near_box *const b = &boxes[j];
            if (a->low[1] <= b->high[1] && b->low[1] <= a->high[1] && a->low[2] <= b->high[2] &&
                b->low[2] <= a->high[2] && !share_vertex(a->corners, b->corners))
                ++*count;
        }
    }
    free(boxes);
    return true;
}
