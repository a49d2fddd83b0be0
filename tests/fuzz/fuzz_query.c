/*
 * Fuzz target: sc_query. A small mesh, built in some way, and a series of poses and questions on
 * one workspace: vertices at any places (huge, denormal, infinite or no numbers), all types and
 * strides, options right and wrong, all instruction sets, arrays too short. Every answer is
 * compared with the oracle's.
 *
 * SPDX-License-Identifier: MIT
 */
#define _POSIX_C_SOURCE 200112L /* posix_memalign: the workspace ends where it ends */

#include "fuzz_support.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "simd/isa.h"
#include "harness.h"

enum { MAXIMUM_POSES = 4, MAXIMUM_QUERIES = 5 };

typedef struct subject {
    soup mesh;
    double *positions; /* of the pose */
    uint32_t *weld;
    uint8_t
        used[256]; /* whether a triangle uses the vertex, or its representative stands for one */
    sc_model *model;
    sc_workspace *workspace;
} subject;

/* Changes the pose: back to rest, a few coordinates, or one of the deformers. */
static void change_pose(fuzz_bytes *bytes, subject *s)
{
    uint32_t how = fuzz_byte(bytes), count = s->mesh.vertex_count, edits = how / 8 % 8;
    if (how & 4) memcpy(s->positions, s->mesh.positions, 3 * count * sizeof(double));
    if (how & 64) {
        for (uint32_t i = 0; i < 3 * count; ++i) /* deformers compute: they want numbers */
            if (!isfinite(s->positions[i])) s->positions[i] = 0;
        test_random_reset(fuzz_byte(bytes));
        soup_any_pose(s->positions, count);
    }
    if (how & 128) soup_scale(s->positions, count, ldexp(1, (int)fuzz_byte(bytes) - 128));
    for (; edits > 0; --edits) {
        uint32_t at = fuzz_byte(bytes) % count, kind = fuzz_byte(bytes);
        for (uint32_t k = 0; k < 3; ++k)
            if (kind >> (5 + k) & 1)
                s->positions[3 * at + k] = fuzz_coordinate(bytes, kind % 32 % FUZZ_KINDS);
    }
}

static int is_for_boxes(const sc_model *model)
{
    sc_model_info info;
    memset(&info, 0, sizeof(info));
    info.struct_size = sizeof(info);
    return sc_model_get_info(model, &info) == SC_OK && info.node_count == 0;
}

static int is_finite_where_used(const subject *s)
{
    for (uint32_t i = 0; i < 3 * s->mesh.vertex_count; ++i)
        if (s->used[i / 3] && !isfinite(s->positions[i])) return 0;
    return 1;
}

/* Any query on a pose that is not finite, or with wrong options, must fail and leave no trace. */
static void check_refusal(const subject *s, const sc_pose *pose, const sc_query_options *options,
                          sc_status expected)
{
    sc_pair pair = {7, 8};
    sc_result result;
    sc_status status;
    memset(&result, 0, sizeof(result));
    result.struct_size = sizeof(result);
    result.collides = 2;
    result.count = 77;
    result.capacity = 1;
    result.pairs = &pair;
    status = sc_query(s->model, s->workspace, pose, options, &result);
    FUZZ_CHECK(status == expected && result.count == 0 && result.collides == 0 && pair.a == 7 &&
                   pair.b == 8,
               "status %d instead of %d", (int)status, (int)expected);
}

static void ask(fuzz_bytes *bytes, const subject *s, const sc_pose *pose,
                const oracle_answer *expected)
{
    uint32_t kind = fuzz_byte(bytes), how = fuzz_byte(bytes), wrong = kind >= 250;
    uint64_t capacity, count;
    sc_query_options o;
    memset(&o, 0, sizeof(o));
    o.struct_size = sizeof(o);
    o.pairs = kind & 1;
    o.contact = kind >> 1 & 1;
    o.output = kind >> 2 & 7 ? SC_OUTPUT_PAIRS : 1 + (kind >> 7);
    o.method = how % 4;
    o.contour = how / 4 % 16 == 0 ? SC_CONTOUR_NONE
                : how / 4 % 2     ? SC_CONTOUR_STAR
                                  : SC_CONTOUR_EXACT;
    o.rest_cache = how / 64 % 2;
    o.simd = kind / 32 % 4;
    if (o.simd > (uint32_t)sc_isa_best()) o.simd = SC_SIMD_BASE;
    if (is_for_boxes(s->model)) {
        o.method = o.method == SC_METHOD_AABB ? SC_METHOD_AABB : SC_METHOD_DEFAULT;
        o.contour = SC_CONTOUR_DEFAULT;
    }
    if (wrong) {
        uint32_t *member[6] = {&o.output, &o.pairs,   &o.contact,
                               &o.method, &o.contour, &o.rest_cache};
        *(kind - 250 < 6 ? member[kind - 250] : &o.simd) += 4 + how;
        check_refusal(s, pose, &o, SC_ERROR_OPTION);
        return;
    }
    if (expected == NULL) {
        check_refusal(s, pose, &o, SC_ERROR_NOT_FINITE);
        return;
    }
    count = expected->lists[o.pairs][o.contact].count;
    capacity = how & 128 ? fuzz_byte(bytes) : count;
    fuzz_check_query(s->model, s->workspace, pose, &o, capacity, expected);
}

/* Positions as most callers have them: aligned, packed, with nothing behind the last. To be
   freed. */
static void *packed_positions(const subject *s, uint32_t type)
{
    uint32_t count = 3 * s->mesh.vertex_count;
    float *narrow;
    if (type == SC_DOUBLE) return fuzz_copy(s->positions, count * sizeof(double));
    narrow = (float *)test_allocate(count * sizeof(float));
    for (uint32_t i = 0; i < count; ++i) narrow[i] = (float)s->positions[i];
    return narrow;
}

static void ask_all(fuzz_bytes *bytes, subject *s)
{
    for (uint32_t poses = 0; poses < MAXIMUM_POSES && (poses == 0 || bytes->left > 0); ++poses) {
        uint32_t form, count = s->mesh.vertex_count;
        int is_known;
        oracle_answer expected;
        input_array positions;
        void *packed;
        sc_pose pose;
        if (poses > 0) change_pose(bytes, s);
        form = fuzz_byte(bytes);
        if (form & 1) soup_round_to_float(s->positions, count);
        positions =
            input_positions(s->positions, count, form & 1 ? SC_FLOAT : SC_DOUBLE, form / 2 % 8);
        pose = input_pose(count, &positions);
        packed = packed_positions(s, pose.position_type);
        if (!(form & 128)) {
            pose.position_stride = 0;
            pose.positions = packed;
        }
        is_known = is_finite_where_used(s);
        if (is_known)
            expected = fuzz_expect(&s->mesh, s->positions, s->weld, s->model, s->workspace);
        for (uint32_t i = 0; i < MAXIMUM_QUERIES && i <= form / 16 % 8; ++i)
            ask(bytes, s, &pose, is_known ? &expected : NULL);
        if (is_known) oracle_free(&expected);
        input_free(&positions);
        free(packed);
    }
}

int fuzz_query(const uint8_t *data, size_t size)
{
    fuzz_bytes bytes = {data, size};
    uint32_t how = fuzz_byte(&bytes), random = fuzz_byte(&bytes);
    uint64_t workspace_size;
    void *memory = NULL;
    sc_mesh mesh;
    input_choices choices;
    subject s;
    memset(&s, 0, sizeof(s));
    fuzz_number(&bytes, 3); /* stands for what fuzz_build reads here: the same seeds serve both */
    s.mesh = fuzz_mesh(&bytes, 0);
    s.positions = (double *)fuzz_copy(s.mesh.positions, 3 * s.mesh.vertex_count * sizeof(double));
    mesh = input_plain_mesh(&s.mesh);
    test_random_reset(random);
    choices = input_choose(&s.mesh, how % 3, how / 4 % 4);
    s.weld = input_weld_of(&choices, &s.mesh);
    for (uint32_t i = 0; i < 3 * s.mesh.triangle_count; ++i)
        s.used[s.mesh.triangles[i]] = s.used[s.weld[s.mesh.triangles[i]]] = 1;
    if (how & 32) {
        choices.options.content = SC_MODEL_BOXES;
        choices.options.rest = SC_REST_UNMARKED;
    }
    FUZZ_CHECK(sc_build(&mesh, &choices.options, &s.model) == SC_OK, "a good mesh");
    input_free_choices(&choices);
    FUZZ_CHECK(sc_workspace_size(s.model, &workspace_size) == SC_OK, "a good model");
    if (how & 16) {
        if (posix_memalign(&memory, SC_ALIGNMENT, (size_t)workspace_size) != 0) abort();
        memset(memory, (int)random, (size_t)workspace_size);
        FUZZ_CHECK(sc_workspace_init(s.model, memory, workspace_size, &s.workspace) == SC_OK,
                   "%u bytes", (unsigned)workspace_size);
    } else {
        FUZZ_CHECK(sc_workspace_create(s.model, NULL, &s.workspace) == SC_OK, "a good model");
    }
    ask_all(&bytes, &s);
    sc_workspace_free(s.workspace);
    sc_model_free(s.model);
    free(memory);
    free(s.weld);
    free(s.positions);
    soup_free(&s.mesh);
    return 0;
}
