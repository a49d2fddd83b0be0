/*
 * Reads the faces and positions of OBJ and OFF files.
 *
 * SPDX-License-Identifier: MIT
 *
 * These two text formats are read here because what matters to this library is vertex identity, the
 * order of faces and every digit: numbers are rounded to the nearest float, vertices and faces keep
 * the numbers they have in the file, and a file that is cut short or names a vertex that does not
 * exist is an error with a line number. Colours, normals, texture coordinates, materials, groups,
 * points and lines are ignored. OFF: text only, one vertex or face a line, comments anywhere.
 *
 * Cost: linear; holds the whole file in memory.
 */
#ifndef TOOLS_TEXT_MESH_H
#define TOOLS_TEXT_MESH_H

#include "polygon_mesh.h"

/* Whether a file is to be read here: its name ends in .obj or .off. */
bool text_mesh_knows(const char *path);

/* Reads a file. On failure *mesh is empty and error, of error_size characters, says why. */
bool text_mesh_read(polygon_mesh *mesh, const char *path, char *error, size_t error_size);

#endif /* TOOLS_TEXT_MESH_H */
