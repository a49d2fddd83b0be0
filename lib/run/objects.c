/*
 * Several objects in one query. See objects.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "run/objects.h"

#include <string.h>

#include "base/clock.h"
#include "base/hooks.h"
#include "query/filter.h"
#include "query/simple.h"
#include "run/near_question.h"
#include "run/objects_frame.h"
#include "run/plan.h"
#include "run/step_question.h"
#include "step/step_filter.h"

/* The call at hand. Of a list's ranges those that fit are in the caller's array. */
typedef struct objects_run {
    const sc_objects_question *asked;
    sc_objects_answer *answer;
    double clearance;
    int incomplete;
} objects_run;

/* What one object, or two, are asked. */
typedef struct part_question {
    sc_question *query; /* of those below: */
    sc_question plain;
    sc_near_question near; /* of what is near, or its step is that of a step */
    sc_asked asked;
    sc_filter filter;
} part_question;

/* What the caller's functions are asked with. */
typedef struct accept_between {
    const sc_objects *objects;
    uint32_t a, b;
} accept_between;

static const sc_object *object_at(const objects_run *run, uint32_t i)
{
    return sc_objects_question_object(&run->asked->objects, i);
}

static const sc_hooks *hooks_of(const sc_object *object)
{
    return &object->workspace->hooks;
}

static int is_over(const objects_run *run)
{
    const sc_objects_answer *a = run->answer;
    return run->incomplete || (run->asked->ends_early && a->list[0].count + a->list[1].count > 0);
}

/* ---- questions ---- */

/* The tasks, if all workspaces are for as many workers. */
static const sc_tasks *tasks_of(const objects_run *run, const sc_object *a, const sc_object *b)
{
    const sc_tasks *tasks = run->asked->given;
    if (!tasks || a->workspace->sizes.workers < tasks->workers ||
        b->workspace->sizes.workers < tasks->workers)
        return NULL;
    return tasks;
}

/* What of a list of the caller's is not written yet. */
static sc_object_list rest_of(const objects_run *run, int kind)
{
    sc_object_list rest = run->answer->list[kind];
    const int has_room = run->asked->output == SC_OUTPUT_PAIRS && rest.count < rest.capacity;
    rest.capacity = has_room ? rest.capacity - rest.count : 0;
    rest.pairs = has_room ? rest.pairs + rest.count : NULL;
    rest.times = has_room && rest.times ? rest.times + rest.count : NULL;
    return rest;
}

static void begin_plain(const objects_run *run, const sc_tasks *tasks, part_question *q)
{
    const sc_object_list rest = rest_of(run, 0);
    q->query = &q->plain;
    q->plain.options = run->asked->options;
    q->plain.options.tasks = tasks;
    q->plain.capacity = rest.capacity;
    q->plain.pairs = rest.pairs;
    q->plain.timed = run->answer->stats != NULL;
    q->plain.ends_early = run->asked->ends_early;
    q->plain.test = sc_simple_tests;
}

/* Options of what is near, on a model or between two objects. */
static sc_status begin_near(const objects_run *run, const sc_model *model, const sc_tasks *tasks,
                            part_question *q)
{
    const sc_object_list faces = rest_of(run, SC_STEP_VERTEX_FACE);
    const sc_object_list pairs = rest_of(run, SC_STEP_EDGE_EDGE);
    sc_near_options *o = &q->near.options;
    sc_near_result lists;
    sc_status status;
    q->near = run->asked->near;
    q->query = &q->near.step.query;
    o->tasks = tasks;
    if (!model) o->method = SC_NEAR_METHOD_BOXES;
    status = model ? sc_near_question_choose(model, o) : SC_OK;
    memset(&lists, 0, sizeof lists);
    lists.vertex_faces = faces.pairs;
    lists.vertex_face_capacity = faces.capacity;
    lists.edge_edges = pairs.pairs;
    lists.edge_edge_capacity = pairs.capacity;
    lists.stats = run->answer->stats;
    sc_near_question_fill(&lists, &q->near);
    return status;
}

static sc_status begin_step(const objects_run *run, const sc_model *model, const sc_tasks *tasks,
                            part_question *q)
{
    const sc_object_list faces = rest_of(run, SC_STEP_VERTEX_FACE);
    const sc_object_list pairs = rest_of(run, SC_STEP_EDGE_EDGE);
    sc_step_options *o = &q->near.step.options;
    sc_step_result lists;
    sc_status status;
    q->near.step = run->asked->near.step;
    q->query = &q->near.step.query;
    o->tasks = tasks;
    if (!model && o->method != SC_STEP_METHOD_SWEPT) o->method = SC_STEP_METHOD_TWO_BOXES;
    status = model ? sc_step_question_choose(model, o) : SC_OK;
    memset(&lists, 0, sizeof lists);
    lists.vertex_faces = faces.pairs;
    lists.vertex_face_times = faces.times;
    lists.vertex_face_capacity = faces.capacity;
    lists.edge_edges = pairs.pairs;
    lists.edge_edge_times = pairs.times;
    lists.edge_edge_capacity = pairs.capacity;
    lists.stats = run->answer->stats;
    sc_step_question_fill(&lists, &q->near.step);
    q->near.step.limits = run->asked->near.step.limits;
    return status;
}

/* A question without a filter; model: what it is asked of, or NULL: two objects. */
static sc_status begin_question(const objects_run *run, const sc_model *model,
                                const sc_tasks *tasks, part_question *q)
{
    sc_status status = SC_OK;
    memset(q, 0, sizeof *q);
    if (run->asked->about == SC_QUESTION_NEAR) {
        status = begin_near(run, model, tasks, q);
    } else if (run->asked->about == SC_QUESTION_STEP) {
        status = begin_step(run, model, tasks, q);
    } else {
        begin_plain(run, tasks, q);
        if (model) status = sc_question_choose(model, &q->plain.options);
        q->plain.has_last = model && q->plain.options.method == SC_METHOD_SCTT;
    }
    q->query->keeps = 1;
    return status;
}

/* Which pairs of an object with itself are not wanted. */
static sc_status begin_filters(const objects_run *run, const sc_object *o, part_question *q)
{
    sc_step_question *step = &q->near.step;
    sc_frame *frame = &o->workspace->frame;
    sc_status status;
    if (run->asked->about == SC_QUESTION_QUERY)
        return o->filter ? sc_filter_begin(q->query, hooks_of(o), o->model, o->filter, &q->filter)
                         : SC_OK;
    step->options.vertex_face_filter = o->vertex_face_filter;
    step->options.edge_edge_filter = o->edge_edge_filter;
    step->options.rest = o->rest;
    step->options.rest_distance = o->rest_distance;
    q->near.options.masks = o->masks;
    if (o->masks && !sc_masks_fit(o->masks, o->model)) {
        sc_hooks_log(hooks_of(o), SC_LOG_ERROR, "object.masks are of another model");
        return SC_ERROR_OPTION;
    }
    status = sc_step_question_read_filters(hooks_of(o), o->model, &q->asked, step);
    if (status) return status;
    status = sc_step_filter_begin(o->model, step->options.rest, q->asked.rest_stride,
                                  step->options.rest_distance, NULL, frame->motion.vertex_groups,
                                  &step->filters);
    if (status)
        sc_question_log_not_finite(hooks_of(o), o->model, &q->asked.rest, q->asked.rest_stride,
                                   " in the rest pose");
    return status;
}

/* What an object is asked about itself. */
static sc_status ask_itself(const objects_run *run, const sc_object *o, part_question *q)
{
    const sc_status status = begin_question(run, o->model, tasks_of(run, o, o), q);
    return status ? status : begin_filters(run, o, q);
}

/* Whether all that are asked about themselves can be: before anything is written. */
static sc_status check_those_asked(const objects_run *run)
{
    part_question q;
    sc_status status = SC_OK;
    uint32_t i;
    for (i = 0; i < run->asked->objects.count && !status; i++)
        if (object_at(run, i)->itself) status = ask_itself(run, object_at(run, i), &q);
    return status;
}

/* ---- answers ---- */

/* Takes down how many pairs of a list are of two objects. */
static void add_range(objects_run *run, const sc_object *a, const sc_object *b, int kind,
                      uint64_t count)
{
    sc_object_list *list = &run->answer->list[kind];
    if (!count) return;
    if (list->range_count < list->range_capacity) {
        sc_object_pairs *range = &list->ranges[list->range_count];
        range->object_a = a->workspace->object - 1;
        range->object_b = b->workspace->object - 1;
        range->first = list->count;
        range->count = count;
    }
    list->range_count++;
    list->count += count;
}

/* How many entries of a sorted list are not turned. */
static uint64_t count_not_turned(const sc_pair *pairs, uint64_t count)
{
    uint64_t low = 0, high = count;
    while (low < high) {
        const uint64_t middle = low + (high - low) / 2;
        if (pairs[middle].a < SC_STEP_TURNED)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

/* Vertices with faces: in a list that fits, those of b with faces of a are behind the others. */
static void add_vertex_faces(objects_run *run, const sc_object *a, const sc_object *b,
                             const sc_step_worker *step)
{
    const sc_object_list rest = rest_of(run, SC_STEP_VERTEX_FACE);
    sc_pair *const pairs = rest.pairs;
    const uint64_t count = step->count[SC_STEP_VERTEX_FACE];
    const int fits = count <= rest.capacity;
    const uint64_t there = fits ? count : rest.capacity;
    const uint64_t first = count_not_turned(pairs, there);
    /* where the caller's function is asked in the end, what was found was more */
    const uint64_t turned = fits ? count - first : step->turned;
    uint64_t i;
    for (i = first; i < there; i++) pairs[i].a &= ~SC_STEP_TURNED;
    add_range(run, a, b, SC_STEP_VERTEX_FACE, count - turned);
    add_range(run, b, a, SC_STEP_VERTEX_FACE, turned);
}

/* Has a question answered in a workspace, and takes down what was found. */
static void answer(objects_run *run, const sc_object *a, const sc_object *b, const sc_question *q)
{
    sc_workspace *w = a->workspace;
    sc_worker *worker = sc_workspace_resume(a->model, w, q);
    worker->last_time = q->timed ? sc_clock_nanoseconds() : 0;
    if (!q->step) sc_workspace_keep_all(w);
    if (!sc_worker_stops(worker)) sc_plan_run(w);
    if (q->timed) {
        worker->stats.nanoseconds[worker->task] += sc_clock_nanoseconds() - worker->last_time;
        sc_worker_add_stats(run->answer->stats, &worker->stats);
    }
    run->incomplete |= worker->incomplete;
    if (!q->step) {
        add_range(run, a, b, 0, worker->count);
        return;
    }
    add_vertex_faces(run, a, b, worker->step);
    add_range(run, a, b, SC_STEP_EDGE_EDGE, worker->step->count[SC_STEP_EDGE_EDGE]);
    if (worker->step->earliest < run->answer->earliest)
        run->answer->earliest = worker->step->earliest;
}

static sc_status look_at_itself(objects_run *run, const sc_object *o)
{
    part_question q;
    const sc_status status = ask_itself(run, o, &q);
    if (status) return status;
    o->workspace->frame.tasks = sc_plan_tasks(o->model, q.query);
    answer(run, o, o, q.query);
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

static int accept_pair(void *user, uint32_t a, uint32_t b)
{
    const accept_between *at = (const accept_between *)user;
    return at->objects->accept(at->objects->accept_user, at->a, at->b, a, b);
}

static int accept_vertex_face(void *user, uint32_t a, uint32_t b)
{
    const accept_between *at = (const accept_between *)user;
    const int turned = a >= SC_STEP_TURNED;
    return at->objects->accept_near(at->objects->accept_user, SC_NEAR_VERTEX_FACE,
                                    turned ? at->b : at->a, turned ? at->a : at->b,
                                    a & ~SC_STEP_TURNED, b);
}

static int accept_edge_edge(void *user, uint32_t a, uint32_t b)
{
    const accept_between *at = (const accept_between *)user;
    return at->objects->accept_near(at->objects->accept_user, SC_NEAR_EDGE_EDGE, at->a, at->b, a,
                                    b);
}

/* Has the caller's functions asked. */
static void begin_accept(const objects_run *run, accept_between *between, part_question *q)
{
    const sc_objects *objects = &run->asked->objects;
    sc_pair_filters *filters = &q->near.step.filters;
    int kind;
    filters->rest_distance = -1;
    if (run->asked->about == SC_QUESTION_QUERY) {
        if (!objects->accept) return;
        q->filter.struct_size = sizeof q->filter;
        q->filter.accept = accept_pair;
        q->filter.accept_user = between;
        q->plain.filter = &q->filter;
        return;
    }
    for (kind = 0; kind < 2 && objects->accept_near; kind++) {
        filters->asks[kind] = 1;
        filters->of[kind].accept =
            kind == SC_STEP_VERTEX_FACE ? accept_vertex_face : accept_edge_edge;
        filters->of[kind].accept_user = between;
    }
}

/* Two objects, the first being that of triangles, or of edges with triangles. */
static void look_at_two(objects_run *run, const sc_object *a, const sc_object *b)
{
    const sc_tasks *tasks = tasks_of(run, a, b);
    const uint32_t about = run->asked->about;
    accept_between between;
    part_question q;
    (void)begin_question(run, NULL, tasks, &q);
    sc_objects_frame_make_boxes(a, tasks, about, run->answer->stats);
    sc_objects_frame_make_boxes(b, tasks, about, run->answer->stats);
    q.query->second = b->workspace;
    q.query->options.method = SC_METHOD_AABB;
    q.query->options.contour = SC_CONTOUR_EXACT;
    sc_workspace_lend(b->model, b->workspace, q.query, tasks ? tasks->workers : 1);
    between.objects = &run->asked->objects;
    between.a = a->workspace->object - 1;
    between.b = b->workspace->object - 1;
    begin_accept(run, &between, &q);
    answer(run, a, b, q.query);
}

/* An object with itself and with those behind it; of edges with triangles, either may be the
   first. */
static sc_status look_at(objects_run *run, uint32_t i)
{
    const sc_objects_question *q = run->asked;
    const int either = q->about == SC_QUESTION_QUERY && q->options.pairs == SC_PAIRS_EDGE;
    const sc_object *a = object_at(run, i);
    uint32_t j;
    if (a->itself) {
        const sc_status status = look_at_itself(run, a);
        if (status) return status;
    }
    for (j = i + 1; j < q->objects.count && !is_over(run); j++) {
        const sc_object *b = object_at(run, j);
        if (!groups_collide(a, b) ||
            !sc_objects_frame_meet(&a->workspace->frame, &b->workspace->frame, run->clearance))
            continue;
        look_at_two(run, a, b);
        if (either && !is_over(run)) look_at_two(run, b, a);
    }
    return SC_OK;
}

static int lacks_room(const sc_object_list *list, uint32_t output)
{
    return (output == SC_OUTPUT_PAIRS && list->count > list->capacity) ||
           (list->range_capacity && list->range_count > list->range_capacity);
}

sc_status sc_objects_run(sc_objects_question *question, sc_objects_answer *answer)
{
    const uint64_t start = answer->stats ? sc_clock_nanoseconds() : 0;
    objects_run run;
    sc_status status;
    uint32_t i;
    memset(&run, 0, sizeof run);
    run.asked = question;
    run.answer = answer;
    answer->earliest = 1;
    status = check_those_asked(&run);
    if (!status) status = sc_objects_frame_read(question, &run.clearance);
    for (i = 0; !status && i < question->objects.count && !is_over(&run); i++)
        status = look_at(&run, i);
    if (answer->stats) answer->stats->total_nanoseconds = sc_clock_nanoseconds() - start;
    if (status) return status;
    if (run.incomplete) return SC_ERROR_INCOMPLETE;
    return lacks_room(&answer->list[0], question->output) ||
                   lacks_room(&answer->list[1], question->output)
               ? SC_ERROR_SHORT_BUFFER
               : SC_OK;
}
