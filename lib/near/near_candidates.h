/*
 * Pairs of a vertex and a triangle, or of two edges, in a search for what is near: what becomes of
 * those that are near, and which of those that floats leave open are.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef SC_NEAR_CANDIDATES_H
#define SC_NEAR_CANDIDATES_H

#include "near/near_worker.h"

/* Whether pairs are wanted by name, and not only counted. */
int sc_near_candidates_want_names(const sc_question *question);

/* Whether the caller's filters are asked of pairs of a kind. */
int sc_near_candidates_are_asked(const sc_worker *w, int kind);

/* Sets bounds of all vertices, if these are wanted. */
void sc_near_candidates_set_bounds(const sc_near_question *question, uint32_t vertices,
                                   double bound);

/* Whether bounds are wanted that one worker has to find: of what the caller's function leaves,
   which it is asked as pairs are found; or where workers cannot lower one number together. */
int sc_near_candidates_need_one_worker(const sc_near_question *question);

/* Takes a pair that is near, which was not taken before, in numbers of places, if filters leave
   it; bound: at most its distance, for bounds of vertices if these are wanted; less than 0: it is
   to be computed. */
void sc_near_candidates_take(sc_worker *w, int kind, sc_pair inner, double bound);

/* Decides a pair that floats left open by exact signs, unless it is known to be near, and takes it
   if it is. */
void sc_near_candidates_decide(sc_worker *w, int kind, sc_pair inner, int is_near);

#endif
