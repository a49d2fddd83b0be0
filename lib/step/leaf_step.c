/*
 * Leaf clusters in a step. See leaf_step.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "step/leaf_step.h"

#include <math.h>

#include "base/bits.h"

/* Encloses some points at both times; where swept, in the box of both. */
static void enclose(const sc_motion *m, const uint32_t *point, int count, float *side,
                    uint32_t stride)
{
    float low[6], high[6];
    int i, k;
    for (k = 0; k < 6; k++) {
        low[k] = HUGE_VALF;
        high[k] = -HUGE_VALF;
    }
    for (i = 0; i < count; i++) {
        const float *unit = m->unit + 8 * (uint64_t)point[i];
        for (k = 0; k < 6; k++) {
            float x = unit[k < 3 ? k : k + 1];
            low[k] = x < low[k] ? x : low[k];
            high[k] = x > high[k] ? x : high[k];
        }
    }
    for (k = 0; k < 3; k++) {
        int end = k + 3;
        if (m->swept) {
            low[k] = low[end] = low[k] < low[end] ? low[k] : low[end];
            high[k] = high[end] = high[k] > high[end] ? high[k] : high[end];
        }
        side[(SC_START_LOW + k) * (int)stride] = low[k];
        side[(SC_START_HIGH + k) * (int)stride] = high[k];
        side[(SC_END_LOW + k) * (int)stride] = low[end];
        side[(SC_END_HIGH + k) * (int)stride] = high[end];
    }
}

static void fill(const sc_model *model, const sc_motion *m, uint32_t leaf, sc_leaf_motion *to)
{
    const uint32_t *corner = sc_model_triangle(model), *first = sc_model_leaf_first(model);
    const uint8_t *owned = sc_model_edge_owned(model);
    uint32_t i, place;
    uint64_t own;
    int k;
    to->leaf = leaf;
    to->first_place = first[leaf];
    to->triangles = first[leaf + 1] - first[leaf];
    to->points = 0;
    to->edges = 0;
    for (place = first[leaf], i = 0; place < first[leaf + 1]; place++, i++) {
        const uint32_t *c = corner + 3 * (uint64_t)place;
        enclose(m, c, 3, &to->triangle_side[0][i], SC_LEAF_MAX);
        for (k = 0; k < 3; k++) {
            uint32_t e = to->edges;
            if (!(owned[place] >> k & 1)) continue;
            to->edge_end[e][0] = c[k];
            to->edge_end[e][1] = c[(k + 1) % 3];
            to->edge_name[e] = 3 * place + (uint32_t)k;
            enclose(m, to->edge_end[e], 2, &to->edge_side[0][e], SC_LEAF_EDGES);
            to->edges++;
        }
    }
    for (own = m->own_points[leaf]; own; own &= own - 1) {
        uint32_t n = to->points++;
        to->point[n] =
            sc_model_leaf_point(model)[SC_LEAF_POINTS * (uint64_t)leaf + sc_bits_lowest64(own)];
        enclose(m, &to->point[n], 1, &to->point_side[0][n], SC_LEAF_POINTS);
    }
}

const sc_leaf_motion *sc_leaf_step_get(sc_step_state *state, uint32_t leaf, int way)
{
    sc_motion *m = &state->query.workspace->motion;
    sc_leaf_motion *kept = &m->leaves[2 * (leaf % SC_LEAVES_KEPT) + (uint32_t)way];
    if (kept->leaf != leaf) fill(state->query.model, m, leaf, kept);
    return kept;
}

void sc_leaf_step_reset(sc_motion *m)
{
    uint32_t i;
    for (i = 0; i < 2 * SC_LEAVES_KEPT; i++) m->leaves[i].leaf = SC_NONE;
}
