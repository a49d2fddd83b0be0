/*
 * Where products underflow. Small integers times a power of two are exact, and so is what their
 * products ought to be; but rounded to multiples of the smallest number, sums of such products get
 * the wrong sign. The bounds of errors have a term for that.
 *
 * SPDX-License-Identifier: MIT
 */
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "harness.h"
#include "inputs.h"
#include "pose/positions.h"
#include "run/workspace.h"

typedef struct scene {
    sc_model *model;
    sc_workspace *workspace;
} scene;

static int open_scene(scene *s, const soup *mesh)
{
    sc_mesh m = input_plain_mesh(mesh);
    sc_build_options options;
    memset(&options, 0, sizeof(options));
    options.struct_size = sizeof(options);
    options.weld = SC_WELD_NONE;
    s->model = NULL;
    s->workspace = NULL;
    return CHECK(sc_build(&m, &options, &s->model) == SC_OK) &&
           CHECK(sc_workspace_create(s->model, NULL, &s->workspace) == SC_OK);
}

static void close_scene(scene *s)
{
    sc_workspace_free(s->workspace);
    sc_model_free(s->model);
}

static uint64_t count_pairs(const scene *s, const double *integers, uint32_t vertex_count, int down)
{
    double positions[30] = {0};
    sc_pose pose = input_plain_pose(positions, vertex_count);
    sc_query_options options;
    sc_result result;
    for (uint32_t i = 0; i < 3 * vertex_count; ++i) positions[i] = ldexp(integers[i], -down);
    memset(&options, 0, sizeof(options));
    memset(&result, 0, sizeof(result));
    options.struct_size = sizeof(options);
    options.output = SC_OUTPUT_COUNT;
    options.method = SC_METHOD_AABB;
    result.struct_size = sizeof(result);
    CHECK(sc_query(s->model, s->workspace, &pose, &options, &result) == SC_OK);
    return result.count;
}

/* Two triangles in a plane, most of them nearly touching, at sizes at which the tests by planes
   (products of three differences) and along sides (of four) underflow. */
static void flat_pairs(void)
{
    static const uint32_t triangles[6] = {0, 1, 2, 3, 4, 5};
    uint32_t rounds = test_iterations(30000), meet = 0;
    double p[18];
    soup mesh = {6, 2, p, NULL};
    scene s;
    uint32_t corners[6];
    memcpy(corners, triangles, sizeof(corners));
    mesh.triangles = corners;
    memset(p, 0, sizeof(p));
    if (!open_scene(&s, &mesh)) return;
    for (uint32_t round = 0; round < rounds; ++round) {
        uint64_t state = test_random_state(), right;
        int a = (int)test_random_below(5) - 2, b = (int)test_random_below(5) - 2;
        uint32_t range = 2 + test_random_below(6);
        for (uint32_t v = 0; v < 6; ++v) {
            p[3 * v] = test_random_below(range);
            p[3 * v + 1] = test_random_below(range);
            p[3 * v + 2] = a * p[3 * v] + b * p[3 * v + 1];
        }
        right = count_pairs(&s, p, 6, 0);
        meet += right > 0;
        for (int down = 264; down < 276; ++down)
            CHECK_MSG(count_pairs(&s, p, 6, down) == right,
                      "at 2^-%d: not %" PRIu64 "; started at %" PRIu64, down, right, state);
        for (int down = 354; down < 364; ++down)
            CHECK_MSG(count_pairs(&s, p, 6, down) == right,
                      "at 2^-%d: not %" PRIu64 "; started at %" PRIu64, down, right, state);
    }
    CHECK(meet > rounds / 10 && meet < rounds - rounds / 10);
    close_scene(&s);
}

SC_TEST_MAIN(SC_TEST(flat_pairs))
