/*
 * Near pairs: counts are those of comparing all boxes with all others, on random triangles that
 * share vertices.
 *
 * SPDX-License-Identifier: MIT
 */
#include "harness.h"
#include "near_pairs.h"

#include <math.h>
#include <stdbool.h>
#include <stdint.h>

enum { VERTICES = 90, TRIANGLES = 150 };

static double positions[3 * VERTICES];
static uint32_t triangles[3 * TRIANGLES];

static bool are_near(const uint32_t *a, const uint32_t *b)
{
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            if (a[i] == b[j]) return false;
        }
    }
    for (size_t k = 0; k < 3; k++) {
        double low[2] = {HUGE_VAL, HUGE_VAL}, high[2] = {-HUGE_VAL, -HUGE_VAL};
        for (int i = 0; i < 3; i++) {
            low[0] = fmin(low[0], positions[3 * a[i] + k]);
            high[0] = fmax(high[0], positions[3 * a[i] + k]);
            low[1] = fmin(low[1], positions[3 * b[i] + k]);
            high[1] = fmax(high[1], positions[3 * b[i] + k]);
        }
        if (low[0] > high[1] || low[1] > high[0]) return false;
    }
    return true;
}

/* Coordinates of a coarse grid, so that boxes also touch; one axis is the longest in each trial. */
static void counts_are_those_of_all_pairs(void)
{
    uint64_t most = 0;
    for (uint32_t trial = 0; trial < test_iterations(60); trial++) {
        for (size_t i = 0; i < 3 * VERTICES; i++) {
            positions[i] = (double)test_random_below(i % 3 == trial % 3 ? 30 : 10);
        }
        for (size_t t = 0; t < TRIANGLES; t++) {
            const uint32_t first = test_random_below(VERTICES - 4);
            for (uint32_t k = 0; k < 3; k++) triangles[3 * t + k] = first + 2 * k;
        }
        uint64_t expected = 0, count = 0;
        for (size_t a = 0; a < TRIANGLES; a++) {
            for (size_t b = a + 1; b < TRIANGLES; b++) {
                expected += are_near(triangles + 3 * a, triangles + 3 * b);
            }
        }
        if (!CHECK(near_pairs_count(triangles, TRIANGLES, positions, &count))) return;
        CHECK_MSG(count == expected, "%lu in place of %lu", (unsigned long)count,
                  (unsigned long)expected);
        most = count > most ? count : most;
    }
    CHECK(most > 0);
}

static void one_triangle_has_none(void)
{
    uint64_t count = 1;
    const uint32_t corners[3] = {0, 1, 2};
    CHECK(near_pairs_count(corners, 1, positions, &count));
    CHECK(count == 0);
}

SC_TEST_MAIN(SC_TEST(counts_are_those_of_all_pairs), SC_TEST(one_triangle_has_none))
