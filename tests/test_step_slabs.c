/*
 * Leaf clusters in steps: what slabs that move tell apart, and what they must not, where one is
 * near the other.
 *
 * Sheets lie on top of each other, so that boxes overlap and slabs alone decide; every step is
 * compared with what the narrow phase says of all pairs.
 *
 * SPDX-License-Identifier: MIT
 */
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "harness.h"
#include "step_check.h"

/* Where sheets lie: in the columns of turn times scale, the first and the second along them, the
   third across. */
typedef struct lie {
    double turn[3][3], scale, shift[3];
} lie;

/* Turned about an axis by an angle. */
static lie turned(const double axis[3], double angle)
{
    const double length = sqrt(axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]);
    const double c = cos(angle), s = sin(angle);
    lie l;
    memset(&l, 0, sizeof(l));
    l.scale = 1;
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        const double a = axis[i] / length;
        l.turn[i][i] = c + (1 - c) * a * a;
        l.turn[i][j] = (1 - c) * a * axis[j] / length - s * axis[k] / length;
        l.turn[i][k] = (1 - c) * a * axis[k] / length + s * axis[j] / length;
    }
    return l;
}

static void draw_axis(double axis[3])
{
    for (int k = 0; k < 3; ++k) axis[k] = test_random_range(-1, 1);
    axis[test_random_below(3)] += 2;
}

static lie any_lie(void)
{
    double axis[3];
    draw_axis(axis);
    return turned(axis, test_random_range(0, 3));
}

static void place(const lie *l, const double p[3], double to[3])
{
    for (int i = 0; i < 3; ++i)
        to[i] = l->shift[i] +
                l->scale * (l->turn[i][0] * p[0] + l->turn[i][1] * p[1] + l->turn[i][2] * p[2]);
}

/* Square sheets of so many cells; that of a point is its third coordinate. */
static soup make_sheets(uint32_t sheets, uint32_t cells)
{
    soup all = soup_cloth(cells, cells);
    for (uint32_t i = 1; i < sheets; ++i) {
        soup more = soup_cloth(cells, cells), both;
        for (uint32_t v = 0; v < more.vertex_count; ++v) more.positions[3 * v + 2] = i;
        both = soup_join(&all, &more);
        soup_free(&all);
        soup_free(&more);
        all = both;
    }
    return all;
}

/* Puts sheets at these heights, each beside the first by a half of a cell or so, with waves of so
   much height. */
static double *pose_sheets(const soup *mesh, const double *height, double wave, double aside,
                           const lie *l)
{
    double *to = (double *)test_allocate(3 * (size_t)mesh->vertex_count * sizeof(double));
    for (uint32_t v = 0; v < mesh->vertex_count; ++v) {
        const double *p = mesh->positions + 3 * (size_t)v;
        const uint32_t sheet = (uint32_t)p[2];
        const double x = p[0] - 0.5 + aside * sheet, y = p[1] - 0.5 + aside * aside * sheet;
        const double at[3] = {x, y, height[sheet] + wave * sin(7 * x) * cos(5 * y)};
        place(l, at, to + 3 * (size_t)v);
    }
    return to;
}

/* All methods on a step, and how many pairs it has. */
static uint64_t count_pairs(const soup *mesh, const double *start, const double *end,
                            const sc_impact_limits *limits, const char *what)
{
    timed_list lists[STEP_KINDS];
    step_subject s;
    input_choices choices = input_choose(mesh, SC_WELD_NONE, test_random_below(4));
    uint64_t count;
    step_solve(mesh, start, end, limits, lists);
    count = lists[0].count + lists[1].count;
    if (step_open(&s, mesh, &choices.options))
        step_check_methods(mesh, &s, start, end, limits, lists, what);
    step_close(&s);
    step_free_lists(lists);
    input_free_choices(&choices);
    return count;
}

/* Candidates of a step by boxes and slabs. */
static uint64_t count_candidates(const soup *mesh, const double *start, const double *end,
                                 const sc_impact_limits *limits, uint32_t method)
{
    const sc_pose from = input_plain_pose(start, mesh->vertex_count);
    const sc_pose to = input_plain_pose(end, mesh->vertex_count);
    sc_step_options o = step_plain_options();
    step_answer a = step_make_answer(0);
    step_subject s;
    uint64_t count = 0;
    o.output = SC_OUTPUT_COUNT;
    o.pairs = SC_STEP_CANDIDATES;
    o.method = method;
    o.separation = limits->separation;
    o.tolerance = limits->tolerance;
    if (step_open(&s, mesh, NULL)) {
        CHECK(sc_query_step(s.model, s.workspace, &from, &to, &o, &a.result) == SC_OK);
        count = a.result.vertex_face_count + a.result.edge_edge_count;
    }
    step_close(&s);
    step_free_answer(&a);
    return count;
}

/* Flat sheets that move together and lie as far apart as the separation, a little more or less: at
   both ends, at one, or in the middle, where the turn of a step brings them nearer. */
static void layers_at_the_separation(void)
{
    static const double beyond[] = {-1e-2, -1e-4, -1e-6, -1e-8, 0, 1e-8, 1e-6, 1e-4, 1e-2};
    uint32_t hits = 0, misses = 0;
    for (uint32_t i = 0; i < test_iterations(72) && test_failures() == 0; ++i) {
        const double separation = i % 3 ? pow(10, test_random_range(-4, -1)) : 0;
        const double gap = separation + beyond[i % 9] * (i % 3 ? separation : 0.1);
        const double heights[2][2] = {{0, gap}, {0, i % 4 == 1 ? 2 * gap : gap}};
        const sc_impact_limits limits = {separation, i % 2 ? 1e-9 : 1e-5, 1};
        soup mesh = make_sheets(2, 4);
        lie l = any_lie();
        double *start = pose_sheets(&mesh, heights[0], 0, 0.3, &l), *end, axis[3];
        if (i % 4 ==
            2) { /* about an axis in the sheet: it shrinks on the way, and so does the gap */
            for (int k = 0; k < 3; ++k) axis[k] = l.turn[k][0];
            {
                const lie turn = turned(axis, test_random_range(0.1, 2));
                const lie before = l;
                for (int r = 0; r < 3; ++r)
                    for (int c = 0; c < 3; ++c)
                        l.turn[r][c] = turn.turn[r][0] * before.turn[0][c] +
                                       turn.turn[r][1] * before.turn[1][c] +
                                       turn.turn[r][2] * before.turn[2][c];
            }
        }
        for (int k = 0; k < 3; ++k) l.shift[k] = test_random_range(-1, 1);
        end = pose_sheets(&mesh, heights[1], 0, 0.3, &l);
        if (count_pairs(&mesh, start, end, &limits, "layers"))
            ++hits;
        else
            ++misses;
        free(start);
        free(end);
        soup_free(&mesh);
    }
    test_note("%u steps with pairs, %u without", hits, misses);
    CHECK(hits * 5 >= test_iterations(72) && misses * 5 >= test_iterations(72));
}

/* Sheets that lie in each other, in a plane of any tilt: that they touch is decided by rounding
   alone, where nothing is added to slabs. */
static void sheets_in_each_other(void)
{
    for (uint32_t i = 0; i < test_iterations(40) && test_failures() == 0; ++i) {
        static const double heights[2] = {0, 0};
        const sc_impact_limits limits = {0, 1e-9, 1};
        soup mesh = make_sheets(2, 4);
        const lie l = any_lie();
        double *start = pose_sheets(&mesh, heights, 0, test_random_range(0.05, 0.4), &l);
        double *end = pose_sheets(&mesh, heights, 0, test_random_range(0.05, 0.4), &l);
        CHECK(count_pairs(&mesh, start, end, &limits, "in each other") > 0);
        free(start);
        free(end);
        soup_free(&mesh);
    }
}

/* One sheet passes through the other: before it at the start and behind it at the end; or it comes
   back, as it turns over with the other one. */
static void sheets_that_pass(void)
{
    for (uint32_t i = 0; i < test_iterations(40) && test_failures() == 0; ++i) {
        const double gap = test_random_range(0.05, 0.5), wave = test_random_range(0, 0.1);
        const double heights[2][2] = {{0, gap}, {0, i % 2 ? gap : -gap}};
        const sc_impact_limits limits = {i % 3 ? 0 : 0.01, 1e-6, 1};
        soup mesh = make_sheets(2, 4);
        double axis[3];
        lie l[2];
        double *start, *end;
        draw_axis(axis);
        l[0] = turned(axis, 0);
        l[1] = turned(axis, i % 2 ? test_random_range(2.5, 3.14159265358979) : 0.2);
        start = pose_sheets(&mesh, heights[0], wave, 0.2, &l[0]);
        end = pose_sheets(&mesh, heights[1], wave, 0.2, &l[1]);
        CHECK(count_pairs(&mesh, start, end, &limits, "pass") > 0 || i % 2);
        free(start);
        free(end);
        soup_free(&mesh);
    }
}

/* Sheets of which rows of triangles have no area, at the start, at the end, or in the middle, where
   half a turn takes their normals away; all sheets at once in one point or on one line. */
static void sheets_without_normals(void)
{
    for (uint32_t i = 0; i < test_iterations(40) && test_failures() == 0; ++i) {
        const double gap = test_random_range(0.001, 0.02);
        const double heights[2] = {0, i % 4 == 3 ? 0 : gap};
        const sc_impact_limits limits = {i % 2 ? gap * test_random_range(0.5, 1.5) : 0, 1e-6, 1};
        soup mesh = make_sheets(2, 4);
        double axis[3] = {0, 0, 1};
        lie l[2];
        double *pose[2];
        l[0] = turned(axis, 0);
        l[1] = turned(axis, i % 4 == 1 ? 3.14159265358979 : 0.1);
        for (int end = 0; end < 2; ++end) {
            pose[end] = pose_sheets(&mesh, heights, 0, 0.1, &l[end]);
            for (uint32_t v = 0; v < mesh.vertex_count; ++v) {
                double *p = pose[end] + 3 * (size_t)v;
                if (i % 4 == 0 && (v + (uint32_t)end) % 3 == 0) p[0] = p[1] = 0;
                if (i % 4 == 2) p[1] = 0; /* upright slivers */
                if (i % 4 == 3 && end) p[0] = p[1] = p[2] = 0;
            }
        }
        count_pairs(&mesh, pose[0], pose[1], &limits, "no normals");
        free(pose[0]);
        free(pose[1]);
        soup_free(&mesh);
    }
}

/* Layers of any size and far from the origin, so that coordinates are rounded by as much as they
   lie apart. */
static void layers_far_away(void)
{
    for (uint32_t i = 0; i < test_iterations(40) && test_failures() == 0; ++i) {
        const double scale = pow(10, test_random_range(-30, 30));
        const double away = i % 2 ? scale * pow(10, test_random_range(0, 12)) : 0;
        const double heights[2][2] = {{0, 1e-3}, {0, i % 3 ? 1e-3 : -1e-3}};
        const sc_impact_limits limits = {i % 4 ? 0 : 1e-3 * scale, 1e-6 * scale, 1};
        soup mesh = make_sheets(2, 4);
        lie l = any_lie();
        double *start, *end;
        l.scale = scale;
        for (int k = 0; k < 3; ++k) l.shift[k] = away * test_random_range(-1, 1);
        start = pose_sheets(&mesh, heights[0], 0.05, 0.2, &l);
        end = pose_sheets(&mesh, heights[1], 0.05, 0.2, &l);
        count_pairs(&mesh, start, end, &limits, "far away");
        free(start);
        free(end);
        soup_free(&mesh);
    }
}

/* A pile of sheets on a model without test tree, whose workspace has no room for all leaf clusters:
   any two of them may have one place. */
static void more_leaf_clusters_than_places(void)
{
    enum { SHEETS = 16 };
    double heights[2][SHEETS];
    soup mesh = make_sheets(SHEETS, 8);
    sc_build_options build;
    step_subject s;
    for (uint32_t i = 0; i < SHEETS; ++i) { /* half of them from here is another one's neighbour: */
        const uint32_t layer =
            2 * i % SHEETS + 2 * i / SHEETS; /* 64 or 128 leaf clusters from it */
        heights[0][i] = 0.01 * layer;
        heights[1][i] = 0.01 * (layer % 2 ? layer : layer + 1.1);
    }
    memset(&build, 0, sizeof(build));
    build.struct_size = sizeof(build);
    build.content = SC_MODEL_BOXES;
    if (step_open(&s, &mesh, &build)) {
        const sc_impact_limits limits = {0, 1e-6, 1};
        const lie l = any_lie();
        double *start = pose_sheets(&mesh, heights[0], 0.02, 0.01, &l);
        double *end = pose_sheets(&mesh, heights[1], 0.02, 0.01, &l);
        const sc_pose from = input_plain_pose(start, mesh.vertex_count);
        const sc_pose to = input_plain_pose(end, mesh.vertex_count);
        timed_list lists[STEP_KINDS];
        step_solve(&mesh, start, end, &limits, lists);
        CHECK(lists[0].count > 100 && lists[1].count > 100);
        for (int round = 0; round < 2; ++round) { /* the second time, places are taken */
            step_answer a = step_make_answer(lists[0].count + lists[1].count);
            sc_step_options o = step_plain_options();
            o.tolerance = limits.tolerance;
            o.times = SC_STEP_TIMES_EACH;
            CHECK(sc_query_step(s.model, s.workspace, round ? &to : &from, round ? &from : &to, &o,
                                &a.result) == SC_OK);
            if (round) {
                step_free_lists(lists);
                step_solve(&mesh, end, start, &limits, lists);
            }
            CHECK(a.result.vertex_face_count == lists[0].count);
            CHECK(a.result.edge_edge_count == lists[1].count);
            CHECK(!memcmp(a.result.edge_edges, lists[1].pairs,
                          (size_t)lists[1].count * sizeof(sc_pair)));
            step_free_answer(&a);
        }
        step_free_lists(lists);
        free(start);
        free(end);
    }
    step_close(&s);
    soup_free(&mesh);
}

/* Layers that are wavy, so that boxes of triangles overlap by far, and a little more than the
   separation apart: nothing is left; and no more by boxes swept than without slabs. */
static void layers_apart_are_told_apart(void)
{
    for (uint32_t i = 0; i < 10; ++i) {
        static const double heights[2] = {0, 0.03};
        const sc_impact_limits limits = {i % 2 ? 0.01 : 0, 1e-6, 1};
        soup mesh = make_sheets(2, 12);
        lie l = any_lie();
        double *start = pose_sheets(&mesh, heights, 0.02, 0.1, &l), *end;
        uint64_t swept;
        for (int k = 0; k < 3; ++k) l.shift[k] = test_random_range(-1, 1);
        end = pose_sheets(&mesh, heights, 0.02, 0.1, &l);
        swept = count_candidates(&mesh, start, end, &limits, SC_STEP_METHOD_SWEPT);
        CHECK(count_candidates(&mesh, start, end, &limits, SC_STEP_METHOD_SCTT) == 0);
        CHECK(swept > 10000);
        free(start);
        free(end);
        soup_free(&mesh);
    }
}

SC_TEST_MAIN(SC_TEST(layers_at_the_separation), SC_TEST(sheets_in_each_other),
             SC_TEST(sheets_that_pass), SC_TEST(sheets_without_normals), SC_TEST(layers_far_away),
             SC_TEST(more_leaf_clusters_than_places), SC_TEST(layers_apart_are_told_apart))
