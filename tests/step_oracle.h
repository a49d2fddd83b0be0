/*
 * The oracle of continuous collision: do a moving vertex and face, or two moving edges, touch
 * during a step; and how far apart are they at a time? In exact arithmetic.
 *
 * It shares nothing with the library, and goes another way. The differences of the points of the
 * two make a moving triangle (for edges: a parallelogram, which is two), and the question is when
 * the origin lies in it. That is so where signs of polynomials of time have certain values, so it
 * begins at a root of one of them; these are isolated by Sturm's theorem, and signs at roots found
 * by greatest common divisors and bisection, all with integers of GMP (the GNU multiple precision
 * library). Any finite doubles are allowed.
 *
 * Cost: 1 microsecond if the two stay apart along an axis, some 10 if a plane contains all four
 * points never or at ordinary times, up to some milliseconds if it always does. Not thread-safe.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef SC_TESTS_STEP_ORACLE_H
#define SC_TESTS_STEP_ORACLE_H

/* What points 0 to 3 are: a vertex and a face, or two edges of two points each. */
typedef enum step_oracle_kind { STEP_ORACLE_VERTEX_FACE, STEP_ORACLE_EDGE_EDGE } step_oracle_kind;

/*
 * Whether the closed sets touch at some time in [0, 1], where each coordinate is (1 - t) start + t
 * end. If so, and the last two are not NULL, *low <= the first such time <= *high, less than 2^-50
 * apart.
 */
int step_oracle_touches(step_oracle_kind kind, const double start[4][3], const double end[4][3],
                        double *low, double *high);

/* Whether their distance at a time is <= a + b; both are >= 0, the sum is exact. */
int step_oracle_is_within(step_oracle_kind kind, const double start[4][3], const double end[4][3],
                          double time, double a, double b);

#endif
