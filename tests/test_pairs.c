/*
 * The heart of the promise: on every mesh, pose, type, stride, welding, partition and method,
 * sc_query reports the pairs that the oracle reports, sorted, each once, in all four kinds.
 *
 * SPDX-License-Identifier: MIT
 */
#include <float.h>
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

/* Ways to search that must all give the same answer. */
typedef struct way {
    const char *name;
    uint32_t method, contour, rest_cache;
} way;

static const way ways[] = {
    {"default", SC_METHOD_DEFAULT, SC_CONTOUR_DEFAULT, SC_REST_CACHE_ON},
    {"sctt", SC_METHOD_SCTT, SC_CONTOUR_DEFAULT, SC_REST_CACHE_ON},
    {"sctt, no cache", SC_METHOD_SCTT, SC_CONTOUR_DEFAULT, SC_REST_CACHE_OFF},
    {"sctt, star", SC_METHOD_SCTT, SC_CONTOUR_STAR, SC_REST_CACHE_ON},
    {"sctt, star, no cache", SC_METHOD_SCTT, SC_CONTOUR_STAR, SC_REST_CACHE_OFF},
    {"aabb sctt", SC_METHOD_AABB_SCTT, SC_CONTOUR_DEFAULT, SC_REST_CACHE_ON},
    {"aabb", SC_METHOD_AABB, SC_CONTOUR_DEFAULT, SC_REST_CACHE_ON},
};
enum { WAYS = sizeof(ways) / sizeof(ways[0]) };

/* What is being compared, for messages. */
typedef struct trial {
    const char *name;
    const soup *mesh;
    const double *pose;
    uint64_t state; /* of the random numbers before the soup was made */
    const sc_model *model;
    sc_workspace *workspace;
    const sc_pose *input;
    const char *partition;
    uint32_t weld;
    const oracle_answer *answer;
} trial;

static const sc_pair guard_pair = {0xdeadbeefu, 0xfeedfaceu};

/* Prints a soup small enough to be a reproducer. */
static void print_reproducer(const trial *t)
{
    if (t->mesh->triangle_count > 40) return;
    for (uint32_t v = 0; v < t->mesh->vertex_count; ++v) {
        const double *r = t->mesh->positions + 3 * (size_t)v, *p = t->pose + 3 * (size_t)v;
        printf("    vertex %" PRIu32 ": rest %.17g %.17g %.17g, pose %.17g %.17g %.17g\n", v, r[0],
               r[1], r[2], p[0], p[1], p[2]);
    }
    for (uint32_t i = 0; i < t->mesh->triangle_count; ++i) {
        const uint32_t *v = t->mesh->triangles + 3 * (size_t)i;
        printf("    triangle %" PRIu32 ": %" PRIu32 " %" PRIu32 " %" PRIu32 "\n", i, v[0], v[1],
               v[2]);
    }
}

static int is_same(const sc_pair *x, const sc_pair *y)
{
    return x->a == y->a && x->b == y->b;
}

/* One query into an array of capacity pairs, which must come out as the head of the expected
   list. */
static int check_pairs(const trial *t, const way *w, uint32_t kind, uint32_t contact,
                       uint64_t capacity)
{
    const oracle_list *expected = &t->answer->lists[kind][contact];
    uint64_t written = capacity < expected->count ? capacity : expected->count, i = 0, k = 0;
    sc_pair *pairs = (sc_pair *)test_allocate((capacity + 1) * sizeof(sc_pair));
    sc_query_options options;
    sc_result result;
    sc_status status, wanted = capacity < expected->count ? SC_ERROR_SHORT_BUFFER : SC_OK;
    int ok;

    for (uint64_t j = 0; j <= capacity; ++j) pairs[j] = guard_pair;
    memset(&options, 0, sizeof(options));
    options.struct_size = sizeof(options);
    options.pairs = kind;
    options.contact = contact;
    options.method = w->method;
    options.contour = w->contour;
    options.rest_cache = w->rest_cache;
    memset(&result, 0, sizeof(result));
    result.struct_size = sizeof(result);
    result.capacity = capacity;
    result.pairs = pairs;
    result.collides = 7;
    result.count = 77;
    status = sc_query(t->model, t->workspace, t->input, &options, &result);

    while (i < written && is_same(&pairs[i], &expected->pairs[i])) ++i;
    for (k = written; k <= capacity && is_same(&pairs[k], &guard_pair);) ++k;
    ok = CHECK_MSG(status == wanted && result.count == expected->count &&
                       result.collides == (expected->count != 0) && i == written && k > capacity,
                   "%s, partition %s, weld %" PRIu32 ", method %s, pairs %" PRIu32
                   ", contact %" PRIu32 ", capacity %" PRIu64 ": status %d, collides %" PRIu32
                   ", count %" PRIu64 " instead of %" PRIu64 ", %" PRIu64
                   " right at the head, %" PRIu64 " untouched behind; soup's random state %" PRIu64,
                   t->name, t->partition, t->weld, w->name, kind, contact, capacity, (int)status,
                   result.collides, result.count, expected->count, i, k - written, t->state);
    if (!ok && test_failures() <= 3) {
        if (i < written && status == wanted)
            printf("    pair %" PRIu64 " is (%" PRIu32 ", %" PRIu32 ") instead of (%" PRIu32
                   ", %" PRIu32 ")\n",
                   i, pairs[i].a, pairs[i].b, expected->pairs[i].a, expected->pairs[i].b);
        print_reproducer(t);
    }
    free(pairs);
    return ok;
}

/* Count and any. */
static void check_number(const trial *t, const way *w, uint32_t kind, uint32_t contact,
                         uint32_t output)
{
    uint64_t expected = t->answer->lists[kind][contact].count;
    sc_query_options options;
    sc_result result;
    sc_status status;
    memset(&options, 0, sizeof(options));
    options.struct_size = sizeof(options);
    options.output = output;
    options.pairs = kind;
    options.contact = contact;
    options.method = w->method;
    options.contour = w->contour;
    options.rest_cache = w->rest_cache;
    memset(&result, 0, sizeof(result));
    result.struct_size = sizeof(result);
    status = sc_query(t->model, t->workspace, t->input, &options, &result);
    if (output == SC_OUTPUT_ANY && expected > 1) expected = 1;
    if (!CHECK_MSG(status == SC_OK && result.count == expected &&
                       result.collides == (expected != 0),
                   "%s, partition %s, weld %" PRIu32 ", method %s, output %" PRIu32
                   ", pairs %" PRIu32 ", contact %" PRIu32 ": status %d, collides %" PRIu32
                   ", count %" PRIu64 " instead of %" PRIu64 "; soup's random state %" PRIu64,
                   t->name, t->partition, t->weld, w->name, output, kind, contact, (int)status,
                   result.collides, result.count, expected, t->state) &&
        test_failures() <= 3)
        print_reproducer(t);
}

/* Whether contour none reports only true pairs, sorted: it may miss some but adds none. */
static void check_none(const trial *t, uint32_t kind, uint32_t contact)
{
    const oracle_list *expected = &t->answer->lists[kind][contact];
    sc_pair *pairs = (sc_pair *)test_allocate((expected->count + 1) * sizeof(sc_pair));
    uint64_t i = 0, k = 0;
    sc_query_options options;
    sc_result result;
    sc_status status;
    memset(&options, 0, sizeof(options));
    options.struct_size = sizeof(options);
    options.pairs = kind;
    options.contact = contact;
    options.method = SC_METHOD_SCTT;
    options.contour = SC_CONTOUR_NONE;
    memset(&result, 0, sizeof(result));
    result.struct_size = sizeof(result);
    result.capacity = expected->count;
    result.pairs = pairs;
    status = sc_query(t->model, t->workspace, t->input, &options, &result);
    if (CHECK_MSG(status == SC_OK && result.count <= expected->count,
                  "%s: status %d, count %" PRIu64, t->name, (int)status, result.count)) {
        for (; i < result.count; ++i) {
            while (k < expected->count && !is_same(&pairs[i], &expected->pairs[k])) ++k;
            if (k++ >= expected->count) break;
        }
        CHECK_MSG(i == result.count, "%s: contour none adds a pair", t->name);
    }
    free(pairs);
}

/* Everything that can be asked of a model in a pose. */
static void check_pose(const trial *t)
{
    for (uint32_t kind = 0; kind < 2; ++kind) {
        for (uint32_t contact = 0; contact < 2; ++contact) {
            uint64_t count = t->answer->lists[kind][contact].count;
            uint32_t chosen = test_random_below(WAYS);
            for (uint32_t i = 0; i < WAYS; ++i) {
                check_pairs(t, &ways[i], kind, contact, count + i % 2);
                if (i != chosen) continue;
                check_number(t, &ways[i], kind, contact, SC_OUTPUT_COUNT);
                check_number(t, &ways[i], kind, contact, SC_OUTPUT_ANY);
                if (count > 0)
                    check_pairs(t, &ways[i], kind, contact,
                                test_random_below(count > 1000000 ? 1000000 : (uint32_t)count));
            }
            check_none(t, kind, contact);
        }
    }
}

/*
 * A mesh in its rest pose and in another, both in random types, strides and places of memory, built
 * as chosen (randomly by input_choose for a weld and a partition if own is NULL) and asked
 * everything.
 */
static void check_chosen(const char *name, uint64_t state, const soup *mesh, const double *pose,
                         uint32_t weld, uint32_t partition, const input_choices *own)
{
    static const uint32_t gaps[] = {0, 1, 4, 7, 8, 20};
    uint32_t rest_type = test_random_below(2), pose_type = test_random_below(2);
    uint32_t index_type = mesh->vertex_count <= 65536 ? test_random_below(2) : SC_UINT32;
    soup rest = soup_copy(mesh);
    soup posed = soup_copy(mesh);
    input_array positions, indices;
    input_choices choices;
    sc_model *model = NULL;
    sc_workspace *workspace = NULL;
    sc_mesh input;
    uint32_t *map;
    sc_status status;

    memcpy(posed.positions, pose, 3 * (size_t)mesh->vertex_count * sizeof(double));
    if (rest_type == SC_FLOAT) soup_round_to_float(rest.positions, rest.vertex_count);
    if (pose_type == SC_FLOAT) soup_round_to_float(posed.positions, posed.vertex_count);
    if (own != NULL) {
        choices = *own;
    } else {
        choices = input_choose(&rest, weld, partition);
    }
    map = input_weld_of(&choices, &rest);
    positions =
        input_positions(rest.positions, rest.vertex_count, rest_type, gaps[test_random_below(6)]);
    indices =
        input_indices(rest.triangles, rest.triangle_count, index_type, gaps[test_random_below(6)]);
    input = input_mesh(&rest, &positions, &indices);
    status =
        sc_build(&input,
                 weld == SC_WELD_REST && partition == SC_PARTITION_FAST && test_random_below(2) != 0
                     ? NULL
                     : &choices.options,
                 &model);
    input_free(&positions); /* the model needs none of its inputs any more */
    input_free(&indices);
    if (CHECK_MSG(status == SC_OK && model != NULL,
                  "%s: sc_build with weld %" PRIu32 ", partition %s: %s; soup's random state "
                  "%" PRIu64,
                  name, weld, choices.partition_name, sc_status_string(status), state)) {
        status = sc_workspace_create(model, NULL, &workspace);
        CHECK(status == SC_OK && workspace != NULL);
    }
    for (int round = 0; round < 2 && workspace != NULL; ++round) {
        const soup *in = round == 0 ? &posed : &rest;
        oracle_answer answer;
        sc_pose pose_input;
        trial t;
        positions = input_positions(in->positions, in->vertex_count,
                                    round == 0 ? pose_type : rest_type, gaps[test_random_below(6)]);
        pose_input = input_pose(in->vertex_count, &positions);
        oracle_solve(in->positions, in->vertex_count, in->triangles, in->triangle_count, map,
                     &answer);
        t.name = name;
        t.mesh = &rest;
        t.pose = in->positions;
        t.state = state;
        t.model = model;
        t.workspace = workspace;
        t.input = &pose_input;
        t.partition = choices.partition_name;
        t.weld = weld;
        t.answer = &answer;
        check_pose(&t);
        oracle_free(&answer);
        input_free(&positions);
    }
    sc_workspace_free(workspace);
    sc_model_free(model);
    if (own == NULL) input_free_choices(&choices);
    free(map);
    soup_free(&rest);
    soup_free(&posed);
}

static void check_mesh(const char *name, uint64_t state, const soup *mesh, const double *pose,
                       uint32_t weld, uint32_t partition)
{
    check_chosen(name, state, mesh, pose, weld, partition, NULL);
}

static void check_random_build(const char *name, uint64_t state, const soup *mesh,
                               const double *pose)
{
    check_mesh(name, state, mesh, pose, test_random_below(3), test_random_below(4));
}

/* A soup whose pose is another soup's points: far from rest. */
static double *other_positions(const soup *s, uint32_t range)
{
    double *pose = (double *)test_allocate(3 * (size_t)s->vertex_count * sizeof(double));
    for (size_t i = 0; i < 3 * (size_t)s->vertex_count; ++i)
        pose[i] = range == 0 ? test_random_unit() : test_random_below(range + 1);
    return pose;
}

static void small_soups_on_a_grid(void)
{
    uint32_t rounds = test_iterations(2000);
    for (uint32_t i = 0; i < rounds; ++i) {
        static const uint32_t ranges[] = {1, 2, 2, 4, 4, 9};
        uint64_t state = test_random_state();
        uint32_t range = ranges[test_random_below(6)];
        soup s = soup_on_grid(range);
        double *pose = other_positions(&s, range);
        check_random_build("grid soup", state, &s, pose);
        free(pose);
        soup_free(&s);
    }
}

/* Two leaf clusters in which all triangles are the same, which share one point or two. */
static void copies_of_two_triangles(void)
{
    for (uint32_t shared = 1; shared <= 2; ++shared) {
        soup s = shape_copies(shared);
        double *pose = other_positions(&s, 3);
        check_mesh("copies", 0, &s, pose, SC_WELD_REST, SC_PARTITION_FAST);
        for (uint32_t i = 0; i < 3 * s.vertex_count; ++i) pose[i] = i % 3 == 2 ? 0 : pose[i];
        check_mesh("flat copies", 0, &s, pose, SC_WELD_REST, SC_PARTITION_FAST);
        free(pose);
        soup_free(&s);
    }
}

static void scattered_soups(void)
{
    uint32_t rounds = test_iterations(300);
    for (uint32_t i = 0; i < rounds; ++i) {
        uint64_t state = test_random_state();
        soup s = soup_scattered();
        double *pose = other_positions(&s, i % 2 == 0 ? 0 : 3);
        check_random_build("scattered soup", state, &s, pose);
        free(pose);
        soup_free(&s);
    }
}

/*
 * The ends of the range of float and double: products overflow and underflow, sums lose all but one
 * bit, but the answer is that of exact arithmetic.
 */
static void extreme_coordinates(void)
{
    static const double factors[] = {
        1e-30, 1e30, 1e-150, 1e150, 1e-300, 1e300, 4.94065645841e-324, 1e-310, 1.4012984643e-45,
        1e-40, 3e37, 4e306};
    uint32_t rounds = test_iterations(200);
    for (uint32_t i = 0; i < rounds; ++i) {
        uint64_t state = test_random_state();
        soup s = i % 2 == 0 ? soup_on_grid(4) : soup_scattered();
        double *pose, factor = factors[test_random_below(12)];
        uint32_t kind = test_random_below(5);
        /* Positions that float cannot hold would become infinite. */
        double limit = factor > 1e38 ? DBL_MAX / 40 : (double)FLT_MAX / 40;
        if (kind == 1 && factor < 1e30) soup_move(s.positions, s.vertex_count, 0x1p20);
        if (kind == 2) soup_nudge(s.positions, s.vertex_count);
        soup_scale(s.positions, s.vertex_count, factor);
        if (kind == 3) soup_move(s.positions, s.vertex_count, 1 / 3.0 * factor);
        pose = other_positions(&s, i % 3 == 0 ? 0 : 2);
        soup_scale(pose, s.vertex_count, factor);
        if (kind == 4) { /* exponents from one end to the other in one mesh */
            for (size_t c = 0; c < 3 * (size_t)s.vertex_count; ++c) {
                double x = ldexp(pose[c] / factor, (int)test_random_below(200) - 100);
                pose[c] = x > limit ? limit : x;
            }
        }
        if (kind == 2) soup_nudge(pose, s.vertex_count);
        if (factor > 1e38) { /* too large for float */
            input_choices none = input_choose(&s, SC_WELD_REST, SC_PARTITION_FAST);
            uint32_t *map = input_weld_of(&none, &s);
            sc_mesh mesh = input_plain_mesh(&s);
            sc_pose input = input_plain_pose(pose, s.vertex_count);
            sc_model *model = NULL;
            sc_workspace *workspace = NULL;
            if (CHECK(sc_build(&mesh, NULL, &model) == SC_OK) &&
                CHECK(sc_workspace_create(model, NULL, &workspace) == SC_OK)) {
                oracle_answer answer;
                trial t = {"huge soup", &s, pose, state, model, workspace, &input, "fast", 0, NULL};
                oracle_solve(pose, s.vertex_count, s.triangles, s.triangle_count, map, &answer);
                t.answer = &answer;
                check_pose(&t);
                oracle_free(&answer);
            }
            sc_workspace_free(workspace);
            sc_model_free(model);
            free(map);
            input_free_choices(&none);
        } else {
            check_random_build("extreme soup", state, &s, pose);
        }
        free(pose);
        soup_free(&s);
    }
}

/* Points in a plane that is oblique and not quite one: every orientation is a matter of
   rounding. */
static void nearly_coplanar(void)
{
    uint32_t rounds = test_iterations(200);
    for (uint32_t i = 0; i < rounds; ++i) {
        uint64_t state = test_random_state();
        soup s = soup_on_grid(3);
        double *pose = (double *)test_allocate(3 * (size_t)s.vertex_count * sizeof(double));
        double u = test_random_unit(), v = test_random_unit();
        for (uint32_t k = 0; k < s.vertex_count; ++k) {
            double *p = pose + 3 * (size_t)k;
            p[0] = s.positions[3 * k] / 3 + 0.1;
            p[1] = s.positions[3 * k + 1] / 7 + 0.1;
            p[2] = u * p[0] + v * p[1];
        }
        if (i % 2 == 0) soup_nudge(pose, s.vertex_count);
        check_random_build("nearly coplanar soup", state, &s, pose);
        free(pose);
        soup_free(&s);
    }
}

/* Pairs of triangles, each with points of its own; those of pair k begin at coordinate 18 k. */
static soup soup_of_pairs(uint32_t pairs)
{
    soup s = soup_make(6 * pairs, 2 * pairs);
    for (uint32_t k = 0; k < 3 * s.vertex_count; ++k) s.positions[k] = test_random_unit();
    for (uint32_t k = 0; k < 3 * s.triangle_count; ++k) s.triangles[k] = k;
    return s;
}

/* Moves the second end of an edge of the second triangle of a pair so that this edge comes as close
   as `off` to an edge of the first. Tells the ends of both. */
static void cross_edges(double *pair, double off, double *end[4])
{
    double along = test_random_range(0.1, 0.9), there = test_random_range(0.1, 0.9);
    uint32_t first = test_random_below(3), turn = test_random_below(3);
    end[0] = pair + 3 * first;
    end[1] = pair + 3 * ((first + 1) % 3);
    end[2] = pair + 9 + 3 * turn;
    end[3] = pair + 9 + 3 * ((turn + 1) % 3);
    for (uint32_t c = 0; c < 3; ++c) {
        double x = end[0][c] + along * (end[1][c] - end[0][c]) + off * test_random_range(-1, 1);
        end[3][c] = end[2][c] + (x - end[2][c]) / there;
    }
}

/* Pairs of triangles that cross each other's planes, of which an edge of one passes one of the
   other ever more closely. */
static void edges_that_nearly_meet(void)
{
    uint32_t rounds = test_iterations(150);
    for (uint32_t i = 0; i < rounds; ++i) {
        uint64_t state = test_random_state();
        uint32_t pairs = 1 + test_random_below(16);
        soup s = soup_of_pairs(pairs);
        for (uint32_t k = 0; k < pairs; ++k) {
            double *end[4];
            cross_edges(s.positions + 18 * k, exp2(-(double)test_random_below(60)), end);
        }
        check_random_build("edges that nearly meet", state, &s, s.positions);
        soup_free(&s);
    }
}

/* Pairs of triangles of which an edge of one and an edge of the other cross in a plane across an
   axis; or, of one pair in three, nearly so, by less than single precision tells. */
static void edges_that_meet_across_an_axis(void)
{
    uint32_t rounds = test_iterations(150);
    for (uint32_t i = 0; i < rounds; ++i) {
        uint64_t state = test_random_state();
        uint32_t pairs = 4 + test_random_below(13);
        soup s = soup_of_pairs(pairs);
        for (uint32_t k = 0; k < pairs; ++k) {
            double *end[4];
            uint32_t axis = test_random_below(3);
            cross_edges(s.positions + 18 * k, 0, end);
            for (uint32_t e = 1; e < 4; ++e) end[e][axis] = end[0][axis];
            if (test_random_below(3) == 0)
                end[test_random_below(4)][axis] *= 1 + exp2(-30.0 - test_random_below(22));
        }
        check_random_build("edges that meet across an axis", state, &s, s.positions);
        soup_free(&s);
    }
}

/* Pairs of triangles that share a point, and from there lie on one ray: the shorter edge ends on
   the longer one. What leads from the middle of one to that of the other is across the ray, but for
   rounding, and tells the rest of them apart. */
static void neighbors_on_a_ray(void)
{
    uint32_t rounds = test_iterations(60);
    for (uint32_t i = 0; i < rounds; ++i) {
        uint64_t state = test_random_state();
        uint32_t pairs = 1 + test_random_below(12);
        soup s = soup_make(5 * pairs, 2 * pairs);
        for (uint32_t k = 0; k < pairs; ++k) {
            double *p = s.positions + 15 * k, ray[3], other[3], across[3], more[3];
            uint32_t *t = s.triangles + 6 * k;
            for (uint32_t c = 0; c < 3; ++c) { /* whole numbers: the middle of the ray is exact */
                p[c] = floor(test_random_range(-1e9, 1e9));
                ray[c] = 2 * floor(test_random_range(-1e6, 1e6));
                other[c] = test_random_unit();
                more[c] = test_random_range(-3e5, 3e5);
            }
            for (uint32_t c = 0; c < 3; ++c)
                across[c] =
                    ray[(c + 1) % 3] * other[(c + 2) % 3] - ray[(c + 2) % 3] * other[(c + 1) % 3];
            for (uint32_t c = 0; c < 3; ++c) {
                p[3 + c] = p[c] + ray[c];
                p[6 + c] = p[c] + ray[c] / 2;
                p[9 + c] = p[c] + floor(across[c] / 2 + more[c]);
                p[12 + c] = p[9 + c] + ray[c] / 2 - floor(across[c]);
            }
            for (uint32_t c = 0; c < 6; ++c)
                t[c] = 5 * k + (c == 0 || c == 3 ? 0 : c == 1 ? 1 : c == 2 ? 3 : c == 4 ? 2 : 4);
        }
        check_random_build("neighbors on a ray", state, &s, s.positions);
        soup_free(&s);
    }
}

/* A fan of triangles round a point, flat across an axis, in a mesh so much larger that single
   precision tells little of it. It turns nearly once, or twice, from near a line of which a leaf
   cluster that is seen along the axis looks at the sides, is closed or ends anywhere, and turns
   back a little here and there. */
static void fans_in_a_plane(void)
{
    uint32_t rounds = test_iterations(400);
    for (uint32_t i = 0; i < rounds; ++i) {
        static const double lines[4][2] = {{1, 0.5}, {-0.5, 1}, {-1, -0.5}, {0.5, -1}};
        uint64_t state = test_random_state();
        uint32_t count = 4 + test_random_below(10), axis = test_random_below(3);
        uint32_t closed = test_random_below(4) == 0, line = test_random_below(4);
        double turns = count > 5 && test_random_below(4) == 0 ? 2 : 1;
        double size = exp2(-(double)test_random_below(24)), angle, sum = 0, place[2], step[16];
        soup s = soup_make(count + 5, count + 1);
        for (uint32_t c = 0; c < 2; ++c) place[c] = test_random_range(-1, 1);
        angle = atan2(lines[line][1], lines[line][0]);
        if (test_random_below(8) == 0) angle = test_random_range(-3, 3);
        for (uint32_t k = 0; k < count; ++k) {
            step[k] = test_random_range(0.3, 1);
            if (i % 4 == 3 && test_random_below(6) == 0)
                step[k] = -exp2(-(double)test_random_below(40));
            sum += step[k];
        }
        for (uint32_t k = 0; k < count + 5; ++k) {
            double far_away = k == count + 2 || k == count + 3 ? -1 : 1, *p = s.positions + 3 * k;
            double reach = k == 0 ? 0 : size * test_random_range(0.5, 1);
            double off = exp2(-4 - (double)test_random_below(40)) * test_random_range(-1, 1);
            p[axis] = 0.25;
            p[(axis + 1) % 3] = k > count + 1 ? far_away : place[0] + reach * cos(angle + off);
            p[(axis + 2) % 3] = k > count + 1 ? 1 - 1e-3 * k : place[1] + reach * sin(angle + off);
            if (k > 0 && k <= count) angle += turns * 6.283185307179586 * step[k - 1] / sum;
        }
        for (uint32_t k = 0; k <= count; ++k) {
            uint32_t *t = s.triangles + 3 * k;
            t[0] = k < count ? 0 : count + 2;
            t[1] = k < count ? k + 1 : count + 3;
            t[2] = k < count ? (closed && k + 1 == count ? 1 : k + 2) : count + 4;
        }
        check_random_build("fan in a plane", state, &s, s.positions);
        soup_free(&s);
    }
}

/* A leaf cluster that lies flat, or nearly, across an axis: a fan, the rim of which goes in and
   out, and more triangles at the rim, some of which reach for points far along it or just touch
   there. The fan turns nearly once, or twice, and back a little here and there. A strip behind it
   makes the mesh large, so that single precision tells little of it. */
static void outlines_in_a_plane(void)
{
    enum { STRIP = 16 };
    uint32_t rounds = test_iterations(600);
    for (uint32_t i = 0; i < rounds; ++i) {
        uint64_t state = test_random_state();
        uint32_t count = 4 + test_random_below(8), ears = test_random_below(4);
        uint32_t closed = test_random_below(3) != 0, axis = test_random_below(3), k;
        uint32_t rim = count + !closed, tip = rim + 1, strip = tip + ears;
        double turns = count > 5 && test_random_below(5) == 0 ? 2 : 1;
        double size = 0.3 * exp2(-(double)test_random_below(i % 2 ? 3 : 22)), sum = 0, step[16];
        double angle = test_random_range(-3, 3), place[2], (*at)[3];
        soup s = soup_make(strip + STRIP + 2, count + ears + STRIP);
        at = (double(*)[3])s.positions;
        for (k = 0; k < 2; ++k) place[k] = test_random_range(-0.5, 0.5);
        for (k = 0; k < count; ++k) {
            step[k] = test_random_range(0.3, 1);
            if (i % 4 == 3 && test_random_below(8) == 0)
                step[k] = -exp2(-(double)test_random_below(40));
            sum += step[k];
        }
        for (k = 0; k <= rim; ++k) {
            double reach = k == 0 ? 0 : size * test_random_range(k % 2 ? 0.9 : 0.3, 1);
            double off = exp2(-4 - (double)test_random_below(40)) * test_random_range(-1, 1);
            at[k][(axis + 1) % 3] = place[0] + reach * cos(angle + off);
            at[k][(axis + 2) % 3] = place[1] + reach * sin(angle + off);
            if (k > 0 && k <= count) angle += turns * 6.283185307179586 * step[k - 1] / sum;
        }
        for (k = 0; k < ears; ++k) {
            uint32_t near = test_random_below(rim + 1), edge = 1 + test_random_below(count);
            double off = size * exp2(-(double)test_random_below(40)) * test_random_range(-1, 1);
            uint32_t *t = s.triangles + 3 * (count + k);
            t[0] = edge < rim ? edge + 1 : 1;
            t[1] = edge;
            t[2] = tip + k;
            for (uint32_t c = 1; c < 3; ++c) {
                double far = at[t[0]][(axis + c) % 3] + at[t[1]][(axis + c) % 3];
                double out = far - place[c - 1] + test_random_range(-0.2, 0.2) * size;
                if (test_random_below(2)) out = at[near][(axis + c) % 3] + off;
                at[tip + k][(axis + c) % 3] = out;
            }
        }
        for (k = 0; k < STRIP + 2; ++k) {
            at[strip + k][(axis + 1) % 3] = 2.0 * k / (STRIP + 1) - 1;
            at[strip + k][(axis + 2) % 3] = k % 2 ? 1 : 0.97;
        }
        for (k = 0; k < s.vertex_count; ++k) {
            double off = size * exp2(-(double)test_random_below(30)) * test_random_range(-1, 1);
            at[k][axis] = 0.25 + (i % 3 == 0 && k < strip ? off : 0);
        }
        for (k = 0; k < count; ++k) {
            uint32_t *t = s.triangles + 3 * k;
            t[0] = 0;
            t[1] = k + 1;
            t[2] = k + 1 < rim ? k + 2 : 1;
        }
        for (k = 0; k < STRIP; ++k) {
            uint32_t *t = s.triangles + 3 * (count + ears + k);
            t[0] = strip + k;
            t[1] = strip + k + 1 + k % 2;
            t[2] = strip + k + 2 - k % 2;
        }
        check_random_build("outline in a plane", state, &s, s.positions);
        soup_free(&s);
    }
}

/* A band of triangles that lies flat, or nearly, across an axis, as two leaf clusters or three: it
   goes round, rather narrow or wide, until its end comes near its beginning, reaches over it, or
   just touches a point there. Its edges go in and out. A strip behind it makes the mesh large, so
   that single precision tells little of it. */
static void bands_in_a_plane(void)
{
    enum { STRIP = 16 };
    uint32_t rounds = test_iterations(800);
    for (uint32_t i = 0; i < rounds; ++i) {
        uint64_t state = test_random_state();
        uint32_t steps = 8 + test_random_below(6), axis = test_random_below(3), k;
        uint32_t strip = 2 * steps + 2;
        double size = 0.3 * exp2(-(double)test_random_below(i % 2 ? 3 : 22)), (*at)[3];
        double width = test_random_range(0.1, 0.45), turns = test_random_range(0.4, 1.3);
        double angle = test_random_range(-3, 3), place[2], inward = test_random_range(-0.1, 0.3);
        soup s = soup_make(strip + STRIP + 2, 2 * steps + STRIP);
        at = (double(*)[3])s.positions;
        for (k = 0; k < 2; ++k) place[k] = test_random_range(-0.5, 0.5);
        for (k = 0; k < strip; ++k) {
            double along = (double)(k / 2) / steps, reach = k % 2 ? 1 : 1 - 2 * width;
            double off = exp2(-3 - (double)test_random_below(i % 4 ? 6 : 40));
            reach = size * (reach * (1 - inward * along) + off * test_random_range(-1, 1));
            at[k][(axis + 1) % 3] = place[0] + reach * cos(angle + along * turns * 6.283185307);
            at[k][(axis + 2) % 3] = place[1] + reach * sin(angle + along * turns * 6.283185307);
        }
        if (test_random_below(3) != 0) { /* one of the last points to one of the first, or near */
            uint32_t last = strip - 1 - test_random_below(2), near = test_random_below(6);
            for (uint32_t c = 1; c < 3; ++c)
                at[last][(axis + c) % 3] =
                    at[near][(axis + c) % 3] +
                    size * exp2(-(double)test_random_below(40)) * test_random_range(-1, 1);
        }
        for (k = 0; k < STRIP + 2; ++k) {
            at[strip + k][(axis + 1) % 3] = 2.0 * k / (STRIP + 1) - 1;
            at[strip + k][(axis + 2) % 3] = k % 2 ? 1 : 0.97;
        }
        for (k = 0; k < s.vertex_count; ++k) {
            double off = size * exp2(-(double)test_random_below(30)) * test_random_range(-1, 1);
            at[k][axis] = 0.25 + (i % 3 == 0 && k < strip ? off / 8 : 0);
        }
        for (k = 0; k < 2 * steps + STRIP; ++k) {
            uint32_t *t = s.triangles + 3 * k, p = k < 2 * steps ? k : strip + k - 2 * steps;
            t[0] = p;
            t[1] = p + 1 + (p - (k < 2 * steps ? 0 : strip)) % 2;
            t[2] = p + 2 - (p - (k < 2 * steps ? 0 : strip)) % 2;
        }
        check_random_build("band in a plane", state, &s, s.positions);
        soup_free(&s);
    }
}

/* A mesh whose triangles are in leaf clusters in this order, in the pose it was made in; frees
   both. */
static void check_in_order(const char *name, uint64_t state, soup *s, uint32_t *order)
{
    input_choices own = input_choose(s, SC_WELD_NONE, SC_PARTITION_FAST);
    own.options.partition = SC_PARTITION_ORDER;
    own.options.order = order;
    check_chosen(name, state, s, s->positions, SC_WELD_NONE, SC_PARTITION_ORDER, &own);
    input_free_choices(&own);
    free(order);
    soup_free(s);
}

/* A tube of three leaf clusters that go round it, straight or bent, at any angle to the axes, with
   loops that go up and down. In places it is turned back, so that one band lies over the one
   before, or the loops are wound twice; it is pressed flat; a point is drawn near one of any other
   loop, or across an edge there, or of its own triangle, or just touches; or a triangle is turned.
   A strip behind it makes the mesh large, so that single precision tells little of it. */
static void tubes(void)
{
    enum { BANDS = 3, LOOPS = BANDS + 1 };
    uint32_t rounds = test_iterations(1500);
    for (uint32_t i = 0; i < rounds; ++i) {
        uint64_t state = test_random_state();
        uint32_t sides = 3 + test_random_below(6), strip = LOOPS * sides, k, c;
        uint32_t per_band = 2 * sides, count = (BANDS + 1) * per_band,
                 trouble = test_random_below(12);
        double size = 0.2 * exp2(-(double)test_random_below(i % 2 ? 3 : 22)), (*at)[3];
        double turns = trouble == 1 && sides > 5 ? 2 : 1, bend = test_random_range(0, 0.4);
        double rough = exp2(-1 - (double)test_random_below(8)), flat = 1, height = 0;
        double middle[3], turn[3][3], length = 0, tall = test_random_range(0.3, 2);
        double tilt = i % 3 ? 0 : test_random_range(-2, 2); /* loops are above and below others */
        soup s = soup_make(strip + per_band + 2, count);
        uint32_t *order = (uint32_t *)test_allocate(count * sizeof(uint32_t));
        at = (double(*)[3])s.positions;
        if (trouble == 2) flat = exp2(-(double)test_random_below(30));
        for (c = 0; c < 3; ++c) {
            middle[c] = test_random_range(-0.5, 0.5);
            turn[0][c] = test_random_range(-1, 1);
            turn[1][c] = test_random_range(-1, 1);
        }
        for (c = 0; c < 3; ++c) length += turn[0][c] * turn[0][c];
        for (c = 0; c < 3; ++c) /* at right angles to the first, if not as long */
            turn[2][c] = turn[0][(c + 1) % 3] * turn[1][(c + 2) % 3] -
                         turn[0][(c + 2) % 3] * turn[1][(c + 1) % 3];
        for (c = 0; c < 3; ++c)
            turn[1][c] = (turn[2][(c + 1) % 3] * turn[0][(c + 2) % 3] -
                          turn[2][(c + 2) % 3] * turn[0][(c + 1) % 3]) /
                         length;
        for (uint32_t loop = 0; loop < LOOPS; ++loop) {
            double wide = trouble == 3 ? test_random_range(0.6, 1) : 1;
            double start = test_random_range(-0.3, 0.3);
            for (k = 0; k < sides; ++k) {
                double angle =
                    (k + start + rough * test_random_range(-1, 1)) * turns * 6.283185307 / sides;
                double reach = wide * (1 + rough * test_random_range(-1, 1));
                double up =
                    height + tall * rough * test_random_range(-1, 1) + tilt * reach * cos(angle);
                double p[3] = {reach * cos(angle) + bend * height * height,
                               flat * reach * sin(angle), up};
                for (c = 0; c < 3; ++c)
                    at[loop * sides + k][c] =
                        middle[c] +
                        size * (turn[0][c] * p[0] + turn[1][c] * p[1] + turn[2][c] * p[2]);
            }
            height += trouble == 3 && test_random_below(2) ? -0.7 * tall : tall;
        }
        for (k = trouble < 4 || trouble > 7 ? 0 : 1 + test_random_below(2); k > 0; --k) {
            uint32_t p = test_random_below(strip), q = test_random_below(strip);
            uint32_t r = q / sides * sides + (q + 1) % sides;
            double share = trouble < 6 ? 0 : test_random_below(3) / 2.0;
            double off = size * exp2(-(double)test_random_below(50)) * test_random_range(-1, 1);
            for (c = 0; c < 3; ++c)
                at[p][c] = at[q][c] + share * (at[r][c] - at[q][c]) + (trouble == 7 ? 0 : off);
        }
        for (k = 0; k < per_band + 2; ++k)
            for (c = 0; c < 3; ++c)
                at[strip + k][c] = c == 0   ? 2.0 * k / (per_band + 1) - 1
                                   : c == 1 ? (k % 2 ? 1 : 0.97)
                                            : 0.9;
        for (k = 0; k < count; ++k) {
            uint32_t *t = s.triangles + 3 * k, band = k / per_band, side = k % per_band / 2;
            uint32_t p = band * sides + side, q = band * sides + (side + 1) % sides;
            uint32_t is_second = k % 2, swap = trouble == 0 && test_random_below(20) == 0;
            if (band == BANDS) {
                p = strip + k % per_band;
                t[0] = p, t[1] = p + 1 + is_second, t[2] = p + 2 - is_second;
            } else {
                t[0] = is_second ? q : p;
                t[1] = is_second ? q + sides : q;
                t[2] = p + sides;
            }
            if (swap) {
                c = t[1];
                t[1] = t[2];
                t[2] = c;
            }
            order[k] = k;
        }
        for (k = trouble < 8 ? 0 : 1 + test_random_below(2); k > 0; --k) {
            uint32_t *t = s.triangles + 3 * test_random_below(count - per_band);
            uint32_t corner = test_random_below(3);
            double share = test_random_range(0.1, 0.9);
            double *p = at[t[corner]], *q = at[t[(corner + 1) % 3]], *o = at[t[(corner + 2) % 3]];
            double off = exp2(-(double)test_random_below(50)) * test_random_range(-1, 1);
            for (c = 0; c < 3; ++c) {
                double to = q[c] + share * (o[c] - q[c]);
                p[c] = to + off * (to - p[c]);
            }
        }
        check_in_order("tube", state, &s, order);
    }
}

/* One leaf cluster round a tube that is no band and meets itself: a flap at the end of the tube
   that curls back into it, seen from the axis always from outside; a triangle whose plane the axis
   sees from outside at two corners only; and a collar in a plane right across the axis, of which
   rounding does not tell from where it is seen. */
static void tubes_that_are_no_bands(void)
{
    enum { POINTS = 10, TRIANGLES = 12 };
    static const struct {
        uint32_t points, triangles;
        int8_t at[3 * POINTS];
        uint8_t corners[3 * TRIANGLES];
    } bands[] = {
        {10,
         10,
         {7, 6,  -1, -11, 3,  0,  3,   -10, 0,  8,   8,  11, -9, 3, 10,
          2, -8, 11, 0,   12, 18, -15, -1,  18, -11, -3, 5,  -7, 1, 4},
         {0, 1, 4, 4, 3, 0, 2, 5, 1, 1, 5, 4, 2, 0, 3,
          3, 5, 2, 6, 3, 4, 4, 7, 6, 8, 7, 4, 8, 4, 9}},
        {6,
         6,
         {13, 1, 1, -9, 28, 8, -21, -4, -2, 13, -3, 25, -18, 21, 19, -6, -15, 7},
         {1, 3, 0, 4, 3, 1, 1, 2, 5, 5, 4, 1, 3, 2, 0, 3, 5, 2}},
        {9,
         12,
         {-73, -15, 3,  -1,  -37, 0, 50, -20, -51, -65, 9,  19, 58, -30,
          16,  15,  11, -24, -55, 5, 20, 35,  -31, 29,  20, 26, -49},
         {1, 3, 0, 1, 4, 3, 2, 4, 1, 5, 4, 2, 2, 0, 5, 3, 5, 0,
          6, 3, 4, 7, 6, 4, 5, 8, 4, 4, 8, 7, 6, 5, 3, 5, 6, 8}},
    };
    for (size_t i = 0; i < sizeof(bands) / sizeof(bands[0]); ++i) {
        uint32_t points = bands[i].points, count = bands[i].triangles, k;
        soup s = soup_make(points, count);
        uint32_t *order = (uint32_t *)test_allocate(count * sizeof(uint32_t));
        for (k = 0; k < 3 * points; ++k) s.positions[k] = bands[i].at[k];
        for (k = 0; k < 3 * count; ++k) s.triangles[k] = bands[i].corners[k];
        for (k = 0; k < count; ++k) order[k] = k;
        check_in_order("tube that is no band", test_random_state(), &s, order);
    }
}

/* Strips in planes across the axes that have one point in common, each a leaf cluster of its own:
   so many of them meet there, up to the most of which each two are a node of the test tree, and
   more. */
static void strips_from_one_point(void)
{
    enum { STRIP = 14 };
    static const uint32_t counts[] = {24, 25, 40, 48, 49};
    for (size_t i = 0; i < sizeof(counts) / sizeof(counts[0]); ++i) {
        uint64_t state = test_random_state();
        uint32_t strips = counts[i], count = strips * STRIP, k;
        soup s = soup_make(1 + strips * (STRIP + 1), count);
        uint32_t *order = (uint32_t *)test_allocate(count * sizeof(uint32_t));
        memset(s.positions, 0, 3 * sizeof(double));
        for (uint32_t v = 1; v < s.vertex_count; ++v) {
            uint32_t strip = (v - 1) / (STRIP + 1), place = (v - 1) % (STRIP + 1);
            double *at = s.positions + 3 * (size_t)v;
            at[strip % 3] = place < 2 ? 0 : test_random_range(-0.1, 0.1);
            at[(strip + 1) % 3] = place / 2 + (place == 1) + test_random_below(2);
            at[(strip + 2) % 3] = place < 2 ? 1 - (double)place : 1 - 2.0 * (place % 2);
            if (strip / 3 % 2) at[(strip + 1) % 3] *= -1;
        }
        for (k = 0; k < count; ++k) {
            uint32_t *t = s.triangles + 3 * k, first = 1 + k / STRIP * (STRIP + 1) + k % STRIP;
            t[0] = k % STRIP ? first - 1 : 0;
            t[1] = first;
            t[2] = first + 1;
            order[k] = k;
        }
        check_in_order("strips from one point", state, &s, order);
    }
}

/* Two bands round an axis on one side of a loop that they share, one in the other or through it. */
static void sleeves(void)
{
    uint32_t rounds = test_iterations(100);
    for (uint32_t i = 0; i < rounds; ++i) {
        uint64_t state = test_random_state();
        uint32_t sides = 5 + test_random_below(4), count = 4 * sides, k;
        soup s = soup_make(3 * sides, count);
        uint32_t *order = (uint32_t *)test_allocate(count * sizeof(uint32_t));
        for (uint32_t loop = 0; loop < 3; ++loop) {
            double wide = loop == 0 ? 1 : test_random_range(0.7, 1.4);
            double height = loop == 0 ? 0 : test_random_range(0.3, 1.5);
            for (k = 0; k < sides; ++k) {
                double *at = s.positions + 3 * (loop * sides + k);
                double angle = (k + test_random_range(-0.1, 0.1)) * 6.283185307 / sides;
                double reach = wide * test_random_range(0.9, 1.1);
                at[0] = reach * cos(angle);
                at[1] = reach * sin(angle);
                at[2] = height + test_random_range(-0.1, 0.1);
            }
        }
        for (k = 0; k < count; ++k) {
            uint32_t *t = s.triangles + 3 * k, side = k % (2 * sides) / 2;
            uint32_t next = (side + 1) % sides, above = (1 + k / (2 * sides)) * sides;
            t[0] = k % 2 ? next : side;
            t[1] = k % 2 ? above + next : next;
            t[2] = above + side;
            order[k] = k;
        }
        check_in_order("sleeves", state, &s, order);
    }
}

/* Points and triangles in a plane. Triangles are counterclockwise where they are not meant to be
   folded. */
typedef struct flat_mesh {
    double at[96][2];
    uint32_t corner[64][3], points, triangles;
} flat_mesh;

static void flat_add(flat_mesh *m, uint32_t a, uint32_t b, uint32_t c)
{
    uint32_t *t = m->corner[m->triangles++];
    t[0] = a;
    t[1] = b;
    t[2] = c;
}

/* Puts a point at a share of the way from a to b, and off that line to the right by a part of its
   length. */
static void flat_put_beside(flat_mesh *m, uint32_t a, uint32_t b, double share, double off,
                            uint32_t point)
{
    double x = m->at[b][0] - m->at[a][0], y = m->at[b][1] - m->at[a][1];
    double along = m->at[a][0] + share * x + off * y;
    m->at[point][1] = m->at[a][1] + share * y - off * x;
    m->at[point][0] = along;
}

/* A band of triangles that goes round, by so many turns; its edges go in and out. */
static void flat_make_band(flat_mesh *m, uint32_t triangles, double turns)
{
    double width = test_random_range(0.1, 0.4), rough = test_random_range(0, 0.1);
    double start = test_random_range(-3, 3), inward = test_random_range(-0.1, 0.2);
    m->points = triangles + 2;
    for (uint32_t k = 0; k < m->points; ++k) {
        double along = (double)k / (triangles + 1), angle = start + along * turns * 6.283185307;
        double reach = (k % 2 ? 1 : 1 - 2 * width) * (1 - inward * along);
        reach += rough * test_random_range(-1, 1);
        m->at[k][0] = reach * cos(angle);
        m->at[k][1] = reach * sin(angle);
        if (k >= 2) flat_add(m, k - 2, k - 1 + k % 2, k - k % 2);
    }
}

/* A fan that goes round twice, first near its middle, with so many points there, then farther out:
   its rim crosses itself once. */
static void flat_make_fan(flat_mesh *m, uint32_t rim, uint32_t inner)
{
    double weight[32], sum[2] = {0, 0}, angle = test_random_range(-3, 3);
    double over = test_random_range(0.1, 0.8), near = test_random_range(0.3, 0.7);
    double rough = test_random_range(0, 0.05);
    for (uint32_t k = 0; k < rim; ++k) sum[k > inner] += weight[k] = test_random_range(0.7, 1);
    m->at[0][0] = m->at[0][1] = 0;
    m->points = rim + 1;
    for (uint32_t k = 0; k < rim; ++k) { /* the edge to point k + 1, and then that */
        double reach = (k < inner ? near : 1) * (1 + rough * test_random_range(-1, 1));
        angle += weight[k] * (6.283185307 + (k > inner ? -over : over)) / sum[k > inner];
        m->at[k + 1][0] = reach * cos(angle);
        m->at[k + 1][1] = reach * sin(angle);
        flat_add(m, 0, k + 1, (k + 1) % rim + 1);
    }
}

/* Cuts a triangle in three, which changes no contour. */
static void flat_cut(flat_mesh *m, uint32_t triangle)
{
    uint32_t *t = m->corner[triangle], a = t[0], b = t[1], c = t[2], p = m->points++;
    double u = test_random_range(0.2, 0.4), v = test_random_range(0.2, 0.4);
    for (uint32_t k = 0; k < 2; ++k)
        m->at[p][k] =
            m->at[a][k] + u * (m->at[b][k] - m->at[a][k]) + v * (m->at[c][k] - m->at[a][k]);
    t[2] = p;
    flat_add(m, b, c, p);
    flat_add(m, c, a, p);
}

/* A triangle that pokes into another one from outside, or just touches it, across the side from
   point a to b. */
static void flat_poke(flat_mesh *m, uint32_t a, uint32_t b)
{
    uint32_t p = m->points, turn = test_random_below(3);
    double depth = exp2(-2 - (double)test_random_below(40));
    m->points += 3;
    flat_put_beside(m, a, b, test_random_range(0.3, 0.7), -depth, p);
    flat_put_beside(m, a, b, test_random_range(0.3, 0.7), 0.4, p + 1);
    flat_put_beside(m, p, p + 1, 1, -0.3, p + 2);
    flat_add(m, p + turn, p + (turn + 1) % 3, p + (turn + 2) % 3);
}

/* Two fans that touch in point 0, from hubs on either side of a line through it: the first has the
   given number of triangles. A rim point of each is on that line or all but on it, to the same side
   of point 0, and the line is across the way from the middle of one's points to that of the
   other's, sixteen times with the last one filling up. */
static void flat_make_touching(flat_mesh *m, uint32_t first, uint32_t second)
{
    double tilt = test_random_below(2) ? test_random_range(-3, 3) : 0, sum[2] = {0, 0};
    m->at[0][0] = m->at[0][1] = 0;
    m->points = 1;
    for (uint32_t s = 0; s < 2; ++s) {
        uint32_t rim = (s ? second : first) + 1, own = test_random_below(rim), hub = m->points++;
        uint32_t on = own + 1 < rim ? own + 1 : own - 1, newest = 0, last = hub;
        double across = s ? -1 : 1, reach = test_random_range(0.5, 0.7);
        m->at[hub][0] = across * reach;
        m->at[hub][1] = 0;
        for (uint32_t k = 0; k < rim; ++k, last = newest) {
            double angle = 6.283185307 * ((double)k - own) / (rim + 1);
            newest = k == own ? 0 : m->points++;
            if (k == on) {
                double off = exp2(-(double)test_random_below(45)) * test_random_range(-0.2, 1);
                m->at[newest][0] = test_random_below(4) ? across * off : 0;
                m->at[newest][1] = (on > own ? -1 : 1) * test_random_range(0.3, 0.8);
            } else if (k != own) {
                m->at[newest][0] = across * reach * (1 - cos(angle));
                m->at[newest][1] = -reach * sin(angle);
            }
            sum[s] += (k + 1 == rim ? 16 - rim : 1) * m->at[newest][1];
            if (k) flat_add(m, hub, s ? newest : last, s ? last : newest);
        }
    }
    if (test_random_below(4)) m->at[1][1] = sum[1] - sum[0];
    for (uint32_t k = 0; k < m->points; ++k) {
        double x = m->at[k][0], y = m->at[k][1];
        m->at[k][0] = (x * cos(tilt) - y * sin(tilt)) / 4;
        m->at[k][1] = (x * sin(tilt) + y * cos(tilt)) / 4;
    }
}

/* Checks such a mesh as two leaf clusters, the first of so many triangles or, if that is 0, any
   number, across an axis, or nearly; a triangle far away makes the whole large, so that single
   precision tells little of it. */
static void check_flat(uint64_t state, const flat_mesh *m, uint32_t count, int is_level)
{
    soup s = soup_make(m->points + 3, m->triangles + 1);
    double(*at)[3] = (double(*)[3])s.positions, place[2];
    double size = 0.3 * exp2(-(double)test_random_below(test_random_below(2) ? 3 : 20));
    uint32_t axis = test_random_below(3), least = m->triangles > 16 ? m->triangles - 16 : 1;
    uint32_t most = m->triangles > 16 ? 16 : m->triangles - 1;
    uint32_t first, order[64], name[96], k;
    sc_tree_node tree[5] = {{1, 2, 0, 0},
                            {3, 4, 0, 0},
                            {SC_NONE, SC_NONE, 0, 1},
                            {SC_NONE, SC_NONE, 0, 0},
                            {SC_NONE, SC_NONE, 0, 0}};
    input_choices own;
    /* the second often has few */
    if (test_random_below(2) && most - least > 2) least = most - 2;
    first = count ? count : least + test_random_below(most - least + 1);
    for (k = 0; k < 2; ++k) place[k] = test_random_range(-0.5, 0.5);
    for (k = 0; k < m->points; ++k) { /* contours begin anywhere */
        uint32_t other = test_random_below(k + 1);
        name[k] = name[other];
        name[other] = k;
    }
    for (k = 0; k < m->points + 3; ++k) {
        static const double far[3][2] = {{-1, 0.97}, {1, 0.97}, {0.3, 1}};
        double *x = at[k < m->points ? name[k] : k];
        for (uint32_t c = 0; c < 2; ++c)
            x[(axis + 1 + c) % 3] =
                k < m->points ? place[c] + size * m->at[k][c] : far[k - m->points][c];
        x[axis] = 0.25;
        if (!is_level && k < m->points)
            x[axis] += size / 8 * exp2(-(double)test_random_below(30)) * test_random_range(-1, 1);
    }
    for (k = 0; k < 3 * m->triangles; ++k) s.triangles[k] = name[m->corner[k / 3][k % 3]];
    for (k = 0; k < 3; ++k) s.triangles[3 * m->triangles + k] = m->points + k;
    tree[3].count = tree[4].first = first;
    tree[4].count = m->triangles - first;
    tree[2].first = m->triangles;
    own = input_choose(&s, SC_WELD_NONE, SC_PARTITION_FAST);
    for (k = 0; k <= m->triangles; ++k) order[k] = k;
    own.options.partition = SC_PARTITION_TREE;
    own.options.order = order;
    own.options.tree = tree;
    own.options.tree_count = 5;
    own.partition_name = "two clusters";
    check_chosen("two clusters in a plane", state, &s, s.positions, SC_WELD_NONE, SC_PARTITION_TREE,
                 &own);
    soup_free(&s);
}

/* Two leaf clusters in a plane whose contour tells, or all but tells, that they have nothing in
   common but what they share: bands of which the last point is near one of the first edges; fans
   that go round twice, mostly so that the edges of the rim that cross are few apart or as far apart
   as can be; contours that are simple though there is a fold inside; and contours in two pieces.
   Contours of sixteen or seventeen points are those at the end of which sixteen at a time are most
   easily mistaken. */
static void two_clusters_in_a_plane(void)
{
    uint32_t rounds = test_iterations(4000);
    for (uint32_t i = 0; i < rounds; ++i) {
        uint64_t state = test_random_state();
        uint32_t kind = i % 8 < 3 ? 0 : i % 8 < 5 ? 3 : i % 4, cuts = test_random_below(9);
        flat_mesh m;
        m.points = m.triangles = 0;
        if (kind == 0) {
            uint32_t count = i % 4 ? 14 + i / 8 % 2 : 8 + test_random_below(12),
                     near = test_random_below(3);
            double off = exp2(-(double)test_random_below(45)) * test_random_range(-1, 1);
            if (i % 4) cuts = 0;
            flat_make_band(&m, count, test_random_range(0.7, 1));
            flat_put_beside(&m, near, near + (near == 0 ? 1 : 2), test_random_range(0, 1),
                            test_random_below(8) ? off : 0, count + 1);
        } else if (kind == 1) {
            uint32_t rim = test_random_below(2) ? 16 : 10 + test_random_below(8);
            uint32_t inner = i % 16 < 8 ? 2 : rim / 2;
            flat_make_fan(&m, rim, test_random_below(4) ? inner : 2 + test_random_below(rim - 5));
        } else {
            flat_make_band(&m, 2 + test_random_below(kind == 3 ? 6 : 12), 0.4);
        }
        if (kind == 3) { /* across an edge of the contour */
            uint32_t k = test_random_below(m.triangles), odd = k % 2;
            flat_poke(&m, odd ? k : k + 2, odd ? k + 2 : k);
        }
        while (cuts-- > 0 && m.triangles <= 30) flat_cut(&m, test_random_below(m.triangles));
        if (kind == 2) { /* the point of the last cut, out of its triangle */
            const uint32_t *t;
            flat_cut(&m, test_random_below(m.triangles));
            t = m.corner[m.triangles - 1];
            flat_put_beside(&m, t[0], t[1], 0.5, test_random_range(0.05, 0.3), t[2]);
        }
        check_flat(state, &m, 0, i / 8 % 3 != 0);
    }
}

/* Two leaf clusters in a plane that touch in a point, and all but touch or meet beside it. */
static void two_clusters_at_a_point(void)
{
    uint32_t rounds = test_iterations(3000);
    for (uint32_t i = 0; i < rounds; ++i) {
        uint64_t state = test_random_state();
        uint32_t first = 1 + test_random_below(13);
        flat_mesh m;
        m.triangles = 0;
        flat_make_touching(&m, first, 1 + test_random_below(13));
        check_flat(state, &m, first, i % 3 != 0);
    }
}

static void deformed_meshes(void)
{
    uint32_t rounds = test_iterations(140);
    for (uint32_t i = 0; i < rounds; ++i) {
        uint64_t state = test_random_state();
        const char *name = NULL;
        soup s = soup_any_mesh(i % 4 == 0 ? 300 : 120, &name);
        double *pose = (double *)test_allocate(3 * (size_t)s.vertex_count * sizeof(double));
        memcpy(pose, s.positions, 3 * (size_t)s.vertex_count * sizeof(double));
        soup_any_pose(pose, s.vertex_count);
        if (test_random_below(6) == 0)
            soup_any_pose(s.positions, s.vertex_count); /* the rest too */
        check_random_build(name, state, &s, pose);
        free(pose);
        soup_free(&s);
    }
}

/*
 * Sheets in which all normals agree and only the contour tells that they lie on themselves:
 * spirals, and petals around a shared vertex; flat, or with just enough height to cross.
 */
static void what_only_contours_tell(void)
{
    uint32_t rounds = test_iterations(80);
    for (uint32_t i = 0; i < rounds; ++i) {
        uint64_t state = test_random_state();
        uint32_t across = 1 + test_random_below(5);
        soup s = i % 3 == 0
                     ? soup_spiral(10 + test_random_below(50), across, test_random_range(0.7, 2.2))
                 : i % 3 == 1 ? soup_flower(1 + test_random_below(4), across)
                              : soup_moebius(12 + test_random_below(30), across);
        double *pose = (double *)test_allocate(3 * (size_t)s.vertex_count * sizeof(double));
        uint32_t heights = test_random_below(3);
        if (i % 3 == 2) { /* cut open: no longer one-sided, but overlapping when crushed */
            s.triangle_count -= 2 * across;
            for (uint32_t v = 0; v < s.vertex_count; ++v) s.positions[3 * v + 2] = 0;
        }
        memcpy(pose, s.positions, 3 * (size_t)s.vertex_count * sizeof(double));
        for (uint32_t v = 0; v < s.vertex_count && heights != 0; ++v)
            pose[3 * v + 2] +=
                heights == 1 ? test_random_range(0, 0.01) : 0.05 * sin(9 * pose[3 * v]);
        if (test_random_below(3) == 0) soup_smooth(pose, s.vertex_count, 0.1);
        if (test_random_below(3) == 0) /* turned: other projections */
            for (uint32_t v = 0; v < s.vertex_count; ++v) {
                double x = pose[3 * v], z = pose[3 * v + 2];
                pose[3 * v] = 0.8 * x - 0.6 * z;
                pose[3 * v + 2] = 0.6 * x + 0.8 * z;
            }
        check_random_build("contour", state, &s, pose);
        free(pose);
        soup_free(&s);
    }
}

/*
 * Discs that go twice around their centre, all normals up: the contour of an inner disc, and of two
 * sectors that lie on each other, in partitions that leave them one neighbor, so that a contour
 * segment is as long and as winding as can be.
 */
static void branched_discs(void)
{
    uint32_t rounds = test_iterations(80);
    for (uint32_t i = 0; i < rounds; ++i) {
        uint64_t state = test_random_state();
        uint32_t around = 6 + 2 * test_random_below(8), rings = 1 + test_random_below(4);
        soup s = soup_branched(around, rings);
        double *pose = (double *)test_allocate(3 * (size_t)s.vertex_count * sizeof(double));
        uint32_t *order = (uint32_t *)test_allocate(s.triangle_count * sizeof(uint32_t));
        uint32_t count = s.triangle_count, a = 0, b = 0, place = 0;
        sc_tree_node tree[5];
        input_choices choices;
        memset(&choices, 0, sizeof(choices));
        choices.options.struct_size = sizeof(choices.options);
        choices.options.weld = SC_WELD_NONE;
        choices.options.partition = SC_PARTITION_TREE;
        choices.options.order = order;
        choices.options.tree = tree;
        choices.partition_name = "own tree";
        if (i % 2 == 0) { /* an inner disc and the rings around it */
            a = around + 2 * around * test_random_below(rings);
            for (uint32_t t = 0; t < count; ++t) order[t] = t;
            tree[0].left = 1;
            tree[0].right = 2;
            tree[1].first = 0;
            tree[1].count = a;
            tree[2].first = a;
            tree[2].count = count - a;
            choices.options.tree_count = 3;
            for (int n = 1; n < 3; ++n) tree[n].left = tree[n].right = SC_NONE;
            if (a == count) { /* nothing around it */
                tree[0] = tree[1];
                choices.options.tree_count = 1;
            }
        } else { /* two sectors opposite in angle, which lie on each other, and the rest */
            uint32_t first = test_random_below(around / 2);
            uint32_t width = 1 + test_random_below(around / 2 - first);
            for (uint32_t part = 0; part < 3; ++part) {
                for (uint32_t t = 0; t < count; ++t) {
                    uint32_t sector = t < around ? t : (t - around) / 2 % around;
                    uint32_t half = sector / (around / 2), within = sector % (around / 2);
                    uint32_t mine = within >= first && within < first + width ? half : 2;
                    if (mine == part) order[place++] = t;
                }
                if (part == 0) a = place;
                if (part == 1) b = place;
            }
            tree[0].left = 1;
            tree[0].right = 2;
            tree[1].left = 3;
            tree[1].right = 4;
            tree[3].first = 0;
            tree[3].count = a;
            tree[4].first = a;
            tree[4].count = b - a;
            tree[2].first = b;
            tree[2].count = count - b;
            choices.options.tree_count = 5;
            for (int n = 2; n < 5; ++n) tree[n].left = tree[n].right = SC_NONE;
            if (b == count) {
                tree[0] = tree[1];
                tree[1] = tree[3];
                tree[2] = tree[4];
                tree[0].left = 1;
                tree[0].right = 2;
                choices.options.tree_count = 3;
            }
        }
        memcpy(pose, s.positions, 3 * (size_t)s.vertex_count * sizeof(double));
        for (uint32_t v = 0; v < s.vertex_count; ++v)
            pose[3 * v + 2] = i % 4 < 2 ? test_random_range(0, 0.01) : 0.02 * pose[3 * v];
        check_chosen("branched disc", state, &s, pose, SC_WELD_NONE, SC_PARTITION_TREE, &choices);
        free(order);
        free(pose);
        soup_free(&s);
    }
}

/* Larger meshes with many pairs, each with every partition; all partitions report the same. */
static void every_partition(void)
{
    for (uint32_t shape = 0; shape < 4; ++shape) {
        soup s = shape == 0   ? soup_cloth(16, 40)
                 : shape == 1 ? soup_sphere(24, 20)
                 : shape == 2 ? soup_tube(16, 40)
                              : soup_moebius(60, 8);
        double *pose = (double *)test_allocate(3 * (size_t)s.vertex_count * sizeof(double));
        uint64_t state = test_random_state();
        memcpy(pose, s.positions, 3 * (size_t)s.vertex_count * sizeof(double));
        if (shape == 0) soup_twist(pose, s.vertex_count, 2.2);
        if (shape == 1) soup_smooth(pose, s.vertex_count, 0.6);
        if (shape >= 2) soup_fold(pose, s.vertex_count);
        soup_smooth(pose, s.vertex_count, 0.03);
        for (uint32_t partition = 0; partition < 4; ++partition)
            check_mesh("large mesh", state, &s, pose, SC_WELD_REST, partition);
        free(pose);
        soup_free(&s);
    }
}

/* One model and one workspace through a whole motion: move gets the rest pose and makes a frame's
   of it. */
static void check_motion(const char *name, soup *s, uint32_t frames,
                         void (*move)(const soup *s, double *pose, uint32_t frame, uint32_t frames))
{
    sc_mesh mesh = input_plain_mesh(s);
    sc_model *model = NULL;
    sc_workspace *workspace = NULL;
    if (!CHECK(sc_build(&mesh, NULL, &model) == SC_OK)) return;
    if (CHECK(sc_workspace_create(model, NULL, &workspace) == SC_OK)) {
        double *pose = (double *)test_allocate(3 * (size_t)s->vertex_count * sizeof(double));
        sc_pose input = input_plain_pose(pose, s->vertex_count);
        for (uint32_t frame = 0; frame < frames; ++frame) {
            oracle_answer answer;
            trial t = {name, s, pose, 0, model, workspace, &input, "fast", 0, NULL};
            memcpy(pose, s->positions, 3 * (size_t)s->vertex_count * sizeof(double));
            move(s, pose, frame, frames);
            oracle_solve(pose, s->vertex_count, s->triangles, s->triangle_count, NULL, &answer);
            t.answer = &answer;
            check_pose(&t);
            oracle_free(&answer);
        }
        free(pose);
    }
    sc_workspace_free(workspace);
    sc_model_free(model);
}

static void twist_back(const soup *s, double *pose, uint32_t frame, uint32_t frames)
{
    soup_twist(pose, s->vertex_count, 3.0 * (frames - frame) / frames);
}

static void one_workspace_many_poses(void)
{
    soup s = soup_cloth(8, 24);
    check_motion("motion", &s, test_iterations(24), twist_back);
    soup_free(&s);
}

/* In every other frame one vertex goes to the other side of the middle, vertex 4. */
static void fold_flat(const soup *s, double *pose, uint32_t frame, uint32_t frames)
{
    double *p = pose + 3 * (size_t)(frame / 2);
    (void)s;
    (void)frames;
    for (int k = 0; k < 3 && frame % 2; ++k) p[k] = 1.75 * pose[3 * 4 + k] - 0.75 * p[k];
}

/* A fan that lies flat, and the same folded over itself in its plane; alone, and so small beside a
   triangle far away that single precision tells nothing of it. */
static void fans_that_fold_flat(void)
{
    for (int far_away = 0; far_away < 2; ++far_away) {
        soup s = soup_cloth(2, 2);
        if (far_away) {
            soup near = s, away = soup_cloth(1, 1);
            for (uint32_t i = 0; i < 3 * away.vertex_count; ++i) away.positions[i] += 1e9;
            s = soup_join(&near, &away);
            soup_free(&near);
            soup_free(&away);
        }
        check_motion("fan", &s, 2 * s.vertex_count, fold_flat);
        soup_free(&s);
    }
}

/* Every capacity from none to one more than needed. */
static void short_buffers(void)
{
    uint32_t rounds = test_iterations(40);
    for (uint32_t i = 0; i < rounds; ++i) {
        uint64_t state = test_random_state();
        const char *name = "grid soup";
        soup s = i % 4 == 0 ? soup_any_mesh(60, &name) : soup_on_grid(2);
        sc_mesh mesh = input_plain_mesh(&s);
        sc_pose pose;
        sc_model *model = NULL;
        sc_workspace *workspace = NULL;
        if (CHECK(sc_build(&mesh, NULL, &model) == SC_OK) &&
            CHECK(sc_workspace_create(model, NULL, &workspace) == SC_OK)) {
            oracle_answer answer;
            trial t = {name, &s, s.positions, state, model, workspace, &pose, "fast", 0, NULL};
            uint32_t *map = (uint32_t *)test_allocate(s.vertex_count * sizeof(uint32_t));
            oracle_weld(s.positions, s.vertex_count, s.triangles, s.triangle_count, map);
            if (i % 4 == 0) soup_fold(s.positions, s.vertex_count);
            pose = input_plain_pose(s.positions, s.vertex_count);
            oracle_solve(s.positions, s.vertex_count, s.triangles, s.triangle_count, map, &answer);
            t.answer = &answer;
            for (uint32_t kind = 0; kind < 4; ++kind) {
                uint64_t count = answer.lists[kind / 2][kind % 2].count;
                for (uint64_t capacity = 0; capacity <= count + 1; ++capacity)
                    check_pairs(&t, &ways[capacity % WAYS], kind / 2, kind % 2, capacity);
            }
            free(map);
            oracle_free(&answer);
        }
        sc_workspace_free(workspace);
        sc_model_free(model);
        soup_free(&s);
    }
}

/* A vertex that no triangle uses may be anything. */
static void unused_vertices(void)
{
    double rest[8 * 3] = {0, 0, 0, 4, 0, 0, 0, 4, 0, 0, 0, 0, 1, 1, -1, 1, 1, 1, 9, 9, 1, 0, 0, 0};
    uint32_t triangles[6] = {0, 1, 2, 4, 5, 6};
    double nothings[3];
    nothings[0] = (double)NAN;
    nothings[1] = HUGE_VAL;
    nothings[2] = -HUGE_VAL;
    for (int i = 0; i < 27; ++i) {
        soup s;
        sc_mesh mesh;
        sc_pose pose;
        sc_model *model = NULL;
        sc_workspace *workspace = NULL;
        oracle_answer answer;
        s.vertex_count = 8;
        s.triangle_count = 2;
        s.positions = rest;
        s.triangles = triangles;
        for (int k = 0; k < 2; ++k) {
            rest[3 * (3 + 4 * k)] = nothings[i % 3];
            rest[3 * (3 + 4 * k) + 1] = nothings[i / 3 % 3];
            rest[3 * (3 + 4 * k) + 2] = nothings[i / 9];
        }
        mesh = input_plain_mesh(&s);
        pose = input_plain_pose(rest, 8);
        oracle_solve(rest, 8, triangles, 2, NULL, &answer);
        CHECK(answer.lists[0][0].count == 1);
        if (CHECK(sc_build(&mesh, NULL, &model) == SC_OK) &&
            CHECK(sc_workspace_create(model, NULL, &workspace) == SC_OK)) {
            trial t = {"unused vertices", &s, rest, 0, model, workspace, &pose, "fast", 0, NULL};
            t.answer = &answer;
            check_pose(&t);
        }
        sc_workspace_free(workspace);
        sc_model_free(model);
        oracle_free(&answer);
    }
}

/* The mesh folder, against the oracle and against the counts that its maker knows. */
static void meshes_of_the_folder(void)
{
    const char *folder = getenv("SC_MESHES") != NULL ? getenv("SC_MESHES") : "meshes";
    char path[512], line[512], name[256];
    uint32_t found = 0;
    FILE *file;
    snprintf(path, sizeof(path), "%s/expected.csv", folder);
    file = fopen(path, "r");
    if (!CHECK_MSG(file != NULL, "cannot read %s", path)) return;
    while (fgets(line, sizeof(line), file) != NULL) {
        unsigned vertices, triangles, counts[4];
        soup s;
        uint32_t *map;
        oracle_answer answer;
        size_t length;
        if (sscanf(line, "%255[^,],%u,%u,%u,%u,%u,%u", name, &vertices, &triangles, &counts[0],
                   &counts[1], &counts[2], &counts[3]) != 7)
            continue; /* the head line, a comment */
        length = strlen(name);
        snprintf(path, sizeof(path), "%s/%s%s", folder, name,
                 length > 4 && strcmp(name + length - 4, ".obj") == 0 ? "" : ".obj");
        if (!CHECK_MSG(input_read_obj(path, &s), "cannot read %s", path)) continue;
        ++found;
        CHECK_MSG(s.vertex_count == vertices && s.triangle_count == triangles,
                  "%s: %" PRIu32 " vertices, %" PRIu32 " triangles", name, s.vertex_count,
                  s.triangle_count);
        map = (uint32_t *)test_allocate(s.vertex_count * sizeof(uint32_t));
        oracle_weld(s.positions, s.vertex_count, s.triangles, s.triangle_count, map);
        oracle_solve(s.positions, s.vertex_count, s.triangles, s.triangle_count, map, &answer);
        for (int k = 0; k < 4; ++k) /* touching triangle, touching edge, proper triangle, edge */
            CHECK_MSG(answer.lists[k % 2][k / 2].count == counts[k],
                      "%s: the oracle finds %" PRIu64 ", expected.csv has %u in column %d", name,
                      answer.lists[k % 2][k / 2].count, counts[k], k + 4);
        check_mesh(name, 0, &s, s.positions, SC_WELD_REST, test_random_below(4));
        oracle_free(&answer);
        free(map);
        soup_free(&s);
    }
    fclose(file);
    CHECK_MSG(found >= 1, "no mesh in %s", folder);
}

SC_TEST_MAIN(SC_TEST(small_soups_on_a_grid), SC_TEST(copies_of_two_triangles),
             SC_TEST(scattered_soups), SC_TEST(extreme_coordinates), SC_TEST(nearly_coplanar),
             SC_TEST(edges_that_nearly_meet), SC_TEST(edges_that_meet_across_an_axis),
             SC_TEST(neighbors_on_a_ray), SC_TEST(fans_in_a_plane), SC_TEST(outlines_in_a_plane),
             SC_TEST(bands_in_a_plane), SC_TEST(tubes), SC_TEST(tubes_that_are_no_bands),
             SC_TEST(sleeves), SC_TEST(strips_from_one_point), SC_TEST(two_clusters_in_a_plane),
             SC_TEST(two_clusters_at_a_point), SC_TEST(deformed_meshes),
             SC_TEST(what_only_contours_tell), SC_TEST(branched_discs), SC_TEST(every_partition),
             SC_TEST(one_workspace_many_poses), SC_TEST(fans_that_fold_flat),
             SC_TEST(short_buffers), SC_TEST(unused_vertices), SC_TEST(meshes_of_the_folder))
