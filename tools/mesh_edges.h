/*
 * The sides of a mesh's triangles, sorted so that the sides on one edge stand together.
 *
 * SPDX-License-Identifier: MIT
 *
 * For programs that need edges: vertices are told apart by number, so join them first
 * (mesh_file_join). Cost: one sort of three entries a triangle.
 */
#ifndef TOOLS_MESH_EDGES_H
#define TOOLS_MESH_EDGES_H

#include "mesh_file.h"

/* Corner 3 t + k stands for the side from vertex k to vertex (k + 1) % 3 of triangle t. */
typedef struct mesh_side {
    uint32_t low, high; /* the two vertex numbers; equal for a side from a vertex to itself */
    uint32_t corner;
} mesh_side;

/* Returns a new array of 3 * triangle_count sides sorted by low, high, corner; NULL: no memory. */
mesh_side *mesh_edges_sort(const mesh_file *mesh);

/* Whether a side runs from its lower to its higher vertex number. */
bool mesh_edges_is_forward(const mesh_file *mesh, const mesh_side *side);

/* The number of sides from sides[begin] on that are on the same edge; count is that of all
   sides. */
size_t mesh_edges_run(const mesh_side *sides, size_t begin, size_t count);

#endif /* TOOLS_MESH_EDGES_H */
