/*
 * Stopping a query early, and what was counted. See worker.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "query/worker.h"

/* What the caller's budget is compared with: all counts but those of the passes over the mesh. */
static uint64_t work(const sc_worker *w)
{
    uint64_t sum = 0;
    int task;
    for (task = SC_TASK_ORIENTATION; task < SC_TASK_COUNT; task++) sum += w->stats.counts[task];
    return sum;
}

static int end_if(sc_worker *w, int early)
{
    if (early) w->stop = w->incomplete = 1;
    return early;
}

int sc_worker_ask_flag(sc_worker *w)
{
    return end_if(w, sc_atomic_read(w->question->options.cancel) != 0);
}

int sc_worker_ask_budget(sc_worker *w)
{
    return end_if(w, work(w) > w->question->options.budget);
}

void sc_worker_add_stats(sc_stats *sum, const sc_stats *stats)
{
    uint32_t k;
    for (k = 0; k < SC_TASK_COUNT; k++) {
        sum->counts[k] += stats->counts[k];
        sum->nanoseconds[k] += stats->nanoseconds[k];
    }
    sum->nodes_visited += stats->nodes_visited;
    sum->nodes_oriented += stats->nodes_oriented;
    sum->nodes_culled += stats->nodes_culled;
    sum->leaf_pairs += stats->leaf_pairs;
    sum->exact_fallbacks += stats->exact_fallbacks;
}
