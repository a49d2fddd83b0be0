/*
 * Bounds of exact signs. See rounding_search.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "rounding_signs.h"

#include <float.h>
#include <gmp.h>
#include <math.h>

#include "base/bounds.h"
#include "base/predicates.h"
#include "rounding_sums.h"

enum { N = ROUNDING_LANES };

static const double U = 0x1p-53;

static double size_of(const double a[3])
{
    return fabs(a[0]) + fabs(a[1]) + fabs(a[2]);
}

/* Four points; three of them, and what the last is seen along, scaled so that normals underflow. */
void rounding_space_tiny(const double (*x)[N], double share[N])
{
    const int s = 535; /* binary digits that a, b and c are made smaller by */
    for (int i = 0; i < N; ++i) {
        double p[4][3], d[3], determinant, magnitude, tiny, error;
        twice e[3][3];
        for (int k = 0; k < 12; ++k) {
            double t = k < 9 ? ldexp(x[k][i], -s) : x[k][i];
            p[k / 3][k % 3] = t;
        }
        sc_predicates_plane plane = sc_predicates_make_plane(p[0], p[1], p[2]);
        for (int k = 0; k < 3; ++k) d[k] = p[3][k] - p[0][k];
        determinant = d[0] * plane.normal[0] + d[1] * plane.normal[1] + d[2] * plane.normal[2];
        tiny = SC_BOUNDS_SIGN_TINY * (1.0 + size_of(d));
        for (int k = 0; k < 3; ++k) {
            double from = ldexp(p[0][k], s);
            e[0][k] = difference(ldexp(p[1][k], s), from);
            e[1][k] = difference(ldexp(p[2][k], s), from);
            e[2][k] = difference(p[3][k], p[0][k]);
        }
        magnitude = 0;
        for (int k = 0; k < 3; ++k) {
            int m = (k + 1) % 3, n = (k + 2) % 3;
            magnitude += fabs(e[2][k].high) *
                         (fabs(e[0][m].high * e[1][n].high) + fabs(e[0][n].high * e[1][m].high));
        }
        error = off_by(ldexp(determinant, 2 * s), determinant_of(e[0], e[1], e[2]));
        error = ldexp(error - 9 * U * magnitude, -2 * s + 1000); /* more: from underflow */
        share[i] = error > 0 ? error / ldexp(tiny, 1000) : 0;
    }
}

/* The sum of two doubles of base/predicates.c, of what sign_of_two makes. Points are made whole
   numbers of up to 2^110, for GMP. */
void rounding_two_doubles(const double (*x)[N], double share[N])
{
    static mpz_t at[4][3], e[3][3], m, t, sum;
    static int is_ready;
    if (!is_ready) {
        for (int k = 0; k < 12; ++k) mpz_init(at[k / 3][k % 3]);
        for (int k = 0; k < 9; ++k) mpz_init(e[k / 3][k % 3]);
        mpz_inits(m, t, sum, NULL);
        is_ready = 1;
    }
    for (int i = 0; i < N; ++i) {
        double p[4][3], value[3][3], tail[3][3], first = 0, second = 0, magnitude = 0;
        for (int k = 0; k < 12; ++k) {
            p[k / 3][k % 3] = nearbyint(x[k][i] * 0x1p+110);
            mpz_set_d(at[k / 3][k % 3], p[k / 3][k % 3]);
        }
        for (int k = 0; k < 9; ++k) {
            twice d = difference(p[1 + k / 3][k % 3], p[0][k % 3]);
            value[k / 3][k % 3] = d.high;
            tail[k / 3][k % 3] = d.low;
            mpz_sub(e[k / 3][k % 3], at[1 + k / 3][k % 3], at[0][k % 3]);
        }
        mpz_set_ui(sum, 0);
        for (int k = 0; k < 3; ++k) { /* as there */
            int a = (k + 1) % 3, b = (k + 2) % 3;
            const double *u = value[0], *v = value[1], *w = value[2];
            double left = u[a] * v[b], left_error = fma(u[a], v[b], -left);
            double right = u[b] * v[a], right_error = fma(u[b], v[a], -right);
            twice high = sum_of(left, -right), all;
            double low = high.low + (left_error - right_error);
            double last = high.high * w[k], last_error = fma(high.high, w[k], -last);
            all = sum_of(first, last);
            first = all.high;
            second += all.low + (last_error + low * w[k]);
            magnitude += (fabs(left) + fabs(right)) * fabs(w[k]);
            second += high.high * tail[2][k] + ((tail[0][a] * v[b] + u[a] * tail[1][b]) -
                                                (tail[0][b] * v[a] + u[b] * tail[1][a])) *
                                                   w[k];
            mpz_mul(m, e[0][a], e[1][b]);
            mpz_mul(t, e[0][b], e[1][a]);
            mpz_sub(m, m, t);
            mpz_mul(m, m, e[2][k]);
            mpz_add(sum, sum, m);
        }
        mpz_set_d(t, first);
        mpz_sub(sum, sum, t);
        mpz_set_d(t, second);
        mpz_sub(sum, sum, t);
        share[i] = magnitude > 0 ? fabs(mpz_get_d(sum)) / (0x1p-98 * magnitude) : 0;
    }
}

/* Determinants in plain arithmetic: how much of 2^53, to which whole numbers are exact. */
void rounding_few_bits(const double (*x)[N], double share[N])
{
    for (int i = 0; i < N; ++i) {
        double most = 0, sum = 0;
        for (int k = 0; k < 3; ++k) {
            int a = (k + 1) % 3, b = (k + 2) % 3;
            double minor = x[a][i] * x[3 + b][i] - x[b][i] * x[3 + a][i];
            sum += minor * x[6 + k][i];
            most = fmax(most, fmax(fabs(minor * x[6 + k][i]), fabs(sum)));
        }
        share[i] = most / 0x1p+53;
    }
}

/* A component of a normal that is truly 0 is what query/primitives.c asks about; this looks at all.
   What a subtraction loses, u of the difference, is not an error of that kind. */
void rounding_area(const double (*x)[N], double share[N])
{
    for (int i = 0; i < N; ++i) {
        double p[3][3], most = 0;
        for (int k = 0; k < 9; ++k) p[k / 3][k % 3] = x[k][i];
        sc_predicates_plane plane = sc_predicates_make_plane(p[0], p[1], p[2]);
        for (int k = 0; k < 3; ++k) {
            int a = (k + 1) % 3, b = (k + 2) % 3;
            twice exact = minor_of(difference(p[1][a], p[0][a]), difference(p[1][b], p[0][b]),
                                   difference(p[2][a], p[0][a]), difference(p[2][b], p[0][b]));
            double bound = SC_BOUNDS_SIGN_2D * plane.magnitude[k] + SC_BOUNDS_SIGN_TINY;
            double off = off_by(plane.normal[k], exact) - U * fabs(plane.normal[k]);
            most = fmax(most, off / bound);
        }
        share[i] = most;
    }
}
