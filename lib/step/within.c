/*
 * Exact comparison of a distance: see within.h for what it promises.
 *
 * SPDX-License-Identifier: MIT
 *
 * The differences between a point of one set and a point of the other are the points of a flat
 * convex polygon: a triangle with the three differences between corners and vertex, or a
 * parallelogram with the four differences between the ends of two edges. The distance of the two
 * sets is that of the polygon from the origin. So there is one text for both kinds, for three or
 * four corners c_0, c_1, ... in order; e_i = c_(i+1) - c_i are the edges, n = e_0 x e_1 is a
 * normal. Each corner, and each edge, is the difference of two given points.
 *
 * Doubles. The nearest point of the polygon is guessed: on each of the edges, and inside.
 *
 *   Near: the guess q is a sum of the corners, whose weights are not negative and add up to 1 but
 *   for rounding; so a point of the polygon is next to q, wherever the guess came from, and if |q|
 *   and errors are no more than the distance d, then the answer is 1.
 *
 *   Far: if q . c_i > |q| d for all corners, with room for errors, then q . x > |q| d for all
 *   points x of the polygon, hence |x| > d. This holds for any q but 0.
 *
 *   Errors. u = 2^-53. R is the largest |c_i|, computed; it is within 2.6 u of itself, as |c_i|^2
 *   has three roundings and the root one. A corner is off by one rounding a coordinate, u R
 *   together.
 *     - Weights of a parallelogram are products of s, t, 1 - s and 1 - t, of which the latter are
 *       off by u / 2 at most, being 1 or less, and the products by u: they add up to 1 to within
 *       2.1 u. Those of a triangle are quotients by the sum of three positive numbers, which has
 *       two roundings, and the quotient one: to within 3.1 u. On an edge they are t and 1 - t: u /
 *       2.
 *     - A point x of the polygon is q computed without roundings from true corners, over the sum of
 *       the weights. q has up to four terms, rounded four times at most (parallelogram; three
 *       times, of a triangle), which is 4.1 u R in all, as the weights of the |c_i| add up to 1;
 *       corners 1.1 u R; the sum of the weights 2.1 u R; for a triangle 3.1, 1.1 and 3.1. So |x -
 *       q| < 7.4 u R.
 *     - |q|^2, computed, has three roundings; the square of r = d - E one, and r one: what passes
 *       |q|^2 <= r^2 has a true |q| <= (d - E) (1 + 3.1 u). So it suffices that
 *       E (1 - 3.1 u) >= 7.4 u R + 3.1 u d.
 *     - q . c_i has three roundings of terms that add up to |q| |c_i| at most, and the corner
 *       another: 4.1 u R |q|. The other side is a root (2.6 u), d + E (u) and their product (u). So
 *       it suffices that E (1 - 4.7 u) >= 4.1 u R + 4.7 u d.
 *   E = 8 u (R + d) is enough for both, with its own three roundings, and half a u R to spare.
 *
 *   Underflow. R is above 2^-250, so that what is spared is above 2^-305. What underflows in q and
 *   |q|^2 is off by less than 2^-1000, of |q| itself by the root of that, 2^-500. A direction is
 *   believed only if |q| > E computed, which is above 2^-301: then what underflows in q . c_i,
 *   again less than 2^-1000, is nothing beside u R |q|, which is above 2^-604. R is below 2^250, so
 *   that no product of four coordinates overflows. Guesses may be spoilt by underflow; they need
 *   not be good.
 *
 * Exactly. The nearest point of the polygon is a corner, or inside an edge, or inside the polygon.
 * For each of these
 *
 *     corner   |c_i|^2 <= d^2
 *     edge     |c_i x c_(i+1)|^2 <= d^2 |e_i|^2   where c_i . e_i < 0 < c_(i+1) . e_i
 *     inside   (c_0 . n)^2 <= d^2 |n|^2           where (c_i x c_(i+1)) . n > 0 for all i
 *
 * says of a point of the polygon that it is near enough; on the right, that the foot of the
 * perpendicular is inside. So if any of them holds, the answer is 1. If none holds, it is 0, for
 * the nearest point of the polygon is such a foot: if it lies inside and n is not 0, or inside an
 * edge that is not 0, then the origin is over it, and otherwise (n = 0, and all is on a line) it is
 * in an edge or a corner as well. The conditions on the right are false where e_i or n is 0.
 *
 * The one that was guessed comes first. It often tells that nothing else is nearer:
 *
 *     corner   c_i . e_i >= 0 and c_i . e_(i-1) <= 0: the polygon lies beyond the plane through c_i
 *              across c_i, as the two edges span the angle in which all of it lies
 *     edge     (c_i x c_(i+1)) . n <= 0: seen along n, the origin is on the outer side of the edge,
 *              or on it, and its foot is inside the edge; if n = 0, all is on the line of that edge
 *     inside   always
 *
 * All these are signs of polynomials of degree 2, 4 and 6 with integers, once the coordinates and d
 * are divided by a power of two. Limbs: with differences and d below 2^(64 n - 2), in magnitude,
 * scalar products are below 3 2^(128 n - 4), components of cross products and n below
 * 2 2^(128 n - 4), products of two of those, added three times, below 12 2^(256 n - 8),
 * c_0 . n below 6 2^(192 n - 6), its square below 36 2^(384 n - 12), and d^2 times |n|^2 below
 * 12 2^(384 n - 12): each of degree k fits into k n limbs, with its sign.
 */
#include "step/within.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

#include "base/assume.h"
#include "base/bits.h"
#include "base/bounds.h"
#include "base/predicates.h"
#include "step/limbs.h"
#include "simd/isa.h"
#if defined(__SIZEOF_INT128__) && defined(__GNUC__)
#  include "step/words.h"
#endif

enum {
    WITHIN_CORNERS = 4,
    WITHIN_LIMBS = 33,  /* of a coordinate, at most */
    WITHIN_NUMBERS = 12 /* coordinates of the four points; the distance comes behind them */
};

static const int within_corner_count[2] = {3, 4};

/* Corner i is the point [i][0] less the point [i][1]; of kinds one after the other. */
static const unsigned char within_corner[2][WITHIN_CORNERS][2] = {{{1, 0}, {2, 0}, {3, 0}, {0, 0}},
                                                                  {{2, 0}, {3, 0}, {3, 1}, {2, 1}}};

/* ------------------------------------------------------------------------------------------------
 * Doubles
 */

/* A polygon, and the point of it that is taken to be next to the origin. A guess is i for corner i,
   corners + i for edge i, 2 corners for the inside. */
typedef struct within_polygon {
    int corners;
    double corner[WITHIN_CORNERS][3];
    double point[3], square; /* of its distance from the origin */
    int guess;
} within_polygon;

static SC_INLINE double within_inner(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static SC_INLINE void within_outer(double result[3], const double a[3], const double b[3])
{
    result[0] = a[1] * b[2] - a[2] * b[1];
    result[1] = a[2] * b[0] - a[0] * b[2];
    result[2] = a[0] * b[1] - a[1] * b[0];
}

/* The best point of all edges. What is not a number, where an edge is 0, becomes 0. */
static SC_INLINE void guess_on_edges(within_polygon *g)
{
    double q[WITHIN_CORNERS][3], t[WITHIN_CORNERS] = {0}, square[WITHIN_CORNERS] = {0};
    int best = 0, next;
    for (int i = 0; i < g->corners; ++i) {
        const double *a = g->corner[i], *b = g->corner[i + 1 < g->corners ? i + 1 : 0];
        double e[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
        double s = -within_inner(a, e) / within_inner(e, e), s_rest;
        s = s > 0 ? s : 0;
        s = s < 1 ? s : 1;
        s_rest = 1 - s;
        for (int k = 0; k < 3; ++k) q[i][k] = s_rest * a[k] + s * b[k];
        square[i] = within_inner(q[i], q[i]);
        t[i] = s;
        best = square[i] < square[best] ? i : best;
    }
    next = best + 1 < g->corners ? best + 1 : 0;
    g->square = square[best];
    g->guess = t[best] == 0 ? best : t[best] == 1 ? next : g->corners + best;
    memcpy(g->point, q[best], sizeof q[best]);
}

/* The foot of the perpendicular, if it seems to be inside. */
static SC_INLINE void guess_inside(within_polygon *g)
{
    const double(*c)[3] = (const double(*)[3])g->corner;
    double e[2][3], n[3], side[WITHIN_CORNERS] = {0, 0, 0, 0}, weight[WITHIN_CORNERS];
    for (int k = 0; k < 3; ++k) {
        e[0][k] = c[1][k] - c[0][k];
        e[1][k] = c[2][k] - c[1][k];
    }
    within_outer(n, e[0], e[1]);
    for (int i = 0; i < g->corners; ++i) {
        double m[3];
        within_outer(m, c[i], c[i + 1 < g->corners ? i + 1 : 0]);
        side[i] = within_inner(m, n);
        if (!(side[i] > 0)) return;
    }
    if (g->corners == 3) {
        double sum = side[0] + side[1] + side[2];
        weight[0] = side[1] / sum;
        weight[1] = side[2] / sum;
        weight[2] = side[0] / sum;
    } else {
        double s = side[3] / (side[3] + side[1]), t = side[0] / (side[0] + side[2]);
        double s_rest = 1 - s, t_rest = 1 - t;
        weight[0] = s_rest * t_rest;
        weight[1] = s * t_rest;
        weight[2] = s * t;
        weight[3] = s_rest * t;
    }
    for (int k = 0; k < 3; ++k) {
        double q = weight[0] * c[0][k];
        for (int i = 1; i < g->corners; ++i) q += weight[i] * c[i][k];
        g->point[k] = q;
    }
    g->square = within_inner(g->point, g->point);
    g->guess = 2 * g->corners;
}

static SC_INLINE int decide_in_doubles(int kind, const double p[4][3], double distance, int *guess)
{
    within_polygon g;
    double largest = 0, error, near_enough, least = HUGE_VAL;
    g.corners = within_corner_count[kind];
    g.guess = 0;
    *guess = 0;
    for (int i = 0; i < g.corners; ++i) {
        const double *to = p[within_corner[kind][i][0]], *from = p[within_corner[kind][i][1]];
        double square;
        for (int k = 0; k < 3; ++k) g.corner[i][k] = to[k] - from[k];
        square = within_inner(g.corner[i], g.corner[i]);
        largest = largest < square ? square : largest;
        /* What overflowed may be no number any more, which would not show in the largest. */
        if (!(square < 0x1p500)) return SC_WITHIN_UNSURE;
    }
    if (!(largest > 0x1p-500)) return SC_WITHIN_UNSURE;

    guess_on_edges(&g);
    guess_inside(&g);
    *guess = g.guess;
    error = SC_BOUNDS_WITHIN * (sqrt(largest) + distance);
    near_enough = distance - error;
    if (near_enough > 0 && g.square <= near_enough * near_enough) return 1;

    for (int i = 0; i < g.corners; ++i) {
        double along = within_inner(g.point, g.corner[i]);
        least = along < least ? along : least;
    }
    if (g.square > error * error && least > sqrt(g.square) * (distance + error)) return 0;
    return SC_WITHIN_UNSURE;
}

/* ------------------------------------------------------------------------------------------------
 * Integers: one text for numbers of any length; vectors are three of n limbs, one after the other.
 */

/* result = a . b, of an + bn limbs */
static void within_dot(uint64_t *result, const uint64_t *a, int an, const uint64_t *b, int bn)
{
    uint64_t product[6 * WITHIN_LIMBS];
    sc_limbs_multiply(result, a, an, b, bn);
    for (int k = 1; k < 3; ++k) {
        sc_limbs_multiply(product, a + k * an, an, b + k * bn, bn);
        sc_limbs_add(result, product, an + bn);
    }
}

/* result = a x b, three of 2 n limbs */
static void within_cross(uint64_t *result, const uint64_t *a, const uint64_t *b, int n)
{
    uint64_t product[2 * WITHIN_LIMBS];
    for (int k = 0; k < 3; ++k) {
        int x = (k + 1) % 3, y = (k + 2) % 3;
        sc_limbs_multiply(result + 2 * k * n, a + x * n, n, b + y * n, n);
        sc_limbs_multiply(product, a + y * n, n, b + x * n, n);
        sc_limbs_subtract(result + 2 * k * n, result + 2 * k * n, product, 2 * n);
    }
}

/* A polygon with integer coordinates of n limbs. */
typedef struct within_shape {
    int n, corners;
    uint64_t corner[WITHIN_CORNERS * 3 * WITHIN_LIMBS];
    uint64_t square[2 * WITHIN_LIMBS]; /* of the distance */
    uint64_t normal[6 * WITHIN_LIMBS]; /* once it is asked for */
} within_shape;

static const uint64_t *shape_corner(const within_shape *s, int i)
{
    return s->corner + 3 * (i < s->corners ? i : i - s->corners) * s->n;
}

static void shape_edge(uint64_t *result, const within_shape *s, int i)
{
    const uint64_t *to = shape_corner(s, i + 1), *from = shape_corner(s, i);
    for (int k = 0; k < 3; ++k)
        sc_limbs_subtract(result + k * s->n, to + k * s->n, from + k * s->n, s->n);
}

/* The sign of corner . edge. */
static int corner_along_edge(const within_shape *s, int corner, const uint64_t *edge)
{
    uint64_t along[2 * WITHIN_LIMBS];
    within_dot(along, shape_corner(s, corner), s->n, edge, s->n);
    return sc_limbs_sign(along, 2 * s->n);
}

static void find_shape_normal(within_shape *s)
{
    uint64_t e[3 * WITHIN_LIMBS], f[3 * WITHIN_LIMBS];
    shape_edge(e, s, 0);
    shape_edge(f, s, 1);
    within_cross(s->normal, e, f, s->n);
}

/* The sign of m . normal, m = c_i x c_(i+1): on which side of edge i the origin is. */
static int side_of_edge(const within_shape *s, const uint64_t *m)
{
    uint64_t side[4 * WITHIN_LIMBS];
    within_dot(side, m, 2 * s->n, s->normal, 2 * s->n);
    return sc_limbs_sign(side, 4 * s->n);
}

/* Whether a <= the square of the distance times b, of an and bn limbs; an = bn + 2 n. */
static int is_within(const within_shape *s, const uint64_t *a, int an, const uint64_t *b, int bn)
{
    uint64_t rest[6 * WITHIN_LIMBS];
    sc_limbs_multiply(rest, s->square, 2 * s->n, b, bn);
    sc_limbs_subtract(rest, rest, a, an);
    return sc_limbs_sign(rest, an) >= 0;
}

/* Each of the next three answers 1 if a point is near enough there, 0 if nothing else is nearer,
   else SC_WITHIN_UNSURE. */
static int decide_corner(const within_shape *s, int i)
{
    uint64_t square[2 * WITHIN_LIMBS], edge[3 * WITHIN_LIMBS];
    within_dot(square, shape_corner(s, i), s->n, shape_corner(s, i), s->n);
    sc_limbs_subtract(square, s->square, square, 2 * s->n);
    if (sc_limbs_sign(square, 2 * s->n) >= 0) return 1;
    shape_edge(edge, s, i);
    if (corner_along_edge(s, i, edge) < 0) return SC_WITHIN_UNSURE;
    shape_edge(edge, s, i > 0 ? i - 1 : s->corners - 1);
    return corner_along_edge(s, i, edge) <= 0 ? 0 : SC_WITHIN_UNSURE;
}

static int decide_edge(within_shape *s, int i)
{
    uint64_t edge[3 * WITHIN_LIMBS], m[6 * WITHIN_LIMBS];
    uint64_t length[2 * WITHIN_LIMBS], area[4 * WITHIN_LIMBS];
    shape_edge(edge, s, i);
    if (corner_along_edge(s, i, edge) >= 0) return SC_WITHIN_UNSURE;
    if (corner_along_edge(s, i + 1, edge) <= 0) return SC_WITHIN_UNSURE;
    within_cross(m, shape_corner(s, i), shape_corner(s, i + 1), s->n);
    within_dot(area, m, 2 * s->n, m, 2 * s->n);
    within_dot(length, edge, s->n, edge, s->n);
    if (is_within(s, area, 4 * s->n, length, 2 * s->n)) return 1;
    find_shape_normal(s);
    return side_of_edge(s, m) <= 0 ? 0 : SC_WITHIN_UNSURE;
}

static int decide_inside(within_shape *s)
{
    uint64_t m[6 * WITHIN_LIMBS], length[4 * WITHIN_LIMBS];
    uint64_t height[3 * WITHIN_LIMBS], square[6 * WITHIN_LIMBS];
    find_shape_normal(s);
    for (int i = 0; i < s->corners; ++i) {
        within_cross(m, shape_corner(s, i), shape_corner(s, i + 1), s->n);
        if (side_of_edge(s, m) <= 0) return SC_WITHIN_UNSURE;
    }
    within_dot(height, shape_corner(s, 0), s->n, s->normal, 2 * s->n);
    sc_limbs_multiply(square, height, 3 * s->n, height, 3 * s->n);
    within_dot(length, s->normal, 2 * s->n, s->normal, 2 * s->n);
    return is_within(s, square, 6 * s->n, length, 4 * s->n);
}

static int decide_at(within_shape *s, int guess)
{
    if (guess < s->corners) return decide_corner(s, guess);
    if (guess < 2 * s->corners) return decide_edge(s, guess - s->corners);
    return decide_inside(s);
}

/* x holds the coordinates of the four points and the distance, n limbs each. */
static int decide_by_signs(int kind, const uint64_t *x, int n, int guess)
{
    within_shape s;
    const uint64_t *distance = x + WITHIN_NUMBERS * n;
    int answer;
    s.n = n;
    s.corners = within_corner_count[kind];
    for (int i = 0; i < s.corners; ++i) {
        const uint64_t *to = x + 3 * within_corner[kind][i][0] * n;
        const uint64_t *from = x + 3 * within_corner[kind][i][1] * n;
        for (int k = 0; k < 3; ++k)
            sc_limbs_subtract(s.corner + (3 * i + k) * n, to + k * n, from + k * n, n);
    }
    sc_limbs_multiply(s.square, distance, n, distance, n);
    answer = decide_at(&s, guess);
    /* one of them is the nearest point, which is told where it is asked for: see "Exactly" */
    for (int i = 0; answer == SC_WITHIN_UNSURE && SC_ALWAYS(i <= 2 * s.corners); ++i)
        answer = decide_at(&s, i);
    return answer == 1;
}

/* ------------------------------------------------------------------------------------------------
 * Words
 */

/* The bits of a double but that of the sign, which order numbers by magnitude. */
static SC_INLINE uint64_t magnitude_bits(double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits & UINT64_MAX >> 1;
}

static SC_INLINE double power_of_two(int exponent)
{
    uint64_t bits = (uint64_t)(1023 + exponent) << 52;
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

/* Two powers of two, far apart, each times 1.5 2^52: what is added to one of them becomes a
   multiple of that power, in the last bits of the sum. */
typedef struct word_scale {
    double coarse, fine;
    uint64_t coarse_bits, fine_bits;
} word_scale;

enum { WORD_BITS = 61, WORD_FINE_BITS = 35 };

/*
 * The integer that value is over the fine power, exactly, or bits in *wrong: value is the sum of a
 * multiple of the coarse power and a rest of up to half of it, both exact, and the rest is to be a
 * multiple of the fine power. Sums are compared with the value by their bits, so that what is
 * subnormal is not taken for 0 where a machine does so; the sign of 0 does not matter.
 */
static SC_INLINE int64_t scale_to_word(const word_scale *s, double value, uint64_t *wrong)
{
    double coarse = value + s->coarse, high = coarse - s->coarse;
    double fine = (value - high) + s->fine, low = fine - s->fine, sum = high + low;
    uint64_t coarse_bits, fine_bits, value_bits, sum_bits;
    memcpy(&coarse_bits, &coarse, sizeof coarse);
    memcpy(&fine_bits, &fine, sizeof fine);
    memcpy(&value_bits, &value, sizeof value);
    memcpy(&sum_bits, &sum, sizeof sum);
    *wrong |= (value_bits ^ sum_bits) << 1;
    return (int64_t)(((coarse_bits - s->coarse_bits) << WORD_FINE_BITS) +
                     (fine_bits - s->fine_bits));
}

/* Sets x to the twelve coordinates and the distance over one power of two, each below 2^61; 0 if
   they are no multiples of it. The largest is from 2^-900 to below 2^901, so that both powers and
   their sums are normal numbers. */
static SC_INLINE int scale_to_words(int64_t *x, const double p[4][3], double distance)
{
    const double *values = p[0];
    double largest = distance, some[4];
    uint64_t wrong = 0;
    word_scale s;
    int exponent;
    for (int i = 0; i < 4; ++i) {
        double a = fabs(values[i]), b = fabs(values[i + 4]), c = fabs(values[i + 8]);
        a = a > b ? a : b;
        some[i] = a > c ? a : c;
    }
    for (int i = 0; i < 4; ++i) largest = some[i] > largest ? some[i] : largest;
    exponent = (int)(magnitude_bits(largest) >> 52) - 1023;
    if (exponent < -900 || exponent > 900) return 0;
    s.fine = 1.5 * power_of_two(exponent + 1 - WORD_BITS + 52);
    s.coarse = 1.5 * power_of_two(exponent + 1 - WORD_BITS + WORD_FINE_BITS + 52);
    s.fine_bits = magnitude_bits(s.fine);
    s.coarse_bits = magnitude_bits(s.coarse);
    for (int i = 0; i < WITHIN_NUMBERS; ++i) x[i] = scale_to_word(&s, values[i], &wrong);
    x[WITHIN_NUMBERS] = scale_to_word(&s, distance, &wrong);
    return wrong == 0;
}

#if defined(__SIZEOF_INT128__) && defined(__GNUC__)

static SC_INLINE int decide_scaled_words(int kind, const int64_t *x, int guess)
{
    sc_words_shape s;
    s.corners = within_corner_count[kind];
    for (int i = 0; i < s.corners; ++i) {
        const int64_t *to = x + 3 * within_corner[kind][i][0];
        const int64_t *from = x + 3 * within_corner[kind][i][1];
        for (int k = 0; k < 3; ++k) s.corner[i][k] = to[k] - from[k];
    }
    s.distance = x[WITHIN_NUMBERS];
    return sc_words_decide(&s, guess);
}

#else

static int decide_scaled_words(int kind, const int64_t *x, int guess)
{
    uint64_t limbs[WITHIN_NUMBERS + 1];
    for (int i = 0; i <= WITHIN_NUMBERS; ++i) limbs[i] = (uint64_t)x[i];
    return decide_by_signs(kind, limbs, 1, guess);
}

#endif

static SC_INLINE int decide_in_words(int kind, const double p[4][3], double distance, int guess)
{
    int64_t x[WITHIN_NUMBERS + 1];
    if (!scale_to_words(x, p, distance)) return SC_WITHIN_UNSURE;
    return decide_scaled_words(kind, x, guess);
}

/* ------------------------------------------------------------------------------------------------
 * Integers of any length
 */

/* A finite double is the mantissa, below 2^53, times 2^(exponent - 1074). */
static uint64_t mantissa_of(double value, int *exponent)
{
    const uint64_t leading_one = UINT64_C(1) << 52;
    uint64_t bits = magnitude_bits(value);
    *exponent = (int)(bits >> 52);
    if (*exponent == 0) return bits; /* subnormal, or 0 */
    --*exponent;
    return (bits & (leading_one - 1)) | leading_one;
}

/* Sets n limbs to value / 2^(least - 1074), which is an integer. */
static void set_limbs(uint64_t *limb, int n, double value, int least)
{
    int exponent;
    uint64_t mantissa = mantissa_of(value, &exponent), sign, carry;
    for (int i = 0; i < n; ++i) limb[i] = 0;
    if (mantissa == 0) return;
    if (exponent < least) {
        mantissa >>= least - exponent;
        exponent = least;
    }
    int at = (exponent - least) / 64, shift = (exponent - least) % 64;
    limb[at] = mantissa << shift;
    if (shift > 11) limb[at + 1] = mantissa >> (64 - shift);
    sign = value < 0 ? UINT64_MAX : 0;
    carry = sign & 1;
    for (int i = 0; i < n; ++i) {
        limb[i] = (limb[i] ^ sign) + carry;
        carry = limb[i] < carry;
    }
}

static SC_NOINLINE int decide_at_length(int kind, const double p[4][3], double distance, int guess)
{
    uint64_t x[(WITHIN_NUMBERS + 1) * WITHIN_LIMBS];
    const double *values = p[0];
    int least = 2 * 2048, most = 0, n;
    for (int i = 0; i <= WITHIN_NUMBERS; ++i) {
        int exponent;
        uint64_t mantissa = mantissa_of(i < WITHIN_NUMBERS ? values[i] : distance, &exponent);
        if (mantissa == 0) continue;
        int low = exponent + (int)sc_bits_lowest64(mantissa);
        least = low < least ? low : least;
        most = exponent + 53 > most ? exponent + 53 : most;
    }
    /* A bit more for differences, two to spare. */
    n = most > least ? (most - least + 3 + 63) / 64 : 1;
    for (int i = 0; i <= WITHIN_NUMBERS; ++i)
        set_limbs(x + i * n, n, i < WITHIN_NUMBERS ? values[i] : distance, least);
    return decide_by_signs(kind, x, n, guess);
}

/* ---------------------------------------------------------------------------------------------- */

/* Whose text is compiled for each kind. */
int sc_within_by_doubles(sc_within_kind kind, const double p[4][3], double distance, int *guess)
{
    if (kind == SC_WITHIN_VERTEX_FACE)
        return decide_in_doubles(SC_WITHIN_VERTEX_FACE, p, distance, guess);
    return decide_in_doubles(SC_WITHIN_EDGE_EDGE, p, distance, guess);
}

int sc_within_by_words(sc_within_kind kind, const double p[4][3], double distance, int guess)
{
    if (kind == SC_WITHIN_VERTEX_FACE)
        return decide_in_words(SC_WITHIN_VERTEX_FACE, p, distance, guess);
    return decide_in_words(SC_WITHIN_EDGE_EDGE, p, distance, guess);
}

int sc_within_by_integers(sc_within_kind kind, const double p[4][3], double distance, int guess)
{
    return decide_at_length((int)kind, p, distance, guess);
}

static int decide_within(sc_within_kind kind, const double p[4][3], double distance)
{
    int guess, answer = sc_within_by_doubles(kind, p, distance, &guess);
    if (answer == SC_WITHIN_UNSURE) answer = sc_within_by_words(kind, p, distance, guess);
    if (answer == SC_WITHIN_UNSURE) answer = sc_within_by_integers(kind, p, distance, guess);
    return answer;
}

int sc_within_vertex_face(const double p[4][3], double distance)
{
    return decide_within(SC_WITHIN_VERTEX_FACE, p, distance);
}

int sc_within_edge_edge(const double p[4][3], double distance)
{
    return decide_within(SC_WITHIN_EDGE_EDGE, p, distance);
}
