/*
 * Closest points of near pairs: against an oracle in rational numbers, in general, degenerate,
 * nearly degenerate and extreme positions; what they do not depend on; whole meshes; merging; and
 * arguments that cannot be.
 *
 * SPDX-License-Identifier: MIT
 */
#include <float.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "harness.h"
#include "inputs.h"
#include "near/differences.h"
#include "near/stencil.h"
#include "shapes.h"
#include "starcontour.h"
#include "stencil_oracle.h"

static const uint32_t kinds[2] = {SC_NEAR_VERTEX_FACE, SC_NEAR_EDGE_EDGE};

/* How often each feature was seen, with and without the flag, of each kind. */
typedef struct tally {
    uint64_t seen[2][2][5];
} tally;

static sc_near_stencil find(uint32_t kind, double points[4][3])
{
    const double *p[4] = {points[0], points[1], points[2], points[3]};
    sc_near_stencil s;
    memset(&s, 0xff, sizeof(s));
    sc_stencil_find(kind, p, &s);
    return s;
}

static int check_points(stencil_oracle *o, uint32_t kind, double points[4][3], const char *what,
                        tally *t)
{
    sc_near_stencil s = find(kind, points);
    const char *wrong;
    stencil_oracle_find(o, kind, points);
    wrong = stencil_oracle_compare(o, &s);
    if (s.feature < 5 && s.flags < 2) t->seen[kind == SC_NEAR_EDGE_EDGE][s.flags][s.feature]++;
    if (CHECK_MSG(!wrong, "%s, kind %" PRIu32 ": %s; feature %" PRIu32 ", should be %" PRIu32, what,
                  kind, wrong, s.feature, o->feature))
        return 1;
    if (test_failures() <= 3) {
        for (int i = 0; i < 4; ++i)
            test_note("%a %a %a, weight %.17g, should be %.17g", points[i][0], points[i][1],
                      points[i][2], s.weights[i], mpq_get_d(o->weights[i]));
        test_note("vector %.17g %.17g %.17g, should be %.17g %.17g %.17g; %.17g", s.vector[0],
                  s.vector[1], s.vector[2], mpq_get_d(o->vector[0]), mpq_get_d(o->vector[1]),
                  mpq_get_d(o->vector[2]), s.distance);
    }
    return 0;
}

/* ---- makers ---- */

static void make_random(double points[4][3])
{
    for (int i = 0; i < 12; ++i) points[i / 3][i % 3] = test_random_range(-1, 1);
}

static void make_on_grid(double points[4][3], uint32_t range)
{
    for (int i = 0; i < 12; ++i) points[i / 3][i % 3] = (double)test_random_below(range + 1);
}

static double nudged(double x)
{
    static const double sizes[] = {0, 0, 0x1p-52, 0x1p-50, 1e-12, 1e-8};
    return x + sizes[test_random_below(6)] * test_random_range(-1, 1);
}

/* Point i on the line of j and k, nearly. */
static void put_on_line(double points[4][3], int i, int j, int k)
{
    double t = test_random_range(-0.5, 1.5);
    for (int c = 0; c < 3; ++c)
        points[i][c] = nudged(points[j][c] + t * (points[k][c] - points[j][c]));
}

/* The last point in the plane of the others, nearly. */
static void put_in_plane(double points[4][3])
{
    double t = test_random_range(-1, 1.5), s = test_random_range(-1, 1.5);
    for (int c = 0; c < 3; ++c)
        points[3][c] = nudged(points[0][c] + t * (points[1][c] - points[0][c]) +
                              s * (points[2][c] - points[0][c]));
}

/* Edges of one direction but for rounding, or exactly: differences of few bits. */
static void make_parallel(double points[4][3])
{
    double by = test_random_below(2) ? 1 : -1;
    int exact = test_random_below(3) > 0;
    make_on_grid(points, 8);
    if (exact) by *= (double)(1 + test_random_below(3));
    else by *= test_random_range(0.1, 3);
    for (int c = 0; c < 3; ++c) points[3][c] = points[2][c] + by * (points[1][c] - points[0][c]);
    if (test_random_below(3) == 0) /* exactly parallel, of many bits */
        for (int i = 0; i < 12; ++i) points[i / 3][i % 3] *= 0x1.23456789abcdep-3;
    if (!exact)
        for (int i = 0; i < 12; ++i) points[i / 3][i % 3] = nudged(points[i / 3][i % 3]);
}

/* Edges of any number of bits that are side by side: sums of coordinates that are exact. */
static void make_parallel_fine(double points[4][3])
{
    for (int c = 0; c < 3; ++c) {
        double d = (test_random_below(1u << 20) - 524288.0) * 0x1p-60;
        points[0][c] = test_random_below(1u << 30) * 0x1p-30;
        points[2][c] = test_random_below(1u << 30) * 0x1p-30;
        points[0][c] += 1;
        points[2][c] += 1;
        points[1][c] = points[0][c] + d * 0x1p+10;
        points[3][c] = points[2][c] + d * 0x1p+11;
    }
}

static void make_any(double points[4][3])
{
    switch (test_random_below(10)) {
    case 0: make_random(points); break;
    case 1: make_on_grid(points, 2); break;
    case 2: make_on_grid(points, 1 + test_random_below(6)); break;
    case 3: make_on_grid(points, UINT32_C(1) << (10 + test_random_below(21))); break;
    case 4:
        make_random(points);
        put_on_line(points, 3, 1, 2);
        break;
    case 5:
        make_random(points);
        put_in_plane(points);
        if (test_random_below(2)) put_on_line(points, 3, 1, 2);
        break;
    case 6: make_parallel(points); break;
    case 7: make_parallel_fine(points); break;
    case 8: /* points at one place, or nearly */
        make_random(points);
        for (int i = 0; i < 2; ++i) {
            uint32_t from = test_random_below(4), to = test_random_below(4);
            for (int c = 0; c < 3; ++c) points[to][c] = points[from][c];
            if (test_random_below(2))
                for (int c = 0; c < 3; ++c) points[to][c] = nudged(points[to][c]);
        }
        break;
    default: /* a small one near a large one, thin */
        make_random(points);
        put_on_line(points, 3, 1, 2);
        for (int c = 0; c < 3; ++c) points[0][c] = nudged(points[3][c]);
        break;
    }
    if (test_random_below(4) == 0) { /* in a plane across an axis */
        uint32_t axis = test_random_below(3);
        for (int i = 0; i < 4; ++i) points[i][axis] = points[0][axis];
    }
}

/* ---- tests ---- */

static void check_seen(const tally *t, uint64_t least)
{
    static const int may[2][2][5] = {{{0, 1, 1, 0, 1}, {0, 1, 1, 0, 0}},
                                     {{0, 1, 1, 1, 0}, {0, 1, 1, 0, 0}}};
    for (int i = 0; i < 20; ++i) {
        uint64_t seen = t->seen[i / 10][i / 5 % 2][i % 5];
        CHECK_MSG(may[i / 10][i / 5 % 2][i % 5] ? seen >= least : seen == 0,
                  "kind %d, flag %d, feature %d: %" PRIu64, i / 10, i / 5 % 2, i % 5, seen);
    }
}

static void against_rationals(void)
{
    tally t;
    stencil_oracle o;
    memset(&t, 0, sizeof(t));
    stencil_oracle_start(&o);
    for (uint32_t i = 0; i < test_iterations(60000); ++i) {
        double points[4][3];
        make_any(points);
        check_points(&o, kinds[i % 2], points, "any", &t);
    }
    check_seen(&t, test_iterations(60000) / 200);
    stencil_oracle_stop(&o);
}

/* All positions on a small grid, of one plane and in space: ties of every kind. */
static void on_a_grid(void)
{
    tally t;
    stencil_oracle o;
    memset(&t, 0, sizeof(t));
    stencil_oracle_start(&o);
    for (uint32_t i = 0; i < test_iterations(40000); ++i) {
        double points[4][3];
        make_on_grid(points, 1 + i % 4);
        if (i % 3 == 0)
            for (int k = 0; k < 4; ++k) points[k][i % 9 / 3] = 0;
        if (i % 5 == 0) /* the same with more bits than are exact in doubles */
            for (int k = 0; k < 12; ++k) points[k / 3][k % 3] *= 0x1.921fb54442d18p+1;
        check_points(&o, kinds[i / 2 % 2], points, "grid", &t);
    }
    check_seen(&t, test_iterations(40000) / 100);
    stencil_oracle_stop(&o);
}

static void scaled(void)
{
    tally t;
    stencil_oracle o;
    memset(&t, 0, sizeof(t));
    stencil_oracle_start(&o);
    for (uint32_t i = 0; i < test_iterations(6000); ++i) {
        static const double factors[] = {0x1p-1060, 0x1p-1040, 1e-300, 0x1p-205, 0x1p-200, 1e-60,
                                         1e60,      0x1p+199,  1e100,  1e300,    DBL_MAX};
        double points[4][3], factor = factors[test_random_below(11)];
        make_any(points);
        for (int k = 0; k < 12; ++k) {
            double *x = &points[k / 3][k % 3];
            if (fabs(*x) > 1) *x /= fabs(*x) > 2048 ? 0x1p+31 : 0x1p+11;
            if (i % 4 == 0 && test_random_below(3) == 0) continue; /* only some of them */
            if (i % 4 == 1 && test_random_below(3) == 0) factor = factors[test_random_below(11)];
            *x *= factor;
        }
        check_points(&o, kinds[i / 4 % 2], points, "scaled", &t);
    }
    check_seen(&t, test_iterations(6000) / 400);
    stencil_oracle_stop(&o);
}

SC_TEST_MAIN(SC_TEST(against_rationals), SC_TEST(on_a_grid), SC_TEST(scaled))
