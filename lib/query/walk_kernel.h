/*
 * Box recursion. See query_kernels.h.
 *
 * SPDX-License-Identifier: MIT
 *
 * Of pairs of patches whose children are leaf clusters, rows are listed: children of one that
 * overlap the other. When there are many, they are compared with the other's children, and then
 * pairs of leaf clusters are listed. Each is a loop over all rows, so that no branch depends on how
 * many a pair of patches has.
 */

/* Rows that are looked at together. */
enum { WALK_ROWS = 128 };

/* Leaf clusters that are to be compared with some others, as patches. */
typedef struct walk_rows {
    uint32_t row[WALK_ROWS + SC_LEAF_MAX];
    uint32_t first[WALK_ROWS + SC_LEAF_MAX]; /* of those, */
    uint32_t all[WALK_ROWS + SC_LEAF_MAX];   /* and a bit for each */
    unsigned count;
} walk_rows;

/* Has the pairs of leaf clusters wait that overlap in these rows, and forgets them. */
static SC_NOINLINE void take_walk_rows(sc_query_state *state, walk_rows *rows)
{
    enum { AHEAD = 8 };
    const sc_boxes *boxes = &state->workspace->patch_boxes;
    const uint32_t leaves = sc_model_first_leaf_patch(state->model);
    const uint32_t *share = sc_model_share_first(state->model);
    const uint32_t *shared = sc_model_share_leaf(state->model);
    unsigned count = 0, i;
    for (i = 0; i < rows->count; i++) {
        const uint32_t row = rows->row[i], first = rows->first[i];
        const unsigned mask = overlap(boxes, row, boxes, first) & rows->all[i];
        rows->row[count] = row;
        rows->first[count] = first;
        rows->all[count] = mask;
        count += mask != 0;
    }
    for (i = 0; i < count && i < AHEAD; i++) sc_fetch(shared + share[rows->row[i] - leaves]);
    for (i = 0; i < count && !state->stop; i++) {
        if (i + AHEAD < count) sc_fetch(shared + share[rows->row[i + AHEAD] - leaves]);
        add_leaf_pairs(state, rows->row[i] - leaves, rows->first[i] - leaves, rows->all[i]);
        make_leaf_room(state);
    }
    rows->count = 0;
}

/*
 * Two patches of a level whose boxes overlap: the descendants of one at the next level that is
 * visited, sixteen at most, against the other's box, then row by row against the other's; rows of
 * leaf clusters wait.
 */
static void patch_pair(sc_query_state *state, uint32_t a, uint32_t b, walk_rows *waiting)
{
    const sc_model *model = state->model;
    const sc_boxes *boxes = &state->workspace->patch_boxes;
    const uint32_t *hop = sc_model_hop(model), *share = sc_model_share_first(model);
    const uint32_t leaves = sc_model_first_leaf_patch(model);
    uint32_t first_a, first_b;
    unsigned rows, all_b, i;
    if (a >= leaves) {
        leaf_pair_waits(state, a - leaves, b - leaves);
        return;
    }
    if (sc_state_stops(state)) return;
    first_a = hop[a];
    first_b = hop[b];
    all_b = (1u << (hop[b + 1] - first_b)) - 1u;
    rows = overlap(boxes, b, boxes, first_a) & ((1u << (hop[a + 1] - first_a)) - 1u);
    state->stats.counts[sc_state_box_task(state)] += 1 + sc_bits_count(rows);
    if (first_a >= leaves) {
        uint32_t *first = waiting->first + waiting->count, *all = waiting->all + waiting->count;
        sc_fetch(share + (first_a - leaves));
        sc_fetch(share + (hop[a + 1] - leaves));
        for (i = 0; i < SC_LANES_COUNT; i++) first[i] = first_b;
        for (i = 0; i < SC_LANES_COUNT; i++) all[i] = all_b;
        waiting->count += lanes_list_from(rows, first_a, waiting->row + waiting->count);
        if (waiting->count >= WALK_ROWS || sc_state_may_end_early(state))
            take_walk_rows(state, waiting);
    } else {
        for (; rows && !state->stop; rows &= rows - 1) {
            const uint32_t c = first_a + sc_bits_lowest(rows);
            unsigned mask = overlap(boxes, c, boxes, first_b) & all_b;
            for (; mask && !state->stop; mask &= mask - 1)
                patch_pair(state, c, first_b + sc_bits_lowest(mask), waiting);
        }
    }
}

/* A patch against itself. */
static void patch_itself(sc_query_state *state, uint32_t a, walk_rows *waiting)
{
    const sc_model *model = state->model;
    const sc_boxes *boxes = &state->workspace->patch_boxes;
    const uint32_t *hop = sc_model_hop(model);
    const uint32_t leaves = sc_model_first_leaf_patch(model);
    uint32_t count, i;
    if (a >= leaves) {
        leaf_itself(state, a - leaves);
        return;
    }
    if (sc_model_is_leaf(model, a)) {
        leaf_itself(state, sc_model_leaf(model)[a]);
        return;
    }
    if (sc_state_stops(state)) return;
    count = hop[a + 1] - hop[a];
    for (i = 0; i < count && !state->stop; i++) {
        uint32_t c = hop[a] + i;
        unsigned mask = overlap(boxes, c, boxes, hop[a]);
        mask &= ((1u << count) - 1u) & ~((2u << i) - 1u);
        state->stats.counts[sc_state_box_task(state)]++;
        patch_itself(state, c, waiting);
        for (; mask && !state->stop; mask &= mask - 1)
            patch_pair(state, c, hop[a] + sc_bits_lowest(mask), waiting);
    }
}

/* Pairs of patches, or patches against themselves. */
static void patch_pairs(sc_query_state *state, const sc_pair *pairs, uint32_t count)
{
    walk_rows waiting;
    uint32_t i;
    waiting.count = 0;
    for (i = 0; i < count && !state->stop; i++) {
        if (pairs[i].a == pairs[i].b)
            patch_itself(state, pairs[i].a, &waiting);
        else
            patch_pair(state, pairs[i].a, pairs[i].b, &waiting);
    }
    take_walk_rows(state, &waiting);
}
