/*
 * Sixteen floats at a time, for the instruction set that the including file chose: SC_LANES is
 * AVX-512 (one register), AVX2 (two), registers of four floats (four; see simd/quads.h: SSE2, which
 * every x86-64 has, or what the compiler makes of its vector types) or, with other compilers, plain
 * C.
 *
 * SPDX-License-Identifier: MIT
 *
 * Operations round as those of single floats do, and there is no fused multiplication and addition,
 * so that all of them give the same results. lanes_largest_size takes the largest absolute value. A
 * comparison gives a mask, of which lanes_bits makes bit i for lane i; with NaN it is false.
 * lanes_points reads the first three of four floats at sixteen places, lanes_rows those of sixteen
 * fours of an array by their numbers. lanes_numbers writes down sixteen numbers, to which one of
 * two is added: the first if they are below a split. lanes_coordinates reads the first three of
 * sixteen fours that follow each other in transposed places (see build/loops.h): block i of sixteen
 * floats holds points i, i + 4, i + 8 and i + 12. Of the functions of fours, lanes_four repeats
 * four floats four times, lanes_each_four each of four floats, and the others store the least or
 * greatest of each four lanes.
 *
 * Included once for each instruction set (see simd/all_kernels.h), and tools/amalgamate.awk tells
 * files that are included several times from others by their having no guard.
 */
#include <math.h>
#include <string.h>

#include "base/bits.h"
#include "simd/quads.h"

#define SC_LANES_AVX512 (SC_LANES == 3)
#define SC_LANES_AVX2 (SC_LANES == 2)
#define SC_LANES_QUADS (SC_LANES == 1)
#define SC_LANES_SSE2 (SC_LANES_QUADS && SC_ISA_X86)

#ifndef SC_LANES_COUNT
#  define SC_LANES_COUNT 16
#endif

#if SC_LANES_AVX512

typedef __m512 lanes;
typedef __mmask16 lanes_mask;

static inline lanes lanes_all(float f)
{
    return _mm512_set1_ps(f);
}
static inline lanes lanes_load(const float *f)
{
    return _mm512_loadu_ps(f);
}
static inline void lanes_store(float *f, lanes a)
{
    _mm512_storeu_ps(f, a);
}
static inline void lanes_store_half(float *f, lanes a)
{
    _mm256_storeu_ps(f, _mm512_castps512_ps256(a));
}
static inline lanes lanes_add(lanes a, lanes b)
{
    return _mm512_add_ps(a, b);
}
static inline lanes lanes_subtract(lanes a, lanes b)
{
    return _mm512_sub_ps(a, b);
}
static inline lanes lanes_multiply(lanes a, lanes b)
{
    return _mm512_mul_ps(a, b);
}
static inline lanes lanes_divide(lanes a, lanes b)
{
    return _mm512_div_ps(a, b);
}
static inline lanes lanes_smaller(lanes a, lanes b)
{
    return _mm512_min_ps(a, b);
}
static inline lanes lanes_larger(lanes a, lanes b)
{
    return _mm512_max_ps(a, b);
}
static inline lanes lanes_absolute(lanes a)
{
    return _mm512_andnot_ps(_mm512_set1_ps(-0.0f), a);
}
static inline lanes lanes_largest_size(lanes a, lanes b, lanes c)
{
#  pragma GCC diagnostic push
#  pragma GCC diagnostic ignored "-Wsign-conversion" /* a macro where nothing is optimised */
    a = _mm512_range_ps(a, b, 11);                   /* the larger absolute value, without sign */
    return _mm512_range_ps(a, c, 11);
#  pragma GCC diagnostic pop
}
static inline lanes_mask lanes_below(lanes a, lanes b)
{
    return _mm512_cmp_ps_mask(a, b, _CMP_LT_OQ);
}
static inline lanes_mask lanes_not_above(lanes a, lanes b)
{
    return _mm512_cmp_ps_mask(a, b, _CMP_LE_OQ);
}
static inline lanes_mask lanes_both(lanes_mask a, lanes_mask b)
{
    return _kand_mask16(a, b); /* so that compilers do not make a chain of comparisons of it */
}
static inline unsigned lanes_bits(lanes_mask a)
{
    return a;
}
static inline int lanes_every(lanes_mask a)
{
    return a == 0xffff;
}
static inline lanes lanes_evens(lanes a, lanes b)
{
    const __m512i evens =
        _mm512_set_epi32(30, 28, 26, 24, 22, 20, 18, 16, 14, 12, 10, 8, 6, 4, 2, 0);
    return _mm512_permutex2var_ps(a, evens, b);
}
static inline lanes lanes_odds(lanes a, lanes b)
{
    const __m512i odds =
        _mm512_set_epi32(31, 29, 27, 25, 23, 21, 19, 17, 15, 13, 11, 9, 7, 5, 3, 1);
    return _mm512_permutex2var_ps(a, odds, b);
}
static inline void lanes_numbers(uint32_t *to, const uint16_t *number, uint32_t split,
                                 uint32_t below, uint32_t others)
{
    __m512i i = _mm512_cvtepu16_epi32(_mm256_loadu_si256((const __m256i *)(const void *)number));
    __m512i add =
        _mm512_mask_blend_epi32(_mm512_cmplt_epu32_mask(i, _mm512_set1_epi32((int)split)),
                                _mm512_set1_epi32((int)others), _mm512_set1_epi32((int)below));
    _mm512_storeu_si512(to, _mm512_add_epi32(i, add));
}
/* The points i, i + 4, i + 8 and i + 12 of sixteen. */
static inline __m512 lanes_four_points(const float *a, const float *b, const float *c,
                                       const float *d)
{
    __m512 r = _mm512_castps128_ps512(_mm_loadu_ps(a));
    r = _mm512_insertf32x4(r, _mm_loadu_ps(b), 1);
    r = _mm512_insertf32x4(r, _mm_loadu_ps(c), 2);
    return _mm512_insertf32x4(r, _mm_loadu_ps(d), 3);
}
static inline void lanes_transposed(const __m512 r[4], __m512 *x, __m512 *y, __m512 *z)
{
    __m512 low = _mm512_unpacklo_ps(r[0], r[1]), low2 = _mm512_unpacklo_ps(r[2], r[3]);
    *x = _mm512_shuffle_ps(low, low2, 0x44);
    *y = _mm512_shuffle_ps(low, low2, 0xee);
    *z = _mm512_shuffle_ps(_mm512_unpackhi_ps(r[0], r[1]), _mm512_unpackhi_ps(r[2], r[3]), 0x44);
}
static inline void lanes_points(const float *const point[SC_LANES_COUNT], lanes *x, lanes *y,
                                lanes *z)
{
    __m512 r[4];
    int i;
    SC_UNROLL
    for (i = 0; i < 4; i++)
        r[i] = lanes_four_points(point[i], point[i + 4], point[i + 8], point[i + 12]);
    lanes_transposed(r, x, y, z);
}
static inline void lanes_rows(const float *at, const uint32_t row[SC_LANES_COUNT], lanes *x,
                              lanes *y, lanes *z)
{
    __m512 r[4];
    int i;
    SC_UNROLL
    for (i = 0; i < 4; i++)
        r[i] = lanes_four_points(at + 4 * (uint64_t)row[i], at + 4 * (uint64_t)row[i + 4],
                                 at + 4 * (uint64_t)row[i + 8], at + 4 * (uint64_t)row[i + 12]);
    lanes_transposed(r, x, y, z);
}
static inline void lanes_coordinates(const float *at, lanes row[3])
{
    __m512 r[4];
    int i;
    SC_UNROLL
    for (i = 0; i < 4; i++) r[i] = _mm512_loadu_ps(at + 16 * i);
    lanes_transposed(r, &row[0], &row[1], &row[2]);
}
static inline lanes lanes_four(const float *f)
{
    return _mm512_broadcast_f32x4(_mm_loadu_ps(f));
}
static inline lanes lanes_each_four(const float *f)
{
    const __m512i place = _mm512_set_epi32(3, 3, 3, 3, 2, 2, 2, 2, 1, 1, 1, 1, 0, 0, 0, 0);
    return _mm512_permutexvar_ps(place, _mm512_castps128_ps512(_mm_loadu_ps(f)));
}
static inline void lanes_store_fourth(float *f, __m512 a)
{
    _mm_storeu_ps(f, _mm512_castps512_ps128(_mm512_maskz_compress_ps(0x1111, a)));
}
static inline void lanes_store_least(float *f, lanes a)
{
    a = _mm512_min_ps(a, _mm512_permute_ps(a, 0xb1));
    lanes_store_fourth(f, _mm512_min_ps(a, _mm512_permute_ps(a, 0x4e)));
}
static inline void lanes_store_most(float *f, lanes a)
{
    a = _mm512_max_ps(a, _mm512_permute_ps(a, 0xb1));
    lanes_store_fourth(f, _mm512_max_ps(a, _mm512_permute_ps(a, 0x4e)));
}

#elif SC_LANES_AVX2 || SC_LANES_QUADS

/* In registers of eight or four floats. SC_LANES_MAP applies f to registers of a, of a and b. */
#  if SC_LANES_AVX2
#    define SC_LANES_PART __m256
#    define SC_LANES_PARTS 2
#    define SC_LANES_OF(name) _mm256_##name
#    define SC_LANES_BELOW(a, b) _mm256_cmp_ps(a, b, _CMP_LT_OQ)
#    define SC_LANES_NOT_ABOVE(a, b) _mm256_cmp_ps(a, b, _CMP_LE_OQ)
#    define SC_LANES_MAP(f)                                                                        \
      lanes r;                                                                                     \
      r.v[0] = f(0);                                                                               \
      r.v[1] = f(1);                                                                               \
      return r
#  else
#    define SC_LANES_PART sc_floats4
#    define SC_LANES_PARTS 4
#    define SC_LANES_OF(name) SC_QUAD(name)
#    define SC_LANES_BELOW(a, b) SC_QUAD(cmplt_ps)(a, b)
#    define SC_LANES_NOT_ABOVE(a, b) SC_QUAD(cmple_ps)(a, b)
#    define SC_LANES_MAP(f)                                                                        \
      lanes r;                                                                                     \
      r.v[0] = f(0);                                                                               \
      r.v[1] = f(1);                                                                               \
      r.v[2] = f(2);                                                                               \
      r.v[3] = f(3);                                                                               \
      return r
#  endif
#  define SC_LANES_WIDTH (SC_LANES_COUNT / SC_LANES_PARTS)

typedef struct lanes {
    SC_LANES_PART v[SC_LANES_PARTS];
} lanes;
typedef lanes lanes_mask;

static inline lanes lanes_all(float f)
{
#  define SC_LANES_F(i) SC_LANES_OF(set1_ps)(f)
    SC_LANES_MAP(SC_LANES_F);
#  undef SC_LANES_F
}
static inline lanes lanes_load(const float *f)
{
#  define SC_LANES_F(i) SC_LANES_OF(loadu_ps)(f + (i)*SC_LANES_WIDTH)
    SC_LANES_MAP(SC_LANES_F);
#  undef SC_LANES_F
}
static inline void lanes_store(float *f, lanes a)
{
    int i;
    for (i = 0; i < SC_LANES_PARTS; i++) SC_LANES_OF(storeu_ps)(f + i * SC_LANES_WIDTH, a.v[i]);
}
static inline void lanes_store_half(float *f, lanes a)
{
    int i;
    for (i = 0; i < SC_LANES_PARTS / 2; i++) SC_LANES_OF(storeu_ps)(f + i * SC_LANES_WIDTH, a.v[i]);
}
static inline lanes lanes_add(lanes a, lanes b)
{
#  define SC_LANES_F(i) SC_LANES_OF(add_ps)(a.v[i], b.v[i])
    SC_LANES_MAP(SC_LANES_F);
#  undef SC_LANES_F
}
static inline lanes lanes_subtract(lanes a, lanes b)
{
#  define SC_LANES_F(i) SC_LANES_OF(sub_ps)(a.v[i], b.v[i])
    SC_LANES_MAP(SC_LANES_F);
#  undef SC_LANES_F
}
static inline lanes lanes_multiply(lanes a, lanes b)
{
#  define SC_LANES_F(i) SC_LANES_OF(mul_ps)(a.v[i], b.v[i])
    SC_LANES_MAP(SC_LANES_F);
#  undef SC_LANES_F
}
static inline lanes lanes_divide(lanes a, lanes b)
{
#  define SC_LANES_F(i) SC_LANES_OF(div_ps)(a.v[i], b.v[i])
    SC_LANES_MAP(SC_LANES_F);
#  undef SC_LANES_F
}
static inline lanes lanes_smaller(lanes a, lanes b)
{
#  define SC_LANES_F(i) SC_LANES_OF(min_ps)(a.v[i], b.v[i])
    SC_LANES_MAP(SC_LANES_F);
#  undef SC_LANES_F
}
static inline lanes lanes_larger(lanes a, lanes b)
{
#  define SC_LANES_F(i) SC_LANES_OF(max_ps)(a.v[i], b.v[i])
    SC_LANES_MAP(SC_LANES_F);
#  undef SC_LANES_F
}
static inline lanes lanes_absolute(lanes a)
{
#  define SC_LANES_F(i) SC_LANES_OF(andnot_ps)(SC_LANES_OF(set1_ps)(-0.0f), a.v[i])
    SC_LANES_MAP(SC_LANES_F);
#  undef SC_LANES_F
}
static inline lanes_mask lanes_below(lanes a, lanes b)
{
#  define SC_LANES_F(i) SC_LANES_BELOW(a.v[i], b.v[i])
    SC_LANES_MAP(SC_LANES_F);
#  undef SC_LANES_F
}
static inline lanes_mask lanes_not_above(lanes a, lanes b)
{
#  define SC_LANES_F(i) SC_LANES_NOT_ABOVE(a.v[i], b.v[i])
    SC_LANES_MAP(SC_LANES_F);
#  undef SC_LANES_F
}
static inline lanes_mask lanes_both(lanes_mask a, lanes_mask b)
{
#  define SC_LANES_F(i) SC_LANES_OF(and_ps)(a.v[i], b.v[i])
    SC_LANES_MAP(SC_LANES_F);
#  undef SC_LANES_F
}

#  if SC_LANES_AVX2

static inline unsigned lanes_bits(lanes_mask a)
{
    return (unsigned)_mm256_movemask_ps(a.v[0]) | (unsigned)_mm256_movemask_ps(a.v[1]) << 8;
}
static inline int lanes_every(lanes_mask a)
{
    return _mm256_movemask_ps(_mm256_and_ps(a.v[0], a.v[1])) == 255;
}
static inline __m256 lanes_half(__m256 a)
{
    return _mm256_castpd_ps(_mm256_permute4x64_pd(_mm256_castps_pd(a), 0xd8));
}
static inline lanes lanes_evens(lanes a, lanes b)
{
    lanes r;
    r.v[0] = lanes_half(_mm256_shuffle_ps(a.v[0], a.v[1], 0x88));
    r.v[1] = lanes_half(_mm256_shuffle_ps(b.v[0], b.v[1], 0x88));
    return r;
}
static inline lanes lanes_odds(lanes a, lanes b)
{
    lanes r;
    r.v[0] = lanes_half(_mm256_shuffle_ps(a.v[0], a.v[1], 0xdd));
    r.v[1] = lanes_half(_mm256_shuffle_ps(b.v[0], b.v[1], 0xdd));
    return r;
}
static inline void lanes_transposed(const __m256 r[4], __m256 *x, __m256 *y, __m256 *z)
{
    __m256 low = _mm256_unpacklo_ps(r[0], r[1]), low2 = _mm256_unpacklo_ps(r[2], r[3]);
    *x = _mm256_shuffle_ps(low, low2, 0x44);
    *y = _mm256_shuffle_ps(low, low2, 0xee);
    *z = _mm256_shuffle_ps(_mm256_unpackhi_ps(r[0], r[1]), _mm256_unpackhi_ps(r[2], r[3]), 0x44);
}
static inline void lanes_points_part(const float *const *point, __m256 *x, __m256 *y, __m256 *z)
{
    __m256 r[4];
    int i;
    for (i = 0; i < 4; i++)
        r[i] = _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_loadu_ps(point[i])),
                                    _mm_loadu_ps(point[i + 4]), 1);
    lanes_transposed(r, x, y, z);
}
static inline void lanes_numbers(uint32_t *to, const uint16_t *number, uint32_t split,
                                 uint32_t below, uint32_t others)
{
    const __m256i end = _mm256_set1_epi32(split < 0x10000u ? (int)split : 0x10000);
    int k;
    SC_UNROLL
    for (k = 0; k < 16; k += 8) {
        __m256i i =
            _mm256_cvtepu16_epi32(_mm_loadu_si128((const __m128i *)(const void *)(number + k)));
        __m256i add = _mm256_blendv_epi8(_mm256_set1_epi32((int)others),
                                         _mm256_set1_epi32((int)below), _mm256_cmpgt_epi32(end, i));
        _mm256_storeu_si256((__m256i *)(void *)(to + k), _mm256_add_epi32(i, add));
    }
}
static inline void lanes_rows_part(const float *at, const uint32_t *row, __m256 *x, __m256 *y,
                                   __m256 *z)
{
    __m256 r[4];
    int i;
    SC_UNROLL
    for (i = 0; i < 4; i++)
        r[i] = _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_loadu_ps(at + 4 * (uint64_t)row[i])),
                                    _mm_loadu_ps(at + 4 * (uint64_t)row[i + 4]), 1);
    lanes_transposed(r, x, y, z);
}
static inline lanes lanes_four(const float *f)
{
    lanes r;
    r.v[0] = r.v[1] = _mm256_set_m128(_mm_loadu_ps(f), _mm_loadu_ps(f));
    return r;
}
static inline lanes lanes_each_four(const float *f)
{
    lanes r;
    r.v[0] = _mm256_set_m128(_mm_set1_ps(f[1]), _mm_set1_ps(f[0]));
    r.v[1] = _mm256_set_m128(_mm_set1_ps(f[3]), _mm_set1_ps(f[2]));
    return r;
}

#  else

static inline unsigned lanes_bits(lanes_mask a)
{
    return sc_quad_bits(a.v[0], a.v[1], a.v[2], a.v[3]);
}
static inline int lanes_every(lanes_mask a)
{
    return sc_quad_every(
        SC_QUAD(and_ps)(SC_QUAD(and_ps)(a.v[0], a.v[1]), SC_QUAD(and_ps)(a.v[2], a.v[3])));
}
static inline lanes lanes_evens(lanes a, lanes b)
{
    lanes r;
    r.v[0] = SC_QUAD_SHUFFLE(a.v[0], a.v[1], 0, 2, 0, 2);
    r.v[1] = SC_QUAD_SHUFFLE(a.v[2], a.v[3], 0, 2, 0, 2);
    r.v[2] = SC_QUAD_SHUFFLE(b.v[0], b.v[1], 0, 2, 0, 2);
    r.v[3] = SC_QUAD_SHUFFLE(b.v[2], b.v[3], 0, 2, 0, 2);
    return r;
}
static inline lanes lanes_odds(lanes a, lanes b)
{
    lanes r;
    r.v[0] = SC_QUAD_SHUFFLE(a.v[0], a.v[1], 1, 3, 1, 3);
    r.v[1] = SC_QUAD_SHUFFLE(a.v[2], a.v[3], 1, 3, 1, 3);
    r.v[2] = SC_QUAD_SHUFFLE(b.v[0], b.v[1], 1, 3, 1, 3);
    r.v[3] = SC_QUAD_SHUFFLE(b.v[2], b.v[3], 1, 3, 1, 3);
    return r;
}
static inline void lanes_transposed(sc_floats4 r[4], sc_floats4 *x, sc_floats4 *y, sc_floats4 *z)
{
    sc_quad_transpose(r);
    *x = r[0];
    *y = r[1];
    *z = r[2];
}
static inline void lanes_points_part(const float *const *point, sc_floats4 *x, sc_floats4 *y,
                                     sc_floats4 *z)
{
    sc_floats4 r[4];
    int i;
    SC_UNROLL
    for (i = 0; i < 4; i++) r[i] = SC_QUAD(loadu_ps)(point[i]);
    lanes_transposed(r, x, y, z);
}
static inline void lanes_numbers(uint32_t *to, const uint16_t *number, uint32_t split,
                                 uint32_t below, uint32_t others)
{
    int i;
    for (i = 0; i < SC_LANES_COUNT; i++) to[i] = number[i] + (number[i] < split ? below : others);
}
static inline void lanes_rows_part(const float *at, const uint32_t *row, sc_floats4 *x,
                                   sc_floats4 *y, sc_floats4 *z)
{
    sc_floats4 r[4];
    int i;
    SC_UNROLL
    for (i = 0; i < 4; i++) r[i] = SC_QUAD(loadu_ps)(at + 4 * (uint64_t)row[i]);
    lanes_transposed(r, x, y, z);
}
static inline lanes lanes_four(const float *f)
{
    lanes r;
    r.v[0] = r.v[1] = r.v[2] = r.v[3] = SC_QUAD(loadu_ps)(f);
    return r;
}
static inline lanes lanes_each_four(const float *f)
{
    lanes r;
    int i;
    SC_UNROLL
    for (i = 0; i < 4; i++) r.v[i] = SC_QUAD(set1_ps)(f[i]);
    return r;
}

#  endif

/* Fours of a, transposed. */
#  if SC_LANES_AVX2
#    define SC_LANES_FOURS(a)                                                                      \
      __m128 r[4];                                                                                 \
      r[0] = _mm256_castps256_ps128((a).v[0]), r[1] = _mm256_extractf128_ps((a).v[0], 1);          \
      r[2] = _mm256_castps256_ps128((a).v[1]), r[3] = _mm256_extractf128_ps((a).v[1], 1);          \
      sc_quad_transpose(r)
#  else
#    define SC_LANES_FOURS(a)                                                                      \
      sc_floats4 *r = (a).v;                                                                       \
      sc_quad_transpose(r)
#  endif
static inline void lanes_store_least(float *f, lanes a)
{
    SC_LANES_FOURS(a);
    SC_QUAD(storeu_ps)
    (f, SC_QUAD(min_ps)(SC_QUAD(min_ps)(r[0], r[1]), SC_QUAD(min_ps)(r[2], r[3])));
}
static inline void lanes_store_most(float *f, lanes a)
{
    SC_LANES_FOURS(a);
    SC_QUAD(storeu_ps)
    (f, SC_QUAD(max_ps)(SC_QUAD(max_ps)(r[0], r[1]), SC_QUAD(max_ps)(r[2], r[3])));
}
#  undef SC_LANES_FOURS

static inline void lanes_points(const float *const point[SC_LANES_COUNT], lanes *x, lanes *y,
                                lanes *z)
{
    int i;
    for (i = 0; i < SC_LANES_PARTS; i++)
        lanes_points_part(point + i * SC_LANES_WIDTH, &x->v[i], &y->v[i], &z->v[i]);
}
static inline void lanes_rows(const float *at, const uint32_t row[SC_LANES_COUNT], lanes *x,
                              lanes *y, lanes *z)
{
    int i;
    SC_UNROLL
    for (i = 0; i < SC_LANES_PARTS; i++)
        lanes_rows_part(at, row + i * SC_LANES_WIDTH, &x->v[i], &y->v[i], &z->v[i]);
}
static inline void lanes_coordinates(const float *at, lanes row[3])
{
    int i, k;
    SC_UNROLL
    for (i = 0; i < SC_LANES_PARTS; i++) {
        SC_LANES_PART r[4];
        SC_UNROLL
        for (k = 0; k < 4; k++) r[k] = SC_LANES_OF(loadu_ps)(at + 16 * k + i * SC_LANES_WIDTH);
        lanes_transposed(r, &row[0].v[i], &row[1].v[i], &row[2].v[i]);
    }
}

#  undef SC_LANES_PART
#  undef SC_LANES_PARTS
#  undef SC_LANES_OF
#  undef SC_LANES_BELOW
#  undef SC_LANES_NOT_ABOVE
#  undef SC_LANES_MAP
#  undef SC_LANES_WIDTH

#else

typedef struct lanes {
    float v[SC_LANES_COUNT];
} lanes;
typedef unsigned lanes_mask;

#  undef SC_LANES_EACH
#  define SC_LANES_EACH(expression)                                                                \
    lanes r;                                                                                       \
    int i;                                                                                         \
    for (i = 0; i < SC_LANES_COUNT; i++) r.v[i] = (expression);                                    \
    return r
static inline lanes lanes_all(float f)
{
    SC_LANES_EACH(f);
}
static inline lanes lanes_load(const float *f)
{
    SC_LANES_EACH(f[i]);
}
static inline void lanes_store(float *f, lanes a)
{
    int i;
    for (i = 0; i < SC_LANES_COUNT; i++) f[i] = a.v[i];
}
static inline void lanes_store_half(float *f, lanes a)
{
    int i;
    for (i = 0; i < SC_LANES_COUNT / 2; i++) f[i] = a.v[i];
}
static inline lanes lanes_add(lanes a, lanes b)
{
    SC_LANES_EACH(a.v[i] + b.v[i]);
}
static inline lanes lanes_subtract(lanes a, lanes b)
{
    SC_LANES_EACH(a.v[i] - b.v[i]);
}
static inline lanes lanes_multiply(lanes a, lanes b)
{
    SC_LANES_EACH(a.v[i] * b.v[i]);
}
static inline lanes lanes_divide(lanes a, lanes b)
{
    SC_LANES_EACH(a.v[i] / b.v[i]);
}
/* as x86 has them: the second operand if one is NaN */
static inline lanes lanes_smaller(lanes a, lanes b)
{
    SC_LANES_EACH(a.v[i] < b.v[i] ? a.v[i] : b.v[i]);
}
static inline lanes lanes_larger(lanes a, lanes b)
{
    SC_LANES_EACH(a.v[i] > b.v[i] ? a.v[i] : b.v[i]);
}
static inline lanes lanes_absolute(lanes a)
{
    SC_LANES_EACH(fabsf(a.v[i]));
}
static inline lanes_mask lanes_below(lanes a, lanes b)
{
    unsigned mask = 0, i;
    for (i = 0; i < SC_LANES_COUNT; i++) mask |= (unsigned)(a.v[i] < b.v[i]) << i;
    return mask;
}
static inline lanes_mask lanes_not_above(lanes a, lanes b)
{
    unsigned mask = 0, i;
    for (i = 0; i < SC_LANES_COUNT; i++) mask |= (unsigned)(a.v[i] <= b.v[i]) << i;
    return mask;
}
static inline lanes_mask lanes_both(lanes_mask a, lanes_mask b)
{
    return a & b;
}
static inline unsigned lanes_bits(lanes_mask a)
{
    return a;
}
static inline int lanes_every(lanes_mask a)
{
    return a == 0xffff;
}
static inline lanes lanes_evens(lanes a, lanes b)
{
    SC_LANES_EACH(i < SC_LANES_COUNT / 2 ? a.v[2 * i] : b.v[2 * i - SC_LANES_COUNT]);
}
static inline lanes lanes_odds(lanes a, lanes b)
{
    SC_LANES_EACH(i < SC_LANES_COUNT / 2 ? a.v[2 * i + 1] : b.v[2 * i + 1 - SC_LANES_COUNT]);
}
static inline void lanes_points(const float *const point[SC_LANES_COUNT], lanes *x, lanes *y,
                                lanes *z)
{
    int i;
    for (i = 0; i < SC_LANES_COUNT; i++) {
        x->v[i] = point[i][0];
        y->v[i] = point[i][1];
        z->v[i] = point[i][2];
    }
}
static inline void lanes_numbers(uint32_t *to, const uint16_t *number, uint32_t split,
                                 uint32_t below, uint32_t others)
{
    int i;
    for (i = 0; i < SC_LANES_COUNT; i++) to[i] = number[i] + (number[i] < split ? below : others);
}
static inline void lanes_rows(const float *at, const uint32_t row[SC_LANES_COUNT], lanes *x,
                              lanes *y, lanes *z)
{
    int i;
    for (i = 0; i < SC_LANES_COUNT; i++) {
        x->v[i] = at[4 * (uint64_t)row[i]];
        y->v[i] = at[4 * (uint64_t)row[i] + 1];
        z->v[i] = at[4 * (uint64_t)row[i] + 2];
    }
}
static inline void lanes_coordinates(const float *at, lanes row[3])
{
    int i, k;
    for (i = 0; i < SC_LANES_COUNT; i++)
        for (k = 0; k < 3; k++) row[k].v[i] = at[16 * (i % 4) + i / 4 * 4 + k];
}
static inline lanes lanes_four(const float *f)
{
    SC_LANES_EACH(f[i % 4]);
}
static inline lanes lanes_each_four(const float *f)
{
    SC_LANES_EACH(f[i / 4]);
}
static inline void lanes_store_least(float *f, lanes a)
{
    int i;
    for (i = 0; i < SC_LANES_COUNT; i++)
        if (i % 4 == 0 || a.v[i] < f[i / 4]) f[i / 4] = a.v[i];
}
static inline void lanes_store_most(float *f, lanes a)
{
    int i;
    for (i = 0; i < SC_LANES_COUNT; i++)
        if (i % 4 == 0 || a.v[i] > f[i / 4]) f[i / 4] = a.v[i];
}

#endif

#if !SC_LANES_AVX512
static inline lanes lanes_largest_size(lanes a, lanes b, lanes c)
{
    return lanes_larger(lanes_larger(lanes_absolute(a), lanes_absolute(b)), lanes_absolute(c));
}
#endif

/*
 * Reductions: of the upper and lower halves, then of halves of these: the order in which a sum is
 * made, the same for all instruction sets. For the least and the greatest no lane is NaN.
 */
#if SC_LANES_AVX512 || SC_LANES_AVX2 || SC_LANES_QUADS

/* To four lanes: by 256 bits, or by 128. */
#  if SC_LANES_AVX512
#    define SC_LANES_HALVE(a, name)                                                                \
      __m256 h = _mm256_##name(_mm512_castps512_ps256(a), _mm512_extractf32x8_ps(a, 1));           \
      __m128 r = _mm_##name(_mm256_castps256_ps128(h), _mm256_extractf128_ps(h, 1));
#  elif SC_LANES_AVX2
#    define SC_LANES_HALVE(a, name)                                                                \
      __m256 h = _mm256_##name((a).v[0], (a).v[1]);                                                \
      __m128 r = _mm_##name(_mm256_castps256_ps128(h), _mm256_extractf128_ps(h, 1));
#  else
#    define SC_LANES_HALVE(a, name)                                                                \
      sc_floats4 r =                                                                               \
          SC_QUAD(name)(SC_QUAD(name)((a).v[0], (a).v[2]), SC_QUAD(name)((a).v[1], (a).v[3]));
#  endif
#  define SC_LANES_REDUCE(a, name)                                                                 \
    SC_LANES_HALVE(a, name)                                                                        \
    r = SC_QUAD(name)(r, SC_QUAD_SHUFFLE(r, r, 2, 3, 2, 3));                                       \
    return SC_QUAD(cvtss_f32)(SC_QUAD(name)(r, SC_QUAD_SHUFFLE(r, r, 1, 0, 3, 2)))
static inline float lanes_sum(lanes a)
{
    SC_LANES_REDUCE(a, add_ps);
}
static inline float lanes_least(lanes a)
{
    SC_LANES_REDUCE(a, min_ps);
}
static inline float lanes_most(lanes a)
{
    SC_LANES_REDUCE(a, max_ps);
}
#  undef SC_LANES_HALVE
#  undef SC_LANES_REDUCE

#else

#  define SC_LANES_REDUCE(expression)                                                              \
    int i, half;                                                                                   \
    for (half = SC_LANES_COUNT / 2; half > 0; half /= 2)                                           \
      for (i = 0; i < half; i++) a.v[i] = (expression);                                            \
    return a.v[0]
static inline float lanes_sum(lanes a)
{
    SC_LANES_REDUCE(a.v[i] + a.v[i + half]);
}
static inline float lanes_least(lanes a)
{
    SC_LANES_REDUCE(a.v[i] < a.v[i + half] ? a.v[i] : a.v[i + half]);
}
static inline float lanes_most(lanes a)
{
    SC_LANES_REDUCE(a.v[i] > a.v[i + half] ? a.v[i] : a.v[i + half]);
}
#  undef SC_LANES_REDUCE

#endif

#include "simd/lanes_double.h"
#include "simd/lanes_pick.h"
#include "simd/lanes_bytes.h"
#include "simd/lanes_cells.h"
#include "simd/lanes_rows.h"
#include "simd/lanes_sets.h"
