/*
 * What sc_query_near refuses: each wrong argument gets its error, and a message; counts are then 0,
 * arrays as they were, and the next query is right.
 *
 * SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "harness.h"
#include "inputs.h"
#include "near_ask.h"

/* What was logged last, and how often. */
typedef struct near_log {
    char text[256];
    uint32_t count;
} near_log;

static void hear(void *user, uint32_t level, const char *message)
{
    near_log *log = (near_log *)user;
    snprintf(log->text, sizeof(log->text), "%s", message);
    log->count += level == SC_LOG_ERROR;
}

enum { ROOM = 64 };

/* All that a query is given, right as long as nobody changes it. */
typedef struct near_call {
    near_log log;
    sc_hooks hooks;
    soup s;
    double *posed;
    sc_model *model, *other_model, *boxes;
    sc_workspace *workspace, *plain, *step, *other, *for_boxes;
    sc_pose pose;
    sc_near_options options;
    sc_filter filter; /* right, and asked for only where a test says so */
    sc_pair ignore[2];
    double resting[27]; /* a rest pose, likewise */
    sc_pose rest;
    sc_near_result result;
    sc_stats stats;
    sc_pair faces[ROOM], edges[ROOM];
    uint64_t count[2]; /* of the right answer */
} near_call;

static void make_right(near_call *c)
{
    memset(&c->log, 0, sizeof(c->log));
    c->pose = input_plain_pose(c->posed, c->s.vertex_count);
    memset(&c->options, 0, sizeof(c->options));
    c->options.struct_size = sizeof(c->options);
    c->options.distance = 0.4;
    memset(&c->filter, 0, sizeof(c->filter));
    c->filter.struct_size = sizeof(c->filter);
    memcpy(c->resting, c->s.positions, sizeof(c->resting));
    c->rest = input_plain_pose(c->resting, c->s.vertex_count);
    memset(&c->stats, 0, sizeof(c->stats));
    c->stats.struct_size = sizeof(c->stats);
    memset(&c->result, 0, sizeof(c->result));
    c->result.struct_size = sizeof(c->result);
    c->result.found = c->result.verdict = 9;
    c->result.vertex_face_count = c->result.edge_edge_count = 9;
    c->result.vertex_faces = c->faces;
    c->result.vertex_face_capacity = ROOM;
    c->result.edge_edges = c->edges;
    c->result.edge_edge_capacity = ROOM;
    c->result.stats = &c->stats;
    memset(c->faces, 0xab, sizeof(c->faces));
    memset(c->edges, 0xab, sizeof(c->edges));
}

static sc_workspace *workspace_of(near_call *c, const sc_model *model, uint32_t flags)
{
    sc_workspace_options options;
    sc_workspace *workspace = NULL;
    memset(&options, 0, sizeof(options));
    options.struct_size = sizeof(options);
    options.flags = flags;
    if (CHECK(sc_workspace_create_for(model, &options, &workspace) == SC_OK))
        CHECK(sc_workspace_set_hooks(workspace, &c->hooks) == SC_OK);
    return workspace;
}

static sc_status ask(near_call *c)
{
    return sc_query_near(c->model, c->workspace, &c->pose, &c->options, &c->result);
}

static int is_right(near_call *c)
{
    sc_status status;
    make_right(c);
    status = ask(c);
    return status == SC_OK && c->result.vertex_face_count == c->count[0] &&
           c->result.edge_edge_count == c->count[1] && c->log.count == 0;
}

/* Nothing found, nothing written, one message that begins so, or none; and all still works. */
static void expect(near_call *c, sc_status status, sc_status wanted, const char *message, int line)
{
    const unsigned char *bytes[2] = {(const unsigned char *)c->faces,
                                     (const unsigned char *)c->edges};
    CHECK_MSG(status == wanted, "line %d: status %d: %s", line, (int)status, c->log.text);
    CHECK_MSG(c->log.count == (message != NULL) &&
                  (!message || strncmp(c->log.text, message, strlen(message)) == 0),
              "line %d: %u messages, %s", line, c->log.count, c->log.text);
    CHECK_MSG(c->result.found == 0 && c->result.verdict == SC_VERDICT_NONE &&
                  c->result.vertex_face_count == 0 && c->result.edge_edge_count == 0,
              "line %d: an answer", line);
    for (size_t i = 0; i < sizeof(c->faces); ++i)
        if (bytes[0][i] != 0xab || bytes[1][i] != 0xab) {
            CHECK_MSG(0, "line %d: an array is written to", line);
            break;
        }
    CHECK_MSG(is_right(c), "line %d: the next answer is wrong", line);
    make_right(c);
}

static int begin(near_call *c)
{
    sc_build_options build;
    sc_mesh mesh, other;
    soup s;
    memset(c, 0, sizeof(*c));
    c->hooks.struct_size = sizeof(c->hooks);
    c->hooks.log = hear;
    c->hooks.user = &c->log;
    c->s = soup_cloth(2, 2);
    c->posed = soup_copy_positions(&c->s);
    mesh = input_plain_mesh(&c->s);
    s = soup_cloth(3, 2);
    other = input_plain_mesh(&s);
    memset(&build, 0, sizeof(build));
    build.struct_size = sizeof(build);
    build.content = SC_MODEL_BOXES;
    if (!CHECK(sc_build(&mesh, NULL, &c->model) == SC_OK &&
               sc_build(&other, NULL, &c->other_model) == SC_OK &&
               sc_build(&mesh, &build, &c->boxes) == SC_OK))
        return 0;
    soup_free(&s);
    c->workspace = workspace_of(c, c->model, SC_WORKSPACE_NEAR);
    c->plain = workspace_of(c, c->model, 0);
    c->step = workspace_of(c, c->model, SC_WORKSPACE_STEP);
    c->other = workspace_of(c, c->other_model, SC_WORKSPACE_NEAR);
    c->for_boxes = workspace_of(c, c->boxes, SC_WORKSPACE_NEAR);
    make_right(c);
    if (!CHECK(ask(c) == SC_OK)) return 0;
    c->count[0] = c->result.vertex_face_count;
    c->count[1] = c->result.edge_edge_count;
    CHECK(c->count[0] > 2 && c->count[1] > 2 && c->count[0] < ROOM && c->count[1] < ROOM);
    make_right(c);
    return 1;
}

static void end(near_call *c)
{
    sc_workspace_free(c->workspace);
    sc_workspace_free(c->plain);
    sc_workspace_free(c->step);
    sc_workspace_free(c->other);
    sc_workspace_free(c->for_boxes);
    sc_model_free(c->model);
    sc_model_free(c->other_model);
    sc_model_free(c->boxes);
    soup_free(&c->s);
    free(c->posed);
}

#define REFUSED(change, wanted, message)                                                           \
  do {                                                                                             \
    change;                                                                                        \
    expect(&c, ask(&c), wanted, message, __LINE__);                                                \
  } while (0)

static void options_and_results(void)
{
    near_call c;
    if (begin(&c)) {
        REFUSED(c.options.struct_size = 4, SC_ERROR_STRUCT_SIZE, "options.struct_size is 4");
        REFUSED(c.options.output = 3, SC_ERROR_OPTION, "options.output is 3, but at most 2");
        REFUSED(c.options.kinds = 3, SC_ERROR_OPTION, "options.kinds is 3, but at most 2");
        REFUSED(c.options.method = 3, SC_ERROR_OPTION, "options.method is 3, but at most 2");
        REFUSED(c.options.simd = 4, SC_ERROR_OPTION, "options.simd is 4, but at most 3");
        REFUSED(c.options.reserved = 1, SC_ERROR_OPTION, "options.reserved is 1, but at most 0");
        REFUSED(c.options.distance = -0.5, SC_ERROR_OPTION,
                "options.distance is -0.5, but finite and at least 0");
        REFUSED(c.options.distance = -0x1p-1074, SC_ERROR_OPTION, "options.distance is -");
        REFUSED(c.options.distance = HUGE_VAL, SC_ERROR_OPTION, "options.distance is inf");
        REFUSED(c.options.distance = (double)NAN, SC_ERROR_OPTION, "options.distance is");
        REFUSED(c.options.rest_distance = -1, SC_ERROR_OPTION, "options.rest_distance is -1");
        REFUSED(c.options.rest_distance = (double)NAN, SC_ERROR_OPTION, "options.rest_distance is");
        REFUSED(c.result.vertex_faces = NULL, SC_ERROR_NULL, "result.vertex_faces is NULL");
        REFUSED(c.result.edge_edges = NULL, SC_ERROR_NULL, "result.edge_edges is NULL");
        REFUSED(c.stats.struct_size = 3, SC_ERROR_STRUCT_SIZE, "result.stats.struct_size is 3");
        c.result.struct_size = 12;
        CHECK(ask(&c) == SC_ERROR_STRUCT_SIZE && c.log.count == 1);
        CHECK(strncmp(c.log.text, "result.struct_size is 12", 24) == 0);
        CHECK(is_right(&c));
        make_right(&c);
        c.options.distance = -0.0; /* is 0 */
        CHECK(ask(&c) == SC_OK && c.result.vertex_face_count == 0);
    }
    end(&c);
}

static void models_workspaces_and_poses(void)
{
    near_call c;
    if (begin(&c)) {
        sc_near_result *r = &c.result;
        expect(&c, sc_query_near(NULL, c.workspace, &c.pose, &c.options, r), SC_ERROR_NULL,
               "model is NULL", __LINE__);
        expect(&c, sc_query_near(c.model, c.workspace, NULL, &c.options, r), SC_ERROR_NULL,
               "pose is NULL", __LINE__);
        CHECK(sc_query_near(c.model, NULL, &c.pose, &c.options, r) == SC_ERROR_NULL &&
              r->vertex_face_count == 0 && r->verdict == SC_VERDICT_NONE);
        make_right(&c);
        CHECK(sc_query_near(c.model, c.workspace, &c.pose, &c.options, NULL) == SC_ERROR_NULL &&
              strcmp(c.log.text, "result is NULL") == 0);
        CHECK(is_right(&c));
        make_right(&c);
        expect(&c, sc_query_near(c.model, c.plain, &c.pose, &c.options, r), SC_ERROR_WORKSPACE, "",
               __LINE__);
        expect(&c, sc_query_near(c.model, c.step, &c.pose, &c.options, r), SC_ERROR_WORKSPACE, "",
               __LINE__);
        expect(&c, sc_query_near(c.model, c.other, &c.pose, &c.options, r), SC_ERROR_WORKSPACE, "",
               __LINE__);
        REFUSED(c.pose.vertex_count = 10, SC_ERROR_VERTEX_COUNT,
                "pose.vertex_count is 10, but the model has 9");
        REFUSED(c.pose.positions = NULL, SC_ERROR_NULL, "pose.positions is NULL");
        REFUSED(c.pose.position_type = 5, SC_ERROR_OPTION, "pose.position_type is 5");
        REFUSED(c.pose.position_stride = 16, SC_ERROR_STRIDE, "pose.position_stride is 16");
        REFUSED(c.pose.struct_size = 8, SC_ERROR_STRUCT_SIZE, "pose.struct_size is 8");
        for (uint32_t i = 0; i < 27; ++i) {
            const double before = c.posed[i];
            c.posed[i] = i % 2 ? (double)NAN : HUGE_VAL;
            char message[64];
            snprintf(message, sizeof message, "vertex %u is NaN or infinite", i / 3);
            c.log.count = 0;
            CHECK(ask(&c) == SC_ERROR_NOT_FINITE && c.result.vertex_face_count == 0 &&
                  c.result.verdict == SC_VERDICT_NONE);
            CHECK_MSG(c.log.count == 1 && strcmp(c.log.text, message) == 0, "%u messages, %s",
                      c.log.count, c.log.text);
            c.posed[i] = before;
            CHECK(is_right(&c));
            make_right(&c);
        }
        c.options.method = SC_NEAR_METHOD_SCTT;
        expect(&c, sc_query_near(c.boxes, c.for_boxes, &c.pose, &c.options, r), SC_ERROR_BOXES_ONLY,
               NULL, __LINE__);
        c.options.method = SC_NEAR_METHOD_DEFAULT;
        CHECK(sc_query_near(c.boxes, c.for_boxes, &c.pose, &c.options, r) == SC_OK &&
              r->vertex_face_count == c.count[0] && r->edge_edge_count == c.count[1]);
    }
    end(&c);
}

/* The filter of vertices and faces, that of edges, and the rest pose. */
static void filters_and_rest(void)
{
    const uint32_t half = sizeof(void *) / 2; /* less than any structure may have */
    near_call c;
    char text[200];
#define FACES(change) (c.options.vertex_face_filter = &c.filter, change)
#define EDGES(change) (c.options.edge_edge_filter = &c.filter, change)
#define REST(change) (c.options.rest = &c.rest, c.options.rest_distance = 0.1, change)
#define IGNORE(x, y)                                                                               \
  (c.ignore[0].a = x, c.ignore[0].b = y, c.filter.ignore = c.ignore, c.filter.ignore_count = 1)
    if (!begin(&c)) {
        end(&c);
        return;
    }
    snprintf(text, sizeof(text), "options.vertex_face_filter.struct_size is %u, but at least %u",
             (unsigned)half, (unsigned)sizeof(void *));
    REFUSED(FACES(c.filter.struct_size = half), SC_ERROR_STRUCT_SIZE, text);
    snprintf(text, sizeof(text), "options.edge_edge_filter.struct_size is %u, but at least",
             (unsigned)half);
    REFUSED(EDGES(c.filter.struct_size = half), SC_ERROR_STRUCT_SIZE, text);
    REFUSED(FACES(c.filter.ignore_rings = SC_RINGS_MAX + 1), SC_ERROR_OPTION,
            "options.vertex_face_filter.ignore_rings is 33, but at most 32");
    REFUSED(EDGES(c.filter.ignore_rings = SC_RINGS_MAX + 1), SC_ERROR_OPTION,
            "options.edge_edge_filter.ignore_rings is 33, but at most 32");
    REFUSED(FACES(c.filter.ignore_count = 1), SC_ERROR_NULL,
            "options.vertex_face_filter.ignore is NULL");
    REFUSED(EDGES(c.filter.ignore_count = 1), SC_ERROR_NULL,
            "options.edge_edge_filter.ignore is NULL");
    /* nine vertices, eight triangles */
    REFUSED(FACES(IGNORE(9, 0)), SC_ERROR_PAIRS,
            "options.vertex_face_filter.ignore[0] is no pair of this model");
    REFUSED(FACES(IGNORE(8, 8)), SC_ERROR_PAIRS,
            "options.vertex_face_filter.ignore[0] is no pair of this model");
    REFUSED(EDGES(IGNORE(5, 24)), SC_ERROR_PAIRS,
            "options.edge_edge_filter.ignore[0] is no pair of this model");
    REFUSED(EDGES(IGNORE(5, 5)), SC_ERROR_PAIRS,
            "options.edge_edge_filter.ignore[0] is no pair of this model");
    c.ignore[1].a = 1;
    c.ignore[1].b = 2;
    REFUSED(FACES((IGNORE(1, 3), c.filter.ignore_count = 2)), SC_ERROR_PAIRS,
            "options.vertex_face_filter.ignore[1] comes before the one before it");
    REFUSED(EDGES((IGNORE(1, 3), c.filter.ignore_count = 2)), SC_ERROR_PAIRS,
            "options.edge_edge_filter.ignore[1] comes before the one before it");
    REFUSED(c.options.rest_distance = 0.5, SC_ERROR_NULL, "options.rest is NULL");
    REFUSED(REST(c.options.rest_distance = -1), SC_ERROR_OPTION,
            "options.rest_distance is -1, but finite and at least 0");
    REFUSED(REST(c.options.rest_distance = HUGE_VAL), SC_ERROR_OPTION,
            "options.rest_distance is inf");
    REFUSED(REST(c.rest.struct_size = 8), SC_ERROR_STRUCT_SIZE, "options.rest.struct_size is 8");
    REFUSED(REST(c.rest.vertex_count = 8), SC_ERROR_VERTEX_COUNT,
            "options.rest.vertex_count is 8, but the model has 9");
    REFUSED(REST(c.rest.positions = NULL), SC_ERROR_NULL, "options.rest.positions is NULL");
    REFUSED(REST(c.rest.position_type = 2), SC_ERROR_OPTION,
            "options.rest.position_type is 2, but at most 1");
    REFUSED(REST(c.rest.position_stride = 23), SC_ERROR_STRIDE,
            "options.rest.position_stride is 23, but 0 or at least 24");
    for (int i = 0; i < 27; ++i) {
        snprintf(text, sizeof(text), "vertex %d is NaN or infinite in the rest pose", i / 3);
        REFUSED(REST(c.resting[i] = i % 2 ? (double)NAN : HUGE_VAL), SC_ERROR_NOT_FINITE, text);
    }
    /* the last of each that is right, and an empty filter */
    (void)FACES(IGNORE(8, 7));
    CHECK(ask(&c) == SC_OK && c.log.count == 0);
    make_right(&c);
    (void)EDGES(IGNORE(22, 23));
    CHECK(ask(&c) == SC_OK && c.log.count == 0);
    make_right(&c);
    (void)EDGES(c.options.vertex_face_filter = &c.filter);
    CHECK(ask(&c) == SC_OK && c.log.count == 0 && c.result.vertex_face_count == c.count[0] &&
          c.result.edge_edge_count == c.count[1]);
    make_right(&c);
    (void)REST(c.options.rest_distance = 0);
    CHECK(ask(&c) == SC_OK && c.log.count == 0);
    /* what leaves out all */
    make_right(&c);
    (void)REST(c.options.rest_distance = 9);
    CHECK(ask(&c) == SC_OK && c.result.vertex_face_count == 0 && c.result.edge_edge_count == 0 &&
          c.result.verdict == SC_VERDICT_CLEAN);
    end(&c);
}

/* Masks of another model, and a bound for each vertex where one pair is enough. */
static void masks_and_bounds(void)
{
    near_call c;
    sc_near_masks *masks = NULL;
    double bounds[9] = {7, 7, 7, 7, 7, 7, 7, 7, 7};
    if (begin(&c)) {
        CHECK(sc_near_masks_create(c.other_model, 2, NULL, &masks) == SC_OK);
        REFUSED(c.options.masks = masks, SC_ERROR_OPTION, "options.masks are of another model");
        sc_near_masks_free(masks);
        c.options.output = SC_OUTPUT_ANY;
        REFUSED(c.result.vertex_bounds = bounds, SC_ERROR_OPTION,
                "result.vertex_bounds are not known from any pair");
        for (int i = 0; i < 9; ++i) CHECK(bounds[i] == 7);
    }
    end(&c);
}

/* Without options: those that touch, of both kinds. Without arrays: numbers and an error.
   Workspaces for this serve queries and steps as well. */
static void what_may_be_left_out(void)
{
    near_call c;
    if (begin(&c)) {
        sc_result plain;
        sc_step_result step;
        CHECK(sc_query_near(c.model, c.workspace, &c.pose, NULL, &c.result) == SC_OK &&
              c.result.found == 0 && c.result.verdict == SC_VERDICT_CLEAN);
        make_right(&c);
        c.result.stats = NULL;
        c.result.vertex_faces = c.result.edge_edges = NULL;
        c.result.vertex_face_capacity = c.result.edge_edge_capacity = 0;
        CHECK(ask(&c) == SC_ERROR_SHORT_BUFFER && c.result.vertex_face_count == c.count[0] &&
              c.result.edge_edge_count == c.count[1] && c.result.verdict == SC_VERDICT_FOUND);
        c.options.output = SC_OUTPUT_COUNT;
        c.result.vertex_face_capacity = 5; /* no array is looked at */
        CHECK(ask(&c) == SC_OK && c.result.vertex_face_count == c.count[0]);
        memset(&plain, 0, sizeof(plain));
        plain.struct_size = sizeof(plain);
        CHECK(sc_query(c.model, c.workspace, &c.pose, NULL, &plain) == SC_OK && plain.count == 0);
        memset(&step, 0, sizeof(step));
        step.struct_size = sizeof(step);
        CHECK(sc_query_step(c.model, c.workspace, &c.pose, &c.pose, NULL, &step) == SC_OK);
        CHECK(is_right(&c));
    }
    end(&c);
}

SC_TEST_MAIN(SC_TEST(options_and_results), SC_TEST(models_workspaces_and_poses),
             SC_TEST(filters_and_rest), SC_TEST(masks_and_bounds), SC_TEST(what_may_be_left_out))
