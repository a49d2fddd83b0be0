/*
 * Square cloth: triangles, an order of compact patches, and smooth surfaces over a coarser grid.
 *
 * SPDX-License-Identifier: MIT
 *
 * Two patterns: cells of four triangles round a vertex in the middle (any number 4 n^2 of triangles
 * is a square), or of two with diagonals that alternate. Vertices first those of the cells'
 * corners, row by row, then the middles. Cost: linear; the order takes a sort.
 */
#ifndef BENCH_CLOTH_MESH_H
#define BENCH_CLOTH_MESH_H

#include "scenes/motion.h"

typedef struct cloth_mesh {
    uint32_t cells;   /* along a side */
    uint32_t crossed; /* 1: four triangles a cell, 0: two */
} cloth_mesh;

/* The cloth whose number of triangles is nearest, with at least 2 x 2 cells. */
cloth_mesh cloth_mesh_choose(uint32_t triangles, uint32_t crossed);

/* Fills the counts, triangles and order of a motion. */
int cloth_mesh_fill(const cloth_mesh *mesh, scene_motion *motion, char *error, size_t error_size);

/*
 * Positions of all vertices, on the uniform cubic B-spline surface (twice continuously
 * differentiable) over a grid of (nodes_cells + 1)^2 control points, 3 doubles each, row by row;
 * beyond its sides the grid goes on straight, so that the surface of a flat grid is the same flat
 * square.
 */
void cloth_mesh_evaluate(const cloth_mesh *mesh, const double *nodes, uint32_t nodes_cells,
                         double *positions);

#endif /* BENCH_CLOTH_MESH_H */
