/*
 * The box of an array of positions. See positions.h.
 *
 * SPDX-License-Identifier: MIT
 *
 * Widens low and high by `some` vertices, one or more; 0 if a coordinate is NaN or infinite.
 *
 * Packed: three registers hold the coordinates of whole vertices: lane i of the three together is
 * coordinate i % 3. They are registers of the machine, as those of sixteen floats or eight doubles
 * are too many. Sums of what is finite are finite, unless that is huge: where they are not, all is
 * looked at number by number.
 */

#if SC_LANES_AVX512
#  define EXTENT(name) _mm512_##name
#  define EXTENT_DOUBLES __m512d
#  define EXTENT_FLOATS __m512
#elif SC_LANES_AVX2
#  define EXTENT(name) _mm256_##name
#  define EXTENT_DOUBLES __m256d
#  define EXTENT_FLOATS __m256
#elif SC_LANES_QUADS
#  define EXTENT(name) SC_QUAD(name)
#  define EXTENT_DOUBLES sc_doubles2
#  define EXTENT_FLOATS sc_floats4
#endif

/* Widens the box by the least and the most of some coordinates k; NaN does not. */
static inline void widen(double least, double most, int k, double low[3], double high[3])
{
    low[k] = least < low[k] ? least : low[k];
    high[k] = most > high[k] ? most : high[k];
}

#ifdef EXTENT
/* Asks for so many bytes a page ahead: what processors foresee by themselves ends with the page. */
static SC_INLINE void fetch_ahead(const void *at, uintptr_t bytes)
{
    enum { PAGE = 4096, LINE = 64 };
    uintptr_t i; /* of an address: it may be behind all positions */
    SC_UNROLL
    for (i = 0; i < bytes; i += LINE) sc_fetch((const void *)((uintptr_t)at + PAGE + i));
}
#endif

static int extent_of_doubles(const double *p, uint64_t some, double low[3], double high[3])
{
    uint64_t count = 3 * some, i = 0;
    double not_finite = 0;
#ifdef EXTENT
    enum { WIDTH = sizeof(EXTENT_DOUBLES) / sizeof(double), AT_ONCE = 3 * WIDTH };
    if (count >= AT_ONCE) {
        EXTENT_DOUBLES lows[3], highs[3], sums[3], x;
        double least[AT_ONCE], most[AT_ONCE], sum[AT_ONCE];
        int j, k;
        SC_UNROLL
        for (k = 0; k < 3; k++) lows[k] = highs[k] = sums[k] = EXTENT(loadu_pd)(p + WIDTH * k);
        for (i = AT_ONCE; i + AT_ONCE <= count; i += AT_ONCE) {
            fetch_ahead(p + i, AT_ONCE * sizeof *p);
            SC_UNROLL
            for (k = 0; k < 3; k++) {
                x = EXTENT(loadu_pd)(p + i + WIDTH * (uint64_t)k);
                lows[k] = EXTENT(min_pd)(x, lows[k]);
                highs[k] = EXTENT(max_pd)(x, highs[k]);
                sums[k] = EXTENT(add_pd)(sums[k], x);
            }
        }
        for (k = 0; k < 3; k++) {
            EXTENT(storeu_pd)(least + WIDTH * k, lows[k]);
            EXTENT(storeu_pd)(most + WIDTH * k, highs[k]);
            EXTENT(storeu_pd)(sum + WIDTH * k, sums[k]);
        }
        for (j = 0; j < AT_ONCE; j++) {
            widen(least[j], most[j], j % 3, low, high);
            not_finite += sum[j] - sum[j];
        }
        if (not_finite != 0) {
            not_finite = 0;
            i = 0;
        }
    }
#endif
    for (; i < count; i++) {
        widen(p[i], p[i], (int)(i % 3), low, high);
        not_finite += p[i] - p[i];
    }
    return not_finite == 0; /* NaN is not 0 */
}

static int extent_of_floats(const float *p, uint64_t some, double low[3], double high[3])
{
    uint64_t count = 3 * some, i = 0;
    float not_finite = 0;
#ifdef EXTENT
    enum { WIDTH = sizeof(EXTENT_FLOATS) / sizeof(float), AT_ONCE = 3 * WIDTH };
    if (count >= AT_ONCE) {
        EXTENT_FLOATS lows[3], highs[3], sums[3], x;
        float least[AT_ONCE], most[AT_ONCE], sum[AT_ONCE];
        int j, k;
        SC_UNROLL
        for (k = 0; k < 3; k++) lows[k] = highs[k] = sums[k] = EXTENT(loadu_ps)(p + WIDTH * k);
        for (i = AT_ONCE; i + AT_ONCE <= count; i += AT_ONCE) {
            fetch_ahead(p + i, AT_ONCE * sizeof *p);
            SC_UNROLL
            for (k = 0; k < 3; k++) {
                x = EXTENT(loadu_ps)(p + i + WIDTH * (uint64_t)k);
                lows[k] = EXTENT(min_ps)(x, lows[k]);
                highs[k] = EXTENT(max_ps)(x, highs[k]);
                sums[k] = EXTENT(add_ps)(sums[k], x);
            }
        }
        for (k = 0; k < 3; k++) {
            EXTENT(storeu_ps)(least + WIDTH * k, lows[k]);
            EXTENT(storeu_ps)(most + WIDTH * k, highs[k]);
            EXTENT(storeu_ps)(sum + WIDTH * k, sums[k]);
        }
        for (j = 0; j < AT_ONCE; j++) {
            widen((double)least[j], (double)most[j], j % 3, low, high);
            not_finite += sum[j] - sum[j];
        }
        if (not_finite != 0) {
            not_finite = 0;
            i = 0;
        }
    }
#endif
    for (; i < count; i++) {
        widen((double)p[i], (double)p[i], (int)(i % 3), low, high);
        not_finite += p[i] - p[i];
    }
    return not_finite == 0; /* NaN is not 0 */
}

#undef EXTENT
#undef EXTENT_DOUBLES
#undef EXTENT_FLOATS

/* Vertices that are stride bytes apart. */
static int extent_of_apart_doubles(const double *p, uint64_t stride, uint64_t some, double low[3],
                                   double high[3])
{
    enum { WIDTH = 8 };
    const unsigned char *from = (const unsigned char *)(const void *)p;
    double least[WIDTH], most[WIDTH], bad[WIDTH], at[3], not_finite = 0;
    uint64_t i = 0;
    int j, k;
    if (some > WIDTH) {
        doubles lows[3], highs[3], x[3], zero = doubles_all(0);
        SC_UNROLL
        for (k = 0; k < 3; k++) lows[k] = highs[k] = doubles_all(p[k]);
        for (; i + WIDTH < some; i += WIDTH) {
            const unsigned char *place[WIDTH];
            SC_UNROLL
            for (j = 0; j < WIDTH; j++) place[j] = from + (i + (uint64_t)j) * stride;
            doubles_points(place, 0, x);
            SC_UNROLL
            for (k = 0; k < 3; k++) {
                lows[k] = doubles_smaller(x[k], lows[k]);
                highs[k] = doubles_larger(x[k], highs[k]);
                zero = doubles_add(zero, doubles_subtract(x[k], x[k]));
            }
        }
        for (k = 0; k < 3; k++) {
            doubles_store(least, lows[k]);
            doubles_store(most, highs[k]);
            for (j = 0; j < WIDTH; j++) {
                low[k] = least[j] < low[k] ? least[j] : low[k];
                high[k] = most[j] > high[k] ? most[j] : high[k];
            }
        }
        doubles_store(bad, zero);
        for (j = 0; j < WIDTH; j++) not_finite += bad[j];
    }
    for (; i < some; i++) {
        memcpy(at, from + i * stride, sizeof at);
        for (k = 0; k < 3; k++) {
            low[k] = at[k] < low[k] ? at[k] : low[k];
            high[k] = at[k] > high[k] ? at[k] : high[k];
            not_finite += at[k] - at[k];
        }
    }
    return not_finite == 0;
}

static int extent_of_apart_floats(const float *p, uint64_t stride, uint64_t some, double low[3],
                                  double high[3])
{
    enum { WIDTH = SC_LANES_COUNT };
    const unsigned char *from = (const unsigned char *)(const void *)p;
    float bad[WIDTH], at[3], not_finite = 0;
    uint64_t i = 0;
    int j, k;
    if (some > WIDTH) {
        lanes lows[3], highs[3], x[3], zero = lanes_all(0);
        SC_UNROLL
        for (k = 0; k < 3; k++) lows[k] = highs[k] = lanes_all(p[k]);
        for (; i + WIDTH < some; i += WIDTH) {
            const float *place[WIDTH];
            SC_UNROLL
            for (j = 0; j < WIDTH; j++)
                place[j] = (const float *)(const void *)(from + (i + (uint64_t)j) * stride);
            lanes_points(place, &x[0], &x[1], &x[2]);
            SC_UNROLL
            for (k = 0; k < 3; k++) {
                lows[k] = lanes_smaller(x[k], lows[k]);
                highs[k] = lanes_larger(x[k], highs[k]);
                zero = lanes_add(zero, lanes_subtract(x[k], x[k]));
            }
        }
        for (k = 0; k < 3; k++) {
            double least = (double)lanes_least(lows[k]), most = (double)lanes_most(highs[k]);
            low[k] = least < low[k] ? least : low[k];
            high[k] = most > high[k] ? most : high[k];
        }
        lanes_store(bad, zero);
        for (j = 0; j < WIDTH; j++) not_finite += bad[j];
    }
    for (; i < some; i++) {
        memcpy(at, from + i * stride, sizeof at);
        for (k = 0; k < 3; k++) {
            double d = (double)at[k];
            low[k] = d < low[k] ? d : low[k];
            high[k] = d > high[k] ? d : high[k];
            not_finite += at[k] - at[k];
        }
    }
    return not_finite == 0;
}
