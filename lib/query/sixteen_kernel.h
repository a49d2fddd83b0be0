/*
 * Sixteen pairs of triangles that share nothing: by planes, by the order along the line in which
 * two planes meet, and by sides in a projection: which are certainly apart. See cluster_kernel.h,
 * which puts them together.
 *
 * SPDX-License-Identifier: MIT
 *
 * All of it is in single precision on the points in the unit box. Each coordinate is off by POINT =
 * 3e-8 at most, so that the difference of two is by EDGE = 6e-8. Let D be the largest extent of the
 * two clusters' boxes together, which bounds all differences, and v = 2^-24.
 *
 * A distance from a plane, up to a factor, is d = (e x f) . w, a sum of six products; e and f are
 * two edges, w runs from their corner p to a corner x of another triangle. With S = |e|1 + |f|1 <=
 * 6 D: moving the components of one of them by EDGE changes d by 2 EDGE |f|1 D, 2 EDGE |e|1 D and
 * EDGE |e|1 |f|1 <= 1.5 EDGE D S at most; of two, by 2 EDGE^2 S + 6 EDGE^2 D; of all three, by 6
 * EDGE^3: below S 4 EDGE (D + EDGE) + 7 EDGE^2 (D + EDGE) in all. The normal n = e x f is rounded,
 * by 4.01 v |e|1 |f|1 in all, which changes d by 6.02 v D^2 S at most. It is computed as n . x - n
 * . p, where one product is compared with the other and the bound, or their difference with the
 * bound: both products are off by 3.01 v |n|1, as no coordinate is above 1, the sum of one with the
 * bound by 1.01 v |n|1 and a part of the bound, and the difference by a part of itself. |n|1 <=
 * 1.01 |e|1 |f|1 <= S^2 / 3.96: together 1.8 v S^2. All of it is below S (2.1 v S + 4 EDGE (D +
 * EDGE) + 7 v D^2) + 8 EDGE^2 (D + EDGE), however that is rounded.
 *
 * If the plane of each of two triangles has a corner of the other, its tip, on one side and two on
 * the other, the planes meet in a line, which crosses the edges from the tips inside them; of a
 * triangle, what is between its two crossings is on that line. Let e and f be such edges of
 * either, w run from tip to tip, and x and y be where the line crosses e and f. Then d = (e x f) .
 * w = (e x f) . (y - x), and as n x n' is along the line and (e x f) . (n x n') = -(e . n') (f .
 * n), of which the sign is the same for all four of such edges, the signs of the four d tell in
 * which order x and y are. If they are the same the triangles are apart. With W = |w|1, moving one
 * of the three by EDGE changes d by EDGE |e|1 |f|1, EDGE |e|1 W and EDGE |f|1 W at most; two, by 2
 * EDGE^2 (|e|1 + |f|1 + W), all three, by 6 EDGE^3. Each of six products meets three differences,
 * two products and three sums: 8.01 v |e|1 |f|1 W. Let S be the sum of that of both triangles, >=
 * |e|1 + |f|1, so that |e|1 |f|1 <= S^2 / 4. With T = S + 2 EDGE and U = W + 4 EDGE all that is
 * below T (1.01 EDGE U + 0.26 EDGE T + 2.03 v T U), rounding of S and W included. Here W is that
 * of two triangles that nearly meet, D that of whole clusters.
 *
 * A side in a projection is d = e_0 p_1 - e_1 p_0, |e|, |p| <= D: off by EDGE (|e|1 + |p|1) <= 4
 * EDGE D, 2 EDGE^2, and by rounding 4.01 v 2 D^2: below 5 EDGE (D + EDGE) + 9 v D^2.
 *
 * The other bounds are above 1e-21: what underflows does not matter.
 */
/* Triangles as they are picked: sixteen by number, of a leaf cluster, or of two. */
typedef struct picked {
    const sc_leaf_derived *derived[2];
    const float *points[2];   /* see sc_frame.point_at */
    const uint8_t *corner[2]; /* see sc_model.leaf_corner */
    const uint8_t *numbers;   /* of the triangles */
} picked;

/* Sixteen pairs of triangles of two leaf clusters; or of two such pairs of clusters. */
typedef struct sixteen_pairs {
    picked of[2];   /* first and second triangles of pairs */
    unsigned split; /* lanes from here on are of the second pair of clusters */
    lanes extent;   /* of both clusters of a pair */
} sixteen_pairs;

/* A row of what is kept of these, at the same place in both clusters. */
static SC_INLINE lanes pick_kept(const sixteen_pairs *x, int two, const float *row,
                                 const float *other, lanes_index i)
{
    const float *rows[2];
    rows[0] = row;
    rows[1] = other;
    return two ? lanes_pick_two(rows, i, x->split) : lanes_pick(row, i);
}

/* The corners of these. */
static SC_INLINE void pick_corners(const sixteen_pairs *x, int s, int two, lanes at[3][3])
{
    const picked *t = &x->of[s];
    if (two)
        lanes_corners_two(t->points, t->corner, t->numbers, x->split, at);
    else
        lanes_corners_through(t->points[0], t->corner[0], t->numbers, at);
}

/* What a distance from a plane, up to a factor, may be off by: of sixteen, and of one. */
static inline lanes plane_bound(lanes size, lanes extent)
{
    const float edge = SC_BOUNDS_EDGE, v = SC_BOUNDS_V;
    lanes wide = lanes_add(extent, lanes_all(edge));
    lanes bound =
        lanes_add(lanes_multiply(size, lanes_all(2.1f * v)),
                  lanes_add(lanes_multiply(lanes_all(4 * edge), wide),
                            lanes_multiply(lanes_multiply(lanes_all(7 * v), extent), extent)));
    return lanes_add(lanes_multiply(size, bound), lanes_multiply(lanes_all(8 * edge * edge), wide));
}
static inline float one_plane_bound(float size, float extent)
{
    const float edge = SC_BOUNDS_EDGE, v = SC_BOUNDS_V;
    float bound = size * (2.1f * v) + (4 * edge * (extent + edge) + 7 * v * extent * extent);
    return size * bound + 8 * edge * edge * (extent + edge);
}

/* What a determinant of edges of two triangles may be off by; size is that of both, w runs from tip
   to tip. */
static inline lanes edges_bound(lanes size, const lanes w[3])
{
    const float edge = SC_BOUNDS_EDGE, v = SC_BOUNDS_V;
    lanes t = lanes_add(size, lanes_all(2 * edge)), u = lanes_all(4 * edge), bound;
    int c;
    SC_UNROLL
    for (c = 0; c < 3; c++) u = lanes_add(u, lanes_absolute(w[c]));
    bound = lanes_add(lanes_all(1.02f * edge), lanes_multiply(t, lanes_all(2.1f * v)));
    bound = lanes_add(lanes_multiply(u, bound), lanes_multiply(t, lanes_all(0.27f * edge)));
    return lanes_multiply(t, bound);
}

/* Of triangles of which the plane of another splits the corners: the one alone on its side, and the
   edges from there to the next corner and to the one after. */
typedef struct tip_corners {
    lanes at[3], edge[2][3];
    unsigned beside, split; /* where all corners are certainly on one side, or certainly not */
} tip_corners;

/* Of first triangles with the second's planes, s = 0, or the other way round. Sets size to that of
   the latter. */
static SC_INLINE void find_tips(const sixteen_pairs *sixteen, int s, int two, tip_corners *tips,
                                lanes *size)
{
    const picked *plane = &sixteen->of[1 - s];
    const sc_leaf_derived *derived = plane->derived[0], *other = plane->derived[1];
    lanes_index i = lanes_index_load(plane->numbers);
    lanes offset = pick_kept(sixteen, two, derived->offset, other->offset, i);
    lanes bound, x[3][3], n[3], least = offset;
    lanes_mask below[3], is_not[2];
    unsigned sure, same;
    int k, c;
    *size = pick_kept(sixteen, two, derived->size, other->size, i);
    bound = plane_bound(*size, sixteen->extent);
    pick_corners(sixteen, s, two, x);
    SC_UNROLL
    for (c = 0; c < 3; c++) n[c] = pick_kept(sixteen, two, derived->normal[c], other->normal[c], i);
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
    for (k = 0; k < 2; k++) is_not[k] = lanes_differ(below[1 - k], below[2]);
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
    same = ~(lanes_bits(is_not[0]) | lanes_bits(is_not[1]));
    tips->beside = sure & same;
    tips->split = sure & ~tips->beside;
}

/* Of pairs in a mask, of which each plane splits the other, those that are certainly apart; size is
   that of both triangles. */
static SC_INLINE unsigned miss_along_line(const tip_corners tips[2], lanes size, unsigned mask)
{
    lanes w[3], m[3], bound, least = lanes_all(INFINITY), most = lanes_all(-INFINITY);
    int i, j, c;
    SC_UNROLL
    for (c = 0; c < 3; c++) w[c] = lanes_subtract(tips[1].at[c], tips[0].at[c]);
    bound = edges_bound(size, w);
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
            least = lanes_smaller(least, d);
            most = lanes_larger(most, d);
        }
    }
    return mask & (lanes_bits(lanes_below(bound, least)) |
                   lanes_bits(lanes_below(most, lanes_subtract(lanes_all(0), bound))));
}

/* The lanes in which, seen along the axis nearest to the normal n of one, the line of an edge
   certainly has the third corner of its triangle on one side and all of the other triangle on the
   other. */
static unsigned side_separates(lanes x[2][3][3], const lanes n[3], lanes extent)
{
    const lanes bound = side_bound(extent);
    const lanes minus_bound = lanes_subtract(lanes_all(0), bound);
    lanes flat[2][3][2];
    unsigned apart = 0;
    int s, k, i;
    SC_UNROLL
    for (s = 0; s < 2; s++) see_along(n, (const lanes(*)[3])x[s], 3, flat[s]);
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

/* With few registers for sixteen floats, code for one pair of clusters and for two is kept apart
   where it is shorter. */
static void find_tips_one(const sixteen_pairs *x, int s, tip_corners *tips, lanes *size)
{
    find_tips(x, s, 0, tips, size);
}
static void find_tips_two(const sixteen_pairs *x, int s, tip_corners *tips, lanes *size)
{
    find_tips(x, s, 1, tips, size);
}
static SC_INLINE void find_tips_some(const sixteen_pairs *x, int s, int two, tip_corners *tips,
                                     lanes *size)
{
    if (SC_LANES_AVX512)
        find_tips(x, s, two, tips, size);
    else if (two)
        find_tips_two(x, s, tips, size);
    else
        find_tips_one(x, s, tips, size);
}

/* Of pairs in a mask, of triangles of two clusters or of two such pairs of clusters, those that are
   certainly apart. */
static SC_INLINE unsigned part_some(const sixteen_pairs *x, int two, unsigned mask)
{
    tip_corners tips[2];
    lanes size[2];
    unsigned open, split;
    find_tips_some(x, 0, two, &tips[0], &size[1]);
    open = mask & ~tips[0].beside;
    if (!open) return mask;
    find_tips_some(x, 1, two, &tips[1], &size[0]);
    open &= ~tips[1].beside;
    split = open & tips[0].split & tips[1].split;
    if (split) open &= ~miss_along_line(tips, lanes_add(size[0], size[1]), split);
    if (open & ~split) { /* not of others, whatever a sixteen has */
        const sc_leaf_derived *const *derived = x->of[0].derived;
        lanes_index i = lanes_index_load(x->of[0].numbers);
        lanes at[2][3][3], n[3];
        int c;
        SC_UNROLL
        for (c = 0; c < 2; c++) pick_corners(x, c, two, at[c]);
        SC_UNROLL
        for (c = 0; c < 3; c++)
            n[c] = pick_kept(x, two, derived[0]->normal[c], derived[1]->normal[c], i);
        open &= ~(~split & side_separates(at, n, x->extent));
    }
    return mask & ~open;
}

/* The same, split or not. With many registers for sixteen floats each is code of its own. */
static SC_NOINLINE unsigned part_one(const sixteen_pairs *x, unsigned mask)
{
    return part_some(x, SC_LANES_AVX512 ? 0 : x->split < SC_LANES_COUNT, mask);
}
static SC_NOINLINE unsigned part_two(const sixteen_pairs *x, unsigned mask)
{
    return part_some(x, 1, mask);
}
static inline unsigned part_pairs(const sixteen_pairs *x, unsigned mask)
{
    return SC_LANES_AVX512 && x->split < SC_LANES_COUNT ? part_two(x, mask) : part_one(x, mask);
}
