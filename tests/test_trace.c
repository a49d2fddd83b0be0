/*
 * Contours of intersections: signs of points that have moved a little, against the oracle's
 * polynomials; contours, against a checker that has the oracle's crossings and knows nothing of how
 * contours were followed, on soups, meshes of every kind and adversaries; and arguments that cannot
 * be.
 *
 * SPDX-License-Identifier: MIT
 */
#include <float.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "adversaries.h"
#include "base/perturbed.h"
#include "harness.h"
#include "inputs.h"
#include "soups.h"
#include "starcontour.h"
#include "tasks.h"
#include "trace_oracle.h"
#include "trace_scene.h"
#include "traced_pose.h"

/* ---- signs ---- */

/* Four points of a small grid, often the same or in a plane, or far out. */
static void draw_points(double p[4][3])
{
    const uint32_t range = 1 + test_random_below(4);
    const double size = test_random_below(4) ? 1 : ldexp(1, (int)test_random_below(600) - 300);
    for (int i = 0; i < 12; ++i) p[i / 3][i % 3] = size * test_random_below(range);
}

static void signs_are_those_of_polynomials(void)
{
    uint32_t zero = 0;
    for (uint32_t n = test_iterations(3000); n > 0; --n) {
        double p[4][3];
        const double *points[4];
        uint32_t numbers[4];
        uint64_t fallbacks = 0;
        int sign, expected;
        draw_points(p);
        for (int i = 0; i < 4; ++i) {
            int is_new = 0;
            points[i] = p[i];
            while (!is_new) {
                numbers[i] = test_random_below(2) ? test_random_below(9) : (uint32_t)test_random();
                is_new = 1;
                for (int j = 0; j < i; ++j) is_new &= numbers[j] != numbers[i];
            }
        }
        expected = trace_oracle_sign(points, numbers);
        sign = sc_perturbed_orient3d(points, numbers, &fallbacks);
        zero += fallbacks > 0;
        if (!CHECK_MSG(sign == expected, "%d, not %d", sign, expected)) return;
    }
    CHECK_MSG(zero > 0 || !test_is_full(), "none was in a plane");
}

/* ---- contours ---- */

static int is_same_result(const sc_trace_result *a, const sc_trace_result *b)
{
    return a->node_count == b->node_count && a->contour_count == b->contour_count &&
           (!a->node_count ||
            memcmp(a->nodes, b->nodes, (size_t)a->node_count * sizeof *a->nodes) == 0) &&
           (!a->contour_count ||
            memcmp(a->contours, b->contours, (size_t)a->contour_count * sizeof *a->contours) == 0);
}

/* Whether all pairs of an edge and a triangle without a common vertex, most of which do not meet,
   give the same contours. */
static int check_all_pairs(const traced_pose *t, const sc_model *model, const sc_pose *pose)
{
    const size_t room = (size_t)t->truth.edge_count * t->triangle_count;
    sc_pair *pairs = (sc_pair *)test_allocate(room * sizeof *pairs);
    sc_trace_result other;
    uint64_t count = 0;
    int is_right;
    for (uint32_t e = 0; e < t->truth.edge_count; ++e)
        for (uint32_t b = 0; b < t->triangle_count; ++b) {
            const trace_oracle_edge *edge = &t->truth.edges[e];
            const uint32_t *corner = t->triangles + 3 * (size_t)b;
            int is_apart = 1;
            for (int k = 0; k < 3; ++k)
                is_apart &= corner[k] != edge->ends[0] && corner[k] != edge->ends[1];
            if (!is_apart) continue;
            pairs[count].a = edge->name;
            pairs[count++].b = b;
        }
    is_right = trace_scene_trace(model, pose, pairs, count, NULL, &other);
    if (is_right) {
        is_right = CHECK_MSG(is_same_result(&t->result, &other), "other pairs change contours");
        trace_scene_free_result(&other);
    }
    free(pairs);
    return is_right;
}

/* Traces a mesh in a pose, in some way of building, and checks all. Adds up what was seen. */
typedef struct tally {
    uint64_t contours, closed, one_sheet, border, branch, vertex;
} tally;

static int check_mesh(const soup *mesh, const double *pose, uint32_t weld, uint32_t partition,
                      tally *sum)
{
    input_choices choices = input_choose(mesh, weld, partition);
    const sc_mesh m = input_plain_mesh(mesh);
    const sc_pose p = input_plain_pose(pose, mesh->vertex_count);
    uint32_t *map = input_weld_of(&choices, mesh);
    sc_model *model = NULL;
    traced_pose t;
    sc_pair *pairs = NULL;
    uint64_t pair_count = 0;
    int is_right = 0;
    memset(&t, 0, sizeof t);
    if (CHECK(sc_build(&m, &choices.options, &model) == SC_OK)) {
        t.triangle_count = mesh->triangle_count;
        t.triangles = (uint32_t *)test_allocate(3 * (size_t)t.triangle_count * sizeof(uint32_t));
        for (uint32_t i = 0; i < 3 * t.triangle_count; ++i)
            t.triangles[i] = map[mesh->triangles[i]];
        t.positions = pose;
        pairs = trace_scene_find_pairs(model, &p, &pair_count);
        t.truth = trace_oracle_find(t.triangles, t.triangle_count, pose);
        is_right = trace_scene_trace(model, &p, pairs, pair_count, NULL, &t.result) &&
                   traced_pose_check(&t) && check_all_pairs(&t, model, &p);
        for (uint64_t i = 0; i < t.result.contour_count && is_right && sum; ++i) {
            const sc_trace_contour *c = &t.result.contours[i];
            ++sum->contours;
            sum->closed += c->begin == SC_TRACE_CLOSED;
            sum->one_sheet += c->flags == SC_TRACE_ONE_SHEET;
            sum->border += c->begin == SC_TRACE_BORDER;
            sum->branch += c->begin == SC_TRACE_BRANCH;
            sum->vertex += c->end == SC_TRACE_VERTEX;
        }
        trace_scene_free_result(&t.result);
        trace_oracle_free(&t.truth);
        free(pairs);
        free(t.triangles);
    }
    sc_model_free(model);
    free(map);
    input_free_choices(&choices);
    return is_right;
}

static void note_tally(const tally *sum)
{
    test_note("%" PRIu64 " contours: %" PRIu64 " closed, %" PRIu64 " from borders, %" PRIu64
              " from branches, %" PRIu64 " to vertices",
              sum->contours, sum->closed, sum->border, sum->branch, sum->vertex);
    CHECK(!test_is_full() || (sum->closed && sum->border && sum->branch && sum->vertex));
}

static uint32_t any_partition(void)
{
    return test_random_below(2) ? SC_PARTITION_FAST : SC_PARTITION_ORDER;
}

static void soups(void)
{
    tally sum;
    memset(&sum, 0, sizeof sum);
    for (uint32_t n = test_iterations(300); n > 0; --n) {
        const int is_grid = test_random_below(3) > 0;
        soup s = is_grid ? soup_on_grid(1 + test_random_below(6)) : soup_scattered();
        const int is_right =
            check_mesh(&s, s.positions, test_random_below(3), any_partition(), &sum);
        soup_free(&s);
        if (!is_right) return;
    }
    note_tally(&sum);
}

static void meshes(void)
{
    tally sum;
    memset(&sum, 0, sizeof sum);
    for (uint32_t n = test_iterations(60); n > 0; --n) {
        const char *name;
        soup s = soup_any_mesh(100, &name);
        double *pose = soup_copy_positions(&s);
        int is_right;
        soup_any_pose(pose, s.vertex_count);
        if (test_random_below(3) == 0) soup_snap(pose, s.vertex_count, 0.125);
        if (test_random_below(4) == 0)
            soup_scale(pose, s.vertex_count, ldexp(1, (int)test_random_below(1900) - 950));
        is_right = check_mesh(&s, pose, test_random_below(3), any_partition(), &sum);
        free(pose);
        soup_free(&s);
        if (!CHECK_MSG(is_right, "%s", name)) return;
    }
    note_tally(&sum);
}

/* Copies of a mesh, right on it: all is in a plane with all. */
static void equal_sheets(void)
{
    for (uint32_t n = test_iterations(20); n > 0; --n) {
        soup cloth = soup_cloth(1 + test_random_below(4), 1 + test_random_below(4));
        soup two = soup_join(&cloth, &cloth), three = soup_join(&two, &cloth);
        tally sum;
        int is_right;
        memset(&sum, 0, sizeof sum);
        is_right = check_mesh(&two, two.positions, SC_WELD_NONE, SC_PARTITION_FAST, &sum) &&
                   check_mesh(&three, three.positions, SC_WELD_NONE, SC_PARTITION_FAST, &sum);
        soup_free(&cloth);
        soup_free(&two);
        soup_free(&three);
        if (!is_right) return;
    }
}

static void adversaries(void)
{
    adversary (*const makers[])(void) = {adversary_slit,    adversary_strip,      adversary_petals,
                                         adversary_doubled, adversary_degenerate, adversary_moebius,
                                         adversary_klein,   adversary_book};
    tally sum;
    memset(&sum, 0, sizeof sum);
    for (uint32_t n = test_iterations(120); n > 0; --n) {
        adversary a = makers[n % (sizeof makers / sizeof *makers)]();
        double *pose;
        int is_right;
        for (uint32_t v = 0; v < a.mesh.vertex_count; ++v)
            if (a.twin[v] < a.mesh.vertex_count)
                memcpy(a.mesh.positions + 3 * (size_t)v, a.mesh.positions + 3 * (size_t)a.twin[v],
                       3 * sizeof(double));
        pose = soup_copy_positions(&a.mesh);
        is_right = check_mesh(&a.mesh, pose, SC_WELD_NONE, any_partition(), &sum);
        free(pose);
        adversary_free(&a);
        if (!is_right) return;
    }
    test_note("%" PRIu64 " contours", sum.contours);
}

static void strips_that_are_one(void)
{
    for (uint32_t turns = 0; turns < 6; ++turns)
        for (uint32_t n = test_iterations(5); n > 0; --n) {
            soup s = trace_scene_strips(20 + test_random_below(20), turns);
            tally sum;
            memset(&sum, 0, sizeof sum);
            if (check_mesh(&s, s.positions, SC_WELD_NONE, SC_PARTITION_FAST, &sum))
                CHECK_MSG(sum.contours == 1 && sum.closed == 1 && sum.one_sheet == turns % 2,
                          "%" PRIu64 " contours, %" PRIu64 " of one sheet after %u turns",
                          sum.contours, sum.one_sheet, turns);
            soup_free(&s);
        }
}

/* ---- what does not change contours ---- */

static void threads_change_nothing(void)
{
    soup mesh = trace_scene_cloths(80);
    trace_scene s;
    soup_snap(mesh.positions, mesh.vertex_count, 0x1p-8); /* some pairs that touch do not cross */
    if (trace_scene_open(&s, mesh, SC_MODEL_FULL)) {
        CHECK(s.count > s.result.node_count);
        CHECK_MSG(s.result.node_count > 500, "%" PRIu64 " nodes", s.result.node_count);
        for (int way = HOST_FIRST; way < HOST_COUNT; ++way)
            for (uint32_t workers = 1; workers <= 3; ++workers) {
                sc_trace_options options;
                sc_trace_result other;
                host h;
                memset(&options, 0, sizeof options);
                options.struct_size = sizeof options;
                host_start(&h, way, workers);
                options.tasks = &h.tasks;
                if (trace_scene_trace(s.model, &s.pose, s.pairs, s.count, &options, &other)) {
                    CHECK(is_same_result(&s.result, &other));
                    trace_scene_free_result(&other);
                }
                CHECK(!h.mistakes && (workers == 1 || h.parts > 0));
                host_stop(&h);
            }
    }
    trace_scene_close(&s);
}

/* Every instruction set, floats and doubles of the same values. */
static void instructions_change_nothing(void)
{
    for (uint32_t n = test_iterations(10); n > 0; --n) {
        soup mesh = trace_scene_cloths(5 + test_random_below(12));
        trace_scene s;
        soup_round_to_float(mesh.positions, mesh.vertex_count);
        if (test_random_below(2)) soup_snap(mesh.positions, mesh.vertex_count, 0x1p-5);
        if (trace_scene_open(&s, mesh, SC_MODEL_FULL))
            for (uint32_t simd = SC_SIMD_BASE; simd <= SC_SIMD_AVX512; ++simd)
                for (uint32_t floats = 0; floats < 2; ++floats) {
                    input_array positions =
                        input_positions(s.mesh.positions, s.mesh.vertex_count,
                                        floats ? SC_FLOAT : SC_DOUBLE, test_random_below(9));
                    const sc_pose pose = input_pose(s.mesh.vertex_count, &positions);
                    sc_trace_options options;
                    sc_trace_result other = trace_scene_no_room();
                    memset(&options, 0, sizeof options);
                    options.struct_size = sizeof options;
                    options.simd = simd;
                    if (sc_trace(s.model, &pose, s.pairs, s.count, &options, &other) ==
                        SC_ERROR_UNSUPPORTED) {
                        CHECK(simd != SC_SIMD_BASE);
                    } else if (trace_scene_trace(s.model, &pose, s.pairs, s.count, &options,
                                                 &other)) {
                        CHECK(is_same_result(&s.result, &other));
                        trace_scene_free_result(&other);
                    }
                    input_free(&positions);
                }
        trace_scene_close(&s);
    }
}

static void models_change_nothing(void)
{
    for (uint32_t n = test_iterations(10); n > 0; --n) {
        soup mesh = trace_scene_cloths(5 + test_random_below(10));
        trace_scene full, boxes;
        const int is_open = trace_scene_open(&full, soup_copy(&mesh), SC_MODEL_FULL);
        if (trace_scene_open(&boxes, mesh, SC_MODEL_BOXES) && is_open)
            CHECK(is_same_result(&full.result, &boxes.result));
        trace_scene_close(&full);
        trace_scene_close(&boxes);
    }
}

/* An order of things that sorts contours whatever their names: by length. */
static int compare_lengths(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Where nothing is in a plane, other numbers of vertices give the same contours. */
static void names_change_nothing(void)
{
    for (uint32_t n = test_iterations(10); n > 0; --n) {
        soup mesh = trace_scene_cloths(4 + test_random_below(8)), other = soup_copy(&mesh);
        const uint32_t count = mesh.vertex_count;
        uint32_t *name = (uint32_t *)test_allocate(count * sizeof *name);
        trace_scene a, b;
        int is_open;
        for (uint32_t v = 0; v < count; ++v) {
            const uint32_t w = test_random_below(v + 1);
            name[v] = name[w];
            name[w] = v;
        }
        for (uint32_t v = 0; v < count; ++v)
            memcpy(other.positions + 3 * (size_t)name[v], mesh.positions + 3 * (size_t)v,
                   3 * sizeof(double));
        for (uint32_t i = 0; i < 3 * mesh.triangle_count; ++i)
            other.triangles[i] = name[mesh.triangles[i]];
        free(name);
        is_open = trace_scene_open(&a, mesh, SC_MODEL_FULL);
        if (trace_scene_open(&b, other, SC_MODEL_FULL) && is_open &&
            CHECK(a.result.node_count == b.result.node_count &&
                  a.result.contour_count == b.result.contour_count)) {
            const uint64_t contours = a.result.contour_count;
            double *length = (double *)test_allocate((size_t)(2 * contours) * sizeof *length);
            for (uint64_t i = 0; i < contours; ++i) {
                length[i] = a.result.contours[i].length;
                length[contours + i] = b.result.contours[i].length;
            }
            qsort(length, (size_t)contours, sizeof *length, compare_lengths);
            qsort(length + contours, (size_t)contours, sizeof *length, compare_lengths);
            for (uint64_t i = 0; i < contours; ++i)
                if (!CHECK_MSG(fabs(length[i] - length[contours + i]) <= 1e-12 * length[i],
                               "%.17g and %.17g", length[i], length[contours + i]))
                    break;
            free(length);
        }
        trace_scene_close(&a);
        trace_scene_close(&b);
    }
}

/* ---- what cannot be ---- */

static void failing_memory(void)
{
    trace_scene s;
    int is_done = 0;
    if (trace_scene_open(&s, trace_scene_cloths(6), SC_MODEL_FULL))
        for (uint32_t times = 0; !is_done && times < 100; ++times) {
            sc_trace_options options;
            sc_trace_result r = s.result;
            scarce_memory memory;
            sc_status status;
            memset(&options, 0, sizeof options);
            options.struct_size = sizeof options;
            options.allocator = &memory.allocator;
            scarce_memory_start(&memory, times);
            status = sc_trace(s.model, &s.pose, s.pairs, s.count, &options, &r);
            is_done = status == SC_OK;
            CHECK(is_done ? r.node_count == s.result.node_count
                          : status == SC_ERROR_MEMORY && !r.node_count && !r.contour_count);
            CHECK(memory.live == 0);
        }
    CHECK(is_done);
    trace_scene_close(&s);
}

/* Cancelled by the allocator, each time it is called: so after each step. */
static void cancelling(void)
{
    trace_scene s;
    int is_done = 0;
    if (trace_scene_open(&s, trace_scene_cloths(6), SC_MODEL_FULL))
        for (uint32_t times = 0; !is_done && times < 100; ++times) {
            sc_trace_options options;
            sc_trace_result r = s.result;
            scarce_memory memory;
            sc_status status;
            memset(&options, 0, sizeof options);
            options.struct_size = sizeof options;
            scarce_memory_start(&memory, times);
            memory.cancels = 1;
            options.allocator = &memory.allocator;
            options.cancel = &memory.cancelled;
            status = sc_trace(s.model, &s.pose, s.pairs, s.count, &options, &r);
            is_done = !memory.cancelled;
            CHECK(is_done
                      ? status == SC_OK && is_same_result(&r, &s.result)
                      : status == SC_ERROR_INCOMPLETE && r.node_count == 0 && r.contour_count == 0);
            CHECK(memory.live == 0);
        }
    CHECK(is_done);
    trace_scene_close(&s);
}

/* The status of a trace of the first so many pairs. */
static sc_status try_pairs(const trace_scene *s, const sc_pair *pairs, uint64_t count)
{
    sc_trace_result r = s->result;
    const sc_status status = sc_trace(s->model, &s->pose, pairs, count, NULL, &r);
    CHECK(status == SC_OK || status == SC_ERROR_SHORT_BUFFER ||
          (!r.node_count && !r.contour_count));
    return status;
}

static void wrong_pairs(void)
{
    trace_scene s;
    if (trace_scene_open(&s, trace_scene_cloths(8), SC_MODEL_FULL) && CHECK(s.count > 8)) {
        sc_pair *pairs = (sc_pair *)test_allocate((size_t)(s.count + 1) * sizeof *pairs);
        for (uint64_t left_out = 0; left_out < s.count; ++left_out) {
            memcpy(pairs, s.pairs, (size_t)left_out * sizeof *pairs);
            memcpy(pairs + left_out, s.pairs + left_out + 1,
                   (size_t)(s.count - left_out - 1) * sizeof *pairs);
            CHECK(try_pairs(&s, pairs, s.count - 1) == SC_ERROR_PAIRS);
        }
        memcpy(pairs, s.pairs, (size_t)s.count * sizeof *pairs);
        pairs[3] = s.pairs[4];
        pairs[4] = s.pairs[3];
        CHECK(try_pairs(&s, pairs, s.count) == SC_ERROR_PAIRS);
        pairs[3] = s.pairs[4];
        pairs[4] = s.pairs[4];
        CHECK(try_pairs(&s, pairs, s.count) == SC_ERROR_PAIRS);
        memcpy(pairs, s.pairs, (size_t)s.count * sizeof *pairs);
        pairs[s.count - 1].b = s.mesh.triangle_count;
        CHECK(try_pairs(&s, pairs, s.count) == SC_ERROR_PAIRS);
        pairs[s.count - 1].a = 3 * s.mesh.triangle_count;
        pairs[s.count - 1].b = 0;
        CHECK(try_pairs(&s, pairs, s.count) == SC_ERROR_PAIRS);
        CHECK(try_pairs(&s, NULL, 0) == SC_OK);
        free(pairs);
    }
    trace_scene_close(&s);
}

/* Triangles with corners on a moment curve: none in a plane with another. */
static soup triangles_of(const uint32_t *corners, uint32_t count, uint32_t vertices)
{
    soup s = soup_make(vertices, count);
    memcpy(s.triangles, corners, 3 * (size_t)count * sizeof *corners);
    for (uint32_t v = 0; v < vertices; ++v)
        for (int k = 0; k < 3; ++k) s.positions[3 * (size_t)v + (size_t)k] = pow(v + 1, k + 1);
    return s;
}

/* Edges that end at a corner of the triangle, which sc_query does not pair with it. */
static void pairs_that_share_vertices(void)
{
    static const uint32_t corners[9] = {0, 1, 2, 0, 3, 4, 5, 1, 6};
    static const sc_pair pairs[] = {{0, 0}, {0, 1}, {0, 2}, {1, 0}, {2, 1}, {3, 0}, {7, 0}};
    static const sc_pair apart[] = {{0, 3}, {1, 1}};
    trace_scene s;
    if (trace_scene_open(&s, triangles_of(corners, 3, 7), SC_MODEL_FULL)) {
        for (size_t i = 0; i < sizeof pairs / sizeof *pairs; ++i)
            CHECK(try_pairs(&s, pairs + i, 1) == SC_ERROR_PAIRS);
        CHECK(try_pairs(&s, apart, 1) == SC_ERROR_PAIRS); /* there is no triangle 3 */
        CHECK(try_pairs(&s, apart + 1, 1) == SC_OK);
    }
    trace_scene_close(&s);
}

/* An upright triangle through a lying one: two crossings. Of a third welding makes a line from one
   point of the first to another: its edges, and what passes through it, change nothing. */
static void collapsed_triangles(void)
{
    static const double positions[27] = {0,  0, 0, 8, 0, 0, 0,  8, 0, 1,  1, -2, 3, 1,
                                         -2, 2, 2, 2, 1, 1, -2, 1, 1, -2, 2, 2,  2};
    soup mesh = soup_make(9, 3);
    sc_build_options options;
    sc_model *model = NULL;
    sc_mesh m;
    sc_pose pose;
    memcpy(mesh.positions, positions, sizeof positions);
    for (uint32_t i = 0; i < 9; ++i) mesh.triangles[i] = i;
    memset(&options, 0, sizeof options);
    options.struct_size = sizeof options;
    options.weld = SC_WELD_REST;
    m = input_plain_mesh(&mesh);
    pose = input_plain_pose(mesh.positions, mesh.vertex_count);
    if (CHECK(sc_build(&m, &options, &model) == SC_OK)) {
        static const sc_pair right[] = {{4, 0}, {5, 0}};
        static const sc_pair more[] = {{0, 2}, {1, 2}, {4, 0}, {5, 0}, {6, 0}};
        sc_trace_result a, b;
        if (trace_scene_trace(model, &pose, right, 2, NULL, &a)) {
            CHECK(a.node_count == 2 && a.contour_count == 1);
            if (trace_scene_trace(model, &pose, more, 5, NULL, &b)) {
                CHECK(is_same_result(&a, &b));
                trace_scene_free_result(&b);
            }
            trace_scene_free_result(&a);
        }
    }
    sc_model_free(model);
    soup_free(&mesh);
}

/* An edge of 2^16 triangles and another triangle 2^15 times, each of which it crosses. */
static void too_many_branches(void)
{
    const uint32_t fan = 1u << 16, crossed = 1u << 15;
    static const double positions[18] = {1, 1, -1, 1, 1, 1, 9, 9, 0, 0, 0, 0, 4, 0, 0, 0, 4, 0};
    soup mesh = soup_make(6, fan + crossed);
    sc_pair *pairs = (sc_pair *)test_allocate(crossed * sizeof *pairs);
    sc_build_options options;
    sc_model *model = NULL;
    sc_mesh m;
    sc_pose pose;
    memcpy(mesh.positions, positions, sizeof positions);
    for (uint32_t i = 0; i < 3 * mesh.triangle_count; ++i)
        mesh.triangles[i] = i % 3 + (i < 3 * fan ? 0 : 3);
    for (uint32_t i = 0; i < crossed; ++i) {
        pairs[i].a = 0;
        pairs[i].b = fan + i;
    }
    memset(&options, 0, sizeof options);
    options.struct_size = sizeof options;
    options.weld = SC_WELD_NONE;
    options.content = SC_MODEL_BOXES;
    m = input_plain_mesh(&mesh);
    pose = input_plain_pose(mesh.positions, mesh.vertex_count);
    if (CHECK(sc_build(&m, &options, &model) == SC_OK)) {
        sc_trace_result r = trace_scene_no_room();
        CHECK(sc_trace(model, &pose, pairs, crossed, NULL, &r) == SC_ERROR_COUNT);
        CHECK(r.node_count == 0 && r.contour_count == 0);
        /* two of them are not too many, but other ends are missing */
        CHECK(sc_trace(model, &pose, pairs, 2, NULL, &r) == SC_ERROR_PAIRS);
    }
    sc_model_free(model);
    free(pairs);
    soup_free(&mesh);
}

static void wrong_arguments(void)
{
    trace_scene s;
    if (trace_scene_open(&s, trace_scene_cloths(8), SC_MODEL_FULL)) {
        sc_trace_result r = s.result;
        sc_trace_options options;
        sc_pose pose = s.pose;
        volatile uint32_t flag = 1;
        sc_allocator allocator;
        sc_tasks tasks;
        double *bad;
        memset(&options, 0, sizeof options);
        options.struct_size = sizeof options;
        CHECK(sc_trace(NULL, &s.pose, s.pairs, s.count, NULL, &r) == SC_ERROR_NULL &&
              !r.node_count && !r.contour_count);
        CHECK(sc_trace(s.model, NULL, s.pairs, s.count, NULL, &r) == SC_ERROR_NULL);
        CHECK(sc_trace(s.model, &s.pose, NULL, s.count, NULL, &r) == SC_ERROR_NULL);
        CHECK(sc_trace(s.model, &s.pose, s.pairs, s.count, NULL, NULL) == SC_ERROR_NULL);
        CHECK(sc_trace(s.model, &s.pose, s.pairs, UINT64_C(1) << 31, NULL, &r) == SC_ERROR_COUNT);
        r.nodes = NULL;
        CHECK(sc_trace(s.model, &s.pose, s.pairs, s.count, NULL, &r) == SC_ERROR_NULL);
        r = s.result;
        r.contours = NULL;
        CHECK(sc_trace(s.model, &s.pose, s.pairs, s.count, NULL, &r) == SC_ERROR_NULL);
        r = s.result;
        r.struct_size = 8;
        CHECK(sc_trace(s.model, &s.pose, s.pairs, s.count, NULL, &r) == SC_ERROR_STRUCT_SIZE);
        r = s.result;
        --r.node_capacity;
        CHECK(sc_trace(s.model, &s.pose, s.pairs, s.count, NULL, &r) == SC_ERROR_SHORT_BUFFER &&
              r.node_count == s.result.node_count && r.contour_count == s.result.contour_count);
        r = s.result;
        --r.contour_capacity;
        CHECK(sc_trace(s.model, &s.pose, s.pairs, s.count, NULL, &r) == SC_ERROR_SHORT_BUFFER &&
              r.node_count == s.result.node_count && r.contour_count == s.result.contour_count);
        r = s.result;
        options.simd = SC_SIMD_AVX512 + 1;
        CHECK(sc_trace(s.model, &s.pose, s.pairs, s.count, &options, &r) == SC_ERROR_OPTION);
        options.simd = SC_SIMD_BEST;
        options.struct_size = 4;
        CHECK(sc_trace(s.model, &s.pose, s.pairs, s.count, &options, &r) == SC_ERROR_STRUCT_SIZE);
        options.struct_size = sizeof options;
        options.cancel = &flag;
        CHECK(sc_trace(s.model, &s.pose, s.pairs, s.count, &options, &r) == SC_ERROR_INCOMPLETE &&
              r.node_count == 0);
        options.cancel = NULL;
        memset(&allocator, 0, sizeof allocator);
        options.allocator = &allocator;
        CHECK(sc_trace(s.model, &s.pose, s.pairs, s.count, &options, &r) == SC_ERROR_NULL);
        options.allocator = NULL;
        memset(&tasks, 0, sizeof tasks);
        tasks.struct_size = 4;
        options.tasks = &tasks;
        CHECK(sc_trace(s.model, &s.pose, s.pairs, s.count, &options, &r) == SC_ERROR_STRUCT_SIZE);
        --pose.vertex_count;
        CHECK(sc_trace(s.model, &pose, s.pairs, s.count, NULL, &r) == SC_ERROR_VERTEX_COUNT);
        bad = soup_copy_positions(&s.mesh);
        for (uint32_t i = 0; i < 3 * s.mesh.vertex_count; ++i) bad[i] = (double)NAN;
        pose = input_plain_pose(bad, s.mesh.vertex_count);
        CHECK(sc_trace(s.model, &pose, s.pairs, s.count, NULL, &r) == SC_ERROR_NOT_FINITE);
        CHECK(sc_trace(s.model, &pose, s.pairs, 3, NULL, &r) == SC_ERROR_NOT_FINITE);
        free(bad);
    }
    trace_scene_close(&s);
}

SC_TEST_MAIN(SC_TEST(signs_are_those_of_polynomials), SC_TEST(soups), SC_TEST(meshes),
             SC_TEST(equal_sheets), SC_TEST(adversaries), SC_TEST(strips_that_are_one),
             SC_TEST(threads_change_nothing), SC_TEST(instructions_change_nothing),
             SC_TEST(models_change_nothing), SC_TEST(names_change_nothing), SC_TEST(failing_memory),
             SC_TEST(cancelling), SC_TEST(wrong_pairs), SC_TEST(pairs_that_share_vertices),
             SC_TEST(collapsed_triangles), SC_TEST(too_many_branches), SC_TEST(wrong_arguments))
