/*
 * Meshes for the programs: read from files of any format assimp knows, or generated.
 *
 * SPDX-License-Identifier: MIT
 *
 * A mesh_file is what the library wants of a mesh: packed positions and uint32 triangles. Positions
 * are the nearest doubles to what the file says, and are floats if all of them are exactly floats.
 * OBJ and OFF files are read by text_mesh.h, PLY by ply_read.h, STL by stl_read.h, all others by
 * assimp, which reads floats and whose positions are moved by the node transforms of the scene, in
 * doubles: see `rounded`. A file may be a pipe, standard input, or packed by gzip.
 *
 * All meshes of a scene come one after the other, in the order of its nodes. Polygons are
 * triangulated; nothing else is reordered, joined or dropped. Some files (STL) and some of assimp's
 * readers (3DS) give every corner of a face a vertex of its own: mesh_file_join undoes that, and so
 * does the library's welding.
 *
 * Faces are the file's own polygons, counted from 0 in its order (assimp: in the order of the
 * scene's meshes). Faces of fewer than three corners, such as lines, keep their number and have no
 * triangle; OBJ files with such an `f` are refused.
 *
 * Cost: linear; of what assimp reads, assimp itself takes most of the time and memory.
 */
#ifndef TOOLS_MESH_FILE_H
#define TOOLS_MESH_FILE_H

#include "starcontour.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct mesh_file {
    void *positions;        /* 3 * vertex_count of position_type */
    uint32_t position_type; /* SC_FLOAT or SC_DOUBLE */
    uint32_t *indices;      /* 3 * triangle_count */
    uint32_t vertex_count;
    uint32_t triangle_count;
    uint32_t face_count;        /* of the file's own faces */
    uint32_t *face_of_triangle; /* triangle_count, ascending; NULL: each triangle is its face */
    /* Objects: `o`, or `g` where there is but one `o`, of OBJ; each `solid` of text STL; nodes that
       have meshes of what assimp reads. Their names, "" where the file gives none; equal names of
       `o` or `g` are one object. */
    uint32_t object_count;    /* 0: the file names none */
    char **object_names;      /* object_count */
    uint32_t *object_of_face; /* face_count; NULL: at most one object */
    uint64_t face_hash;       /* use mesh_file_hash; 0: not known yet */
    bool rounded; /* a reader gave floats of a format that can hold more; the answer is for these */
    bool has_animation; /* of what assimp reads: it is not played, positions are the bind pose's */
} mesh_file;

/* Other positions of a mesh. */
typedef struct mesh_pose {
    void *positions;             /* 3 * vertex_count of position_type */
    uint32_t position_type;      /* its own, whatever that of the rest mesh is */
    bool rounded, has_animation; /* as in mesh_file */
} mesh_pose;

/* Formats that are read here, for mesh_file_assume. */
enum {
    MESH_FORMAT_UNKNOWN = 0,
    MESH_FORMAT_OBJ,
    MESH_FORMAT_OFF,
    MESH_FORMAT_PLY,
    MESH_FORMAT_STL
};

/* The format of files that are read from now on and whose names tell none, such as "-", standard
   input; MESH_FORMAT_UNKNOWN, as at first: their content tells it, or does not. */
void mesh_file_assume(uint32_t format);

/* Room for any message that the readers write. */
enum { MESH_FILE_ERROR_SIZE = 1024 };

/* Reads a mesh. On failure error says why, beginning with the path, and *mesh is empty. */
bool mesh_file_read(mesh_file *mesh, const char *path, char error[MESH_FILE_ERROR_SIZE]);

/*
 * A hash of the faces as read, before triangulation, the same in every run and on every machine.
 * It is made when the mesh is read, or, if all faces are triangles, anew with every call: keep it
 * in face_hash where several files are compared with one.
 */
uint64_t mesh_file_hash(const mesh_file *mesh);

/*
 * Reads the positions of another file with the vertices and faces of rest, which must match in
 * number and order. The triangles are those of rest, so polygons are not triangulated anew. On
 * failure *pose is empty.
 */
bool mesh_file_read_pose(const mesh_file *rest, const char *path, mesh_pose *pose,
                         char error[MESH_FILE_ERROR_SIZE]);

/* Frees the positions and empties the pose. An all-zero pose is allowed. */
void mesh_pose_free(mesh_pose *pose);

/* Allocates the arrays of a mesh of floats with given counts, each triangle a face; false if there
   is no memory. */
bool mesh_file_allocate(mesh_file *mesh, uint32_t vertex_count, uint32_t triangle_count);

/* Frees the arrays and empties the mesh. An all-zero mesh is allowed. */
void mesh_file_free(mesh_file *mesh);

/* A vertex of an array of positions of a type, as doubles. */
void mesh_file_position(const void *positions, uint32_t position_type, size_t vertex,
                        double position[3]);

/* The positions of a mesh as floats: doubles are rounded for good. For what is made of a mesh and
   does not answer for it, such as scenes. Larger than any float becomes infinite. */
float *mesh_file_floats(mesh_file *mesh);

/*
 * Returns a new array: for each vertex the lowest number of a vertex with an equal position
 * (-0 equals 0). NULL if there is no memory.
 */
uint32_t *mesh_file_weld_map(const mesh_file *mesh);

/* Makes vertices with equal positions one. The first keeps its place in the order. */
bool mesh_file_join(mesh_file *mesh);

#endif /* TOOLS_MESH_FILE_H */
