/*
 * Pairs that may be near. See near_candidates.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "near/near_candidates.h"

#include <float.h>

#include "base/atomic.h"
#include "base/bounds.h"
#include "near/stencil.h"
#include "step/step_candidates.h"
#include "step/step_filter.h"
#include "step/step_pairs.h"
#include "step/within.h"

int sc_near_candidates_want_names(const sc_question *question)
{
    const sc_pair_filters *f = &question->near->step.filters;
    return question->options.output != SC_OUTPUT_COUNT || f->sifts[0] || f->sifts[1] ||
           f->asks[0] || f->asks[1] || question->near->bounds;
}

int sc_near_candidates_are_asked(const sc_worker *w, int kind)
{
    const sc_pair_filters *f = &w->step->question->filters;
    return f->sifts[kind] || f->asks[kind] || w->question->near->bounds;
}

void sc_near_candidates_set_bounds(const sc_near_question *question, uint32_t vertices,
                                   double bound)
{
    uint32_t v;
    for (v = 0; question->bounds && v < vertices; v++) question->bounds[v] = bound;
}

int sc_near_candidates_need_one_worker(const sc_near_question *question)
{
    const sc_pair_filters *f = &question->step.filters;
    return question->bounds && (!SC_ATOMIC_DOUBLES || f->of[0].accept || f->of[1].accept);
}

/* The distance of a pair, rounded down. That of a stencil may be infinite by its rounding alone, as
   the pair is near. Below 2^-1021 the difference is exact; above, it rounds by less than what the
   product leaves. */
static double find_bound(const sc_worker *w, int kind, const sc_pair *pair, const uint32_t point[4])
{
    double at[4][3], bound;
    const double *const points[4] = {at[0], at[1], at[2], at[3]};
    sc_near_stencil stencil;
    sc_step_candidates_positions(w, kind, pair, point, 0, at);
    sc_stencil_find(kind == SC_STEP_VERTEX_FACE ? SC_NEAR_VERTEX_FACE : SC_NEAR_EDGE_EDGE, points,
                    &stencil);
    bound = stencil.distance < DBL_MAX ? stencil.distance : DBL_MAX;
    bound = bound * (1 - SC_BOUNDS_STENCIL) - SC_BOUNDS_STENCIL_LEAST;
    return bound > 0 ? bound : 0;
}

/* Lowers the bounds of the four vertices of a pair. */
static void lower_bounds(const sc_worker *w, int kind, const sc_pair *pair, const uint32_t point[4],
                         double bound)
{
    double *bounds = w->question->near->bounds;
    int k;
    if (bound < 0) bound = find_bound(w, kind, pair, point);
    for (k = 0; k < 4; k++) {
        if (w->share)
            sc_atomic_lessen(&bounds[point[k]], bound);
        else if (bound < bounds[point[k]])
            bounds[point[k]] = bound;
    }
}

void sc_near_candidates_take(sc_worker *w, int kind, sc_pair inner, double bound)
{
    const sc_pair_filters *f = &w->step->question->filters;
    sc_pair name = sc_step_candidates_name(w, kind, &inner);
    uint32_t point[4];
    if (w->stop) return;
    if (sc_step_candidates_turn(w, kind, name)) {
        const uint32_t t = name.a;
        name.a = name.b;
        name.b = t;
    }
    sc_step_candidates_points(w, kind, &inner, point);
    if (f->sifts[kind]) {
        if (!sc_step_filter_admits(w, kind, inner, point, name)) return;
    }
    if (f->asks[kind] && !sc_step_filter_accepts(w, kind, name)) return;
    if (w->question->near->bounds) lower_bounds(w, kind, &inner, point, bound);
    sc_step_pairs_take(w, kind, name.a, name.b, 0);
}

static int is_near_enough(const sc_worker *w, int kind, const sc_pair *pair)
{
    const double distance = w->question->near->options.distance;
    double at[4][3];
    const double(*from)[3] = (const double(*)[3])at;
    uint32_t point[4];
    sc_step_candidates_points(w, kind, pair, point);
    sc_step_candidates_positions(w, kind, pair, point, 0, at);
    return kind == SC_STEP_VERTEX_FACE ? sc_within_vertex_face(from, distance)
                                       : sc_within_edge_edge(from, distance);
}

void sc_near_candidates_decide(sc_worker *w, int kind, sc_pair inner, int is_near)
{
    if (!is_near && !is_near_enough(w, kind, &inner)) return;
    if (sc_near_candidates_want_names(w->question))
        sc_near_candidates_take(w, kind, inner, -1);
    else
        sc_step_pairs_take(w, kind, inner.a, inner.b, 0); /* counts it */
}
