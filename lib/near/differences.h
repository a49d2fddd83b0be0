/*
 * Four points, the differences between them, and polynomials of these: dot and cross products and
 * what is made of two of them. Signs are exact, and values right to the last bit or nearly so, for
 * all finite doubles.
 *
 * SPDX-License-Identifier: MIT
 *
 * Each polynomial is sought in two stages:
 *   1. as the sum of two doubles (sc_twofold), 10 to 50 ns. It is believed if it is much larger
 *      than what it can be off by, or if differences have so few bits that it is exact;
 *   2. in integers (base/wide.h), 0.5 to 1 us, for widely different exponents more.
 *
 * Points that are not finite give results that mean nothing, but cause no harm.
 */
#ifndef SC_NEAR_DIFFERENCES_H
#define SC_NEAR_DIFFERENCES_H

#include "base/predicates.h"

/* high + low is off by at most SC_BOUNDS_TWOFOLD times magnitude: the sum of the absolute values of
   all products that it is made of. See differences.c. */
typedef struct sc_twofold {
    double high, low, magnitude;
} sc_twofold;

typedef struct sc_quad {
    const double *point[4];
    int is_moderate;  /* no operation on two doubles can overflow or underflow */
    int has_few_bits; /* and they are all exact */
} sc_quad;

/* A difference of two points: to - from. */
typedef struct sc_span {
    int from, to;
    sc_twofold part[3];
} sc_span;

/* A cross product of two differences. */
typedef struct sc_cross {
    int from[2], to[2];
    sc_twofold part[3];
} sc_cross;

/* Keeps the pointers. */
void sc_quad_set(sc_quad *quad, const double *const points[4]);

void sc_quad_span(const sc_quad *quad, int from, int to, sc_span *span);
void sc_quad_cross(const sc_span *u, const sc_span *v, sc_cross *cross); /* u x v */

/*
 * Values: number times 2^exponent, number being 0 or from 1/2 to 1 in magnitude. Relatively, each
 * is off by at most 1.51 u, u = 2^-53; 0 is exact.
 */
sc_predicates_value sc_quad_dot(const sc_quad *quad, const sc_span *u, const sc_span *v);
sc_predicates_value sc_quad_part(const sc_quad *quad, const sc_cross *n, int axis);
sc_predicates_value sc_quad_volume(const sc_quad *quad, const sc_span *w, const sc_cross *n);
sc_predicates_value sc_quad_cross_dot(const sc_quad *quad, const sc_cross *m, const sc_cross *n);
/* One coordinate of w x n. */
sc_predicates_value sc_quad_turned(const sc_quad *quad, const sc_span *w, const sc_cross *n,
                                   int axis);

/* Signs: -1, 0 or 1, by plain arithmetic if that is certain. */
int sc_quad_dot_sign(const sc_quad *quad, const sc_span *u, const sc_span *v);
/* Of (u x v) . n. */
int sc_quad_cross_dot_sign(const sc_quad *quad, const sc_span *u, const sc_span *v,
                           const sc_cross *n);
/* Whether a cross product is 0. */
int sc_quad_is_zero(const sc_quad *quad, const sc_cross *n);

#endif
