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

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Polygons as a file has them. Face i has the corners offsets[i] to offsets[i + 1] - 1. */
typedef struct text_mesh {
    float *positions;  /* 3 * vertex_count */
    uint32_t *corners; /* offsets[face_count] */
    size_t *offsets;   /* face_count + 1 */
    size_t vertex_count;
    size_t face_count; /* those with three corners or more */
} text_mesh;

/* Whether a file is to be read here: its name ends in .obj or .off. */
bool text_mesh_knows(const char *path);

/* Reads a file. On failure *mesh is empty and error, of error_size characters, says why. */
bool text_mesh_read(text_mesh *mesh, const char *path, char *error, size_t error_size);

/* Frees the arrays and empties the mesh. */
void text_mesh_free(text_mesh *mesh);

/*
 * Cuts a polygon of count >= 3 corners into count - 2 triangles by clipping ears in the plane it
 * fits best; a convex one becomes a fan round its first corner. triangles: 3 * (count - 2) corners.
 * A polygon that crosses itself or has no area still becomes that many triangles.
 */
void text_mesh_triangulate(const float *positions, const uint32_t *corners, uint32_t count,
                           uint32_t *triangles);

#endif /* TOOLS_TEXT_MESH_H */
