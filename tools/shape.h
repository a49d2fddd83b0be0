/*
 * Generated meshes for the programs: cloth grids, spheres, midpoint subdivision.
 *
 * SPDX-License-Identifier: MIT
 *
 * All return false if there is no memory, or too many triangles would come out. Linear in size but
 * for the sort of edges.
 */
#ifndef TOOLS_SHAPE_H
#define TOOLS_SHAPE_H

#include "mesh_file.h"

/* A flat square from -1 to 1 in x and y, of cells x cells cells of two triangles each, with
   diagonals that alternate. cells is 1 or more. */
bool shape_make_grid(mesh_file *mesh, uint32_t cells);

/* A unit sphere: an icosahedron subdivided level times, 20 * 4^level triangles. */
bool shape_make_sphere(mesh_file *mesh, uint32_t level);

/* Cuts every triangle into four at the midpoints of its sides. Positions are rounded
   to floats. Join vertices first; on failure the mesh is as it was. */
bool shape_subdivide(mesh_file *mesh);

#endif /* TOOLS_SHAPE_H */
