/*
 * See near_ask.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "near_ask.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "harness.h"
#include "near_oracle.h"

/* ---- asking ---- */

const near_way near_ways[NEAR_WAYS] = {
    {"default", SC_NEAR_METHOD_DEFAULT, SC_SIMD_BEST},
    {"sctt, base", SC_NEAR_METHOD_SCTT, SC_SIMD_BASE},
    {"sctt, avx2", SC_NEAR_METHOD_SCTT, SC_SIMD_AVX2},
    {"sctt, avx512", SC_NEAR_METHOD_SCTT, SC_SIMD_AVX512},
    {"boxes, base", SC_NEAR_METHOD_BOXES, SC_SIMD_BASE},
    {"boxes, avx2", SC_NEAR_METHOD_BOXES, SC_SIMD_AVX2},
    {"boxes, avx512", SC_NEAR_METHOD_BOXES, SC_SIMD_AVX512},
};

static const sc_pair guard_pair = {0xdeadbeefu, 0xfeedfaceu};

sc_near_options near_options_for(const near_way *w, double distance)
{
    sc_near_options options;
    memset(&options, 0, sizeof(options));
    options.struct_size = sizeof(options);
    options.method = w->method;
    options.simd = w->simd;
    options.distance = distance;
    return options;
}

sc_workspace *near_workspace(const sc_model *model, uint32_t workers)
{
    sc_workspace_options options;
    sc_workspace *workspace = NULL;
    memset(&options, 0, sizeof(options));
    options.struct_size = sizeof(options);
    options.flags = SC_WORKSPACE_NEAR;
    options.workers = workers;
    CHECK(sc_workspace_create_for(model, &options, &workspace) == SC_OK);
    return workspace;
}

near_answer near_ask(const near_question *q, const sc_near_options *options, uint64_t faces,
                     uint64_t edges)
{
    near_answer a;
    memset(&a, 0, sizeof(a));
    a.capacity[STEP_VERTEX_FACE] = faces;
    a.capacity[STEP_EDGE_EDGE] = edges;
    for (int kind = 0; kind < STEP_KINDS; ++kind) {
        a.pairs[kind] = (sc_pair *)test_allocate((a.capacity[kind] + 1) * sizeof(sc_pair));
        for (uint64_t i = 0; i <= a.capacity[kind]; ++i) a.pairs[kind][i] = guard_pair;
    }
    a.stats.struct_size = sizeof(a.stats);
    a.result.struct_size = sizeof(a.result);
    a.result.found = a.result.verdict = a.result.reserved = 7;
    a.result.vertex_face_count = a.result.edge_edge_count = 7;
    a.result.vertex_face_capacity = faces;
    a.result.vertex_faces = a.pairs[STEP_VERTEX_FACE];
    a.result.edge_edge_capacity = edges;
    a.result.edge_edges = a.pairs[STEP_EDGE_EDGE];
    a.result.stats = &a.stats;
    a.status = sc_query_near(q->model, q->workspace, q->pose, options, &a.result);
    a.count[STEP_VERTEX_FACE] = a.result.vertex_face_count;
    a.count[STEP_EDGE_EDGE] = a.result.edge_edge_count;
    for (int kind = 0; kind < STEP_KINDS; ++kind)
        CHECK_MSG(memcmp(&a.pairs[kind][a.capacity[kind]], &guard_pair, sizeof(sc_pair)) == 0,
                  "%s: writes behind the end of %s", q->name, step_kind_names[kind]);
    CHECK(a.result.reserved == 0);
    return a;
}

near_answer near_ask_all(const near_question *q, const sc_near_options *options)
{
    near_answer counted = near_ask(q, options, 0, 0), all;
    uint64_t sum = counted.count[0] + counted.count[1];
    CHECK_MSG(counted.status == (sum ? SC_ERROR_SHORT_BUFFER : SC_OK), "%s: status %d", q->name,
              (int)counted.status);
    all = near_ask(q, options, counted.count[0], counted.count[1]);
    CHECK_MSG(all.status == SC_OK && all.count[0] == counted.count[0] &&
                  all.count[1] == counted.count[1] && all.result.found == (sum != 0) &&
                  all.result.verdict == (sum ? SC_VERDICT_FOUND : SC_VERDICT_CLEAN),
              "%s: status %d, found %" PRIu32 ", verdict %" PRIu32 ", counts %" PRIu64 " %" PRIu64
              " after %" PRIu64 " %" PRIu64 "; state %" PRIu64,
              q->name, (int)all.status, all.result.found, all.result.verdict, all.count[0],
              all.count[1], counted.count[0], counted.count[1], q->state);
    near_answer_free(&counted);
    return all;
}

void near_answer_free(near_answer *a)
{
    for (int kind = 0; kind < STEP_KINDS; ++kind) free(a->pairs[kind]);
}

int near_answers_are_same(const near_answer *a, const near_answer *b)
{
    int same = a->status == b->status && a->count[0] == b->count[0] && a->count[1] == b->count[1] &&
               a->result.found == b->result.found && a->result.verdict == b->result.verdict;
    for (int kind = 0; kind < STEP_KINDS && same; ++kind) {
        uint64_t filled = a->count[kind] < a->capacity[kind] ? a->count[kind] : a->capacity[kind];
        same = a->capacity[kind] == b->capacity[kind] &&
               memcmp(a->pairs[kind], b->pairs[kind], (size_t)filled * sizeof(sc_pair)) == 0;
    }
    return same;
}

static int compare_pairs(sc_pair x, sc_pair y)
{
    return x.a != y.a ? (x.a < y.a ? -1 : 1) : x.b != y.b ? (x.b < y.b ? -1 : 1) : 0;
}

int near_answer_is_in(const near_answer *a, const near_answer *b)
{
    for (int kind = 0; kind < STEP_KINDS; ++kind) {
        uint64_t j = 0;
        for (uint64_t i = 0; i < a->count[kind]; ++i) {
            while (j < b->count[kind] && compare_pairs(b->pairs[kind][j], a->pairs[kind][i]) < 0)
                ++j;
            if (j == b->count[kind] || compare_pairs(b->pairs[kind][j], a->pairs[kind][i]) != 0)
                return 0;
        }
    }
    return 1;
}

int near_way_is_there(const near_way *w, const sc_model *model, sc_workspace *workspace,
                      const sc_pose *pose)
{
    sc_near_options options = near_options_for(w, 0);
    sc_near_result result;
    memset(&result, 0, sizeof(result));
    result.struct_size = sizeof(result);
    options.output = SC_OUTPUT_ANY;
    return sc_query_near(model, workspace, pose, &options, &result) != SC_ERROR_UNSUPPORTED;
}

/* ---- the truth ---- */

static void get_points(const step_motion *m, int kind, sc_pair pair, double p[4][3])
{
    uint32_t v[4];
    step_pair_vertices(m, kind, pair, v);
    for (int k = 0; k < 4; ++k) memcpy(p[k], m->ends[0] + 3 * (size_t)v[k], 3 * sizeof(double));
}

static int is_one(const step_motion *m, int kind, sc_pair pair)
{
    uint32_t v[4], first = step_pair_vertices(m, kind, pair, v);
    if (kind == STEP_VERTEX_FACE && !m->used[pair.a]) return 0;
    for (uint32_t i = 0; i < first; ++i)
        for (uint32_t k = first; k < 4; ++k)
            if (v[i] == v[k]) return 0;
    return 1;
}

/* Whether an extent of both along an axis is more than the distance apart. A rounded difference is
   above a double only if the exact one is. */
static int is_apart(const double p[4][3], int first, double distance)
{
    for (int k = 0; k < 3; ++k) {
        double low[2] = {HUGE_VAL, HUGE_VAL}, high[2] = {-HUGE_VAL, -HUGE_VAL};
        for (int i = 0; i < 4; ++i) {
            low[i >= first] = fmin(low[i >= first], p[i][k]);
            high[i >= first] = fmax(high[i >= first], p[i][k]);
        }
        if (low[0] - high[1] > distance || low[1] - high[0] > distance) return 1;
    }
    return 0;
}

int near_truth_is_within(const step_motion *m, int kind, sc_pair pair, double distance)
{
    double p[4][3];
    const double(*points)[3] = (const double(*)[3])p;
    get_points(m, kind, pair, p);
    if (is_apart(points, kind == STEP_VERTEX_FACE ? 1 : 2, distance)) return 0;
    return kind == STEP_VERTEX_FACE ? near_oracle_vertex_face(points, distance)
                                    : near_oracle_edge_edge(points, distance);
}

double near_truth_distance(const step_motion *m, int kind, sc_pair pair)
{
    double p[4][3];
    const double(*points)[3] = (const double(*)[3])p;
    get_points(m, kind, pair, p);
    return kind == STEP_VERTEX_FACE ? near_oracle_distance_vertex_face(points)
                                    : near_oracle_distance_edge_edge(points);
}

int near_truth_draw(const step_motion *m, int kind, sc_pair *pair)
{
    for (int i = 0; i < 200; ++i) {
        if (kind == STEP_VERTEX_FACE) {
            pair->a = test_random_below(m->vertex_count);
            pair->b = test_random_below(m->triangle_count);
        } else {
            if (m->edge_count == 0) return 0;
            pair->a = m->edge[test_random_below(m->edge_count)];
            pair->b = m->edge[test_random_below(m->edge_count)];
            if (pair->a > pair->b) {
                const uint32_t a = pair->a;
                pair->a = pair->b;
                pair->b = a;
            }
        }
        if (is_one(m, kind, *pair)) return 1;
    }
    return 0;
}

oracle_list near_truth_find(const step_motion *m, int kind, double distance)
{
    const uint32_t rows = kind == STEP_VERTEX_FACE ? m->vertex_count : m->edge_count;
    oracle_list list;
    memset(&list, 0, sizeof(list));
    for (uint32_t i = 0; i < rows; ++i)
        for (uint32_t j = kind == STEP_VERTEX_FACE ? 0 : i + 1;
             j < (kind == STEP_VERTEX_FACE ? m->triangle_count : m->edge_count); ++j) {
            sc_pair pair = {i, j};
            if (kind == STEP_EDGE_EDGE) {
                pair.a = m->edge[i];
                pair.b = m->edge[j];
            }
            if (!is_one(m, kind, pair) || !near_truth_is_within(m, kind, pair, distance)) continue;
            if (list.count == list.capacity) {
                list.capacity = 2 * list.capacity + 64;
                list.pairs = (sc_pair *)realloc(list.pairs, list.capacity * sizeof(sc_pair));
                if (list.pairs == NULL) abort();
            }
            list.pairs[list.count++] = pair;
        }
    return list;
}

static void print_points(const step_motion *m, int kind, sc_pair pair)
{
    double p[4][3];
    get_points(m, kind, pair, p);
    for (int i = 0; i < 4; ++i) printf("    {%a, %a, %a}\n", p[i][0], p[i][1], p[i][2]);
}

void near_truth_check(const near_question *q, const step_motion *m, const near_answer *a,
                      double distance, const char *what)
{
    for (int kind = 0; kind < STEP_KINDS; ++kind) {
        oracle_list list = near_truth_find(m, kind, distance);
        uint64_t i = 0;
        while (i < list.count && i < a->count[kind] &&
               compare_pairs(list.pairs[i], a->pairs[kind][i]) == 0)
            ++i;
        if (!CHECK_MSG(i == list.count && i == a->count[kind],
                       "%s, %s: %s: %" PRIu64 " instead of %" PRIu64 ", %" PRIu64
                       " are the same at the head; distance %a, state %" PRIu64,
                       q->name, what, step_kind_names[kind], a->count[kind], list.count, i,
                       distance, q->state) &&
            test_failures() <= 3) {
            if (i < list.count) print_points(m, kind, list.pairs[i]);
            if (i < a->count[kind]) print_points(m, kind, a->pairs[kind][i]);
        }
        free(list.pairs);
    }
}
