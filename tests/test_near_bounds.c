/*
 * The certificates of distances in floats (lib/near/distance_kernel.h) are right with the bound of
 * lib/base/bounds.h, and not with half of it: attacks by pairs of which all points are off as far
 * as points may be, towards each other or apart, at a distance next to theirs.
 *
 * SPDX-License-Identifier: MIT
 */
#include <inttypes.h>
#include <math.h>
#include <string.h>

#include "harness.h"
#include "near_oracle.h"

#include "base/boxes.h"
#include "simd/quads.h"

/* The kernels, as simd/kernels_base.c has them. */
#define SC_KERNELS near_bounds_kernels
#define SC_LANES SC_QUADS

#include "simd/all_kernels.h"

/* A vertex and a face, or two edges: points as floats, and where they are in truth. */
typedef struct attack {
    int faces; /* 1: vertex and face */
    float point[4][3];
    double truth[4][3];
    double distance, size; /* in truth, rounded down; the s of sc_bounds_near */
} attack;

static double log_range(double low, double high)
{
    return pow(10, test_random_range(low, high));
}

static void draw_vector(double v[3], double length)
{
    for (int k = 0; k < 3; ++k) v[k] = length * test_random_range(-1, 1);
}

static double extent_of(const attack *a, int first, int count)
{
    float largest = 0;
    for (int k = 0; k < 3; ++k) {
        float low = a->point[first][k], high = low;
        for (int i = 1; i < count; ++i) {
            low = fminf(low, a->point[first + i][k]);
            high = fmaxf(high, a->point[first + i][k]);
        }
        largest = fmaxf(largest, high - low);
    }
    return (double)largest;
}

/* way: 1, the points in truth are farther from each other; -1: nearer. */
static attack draw_attack(int faces, int way)
{
    const double size = log_range(-4, -0.6), apart = log_range(-5, -0.3);
    const double off = 0.999 * (double)SC_BOUNDS_POINT;
    double e[3], f[3], n[3], length, s = test_random_range(-0.3, 1.2), t;
    const double(*points)[3];
    attack a;
    a.faces = faces;
    draw_vector(e, size);
    draw_vector(f, test_random_below(3) ? size : size * log_range(-3, 0));
    if (test_random_below(4) == 0) /* thin, or parallel */
        for (int k = 0; k < 3; ++k) f[k] = 0.7 * e[k] + f[k] * log_range(-6, -1);
    switch (test_random_below(3)) { /* the way from one to the other */
    case 0:
        for (int k = 0; k < 3; ++k)
            n[k] = e[(k + 1) % 3] * f[(k + 2) % 3] - e[(k + 2) % 3] * f[(k + 1) % 3];
        break;
    case 1:
        for (int k = 0; k < 3; ++k) n[k] = test_random_below(2) ? 1 : -1;
        break;
    default:
        draw_vector(n, 1);
        break;
    }
    length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    for (int k = 0; k < 3; ++k) n[k] = length > 0 ? n[k] / length : k == 0;
    t = test_random_range(-0.3, 1.2);
    s = fmin(fmax(s, 0), 1);
    t = fmin(fmax(t, 0), faces ? 1 - s : 1);
    for (int k = 0; k < 3; ++k) {
        const double from = test_random_range(-0.2, 0.2);
        double x[4];
        if (faces) {
            x[1] = from;
            x[2] = from + e[k];
            x[3] = from + f[k];
            x[0] = from + s * e[k] + t * f[k] + apart * n[k];
        } else {
            x[2] = from;
            x[3] = from + f[k];
            x[0] = from + t * f[k] + apart * n[k] - s * e[k];
            x[1] = x[0] + e[k];
        }
        for (int i = 0; i < 4; ++i) {
            const int first = i < (faces ? 1 : 2);
            a.point[i][k] = (float)x[i];
            a.truth[i][k] =
                (double)a.point[i][k] + (first ? 1 : -1) * (n[k] < 0 ? -1 : 1) * way * off;
        }
    }
    points = (const double(*)[3])a.truth;
    a.distance =
        faces ? near_oracle_distance_vertex_face(points) : near_oracle_distance_edge_edge(points);
    a.size = faces ? extent_of(&a, 1, 3) : extent_of(&a, 0, 2) + extent_of(&a, 2, 2);
    return a;
}

static unsigned judge(const attack *a, const near_limits *limits, near_measured *measured)
{
    lanes v[3], e[3], f[3], x[4][3];
    for (int i = 0; i < 4; ++i)
        for (int k = 0; k < 3; ++k) x[i][k] = lanes_all(a->point[i][k]);
    for (int k = 0; k < 3; ++k) {
        v[k] = lanes_subtract(x[0][k], a->faces ? x[1][k] : x[2][k]);
        e[k] = a->faces ? lanes_subtract(x[2][k], x[1][k]) : lanes_subtract(x[1][k], x[0][k]);
        f[k] = a->faces ? lanes_subtract(x[3][k], x[1][k]) : lanes_subtract(x[3][k], x[2][k]);
    }
    return a->faces
               ? judge_faces((const lanes *)v, (const lanes *)e, (const lanes *)f, limits, measured)
               : judge_edges((const lanes *)v, (const lanes *)e, (const lanes *)f, limits,
                             measured);
}

/* Limits with a part of the bound. */
static near_limits limits_with(double distance, double size, double part)
{
    const double error = part * sc_bounds_near(distance, size);
    near_limits limits;
    limits.error = error;
    limits.near = lanes_all((float)(fmax(distance - error, 0) * fmax(distance - error, 0)));
    limits.far = lanes_all((float)((distance + error) * (distance + error)));
    return limits;
}

/* So many attacks: none on the limits in use succeeds, some on those with half of the bound. */
static void attack_limits(int faces, int way)
{
    const uint32_t count = test_iterations_at_least(300000, 60000);
    uint64_t wrong_by_half = 0, sure = 0;
    const unsigned mistake = way > 0 ? 1u : 1u << 16;
    for (uint32_t i = 0; i < count; ++i) {
        const uint64_t state = test_random_state();
        const attack a = draw_attack(faces, way);
        /* not within this, if points are farther in truth; within it, if they are nearer */
        const double d = a.distance * (1 - way * 1e-12);
        near_limits limits = near_limits_for(d, a.size);
        if (!(a.distance > 0)) continue;
        CHECK_MSG(!(judge(&a, &limits, NULL) & mistake),
                  "taken for %s: distance %a, size %g, state %" PRIu64, way > 0 ? "near" : "far", d,
                  a.size, state);
        limits = limits_with(d, a.size, 0.5);
        wrong_by_half += (judge(&a, &limits, NULL) & mistake) != 0;
        /* and what is a thousandth off is told */
        limits = near_limits_for(a.distance * (1 + way * 1e-3), a.size);
        sure += a.distance > 1e-3 && (judge(&a, &limits, NULL) & mistake) != 0;
    }
    test_note("%" PRIu64 " of %" PRIu32 " with half of the bound; %" PRIu64 " told by it",
              wrong_by_half, count, sure);
    CHECK(wrong_by_half > 10 && sure > count / 10);
}

static void near_faces(void)
{
    attack_limits(1, 1);
}

static void far_faces(void)
{
    attack_limits(1, -1);
}

static void near_edges(void)
{
    attack_limits(0, 1);
}

static void far_edges(void)
{
    attack_limits(0, -1);
}

/* Bounds of distances, of pairs that are nearer in truth than their points are: none is above the
   distance, but some with half of the error. */
static void attack_bounds(int faces)
{
    const uint32_t count = test_iterations_at_least(300000, 60000);
    uint64_t wrong_by_half = 0, told = 0;
    for (uint32_t i = 0; i < count; ++i) {
        const uint64_t state = test_random_state();
        const attack a = draw_attack(faces, -1);
        const double d = a.distance * test_random_range(1, 1.2);
        near_limits limits = near_limits_for(d, a.size);
        near_measured measured;
        double bound;
        (void)judge(&a, &limits, &measured);
        bound = near_bound(&measured, i % SC_LANES_COUNT, &limits);
        CHECK_MSG(bound <= a.distance, "bound %a of distance %a, size %g, state %" PRIu64, bound,
                  a.distance, a.size, state);
        told += bound > a.distance - 5 * limits.error;
        limits.error /= 2;
        wrong_by_half += near_bound(&measured, 0, &limits) > a.distance;
    }
    test_note("%" PRIu64 " of %" PRIu32 " with half of the error; %" PRIu64 " told by it",
              wrong_by_half, count, told);
    CHECK(wrong_by_half > 10 && told > count / 10);
}

static void bounds_of_faces(void)
{
    attack_bounds(1);
}

static void bounds_of_edges(void)
{
    attack_bounds(0);
}

SC_TEST_MAIN(SC_TEST(bounds_of_faces), SC_TEST(bounds_of_edges), SC_TEST(near_faces),
             SC_TEST(far_faces), SC_TEST(near_edges), SC_TEST(far_edges))
