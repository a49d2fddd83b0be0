/*
 * A step of a mesh from one pose to another, asked of the library: its collisions, and how many
 * candidates culling left.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef BENCH_STEP_METHOD_H
#define BENCH_STEP_METHOD_H

#include "starcontour.h"

#include <stdint.h>

/* What is kept from step to step. All zero at first. */
typedef struct step_method {
    sc_pair *lists[2]; /* vertex-face and edge-edge pairs of the last query */
    uint64_t count[2], room[2];
    uint64_t candidates;      /* of both kinds */
    double candidates_ms, ms; /* how long the two queries took */
} step_method;

/*
 * Two queries, of which the last of each kind is timed: candidates, counted, and collisions, which
 * go into the lists; these grow as needed. method is SC_STEP_METHOD_..., contour SC_CONTOUR_...;
 * stats may be NULL.
 */
sc_status step_method_query(step_method *step, const sc_model *model, sc_workspace *workspace,
                            const sc_pose *start, const sc_pose *end, uint32_t method,
                            uint32_t contour, sc_stats *stats);

void step_method_free(step_method *step);

#endif /* BENCH_STEP_METHOD_H */
