/*
 * The oracle of triple points: on which side of a triangle's plane a crossing of an edge and a
 * triangle is if every vertex has moved, and where three triangles meet, in exact arithmetic.
 *
 * Shares nothing with the library: determinants are written out as polynomials of 24 unknowns (GMP,
 * the GNU multiple precision library), multiplied, and the lowest term is looked for.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef SC_TESTS_TRIPLE_ORACLE_H
#define SC_TESTS_TRIPLE_ORACLE_H

#include <stdint.h>

/* Of eight points, on which side of the plane of the last three the line through the first two
   meets the plane of the three between: the sign of trace_oracle_sign of the last three and that
   point. Coordinate c of point n moves by e(3 n + c), each of which is smaller than any power of
   those before. */
int triple_oracle_side(const double *const points[8], const uint32_t numbers[8]);

/* The height of that point over the plane, in units that depend on the plane alone, if nothing
   moves; NaN if the line is parallel to the first plane. Rounded, and 0 only if it is 0. All
   coordinates are below 2^100, and multiples of 2^-100. */
double triple_oracle_height(const double *const points[8]);

/* Whether three triangles have a point in common, of 9 points in all: 1 if it is inside of all, 0
   if they have none, and -1 if that is decided by a tie: four points in a plane, a point on a line
   or parallel planes. */
int triple_oracle_meet(const double *const points[9]);

#endif
