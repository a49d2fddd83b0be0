/*
 * Pairs of leaf clusters: proofs that strike pairs out, and the triangles of those that are left.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef SC_QUERY_CLUSTERS_H
#define SC_QUERY_CLUSTERS_H

#include "query/worker.h"

/* Bits of all triangles of a leaf cluster. */
#define SC_LEAF_ALL ((1u << SC_LEAF_MAX) - 1u)

/* Of pairs of leaf clusters that wait: so many or more are tested by slabs first; memory is asked
   for some places ahead. The first ones tuned on crushed cloth and the bunny. */
enum { SC_LEAF_SLABS_FIRST = 64, SC_FETCH_POINTS = 8, SC_FETCH_DERIVED = 5 };

/* Leaf clusters of which slabs are made together. */
enum { SC_MADE_LEAVES = 64 };

/* Pairs of triangles that are listed together, so many or the next pair of clusters more, sixteen
   at a time. */
enum { SC_ROWS_LISTED = 512, SC_ROWS_LIST = SC_ROWS_LISTED + SC_LEAF_PAIRS + 2 * 16 };

/* Two leaf clusters, in any order unless they have a list, and what is known of pairs of their
   triangles. */
typedef struct sc_leaf_pair {
    uint32_t a, b;
    uint32_t bit; /* of items: they follow a contour test */
    int shares;   /* any do */
    int wanted;   /* so are pairs that do */
    /* pairs that share points, see build/sharing_lists.h, or NULL */
    const uint16_t *list, *list_end;
    /* if that is NULL, SC_LEAF_MAX rows: triangles of b that share points with one of a */
    const uint16_t *shared;
    uint16_t found[SC_LEAF_MAX]; /* room for shared */
} sc_leaf_pair;

/* Fills *pair with what the model knows. */
void sc_clusters_enter(const sc_worker *w, const sc_cluster_pair *clusters, sc_leaf_pair *pair);

#endif
