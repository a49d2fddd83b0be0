/*
 * Orientation signs that are never 0: of points in general position right beside those given.
 *
 * SPDX-License-Identifier: MIT
 *
 * Edelsbrunner and Muecke, Simulation of Simplicity, ACM Transactions on Graphics 9(1), 1990:
 * coordinate c (0, 1, 2) of point n moves by e(3 n + c), and each e(i) is so small that no sign
 * which is not 0 without it and those behind it changes: smaller than any power of those before.
 * Whatever is asked of points so moved is answered as for one set of points, of which no four are
 * in a plane. Points are told apart by their numbers alone, so that points at one place are two.
 */
#ifndef SC_BASE_PERTURBED_H
#define SC_BASE_PERTURBED_H

#include <stdint.h>

/*
 * The sign of sc_predicates_orient3d, 1 or -1, of four points that have different numbers.
 * *fallbacks is as in base/predicates.h. Costs what that sign does where the points are not in a
 * plane.
 */
int sc_perturbed_orient3d(const double *const points[4], const uint32_t numbers[4],
                          uint64_t *fallbacks);

/*
 * On which side of a plane a crossing is: that of the line through points 0 and 1 with the plane
 * through points 2, 3 and 4. The sign of sc_predicates_orient3d of points 5, 6 and 7, the plane,
 * and the crossing: 1 or -1. 0 and 1 must be on different sides of 2, 3 and 4. Numbers differ,
 * except that one of 5, 6 and 7 may be one of 0 and 1, and one may be one of 2, 3 and 4.
 *
 * Costs what the signs of 0 and 1 do where they agree, else 0.3 us, and 2 to 30 us where the
 * crossing is in the plane.
 */
int sc_perturbed_crossing_side(const double *const points[8], const uint32_t numbers[8]);

#endif
