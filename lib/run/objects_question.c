/*
 * What is asked of several objects. See objects_question.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "run/objects_question.h"

#include <float.h>
#include <inttypes.h>
#include <string.h>

#include "base/arguments.h"
#include "base/assume.h"
#include "run/near_question.h"
#include "run/step_question.h"

const sc_object *sc_objects_question_object(const sc_objects *objects, uint32_t i)
{
    return (const sc_object *)(const void *)((const unsigned char *)(const void *)objects->objects +
                                             i * objects->stride);
}

static sc_status refuse(const sc_hooks *hooks, const char *what)
{
    sc_hooks_log(hooks, SC_LOG_ERROR, "%s", what);
    return SC_ERROR_OPTION;
}

/* What workspaces must be made for. */
static uint32_t flags_for(uint32_t about)
{
    static const uint32_t flags[SC_QUESTIONS] = {0, SC_WORKSPACE_STEP, SC_WORKSPACE_NEAR};
    return flags[about];
}

static sc_status check_object(const sc_object *o, uint32_t about)
{
    const sc_hooks *hooks = o->workspace ? &o->workspace->hooks : NULL;
    const sc_choice choices[] = {{"itself", o->itself, 1}, {"reserved", o->reserved, 0}};
    sc_status status = sc_arguments_need(hooks, "object", "workspace", o->workspace);
    if (!status) status = sc_arguments_need(hooks, "object", "model", o->model);
    if (!status) status = sc_arguments_need(hooks, "object", "pose", o->pose);
    if (!status) status = sc_arguments_choose(hooks, "object", choices, 2);
    if (!status && about != SC_QUESTION_STEP && o->end)
        status = refuse(hooks, "object.end is for steps");
    if (!status && about != SC_QUESTION_QUERY && o->filter)
        status = refuse(hooks, "object.filter is for intersections");
    if (!status && about == SC_QUESTION_QUERY &&
        (o->vertex_face_filter || o->edge_edge_filter || o->rest || o->masks))
        status = refuse(hooks, "filters by kind, rest and masks of an object are not for "
                               "intersections");
    if (!status && about == SC_QUESTION_STEP && o->masks)
        status = refuse(hooks, "object.masks are for what is near");
    if (!status && about != SC_QUESTION_QUERY &&
        !(o->rest_distance >= 0 && o->rest_distance <= DBL_MAX))
        status = refuse(hooks, "object.rest_distance must be finite and at least 0");
    if (!status && about != SC_QUESTION_QUERY && SC_HARDLY(o->model->vertex_count > SC_STEP_TURNED))
        status = SC_ERROR_COUNT;
    return status ? status : sc_question_check_workspace(o->model, o->workspace, flags_for(about));
}

/* Each object by itself, and that no workspace is in two: each gets the number of its object. */
static sc_status check_objects(const sc_objects *objects, uint32_t about)
{
    sc_status status;
    uint32_t i;
    for (i = 0; i < objects->count; i++) {
        status = check_object(sc_objects_question_object(objects, i), about);
        if (status) return status;
        sc_objects_question_object(objects, i)->workspace->scene.number = 0;
    }
    for (i = 0; i < objects->count; i++) {
        sc_workspace *w = sc_objects_question_object(objects, i)->workspace;
        if (w->scene.number) {
            sc_hooks_log(&w->hooks, SC_LOG_ERROR,
                         "objects %" PRIu32 " and %" PRIu32 " have one workspace",
                         w->scene.number - 1, i);
            return SC_ERROR_WORKSPACE;
        }
        w->scene.number = i + 1;
    }
    return SC_OK;
}

static sc_status read_tasks(const sc_tasks *from, sc_objects_question *q)
{
    const sc_status status = sc_arguments_read_tasks(NULL, from, &q->tasks);
    if (status) return status;
    if (q->tasks.workers > SC_WORKERS_MAX) return SC_ERROR_OPTION;
    if (q->tasks.workers > 1) q->given = &q->tasks;
    return SC_OK;
}

/* What all three have; simd is what the caller wants. */
static sc_status read_objects(const sc_objects *objects, uint32_t simd, const sc_tasks *tasks,
                              sc_objects_question *q)
{
    const uint32_t best = (uint32_t)sc_isa_best();
    sc_status status;
    if (SC_HARDLY(simd > best)) return SC_ERROR_UNSUPPORTED;
    q->simd = simd == SC_SIMD_BEST ? best : simd;
    status = sc_arguments_need(NULL, "objects", NULL, objects);
    if (!status)
        status = sc_arguments_read(NULL, "objects", &q->objects, sizeof q->objects, objects,
                                   SC_ARGUMENTS_UP_TO(sc_objects, objects));
    if (status) return status;
    if (q->objects.count && !q->objects.objects) return SC_ERROR_NULL;
    if (!q->objects.stride) q->objects.stride = sizeof(sc_object);
    if (q->objects.stride < sizeof(sc_object) || q->objects.stride % sizeof(void *))
        return SC_ERROR_STRIDE;
    status = read_tasks(tasks, q);
    return status ? status : check_objects(&q->objects, q->about);
}

sc_status sc_objects_question_read(const sc_objects *objects, const sc_query_options *options,
                                   sc_objects_question *q)
{
    const sc_query_options *o = &q->options;
    sc_status status;
    memset(q, 0, sizeof *q);
    q->about = SC_QUESTION_QUERY;
    status = sc_question_read_options(NULL, options, &q->options);
    if (status) return status;
    if (o->filter || o->budget || o->contour == SC_CONTOUR_STAR || o->contour == SC_CONTOUR_NONE)
        return SC_ERROR_OPTION;
    status = read_objects(objects, o->simd, o->tasks, q);
    q->options.simd = q->simd;
    q->output = o->output;
    q->ends_early = o->output == SC_OUTPUT_ANY;
    return status;
}

sc_status sc_objects_question_read_near(const sc_objects *objects, const sc_near_options *options,
                                        sc_objects_question *q)
{
    sc_near_options *o = &q->near.options;
    sc_status status;
    memset(q, 0, sizeof *q);
    q->about = SC_QUESTION_NEAR;
    status = sc_near_question_read_options(NULL, options, o);
    if (status) return status;
    if (o->vertex_face_filter || o->edge_edge_filter || o->rest || o->rest_distance > 0 ||
        o->masks || o->budget)
        return SC_ERROR_OPTION;
    q->near.step.limits.separation = o->distance;
    status = read_objects(objects, o->simd, o->tasks, q);
    o->simd = q->simd;
    q->output = o->output;
    q->ends_early = o->output == SC_OUTPUT_ANY;
    return status;
}

sc_status sc_objects_question_read_step(const sc_objects *objects, const sc_step_options *options,
                                        sc_objects_question *q)
{
    sc_step_options *o = &q->near.step.options;
    sc_status status;
    memset(q, 0, sizeof *q);
    q->about = SC_QUESTION_STEP;
    status = sc_step_question_read_options(NULL, options, o);
    if (status) return status;
    if (o->vertex_face_filter || o->edge_edge_filter || o->rest || o->rest_distance > 0 ||
        o->budget || o->contour == SC_CONTOUR_STAR || o->contour == SC_CONTOUR_NONE)
        return SC_ERROR_OPTION;
    q->near.step.limits.separation = o->separation;
    q->near.step.limits.tolerance = o->tolerance;
    q->near.step.limits.latest = 1;
    status = read_objects(objects, o->simd, o->tasks, q);
    o->simd = q->simd;
    q->output = o->output;
    q->ends_early = o->output == SC_OUTPUT_ANY && o->times == SC_STEP_TIMES_NONE;
    return status;
}
