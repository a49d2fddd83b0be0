/*
 * What is within a distance in a pose, asked of the library in several ways; and the length that
 * distances are given in.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef BENCH_NEAR_METHOD_H
#define BENCH_NEAR_METHOD_H

#include "starcontour.h"

#include <stdbool.h>
#include <stdint.h>

/* The ways. */
enum {
    NEAR_LIST = 1,  /* sc_query_near: sorted pairs */
    NEAR_COUNT = 2, /* sc_query_near: how many there are, no lists */
    NEAR_STILL = 3  /* sc_query_step from the pose to itself, with the distance as separation:
                       sorted pairs, and a few more: see the tolerance of sc_step_options */
};

/* What is asked. */
typedef struct near_method_question {
    double distance;       /* in units of the coordinates */
    uint32_t ignore_rings; /* as in sc_filter, for both kinds of pairs; a test tree of NEAR_LIST and
                              NEAR_COUNT leaves them out by masks, all others by filters */
    uint32_t as;           /* NEAR_... */
    uint32_t method, simd; /* SC_NEAR_METHOD_..., or for NEAR_STILL SC_STEP_METHOD_... */
    const sc_tasks *tasks; /* or NULL */
} near_method_question;

/* What is kept from query to query. All zero at first. */
typedef struct near_method {
    sc_pair *lists[2]; /* vertex-face and edge-edge pairs of the last query that lists them */
    uint64_t count[2], room[2];
    double ms; /* of the last query, without those whose lists were too short, nor making masks */
    sc_near_masks *masks; /* of the model, of as many rings as the last query left out, or NULL */
    uint32_t rings;
} near_method;

/* One query; lists grow as needed. stats may be NULL. */
sc_status near_method_query(near_method *near, const sc_model *model, sc_workspace *workspace,
                            const sc_pose *pose, const near_method_question *question,
                            sc_stats *stats);

void near_method_free(near_method *near);

/*
 * The median length of a mesh's edges, each taken once: of an even number of them the lower one of
 * the two in the middle. triangles has 3 triangle_count vertex numbers, positions 3 coordinates a
 * vertex. False without memory, or without a triangle.
 */
bool near_method_median_edge(const uint32_t *triangles, uint32_t triangle_count,
                             const double *positions, double *length);

#endif /* BENCH_NEAR_METHOD_H */
