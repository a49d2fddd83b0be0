/*
 * Sums of two doubles, about 104 bits: the exact values that rounding in doubles is held against.
 * For rounding_bounds.c and rounding_signs.c.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef SC_TESTS_ROUNDING_SUMS_H
#define SC_TESTS_ROUNDING_SUMS_H

#include <math.h>

/* high + low; low is at most half a unit in the last place of high. */
typedef struct twice {
    double high, low;
} twice;

static inline twice sum_of(double a, double b)
{
    twice r;
    double part;
    r.high = a + b;
    part = r.high - a;
    r.low = (a - (r.high - part)) + (b - part);
    return r;
}

static inline twice add(twice a, twice b)
{
    twice high = sum_of(a.high, b.high), low = sum_of(a.low, b.low);
    high = sum_of(high.high, high.low + low.high);
    return sum_of(high.high, high.low + low.low);
}

static inline twice minus(twice a)
{
    a.high = -a.high;
    a.low = -a.low;
    return a;
}

static inline twice product(twice a, twice b)
{
    double high = a.high * b.high, low = fma(a.high, b.high, -high);
    return sum_of(high, low + (a.high * b.low + a.low * b.high));
}

static inline twice difference(double a, double b)
{
    return sum_of(a, -b);
}

/* a0 b1 - a1 b0 */
static inline twice minor_of(twice a0, twice a1, twice b0, twice b1)
{
    return add(product(a0, b1), minus(product(a1, b0)));
}

static inline twice determinant_of(const twice a[3], const twice b[3], const twice c[3])
{
    twice sum = {0, 0};
    for (int k = 0; k < 3; ++k) {
        int i = (k + 1) % 3, j = (k + 2) % 3;
        sum = add(sum, product(minor_of(a[i], a[j], b[i], b[j]), c[k]));
    }
    return sum;
}

/* |computed - exact| */
static inline double off_by(double computed, twice exact)
{
    return fabs((computed - exact.high) - exact.low);
}

#endif
