/*
 * Refinement of cuts, in small and large patches: the border becomes shorter, no side too large,
 * and nothing else changes.
 *
 * SPDX-License-Identifier: MIT
 */
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "build/small_refinement.h"
#include "harness.h"

enum { SIDE_MAX = 24, TRIANGLES_MAX = 2 * SIDE_MAX * SIDE_MAX };

/* Two triangles in each square of a grid; the patch is a rectangle of it, 2 * PATCH + side in each
   label. */
enum { PATCH = 5, OTHER = 8 };

typedef struct grid {
    uint32_t columns, rows, count; /* count: triangles */
    uint32_t patch_count, triangles[TRIANGLES_MAX];
    uint32_t neighbor[3 * TRIANGLES_MAX];
    float lengths[3 * TRIANGLES_MAX];
    uint32_t label[TRIANGLES_MAX + 1];
    float gain[TRIANGLES_MAX];
    uint8_t state[TRIANGLES_MAX + 1];
    uint32_t moves[TRIANGLES_MAX], border[TRIANGLES_MAX];
    sc_pair heap[4 * TRIANGLES_MAX];
    sc_refinement refinement;
} grid;

static uint32_t triangle_at(const grid *g, uint32_t x, uint32_t y, uint32_t upper)
{
    return x < g->columns && y < g->rows ? 2 * (y * g->columns + x) + upper : g->count;
}

/* Joins side k of a lower triangle with side k of an upper one. */
static void join(grid *g, uint32_t k, uint32_t t, uint32_t u, float length)
{
    if (t < g->count) {
        g->neighbor[3 * t + k] = u;
        g->lengths[3 * t + k] = length;
    }
    if (u < g->count) {
        g->neighbor[3 * u + k] = t;
        g->lengths[3 * u + k] = length;
    }
}

static float any_length(int kind)
{
    return (float)(kind == 0   ? 1
                   : kind == 1 ? test_random_unit()
                               : exp2(test_random_range(-30, kind == 2 ? 12 : 127)));
}

static void make_grid(grid *g, uint32_t columns, uint32_t rows, int kind)
{
    memset(g, 0, sizeof(*g));
    g->columns = columns;
    g->rows = rows;
    g->count = 2 * columns * rows;
    for (uint32_t x = 0; x <= columns; ++x)
        for (uint32_t y = 0; y <= rows; ++y) {
            uint32_t t = triangle_at(g, x, y, 0);
            join(g, 0, t, triangle_at(g, x, y, 1), any_length(kind));
            join(g, 1, t, triangle_at(g, x - 1, y, 1), any_length(kind));
            join(g, 2, t, triangle_at(g, x, y - 1, 1), any_length(kind));
        }
    g->refinement.neighbor = g->neighbor;
    g->refinement.lengths = g->lengths;
    g->refinement.label = g->label;
    g->refinement.gain = g->gain;
    g->refinement.state = g->state;
    g->refinement.moves = g->moves;
    g->refinement.heap = g->heap;
    g->refinement.border = g->border;
}

/* Makes a patch of the first columns and rows, and cuts it anywhere; size[0] of its triangles are
   on side 0. */
static void cut(grid *g, uint32_t columns, uint32_t rows, uint32_t size[2])
{
    uint32_t first;
    g->patch_count = 0;
    for (uint32_t t = 0; t <= g->count; ++t) g->label[t] = t < g->count ? OTHER : UINT32_MAX;
    for (uint32_t x = 0; x < columns; ++x)
        for (uint32_t y = 0; y < rows; ++y)
            for (uint32_t upper = 0; upper < 2; ++upper)
                g->triangles[g->patch_count++] = triangle_at(g, x, y, upper);
    first = 1 + test_random_below(g->patch_count - 1);
    for (uint32_t i = 0; i < g->patch_count; ++i) {
        uint32_t side = test_random_below(6) == 0 ? test_random_below(2) : i >= first;
        g->label[g->triangles[i]] = 2 * PATCH + (i == 0 ? 0 : i + 1 == g->patch_count ? 1 : side);
    }
    size[0] = size[1] = 0;
    for (uint32_t i = 0; i < g->patch_count; ++i) ++size[g->label[g->triangles[i]] & 1];
}

static int is_at_border(const grid *g, uint32_t t)
{
    int is = 0;
    for (uint32_t k = 0; k < 3; ++k) is |= (g->label[g->neighbor[3 * t + k]] ^ g->label[t]) == 1;
    return is;
}

static double border_length(const grid *g)
{
    double sum = 0;
    for (uint32_t t = 0; t < g->count; t += 2) /* each side once, from the lower triangle */
        for (uint32_t k = 0; k < 3; ++k)
            if ((g->label[g->neighbor[3 * t + k]] ^ g->label[t]) == 1)
                sum += (double)g->lengths[3 * t + k];
    return sum;
}

/* Runs one of the two. Returns by how much the border became shorter, as a part of what it was. */
static double check_run(grid *g, int small, uint32_t size[2], const uint32_t capacity[2])
{
    double before = border_length(g), after;
    uint32_t counted[2] = {0, 0}, wrong = 0, listed = 0;
    if (small)
        sc_small_refinement_run(&g->refinement, g->triangles, g->patch_count, size, capacity);
    else
        sc_refinement_run(&g->refinement, g->triangles, g->patch_count, size, capacity);
    after = border_length(g);
    for (uint32_t i = 0; i < g->patch_count; ++i) {
        uint32_t label = g->label[g->triangles[i]];
        wrong += label >> 1 != PATCH;
        ++counted[label & 1];
        listed += (uint32_t)is_at_border(g, g->triangles[i]);
    }
    for (uint32_t i = 0; i < g->refinement.border_count; ++i) {
        uint32_t t = g->border[i];
        wrong += t >= g->count || g->label[t] >> 1 != PATCH || !is_at_border(g, t) || g->state[t];
        if (t < g->count) g->state[t] = 1; /* once each */
    }
    for (uint32_t i = 0; i < g->refinement.border_count; ++i) g->state[g->border[i]] = 0;
    for (uint32_t t = 0; t <= g->count; ++t) wrong += g->state[t] != 0;
    for (uint32_t t = 0; t < g->count; ++t)
        wrong += g->label[t] >> 1 != PATCH && g->label[t] != OTHER;
    CHECK_MSG(wrong == 0 && g->label[g->count] == UINT32_MAX, "%" PRIu32 " wrong", wrong);
    CHECK(listed == g->refinement.border_count);
    CHECK(counted[0] == size[0] && counted[1] == size[1]);
    CHECK(size[0] > 0 && size[1] > 0 && size[0] <= capacity[0] && size[1] <= capacity[1]);
    return before > 0 ? (before - after) / before : 0;
}

/* Cuts of any patches. Lengths beyond 4096 are all the same to a small one, and below 1/1024
   nothing. */
static void any_cuts(void)
{
    static grid g, again;
    double shorter[2] = {0, 0};
    uint32_t runs[2] = {0, 0};
    for (uint32_t i = 0; i < test_iterations_at_least(3000, 300); ++i) {
        int kind = (int)test_random_below(3), small = i % 2 == 0;
        uint32_t columns = 1 + test_random_below(small ? 5 : SIDE_MAX);
        uint32_t rows = 2 + test_random_below(small ? 5 : SIDE_MAX - 1);
        uint32_t size[2], capacity[2];
        make_grid(&g, columns, rows, kind);
        cut(&g, 1 + test_random_below(columns), 2 + test_random_below(rows - 1), size);
        for (int k = 0; k < 2; ++k) {
            capacity[k] = size[k] + test_random_below(1 + g.patch_count / 4);
            if (capacity[k] >= g.patch_count) capacity[k] = g.patch_count - 1;
        }
        again = g;
        again.refinement.neighbor = again.neighbor;
        for (int run = 0; run < 1 + small; ++run) { /* small patches by either */
            uint32_t now[2] = {size[0], size[1]};
            double part;
            g.label[g.count] = UINT32_MAX;
            memcpy(g.label, again.label, sizeof(g.label));
            part = check_run(&g, small && run == 0, now, capacity);
            CHECK_MSG(part > -1e-3, "longer by %g", -part);
            shorter[small && run == 0] += part;
            ++runs[small && run == 0];
        }
    }
    for (int k = 0; k < 2; ++k)
        CHECK_MSG(shorter[k] > 0.2 * runs[k], "%d: %g", k, shorter[k] / runs[k]);
}

/* A row of triangles, cut where the side is longest, however long that is. */
static void longest_side(void)
{
    static const float most[] = {2, 4095, 4097, 1e6f, 1e30f, 3e38f};
    static grid g;
    for (size_t i = 0; i < sizeof(most) / sizeof(most[0]); ++i)
        for (int small = 0; small < 2; ++small)
            for (uint32_t at = 1; at < 7; ++at) {
                uint32_t size[2] = {at, 8 - at}, capacity[2] = {7, 7};
                make_grid(&g, 4, 1, 0);
                for (uint32_t t = 0; t <= 8; ++t)
                    g.label[t] = t == 8 ? UINT32_MAX : 2 * PATCH + (t >= at);
                for (uint32_t t = 0; t < 8; ++t) g.triangles[t] = t;
                g.patch_count = 8;
                for (uint32_t t = at - 1; t <= at; ++t)
                    for (uint32_t k = 0; k < 3; ++k)
                        if (g.neighbor[3 * t + k] == 2 * at - 1 - t) g.lengths[3 * t + k] = most[i];
                CHECK(border_length(&g) == (double)most[i]);
                check_run(&g, small, size, capacity);
                CHECK_MSG(border_length(&g) == 1, "%g at %" PRIu32 ": %g", (double)most[i], at,
                          border_length(&g));
            }
}

SC_TEST_MAIN(SC_TEST(any_cuts), SC_TEST(longest_side))
