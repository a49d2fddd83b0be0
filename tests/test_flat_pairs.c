/*
 * Queries on meshes that lie in a plane, or nearly: fans, outlines, bands, tubes, and two leaf
 * clusters next to each other, which proofs for neighbors tell apart or do not; against the
 * oracle.
 *
 * SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "harness.h"
#include "inputs.h"
#include "pair_trial.h"
#include "soups.h"
#include "starcontour.h"

/* A fan of triangles round a point, flat across an axis, in a mesh so much larger that single
   precision tells little of it. It turns nearly once, or twice, from near a line of which a leaf
   cluster that is seen along the axis looks at the sides, is closed or ends anywhere, and turns
   back a little here and there. */
static void fans_in_a_plane(void)
{
    uint32_t rounds = test_iterations(400);
    for (uint32_t i = 0; i < rounds; ++i) {
        static const double lines[4][2] = {{1, 0.5}, {-0.5, 1}, {-1, -0.5}, {0.5, -1}};
        uint64_t state = test_random_state();
        uint32_t count = 4 + test_random_below(10), axis = test_random_below(3);
        uint32_t closed = test_random_below(4) == 0, line = test_random_below(4);
        double turns = count > 5 && test_random_below(4) == 0 ? 2 : 1;
        double size = exp2(-(double)test_random_below(24)), angle, sum = 0, place[2], step[16];
        soup s = soup_make(count + 5, count + 1);
        for (uint32_t c = 0; c < 2; ++c) place[c] = test_random_range(-1, 1);
        angle = atan2(lines[line][1], lines[line][0]);
        if (test_random_below(8) == 0) angle = test_random_range(-3, 3);
        for (uint32_t k = 0; k < count; ++k) {
            step[k] = test_random_range(0.3, 1);
            if (i % 4 == 3 && test_random_below(6) == 0)
                step[k] = -exp2(-(double)test_random_below(40));
            sum += step[k];
        }
        for (uint32_t k = 0; k < count + 5; ++k) {
            double far_away = k == count + 2 || k == count + 3 ? -1 : 1, *p = s.positions + 3 * k;
            double reach = k == 0 ? 0 : size * test_random_range(0.5, 1);
            double off = exp2(-4 - (double)test_random_below(40)) * test_random_range(-1, 1);
            p[axis] = 0.25;
            p[(axis + 1) % 3] = k > count + 1 ? far_away : place[0] + reach * cos(angle + off);
            p[(axis + 2) % 3] = k > count + 1 ? 1 - 1e-3 * k : place[1] + reach * sin(angle + off);
            if (k > 0 && k <= count) angle += turns * 6.283185307179586 * step[k - 1] / sum;
        }
        for (uint32_t k = 0; k <= count; ++k) {
            uint32_t *t = s.triangles + 3 * k;
            t[0] = k < count ? 0 : count + 2;
            t[1] = k < count ? k + 1 : count + 3;
            t[2] = k < count ? (closed && k + 1 == count ? 1 : k + 2) : count + 4;
        }
        trial_check_random_build("fan in a plane", state, &s, s.positions);
        soup_free(&s);
    }
}

/* A leaf cluster that lies flat, or nearly, across an axis: a fan, the rim of which goes in and
   out, and more triangles at the rim, some of which reach for points far along it or just touch
   there. The fan turns nearly once, or twice, and back a little here and there. A strip behind it
   makes the mesh large, so that single precision tells little of it. */
static void outlines_in_a_plane(void)
{
    enum { STRIP = 16 };
    uint32_t rounds = test_iterations(600);
    for (uint32_t i = 0; i < rounds; ++i) {
        uint64_t state = test_random_state();
        uint32_t count = 4 + test_random_below(8), ears = test_random_below(4);
        uint32_t closed = test_random_below(3) != 0, axis = test_random_below(3), k;
        uint32_t rim = count + !closed, tip = rim + 1, strip = tip + ears;
        double turns = count > 5 && test_random_below(5) == 0 ? 2 : 1;
        double size = 0.3 * exp2(-(double)test_random_below(i % 2 ? 3 : 22)), sum = 0, step[16];
        double angle = test_random_range(-3, 3), place[2], (*at)[3];
        soup s = soup_make(strip + STRIP + 2, count + ears + STRIP);
        at = (double(*)[3])s.positions;
        for (k = 0; k < 2; ++k) place[k] = test_random_range(-0.5, 0.5);
        for (k = 0; k < count; ++k) {
            step[k] = test_random_range(0.3, 1);
            if (i % 4 == 3 && test_random_below(8) == 0)
                step[k] = -exp2(-(double)test_random_below(40));
            sum += step[k];
        }
        for (k = 0; k <= rim; ++k) {
            double reach = k == 0 ? 0 : size * test_random_range(k % 2 ? 0.9 : 0.3, 1);
            double off = exp2(-4 - (double)test_random_below(40)) * test_random_range(-1, 1);
            at[k][(axis + 1) % 3] = place[0] + reach * cos(angle + off);
            at[k][(axis + 2) % 3] = place[1] + reach * sin(angle + off);
            if (k > 0 && k <= count) angle += turns * 6.283185307179586 * step[k - 1] / sum;
        }
        for (k = 0; k < ears; ++k) {
            uint32_t near = test_random_below(rim + 1), edge = 1 + test_random_below(count);
            double off = size * exp2(-(double)test_random_below(40)) * test_random_range(-1, 1);
            uint32_t *t = s.triangles + 3 * (count + k);
            t[0] = edge < rim ? edge + 1 : 1;
            t[1] = edge;
            t[2] = tip + k;
            for (uint32_t c = 1; c < 3; ++c) {
                double far = at[t[0]][(axis + c) % 3] + at[t[1]][(axis + c) % 3];
                double out = far - place[c - 1] + test_random_range(-0.2, 0.2) * size;
                if (test_random_below(2)) out = at[near][(axis + c) % 3] + off;
                at[tip + k][(axis + c) % 3] = out;
            }
        }
        for (k = 0; k < STRIP + 2; ++k) {
            at[strip + k][(axis + 1) % 3] = 2.0 * k / (STRIP + 1) - 1;
            at[strip + k][(axis + 2) % 3] = k % 2 ? 1 : 0.97;
        }
        for (k = 0; k < s.vertex_count; ++k) {
            double off = size * exp2(-(double)test_random_below(30)) * test_random_range(-1, 1);
            at[k][axis] = 0.25 + (i % 3 == 0 && k < strip ? off : 0);
        }
        for (k = 0; k < count; ++k) {
            uint32_t *t = s.triangles + 3 * k;
            t[0] = 0;
            t[1] = k + 1;
            t[2] = k + 1 < rim ? k + 2 : 1;
        }
        for (k = 0; k < STRIP; ++k) {
            uint32_t *t = s.triangles + 3 * (count + ears + k);
            t[0] = strip + k;
            t[1] = strip + k + 1 + k % 2;
            t[2] = strip + k + 2 - k % 2;
        }
        trial_check_random_build("outline in a plane", state, &s, s.positions);
        soup_free(&s);
    }
}

/* A band of triangles that lies flat, or nearly, across an axis, as two leaf clusters or three: it
   goes round, rather narrow or wide, until its end comes near its beginning, reaches over it, or
   just touches a point there. Its edges go in and out. A strip behind it makes the mesh large, so
   that single precision tells little of it. */
static void bands_in_a_plane(void)
{
    enum { STRIP = 16 };
    uint32_t rounds = test_iterations(800);
    for (uint32_t i = 0; i < rounds; ++i) {
        uint64_t state = test_random_state();
        uint32_t steps = 8 + test_random_below(6), axis = test_random_below(3), k;
        uint32_t strip = 2 * steps + 2;
        double size = 0.3 * exp2(-(double)test_random_below(i % 2 ? 3 : 22)), (*at)[3];
        double width = test_random_range(0.1, 0.45), turns = test_random_range(0.4, 1.3);
        double angle = test_random_range(-3, 3), place[2], inward = test_random_range(-0.1, 0.3);
        soup s = soup_make(strip + STRIP + 2, 2 * steps + STRIP);
        at = (double(*)[3])s.positions;
        for (k = 0; k < 2; ++k) place[k] = test_random_range(-0.5, 0.5);
        for (k = 0; k < strip; ++k) {
            double along = (double)(k / 2) / steps, reach = k % 2 ? 1 : 1 - 2 * width;
            double off = exp2(-3 - (double)test_random_below(i % 4 ? 6 : 40));
            reach = size * (reach * (1 - inward * along) + off * test_random_range(-1, 1));
            at[k][(axis + 1) % 3] = place[0] + reach * cos(angle + along * turns * 6.283185307);
            at[k][(axis + 2) % 3] = place[1] + reach * sin(angle + along * turns * 6.283185307);
        }
        if (test_random_below(3) != 0) { /* one of the last points to one of the first, or near */
            uint32_t last = strip - 1 - test_random_below(2), near = test_random_below(6);
            for (uint32_t c = 1; c < 3; ++c)
                at[last][(axis + c) % 3] =
                    at[near][(axis + c) % 3] +
                    size * exp2(-(double)test_random_below(40)) * test_random_range(-1, 1);
        }
        for (k = 0; k < STRIP + 2; ++k) {
            at[strip + k][(axis + 1) % 3] = 2.0 * k / (STRIP + 1) - 1;
            at[strip + k][(axis + 2) % 3] = k % 2 ? 1 : 0.97;
        }
        for (k = 0; k < s.vertex_count; ++k) {
            double off = size * exp2(-(double)test_random_below(30)) * test_random_range(-1, 1);
            at[k][axis] = 0.25 + (i % 3 == 0 && k < strip ? off / 8 : 0);
        }
        for (k = 0; k < 2 * steps + STRIP; ++k) {
            uint32_t *t = s.triangles + 3 * k, p = k < 2 * steps ? k : strip + k - 2 * steps;
            t[0] = p;
            t[1] = p + 1 + (p - (k < 2 * steps ? 0 : strip)) % 2;
            t[2] = p + 2 - (p - (k < 2 * steps ? 0 : strip)) % 2;
        }
        trial_check_random_build("band in a plane", state, &s, s.positions);
        soup_free(&s);
    }
}

/* A mesh whose triangles are in leaf clusters in this order, in the pose it was made in; frees
   both. */
static void check_in_order(const char *name, uint64_t state, soup *s, uint32_t *order)
{
    input_choices own = input_choose(s, SC_WELD_NONE, SC_PARTITION_FAST);
    own.options.partition = SC_PARTITION_ORDER;
    own.options.order = order;
    trial_check_chosen(name, state, s, s->positions, SC_WELD_NONE, SC_PARTITION_ORDER, &own);
    input_free_choices(&own);
    free(order);
    soup_free(s);
}

/* A tube of three leaf clusters that go round it, straight or bent, at any angle to the axes, with
   loops that go up and down. In places it is turned back, so that one band lies over the one
   before, or the loops are wound twice; it is pressed flat; a point is drawn near one of any other
   loop, or across an edge there, or of its own triangle, or just touches; or a triangle is turned.
   A strip behind it makes the mesh large, so that single precision tells little of it. */
static void tubes(void)
{
    enum { BANDS = 3, LOOPS = BANDS + 1 };
    uint32_t rounds = test_iterations(1500);
    for (uint32_t i = 0; i < rounds; ++i) {
        uint64_t state = test_random_state();
        uint32_t sides = 3 + test_random_below(6), strip = LOOPS * sides, k, c;
        uint32_t per_band = 2 * sides, count = (BANDS + 1) * per_band,
                 trouble = test_random_below(12);
        double size = 0.2 * exp2(-(double)test_random_below(i % 2 ? 3 : 22)), (*at)[3];
        double turns = trouble == 1 && sides > 5 ? 2 : 1, bend = test_random_range(0, 0.4);
        double rough = exp2(-1 - (double)test_random_below(8)), flat = 1, height = 0;
        double middle[3], turn[3][3], length = 0, tall = test_random_range(0.3, 2);
        double tilt = i % 3 ? 0 : test_random_range(-2, 2); /* loops are above and below others */
        soup s = soup_make(strip + per_band + 2, count);
        uint32_t *order = (uint32_t *)test_allocate(count * sizeof(uint32_t));
        at = (double(*)[3])s.positions;
        if (trouble == 2) flat = exp2(-(double)test_random_below(30));
        for (c = 0; c < 3; ++c) {
            middle[c] = test_random_range(-0.5, 0.5);
            turn[0][c] = test_random_range(-1, 1);
            turn[1][c] = test_random_range(-1, 1);
        }
        for (c = 0; c < 3; ++c) length += turn[0][c] * turn[0][c];
        for (c = 0; c < 3; ++c) /* at right angles to the first, if not as long */
            turn[2][c] = turn[0][(c + 1) % 3] * turn[1][(c + 2) % 3] -
                         turn[0][(c + 2) % 3] * turn[1][(c + 1) % 3];
        for (c = 0; c < 3; ++c)
            turn[1][c] = (turn[2][(c + 1) % 3] * turn[0][(c + 2) % 3] -
                          turn[2][(c + 2) % 3] * turn[0][(c + 1) % 3]) /
                         length;
        for (uint32_t loop = 0; loop < LOOPS; ++loop) {
            double wide = trouble == 3 ? test_random_range(0.6, 1) : 1;
            double start = test_random_range(-0.3, 0.3);
            for (k = 0; k < sides; ++k) {
                double angle =
                    (k + start + rough * test_random_range(-1, 1)) * turns * 6.283185307 / sides;
                double reach = wide * (1 + rough * test_random_range(-1, 1));
                double up =
                    height + tall * rough * test_random_range(-1, 1) + tilt * reach * cos(angle);
                double p[3] = {reach * cos(angle) + bend * height * height,
                               flat * reach * sin(angle), up};
                for (c = 0; c < 3; ++c)
                    at[loop * sides + k][c] =
                        middle[c] +
                        size * (turn[0][c] * p[0] + turn[1][c] * p[1] + turn[2][c] * p[2]);
            }
            height += trouble == 3 && test_random_below(2) ? -0.7 * tall : tall;
        }
        for (k = trouble < 4 || trouble > 7 ? 0 : 1 + test_random_below(2); k > 0; --k) {
            uint32_t p = test_random_below(strip), q = test_random_below(strip);
            uint32_t r = q / sides * sides + (q + 1) % sides;
            double share = trouble < 6 ? 0 : test_random_below(3) / 2.0;
            double off = size * exp2(-(double)test_random_below(50)) * test_random_range(-1, 1);
            for (c = 0; c < 3; ++c)
                at[p][c] = at[q][c] + share * (at[r][c] - at[q][c]) + (trouble == 7 ? 0 : off);
        }
        for (k = 0; k < per_band + 2; ++k)
            for (c = 0; c < 3; ++c)
                at[strip + k][c] = c == 0   ? 2.0 * k / (per_band + 1) - 1
                                   : c == 1 ? (k % 2 ? 1 : 0.97)
                                            : 0.9;
        for (k = 0; k < count; ++k) {
            uint32_t *t = s.triangles + 3 * k, band = k / per_band, side = k % per_band / 2;
            uint32_t p = band * sides + side, q = band * sides + (side + 1) % sides;
            uint32_t is_second = k % 2, swap = trouble == 0 && test_random_below(20) == 0;
            if (band == BANDS) {
                p = strip + k % per_band;
                t[0] = p, t[1] = p + 1 + is_second, t[2] = p + 2 - is_second;
            } else {
                t[0] = is_second ? q : p;
                t[1] = is_second ? q + sides : q;
                t[2] = p + sides;
            }
            if (swap) {
                c = t[1];
                t[1] = t[2];
                t[2] = c;
            }
            order[k] = k;
        }
        for (k = trouble < 8 ? 0 : 1 + test_random_below(2); k > 0; --k) {
            uint32_t *t = s.triangles + 3 * test_random_below(count - per_band);
            uint32_t corner = test_random_below(3);
            double share = test_random_range(0.1, 0.9);
            double *p = at[t[corner]], *q = at[t[(corner + 1) % 3]], *o = at[t[(corner + 2) % 3]];
            double off = exp2(-(double)test_random_below(50)) * test_random_range(-1, 1);
            for (c = 0; c < 3; ++c) {
                double to = q[c] + share * (o[c] - q[c]);
                p[c] = to + off * (to - p[c]);
            }
        }
        check_in_order("tube", state, &s, order);
    }
}

/* One leaf cluster round a tube that is no band and meets itself: a flap at the end of the tube
   that curls back into it, seen from the axis always from outside; a triangle whose plane the axis
   sees from outside at two corners only; and a collar in a plane right across the axis, of which
   rounding does not tell from where it is seen. */
static void tubes_that_are_no_bands(void)
{
    enum { POINTS = 10, TRIANGLES = 12 };
    static const struct {
        uint32_t points, triangles;
        int8_t at[3 * POINTS];
        uint8_t corners[3 * TRIANGLES];
    } bands[] = {
        {10,
         10,
         {7, 6,  -1, -11, 3,  0,  3,   -10, 0,  8,   8,  11, -9, 3, 10,
          2, -8, 11, 0,   12, 18, -15, -1,  18, -11, -3, 5,  -7, 1, 4},
         {0, 1, 4, 4, 3, 0, 2, 5, 1, 1, 5, 4, 2, 0, 3,
          3, 5, 2, 6, 3, 4, 4, 7, 6, 8, 7, 4, 8, 4, 9}},
        {6,
         6,
         {13, 1, 1, -9, 28, 8, -21, -4, -2, 13, -3, 25, -18, 21, 19, -6, -15, 7},
         {1, 3, 0, 4, 3, 1, 1, 2, 5, 5, 4, 1, 3, 2, 0, 3, 5, 2}},
        {9,
         12,
         {-73, -15, 3,  -1,  -37, 0, 50, -20, -51, -65, 9,  19, 58, -30,
          16,  15,  11, -24, -55, 5, 20, 35,  -31, 29,  20, 26, -49},
         {1, 3, 0, 1, 4, 3, 2, 4, 1, 5, 4, 2, 2, 0, 5, 3, 5, 0,
          6, 3, 4, 7, 6, 4, 5, 8, 4, 4, 8, 7, 6, 5, 3, 5, 6, 8}},
    };
    for (size_t i = 0; i < sizeof(bands) / sizeof(bands[0]); ++i) {
        uint32_t points = bands[i].points, count = bands[i].triangles, k;
        soup s = soup_make(points, count);
        uint32_t *order = (uint32_t *)test_allocate(count * sizeof(uint32_t));
        for (k = 0; k < 3 * points; ++k) s.positions[k] = bands[i].at[k];
        for (k = 0; k < 3 * count; ++k) s.triangles[k] = bands[i].corners[k];
        for (k = 0; k < count; ++k) order[k] = k;
        check_in_order("tube that is no band", test_random_state(), &s, order);
    }
}

/* Strips in planes across the axes that have one point in common, each a leaf cluster of its own:
   so many of them meet there, up to the most of which each two are a node of the test tree, and
   more. */
static void strips_from_one_point(void)
{
    enum { STRIP = 14 };
    static const uint32_t counts[] = {24, 25, 40, 48, 49};
    for (size_t i = 0; i < sizeof(counts) / sizeof(counts[0]); ++i) {
        uint64_t state = test_random_state();
        uint32_t strips = counts[i], count = strips * STRIP, k;
        soup s = soup_make(1 + strips * (STRIP + 1), count);
        uint32_t *order = (uint32_t *)test_allocate(count * sizeof(uint32_t));
        memset(s.positions, 0, 3 * sizeof(double));
        for (uint32_t v = 1; v < s.vertex_count; ++v) {
            uint32_t strip = (v - 1) / (STRIP + 1), place = (v - 1) % (STRIP + 1);
            double *at = s.positions + 3 * (size_t)v;
            at[strip % 3] = place < 2 ? 0 : test_random_range(-0.1, 0.1);
            at[(strip + 1) % 3] = place / 2 + (place == 1) + test_random_below(2);
            at[(strip + 2) % 3] = place < 2 ? 1 - (double)place : 1 - 2.0 * (place % 2);
            if (strip / 3 % 2) at[(strip + 1) % 3] *= -1;
        }
        for (k = 0; k < count; ++k) {
            uint32_t *t = s.triangles + 3 * k, first = 1 + k / STRIP * (STRIP + 1) + k % STRIP;
            t[0] = k % STRIP ? first - 1 : 0;
            t[1] = first;
            t[2] = first + 1;
            order[k] = k;
        }
        check_in_order("strips from one point", state, &s, order);
    }
}

/* A tube turned inside out at its middle, so that both halves lie on each other. */
static void tubes_turned_inside_out(void)
{
    for (uint32_t sides = 3; sides <= 8; ++sides) {
        uint64_t state = test_random_state();
        soup s = soup_make(5 * sides, 8 * sides);
        uint32_t *order = (uint32_t *)test_allocate(s.triangle_count * sizeof(uint32_t));
        for (uint32_t v = 0; v < s.vertex_count; ++v) {
            double angle = v % sides * 6.283185307 / sides;
            s.positions[3 * v] = cos(angle);
            s.positions[3 * v + 1] = sin(angle);
            s.positions[3 * v + 2] = fabs(v / sides - 2.0);
        }
        for (uint32_t k = 0; k < s.triangle_count; ++k) {
            uint32_t *t = s.triangles + 3 * k, loop = k / (2 * sides) * sides;
            uint32_t p = loop + k / 2 % sides, q = loop + (k / 2 + 1) % sides;
            t[0] = k % 2 ? q : p;
            t[1] = k % 2 ? q + sides : q;
            t[2] = p + sides;
            order[k] = k;
        }
        check_in_order("tube turned inside out", state, &s, order);
    }
}

/* Two bands round an axis on one side of a loop that they share, one in the other or through it. */
static void sleeves(void)
{
    uint32_t rounds = test_iterations(100);
    for (uint32_t i = 0; i < rounds; ++i) {
        uint64_t state = test_random_state();
        uint32_t sides = 5 + test_random_below(4), count = 4 * sides, k;
        soup s = soup_make(3 * sides, count);
        uint32_t *order = (uint32_t *)test_allocate(count * sizeof(uint32_t));
        for (uint32_t loop = 0; loop < 3; ++loop) {
            double wide = loop == 0 ? 1 : test_random_range(0.7, 1.4);
            double height = loop == 0 ? 0 : test_random_range(0.3, 1.5);
            for (k = 0; k < sides; ++k) {
                double *at = s.positions + 3 * (loop * sides + k);
                double angle = (k + test_random_range(-0.1, 0.1)) * 6.283185307 / sides;
                double reach = wide * test_random_range(0.9, 1.1);
                at[0] = reach * cos(angle);
                at[1] = reach * sin(angle);
                at[2] = height + test_random_range(-0.1, 0.1);
            }
        }
        for (k = 0; k < count; ++k) {
            uint32_t *t = s.triangles + 3 * k, side = k % (2 * sides) / 2;
            uint32_t next = (side + 1) % sides, above = (1 + k / (2 * sides)) * sides;
            t[0] = k % 2 ? next : side;
            t[1] = k % 2 ? above + next : next;
            t[2] = above + side;
            order[k] = k;
        }
        check_in_order("sleeves", state, &s, order);
    }
}

/* Points and triangles in a plane. Triangles are counterclockwise where they are not meant to be
   folded. */
typedef struct flat_mesh {
    double at[96][2];
    uint32_t corner[64][3], points, triangles;
} flat_mesh;

static void flat_add(flat_mesh *m, uint32_t a, uint32_t b, uint32_t c)
{
    uint32_t *t = m->corner[m->triangles++];
    t[0] = a;
    t[1] = b;
    t[2] = c;
}

/* Puts a point at a share of the way from a to b, and off that line to the right by a part of its
   length. */
static void flat_put_beside(flat_mesh *m, uint32_t a, uint32_t b, double share, double off,
                            uint32_t point)
{
    double x = m->at[b][0] - m->at[a][0], y = m->at[b][1] - m->at[a][1];
    double along = m->at[a][0] + share * x + off * y;
    m->at[point][1] = m->at[a][1] + share * y - off * x;
    m->at[point][0] = along;
}

/* A band of triangles that goes round, by so many turns; its edges go in and out. */
static void flat_make_band(flat_mesh *m, uint32_t triangles, double turns)
{
    double width = test_random_range(0.1, 0.4), rough = test_random_range(0, 0.1);
    double start = test_random_range(-3, 3), inward = test_random_range(-0.1, 0.2);
    m->points = triangles + 2;
    for (uint32_t k = 0; k < m->points; ++k) {
        double along = (double)k / (triangles + 1), angle = start + along * turns * 6.283185307;
        double reach = (k % 2 ? 1 : 1 - 2 * width) * (1 - inward * along);
        reach += rough * test_random_range(-1, 1);
        m->at[k][0] = reach * cos(angle);
        m->at[k][1] = reach * sin(angle);
        if (k >= 2) flat_add(m, k - 2, k - 1 + k % 2, k - k % 2);
    }
}

/* A fan that goes round twice, first near its middle, with so many points there, then farther out:
   its rim crosses itself once. */
static void flat_make_fan(flat_mesh *m, uint32_t rim, uint32_t inner)
{
    double weight[32], sum[2] = {0, 0}, angle = test_random_range(-3, 3);
    double over = test_random_range(0.1, 0.8), near = test_random_range(0.3, 0.7);
    double rough = test_random_range(0, 0.05);
    for (uint32_t k = 0; k < rim; ++k) sum[k > inner] += weight[k] = test_random_range(0.7, 1);
    m->at[0][0] = m->at[0][1] = 0;
    m->points = rim + 1;
    for (uint32_t k = 0; k < rim; ++k) { /* the edge to point k + 1, and then that */
        double reach = (k < inner ? near : 1) * (1 + rough * test_random_range(-1, 1));
        angle += weight[k] * (6.283185307 + (k > inner ? -over : over)) / sum[k > inner];
        m->at[k + 1][0] = reach * cos(angle);
        m->at[k + 1][1] = reach * sin(angle);
        flat_add(m, 0, k + 1, (k + 1) % rim + 1);
    }
}

/* Cuts a triangle in three, which changes no contour. */
static void flat_cut(flat_mesh *m, uint32_t triangle)
{
    uint32_t *t = m->corner[triangle], a = t[0], b = t[1], c = t[2], p = m->points++;
    double u = test_random_range(0.2, 0.4), v = test_random_range(0.2, 0.4);
    for (uint32_t k = 0; k < 2; ++k)
        m->at[p][k] =
            m->at[a][k] + u * (m->at[b][k] - m->at[a][k]) + v * (m->at[c][k] - m->at[a][k]);
    t[2] = p;
    flat_add(m, b, c, p);
    flat_add(m, c, a, p);
}

/* A triangle that pokes into another one from outside, or just touches it, across the side from
   point a to b. */
static void flat_poke(flat_mesh *m, uint32_t a, uint32_t b)
{
    uint32_t p = m->points, turn = test_random_below(3);
    double depth = exp2(-2 - (double)test_random_below(40));
    m->points += 3;
    flat_put_beside(m, a, b, test_random_range(0.3, 0.7), -depth, p);
    flat_put_beside(m, a, b, test_random_range(0.3, 0.7), 0.4, p + 1);
    flat_put_beside(m, p, p + 1, 1, -0.3, p + 2);
    flat_add(m, p + turn, p + (turn + 1) % 3, p + (turn + 2) % 3);
}

/* Two fans that touch in point 0, from hubs on either side of a line through it: the first has the
   given number of triangles. A rim point of each is on that line or all but on it, to the same side
   of point 0, and the line is across the way from the middle of one's points to that of the
   other's, sixteen times with the last one filling up. */
static void flat_make_touching(flat_mesh *m, uint32_t first, uint32_t second)
{
    double tilt = test_random_below(2) ? test_random_range(-3, 3) : 0, sum[2] = {0, 0};
    m->at[0][0] = m->at[0][1] = 0;
    m->points = 1;
    for (uint32_t s = 0; s < 2; ++s) {
        uint32_t rim = (s ? second : first) + 1, own = test_random_below(rim), hub = m->points++;
        uint32_t on = own + 1 < rim ? own + 1 : own - 1, newest = 0, last = hub;
        double across = s ? -1 : 1, reach = test_random_range(0.5, 0.7);
        m->at[hub][0] = across * reach;
        m->at[hub][1] = 0;
        for (uint32_t k = 0; k < rim; ++k, last = newest) {
            double angle = 6.283185307 * ((double)k - own) / (rim + 1);
            newest = k == own ? 0 : m->points++;
            if (k == on) {
                double off = exp2(-(double)test_random_below(45)) * test_random_range(-0.2, 1);
                m->at[newest][0] = test_random_below(4) ? across * off : 0;
                m->at[newest][1] = (on > own ? -1 : 1) * test_random_range(0.3, 0.8);
            } else if (k != own) {
                m->at[newest][0] = across * reach * (1 - cos(angle));
                m->at[newest][1] = -reach * sin(angle);
            }
            sum[s] += (k + 1 == rim ? 16 - rim : 1) * m->at[newest][1];
            if (k) flat_add(m, hub, s ? newest : last, s ? last : newest);
        }
    }
    if (test_random_below(4)) m->at[1][1] = sum[1] - sum[0];
    for (uint32_t k = 0; k < m->points; ++k) {
        double x = m->at[k][0], y = m->at[k][1];
        m->at[k][0] = (x * cos(tilt) - y * sin(tilt)) / 4;
        m->at[k][1] = (x * sin(tilt) + y * cos(tilt)) / 4;
    }
}

/* Checks such a mesh as two leaf clusters, the first of so many triangles or, if that is 0, any
   number, across an axis, or nearly; a triangle far away makes the whole large, so that single
   precision tells little of it. */
static void check_flat(uint64_t state, const flat_mesh *m, uint32_t count, int is_level)
{
    soup s = soup_make(m->points + 3, m->triangles + 1);
    double(*at)[3] = (double(*)[3])s.positions, place[2];
    double size = 0.3 * exp2(-(double)test_random_below(test_random_below(2) ? 3 : 20));
    uint32_t axis = test_random_below(3), least = m->triangles > 16 ? m->triangles - 16 : 1;
    uint32_t most = m->triangles > 16 ? 16 : m->triangles - 1;
    uint32_t first, order[64], name[96], k;
    sc_tree_node tree[5] = {{1, 2, 0, 0},
                            {3, 4, 0, 0},
                            {SC_NONE, SC_NONE, 0, 1},
                            {SC_NONE, SC_NONE, 0, 0},
                            {SC_NONE, SC_NONE, 0, 0}};
    input_choices own;
    /* the second often has few */
    if (test_random_below(2) && most - least > 2) least = most - 2;
    first = count ? count : least + test_random_below(most - least + 1);
    for (k = 0; k < 2; ++k) place[k] = test_random_range(-0.5, 0.5);
    for (k = 0; k < m->points; ++k) { /* contours begin anywhere */
        uint32_t other = test_random_below(k + 1);
        name[k] = name[other];
        name[other] = k;
    }
    for (k = 0; k < m->points + 3; ++k) {
        static const double far[3][2] = {{-1, 0.97}, {1, 0.97}, {0.3, 1}};
        double *x = at[k < m->points ? name[k] : k];
        for (uint32_t c = 0; c < 2; ++c)
            x[(axis + 1 + c) % 3] =
                k < m->points ? place[c] + size * m->at[k][c] : far[k - m->points][c];
        x[axis] = 0.25;
        if (!is_level && k < m->points)
            x[axis] += size / 8 * exp2(-(double)test_random_below(30)) * test_random_range(-1, 1);
    }
    for (k = 0; k < 3 * m->triangles; ++k) s.triangles[k] = name[m->corner[k / 3][k % 3]];
    for (k = 0; k < 3; ++k) s.triangles[3 * m->triangles + k] = m->points + k;
    tree[3].count = tree[4].first = first;
    tree[4].count = m->triangles - first;
    tree[2].first = m->triangles;
    own = input_choose(&s, SC_WELD_NONE, SC_PARTITION_FAST);
    for (k = 0; k <= m->triangles; ++k) order[k] = k;
    own.options.partition = SC_PARTITION_TREE;
    own.options.order = order;
    own.options.tree = tree;
    own.options.tree_count = 5;
    own.partition_name = "two clusters";
    trial_check_chosen("two clusters in a plane", state, &s, s.positions, SC_WELD_NONE,
                       SC_PARTITION_TREE, &own);
    soup_free(&s);
}

/* Two leaf clusters in a plane whose contour tells, or all but tells, that they have nothing in
   common but what they share: bands of which the last point is near one of the first edges; fans
   that go round twice, mostly so that the edges of the rim that cross are few apart or as far apart
   as can be; contours that are simple though there is a fold inside; and contours in two pieces.
   Contours of sixteen or seventeen points are those at the end of which sixteen at a time are most
   easily mistaken. */
static void two_clusters_in_a_plane(void)
{
    uint32_t rounds = test_iterations(4000);
    for (uint32_t i = 0; i < rounds; ++i) {
        uint64_t state = test_random_state();
        uint32_t kind = i % 8 < 3 ? 0 : i % 8 < 5 ? 3 : i % 4, cuts = test_random_below(9);
        flat_mesh m;
        m.points = m.triangles = 0;
        if (kind == 0) {
            uint32_t count = i % 4 ? 14 + i / 8 % 2 : 8 + test_random_below(12),
                     near = test_random_below(3);
            double off = exp2(-(double)test_random_below(45)) * test_random_range(-1, 1);
            if (i % 4) cuts = 0;
            flat_make_band(&m, count, test_random_range(0.7, 1));
            flat_put_beside(&m, near, near + (near == 0 ? 1 : 2), test_random_range(0, 1),
                            test_random_below(8) ? off : 0, count + 1);
        } else if (kind == 1) {
            uint32_t rim = test_random_below(2) ? 16 : 10 + test_random_below(8);
            uint32_t inner = i % 16 < 8 ? 2 : rim / 2;
            flat_make_fan(&m, rim, test_random_below(4) ? inner : 2 + test_random_below(rim - 5));
        } else {
            flat_make_band(&m, 2 + test_random_below(kind == 3 ? 6 : 12), 0.4);
        }
        if (kind == 3) { /* across an edge of the contour */
            uint32_t k = test_random_below(m.triangles), odd = k % 2;
            flat_poke(&m, odd ? k : k + 2, odd ? k + 2 : k);
        }
        while (cuts-- > 0 && m.triangles <= 30) flat_cut(&m, test_random_below(m.triangles));
        if (kind == 2) { /* the point of the last cut, out of its triangle */
            const uint32_t *t;
            flat_cut(&m, test_random_below(m.triangles));
            t = m.corner[m.triangles - 1];
            flat_put_beside(&m, t[0], t[1], 0.5, test_random_range(0.05, 0.3), t[2]);
        }
        check_flat(state, &m, 0, i / 8 % 3 != 0);
    }
}

/* Two leaf clusters in a plane that are a band which goes round until a corner of its end comes to
   one of its beginning, a little before it or past it. From there edges lead away on both sides,
   some in a straight row with one another. */
static void two_clusters_in_a_row(void)
{
    uint32_t rounds = test_iterations(4000);
    for (uint32_t i = 0; i < rounds; ++i) {
        uint64_t state = test_random_state();
        uint32_t count = 12 + test_random_below(4), from = count % 2, to = 1 - from;
        double tiny = exp2(-(double)test_random_range(4, i % 8 ? 26 : 45)), away = to ? 1 : -1;
        double gap = tiny * test_random_range(-1, 0.5), off = tiny * test_random_range(-1, 1);
        flat_mesh m;
        m.points = m.triangles = 0;
        flat_make_band(&m, count, test_random_range(0.7, 0.95));
        flat_put_beside(&m, from, to, 1 + gap, i % 3 ? off : 0, count + 1);
        flat_put_beside(&m, from, to, 1 + test_random_range(0, 0.3),
                        away * test_random_range(0.2, 0.8), count);
        flat_put_beside(&m, from, to, 1 + test_random_range(0.3, 1),
                        i % 2 ? 0 : away * test_random_range(0, 0.2), count - 1);
        check_flat(state, &m, 0, i / 8 % 3 != 0);
    }
}

/* Two leaf clusters in a plane that touch in a point, and all but touch or meet beside it. */
static void two_clusters_at_a_point(void)
{
    uint32_t rounds = test_iterations(3000);
    for (uint32_t i = 0; i < rounds; ++i) {
        uint64_t state = test_random_state();
        uint32_t first = 1 + test_random_below(13);
        flat_mesh m;
        m.triangles = 0;
        flat_make_touching(&m, first, 1 + test_random_below(13));
        check_flat(state, &m, first, i % 3 != 0);
    }
}

/* In every other frame one vertex goes to the other side of the middle, vertex 4. */
static void fold_flat(const soup *s, double *pose, uint32_t frame, uint32_t frames)
{
    double *p = pose + 3 * (size_t)(frame / 2);
    (void)s;
    (void)frames;
    for (int k = 0; k < 3 && frame % 2; ++k) p[k] = 1.75 * pose[3 * 4 + k] - 0.75 * p[k];
}

/* A fan that lies flat, and the same folded over itself in its plane; alone, and so small beside a
   triangle far away that single precision tells nothing of it. */
static void fans_that_fold_flat(void)
{
    for (int far_away = 0; far_away < 2; ++far_away) {
        soup s = soup_cloth(2, 2);
        if (far_away) {
            soup near = s, away = soup_cloth(1, 1);
            for (uint32_t i = 0; i < 3 * away.vertex_count; ++i) away.positions[i] += 1e9;
            s = soup_join(&near, &away);
            soup_free(&near);
            soup_free(&away);
        }
        trial_check_motion("fan", &s, 2 * s.vertex_count, fold_flat);
        soup_free(&s);
    }
}

SC_TEST_MAIN(SC_TEST(fans_in_a_plane), SC_TEST(outlines_in_a_plane), SC_TEST(bands_in_a_plane),
             SC_TEST(tubes), SC_TEST(tubes_that_are_no_bands), SC_TEST(sleeves),
             SC_TEST(tubes_turned_inside_out), SC_TEST(strips_from_one_point),
             SC_TEST(two_clusters_in_a_plane), SC_TEST(two_clusters_in_a_row),
             SC_TEST(two_clusters_at_a_point), SC_TEST(fans_that_fold_flat))
