/*
 * Queries of steps: all methods against all pairs decided by the narrow phase alone, and the
 * interface.
 *
 * That the narrow phase itself is right is the matter of test_impact, and that nothing is lost
 * against exact arithmetic that of test_step_oracle.
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
#include "starcontour.h"
#include "step_check.h"

/* One random step of a mesh: the poses of soups.h, a small or a large motion. */
static void try_step(const soup *mesh, const char *name)
{
    size_t bytes = 3 * (size_t)mesh->vertex_count * sizeof(double);
    double *start = (double *)test_allocate(bytes), *end = (double *)test_allocate(bytes);
    sc_impact_limits limits;
    timed_list lists[STEP_KINDS];
    input_choices choices = input_choose(mesh, SC_WELD_REST, test_random_below(4));
    step_subject s;
    memcpy(start, mesh->positions, bytes);
    if (test_random_below(2)) soup_any_pose(start, mesh->vertex_count);
    memcpy(end, start, bytes);
    switch (test_random_below(6)) {
    case 0:
        soup_any_pose(end, mesh->vertex_count);
        break;
    case 1: {
        double far = pow(10, test_random_range(-4, 0));
        for (uint32_t i = 0; i < 3 * mesh->vertex_count; ++i)
            end[i] += test_random_range(-far, far);
        break;
    }
    case 2:
        for (uint32_t i = 0; i < 3 * mesh->vertex_count; ++i) end[i] += i % 3 == 0 ? 5 : 0;
        if (mesh->vertex_count > 3)
            end[3 * test_random_below(mesh->vertex_count)] -= 3; /* teleported */
        break;
    default:
        break;
    }
    limits.separation = test_random_below(3) ? 0 : pow(10, test_random_range(-5, -1));
    limits.tolerance = pow(10, test_random_range(-5, -3));
    limits.latest = 1;
    step_solve(mesh, start, end, &limits, lists);
    if (step_open(&s, mesh, &choices.options))
        step_check_methods(mesh, &s, start, end, &limits, lists, name);
    step_close(&s);
    step_free_lists(lists);
    input_free_choices(&choices);
    free(start);
    free(end);
}

/* All methods on a step that has pairs in most cases. */
static void check_near_step(const soup *mesh, const double *start, const double *end,
                            double separation, const char *what)
{
    const sc_impact_limits limits = {separation, 1e-4, 1};
    step_check(mesh, start, end, &limits, what);
}

/* The same with a tolerance of that size; few candidates are left. Returns how many vertex-face
   pairs collide. */
static uint64_t check_tiny_step(const soup *mesh, const double *start, const double *end,
                                double tolerance)
{
    uint64_t count;
    sc_impact_limits limits = {0, tolerance, 1};
    timed_list lists[STEP_KINDS];
    input_choices choices = input_choose(mesh, SC_WELD_NONE, SC_PARTITION_FAST);
    step_subject s;
    step_solve(mesh, start, end, &limits, lists);
    if (step_open(&s, mesh, &choices.options)) {
        sc_pose from = input_plain_pose(start, mesh->vertex_count);
        sc_pose to = input_plain_pose(end, mesh->vertex_count);
        sc_step_options o = step_plain_options();
        step_answer a = step_make_answer(0);
        step_check_methods(mesh, &s, start, end, &limits, lists, "tiny");
        o.output = SC_OUTPUT_COUNT;
        o.pairs = SC_STEP_CANDIDATES;
        o.tolerance = tolerance;
        CHECK(sc_query_step(s.model, s.workspace, &from, &to, &o, &a.result) == SC_OK);
        CHECK_MSG(a.result.vertex_face_count >= lists[0].count &&
                      5 * a.result.vertex_face_count < mesh->vertex_count * mesh->triangle_count,
                  "%" PRIu64 " candidates", a.result.vertex_face_count);
        step_free_answer(&a);
    }
    count = lists[0].count;
    step_close(&s);
    step_free_lists(lists);
    input_free_choices(&choices);
    return count;
}

static void soups_that_move(void)
{
    for (uint32_t i = 0; i < test_iterations(400) && test_failures() == 0; ++i) {
        soup s = i % 2 ? soup_on_grid(4) : soup_scattered();
        try_step(&s, i % 2 ? "grid" : "scattered");
        soup_free(&s);
    }
}

static void meshes_that_move(void)
{
    for (uint32_t i = 0; i < test_iterations(12) && test_failures() == 0; ++i) {
        const char *name;
        soup s = shape_any(150, &name);
        try_step(&s, name);
        soup_free(&s);
    }
}

/* A cloth whose right half is folded over the left one, at a slope: 0 brings them together. */
static double *fold(const soup *mesh, double slope)
{
    double *to = (double *)test_allocate(3 * (size_t)mesh->vertex_count * sizeof(double));
    memcpy(to, mesh->positions, 3 * (size_t)mesh->vertex_count * sizeof(double));
    for (uint32_t v = 0; v < mesh->vertex_count; ++v) {
        double *p = to + 3 * (size_t)v, beyond = p[0] - 0.5;
        if (beyond > 0) {
            p[0] = 0.5 - 0.97 * beyond;
            p[2] = slope * beyond;
        }
    }
    return to;
}

/* Puts the points inside a cloth of 3 x 3 cells somewhere in its plane so that all triangles keep a
   positive area. */
static void rearrange(const soup *mesh, double *to)
{
    int good = 0;
    while (!good) {
        good = 1;
        for (uint32_t v = 0; v < mesh->vertex_count; ++v) {
            const double *p = mesh->positions + 3 * (size_t)v;
            int inside = p[0] > 0.01 && p[0] < 0.99 && p[1] > 0.01 && p[1] < 0.99;
            for (int k = 0; k < 3; ++k)
                to[3 * (size_t)v + (size_t)k] =
                    inside && k < 2 ? test_random_range(0.05, 0.95) : p[k];
        }
        for (uint32_t i = 0; i < mesh->triangle_count && good; ++i) {
            const double *c[3];
            for (int k = 0; k < 3; ++k)
                c[k] = to + 3 * (size_t)mesh->triangles[3 * i + (uint32_t)k];
            good = (c[1][0] - c[0][0]) * (c[2][1] - c[0][1]) -
                       (c[1][1] - c[0][1]) * (c[2][0] - c[0][0]) >
                   0.005;
        }
    }
}

/* The contour stays; inside, triangles turn over on the way although they lie well at both ends, or
   are so flat that points come near. Culling must see that without the contour's help. */
static void rearranged_insides(void)
{
    soup mesh = soup_cloth(3, 3);
    size_t bytes = 3 * (size_t)mesh.vertex_count * sizeof(double);
    double *start = (double *)test_allocate(bytes), *end = (double *)test_allocate(bytes);
    uint32_t hits = 0;
    step_subject s;
    if (step_open(&s, &mesh, NULL))
        for (uint32_t i = 0; i < test_iterations(150) && test_failures() == 0; ++i) {
            sc_impact_limits limits;
            timed_list lists[STEP_KINDS];
            rearrange(&mesh, start);
            rearrange(&mesh, end);
            if (i % 3 == 0) memcpy(end, start, bytes);
            limits.separation = i % 3 == 1 ? 0 : test_random_range(0.001, 0.05);
            limits.tolerance = 1e-4;
            limits.latest = 1;
            step_solve(&mesh, start, end, &limits, lists);
            hits += lists[0].count + lists[1].count > 0;
            step_check_methods(&mesh, &s, start, end, &limits, lists, "rearranged");
            step_free_lists(lists);
        }
    test_note("%u steps with pairs", hits);
    step_close(&s);
    soup_free(&mesh);
    free(start);
    free(end);
}

/* A small cloth that falls through a large one: two pieces whose contours lie inside one another.
   corner: they share one, and lie in each other's corner, where contours touch. */
static void pieces_inside_one_another(void)
{
    for (uint32_t i = 0; i < test_iterations(24) && test_failures() == 0; ++i) {
        int corner = i % 2;
        soup large = soup_cloth(4, 4), small = soup_cloth(2 + i % 3, 2), both;
        double *end, across[2], along[2];
        uint32_t first = large.vertex_count;
        for (int k = 0; k < 2; ++k) { /* between the large one's sides */
            across[k] = k ? 0.15 + 0.1 * test_random_unit() : 0.4;
            along[k] = k ? 0.4 : 0.15 + 0.1 * test_random_unit();
        }
        for (uint32_t v = 0; v < small.vertex_count; ++v) {
            double *p = small.positions + 3 * (size_t)v, x = p[0], y = p[1];
            for (int k = 0; k < 2; ++k) p[k] = across[k] * x + along[k] * y + (corner ? 0 : 0.2);
            p[2] = corner ? 0.3 * (x + y) : 0.1;
        }
        both = soup_join(&large, &small);
        end = (double *)test_allocate(3 * (size_t)both.vertex_count * sizeof(double));
        memcpy(end, both.positions, 3 * (size_t)both.vertex_count * sizeof(double));
        for (uint32_t v = first; v < both.vertex_count; ++v) end[3 * (size_t)v + 2] *= -1;
        check_near_step(&both, both.positions, end, 0,
                        corner ? "a corner in a corner" : "a piece in a piece");
        free(end);
        soup_free(&large);
        soup_free(&small);
        soup_free(&both);
    }
}

/* A strip bent in its plane so that its ends nearly meet, nearer than the separation; or meet on
   the way. */
static void ends_that_nearly_meet(void)
{
    for (uint32_t i = 0; i < test_iterations(40) && test_failures() == 0; ++i) {
        soup mesh = soup_cloth(2, 20);
        double *to[2];
        for (int k = 0; k < 2; ++k) {
            double angle = test_random_range(6.1, k && i % 4 == 1 ? 6.5 : 6.27);
            to[k] = (double *)test_allocate(3 * (size_t)mesh.vertex_count * sizeof(double));
            for (uint32_t v = 0; v < mesh.vertex_count; ++v) {
                const double *p = mesh.positions + 3 * (size_t)v;
                double *q = to[k] + 3 * (size_t)v, far = 1 - 0.3 * p[1];
                q[0] = far * cos(angle * p[0]);
                q[1] = far * sin(angle * p[0]);
                q[2] = 0;
            }
        }
        check_near_step(&mesh, to[0], to[i % 2], i % 4 == 1 ? 0 : test_random_range(0.02, 0.1),
                        "a strip");
        free(to[0]);
        free(to[1]);
        soup_free(&mesh);
    }
}

/* Long strips bent in their plane, of which any two parts may come near each other or cross:
   contours of three and more times sixty-four edges, in any direction. */
static void long_strips(void)
{
    for (uint32_t i = 0; i < test_iterations(16) && test_failures() == 0; ++i) {
        soup mesh = soup_cloth(2, 80 + i);
        double turn = test_random_range(0, 6.3), bend = test_random_range(2, 12);
        double slower = test_random_range(0.2, 1), *to[2];
        for (int k = 0; k < 2; ++k) {
            to[k] = (double *)test_allocate(3 * (size_t)mesh.vertex_count * sizeof(double));
            for (uint32_t v = 0; v < mesh.vertex_count; ++v) {
                const double *p = mesh.positions + 3 * (size_t)v;
                double *q = to[k] + 3 * (size_t)v, along = i % 4 == 0 ? p[0] : 0;
                double angle = turn + (i % 4 == 0 ? 0 : bend * p[0]);
                double far =
                    (i % 4 == 0 ? 0 : exp(-slower * p[0])) + 0.02 * p[1] - 0.01 * k * (i % 2);
                q[0] = far * cos(angle) - along * sin(angle);
                q[1] = far * sin(angle) + along * cos(angle);
                q[2] = 0;
            }
        }
        check_near_step(&mesh, to[0], to[1], i % 3 == 0 ? 0.001 : 0, "a long strip");
        free(to[0]);
        free(to[1]);
        soup_free(&mesh);
    }
}

/* A cloth and its folding, in doubles so small that to bring them to size takes more than a factor
   that is a double. */
static void denormal_meshes(void)
{
    uint64_t count = 0;
    for (uint32_t i = 0; i < test_iterations_at_least(12, 4) && test_failures() == 0; ++i) {
        soup mesh = soup_cloth(5, 5);
        double *end = fold(&mesh, i % 3 * 0.1), least = ldexp(1, -1044 + (int)i);
        for (uint32_t k = 0; k < 3 * mesh.vertex_count; ++k) {
            mesh.positions[k] = round(1000 * mesh.positions[k]) * least;
            end[k] = round(1000 * end[k]) * least;
        }
        count += check_tiny_step(&mesh, mesh.positions, end, 10 * least);
        free(end);
        soup_free(&mesh);
    }
    CHECK(count > 10);
}

/* A disc but for a narrow sector, whose sides a point of the disc sees, but that is narrower than
   the separation. */
static void narrow_notches(void)
{
    enum { SECTORS = 16 };
    for (uint32_t i = 0; i < test_iterations(60) && test_failures() == 0; ++i) {
        soup s = soup_make(SECTORS + 2, SECTORS);
        double notch = test_random_range(0.1, 0.2), turn = test_random_range(0, 6.3);
        s.positions[0] = s.positions[1] = s.positions[2] = 0;
        for (uint32_t v = 1; v < s.vertex_count; ++v) {
            double at = turn + (6.2831853 - notch) * (v - 1) / SECTORS;
            s.positions[3 * v] = cos(at);
            s.positions[3 * v + 1] = sin(at);
            s.positions[3 * v + 2] = 0;
        }
        for (uint32_t t = 0; t < SECTORS; ++t) {
            s.triangles[3 * t] = 0;
            s.triangles[3 * t + 1] = t + 1;
            s.triangles[3 * t + 2] = t + 2;
        }
        check_near_step(&s, s.positions, s.positions, notch + 0.02, "a notch");
        soup_free(&s);
    }
}

/* A flat ring round a hole of three corners, of which one dips below the side across from it, or
   nearly, while that turns: at both ends the hole is the right way round, and each of its edges
   shares a point with each other one, so that only how they turn there can tell. */
static void holes_of_three_corners(void)
{
    static const uint32_t triangles[] = {1, 0, 3, 2, 1, 4, 0, 2, 5, 0, 5, 3, 1, 3, 4, 2, 4, 5};
    uint32_t dipped = 0;
    for (uint32_t i = 0; i < test_iterations(200) && test_failures() == 0; ++i) {
        const double depth = test_random_range(-0.2, 0.2), far = test_random_range(5, 30);
        const double turn = test_random_range(0, 6.3);
        double to[2][18];
        soup s = soup_make(6, 6);
        memcpy(s.triangles, triangles, sizeof(triangles));
        for (int end = 0; end < 2; ++end) {
            const double t = end ? 1 : -1;
            const double corner[6][2] = {{0, 0},
                                         {1, t},
                                         {0.5 - 0.3 * t, 0.5 * t - depth},
                                         {0.5, -far},
                                         {0.25 * far, far},
                                         {-0.25 * far, far}};
            for (int v = 0; v < 6; ++v) {
                double x = corner[v][0], y = corner[v][1] * (i % 2 ? 1 : -1);
                to[end][3 * v] = x * cos(turn) - y * sin(turn);
                to[end][3 * v + 1] = x * sin(turn) + y * cos(turn);
                to[end][3 * v + 2] = 0;
            }
        }
        memcpy(s.positions, to[0], sizeof(to[0]));
        dipped += depth > 0.01;
        check_near_step(&s, to[0], to[1], i % 3 ? 0 : 0.01, "a hole");
        soup_free(&s);
    }
    CHECK_MSG(dipped >= test_iterations(40), "%u holes", (unsigned)dipped);
}

/* Flat or nearly so, so that contours are all that keeps things apart; with patches in any number
   of pieces. */
static void flat_meshes_that_move(void)
{
    for (uint32_t i = 0; i < test_iterations(120) && test_failures() == 0; ++i) {
        soup s;
        switch (i % 6) {
        case 0:
            s = soup_cloth(4 + test_random_below(8), 4 + test_random_below(8));
            break;
        case 1:
            s = soup_annulus(8 + test_random_below(16), 2 + test_random_below(3));
            break;
        case 2:
            s = soup_pinched(2 + test_random_below(4));
            break;
        case 3:
            s = shape_spiral(30 + test_random_below(30), 1 + test_random_below(2),
                             test_random_range(0.5, 2), 0);
            break;
        case 4:
            s = shape_hub(8 + test_random_below(60));
            break;
        default:
            s = shape_broken_cloth(4 + test_random_below(6));
            break;
        }
        try_step(&s, "flat");
        soup_free(&s);
    }
}

static void arrays_and_counts(void)
{
    soup mesh = soup_cloth(12, 12);
    double *start = fold(&mesh, 0.6), *end = fold(&mesh, -0.4);
    sc_pose from = input_plain_pose(start, mesh.vertex_count),
            to = input_plain_pose(end, mesh.vertex_count);
    step_subject s;
    if (step_open(&s, &mesh, NULL)) {
        step_answer all = step_make_answer(100000), a = step_make_answer(100000);
        sc_step_options o = step_plain_options();
        uint64_t v, e;
        o.times = SC_STEP_TIMES_EACH;
        CHECK(sc_query_step(s.model, s.workspace, &from, &to, &o, &all.result) == SC_OK);
        v = all.result.vertex_face_count;
        e = all.result.edge_edge_count;
        CHECK_MSG(v > 50 && e > 50, "%" PRIu64 ", %" PRIu64, v, e);
        CHECK(all.result.collides == 1 && all.result.verdict == SC_VERDICT_FOUND);
        CHECK(all.result.earliest > 0 && all.result.earliest < 1);
        for (uint64_t n = 0; n < e; n += e / 7 + 1) { /* short arrays hold the first ones */
            a.result.vertex_face_capacity = n < v ? n : v;
            a.result.edge_edge_capacity = n;
            CHECK(sc_query_step(s.model, s.workspace, &from, &to, &o, &a.result) ==
                  SC_ERROR_SHORT_BUFFER);
            CHECK(a.result.vertex_face_count == v && a.result.edge_edge_count == e);
            CHECK(a.result.earliest == all.result.earliest);
            CHECK(memcmp(a.result.edge_edges, all.result.edge_edges, (size_t)n * sizeof(sc_pair)) ==
                  0);
            CHECK(memcmp(a.result.edge_edge_times, all.result.edge_edge_times,
                         (size_t)n * sizeof(double)) == 0);
            CHECK(memcmp(a.result.vertex_faces, all.result.vertex_faces,
                         (size_t)a.result.vertex_face_capacity * sizeof(sc_pair)) == 0);
        }
        o.output = SC_OUTPUT_COUNT;
        CHECK(sc_query_step(s.model, s.workspace, &from, &to, &o, &a.result) == SC_OK);
        CHECK(a.result.vertex_face_count == v && a.result.edge_edge_count == e);
        o.output = SC_OUTPUT_ANY;
        CHECK(sc_query_step(s.model, s.workspace, &from, &to, &o, &a.result) == SC_OK);
        CHECK(a.result.vertex_face_count + a.result.edge_edge_count == 1);
        CHECK(a.result.collides == 1 && a.result.earliest == all.result.earliest);
        o.times = SC_STEP_TIMES_NONE;
        CHECK(sc_query_step(s.model, s.workspace, &from, &to, &o, &a.result) == SC_OK);
        CHECK(a.result.collides == 1 && a.result.earliest == 0);
        /* a still mesh collides with nothing */
        o.output = SC_OUTPUT_PAIRS;
        CHECK(sc_query_step(s.model, s.workspace, &from, &from, &o, &a.result) == SC_OK);
        CHECK(a.result.collides == 0 && a.result.earliest == 1);
        CHECK(a.result.verdict == SC_VERDICT_CLEAN);
        step_free_answer(&all);
        step_free_answer(&a);
    }
    step_close(&s);
    soup_free(&mesh);
    free(start);
    free(end);
}

static void ends_early(void)
{
    soup mesh = soup_cloth(16, 16);
    double *start = fold(&mesh, 0.6), *end = fold(&mesh, -0.4);
    sc_pose from = input_plain_pose(start, mesh.vertex_count),
            to = input_plain_pose(end, mesh.vertex_count);
    step_subject s;
    if (step_open(&s, &mesh, NULL)) {
        step_answer all = step_make_answer(100000), a = step_make_answer(100000);
        sc_step_options o = step_plain_options();
        volatile uint32_t flag = 1;
        uint64_t budget = 1, work = 0, stopped = 0;
        sc_status status = SC_ERROR_INCOMPLETE;
        all.stats.struct_size = sizeof(all.stats);
        all.result.stats = &all.stats;
        CHECK(sc_query_step(s.model, s.workspace, &from, &to, &o, &all.result) == SC_OK);
        for (int i = SC_TASK_ORIENTATION; i < SC_TASK_COUNT; ++i) work += all.stats.counts[i];
        o.cancel = &flag;
        CHECK(sc_query_step(s.model, s.workspace, &from, &to, &o, &a.result) ==
              SC_ERROR_INCOMPLETE);
        CHECK(a.result.verdict == SC_VERDICT_INCOMPLETE && a.result.earliest == 0);
        o.cancel = NULL;
        for (; status == SC_ERROR_INCOMPLETE; budget *= 3) {
            o.budget = budget;
            status = sc_query_step(s.model, s.workspace, &from, &to, &o, &a.result);
            CHECK(status == SC_OK || budget <= work);
            CHECK(status == SC_ERROR_INCOMPLETE || status == SC_OK);
            stopped += status == SC_ERROR_INCOMPLETE;
            CHECK(a.result.edge_edge_count <= all.result.edge_edge_count);
        }
        CHECK(a.result.edge_edge_count == all.result.edge_edge_count);
        CHECK_MSG(stopped > 3, "%" PRIu64 " budgets were too small", stopped);
        step_free_answer(&all);
        step_free_answer(&a);
    }
    step_close(&s);
    soup_free(&mesh);
    free(start);
    free(end);
}

static void refuses_what_does_not_fit(void)
{
    soup mesh = soup_cloth(3, 3), other = soup_cloth(4, 3);
    sc_pose pose = input_plain_pose(mesh.positions, mesh.vertex_count), bad = pose;
    sc_step_options o = step_plain_options();
    step_answer a = step_make_answer(16);
    step_subject s, t;
    sc_workspace *plain = NULL;
    double nan_at[3 * 16];
    sc_tasks tasks;
    if (step_open(&s, &mesh, NULL) && step_open(&t, &other, NULL) &&
        CHECK(sc_workspace_create(s.model, NULL, &plain) == SC_OK)) {
#define ASK(start, end) sc_query_step(s.model, s.workspace, start, end, &o, &a.result)
        CHECK(ASK(&pose, &pose) == SC_OK);
        CHECK(sc_query_step(s.model, s.workspace, &pose, &pose, NULL, &a.result) == SC_OK);
        CHECK(sc_query_step(NULL, s.workspace, &pose, &pose, &o, &a.result) == SC_ERROR_NULL);
        CHECK(sc_query_step(s.model, NULL, &pose, &pose, &o, &a.result) == SC_ERROR_NULL);
        CHECK(sc_query_step(s.model, s.workspace, &pose, &pose, &o, NULL) == SC_ERROR_NULL);
        CHECK(ASK(NULL, &pose) == SC_ERROR_NULL);
        CHECK(ASK(&pose, NULL) == SC_ERROR_NULL);
        CHECK(sc_query_step(s.model, t.workspace, &pose, &pose, &o, &a.result) ==
              SC_ERROR_WORKSPACE);
        CHECK(sc_query_step(s.model, plain, &pose, &pose, &o, &a.result) == SC_ERROR_WORKSPACE);
        bad.vertex_count++;
        CHECK(ASK(&pose, &bad) == SC_ERROR_VERTEX_COUNT);
        CHECK(ASK(&bad, &pose) == SC_ERROR_VERTEX_COUNT);
        bad = pose;
        memcpy(nan_at, mesh.positions, sizeof(nan_at));
        nan_at[7] = (double)NAN;
        bad.positions = nan_at;
        CHECK(ASK(&pose, &bad) == SC_ERROR_NOT_FINITE);
        CHECK(a.result.verdict == SC_VERDICT_NONE && a.result.earliest == 0);
        CHECK(ASK(&bad, &pose) == SC_ERROR_NOT_FINITE);
        nan_at[7] = HUGE_VAL;
        CHECK(ASK(&bad, &pose) == SC_ERROR_NOT_FINITE);
#define REFUSED(member, value, status)                                                             \
  do {                                                                                             \
    o = step_plain_options();                                                                      \
    o.member = value;                                                                              \
    CHECK(ASK(&pose, &pose) == status);                                                            \
    o = step_plain_options();                                                                      \
  } while (0)
        REFUSED(struct_size, 4, SC_ERROR_STRUCT_SIZE);
        REFUSED(output, 3, SC_ERROR_OPTION);
        REFUSED(pairs, 2, SC_ERROR_OPTION);
        REFUSED(times, 3, SC_ERROR_OPTION);
        REFUSED(method, 4, SC_ERROR_OPTION);
        REFUSED(contour, 4, SC_ERROR_OPTION);
        REFUSED(simd, 9, SC_ERROR_OPTION);
        REFUSED(reserved, 1, SC_ERROR_OPTION);
        memset(&tasks, 0, sizeof(tasks));
        tasks.struct_size = sizeof(tasks);
        REFUSED(tasks, &tasks, SC_ERROR_NULL);
        REFUSED(separation, -1e-300, SC_ERROR_OPTION);
        REFUSED(separation, (double)NAN, SC_ERROR_OPTION);
        REFUSED(separation, HUGE_VAL, SC_ERROR_OPTION);
        REFUSED(tolerance, -1, SC_ERROR_OPTION);
        REFUSED(tolerance, (double)NAN, SC_ERROR_OPTION);
        REFUSED(tolerance, HUGE_VAL, SC_ERROR_OPTION);
        REFUSED(separation, 1e308, SC_ERROR_SHORT_BUFFER);
        {
            sc_pose wrong = pose;
            wrong.struct_size = 4;
            CHECK(ASK(&wrong, &pose) == SC_ERROR_STRUCT_SIZE);
            CHECK(ASK(&pose, &wrong) == SC_ERROR_STRUCT_SIZE);
        }
        a.result.struct_size = 8;
        CHECK(ASK(&pose, &pose) == SC_ERROR_STRUCT_SIZE);
        a.result.struct_size = sizeof(a.result);
        {
            sc_pair *keep = a.result.edge_edges;
            a.result.edge_edges = NULL;
            CHECK(ASK(&pose, &pose) == SC_ERROR_NULL);
            a.result.edge_edges = keep;
            keep = a.result.vertex_faces;
            a.result.vertex_faces = NULL;
            CHECK(ASK(&pose, &pose) == SC_ERROR_NULL);
            a.result.vertex_faces = keep;
        }
        a.stats.struct_size = 4;
        a.result.stats = &a.stats;
        CHECK(ASK(&pose, &pose) == SC_ERROR_STRUCT_SIZE);
#undef REFUSED
#undef ASK
    }
    sc_workspace_free(plain);
    step_close(&s);
    step_close(&t);
    step_free_answer(&a);
    soup_free(&mesh);
    soup_free(&other);
}

SC_TEST_MAIN(SC_TEST(soups_that_move), SC_TEST(meshes_that_move), SC_TEST(flat_meshes_that_move),
             SC_TEST(holes_of_three_corners), SC_TEST(rearranged_insides),
             SC_TEST(pieces_inside_one_another), SC_TEST(ends_that_nearly_meet),
             SC_TEST(narrow_notches), SC_TEST(long_strips), SC_TEST(denormal_meshes),
             SC_TEST(arrays_and_counts), SC_TEST(ends_early), SC_TEST(refuses_what_does_not_fit))
