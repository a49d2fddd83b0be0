/*
 * Cutting a patch straight across. See straight_cut.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "build/straight_cut.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "base/sort.h"

/* Patches of fewer triangles than this are not worth buckets. */
enum { BUCKETS = 256 };

/* A triangle and where it is, to be compared as one number. */
static uint64_t key_of(float along, uint32_t t)
{
    return (uint64_t)sc_sort_key(along) << 32 | t;
}

/* Moves what is lower than the key in the middle before it, and returns where that is then. Without
   branches, which no processor could foresee. */
static uint32_t split_keys(uint64_t *keys, uint32_t count)
{
    uint64_t pivot = keys[count / 2];
    uint32_t lower = 0, i;
    keys[count / 2] = keys[count - 1];
    for (i = 0; i + 1 < count; i++) {
        uint64_t key = keys[i];
        keys[i] = keys[lower];
        keys[lower] = key;
        lower += key < pivot;
    }
    keys[count - 1] = keys[lower];
    keys[lower] = pivot;
    return lower;
}

/* Moves the lowest `left` of count keys, no two of which are the same, to the front. */
static void select_lowest(uint64_t *keys, uint32_t count, uint32_t left)
{
    while (count > 1) {
        uint32_t lower = split_keys(keys, count);
        if (left - lower < 2) return; /* up to the pivot, or with it */
        if (left < lower) {
            count = lower;
        } else {
            keys += lower + 1;
            count -= lower + 1;
            left -= lower + 1;
        }
    }
}

void sc_straight_cut_run(const sc_facets *facets, const uint32_t *triangles, uint32_t count,
                         uint32_t left_target, float *along, uint64_t *keys, uint32_t *label,
                         uint32_t low)
{
    float direction[3], least = HUGE_VALF, most = -HUGE_VALF, scale;
    uint32_t size[BUCKETS + 1], i, middle = 0, before = 0, candidates = 0;
    sc_direction_find(facets, triangles, count, 1, direction);
    for (i = 0; i < count; i++) {
        float at = sc_direction_along(facets->centers + 3 * (uint64_t)triangles[i], direction);
        along[i] = at;
        if (at < least) least = at;
        if (at > most) most = at;
    }
    scale = count < BUCKETS ? 0 : BUCKETS / (most - least);
    if (!(scale <= FLT_MAX)) scale = 0; /* all in one bucket */
    if (scale > 0) {
        memset(size, 0, sizeof size);
        for (i = 0; i < count; i++) size[(uint32_t)((along[i] - least) * scale)]++;
        while (before + size[middle] < left_target) before += size[middle++];
    }
    for (i = 0; i < count; i++) {
        uint32_t bucket = (uint32_t)((along[i] - least) * scale);
        label[triangles[i]] = low + (bucket > middle);
        if (bucket != middle) continue;
        keys[candidates++] = key_of(along[i], triangles[i]);
    }
    select_lowest(keys, candidates, left_target - before);
    for (i = left_target - before; i < candidates; i++) label[(uint32_t)keys[i]] = low + 1;
}
