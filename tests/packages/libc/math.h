/* All that lib/ takes from <math.h>, for compilers of systems whose headers are not here.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef TESTS_LIBC_MATH_H
#define TESTS_LIBC_MATH_H

double fabs(double), fmin(double, double), fmax(double, double), sqrt(double), floor(double);
double atan2(double, double), ceil(double), frexp(double, int *), ldexp(double, int);
float fabsf(float), fminf(float, float), fmaxf(float, float), sqrtf(float), floorf(float), ceilf(float);
#define INFINITY ((float)(1e300 * 1e300))
#define NAN (-(float)(INFINITY * 0.0F))
#define HUGE_VAL ((double)INFINITY)
#define HUGE_VALF INFINITY
#define isfinite(x) ((x) - (x) == 0)

#endif /* TESTS_LIBC_MATH_H */
