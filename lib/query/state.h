/*
 * One query on its way: what it was asked, where its answer goes, what it counted.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef SC_QUERY_STATE_H
#define SC_QUERY_STATE_H

#include <stddef.h>

#include "base/atomic.h"
#include "base/clock.h"
#include "pose/workspace.h"

/* What the workers of a query have in common and write to, see query/parallel.c. */
typedef struct sc_share {
    size_t claimed; /* entries of the caller's array that were given out, perhaps beyond its end */
    uint32_t halt;  /* enough is known */
} sc_share;

typedef struct sc_query_state {
    const sc_model *model;
    sc_workspace *workspace;
    sc_query_options options;
    const sc_filter *filter; /* checked, or NULL; what follows comes from it */
    int sifts;           /* it has groups, which drop pairs of triangles before they are tested */
    int drops_neighbors; /* of triangles that share a vertex nothing is wanted */
    sc_pair *pairs;      /* the caller's array */
    uint64_t capacity;
    uint64_t count;    /* pairs found */
    sc_share *share;   /* NULL, if one thread does all */
    int stop;          /* enough is known, or the query is to end early */
    int incomplete;    /* it is to end early */
    int after_contour; /* box and primitive tests count as following a failed contour test */
    uint32_t task;     /* what the clock runs for */
    int timed;
    uint64_t last_time;
    sc_stats stats;
} sc_query_state;

/* Asks the caller's flag, and the budget. Sets stop and incomplete, and returns stop. */
int sc_state_ask_flag(sc_query_state *state);
int sc_state_ask_budget(sc_query_state *state);

/* Whether to stop. To be asked at least every 100 us or so. */
static inline int sc_state_cancelled(sc_query_state *state)
{
    if (state->share && sc_atomic_read(&state->share->halt)) state->stop = 1;
    return state->stop || (state->options.cancel && sc_state_ask_flag(state));
}

/* The same, and whether the budget is used up: only where it does not depend on the flag or on
   statistics that asking comes after the same work in each run. */
static inline int sc_state_stops(sc_query_state *state)
{
    return sc_state_cancelled(state) || (state->options.budget && sc_state_ask_budget(state));
}

/* Whether pairs should not wait for long to be decided: the first hit ends the query, or a budget
   does, and what has been found by then counts. */
static inline int sc_state_may_end_early(const sc_query_state *state)
{
    return state->options.output == SC_OUTPUT_ANY || state->options.budget;
}

/* Lets the clock run for another task; returns the one it ran for. */
static inline uint32_t sc_state_switch(sc_query_state *state, uint32_t task)
{
    uint32_t previous = state->task;
    if (state->timed && task != previous) {
        uint64_t now = sc_clock_nanoseconds();
        state->stats.nanoseconds[previous] += now - state->last_time;
        state->last_time = now;
        state->task = task;
    }
    return previous;
}

static inline uint32_t sc_state_box_task(const sc_query_state *state)
{
    return state->after_contour ? SC_TASK_BOXES_CONTOUR : SC_TASK_BOXES_ORIENTATION;
}

static inline uint32_t sc_state_primitive_task(const sc_query_state *state)
{
    return state->after_contour ? SC_TASK_PRIMITIVES_CONTOUR : SC_TASK_PRIMITIVES_ORIENTATION;
}

#endif
