/*
 * The oracle of proximity: see near_oracle.h.
 *
 * SPDX-License-Identifier: MIT
 *
 * Coordinates and distance are multiplied by a power of two that makes integers of all. Each region
 * of the nearest points has a candidate, a fraction: the square of the distance there. The least of
 * those that exist is the square of the distance.
 */
#include "near_oracle.h"

#include <gmp.h>
#include <limits.h>
#include <math.h>

/* A squared distance, with a denominator above 0; none yet if that is 0. */
typedef struct fraction {
    mpz_t above, below;
} fraction;

static mpz_t x[4][3], limit, a, b, c, p, q, s, t, whole, next, vector[3], e[3], f[3], w[3];
static fraction least;
static int scale; /* coordinates were multiplied by 2^-scale */

static void start(void)
{
    static int is_ready;
    mpz_t *const all[] = {&limit, &a, &b, &c, &p, &q, &s, &t, &whole, &next};
    if (is_ready) return;
    is_ready = 1;
    for (unsigned i = 0; i < sizeof(all) / sizeof(all[0]); ++i) mpz_init(*all[i]);
    for (int k = 0; k < 3; ++k) {
        for (int i = 0; i < 4; ++i) mpz_init(x[i][k]);
        mpz_init(vector[k]);
        mpz_init(e[k]);
        mpz_init(f[k]);
        mpz_init(w[k]);
    }
    mpz_init(least.above);
    mpz_init(least.below);
}

static int lowest_exponent(double value)
{
    int exponent;
    if (value == 0) return INT_MAX;
    (void)frexp(value, &exponent);
    return exponent - 53;
}

/* value 2^-scale, a multiple of which value is: 53 bits, and as many zeros. */
static void set(mpz_t to, double value)
{
    int exponent;
    double fraction_part = frexp(value, &exponent);
    mpz_set_d(to, ldexp(fraction_part, 53));
    if (value == 0) return;
    mpz_mul_2exp(to, to, (mp_bitcnt_t)(exponent - 53 - scale));
}

static void read(const double point[4][3], double d)
{
    start();
    scale = lowest_exponent(d);
    for (int i = 0; i < 4; ++i) {
        for (int k = 0; k < 3; ++k) {
            int exponent = lowest_exponent(point[i][k]);
            if (exponent < scale) scale = exponent;
        }
    }
    if (scale == INT_MAX) scale = 0;
    for (int i = 0; i < 4; ++i) {
        for (int k = 0; k < 3; ++k) set(x[i][k], point[i][k]);
    }
    set(limit, d);
    mpz_mul(limit, limit, limit);
    mpz_set_ui(least.below, 0);
}

static void difference(mpz_t to[3], mpz_t from[3], mpz_t less[3])
{
    for (int k = 0; k < 3; ++k) mpz_sub(to[k], from[k], less[k]);
}

static void product(mpz_t to, mpz_t left[3], mpz_t right[3])
{
    mpz_mul(to, left[0], right[0]);
    mpz_addmul(to, left[1], right[1]);
    mpz_addmul(to, left[2], right[2]);
}

/* Takes above / below if it is less than what there is; below > 0. */
static void offer(mpz_t above, mpz_t below)
{
    int is_less = mpz_sgn(least.below) == 0;
    if (!is_less) {
        mpz_mul(whole, above, least.below);
        mpz_mul(next, least.above, below);
        is_less = mpz_cmp(whole, next) < 0;
    }
    if (!is_less) return;
    mpz_set(least.above, above);
    mpz_set(least.below, below);
}

/* The square of |vector| over that of `below`. */
static void offer_vector(mpz_t below)
{
    product(s, vector, vector);
    mpz_mul(t, below, below);
    offer(s, t);
}

/* A point and a segment: at the foot where that is in the segment, else at the end next to it. */
static void offer_segment(mpz_t point[3], mpz_t from[3], mpz_t to[3])
{
    difference(e, to, from);
    difference(w, point, from);
    product(a, e, e);
    product(p, e, w);
    if (mpz_sgn(p) <= 0) {
        mpz_set_ui(a, 1);
        mpz_set_ui(p, 0);
    } else if (mpz_cmp(p, a) >= 0) {
        mpz_set_ui(a, 1);
        mpz_set_ui(p, 1);
    }
    for (int k = 0; k < 3; ++k) {
        mpz_mul(vector[k], w[k], a);
        mpz_submul(vector[k], e[k], p);
    }
    offer_vector(a);
}

/* Solves the equations for the foot p e + q f of w, or the nearest points of two lines: Cramer's
   rule with the matrix (a b; b c), whose determinant goes to c. */
static void solve(void)
{
    product(a, e, e);
    product(b, e, f);
    product(c, f, f);
    product(s, e, w);
    product(t, f, w);
    mpz_mul(p, c, s);
    mpz_submul(p, b, t);
    mpz_mul(q, a, t);
    mpz_submul(q, b, s);
    mpz_mul(c, c, a);
    mpz_submul(c, b, b);
}

static void offer_solution(void)
{
    for (int k = 0; k < 3; ++k) {
        mpz_mul(vector[k], w[k], c);
        mpz_submul(vector[k], e[k], p);
        mpz_submul(vector[k], f[k], q);
    }
    offer_vector(c);
}

static void find_vertex_face(const double point[4][3], double d)
{
    read(point, d);
    for (int i = 1; i < 4; ++i) offer_segment(x[0], x[i], x[i % 3 + 1]);
    difference(e, x[2], x[1]);
    difference(f, x[3], x[1]);
    difference(w, x[0], x[1]);
    solve();
    mpz_add(next, p, q);
    if (mpz_sgn(c) > 0 && mpz_sgn(p) >= 0 && mpz_sgn(q) >= 0 && mpz_cmp(next, c) <= 0)
        offer_solution();
}

static void find_edge_edge(const double point[4][3], double d)
{
    read(point, d);
    for (int i = 0; i < 2; ++i) {
        offer_segment(x[i], x[2], x[3]);
        offer_segment(x[2 + i], x[0], x[1]);
    }
    /* x_2 - x_0 = p e + q f, as near as can be, where f runs backwards */
    difference(e, x[1], x[0]);
    difference(f, x[2], x[3]);
    difference(w, x[2], x[0]);
    solve();
    if (mpz_sgn(c) > 0 && mpz_sgn(p) >= 0 && mpz_sgn(q) >= 0 && mpz_cmp(p, c) <= 0 &&
        mpz_cmp(q, c) <= 0)
        offer_solution();
}

static int is_within(void)
{
    mpz_mul(whole, limit, least.below);
    return mpz_cmp(least.above, whole) <= 0;
}

/* The integer part of the quotient times a power of two of which so many bits remain that the root
   has 55. */
static double root(void)
{
    long shift, bits;
    if (mpz_sgn(least.above) == 0) return 0;
    bits = (long)mpz_sizeinbase(least.above, 2) - (long)mpz_sizeinbase(least.below, 2);
    shift = 128 - bits;
    shift += shift & 1;
    if (shift > 0)
        mpz_mul_2exp(least.above, least.above, (mp_bitcnt_t)shift);
    else
        mpz_mul_2exp(least.below, least.below, (mp_bitcnt_t)-shift);
    mpz_tdiv_q(whole, least.above, least.below);
    mpz_sqrt(whole, whole);
    return ldexp(mpz_get_d(whole), scale - (int)(shift / 2));
}

int near_oracle_vertex_face(const double point[4][3], double d)
{
    find_vertex_face(point, d);
    return is_within();
}

int near_oracle_edge_edge(const double point[4][3], double d)
{
    find_edge_edge(point, d);
    return is_within();
}

double near_oracle_distance_vertex_face(const double point[4][3])
{
    find_vertex_face(point, 0);
    return root();
}

double near_oracle_distance_edge_edge(const double point[4][3])
{
    find_edge_edge(point, 0);
    return root();
}
