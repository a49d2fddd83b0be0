/*
 * Pairs of triangles decided by the signs of determinants, eight at a time, as far as that is
 * certain in doubles. The scalar form, which is exact and decides the rest, is query/primitives.c.
 *
 * SPDX-License-Identifier: MIT
 *
 * A pair has six signs of corners against the other's plane and nine of edges against edges. Seen
 * from the first corner of the first triangle, its others are a_1 and a_2, those of the second b_0,
 * b_1 and b_2. With n_i = b_i x b_i+1, whose sum is the second's normal, fourteen determinants make
 * up all signs:
 *   corners b_i, and minus a_k:  S_i = (a_1 x a_2) . b_i
 *                                T_0 = n_0 . b_2, T_k = T_0 - (n_0 + n_1 + n_2) . a_k
 *   edges k and i, from below:   L_0i = n_i . a_1, L_2i = -n_i . a_2
 *                                L_1i = S_i+1 - S_i - L_0i - L_2i
 *
 * Each component of a and b is a difference of two coordinates; let r be the largest of them all.
 * In exact arithmetic a determinant is a sum of at most four times six products of three of them.
 * One of these meets the rounding of three differences, two products, a subtraction and two
 * additions, and in T_k of three more, hence is off by 11.01 * 2^-53 r^3 at most, and the sum by
 * 264.3 * 2^-53 r^3. The bound is 272 * 2^-53 r^3 with at least 2^-300 for r, which covers its own
 * three roundings and products that underflow: these change a sum by less than 2^-1060 (1 + r), or
 * 2^-1000 (1 + r) and 2^-1010 r^2 where subnormal numbers are flushed to zero. Computed as 4.25 *
 * 2^-53 (4 r)^3 it is infinite, and nothing certain, before any sum can overflow.
 *
 * A sign is certainly zero if its four points have a coordinate in common, which is asked only
 * where it matters; what is coplanar otherwise is left to the scalar form.
 */

/* Eight pairs of triangles. */
typedef struct eight_triangle_pairs {
    doubles at[2][3][3]; /* triangle, corner, axis */
    doubles side[2][3];  /* of corners against the other's plane: T and S */
    doubles line[3][3];  /* of edges against edges: L */
    doubles reach;       /* four times r */
    doubles bound;       /* what is larger than this has a certain sign */
} eight_triangle_pairs;

/* Corners of the first or the second triangles. */
static SC_INLINE void read_points(const sc_pair_lanes *pairs, int s, int floats, doubles at[3][3])
{
    const sc_triangle_source *of = &pairs->of[s];
    const unsigned char *positions = of->positions;
    const uint64_t stride = of->stride;
    const uint32_t *triangle[SC_PAIR_LANES];
    int k, i;
    SC_UNROLL
    for (i = 0; i < SC_PAIR_LANES; i++)
        triangle[i] = of->triangle + 3 * (uint64_t)(s ? pairs->pairs[i].b : pairs->pairs[i].a);
    for (k = 0; k < 3; k++) {
        const unsigned char *point[SC_PAIR_LANES];
        SC_UNROLL
        for (i = 0; i < SC_PAIR_LANES; i++)
            point[i] = positions + sc_alone((size_t)(stride * triangle[i][k]));
        doubles_points(point, floats, at[k]);
    }
}

static SC_NOINLINE void read_floats(const sc_pair_lanes *pairs, int s, doubles at[3][3])
{
    read_points(pairs, s, 1, at);
}

static SC_INLINE void read_triangles(const sc_pair_lanes *pairs, int s, doubles at[3][3])
{
    if (pairs->of[s].floats)
        read_floats(pairs, s, at);
    else
        read_points(pairs, s, 0, at);
}

static inline void cross_eight(const doubles e[3], const doubles f[3], doubles n[3])
{
    int c;
    SC_UNROLL
    for (c = 0; c < 3; c++)
        n[c] = doubles_subtract(doubles_multiply(e[(c + 1) % 3], f[(c + 2) % 3]),
                                doubles_multiply(e[(c + 2) % 3], f[(c + 1) % 3]));
}

static inline doubles dot_eight(const doubles n[3], const doubles p[3])
{
    return doubles_add(doubles_add(doubles_multiply(n[0], p[0]), doubles_multiply(n[1], p[1])),
                       doubles_multiply(n[2], p[2]));
}

/* Reads the corners and computes all else. */
static SC_INLINE void read_eight(const sc_pair_lanes *pairs, eight_triangle_pairs *x)
{
    doubles a[2][3], b[3][3], n[3], along[2][3], reach = doubles_all(SC_BOUNDS_EIGHT_LEAST);
    doubles *side = x->side[1], (*line)[3] = x->line;
    int k, i, c;
    read_triangles(pairs, 0, x->at[0]);
    read_triangles(pairs, 1, x->at[1]);
    SC_UNROLL
    for (k = 0; k < 5; k++) {
        const doubles *from = x->at[0][0], *to = k < 2 ? x->at[0][k + 1] : x->at[1][k - 2];
        doubles *p = k < 2 ? a[k] : b[k - 2];
        SC_UNROLL
        for (c = 0; c < 3; c++) {
            p[c] = doubles_subtract(to[c], from[c]);
            reach = doubles_larger_size(reach, p[c]);
        }
    }
    cross_eight(a[0], a[1], n);
    SC_UNROLL
    for (i = 0; i < 3; i++) side[i] = dot_eight(n, b[i]);
    SC_UNROLL
    for (i = 0; i < 3; i++) {
        cross_eight(b[i], b[(i + 1) % 3], n);
        along[0][i] = dot_eight(n, a[0]);
        along[1][i] = dot_eight(n, a[1]);
        if (i == 0) x->side[0][0] = dot_eight(n, b[2]);
    }
    SC_UNROLL
    for (k = 0; k < 2; k++)
        x->side[0][k + 1] = doubles_subtract(
            x->side[0][0], doubles_add(doubles_add(along[k][0], along[k][1]), along[k][2]));
    SC_UNROLL
    for (i = 0; i < 3; i++) {
        line[0][i] = along[0][i];
        line[1][i] = doubles_subtract(doubles_add(along[1][i], side[(i + 1) % 3]),
                                      doubles_add(along[0][i], side[i]));
        line[2][i] = doubles_subtract(doubles_all(0), along[1][i]);
    }
    x->reach = reach = doubles_multiply(doubles_all(4), reach);
    x->bound = doubles_multiply(doubles_all(SC_BOUNDS_EIGHT),
                                doubles_multiply(doubles_multiply(reach, reach), reach));
}

/* ---- what is certain of nearly all ---- */

/* Which edges of the two, the first's k and the second's i, are in one plane across an axis.
   Returns the lanes in which any are. */
static inline unsigned find_level_edges(doubles at[2][3][3], doubles_mask level[3][3])
{
    unsigned found = 0;
    const doubles_mask none = doubles_below(doubles_all(0), doubles_all(0));
    int c, s, k, i;
    SC_UNROLL
    for (k = 0; k < 3; k++) {
        SC_UNROLL
        for (i = 0; i < 3; i++) level[k][i] = none;
    }
    for (c = 0; c < 3; c++) {
        doubles_mask even[2][3], any[2], same;
        doubles where[2];
        unsigned some;
        SC_UNROLL
        for (s = 0; s < 2; s++) {
            doubles p = at[s][0][c], q = at[s][1][c], r = at[s][2][c];
            even[s][0] = doubles_equal(p, q);
            even[s][1] = doubles_equal(q, r);
            even[s][2] = doubles_equal(r, p);
            any[s] = doubles_either(doubles_either(even[s][0], even[s][1]), even[s][2]);
            where[s] = doubles_choose(even[s][1], q, p); /* which is that of all its even edges */
        }
        same = doubles_equal(where[0], where[1]);
        some = doubles_bits(doubles_both(doubles_both(any[0], any[1]), same));
        if (!some) continue;
        SC_UNROLL
        for (k = 0; k < 3; k++) {
            doubles_mask one = doubles_both(even[0][k], same);
            SC_UNROLL
            for (i = 0; i < 3; i++) {
                doubles_mask both = doubles_both(one, even[1][i]);
                level[k][i] = doubles_either(level[k][i], both);
            }
        }
        found |= some;
    }
    return found;
}

/* Of the six edges by their bits: whose ends are on different sides, of these whose lines have
   signs that are not certain, and which meet the other triangle if all that is. */
typedef struct edge_bits {
    unsigned sides[6], open[6], meets[6];
} edge_bits;

static inline void look_along(edge_bits *e, int edge, const doubles line[3], doubles bound)
{
    doubles least = doubles_smaller_size(doubles_smaller_size(line[0], line[1]), line[2]);
    e->open[edge] = e->sides[edge] & ~doubles_bits(doubles_below(bound, least));
    e->meets[edge] = e->sides[edge] & ~doubles_differ3(line[0], line[1], line[2]);
}

/* The signs of lines that are certainly zero count as those next to them, or if touching is not
   asked for, their edges do not meet. Only if there is another, which is not certain then, if it is
   zero, too. */
static inline void look_along_level(edge_bits *e, int edge, const doubles line[3],
                                    const doubles_mask level[3], doubles bound, int proper)
{
    doubles next[3];
    int i;
    SC_UNROLL
    for (i = 0; i < 3; i++) next[i] = doubles_choose(level[i], line[(i + 1) % 3], line[i]);
    look_along(e, edge, next, bound);
    if (proper) {
        unsigned none = ~doubles_bits(doubles_either(doubles_either(level[0], level[1]), level[2]));
        e->open[edge] &= none;
        e->meets[edge] &= none;
    }
}

/* Decides eight pairs that share nothing, if no corner may be in the other's plane; else returns
   0. */
static SC_INLINE int decide_most(const sc_pair_lanes *pairs, eight_triangle_pairs *x,
                                 sc_verdict *verdict)
{
    edge_bits e;
    unsigned certain[2], apart = 0, open = 0;
    uint64_t meets = 0;
    int s, k;
    SC_UNROLL
    for (s = 0; s < 2; s++) {
        const doubles *side = x->side[s];
        doubles least = doubles_smaller_size(doubles_smaller_size(side[0], side[1]), side[2]);
        certain[s] = doubles_bits(doubles_below(x->bound, least));
        SC_UNROLL
        for (k = 0; k < 3; k++) e.sides[3 * s + k] = doubles_differ(side[k], side[(k + 1) % 3]);
        apart |= certain[s] & ~(e.sides[3 * s] | e.sides[3 * s + 1] | e.sides[3 * s + 2]);
    }
    if (~apart & ~(certain[0] & certain[1]) & 255u) return 0;
    SC_UNROLL
    for (k = 0; k < 3; k++) {
        doubles across[3];
        across[0] = x->line[0][k];
        across[1] = x->line[1][k];
        across[2] = x->line[2][k];
        look_along(&e, k, x->line[k], x->bound);
        look_along(&e, 3 + k, across, x->bound);
        open |= e.open[k] | e.open[3 + k];
    }
    open &= ~apart;
    if (open) {
        doubles_mask level[3][3];
        unsigned found = find_level_edges(x->at, level);
        if (open & ~found) return 0;
        open = 0;
        SC_UNROLL
        for (k = 0; k < 3; k++) {
            doubles across[3];
            doubles_mask level_across[3];
            SC_UNROLL
            for (s = 0; s < 3; s++) {
                across[s] = x->line[s][k];
                level_across[s] = level[s][k];
            }
            look_along_level(&e, k, x->line[k], level[k], x->bound, pairs->proper);
            look_along_level(&e, 3 + k, across, level_across, x->bound, pairs->proper);
            open |= e.open[k] | e.open[3 + k];
        }
        if (open & ~apart) return 0;
    }
    SC_UNROLL
    for (k = 0; k < 6; k++) meets |= (uint64_t)(e.meets[k] & ~apart) << 8 * k;
    verdict->meets = meets;
    verdict->unsure = 0;
    return 1;
}

/* ---- what is certain of the rest ---- */

/* In which lanes a determinant is certainly positive, negative or zero. */
typedef struct sign_bits {
    unsigned above, below, zero;
} sign_bits;

static inline sign_bits sign_of(doubles d, doubles bound)
{
    sign_bits sign;
    sign.above = doubles_bits(doubles_below(bound, d));
    sign.below = doubles_bits(doubles_below(d, doubles_subtract(doubles_all(0), bound)));
    sign.zero = 0;
    return sign;
}

/* What a side in a projection may be off by; see below. */
static inline doubles beside_bound(doubles reach)
{
    return doubles_multiply(doubles_all(SC_BOUNDS_SIGN_2D / 2), doubles_multiply(reach, reach));
}

/*
 * The lanes in which the two, projected along the axis nearest to the normal of one, are certainly
 * on different sides of the line of a projected edge: its own triangle's third corner on one side,
 * all of the other's strictly on the other, but for one that they share if it is on the line. Then
 * they do not meet elsewhere. Nearly coplanar pairs that are apart are so by one of these six
 * lines. A side d = e_0 p_1 - e_1 p_0 meets two differences, a product and a subtraction: 4.01 *
 * 2^-53 of two products of numbers of up to 2 r, 8 r^2 together.
 */
static unsigned are_beside(const eight_triangle_pairs *x, const unsigned shared[2][3])
{
    doubles e[2][3], n[3], size[3], flat[2][3][2], zero = doubles_all(0);
    doubles bound = beside_bound(x->reach);
    doubles_mask first, second;
    unsigned apart = 0;
    int s, k, i, c;
    for (k = 0; k < 2; k++)
        for (c = 0; c < 3; c++) e[k][c] = doubles_subtract(x->at[0][k + 1][c], x->at[0][0][c]);
    cross_eight(e[0], e[1], n);
    for (c = 0; c < 3; c++) size[c] = doubles_absolute(n[c]);
    first = doubles_below(doubles_larger(size[1], size[2]), size[0]);
    second = doubles_below(size[2], size[1]);
    for (s = 0; s < 2; s++)
        for (k = 0; k < 3; k++) {
            const doubles *p = x->at[s][k];
            flat[s][k][0] = doubles_choose(first, p[1], p[0]);
            flat[s][k][1] = doubles_choose(first, p[2], doubles_choose(second, p[2], p[1]));
        }
    for (s = 0; s < 2; s++)
        for (k = 0; k < 3; k++) {
            const doubles *from = flat[s][k], *to = flat[s][(k + 1) % 3];
            doubles edge[2];
            unsigned left[4], right[4];
            for (c = 0; c < 2; c++) edge[c] = doubles_subtract(to[c], from[c]);
            for (i = 0; i < 4; i++) { /* the other's corners, and its own third */
                const doubles *at = i < 3 ? flat[1 - s][i] : flat[s][(k + 2) % 3];
                doubles d =
                    doubles_subtract(doubles_multiply(edge[0], doubles_subtract(at[1], from[1])),
                                     doubles_multiply(edge[1], doubles_subtract(at[0], from[0])));
                unsigned counts = i < 3 ? shared[1 - s][i] : 0;
                left[i] = doubles_bits(doubles_below(bound, d)) | counts;
                right[i] = doubles_bits(doubles_below(d, doubles_subtract(zero, bound))) | counts;
            }
            apart |= ((left[3] & right[0] & right[1] & right[2]) |
                      (right[3] & left[0] & left[1] & left[2])) &
                     ~shared[s][(k + 2) % 3];
        }
    return apart;
}

/* The lanes in which four points have a coordinate in common: in a plane across an axis, where most
   signs are that are zero. The points are compared, not subtracted, in case small differences are
   flushed to zero. */
static unsigned are_level(const doubles p[3], const doubles q[3], const doubles r[3],
                          const doubles s[3])
{
    unsigned level = 0;
    int c;
    for (c = 0; c < 3; c++)
        level |= doubles_bits(
            doubles_both(doubles_both(doubles_equal(p[c], q[c]), doubles_equal(q[c], r[c])),
                         doubles_equal(r[c], s[c])));
    return level;
}

/* An edge, by the signs of its ends against a plane and of its line against three others, where
   zero counts as on either side if touching is asked for (all bits set), as on none if not (0). An
   edge in the plane stays open. */
static inline void decide_edge(sign_bits from, sign_bits to, sign_bits a, sign_bits b, sign_bits c,
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

/* All signs of eight pairs: of corners against the other's plane, and of the first's edges against
   the second's. */
typedef struct pair_signs {
    sign_bits side[2][3], line[3][3];
} pair_signs;

/* Sets the lanes in which edges meet, and in which that is open; returns the lanes in which an edge
   is left open. */
static inline unsigned decide_edges(const sc_pair_lanes *pairs, const pair_signs *signs,
                                    unsigned meets[6], unsigned open[6])
{
    unsigned touching = pairs->proper ? 0 : ~0u, unsure = 0;
    int k, s;
    SC_UNROLL
    for (k = 0; k < 3; k++) {
        const sign_bits(*side)[3] = signs->side, (*line)[3] = signs->line;
        int next = (k + 1) % 3;
        decide_edge(side[0][k], side[0][next], line[k][0], line[k][1], line[k][2], touching,
                    &meets[k], &open[k]);
        decide_edge(side[1][k], side[1][next], line[0][k], line[1][k], line[2][k], touching,
                    &meets[3 + k], &open[3 + k]);
        for (s = 0; s < 2; s++) {
            meets[3 * s + k] &= ~(pairs->shared[s][k] | pairs->shared[s][next]);
            open[3 * s + k] &= ~(pairs->shared[s][k] | pairs->shared[s][next]);
            unsure |= open[3 * s + k];
        }
    }
    return unsure;
}

/* Finds which of the signs that are not certain in some lanes are certainly zero. Returns the lanes
   in which a corner may be in the other's plane. */
static unsigned find_zeros(const eight_triangle_pairs *x, unsigned some, pair_signs *signs)
{
    unsigned level = 0;
    int s, k, i;
    for (s = 0; s < 2; s++)
        for (k = 0; k < 3; k++) {
            const doubles(*t)[3] = x->at[1 - s];
            unsigned open = some & ~(signs->side[s][k].above | signs->side[s][k].below);
            level |= open;
            if (open) signs->side[s][k].zero = open & are_level(t[0], t[1], t[2], x->at[s][k]);
        }
    for (k = 0; k < 3; k++)
        for (i = 0; i < 3; i++) {
            const doubles(*a)[3] = x->at[0], (*b)[3] = x->at[1];
            unsigned open = some & ~(signs->line[k][i].above | signs->line[k][i].below);
            if (open)
                signs->line[k][i].zero =
                    open & are_level(a[k], a[(k + 1) % 3], b[i], b[(i + 1) % 3]);
        }
    return level;
}

/* Decides eight pairs, edge by edge, as far as that is certain. */
static SC_NOINLINE void decide_rest(const sc_pair_lanes *pairs, const eight_triangle_pairs *x,
                                    sc_verdict *verdict)
{
    pair_signs signs;
    unsigned apart = 0, unsure, meets[6], open[6];
    int s, k, i;
    for (s = 0; s < 2; s++) {
        unsigned above = 255, below = 255;
        for (k = 0; k < 3; k++) {
            signs.side[s][k] = sign_of(x->side[s][k], x->bound);
            above &= signs.side[s][k].above | pairs->shared[s][k];
            below &= signs.side[s][k].below | pairs->shared[s][k];
        }
        apart |= above | below;
    }
    for (k = 0; k < 3; k++)
        for (i = 0; i < 3; i++) signs.line[k][i] = sign_of(x->line[k][i], x->bound);
    unsure = decide_edges(pairs, &signs, meets, open) & ~apart;
    if (unsure) {
        unsigned level = find_zeros(x, unsure, &signs);
        unsure = decide_edges(pairs, &signs, meets, open) & ~apart;
        if (unsure & level) apart |= are_beside(x, pairs->shared);
    }
    verdict->meets = verdict->unsure = 0;
    for (k = 0; k < 6; k++) {
        verdict->meets |= (uint64_t)(meets[k] & ~apart) << 8 * k;
        verdict->unsure |= (uint64_t)(open[k] & ~apart) << 8 * k;
    }
}

static void decide(const sc_pair_lanes *pairs, sc_verdict *verdict)
{
    eight_triangle_pairs x;
    read_eight(pairs, &x);
    if (pairs->shares || !decide_most(pairs, &x, verdict)) decide_rest(pairs, &x, verdict);
}
