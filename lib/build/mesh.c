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
#include "base/atomic.h"
#include "base/jobs.h"

#define MAX_TRIANGLES 0x55555554u
#define MAX_VERTICES 0xfffffff0u

/* Triangles and vertices of the shortest part that is read by itself. */
enum { READ_TRIANGLES_MIN = 5000, READ_VERTICES_MIN = 5000 };

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

/* A mesh that is read in parts. */
typedef struct reading {
    const sc_mesh *mesh;
    const sc_hooks *hooks;
    const sc_tasks *tasks;
    const uint32_t *weld_map; /* NULL: the caller gave none */
    uint64_t position_stride, index_stride;
    sc_points *points;
    uint32_t *representative;       /* of each used vertex */
    uint8_t *used;                  /* whether a vertex is; set by all parts */
    uint32_t wrong[SC_JOBS_PARTS];  /* the first triangle or vertex of a part that is, or SC_NONE */
    uint32_t number[SC_JOBS_PARTS]; /* how many points a part has; then the number of its first */
} reading;

/* The first wrong triangle or vertex, if any: a part ends at its first, and all before it are
   right. */
static uint32_t first_wrong(const reading *r, uint32_t parts)
{
    uint32_t part = 0;
    while (part < parts && r->wrong[part] == SC_NONE) part++;
    return part < parts ? r->wrong[part] : SC_NONE;
}

static void read_some_triangles(void *context, uint32_t part, uint32_t first, uint32_t end)
{
    reading *r = (reading *)context;
    const uint64_t stride = r->index_stride;
    const uint32_t vertex_count = r->mesh->vertex_count, *weld_map = r->weld_map;
    const int is_narrow = r->mesh->index_type == SC_UINT16, is_shared = r->tasks != NULL;
    const unsigned char *at = (const unsigned char *)r->mesh->indices + stride * first;
    uint8_t *used = r->used;
    uint32_t *corners = r->points->triangles + 3 * (uint64_t)first, t;
    int k;
    r->wrong[part] = SC_NONE;
    for (t = first; t < end; t++, at += stride, corners += 3) {
        if (is_narrow) {
            uint16_t narrow[3];
            memcpy(narrow, at, sizeof narrow);
            for (k = 0; k < 3; k++) corners[k] = narrow[k];
        } else {
            memcpy(corners, at, 3 * sizeof(uint32_t));
        }
        for (k = 0; k < 3; k++) {
            uint32_t v = corners[k];
            if (v >= vertex_count) {
                r->wrong[part] = t;
                return;
            }
            sc_atomic_mark(&used[v], is_shared);
            /* what stands for a used vertex is used */
            if (weld_map) sc_atomic_mark(&used[weld_map[v]], is_shared);
        }
    }
}

static sc_status read_triangles(reading *r)
{
    const sc_mesh *mesh = r->mesh;
    const uint32_t parts = sc_jobs_loop(r->tasks, mesh->triangle_count, READ_TRIANGLES_MIN,
                                        read_some_triangles, r),
                   t = first_wrong(r, parts);
    const uint32_t *corner;
    if (t == SC_NONE) return SC_OK;
    corner = r->points->triangles + 3 * (uint64_t)t;
    while (*corner < mesh->vertex_count) corner++;
    sc_hooks_log(r->hooks, SC_LOG_ERROR,
                 "triangle %" PRIu32 " names vertex %" PRIu32 " of %" PRIu32, t, *corner,
                 mesh->vertex_count);
    return SC_ERROR_INDEX;
}

static void read_vertex(const reading *r, uint32_t v, double position[3])
{
    sc_mesh_read_position(r->mesh->positions, r->mesh->position_type, r->position_stride, v,
                          position);
}

static void check_some_vertices(void *context, uint32_t part, uint32_t first, uint32_t end)
{
    reading *r = (reading *)context;
    uint32_t v;
    r->wrong[part] = SC_NONE;
    for (v = first; v < end; v++) {
        double p[3];
        if (!r->used[v]) continue;
        read_vertex(r, v, p);
        if (!(isfinite(p[0]) && isfinite(p[1]) && isfinite(p[2]))) {
            r->wrong[part] = v;
            return;
        }
        r->representative[v] = r->weld_map ? r->weld_map[v] : v;
    }
}

static sc_status check_vertices(reading *r)
{
    const uint32_t parts = sc_jobs_loop(r->tasks, r->mesh->vertex_count, READ_VERTICES_MIN,
                                        check_some_vertices, r),
                   v = first_wrong(r, parts);
    if (v == SC_NONE) return SC_OK;
    sc_hooks_log(r->hooks, SC_LOG_ERROR, "vertex %" PRIu32 " is NaN or infinite", v);
    return SC_ERROR_NOT_FINITE;
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

/* Vertices to be welded are shared out by the lowest bits of their hashes, so that those at one
   position are in one share: a power of two, or without tasks one. */
enum { WELD_SHARES = 8 };

/* What welding by positions works with. */
typedef struct welding {
    const reading *r;
    uint32_t shares;
    uint32_t *hash;                             /* of each used vertex */
    uint32_t *table;                            /* those of the shares, one after the other */
    uint64_t begin[WELD_SHARES + 1];            /* of each share's table */
    uint32_t count[SC_JOBS_PARTS][WELD_SHARES]; /* vertices of each part, by shares */
} welding;

static void hash_some_vertices(void *context, uint32_t part, uint32_t first, uint32_t end)
{
    welding *w = (welding *)context;
    uint32_t v;
    memset(w->count[part], 0, sizeof w->count[part]);
    for (v = first; v < end; v++) {
        double p[3];
        if (!w->r->used[v]) continue;
        read_vertex(w->r, v, p);
        w->hash[v] = (uint32_t)hash_position(p);
        w->count[part][w->hash[v] & (w->shares - 1)]++;
    }
}

static int is_at_same_position(const reading *r, uint32_t v, uint32_t other)
{
    double p[3], q[3];
    read_vertex(r, v, p);
    read_vertex(r, other, q);
    return p[0] == q[0] && p[1] == q[1] && p[2] == q[2];
}

static void weld_share(void *context, uint32_t share, uint32_t worker)
{
    const welding *w = (const welding *)context;
    const reading *r = w->r;
    uint32_t *table = w->table + w->begin[share], v;
    const uint64_t size = w->begin[share + 1] - w->begin[share];
    (void)worker;
    memset(table, 0xff, (size_t)size * sizeof *table);
    for (v = 0; v < r->mesh->vertex_count; v++) {
        uint32_t hash = w->hash[v], other;
        uint64_t at;
        if ((hash & (w->shares - 1)) != share || !r->used[v]) continue;
        for (at = (hash * size) >> 32; (other = table[at]) != SC_NONE;
             at = at + 1 < size ? at + 1 : 0)
            if (w->hash[other] == hash && is_at_same_position(r, v, other)) break;
        if (other == SC_NONE) table[at] = other = v;
        r->representative[v] = other;
    }
}

/* representative[v] for all used vertices: the lowest used vertex at the same position. */
static sc_status weld_rest(reading *r, sc_scratch *scratch)
{
    const uint32_t count = r->mesh->vertex_count;
    uint32_t parts, part, share;
    welding w;
    w.r = r;
    w.shares = r->tasks && count >= READ_VERTICES_MIN ? WELD_SHARES : 1;
    w.hash = (uint32_t *)sc_scratch_take_filled(scratch, count, sizeof *w.hash, 0);
    if (!w.hash) return SC_ERROR_MEMORY;
    parts = sc_jobs_loop(r->tasks, count, READ_VERTICES_MIN, hash_some_vertices, &w);
    for (w.begin[0] = share = 0; share < w.shares; share++) {
        uint64_t members = 0; /* half as many as there are slots */
        for (part = 0; part < parts; part++) members += w.count[part][share];
        w.begin[share + 1] = w.begin[share] + 2 * members + 1;
    }
    w.table = (uint32_t *)sc_scratch_take(scratch, w.begin[w.shares], sizeof *w.table);
    if (!w.table) return SC_ERROR_MEMORY;
    sc_jobs_run(r->tasks, w.shares, weld_share, &w);
    sc_scratch_give(scratch, w.table);
    sc_scratch_give(scratch, w.hash);
    return SC_OK;
}

static int is_point(const reading *r, uint32_t v)
{
    return r->used[v] && r->representative[v] == v;
}

static void count_representatives(void *context, uint32_t part, uint32_t first, uint32_t end)
{
    reading *r = (reading *)context;
    uint32_t v, count = 0;
    for (v = first; v < end; v++) count += (uint32_t)is_point(r, v);
    r->number[part] = count;
}

static void number_representatives(void *context, uint32_t part, uint32_t first, uint32_t end)
{
    const reading *r = (const reading *)context;
    uint32_t v, next = r->number[part];
    for (v = first; v < end; v++)
        r->points->slot[v] = !r->used[v]                 ? SC_SLOT_UNUSED
                             : r->representative[v] != v ? SC_SLOT_WELDED
                                                         : next++;
}

static void name_points(void *context, uint32_t part, uint32_t first, uint32_t end)
{
    const reading *r = (const reading *)context;
    uint32_t *corner = r->points->triangles + 3 * (uint64_t)first, t;
    int k;
    (void)part;
    for (t = first; t < end; t++, corner += 3) {
        for (k = 0; k < 3; k++) corner[k] = r->points->slot[r->representative[corner[k]]];
        r->points->id[t] = t;
    }
}

static void copy_rest_pose(void *context, uint32_t part, uint32_t first, uint32_t end)
{
    const reading *r = (const reading *)context;
    uint32_t v;
    (void)part;
    for (v = first; v < end; v++)
        if (r->points->slot[v] < SC_SLOT_WELDED)
            read_vertex(r, v, r->points->rest + 3 * (uint64_t)r->points->slot[v]);
}

/* Numbers points in the order of their vertices, and names them in triangles. */
static sc_status make_points(reading *r, sc_scratch *scratch)
{
    sc_points *points = r->points;
    uint32_t parts, part;
    parts =
        sc_jobs_loop(r->tasks, points->vertex_count, READ_VERTICES_MIN, count_representatives, r);
    for (points->point_count = part = 0; part < parts; part++) {
        uint32_t count = r->number[part];
        r->number[part] = points->point_count;
        points->point_count += count;
    }
    points->rest =
        (double *)sc_scratch_take(scratch, 3 * (uint64_t)points->point_count, sizeof(double));
    if (!points->rest) return SC_ERROR_MEMORY;
    sc_jobs_loop(r->tasks, points->vertex_count, READ_VERTICES_MIN, number_representatives, r);
    sc_jobs_loop(r->tasks, points->triangle_count, READ_TRIANGLES_MIN, name_points, r);
    sc_jobs_loop(r->tasks, points->vertex_count, READ_VERTICES_MIN, copy_rest_pose, r);
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
    reading r;
    sc_status status;

    status = check_mesh(mesh, options->hooks, &r.position_stride, &r.index_stride);
    if (!status && options->weld == SC_WELD_MAP)
        status = check_weld_map(options, mesh->vertex_count);
    if (status) return status;

    points->vertex_count = mesh->vertex_count;
    points->triangle_count = mesh->triangle_count;
    points->triangles =
        (uint32_t *)sc_scratch_take(scratch, 3 * (uint64_t)mesh->triangle_count, sizeof(uint32_t));
    points->id = (uint32_t *)sc_scratch_take(scratch, mesh->triangle_count, sizeof(uint32_t));
    points->slot = (uint32_t *)sc_scratch_take(scratch, mesh->vertex_count, sizeof(uint32_t));
    r.mesh = mesh;
    r.hooks = options->hooks;
    r.tasks = scratch->tasks;
    r.weld_map = options->weld == SC_WELD_MAP ? options->weld_map : NULL;
    r.points = points;
    r.representative = (uint32_t *)sc_scratch_take(scratch, mesh->vertex_count, sizeof(uint32_t));
    r.used = (uint8_t *)sc_scratch_take_filled(scratch, mesh->vertex_count, 1, 0);
    if (!points->triangles || !points->id || !points->slot || !r.representative || !r.used)
        return SC_ERROR_MEMORY;
    status = read_triangles(&r);
    if (!status) status = check_vertices(&r);
    if (!status && options->weld == SC_WELD_REST) status = weld_rest(&r, scratch);
    if (!status) status = make_points(&r, scratch);
    if (status) return status;
    sc_scratch_give(scratch, r.representative);
    sc_scratch_give(scratch, r.used);
    return SC_OK;
}
