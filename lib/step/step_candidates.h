/*
 * Pairs of a vertex and a triangle, or of two edges, that may collide: the last stages of a step.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef SC_STEP_CANDIDATES_H
#define SC_STEP_CANDIDATES_H

#include "step/step_worker.h"

/* The points of a pair, in the order in which the narrow phase takes them. */
static inline void sc_step_candidates_points(const sc_model *model, int kind, const sc_pair *pair,
                                             uint32_t point[4])
{
    const uint32_t *triangle = sc_model_triangle(model);
    uint32_t k;
    if (kind == SC_STEP_VERTEX_FACE) {
        point[0] = pair->a;
        for (k = 0; k < 3; k++) point[k + 1] = triangle[3 * (uint64_t)pair->b + k];
        return;
    }
    point[0] = triangle[pair->a];
    point[1] = triangle[pair->a - pair->a % 3 + (pair->a + 1) % 3];
    point[2] = triangle[pair->b];
    point[3] = triangle[pair->b - pair->b % 3 + (pair->b + 1) % 3];
}

/* A pair in the caller's numbers. */
sc_pair sc_step_candidates_name(const sc_model *model, int kind, const sc_pair *pair);

/* Stages, see query/lists.h: the narrow phase of pairs, or, if candidates are wanted, these. */
void sc_step_candidates_take_faces(sc_worker *w, uint32_t most);
void sc_step_candidates_take_edges(sc_worker *w, uint32_t most);

#endif
