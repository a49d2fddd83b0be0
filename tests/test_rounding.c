/*
 * Actual rounding errors stay within the bounds that lib/GUARANTEE.md lists: some random and
 * adversarial trials of each; see rounding_search.h. Of many bounds more than half is reached, so
 * that a test here fails if one of them is halved.
 *
 * SPDX-License-Identifier: MIT
 */
#include <string.h>

#include "harness.h"
#include "rounding_search.h"

/* All bounds of a group. What they reach at least is the search's own test: one that found nothing
   would pass whatever the bound. */
static void search_group(const char *group)
{
    int searched = 0;
    for (int i = 0; i < rounding_bound_count; ++i) {
        const rounding_bound *b = &rounding_bounds[i];
        const uint32_t trials = test_iterations(200000 / (uint32_t)b->slowness);
        double share;
        if (strcmp(b->group, group) != 0) continue;
        ++searched;
        share = rounding_search(b, trials, 1, NULL);
        CHECK_MSG(share > 0 && share <= 1, "%s: %g of the bound", b->name, share);
        CHECK_MSG(trials < 200000 / (uint32_t)b->slowness || share >= b->seen,
                  "%s: only %g of the bound", b->name, share);
    }
    CHECK(searched > 0);
}

static void exact_signs(void)
{
    search_group("exact signs");
}

static void boxes_and_points(void)
{
    search_group("boxes and points");
}

static void contours(void)
{
    search_group("contours");
}

static void triangles_in_the_unit_box(void)
{
    search_group("triangles in the unit box");
}

static void triangles_in_doubles(void)
{
    search_group("triangles in doubles");
}

static void steps(void)
{
    search_group("steps");
}

SC_TEST_MAIN(SC_TEST(exact_signs), SC_TEST(boxes_and_points), SC_TEST(contours),
             SC_TEST(triangles_in_the_unit_box), SC_TEST(triangles_in_doubles), SC_TEST(steps))
