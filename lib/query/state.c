/*
 * Stopping a query early. See state.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "query/state.h"

#include "base/atomic.h"

/* What the caller's budget is compared with: all counts but those of the passes over the mesh. */
static uint64_t work(const sc_query_state *state)
{
    uint64_t sum = 0;
    int task;
    for (task = SC_TASK_ORIENTATION; task < SC_TASK_COUNT; task++) sum += state->stats.counts[task];
    return sum;
}

static int end_if(sc_query_state *state, int early)
{
    if (early) state->stop = state->incomplete = 1;
    return early;
}

int sc_state_ask_flag(sc_query_state *state)
{
    return end_if(state, sc_atomic_read(state->options.cancel) != 0);
}

int sc_state_ask_budget(sc_query_state *state)
{
    return end_if(state, work(state) > state->options.budget);
}
