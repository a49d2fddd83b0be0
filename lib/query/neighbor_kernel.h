/*
 * Pairs of triangles of two leaf clusters, or of one, that share points: sixteen at a time, which have nothing in common
 * but what they share. See query_kernels.h.
 *
 * SPDX-License-Identifier: MIT
 *
 * If all corners of u that are not t's are strictly on one side of the plane of t, which then has an area, u meets the
 * plane in what they share only. The same is true in a projection of the line of an edge of t, if the corners that they
 * share are on it: its third corner strictly on one side, and those of u that are not shared strictly on the other. Either
 * way no edge that starts and ends elsewhere meets the other triangle, for what is shared, a point or an edge, has no
 * point on the edge of t or u opposite to it. This tells nothing of two triangles that share all.
 *
 * In single precision. What moving the points changes, and the bound of a side, are derived in leaf_kernel.h, in the
 * terms of which d = (e x f) . w, w from the plane's first corner, meets eight roundings here: 8.01 v |e|1 |f|1 D
 * <= 12.1 v D^2 S. All of it is below S (4 EDGE (D + EDGE) + 13 v D^2) + 7 EDGE^2 (D + EDGE), however that is rounded.
 */

/* Sixteen pairs: corners, and which of them are the other's too. */
typedef struct SC_KERNEL(neighbors) {
    lanes at[2][3][3]; /* triangle, corner, axis */
    lanes_mask shared[2][3];
    unsigned same; /* all corners are */
} SC_KERNEL(neighbors);

/* Corners of the triangles of a leaf cluster, and what points they are. */
typedef struct SC_KERNEL(neighbor_corners) {
    float at[3][3][SC_LEAF_MAX];
    float point[3][SC_LEAF_MAX]; /* the bits of these numbers */
} SC_KERNEL(neighbor_corners);

static void SC_KERNEL(find_corners)(const sc_query_state *state, uint32_t leaf,
                                    SC_KERNEL(neighbor_corners) * corners)
{
    const uint8_t *where = sc_model_leaf_corner(state->model) + 3 * SC_LEAF_MAX * (uint64_t)leaf;
    float point[SC_LEAF_POINTS];
    lanes x[3][3];
    int k, c;
    memcpy(point, sc_model_leaf_point(state->model) + SC_LEAF_POINTS * (uint64_t)leaf,
           sizeof point);
    lanes_corners_at(state->workspace->point_at + 4 * SC_LEAF_POINTS * (uint64_t)leaf, where, x);
    SC_UNROLL
    for (k = 0; k < 3; k++) {
        lanes_store(corners->point[k],
                    lanes_pick(point, lanes_index_load(where + SC_LEAF_MAX * k)));
        SC_UNROLL
        for (c = 0; c < 3; c++) lanes_store(corners->at[k][c], x[k][c]);
    }
}

static inline void SC_KERNEL(load_neighbors)(const SC_KERNEL(neighbor_corners) * a,
                                             const SC_KERNEL(neighbor_corners) * b,
                                             const uint8_t *of_a, const uint8_t *of_b,
                                             SC_KERNEL(neighbors) * x)
{
    lanes_index i = lanes_index_load(of_a), j = lanes_index_load(of_b);
    lanes p[3], q[3];
    lanes_mask same[3][3];
    int k, c;
    SC_UNROLL
    for (k = 0; k < 3; k++) {
        p[k] = lanes_pick(a->point[k], i);
        q[k] = lanes_pick(b->point[k], j);
        SC_UNROLL
        for (c = 0; c < 3; c++) {
            x->at[0][k][c] = lanes_pick(a->at[k][c], i);
            x->at[1][k][c] = lanes_pick(b->at[k][c], j);
        }
    }
    SC_UNROLL
    for (k = 0; k < 3; k++) {
        SC_UNROLL
        for (c = 0; c < 3; c++) same[k][c] = lanes_same(p[k], q[c]);
    }
    SC_UNROLL
    for (k = 0; k < 3; k++) {
        x->shared[0][k] = lanes_either(lanes_either(same[k][0], same[k][1]), same[k][2]);
        x->shared[1][k] = lanes_either(lanes_either(same[0][k], same[1][k]), same[2][k]);
    }
    x->same = lanes_bits(lanes_both(x->shared[0][0], lanes_both(x->shared[0][1], x->shared[0][2])));
    x->same |=
        lanes_bits(lanes_both(x->shared[1][0], lanes_both(x->shared[1][1], x->shared[1][2])));
}

/* The lanes in which the plane of triangle s certainly has all corners of the other that are not shared on one side;
   n gets its normal, flat those lanes in which all these corners may be in the plane. */
static inline unsigned SC_KERNEL(plane_parts)(const SC_KERNEL(neighbors) * x, int s, float extent,
                                              lanes n[3], unsigned *flat)
{
    const float edge = 6e-8f, v = 5.9604644775390625e-8f;
    const lanes far = lanes_all(FLT_MAX), minus_far = lanes_all(-FLT_MAX);
    const lanes(*t)[3] = x->at[s], (*o)[3] = x->at[1 - s];
    lanes e[3], f[3], size = lanes_all(0), bound, minus_bound, least = far, most = minus_far;
    int k, c;
    SC_UNROLL
    for (c = 0; c < 3; c++) {
        e[c] = lanes_subtract(t[1][c], t[0][c]);
        f[c] = lanes_subtract(t[2][c], t[0][c]);
        size = lanes_add(size, lanes_add(lanes_absolute(e[c]), lanes_absolute(f[c])));
    }
    SC_UNROLL
    for (c = 0; c < 3; c++)
        n[c] = lanes_subtract(lanes_multiply(e[(c + 1) % 3], f[(c + 2) % 3]),
                              lanes_multiply(e[(c + 2) % 3], f[(c + 1) % 3]));
    bound = lanes_add(
        lanes_multiply(size, lanes_all(4 * edge * (extent + edge) + 13 * v * extent * extent)),
        lanes_all(7 * edge * edge * (extent + edge)));
    SC_UNROLL
    for (k = 0; k < 3; k++) {
        lanes d = lanes_multiply(n[0], lanes_subtract(o[k][0], t[0][0]));
        SC_UNROLL
        for (c = 1; c < 3; c++)
            d = lanes_add(d, lanes_multiply(n[c], lanes_subtract(o[k][c], t[0][c])));
        least = lanes_smaller(least, lanes_choose(x->shared[1 - s][k], far, d));
        most = lanes_larger(most, lanes_choose(x->shared[1 - s][k], minus_far, d));
    }
    minus_bound = lanes_subtract(lanes_all(0), bound);
    *flat =
        lanes_bits(lanes_both(lanes_not_above(most, bound), lanes_not_above(minus_bound, least)));
    return lanes_bits(lanes_below(bound, least)) | lanes_bits(lanes_below(most, minus_bound));
}

/* Corners as they are seen along the axis nearest to n. */
static inline void SC_KERNEL(see_along)(const lanes n[3], const lanes corner[3][3],
                                        lanes flat[3][2])
{
    lanes size[3];
    lanes_mask first, second;
    int k, c;
    SC_UNROLL
    for (c = 0; c < 3; c++) size[c] = lanes_absolute(n[c]);
    first = lanes_below(lanes_larger(size[1], size[2]), size[0]);
    second = lanes_below(size[2], size[1]);
    SC_UNROLL
    for (k = 0; k < 3; k++) {
        const lanes *p = corner[k];
        flat[k][0] = lanes_choose(first, p[1], p[0]);
        flat[k][1] = lanes_choose(first, p[2], lanes_choose(second, p[2], p[1]));
    }
}

/* The lanes in which the line of an edge does, seen along the axis nearest to the normal n of one. */
static unsigned SC_KERNEL(side_parts)(const SC_KERNEL(neighbors) * x, const lanes n[3],
                                      float extent)
{
    const float edge = 6e-8f, v = 5.9604644775390625e-8f;
    const lanes far = lanes_all(FLT_MAX), minus_far = lanes_all(-FLT_MAX);
    const lanes bound = lanes_all(5 * edge * (extent + edge) + 9 * v * extent * extent);
    const lanes minus_bound = lanes_subtract(lanes_all(0), bound);
    lanes flat[2][3][2];
    unsigned apart = 0;
    int s, k, i;
    SC_UNROLL
    for (s = 0; s < 2; s++) SC_KERNEL(see_along)(n, x->at[s], flat[s]);
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
            lanes least = far, most = minus_far;
            unsigned parts;
            SC_UNROLL
            for (i = 0; i < 3; i++) {
                lanes d = lanes_subtract(lanes_multiply(e0, lanes_subtract(o[i][1], t[k][1])),
                                         lanes_multiply(e1, lanes_subtract(o[i][0], t[k][0])));
                least = lanes_smaller(least, lanes_choose(x->shared[1 - s][i], far, d));
                most = lanes_larger(most, lanes_choose(x->shared[1 - s][i], minus_far, d));
            }
            parts = lanes_bits(lanes_both(lanes_below(bound, own), lanes_below(most, minus_bound)));
            parts |=
                lanes_bits(lanes_both(lanes_below(own, minus_bound), lanes_below(bound, least)));
            apart |= parts & ~lanes_bits(x->shared[s][third]);
        }
    }
    return apart;
}

/* Takes those of the pairs listed that may meet outside of what they share; extent is that of both clusters. */
static void SC_KERNEL(take_neighbors)(sc_query_state *state, const sc_leaf_pair *p, float extent,
                                      uint8_t *of_a, uint8_t *of_b, unsigned count)
{
    const uint32_t *first = sc_model_leaf_first(state->model);
    SC_KERNEL(neighbor_corners) a, other, *b = &a;
    SC_KERNEL(neighbors) x;
    lanes n[3];
    unsigned at;
    SC_KERNEL(find_corners)(state, p->a, &a);
    if (p->a != p->b) {
        SC_KERNEL(find_corners)(state, p->b, &other);
        b = &other;
    }
    memset(of_a + count, 0, SC_LANES_COUNT); /* fills the last row */
    memset(of_b + count, 0, SC_LANES_COUNT);
    for (at = 0; at < count; at += SC_LANES_COUNT) {
        unsigned mask = count - at < SC_LANES_COUNT ? (1u << (count - at)) - 1u : 0xffffu, flat[2];
        SC_KERNEL(load_neighbors)(&a, b, of_a + at, of_b + at, &x);
        mask &= ~SC_KERNEL(plane_parts)(&x, 1, extent, n, &flat[1]) | x.same;
        mask &= ~SC_KERNEL(plane_parts)(&x, 0, extent, n, &flat[0]) | x.same;
        if (sc_bits_count(mask) >= SC_SIDES_WORTH)
            mask &= ~SC_KERNEL(side_parts)(&x, n, extent) | x.same;
        for (; mask; mask &= mask - 1) {
            uint32_t lane = at + sc_bits_lowest(mask);
            sc_candidates_add_neighbors(state, first[p->a] + of_a[lane], first[p->b] + of_b[lane],
                                        (flat[0] & flat[1]) >> (lane - at) & 1);
        }
    }
}
