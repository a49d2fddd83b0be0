/*
 * See step_check.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "step_check.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "harness.h"
#include "oracle.h"

static const uint32_t methods[] = {SC_STEP_METHOD_SCTT, SC_STEP_METHOD_SCTT,
                                   SC_STEP_METHOD_TWO_BOXES, SC_STEP_METHOD_SWEPT};
enum { METHODS = 4 };

static void add(timed_list *list, uint32_t a, uint32_t b, double time)
{
    if (list->count == list->room) {
        list->room = 2 * list->room + 16;
        list->pairs = (sc_pair *)realloc(list->pairs, (size_t)list->room * sizeof(sc_pair));
        list->times = (double *)realloc(list->times, (size_t)list->room * sizeof(double));
        if (!list->pairs || !list->times) abort();
    }
    list->pairs[list->count].a = a;
    list->pairs[list->count].b = b;
    list->times[list->count++] = time;
}

void step_free_lists(timed_list lists[STEP_KINDS])
{
    for (int i = 0; i < STEP_KINDS; ++i) {
        free(lists[i].pairs);
        free(lists[i].times);
    }
}

static void take_point(const double *from, uint32_t v, double to[3])
{
    memcpy(to, from + 3 * (size_t)v, 3 * sizeof(double));
}

typedef struct edge {
    uint32_t a, b, name;
} edge;

/* The edges of a welded soup: each by the first triangle and side that has it. */
static edge *edges_of(const soup *s, const uint32_t *weld, uint32_t *count)
{
    edge *edges = (edge *)test_allocate(3 * (size_t)s->triangle_count * sizeof(edge));
    *count = 0;
    for (uint32_t i = 0; i < 3 * s->triangle_count; ++i) {
        uint32_t a = weld[s->triangles[i]], b = weld[s->triangles[i - i % 3 + (i % 3 + 1) % 3]], j;
        if (a == b) continue;
        for (j = 0; j < *count; ++j)
            if ((edges[j].a == a && edges[j].b == b) || (edges[j].a == b && edges[j].b == a)) break;
        if (j < *count) continue;
        edges[*count].a = a;
        edges[*count].b = b;
        edges[(*count)++].name = i;
    }
    return edges;
}

void step_solve(const soup *s, const double *start, const double *end,
                const sc_impact_limits *limits, timed_list lists[STEP_KINDS])
{
    uint32_t *weld = (uint32_t *)test_allocate(s->vertex_count * sizeof(uint32_t)), count;
    uint8_t *used = (uint8_t *)calloc(s->vertex_count, 1);
    double from[4][3], to[4][3], time;
    const double(*f)[3] = (const double(*)[3])from, (*t)[3] = (const double(*)[3])to;
    edge *edges;
    memset(lists, 0, STEP_KINDS * sizeof(timed_list));
    oracle_weld(s->positions, s->vertex_count, s->triangles, s->triangle_count, weld);
    for (uint32_t i = 0; i < 3 * s->triangle_count; ++i) used[weld[s->triangles[i]]] = 1;
    edges = edges_of(s, weld, &count);
    for (uint32_t v = 0; v < s->vertex_count; ++v)
        for (uint32_t i = 0; used[v] && i < s->triangle_count; ++i) {
            int corner = 0;
            take_point(start, v, from[0]);
            take_point(end, v, to[0]);
            for (uint32_t k = 0; k < 3; ++k) {
                uint32_t c = weld[s->triangles[3 * i + k]];
                corner |= c == v;
                take_point(start, c, from[k + 1]);
                take_point(end, c, to[k + 1]);
            }
            if (!corner && sc_impact_vertex_face(f, t, limits, &time)) add(&lists[0], v, i, time);
        }
    for (uint32_t i = 0; i < count; ++i)
        for (uint32_t j = i + 1; j < count; ++j) {
            const edge *x = &edges[i], *y = &edges[j];
            if (x->a == y->a || x->a == y->b || x->b == y->a || x->b == y->b) continue;
            take_point(start, x->a, from[0]);
            take_point(start, x->b, from[1]);
            take_point(start, y->a, from[2]);
            take_point(start, y->b, from[3]);
            take_point(end, x->a, to[0]);
            take_point(end, x->b, to[1]);
            take_point(end, y->a, to[2]);
            take_point(end, y->b, to[3]);
            if (sc_impact_edge_edge(f, t, limits, &time)) add(&lists[1], x->name, y->name, time);
        }
    free(weld);
    free(used);
    free(edges);
}

int step_open(step_subject *s, const soup *mesh, const sc_build_options *options)
{
    sc_mesh m = input_plain_mesh(mesh);
    sc_workspace_options w;
    s->model = NULL;
    s->workspace = NULL;
    memset(&w, 0, sizeof(w));
    w.struct_size = sizeof(w);
    w.flags = SC_WORKSPACE_STEP;
    return CHECK(sc_build(&m, options, &s->model) == SC_OK) &&
           CHECK(sc_workspace_create_for(s->model, &w, &s->workspace) == SC_OK);
}

void step_close(step_subject *s)
{
    sc_workspace_free(s->workspace);
    sc_model_free(s->model);
}

sc_step_options step_plain_options(void)
{
    sc_step_options o;
    memset(&o, 0, sizeof(o));
    o.struct_size = sizeof(o);
    return o;
}

step_answer step_make_answer(uint64_t capacity)
{
    step_answer a;
    memset(&a, 0, sizeof(a));
    a.result.struct_size = sizeof(a.result);
    a.result.vertex_face_capacity = a.result.edge_edge_capacity = capacity;
    a.result.vertex_faces = (sc_pair *)test_allocate((size_t)capacity * sizeof(sc_pair));
    a.result.edge_edges = (sc_pair *)test_allocate((size_t)capacity * sizeof(sc_pair));
    a.result.vertex_face_times = (double *)test_allocate((size_t)capacity * sizeof(double));
    a.result.edge_edge_times = (double *)test_allocate((size_t)capacity * sizeof(double));
    return a;
}

void step_free_answer(step_answer *a)
{
    free(a->result.vertex_faces);
    free(a->result.edge_edges);
    free(a->result.vertex_face_times);
    free(a->result.edge_edge_times);
}

static int same_list(const timed_list *wanted, uint64_t count, const sc_pair *pairs,
                     const double *times)
{
    if (count != wanted->count) return 0;
    return count == 0 || (memcmp(pairs, wanted->pairs, (size_t)count * sizeof(sc_pair)) == 0 &&
                          memcmp(times, wanted->times, (size_t)count * sizeof(double)) == 0);
}

/* Whether every pair of a sorted list is in another. */
static int holds_all(const timed_list *wanted, uint64_t count, const sc_pair *pairs)
{
    uint64_t j = 0;
    for (uint64_t i = 0; i < wanted->count; ++i) {
        while (j < count && (pairs[j].a != wanted->pairs[i].a || pairs[j].b != wanted->pairs[i].b))
            ++j;
        if (j == count) return 0;
    }
    return 1;
}

/* Whether both have the same candidates, as far as there is room for them. */
static int same_candidates(const step_answer *a, const step_answer *b)
{
    const sc_step_result *x = &a->result, *y = &b->result;
    const uint64_t v = x->vertex_face_count, e = x->edge_edge_count;
    if (v != y->vertex_face_count || e != y->edge_edge_count) return 0;
    return v > x->vertex_face_capacity || e > x->edge_edge_capacity ||
           ((v == 0 ||
             memcmp(x->vertex_faces, y->vertex_faces, (size_t)v * sizeof(sc_pair)) == 0) &&
            (e == 0 || memcmp(x->edge_edges, y->edge_edges, (size_t)e * sizeof(sc_pair)) == 0));
}

/* One method on one step: collisions with their times, then candidates, which a gets. Returns -1 if
   this machine does not have the instruction set. */
static int check_method(step_subject *s, const sc_pose poses[2], sc_step_options o,
                        const timed_list lists[STEP_KINDS], const char *what, step_answer *a)
{
    double earliest = 1;
    sc_status status;
    int good;
    for (int kind = 0; kind < STEP_KINDS; ++kind)
        for (uint64_t i = 0; i < lists[kind].count; ++i)
            if (lists[kind].times[i] < earliest) earliest = lists[kind].times[i];
    status = sc_query_step(s->model, s->workspace, &poses[0], &poses[1], &o, &a->result);
    if (status == SC_ERROR_UNSUPPORTED) return -1;
    good = CHECK_MSG(status == SC_OK, "%s: status %d", what, (int)status) &&
           CHECK_MSG(same_list(&lists[0], a->result.vertex_face_count, a->result.vertex_faces,
                               a->result.vertex_face_times),
                     "%s, method %u, contour %u: %" PRIu64 " vertex-face pairs of %" PRIu64, what,
                     o.method, o.contour, a->result.vertex_face_count, lists[0].count) &&
           CHECK_MSG(same_list(&lists[1], a->result.edge_edge_count, a->result.edge_edges,
                               a->result.edge_edge_times),
                     "%s, method %u, contour %u: %" PRIu64 " edge-edge pairs of %" PRIu64, what,
                     o.method, o.contour, a->result.edge_edge_count, lists[1].count) &&
           CHECK_MSG(a->result.earliest == earliest, "%s: earliest %.17g, not %.17g", what,
                     a->result.earliest, earliest);
    o.pairs = SC_STEP_CANDIDATES;
    status = sc_query_step(s->model, s->workspace, &poses[0], &poses[1], &o, &a->result);
    if (status == SC_ERROR_SHORT_BUFFER) return good;
    return good & CHECK(status == SC_OK) &
           CHECK_MSG(holds_all(&lists[0], a->result.vertex_face_count, a->result.vertex_faces) &&
                         holds_all(&lists[1], a->result.edge_edge_count, a->result.edge_edges),
                     "%s, method %u: candidates lack a collision", what, o.method);
}

int step_check_methods(const soup *mesh, step_subject *s, const double *start, const double *end,
                       const sc_impact_limits *limits, const timed_list lists[STEP_KINDS],
                       const char *what)
{
    const sc_pose poses[2] = {input_plain_pose(start, mesh->vertex_count),
                              input_plain_pose(end, mesh->vertex_count)};
    const uint64_t room = lists[0].count + lists[1].count + 5000;
    int good = 1;
    for (uint32_t i = 0; i < METHODS && good; ++i) {
        step_answer base = step_make_answer(room);
        for (uint32_t simd = SC_SIMD_BASE; simd <= SC_SIMD_AVX512 && good; ++simd) {
            step_answer other = simd == SC_SIMD_BASE ? base : step_make_answer(room);
            sc_step_options o = step_plain_options();
            int result;
            o.method = methods[i];
            o.simd = simd;
            if (i == 1) o.contour = SC_CONTOUR_STAR;
            o.times = SC_STEP_TIMES_EACH;
            o.separation = limits->separation;
            o.tolerance = limits->tolerance;
            result = check_method(s, poses, o, lists, what, &other);
            good = result != 0;
            if (simd == SC_SIMD_BASE)
                base = other;
            else if (result > 0)
                good = CHECK_MSG(same_candidates(&base, &other),
                                 "%s, method %u: candidates differ by instruction set", what,
                                 o.method);
            if (simd != SC_SIMD_BASE) step_free_answer(&other);
        }
        step_free_answer(&base);
    }
    return good;
}

void step_check(const soup *mesh, const double *start, const double *end,
                const sc_impact_limits *limits, const char *what)
{
    timed_list lists[STEP_KINDS];
    input_choices choices = input_choose(mesh, SC_WELD_REST, test_random_below(4));
    step_subject s;
    step_solve(mesh, start, end, limits, lists);
    if (step_open(&s, mesh, &choices.options))
        step_check_methods(mesh, &s, start, end, limits, lists, what);
    step_close(&s);
    step_free_lists(lists);
    input_free_choices(&choices);
}
