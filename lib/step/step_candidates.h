/*
 * Pairs of a vertex and a triangle, or of two edges, whose boxes come near each other.
 *
 * SPDX-License-Identifier: MIT
 *
 * They are collected; those that are not seen to stay apart, sixteen at a time, go to the narrow
 * phase.
 */
#ifndef SC_STEP_CANDIDATES_H
#define SC_STEP_CANDIDATES_H

#include "step/step_worker.h"

/* Takes a vertex-face pair, of a point and the place of a triangle, or an edge-edge pair, of edges
   as 3 place + k; they have no vertex in common. */
void sc_step_candidates_take(sc_worker *w, int kind, uint32_t a, uint32_t b);

/* Decides what has been collected; to be called before the kind of task changes, and at the end. */
void sc_step_candidates_decide(sc_worker *w);

#endif
