/*
 * Pairs of triangles whose boxes overlap. See candidates.h.
 *
 * SPDX-License-Identifier: MIT
 *
 * What happens to a pair depends on the vertices it shares. None: it is collected; then many are
 * decided at once, eight at a time, and those of which that is not certain by the exact primitives.
 * One: the same. More: the exact primitives.
 */
#include "query/candidates.h"

#include <string.h>

#include "base/bits.h"
#include "simd/isa.h"
#include "pose/positions.h"
#include "query/filter.h"
#include "query/pairs.h"
#include "query/primitives.h"
#include "query/query_kernels.h"

/* Reports that two triangles meet. */
static void take_triangles(sc_query_state *state, const sc_pair *places)
{
    const uint32_t *id = sc_model_triangle_id(state->model);
    uint32_t a = id[places->a], b = id[places->b];
    sc_pairs_take(state, a < b ? a : b, a < b ? b : a);
}

/* Reports edges that meet the other triangle. */
static void take_edges(sc_query_state *state, const sc_pair *places, unsigned hits)
{
    const uint32_t *id = sc_model_triangle_id(state->model);
    for (; hits; hits &= hits - 1) {
        uint32_t bit = sc_bits_lowest(hits);
        if (bit < 3)
            sc_pairs_take(state, 3 * id[places->a] + bit, id[places->b]);
        else
            sc_pairs_take(state, 3 * id[places->b] + bit - 3, id[places->a]);
    }
}

/* The edges that bear the names of the two triangles' edges. */
static unsigned edges_wanted(const sc_query_state *state, const sc_pair *places)
{
    const uint8_t *owned = sc_model_edge_owned(state->model);
    return (unsigned)owned[places->a] | (unsigned)owned[places->b] << 3;
}

/* Decides a pair alone, exactly. */
static void decide_pair(sc_query_state *state, const sc_pair *places)
{
    const sc_model *model = state->model;
    const uint32_t *triangle = sc_model_triangle(model);
    double copy[2][3][4];
    int proper = state->options.contact == SC_CONTACT_PROPER, k;
    sc_triangle_pair pair;
    if (sc_state_cancelled(state)) return;
    for (k = 0; k < 3; k++) {
        pair.va[k] = triangle[3 * (uint64_t)places->a + (uint64_t)k];
        pair.vb[k] = triangle[3 * (uint64_t)places->b + (uint64_t)k];
        pair.a[k] = sc_positions_at(state->workspace, pair.va[k], copy[0][k]);
        pair.b[k] = sc_positions_at(state->workspace, pair.vb[k], copy[1][k]);
    }
    if (state->options.pairs == SC_PAIRS_EDGE)
        take_edges(state, places,
                   sc_primitives_edge_hits(&pair, proper, edges_wanted(state, places),
                                           &state->stats.exact_fallbacks));
    else if (sc_primitives_triangles_meet(&pair, proper, &state->stats.exact_fallbacks))
        take_triangles(state, places);
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

static int repeats_point(const uint32_t *t)
{
    return t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
}

void sc_candidates_add_neighbors(sc_query_state *state, uint32_t a, uint32_t b)
{
    const uint32_t *triangle = sc_model_triangle(state->model);
    const uint32_t *t = triangle + 3 * (uint64_t)a, *u = triangle + 3 * (uint64_t)b;
    sc_workspace *w = state->workspace;
    uint32_t shared[3] = {0, 0, 0}, previous;
    int count = list_shared(t, u, shared);
    sc_pair pair;
    pair.a = a;
    pair.b = b;
    if (count == 1 && !repeats_point(t) && !repeats_point(u)) {
        w->neighbors[w->neighbor_count++] = pair;
        return;
    }
    /* with two different vertices shared, so does every edge share one */
    if (count >= 2 && shared[0] != shared[1] &&
        (state->options.pairs == SC_PAIRS_EDGE || state->options.contact == SC_CONTACT_PROPER))
        return;
    previous = sc_state_switch(state, sc_state_primitive_task(state));
    state->stats.counts[sc_state_primitive_task(state)]++;
    if (!state->stop) decide_pair(state, &pair);
    sc_state_switch(state, previous);
}

/* Marks the corners that the triangles share. */
static void mark_shared(sc_pair_lanes *lanes)
{
    uint32_t j;
    int i, k;
    memset(lanes->shared, 0, sizeof lanes->shared);
    for (j = 0; j < SC_PAIR_LANES; j++) {
        const uint32_t *a = lanes->triangle + 3 * (uint64_t)lanes->pairs[j].a;
        const uint32_t *b = lanes->triangle + 3 * (uint64_t)lanes->pairs[j].b;
        for (i = 0; i < 3; i++)
            for (k = 0; k < 3; k++)
                if (a[i] == b[k]) {
                    lanes->shared[0][i] |= 1u << j;
                    lanes->shared[1][k] |= 1u << j;
                }
    }
}

/* What a verdict says of a lane, as bits for the edges. */
static unsigned edges_of_lane(uint64_t lanes, uint32_t j)
{
    unsigned edges = 0;
    int k;
    for (k = 0; k < 6; k++) edges |= (unsigned)(lanes >> (8 * k + (int)j) & 1u) << k;
    return edges;
}

/* The lanes that it says anything of. */
static unsigned lanes_of(uint64_t lanes)
{
    lanes |= lanes >> 32;
    lanes |= lanes >> 16;
    return (unsigned)(lanes | lanes >> 8) & ((1u << SC_PAIR_LANES) - 1u);
}

/* All edges of some lanes. */
static uint64_t edges_of(unsigned lanes)
{
    return lanes * (uint64_t)0x010101010101;
}

/* Decides a pair alone, of which not all is certain. */
static void conclude(sc_query_state *state, const sc_pair *places, unsigned meets, unsigned unsure)
{
    if (state->options.pairs == SC_PAIRS_EDGE) {
        unsigned wanted = edges_wanted(state, places);
        if (unsure & wanted)
            decide_pair(state, places);
        else
            take_edges(state, places, meets & wanted);
    } else if (meets) {
        take_triangles(state, places);
    } else {
        decide_pair(state, places);
    }
}

/* Bit 8 k + i from bit 8 i + k. */
static uint64_t turn_bits(uint64_t x)
{
    uint64_t t = (x ^ x >> 7) & 0x00aa00aa00aa00aau;
    x ^= t ^ t << 7;
    t = (x ^ x >> 14) & 0x0000cccc0000ccccu;
    x ^= t ^ t << 14;
    t = (x ^ x >> 28) & 0x00000000f0f0f0f0u;
    return x ^ t ^ t << 28;
}

/* Of some lanes the edges that bear their names, bit 8 i + k for pair i. */
static uint64_t wanted_of_lanes(const sc_query_state *state, const sc_pair *pairs)
{
    uint64_t wanted = 0;
    int i;
    for (i = 0; i < SC_PAIR_LANES; i++)
        wanted |= (uint64_t)edges_wanted(state, &pairs[i]) << SC_PAIR_LANES * i;
    return wanted;
}

/* Reports what meets in some lanes. */
static void take_lanes(sc_query_state *state, const sc_pair *pairs, uint64_t meets)
{
    const uint32_t *id = sc_model_triangle_id(state->model);
    sc_pair found[6 * SC_PAIR_LANES];
    uint32_t count = 0;
    if (state->options.pairs == SC_PAIRS_EDGE) {
        meets &= turn_bits(wanted_of_lanes(state, pairs));
        if (sc_pairs_are_counted(state)) {
            state->count += sc_bits_count64(meets);
            return;
        }
        for (; meets; meets &= meets - 1) {
            uint32_t bit = sc_bits_lowest64(meets), k = bit / SC_PAIR_LANES;
            sc_pair pair = pairs[bit % SC_PAIR_LANES];
            uint32_t mine = k < 3 ? pair.a : pair.b, other = k < 3 ? pair.b : pair.a;
            k -= k < 3 ? 0 : 3;
            found[count].a = 3 * id[mine] + k;
            found[count++].b = id[other];
        }
    } else {
        unsigned lanes = lanes_of(meets);
        for (; lanes; lanes &= lanes - 1) {
            sc_pair pair = pairs[sc_bits_lowest(lanes)];
            uint32_t a = id[pair.a], b = id[pair.b];
            found[count].a = a < b ? a : b;
            found[count++].b = a < b ? b : a;
        }
    }
    sc_pairs_take_all(state, found, count);
}

/* Asks for what is read of two triangles. */
static inline void fetch_triangles(const sc_model *model, const sc_pair *pair)
{
    const uint32_t *triangle = sc_model_triangle(model), *id = sc_model_triangle_id(model);
    const uint8_t *owned = sc_model_edge_owned(model);
    sc_fetch(triangle + 3 * (uint64_t)pair->a);
    sc_fetch(triangle + 3 * (uint64_t)pair->b);
    sc_fetch(id + pair->a);
    sc_fetch(id + pair->b);
    sc_fetch(owned + pair->a);
    sc_fetch(owned + pair->b);
}

/* Decides pairs that share nothing, or one point each. */
static void decide_all(sc_query_state *state, const sc_pair *pairs, uint32_t count, int share)
{
    const sc_workspace *w = state->workspace;
    sc_pair last[SC_PAIR_LANES];
    sc_pair_lanes lanes;
    uint32_t i, j;
    lanes.triangle = sc_model_triangle(state->model);
    lanes.positions = w->positions;
    lanes.stride = w->stride;
    lanes.floats = w->position_type == SC_FLOAT;
    lanes.proper = state->options.contact == SC_CONTACT_PROPER;
    lanes.shares = share;
    memset(lanes.shared, 0, sizeof lanes.shared);
    state->stats.counts[sc_state_primitive_task(state)] += count;
    for (i = 0; i < count && !sc_state_cancelled(state); i += SC_PAIR_LANES) {
        sc_verdict verdict;
        unsigned some = (1u << SC_PAIR_LANES) - 1u, open;
        lanes.pairs = pairs + i;
        for (j = i + SC_PAIR_LANES; j < i + 2 * SC_PAIR_LANES && j < count; j++)
            fetch_triangles(state->model, pairs + j);
        if (count - i < SC_PAIR_LANES) {
            for (j = 0; j < SC_PAIR_LANES; j++) last[j] = pairs[i + j < count ? i + j : count - 1];
            lanes.pairs = last;
            some = (1u << (count - i)) - 1u;
        }
        if (share) mark_shared(&lanes);
        w->kernels->query->decide(&lanes, &verdict);
        open = lanes_of(verdict.unsure) & some;
        if (verdict.meets) take_lanes(state, lanes.pairs, verdict.meets & edges_of(some & ~open));
        for (; open && !state->stop; open &= open - 1) {
            j = sc_bits_lowest(open);
            conclude(state, &lanes.pairs[j], edges_of_lane(verdict.meets, j),
                     edges_of_lane(verdict.unsure, j));
        }
    }
}

/* Decides what has been collected of triangles. */
static void decide_collected(sc_query_state *state)
{
    sc_workspace *w = state->workspace;
    uint32_t previous;
    if (state->sifts) sc_filter_sift(state);
    if (!w->candidate_count && !w->neighbor_count) return;
    previous = sc_state_switch(state, sc_state_primitive_task(state));
    decide_all(state, w->candidates, w->candidate_count, 0);
    decide_all(state, w->neighbors, w->neighbor_count, 1);
    w->candidate_count = w->neighbor_count = 0;
    sc_state_switch(state, previous);
}

void sc_candidates_decide(sc_query_state *state)
{
    uint32_t previous = sc_state_switch(state, sc_state_box_task(state));
    if (state->workspace->near_count || state->workspace->far_count)
        state->workspace->kernels->query->leaf_pairs(state);
    sc_state_switch(state, previous);
    decide_collected(state);
}

void sc_candidates_make_room(sc_query_state *state)
{
    /* up to SC_LEAF_MAX places are written to behind the last pair */
    const int soon = sc_state_may_end_early(state);
    const uint32_t most = soon ? 64 : SC_CANDIDATES_MAX - SC_LEAF_MAX * (SC_LEAF_MAX + 1);
    const sc_workspace *w = state->workspace;
    if (w->candidate_count >= most || w->neighbor_count >= most) decide_collected(state);
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

void sc_candidates_enter(sc_query_state *state, uint32_t a, uint32_t b, uint32_t shared,
                         sc_leaf_pair *p)
{
    static const uint16_t nothing[SC_LEAF_MAX] = {0};
    const sc_model *model = state->model;
    p->a = a;
    p->b = b;
    p->shared = nothing;
    p->wanted = !state->drops_neighbors;
    p->list = NULL;
    if (sc_model_share_crowded(model)[a] & sc_model_share_crowded(model)[b]) {
        find_shared(model, p);
    } else if (a == b) {
        sc_sharing_unfold(sc_model_share_own_rows(model) + SC_OWN_WORDS * (uint64_t)a, p->found);
        p->shared = p->found;
    } else if (shared != SC_NONE) {
        p->list = sc_model_share_list(model) + sc_model_share_begin(model)[shared];
        p->list_end = sc_model_share_list(model) + sc_model_share_begin(model)[shared + 1];
    }
    p->shares = p->list || p->shared != nothing;
}
