/*
 * Points of the pose in the unit box, sixteen at a time, straight from the caller's array; and the box of that
 * array. See positions.h.
 *
 * SPDX-License-Identifier: MIT
 *
 * A coordinate is moved by the center and scaled in double precision, then rounded to float. Nothing is read beyond
 * the three coordinates of a vertex, which may be the last thing in the caller's memory.
 *
 * points_of gives sixteen points as x, y and z; and, unless each is NULL, point by point as four floats, the last of which
 * is 0: points 0, 4, 8, 12, 1, 5 and so on (see build/loops.h).
 */

#if SC_LANES_AVX512

/* What points_of has in registers throughout a loop: where positions are, and how they get into the unit box. */
typedef struct SC_KERNEL(points_frame) {
    const unsigned char *from;
    __m512d center, scale;
} SC_KERNEL(points_frame);

static SC_INLINE SC_KERNEL(points_frame) SC_KERNEL(points_frame_of)(const sc_workspace *w)
{
    SC_KERNEL(points_frame) f;
    f.from = w->positions;
    f.center = _mm512_broadcast_f64x4(_mm256_set_pd(0, w->center[2], w->center[1], w->center[0]));
    f.scale = _mm512_set1_pd(w->scale);
    return f;
}

/* Two vertices, at p and q, of doubles or floats. */
static SC_INLINE __m256 SC_KERNEL(sc_points_two)(const SC_KERNEL(points_frame) * f,
                                                 const unsigned char *p, const unsigned char *q,
                                                 int is_double)
{
    __m512d d;
    if (is_double)
        d = _mm512_insertf64x4(_mm512_castpd256_pd512(_mm256_maskz_loadu_pd(7, p)),
                               _mm256_maskz_loadu_pd(7, q), 1);
    else
        d = _mm512_cvtps_pd(_mm256_insertf128_ps(_mm256_castps128_ps256(_mm_maskz_loadu_ps(7, p)),
                                                 _mm_maskz_loadu_ps(7, q), 1));
    return _mm512_cvtpd_ps(_mm512_mul_pd(_mm512_sub_pd(d, f->center), f->scale));
}

static SC_INLINE void SC_KERNEL(points_of)(const SC_KERNEL(points_frame) * f, const uint32_t *point,
                                           int is_double, uint64_t stride, lanes at[3], float *each)
{
    const unsigned char *from = f->from;
    __m512 r[4], low, low2;
    int i;
    SC_UNROLL
    for (i = 0; i < 4; i++)
        r[i] = _mm512_insertf32x8(
            _mm512_castps256_ps512(SC_KERNEL(sc_points_two)(
                f, from + point[i] * stride, from + point[i + 4] * stride, is_double)),
            SC_KERNEL(sc_points_two)(f, from + point[i + 8] * stride, from + point[i + 12] * stride,
                                     is_double),
            1);
    if (each) {
        SC_UNROLL
        for (i = 0; i < 4; i++) _mm512_storeu_ps(each + 16 * i, r[i]);
    }
    low = _mm512_unpacklo_ps(r[0], r[1]);
    low2 = _mm512_unpacklo_ps(r[2], r[3]);
    at[0] = _mm512_shuffle_ps(low, low2, 0x44);
    at[1] = _mm512_shuffle_ps(low, low2, 0xee);
    at[2] = _mm512_shuffle_ps(_mm512_unpackhi_ps(r[0], r[1]), _mm512_unpackhi_ps(r[2], r[3]), 0x44);
}

#elif SC_LANES_AVX2

typedef struct SC_KERNEL(points_frame) {
    const unsigned char *from;
    __m256d center, scale;
} SC_KERNEL(points_frame);

static SC_INLINE SC_KERNEL(points_frame) SC_KERNEL(points_frame_of)(const sc_workspace *w)
{
    SC_KERNEL(points_frame) f;
    f.from = w->positions;
    f.center = _mm256_set_pd(0, w->center[2], w->center[1], w->center[0]);
    f.scale = _mm256_set1_pd(w->scale);
    return f;
}

static SC_INLINE __m128 SC_KERNEL(sc_points_one)(const SC_KERNEL(points_frame) * f,
                                                 const unsigned char *p, int is_double)
{
    __m256d d;
    if (is_double)
        d = _mm256_maskload_pd((const double *)(const void *)p, _mm256_set_epi64x(0, -1, -1, -1));
    else
        d = _mm256_cvtps_pd(
            _mm_maskload_ps((const float *)(const void *)p, _mm_set_epi32(0, -1, -1, -1)));
    return _mm256_cvtpd_ps(_mm256_mul_pd(_mm256_sub_pd(d, f->center), f->scale));
}

static SC_INLINE void SC_KERNEL(points_of)(const SC_KERNEL(points_frame) * f, const uint32_t *point,
                                           int is_double, uint64_t stride, lanes at[3], float *each)
{
    __m128 r[3][4];
    int i;
    SC_UNROLL
    for (i = 0; i < 4; i++, point += 4) {
        __m128 x = SC_KERNEL(sc_points_one)(f, f->from + point[0] * stride, is_double);
        __m128 y = SC_KERNEL(sc_points_one)(f, f->from + point[1] * stride, is_double);
        __m128 z = SC_KERNEL(sc_points_one)(f, f->from + point[2] * stride, is_double);
        __m128 rest = SC_KERNEL(sc_points_one)(f, f->from + point[3] * stride, is_double);
        if (each) {
            _mm_storeu_ps(each + 4 * i, x);
            _mm_storeu_ps(each + 16 + 4 * i, y);
            _mm_storeu_ps(each + 32 + 4 * i, z);
            _mm_storeu_ps(each + 48 + 4 * i, rest);
        }
        _MM_TRANSPOSE4_PS(x, y, z, rest);
        r[0][i] = x;
        r[1][i] = y;
        r[2][i] = z;
    }
    SC_UNROLL
    for (i = 0; i < 3; i++) {
        at[i].v[0] = _mm256_set_m128(r[i][1], r[i][0]);
        at[i].v[1] = _mm256_set_m128(r[i][3], r[i][2]);
    }
}

#elif SC_LANES_QUADS

typedef struct SC_KERNEL(points_frame) {
    const unsigned char *from;
    sc_doubles2 center[3], scale;
} SC_KERNEL(points_frame);

static SC_INLINE SC_KERNEL(points_frame) SC_KERNEL(points_frame_of)(const sc_workspace *w)
{
    SC_KERNEL(points_frame) f;
    int k;
    f.from = w->positions;
    f.scale = SC_QUAD(set1_pd)(w->scale);
    for (k = 0; k < 3; k++) f.center[k] = SC_QUAD(set1_pd)(w->center[k]);
    return f;
}

static SC_INLINE double SC_KERNEL(sc_points_one)(const unsigned char *p, int is_double)
{
    double d;
    float f; /* at any address */
    if (is_double) {
        memcpy(&d, p, sizeof d);
        return d;
    }
    memcpy(&f, p, sizeof f);
    return (double)f;
}

static SC_INLINE void SC_KERNEL(points_of)(const SC_KERNEL(points_frame) * f, const uint32_t *point,
                                           int is_double, uint64_t stride, lanes at[3], float *each)
{
    int i, j, k;
    SC_UNROLL
    for (i = 0; i < 4; i++) {
        sc_floats4 one[4];
        SC_UNROLL
        for (k = 0; k < 3; k++) {
            sc_doubles2 d[2];
            SC_UNROLL
            for (j = 0; j < 2; j++) {
                uint64_t p = point[4 * i + 2 * j] * stride, q = point[4 * i + 2 * j + 1] * stride;
                const unsigned char *from = f->from + (is_double ? 8 : 4) * k;
                d[j] = SC_QUAD(setr_pd)(SC_KERNEL(sc_points_one)(from + p, is_double),
                                        SC_KERNEL(sc_points_one)(from + q, is_double));
                d[j] = SC_QUAD(mul_pd)(SC_QUAD(sub_pd)(d[j], f->center[k]), f->scale);
            }
            at[k].v[i] = one[k] = sc_quad_rounded(d[0], d[1]);
        }
        if (each) {
            one[3] = SC_QUAD(set1_ps)(0);
            sc_quad_transpose(one);
            SC_UNROLL
            for (j = 0; j < 4; j++) SC_QUAD(storeu_ps)(each + 16 * j + 4 * i, one[j]);
        }
    }
}

#else

typedef const sc_workspace *SC_KERNEL(points_frame);

static SC_INLINE SC_KERNEL(points_frame) SC_KERNEL(points_frame_of)(const sc_workspace *w)
{
    return w;
}

static SC_INLINE void SC_KERNEL(points_of)(const SC_KERNEL(points_frame) * f, const uint32_t *point,
                                           int is_double, uint64_t stride, lanes at[3], float *each)
{
    float row[3][SC_LANES_COUNT], unit[4];
    int i, k;
    (void)is_double;
    (void)stride;
    for (i = 0; i < SC_LANES_COUNT; i++) {
        sc_positions_unit(*f, point[i], unit);
        unit[3] = 0;
        for (k = 0; k < 3; k++) row[k][i] = unit[k];
        if (each) memcpy(each + 16 * (i % 4) + i / 4 * 4, unit, sizeof unit);
    }
    for (k = 0; k < 3; k++) at[k] = lanes_load(row[k]);
}

#endif

/* Sixteen points: at gets their x, then y, then z. */
static inline void SC_KERNEL(load_points)(const sc_workspace *w, const uint32_t *point, float *at)
{
    const SC_KERNEL(points_frame) f = SC_KERNEL(points_frame_of)(w);
    lanes row[3];
    int k;
    if (w->position_type == SC_DOUBLE)
        SC_KERNEL(points_of)(&f, point, 1, w->stride, row, NULL);
    else
        SC_KERNEL(points_of)(&f, point, 0, w->stride, row, NULL);
    SC_UNROLL
    for (k = 0; k < 3; k++) lanes_store(at + SC_LANES_COUNT * k, row[k]);
}
