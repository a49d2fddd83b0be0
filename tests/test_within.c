/*
 * Tests of exact comparisons of distances, lib/step/within, against fractions of integers.
 *
 * SPDX-License-Identifier: MIT
 *
 * Each pair is asked about as a whole, in another order of its points, and of each stage by itself;
 * all that answers must be right. Distances are those of the pair, rounded down and up, and others
 * next to them.
 */
#include <float.h>
#include <gmp.h>
#include <math.h>
#include <string.h>

#include "harness.h"
#include "step/limbs.h"
#include "step/within.h"
#include "near_oracle.h"

typedef struct points {
    double p[4][3];
} points;

/* How many answers were given by which stage, of each kind, and how many were 1. */
typedef struct tally {
    uint32_t asked[2], near[2], doubles[2], words[2], integers[2];
} tally;

static int is_near(sc_within_kind kind, const points *q, double d)
{
    return kind == SC_WITHIN_VERTEX_FACE ? sc_within_vertex_face(q->p, d)
                                         : sc_within_edge_edge(q->p, d);
}

static int is_truly_near(sc_within_kind kind, const points *q, double d)
{
    return kind == SC_WITHIN_VERTEX_FACE ? near_oracle_vertex_face(q->p, d)
                                         : near_oracle_edge_edge(q->p, d);
}

static int is_settled_by_doubles(sc_within_kind kind, const points *q, double d)
{
    int guess;
    return sc_within_by_doubles(kind, q->p, d, &guess) != SC_WITHIN_UNSURE;
}

static int answer_in_words(sc_within_kind kind, const points *q, double d, int guess)
{
    return sc_within_by_words(kind, q->p, d, guess);
}

static double true_distance(sc_within_kind kind, const points *q)
{
    return kind == SC_WITHIN_VERTEX_FACE ? near_oracle_distance_vertex_face(q->p)
                                         : near_oracle_distance_edge_edge(q->p);
}

static void swap_points(points *q, int i, int j)
{
    double keep[3];
    memcpy(keep, q->p[i], sizeof keep);
    memcpy(q->p[i], q->p[j], sizeof keep);
    memcpy(q->p[j], keep, sizeof keep);
}

/* Another order of corners; of ends, and of edges. */
static void reorder(sc_within_kind kind, points *q)
{
    if (kind == SC_WITHIN_VERTEX_FACE) {
        swap_points(q, 1, 1 + (int)test_random_below(3));
        swap_points(q, 2, 2 + (int)test_random_below(2));
        return;
    }
    if (test_random_below(2)) swap_points(q, 0, 1);
    if (test_random_below(2)) swap_points(q, 2, 3);
    if (test_random_below(2)) {
        swap_points(q, 0, 2);
        swap_points(q, 1, 3);
    }
}

/* Compares all that answers with the truth, which it returns. */
static int check(sc_within_kind kind, const points *q, double d, tally *t)
{
    uint64_t failures = test_failures();
    int truth = is_truly_near(kind, q, d), guess = -1, by_doubles, by_words, wild;
    points other = *q;
    ++t->asked[kind];
    t->near[kind] += truth != 0;
    CHECK_MSG(is_near(kind, q, d) == truth, "must be %d", truth);
    reorder(kind, &other);
    CHECK_MSG(is_near(kind, &other, d) == truth, "must be %d in another order", truth);

    by_doubles = sc_within_by_doubles(kind, q->p, d, &guess);
    CHECK_MSG(by_doubles == truth || by_doubles == SC_WITHIN_UNSURE, "doubles: %d, not %d",
              by_doubles, truth);
    CHECK_MSG(guess >= 0 && guess <= 2 * (kind == SC_WITHIN_VERTEX_FACE ? 3 : 4), "%d", guess);
    by_words = sc_within_by_words(kind, q->p, d, guess);
    CHECK_MSG(by_words == truth || by_words == SC_WITHIN_UNSURE, "words: %d, not %d", by_words,
              truth);
    t->doubles[kind] += by_doubles != SC_WITHIN_UNSURE;
    t->words[kind] += by_doubles == SC_WITHIN_UNSURE && by_words != SC_WITHIN_UNSURE;
    t->integers[kind] += by_doubles == SC_WITHIN_UNSURE && by_words == SC_WITHIN_UNSURE;
    CHECK_MSG(sc_within_by_integers(kind, q->p, d, guess) == truth, "integers: not %d", truth);
    /* No answer depends on a guess. */
    wild = (int)test_random_below(kind == SC_WITHIN_VERTEX_FACE ? 7 : 9);
    CHECK_MSG(sc_within_by_integers(kind, q->p, d, wild) == truth, "guess %d: not %d", wild, truth);
    CHECK_MSG(sc_within_by_words(kind, q->p, d, wild) == by_words, "guess %d: not %d", wild,
              by_words);
    if (test_failures() > failures) {
        test_note("kind %d, distance %a", (int)kind, d);
        for (int i = 0; i < 4; ++i) test_note("{%a, %a, %a}", q->p[i][0], q->p[i][1], q->p[i][2]);
    }
    return truth;
}

/* At the distance, rounded down, at the next doubles, and at one that is further off. */
static void check_around(sc_within_kind kind, const points *q, tally *t)
{
    double d = true_distance(kind, q), next = nextafter(d, HUGE_VAL);
    if (!(next <= DBL_MAX)) return;
    if (d >= DBL_MIN) {
        check(kind, q, d, t);
        CHECK_MSG(check(kind, q, next, t), "%a: more than the distance %a", next, d);
        CHECK_MSG(!check(kind, q, nextafter(d, 0), t), "less than the distance %a", d);
    } else {
        check(kind, q, d, t);
        check(kind, q, next, t);
    }
    d *= 1 + (double)(1 + test_random_below(20)) * (test_random_below(2) ? 0x1p-52 : -0x1p-52);
    if (d <= DBL_MAX) check(kind, q, d, t);
    if (test_random_below(16) == 0) {
        d *= exp2(test_random_range(-60, 60));
        if (d <= DBL_MAX) check(kind, q, d, t);
        check(kind, q, 0, t);
    }
}

static void check_seen(const tally *t, int doubles, int words, int integers)
{
    for (int kind = 0; kind < 2; ++kind) {
        test_note("kind %d: %u asked, %u near, %u by doubles, %u by words, %u by integers", kind,
                  t->asked[kind], t->near[kind], t->doubles[kind], t->words[kind],
                  t->integers[kind]);
        if (!test_is_full()) continue;
        CHECK(t->near[kind] > t->asked[kind] / 10 && t->near[kind] < t->asked[kind] / 10 * 9);
        if (doubles) CHECK(t->doubles[kind] > t->asked[kind] / 50);
        if (words) CHECK(t->words[kind] > t->asked[kind] / 50);
        if (integers) CHECK(t->integers[kind] > t->asked[kind] / 50);
    }
}

/* Calls make for each kind, so many times, and checks. */
static void check_made(void (*make)(sc_within_kind kind, points *q), uint32_t count, tally *t)
{
    uint32_t n = test_iterations(count);
    for (uint32_t i = 0; i < n; ++i) {
        sc_within_kind kind = i & 1 ? SC_WITHIN_EDGE_EDGE : SC_WITHIN_VERTEX_FACE;
        points q;
        make(kind, &q);
        check_around(kind, &q, t);
    }
}

/* ------------------------------------------------------------------------------------------------
 * Pairs
 */

static double whole(int range)
{
    return (double)test_random_below((uint32_t)(2 * range + 1)) - range;
}

static void scale_all(points *q, double factor)
{
    for (int i = 0; i < 4; ++i) {
        for (int k = 0; k < 3; ++k) q->p[i][k] *= factor;
    }
}

static void move_to(points *q, double size)
{
    for (int k = 0; k < 3; ++k) {
        double by = test_random_range(-size, size);
        for (int i = 0; i < 4; ++i) q->p[i][k] += by;
    }
}

static void make_random(sc_within_kind kind, points *q)
{
    (void)kind;
    for (int i = 0; i < 4; ++i) {
        for (int k = 0; k < 3; ++k) q->p[i][k] = test_random_range(-1, 1);
    }
    if (test_random_below(2)) move_to(q, 4);
}

/* Coordinates of widely different sizes. */
static void make_mixed(sc_within_kind kind, points *q)
{
    double range = test_random_below(4) ? 30 : 200;
    make_random(kind, q);
    for (int i = 0; i < 4; ++i) {
        for (int k = 0; k < 3; ++k)
            q->p[i][k] *= test_random_below(4) ? 1 : exp2(test_random_range(-range, 0));
    }
}

static void make_on_grid(sc_within_kind kind, points *q)
{
    static const double edges[] = {1, 0.25, 0.1, 1.0 / 3, 1e-5, 1e300, 1e-300};
    double edge = edges[test_random_below(7)];
    int range = 1 + (int)test_random_below(3), flat = (int)test_random_below(2);
    double place = test_random_below(2) ? whole(1000) : 0;
    (void)kind;
    for (int i = 0; i < 4; ++i) {
        for (int k = 0; k < 3; ++k) q->p[i][k] = k == 2 && flat ? 0 : (whole(range) + place) * edge;
    }
}

/* Triangles without area, edges without length, parallel and touching ones; on a grid or not. */
static void make_degenerate(sc_within_kind kind, points *q)
{
    int split = kind == SC_WITHIN_VERTEX_FACE ? 1 : 2, last = (int)test_random_below(3);
    double s = whole(8) / 8, t = whole(8) / 8;
    if (test_random_below(2))
        make_random(kind, q);
    else
        make_on_grid(kind, q);
    for (int k = 0; k < 3; ++k) {
        double *const x[4] = {&q->p[0][k], &q->p[1][k], &q->p[2][k], &q->p[3][k]};
        switch (last) {
        case 0: /* on a line, or parallel; in one point if s is 0 */
            *x[3] = kind == SC_WITHIN_VERTEX_FACE ? *x[1] + s * (*x[2] - *x[1])
                                                  : *x[2] + s * (*x[1] - *x[0]);
            break;
        case 1:
            *x[3] = *x[2];
            break;
        default: /* next to each other */
            if (split == 1) {
                *x[0] =
                    *x[1] + fabs(s) * (*x[2] - *x[1]) + fabs(t) * (1 - fabs(s)) * (*x[3] - *x[1]);
            } else {
                double there = *x[0] + fabs(s) * (*x[1] - *x[0]);
                *x[3] = there + fabs(t) * (there - *x[2]);
            }
        }
    }
    if (test_random_below(4) == 0)
        q->p[0][test_random_below(3)] += exp2(-(double)test_random_below(52));
}

/*
 * A distance that is an integer times a power of two, along a vector of integer length: to the
 * inside, a side or a corner of what lies across it. Returns the distance.
 */
static double make_exact(sc_within_kind kind, points *q)
{
    static const int vectors[][4] = {{0, 0, 1, 1}, {1, 2, 2, 3},  {2, 3, 6, 7},   {1, 4, 8, 9},
                                     {4, 4, 7, 9}, {2, 6, 9, 11}, {3, 4, 12, 13}, {2, 5, 14, 15},
                                     {0, 3, 4, 5}, {8, 9, 12, 17}};
    const int *n = vectors[test_random_below(10)];
    int first = (int)test_random_below(3), step = 1 + (int)test_random_below(2), times;
    double a[3], u[3], v[3], power = exp2((double)test_random_below(40) - 20);
    for (int k = 0; k < 3; ++k) a[(first + k * step) % 3] = n[k] * (test_random_below(2) ? 1 : -1);
    /* Across it: two of the three (a_2, -a_1, 0), ..., which are not both 0. */
    u[0] = a[1], u[1] = -a[0], u[2] = 0;
    if (u[0] == 0 && u[1] == 0) u[0] = a[2];
    v[0] = 0, v[1] = a[2], v[2] = -a[1];
    if (v[1] == 0 && v[2] == 0) v[1] = a[0];
    times = 1 + (int)test_random_below(5);
    for (int i = 0; i < 4; ++i) {
        /* Corners round the foot, or on one side of it so that one is nearest. */
        double s = whole(3), t = whole(3);
        if (kind == SC_WITHIN_VERTEX_FACE) {
            if (i == 0) s = t = 0;
            if (i == 1) s = fabs(s), t = 0;
            if (i == 2) s = -fabs(s), t = fabs(t);
            if (i == 3) s = -fabs(s), t = -fabs(t);
        } else {
            if (i == 0) s = fabs(s), t = 0;
            if (i == 1) s = -fabs(s), t = 0;
            if (i == 2) s = whole(1) * t, t = fabs(t);
            if (i == 3) s = 0, t = -fabs(t);
        }
        for (int k = 0; k < 3; ++k) {
            int is_off = kind == SC_WITHIN_VERTEX_FACE ? i == 0 : i < 2;
            q->p[i][k] = power * (s * u[k] + t * v[k] + (is_off ? times * a[k] : 0));
        }
    }
    return power * times * n[3];
}

/* ------------------------------------------------------------------------------------------------
 * Tests
 */

static void random_pairs(void)
{
    tally t = {{0}, {0}, {0}, {0}, {0}};
    check_made(make_random, 50000, &t);
    check_seen(&t, 0, 1, 0);
}

static void mixed_pairs(void)
{
    tally t = {{0}, {0}, {0}, {0}, {0}};
    check_made(make_mixed, 30000, &t);
    check_seen(&t, 0, 0, 1);
}

static void pairs_on_a_grid(void)
{
    tally t = {{0}, {0}, {0}, {0}, {0}};
    uint32_t n = test_iterations(30000);
    check_made(make_on_grid, 40000, &t);
    for (uint32_t i = 0; i < n; ++i) {
        sc_within_kind kind = i & 1 ? SC_WITHIN_EDGE_EDGE : SC_WITHIN_VERTEX_FACE;
        points q;
        for (int j = 0; j < 12; ++j) q.p[j / 3][j % 3] = whole(2) + 1e6;
        check(kind, &q, 1, &t);
        check(kind, &q, 2, &t);
        CHECK(answer_in_words(kind, &q, 1, 0) != SC_WITHIN_UNSURE);
    }
    check_seen(&t, 1, 1, 0);
}

static void degenerate_pairs(void)
{
    tally t = {{0}, {0}, {0}, {0}, {0}};
    check_made(make_degenerate, 40000, &t);
    check_seen(&t, 1, 1, 0);
}

static void exact_distances(void)
{
    tally t = {{0}, {0}, {0}, {0}, {0}};
    uint32_t n = test_iterations(30000), reached = 0;
    for (uint32_t i = 0; i < n; ++i) {
        sc_within_kind kind = i & 1 ? SC_WITHIN_EDGE_EDGE : SC_WITHIN_VERTEX_FACE;
        points q;
        double d = make_exact(kind, &q);
        int is_reached = true_distance(kind, &q) == d;
        reached += (uint32_t)is_reached;
        CHECK(check(kind, &q, d, &t) == is_reached);
        check(kind, &q, nextafter(d, 0), &t);
        check(kind, &q, nextafter(d, HUGE_VAL), &t);
        scale_all(&q, exp2(whole(900)));
        if (i % 16 < 2) check_around(kind, &q, &t);
    }
    CHECK_MSG(reached > n / 4, "%u of %u", reached, n);
    check_seen(&t, 0, 1, 0);
}

/* Everything by powers of two that no product survives, and coordinates at both ends of the range.
   */
static void huge_and_tiny_pairs(void)
{
    tally t = {{0}, {0}, {0}, {0}, {0}};
    uint32_t n = test_iterations(20000);
    for (uint32_t i = 0; i < n; ++i) {
        sc_within_kind kind = i & 1 ? SC_WITHIN_EDGE_EDGE : SC_WITHIN_VERTEX_FACE;
        points q;
        int what = (int)test_random_below(4);
        if (what == 0)
            make_mixed(kind, &q);
        else if (what == 1)
            make_on_grid(kind, &q);
        else
            make_random(kind, &q);
        switch (test_random_below(4)) {
        case 0:
            scale_all(&q, exp2(900));
            break;
        case 1:
            scale_all(&q, exp2(-900));
            break;
        case 2:
            scale_all(&q, exp2(-1030));
            break; /* subnormal */
        default:
            scale_all(&q, exp2(whole(300)));
        }
        for (int j = 0; j < 12; ++j) {
            if (!(fabs(q.p[j / 3][j % 3]) <= DBL_MAX)) q.p[j / 3][j % 3] = DBL_MAX;
        }
        check_around(kind, &q, &t);
    }
    n = test_iterations(400);
    for (uint32_t i = 0; i < n; ++i) {
        sc_within_kind kind = i & 1 ? SC_WITHIN_EDGE_EDGE : SC_WITHIN_VERTEX_FACE;
        points q;
        for (int j = 0; j < 12; ++j) {
            double size = exp2(test_random_range(-1074, 1023.9));
            q.p[j / 3][j % 3] = whole(1) * (test_random_below(4) ? size : DBL_MAX);
        }
        check(kind, &q, exp2(test_random_range(-1074, 1023.9)), &t);
        check(kind, &q, DBL_MAX, &t);
        check_around(kind, &q, &t);
    }
    check_seen(&t, 0, 0, 1);
}

/* A vertex over a face, or an edge over an edge, at a distance that vanishes if it is scaled with
   the coordinates, beside one that is a unit less. */
static void distances_that_vanish_when_scaled(void)
{
    static const int sizes[] = {-1070, -1000, -901, -900, -500, 0, 100, 300, 900, 901, 1000};
    static const double heights[] = {0x1p-1074, 3 * 0x1p-1074, 0x1p-1022, 1e-300, 1e-160, 1e-18};
    tally t = {{0}, {0}, {0}, {0}, {0}};
    for (int i = 0; i < 11; ++i) {
        for (int j = 0; j < 6; ++j) {
            double a = exp2(sizes[i]), h = heights[j];
            points face = {{{0, 0, h}, {-a, -a, 0}, {a, -a, 0}, {0, a, 0}}};
            points edges = {{{-a, 0, h}, {a, 0, h}, {0, -a, 0}, {0, a, 0}}};
            points ends = {{{0, 0, h}, {0, 0, a + h}, {0, -a, 0}, {0, a, 0}}};
            const points *const all[3] = {&face, &edges, &ends};
            for (int k = 0; k < 3; ++k) {
                sc_within_kind kind = k == 0 ? SC_WITHIN_VERTEX_FACE : SC_WITHIN_EDGE_EDGE;
                CHECK(check(kind, all[k], h, &t) == 1);
                CHECK(check(kind, all[k], nextafter(h, 0), &t) == 0);
                CHECK(check(kind, all[k], nextafter(h, 1), &t) == 1);
                CHECK(check(kind, all[k], 0, &t) == 0);
            }
        }
    }
}

/* Integers of 27 to 35 bits, at distances next to the true one: products of them fill one word, or
   do not fit any more. The origin of what makes feet inside likely is the middle of the others. */
static void words_at_the_limit(void)
{
    tally t = {{0}, {0}, {0}, {0}, {0}};
    uint32_t n = test_iterations(40000);
    for (uint32_t i = 0; i < n; ++i) {
        sc_within_kind kind = i & 1 ? SC_WITHIN_EDGE_EDGE : SC_WITHIN_VERTEX_FACE;
        double size = exp2(27 + test_random_below(9)), d;
        int inside = kind == SC_WITHIN_VERTEX_FACE ? 6 : 8, truth;
        points q;
        for (int j = 0; j < 12; ++j) q.p[j / 3][j % 3] = floor(test_random_range(-size, size));
        for (int k = 0; k < 3; ++k) {
            if (kind == SC_WITHIN_VERTEX_FACE)
                q.p[0][k] = floor((q.p[1][k] + q.p[2][k] + q.p[3][k]) / 4);
            else
                q.p[0][k] = floor((q.p[2][k] + q.p[3][k]) / 2) - q.p[1][k];
        }
        d = floor(true_distance(kind, &q)) + test_random_below(2);
        truth = check(kind, &q, d, &t);
        CHECK(answer_in_words(kind, &q, d, inside) == truth);
    }
    check_seen(&t, 1, 0, 0);
}

/* d = 0 tells what touches. */
static void touching_pairs(void)
{
    tally t = {{0}, {0}, {0}, {0}, {0}};
    uint32_t n = test_iterations(40000);
    for (uint32_t i = 0; i < n; ++i) {
        sc_within_kind kind = i & 1 ? SC_WITHIN_EDGE_EDGE : SC_WITHIN_VERTEX_FACE;
        points q;
        int touches;
        if (i % 4 < 2)
            make_degenerate(kind, &q);
        else
            make_on_grid(kind, &q);
        touches = check(kind, &q, 0, &t);
        CHECK(!touches || true_distance(kind, &q) == 0);
        CHECK(touches || true_distance(kind, &q) > 0 || is_near(kind, &q, 0x1p-1074));
        check(kind, &q, 0x1p-1074, &t);
    }
    check_seen(&t, 0, 1, 0);
}

/* The largest distance of a point of one and a point of the other. */
static double largest_distance(sc_within_kind kind, const points *q)
{
    int split = kind == SC_WITHIN_VERTEX_FACE ? 1 : 2;
    double largest = 0;
    for (int i = 0; i < split; ++i) {
        for (int j = split; j < 4; ++j) {
            double x = q->p[j][0] - q->p[i][0], y = q->p[j][1] - q->p[i][1];
            double z = q->p[j][2] - q->p[i][2];
            largest = fmax(largest, sqrt(x * x + y * y + z * z));
        }
    }
    return largest;
}

/* Doubles settle what is off by more than their bound and some errors, but where edges are short or
   nearly parallel, and leave what is off by less than the bound and no errors: both to a few pairs.
   */
static void doubles_settle_most(void)
{
    uint32_t n = test_iterations(20000), settled = 0, left = 0;
    for (uint32_t i = 0; i < n; ++i) {
        sc_within_kind kind = i & 1 ? SC_WITHIN_EDGE_EDGE : SC_WITHIN_VERTEX_FACE;
        points q;
        double d, unit;
        make_random(kind, &q);
        d = true_distance(kind, &q);
        unit = (test_random_below(2) ? 0x1p-53 : -0x1p-53) * (largest_distance(kind, &q) + d);
        settled += (uint32_t)is_settled_by_doubles(kind, &q, d + 16 * unit);
        left += (uint32_t)!is_settled_by_doubles(kind, &q, d + 6 * unit);
    }
    CHECK_MSG(settled >= n - n / 20, "%u of %u", settled, n);
    CHECK_MSG(left >= n - n / 20, "%u of %u", left, n);
}

/* Products of limbs, by halves and as the compiler does it, against those of GMP. */
static void products_of_limbs(void)
{
    uint32_t n = test_iterations(20000);
    mpz_t left, right;
    mpz_init(left);
    mpz_init(right);
    for (uint32_t i = 0; i < n; ++i) {
        uint64_t x[4], high, low, by_halves, found[2] = {0, 0};
        for (int k = 0; k < 4; ++k) {
            x[k] = test_random();
            if (test_random_below(3) == 0) x[k] = ~(uint64_t)0;
            if (test_random_below(3) == 0) x[k] <<= test_random_below(64);
        }
        mpz_import(left, 1, -1, sizeof *x, 0, 0, &x[0]);
        mpz_import(right, 1, -1, sizeof *x, 0, 0, &x[1]);
        mpz_mul(left, left, right);
        for (int k = 2; k < 4; ++k) {
            mpz_import(right, 1, -1, sizeof *x, 0, 0, &x[k]);
            mpz_add(left, left, right);
        }
        mpz_export(found, NULL, -1, sizeof *found, 0, 0, left);
        low = sc_limbs_multiply_add(x[0], x[1], x[2], x[3], &high);
        CHECK(low == found[0] && high == found[1]);
        by_halves = sc_limbs_multiply_halves(x[0], x[1], x[2], x[3], &high);
        CHECK(by_halves == found[0] && high == found[1]);
    }
    mpz_clear(left);
    mpz_clear(right);
}

SC_TEST_MAIN(SC_TEST(random_pairs), SC_TEST(mixed_pairs), SC_TEST(pairs_on_a_grid),
             SC_TEST(degenerate_pairs), SC_TEST(exact_distances), SC_TEST(huge_and_tiny_pairs),
             SC_TEST(distances_that_vanish_when_scaled), SC_TEST(words_at_the_limit),
             SC_TEST(touching_pairs), SC_TEST(doubles_settle_most), SC_TEST(products_of_limbs))
