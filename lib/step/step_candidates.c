/*
 * Pairs that may collide. See step_candidates.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "step/step_candidates.h"

#include "pose/positions.h"
#include "step/step_filter.h"
#include "step/step_pairs.h"

sc_pair sc_step_candidates_name(const sc_worker *w, int kind, const sc_pair *pair)
{
    const sc_pair_sides sides = sc_step_candidates_sides(w, kind, pair);
    const uint32_t *of_a = sc_model_triangle_id(sides.a->model);
    const uint32_t *of_b = sc_model_triangle_id(sides.b->model);
    sc_pair name;
    if (kind == SC_STEP_VERTEX_FACE) {
        name.a = pair->a;
        name.b = of_b[pair->b];
    } else {
        name.a = 3 * of_a[pair->a / 3] + pair->a % 3;
        name.b = 3 * of_b[pair->b / 3] + pair->b % 3;
    }
    return name;
}

void sc_step_candidates_positions(const sc_worker *w, int kind, const sc_pair *pair,
                                  const uint32_t point[4], int end, double at[4][3])
{
    const sc_pair_sides sides = sc_step_candidates_sides(w, kind, pair);
    const uint32_t of_first = sc_step_points_of_first(kind);
    uint32_t k;
    for (k = 0; k < 4; k++) {
        const sc_worker *side = k < of_first ? sides.a : sides.b;
        sc_positions_get(&side->frame->positions[end], point[k], at[k]);
    }
}

static int collides(int kind, const double from[4][3], const double to[4][3],
                    const sc_impact_limits *limits, double *time)
{
    return kind == SC_STEP_VERTEX_FACE ? sc_impact_vertex_face(from, to, limits, time)
                                       : sc_impact_edge_edge(from, to, limits, time);
}

/* Decides a pair, or takes it, if candidates are wanted. */
static void take_moving(sc_worker *w, int kind, sc_pair pair)
{
    const sc_step_question *question = w->step->question;
    double start[4][3], end[4][3], time = 0;
    const double(*from)[3] = (const double(*)[3])start, (*to)[3] = (const double(*)[3])end;
    sc_pair name = sc_step_candidates_name(w, kind, &pair);
    uint32_t point[4], k;
    /* The answer must not depend on which of two edges was found first: the one with the lower
       name is put first. */
    if (sc_step_candidates_turn(w, kind, name)) {
        k = name.a;
        name.a = name.b;
        name.b = k;
        k = pair.a;
        pair.a = pair.b;
        pair.b = k;
    }
    sc_step_candidates_points(w, kind, &pair, point);
    if (question->filters.sifts[kind] && !sc_step_filter_admits(w, kind, pair, point, name)) return;
    if (question->options.pairs == SC_STEP_COLLISIONS) {
        sc_step_candidates_positions(w, kind, &pair, point, 0, start);
        sc_step_candidates_positions(w, kind, &pair, point, 1, end);
        if (!collides(kind, from, to, &question->limits, &time)) return;
        if (question->options.begun == SC_STEP_BEGUN_NEARER) {
            sc_impact_limits own = question->limits;
            own.separation =
                sc_impact_nearer(kind == SC_STEP_EDGE_EDGE, from, to, &question->limits);
            if (own.separation < question->limits.separation &&
                !collides(kind, from, to, &own, &time))
                return;
        }
    }
    if (question->filters.asks[kind] && !sc_step_filter_accepts(w, kind, name)) return;
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
