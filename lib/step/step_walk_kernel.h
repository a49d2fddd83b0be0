/*
 * Box recursion over a step, and the vertices, edges and triangles of leaf clusters. See
 * step_kernels.h.
 *
 * SPDX-License-Identifier: MIT
 */

#define SC_LANES_ALL ((1u << SC_LANES_COUNT) - 1u)

/* The sides of a box that moves, for comparison with many. */
typedef struct box_sides {
    lanes side[SC_MOTION_SIDES];
} box_sides;

/* Those of box i of an array of boxes, each moved outwards. */
static inline void sides_of(const float *side, uint32_t stride, uint32_t i, float margin,
                            box_sides *box)
{
    int k;
    for (k = 0; k < SC_MOTION_SIDES; k++) {
        float x = side[(uint32_t)k * stride + i];
        box->side[k] = lanes_all(k % 6 < 3 ? x - margin : x + margin);
    }
}

/*
 * Bit k: box j + k is not apart from the box at all times. Apart: on one axis, one of the two is
 * below the other both at the start and at the end, that is, the larger of the two differences is
 * negative; differences have the sign that they should have.
 */
static inline unsigned lie_near(const box_sides *box, const float *side, uint32_t stride,
                                uint32_t j)
{
    lanes least = lanes_all(0);
    int k;
    for (k = 0; k < 3; k++) {
        const float *at = side + (uint32_t)k * stride + j;
        lanes below = lanes_larger(
            lanes_subtract(box->side[SC_START_HIGH + k], lanes_load(at + SC_START_LOW * stride)),
            lanes_subtract(box->side[SC_END_HIGH + k], lanes_load(at + SC_END_LOW * stride)));
        lanes above = lanes_larger(
            lanes_subtract(lanes_load(at + SC_START_HIGH * stride), box->side[SC_START_LOW + k]),
            lanes_subtract(lanes_load(at + SC_END_HIGH * stride), box->side[SC_END_LOW + k]));
        least = lanes_smaller(least, lanes_smaller(below, above));
    }
    return ~lanes_bits(lanes_below(least, lanes_all(0))) & SC_LANES_ALL;
}

/* Bits of the first count boxes that are near one. */
static inline uint64_t all_near(const box_sides *box, const float *side, uint32_t stride,
                                uint32_t count)
{
    uint64_t bits = 0;
    uint32_t j;
    for (j = 0; j < count; j += SC_LANES_COUNT)
        bits |= (uint64_t)lie_near(box, side, stride, j) << j;
    return bits & (((uint64_t)1 << count) - 1);
}

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

/* Vertices of one leaf cluster, those with a bit, against triangles of another or the same. */
static void vertices_with_faces(sc_step_state *state, const sc_leaf_motion *a, uint64_t points,
                                const sc_leaf_motion *b, uint64_t triangles)
{
    const uint32_t *corner = sc_model_triangle(state->query.model);
    float margin = state->query.workspace->motion.margin;
    uint64_t tests = 0;
    for (; points && !state->query.stop; points &= points - 1) {
        uint32_t i = sc_bits_lowest64(points), point = a->point[i];
        box_sides box;
        uint64_t some;
        sides_of(a->point_side[0], SC_LEAF_POINTS, i, margin, &box);
        some = all_near(&box, b->triangle_side[0], SC_LEAF_MAX, b->triangles) & triangles;
        tests++;
        for (; some && !state->query.stop; some &= some - 1) {
            uint32_t place = b->first_place + sc_bits_lowest64(some);
            const uint32_t *c = corner + 3 * (uint64_t)place;
            if (c[0] != point && c[1] != point && c[2] != point)
                sc_step_candidates_take(state, SC_STEP_VERTEX_FACE, point, place);
        }
    }
    count_tests(state, tests);
}

/* Edges of one leaf cluster, those with a bit, against edges of another, or of the same that come
   later. */
static void edges_with_edges(sc_step_state *state, const sc_leaf_motion *a, uint64_t some_a,
                             const sc_leaf_motion *b, uint64_t some_b)
{
    float margin = state->query.workspace->motion.margin;
    uint64_t tests = 0;
    for (; some_a && !state->query.stop; some_a &= some_a - 1) {
        uint32_t i = sc_bits_lowest64(some_a);
        const uint32_t *e = a->edge_end[i];
        box_sides box;
        uint64_t some;
        sides_of(a->edge_side[0], SC_LEAF_EDGES, i, margin, &box);
        some = all_near(&box, b->edge_side[0], SC_LEAF_EDGES, b->edges) & some_b;
        if (a->leaf == b->leaf) some &= ~(((uint64_t)2 << i) - 1);
        tests++;
        for (; some && !state->query.stop; some &= some - 1) {
            uint32_t j = sc_bits_lowest64(some);
            const uint32_t *f = b->edge_end[j];
            if (e[0] != f[0] && e[0] != f[1] && e[1] != f[0] && e[1] != f[1])
                sc_step_candidates_take(state, SC_STEP_EDGE_EDGE, a->edge_name[i], b->edge_name[j]);
        }
    }
    count_tests(state, tests);
}

/* Bits of what of a leaf cluster is near the box of another. */
typedef struct part_counts {
    uint64_t points, edges, triangles;
} part_counts;

static inline void parts_near(const sc_leaf_motion *a, const box_sides *box, part_counts *some)
{
    some->points = some->edges = 0;
    some->triangles = all_near(box, a->triangle_side[0], SC_LEAF_MAX, a->triangles);
    if (!some->triangles) return;
    some->points = all_near(box, a->point_side[0], SC_LEAF_POINTS, a->points);
    some->edges = all_near(box, a->edge_side[0], SC_LEAF_EDGES, a->edges);
}

static void step_leaf_pair(sc_step_state *state, uint32_t leaf_a, uint32_t leaf_b)
{
    const sc_motion *m = &state->query.workspace->motion;
    uint32_t first = sc_model_first_leaf_patch(state->query.model);
    const sc_leaf_motion *a, *b;
    box_sides box;
    part_counts some_a, some_b;
    state->query.stats.leaf_pairs++;
    a = sc_leaf_step_get(state, leaf_a, 0);
    patch_sides(m, first + leaf_b, m->margin / 2, &box);
    parts_near(a, &box, &some_a);
    count_tests(state, 1);
    if (!some_a.triangles) return;
    b = sc_leaf_step_get(state, leaf_b, 1);
    patch_sides(m, first + leaf_a, m->margin / 2, &box);
    parts_near(b, &box, &some_b);
    count_tests(state, 1);
    if (!some_b.triangles) return;
    vertices_with_faces(state, a, some_a.points, b, some_b.triangles);
    vertices_with_faces(state, b, some_b.points, a, some_a.triangles);
    edges_with_edges(state, a, some_a.edges, b, some_b.edges);
}

static void step_leaf_itself(sc_step_state *state, uint32_t leaf)
{
    const sc_leaf_motion *a = sc_leaf_step_get(state, leaf, 0);
    state->query.stats.leaf_pairs++;
    vertices_with_faces(state, a, ((uint64_t)1 << a->points) - 1, a, ~(uint64_t)0);
    edges_with_edges(state, a, ((uint64_t)1 << a->edges) - 1, a, ~(uint64_t)0);
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
