/*
 * Pairs that floats left open, by exact signs: the last stages of a search for what is near.
 *
 * SPDX-License-Identifier: MIT
 *
 * On a regular grid, where the distance is that of its points, half of all pairs are as far apart
 * as the distance but for a few roundings, and the nearest points of nearly all of these are
 * corners or ends: two given points. So of eight pairs at a time the nearest two points are found
 * in doubles, and two proofs are tried; what neither tells is left to step/within.h, one by one. A
 * difference of two points is called a corner here, as in step/within.c.
 *
 * Near, if c, the smallest corner, is: the square of its length less that of the distance d, as a
 * sum of two doubles. u = 2^-53, D = d d. Each component of c is known as a value and a tail, at
 * most u of it; the square of a value as a product and a rest, at most u of it; the sum of the
 * products as s and two rests; D as a product and a rest. So the difference is t = s - D and a sum
 * R of nine terms; left out are squares of tails, 2 u^2 D. Let s be from D / 2 to 2 D. Then t has
 * no rounding (Sterbenz), the terms of R come to 11 u D in size, and their rounding to 94 u^2 D: so
 * t + R is off by less than 2^-98 D, but for its own rounding, which changes no sign. Below -2^-96
 * D (SC_BOUNDS_CORNER) the difference is less than 0. Where s is smaller it is so without doubt, as
 * R is small beside D / 2; where s is larger, or overflows, t + R is above 0 or no number. The
 * largest error in three million pairs made for it was 2^-103 D.
 *
 * Far, if c separates: q . c_i > |q| d for all corners c_i and any q says so, as in step/within.c;
 * q is c. Let R be the largest |c_i|, which |x| + |y| + |z|, as computed, is not below by more than
 * u. Scalar products are off by 4.1 u R |q|, with the rounding of corners. They are compared with
 * |q| f by squares, of which the roundings make |q| f (1 - 3.1 u) at least, where f = d + 8 u (R +
 * d) (SC_BOUNDS_WITHIN) with its own is d (1 + 7 u) + 7.9 u R or more: that is above |q| (d + 4.1 u
 * R).
 *
 * Underflow, also where subnormal numbers count as 0 (of floats: GUARANTEE.md, at its beginning): d
 * is from 2^-200 to 2^200, and corners of what is far are shorter than 2^250. c is one of the
 * corners, so the least scalar product is at most its square, which is more than f f if that
 * product is above |c| f. So squares that are compared are above 2^-801 and below 2^1001; and what
 * is lost, 2^-1021 |q| of a scalar product and 2^-820 of a difference of squares, is nothing beside
 * u R |q|, above 2^-254 |q|, and 2^-98 D, above 2^-499.
 */

/* Fewer are decided one by one. */
enum { CORNERS_EIGHT = 8, CORNERS_PAY = 3 };

/* The distance, and its square as square + rest. What is below sure is less than 0; corners of what
   is far are shorter than reach. Nothing is either where the distance is out of range. */
typedef struct corner_limits {
    double distance, square, rest, sure, reach;
} corner_limits;

static corner_limits corner_limits_for(double distance)
{
    const exact_doubles d = exact_difference(doubles_all(distance), doubles_all(0));
    double square[CORNERS_EIGHT], rest[CORNERS_EIGHT];
    corner_limits limits;
    doubles left;
    doubles_store(square, exact_product(&d, &d, &left));
    doubles_store(rest, left);
    limits.distance = distance;
    limits.square = square[0];
    limits.rest = rest[0];
    limits.sure = -HUGE_VAL;
    limits.reach = 0;
    if (distance > 0x1p-200 && distance < 0x1p200) {
        limits.sure = -SC_BOUNDS_CORNER * square[0];
        limits.reach = 0x1p250;
    }
    return limits;
}

static SC_INLINE doubles inner_of_doubles(const doubles a[3], const doubles b[3])
{
    return doubles_add(doubles_add(doubles_multiply(a[0], b[0]), doubles_multiply(a[1], b[1])),
                       doubles_multiply(a[2], b[2]));
}

/* Pairs that are near as two of their points are and, in the upper half, far ones; at: where the
   first, second, third and fourth points of eight are. */
static SC_INLINE unsigned judge_by_corners(int kind,
                                           const unsigned char *const at[4][CORNERS_EIGHT],
                                           int floats, const corner_limits *limits)
{
    /* differences of these points are the corners: see step/within.c */
    static const unsigned char of[2][4][2] = {{{1, 0}, {2, 0}, {3, 0}, {3, 0}},
                                              {{2, 0}, {3, 0}, {3, 1}, {2, 1}}};
    const int corners = kind == SC_STEP_VERTEX_FACE ? 3 : 4;
    const doubles zero = doubles_all(0), distance = doubles_all(limits->distance);
    doubles point[4][3], corner[4][3], to[3], from[3], c[3], square[3], sum, rest, side;
    doubles least = doubles_all(HUGE_VAL), size = least, rests = zero, reach = zero;
    doubles_mask far;
    int i, k;
    for (i = 0; i < 4; i++) doubles_points(at[i], floats, point[i]);
    for (k = 0; k < 3; k++) {
        to[k] = point[of[kind][0][0]][k];
        from[k] = point[of[kind][0][1]][k];
    }
    for (i = 0; i < corners; i++) { /* squares may be infinite */
        const doubles *a = point[of[kind][i][0]], *b = point[of[kind][i][1]];
        doubles_mask nearer;
        for (k = 0; k < 3; k++) corner[i][k] = doubles_subtract(a[k], b[k]);
        side = inner_of_doubles((const doubles *)corner[i], (const doubles *)corner[i]);
        nearer = doubles_below(side, size);
        size = doubles_choose(nearer, side, size);
        for (k = 0; k < 3; k++) {
            to[k] = doubles_choose(nearer, a[k], to[k]);
            from[k] = doubles_choose(nearer, b[k], from[k]);
        }
        reach = doubles_larger(
            doubles_add(doubles_add(doubles_absolute(corner[i][0]), doubles_absolute(corner[i][1])),
                        doubles_absolute(corner[i][2])),
            reach);
    }
    for (k = 0; k < 3; k++) {
        const exact_doubles n = exact_difference(to[k], from[k]);
        const doubles part = doubles_multiply(n.value, n.tail);
        c[k] = n.value;
        square[k] = exact_product(&n, &n, &rest);
        rests = doubles_add(doubles_add(rests, rest), doubles_add(part, part));
    }
    sum = exact_sum(square[0], square[1], &rest);
    rests = doubles_add(rests, rest);
    sum = exact_sum(sum, square[2], &rest);
    rests = doubles_subtract(doubles_add(rests, rest), doubles_all(limits->rest));
    sum = doubles_add(doubles_subtract(sum, doubles_all(limits->square)), rests);

    for (i = 0; i < corners; i++)
        least = doubles_smaller(inner_of_doubles((const doubles *)corner[i], (const doubles *)c),
                                least);
    side = doubles_add(
        distance, doubles_multiply(doubles_all(SC_BOUNDS_WITHIN), doubles_add(reach, distance)));
    far = doubles_both(
        doubles_below(doubles_multiply(doubles_multiply(size, side), side),
                      doubles_multiply(least, least)),
        doubles_both(doubles_below(zero, least), doubles_below(reach, doubles_all(limits->reach))));
    return doubles_bits(doubles_below(sum, doubles_all(limits->sure))) | doubles_bits(far) << 16;
}

/* Where the points of a pair are, as those of pair i. */
static SC_INLINE void find_corners(const sc_worker *w, int kind, const sc_pair *pair,
                                   const unsigned char *at[4][CORNERS_EIGHT], uint32_t i)
{
    const sc_pair_sides sides = sc_step_candidates_sides(w, kind, pair);
    uint32_t point[4], k;
    sc_step_candidates_points(w, kind, pair, point);
    for (k = 0; k < 4; k++) {
        const sc_worker *side = k < sc_step_points_of_first(kind) ? sides.a : sides.b;
        at[k][i] = sc_positions_place(&side->frame->positions[0], point[k]);
    }
}

static SC_INLINE void take_near_open(sc_worker *w, uint32_t most, int kind)
{
    uint32_t *left = &w->lists.count[SC_LIST_FACES + kind];
    const sc_pair *pairs = w->lists.moving[kind];
    const corner_limits limits = corner_limits_for(w->question->near->options.distance);
    const uint32_t type = w->frame->positions[0].type;
    const int together = type == w->second->frame->positions[0].type;
    while (most && *left && !w->stop) {
        const unsigned char *at[4][CORNERS_EIGHT];
        uint32_t count = *left < most ? *left : most, i;
        unsigned known = 0;
        if (count > CORNERS_EIGHT) count = CORNERS_EIGHT;
        if (count >= CORNERS_PAY && together) {
            for (i = 0; i < CORNERS_EIGHT; i++)
                find_corners(w, kind, &pairs[*left - 1 - (i < count ? i : 0)], at, i);
            known = judge_by_corners(kind, (const unsigned char *const(*)[CORNERS_EIGHT])at,
                                     type == SC_FLOAT, &limits);
        }
        for (i = 0; i < count && !w->stop; i++, most--) {
            const sc_pair pair = pairs[--*left];
            if (known >> i >> 16 & 1) continue;
            sc_near_candidates_decide(w, kind, pair, known >> i & 1);
        }
    }
}

static void take_near_open_faces(sc_worker *w, uint32_t most)
{
    take_near_open(w, most, SC_STEP_VERTEX_FACE);
}

static void take_near_open_edges(sc_worker *w, uint32_t most)
{
    take_near_open(w, most, SC_STEP_EDGE_EDGE);
}
