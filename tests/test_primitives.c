/*
 * Two triangles on few points of a grid, in every position they can have, against the oracle: edge and
 * triangle pairs, touching and proper, any choice of edges.
 *
 * SPDX-License-Identifier: MIT
 */
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "harness.h"
#include "oracle.h"
#include "query/primitives.h"

enum { MOST_POINTS = 8 };

typedef struct two {
    double points[3 * MOST_POINTS];
    uint32_t count, corners[6];
} two;

/* Points of a small grid, all of it or what a plane or line through it holds, exactly or off by a
   rounding; any size, so that products overflow and underflow. */
static void random_points(two *t)
{
    uint32_t range = 2 + test_random_below(5), shape = test_random_below(6);
    double size = 1;
    t->count = 3 + test_random_below(MOST_POINTS - 2);
    for (uint32_t v = 0; v < t->count; ++v) {
        double *p = t->points + 3 * v;
        for (int k = 0; k < 3; ++k) p[k] = test_random_below(range);
        if (shape == 0) p[2] = 0;
        if (shape == 1) p[2] = p[0] - 2 * p[1];
        if (shape == 2) {
            p[1] = 2 * p[0];
            p[2] = -p[0];
        }
        if (shape == 3) {
            double x = p[0] / 7, y = p[1] / 7;
            p[0] = 0.1 + 0.3 * x - 0.7 * y;
            p[1] = 0.2 - x + 0.4 * y;
            p[2] = 0.3 * x + 0.9 * y;
            for (int k = 0; k < 3; ++k)
                if (test_random_below(3) == 0)
                    p[k] = nextafter(p[k], test_random_below(2) ? 9 : -9);
        }
    }
    switch (test_random_below(8)) {
    case 0:
        size = shape == 3 ? 0x1p-900 : 0x1p-1074;
        break;
    case 1:
        size = 0x1p1000;
        break;
    case 2:
        size = 0x1p-350;
        break;
    default:
        break;
    }
    for (uint32_t i = 0; i < 3 * t->count; ++i) t->points[i] *= size;
}

static void random_corners(two *t)
{
    int different = test_random_below(8) != 0;
    for (uint32_t k = 0; k < 6; ++k) {
        uint32_t again = 1;
        while (again) {
            t->corners[k] = test_random_below(t->count);
            again = 0;
            for (uint32_t i = k / 3 * 3; different && i < k; ++i)
                again |= t->corners[i] == t->corners[k];
        }
    }
}

/* Sides that are the same edge of one triangle all have the name of the first. */
static unsigned name_edges(const two *t, unsigned sides)
{
    unsigned named = 0;
    for (uint32_t side = 0; side < 6; ++side) {
        uint32_t base = side / 3 * 3, first = side, i;
        uint32_t a = t->corners[side], b = t->corners[base + (side - base + 1) % 3];
        if (!(sides >> side & 1)) continue;
        for (i = side; i-- > base;) {
            uint32_t c = t->corners[i], d = t->corners[base + (i - base + 1) % 3];
            if ((a == c && b == d) || (a == d && b == c)) first = i;
        }
        named |= 1u << first;
    }
    return named;
}

static void two_triangles(void)
{
    uint64_t fallbacks = 0;
    uint32_t meetings[2] = {0, 0}, crossings[2] = {0, 0}, rounds = test_iterations(60000);
    for (uint32_t round = 0; round < rounds; ++round) {
        two t;
        sc_triangle_pair pair;
        oracle_answer answer;
        uint64_t state = test_random_state();
        random_points(&t);
        random_corners(&t);
        for (int k = 0; k < 3; ++k) {
            pair.va[k] = t.corners[k];
            pair.vb[k] = t.corners[3 + k];
            pair.a[k] = t.points + 3 * t.corners[k];
            pair.b[k] = t.points + 3 * t.corners[3 + k];
        }
        oracle_solve(t.points, t.count, t.corners, 2, NULL, &answer);
        for (int proper = 0; proper < 2; ++proper) {
            const oracle_list *edges = &answer.lists[SC_PAIRS_EDGE][proper];
            unsigned expected = 0, mask = test_random_below(64);
            unsigned hits =
                sc_primitives_edge_hits(&pair, proper, SC_PRIMITIVES_ALL_EDGES, &fallbacks);
            int meet = sc_primitives_triangles_meet(&pair, proper, &fallbacks);
            for (uint64_t i = 0; i < edges->count; ++i) expected |= 1u << edges->pairs[i].a;
            CHECK_MSG(name_edges(&t, hits) == expected,
                      "proper %d: edges %x instead of %x; started at %" PRIu64, proper,
                      name_edges(&t, hits), expected, state);
            CHECK_MSG(meet == (answer.lists[SC_PAIRS_TRIANGLE][proper].count != 0),
                      "proper %d: meet %d; started at %" PRIu64, proper, meet, state);
            CHECK_MSG(sc_primitives_edge_hits(&pair, proper, mask, &fallbacks) == (hits & mask),
                      "proper %d, edges %x; started at %" PRIu64, proper, mask, state);
            meetings[proper] += (uint32_t)meet;
            crossings[proper] += expected != 0;
        }
        oracle_free(&answer);
    }
    /* enough of each kind */
    for (int proper = 0; proper < 2 && rounds >= 10000; ++proper)
        CHECK(meetings[proper] > rounds / 50 && meetings[proper] < rounds - rounds / 50 &&
              crossings[proper] > rounds / 50);
    CHECK(meetings[0] >= meetings[1] && fallbacks > 0);
}

SC_TEST_MAIN(SC_TEST(two_triangles))
