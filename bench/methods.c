/*
 * The methods that are measured; see methods.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "methods.h"

#include "query_threads.h"
#include "tool.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const method_kind method_kinds[] = {
    {"exact", "test tree with orientation and exact contour tests", NULL, false, false,
     SC_METHOD_SCTT, SC_CONTOUR_EXACT, false, 0, false, 0},
    {"star", "test tree with orientation and star-contour tests, as in the paper", NULL, false,
     false, SC_METHOD_SCTT, SC_CONTOUR_STAR, false, 0, false, 0},
    {"none", "test tree without a contour test: MISSES PAIRS, which are counted", NULL, true, false,
     SC_METHOD_SCTT, SC_CONTOUR_NONE, false, 0, false, 0},
    {"aabb-sctt",
     "tree of boxes, started at the test tree's non-adjacent children, as in the paper", NULL,
     false, false, SC_METHOD_AABB_SCTT, SC_CONTOUR_DEFAULT, false, 0, false, 0},
    {"aabb", "a plain tree of boxes", NULL, false, false, SC_METHOD_AABB, SC_CONTOUR_DEFAULT, false,
     0, false, 0},
    {"hash", "optimised spatial hashing, cells as long as the average edge", NULL, false, true, 0,
     0, false, 0, false, 0},
    {"step", "of steps: test tree with cones and contours that move", NULL, false, false,
     SC_STEP_METHOD_SCTT, SC_CONTOUR_EXACT, true, 0, false, 0},
    {"step-star", "of steps: test tree with moving star contours", NULL, false, false,
     SC_STEP_METHOD_SCTT, SC_CONTOUR_STAR, true, 0, false, 0},
    {"step-none", "of steps: test tree without a contour test: MISSES PAIRS, which are counted",
     NULL, true, false, SC_STEP_METHOD_SCTT, SC_CONTOUR_NONE, true, 0, false, 0},
    {"step-two-boxes", "of steps: a plain tree, with boxes at the start and at the end", NULL,
     false, false, SC_STEP_METHOD_TWO_BOXES, SC_CONTOUR_DEFAULT, true, 0, false, 0},
    {"step-swept", "of steps: a plain tree, with boxes round the motion", NULL, false, false,
     SC_STEP_METHOD_SWEPT, SC_CONTOUR_DEFAULT, true, 0, false, 0},
    {"near", "of what is near: test tree with contours that keep clear; sorted pairs", NULL, false,
     false, SC_NEAR_METHOD_SCTT, SC_CONTOUR_DEFAULT, false, 0, false, NEAR_LIST},
    {"near-count", "of what is near: the same, counted and not listed", NULL, false, false,
     SC_NEAR_METHOD_SCTT, SC_CONTOUR_DEFAULT, false, 0, false, NEAR_COUNT},
    {"near-boxes", "of what is near: a plain tree of boxes; sorted pairs", NULL, false, false,
     SC_NEAR_METHOD_BOXES, SC_CONTOUR_DEFAULT, false, 0, false, NEAR_LIST},
    {"near-still",
     "of what is near: a step that does not move; a few pairs more, which are counted", NULL, false,
     false, SC_STEP_METHOD_SCTT, SC_CONTOUR_EXACT, false, 0, false, NEAR_STILL},
    {"near-inflated", "of what is near: the same, by a plain tree of inflated boxes", NULL, false,
     false, SC_STEP_METHOD_SWEPT, SC_CONTOUR_DEFAULT, false, 0, false, NEAR_STILL},
};

const size_t method_count = sizeof method_kinds / sizeof *method_kinds;

uint32_t method_asks(const method_kind *kind)
{
    if (kind->near) return METHOD_NEAR;
    if (kind->is_step) return METHOD_STEPS;
    return SC_PAIRS_TRIANGLE;
}

const method_kind *method_find(const char *name)
{
    for (size_t i = 0; i < method_count; i++) {
        if (strcmp(method_kinds[i].name, name) == 0) return &method_kinds[i];
    }
    return NULL;
}

bool method_read(const char *text, method_variant *variant, const char **reason)
{
    static const struct {
        const char *name;
        uint32_t simd;
        bool serial;
    } ways[] = {{"base", SC_SIMD_BASE, false},
                {"avx2", SC_SIMD_AVX2, false},
                {"avx512", SC_SIMD_AVX512, false},
                {"serial", SC_SIMD_BEST, true}};
    snprintf(variant->name, sizeof variant->name, "%s", text);
    char *const at = strchr(variant->name, '@');
    if (at) *at = '\0';
    const method_kind *kind = method_find(variant->name);
    *reason = !kind ? "there is no such method" : kind->missing;
    if (*reason) return false;
    variant->kind = *kind;
    variant->kind.name = variant->name;
    if (!at) return true;
    *at = '@';
    for (size_t i = 0; i < sizeof ways / sizeof *ways; i++) {
        if (strcmp(at + 1, ways[i].name) != 0) continue;
        variant->kind.simd = ways[i].simd;
        variant->kind.serial = ways[i].serial;
        *reason = kind->is_hash || kind->is_step || kind->near == NEAR_STILL
                      ? "only queries of the library have @"
                      : NULL;
        return !*reason;
    }
    *reason = "behind @ is none of base, avx2, avx512, serial";
    return false;
}

/* For as many workers as its queries have. */
static sc_status make_workspace(const method_kind *kind, const sc_model *model,
                                sc_workspace **workspace)
{
    uint32_t flags = 0;
    if (kind->near) flags = SC_WORKSPACE_NEAR;
    if (kind->is_step) flags = SC_WORKSPACE_STEP;
    if (!kind->serial) return query_threads_workspace(model, flags, workspace);
    sc_workspace_options options;
    memset(&options, 0, sizeof options);
    options.struct_size = sizeof options;
    options.flags = flags;
    return sc_workspace_create_for(model, &options, workspace);
}

bool method_open(method_runner *runner, const method_kind *kind, const method_mesh *mesh,
                 const double *rest, const char **reason)
{
    memset(runner, 0, sizeof *runner);
    runner->kind = kind;
    runner->mesh = mesh;
    *reason = NULL;
    if (kind->is_hash) {
        runner->hash = spatial_hash_create(rest, mesh->vertex_count, mesh->triangles,
                                           mesh->triangle_count, reason);
    } else {
        const sc_status status = make_workspace(kind, mesh->model, &runner->workspace);
        if (status != SC_OK) *reason = sc_status_string(status);
    }
    return *reason == NULL;
}

void method_close(method_runner *runner)
{
    sc_workspace_free(runner->workspace);
    spatial_hash_free(runner->hash);
    step_method_free(&runner->step);
    near_method_free(&runner->near);
    free(runner->pairs);
    memset(runner, 0, sizeof *runner);
}

bool method_reserve(method_runner *runner, uint64_t count)
{
    if (count <= runner->room) return true;
    sc_pair *larger = (sc_pair *)realloc(runner->pairs, (size_t)count * sizeof *larger);
    if (!larger) return false;
    runner->pairs = larger;
    runner->room = count;
    return true;
}

/* The hash sorts into its own array, so that is copied, as the library's answer is its caller's. */
static bool query_hash(method_runner *runner, const double *positions,
                       const method_question *question, sc_stats *stats, double *milliseconds)
{
    spatial_hash_answer answer;
    const double start = tool_clock();
    if (!spatial_hash_query(runner->hash, positions, question->pairs, question->contact, &answer))
        return false;
    if (!method_reserve(runner, answer.count)) return false;
    if (answer.count)
        memcpy(runner->pairs, answer.pairs, (size_t)answer.count * sizeof *runner->pairs);
    *milliseconds = tool_clock() - start;
    runner->count = answer.count;
    if (stats) {
        stats->counts[SC_TASK_BOXES_ORIENTATION] = answer.box_tests;
        stats->counts[SC_TASK_PRIMITIVES_ORIENTATION] = answer.primitive_tests;
        stats->exact_fallbacks = answer.undecided;
    }
    return true;
}

static sc_pose make_pose(const method_mesh *mesh, const void *positions)
{
    sc_pose pose;
    memset(&pose, 0, sizeof pose);
    pose.struct_size = sizeof pose;
    pose.vertex_count = mesh->vertex_count;
    pose.position_type = mesh->position_type;
    pose.positions = positions;
    return pose;
}

static sc_status query_library(method_runner *runner, const void *positions,
                               const method_question *question, sc_stats *stats,
                               double *milliseconds)
{
    const sc_pose pose = make_pose(runner->mesh, positions);
    sc_query_options options;
    memset(&options, 0, sizeof options);
    options.struct_size = sizeof options;
    options.pairs = question->pairs;
    options.contact = question->contact;
    options.method = runner->kind->method;
    options.contour = runner->kind->contour;
    options.simd = runner->kind->simd;
    options.tasks = runner->kind->serial ? NULL : query_threads_tasks();
    sc_result result;
    memset(&result, 0, sizeof result);
    result.struct_size = sizeof result;
    result.capacity = runner->room;
    result.pairs = runner->pairs;
    result.stats = stats;
    const double start = tool_clock();
    const sc_status status =
        sc_query(runner->mesh->model, runner->workspace, &pose, &options, &result);
    *milliseconds = tool_clock() - start;
    runner->count = result.count;
    return status;
}

/* Makes one sorted list of those of vertex-face and of edge-edge pairs; see method_query. */
static sc_status join_lists(method_runner *runner, sc_pair *const lists[2], const uint64_t count[2])
{
    if (!method_reserve(runner, count[0] + count[1])) return SC_ERROR_MEMORY;
    for (uint64_t i = 0; i < count[0]; i++) runner->pairs[i] = lists[0][i];
    for (uint64_t i = 0; i < count[1]; i++) {
        sc_pair *const to = &runner->pairs[count[0] + i];
        to->a = lists[1][i].a + 0x80000000u;
        to->b = lists[1][i].b + 0x80000000u;
    }
    return SC_OK;
}

static sc_status query_step(method_runner *runner, const method_pose *pose, bool pairs_wanted,
                            sc_stats *stats, double *milliseconds)
{
    step_method *const step = &runner->step;
    const sc_pose start = make_pose(runner->mesh, pose->positions);
    const sc_pose end = make_pose(runner->mesh, pose->end);
    const sc_status status =
        step_method_query(step, runner->mesh->model, runner->workspace, &start, &end,
                          runner->kind->method, runner->kind->contour, stats);
    *milliseconds = step->ms;
    runner->count = step->count[0] + step->count[1];
    if (status != SC_OK || !pairs_wanted) return status;
    return join_lists(runner, step->lists, step->count);
}

static sc_status query_near(method_runner *runner, const void *positions,
                            const method_question *question, bool pairs_wanted, sc_stats *stats,
                            double *milliseconds)
{
    const method_kind *const kind = runner->kind;
    near_method *const near = &runner->near;
    const sc_pose pose = make_pose(runner->mesh, positions);
    near_method_question asked = {question->distance, question->ignore_rings,
                                  kind->near,         kind->method,
                                  kind->simd,         kind->serial ? NULL : query_threads_tasks()};
    sc_status status =
        near_method_query(near, runner->mesh->model, runner->workspace, &pose, &asked, stats);
    *milliseconds = near->ms;
    runner->count = near->count[0] + near->count[1];
    if (status != SC_OK || !pairs_wanted) return status;
    if (kind->near == NEAR_COUNT) {
        const uint64_t counted[2] = {near->count[0], near->count[1]};
        asked.as = NEAR_LIST;
        status =
            near_method_query(near, runner->mesh->model, runner->workspace, &pose, &asked, NULL);
        if (status == SC_OK && (counted[0] != near->count[0] || counted[1] != near->count[1]))
            status = SC_ERROR_COUNT;
        if (status != SC_OK) return status;
    }
    return join_lists(runner, near->lists, near->count);
}

bool method_query(method_runner *runner, const method_pose *pose, const method_question *question,
                  bool pairs_wanted, sc_stats *stats, double *milliseconds, const char **reason)
{
    sc_status status = SC_OK;
    if (stats) {
        memset(stats, 0, sizeof *stats);
        stats->struct_size = sizeof *stats;
    }
    if (runner->kind->is_hash) {
        *reason = "out of memory, or an edge meets too many cells";
        return query_hash(runner, pose->doubles, question, stats, milliseconds);
    }
    if (runner->kind->near)
        status = query_near(runner, pose->positions, question, pairs_wanted, stats, milliseconds);
    else if (runner->kind->is_step)
        status = query_step(runner, pose, pairs_wanted, stats, milliseconds);
    else
        status = query_library(runner, pose->positions, question, stats, milliseconds);
    if (status == SC_ERROR_SHORT_BUFFER) {
        status = method_reserve(runner, runner->count + runner->count / 4)
                     ? query_library(runner, pose->positions, question, stats, milliseconds)
                     : SC_ERROR_MEMORY;
    }
    *reason = sc_status_string(status);
    return status == SC_OK;
}
