/*
 * Builds the model of a scene.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef BENCH_BENCH_MODEL_H
#define BENCH_BENCH_MODEL_H

#include "scene_folder.h"

#include "starcontour.h"

/* Partitions: SC_PARTITION_FAST, METIS, or the scene's own order. */
enum { BENCH_FAST = 0, BENCH_METIS = 1, BENCH_STRUCTURE = 2 };

/*
 * rest: the first frame. The mesh has floats where the scene has, else doubles. options says all
 * but the partition, which is set here; BENCH_STRUCTURE needs scene->order. *milliseconds is the
 * time of sc_build.
 */
sc_status bench_model_build(const scene_folder *scene, const double *rest, uint32_t partition,
                            sc_build_options *options, sc_model **model, double *milliseconds);

/* A copy of a frame, of the mesh's type, to be freed; NULL without memory. */
void *bench_model_positions(const scene_folder *scene, const double *positions);

#endif /* BENCH_BENCH_MODEL_H */
