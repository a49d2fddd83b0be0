/*
 * Pairs of triangles: decided in doubles, eight at a time, and what that leaves, exactly.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef SC_QUERY_DECIDE_H
#define SC_QUERY_DECIDE_H

#include "query/worker.h"

/* Lists a pair that shares points, by the places of its triangles, of which the former follows a
   contour test or not: for eight at a time or for exact primitives, or not at all if nothing of it
   is wanted. */
void sc_decide_add_neighbors(sc_worker *w, uint32_t a, uint32_t b);

/* Stages, see query/lists.h: pairs that share nothing; that share one point; that are left. */
void sc_decide_candidates(sc_worker *w, uint32_t most);
void sc_decide_neighbors(sc_worker *w, uint32_t most);
void sc_decide_exactly(sc_worker *w, uint32_t most);

#endif
