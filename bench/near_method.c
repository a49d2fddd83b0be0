/*
 * What is near, asked of the library; see near_method.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "near_method.h"

#include "tool.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

void near_method_free(near_method *near)
{
    free(near->lists[0]);
    free(near->lists[1]);
    sc_near_masks_free(near->masks);
    memset(near, 0, sizeof *near);
}

static bool reserve(near_method *near, int kind, uint64_t count)
{
    if (count <= near->room[kind]) return true;
    free(near->lists[kind]);
    near->room[kind] = count + count / 4;
    near->lists[kind] = (sc_pair *)malloc((size_t)near->room[kind] * sizeof(sc_pair));
    if (!near->lists[kind]) near->room[kind] = 0;
    return near->lists[kind] != NULL;
}

/* Makes masks for a question, if there are none yet or those for other rings. */
static sc_status make_masks(near_method *near, const sc_model *model,
                            const near_method_question *question)
{
    if (near->rings == question->ignore_rings) return SC_OK;
    sc_near_masks_free(near->masks);
    near->masks = NULL;
    near->rings = 0;
    const sc_status status =
        sc_near_masks_create(model, question->ignore_rings, NULL, &near->masks);
    if (status == SC_OK) near->rings = question->ignore_rings;
    return status;
}

/* One call of sc_query_near. */
static sc_status query_once(near_method *near, const sc_model *model, sc_workspace *workspace,
                            const sc_pose *pose, const near_method_question *question,
                            const sc_filter *filter, sc_stats *stats)
{
    sc_near_options options;
    sc_near_result result;
    memset(&options, 0, sizeof options);
    memset(&result, 0, sizeof result);
    options.struct_size = sizeof options;
    options.output = question->as == NEAR_COUNT ? SC_OUTPUT_COUNT : SC_OUTPUT_PAIRS;
    options.method = question->method;
    options.simd = question->simd;
    options.distance = question->distance;
    options.vertex_face_filter = options.edge_edge_filter = filter;
    options.masks = question->ignore_rings && !filter ? near->masks : NULL;
    options.tasks = question->tasks;
    result.struct_size = sizeof result;
    result.vertex_faces = near->lists[0];
    result.vertex_face_capacity = near->room[0];
    result.edge_edges = near->lists[1];
    result.edge_edge_capacity = near->room[1];
    result.stats = stats;
    const double from = tool_clock();
    const sc_status status = sc_query_near(model, workspace, pose, &options, &result);
    near->ms = tool_clock() - from;
    near->count[0] = result.vertex_face_count;
    near->count[1] = result.edge_edge_count;
    return status;
}

/* One call of sc_query_step. */
static sc_status step_once(near_method *near, const sc_model *model, sc_workspace *workspace,
                           const sc_pose *pose, const near_method_question *question,
                           const sc_filter *filter, sc_stats *stats)
{
    sc_step_options options;
    sc_step_result result;
    memset(&options, 0, sizeof options);
    memset(&result, 0, sizeof result);
    options.struct_size = sizeof options;
    options.output = SC_OUTPUT_PAIRS;
    options.method = question->method;
    options.simd = question->simd;
    options.separation = question->distance;
    options.vertex_face_filter = options.edge_edge_filter = filter;
    options.tasks = question->tasks;
    result.struct_size = sizeof result;
    result.vertex_faces = near->lists[0];
    result.vertex_face_capacity = near->room[0];
    result.edge_edges = near->lists[1];
    result.edge_edge_capacity = near->room[1];
    result.stats = stats;
    const double from = tool_clock();
    const sc_status status = sc_query_step(model, workspace, pose, pose, &options, &result);
    near->ms = tool_clock() - from;
    near->count[0] = result.vertex_face_count;
    near->count[1] = result.edge_edge_count;
    return status;
}

sc_status near_method_query(near_method *near, const sc_model *model, sc_workspace *workspace,
                            const sc_pose *pose, const near_method_question *question,
                            sc_stats *stats)
{
    sc_filter filter;
    memset(&filter, 0, sizeof filter);
    filter.struct_size = sizeof filter;
    filter.ignore_rings = question->ignore_rings;
    const bool masked = question->ignore_rings && question->as != NEAR_STILL &&
                        question->method == SC_NEAR_METHOD_SCTT;
    const sc_filter *const used = question->ignore_rings && !masked ? &filter : NULL;
    const sc_status made = masked ? make_masks(near, model, question) : SC_OK;
    if (made != SC_OK) return made;
    for (;;) {
        const sc_status status = (question->as == NEAR_STILL ? step_once : query_once)(
            near, model, workspace, pose, question, used, stats);
        if (status != SC_ERROR_SHORT_BUFFER) return status;
        if (!reserve(near, 0, near->count[0]) || !reserve(near, 1, near->count[1]))
            return SC_ERROR_MEMORY;
    }
}

static int compare_edges(const void *left, const void *right)
{
    const uint64_t a = *(const uint64_t *)left, b = *(const uint64_t *)right;
    return a < b ? -1 : a > b;
}

static int compare_lengths(const void *left, const void *right)
{
    const double a = *(const double *)left, b = *(const double *)right;
    return a < b ? -1 : a > b;
}

bool near_method_median_edge(const uint32_t *triangles, uint32_t triangle_count,
                             const double *positions, double *length)
{
    const size_t sides = 3 * (size_t)triangle_count;
    uint64_t *const edges = (uint64_t *)malloc(sides * sizeof *edges);
    double *const lengths = (double *)malloc(sides * sizeof *lengths);
    const bool done = edges && lengths && sides > 0;
    if (done) {
        size_t count = 0;
        for (size_t i = 0; i < sides; i++) {
            const uint32_t a = triangles[i], b = triangles[i % 3 == 2 ? i - 2 : i + 1];
            edges[i] = a < b ? ((uint64_t)a << 32) + b : ((uint64_t)b << 32) + a;
        }
        qsort(edges, sides, sizeof *edges, compare_edges);
        for (size_t i = 0; i < sides; i++) {
            if (i > 0 && edges[i] == edges[i - 1]) continue;
            const double *const p = positions + 3 * (size_t)(edges[i] >> 32);
            const double *const q = positions + 3 * (size_t)(edges[i] & 0xffffffffu);
            const double x = p[0] - q[0], y = p[1] - q[1], z = p[2] - q[2];
            lengths[count++] = sqrt(x * x + y * y + z * z);
        }
        qsort(lengths, count, sizeof *lengths, compare_lengths);
        *length = lengths[(count - 1) / 2];
    }
    free(edges);
    free(lengths);
    return done;
}
