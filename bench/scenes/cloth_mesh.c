/*
 * Square cloth; see cloth_mesh.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "scenes/cloth_mesh.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

cloth_mesh cloth_mesh_choose(uint32_t triangles, uint32_t crossed)
{
    const double cells = sqrt((double)triangles / (crossed ? 4.0 : 2.0));
    cloth_mesh mesh;
    mesh.cells = cells < 2.0 ? 2 : (uint32_t)(cells + 0.5);
    mesh.crossed = crossed;
    return mesh;
}

static uint32_t corner_of(const cloth_mesh *mesh, uint32_t row, uint32_t column)
{
    return row * (mesh->cells + 1) + column;
}

static void put_triangle(uint32_t *out, uint32_t a, uint32_t b, uint32_t c)
{
    out[0] = a;
    out[1] = b;
    out[2] = c;
}

/* The triangles of a cell, two or four of them. */
static void fill_cell(const cloth_mesh *mesh, uint32_t row, uint32_t column, uint32_t *out)
{
    const uint32_t a = corner_of(mesh, row, column), b = a + 1;
    const uint32_t d = corner_of(mesh, row + 1, column), c = d + 1;
    if (mesh->crossed) {
        const uint32_t m = (mesh->cells + 1) * (mesh->cells + 1) + row * mesh->cells + column;
        put_triangle(out, a, b, m);
        put_triangle(out + 3, b, c, m);
        put_triangle(out + 6, c, d, m);
        put_triangle(out + 9, d, a, m);
    } else if ((row + column) % 2 == 0) {
        put_triangle(out, a, b, c);
        put_triangle(out + 3, a, c, d);
    } else {
        put_triangle(out, a, b, d);
        put_triangle(out + 3, b, c, d);
    }
}

/*
 * The place of a cell on Hilbert's curve through a square of side cells, a power of two. Any part
 * of the curve is a compact patch, so it does not matter where an order along it is cut.
 */
static uint64_t curve_place(uint32_t side, uint32_t x, uint32_t y)
{
    uint64_t place = 0;
    for (uint32_t half = side / 2; half > 0; half /= 2) {
        const uint32_t right = x & half ? 1 : 0, up = y & half ? 1 : 0;
        place += (uint64_t)half * half * ((3 * right) ^ up);
        /* Within a quarter the curve is turned, so that it begins where the last one ended. */
        x &= half - 1;
        y &= half - 1;
        if (up == 0) {
            if (right) {
                x = half - 1 - x;
                y = half - 1 - y;
            }
            const uint32_t swap = x;
            x = y;
            y = swap;
        }
    }
    return place;
}

typedef struct placed_cell {
    uint64_t place;
    uint32_t cell;
} placed_cell;

static int compare_places(const void *a, const void *b)
{
    const placed_cell *first = (const placed_cell *)a, *second = (const placed_cell *)b;
    return first->place < second->place ? -1 : first->place > second->place;
}

static int fill_order(const cloth_mesh *mesh, uint32_t *order)
{
    const uint32_t count = mesh->cells * mesh->cells, each = mesh->crossed ? 4 : 2;
    placed_cell *placed = (placed_cell *)malloc(count * sizeof *placed);
    if (!placed) return -1;
    uint32_t side = 1;
    while (side < mesh->cells) side *= 2;
    for (uint32_t i = 0; i < count; i++) {
        placed[i].place = curve_place(side, i % mesh->cells, i / mesh->cells);
        placed[i].cell = i;
    }
    qsort(placed, count, sizeof *placed, compare_places);
    for (uint32_t i = 0; i < count; i++) {
        for (uint32_t k = 0; k < each; k++) order[each * i + k] = each * placed[i].cell + k;
    }
    free(placed);
    return 0;
}

int cloth_mesh_fill(const cloth_mesh *mesh, scene_motion *motion, char *error, size_t error_size)
{
    const uint32_t n = mesh->cells, each = mesh->crossed ? 4 : 2;
    motion->vertex_count = (n + 1) * (n + 1) + (mesh->crossed ? n * n : 0);
    motion->triangle_count = each * n * n;
    motion->triangles = (uint32_t *)malloc(3 * (size_t)motion->triangle_count * sizeof(uint32_t));
    motion->order = (uint32_t *)malloc((size_t)motion->triangle_count * sizeof(uint32_t));
    if (!motion->triangles || !motion->order || fill_order(mesh, motion->order) != 0) {
        return scene_fail(error, error_size, "cloth: out of memory");
    }
    uint32_t *out = motion->triangles;
    for (uint32_t row = 0; row < n; row++) {
        for (uint32_t column = 0; column < n; column++, out += 3 * each) {
            fill_cell(mesh, row, column, out);
        }
    }
    return 0;
}

/* A control point; beyond the sides the grid goes on straight. */
static void get_node(const double *nodes, int64_t cells, int64_t row, int64_t column, double *out)
{
    const int64_t r = row < 0 ? 0 : row > cells ? cells : row;
    const int64_t c = column < 0 ? 0 : column > cells ? cells : column;
    const double *at = nodes + 3 * (r * (cells + 1) + c);
    /* The mirror image of the point on the other side of the border. */
    const double *mirrored = nodes + 3 * ((2 * r - row) * (cells + 1) + 2 * c - column);
    for (int k = 0; k < 3; k++) {
        out[k] = row == r && column == c ? at[k] : 2.0 * at[k] - mirrored[k];
    }
}

/* The four control points, from *first on, and their weights at a parameter from 0 to cells. */
static void spline_weights(double parameter, uint32_t cells, int64_t *first, double weights[4])
{
    double begin = floor(parameter);
    if (begin > (double)cells - 1.0) begin = (double)cells - 1.0;
    const double t = parameter - begin, s = 1.0 - t;
    *first = (int64_t)begin - 1;
    weights[0] = s * s * s / 6.0;
    weights[1] = (4.0 - 6.0 * t * t + 3.0 * t * t * t) / 6.0;
    weights[2] = (4.0 - 6.0 * s * s + 3.0 * s * s * s) / 6.0;
    weights[3] = t * t * t / 6.0;
}

void cloth_mesh_evaluate(const cloth_mesh *mesh, const double *nodes, uint32_t nodes_cells,
                         double *positions)
{
    const double scale = (double)nodes_cells / (double)mesh->cells;
    double *out = positions;
    /* Corners of cells, then their middles. */
    for (uint32_t middles = 0; middles <= mesh->crossed; middles++) {
        const uint32_t side = mesh->cells + 1 - middles;
        const double shift = middles ? 0.5 : 0.0;
        for (uint32_t row = 0; row < side; row++) {
            int64_t first_row;
            double row_weights[4];
            spline_weights((row + shift) * scale, nodes_cells, &first_row, row_weights);
            for (uint32_t column = 0; column < side; column++, out += 3) {
                int64_t first_column;
                double column_weights[4];
                spline_weights((column + shift) * scale, nodes_cells, &first_column,
                               column_weights);
                out[0] = out[1] = out[2] = 0.0;
                for (int i = 0; i < 4; i++) {
                    for (int j = 0; j < 4; j++) {
                        double node[3];
                        get_node(nodes, nodes_cells, first_row + i, first_column + j, node);
                        const double weight = row_weights[i] * column_weights[j];
                        for (int k = 0; k < 3; k++) out[k] += weight * node[k];
                    }
                }
            }
        }
    }
}
