/*
 * Orientation signs by big integers: the last stage of predicates.h, right for all finite doubles.
 *
 * SPDX-License-Identifier: MIT
 *
 * Signs as in predicates.h. The cost grows with the square of the span of the exponents: about
 * 0.5 us for coordinates of similar size, up to 30 us for the whole range of doubles. Takes up to
 * 12 KB of stack. Signs use no floating-point arithmetic at all.
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

/*
 * Sums of products of differences of four points, of degree 2 to 4: each product has two factors,
 * and each factor is a coordinate of a difference or of a cross product of two differences. All
 * products have as many differences.
 */
typedef struct sc_wide_factor {
    int axis;
    int from, to;   /* points: the difference to - from */
    int from2, to2; /* the second one of a cross product; equal: there is none */
} sc_wide_factor;

/* The sum of count products, 1 to 3, of two factors each: the number returned times 2^*exponent, to
   within 2^-53 + 2^-62 of it, with a magnitude from 2^63 to 2^64 or exactly 0. */
double sc_wide_products_value(const double *const points[4], const sc_wide_factor (*factors)[2],
                              int count, int *exponent);

/*
 * A minor of the matrix whose rows are 1 and the coordinates of points, 1, x, y, z: of count rows,
 * 1 to 4, the column of ones, and count - 1 columns of coordinates, ascending.
 */
typedef struct sc_wide_minor {
    int count;
    const double *rows[4];
    int columns[3]; /* 0, 1 or 2 */
} sc_wide_minor;

/* The sum of count products of two minors each, times 1 or -1: as above. All products have as many
   rows. */
double sc_wide_minors_value(const sc_wide_minor (*factors)[2], const int *signs, int count,
                            int *exponent);

#endif /* SC_BASE_WIDE_H */
