/*
 * Box recursion. See query_kernels.h.
 *
 * SPDX-License-Identifier: MIT
 */

/*
 * Two patches of a level whose boxes overlap: the descendants of each at the next level that is visited,
 * sixteen at most, against the other's box, then row by row.
 */
static void SC_KERNEL(patch_pair)(sc_query_state *state, uint32_t a, uint32_t b)
{
    const sc_model *model = state->model;
    const sc_boxes boxes = state->workspace->patch_boxes;
    const uint32_t *hop = sc_model_hop(model);
    const uint32_t leaves = sc_model_first_leaf_patch(model);
    uint32_t first_a, first_b;
    unsigned rows, all_b;
    if (a >= leaves) {
        SC_KERNEL(leaf_pair_waits)
        (state, sc_model_leaf(model)[a], sc_model_leaf(model)[b]);
        return;
    }
    if (sc_state_stops(state)) return;
    first_a = hop[a];
    first_b = hop[b];
    all_b = (1u << (hop[b + 1] - first_b)) - 1u;
    rows = SC_KERNEL(overlap)(&boxes, b, &boxes, first_a) & ((1u << (hop[a + 1] - first_a)) - 1u);
    state->stats.counts[sc_state_box_task(state)] += 1 + sc_bits_count(rows);
    for (; rows && !state->stop; rows &= rows - 1) {
        uint32_t c = first_a + sc_bits_lowest(rows);
        unsigned mask = SC_KERNEL(overlap)(&boxes, c, &boxes, first_b) & all_b;
        if (c < leaves) {
            for (; mask && !state->stop; mask &= mask - 1)
                SC_KERNEL(patch_pair)(state, c, first_b + sc_bits_lowest(mask));
        } else {
            SC_KERNEL(add_leaf_pairs)(state, c - leaves, first_b - leaves, mask);
            SC_KERNEL(make_leaf_room)(state);
        }
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
