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

#include "query/worker.h"

/* Takes a pair that was not taken before, unless the caller's filter has it left out. */
void sc_pairs_take(sc_worker *w, uint32_t a, uint32_t b);

/* Whether pairs are only counted, all of them. */
static inline int sc_pairs_are_counted(const sc_question *q)
{
    return !q->filter && (q->options.output == SC_OUTPUT_COUNT ||
                          (q->options.output == SC_OUTPUT_PAIRS && !q->capacity));
}

/* Takes several such. */
void sc_pairs_take_all(sc_worker *w, const sc_pair *pairs, uint32_t count);

/* Sorts the array, at the end of a query that found so many; there is room for some more pairs.
   Tasks, or NULL, share in that if there are very many. */
void sc_pairs_finish(const sc_question *question, uint64_t found, sc_pair *spare, uint64_t room,
                     const sc_tasks *tasks);

#endif
