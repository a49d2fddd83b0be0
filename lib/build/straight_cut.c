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

/* Moves the lowest `left` of count keys to the front. */
static void select_lowest(uint64_t *keys, uint32_t count, uint32_t left)
{
    int64_t low = 0, high = (int64_t)count - 1;
    while (low < high) {
        uint64_t pivot = keys[low + (high - low) / 2];
        int64_t i = low, j = high;
        while (i <= j) {
            while (keys[i] < pivot) i++;
            while (pivot < keys[j]) j--;
            if (i <= j) {
                uint64_t swapped = keys[i];
                keys[i++] = keys[j];
                keys[j--] = swapped;
            }
        }
        if ((int64_t)left <= j)
            high = j;
        else if ((int64_t)left >= i)
            low = i;
        else
            return;
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
