/*
 * Eight doubles at a time: one register of AVX-512, two of AVX2, four of two doubles
 * (simd/quads.h), elsewhere plain C. A part of simd/lanes.h.
 *
 * SPDX-License-Identifier: MIT
 *
 * Operations round as those of single doubles do. doubles_larger_size and doubles_smaller_size take
 * the larger or smaller absolute value. A comparison gives a mask of all lanes, of which
 * doubles_bits makes bit i for lane i; with NaN it is false. doubles_signs makes such bits of
 * signs, doubles_differ of whether the signs of two or three differ. doubles_choose takes from a
 * where the mask is set, else from b; doubles_points reads three doubles, or floats, at eight
 * places, aligned or not.
 */

#if !SC_LANES_AVX512 && !SC_LANES_AVX2
static SC_INLINE void doubles_point(const unsigned char *at, int floats, double p[3])
{
    float f[3];
    int c;
    if (!floats) {
        memcpy(p, at, 3 * sizeof *p);
        return;
    }
    memcpy(f, at, sizeof f);
    for (c = 0; c < 3; c++) p[c] = (double)f[c];
}
#endif

#if SC_LANES_AVX512

typedef __m512d doubles;
typedef __mmask8 doubles_mask;

static inline doubles doubles_all(double d)
{
    return _mm512_set1_pd(d);
}
static inline doubles doubles_load(const double *d)
{
    return _mm512_loadu_pd(d);
}
static inline void doubles_store(double *d, doubles a)
{
    _mm512_storeu_pd(d, a);
}
static inline doubles doubles_add(doubles a, doubles b)
{
    return _mm512_add_pd(a, b);
}
static inline doubles doubles_subtract(doubles a, doubles b)
{
    return _mm512_sub_pd(a, b);
}
static inline doubles doubles_multiply(doubles a, doubles b)
{
    return _mm512_mul_pd(a, b);
}
static inline doubles doubles_smaller(doubles a, doubles b)
{
    return _mm512_min_pd(a, b);
}
static inline doubles doubles_larger(doubles a, doubles b)
{
    return _mm512_max_pd(a, b);
}
static inline doubles doubles_absolute(doubles a)
{
    return _mm512_andnot_pd(_mm512_set1_pd(-0.0), a);
}
#  pragma GCC diagnostic push
#  pragma GCC diagnostic ignored "-Wsign-conversion" /* macros where nothing is optimised */
static inline doubles doubles_larger_size(doubles a, doubles b)
{
    return _mm512_range_pd(a, b, 11); /* the larger absolute value, without sign */
}
static inline doubles doubles_smaller_size(doubles a, doubles b)
{
    return _mm512_range_pd(a, b, 10);
}
#  pragma GCC diagnostic pop
static inline unsigned doubles_signs(doubles a)
{
    return _mm512_movepi64_mask(_mm512_castpd_si512(a));
}
static inline unsigned doubles_differ(doubles a, doubles b)
{
    return _mm512_movepi64_mask(_mm512_castpd_si512(_mm512_xor_pd(a, b)));
}
static inline unsigned doubles_differ3(doubles a, doubles b, doubles c)
{
    return _mm512_movepi64_mask(_mm512_ternarylogic_epi64(
        _mm512_castpd_si512(a), _mm512_castpd_si512(b), _mm512_castpd_si512(c), 0x7e));
}
static inline doubles_mask doubles_below(doubles a, doubles b)
{
    return _mm512_cmp_pd_mask(a, b, _CMP_LT_OQ);
}
static inline doubles_mask doubles_equal(doubles a, doubles b)
{
    return _mm512_cmp_pd_mask(a, b, _CMP_EQ_OQ);
}
static inline doubles_mask doubles_both(doubles_mask a, doubles_mask b)
{
    return (doubles_mask)(a & b);
}
static inline doubles_mask doubles_either(doubles_mask a, doubles_mask b)
{
    return (doubles_mask)(a | b);
}
static inline unsigned doubles_bits(doubles_mask a)
{
    return a;
}
static inline doubles doubles_choose(doubles_mask m, doubles a, doubles b)
{
    return _mm512_mask_blend_pd(m, b, a);
}
static SC_INLINE __m512d doubles_two(const unsigned char *const at[8], int floats, int i)
{
    const void *p = at[i], *q = at[i + 4];
    __m256d a = floats ? _mm256_cvtps_pd(_mm_maskz_loadu_ps(7, p)) : _mm256_maskz_loadu_pd(7, p);
    __m256d b = floats ? _mm256_cvtps_pd(_mm_maskz_loadu_ps(7, q)) : _mm256_maskz_loadu_pd(7, q);
    return _mm512_insertf64x4(_mm512_castpd256_pd512(a), b, 1);
}
static SC_INLINE void doubles_points(const unsigned char *const at[8], int floats, doubles point[3])
{
    const __m512i first = _mm512_set_epi64(13, 12, 5, 4, 9, 8, 1, 0);
    const __m512i second = _mm512_set_epi64(15, 14, 7, 6, 11, 10, 3, 2);
    __m512d r0 = doubles_two(at, floats, 0);
    __m512d r1 = doubles_two(at, floats, 1);
    __m512d r2 = doubles_two(at, floats, 2);
    __m512d r3 = doubles_two(at, floats, 3);
    __m512d low = _mm512_unpacklo_pd(r0, r1), low2 = _mm512_unpacklo_pd(r2, r3);
    point[0] = _mm512_permutex2var_pd(low, first, low2);
    point[1] =
        _mm512_permutex2var_pd(_mm512_unpackhi_pd(r0, r1), first, _mm512_unpackhi_pd(r2, r3));
    point[2] = _mm512_permutex2var_pd(low, second, low2);
}

#elif SC_LANES_AVX2 || SC_LANES_QUADS

/* In registers of four or two doubles. SC_DOUBLES_MAP applies f to each of a, and of b. */
#  undef SC_DOUBLES_OF
#  undef SC_DOUBLES_MAP
#  if SC_LANES_AVX2
#    define SC_DOUBLES_OF(name) _mm256_##name
#    define SC_DOUBLES_MAP(f)                                                                      \
      doubles r;                                                                                   \
      r.p0 = f(p0);                                                                                \
      r.p1 = f(p1);                                                                                \
      return r
typedef struct doubles {
    __m256d p0, p1;
} doubles;
#  else
#    define SC_DOUBLES_OF(name) SC_QUAD(name)
#    define SC_DOUBLES_MAP(f)                                                                      \
      doubles r;                                                                                   \
      r.p0 = f(p0);                                                                                \
      r.p1 = f(p1);                                                                                \
      r.p2 = f(p2);                                                                                \
      r.p3 = f(p3);                                                                                \
      return r
typedef struct doubles {
    sc_doubles2 p0, p1, p2, p3;
} doubles;
#  endif
typedef doubles doubles_mask;

static inline doubles doubles_all(double d)
{
#  define SC_DOUBLES_ONE(p) SC_DOUBLES_OF(set1_pd)(d)
    SC_DOUBLES_MAP(SC_DOUBLES_ONE);
#  undef SC_DOUBLES_ONE
}
#  if SC_LANES_AVX2
static inline doubles doubles_load(const double *d)
{
    doubles r;
    r.p0 = _mm256_loadu_pd(d);
    r.p1 = _mm256_loadu_pd(d + 4);
    return r;
}
static inline void doubles_store(double *d, doubles a)
{
    _mm256_storeu_pd(d, a.p0);
    _mm256_storeu_pd(d + 4, a.p1);
}
#  else
static inline doubles doubles_load(const double *d)
{
    doubles r;
    r.p0 = SC_QUAD(loadu_pd)(d);
    r.p1 = SC_QUAD(loadu_pd)(d + 2);
    r.p2 = SC_QUAD(loadu_pd)(d + 4);
    r.p3 = SC_QUAD(loadu_pd)(d + 6);
    return r;
}
static inline void doubles_store(double *d, doubles a)
{
    SC_QUAD(storeu_pd)(d, a.p0);
    SC_QUAD(storeu_pd)(d + 2, a.p1);
    SC_QUAD(storeu_pd)(d + 4, a.p2);
    SC_QUAD(storeu_pd)(d + 6, a.p3);
}
#  endif
static inline doubles doubles_add(doubles a, doubles b)
{
#  define SC_DOUBLES_ONE(p) SC_DOUBLES_OF(add_pd)(a.p, b.p)
    SC_DOUBLES_MAP(SC_DOUBLES_ONE);
#  undef SC_DOUBLES_ONE
}
static inline doubles doubles_subtract(doubles a, doubles b)
{
#  define SC_DOUBLES_ONE(p) SC_DOUBLES_OF(sub_pd)(a.p, b.p)
    SC_DOUBLES_MAP(SC_DOUBLES_ONE);
#  undef SC_DOUBLES_ONE
}
static inline doubles doubles_multiply(doubles a, doubles b)
{
#  define SC_DOUBLES_ONE(p) SC_DOUBLES_OF(mul_pd)(a.p, b.p)
    SC_DOUBLES_MAP(SC_DOUBLES_ONE);
#  undef SC_DOUBLES_ONE
}
static inline doubles doubles_smaller(doubles a, doubles b)
{
#  define SC_DOUBLES_ONE(p) SC_DOUBLES_OF(min_pd)(a.p, b.p)
    SC_DOUBLES_MAP(SC_DOUBLES_ONE);
#  undef SC_DOUBLES_ONE
}
static inline doubles doubles_larger(doubles a, doubles b)
{
#  define SC_DOUBLES_ONE(p) SC_DOUBLES_OF(max_pd)(a.p, b.p)
    SC_DOUBLES_MAP(SC_DOUBLES_ONE);
#  undef SC_DOUBLES_ONE
}
static inline doubles doubles_absolute(doubles a)
{
#  define SC_DOUBLES_ONE(p) SC_DOUBLES_OF(andnot_pd)(SC_DOUBLES_OF(set1_pd)(-0.0), a.p)
    SC_DOUBLES_MAP(SC_DOUBLES_ONE);
#  undef SC_DOUBLES_ONE
}

static inline doubles_mask doubles_both(doubles_mask a, doubles_mask b)
{
#  define SC_DOUBLES_ONE(p) SC_DOUBLES_OF(and_pd)(a.p, b.p)
    SC_DOUBLES_MAP(SC_DOUBLES_ONE);
#  undef SC_DOUBLES_ONE
}
static inline doubles_mask doubles_either(doubles_mask a, doubles_mask b)
{
#  define SC_DOUBLES_ONE(p) SC_DOUBLES_OF(or_pd)(a.p, b.p)
    SC_DOUBLES_MAP(SC_DOUBLES_ONE);
#  undef SC_DOUBLES_ONE
}

#  if SC_LANES_AVX2

static inline doubles_mask doubles_below(doubles a, doubles b)
{
#    define SC_DOUBLES_ONE(p) _mm256_cmp_pd(a.p, b.p, _CMP_LT_OQ)
    SC_DOUBLES_MAP(SC_DOUBLES_ONE);
#    undef SC_DOUBLES_ONE
}
static inline doubles_mask doubles_equal(doubles a, doubles b)
{
#    define SC_DOUBLES_ONE(p) _mm256_cmp_pd(a.p, b.p, _CMP_EQ_OQ)
    SC_DOUBLES_MAP(SC_DOUBLES_ONE);
#    undef SC_DOUBLES_ONE
}
static inline unsigned doubles_bits(doubles_mask a)
{
    return (unsigned)_mm256_movemask_pd(a.p0) | (unsigned)_mm256_movemask_pd(a.p1) << 4;
}
static inline unsigned doubles_signs(doubles a)
{
    return doubles_bits(a);
}
static inline doubles doubles_choose(doubles_mask m, doubles a, doubles b)
{
#    define SC_DOUBLES_ONE(p) _mm256_blendv_pd(b.p, a.p, m.p)
    SC_DOUBLES_MAP(SC_DOUBLES_ONE);
#    undef SC_DOUBLES_ONE
}
static SC_INLINE __m256d doubles_point(const void *at, int floats)
{
    return floats
               ? _mm256_cvtps_pd(_mm_maskload_ps((const float *)at, _mm_setr_epi32(-1, -1, -1, 0)))
               : _mm256_maskload_pd((const double *)at, _mm256_setr_epi64x(-1, -1, -1, 0));
}
static SC_INLINE void doubles_transpose(const unsigned char *const at[4], int floats, __m256d *x,
                                        __m256d *y, __m256d *z)
{
    __m256d a = doubles_point(at[0], floats);
    __m256d b = doubles_point(at[1], floats);
    __m256d c = doubles_point(at[2], floats);
    __m256d d = doubles_point(at[3], floats);
    __m256d low = _mm256_unpacklo_pd(a, b), low2 = _mm256_unpacklo_pd(c, d);
    *x = _mm256_permute2f128_pd(low, low2, 0x20);
    *y = _mm256_permute2f128_pd(_mm256_unpackhi_pd(a, b), _mm256_unpackhi_pd(c, d), 0x20);
    *z = _mm256_permute2f128_pd(low, low2, 0x31);
}
static SC_INLINE void doubles_points(const unsigned char *const at[8], int floats, doubles point[3])
{
    doubles_transpose(at, floats, &point[0].p0, &point[1].p0, &point[2].p0);
    doubles_transpose(at + 4, floats, &point[0].p1, &point[1].p1, &point[2].p1);
}

#  else

static inline doubles_mask doubles_below(doubles a, doubles b)
{
#    define SC_DOUBLES_ONE(p) SC_QUAD(cmplt_pd)(a.p, b.p)
    SC_DOUBLES_MAP(SC_DOUBLES_ONE);
#    undef SC_DOUBLES_ONE
}
static inline doubles_mask doubles_equal(doubles a, doubles b)
{
#    define SC_DOUBLES_ONE(p) SC_QUAD(cmpeq_pd)(a.p, b.p)
    SC_DOUBLES_MAP(SC_DOUBLES_ONE);
#    undef SC_DOUBLES_ONE
}
static inline unsigned doubles_bits(doubles_mask a)
{
    return sc_quad_bits_doubles(a.p0, a.p1, a.p2, a.p3);
}
static inline unsigned doubles_signs(doubles a)
{
    return sc_quad_signs_doubles(a.p0, a.p1, a.p2, a.p3);
}
static inline doubles doubles_choose(doubles_mask m, doubles a, doubles b)
{
#    define SC_DOUBLES_ONE(p)                                                                      \
      SC_QUAD(or_pd)(SC_QUAD(and_pd)(m.p, a.p), SC_QUAD(andnot_pd)(m.p, b.p))
    SC_DOUBLES_MAP(SC_DOUBLES_ONE);
#    undef SC_DOUBLES_ONE
}
static SC_INLINE void doubles_transpose(const unsigned char *const at[2], int floats,
                                        sc_doubles2 *x, sc_doubles2 *y, sc_doubles2 *z)
{
    double p[3], q[3];
    doubles_point(at[0], floats, p);
    doubles_point(at[1], floats, q);
    *x = SC_QUAD(setr_pd)(p[0], q[0]);
    *y = SC_QUAD(setr_pd)(p[1], q[1]);
    *z = SC_QUAD(setr_pd)(p[2], q[2]);
}
static SC_INLINE void doubles_points(const unsigned char *const at[8], int floats, doubles point[3])
{
    doubles_transpose(at, floats, &point[0].p0, &point[1].p0, &point[2].p0);
    doubles_transpose(at + 2, floats, &point[0].p1, &point[1].p1, &point[2].p1);
    doubles_transpose(at + 4, floats, &point[0].p2, &point[1].p2, &point[2].p2);
    doubles_transpose(at + 6, floats, &point[0].p3, &point[1].p3, &point[2].p3);
}

#  endif

#else

typedef struct doubles {
    double v[8];
} doubles;
typedef unsigned doubles_mask;

#  undef SC_DOUBLES_EACH
#  define SC_DOUBLES_EACH(expression)                                                              \
    doubles r;                                                                                     \
    int i;                                                                                         \
    for (i = 0; i < 8; i++) r.v[i] = (expression);                                                 \
    return r

static inline doubles doubles_all(double d)
{
    SC_DOUBLES_EACH(d);
}
static inline doubles doubles_load(const double *d)
{
    SC_DOUBLES_EACH(d[i]);
}
static inline void doubles_store(double *d, doubles a)
{
    int i;
    for (i = 0; i < 8; i++) d[i] = a.v[i];
}
static inline doubles doubles_add(doubles a, doubles b)
{
    SC_DOUBLES_EACH(a.v[i] + b.v[i]);
}
static inline doubles doubles_subtract(doubles a, doubles b)
{
    SC_DOUBLES_EACH(a.v[i] - b.v[i]);
}
static inline doubles doubles_multiply(doubles a, doubles b)
{
    SC_DOUBLES_EACH(a.v[i] * b.v[i]);
}
/* as x86 has them: the second operand if one is NaN */
static inline doubles doubles_smaller(doubles a, doubles b)
{
    SC_DOUBLES_EACH(a.v[i] < b.v[i] ? a.v[i] : b.v[i]);
}
static inline doubles doubles_larger(doubles a, doubles b)
{
    SC_DOUBLES_EACH(a.v[i] > b.v[i] ? a.v[i] : b.v[i]);
}
static inline doubles doubles_absolute(doubles a)
{
    SC_DOUBLES_EACH(fabs(a.v[i]));
}
static inline doubles_mask doubles_below(doubles a, doubles b)
{
    unsigned mask = 0, i;
    for (i = 0; i < 8; i++) mask |= (unsigned)(a.v[i] < b.v[i]) << i;
    return mask;
}
static inline doubles_mask doubles_equal(doubles a, doubles b)
{
    unsigned mask = 0, i;
    for (i = 0; i < 8; i++) mask |= (unsigned)(a.v[i] == b.v[i]) << i;
    return mask;
}
static inline doubles_mask doubles_both(doubles_mask a, doubles_mask b)
{
    return a & b;
}
static inline doubles_mask doubles_either(doubles_mask a, doubles_mask b)
{
    return a | b;
}
static inline unsigned doubles_bits(doubles_mask a)
{
    return a;
}
static inline unsigned doubles_signs(doubles a)
{
    unsigned mask = 0, i;
    uint64_t bits[8];
    memcpy(bits, a.v, sizeof bits);
    for (i = 0; i < 8; i++) mask |= (unsigned)(bits[i] >> 63) << i;
    return mask;
}
static inline doubles doubles_choose(doubles_mask m, doubles a, doubles b)
{
    SC_DOUBLES_EACH(m >> i & 1u ? a.v[i] : b.v[i]);
}
static SC_INLINE void doubles_points(const unsigned char *const at[8], int floats, doubles point[3])
{
    int i, c;
    for (i = 0; i < 8; i++) {
        double p[3];
        doubles_point(at[i], floats, p);
        for (c = 0; c < 3; c++) point[c].v[i] = p[c];
    }
}

#endif

#if !SC_LANES_AVX512
static inline doubles doubles_larger_size(doubles a, doubles b)
{
    return doubles_larger(doubles_absolute(a), doubles_absolute(b));
}
static inline doubles doubles_smaller_size(doubles a, doubles b)
{
    return doubles_smaller(doubles_absolute(a), doubles_absolute(b));
}
static inline unsigned doubles_differ(doubles a, doubles b)
{
    return doubles_signs(a) ^ doubles_signs(b);
}
static inline unsigned doubles_differ3(doubles a, doubles b, doubles c)
{
    return doubles_differ(a, b) | doubles_differ(a, c);
}
#endif
