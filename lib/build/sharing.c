/*
 * Which triangles of leaf clusters share points. See sharing.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "build/sharing.h"

#include <string.h>

#include "base/assume.h"
#include "base/jobs.h"

/* Room for so many neighbors a cluster with higher numbers, until it is known how many there are:
   few meshes have more. */
enum { NEIGHBORS = 8 };

/* A cluster has so many corners and other clusters round them at most, and a table of these has
   more slots, a power of 2. */
enum { CORNERS = 3 * SC_LEAF_MAX, OTHERS = CORNERS * SC_SHARING_CROWD, SLOTS = 4096 };
typedef char a_slot_is_free[SLOTS > OTHERS ? 1 : -1];

/* The points of a cluster that were looked at are found by their lowest bits. */
enum { SEEN_SLOTS = 256 };

/* The clusters with higher numbers that share a point with the one at hand, as they turn up. */
typedef struct found {
    uint32_t count, leaf[OTHERS];
    uint16_t slot[SLOTS]; /* 1 + place in the list of a cluster that belongs here or in one of the
                             slots before, 0 if free */
    uint8_t seen_at[SEEN_SLOTS]; /* any number: the place of a point in a list, if it is there */
    uint64_t room;               /* for so many there are: */
    uint16_t *rows;              /* SC_LEAF_MAX each */
    uint32_t *touch;
    uint16_t spare_rows[SC_LEAF_MAX]; /* for all others */
    uint32_t spare_touch;
} found;

/* A search through all clusters. */
typedef struct leaf_search {
    const sc_points *points;
    const sc_adjacency *adjacency;
    const uint32_t *order;
    const sc_xbvh *xbvh;
    uint32_t *place; /* of each triangle, SC_LEAF_MAX times its leaf cluster, and its place there */
    sc_sharing *s;
    int is_counted; /* the room of each part is what it needs, not what NEIGHBORS says */
    uint32_t leaf[SC_JOBS_PARTS + 1];                    /* the first of each part, and the end */
    uint64_t begin[SC_JOBS_PARTS], count[SC_JOBS_PARTS]; /* where each part writes, and how many */
} leaf_search;

static void clear_found(found *f)
{
    uint32_t i, at;
    for (i = 0; i < f->count; i++) /* each is in the run of taken slots that begins with its own */
        for (at = f->leaf[i] % SLOTS; f->slot[at]; at = (at + 1) % SLOTS) f->slot[at] = 0;
    f->count = 0;
}

/* The masks of another cluster, in which a triangle at point p is. */
static uint16_t *rows_of(found *f, uint32_t other, uint32_t p)
{
    uint32_t at = other % SLOTS, i;
    uint16_t *rows;
    uint32_t *touch;
    while (f->slot[at] && f->leaf[f->slot[at] - 1u] != other) at = (at + 1) % SLOTS;
    i = f->slot[at] ? f->slot[at] - 1u : f->count;
    rows = i < f->room ? f->rows + SC_LEAF_MAX * (uint64_t)i : f->spare_rows;
    touch = i < f->room ? f->touch + i : &f->spare_touch;
    if (f->slot[at]) {
        if (*touch != p) *touch = SC_NONE;
        return rows;
    }
    memset(rows, 0, SC_LEAF_MAX * sizeof *rows);
    *touch = p;
    f->leaf[f->count++] = other;
    f->slot[at] = (uint16_t)f->count;
    return rows;
}

/* Looks at the triangles round a point of a cluster. */
static void look_round(const leaf_search *g, uint32_t leaf, uint32_t p, found *f)
{
    const sc_adjacency *adjacency = g->adjacency;
    uint32_t begin = adjacency->corner_first[p], end = adjacency->corner_first[p + 1], i, k;
    uint32_t mask = 0, own = 0, others = 0, other[SC_SHARING_CROWD];
    uint32_t first = SC_LEAF_MAX * leaf;
    uint8_t row[SC_SHARING_CROWD];
    if (end - begin > SC_SHARING_CROWD) {
        g->s->crowded[leaf] = 1;
        return;
    }
    for (i = begin; i < end; i++) {
        uint32_t at = g->place[adjacency->corners[i] / 3], is_own = at - first < SC_LEAF_MAX;
        other[others] = at;
        others += at >= first + SC_LEAF_MAX;
        row[own] = (uint8_t)(at % SC_LEAF_MAX);
        mask |= is_own << at % SC_LEAF_MAX;
        own += is_own;
    }
    for (k = 0; k < own; k++) /* those in higher rows */
        g->s->own_rows[SC_LEAF_MAX * (uint64_t)leaf + row[k]] |= (uint16_t)(mask & (~1u << row[k]));
    for (i = 0; i < others; i++) {
        uint16_t *rows = rows_of(f, other[i] / SC_LEAF_MAX, p);
        uint16_t bit = (uint16_t)(1u << other[i] % SC_LEAF_MAX);
        for (k = 0; k < own; k++) rows[row[k]] |= bit;
    }
}

/* Looks at each point of a cluster, nearly always once: twice does no harm. */
static void look_at_leaf(const leaf_search *g, uint32_t leaf, found *f)
{
    uint32_t seen[CORNERS], count = 0, i, c;
    for (i = g->xbvh->leaf_first[leaf]; i < g->xbvh->leaf_first[leaf + 1]; i++)
        for (c = 0; c < 3; c++) {
            uint32_t p = g->points->triangles[3 * (uint64_t)g->order[i] + c];
            uint8_t *at = &f->seen_at[p % SEEN_SLOTS];
            if (*at < count && seen[*at] == p) continue;
            *at = (uint8_t)count;
            seen[count++] = p;
            look_round(g, leaf, p, f);
        }
}

/* Writes the list of what was found for a cluster, and brings it, masks and touch into ascending
   order. */
static void order_found(const found *f, uint32_t *list)
{
    uint32_t i, j;
    for (i = 0; i < f->count; i++) {
        uint32_t leaf = f->leaf[i], touch = f->touch[i];
        uint16_t rows[SC_LEAF_MAX];
        memcpy(rows, f->rows + SC_LEAF_MAX * (uint64_t)i, sizeof rows);
        for (j = i; j > 0 && list[j - 1] > leaf; j--) {
            list[j] = list[j - 1];
            f->touch[j] = f->touch[j - 1];
            memcpy(f->rows + SC_LEAF_MAX * (uint64_t)j, f->rows + SC_LEAF_MAX * (uint64_t)(j - 1),
                   sizeof rows);
        }
        list[j] = leaf;
        f->touch[j] = touch;
        memcpy(f->rows + SC_LEAF_MAX * (uint64_t)j, rows, sizeof rows);
    }
}

static void place_triangles(void *context, uint32_t part, uint32_t first, uint32_t end)
{
    const leaf_search *g = (const leaf_search *)context;
    uint32_t leaf, i;
    (void)part;
    for (leaf = first; leaf < end; leaf++)
        for (i = g->xbvh->leaf_first[leaf]; i < g->xbvh->leaf_first[leaf + 1]; i++)
            g->place[g->order[i]] = SC_LEAF_MAX * leaf + (i - g->xbvh->leaf_first[leaf]);
}

/* Lists what clusters share. If there is no room for all, what they need is counted. */
static void look_at_leaves(void *context, uint32_t part, uint32_t first, uint32_t end)
{
    leaf_search *g = (leaf_search *)context;
    uint64_t room = NEIGHBORS * (uint64_t)(end - first), at, count = 0;
    uint32_t leaf;
    found f;
    if (g->is_counted) {
        room = g->count[part];
    } else {
        g->leaf[part] = first;
        g->begin[part] = NEIGHBORS * (uint64_t)first;
    }
    f.count = 0;
    memset(f.slot, 0, sizeof f.slot);
    memset(f.seen_at, 0, sizeof f.seen_at);
    for (leaf = first; leaf < end; leaf++) {
        at = g->begin[part] + count;
        f.room = count < room ? room - count : 0;
        f.rows = g->s->rows + SC_LEAF_MAX * at;
        f.touch = g->s->touch + at;
        g->s->first[leaf] = (uint32_t)at;
        look_at_leaf(g, leaf, &f);
        count += f.count;
        if (f.count <= f.room) order_found(&f, g->s->leaf + at);
        clear_found(&f);
    }
    g->count[part] = count;
}

/* Clusters that parts of a loop look at, at least. */
enum { CLUSTERS_MIN = 128 };

static int take_lists(sc_scratch *scratch, uint64_t entries, sc_sharing *s)
{
    s->leaf = (uint32_t *)sc_scratch_take(scratch, entries, sizeof *s->leaf);
    s->touch = (uint32_t *)sc_scratch_take(scratch, entries, sizeof *s->touch);
    s->rows = (uint16_t *)sc_scratch_take(scratch, SC_LEAF_MAX * entries, sizeof *s->rows);
    return s->leaf && s->touch && s->rows;
}

/* What parts found, to be put together. */
typedef struct joining {
    const leaf_search *g;
    sc_sharing from;
    uint64_t begin[SC_JOBS_PARTS]; /* where they found room */
} joining;

static void join_part(void *context, uint32_t part, uint32_t worker)
{
    const joining *j = (const joining *)context;
    const leaf_search *g = j->g;
    const sc_sharing *s = g->s;
    const uint64_t from = j->begin[part], to = g->begin[part], count = g->count[part];
    uint32_t leaf;
    (void)worker;
    if (count) {
        memcpy(s->leaf + to, j->from.leaf + from, (size_t)count * sizeof *s->leaf);
        memcpy(s->touch + to, j->from.touch + from, (size_t)count * sizeof *s->touch);
        memcpy(s->rows + SC_LEAF_MAX * to, j->from.rows + SC_LEAF_MAX * from,
               (size_t)count * SC_LEAF_MAX * sizeof *s->rows);
    }
    for (leaf = g->leaf[part]; leaf < g->leaf[part + 1]; leaf++)
        s->first[leaf] -= (uint32_t)(from - to);
}

static void give_lists(sc_scratch *scratch, const sc_sharing *s)
{
    sc_scratch_give(scratch, s->leaf);
    sc_scratch_give(scratch, s->touch);
    sc_scratch_give(scratch, s->rows);
}

/* Puts what parts found into lists of just that length; if they had no room, they look again. */
static sc_status join_parts(leaf_search *g, uint32_t parts, sc_scratch *scratch)
{
    joining j;
    uint64_t total = 0;
    uint32_t part, leaves = g->leaf[parts];
    int is_short = 0;
    j.g = g;
    j.from = *g->s;
    for (part = 0; part < parts; total += g->count[part++]) {
        j.begin[part] = g->begin[part];
        g->begin[part] = total;
        is_short |= g->count[part] > NEIGHBORS * (uint64_t)(g->leaf[part + 1] - g->leaf[part]);
    }
    if (SC_HARDLY(total > 0xffff0000u)) return SC_ERROR_COUNT; /* 150 gigabytes */
    if (is_short) give_lists(scratch, &j.from);
    if (!take_lists(scratch, total, g->s)) return SC_ERROR_MEMORY;
    if (is_short) {
        g->is_counted = 1;
        (void)sc_jobs_loop(scratch->tasks, leaves, CLUSTERS_MIN, look_at_leaves, g);
    } else {
        sc_jobs_run(scratch->tasks, parts, join_part, &j);
        give_lists(scratch, &j.from);
    }
    g->s->first[leaves] = (uint32_t)total;
    return SC_OK;
}

sc_status sc_sharing_build(const sc_points *points, const sc_adjacency *adjacency,
                           const uint32_t *order, const sc_xbvh *xbvh, sc_scratch *scratch,
                           sc_sharing *s)
{
    uint32_t leaves = xbvh->leaf_count, parts;
    sc_status status;
    leaf_search g;
    g.points = points;
    g.adjacency = adjacency;
    g.order = order;
    g.xbvh = xbvh;
    g.s = s;
    g.is_counted = 0;
    g.place = (uint32_t *)sc_scratch_take(scratch, points->triangle_count, sizeof *g.place);
    s->first = (uint32_t *)sc_scratch_take(scratch, (uint64_t)leaves + 1, sizeof *s->first);
    s->own_rows = (uint16_t *)sc_scratch_take_filled(scratch, (uint64_t)leaves * SC_LEAF_MAX,
                                                     sizeof *s->own_rows, 0);
    s->crowded = (uint8_t *)sc_scratch_take_filled(scratch, leaves, 1, 0);
    if (!g.place || !s->first || !s->own_rows || !s->crowded) return SC_ERROR_MEMORY;
    if (!take_lists(scratch, NEIGHBORS * (uint64_t)leaves, s)) return SC_ERROR_MEMORY;
    sc_jobs_loop(scratch->tasks, leaves, CLUSTERS_MIN, place_triangles, &g);
    parts = sc_jobs_loop(scratch->tasks, leaves, CLUSTERS_MIN, look_at_leaves, &g);
    g.leaf[parts] = leaves;
    status = join_parts(&g, parts, scratch);
    sc_scratch_give(scratch, g.place);
    return status;
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
