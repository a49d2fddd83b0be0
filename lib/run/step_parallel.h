/*
 * The query of one step by several of the host's threads.
 *
 * SPDX-License-Identifier: MIT
 *
 * The answer is that of one thread, bit for bit, and so is all that is counted, unless the query is
 * to end at the first pair: whoever does what, each node of the test tree is looked at or not for
 * the same reasons.
 */
#ifndef SC_RUN_STEP_PARALLEL_H
#define SC_RUN_STEP_PARALLEL_H

#include "run/workspace.h"

/* The tasks that share in a step, or at least in the passes over the poses: those of the caller if
   there are two workers or more and the model is not small, else NULL. */
const sc_tasks *sc_step_parallel_tasks(const sc_model *model, const sc_step_question *question);

/* Whether the rest is to be shared out as well: not with a budget. */
int sc_step_parallel_pays(const sc_model *model, const sc_step_question *question);

/* Does what sc_step_traversal_run and sc_step_pairs_finish do, for a step that pays and was begun
   in this workspace; what was found and counted is in its first worker. Where one of the caller's
   lists turns out to be too short, one thread asks again. */
void sc_step_parallel_run(sc_workspace *workspace);

#endif
