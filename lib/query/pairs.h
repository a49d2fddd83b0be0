/*
 * The caller's array of pairs: filled in any order, sorted at the end.
 *
 * SPDX-License-Identifier: MIT
 *
 * An array that is too short keeps the first pairs of the sorted list: once full, it is a heap with
 * the last pair on top, which a lower one replaces.
 */
#ifndef SC_QUERY_PAIRS_H
#define SC_QUERY_PAIRS_H

#include "query/state.h"

/* Takes a pair that was not taken before, unless the caller's filter has it left out. */
void sc_pairs_take(sc_query_state *state, uint32_t a, uint32_t b);

/* Whether pairs are only counted, all of them. */
static inline int sc_pairs_are_counted(const sc_query_state *state)
{
    return !state->filter && (state->options.output == SC_OUTPUT_COUNT ||
                              (state->options.output == SC_OUTPUT_PAIRS && !state->capacity));
}

/* Takes several such. */
void sc_pairs_take_all(sc_query_state *state, const sc_pair *pairs, uint32_t count);

/* Sorts the array, at the end of a query: what is known of the pose is lost. Tasks, or NULL, share
   in that if there are very many. */
void sc_pairs_finish(sc_query_state *state, const sc_tasks *tasks);

#endif
