/*
 * Sine and cosine that are the same everywhere, as those of C libraries are not: sums and products
 * only. Test meshes compiled with -include of this file are the same meshes on every system, so
 * that pairs found on two systems can be compared. Good to some digits, which is all that a mesh
 * asks for.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef SC_TESTS_SAME_MATH_H
#define SC_TESTS_SAME_MATH_H

#include <math.h>

static inline double same_sin(double x)
{
    const double pi = 3.14159265358979323846;
    double turns = x / (2 * pi), term, sum, square;
    int i;
    turns -= floor(turns); /* floor is exact everywhere */
    if (turns > 0.5) turns -= 1;
    x = 2 * pi * turns;
    square = x * x;
    term = sum = x;
    for (i = 2; i < 30; i += 2) {
        term *= -square / (i * (i + 1));
        sum += term;
    }
    return sum;
}

static inline double same_cos(double x)
{
    return same_sin(x + 1.57079632679489661923);
}

#define sin same_sin
#define cos same_cos

#endif
