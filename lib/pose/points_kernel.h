/*
 * Points of the pose in the unit box, sixteen at a time, straight from the caller's array. See
 * positions.h.
 *
 * SPDX-License-Identifier: MIT
 *
 * points_of writes sixteen points, each as four floats of which the last is 0, in transposed places
 * (see build/loops.h), as lanes_coordinates reads them. The bits are those of sc_positions_unit: a
 * double has more than twice the digits of a float, so that floats may be subtracted without
 * becoming doubles.
 *
 * Four coordinates of a vertex may be read, the fourth only to be dropped. The last vertex may be
 * the last thing in the caller's memory: it is left to points_one_by_one, and so are poses that are
 * too small or too large for floats.
 */

static void points_one_by_one(const sc_frame *frame, const uint32_t *point, float *each)
{
    int i;
    memset(each, 0, 4 * SC_LANES_COUNT * sizeof *each);
    for (i = 0; i < SC_LANES_COUNT; i++)
        sc_positions_unit(frame, point[i], each + 16 * (i % 4) + i / 4 * 4);
}

#if SC_LANES_AVX512

/* What points_of has in registers throughout a loop: where positions are, and how they get into the
   unit box. */
typedef struct point_reader {
    const unsigned char *from;
    __m512d center;
    __m512 float_center, scale;
} point_reader;

static SC_INLINE point_reader point_reader_of(const sc_frame *frame)
{
    point_reader f;
    f.from = frame->positions[0].at;
    f.center = _mm512_broadcast_f64x4(
        _mm256_set_pd(0, frame->center[2], frame->center[1], frame->center[0]));
    f.float_center = _mm512_broadcast_f32x4(_mm256_cvtpd_ps(_mm512_castpd512_pd256(f.center)));
    f.scale = _mm512_set1_ps((float)frame->scale);
    return f;
}

static SC_INLINE __m128 points_float(const unsigned char *p)
{
    return _mm_loadu_ps((const float *)(const void *)p);
}

/* Two vertices of doubles, moved and rounded. */
static SC_INLINE __m256 points_two(const point_reader *f, const unsigned char *p,
                                   const unsigned char *q)
{
    __m512d d =
        _mm512_insertf64x4(_mm512_castpd256_pd512(_mm256_loadu_pd((const double *)(const void *)p)),
                           _mm256_loadu_pd((const double *)(const void *)q), 1);
    return _mm512_cvtpd_ps(_mm512_maskz_sub_pd(0x77, d, f->center));
}

static SC_INLINE void points_of(const point_reader *f, const uint32_t *point, int is_double,
                                uint64_t stride, float *each)
{
    int i;
    SC_UNROLL
    for (i = 0; i < 4; i++) {
        const unsigned char *a = f->from + point[i] * stride, *b = f->from + point[i + 4] * stride;
        const unsigned char *c = f->from + point[i + 8] * stride;
        const unsigned char *d = f->from + point[i + 12] * stride;
        __m512 r;
        if (is_double) {
            r = _mm512_insertf32x8(_mm512_castps256_ps512(points_two(f, a, b)), points_two(f, c, d),
                                   1);
        } else {
            r = _mm512_castps128_ps512(points_float(a));
            r = _mm512_insertf32x4(r, points_float(b), 1);
            r = _mm512_insertf32x4(r, points_float(c), 2);
            r = _mm512_insertf32x4(r, points_float(d), 3);
            r = _mm512_maskz_sub_ps(0x7777, r, f->float_center);
        }
        _mm512_storeu_ps(each + 16 * i, _mm512_mul_ps(r, f->scale));
    }
}

#elif SC_LANES_AVX2

typedef struct point_reader {
    const unsigned char *from;
    __m256d center;
    __m256 float_center, scale;
} point_reader;

static SC_INLINE point_reader point_reader_of(const sc_frame *frame)
{
    point_reader f;
    f.from = frame->positions[0].at;
    f.center = _mm256_set_pd(0, frame->center[2], frame->center[1], frame->center[0]);
    f.float_center = _mm256_set_m128(_mm256_cvtpd_ps(f.center), _mm256_cvtpd_ps(f.center));
    f.scale = _mm256_set1_ps((float)frame->scale);
    return f;
}

/* A vertex, of doubles moved and rounded. */
static SC_INLINE __m128 points_one(const point_reader *f, const unsigned char *p, int is_double)
{
    if (!is_double) return _mm_loadu_ps((const float *)(const void *)p);
    return _mm256_cvtpd_ps(_mm256_sub_pd(
        _mm256_maskload_pd((const double *)(const void *)p, _mm256_set_epi64x(0, -1, -1, -1)),
        f->center));
}

static SC_INLINE void points_of(const point_reader *f, const uint32_t *point, int is_double,
                                uint64_t stride, float *each)
{
    const __m256 three = _mm256_castsi256_ps(_mm256_set_epi32(0, -1, -1, -1, 0, -1, -1, -1));
    int i;
    SC_UNROLL
    for (i = 0; i < 8; i++) {
        const uint32_t *at = point + i % 4 + i / 4 * 8;
        __m128 a = points_one(f, f->from + at[0] * stride, is_double);
        __m128 b = points_one(f, f->from + at[4] * stride, is_double);
        __m256 r = _mm256_set_m128(b, a);
        if (!is_double) r = _mm256_sub_ps(_mm256_and_ps(r, three), f->float_center);
        _mm256_storeu_ps(each + 16 * (i % 4) + 8 * (i / 4), _mm256_mul_ps(r, f->scale));
    }
}

#elif SC_LANES_QUADS

typedef struct point_reader {
    const unsigned char *from;
    sc_doubles2 center[2];
    sc_floats4 float_center, scale, three;
} point_reader;

static SC_INLINE point_reader point_reader_of(const sc_frame *frame)
{
    const uint32_t bits[4] = {~(uint32_t)0, ~(uint32_t)0, ~(uint32_t)0, 0};
    point_reader f;
    f.from = frame->positions[0].at;
    f.center[0] = SC_QUAD(setr_pd)(frame->center[0], frame->center[1]);
    f.center[1] = SC_QUAD(set1_pd)(frame->center[2]);
    f.float_center = sc_quad_rounded(f.center[0], SC_QUAD(setr_pd)(frame->center[2], 0));
    f.scale = SC_QUAD(set1_ps)((float)frame->scale);
    memcpy(&f.three, bits, sizeof f.three);
    return f;
}

static SC_INLINE double points_one(const unsigned char *p)
{
    double d; /* at any address */
    memcpy(&d, p, sizeof d);
    return d;
}

static SC_INLINE void points_of(const point_reader *f, const uint32_t *point, int is_double,
                                uint64_t stride, float *each)
{
    int i;
    SC_UNROLL
    for (i = 0; i < 8; i++) { /* two points */
        const unsigned char *p = f->from + point[2 * i] * stride;
        const unsigned char *q = f->from + point[2 * i + 1] * stride;
        float *to = each + 32 * (i % 2) + 4 * (i / 2);
        sc_floats4 a, b;
        if (is_double) {
            sc_doubles2 x =
                SC_QUAD(sub_pd)(SC_QUAD(loadu_pd)((const double *)(const void *)p), f->center[0]);
            sc_doubles2 y =
                SC_QUAD(sub_pd)(SC_QUAD(loadu_pd)((const double *)(const void *)q), f->center[0]);
            sc_doubles2 z = SC_QUAD(sub_pd)(
                SC_QUAD(setr_pd)(points_one(p + 16), points_one(q + 16)), f->center[1]);
            sc_floats4 xy = sc_quad_rounded(x, y), zz = sc_quad_rounded_two(z);
            a = SC_QUAD_SHUFFLE(xy, zz, 0, 1, 0, 2);
            b = SC_QUAD_SHUFFLE(xy, zz, 2, 3, 1, 2);
        } else {
            a = SC_QUAD(loadu_ps)((const float *)(const void *)p);
            b = SC_QUAD(loadu_ps)((const float *)(const void *)q);
            a = SC_QUAD(sub_ps)(SC_QUAD(and_ps)(a, f->three), f->float_center);
            b = SC_QUAD(sub_ps)(SC_QUAD(and_ps)(b, f->three), f->float_center);
        }
        SC_QUAD(storeu_ps)(to, SC_QUAD(mul_ps)(a, f->scale));
        SC_QUAD(storeu_ps)(to + 16, SC_QUAD(mul_ps)(b, f->scale));
    }
}

#endif

#if SC_LANES_AVX512 || SC_LANES_AVX2 || SC_LANES_QUADS

/* Whether the last vertex is among sixteen points, and four coordinates of each are read. */
static SC_INLINE int points_have(const uint32_t *point, lanes last, int is_double)
{
    if (is_double && !SC_LANES_AVX512) return 0;
    return lanes_bits(lanes_same(lanes_load((const float *)(const void *)point), last)) != 0;
}

/* The number of the last vertex in each lane, bit by bit. */
static SC_INLINE lanes points_last(const sc_frame *frame)
{
    float last;
    memcpy(&last, &frame->positions[0].last, sizeof last);
    return lanes_all(last);
}

#else

typedef const sc_frame *point_reader;

static SC_INLINE point_reader point_reader_of(const sc_frame *frame)
{
    return frame;
}

static SC_INLINE void points_of(const point_reader *f, const uint32_t *point, int is_double,
                                uint64_t stride, float *each)
{
    (void)is_double;
    (void)stride;
    points_one_by_one(*f, point, each);
}

static SC_INLINE int points_have(const uint32_t *point, lanes last, int is_double)
{
    (void)point;
    (void)last;
    (void)is_double;
    return 0;
}

static SC_INLINE lanes points_last(const sc_frame *frame)
{
    (void)frame;
    return lanes_all(0);
}

#endif

/* Sixteen points: at gets their x, then y, then z. */
static inline void load_points(const sc_frame *frame, const uint32_t *point, float *at)
{
    const point_reader f = point_reader_of(frame);
    const int is_double = frame->positions[0].type == SC_DOUBLE;
    float each[4 * SC_LANES_COUNT];
    lanes row[3];
    int k;
    if (!frame->fits_float || points_have(point, points_last(frame), is_double))
        points_one_by_one(frame, point, each);
    else if (is_double)
        points_of(&f, point, 1, frame->positions[0].stride, each);
    else
        points_of(&f, point, 0, frame->positions[0].stride, each);
    lanes_coordinates(each, row);
    SC_UNROLL
    for (k = 0; k < 3; k++) lanes_store(at + SC_LANES_COUNT * k, row[k]);
}
