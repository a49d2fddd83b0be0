/*
 * Orientation signs that are never 0: of points in general position right beside those given.
 *
 * SPDX-License-Identifier: MIT
 *
 * Edelsbrunner and Muecke, Simulation of Simplicity, ACM Transactions on Graphics 9(1), 1990:
 * coordinate c (0, 1, 2) of point n moves by e to the power of 2^(3 n + c), for an e so small that
 * no sign that was not 0 changes. Whatever is asked of points so moved is answered as for one set
 * of points of which no four are in a plane. Points are told apart by their numbers alone, so that
 * points at one place are two.
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

#endif
