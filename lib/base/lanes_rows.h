/*
 * Sixteen rows of sixteen floats each, of which one question is asked. For the instruction set that base/lanes.h,
 * included before, is for.
 *
 * SPDX-License-Identifier: MIT
 *
 * lanes_signs_of takes the signs of a row, and lanes_all_negative makes bit i if all of row i are set, as they are of
 * what is below 0.
 *
 * No guard, as in base/lanes.h; base/lanes_rows_end.h ends it.
 */
#define lanes_signs SC_KERNEL(sc_lanes_signs)
#define lanes_signs_of SC_KERNEL(sc_lanes_signs_of)
#define lanes_all_negative SC_KERNEL(sc_lanes_all_negative)

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
#  if !SC_LANES_SSE2
    const sc_floats4 zero = SC_QUAD(set1_ps)(0);
    int i;
    SC_UNROLL
    for (i = 0; i < 4; i++) a.v[i] = SC_QUAD(cmplt_ps)(a.v[i], zero);
#  endif
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
