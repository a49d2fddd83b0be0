/*
 * Box recursion over a step, down to pairs of leaf clusters. See step_kernels.h.
 *
 * SPDX-License-Identifier: MIT
 */

#define SC_LANES_ALL ((1u << SC_LANES_COUNT) - 1u)

/* The sides of a box that moves, for comparison with many. */
typedef struct box_sides {
    lanes side[SC_MOTION_SIDES];
} box_sides;

/* Sides of patches are in twelve arrays. */
static inline void patch_sides(const sc_motion *m, uint32_t patch, float margin, box_sides *box)
{
    int k;
    for (k = 0; k < SC_MOTION_SIDES; k++) {
        float x = m->boxes[k / 6].side[k % 6][patch];
        box->side[k] = lanes_all(k % 6 < 3 ? x - margin : x + margin);
    }
}

/* Bit k: patch j + k is not apart from the box at all times. */
static inline unsigned near_patches(const box_sides *box, const sc_motion *m, uint32_t j)
{
    lanes least = lanes_all(0);
    int k;
    for (k = 0; k < 3; k++) {
        lanes below = lanes_larger(
            lanes_subtract(box->side[SC_START_HIGH + k], lanes_load(m->boxes[0].side[k] + j)),
            lanes_subtract(box->side[SC_END_HIGH + k], lanes_load(m->boxes[1].side[k] + j)));
        lanes above = lanes_larger(
            lanes_subtract(lanes_load(m->boxes[0].side[k + 3] + j), box->side[SC_START_LOW + k]),
            lanes_subtract(lanes_load(m->boxes[1].side[k + 3] + j), box->side[SC_END_LOW + k]));
        least = lanes_smaller(least, lanes_smaller(below, above));
    }
    return ~lanes_bits(lanes_below(least, lanes_all(0))) & SC_LANES_ALL;
}

static inline void count_tests(sc_step_state *state, uint64_t tests)
{
    state->query.stats.counts[sc_state_box_task(&state->query)] += tests;
}

/* Hands on what is left of two leaf clusters, or of one. */
static void take_step_rows(sc_step_state *state, uint32_t leaf_a, uint32_t leaf_b,
                           const step_rows *rows)
{
    const sc_model *model = state->query.model;
    const uint32_t leaf[2] = {leaf_a, leaf_b}, *point = sc_model_leaf_point(model);
    const uint32_t first[2] = {sc_model_leaf_first(model)[leaf_a],
                               sc_model_leaf_first(model)[leaf_b]};
    unsigned r, some, k;
    for (r = 0; r < rows->faces; r++) {
        const uint32_t of = rows->of[r];
        const uint32_t *others = point + SC_LEAF_POINTS * (uint64_t)leaf[1 - of];
        for (some = rows->points[r]; some && !state->query.stop; some &= some - 1)
            sc_step_candidates_take(state, SC_STEP_VERTEX_FACE, others[sc_bits_lowest(some)],
                                    first[of] + rows->face[r]);
    }
    for (r = 0; r < rows->edges; r++) {
        const uint32_t edge = rows->edge[r];
        const uint32_t name = 3 * (first[0] + edge % SC_LEAF_MAX) + edge / SC_LEAF_MAX;
        for (k = 0; k < 3; k++)
            for (some = rows->others[r][k]; some && !state->query.stop; some &= some - 1)
                sc_step_candidates_take(state, SC_STEP_EDGE_EDGE, name,
                                        3 * (first[1] + sc_bits_lowest(some)) + k);
    }
}

static void step_leaf_pair(sc_step_state *state, uint32_t leaf_a, uint32_t leaf_b)
{
    const sc_leaf_motion *a = leaf_motion(state, leaf_a);
    const sc_leaf_motion *b = other_motion(state, leaf_a, leaf_b);
    const sc_motion *m = &state->query.workspace->motion;
    step_rows rows;
    state->query.stats.leaf_pairs++;
    count_tests(state, find_rows(state->query.model, m, a, b, &rows));
    take_step_rows(state, leaf_a, leaf_b, &rows);
}

static void step_leaf_itself(sc_step_state *state, uint32_t leaf)
{
    const sc_leaf_motion *a = leaf_motion(state, leaf);
    const sc_motion *m = &state->query.workspace->motion;
    step_rows rows;
    state->query.stats.leaf_pairs++;
    count_tests(state, find_own_rows(state->query.model, m, a, &rows));
    take_step_rows(state, leaf, leaf, &rows);
}

/* Two patches of a level whose boxes are near each other, as query/walk_kernel.h does it. */
static void step_patch_pair(sc_step_state *state, uint32_t a, uint32_t b)
{
    const sc_model *model = state->query.model;
    const sc_motion *m = &state->query.workspace->motion;
    const uint32_t *hop = sc_model_hop(model);
    uint32_t a_count, b_count;
    box_sides box;
    unsigned rows;
    if (a >= sc_model_first_leaf_patch(model)) {
        step_leaf_pair(state, sc_model_leaf(model)[a], sc_model_leaf(model)[b]);
        return;
    }
    if (sc_state_stops(&state->query)) return;
    a_count = hop[a + 1] - hop[a];
    b_count = hop[b + 1] - hop[b];
    patch_sides(m, b, 0, &box);
    rows = near_patches(&box, m, hop[a]) & ((1u << a_count) - 1u);
    count_tests(state, 1);
    for (; rows && !state->query.stop; rows &= rows - 1) {
        uint32_t c = hop[a] + sc_bits_lowest(rows);
        unsigned some;
        patch_sides(m, c, 0, &box);
        some = near_patches(&box, m, hop[b]) & ((1u << b_count) - 1u);
        count_tests(state, 1);
        for (; some && !state->query.stop; some &= some - 1)
            step_patch_pair(state, c, hop[b] + sc_bits_lowest(some));
    }
}

/* A patch against itself. */
static void step_patch_itself(sc_step_state *state, uint32_t a)
{
    const sc_model *model = state->query.model;
    const sc_motion *m = &state->query.workspace->motion;
    const uint32_t *hop = sc_model_hop(model);
    uint32_t count, i;
    if (sc_model_is_leaf(model, a)) {
        step_leaf_itself(state, sc_model_leaf(model)[a]);
        return;
    }
    if (sc_state_stops(&state->query)) return;
    count = hop[a + 1] - hop[a];
    for (i = 0; i < count && !state->query.stop; i++) {
        uint32_t c = hop[a] + i;
        box_sides box;
        unsigned some;
        patch_sides(m, c, 0, &box);
        some = near_patches(&box, m, hop[a]);
        some &= ((1u << count) - 1u) & ~((2u << i) - 1u);
        count_tests(state, 1);
        step_patch_itself(state, c);
        for (; some && !state->query.stop; some &= some - 1)
            step_patch_pair(state, c, hop[a] + sc_bits_lowest(some));
    }
}

#undef SC_LANES_ALL
