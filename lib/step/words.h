/*
 * Whether a polygon whose coordinates are integers of one word is within a distance of the origin.
 *
 * SPDX-License-Identifier: MIT
 *
 * The signs of step/within.c, which says what they are and why they fit, for compilers that have
 * integers of 128 bits: three to five times as fast as the text there, with n = 1.
 *
 * A component of a product of two words fits into 128 bits with its sign; those of four words are
 * two such numbers, low and high; and those of six three.
 */
#ifndef SC_STEP_WORDS_H
#define SC_STEP_WORDS_H

#include <stdint.h>

#include "base/assume.h"
#include "base/bits.h"
#include "simd/isa.h"

enum { SC_WORDS_UNSURE = -1 };

__extension__ typedef __int128 sc_words_two;
__extension__ typedef unsigned __int128 sc_words_bits;

/* low + high 2^128, modulo 2^256 */
typedef struct sc_words_four {
    sc_words_bits low, high;
} sc_words_four;

typedef struct sc_words_shape {
    int corners;
    int64_t corner[4][3];
    int64_t distance;
    sc_words_bits square; /* of the distance */
} sc_words_shape;

/*
 * Divides all by the largest power of two that leaves integers. 1 if corners are then below 2^29
 * and so is the distance: a narrow shape. Of these edges are below 2^30, components of products of
 * two below 2^61, which is one word, and of four below 3 2^122.
 */
static SC_INLINE int sc_words_narrow(sc_words_shape *s)
{
    uint64_t any = (uint64_t)s->distance, sizes = any;
    unsigned shift;
    for (int i = 0; i < s->corners; ++i) {
        for (int k = 0; k < 3; ++k) {
            uint64_t bits = (uint64_t)s->corner[i][k];
            any |= bits;
            sizes |= bits ^ ((uint64_t)0 - (bits >> 63));
        }
    }
    shift = any ? sc_bits_lowest64(any) : 0;
    if (sizes >> shift >= 1u << 29) return 0;
    s->distance >>= shift;
    for (int i = 0; i < s->corners; ++i) {
        for (int k = 0; k < 3; ++k) s->corner[i][k] >>= shift;
    }
    return 1;
}

/* In what follows, narrow says that the shape is, and is a constant where it counts. */
static SC_INLINE sc_words_two sc_words_dot(const int64_t a[3], const int64_t b[3], int narrow)
{
    if (narrow) return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    return (sc_words_two)a[0] * b[0] + (sc_words_two)a[1] * b[1] + (sc_words_two)a[2] * b[2];
}

static SC_INLINE void sc_words_cross(sc_words_two result[3], const int64_t a[3], const int64_t b[3],
                                     int narrow)
{
    if (narrow) {
        result[0] = a[1] * b[2] - a[2] * b[1];
        result[1] = a[2] * b[0] - a[0] * b[2];
        result[2] = a[0] * b[1] - a[1] * b[0];
        return;
    }
    result[0] = (sc_words_two)a[1] * b[2] - (sc_words_two)a[2] * b[1];
    result[1] = (sc_words_two)a[2] * b[0] - (sc_words_two)a[0] * b[2];
    result[2] = (sc_words_two)a[0] * b[1] - (sc_words_two)a[1] * b[0];
}

static SC_INLINE sc_words_bits sc_words_magnitude(sc_words_two a)
{
    return a < 0 ? 0 - (sc_words_bits)a : (sc_words_bits)a;
}

/* Of numbers without a sign. */
static SC_INLINE sc_words_four sc_words_multiply(sc_words_bits a, sc_words_bits b)
{
    uint64_t a_low = (uint64_t)a, a_high = (uint64_t)(a >> 64);
    uint64_t b_low = (uint64_t)b, b_high = (uint64_t)(b >> 64);
    sc_words_bits low = (sc_words_bits)a_low * b_low;
    sc_words_bits left = (sc_words_bits)a_high * b_low + (uint64_t)(low >> 64);
    sc_words_bits right = (sc_words_bits)a_low * b_high + (uint64_t)left;
    sc_words_four product;
    product.low = (right << 64) | (uint64_t)low;
    product.high =
        (sc_words_bits)a_high * b_high + (uint64_t)(left >> 64) + (uint64_t)(right >> 64);
    return product;
}

static SC_INLINE sc_words_four sc_words_add(sc_words_four a, sc_words_four b)
{
    sc_words_four sum;
    sum.low = a.low + b.low;
    sum.high = a.high + b.high + (sum.low < b.low);
    return sum;
}

/* Of numbers with a sign: see sc_limbs_multiply. */
static SC_INLINE sc_words_four sc_words_multiply_signed(sc_words_two a, sc_words_two b)
{
    sc_words_four product = sc_words_multiply((sc_words_bits)a, (sc_words_bits)b);
    product.high -= ((sc_words_bits)b & (sc_words_bits)(a >> 127)) +
                    ((sc_words_bits)a & (sc_words_bits)(b >> 127));
    return product;
}

static SC_INLINE int sc_words_is_above_zero(sc_words_four a)
{
    return (sc_words_two)a.high > 0 || (a.high == 0 && a.low != 0);
}

static SC_INLINE sc_words_four sc_words_dot_two(const sc_words_two a[3], const sc_words_two b[3],
                                                int narrow)
{
    if (narrow) {
        sc_words_two sum = (sc_words_two)(int64_t)a[0] * (int64_t)b[0] +
                           (sc_words_two)(int64_t)a[1] * (int64_t)b[1] +
                           (sc_words_two)(int64_t)a[2] * (int64_t)b[2];
        sc_words_four wide = {(sc_words_bits)sum, (sc_words_bits)(sum >> 127)};
        return wide;
    }
    return sc_words_add(
        sc_words_add(sc_words_multiply_signed(a[0], b[0]), sc_words_multiply_signed(a[1], b[1])),
        sc_words_multiply_signed(a[2], b[2]));
}

static SC_INLINE sc_words_four sc_words_square(const sc_words_two a[3], int narrow)
{
    if (narrow) return sc_words_dot_two(a, a, 1);
    sc_words_bits x = sc_words_magnitude(a[0]), y = sc_words_magnitude(a[1]);
    sc_words_bits z = sc_words_magnitude(a[2]);
    return sc_words_add(sc_words_add(sc_words_multiply(x, x), sc_words_multiply(y, y)),
                        sc_words_multiply(z, z));
}

static SC_INLINE void sc_words_edge(int64_t edge[3], const sc_words_shape *s, int i, int j)
{
    for (int k = 0; k < 3; ++k) edge[k] = s->corner[j][k] - s->corner[i][k];
}

static SC_INLINE void sc_words_normal(sc_words_two normal[3], const sc_words_shape *s, int narrow)
{
    int64_t e[3], f[3];
    sc_words_edge(e, s, 0, 1);
    sc_words_edge(f, s, 1, 2);
    sc_words_cross(normal, e, f, narrow);
}

/* Each of the next three answers as its like in step/within.c; j is the corner behind i. */
static SC_INLINE int sc_words_decide_corner(const sc_words_shape *s, int i, int j, int narrow)
{
    int64_t next[3], last[3];
    const int64_t *c = s->corner[i];
    if ((sc_words_bits)sc_words_dot(c, c, narrow) <= s->square) return 1;
    sc_words_edge(next, s, i, j);
    sc_words_edge(last, s, i > 0 ? i - 1 : s->corners - 1, i);
    if (sc_words_dot(c, next, narrow) < 0) return SC_WORDS_UNSURE;
    return sc_words_dot(c, last, narrow) <= 0 ? 0 : SC_WORDS_UNSURE;
}

static SC_INLINE int sc_words_decide_edge(const sc_words_shape *s, int i, int j, int narrow)
{
    int64_t edge[3];
    sc_words_two m[3], normal[3];
    sc_words_four area, limit;
    sc_words_edge(edge, s, i, j);
    if (sc_words_dot(s->corner[i], edge, narrow) >= 0) return SC_WORDS_UNSURE;
    if (sc_words_dot(s->corner[j], edge, narrow) <= 0) return SC_WORDS_UNSURE;
    sc_words_cross(m, s->corner[i], s->corner[j], narrow);
    area = sc_words_square(m, narrow);
    limit = sc_words_multiply(s->square, (sc_words_bits)sc_words_dot(edge, edge, narrow));
    if (area.high < limit.high || (area.high == limit.high && area.low <= limit.low)) return 1;
    sc_words_normal(normal, s, narrow);
    return sc_words_is_above_zero(sc_words_dot_two(m, normal, narrow)) ? SC_WORDS_UNSURE : 0;
}

/* Whether the square of the distance times |n|^2 is the square of c_0 . n or more, where the latter
   is below 2^192 in magnitude. */
static SC_INLINE int sc_words_is_plane_near(const sc_words_shape *s, const sc_words_two normal[3],
                                            int narrow)
{
    sc_words_four height = {0, 0}, length = sc_words_square(normal, narrow), low, middle, high;
    sc_words_bits left[3], right[3];
    if (narrow) {
        sc_words_two sum = 0;
        for (int k = 0; k < 3; ++k) sum += normal[k] * s->corner[0][k];
        height.low = sc_words_magnitude(sum);
    }
    for (int k = 0; k < 3 && !narrow; ++k)
        height = sc_words_add(height, sc_words_multiply_signed(s->corner[0][k], normal[k]));
    if (height.high >> 127) {
        height.high = ~height.high + (height.low == 0);
        height.low = 0 - height.low;
    }
    low = sc_words_multiply(height.low, height.low);
    middle = sc_words_multiply(height.low, height.high);
    middle = sc_words_add(middle, middle);
    high.low = height.high * height.high;
    left[0] = low.low;
    left[1] = low.high + middle.low;
    left[2] = middle.high + high.low + (left[1] < middle.low);

    low = sc_words_multiply(s->square, length.low);
    high = sc_words_multiply(s->square, length.high);
    right[0] = low.low;
    right[1] = low.high + high.low;
    right[2] = high.high + (right[1] < high.low);
    if (left[2] != right[2]) return left[2] < right[2];
    if (left[1] != right[1]) return left[1] < right[1];
    return left[0] <= right[0];
}

static SC_INLINE int sc_words_decide_inside(const sc_words_shape *s, int narrow)
{
    sc_words_two normal[3], m[3];
    sc_words_normal(normal, s, narrow);
    for (int i = 0; i < s->corners; ++i) {
        sc_words_cross(m, s->corner[i], s->corner[i + 1 < s->corners ? i + 1 : 0], narrow);
        if (!sc_words_is_above_zero(sc_words_dot_two(m, normal, narrow))) return SC_WORDS_UNSURE;
    }
    return sc_words_is_plane_near(s, normal, narrow);
}

static SC_INLINE int sc_words_decide_at(const sc_words_shape *s, int guess, int narrow)
{
    int i = guess < s->corners ? guess : guess - s->corners, j = i + 1 < s->corners ? i + 1 : 0;
    if (guess < s->corners) return sc_words_decide_corner(s, i, j, narrow);
    if (guess < 2 * s->corners) return sc_words_decide_edge(s, i, j, narrow);
    return sc_words_decide_inside(s, narrow);
}

static SC_INLINE int sc_words_decide_shape(sc_words_shape *s, int guess, int narrow)
{
    int answer;
    s->square = (sc_words_bits)s->distance * (sc_words_bits)s->distance;
    answer = sc_words_decide_at(s, guess, narrow);
    /* one of them is the nearest point, as in step/within.c */
    for (int i = 0; answer == SC_WORDS_UNSURE && SC_ALWAYS(i <= 2 * s->corners); ++i)
        answer = sc_words_decide_at(s, i, narrow);
    return answer == 1;
}

/* Corners and distance are below 2^62. 1 or 0. To see whether a shape is narrow takes 12 ns, which
   only pays for the inside. */
static SC_INLINE int sc_words_decide(sc_words_shape *s, int guess)
{
    if (guess == 2 * s->corners && sc_words_narrow(s)) return sc_words_decide_shape(s, guess, 1);
    return sc_words_decide_shape(s, guess, 0);
}

#endif /* SC_STEP_WORDS_H */
