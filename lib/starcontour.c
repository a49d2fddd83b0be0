/*
 * The entry points: arguments are checked, steps put in order, errors passed on. What the calls
 * promise is in starcontour.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "starcontour.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

#include "base/arguments.h"
#include "base/assume.h"
#include "base/clock.h"
#include "base/hooks.h"
#include "base/structs.h"
#include "build/model.h"
#include "build/pipeline.h"
#include "build/saved_model.h"
#include "near/masks.h"
#include "near/merging.h"
#include "near/near_candidates.h"
#include "near/step_stencil.h"
#include "near/stencil.h"
#include "pose/positions.h"
#include "query/contacts.h"
#include "query/filter.h"
#include "query/pairs.h"
#include "query/recording.h"
#include "run/near_question.h"
#include "run/objects.h"
#include "run/plan.h"
#include "run/question.h"
#include "run/recorded.h"
#include "run/rest.h"
#include "run/step_question.h"
#include "step/step_filter.h"
#include "step/step_motion.h"
#include "trace/gradients.h"
#include "trace/regions.h"
#include "trace/trace.h"
#include "trace/triples.h"
#include "step/step_pairs.h"

/* ---- building ---- */

/* On request: which nodes fail in the rest pose. On failure the model is released. */
static sc_status mark_rest(const sc_mesh *mesh, const sc_build_options *options,
                           sc_scratch *scratch, sc_model **model)
{
    sc_pose rest;
    uint64_t stride;
    sc_status status;
    if (options->rest == SC_REST_UNMARKED) return SC_OK;
    sc_scratch_clear(scratch); /* make room for the workspace of the rest pose */
    memset(&rest, 0, sizeof rest);
    rest.vertex_count = mesh->vertex_count;
    rest.position_type = mesh->position_type;
    rest.positions = mesh->positions;
    status = sc_mesh_position_stride(options->hooks, "mesh", mesh->position_type,
                                     mesh->position_stride, &stride);
    if (SC_ALWAYS(!status)) /* sc_mesh_read has looked */
        status = sc_rest_mark(*model, &rest, stride, scratch, options->hooks);
    if (status) {
        sc_model_release(*model);
        *model = NULL;
    }
    return status;
}

static sc_status check_build_choices(const sc_build_options *o)
{
    const sc_choice choices[] = {
        {"weld", o->weld, SC_WELD_NONE},
        {"partition", o->partition, SC_PARTITION_BISECT},
        {"rest", o->rest, SC_REST_MARKED},
        {"content", o->content, SC_MODEL_BOXES},
    };
    sc_status status =
        sc_arguments_choose(o->hooks, "options", choices, sizeof choices / sizeof *choices);
    if (status) return status;
    return o->content == SC_MODEL_BOXES && o->rest == SC_REST_MARKED ? SC_ERROR_BOXES_ONLY : SC_OK;
}

/* The caller's functions; options.allocator is from, which may be NULL. */
static sc_status read_allocator(const sc_hooks *hooks, const sc_allocator *from,
                                sc_allocator *allocator)
{
    *allocator = sc_memory_allocator(from);
    if (allocator->allocate && allocator->release) return SC_OK;
    sc_hooks_log(hooks, SC_LOG_ERROR, "options.allocator.%s is NULL",
                 allocator->allocate ? "release" : "allocate");
    return SC_ERROR_NULL;
}

static sc_status read_build_tasks(const sc_hooks *hooks, const sc_tasks *from, sc_tasks *tasks)
{
    sc_status status = sc_arguments_read_tasks(hooks, from, tasks);
    if (status || tasks->workers <= SC_WORKERS_MAX) return status;
    sc_hooks_log(hooks, SC_LOG_ERROR, "options.tasks.workers is %" PRIu32 ", more than %d",
                 tasks->workers, SC_WORKERS_MAX);
    return SC_ERROR_OPTION;
}

sc_status sc_build(const sc_mesh *mesh, const sc_build_options *options, sc_model **model)
{
    sc_mesh m;
    sc_build_options o;
    sc_hooks hooks;
    sc_allocator allocator;
    sc_scratch scratch;
    sc_tasks tasks;
    sc_status status;
    if (!model) return SC_ERROR_NULL;
    *model = NULL;
    status = sc_arguments_read_options(NULL, "options", &o, sizeof o, options);
    if (!status) status = sc_arguments_read_hooks(o.hooks, &hooks);
    if (status) return status;
    o.hooks = &hooks;
    status = sc_arguments_need(&hooks, "mesh", NULL, mesh);
    if (!status)
        status = sc_arguments_read(&hooks, "mesh", &m, sizeof m, mesh,
                                   SC_ARGUMENTS_UP_TO(sc_mesh, indices));
    if (!status) status = check_build_choices(&o);
    if (!status) status = read_allocator(&hooks, o.allocator, &allocator);
    if (!status) status = read_build_tasks(&hooks, o.tasks, &tasks);
    if (status) return status;
    sc_scratch_init(&scratch, &allocator);
    if (tasks.workers > 1) scratch.tasks = &tasks;
    status = sc_pipeline_run(&m, &o, &scratch, model);
    if (!status) status = mark_rest(&m, &o, &scratch, model);
    sc_scratch_clear(&scratch);
    if (status) return status;
    sc_model_note_memory(*model, &scratch);
    sc_pipeline_log_facts(&hooks, *model);
    return SC_OK;
}

void sc_model_free(sc_model *model)
{
    if (model) sc_model_release(model);
}

sc_status sc_model_get_info(const sc_model *model, sc_model_info *info)
{
    const sc_model_owner *owner;
    sc_model_info i;
    sc_status status;
    if (!model || !info) return SC_ERROR_NULL;
    status = sc_arguments_check(NULL, "info", info, sizeof i, SC_ARGUMENTS_DEFAULTS);
    if (status) return status;
    memset(&i, 0, sizeof i);
    owner = sc_model_owner_of(model);
    i.vertex_count = model->vertex_count;
    i.point_count = model->point_count;
    i.triangle_count = model->triangle_count;
    i.edge_count = model->edge_count;
    i.component_count = model->component_count;
    i.boundary_edges = model->boundary_edges;
    i.irregular_edges = model->irregular_edges;
    i.leaf_count = model->leaf_count;
    i.level_count = model->level_count;
    i.node_count = model->node_count;
    i.segment_count = model->segment_count;
    i.topology_hash = model->topology_hash;
    i.model_bytes = model->bytes + SC_ALIGNMENT; /* with what frees it */
    i.workspace_bytes = sc_workspace_bytes(model, NULL);
    if (owner) {
        i.peak_bytes = owner->peak_bytes;
        i.allocations = owner->allocations;
    }
    sc_structs_write(info, &i, sizeof i);
    return SC_OK;
}

sc_status sc_model_get_level(const sc_model *model, uint32_t level, sc_level_info *info)
{
    sc_level_info i;
    const sc_level *l;
    sc_status status;
    if (!model || !info) return SC_ERROR_NULL;
    status = sc_arguments_check(NULL, "info", info, sizeof i, SC_ARGUMENTS_DEFAULTS);
    if (status) return status;
    if (level >= model->level_count) return SC_ERROR_LEVEL;
    l = &sc_model_level_info(model)[level];
    memset(&i, 0, sizeof i);
    i.patch_count = l->patch_count;
    i.connected_patches = l->connected_patches;
    i.segment_count = l->segment_count;
    i.self_nodes = l->self_nodes;
    i.self_oriented = l->self_oriented;
    i.self_culled = l->self_culled;
    i.pair_nodes = l->pair_nodes;
    i.pair_oriented = l->pair_oriented;
    i.pair_culled = l->pair_culled;
    sc_structs_write(info, &i, sizeof i);
    return SC_OK;
}

sc_status sc_model_get_patches(const sc_model *model, uint32_t level, uint32_t *patch_of_triangle,
                               uint64_t capacity)
{
    const uint32_t *leaf, *leaf_first, *id;
    uint32_t first, p, i;
    if (!model || !patch_of_triangle) return SC_ERROR_NULL;
    if (level >= model->level_count) return SC_ERROR_LEVEL;
    if (capacity < model->triangle_count) return SC_ERROR_SHORT_BUFFER;
    leaf = sc_model_leaf(model);
    leaf_first = sc_model_leaf_first(model);
    id = sc_model_triangle_id(model);
    first = sc_model_level_first(model)[level];
    for (p = 0; p < sc_model_patches(model, level); p++)
        for (i = leaf_first[leaf[first + p]]; i < leaf_first[leaf[first + p + 1]]; i++)
            patch_of_triangle[id[i]] = p;
    return SC_OK;
}

/* ---- saved models ---- */

sc_status sc_model_save_size(const sc_model *model, uint64_t *size)
{
    if (!model || !size) return SC_ERROR_NULL;
    *size = sc_saved_model_bytes(model);
    return SC_OK;
}

sc_status sc_model_save(const sc_model *model, void *memory, uint64_t size, uint64_t *written)
{
    uint64_t bytes;
    if (written) *written = 0;
    if (!model) return SC_ERROR_NULL;
    bytes = sc_saved_model_bytes(model);
    if (written) *written = bytes;
    if (size < bytes) return SC_ERROR_SHORT_BUFFER;
    if (!memory) return SC_ERROR_NULL;
    sc_saved_model_write(model, memory);
    return SC_OK;
}

sc_status sc_model_load(const void *data, uint64_t size, const sc_load_options *options,
                        sc_model **model)
{
    sc_choice mode = {"mode", 0, SC_LOAD_IN_PLACE};
    sc_load_options o;
    sc_hooks hooks;
    sc_allocator allocator;
    sc_scratch scratch;
    sc_status status;
    if (!model) return SC_ERROR_NULL;
    *model = NULL;
    status = sc_arguments_read_options(NULL, "options", &o, sizeof o, options);
    if (!status) status = sc_arguments_read_hooks(o.hooks, &hooks);
    if (status) return status;
    mode.value = o.mode;
    status = sc_arguments_need(&hooks, "data", NULL, data);
    if (!status) status = sc_arguments_choose(&hooks, "options", &mode, 1);
    if (!status) status = read_allocator(&hooks, o.allocator, &allocator);
    if (status) return status;
    sc_scratch_init(&scratch, &allocator);
    status = sc_saved_model_read(data, size, o.mode == SC_LOAD_IN_PLACE, o.topology_hash, &scratch,
                                 &hooks, model);
    sc_scratch_clear(&scratch);
    if (!status && o.mode == SC_LOAD_COPY) sc_model_note_memory(*model, &scratch);
    return status;
}

/* ---- workspaces ---- */

/* Whether a workspace of that kind may use the room of another one. */
static sc_status check_room(const sc_model *model, const sc_workspace_options *o)
{
    const sc_workspace_sizes *s = &o->room->sizes;
    if (!sc_workspace_fits(o->room, model)) return SC_ERROR_WORKSPACE;
    if (s->flags != o->flags + SC_WORKSPACE_ROOM || s->workers != o->workers)
        return SC_ERROR_OPTION;
    return SC_OK;
}

/* The options of a workspace, all of them set. */
static sc_status read_workspace_options(const sc_model *model, const sc_workspace_options *options,
                                        sc_workspace_options *o)
{
    const uint32_t flags = SC_WORKSPACE_STEP | SC_WORKSPACE_NEAR | SC_WORKSPACE_ROOM;
    sc_status status = sc_arguments_read_options(NULL, "options", o, sizeof *o, options);
    if (status) return status;
    if ((o->flags & ~flags) || o->workers > SC_WORKERS_MAX || o->reserved) return SC_ERROR_OPTION;
    if (o->flags & SC_WORKSPACE_NEAR) o->flags |= SC_WORKSPACE_STEP;
    if (!o->workers) o->workers = 1;
    return o->room ? check_room(model, o) : SC_OK;
}

sc_status sc_workspace_size_for(const sc_model *model, const sc_workspace_options *options,
                                uint64_t *size)
{
    sc_workspace_options o;
    sc_status status;
    if (!model || !size) return SC_ERROR_NULL;
    status = read_workspace_options(model, options, &o);
    if (!status) *size = sc_workspace_bytes(model, &o);
    return status;
}

sc_status sc_workspace_init_for(const sc_model *model, const sc_workspace_options *options,
                                void *memory, uint64_t size, sc_workspace **workspace)
{
    sc_workspace_options o;
    sc_status status;
    if (!workspace) return SC_ERROR_NULL;
    *workspace = NULL;
    if (!model || !memory) return SC_ERROR_NULL;
    status = read_workspace_options(model, options, &o);
    if (status) return status;
    if ((uintptr_t)memory % SC_ALIGNMENT) return SC_ERROR_ALIGNMENT;
    if (size < sc_workspace_bytes(model, &o)) return SC_ERROR_WORKSPACE;
    *workspace = sc_workspace_place(model, &o, memory);
    return SC_OK;
}

sc_status sc_workspace_create_for(const sc_model *model, const sc_workspace_options *options,
                                  sc_workspace **workspace)
{
    sc_workspace_options o;
    sc_allocator a;
    uint64_t bytes;
    void *memory;
    sc_status status;
    if (!workspace) return SC_ERROR_NULL;
    *workspace = NULL;
    if (!model) return SC_ERROR_NULL;
    status = read_workspace_options(model, options, &o);
    if (status) return status;
    status = read_allocator(NULL, o.allocator, &a);
    if (status) return status;
    bytes = sc_workspace_bytes(model, &o);
    if (SC_HARDLY(bytes > SIZE_MAX)) return SC_ERROR_MEMORY; /* where addresses have 32 bits */
    memory = a.allocate(a.user, bytes, SC_ALIGNMENT);
    if (!memory) return SC_ERROR_MEMORY;
    *workspace = sc_workspace_place(model, &o, memory);
    (*workspace)->allocator = a;
    (*workspace)->owned = 1;
    return SC_OK;
}

sc_status sc_workspace_size(const sc_model *model, uint64_t *size)
{
    return sc_workspace_size_for(model, NULL, size);
}

sc_status sc_workspace_init(const sc_model *model, void *memory, uint64_t size,
                            sc_workspace **workspace)
{
    return sc_workspace_init_for(model, NULL, memory, size, workspace);
}

sc_status sc_workspace_create(const sc_model *model, const sc_allocator *allocator,
                              sc_workspace **workspace)
{
    sc_workspace_options options;
    memset(&options, 0, sizeof options);
    options.struct_size = sizeof options;
    options.allocator = allocator;
    return sc_workspace_create_for(model, &options, workspace);
}

sc_status sc_workspace_set_hooks(sc_workspace *workspace, const sc_hooks *hooks)
{
    sc_hooks checked;
    sc_status status;
    if (!workspace) return SC_ERROR_NULL;
    status = sc_arguments_read_hooks(hooks, &checked);
    if (!status) workspace->hooks = checked;
    return status;
}

void sc_workspace_free(sc_workspace *workspace)
{
    if (workspace && workspace->owned)
        workspace->allocator.release(workspace->allocator.user, workspace, workspace->bytes);
}

/* ---- queries ---- */

static int uses_star(const sc_query_options *o)
{
    return o->method == SC_METHOD_SCTT && o->contour == SC_CONTOUR_STAR;
}

/* The clock of a query that began then stands still. */
static void stop_clock_of(sc_worker *w, uint64_t start)
{
    uint64_t now;
    if (!w->question->timed) return;
    now = sc_clock_nanoseconds();
    w->stats.nanoseconds[w->task] += now - w->last_time;
    w->stats.total_nanoseconds = now - start;
}

/* Reads the pose, or both of a step: step is NULL for a query. */
static sc_status read_frame(const sc_model *model, sc_workspace *workspace, const sc_asked *asked,
                            sc_step_question *step)
{
    const sc_hooks *hooks = &workspace->hooks;
    sc_frame *frame = &workspace->frame;
    sc_status status;
    if (!step) {
        status = sc_positions_read(model, &asked->pose[0], asked->stride[0], frame);
        if (status) sc_question_log_not_finite(hooks, model, &asked->pose[0], asked->stride[0], "");
        return status;
    }
    frame->motion.ends = step->query.near ? 1 : 2;
    frame->motion.swept = step->options.method == SC_STEP_METHOD_SWEPT;
    status = sc_motion_read(model, asked->pose, asked->stride, &step->limits, frame);
    if (status && step->query.near) {
        sc_question_log_not_finite(hooks, model, &asked->pose[0], asked->stride[0], "");
        return status;
    }
    if (status) {
        sc_question_log_not_finite(hooks, model, &asked->pose[0], asked->stride[0],
                                   " at the start");
        sc_question_log_not_finite(hooks, model, &asked->pose[1], asked->stride[1], " at the end");
        return status;
    }
    status = sc_step_filter_begin(model, step->options.rest, asked->rest_stride,
                                  step->options.rest_distance, frame->tasks,
                                  frame->motion.vertex_groups, &step->filters);
    if (status)
        sc_question_log_not_finite(hooks, model, &asked->rest, asked->rest_stride,
                                   " in the rest pose");
    return status;
}

/* A query, or a step. What was found and counted is in the first worker. */
static sc_status run(const sc_model *model, sc_workspace *workspace, const sc_asked *asked,
                     const sc_question *question, sc_step_question *step)
{
    sc_worker *w = sc_workspace_begin(model, workspace, question);
    uint64_t start = 0;
    sc_status status;
    workspace->frame.tasks = sc_plan_tasks(model, question);
    workspace->frame.kernels = sc_kernels_for(question->options.simd);
    if (question->timed) start = w->last_time = sc_clock_nanoseconds();
    if (sc_worker_stops(w)) return SC_ERROR_INCOMPLETE;
    if (!step && !uses_star(&question->options)) sc_workspace_keep_all(workspace);
    status = read_frame(model, workspace, asked, step);
    if (status) return status;
    if (question->near)
        sc_near_candidates_set_bounds(question->near, model->vertex_count,
                                      question->near->options.distance);
    sc_plan_run(workspace);
    stop_clock_of(w, start);
    return w->incomplete ? SC_ERROR_INCOMPLETE : SC_OK;
}

/* Whether something is known: all, or what fits, or what was found until it ended. */
static int has_answer(sc_status status)
{
    return !status || status == SC_ERROR_SHORT_BUFFER || status == SC_ERROR_INCOMPLETE;
}

static uint32_t verdict_of(sc_status status, uint32_t found)
{
    if (status == SC_ERROR_INCOMPLETE) return SC_VERDICT_INCOMPLETE;
    return found ? SC_VERDICT_FOUND : SC_VERDICT_CLEAN;
}

static void fill_result(const sc_worker *w, sc_status status, sc_result *r)
{
    r->count = w->question->options.output == SC_OUTPUT_ANY ? w->count > 0 : w->count;
    r->collides = w->count > 0;
    r->verdict = verdict_of(status, r->collides);
    if (r->stats) sc_structs_write(r->stats, &w->stats, sizeof w->stats);
}

sc_status sc_query(const sc_model *model, sc_workspace *workspace, const sc_pose *pose,
                   const sc_query_options *options, sc_result *result)
{
    const sc_hooks *hooks = workspace ? &workspace->hooks : NULL;
    sc_question question;
    sc_asked asked;
    sc_result r;
    sc_status status = sc_arguments_need(hooks, "result", NULL, result);
    if (!status)
        status = sc_arguments_read(hooks, "result", &r, sizeof r, result,
                                   SC_ARGUMENTS_UP_TO(sc_result, pairs));
    if (status) return status;
    r.collides = 0;
    r.count = 0;
    r.verdict = SC_VERDICT_NONE;
    r.reserved = 0;
    memset(&question, 0, sizeof question);
    status = sc_question_read(model, workspace, pose, options, &r, &asked, &question);
    if (!status && SC_ALWAYS(workspace)) { /* it is refused if it is NULL */
        const sc_worker *w = &workspace->worker[0];
        status = run(model, workspace, &asked, &question, NULL);
        if (!status && question.options.output == SC_OUTPUT_PAIRS && w->count > question.capacity)
            status = SC_ERROR_SHORT_BUFFER;
        if (has_answer(status)) fill_result(w, status, &r);
    }
    sc_structs_write(result, &r, sizeof r);
    return status;
}

/* Many poses, and who asks about them. */
typedef struct pose_batch {
    const sc_model *model;
    sc_workspace *const *workspaces;
    const unsigned char *poses;
    unsigned char *results;
    uint64_t pose_bytes, result_bytes; /* from one to the next */
    sc_query_options options;          /* of one query */
    sc_status *statuses;
} pose_batch;

static void ask_pose(void *context, uint32_t part, uint32_t worker)
{
    const pose_batch *b = (const pose_batch *)context;
    const sc_pose *pose = (const sc_pose *)(const void *)(b->poses + part * b->pose_bytes);
    sc_result *result = (sc_result *)(void *)(b->results + part * b->result_bytes);
    b->statuses[part] = sc_query(b->model, b->workspaces[worker], pose, &b->options, result);
}

/* The options of one query, and what shares in all. */
static sc_status read_batch(sc_workspace *const *workspaces, const sc_query_options *options,
                            pose_batch *b, sc_tasks *tasks)
{
    uint32_t i, k;
    sc_status status = sc_question_read_options(NULL, options, &b->options);
    if (!status) status = sc_arguments_read_tasks(NULL, b->options.tasks, tasks);
    if (status) return status;
    b->options.tasks = NULL;
    if (tasks->workers > SC_WORKERS_MAX) return SC_ERROR_WORKSPACE;
    for (i = 0; i < tasks->workers; i++) {
        if (!workspaces[i]) return SC_ERROR_NULL;
        for (k = 0; k < i; k++)
            if (workspaces[k]->room == workspaces[i]->room) return SC_ERROR_WORKSPACE;
    }
    return SC_OK;
}

sc_status sc_query_batch(const sc_model *model, sc_workspace *const *workspaces,
                         const sc_pose *poses, uint32_t count, const sc_query_options *options,
                         sc_result *results, sc_status *statuses)
{
    pose_batch b;
    sc_tasks tasks;
    sc_status status;
    uint32_t i;
    if (!model || !workspaces || (count && (!poses || !results || !statuses))) return SC_ERROR_NULL;
    status = read_batch(workspaces, options, &b, &tasks);
    if (status || !count) return status;
    b.model = model;
    b.workspaces = workspaces;
    b.poses = (const unsigned char *)(const void *)poses;
    b.results = (unsigned char *)(void *)results;
    b.pose_bytes = poses->struct_size;
    b.result_bytes = results->struct_size;
    b.statuses = statuses;
    if (b.pose_bytes < SC_ARGUMENTS_UP_TO(sc_pose, positions) || b.pose_bytes % sizeof(void *) ||
        b.result_bytes < SC_ARGUMENTS_UP_TO(sc_result, pairs) || b.result_bytes % sizeof(void *))
        return SC_ERROR_STRUCT_SIZE;
    if (tasks.workers > 1)
        tasks.finish(tasks.user, tasks.enqueue(tasks.user, ask_pose, &b, count));
    else
        for (i = 0; i < count; i++) ask_pose(&b, i, 0);
    for (i = 0; i < count && !status; i++) status = statuses[i];
    return status;
}

/* Arrays that the caller must give. */
static sc_status need_list(const char *pairs, const char *ranges, const sc_object_list *list,
                           uint32_t output)
{
    sc_status status = SC_OK;
    if (output == SC_OUTPUT_PAIRS && list->capacity)
        status = sc_arguments_need(NULL, "result", pairs, list->pairs);
    if (!status && list->range_capacity)
        status = sc_arguments_need(NULL, "result", ranges, list->ranges);
    return status;
}

/* What was found of all objects; any: one pair is enough to know. wanted: the caller's
   statistics. */
static sc_status run_objects(sc_objects_question *question, sc_objects_answer *answer, int any,
                             sc_stats *wanted, uint32_t *collides, uint32_t *verdict)
{
    sc_object_list *list = answer->list;
    sc_stats stats;
    sc_status status = SC_OK;
    if (wanted)
        status =
            sc_arguments_check(NULL, "result.stats", wanted, sizeof stats, SC_ARGUMENTS_DEFAULTS);
    if (!status) {
        memset(&stats, 0, sizeof stats);
        answer->stats = wanted ? &stats : NULL;
        status = sc_objects_run(question, answer);
    }
    if (!has_answer(status)) {
        list[0].count = list[0].range_count = list[1].count = list[1].range_count = 0;
        answer->earliest = 0;
        return status;
    }
    *collides = list[0].count + list[1].count > 0;
    if (any) {
        list[0].count = list[0].count > 0;
        list[1].count = list[1].count > 0 && !list[0].count;
    }
    *verdict = verdict_of(status, *collides);
    if (wanted) sc_structs_write(wanted, &stats, sizeof stats);
    return status;
}

sc_status sc_query_objects(const sc_objects *objects, const sc_query_options *options,
                           sc_objects_result *result)
{
    sc_objects_question question;
    sc_objects_answer answer;
    sc_object_list *list = answer.list;
    sc_objects_result r;
    sc_status status = sc_arguments_need(NULL, "result", NULL, result);
    if (!status)
        status = sc_arguments_read(NULL, "result", &r, sizeof r, result,
                                   SC_ARGUMENTS_UP_TO(sc_objects_result, pairs));
    if (status) return status;
    r.collides = r.reserved = 0;
    r.verdict = SC_VERDICT_NONE;
    memset(&answer, 0, sizeof answer);
    list->capacity = r.capacity;
    list->pairs = r.pairs;
    list->range_capacity = r.range_capacity;
    list->ranges = r.ranges;
    status = sc_objects_question_read(objects, options, &question);
    if (!status) status = need_list("pairs", "ranges", list, question.output);
    if (!status)
        status =
            run_objects(&question, &answer, question.ends_early, r.stats, &r.collides, &r.verdict);
    r.count = list->count;
    r.range_count = list->range_count;
    sc_structs_write(result, &r, sizeof r);
    return status;
}

/* Checks and copies the caller's lists; *r is to be written back then. */
static sc_status read_lists(sc_objects_lists *lists, sc_objects_lists *r, sc_objects_answer *answer)
{
    sc_object_list *const list[2] = {&r->vertex_faces, &r->edge_edges};
    sc_status status = sc_arguments_need(NULL, "lists", NULL, lists);
    int kind;
    if (!status)
        status = sc_arguments_read(NULL, "lists", r, sizeof *r, lists,
                                   SC_ARGUMENTS_UP_TO(sc_objects_lists, edge_edges));
    if (status) return status;
    r->collides = r->reserved = 0;
    r->verdict = SC_VERDICT_NONE;
    r->earliest = 0;
    memset(answer, 0, sizeof *answer);
    for (kind = 0; kind < 2; kind++) {
        answer->list[kind] = *list[kind];
        answer->list[kind].count = answer->list[kind].range_count = 0;
    }
    return SC_OK;
}

/* Answers a question about two lists, unless it was refused, and writes them back. */
static sc_status answer_lists(sc_objects_question *question, sc_status status,
                              sc_objects_answer *answer, sc_objects_lists *r,
                              sc_objects_lists *lists)
{
    sc_object_list *list = answer->list;
    if (!status)
        status = need_list("vertex_faces.pairs", "vertex_faces.ranges", &list[0], question->output);
    if (!status)
        status = need_list("edge_edges.pairs", "edge_edges.ranges", &list[1], question->output);
    if (!status)
        status = run_objects(question, answer, question->output == SC_OUTPUT_ANY, r->stats,
                             &r->collides, &r->verdict);
    r->vertex_faces = list[0];
    r->edge_edges = list[1];
    sc_structs_write(lists, r, sizeof *r);
    return status;
}

sc_status sc_query_objects_near(const sc_objects *objects, const sc_near_options *options,
                                sc_objects_lists *lists)
{
    sc_objects_question question;
    sc_objects_answer answer;
    sc_objects_lists r;
    sc_status status = read_lists(lists, &r, &answer);
    if (status) return status;
    status = sc_objects_question_read_near(objects, options, &question);
    return answer_lists(&question, status, &answer, &r, lists);
}

sc_status sc_query_objects_step(const sc_objects *objects, const sc_step_options *options,
                                sc_objects_lists *lists)
{
    sc_objects_question question;
    sc_objects_answer answer;
    sc_objects_lists r;
    uint32_t times;
    sc_status status = read_lists(lists, &r, &answer);
    if (status) return status;
    status = sc_objects_question_read_step(objects, options, &question);
    times = question.near.step.options.times;
    status = answer_lists(&question, status, &answer, &r, lists);
    r.earliest = answer.earliest;
    if (status == SC_ERROR_INCOMPLETE || (r.collides && times == SC_STEP_TIMES_NONE))
        r.earliest = 0;
    sc_structs_write(lists, &r, sizeof r);
    return status;
}

/* ---- steps ---- */

/* Whether one of the lists has more than the caller's array holds. */
static int is_short(const sc_step_worker *w)
{
    const sc_step_question *q = w->question;
    int kind, more = 0;
    for (kind = 0; kind < 2; kind++) more |= w->count[kind] > q->list[kind].capacity;
    return more && q->options.output == SC_OUTPUT_PAIRS;
}

static void fill_step_result(const sc_worker *w, sc_status status, sc_step_result *r)
{
    const sc_step_options *o = &w->step->question->options;
    uint64_t v = w->step->count[SC_STEP_VERTEX_FACE], e = w->step->count[SC_STEP_EDGE_EDGE];
    int any = o->output == SC_OUTPUT_ANY;
    r->vertex_face_count = any ? v > 0 : v;
    r->edge_edge_count = any ? e > 0 && v == 0 : e;
    r->collides = v + e > 0;
    r->verdict = verdict_of(status, r->collides);
    r->earliest = w->step->earliest;
    if (status == SC_ERROR_INCOMPLETE || (r->collides && o->times == SC_STEP_TIMES_NONE))
        r->earliest = 0;
    if (r->stats) sc_structs_write(r->stats, &w->stats, sizeof w->stats);
}

sc_status sc_query_step(const sc_model *model, sc_workspace *workspace, const sc_pose *start,
                        const sc_pose *end, const sc_step_options *options, sc_step_result *result)
{
    const sc_hooks *hooks = workspace ? &workspace->hooks : NULL;
    sc_step_question question;
    sc_asked asked;
    sc_step_result r;
    sc_status status = sc_arguments_need(hooks, "result", NULL, result);
    if (!status)
        status = sc_arguments_read(hooks, "result", &r, sizeof r, result,
                                   SC_ARGUMENTS_UP_TO(sc_step_result, earliest));
    if (status) return status;
    r.collides = 0;
    r.verdict = SC_VERDICT_NONE;
    r.reserved = 0;
    r.vertex_face_count = 0;
    r.edge_edge_count = 0;
    r.earliest = 0;
    memset(&question, 0, sizeof question);
    status = sc_step_question_read(model, workspace, start, end, options, &r, &asked, &question);
    if (!status && SC_ALWAYS(workspace)) { /* likewise */
        const sc_worker *w = &workspace->worker[0];
        status = run(model, workspace, &asked, &question.query, &question);
        if (!status && is_short(w->step)) status = SC_ERROR_SHORT_BUFFER;
        if (has_answer(status)) fill_step_result(w, status, &r);
    }
    sc_structs_write(result, &r, sizeof r);
    return status;
}

/* ---- proximity ---- */

static void fill_near_result(const sc_worker *w, sc_status status, sc_near_result *r)
{
    const uint64_t v = w->step->count[SC_STEP_VERTEX_FACE], e = w->step->count[SC_STEP_EDGE_EDGE];
    const int any = w->question->options.output == SC_OUTPUT_ANY;
    r->vertex_face_count = any ? v > 0 : v;
    r->edge_edge_count = any ? e > 0 && v == 0 : e;
    r->found = v + e > 0;
    r->verdict = verdict_of(status, r->found);
    if (r->stats) sc_structs_write(r->stats, &w->stats, sizeof w->stats);
}

sc_status sc_query_near(const sc_model *model, sc_workspace *workspace, const sc_pose *pose,
                        const sc_near_options *options, sc_near_result *result)
{
    const sc_hooks *hooks = workspace ? &workspace->hooks : NULL;
    sc_near_question question;
    sc_asked asked;
    sc_near_result r;
    sc_status status = sc_arguments_need(hooks, "result", NULL, result);
    if (!status)
        status = sc_arguments_read(hooks, "result", &r, sizeof r, result,
                                   SC_ARGUMENTS_UP_TO(sc_near_result, edge_edges));
    if (status) return status;
    r.found = 0;
    r.verdict = SC_VERDICT_NONE;
    r.reserved = 0;
    r.vertex_face_count = 0;
    r.edge_edge_count = 0;
    memset(&question, 0, sizeof question);
    status = sc_near_question_read(model, workspace, pose, options, &r, &asked, &question);
    if (!status && SC_ALWAYS(workspace)) { /* likewise */
        const sc_worker *w = &workspace->worker[0];
        status = run(model, workspace, &asked, &question.step.query, &question.step);
        if (!status && is_short(w->step)) status = SC_ERROR_SHORT_BUFFER;
        if (status == SC_ERROR_INCOMPLETE)
            sc_near_candidates_set_bounds(&question, model->vertex_count, 0);
        if (has_answer(status)) fill_near_result(w, status, &r);
    }
    sc_structs_write(result, &r, sizeof r);
    return status;
}

/* ---- contacts ---- */

/* The positions of corners first to first + count - 1 (mod 3) of a triangle; the last fills up. */
static sc_status read_corners(const sc_model *model, const sc_pose *pose, uint64_t stride,
                              uint32_t triangle, uint32_t first, uint32_t count,
                              double positions[3][3])
{
    const uint32_t *corner =
        sc_model_triangle(model) + 3 * (uint64_t)sc_model_place(model)[triangle];
    uint32_t i, k;
    for (i = 0; i < 3; i++) {
        uint32_t point = corner[(first + (i < count ? i : count - 1)) % 3];
        sc_mesh_read_position(pose->positions, pose->position_type, stride, point, positions[i]);
        for (k = 0; k < 3; k++)
            if (positions[i][k] - positions[i][k] != 0) return SC_ERROR_NOT_FINITE;
    }
    return SC_OK;
}

sc_status sc_contacts(const sc_model *model, const sc_pose *pose, uint32_t kind,
                      const sc_pair *pairs, uint64_t count, sc_contact *contacts)
{
    sc_pose p;
    sc_status status;
    uint64_t stride, i;
    int is_edge = kind == SC_PAIRS_EDGE;
    if (!model || !pose || (count && (!pairs || !contacts))) return SC_ERROR_NULL;
    if (kind > SC_PAIRS_EDGE) return SC_ERROR_OPTION;
    status = sc_question_read_pose(NULL, "pose", model, pose, &p, &stride);
    for (i = 0; !status && i < count; i++) {
        uint32_t a = is_edge ? pairs[i].a / 3 : pairs[i].a, b = pairs[i].b;
        double at[2][3][3];
        const double *corners[2][3];
        int s, k;
        if (a >= model->triangle_count || b >= model->triangle_count || (a == b && !is_edge))
            return SC_ERROR_PAIRS;
        status = read_corners(model, &p, stride, a, is_edge ? pairs[i].a % 3 : 0, is_edge ? 2 : 3,
                              at[0]);
        if (!status) status = read_corners(model, &p, stride, b, 0, 3, at[1]);
        for (s = 0; s < 2; s++)
            for (k = 0; k < 3; k++) corners[s][k] = at[s][k];
        if (!status) sc_contacts_find(corners[0], corners[1], &contacts[i]);
    }
    return status;
}

/* ---- contours of intersections ---- */

/* More pairs than this are refused. */
#define TRACE_PAIRS_MAX (UINT64_C(1) << 30)

/* What a call about contours was given, checked. */
typedef struct trace_call {
    sc_hooks hooks;
    sc_allocator allocator;
    sc_tasks tasks;
    sc_trace_subject subject; /* but for pairs */
} trace_call;

static sc_status read_trace_call(const sc_model *model, const sc_pose *pose,
                                 const sc_trace_options *options, trace_call *call)
{
    sc_trace_options o;
    sc_choice simd = {"simd", 0, SC_SIMD_AVX512};
    sc_pose p;
    uint64_t stride;
    sc_status status = sc_arguments_read_options(NULL, "options", &o, sizeof o, options);
    if (!status) status = sc_arguments_read_hooks(o.hooks, &call->hooks);
    if (status) return status;
    simd.value = o.simd;
    status = sc_arguments_choose(&call->hooks, "options", &simd, 1);
    if (status) return status;
    if (o.simd == SC_SIMD_BEST) o.simd = (uint32_t)sc_isa_best();
    if (SC_HARDLY(o.simd > (uint32_t)sc_isa_best())) return SC_ERROR_UNSUPPORTED;
    status = read_allocator(&call->hooks, o.allocator, &call->allocator);
    if (!status) status = read_build_tasks(&call->hooks, o.tasks, &call->tasks);
    if (!status) status = sc_question_read_pose(&call->hooks, "pose", model, pose, &p, &stride);
    if (status) return status;
    memset(&call->subject, 0, sizeof call->subject);
    call->subject.model = model;
    sc_positions_note(model, &p, stride, &call->subject.positions);
    call->subject.kernels = sc_kernels_for(o.simd)->trace;
    call->subject.hooks = &call->hooks;
    call->subject.cancel = o.cancel;
    return SC_OK;
}

/* Arrays of a trace: the caller's, to be filled, or of one that was. */
static sc_status need_trace_arrays(const sc_hooks *hooks, const char *of, const sc_trace_result *r,
                                   uint64_t nodes, uint64_t contours)
{
    sc_status status = nodes ? sc_arguments_need(hooks, of, "nodes", r->nodes) : SC_OK;
    if (!status && contours) status = sc_arguments_need(hooks, of, "contours", r->contours);
    return status;
}

static sc_status find_trace(const sc_model *model, const sc_pose *pose, const sc_pair *pairs,
                            uint64_t count, const sc_trace_options *options, sc_trace_result *r)
{
    trace_call call;
    sc_scratch scratch;
    sc_status status = read_trace_call(model, pose, options, &call);
    if (!status)
        status = need_trace_arrays(&call.hooks, "result", r, r->node_capacity, r->contour_capacity);
    if (!status && count > TRACE_PAIRS_MAX) status = SC_ERROR_COUNT;
    if (status) return status;
    call.subject.pairs = pairs;
    call.subject.count = (uint32_t)count;
    sc_scratch_init(&scratch, &call.allocator);
    if (call.tasks.workers > 1) scratch.tasks = &call.tasks;
    status = sc_trace_run(&call.subject, &scratch, r);
    sc_scratch_clear(&scratch);
    return status;
}

sc_status sc_trace(const sc_model *model, const sc_pose *pose, const sc_pair *pairs, uint64_t count,
                   const sc_trace_options *options, sc_trace_result *result)
{
    sc_trace_result r;
    sc_status status;
    if (!result) return SC_ERROR_NULL;
    status = sc_arguments_read(NULL, "result", &r, sizeof r, result,
                               SC_ARGUMENTS_UP_TO(sc_trace_result, contours));
    if (status) return status;
    r.reserved = 0;
    r.node_count = r.contour_count = 0;
    status = !model || !pose || (count && !pairs)
                 ? SC_ERROR_NULL
                 : find_trace(model, pose, pairs, count, options, &r);
    if (status && status != SC_ERROR_SHORT_BUFFER) r.node_count = r.contour_count = 0;
    sc_structs_write(result, &r, sizeof r);
    return status;
}

/* What a call about a trace was given, checked but for numbers in the trace. */
static sc_status read_traced_call(const sc_model *model, const sc_pose *pose,
                                  const sc_trace_result *trace, const sc_trace_options *options,
                                  trace_call *call, sc_trace_result *t)
{
    sc_status status = read_trace_call(model, pose, options, call);
    memset(t, 0, sizeof *t);
    if (!status)
        status = sc_arguments_read(&call->hooks, "trace", t, sizeof *t, trace,
                                   SC_ARGUMENTS_UP_TO(sc_trace_result, contours));
    if (!status)
        status = need_trace_arrays(&call->hooks, "trace", t, t->node_count, t->contour_count);
    if (!status && (t->node_count > t->node_capacity || t->contour_count > t->contour_capacity))
        status = SC_ERROR_SHORT_BUFFER; /* not all are there */
    if (!status && (t->node_count > TRACE_PAIRS_MAX || t->contour_count > TRACE_PAIRS_MAX))
        status = SC_ERROR_COUNT;
    return status;
}

static sc_status find_triples(const sc_model *model, const sc_pose *pose,
                              const sc_trace_result *trace, const sc_trace_options *options,
                              sc_triples_result *r)
{
    trace_call call;
    sc_scratch scratch;
    sc_trace_result t;
    sc_status status = read_traced_call(model, pose, trace, options, &call, &t);
    if (!status && r->capacity)
        status = sc_arguments_need(&call.hooks, "result", "triples", r->triples);
    if (status) return status;
    sc_scratch_init(&scratch, &call.allocator);
    status = sc_triples_find(&call.subject, &t, &scratch, r);
    sc_scratch_clear(&scratch);
    return status;
}

sc_status sc_trace_triples(const sc_model *model, const sc_pose *pose, const sc_trace_result *trace,
                           const sc_trace_options *options, sc_triples_result *result)
{
    sc_triples_result r;
    sc_status status;
    if (!result) return SC_ERROR_NULL;
    status = sc_arguments_read(NULL, "result", &r, sizeof r, result,
                               SC_ARGUMENTS_UP_TO(sc_triples_result, triples));
    if (status) return status;
    r.reserved = 0;
    r.count = 0;
    status =
        !model || !pose || !trace ? SC_ERROR_NULL : find_triples(model, pose, trace, options, &r);
    if (status && status != SC_ERROR_SHORT_BUFFER) r.count = 0;
    sc_structs_write(result, &r, sizeof r);
    return status;
}

static sc_status find_regions(const sc_model *model, const sc_pose *pose,
                              const sc_trace_result *trace, const sc_trace_options *options,
                              sc_regions_result *r)
{
    const sc_choice flags = {"flags", r->flags, SC_REGIONS_INSIDE};
    trace_call call;
    sc_scratch scratch;
    sc_trace_result t;
    sc_status status = read_traced_call(model, pose, trace, options, &call, &t);
    if (!status) status = sc_arguments_choose(&call.hooks, "result", &flags, 1);
    if (!status && r->region_capacity)
        status = sc_arguments_need(&call.hooks, "result", "regions", r->regions);
    if (status) return status;
    sc_scratch_init(&scratch, &call.allocator);
    status = sc_regions_find(&call.subject, &t, &scratch, r);
    sc_scratch_clear(&scratch);
    return status;
}

sc_status sc_trace_regions(const sc_model *model, const sc_pose *pose, const sc_trace_result *trace,
                           const sc_trace_options *options, sc_regions_result *result)
{
    sc_regions_result r;
    sc_status status;
    if (!result) return SC_ERROR_NULL;
    status = sc_arguments_read(NULL, "result", &r, sizeof r, result,
                               SC_ARGUMENTS_UP_TO(sc_regions_result, sides));
    if (status) return status;
    r.region_count = 0;
    status =
        !model || !pose || !trace ? SC_ERROR_NULL : find_regions(model, pose, trace, options, &r);
    if (status && status != SC_ERROR_SHORT_BUFFER) r.region_count = 0;
    sc_structs_write(result, &r, sizeof r);
    return status;
}

uint32_t sc_region_hint(const sc_region *regions, const sc_contour_sides *contour, uint32_t sheet)
{
    uint32_t first, second;
    if (!regions || !contour || sheet > 1) return SC_TRACE_NO_EDGE;
    first = contour->sides[sheet][0];
    second = contour->sides[sheet][1];
    if (first == second || regions[first].area == regions[second].area) return SC_TRACE_NO_EDGE;
    return regions[second].area < regions[first].area;
}

sc_status sc_trace_gradients(const sc_model *model, const sc_pose *pose,
                             const sc_trace_result *traced, sc_trace_gradient *gradients)
{
    sc_trace_result r;
    sc_positions positions;
    sc_pose p;
    uint64_t stride;
    sc_status status;
    if (!model || !pose || !traced) return SC_ERROR_NULL;
    status = sc_arguments_read(NULL, "traced", &r, sizeof r, traced,
                               SC_ARGUMENTS_UP_TO(sc_trace_result, contours));
    if (!status) status = sc_question_read_pose(NULL, "pose", model, pose, &p, &stride);
    if (status) return status;
    if (r.node_count > r.node_capacity || r.contour_count > r.contour_capacity)
        return SC_ERROR_SHORT_BUFFER;
    if ((r.node_count && (!r.nodes || !gradients)) || (r.contour_count && !r.contours))
        return SC_ERROR_NULL;
    sc_positions_note(model, &p, stride, &positions);
    return sc_gradients_find(model, &positions, &r, gradients);
}

/* ---- proximity ---- */

static sc_status read_vertices(const sc_pose *pose, uint64_t stride, const uint32_t vertices[4],
                               double positions[4][3])
{
    int i, k;
    for (i = 0; i < 4; i++) {
        sc_mesh_read_position(pose->positions, pose->position_type, stride, vertices[i],
                              positions[i]);
        for (k = 0; k < 3; k++)
            if (positions[i][k] - positions[i][k] != 0) return SC_ERROR_NOT_FINITE;
    }
    return SC_OK;
}

/* The vertices of a pair, those of a first; an error if there is no such pair. */
static sc_status find_vertices(const sc_model *model, uint32_t kind, const sc_pair *pair,
                               uint32_t vertices[4])
{
    const uint32_t *triangle = sc_model_triangle(model), *place = sc_model_place(model);
    uint32_t i, j, count_a = kind == SC_NEAR_VERTEX_FACE ? 1 : 2;
    if (kind == SC_NEAR_VERTEX_FACE) {
        if (pair->a >= model->vertex_count || pair->b >= model->triangle_count ||
            sc_model_vertex_use(model)[pair->a] != SC_VERTEX_POINT)
            return SC_ERROR_PAIRS;
        vertices[0] = pair->a;
        memcpy(&vertices[1], &triangle[3 * (uint64_t)place[pair->b]], 3 * sizeof *vertices);
    } else {
        for (i = 0; i < 2; i++) {
            uint32_t edge = i ? pair->b : pair->a;
            const uint32_t *corner;
            if (edge / 3 >= model->triangle_count) return SC_ERROR_PAIRS;
            corner = &triangle[3 * (uint64_t)place[edge / 3]];
            vertices[2 * i] = corner[edge % 3];
            vertices[2 * i + 1] = corner[(edge + 1) % 3];
        }
    }
    for (i = 0; i < count_a; i++)
        for (j = count_a; j < 4; j++)
            if (vertices[i] == vertices[j]) return SC_ERROR_PAIRS;
    return SC_OK;
}

sc_status sc_near_masks_create(const sc_model *model, uint32_t rings, const sc_allocator *allocator,
                               sc_near_masks **masks)
{
    sc_allocator a;
    sc_status status;
    if (!masks) return SC_ERROR_NULL;
    *masks = NULL;
    if (!model) return SC_ERROR_NULL;
    if (!rings || rings > SC_RINGS_MAX) return SC_ERROR_OPTION;
    status = read_allocator(NULL, allocator, &a);
    return status ? status : sc_masks_make(model, rings, &a, masks);
}

void sc_near_masks_free(sc_near_masks *masks)
{
    if (masks) masks->allocator.release(masks->allocator.user, masks, masks->bytes);
}

sc_status sc_near_stencils(const sc_model *model, const sc_pose *pose, uint32_t kind,
                           const sc_pair *pairs, uint64_t count, sc_near_stencil *stencils)
{
    sc_pose p;
    sc_status status;
    uint64_t stride, i;
    if (!model || !pose || (count && (!pairs || !stencils))) return SC_ERROR_NULL;
    if (kind != SC_NEAR_VERTEX_FACE && kind != SC_NEAR_EDGE_EDGE) return SC_ERROR_OPTION;
    status = sc_question_read_pose(NULL, "pose", model, pose, &p, &stride);
    for (i = 0; !status && i < count; i++) {
        double at[4][3];
        const double *points[4] = {at[0], at[1], at[2], at[3]};
        status = find_vertices(model, kind, &pairs[i], stencils[i].vertices);
        if (!status) status = read_vertices(&p, stride, stencils[i].vertices, at);
        if (!status) sc_stencil_find(kind, points, &stencils[i]);
    }
    return status;
}

sc_status sc_step_stencils(const sc_model *model, const sc_pose *start, const sc_pose *end,
                           uint32_t kind, const sc_pair *pairs, const double *times, uint64_t count,
                           sc_step_stencil *stencils)
{
    sc_pose poses[2];
    sc_status status;
    uint64_t stride[2], i;
    if (!model || !start || !end || (count && (!pairs || !stencils))) return SC_ERROR_NULL;
    if (kind != SC_NEAR_VERTEX_FACE && kind != SC_NEAR_EDGE_EDGE) return SC_ERROR_OPTION;
    status = sc_question_read_pose(NULL, "start", model, start, &poses[0], &stride[0]);
    if (!status) status = sc_question_read_pose(NULL, "end", model, end, &poses[1], &stride[1]);
    for (i = 0; !status && i < count; i++) {
        sc_step_stencil *s = &stencils[i];
        double at[2][4][3];
        s->time = times ? times[i] : 0;
        if (!(s->time >= 0 && s->time <= 1)) return SC_ERROR_OPTION;
        status = find_vertices(model, kind, &pairs[i], s->start.vertices);
        if (!status) status = read_vertices(&poses[0], stride[0], s->start.vertices, at[0]);
        if (!status) status = read_vertices(&poses[1], stride[1], s->start.vertices, at[1]);
        if (status) return status;
        memcpy(s->impact.vertices, s->start.vertices, sizeof s->start.vertices);
        sc_step_stencil_find(kind, (const double(*)[3])at[0], (const double(*)[3])at[1], s);
    }
    return status;
}

sc_status sc_near_merge(sc_near_stencil *stencils, uint64_t count, uint64_t *merged_count,
                        uint32_t *multiplicities)
{
    if (!merged_count) return SC_ERROR_NULL;
    *merged_count = 0;
    if (count && (!stencils || !multiplicities)) return SC_ERROR_NULL;
    if (count > UINT32_MAX) return SC_ERROR_COUNT;
    *merged_count = sc_merging_run(stencils, (uint32_t)count, multiplicities);
    return SC_OK;
}

/* ---- records ---- */

/* The pose, its stride, the options and the filter, if there is one, as the caller meant them;
   o->filter is filter then. */
static sc_status check_record(const sc_model *model, const sc_pose *pose,
                              const sc_query_options *options, sc_pose *p, uint64_t *stride,
                              sc_query_options *o, sc_filter *filter)
{
    sc_query_options checked;
    sc_status status;
    if (!model || !pose) return SC_ERROR_NULL;
    status = sc_question_read_options(NULL, options, o);
    if (status) return status;
    checked = *o; /* defaults stay defaults */
    status = sc_question_choose(model, &checked);
    if (status) return status;
    if (o->filter) {
        status = sc_filter_read(NULL, "options.filter", model, o->pairs, o->filter, filter);
        if (status) return status;
        o->filter = filter;
    }
    return sc_question_read_pose(NULL, "pose", model, pose, p, stride);
}

sc_status sc_record_size(const sc_model *model, const sc_pose *pose,
                         const sc_query_options *options, uint64_t *size)
{
    sc_query_options o;
    sc_pose p;
    sc_filter filter;
    uint64_t stride;
    sc_status status;
    if (!size) return SC_ERROR_NULL;
    status = check_record(model, pose, options, &p, &stride, &o, &filter);
    if (!status) *size = sc_recording_bytes(model, &p, o.filter);
    return status;
}

sc_status sc_record_write(const sc_model *model, const sc_pose *pose,
                          const sc_query_options *options, void *memory, uint64_t size,
                          uint64_t *written)
{
    sc_query_options o;
    sc_pose p;
    sc_filter filter;
    uint64_t stride, bytes;
    sc_status status;
    if (written) *written = 0;
    status = check_record(model, pose, options, &p, &stride, &o, &filter);
    if (status) return status;
    bytes = sc_recording_bytes(model, &p, o.filter);
    if (written) *written = bytes;
    if (size < bytes) return SC_ERROR_SHORT_BUFFER;
    if (!memory) return SC_ERROR_NULL;
    sc_recording_write(model, &p, stride, &o, memory);
    return SC_OK;
}

/* A step or a search, checked. */
static sc_status write_features(const sc_model *model, const sc_recorded *recorded, void *memory,
                                uint64_t size, uint64_t *written)
{
    const uint64_t bytes = sc_recording_features_bytes(model, recorded);
    if (written) *written = bytes;
    if (size < bytes) return SC_ERROR_SHORT_BUFFER;
    if (!memory) return SC_ERROR_NULL;
    sc_recording_features_write(model, recorded, memory);
    return SC_OK;
}

sc_status sc_record_step_size(const sc_model *model, const sc_pose *start, const sc_pose *end,
                              const sc_step_options *options, uint64_t *size)
{
    sc_recorded recorded;
    sc_status status;
    if (!size) return SC_ERROR_NULL;
    status = sc_recorded_step(model, start, end, options, &recorded);
    if (!status) *size = sc_recording_features_bytes(model, &recorded);
    return status;
}

sc_status sc_record_step_write(const sc_model *model, const sc_pose *start, const sc_pose *end,
                               const sc_step_options *options, void *memory, uint64_t size,
                               uint64_t *written)
{
    sc_recorded recorded;
    sc_status status;
    if (written) *written = 0;
    status = sc_recorded_step(model, start, end, options, &recorded);
    return status ? status : write_features(model, &recorded, memory, size, written);
}

sc_status sc_record_near_size(const sc_model *model, const sc_pose *pose,
                              const sc_near_options *options, uint64_t *size)
{
    sc_recorded recorded;
    sc_status status;
    if (!size) return SC_ERROR_NULL;
    status = sc_recorded_near(model, pose, options, &recorded);
    if (!status) *size = sc_recording_features_bytes(model, &recorded);
    return status;
}

sc_status sc_record_near_write(const sc_model *model, const sc_pose *pose,
                               const sc_near_options *options, void *memory, uint64_t size,
                               uint64_t *written)
{
    sc_recorded recorded;
    sc_status status;
    if (written) *written = 0;
    status = sc_recorded_near(model, pose, options, &recorded);
    return status ? status : write_features(model, &recorded, memory, size, written);
}

/* A structure of the caller's, and what of the record it is for. */
typedef struct record_part {
    void *to; /* or NULL */
    const void *from;
    uint32_t size, least; /* as sc_arguments_check takes them */
    int is_there;         /* the record has it */
} record_part;

enum { RECORD_PARTS = 8 };

static void list_record_parts(const sc_record *r, const sc_recording *found,
                              record_part parts[RECORD_PARTS])
{
    const uint32_t pose = SC_ARGUMENTS_UP_TO(sc_pose, positions), all = SC_ARGUMENTS_DEFAULTS;
    const sc_step_options *step = &found->step_options;
    const sc_near_options *search = &found->near_options;
    const sc_pose *rest = &found->pose[SC_RECORDED_REST];
    const record_part list[RECORD_PARTS] = {
        {r->pose, &found->pose[SC_RECORDED_START], sizeof(sc_pose), pose, 1},
        {r->end, &found->pose[SC_RECORDED_END], sizeof(sc_pose), pose,
         found->kind == SC_RECORD_STEP},
        {r->rest, rest, sizeof(sc_pose), pose, rest->positions != NULL},
        {r->options, &found->options, sizeof(sc_query_options), all,
         found->kind == SC_RECORD_QUERY},
        {r->step_options, step, sizeof(sc_step_options), all, found->kind == SC_RECORD_STEP},
        {r->near_options, search, sizeof(sc_near_options), all, found->kind == SC_RECORD_NEAR},
        {r->filter, &found->filter[0], sizeof(sc_filter), all,
         found->options.filter || step->vertex_face_filter || search->vertex_face_filter},
        {r->edge_edge_filter, &found->filter[1], sizeof(sc_filter), all,
         step->edge_edge_filter || search->edge_edge_filter},
    };
    memcpy(parts, list, sizeof list);
}

/* Filters and rest pose of options become the caller's. */
static void place_record_filters(const sc_record *r, const sc_filter **vertex_face,
                                 const sc_filter **edge_edge, const sc_pose **rest)
{
    if (*vertex_face) *vertex_face = r->filter;
    if (*edge_edge) *edge_edge = r->edge_edge_filter;
    if (*rest) *rest = r->rest;
}

sc_status sc_record_read(const void *data, uint64_t size, sc_record *record)
{
    record_part parts[RECORD_PARTS];
    sc_recording found;
    sc_step_options *step = &found.step_options;
    sc_near_options *search = &found.near_options;
    sc_record r;
    sc_status status;
    int k;
    if (!data || !record) return SC_ERROR_NULL;
    status = sc_arguments_read(NULL, "record", &r, sizeof r, record,
                               SC_ARGUMENTS_UP_TO(sc_record, model_size));
    if (status) return status;
    memset(&found, 0, sizeof found);
    list_record_parts(&r, &found, parts);
    for (k = 0; k < RECORD_PARTS && !status; k++)
        if (parts[k].to)
            status = sc_arguments_check(NULL, "record", parts[k].to, parts[k].size, parts[k].least);
    if (!status) status = sc_recording_read(data, size, &found);
    if (status) return status;
    list_record_parts(&r, &found, parts);
    for (k = 0; k < RECORD_PARTS; k++)
        if (parts[k].is_there && !parts[k].to) return SC_ERROR_NULL;
    for (k = 0; k < RECORD_PARTS; k++)
        if (parts[k].to && !sc_structs_reach(parts[k].to, parts[k].from, parts[k].size))
            return SC_ERROR_STRUCT_SIZE;
    if (found.options.filter) found.options.filter = r.filter;
    place_record_filters(&r, &step->vertex_face_filter, &step->edge_edge_filter, &step->rest);
    place_record_filters(&r, &search->vertex_face_filter, &search->edge_edge_filter, &search->rest);
    for (k = 0; k < RECORD_PARTS; k++)
        if (parts[k].to) sc_structs_write(parts[k].to, parts[k].from, parts[k].size);
    r.left_out = found.left_out;
    r.model = found.model;
    r.model_size = found.model_size;
    r.kind = found.kind;
    r.mask_rings = found.mask_rings;
    sc_structs_write(record, &r, sizeof r);
    return SC_OK;
}
