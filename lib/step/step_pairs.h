/*
 * The caller's lists of a step: filled in any order, sorted at the end, each with the times of its
 * pairs.
 *
 * SPDX-License-Identifier: MIT
 *
 * A list that is too short keeps the first pairs, as query/pairs.h says.
 */
#ifndef SC_STEP_PAIRS_H
#define SC_STEP_PAIRS_H

#include "step/step_worker.h"

/* Takes a pair that was not taken before, in the caller's numbers. */
void sc_step_pairs_take(sc_worker *w, int kind, uint32_t a, uint32_t b, double time);

/* The same for some pairs, fewer than SC_FOUND_MAX, of a list without times. */
void sc_step_pairs_take_all(sc_worker *w, int kind, const sc_pair *pairs, uint32_t count);

/* Gives what a worker has found to the lists that several share, as sc_pairs_deliver. */
void sc_step_pairs_deliver(const sc_worker *w);

/* Sorts the lists, of which each was given so many pairs; spare is room for some pairs. tasks share
   in it, unless NULL. */
void sc_step_pairs_finish(const sc_step_question *question, const uint64_t found[2], sc_pair *spare,
                          uint64_t room, const sc_tasks *tasks);

#endif
