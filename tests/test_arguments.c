/*
 * What the log hears of arguments that are refused: which member it is, and what is wrong with it.
 *
 * SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "harness.h"
#include "inputs.h"

typedef struct journal {
    char text[512];
    uint32_t errors, others;
} journal;

static void take_message(void *user, uint32_t level, const char *message)
{
    journal *j = (journal *)user;
    snprintf(j->text, sizeof(j->text), "%s", message);
    j->errors += level == SC_LOG_ERROR;
    j->others += level != SC_LOG_ERROR;
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

/* All that calls can be given, right as long as nobody changes it. Structures have room behind
   them, as a later version's have. */
typedef struct call {
    journal log;
    sc_hooks hooks;
    soup s;
    sc_mesh mesh;
    sc_build_options build;
    sc_load_options load;
    sc_allocator allocator;
    uint32_t order[8], weld_map[9];
    sc_tree_node tree[3];
    sc_model *model;
    sc_workspace *workspace;
    sc_pose pose, end, rest;
    struct {
        sc_query_options known;
        uint64_t later;
    } query;
    sc_step_options step;
    sc_filter filter;
    sc_tasks tasks;
    sc_stats stats;
    sc_pair pairs[8];
    sc_result result;
    sc_step_result step_result;
} call;

#define SIZED(structure)                                                                           \
  (memset(&(structure), 0, sizeof(structure)), (structure).struct_size = sizeof(structure))

static void make_right(call *c)
{
    memset(&c->log, 0, sizeof(c->log));
    SIZED(c->hooks);
    c->hooks.log = take_message;
    c->hooks.user = &c->log;
    c->mesh = input_plain_mesh(&c->s);
    SIZED(c->build);
    c->build.hooks = &c->hooks;
    SIZED(c->load);
    c->load.hooks = &c->hooks;
    for (uint32_t i = 0; i < 8; ++i) c->order[i] = i;
    for (uint32_t i = 0; i < 9; ++i) c->weld_map[i] = i;
    for (uint32_t i = 0; i < 3; ++i) {
        c->tree[i].left = i == 0 ? 1 : SC_NONE;
        c->tree[i].right = i == 0 ? 2 : SC_NONE;
        c->tree[i].first = i == 2 ? 3 : 0;
        c->tree[i].count = i == 2 ? 5 : 3;
    }
    c->build.order = c->order;
    c->build.weld_map = c->weld_map;
    c->build.tree = c->tree;
    c->build.tree_count = 3;
    c->pose = c->end = input_plain_pose(c->s.positions, 9);
    memset(&c->query, 0, sizeof(c->query));
    c->query.known.struct_size = sizeof(c->query.known);
    SIZED(c->step);
    SIZED(c->filter);
    SIZED(c->tasks);
    c->tasks.workers = 2;
    c->tasks.enqueue = enqueue;
    c->tasks.finish = finish;
    SIZED(c->stats);
    SIZED(c->result);
    c->result.pairs = c->pairs;
    c->result.capacity = 8;
    SIZED(c->step_result);
}

/* A cloth of eight triangles, its model, and a workspace of two workers. */
static int begin(call *c, uint32_t flags)
{
    sc_workspace_options options;
    memset(c, 0, sizeof(*c));
    c->s = soup_cloth(2, 2);
    make_right(c);
    SIZED(options);
    options.workers = 2;
    options.flags = flags;
    return CHECK(sc_build(&c->mesh, NULL, &c->model) == SC_OK) &&
           CHECK(sc_workspace_create_for(c->model, &options, &c->workspace) == SC_OK) &&
           CHECK(sc_workspace_set_hooks(c->workspace, &c->hooks) == SC_OK);
}

static void end(call *c)
{
    sc_workspace_free(c->workspace);
    sc_model_free(c->model);
    soup_free(&c->s);
}

/* Whether a call was refused as it should be, with one message. */
static void expect(call *c, sc_status status, sc_status wanted, const char *message, int line)
{
    CHECK_MSG(status == wanted, "line %d: status %d: %s", line, (int)status, c->log.text);
    CHECK_MSG(c->log.errors == 1 && c->log.others == 0, "line %d: %u messages, then %u", line,
              c->log.errors, c->log.others);
    CHECK_MSG(strcmp(c->log.text, message) == 0, "line %d: %s", line, c->log.text);
    make_right(c);
}

static sc_status build(call *c)
{
    sc_model *model = NULL;
    sc_status status = sc_build(&c->mesh, &c->build, &model);
    sc_model_free(model);
    return status;
}

static sc_status query(call *c)
{
    return sc_query(c->model, c->workspace, &c->pose, &c->query.known, &c->result);
}

static sc_status step(call *c)
{
    return sc_query_step(c->model, c->workspace, &c->pose, &c->end, &c->step, &c->step_result);
}

/* change: makes one thing wrong. */
#define REFUSED(call_it, change, wanted, message)                                                  \
  do {                                                                                             \
    change;                                                                                        \
    expect(&c, call_it(&c), wanted, message, __LINE__);                                            \
  } while (0)

static void builds(void)
{
    call c;
    sc_model *model;
    char text[100];
    if (!begin(&c, 0)) {
        end(&c);
        return;
    }
    CHECK(build(&c) == SC_OK && c.log.errors == 0);
    expect(&c, sc_build(NULL, &c.build, &model), SC_ERROR_NULL, "mesh is NULL", __LINE__);
    snprintf(text, sizeof(text), "mesh.struct_size is 12, but at least %u and a multiple of %u",
             (unsigned)(sizeof(sc_mesh)), (unsigned)sizeof(void *));
    REFUSED(build, c.mesh.struct_size = 12, SC_ERROR_STRUCT_SIZE, text);
    REFUSED(build, c.mesh.reserved = 7, SC_ERROR_OPTION, "mesh.reserved is 7, but at most 0");
    REFUSED(build, c.mesh.position_type = 2, SC_ERROR_OPTION,
            "mesh.position_type is 2, but at most 1");
    REFUSED(build, c.mesh.index_type = 9, SC_ERROR_OPTION, "mesh.index_type is 9, but at most 1");
    REFUSED(build, c.mesh.position_stride = 16, SC_ERROR_STRIDE,
            "mesh.position_stride is 16, but 0 or at least 24");
    REFUSED(build, c.mesh.index_stride = 8, SC_ERROR_STRIDE,
            "mesh.index_stride is 8, but 0 or at least 12");
    REFUSED(build, c.mesh.positions = NULL, SC_ERROR_NULL, "mesh.positions is NULL");
    REFUSED(build, c.mesh.indices = NULL, SC_ERROR_NULL, "mesh.indices is NULL");
    REFUSED(build, c.build.weld = 3, SC_ERROR_OPTION, "options.weld is 3, but at most 2");
    REFUSED(build, c.build.partition = 4, SC_ERROR_OPTION, "options.partition is 4, but at most 3");
    REFUSED(build, c.build.rest = 2, SC_ERROR_OPTION, "options.rest is 2, but at most 1");
    REFUSED(build, c.build.content = 2, SC_ERROR_OPTION, "options.content is 2, but at most 1");
    REFUSED(build, (c.build.weld = SC_WELD_MAP, c.build.weld_map = NULL), SC_ERROR_NULL,
            "options.weld_map is NULL");
    REFUSED(build, (c.build.weld = SC_WELD_MAP, c.weld_map[4] = 9), SC_ERROR_WELD_MAP,
            "options.weld_map[4] is 9, which is no vertex");
    REFUSED(build, (c.build.weld = SC_WELD_MAP, c.weld_map[4] = 3, c.weld_map[3] = 2),
            SC_ERROR_WELD_MAP, "options.weld_map[4] is 3, which does not represent itself");
    REFUSED(build, c.build.allocator = &c.allocator, SC_ERROR_NULL,
            "options.allocator.allocate is NULL");
    REFUSED(build, c.build.partition = SC_PARTITION_BISECT, SC_ERROR_NULL,
            "options.bisect is NULL");
    end(&c);
}

static void orders_and_trees(void)
{
    call c;
    if (!begin(&c, 0)) {
        end(&c);
        return;
    }
    c.build.partition = SC_PARTITION_TREE;
    CHECK(build(&c) == SC_OK && c.log.errors == 0);
#define TREE(change) (c.build.partition = SC_PARTITION_TREE, change)
    REFUSED(build, TREE(c.build.order = NULL), SC_ERROR_NULL, "options.order is NULL");
    REFUSED(build, TREE(c.order[3] = 8), SC_ERROR_TREE,
            "options.order[3] is 8, which is no triangle");
    REFUSED(build, TREE(c.order[3] = 1), SC_ERROR_TREE, "options.order[3] is 1, which came before");
    REFUSED(build, TREE(c.build.tree = NULL), SC_ERROR_NULL, "options.tree is NULL");
    REFUSED(build, TREE(c.build.tree_count = 0), SC_ERROR_TREE, "options.tree_count is 0");
    REFUSED(build, TREE(c.build.tree_count = 2), SC_ERROR_TREE,
            "options.tree: node 2 does not exist");
    REFUSED(build, TREE(c.tree[0].right = 1), SC_ERROR_TREE,
            "options.tree: node 1 has two parents, or is the root");
    REFUSED(build, TREE(c.tree[2].count = 6), SC_ERROR_TREE,
            "options.tree: node 2 is a leaf of entries of options.order that do not exist");
    REFUSED(build, TREE(c.tree[2].count = 0), SC_ERROR_TREE,
            "options.tree: node 2 is a leaf of entries of options.order that do not exist");
    REFUSED(build, TREE(c.tree[2].first = 2), SC_ERROR_TREE,
            "options.tree: node 2 is a leaf of entries of options.order that another leaf has");
    REFUSED(build, TREE(c.tree[2].count = 4), SC_ERROR_TREE,
            "options.tree: its leaves have 7 of 8 triangles");
    end(&c);
}

static void loads(void)
{
    call c;
    sc_model *model;
    const unsigned char data[8] = {0};
    if (begin(&c, 0)) {
        expect(&c, sc_model_load(NULL, 8, &c.load, &model), SC_ERROR_NULL, "data is NULL",
               __LINE__);
        c.load.mode = 2;
        expect(&c, sc_model_load(data, 8, &c.load, &model), SC_ERROR_OPTION,
               "options.mode is 2, but at most 1", __LINE__);
        c.load.allocator = &c.allocator;
        expect(&c, sc_model_load(data, 8, &c.load, &model), SC_ERROR_NULL,
               "options.allocator.allocate is NULL", __LINE__);
    }
    end(&c);
}

static void queries(void)
{
    call c;
    char text[160];
    if (!begin(&c, 0)) {
        end(&c);
        return;
    }
    CHECK(query(&c) == SC_OK && c.log.errors == 0);
    expect(&c, sc_query(NULL, c.workspace, &c.pose, NULL, &c.result), SC_ERROR_NULL,
           "model is NULL", __LINE__);
    expect(&c, sc_query(c.model, c.workspace, NULL, NULL, &c.result), SC_ERROR_NULL, "pose is NULL",
           __LINE__);
    expect(&c, sc_query(c.model, c.workspace, &c.pose, NULL, NULL), SC_ERROR_NULL, "result is NULL",
           __LINE__);
    CHECK(sc_query(c.model, NULL, &c.pose, NULL, &c.result) == SC_ERROR_NULL); /* nobody to tell */

#define QUERY(member, value) c.query.known.member = value
    REFUSED(query, QUERY(output, 3), SC_ERROR_OPTION, "options.output is 3, but at most 2");
    REFUSED(query, QUERY(pairs, 2), SC_ERROR_OPTION, "options.pairs is 2, but at most 1");
    REFUSED(query, QUERY(contact, 2), SC_ERROR_OPTION, "options.contact is 2, but at most 1");
    REFUSED(query, QUERY(method, 4), SC_ERROR_OPTION, "options.method is 4, but at most 3");
    REFUSED(query, QUERY(contour, 4), SC_ERROR_OPTION, "options.contour is 4, but at most 3");
    REFUSED(query, QUERY(rest_cache, 2), SC_ERROR_OPTION, "options.rest_cache is 2, but at most 1");
    REFUSED(query, QUERY(simd, 5), SC_ERROR_OPTION, "options.simd is 5, but at most 3");
    snprintf(text, sizeof(text), "options.struct_size is 4, but at least 8 and a multiple of %u",
             (unsigned)sizeof(void *));
    REFUSED(query, QUERY(struct_size, 4), SC_ERROR_STRUCT_SIZE, text);
    snprintf(text, sizeof(text),
             "options.struct_size is %u, of which this library knows %u, and byte %u is not 0",
             (unsigned)sizeof(c.query), (unsigned)sizeof(c.query.known),
             (unsigned)sizeof(c.query.known) + 7);
    REFUSED(query,
            (QUERY(struct_size, sizeof(c.query)),
             ((unsigned char *)&c.query)[sizeof(c.query.known) + 7] = 1),
            SC_ERROR_STRUCT_SIZE, text);

    snprintf(text, sizeof(text), "pose.struct_size is 9, but at least %u and a multiple of %u",
             (unsigned)sizeof(sc_pose), (unsigned)sizeof(void *));
    REFUSED(query, c.pose.struct_size = 9, SC_ERROR_STRUCT_SIZE, text);
    REFUSED(query, c.pose.vertex_count = 8, SC_ERROR_VERTEX_COUNT,
            "pose.vertex_count is 8, but the model has 9");
    REFUSED(query, c.pose.positions = NULL, SC_ERROR_NULL, "pose.positions is NULL");
    REFUSED(query, c.pose.position_type = 5, SC_ERROR_OPTION,
            "pose.position_type is 5, but at most 1");
    REFUSED(query, (c.pose.position_type = SC_FLOAT, c.pose.position_stride = 11), SC_ERROR_STRIDE,
            "pose.position_stride is 11, but 0 or at least 12");
    REFUSED(query, c.result.pairs = NULL, SC_ERROR_NULL, "result.pairs is NULL");
    snprintf(text, sizeof(text),
             "result.stats.struct_size is 4, but at least 8 and a multiple of %u",
             (unsigned)sizeof(void *));
    REFUSED(query, (c.result.stats = &c.stats, c.stats.struct_size = 4), SC_ERROR_STRUCT_SIZE,
            text);
    end(&c);
}

static void tasks_filters_and_workspaces(void)
{
    call c, other;
    if (begin(&c, 0) & begin(&other, 0)) {
#define TASKS(change) (c.query.known.tasks = &c.tasks, change)
        REFUSED(query, TASKS(c.tasks.enqueue = NULL), SC_ERROR_NULL,
                "options.tasks.enqueue is NULL");
        REFUSED(query, TASKS(c.tasks.finish = NULL), SC_ERROR_NULL, "options.tasks.finish is NULL");
        REFUSED(query, TASKS(c.tasks.workers = 3), SC_ERROR_WORKSPACE,
                "options.tasks.workers is 3, but the workspace is for 2");
#define FILTER(change) (c.query.known.filter = &c.filter, change)
        REFUSED(query, FILTER(c.filter.ignore_rings = 33), SC_ERROR_OPTION,
                "options.filter.ignore_rings is 33, but at most 32");
        REFUSED(query, FILTER(c.filter.ignore_count = 2), SC_ERROR_NULL,
                "options.filter.ignore is NULL");
        for (uint32_t i = 0; i < 3; ++i) c.pairs[i].a = c.pairs[i].b = i + 1;
        REFUSED(query, FILTER((c.filter.ignore = c.pairs, c.filter.ignore_count = 3)),
                SC_ERROR_PAIRS, "options.filter.ignore[0] is no pair of this model");
        c.pairs[0].b = 5;
        c.pairs[1].a = 0;
        REFUSED(query, FILTER((c.filter.ignore = c.pairs, c.filter.ignore_count = 2)),
                SC_ERROR_PAIRS, "options.filter.ignore[1] comes before the one before it");
        sc_model_free(other.model); /* one with as many vertices, but other triangles */
        other.model = NULL;
        other.s.triangles[0] = 8;
        CHECK(sc_build(&other.mesh, NULL, &other.model) == SC_OK);
        expect(&c, sc_query(other.model, c.workspace, &c.pose, NULL, &c.result), SC_ERROR_WORKSPACE,
               "the workspace is for another model", __LINE__);
        REFUSED(step, (void)0, SC_ERROR_WORKSPACE,
                "the workspace is not for steps: SC_WORKSPACE_STEP");
    }
    end(&c);
    end(&other);
}

/* Filters of a step and its rest pose. */
static void step_filters(void)
{
    call c;
    char text[200];
#define VERTEX_FACE(change) (c.step.vertex_face_filter = &c.filter, change)
#define EDGE_EDGE(change) (c.step.edge_edge_filter = &c.filter, change)
#define REST(change) (c.rest = c.pose, c.step.rest = &c.rest, change)
#define IGNORE(x, y)                                                                               \
  (c.pairs[0].a = x, c.pairs[0].b = y, c.filter.ignore = c.pairs, c.filter.ignore_count = 1)
    if (!begin(&c, SC_WORKSPACE_STEP)) {
        end(&c);
        return;
    }
    snprintf(text, sizeof(text),
             "options.vertex_face_filter.struct_size is %u, but at least %u and a multiple of %u",
             (unsigned)sizeof(void *) / 2, (unsigned)sizeof(void *), (unsigned)sizeof(void *));
    REFUSED(step, VERTEX_FACE(c.filter.struct_size = sizeof(void *) / 2), SC_ERROR_STRUCT_SIZE,
            text);
    REFUSED(step, VERTEX_FACE(c.filter.ignore_rings = 33), SC_ERROR_OPTION,
            "options.vertex_face_filter.ignore_rings is 33, but at most 32");
    REFUSED(step, EDGE_EDGE(c.filter.ignore_rings = 33), SC_ERROR_OPTION,
            "options.edge_edge_filter.ignore_rings is 33, but at most 32");
    REFUSED(step, EDGE_EDGE(c.filter.ignore_count = 1), SC_ERROR_NULL,
            "options.edge_edge_filter.ignore is NULL");
    /* nine vertices, eight triangles */
    REFUSED(step, VERTEX_FACE(IGNORE(9, 0)), SC_ERROR_PAIRS,
            "options.vertex_face_filter.ignore[0] is no pair of this model");
    REFUSED(step, VERTEX_FACE(IGNORE(8, 8)), SC_ERROR_PAIRS,
            "options.vertex_face_filter.ignore[0] is no pair of this model");
    REFUSED(step, EDGE_EDGE(IGNORE(5, 24)), SC_ERROR_PAIRS,
            "options.edge_edge_filter.ignore[0] is no pair of this model");
    REFUSED(step, EDGE_EDGE(IGNORE(5, 5)), SC_ERROR_PAIRS,
            "options.edge_edge_filter.ignore[0] is no pair of this model");
    c.pairs[1].a = 1;
    c.pairs[1].b = 2;
    REFUSED(step, EDGE_EDGE((IGNORE(1, 3), c.filter.ignore_count = 2)), SC_ERROR_PAIRS,
            "options.edge_edge_filter.ignore[1] comes before the one before it");
    REFUSED(step, c.step.rest_distance = 0.5, SC_ERROR_NULL, "options.rest is NULL");
    REFUSED(step, REST(c.step.rest_distance = -1), SC_ERROR_OPTION,
            "options.rest_distance is -1, but finite and at least 0");
    REFUSED(step, REST(c.step.rest_distance = HUGE_VAL), SC_ERROR_OPTION,
            "options.rest_distance is inf, but finite and at least 0");
    REFUSED(step, REST(c.rest.vertex_count = 8), SC_ERROR_VERTEX_COUNT,
            "options.rest.vertex_count is 8, but the model has 9");
    REFUSED(step, REST(c.rest.positions = NULL), SC_ERROR_NULL, "options.rest.positions is NULL");
    REFUSED(step, REST(c.rest.position_type = 2), SC_ERROR_OPTION,
            "options.rest.position_type is 2, but at most 1");
    REFUSED(step, REST(c.rest.position_stride = 23), SC_ERROR_STRIDE,
            "options.rest.position_stride is 23, but 0 or at least 24");
    /* the last of each that is right, and an empty filter */
    make_right(&c);
    VERTEX_FACE(IGNORE(8, 7));
    CHECK(step(&c) == SC_OK && c.log.errors == 0);
    make_right(&c);
    EDGE_EDGE(IGNORE(22, 23));
    CHECK(step(&c) == SC_OK && c.log.errors == 0);
    make_right(&c);
    (void)REST(c.step.rest_distance = 0);
    CHECK(step(&c) == SC_OK && c.log.errors == 0);
    end(&c);
}

static void steps(void)
{
    call c;
    if (!begin(&c, SC_WORKSPACE_STEP)) {
        end(&c);
        return;
    }
    CHECK(step(&c) == SC_OK && c.log.errors == 0);
    expect(&c, sc_query_step(NULL, c.workspace, &c.pose, &c.end, NULL, &c.step_result),
           SC_ERROR_NULL, "model is NULL", __LINE__);
    expect(&c, sc_query_step(c.model, c.workspace, NULL, &c.end, NULL, &c.step_result),
           SC_ERROR_NULL, "start is NULL", __LINE__);
    expect(&c, sc_query_step(c.model, c.workspace, &c.pose, NULL, NULL, &c.step_result),
           SC_ERROR_NULL, "end is NULL", __LINE__);
    expect(&c, sc_query_step(c.model, c.workspace, &c.pose, &c.end, NULL, NULL), SC_ERROR_NULL,
           "result is NULL", __LINE__);
    REFUSED(step, c.step.output = 3, SC_ERROR_OPTION, "options.output is 3, but at most 2");
    REFUSED(step, c.step.pairs = 2, SC_ERROR_OPTION, "options.pairs is 2, but at most 1");
    REFUSED(step, c.step.times = 3, SC_ERROR_OPTION, "options.times is 3, but at most 2");
    REFUSED(step, c.step.method = 9, SC_ERROR_OPTION, "options.method is 9, but at most 3");
    REFUSED(step, c.step.contour = 4, SC_ERROR_OPTION, "options.contour is 4, but at most 3");
    REFUSED(step, c.step.simd = 4, SC_ERROR_OPTION, "options.simd is 4, but at most 3");
    REFUSED(step, c.step.reserved = 1, SC_ERROR_OPTION, "options.reserved is 1, but at most 0");
    REFUSED(step, c.step.separation = -0.5, SC_ERROR_OPTION,
            "options.separation is -0.5, but finite and at least 0");
    REFUSED(step, c.step.tolerance = HUGE_VAL, SC_ERROR_OPTION,
            "options.tolerance is inf, but finite and at least 0");
    REFUSED(step, c.pose.vertex_count = 10, SC_ERROR_VERTEX_COUNT,
            "start.vertex_count is 10, but the model has 9");
    REFUSED(step, c.end.positions = NULL, SC_ERROR_NULL, "end.positions is NULL");
    REFUSED(step, c.step_result.vertex_face_capacity = 1, SC_ERROR_NULL,
            "result.vertex_faces is NULL");
    REFUSED(step, c.step_result.edge_edge_capacity = 1, SC_ERROR_NULL, "result.edge_edges is NULL");
    end(&c);
}

SC_TEST_MAIN(SC_TEST(builds), SC_TEST(orders_and_trees), SC_TEST(loads), SC_TEST(queries),
             SC_TEST(tasks_filters_and_workspaces), SC_TEST(step_filters), SC_TEST(steps))
