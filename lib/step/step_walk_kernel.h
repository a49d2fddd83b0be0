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

static inline void count_tests(sc_worker *w, uint64_t tests)
{
    w->stats.counts[sc_step_box_task(w)] += tests;
}

/* Hands on what is left of two leaf clusters, or of one. */
static void take_step_rows(sc_worker *w, uint32_t leaf_a, uint32_t leaf_b, const step_rows *rows)
{
    const sc_model *model = w->model;
    const uint32_t leaf[2] = {leaf_a, leaf_b}, *point = sc_model_leaf_point(model);
    const uint32_t first[2] = {sc_model_leaf_first(model)[leaf_a],
                               sc_model_leaf_first(model)[leaf_b]};
    unsigned r, some, k;
    for (r = 0; r < rows->faces; r++) {
        const uint32_t of = rows->of[r];
        const uint32_t *others = point + SC_LEAF_POINTS * (uint64_t)leaf[1 - of];
        for (some = rows->points[r]; some && !w->stop; some &= some - 1)
            sc_step_candidates_take(w, SC_STEP_VERTEX_FACE, others[sc_bits_lowest(some)],
                                    first[of] + rows->face[r]);
    }
    for (r = 0; r < rows->edges; r++) {
        const uint32_t edge = rows->edge[r];
        const uint32_t name = 3 * (first[0] + edge % SC_LEAF_MAX) + edge / SC_LEAF_MAX;
        for (k = 0; k < 3; k++)
            for (some = rows->others[r][k]; some && !w->stop; some &= some - 1)
                sc_step_candidates_take(w, SC_STEP_EDGE_EDGE, name,
                                        3 * (first[1] + sc_bits_lowest(some)) + k);
    }
}

static void step_leaf_pair(sc_worker *w, uint32_t leaf_a, uint32_t leaf_b)
{
    const sc_leaf_motion *a = leaf_motion(w, leaf_a);
    const sc_leaf_motion *b = other_motion(w, leaf_a, leaf_b);
    step_rows rows;
    w->stats.leaf_pairs++;
    count_tests(w, find_rows(w->model, &w->frame->motion, a, b, &rows));
    take_step_rows(w, leaf_a, leaf_b, &rows);
}

static void step_leaf_itself(sc_worker *w, uint32_t leaf)
{
    const sc_leaf_motion *a = leaf_motion(w, leaf);
    step_rows rows;
    w->stats.leaf_pairs++;
    count_tests(w, find_own_rows(w->model, &w->frame->motion, a, &rows));
    take_step_rows(w, leaf, leaf, &rows);
}

/* Two patches of a level whose boxes are near each other, as query/broad_kernel.h does it. */
static void step_patch_pair(sc_worker *w, uint32_t a, uint32_t b)
{
    const sc_model *model = w->model;
    const sc_motion *m = &w->frame->motion;
    const uint32_t *hop = sc_model_hop(model);
    uint32_t a_count, b_count;
    box_sides box;
    unsigned rows;
    if (a >= sc_model_first_leaf_patch(model)) {
        step_leaf_pair(w, sc_model_leaf(model)[a], sc_model_leaf(model)[b]);
        return;
    }
    if (sc_worker_stops(w)) return;
    a_count = hop[a + 1] - hop[a];
    b_count = hop[b + 1] - hop[b];
    patch_sides(m, b, 0, &box);
    rows = near_patches(&box, m, hop[a]) & ((1u << a_count) - 1u);
    count_tests(w, 1);
    for (; rows && !w->stop; rows &= rows - 1) {
        uint32_t c = hop[a] + sc_bits_lowest(rows);
        unsigned some;
        patch_sides(m, c, 0, &box);
        some = near_patches(&box, m, hop[b]) & ((1u << b_count) - 1u);
        count_tests(w, 1);
        for (; some && !w->stop; some &= some - 1)
            step_patch_pair(w, c, hop[b] + sc_bits_lowest(some));
    }
}

/* A patch against itself. */
static void step_patch_itself(sc_worker *w, uint32_t a)
{
    const sc_model *model = w->model;
    const sc_motion *m = &w->frame->motion;
    const uint32_t *hop = sc_model_hop(model);
    uint32_t count, i;
    if (sc_model_is_leaf(model, a)) {
        step_leaf_itself(w, sc_model_leaf(model)[a]);
        return;
    }
    if (sc_worker_stops(w)) return;
    count = hop[a + 1] - hop[a];
    for (i = 0; i < count && !w->stop; i++) {
        uint32_t c = hop[a] + i;
        box_sides box;
        unsigned some;
        patch_sides(m, c, 0, &box);
        some = near_patches(&box, m, hop[a]);
        some &= ((1u << count) - 1u) & ~((2u << i) - 1u);
        count_tests(w, 1);
        step_patch_itself(w, c);
        for (; some && !w->stop; some &= some - 1)
            step_patch_pair(w, c, hop[a] + sc_bits_lowest(some));
    }
}

#undef SC_LANES_ALL
