/*
 * Pairs of triangles whose boxes overlap: collected, then decided in batches.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef SC_QUERY_CANDIDATES_H
#define SC_QUERY_CANDIDATES_H

#include "query/state.h"

/* Bits of all triangles of a leaf cluster. */
#define SC_LEAF_ALL ((1u << SC_LEAF_MAX) - 1u)

/* Pairs of triangles of two leaf clusters, at most. */
enum { SC_LEAF_PAIRS = SC_LEAF_MAX * SC_LEAF_MAX };

/* Of pairs of leaf clusters that wait: so many or more are tested by slabs first; memory is asked
   for some places ahead; so many are looked at before the query asks whether to stop. The first
   ones tuned on crushed cloth and the bunny. */
enum {
    SC_LEAF_SLABS_FIRST = 64,
    SC_FETCH_POINTS = 8,
    SC_FETCH_READY = 5,
    SC_LEAF_PAIRS_UNASKED = 64
};

/* Leaf clusters of which slabs are made together. */
enum { SC_MADE_LEAVES = 64 };

/* Pairs of leaf clusters that are looked at together; and of triangles in them, so many or the next
   pair of clusters more. Lists of both are written sixteen at a time. */
enum {
    SC_ROWS_PAIRS = 32,
    SC_ROWS = SC_ROWS_PAIRS * SC_LEAF_MAX + 16,
    SC_ROWS_LISTED = 512,
    SC_ROWS_LIST = SC_ROWS_LISTED + SC_LEAF_PAIRS + 2 * 16
};

/* Numbers that tell of two triangles that share a point how they are looked at, see
   query/neighbor_kernel.h. */
enum { SC_NEIGHBORS_ROWS = 7 };

/* Two leaf clusters, a <= b, and what is known of pairs of their triangles. */
typedef struct sc_leaf_pair {
    uint32_t a, b;
    int shares; /* any do */
    /* pairs that share points, see build/sharing_lists.h, or NULL */
    const uint16_t *list, *list_end;
    /* if that is NULL, SC_LEAF_MAX rows: triangles of b that share points with one of a */
    const uint16_t *shared;
    int wanted;                  /* so are pairs that do */
    uint16_t found[SC_LEAF_MAX]; /* room for shared */
} sc_leaf_pair;

/* Fills *pair; shared is where sc_model_share_begin has the two, or SC_NONE: they share no point,
   or are one, or crowded. */
void sc_candidates_enter(sc_query_state *state, uint32_t leaf_a, uint32_t leaf_b, uint32_t shared,
                         sc_leaf_pair *pair);

/* Takes a pair that shares points, by the places of its triangles: decides or collects it. */
void sc_candidates_add_neighbors(sc_query_state *state, uint32_t a, uint32_t b);

/* Collects a pair that shares nothing, by the places of its triangles. */
static inline void sc_candidates_add(sc_query_state *state, uint32_t a, uint32_t b)
{
    sc_pair *pair = &state->workspace->candidates[state->workspace->candidate_count++];
    pair->a = a;
    pair->b = b;
}

/* Pairs are decided by so many at a time. */
enum { SC_PAIR_LANES = 8 };

/* SC_PAIR_LANES pairs of triangles that share one point at most. Bit i of shared: in pair i the
   corner is one of the other triangle's. */
typedef struct sc_pair_lanes {
    const sc_pair *pairs;           /* places of triangles */
    const uint32_t *triangle;       /* three points at each place */
    const unsigned char *positions; /* as in sc_workspace */
    uint64_t stride;
    int floats; /* positions are floats */
    int proper; /* contacts are proper ones only */
    int shares; /* some points are shared */
    unsigned shared[2][3];
} sc_pair_lanes;

/* Which edges (k of the first triangle, 3 + k of the second) meet the other triangle, bit 8 k + i
   for pair i: certainly; or it cannot be told. None from a shared point. */
typedef struct sc_verdict {
    uint64_t meets, unsure;
} sc_verdict;

/* To be called after each pair of leaf clusters: decides what has been collected if there is no
   room for another. */
void sc_candidates_make_room(sc_query_state *state);

/* Decides what has been collected; to be called before the kind of task changes, and at the end. */
void sc_candidates_decide(sc_query_state *state);

#endif
