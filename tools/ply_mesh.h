/*
 * Reads the faces and positions of PLY files, as text or binary in either byte order.
 *
 * SPDX-License-Identifier: MIT
 *
 * As of OBJ and OFF files (text_mesh.h), numbers are rounded to the nearest float, vertices and
 * faces keep their order, and a file that is cut short, or names a vertex that does not exist, is
 * an error. Read are x, y and z of the element "vertex", and the list "vertex_indices" or
 * "vertex_index" of the elements "face" and "tristrips" (a strip of triangles, a new one after each
 * -1); all else is skipped. In text, each vertex or face is a line.
 *
 * Whatever a file says, reading it takes time and memory in proportion to what it holds.
 */
#ifndef TOOLS_PLY_MESH_H
#define TOOLS_PLY_MESH_H

#include "polygon_mesh.h"

/* Whether a file is to be read here: its name ends in .ply, or it begins with the word "ply". */
bool ply_mesh_knows(const char *path);

/* Reads a file. On failure *mesh is empty and error, of error_size characters, says why. */
bool ply_mesh_read(polygon_mesh *mesh, const char *path, char *error, size_t error_size);

#endif /* TOOLS_PLY_MESH_H */
