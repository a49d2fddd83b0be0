/*
 * Several objects in one query. See objects.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "run/objects.h"

#include <string.h>

#include "base/assume.h"
#include "base/atomic.h"
#include "base/clock.h"
#include "base/hooks.h"
#include "query/filter.h"
#include "query/pairs.h"
#include "query/simple.h"
#include "run/near_question.h"
#include "run/objects_frame.h"
#include "run/objects_sweep.h"
#include "run/plan.h"
#include "run/step_question.h"
#include "step/step_filter.h"
#include "step/step_pairs.h"

/* The call at hand. Of a list's ranges those that fit are in the caller's array. */
typedef struct objects_run {
    const sc_objects_question *asked;
    sc_objects_answer *answer;
    double clearance;
    int incomplete;
    int alone;          /* the calling thread does without tasks */
    sc_workspace *lead; /* where tasks share in units: the first of so many workers, whose plan has
                           room for them; or NULL */
} objects_run;

/* What the caller's functions are asked with. */
typedef struct accept_between {
    const sc_objects *objects;
    uint32_t a, b;
} accept_between;

/* What one object, or two, are asked. */
typedef struct part_question {
    sc_question *query; /* of those below: */
    sc_question plain;
    sc_near_question near; /* of what is near, or its step is that of a step */
    sc_asked asked;
    sc_filter filter;
    accept_between between;
} part_question;

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
    if (!tasks || run->alone || a->workspace->sizes.workers < tasks->workers ||
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
        q->plain.has_last = model && !sc_model_is_for_boxes(model);
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
    q->near.step.query.opens_all = !o->masks;
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

/* What an object is asked about itself; of one that was checked, SC_OK. */
static sc_status ask_itself(const objects_run *run, const sc_object *o, const sc_tasks *tasks,
                            part_question *q)
{
    const sc_status status = begin_question(run, o->model, tasks, q);
    return status ? status : begin_filters(run, o, q);
}

/* Whether all that are asked about themselves can be: before anything is written. */
static sc_status check_those_asked(const objects_run *run)
{
    part_question q;
    sc_status status = SC_OK;
    uint32_t i;
    for (i = 0; i < run->asked->objects.count && !status; i++) {
        const sc_object *o = object_at(run, i);
        if (!o->itself) continue;
        status = ask_itself(run, o, NULL, &q);
        o->workspace->scene.asks =
            q.filter.accept || q.near.step.filters.of[0].accept || q.near.step.filters.of[1].accept;
    }
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
        range->object_a = a->workspace->scene.number - 1;
        range->object_b = b->workspace->scene.number - 1;
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

static void look_at_itself(objects_run *run, const sc_object *o)
{
    part_question q;
    (void)ask_itself(run, o, tasks_of(run, o, o), &q);
    o->workspace->frame.tasks = sc_plan_tasks(o->model, q.query);
    answer(run, o, o, q.query);
}

/* ---- two objects ---- */

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
static void begin_accept(const objects_run *run, part_question *q)
{
    const sc_objects *objects = &run->asked->objects;
    accept_between *between = &q->between;
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

/* What two objects are asked, the first being that of triangles, or of edges with triangles. */
static void ask_two(const objects_run *run, const sc_object *a, const sc_object *b,
                    const sc_tasks *tasks, part_question *q)
{
    (void)begin_question(run, NULL, tasks, q);
    q->query->second = b->workspace;
    q->query->one_room = a->workspace->room == b->workspace->room;
    q->query->options.method = SC_METHOD_AABB;
    q->query->options.contour = SC_CONTOUR_EXACT;
    q->between.objects = &run->asked->objects;
    q->between.a = a->workspace->scene.number - 1;
    q->between.b = b->workspace->scene.number - 1;
    begin_accept(run, q);
}

static void look_at_two(objects_run *run, const sc_object *a, const sc_object *b)
{
    const sc_tasks *tasks = tasks_of(run, a, b);
    part_question q;
    sc_objects_frame_make_boxes(a, tasks, run->asked->about, run->answer->stats);
    sc_objects_frame_make_boxes(b, tasks, run->asked->about, run->answer->stats);
    ask_two(run, a, b, tasks, &q);
    sc_workspace_lend(b->model, b->workspace, q.query, tasks ? tasks->workers : 1);
    answer(run, a, b, q.query);
}

/* Of edges with triangles, either of two objects may be that of edges. */
static int goes_both_ways(const objects_run *run)
{
    return run->asked->about == SC_QUESTION_QUERY && run->asked->options.pairs == SC_PAIRS_EDGE;
}

/* An object with itself, or two. */
static void look_at(objects_run *run, sc_pair unit)
{
    const sc_object *a = object_at(run, unit.a), *b = object_at(run, unit.b);
    if (a == b) {
        look_at_itself(run, a);
        return;
    }
    look_at_two(run, a, b);
    if (goes_both_ways(run) && !is_over(run)) look_at_two(run, b, a);
}

/* ---- units, each by one worker ---- */

/*
 * Questions about small objects are answered whole, each by one worker, many at a time: those of
 * objects with themselves first, together with the boxes of all that come near others; then those
 * of two, for which worker k of either workspace, and a part of its room, is at the service of the
 * thread that is worker k. What they find goes to one array and is sorted there, since a pair is
 * packed with its unit's number; the same whoever did what.
 */
typedef struct units_job {
    objects_run *run;
    const sc_tasks *tasks;
    sc_plan_room *room; /* of the lead, with the units; and the job's items: objects in tests, and
                           in open their units, counted from 1 */
    uint32_t count;     /* of units */
    uint32_t item_count;
    sc_share share;
    size_t first_found; /* where one pair is enough: no unit behind this one is of interest */
} units_job;

/* Smaller objects are not worth sharing inside. */
enum { WHOLE_LEAVES = 1024 };

/* Whether one worker may answer a question about them by itself. */
static int is_unit(const objects_run *run, sc_pair unit)
{
    const sc_object *a = object_at(run, unit.a), *b = object_at(run, unit.b);
    const sc_objects *objects = &run->asked->objects;
    if (!run->lead || !tasks_of(run, a, b)) return 0;
    if (a->model->leaf_count > WHOLE_LEAVES && b->model->leaf_count > WHOLE_LEAVES) return 0;
    if (SC_HARDLY(!sc_pairs_can_be_packed(a->model) || !sc_pairs_can_be_packed(b->model)))
        return 0; /* a model of more than 44 million triangles takes gigabytes */
    /* the caller's functions are asked by the calling thread */
    return a == b ? !a->workspace->scene.asks : !objects->accept && !objects->accept_near;
}

/* What a worker found in a question of a unit, and counted. */
static void look_by_worker(units_job *job, const sc_object *a, const sc_object *b,
                           const sc_question *q, sc_unit *unit, uint32_t worker)
{
    const int alone = a == b && !sc_workspace_is_shared(a->workspace);
    const uint32_t parts = alone ? 1 : job->tasks->workers, part = alone ? 0 : worker;
    sc_share *share = q->ends_early ? NULL : &job->share;
    sc_worker *w;
    if (a != b) (void)sc_workspace_join(b->model, b->workspace, q, NULL, worker, part, parts);
    w = sc_workspace_join(a->model, a->workspace, q, share, worker, part, parts);
    w->last_time = q->timed ? sc_clock_nanoseconds() : 0;
    if (!sc_worker_stops(w)) sc_plan_run_whole(a->workspace, worker);
    if (q->timed) {
        w->stats.nanoseconds[w->task] += sc_clock_nanoseconds() - w->last_time;
        sc_worker_add_stats(&job->run->lead->worker[worker].total, &w->stats);
    }
    unit->incomplete |= (uint32_t)w->incomplete;
    if (!q->step) {
        unit->count[0] += w->count;
        unit->turned += q->prefix & 1 ? w->count : 0;
        return;
    }
    unit->count[0] = w->step->count[0];
    unit->count[1] = w->step->count[1];
    unit->turned = w->step->turned;
    unit->earliest = w->step->earliest;
}

static void answer_unit(units_job *job, uint32_t number, uint32_t worker)
{
    objects_run *run = job->run;
    sc_unit *unit = &job->room->units[number];
    const sc_object *a = object_at(run, unit->a), *b = object_at(run, unit->b);
    const uint32_t ways = a != b && goes_both_ways(run) ? 2 : 1;
    part_question q;
    uint32_t way;
    for (way = 0; way < ways && number < sc_atomic_get(&job->first_found); way++) {
        const sc_object *first = way ? b : a, *second = way ? a : b;
        if (a == b)
            (void)ask_itself(run, a, NULL, &q);
        else
            ask_two(run, first, second, NULL, &q);
        q.query->packs = 1;
        q.query->prefix = 2 * number + way;
        look_by_worker(job, first, second, q.query, unit, worker);
        if (run->asked->ends_early && unit->count[0] + unit->count[1] > 0)
            sc_atomic_least(&job->first_found, number);
    }
}

/* An object with itself, if it is asked that, and its boxes, if others are near. */
static void run_object(void *context, uint32_t part, uint32_t worker)
{
    units_job *job = (units_job *)context;
    const objects_run *run = job->run;
    const sc_object *o = object_at(run, job->room->tests[part]);
    const uint32_t unit = job->room->open[part];
    o->workspace->frame.tasks = NULL;
    if (unit) answer_unit(job, unit - 1, worker);
    if (job->room->passed[part])
        sc_objects_frame_make_boxes(o, NULL, run->asked->about,
                                    run->answer->stats ? &run->lead->worker[worker].total : NULL);
}

static void run_two(void *context, uint32_t part, uint32_t worker)
{
    units_job *job = (units_job *)context;
    const sc_unit *unit = &job->room->units[part];
    if (unit->a != unit->b) answer_unit(job, part, worker);
}

/* The item of an object, which is listed unless it is already. */
static uint32_t item_of(units_job *job, uint32_t object)
{
    sc_in_scene *scene = &object_at(job->run, object)->workspace->scene;
    if (!scene->item) {
        const uint32_t at = job->item_count++;
        job->room->tests[at] = object;
        job->room->open[at] = job->room->passed[at] = 0;
        scene->item = at + 1;
    }
    return scene->item - 1;
}

static void list_items(units_job *job)
{
    uint32_t i;
    for (i = 0; i < job->count; i++) {
        const sc_unit *unit = &job->room->units[i];
        if (unit->a == unit->b)
            job->room->open[item_of(job, unit->a)] = i + 1;
        else
            job->room->passed[item_of(job, unit->a)] = job->room->passed[item_of(job, unit->b)] = 1;
    }
    for (i = 0; i < job->item_count; i++)
        object_at(job->run, job->room->tests[i])->workspace->scene.item = 0;
}

/* Sorts what was found, and takes it down unit by unit. */
static void finish_units(units_job *job)
{
    objects_run *run = job->run;
    const uint64_t found[2] = {job->share.claimed[0], job->share.claimed[1]};
    uint64_t room, k;
    sc_pair *spare = sc_workspace_spare(run->lead, &room);
    part_question q;
    uint32_t i;
    int kind;
    (void)begin_question(run, NULL, NULL, &q);
    if (q.query->step)
        sc_step_pairs_finish(q.query->step, found, spare, room, job->tasks);
    else
        sc_pairs_finish(q.query, found[0], NULL, 0, job->tasks);
    for (kind = 0; kind < 2; kind++) {
        sc_pair *pairs = rest_of(run, kind).pairs;
        for (k = 0; k < found[kind]; k++) pairs[k] = sc_pairs_unpack(pairs[k]);
    }
    for (i = 0; i < job->count && !is_over(run); i++) {
        const sc_unit *unit = &job->room->units[i];
        const sc_object *a = object_at(run, unit->a), *b = object_at(run, unit->b);
        add_range(run, a, b, 0, unit->count[0] - unit->turned);
        add_range(run, b, a, 0, unit->turned);
        add_range(run, a, b, 1, unit->count[1]);
        run->incomplete |= unit->incomplete != 0;
        if (unit->earliest < run->answer->earliest) run->answer->earliest = unit->earliest;
    }
}

/* What workers counted; of units that are asked again, in their passes over poses alone. */
static void add_totals(const units_job *job, int again)
{
    sc_stats *sum = job->run->answer->stats;
    uint32_t i, task;
    for (i = 0; sum && i < job->tasks->workers; i++) {
        const sc_stats *total = &job->run->lead->worker[i].total;
        if (!again) sc_worker_add_stats(sum, total);
        for (task = 0; again && task < SC_TASK_ORIENTATION; task++) {
            sum->counts[task] += total->counts[task];
            sum->nanoseconds[task] += total->nanoseconds[task];
        }
    }
}

/* Answers units of the lead's list; where the caller's arrays turn out to be too short, by the
   calling thread. */
static void answer_units(objects_run *run, uint32_t count)
{
    const sc_tasks *tasks = run->asked->given;
    units_job job;
    uint32_t i;
    memset(&job, 0, sizeof job);
    job.run = run;
    job.tasks = tasks;
    job.room = &run->lead->plan;
    job.count = count;
    job.first_found = count;
    for (i = 0; i < tasks->workers; i++) memset(&run->lead->worker[i].total, 0, sizeof(sc_stats));
    list_items(&job);
    tasks->finish(tasks->user, tasks->enqueue(tasks->user, run_object, &job, job.item_count));
    tasks->finish(tasks->user, tasks->enqueue(tasks->user, run_two, &job, count));
    add_totals(&job, job.share.halt != 0);
    if (!job.share.halt) finish_units(&job);
    run->alone = job.share.halt != 0; /* with tasks the list's room were for parts */
    for (i = 0; run->alone && i < count && !is_over(run); i++) {
        const sc_pair unit = {job.room->units[i].a, job.room->units[i].b};
        look_at(run, unit);
    }
    run->alone = 0;
}

/* ---- all together ---- */

/* Goes on to the next unit; returns 0 if there is none. */
static int find_next(const objects_run *run, sc_pair *unit)
{
    const sc_objects *objects = &run->asked->objects;
    for (;;) {
        unit->b = sc_objects_sweep_next(objects, run->clearance, unit->a, unit->b);
        if (unit->b < objects->count) return 1;
        if (++unit->a >= objects->count) return 0;
        unit->b = unit->a;
        if (object_at(run, unit->a)->itself) return 1;
    }
}

/* The object whose workspace is where tasks share in units: the first that is for so many. */
static sc_workspace *find_lead(const objects_run *run)
{
    const sc_objects *objects = &run->asked->objects;
    uint32_t i;
    for (i = 0; SC_ATOMIC && i < objects->count; i++)
        if (tasks_of(run, object_at(run, i), object_at(run, i)))
            return object_at(run, i)->workspace;
    return NULL;
}

/* All units, in order: small ones that follow each other together, others by themselves. */
static void look_at_all(objects_run *run)
{
    sc_pair unit = {0, 0};
    int more = run->asked->objects.count && (object_at(run, 0)->itself || find_next(run, &unit));
    run->lead = find_lead(run);
    while (more && !is_over(run)) {
        const sc_pair first = unit;
        uint32_t count = 0;
        for (; more && count < SC_UNITS_MAX && is_unit(run, unit); more = find_next(run, &unit)) {
            sc_unit *u = &run->lead->plan.units[count++];
            memset(u, 0, sizeof *u);
            u->a = unit.a;
            u->b = unit.b;
            u->earliest = 1;
        }
        if (count > 1) {
            answer_units(run, count);
        } else {
            look_at(run, first);
            if (!count) more = find_next(run, &unit);
        }
    }
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
    memset(&run, 0, sizeof run);
    run.asked = question;
    run.answer = answer;
    answer->earliest = 1;
    status = check_those_asked(&run);
    if (!status) status = sc_objects_frame_read(question, &run.clearance);
    if (!status) {
        sc_objects_sweep_run(&question->objects, run.clearance);
        look_at_all(&run);
    }
    if (answer->stats) answer->stats->total_nanoseconds = sc_clock_nanoseconds() - start;
    if (status) return status;
    if (run.incomplete) return SC_ERROR_INCOMPLETE;
    return lacks_room(&answer->list[0], question->output) ||
                   lacks_room(&answer->list[1], question->output)
               ? SC_ERROR_SHORT_BUFFER
               : SC_OK;
}
