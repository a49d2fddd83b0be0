/*
 * Triangles of edges, and branches of crossings. See sheets.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "trace/sheets.h"

#include <inttypes.h>

#include "base/hooks.h"
#include "base/jobs.h"
#include "base/sort.h"

/* Triangles of the shortest part that is looked through by itself. */
enum { PART_PLACES_MIN = 5000 };

/* The edges that cross, by their lower ends, and the triangles that have them. */
typedef struct crossing_edges {
    const sc_trace_subject *subject;
    uint32_t count;
    sc_pair *ends;     /* of each edge, the lower one first */
    uint32_t *first;   /* vertex_count + 1: edges with lower end v are first[v] to first[v + 1] */
    sc_pair *by_end;   /* of these, the upper end and the number */
    uint8_t *is_end;   /* vertex_count: whether an edge ends there */
    uint32_t *place;   /* of each part, from its first on: places that may have an edge */
    sc_pair *triangle; /* of edges, and triangles that have them */
    uint64_t total;    /* how many these are */
    uint32_t found[SC_JOBS_PARTS], begin[SC_JOBS_PARTS]; /* places of each part, and its first */
    uint64_t to[SC_JOBS_PARTS];                          /* where each part writes */
} crossing_edges;

/* The number of the edge between two vertices, or SC_NONE. */
static uint32_t find_edge(const crossing_edges *e, uint32_t u, uint32_t v)
{
    const uint32_t low = u < v ? u : v, high = u < v ? v : u;
    uint32_t i;
    for (i = e->first[low]; i < e->first[low + 1]; i++)
        if (e->by_end[i].a == high) return e->by_end[i].b;
    return SC_NONE;
}

/* Sorts edges by their lower ends. */
static void sort_crossing_edges(crossing_edges *e)
{
    const uint32_t vertices = e->subject->model->vertex_count;
    uint32_t i, v;
    for (i = 0; i < e->count; i++) e->first[e->ends[i].a + 1]++;
    for (v = 0; v < vertices; v++) e->first[v + 1] += e->first[v];
    for (i = e->count; i-- > 0;) { /* fills each list from its end, which moves to its begin */
        const uint32_t at = --e->first[e->ends[i].a + 1];
        e->by_end[at].a = e->ends[i].b;
        e->by_end[at].b = i;
    }
    for (v = 0; v < vertices; v++) e->first[v] = e->first[v + 1];
    e->first[vertices] = e->count;
}

/* Lists the edges of crossings, which are sorted by them. */
static sc_status list_crossing_edges(crossing_edges *e, const sc_pair *crossings, uint32_t count,
                                     sc_scratch *scratch)
{
    const uint32_t vertices = e->subject->model->vertex_count;
    uint32_t i, low, ends[2];
    e->ends = (sc_pair *)sc_scratch_take(scratch, count, sizeof *e->ends);
    e->by_end = (sc_pair *)sc_scratch_take(scratch, count, sizeof *e->by_end);
    e->first =
        (uint32_t *)sc_scratch_take_filled(scratch, (uint64_t)vertices + 1, sizeof *e->first, 0);
    e->is_end = (uint8_t *)sc_scratch_take_filled(scratch, vertices, 1, 0);
    if (!e->ends || !e->by_end || !e->first || !e->is_end) return SC_ERROR_MEMORY;
    for (e->count = i = 0; i < count; i++) {
        if (i > 0 && crossings[i].a == crossings[i - 1].a) continue;
        sc_trace_ends(e->subject->model, crossings[i].a, ends);
        low = ends[0] < ends[1] ? 0 : 1;
        e->ends[e->count].a = ends[low];
        e->ends[e->count++].b = ends[1 - low];
        e->is_end[ends[0]] = e->is_end[ends[1]] = 1;
    }
    sort_crossing_edges(e);
    return SC_OK;
}

/* Lists the places that have two corners at which edges end. */
static void find_some_places(void *context, uint32_t part, uint32_t first, uint32_t end)
{
    crossing_edges *e = (crossing_edges *)context;
    const uint32_t *corner = sc_model_triangle(e->subject->model) + 3 * (uint64_t)first;
    uint32_t i, count = 0;
    for (i = first; i < end; i++, corner += 3) { /* without branches */
        e->place[first + count] = i;
        count += e->is_end[corner[0]] + e->is_end[corner[1]] + e->is_end[corner[2]] >= 2;
    }
    e->begin[part] = first;
    e->found[part] = count;
}

/* Of these the edges; how many there are instead of how many places. */
static void find_some_sides(void *context, uint32_t part, uint32_t worker)
{
    crossing_edges *e = (crossing_edges *)context;
    const uint32_t *triangle = sc_model_triangle(e->subject->model);
    const uint32_t *id = sc_model_triangle_id(e->subject->model);
    const uint32_t *place = e->place + e->begin[part];
    sc_pair *to = e->triangle + e->to[part];
    uint32_t i, k, count = 0;
    (void)worker;
    for (i = 0; i < e->found[part]; i++) {
        const uint32_t *corner = triangle + 3 * (uint64_t)place[i];
        if (sc_trace_is_collapsed(corner)) continue;
        for (k = 0; k < 3; k++) {
            const uint32_t edge = find_edge(e, corner[k], corner[k < 2 ? k + 1 : 0]);
            if (edge == SC_NONE) continue;
            to[count].a = edge;
            to[count++].b = id[place[i]];
        }
    }
    e->found[part] = count;
}

/* Lists which triangles have which edges. */
static sc_status list_triangles(crossing_edges *e, sc_scratch *scratch)
{
    const uint32_t triangles = e->subject->model->triangle_count;
    uint64_t room = 0;
    uint32_t parts, part;
    e->place = (uint32_t *)sc_scratch_take(scratch, triangles, sizeof *e->place);
    if (!e->place) return SC_ERROR_MEMORY;
    parts = sc_jobs_loop(scratch->tasks, triangles, PART_PLACES_MIN, find_some_places, e);
    for (part = 0; part < parts; part++) {
        e->to[part] = room;
        room += 3 * (uint64_t)e->found[part];
    }
    e->triangle = (sc_pair *)sc_scratch_take(scratch, room, sizeof *e->triangle);
    if (!e->triangle) return SC_ERROR_MEMORY;
    sc_jobs_run(scratch->tasks, parts, find_some_sides, e);
    sc_scratch_give(scratch, e->place);
    for (e->total = part = 0; part < parts; part++) {
        memmove(e->triangle + e->total, e->triangle + e->to[part],
                e->found[part] * sizeof *e->triangle);
        e->total += e->found[part];
    }
    return SC_OK;
}

static void give_edges(sc_scratch *scratch, const crossing_edges *e)
{
    sc_scratch_give(scratch, e->triangle);
    sc_scratch_give(scratch, e->is_end);
    sc_scratch_give(scratch, e->first);
    sc_scratch_give(scratch, e->by_end);
    sc_scratch_give(scratch, e->ends);
}

/* Sorts triangles by edges, each edge's in ascending order; returns where those of each edge begin,
   or NULL if there is no memory. */
static uint32_t *sort_triangles(crossing_edges *e, sc_scratch *scratch)
{
    uint32_t *first =
        (uint32_t *)sc_scratch_take_filled(scratch, (uint64_t)e->count + 1, sizeof *first, 0);
    sc_pair *sorted = (sc_pair *)sc_scratch_take(scratch, e->total, sizeof *sorted);
    uint32_t edge;
    uint64_t i;
    if (!first || !sorted) return NULL;
    for (i = 0; i < e->total; i++) first[e->triangle[i].a + 1]++;
    for (edge = 0; edge < e->count; edge++) first[edge + 1] += first[edge];
    for (i = e->total; i-- > 0;) sorted[--first[e->triangle[i].a + 1]] = e->triangle[i];
    for (edge = 0; edge < e->count; edge++) first[edge] = first[edge + 1];
    first[edge] = (uint32_t)e->total;
    for (edge = 0; edge < e->count; edge++)
        sc_sort_pairs(sorted + first[edge], first[edge + 1] - first[edge]);
    sc_scratch_give(scratch, e->triangle);
    e->triangle = sorted;
    return first;
}

/* Gives each crossing a branch for each triangle of its edge. */
static sc_status list_branches(sc_sheets *s, crossing_edges *t, sc_scratch *scratch)
{
    const uint32_t *of_edge = sort_triangles(t, scratch);
    uint64_t total = 0;
    uint32_t i, edge = 0, at, branch = 0;
    s->first = (uint32_t *)sc_scratch_take(scratch, (uint64_t)s->count + 1, sizeof *s->first);
    if (!of_edge || !s->first) return SC_ERROR_MEMORY;
    for (i = 0; i < s->count; i++) {
        edge += i > 0 && s->crossings[i].a != s->crossings[i - 1].a;
        s->first[i] = (uint32_t)total;
        total += of_edge[edge + 1] - of_edge[edge];
        if (total > UINT32_MAX / 2) return SC_ERROR_COUNT;
    }
    s->first[i] = (uint32_t)total;
    s->triangle = (uint32_t *)sc_scratch_take(scratch, total, sizeof *s->triangle);
    s->crossing = (uint32_t *)sc_scratch_take(scratch, total, sizeof *s->crossing);
    s->other = (uint32_t *)sc_scratch_take(scratch, total, sizeof *s->other);
    if (!s->triangle || !s->crossing || !s->other) return SC_ERROR_MEMORY;
    for (edge = i = 0; i < s->count; i++) {
        edge += i > 0 && s->crossings[i].a != s->crossings[i - 1].a;
        for (at = of_edge[edge]; at < of_edge[edge + 1]; at++, branch++) {
            s->triangle[branch] = t->triangle[at].b;
            s->crossing[branch] = i;
        }
    }
    return SC_OK;
}

/* The triangles whose segment a branch begins. */
static sc_pair segment_of(const sc_sheets *s, uint32_t branch)
{
    const uint32_t t = s->triangle[branch], u = s->crossings[s->crossing[branch]].b;
    sc_pair pair;
    pair.a = t < u ? t : u;
    pair.b = t < u ? u : t;
    return pair;
}

uint32_t sc_sheets_shared_vertex(const sc_model *model, uint32_t a, uint32_t b)
{
    const uint32_t *p = sc_trace_corners(model, a), *q = sc_trace_corners(model, b);
    uint32_t i, k, shared = SC_NONE, count = 0;
    for (i = 0; i < 3; i++)
        for (k = 0; k < 3; k++)
            if (p[i] == q[k]) {
                shared = p[i];
                count++;
            }
    return count == 1 ? shared : SC_NONE;
}

/* Joins the branches of one segment, of which they are the ends; or one end is a vertex. */
static int join_segment(const sc_trace_subject *subject, sc_sheets *s, const sc_pair *branches,
                        uint64_t count)
{
    const sc_pair segment = segment_of(s, branches[0].b);
    if (count == 2) {
        s->other[branches[0].b] = branches[1].b;
        s->other[branches[1].b] = branches[0].b;
        return 1;
    }
    s->other[branches[0].b] = SC_NONE;
    if (count == 1 && sc_sheets_shared_vertex(subject->model, segment.a, segment.b) != SC_NONE)
        return 1;
    sc_hooks_log(subject->hooks, SC_LOG_ERROR,
                 "pairs lack an end of what triangles %" PRIu32 " and %" PRIu32 " have in common",
                 segment.a, segment.b);
    return 0;
}

/* Joins branches of which the lower triangle is the same, by the other one: the first of each
   pair. */
static int join_some(const sc_trace_subject *subject, sc_sheets *s, sc_pair *branches,
                     uint64_t count)
{
    uint64_t i, end;
    sc_sort_pairs(branches, count);
    for (i = 0; i < count; i = end) {
        for (end = i + 1; end < count && branches[end].a == branches[i].a;) end++;
        if (!join_segment(subject, s, branches + i, end - i)) return 0;
    }
    return 1;
}

static sc_status join_branches(const sc_trace_subject *subject, sc_sheets *s, sc_scratch *scratch)
{
    const uint32_t triangles = subject->model->triangle_count, count = s->first[s->count];
    sc_pair *list = (sc_pair *)sc_scratch_take(scratch, count, sizeof *list);
    uint32_t *first =
        (uint32_t *)sc_scratch_take_filled(scratch, (uint64_t)triangles + 1, sizeof *first, 0);
    uint32_t i;
    if (!list || !first) return SC_ERROR_MEMORY;
    for (i = 0; i < count; i++) first[segment_of(s, i).a + 1]++;
    for (i = 0; i < triangles; i++) first[i + 1] += first[i];
    for (i = 0; i < count; i++) { /* afterwards first[t] is where those of t end */
        const sc_pair segment = segment_of(s, i);
        const uint32_t at = first[segment.a]++;
        list[at].a = segment.b;
        list[at].b = i;
    }
    for (i = 0; i < triangles; i++) {
        const uint32_t begin = i ? first[i - 1] : 0;
        if (first[i] > begin && !join_some(subject, s, list + begin, first[i] - begin))
            return SC_ERROR_PAIRS;
    }
    sc_scratch_give(scratch, first);
    sc_scratch_give(scratch, list);
    return SC_OK;
}

sc_status sc_sheets_find(const sc_trace_subject *subject, const sc_pair *crossings, uint32_t count,
                         sc_scratch *scratch, sc_sheets *sheets)
{
    crossing_edges edges;
    sc_status status;
    memset(sheets, 0, sizeof *sheets);
    sheets->crossings = crossings;
    sheets->count = count;
    memset(&edges, 0, sizeof edges);
    edges.subject = subject;
    status = list_crossing_edges(&edges, crossings, count, scratch);
    if (!status) status = list_triangles(&edges, scratch);
    if (!status) status = list_branches(sheets, &edges, scratch);
    give_edges(scratch, &edges);
    if (!status && sc_trace_is_cancelled(subject)) status = SC_ERROR_INCOMPLETE;
    return status ? status : join_branches(subject, sheets, scratch);
}
