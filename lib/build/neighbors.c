/*
 * Which patches of a level are adjacent. See neighbors.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "build/neighbors.h"

#include <string.h>

#include "base/assume.h"
#include "base/jobs.h"
#include "base/sort.h"

/*
 * The points of more triangles than sharing looks at, as records of a point, a number n and n
 * different patches of the level at hand in ascending order, where there are several.
 */
typedef struct meetings {
    uint32_t *words;
    uint64_t count;
} meetings;

/* Patches of a level and those of the next, while they are listed. */
typedef struct level_lists {
    const sc_xbvh *xbvh;
    const sc_sharing *sharing;
    sc_neighbors *neighbors;
    const uint32_t *parent; /* of patches of the next level, from its first on: of the same level */
    uint32_t begin, below;  /* the first of the level and of the next */
} level_lists;

/* So many corners are in several leaf clusters, even if all of each triangle are at one point. */
typedef char has_several_leaves[(int)SC_SHARING_CROWD >= 3 * (int)SC_LEAF_MAX ? 1 : -1];

/* Patches that parts of a loop list, at least. */
enum { PATCHES_MIN = 1024 };

/* Drops repeats from a sorted list; returns what is left. */
static uint32_t drop_repeats(uint32_t *list, uint32_t count)
{
    uint32_t i, n = 0;
    for (i = 0; i < count; i++)
        if (n == 0 || list[n - 1] != list[i]) list[n++] = list[i];
    return n;
}

/* The leaf clusters that meet at points of very many triangles. keys: room for all of one. */
static sc_status meet_at_leaves(const sc_points *points, const sc_adjacency *adjacency,
                                const uint32_t *order, const sc_xbvh *xbvh, sc_scratch *scratch,
                                meetings *met)
{
    const uint32_t *first = adjacency->corner_first;
    uint32_t leaf, i, p, longest = 0, base = xbvh->level_first[xbvh->level_count - 1], *patch_of;
    uint64_t room = 0;
    sc_pair *keys;
    met->count = 0;
    for (p = 0; p < points->point_count; p++) {
        uint32_t corners = first[p + 1] - first[p];
        if (corners <= SC_SHARING_CROWD) continue;
        room += 2 + (uint64_t)corners;
        if (corners > longest) longest = corners;
    }
    if (!room) return SC_OK;
    met->words = (uint32_t *)sc_scratch_take(scratch, room, sizeof *met->words);
    patch_of = (uint32_t *)sc_scratch_take(scratch, points->triangle_count, sizeof *patch_of);
    keys = (sc_pair *)sc_scratch_take(scratch, longest, sizeof *keys);
    if (!met->words || !patch_of || !keys) return SC_ERROR_MEMORY;
    for (leaf = 0; leaf < xbvh->leaf_count; leaf++)
        for (i = xbvh->leaf_first[leaf]; i < xbvh->leaf_first[leaf + 1]; i++)
            patch_of[order[i]] = base + leaf;
    for (p = 0; p < points->point_count; p++) {
        uint32_t *record = met->words + met->count, n = 0;
        if (first[p + 1] - first[p] <= SC_SHARING_CROWD) continue;
        for (i = first[p]; i < first[p + 1]; i++) {
            keys[n].a = patch_of[adjacency->corners[i] / 3];
            keys[n++].b = 0;
        }
        sc_sort_pairs(keys, n);
        for (i = 0; i < n; i++) record[2 + i] = keys[i].a;
        n = drop_repeats(record + 2, n); /* two at least, see has_several_leaves */
        record[0] = p;
        record[1] = n;
        met->count += 2 + n;
    }
    sc_scratch_give(scratch, keys);
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

/* Counts what a level's lists may have, and where they begin behind those that are there. */
static void count_level(const level_lists *l, uint32_t end, const meetings *met, uint64_t *total)
{
    const uint32_t *child = l->xbvh->child;
    uint32_t *count = l->neighbors->count, p;
    uint64_t at, i;
    for (p = l->begin; p < end; p++)
        if (l->parent)
            count[p] = count[child[p]] + (child[p + 1] - child[p] > 1 ? count[child[p] + 1] : 0);
        else
            count[p] = l->sharing->first[p - l->begin + 1] - l->sharing->first[p - l->begin];
    for (at = 0; at < met->count; at += 2 + met->words[at + 1]) {
        const uint32_t *record = met->words + at;
        if (record[1] > SC_NEIGHBORS_HUB) continue;
        for (i = 0; i + 1 < record[1]; i++) count[record[2 + i]] += record[1] - 1 - (uint32_t)i;
    }
    for (p = l->begin, *total = 0; p < end; p++) *total += count[p];
}

/* Lists the patches that meet at points of very many triangles. */
static void list_meetings(const meetings *met, sc_neighbors *neighbors)
{
    uint32_t *count = neighbors->count, p;
    uint64_t at, i, j;
    for (at = 0; at < met->count; at += 2 + met->words[at + 1]) {
        const uint32_t *record = met->words + at;
        if (record[1] > SC_NEIGHBORS_HUB) continue;
        for (i = 0; i < record[1]; i++) {
            p = record[2 + i];
            for (j = i + 1; j < record[1]; j++) {
                sc_pair *entry = neighbors->entries + neighbors->first[p] + count[p]++;
                entry->a = record[2 + j];
                entry->b = record[0];
            }
        }
    }
}

/* Sorts a list, and makes one entry of those with the same patch: of a point if it is the same
   for all. Returns how many are left. */
static uint32_t unite_entries(sc_pair *list, uint32_t count)
{
    uint32_t i, n = 0;
    sc_sort_pairs(list, count);
    for (i = 0; i < count; i++)
        if (n > 0 && list[n - 1].a == list[i].a) {
            if (list[n - 1].b != list[i].b) list[n - 1].b = SC_NONE;
        } else {
            list[n++] = list[i];
        }
    return n;
}

/* Adds what the level below, or leaf clusters' sharing, says of patches, to what is listed. What
   two patches share their children share. */
static void list_patches(void *context, uint32_t part, uint32_t first, uint32_t end)
{
    const level_lists *l = (const level_lists *)context;
    const uint32_t *child = l->xbvh->child;
    uint32_t *count = l->neighbors->count, p, c, i;
    (void)part;
    for (p = l->begin + first; p < l->begin + end; p++) {
        sc_pair *list = l->neighbors->entries + l->neighbors->first[p];
        uint32_t n = count[p];
        for (c = child[p]; l->parent && c < child[p + 1]; c++) {
            const sc_pair *below = l->neighbors->entries + l->neighbors->first[c];
            for (i = 0; i < count[c]; i++) {
                list[n].a = l->parent[below[i].a - l->below];
                list[n].b = below[i].b;
                n += list[n].a != p;
            }
        }
        for (i = l->parent ? 0 : l->sharing->first[p - l->begin];
             !l->parent && i < l->sharing->first[p - l->begin + 1]; i++) {
            list[n].a = l->begin + l->sharing->leaf[i];
            list[n++].b = l->sharing->touch[i];
        }
        count[p] = unite_entries(list, n);
    }
}

/* Lists the neighbors of all patches of a level. */
static sc_status list_level(level_lists *l, uint32_t end, const meetings *met, sc_scratch *scratch)
{
    sc_neighbors *neighbors = l->neighbors;
    uint64_t total;
    uint32_t p;
    sc_status status;
    count_level(l, end, met, &total);
    status = reserve_entries(neighbors, scratch, total);
    if (status) return status;
    for (p = l->begin; p < end; p++) {
        neighbors->first[p] = (uint32_t)neighbors->entry_count;
        neighbors->entry_count += neighbors->count[p];
        neighbors->count[p] = 0;
    }
    list_meetings(met, neighbors);
    sc_jobs_loop(scratch->tasks, end - l->begin, PATCHES_MIN, list_patches, l);
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
                             const uint32_t *order, const sc_xbvh *xbvh, const sc_sharing *sharing,
                             sc_scratch *scratch, sc_neighbors *neighbors)
{
    uint32_t level = xbvh->level_count - 1, p, c, *parent, *hub_of;
    meetings met = {NULL, 0};
    level_lists l;
    sc_status status;
    memset(neighbors, 0, sizeof *neighbors);
    parent = (uint32_t *)sc_scratch_take(scratch, xbvh->leaf_count, sizeof *parent);
    neighbors->first = (uint32_t *)sc_scratch_take(scratch, xbvh->patch_end, sizeof(uint32_t));
    neighbors->count =
        (uint32_t *)sc_scratch_take_filled(scratch, xbvh->patch_end, sizeof(uint32_t), 0);
    hub_of = (uint32_t *)sc_scratch_take_filled(scratch, xbvh->patch_end, sizeof *hub_of, 0xff);
    if (!parent || !hub_of || !neighbors->first || !neighbors->count) return SC_ERROR_MEMORY;
    status = meet_at_leaves(points, adjacency, order, xbvh, scratch, &met);
    if (status) return status;
    l.xbvh = xbvh;
    l.sharing = sharing;
    l.neighbors = neighbors;
    l.parent = NULL;
    l.below = 0;
    for (;; level--) {
        l.begin = xbvh->level_first[level];
        status = list_level(&l, xbvh->level_first[level + 1] - 1, &met, scratch);
        if (status) return status;
        unmark_at_hubs(&met, hub_of, neighbors);
        if (level == 0) break;
        l.below = l.begin;
        l.parent = parent;
        for (p = xbvh->level_first[level - 1]; p + 1 < l.below; p++)
            for (c = xbvh->child[p]; c < xbvh->child[p + 1]; c++) parent[c - l.below] = p;
        ascend(&met, parent, l.below);
    }
    sc_scratch_give(scratch, met.words);
    sc_scratch_give(scratch, hub_of);
    sc_scratch_give(scratch, parent);
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
