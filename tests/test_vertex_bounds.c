/*
 * Bounds of vertices in what is near: at most the exact distances of all pairs at a vertex, and not
 * far below, whoever finds them; and what they are for: vertices that move by less than half of
 * theirs bring nothing together.
 *
 * SPDX-License-Identifier: MIT
 */
#include <float.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "harness.h"
#include "inputs.h"
#include "near_ask.h"
#include "shapes.h"
#include "soups.h"
#include "starcontour.h"
#include "steps.h"
#include "tasks.h"

/* A mesh in a pose. */
typedef struct scene {
    soup mesh; /* the rest pose */
    double *posed;
    step_motion m;
    input_choices choices;
    sc_pose pose;
    sc_model *model;
    sc_workspace *workspace, *shared; /* for one worker, and for THREADS_MAX */
    double size, edge;                /* the largest extent of the pose, and that of an edge */
    uint64_t state;
} scene;

/* Takes mesh and pose over. */
static int open_scene(scene *s, soup mesh, double *posed, uint64_t state)
{
    sc_mesh input = input_plain_mesh(&mesh);
    uint32_t *map;
    memset(s, 0, sizeof *s);
    s->mesh = mesh;
    s->posed = posed;
    s->state = state;
    s->choices = input_choose(&mesh, test_random_below(3), test_random_below(4));
    memset(&s->pose, 0, sizeof s->pose);
    s->pose.struct_size = sizeof s->pose;
    s->pose.vertex_count = mesh.vertex_count;
    s->pose.position_type = SC_DOUBLE;
    s->pose.positions = posed;
    if (!CHECK(sc_build(&input, &s->choices.options, &s->model) == SC_OK)) return 0;
    map = input_weld_of(&s->choices, &mesh);
    s->m = step_motion_make(&mesh, posed, posed, map);
    free(map);
    s->workspace = near_workspace(s->model, 1);
    s->shared = near_workspace(s->model, THREADS_MAX);
    s->size = s->m.extent;
    for (uint32_t i = 0; i < s->m.edge_count; ++i) {
        const double *p = posed + 3 * (size_t)step_edge_start(&s->m, s->m.edge[i]);
        const double *q = posed + 3 * (size_t)step_edge_end(&s->m, s->m.edge[i]);
        for (int k = 0; k < 3; ++k) s->edge = fmax(s->edge, fabs(p[k] - q[k]));
    }
    return s->workspace != NULL && s->shared != NULL;
}

static void close_scene(scene *s)
{
    sc_workspace_free(s->workspace);
    sc_workspace_free(s->shared);
    if (s->model) step_motion_free(&s->m);
    sc_model_free(s->model);
    input_free_choices(&s->choices);
    soup_free(&s->mesh);
    free(s->posed);
}

/* The caller's lists are in the result. */
static sc_status ask_into(const scene *s, sc_workspace *workspace, const sc_near_options *options,
                          double *bounds, sc_near_result *result)
{
    result->struct_size = sizeof *result;
    result->vertex_bounds = bounds;
    for (uint32_t v = 0; v < s->mesh.vertex_count; ++v) bounds[v] = -1;
    return sc_query_near(s->model, workspace, &s->pose, options, result);
}

static sc_status ask(const scene *s, sc_workspace *workspace, const sc_near_options *options,
                     double *bounds)
{
    sc_near_result result;
    memset(&result, 0, sizeof result);
    return ask_into(s, workspace, options, bounds, &result);
}

static int accept_even(void *user, uint32_t a, uint32_t b)
{
    (void)user;
    return (a + b) % 2 == 0;
}

/* The least distance of the pairs at each vertex, or d. */
static double *find_truth(const scene *s, const sc_near_options *o)
{
    double *truth = (double *)test_allocate(sizeof(double) * s->mesh.vertex_count);
    for (uint32_t v = 0; v < s->mesh.vertex_count; ++v) truth[v] = o->distance;
    for (int kind = 0; kind < 2; ++kind) {
        const int wanted = o->kinds == SC_NEAR_BOTH || (int)o->kinds == kind + 1;
        const sc_filter *f = kind ? o->edge_edge_filter : o->vertex_face_filter;
        oracle_list list = near_truth_find(&s->m, kind, o->distance);
        for (uint64_t i = 0; wanted && i < list.count; ++i) {
            const sc_pair pair = list.pairs[i];
            const double d = near_truth_distance(&s->m, kind, pair);
            uint32_t at[4];
            if (f && f->accept && !f->accept(NULL, pair.a, pair.b)) continue;
            step_pair_vertices(&s->m, kind, pair, at);
            for (int k = 0; k < 4; ++k) truth[at[k]] = fmin(truth[at[k]], d);
        }
        free(list.pairs);
    }
    return truth;
}

static void check_bounds(const scene *s, const sc_near_options *options)
{
    const size_t bytes = sizeof(double) * s->mesh.vertex_count;
    const double slack = 5e-7 * s->size + 3e-5 * (s->edge + options->distance);
    double *truth = find_truth(s, options);
    double *bounds = (double *)test_allocate(bytes), *others = (double *)test_allocate(bytes);
    uint64_t above = 0, below = 0;
    CHECK(ask(s, s->workspace, options, bounds) == SC_OK);
    for (uint32_t v = 0; v < s->mesh.vertex_count; ++v) {
        above += !(bounds[v] <= truth[v]);
        below += !(bounds[v] >= truth[v] - slack) || bounds[v] < 0;
    }
    CHECK_MSG(above == 0 && below == 0,
              "d %a, kinds %" PRIu32 ": %" PRIu64 " bounds too large, %" PRIu64
              " too small; state %" PRIu64,
              options->distance, options->kinds, above, below, s->state);
    for (int i = 0; i < NEAR_WAYS; ++i) {
        sc_near_options o = *options;
        o.method = near_ways[i].method;
        o.simd = near_ways[i].simd;
        o.output = i % 2 ? SC_OUTPUT_COUNT : SC_OUTPUT_PAIRS;
        if (!near_way_is_there(&near_ways[i], s->model, s->workspace, &s->pose)) continue;
        if (o.output == SC_OUTPUT_COUNT) {
            CHECK(ask(s, s->workspace, &o, others) == SC_OK);
            CHECK_MSG(!memcmp(bounds, others, bytes), "%s differs", near_ways[i].name);
        } else {
            const sc_status status = ask(s, s->workspace, &o, others);
            CHECK(status == SC_OK || status == SC_ERROR_SHORT_BUFFER);
            CHECK_MSG(!memcmp(bounds, others, bytes), "%s differs", near_ways[i].name);
        }
    }
    free(truth);
    free(bounds);
    free(others);
}

/* All pairs of small meshes, by exact arithmetic. */
static void bounds_of_any_mesh(void)
{
    for (uint32_t trial = test_iterations(250); trial-- > 0 && !test_failures();) {
        const uint64_t state = test_random_state();
        const char *name;
        soup mesh = shape_any(2 + test_random_below(60), &name);
        double *posed = soup_copy_positions(&mesh);
        const double factor = trial % 5 ? 1 : ldexp(1, (int)test_random_below(400) - 200);
        sc_near_options o;
        sc_filter filter;
        scene s;
        if (test_random_below(4)) soup_any_pose(posed, mesh.vertex_count);
        if (trial % 4 == 0) soup_snap(posed, mesh.vertex_count, 0.125);
        if (trial % 7 == 0) soup_move(posed, mesh.vertex_count, 1000);
        soup_scale(posed, mesh.vertex_count, factor);
        if (open_scene(&s, mesh, posed, state)) {
            memset(&o, 0, sizeof o);
            o.struct_size = sizeof o;
            o.distance = s.edge * (trial % 3 ? test_random_range(0, 1) : 0.125 / 8);
            if (trial % 4 == 0) o.distance = 0.125 * factor;
            o.kinds = test_random_below(3);
            o.output = SC_OUTPUT_COUNT;
            memset(&filter, 0, sizeof filter);
            filter.struct_size = sizeof filter;
            filter.accept = accept_even;
            if (trial % 3 == 0) o.vertex_face_filter = o.edge_edge_filter = &filter;
            check_bounds(&s, &o);
        }
        close_scene(&s);
    }
}

/* Fails a check if a bound is above the exact distance of a pair at the vertex; counts those above
   0. m is the pose times a power of two, up: where doubles next to each other are far apart, the
   oracle tells of that what is between them. */
static void check_sound(const scene *s, const step_motion *m, double up, const sc_near_options *o,
                        uint64_t *positive)
{
    double *bounds = (double *)test_allocate(sizeof(double) * s->mesh.vertex_count);
    uint64_t above = 0;
    CHECK(ask(s, s->workspace, o, bounds) == SC_OK);
    for (uint32_t v = 0; v < s->mesh.vertex_count; ++v)
        above += !(bounds[v] >= 0 && bounds[v] <= o->distance);
    for (int kind = 0; kind < 2; ++kind) {
        oracle_list list = near_truth_find(m, kind, o->distance * up);
        for (uint64_t i = 0; i < list.count; ++i) {
            uint32_t at[4];
            step_pair_vertices(m, kind, list.pairs[i], at);
            for (int k = 0; k < 4; ++k) {
                const double bound = bounds[at[k]] * up;
                *positive += bound > 0;
                above +=
                    bound > 0 && near_truth_is_within(m, kind, list.pairs[i], nextafter(bound, 0));
            }
        }
        free(list.pairs);
    }
    CHECK_MSG(above == 0, "d %a: %" PRIu64 " bounds too large; state %" PRIu64, o->distance, above,
              s->state);
    free(bounds);
}

/* Coordinates up to the largest doubles, and of a few of the smallest. */
static void bounds_at_both_ends_of_the_range(void)
{
    uint64_t positive[2] = {0, 0};
    for (uint32_t trial = test_iterations_at_least(200, 40); trial-- > 0 && !test_failures();) {
        const uint64_t state = test_random_state();
        const int tiny = trial % 2;
        const char *name;
        soup mesh = shape_any(2 + test_random_below(40), &name);
        double *posed = soup_copy_positions(&mesh), *raised, most = 0;
        const double up = tiny ? 0x1p600 : 1;
        sc_near_options o;
        scene s;
        if (test_random_below(4)) soup_any_pose(posed, mesh.vertex_count);
        for (size_t i = 0; i < 3 * (size_t)mesh.vertex_count; ++i)
            most = fmax(most, fabs(posed[i]));
        if (!(most > 0)) most = 1;
        for (size_t i = 0; i < 3 * (size_t)mesh.vertex_count; ++i)
            posed[i] = tiny ? ldexp(posed[i] / most, -1074 + (int)(4 + trial / 2 % 70))
                            : posed[i] / most * (trial % 4 ? DBL_MAX : 0x1p1022);
        raised = (double *)test_allocate(3 * sizeof(double) * mesh.vertex_count);
        for (size_t i = 0; i < 3 * (size_t)mesh.vertex_count; ++i) raised[i] = posed[i] * up;
        if (open_scene(&s, mesh, posed, state)) {
            step_motion m;
            uint32_t *map;
            memset(&o, 0, sizeof o);
            o.struct_size = sizeof o;
            o.output = SC_OUTPUT_COUNT;
            o.distance = fmin(s.edge, DBL_MAX) * test_random_range(0.1, 0.6);
            map = input_weld_of(&s.choices, &s.mesh);
            m = step_motion_make(&s.mesh, raised, raised, map);
            check_sound(&s, &m, up, &o, &positive[tiny]);
            step_motion_free(&m);
            free(map);
        }
        free(raised);
        close_scene(&s);
    }
    CHECK_MSG(positive[0] > 0, "%" PRIu64 " huge bounds", positive[0]);
}

/* Two edges of triangles whose middles are a vector apart, at random across it; the third corners
   are behind them. */
static double *draw_edges_apart(const double apart[3], double length)
{
    double *posed = (double *)test_allocate(18 * sizeof(double));
    for (int i = 0; i < 6; i += 3) {
        const double half = i ? 0.5 : -0.5;
        double along[3], part = 0;
        for (int k = 0; k < 3; ++k) {
            along[k] = length * test_random_range(-0.1, 0.1);
            part += along[k] * apart[k] / (length * length);
        }
        for (int k = 0; k < 3; ++k) {
            posed[3 * i + k] = half * apart[k] + (along[k] - part * apart[k]);
            posed[3 * i + 3 + k] = half * apart[k] - (along[k] - part * apart[k]);
            posed[3 * i + 6 + k] = 1.2 * half * apart[k] + along[(k + 1) % 3];
        }
    }
    return posed;
}

/* A distance beyond all that there is, however far, leaves bounds what they are. */
static void bounds_of_endless_distances(void)
{
    soup mesh = soup_cloth(6, 6);
    double *posed = soup_copy_positions(&mesh);
    scene s;
    soup_smooth(posed, mesh.vertex_count, 0.3);
    if (open_scene(&s, mesh, posed, test_random_state())) {
        double *bounds = (double *)test_allocate(sizeof(double) * mesh.vertex_count);
        double *others = (double *)test_allocate(sizeof(double) * mesh.vertex_count);
        sc_near_options o;
        memset(&o, 0, sizeof o);
        o.struct_size = sizeof o;
        o.output = SC_OUTPUT_COUNT;
        o.distance = 20 * s.size;
        CHECK(ask(&s, s.workspace, &o, bounds) == SC_OK);
        for (int i = 1; i < 300; i += 30) {
            o.distance = s.size * pow(10, i);
            CHECK(ask(&s, s.workspace, &o, others) == SC_OK);
            for (uint32_t v = 0; v < mesh.vertex_count; ++v)
                if (!CHECK_MSG(bounds[v] > 0 && bounds[v] == others[v], "%g, not %g", others[v],
                               bounds[v]))
                    break;
        }
        free(bounds);
        free(others);
    }
    close_scene(&s);
}

/* Edges that are nearer than the largest double, by so little that their distance is more by its
   rounding: a bound of it is a double all the same. */
static void bounds_of_the_largest_distances(void)
{
    uint64_t pairs = 0, infinite = 0;
    for (uint32_t trial = test_iterations_at_least(3000, 1500); trial-- > 0 && !test_failures();) {
        const uint64_t state = test_random_state();
        const double apart[3] = {test_random_range(-1, 1), test_random_range(-1, 1),
                                 test_random_range(0.5, 1)};
        const double length = sqrt(apart[0] * apart[0] + apart[1] * apart[1] + apart[2] * apart[2]);
        const double factor = (1 - test_random_below(4) * 0x1p-53) / length;
        soup mesh = soup_make(6, 2);
        double *posed = draw_edges_apart(apart, length);
        sc_near_options o;
        scene s;
        for (uint32_t i = 0; i < 18; ++i) {
            mesh.positions[i] = posed[i];
            posed[i] = ldexp(posed[i] * factor, 1024);
        }
        for (uint32_t i = 0; i < 6; ++i) mesh.triangles[i] = i;
        memset(&o, 0, sizeof o);
        o.struct_size = sizeof o;
        o.output = SC_OUTPUT_PAIRS;
        o.kinds = SC_NEAR_EDGE_EDGE;
        o.distance = DBL_MAX;
        if (open_scene(&s, mesh, posed, state)) {
            sc_near_result result;
            sc_pair edges[9];
            sc_near_stencil stencils[9];
            double bounds[6];
            memset(&result, 0, sizeof result);
            result.edge_edges = edges;
            result.edge_edge_capacity = 9;
            CHECK(ask_into(&s, s.workspace, &o, bounds, &result) == SC_OK);
            CHECK(sc_near_stencils(s.model, &s.pose, SC_NEAR_EDGE_EDGE, edges,
                                   result.edge_edge_count, stencils) == SC_OK);
            for (uint64_t i = 0; i < result.edge_edge_count; ++i) {
                const double truth = near_truth_distance(&s.m, STEP_EDGE_EDGE, edges[i]);
                uint32_t at[4];
                step_pair_vertices(&s.m, STEP_EDGE_EDGE, edges[i], at);
                for (int k = 0; k < 4; ++k)
                    CHECK_MSG(bounds[at[k]] >= 0 && bounds[at[k]] <= truth,
                              "bound %a of %a, state %" PRIu64, bounds[at[k]], truth, state);
                infinite += stencils[i].distance > DBL_MAX;
                pairs++;
            }
        }
        close_scene(&s);
    }
    test_note("%" PRIu64 " of %" PRIu64 " distances are infinite", infinite, pairs);
    CHECK(infinite > 0 && pairs > infinite);
}

/* Whoever finds them, with a function that is asked about either kind of pair, both or none; and
   what is cancelled has none. */
static void bounds_by_many_workers(void)
{
    static const volatile uint32_t set = 1;
    for (uint32_t trial = test_iterations_at_least(12, 4); trial-- > 0;) {
        soup mesh = trial % 2 ? soup_cloth(40, 40) : shape_body(40, 40);
        const size_t bytes = sizeof(double) * mesh.vertex_count;
        double *posed = soup_copy_positions(&mesh), *alone, *together;
        sc_near_options o;
        sc_near_result lists;
        sc_filter filter;
        scene s;
        host h;
        soup_smooth(posed, mesh.vertex_count, 0.1);
        soup_twist(posed, mesh.vertex_count, test_random_range(0, 2));
        if (!open_scene(&s, mesh, posed, test_random_state())) return;
        alone = (double *)test_allocate(bytes);
        together = (double *)test_allocate(bytes);
        memset(&o, 0, sizeof o);
        o.struct_size = sizeof o;
        o.distance = s.edge * test_random_range(0.3, 1.2);
        o.output = SC_OUTPUT_COUNT;
        memset(&filter, 0, sizeof filter);
        filter.struct_size = sizeof filter;
        filter.accept = accept_even;
        if (trial % 4 & 1) o.vertex_face_filter = &filter;
        if (trial % 4 & 2) o.edge_edge_filter = &filter;
        memset(&lists, 0, sizeof lists);
        CHECK(ask_into(&s, s.workspace, &o, alone, &lists) == SC_OK);
        host_start(&h, HOST_FIRST + (int)(trial % (HOST_COUNT - HOST_FIRST)), THREADS_MAX);
        o.tasks = &h.tasks;
        CHECK(ask(&s, s.shared, &o, together) == SC_OK);
        CHECK(!memcmp(alone, together, bytes));
        /* with room for all pairs the function could be asked at the end */
        o.output = SC_OUTPUT_PAIRS;
        lists.vertex_face_capacity = lists.vertex_face_count;
        lists.edge_edge_capacity = lists.edge_edge_count;
        lists.vertex_faces = (sc_pair *)test_allocate(sizeof(sc_pair) * lists.vertex_face_count);
        lists.edge_edges = (sc_pair *)test_allocate(sizeof(sc_pair) * lists.edge_edge_count);
        CHECK(lists.vertex_face_count > 0 && lists.edge_edge_count > 0);
        CHECK(ask_into(&s, s.shared, &o, together, &lists) == SC_OK);
        CHECK(!memcmp(alone, together, bytes));
        free(lists.vertex_faces);
        free(lists.edge_edges);
        CHECK(ask(&s, s.shared, &o, together) == SC_ERROR_SHORT_BUFFER);
        CHECK(!memcmp(alone, together, bytes));
        o.cancel = &set;
        CHECK(ask(&s, s.shared, &o, together) == SC_ERROR_INCOMPLETE);
        for (uint32_t v = 0; v < mesh.vertex_count; ++v) CHECK(together[v] == 0);
        host_stop(&h);
        free(alone);
        free(together);
        close_scene(&s);
    }
}

/* A shorter result goes on working, and what cannot be known is refused. */
static void other_results(void)
{
    soup mesh = soup_cloth(8, 8);
    double *posed = soup_copy_positions(&mesh), bounds[81];
    sc_near_options o;
    sc_near_result result;
    scene s;
    if (!open_scene(&s, mesh, posed, test_random_state())) return;
    memset(&o, 0, sizeof o);
    o.struct_size = sizeof o;
    o.distance = 0.25;
    o.output = SC_OUTPUT_ANY;
    CHECK(ask(&s, s.workspace, &o, bounds) == SC_ERROR_OPTION);
    for (uint32_t v = 0; v < mesh.vertex_count; ++v) CHECK(bounds[v] == -1);
    o.output = SC_OUTPUT_COUNT;
    posed[4] = (double)NAN;
    CHECK(ask(&s, s.workspace, &o, bounds) == SC_ERROR_NOT_FINITE);
    for (uint32_t v = 0; v < mesh.vertex_count; ++v) CHECK(bounds[v] == -1);
    posed[4] = 0;
    memset(&result, 0, sizeof result);
    result.struct_size = offsetof(sc_near_result, vertex_bounds);
    result.vertex_bounds = bounds;
    CHECK(sc_query_near(s.model, s.workspace, &s.pose, &o, &result) == SC_OK);
    for (uint32_t v = 0; v < mesh.vertex_count; ++v) CHECK(bounds[v] == -1);
    close_scene(&s);
}

static int intersects(const scene *s)
{
    sc_query_options o = no_options();
    sc_result r;
    memset(&r, 0, sizeof r);
    r.struct_size = sizeof r;
    o.output = SC_OUTPUT_ANY;
    CHECK(sc_query(s->model, s->workspace, &s->pose, &o, &r) == SC_OK);
    return r.collides != 0;
}

/* Moves each vertex by nearly half its bound: anywhere, all to one point, or towards what is
   near. */
static void move_by_bounds(scene *s, const double *bounds, int way)
{
    double to[3] = {test_random_range(-1, 1), test_random_range(-1, 1), test_random_range(-1, 1)};
    for (uint32_t v = 0; v < s->mesh.vertex_count; ++v) {
        double *p = s->posed + 3 * (size_t)v, d[3], length;
        for (int k = 0; k < 3; ++k)
            d[k] = way == 0 ? test_random_range(-1, 1) : way == 1 ? to[k] - p[k] : 0;
        if (way == 2) d[2] = p[2] > 0 ? -1 : 1; /* layers towards each other */
        length = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
        if (!(length > 0)) continue;
        for (int k = 0; k < 3; ++k) p[k] += 0.4999 * bounds[v] * d[k] / length;
    }
}

/* Poses without intersections have none after. */
static void nothing_comes_together(void)
{
    uint64_t clean = 0, moved = 0;
    for (uint32_t trial = test_iterations_at_least(400, 40); trial-- > 0 && !test_failures();) {
        const uint64_t state = test_random_state();
        const char *name;
        soup mesh;
        double *posed, *bounds;
        sc_near_options o;
        scene s;
        if (trial % 3 == 0) { /* two layers */
            soup one = soup_cloth(6 + test_random_below(8), 6 + test_random_below(8));
            soup other = soup_copy(&one);
            for (uint32_t v = 0; v < one.vertex_count; ++v) {
                one.positions[3 * v + 2] = 0.01;
                other.positions[3 * v + 2] = -0.01;
            }
            mesh = soup_join(&one, &other);
            soup_free(&one);
            soup_free(&other);
        } else {
            mesh = shape_any(2 + test_random_below(300), &name);
        }
        posed = soup_copy_positions(&mesh);
        if (trial % 2) soup_smooth(posed, mesh.vertex_count, test_random_range(0, 0.1));
        if (!open_scene(&s, mesh, posed, state)) return;
        bounds = (double *)test_allocate(sizeof(double) * mesh.vertex_count);
        if (!intersects(&s)) {
            ++clean;
            for (int round = 0; round < 3; ++round) {
                memset(&o, 0, sizeof o);
                o.struct_size = sizeof o;
                o.distance = s.edge * test_random_range(0.01, 2);
                o.output = SC_OUTPUT_COUNT;
                CHECK(ask(&s, s.workspace, &o, bounds) == SC_OK);
                move_by_bounds(&s, bounds, (int)test_random_below(3));
                CHECK_MSG(!intersects(&s), "state %" PRIu64, s.state);
                ++moved;
            }
        }
        free(bounds);
        close_scene(&s);
    }
    CHECK_MSG(clean > 10, "%" PRIu64 " clean poses, %" PRIu64 " moves", clean, moved);
}

SC_TEST_MAIN(SC_TEST(bounds_of_any_mesh), SC_TEST(bounds_at_both_ends_of_the_range),
             SC_TEST(bounds_of_endless_distances), SC_TEST(bounds_of_the_largest_distances),
             SC_TEST(bounds_by_many_workers), SC_TEST(other_results),
             SC_TEST(nothing_comes_together))
