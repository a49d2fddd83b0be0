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
static void decide_candidate(sc_step_state *state, int kind, sc_pair pair)
{
    const sc_motion *motion = &state->query.workspace->motion;
    double start[4][3], end[4][3], time = 0;
    const double(*from)[3] = (const double(*)[3])start, (*to)[3] = (const double(*)[3])end;
    uint32_t point[4], k;
    sc_pair name;
    if (sc_state_cancelled(&state->query)) return;
    pair = put_in_order(state->query.model, kind, pair, &name);
    points_of_candidate(state->query.model, kind, &pair, point);
    for (k = 0; k < 4; k++) {
        sc_motion_position(motion, 0, point[k], start[k]);
        sc_motion_position(motion, 1, point[k], end[k]);
    }
    if (kind == SC_STEP_VERTEX_FACE ? sc_impact_vertex_face(from, to, &state->limits, &time)
                                    : sc_impact_edge_edge(from, to, &state->limits, &time))
        sc_step_pairs_take(state, kind, name.a, name.b, time);
}

/* Up to sixteen candidates: most are seen to stay apart all at once. */
static void decide_some(sc_step_state *state, int kind, const sc_pair *pairs, uint32_t count)
{
    const sc_step_kernels *kernels = state->query.workspace->kernels->step;
    sc_candidate_points points;
    unsigned left;
    uint32_t i, k, point[4];
    for (i = 0; i < 16; i++) { /* the last one fills the row */
        points_of_candidate(state->query.model, kind, &pairs[i < count ? i : count - 1], point);
        for (k = 0; k < 4; k++) points.point[k][i] = point[k];
    }
    left = ~kernels->stay_apart(&state->query.workspace->motion, &points,
                                kind == SC_STEP_VERTEX_FACE ? 1 : 2) &
           ((1u << count) - 1u);
    for (; left && !state->query.stop; left &= left - 1)
        decide_candidate(state, kind, pairs[sc_bits_lowest(left)]);
}

void sc_step_candidates_decide(sc_step_state *state)
{
    uint32_t i, previous = sc_state_switch(&state->query, sc_state_primitive_task(&state->query));
    int kind;
    for (kind = 0; kind < 2; kind++) {
        uint32_t count = state->candidate_count[kind];
        const sc_pair *pairs = state->candidates[kind];
        state->query.stats.counts[sc_state_primitive_task(&state->query)] += count;
        if (state->options.pairs == SC_STEP_COLLISIONS) {
            for (i = 0; i < count && !state->query.stop; i += 16)
                decide_some(state, kind, pairs + i, count - i < 16 ? count - i : 16);
        } else {
            for (i = 0; i < count && !state->query.stop; i++) {
                sc_pair name;
                put_in_order(state->query.model, kind, pairs[i], &name);
                sc_step_pairs_take(state, kind, name.a, name.b, 0);
            }
        }
        state->candidate_count[kind] = 0;
    }
    sc_state_switch(&state->query, previous);
}

void sc_step_candidates_take(sc_step_state *state, int kind, uint32_t a, uint32_t b)
{
    sc_pair *to = &state->candidates[kind][state->candidate_count[kind]];
    to->a = a;
    to->b = b;
    if (++state->candidate_count[kind] == SC_STEP_BATCH) sc_step_candidates_decide(state);
}
