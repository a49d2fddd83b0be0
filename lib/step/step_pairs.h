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

#include "step/step_state.h"

/* Takes a pair that was not taken before, in the caller's numbers. */
void sc_step_pairs_take(sc_step_state *state, int kind, uint32_t a, uint32_t b, double time);

/* Sorts the lists; tasks share in it, unless NULL. */
void sc_step_pairs_finish(sc_step_state *state, const sc_tasks *tasks);

#endif
