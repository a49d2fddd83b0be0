/*
 * Pairs of triangles whose boxes overlap. See candidates.h.
 *
 * SPDX-License-Identifier: MIT
 *
 * What happens to a pair depends on the vertices it shares. None: it is collected; then many are
 * decided at once, eight at a time, and those of which that is not certain by the exact primitives.
 * Of settled ones there is nothing left to do but to see that two edges are in one plane, if it
 * depends on that. One: the same, but nothing if that is not certain and the fan round the shared
 * vertex projects one to one. More: nothing if a fan round one of them does, else the exact
 * primitives.
 */
#include "query/candidates.h"

#include <string.h>

#include "base/bits.h"
#include "simd/isa.h"
#include "pose/fan.h"
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

/* Whether the fan round a vertex that two triangles share projects one to one: then they share all
   that they have in common. */
static int have_plain_fan(sc_query_state *state, const sc_pair *places)
{
    const uint32_t *triangle = sc_model_triangle(state->model);
    uint32_t shared[3];
    int i, count = list_shared(triangle + 3 * (uint64_t)places->a,
                               triangle + 3 * (uint64_t)places->b, shared);
    for (i = 0; i < count; i++)
        if (sc_fan_is_plain(state->model, state->workspace, shared[i])) return 1;
    return 0;
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
    if (!state->stop && !have_plain_fan(state, &pair)) decide_pair(state, &pair);
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

/* Decides a pair alone, unless the fan round what it shares does. */
static void decide_rest(sc_query_state *state, const sc_pair *places, int share)
{
    if (!share || !have_plain_fan(state, places)) decide_pair(state, places);
}

/* Decides a pair alone, of which not all is certain. */
static void conclude(sc_query_state *state, const sc_pair *places, unsigned meets, unsigned unsure,
                     int share)
{
    if (state->options.pairs == SC_PAIRS_EDGE) {
        unsigned wanted = edges_wanted(state, places);
        if (unsure & wanted)
            decide_rest(state, places, share);
        else
            take_edges(state, places, meets & wanted);
    } else if (meets) {
        take_triangles(state, places);
    } else {
        decide_rest(state, places, share);
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
                     edges_of_lane(verdict.unsure, j), share);
        }
    }
}

/* The bits of a coordinate. */
static inline uint64_t bits_of(const unsigned char *from, int is_double)
{
    uint64_t whole;
    uint32_t half;
    if (is_double) {
        memcpy(&whole, from, sizeof whole);
        return whole;
    }
    memcpy(&half, from, sizeof half);
    return half;
}

/* Of a triangle whose tip is named as in the code of a settled pair, bits of the edges that meet
   the other triangle, if that from the tip to the next corner does, and that to the one after. Then
   of both triangles by the lowest eight bits of such a code: those edges meet the other triangle
   that pass two edges of it on different sides. */
#define SC_TIP_EDGES(tip, next, after) ((next) << ((tip) + 2) % 3 | (after) << ((tip) + 1) % 3)
#define SC_DIFFER(code, i, j)                                                                      \
  (((code) >> (SC_SETTLED_BELOW + (i)) ^ (code) >> (SC_SETTLED_BELOW + (j))) & 1)
#define SC_CODE_EDGES(code)                                                                        \
  (SC_TIP_EDGES((code)&3, SC_DIFFER(code, 0, 1), SC_DIFFER(code, 2, 3)) |                          \
   SC_TIP_EDGES((code) >> 2 & 3, SC_DIFFER(code, 0, 2), SC_DIFFER(code, 1, 3)) << 3)
#define SC_CODES_4(code)                                                                           \
  SC_CODE_EDGES(code), SC_CODE_EDGES((code) + 1), SC_CODE_EDGES((code) + 2),                       \
      SC_CODE_EDGES((code) + 3)
#define SC_CODES_16(code)                                                                          \
  SC_CODES_4(code), SC_CODES_4((code) + 4), SC_CODES_4((code) + 8), SC_CODES_4((code) + 12)
#define SC_CODES_64(code)                                                                          \
  SC_CODES_16(code), SC_CODES_16((code) + 16), SC_CODES_16((code) + 32), SC_CODES_16((code) + 48)
static const uint8_t settled_edges[256] = {SC_CODES_64(0), SC_CODES_64(64), SC_CODES_64(128),
                                           SC_CODES_64(192)};

/* Where numbers of four bits have that of the edge of the first triangle, or of the second, that is
   not certain, if any: by its tip and whether it goes to the next corner. */
static inline unsigned level_edge(unsigned code, int second)
{
    return 4 * (second ? (code >> 2 & 3u) | (code >> (SC_SETTLED_COLUMN - 2) & 4u)
                       : (code & 3u) | (code >> (SC_SETTLED_ROW - 2) & 4u));
}

/* Whether these are in a plane across the axis that the code names. */
static inline unsigned is_level(const sc_workspace *w, const uint32_t *t, const uint32_t *u,
                                unsigned code)
{
    const uint32_t ends = 0x49428186u; /* the corners from and to which such an edge runs */
    const unsigned k = ends >> level_edge(code, 0), i = ends >> level_edge(code, 1);
    const int is_double = w->position_type == SC_DOUBLE;
    const unsigned char *from =
        w->positions + (is_double ? sizeof(double) : sizeof(float)) * (code >> SC_SETTLED_AXIS);
    const uint64_t level = bits_of(from + w->stride * t[k & 3u], is_double);
    return level == bits_of(from + w->stride * t[k >> 2 & 3u], is_double) &&
           level == bits_of(from + w->stride * u[i & 3u], is_double) &&
           level == bits_of(from + w->stride * u[i >> 2 & 3u], is_double);
}

/* Which edges of such a pair meet the other triangle: those two if touching is asked for, all bits
   or none. */
static inline unsigned level_edges(unsigned code, unsigned touching)
{
    const uint32_t bits = 0x02140142u; /* of such an edge */
    const unsigned first = bits >> level_edge(code, 0) & 7u,
                   second = bits >> level_edge(code, 1) & 7u;
    const unsigned both = first | second << 3;
    return (settled_edges[code & 255u] & ~both) | (touching & both);
}

/* Writes down what is to be reported if some edges of a pair meet the other triangle. Returns how
   much; room for six. */
static inline uint32_t name_edges(const sc_query_state *state, const sc_pair *pair, unsigned edges,
                                  sc_pair *found)
{
    const uint32_t *id = sc_model_triangle_id(state->model);
    const uint32_t a = id[pair->a], b = id[pair->b];
    uint32_t count = 0, i;
    if (state->options.pairs != SC_PAIRS_EDGE) {
        found->a = a < b ? a : b;
        found->b = a < b ? b : a;
        return edges != 0;
    }
    edges &= edges_wanted(state, pair);
    for (i = 0; i < 2 || edges; i++) { /* seldom more than two: no branch depends on how many */
        const uint32_t bit = sc_bits_lowest(edges | 1u << 5), second = 0u - (bit > 2);
        const uint32_t swap = (a ^ b) & second;
        found[i].a = (uint32_t)sc_alone(3 * (a ^ swap) + bit - (3 & second));
        found[i].b = b ^ swap;
        count += edges != 0;
        edges &= edges - 1;
    }
    return count;
}

/* Reports settled pairs; collects as candidates those that are not, as their edges are not in one
   plane. */
static void take_settled(sc_query_state *state)
{
    enum { AHEAD = 16 };
    const unsigned touching = state->options.contact == SC_CONTACT_PROPER ? 0 : ~0u;
    const uint32_t *triangle = sc_model_triangle(state->model);
    uint64_t *counted = &state->stats.counts[sc_state_primitive_task(state)];
    sc_workspace *w = state->workspace;
    const uint32_t count = w->settled_count;
    uint32_t i, end;
    *counted += count;
    for (i = 0; i < count && !sc_state_cancelled(state);) {
        sc_pair found[6 * SC_PAIR_LANES];
        uint32_t some = 0;
        for (end = i + SC_PAIR_LANES < count ? i + SC_PAIR_LANES : count; i < end; i++) {
            const sc_pair *pair = &w->settled[i];
            const unsigned code = w->settled_code[i];
            unsigned edges = settled_edges[code & 255u];
            if (i + AHEAD < count) fetch_triangles(state->model, pair + AHEAD);
            if (code >> SC_SETTLED_AXIS != 3) {
                if (!is_level(w, triangle + 3 * (uint64_t)pair->a, triangle + 3 * (uint64_t)pair->b,
                              code)) {
                    sc_candidates_add(state, pair->a, pair->b);
                    --*counted;
                    continue;
                }
                edges = level_edges(code, touching);
            }
            some += name_edges(state, pair, edges, found + some);
        }
        sc_pairs_take_all(state, found, some);
    }
    w->settled_count = 0;
}

/* Decides what has been collected of triangles. */
static void decide_collected(sc_query_state *state)
{
    sc_workspace *w = state->workspace;
    uint32_t previous;
    if (state->sifts) sc_filter_sift(state);
    if (!w->candidate_count && !w->neighbor_count && !w->settled_count) return;
    previous = sc_state_switch(state, sc_state_primitive_task(state));
    decide_all(state, w->candidates, w->candidate_count, 0);
    decide_all(state, w->neighbors, w->neighbor_count, 1);
    w->candidate_count = w->neighbor_count = 0;
    take_settled(state);
    decide_all(state, w->candidates, w->candidate_count, 0);
    w->candidate_count = 0;
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
    const uint32_t room = SC_LEAF_MAX * (SC_LEAF_MAX + 1);
    const uint32_t most = soon ? 64 : SC_CANDIDATES_MAX - room;
    const uint32_t most_settled = soon ? 1 : SC_SETTLED_MAX - room;
    const sc_workspace *w = state->workspace;
    if (w->candidate_count >= most || w->neighbor_count >= most || w->settled_count >= most_settled)
        decide_collected(state);
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
