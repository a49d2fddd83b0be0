/*
 * See pair_trial.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "pair_trial.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "harness.h"

const trial_way trial_ways[TRIAL_WAYS] = {
    {"default", SC_METHOD_DEFAULT, SC_CONTOUR_DEFAULT, SC_REST_CACHE_ON},
    {"sctt", SC_METHOD_SCTT, SC_CONTOUR_DEFAULT, SC_REST_CACHE_ON},
    {"sctt, no cache", SC_METHOD_SCTT, SC_CONTOUR_DEFAULT, SC_REST_CACHE_OFF},
    {"sctt, star", SC_METHOD_SCTT, SC_CONTOUR_STAR, SC_REST_CACHE_ON},
    {"sctt, star, no cache", SC_METHOD_SCTT, SC_CONTOUR_STAR, SC_REST_CACHE_OFF},
    {"aabb sctt", SC_METHOD_AABB_SCTT, SC_CONTOUR_DEFAULT, SC_REST_CACHE_ON},
    {"aabb", SC_METHOD_AABB, SC_CONTOUR_DEFAULT, SC_REST_CACHE_ON},
};

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

/* Asks with any instruction set that the machine has. */
static sc_status ask(const trial *t, sc_query_options *options, sc_result *result)
{
    sc_status status;
    options->simd = test_random_below(SC_SIMD_AVX512 + 1);
    status = sc_query(t->model, t->workspace, t->input, options, result);
    if (status != SC_ERROR_UNSUPPORTED || options->simd <= SC_SIMD_BASE) return status;
    options->simd = SC_SIMD_BEST;
    return sc_query(t->model, t->workspace, t->input, options, result);
}

int trial_check_pairs(const trial *t, const trial_way *w, uint32_t kind, uint32_t contact,
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
    status = ask(t, &options, &result);

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
static void check_number(const trial *t, const trial_way *w, uint32_t kind, uint32_t contact,
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
    status = ask(t, &options, &result);
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
    status = ask(t, &options, &result);
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

void trial_check_pose(const trial *t)
{
    for (uint32_t kind = 0; kind < 2; ++kind) {
        for (uint32_t contact = 0; contact < 2; ++contact) {
            uint64_t count = t->answer->lists[kind][contact].count;
            uint32_t chosen = test_random_below(TRIAL_WAYS);
            for (uint32_t i = 0; i < TRIAL_WAYS; ++i) {
                trial_check_pairs(t, &trial_ways[i], kind, contact, count + i % 2);
                if (i != chosen) continue;
                check_number(t, &trial_ways[i], kind, contact, SC_OUTPUT_COUNT);
                check_number(t, &trial_ways[i], kind, contact, SC_OUTPUT_ANY);
                if (count > 0)
                    trial_check_pairs(
                        t, &trial_ways[i], kind, contact,
                        test_random_below(count > 1000000 ? 1000000 : (uint32_t)count));
            }
            check_none(t, kind, contact);
        }
    }
}

void trial_check_chosen(const char *name, uint64_t state, const soup *mesh, const double *pose,
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
        trial_check_pose(&t);
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

void trial_check(const char *name, uint64_t state, const soup *mesh, const double *pose,
                 uint32_t weld, uint32_t partition)
{
    trial_check_chosen(name, state, mesh, pose, weld, partition, NULL);
}

void trial_check_random_build(const char *name, uint64_t state, const soup *mesh,
                              const double *pose)
{
    trial_check(name, state, mesh, pose, test_random_below(3), test_random_below(4));
}

void trial_check_motion(const char *name, soup *s, uint32_t frames,
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
            trial_check_pose(&t);
            oracle_free(&answer);
        }
        free(pose);
    }
    sc_workspace_free(workspace);
    sc_model_free(model);
}
