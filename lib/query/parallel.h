/*
 * One query by several of the host's threads.
 *
 * SPDX-License-Identifier: MIT
 *
 * The answer is that of one thread, bit for bit. What was counted does not depend on the number of
 * workers or on who did what.
 */
#ifndef SC_QUERY_PARALLEL_H
#define SC_QUERY_PARALLEL_H

#include "query/state.h"

/* The tasks that share in a query, or at least in the passes over the pose: those of the caller if
   there are two workers or more and the model is not small, else NULL. */
const sc_tasks *sc_parallel_tasks(const sc_query_state *state);

/*
 * Whether the rest of a query is to be shared out: there are such tasks, and it is not one of those
 * that one thread does: with the star test or no contour test, with a budget, or without a list of
 * pairs of which the caller's function can be asked.
 */
int sc_parallel_pays(const sc_query_state *state);

/*
 * Does what sc_traversal_run and sc_pairs_finish do, for a query that pays. Where the caller's
 * array turns out to be too short, one thread asks again.
 */
void sc_parallel_run(sc_query_state *state);

#endif
