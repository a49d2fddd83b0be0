/*
 * Tests of the oracle itself, against answers known by hand and, on small integer points, against a
 * third way: by Caratheodory's theorem two hulls meet if and only if the equations of a common
 * point have a solution with independent columns and no negative weight. All such solutions are
 * listed here in plain integers; the corners of the intersection are among them.
 *
 * SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <string.h>

#include "harness.h"
#include "oracle.h"
#include "soups.h"

typedef struct point {
    int64_t x[3];
} point;

static point point_of(const double *positions, uint32_t vertex)
{
    point p;
    for (uint32_t i = 0; i < 3; ++i) p.x[i] = (int64_t)positions[3 * vertex + i];
    return p;
}

static int64_t dot(const int64_t *u, const int64_t *v)
{
    return u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
}

/* Whether x / d, d > 0, lies on the closed segment s t. */
static int is_on_segment(const int64_t *x, int64_t d, const point *s, const point *t)
{
    int64_t u[3], v[3];
    for (int i = 0; i < 3; ++i) {
        u[i] = x[i] - d * s->x[i];
        v[i] = t->x[i] - s->x[i];
    }
    for (int i = 0; i < 3; ++i) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        if (u[j] * v[k] != u[k] * v[j]) return 0;
    }
    if (dot(v, v) == 0) return dot(u, u) == 0;
    return dot(u, v) >= 0 && dot(u, v) <= d * dot(v, v);
}

/*
 * Solves the columns of subset for the right-hand side; weights[j] / the returned denominator > 0
 * is the weight of column j. 0 if they are dependent, have no solution, or a negative one.
 */
static int64_t solve(const int64_t columns[6][5], uint32_t subset, int64_t *weights)
{
    int64_t table[5][7], before = 1;
    int row_of[6], rows = 0, sign;
    for (int i = 0; i < 5; ++i) {
        for (int j = 0; j < 6; ++j) table[i][j] = columns[j][i];
        table[i][6] = i >= 3;
    }
    for (int j = 0; j < 6; ++j) {
        int r = rows;
        weights[j] = 0;
        if ((subset >> j & 1) == 0) continue;
        while (r < 5 && table[r][j] == 0) ++r;
        if (r == 5) return 0;
        for (int k = 0; k < 7; ++k) {
            int64_t swap = table[r][k];
            table[r][k] = table[rows][k];
            table[rows][k] = swap;
        }
        for (int i = 0; i < 5; ++i) {
            int64_t factor = table[i][j];
            if (i == rows) continue;
            for (int k = 0; k < 7; ++k)
                table[i][k] = (table[i][k] * table[rows][j] - factor * table[rows][k]) / before;
        }
        before = table[rows][j];
        row_of[j] = rows++;
    }
    for (int i = rows; i < 5; ++i) {
        if (table[i][6] != 0) return 0;
    }
    sign = before < 0 ? -1 : 1;
    for (int j = 0; j < 6; ++j) {
        if ((subset >> j & 1) == 0) continue;
        weights[j] = sign * table[row_of[j]][6];
        if (weights[j] < 0) return 0;
    }
    return sign * before;
}

/* Whether two hulls have a common point, and off the segment s t if that is not NULL. */
static int meet(const point *p, uint32_t p_count, const point *q, uint32_t q_count, const point *s,
                const point *t)
{
    int64_t columns[6][5], weights[6];
    uint32_t count = p_count + q_count;
    memset(columns, 0, sizeof(columns));
    for (uint32_t j = 0; j < count; ++j) {
        for (int i = 0; i < 3; ++i) columns[j][i] = j < p_count ? p[j].x[i] : -q[j - p_count].x[i];
        columns[j][j < p_count ? 3 : 4] = 1;
    }
    for (uint32_t subset = 1; subset < 1u << count; ++subset) {
        int64_t x[3] = {0, 0, 0},
                denominator = solve((const int64_t(*)[5])columns, subset, weights);
        if (denominator == 0) continue;
        if (s == NULL) return 1;
        for (uint32_t j = 0; j < p_count; ++j) {
            for (int i = 0; i < 3; ++i) x[i] += weights[j] * p[j].x[i];
        }
        if (!is_on_segment(x, denominator, s, t)) return 1;
    }
    return 0;
}

/* What SC_PAIRS_TRIANGLE, touching, says of triangles 0 and 1 of a soup. */
static int expect_touching(const soup *s)
{
    const uint32_t *a = s->triangles, *b = s->triangles + 3;
    point p[3], q[3], shared[3], rest_p[3], rest_q[3];
    uint32_t seen[3], shared_count = 0, p_count = 0, q_count = 0;
    for (uint32_t k = 0; k < 3; ++k) {
        uint32_t is_new = 1;
        p[k] = point_of(s->positions, a[k]);
        q[k] = point_of(s->positions, b[k]);
        for (uint32_t i = 0; i < shared_count; ++i) is_new &= seen[i] != a[k];
        if (is_new && (a[k] == b[0] || a[k] == b[1] || a[k] == b[2])) {
            seen[shared_count] = a[k];
            shared[shared_count++] = p[k];
        }
    }
    for (uint32_t k = 0; k < 3; ++k) {
        int in_p = 0, in_q = 0;
        for (uint32_t i = 0; i < shared_count; ++i) {
            in_p |= seen[i] == a[k];
            in_q |= seen[i] == b[k];
        }
        if (!in_p) rest_p[p_count++] = p[k];
        if (!in_q) rest_q[q_count++] = q[k];
    }
    if (shared_count == 0) return meet(p, 3, q, 3, NULL, NULL);
    if (shared_count == 1)
        return meet(rest_p, p_count, q, 3, NULL, NULL) || meet(p, 3, rest_q, q_count, NULL, NULL);
    if (shared_count == 2) return meet(p, 3, q, 3, &shared[0], &shared[1]);
    return 1;
}

static int64_t volume(const point *a, const point *b, const point *c, const point *d)
{
    int64_t u[3], v[3], w[3];
    for (int i = 0; i < 3; ++i) {
        u[i] = b->x[i] - a->x[i];
        v[i] = c->x[i] - a->x[i];
        w[i] = d->x[i] - a->x[i];
    }
    return u[0] * (v[1] * w[2] - v[2] * w[1]) + u[1] * (v[2] * w[0] - v[0] * w[2]) +
           u[2] * (v[0] * w[1] - v[1] * w[0]);
}

static int opposite(int64_t x, int64_t y)
{
    return (x < 0 && y > 0) || (x > 0 && y < 0);
}

static int same(int64_t x, int64_t y)
{
    return (x < 0 && y < 0) || (x > 0 && y > 0);
}

/* Whether the edge p q crosses a triangle properly, by signs of volumes. */
static int expect_proper(const point *p, const point *q, const point *t)
{
    int64_t a = volume(p, q, &t[0], &t[1]), b = volume(p, q, &t[1], &t[2]);
    int64_t c = volume(p, q, &t[2], &t[0]);
    return opposite(volume(&t[0], &t[1], &t[2], p), volume(&t[0], &t[1], &t[2], q)) && same(a, b) &&
           same(b, c);
}

static int is_listed(const oracle_list *list, uint32_t a, uint32_t b)
{
    for (uint64_t i = 0; i < list->count; ++i) {
        if (list->pairs[i].a == a && list->pairs[i].b == b) return 1;
    }
    return 0;
}

/* Compares the oracle's answer on a soup of two triangles. */
static void check_two(const soup *s)
{
    oracle_answer answer;
    int expected = expect_touching(s), any_proper = 0;
    oracle_solve(s->positions, s->vertex_count, s->triangles, 2, NULL, &answer);
    CHECK_MSG((int)answer.lists[SC_PAIRS_TRIANGLE][SC_CONTACT_TOUCHING].count == expected,
              "expected %d", expected);
    for (uint32_t a = 0; a < 2; ++a) {
        const uint32_t *v = s->triangles + 3 * a, *w = s->triangles + 3 * (1 - a);
        for (uint32_t k = 0; k < 3; ++k) {
            uint32_t from = v[k], to = v[(k + 1) % 3];
            point ends[2], t[3];
            int shares = 0, repeated = 0, touches, proper;
            for (uint32_t i = 0; i < 3; ++i) {
                shares |= w[i] == from || w[i] == to;
                t[i] = point_of(s->positions, w[i]);
            }
            for (uint32_t i = 0; i < k; ++i) {
                uint32_t x = v[i], y = v[(i + 1) % 3];
                repeated |= (x == from && y == to) || (x == to && y == from);
            }
            ends[0] = point_of(s->positions, from);
            ends[1] = point_of(s->positions, to);
            shares |= from == to;
            proper = !shares && expect_proper(&ends[0], &ends[1], t);
            touches = !shares && !repeated && meet(ends, 2, t, 3, NULL, NULL);
            any_proper |= proper;
            CHECK_MSG(is_listed(&answer.lists[SC_PAIRS_EDGE][SC_CONTACT_TOUCHING], 3 * a + k,
                                1 - a) == touches,
                      "expected %d for side %u of %u", touches, k, a);
            CHECK_MSG(is_listed(&answer.lists[SC_PAIRS_EDGE][SC_CONTACT_PROPER], 3 * a + k,
                                1 - a) == (proper && !repeated),
                      "expected %d for side %u of %u", proper && !repeated, k, a);
        }
    }
    CHECK((int)answer.lists[SC_PAIRS_TRIANGLE][SC_CONTACT_PROPER].count == any_proper);
    oracle_free(&answer);
}

static void agrees_with_enumeration(void)
{
    uint32_t rounds = test_iterations(60000);
    for (uint32_t i = 0; i < rounds; ++i) {
        uint32_t vertex_count = 1 + test_random_below(6), range = 1 + test_random_below(4);
        soup s = soup_make(vertex_count, 2);
        for (uint32_t k = 0; k < 3 * vertex_count; ++k) {
            s.positions[k] = test_random_below(range + 1);
            if (k % 3 == 2 && i % 4 == 0) s.positions[k] = 0;
        }
        for (uint32_t k = 0; k < 6; ++k)
            s.triangles[k] = vertex_count == 6 && i % 2 == 0 ? k : test_random_below(vertex_count);
        check_two(&s);
        soup_free(&s);
    }
}

typedef struct known {
    const char *name;
    double positions[6][3];
    uint32_t triangles[6];
    uint64_t counts[2][2]; /* triangle touching, proper; edge touching, proper */
} known;

static const known known_cases[] = {
    {"apart",
     {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}},
     {0, 1, 2, 3, 4, 5},
     {{0, 0}, {0, 0}}},
    {"one edge pierces",
     {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {1, 1, -1}, {1, 1, 1}, {9, 9, 1}},
     {0, 1, 2, 3, 4, 5},
     {{1, 1}, {2, 2}}}, /* and the edge from 1 to 2 passes through the other triangle */
    {"a corner touches the inside",
     {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {1, 1, 0}, {1, 1, 1}, {2, 1, 1}},
     {0, 1, 2, 3, 4, 5},
     {{1, 0}, {2, 0}}},
    {"shared vertex, apart",
     {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 1}, {0, -1, 1}, {0, 0, 0}},
     {0, 1, 2, 0, 3, 4},
     {{0, 0}, {0, 0}}},
    {"shared vertex, crossing",
     {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {1, 1, -1}, {1, 1, 1}, {0, 0, 0}},
     {0, 1, 2, 0, 3, 4},
     {{1, 1}, {1, 1}}},
    {"shared edge, folded flat",
     {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {4, 4, 0}, {0, 0, 0}, {0, 0, 0}},
     {0, 1, 2, 1, 0, 3},
     {{1, 0}, {0, 0}}},
    {"shared edge, flat and open",
     {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {4, -4, 0}, {0, 0, 0}, {0, 0, 0}},
     {0, 1, 2, 1, 0, 3},
     {{0, 0}, {0, 0}}},
    {"duplicates",
     {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}},
     {0, 1, 2, 2, 1, 0},
     {{1, 0}, {0, 0}}},
};

static void knows_by_hand(void)
{
    for (size_t i = 0; i < sizeof(known_cases) / sizeof(known_cases[0]); ++i) {
        const known *k = &known_cases[i];
        oracle_answer answer;
        oracle_solve(&k->positions[0][0], 6, k->triangles, 2, NULL, &answer);
        for (int kind = 0; kind < 2; ++kind) {
            for (int contact = 0; contact < 2; ++contact)
                CHECK_MSG(answer.lists[kind][contact].count == k->counts[kind][contact],
                          "%s: kind %d, contact %d: %u", k->name, kind, contact,
                          (unsigned)answer.lists[kind][contact].count);
        }
        oracle_free(&answer);
    }
}

/* The last bit decides, over the whole range of exponents. */
static void sees_the_last_bit(void)
{
    static const double scales[] = {1, 1e-300, 1e300, 0x1p-1074};
    for (int i = 0; i < 4; ++i) {
        double s = scales[i], third = i == 3 ? s : s / 3;
        double p[9] = {third, third, third, s, s, s, s, third, 7 * s};
        double q[9] = {third, third, third, -s, 0, 0, 0, -s, 0};
        CHECK(oracle_hulls_meet(p, 3, q, 3));
        q[2] = nextafter(q[2], -HUGE_VAL);
        CHECK(!oracle_hulls_meet(p, 3, q, 3));
    }
}

/* Triangles that share no vertex meet if and only if an edge of one meets the other. */
static void triangles_agree_with_edges(void)
{
    uint32_t rounds = test_iterations(150);
    for (uint32_t i = 0; i < rounds; ++i) {
        const char *name;
        soup s = i % 2 == 0 ? soup_scattered() : soup_any_mesh(60, &name);
        oracle_answer answer;
        const oracle_list *edges, *triangles;
        uint64_t apart = 0, found = 0;
        if (i % 2 != 0) soup_any_pose(s.positions, s.vertex_count);
        oracle_solve(s.positions, s.vertex_count, s.triangles, s.triangle_count, NULL, &answer);
        edges = &answer.lists[SC_PAIRS_EDGE][SC_CONTACT_TOUCHING];
        triangles = &answer.lists[SC_PAIRS_TRIANGLE][SC_CONTACT_TOUCHING];
        for (uint64_t e = 0; e < edges->count; ++e) {
            uint32_t a = edges->pairs[e].a / 3, b = edges->pairs[e].b;
            CHECK(is_listed(triangles, a < b ? a : b, a < b ? b : a));
        }
        for (uint64_t t = 0; t < triangles->count; ++t) {
            const uint32_t *v = s.triangles + 3 * triangles->pairs[t].a;
            const uint32_t *w = s.triangles + 3 * triangles->pairs[t].b;
            int shares = 0, meets = 0;
            for (uint32_t k = 0; k < 9; ++k) shares |= v[k / 3] == w[k % 3];
            if (shares) continue;
            ++apart;
            for (uint32_t k = 0; k < 6; ++k) {
                const uint32_t *edge = k < 3 ? v : w, *face = k < 3 ? w : v;
                double p[6], q[9];
                memcpy(p, s.positions + 3 * edge[k % 3], 3 * sizeof(double));
                memcpy(p + 3, s.positions + 3 * edge[(k + 1) % 3], 3 * sizeof(double));
                for (uint32_t c = 0; c < 3; ++c)
                    memcpy(q + 3 * c, s.positions + 3 * face[c], 3 * sizeof(double));
                meets |= oracle_hulls_meet(p, 2, q, 3);
            }
            found += meets != 0;
        }
        CHECK(apart == found);
        oracle_free(&answer);
        soup_free(&s);
    }
}

SC_TEST_MAIN(SC_TEST(knows_by_hand), SC_TEST(agrees_with_enumeration), SC_TEST(sees_the_last_bit),
             SC_TEST(triangles_agree_with_edges))
