/*
 * The character of sc-dataset: a closed, oriented manifold that does not meet itself at rest, of as
 * many triangles as were asked for; poses that are the same for one number, differ between numbers,
 * stay in reach and keep bones' lengths; and some that collide and some that do not.
 *
 * SPDX-License-Identifier: MIT
 */
#include "harness.h"
#include "scenes/character.h"
#include "starcontour.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct side {
    uint32_t from, to;
} side;

static int compare_sides(const void *a, const void *b)
{
    const side *const x = (const side *)a, *const y = (const side *)b;
    if (x->from != y->from) return x->from < y->from ? -1 : 1;
    return (x->to > y->to) - (x->to < y->to);
}

/* Each side of a triangle is there once in each direction, so that all is closed and oriented; and
   vertices - edges + triangles is 2: one piece without holes. */
static void surface_is_closed(void)
{
    const uint32_t sizes[] = {2000, 3000, 5000, 25000};
    for (size_t s = 0; s < sizeof sizes / sizeof *sizes; s++) {
        character body;
        side *sides[2];
        size_t count;
        if (!CHECK(character_make(&body, sizes[s]))) return;
        count = 3 * (size_t)body.triangle_count;
        CHECK_MSG(fabs((double)body.triangle_count / sizes[s] - 1) <= 0.02, "%u triangles, not %u",
                  body.triangle_count, sizes[s]);
        CHECK(2 * (size_t)body.vertex_count - body.triangle_count == 4);
        for (int k = 0; k < 2; k++) {
            sides[k] = (side *)malloc(count * sizeof(side));
            for (size_t i = 0; i < count; i++) {
                const uint32_t a = body.triangles[i];
                const uint32_t b = body.triangles[i / 3 * 3 + (i + 1) % 3];
                sides[k][i].from = k ? b : a;
                sides[k][i].to = k ? a : b;
            }
            qsort(sides[k], count, sizeof(side), compare_sides);
        }
        CHECK(memcmp(sides[0], sides[1], count * sizeof(side)) == 0);
        for (size_t i = 1; i < count; i++)
            if (!CHECK(compare_sides(&sides[0][i - 1], &sides[0][i]) < 0)) break;
        free(sides[0]);
        free(sides[1]);
        character_free(&body);
    }
}

/* Six times the volume inside is positive where triangles are counter-clockwise from outside. */
static void triangles_face_outwards(void)
{
    character body;
    double volume = 0;
    if (!CHECK(character_make(&body, 2000))) return;
    for (size_t t = 0; t < body.triangle_count; t++) {
        const float *p[3];
        for (size_t k = 0; k < 3; k++) p[k] = body.rest + 3 * (size_t)body.triangles[3 * t + k];
        for (int k = 0; k < 3; k++) {
            const int i = (k + 1) % 3, j = (k + 2) % 3;
            volume += (double)p[0][k] *
                      ((double)p[1][i] * (double)p[2][j] - (double)p[1][j] * (double)p[2][i]);
        }
    }
    CHECK_MSG(volume > 0.3 && volume < 0.8, "six times the volume: %g", volume);
    character_free(&body);
}

/* The number of pairs in a pose. */
static uint64_t pairs_in(const sc_model *model, sc_workspace *workspace, const character *body,
                         const float *positions)
{
    sc_query_options options;
    sc_result result;
    sc_pose pose;
    memset(&options, 0, sizeof options);
    options.struct_size = sizeof options;
    options.output = SC_OUTPUT_COUNT;
    memset(&pose, 0, sizeof pose);
    pose.struct_size = sizeof pose;
    pose.vertex_count = body->vertex_count;
    pose.position_type = SC_FLOAT;
    pose.positions = positions;
    memset(&result, 0, sizeof result);
    result.struct_size = sizeof result;
    CHECK(sc_query(model, workspace, &pose, &options, &result) == SC_OK);
    return result.count;
}

static void limbs_sometimes_touch(void)
{
    enum { POSES = 200 };
    character body;
    sc_mesh mesh;
    sc_build_options options;
    sc_model *model = NULL;
    sc_workspace *workspace = NULL;
    uint32_t colliding = 0;
    float *positions;
    if (!CHECK(character_make(&body, 5000))) return;
    positions = (float *)malloc(3 * sizeof(float) * body.vertex_count);
    memset(&mesh, 0, sizeof mesh);
    mesh.struct_size = sizeof mesh;
    mesh.vertex_count = body.vertex_count;
    mesh.triangle_count = body.triangle_count;
    mesh.position_type = SC_FLOAT;
    mesh.positions = body.rest;
    mesh.indices = body.triangles;
    memset(&options, 0, sizeof options);
    options.struct_size = sizeof options;
    options.weld = SC_WELD_NONE;
    if (CHECK(positions && sc_build(&mesh, &options, &model) == SC_OK) &&
        CHECK(sc_workspace_create(model, NULL, &workspace) == SC_OK)) {
        CHECK(pairs_in(model, workspace, &body, body.rest) == 0);
        for (uint64_t number = 0; number < POSES; number++) {
            character_pose(&body, number, positions);
            colliding += pairs_in(model, workspace, &body, positions) > 0;
        }
        CHECK_MSG(colliding > POSES / 4 && colliding < POSES * 9 / 10, "%u of %d collide",
                  colliding, POSES);
    }
    sc_workspace_free(workspace);
    sc_model_free(model);
    free(positions);
    character_free(&body);
}

static double far_apart(const float *positions, uint32_t a, uint32_t b)
{
    double sum = 0;
    for (uint32_t k = 0; k < 3; k++) {
        const double x =
            (double)positions[3 * (size_t)a + k] - (double)positions[3 * (size_t)b + k];
        sum += x * x;
    }
    return sqrt(sum);
}

/* The tips of both hands are where x is least and greatest: a tip and the vertex nearest to it
   follow one bone. */
static void poses_follow_their_numbers(void)
{
    character body;
    float *poses[3];
    uint32_t tip = 0, near;
    double before, moved = 0, farthest = 0;
    if (!CHECK(character_make(&body, 3000))) return;
    for (int k = 0; k < 3; k++) poses[k] = (float *)malloc(3 * sizeof(float) * body.vertex_count);
    character_pose(&body, 7, poses[0]);
    character_pose(&body, 8, poses[1]);
    character_pose(&body, 7, poses[2]);
    CHECK(memcmp(poses[0], poses[2], 3 * sizeof(float) * body.vertex_count) == 0);
    for (uint32_t v = 0; v < body.vertex_count; v++) {
        if (body.rest[3 * (size_t)v] > body.rest[3 * (size_t)tip]) tip = v;
        for (size_t k = 0; k < 3; k++)
            farthest = fmax(farthest, fabs((double)poses[0][3 * (size_t)v + k]));
    }
    CHECK_MSG(farthest > 0.5 && farthest < 3, "a coordinate of %g", farthest);
    near = tip ? 0 : 1;
    for (uint32_t v = 0; v < body.vertex_count; v++)
        if (v != tip && far_apart(body.rest, v, tip) < far_apart(body.rest, near, tip)) near = v;
    before = far_apart(body.rest, tip, near);
    for (int k = 0; k < 2; k++)
        CHECK_MSG(fabs(far_apart(poses[k], tip, near) - before) < 1e-5, "%.9g was %.9g",
                  far_apart(poses[k], tip, near), before);
    for (size_t k = 0; k < 3; k++)
        moved +=
            fabs((double)poses[0][3 * (size_t)tip + k] - (double)poses[1][3 * (size_t)tip + k]);
    CHECK_MSG(moved > 0.01, "the hand moved by %g", moved);
    for (int k = 0; k < 3; k++) free(poses[k]);
    character_free(&body);
}

SC_TEST_MAIN(SC_TEST(surface_is_closed), SC_TEST(triangles_face_outwards),
             SC_TEST(limbs_sometimes_touch), SC_TEST(poses_follow_their_numbers))
