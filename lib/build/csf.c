/*
 * The contour segment forest. See csf.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "build/csf.h"

#include <math.h>
#include <string.h>

#include "base/assume.h"
#include "base/jobs.h"
#include "build/chains.h"

/* The cosine up to which a run may turn from its first half-edge. */
static const double TURN_COSINE = 0.25;

/* Room for the lists of nodes, so that it seldom has to grow. */
enum { SEGMENTS_A_NODE = 10 };

/* Loops over half-edges, triangles and the like are cut into parts of so many at least. */
enum { PART_MIN = 4096, PART_LEAVES_MIN = 256, PART_NODES_MIN = 1024 };

/* The contour half-edges of one level; a place is a number below count. What leads from level to
   level are places, so that work at a level touches only what belongs to it. */
typedef struct contour_level {
    uint32_t count;
    uint32_t *half_edges; /* count */
    uint32_t *below,
        *above; /* count: places one level down and up, SC_NONE where it is none there */
    uint32_t *opposite, *next;  /* count: places; opposite: SC_NONE at the outside */
    uint32_t *inside, *outside; /* count: patches on its side and across, SC_NONE for the outside */
    uint32_t *segment, *end; /* count: of the run that starts here: its segment, its last place */
    uint8_t *cut, *start;    /* count: whether a run starts here, regardless or at all */
} contour_level;

typedef struct builder {
    const sc_points *points;
    const sc_adjacency *adjacency;
    const sc_xbvh *xbvh;
    const sc_sctt *sctt;
    sc_scratch *scratch;
    contour_level *levels;  /* level_count */
    uint32_t leaf_segments; /* of the last level */
    sc_list points_first, half_edges, child_first, children;
    /* Node lists, written from the end of their room, the last node's first; how much of it is in
       use; and of each node, how much was then. */
    uint32_t *lists, *node_place; /* room; node_count + 1 */
    uint64_t room, listed;
    /* The runs of the level at hand, which are in the order of their patches, and where those of
       each begin. */
    uint32_t *run_out, *run_segment, *patch_first;
    uint32_t *kept; /* places that a level keeps of the one below; the same memory as run_out */
    /* For the parts of loops: the level at hand, and its number; of each part, how much it has of
       what is counted, and then how much those before it have. */
    contour_level *level;
    uint32_t number;
    uint64_t counts[SC_JOBS_PARTS + 1], segments_of[SC_JOBS_PARTS + 1],
        children_of[SC_JOBS_PARTS + 1];
} builder;

/* Returns how many parts there are. */
static uint32_t in_parts(const builder *b, uint32_t count, uint32_t least, sc_jobs_body body,
                         void *context)
{
    return count ? sc_jobs_loop(b->scratch->tasks, count, least, body, context) : 0;
}

/* From what each part has to what those before it have; returns what all have. */
static uint64_t add_up(uint64_t counts[SC_JOBS_PARTS + 1], uint32_t parts)
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
static int take_level(sc_scratch *scratch, contour_level *level, uint32_t count)
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

static void give_level(sc_scratch *scratch, const contour_level *level)
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
    builder *b;
    const uint32_t *order;
    uint32_t *patch;        /* triangle_count: the leaf cluster it is in */
    uint32_t *place;        /* 3 * triangle_count: of half-edges in the last level, or SC_NONE */
    uint32_t *all;          /* 3 * triangle_count: those of each part, from the part's first on */
    const uint32_t *parent; /* of patches of the level below, counted from its first */
    contour_level *level, *below;
} collection;

static void find_patches(void *context, uint32_t part, uint32_t first, uint32_t end)
{
    const collection *c = (const collection *)context;
    const sc_xbvh *xbvh = c->b->xbvh;
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
    const collection *c = (const collection *)context;
    const uint32_t *opposite = c->b->adjacency->opposite, *patch = c->patch, *order = c->order;
    uint32_t *place = c->place, *all = c->all + 3 * (size_t)first, i, k, count = 0;
    for (i = first; i < end; i++)
        for (k = 0; k < 3; k++) { /* without branches, which no processor could foresee */
            uint32_t h = 3 * order[i] + k, other = opposite[h];
            uint32_t between = other == SC_NONE || patch[other / 3] != patch[order[i]];
            place[h] = count | (between - 1);
            all[count] = h;
            count += between;
        }
    c->b->counts[part] = count;
}

static void place_leaf_edges(void *context, uint32_t part, uint32_t first, uint32_t end)
{
    const collection *c = (const collection *)context;
    uint32_t e = (uint32_t)c->b->counts[part], stop = (uint32_t)c->b->counts[part + 1];
    uint32_t *half_edges = c->level->half_edges;
    (void)end;
    memcpy(half_edges + e, c->all + 3 * (size_t)first, (stop - e) * sizeof *half_edges);
    if (part == 0) return; /* they are those already */
    for (; e < stop; e++) c->place[half_edges[e]] = e;
}

static void relate_leaf_edges(void *context, uint32_t part, uint32_t first, uint32_t end)
{
    const collection *c = (const collection *)context;
    const uint32_t *opposite = c->b->adjacency->opposite, *patch = c->patch, *place = c->place;
    contour_level *level = c->level;
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
static sc_status collect_leaves(builder *b, const uint32_t *order, contour_level *level)
{
    uint32_t triangles = b->points->triangle_count, parts, count;
    uint64_t corners = 3 * (uint64_t)triangles;
    collection c;
    c.b = b;
    c.order = order;
    c.level = level;
    c.patch = (uint32_t *)sc_scratch_take(b->scratch, triangles, sizeof *c.patch);
    c.place = (uint32_t *)sc_scratch_take(b->scratch, corners, sizeof *c.place);
    c.all = (uint32_t *)sc_scratch_take(b->scratch, corners, sizeof *c.all);
    if (!c.patch || !c.place || !c.all) return SC_ERROR_MEMORY;
    (void)in_parts(b, b->xbvh->leaf_count, PART_LEAVES_MIN, find_patches, &c);
    parts = in_parts(b, triangles, PART_MIN, find_leaf_edges, &c);
    count = (uint32_t)add_up(b->counts, parts);
    if (!take_level(b->scratch, level, count)) return SC_ERROR_MEMORY;
    (void)in_parts(b, triangles, PART_MIN, place_leaf_edges, &c);
    sc_scratch_give(b->scratch, c.all);
    (void)in_parts(b, count, PART_MIN, relate_leaf_edges, &c);
    sc_scratch_give(b->scratch, c.patch);
    sc_scratch_give(b->scratch, c.place);
    return SC_OK;
}

/* Lists those of the level below that a level keeps, as find_leaf_edges does. */
static void find_edges(void *context, uint32_t part, uint32_t first, uint32_t end)
{
    const collection *c = (const collection *)context;
    const contour_level *below = c->below;
    const uint32_t *parent = c->parent;
    uint32_t begin = c->b->xbvh->level_first[c->b->number + 1], e, count = 0;
    uint32_t *kept = c->b->kept + first;
    for (e = first; e < end; e++) { /* without branches, again */
        uint32_t out = below->outside[e];
        uint32_t between =
            out == SC_NONE || parent[out - begin] != parent[below->inside[e] - begin];
        below->above[e] = count | (between - 1);
        kept[count] = e;
        count += between;
    }
    c->b->counts[part] = count;
}

static void place_edges(void *context, uint32_t part, uint32_t first, uint32_t end)
{
    const collection *c = (const collection *)context;
    uint32_t e = (uint32_t)c->b->counts[part], stop = (uint32_t)c->b->counts[part + 1];
    uint32_t *places = c->level->below;
    (void)end;
    memcpy(places + e, c->b->kept + first, (stop - e) * sizeof *places);
    if (part == 0) return; /* they are those already */
    for (; e < stop; e++) c->below->above[places[e]] = e;
}

static void relate_edges(void *context, uint32_t part, uint32_t first, uint32_t end)
{
    const collection *c = (const collection *)context;
    const contour_level *below = c->below;
    contour_level *level = c->level;
    const uint32_t *parent = c->parent;
    uint32_t begin = c->b->xbvh->level_first[c->b->number + 1], e;
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
static sc_status collect_level(builder *b, uint32_t number, uint32_t *parent)
{
    contour_level *level = &b->levels[number], *below = &b->levels[number + 1];
    const sc_xbvh *xbvh = b->xbvh;
    uint32_t begin = xbvh->level_first[number + 1], parts, count, p, i;
    collection c;
    c.b = b;
    c.parent = parent;
    c.level = level;
    c.below = below;
    b->number = number;
    for (p = xbvh->level_first[number]; p + 1 < begin; p++)
        for (i = xbvh->child[p]; i < xbvh->child[p + 1]; i++) parent[i - begin] = p;
    parts = in_parts(b, below->count, PART_MIN, find_edges, &c);
    count = (uint32_t)add_up(b->counts, parts);
    if (!take_level(b->scratch, level, count)) return SC_ERROR_MEMORY;
    (void)in_parts(b, below->count, PART_MIN, place_edges, &c);
    (void)in_parts(b, count, PART_MIN, relate_edges, &c);
    sc_scratch_give(b->scratch, below->opposite);
    below->opposite = NULL;
    return SC_OK;
}

/* Where the first patch begins that begins at place e or after it. The places of a patch follow each
   other, so from one such place to another there are patches as a whole, with their loops. */
static uint32_t patch_begin(const contour_level *level, uint32_t e)
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

static void direction_of(const builder *b, uint32_t h, double direction[3])
{
    const double *p = b->points->rest + 3 * (uint64_t)b->points->triangles[h];
    const double *q = b->points->rest + 3 * (uint64_t)b->points->triangles[sc_adjacency_next(h)];
    int k;
    for (k = 0; k < 3; k++) direction[k] = q[k] - p[k];
}

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Walks the run that starts at place e and cuts it where it turns. */
static void cut_run(const builder *b, contour_level *level, uint32_t e)
{
    double first[3], now[3];
    direction_of(b, level->half_edges[e], first);
    for (e = level->next[e]; !level->start[e]; e = level->next[e]) {
        direction_of(b, level->half_edges[e], now);
        if (dot(first, now) < TURN_COSINE * sqrt(dot(first, first)) * sqrt(dot(now, now))) {
            level->cut[e] = level->start[e] = 1;
            memcpy(first, now, sizeof first);
        }
    }
}

/* Walks the loop that place e is in, marks it seen, and cuts it where that is needed: runs at the
   outside where they turn, and a loop in which no run starts first at its lowest half-edge. */
static void cut_loop(const builder *b, contour_level *level, uint32_t e, uint8_t *seen)
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
        cut_run(b, level, lowest);
    } else if (outside) {
        do {
            if (level->start[f] && level->outside[f] == SC_NONE) cut_run(b, level, f);
            f = level->next[f];
        } while (f != e);
    }
}

static void hand_cuts_down(void *context, uint32_t part, uint32_t first, uint32_t end)
{
    const contour_level *above = (const contour_level *)context, *level = above + 1;
    uint32_t e;
    (void)part;
    for (e = first; e < end; e++) level->cut[above->below[e]] = above->cut[e];
}

/* What finding starts works with. */
typedef struct start_search {
    const builder *b;
    contour_level *level;
    uint8_t *seen; /* places */
} start_search;

static void find_starts_of_patches(void *context, uint32_t part, uint32_t first, uint32_t end)
{
    const start_search *s = (const start_search *)context;
    contour_level *level = s->level;
    uint32_t e, f;
    (void)part;
    first = patch_begin(level, first);
    end = patch_begin(level, end);
    for (e = first; e < end; e++) { /* each follows one */
        f = level->next[e];
        level->start[f] = level->cut[f] | (level->outside[e] != level->outside[f]);
    }
    for (e = first; e < end; e++)
        if (!s->seen[e]) cut_loop(s->b, level, e, s->seen);
}

/* Decides where runs start, from the cuts of the level above, if there is one, and its own. */
static sc_status find_starts(builder *b, contour_level *level, contour_level *above)
{
    start_search search;
    search.b = b;
    search.level = level;
    search.seen = (uint8_t *)sc_scratch_take_filled(b->scratch, level->count, 1, 0);
    if (!search.seen) return SC_ERROR_MEMORY;
    if (above) (void)in_parts(b, above->count, PART_MIN, hand_cuts_down, above);
    (void)in_parts(b, level->count, PART_MIN, find_starts_of_patches, &search);
    sc_scratch_give(b->scratch, search.seen);
    return SC_OK;
}

/* Writes the half-edges of a run and one that starts at its last point; returns their number. */
static uint32_t list_leaf_segment(contour_level *level, uint32_t start, uint32_t *half_edges)
{
    uint32_t e = start, h, count = 0;
    do {
        h = level->half_edges[e];
        half_edges[count++] = h;
        level->end[start] = e;
        e = level->next[e];
    } while (!level->start[e]);
    half_edges[count++] = sc_adjacency_next(h); /* starts at the last point */
    return count;
}

/* Writes the segments of the level below that a run consists of; returns their number. */
static uint32_t list_children(contour_level *level, const contour_level *below, uint32_t start,
                              uint32_t *children)
{
    uint32_t from = level->below[start], end, count = 0;
    for (;;) {
        children[count++] = below->segment[from];
        end = below->above[below->end[from]];
        if (level->start[level->next[end]]) break;
        from = level->below[level->next[end]];
    }
    level->end[start] = end;
    return count;
}

static void count_runs(void *context, uint32_t part, uint32_t first, uint32_t end)
{
    builder *b = (builder *)context;
    const contour_level *level = b->level;
    uint32_t e, runs = 0;
    first = patch_begin(level, first);
    end = patch_begin(level, end);
    for (e = first; e < end; e++) runs += level->start[e];
    b->counts[part] = runs;
}

/* Writes the places where a part's runs start. */
static void list_runs(const builder *b, uint32_t part, uint32_t first)
{
    uint32_t i = (uint32_t)b->counts[part], end = (uint32_t)b->counts[part + 1], e;
    for (e = first; i < end; e++) { /* nothing after the part's own */
        b->run_segment[i] = e;
        i += b->level->start[e];
    }
}

/* Walks the runs of the last level: each is a segment. All half-edges are in one, and each has one
   more. */
static void walk_leaf_runs(void *context, uint32_t part, uint32_t first, uint32_t end)
{
    builder *b = (builder *)context;
    uint32_t i, stop = (uint32_t)b->counts[part + 1], *half_edges = b->half_edges.items;
    uint64_t at;
    (void)end;
    first = patch_begin(b->level, first);
    list_runs(b, part, first);
    at = first + b->counts[part];
    for (i = (uint32_t)b->counts[part]; i < stop; i++) {
        uint32_t e = b->run_segment[i];
        b->points_first.items[i] = (uint32_t)at;
        at += list_leaf_segment(b->level, e, half_edges + at);
        b->level->segment[e] = i;
    }
}

/* Walks the runs of another level, and lists the children of those that have two or more from the
   part's first place on, where the level below has what nothing needs any more: no more than there
   are half-edges. Their number is in run_out, for now. */
static void walk_parent_runs(void *context, uint32_t part, uint32_t first, uint32_t end)
{
    builder *b = (builder *)context;
    contour_level *level = b->level;
    uint32_t i, stop = (uint32_t)b->counts[part + 1], segments = 0, count = 0, *children;
    (void)end;
    first = patch_begin(level, first);
    children = level[1].next + first;
    list_runs(b, part, first);
    for (i = (uint32_t)b->counts[part]; i < stop; i++) {
        uint32_t e = b->run_segment[i], more = list_children(level, level + 1, e, children + count);
        b->run_out[i] = more;
        level->segment[e] = children[count]; /* one child: the segment stays */
        segments += more > 1;
        count += more > 1 ? more : 0;
    }
    b->segments_of[part] = segments;
    b->children_of[part] = count;
}

/* Numbers the segments that walk_parent_runs found, and puts their children where they belong. */
static void number_parents(void *context, uint32_t part, uint32_t first, uint32_t end)
{
    builder *b = (builder *)context;
    contour_level *level = b->level;
    uint32_t i, stop = (uint32_t)b->counts[part + 1];
    uint64_t segment = b->child_first.count + b->segments_of[part];
    uint64_t child = b->children.count + b->children_of[part];
    uint64_t count = b->children_of[part + 1] - b->children_of[part];
    (void)end;
    if (count == 0) return;
    first = patch_begin(level, first);
    memcpy(b->children.items + child, level[1].next + first, (size_t)count * sizeof(uint32_t));
    for (i = (uint32_t)b->counts[part]; i < stop; i++) {
        if (b->run_out[i] == 1) continue;
        b->child_first.items[segment] = (uint32_t)child;
        child += b->run_out[i];
        level->segment[b->run_segment[i]] = b->leaf_segments + (uint32_t)segment++;
    }
}

/* Notes what is across runs, their segments, and where those of each patch begin. */
static void finish_runs(void *context, uint32_t part, uint32_t first, uint32_t end)
{
    builder *b = (builder *)context;
    const contour_level *level = b->level;
    uint32_t i, stop = (uint32_t)b->counts[part + 1], begin = b->xbvh->level_first[b->number];
    uint32_t patch;
    (void)end;
    first = patch_begin(level, first);
    patch = first ? level->inside[first - 1] + 1 : begin;
    for (i = (uint32_t)b->counts[part]; i < stop; i++) {
        uint32_t e = b->run_segment[i];
        while (patch <= level->inside[e]) b->patch_first[patch++ - begin] = i;
        b->run_out[i] = level->outside[e];
        b->run_segment[i] = level->segment[e];
    }
}

/* Room for more items before those that are in the node lists; 0 if memory ran out, or for more
   than fit numbers. */
static int reserve_lists(builder *b, uint64_t more)
{
    uint64_t room = b->room + b->room / 4 + more;
    uint32_t *lists;
    if (SC_HARDLY(b->listed + more > 0xfffffff0u)) return 0;
    if (b->lists && b->listed + more <= b->room) return 1;
    lists = (uint32_t *)sc_scratch_take(b->scratch, room, sizeof *lists);
    if (!lists) return 0;
    if (b->listed)
        memcpy(lists + room - b->listed, b->lists + b->room - b->listed,
               (size_t)b->listed * sizeof *lists);
    sc_scratch_give(b->scratch, b->lists);
    b->lists = lists;
    b->room = room;
    return 1;
}

/* How many segments of a patch are not towards another. */
static uint32_t count_patch(const builder *b, uint32_t patch, uint32_t other)
{
    const uint32_t *first = b->patch_first + (patch - b->xbvh->level_first[b->number]);
    uint32_t i, count = 0;
    for (i = first[0]; i < first[1]; i++) count += b->run_out[i] != other;
    return count;
}

/* Lists the segments of a patch, but for those towards another; returns the end of the list. */
static uint32_t *list_patch(const builder *b, uint32_t patch, uint32_t other, uint32_t *list)
{
    const uint32_t *first = b->patch_first + (patch - b->xbvh->level_first[b->number]);
    uint32_t i;
    for (i = first[0]; i < first[1]; i++)
        if (b->run_out[i] != other) *list++ = b->run_segment[i];
    return list;
}

/* Nodes of the level at hand, counted from its first: how long their lists are. */
static void measure_nodes(void *context, uint32_t part, uint32_t first, uint32_t end)
{
    builder *b = (builder *)context;
    uint32_t n, level_first = b->sctt->level_first[b->number];
    uint64_t sum = 0;
    for (n = level_first + first; n < level_first + end; n++) {
        uint32_t p = b->sctt->patches[n].a, q = b->sctt->patches[n].b;
        /* no patch has the number patch_end, so that self nodes leave nothing out */
        uint32_t count = count_patch(b, p, p == q ? b->xbvh->patch_end : q);
        if (p != q) count += count_patch(b, q, p);
        if (b->sctt->touch[n] != SC_NONE) count += 2;
        b->node_place[n] = count;
        sum += count;
    }
    b->counts[part] = sum;
}

static void list_nodes(void *context, uint32_t part, uint32_t first, uint32_t end)
{
    builder *b = (builder *)context;
    uint32_t n, level_first = b->sctt->level_first[b->number];
    /* those of the level end where those of the levels below begin */
    uint64_t left = b->listed - b->counts[part];
    uint32_t *list = b->lists + (b->room - left);
    for (n = level_first + first; n < level_first + end; n++) {
        uint32_t p = b->sctt->patches[n].a, q = b->sctt->patches[n].b, *head = list;
        uint64_t here = left;
        left -= b->node_place[n];
        b->node_place[n] = (uint32_t)here;
        if (b->sctt->touch[n] != SC_NONE) {
            *list++ = b->sctt->touch[n];
            list++;
        }
        list = list_patch(b, p, p == q ? b->xbvh->patch_end : q, list);
        if (b->sctt->touch[n] != SC_NONE) head[1] = (uint32_t)(list - head) - 2;
        if (p != q) list = list_patch(b, q, p, list);
    }
}

/* Room for the segments of the last level; one more for the end of all. */
static int reserve_for_leaves(builder *b, uint32_t half_edges, uint32_t runs)
{
    return sc_list_reserve(b->scratch, &b->points_first, (uint64_t)runs + 1) &&
           sc_list_reserve(b->scratch, &b->half_edges, (uint64_t)half_edges + runs);
}

static sc_status build_level(builder *b, uint32_t number, sc_csf *csf)
{
    contour_level *level = b->level = &b->levels[number];
    uint32_t parts, runs, patch,
        last = b->xbvh->level_count - 1, count = level->count, begin = b->xbvh->level_first[number],
        nodes = b->sctt->level_first[number + 1] - b->sctt->level_first[number];
    b->number = number;
    level->segment = (uint32_t *)sc_scratch_take(b->scratch, count, sizeof(uint32_t));
    level->end = (uint32_t *)sc_scratch_take(b->scratch, count, sizeof(uint32_t));
    if (!level->segment || !level->end) return SC_ERROR_MEMORY;
    parts = in_parts(b, count, PART_MIN, count_runs, b);
    runs = (uint32_t)add_up(b->counts, parts);
    csf->level_segments[number] = runs;
    if (number == last) {
        if (!reserve_for_leaves(b, count, runs)) return SC_ERROR_MEMORY;
        (void)in_parts(b, count, PART_MIN, walk_leaf_runs, b);
        b->points_first.count = csf->leaf_count = b->leaf_segments = runs;
        b->half_edges.count = (uint64_t)count + runs;
    } else {
        uint64_t segments, children;
        (void)in_parts(b, count, PART_MIN, walk_parent_runs, b);
        segments = add_up(b->segments_of, parts);
        children = add_up(b->children_of, parts);
        if (!sc_list_reserve(b->scratch, &b->child_first, segments + 1) || /* and the end of all */
            !sc_list_reserve(b->scratch, &b->children, children))
            return SC_ERROR_MEMORY;
        (void)in_parts(b, count, PART_MIN, number_parents, b);
        b->child_first.count += segments;
        b->children.count += children;
        give_level(b->scratch, level + 1);
    }
    (void)in_parts(b, count, PART_MIN, finish_runs, b);
    patch = count ? level->inside[count - 1] + 1 : begin;
    while (patch < b->xbvh->level_first[number + 1]) b->patch_first[patch++ - begin] = runs;
    parts = in_parts(b, nodes, PART_NODES_MIN, measure_nodes, b);
    if (!reserve_lists(b, add_up(b->counts, parts))) return SC_ERROR_MEMORY;
    b->listed += b->counts[parts];
    (void)in_parts(b, nodes, PART_NODES_MIN, list_nodes, b);
    return SC_OK;
}

/* How many points the lists of a node's segments have, and edges. */
static void count_points(const sc_csf *csf, const uint32_t *segments, uint32_t count,
                         uint64_t *points, uint64_t *edges)
{
    uint32_t i;
    for (*edges = 0, i = 0; i < count; i++)
        *edges += csf->point_last[segments[i]] - csf->point_first[segments[i]];
    *points = *edges + count;
}

/* How long a node's loop is, of so many pieces and edges; 0: it gets none, see csf.h. */
static uint32_t measure_loop(const sc_xbvh *xbvh, sc_pair patches, uint32_t pieces, uint64_t edges)
{
    uint32_t leaves = xbvh->leaf[patches.a + 1] - xbvh->leaf[patches.a];
    if (patches.b != patches.a) leaves += xbvh->leaf[patches.b + 1] - xbvh->leaf[patches.b];
    if (leaves > SC_LOOP_LEAVES || edges > SC_LOOP_MAX) return 0;
    if (pieces < 2) return (uint32_t)edges;
    return pieces <= SC_LOOP_PIECES && edges <= SC_LOOP_PIECES_EDGES ? 1 + pieces + (uint32_t)edges
                                                                     : 0;
}

/* Whether one of some segments starts at a point. */
static uint32_t start_at(const sc_csf *csf, const uint32_t *segments, uint32_t count,
                         uint32_t point)
{
    uint32_t i, found = 0;
    for (i = 0; i < count; i++) found |= csf->points[csf->point_first[segments[i]]] == point;
    return found;
}

/* What measuring contours works with. Each part has room of its own. */
typedef struct measurement {
    const builder *b;
    sc_csf *csf;
    uint32_t parts;
    sc_chains chains[SC_JOBS_PARTS];
    uint32_t most[SC_JOBS_PARTS]; /* points of a node's contour, of those of each part */
} measurement;

/* Chains the segments of a node, measures them and its loop, whose length loop_first has for now,
   and returns how many points they have. Those of patches that share one point stay apart; as
   pieces, the chain through it on one side and that on the other are one. */
static uint32_t measure_contour(const measurement *m, const sc_chains *chains, uint32_t n)
{
    const sc_sctt *sctt = m->b->sctt;
    sc_csf *csf = m->csf;
    uint32_t *segments = csf->contours + csf->contour_first[n], first, pieces;
    uint32_t count = csf->contour_first[n + 1] - csf->contour_first[n], touch = sctt->touch[n];
    uint64_t points, edges;
    if (touch == SC_NONE) {
        pieces = sc_chains_order(chains, segments, count);
    } else {
        first = segments[1];
        segments += 2;
        count -= 2;
        pieces = sc_chains_order(chains, segments, first) +
                 sc_chains_order(chains, segments + first, count - first) -
                 (start_at(csf, segments, first, touch) &
                  start_at(csf, segments + first, count - first, touch));
    }
    csf->in_pieces[n] = pieces > 1;
    count_points(csf, segments, count, &points, &edges);
    csf->loop_first[n] =
        touch == SC_NONE ? measure_loop(m->b->xbvh, sctt->patches[n], pieces, edges) : 0;
    return (uint32_t)points;
}

/* The first node of a part: each has about as many segments. */
static uint32_t part_begin(const measurement *m, uint32_t part)
{
    const uint32_t *first = m->csf->contour_first;
    uint32_t low = 0, high = m->b->sctt->node_count, middle;
    uint32_t segment = (uint32_t)((uint64_t)first[high] * part / m->parts);
    if (part == m->parts) return high;
    while (low < high) {
        middle = low + (high - low) / 2;
        if (first[middle] < segment)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

static void measure_part(void *context, uint32_t part, uint32_t worker)
{
    measurement *m = (measurement *)context;
    uint32_t n, points, most = 0, end = part_begin(m, part + 1);
    (void)worker;
    for (n = part_begin(m, part); n < end; n++) {
        points = measure_contour(m, &m->chains[part], n);
        if (points > most) most = points;
    }
    m->most[part] = most;
}

/* Takes room for as many parts as there are workers, as long as that makes building take no more
   memory in all than it has taken so far, for contours of up to so many segments. */
static sc_status take_rooms(measurement *m, uint64_t longest)
{
    sc_scratch *scratch = m->b->scratch;
    uint64_t before = scratch->live_bytes, room = 0, points = m->b->points->point_count;
    uint32_t most = scratch->tasks ? scratch->tasks->workers : 1;
    if (most > m->b->sctt->node_count / PART_NODES_MIN)
        most = m->b->sctt->node_count / PART_NODES_MIN;
    if (most > SC_JOBS_PARTS) most = SC_JOBS_PARTS;
    m->parts = 0;
    do {
        sc_chains *chains = &m->chains[m->parts++];
        chains->points = m->csf->points;
        chains->first = m->csf->point_first;
        chains->last = m->csf->point_last;
        if (sc_chains_take(scratch, points, longest, chains)) return SC_ERROR_MEMORY;
        if (m->parts == 1) room = scratch->live_bytes - before;
    } while (m->parts < most && scratch->live_bytes + room <= scratch->peak_bytes);
    return SC_OK;
}

/* Puts the loops one after the other, as far as there are numbers for where they begin. */
static void place_loops(sc_csf *csf, uint32_t nodes)
{
    uint32_t n, length, taken = 0;
    for (n = 0; n < nodes; n++) {
        length = csf->loop_first[n];
        csf->loop_first[n] = taken;
        if (SC_HARDLY(length >= 0xfffff000u - taken)) continue;
        taken += length;
    }
    csf->loop_first[nodes] = taken;
}

static sc_status measure_contours(builder *b, sc_csf *csf)
{
    uint32_t nodes = b->sctt->node_count, n, part, longest = 0;
    measurement m;
    for (n = 0; n < nodes; n++)
        if (csf->contour_first[n + 1] - csf->contour_first[n] > longest)
            longest = csf->contour_first[n + 1] - csf->contour_first[n];
    m.b = b;
    m.csf = csf;
    csf->in_pieces = (uint8_t *)sc_scratch_take(b->scratch, nodes, 1);
    csf->loop_first =
        (uint32_t *)sc_scratch_take(b->scratch, (uint64_t)nodes + 1, sizeof(uint32_t));
    if (!csf->in_pieces || !csf->loop_first || take_rooms(&m, longest)) return SC_ERROR_MEMORY;
    sc_jobs_run(b->scratch->tasks, m.parts, measure_part, &m);
    csf->contour_max = 0;
    for (part = 0; part < m.parts; part++) {
        if (m.most[part] > csf->contour_max) csf->contour_max = m.most[part];
        sc_chains_give(b->scratch, &m.chains[part]);
    }
    place_loops(csf, nodes);
    return SC_OK;
}

/* The node lists are there; where they begin. */
static sc_status place_contours(builder *b, sc_csf *csf)
{
    uint32_t n, nodes = b->sctt->node_count;
    csf->contours = b->lists + (b->room - b->listed);
    csf->contour_first = b->node_place;
    b->node_place[nodes] = 0;
    for (n = 0; n <= nodes; n++) b->node_place[n] = (uint32_t)b->listed - b->node_place[n];
    return measure_contours(b, csf);
}

/* What laying out points works with. */
typedef struct point_layout {
    const builder *b;
    const sc_csf *csf;
} point_layout;

/* The last half-edges of segments of the last level; then come the others, where one of them is
   first. */
static void lay_out_last_points(void *context, uint32_t part, uint32_t first, uint32_t end)
{
    const point_layout *l = (const point_layout *)context;
    const uint32_t *from = l->b->points_first.items, *half_edges = l->b->half_edges.items;
    uint32_t s;
    (void)part;
    for (s = first; s < end; s++)
        l->csf->half_edges[l->csf->point_last[s]] = half_edges[from[s + 1] - 1];
}

static void lay_out_other_points(void *context, uint32_t part, uint32_t first, uint32_t end)
{
    const point_layout *l = (const point_layout *)context;
    const uint32_t *from = l->b->points_first.items, *half_edges = l->b->half_edges.items;
    uint32_t s;
    (void)part;
    for (s = first; s < end; s++) {
        uint32_t at = l->csf->point_first[s], count = l->csf->point_last[s] - at;
        memcpy(l->csf->half_edges + at, half_edges + from[s], count * sizeof *half_edges);
    }
}

static void find_points(void *context, uint32_t part, uint32_t first, uint32_t end)
{
    const point_layout *l = (const point_layout *)context;
    uint32_t i;
    (void)part;
    for (i = first; i < end; i++)
        l->csf->points[i] = l->b->points->triangles[l->csf->half_edges[i]];
}

/* Puts the points of all segments below one that has no parent into one range. */
static sc_status lay_out_points(builder *b, sc_csf *csf)
{
    uint32_t s, i, *from = b->points_first.items, *first, *last;
    uint64_t end = 0;
    point_layout l;
    first = (uint32_t *)sc_scratch_take_filled(b->scratch, csf->segment_count, sizeof *first, 0xff);
    last = (uint32_t *)sc_scratch_take(b->scratch, csf->segment_count, sizeof *last);
    if (!first || !last) return SC_ERROR_MEMORY;
    for (s = 0; s < csf->leaf_count; s++) last[s] = from[s + 1] - from[s] - 1;
    for (; s < csf->segment_count; s++) { /* half-edges, for now */
        const uint32_t *child = csf->child_first + (s - csf->leaf_count);
        for (i = child[0], last[s] = 0; i < child[1]; i++) last[s] += last[csf->children[i]];
    }
    for (; s-- > 0;) { /* parents come before their children */
        if (first[s] == SC_NONE) {
            first[s] = (uint32_t)end;
            end += (uint64_t)last[s] + 1;
            if (SC_HARDLY(end > 0xfffffff0u)) return SC_ERROR_COUNT; /* 16 gigabytes */
        }
        if (s >= csf->leaf_count) {
            const uint32_t *child = csf->child_first + (s - csf->leaf_count);
            uint32_t at = first[s];
            for (i = child[0]; i < child[1]; at += last[csf->children[i++]])
                first[csf->children[i]] = at;
        }
        last[s] += first[s];
    }
    csf->points = (uint32_t *)sc_scratch_take(b->scratch, end, sizeof *csf->points);
    csf->half_edges = (uint32_t *)sc_scratch_take(b->scratch, end, sizeof *csf->half_edges);
    if (!csf->points || !csf->half_edges) return SC_ERROR_MEMORY;
    csf->point_first = first;
    csf->point_last = last;
    csf->point_count = (uint32_t)end;
    l.b = b;
    l.csf = csf;
    (void)in_parts(b, csf->leaf_count, PART_NODES_MIN, lay_out_last_points, &l);
    (void)in_parts(b, csf->leaf_count, PART_NODES_MIN, lay_out_other_points, &l);
    (void)in_parts(b, csf->point_count, PART_MIN, find_points, &l);
    return SC_OK;
}

static sc_status prepare(builder *b, const uint32_t *order, sc_csf *csf)
{
    uint32_t i, level_count = b->xbvh->level_count, contour, *parent;
    sc_status status;
    parent = (uint32_t *)sc_scratch_take(b->scratch, b->xbvh->leaf_count, sizeof *parent);
    b->levels =
        (contour_level *)sc_scratch_take_filled(b->scratch, level_count, sizeof *b->levels, 0);
    b->node_place = (uint32_t *)sc_scratch_take(b->scratch, (uint64_t)b->sctt->node_count + 1,
                                                sizeof(uint32_t));
    csf->level_segments = (uint32_t *)sc_scratch_take(b->scratch, level_count, sizeof(uint32_t));
    if (!parent || !b->levels || !b->node_place || !csf->level_segments) return SC_ERROR_MEMORY;
    status = collect_leaves(b, order, &b->levels[level_count - 1]);
    if (status) return status;
    contour = b->levels[level_count - 1].count;
    b->kept = b->run_out = (uint32_t *)sc_scratch_take(b->scratch, contour, sizeof(uint32_t));
    if (!b->kept) return SC_ERROR_MEMORY;
    for (i = level_count - 1; !status && i-- > 0;) status = collect_level(b, i, parent);
    if (status) return status;
    sc_scratch_give(b->scratch, parent);
    b->run_segment = (uint32_t *)sc_scratch_take(b->scratch, contour, sizeof(uint32_t));
    b->patch_first = (uint32_t *)sc_scratch_take(b->scratch, (uint64_t)b->xbvh->leaf_count + 1,
                                                 sizeof(uint32_t));
    return b->run_segment && b->patch_first ? SC_OK : SC_ERROR_MEMORY;
}

static void give_back(builder *b)
{
    give_level(b->scratch, &b->levels[0]);
    sc_scratch_give(b->scratch, b->levels);
    sc_scratch_give(b->scratch, b->run_out);
    sc_scratch_give(b->scratch, b->run_segment);
    sc_scratch_give(b->scratch, b->patch_first);
    sc_scratch_give(b->scratch, b->points_first.items);
    sc_scratch_give(b->scratch, b->half_edges.items);
}

sc_status sc_csf_build(const sc_points *points, const sc_adjacency *adjacency,
                       const uint32_t *order, const sc_xbvh *xbvh, const sc_sctt *sctt,
                       sc_scratch *scratch, sc_csf *csf)
{
    builder b;
    uint32_t level;
    sc_status status;
    memset(&b, 0, sizeof b);
    b.points = points;
    b.adjacency = adjacency;
    b.xbvh = xbvh;
    b.sctt = sctt;
    b.scratch = scratch;
    status = prepare(&b, order, csf);
    if (status) return status;
    if (!reserve_lists(&b, SEGMENTS_A_NODE * (uint64_t)sctt->node_count)) return SC_ERROR_MEMORY;
    for (level = 0; level < xbvh->level_count; level++) { /* cuts go down */
        status = find_starts(&b, &b.levels[level], level ? &b.levels[level - 1] : NULL);
        if (status) return status;
    }
    for (level = xbvh->level_count; level-- > 0;) { /* segments grow up */
        status = build_level(&b, level, csf);
        if (status) return status;
    }
    csf->segment_count = b.leaf_segments + (uint32_t)b.child_first.count;
    if (!sc_list_reserve(scratch, &b.child_first, 1) ||
        !sc_list_reserve(scratch, &b.half_edges, 1) || !sc_list_reserve(scratch, &b.children, 1))
        return SC_ERROR_MEMORY;
    sc_list_add(&b.points_first, (uint32_t)b.half_edges.count); /* see reserve_for_leaves */
    sc_list_add(&b.child_first, (uint32_t)b.children.count);
    csf->child_first = b.child_first.items;
    csf->children = b.children.items;
    status = lay_out_points(&b, csf);
    if (status) return status;
    status = place_contours(&b, csf);
    give_back(&b);
    return status;
}

int sc_csf_validate(const sc_csf *csf, const sc_sctt *sctt, sc_scratch *scratch)
{
    uint32_t s, i, n;
    uint8_t *has_parent = (uint8_t *)sc_scratch_take_filled(scratch, csf->segment_count, 1, 0);
    if (!has_parent) return 0;
    for (s = 0; s < csf->segment_count; s++)
        if (csf->point_first[s] >= csf->point_last[s] || csf->point_last[s] >= csf->point_count)
            return 0;
    for (s = csf->leaf_count; s < csf->segment_count; s++) {
        const uint32_t *first = csf->child_first + (s - csf->leaf_count);
        uint32_t at = csf->point_first[s];
        if (first[1] < first[0] + 2) return 0;
        for (i = first[0]; i < first[1]; i++) {
            uint32_t child = csf->children[i];
            if (child >= s || has_parent[child] || csf->point_first[child] != at) return 0;
            has_parent[child] = 1;
            at = csf->point_last[child];
        }
        if (at != csf->point_last[s]) return 0;
    }
    for (n = 0; n < sctt->node_count; n++) {
        uint32_t skip = sctt->touch[n] == SC_NONE ? 0 : 2;
        if (csf->contour_first[n] + skip > csf->contour_first[n + 1]) return 0;
        for (i = csf->contour_first[n] + skip; i < csf->contour_first[n + 1]; i++)
            if (csf->contours[i] >= csf->segment_count) return 0;
    }
    sc_scratch_give(scratch, has_parent);
    return 1;
}
