/*
 * The triangles of two leaf clusters, or of one: boxes against boxes, row by row; then what is left, sixteen pairs at a
 * time, by planes and by sides in a projection. See query_kernels.h.
 *
 * SPDX-License-Identifier: MIT
 *
 * All of it is in single precision on the points in the unit box. Each coordinate is off by POINT = 3e-8 at most, so
 * that the difference of two is by EDGE = 6e-8. Let D be the largest extent of the two clusters' boxes together, which
 * bounds all differences, and v = 2^-24.
 *
 * A distance from a plane, up to a factor, is d = (e x f) . w, a sum of six products; e and f are two edges, w runs from
 * their corner to another triangle's. With S = |e|1 + |f|1 <= 6 D: moving the components of one of them by EDGE changes
 * d by 2 EDGE |f|1 D, 2 EDGE |e|1 D and EDGE |e|1 |f|1 <= 1.5 EDGE D S at most; of two, by 2 EDGE^2 S + 6 EDGE^2 D; of all
 * three, by 6 EDGE^3; and rounding (eight times a product) by 8.01 v |e|1 |f|1 D <= 12.1 v D^2 S. All of it is below
 * S (4 EDGE (D + EDGE) + 13 v D^2) + 7 EDGE^2 (D + EDGE), however that is rounded.
 *
 * A side in a projection is d = e_0 p_1 - e_1 p_0, |e|, |p| <= D: off by EDGE (|e|1 + |p|1) <= 4 EDGE D, 2 EDGE^2, and by
 * rounding 4.01 v 2 D^2: below 5 EDGE (D + EDGE) + 9 v D^2.
 *
 * A place along a direction n of the points of a cluster, x in the unit box: off by POINT |n|1, and by rounding 3.01 v |n|1,
 * 2.1e-7 |n|1 in all, and a few FLT_MIN for products that underflow. Two of them and the sum of one with the bound are
 * below 5e-7 |n|1 + 16 FLT_MIN.
 *
 * The other bounds are above 1e-21: what underflows does not matter.
 */
/* Bit k: box i of a overlaps box j + k of b, for k from 0 to 15. */
static inline unsigned SC_KERNEL(overlap)(const sc_boxes *a, uint64_t i, const sc_boxes *b,
                                          uint64_t j)
{
    lanes_mask m[3];
    int k;
    SC_UNROLL
    for (k = 0; k < 3; k++)
        m[k] =
            lanes_both(lanes_not_above(lanes_all(a->side[k][i]), lanes_load(b->side[k + 3] + j)),
                       lanes_not_above(lanes_load(b->side[k] + j), lanes_all(a->side[k + 3][i])));
    return lanes_bits(lanes_both(m[0], lanes_both(m[1], m[2])));
}

/* Where the points of a leaf cluster are along a direction. */
static inline lanes SC_KERNEL(along)(const sc_query_state *state, uint32_t leaf,
                                     const float direction[3])
{
    const float *at = state->workspace->leaf_at + 3 * SC_LEAF_POINTS * (uint64_t)leaf;
    lanes x = lanes_multiply(lanes_all(direction[0]), lanes_load(at));
    lanes y = lanes_multiply(lanes_all(direction[1]), lanes_load(at + SC_LEAF_POINTS));
    lanes z = lanes_multiply(lanes_all(direction[2]), lanes_load(at + 2 * SC_LEAF_POINTS));
    return lanes_add(lanes_add(x, y), z);
}

/* Corners and boxes of the triangles of a leaf cluster. */
static void SC_KERNEL(make_boxes)(const sc_query_state *state, uint32_t leaf, sc_leaf_ready *ready)
{
    const sc_model *model = state->model;
    const uint32_t *first = sc_model_leaf_first(model) + leaf;
    const lanes ulp = lanes_all(1.1920929e-7f), least = lanes_all(FLT_MIN); /* see base/boxes.h */
    lanes x[3][3];
    uint32_t i;
    int k, c;
    lanes_corners(state->workspace->leaf_at + 3 * SC_LEAF_POINTS * (uint64_t)leaf,
                  sc_model_leaf_corner(model) + 3 * SC_LEAF_MAX * (uint64_t)leaf, x);
    SC_UNROLL
    for (c = 0; c < 3; c++) {
        lanes low = lanes_smaller(x[0][c], lanes_smaller(x[1][c], x[2][c]));
        lanes high = lanes_larger(x[0][c], lanes_larger(x[1][c], x[2][c]));
        low = lanes_subtract(low, lanes_add(lanes_multiply(lanes_absolute(low), ulp), least));
        high = lanes_add(high, lanes_add(lanes_multiply(lanes_absolute(high), ulp), least));
        lanes_store(ready->side[c], low);
        lanes_store(ready->side[c + 3], high);
        for (i = first[1] - first[0]; i < SC_LEAF_MAX; i++) /* no triangle: overlaps nothing */
            ready->side[c][i] = ready->side[c + 3][i] = (float)NAN;
        SC_UNROLL
        for (k = 0; k < 3; k++) lanes_store(ready->corner[k][c], x[k][c]);
    }
    ready->leaf = leaf;
    ready->tick = state->workspace->pose_tick;
    ready->has_normals = 0;
}

/* What is made of these. */
static void SC_KERNEL(make_normals)(sc_leaf_ready *ready)
{
    lanes x[3][3], e[3], f[3], n[3], size;
    int k, c;
    SC_UNROLL
    for (k = 0; k < 3; k++) {
        SC_UNROLL
        for (c = 0; c < 3; c++) x[k][c] = lanes_load(ready->corner[k][c]);
    }
    SC_UNROLL
    for (c = 0; c < 3; c++) {
        e[c] = lanes_subtract(x[1][c], x[0][c]);
        f[c] = lanes_subtract(x[2][c], x[0][c]);
    }
    size = lanes_add(lanes_absolute(e[0]), lanes_absolute(f[0]));
    SC_UNROLL
    for (c = 1; c < 3; c++)
        size = lanes_add(size, lanes_add(lanes_absolute(e[c]), lanes_absolute(f[c])));
    lanes_store(ready->size, size);
    SC_UNROLL
    for (c = 0; c < 3; c++) {
        n[c] = lanes_subtract(lanes_multiply(e[(c + 1) % 3], f[(c + 2) % 3]),
                              lanes_multiply(e[(c + 2) % 3], f[(c + 1) % 3]));
        lanes_store(ready->normal[c], n[c]);
    }
    ready->has_normals = 1;
}

/* A leaf cluster with its boxes; side is 0 for the lower of two, 1 for the other. */
static inline sc_leaf_ready *SC_KERNEL(boxes)(const sc_query_state *state, uint32_t leaf,
                                              uint32_t side)
{
    sc_leaf_ready *ready = state->workspace->ready + SC_READY_KEPT * side + leaf % SC_READY_KEPT;
    if (ready->leaf != leaf || ready->tick != state->workspace->pose_tick)
        SC_KERNEL(make_boxes)(state, leaf, ready);
    return ready;
}

/* The same with all that there is. */
static inline const sc_leaf_ready *SC_KERNEL(ready)(const sc_query_state *state, uint32_t leaf,
                                                    uint32_t side)
{
    sc_leaf_ready *ready = SC_KERNEL(boxes)(state, leaf, side);
    if (!ready->has_normals) SC_KERNEL(make_normals)(ready);
    return ready;
}

/* The slab of a leaf cluster; side as above. */
static const sc_leaf_slab *SC_KERNEL(slab)(const sc_query_state *state, uint32_t leaf,
                                           uint32_t side)
{
    sc_leaf_slab *slab = state->workspace->slab + leaf;
    if (slab->tick != state->workspace->pose_tick) {
        const sc_leaf_ready *ready = SC_KERNEL(ready)(state, leaf, side);
        float reach = 16 * FLT_MIN;
        lanes along;
        int c;
        for (c = 0; c < 3; c++) {
            slab->direction[c] = lanes_sum(lanes_load(ready->normal[c]));
            reach += 5e-7f * fabsf(slab->direction[c]);
        }
        along = SC_KERNEL(along)(state, leaf, slab->direction);
        slab->ends[0] = lanes_least(along) - reach;
        slab->ends[1] = lanes_most(along) + reach;
        slab->tick = state->workspace->pose_tick;
    }
    return slab;
}

/* Whether all points of a leaf cluster are certainly before a slab, or behind. */
static inline int SC_KERNEL(is_beside)(const sc_query_state *state, uint32_t leaf,
                                       const sc_leaf_slab *slab)
{
    lanes along = SC_KERNEL(along)(state, leaf, slab->direction);
    return lanes_bits(lanes_below(along, lanes_all(slab->ends[0]))) == 0xffffu ||
           lanes_bits(lanes_below(lanes_all(slab->ends[1]), along)) == 0xffffu;
}

/* Largest extent of the boxes of two leaf clusters together. */
static float SC_KERNEL(extent)(const sc_query_state *state, uint32_t a, uint32_t b)
{
    const sc_boxes *boxes = &state->workspace->patch_boxes;
    uint32_t leaves = sc_model_first_leaf_patch(state->model);
    float extent = 0;
    int c;
    SC_UNROLL
    for (c = 0; c < 3; c++) {
        const float *low = boxes->side[c] + leaves, *high = boxes->side[c + 3] + leaves;
        float length =
            (high[a] > high[b] ? high[a] : high[b]) - (low[a] < low[b] ? low[a] : low[b]);
        if (length > extent) extent = length;
    }
    return extent;
}

/* The lanes in which a plane, given by a normal, its size and a point, certainly has all corners of o on one side. */
static inline unsigned SC_KERNEL(plane_separates)(const lanes n[3], lanes size, const lanes p[3],
                                                  lanes o[3][3], float extent)
{
    const float edge = 6e-8f, v = 5.9604644775390625e-8f;
    lanes bound, least = lanes_all(0), most = least;
    int k, c;
    bound = lanes_add(
        lanes_multiply(size, lanes_all(4 * edge * (extent + edge) + 13 * v * extent * extent)),
        lanes_all(7 * edge * edge * (extent + edge)));
    SC_UNROLL
    for (k = 0; k < 3; k++) {
        lanes d = lanes_multiply(n[0], lanes_subtract(o[k][0], p[0]));
        SC_UNROLL
        for (c = 1; c < 3; c++)
            d = lanes_add(d, lanes_multiply(n[c], lanes_subtract(o[k][c], p[c])));
        least = k ? lanes_smaller(least, d) : d;
        most = k ? lanes_larger(most, d) : d;
    }
    return lanes_bits(lanes_below(bound, least)) |
           lanes_bits(lanes_below(most, lanes_subtract(lanes_all(0), bound)));
}

/* The lanes in which, seen along the axis nearest to the normal n of one, the line of an edge certainly has the third
   corner of its triangle on one side and all of the other triangle on the other. */
static unsigned SC_KERNEL(side_separates)(lanes x[2][3][3], const lanes n[3], float extent)
{
    const float edge = 6e-8f, v = 5.9604644775390625e-8f;
    const lanes bound = lanes_all(5 * edge * (extent + edge) + 9 * v * extent * extent);
    const lanes minus_bound = lanes_subtract(lanes_all(0), bound);
    lanes size[3], flat[2][3][2];
    lanes_mask first, second;
    unsigned apart = 0;
    int s, k, i, c;
    SC_UNROLL
    for (c = 0; c < 3; c++) size[c] = lanes_absolute(n[c]);
    first = lanes_below(lanes_larger(size[1], size[2]), size[0]);
    second = lanes_below(size[2], size[1]);
    SC_UNROLL
    for (s = 0; s < 2; s++) {
        SC_UNROLL
        for (k = 0; k < 3; k++) {
            lanes last = lanes_choose(second, x[s][k][2], x[s][k][1]);
            flat[s][k][0] = lanes_choose(first, x[s][k][1], x[s][k][0]);
            flat[s][k][1] = lanes_choose(first, x[s][k][2], last);
        }
    }
    SC_UNROLL
    for (s = 0; s < 2; s++) {
        SC_UNROLL
        for (k = 0; k < 3; k++) {
            lanes(*t)[2] = flat[s], (*o)[2] = flat[1 - s];
            int next = (k + 1) % 3, third = (k + 2) % 3;
            lanes e0 = lanes_subtract(t[next][0], t[k][0]);
            lanes e1 = lanes_subtract(t[next][1], t[k][1]);
            lanes own = lanes_subtract(lanes_multiply(e0, lanes_subtract(t[third][1], t[k][1])),
                                       lanes_multiply(e1, lanes_subtract(t[third][0], t[k][0])));
            lanes least = lanes_all(0), most = least;
            SC_UNROLL
            for (i = 0; i < 3; i++) {
                lanes d = lanes_subtract(lanes_multiply(e0, lanes_subtract(o[i][1], t[k][1])),
                                         lanes_multiply(e1, lanes_subtract(o[i][0], t[k][0])));
                least = i ? lanes_smaller(least, d) : d;
                most = i ? lanes_larger(most, d) : d;
            }
            apart |=
                lanes_bits(lanes_both(lanes_below(bound, own), lanes_below(most, minus_bound)));
            apart |=
                lanes_bits(lanes_both(lanes_below(own, minus_bound), lanes_below(bound, least)));
        }
    }
    return apart;
}

/* The lanes in which the triangles of two clusters with these numbers are not certainly apart. */
static unsigned SC_KERNEL(test_pairs)(const sc_leaf_ready *a, const sc_leaf_ready *b,
                                      const uint8_t *of_a, const uint8_t *of_b, unsigned mask,
                                      float extent)
{
    lanes_index i = lanes_index_load(of_a), j = lanes_index_load(of_b);
    lanes x[2][3][3], n[3];
    int k, c;
    SC_UNROLL
    for (k = 0; k < 3; k++) {
        SC_UNROLL
        for (c = 0; c < 3; c++) {
            x[0][k][c] = lanes_pick(a->corner[k][c], i);
            x[1][k][c] = lanes_pick(b->corner[k][c], j);
        }
    }
    SC_UNROLL
    for (c = 0; c < 3; c++) n[c] = lanes_pick(b->normal[c], j);
    mask &= ~SC_KERNEL(plane_separates)(n, lanes_pick(b->size, j), x[1][0], x[0], extent);
    SC_UNROLL
    for (c = 0; c < 3; c++) n[c] = lanes_pick(a->normal[c], i);
    mask &= ~SC_KERNEL(plane_separates)(n, lanes_pick(a->size, i), x[0][0], x[1], extent);
    if (sc_bits_count(mask) >= SC_SIDES_WORTH) mask &= ~SC_KERNEL(side_separates)(x, n, extent);
    return mask;
}

/* Collects those of the pairs listed that are not certainly apart. */
static void SC_KERNEL(collect)(sc_query_state *state, uint32_t leaf_a, uint32_t leaf_b,
                               uint8_t *of_a, uint8_t *of_b, unsigned count)
{
    const uint32_t *first = sc_model_leaf_first(state->model);
    const sc_leaf_ready *a = NULL, *b = NULL;
    float extent = 0;
    unsigned at;
    if (count >= SC_LEAF_FEW) {
        a = SC_KERNEL(ready)(state, leaf_a, leaf_a > leaf_b);
        b = SC_KERNEL(ready)(state, leaf_b, leaf_a < leaf_b);
        extent = SC_KERNEL(extent)(state, leaf_a, leaf_b);
        memset(of_a + count, 0, SC_LANES_COUNT); /* fills the last row */
        memset(of_b + count, 0, SC_LANES_COUNT);
    }
    for (at = 0; at < count; at += SC_LANES_COUNT) {
        unsigned mask = count - at < SC_LANES_COUNT ? (1u << (count - at)) - 1u : 0xffffu;
        if (count >= SC_LEAF_FEW)
            mask = SC_KERNEL(test_pairs)(a, b, of_a + at, of_b + at, mask, extent);
        for (; mask; mask &= mask - 1) {
            uint32_t lane = at + sc_bits_lowest(mask);
            sc_candidates_add(state, first[leaf_a] + of_a[lane], first[leaf_b] + of_b[lane]);
        }
    }
}

/* Rows of triangles of cluster p->a against all of cluster p->b, of which only some may overlap one of a. Most pairs
   share points round which nothing can happen, and are dropped here. */
static void SC_KERNEL(compare_leaves)(sc_query_state *state, sc_leaf_pair *p, unsigned rows,
                                      unsigned some)
{
    const sc_leaf_ready *a = SC_KERNEL(boxes)(state, p->a, p->a > p->b);
    const sc_leaf_ready *b = SC_KERNEL(boxes)(state, p->b, p->b > p->a);
    uint8_t of_a[SC_LEAF_PAIRS + 2 * SC_LANES_COUNT], of_b[SC_LEAF_PAIRS + 2 * SC_LANES_COUNT];
    uint64_t tests = 0;
    unsigned count = 0;
    lanes low[3], high[3];
    int k;
    SC_UNROLL
    for (k = 0; k < 3; k++) {
        low[k] = lanes_load(b->side[k]);
        high[k] = lanes_load(b->side[k + 3]);
    }
    for (; rows; rows &= rows - 1, tests++) {
        uint32_t i = sc_bits_lowest(rows);
        lanes_mask m[3];
        unsigned mask, shared = p->shared[i];
        SC_UNROLL
        for (k = 0; k < 3; k++)
            m[k] = lanes_both(lanes_not_above(lanes_all(a->side[k][i]), high[k]),
                              lanes_not_above(low[k], lanes_all(a->side[k + 3][i])));
        mask = lanes_bits(lanes_both(m[0], lanes_both(m[1], m[2]))) & some;
        if (p->a == p->b) mask &= ~((2u << i) - 1u);
        mask &= ~(shared & (p->plain_a >> i & 1u ? SC_LEAF_ALL : p->plain_b));
        if (!mask) continue;
        if (mask & shared) sc_candidates_take_neighbors(state, p, i, mask & shared);
        mask &= ~shared;
        memset(of_a + count, (int)i, SC_LANES_COUNT);
        count += lanes_list(mask, of_b + count);
    }
    state->stats.counts[sc_state_box_task(state)] += tests;
    if (count) SC_KERNEL(collect)(state, p->a, p->b, of_a, of_b, count);
    sc_candidates_make_room(state);
}

/* The triangles of leaf a whose boxes overlap that of leaf b. */
static unsigned SC_KERNEL(rows_at)(const sc_query_state *state, uint32_t a, uint32_t b)
{
    sc_leaf_ready *ready = SC_KERNEL(boxes)(state, a, a > b);
    sc_boxes row;
    int k;
    SC_UNROLL
    for (k = 0; k < 6; k++) row.side[k] = ready->side[k];
    return SC_KERNEL(overlap)(&state->workspace->patch_boxes,
                              sc_model_first_leaf_patch(state->model) + b, &row, 0);
}

static void SC_KERNEL(leaf_pair)(sc_query_state *state, uint32_t leaf_a, uint32_t leaf_b)
{
    uint32_t a = leaf_a < leaf_b ? leaf_a : leaf_b, b = leaf_a < leaf_b ? leaf_b : leaf_a;
    sc_leaf_pair p;
    unsigned rows = SC_KERNEL(rows_at)(state, a, b), some;
    state->stats.leaf_pairs++;
    state->stats.counts[sc_state_box_task(state)]++;
    if (!rows) return;
    sc_candidates_enter(state, a, b, &p);
    if (!p.shares && (SC_KERNEL(is_beside)(state, b, SC_KERNEL(slab)(state, a, 0)) ||
                      SC_KERNEL(is_beside)(state, a, SC_KERNEL(slab)(state, b, 1))))
        return;
    some = SC_KERNEL(rows_at)(state, b, a);
    state->stats.counts[sc_state_box_task(state)]++;
    if (!some) return;
    if (!p.shares && sc_bits_count(some) < sc_bits_count(rows)) { /* either may be the rows */
        unsigned swap = some;
        p.a = b;
        p.b = a;
        some = rows;
        rows = swap;
    }
    SC_KERNEL(compare_leaves)(state, &p, rows, some);
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
