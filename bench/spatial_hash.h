/*
 * A spatial hash for self-collision, to compare with: M. Teschner, B. Heidelberger, M. Mueller,
 * D. Pomeranets, M. Gross, "Optimized Spatial Hashing for Collision Detection of Deformable Objects",
 * Vision, Modeling, and Visualization 2003; with edges in place of vertices.
 *
 * SPDX-License-Identifier: MIT
 *
 * Space is cut into cubes as long as the mesh's average edge. For each pose every edge is put into
 * the cells that its box meets, and every triangle looks at the edges in the cells that its box
 * meets. A pair that meets in several cells is tested in one of them only.
 *
 * NOT EXACT: the test is in plain double arithmetic and leaves out coplanar contact, so a touching
 * pair may be counted or not. Memory grows with the number of cells that edges meet.
 */
#ifndef BENCH_SPATIAL_HASH_H
#define BENCH_SPATIAL_HASH_H

#include "mesh_file.h"

typedef struct spatial_hash spatial_hash;

/* Prepares for a mesh whose vertices are joined. It must stay as it is. NULL: no memory. */
spatial_hash *spatial_hash_create(const mesh_file *mesh);

void spatial_hash_free(spatial_hash *hash);

/* Counts the pairs of an edge and a triangle that meet and share no vertex. False: no memory. */
bool spatial_hash_query(spatial_hash *hash, const float *positions, uint64_t *count);

#endif /* BENCH_SPATIAL_HASH_H */
