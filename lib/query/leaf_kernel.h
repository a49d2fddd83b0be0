/*
 * The triangles of two leaf clusters, or of one: boxes against boxes, row by row; then what is left, sixteen pairs at a
 * time, by planes, by the order along the line in which two planes meet, and by sides in a projection. Pairs that are
 * certain to meet are taken, pairs of which nothing is certain are collected. See query_kernels.h.
 *
 * SPDX-License-Identifier: MIT
 *
 * All of it is in single precision on the points in the unit box. Each coordinate is off by POINT = 3e-8 at most, so
 * that the difference of two is by EDGE = 6e-8. Let D be the largest extent of the two clusters' boxes together, which
 * bounds all differences, and v = 2^-24.
 *
 * A distance from a plane, up to a factor, is d = (e x f) . w, a sum of six products; e and f are two edges, w runs from
 * their corner p to a corner x of another triangle. With S = |e|1 + |f|1 <= 6 D: moving the components of one of them by
 * EDGE changes d by 2 EDGE |f|1 D, 2 EDGE |e|1 D and EDGE |e|1 |f|1 <= 1.5 EDGE D S at most; of two, by
 * 2 EDGE^2 S + 6 EDGE^2 D; of all three, by 6 EDGE^3: below S 4 EDGE (D + EDGE) + 7 EDGE^2 (D + EDGE) in all. The normal
 * n = e x f is rounded, by 4.01 v |e|1 |f|1 in all, which changes d by 6.02 v D^2 S at most. It is computed as n . x - n . p,
 * where one product is compared with the other and the bound, or their difference with the bound: both products are off by
 * 3.01 v |n|1, as no coordinate is above 1, the sum of one with the bound by 1.01 v |n|1 and a part of the bound, and the
 * difference by a part of itself. |n|1 <= 1.01 |e|1 |f|1 <= S^2 / 3.96: together 1.8 v S^2. All of it is below
 * S (2.1 v S + 4 EDGE (D + EDGE) + 7 v D^2) + 8 EDGE^2 (D + EDGE), however that is rounded.
 *
 * If the plane of each of two triangles has a corner of the other, its tip, on one side and two on the other, the planes meet
 * in a line, which crosses the edges from the tips inside them; of a triangle, what is between its two crossings is on that
 * line. Let e and f be such edges of either, w run from tip to tip, and x and y be where the line crosses e and f. Then
 * d = (e x f) . w = (e x f) . (y - x), and as n x n' is along the line and (e x f) . (n x n') = -(e . n') (f . n), of
 * which the sign is the same for all four of such edges, the signs of the four d tell in which order x and y are. If they
 * are the same the triangles are apart, if not they meet; and so does an edge whose two signs differ, no matter
 * how contacts are defined, as nothing is zero. Each of six products meets three differences, two products and three sums:
 * d is off by 8.01 v |e|1 |f|1 D. Let S be the sum of that of both triangles, >= |e|1 + |f|1. As |e|1 |f|1 is below S^2 / 4
 * and 1.5 D S, and D <= 2, this is below 2.01 v S^2 + 6.01 v D^2 S; and what moving the points changes is as above: the bound
 * above holds.
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
    lanes at[3];
    int k;
    lanes_turned(state->workspace->point_at + 4 * SC_LEAF_POINTS * (uint64_t)leaf, at);
    SC_UNROLL
    for (k = 0; k < 3; k++) at[k] = lanes_multiply(lanes_all(direction[k]), at[k]);
    return lanes_add(lanes_add(at[0], at[1]), at[2]);
}

/* The corners of a leaf cluster's triangles. */
static inline void SC_KERNEL(leaf_corners)(const sc_query_state *state, uint32_t leaf,
                                           lanes x[3][3])
{
    lanes_corners_at(state->workspace->point_at + 4 * SC_LEAF_POINTS * (uint64_t)leaf,
                     sc_model_leaf_corner(state->model) + 3 * SC_LEAF_MAX * (uint64_t)leaf, x);
}

/* Boxes of the triangles of a leaf cluster. */
static void SC_KERNEL(make_boxes)(const sc_query_state *state, uint32_t leaf, sc_leaf_ready *ready)
{
    const uint32_t *first = sc_model_leaf_first(state->model) + leaf;
    const lanes ulp = lanes_all(1.1920929e-7f), least = lanes_all(FLT_MIN); /* see base/boxes.h */
    lanes x[3][3];
    uint32_t i;
    int c;
    SC_KERNEL(leaf_corners)(state, leaf, x);
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
    }
}

/* Their planes. */
static void SC_KERNEL(make_normals)(const sc_query_state *state, uint32_t leaf,
                                    sc_leaf_ready *ready)
{
    lanes x[3][3], e[3], f[3], n[3], size, offset;
    int c;
    SC_KERNEL(leaf_corners)(state, leaf, x);
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
    offset = lanes_multiply(n[0], x[0][0]);
    SC_UNROLL
    for (c = 1; c < 3; c++) offset = lanes_add(offset, lanes_multiply(n[c], x[0][c]));
    lanes_store(ready->offset, offset);
}

/* Where a leaf cluster is kept; is_upper: it is the upper of the two of a pair. */
static inline uint32_t SC_KERNEL(place)(const sc_query_state *state, uint32_t leaf, int is_upper)
{
    const sc_workspace *w = state->workspace;
    return (leaf & w->ready_mask) + (is_upper ? w->ready_upper : 0);
}

/* A leaf cluster with its boxes. */
static inline const sc_leaf_ready *SC_KERNEL(boxes)(const sc_query_state *state, uint32_t leaf,
                                                    int is_upper)
{
    sc_workspace *w = state->workspace;
    uint32_t at = SC_KERNEL(place)(state, leaf, is_upper);
    sc_leaf_known *known = w->known + at;
    if (known->leaf != leaf || known->boxes != w->pose_tick) {
        SC_KERNEL(make_boxes)(state, leaf, w->ready + at);
        known->leaf = leaf;
        known->boxes = w->pose_tick;
        known->has_normals = 0;
    }
    return w->ready + at;
}

/* The same with all that there is. */
static inline const sc_leaf_ready *SC_KERNEL(ready)(const sc_query_state *state, uint32_t leaf,
                                                    int is_upper)
{
    sc_workspace *w = state->workspace;
    uint32_t at = SC_KERNEL(place)(state, leaf, is_upper);
    SC_KERNEL(boxes)(state, leaf, is_upper);
    if (!w->known[at].has_normals) {
        SC_KERNEL(make_normals)(state, leaf, w->ready + at);
        w->known[at].has_normals = 1;
    }
    return w->ready + at;
}

/* Makes the slab of a leaf cluster; is_upper as above. */
static void SC_KERNEL(make_slab)(const sc_query_state *state, uint32_t leaf, int is_upper)
{
    sc_leaf_slab *slab = state->workspace->slab + leaf;
    const sc_leaf_ready *ready = SC_KERNEL(ready)(state, leaf, is_upper);
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

/* That slab. */
static inline const sc_leaf_slab *SC_KERNEL(slab)(const sc_query_state *state, uint32_t leaf,
                                                  int is_upper)
{
    const sc_leaf_slab *slab = state->workspace->slab + leaf;
    if (slab->tick != state->workspace->pose_tick) SC_KERNEL(make_slab)(state, leaf, is_upper);
    return slab;
}

/* Not 0 if all points of a leaf cluster are certainly before a slab, or behind. Without branches, as either may be. */
static inline unsigned SC_KERNEL(is_beside)(const sc_query_state *state, uint32_t leaf,
                                            const sc_leaf_slab *slab)
{
    lanes along = SC_KERNEL(along)(state, leaf, slab->direction);
    return (unsigned)(lanes_every(lanes_below(along, lanes_all(slab->ends[0])))) |
           (unsigned)(lanes_every(lanes_below(lanes_all(slab->ends[1]), along)));
}

/* Whether the slab of one of two leaf clusters, a < b, certainly has the other on one side. If they share a point, it
   is in both, to the last bit. */
static inline unsigned SC_KERNEL(slabs_part)(const sc_query_state *state, uint32_t a, uint32_t b)
{
    const sc_leaf_slab *of_a = SC_KERNEL(slab)(state, a, 0), *of_b = SC_KERNEL(slab)(state, b, 1);
    return SC_KERNEL(is_beside)(state, b, of_a) | SC_KERNEL(is_beside)(state, a, of_b);
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

/* Triangles of a leaf cluster as they are picked: sixteen by number. */
typedef struct SC_KERNEL(picked) {
    const sc_leaf_ready *ready;
    const float *points;    /* see sc_workspace.point_at */
    const uint8_t *corner;  /* see sc_model.leaf_corner */
    const uint8_t *numbers; /* of the triangles */
} SC_KERNEL(picked);

/* The corners of these. */
static inline void SC_KERNEL(pick_corners)(const SC_KERNEL(picked) * t, lanes x[3][3])
{
    lanes_corners_through(t->points, t->corner, t->numbers, x);
}

/* What a distance from a plane, up to a factor, may be off by. */
static inline lanes SC_KERNEL(plane_bound)(lanes size, float extent)
{
    const float edge = 6e-8f, v = 5.9604644775390625e-8f;
    lanes bound = lanes_add(lanes_multiply(size, lanes_all(2.1f * v)),
                            lanes_all(4 * edge * (extent + edge) + 7 * v * extent * extent));
    return lanes_add(lanes_multiply(size, bound), lanes_all(8 * edge * edge * (extent + edge)));
}

/* Of triangles of which the plane of another splits the corners: the one alone on its side, and the edges from there to the
   next corner and to the one after. */
typedef struct SC_KERNEL(tips) {
    lanes at[3], edge[2][3];
    unsigned is[2];         /* the lanes in which the corner is the first, and the second */
    unsigned beside, split; /* where all corners are certainly on one side, or certainly not */
} SC_KERNEL(tips);

static inline void SC_KERNEL(find_tips)(const SC_KERNEL(picked) * t,
                                        const SC_KERNEL(picked) * plane, float extent,
                                        SC_KERNEL(tips) * tips)
{
    lanes_index i = lanes_index_load(plane->numbers);
    lanes offset = lanes_pick(plane->ready->offset, i), x[3][3], n[3], least;
    lanes bound = SC_KERNEL(plane_bound)(lanes_pick(plane->ready->size, i), extent);
    lanes_mask below[3], is_not[2];
    unsigned sure;
    int k, c;
    SC_KERNEL(pick_corners)(t, x);
    SC_UNROLL
    for (c = 0; c < 3; c++) n[c] = lanes_pick(plane->ready->normal[c], i);
    SC_UNROLL
    for (k = 0; k < 3; k++) {
        lanes d = lanes_multiply(n[0], x[k][0]);
        SC_UNROLL
        for (c = 1; c < 3; c++) d = lanes_add(d, lanes_multiply(n[c], x[k][c]));
        below[k] = lanes_below(d, offset);
        d = lanes_absolute(lanes_subtract(d, offset));
        least = k ? lanes_smaller(least, d) : d;
    }
    SC_UNROLL
    for (k = 0; k < 2; k++) {
        is_not[k] = lanes_differ(below[1 - k], below[2]);
        tips->is[k] = ~lanes_bits(is_not[k]);
    }
    SC_UNROLL
    for (c = 0; c < 3; c++) {
        lanes p = lanes_choose(is_not[0], lanes_choose(is_not[1], x[2][c], x[1][c]), x[0][c]);
        lanes q = lanes_choose(is_not[0], lanes_choose(is_not[1], x[0][c], x[2][c]), x[1][c]);
        lanes r = lanes_choose(is_not[0], lanes_choose(is_not[1], x[1][c], x[0][c]), x[2][c]);
        tips->at[c] = p;
        tips->edge[0][c] = lanes_subtract(q, p);
        tips->edge[1][c] = lanes_subtract(r, p);
    }
    sure = lanes_bits(lanes_below(bound, least));
    tips->beside = sure & tips->is[0] & tips->is[1];
    tips->split = sure & ~tips->beside;
}

/* What is certain of pairs: the lanes in which they are apart, or meet; then also, in which ones edge k of the first, or k - 3
   of the second, meets the other. */
typedef struct SC_KERNEL(verdict) {
    unsigned apart, meets, edge[6];
} SC_KERNEL(verdict);

/* Edges that meet, in these lanes the one from the tip to the next corner and to the one after. */
static inline void SC_KERNEL(name_edges)(const SC_KERNEL(tips) * t, unsigned next, unsigned after,
                                         unsigned edge[3])
{
    unsigned third = ~(t->is[0] | t->is[1]);
    edge[0] = (next & t->is[0]) | (after & t->is[1]);
    edge[1] = (next & t->is[1]) | (after & third);
    edge[2] = (next & third) | (after & t->is[0]);
}

/* Those of pairs in a mask of which each plane splits the other. */
static inline void SC_KERNEL(cross_edges)(const SC_KERNEL(tips) tips[2], lanes bound, unsigned mask,
                                          SC_KERNEL(verdict) * verdict)
{
    lanes w[3], m[3], least = lanes_all(0);
    unsigned below[2][2], any, all;
    int i, j, c;
    SC_UNROLL
    for (c = 0; c < 3; c++) w[c] = lanes_subtract(tips[1].at[c], tips[0].at[c]);
    SC_UNROLL
    for (j = 0; j < 2; j++) {
        const lanes *f = tips[1].edge[j];
        SC_UNROLL
        for (c = 0; c < 3; c++)
            m[c] = lanes_subtract(lanes_multiply(f[(c + 1) % 3], w[(c + 2) % 3]),
                                  lanes_multiply(f[(c + 2) % 3], w[(c + 1) % 3]));
        SC_UNROLL
        for (i = 0; i < 2; i++) {
            const lanes *e = tips[0].edge[i];
            lanes d = lanes_multiply(e[0], m[0]);
            SC_UNROLL
            for (c = 1; c < 3; c++) d = lanes_add(d, lanes_multiply(e[c], m[c]));
            below[i][j] = lanes_bits(lanes_below(d, lanes_all(0)));
            d = lanes_absolute(d);
            least = i | j ? lanes_smaller(least, d) : d;
        }
    }
    mask &= tips[0].split & tips[1].split & lanes_bits(lanes_below(bound, least));
    any = below[0][0] | below[0][1] | below[1][0] | below[1][1];
    all = below[0][0] & below[0][1] & below[1][0] & below[1][1];
    verdict->apart = mask & (all | ~any);
    verdict->meets = mask &= any & ~all;
    SC_KERNEL(name_edges)
    (&tips[0], mask & (below[0][0] ^ below[0][1]), mask & (below[1][0] ^ below[1][1]),
     verdict->edge);
    SC_KERNEL(name_edges)
    (&tips[1], mask & (below[0][0] ^ below[1][0]), mask & (below[0][1] ^ below[1][1]),
     verdict->edge + 3);
}

/* The lanes in which, seen along the axis nearest to the normal n of one, the line of an edge certainly has the third
   corner of its triangle on one side and all of the other triangle on the other. */
static unsigned SC_KERNEL(side_separates)(lanes x[2][3][3], const lanes n[3], float extent)
{
    const float edge = 6e-8f, v = 5.9604644775390625e-8f;
    const lanes bound = lanes_all(5 * edge * (extent + edge) + 9 * v * extent * extent);
    const lanes minus_bound = lanes_subtract(lanes_all(0), bound);
    lanes flat[2][3][2];
    unsigned apart = 0;
    int s, k, i;
    SC_UNROLL
    for (s = 0; s < 2; s++) SC_KERNEL(see_along)(n, (const lanes(*)[3])x[s], 3, flat[s]);
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

/* Pairs in a mask, of triangles of two clusters with these numbers. */
static void SC_KERNEL(test_pairs)(const SC_KERNEL(picked) * a, const SC_KERNEL(picked) * b,
                                  unsigned mask, float extent, SC_KERNEL(verdict) * verdict)
{
    lanes_index i = lanes_index_load(a->numbers);
    SC_KERNEL(tips) tips[2];
    unsigned open;
    lanes size;
    SC_KERNEL(find_tips)(a, b, extent, &tips[0]);
    open = mask & ~tips[0].beside;
    verdict->meets = 0;
    verdict->apart = ~0u;
    if (!open) return;
    SC_KERNEL(find_tips)(b, a, extent, &tips[1]);
    open &= ~tips[1].beside;
    size = lanes_add(lanes_pick(a->ready->size, i),
                     lanes_pick(b->ready->size, lanes_index_load(b->numbers)));
    SC_KERNEL(cross_edges)(tips, SC_KERNEL(plane_bound)(size, extent), open, verdict);
    open &= ~(verdict->apart | verdict->meets);
    if (sc_bits_count(open & ~(tips[0].split & tips[1].split)) >= SC_SIDES_WORTH) {
        lanes x[2][3][3], n[3];
        int c;
        SC_KERNEL(pick_corners)(a, x[0]);
        SC_KERNEL(pick_corners)(b, x[1]);
        SC_UNROLL
        for (c = 0; c < 3; c++) n[c] = lanes_pick(a->ready->normal[c], i);
        open &= ~SC_KERNEL(side_separates)(x, n, extent);
    }
    verdict->apart = ~(open | verdict->meets);
}

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
