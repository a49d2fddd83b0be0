/*
 * The box of an array of positions. See positions.h.
 *
 * SPDX-License-Identifier: MIT
 *
 * Widens low and high by `some` vertices, one or more; 0 if a coordinate is NaN or infinite.
 *
 * Packed: three registers hold the coordinates of whole vertices: lane i of the three together is coordinate i % 3.
 */

static int SC_KERNEL(extent_of_doubles)(const double *p, uint64_t some, double low[3],
                                        double high[3])
{
    enum { WIDTH = 8, AT_ONCE = 3 * WIDTH };
    uint64_t count = 3 * some, i = 0;
    double least[AT_ONCE], most[AT_ONCE], bad[WIDTH], not_finite = 0;
    int j, k;
    if (count >= AT_ONCE) {
        doubles lows[3], highs[3], x,
            zero = doubles_all(0); /* stays 0 unless something is not finite */
        SC_UNROLL
        for (k = 0; k < 3; k++) lows[k] = highs[k] = doubles_load(p + WIDTH * k);
        for (; i + AT_ONCE <= count; i += AT_ONCE) SC_UNROLL
        for (k = 0; k < 3; k++) {
            x = doubles_load(p + i + WIDTH * (uint64_t)k);
            lows[k] = doubles_smaller(x, lows[k]);
            highs[k] = doubles_larger(x, highs[k]);
            zero = doubles_add(zero, doubles_subtract(x, x));
        }
        SC_UNROLL
        for (k = 0; k < 3; k++) {
            doubles_store(least + WIDTH * k, lows[k]);
            doubles_store(most + WIDTH * k, highs[k]);
        }
        doubles_store(bad, zero);
        for (j = 0; j < WIDTH; j++) not_finite += bad[j];
        for (j = 0; j < AT_ONCE; j++) {
            low[j % 3] = least[j] < low[j % 3] ? least[j] : low[j % 3];
            high[j % 3] = most[j] > high[j % 3] ? most[j] : high[j % 3];
        }
    }
    for (; i < count; i++) {
        low[i % 3] = p[i] < low[i % 3] ? p[i] : low[i % 3];
        high[i % 3] = p[i] > high[i % 3] ? p[i] : high[i % 3];
        not_finite += p[i] - p[i];
    }
    return not_finite == 0; /* NaN is not 0 */
}

static int SC_KERNEL(extent_of_floats)(const float *p, uint64_t some, double low[3], double high[3])
{
    enum { WIDTH = SC_LANES_COUNT, AT_ONCE = 3 * WIDTH };
    uint64_t count = 3 * some, i = 0;
    float least[AT_ONCE], most[AT_ONCE], bad[WIDTH], not_finite = 0;
    int j, k;
    if (count >= AT_ONCE) {
        lanes lows[3], highs[3], x, zero = lanes_all(0);
        SC_UNROLL
        for (k = 0; k < 3; k++) lows[k] = highs[k] = lanes_load(p + WIDTH * k);
        for (; i + AT_ONCE <= count; i += AT_ONCE) SC_UNROLL
        for (k = 0; k < 3; k++) {
            x = lanes_load(p + i + WIDTH * (uint64_t)k);
            lows[k] = lanes_smaller(x, lows[k]);
            highs[k] = lanes_larger(x, highs[k]);
            zero = lanes_add(zero, lanes_subtract(x, x));
        }
        SC_UNROLL
        for (k = 0; k < 3; k++) {
            lanes_store(least + WIDTH * k, lows[k]);
            lanes_store(most + WIDTH * k, highs[k]);
        }
        lanes_store(bad, zero);
        for (j = 0; j < WIDTH; j++) not_finite += bad[j];
        for (j = 0; j < AT_ONCE; j++) {
            low[j % 3] = (double)least[j] < low[j % 3] ? (double)least[j] : low[j % 3];
            high[j % 3] = (double)most[j] > high[j % 3] ? (double)most[j] : high[j % 3];
        }
    }
    for (; i < count; i++) {
        double d = (double)p[i];
        low[i % 3] = d < low[i % 3] ? d : low[i % 3];
        high[i % 3] = d > high[i % 3] ? d : high[i % 3];
        not_finite += p[i] - p[i];
    }
    return not_finite == 0;
}

/* Vertices that are stride bytes apart. */
static int SC_KERNEL(extent_of_apart_doubles)(const double *p, uint64_t stride, uint64_t some,
                                              double low[3], double high[3])
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

static int SC_KERNEL(extent_of_apart_floats)(const float *p, uint64_t stride, uint64_t some,
                                             double low[3], double high[3])
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
