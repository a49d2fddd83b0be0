/*
 * See rounding_search.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "rounding_search.h"

#include <math.h>
#include <string.h>

enum { N = ROUNDING_LANES };

/* splitmix64; of its own, so that a search says the same whatever was asked before. */
static uint64_t draw(uint64_t *state)
{
    uint64_t z = *state += UINT64_C(0x9e3779b97f4a7c15);
    z = (z ^ z >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ z >> 27) * UINT64_C(0x94d049bb133111eb);
    return z ^ z >> 31;
}

/* From -1 to 1, not 1. */
static double draw_real(uint64_t *state)
{
    return (double)(int64_t)draw(state) * 0x1p-63;
}

static double power_of_two(int exponent)
{
    uint64_t bits = (uint64_t)(1023 + exponent) << 52;
    double power;
    memcpy(&power, &bits, sizeof power);
    return power;
}

/* A number that becomes the float next to f: near the middle to another, or anywhere between. */
static double blurred(double f, uint64_t *state)
{
    uint64_t r = draw(state);
    float near = (float)f, next = nextafterf(near, r & 1 ? 2.0f : -2.0f);
    double way;
    if (near >= 1 || near <= -1) {
        near = near > 0 ? 1.0f : -1.0f;
        next = nextafterf(near, 0.0f);
    }
    way = 0.4999 * ((double)next - (double)near);
    return (double)near + (r & 6 ? way : way * ((double)(r >> 11) * 0x1p-53));
}

typedef struct trial_style {
    rounding_kind kind;
    int axes;
    unsigned style;
    double base[3], extent, way[2][3];
} trial_style;

static trial_style draw_style(const rounding_bound *b, uint64_t *state)
{
    trial_style s;
    s.kind = b->kind;
    s.axes = b->axes;
    s.style = (unsigned)(draw(state) % 6);
    s.extent = power_of_two(-(int)(draw(state) % 24));
    for (int k = 0; k < 3; ++k) {
        s.base[k] = draw_real(state);
        for (int m = 0; m < 2; ++m) s.way[m][k] = draw_real(state);
    }
    return s;
}

static double fitting(const trial_style *s, double f, uint64_t *state)
{
    if (s->kind == ROUNDING_WHOLE) {
        f = nearbyint(f * 65536);
        return f > 65535 ? 65535 : f < -65535 ? -65535 : f;
    }
    return s->kind == ROUNDING_UNIT ? blurred(f, state) : f;
}

/* The numbers of one lane. */
static void draw_trial(const rounding_bound *b, const trial_style *s, uint64_t *state, int lane,
                       double (*x)[N])
{
    double t[2] = {0, 0};
    for (int i = 0; i < b->inputs; ++i) {
        int axis = i % s->axes;
        double f = draw_real(state);
        if (axis == 0) {
            t[0] = draw_real(state);
            t[1] = draw_real(state);
        }
        switch (s->style) {
        case 0:
            break; /* anywhere */
        case 1:
            f = (s->base[axis] + s->extent * f) / 2;
            break; /* close together */
        case 2:
            f *= power_of_two(-(int)(draw(state) % 30));
            break; /* of all sizes */
        case 3:
            f = (s->way[0][axis] * t[0] + s->way[1][axis] * t[1]) / 2;
            break; /* in a plane */
        case 4:
            f = s->way[0][axis] * t[0] + s->extent * 0x1p-20 * f;
            break; /* along a line */
        default:   /* at the ends */
            f = (f > 0 ? 1 : -1) * (f * f > 0.5 ? 1 - s->extent * fabs(f) : fabs(f) * s->extent);
        }
        x[i][lane] = fitting(s, f, state);
    }
}

/* Changes a few numbers of a trial. */
static void change_trial(const rounding_bound *b, const trial_style *s, uint64_t *state, int lane,
                         double (*x)[N])
{
    uint64_t r = draw(state);
    int changes = 1 + (int)(r & 1) + (int)(r >> 1 & r >> 2 & 3);
    for (; changes > 0; --changes) {
        int i, other;
        double f, step;
        r = draw(state);
        i = (int)((r >> 32) % (uint64_t)b->inputs);
        other = (int)((r >> 16 & 0xffff) % (uint64_t)b->inputs);
        f = x[i][lane];
        step = b->kind == ROUNDING_UNIT ? 0x1p-24 : 0x1p-53;
        switch (r & 7) {
        case 0:
            f = 2 * (double)(float)f - f;
            break; /* the other side of a float */
        case 1:
            f += f * step * (double)(1 + (r >> 8 & 3)) * (r >> 10 & 1 ? 1 : -1);
            break;
        case 2:
            f += f * draw_real(state) * power_of_two(-(int)(r >> 8 & 31));
            break;
        case 3:
            f = draw_real(state);
            break;
        case 4:
            f = x[other - other % s->axes + i % s->axes < b->inputs
                      ? other - other % s->axes + i % s->axes
                      : i][lane];
            break;
        case 5:
            f = -f;
            break;
        case 6:
            f *= r >> 8 & 1 ? 0.5 : 2;
            break;
        default: { /* to a power of two, or just before */
            int exponent;
            (void)frexp(f, &exponent);
            f = copysign(ldexp(1, exponent) * (r >> 8 & 1 ? 1 : 1 - step), f);
        }
        }
        if (b->kind != ROUNDING_WHOLE && (f > 1 || f < -1)) f = f > 0 ? 1 : -1;
        if (b->kind == ROUNDING_WHOLE) {
            f = nearbyint(f);
            x[i][lane] = f > 65535 ? 65535 : f < -65535 ? -65535 : f;
        } else {
            x[i][lane] = b->kind == ROUNDING_UNIT && (r & 7) ? blurred(f, state) : f;
        }
    }
}

double rounding_search(const rounding_bound *b, uint64_t trials, uint64_t seed, double *worst)
{
    enum { CLIMB = 20000 }; /* sixteens until it begins anew */
    static double x[ROUNDING_INPUTS][N];
    double best[ROUNDING_INPUTS] = {0}, at[ROUNDING_INPUTS] = {0}, most = -1, height = -1;
    uint64_t state = seed, done, rounds = 0;
    const uint64_t length = trials / N / 4 < CLIMB ? trials / N / 4 + 1 : CLIMB;
    for (done = 0; done < trials; done += N, ++rounds) {
        trial_style style = draw_style(b, &state);
        const int climbs = rounds % 2;
        double share[N];
        if (rounds % length == 0) { /* from the worst of all every third time */
            height = rounds / length % 3 == 2 ? most : -1;
            if (height >= 0) memcpy(at, best, sizeof at);
        }
        if (rounds == 0 && b->known) {
            for (int k = 0; k < b->inputs; ++k) at[k] = b->known[k];
            height = 0;
        }
        for (int i = 0; i < N; ++i) {
            if (rounds == 0 && b->known) {
                for (int k = 0; k < b->inputs; ++k) x[k][i] = at[k];
            } else if (climbs && height >= 0) {
                for (int k = 0; k < b->inputs; ++k) x[k][i] = at[k];
                change_trial(b, &style, &state, i, x);
            } else {
                draw_trial(b, &style, &state, i, x);
            }
        }
        b->share((const double(*)[N])x, share);
        for (int i = 0; i < N; ++i) {
            if (share[i] > most) {
                most = share[i];
                for (int k = 0; k < b->inputs; ++k) best[k] = x[k][i];
            }
            if (share[i] >= height && (climbs || height <= 0)) {
                height = share[i];
                for (int k = 0; k < b->inputs; ++k) at[k] = x[k][i];
            }
        }
    }
    if (worst) memcpy(worst, best, sizeof best);
    return most;
}
