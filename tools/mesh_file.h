/*
 * Meshes for the programs: read from files of any format assimp knows, or generated.
 *
 * SPDX-License-Identifier: MIT
 *
 * A mesh_file is what the library wants of a mesh: packed float positions and uint32 triangles.
 * OBJ and OFF files are read by text_mesh.h, all others by assimp, whose positions are floats too,
 * moved by the node transforms of the scene. What the library promises holds for these floats.
 *
 * All meshes of a scene come one after the other, in the order of its nodes. Polygons are
 * triangulated; points and lines are left out; nothing else is reordered, joined or dropped.
 * Some of assimp's readers (3DS, STL) give every corner of a face a vertex of its own:
 * mesh_file_join undoes that, and so does the library's welding.
 *
 * Cost: linear; assimp itself takes most of the time and memory.
 */
#ifndef TOOLS_MESH_FILE_H
#define TOOLS_MESH_FILE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct mesh_file {
    float *positions;  /* 3 * vertex_count */
    uint32_t *indices; /* 3 * triangle_count */
    uint32_t vertex_count;
    uint32_t triangle_count;
    uint64_t face_hash; /* of the faces as read, before triangulation */
} mesh_file;

/* Room for any message that the readers write. */
enum { MESH_FILE_ERROR_SIZE = 1024 };

/* Reads a mesh. On failure error says why, beginning with the path, and *mesh is empty. */
bool mesh_file_read(mesh_file *mesh, const char *path, char error[MESH_FILE_ERROR_SIZE]);

/*
 * Reads the positions of another file with the vertices and faces of rest, which must match in
 * number and order. The triangles are those of rest, so polygons are not triangulated anew.
 * positions has room for 3 * rest->vertex_count floats.
 */
bool mesh_file_read_pose(const mesh_file *rest, const char *path, float *positions,
                         char error[MESH_FILE_ERROR_SIZE]);

/* Allocates the arrays of a mesh with given counts; false if there is no memory. */
bool mesh_file_allocate(mesh_file *mesh, uint32_t vertex_count, uint32_t triangle_count);

/* Frees the arrays and empties the mesh. An all-zero mesh is allowed. */
void mesh_file_free(mesh_file *mesh);

/*
 * Returns a new array: for each vertex the lowest number of a vertex with an equal position
 * (-0 equals 0). NULL if there is no memory.
 */
uint32_t *mesh_file_weld_map(const mesh_file *mesh);

/* Makes vertices with equal positions one. The first keeps its place in the order. */
bool mesh_file_join(mesh_file *mesh);

#endif /* TOOLS_MESH_FILE_H */
