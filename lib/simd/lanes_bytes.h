/*
 * Sixteen bytes at a time, one for each of sixteen lanes: numbers below sixteen, of points of a
 * leaf cluster. A part of simd/lanes.h.
 *
 * SPDX-License-Identifier: MIT
 *
 * Masks are bytes of all bits or none; lanes_bytes_choose takes from a where one is set, else from
 * b, and lanes_bytes_bits makes bit i for byte i. lanes_bytes_quarters has the four lowest bits of
 * each of sixteen words, the four above, and so on. lanes_bytes_through reads a row by numbers
 * below sixteen. lanes_triples are three rows, which lanes_triples_through reads by the same
 * numbers. lanes_names tells for each of sixteen numbers b where among sixteen others it first is,
 * or 255 if nowhere. lanes_index_of makes numbers of lanes (simd/lanes_pick.h) of them.
 * lanes_list_rows takes from rows of numbers those of these lanes, adds to those of each row a
 * number of its own, and writes them as rows of so many words, room for sixteen in each.
 * lanes_edges_of reads points of two tables, in transposed places (see simd/lanes.h), by numbers:
 * the first of three of one is subtracted from the other two, then from two of the other.
 */

#if SC_LANES_AVX512 || SC_LANES_AVX2 || SC_LANES_SSE2

typedef __m128i lanes_bytes;

static inline lanes_bytes lanes_bytes_load(const uint8_t *bytes)
{
    return _mm_loadu_si128((const __m128i *)(const void *)bytes);
}
static inline void lanes_bytes_store(uint8_t *bytes, lanes_bytes a)
{
    _mm_storeu_si128((__m128i *)(void *)bytes, a);
}
static inline lanes_bytes lanes_bytes_same(lanes_bytes a, lanes_bytes b)
{
    return _mm_cmpeq_epi8(a, b);
}
static inline lanes_bytes lanes_bytes_both(lanes_bytes a, lanes_bytes b)
{
    return _mm_and_si128(a, b);
}
static inline lanes_bytes lanes_bytes_either(lanes_bytes a, lanes_bytes b)
{
    return _mm_or_si128(a, b);
}
static inline lanes_bytes lanes_bytes_but(lanes_bytes a, lanes_bytes b)
{
    return _mm_andnot_si128(b, a);
}
static inline unsigned lanes_bytes_bits(lanes_bytes a)
{
    return (unsigned)_mm_movemask_epi8(a);
}

#elif SC_LANES_QUADS

typedef sc_bytes16 lanes_bytes;

static inline lanes_bytes lanes_bytes_load(const uint8_t *bytes)
{
    lanes_bytes r;
    memcpy(&r, bytes, sizeof r);
    return r;
}
static inline void lanes_bytes_store(uint8_t *bytes, lanes_bytes a)
{
    memcpy(bytes, &a, sizeof a);
}
static inline lanes_bytes lanes_bytes_same(lanes_bytes a, lanes_bytes b)
{
    return (lanes_bytes)(a == b);
}
static inline lanes_bytes lanes_bytes_both(lanes_bytes a, lanes_bytes b)
{
    return a & b;
}
static inline lanes_bytes lanes_bytes_either(lanes_bytes a, lanes_bytes b)
{
    return a | b;
}
static inline lanes_bytes lanes_bytes_but(lanes_bytes a, lanes_bytes b)
{
    return a & ~b;
}
/* A bit of each byte; the sum of eight such bytes is in the highest byte of their product with
   ones. */
static inline unsigned lanes_bytes_bits(lanes_bytes a)
{
    const lanes_bytes bit = {1, 2, 4, 8, 16, 32, 64, 128, 1, 2, 4, 8, 16, 32, 64, 128};
    sc_numbers2 eight = (sc_numbers2)(a & bit);
    const uint64_t ones = 0x0101010101010101u;
    return (unsigned)((uint64_t)eight[0] * ones >> 56 | (uint64_t)eight[1] * ones >> 56 << 8);
}

#else

typedef struct lanes_bytes {
    uint8_t v[SC_LANES_COUNT];
} lanes_bytes;

#  define SC_BYTES_EACH(expression)                                                                \
    lanes_bytes r;                                                                                 \
    int i;                                                                                         \
    for (i = 0; i < SC_LANES_COUNT; i++) r.v[i] = (uint8_t)(expression);                           \
    return r

static inline lanes_bytes lanes_bytes_load(const uint8_t *bytes)
{
    SC_BYTES_EACH(bytes[i]);
}
static inline void lanes_bytes_store(uint8_t *bytes, lanes_bytes a)
{
    memcpy(bytes, a.v, sizeof a.v);
}
static inline lanes_bytes lanes_bytes_same(lanes_bytes a, lanes_bytes b)
{
    SC_BYTES_EACH(a.v[i] == b.v[i] ? 255 : 0);
}
static inline lanes_bytes lanes_bytes_both(lanes_bytes a, lanes_bytes b)
{
    SC_BYTES_EACH(a.v[i] & b.v[i]);
}
static inline lanes_bytes lanes_bytes_either(lanes_bytes a, lanes_bytes b)
{
    SC_BYTES_EACH(a.v[i] | b.v[i]);
}
static inline lanes_bytes lanes_bytes_but(lanes_bytes a, lanes_bytes b)
{
    SC_BYTES_EACH(a.v[i] & ~b.v[i]);
}
static inline unsigned lanes_bytes_bits(lanes_bytes a)
{
    unsigned bits = 0, i;
    for (i = 0; i < SC_LANES_COUNT; i++) bits |= (a.v[i] & 1u) << i;
    return bits;
}
#  undef SC_BYTES_EACH

#endif

static inline lanes_bytes lanes_bytes_all(uint8_t number)
{
#if SC_LANES_AVX512 || SC_LANES_AVX2 || SC_LANES_SSE2
    return _mm_set1_epi8((char)number);
#else
    uint8_t bytes[SC_LANES_COUNT];
    memset(bytes, number, sizeof bytes);
    return lanes_bytes_load(bytes);
#endif
}

static inline void lanes_bytes_quarters(const uint16_t *words, lanes_bytes quarter[4])
{
#if SC_LANES_AVX512 || SC_LANES_AVX2 || SC_LANES_SSE2
    const __m128i byte = _mm_set1_epi16(255), lowest = _mm_set1_epi8(15);
    const __m128i *from = (const __m128i *)(const void *)words;
    __m128i a = _mm_loadu_si128(from), b = _mm_loadu_si128(from + 1), half[2];
    int k;
    half[0] = _mm_packus_epi16(_mm_and_si128(a, byte), _mm_and_si128(b, byte));
    half[1] = _mm_packus_epi16(_mm_srli_epi16(a, 8), _mm_srli_epi16(b, 8));
    SC_UNROLL
    for (k = 0; k < 2; k++) {
        quarter[2 * k] = _mm_and_si128(half[k], lowest);
        quarter[2 * k + 1] = _mm_and_si128(_mm_srli_epi16(half[k], 4), lowest);
    }
#else
    uint8_t byte[4][SC_LANES_COUNT];
    int i, k;
    SC_UNROLL
    for (k = 0; k < 4; k++) {
        for (i = 0; i < SC_LANES_COUNT; i++) byte[k][i] = (uint8_t)(words[i] >> 4 * k & 15u);
        quarter[k] = lanes_bytes_load(byte[k]);
    }
#endif
}

#if SC_LANES_AVX512 || SC_LANES_AVX2

static inline lanes_bytes lanes_bytes_choose(lanes_bytes m, lanes_bytes a, lanes_bytes b)
{
    return _mm_blendv_epi8(b, a, m);
}
static inline lanes_bytes lanes_bytes_through(lanes_bytes row, lanes_bytes numbers)
{
    return _mm_shuffle_epi8(row, numbers);
}

typedef struct lanes_triples {
    lanes_bytes row[3];
} lanes_triples;

static inline lanes_triples lanes_triples_of(const lanes_bytes row[3])
{
    lanes_triples r;
    int k;
    SC_UNROLL
    for (k = 0; k < 3; k++) r.row[k] = row[k];
    return r;
}
static inline void lanes_triples_through(const lanes_triples *t, const uint8_t *numbers,
                                         lanes_bytes to[3])
{
    lanes_bytes from = lanes_bytes_load(numbers);
    int k;
    SC_UNROLL
    for (k = 0; k < 3; k++) to[k] = _mm_shuffle_epi8(t->row[k], from);
}
static inline lanes_index lanes_index_of(lanes_bytes numbers)
{
#  if SC_LANES_AVX512
    return _mm512_cvtepu8_epi32(numbers);
#  else
    lanes_index r;
    r.v[0] = _mm256_cvtepu8_epi32(numbers);
    r.v[1] = _mm256_cvtepu8_epi32(_mm_srli_si128(numbers, 8));
    return r;
#  endif
}
static SC_INLINE void lanes_edges_of(const float *a, const float *b, const lanes_bytes of_a[3],
                                     const lanes_bytes of_b[2], lanes edge[2][2][3])
{
    lanes row[2][3];
    lanes_index at[5];
    int s, k, c;
    lanes_coordinates(a, row[0]);
    lanes_coordinates(b, row[1]);
    SC_UNROLL
    for (k = 0; k < 3; k++) at[k] = lanes_index_of(of_a[k]);
    SC_UNROLL
    for (k = 0; k < 2; k++) at[3 + k] = lanes_index_of(of_b[k]);
    SC_UNROLL
    for (c = 0; c < 3; c++) {
        lanes from = lanes_pick_of(row[0][c], at[0]);
        SC_UNROLL
        for (s = 0; s < 2; s++) {
            SC_UNROLL
            for (k = 0; k < 2; k++)
                edge[s][k][c] = lanes_subtract(lanes_pick_of(row[s][c], at[1 + 2 * s + k]), from);
        }
    }
}

#else

static inline lanes_bytes lanes_bytes_choose(lanes_bytes m, lanes_bytes a, lanes_bytes b)
{
    return lanes_bytes_either(lanes_bytes_both(m, a), lanes_bytes_but(b, m));
}
static inline lanes_bytes lanes_bytes_through(lanes_bytes row, lanes_bytes numbers)
{
    uint8_t from[SC_LANES_COUNT], number[SC_LANES_COUNT], to[SC_LANES_COUNT];
    int i;
    lanes_bytes_store(from, row);
    lanes_bytes_store(number, numbers);
    for (i = 0; i < SC_LANES_COUNT; i++) to[i] = from[number[i]];
    return lanes_bytes_load(to);
}

static inline lanes_index lanes_index_of(lanes_bytes numbers)
{
    lanes_index r;
    lanes_bytes_store(r.at, numbers);
    return r;
}

/* The three of each lane together, to be read at once. */
typedef struct lanes_triples {
    uint32_t of[SC_LANES_COUNT];
} lanes_triples;

static inline lanes_triples lanes_triples_of(const lanes_bytes row[3])
{
    uint8_t byte[3][SC_LANES_COUNT];
    lanes_triples r;
    int i, k;
    for (k = 0; k < 3; k++) lanes_bytes_store(byte[k], row[k]);
    for (i = 0; i < SC_LANES_COUNT; i++)
        r.of[i] = byte[0][i] | (uint32_t)byte[1][i] << 8 | (uint32_t)byte[2][i] << 16;
    return r;
}

#  if SC_LANES_SSE2

/* The lowest bytes of four registers of four numbers. */
static inline lanes_bytes lanes_lowest(const __m128i four[4])
{
    const __m128i lowest = _mm_set1_epi32(255);
    return _mm_packus_epi16(
        _mm_packs_epi32(_mm_and_si128(four[0], lowest), _mm_and_si128(four[1], lowest)),
        _mm_packs_epi32(_mm_and_si128(four[2], lowest), _mm_and_si128(four[3], lowest)));
}
static inline void lanes_triples_through(const lanes_triples *t, const uint8_t *numbers,
                                         lanes_bytes to[3])
{
    __m128i four[4];
    int i, k;
    SC_UNROLL
    for (i = 0; i < 4; i++) {
        const uint8_t *n = numbers + 4 * i;
        four[i] =
            _mm_setr_epi32((int)t->of[n[0]], (int)t->of[n[1]], (int)t->of[n[2]], (int)t->of[n[3]]);
    }
    SC_UNROLL
    for (k = 0; k < 3; k++) {
        to[k] = lanes_lowest(four);
        SC_UNROLL
        for (i = 0; i < 4; i++) four[i] = _mm_srli_epi32(four[i], 8);
    }
}

#  else

static inline void lanes_triples_through(const lanes_triples *t, const uint8_t *numbers,
                                         lanes_bytes to[3])
{
    uint32_t three[SC_LANES_COUNT];
    uint8_t byte[3][SC_LANES_COUNT];
    int i, k;
    for (i = 0; i < SC_LANES_COUNT; i++) three[i] = t->of[numbers[i]];
    SC_UNROLL
    for (k = 0; k < 3; k++) {
        for (i = 0; i < SC_LANES_COUNT; i++) byte[k][i] = (uint8_t)(three[i] >> 8 * k);
        to[k] = lanes_bytes_load(byte[k]);
    }
}

#  endif

#  if SC_LANES_QUADS

static SC_INLINE void lanes_edges_of(const float *a, const float *b, const lanes_bytes of_a[3],
                                     const lanes_bytes of_b[2], lanes edge[2][2][3])
{
    uint8_t place[5][SC_LANES_COUNT];
    int i, j, k, c;
    SC_UNROLL
    for (k = 0; k < 5; k++) {
        lanes_bytes_store(place[k], k < 3 ? of_a[k] : of_b[k - 3]);
        sc_quad_places(place[k], place[k]);
    }
    for (i = 0; i < 4; i++) {
        sc_floats4 from[4], x[4];
        SC_UNROLL
        for (j = 0; j < 4; j++) from[j] = sc_quad_at(a, place[0][4 * i + j]);
        SC_UNROLL
        for (k = 0; k < 4; k++) {
            SC_UNROLL
            for (j = 0; j < 4; j++)
                x[j] = SC_QUAD(sub_ps)(sc_quad_at(k < 2 ? a : b, place[1 + k][4 * i + j]), from[j]);
            sc_quad_transpose(x);
            SC_UNROLL
            for (c = 0; c < 3; c++) edge[k / 2][k % 2][c].v[i] = x[c];
        }
    }
}

#  else

static inline void lanes_edges_of(const float *a, const float *b, const lanes_bytes of_a[3],
                                  const lanes_bytes of_b[2], lanes edge[2][2][3])
{
    int i, k, c;
    for (i = 0; i < SC_LANES_COUNT; i++) {
        unsigned p = of_a[0].v[i];
        for (k = 0; k < 4; k++) {
            unsigned q = k < 2 ? of_a[1 + k].v[i] : of_b[k - 2].v[i];
            const float *from = a + 16 * (p & 3) + p / 4 * 4;
            const float *to = (k < 2 ? a : b) + 16 * (q & 3) + q / 4 * 4;
            for (c = 0; c < 3; c++) edge[k / 2][k % 2][c].v[i] = to[c] - from[c];
        }
    }
}

#  endif
#endif

#if SC_LANES_AVX512

static SC_INLINE void lanes_list_rows(unsigned mask, const lanes_bytes row[], const uint32_t add[],
                                      int rows, uint32_t *to, int length)
{
    int k;
    SC_UNROLL
    for (k = 0; k < rows; k++) {
        __m512i all = _mm512_add_epi32(lanes_index_of(row[k]), _mm512_set1_epi32((int)add[k]));
        _mm512_storeu_si512(to + k * length, _mm512_maskz_compress_epi32((__mmask16)mask, all));
    }
}

#else

static SC_INLINE void lanes_list_rows(unsigned mask, const lanes_bytes row[], const uint32_t add[],
                                      int rows, uint32_t *to, int length)
{
    for (; mask; mask &= mask - 1, to++) {
        uint32_t lane = sc_bits_lowest(mask);
        int k;
        for (k = 0; k < rows; k++)
            to[k * length] = add[k] + ((const uint8_t *)(const void *)&row[k])[lane];
    }
}

#endif

/* The last of sixteen is compared first, so that the first that is the same is what stays. */
#if SC_LANES_AVX512

static inline lanes_bytes lanes_names(const uint32_t *a, const uint32_t *b)
{
    __m512i other = _mm512_loadu_si512(b), name = _mm512_set1_epi32(255);
    int i;
    SC_UNROLL
    for (i = 15; i >= 0; i--)
        name = _mm512_mask_mov_epi32(name,
                                     _mm512_cmpeq_epi32_mask(other, _mm512_set1_epi32((int)a[i])),
                                     _mm512_set1_epi32(i));
    return _mm512_cvtepi32_epi8(name);
}

#elif SC_LANES_AVX2

static inline lanes_bytes lanes_names(const uint32_t *a, const uint32_t *b)
{
    __m256i other[2], name[2], both;
    int i, k;
    SC_UNROLL
    for (k = 0; k < 2; k++) {
        other[k] = _mm256_loadu_si256((const __m256i *)(const void *)(b + 8 * k));
        name[k] = _mm256_set1_epi32(255);
    }
    SC_UNROLL
    for (i = 15; i >= 0; i--) {
        const __m256i one = _mm256_set1_epi32((int)a[i]), number = _mm256_set1_epi32(i);
        SC_UNROLL
        for (k = 0; k < 2; k++)
            name[k] = _mm256_blendv_epi8(name[k], number, _mm256_cmpeq_epi32(other[k], one));
    }
    both = _mm256_permute4x64_epi64(_mm256_packs_epi32(name[0], name[1]), 0xd8);
    return _mm_packus_epi16(_mm256_castsi256_si128(both), _mm256_extracti128_si256(both, 1));
}

#elif SC_LANES_SSE2

/* What is kept is 255 less a number, the largest of which is that of the first; 0 if there is
   none. */
static inline lanes_bytes lanes_names(const uint32_t *a, const uint32_t *b)
{
    __m128i other[4], kept[4];
    int i, k;
    SC_UNROLL
    for (k = 0; k < 4; k++) {
        other[k] = _mm_loadu_si128((const __m128i *)(const void *)(b + 4 * k));
        kept[k] = _mm_setzero_si128();
    }
    SC_UNROLL
    for (i = 0; i < 16; i++) {
        const __m128i one = _mm_set1_epi32((int)a[i]), number = _mm_set1_epi32(255 - i);
        SC_UNROLL
        for (k = 0; k < 4; k++)
            kept[k] = _mm_max_epi16(kept[k], _mm_and_si128(_mm_cmpeq_epi32(other[k], one), number));
    }
    return _mm_xor_si128(lanes_lowest(kept), _mm_set1_epi8(-1));
}

#else

static inline lanes_bytes lanes_names(const uint32_t *a, const uint32_t *b)
{
    uint32_t name[SC_LANES_COUNT], i, k;
    uint8_t byte[SC_LANES_COUNT];
    for (k = 0; k < SC_LANES_COUNT; k++) name[k] = 255;
    for (i = SC_LANES_COUNT; i-- > 0;)
        for (k = 0; k < SC_LANES_COUNT; k++) name[k] = a[i] == b[k] ? i : name[k];
    for (k = 0; k < SC_LANES_COUNT; k++) byte[k] = (uint8_t)name[k];
    return lanes_bytes_load(byte);
}

#endif
