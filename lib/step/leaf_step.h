/*
 * The pairs of leaf clusters in a step: which of their vertices, edges and triangles may come
 * together.
 *
 * SPDX-License-Identifier: MIT
 *
 * A vertex belongs to the first leaf cluster that has it, an edge to the triangle that names it: so
 * each vertex meets each triangle, and each edge each other edge, in one pair of leaf clusters, or
 * in one with itself. Pairs that share points are among them, there is nothing special about
 * neighbors.
 */
#ifndef SC_STEP_LEAF_STEP_H
#define SC_STEP_LEAF_STEP_H

#include "step/step_state.h"

/* The vertices, edges and triangles of a leaf cluster, from the few that are kept in the workspace;
   way 0 and way 1 are never at the same place. About 0.3 us if it is not there. */
const sc_leaf_motion *sc_leaf_step_get(sc_step_state *state, uint32_t leaf, int way);

/* Forgets those of the last query. */
void sc_leaf_step_reset(sc_motion *motion);

#endif
