/*
 * Eight floats at a time, for the instruction set that the including file chose: SC_LANES is AVX2, SSE2
 * (what every x86-64 has) or, where neither is, plain C, which compilers turn into what there is.
 *
 * SPDX-License-Identifier: MIT
 *
 * Operations round as those of single floats do, and there is no fused multiplication and addition, so that
 * all three give the same results. A comparison gives a mask, of which lanes_bits makes bit i for lane i; with
 * NaN it is false. lanes_next is a moved down by one lane, with the first of b on top; lanes_points reads the
 * first three of four floats at eight places.
 *
 * Included once for each instruction set, by the .c files that include kernels, which define SC_KERNEL(name) to
 * make names of their own; so this has no guard. base/lanes_end.h ends it.
 */
#include <math.h>

#include "base/bits.h"

#define SC_LANES_AVX2 (SC_LANES == 2)
#define SC_LANES_SSE2 (SC_LANES == 1)

#define lanes SC_KERNEL(sc_lanes)
#define lanes_all SC_KERNEL(sc_lanes_all)
#define lanes_load SC_KERNEL(sc_lanes_load)
#define lanes_store SC_KERNEL(sc_lanes_store)
#define lanes_add SC_KERNEL(sc_lanes_add)
#define lanes_subtract SC_KERNEL(sc_lanes_subtract)
#define lanes_multiply SC_KERNEL(sc_lanes_multiply)
#define lanes_smaller SC_KERNEL(sc_lanes_smaller)
#define lanes_larger SC_KERNEL(sc_lanes_larger)
#define lanes_absolute SC_KERNEL(sc_lanes_absolute)
#define lanes_mask SC_KERNEL(sc_lanes_mask)
#define lanes_below SC_KERNEL(sc_lanes_below)
#define lanes_not_above SC_KERNEL(sc_lanes_not_above)
#define lanes_both SC_KERNEL(sc_lanes_both)
#define lanes_bits SC_KERNEL(sc_lanes_bits)
#define lanes_next SC_KERNEL(sc_lanes_next)
#define lanes_sum SC_KERNEL(sc_lanes_sum)
#define lanes_least SC_KERNEL(sc_lanes_least)
#define lanes_most SC_KERNEL(sc_lanes_most)
#define lanes_points SC_KERNEL(sc_lanes_points)

#ifndef SC_LANES_COUNT
#  define SC_LANES_COUNT 8
#endif

#if SC_LANES_AVX2

typedef __m256 lanes;
typedef __m256 lanes_mask;

static inline lanes lanes_all(float f)
{
    return _mm256_set1_ps(f);
}
static inline lanes lanes_load(const float *f)
{
    return _mm256_loadu_ps(f);
}
static inline void lanes_store(float *f, lanes a)
{
    _mm256_storeu_ps(f, a);
}
static inline lanes lanes_add(lanes a, lanes b)
{
    return _mm256_add_ps(a, b);
}
static inline lanes lanes_subtract(lanes a, lanes b)
{
    return _mm256_sub_ps(a, b);
}
static inline lanes lanes_multiply(lanes a, lanes b)
{
    return _mm256_mul_ps(a, b);
}
static inline lanes lanes_smaller(lanes a, lanes b)
{
    return _mm256_min_ps(a, b);
}
static inline lanes lanes_larger(lanes a, lanes b)
{
    return _mm256_max_ps(a, b);
}
static inline lanes lanes_absolute(lanes a)
{
    return _mm256_andnot_ps(_mm256_set1_ps(-0.0f), a);
}
static inline lanes_mask lanes_below(lanes a, lanes b)
{
    return _mm256_cmp_ps(a, b, _CMP_LT_OQ);
}
static inline lanes_mask lanes_not_above(lanes a, lanes b)
{
    return _mm256_cmp_ps(a, b, _CMP_LE_OQ);
}
static inline lanes_mask lanes_both(lanes_mask a, lanes_mask b)
{
    return _mm256_and_ps(a, b);
}
static inline unsigned lanes_bits(lanes_mask a)
{
    return (unsigned)_mm256_movemask_ps(a);
}
static inline lanes lanes_next(lanes a, lanes b)
{
    __m256 middle = _mm256_permute2f128_ps(a, b, 0x21); /* a4 to a7, b0 to b3 */
    return _mm256_castsi256_ps(
        _mm256_alignr_epi8(_mm256_castps_si256(middle), _mm256_castps_si256(a), 4));
}
static inline void lanes_points(const float *const point[SC_LANES_COUNT], lanes *x, lanes *y,
                                lanes *z)
{
    __m256 r[4], low, high, low2, high2;
    int i;
    for (i = 0; i < 4; i++)
        r[i] = _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_loadu_ps(point[i])),
                                    _mm_loadu_ps(point[i + 4]), 1);
    low = _mm256_unpacklo_ps(r[0], r[1]);
    high = _mm256_unpackhi_ps(r[0], r[1]);
    low2 = _mm256_unpacklo_ps(r[2], r[3]);
    high2 = _mm256_unpackhi_ps(r[2], r[3]);
    *x = _mm256_shuffle_ps(low, low2, 0x44);
    *y = _mm256_shuffle_ps(low, low2, 0xee);
    *z = _mm256_shuffle_ps(high, high2, 0x44);
}

#elif SC_LANES_SSE2

typedef struct lanes {
    __m128 low, high;
} lanes;
typedef lanes lanes_mask;

#  undef SC_LANES_PAIR
#  define SC_LANES_PAIR(a, b)                                                                      \
    lanes r;                                                                                       \
    r.low = a;                                                                                     \
    r.high = b;                                                                                    \
    return r
static inline lanes lanes_all(float f)
{
    SC_LANES_PAIR(_mm_set1_ps(f), _mm_set1_ps(f));
}
static inline lanes lanes_load(const float *f)
{
    SC_LANES_PAIR(_mm_loadu_ps(f), _mm_loadu_ps(f + 4));
}
static inline void lanes_store(float *f, lanes a)
{
    _mm_storeu_ps(f, a.low);
    _mm_storeu_ps(f + 4, a.high);
}
static inline lanes lanes_add(lanes a, lanes b)
{
    SC_LANES_PAIR(_mm_add_ps(a.low, b.low), _mm_add_ps(a.high, b.high));
}
static inline lanes lanes_subtract(lanes a, lanes b)
{
    SC_LANES_PAIR(_mm_sub_ps(a.low, b.low), _mm_sub_ps(a.high, b.high));
}
static inline lanes lanes_multiply(lanes a, lanes b)
{
    SC_LANES_PAIR(_mm_mul_ps(a.low, b.low), _mm_mul_ps(a.high, b.high));
}
static inline lanes lanes_smaller(lanes a, lanes b)
{
    SC_LANES_PAIR(_mm_min_ps(a.low, b.low), _mm_min_ps(a.high, b.high));
}
static inline lanes lanes_larger(lanes a, lanes b)
{
    SC_LANES_PAIR(_mm_max_ps(a.low, b.low), _mm_max_ps(a.high, b.high));
}
static inline lanes lanes_absolute(lanes a)
{
    __m128 sign = _mm_set1_ps(-0.0f);
    SC_LANES_PAIR(_mm_andnot_ps(sign, a.low), _mm_andnot_ps(sign, a.high));
}
static inline lanes_mask lanes_below(lanes a, lanes b)
{
    SC_LANES_PAIR(_mm_cmplt_ps(a.low, b.low), _mm_cmplt_ps(a.high, b.high));
}
static inline lanes_mask lanes_not_above(lanes a, lanes b)
{
    SC_LANES_PAIR(_mm_cmple_ps(a.low, b.low), _mm_cmple_ps(a.high, b.high));
}
static inline lanes_mask lanes_both(lanes_mask a, lanes_mask b)
{
    SC_LANES_PAIR(_mm_and_ps(a.low, b.low), _mm_and_ps(a.high, b.high));
}
static inline unsigned lanes_bits(lanes_mask a)
{
    return (unsigned)_mm_movemask_ps(a.low) | (unsigned)_mm_movemask_ps(a.high) << 4;
}
static inline lanes lanes_next(lanes a, lanes b)
{
    __m128 low = _mm_move_ss(a.low, a.high), high = _mm_move_ss(a.high, b.low);
    SC_LANES_PAIR(_mm_shuffle_ps(low, low, 0x39), _mm_shuffle_ps(high, high, 0x39));
}
static inline void lanes_points(const float *const point[SC_LANES_COUNT], lanes *x, lanes *y,
                                lanes *z)
{
    __m128 r[8];
    int i;
    for (i = 0; i < 8; i++) r[i] = _mm_loadu_ps(point[i]);
    _MM_TRANSPOSE4_PS(r[0], r[1], r[2], r[3]);
    _MM_TRANSPOSE4_PS(r[4], r[5], r[6], r[7]);
    x->low = r[0];
    y->low = r[1];
    z->low = r[2];
    x->high = r[4];
    y->high = r[5];
    z->high = r[6];
}

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
static inline lanes lanes_next(lanes a, lanes b)
{
    SC_LANES_EACH(i + 1 < SC_LANES_COUNT ? a.v[i + 1] : b.v[0]);
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

#endif

/*
 * Reductions: of the upper and lower halves, then of halves of these. The sum, of which the order matters, is
 * ((v0 + v4) + (v2 + v6)) + ((v1 + v5) + (v3 + v7)) for all instruction sets; for the least and the greatest no lane
 * is NaN.
 */
#if SC_LANES_AVX2 || SC_LANES_SSE2

#  if SC_LANES_AVX2
#    define SC_LANES_LOW(a) _mm256_castps256_ps128(a)
#    define SC_LANES_HIGH(a) _mm256_extractf128_ps(a, 1)
#  else
#    define SC_LANES_LOW(a) (a).low
#    define SC_LANES_HIGH(a) (a).high
#  endif
#  define SC_LANES_REDUCE(a, four, one)                                                            \
    __m128 r = four(SC_LANES_LOW(a), SC_LANES_HIGH(a));                                            \
    r = four(r, _mm_movehl_ps(r, r));                                                              \
    return _mm_cvtss_f32(one(r, _mm_shuffle_ps(r, r, 1)))
static inline float lanes_sum(lanes a)
{
    SC_LANES_REDUCE(a, _mm_add_ps, _mm_add_ss);
}
static inline float lanes_least(lanes a)
{
    SC_LANES_REDUCE(a, _mm_min_ps, _mm_min_ss);
}
static inline float lanes_most(lanes a)
{
    SC_LANES_REDUCE(a, _mm_max_ps, _mm_max_ss);
}
#  undef SC_LANES_LOW
#  undef SC_LANES_HIGH
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
