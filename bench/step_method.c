/*
 * A step, asked of the library; see step_method.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "step_method.h"

#include "query_threads.h"
#include "tool.h"

#include <stdlib.h>
#include <string.h>

void step_method_free(step_method *step)
{
    free(step->lists[0]);
    free(step->lists[1]);
    memset(step, 0, sizeof *step);
}

static bool reserve(step_method *step, int kind, uint64_t count)
{
    if (count <= step->room[kind]) return true;
    free(step->lists[kind]);
    step->room[kind] = count + count / 4;
    step->lists[kind] = (sc_pair *)malloc((size_t)step->room[kind] * sizeof(sc_pair));
    if (!step->lists[kind]) step->room[kind] = 0;
    return step->lists[kind] != NULL;
}

sc_status step_method_query(step_method *step, const sc_model *model, sc_workspace *workspace,
                            const sc_pose *start, const sc_pose *end, uint32_t method,
                            uint32_t contour, sc_stats *stats)
{
    sc_step_options options;
    sc_step_result result;
    memset(&options, 0, sizeof options);
    memset(&result, 0, sizeof result);
    options.struct_size = sizeof options;
    options.output = SC_OUTPUT_COUNT;
    options.pairs = SC_STEP_CANDIDATES;
    options.method = method;
    options.contour = contour;
    options.tasks = query_threads_tasks();
    result.struct_size = sizeof result;
    double from = tool_clock();
    sc_status status = sc_query_step(model, workspace, start, end, &options, &result);
    step->candidates_ms = tool_clock() - from;
    step->candidates = result.vertex_face_count + result.edge_edge_count;
    options.output = SC_OUTPUT_PAIRS;
    options.pairs = SC_STEP_COLLISIONS;
    result.stats = stats;
    while (status == SC_OK) {
        result.vertex_faces = step->lists[0];
        result.vertex_face_capacity = step->room[0];
        result.edge_edges = step->lists[1];
        result.edge_edge_capacity = step->room[1];
        from = tool_clock();
        status = sc_query_step(model, workspace, start, end, &options, &result);
        step->ms = tool_clock() - from;
        if (status != SC_ERROR_SHORT_BUFFER) break;
        status =
            reserve(step, 0, result.vertex_face_count) && reserve(step, 1, result.edge_edge_count)
                ? SC_OK
                : SC_ERROR_MEMORY;
    }
    step->count[0] = result.vertex_face_count;
    step->count[1] = result.edge_edge_count;
    return status;
}
