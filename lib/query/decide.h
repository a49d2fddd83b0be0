/*
 * Pairs of triangles: decided in doubles, eight at a time, and what that leaves, exactly.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef SC_QUERY_DECIDE_H
#define SC_QUERY_DECIDE_H

#include "query/worker.h"

/* Pairs are decided by so many at a time. */
enum { SC_PAIR_LANES = 8 };

/* SC_PAIR_LANES pairs of triangles that share one point at most. Bit i of shared: in pair i the
   corner is one of the other triangle's. */
typedef struct sc_pair_lanes {
    const sc_pair *pairs;           /* places of triangles */
    const uint32_t *triangle;       /* three points at each place */
    const unsigned char *positions; /* as in sc_positions */
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

/* Lists a pair that shares points, by the places of its triangles, of which the former follows a
   contour test or not: for eight at a time or for exact primitives, or not at all if nothing of it
   is wanted. */
void sc_decide_add_neighbors(sc_worker *w, uint32_t a, uint32_t b);

/* Stages, see query/lists.h: pairs that share nothing; that share one point; that are left. */
void sc_decide_candidates(sc_worker *w, uint32_t most);
void sc_decide_neighbors(sc_worker *w, uint32_t most);
void sc_decide_exactly(sc_worker *w, uint32_t most);

#endif
