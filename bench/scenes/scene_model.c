/*
 * The models of glmark2 at any resolution; see scene_model.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "scenes/scene_model.h"

#include "mesh_edges.h"
#include "scenes/decimate.h"
#include "scenes/motion.h"
#include "shape.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Turns the mesh upright and fits it into its box, in floats. */
static void stand_up(mesh_file *mesh, int up)
{
    float *positions = mesh_file_floats(mesh);
    double low[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, high[3] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
    for (size_t v = 0; v < mesh->vertex_count; v++) {
        float *p = positions + 3 * v;
        const float y = p[1], z = p[2];
        if (up == 1) {
            p[1] = -z;
            p[2] = y;
        } else if (up == -2) {
            p[1] = -y;
            p[2] = -z;
        }
        for (int k = 0; k < 3; k++) {
            low[k] = fmin(low[k], (double)p[k]);
            high[k] = fmax(high[k], (double)p[k]);
        }
    }
    const double size = fmax(fmax(high[0] - low[0], high[1] - low[1]), high[2] - low[2]);
    const double scale = size > 0.0 ? 2.0 / size : 1.0;
    for (size_t i = 0; i < 3 * (size_t)mesh->vertex_count; i++) {
        const double middle = 0.5 * (low[i % 3] + high[i % 3]);
        positions[i] = (float)(scale * ((double)positions[i] - middle));
    }
}

/* Marks the vertices of edges that have not two triangles. */
static bool mark_borders(const mesh_file *mesh, uint8_t *border)
{
    const size_t count = 3 * (size_t)mesh->triangle_count;
    mesh_side *sides = mesh_edges_sort(mesh);
    if (!sides) return false;
    for (size_t begin = 0; begin < count;) {
        const size_t length = mesh_edges_run(sides, begin, count);
        if (length != 2) border[sides[begin].low] = border[sides[begin].high] = 1;
        begin += length;
    }
    free(sides);
    return true;
}

/*
 * Smooths what cutting in four left in flat pieces: vertices move a part of the way to the mean of
 * their neighbours, then a little more back, which keeps the volume (Taubin, "A signal processing
 * approach to fair surface design", 1995). Borders stay.
 */
static bool smooth_mesh(mesh_file *mesh, int times)
{
    const size_t n = mesh->vertex_count;
    float *positions = mesh_file_floats(mesh);
    uint8_t *border = (uint8_t *)calloc(n, 1);
    double *sums = (double *)malloc(3 * n * sizeof *sums);
    uint32_t *counts = (uint32_t *)malloc(n * sizeof *counts);
    const bool done = border && sums && counts && mark_borders(mesh, border);
    for (int pass = 0; done && pass < 2 * times; pass++) {
        const double part = pass % 2 == 0 ? 0.5 : -0.52;
        memset(sums, 0, 3 * n * sizeof *sums);
        memset(counts, 0, n * sizeof *counts);
        for (size_t c = 0; c < 3 * (size_t)mesh->triangle_count; c++) {
            /* Inside each edge is met twice, once from each end to the other. */
            const size_t v = mesh->indices[c];
            const size_t w = mesh->indices[c - c % 3 + (c + 1) % 3];
            for (size_t k = 0; k < 3; k++) sums[3 * v + k] += (double)positions[3 * w + k];
            counts[v]++;
        }
        for (size_t v = 0; v < n; v++) {
            if (border[v] || counts[v] == 0) continue;
            for (size_t k = 0; k < 3; k++) {
                float *p = &positions[3 * v + k];
                *p = (float)((double)*p + part * (sums[3 * v + k] / counts[v] - (double)*p));
            }
        }
    }
    free(border);
    free(sums);
    free(counts);
    return done;
}

static bool resize(mesh_file *mesh, uint32_t triangles)
{
    int cuts = 0;
    while (triangles > mesh->triangle_count + mesh->triangle_count / 3) {
        triangles = (triangles + 2) / 4;
        cuts++;
    }
    if (triangles < mesh->triangle_count && !decimate_mesh(mesh, triangles)) return false;
    for (int i = 0; i < cuts; i++) {
        if (!shape_subdivide(mesh) || !smooth_mesh(mesh, 3)) return false;
    }
    return true;
}

int scene_model_read(mesh_file *mesh, const char *file, int up, uint32_t triangles, char *error,
                     size_t error_size)
{
    char path[4200], message[MESH_FILE_ERROR_SIZE];
    const char *folder = getenv("SC_MESHES");
    if (!folder || !*folder) folder = "build/meshes";
    memset(mesh, 0, sizeof *mesh);
    if (snprintf(path, sizeof path, "%s/%s", folder, file) >= (int)sizeof path) {
        return scene_fail(error, error_size, "%s: the path is too long", folder);
    }
    FILE *there = fopen(path, "rb");
    if (!there) {
        return scene_fail(error, error_size, "%s is not there: 'make meshes' fetches it", path);
    }
    fclose(there);
    if (!mesh_file_read(mesh, path, message)) {
        return scene_fail(error, error_size, "%s", message);
    }
    stand_up(mesh, up);
    if (!mesh_file_join(mesh) || !resize(mesh, triangles)) {
        mesh_file_free(mesh);
        return scene_fail(error, error_size, "%s: out of memory, or too many triangles", path);
    }
    return 0;
}

void scene_model_normals(const uint32_t *triangles, uint32_t triangle_count,
                         const double *positions, uint32_t vertex_count, double *normals)
{
    memset(normals, 0, 3 * (size_t)vertex_count * sizeof *normals);
    for (size_t t = 0; t < triangle_count; t++) {
        const uint32_t *v = triangles + 3 * t;
        const double *a = positions + 3 * (size_t)v[0], *b = positions + 3 * (size_t)v[1],
                     *c = positions + 3 * (size_t)v[2];
        for (int k = 0; k < 3; k++) {
            const int i = (k + 1) % 3, j = (k + 2) % 3;
            const double n = (b[i] - a[i]) * (c[j] - a[j]) - (b[j] - a[j]) * (c[i] - a[i]);
            for (int m = 0; m < 3; m++) normals[3 * (size_t)v[m] + (size_t)k] += n;
        }
    }
    for (size_t i = 0; i < 3 * (size_t)vertex_count; i += 3) {
        const double length = sqrt(normals[i] * normals[i] + normals[i + 1] * normals[i + 1] +
                                   normals[i + 2] * normals[i + 2]);
        for (size_t k = 0; k < 3 && length > 0.0; k++) normals[i + k] /= length;
    }
}
