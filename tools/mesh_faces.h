/*
 * Which of a file's own faces and objects its triangles, edges and vertices belong to, and how many
 * pairs there are between each two objects.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef TOOLS_MESH_FACES_H
#define TOOLS_MESH_FACES_H

#include "mesh_file.h"

/* What belongs to no object that the file names. */
#define MESH_NO_OBJECT UINT32_MAX

/* The face that a triangle is a part of. */
uint32_t mesh_face_of(const mesh_file *mesh, uint32_t triangle);

/* The object of a triangle, or MESH_NO_OBJECT. */
uint32_t mesh_object_of(const mesh_file *mesh, uint32_t triangle);

/* The name of an object; "" where the file gives none, and of MESH_NO_OBJECT. */
const char *mesh_object_name(const mesh_file *mesh, uint32_t object);

/* Prints a name, without the control characters that a file may bring; "(unnamed)" for "". */
void mesh_print_name(const char *name);

/* A new array: for each vertex the object of the first triangle that has it, or MESH_NO_OBJECT.
   NULL if there is no memory. */
uint32_t *mesh_vertex_objects(const mesh_file *mesh);

/* So many pairs between two objects, a <= b. */
typedef struct mesh_object_pairs {
    uint32_t a, b;
    uint64_t pairs;
} mesh_object_pairs;

/* Pairs by their two objects. All zero: none yet. */
typedef struct mesh_tally {
    mesh_object_pairs *entries;
    size_t count, capacity;
} mesh_tally;

/* Counts a pair between two objects, in either order; false if there is no memory. */
bool mesh_tally_add(mesh_tally *tally, uint32_t a, uint32_t b);

/* Makes one entry of each two objects, those with the most pairs first. */
void mesh_tally_sort(mesh_tally *tally);

/* Prints the first entries in a line of their own: "body / wheel 12, body / body 3". */
void mesh_tally_print(const mesh_tally *tally, const mesh_file *mesh);

void mesh_tally_free(mesh_tally *tally);

#endif /* TOOLS_MESH_FACES_H */
