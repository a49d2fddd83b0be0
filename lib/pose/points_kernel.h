/*
 * Points of the pose in the unit box, sixteen at a time, straight from the caller's array; and the box of that
 * array. See positions.h.
 *
 * SPDX-License-Identifier: MIT
 *
 * A coordinate is moved by the center and scaled in double precision, then rounded to float. Nothing is read beyond
 * the three coordinates of a vertex, which may be the last thing in the caller's memory.
 */

#if SC_LANES_AVX512

/* Two vertices, at p and q, of doubles or floats. */
static inline __m256 SC_KERNEL(sc_points_two)(const unsigned char *p, const unsigned char *q,
                                              int is_double, __m512d center, __m512d scale)
{
    __m512d d;
    if (is_double)
        d = _mm512_insertf64x4(_mm512_castpd256_pd512(_mm256_maskz_loadu_pd(7, p)),
                               _mm256_maskz_loadu_pd(7, q), 1);
    else
        d = _mm512_cvtps_pd(_mm256_insertf128_ps(_mm256_castps128_ps256(_mm_maskz_loadu_ps(7, p)),
                                                 _mm_maskz_loadu_ps(7, q), 1));
    return _mm512_cvtpd_ps(_mm512_mul_pd(_mm512_sub_pd(d, center), scale));
}

static inline void SC_KERNEL(sc_points_load)(const sc_workspace *w, const uint32_t *point,
                                             float *at, int is_double, uint64_t stride)
{
    const unsigned char *from = w->positions;
    const __m512d scale = _mm512_set1_pd(w->scale);
    const __m512d center =
        _mm512_broadcast_f64x4(_mm256_set_pd(0, w->center[2], w->center[1], w->center[0]));
    __m512 r[4], low, low2;
    int i;
    SC_UNROLL
    for (i = 0; i < 4; i++)
        r[i] = _mm512_insertf32x8(
            _mm512_castps256_ps512(SC_KERNEL(sc_points_two)(
                from + point[i] * stride, from + point[i + 4] * stride, is_double, center, scale)),
            SC_KERNEL(sc_points_two)(from + point[i + 8] * stride, from + point[i + 12] * stride,
                                     is_double, center, scale),
            1);
    low = _mm512_unpacklo_ps(r[0], r[1]);
    low2 = _mm512_unpacklo_ps(r[2], r[3]);
    _mm512_storeu_ps(at, _mm512_shuffle_ps(low, low2, 0x44));
    _mm512_storeu_ps(at + 16, _mm512_shuffle_ps(low, low2, 0xee));
    _mm512_storeu_ps(at + 32, _mm512_shuffle_ps(_mm512_unpackhi_ps(r[0], r[1]),
                                                _mm512_unpackhi_ps(r[2], r[3]), 0x44));
}

#elif SC_LANES_AVX2 || SC_LANES_SSE2

#  if SC_LANES_AVX2
static inline __m128 SC_KERNEL(sc_points_one)(const sc_workspace *w, const unsigned char *p,
                                              int is_double)
{
    const __m256d center = _mm256_set_pd(0, w->center[2], w->center[1], w->center[0]);
    __m256d d;
    if (is_double)
        d = _mm256_maskload_pd((const double *)(const void *)p, _mm256_set_epi64x(0, -1, -1, -1));
    else
        d = _mm256_cvtps_pd(
            _mm_maskload_ps((const float *)(const void *)p, _mm_set_epi32(0, -1, -1, -1)));
    return _mm256_cvtpd_ps(_mm256_mul_pd(_mm256_sub_pd(d, center), _mm256_set1_pd(w->scale)));
}
#  else
static inline __m128 SC_KERNEL(sc_points_one)(const sc_workspace *w, const unsigned char *p,
                                              int is_double)
{
    const __m128d scale = _mm_set1_pd(w->scale);
    __m128d xy, z;
    if (is_double) {
        xy = _mm_loadu_pd((const double *)(const void *)p);
        z = _mm_castsi128_pd(_mm_loadl_epi64((const __m128i *)(const void *)(p + 16)));
    } else {
        float last; /* at any address */
        memcpy(&last, p + 8, sizeof last);
        xy = _mm_cvtps_pd(_mm_castsi128_ps(_mm_loadl_epi64((const __m128i *)(const void *)p)));
        z = _mm_cvtps_pd(_mm_set_ss(last));
    }
    xy = _mm_mul_pd(_mm_sub_pd(xy, _mm_set_pd(w->center[1], w->center[0])), scale);
    z = _mm_mul_pd(_mm_sub_pd(z, _mm_set_pd(0, w->center[2])), scale);
    return _mm_movelh_ps(_mm_cvtpd_ps(xy), _mm_cvtpd_ps(z));
}
#  endif

static inline void SC_KERNEL(sc_points_load)(const sc_workspace *w, const uint32_t *point,
                                             float *at, int is_double, uint64_t stride)
{
    int i;
    SC_UNROLL
    for (i = 0; i < 16; i += 4) {
        __m128 x = SC_KERNEL(sc_points_one)(w, w->positions + point[i] * stride, is_double);
        __m128 y = SC_KERNEL(sc_points_one)(w, w->positions + point[i + 1] * stride, is_double);
        __m128 z = SC_KERNEL(sc_points_one)(w, w->positions + point[i + 2] * stride, is_double);
        __m128 rest = SC_KERNEL(sc_points_one)(w, w->positions + point[i + 3] * stride, is_double);
        _MM_TRANSPOSE4_PS(x, y, z, rest);
        _mm_storeu_ps(at + i, x);
        _mm_storeu_ps(at + 16 + i, y);
        _mm_storeu_ps(at + 32 + i, z);
    }
}

#else

static inline void SC_KERNEL(sc_points_load)(const sc_workspace *w, const uint32_t *point,
                                             float *at, int is_double, uint64_t stride)
{
    int i, k;
    (void)is_double;
    (void)stride;
    for (i = 0; i < 16; i++) {
        float unit[3];
        sc_positions_unit(w, point[i], unit);
        for (k = 0; k < 3; k++) at[16 * k + i] = unit[k];
    }
}

#endif

/* Sixteen points: at gets their x, then y, then z. */
static void SC_KERNEL(load_points)(const sc_workspace *w, const uint32_t *point, float *at)
{
    if (w->position_type == SC_DOUBLE)
        if (w->stride == 3 * sizeof(double))
            SC_KERNEL(sc_points_load)(w, point, at, 1, 3 * sizeof(double));
        else
            SC_KERNEL(sc_points_load)(w, point, at, 1, w->stride);
    else if (w->stride == 3 * sizeof(float))
        SC_KERNEL(sc_points_load)(w, point, at, 0, 3 * sizeof(float));
    else
        SC_KERNEL(sc_points_load)(w, point, at, 0, w->stride);
}
