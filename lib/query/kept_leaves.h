/*
 * What a worker keeps of leaf clusters in a query, made when it is first needed: boxes and planes
 * of their triangles, and slabs that they are in. See query/derived_kernel.h.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef SC_QUERY_KEPT_LEAVES_H
#define SC_QUERY_KEPT_LEAVES_H

#include "build/hierarchy.h"

/* The derived data of a leaf cluster: what tests of its triangles need, in the unit box. Rows are
   filled with the last triangle. */
typedef struct sc_leaf_derived {
    float side[6][SC_LEAF_MAX]; /* boxes; what is no triangle is NaN and overlaps nothing */
    float normal[3][SC_LEAF_MAX];
    float offset[SC_LEAF_MAX]; /* where the first corner is along the normal */
    float size[SC_LEAF_MAX];   /* |e|1 + |f|1, e and f the edges from the first corner */
} sc_leaf_derived;

enum { SC_DERIVED_ROWS = sizeof(sc_leaf_derived) / (SC_LEAF_MAX * sizeof(float)) };

/* Of which leaf cluster derived data is kept, from which epoch, 0 for never; and the largest extent
   of its box. */
typedef struct sc_leaf_known {
    uint32_t leaf, epoch;
    float extent;
} sc_leaf_known;

/* Where the points of a leaf cluster are along its mean normal, about, at least and at most. */
typedef struct sc_leaf_slab {
    float direction[3], ends[2];
    uint32_t epoch; /* 0: nothing yet */
} sc_leaf_slab;

/* Where there is no room for the derived data of all leaf clusters, there is for so many: a power
   of two. */
enum { SC_DERIVED_KEPT = 64 };

/* As mask: every leaf cluster has a place. */
#define SC_KEEPS_ALL 0xffffffffu

/*
 * The derived data of leaf cluster i is kept at i & mask, if it is there. Of two with one place the
 * second is at the place behind all of them, `spare`.
 */
typedef struct sc_kept_leaves {
    sc_leaf_derived *derived;
    sc_leaf_known *known;
    uint32_t mask; /* SC_KEEPS_ALL, or spare - 1 */
    uint32_t spare;
    sc_leaf_derived *some_derived; /* some + 1, the worker's own */
    sc_leaf_known *some_known;     /* as many */
    uint32_t some;                 /* SC_DERIVED_KEPT, fewer in small models */
    sc_leaf_slab *slab;            /* leaf_count */
} sc_kept_leaves;

/* Has a power of two of them kept in arrays with one place more; or all. */
static inline void sc_kept_leaves_in(sc_kept_leaves *kept, sc_leaf_derived *derived,
                                     sc_leaf_known *known, uint32_t count)
{
    kept->derived = derived;
    kept->known = known;
    kept->spare = count == SC_KEEPS_ALL ? 0 : count;
    kept->mask = count == SC_KEEPS_ALL ? count : count - 1;
}

/* Has some kept, in the worker's own arrays. */
static inline void sc_kept_leaves_some(sc_kept_leaves *kept)
{
    sc_kept_leaves_in(kept, kept->some_derived, kept->some_known, kept->some);
}

#endif
