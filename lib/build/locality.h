/*
 * Renumbers triangles and points so that what is near in space is near in memory.
 *
 * SPDX-License-Identifier: MIT
 *
 * Triangles in the order of a space-filling curve through their centers in the rest pose, points in
 * the order in which these triangles first use them. All later steps of a build go from a triangle
 * to its neighbors; on a mesh in random order each such step would miss the cache. The order
 * decides no answer. Linear time.
 *
 * The Z-shaped curve (G. M. Morton, 1966) costs least. That of D. Hilbert (1891) never leaps, so
 * that consecutive triangles make good leaf clusters: by boxes, a query on the bunny takes 1.15
 * times as long as with bisected patches, along the other curve 1.37 times.
 */
#ifndef SC_BUILD_LOCALITY_H
#define SC_BUILD_LOCALITY_H

#include "build/mesh.h"

enum { SC_LOCALITY_Z, SC_LOCALITY_HILBERT };

/* Changes triangles, id, rest and slot. curve: one of the above. */
sc_status sc_locality_sort(sc_points *points, int curve, sc_scratch *scratch);

#endif
