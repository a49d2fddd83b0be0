/*
 * Differences of four points and polynomials of them. See differences.h.
 *
 * SPDX-License-Identifier: MIT
 *
 * Sums of two doubles. Let u = 2^-53. A number X is high + low with
 *     |X - high - low| <= A u^2 m,   |low| <= L u m,
 * m its magnitude, to first order. A difference of two coordinates has A = 0 and L = 1, as what its
 * rounding lost is known. A sum of up to three products X Y, whose magnitude M is the sum of
 * theirs, is made so: high is the sum of all high parts' products; what that loses is known
 * exactly, u M by the products and 2 u M by the sums. low is the sum of that and of all high low' +
 * low high', which are (L + L') u M. So it is at most (3 + L + L') u M, and each of its terms is
 * rounded seven times at most. Left out are low low', L L' u^2 M, and X and Y are off themselves:
 *     L'' = 3 + L + L',   A'' = 7 L'' + L L' + A + A'.
 *   degree 2, a dot product or a part of a cross product:   L =  5, A =  36
 *   degree 3, one of a difference and of a cross product:   L =  9, A = 104
 *   degree 4, one of two cross products:                    L = 13, A = 188
 * SC_BOUNDS_TWOFOLD is 256 u^2, for what is not of first order and the rounding of M as well.
 */
#include "near/differences.h"

#include <string.h>

#include "base/wide.h"

/* A contracted product and sum would spoil the error terms. GCC does not contract with -std=c99. */
#if defined(__clang__)
#  pragma STDC FP_CONTRACT OFF
#elif defined(_MSC_VER)
#  pragma fp_contract(off)
#endif

/* Rounded sum and what the rounding lost. */
static double sum_and_loss(double a, double b, double *loss)
{
    double sum = a + b;
    double b_part = sum - a;
    double a_part = sum - b_part;
    *loss = (a - a_part) + (b - b_part);
    return sum;
}

/* The 26 upper bits of a double. */
static double upper_half(double value)
{
    double scaled = 134217729.0 * value; /* 2^27 + 1 */
    return scaled - (scaled - value);
}

/* Rounded product and what the rounding lost. */
static double product_and_loss(double a, double b, double *loss)
{
    double a_high = upper_half(a), a_low = a - a_high;
    double b_high = upper_half(b), b_low = b - b_high;
    double product = a * b;
    *loss = ((a_high * b_high - product) + a_high * b_low + a_low * b_high) + a_low * b_low;
    return product;
}

/* Adds sign times a product; sign is 1 or -1. */
static void add_twofold(sc_twofold *sum, double sign, const sc_twofold *a, const sc_twofold *b)
{
    double high = sign * a->high, low = sign * a->low;
    double product_loss, sum_loss;
    double product = product_and_loss(high, b->high, &product_loss);
    sum->high = sum_and_loss(sum->high, product, &sum_loss);
    sum->low += sum_loss + (product_loss + (high * b->low + low * b->high));
    sum->magnitude += a->magnitude * b->magnitude;
}

static int next_axis(int axis)
{
    return axis == 2 ? 0 : axis + 1;
}

/*
 * Whether a coordinate is 0 or has a magnitude from 2^-200 to below 2^201. Then it is a multiple of
 * 2^-252, as are differences, which are below 2^202, and what they lost. Polynomials of degree 4
 * and all that they are made of are multiples of 2^-1008 and below 2^820, the 2^27 of upper_half
 * included: normal numbers all along.
 */
static int are_moderate(const double *p)
{
    const uint64_t low = (uint64_t)(1023 - 200) << 52;
    const uint64_t high = (uint64_t)(1023 + 201) << 52;
    int i, moderate = 1;
    for (i = 0; i < 3; i++) {
        uint64_t bits;
        memcpy(&bits, &p[i], sizeof bits);
        bits &= UINT64_MAX >> 1;
        moderate &= (bits == 0) | ((bits >= low) & (bits < high));
    }
    return moderate;
}

/*
 * Whether all differences from the first point are exact, multiples of one power of two, g, and
 * below 2^24 g. Then all differences are below 2^25 g and exact; parts of cross products, dot
 * products and their terms below 2^53 g^2 and exact. Products of higher degree and their losses are
 * multiples of g^3 or g^4 and below 2^104 of them, so that losses are below 2^51, and the six or
 * less that low is the sum of below 2^53 together: exact as well. What is added to a difference
 * here, and taken away again, leaves the multiple of g next to it.
 */
static int have_few_of(const double *const points[4])
{
    double value[3][3], largest = 0, power;
    uint64_t bits;
    int i, k, few = 1;
    for (i = 0; i < 3; i++)
        for (k = 0; k < 3; k++) {
            double loss;
            value[i][k] = sum_and_loss(points[i + 1][k], -points[0][k], &loss);
            few &= loss == 0;
            largest = fabs(value[i][k]) > largest ? fabs(value[i][k]) : largest;
        }
    if (!few) return 0;
    memcpy(&bits, &largest, sizeof bits);
    bits &= UINT64_C(0x7ff) << 52;
    memcpy(&power, &bits, sizeof power);
    power *= 0x1.8p+29; /* g is 2^-23 of the power of two that largest begins with */
    for (i = 0; i < 3; i++)
        for (k = 0; k < 3; k++) few &= (value[i][k] + power) - power == value[i][k];
    return few;
}

void sc_quad_set(sc_quad *quad, const double *const points[4])
{
    int i;
    quad->is_moderate = 1;
    for (i = 0; i < 4; i++) {
        quad->point[i] = points[i];
        quad->is_moderate &= are_moderate(points[i]);
    }
    quad->has_few_bits = quad->is_moderate && have_few_of(points);
}

void sc_quad_span(const sc_quad *quad, int from, int to, sc_span *span)
{
    int k;
    span->from = from;
    span->to = to;
    for (k = 0; k < 3; k++) {
        sc_twofold *part = &span->part[k];
        part->high = sum_and_loss(quad->point[to][k], -quad->point[from][k], &part->low);
        part->magnitude = fabs(part->high);
    }
}

void sc_quad_cross(const sc_span *u, const sc_span *v, sc_cross *cross)
{
    int k;
    cross->from[0] = u->from;
    cross->to[0] = u->to;
    cross->from[1] = v->from;
    cross->to[1] = v->to;
    for (k = 0; k < 3; k++) {
        int i = next_axis(k), j = next_axis(i);
        sc_twofold sum = {0, 0, 0};
        add_twofold(&sum, 1, &u->part[i], &v->part[j]);
        add_twofold(&sum, -1, &u->part[j], &v->part[i]);
        cross->part[k] = sum;
    }
}

/* ---- values ---- */

static sc_predicates_value normalized(double number, int exponent)
{
    sc_predicates_value value;
    int own = 0;
    value.number = frexp(number, &own);
    value.exponent = value.number == 0 ? 0 : exponent + own;
    return value;
}

/*
 * 1 if a sum of two doubles is to be believed. It is off by at most u / 2 of it then, and the
 * rounding of high + low by u.
 */
static int is_sharp(const sc_quad *quad, const sc_twofold *sum)
{
    if (!quad->is_moderate) return 0;
    return quad->has_few_bits ||
           fabs(sum->high + sum->low) >= SC_BOUNDS_TWOFOLD * 0x1p+54 * sum->magnitude;
}

static sc_wide_factor factor_of_span(const sc_span *span, int axis, int turned)
{
    sc_wide_factor factor = {0, 0, 0, 0, 0};
    factor.axis = axis;
    factor.from = turned ? span->to : span->from;
    factor.to = turned ? span->from : span->to;
    return factor;
}

static sc_wide_factor factor_of_cross(const sc_cross *cross, int axis)
{
    sc_wide_factor factor;
    factor.axis = axis;
    factor.from = cross->from[0];
    factor.to = cross->to[0];
    factor.from2 = cross->from[1];
    factor.to2 = cross->to[1];
    return factor;
}

/* The value of a sum: as it is, or in integers. */
static sc_predicates_value value_in_integers(const sc_quad *quad,
                                             const sc_wide_factor (*factors)[2], int count)
{
    int exponent;
    double number = sc_wide_products_value(quad->point, factors, count, &exponent);
    return normalized(number, exponent);
}

sc_predicates_value sc_quad_dot(const sc_quad *quad, const sc_span *u, const sc_span *v)
{
    sc_twofold sum = {0, 0, 0};
    sc_wide_factor factors[3][2];
    int k;
    for (k = 0; k < 3; k++) add_twofold(&sum, 1, &u->part[k], &v->part[k]);
    if (is_sharp(quad, &sum)) return normalized(sum.high + sum.low, 0);
    for (k = 0; k < 3; k++) {
        factors[k][0] = factor_of_span(u, k, 0);
        factors[k][1] = factor_of_span(v, k, 0);
    }
    return value_in_integers(quad, (const sc_wide_factor(*)[2])factors, 3);
}

sc_predicates_value sc_quad_part(const sc_quad *quad, const sc_cross *n, int axis)
{
    const sc_twofold *part = &n->part[axis];
    sc_wide_factor factors[2][2] = {{{0, 0, 0, 0, 0}}};
    int k, i = next_axis(axis), j = next_axis(i);
    if (is_sharp(quad, part)) return normalized(part->high + part->low, 0);
    for (k = 0; k < 2; k++) {
        factors[k][0].axis = k ? j : i;
        factors[k][0].from = k ? n->to[0] : n->from[0];
        factors[k][0].to = k ? n->from[0] : n->to[0];
        factors[k][1].axis = k ? i : j;
        factors[k][1].from = n->from[1];
        factors[k][1].to = n->to[1];
    }
    return value_in_integers(quad, (const sc_wide_factor(*)[2])factors, 2);
}

sc_predicates_value sc_quad_volume(const sc_quad *quad, const sc_span *w, const sc_cross *n)
{
    sc_twofold sum = {0, 0, 0};
    sc_wide_factor factors[3][2];
    int k;
    for (k = 0; k < 3; k++) add_twofold(&sum, 1, &w->part[k], &n->part[k]);
    if (is_sharp(quad, &sum)) return normalized(sum.high + sum.low, 0);
    for (k = 0; k < 3; k++) {
        factors[k][0] = factor_of_span(w, k, 0);
        factors[k][1] = factor_of_cross(n, k);
    }
    return value_in_integers(quad, (const sc_wide_factor(*)[2])factors, 3);
}

sc_predicates_value sc_quad_cross_dot(const sc_quad *quad, const sc_cross *m, const sc_cross *n)
{
    sc_twofold sum = {0, 0, 0};
    sc_wide_factor factors[3][2];
    int k;
    for (k = 0; k < 3; k++) add_twofold(&sum, 1, &m->part[k], &n->part[k]);
    if (is_sharp(quad, &sum)) return normalized(sum.high + sum.low, 0);
    for (k = 0; k < 3; k++) {
        factors[k][0] = factor_of_cross(m, k);
        factors[k][1] = factor_of_cross(n, k);
    }
    return value_in_integers(quad, (const sc_wide_factor(*)[2])factors, 3);
}

sc_predicates_value sc_quad_turned(const sc_quad *quad, const sc_span *w, const sc_cross *n,
                                   int axis)
{
    int i = next_axis(axis), j = next_axis(i);
    sc_twofold sum = {0, 0, 0};
    sc_wide_factor factors[2][2];
    add_twofold(&sum, 1, &w->part[i], &n->part[j]);
    add_twofold(&sum, -1, &w->part[j], &n->part[i]);
    if (is_sharp(quad, &sum)) return normalized(sum.high + sum.low, 0);
    factors[0][0] = factor_of_span(w, i, 0);
    factors[0][1] = factor_of_cross(n, j);
    factors[1][0] = factor_of_span(w, j, 1);
    factors[1][1] = factor_of_cross(n, i);
    return value_in_integers(quad, (const sc_wide_factor(*)[2])factors, 2);
}

/* ---- signs ---- */

static int sign_of(double number)
{
    return (number > 0) - (number < 0);
}

/* By the high parts, which are what plain arithmetic gives, if they are large enough. */
int sc_quad_dot_sign(const sc_quad *quad, const sc_span *u, const sc_span *v)
{
    double sum = 0, magnitude = 0;
    int k;
    for (k = 0; k < 3; k++) {
        double product = u->part[k].high * v->part[k].high;
        sum += product;
        magnitude += fabs(product);
    }
    if (quad->is_moderate && fabs(sum) > SC_BOUNDS_NEAR_DOT * magnitude) return sign_of(sum);
    return sign_of(sc_quad_dot(quad, u, v).number);
}

int sc_quad_cross_dot_sign(const sc_quad *quad, const sc_span *u, const sc_span *v,
                           const sc_cross *n)
{
    double sum = 0, magnitude = 0;
    sc_cross m;
    int k;
    for (k = 0; k < 3; k++) {
        int i = next_axis(k), j = next_axis(i);
        double left = u->part[i].high * v->part[j].high;
        double right = u->part[j].high * v->part[i].high;
        sum += (left - right) * n->part[k].high;
        magnitude += (fabs(left) + fabs(right)) * n->part[k].magnitude;
    }
    if (quad->is_moderate && fabs(sum) > SC_BOUNDS_NEAR_CROSS * magnitude) return sign_of(sum);
    sc_quad_cross(u, v, &m);
    return sign_of(sc_quad_cross_dot(quad, &m, n).number);
}

int sc_quad_is_zero(const sc_quad *quad, const sc_cross *n)
{
    int k;
    for (k = 0; k < 3; k++) {
        const sc_twofold *part = &n->part[k];
        if (quad->is_moderate && fabs(part->high + part->low) > SC_BOUNDS_TWOFOLD * part->magnitude)
            return 0;
    }
    for (k = 0; k < 3; k++)
        if (sc_quad_part(quad, n, k).number != 0) return 0;
    return 1;
}
