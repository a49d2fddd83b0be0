/*
 * Counts triangles that are near each other: how heavy contact is, whatever a method makes of it.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef BENCH_NEAR_PAIRS_H
#define BENCH_NEAR_PAIRS_H

#include <stdbool.h>
#include <stdint.h>

/*
 * Counts the pairs of triangles that share no vertex and whose boxes overlap. triangles has 3
 * triangle_count vertex numbers, positions 3 coordinates a vertex. By a sweep along the longest
 * axis: n log n, and a step for each pair that overlaps there; a fraction of a second for 100,000
 * triangles. False without memory.
 */
bool near_pairs_count(const uint32_t *triangles, uint32_t triangle_count, const double *positions,
                      uint64_t *count);

#endif /* BENCH_NEAR_PAIRS_H */
