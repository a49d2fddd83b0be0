/*
 * The star-contour test (paper, section 3), and the exact one beside it, on every node of the
 * test tree, against the oracle.
 *
 * SPDX-License-Identifier: MIT
 */
#include <inttypes.h>
#include <math.h>
#include <string.h>

#include "harness.h"
#include "inputs.h"
#include "pose/dnc.h"
#include "pose/positions.h"
#include "posed_model.h"
#include "query/simple.h"
#include "shapes.h"
#include "simd/isa.h"
#include "soups.h"
#include "starcontour.h"

/* Projected coordinates beyond the range of float, in which bounds are kept. */
static void stars_beyond_float(void)
{
    posed_model_tally tally;
    memset(&tally, 0, sizeof(tally));
    for (uint32_t i = 0; i < test_iterations(100); ++i) {
        posed_model s;
        posed_model_open_any(&s, 30 + i % 90);
        posed_model_any_pose(s.pose, s.mesh.vertex_count);
        soup_scale(s.pose, s.mesh.vertex_count, exp2(test_random_range(105, 140)));
        if (posed_model_load(&s)) posed_model_check_nodes(&s, &tally);
        posed_model_close(&s);
    }
    CHECK(!test_is_full() || (tally.passed > 0 && tally.colliding > 100));
}

static void stars_have_no_pairs(void)
{
    posed_model_tally tally;
    memset(&tally, 0, sizeof(tally));
    for (uint32_t i = 0; i < test_iterations(300); ++i) {
        posed_model s;
        posed_model_open_any(&s, 30 + i % 120);
        posed_model_any_pose(s.pose, s.mesh.vertex_count);
        if (posed_model_load(&s)) posed_model_check_nodes(&s, &tally);
        posed_model_close(&s);
    }
    test_note("%" PRIu64 " of %" PRIu64 " passed, %" PRIu64 " of %" PRIu64
              " with one shared point; %" PRIu64 " had pairs inside",
              tally.passed, tally.oriented, tally.touching_passed, tally.touching, tally.colliding);
    CHECK(!test_is_full() ||
          (6 * tally.passed > tally.oriented && 8 * tally.touching_passed > tally.touching));
    test_note("%" PRIu64 " contours are simple, %" PRIu64 " of these have one shared point",
              tally.simple, tally.pinched);
    CHECK(!test_is_full() || (tally.simple > tally.passed && 4 * tally.pinched > tally.touching));
    CHECK(!test_is_full() || tally.colliding > 500);
}

/* Flat, all normals up, and more than once round: the contour alone can tell. */
static void spirals_overlap(void)
{
    posed_model_tally tally;
    memset(&tally, 0, sizeof(tally));
    for (uint32_t i = 0; i < test_iterations(24); ++i) {
        posed_model s;
        soup mesh = shape_spiral(30 + i, 1 + i % 3, test_random_range(0.3, 2.2), i % 2 ? 0.1 : 0);
        if (!posed_model_open(&s, "spiral", &mesh, SC_WELD_NONE, i / 2 % 4)) continue;
        posed_model_rotate(s.pose, s.mesh.vertex_count);
        if (posed_model_load(&s)) posed_model_check_nodes(&s, &tally);
        posed_model_close(&s);
    }
    CHECK(!test_is_full() || (tally.colliding > 500 && tally.passed > 1000));
}

/* A long ribbon that nearly closes to a ring, or goes on over its own start: only edges that are
   far from each other in the contour meet. */
static void long_contours(void)
{
    for (uint32_t i = 0; i < 8; ++i) {
        posed_model s;
        soup mesh = shape_spiral(1400 + 37 * i, 1, i % 2 ? 1.001 : 0.999, 0);
        sc_projection projection;
        if (posed_model_open(&s, "ribbon", &mesh, SC_WELD_NONE, SC_PARTITION_FAST) &&
            posed_model_load(&s) && CHECK(s.workspace->frame.mask[0] != 0)) {
            s.workspace->frame.kernels = sc_kernels_for(1 + i / 2 % (uint32_t)sc_isa_best());
            sc_dnc_projection(&s.workspace->frame, s.workspace->frame.mask[0], &projection);
            CHECK_MSG(sc_simple_test(s.workspace->worker, &projection, 0) == (i % 2 == 0),
                      "ribbon %u", i);
        }
        posed_model_close(&s);
    }
}

/* A disc that goes twice round its center, and so lies over itself, in a ring of which one patch
   borders on most of it: one segment that is crossed twice, and from the center everything looks
   like a star. */
static void branched_discs(void)
{
    enum { SECTORS = 16 };
    posed_model_tally tally;
    memset(&tally, 0, sizeof(tally));
    for (uint32_t turn = 0; turn < 16; ++turn) {
        soup mesh = soup_make(1 + 2 * SECTORS, 3 * SECTORS);
        uint32_t order[3 * SECTORS], few = 2 + turn % 3 * 2, n = 0;
        sc_tree_node tree[5];
        posed_model s;
        sc_mesh m;
        memset(mesh.positions, 0, 3 * sizeof(double));
        for (uint32_t i = 0; i < SECTORS; ++i) {
            uint32_t a = 1 + i, b = 1 + (i + 1) % SECTORS;
            uint32_t corners[3][3] = {
                {0, a, b}, {a, a + SECTORS, b}, {b, a + SECTORS, b + SECTORS}};
            for (uint32_t ring = 0; ring < 2; ++ring) {
                double *p = mesh.positions + 3 * (size_t)(a + ring * SECTORS);
                double angle = 4 * posed_model_pi * i / SECTORS + 0.1 + 0.4 * turn;
                p[0] = (1 + ring) * cos(angle);
                p[1] = (1 + ring) * sin(angle);
                p[2] = 0;
            }
            memcpy(mesh.triangles + 3 * (size_t)i, corners[0], sizeof(corners[0]));
            memcpy(mesh.triangles + 3 * (size_t)(SECTORS + 2 * i), corners[1],
                   2 * sizeof(corners[1]));
        }
        for (uint32_t i = 0; i < 3 * SECTORS; ++i) order[i] = i;
        memset(tree, 0, sizeof(tree)); /* the disc | most of the ring, the rest */
        tree[0].left = 1;
        tree[0].right = 2;
        tree[2].left = 3;
        tree[2].right = 4;
        for (uint32_t i = 1; i < 5; i = i == 1 ? 3 : i + 1) {
            tree[i].left = tree[i].right = SC_NONE;
            tree[i].first = n;
            tree[i].count = i == 1 ? SECTORS : i == 3 ? 2 * SECTORS - few : few;
            n += tree[i].count;
        }
        memset(&s, 0, sizeof(s));
        s.name = "branched disc";
        s.mesh = mesh;
        s.pose = soup_copy_positions(&mesh);
        s.choices.options.struct_size = sizeof(s.choices.options);
        s.choices.options.weld = SC_WELD_NONE;
        s.choices.options.partition = SC_PARTITION_TREE;
        s.choices.options.order = order;
        s.choices.options.tree = tree;
        s.choices.options.tree_count = 5;
        s.choices.partition_name = "tree";
        m = input_plain_mesh(&mesh);
        if (turn % 2) posed_model_rotate(s.pose, mesh.vertex_count);
        if (CHECK(sc_build(&m, &s.choices.options, &s.model) == SC_OK) &&
            CHECK(sc_workspace_create(s.model, NULL, &s.workspace) == SC_OK) &&
            posed_model_load(&s))
            posed_model_check_nodes(&s, &tally);
        posed_model_close(&s);
    }
    CHECK(tally.colliding > 0);
}

SC_TEST_MAIN(SC_TEST(stars_have_no_pairs), SC_TEST(stars_beyond_float), SC_TEST(spirals_overlap),
             SC_TEST(long_contours), SC_TEST(branched_discs))
