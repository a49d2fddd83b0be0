/*
 * A contour of a node as it is seen throughout a step: its projections at the start and at the end.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef SC_STEP_MOVING_PROJECTION_H
#define SC_STEP_MOVING_PROJECTION_H

#include "query/simple_contour.h"
#include "step/step_worker.h"

/* A projected contour at the start, whose parts serve the end as well: points, axes, error, pinches
   and pieces; and the rest of the end. */
typedef struct sc_moving_contour {
    sc_simple_contour start;
    const sc_moving_edges *end;
    int ends;        /* 1: nothing moves, and end is not written; else 2 */
    float from[3];   /* at the end */
    float length[2]; /* of the axes: |axis|2, rounded up */
    /* Of a direction m, (|m.x| + |m.y|) known, and the length of (m.x reach[0], m.y reach[1]), is
       how far apart two computed sets must be along it for the true ones to be as far apart as is
       wanted. See moving_contour.c. */
    float known, reach[2];
    float clear[2];    /* at least that along the axes */
    float altitude[2]; /* in place of reach, for edges that share a point */
    uint32_t rings;    /* edges that come fewer after each other may be nearer; 0: none may */
    float open;        /* in place of known, for those; altitude counts for each edge between */
} sc_moving_contour;

#endif
