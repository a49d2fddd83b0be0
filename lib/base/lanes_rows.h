/*
 * Sixteen rows of sixteen floats each, of which one thing is found at once. For the instruction set that base/lanes.h,
 * included before, is for.
 *
 * SPDX-License-Identifier: MIT
 *
 * lanes_signs_of takes the signs of a row, and lanes_all_negative makes bit i if all of row i are set, as they are of
 * what is below 0. lanes_rows_ends makes lane i the least and the most of row i of memory, rows being `stride` floats
 * apart; none is NaN.
 *
 * No guard, as in base/lanes.h; base/lanes_rows_end.h ends it.
 */
#define lanes_signs SC_KERNEL(sc_lanes_signs)
#define lanes_signs_of SC_KERNEL(sc_lanes_signs_of)
#define lanes_all_negative SC_KERNEL(sc_lanes_all_negative)
#define lanes_rows_ends SC_KERNEL(sc_lanes_rows_ends)

/*
 * On x86-64 words, then bytes, are made of four rows, which keeps signs since it saturates: four bytes each, in each 128
 * bits. When these are joined, a row is negative if the signs of its four bytes are set.
 */
#if SC_LANES_AVX512

typedef __m512i lanes_signs;

static inline lanes_signs lanes_signs_of(lanes a)
{
    return _mm512_castps_si512(a);
}
static inline __m512i SC_KERNEL(sc_lanes_four_signs)(const lanes_signs row[4])
{
    return _mm512_packs_epi16(_mm512_packs_epi32(row[0], row[1]),
                              _mm512_packs_epi32(row[2], row[3]));
}
static inline unsigned lanes_all_negative(const lanes_signs row[16])
{
    const __m512i signs = _mm512_set1_epi8(-128);
    __m512i a = SC_KERNEL(sc_lanes_four_signs)(row), b = SC_KERNEL(sc_lanes_four_signs)(row + 4);
    __m512i c = SC_KERNEL(sc_lanes_four_signs)(row + 8),
            d = SC_KERNEL(sc_lanes_four_signs)(row + 12);
    a = _mm512_and_si512(_mm512_shuffle_i32x4(a, b, 0x44), _mm512_shuffle_i32x4(a, b, 0xee));
    c = _mm512_and_si512(_mm512_shuffle_i32x4(c, d, 0x44), _mm512_shuffle_i32x4(c, d, 0xee));
    a = _mm512_and_si512(_mm512_shuffle_i32x4(a, c, 0x88), _mm512_shuffle_i32x4(a, c, 0xdd));
    return _mm512_cmpeq_epi32_mask(_mm512_and_si512(a, signs), signs);
}

#elif SC_LANES_AVX2

typedef __m256i lanes_signs;

static inline lanes_signs lanes_signs_of(lanes a)
{
    return _mm256_castps_si256(_mm256_and_ps(a.v[0], a.v[1]));
}
static inline __m256i SC_KERNEL(sc_lanes_four_signs)(const lanes_signs row[4])
{
    return _mm256_packs_epi16(_mm256_packs_epi32(row[0], row[1]),
                              _mm256_packs_epi32(row[2], row[3]));
}
static inline unsigned SC_KERNEL(sc_lanes_eight_negative)(const lanes_signs row[8])
{
    const __m256i signs = _mm256_set1_epi8(-128);
    __m256i a = SC_KERNEL(sc_lanes_four_signs)(row), b = SC_KERNEL(sc_lanes_four_signs)(row + 4);
    a = _mm256_and_si256(_mm256_permute2x128_si256(a, b, 0x20),
                         _mm256_permute2x128_si256(a, b, 0x31));
    a = _mm256_cmpeq_epi32(_mm256_and_si256(a, signs), signs);
    return (unsigned)_mm256_movemask_ps(_mm256_castsi256_ps(a));
}
static inline unsigned lanes_all_negative(const lanes_signs row[16])
{
    return SC_KERNEL(sc_lanes_eight_negative)(row) | SC_KERNEL(sc_lanes_eight_negative)(row + 8)
                                                         << 8;
}

#elif SC_LANES_QUADS

typedef sc_floats4 lanes_signs;

static inline lanes_signs lanes_signs_of(lanes a)
{
    return SC_QUAD(and_ps)(SC_QUAD(and_ps)(a.v[0], a.v[1]), SC_QUAD(and_ps)(a.v[2], a.v[3]));
}
#  if SC_LANES_SSE2

static inline unsigned lanes_all_negative(const lanes_signs row[16])
{
    const __m128i signs = _mm_set1_epi8(-128);
    unsigned mask = 0;
    int i, k;
    SC_UNROLL
    for (i = 0; i < 16; i += 4) {
        __m128i four[4], a;
        SC_UNROLL
        for (k = 0; k < 4; k++) four[k] = _mm_castps_si128(row[i + k]);
        a = _mm_packs_epi16(_mm_packs_epi32(four[0], four[1]), _mm_packs_epi32(four[2], four[3]));
        a = _mm_cmpeq_epi32(_mm_and_si128(a, signs), signs);
        mask |= (unsigned)_mm_movemask_ps(_mm_castsi128_ps(a)) << i;
    }
    return mask;
}

#  else

static inline unsigned lanes_all_negative(const lanes_signs row[16])
{
    sc_floats4 all[4], x[4];
    int i, k;
    SC_UNROLL
    for (i = 0; i < 4; i++) {
        SC_UNROLL
        for (k = 0; k < 4; k++) x[k] = row[4 * i + k];
        sc_quad_transpose(x);
        all[i] = SC_QUAD(and_ps)(SC_QUAD(and_ps)(x[0], x[1]), SC_QUAD(and_ps)(x[2], x[3]));
        all[i] = (sc_floats4)((sc_numbers4)all[i] < 0);
    }
    return sc_quad_bits(all[0], all[1], all[2], all[3]);
}

#  endif

#else

typedef unsigned lanes_signs;

static inline lanes_signs lanes_signs_of(lanes a)
{
    return lanes_most(a) < 0;
}
static inline unsigned lanes_all_negative(const lanes_signs row[16])
{
    unsigned mask = 0, i;
    for (i = 0; i < 16; i++) mask |= row[i] << i;
    return mask;
}

#endif

/*
 * Rows are halved, two becoming one register, until each 128 bits are of one row, four rows apart; four such registers, of
 * rows that follow each other, are transposed.
 */
#define SC_LANES_TRANSPOSED(prefix, name, r, result)                                               \
  r[0] = prefix##_##name##_ps(prefix##_unpacklo_ps(r[0], r[1]), prefix##_unpackhi_ps(r[0], r[1])); \
  r[2] = prefix##_##name##_ps(prefix##_unpacklo_ps(r[2], r[3]), prefix##_unpackhi_ps(r[2], r[3])); \
  result = prefix##_##name##_ps(prefix##_shuffle_ps(r[0], r[2], 0x44),                             \
                                prefix##_shuffle_ps(r[0], r[2], 0xee))
#if SC_LANES_AVX512

static inline void lanes_rows_ends(const float *row, uint64_t stride, lanes *least, lanes *most)
{
    __m512 low[4], high[4];
    int i;
    SC_UNROLL
    for (i = 0; i < 4; i++) {
        const float *p = row + stride * (uint64_t)i;
        __m512 r0 = _mm512_loadu_ps(p), r1 = _mm512_loadu_ps(p + 4 * stride);
        __m512 r2 = _mm512_loadu_ps(p + 8 * stride), r3 = _mm512_loadu_ps(p + 12 * stride);
        __m512 a = _mm512_shuffle_f32x4(r0, r1, 0x44), b = _mm512_shuffle_f32x4(r0, r1, 0xee);
        __m512 c = _mm512_shuffle_f32x4(r2, r3, 0x44), d = _mm512_shuffle_f32x4(r2, r3, 0xee);
        __m512 ab = _mm512_min_ps(a, b), cd = _mm512_min_ps(c, d);
        low[i] =
            _mm512_min_ps(_mm512_shuffle_f32x4(ab, cd, 0x88), _mm512_shuffle_f32x4(ab, cd, 0xdd));
        ab = _mm512_max_ps(a, b), cd = _mm512_max_ps(c, d);
        high[i] =
            _mm512_max_ps(_mm512_shuffle_f32x4(ab, cd, 0x88), _mm512_shuffle_f32x4(ab, cd, 0xdd));
    }
    SC_LANES_TRANSPOSED(_mm512, min, low, *least);
    SC_LANES_TRANSPOSED(_mm512, max, high, *most);
}

#elif SC_LANES_AVX2

static inline void lanes_rows_ends(const float *row, uint64_t stride, lanes *least, lanes *most)
{
    __m256 low[4], high[4];
    int i, half;
    SC_UNROLL
    for (half = 0; half < 2; half++) {
        SC_UNROLL
        for (i = 0; i < 4; i++) {
            const float *p = row + stride * (uint64_t)(8 * half + i), *q = p + 4 * stride;
            __m256 p0 = _mm256_loadu_ps(p), p1 = _mm256_loadu_ps(p + 8);
            __m256 q0 = _mm256_loadu_ps(q), q1 = _mm256_loadu_ps(q + 8);
            __m256 a = _mm256_min_ps(p0, p1), b = _mm256_min_ps(q0, q1);
            low[i] = _mm256_min_ps(_mm256_permute2f128_ps(a, b, 0x20),
                                   _mm256_permute2f128_ps(a, b, 0x31));
            a = _mm256_max_ps(p0, p1), b = _mm256_max_ps(q0, q1);
            high[i] = _mm256_max_ps(_mm256_permute2f128_ps(a, b, 0x20),
                                    _mm256_permute2f128_ps(a, b, 0x31));
        }
        SC_LANES_TRANSPOSED(_mm256, min, low, least->v[half]);
        SC_LANES_TRANSPOSED(_mm256, max, high, most->v[half]);
    }
}

#elif SC_LANES_QUADS

static inline void lanes_rows_ends(const float *row, uint64_t stride, lanes *least, lanes *most)
{
    sc_floats4 low[4], high[4];
    int i, k;
    for (i = 0; i < 4; i++) {
        SC_UNROLL
        for (k = 0; k < 4; k++) {
            const float *p = row + stride * (uint64_t)(4 * i + k);
            sc_floats4 r0 = SC_QUAD(loadu_ps)(p), r1 = SC_QUAD(loadu_ps)(p + 4);
            sc_floats4 r2 = SC_QUAD(loadu_ps)(p + 8), r3 = SC_QUAD(loadu_ps)(p + 12);
            low[k] = SC_QUAD(min_ps)(SC_QUAD(min_ps)(r0, r1), SC_QUAD(min_ps)(r2, r3));
            high[k] = SC_QUAD(max_ps)(SC_QUAD(max_ps)(r0, r1), SC_QUAD(max_ps)(r2, r3));
        }
        sc_quad_transpose(low);
        sc_quad_transpose(high);
        least->v[i] =
            SC_QUAD(min_ps)(SC_QUAD(min_ps)(low[0], low[1]), SC_QUAD(min_ps)(low[2], low[3]));
        most->v[i] =
            SC_QUAD(max_ps)(SC_QUAD(max_ps)(high[0], high[1]), SC_QUAD(max_ps)(high[2], high[3]));
    }
}

#else

static inline void lanes_rows_ends(const float *row, uint64_t stride, lanes *least, lanes *most)
{
    int i;
    for (i = 0; i < SC_LANES_COUNT; i++, row += stride) {
        least->v[i] = lanes_least(lanes_load(row));
        most->v[i] = lanes_most(lanes_load(row));
    }
}

#endif
#undef SC_LANES_TRANSPOSED
