/*
 * Tests of the narrow phase of continuous collision, lib/step/impact.
 *
 * SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <string.h>

#include "harness.h"
#include "step/impact.h"

typedef struct query {
    double start[4][3], end[4][3];
} query;

static int ask(const query *q, int is_face, double separation, double tolerance, double *time)
{
    sc_impact_limits limits = {separation, tolerance, 1};
    if (is_face) return sc_impact_vertex_face(q->start, q->end, &limits, time);
    return sc_impact_edge_edge(q->start, q->end, &limits, time);
}

static void known_times(void)
{
    query drop = {{{0.25, 0.25, 1}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}},
                  {{0.25, 0.25, -1}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}}};
    query cross = {{{-1, 0, 1}, {1, 0, 1}, {0, -1, 0}, {0, 1, 0}},
                   {{-1, 0, -3}, {1, 0, -3}, {0, -1, 0}, {0, 1, 0}}};
    double time = -1;
    CHECK(ask(&drop, 1, 0, 1e-6, &time) == 1);
    CHECK_MSG(time <= 0.5 && time >= 0.5 - 1e-6, "%.17g", time);
    CHECK(ask(&drop, 1, 0.5, 1e-6, &time) == 1);
    CHECK_MSG(time <= 0.25 && time >= 0.25 - 1e-6, "%.17g", time);
    CHECK(ask(&drop, 1, 1, 1e-6, &time) == 1 && time == 0);
    CHECK(ask(&cross, 0, 0, 1e-6, &time) == 1);
    CHECK_MSG(time <= 0.25 && time >= 0.25 - 1e-6, "%.17g", time);
    for (int k = 0; k < 4; ++k) drop.end[k][2] += 5;
    CHECK(ask(&drop, 1, 0, 1e-6, &time) == 1 && time <= 0.5 && time >= 0.5 - 1e-6);
    drop.end[0][2] += 1.001;
    CHECK(ask(&drop, 1, 0, 1e-6, &time) == 0 && time == 1);
}

SC_TEST_MAIN(SC_TEST(known_times))
