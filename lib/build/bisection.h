/*
 * Partition by recursive bisection: the built-in cut across the longest direction of a patch, or the
 * caller's (METIS).
 *
 * SPDX-License-Identifier: MIT
 *
 * Every patch is first taken apart where it is not connected through edges, so that components, and
 * what a cut tore off, become patches of their own. A connected patch is cut in two; then triangles
 * move across the cut where that shortens it, and islands go to the side that surrounds them, as far
 * as the sides' capacities allow. O(n log n).
 */
#ifndef SC_BUILD_BISECTION_H
#define SC_BUILD_BISECTION_H

#include "build/adjacency.h"
#include "build/hierarchy.h"

/* bisect NULL: the built-in cut. */
sc_status sc_bisection_build(const sc_points *points, const sc_adjacency *adjacency,
                             sc_bisect bisect, void *user, sc_scratch *scratch,
                             sc_hierarchy *hierarchy);

#endif
