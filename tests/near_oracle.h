/*
 * The oracle of proximity: is the distance of a point and a triangle, or of two segments, at most
 * d? In exact arithmetic.
 *
 * It shares nothing with the library, and goes another way: by squared distances as quotients of
 * integers (GMP, the GNU multiple precision library), made of scalar products alone. Any finite
 * doubles are allowed.
 *
 * Cost: some microseconds, more where exponents differ much. Not thread-safe.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef SC_TESTS_NEAR_ORACLE_H
#define SC_TESTS_NEAR_ORACLE_H

/* p[0] is the vertex, p[1] to p[3] are the corners of the face; d >= 0. */
int near_oracle_vertex_face(const double p[4][3], double d);

/* p[0] and p[1] are the ends of one edge, p[2] and p[3] those of the other. */
int near_oracle_edge_edge(const double p[4][3], double d);

/* The distance, rounded down to a double; below the least normal one, to one next to it. Infinite
   above the largest. */
double near_oracle_distance_vertex_face(const double p[4][3]);
double near_oracle_distance_edge_edge(const double p[4][3]);

#endif
