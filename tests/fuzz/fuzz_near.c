/*
 * Fuzz target: sc_query_near. A small mesh, built in some way, in poses of any coordinates and with
 * any distances; each answer is compared with that of boxes and plain C, and those of few triangles
 * with the oracle's.
 *
 * SPDX-License-Identifier: MIT
 */
#include "fuzz_support.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "harness.h"
#include "near_ask.h"
#include "simd/isa.h"

enum { MOST_POSES = 3, MOST_TRIANGLES = 30 };

typedef struct fuzz_scene {
    const soup *mesh;
    const uint32_t *weld;
    const double *positions;
    near_question q;
    int is_finite;
} fuzz_scene;

/* 0 or more and finite, or, seldom, anything. */
static double take_distance(fuzz_bytes *bytes)
{
    const uint32_t kind = fuzz_byte(bytes);
    const double d = fuzz_coordinate(bytes, kind % FUZZ_KINDS);
    if (kind >= 250) return d;
    return isfinite(d) ? fabs(d) : 1e308;
}

static void ask_once(fuzz_bytes *bytes, const fuzz_scene *s)
{
    const uint32_t how = fuzz_byte(bytes);
    const double distance = take_distance(bytes);
    near_way way = {"fuzzed", how % 3, how / 4 % 4};
    sc_near_options options;
    near_answer boxes, other;
    if (way.simd > (uint32_t)sc_isa_best()) way.simd = SC_SIMD_BASE;
    options = near_options_for(&near_ways[4], distance);
    if (!(distance >= 0 && distance <= DBL_MAX) || !s->is_finite) {
        other = near_ask(&s->q, &options, 3, 3);
        FUZZ_CHECK(other.status == (distance >= 0 && distance <= DBL_MAX ? SC_ERROR_NOT_FINITE
                                                                         : SC_ERROR_OPTION) &&
                       other.count[0] == 0 && other.count[1] == 0,
                   "status %d", (int)other.status);
        near_answer_free(&other);
        return;
    }
    options.kinds = how / 16 % 3;
    boxes = near_ask_all(&s->q, &options);
    options.method = way.method;
    options.simd = way.simd;
    other = near_ask(&s->q, &options, boxes.count[0], boxes.count[1]);
    FUZZ_CHECK(near_answers_are_same(&boxes, &other), "distance %a", distance);
    near_answer_free(&other);
    options.output = SC_OUTPUT_COUNT;
    other = near_ask(&s->q, &options, 0, 0);
    FUZZ_CHECK(other.status == SC_OK && other.count[0] == boxes.count[0] &&
                   other.count[1] == boxes.count[1],
               "distance %a", distance);
    near_answer_free(&other);
    if (s->mesh->triangle_count <= MOST_TRIANGLES && options.kinds == SC_NEAR_BOTH) {
        step_motion m = step_motion_make(s->mesh, s->positions, s->positions, s->weld);
        for (int kind = 0; kind < STEP_KINDS; ++kind) {
            oracle_list list = near_truth_find(&m, kind, distance);
            FUZZ_CHECK(list.count == boxes.count[kind] &&
                           (!list.count || memcmp(list.pairs, boxes.pairs[kind],
                                                  (size_t)list.count * sizeof(sc_pair)) == 0),
                       "distance %a", distance);
            free(list.pairs);
        }
        step_motion_free(&m);
    }
    near_answer_free(&boxes);
}

int fuzz_near(const uint8_t *data, size_t size)
{
    fuzz_bytes bytes = {data, size};
    const uint32_t how = fuzz_byte(&bytes), random = fuzz_byte(&bytes);
    sc_model *model = NULL;
    double *positions;
    uint32_t *weld;
    soup mesh;
    sc_mesh input;
    input_choices choices;
    fuzz_scene s;
    fuzz_number(&bytes, 3); /* as in fuzz_query: the same seeds serve both */
    mesh = fuzz_mesh(&bytes, 0);
    input = input_plain_mesh(&mesh);
    test_random_reset(random);
    choices = input_choose(&mesh, how % 3, how / 4 % 4);
    weld = input_weld_of(&choices, &mesh);
    FUZZ_CHECK(sc_build(&input, &choices.options, &model) == SC_OK, "a good mesh");
    positions = (double *)fuzz_copy(mesh.positions, 3 * mesh.vertex_count * sizeof(double));
    memset(&s, 0, sizeof(s));
    s.mesh = &mesh;
    s.weld = weld;
    s.positions = positions;
    s.q.name = "fuzzed";
    s.q.model = model;
    s.q.workspace = near_workspace(model, 1);
    for (uint32_t i = 0; i < MOST_POSES && (i == 0 || bytes.left > 0); ++i) {
        sc_pose pose = input_plain_pose(positions, mesh.vertex_count);
        for (uint32_t edits = i == 0 ? 0 : fuzz_byte(&bytes) % 8; edits > 0; --edits) {
            const uint32_t at = fuzz_byte(&bytes) % (3 * mesh.vertex_count);
            positions[at] = fuzz_coordinate(&bytes, fuzz_byte(&bytes) % FUZZ_KINDS);
        }
        s.q.pose = &pose;
        s.is_finite = 1;
        for (uint32_t t = 0; t < 3 * mesh.triangle_count; ++t)
            for (uint32_t k = 0; k < 3; ++k)
                s.is_finite &= isfinite(positions[3 * weld[mesh.triangles[t]] + k]) != 0;
        for (uint32_t k = 0; k < 3; ++k) ask_once(&bytes, &s);
    }
    sc_workspace_free(s.q.workspace);
    sc_model_free(model);
    input_free_choices(&choices);
    free(positions);
    free(weld);
    soup_free(&mesh);
    return 0;
}
