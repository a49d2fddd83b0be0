/*
 * Sixteen floats and eight doubles at a time: all forms give the bits of the plain one, on random
 * numbers, zeros of both signs, infinities and NaN (not a number).
 *
 * SPDX-License-Identifier: MIT
 */
#include <float.h>
#include <math.h>
#include <string.h>

#include "simd/isa.h"
#include "harness.h"
#include "lanes_trial_types.h"

/* Of any kind: small numbers, so that some are the same; or large and small ones. */
static double number(int plain)
{
    static const double special[8] = {0.0,
                                      -0.0,
                                      HUGE_VAL,
                                      -HUGE_VAL,
                                      (double)FLT_MIN,
                                      -(double)FLT_MIN,
                                      (double)FLT_MAX,
                                      -(double)FLT_MAX};
    uint32_t kind = test_random_below(8);
    if (!plain && kind == 0) return special[test_random_below(8)];
    if (!plain && kind == 1) return (double)NAN;
    if (kind < 4) return (double)test_random_below(7) - 3;
    return test_random_range(-1, 1) * (kind == 7 ? 1e-30 : 1);
}

static void draw(lanes_input *in)
{
    uint32_t i, k, positive = test_random_below(40);
    for (i = 0; i < 16; i++) {
        in->a[i] = (float)number(0);
        in->b[i] = test_random_below(4) ? (float)number(0) : in->a[i];
        for (k = 0; k < 16; k++) in->row[k][i] = (float)-test_random_range(1e-30, 1);
    }
    for (i = 0; i < positive; i++)
        in->row[test_random_below(16)][test_random_below(16)] = (float)test_random_below(2);
    for (i = 0; i < 8; i++) {
        in->c[i] = number(0);
        in->d[i] = test_random_below(4) ? number(0) : in->c[i];
    }
    for (i = 0; i < 64; i++) in->plain[i] = (float)number(1);
    for (i = 0; i < 48; i++) in->number[i] = (uint8_t)test_random_below(16);
    for (i = 0; i < 16; i++) in->through[i] = (uint8_t)test_random_below(16);
    for (i = 0; i < 48; i++) in->other[i] = (uint8_t)test_random_below(16);
    in->split = test_random_below(17);
    for (i = 0; i < 4; i++) in->first[i] = test_random_below(1000000);
    for (i = 0; i < 20; i++) in->exact[i] = number(1);
    for (i = 0; i < 32; i++) in->names[i] = test_random_below(24) * 0x01010000u + 7;
    for (i = 0; i < 16; i++) in->words[i] = (uint16_t)test_random();
    for (i = 0; i < 16; i++) in->apart[i] = in->names[0] - 16 + 3 * i + test_random_below(3);
    if (test_random_below(4) == 0) in->apart[test_random_below(16)] += 0x80000000u;
    in->mask = test_random_below(0x10000);
    for (i = 0; i < 12; i++) in->bits[i] = (unsigned)test_random();
    for (k = 0; k < 4; k++)
        for (i = 0; i < 16; i++)
            in->cell[k][i] = (uint8_t)(test_random_below(4) ? 100 + test_random_below(8)
                                                            : 1 + test_random_below(254));
    if (test_random_below(4) == 0) /* all below, or none: as in most boxes */
        for (i = 0; i < 16; i++) in->a[i] = in->b[i] = 1;
}

static void all_forms_agree(void)
{
    enum { TRIALS = 20000 };
    lanes_input in;
    uint32_t trial;
    memset(&in, 0, sizeof in);
    for (trial = 0; trial < TRIALS && !test_failures(); trial++) {
        lanes_outcome plain, other;
        draw(&in);
        memset(&plain, 0, sizeof plain);
        memset(&other, 0, sizeof other);
        lanes_try_plain(&in, &plain);
        lanes_try_vectors(&in, &other);
        CHECK_MSG(!memcmp(&plain, &other, sizeof plain), "vector types, trial %u", trial);
        memset(&other, 0, sizeof other);
        lanes_try_base(&in, &other);
        CHECK_MSG(!memcmp(&plain, &other, sizeof plain), "base, trial %u", trial);
        if (sc_isa_best() >= SC_ISA_AVX2) {
            memset(&other, 0, sizeof other);
            lanes_try_avx2(&in, &other);
            CHECK_MSG(!memcmp(&plain, &other, sizeof plain), "AVX2, trial %u", trial);
        }
        if (sc_isa_best() >= SC_ISA_AVX512) {
            memset(&other, 0, sizeof other);
            lanes_try_avx512(&in, &other);
            CHECK_MSG(!memcmp(&plain, &other, sizeof plain), "AVX-512, trial %u", trial);
        }
    }
    if (sc_isa_best() < SC_ISA_AVX512) test_skip("what this machine does not have");
}

/* Point i of plain, of four floats in transposed places. */
static const float *turned_point(const lanes_input *in, uint32_t i)
{
    static const uint8_t place[16] = {0, 4, 8, 12, 1, 5, 9, 13, 2, 6, 10, 14, 3, 7, 11, 15};
    return in->plain + 4 * place[i];
}

/* The least and the most of three coordinates of sixteen points. */
static void ends_of_row(const lanes_input *in, uint32_t i, float ends[6])
{
    const float *at = in->row[0] + LANES_STRIDE * i;
    uint32_t k, j;
    for (k = 0; k < 3; k++) {
        ends[k] = ends[k + 3] = at[k];
        for (j = 1; j < 16; j++) {
            ends[k] = fminf(ends[k], at[4 * j + k]);
            ends[k + 3] = fmaxf(ends[k + 3], at[4 * j + k]);
        }
    }
}

/* The plain form against what is said of it. */
static void bytes_and_names(void)
{
    lanes_input in;
    lanes_outcome out;
    uint32_t trial, i, k, c;
    memset(&in, 0, sizeof in);
    for (trial = 0; trial < 2000; trial++) {
        draw(&in);
        lanes_try_plain(&in, &out);
        for (i = 0; i < 16; i++) {
            const uint8_t a = in.number[i], b = in.through[i];
            unsigned name = 0;
            while (name < 16 && in.names[name] != in.names[16 + i]) name++;
            CHECK(out.bytes[0][i] == (a == b ? 255 : 0));
            CHECK((out.bits[14] >> i & 1u) == (unsigned)(a == b));
            CHECK((out.bits[15] >> i & 1u) == (unsigned)(in.names[i] == in.names[16 + i]));
            CHECK(!memcmp(&out.row[64][i], &in.a[b], sizeof(float)));
            CHECK(!memcmp(&out.row[75][i], &(in.mask >> i & 1u ? in.b : in.a)[a], sizeof(float)));
            CHECK(out.bytes[4][i] == (in.number[16 + i] == in.number[32 + i] ? a : b));
            CHECK(out.bytes[5][i] == in.number[b]);
            CHECK(out.bytes[6][i] == (name < 16 ? name : 255));
            for (k = 0; k < 3; k++) CHECK(out.bytes[7 + k][i] == in.number[16 * k + b]);
            for (k = 0; k < 4; k++) CHECK(out.bytes[10 + k][i] == (in.words[i] >> 4 * k & 15));
            CHECK(out.bytes[14][i] == in.number[0]);
            for (k = 0; k < 4; k++)
                for (c = 0; c < 3; c++) {
                    const float *table = k < 2 ? in.plain : in.row[0];
                    uint32_t at = in.number[16 * (k < 2 ? k + 1 : k - 1) + i];
                    float edge = table[16 * (at & 3) + at / 4 * 4 + c] - turned_point(&in, a)[c];
                    CHECK(!memcmp(&out.row[51 + 3 * k + c][i], &edge, sizeof edge));
                }
        }
        for (i = c = 0; i < 16; i++) {
            if (!(in.mask >> i & 1u)) continue;
            for (k = 0; k < 3; k++)
                CHECK(out.kept[k][c] == in.names[k] + ((unsigned)in.words[i] >> 4 * k & 15u));
            c++;
        }
    }
}

/* The same of sets. */
static void sets_within_sets(void)
{
    lanes_input in;
    lanes_outcome out;
    uint32_t trial, i;
    memset(&in, 0, sizeof in);
    for (trial = 0; trial < 2000; trial++) {
        unsigned all = 0;
        draw(&in);
        lanes_try_plain(&in, &out);
        for (i = 0; i < 16; i++) {
            const unsigned one = 1u << in.number[i], other = 1u << in.number[16 + i];
            const unsigned some = (unsigned)in.words[0] & in.words[1];
            if (in.mask >> i & 1u) all |= one | other;
            CHECK((out.bits[27] >> i & 1u) == (unsigned)((in.words[i] & some) == some));
            CHECK((out.bits[24] >> i & 1u) == (unsigned)((in.mask & one) != 0));
            CHECK((out.bits[25] >> i & 1u) == (unsigned)((~in.mask & (one | other)) == 0));
            CHECK((out.bits[26] >> i & 1u) ==
                  (unsigned)((in.words[i] & ~(in.mask | in.words[0])) == 0));
        }
        CHECK(out.bits[28] == all);
    }
}

/* Whether a cell is in the box of two others, or beside it. */
static int is_near(const lanes_input *in, uint32_t cell, uint32_t i)
{
    uint32_t k;
    for (k = 0; k < 4; k += 2) {
        const uint8_t at = in->cell[k][cell], a = in->cell[k][i], b = in->cell[k + 1][i];
        if (at > (a > b ? a : b) + 1 || at + 1 < (a < b ? a : b)) return 0;
    }
    return 1;
}

/* The same of cells. */
static void cells_and_boxes(void)
{
    lanes_input in;
    lanes_outcome out;
    uint32_t trial, i;
    memset(&in, 0, sizeof in);
    for (trial = 0; trial < 2000; trial++) {
        draw(&in);
        lanes_try_plain(&in, &out);
        for (i = 0; i < 16; i++) {
            const uint32_t x = in.cell[0][i], y = in.cell[2][i];
            const int near = is_near(&in, 0, i);
            CHECK(out.cells[0][i] == (x | y << 8 | (255 - x) << 16 | (255 - y) << 24));
            CHECK((out.bits[22] >> i & 1u) == (unsigned)near);
            CHECK((out.bits[23] >> i & 1u) == (unsigned)(near || is_near(&in, 1, i)));
        }
    }
}

/* The same of lists and signs. */
static void lists_and_signs(void)
{
    lanes_input in;
    lanes_outcome out;
    uint32_t trial, i, k, wide;
    memset(&in, 0, sizeof in);
    for (trial = 0; trial < 2000; trial++) {
        unsigned count = 0, negative = 0, marked = 0, among = 0, found = 0;
        float ends[6];
        draw(&in);
        lanes_try_plain(&in, &out);
        for (i = 0; i < 16; i++) {
            for (k = 0; k < 16 && in.row[i][k] < 0; k++) continue;
            negative |= (unsigned)(k == 16) << i;
            marked |= (unsigned)(in.a[i] < in.b[i]) << in.number[i];
            marked |= (unsigned)(in.b[i] < in.a[i]) << in.number[16 + i];
            marked |= (unsigned)(in.plain[i] < in.plain[16 + i]) << in.number[32 + i];
            among |= (in.mask >> in.number[i] & 1u) << i;
            if (!(in.mask >> i & 1u)) continue;
            CHECK(out.list[count] == i && out.from[count] == in.names[0] + i);
            for (k = 0, wide = 0; k < 12; k++) wide |= (in.bits[k] >> i & 1u) << k;
            CHECK(out.wide[count] == wide);
            wide = in.bits[0] >> i & 1u;
            CHECK(out.pairs[2 * count] == in.first[wide] + in.number[i]);
            CHECK(out.pairs[2 * count + 1] == in.first[2 + wide] + in.through[i]);
            count++;
        }
        CHECK(out.bits[5] == count && out.bits[18] == count && out.bits[6] == negative);
        CHECK(out.bits[16] == marked && out.bits[17] == among);
        for (i = count = 0; i < in.split; i++) {
            const uint32_t number = in.apart[i] - in.names[0];
            if (number >= 16 || !(in.mask >> number & 1u)) continue;
            CHECK(out.among[count++] == in.first[0] + i);
            found |= 1u << number;
        }
        CHECK(out.bits[20] == count && out.bits[21] == found);
        for (i = 0; i < 16; i++) {
            CHECK((out.bits[0] >> i & 1u) == (unsigned)(in.a[i] < in.b[i]));
            CHECK((out.bits[1] >> i & 1u) == (unsigned)(in.a[i] <= in.b[i]));
            CHECK(!memcmp(&out.row[17][i], &in.a[in.number[i]], sizeof(float)));
            CHECK(!memcmp(&out.row[21][i], turned_point(&in, in.number[i]), sizeof(float)));
            CHECK(
                !memcmp(&out.row[29][i], turned_point(&in, in.number[32 + i]) + 2, sizeof(float)));
            for (k = 0; k < 9; k++)
                CHECK(!memcmp(&out.row[39 + k][i],
                              turned_point(&in, in.number[k / 3 * 16 + in.through[i]]) + k % 3,
                              sizeof(float)));
            CHECK((out.bits[19] >> i & 1u) == (unsigned)(i >= in.split));
            CHECK(!memcmp(&out.row[65][i], (i < in.split ? in.a : in.b) + in.number[i],
                          sizeof(float)));
            for (k = 0; k < 9; k++) {
                uint32_t at = k / 3 * 16 + in.through[i];
                const float *point = turned_point(&in, in.number[at]);
                if (i >= in.split)
                    point = in.row[0] + 16 * (in.other[at] & 3) + in.other[at] / 4 * 4;
                CHECK(!memcmp(&out.row[66 + k][i], point + k % 3, sizeof(float)));
            }
            for (k = 0; k < 3; k++)
                CHECK(!memcmp(&out.row[30 + k][i], turned_point(&in, i) + k, sizeof(float)));
            for (k = 0; k < 3; k++)
                CHECK(!memcmp(&out.row[48 + k][i], in.plain + 1 + 4 * (in.number[i] % 15u) + k,
                              sizeof(float)));
            wide = (uint32_t)in.number[i] << in.number[i] % 13;
            CHECK(out.numbers[i] ==
                  wide + (wide < 3u << in.number[0] ? in.mask : (uint32_t)in.number[1] << 16));
            ends_of_row(&in, i, ends);
            for (k = 0; k < 6; k++) CHECK(!memcmp(&out.row[33 + k][i], &ends[k], sizeof(float)));
        }
    }
}

SC_TEST_MAIN(SC_TEST(all_forms_agree), SC_TEST(bytes_and_names), SC_TEST(sets_within_sets),
             SC_TEST(cells_and_boxes), SC_TEST(lists_and_signs))
