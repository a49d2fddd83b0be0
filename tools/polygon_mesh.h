/*
 * The polygons of a file as it has them: what each reader makes, and mesh_file.c cuts into
 * triangles.
 *
 * SPDX-License-Identifier: MIT
 *
 * Vertices and faces keep the numbers they have in the file. Coordinates are doubles here, the
 * nearest ones to what the file says.
 */
#ifndef TOOLS_POLYGON_MESH_H
#define TOOLS_POLYGON_MESH_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* A name in the file: from first_face on, faces belong to what it names, until the next one. */
typedef struct polygon_mark {
    size_t first_face;
    char *name;
    char kind; /* as the reader likes: OBJ has objects and groups at the same time */
} polygon_mark;

/* Face i has the corners offsets[i] to offsets[i + 1] - 1, which may be fewer than three. */
typedef struct polygon_mesh {
    double *positions; /* 3 * vertex_count */
    uint32_t *corners; /* offsets[face_count] */
    size_t *offsets;   /* face_count + 1 */
    size_t vertex_count, face_count;
    uint32_t object_count;    /* 0: the file names none */
    char **object_names;      /* object_count */
    uint32_t *object_of_face; /* face_count; NULL: at most one object */
    bool rounded;             /* as in mesh_file.h */
    bool has_animation;       /* the same */
    polygon_mark *marks;
    size_t mark_count;
    size_t vertex_room, corner_room, face_room, mark_room; /* allocated entries */
} polygon_mesh;

/* Makes an empty mesh; false if there is no memory. */
bool polygon_mesh_init(polygon_mesh *mesh);

/* Frees the arrays and empties the mesh; an all-zero mesh is allowed. */
void polygon_mesh_free(polygon_mesh *mesh);

/* Gets ready for so many more vertices, corners or faces, so that adding them needs no memory. */
bool polygon_mesh_reserve_vertices(polygon_mesh *mesh, size_t count);
bool polygon_mesh_reserve_corners(polygon_mesh *mesh, size_t count);
bool polygon_mesh_reserve_faces(polygon_mesh *mesh, size_t count);

/* All return false if there is no memory or the count does not fit into 32 bits. */
bool polygon_mesh_add_vertex(polygon_mesh *mesh, const double position[3]);

/* Adds a face; corners may name vertices that follow. */
bool polygon_mesh_add_face(polygon_mesh *mesh, const uint32_t *corners, size_t count);

/* The same in two steps: corners one by one, then the face that they make. */
bool polygon_mesh_add_corner(polygon_mesh *mesh, size_t index, uint32_t corner);
bool polygon_mesh_end_face(polygon_mesh *mesh, size_t count);

/* From the next face on, faces belong to what the name says. */
bool polygon_mesh_mark(polygon_mesh *mesh, char kind, const char *name, size_t length);

/* How many marks of a kind have faces. */
size_t polygon_mesh_marked(const polygon_mesh *mesh, char kind);

/*
 * Makes the objects from the marks of a kind. same: equal names are one object, else each mark is
 * one. Faces before the first mark belong to an object without a name, "". What has no face is left
 * out, and a single object without a name is none.
 */
bool polygon_mesh_name_objects(polygon_mesh *mesh, char kind, bool same);

/* The first face with a corner that is no vertex, or face_count. */
size_t polygon_mesh_bad_face(const polygon_mesh *mesh);

/* How many triangles all faces are cut into. */
uint64_t polygon_mesh_triangle_count(const polygon_mesh *mesh);

/*
 * Cuts a polygon of count >= 3 corners into count - 2 triangles by clipping ears in the plane it
 * fits best; a convex one becomes a fan round its first corner. triangles: 3 * (count - 2) corners.
 * A polygon that crosses itself or has no area still becomes that many triangles.
 */
void polygon_mesh_triangulate(const double *positions, const uint32_t *corners, uint32_t count,
                              uint32_t *triangles);

#endif /* TOOLS_POLYGON_MESH_H */
