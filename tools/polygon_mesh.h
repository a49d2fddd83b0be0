/*
 * Polygons as a file has them, for the readers of single formats, and what these share.
 *
 * SPDX-License-Identifier: MIT
 *
 * Readers add vertices and corners one by one, so that what is allocated grows with what a file
 * holds, not with what it says it holds.
 */
#ifndef TOOLS_POLYGON_MESH_H
#define TOOLS_POLYGON_MESH_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* All zero: empty. Face i has the corners offsets[i] to offsets[i + 1] - 1. */
typedef struct polygon_mesh {
    float *positions;  /* 3 * vertex_count */
    uint32_t *corners; /* offsets[face_count] */
    size_t *offsets;   /* face_count + 1; NULL if there are no faces */
    size_t vertex_count;
    size_t face_count;                          /* those with three corners or more */
    size_t vertex_room, corner_room, face_room; /* allocated entries */
} polygon_mesh;

/* How many corners there are. */
size_t polygon_mesh_corners(const polygon_mesh *mesh);

/* Adds a vertex; false if there is no memory. */
bool polygon_mesh_add_vertex(polygon_mesh *mesh, const float position[3]);

/* Sets corner number index, one after the other, of the face that comes next; false if there is no
   memory. */
bool polygon_mesh_add_corner(polygon_mesh *mesh, size_t index, uint32_t vertex);

/* Makes corner_count corners the next face, or drops them if they are a point or a line; false if
   there is no memory. */
bool polygon_mesh_end_face(polygon_mesh *mesh, size_t corner_count);

/* Whether all corners are vertices; else error, of error_size characters, says which is not. */
bool polygon_mesh_check(const polygon_mesh *mesh, const char *path, char *error, size_t error_size);

/* Frees the arrays and empties the mesh. */
void polygon_mesh_free(polygon_mesh *mesh);

/*
 * Cuts a polygon of count >= 3 corners into count - 2 triangles by clipping ears in the plane it
 * fits best; a convex one becomes a fan round its first corner. triangles: 3 * (count - 2) corners.
 * A polygon that crosses itself or has no area still becomes that many triangles.
 */
void polygon_mesh_triangulate(const float *positions, const uint32_t *corners, uint32_t count,
                              uint32_t *triangles);

/* A whole file, with a 0 after its *size bytes, to be freed; or NULL, and error says why. */
char *polygon_mesh_load(const char *path, size_t *size, char *error, size_t error_size);

#endif /* TOOLS_POLYGON_MESH_H */
