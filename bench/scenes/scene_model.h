/*
 * The models of glmark2 at any resolution.
 *
 * SPDX-License-Identifier: MIT
 *
 * Edges are collapsed (decimate.h), or triangles are cut in four and the surface is smoothed, so
 * that the count comes near to what is asked for. Meshes stand upright on z, with their box about
 * the origin and its longest side 2.
 */
#ifndef BENCH_SCENE_MODEL_H
#define BENCH_SCENE_MODEL_H

#include "mesh_file.h"

/* Reads FILE from build/meshes or $SC_MESHES. up: how it stands in the file: 1: y is up, -2: z is
   down. Returns 0, or -1 with a message in error, which names `make meshes` if the file is not
   there. */
int scene_model_read(mesh_file *mesh, const char *file, int up, uint32_t triangles, char *error,
                     size_t error_size);

/* Unit normals of all vertices, 3 each, by the sum of their triangles' (0 where that is 0). */
void scene_model_normals(const uint32_t *triangles, uint32_t triangle_count,
                         const double *positions, uint32_t vertex_count, double *normals);

#endif /* BENCH_SCENE_MODEL_H */
