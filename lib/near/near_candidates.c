/*
 * Pairs that may be near. See near_candidates.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "near/near_candidates.h"

#include "step/within.h"
#include "pose/positions.h"
#include "step/step_candidates.h"
#include "step/step_filter.h"
#include "step/step_pairs.h"

int sc_near_candidates_want_names(const sc_question *question)
{
    return question->options.output != SC_OUTPUT_COUNT;
}

int sc_near_candidates_are_filtered(const sc_question *question)
{
    const sc_pair_filters *f = &question->step->filters;
    return f->sifts[0] || f->sifts[1] || f->asks[0] || f->asks[1];
}

void sc_near_candidates_take(sc_worker *w, int kind, sc_pair inner, uint32_t a, uint32_t b)
{
    const sc_pair_filters *f = &w->step->question->filters;
    sc_pair name;
    if (kind == SC_STEP_EDGE_EDGE && a > b) {
        const uint32_t t = a;
        a = b;
        b = t;
    }
    name.a = a;
    name.b = b;
    if (f->sifts[kind]) {
        uint32_t point[4];
        sc_step_candidates_points(w->model, kind, &inner, point);
        if (!sc_step_filter_admits(w, kind, inner, point, name)) return;
    }
    if (f->asks[kind] && !sc_step_filter_accepts(w, kind, name)) return;
    sc_step_pairs_take(w, kind, a, b, 0);
}

static int is_near_enough(const sc_worker *w, int kind, const sc_pair *pair)
{
    const double distance = w->question->near->options.distance;
    double at[4][3];
    const double(*from)[3] = (const double(*)[3])at;
    uint32_t point[4], k;
    sc_step_candidates_points(w->model, kind, pair, point);
    for (k = 0; k < 4; k++) sc_positions_get(&w->frame->positions[0], point[k], at[k]);
    return kind == SC_STEP_VERTEX_FACE ? sc_within_vertex_face(from, distance)
                                       : sc_within_edge_edge(from, distance);
}

static void take_open(sc_worker *w, uint32_t most, int kind)
{
    uint32_t *left = &w->lists.count[SC_LIST_FACES + kind];
    for (; most && *left && !w->stop; most--) {
        const sc_pair pair = w->lists.moving[kind][--*left];
        sc_pair name;
        if (!is_near_enough(w, kind, &pair)) continue;
        name = sc_step_candidates_name(w->model, kind, &pair);
        sc_near_candidates_take(w, kind, pair, name.a, name.b);
    }
}

void sc_near_candidates_take_faces(sc_worker *w, uint32_t most)
{
    take_open(w, most, SC_STEP_VERTEX_FACE);
}

void sc_near_candidates_take_edges(sc_worker *w, uint32_t most)
{
    take_open(w, most, SC_STEP_EDGE_EDGE);
}
