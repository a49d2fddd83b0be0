/*
 * Thin parts cut into slices. See slices.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "build/slices.h"

#include <string.h>

#include "base/assume.h"
#include "base/bits.h"
#include "base/sort.h"

/* Patches of fewer leaf clusters are not worth it; larger ones than this are cut in two first,
   which is cheaper than to find out that they are no thin part. */
enum { COUNT_LEAST = 4 * SC_LEAF_MAX, COUNT_MOST = 4096 };

/* Triangles of a slice at least, but for the first and the last. */
enum { SLICE_LEAST = 12 };

/* Normals look to all sides if their sum is no longer than this part of their number. Half a tube
   has 2 / pi. */
static const float ONE_SIDED = 0.25f;

static int looks_around(const sc_facets *facets, const uint32_t *triangles, uint32_t count)
{
    float sum[3] = {0, 0, 0}, most = ONE_SIDED * (float)count;
    uint32_t i, k;
    for (i = 0; i < count; i++)
        for (k = 0; k < 3; k++) sum[k] += facets->normals[3 * (uint64_t)triangles[i] + k];
    return sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2] <= most * most;
}

/* Whether the triangles in places at .. end - 1 hang together. */
static int is_one_piece(const sc_slices *slices, uint32_t at, uint32_t end)
{
    uint32_t reached = 1, next = 1, count = end - at, k;
    while (next) {
        uint32_t t = slices->keys[at + sc_bits_lowest64(next)].b;
        next &= next - 1;
        for (k = 0; k < 3; k++) {
            uint32_t u = slices->neighbor[3 * (uint64_t)t + k];
            uint32_t place = (slices->place[u] - at) % count, bit; /* if it is one of them */
            if (slices->keys[at + place].b != u) continue;
            bit = 1u << place & ~reached;
            reached |= bit;
            next |= bit;
        }
    }
    return SC_ALWAYS(count < 32) && reached == (1u << count) - 1; /* SC_LEAF_MAX at most */
}

/* Where among the ends least .. end of a slice the way to the next triangle is furthest. */
static uint32_t find_gap(const sc_slices *slices, const float direction[3], uint32_t least,
                         uint32_t end)
{
    const float *centers = slices->facets.centers;
    float furthest = -1;
    uint32_t best = end, i;
    for (i = end; i >= least; i--) {
        float way = sc_direction_along(centers + 3 * (uint64_t)slices->keys[i].b, direction) -
                    sc_direction_along(centers + 3 * (uint64_t)slices->keys[i - 1].b, direction);
        if (way <= furthest) continue;
        furthest = way;
        best = i;
    }
    return best;
}

/* Finds where slices start; returns how many, or 0 where they are no good. */
static uint32_t find_slices(const sc_slices *slices, sc_hierarchy *hierarchy, uint32_t first,
                            uint32_t count, const float direction[3])
{
    uint32_t *starts = hierarchy->starts, leaves = 0, at, end;
    for (at = 0;; at = end) {
        starts[leaves++] = first + at;
        end = sc_hierarchy_leaf_end(hierarchy, first + at, first + count) - first;
        if (end == count) break;
        if (at && end - at < SLICE_LEAST) return 0;
        end = find_gap(slices, direction, at ? at + SLICE_LEAST : 1, end);
        if (at && !is_one_piece(slices, at, end)) return 0;
    }
    starts[leaves] = first + count;
    return leaves;
}

int sc_slices_add(const sc_slices *slices, sc_hierarchy *hierarchy, uint32_t first, uint32_t count,
                  uint32_t depth, uint32_t *node)
{
    uint32_t *order = hierarchy->order + first, i, leaves;
    float direction[3];
    if (count < COUNT_LEAST || count > COUNT_MOST) return 0;
    if (!looks_around(&slices->facets, order, count)) return 0;
    sc_direction_find(&slices->facets, order, count, 0, direction);
    for (i = 0; i < count; i++) {
        const float *center = slices->facets.centers + 3 * (uint64_t)order[i];
        slices->keys[i].a = sc_sort_key(sc_direction_along(center, direction));
        slices->keys[i].b = order[i];
    }
    sc_sort_pairs(slices->keys, count);
    memcpy(slices->before, order, count * sizeof *order);
    for (i = 0; i < count; i++) {
        order[i] = slices->keys[i].b;
        slices->place[order[i]] = i;
    }
    leaves = find_slices(slices, hierarchy, first, count, direction);
    if (leaves)
        *node = sc_hierarchy_add_leaves(hierarchy, leaves, depth);
    else
        memcpy(order, slices->before, count * sizeof *order);
    return leaves > 0;
}
