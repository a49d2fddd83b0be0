/*
 * Which patches of a level are adjacent: share a point.
 *
 * SPDX-License-Identifier: MIT
 *
 * A point at which more than SC_NEIGHBORS_HUB patches of a level meet makes none of them adjacent
 * at that level, or a fan of n triangles would cost n^2. That loses no pair: patches that are not
 * adjacent are tested by their boxes. Of leaf clusters that are not adjacent it is not asked there
 * which triangles share points, unless they are crowded: so no point is a hub that does not make
 * those with it crowded.
 */
#ifndef SC_BUILD_NEIGHBORS_H
#define SC_BUILD_NEIGHBORS_H

#include "build/adjacency.h"
#include "build/sharing.h"
#include "build/xbvh.h"

enum { SC_NEIGHBORS_HUB = SC_SHARING_CROWD };

/*
 * Patch p has the neighbors entries[first[p]] to entries[first[p] + count[p] - 1], sorted, those
 * with higher numbers only. In an entry a is the neighbor, b the shared point if there is exactly
 * one, else SC_NONE. Scratch memory.
 */
typedef struct sc_neighbors {
    uint32_t *first, *count; /* patch_end */
    sc_pair *entries;
    uint64_t entry_count, capacity;
} sc_neighbors;

/* order[i] is the triangle at place i of the leaf order; sharing, with touch, is of the same
   clusters. */
sc_status sc_neighbors_build(const sc_points *points, const sc_adjacency *adjacency,
                             const uint32_t *order, const sc_xbvh *xbvh, const sc_sharing *sharing,
                             sc_scratch *scratch, sc_neighbors *neighbors);

void sc_neighbors_free(sc_neighbors *neighbors, sc_scratch *scratch);

/* The entry of two patches with a < b, or NULL if they are not adjacent. */
const sc_pair *sc_neighbors_find(const sc_neighbors *neighbors, uint32_t a, uint32_t b);

#endif
