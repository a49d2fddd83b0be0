/*
 * The orientation signs against integers of GMP (the GNU multiple precision library), on points of
 * many kinds, each stage by itself and all together.
 *
 * SPDX-License-Identifier: MIT
 */
#include "base/predicates.h"
#include "base/wide.h"

#include "harness.h"

#include <gmp.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* ------------------------------------------------------------------------------------------------
 * The signs by GMP: all coordinates times 2^1074 are integers.
 */

static void set_integer(mpz_t result, double value)
{
    int exponent;
    double mantissa = frexp(value, &exponent); /* value = mantissa 2^exponent, 53 bits */
    mpz_set_d(result, mantissa * 0x1p53);
    if (exponent - 53 + 1074 >= 0) {
        mpz_mul_2exp(result, result, (mp_bitcnt_t)(exponent - 53 + 1074));
    } else { /* a subnormal number: what is shifted out is 0 */
        mpz_tdiv_q_2exp(result, result, (mp_bitcnt_t) - (exponent - 53 + 1074));
    }
}

/* The sign of the determinant of the differences of points 1 to dimension from point 0. */
static int gmp_sign(double points[4][3], int dimension)
{
    mpz_t m[3][3], base, product, sum;
    mpz_inits(base, product, sum, (mpz_ptr)0);
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            mpz_init_set_si(m[i][j], i == j);
            if (i >= dimension || j >= dimension) continue;
            set_integer(m[i][j], points[i + 1][j]);
            set_integer(base, points[0][j]);
            mpz_sub(m[i][j], m[i][j], base);
        }
    }
    for (int i = 0; i < 3; ++i) {
        for (int k = 1; k < 3; ++k) { /* the even and the odd permutation that start with i */
            mpz_mul(product, m[0][i], m[1][(i + k) % 3]);
            mpz_mul(product, product, m[2][(i + 3 - k) % 3]);
            if (k == 1) {
                mpz_add(sum, sum, product);
            } else {
                mpz_sub(sum, sum, product);
            }
        }
    }
    int sign = mpz_sgn(sum);
    for (int i = 0; i < 9; ++i) mpz_clear(m[i / 3][i % 3]);
    mpz_clears(base, product, sum, (mpz_ptr)0);
    return sign;
}

/* ------------------------------------------------------------------------------------------------
 * Kinds of points
 */

static double any_sign(double value)
{
    return test_random_below(2) ? value : -value;
}

static double random_bits(int low_exponent, int high_exponent)
{
    int span = high_exponent - low_exponent + 1;
    double mantissa = 1.0 + test_random_unit();
    return any_sign(ldexp(mantissa, low_exponent + (int)test_random_below((uint32_t)span)));
}

/* A few units in the last place up or down. */
static double nudge(double value)
{
    for (uint32_t n = test_random_below(4); n > 0; --n)
        value = nextafter(value, any_sign(HUGE_VAL));
    return value;
}

static double uniform(void)
{
    return test_random_range(-1.0, 1.0);
}

static double small_integer(void)
{
    return (double)test_random_below(4) - 1.0;
}

static double any_exponent(void)
{
    uint64_t bits;
    double value;
    do {
        bits = test_random();
        memcpy(&value, &bits, sizeof value);
    } while (!isfinite(value));
    return value;
}

static double subnormal(void)
{
    return any_sign((double)test_random_below(16) * 0x1p-1074);
}

static double huge(void)
{
    return random_bits(1020, 1023);
}

static double underflowing(void)
{
    return random_bits(-560, -330);
}

/* Too small or large for expansions in 3d, and of similar size, so that the last bits matter. */
static double small(void)
{
    return random_bits(-360, -356);
}

static double large(void)
{
    return random_bits(340, 344);
}

static double mixed(void)
{
    switch (test_random_below(6)) {
    case 0:
        return 0.0;
    case 1:
        return subnormal();
    case 2:
        return huge();
    case 3:
        return small_integer();
    case 4:
        return random_bits(-300, 300);
    default:
        return uniform();
    }
}

/* Twelve coordinates of one kind, one after the other. */
static void fill(double points[4][3], double (*coordinate)(void))
{
    for (int i = 0; i < 4; ++i) {
        for (int j = 0; j < 3; ++j) points[i][j] = coordinate();
    }
}

/* Moves the last of count points into the line or plane of the others, as far as rounding
   allows. */
static void flatten(double points[4][3], int dimension)
{
    double s = uniform(), t = dimension == 2 ? 0.0 : uniform();
    for (int j = 0; j < 3; ++j) {
        const double *a = points[0], *b = points[1], *c = points[2];
        double edge = dimension == 2 ? 0.0 : c[j] - a[j];
        points[dimension][j] = nudge(a[j] + s * (b[j] - a[j]) + t * edge);
    }
}

/* ------------------------------------------------------------------------------------------------
 * Comparing
 */

typedef struct tally {
    uint64_t trials, fallbacks;
    uint64_t hard; /* fallbacks with a sign that is not 0 */
    uint64_t zeros;
} tally;

static void print_points(double points[4][3], int dimension)
{
    for (int i = 0; i <= dimension; ++i) {
        printf("    %a %a %a\n", points[i][0], points[i][1], points[i][2]);
    }
}

/* One set of points, all stages. */
static void compare(double points[4][3], int dimension, tally *t)
{
    const double *a = points[0], *b = points[1], *c = points[2], *d = points[3];
    uint64_t fallbacks = 0;
    int wanted = gmp_sign(points, dimension), sign, exact, wide;
    if (dimension == 2) {
        sign = sc_predicates_orient2d(a, b, c, &fallbacks);
        exact = sc_predicates_orient2d_exact(a, b, c);
        wide = sc_wide_orient2d(a, b, c);
    } else {
        sign = sc_predicates_orient3d(a, b, c, d, &fallbacks);
        exact = sc_predicates_orient3d_exact(a, b, c, d);
        wide = sc_wide_orient3d(a, b, c, d);
    }
    if (!CHECK_MSG(sign == wanted && exact == wanted && wide == wanted,
                   "%dd: GMP %d, the sign %d, without filter %d, wide %d", dimension, wanted, sign,
                   exact, wide) ||
        !CHECK_MSG(fallbacks == 1 || (fallbacks == 0 && wanted != 0), "fallbacks went up by %u",
                   (unsigned)fallbacks)) {
        print_points(points, dimension);
    }
    ++t->trials;
    t->fallbacks += fallbacks;
    t->hard += fallbacks != 0 && wanted != 0;
    t->zeros += wanted == 0;
}

/* How points of a kind are made into a hard case. */
enum { AS_THEY_ARE, FLATTENED };

static tally try_kind(const char *name, double (*coordinate)(void), int how, int dimension,
                      uint32_t trials)
{
    tally t = {0, 0, 0, 0};
    for (uint32_t i = 0, n = test_iterations(trials); i < n; ++i) {
        double points[4][3];
        fill(points, coordinate);
        if (how == FLATTENED) flatten(points, dimension);
        int finite = 1;
        for (int k = 0; k < 12; ++k) finite = finite && isfinite(points[k / 3][k % 3]);
        if (finite) compare(points, dimension, &t);
    }
    test_note("%dd %s%s: %u, of them past the filter %u (%u not zero), zero %u", dimension, name,
              how == FLATTENED ? ", flattened" : "", (unsigned)t.trials, (unsigned)t.fallbacks,
              (unsigned)t.hard, (unsigned)t.zeros);
    return t;
}

/* ------------------------------------------------------------------------------------------------
 * Tests
 */

static void conventions(void)
{
    const double o[3] = {0, 0, 0}, x[3] = {1, 0, 0}, y[3] = {0, 1, 0}, z[3] = {0, 0, 1};
    uint64_t fallbacks = 0;
    CHECK(sc_predicates_orient2d(o, x, y, &fallbacks) == 1);
    CHECK(sc_predicates_orient2d(o, y, x, &fallbacks) == -1);
    CHECK(sc_predicates_orient3d(o, x, y, z, &fallbacks) == 1);
    CHECK(sc_predicates_orient3d(o, y, x, z, &fallbacks) == -1);
    CHECK(sc_predicates_orient3d(z, o, x, y, &fallbacks) == -1);
    CHECK(fallbacks == 0);
    CHECK(sc_predicates_orient3d_exact(o, x, y, z) == 1 && sc_wide_orient3d(o, x, y, z) == 1);
    CHECK(sc_predicates_orient2d_exact(o, x, y) == 1 && sc_wide_orient2d(o, x, y) == 1);
    CHECK(sc_predicates_orient3d(o, x, y, y, &fallbacks) == 0 && fallbacks == 1);
    CHECK(sc_predicates_orient2d(o, x, x, &fallbacks) == 0 && fallbacks == 2);
}

/* The filter decides what is clear, and what it decides is right. */
static void first_stage(void)
{
    for (int dimension = 2; dimension <= 3; ++dimension) {
        tally t = try_kind("uniform", uniform, AS_THEY_ARE, dimension, 4000);
        CHECK(t.fallbacks == 0);
    }
}

/* Cases for the expansions: nothing is zero or out of their range, nearly everything is flat. */
static void second_stage(void)
{
    for (int dimension = 2; dimension <= 3; ++dimension) {
        tally t = try_kind("uniform", uniform, FLATTENED, dimension, 20000);
        CHECK(t.fallbacks > t.trials / 10 && t.hard > t.trials / 20);
        t = try_kind("small integers", small_integer, AS_THEY_ARE, dimension, 4000);
        CHECK(t.zeros > t.trials / 10);
        t = try_kind("small integers", small_integer, FLATTENED, dimension, 4000);
        CHECK(t.hard > t.trials / 20);
    }
}

static double moderate(void)
{
    return random_bits(-250, 250);
}

/* The edges of the range of the expansions, and lengths of all sizes within it. */
static void second_stage_extremes(void)
{
    for (int dimension = 2; dimension <= 3; ++dimension) {
        tally t = try_kind("2^-250 to 2^251", moderate, FLATTENED, dimension, 10000);
        CHECK(t.hard > 0);
        for (uint32_t i = 0, n = test_iterations(10000); i < n; ++i) {
            double points[4][3];
            fill(points, uniform);
            if (test_random_below(2)) flatten(points, dimension);
            for (int k = 0; k < 12; ++k) {
                double *p = &points[k / 3][k % 3];
                *p = test_random_below(4) == 0 ? any_sign(0x1.fffffffffffffp250)
                                               : nudge(any_sign(0x1p-250));
            }
            compare(points, dimension, &t);
        }
    }
}

/* Three vectors of integers below 2^bits whose determinant is 1, -1 or, if flat, 0. */
static void make_lattice(double row[3][3], int bits, int flat)
{
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) row[i][j] = i == j && !(flat && i == 2) ? any_sign(1.0) : 0.0;
    }
    for (int tries = 0; tries < 8 * bits; ++tries) {
        uint32_t i = test_random_below(3), k = (i + 1 + test_random_below(2)) % 3;
        int of_rows = (int)test_random_below(2), fits = 1;
        double factor = any_sign(1.0 + test_random_below(4)), sum[3];
        for (int j = 0; j < 3; ++j) {
            sum[j] = of_rows ? row[i][j] + factor * row[k][j] : row[j][i] + factor * row[j][k];
            fits = fits && fabs(sum[j]) < ldexp(1.0, bits);
        }
        for (int j = 0; fits && j < 3; ++j) *(of_rows ? &row[i][j] : &row[j][i]) = sum[j];
    }
}

/* Determinants that are smaller than sums of two doubles can tell, and such as take few bits: from
   integers of up to 51 bits. Seen from a point that is not one, differences are rounded. */
static void second_stage_lattices(void)
{
    tally t = {0, 0, 0, 0};
    uint64_t hard;
    for (uint32_t i = 0, n = test_iterations(8000); i < n; ++i) {
        double points[4][3], row[3][3], from[3] = {0, 0, 0};
        int bits = 3 + (int)test_random_below(49), moved = (int)test_random_below(2);
        make_lattice(row, bits, test_random_below(3) == 0);
        for (int j = 0; j < 3; ++j) {
            if (moved) from[j] = (double)test_random_below(1u << (bits < 30 ? bits : 30));
            points[0][j] = from[j];
            for (int k = 0; k < 3; ++k) points[k + 1][j] = from[j] + row[k][j];
        }
        compare(points, 3, &t);
    }
    CHECK(t.hard > t.trials / 10 && t.zeros > t.trials / 10);
    hard = t.hard;
    for (uint32_t i = 0, n = test_iterations(8000); i < n; ++i) {
        double points[4][3];
        make_lattice(points + 1, 30 + (int)test_random_below(22), 1);
        for (int j = 0; j < 3; ++j)
            points[0][j] = ldexp(uniform(), -20 - (int)test_random_below(20));
        compare(points, 3, &t);
    }
    CHECK(t.hard > hard + t.trials / 10);
}

static void third_stage(void)
{
    static const struct {
        const char *name;
        double (*coordinate)(void);
    } kinds[] = {{"any exponent", any_exponent},
                 {"subnormal", subnormal},
                 {"huge", huge},
                 {"underflowing", underflowing},
                 {"mixed", mixed},
                 {"small", small},
                 {"large", large}};
    for (int dimension = 2; dimension <= 3; ++dimension) {
        for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; ++i) {
            tally plain =
                try_kind(kinds[i].name, kinds[i].coordinate, AS_THEY_ARE, dimension, 2000);
            tally flat = try_kind(kinds[i].name, kinds[i].coordinate, FLATTENED, dimension, 2000);
            CHECK(plain.hard + flat.hard > 0);
        }
    }
}

/* Even permutations keep the sign, odd ones turn it: of hard cases, whatever the stage. */
static void permutations(void)
{
    static const uint8_t even[12][4] = {{0, 1, 2, 3}, {0, 2, 3, 1}, {0, 3, 1, 2}, {1, 0, 3, 2},
                                        {1, 2, 0, 3}, {1, 3, 2, 0}, {2, 0, 1, 3}, {2, 1, 3, 0},
                                        {2, 3, 0, 1}, {3, 0, 2, 1}, {3, 1, 0, 2}, {3, 2, 1, 0}};
    uint64_t fallbacks = 0;
    for (uint32_t n = test_iterations(2000); n > 0; --n) {
        double p[4][3];
        fill(p, test_random_below(2) ? uniform : underflowing);
        flatten(p, 3);
        int sign = sc_predicates_orient3d(p[0], p[1], p[2], p[3], &fallbacks);
        for (int i = 0; i < 12; ++i) {
            const uint8_t *e = even[i];
            CHECK(sc_predicates_orient3d(p[e[0]], p[e[1]], p[e[2]], p[e[3]], &fallbacks) == sign);
            CHECK(sc_predicates_orient3d(p[e[0]], p[e[1]], p[e[3]], p[e[2]], &fallbacks) == -sign);
        }
    }
    CHECK(fallbacks > 0);
}

SC_TEST_MAIN(SC_TEST(conventions), SC_TEST(first_stage), SC_TEST(second_stage),
             SC_TEST(second_stage_extremes), SC_TEST(second_stage_lattices), SC_TEST(third_stage),
             SC_TEST(permutations))
