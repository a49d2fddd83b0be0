/*
 * The runner: which stage a worker runs next, and when it stops.
 *
 * SPDX-License-Identifier: MIT
 *
 * It always runs the last stage whose list is long enough to be worth it; if there is none, the
 * first whose list is not empty. So what is found is decided soon, no list has more than it has
 * room for (query/lists.h), and what a stage leaves is still in the cache when the next one begins.
 * The same for one worker as for many.
 *
 * Between stages, and nowhere else, it asks the caller's flag and the budget, and whether enough is
 * known; none takes longer than some 20 microseconds, but for a contour or a pair of triangles that
 * does by itself.
 */
#ifndef SC_RUN_RUNNER_H
#define SC_RUN_RUNNER_H

#include "query/worker.h"

/* Runs stages until no list is worth one; all: until all lists are empty. What waits when the query
   is to end early is dropped. */
void sc_runner_run(sc_worker *w, int all);

/* Runs one stage on so many of the last items of its list, or fewer. */
void sc_runner_run_stage(sc_worker *w, sc_list_id list, uint32_t most);

/* How many items wait in all lists, for the sake of scheduling. */
uint32_t sc_runner_waiting(const sc_worker *w);

/* Boxes, unless they are there. */
void sc_runner_make_boxes(sc_worker *w);

#endif
