/*
 * Two triangles on few points of a grid, in every position they can have, against the oracle: edge
 * and triangle pairs, touching and proper, any choice of edges. And eight pairs at once against one
 * by one.
 *
 * SPDX-License-Identifier: MIT
 */
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "harness.h"
#include "oracle.h"
#include "query/primitives.h"
#include "query/query_kernels.h"

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

/* Anywhere: so that nearly all signs are certain. */
static void points_anywhere(two *t)
{
    t->count = 6;
    for (uint32_t k = 0; k < t->count; ++k) t->corners[k] = k;
    for (uint32_t i = 0; i < 3 * t->count; ++i) t->points[i] = test_random_unit();
}

/* Eight pairs, as the library has them: each has points and two triangles of its own. */
typedef struct batch {
    sc_pair_lanes lanes;
    sc_pair pairs[SC_PAIR_LANES];
    uint32_t triangle[6 * SC_PAIR_LANES];
    double points[3 * MOST_POINTS * SC_PAIR_LANES];
    /* the same with odd strides, or floats, for first and for second triangles */
    unsigned char bytes[2][MOST_POINTS * SC_PAIR_LANES * 27];
} batch;

static void clear_batch(batch *b)
{
    memset(b, 0, sizeof *b);
    b->lanes.pairs = b->pairs;
    b->lanes.of[0].triangle = b->triangle;
    b->lanes.of[0].positions = (const unsigned char *)b->points;
    b->lanes.of[0].stride = 3 * sizeof(double);
    b->lanes.of[1] = b->lanes.of[0];
}

/* Has first or second triangles read from bytes. */
static void put_bytes(batch *b, int side, int floats)
{
    sc_triangle_source *of = &b->lanes.of[side];
    of->positions = b->bytes[side];
    of->floats = floats;
    of->stride = floats ? 13 : 27;
    for (uint32_t i = 0; i < 3 * MOST_POINTS * SC_PAIR_LANES; ++i) {
        unsigned char *at = b->bytes[side] + of->stride * (i / 3);
        float f = (float)b->points[i];
        if (floats)
            memcpy(at + i % 3 * sizeof f, &f, sizeof f);
        else
            memcpy(at + i % 3 * sizeof(double), b->points + i, sizeof(double));
    }
}

/* Puts two triangles into a lane. Returns 0 if they share more than a batch's pairs may. */
static int set_lane(batch *b, uint32_t lane, const two *t)
{
    uint32_t common = 0, repeats = 0;
    b->pairs[lane].a = 2 * lane;
    b->pairs[lane].b = 2 * lane + 1;
    for (uint32_t i = 0; i < 6; ++i) {
        uint32_t point = MOST_POINTS * lane + t->corners[i];
        b->triangle[6 * lane + i] = point;
        memcpy(b->points + 3 * point, t->points + 3 * t->corners[i], 3 * sizeof(double));
        repeats += t->corners[i] == t->corners[i / 3 * 3 + (i + 1) % 3];
    }
    for (uint32_t i = 0; i < 3; ++i)
        for (uint32_t k = 0; k < 3; ++k)
            if (t->corners[i] == t->corners[3 + k]) {
                ++common;
                b->lanes.shares = 1;
                b->lanes.shared[0][i] |= 1u << lane;
                b->lanes.shared[1][k] |= 1u << lane;
            }
    return common == 0 || (common == 1 && repeats == 0);
}

/* Compares what a verdict says of a lane; returns 1 if it left something open. */
static int check_lane(const batch *b, const sc_verdict *verdict, uint32_t lane, const two *t,
                      const char *which, uint64_t state)
{
    sc_triangle_pair pair;
    uint64_t fallbacks = 0;
    unsigned touch, cross, unsure = 0;
    for (int k = 0; k < 3; ++k) {
        pair.va[k] = t->corners[k];
        pair.vb[k] = t->corners[3 + k];
        pair.a[k] = t->points + 3 * pair.va[k];
        pair.b[k] = t->points + 3 * pair.vb[k];
    }
    touch = sc_primitives_edge_hits(&pair, 0, SC_PRIMITIVES_ALL_EDGES, &fallbacks);
    cross = sc_primitives_edge_hits(&pair, 1, SC_PRIMITIVES_ALL_EDGES, &fallbacks);
    for (uint32_t k = 0; k < 6; ++k) {
        uint32_t s = k / 3, from = k % 3, to = (from + 1) % 3, bit = SC_PAIR_LANES * k + lane;
        unsigned hits = b->lanes.proper ? cross : touch;
        unsigned meets = verdict->meets >> bit & 1u, open = verdict->unsure >> bit & 1u;
        if ((b->lanes.shared[s][from] | b->lanes.shared[s][to]) >> lane & 1u) continue;
        if (t->corners[3 * s + from] == t->corners[3 * s + to]) continue;
        unsure |= open;
        CHECK_MSG(!(meets && open), "%s: edge %u is both; started at %" PRIu64, which, k, state);
        if (meets)
            CHECK_MSG(hits >> k & 1u, "%s: edge %u does not meet; started at %" PRIu64, which, k,
                      state);
        else if (!open)
            CHECK_MSG(!(hits >> k & 1u), "%s: edge %u meets; started at %" PRIu64, which, k, state);
    }
    return (int)unsure;
}

static const char *const isa_name[] = {"", "base", "AVX2", "AVX-512"};

static void eight_pairs_at_once(void)
{
    uint32_t rounds = test_iterations(30000), left_open = 0, anywhere = 0;
    for (uint32_t round = 0; round < rounds; ++round) {
        two t[SC_PAIR_LANES];
        batch b;
        sc_verdict first, verdict;
        unsigned fine = 0;
        uint64_t state = test_random_state();
        int generic = round % 4 == 0, apart = round % 4 == 1; /* nothing shared */
        clear_batch(&b);
        b.lanes.proper = round % 8 > 3;
        for (uint32_t lane = 0; lane < SC_PAIR_LANES; ++lane) {
            memset(&t[lane], 0, sizeof t[lane]);
            if (generic) {
                points_anywhere(&t[lane]);
            } else {
                random_points(&t[lane]);
                random_corners(&t[lane]);
            }
            if (apart) {
                t[lane].count = 6;
                for (uint32_t k = 0; k < 6; ++k) t[lane].corners[k] = k;
            }
            fine |= (unsigned)set_lane(&b, lane, &t[lane]) << lane;
        }
        for (uint32_t isa = SC_ISA_BASE; isa <= (uint32_t)sc_isa_best(); ++isa) {
            sc_kernels_for(isa)->query->decide(&b.lanes, &verdict);
            if (isa == SC_ISA_BASE) first = verdict;
            CHECK_MSG(!memcmp(&first, &verdict, sizeof verdict),
                      "%s differs from base; started at %" PRIu64, isa_name[isa], state);
            if (!b.lanes.shares) { /* as if some were shared: edge by edge */
                b.lanes.shares = 1;
                sc_kernels_for(isa)->query->decide(&b.lanes, &verdict);
                b.lanes.shares = 0;
                CHECK_MSG(!memcmp(&first, &verdict, sizeof verdict),
                          "%s differs edge by edge; started at %" PRIu64, isa_name[isa], state);
            }
            for (uint32_t lane = 0; lane < SC_PAIR_LANES; ++lane) {
                int open;
                if (!(fine >> lane & 1u)) continue;
                open = check_lane(&b, &verdict, lane, &t[lane], isa_name[isa], state);
                if (!generic) continue;
                anywhere++;
                left_open += (uint32_t)open;
            }
        }
    }
    CHECK_MSG(left_open <= anywhere / 1000, "%u of %u pairs anywhere were left open", left_open,
              anywhere);
}

/* Along one axis or two, corners are at one of three places each, but not all of a triangle at one:
   some edges of both are in one plane across the axis, others in another, and no corner is in the
   other's plane. */
static void points_in_layers(two *t)
{
    uint32_t axes = 1 + test_random_below(2), axis = test_random_below(3);
    points_anywhere(t);
    for (; axes > 0; --axes, axis = (axis + 1) % 3) {
        double place[3];
        for (int i = 0; i < 3; ++i) place[i] = test_random_unit();
        for (uint32_t s = 0; s < 2; ++s) {
            double *corner = t->points + 9 * s + axis;
            do {
                for (int k = 0; k < 3; ++k) corner[3 * k] = place[test_random_below(3)];
            } while (corner[0] == corner[3] && corner[3] == corner[6]);
        }
    }
}

static void eight_pairs_in_layers(void)
{
    uint32_t rounds = test_iterations(20000), meetings = 0;
    for (uint32_t round = 0; round < rounds; ++round) {
        two t[SC_PAIR_LANES];
        batch b;
        uint64_t state = test_random_state();
        clear_batch(&b);
        b.lanes.proper = round % 2 != 0;
        for (uint32_t lane = 0; lane < SC_PAIR_LANES; ++lane) {
            points_in_layers(&t[lane]);
            set_lane(&b, lane, &t[lane]);
        }
        for (uint32_t isa = SC_ISA_BASE; isa <= (uint32_t)sc_isa_best(); ++isa) {
            sc_verdict verdict;
            sc_kernels_for(isa)->query->decide(&b.lanes, &verdict);
            meetings += verdict.meets != 0;
            for (uint32_t lane = 0; lane < SC_PAIR_LANES; ++lane)
                check_lane(&b, &verdict, lane, &t[lane], isa_name[isa], state);
        }
    }
    CHECK(meetings > rounds / 10);
}

/* Positions are read wherever they are, as floats, too. */
static void any_stride_and_type(void)
{
    for (uint32_t round = 0; round < test_iterations(2000); ++round) {
        batch b;
        sc_verdict first, verdict;
        clear_batch(&b);
        for (uint32_t lane = 0; lane < SC_PAIR_LANES; ++lane) {
            two t;
            memset(&t, 0, sizeof t);
            points_anywhere(&t);
            for (int i = 0; i < 18; ++i) t.points[i] = (double)(float)t.points[i];
            set_lane(&b, lane, &t);
        }
        sc_kernels_base.query->decide(&b.lanes, &first);
        for (unsigned floats = 0; floats < 4; ++floats) { /* of the first and of the second */
            for (int side = 0; side < 2; ++side) put_bytes(&b, side, (int)(floats >> side & 1u));
            for (uint32_t isa = SC_ISA_BASE; isa <= (uint32_t)sc_isa_best(); ++isa) {
                sc_kernels_for(isa)->query->decide(&b.lanes, &verdict);
                CHECK_MSG(!memcmp(&first, &verdict, sizeof verdict), "%s differs", isa_name[isa]);
            }
        }
    }
}

/* Pairs in a plane that are well apart, with boxes that overlap, are told so. */
static void apart_in_a_plane(void)
{
    static const double corner[6][2] = {{0, 0}, {4, 0}, {0, 4}, {4, 4}, {4, 1}, {1, 4}};
    for (int axis = 0; axis < 3; ++axis)
        for (int tilt = 0; tilt < 2; ++tilt) {
            two t;
            batch b;
            sc_verdict verdict;
            memset(&t, 0, sizeof t);
            clear_batch(&b);
            for (int i = 0; i < 6; ++i) {
                t.corners[i] = (uint32_t)i;
                t.points[3 * i + axis] = tilt ? 0.3 * corner[i][0] - 0.1 * corner[i][1] : 0.7;
                t.points[3 * i + (axis + 1) % 3] = corner[i][0];
                t.points[3 * i + (axis + 2) % 3] = corner[i][1];
            }
            for (uint32_t lane = 0; lane < SC_PAIR_LANES; ++lane) set_lane(&b, lane, &t);
            sc_kernels_base.query->decide(&b.lanes, &verdict);
            CHECK(verdict.meets == 0 && verdict.unsure == 0);
        }
}

/*
 * A triangle that lies on a line seems to have an area, so far is its computed normal off, and
 * another lies over it: not in its plane, though all corners of the other have sign 0 there. With
 * the products of two odd numbers a little above 2^26.5, less 1, each difference to -1 is half a
 * unit in the last place off: 0.59 of the bound of an area is reached.
 */
static void lines_that_seem_to_have_areas(void)
{
    double over[3][3] = {{-0x1p+56, -0x1p+54, 1}, {0x1p+56, -0x1p+54, 1}, {0, 0x1p+56, 1}};
    uint32_t wrong = 0, rounds = test_iterations(4000);
    uint64_t fallbacks = 0;
    double most = 0;
    for (uint32_t i = 0; i < rounds; ++i) {
        double line[3][3] = {{-1, -1, 0}, {0, 0, 0}, {0, 0, 0}}, times[2], way[2], left, right;
        sc_triangle_pair pair;
        for (int k = 0; k < 2; ++k) {
            times[k] = 94906267.0 + 2 * test_random_below(3000000);
            way[k] = 94906267.0 + 2 * test_random_below(3000000);
        }
        for (int k = 0; k < 4; ++k) /* exactly: the product has 54 bits */
            line[1 + k / 2][k % 2] = fma(times[k / 2], way[k % 2], -1);
        left = (line[1][0] + 1) * (line[2][1] + 1);
        right = (line[1][1] + 1) * (line[2][0] + 1);
        most = fmax(most, fabs(left - right) / (5 * 0x1p-53 * (left + right)));
        for (int k = 0; k < 3; ++k) {
            pair.a[k] = over[k];
            pair.b[k] = line[k];
            pair.va[k] = (uint32_t)k;
            pair.vb[k] = 3 + (uint32_t)k;
        }
        wrong += sc_primitives_edge_hits(&pair, 0, SC_PRIMITIVES_ALL_EDGES, &fallbacks) != 0;
    }
    CHECK_MSG(wrong == 0, "%" PRIu32 " of %" PRIu32 " meet", wrong, rounds);
    CHECK_MSG(rounds < 1000 || (most > 0.55 && most < 1), "%g of the bound", most);
}

SC_TEST_MAIN(SC_TEST(two_triangles), SC_TEST(eight_pairs_at_once), SC_TEST(eight_pairs_in_layers),
             SC_TEST(any_stride_and_type), SC_TEST(apart_in_a_plane),
             SC_TEST(lines_that_seem_to_have_areas))
