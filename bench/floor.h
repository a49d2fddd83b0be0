/*
 * The physical floor: the least that any method does with a pose.
 *
 * SPDX-License-Identifier: MIT
 *
 * One pass that reads every position and every vertex number once and reduces eight triangles at a
 * time to a box and to the range of their normals, four such clusters abreast. Vertex numbers are
 * laid out for this beforehand, in the order of the model's patches, so that neighbours stand
 * together.
 *
 * No method can be faster than about this unless it leaves part of the mesh unread.
 */
#ifndef BENCH_FLOOR_H
#define BENCH_FLOOR_H

#include "methods.h"

typedef struct floor_pass floor_pass;

/* Prepares for a mesh: clusters of eight triangles next to each other. NULL: no memory. */
floor_pass *floor_create(const method_mesh *mesh);

void floor_free(floor_pass *pass);

/* One pass over a pose of the mesh's type; returns milliseconds. */
double floor_run(floor_pass *pass, const void *positions);

/* The box of all clusters after a pass: low x, y, z, high x, y, z; and that of the normals. */
void floor_result(const floor_pass *pass, float box[6], float normals[6]);

#endif /* BENCH_FLOOR_H */
