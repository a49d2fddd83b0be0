/*
 * The physical floor; see floor.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "floor.h"

#include "tool.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#if defined(__SSE2__)
#  include <emmintrin.h>
#endif

/* A group is four clusters of eight triangles; lane l of every array belongs to cluster l. */
enum { LANES = 4, CLUSTER = 8, GROUP = LANES * CLUSTER };

/* Where the points of three corners begin, of one triangle in each cluster. */
typedef struct floor_corners {
    uint32_t at[3][LANES];
} floor_corners;

/* What a group is reduced to. */
typedef struct floor_bounds {
    float low[3][LANES], high[3][LANES];
    float normal_low[3][LANES], normal_high[3][LANES];
} floor_bounds;

struct floor_pass {
    size_t group_count;
    uint32_t vertex_count;
    float *points;          /* 4 * vertex_count: x, y, z, unused */
    floor_corners *corners; /* group_count * CLUSTER */
    floor_bounds *bounds;   /* group_count */
    bool single;
};

/* Four floats: SSE2 is part of every x86-64; elsewhere it is left to the compiler. */
#if defined(__SSE2__)
typedef __m128 quad;

static inline quad quad_all(float x)
{
    return _mm_set1_ps(x);
}

static inline quad quad_load(const float *from)
{
    return _mm_loadu_ps(from);
}

static inline void quad_store(float *to, quad a)
{
    _mm_storeu_ps(to, a);
}

static inline quad quad_min(quad a, quad b)
{
    return _mm_min_ps(a, b);
}

static inline quad quad_max(quad a, quad b)
{
    return _mm_max_ps(a, b);
}

static inline quad quad_subtract(quad a, quad b)
{
    return _mm_sub_ps(a, b);
}

static inline quad quad_multiply(quad a, quad b)
{
    return _mm_mul_ps(a, b);
}

/* Rows to columns. */
static inline void quad_transpose(quad rows[4])
{
    _MM_TRANSPOSE4_PS(rows[0], rows[1], rows[2], rows[3]);
}
#else
typedef struct quad {
    float at[4];
} quad;

/* An operation on each of four pairs. */
#  define QUAD_EACH(expression)                                                                    \
    quad r;                                                                                        \
    for (int i = 0; i < 4; i++) r.at[i] = (expression);                                            \
    return r

static inline quad quad_all(float x)
{
    QUAD_EACH(x);
}

static inline quad quad_load(const float *from)
{
    QUAD_EACH(from[i]);
}

static inline void quad_store(float *to, quad a)
{
    memcpy(to, a.at, sizeof a.at);
}

static inline quad quad_min(quad a, quad b)
{
    QUAD_EACH(a.at[i] < b.at[i] ? a.at[i] : b.at[i]);
}

static inline quad quad_max(quad a, quad b)
{
    QUAD_EACH(a.at[i] > b.at[i] ? a.at[i] : b.at[i]);
}

static inline quad quad_subtract(quad a, quad b)
{
    QUAD_EACH(a.at[i] - b.at[i]);
}

static inline quad quad_multiply(quad a, quad b)
{
    QUAD_EACH(a.at[i] * b.at[i]);
}

static inline void quad_transpose(quad rows[4])
{
    quad columns[4];
    for (int i = 0; i < 4; i++) {
        for (int j = 0; j < 4; j++) columns[i].at[j] = rows[j].at[i];
    }
    memcpy(rows, columns, sizeof columns);
}
#endif

/* Positions as points of four floats. */
static void read_positions(floor_pass *pass, const void *positions)
{
    float *out = pass->points;
    if (pass->single) {
        const float *in = (const float *)positions;
        for (size_t v = 0; v < pass->vertex_count; v++, in += 3, out += 4) {
            out[0] = in[0];
            out[1] = in[1];
            out[2] = in[2];
        }
    } else {
        const double *in = (const double *)positions;
        for (size_t v = 0; v < pass->vertex_count; v++, in += 3, out += 4) {
            out[0] = (float)in[0];
            out[1] = (float)in[1];
            out[2] = (float)in[2];
        }
    }
}

/* Boxes, and ranges of normals (not of unit length), of the four clusters of a group. */
static inline void reduce_group(const float *points, const floor_corners *corners,
                                floor_bounds *bounds)
{
    quad low[3], high[3], normal_low[3], normal_high[3];
    for (int k = 0; k < 3; k++) {
        low[k] = normal_low[k] = quad_all(INFINITY);
        high[k] = normal_high[k] = quad_all(-INFINITY);
    }
    for (int t = 0; t < CLUSTER; t++) {
        quad p[3][4];
        for (int v = 0; v < 3; v++) {
            for (int l = 0; l < LANES; l++) p[v][l] = quad_load(points + corners[t].at[v][l]);
            quad_transpose(p[v]);
        }
        for (int k = 0; k < 3; k++) {
            low[k] = quad_min(low[k], quad_min(p[0][k], quad_min(p[1][k], p[2][k])));
            high[k] = quad_max(high[k], quad_max(p[0][k], quad_max(p[1][k], p[2][k])));
            p[1][k] = quad_subtract(p[1][k], p[0][k]);
            p[2][k] = quad_subtract(p[2][k], p[0][k]);
        }
        for (int k = 0; k < 3; k++) {
            const int i = (k + 1) % 3, j = (k + 2) % 3;
            const quad n =
                quad_subtract(quad_multiply(p[1][i], p[2][j]), quad_multiply(p[1][j], p[2][i]));
            normal_low[k] = quad_min(normal_low[k], n);
            normal_high[k] = quad_max(normal_high[k], n);
        }
    }
    for (int k = 0; k < 3; k++) {
        quad_store(bounds->low[k], low[k]);
        quad_store(bounds->high[k], high[k]);
        quad_store(bounds->normal_low[k], normal_low[k]);
        quad_store(bounds->normal_high[k], normal_high[k]);
    }
}

typedef struct placed_triangle {
    uint32_t patch, triangle;
} placed_triangle;

static int compare_places(const void *left, const void *right)
{
    const placed_triangle *a = (const placed_triangle *)left;
    const placed_triangle *b = (const placed_triangle *)right;
    if (a->patch != b->patch) return a->patch < b->patch ? -1 : 1;
    return a->triangle < b->triangle ? -1 : a->triangle > b->triangle;
}

/* The triangles patch by patch, so that neighbours stand together. False: no memory. */
static bool place_triangles(const method_mesh *mesh, placed_triangle *places)
{
    sc_model_info info;
    memset(&info, 0, sizeof info);
    info.struct_size = sizeof info;
    uint32_t *patches = (uint32_t *)malloc(mesh->triangle_count * sizeof *patches);
    const bool done = patches && sc_model_get_info(mesh->model, &info) == SC_OK &&
                      sc_model_get_patches(mesh->model, info.level_count - 1, patches,
                                           mesh->triangle_count) == SC_OK;
    for (uint32_t t = 0; done && t < mesh->triangle_count; t++) {
        places[t].patch = patches[t];
        places[t].triangle = t;
    }
    if (done) qsort(places, mesh->triangle_count, sizeof *places, compare_places);
    free(patches);
    return done;
}

floor_pass *floor_create(const method_mesh *mesh)
{
    floor_pass *pass = (floor_pass *)calloc(1, sizeof *pass);
    placed_triangle *places = (placed_triangle *)malloc(mesh->triangle_count * sizeof *places);
    if (pass) {
        pass->single = mesh->position_type == SC_FLOAT;
        pass->vertex_count = mesh->vertex_count;
        pass->points = (float *)calloc(4 * (size_t)mesh->vertex_count, sizeof(float));
        pass->group_count = ((size_t)mesh->triangle_count + GROUP - 1) / GROUP;
        pass->corners =
            (floor_corners *)malloc(pass->group_count * CLUSTER * sizeof(floor_corners));
        pass->bounds = (floor_bounds *)malloc(pass->group_count * sizeof(floor_bounds));
    }
    if (!pass || !places || !pass->points || !pass->corners || !pass->bounds ||
        !place_triangles(mesh, places)) {
        free(places);
        floor_free(pass);
        return NULL;
    }
    for (size_t i = 0; i < pass->group_count * GROUP; i++) {
        /* What is missing in the last group is the last triangle again. */
        const size_t last = mesh->triangle_count - 1;
        const uint32_t *vertices =
            mesh->triangles + 3 * (size_t)places[i < last ? i : last].triangle;
        floor_corners *corners = &pass->corners[i / GROUP * CLUSTER + i % CLUSTER];
        for (int v = 0; v < 3; v++) corners->at[v][i % GROUP / CLUSTER] = 4 * vertices[v];
    }
    free(places);
    return pass;
}

void floor_free(floor_pass *pass)
{
    if (!pass) return;
    free(pass->points);
    free(pass->corners);
    free(pass->bounds);
    free(pass);
}

double floor_run(floor_pass *pass, const void *positions)
{
    const double start = tool_clock();
    read_positions(pass, positions);
    for (size_t g = 0; g < pass->group_count; g++)
        reduce_group(pass->points, &pass->corners[g * CLUSTER], &pass->bounds[g]);
    return tool_clock() - start;
}

void floor_result(const floor_pass *pass, float box[6], float normals[6])
{
    for (int k = 0; k < 3; k++) {
        box[k] = normals[k] = INFINITY;
        box[3 + k] = normals[3 + k] = -INFINITY;
        for (size_t g = 0; g < pass->group_count; g++) {
            const floor_bounds *b = &pass->bounds[g];
            for (int l = 0; l < LANES; l++) {
                box[k] = fminf(box[k], b->low[k][l]);
                box[3 + k] = fmaxf(box[3 + k], b->high[k][l]);
                normals[k] = fminf(normals[k], b->normal_low[k][l]);
                normals[3 + k] = fmaxf(normals[3 + k], b->normal_high[k][l]);
            }
        }
    }
}
