/*
 * The oracle of contours: which edges cross which triangles if every vertex has moved by its power
 * of an infinitesimal number, in exact arithmetic, by comparing each edge with all triangles that
 * its box touches.
 *
 * It shares nothing with the library: determinants are written out as polynomials (GMP, the GNU
 * multiple precision library), term by term, of which the lowest is looked for.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef SC_TESTS_TRACE_ORACLE_H
#define SC_TESTS_TRACE_ORACLE_H

#include <stdint.h>

/* The sign of four points: 1 or -1. Coordinate c of point n moves by e to the power of
   2^(3 n + c). */
int trace_oracle_sign(const double *const points[4], const uint32_t numbers[4]);

/* Whether an edge, of which the first two of five points are the ends, crosses a triangle, of which
   the others are the corners. All numbers differ. */
int trace_oracle_crosses(const double *const points[5], const uint32_t numbers[5]);

/* Whether that is where the edge crosses the triangle: weights off by at most 2^-49 of themselves,
   coordinates by 2^-49 of the largest of the five points, or 2^-1070. Where edge and triangle are
   in a plane: whether the points of edge and triangle that have these weights are the point, up to
   2^-46. */
int trace_oracle_is_placed(const double *const points[5], double along, const double weights[3],
                           const double point[3]);

/* An edge that triangles have, not counting those with two corners in one. */
typedef struct trace_oracle_edge {
    uint32_t name; /* 3 t + k of the first triangle that has it, counting these too */
    uint32_t ends[2];
    uint32_t count, *triangles; /* ascending */
} trace_oracle_edge;

typedef struct trace_oracle_crossing {
    uint32_t edge; /* which of the edges */
    uint32_t triangle;
} trace_oracle_crossing;

/* All that there is in a pose. Sorted: edges by name, crossings by edge, then triangle. */
typedef struct trace_oracle_answer {
    uint32_t edge_count, crossing_count;
    trace_oracle_edge *edges;
    trace_oracle_crossing *crossings;
} trace_oracle_answer;

/* triangles: 3 corners each, after welding; positions: 3 a vertex. */
trace_oracle_answer trace_oracle_find(const uint32_t *triangles, uint32_t triangle_count,
                                      const double *positions);
void trace_oracle_free(trace_oracle_answer *answer);

#endif
