/*
 * Where products underflow. Small integers times a power of two are exact, and so is what their
 * products ought to be; but rounded to multiples of the smallest number, sums of such products get
 * the wrong sign. The bounds of errors have a term for that. And where products overflow: what is
 * infinite has no sign.
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
#include "pose/fan.h"
#include "pose/positions.h"

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

/* The sum of the normals of a fan, and whether each of them makes less than a right angle with
   it. */
static int is_upright(int64_t r[][3], uint32_t count)
{
    int64_t n[8][3], d[3] = {0, 0, 0};
    for (uint32_t i = 0; i < count; ++i) {
        const int64_t *a = r[i], *b = r[(i + 1) % count];
        for (int k = 0; k < 3; ++k) {
            n[i][k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
            d[k] += n[i][k];
        }
    }
    for (uint32_t i = 0; i < count; ++i)
        if (n[i][0] * d[0] + n[i][1] * d[1] + n[i][2] * d[2] <= 0) return 0;
    return 1;
}

/* Fans of four to six triangles round vertex 0. */
static void fans(void)
{
    uint32_t plain = 0, upright = 0;
    for (uint32_t count = 4; count <= 6; ++count) {
        double p[24];
        uint32_t corners[18];
        soup mesh = {count + 1, count, p, NULL};
        scene s;
        for (uint32_t i = 0; i < count; ++i) {
            corners[3 * i] = 0;
            corners[3 * i + 1] = 1 + i;
            corners[3 * i + 2] = 1 + (i + 1) % count;
        }
        mesh.triangles = corners;
        memset(p, 0, sizeof(p));
        if (!open_scene(&s, &mesh)) return;
        for (uint32_t round = 0; round < test_iterations(40000); ++round) {
            uint64_t state = test_random_state();
            int64_t r[8][3];
            int range = 2 + (int)test_random_below(3), exact;
            for (uint32_t i = 0; i < count; ++i) /* round the z axis, roughly */
                for (int k = 0; k < 3; ++k) {
                    double angle = 6.283185307179586 * i / count;
                    double x = k == 0 ? cos(angle) : k == 1 ? sin(angle) : 0;
                    r[i][k] = (int64_t)rint(range * x) + (int)test_random_below(3) - 1;
                }
            exact = is_upright(r, count);
            upright += (uint32_t)exact;
            for (int down = 262; down < 274; ++down) {
                sc_pose pose = input_plain_pose(p, count + 1);
                int is_plain;
                for (uint32_t i = 0; i < count; ++i)
                    for (int k = 0; k < 3; ++k)
                        p[3 * (i + 1) + (uint32_t)k] = ldexp((double)r[i][k], -down);
                sc_workspace_new_pose(s.model, s.workspace);
                CHECK(sc_positions_read(s.model, &pose, 24, s.workspace) == SC_OK);
                is_plain = sc_fan_test(s.model, s.workspace, sc_model_triangle(s.model)[0]);
                CHECK_MSG(!is_plain || exact, "at 2^-%d; started at %" PRIu64, down, state);
            }
            for (int k = 0; k < 3; ++k) /* and the same fan where nothing underflows */
                for (uint32_t i = 0; i < count; ++i) p[3 * (i + 1) + (uint32_t)k] = (double)r[i][k];
            {
                sc_pose pose = input_plain_pose(p, count + 1);
                sc_workspace_new_pose(s.model, s.workspace);
                CHECK(sc_positions_read(s.model, &pose, 24, s.workspace) == SC_OK);
                plain += (uint32_t)sc_fan_test(s.model, s.workspace, sc_model_triangle(s.model)[0]);
            }
        }
        close_scene(&s);
    }
    CHECK_MSG(plain > 1000 && upright >= plain, "%" PRIu32 " of %" PRIu32, plain, upright);
}

/* Whether a fan round vertex 0 is plain in this pose. */
static int is_plain_at(scene *s, double *p, uint32_t vertex_count)
{
    sc_pose pose = input_plain_pose(p, vertex_count);
    sc_workspace_new_pose(s->model, s->workspace);
    CHECK(sc_positions_read(s->model, &pose, 24, s->workspace) == SC_OK);
    return sc_fan_test(s->model, s->workspace, sc_model_triangle(s->model)[0]);
}

/* Fans of so large a size that areas along the sum of their normals, products of four coordinates,
   overflow in part. None is plain that is not where it is small. */
static void fans_that_overflow(void)
{
    static const double axes[3][3] = {{1, -1, 0}, {0.5, 0.5, -1}, {1, 1, 1}};
    uint32_t corners[18], large = 0, small = 0, count = 5;
    double p[24];
    soup mesh = {count + 1, count, p, corners};
    scene s;
    for (uint32_t i = 0; i < count; ++i) {
        corners[3 * i] = 0;
        corners[3 * i + 1] = 1 + i;
        corners[3 * i + 2] = 1 + (i + 1) % count;
    }
    memset(p, 0, sizeof(p));
    if (!open_scene(&s, &mesh)) return;
    for (uint32_t round = 0; round < test_iterations(300000); ++round) {
        uint64_t state = test_random_state();
        int exponent = 253 + (int)test_random_below(4), is_large, is_small;
        for (uint32_t i = 0; i < count; ++i) {
            double angle = 6.283185307179586 * (i + test_random_unit()) / count;
            double at[3] = {cos(angle) * test_random_range(0.2, 1.2),
                            sin(angle) * test_random_range(0.2, 1.2), test_random_range(-1, 1)};
            double *corner = p + 3 * ((size_t)i + 1);
            for (int k = 0; k < 3; ++k)
                corner[k] = at[0] * axes[0][k] + at[1] * axes[1][k] + at[2] * axes[2][k];
            corner[test_random_below(3)] *= test_random_range(1, 3);
        }
        is_small = is_plain_at(&s, p, count + 1);
        for (uint32_t i = 3; i < 3 * (count + 1); ++i) p[i] = ldexp(p[i], exponent);
        is_large = is_plain_at(&s, p, count + 1);
        large += (uint32_t)is_large;
        small += (uint32_t)is_small;
        CHECK_MSG(!is_large || is_small, "at 2^%d; started at %" PRIu64, exponent, state);
    }
    CHECK_MSG(large > small / 10 && small > large, "%" PRIu32 " of %" PRIu32, large, small);
    close_scene(&s);
}

SC_TEST_MAIN(SC_TEST(flat_pairs), SC_TEST(fans), SC_TEST(fans_that_overflow))
