/*
 * Partition by recursive bisection: the built-in cut (build/straight_cut.h), or the caller's
 * (METIS).
 *
 * SPDX-License-Identifier: MIT
 *
 * Every patch is first taken apart where it is not connected through edges, so that components, and
 * what a cut tore off, become patches of their own. A thin tube is cut into rings at once
 * (build/slices.h). Any other connected patch is cut in two; then triangles move across the cut
 * where that makes it cheaper, and islands go to the side that surrounds them, as far as the sides'
 * capacities allow. O(n log n).
 *
 * A cut costs, along each edge, its rest length over the mean, divided by 2 - cos of the angle
 * between the normals of the two triangles: so that cuts follow creases, and normal cones of
 * patches stay narrow. On the scenes of sc-bench, against lengths alone, queries at rest take 10 to
 * 15 % less on the horse with METIS, 8 % on the cat, 3 to 7 % on bunnies; with the built-in cut 1 %
 * less on the horse, 3 to 9 % on cat and bunnies; on animations 0 to 3 % less. Up to 1 + 4 (1 -
 * cos) as divisor gives the same within the noise, and rods then get 2 to 7 % more memory.
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
