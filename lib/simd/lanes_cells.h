/*
 * Sixteen cells of a grid of 256 by 256 at a time, or boxes of cells. A part of simd/lanes.h.
 *
 * SPDX-License-Identifier: MIT
 *
 * A cell is four bytes of a word, from the lowest: x, y, 255 - x and 255 - y; lanes_cells_of makes
 * sixteen of floats 2^23 + x and 2^23 + y. A box is the least x and y, and 255 less the greatest;
 * lanes_cells_joined takes the smaller of each byte of two cells or boxes. lanes_cells_reach of
 * boxes, without a byte that is 0, is what other boxes are compared with. lanes_cells_note notes
 * lanes in which a box overlaps that of which the reach is, or lies in cells beside it, and
 * lanes_cells_noted makes bit i for lane i if that was noted since lanes_cells_none.
 */

/*
 * A box overlaps another, or lies beside it, if its least x is at most 1 above the greatest of the
 * other, and 255 less its greatest x at most 1 above 255 less the least of the other; likewise y.
 * So the reach has 256 less each byte of a box, those of least and greatest exchanged, and no byte
 * of the other box may be above it.
 */
#if SC_LANES_AVX512

typedef __m512i lanes_cells;

static inline lanes_cells lanes_cells_of(lanes x, lanes y)
{
    const __m512i lower = _mm512_set1_epi32(0xffff);
    __m512i both =
        _mm512_xor_si512(_mm512_castps_si512(x), _mm512_slli_epi32(_mm512_castps_si512(y), 8));
    /* of the lower half as it is, of the upper the opposite of what is moved there */
    return _mm512_ternarylogic_epi32(lower, both, _mm512_slli_epi32(both, 16), 0xc5);
}
static inline lanes_cells lanes_cells_load(const uint32_t *cells)
{
    return _mm512_loadu_si512(cells);
}
static inline void lanes_cells_store(uint32_t *cells, lanes_cells a)
{
    _mm512_storeu_si512(cells, a);
}
static inline lanes_cells lanes_cells_joined(lanes_cells a, lanes_cells b)
{
    return _mm512_min_epu8(a, b);
}
static inline lanes_cells lanes_cells_reach(lanes_cells a)
{
    return _mm512_rol_epi32(_mm512_sub_epi8(_mm512_setzero_si512(), a), 16);
}
static inline lanes_cells lanes_cells_none(void)
{
    return _mm512_set1_epi32(-1);
}
static inline lanes_cells lanes_cells_note(lanes_cells noted, lanes_cells box, lanes_cells reach)
{
    return _mm512_min_epu32(noted, _mm512_subs_epu8(box, reach));
}
static inline unsigned lanes_cells_noted(lanes_cells noted)
{
    return _mm512_testn_epi32_mask(noted, noted);
}

#elif SC_LANES_AVX2

typedef struct lanes_cells {
    __m256i v[2];
} lanes_cells;

#  define SC_CELLS_MAP(f)                                                                          \
    lanes_cells r;                                                                                 \
    r.v[0] = f(0);                                                                                 \
    r.v[1] = f(1);                                                                                 \
    return r
static inline __m256i lanes_eight_cells(__m256i x, __m256i y)
{
    const __m256i lower = _mm256_set1_epi32(0xffff);
    __m256i both = _mm256_xor_si256(x, _mm256_slli_epi32(y, 8));
    both = _mm256_blend_epi16(_mm256_slli_epi32(both, 16), both, 0x55);
    return _mm256_xor_si256(both, _mm256_andnot_si256(lower, _mm256_set1_epi32(-1)));
}
static inline lanes_cells lanes_cells_of(lanes x, lanes y)
{
#  define SC_CELLS_F(i) lanes_eight_cells(_mm256_castps_si256(x.v[i]), _mm256_castps_si256(y.v[i]))
    SC_CELLS_MAP(SC_CELLS_F);
#  undef SC_CELLS_F
}
static inline lanes_cells lanes_cells_load(const uint32_t *cells)
{
#  define SC_CELLS_F(i) _mm256_loadu_si256((const __m256i *)(const void *)(cells + 8 * (i)))
    SC_CELLS_MAP(SC_CELLS_F);
#  undef SC_CELLS_F
}
static inline void lanes_cells_store(uint32_t *cells, lanes_cells a)
{
    _mm256_storeu_si256((__m256i *)(void *)cells, a.v[0]);
    _mm256_storeu_si256((__m256i *)(void *)(cells + 8), a.v[1]);
}
static inline lanes_cells lanes_cells_joined(lanes_cells a, lanes_cells b)
{
#  define SC_CELLS_F(i) _mm256_min_epu8(a.v[i], b.v[i])
    SC_CELLS_MAP(SC_CELLS_F);
#  undef SC_CELLS_F
}
static inline __m256i lanes_eight_reaches(__m256i a)
{
    a = _mm256_sub_epi8(_mm256_setzero_si256(), a);
    return _mm256_or_si256(_mm256_slli_epi32(a, 16), _mm256_srli_epi32(a, 16));
}
static inline lanes_cells lanes_cells_reach(lanes_cells a)
{
#  define SC_CELLS_F(i) lanes_eight_reaches(a.v[i])
    SC_CELLS_MAP(SC_CELLS_F);
#  undef SC_CELLS_F
}
static inline lanes_cells lanes_cells_none(void)
{
#  define SC_CELLS_F(i) _mm256_set1_epi32(-1)
    SC_CELLS_MAP(SC_CELLS_F);
#  undef SC_CELLS_F
}
static inline lanes_cells lanes_cells_note(lanes_cells noted, lanes_cells box, lanes_cells reach)
{
#  define SC_CELLS_F(i) _mm256_min_epu32(noted.v[i], _mm256_subs_epu8(box.v[i], reach.v[i]))
    SC_CELLS_MAP(SC_CELLS_F);
#  undef SC_CELLS_F
}
static inline unsigned lanes_eight_noted(__m256i noted)
{
    noted = _mm256_cmpeq_epi32(noted, _mm256_setzero_si256());
    return (unsigned)_mm256_movemask_ps(_mm256_castsi256_ps(noted));
}
static inline unsigned lanes_cells_noted(lanes_cells noted)
{
    return lanes_eight_noted(noted.v[0]) | lanes_eight_noted(noted.v[1]) << 8;
}
#  undef SC_CELLS_MAP

#elif SC_LANES_QUADS

/* What is noted are masks. */
#  if SC_LANES_SSE2

typedef __m128i lanes_four_cells;

static inline __m128i lanes_cells_at(sc_floats4 x, sc_floats4 y)
{
    __m128i both = _mm_xor_si128(_mm_castps_si128(x), _mm_slli_epi32(_mm_castps_si128(y), 8));
    __m128i lower = _mm_and_si128(both, _mm_set1_epi32(0xffff));
    return _mm_xor_si128(_mm_or_si128(lower, _mm_slli_epi32(lower, 16)),
                         _mm_set1_epi32((int)0xffff0000));
}
static inline __m128i lanes_four_joined(__m128i a, __m128i b)
{
    return _mm_min_epu8(a, b);
}
static inline __m128i lanes_four_reaches(__m128i a)
{
    a = _mm_sub_epi8(_mm_setzero_si128(), a);
    return _mm_or_si128(_mm_slli_epi32(a, 16), _mm_srli_epi32(a, 16));
}
static inline __m128i lanes_four_none(void)
{
    return _mm_setzero_si128();
}
static inline __m128i lanes_four_note(__m128i noted, __m128i box, __m128i reach)
{
    return _mm_or_si128(noted, _mm_cmpeq_epi32(_mm_subs_epu8(box, reach), _mm_setzero_si128()));
}
static inline sc_floats4 lanes_four_noted(__m128i noted)
{
    return _mm_castsi128_ps(noted);
}

#  else

typedef sc_words4 lanes_four_cells;

static inline sc_words4 lanes_cells_at(sc_floats4 x, sc_floats4 y)
{
    sc_words4 lower = ((sc_words4)x ^ (sc_words4)y << 8) & 0xffff;
    return (lower | lower << 16) ^ 0xffff0000;
}
static inline sc_words4 lanes_four_joined(sc_words4 a, sc_words4 b)
{
    sc_bytes16 below = (sc_bytes16)((sc_bytes16)a < (sc_bytes16)b);
    return ((sc_words4)below & a) | (~(sc_words4)below & b);
}
static inline sc_words4 lanes_four_reaches(sc_words4 a)
{
    a = (sc_words4)(-(sc_bytes16)a);
    return a << 16 | a >> 16;
}
static inline sc_words4 lanes_four_none(void)
{
    return (sc_words4){0, 0, 0, 0};
}
static inline sc_words4 lanes_four_note(sc_words4 noted, sc_words4 box, sc_words4 reach)
{
    sc_words4 apart = (sc_words4)((sc_bytes16)box > (sc_bytes16)reach);
    return noted | (sc_words4)(apart == 0);
}
static inline sc_floats4 lanes_four_noted(sc_words4 noted)
{
    return (sc_floats4)noted;
}

#  endif

typedef struct lanes_cells {
    lanes_four_cells v[4];
} lanes_cells;

#  define SC_CELLS_EACH(expression)                                                                \
    lanes_cells r;                                                                                 \
    int i;                                                                                         \
    SC_UNROLL                                                                                      \
    for (i = 0; i < 4; i++) r.v[i] = (expression);                                                 \
    return r
static inline lanes_cells lanes_cells_of(lanes x, lanes y)
{
    SC_CELLS_EACH(lanes_cells_at(x.v[i], y.v[i]));
}
static inline lanes_cells lanes_cells_load(const uint32_t *cells)
{
    lanes_cells r;
    memcpy(&r, cells, sizeof r);
    return r;
}
static inline void lanes_cells_store(uint32_t *cells, lanes_cells a)
{
    memcpy(cells, &a, sizeof a);
}
static inline lanes_cells lanes_cells_joined(lanes_cells a, lanes_cells b)
{
    SC_CELLS_EACH(lanes_four_joined(a.v[i], b.v[i]));
}
static inline lanes_cells lanes_cells_reach(lanes_cells a)
{
    SC_CELLS_EACH(lanes_four_reaches(a.v[i]));
}
static inline lanes_cells lanes_cells_none(void)
{
    SC_CELLS_EACH(lanes_four_none());
}
static inline lanes_cells lanes_cells_note(lanes_cells noted, lanes_cells box, lanes_cells reach)
{
    SC_CELLS_EACH(lanes_four_note(noted.v[i], box.v[i], reach.v[i]));
}
static inline unsigned lanes_cells_noted(lanes_cells noted)
{
    lanes four;
    int i;
    SC_UNROLL
    for (i = 0; i < 4; i++) four.v[i] = lanes_four_noted(noted.v[i]);
    return lanes_bits(four);
}
#  undef SC_CELLS_EACH

#else

typedef struct lanes_cells {
    uint32_t v[SC_LANES_COUNT];
} lanes_cells;

#  define SC_CELLS_EACH(expression)                                                                \
    lanes_cells r;                                                                                 \
    int i;                                                                                         \
    for (i = 0; i < SC_LANES_COUNT; i++) r.v[i] = (expression);                                    \
    return r
static inline uint32_t lanes_cell(float x, float y)
{
    uint32_t cell = ((uint32_t)x & 255u) | ((uint32_t)y & 255u) << 8;
    return (cell | cell << 16) ^ 0xffff0000u;
}
static inline lanes_cells lanes_cells_of(lanes x, lanes y)
{
    SC_CELLS_EACH(lanes_cell(x.v[i], y.v[i]));
}
static inline lanes_cells lanes_cells_load(const uint32_t *cells)
{
    SC_CELLS_EACH(cells[i]);
}
static inline void lanes_cells_store(uint32_t *cells, lanes_cells a)
{
    memcpy(cells, a.v, sizeof a.v);
}
static inline uint32_t lanes_one_joined(uint32_t a, uint32_t b)
{
    uint32_t r = 0, byte;
    for (byte = 255; byte; byte <<= 8) r |= (a & byte) < (b & byte) ? a & byte : b & byte;
    return r;
}
static inline lanes_cells lanes_cells_joined(lanes_cells a, lanes_cells b)
{
    SC_CELLS_EACH(lanes_one_joined(a.v[i], b.v[i]));
}
static inline uint32_t lanes_one_reach(uint32_t a)
{
    a = ~a + 0x01010101u; /* no byte is 0 */
    return a << 16 | a >> 16;
}
static inline lanes_cells lanes_cells_reach(lanes_cells a)
{
    SC_CELLS_EACH(lanes_one_reach(a.v[i]));
}
static inline lanes_cells lanes_cells_none(void)
{
    SC_CELLS_EACH(0);
}
static inline lanes_cells lanes_cells_note(lanes_cells noted, lanes_cells box, lanes_cells reach)
{
    SC_CELLS_EACH(noted.v[i] | (lanes_one_joined(box.v[i], reach.v[i]) == box.v[i]));
}
static inline unsigned lanes_cells_noted(lanes_cells noted)
{
    unsigned bits = 0, i;
    for (i = 0; i < SC_LANES_COUNT; i++) bits |= (unsigned)(noted.v[i] != 0) << i;
    return bits;
}
#  undef SC_CELLS_EACH

#endif

static inline lanes_cells lanes_cells_all(uint32_t cell)
{
#if SC_LANES_AVX512
    return _mm512_set1_epi32((int)cell);
#else
    uint32_t all[SC_LANES_COUNT];
    int i;
    for (i = 0; i < SC_LANES_COUNT; i++) all[i] = cell;
    return lanes_cells_load(all);
#endif
}
