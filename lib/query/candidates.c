/*
 * Pairs of triangles whose boxes overlap. See candidates.h.
 *
 * SPDX-License-Identifier: MIT
 *
 * What happens to a pair depends on the vertices it shares. None: it is collected; then a test of all
 * vertices against both planes, eight pairs at a time, for flat pairs another along their sides, then the
 * exact primitives. One or more: nothing if the fan round a shared vertex projects one to one, else the
 * exact primitives.
 */
#include "query/candidates.h"

#include <math.h>

#include "base/bits.h"
#include "pose/fan.h"
#include "query/filter.h"
#include "query/pairs.h"
#include "query/primitives.h"
#include "query/query_kernels.h"

/*
 * Whether a direction in the plane of one of two triangles, across one of its sides, certainly
 * separates them. Any direction m will do, so the rounding of m does not matter; m . (p - a) collects
 * one difference, one product and two additions: 5 * 2^-53 |m|1 |p - a|max is more. This spares flat
 * regions the exact primitives, which are slow there.
 */
static int side_separates(const sc_pair_lanes *lanes, unsigned lane)
{
    const double relative = 5 * 1.1102230246251565e-16, absolute = 1e-290;
    double x[2][3][3];
    int s, k, i, c;
    for (s = 0; s < 2; s++)
        for (k = 0; k < 3; k++)
            for (c = 0; c < 3; c++) x[s][k][c] = lanes->corner[s][k][c][lane];
    for (s = 0; s < 2; s++) {
        double(*t)[3] = x[s], (*o)[3] = x[1 - s];
        double e[3][3], n[3];
        for (k = 0; k < 3; k++)
            for (c = 0; c < 3; c++) e[k][c] = t[(k + 1) % 3][c] - t[k][c];
        for (c = 0; c < 3; c++)
            n[c] = e[0][(c + 1) % 3] * e[1][(c + 2) % 3] - e[0][(c + 2) % 3] * e[1][(c + 1) % 3];
        for (k = 0; k < 3; k++) {
            double m[3], own = HUGE_VAL, other = -HUGE_VAL, reach = 0, bound;
            for (c = 0; c < 3; c++)
                m[c] = n[(c + 1) % 3] * e[k][(c + 2) % 3] - n[(c + 2) % 3] * e[k][(c + 1) % 3];
            for (i = 0; i < 6; i++) {
                const double *p = i < 3 ? t[i] : o[i - 3];
                double d0 = p[0] - t[k][0], d1 = p[1] - t[k][1], d2 = p[2] - t[k][2];
                double along = m[0] * d0 + m[1] * d1 + m[2] * d2;
                if (along != along) return 0;
                if (fabs(d0) > reach) reach = fabs(d0);
                if (fabs(d1) > reach) reach = fabs(d1);
                if (fabs(d2) > reach) reach = fabs(d2);
                if (i < 3)
                    own = along < own ? along : own;
                else
                    other = along > other ? along : other;
            }
            bound =
                relative * (fabs(m[0]) + fabs(m[1]) + fabs(m[2])) * reach + absolute * (1 + reach);
            if (own - other > 2.0001 * bound) return 1;
        }
    }
    return 0;
}

static void decide_pair(sc_query_state *state, const sc_pair *places)
{
    const sc_model *model = state->model;
    const uint32_t *triangle = sc_model_triangle(model), *id = sc_model_triangle_id(model);
    const double *position = state->workspace->position;
    int proper = state->options.contact == SC_CONTACT_PROPER, k;
    sc_triangle_pair pair;
    if (sc_state_cancelled(state)) return;
    for (k = 0; k < 3; k++) {
        pair.va[k] = triangle[3 * (uint64_t)places->a + (uint64_t)k];
        pair.vb[k] = triangle[3 * (uint64_t)places->b + (uint64_t)k];
        pair.a[k] = position + 3 * (uint64_t)pair.va[k];
        pair.b[k] = position + 3 * (uint64_t)pair.vb[k];
    }
    if (state->options.pairs == SC_PAIRS_EDGE) {
        const uint8_t *owned = sc_model_edge_owned(model);
        unsigned edges = (unsigned)owned[places->a] | (unsigned)owned[places->b] << 3, hits;
        hits = sc_primitives_edge_hits(&pair, proper, edges, &state->stats.exact_fallbacks);
        for (; hits; hits &= hits - 1) {
            uint32_t bit = sc_bits_lowest(hits);
            if (bit < 3)
                sc_pairs_take(state, 3 * id[places->a] + bit, id[places->b]);
            else
                sc_pairs_take(state, 3 * id[places->b] + bit - 3, id[places->a]);
        }
    } else if (sc_primitives_triangles_meet(&pair, proper, &state->stats.exact_fallbacks)) {
        uint32_t a = id[places->a], b = id[places->b];
        sc_pairs_take(state, a < b ? a : b, a < b ? b : a);
    }
}

/* Lists the vertices that two triangles share; returns how many. */
static int list_shared(const uint32_t *a, const uint32_t *b, uint32_t shared[3])
{
    int i, count = 0;
    for (i = 0; i < 3; i++) {
        shared[count] = a[i];
        count += (a[i] == b[0]) | (a[i] == b[1]) | (a[i] == b[2]);
    }
    return count;
}

/* Whether two triangles that share vertices can have anything to report. */
static int neighbors_matter(sc_query_state *state, const uint32_t *a, const uint32_t *b)
{
    uint32_t shared[3] = {0, 0, 0};
    int i, count = list_shared(a, b, shared);
    /* with two different vertices shared, so does every edge share one */
    if (count >= 2 && shared[0] != shared[1] &&
        (state->options.pairs == SC_PAIRS_EDGE || state->options.contact == SC_CONTACT_PROPER))
        return 0;
    for (i = 0; i < count; i++)
        if (sc_fan_is_plain(state->model, state->workspace, shared[i])) return 0;
    return 1;
}

/* A triangle and some of a leaf cluster that share vertices with it. */
static void decide_neighbors(sc_query_state *state, uint32_t a, uint32_t first_b, unsigned mask)
{
    const uint32_t *triangle = sc_model_triangle(state->model);
    uint32_t previous = sc_state_switch(state, sc_state_primitive_task(state));
    for (; mask && !state->stop; mask &= mask - 1) {
        sc_pair pair;
        state->stats.counts[sc_state_primitive_task(state)]++;
        pair.a = a;
        pair.b = first_b + sc_bits_lowest(mask);
        if (neighbors_matter(state, triangle + 3 * (uint64_t)pair.a,
                             triangle + 3 * (uint64_t)pair.b))
            decide_pair(state, &pair);
    }
    sc_state_switch(state, previous);
}

void sc_candidates_decide(sc_query_state *state)
{
    const uint32_t *triangle = sc_model_triangle(state->model);
    sc_workspace *w = state->workspace;
    const double *position = w->position;
    uint32_t i, j, count, previous;
    int s, k, c;
    if (state->sifts) sc_filter_sift(state);
    count = w->candidate_count;
    if (!count) return;
    previous = sc_state_switch(state, sc_state_primitive_task(state));
    state->stats.counts[sc_state_primitive_task(state)] += count;
    for (i = 0; i < count && !state->stop; i += SC_PAIR_LANES) {
        sc_pair_lanes x;
        sc_plane_test planes;
        unsigned rest;
        for (j = 0; j < SC_PAIR_LANES; j++) { /* the last pair fills the row */
            const sc_pair *pair = &w->candidates[i + j < count ? i + j : count - 1];
            for (s = 0; s < 2; s++)
                for (k = 0; k < 3; k++) {
                    uint64_t corner = 3 * (uint64_t)(s ? pair->b : pair->a) + (uint64_t)k;
                    const double *p = position + 3 * (uint64_t)triangle[corner];
                    for (c = 0; c < 3; c++) x.corner[s][k][c][j] = p[c];
                }
        }
        planes = sc_query_kernels_of(w)->test_planes(&x);
        rest = ~planes.apart & ((1u << SC_PAIR_LANES) - 1u);
        if (count - i < SC_PAIR_LANES) rest &= (1u << (count - i)) - 1u;
        for (; rest && !state->stop; rest &= rest - 1) {
            unsigned lane = sc_bits_lowest(rest);
            if ((planes.flat >> lane & 1u) && side_separates(&x, lane)) continue;
            decide_pair(state, &w->candidates[i + lane]);
        }
    }
    w->candidate_count = 0;
    sc_state_switch(state, previous);
}

/* Collected pairs are decided when there are this many: fewer if the first hit ends the query. */
static uint32_t batch_size(const sc_query_state *state)
{
    return state->options.output == SC_OUTPUT_ANY ? 64 : SC_CANDIDATES_MAX - SC_LEAF_MAX;
}

static void collect_row(sc_query_state *state, uint32_t a, uint32_t first_b, unsigned mask)
{
    sc_workspace *w = state->workspace;
    while (mask) {
        sc_pair *candidate = &w->candidates[w->candidate_count++];
        candidate->a = a;
        candidate->b = first_b + sc_bits_lowest(mask);
        mask &= mask - 1;
    }
    if (w->candidate_count >= batch_size(state)) sc_candidates_decide(state);
}

/* Whether two triangles share a vertex, without branches. */
static inline unsigned share_any(const uint32_t *a, const uint32_t *b)
{
    return (unsigned)((a[0] == b[0]) | (a[0] == b[1]) | (a[0] == b[2]) | (a[1] == b[0]) |
                      (a[1] == b[1]) | (a[1] == b[2]) | (a[2] == b[0]) | (a[2] == b[1]) |
                      (a[2] == b[2]));
}

/* The masks of two clusters that have points of so many triangles that the model has none. */
static void find_shared(const sc_model *model, sc_leaf_pair *p)
{
    const uint32_t *triangle = sc_model_triangle(model), *first = sc_model_leaf_first(model);
    uint32_t i, j;
    for (i = first[p->a]; i < first[p->a + 1]; i++) {
        uint16_t *row = &p->found[i - first[p->a]];
        for (j = first[p->b], *row = 0; j < first[p->b + 1]; j++)
            *row |= (uint16_t)(share_any(triangle + 3 * (uint64_t)i, triangle + 3 * (uint64_t)j)
                               << (j - first[p->b]));
    }
    p->shared = p->found;
}

void sc_candidates_enter(sc_query_state *state, uint32_t a, uint32_t b, sc_leaf_pair *p)
{
    static const uint16_t nothing[SC_LEAF_MAX] = {0};
    const sc_model *model = state->model;
    const uint32_t *first = sc_model_share_first(model), *leaf = sc_model_share_leaf(model);
    uint32_t i;
    p->a = a;
    p->b = b;
    p->shared = nothing;
    p->plain_a = p->plain_b = 0;
    if (sc_model_share_crowded(model)[a] & sc_model_share_crowded(model)[b])
        find_shared(model, p);
    else if (a == b)
        p->shared = sc_model_share_own_rows(model) + SC_LEAF_MAX * (uint64_t)a;
    else
        for (i = first[a]; i < first[a + 1] && leaf[i] <= b; i++)
            if (leaf[i] == b) p->shared = sc_model_share_rows(model) + SC_LEAF_MAX * (uint64_t)i;
    if (p->shared == nothing) return;
    if (state->drops_neighbors) {
        p->plain_a = (1u << SC_LEAF_MAX) - 1u; /* as good as plain */
        return;
    }
    p->plain_a = sc_fan_plain_of_leaf(model, state->workspace, a);
    p->plain_b = sc_fan_plain_of_leaf(model, state->workspace, b);
}

void sc_candidates_take(sc_query_state *state, const sc_leaf_pair *p, uint32_t i, unsigned mask)
{
    const uint32_t *first = sc_model_leaf_first(state->model);
    unsigned shared = mask & p->shared[i];
    if (shared) decide_neighbors(state, first[p->a] + i, first[p->b], shared);
    if (mask & ~shared) collect_row(state, first[p->a] + i, first[p->b], mask & ~shared);
}
