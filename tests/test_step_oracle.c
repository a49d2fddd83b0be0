/*
 * The promise of steps: on every mesh, pair of poses, type, stride, welding, partition, separation
 * and method, sc_query_step reports every vertex-face and edge-edge pair that exact arithmetic says
 * collides, and beyond these only pairs that come within the tolerance; all methods report the
 * same.
 *
 * All pairs of small meshes are decided by step_oracle.h. Pairs that stay apart along one of
 * thirteen directions, by more than rounding can hide, are not handed to it.
 *
 * SPDX-License-Identifier: MIT
 */
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "harness.h"
#include "inputs.h"
#include "oracle.h"
#include "shapes.h"
#include "soups.h"
#include "starcontour.h"
#include "step_truth.h"
#include "steps.h"

/* ------------------------------------------------------------------------------------------------
 * Queries
 */

typedef struct way {
    const char *name;
    uint32_t method, contour, simd;
} way;

static const way ways[] = {
    {"default", SC_STEP_METHOD_DEFAULT, SC_CONTOUR_DEFAULT, SC_SIMD_BEST},
    {"sctt", SC_STEP_METHOD_SCTT, SC_CONTOUR_EXACT, SC_SIMD_BASE},
    {"sctt, star", SC_STEP_METHOD_SCTT, SC_CONTOUR_STAR, SC_SIMD_BEST},
    {"sctt, star, base", SC_STEP_METHOD_SCTT, SC_CONTOUR_STAR, SC_SIMD_BASE},
    {"two boxes", SC_STEP_METHOD_TWO_BOXES, SC_CONTOUR_DEFAULT, SC_SIMD_BEST},
    {"two boxes, base", SC_STEP_METHOD_TWO_BOXES, SC_CONTOUR_DEFAULT, SC_SIMD_BASE},
    {"swept", SC_STEP_METHOD_SWEPT, SC_CONTOUR_DEFAULT, SC_SIMD_BEST},
};

enum { WAYS = sizeof(ways) / sizeof(ways[0]) };

/* What is asked, and of what. */
typedef struct question {
    const char *name;
    const sc_model *model;
    sc_workspace *workspace;
    const sc_pose *start, *end;
    double separation, tolerance;
    uint64_t state; /* of the random numbers before the step was made */
} question;

/* An answer with arrays of exactly the size asked for, and a guard behind each. */
typedef struct answer {
    sc_status status;
    sc_step_result result;
    sc_pair *pairs[STEP_KINDS];
    double *times[STEP_KINDS];
    uint64_t count[STEP_KINDS], capacity[STEP_KINDS];
} answer;

static const sc_pair guard_pair = {0xdeadbeefu, 0xfeedfaceu};

static void answer_free(answer *a)
{
    for (int kind = 0; kind < STEP_KINDS; ++kind) {
        free(a->pairs[kind]);
        free(a->times[kind]);
    }
}

static answer ask(const question *q, const way *w, uint32_t output, uint32_t pairs, uint32_t times,
                  uint64_t faces, uint64_t edges)
{
    sc_step_options options;
    answer a;
    memset(&a, 0, sizeof(a));
    memset(&options, 0, sizeof(options));
    options.struct_size = sizeof(options);
    options.output = output;
    options.pairs = pairs;
    options.times = times;
    options.method = w->method;
    options.contour = w->contour;
    options.simd = w->simd;
    options.separation = q->separation;
    options.tolerance = q->tolerance;
    a.capacity[STEP_VERTEX_FACE] = faces;
    a.capacity[STEP_EDGE_EDGE] = edges;
    for (int kind = 0; kind < STEP_KINDS; ++kind) {
        uint64_t room = a.capacity[kind] + 1;
        a.pairs[kind] = (sc_pair *)test_allocate(room * sizeof(sc_pair));
        a.times[kind] = (double *)test_allocate(room * sizeof(double));
        for (uint64_t i = 0; i < room; ++i) {
            a.pairs[kind][i] = guard_pair;
            a.times[kind][i] = -7;
        }
    }
    a.result.struct_size = sizeof(a.result);
    a.result.vertex_face_capacity = faces;
    a.result.vertex_faces = a.pairs[STEP_VERTEX_FACE];
    a.result.vertex_face_times = a.times[STEP_VERTEX_FACE];
    a.result.edge_edge_capacity = edges;
    a.result.edge_edges = a.pairs[STEP_EDGE_EDGE];
    a.result.edge_edge_times = a.times[STEP_EDGE_EDGE];
    a.result.collides = 7;
    a.result.earliest = -7;
    a.status = sc_query_step(q->model, q->workspace, q->start, q->end, &options, &a.result);
    a.count[STEP_VERTEX_FACE] = a.result.vertex_face_count;
    a.count[STEP_EDGE_EDGE] = a.result.edge_edge_count;
    for (int kind = 0; kind < STEP_KINDS; ++kind)
        CHECK_MSG(memcmp(&a.pairs[kind][a.capacity[kind]], &guard_pair, sizeof(sc_pair)) == 0 &&
                      a.times[kind][a.capacity[kind]] == -7,
                  "%s, %s: writes behind the end of %s", q->name, w->name, step_kind_names[kind]);
    return a;
}

/* All collisions with their times, in two queries. */
static answer ask_all(const question *q, const way *w, uint32_t pairs)
{
    uint32_t times = pairs == SC_STEP_CANDIDATES ? SC_STEP_TIMES_NONE : SC_STEP_TIMES_EACH;
    answer counted = ask(q, w, SC_OUTPUT_PAIRS, pairs, times, 0, 0), all;
    uint64_t sum = counted.count[0] + counted.count[1];
    CHECK_MSG(counted.status == (sum ? SC_ERROR_SHORT_BUFFER : SC_OK), "%s, %s: status %d", q->name,
              w->name, (int)counted.status);
    all = ask(q, w, SC_OUTPUT_PAIRS, pairs, times, counted.count[0], counted.count[1]);
    CHECK_MSG(all.status == SC_OK && all.count[0] == counted.count[0] &&
                  all.count[1] == counted.count[1] && all.result.collides == (sum != 0) &&
                  all.result.verdict == (sum ? SC_VERDICT_FOUND : SC_VERDICT_CLEAN),
              "%s, %s: status %d, collides %" PRIu32 ", verdict %" PRIu32 ", counts %" PRIu64
              " %" PRIu64 " after %" PRIu64 " %" PRIu64,
              q->name, w->name, (int)all.status, all.result.collides, all.result.verdict,
              all.count[0], all.count[1], counted.count[0], counted.count[1]);
    answer_free(&counted);
    return all;
}

static int is_before(sc_pair x, sc_pair y)
{
    return x.a < y.a || (x.a == y.a && x.b < y.b);
}

static int is_same(sc_pair x, sc_pair y)
{
    return x.a == y.a && x.b == y.b;
}

/* Where a pair is in a sorted list; count if it is not. */
static uint64_t find(const sc_pair *pairs, uint64_t count, sc_pair pair)
{
    for (uint64_t low = 0, high = count; low < high;) {
        uint64_t middle = (low + high) / 2;
        if (is_same(pairs[middle], pair)) return middle;
        if (is_before(pairs[middle], pair))
            low = middle + 1;
        else
            high = middle;
    }
    return count;
}

/* ------------------------------------------------------------------------------------------------
 * Comparing
 */

static void print_pair(const step_motion *m, int kind, sc_pair pair)
{
    uint32_t v[4];
    step_pair_vertices(m, kind, pair, v);
    for (int k = 0; k < 4; ++k) {
        const double *p = m->ends[0] + 3 * (size_t)v[k], *q = m->ends[1] + 3 * (size_t)v[k];
        printf("    vertex %" PRIu32 ": %.17g %.17g %.17g to %.17g %.17g %.17g\n", v[k], p[0], p[1],
               p[2], q[0], q[1], q[2]);
    }
}

/* The list of the default method: nothing lost, nothing beyond the tolerance, times as promised. */
static void check_answer(const question *q, const step_motion *m, const answer *a)
{
    double tolerance = q->tolerance > 0 ? q->tolerance : 1e-6 * m->extent * (1 + 1e-6), least = 1;
    for (int kind = 0; kind < STEP_KINDS; ++kind) {
        step_truth found = step_truth_find(m, kind, q->separation);
        for (uint64_t i = 0; i < found.list.count; ++i) {
            sc_pair pair = found.list.pairs[i];
            uint64_t at = find(a->pairs[kind], a->count[kind], pair);
            int ok = CHECK_MSG(
                at < a->count[kind],
                "%s: %s (%" PRIu32 ", %" PRIu32 ") is lost; separation %g, state %" PRIu64, q->name,
                step_kind_names[kind], pair.a, pair.b, q->separation, q->state);
            if (ok)
                ok =
                    CHECK_MSG(a->times[kind][at] <= found.when[i],
                              "%s: %s (%" PRIu32 ", %" PRIu32
                              ") collides by %.17g, not after %.17g; separation %g, state %" PRIu64,
                              q->name, step_kind_names[kind], pair.a, pair.b, found.when[i],
                              a->times[kind][at], q->separation, q->state);
            if (!ok && test_failures() <= 3) print_pair(m, kind, pair);
        }
        for (uint64_t i = 0; i < a->count[kind]; ++i) {
            sc_pair pair = a->pairs[kind][i];
            double time = a->times[kind][i];
            CHECK_MSG(i == 0 || is_before(a->pairs[kind][i - 1], pair), "%s: not sorted", q->name);
            if (CHECK_MSG(time >= 0 && time <= 1, "%s: time %g", q->name, time))
                CHECK_MSG(step_is_near(m, kind, pair, time, q->separation, tolerance),
                          "%s: %s (%" PRIu32 ", %" PRIu32
                          ") is not within tolerance %g at %.17g, state %" PRIu64,
                          q->name, step_kind_names[kind], pair.a, pair.b, tolerance, time,
                          q->state);
            least = fmin(least, time);
        }
        free(found.list.pairs);
        free(found.when);
    }
    CHECK_MSG(a->result.earliest == least, "%s: earliest %.17g, least time %.17g", q->name,
              a->result.earliest, least);
}

static void check_same(const question *q, const way *w, const answer *a, const answer *b)
{
    for (int kind = 0; kind < STEP_KINDS; ++kind) {
        uint64_t i = 0, least = a->count[kind] < b->count[kind] ? a->count[kind] : b->count[kind];
        while (i < least && is_same(a->pairs[kind][i], b->pairs[kind][i]) &&
               memcmp(&a->times[kind][i], &b->times[kind][i], sizeof(double)) == 0)
            ++i;
        CHECK_MSG(i == least && a->count[kind] == b->count[kind],
                  "%s: %s of %s: %" PRIu64 " instead of %" PRIu64 ", %" PRIu64
                  " are the same at the head; state %" PRIu64,
                  q->name, step_kind_names[kind], w->name, b->count[kind], a->count[kind], i,
                  q->state);
    }
    CHECK_MSG(memcmp(&a->result.earliest, &b->result.earliest, sizeof(double)) == 0,
              "%s: earliest of %s: %.17g instead of %.17g, state %" PRIu64, q->name, w->name,
              b->result.earliest, a->result.earliest, q->state);
}

/* Every pair of the first, which the way found or should have found, is in the second. */
static void check_superset(const question *q, const way *w, const answer *a, const answer *b)
{
    for (int kind = 0; kind < STEP_KINDS; ++kind)
        for (uint64_t i = 0; i < a->count[kind]; ++i)
            CHECK_MSG(find(b->pairs[kind], b->count[kind], a->pairs[kind][i]) < b->count[kind],
                      "%s: a pair is in one list of %s, not in the other, state %" PRIu64, q->name,
                      w->name, q->state);
}

/* Numbers, yes or no, and arrays that are too short. */
static void check_outputs(const question *q, const way *w, const answer *a)
{
    uint64_t sum = a->count[0] + a->count[1];
    answer b = ask(q, w, SC_OUTPUT_COUNT, SC_STEP_COLLISIONS, SC_STEP_TIMES_EARLIEST, 0, 0);
    CHECK_MSG(b.status == SC_OK && b.count[0] == a->count[0] && b.count[1] == a->count[1] &&
                  b.result.collides == (sum != 0) && b.result.earliest == a->result.earliest,
              "%s: count of %s: %" PRIu64 " %" PRIu64 ", earliest %.17g, state %" PRIu64, q->name,
              w->name, b.count[0], b.count[1], b.result.earliest, q->state);
    answer_free(&b);
    b = ask(q, w, SC_OUTPUT_ANY, SC_STEP_COLLISIONS, SC_STEP_TIMES_NONE, 0, 0);
    CHECK_MSG(b.status == SC_OK && b.result.collides == (sum != 0) &&
                  b.result.verdict == (sum ? SC_VERDICT_FOUND : SC_VERDICT_CLEAN),
              "%s: any of %s: %" PRIu32 ", verdict %" PRIu32 ", state %" PRIu64, q->name, w->name,
              b.result.collides, b.result.verdict, q->state);
    answer_free(&b);
    if (sum == 0) return;
    b = ask(q, w, SC_OUTPUT_PAIRS, SC_STEP_COLLISIONS, SC_STEP_TIMES_EACH,
            test_random() % (a->count[0] + 1), test_random() % (a->count[1] + 1));
    for (int kind = 0; kind < STEP_KINDS; ++kind) {
        CHECK_MSG(b.count[kind] == a->count[kind], "%s: a short array is counted wrongly", q->name);
        for (uint64_t i = 0; i < b.capacity[kind]; ++i)
            CHECK_MSG(is_same(a->pairs[kind][i], b.pairs[kind][i]) &&
                          a->times[kind][i] == b.times[kind][i],
                      "%s: short arrays of %s hold other pairs, state %" PRIu64, q->name, w->name,
                      q->state);
    }
    CHECK(
        b.status ==
        (b.capacity[0] < b.count[0] || b.capacity[1] < b.count[1] ? SC_ERROR_SHORT_BUFFER : SC_OK));
    answer_free(&b);
}

/* ------------------------------------------------------------------------------------------------
 * One step
 */

static sc_workspace *make_workspace(const sc_model *model)
{
    sc_workspace_options options;
    sc_workspace *workspace = NULL;
    memset(&options, 0, sizeof(options));
    options.struct_size = sizeof(options);
    options.flags = SC_WORKSPACE_STEP;
    CHECK(sc_workspace_create_for(model, &options, &workspace) == SC_OK);
    return workspace;
}

/* Counts, so that a test can say that it saw what it is about. */
typedef struct tally {
    uint64_t steps, collisions, clean;
    uint64_t missed; /* by queries without a contour test */
} tally;

static void check_step(const step *s, uint64_t state, tally *sum)
{
    uint32_t weld = test_random_below(3), n = s->mesh.vertex_count, *map;
    input_choices choices = input_choose(&s->mesh, weld, test_random_below(4));
    uint32_t gap = test_random_below(2) ? 0 : 5;
    input_array start = input_positions(s->start, n, s->type, gap);
    input_array end = input_positions(s->end, n, test_random_below(2) ? s->type : SC_DOUBLE,
                                      test_random_below(2) ? 0 : 3);
    sc_pose start_pose = input_pose(n, &start), end_pose = input_pose(n, &end);
    sc_mesh mesh = input_plain_mesh(&s->mesh);
    sc_model *model = NULL;
    question q;
    memset(&q, 0, sizeof(q));
    if (!CHECK(sc_build(&mesh, &choices.options, &model) == SC_OK)) return;
    map = input_weld_of(&choices, &s->mesh);
    q.name = s->name;
    q.model = model;
    q.workspace = make_workspace(model);
    q.start = &start_pose;
    q.end = &end_pose;
    q.separation = s->separation;
    q.state = state;
    if (test_random_below(3) == 0) q.tolerance = s->size * pow(10, test_random_range(-9, -3));
    if (q.workspace != NULL) {
        step_motion m = step_motion_make(&s->mesh, s->start, s->end, map);
        answer all = ask_all(&q, &ways[0], SC_STEP_COLLISIONS);
        check_answer(&q, &m, &all);
        for (uint32_t w = 1; w < WAYS; ++w) {
            answer other;
            if (test_random_below(2)) continue;
            other = ask_all(&q, &ways[w], SC_STEP_COLLISIONS);
            check_same(&q, &ways[w], &all, &other);
            answer_free(&other);
        }
        if (test_random_below(3) == 0) check_outputs(&q, &ways[test_random_below(WAYS)], &all);
        if (test_random_below(3) == 0) {
            const way *w = &ways[test_random_below(WAYS)];
            answer candidates = ask_all(&q, w, SC_STEP_CANDIDATES);
            check_superset(&q, w, &all, &candidates);
            answer_free(&candidates);
        }
        if (test_random_below(2) == 0) {
            static const way no_contour = {"no contour test", SC_STEP_METHOD_SCTT, SC_CONTOUR_NONE,
                                           SC_SIMD_BEST};
            answer some = ask_all(&q, &no_contour, SC_STEP_COLLISIONS);
            check_superset(&q, &no_contour, &some, &all);
            sum->missed += all.count[0] + all.count[1] - some.count[0] - some.count[1];
            answer_free(&some);
        }
        ++sum->steps;
        sum->collisions += all.count[0] + all.count[1];
        sum->clean += all.count[0] + all.count[1] == 0;
        answer_free(&all);
        step_motion_free(&m);
    }
    sc_workspace_free(q.workspace);
    sc_model_free(model);
    free(map);
    input_free(&start);
    input_free(&end);
    input_free_choices(&choices);
}

/* Many steps of one maker. Both answers must really come up, for which fewer steps than those
   planned go on to these; of makers that are about contours, so must patches with collisions that
   only the contour test keeps from being skipped, if the steps are not fewer. */
static void check_maker(step_maker make, int is_about_contours)
{
    enum { STEPS = 25 };
    const uint32_t count = test_iterations(STEPS);
    tally sum;
    memset(&sum, 0, sizeof(sum));
    if (count < STEPS) is_about_contours = 0;
    for (uint32_t i = 0; i < count || (i < STEPS && sum.collisions == 0); ++i) {
        uint64_t state = test_random_state();
        step s = make();
        step_dress(&s);
        check_step(&s, state, &sum);
        step_free(&s);
    }
    test_note("%" PRIu64 " steps, %" PRIu64 " without collision, %" PRIu64 " pairs, %" PRIu64
              " of them missed without a contour test",
              sum.steps, sum.clean, sum.collisions, sum.missed);
    CHECK(sum.collisions > 0 && (sum.missed > 0 || !is_about_contours));
}

static void steps_nested(void)
{
    check_maker(step_nested, 1);
}

static void steps_pinch(void)
{
    check_maker(step_pinch, 1);
}

static void steps_lips(void)
{
    check_maker(step_lips, 1);
}

static void steps_fold(void)
{
    check_maker(step_fold, 0);
}

static void steps_hole(void)
{
    check_maker(step_hole, 1);
}

static void steps_pass(void)
{
    check_maker(step_pass, 1);
}

static void steps_sweep(void)
{
    check_maker(step_sweep, 1);
}

static void steps_flip(void)
{
    check_maker(step_flip, 0);
}

static void steps_whirl(void)
{
    check_maker(step_whirl, 0);
}

static void steps_invert(void)
{
    check_maker(step_invert, 0);
}

static void steps_thick(void)
{
    check_maker(step_thick, 0);
}

static void steps_teleport(void)
{
    check_maker(step_teleport, 0);
}

static void steps_rotate(void)
{
    check_maker(step_rotate, 0);
}

static void steps_shrink(void)
{
    check_maker(step_shrink, 0);
}

static void steps_still(void)
{
    check_maker(step_still, 0);
}

static void steps_shift(void)
{
    check_maker(step_shift, 0);
}

static void steps_sheets(void)
{
    check_maker(step_sheets, 0);
}

static void steps_graze(void)
{
    check_maker(step_graze, 0);
}

static void steps_needle(void)
{
    check_maker(step_needle, 0);
}

static void steps_book(void)
{
    check_maker(step_book, 0);
}

static void steps_any(void)
{
    check_maker(step_any, 0);
}

/* ------------------------------------------------------------------------------------------------
 * Beside the discrete query
 */

/* The corner that names an edge with these two vertices, or SC_NONE. */
static uint32_t name_edge(const step_motion *m, uint32_t a, uint32_t b)
{
    for (uint32_t i = 0; i < m->edge_count; ++i) {
        uint32_t p = step_edge_start(m, m->edge[i]), q = step_edge_end(m, m->edge[i]);
        if ((p == a && q == b) || (p == b && q == a)) return m->edge[i];
    }
    return SC_NONE;
}

/* All pairs of an edge and a triangle in one pose. */
static oracle_list query_edges(const question *q, const sc_pose *pose, uint32_t contact)
{
    oracle_list list;
    sc_query_options options;
    sc_result result;
    memset(&list, 0, sizeof(list));
    memset(&options, 0, sizeof(options));
    memset(&result, 0, sizeof(result));
    options.struct_size = sizeof(options);
    options.pairs = SC_PAIRS_EDGE;
    options.contact = contact;
    result.struct_size = sizeof(result);
    if (sc_query(q->model, q->workspace, pose, &options, &result) != SC_OK) {
        list.pairs = (sc_pair *)test_allocate((size_t)result.count * sizeof(sc_pair));
        result.capacity = result.count;
        result.pairs = list.pairs;
        CHECK(sc_query(q->model, q->workspace, pose, &options, &result) == SC_OK);
    }
    list.count = result.count;
    return list;
}

static int motion_is_corner(const step_motion *m, uint32_t triangle, uint32_t vertex)
{
    const uint32_t *c = m->corner + 3 * (size_t)triangle;
    return c[0] == vertex || c[1] == vertex || c[2] == vertex;
}

/* collides_somehow of a triangle that is one vertex, which has no edges: a collision of that vertex
   with a triangle at the edge. 1 as well if it is a corner of all of these. */
static int vertex_collides(const step_motion *m, const answer *a, sc_pair pair, double *least)
{
    uint32_t v = m->corner[3 * (size_t)pair.b], others = 0;
    int found = 0;
    for (uint32_t t = 0; t < m->triangle_count; ++t) {
        sc_pair wanted = {v, t};
        uint64_t at;
        if (!motion_is_corner(m, t, step_edge_start(m, pair.a)) ||
            !motion_is_corner(m, t, step_edge_end(m, pair.a)) || motion_is_corner(m, t, v))
            continue;
        ++others;
        at = find(a->pairs[STEP_VERTEX_FACE], a->count[STEP_VERTEX_FACE], wanted);
        if (at == a->count[STEP_VERTEX_FACE]) continue;
        found = 1;
        *least = fmin(*least, a->times[STEP_VERTEX_FACE][at]);
    }
    if (others == 0) *least = 0;
    return found || others == 0;
}

/* Whether a collision is reported of an edge's end with a triangle, or of the edge with one of its
   edges; *least is the earliest time of these. */
static int collides_somehow(const step_motion *m, const answer *a, sc_pair pair, double *least)
{
    uint32_t ends[2] = {step_edge_start(m, pair.a), step_edge_end(m, pair.a)};
    const uint32_t *corner = m->corner + 3 * (size_t)pair.b;
    int found = 0;
    *least = 1;
    if (corner[0] == corner[1] && corner[1] == corner[2]) return vertex_collides(m, a, pair, least);
    for (int kind = 0; kind < STEP_KINDS; ++kind)
        for (uint32_t k = 0; k < (kind == STEP_VERTEX_FACE ? 2u : 3u); ++k) {
            const uint32_t *v = m->corner + 3 * (size_t)pair.b;
            sc_pair wanted = {ends[k % 2], pair.b};
            uint64_t at;
            if (kind == STEP_EDGE_EDGE) {
                uint32_t side = name_edge(m, v[k], v[(k + 1) % 3]);
                wanted.a = pair.a < side ? pair.a : side;
                wanted.b = pair.a < side ? side : pair.a;
            }
            at = find(a->pairs[kind], a->count[kind], wanted);
            if (at == a->count[kind]) continue;
            found = 1;
            *least = fmin(*least, a->times[kind][at]);
        }
    return found;
}

/* An edge that meets a triangle at one end of a step and not at the other has a collision in
   between, and one that only touches it, at the start, collides then. */
static void check_ends(const step *s, uint64_t *changes, uint64_t *touches)
{
    uint32_t n = s->mesh.vertex_count, *map;
    sc_pose start = input_plain_pose(s->start, n), end = input_plain_pose(s->end, n);
    sc_mesh mesh = input_plain_mesh(&s->mesh);
    sc_build_options options;
    question q;
    answer all;
    step_motion m;
    oracle_list met[2], proper;
    sc_model *model = NULL;
    memset(&options, 0, sizeof(options));
    options.struct_size = sizeof(options);
    options.weld = SC_WELD_NONE;
    if (!CHECK(sc_build(&mesh, &options, &model) == SC_OK)) return;
    map = (uint32_t *)test_allocate(n * sizeof(uint32_t));
    for (uint32_t v = 0; v < n; ++v) map[v] = v;
    memset(&q, 0, sizeof(q));
    q.name = s->name;
    q.model = model;
    q.workspace = make_workspace(model);
    q.start = &start;
    q.end = &end;
    q.separation = s->separation;
    m = step_motion_make(&s->mesh, s->start, s->end, map);
    all = ask_all(&q, &ways[0], SC_STEP_COLLISIONS);
    met[0] = query_edges(&q, &start, SC_CONTACT_TOUCHING);
    met[1] = query_edges(&q, &end, SC_CONTACT_TOUCHING);
    proper = query_edges(&q, &start, SC_CONTACT_PROPER);
    for (int e = 0; e < 2; ++e)
        for (uint64_t i = 0; i < met[e].count; ++i) {
            sc_pair pair = met[e].pairs[i];
            int stays = find(met[1 - e].pairs, met[1 - e].count, pair) < met[1 - e].count;
            int touching = e == 0 && find(proper.pairs, proper.count, pair) == proper.count;
            double least = 1;
            if (stays && !touching) continue;
            *changes += !stays;
            *touches += (uint64_t)touching;
            CHECK_MSG(collides_somehow(&m, &all, pair, &least) && (!touching || least == 0),
                      "%s: edge %" PRIu32 " and triangle %" PRIu32
                      " meet at one end, and no collision says so (first at %g)",
                      s->name, pair.a, pair.b, least);
        }
    for (int e = 0; e < 2; ++e) free(met[e].pairs);
    free(proper.pairs);
    answer_free(&all);
    step_motion_free(&m);
    free(map);
    sc_workspace_free(q.workspace);
    sc_model_free(model);
}

static void agrees_with_queries_at_the_ends(void)
{
    static const step_maker makers[] = {step_nested, step_pinch,    step_lips,   step_fold,
                                        step_hole,   step_pass,     step_sweep,  step_flip,
                                        step_invert, step_teleport, step_rotate, step_sheets,
                                        step_graze,  step_needle,   step_book,   step_any};
    uint64_t changes = 0, touches = 0;
    for (uint32_t i = test_iterations(400); i > 0; --i) {
        step s = makers[i % (sizeof(makers) / sizeof(makers[0]))]();
        step_dress(&s);
        check_ends(&s, &changes, &touches);
        step_free(&s);
    }
    test_note("%" PRIu64 " pairs met at one end only, %" PRIu64 " touched at the start", changes,
              touches);
    CHECK(changes > 0 && touches > 0);
}

/* ------------------------------------------------------------------------------------------------
 * Larger meshes: methods beside each other
 */

static soup make_large(const char **name)
{
    uint32_t side = 20 + test_random_below(20);
    switch (test_random_below(5)) {
    case 0:
        *name = "large cloth";
        return soup_cloth(side, side);
    case 1:
        *name = "large body";
        return shape_body(side, side);
    case 2:
        *name = "large spiral";
        return shape_spiral(4 * side, 6, test_random_range(0.8, 2), 0.1);
    case 3:
        *name = "large hub";
        return shape_hub(10 * side);
    default:
        *name = "large annulus";
        return soup_annulus(2 * side, side);
    }
}

static void methods_agree_on_larger_meshes(void)
{
    uint64_t pairs = 0;
    for (uint32_t i = test_iterations(25); i > 0; --i) {
        const char *name;
        uint64_t state = test_random_state();
        soup mesh = make_large(&name);
        step s;
        input_choices choices;
        sc_model *model = NULL;
        memset(&s, 0, sizeof(s));
        s.mesh = mesh;
        s.start = (double *)test_allocate(3 * (size_t)mesh.vertex_count * sizeof(double));
        s.end = (double *)test_allocate(3 * (size_t)mesh.vertex_count * sizeof(double));
        memcpy(s.start, mesh.positions, 3 * (size_t)mesh.vertex_count * sizeof(double));
        soup_smooth(s.start, mesh.vertex_count, test_random_range(0, 0.3));
        memcpy(s.end, s.start, 3 * (size_t)mesh.vertex_count * sizeof(double));
        soup_smooth(s.end, mesh.vertex_count, test_random_range(0, 0.5));
        if (test_random_below(3) == 0) soup_twist(s.end, mesh.vertex_count, 0.3);
        if (test_random_below(4) == 0) soup_noise(s.end, mesh.vertex_count, 0.01);
        if (test_random_below(3) == 0) soup_move(s.end, mesh.vertex_count, 3);
        choices = input_choose(&mesh, SC_WELD_NONE, test_random_below(4));
        {
            sc_mesh input = input_plain_mesh(&mesh);
            CHECK(sc_build(&input, &choices.options, &model) == SC_OK);
        }
        if (model != NULL) {
            sc_pose start = input_plain_pose(s.start, mesh.vertex_count);
            sc_pose end = input_plain_pose(s.end, mesh.vertex_count);
            question q;
            answer all;
            memset(&q, 0, sizeof(q));
            q.name = name;
            q.model = model;
            q.workspace = make_workspace(model);
            q.start = &start;
            q.end = &end;
            q.state = state;
            if (test_random_below(2)) q.separation = pow(10, test_random_range(-6, -2));
            all = ask_all(&q, &ways[WAYS - 1], SC_STEP_COLLISIONS);
            pairs += all.count[0] + all.count[1];
            for (uint32_t w = 0; w + 1 < WAYS; ++w) {
                answer other = ask_all(&q, &ways[w], SC_STEP_COLLISIONS);
                check_same(&q, &ways[w], &all, &other);
                answer_free(&other);
            }
            answer_free(&all);
            sc_workspace_free(q.workspace);
            sc_model_free(model);
        }
        input_free_choices(&choices);
        step_free(&s);
    }
    test_note("%" PRIu64 " pairs", pairs);
    CHECK(pairs > 0);
}

SC_TEST_MAIN(SC_TEST(steps_nested), SC_TEST(steps_pinch), SC_TEST(steps_lips), SC_TEST(steps_fold),
             SC_TEST(steps_hole), SC_TEST(steps_pass), SC_TEST(steps_sweep), SC_TEST(steps_flip),
             SC_TEST(steps_whirl), SC_TEST(steps_invert), SC_TEST(steps_thick),
             SC_TEST(steps_teleport), SC_TEST(steps_rotate), SC_TEST(steps_shrink),
             SC_TEST(steps_still), SC_TEST(steps_shift), SC_TEST(steps_sheets),
             SC_TEST(steps_graze), SC_TEST(steps_needle), SC_TEST(steps_book), SC_TEST(steps_any),
             SC_TEST(agrees_with_queries_at_the_ends), SC_TEST(methods_agree_on_larger_meshes))
