/*
 * One query of a step on its way: what it was asked, where its answer goes.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef SC_STEP_STATE_H
#define SC_STEP_STATE_H

#include "query/state.h"
#include "step/impact.h"

/* Which of the caller's two lists. */
enum { SC_STEP_VERTEX_FACE = 0, SC_STEP_EDGE_EDGE = 1 };

/* So many candidates are collected before they are decided. */
enum { SC_STEP_BATCH = 128 };

/* One of the caller's lists. */
typedef struct sc_step_list {
    sc_pair *pairs;
    double *times; /* or NULL */
    uint64_t capacity;
    uint64_t count; /* pairs found */
} sc_step_list;

typedef struct sc_step_state {
    sc_query_state query; /* what all queries have: output, cancel, budget, statistics */
    sc_step_options options;
    sc_impact_limits limits; /* of the narrow phase */
    sc_step_list list[2];
    double earliest; /* least time of a pair found, else 1 */
    uint32_t candidate_count[2];
    sc_pair candidates[2][SC_STEP_BATCH]; /* see step_candidates.h */
} sc_step_state;

#endif
