/*
 * The half-edges of contours. See contour_edges.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "build/contour_edges.h"

#include <math.h>
#include <string.h>

/* The cosine up to which a run may turn from its first half-edge. */
static const double TURN_COSINE = 0.25;

/* Loops over leaf clusters are cut into parts of so many at least. */
enum { PART_LEAVES_MIN = 256 };

uint64_t sc_contour_add_up(uint64_t counts[SC_JOBS_PARTS + 1], uint32_t parts)
{
    uint64_t part, sum = 0;
    uint32_t i;
    for (i = 0; i < parts; i++) {
        part = counts[i];
        counts[i] = sum;
        sum += part;
    }
    counts[parts] = sum;
    return sum;
}

/* Memory for the half-edges of a level. */
static int take_level(sc_scratch *scratch, sc_contour_level *level, uint32_t count)
{
    uint32_t **const arrays[] = {&level->half_edges, &level->below, &level->above,
                                 &level->opposite,   &level->next,  &level->inside,
                                 &level->outside};
    unsigned i;
    level->count = count;
    level->cut = (uint8_t *)sc_scratch_take_filled(scratch, count, 1, 0);
    level->start = (uint8_t *)sc_scratch_take(scratch, count, 1);
    if (!level->cut || !level->start) return 0;
    for (i = 0; i < sizeof arrays / sizeof *arrays; i++) {
        *arrays[i] = (uint32_t *)sc_scratch_take(scratch, count, sizeof(uint32_t));
        if (!*arrays[i]) return 0;
    }
    return 1;
}

void sc_contour_level_give(sc_scratch *scratch, const sc_contour_level *level)
{
    sc_scratch_give(scratch, level->half_edges);
    sc_scratch_give(scratch, level->below);
    sc_scratch_give(scratch, level->above);
    sc_scratch_give(scratch, level->opposite);
    sc_scratch_give(scratch, level->next);
    sc_scratch_give(scratch, level->inside);
    sc_scratch_give(scratch, level->outside);
    sc_scratch_give(scratch, level->segment);
    sc_scratch_give(scratch, level->end);
    sc_scratch_give(scratch, level->cut);
    sc_scratch_give(scratch, level->start);
}

/* What collecting half-edges works with. */
typedef struct collection {
    const sc_points *points;
    const sc_adjacency *adjacency;
    const sc_xbvh *xbvh;
    const uint32_t *order;
    sc_scratch *scratch;
    uint32_t *patch;  /* triangle_count: the leaf cluster it is in */
    uint32_t *place;  /* 3 * triangle_count: of half-edges in the last level, or SC_NONE */
    uint32_t *all;    /* 3 * triangle_count: those of each part, from the part's first on */
    uint32_t *parent; /* of patches of the level below, counted from its first */
    uint32_t *kept;   /* places of the level below: those that each part keeps, from its first on */
    uint32_t begin;   /* the first patch of the level below */
    sc_contour_level *level, *below;
    /* Of each part, how many half-edges it has, and then how many those before it have. */
    uint64_t counts[SC_JOBS_PARTS + 1];
} collection;

static void find_patches(void *context, uint32_t part, uint32_t first, uint32_t end)
{
    const collection *c = (const collection *)context;
    const sc_xbvh *xbvh = c->xbvh;
    uint32_t leaf, i, base = xbvh->level_first[xbvh->level_count - 1];
    (void)part;
    for (leaf = first; leaf < end; leaf++)
        for (i = xbvh->leaf_first[leaf]; i < xbvh->leaf_first[leaf + 1]; i++)
            c->patch[c->order[i]] = base + leaf;
}

/* Lists the half-edges of triangles that are between leaf clusters. Their places are those among
   the part's. */
static void find_leaf_edges(void *context, uint32_t part, uint32_t first, uint32_t end)
{
    collection *c = (collection *)context;
    const uint32_t *opposite = c->adjacency->opposite, *patch = c->patch, *order = c->order;
    uint32_t *place = c->place, *all = c->all + 3 * (size_t)first, i, k, count = 0;
    for (i = first; i < end; i++)
        for (k = 0; k < 3; k++) { /* without branches, which no processor could foresee */
            uint32_t h = 3 * order[i] + k, other = opposite[h];
            uint32_t between = other == SC_NONE || patch[other / 3] != patch[order[i]];
            place[h] = count | (between - 1);
            all[count] = h;
            count += between;
        }
    c->counts[part] = count;
}

static void place_leaf_edges(void *context, uint32_t part, uint32_t first, uint32_t end)
{
    const collection *c = (const collection *)context;
    uint32_t e = (uint32_t)c->counts[part], stop = (uint32_t)c->counts[part + 1];
    uint32_t *half_edges = c->level->half_edges;
    (void)end;
    memcpy(half_edges + e, c->all + 3 * (size_t)first, (stop - e) * sizeof *half_edges);
    if (part == 0) return; /* they are those already */
    for (; e < stop; e++) c->place[half_edges[e]] = e;
}

static void relate_leaf_edges(void *context, uint32_t part, uint32_t first, uint32_t end)
{
    const collection *c = (const collection *)context;
    const uint32_t *opposite = c->adjacency->opposite, *patch = c->patch, *place = c->place;
    sc_contour_level *level = c->level;
    uint32_t e;
    (void)part;
    for (e = first; e < end; e++) {
        uint32_t h = level->half_edges[e], other = opposite[h];
        level->inside[e] = patch[h / 3];
        level->outside[e] = other == SC_NONE ? SC_NONE : patch[other / 3];
        level->opposite[e] = other == SC_NONE ? SC_NONE : place[other];
        /* the one that follows: turns round the end point through triangles of the patch */
        h = sc_adjacency_next(h);
        while (place[h] == SC_NONE) h = sc_adjacency_next(opposite[h]);
        level->next[e] = place[h];
    }
}

/* The last level: the half-edges between leaf clusters, in the order of the leaves, so that
   segments that are near have near numbers. */
static sc_status collect_leaves(collection *c)
{
    uint32_t triangles = c->points->triangle_count, parts, count;
    uint64_t corners = 3 * (uint64_t)triangles;
    c->patch = (uint32_t *)sc_scratch_take(c->scratch, triangles, sizeof *c->patch);
    c->place = (uint32_t *)sc_scratch_take(c->scratch, corners, sizeof *c->place);
    c->all = (uint32_t *)sc_scratch_take(c->scratch, corners, sizeof *c->all);
    if (!c->patch || !c->place || !c->all) return SC_ERROR_MEMORY;
    (void)sc_contour_parts(c->scratch, c->xbvh->leaf_count, PART_LEAVES_MIN, find_patches, c);
    parts = sc_contour_parts(c->scratch, triangles, SC_CONTOUR_PART_MIN, find_leaf_edges, c);
    count = (uint32_t)sc_contour_add_up(c->counts, parts);
    if (!take_level(c->scratch, c->level, count)) return SC_ERROR_MEMORY;
    (void)sc_contour_parts(c->scratch, triangles, SC_CONTOUR_PART_MIN, place_leaf_edges, c);
    sc_scratch_give(c->scratch, c->all);
    (void)sc_contour_parts(c->scratch, count, SC_CONTOUR_PART_MIN, relate_leaf_edges, c);
    sc_scratch_give(c->scratch, c->patch);
    sc_scratch_give(c->scratch, c->place);
    return SC_OK;
}

/* Lists those of the level below that a level keeps, as find_leaf_edges does. */
static void find_edges(void *context, uint32_t part, uint32_t first, uint32_t end)
{
    collection *c = (collection *)context;
    const sc_contour_level *below = c->below;
    const uint32_t *parent = c->parent;
    uint32_t begin = c->begin, e, count = 0;
    uint32_t *kept = c->kept + first;
    for (e = first; e < end; e++) { /* without branches, again */
        uint32_t out = below->outside[e];
        uint32_t between =
            out == SC_NONE || parent[out - begin] != parent[below->inside[e] - begin];
        below->above[e] = count | (between - 1);
        kept[count] = e;
        count += between;
    }
    c->counts[part] = count;
}

static void place_edges(void *context, uint32_t part, uint32_t first, uint32_t end)
{
    const collection *c = (const collection *)context;
    uint32_t e = (uint32_t)c->counts[part], stop = (uint32_t)c->counts[part + 1];
    uint32_t *places = c->level->below;
    (void)end;
    memcpy(places + e, c->kept + first, (stop - e) * sizeof *places);
    if (part == 0) return; /* they are those already */
    for (; e < stop; e++) c->below->above[places[e]] = e;
}

static void relate_edges(void *context, uint32_t part, uint32_t first, uint32_t end)
{
    const collection *c = (const collection *)context;
    const sc_contour_level *below = c->below;
    sc_contour_level *level = c->level;
    const uint32_t *parent = c->parent;
    uint32_t begin = c->begin, e;
    (void)part;
    for (e = first; e < end; e++) {
        uint32_t from = level->below[e], following;
        uint32_t out = below->outside[from], other = below->opposite[from];
        level->half_edges[e] = below->half_edges[from];
        level->inside[e] = parent[below->inside[from] - begin];
        level->outside[e] = out == SC_NONE ? SC_NONE : parent[out - begin];
        level->opposite[e] = other == SC_NONE ? SC_NONE : below->above[other];
        /* the one that follows: turns round the end point through patches below */
        following = below->next[from];
        while (below->above[following] == SC_NONE)
            following = below->next[below->opposite[following]];
        level->next[e] = below->above[following];
    }
}

/* Any other level: what is left of those of the level below. */
static sc_status collect_level(collection *c, uint32_t number)
{
    const sc_xbvh *xbvh = c->xbvh;
    uint32_t parts, count, p, i;
    c->begin = xbvh->level_first[number + 1];
    for (p = xbvh->level_first[number]; p + 1 < c->begin; p++)
        for (i = xbvh->child[p]; i < xbvh->child[p + 1]; i++) c->parent[i - c->begin] = p;
    parts = sc_contour_parts(c->scratch, c->below->count, SC_CONTOUR_PART_MIN, find_edges, c);
    count = (uint32_t)sc_contour_add_up(c->counts, parts);
    if (!take_level(c->scratch, c->level, count)) return SC_ERROR_MEMORY;
    (void)sc_contour_parts(c->scratch, c->below->count, SC_CONTOUR_PART_MIN, place_edges, c);
    (void)sc_contour_parts(c->scratch, count, SC_CONTOUR_PART_MIN, relate_edges, c);
    sc_scratch_give(c->scratch, c->below->opposite);
    c->below->opposite = NULL;
    return SC_OK;
}

sc_status sc_contour_edges_collect(const sc_points *points, const sc_adjacency *adjacency,
                                   const uint32_t *order, const sc_xbvh *xbvh, sc_scratch *scratch,
                                   sc_contour_level *levels)
{
    uint32_t number = xbvh->level_count - 1;
    sc_status status;
    collection c;
    memset(&c, 0, sizeof c);
    c.points = points;
    c.adjacency = adjacency;
    c.order = order;
    c.xbvh = xbvh;
    c.scratch = scratch;
    c.level = &levels[number];
    c.parent = (uint32_t *)sc_scratch_take(scratch, xbvh->leaf_count, sizeof *c.parent);
    if (!c.parent) return SC_ERROR_MEMORY;
    status = collect_leaves(&c);
    if (status) return status;
    c.kept = (uint32_t *)sc_scratch_take(scratch, c.level->count, sizeof *c.kept);
    if (!c.kept) return SC_ERROR_MEMORY;
    while (!status && number-- > 0) {
        c.below = c.level;
        c.level = &levels[number];
        status = collect_level(&c, number);
    }
    sc_scratch_give(scratch, c.parent);
    sc_scratch_give(scratch, c.kept);
    return status;
}

uint32_t sc_contour_patch_begin(const sc_contour_level *level, uint32_t e)
{
    uint32_t low = e, high = level->count, middle;
    if (e == 0) return 0;
    while (low < high) {
        middle = low + (high - low) / 2;
        if (level->inside[middle] == level->inside[e - 1])
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

static void direction_of(const sc_points *points, uint32_t h, double direction[3])
{
    const double *p = points->rest + 3 * (uint64_t)points->triangles[h];
    const double *q = points->rest + 3 * (uint64_t)points->triangles[sc_adjacency_next(h)];
    int k;
    for (k = 0; k < 3; k++) direction[k] = q[k] - p[k];
}

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Walks the run that starts at place e and cuts it where it turns. */
static void cut_run(const sc_points *points, sc_contour_level *level, uint32_t e)
{
    double first[3], now[3];
    direction_of(points, level->half_edges[e], first);
    for (e = level->next[e]; !level->start[e]; e = level->next[e]) {
        direction_of(points, level->half_edges[e], now);
        if (dot(first, now) < TURN_COSINE * sqrt(dot(first, first)) * sqrt(dot(now, now))) {
            level->cut[e] = level->start[e] = 1;
            memcpy(first, now, sizeof first);
        }
    }
}

/* Walks the loop that place e is in, marks it seen, and cuts it where that is needed: runs at the
   outside where they turn, and a loop in which no run starts first at its lowest half-edge. */
static void cut_loop(const sc_points *points, sc_contour_level *level, uint32_t e, uint8_t *seen)
{
    uint32_t f = e, lowest = e, starts = 0, outside = 0;
    do {
        seen[f] = 1;
        starts |= level->start[f];
        outside |= level->outside[f] == SC_NONE;
        f = level->next[f];
    } while (f != e);
    if (!starts) {
        for (f = level->next[e]; f != e; f = level->next[f])
            if (level->half_edges[f] < level->half_edges[lowest]) lowest = f;
        level->cut[lowest] = level->start[lowest] = 1;
        cut_run(points, level, lowest);
    } else if (outside) {
        do {
            if (level->start[f] && level->outside[f] == SC_NONE) cut_run(points, level, f);
            f = level->next[f];
        } while (f != e);
    }
}

static void hand_cuts_down(void *context, uint32_t part, uint32_t first, uint32_t end)
{
    const sc_contour_level *above = (const sc_contour_level *)context, *level = above + 1;
    uint32_t e;
    (void)part;
    for (e = first; e < end; e++) level->cut[above->below[e]] = above->cut[e];
}

/* What finding starts works with. */
typedef struct start_search {
    const sc_points *points;
    sc_contour_level *level;
    uint8_t *seen; /* places */
} start_search;

static void find_starts_of_patches(void *context, uint32_t part, uint32_t first, uint32_t end)
{
    const start_search *s = (const start_search *)context;
    sc_contour_level *level = s->level;
    uint32_t e, f;
    (void)part;
    first = sc_contour_patch_begin(level, first);
    end = sc_contour_patch_begin(level, end);
    for (e = first; e < end; e++) { /* each follows one */
        f = level->next[e];
        level->start[f] = level->cut[f] | (level->outside[e] != level->outside[f]);
    }
    for (e = first; e < end; e++)
        if (!s->seen[e]) cut_loop(s->points, level, e, s->seen);
}

sc_status sc_contour_edges_find_starts(const sc_points *points, sc_scratch *scratch,
                                       sc_contour_level *level, sc_contour_level *above)
{
    start_search search;
    search.points = points;
    search.level = level;
    search.seen = (uint8_t *)sc_scratch_take_filled(scratch, level->count, 1, 0);
    if (!search.seen) return SC_ERROR_MEMORY;
    if (above)
        (void)sc_contour_parts(scratch, above->count, SC_CONTOUR_PART_MIN, hand_cuts_down, above);
    (void)sc_contour_parts(scratch, level->count, SC_CONTOUR_PART_MIN, find_starts_of_patches,
                           &search);
    sc_scratch_give(scratch, search.seen);
    return SC_OK;
}
