/*
 * Reading, checking and welding the caller's mesh. See mesh.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "build/mesh.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

#include "base/arguments.h"
#include "base/assume.h"

#define MAX_TRIANGLES 0x55555554u
#define MAX_VERTICES 0xfffffff0u

void sc_mesh_read_position(const void *positions, uint32_t type, uint64_t stride, uint64_t e,
                           double position[3])
{
    const unsigned char *at = (const unsigned char *)positions + stride * e;
    if (type == SC_DOUBLE) {
        memcpy(position, at, 3 * sizeof(double));
    } else {
        float f[3];
        memcpy(f, at, sizeof f);
        position[0] = (double)f[0];
        position[1] = (double)f[1];
        position[2] = (double)f[2];
    }
}

sc_status sc_mesh_position_stride(const sc_hooks *hooks, const char *of, uint32_t type,
                                  uint32_t given, uint64_t *stride)
{
    const sc_choice choice = {"position_type", type, SC_DOUBLE};
    sc_status status = sc_arguments_choose(hooks, of, &choice, 1);
    if (status) return status;
    return sc_arguments_stride(hooks, of, "position_stride", given,
                               3 * (type == SC_DOUBLE ? sizeof(double) : sizeof(float)), stride);
}

static sc_status read_index_stride(const sc_hooks *hooks, const sc_mesh *mesh, uint64_t *stride)
{
    const sc_choice choice = {"index_type", mesh->index_type, SC_UINT16};
    const int narrow = mesh->index_type == SC_UINT16;
    sc_status status = sc_arguments_choose(hooks, "mesh", &choice, 1);
    if (status) return status;
    return sc_arguments_stride(hooks, "mesh", "index_stride", mesh->index_stride,
                               3 * (narrow ? sizeof(uint16_t) : sizeof(uint32_t)), stride);
}

static sc_status read_triangles(const sc_mesh *mesh, uint64_t stride, const sc_hooks *hooks,
                                uint32_t *triangles)
{
    const unsigned char *at = (const unsigned char *)mesh->indices;
    uint32_t t;
    int k;
    for (t = 0; t < mesh->triangle_count; t++, at += stride, triangles += 3) {
        if (mesh->index_type == SC_UINT16) {
            uint16_t narrow[3];
            memcpy(narrow, at, sizeof narrow);
            for (k = 0; k < 3; k++) triangles[k] = narrow[k];
        } else {
            memcpy(triangles, at, 3 * sizeof(uint32_t));
        }
        for (k = 0; k < 3; k++)
            if (triangles[k] >= mesh->vertex_count) {
                sc_hooks_log(hooks, SC_LOG_ERROR,
                             "triangle %" PRIu32 " names vertex %" PRIu32 " of %" PRIu32, t,
                             triangles[k], mesh->vertex_count);
                return SC_ERROR_INDEX;
            }
    }
    return SC_OK;
}

static uint64_t hash_position(const double position[3])
{
    uint64_t hash = 0x9e3779b97f4a7c15u, bits;
    int k;
    for (k = 0; k < 3; k++) {
        double x = position[k] == 0 ? 0 : position[k]; /* -0 equals 0 */
        memcpy(&bits, &x, sizeof bits);
        hash = (hash ^ bits) * 0xff51afd7ed558ccdu;
        hash ^= hash >> 32;
    }
    return hash;
}

/* representative[v] for all used vertices: the lowest used vertex at the same position. */
static sc_status weld_rest(const sc_mesh *mesh, uint64_t stride, const uint8_t *used,
                           sc_scratch *scratch, uint32_t *representative)
{
    uint64_t size = 16, at;
    uint32_t *table, v;
    while (size < 2 * (uint64_t)mesh->vertex_count) size *= 2;
    table = (uint32_t *)sc_scratch_take_filled(scratch, size, sizeof *table, 0xff);
    if (!table) return SC_ERROR_MEMORY;
    for (v = 0; v < mesh->vertex_count; v++) {
        double p[3], q[3];
        if (!used[v]) continue;
        sc_mesh_read_position(mesh->positions, mesh->position_type, stride, v, p);
        for (at = hash_position(p) & (size - 1);; at = (at + 1) & (size - 1)) {
            if (table[at] == SC_NONE) {
                table[at] = representative[v] = v;
                break;
            }
            sc_mesh_read_position(mesh->positions, mesh->position_type, stride, table[at], q);
            if (p[0] == q[0] && p[1] == q[1] && p[2] == q[2]) {
                representative[v] = table[at];
                break;
            }
        }
    }
    sc_scratch_give(scratch, table);
    return SC_OK;
}

static sc_status check_weld_map(const sc_build_options *options, uint32_t count)
{
    const uint32_t *map = options->weld_map;
    uint32_t v;
    sc_status status = sc_arguments_need(options->hooks, "options", "weld_map", map);
    if (status) return status;
    for (v = 0; v < count; v++)
        if (map[v] >= count || map[map[v]] != map[v]) {
            sc_hooks_log(options->hooks, SC_LOG_ERROR,
                         "options.weld_map[%" PRIu32 "] is %" PRIu32 ", which %s", v, map[v],
                         map[v] >= count ? "is no vertex" : "does not represent itself");
            return SC_ERROR_WELD_MAP;
        }
    return SC_OK;
}

/* All that can be wrong but what is in the arrays. */
static sc_status check_mesh(const sc_mesh *mesh, const sc_hooks *hooks, uint64_t *position_stride,
                            uint64_t *index_stride)
{
    const sc_choice reserved = {"reserved", mesh->reserved, 0};
    sc_status status = sc_arguments_choose(hooks, "mesh", &reserved, 1);
    if (status) return status;
    if (!mesh->vertex_count || !mesh->triangle_count) return SC_ERROR_EMPTY;
    if (mesh->vertex_count > MAX_VERTICES || mesh->triangle_count > MAX_TRIANGLES)
        return SC_ERROR_COUNT;
    status = sc_arguments_need(hooks, "mesh", "positions", mesh->positions);
    if (!status) status = sc_arguments_need(hooks, "mesh", "indices", mesh->indices);
    if (!status)
        status = sc_mesh_position_stride(hooks, "mesh", mesh->position_type, mesh->position_stride,
                                         position_stride);
    if (!status) status = read_index_stride(hooks, mesh, index_stride);
    if (status) return status;
    /* where addresses have 32 bits: */
    return SC_HARDLY(*position_stride > SIZE_MAX / mesh->vertex_count ||
                     *index_stride > SIZE_MAX / mesh->triangle_count)
               ? SC_ERROR_COUNT
               : SC_OK;
}

sc_status sc_mesh_read(const sc_mesh *mesh, const sc_build_options *options, sc_scratch *scratch,
                       sc_points *points)
{
    uint64_t position_stride, index_stride, h, corners;
    uint32_t *representative, v, t;
    uint8_t *used;
    sc_status status;

    status = check_mesh(mesh, options->hooks, &position_stride, &index_stride);
    if (!status && options->weld == SC_WELD_MAP)
        status = check_weld_map(options, mesh->vertex_count);
    if (status) return status;

    corners = 3 * (uint64_t)mesh->triangle_count;
    points->vertex_count = mesh->vertex_count;
    points->triangle_count = mesh->triangle_count;
    points->triangles = (uint32_t *)sc_scratch_take(scratch, corners, sizeof(uint32_t));
    points->id = (uint32_t *)sc_scratch_take(scratch, mesh->triangle_count, sizeof(uint32_t));
    points->slot = (uint32_t *)sc_scratch_take(scratch, mesh->vertex_count, sizeof(uint32_t));
    representative = (uint32_t *)sc_scratch_take(scratch, mesh->vertex_count, sizeof(uint32_t));
    used = (uint8_t *)sc_scratch_take_filled(scratch, mesh->vertex_count, 1, 0);
    if (!points->triangles || !points->id || !points->slot || !representative || !used)
        return SC_ERROR_MEMORY;
    status = read_triangles(mesh, index_stride, options->hooks, points->triangles);
    if (status) return status;

    for (h = 0; h < corners; h++) used[points->triangles[h]] = 1;
    if (options->weld == SC_WELD_MAP) /* what stands for a used vertex is used */
        for (h = 0; h < corners; h++) used[options->weld_map[points->triangles[h]]] = 1;
    for (v = 0; v < mesh->vertex_count; v++) {
        double p[3];
        if (!used[v]) continue;
        sc_mesh_read_position(mesh->positions, mesh->position_type, position_stride, v, p);
        if (!(isfinite(p[0]) && isfinite(p[1]) && isfinite(p[2]))) {
            sc_hooks_log(options->hooks, SC_LOG_ERROR, "vertex %" PRIu32 " is NaN or infinite", v);
            return SC_ERROR_NOT_FINITE;
        }
        representative[v] = options->weld == SC_WELD_MAP ? options->weld_map[v] : v;
    }
    if (options->weld == SC_WELD_REST) {
        status = weld_rest(mesh, position_stride, used, scratch, representative);
        if (status) return status;
    }

    points->point_count = 0;
    for (v = 0; v < mesh->vertex_count; v++)
        points->slot[v] = !used[v]                 ? SC_SLOT_UNUSED
                          : representative[v] != v ? SC_SLOT_WELDED
                                                   : points->point_count++;
    for (h = 0; h < corners; h++)
        points->triangles[h] = points->slot[representative[points->triangles[h]]];
    points->rest =
        (double *)sc_scratch_take(scratch, 3 * (uint64_t)points->point_count, sizeof(double));
    if (!points->rest) return SC_ERROR_MEMORY;
    for (v = 0; v < mesh->vertex_count; v++)
        if (points->slot[v] < SC_SLOT_WELDED)
            sc_mesh_read_position(mesh->positions, mesh->position_type, position_stride, v,
                                  points->rest + 3 * (uint64_t)points->slot[v]);
    for (t = 0; t < mesh->triangle_count; t++) points->id[t] = t;
    sc_scratch_give(scratch, representative);
    sc_scratch_give(scratch, used);
    return SC_OK;
}
