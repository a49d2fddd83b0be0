/*
 * Sine and cosine of the same bits on every machine. Each system's mathematical library rounds its
 * own way, and shapes for tests made with them would differ in last bits, and so in pairs.
 *
 * SPDX-License-Identifier: MIT
 *
 * The angle is brought to [-pi/4, pi/4] by multiples of pi/2, then a Taylor series: within about
 * 1e-15 for angles of a few turns, and something from -1 to 1 for any, which is all that tests
 * need.
 */
#include <math.h>

/* The sine of a small angle, or its cosine: x^first / first! - x^(first + 2) / (first + 2)! ... */
static double series(double x, int first)
{
    double term = first ? x : 1, sum = term;
    for (int i = first + 1; i < first + 19; i += 2) {
        term *= -x * x / (i * (i + 1));
        sum += term;
    }
    return sum;
}

/* The sine of an angle and so many right angles more. */
static double turned(double x, int more)
{
    const double right_angle = 1.57079632679489661923;
    x = fmod(x, 4 * right_angle); /* exact */
    const double turns = floor(x / right_angle + 0.5);
    const int quarter = ((int)turns + more + 8) % 4;
    const double y = series(x - turns * right_angle, quarter % 2 == 0);
    return quarter < 2 ? y : -y;
}

double sin(double x)
{
    return turned(x, 0);
}

double cos(double x)
{
    return turned(x, 1);
}
