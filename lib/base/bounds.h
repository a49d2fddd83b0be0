/*
 * Error bounds by name: what computed numbers are off by.
 *
 * SPDX-License-Identifier: MIT
 *
 * Whatever skips work widens by a bound, so that nothing is lost to rounding. Here are the numbers
 * that bounds are made of, with their derivations. Where a bound is a formula of several of them,
 * it is derived at the line, in these names. lib/GUARANTEE.md lists all bounds, with the tests that
 * fail when one is left out or halved.
 *
 * An operation returns the true value times 1 + e, |e| <= u, half a unit in the last place of 1. A
 * sum or difference does so even if it is subnormal, being then exact; a product that underflows is
 * off by a little more, which FLT_MIN or a tiny term covers.
 */
#ifndef SC_BASE_BOUNDS_H
#define SC_BASE_BOUNDS_H

/* u of doubles, 2^-53, and of floats, 2^-24, which formulas call v. */
#define SC_BOUNDS_U 0x1p-53
#define SC_BOUNDS_V 5.9604644775390625e-8f

/*
 * Signs of determinants in doubles (base/predicates.h). Multiply one out into monomials, products
 * of differences of coordinates. A rounding multiplies some monomials by 1 + e; let n be the most
 * that any of them meets:
 *   2d: 2 differences, 1 product, 1 subtraction:                               n = 4
 *   3d: 3 differences, 1 product, 1 subtraction, 1 product, 2 additions:       n = 8
 * With M the sum of the absolute monomials, the determinant is off by at most ((1 + u)^n - 1) M. M
 * is computed by the same operations on absolute values, hence to a factor of (1 - u)^n or better,
 * so that the error is at most n u (1 + 20 u) times the computed M. (n + 1) u M is larger, the
 * rounding of this product included. These are worst cases: second_stage in
 * tests/test_predicates.c sees errors between 1 and 2 u M, and fails with bounds of 1 u M.
 *
 * Underflow: in 2d two products, off by 2^-1074 at most. In 3d with w = d - a: each component of
 * the cross product is off by 2^-1074 or a little more, which is multiplied by that of w, and the
 * three last products by 2^-1075. 2^-900 (1 + |w.x| + |w.y| + |w.z|) is more than that by far. With
 * subnormals flushed, a difference may be off by 3 * 2^-1022; with differences up to 2^57 the 6
 * monomials of 3 factors are off by 6 * 3 * 3 * 2^-1022 * 2^114 < 2^-902, which it covers as well.
 *
 * Overflow: the computed M is never less than the computed determinant, rounding being monotonic.
 * If anything overflows, then M is infinite or NaN, and the comparison with the bound fails.
 */
#define SC_BOUNDS_SIGN_2D (5.0 * SC_BOUNDS_U)
#define SC_BOUNDS_SIGN_3D (9.0 * SC_BOUNDS_U)
#define SC_BOUNDS_SIGN_TINY 0x1p-900

/* Of a determinant as the sum of two doubles, 256 u^2 M, derived in base/predicates.c; and of eight
   pairs in doubles (query/decide_kernel.h): 64 times this by the cube of the largest component,
   which is taken for at least so much. */
#define SC_BOUNDS_SIGN_SUMS 0x1p-98
#define SC_BOUNDS_EIGHT (4.25 * SC_BOUNDS_U)
#define SC_BOUNDS_EIGHT_LEAST 0x1p-300

/* Determinants of eight crossings (trace/crossing_kernel.h): certain if larger than this part of M;
   in what range; and what part of W tells D from it. */
#define SC_BOUNDS_CROSSING 0x1p-44
#define SC_BOUNDS_CROSSING_LEAST 0x1p-450
#define SC_BOUNDS_CROSSING_MOST 0x1p+250
#define SC_BOUNDS_CROSSING_SHARE 0x1p-50

/* Below this part of M a determinant in doubles, which is off by 8 u M, is taken for 0: an edge is
   parallel to a triangle then. trace/gradients.c. */
#define SC_BOUNDS_GRADIENT 0x1p-40

/* The distance of a point and a triangle, or of two segments, compared with another in doubles: so
   much of the sum of that and of the largest distance of two of their points. step/within.c. */
#define SC_BOUNDS_WITHIN (8.0 * SC_BOUNDS_U)

/* The square of the distance of two points less that of another, in sums of two doubles: certainly
   below 0 if below so much of the latter. near/corner_kernel.h. */
#define SC_BOUNDS_CORNER 0x1p-96

/*
 * Polynomials of differences of points (near/differences.c). As a sum of two doubles: 256 u^2 M,
 * derived there. In plain arithmetic, n as above: a dot product 2 differences, 1 product, 2 sums;
 * of two cross products twice the 4 of a determinant in 2d, 1 product, 2 sums.
 */
#define SC_BOUNDS_TWOFOLD 0x1p-98
#define SC_BOUNDS_NEAR_DOT (6.0 * SC_BOUNDS_U)
#define SC_BOUNDS_NEAR_CROSS (12.0 * SC_BOUNDS_U)

/*
 * Boxes. A double that becomes a float is off by at most 2^-24 |f|; one step of 2^-23 |f| or more
 * undoes it, and FLT_MIN does so where f is denormal or zero. Boxes of points in the unit box are
 * moved outwards by that step and by 2^-85, for what underflows: see pose/positions.c.
 */
#define SC_BOUNDS_STEP 1.1920929e-7f
#define SC_BOUNDS_STEP_LEAST 2.58493941422821148e-26f

/* A coordinate of a point in the unit box: 2^-25 for the rounding to float of a number of at most
   1, and a little for those to double before. POINT in formulas. The difference of two of them,
   EDGE. */
#define SC_BOUNDS_POINT 3e-8f
#define SC_BOUNDS_EDGE 6e-8f

/*
 * Places of points along a direction n, in the unit box. n . x is off by POINT |n|1, and by
 * rounding 3.01 v |n|1, 2.1e-7 |n|1 in all, and a few FLT_MIN for products that underflow. An end
 * of a slab is the place of one of its points and a sum, off by 6e-8 |n|1 more. The places of two
 * points and an end together are off by less than this times |n|1, and 16 FLT_MIN.
 */
#define SC_BOUNDS_PLACES 5e-7f

/* The same for the difference of two places along c, of which a component is the sum of two: by
   2 POINT |c|1, by rounding 6.02 v |c|1 and 2.02 v |c|1, and by 2.01 v |c|1: below 6.6e-7 |c|1. */
#define SC_BOUNDS_RAYS 7e-7f

/* A coordinate of a point of a projected contour, of points that are no further than size from the
   middle in any coordinate, along an axis of |a|1 <= 1: POINT, and 4.1 v size for a difference,
   three products and two sums. */
static inline float sc_bounds_contour(float size)
{
    return 3.01e-8f + 4.1f * SC_BOUNDS_V * size;
}

/* What a coordinate of a leaf cluster is off by in cylinder coordinates, as query/tube_kernel.h has
   them, where no point is further than this from the middle. */
static inline float sc_bounds_tube(float reach)
{
    return 9.2e-8f + 7.4e-7f * reach;
}

/* A cross or dot product of vectors in such a projection: so many errors of a coordinate times the
   sum of absolute components, see query/simple.c. */
#define SC_BOUNDS_TURN 12

/* Of a contour that moves, so many errors of a coordinate two points must be apart along a
   direction, over its |m|1; see step/moving_contour.c. */
#define SC_BOUNDS_MOVING_TURN 5

/* Sums of bounds of rays, of five or fewer operations each, in doubles: of the sum of the absolute
   terms. */
#define SC_BOUNDS_RAY_SUM 1e-15

/*
 * How far apart boxes of moving points are kept, together, besides a distance: each is moved
 * outwards by half of it, which rounds by at most v (1 + margin) each time. Four times POINT, twice
 * EDGE, and a little.
 */
#define SC_BOUNDS_MOVING_BOX 3e-7f

/*
 * Distances in the unit box in floats (near/distance_kernel.h): what the length of a vector between
 * two points of a pair, and a place along its direction, are off by together. d is the distance
 * asked for; s the largest extent, along an axis, of an edge in one leaf cluster plus that in the
 * other. v, e and f are differences of points, of which the boxes of the two that they belong to
 * are nearer than d and 4e-6: |v_k| < d + s + 4e-6, and |e_k| + |f_k| <= s, of a face with weights
 * that add up to 1.
 *
 * A point of each of the two is a convex combination of points, which are off by POINT: their
 * difference by 2 POINT, in length by sqrt(3) times that, 1.0393e-7. The rest is rounding:
 *   - of a vector w = v - s' e - t' f between two points, with |w| <= d, so that |v_k| <= d + s:
 *     differences, products and sums are off by v (2 |v_k| + 3 s + |w_k|), below
 *     v (3.01 d + 5.01 s); weights that add up to 1 + 4 v move the point by 4 v s: in length
 *     sqrt(3) v (3.01 d + 9.01 s);
 *   - of places along w, over |w|: the three differences, of each three products and two sums, and
 *     two sums of what comes out: 4.01 v (|v| + s) and 2.01 v (|v| + s) in lengths, which are
 *     sqrt(3) (d + 2 s + 4e-6) at most: 10.5 v (d + 2 s) and 3e-12.
 * Both are below what is named here.
 */
#define SC_BOUNDS_NEAR 1.05e-7
static inline double sc_bounds_near(double distance, double size)
{
    return SC_BOUNDS_NEAR + 16 * (double)SC_BOUNDS_V * (distance + 3 * size);
}

/* Squares of lengths, of three products and two sums, are off by 3.01 v of their own; and products
   of two of them by 2 v more: thresholds for them are moved by this times themselves. */
#define SC_BOUNDS_NEAR_SQUARE (8 * (double)SC_BOUNDS_V)

/*
 * A bound of a distance (near/distance_kernel.h). With g a place along w times |w|, both as
 * computed, and r = g / |w|, the distance is more than each d' <= d for which
 * r > (d' + E) (1 + SC_BOUNDS_NEAR_SQUARE) in squares, E being sc_bounds_near for d: so it is at
 * least r (1 - 4 SC_BOUNDS_NEAR_SQUARE) - E. Doubles round that by less than 2^-48, also where it
 * is denormal in units of the pose, as the unit box is then 2^1022 times as large at most; of which
 * there are 1e-9 to spare in SC_BOUNDS_NEAR.
 */
#define SC_BOUNDS_NEAR_BELOW (4 * SC_BOUNDS_NEAR_SQUARE)

/* What the distance of a stencil is off by, over itself, with its rounding downwards; or, where
   that is less, as a length. See sc_near_stencil. */
#define SC_BOUNDS_STENCIL 0x1p-49
#define SC_BOUNDS_STENCIL_LEAST 0x1p-1022

/* A direction whose square is below this tells nothing: what underflows is far less. */
#define SC_BOUNDS_NEAR_LEAST 1e-15f

#endif
