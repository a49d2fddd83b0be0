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
     SC_METHOD_SCTT, SC_CONTOUR_EXACT, false, 0, false},
    {"star", "test tree with orientation and star-contour tests, as in the paper", NULL, false,
     false, SC_METHOD_SCTT, SC_CONTOUR_STAR, false, 0, false},
    {"none", "test tree without a contour test: MISSES PAIRS, which are counted", NULL, true, false,
     SC_METHOD_SCTT, SC_CONTOUR_NONE, false, 0, false},
    {"aabb-sctt",
     "tree of boxes, started at the test tree's non-adjacent children, as in the paper", NULL,
     false, false, SC_METHOD_AABB_SCTT, SC_CONTOUR_DEFAULT, false, 0, false},
    {"aabb", "a plain tree of boxes", NULL, false, false, SC_METHOD_AABB, SC_CONTOUR_DEFAULT, false,
     0, false},
    {"hash", "optimised spatial hashing, cells as long as the average edge", NULL, false, true, 0,
     0, false, 0, false},
    {"step", "of steps: test tree with cones and contours that move", NULL, false, false,
     SC_STEP_METHOD_SCTT, SC_CONTOUR_EXACT, true, 0, false},
    {"step-star", "of steps: test tree with moving star contours", NULL, false, false,
     SC_STEP_METHOD_SCTT, SC_CONTOUR_STAR, true, 0, false},
    {"step-none", "of steps: test tree without a contour test: MISSES PAIRS, which are counted",
     NULL, true, false, SC_STEP_METHOD_SCTT, SC_CONTOUR_NONE, true, 0, false},
    {"step-two-boxes", "of steps: a plain tree, with boxes at the start and at the end", NULL,
     false, false, SC_STEP_METHOD_TWO_BOXES, SC_CONTOUR_DEFAULT, true, 0, false},
    {"step-swept", "of steps: a plain tree, with boxes round the motion", NULL, false, false,
     SC_STEP_METHOD_SWEPT, SC_CONTOUR_DEFAULT, true, 0, false},
};

const size_t method_count = sizeof method_kinds / sizeof *method_kinds;

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
        *reason = kind->is_hash || kind->is_step ? "only queries of the library have @" : NULL;
        return !*reason;
    }
    *reason = "behind @ is none of base, avx2, avx512, serial";
    return false;
}

/* For as many workers as its queries have. */
static sc_status make_workspace(const method_kind *kind, const sc_model *model,
                                sc_workspace **workspace)
{
    if (kind->serial) return sc_workspace_create(model, NULL, workspace);
    return query_threads_workspace(model, kind->is_step ? SC_WORKSPACE_STEP : 0, workspace);
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
    if (!method_reserve(runner, runner->count)) return SC_ERROR_MEMORY;
    for (uint64_t i = 0; i < step->count[0]; i++) runner->pairs[i] = step->lists[0][i];
    for (uint64_t i = 0; i < step->count[1]; i++) {
        sc_pair *const to = &runner->pairs[step->count[0] + i];
        to->a = step->lists[1][i].a + 0x80000000u;
        to->b = step->lists[1][i].b + 0x80000000u;
    }
    return status;
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
    if (runner->kind->is_step)
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
