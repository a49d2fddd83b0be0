/*
 * Builds the model of a scene; see bench_model.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "bench_model.h"

#include "tool.h"

#include "starcontour_metis.h"

#include <stdlib.h>
#include <string.h>

void *bench_model_positions(const scene_folder *scene, const double *positions)
{
    const size_t count = 3 * (size_t)scene->vertex_count;
    void *const copy = malloc(count * (scene->single ? sizeof(float) : sizeof(double)));
    if (copy && scene->single) {
        for (size_t i = 0; i < count; i++) ((float *)copy)[i] = (float)positions[i];
    } else if (copy) {
        memcpy(copy, positions, count * sizeof(double));
    }
    return copy;
}

sc_status bench_model_build(const scene_folder *scene, const double *rest, uint32_t partition,
                            sc_build_options *options, sc_model **model, double *milliseconds)
{
    void *const positions = bench_model_positions(scene, rest);
    if (!positions) return SC_ERROR_MEMORY;
    sc_mesh mesh;
    memset(&mesh, 0, sizeof mesh);
    mesh.struct_size = sizeof mesh;
    mesh.vertex_count = scene->vertex_count;
    mesh.triangle_count = scene->triangle_count;
    mesh.position_type = scene->single ? SC_FLOAT : SC_DOUBLE;
    mesh.positions = positions;
    mesh.indices = scene->triangles;
    options->struct_size = sizeof *options;
    if (partition == BENCH_METIS) {
        options->partition = SC_PARTITION_BISECT;
        options->bisect = sc_metis_bisect;
    } else if (partition == BENCH_STRUCTURE) {
        options->partition = SC_PARTITION_ORDER;
        options->order = scene->order;
    }
    const double start = tool_clock();
    const sc_status status = sc_build(&mesh, options, model);
    *milliseconds = tool_clock() - start;
    free(positions);
    return status;
}
