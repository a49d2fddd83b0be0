/*
 * Whether contours are those of a pose: each node is where an edge crosses a triangle, contours
 * pass through each crossing and each segment as often as they should, go on where the mesh does,
 * and end as the header of the library allows. The checker has the oracle's crossings, and knows
 * nothing of how contours were followed.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef SC_TESTS_TRACED_POSE_H
#define SC_TESTS_TRACED_POSE_H

#include <stdint.h>

#include "starcontour.h"
#include "trace_oracle.h"

/* A mesh in a pose, what the library says of it and what is true. */
typedef struct traced_pose {
    uint32_t triangle_count;
    uint32_t *triangles;     /* after welding */
    const double *positions; /* 3 a vertex */
    sc_trace_result result;
    trace_oracle_answer truth;
} traced_pose;

/* Checks all contours of the result: 1, or 0 after a failed check. Where contours begin at vertices
   that two triangles have follows from the rest and is not looked for by itself. */
int traced_pose_check(const traced_pose *t);

#endif
