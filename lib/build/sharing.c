/*
 * Which triangles of leaf clusters share points. See sharing.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "build/sharing.h"

#include <string.h>

#include "base/assume.h"

/* Items of a list for the masks of all rows, which have 16 bits each. */
enum { ROW_ITEMS = SC_LEAF_MAX / 2 };

/* Room for so many neighbors a cluster with higher numbers, so that lists seldom have to grow. */
enum { NEIGHBORS = 4 };

/* The clusters that share a point with the one at hand, as they turn up. */
typedef struct found {
    uint32_t *entry; /* leaf_count: 1 + entry of a cluster in the lists, 0 if it did not turn up */
    sc_list leaf;
    sc_list rows; /* ROW_ITEMS an entry */
} found;

static uint16_t *rows_at(const found *f, uint64_t entry)
{
    return (uint16_t *)(void *)(f->rows.items + ROW_ITEMS * entry);
}

/* The masks of another cluster, NULL if memory ran out. */
static uint16_t *rows_of(sc_scratch *scratch, found *f, uint32_t other)
{
    if (!f->entry[other]) {
        if (!sc_list_reserve(scratch, &f->leaf, 1) ||
            !sc_list_reserve(scratch, &f->rows, ROW_ITEMS))
            return NULL;
        memset(rows_at(f, f->leaf.count), 0, SC_LEAF_MAX * sizeof(uint16_t));
        f->rows.count += ROW_ITEMS;
        sc_list_add(&f->leaf, other);
        f->entry[other] = (uint32_t)f->leaf.count;
    }
    return rows_at(f, f->entry[other] - 1);
}

/* Looks at the triangles round a point of a cluster. place: of each triangle, SC_LEAF_MAX times its
   leaf cluster, and its place in that. */
static int look_round(const sc_adjacency *adjacency, const uint32_t *place, uint32_t leaf,
                      uint32_t p, sc_scratch *scratch, sc_sharing *s, found *f)
{
    uint32_t begin = adjacency->corner_first[p], end = adjacency->corner_first[p + 1], i, k;
    uint32_t mask = 0, own = 0, others = 0, other[SC_SHARING_CROWD];
    uint32_t first = SC_LEAF_MAX * leaf;
    uint8_t row[SC_SHARING_CROWD];
    if (end - begin > SC_SHARING_CROWD) {
        s->crowded[leaf] = 1;
        return 1;
    }
    for (i = begin; i < end; i++) {
        uint32_t at = place[adjacency->corners[i] / 3], is_own = at - first < SC_LEAF_MAX;
        other[others] = at;
        others += at >= first + SC_LEAF_MAX;
        row[own] = (uint8_t)(at % SC_LEAF_MAX);
        mask |= is_own << at % SC_LEAF_MAX;
        own += is_own;
    }
    for (k = 0; k < own; k++) /* those in higher rows */
        s->own_rows[SC_LEAF_MAX * (uint64_t)leaf + row[k]] |= (uint16_t)(mask & (~1u << row[k]));
    if (!others) return 1;
    for (i = 0; i < others; i++) {
        uint16_t *rows = rows_of(scratch, f, other[i] / SC_LEAF_MAX);
        uint16_t bit = (uint16_t)(1u << other[i] % SC_LEAF_MAX);
        if (!rows) return 0;
        for (k = 0; k < own; k++) rows[row[k]] |= bit;
    }
    return 1;
}

/* Moves what was found for a cluster into the lists' tail, in ascending order. */
static void sort_tail(found *f, uint64_t begin)
{
    uint64_t i, j;
    for (i = begin; i < f->leaf.count; i++) {
        uint32_t leaf = f->leaf.items[i];
        uint16_t rows[SC_LEAF_MAX];
        memcpy(rows, rows_at(f, i), sizeof rows);
        f->entry[leaf] = 0;
        for (j = i; j > begin && f->leaf.items[j - 1] > leaf; j--) {
            f->leaf.items[j] = f->leaf.items[j - 1];
            memcpy(rows_at(f, j), rows_at(f, j - 1), sizeof rows);
        }
        f->leaf.items[j] = leaf;
        memcpy(rows_at(f, j), rows, sizeof rows);
    }
}

sc_status sc_sharing_build(const sc_points *points, const sc_adjacency *adjacency,
                           const uint32_t *order, const sc_xbvh *xbvh, sc_scratch *scratch,
                           sc_sharing *s)
{
    uint32_t leaf, i, leaves = xbvh->leaf_count, *place;
    uint32_t *looked; /* a point's last cluster */
    found f;
    memset(&f, 0, sizeof f);
    place = (uint32_t *)sc_scratch_take(scratch, points->triangle_count, sizeof *place);
    f.entry = (uint32_t *)sc_scratch_take_filled(scratch, leaves, sizeof *f.entry, 0);
    looked = (uint32_t *)sc_scratch_take_filled(scratch, points->point_count, sizeof *looked, 0xff);
    s->first = (uint32_t *)sc_scratch_take(scratch, (uint64_t)leaves + 1, sizeof *s->first);
    s->own_rows = (uint16_t *)sc_scratch_take_filled(scratch, (uint64_t)leaves * SC_LEAF_MAX,
                                                     sizeof *s->own_rows, 0);
    s->crowded = (uint8_t *)sc_scratch_take_filled(scratch, leaves, 1, 0);
    if (!place || !f.entry || !looked || !s->first || !s->own_rows || !s->crowded)
        return SC_ERROR_MEMORY;
    if (!sc_list_reserve(scratch, &f.leaf, NEIGHBORS * (uint64_t)leaves) ||
        !sc_list_reserve(scratch, &f.rows, ROW_ITEMS * NEIGHBORS * (uint64_t)leaves))
        return SC_ERROR_MEMORY;
    for (leaf = 0; leaf < leaves; leaf++)
        for (i = xbvh->leaf_first[leaf]; i < xbvh->leaf_first[leaf + 1]; i++)
            place[order[i]] = SC_LEAF_MAX * leaf + (i - xbvh->leaf_first[leaf]);
    for (leaf = 0; leaf < leaves; leaf++) {
        s->first[leaf] = (uint32_t)f.leaf.count;
        for (i = 3 * xbvh->leaf_first[leaf]; i < 3 * xbvh->leaf_first[leaf + 1]; i++) {
            uint32_t p = points->triangles[3 * (uint64_t)order[i / 3] + i % 3];
            if (looked[p] == leaf) continue;
            looked[p] = leaf;
            if (!look_round(adjacency, place, leaf, p, scratch, s, &f)) return SC_ERROR_MEMORY;
        }
        /* 150 gigabytes; of a cluster there are fewer than 0xffff, so that no number wraps round */
        if (SC_HARDLY(f.leaf.count > 0xffff0000u)) return SC_ERROR_COUNT;
        sort_tail(&f, s->first[leaf]);
    }
    s->first[leaves] = (uint32_t)f.leaf.count;
    s->leaf = f.leaf.items;
    s->rows = rows_at(&f, 0);
    sc_scratch_give(scratch, place);
    sc_scratch_give(scratch, f.entry);
    sc_scratch_give(scratch, looked);
    return SC_OK;
}

static int share(const sc_points *points, uint32_t t, uint32_t u)
{
    const uint32_t *a = points->triangles + 3 * (uint64_t)t,
                   *b = points->triangles + 3 * (uint64_t)u;
    int i, k, same = 0;
    for (i = 0; i < 3; i++)
        for (k = 0; k < 3; k++) same |= a[i] == b[k];
    return same;
}

int sc_sharing_validate(const sc_points *points, const uint32_t *order, const sc_xbvh *xbvh,
                        const sc_sharing *s)
{
    const uint32_t *first = xbvh->leaf_first;
    uint32_t a, b, i, j, entry, wrong = 0;
    for (a = 0; a < xbvh->leaf_count; a++)
        for (b = a, entry = s->first[a]; b < xbvh->leaf_count; b++) {
            const uint16_t *rows = a == b ? s->own_rows + SC_LEAF_MAX * (uint64_t)a : NULL;
            if (a != b && entry < s->first[a + 1] && s->leaf[entry] == b)
                rows = s->rows + SC_LEAF_MAX * (uint64_t)entry++;
            if (s->crowded[a] && s->crowded[b]) continue;
            for (i = first[a]; i < first[a + 1]; i++)
                for (j = a == b ? i + 1 : first[b]; j < first[b + 1]; j++)
                    wrong += (uint32_t)share(points, order[i], order[j]) !=
                             (rows ? rows[i - first[a]] >> (j - first[b]) & 1u : 0);
        }
    return wrong == 0;
}
