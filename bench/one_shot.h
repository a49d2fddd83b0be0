/*
 * Measures a single query of a mesh from nothing: build, workspace, query, and freeing it all.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef BENCH_ONE_SHOT_H
#define BENCH_ONE_SHOT_H

#include "methods.h"
#include "scene_folder.h"

typedef struct one_shot_options {
    method_question question;
    uint32_t partition; /* BENCH_... of bench_model.h */
    uint32_t repeats;   /* of which medians are taken; the methods take turns */
} one_shot_options;

/*
 * Of the first frame, with each of the methods, which are queries of the library; aabb with a model
 * for boxes alone, as for a mesh that is asked about once. Prints a JSON object a line and method,
 * with
 *     build_ms, workspace_ms, query_ms, total_ms         total_ms is the median of sums, freeing
 *                                                        included
 *     pairs, model_bytes, workspace_bytes, peak_bytes    peak_bytes: while it was built
 * or, with json false, a table. On failure false, with a message in error.
 */
bool one_shot_run(scene_folder *scene, const char *name, const method_kind *const *methods,
                  size_t count, const one_shot_options *options, bool json, char *error,
                  size_t error_size);

#endif /* BENCH_ONE_SHOT_H */
