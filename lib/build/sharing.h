/*
 * Which triangles of leaf clusters share points: bit masks, so that a query need not compare
 * numbers.
 *
 * SPDX-License-Identifier: MIT
 *
 * Of about six pairs of triangles whose boxes overlap, for each triangle of a smooth mesh at rest,
 * all but a few share a point. They are told apart by a mask of bits for each triangle of a cluster
 * and each neighboring cluster: about 10 bytes a triangle.
 */
#ifndef SC_BUILD_SHARING_H
#define SC_BUILD_SHARING_H

#include "build/adjacency.h"
#include "build/xbvh.h"

/* Points of more triangles than this are left out, for a fan of n triangles would cost n^2;
   clusters that have one are crowded. */
enum { SC_SHARING_CROWD = 48 };

/* Scratch memory. */
typedef struct sc_sharing {
    uint32_t
        *first;     /* leaf_count + 1: entries of leaf cluster i are first[i] to first[i + 1] - 1 */
    uint32_t *leaf; /* first[leaf_count]: the other cluster, with a higher number, ascending */
    uint32_t *touch; /* as many: the point that the two share if it is one, SC_NONE if several; may
                        be given back */
    uint16_t
        *rows; /* SC_LEAF_MAX an entry: bit j of row i: triangle i shares with j of the other */
    uint16_t *own_rows; /* SC_LEAF_MAX a cluster: bit j > i of row i: its triangles i and j share */
    uint8_t *crowded;   /* leaf_count: 1 if its rows do not say all */
} sc_sharing;

/* The own rows of a cluster as the model keeps them, in half as many words: of row k the
   SC_LEAF_MAX - 1 - k highest bits are used, hence word k has room for row SC_LEAF_MAX - 1 - k
   below them, whose k bits are moved there. */
enum { SC_OWN_WORDS = SC_LEAF_MAX / 2 };

static inline void sc_sharing_fold(const uint16_t rows[SC_LEAF_MAX], uint16_t words[SC_OWN_WORDS])
{
    unsigned k;
    for (k = 0; k < SC_OWN_WORDS; k++)
        words[k] = (uint16_t)(rows[k] | (unsigned)rows[SC_LEAF_MAX - 1 - k] >> (SC_LEAF_MAX - k));
}

static inline void sc_sharing_unfold(const uint16_t words[SC_OWN_WORDS], uint16_t rows[SC_LEAF_MAX])
{
    unsigned k;
    for (k = 0; k < SC_OWN_WORDS; k++) {
        rows[k] = (uint16_t)(words[k] & (~1u << k));
        rows[SC_LEAF_MAX - 1 - k] = (uint16_t)((unsigned)words[k] << (SC_LEAF_MAX - k));
    }
}

sc_status sc_sharing_build(const sc_points *points, const sc_adjacency *adjacency,
                           const uint32_t *order, const sc_xbvh *xbvh, sc_scratch *scratch,
                           sc_sharing *sharing);

/* For debug builds and tests: 1 if the masks are what comparing all numbers gives. */
int sc_sharing_validate(const sc_points *points, const uint32_t *order, const sc_xbvh *xbvh,
                        const sc_sharing *sharing);

#endif
