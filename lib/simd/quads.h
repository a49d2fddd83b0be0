/*
 * Registers of four floats or two doubles: by SSE2 on x86-64; elsewhere, with gcc and clang, by
 * their vector types, of which they make NEON, WebAssembly's SIMD or whatever there is. SIMD:
 * single instruction, multiple data.
 *
 * SPDX-License-Identifier: MIT
 *
 * SC_QUADS is 0 where there are none. SC_QUAD(name) does what the SSE2 intrinsic _mm_name does: the
 * same bits, and of two NaN or zeros the same one. Masks are registers of all bits or none. Numbers
 * of a SC_QUAD_SHUFFLE are constants: two of a, then two of b.
 */
#ifndef SC_SIMD_QUADS_H
#define SC_SIMD_QUADS_H

#include <stdint.h>
#include <string.h>

#include "simd/isa.h"

#if SC_ISA_X86

#  include <emmintrin.h>
#  define SC_QUADS 1
#  define SC_QUAD(name) _mm_##name
#  define SC_QUAD_SHUFFLE(a, b, i, j, k, l) _mm_shuffle_ps(a, b, _MM_SHUFFLE(l, k, j, i))
typedef __m128 sc_floats4;
typedef __m128d sc_doubles2;

/* Bit i for lane i of four masks of floats, or of doubles. */
static inline unsigned sc_quad_bits(sc_floats4 a, sc_floats4 b, sc_floats4 c, sc_floats4 d)
{
    return (unsigned)_mm_movemask_ps(a) | (unsigned)_mm_movemask_ps(b) << 4 |
           (unsigned)_mm_movemask_ps(c) << 8 | (unsigned)_mm_movemask_ps(d) << 12;
}
static inline unsigned sc_quad_bits_doubles(sc_doubles2 a, sc_doubles2 b, sc_doubles2 c,
                                            sc_doubles2 d)
{
    return (unsigned)_mm_movemask_pd(a) | (unsigned)_mm_movemask_pd(b) << 2 |
           (unsigned)_mm_movemask_pd(c) << 4 | (unsigned)_mm_movemask_pd(d) << 6;
}
/* The same of four registers of any doubles, by their signs. */
static inline unsigned sc_quad_signs_doubles(sc_doubles2 a, sc_doubles2 b, sc_doubles2 c,
                                             sc_doubles2 d)
{
    return sc_quad_bits_doubles(a, b, c, d);
}
/* A mask of the lanes that have the same bits. */
static inline sc_floats4 sc_quad_same(sc_floats4 a, sc_floats4 b)
{
    return _mm_castsi128_ps(_mm_cmpeq_epi32(_mm_castps_si128(a), _mm_castps_si128(b)));
}
/* Whether all are set. */
static inline int sc_quad_every(sc_floats4 a)
{
    return _mm_movemask_ps(a) == 15;
}
/* Two of a, then two of b, or 0, rounded. */
static inline sc_floats4 sc_quad_rounded(sc_doubles2 a, sc_doubles2 b)
{
    return _mm_movelh_ps(_mm_cvtpd_ps(a), _mm_cvtpd_ps(b));
}
static inline sc_floats4 sc_quad_rounded_two(sc_doubles2 a)
{
    return _mm_cvtpd_ps(a);
}
/* Where points of sixteen numbers below sixteen are in a table of transposed places (see
   simd/lanes.h), in bytes: block i % 4, place i / 4. */
static inline void sc_quad_places(const uint8_t *numbers, uint8_t *place)
{
    __m128i n = _mm_loadu_si128((const __m128i *)(const void *)numbers);
    __m128i block = _mm_and_si128(_mm_slli_epi16(n, 6), _mm_set1_epi8((char)0xc0));
    n = _mm_or_si128(block, _mm_and_si128(_mm_slli_epi16(n, 2), _mm_set1_epi8(0x30)));
    _mm_storeu_si128((__m128i *)(void *)place, n);
}
/* x[i][k] becomes x[k][i]. */
static inline void sc_quad_transpose(sc_floats4 x[4])
{
    _MM_TRANSPOSE4_PS(x[0], x[1], x[2], x[3]);
}

#elif SC_ISA_VECTORS

#  define SC_QUADS 1
#  define SC_QUAD(name) sc_quad_##name

typedef float sc_floats4 __attribute__((vector_size(16)));
typedef double sc_doubles2 __attribute__((vector_size(16)));
typedef int32_t sc_numbers4 __attribute__((vector_size(16)));
typedef int64_t sc_numbers2 __attribute__((vector_size(16)));
typedef uint32_t sc_words4 __attribute__((vector_size(16)));
typedef uint8_t sc_bytes16 __attribute__((vector_size(16)));

#  if defined(__clang__)
#    define SC_QUAD_OF(a, b, i, j, k, l) __builtin_shufflevector(a, b, i, j, k, l)
#  else
#    define SC_QUAD_OF(a, b, i, j, k, l) __builtin_shuffle(a, b, (sc_numbers4){i, j, k, l})
#  endif
#  define SC_QUAD_SHUFFLE(a, b, i, j, k, l) SC_QUAD_OF(a, b, i, j, (k) + 4, (l) + 4)

static inline sc_floats4 sc_quad_set1_ps(float f)
{
    return (sc_floats4){f, f, f, f};
}
static inline sc_doubles2 sc_quad_set1_pd(double d)
{
    return (sc_doubles2){d, d};
}
static inline sc_doubles2 sc_quad_setr_pd(double d, double e)
{
    return (sc_doubles2){d, e};
}
static inline sc_floats4 sc_quad_loadu_ps(const float *f)
{
    sc_floats4 r;
    memcpy(&r, f, sizeof r);
    return r;
}
static inline sc_doubles2 sc_quad_loadu_pd(const double *d)
{
    sc_doubles2 r;
    memcpy(&r, d, sizeof r);
    return r;
}
static inline void sc_quad_storeu_ps(float *f, sc_floats4 a)
{
    memcpy(f, &a, sizeof a);
}
static inline void sc_quad_storeu_pd(double *d, sc_doubles2 a)
{
    memcpy(d, &a, sizeof a);
}
static inline float sc_quad_cvtss_f32(sc_floats4 a)
{
    return a[0];
}

/* Two operands, one result; for four floats (ps) and for two doubles (pd). */
#  define SC_QUAD_ONE(type, name, result)                                                          \
    static inline type sc_quad_##name(type a, type b)                                              \
    {                                                                                              \
      return (type)(result);                                                                       \
    }
#  define SC_QUAD_CHOOSE(mask, m) (((mask)(m) & (mask)a) | (~(mask)(m) & (mask)b))
#  define SC_QUAD_ALL(type, mask, end)                                                             \
    SC_QUAD_ONE(type, add_##end, a + b)                                                            \
    SC_QUAD_ONE(type, sub_##end, a - b)                                                            \
    SC_QUAD_ONE(type, mul_##end, a *b)                                                             \
    SC_QUAD_ONE(type, div_##end, a / b)                                                            \
    SC_QUAD_ONE(type, and_##end, (mask)a &(mask)b)                                                 \
    SC_QUAD_ONE(type, andnot_##end, ~(mask)a &(mask)b)                                             \
    SC_QUAD_ONE(type, or_##end, (mask)a | (mask)b)                                                 \
    SC_QUAD_ONE(type, cmplt_##end, a < b)                                                          \
    SC_QUAD_ONE(type, cmple_##end, a <= b)                                                         \
    SC_QUAD_ONE(type, cmpeq_##end, a == b)                                                         \
    SC_QUAD_ONE(type, min_##end, SC_QUAD_CHOOSE(mask, a < b))                                      \
    SC_QUAD_ONE(type, max_##end, SC_QUAD_CHOOSE(mask, a > b))
SC_QUAD_ALL(sc_floats4, sc_numbers4, ps)
SC_QUAD_ALL(sc_doubles2, sc_numbers2, pd)

static inline unsigned sc_quad_bits(sc_floats4 a, sc_floats4 b, sc_floats4 c, sc_floats4 d)
{
    const sc_numbers4 bit = {1, 2, 4, 8};
    sc_numbers4 r = (((sc_numbers4)a & bit) | ((sc_numbers4)b & bit << 4)) |
                    (((sc_numbers4)c & bit << 8) | ((sc_numbers4)d & bit << 12));
    sc_numbers2 two = (sc_numbers2)r;
    uint64_t all = (uint64_t)two[0] | (uint64_t)two[1];
    return (unsigned)(all | all >> 32);
}
static inline unsigned sc_quad_bits_doubles(sc_doubles2 a, sc_doubles2 b, sc_doubles2 c,
                                            sc_doubles2 d)
{
    const sc_numbers2 bit = {1, 2};
    sc_numbers2 r = (((sc_numbers2)a & bit) | ((sc_numbers2)b & bit << 2)) |
                    (((sc_numbers2)c & bit << 4) | ((sc_numbers2)d & bit << 6));
    return (unsigned)(r[0] | r[1]);
}
static inline unsigned sc_quad_signs_doubles(sc_doubles2 a, sc_doubles2 b, sc_doubles2 c,
                                             sc_doubles2 d)
{
    const sc_numbers2 zero = {0, 0};
    return sc_quad_bits_doubles(
        (sc_doubles2)((sc_numbers2)a < zero), (sc_doubles2)((sc_numbers2)b < zero),
        (sc_doubles2)((sc_numbers2)c < zero), (sc_doubles2)((sc_numbers2)d < zero));
}
static inline sc_floats4 sc_quad_same(sc_floats4 a, sc_floats4 b)
{
    return (sc_floats4)((sc_numbers4)a == (sc_numbers4)b);
}
static inline int sc_quad_every(sc_floats4 a)
{
    sc_numbers2 two = (sc_numbers2)a;
    return (two[0] & two[1]) == -1;
}
static inline sc_floats4 sc_quad_rounded(sc_doubles2 a, sc_doubles2 b)
{
    return (sc_floats4){(float)a[0], (float)a[1], (float)b[0], (float)b[1]};
}
static inline sc_floats4 sc_quad_rounded_two(sc_doubles2 a)
{
    return (sc_floats4){(float)a[0], (float)a[1], 0, 0};
}
static inline void sc_quad_places(const uint8_t *numbers, uint8_t *place)
{
    sc_bytes16 n;
    memcpy(&n, numbers, sizeof n);
    n = n << 6 | (n << 2 & 0x30);
    memcpy(place, &n, sizeof n);
}
static inline void sc_quad_transpose(sc_floats4 x[4])
{
    sc_floats4 low = SC_QUAD_OF(x[0], x[1], 0, 4, 1, 5), high = SC_QUAD_OF(x[0], x[1], 2, 6, 3, 7);
    sc_floats4 low2 = SC_QUAD_OF(x[2], x[3], 0, 4, 1, 5),
               high2 = SC_QUAD_OF(x[2], x[3], 2, 6, 3, 7);
    x[0] = SC_QUAD_OF(low, low2, 0, 1, 4, 5);
    x[1] = SC_QUAD_OF(low, low2, 2, 3, 6, 7);
    x[2] = SC_QUAD_OF(high, high2, 0, 1, 4, 5);
    x[3] = SC_QUAD_OF(high, high2, 2, 3, 6, 7);
}

#else

#  define SC_QUADS 0

#endif

#if SC_QUADS

/* The point that sc_quad_places says. */
static SC_INLINE sc_floats4 sc_quad_at(const float *table, uint8_t place)
{
    return SC_QUAD(loadu_ps)(table + place / sizeof *table);
}

#endif

#endif
