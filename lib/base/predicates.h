/*
 * Orientation signs of two- and three-dimensional points, exact for all finite doubles.
 *
 * SPDX-License-Identifier: MIT
 *
 * Each sign is sought in three stages:
 *   1. a filter, in this header: the determinant in plain arithmetic, believed if it is larger than
 *      a bound of its error. 1 to 5 ns; decides nearly always when the sign is not zero;
 *   2. expansions (predicates.c), when no product can overflow or underflow: 0.1 to 1 us;
 *   3. big integers (wide.c), for everything else: 0.5 us, for widely different exponents up to
 *      30 us.
 * Stages 2 and 3 always decide. *fallbacks, which must not be NULL, counts the signs that needed
 * them; it is not reset.
 *
 * Signs of points that are not finite mean nothing, but cause no harm.
 *
 * What is asked of the floating-point unit: doubles evaluated as doubles, rounding to nearest. The
 * compiler may contract products and sums here, not in predicates.c. Flushing subnormal numbers to
 * zero is harmless while no coordinate is larger than 2^56.
 */
#ifndef SC_BASE_PREDICATES_H
#define SC_BASE_PREDICATES_H

#include <float.h>
#include <math.h>
#include <stdint.h>

#include "base/bounds.h"

#ifdef __FAST_MATH__
#  error "exact signs need strict floating-point arithmetic: compile without -ffast-math"
#endif
#if !defined(FLT_EVAL_METHOD) || FLT_EVAL_METHOD < 0 || FLT_EVAL_METHOD == 2
#  error "exact signs need doubles evaluated as doubles: on 32-bit x86 use -msse2 -mfpmath=sse"
#endif

/* Stages 2 and 3; arguments and results as below. */
int sc_predicates_orient2d_exact(const double a[2], const double b[2], const double c[2]);
int sc_predicates_orient3d_exact(const double a[3], const double b[3], const double c[3],
                                 const double d[3]);

/*
 * The sign of (b - a) x (c - a), x_1 y_2 - x_2 y_1: 1 if a, b, c run counter-clockwise, -1 if
 * clockwise, 0 if they are on a line.
 */
static inline int sc_predicates_orient2d(const double a[2], const double b[2], const double c[2],
                                         uint64_t *fallbacks)
{
    double left = (b[0] - a[0]) * (c[1] - a[1]);
    double right = (b[1] - a[1]) * (c[0] - a[0]);
    double determinant = left - right;
    double magnitude = fabs(left) + fabs(right);
    double bound = SC_BOUNDS_SIGN_2D * magnitude + SC_BOUNDS_SIGN_TINY;
    if (determinant > bound) return 1;
    if (determinant < -bound) return -1;
    ++*fallbacks;
    return sc_predicates_orient2d_exact(a, b, c);
}

/* The plane through a, b and c, made ready for the signs of several points. Keeps the pointers. */
typedef struct sc_predicates_plane {
    const double *a, *b, *c;
    double normal[3];    /* (b - a) x (c - a), rounded */
    double magnitude[3]; /* the same, with the absolute values of all products added */
} sc_predicates_plane;

static inline sc_predicates_plane sc_predicates_make_plane(const double a[3], const double b[3],
                                                           const double c[3])
{
    sc_predicates_plane plane;
    double ux = b[0] - a[0], uy = b[1] - a[1], uz = b[2] - a[2];
    double vx = c[0] - a[0], vy = c[1] - a[1], vz = c[2] - a[2];
    double yz = uy * vz, zy = uz * vy;
    double zx = uz * vx, xz = ux * vz;
    double xy = ux * vy, yx = uy * vx;
    plane.a = a;
    plane.b = b;
    plane.c = c;
    plane.normal[0] = yz - zy;
    plane.normal[1] = zx - xz;
    plane.normal[2] = xy - yx;
    plane.magnitude[0] = fabs(yz) + fabs(zy);
    plane.magnitude[1] = fabs(zx) + fabs(xz);
    plane.magnitude[2] = fabs(xy) + fabs(yx);
    return plane;
}

/*
 * The sign of ((b - a) x (c - a)) . (d - a): 1 if d is on the side of the plane to which the normal
 * (b - a) x (c - a) points, from where a, b, c run counter-clockwise; -1 on the other side; 0 if
 * the four points are in a plane. For (0,0,0), (1,0,0), (0,1,0), (0,0,1) it is 1.
 */
static inline int sc_predicates_side_of_plane(const sc_predicates_plane *plane, const double d[3],
                                              uint64_t *fallbacks)
{
    double x = d[0] - plane->a[0], y = d[1] - plane->a[1], z = d[2] - plane->a[2];
    double determinant = x * plane->normal[0] + y * plane->normal[1] + z * plane->normal[2];
    double magnitude = fabs(x) * plane->magnitude[0] + fabs(y) * plane->magnitude[1] +
                       fabs(z) * plane->magnitude[2];
    double tiny = SC_BOUNDS_SIGN_TINY * (1.0 + (fabs(x) + fabs(y) + fabs(z)));
    double bound = SC_BOUNDS_SIGN_3D * magnitude + tiny;
    if (determinant > bound) return 1;
    if (determinant < -bound) return -1;
    ++*fallbacks;
    return sc_predicates_orient3d_exact(plane->a, plane->b, plane->c, d);
}

/* The same sign from four points. An odd permutation of the points changes it, an even one not. */
static inline int sc_predicates_orient3d(const double a[3], const double b[3], const double c[3],
                                         const double d[3], uint64_t *fallbacks)
{
    sc_predicates_plane plane = sc_predicates_make_plane(a, b, c);
    return sc_predicates_side_of_plane(&plane, d, fallbacks);
}

/*
 * The determinants whose signs these are: number times 2^exponent, to within 2^-51 of the true
 * value, however small it is. A value that is 0 is so exactly. By stages 2 and 3.
 */
typedef struct sc_predicates_value {
    double number;
    int exponent;
} sc_predicates_value;

sc_predicates_value sc_predicates_orient2d_value(const double a[2], const double b[2],
                                                 const double c[2]);
sc_predicates_value sc_predicates_orient3d_value(const double a[3], const double b[3],
                                                 const double c[3], const double d[3]);

#endif /* SC_BASE_PREDICATES_H */
