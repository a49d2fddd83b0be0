/*
 * Sixteen sets of numbers below sixteen. A part of simd/lanes.h.
 *
 * SPDX-License-Identifier: MIT
 *
 * Number i is in a set if bit i is set. lanes_sets_load reads sixteen sets, lanes_sets_store writes
 * them, lanes_sets_of makes them of one number each, lanes_sets_join joins each two. lanes_within
 * tells which of them have no number that is not in one set, lanes_holding which have all of it;
 * lanes_sets_all joins those in some lanes.
 */
#if SC_LANES_AVX512 || SC_LANES_AVX2 || SC_LANES_SSE2

/* The numbers that any of eight sets has. */
static inline unsigned lanes_sets_joined(__m128i h)
{
    h = _mm_or_si128(h, _mm_unpackhi_epi64(h, h));
    h = _mm_or_si128(h, _mm_shuffle_epi32(h, 1));
    h = _mm_or_si128(h, _mm_srli_epi32(h, 16));
    return (unsigned)_mm_cvtsi128_si32(h) & 0xffffu;
}

#endif

#if SC_LANES_AVX512 || SC_LANES_AVX2

typedef __m256i lanes_sets;

static inline lanes_sets lanes_sets_load(const uint16_t *sets)
{
    return _mm256_loadu_si256((const __m256i *)(const void *)sets);
}
static inline void lanes_sets_store(uint16_t *to, lanes_sets a)
{
    _mm256_storeu_si256((__m256i *)(void *)to, a);
}
static inline lanes_sets lanes_sets_join(lanes_sets a, lanes_sets b)
{
    return _mm256_or_si256(a, b);
}

#  if SC_LANES_AVX512

static inline lanes_sets lanes_sets_of(const uint8_t *numbers)
{
    const __m128i n = _mm_loadu_si128((const __m128i *)(const void *)numbers);
    return _mm256_sllv_epi16(_mm256_set1_epi16(1), _mm256_cvtepu8_epi16(n));
}
static inline unsigned lanes_within(lanes_sets a, unsigned set)
{
    return _mm256_testn_epi16_mask(a, _mm256_set1_epi16((short)~set));
}
static inline unsigned lanes_holding(lanes_sets a, unsigned set)
{
    const __m256i all = _mm256_set1_epi16((short)set);
    return _mm256_cmpeq_epi16_mask(_mm256_and_si256(a, all), all);
}
static inline unsigned lanes_sets_all(lanes_sets a, unsigned some)
{
    const __m256i x = _mm256_maskz_mov_epi16((__mmask16)some, a);
    return lanes_sets_joined(
        _mm_or_si128(_mm256_castsi256_si128(x), _mm256_extracti128_si256(x, 1)));
}

#  else

static inline lanes_sets lanes_sets_of(const uint8_t *numbers)
{
    const __m256i one = _mm256_set1_epi32(1);
    const lanes_index n = lanes_index_load(numbers);
    const __m256i both =
        _mm256_packus_epi32(_mm256_sllv_epi32(one, n.v[0]), _mm256_sllv_epi32(one, n.v[1]));
    return _mm256_permute4x64_epi64(both, 0xd8);
}
static inline unsigned lanes_within(lanes_sets a, unsigned set)
{
    const __m256i others = _mm256_andnot_si256(_mm256_set1_epi16((short)set), a);
    const __m256i none = _mm256_cmpeq_epi16(others, _mm256_setzero_si256());
    return (unsigned)_mm_movemask_epi8(
        _mm_packs_epi16(_mm256_castsi256_si128(none), _mm256_extracti128_si256(none, 1)));
}
static inline unsigned lanes_holding(lanes_sets a, unsigned set)
{
    const __m256i all = _mm256_set1_epi16((short)set);
    const __m256i each = _mm256_cmpeq_epi16(_mm256_and_si256(a, all), all);
    return (unsigned)_mm_movemask_epi8(
        _mm_packs_epi16(_mm256_castsi256_si128(each), _mm256_extracti128_si256(each, 1)));
}
static inline unsigned lanes_sets_all(lanes_sets a, unsigned some)
{
    const __m256i bits = _mm256_setr_epi16(1, 2, 4, 8, 16, 32, 64, 128, 256, 512, 1024, 2048, 4096,
                                           8192, 16384, (short)-32768);
    const __m256i set = _mm256_and_si256(_mm256_set1_epi16((short)some), bits);
    const __m256i x = _mm256_and_si256(a, _mm256_cmpeq_epi16(set, bits));
    return lanes_sets_joined(
        _mm_or_si128(_mm256_castsi256_si128(x), _mm256_extracti128_si256(x, 1)));
}

#  endif

#elif SC_LANES_SSE2

typedef struct lanes_sets {
    __m128i v[2];
} lanes_sets;

static inline lanes_sets lanes_sets_load(const uint16_t *sets)
{
    lanes_sets r;
    r.v[0] = _mm_loadu_si128((const __m128i *)(const void *)sets);
    r.v[1] = _mm_loadu_si128((const __m128i *)(const void *)(sets + 8));
    return r;
}
static inline void lanes_sets_store(uint16_t *to, lanes_sets a)
{
    _mm_storeu_si128((__m128i *)(void *)to, a.v[0]);
    _mm_storeu_si128((__m128i *)(void *)(to + 8), a.v[1]);
}
static inline lanes_sets lanes_sets_join(lanes_sets a, lanes_sets b)
{
    a.v[0] = _mm_or_si128(a.v[0], b.v[0]);
    a.v[1] = _mm_or_si128(a.v[1], b.v[1]);
    return a;
}
/* There is no shift by many counts: bits 0 to 3 of a number stand for factors of 2, 4, 16, 256. */
static inline lanes_sets lanes_sets_of(const uint8_t *numbers)
{
    const __m128i all = _mm_loadu_si128((const __m128i *)(const void *)numbers);
    const __m128i none = _mm_setzero_si128();
    lanes_sets r;
    int i, k;
    r.v[0] = _mm_unpacklo_epi8(all, none);
    r.v[1] = _mm_unpackhi_epi8(all, none);
    SC_UNROLL
    for (i = 0; i < 2; i++) {
        const __m128i n = r.v[i];
        r.v[i] = _mm_set1_epi16(1);
        SC_UNROLL
        for (k = 0; k < 4; k++) {
            const __m128i unset =
                _mm_cmpeq_epi16(_mm_and_si128(n, _mm_set1_epi16((short)(1 << k))), none);
            const __m128i more = _mm_set1_epi16((short)((1 << (1 << k)) - 1));
            r.v[i] = _mm_mullo_epi16(
                r.v[i], _mm_add_epi16(_mm_andnot_si128(unset, more), _mm_set1_epi16(1)));
        }
    }
    return r;
}
static inline unsigned lanes_within(lanes_sets a, unsigned set)
{
    const __m128i all = _mm_set1_epi16((short)set), none = _mm_setzero_si128();
    return (unsigned)_mm_movemask_epi8(
        _mm_packs_epi16(_mm_cmpeq_epi16(_mm_andnot_si128(all, a.v[0]), none),
                        _mm_cmpeq_epi16(_mm_andnot_si128(all, a.v[1]), none)));
}
static inline unsigned lanes_holding(lanes_sets a, unsigned set)
{
    const __m128i all = _mm_set1_epi16((short)set);
    return (unsigned)_mm_movemask_epi8(
        _mm_packs_epi16(_mm_cmpeq_epi16(_mm_and_si128(all, a.v[0]), all),
                        _mm_cmpeq_epi16(_mm_and_si128(all, a.v[1]), all)));
}
static inline unsigned lanes_sets_all(lanes_sets a, unsigned some)
{
    const __m128i bits[2] = {
        _mm_setr_epi16(1, 2, 4, 8, 16, 32, 64, 128),
        _mm_setr_epi16(256, 512, 1024, 2048, 4096, 8192, 16384, (short)-32768)};
    const __m128i each = _mm_set1_epi16((short)some);
    const __m128i low = _mm_cmpeq_epi16(_mm_and_si128(each, bits[0]), bits[0]);
    const __m128i high = _mm_cmpeq_epi16(_mm_and_si128(each, bits[1]), bits[1]);
    return lanes_sets_joined(_mm_or_si128(_mm_and_si128(a.v[0], low), _mm_and_si128(a.v[1], high)));
}

#else

typedef struct lanes_sets {
    uint16_t v[SC_LANES_COUNT];
} lanes_sets;

static inline lanes_sets lanes_sets_load(const uint16_t *sets)
{
    lanes_sets r;
    memcpy(r.v, sets, sizeof r.v);
    return r;
}
static inline void lanes_sets_store(uint16_t *to, lanes_sets a)
{
    memcpy(to, a.v, sizeof a.v);
}
static inline lanes_sets lanes_sets_join(lanes_sets a, lanes_sets b)
{
    int i;
    for (i = 0; i < SC_LANES_COUNT; i++) a.v[i] = (uint16_t)(a.v[i] | b.v[i]);
    return a;
}
static inline lanes_sets lanes_sets_of(const uint8_t *numbers)
{
    lanes_sets r;
    int i;
    for (i = 0; i < SC_LANES_COUNT; i++) r.v[i] = (uint16_t)(1u << numbers[i]);
    return r;
}
static inline unsigned lanes_within(lanes_sets a, unsigned set)
{
    unsigned bits = 0, i;
    for (i = 0; i < SC_LANES_COUNT; i++) bits |= (unsigned)((a.v[i] & ~set) == 0) << i;
    return bits;
}
static inline unsigned lanes_holding(lanes_sets a, unsigned set)
{
    unsigned bits = 0, i;
    for (i = 0; i < SC_LANES_COUNT; i++) bits |= (unsigned)((a.v[i] & set) == set) << i;
    return bits;
}
static inline unsigned lanes_sets_all(lanes_sets a, unsigned some)
{
    unsigned all = 0, i;
    for (i = 0; i < SC_LANES_COUNT; i++) all |= some >> i & 1 ? a.v[i] : 0u;
    return all;
}

#endif
