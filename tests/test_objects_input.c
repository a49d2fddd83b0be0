/*
 * What sc_query_objects, sc_query_objects_near and sc_query_objects_step refuse: each wrong
 * argument gets its error, and where it is an object's a message; counts are then 0, arrays as they
 * were, and the next answer is right.
 *
 * SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "harness.h"
#include "inputs.h"
#include "soups.h"
#include "starcontour.h"

/* What was logged last, and how often. */
typedef struct objects_log {
    char text[256];
    uint32_t count;
} objects_log;

static void hear(void *user, uint32_t level, const char *message)
{
    objects_log *log = (objects_log *)user;
    snprintf(log->text, sizeof(log->text), "%s", message);
    log->count += level == SC_LOG_ERROR;
}

static void *enqueue(void *user, void (*run)(void *context, uint32_t part, uint32_t worker),
                     void *context, uint32_t count)
{
    (void)user;
    for (uint32_t part = 0; part < count; ++part) run(context, part, 0);
    return NULL;
}

static void finish(void *user, void *task)
{
    (void)user;
    (void)task;
}

/* What may be asked. */
enum { QUERY, NEAR, STEP, QUESTIONS };
enum { OBJECTS = 2, LISTS = 2, ROOM = 512 };

/* An object with something of the caller's behind it. */
typedef struct wide_object {
    sc_object object;
    uint64_t own;
} wide_object;

/* All that a call is given, right as long as nobody changes it. */
typedef struct objects_call {
    int about;
    objects_log log;
    sc_hooks hooks;
    soup mesh;
    double *posed[OBJECTS];
    sc_model *model;
    sc_workspace *workspace[OBJECTS];
    sc_pose pose[OBJECTS];
    sc_object object[OBJECTS];
    sc_objects objects;
    sc_query_options query;
    sc_near_options near;
    sc_step_options step;
    sc_filter filter; /* right, as all up to the tasks, and asked for only where a test says so */
    sc_near_masks *masks;
    sc_tasks tasks;
    sc_objects_result result;
    sc_objects_lists lists;
    sc_pair pairs[LISTS][ROOM];
    sc_object_pairs ranges[LISTS][ROOM];
    uint64_t count[QUESTIONS][LISTS]; /* of right answers */
} objects_call;

#define SIZED(structure)                                                                           \
  (memset(&(structure), 0, sizeof(structure)), (structure).struct_size = sizeof(structure))

static void give_list(objects_call *c, int i, sc_object_list *list)
{
    list->count = list->range_count = 9;
    list->capacity = list->range_capacity = ROOM;
    list->pairs = c->pairs[i];
    list->ranges = c->ranges[i];
}

static void make_right(objects_call *c)
{
    memset(&c->log, 0, sizeof(c->log));
    memset(c->object, 0, sizeof(c->object));
    for (int i = 0; i < OBJECTS; ++i) {
        c->pose[i] = input_plain_pose(c->posed[i], c->mesh.vertex_count);
        c->object[i].model = c->model;
        c->object[i].workspace = c->workspace[i];
        c->object[i].pose = &c->pose[i];
        c->object[i].itself = 1;
    }
    SIZED(c->objects);
    c->objects.count = OBJECTS;
    c->objects.objects = c->object;
    SIZED(c->query);
    SIZED(c->near);
    c->near.distance = 0.2;
    SIZED(c->step);
    c->step.separation = 0.2;
    SIZED(c->filter);
    SIZED(c->tasks);
    c->tasks.workers = 2;
    c->tasks.enqueue = enqueue;
    c->tasks.finish = finish;
    memset(c->pairs, 0xab, sizeof(c->pairs));
    memset(c->ranges, 0xab, sizeof(c->ranges));
    SIZED(c->result);
    c->result.collides = c->result.verdict = 9;
    c->result.count = c->result.range_count = 9;
    c->result.capacity = c->result.range_capacity = ROOM;
    c->result.pairs = c->pairs[0];
    c->result.ranges = c->ranges[0];
    SIZED(c->lists);
    c->lists.collides = c->lists.verdict = 9;
    give_list(c, 0, &c->lists.vertex_faces);
    give_list(c, 1, &c->lists.edge_edges);
}

static sc_status ask(objects_call *c)
{
    if (c->about == NEAR) return sc_query_objects_near(&c->objects, &c->near, &c->lists);
    if (c->about == STEP) return sc_query_objects_step(&c->objects, &c->step, &c->lists);
    return sc_query_objects(&c->objects, &c->query, &c->result);
}

static uint64_t count_of(const objects_call *c, int i)
{
    if (c->about == QUERY) return i ? 0 : c->result.count;
    return i ? c->lists.edge_edges.count : c->lists.vertex_faces.count;
}

static uint64_t range_count_of(const objects_call *c, int i)
{
    if (c->about == QUERY) return i ? 0 : c->result.range_count;
    return i ? c->lists.edge_edges.range_count : c->lists.vertex_faces.range_count;
}

/* Whether an answer is that of what is right. */
static int is_answer_right(const objects_call *c, sc_status status)
{
    return status == SC_OK && count_of(c, 0) == c->count[c->about][0] &&
           count_of(c, 1) == c->count[c->about][1] && c->log.count == 0;
}

static int is_right(objects_call *c)
{
    make_right(c);
    return is_answer_right(c, ask(c));
}

static int is_noise(const void *memory, size_t size)
{
    const unsigned char *bytes = (const unsigned char *)memory;
    for (size_t i = 0; i < size; ++i)
        if (bytes[i] != 0xab) return 0;
    return 1;
}

/* Nothing found, nothing written, one message, or none for NULL; and all still works. */
static void expect(objects_call *c, sc_status status, sc_status wanted, const char *message,
                   int line)
{
    const int query = c->about == QUERY;
    CHECK_MSG(status == wanted, "line %d, question %d: status %d: %s", line, c->about, (int)status,
              c->log.text);
    CHECK_MSG(c->log.count == (message != NULL) && (!message || !strcmp(c->log.text, message)),
              "line %d, question %d: %u messages, %s", line, c->about, c->log.count, c->log.text);
    CHECK_MSG((query ? c->result.collides : c->lists.collides) == 0 &&
                  (query ? c->result.verdict : c->lists.verdict) == SC_VERDICT_NONE &&
                  count_of(c, 0) == 0 && count_of(c, 1) == 0 && range_count_of(c, 0) == 0 &&
                  range_count_of(c, 1) == 0,
              "line %d, question %d: an answer", line, c->about);
    CHECK_MSG(is_noise(c->pairs, sizeof(c->pairs)) && is_noise(c->ranges, sizeof(c->ranges)),
              "line %d, question %d: an array is written to", line, c->about);
    CHECK_MSG(is_right(c), "line %d, question %d: the next answer is wrong", line, c->about);
    make_right(c);
}

#define REFUSED(change, wanted, message)                                                           \
  do {                                                                                             \
    (void)(change);                                                                                \
    expect(&c, ask(&c), wanted, message, __LINE__);                                                \
  } while (0)

/* Two cloths, one in waves that go through the other. */
static int begin(objects_call *c)
{
    sc_workspace_options options;
    sc_mesh mesh;
    memset(c, 0, sizeof(*c));
    SIZED(c->hooks);
    c->hooks.log = hear;
    c->hooks.user = &c->log;
    c->mesh = soup_cloth(2, 2);
    mesh = input_plain_mesh(&c->mesh);
    for (int i = 0; i < OBJECTS; ++i) c->posed[i] = soup_copy_positions(&c->mesh);
    for (uint32_t v = 0; v < c->mesh.vertex_count; ++v) {
        c->posed[0][3 * v + 2] = 0;
        c->posed[1][3 * v + 2] = v % 2 ? 0.1 : -0.07;
    }
    SIZED(options);
    options.workers = 2;
    options.flags = SC_WORKSPACE_NEAR;
    if (!CHECK(sc_build(&mesh, NULL, &c->model) == SC_OK)) return 0;
    if (!CHECK(sc_near_masks_create(c->model, 2, NULL, &c->masks) == SC_OK)) return 0;
    for (int i = 0; i < OBJECTS; ++i)
        if (!CHECK(sc_workspace_create_for(c->model, &options, &c->workspace[i]) == SC_OK) ||
            !CHECK(sc_workspace_set_hooks(c->workspace[i], &c->hooks) == SC_OK))
            return 0;
    for (c->about = 0; c->about < QUESTIONS; ++c->about) {
        make_right(c);
        CHECK(ask(c) == SC_OK);
        for (int i = 0; i < LISTS; ++i) c->count[c->about][i] = count_of(c, i);
        CHECK(c->count[c->about][0] > 0 && (c->about == QUERY || c->count[c->about][1] > 0));
    }
    return 1;
}

static void end(objects_call *c)
{
    for (int i = 0; i < OBJECTS; ++i) {
        sc_workspace_free(c->workspace[i]);
        free(c->posed[i]);
    }
    sc_near_masks_free(c->masks);
    sc_model_free(c->model);
    soup_free(&c->mesh);
}

/* What an object lacks, or has that is for other questions. */
static void objects_alone(void)
{
    static const double lengths[] = {-1, (double)INFINITY, (double)NAN};
    static const char not_for_queries[] =
        "filters by kind, rest and masks of an object are not for intersections";
    objects_call c;
    int ok = begin(&c);
    for (c.about = 0; ok && c.about < QUESTIONS; ++c.about) {
        sc_object *o = &c.object[1];
        make_right(&c);
        REFUSED(o->workspace = NULL, SC_ERROR_NULL, NULL);
        REFUSED(o->model = NULL, SC_ERROR_NULL, "object.model is NULL");
        REFUSED(o->pose = NULL, SC_ERROR_NULL, "object.pose is NULL");
        REFUSED(o->itself = 2, SC_ERROR_OPTION, "object.itself is 2, but at most 1");
        REFUSED(o->reserved = 1, SC_ERROR_OPTION, "object.reserved is 1, but at most 0");
        REFUSED(o->workspace = c.workspace[0], SC_ERROR_WORKSPACE,
                "objects 0 and 1 have one workspace");
        if (c.about != STEP)
            REFUSED(o->end = &c.pose[1], SC_ERROR_OPTION, "object.end is for steps");
        if (c.about == QUERY) {
            REFUSED(o->vertex_face_filter = &c.filter, SC_ERROR_OPTION, not_for_queries);
            REFUSED(o->edge_edge_filter = &c.filter, SC_ERROR_OPTION, not_for_queries);
            REFUSED(o->rest = &c.pose[1], SC_ERROR_OPTION, not_for_queries);
            REFUSED(o->masks = c.masks, SC_ERROR_OPTION, not_for_queries);
        } else {
            REFUSED(o->filter = &c.filter, SC_ERROR_OPTION, "object.filter is for intersections");
            for (size_t i = 0; i < sizeof(lengths) / sizeof(*lengths); ++i)
                REFUSED(o->rest_distance = lengths[i], SC_ERROR_OPTION,
                        "object.rest_distance must be finite and at least 0");
        }
        if (c.about == STEP)
            REFUSED(o->masks = c.masks, SC_ERROR_OPTION, "object.masks are for what is near");
    }
    end(&c);
}

/* What all three have in common: the array of objects, and its tasks. */
static void scenes_and_tasks(void)
{
    objects_call c;
    wide_object wide[OBJECTS];
    int ok = begin(&c);
    for (c.about = 0; ok && c.about < QUESTIONS; ++c.about) {
        const sc_tasks **tasks = c.about == QUERY  ? &c.query.tasks
                                 : c.about == NEAR ? &c.near.tasks
                                                   : &c.step.tasks;
        make_right(&c);
        REFUSED(c.objects.objects = NULL, SC_ERROR_NULL, NULL);
        REFUSED(c.objects.struct_size = 8, SC_ERROR_STRUCT_SIZE, NULL);
        REFUSED(c.objects.stride = sizeof(sc_object) - sizeof(void *), SC_ERROR_STRIDE, NULL);
        REFUSED(c.objects.stride = sizeof(sc_object) + 1, SC_ERROR_STRIDE, NULL);
        REFUSED((*tasks = &c.tasks, c.tasks.struct_size = 8), SC_ERROR_STRUCT_SIZE, NULL);
        REFUSED((*tasks = &c.tasks, c.tasks.enqueue = NULL), SC_ERROR_NULL, NULL);
        REFUSED((*tasks = &c.tasks, c.tasks.finish = NULL), SC_ERROR_NULL, NULL);
        REFUSED((*tasks = &c.tasks, c.tasks.workers = SC_WORKERS_MAX + 1), SC_ERROR_OPTION, NULL);
        for (c.tasks.workers = SC_WORKERS_MAX;;
             c.tasks.workers = 0) { /* more than workspaces are for, and 0 */
            *tasks = &c.tasks;
            CHECK(is_answer_right(&c, ask(&c)));
            if (!c.tasks.workers) break;
        }
        make_right(&c);
        memset(wide, 0xff, sizeof(wide));
        for (int i = 0; i < OBJECTS; ++i) wide[i].object = c.object[i];
        c.objects.objects = &wide[0].object;
        c.objects.stride = sizeof(wide_object);
        CHECK(is_answer_right(&c, ask(&c)));
    }
    end(&c);
}

/* What sc_query, sc_query_near and sc_query_step are asked, and several objects cannot be. */
static void options_of_one_mesh(void)
{
    objects_call c;
    if (begin(&c)) {
        c.about = QUERY;
        make_right(&c);
        REFUSED(c.query.struct_size = 4, SC_ERROR_STRUCT_SIZE, NULL);
        REFUSED(c.query.output = SC_OUTPUT_ANY + 1, SC_ERROR_OPTION, NULL);
        REFUSED(c.query.filter = &c.filter, SC_ERROR_OPTION, NULL);
        REFUSED(c.query.budget = 1, SC_ERROR_OPTION, NULL);
        REFUSED(c.query.contour = SC_CONTOUR_STAR, SC_ERROR_OPTION, NULL);
        REFUSED(c.query.contour = SC_CONTOUR_NONE, SC_ERROR_OPTION, NULL);
        REFUSED(c.result.pairs = NULL, SC_ERROR_NULL, NULL);
        c.query.contour = SC_CONTOUR_EXACT;
        CHECK(is_answer_right(&c, ask(&c)));
        c.about = NEAR;
        make_right(&c);
        REFUSED(c.near.struct_size = 4, SC_ERROR_STRUCT_SIZE, NULL);
        REFUSED(c.near.distance = -1, SC_ERROR_OPTION, NULL);
        REFUSED(c.near.vertex_face_filter = &c.filter, SC_ERROR_OPTION, NULL);
        REFUSED(c.near.edge_edge_filter = &c.filter, SC_ERROR_OPTION, NULL);
        REFUSED(c.near.rest = &c.pose[0], SC_ERROR_OPTION, NULL);
        REFUSED(c.near.rest_distance = 0.1, SC_ERROR_OPTION, NULL);
        REFUSED(c.near.masks = c.masks, SC_ERROR_OPTION, NULL);
        REFUSED(c.near.budget = 1, SC_ERROR_OPTION, NULL);
        REFUSED(c.lists.edge_edges.pairs = NULL, SC_ERROR_NULL, NULL);
        c.about = STEP;
        make_right(&c);
        REFUSED(c.step.struct_size = 4, SC_ERROR_STRUCT_SIZE, NULL);
        REFUSED(c.step.separation = -1, SC_ERROR_OPTION, NULL);
        REFUSED(c.step.vertex_face_filter = &c.filter, SC_ERROR_OPTION, NULL);
        REFUSED(c.step.edge_edge_filter = &c.filter, SC_ERROR_OPTION, NULL);
        REFUSED(c.step.rest = &c.pose[0], SC_ERROR_OPTION, NULL);
        REFUSED(c.step.rest_distance = 0.1, SC_ERROR_OPTION, NULL);
        REFUSED(c.step.budget = 1, SC_ERROR_OPTION, NULL);
        REFUSED(c.step.contour = SC_CONTOUR_STAR, SC_ERROR_OPTION, NULL);
        REFUSED(c.step.contour = SC_CONTOUR_NONE, SC_ERROR_OPTION, NULL);
        REFUSED(c.lists.vertex_faces.pairs = NULL, SC_ERROR_NULL, NULL);
        c.step.contour = SC_CONTOUR_EXACT;
        CHECK(is_answer_right(&c, ask(&c)));
    }
    end(&c);
}

SC_TEST_MAIN(SC_TEST(objects_alone), SC_TEST(scenes_and_tasks), SC_TEST(options_of_one_mesh))
