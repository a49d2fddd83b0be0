/*
 * Fewer triangles: edges are collapsed, the cheapest first.
 *
 * SPDX-License-Identifier: MIT
 *
 * The cost of a collapse is the sum of squared distances to the planes of the triangles that went
 * into the vertex (Garland, Heckbert, "Surface simplification using quadric error metrics", 1997),
 * with planes through borders added; the new vertex is the best of the two ends and their middle.
 * Collapses that would join what is not connected, or turn a triangle over, are left out, so the
 * topology stays as it is. Cost: n log n; about a microsecond for each triangle removed and as many
 * bytes as half a kilobyte a triangle.
 */
#ifndef BENCH_DECIMATE_H
#define BENCH_DECIMATE_H

#include "mesh_file.h"

/*
 * Collapses edges until at most this many triangles are left, or none can be collapsed. Join
 * vertices first; unused vertices are dropped. False, with the mesh as it was, if there is no
 * memory.
 */
bool decimate_mesh(mesh_file *mesh, uint32_t triangles);

#endif /* BENCH_DECIMATE_H */
