/*
 * Orientation signs by big integers: the last stage of predicates.h, right for all finite doubles.
 *
 * SPDX-License-Identifier: MIT
 *
 * Signs as in predicates.h. The cost grows with the square of the span of the exponents: about
 * 0.5 us for coordinates of similar size, up to 30 us for the whole range of doubles. Takes about
 * 8 KB of stack. Signs use no floating-point arithmetic at all.
 */
#ifndef SC_BASE_WIDE_H
#define SC_BASE_WIDE_H

int sc_wide_orient2d(const double a[2], const double b[2], const double c[2]);
int sc_wide_orient3d(const double a[3], const double b[3], const double c[3], const double d[3]);

/* The determinants themselves: the number returned times 2^*exponent, to within 2^-51 of it. */
double sc_wide_orient2d_value(const double a[2], const double b[2], const double c[2],
                              int *exponent);
double sc_wide_orient3d_value(const double a[3], const double b[3], const double c[3],
                              const double d[3], int *exponent);

#endif /* SC_BASE_WIDE_H */
