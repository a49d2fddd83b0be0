/*
 * Pairs of triangles decided by the signs of determinants, eight at a time, as far as that is certain in doubles.
 * The scalar form, which is exact and decides the rest, is query/primitives.c.
 *
 * SPDX-License-Identifier: MIT
 *
 * A pair has six signs of corners against the other's plane and nine of edges against edges: d = (e x f) . p, where e
 * and f are edges and p runs from a corner of one triangle to one of the other. Each component of e, f and p is a
 * difference of two coordinates. In exact arithmetic d is a sum of six products of a component of each; one of them
 * meets the rounding of three differences, two products, a subtraction and two additions, hence is off by
 * 8.01 * 2^-53 of its absolute value at most. With E the sum of a triangle's extents along the axes, |e|1 <= E of its
 * triangle, and no component of p is above R, the largest extent of both: the absolute values sum to E E' R at most.
 * E and R are computed to within 4 * 2^-53 and 2^-53 and their product is rounded thrice more, so that 9 * 2^-53 E E' R
 * as computed covers it; the absolute term is for products that underflow. If E E' R overflows, the
 * bound is infinite or not a number, and nothing is certain; if not, no sum of products can, but by rounding, which
 * leaves the sign as it is. A sign is certainly zero if its four points have a coordinate in common, which is asked only
 * where it matters; what is coplanar otherwise is left to the scalar form.
 */

/* Corners of eight pairs; and how large the triangles and pairs are. */
typedef struct SC_KERNEL(corners) {
    doubles at[2][3][3]; /* triangle, corner, axis */
    doubles edge[2][3][3];
    doubles extent[2], reach;
} SC_KERNEL(corners);

/* In which lanes a determinant is certainly positive, negative or zero. */
typedef struct SC_KERNEL(sign) {
    unsigned above, below, zero;
} SC_KERNEL(sign);

static inline void SC_KERNEL(read_corners)(const sc_pair_lanes *pairs, SC_KERNEL(corners) * x)
{
    doubles low[2][3], high[2][3];
    int s, k, c;
    SC_UNROLL
    for (s = 0; s < 2; s++) {
        SC_UNROLL
        for (k = 0; k < 3; k++)
            doubles_points(pairs->corner[s][k], &x->at[s][k][0], &x->at[s][k][1], &x->at[s][k][2]);
        SC_UNROLL
        for (c = 0; c < 3; c++) {
            doubles p = x->at[s][0][c], q = x->at[s][1][c], r = x->at[s][2][c];
            low[s][c] = doubles_smaller(doubles_smaller(p, q), r);
            high[s][c] = doubles_larger(doubles_larger(p, q), r);
            x->edge[s][0][c] = doubles_subtract(q, p);
            x->edge[s][1][c] = doubles_subtract(r, q);
            x->edge[s][2][c] = doubles_subtract(p, r);
        }
        x->extent[s] = doubles_add(doubles_add(doubles_subtract(high[s][0], low[s][0]),
                                               doubles_subtract(high[s][1], low[s][1])),
                                   doubles_subtract(high[s][2], low[s][2]));
    }
    SC_UNROLL
    for (c = 0; c < 3; c++) {
        doubles all = doubles_subtract(doubles_larger(high[0][c], high[1][c]),
                                       doubles_smaller(low[0][c], low[1][c]));
        x->reach = c ? doubles_larger(x->reach, all) : all;
    }
}

static inline doubles SC_KERNEL(bound)(const SC_KERNEL(corners) * x, doubles e, doubles f)
{
    doubles product = doubles_multiply(x->reach, doubles_multiply(e, f));
    return doubles_add(doubles_multiply(doubles_all(SC_PREDICATES_BOUND_3D), product),
                       doubles_multiply(doubles_all(SC_PREDICATES_BOUND_TINY),
                                        doubles_add(doubles_all(1), x->reach)));
}

static inline void SC_KERNEL(cross)(const doubles e[3], const doubles f[3], doubles n[3])
{
    int c;
    SC_UNROLL
    for (c = 0; c < 3; c++)
        n[c] = doubles_subtract(doubles_multiply(e[(c + 1) % 3], f[(c + 2) % 3]),
                                doubles_multiply(e[(c + 2) % 3], f[(c + 1) % 3]));
}

/* Of n . (q - p). */
static inline SC_KERNEL(sign)
    SC_KERNEL(sign_along)(const doubles n[3], const doubles p[3], const doubles q[3], doubles bound)
{
    SC_KERNEL(sign) sign;
    doubles d = doubles_add(doubles_add(doubles_multiply(n[0], doubles_subtract(q[0], p[0])),
                                        doubles_multiply(n[1], doubles_subtract(q[1], p[1]))),
                            doubles_multiply(n[2], doubles_subtract(q[2], p[2])));
    sign.above = doubles_bits(doubles_below(bound, d));
    sign.below = doubles_bits(doubles_below(d, doubles_subtract(doubles_all(0), bound)));
    sign.zero = 0;
    return sign;
}

/*
 * The lanes in which the two, projected along the axis nearest to the normal of one, are certainly on different sides
 * of the line of a projected edge: its own triangle's third corner on one side, all of the other's strictly on the
 * other, but for one that they share if it is on the line. Then they do not meet elsewhere. Nearly coplanar pairs that are apart are so by one of these six lines. A side
 * d = e_0 p_1 - e_1 p_0 meets two differences, a product and a subtraction: 4.01 * 2^-53 (|e_0| + |e_1|) |p|max.
 */
static unsigned SC_KERNEL(are_beside)(const SC_KERNEL(corners) * x, const unsigned shared[2][3])
{
    doubles n[3], size[3], flat[2][3][2], edge[2][3][2], zero = doubles_all(0);
    doubles_mask first, second;
    unsigned apart = 0;
    int s, k, i, c;
    SC_KERNEL(cross)(x->edge[0][0], x->edge[0][1], n);
    SC_UNROLL
    for (c = 0; c < 3; c++) size[c] = doubles_absolute(n[c]);
    first = doubles_below(doubles_larger(size[1], size[2]), size[0]);
    second = doubles_below(size[2], size[1]);
    SC_UNROLL
    for (s = 0; s < 2; s++) {
        SC_UNROLL
        for (k = 0; k < 3; k++) {
            const doubles *p = x->at[s][k], *e = x->edge[s][k];
            flat[s][k][0] = doubles_choose(first, p[1], p[0]);
            flat[s][k][1] = doubles_choose(first, p[2], doubles_choose(second, p[2], p[1]));
            edge[s][k][0] = doubles_choose(first, e[1], e[0]);
            edge[s][k][1] = doubles_choose(first, e[2], doubles_choose(second, e[2], e[1]));
        }
    }
    SC_UNROLL
    for (s = 0; s < 2; s++) {
        doubles area = doubles_subtract(doubles_multiply(edge[s][0][0], edge[s][1][1]),
                                        doubles_multiply(edge[s][0][1], edge[s][1][0]));
        doubles bound = doubles_add(doubles_multiply(doubles_all(SC_PREDICATES_BOUND_2D),
                                                     doubles_multiply(x->extent[s], x->reach)),
                                    doubles_all(SC_PREDICATES_BOUND_TINY));
        unsigned left = doubles_bits(doubles_below(bound, area));
        unsigned right = doubles_bits(doubles_below(area, doubles_subtract(zero, bound)));
        SC_UNROLL
        for (k = 0; k < 3; k++) {
            unsigned all_left = 255, all_right = 255;
            SC_UNROLL
            for (i = 0; i < 3; i++) {
                doubles p0 = doubles_subtract(flat[1 - s][i][0], flat[s][k][0]);
                doubles p1 = doubles_subtract(flat[1 - s][i][1], flat[s][k][1]);
                doubles d = doubles_subtract(doubles_multiply(edge[s][k][0], p1),
                                             doubles_multiply(edge[s][k][1], p0));
                all_left &= doubles_bits(doubles_below(bound, d)) | shared[1 - s][i];
                all_right &= doubles_bits(doubles_below(d, doubles_subtract(zero, bound))) |
                             shared[1 - s][i];
            }
            apart |= ((left & all_right) | (right & all_left)) & ~shared[s][(k + 2) % 3];
        }
    }
    return apart;
}

/* The lanes in which four points have a coordinate in common: in a plane across an axis, where most signs are that are
   zero. The points are compared, not subtracted, in case small differences are flushed to zero. */
static unsigned SC_KERNEL(are_level)(const doubles p[3], const doubles q[3], const doubles r[3],
                                     const doubles s[3])
{
    unsigned level = 0;
    int c;
    for (c = 0; c < 3; c++)
        level |=
            ~(doubles_bits(doubles_below(p[c], q[c])) | doubles_bits(doubles_below(q[c], p[c])) |
              doubles_bits(doubles_below(q[c], r[c])) | doubles_bits(doubles_below(r[c], q[c])) |
              doubles_bits(doubles_below(r[c], s[c])) | doubles_bits(doubles_below(s[c], r[c])));
    return level;
}

/* An edge, by the signs of its ends against a plane and of its line against three others, where zero counts as on
   either side if touching is asked for (all bits set), as on none if not (0). An edge in the plane stays open. */
static inline void SC_KERNEL(decide_edge)(SC_KERNEL(sign) from, SC_KERNEL(sign) to,
                                          SC_KERNEL(sign) a, SC_KERNEL(sign) b, SC_KERNEL(sign) c,
                                          unsigned touching, unsigned *meets, unsigned *unsure)
{
    unsigned zero = from.zero | to.zero | a.zero | b.zero | c.zero;
    unsigned passes = ((a.above | a.zero) & (b.above | b.zero) & (c.above | c.zero)) |
                      ((a.below | a.zero) & (b.below | b.zero) & (c.below | c.zero));
    unsigned misses = (a.above | b.above | c.above) & (a.below | b.below | c.below);
    unsigned crosses = ((from.above | from.zero) & (to.below | to.zero)) |
                       ((from.below | from.zero) & (to.above | to.zero));
    misses |= (from.above & to.above) | (from.below & to.below) | (zero & ~touching);
    *meets = crosses & passes & ~(from.zero & to.zero) & (touching | ~zero) & 255u;
    *unsure = ~(*meets | misses) & 255u;
}

/* All signs of eight pairs: of corners against the other's plane, and of the first's edges against the second's. */
typedef struct SC_KERNEL(signs) {
    SC_KERNEL(sign) side[2][3], line[3][3];
} SC_KERNEL(signs);

/* Fills the verdict; returns the lanes in which an edge is left open. */
static inline unsigned SC_KERNEL(decide_edges)(const sc_pair_lanes *pairs,
                                               const SC_KERNEL(signs) * signs, sc_verdict *verdict)
{
    unsigned touching = pairs->proper ? 0 : ~0u, unsure = 0;
    int k, s;
    SC_UNROLL
    for (k = 0; k < 3; k++) {
        const SC_KERNEL(sign)(*side)[3] = signs->side, (*line)[3] = signs->line;
        int next = (k + 1) % 3;
        SC_KERNEL(decide_edge)
        (side[0][k], side[0][next], line[k][0], line[k][1], line[k][2], touching,
         &verdict->meets[k], &verdict->unsure[k]);
        SC_KERNEL(decide_edge)
        (side[1][k], side[1][next], line[0][k], line[1][k], line[2][k], touching,
         &verdict->meets[3 + k], &verdict->unsure[3 + k]);
        for (s = 0; s < 2; s++) {
            verdict->meets[3 * s + k] &= ~(pairs->shared[s][k] | pairs->shared[s][next]);
            verdict->unsure[3 * s + k] &= ~(pairs->shared[s][k] | pairs->shared[s][next]);
            unsure |= verdict->unsure[3 * s + k];
        }
    }
    return unsure;
}

/* Finds which of the signs that are not certain in some lanes are certainly zero. Returns the lanes in which a corner
   may be in the other's plane. */
static unsigned SC_KERNEL(find_zeros)(const SC_KERNEL(corners) * x, unsigned some,
                                      SC_KERNEL(signs) * signs)
{
    unsigned level = 0;
    int s, k, i;
    for (s = 0; s < 2; s++)
        for (k = 0; k < 3; k++) {
            const doubles(*t)[3] = x->at[1 - s];
            unsigned open = some & ~(signs->side[s][k].above | signs->side[s][k].below);
            level |= open;
            if (open)
                signs->side[s][k].zero = open & SC_KERNEL(are_level)(t[0], t[1], t[2], x->at[s][k]);
        }
    for (k = 0; k < 3; k++)
        for (i = 0; i < 3; i++) {
            const doubles(*a)[3] = x->at[0], (*b)[3] = x->at[1];
            unsigned open = some & ~(signs->line[k][i].above | signs->line[k][i].below);
            if (open)
                signs->line[k][i].zero =
                    open & SC_KERNEL(are_level)(a[k], a[(k + 1) % 3], b[i], b[(i + 1) % 3]);
        }
    return level;
}

static void SC_KERNEL(decide)(const sc_pair_lanes *pairs, sc_verdict *verdict)
{
    SC_KERNEL(corners) x;
    SC_KERNEL(signs) signs;
    unsigned apart = 0, unsure;
    int s, k, i;
    memset(verdict, 0, sizeof *verdict);
    SC_KERNEL(read_corners)(pairs, &x);
    SC_UNROLL
    for (s = 0; s < 2; s++) { /* corners of s against the plane of the other */
        doubles n[3], bound = SC_KERNEL(bound)(&x, x.extent[1 - s], x.extent[1 - s]);
        unsigned above = 255, below = 255;
        SC_KERNEL(cross)(x.edge[1 - s][0], x.edge[1 - s][1], n);
        SC_UNROLL
        for (k = 0; k < 3; k++) {
            SC_KERNEL(sign) sign = SC_KERNEL(sign_along)(n, x.at[1 - s][0], x.at[s][k], bound);
            above &= sign.above | pairs->shared[s][k];
            below &= sign.below | pairs->shared[s][k];
            signs.side[s][k] = sign;
        }
        apart |= above | below;
    }
    if (apart == 255u) return;
    {
        doubles bound = SC_KERNEL(bound)(&x, x.extent[0], x.extent[1]);
        SC_UNROLL
        for (k = 0; k < 3; k++) {
            SC_UNROLL
            for (i = 0; i < 3; i++) {
                doubles n[3];
                SC_KERNEL(cross)(x.edge[0][k], x.edge[1][i], n);
                signs.line[k][i] = SC_KERNEL(sign_along)(n, x.at[0][k], x.at[1][i], bound);
            }
        }
    }
    unsure = SC_KERNEL(decide_edges)(pairs, &signs, verdict) & ~apart;
    if (unsure) {
        unsigned level = SC_KERNEL(find_zeros)(&x, unsure, &signs);
        unsure = SC_KERNEL(decide_edges)(pairs, &signs, verdict) & ~apart;
        if (unsure & level) apart |= SC_KERNEL(are_beside)(&x, pairs->shared);
    }
    SC_UNROLL
    for (k = 0; k < 6; k++) {
        verdict->meets[k] &= ~apart;
        verdict->unsure[k] &= ~apart;
    }
}
