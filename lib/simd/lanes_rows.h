/*
 * Sixteen rows of sixteen floats or points each, of which one thing is found at once. A part of
 * simd/lanes.h.
 *
 * SPDX-License-Identifier: MIT
 *
 * lanes_signs_of takes the signs of a row, and lanes_all_negative makes bit i if all of row i are
 * set, as they are of what is below 0. lanes_rows_ends makes lane i the least and the most x, y and
 * z of row i of memory, sixteen points of four floats in any order, rows being `stride` floats
 * apart; none is NaN.
 */

/*
 * On x86-64 words, then bytes, are made of four rows, which keeps signs since it saturates: four
 * bytes each, in each 128 bits. When these are joined, a row is negative if the signs of its four
 * bytes are set.
 */
#if SC_LANES_AVX512

typedef __m512i lanes_signs;

static inline lanes_signs lanes_signs_of(lanes a)
{
    return _mm512_castps_si512(a);
}
static inline __m512i lanes_four_signs(const lanes_signs row[4])
{
    return _mm512_packs_epi16(_mm512_packs_epi32(row[0], row[1]),
                              _mm512_packs_epi32(row[2], row[3]));
}
static inline unsigned lanes_all_negative(const lanes_signs row[16])
{
    const __m512i signs = _mm512_set1_epi8(-128);
    __m512i a = lanes_four_signs(row), b = lanes_four_signs(row + 4);
    __m512i c = lanes_four_signs(row + 8), d = lanes_four_signs(row + 12);
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
static inline __m256i lanes_four_signs(const lanes_signs row[4])
{
    return _mm256_packs_epi16(_mm256_packs_epi32(row[0], row[1]),
                              _mm256_packs_epi32(row[2], row[3]));
}
static inline unsigned lanes_eight_negative(const lanes_signs row[8])
{
    const __m256i signs = _mm256_set1_epi8(-128);
    __m256i a = lanes_four_signs(row), b = lanes_four_signs(row + 4);
    a = _mm256_and_si256(_mm256_permute2x128_si256(a, b, 0x20),
                         _mm256_permute2x128_si256(a, b, 0x31));
    a = _mm256_cmpeq_epi32(_mm256_and_si256(a, signs), signs);
    return (unsigned)_mm256_movemask_ps(_mm256_castsi256_ps(a));
}
static inline unsigned lanes_all_negative(const lanes_signs row[16])
{
    return lanes_eight_negative(row) | lanes_eight_negative(row + 8) << 8;
}

#elif SC_LANES_QUADS

typedef sc_floats4 lanes_signs;

static inline lanes_signs lanes_signs_of(lanes a)
{
    return SC_QUAD(and_ps)(SC_QUAD(and_ps)(a.v[0], a.v[1]), SC_QUAD(and_ps)(a.v[2], a.v[3]));
}

/* Rows in pieces of four lanes, one after another: only those that are negative in all of them are
   kept. */
#  if SC_LANES_SSE2

typedef struct lanes_signs_kept {
    __m128i four[4];
} lanes_signs_kept;

static inline lanes_signs_kept lanes_keep_all(void)
{
    lanes_signs_kept kept;
    int i;
    SC_UNROLL
    for (i = 0; i < 4; i++) kept.four[i] = _mm_set1_epi8(-1);
    return kept;
}
static inline void lanes_keep(lanes_signs_kept *kept, const lanes_signs row[16])
{
    int i, k;
    SC_UNROLL
    for (i = 0; i < 4; i++) {
        __m128i four[4];
        SC_UNROLL
        for (k = 0; k < 4; k++) four[k] = _mm_castps_si128(row[4 * i + k]);
        kept->four[i] =
            _mm_and_si128(kept->four[i], _mm_packs_epi16(_mm_packs_epi32(four[0], four[1]),
                                                         _mm_packs_epi32(four[2], four[3])));
    }
}
static inline unsigned lanes_kept_negative(const lanes_signs_kept *kept)
{
    const __m128i signs = _mm_set1_epi8(-128);
    unsigned mask = 0;
    int i;
    SC_UNROLL
    for (i = 0; i < 4; i++) {
        __m128i all = _mm_cmpeq_epi32(_mm_and_si128(kept->four[i], signs), signs);
        mask |= (unsigned)_mm_movemask_ps(_mm_castsi128_ps(all)) << 4 * i;
    }
    return mask;
}

#  else

typedef struct lanes_signs_kept {
    sc_floats4 row[16];
} lanes_signs_kept;

static inline lanes_signs_kept lanes_keep_all(void)
{
    lanes_signs_kept kept;
    int i;
    for (i = 0; i < 16; i++) kept.row[i] = SC_QUAD(set1_ps)(-1);
    return kept;
}
static inline void lanes_keep(lanes_signs_kept *kept, const lanes_signs row[16])
{
    int i;
    for (i = 0; i < 16; i++) kept->row[i] = SC_QUAD(and_ps)(kept->row[i], row[i]);
}
static inline unsigned lanes_kept_negative(const lanes_signs_kept *kept)
{
    sc_floats4 all[4], x[4];
    int i, k;
    SC_UNROLL
    for (i = 0; i < 4; i++) {
        SC_UNROLL
        for (k = 0; k < 4; k++) x[k] = kept->row[4 * i + k];
        sc_quad_transpose(x);
        all[i] = SC_QUAD(and_ps)(SC_QUAD(and_ps)(x[0], x[1]), SC_QUAD(and_ps)(x[2], x[3]));
        all[i] = (sc_floats4)((sc_numbers4)all[i] < 0);
    }
    return sc_quad_bits(all[0], all[1], all[2], all[3]);
}

#  endif

static inline unsigned lanes_all_negative(const lanes_signs row[16])
{
    lanes_signs_kept kept = lanes_keep_all();
    lanes_keep(&kept, row);
    return lanes_kept_negative(&kept);
}

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
 * Of sixteen points in a register each 128 bits are joined, two registers becoming one, until each
 * is of one row, four rows apart; four such registers, of rows that follow each other, are
 * transposed.
 */
#if SC_LANES_AVX512

#  define SC_LANES_JOINED(name, a, b)                                                              \
    _mm512_##name##_ps(_mm512_shuffle_f32x4(a, b, 0x44), _mm512_shuffle_f32x4(a, b, 0xee))
#  define SC_LANES_JOINED_AGAIN(name, a, b)                                                        \
    _mm512_##name##_ps(_mm512_shuffle_f32x4(a, b, 0x88), _mm512_shuffle_f32x4(a, b, 0xdd))
static inline void lanes_rows_ends(const float *row, uint64_t stride, lanes least[3], lanes most[3])
{
    __m512 low[4], high[4];
    int i, j, k;
    SC_UNROLL
    for (i = 0; i < 4; i++) {
        __m512 a[4], b[4];
        SC_UNROLL
        for (j = 0; j < 4; j++) {
            const float *p = row + stride * (uint64_t)(i + 4 * j);
            a[j] = b[j] = _mm512_loadu_ps(p);
            SC_UNROLL
            for (k = 1; k < 4; k++) {
                __m512 next = _mm512_loadu_ps(p + 16 * k);
                a[j] = _mm512_min_ps(a[j], next);
                b[j] = _mm512_max_ps(b[j], next);
            }
        }
        a[0] = SC_LANES_JOINED(min, a[0], a[1]), a[2] = SC_LANES_JOINED(min, a[2], a[3]);
        b[0] = SC_LANES_JOINED(max, b[0], b[1]), b[2] = SC_LANES_JOINED(max, b[2], b[3]);
        low[i] = SC_LANES_JOINED_AGAIN(min, a[0], a[2]);
        high[i] = SC_LANES_JOINED_AGAIN(max, b[0], b[2]);
    }
    lanes_transposed(low, &least[0], &least[1], &least[2]);
    lanes_transposed(high, &most[0], &most[1], &most[2]);
}
#  undef SC_LANES_JOINED
#  undef SC_LANES_JOINED_AGAIN

#elif SC_LANES_AVX2

#  define SC_LANES_JOINED(name, a, b)                                                              \
    _mm256_##name##_ps(_mm256_permute2f128_ps(a, b, 0x20), _mm256_permute2f128_ps(a, b, 0x31))
static inline void lanes_rows_ends(const float *row, uint64_t stride, lanes least[3], lanes most[3])
{
    __m256 low[4], high[4];
    int i, j, k, half;
    SC_UNROLL
    for (half = 0; half < 2; half++) {
        SC_UNROLL
        for (i = 0; i < 4; i++) {
            __m256 a[2], b[2];
            SC_UNROLL
            for (j = 0; j < 2; j++) {
                const float *p = row + stride * (uint64_t)(8 * half + i + 4 * j);
                a[j] = b[j] = _mm256_loadu_ps(p);
                SC_UNROLL
                for (k = 1; k < 8; k++) {
                    __m256 next = _mm256_loadu_ps(p + 8 * k);
                    a[j] = _mm256_min_ps(a[j], next);
                    b[j] = _mm256_max_ps(b[j], next);
                }
            }
            low[i] = SC_LANES_JOINED(min, a[0], a[1]);
            high[i] = SC_LANES_JOINED(max, b[0], b[1]);
        }
        lanes_transposed(low, &least[0].v[half], &least[1].v[half], &least[2].v[half]);
        lanes_transposed(high, &most[0].v[half], &most[1].v[half], &most[2].v[half]);
    }
}
#  undef SC_LANES_JOINED

#elif SC_LANES_QUADS

static inline void lanes_rows_ends(const float *row, uint64_t stride, lanes least[3], lanes most[3])
{
    sc_floats4 low[4], high[4];
    int i, j, k;
    for (i = 0; i < 4; i++) {
        SC_UNROLL
        for (j = 0; j < 4; j++) {
            const float *p = row + stride * (uint64_t)(4 * i + j);
            low[j] = high[j] = SC_QUAD(loadu_ps)(p);
            SC_UNROLL
            for (k = 1; k < 16; k++) {
                sc_floats4 next = SC_QUAD(loadu_ps)(p + 4 * k);
                low[j] = SC_QUAD(min_ps)(low[j], next);
                high[j] = SC_QUAD(max_ps)(high[j], next);
            }
        }
        lanes_transposed(low, &least[0].v[i], &least[1].v[i], &least[2].v[i]);
        lanes_transposed(high, &most[0].v[i], &most[1].v[i], &most[2].v[i]);
    }
}

#else

static inline void lanes_rows_ends(const float *row, uint64_t stride, lanes least[3], lanes most[3])
{
    int i, k;
    for (i = 0; i < SC_LANES_COUNT; i++, row += stride) {
        lanes at[3];
        lanes_coordinates(row, at);
        for (k = 0; k < 3; k++) {
            least[k].v[i] = lanes_least(at[k]);
            most[k].v[i] = lanes_most(at[k]);
        }
    }
}

#endif
