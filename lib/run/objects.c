/*
 * Several objects in one query. See objects.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "run/objects.h"

#include <float.h>
#include <inttypes.h>
#include <math.h>
#include <string.h>

#include "base/arguments.h"
#include "base/clock.h"
#include "base/hooks.h"
#include "pose/positions.h"
#include "pose/refit.h"
#include "query/filter.h"
#include "query/simple.h"
#include "run/plan.h"

/* The call at hand. */
typedef struct objects_run {
    const sc_objects_question *asked;
    sc_objects_result *result;
    uint64_t ranges; /* found so far, of which those that fit are in the caller's array */
    int incomplete;
} objects_run;

/* What the caller's function is asked with. */
typedef struct accept_between {
    const sc_objects *objects;
    uint32_t a, b;
} accept_between;

static const sc_object *object_at(const sc_objects *objects, uint32_t i)
{
    return (const sc_object *)(const void *)((const unsigned char *)(const void *)objects->objects +
                                             i * objects->stride);
}

static const sc_hooks *hooks_of(const sc_object *object)
{
    return object->workspace ? &object->workspace->hooks : NULL;
}

/* ---- arguments ---- */

static sc_status check_object(const sc_object *o)
{
    const sc_hooks *hooks = hooks_of(o);
    const sc_choice choices[] = {{"itself", o->itself, 1}, {"reserved", o->reserved, 0}};
    sc_status status = sc_arguments_need(hooks, "object", "workspace", o->workspace);
    if (!status) status = sc_arguments_need(hooks, "object", "model", o->model);
    if (!status) status = sc_arguments_need(hooks, "object", "pose", o->pose);
    if (!status) status = sc_arguments_choose(hooks, "object", choices, 2);
    if (!status && o->end) {
        sc_hooks_log(hooks, SC_LOG_ERROR, "object.end is for steps");
        status = SC_ERROR_OPTION;
    }
    return status ? status : sc_question_check_workspace(o->model, o->workspace, 0);
}

/* Each object by itself, and that no workspace is in two: each gets the number of its object. */
static sc_status check_objects(const sc_objects *objects)
{
    sc_status status;
    uint32_t i;
    for (i = 0; i < objects->count; i++) {
        status = check_object(object_at(objects, i));
        if (status) return status;
        object_at(objects, i)->workspace->object = 0;
    }
    for (i = 0; i < objects->count; i++) {
        sc_workspace *w = object_at(objects, i)->workspace;
        if (w->object) {
            sc_hooks_log(&w->hooks, SC_LOG_ERROR,
                         "objects %" PRIu32 " and %" PRIu32 " have one workspace", w->object - 1,
                         i);
            return SC_ERROR_WORKSPACE;
        }
        w->object = i + 1;
    }
    return SC_OK;
}

static sc_status read_tasks(const sc_tasks *from, sc_objects_question *q)
{
    sc_status status;
    if (!from) return SC_OK;
    status = sc_arguments_read(NULL, "options.tasks", &q->tasks, sizeof q->tasks, from,
                               SC_ARGUMENTS_UP_TO(sc_tasks, finish));
    if (status) return status;
    if (!q->tasks.enqueue || !q->tasks.finish) return SC_ERROR_NULL;
    if (q->tasks.workers > SC_WORKERS_MAX) return SC_ERROR_OPTION;
    if (q->tasks.workers > 1) q->given = &q->tasks;
    return SC_OK;
}

sc_status sc_objects_read(const sc_objects *objects, const sc_query_options *options,
                          sc_objects_question *q)
{
    sc_status status;
    memset(q, 0, sizeof *q);
    status = sc_arguments_need(NULL, "objects", NULL, objects);
    if (!status)
        status = sc_arguments_read(NULL, "objects", &q->objects, sizeof q->objects, objects,
                                   SC_ARGUMENTS_UP_TO(sc_objects, objects));
    if (!status) status = sc_question_read_options(NULL, options, &q->options);
    if (status) return status;
    if (q->objects.count && !q->objects.objects) return SC_ERROR_NULL;
    if (!q->objects.stride) q->objects.stride = sizeof(sc_object);
    if (q->objects.stride < sizeof(sc_object) || q->objects.stride % sizeof(void *))
        return SC_ERROR_STRIDE;
    if (q->options.filter || q->options.budget || q->options.contour == SC_CONTOUR_STAR ||
        q->options.contour == SC_CONTOUR_NONE)
        return SC_ERROR_OPTION;
    if (q->options.simd > (uint32_t)sc_isa_best()) return SC_ERROR_UNSUPPORTED;
    if (q->options.simd == SC_SIMD_BEST) q->options.simd = (uint32_t)sc_isa_best();
    status = read_tasks(q->options.tasks, q);
    return status ? status : check_objects(&q->objects);
}

/* ---- poses ---- */

/* Notes where a pose is, and finds the box of its points; unless it is that of the last call. */
static sc_status read_pose(const objects_run *run, const sc_object *o)
{
    sc_workspace *w = o->workspace;
    sc_pose pose;
    uint64_t stride;
    sc_status status =
        sc_question_read_pose(&w->hooks, "object.pose", o->model, o->pose, &pose, &stride);
    if (status) return status;
    w->frame.kernels = sc_kernels_for(run->asked->options.simd);
    w->frame.tasks = NULL;
    if (o->pose_version && o->pose_version == w->pose_version) {
        sc_positions_note(o->model, &pose, stride, &w->frame.positions[0]);
        return SC_OK;
    }
    sc_workspace_forget(w);
    status = sc_positions_read(o->model, &pose, stride, &w->frame);
    if (status) {
        sc_hooks_log(&w->hooks, SC_LOG_ERROR, "object %" PRIu32 " has a vertex that is not finite",
                     w->object - 1);
        sc_question_log_not_finite(&w->hooks, o->model, &pose, stride, "");
    }
    return status;
}

/* The unit box of all objects. */
typedef struct unit_box {
    double center[3];
    int exponent; /* of the radius */
} unit_box;

/* The largest distance of a coordinate of some box from a center. */
static double reach_of(const double low[3], const double high[3], const double center[3])
{
    double reach = 0;
    int k;
    for (k = 0; k < 3; k++) reach = fmax(reach, fmax(high[k] - center[k], center[k] - low[k]));
    return reach;
}

/* Whether all is within a unit box that is not much too large for it. */
static int fits_box(const double low[3], const double high[3], double half, const unit_box *box)
{
    const double reach = ldexp(1, box->exponent);
    return reach_of(low, high, box->center) * 1.000001 < reach && 8 * half >= reach;
}

/* A box of all objects, with a center that is of floats, as some positions may be; that of the last
   call, *box, if it fits. */
static void choose_box(const double low[3], const double high[3], int has_last, unit_box *box)
{
    double half = 0;
    int k;
    for (k = 0; k < 3; k++) half = fmax(half, high[k] / 2 - low[k] / 2);
    if (has_last && fits_box(low, high, half, box)) return;
    for (k = 0; k < 3; k++) {
        const double middle = low[k] / 2 + high[k] / 2;
        box->center[k] = fabs(middle) < (double)FLT_MAX ? sc_positions_rounded(middle) : middle;
    }
    (void)frexp(reach_of(low, high, box->center) * 1.000001, &box->exponent);
    if (box->exponent < -1022) box->exponent = -1022;
}

/* That of a frame. */
static void find_box(const sc_frame *frame, unit_box *box)
{
    memcpy(box->center, frame->center, sizeof box->center);
    (void)frexp(frame->scale, &box->exponent);
    box->exponent = 1 - box->exponent;
}

/* Reads all poses, and gives their frames one unit box. */
static sc_status read_poses(const objects_run *run)
{
    const sc_objects *objects = &run->asked->objects;
    double low[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, high[3] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
    unit_box box;
    uint32_t i;
    int k, has_last = 0;
    for (i = 0; i < objects->count; i++) {
        const sc_object *o = object_at(objects, i);
        const sc_frame *f = &o->workspace->frame;
        const sc_status status = read_pose(run, o);
        if (status) return status;
        if (o->workspace->pose_version && !has_last) {
            find_box(f, &box);
            has_last = 1;
        }
        for (k = 0; k < 3; k++) {
            low[k] = fmin(low[k], f->low[k]);
            high[k] = fmax(high[k], f->high[k]);
        }
    }
    if (!objects->count) return SC_OK;
    choose_box(low, high, has_last, &box);
    for (i = 0; i < objects->count; i++) {
        const sc_object *o = object_at(objects, i);
        sc_workspace *w = o->workspace;
        unit_box own;
        find_box(&w->frame, &own);
        if (!w->pose_version || own.exponent != box.exponent ||
            memcmp(own.center, box.center, sizeof box.center) != 0) {
            sc_workspace_forget(w);
            sc_positions_move(&w->frame, box.center);
            sc_positions_scale(&w->frame, box.exponent);
            w->pose_version = o->pose_version;
        }
    }
    return SC_OK;
}

/* ---- queries ---- */

/* Whether what is found is written into an array. */
static uint64_t room_for_pairs(const objects_run *run)
{
    const sc_objects_result *r = run->result;
    if (run->asked->options.output != SC_OUTPUT_PAIRS || r->count >= r->capacity) return 0;
    return r->capacity - r->count;
}

/* The tasks, if all workspaces are for as many workers. */
static const sc_tasks *tasks_of(const objects_run *run, const sc_object *a, const sc_object *b)
{
    const sc_tasks *tasks = run->asked->given;
    if (!tasks || a->workspace->sizes.workers < tasks->workers ||
        b->workspace->sizes.workers < tasks->workers)
        return NULL;
    return tasks;
}

/* Has a question answered in a workspace, and takes down what was found. */
static void answer(objects_run *run, const sc_object *a, const sc_object *b, sc_question *q)
{
    sc_objects_result *r = run->result;
    sc_workspace *w = a->workspace;
    sc_worker *worker = sc_workspace_resume(a->model, w, q);
    const uint64_t start = q->timed ? sc_clock_nanoseconds() : 0;
    worker->last_time = start;
    sc_workspace_keep_all(w);
    if (!sc_worker_stops(worker)) sc_plan_run(w);
    if (q->timed) {
        worker->stats.nanoseconds[worker->task] += sc_clock_nanoseconds() - worker->last_time;
        sc_worker_add_stats(r->stats, &worker->stats);
    }
    run->incomplete |= worker->incomplete;
    if (!worker->count) return;
    if (run->ranges < r->range_capacity) {
        sc_object_pairs *range = &r->ranges[run->ranges];
        range->object_a = a->workspace->object - 1;
        range->object_b = b->workspace->object - 1;
        range->first = r->count;
        range->count = worker->count;
    }
    run->ranges++;
    r->count += worker->count;
}

static void begin_question(const objects_run *run, const sc_object *a, const sc_object *b,
                           sc_question *q)
{
    const sc_query_options *o = &run->asked->options;
    memset(q, 0, sizeof *q);
    q->options = *o;
    q->options.tasks = tasks_of(run, a, b);
    q->capacity = room_for_pairs(run);
    q->pairs = q->capacity ? run->result->pairs + run->result->count : NULL;
    q->timed = run->result->stats != NULL;
    q->ends_early = o->output == SC_OUTPUT_ANY;
    q->test = sc_simple_tests;
    q->keeps = 1;
}

static int is_over(const objects_run *run)
{
    return run->incomplete ||
           (run->asked->options.output == SC_OUTPUT_ANY && run->result->count > 0);
}

/* What an object is asked about itself. */
static sc_status ask_itself(const objects_run *run, const sc_object *o, sc_question *q,
                            sc_filter *filter)
{
    sc_status status;
    begin_question(run, o, o, q);
    status = sc_question_choose(o->model, &q->options);
    q->has_last = q->options.method == SC_METHOD_SCTT;
    if (!status && o->filter) status = sc_filter_begin(q, hooks_of(o), o->model, o->filter, filter);
    return status;
}

/* Whether all that do so can be: before anything is written. */
static sc_status check_those_asked(const objects_run *run)
{
    const sc_objects *objects = &run->asked->objects;
    sc_question q;
    sc_filter filter;
    sc_status status = SC_OK;
    uint32_t i;
    for (i = 0; i < objects->count && !status; i++)
        if (object_at(objects, i)->itself)
            status = ask_itself(run, object_at(objects, i), &q, &filter);
    return status;
}

static sc_status look_at_itself(objects_run *run, const sc_object *o)
{
    sc_question q;
    sc_filter filter;
    sc_status status = ask_itself(run, o, &q, &filter);
    if (status) return status;
    o->workspace->frame.tasks = sc_plan_tasks(o->model, &q);
    answer(run, o, o, &q);
    return SC_OK;
}

/* ---- two objects ---- */

static int groups_collide(const sc_object *a, const sc_object *b)
{
    const sc_group all = {0xffffffffu, 0xffffffffu};
    const sc_group x = a->group.category || a->group.mask ? a->group : all;
    const sc_group y = b->group.category || b->group.mask ? b->group : all;
    return sc_filter_groups_collide(x, y);
}

static int boxes_meet(const sc_frame *a, const sc_frame *b)
{
    int k, meet = 1;
    for (k = 0; k < 3; k++) meet &= (a->low[k] <= b->high[k]) & (b->low[k] <= a->high[k]);
    return meet;
}

/* Boxes and points of an object, for others to be compared with. */
static void make_boxes(objects_run *run, const sc_object *o, const sc_tasks *tasks)
{
    sc_frame *frame = &o->workspace->frame;
    const uint64_t start = run->result->stats ? sc_clock_nanoseconds() : 0;
    if (frame->boxes_ready) return;
    frame->tasks = o->model->leaf_count < 128 ? NULL : tasks;
    sc_refit_boxes(o->model, frame);
    if (!run->result->stats) return;
    run->result->stats->counts[SC_TASK_UPDATE_BOXES] +=
        (uint64_t)o->model->patch_end + o->model->triangle_count;
    run->result->stats->nanoseconds[SC_TASK_UPDATE_BOXES] += sc_clock_nanoseconds() - start;
}

static int accept_pair(void *user, uint32_t a, uint32_t b)
{
    const accept_between *between = (const accept_between *)user;
    return between->objects->accept(between->objects->accept_user, between->a, between->b, a, b);
}

static void look_at_two(objects_run *run, const sc_object *a, const sc_object *b)
{
    const sc_objects *objects = &run->asked->objects;
    accept_between between;
    sc_question q;
    sc_filter filter;
    begin_question(run, a, b, &q);
    make_boxes(run, a, q.options.tasks);
    make_boxes(run, b, q.options.tasks);
    q.second = b->workspace;
    sc_workspace_lend(b->model, b->workspace, &q, q.options.tasks ? q.options.tasks->workers : 1);
    q.options.method = SC_METHOD_AABB;
    q.options.contour = SC_CONTOUR_EXACT;
    if (objects->accept) {
        between.objects = objects;
        between.a = a->workspace->object - 1;
        between.b = b->workspace->object - 1;
        memset(&filter, 0, sizeof filter);
        filter.struct_size = sizeof filter;
        filter.accept = accept_pair;
        filter.accept_user = &between;
        q.filter = &filter;
    }
    answer(run, a, b, &q);
}

/* An object with itself and with those behind it; of edges with triangles, with those before it as
   well. */
static sc_status look_at(objects_run *run, uint32_t i)
{
    const sc_objects *objects = &run->asked->objects;
    const sc_object *a = object_at(objects, i);
    const int edges = run->asked->options.pairs == SC_PAIRS_EDGE;
    uint32_t j;
    sc_status status;
    for (j = edges ? 0 : i; j < objects->count && !is_over(run); j++) {
        const sc_object *b = object_at(objects, j);
        if (i == j) {
            if (a->itself && (status = look_at_itself(run, a))) return status;
        } else if (boxes_meet(&a->workspace->frame, &b->workspace->frame) && groups_collide(a, b)) {
            look_at_two(run, a, b);
        }
    }
    return SC_OK;
}

sc_status sc_objects_run(const sc_objects_question *question, sc_objects_result *result)
{
    const uint64_t start = result->stats ? sc_clock_nanoseconds() : 0;
    objects_run run;
    sc_status status;
    uint32_t i;
    memset(&run, 0, sizeof run);
    run.asked = question;
    run.result = result;
    status = check_those_asked(&run);
    if (!status) status = read_poses(&run);
    for (i = 0; !status && i < question->objects.count && !is_over(&run); i++)
        status = look_at(&run, i);
    result->range_count = run.ranges;
    if (result->stats) result->stats->total_nanoseconds = sc_clock_nanoseconds() - start;
    if (status) return status;
    if (run.incomplete) return SC_ERROR_INCOMPLETE;
    if (question->options.output == SC_OUTPUT_PAIRS && result->count > result->capacity)
        return SC_ERROR_SHORT_BUFFER;
    return run.ranges > result->range_capacity && result->range_capacity ? SC_ERROR_SHORT_BUFFER
                                                                         : SC_OK;
}
