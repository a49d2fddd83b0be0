/*
 * Generated meshes; see shape.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "shape.h"

#include "mesh_edges.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void set_triangle(mesh_file *mesh, uint32_t triangle, uint32_t a, uint32_t b, uint32_t c)
{
    uint32_t *out = mesh->indices + 3 * (size_t)triangle;
    out[0] = a;
    out[1] = b;
    out[2] = c;
}

bool shape_make_grid(mesh_file *mesh, uint32_t cells)
{
    memset(mesh, 0, sizeof *mesh);
    if (cells == 0 || cells > 20000) return false;
    const uint32_t side = cells + 1;
    if (!mesh_file_allocate(mesh, side * side, 2 * cells * cells)) return false;
    for (uint32_t row = 0; row < side; row++) {
        for (uint32_t column = 0; column < side; column++) {
            float *out = (float *)mesh->positions + 3 * ((size_t)row * side + column);
            out[0] = (float)(2.0 * column / cells - 1.0);
            out[1] = (float)(2.0 * row / cells - 1.0);
            out[2] = 0.0f;
        }
    }
    uint32_t triangle = 0;
    for (uint32_t row = 0; row < cells; row++) {
        for (uint32_t column = 0; column < cells; column++) {
            const uint32_t a = row * side + column, b = a + 1, c = b + side, d = a + side;
            if ((row + column) % 2 == 0) {
                set_triangle(mesh, triangle++, a, b, c);
                set_triangle(mesh, triangle++, a, c, d);
            } else {
                set_triangle(mesh, triangle++, a, b, d);
                set_triangle(mesh, triangle++, b, c, d);
            }
        }
    }
    return true;
}

static void normalize_positions(mesh_file *mesh)
{
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        float *p = (float *)mesh->positions + 3 * (size_t)v;
        const double x = (double)p[0], y = (double)p[1], z = (double)p[2];
        const double length = sqrt(x * x + y * y + z * z);
        p[0] = (float)(x / length);
        p[1] = (float)(y / length);
        p[2] = (float)(z / length);
    }
}

bool shape_make_sphere(mesh_file *mesh, uint32_t level)
{
    /* The corners of an icosahedron are those of three golden rectangles. */
    static const float golden = 1.618034f;
    static const uint32_t faces[20][3] = {
        {0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
        {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
        {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
    memset(mesh, 0, sizeof *mesh);
    if (level > 11 || !mesh_file_allocate(mesh, 12, 20)) return false;
    for (int v = 0; v < 12; v++) {
        const int plane = v / 4;
        float *p = (float *)mesh->positions + 3 * v;
        p[plane] = v & 1 ? 1.0f : -1.0f;
        p[(plane + 1) % 3] = v & 2 ? -golden : golden;
        p[(plane + 2) % 3] = 0.0f;
    }
    for (uint32_t t = 0; t < 20; t++) set_triangle(mesh, t, faces[t][0], faces[t][1], faces[t][2]);
    normalize_positions(mesh);
    for (uint32_t i = 0; i < level; i++) {
        if (!shape_subdivide(mesh)) {
            mesh_file_free(mesh);
            return false;
        }
        normalize_positions(mesh);
    }
    return true;
}

/* Numbers the edges: middle[c] becomes first + the edge of side c. Returns the number of edges. */
static uint32_t number_edges(const mesh_side *sides, size_t count, uint32_t first, uint32_t *middle)
{
    uint32_t edges = 0;
    for (size_t begin = 0; begin < count; edges++) {
        const size_t end = begin + mesh_edges_run(sides, begin, count);
        for (; begin < end; begin++) middle[sides[begin].corner] = first + edges;
    }
    return edges;
}

bool shape_subdivide(mesh_file *mesh)
{
    if (mesh->triangle_count > UINT32_MAX / 12) return false;
    const size_t side_count = 3 * (size_t)mesh->triangle_count;
    mesh_side *sides = mesh_edges_sort(mesh);
    uint32_t *middle = (uint32_t *)malloc(side_count * sizeof *middle);
    mesh_file fine;
    memset(&fine, 0, sizeof fine);
    bool done = false;
    if (sides && middle) {
        const uint32_t edges = number_edges(sides, side_count, mesh->vertex_count, middle);
        done = edges <= UINT32_MAX - mesh->vertex_count &&
               mesh_file_allocate(&fine, mesh->vertex_count + edges, 4 * mesh->triangle_count);
    }
    if (done) {
        const float *from = mesh_file_floats(mesh);
        float *to = (float *)fine.positions;
        memcpy(to, from, 3 * (size_t)mesh->vertex_count * sizeof(float));
        for (size_t c = 0; c < side_count; c++) {
            const float *low = from + 3 * (size_t)sides[c].low;
            const float *high = from + 3 * (size_t)sides[c].high;
            float *out = to + 3 * (size_t)middle[sides[c].corner];
            for (int k = 0; k < 3; k++) out[k] = (float)(((double)low[k] + (double)high[k]) / 2.0);
        }
        for (uint32_t t = 0; t < mesh->triangle_count; t++) {
            const uint32_t *v = mesh->indices + 3 * (size_t)t, *m = middle + 3 * (size_t)t;
            set_triangle(&fine, 4 * t, v[0], m[0], m[2]);
            set_triangle(&fine, 4 * t + 1, v[1], m[1], m[0]);
            set_triangle(&fine, 4 * t + 2, v[2], m[2], m[1]);
            set_triangle(&fine, 4 * t + 3, m[0], m[1], m[2]);
        }
        mesh_file_free(mesh);
        *mesh = fine;
    }
    free(sides);
    free(middle);
    return done;
}
