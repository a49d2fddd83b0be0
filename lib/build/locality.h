/*
 * Renumbers triangles and points so that what is near in space is near in memory.
 *
 * SPDX-License-Identifier: MIT
 *
 * Triangles in the order of a Z-shaped space-filling curve (G. M. Morton, 1966) through their centers in the
 * rest pose, points in the order in which these triangles first use them. All later steps of a build go
 * from a triangle to its neighbors; on a mesh in random order each such step would miss the cache. The
 * order decides no answer. Linear time.
 */
#ifndef SC_BUILD_LOCALITY_H
#define SC_BUILD_LOCALITY_H

#include "build/mesh.h"

/* Changes triangles, id, rest and slot. */
sc_status sc_locality_sort(sc_points *points, sc_scratch *scratch);

#endif
