/*
 * Pairs of a vertex and a triangle, or of two edges, that may collide: the last stages of a step.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef SC_STEP_CANDIDATES_H
#define SC_STEP_CANDIDATES_H

#include "step/step_worker.h"

/* Whether it is a vertex of the second object and a face of the first. */
static inline int sc_step_candidates_are_turned(const sc_worker *w, int kind, const sc_pair *pair)
{
    return kind == SC_STEP_VERTEX_FACE && sc_worker_is_between(w) && pair->a >= SC_STEP_TURNED;
}

/* Whose model and frame the first and the second of a pair have. */
typedef struct sc_pair_sides {
    const sc_worker *a, *b;
} sc_pair_sides;

static inline sc_pair_sides sc_step_candidates_sides(const sc_worker *w, int kind,
                                                     const sc_pair *pair)
{
    sc_pair_sides sides;
    const int turned = sc_step_candidates_are_turned(w, kind, pair);
    sides.a = turned ? w->second : w;
    sides.b = turned ? w : w->second;
    return sides;
}

/* The points of a pair, in the order in which the narrow phase takes them. */
static inline void sc_step_candidates_points(const sc_worker *w, int kind, const sc_pair *pair,
                                             uint32_t point[4])
{
    const sc_pair_sides sides = sc_step_candidates_sides(w, kind, pair);
    const uint32_t *of_a = sc_model_triangle(sides.a->model);
    const uint32_t *of_b = sc_model_triangle(sides.b->model);
    uint32_t k;
    if (kind == SC_STEP_VERTEX_FACE) {
        const int turned = sc_step_candidates_are_turned(w, kind, pair);
        point[0] = turned ? pair->a & ~SC_STEP_TURNED : pair->a;
        for (k = 0; k < 3; k++) point[k + 1] = of_b[3 * (uint64_t)pair->b + k];
        return;
    }
    point[0] = of_a[pair->a];
    point[1] = of_a[pair->a - pair->a % 3 + (pair->a + 1) % 3];
    point[2] = of_b[pair->b];
    point[3] = of_b[pair->b - pair->b % 3 + (pair->b + 1) % 3];
}

/* A pair in the caller's numbers; what is turned stays so. */
sc_pair sc_step_candidates_name(const sc_worker *w, int kind, const sc_pair *pair);

/* Whether two edges are named the other way round: the lower name is first. Between two objects the
   first object's is. */
static inline int sc_step_candidates_turn(const sc_worker *w, int kind, sc_pair name)
{
    return kind == SC_STEP_EDGE_EDGE && name.a > name.b && !sc_worker_is_between(w);
}

/* Where the points of a pair are at the start of a step (end: 0), or at its end (1). */
void sc_step_candidates_positions(const sc_worker *w, int kind, const sc_pair *pair,
                                  const uint32_t point[4], int end, double at[4][3]);

/* Stages, see query/lists.h: the narrow phase of pairs, or, if candidates are wanted, these. */
void sc_step_candidates_take_faces(sc_worker *w, uint32_t most);
void sc_step_candidates_take_edges(sc_worker *w, uint32_t most);

#endif
