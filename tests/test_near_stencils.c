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
    by *= exact ? (double)(1 + test_random_below(3)) : test_random_range(0.1, 3);
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

/* Differences of points 0 and 1, and of 2 and 3, at right angles but for rounding. */
static void make_perpendicular(double points[4][3])
{
    double u[3], dot = 0, square = 0;
    make_random(points);
    for (int c = 0; c < 3; ++c) {
        u[c] = points[1][c] - points[0][c];
        dot += u[c] * (points[3][c] - points[2][c]);
        square += u[c] * u[c];
    }
    for (int c = 0; c < 3; ++c) points[3][c] -= dot / square * u[c];
}

/* On a grid, but for what is too little to be seen in rounded differences. */
static void make_on_noisy_grid(double points[4][3])
{
    make_on_grid(points, 3);
    for (int i = 0; i < 12; ++i)
        if (!(points[i / 3][i % 3] > 0) && test_random_below(2))
            points[i / 3][i % 3] = ldexp(test_random_range(-1, 1), -60);
}

/* Differences are exact, but of many bits; the last point near the line or plane of others. */
static void make_exact(double points[4][3])
{
    make_random(points);
    if (test_random_below(2))
        put_in_plane(points);
    else
        put_on_line(points, 3, 1, 2);
    for (int i = 0; i < 12; ++i) {
        double *x = &points[i / 3][i % 3];
        *x = (*x + 24) - 24; /* a multiple of 2^-48 */
    }
}

static void make_any(double points[4][3])
{
    switch (test_random_below(13)) {
    case 10:
        make_perpendicular(points);
        break;
    case 11:
        make_on_noisy_grid(points);
        break;
    case 12:
        make_exact(points);
        break;
    case 0:
        make_random(points);
        break;
    case 1:
        make_on_grid(points, 2);
        break;
    case 2:
        make_on_grid(points, 1 + test_random_below(6));
        break;
    case 3:
        make_on_grid(points, UINT32_C(1) << (10 + test_random_below(21)));
        break;
    case 4:
        make_random(points);
        put_on_line(points, 3, 1, 2);
        break;
    case 5:
        make_random(points);
        put_in_plane(points);
        if (test_random_below(2)) put_on_line(points, 3, 1, 2);
        break;
    case 6:
        make_parallel(points);
        break;
    case 7:
        make_parallel_fine(points);
        break;
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

/* Weights of far exponents are small, but not 0. */
static void tiny_weights(void)
{
    double face[4][3] = {{0x1p-1060, 1, 0}, {0, 0, 0}, {0x1p+1000, 0, 0}, {0, -1, 0}};
    double edges[4][3] = {
        {0, 0, 1}, {0x1p+1000, 0, 1}, {0x1p-1060, -1, 0}, {0x1p-1060, 0x1p+1000, 0}};
    tally t;
    stencil_oracle o;
    sc_near_stencil s;
    memset(&t, 0, sizeof(t));
    stencil_oracle_start(&o);
    check_points(&o, SC_NEAR_VERTEX_FACE, face, "tiny", &t);
    s = find(SC_NEAR_VERTEX_FACE, face);
    CHECK(s.feature == SC_FEATURE_VERTEX_EDGE && s.weights[2] >= DBL_MIN && s.weights[2] < 1e-300);
    check_points(&o, SC_NEAR_EDGE_EDGE, edges, "tiny", &t);
    s = find(SC_NEAR_EDGE_EDGE, edges);
    CHECK(s.feature == SC_FEATURE_EDGE_EDGE && s.weights[1] <= -DBL_MIN && s.weights[1] > -1e-300);
    stencil_oracle_stop(&o);
}

static void exchange(double *p, double *q)
{
    double t[3];
    memcpy(t, p, sizeof(t));
    memcpy(p, q, sizeof(t));
    memcpy(q, t, sizeof(t));
}

static int are_same_places(double points[4][3], int i, int j)
{
    return memcmp(points[i], points[j], sizeof(points[i])) == 0;
}

/* What is found does not depend on the order of ends, edges and corners, unless two are at one
   place. */
static void whatever_the_order(void)
{
    uint64_t seen = 0;
    for (uint32_t i = 0; i < test_iterations(20000); ++i) {
        double points[4][3], turned[4][3];
        int to[4] = {0, 1, 2, 3}, turn_vector = 0;
        uint32_t kind = kinds[i % 2], how = test_random_below(3);
        sc_near_stencil s, t;
        if (test_random_below(3))
            make_any(points);
        else
            make_parallel_fine(points);
        if (are_same_places(points, 0, 1) || are_same_places(points, 2, 3) ||
            are_same_places(points, 1, 2) || are_same_places(points, 1, 3))
            continue;
        memcpy(turned, points, sizeof(turned));
        if (kind == SC_NEAR_VERTEX_FACE) {
            int j = 1 + (int)how, k = 1 + ((int)how + 1) % 3;
            exchange(turned[j], turned[k]);
            to[j] = k;
            to[k] = j;
        } else if (how < 2) {
            int j = 2 * (int)how;
            exchange(turned[j], turned[j + 1]);
            to[j] = j + 1;
            to[j + 1] = j;
        } else {
            turn_vector = 1;
            for (int j = 0; j < 4; ++j) to[j] = (j + 2) % 4;
            exchange(turned[0], turned[2]);
            exchange(turned[1], turned[3]);
        }
        s = find(kind, points);
        t = find(kind, turned);
        CHECK(s.feature == t.feature && s.flags == t.flags);
        seen += s.flags;
        CHECK(fabs(s.distance - t.distance) <= 0x1p-49 * s.distance);
        for (int j = 0; j < 4; ++j) {
            double w = turn_vector ? -t.weights[to[j]] : t.weights[to[j]];
            CHECK((s.weights[j] > 0) == (w > 0) && (s.weights[j] < 0) == (w < 0));
            CHECK(fabs(s.weights[j] - w) <= 0x1p-49 * fabs(w));
        }
        for (int k = 0; k < 3; ++k) {
            double v = turn_vector ? -t.vector[k] : t.vector[k];
            CHECK(fabs(s.vector[k] - v) <= 0x1p-49 * fabs(v));
        }
    }
    CHECK(seen > test_iterations(20000) / 20);
}

/* ---- polynomials ---- */

static void exact_span(mpq_t span[3], const double *from, const double *to)
{
    mpq_t t;
    mpq_init(t);
    for (int k = 0; k < 3; ++k) {
        mpq_set_d(span[k], to[k]);
        mpq_set_d(t, from[k]);
        mpq_sub(span[k], span[k], t);
    }
    mpq_clear(t);
}

static void exact_cross(mpq_t result[3], mpq_t u[3], mpq_t v[3])
{
    mpq_t t;
    mpq_init(t);
    for (int k = 0; k < 3; ++k) {
        int i = (k + 1) % 3, j = (k + 2) % 3;
        mpq_mul(result[k], u[i], v[j]);
        mpq_mul(t, u[j], v[i]);
        mpq_sub(result[k], result[k], t);
    }
    mpq_clear(t);
}

static void exact_dot(mpq_t result, mpq_t u[3], mpq_t v[3])
{
    mpq_t t;
    mpq_init(t);
    mpq_set_ui(result, 0, 1);
    for (int k = 0; k < 3; ++k) {
        mpq_mul(t, u[k], v[k]);
        mpq_add(result, result, t);
    }
    mpq_clear(t);
}

/* How far a value is off, in units of 2^-53 of the truth. */
static double error_of(sc_predicates_value value, mpq_t truth)
{
    mpq_t t;
    double error;
    if (mpq_sgn(truth) == 0) return value.number == 0 ? 0 : HUGE_VAL;
    mpq_init(t);
    mpq_set_d(t, value.number);
    if (value.exponent >= 0)
        mpq_mul_2exp(t, t, (mp_bitcnt_t)value.exponent);
    else
        mpq_div_2exp(t, t, (mp_bitcnt_t)-value.exponent);
    mpq_sub(t, t, truth);
    mpq_div(t, t, truth);
    error = fabs(mpq_get_d(t)) * 0x1p+53;
    mpq_clear(t);
    return error;
}

/* What share of its bound the error of a sum of two doubles is. */
static double share_of(const sc_twofold *sum, mpq_t truth)
{
    mpq_t t, high;
    double error;
    mpq_inits(t, high, NULL);
    mpq_set_d(t, sum->low);
    mpq_set_d(high, sum->high);
    mpq_add(t, t, high);
    mpq_sub(t, t, truth);
    error = fabs(mpq_get_d(t));
    mpq_clears(t, high, NULL);
    return sum->magnitude > 0 ? error / (SC_BOUNDS_TWOFOLD * sum->magnitude) : error > 0 ? 9 : 0;
}

/* Each polynomial of differences against its exact value, and its sign. */
static void polynomials(void)
{
    double worst = 0, worst_part = 0;
    uint64_t zeros = 0;
    mpq_t u[3], v[3], w[3], n[3], m[3], truth;
    for (int k = 0; k < 3; ++k) mpq_inits(u[k], v[k], w[k], n[k], m[k], NULL);
    mpq_init(truth);
    for (uint32_t i = 0; i < test_iterations(40000); ++i) {
        double points[4][3];
        const double *p[4] = {points[0], points[1], points[2], points[3]};
        sc_quad quad;
        sc_span su, sv, sw;
        sc_cross sn, sm;
        make_any(points);
        if (i % 7 == 0)
            for (int k = 0; k < 12; ++k) {
                double *x = &points[k / 3][k % 3];
                *x = ldexp(*x, (int)test_random_below(400) - 200);
            }
        sc_quad_set(&quad, p);
        sc_quad_span(&quad, 0, 1, &su);
        sc_quad_span(&quad, i % 3 == 0 ? 0 : 2, 3, &sv);
        sc_quad_span(&quad, 1, 2, &sw);
        sc_quad_cross(&su, &sv, &sn);
        sc_quad_cross(&sw, &sv, &sm);
        exact_span(u, points[0], points[1]);
        exact_span(v, points[i % 3 == 0 ? 0 : 2], points[3]);
        exact_span(w, points[1], points[2]);
        exact_cross(n, u, v);
        exact_cross(m, w, v);
        exact_dot(truth, u, v);
        worst = fmax(worst, error_of(sc_quad_dot(&quad, &su, &sv), truth));
        CHECK(sc_quad_dot_sign(&quad, &su, &sv) == mpq_sgn(truth));
        zeros += mpq_sgn(truth) == 0;
        exact_dot(truth, w, n);
        worst = fmax(worst, error_of(sc_quad_volume(&quad, &sw, &sn), truth));
        exact_dot(truth, m, n);
        worst = fmax(worst, error_of(sc_quad_cross_dot(&quad, &sm, &sn), truth));
        CHECK(sc_quad_cross_dot_sign(&quad, &sw, &sv, &sn) == mpq_sgn(truth));
        zeros += mpq_sgn(truth) == 0;
        CHECK(sc_quad_is_zero(&quad, &sn) == !(mpq_sgn(n[0]) || mpq_sgn(n[1]) || mpq_sgn(n[2])));
        for (int k = 0; k < 3; ++k) {
            worst = fmax(worst, error_of(sc_quad_part(&quad, &sn, k), n[k]));
            if (quad.is_moderate) worst_part = fmax(worst_part, share_of(&sn.part[k], n[k]));
        }
        exact_cross(m, w, n);
        for (int k = 0; k < 3; ++k)
            worst = fmax(worst, error_of(sc_quad_turned(&quad, &sw, &sn, k), m[k]));
    }
    CHECK_MSG(worst <= 1.51, "%.3f u", worst);
    CHECK_MSG(worst > 0.9, "%.3f u", worst);
    CHECK_MSG(worst_part <= 1, "%.3f of the bound", worst_part);
    CHECK(zeros > test_iterations(40000) / 10);
    test_note("%.3f u; %.4f of the bound of sums of two doubles", worst, worst_part);
    for (int k = 0; k < 3; ++k) mpq_clears(u[k], v[k], w[k], n[k], m[k], NULL);
    mpq_clear(truth);
}

/* ---- meshes ---- */

static uint32_t corner_of(const soup *s, const uint32_t *weld, uint32_t corner)
{
    return weld[s->triangles[corner]];
}

/* The vertices that a pair names, 0 if there is no such pair. */
static int name_vertices(const soup *s, const uint32_t *weld, const unsigned char *is_used,
                         uint32_t kind, const sc_pair *pair, uint32_t v[4])
{
    uint32_t sides = kind == SC_NEAR_VERTEX_FACE ? 1 : 2;
    if (kind == SC_NEAR_VERTEX_FACE) {
        if (pair->a >= s->vertex_count || pair->b >= s->triangle_count || !is_used[pair->a])
            return 0;
        v[0] = pair->a;
        for (uint32_t k = 0; k < 3; ++k) v[1 + k] = corner_of(s, weld, 3 * pair->b + k);
    } else {
        const uint32_t edge[2] = {pair->a, pair->b};
        for (uint32_t i = 0; i < 2; ++i) {
            uint32_t t = edge[i] / 3;
            if (t >= s->triangle_count) return 0;
            v[2 * i] = corner_of(s, weld, edge[i]);
            v[2 * i + 1] = corner_of(s, weld, 3 * t + (edge[i] + 1) % 3);
        }
    }
    for (uint32_t i = 0; i < sides; ++i)
        for (uint32_t j = sides; j < 4; ++j)
            if (v[i] == v[j]) return 0;
    return 1;
}

/* Pairs of meshes in every type, order and welding, and names of none. */
static void pairs_of_meshes(void)
{
    uint64_t good = 0, bad = 0;
    stencil_oracle o;
    stencil_oracle_start(&o);
    for (uint32_t round = 0; round < test_iterations_at_least(60, 20); ++round) {
        const char *name;
        soup mesh = shape_any(60, &name), posed = soup_copy(&mesh);
        input_choices choices = input_choose(&mesh, test_random_below(3), test_random_below(4));
        uint32_t *weld = input_weld_of(&choices, &mesh);
        unsigned char *is_used = (unsigned char *)test_allocate(mesh.vertex_count);
        sc_mesh input = input_plain_mesh(&mesh);
        uint32_t type = round % 2 ? SC_FLOAT : SC_DOUBLE;
        input_array positions;
        sc_model *model;
        soup_any_pose(posed.positions, posed.vertex_count);
        if (type == SC_FLOAT) soup_round_to_float(posed.positions, posed.vertex_count);
        positions = input_positions(posed.positions, posed.vertex_count, type, round % 3 * 4);
        memset(is_used, 0, mesh.vertex_count);
        for (uint32_t i = 0; i < 3 * mesh.triangle_count; ++i)
            is_used[corner_of(&mesh, weld, i)] = 1;
        if (CHECK(sc_build(&input, &choices.options, &model) == SC_OK)) {
            sc_pose pose = input_pose(posed.vertex_count, &positions);
            for (uint32_t i = 0; i < 200; ++i) {
                uint32_t kind = kinds[i % 2], v[4];
                uint32_t corners = 3 * mesh.triangle_count;
                sc_pair pair = {test_random_below(i % 2 ? corners : mesh.vertex_count),
                                test_random_below(i % 2 ? corners : mesh.triangle_count)};
                sc_near_stencil s[2];
                sc_status status;
                double at[4][3];
                const char *wrong;
                memset(s, 0x77, sizeof(s));
                status = sc_near_stencils(model, &pose, kind, &pair, 1, s);
                CHECK(s[1].feature == 0x77777777);
                if (!name_vertices(&mesh, weld, is_used, kind, &pair, v)) {
                    CHECK_MSG(status == SC_ERROR_PAIRS, "%s: %d", name, (int)status);
                    bad++;
                    continue;
                }
                if (!CHECK_MSG(status == SC_OK, "%s: %d", name, (int)status)) continue;
                good++;
                for (int k = 0; k < 4; ++k)
                    memcpy(at[k], posed.positions + 3 * (size_t)v[k], sizeof(at[k]));
                CHECK(memcmp(v, s[0].vertices, sizeof(v)) == 0);
                stencil_oracle_find(&o, kind, at);
                wrong = stencil_oracle_compare(&o, s);
                CHECK_MSG(!wrong, "%s: %s", name, wrong);
            }
            sc_model_free(model);
        }
        input_free(&positions);
        free(weld);
        free(is_used);
        input_free_choices(&choices);
        soup_free(&mesh);
        soup_free(&posed);
    }
    CHECK(good > 500 && bad > 100);
    stencil_oracle_stop(&o);
}

/* ---- merging ---- */

/* A stencil of a few vertices; weight says where it comes from. */
static void make_stencil(sc_near_stencil *s, uint32_t vertices, uint32_t number)
{
    uint32_t kind = test_random_below(2), feature = 1 + test_random_below(4);
    memset(s, 0, sizeof(*s));
    s->distance = number;
    s->flags = test_random_below(2);
    for (uint32_t i = 0; i < 4; ++i) s->vertices[i] = test_random_below(vertices);
    if (feature == SC_FEATURE_EDGE_EDGE) kind = 1;
    if (feature == SC_FEATURE_VERTEX_FACE) kind = 0;
    s->feature = feature;
    if (feature >= 3) {
        for (uint32_t i = 0; i < 4; ++i)
            s->weights[i] = i < 1 + kind ? -1.0 / (1 + kind) : 1.0 / (3 - kind);
    } else if (feature == 2 && kind == 1 && test_random_below(2)) {
        s->weights[0] = test_random_below(2) ? -1 : -0.25; /* with a neighbor that is next to 0 */
        s->weights[1] = s->weights[0] < -0.5 ? -DBL_MIN : -0.75;
        s->weights[2 + test_random_below(2)] = 1;
    } else {
        uint32_t out = 1 + kind + test_random_below(3 - kind);
        s->weights[kind ? test_random_below(2) : 0] = -1;
        for (uint32_t i = 1 + kind; i < 4; ++i) {
            if (feature == 1)
                s->weights[i] = i == out;
            else if (kind || i != out)
                s->weights[i] = 0.5;
        }
    }
}

/* Whether two are of the same two vertices, or the same vertex and edge, by all of both. */
static int are_alike(const sc_near_stencil *s, const sc_near_stencil *t)
{
    for (int turn = 0; turn < 2; ++turn) {
        int alike = s->feature == t->feature && s->feature <= 2;
        for (int i = 0; i < 4; ++i)
            for (int side = -1; side < 2; side += 2) {
                const sc_near_stencil *from = side < 0 ? s : t, *to = side < 0 ? t : s;
                int found = !(from->weights[i] < 0) && !(from->weights[i] > 0);
                for (int j = 0; j < 4; ++j) {
                    double w = turn ? -to->weights[j] : to->weights[j];
                    found |= from->vertices[i] == to->vertices[j] &&
                             (from->weights[i] > 0 ? w > 0 : w < 0);
                }
                alike &= found;
            }
        if (alike) return 1;
    }
    return 0;
}

static void merged(void)
{
    enum { MOST = 300 };
    static sc_near_stencil before[MOST], after[MOST + 1];
    static uint32_t multiplicities[MOST + 1], expected[MOST];
    uint64_t merges = 0;
    for (uint32_t round = 0; round < test_iterations_at_least(400, 100); ++round) {
        uint32_t count = test_random_below(round % 4 ? 12 : MOST + 1), left = 0;
        uint32_t vertices = 4 + test_random_below(round % 3 ? 3 : 30);
        uint64_t merged_count = 77;
        for (uint32_t i = 0; i < count; ++i) {
            int distinct;
            do { /* a pair has no vertex twice, but for edges without length */
                make_stencil(&before[i], vertices, i);
                distinct = 1;
                for (int j = 0; j < 4; ++j)
                    for (int k = 0; k < j; ++k)
                        distinct &= before[i].vertices[j] != before[i].vertices[k];
            } while (!distinct);
            expected[i] = 1;
            for (uint32_t j = 0; j < i; ++j)
                if (expected[j] && are_alike(&before[i], &before[j])) {
                    expected[j]++;
                    expected[i] = 0;
                    merges++;
                    break;
                }
        }
        memcpy(after, before, count * sizeof(*before));
        memset(&after[count], 0x55, sizeof(after[count]));
        multiplicities[count] = 0x55555555;
        CHECK(sc_near_merge(after, count, &merged_count, multiplicities) == SC_OK);
        CHECK(after[count].feature == 0x55555555 && multiplicities[count] == 0x55555555);
        for (uint32_t i = 0; i < count; ++i) {
            if (!expected[i]) continue;
            if (!CHECK(left < merged_count)) break;
            CHECK(memcmp(&after[left], &before[i], sizeof(before[i])) == 0);
            CHECK(multiplicities[left] == expected[i]);
            left++;
        }
        CHECK(left == merged_count);
    }
    CHECK(merges > test_iterations_at_least(400, 100) / 2);
}

/* The stencils of all pairs of a flat mesh, in which many are of one feature. */
static void merged_of_a_mesh(void)
{
    soup mesh = soup_cloth(4, 4);
    sc_mesh input = input_plain_mesh(&mesh);
    sc_pose pose = input_plain_pose(mesh.positions, mesh.vertex_count);
    sc_model *model;
    if (CHECK(sc_build(&input, NULL, &model) == SC_OK)) {
        enum { MOST = 20000 };
        static sc_near_stencil s[MOST];
        static uint32_t multiplicities[MOST];
        uint64_t count = 0, left, sum = 0;
        for (uint32_t k = 0; k < 2; ++k) {
            uint32_t most_a = k ? 3 * mesh.triangle_count : mesh.vertex_count;
            uint32_t most_b = k ? 3 * mesh.triangle_count : mesh.triangle_count;
            for (uint32_t a = 0; a < most_a; ++a)
                for (uint32_t b = k ? a + 1 : 0; b < most_b && count < MOST; ++b) {
                    sc_pair pair = {a, b};
                    if (sc_near_stencils(model, &pose, kinds[k], &pair, 1, &s[count]) == SC_OK)
                        count++;
                }
        }
        CHECK(sc_near_merge(s, count, &left, multiplicities) == SC_OK);
        CHECK(left < count && left > 0);
        for (uint64_t i = 0; i < left; ++i) {
            sum += multiplicities[i];
            for (uint64_t j = 0; j < i && i < 2000; ++j) CHECK(!are_alike(&s[i], &s[j]));
        }
        CHECK(sum == count);
        sc_model_free(model);
    }
    soup_free(&mesh);
}

static void wrong_arguments(void)
{
    soup mesh = soup_cloth(2, 2); /* 8 triangles, 9 vertices */
    sc_mesh input = input_plain_mesh(&mesh);
    sc_pose pose = input_plain_pose(mesh.positions, mesh.vertex_count);
    sc_pair pair = {8, 0};
    sc_near_stencil s;
    sc_model *model;
    uint64_t left = 5;
    uint32_t multiplicity;
    const uint32_t kind = SC_NEAR_VERTEX_FACE;
    if (!CHECK(sc_build(&input, NULL, &model) == SC_OK)) return;
    CHECK(sc_near_stencils(model, &pose, kind, &pair, 1, &s) == SC_OK);
    CHECK(sc_near_stencils(model, &pose, kind, NULL, 0, NULL) == SC_OK);
    CHECK(sc_near_stencils(NULL, &pose, kind, &pair, 1, &s) == SC_ERROR_NULL);
    CHECK(sc_near_stencils(model, NULL, kind, &pair, 1, &s) == SC_ERROR_NULL);
    CHECK(sc_near_stencils(model, &pose, kind, NULL, 1, &s) == SC_ERROR_NULL);
    CHECK(sc_near_stencils(model, &pose, kind, &pair, 1, NULL) == SC_ERROR_NULL);
    CHECK(sc_near_stencils(model, &pose, SC_NEAR_BOTH, &pair, 1, &s) == SC_ERROR_OPTION);
    CHECK(sc_near_stencils(model, &pose, 3, &pair, 1, &s) == SC_ERROR_OPTION);
    for (uint32_t k = 0; k < 2; ++k) {
        static const sc_pair wrong[2][4] = {{{9, 0}, {8, 8}, {UINT32_MAX, 0}, {8, UINT32_MAX}},
                                            {{24, 0}, {0, 24}, {UINT32_MAX, 0}, {0, 0}}};
        for (int i = 0; i < 4; ++i)
            CHECK(sc_near_stencils(model, &pose, kinds[k], &wrong[k][i], 1, &s) == SC_ERROR_PAIRS);
    }
    for (uint32_t k = 0; k < 3; ++k) {
        double *x = &mesh.positions[3 * 8 + k], kept = *x;
        *x = k == 0 ? (double)NAN : k == 1 ? HUGE_VAL : -HUGE_VAL;
        CHECK(sc_near_stencils(model, &pose, kind, &pair, 1, &s) == SC_ERROR_NOT_FINITE);
        *x = kept;
    }
    pose.vertex_count--;
    CHECK(sc_near_stencils(model, &pose, kind, &pair, 1, &s) == SC_ERROR_VERTEX_COUNT);
    pose.vertex_count++;
    pose.struct_size = 4;
    CHECK(sc_near_stencils(model, &pose, kind, &pair, 1, &s) == SC_ERROR_STRUCT_SIZE);
    pose.struct_size = sizeof(pose);
    pose.position_stride = 1;
    CHECK(sc_near_stencils(model, &pose, kind, &pair, 1, &s) == SC_ERROR_STRIDE);
    sc_model_free(model);
    soup_free(&mesh);

    CHECK(sc_near_merge(&s, 1, NULL, &multiplicity) == SC_ERROR_NULL);
    CHECK(sc_near_merge(NULL, 1, &left, &multiplicity) == SC_ERROR_NULL && left == 0);
    left = 5;
    CHECK(sc_near_merge(&s, 1, &left, NULL) == SC_ERROR_NULL && left == 0);
    left = 5;
    CHECK(sc_near_merge(&s, UINT64_C(1) << 32, &left, &multiplicity) == SC_ERROR_COUNT);
    CHECK(left == 0);
    left = 5;
    CHECK(sc_near_merge(NULL, 0, &left, NULL) == SC_OK && left == 0);
}

SC_TEST_MAIN(SC_TEST(against_rationals), SC_TEST(on_a_grid), SC_TEST(scaled), SC_TEST(tiny_weights),
             SC_TEST(whatever_the_order), SC_TEST(polynomials), SC_TEST(pairs_of_meshes),
             SC_TEST(merged), SC_TEST(merged_of_a_mesh), SC_TEST(wrong_arguments))
