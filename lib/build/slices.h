/*
 * Thin parts cut into slices: tubes, strands, whatever a leaf cluster goes all the way round.
 *
 * SPDX-License-Identifier: MIT
 *
 * The normals of such a patch look to all sides, so that it is not culled by shape, however it is
 * cut below. What it costs are pairs of leaf clusters, and least where these follow each other like
 * the rings of a tube: each has two neighbors rather than five to eight. So the triangles are
 * sorted along the longest direction of the patch and taken off in turn, as many as fit into a leaf
 * cluster, to where the next is furthest: between two rings of a tube. They are kept if nearly all
 * come out full and in one piece; that is seen at the first few where a patch is no thin part. Else
 * it is cut in two, and its halves may be one.
 *
 * O(n log n) where slices are made, for the sum of normals O(n) else.
 */
#ifndef SC_BUILD_SLICES_H
#define SC_BUILD_SLICES_H

#include "build/direction.h"
#include "build/hierarchy.h"

/* All arrays are per triangle of the mesh. */
typedef struct sc_slices {
    sc_facets facets;
    const uint32_t
        *neighbor;    /* 3 a triangle: across its sides; without one, the number of triangles */
    sc_pair *keys;    /* scratch */
    uint32_t *before; /* scratch */
    uint32_t *place;  /* and one more: scratch, but not uninitialized */
} sc_slices;

/* Whether order[first .. first + count), which is connected, is a thin part: then it is sorted
   anew, and *node becomes the root of a balanced tree over its slices. Else it is as it was. */
int sc_slices_add(const sc_slices *slices, sc_hierarchy *hierarchy, uint32_t first, uint32_t count,
                  uint32_t depth, uint32_t *node);

#endif
