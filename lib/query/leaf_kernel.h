/*
 * The triangles of two leaf clusters, or of one: boxes against boxes, row by row; then what is left, sixteen pairs at a
 * time (query/sixteen_kernel.h). Pairs that are certain to meet are taken, pairs of which nothing is certain are collected.
 * See query_kernels.h.
 *
 * SPDX-License-Identifier: MIT
 */
/* Sets all of a picked but the numbers. */
static inline void SC_KERNEL(begin_picking)(const sc_query_state *state, uint32_t leaf,
                                            int is_upper, SC_KERNEL(picked) * t)
{
    t->points = state->workspace->point_at + 4 * SC_LEAF_POINTS * (uint64_t)leaf;
    t->ready = SC_KERNEL(ready)(state, leaf, is_upper);
    t->corner = sc_model_leaf_corner(state->model) + 3 * SC_LEAF_MAX * (uint64_t)leaf;
    t->numbers = NULL;
}

/* Takes those of the pairs in these rows that certainly meet, and collects those that are not certainly apart. */
static void SC_KERNEL(collect)(sc_query_state *state, const sc_leaf_pair *p, SC_KERNEL(picked) * a,
                               SC_KERNEL(picked) * b, unsigned rows, const uint8_t row_a[],
                               const uint16_t row_b[], float extent)
{
    uint32_t first_a = sc_model_leaf_first(state->model)[p->a];
    uint32_t first_b = sc_model_leaf_first(state->model)[p->b];
    uint8_t of_a[SC_LEAF_PAIRS + 2 * SC_LANES_COUNT], of_b[SC_LEAF_PAIRS + 2 * SC_LANES_COUNT];
    SC_KERNEL(verdict) verdict;
    unsigned count = 0, at, r, met;
    for (r = 0; r < rows; r++) {
        memset(of_a + count, row_a[r], SC_LANES_COUNT);
        count += lanes_list(row_b[r], of_b + count);
    }
    memset(of_a + count, 0, SC_LANES_COUNT); /* fills the last row */
    memset(of_b + count, 0, SC_LANES_COUNT);
    for (at = 0; at < count; at += SC_LANES_COUNT) {
        unsigned mask = count - at < SC_LANES_COUNT ? (1u << (count - at)) - 1u : 0xffffu;
        if (count >= SC_LEAF_FEW) {
            a->numbers = of_a + at;
            b->numbers = of_b + at;
            SC_KERNEL(test_pairs)(a, b, mask, extent, &verdict);
            for (met = mask & verdict.meets; met; met &= met - 1) {
                uint32_t lane = sc_bits_lowest(met);
                unsigned edges = 0;
                int k;
                SC_UNROLL
                for (k = 0; k < 6; k++) edges |= (verdict.edge[k] >> lane & 1u) << k;
                sc_candidates_take(state, first_a + of_a[at + lane], first_b + of_b[at + lane],
                                   edges);
            }
            mask &= ~(verdict.apart | verdict.meets);
        }
        for (; mask; mask &= mask - 1) {
            uint32_t lane = at + sc_bits_lowest(mask);
            sc_candidates_add(state, first_a + of_a[lane], first_b + of_b[lane]);
        }
    }
}

/* The boxes of the triangles of a leaf cluster that overlap that of triangle i of another. */
static inline unsigned SC_KERNEL(overlap_row)(const sc_leaf_ready *a, uint32_t i,
                                              const lanes low[3], const lanes high[3])
{
    lanes_mask m[3];
    int k;
    SC_UNROLL
    for (k = 0; k < 3; k++)
        m[k] = lanes_both(lanes_not_above(lanes_all(a->side[k][i]), high[k]),
                          lanes_not_above(low[k], lanes_all(a->side[k + 3][i])));
    return lanes_bits(lanes_both(m[0], lanes_both(m[1], m[2])));
}

static inline void SC_KERNEL(load_boxes)(const sc_leaf_ready *ready, lanes low[3], lanes high[3])
{
    int k;
    SC_UNROLL
    for (k = 0; k < 3; k++) {
        low[k] = lanes_load(ready->side[k]);
        high[k] = lanes_load(ready->side[k + 3]);
    }
}

/* Lists the rows of a, triangles whose boxes overlap some of b's, and which. Returns how many. */
static unsigned SC_KERNEL(list_rows)(const sc_leaf_ready *a, const sc_leaf_ready *b, unsigned rows,
                                     unsigned some, uint8_t of_a[], uint16_t of_b[])
{
    lanes low[3], high[3];
    unsigned count = 0;
    SC_KERNEL(load_boxes)(b, low, high);
    for (; rows; rows &= rows - 1) {
        uint32_t i = sc_bits_lowest(rows);
        of_a[count] = (uint8_t)i;
        of_b[count] = (uint16_t)(SC_KERNEL(overlap_row)(a, i, low, high) & some);
        count += of_b[count] != 0;
    }
    return count;
}

/* The same of clusters of which some triangles share points: pairs that do are taken, and not in the rows. Without
   branches, as any row may have some. */
static unsigned SC_KERNEL(take_shared)(sc_query_state *state, const sc_leaf_pair *p,
                                       const sc_leaf_ready *a, const sc_leaf_ready *b,
                                       unsigned rows, unsigned some, uint8_t of_a[],
                                       uint16_t of_b[])
{
    uint8_t near_a[SC_LEAF_PAIRS + 2 * SC_LANES_COUNT], near_b[SC_LEAF_PAIRS + 2 * SC_LANES_COUNT];
    const unsigned lower = p->a == p->b ? 0 : SC_LEAF_ALL; /* of b, those below i, too */
    unsigned count = 0, near_count = 0;
    lanes low[3], high[3];
    SC_KERNEL(load_boxes)(b, low, high);
    for (; rows; rows &= rows - 1) {
        uint32_t i = sc_bits_lowest(rows);
        unsigned mask = SC_KERNEL(overlap_row)(a, i, low, high) & some, shared = p->shared[i];
        mask &= ~((2u << i) - 1u) | lower;
        memset(near_a + near_count, (int)i, SC_LANES_COUNT);
        near_count += lanes_list(mask & shared, near_b + near_count);
        mask &= ~shared;
        of_a[count] = (uint8_t)i;
        of_b[count] = (uint16_t)mask;
        count += mask != 0;
    }
    if (near_count && p->wanted) SC_KERNEL(take_neighbors)
    (state, p, SC_KERNEL(extent)(state, p->a, p->b), near_a, near_b, near_count);
    return count;
}

/* Drops pairs of these rows of which the plane of the row's triangle has the other on one side. Returns how many rows are
   left. */
static unsigned SC_KERNEL(drop_by_planes)(const SC_KERNEL(picked) * a, const SC_KERNEL(picked) * b,
                                          float extent, unsigned rows, uint8_t of_a[],
                                          uint16_t of_b[])
{
    float above[SC_LEAF_MAX], below[SC_LEAF_MAX];
    lanes at[3], bound = SC_KERNEL(plane_bound)(lanes_load(a->ready->size), extent);
    lanes_index corner[3];
    unsigned count = 0, r;
    int k;
    lanes_turned(b->points, at);
    SC_UNROLL
    for (k = 0; k < 3; k++) corner[k] = lanes_index_load(b->corner + SC_LEAF_MAX * k);
    lanes_store(above, lanes_add(lanes_load(a->ready->offset), bound));
    lanes_store(below, lanes_subtract(lanes_load(a->ready->offset), bound));
    for (r = 0; r < rows; r++) {
        uint32_t i = of_a[r];
        lanes d[3], along = lanes_multiply(lanes_all(a->ready->normal[0][i]), at[0]);
        lanes_mask meets;
        SC_UNROLL
        for (k = 1; k < 3; k++)
            along = lanes_add(along, lanes_multiply(lanes_all(a->ready->normal[k][i]), at[k]));
        SC_UNROLL
        for (k = 0; k < 3; k++) d[k] = lanes_pick_of(along, corner[k]);
        meets = lanes_both(
            lanes_not_above(lanes_smaller(d[0], lanes_smaller(d[1], d[2])), lanes_all(above[i])),
            lanes_not_above(lanes_all(below[i]), lanes_larger(d[0], lanes_larger(d[1], d[2]))));
        of_a[count] = (uint8_t)i;
        of_b[count] = (uint16_t)(lanes_bits(meets) & of_b[r]);
        count += of_b[count] != 0;
    }
    return count;
}

/* Rows of triangles of cluster p->a against all of cluster p->b, of which only some may overlap one of a. */
static void SC_KERNEL(compare_leaves)(sc_query_state *state, sc_leaf_pair *p, unsigned rows,
                                      unsigned some)
{
    const sc_leaf_ready *of_a = SC_KERNEL(boxes)(state, p->a, p->a > p->b);
    const sc_leaf_ready *of_b = SC_KERNEL(boxes)(state, p->b, p->b > p->a);
    uint8_t row_a[SC_LEAF_MAX + 1];
    uint16_t row_b[SC_LEAF_MAX + 1];
    unsigned count;
    state->stats.counts[sc_state_box_task(state)] += sc_bits_count(rows);
    if (p->shares)
        count = SC_KERNEL(take_shared)(state, p, of_a, of_b, rows, some, row_a, row_b);
    else
        count = SC_KERNEL(list_rows)(of_a, of_b, rows, some, row_a, row_b);
    if (count) {
        float extent = SC_KERNEL(extent)(state, p->a, p->b);
        SC_KERNEL(picked) a, b;
        SC_KERNEL(begin_picking)(state, p->a, p->a > p->b, &a);
        SC_KERNEL(begin_picking)(state, p->b, p->b > p->a, &b);
        count = SC_KERNEL(drop_by_planes)(&a, &b, extent, count, row_a, row_b);
        if (count) SC_KERNEL(collect)(state, p, &a, &b, count, row_a, row_b, extent);
    }
    sc_candidates_make_room(state);
}

/* The triangles of leaf a whose boxes overlap that of leaf b. */
static unsigned SC_KERNEL(rows_at)(const sc_query_state *state, uint32_t a, uint32_t b)
{
    const sc_leaf_ready *ready = SC_KERNEL(boxes)(state, a, a > b);
    const sc_boxes *boxes = &state->workspace->patch_boxes;
    uint64_t i = (uint64_t)sc_model_first_leaf_patch(state->model) + b;
    lanes_mask m[3];
    int k;
    SC_UNROLL
    for (k = 0; k < 3; k++)
        m[k] = lanes_both(
            lanes_not_above(lanes_all(boxes->side[k][i]), lanes_load(ready->side[k + 3])),
            lanes_not_above(lanes_load(ready->side[k]), lanes_all(boxes->side[k + 3][i])));
    return lanes_bits(lanes_both(m[0], lanes_both(m[1], m[2])));
}

/* Two leaf clusters, a < b; by_slabs: slabs may tell them apart, and were not looked at. */
static void SC_KERNEL(leaf_pair)(sc_query_state *state, uint32_t a, uint32_t b, int by_slabs)
{
    sc_leaf_pair p;
    unsigned rows = SC_KERNEL(rows_at)(state, a, b), some;
    if (!rows) return;
    some = SC_KERNEL(rows_at)(state, b, a);
    if (!some) return;
    if (by_slabs && SC_KERNEL(slabs_part)(state, a, b)) return;
    sc_candidates_enter(state, a, b, &p);
    if (!p.shares && sc_bits_count(some) < sc_bits_count(rows)) { /* either may be the rows */
        unsigned swap = some;
        p.a = b;
        p.b = a;
        some = rows;
        rows = swap;
    }
    SC_KERNEL(compare_leaves)(state, &p, rows, some);
}

/* Asks for the memory of a leaf cluster that is made ready; or of its slab and points, and the former if there is no
   slab yet. */
static inline void SC_KERNEL(fetch_ready)(const sc_workspace *w, uint32_t leaf)
{
    const float *at = w->ready[leaf & w->ready_mask].side[0];
    int k;
    for (k = 0; k < SC_READY_ROWS; k++) sc_fetch(at + SC_LEAF_MAX * k);
}

static inline void SC_KERNEL(fetch_points)(const sc_workspace *w, uint32_t leaf)
{
    const float *at = w->point_at + 4 * SC_LEAF_POINTS * (uint64_t)leaf;
    int k;
    for (k = 0; k < 4; k++) sc_fetch(at + SC_LEAF_POINTS * k);
    if (w->slab[leaf].tick != w->pose_tick) SC_KERNEL(fetch_ready)(w, leaf);
}

/* The pairs of leaf clusters that wait. If they are many, slabs drop most of those that hold no pair of triangles; some
   pairs ahead, memory is asked for. If they are few, it does not pay to make slabs before boxes meet. */
static void SC_KERNEL(leaf_pairs)(sc_query_state *state)
{
    sc_workspace *w = state->workspace;
    uint32_t *lower = w->leaf_pairs[0], *upper = w->leaf_pairs[1];
    uint32_t count = w->leaf_pair_count, kept = 0, i;
    int slabs_first = count >= SC_LEAF_SLABS_FIRST;
    w->leaf_pair_count = 0;
    if (slabs_first) {
        for (i = 0; i < count; i++) {
            uint32_t a = lower[i], b = upper[i];
            if (i + SC_FETCH_POINTS < count) SC_KERNEL(fetch_points)(w, upper[i + SC_FETCH_POINTS]);
            lower[kept] = a;
            upper[kept] = b;
            kept += !SC_KERNEL(slabs_part)(state, a, b);
        }
        count = kept;
    }
    for (i = 0; i < count && !state->stop; i++) {
        if (i + SC_FETCH_READY < count) SC_KERNEL(fetch_ready)(w, upper[i + SC_FETCH_READY]);
        SC_KERNEL(leaf_pair)(state, lower[i], upper[i], !slabs_first);
        if (i % SC_LEAF_PAIRS_UNASKED == 0) sc_state_stops(state);
    }
}

/* Has pairs of a leaf cluster wait: with those numbered from first on, all below it or all above, of which bits of a
   mask are set. */
static inline void SC_KERNEL(add_leaf_pairs)(sc_query_state *state, uint32_t leaf, uint32_t first,
                                             unsigned mask)
{
    sc_workspace *w = state->workspace;
    int is_upper = leaf > first;
    unsigned count = lanes_list_from(mask, first, w->leaf_pairs[!is_upper] + w->leaf_pair_count);
    uint32_t *same = w->leaf_pairs[is_upper] + w->leaf_pair_count;
    int i;
    for (i = 0; i < SC_LANES_COUNT; i++) same[i] = leaf;
    w->leaf_pair_count += count;
    state->stats.leaf_pairs += count;
    state->stats.counts[sc_state_box_task(state)] += count;
}

/* To be called after SC_LEAF_MAX such or fewer: sees that so many more have room. */
static inline void SC_KERNEL(make_leaf_room)(sc_query_state *state)
{
    /* fewer if the first hit ends the query */
    uint32_t most = state->options.output == SC_OUTPUT_ANY ? 16 : SC_LEAF_QUEUE - SC_LEAF_MAX;
    if (state->workspace->leaf_pair_count > most) SC_KERNEL(leaf_pairs)(state);
}

static void SC_KERNEL(leaf_pair_waits)(sc_query_state *state, uint32_t a, uint32_t b)
{
    SC_KERNEL(add_leaf_pairs)(state, a, b, 1);
    SC_KERNEL(make_leaf_room)(state);
}

static void SC_KERNEL(leaf_itself)(sc_query_state *state, uint32_t leaf)
{
    const uint32_t *first = sc_model_leaf_first(state->model);
    unsigned rows = (1u << (first[leaf + 1] - first[leaf] - 1)) - 1u;
    sc_leaf_pair p;
    state->stats.leaf_pairs++;
    sc_candidates_enter(state, leaf, leaf, &p);
    SC_KERNEL(compare_leaves)(state, &p, rows, SC_LEAF_ALL);
}
