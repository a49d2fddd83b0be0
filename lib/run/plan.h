/*
 * One query, by one worker or by several of the host's threads: what is to be done, and who does
 * it.
 *
 * SPDX-License-Identifier: MIT
 *
 * The answer is the same bit for bit, whoever does what, and what was counted does not depend on
 * the number of workers if that is 2 or more.
 */
#ifndef SC_RUN_PLAN_H
#define SC_RUN_PLAN_H

#include "run/workspace.h"

/* The tasks that share in a query, or at least in the passes over the pose: those of the caller if
   there are two workers or more and the model is not small, else NULL. */
const sc_tasks *sc_plan_tasks(const sc_model *model, const sc_question *question);

/*
 * Answers the question of a query that was begun in this workspace, whose pose was read: what was
 * found and counted is in its first worker, and the caller's array is sorted. Where that turns out
 * to be too short for several workers, one asks again; and one does all with the star test or no
 * contour test, with a budget, or without a list of pairs of which the caller's function can be
 * asked.
 */
void sc_plan_run(sc_workspace *workspace);

/* The same of a query that this worker has joined as a whole one among others (sc_workspace_join):
   what it found is in the shared array, in any order. */
void sc_plan_run_whole(sc_workspace *workspace, uint32_t worker);

#endif
