/*
 * The promise of proximity: on every mesh, pose, type, stride, welding and partition, for every
 * distance, sc_query_near reports the vertex-face and edge-edge pairs that exact arithmetic says
 * are within it, and no other; by every method, instruction set and number of workers.
 *
 * All pairs of small meshes are decided by near_oracle.h, for distances that some pair has to
 * within a unit in the last place. What is refused: test_near_input.c; many workers:
 * test_near_tasks.c.
 *
 * SPDX-License-Identifier: MIT
 */
#include <float.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "adversaries.h"
#include "harness.h"
#include "inputs.h"
#include "near_ask.h"
#include "posed_model.h"
#include "shapes.h"
#include "soups.h"
#include "starcontour.h"
#include "steps.h"
#include "tasks.h"

/* A mesh in a pose, as it is handed over. */
typedef struct scene {
    near_question q;
    soup mesh; /* the rest pose */
    double *posed;
    step_motion m;
    input_choices choices;
    input_array positions;
    sc_pose pose;
    sc_model *model;
    sc_workspace *shared; /* for two workers */
    double edge, extent;  /* an edge's length, and the pose's along an axis */
} scene;

/* Counts, so that a test can say that it saw what it is about. */
typedef struct tally {
    uint64_t scenes, queries, pairs, none;
} tally;

static double largest_extent(const step_motion *m)
{
    return m->extent < HUGE_VAL ? m->extent : DBL_MAX;
}

static double edge_length(const step_motion *m)
{
    double length = 0;
    for (int tries = 0; tries < 20 && m->edge_count > 0 && !(length > 0); ++tries) {
        const uint32_t edge = m->edge[test_random_below(m->edge_count)];
        const double *p = m->ends[0] + 3 * (size_t)step_edge_start(m, edge);
        const double *q = m->ends[0] + 3 * (size_t)step_edge_end(m, edge);
        length = hypot(hypot(p[0] - q[0], p[1] - q[1]), p[2] - q[2]);
    }
    return length;
}

/* Takes mesh and pose over. */
static int scene_start(scene *s, const char *name, soup mesh, double *posed, uint32_t type,
                       uint64_t state)
{
    uint32_t *map;
    sc_mesh input;
    memset(s, 0, sizeof(*s));
    s->mesh = mesh;
    s->posed = posed;
    s->choices = input_choose(&mesh, test_random_below(3), test_random_below(4));
    s->positions = input_positions(posed, mesh.vertex_count, type, test_random_below(2) ? 0 : 5);
    s->pose = input_pose(mesh.vertex_count, &s->positions);
    input = input_plain_mesh(&mesh);
    s->q.name = name;
    s->q.state = state;
    if (!CHECK(sc_build(&input, &s->choices.options, &s->model) == SC_OK)) return 0;
    map = input_weld_of(&s->choices, &mesh);
    s->m = step_motion_make(&mesh, posed, posed, map);
    free(map);
    s->q.model = s->model;
    s->q.pose = &s->pose;
    s->q.workspace = near_workspace(s->model, 1);
    s->shared = near_workspace(s->model, 2);
    s->edge = edge_length(&s->m);
    s->extent = largest_extent(&s->m);
    return s->q.workspace != NULL && s->shared != NULL;
}

static void scene_stop(scene *s)
{
    sc_workspace_free(s->q.workspace);
    sc_workspace_free(s->shared);
    sc_model_free(s->model);
    if (s->model != NULL) step_motion_free(&s->m);
    input_free(&s->positions);
    input_free_choices(&s->choices);
    soup_free(&s->mesh);
    free(s->posed);
}

/* The distance of a drawn pair, rounded down: itself or, as often, one unit in the last place below
   or above, as it may be that of the pair or not. Less than 0 if there is none. */
static double drawn_distance(const scene *s)
{
    const int kind = (int)test_random_below(2);
    sc_pair pair;
    double d;
    if (!near_truth_draw(&s->m, kind, &pair)) return -1;
    d = near_truth_distance(&s->m, kind, pair);
    switch (test_random_below(4)) {
    case 0:
        d = nextafter(d, 0);
        break;
    case 1:
        d = nextafter(d, DBL_MAX);
        break;
    case 2: /* as far off as floats hide */
        d *= 1 + ldexp(test_random_range(-1, 1), -20 - (int)test_random_below(30));
        break;
    default:
        break;
    }
    return d <= DBL_MAX ? d : -1;
}

/* Ascending distances of all kinds. */
static uint32_t draw_distances(const scene *s, double *distance)
{
    const double edge = s->edge, extent = s->extent;
    const double fixed[] = {0,
                            0x1p-1074,
                            extent * ldexp(1, -40),
                            edge,
                            edge * 0.01,
                            edge * test_random_range(0.05, 1),
                            edge * test_random_range(1, 5),
                            extent * test_random_range(0.5, 1.8),
                            4 * extent,
                            1e308,
                            DBL_MAX};
    enum { FIXED = sizeof(fixed) / sizeof(fixed[0]) };
    uint32_t count = 0;
    for (uint32_t i = 0; i < FIXED; ++i)
        if (test_random_below(3) == 0 && fixed[i] <= DBL_MAX) distance[count++] = fixed[i];
    for (uint32_t i = 0; i < 4; ++i) {
        distance[count] = drawn_distance(s);
        count += distance[count] >= 0;
    }
    for (uint32_t i = 1; i < count; ++i)
        for (uint32_t j = i; j > 0 && distance[j] < distance[j - 1]; --j) {
            double swap = distance[j];
            distance[j] = distance[j - 1];
            distance[j - 1] = swap;
        }
    return count;
}

enum { DISTANCES_MAX = 16 };

/* ------------------------------------------------------------------------------------------------
 * Comparing
 */

static void check_same(const scene *s, const char *what, const near_answer *a, const near_answer *b,
                       double distance)
{
    CHECK_MSG(near_answers_are_same(a, b),
              "%s, %s: status %d after %d, counts %" PRIu64 " %" PRIu64 " instead of %" PRIu64
              " %" PRIu64 "; distance %a, state %" PRIu64,
              s->q.name, what, (int)b->status, (int)a->status, b->count[0], b->count[1],
              a->count[0], a->count[1], distance, s->q.state);
}

/* Of the answer a with both kinds, what is left when one is asked for. */
static void check_kinds(const scene *s, sc_near_options options, const near_answer *a)
{
    for (int kind = 0; kind < STEP_KINDS; ++kind) {
        near_answer b, expected = *a;
        options.kinds = kind == STEP_VERTEX_FACE ? SC_NEAR_VERTEX_FACE : SC_NEAR_EDGE_EDGE;
        expected.count[1 - kind] = expected.capacity[1 - kind] = 0;
        expected.result.found = a->count[kind] > 0;
        expected.result.verdict = a->count[kind] ? SC_VERDICT_FOUND : SC_VERDICT_CLEAN;
        b = near_ask_all(&s->q, &options);
        check_same(s, "one kind", &expected, &b, options.distance);
        near_answer_free(&b);
    }
}

/* Numbers, and yes or no. */
static void check_counts(const scene *s, sc_near_options options, const near_answer *a)
{
    const uint64_t sum = a->count[0] + a->count[1];
    near_answer b;
    options.output = SC_OUTPUT_COUNT;
    b = near_ask(&s->q, &options, 3, 3);
    CHECK_MSG(b.status == SC_OK && b.count[0] == a->count[0] && b.count[1] == a->count[1] &&
                  b.result.found == (sum != 0) && b.result.verdict == a->result.verdict &&
                  b.pairs[0][0].a == 0xdeadbeefu && b.pairs[1][0].a == 0xdeadbeefu,
              "%s: counts %" PRIu64 " %" PRIu64 " instead of %" PRIu64 " %" PRIu64
              "; distance %a, state %" PRIu64,
              s->q.name, b.count[0], b.count[1], a->count[0], a->count[1], options.distance,
              s->q.state);
    near_answer_free(&b);
    options.output = SC_OUTPUT_ANY;
    for (uint32_t kinds = SC_NEAR_BOTH; kinds <= SC_NEAR_EDGE_EDGE; ++kinds) {
        const uint64_t there = kinds == SC_NEAR_BOTH ? sum : a->count[kinds - 1];
        options.kinds = kinds;
        b = near_ask(&s->q, &options, 3, 3);
        CHECK_MSG(b.status == SC_OK && b.count[0] + b.count[1] == (there != 0) &&
                      b.count[0] <= a->count[0] && b.count[1] <= a->count[1] &&
                      b.result.found == (there != 0) &&
                      b.result.verdict == (there ? SC_VERDICT_FOUND : SC_VERDICT_CLEAN) &&
                      b.pairs[0][0].a == 0xdeadbeefu && b.pairs[1][0].a == 0xdeadbeefu,
                  "%s: any of kinds %" PRIu32 ": %" PRIu64 " %" PRIu64 " of %" PRIu64
                  "; distance %a, state %" PRIu64,
                  s->q.name, kinds, b.count[0], b.count[1], there, options.distance, s->q.state);
        near_answer_free(&b);
    }
}

/* Arrays that are too short by so much hold the first pairs, whatever the other one has. */
static void check_short(const scene *s, const sc_near_options *options, const near_answer *a)
{
    for (uint32_t i = 0; i < 4; ++i) {
        uint64_t room[STEP_KINDS];
        near_answer b;
        for (int kind = 0; kind < STEP_KINDS; ++kind) {
            const uint64_t n = a->count[kind];
            const uint64_t some[] = {0, 1, n > 0 ? n - 1 : 0, n, n + 3, test_random() % (n + 1)};
            room[kind] = some[test_random_below(6)];
        }
        b = near_ask(&s->q, options, room[0], room[1]);
        CHECK_MSG(b.count[0] == a->count[0] && b.count[1] == a->count[1] &&
                      b.result.found == a->result.found && b.result.verdict == a->result.verdict &&
                      b.status == (room[0] < a->count[0] || room[1] < a->count[1]
                                       ? SC_ERROR_SHORT_BUFFER
                                       : SC_OK),
                  "%s: room for %" PRIu64 " %" PRIu64 ", status %d, state %" PRIu64, s->q.name,
                  room[0], room[1], (int)b.status, s->q.state);
        for (int kind = 0; kind < STEP_KINDS; ++kind) {
            const uint64_t n = room[kind] < a->count[kind] ? room[kind] : a->count[kind];
            CHECK_MSG(memcmp(a->pairs[kind], b.pairs[kind], (size_t)n * sizeof(sc_pair)) == 0,
                      "%s: arrays for %" PRIu64 " %" PRIu64 " hold other pairs, state %" PRIu64,
                      s->q.name, room[0], room[1], s->q.state);
        }
        near_answer_free(&b);
    }
}

/* The other ways to the same answer, some of them. */
static void check_ways(const scene *s, sc_near_options options, const near_answer *a)
{
    const double distance = options.distance;
    for (uint32_t w = 1; w < NEAR_WAYS; ++w) {
        near_answer b;
        if (test_random_below(2)) continue;
        if (!near_way_is_there(&near_ways[w], s->model, s->q.workspace, &s->pose)) continue;
        options = near_options_for(&near_ways[w], distance);
        b = near_ask(&s->q, &options, a->count[0], a->count[1]);
        check_same(s, near_ways[w].name, a, &b, distance);
        near_answer_free(&b);
    }
    if (test_random_below(3) == 0) {
        near_question q = s->q;
        near_answer b;
        host h;
        host_start(&h, (int)test_random_below(HOST_COUNT), 2);
        q.workspace = s->shared;
        options = near_options_for(&near_ways[test_random_below(2) ? 0 : 4], distance);
        options.tasks = &h.tasks;
        b = near_ask(&q, &options, a->count[0], a->count[1]);
        check_same(s, "two workers", a, &b, distance);
        CHECK(h.mistakes == 0);
        near_answer_free(&b);
        host_stop(&h);
    }
}

/* ------------------------------------------------------------------------------------------------
 * One scene
 */

static void check_scene(scene *s, tally *sum)
{
    double distance[DISTANCES_MAX];
    const uint32_t count = draw_distances(s, distance);
    near_answer before;
    memset(&before, 0, sizeof(before));
    for (uint32_t i = 0; i < count; ++i) {
        sc_near_options options = near_options_for(&near_ways[0], distance[i]);
        near_answer all = near_ask_all(&s->q, &options);
        near_truth_check(&s->q, &s->m, &all, distance[i], "default");
        if (i > 0)
            CHECK_MSG(near_answer_is_in(&before, &all), "%s: less within more, state %" PRIu64,
                      s->q.name, s->q.state);
        check_ways(s, options, &all);
        options = near_options_for(&near_ways[test_random_below(2) ? 1 : 4], distance[i]);
        if (test_random_below(4) == 0) check_kinds(s, options, &all);
        if (test_random_below(4) == 0) check_counts(s, options, &all);
        if (test_random_below(4) == 0) check_short(s, &options, &all);
        near_answer_free(&before);
        before = all;
        ++sum->queries;
        sum->pairs += all.count[0] + all.count[1];
        sum->none += all.count[0] + all.count[1] == 0;
    }
    near_answer_free(&before);
    ++sum->scenes;
}

static void check_tally(const tally *sum)
{
    test_note("%" PRIu64 " scenes, %" PRIu64 " queries, %" PRIu64 " without pairs, %" PRIu64
              " pairs",
              sum->scenes, sum->queries, sum->none, sum->pairs);
    CHECK(sum->pairs > 0);
}

static double *copy_positions(const double *positions, uint32_t count)
{
    double *copy = (double *)test_allocate(3 * (size_t)count * sizeof(double));
    memcpy(copy, positions, 3 * (size_t)count * sizeof(double));
    return copy;
}

static int floats_hold(const double *positions, uint32_t count)
{
    for (uint32_t c = 0; c < 3 * count; ++c)
        if (!(fabs(positions[c]) < (double)FLT_MAX)) return 0;
    return 1;
}

/* Any mesh in any pose, of any size and place. */
static void any_scene(void)
{
    tally sum;
    memset(&sum, 0, sizeof(sum));
    for (uint32_t i = 0; i < test_iterations_at_least(250, 20); ++i) {
        static const int sizes[] = {900, -900, 500, -500, -1030, 120, -120, 60, -60, 3};
        const uint64_t state = test_random_state();
        const char *name = "scattered";
        soup mesh = test_random_below(4) == 0 ? soup_scattered()
                                              : shape_any(20 + test_random_below(60), &name);
        double *posed = copy_positions(mesh.positions, mesh.vertex_count);
        uint32_t type = test_random_below(3) ? SC_DOUBLE : SC_FLOAT;
        scene s;
        if (test_random_below(4)) soup_any_pose(posed, mesh.vertex_count);
        if (test_random_below(4) == 0)
            soup_move(posed, mesh.vertex_count, pow(10, test_random_range(0, 12)));
        if (test_random_below(3) == 0) {
            const int size = sizes[test_random_below(10)];
            soup_scale(posed, mesh.vertex_count, ldexp(1, size));
            if (size < -60) type = SC_DOUBLE; /* floats hold no less */
        }
        if (!floats_hold(posed, mesh.vertex_count)) type = SC_DOUBLE;
        if (type == SC_FLOAT) soup_round_to_float(posed, mesh.vertex_count);
        if (scene_start(&s, name, mesh, posed, type, state)) check_scene(&s, &sum);
        scene_stop(&s);
    }
    check_tally(&sum);
}

/* Poses that are hard on steps: folds, lips, sheets, needles, books and pinches. */
static void poses_of_steps(void)
{
    static step (*const makers[])(void) = {
        step_nested, step_pinch,  step_lips,   step_fold,   step_hole,   step_pass,
        step_sweep,  step_flip,   step_whirl,  step_invert, step_thick,  step_teleport,
        step_rotate, step_shrink, step_sheets, step_graze,  step_needle, step_book};
    enum { MAKERS = sizeof(makers) / sizeof(makers[0]) };
    tally sum;
    memset(&sum, 0, sizeof(sum));
    for (uint32_t i = 0; i < test_iterations_at_least(8 * MAKERS, MAKERS); ++i) {
        const uint64_t state = test_random_state();
        step t = makers[i % MAKERS]();
        scene s;
        soup mesh;
        step_dress(&t);
        mesh = soup_copy(&t.mesh);
        if (scene_start(&s, t.name, mesh,
                        copy_positions(i / MAKERS % 2 ? t.start : t.end, mesh.vertex_count), t.type,
                        state))
            check_scene(&s, &sum);
        scene_stop(&s);
        step_free(&t);
    }
    check_tally(&sum);
}

/* Contours that close on themselves, doubled and pinched patches, what is next to underflow. */
static void adversaries(void)
{
    static adversary (*const makers[])(void) = {
        adversary_slit,    adversary_strip,   adversary_petals,  adversary_doubled,
        adversary_book,    adversary_moebius, adversary_klein,   adversary_degenerate,
        adversary_sheets,  adversary_upright, adversary_shallow, adversary_ring,
        adversary_corners, adversary_faces};
    enum { MAKERS = sizeof(makers) / sizeof(makers[0]) };
    tally sum;
    memset(&sum, 0, sizeof(sum));
    for (uint32_t i = 0; i < test_iterations_at_least(10 * MAKERS, MAKERS); ++i) {
        const uint64_t state = test_random_state();
        adversary a = makers[i % MAKERS]();
        scene s;
        soup mesh;
        adversary_dress(&a);
        mesh = soup_copy(&a.mesh);
        if (scene_start(&s, "adversary", mesh, copy_positions(mesh.positions, mesh.vertex_count),
                        a.type, state))
            check_scene(&s, &sum);
        scene_stop(&s);
        adversary_free(&a);
    }
    check_tally(&sum);
}

/* Small integers, where ties are common; sizes with and without a grid that floats can hold. */
static void soups_on_grids(void)
{
    tally sum;
    memset(&sum, 0, sizeof(sum));
    for (uint32_t i = 0; i < test_iterations_at_least(150, 15); ++i) {
        const uint64_t state = test_random_state();
        soup mesh = soup_on_grid(1 + test_random_below(5));
        double *posed = copy_positions(mesh.positions, mesh.vertex_count);
        scene s;
        if (test_random_below(3) == 0)
            soup_scale(posed, mesh.vertex_count, test_random_below(2) ? 1.0 / 3 : 0x1p-700);
        if (test_random_below(3) == 0) soup_move(posed, mesh.vertex_count, 1000003);
        if (scene_start(&s, "grid", mesh, posed, SC_DOUBLE, state)) check_scene(&s, &sum);
        scene_stop(&s);
    }
    check_tally(&sum);
}

/* A flat grid of squares and as a distance the length of their edges, or a whole number of times
   that: two of five pairs that are within it are just within it. */
static void ties_on_flat_grids(void)
{
    uint64_t within = 0, ties = 0;
    for (uint32_t i = 0; i < test_iterations_at_least(20, 4); ++i) {
        const uint64_t state = test_random_state();
        const uint32_t across = 2 + test_random_below(6), along = 2 + test_random_below(6);
        static const double units[] = {1, 0x1p-10, 1e-3, 1.0 / 3, 0x1p300, 7};
        const double unit = units[test_random_below(6)];
        soup mesh = soup_cloth(across, along);
        double *posed = copy_positions(mesh.positions, mesh.vertex_count);
        double distance[3] = {unit, 2 * unit, nextafter(unit, 0)};
        scene s;
        for (uint32_t v = 0; v < mesh.vertex_count; ++v) { /* row by row */
            posed[3 * v] = unit * (double)(v % (along + 1));
            posed[3 * v + 1] = unit * (double)(v / (along + 1));
            posed[3 * v + 2] = i % 2 ? 0 : 3 * unit;
        }
        if (scene_start(&s, "flat grid", mesh, posed, SC_DOUBLE, state)) {
            near_answer one[3];
            for (int d = 0; d < 3; ++d) {
                sc_near_options options = near_options_for(&near_ways[0], distance[d]);
                one[d] = near_ask_all(&s.q, &options);
                near_truth_check(&s.q, &s.m, &one[d], distance[d], "default");
                check_ways(&s, options, &one[d]);
            }
            within += one[0].count[0] + one[0].count[1];
            ties += one[0].count[0] + one[0].count[1] - one[2].count[0] - one[2].count[1];
            for (int d = 0; d < 3; ++d) near_answer_free(&one[d]);
        }
        scene_stop(&s);
    }
    test_note("%" PRIu64 " pairs, %" PRIu64 " of them ties", within, ties);
    CHECK(ties > within / 5);
}

/* Right-angled triangles in any direction and of any size, and as a distance the length of one of
   their sides, to the last bits: many pairs are as far apart at two of their points, but for a few
   roundings. Every fourth cloth has a point so far off that floats tell nothing of the others. */
static void points_at_the_distance(void)
{
    static const double units[] = {1, 0x1p-195, 0x1p195, 0x1p-205, 0x1p205, 0x1p-505, 0x1p900};
    enum { UNITS = sizeof units / sizeof *units };
    uint64_t within = 0, ties = 0;
    for (uint32_t i = 0; i < test_iterations_at_least(84, 28); ++i) {
        const uint64_t state = test_random_state();
        const double unit = units[i % UNITS];
        const int far_off = i / UNITS % 4 == 3, floats = unit == 1 && i % 2;
        soup mesh = soup_cloth(3 + test_random_below(3), 3);
        const uint32_t count = mesh.vertex_count, *t = mesh.triangles;
        double *posed = copy_positions(mesh.positions, count);
        scene s;
        if (i % 3) posed_model_rotate(posed, count);
        soup_scale(posed, count, unit);
        for (uint32_t c = 0; floats && c < 3 * count; ++c) posed[c] = (double)(float)posed[c];
        if (far_off) posed[3 * count - 1] = unit < 0x1p900 ? 0x1p60 * unit : 0x1p1000;
        if (scene_start(&s, "cloth", mesh, posed, floats ? SC_FLOAT : SC_DOUBLE, state)) {
            const uint32_t side = test_random_below(3);
            const double *a = posed + 3 * (size_t)t[side], *b = posed + 3 * (size_t)t[side ? 0 : 1];
            const double d = hypot(hypot(a[0] - b[0], a[1] - b[1]), a[2] - b[2]);
            const double distance[] = {d,
                                       nextafter(d, 0),
                                       nextafter(d, HUGE_VAL),
                                       d * (1 - 0x1p-50),
                                       d < 0x1p190 ? d : 0x1p190,
                                       d * (1 + 0x1p-50)};
            uint64_t least = UINT64_MAX, most = 0;
            for (int k = 0; k < 6; ++k) {
                sc_near_options options = near_options_for(&near_ways[k % 2 ? 0 : 4], distance[k]);
                near_answer all = near_ask_all(&s.q, &options);
                const uint64_t pairs = all.count[0] + all.count[1];
                near_truth_check(&s.q, &s.m, &all, distance[k], "points");
                if (k == 0) check_ways(&s, options, &all);
                if (k != 4) {
                    least = pairs < least ? pairs : least;
                    most = pairs > most ? pairs : most;
                }
                near_answer_free(&all);
            }
            within += most;
            ties += most - least;
        }
        scene_stop(&s);
    }
    test_note("%" PRIu64 " pairs, %" PRIu64 " of them within a few roundings", within, ties);
    CHECK(ties > within / 5);
}

/* Triangles between any three of a few points: leaf clusters of which triangles share few edges. */
static void many_edges_in_a_leaf(void)
{
    tally sum;
    memset(&sum, 0, sizeof(sum));
    for (uint32_t i = 0; i < test_iterations_at_least(40, 20); ++i) {
        const uint64_t state = test_random_state();
        soup mesh = soup_make(32, 36);
        scene s;
        for (uint32_t c = 0; c < 96; ++c) mesh.positions[c] = test_random_unit();
        for (uint32_t t = 0; t < 36; ++t)
            for (uint32_t k = 0; k < 3; ++k)
                mesh.triangles[3 * t + k] = t / 18 * 16 + (5 * k + test_random_below(5));
        if (scene_start(&s, "many edges", mesh, copy_positions(mesh.positions, 32), SC_DOUBLE,
                        state))
            check_scene(&s, &sum);
        scene_stop(&s);
    }
    check_tally(&sum);
}

/* Two flat sheets in any direction, a small part of an edge apart, and that as a distance, but for
   what floats hide: the slabs of their triangles end there. */
static void layers_at_the_distance(void)
{
    uint64_t within = 0;
    for (uint32_t i = 0; i < test_iterations_at_least(60, 30); ++i) {
        const uint64_t state = test_random_state();
        soup one = soup_cloth(5, 5), two = soup_cloth(4, 5), mesh;
        const double apart = 0.2 * pow(10, test_random_range(-5, -0.5));
        double *posed;
        scene s;
        for (uint32_t v = 0; v < two.vertex_count; ++v) two.positions[3 * v + 2] = apart;
        mesh = soup_join(&one, &two);
        soup_free(&one);
        soup_free(&two);
        posed = copy_positions(mesh.positions, mesh.vertex_count);
        posed_model_rotate(posed, mesh.vertex_count);
        soup_noise(posed, mesh.vertex_count, 1e-9);
        if (scene_start(&s, "layers", mesh, posed, SC_DOUBLE, state)) {
            static const double parts[] = {1, 1 + 1e-8, 1 + 1e-6, 1 - 1e-6, 1 + 1e-4};
            for (int d = 0; d < 5; ++d) {
                sc_near_options options =
                    near_options_for(&near_ways[d % 2 ? 0 : 4], apart * parts[d]);
                near_answer all = near_ask_all(&s.q, &options);
                near_truth_check(&s.q, &s.m, &all, options.distance, "layers");
                within += all.count[0] + all.count[1];
                near_answer_free(&all);
            }
        }
        scene_stop(&s);
    }
    CHECK_MSG(within > 0, "%" PRIu64 " pairs", within);
}

/* Of distance 0 are those that touch, as another oracle says; and a distance larger than the mesh
   has all pairs without a common vertex. */
static void none_apart_and_all(void)
{
    uint64_t touching = 0, all = 0;
    for (uint32_t i = 0; i < test_iterations_at_least(60, 10); ++i) {
        const uint64_t state = test_random_state();
        const char *name = "grid";
        soup mesh = i % 2 ? soup_on_grid(2) : shape_any(40, &name);
        double *posed = copy_positions(mesh.positions, mesh.vertex_count);
        scene s;
        if (test_random_below(2)) soup_snap(posed, mesh.vertex_count, 0.25);
        if (scene_start(&s, name, mesh, posed, SC_DOUBLE, state)) {
            sc_near_options options = near_options_for(&near_ways[0], 0);
            near_answer none = near_ask_all(&s.q, &options), every;
            uint64_t count[2] = {0, 0}, pairs[2] = {0, 0};
            options.distance = 1e308;
            every = near_ask_all(&s.q, &options);
            for (int kind = 0; kind < STEP_KINDS; ++kind) {
                oracle_list list = near_truth_find(&s.m, kind, 1e308);
                for (uint64_t j = 0; j < list.count; ++j) {
                    uint32_t v[4], first = step_pair_vertices(&s.m, kind, list.pairs[j], v);
                    double p[12];
                    for (int k = 0; k < 4; ++k)
                        memcpy(p + 3 * k, s.m.ends[0] + 3 * (size_t)v[k], 3 * sizeof(double));
                    count[kind] += (uint64_t)oracle_hulls_meet(p, first, p + 3 * first, 4 - first);
                }
                pairs[kind] = list.count;
                free(list.pairs);
            }
            CHECK_MSG(none.count[0] == count[0] && none.count[1] == count[1],
                      "%s: %" PRIu64 " %" PRIu64 " touch, not %" PRIu64 " %" PRIu64, name, count[0],
                      count[1], none.count[0], none.count[1]);
            CHECK_MSG(every.count[0] == pairs[0] && every.count[1] == pairs[1],
                      "%s: there are %" PRIu64 " %" PRIu64 ", not %" PRIu64 " %" PRIu64, name,
                      pairs[0], pairs[1], every.count[0], every.count[1]);
            near_truth_check(&s.q, &s.m, &none, 0, "touching");
            check_ways(&s, options, &every);
            touching += count[0] + count[1];
            all += pairs[0] + pairs[1];
            near_answer_free(&none);
            near_answer_free(&every);
        }
        scene_stop(&s);
    }
    CHECK_MSG(touching > 0 && all > touching, "%" PRIu64 " of %" PRIu64, touching, all);
}

/* Contours are looked for unless most leaf clusters have triangles that are lower than the distance:
   a cloth of cells of 1 x 1, altitudes 0.707, of which a part is stretched, to 0.99. */
static void wide_distances(void)
{
    static const struct {
        uint32_t stretched; /* of 40 columns */
        double distance;
        int looks;
    } cases[] = {{0, 0.1, 1},  {0, 0.65, 1},  {0, 0.75, 0},  {0, 3, 0},
                 {4, 0.75, 0}, {16, 0.65, 1}, {16, 0.75, 1}, {16, 1.1, 0}};
    for (uint32_t i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        const double from = 40 - (double)cases[i].stretched;
        soup cloth = soup_cloth(40, 40);
        sc_mesh mesh;
        sc_pose pose;
        sc_model *model = NULL;
        near_question q = {"stretched", NULL, NULL, &pose, 0};
        for (uint32_t v = 0; v < cloth.vertex_count; ++v) {
            double *p = cloth.positions + 3 * (size_t)v;
            p[0] *= 40;
            p[1] *= 40;
            if (p[0] > from) p[0] = from + 8 * (p[0] - from);
        }
        mesh = input_plain_mesh(&cloth);
        pose = input_plain_pose(cloth.positions, cloth.vertex_count);
        if (!CHECK(sc_build(&mesh, NULL, &model) == SC_OK)) return;
        q.model = model;
        q.workspace = near_workspace(model, 1);
        for (int way = 0; way < NEAR_WAYS; ++way) {
            sc_near_options options = near_options_for(&near_ways[way], cases[i].distance);
            near_answer all;
            if (!near_way_is_there(&near_ways[way], model, q.workspace, &pose)) continue;
            all = near_ask_all(&q, &options);
            CHECK_MSG((all.stats.nodes_visited > 0) ==
                          (cases[i].looks && options.method != SC_NEAR_METHOD_BOXES),
                      "case %" PRIu32 ", %s: %" PRIu64 " nodes", i, near_ways[way].name,
                      all.stats.nodes_visited);
            near_answer_free(&all);
        }
        sc_workspace_free(q.workspace);
        sc_model_free(model);
        soup_free(&cloth);
    }
}

SC_TEST_MAIN(SC_TEST(any_scene), SC_TEST(poses_of_steps), SC_TEST(adversaries),
             SC_TEST(soups_on_grids), SC_TEST(ties_on_flat_grids), SC_TEST(points_at_the_distance),
             SC_TEST(layers_at_the_distance), SC_TEST(many_edges_in_a_leaf),
             SC_TEST(none_apart_and_all), SC_TEST(wide_distances))
