/*
 * Box recursion and the triangles of leaf clusters. See query_kernels.h.
 *
 * SPDX-License-Identifier: MIT
 */

/* Bit k: box i of a overlaps box j + k of b, for k from 0 to 15. */
static inline unsigned SC_KERNEL(overlap)(const sc_boxes *a, uint64_t i, const sc_boxes *b,
                                          uint64_t j)
{
    lanes_mask m[3];
    int k;
    for (k = 0; k < 3; k++)
        m[k] =
            lanes_both(lanes_not_above(lanes_all(a->side[k][i]), lanes_load(b->side[k + 3] + j)),
                       lanes_not_above(lanes_load(b->side[k] + j), lanes_all(a->side[k + 3][i])));
    return lanes_bits(lanes_both(m[0], lanes_both(m[1], m[2])));
}

/* Rows of triangles of cluster p->a whose boxes overlap some of cluster p->b. Most pairs share points
   round which nothing can happen, and are dropped here. */
static void SC_KERNEL(compare_leaves)(sc_query_state *state, sc_leaf_pair *p, unsigned rows)
{
    const sc_boxes *boxes = &state->workspace->triangle_boxes;
    uint64_t row_a = (uint64_t)p->a * SC_LEAF_MAX, row_b = (uint64_t)p->b * SC_LEAF_MAX;
    uint64_t tests = 0;
    for (; rows && !state->stop; rows &= rows - 1) {
        uint32_t i = sc_bits_lowest(rows);
        unsigned mask = SC_KERNEL(overlap)(boxes, row_a + i, boxes, row_b), shared;
        if (p->a == p->b) mask &= ~((2u << i) - 1u);
        tests++;
        shared = p->shared[i] & (p->plain_a >> i & 1u ? SC_LEAF_ALL : p->plain_b);
        if (mask & ~shared) sc_candidates_take(state, p, i, mask & ~shared);
    }
    state->stats.counts[sc_state_box_task(state)] += tests;
}

static void SC_KERNEL(leaf_pair)(sc_query_state *state, uint32_t leaf_a, uint32_t leaf_b)
{
    const sc_workspace *w = state->workspace;
    uint32_t a = leaf_a < leaf_b ? leaf_a : leaf_b, b = leaf_a < leaf_b ? leaf_b : leaf_a;
    uint32_t patch_b = sc_model_first_leaf_patch(state->model) + b;
    sc_leaf_pair p;
    unsigned rows = SC_KERNEL(overlap)(&w->patch_boxes, patch_b, &w->triangle_boxes,
                                       (uint64_t)a * SC_LEAF_MAX) &
                    SC_LEAF_ALL;
    state->stats.leaf_pairs++;
    state->stats.counts[sc_state_box_task(state)]++;
    if (!rows) return;
    sc_candidates_enter(state, a, b, &p);
    SC_KERNEL(compare_leaves)(state, &p, rows);
}

static void SC_KERNEL(leaf_itself)(sc_query_state *state, uint32_t leaf)
{
    const uint32_t *first = sc_model_leaf_first(state->model);
    sc_leaf_pair p;
    state->stats.leaf_pairs++;
    sc_candidates_enter(state, leaf, leaf, &p);
    SC_KERNEL(compare_leaves)(state, &p, (1u << (first[leaf + 1] - first[leaf] - 1)) - 1u);
}

/*
 * Two patches of a level whose boxes overlap: the descendants of each at the next level that is visited,
 * eight at most, against the other's box, then row by row.
 */
static void SC_KERNEL(patch_pair)(sc_query_state *state, uint32_t a, uint32_t b)
{
    const sc_model *model = state->model;
    const sc_boxes *boxes = &state->workspace->patch_boxes;
    const uint32_t *hop = sc_model_hop(model);
    uint32_t a_count, b_count;
    unsigned rows;
    if (a >= sc_model_first_leaf_patch(model)) {
        SC_KERNEL(leaf_pair)(state, sc_model_leaf(model)[a], sc_model_leaf(model)[b]);
        return;
    }
    if (sc_state_stops(state)) return;
    a_count = hop[a + 1] - hop[a];
    b_count = hop[b + 1] - hop[b];
    rows = SC_KERNEL(overlap)(boxes, b, boxes, hop[a]) & ((1u << a_count) - 1u);
    state->stats.counts[sc_state_box_task(state)]++;
    for (; rows && !state->stop; rows &= rows - 1) {
        uint32_t c = hop[a] + sc_bits_lowest(rows);
        unsigned mask = SC_KERNEL(overlap)(boxes, c, boxes, hop[b]) & ((1u << b_count) - 1u);
        state->stats.counts[sc_state_box_task(state)]++;
        for (; mask && !state->stop; mask &= mask - 1)
            SC_KERNEL(patch_pair)(state, c, hop[b] + sc_bits_lowest(mask));
    }
}

/* A patch against itself. */
static void SC_KERNEL(patch_itself)(sc_query_state *state, uint32_t a)
{
    const sc_model *model = state->model;
    const sc_boxes *boxes = &state->workspace->patch_boxes;
    const uint32_t *hop = sc_model_hop(model);
    uint32_t count, i;
    if (sc_model_is_leaf(model, a)) {
        SC_KERNEL(leaf_itself)(state, sc_model_leaf(model)[a]);
        return;
    }
    if (sc_state_stops(state)) return;
    count = hop[a + 1] - hop[a];
    for (i = 0; i < count && !state->stop; i++) {
        uint32_t c = hop[a] + i;
        unsigned mask = SC_KERNEL(overlap)(boxes, c, boxes, hop[a]);
        mask &= ((1u << count) - 1u) & ~((2u << i) - 1u);
        state->stats.counts[sc_state_box_task(state)]++;
        SC_KERNEL(patch_itself)(state, c);
        for (; mask && !state->stop; mask &= mask - 1)
            SC_KERNEL(patch_pair)(state, c, hop[a] + sc_bits_lowest(mask));
    }
}
