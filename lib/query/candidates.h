/*
 * Pairs of triangles whose boxes overlap: collected, then decided in batches.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef SC_QUERY_CANDIDATES_H
#define SC_QUERY_CANDIDATES_H

#include "query/state.h"

/* Compares the triangles of two leaf clusters, or of one with each other. */
void sc_candidates_of_pair(sc_query_state *state, uint32_t leaf_a, uint32_t leaf_b);
void sc_candidates_of_leaf(sc_query_state *state, uint32_t leaf);

/* Decides what has been collected; to be called before the kind of task changes, and at the end. */
void sc_candidates_decide(sc_query_state *state);

#endif
