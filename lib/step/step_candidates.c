/*
 * Pairs that may collide. See step_candidates.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "step/step_candidates.h"

#include "base/bits.h"
#include "step/step_kernels.h"
#include "step/step_motion.h"
#include "step/step_pairs.h"

/* The points of a pair, in the order in which the narrow phase takes them. */
static void points_of_candidate(const sc_model *model, int kind, const sc_pair *pair,
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

/* A pair in the caller's numbers; edges with the lower first. */
static sc_pair name_candidate(const sc_model *model, int kind, const sc_pair *pair)
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
    *name = name_candidate(model, kind, &pair);
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

/* The narrow phase. */
static void decide_candidate(sc_worker *w, int kind, sc_pair pair)
{
    const sc_positions *positions = w->frame->positions;
    double start[4][3], end[4][3], time = 0;
    const double(*from)[3] = (const double(*)[3])start, (*to)[3] = (const double(*)[3])end;
    uint32_t point[4], k;
    sc_pair name;
    if (sc_worker_is_cancelled(w)) return;
    pair = put_in_order(w->model, kind, pair, &name);
    points_of_candidate(w->model, kind, &pair, point);
    for (k = 0; k < 4; k++) {
        sc_positions_get(&positions[0], point[k], start[k]);
        sc_positions_get(&positions[1], point[k], end[k]);
    }
    if (kind == SC_STEP_VERTEX_FACE
            ? sc_impact_vertex_face(from, to, &w->step->question->limits, &time)
            : sc_impact_edge_edge(from, to, &w->step->question->limits, &time))
        sc_step_pairs_take(w, kind, name.a, name.b, time);
}

/* Up to sixteen candidates: most are seen to stay apart all at once. */
static void decide_sixteen(sc_worker *w, int kind, const sc_pair *pairs, uint32_t count)
{
    const sc_step_kernels *kernels = w->frame->kernels->step;
    sc_candidate_points points;
    unsigned left;
    uint32_t i, k, point[4];
    for (i = 0; i < 16; i++) { /* the last one fills the row */
        points_of_candidate(w->model, kind, &pairs[i < count ? i : count - 1], point);
        for (k = 0; k < 4; k++) points.point[k][i] = point[k];
    }
    left = ~kernels->stay_apart(&w->frame->motion, &points, kind == SC_STEP_VERTEX_FACE ? 1 : 2) &
           ((1u << count) - 1u);
    for (; left && !w->stop; left &= left - 1)
        decide_candidate(w, kind, pairs[sc_bits_lowest(left)]);
}

void sc_step_candidates_decide(sc_worker *w)
{
    uint32_t i, previous = sc_worker_switch(w, sc_step_primitive_task(w));
    int kind;
    for (kind = 0; kind < 2; kind++) {
        uint32_t count = w->step->candidate_count[kind];
        const sc_pair *pairs = w->step->candidates[kind];
        w->stats.counts[sc_step_primitive_task(w)] += count;
        if (w->step->question->options.pairs == SC_STEP_COLLISIONS) {
            for (i = 0; i < count && !w->stop; i += 16)
                decide_sixteen(w, kind, pairs + i, count - i < 16 ? count - i : 16);
        } else {
            for (i = 0; i < count && !w->stop; i++) {
                sc_pair name;
                put_in_order(w->model, kind, pairs[i], &name);
                sc_step_pairs_take(w, kind, name.a, name.b, 0);
            }
        }
        w->step->candidate_count[kind] = 0;
    }
    sc_worker_switch(w, previous);
}

void sc_step_candidates_take(sc_worker *w, int kind, uint32_t a, uint32_t b)
{
    sc_pair *to = &w->step->candidates[kind][w->step->candidate_count[kind]];
    to->a = a;
    to->b = b;
    if (++w->step->candidate_count[kind] == SC_STEP_BATCH) sc_step_candidates_decide(w);
}
