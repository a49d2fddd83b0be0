/*
 * Which patches of a level are adjacent. See neighbors.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "build/neighbors.h"

#include <string.h>

#include "base/assume.h"
#include "base/sort.h"

/*
 * The points at which several patches meet, as records of a point, a number n and n different
 * patches of the level at hand in ascending order.
 */
typedef struct meetings {
    uint32_t *words;
    uint64_t count;
} meetings;

/* Lists of up to this many numbers are sorted in place. */
enum { SHORT_LIST = 24 };

/* Sorts a list and drops repeats; returns what is left. keys: room for as many, if it is not
   short. */
static uint32_t sort_unique(uint32_t *list, uint32_t count, sc_pair *keys)
{
    uint32_t i, j, n = 0;
    if (count <= SHORT_LIST) {
        for (i = 0; i < count; i++) {
            uint32_t item = list[i], k;
            for (j = n; j > 0 && list[j - 1] > item; j--) continue;
            if (j > 0 && list[j - 1] == item) continue;
            for (k = n++; k > j; k--) list[k] = list[k - 1];
            list[j] = item;
        }
        return n;
    }
    for (i = 0; i < count; i++) {
        keys[i].a = list[i];
        keys[i].b = 0;
    }
    sc_sort_pairs(keys, count);
    for (i = 0; i < count; i++)
        if (n == 0 || list[n - 1] != keys[i].a) list[n++] = keys[i].a;
    return n;
}

static sc_status meet_at_leaves(const sc_points *points, const sc_adjacency *adjacency,
                                const uint32_t *order, const sc_xbvh *xbvh, sc_pair *keys,
                                sc_scratch *scratch, meetings *met)
{
    uint32_t leaf, i, p, *patch_of, base = xbvh->level_first[xbvh->level_count - 1];
    patch_of = (uint32_t *)sc_scratch_take(scratch, points->triangle_count, sizeof *patch_of);
    met->words = (uint32_t *)sc_scratch_take(
        scratch, 3 * (uint64_t)points->triangle_count + 2 * (uint64_t)points->point_count,
        sizeof *met->words);
    met->count = 0;
    if (!patch_of || !met->words) return SC_ERROR_MEMORY;
    for (leaf = 0; leaf < xbvh->leaf_count; leaf++)
        for (i = xbvh->leaf_first[leaf]; i < xbvh->leaf_first[leaf + 1]; i++)
            patch_of[order[i]] = base + leaf;
    for (p = 0; p < points->point_count; p++) {
        uint32_t *record = met->words + met->count, n = 0;
        for (i = adjacency->corner_first[p]; i < adjacency->corner_first[p + 1]; i++)
            record[2 + n++] = patch_of[adjacency->corners[i] / 3];
        n = sort_unique(record + 2, n, keys);
        if (n < 2) continue;
        record[0] = p;
        record[1] = n;
        met->count += 2 + n;
    }
    sc_scratch_give(scratch, patch_of);
    return SC_OK;
}

/* Replaces patches by their parents, which are in ascending order as well. */
static void ascend(meetings *met, const uint32_t *parent, uint32_t level_first)
{
    uint64_t from = 0, to = 0;
    while (from < met->count) {
        uint32_t p = met->words[from], count = met->words[from + 1], i, n = 0, last = SC_NONE;
        uint32_t *record = met->words + to; /* never ahead of what is read */
        for (i = 0; i < count; i++) {
            uint32_t patch = parent[met->words[from + 2 + i] - level_first];
            n += patch != last;
            record[1 + n] = last = patch;
        }
        from += 2 + count;
        record[0] = p;
        record[1] = n;
        to += n < 2 ? 0 : 2 + n;
    }
    met->count = to;
}

static sc_status reserve_entries(sc_neighbors *neighbors, sc_scratch *scratch, uint64_t more)
{
    uint64_t capacity = neighbors->entry_count + more;
    sc_pair *entries;
    if (neighbors->entries && capacity <= neighbors->capacity) return SC_OK;
    if (SC_HARDLY(capacity > 0xfffffff0u)) return SC_ERROR_COUNT; /* 32 gigabytes */
    if (capacity < 2 * neighbors->capacity) capacity = 2 * neighbors->capacity;
    entries = (sc_pair *)sc_scratch_take(scratch, capacity, sizeof *entries);
    if (!entries) return SC_ERROR_MEMORY;
    if (neighbors->entry_count)
        memcpy(entries, neighbors->entries, (size_t)neighbors->entry_count * sizeof *entries);
    sc_scratch_give(scratch, neighbors->entries);
    neighbors->entries = entries;
    neighbors->capacity = capacity;
    return SC_OK;
}

/* Lists the neighbors of all patches of a level. place: a number for each patch, which may be any:
   the place of a neighbor among those of the patch at hand, if that neighbor is there. */
static sc_status list_level(const meetings *met, uint32_t begin, uint32_t end, uint32_t *place,
                            sc_scratch *scratch, sc_neighbors *neighbors)
{
    uint32_t *count = neighbors->count, *first = neighbors->first, p;
    uint64_t at, total = 0, i, j;
    sc_status status;
    sc_pair *entries;
    for (p = begin; p < end; p++) count[p] = 0;
    for (at = 0; at < met->count; at += 2 + met->words[at + 1]) {
        const uint32_t *record = met->words + at;
        if (record[1] > SC_NEIGHBORS_HUB) continue;
        for (i = 0; i + 1 < record[1]; i++) count[record[2 + i]] += record[1] - 1 - (uint32_t)i;
    }
    for (p = begin; p < end; p++) total += count[p];
    status = reserve_entries(neighbors, scratch, total);
    if (status) return status;
    entries = neighbors->entries;
    total = neighbors->entry_count;
    for (p = begin; p < end; p++) {
        first[p] = (uint32_t)total;
        total += count[p];
        count[p] = 0;
    }
    for (at = 0; at < met->count; at += 2 + met->words[at + 1]) {
        const uint32_t *record = met->words + at;
        if (record[1] > SC_NEIGHBORS_HUB) continue;
        for (i = 0; i < record[1]; i++) {
            p = record[2 + i];
            for (j = i + 1; j < record[1]; j++) {
                entries[first[p] + count[p]].a = record[2 + j];
                entries[first[p] + count[p]++].b = record[0];
            }
        }
    }
    total = neighbors->entry_count;
    for (p = begin; p < end; p++) { /* one entry for equal neighbors */
        uint32_t n = 0, k;
        sc_pair *list = entries + first[p], *kept = entries + total;
        for (k = 0; k < count[p]; k++) {
            uint32_t known = place[list[k].a];
            if (known < n && kept[known].a == list[k].a) {
                kept[known].b = SC_NONE;
            } else {
                place[list[k].a] = n;
                kept[n++] = list[k];
            }
        }
        sc_sort_pairs(kept, n);
        first[p] = (uint32_t)total;
        count[p] = n;
        total += n;
    }
    neighbors->entry_count = total;
    return SC_OK;
}

/* Patches that share a point and a hub share more than one point. */
static void unmark_at_hubs(const meetings *met, uint32_t *hub_of, sc_neighbors *neighbors)
{
    uint64_t at;
    uint32_t i, k;
    for (at = 0; at < met->count; at += 2 + met->words[at + 1]) {
        const uint32_t *record = met->words + at;
        if (record[1] <= SC_NEIGHBORS_HUB) continue;
        for (i = 0; i < record[1]; i++) hub_of[record[2 + i]] = record[0];
        for (i = 0; i < record[1]; i++) {
            sc_pair *list = neighbors->entries + neighbors->first[record[2 + i]];
            for (k = 0; k < neighbors->count[record[2 + i]]; k++)
                if (hub_of[list[k].a] == record[0]) list[k].b = SC_NONE;
        }
    }
}

sc_status sc_neighbors_build(const sc_points *points, const sc_adjacency *adjacency,
                             const uint32_t *order, const sc_xbvh *xbvh, sc_scratch *scratch,
                             sc_neighbors *neighbors)
{
    uint32_t level, p, longest = 0, *parent, *hub_of, *place;
    meetings met;
    sc_pair *keys;
    sc_status status;
    memset(neighbors, 0, sizeof *neighbors);
    for (p = 0; p < points->point_count; p++)
        if (adjacency->corner_first[p + 1] - adjacency->corner_first[p] > longest)
            longest = adjacency->corner_first[p + 1] - adjacency->corner_first[p];
    keys = (sc_pair *)sc_scratch_take(scratch, longest, sizeof *keys);
    parent = (uint32_t *)sc_scratch_take(scratch, xbvh->leaf_count, sizeof *parent);
    neighbors->first = (uint32_t *)sc_scratch_take(scratch, xbvh->patch_end, sizeof(uint32_t));
    neighbors->count =
        (uint32_t *)sc_scratch_take_filled(scratch, xbvh->patch_end, sizeof(uint32_t), 0);
    hub_of = (uint32_t *)sc_scratch_take_filled(scratch, xbvh->patch_end, sizeof *hub_of, 0xff);
    place = (uint32_t *)sc_scratch_take_filled(scratch, xbvh->patch_end, sizeof *place, 0xff);
    if (!keys || !parent || !hub_of || !place || !neighbors->first || !neighbors->count)
        return SC_ERROR_MEMORY;
    status = meet_at_leaves(points, adjacency, order, xbvh, keys, scratch, &met);
    if (status) return status;
    for (level = xbvh->level_count - 1;; level--) {
        uint32_t begin = xbvh->level_first[level], end = xbvh->level_first[level + 1] - 1;
        status = list_level(&met, begin, end, place, scratch, neighbors);
        if (status) return status;
        unmark_at_hubs(&met, hub_of, neighbors);
        if (level == 0) break;
        for (p = xbvh->level_first[level - 1]; p + 1 < begin; p++) {
            uint32_t c;
            for (c = xbvh->child[p]; c < xbvh->child[p + 1]; c++) parent[c - begin] = p;
        }
        ascend(&met, parent, begin);
    }
    sc_scratch_give(scratch, met.words);
    sc_scratch_give(scratch, place);
    sc_scratch_give(scratch, hub_of);
    sc_scratch_give(scratch, parent);
    sc_scratch_give(scratch, keys);
    return SC_OK;
}

void sc_neighbors_free(sc_neighbors *neighbors, sc_scratch *scratch)
{
    sc_scratch_give(scratch, neighbors->first);
    sc_scratch_give(scratch, neighbors->count);
    sc_scratch_give(scratch, neighbors->entries);
}

const sc_pair *sc_neighbors_find(const sc_neighbors *neighbors, uint32_t a, uint32_t b)
{
    const sc_pair *list = neighbors->entries + neighbors->first[a];
    uint32_t low = 0, high = neighbors->count[a];
    while (low < high) {
        uint32_t middle = (low + high) / 2;
        if (list[middle].a < b)
            low = middle + 1;
        else
            high = middle;
    }
    return low < neighbors->count[a] && list[low].a == b ? &list[low] : NULL;
}
