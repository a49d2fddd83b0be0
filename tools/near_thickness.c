/*
 * The thickness of faces, from near pairs; see near_thickness.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "near_thickness.h"

#include <math.h>
#include <stdlib.h>

/* Of how many pairs distances are found at a time. */
enum { SOME = 1024 };

/* Whether it is known which vertices are joined: a saved model that is not sc-partition's does not
   say it. */
static bool knows_welds(const near_answer *answer)
{
    const mesh_file *mesh = answer->mesh;
    uint32_t used = 0;
    if (answer->weld_map) return true;
    bool *seen = (bool *)calloc((size_t)mesh->vertex_count + 1, sizeof *seen);
    if (!seen) return false;
    for (size_t c = 0; c < 3 * (size_t)mesh->triangle_count; c++) {
        used += !seen[mesh->indices[c]];
        seen[mesh->indices[c]] = true;
    }
    free(seen);
    return used == answer->info.point_count;
}

/* Adds pairs, SOME at most, that count. */
static sc_status add_some(const near_answer *answer, thickness *all, uint32_t kind,
                          const sc_pair *pairs, uint64_t count, sc_near_stencil *stencils)
{
    const sc_status status =
        sc_near_stencils(answer->model, answer->pose, kind, pairs, count, stencils);
    for (uint64_t i = 0; status == SC_OK && i < count; i++)
        thickness_add(all, kind, pairs[i], stencils[i].distance);
    return status;
}

/* Adds all pairs that count. Most of what is near does not, so it is looked at first which do, and
   distances are found of those alone. */
static sc_status add_pairs(const near_answer *answer, thickness *all)
{
    static const uint32_t kinds[KINDS] = {SC_NEAR_VERTEX_FACE, SC_NEAR_EDGE_EDGE};
    sc_pair some[SOME];
    sc_near_stencil *stencils = (sc_near_stencil *)malloc(SOME * sizeof *stencils);
    sc_status status = stencils ? SC_OK : SC_ERROR_MEMORY;
    for (int kind = 0; kind < KINDS; kind++) {
        uint64_t count = 0;
        for (uint64_t i = 0; status == SC_OK && i < answer->counts[kind]; i++) {
            if (!thickness_counts(all, kinds[kind], answer->pairs[kind][i])) continue;
            some[count++] = answer->pairs[kind][i];
            if (count < SOME) continue;
            status = add_some(answer, all, kinds[kind], some, count, stencils);
            count = 0;
        }
        if (status == SC_OK) status = add_some(answer, all, kinds[kind], some, count, stencils);
    }
    free(stencils);
    return status;
}

bool near_thickness_find(near_answer *answer, double distance, char error[MESH_FILE_ERROR_SIZE])
{
    const mesh_file *mesh = answer->mesh;
    const thickness_mesh shape = {mesh->indices,           mesh->triangle_count,
                                  mesh->vertex_count,      answer->weld_map,
                                  answer->pose->positions, answer->pose->position_type};
    if (!knows_welds(answer)) {
        snprintf(
            error, MESH_FILE_ERROR_SIZE,
            "%s: the model does not say which vertices are joined; sc-partition writes one that "
            "does, for --thickness",
            answer->path);
        return false;
    }
    thickness *all = thickness_new(&shape, distance);
    answer->thickness =
        (double *)malloc(((size_t)mesh->face_count + 1) * sizeof *answer->thickness);
    sc_status status = all && answer->thickness ? SC_OK : SC_ERROR_MEMORY;
    if (status == SC_OK) status = add_pairs(answer, all);
    if (status == SC_OK) {
        for (uint32_t i = 0; i < mesh->face_count; i++) answer->thickness[i] = HUGE_VAL;
        for (uint32_t t = 0; t < mesh->triangle_count; t++) {
            double *of_face = &answer->thickness[mesh_face_of(mesh, t)];
            const double value = thickness_of_triangles(all)[t];
            *of_face = value < *of_face ? value : *of_face;
        }
        if (!thickness_find_spread(answer->thickness, mesh->face_count, distance, &answer->spread))
            status = SC_ERROR_MEMORY;
    }
    thickness_free(all);
    if (status != SC_OK)
        snprintf(error, MESH_FILE_ERROR_SIZE, "%s: %s", answer->path, tool_why(status));
    return status == SC_OK;
}
