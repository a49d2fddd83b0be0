/*
 * Pairs of a vertex and a triangle, or of two edges, in a search for what is near: what becomes of
 * those that are near, and the last stages, of those that floats leave open.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef SC_NEAR_CANDIDATES_H
#define SC_NEAR_CANDIDATES_H

#include "near/near_worker.h"

/* Whether pairs are wanted by name, and not only counted. */
int sc_near_candidates_want_names(const sc_question *question);

/* Whether some pairs are not wanted: all go through sc_near_candidates_take then. */
int sc_near_candidates_are_filtered(const sc_question *question);

/* Takes a pair that is near, which was not taken before: in numbers of places, and in the caller's
   numbers, edges in any order. */
void sc_near_candidates_take(sc_worker *w, int kind, sc_pair inner, uint32_t a, uint32_t b);

/* Stages, see query/lists.h: by exact signs. */
void sc_near_candidates_take_faces(sc_worker *w, uint32_t most);
void sc_near_candidates_take_edges(sc_worker *w, uint32_t most);

#endif
