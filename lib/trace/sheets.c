/*
 * Triangles of edges, and branches of crossings. See sheets.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "trace/sheets.h"

#include <inttypes.h>

#include "base/assume.h"
#include "base/hooks.h"
#include "base/jobs.h"
#include "base/sort.h"
#include "trace/crossed_edges.h"

/* Triangles of the shortest part that is looked through by itself. */
enum { PART_PLACES_MIN = 5000 };

/* The edges that cross, and the triangles that have them. */
typedef struct edge_owners {
    const sc_trace_subject *subject;
    sc_crossed_edges edges;
    uint32_t *place;   /* of each part, from its first on: places that may have an edge */
    sc_pair *triangle; /* of edges, and triangles that have them */
    uint64_t total;    /* how many these are */
    uint32_t found[SC_JOBS_PARTS], begin[SC_JOBS_PARTS]; /* places of each part, and its first */
    uint64_t to[SC_JOBS_PARTS];                          /* where each part writes */
} edge_owners;

/* Lists the places that have two corners at which edges end. */
static void find_some_places(void *context, uint32_t part, uint32_t first, uint32_t end)
{
    edge_owners *e = (edge_owners *)context;
    const uint32_t *corner = sc_model_triangle(e->subject->model) + 3 * (uint64_t)first;
    uint32_t i, count = 0;
    for (i = first; i < end; i++, corner += 3) { /* without branches */
        e->place[first + count] = i;
        count +=
            e->edges.is_end[corner[0]] + e->edges.is_end[corner[1]] + e->edges.is_end[corner[2]] >=
            2;
    }
    e->begin[part] = first;
    e->found[part] = count;
}

/* Of these the edges; how many there are instead of how many places. */
static void find_some_sides(void *context, uint32_t part, uint32_t worker)
{
    edge_owners *e = (edge_owners *)context;
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
            const uint32_t edge =
                sc_crossed_edges_find(&e->edges, corner[k], corner[k < 2 ? k + 1 : 0]);
            if (edge == SC_NONE) continue;
            to[count].a = edge;
            to[count++].b = id[place[i]];
        }
    }
    e->found[part] = count;
}

/* Lists which triangles have which edges. */
static sc_status list_triangles(edge_owners *e, sc_scratch *scratch)
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

/* Sorts triangles by edges, each edge's in ascending order; returns where those of each edge begin,
   or NULL if there is no memory. */
static uint32_t *sort_triangles(edge_owners *e, sc_scratch *scratch)
{
    uint32_t *first =
        (uint32_t *)sc_scratch_take_filled(scratch, (uint64_t)e->edges.count + 1, sizeof *first, 0);
    sc_pair *sorted = (sc_pair *)sc_scratch_take(scratch, e->total, sizeof *sorted);
    uint32_t edge;
    uint64_t i;
    if (!first || !sorted) return NULL;
    for (i = 0; i < e->total; i++) first[e->triangle[i].a + 1]++;
    for (edge = 0; edge < e->edges.count; edge++) first[edge + 1] += first[edge];
    for (i = e->total; i-- > 0;) sorted[--first[e->triangle[i].a + 1]] = e->triangle[i];
    for (edge = 0; edge < e->edges.count; edge++) first[edge] = first[edge + 1];
    first[edge] = (uint32_t)e->total;
    for (edge = 0; edge < e->edges.count; edge++)
        sc_sort_pairs(sorted + first[edge], first[edge + 1] - first[edge]);
    sc_scratch_give(scratch, e->triangle);
    e->triangle = sorted;
    return first;
}

/* Gives each crossing a branch for each triangle of its edge. */
static sc_status list_branches(sc_sheets *s, edge_owners *t, sc_scratch *scratch)
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

/* Joins the branches of one segment, of which they are the ends; or one end is a vertex. There are
   not more than two: all cross, and of two names of one edge only the first has branches. */
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
    if (SC_ALWAYS(count == 1) &&
        sc_sheets_shared_vertex(subject->model, segment.a, segment.b) != SC_NONE)
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
    edge_owners owners;
    sc_status status;
    memset(sheets, 0, sizeof *sheets);
    sheets->crossings = crossings;
    sheets->count = count;
    memset(&owners, 0, sizeof owners);
    owners.subject = subject;
    status = sc_crossed_edges_list(subject, crossings, count, scratch, &owners.edges);
    if (!status) status = list_triangles(&owners, scratch);
    if (!status) status = list_branches(sheets, &owners, scratch);
    sc_scratch_give(scratch, owners.triangle);
    sc_crossed_edges_give(scratch, &owners.edges);
    if (!status && sc_trace_is_cancelled(subject)) status = SC_ERROR_INCOMPLETE;
    return status ? status : join_branches(subject, sheets, scratch);
}
