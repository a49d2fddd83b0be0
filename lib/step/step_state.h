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

/* What the workers of a step have in common and write to, see step/step_parallel.c. */
typedef struct sc_step_share {
    sc_share query;    /* of which claimed is not used */
    size_t claimed[2]; /* entries of the lists that were given out, perhaps beyond their ends */
} sc_step_share;

typedef struct sc_step_state {
    sc_query_state query; /* what all queries have: output, cancel, budget, statistics */
    sc_step_options options;
    sc_impact_limits limits; /* of the narrow phase */
    sc_step_list list[2];
    double earliest;      /* least time of a pair found, else 1 */
    sc_step_share *share; /* NULL, if one thread does all */
    uint32_t reached[2];  /* nodes of one patch, and of two, whose parents this worker opened */
    uint32_t large;       /* large nodes of a level that it opened */
    uint32_t candidate_count[2];
    sc_pair candidates[2][SC_STEP_BATCH]; /* see step_candidates.h */
} sc_step_state;

#endif
