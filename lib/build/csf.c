/*
 * The contour segment forest. See csf.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "build/csf.h"

#include <string.h>

#include "base/assume.h"
#include "build/chains.h"
#include "build/contour_edges.h"

/* Room for the lists of nodes, so that it seldom has to grow. */
enum { SEGMENTS_A_NODE = 10 };

/* Loops over nodes and segments are cut into parts of so many at least. */
enum { PART_NODES_MIN = 1024 };

typedef struct builder {
    const sc_points *points;
    const sc_adjacency *adjacency;
    const sc_xbvh *xbvh;
    const sc_sctt *sctt;
    sc_scratch *scratch;
    sc_contour_level *levels; /* level_count */
    uint32_t leaf_segments;   /* of the last level */
    sc_list points_first, half_edges, child_first, children;
    /* Node lists, written from the end of their room, the last node's first; how much of it is in
       use; and of each node, how much was then. */
    uint32_t *lists, *node_place; /* room; node_count + 1 */
    uint64_t room, listed;
    /* The runs of the level at hand, which are in the order of their patches, and where those of
       each begin. */
    uint32_t *run_out, *run_segment, *patch_first;
    /* For the parts of loops: the level at hand, and its number; of each part, how much it has of
       what is counted, and then how much those before it have. */
    sc_contour_level *level;
    uint32_t number;
    uint64_t counts[SC_JOBS_PARTS + 1], segments_of[SC_JOBS_PARTS + 1],
        children_of[SC_JOBS_PARTS + 1];
} builder;

/* Writes the half-edges of a run and one that starts at its last point; returns their number. */
static uint32_t list_leaf_segment(sc_contour_level *level, uint32_t start, uint32_t *half_edges)
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
static uint32_t list_children(sc_contour_level *level, const sc_contour_level *below,
                              uint32_t start, uint32_t *children)
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
    const sc_contour_level *level = b->level;
    uint32_t e, runs = 0;
    first = sc_contour_patch_begin(level, first);
    end = sc_contour_patch_begin(level, end);
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
    first = sc_contour_patch_begin(b->level, first);
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
    sc_contour_level *level = b->level;
    uint32_t i, stop = (uint32_t)b->counts[part + 1], segments = 0, count = 0, *children;
    (void)end;
    first = sc_contour_patch_begin(level, first);
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
    sc_contour_level *level = b->level;
    uint32_t i, stop = (uint32_t)b->counts[part + 1];
    uint64_t segment = b->child_first.count + b->segments_of[part];
    uint64_t child = b->children.count + b->children_of[part];
    uint64_t count = b->children_of[part + 1] - b->children_of[part];
    (void)end;
    if (count == 0) return;
    first = sc_contour_patch_begin(level, first);
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
    const sc_contour_level *level = b->level;
    uint32_t i, stop = (uint32_t)b->counts[part + 1], begin = b->xbvh->level_first[b->number];
    uint32_t patch;
    (void)end;
    first = sc_contour_patch_begin(level, first);
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
    sc_contour_level *level = b->level = &b->levels[number];
    uint32_t parts, runs, patch,
        last = b->xbvh->level_count - 1, count = level->count, begin = b->xbvh->level_first[number],
        nodes = b->sctt->level_first[number + 1] - b->sctt->level_first[number];
    b->number = number;
    level->segment = (uint32_t *)sc_scratch_take(b->scratch, count, sizeof(uint32_t));
    level->end = (uint32_t *)sc_scratch_take(b->scratch, count, sizeof(uint32_t));
    if (!level->segment || !level->end) return SC_ERROR_MEMORY;
    parts = sc_contour_parts(b->scratch, count, SC_CONTOUR_PART_MIN, count_runs, b);
    runs = (uint32_t)sc_contour_add_up(b->counts, parts);
    csf->level_segments[number] = runs;
    if (number == last) {
        if (!reserve_for_leaves(b, count, runs)) return SC_ERROR_MEMORY;
        (void)sc_contour_parts(b->scratch, count, SC_CONTOUR_PART_MIN, walk_leaf_runs, b);
        b->points_first.count = csf->leaf_count = b->leaf_segments = runs;
        b->half_edges.count = (uint64_t)count + runs;
    } else {
        uint64_t segments, children;
        (void)sc_contour_parts(b->scratch, count, SC_CONTOUR_PART_MIN, walk_parent_runs, b);
        segments = sc_contour_add_up(b->segments_of, parts);
        children = sc_contour_add_up(b->children_of, parts);
        if (!sc_list_reserve(b->scratch, &b->child_first, segments + 1) || /* and the end of all */
            !sc_list_reserve(b->scratch, &b->children, children))
            return SC_ERROR_MEMORY;
        (void)sc_contour_parts(b->scratch, count, SC_CONTOUR_PART_MIN, number_parents, b);
        b->child_first.count += segments;
        b->children.count += children;
        sc_contour_level_give(b->scratch, level + 1);
    }
    (void)sc_contour_parts(b->scratch, count, SC_CONTOUR_PART_MIN, finish_runs, b);
    patch = count ? level->inside[count - 1] + 1 : begin;
    while (patch < b->xbvh->level_first[number + 1]) b->patch_first[patch++ - begin] = runs;
    parts = sc_contour_parts(b->scratch, nodes, PART_NODES_MIN, measure_nodes, b);
    if (!reserve_lists(b, sc_contour_add_up(b->counts, parts))) return SC_ERROR_MEMORY;
    b->listed += b->counts[parts];
    (void)sc_contour_parts(b->scratch, nodes, PART_NODES_MIN, list_nodes, b);
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
    (void)sc_contour_parts(b->scratch, csf->leaf_count, PART_NODES_MIN, lay_out_last_points, &l);
    (void)sc_contour_parts(b->scratch, csf->leaf_count, PART_NODES_MIN, lay_out_other_points, &l);
    (void)sc_contour_parts(b->scratch, csf->point_count, SC_CONTOUR_PART_MIN, find_points, &l);
    return SC_OK;
}

static sc_status prepare(builder *b, const uint32_t *order, sc_csf *csf)
{
    uint32_t level_count = b->xbvh->level_count, contour;
    sc_status status;
    b->levels =
        (sc_contour_level *)sc_scratch_take_filled(b->scratch, level_count, sizeof *b->levels, 0);
    b->node_place = (uint32_t *)sc_scratch_take(b->scratch, (uint64_t)b->sctt->node_count + 1,
                                                sizeof(uint32_t));
    csf->level_segments = (uint32_t *)sc_scratch_take(b->scratch, level_count, sizeof(uint32_t));
    if (!b->levels || !b->node_place || !csf->level_segments) return SC_ERROR_MEMORY;
    status =
        sc_contour_edges_collect(b->points, b->adjacency, order, b->xbvh, b->scratch, b->levels);
    if (status) return status;
    contour = b->levels[level_count - 1].count;
    b->run_out = (uint32_t *)sc_scratch_take(b->scratch, contour, sizeof(uint32_t));
    b->run_segment = (uint32_t *)sc_scratch_take(b->scratch, contour, sizeof(uint32_t));
    b->patch_first = (uint32_t *)sc_scratch_take(b->scratch, (uint64_t)b->xbvh->leaf_count + 1,
                                                 sizeof(uint32_t));
    return b->run_out && b->run_segment && b->patch_first ? SC_OK : SC_ERROR_MEMORY;
}

static void give_back(builder *b)
{
    sc_contour_level_give(b->scratch, &b->levels[0]);
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
        status = sc_contour_edges_find_starts(points, scratch, &b.levels[level],
                                              level ? &b.levels[level - 1] : NULL);
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
