/*
 * Box recursion. See query_kernels.h.
 *
 * SPDX-License-Identifier: MIT
 */

/* Of the children of a patch in a mask, from first_a on, lists those whose boxes overlap some of another's in all_b, from
   first_b on; and which these are. Returns how many. Without branches, as any row may have some. */
static inline unsigned SC_KERNEL(list_rows)(const sc_boxes *boxes, uint32_t first_a, unsigned rows,
                                            uint32_t first_b, unsigned all_b, uint32_t *row,
                                            unsigned *mask)
{
    lanes low[3], high[3];
    lanes_mask m[3];
    unsigned count = 0;
    int k;
    SC_UNROLL
    for (k = 0; k < 3; k++) {
        low[k] = lanes_load(boxes->side[k] + first_b);
        high[k] = lanes_load(boxes->side[k + 3] + first_b);
    }
    for (; rows; rows &= rows - 1) {
        const uint32_t c = first_a + sc_bits_lowest(rows);
        SC_UNROLL
        for (k = 0; k < 3; k++)
            m[k] = lanes_both(lanes_not_above(lanes_all(boxes->side[k][c]), high[k]),
                              lanes_not_above(low[k], lanes_all(boxes->side[k + 3][c])));
        row[count] = c;
        mask[count] = lanes_bits(lanes_both(m[0], lanes_both(m[1], m[2]))) & all_b;
        count += mask[count] != 0;
    }
    return count;
}

/*
 * Two patches of a level whose boxes overlap: the descendants of one at the next level that is visited,
 * sixteen at most, against the other's box, then row by row against the other's.
 */
static void SC_KERNEL(patch_pair)(sc_query_state *state, uint32_t a, uint32_t b)
{
    const sc_model *model = state->model;
    const sc_boxes *boxes = &state->workspace->patch_boxes;
    const uint32_t *hop = sc_model_hop(model);
    const uint32_t leaves = sc_model_first_leaf_patch(model);
    uint32_t first_a, first_b, row[SC_LEAF_MAX];
    unsigned rows, all_b, mask[SC_LEAF_MAX], count, i;
    if (a >= leaves) {
        SC_KERNEL(leaf_pair_waits)
        (state, sc_model_leaf(model)[a], sc_model_leaf(model)[b]);
        return;
    }
    if (sc_state_stops(state)) return;
    first_a = hop[a];
    first_b = hop[b];
    all_b = (1u << (hop[b + 1] - first_b)) - 1u;
    rows = SC_KERNEL(overlap)(boxes, b, boxes, first_a) & ((1u << (hop[a + 1] - first_a)) - 1u);
    state->stats.counts[sc_state_box_task(state)] += 1 + sc_bits_count(rows);
    count = SC_KERNEL(list_rows)(boxes, first_a, rows, first_b, all_b, row, mask);
    if (first_a < leaves) {
        for (i = 0; i < count; i++)
            for (; mask[i] && !state->stop; mask[i] &= mask[i] - 1)
                SC_KERNEL(patch_pair)(state, row[i], first_b + sc_bits_lowest(mask[i]));
    } else {
        for (i = 0; i < count && !state->stop; i++) {
            SC_KERNEL(add_leaf_pairs)(state, row[i] - leaves, first_b - leaves, mask[i]);
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
