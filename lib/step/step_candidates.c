/*
 * Pairs that may collide. See step_candidates.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "step/step_candidates.h"

#include "pose/positions.h"
#include "step/step_pairs.h"

sc_pair sc_step_candidates_name(const sc_model *model, int kind, const sc_pair *pair)
{
    const uint32_t *id = sc_model_triangle_id(model);
    sc_pair name;
    if (kind == SC_STEP_VERTEX_FACE) {
        name.a = pair->a;
        name.b = id[pair->b];
    } else {
        name.a = 3 * id[pair->a / 3] + pair->a % 3;
        name.b = 3 * id[pair->b / 3] + pair->b % 3;
    }
    return name;
}

/* The answer must not depend on which of two edges was found first: the one with the lower name is
   put first. */
static sc_pair put_in_order(const sc_model *model, int kind, sc_pair pair, sc_pair *name)
{
    *name = sc_step_candidates_name(model, kind, &pair);
    if (kind == SC_STEP_EDGE_EDGE && name->a > name->b) {
        uint32_t t = name->a;
        name->a = name->b;
        name->b = t;
        t = pair.a;
        pair.a = pair.b;
        pair.b = t;
    }
    return pair;
}

/* Decides a pair, or takes it, if candidates are wanted. */
static void take_moving(sc_worker *w, int kind, sc_pair pair)
{
    const sc_positions *positions = w->frame->positions;
    const sc_impact_limits *limits = &w->step->question->limits;
    double start[4][3], end[4][3], time = 0;
    const double(*from)[3] = (const double(*)[3])start, (*to)[3] = (const double(*)[3])end;
    uint32_t point[4], k;
    sc_pair name;
    pair = put_in_order(w->model, kind, pair, &name);
    if (w->step->question->options.pairs == SC_STEP_COLLISIONS) {
        sc_step_candidates_points(w->model, kind, &pair, point);
        for (k = 0; k < 4; k++) {
            sc_positions_get(&positions[0], point[k], start[k]);
            sc_positions_get(&positions[1], point[k], end[k]);
        }
        if (!(kind == SC_STEP_VERTEX_FACE ? sc_impact_vertex_face(from, to, limits, &time)
                                          : sc_impact_edge_edge(from, to, limits, &time)))
            return;
    }
    sc_step_pairs_take(w, kind, name.a, name.b, time);
}

void sc_step_candidates_take_faces(sc_worker *w, uint32_t most)
{
    uint32_t *left = &w->lists.count[SC_LIST_FACES];
    for (; most && *left && !w->stop; most--)
        take_moving(w, SC_STEP_VERTEX_FACE, w->lists.moving[0][--*left]);
}

void sc_step_candidates_take_edges(sc_worker *w, uint32_t most)
{
    uint32_t *left = &w->lists.count[SC_LIST_EDGES];
    for (; most && *left && !w->stop; most--)
        take_moving(w, SC_STEP_EDGE_EDGE, w->lists.moving[1][--*left]);
}
