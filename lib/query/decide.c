/*
 * Pairs of triangles. See decide.h.
 *
 * SPDX-License-Identifier: MIT
 *
 * What happens to a pair depends on the vertices it shares. None, or one: many are decided at once,
 * eight at a time, and those of which that is not certain by the exact primitives. More: these
 * alone decide.
 */
#include "query/decide.h"

#include <string.h>

#include "base/bits.h"
#include "pose/positions.h"
#include "query/filter.h"
#include "query/pairs.h"
#include "query/primitives.h"
#include "query/query_kernels.h"

/* Two triangles in the caller's numbers, the lower one first; of two objects as they are. */
static sc_pair name_triangles(const sc_worker *w, const sc_pair *places)
{
    const uint32_t a = sc_model_triangle_id(w->model)[places->a];
    const uint32_t b = sc_model_triangle_id(w->second->model)[places->b];
    const int turns = b < a && !sc_worker_is_between(w);
    sc_pair name;
    name.a = turns ? b : a;
    name.b = turns ? a : b;
    return name;
}

/* Reports that two triangles meet. */
static void take_triangles(sc_worker *w, const sc_pair *places)
{
    const sc_pair name = name_triangles(w, places);
    sc_pairs_take(w, name.a, name.b);
}

/* Reports edges that meet the other triangle. */
static void take_edges(sc_worker *w, const sc_pair *places, unsigned hits)
{
    const uint32_t a = sc_model_triangle_id(w->model)[places->a];
    const uint32_t b = sc_model_triangle_id(w->second->model)[places->b];
    for (; hits; hits &= hits - 1) {
        uint32_t bit = sc_bits_lowest(hits);
        if (bit < 3)
            sc_pairs_take(w, 3 * a + bit, b);
        else
            sc_pairs_take(w, 3 * b + bit - 3, a);
    }
}

/* The edges that bear the names of the two triangles' edges; between two objects those of the
   first. */
static unsigned edges_wanted(const sc_worker *w, const sc_pair *places)
{
    const uint8_t *owned = sc_model_edge_owned(w->model);
    if (sc_worker_is_between(w)) return owned[places->a];
    return (unsigned)owned[places->a] | (unsigned)owned[places->b] << 3;
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

void sc_decide_add_neighbors(sc_worker *w, uint32_t a, uint32_t b)
{
    const uint32_t *triangle = sc_model_triangle(w->model);
    const uint32_t *t = triangle + 3 * (uint64_t)(a & SC_ITEM), *u = triangle + 3 * (uint64_t)b;
    sc_lists *l = &w->lists;
    uint32_t shared[3] = {0, 0, 0};
    const int count = list_shared(t, u, shared);
    sc_pair pair;
    pair.a = a;
    pair.b = b;
    if (count == 1 && !repeats_point(t) && !repeats_point(u)) {
        l->neighbors[l->count[SC_LIST_NEIGHBORS]++] = pair;
        return;
    }
    /* with two different vertices shared, so does every edge share one */
    if (count >= 2 && shared[0] != shared[1] &&
        (w->question->options.pairs == SC_PAIRS_EDGE ||
         w->question->options.contact == SC_CONTACT_PROPER))
        return;
    sc_worker_count_primitives(w, sc_item_follows(a), 1);
    l->exact[l->count[SC_LIST_EXACT]++] = pair;
}

/* Leaves a pair to the exact primitives. */
static void leave_open(sc_worker *w, const sc_pair *places)
{
    w->lists.exact[w->lists.count[SC_LIST_EXACT]++] = *places;
}

/* Marks the corners that the triangles share. */
static void mark_shared(sc_pair_lanes *lanes)
{
    uint32_t j;
    int i, k;
    memset(lanes->shared, 0, sizeof lanes->shared);
    for (j = 0; j < SC_PAIR_LANES; j++) {
        const uint32_t *a = lanes->of[0].triangle + 3 * (uint64_t)lanes->pairs[j].a;
        const uint32_t *b = lanes->of[1].triangle + 3 * (uint64_t)lanes->pairs[j].b;
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
static void conclude(sc_worker *w, const sc_pair *places, unsigned meets, unsigned unsure)
{
    if (w->question->options.pairs == SC_PAIRS_EDGE) {
        unsigned wanted = edges_wanted(w, places);
        if (unsure & wanted)
            leave_open(w, places);
        else
            take_edges(w, places, meets & wanted);
    } else if (meets) {
        take_triangles(w, places);
    } else {
        leave_open(w, places);
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
static uint64_t wanted_of_lanes(const sc_worker *w, const sc_pair *pairs)
{
    uint64_t wanted = 0;
    int i;
    for (i = 0; i < SC_PAIR_LANES; i++)
        wanted |= (uint64_t)edges_wanted(w, &pairs[i]) << SC_PAIR_LANES * i;
    return wanted;
}

/* Reports what meets in some lanes. */
static void take_lanes(sc_worker *w, const sc_pair *pairs, uint64_t meets)
{
    const uint32_t *id[2];
    sc_pair found[6 * SC_PAIR_LANES];
    uint32_t count = 0;
    id[0] = sc_model_triangle_id(w->model);
    id[1] = sc_model_triangle_id(w->second->model);
    if (w->question->options.pairs == SC_PAIRS_EDGE) {
        meets &= turn_bits(wanted_of_lanes(w, pairs));
        if (sc_pairs_are_counted(w->question)) {
            w->count += sc_bits_count64(meets);
            return;
        }
        for (; meets; meets &= meets - 1) {
            uint32_t bit = sc_bits_lowest64(meets), k = bit / SC_PAIR_LANES;
            const sc_pair *pair = &pairs[bit % SC_PAIR_LANES];
            const uint32_t a = id[0][pair->a], b = id[1][pair->b];
            found[count].a = k < 3 ? 3 * a + k : 3 * b + k - 3;
            found[count++].b = k < 3 ? b : a;
        }
    } else {
        unsigned lanes = lanes_of(meets);
        for (; lanes; lanes &= lanes - 1)
            found[count++] = name_triangles(w, &pairs[sc_bits_lowest(lanes)]);
    }
    sc_pairs_take_all(w, found, count);
}

/* Asks for what is read of a triangle. */
static inline void fetch_triangle(const sc_model *model, uint32_t place)
{
    sc_fetch(sc_model_triangle(model) + 3 * (uint64_t)place);
    sc_fetch(sc_model_triangle_id(model) + place);
    sc_fetch(sc_model_edge_owned(model) + place);
}

static void find_triangles(const sc_worker *w, sc_triangle_source *source)
{
    const sc_positions *positions = &w->frame->positions[0];
    source->triangle = sc_model_triangle(w->model);
    source->positions = positions->at;
    source->stride = positions->stride;
    source->floats = positions->type == SC_FLOAT;
}

/* Decides pairs of a list that share nothing, or one point each. */
static void decide_some(sc_worker *w, const sc_pair *items, uint32_t count, int share)
{
    const sc_worker *v = w->second;
    sc_pair pairs[SC_PAIR_LANES];
    sc_pair_lanes lanes;
    uint32_t i, j, follow = 0;
    lanes.pairs = pairs;
    find_triangles(w, &lanes.of[0]);
    find_triangles(v, &lanes.of[1]);
    lanes.proper = w->question->options.contact == SC_CONTACT_PROPER;
    lanes.shares = share;
    memset(lanes.shared, 0, sizeof lanes.shared);
    for (i = 0; i < count && !w->stop; i += SC_PAIR_LANES) {
        const uint32_t some = count - i < SC_PAIR_LANES ? count - i : SC_PAIR_LANES;
        unsigned of_all = (1u << some) - 1u, open;
        sc_verdict verdict;
        for (j = 0; j < SC_PAIR_LANES; j++) { /* the last one fills them up */
            pairs[j] = items[i + j < count ? i + j : count - 1];
            follow += i + j < count ? sc_item_follows(pairs[j].a) : 0;
            pairs[j].a &= SC_ITEM;
        }
        for (j = i + SC_PAIR_LANES; j < i + 2 * SC_PAIR_LANES && j < count; j++) {
            fetch_triangle(w->model, items[j].a & SC_ITEM);
            fetch_triangle(v->model, items[j].b);
        }
        if (share) mark_shared(&lanes);
        w->frame->kernels->query->decide(&lanes, &verdict);
        open = lanes_of(verdict.unsure) & of_all;
        if (verdict.meets) take_lanes(w, pairs, verdict.meets & edges_of(of_all & ~open));
        for (; open && !w->stop; open &= open - 1) {
            j = sc_bits_lowest(open);
            conclude(w, &pairs[j], edges_of_lane(verdict.meets, j),
                     edges_of_lane(verdict.unsure, j));
        }
    }
    sc_worker_count_primitives(w, 0, count - follow);
    sc_worker_count_primitives(w, 1, follow);
}

void sc_decide_candidates(sc_worker *w, uint32_t most)
{
    uint32_t *left = &w->lists.count[SC_LIST_CANDIDATES], count = *left < most ? *left : most;
    sc_pair *pairs = w->lists.candidates + (*left -= count);
    if (w->question->sifts) count = sc_filter_sift(w, pairs, count);
    decide_some(w, pairs, count, 0);
}

void sc_decide_neighbors(sc_worker *w, uint32_t most)
{
    uint32_t *left = &w->lists.count[SC_LIST_NEIGHBORS], count = *left < most ? *left : most;
    decide_some(w, w->lists.neighbors + (*left -= count), count, 1);
}

/* Makes points of the second object other ones than those of the first: their numbers, as those of
   items, are below 2^31. */
#define OTHER_OBJECT 0x80000000u

static void decide_exactly(sc_worker *w, const sc_pair *places)
{
    const sc_worker *v = w->second;
    const uint32_t *a = sc_model_triangle(w->model) + 3 * (uint64_t)places->a;
    const uint32_t *b = sc_model_triangle(v->model) + 3 * (uint64_t)places->b;
    const uint32_t apart = sc_worker_is_between(w) ? OTHER_OBJECT : 0;
    const int proper = w->question->options.contact == SC_CONTACT_PROPER;
    double copy[2][3][4];
    sc_triangle_pair pair;
    int k;
    for (k = 0; k < 3; k++) {
        pair.va[k] = a[k];
        pair.vb[k] = b[k] | apart;
        pair.a[k] = sc_positions_at(&w->frame->positions[0], a[k], copy[0][k]);
        pair.b[k] = sc_positions_at(&v->frame->positions[0], b[k], copy[1][k]);
    }
    if (w->question->options.pairs == SC_PAIRS_EDGE)
        take_edges(w, places,
                   sc_primitives_edge_hits(&pair, proper, edges_wanted(w, places),
                                           &w->stats.exact_fallbacks));
    else if (sc_primitives_triangles_meet(&pair, proper, &w->stats.exact_fallbacks))
        take_triangles(w, places);
}

void sc_decide_exactly(sc_worker *w, uint32_t most)
{
    uint32_t *left = &w->lists.count[SC_LIST_EXACT];
    for (; most && *left && !w->stop; most--) {
        sc_pair pair = w->lists.exact[--*left];
        pair.a &= SC_ITEM;
        decide_exactly(w, &pair);
    }
}
