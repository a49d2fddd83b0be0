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

/* The edges that cross, found by their ends, and the triangles that have them. */
typedef struct edge_table {
    const sc_trace_subject *subject;
    uint32_t count;
    sc_pair *ends;     /* of each edge, the lower one first */
    uint32_t *slot;    /* size: 1 + the number of an edge that belongs here or in a slot before */
    uint64_t size;     /* a power of two */
    uint8_t *is_end;   /* of each vertex: whether an edge ends there */
    sc_pair *triangle; /* of edges and triangles that have them: those of each part */
    uint64_t begin[SC_JOBS_PARTS];
    uint32_t found[SC_JOBS_PARTS];
    int is_counted; /* there is room for what was found, which is to be written now */
} edge_table;

/* u < v */
static uint64_t slot_of(const edge_table *t, uint64_t u, uint64_t v)
{
    const uint64_t hash = (u * 0x9e3779b97f4a7c15u) ^ (v * 0xc2b2ae3d27d4eb4fu);
    return (hash ^ hash >> 32) & (t->size - 1);
}

/* The number of the edge between two vertices, or SC_NONE. */
static uint32_t find_edge(const edge_table *t, uint32_t u, uint32_t v)
{
    const uint32_t low = u < v ? u : v, high = u < v ? v : u;
    uint64_t at = slot_of(t, low, high);
    for (; t->slot[at]; at = (at + 1) & (t->size - 1)) {
        const sc_pair ends = t->ends[t->slot[at] - 1];
        if (ends.a == low && ends.b == high) return t->slot[at] - 1;
    }
    return SC_NONE;
}

/* Lists the edges of crossings, which are sorted by them. SC_ERROR_PAIRS: one has two names. */
static sc_status list_edges(edge_table *t, const sc_pair *crossings, uint32_t count,
                            sc_scratch *scratch)
{
    uint32_t i, low, ends[2];
    for (t->size = 16; t->size < 2 * (uint64_t)count;) t->size *= 2;
    t->ends = (sc_pair *)sc_scratch_take(scratch, count, sizeof *t->ends);
    t->slot = (uint32_t *)sc_scratch_take_filled(scratch, t->size, sizeof *t->slot, 0);
    t->is_end = (uint8_t *)sc_scratch_take_filled(scratch, t->subject->model->vertex_count, 1, 0);
    if (!t->ends || !t->slot || !t->is_end) return SC_ERROR_MEMORY;
    for (t->count = i = 0; i < count; i++) {
        uint64_t at;
        if (i > 0 && crossings[i].a == crossings[i - 1].a) continue;
        sc_trace_ends(t->subject->model, crossings[i].a, ends);
        if (find_edge(t, ends[0], ends[1]) != SC_NONE) {
            sc_hooks_log(t->subject->hooks, SC_LOG_ERROR, "pairs have two names of edge %" PRIu32,
                         crossings[i].a);
            return SC_ERROR_PAIRS;
        }
        low = ends[0] < ends[1] ? 0 : 1;
        t->ends[t->count].a = ends[low];
        t->ends[t->count++].b = ends[1 - low];
        at = slot_of(t, ends[low], ends[1 - low]);
        while (t->slot[at]) at = (at + 1) & (t->size - 1);
        t->slot[at] = t->count;
        t->is_end[ends[0]] = t->is_end[ends[1]] = 1;
    }
    return SC_OK;
}

static void look_at_places(void *context, uint32_t part, uint32_t first, uint32_t end)
{
    edge_table *t = (edge_table *)context;
    const uint32_t *corner = sc_model_triangle(t->subject->model) + 3 * (uint64_t)first;
    const uint32_t *id = sc_model_triangle_id(t->subject->model);
    uint32_t i, k, count = 0;
    for (i = first; i < end; i++, corner += 3) {
        if (t->is_end[corner[0]] + t->is_end[corner[1]] + t->is_end[corner[2]] < 2) continue;
        if (sc_trace_is_collapsed(corner)) continue;
        for (k = 0; k < 3; k++) {
            const uint32_t u = corner[k], v = corner[(k + 1) % 3];
            const uint32_t edge = t->is_end[u] && t->is_end[v] ? find_edge(t, u, v) : SC_NONE;
            if (edge == SC_NONE) continue;
            if (t->is_counted) {
                t->triangle[t->begin[part] + count].a = edge;
                t->triangle[t->begin[part] + count].b = id[i];
            }
            count++;
        }
    }
    t->found[part] = count;
}

/* Lists which triangles have which edges: sorted by the number of the edge, then that of the
   triangle. */
static sc_status list_triangles(edge_table *t, sc_scratch *scratch, uint64_t *total)
{
    const uint32_t triangles = t->subject->model->triangle_count;
    sc_pair *spare;
    uint32_t parts, part;
    t->is_counted = 0;
    parts = sc_jobs_loop(scratch->tasks, triangles, PART_PLACES_MIN, look_at_places, t);
    for (*total = part = 0; part < parts; part++) {
        t->begin[part] = *total;
        *total += t->found[part];
    }
    t->triangle = (sc_pair *)sc_scratch_take(scratch, *total, sizeof *t->triangle);
    spare = (sc_pair *)sc_scratch_take(scratch, *total, sizeof *spare);
    if (!t->triangle || !spare) return SC_ERROR_MEMORY;
    t->is_counted = 1;
    sc_jobs_loop(scratch->tasks, triangles, PART_PLACES_MIN, look_at_places, t);
    sc_sort_in_room(t->triangle, spare, *total, *total);
    sc_scratch_give(scratch, spare);
    return SC_OK;
}

static void give_table(sc_scratch *scratch, const edge_table *t)
{
    sc_scratch_give(scratch, t->triangle);
    sc_scratch_give(scratch, t->is_end);
    sc_scratch_give(scratch, t->slot);
    sc_scratch_give(scratch, t->ends);
}

/* Where the triangles of each edge begin among them; NULL if there is no memory. */
static uint32_t *index_triangles(const edge_table *t, uint64_t total, sc_scratch *scratch)
{
    uint32_t *first = (uint32_t *)sc_scratch_take(scratch, (uint64_t)t->count + 1, sizeof *first);
    uint32_t edge;
    uint64_t i = 0;
    for (edge = 0; first && edge <= t->count; edge++) {
        while (i < total && t->triangle[i].a < edge) i++;
        first[edge] = (uint32_t)i;
    }
    return first;
}

/* Gives each crossing a branch for each triangle of its edge. */
static sc_status list_branches(sc_sheets *s, const edge_table *t, uint64_t triangles,
                               sc_scratch *scratch)
{
    const uint32_t *of_edge = index_triangles(t, triangles, scratch);
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

/* Joins the branches of one segment. Two triangles that share a vertex have one crossing, others
   two: of the segment between them they are the ends. */
static int join_segment(const sc_trace_subject *subject, sc_sheets *s, const sc_pair *branches,
                        uint64_t count)
{
    const sc_pair segment = segment_of(s, branches[0].b);
    const int is_at_vertex =
        sc_sheets_shared_vertex(subject->model, segment.a, segment.b) != SC_NONE;
    if (count == (is_at_vertex ? 1 : 2)) {
        s->other[branches[0].b] = count == 1 ? SC_NONE : branches[1].b;
        if (count == 2) s->other[branches[1].b] = branches[0].b;
        return 1;
    }
    sc_hooks_log(subject->hooks, SC_LOG_ERROR,
                 "pairs lack an end of what triangles %" PRIu32 " and %" PRIu32 " have in common",
                 segment.a, segment.b);
    return 0;
}

/* Joins branches of which the lower triangle is the same. */
static int join_some(const sc_trace_subject *subject, sc_sheets *s, sc_pair *branches,
                     uint64_t count)
{
    uint64_t i, end;
    for (i = 0; i < count; i++) branches[i].a = segment_of(s, branches[i].b).b;
    sc_sort_pairs(branches, count);
    for (i = 0; i < count; i = end) {
        for (end = i + 1; end < count && branches[end].a == branches[i].a;) end++;
        if (!join_segment(subject, s, branches + i, end - i)) return 0;
    }
    return 1;
}

static sc_status join_branches(const sc_trace_subject *subject, sc_sheets *s, sc_scratch *scratch)
{
    const uint32_t count = s->first[s->count];
    sc_pair *list = (sc_pair *)sc_scratch_take(scratch, count, sizeof *list), *sorted;
    sc_pair *spare = (sc_pair *)sc_scratch_take(scratch, count, sizeof *spare);
    uint32_t i, end, lower;
    unsigned bits = 1;
    if (!list || !spare) return SC_ERROR_MEMORY;
    if (!count) return SC_OK;
    for (i = 0; i < count; i++) {
        list[i].a = segment_of(s, i).a;
        list[i].b = i;
    }
    while (bits < 32 && subject->model->triangle_count >> bits) bits++;
    sorted = sc_sort_by_digits(list, spare, count, bits, NULL, NULL);
    for (i = 0; i < count; i = end) {
        lower = sorted[i].a;
        for (end = i + 1; end < count && sorted[end].a == lower;) end++;
        if (!join_some(subject, s, sorted + i, end - i)) return SC_ERROR_PAIRS;
    }
    sc_scratch_give(scratch, spare);
    sc_scratch_give(scratch, list);
    return SC_OK;
}

sc_status sc_sheets_find(const sc_trace_subject *subject, const sc_pair *crossings, uint32_t count,
                         sc_scratch *scratch, sc_sheets *sheets)
{
    edge_table table;
    uint64_t triangles = 0;
    sc_status status;
    memset(sheets, 0, sizeof *sheets);
    sheets->crossings = crossings;
    sheets->count = count;
    memset(&table, 0, sizeof table);
    table.subject = subject;
    status = list_edges(&table, crossings, count, scratch);
    if (!status) status = list_triangles(&table, scratch, &triangles);
    if (!status) status = list_branches(sheets, &table, triangles, scratch);
    give_table(scratch, &table);
    if (!status && sc_trace_is_cancelled(subject)) status = SC_ERROR_INCOMPLETE;
    return status ? status : join_branches(subject, sheets, scratch);
}
