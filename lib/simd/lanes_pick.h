/*
 * Numbers of lanes: rows of sixteen floats in any order. A part of simd/lanes.h.
 *
 * SPDX-License-Identifier: MIT
 *
 * lanes_list writes the numbers of the bits set in a mask, ascending, and returns how many; sixteen
 * bytes are written to; lanes_list_from adds a first number to them, and writes sixteen words;
 * lanes_list_pairs takes the numbers of these lanes from two rows of sixteen bytes, adds the first
 * of two first numbers, or the second in lanes of a second mask, and writes pairs of words, room
 * for sixteen. lanes_list_bits writes a number for each, bit k of which is its lane's in the k-th
 * of twelve masks, room for sixteen. lanes_list_among looks at words, sixteen or fewer, none of
 * which is there twice: it writes `at` and the places of those that are a first number and one of a
 * set of numbers below sixteen, room for sixteen, and tells which these are. lanes_index reads
 * sixteen numbers below sixteen, lanes_index_through those of these numbers of a row of sixteen
 * bytes; lanes_pick and lanes_pick_of take the floats of these numbers of a row, in memory or not,
 * lanes_pick_both those of numbers below 32 of two rows. lanes_choose takes from a where the mask
 * is set, else from b. lanes_same compares bits, whatever they mean; lanes_differ has what is in
 * one of two masks only. lanes_corners picks corners 0 to 2 of triangles, their coordinates 0 to 2,
 * from three rows of coordinates by three of numbers; lanes_corners_at finds the former in memory,
 * in transposed places (see simd/lanes.h); lanes_corners_through takes the triangles of sixteen
 * numbers below sixteen instead of all in order. lanes_pick_two and lanes_corners_two do as
 * lanes_pick and lanes_corners_through, but from a second place in the lanes that follow so many;
 * lanes_from has these.
 *
 * lanes_marked is the set of the numbers in three rows, in lanes of three masks; lanes_among has
 * the lanes of which the number is in a set.
 */
#if SC_LANES_AVX512

static inline lanes_mask lanes_from(unsigned count)
{
    return (lanes_mask)(0xffffu << count);
}

typedef __m512i lanes_index;

static inline lanes_index lanes_index_load(const uint8_t *numbers)
{
    return _mm512_cvtepu8_epi32(_mm_loadu_si128((const __m128i *)(const void *)numbers));
}
static inline lanes_index lanes_index_through(const uint8_t *row, const uint8_t *numbers)
{
    return _mm512_cvtepu8_epi32(
        _mm_shuffle_epi8(_mm_loadu_si128((const __m128i *)(const void *)row),
                         _mm_loadu_si128((const __m128i *)(const void *)numbers)));
}
static inline lanes lanes_pick(const float *row, lanes_index i)
{
    return _mm512_permutexvar_ps(i, _mm512_loadu_ps(row));
}
static inline lanes lanes_pick_of(lanes row, lanes_index i)
{
    return _mm512_permutexvar_ps(i, row);
}
static inline lanes lanes_pick_both(const lanes row[2], const uint8_t *numbers)
{
    return _mm512_permutex2var_ps(row[0], lanes_index_load(numbers), row[1]);
}
static inline lanes lanes_choose(lanes_mask m, lanes a, lanes b)
{
    return _mm512_mask_blend_ps(m, b, a);
}
static inline lanes_mask lanes_same(lanes a, lanes b)
{
    return _mm512_cmpeq_epi32_mask(_mm512_castps_si512(a), _mm512_castps_si512(b));
}
static inline lanes_mask lanes_differ(lanes_mask a, lanes_mask b)
{
    return (lanes_mask)(a ^ b);
}
static inline unsigned lanes_marked(const lanes_index number[3], const lanes_mask mask[3])
{
    const __m512i one = _mm512_set1_epi32(1);
    __m512i all = _mm512_maskz_sllv_epi32(mask[0], one, number[0]);
    all = _mm512_or_si512(all, _mm512_maskz_sllv_epi32(mask[1], one, number[1]));
    all = _mm512_or_si512(all, _mm512_maskz_sllv_epi32(mask[2], one, number[2]));
    return (unsigned)_mm512_reduce_or_epi32(all);
}
static inline unsigned lanes_among(lanes_index number, unsigned set)
{
    __m512i bit = _mm512_sllv_epi32(_mm512_set1_epi32(1), number);
    return _mm512_test_epi32_mask(bit, _mm512_set1_epi32((int)set));
}
static inline unsigned lanes_list(unsigned mask, uint8_t *to)
{
    const __m512i all = _mm512_set_epi32(15, 14, 13, 12, 11, 10, 9, 8, 7, 6, 5, 4, 3, 2, 1, 0);
    __m512i set = _mm512_maskz_compress_epi32((__mmask16)mask, all);
    _mm_storeu_si128((__m128i *)(void *)to, _mm512_cvtepi32_epi8(set));
    return (unsigned)__builtin_popcount(mask);
}

static inline unsigned lanes_list_from(unsigned mask, uint32_t first, uint32_t *to)
{
    const __m512i all = _mm512_set_epi32(15, 14, 13, 12, 11, 10, 9, 8, 7, 6, 5, 4, 3, 2, 1, 0);
    __m512i numbers = _mm512_add_epi32(_mm512_set1_epi32((int)first), all);
    _mm512_storeu_si512(to, _mm512_maskz_compress_epi32((__mmask16)mask, numbers));
    return (unsigned)__builtin_popcount(mask);
}
static inline unsigned lanes_list_among(const uint32_t *word, unsigned count, uint32_t first,
                                        unsigned set, uint32_t at, uint32_t *to, unsigned *found)
{
    const __mmask16 some = (__mmask16)((1u << count) - 1u);
    const __m512i number =
        _mm512_sub_epi32(_mm512_maskz_loadu_epi32(some, word), _mm512_set1_epi32((int)first));
    const __m512i bit = _mm512_sllv_epi32(_mm512_set1_epi32(1), number);
    const __mmask16 among = _mm512_mask_test_epi32_mask(some, bit, _mm512_set1_epi32((int)set));
    *found = (unsigned)_mm512_mask_reduce_or_epi32(among, bit);
    return lanes_list_from(among, at, to);
}
static inline unsigned lanes_list_pairs(unsigned mask, unsigned second, const uint8_t *a,
                                        const uint32_t first_a[2], const uint8_t *b,
                                        const uint32_t first_b[2], uint32_t *to)
{
    const __m512i low = _mm512_set_epi32(23, 7, 22, 6, 21, 5, 20, 4, 19, 3, 18, 2, 17, 1, 16, 0);
    const __m512i high = _mm512_add_epi32(low, _mm512_set1_epi32(8));
    __m512i i = _mm512_mask_set1_epi32(_mm512_set1_epi32((int)first_a[0]), (__mmask16)second,
                                       (int)first_a[1]);
    __m512i j = _mm512_mask_set1_epi32(_mm512_set1_epi32((int)first_b[0]), (__mmask16)second,
                                       (int)first_b[1]);
    i = _mm512_add_epi32(lanes_index_load(a), i);
    j = _mm512_add_epi32(lanes_index_load(b), j);
    i = _mm512_maskz_compress_epi32((__mmask16)mask, i);
    j = _mm512_maskz_compress_epi32((__mmask16)mask, j);
    _mm512_storeu_si512(to, _mm512_permutex2var_epi32(i, low, j));
    _mm512_storeu_si512(to + 16, _mm512_permutex2var_epi32(i, high, j));
    return (unsigned)__builtin_popcount(mask);
}
static inline void lanes_list_bits(unsigned mask, const unsigned bits[12], uint16_t *to)
{
    __m512i numbers = _mm512_setzero_si512();
    int k, j;
    SC_UNROLL
    for (k = 0; k < 12; k += 6) {
        SC_UNROLL
        for (j = k; j < k + 6; j++)
            numbers = _mm512_mask_or_epi32(numbers, (__mmask16)bits[j], numbers,
                                           _mm512_set1_epi32(1 << j));
    }
    numbers = _mm512_maskz_compress_epi32((__mmask16)mask, numbers);
    _mm256_storeu_si256((__m256i *)(void *)to, _mm512_cvtepi32_epi16(numbers));
}

#else

static inline lanes_mask lanes_from(unsigned count)
{
    static const float number[SC_LANES_COUNT] = {0, 1, 2,  3,  4,  5,  6,  7,
                                                 8, 9, 10, 11, 12, 13, 14, 15};
    return lanes_not_above(lanes_all((float)count), lanes_load(number));
}

static inline void lanes_list_bits(unsigned mask, const unsigned bits[12], uint16_t *to)
{
    uint64_t four[3]; /* masks side by side */
    int k;
    SC_UNROLL
    for (k = 0; k < 3; k++)
        four[k] = (bits[4 * k] & 0xffffu) | (uint64_t)(bits[4 * k + 1] & 0xffffu) << 16 |
                  (uint64_t)(bits[4 * k + 2] & 0xffffu) << 32 |
                  (uint64_t)(bits[4 * k + 3] & 0xffffu) << 48;
    for (; mask; mask &= mask - 1) {
        uint32_t lane = sc_bits_lowest(mask);
        unsigned number = 0;
        SC_UNROLL
        for (k = 0; k < 3; k++) { /* a product brings the four bits of the lane together */
            uint64_t apart = four[k] >> lane & 0x0001000100010001u;
            number |= ((unsigned)(apart * 0x0001000200040008u >> 48) & 15u) << 4 * k;
        }
        *to++ = (uint16_t)number;
    }
}
static inline unsigned lanes_list(unsigned mask, uint8_t *to)
{
    /* of four bits the numbers of those that are set, lowest first; and how many */
    static const uint8_t number[16][4] = {
        {0}, {0},    {1},    {0, 1},    {2},    {0, 2},    {1, 2},    {0, 1, 2},
        {3}, {0, 3}, {1, 3}, {0, 1, 3}, {2, 3}, {0, 2, 3}, {1, 2, 3}, {0, 1, 2, 3}};
    static const uint8_t some[16] = {0, 1, 1, 2, 1, 2, 2, 3, 1, 2, 2, 3, 2, 3, 3, 4};
    unsigned count = 0, first;
    SC_UNROLL
    for (first = 0; first < SC_LANES_COUNT; first += 4) {
        unsigned bits = mask >> first & 15u;
        uint32_t four;
        memcpy(&four, number[bits], sizeof four);
        four += first * 0x01010101u;
        memcpy(to + count, &four, sizeof four);
        count += some[bits];
    }
    return count;
}
static inline unsigned lanes_list_from(unsigned mask, uint32_t first, uint32_t *to)
{
    uint8_t number[SC_LANES_COUNT] = {0};
    unsigned count = lanes_list(mask, number), i;
    for (i = 0; i < SC_LANES_COUNT; i++) to[i] = first + number[i];
    return count;
}

#  if SC_LANES_AVX2

static inline unsigned lanes_list_among(const uint32_t *word, unsigned count, uint32_t first,
                                        unsigned set, uint32_t at, uint32_t *to, unsigned *found)
{
    const __m256i one = _mm256_set1_epi32(1), all = _mm256_set1_epi32((int)set);
    const __m256i from = _mm256_set1_epi32((int)first);
    const __m256i lane = _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7);
    __m256i bits[2];
    __m128i half;
    unsigned among = 0;
    int k;
    SC_UNROLL
    for (k = 0; k < 2; k++) {
        const __m256i some = _mm256_cmpgt_epi32(_mm256_set1_epi32((int)count - 8 * k), lane);
        const __m256i number = _mm256_sub_epi32(
            _mm256_maskload_epi32((const int *)(const void *)(word + 8 * k), some), from);
        bits[k] = _mm256_and_si256(_mm256_and_si256(_mm256_sllv_epi32(one, number), all), some);
        among |= (unsigned)_mm256_movemask_ps(
                     _mm256_castsi256_ps(_mm256_cmpgt_epi32(bits[k], _mm256_setzero_si256())))
                 << 8 * k;
    }
    bits[0] = _mm256_or_si256(bits[0], bits[1]);
    half = _mm_or_si128(_mm256_castsi256_si128(bits[0]), _mm256_extracti128_si256(bits[0], 1));
    half = _mm_or_si128(half, _mm_shuffle_epi32(half, 0x4e));
    *found = (unsigned)_mm_cvtsi128_si32(_mm_or_si128(half, _mm_shuffle_epi32(half, 0xb1)));
    return lanes_list_from(among, at, to);
}

#  else

static inline unsigned lanes_list_among(const uint32_t *word, unsigned count, uint32_t first,
                                        unsigned set, uint32_t at, uint32_t *to, unsigned *found)
{
    unsigned listed = 0, i;
    for (*found = i = 0; i < count; i++) {
        const uint32_t number = word[i] - first;
        const unsigned bit = number < SC_LANES_COUNT ? set & 1u << number % SC_LANES_COUNT : 0u;
        to[listed] = at + i;
        listed += bit != 0;
        *found |= bit;
    }
    return listed;
}

#  endif

static inline unsigned lanes_list_pairs(unsigned mask, unsigned second, const uint8_t *a,
                                        const uint32_t first_a[2], const uint8_t *b,
                                        const uint32_t first_b[2], uint32_t *to)
{
    unsigned count = 0;
    for (; mask; mask &= mask - 1) {
        uint32_t lane = sc_bits_lowest(mask), k = second >> lane & 1u;
        to[2 * count] = first_a[k] + a[lane];
        to[2 * count++ + 1] = first_b[k] + b[lane];
    }
    return count;
}

#  if SC_LANES_AVX2

typedef struct lanes_index {
    __m256i v[2];
} lanes_index;

static inline lanes_index lanes_index_load(const uint8_t *numbers)
{
    lanes_index r;
    r.v[0] = _mm256_cvtepu8_epi32(_mm_loadl_epi64((const __m128i *)(const void *)numbers));
    r.v[1] = _mm256_cvtepu8_epi32(_mm_loadl_epi64((const __m128i *)(const void *)(numbers + 8)));
    return r;
}
static inline lanes_index lanes_index_through(const uint8_t *row, const uint8_t *numbers)
{
    __m128i all = _mm_shuffle_epi8(_mm_loadu_si128((const __m128i *)(const void *)row),
                                   _mm_loadu_si128((const __m128i *)(const void *)numbers));
    lanes_index r;
    r.v[0] = _mm256_cvtepu8_epi32(all);
    r.v[1] = _mm256_cvtepu8_epi32(_mm_srli_si128(all, 8));
    return r;
}
/* The sign bit of the number shifted, which a blend looks at, tells whether it is above seven. */
static inline __m256 lanes_pick_part(__m256 low, __m256 high, __m256i i)
{
    return _mm256_blendv_ps(_mm256_permutevar8x32_ps(low, i), _mm256_permutevar8x32_ps(high, i),
                            _mm256_castsi256_ps(_mm256_slli_epi32(i, 28)));
}
static inline lanes lanes_pick_of(lanes row, lanes_index i)
{
    lanes r;
    r.v[0] = lanes_pick_part(row.v[0], row.v[1], i.v[0]);
    r.v[1] = lanes_pick_part(row.v[0], row.v[1], i.v[1]);
    return r;
}
static inline lanes lanes_pick(const float *row, lanes_index i)
{
    return lanes_pick_of(lanes_load(row), i);
}
static inline lanes lanes_pick_both(const lanes row[2], const uint8_t *numbers)
{
    const lanes_index i = lanes_index_load(numbers);
    const lanes low = lanes_pick_of(row[0], i), high = lanes_pick_of(row[1], i);
    lanes r;
    int k;
    SC_UNROLL
    for (k = 0; k < 2; k++)
        r.v[k] = _mm256_blendv_ps(low.v[k], high.v[k],
                                  _mm256_castsi256_ps(_mm256_slli_epi32(i.v[k], 27)));
    return r;
}
static inline lanes lanes_choose(lanes_mask m, lanes a, lanes b)
{
    lanes r;
    r.v[0] = _mm256_blendv_ps(b.v[0], a.v[0], m.v[0]);
    r.v[1] = _mm256_blendv_ps(b.v[1], a.v[1], m.v[1]);
    return r;
}
static inline lanes_mask lanes_same(lanes a, lanes b)
{
    lanes r;
    int k;
    for (k = 0; k < 2; k++)
        r.v[k] = _mm256_castsi256_ps(
            _mm256_cmpeq_epi32(_mm256_castps_si256(a.v[k]), _mm256_castps_si256(b.v[k])));
    return r;
}
static inline lanes_mask lanes_differ(lanes_mask a, lanes_mask b)
{
    lanes r;
    r.v[0] = _mm256_xor_ps(a.v[0], b.v[0]);
    r.v[1] = _mm256_xor_ps(a.v[1], b.v[1]);
    return r;
}
static inline unsigned lanes_marked(const lanes_index number[3], const lanes_mask mask[3])
{
    const __m256i one = _mm256_set1_epi32(1);
    __m256i all = _mm256_setzero_si256();
    __m128i half;
    int i, k;
    SC_UNROLL
    for (k = 0; k < 3; k++) {
        SC_UNROLL
        for (i = 0; i < 2; i++)
            all = _mm256_or_si256(all, _mm256_and_si256(_mm256_castps_si256(mask[k].v[i]),
                                                        _mm256_sllv_epi32(one, number[k].v[i])));
    }
    half = _mm_or_si128(_mm256_castsi256_si128(all), _mm256_extracti128_si256(all, 1));
    half = _mm_or_si128(half, _mm_shuffle_epi32(half, 0x4e));
    return (unsigned)_mm_cvtsi128_si32(_mm_or_si128(half, _mm_shuffle_epi32(half, 0xb1)));
}
static inline unsigned lanes_among(lanes_index number, unsigned set)
{
    const __m256i one = _mm256_set1_epi32(1), all = _mm256_set1_epi32((int)set);
    lanes_mask r;
    int i;
    SC_UNROLL
    for (i = 0; i < 2; i++) {
        __m256i bit = _mm256_sllv_epi32(one, number.v[i]);
        r.v[i] = _mm256_castsi256_ps(_mm256_cmpeq_epi32(_mm256_and_si256(bit, all), bit));
    }
    return lanes_bits(r);
}

#  else

typedef struct lanes_index {
    uint8_t at[SC_LANES_COUNT];
} lanes_index;

static inline unsigned lanes_marked(const lanes_index number[3], const lanes_mask mask[3])
{
    unsigned set = 0, bits;
    int k;
    for (k = 0; k < 3; k++)
        for (bits = lanes_bits(mask[k]); bits; bits &= bits - 1)
            set |= 1u << number[k].at[sc_bits_lowest(bits)];
    return set;
}
static inline unsigned lanes_among(lanes_index number, unsigned set)
{
    unsigned bits = 0, i;
    for (i = 0; i < SC_LANES_COUNT; i++) bits |= (set >> number.at[i] & 1u) << i;
    return bits;
}

static inline lanes_index lanes_index_load(const uint8_t *numbers)
{
    lanes_index r;
    memcpy(r.at, numbers, sizeof r.at);
    return r;
}
static inline lanes_index lanes_index_through(const uint8_t *row, const uint8_t *numbers)
{
    lanes_index r;
    int k;
    for (k = 0; k < SC_LANES_COUNT; k++) r.at[k] = row[numbers[k]];
    return r;
}
static inline lanes lanes_pick(const float *row, lanes_index i)
{
    float r[SC_LANES_COUNT];
    int k;
    for (k = 0; k < SC_LANES_COUNT; k++) r[k] = row[i.at[k]];
    return lanes_load(r);
}
static inline lanes lanes_pick_of(lanes row, lanes_index i)
{
    float r[SC_LANES_COUNT];
    lanes_store(r, row);
    return lanes_pick(r, i);
}
static inline lanes lanes_pick_both(const lanes row[2], const uint8_t *numbers)
{
    float r[2 * SC_LANES_COUNT];
    lanes_store(r, row[0]);
    lanes_store(r + SC_LANES_COUNT, row[1]);
    return lanes_pick(r, lanes_index_load(numbers));
}

#    if SC_LANES_QUADS

static inline lanes lanes_choose(lanes_mask m, lanes a, lanes b)
{
    lanes r;
    int k;
    for (k = 0; k < 4; k++)
        r.v[k] =
            SC_QUAD(or_ps)(SC_QUAD(and_ps)(m.v[k], a.v[k]), SC_QUAD(andnot_ps)(m.v[k], b.v[k]));
    return r;
}
static inline lanes_mask lanes_same(lanes a, lanes b)
{
    lanes r;
    int k;
    for (k = 0; k < 4; k++) r.v[k] = sc_quad_same(a.v[k], b.v[k]);
    return r;
}
static inline lanes_mask lanes_differ(lanes_mask a, lanes_mask b)
{
    lanes r;
    int k;
    for (k = 0; k < 4; k++)
        r.v[k] =
            SC_QUAD(or_ps)(SC_QUAD(andnot_ps)(a.v[k], b.v[k]), SC_QUAD(andnot_ps)(b.v[k], a.v[k]));
    return r;
}

#    else

static inline lanes lanes_choose(lanes_mask m, lanes a, lanes b)
{
    int k;
    for (k = 0; k < SC_LANES_COUNT; k++)
        if (m >> k & 1u) b.v[k] = a.v[k];
    return b;
}
static inline lanes_mask lanes_same(lanes a, lanes b)
{
    lanes_mask mask = 0;
    unsigned k;
    for (k = 0; k < SC_LANES_COUNT; k++)
        mask |= (unsigned)(memcmp(&a.v[k], &b.v[k], sizeof a.v[k]) == 0) << k;
    return mask;
}
static inline lanes_mask lanes_differ(lanes_mask a, lanes_mask b)
{
    return a ^ b;
}

#    endif
#  endif
#endif

static inline lanes lanes_pick_two(const float *const row[2], lanes_index i, unsigned split)
{
    return lanes_choose(lanes_from(split), lanes_pick(row[1], i), lanes_pick(row[0], i));
}

#if SC_LANES_QUADS

/* There is no permutation by numbers: the points one after another, then read again as the
   corners. */
static inline void lanes_corners(const lanes at[3], const uint8_t *where, lanes corner[3][3])
{
    float points[16][4];
    sc_floats4 x[4];
    int c, i, k;
    for (i = 0; i < 4; i++) {
        SC_UNROLL
        for (k = 0; k < 3; k++) x[k] = at[k].v[i];
        x[3] = x[2];
        sc_quad_transpose(x);
        SC_UNROLL
        for (k = 0; k < 4; k++) SC_QUAD(storeu_ps)(points[4 * i + k], x[k]);
    }
    for (c = 0; c < 3; c++)
        for (i = 0; i < 4; i++, where += 4) {
            SC_UNROLL
            for (k = 0; k < 4; k++) x[k] = SC_QUAD(loadu_ps)(points[where[k]]);
            sc_quad_transpose(x);
            SC_UNROLL
            for (k = 0; k < 3; k++) corner[c][k].v[i] = x[k];
        }
}
static inline void lanes_corners_at(const float *at, const uint8_t *where, lanes corner[3][3])
{
    sc_floats4 x[4];
    uint8_t place[SC_LANES_COUNT];
    int c, i, k;
    for (c = 0; c < 3; c++, where += SC_LANES_COUNT) {
        sc_quad_places(where, place);
        for (i = 0; i < 4; i++) {
            SC_UNROLL
            for (k = 0; k < 4; k++) x[k] = sc_quad_at(at, place[4 * i + k]);
            sc_quad_transpose(x);
            SC_UNROLL
            for (k = 0; k < 3; k++) corner[c][k].v[i] = x[k];
        }
    }
}
static inline void lanes_corners_through(const float *at, const uint8_t *where,
                                         const uint8_t *numbers, lanes corner[3][3])
{
    sc_floats4 x[4];
    uint8_t place[SC_LANES_COUNT];
    int c, i, k;
    for (c = 0; c < 3; c++, where += SC_LANES_COUNT) {
        sc_quad_places(where, place);
        for (i = 0; i < 4; i++) {
            SC_UNROLL
            for (k = 0; k < 4; k++) x[k] = sc_quad_at(at, place[numbers[4 * i + k]]);
            sc_quad_transpose(x);
            SC_UNROLL
            for (k = 0; k < 3; k++) corner[c][k].v[i] = x[k];
        }
    }
}

#else

static inline void lanes_corners(const lanes at[3], const uint8_t *where, lanes corner[3][3])
{
    int c, k;
    SC_UNROLL
    for (c = 0; c < 3; c++) {
        lanes_index from = lanes_index_load(where + SC_LANES_COUNT * c);
        SC_UNROLL
        for (k = 0; k < 3; k++) corner[c][k] = lanes_pick_of(at[k], from);
    }
}
static inline void lanes_corners_at(const float *at, const uint8_t *where, lanes corner[3][3])
{
    lanes row[3];
    lanes_coordinates(at, row);
    lanes_corners(row, where, corner);
}
static inline void lanes_corners_through(const float *at, const uint8_t *where,
                                         const uint8_t *numbers, lanes corner[3][3])
{
    lanes row[3];
    int c, k;
    lanes_coordinates(at, row);
    SC_UNROLL
    for (c = 0; c < 3; c++) {
        lanes_index from = lanes_index_through(where + SC_LANES_COUNT * c, numbers);
        SC_UNROLL
        for (k = 0; k < 3; k++) corner[c][k] = lanes_pick_of(row[k], from);
    }
}

#endif

static inline void lanes_corners_two(const float *const at[2], const uint8_t *const where[2],
                                     const uint8_t *numbers, unsigned split, lanes corner[3][3])
{
    const lanes_mask second = lanes_from(split);
    lanes other[3][3];
    int c, k;
    lanes_corners_through(at[0], where[0], numbers, corner);
    lanes_corners_through(at[1], where[1], numbers, other);
    SC_UNROLL
    for (c = 0; c < 3; c++) {
        SC_UNROLL
        for (k = 0; k < 3; k++) corner[c][k] = lanes_choose(second, other[c][k], corner[c][k]);
    }
}
