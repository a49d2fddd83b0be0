/*
 * What a step is asked. See step_question.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "run/step_question.h"

#include <float.h>

#include "base/arguments.h"
#include "base/assume.h"
#include "run/question.h"
#include "step/moving_contour.h"
#include "step/step_filter.h"

sc_status sc_step_question_check_length(const sc_hooks *hooks, const char *name, double length)
{
    if (length >= 0 && length <= DBL_MAX) return SC_OK;
    sc_hooks_log(hooks, SC_LOG_ERROR, "options.%s is %g, but finite and at least 0", name, length);
    return SC_ERROR_OPTION;
}

static sc_status check_step_choices(const sc_hooks *hooks, const sc_step_options *o)
{
    const sc_choice choices[] = {
        {"output", o->output, SC_OUTPUT_ANY},
        {"pairs", o->pairs, SC_STEP_CANDIDATES},
        {"times", o->times, SC_STEP_TIMES_EACH},
        {"method", o->method, SC_STEP_METHOD_SWEPT},
        {"contour", o->contour, SC_CONTOUR_EXACT},
        {"simd", o->simd, SC_SIMD_AVX512},
        {"reserved", o->reserved, 0},
        {"begun", o->begun, SC_STEP_BEGUN_NEARER},
        {"reserved2", o->reserved2, 0},
    };
    sc_status status =
        sc_arguments_choose(hooks, "options", choices, sizeof choices / sizeof *choices);
    if (!status) status = sc_step_question_check_length(hooks, "separation", o->separation);
    if (!status) status = sc_step_question_check_length(hooks, "tolerance", o->tolerance);
    return status ? status
                  : sc_step_question_check_length(hooks, "rest_distance", o->rest_distance);
}

/* On a model for boxes, what asks for no method and no contour test gets boxes. */
static sc_status choose_step_method(const sc_model *model, uint32_t contour, uint32_t *method)
{
    if (!sc_model_is_for_boxes(model)) return SC_OK;
    if (*method == SC_STEP_METHOD_DEFAULT && contour == SC_CONTOUR_DEFAULT)
        *method = SC_STEP_METHOD_TWO_BOXES;
    return *method > SC_STEP_METHOD_SCTT ? SC_OK : SC_ERROR_BOXES_ONLY;
}

sc_status sc_step_question_read_options(const sc_hooks *hooks, const sc_step_options *from,
                                        sc_step_options *options)
{
    const sc_status status =
        sc_arguments_read_options(hooks, "options", options, sizeof *options, from);
    return status ? status : check_step_choices(hooks, options);
}

sc_status sc_step_question_choose(const sc_model *model, sc_step_options *o)
{
    const uint32_t best = (uint32_t)sc_isa_best();
    sc_status status = choose_step_method(model, o->contour, &o->method);
    if (status) return status;
    if (o->simd == SC_SIMD_BEST) o->simd = best;
    if (SC_HARDLY(o->simd > best)) return SC_ERROR_UNSUPPORTED;
    if (o->method == SC_STEP_METHOD_DEFAULT) o->method = SC_STEP_METHOD_SCTT;
    if (!o->contour) o->contour = SC_CONTOUR_EXACT;
    return SC_OK;
}

void sc_step_question_fill(const sc_step_result *result, sc_step_question *question)
{
    const sc_step_options *o = &question->options;
    const int times = o->times == SC_STEP_TIMES_EACH;
    sc_step_list *list = question->list;
    question->query.options.output = o->output;
    question->query.options.simd = o->simd;
    question->query.options.cancel = o->cancel;
    question->query.options.budget = o->budget;
    question->query.options.tasks = o->tasks;
    question->query.options.method =
        o->method == SC_STEP_METHOD_SCTT ? SC_METHOD_SCTT : SC_METHOD_AABB;
    question->query.options.contour = SC_CONTOUR_EXACT; /* for the order of nodes */
    question->query.has_last = o->method == SC_STEP_METHOD_SCTT;
    question->query.opens_all = 1;
    question->query.ends_early =
        o->budget || (o->output == SC_OUTPUT_ANY && o->times == SC_STEP_TIMES_NONE);
    question->query.timed = result->stats != NULL;
    question->query.test = sc_moving_contour_tests;
    question->query.step = question;
    list[SC_STEP_VERTEX_FACE].pairs = result->vertex_faces;
    list[SC_STEP_VERTEX_FACE].times = times ? result->vertex_face_times : NULL;
    list[SC_STEP_VERTEX_FACE].capacity = result->vertex_face_capacity;
    list[SC_STEP_EDGE_EDGE].pairs = result->edge_edges;
    list[SC_STEP_EDGE_EDGE].times = times ? result->edge_edge_times : NULL;
    list[SC_STEP_EDGE_EDGE].capacity = result->edge_edge_capacity;
    question->limits.separation = o->separation;
    question->limits.tolerance = o->tolerance;
    question->limits.latest = 1;
}

sc_status sc_step_question_read_filters(const sc_hooks *hooks, const sc_model *model,
                                        sc_asked *asked, sc_step_question *question)
{
    sc_step_options *o = &question->options;
    sc_status status = sc_step_filter_read(hooks, model, o->vertex_face_filter, o->edge_edge_filter,
                                           &question->filters);
    asked->rest_stride = 0;
    if (!status && o->rest) {
        status = sc_question_read_pose(hooks, "options.rest", model, o->rest, &asked->rest,
                                       &asked->rest_stride);
        o->rest = &asked->rest;
    } else if (!status && o->rest_distance > 0) {
        status = sc_arguments_need(hooks, "options", "rest", NULL);
    }
    return status;
}

sc_status sc_step_question_read(const sc_model *model, const sc_workspace *workspace,
                                const sc_pose *start, const sc_pose *end,
                                const sc_step_options *from, const sc_step_result *result,
                                sc_asked *asked, sc_step_question *question)
{
    sc_step_options *o = &question->options;
    const sc_hooks *hooks;
    sc_status status;
    if (!workspace) return SC_ERROR_NULL;
    hooks = &workspace->hooks;
    if ((status = sc_arguments_need(hooks, "model", NULL, model))) return status;
    if ((status = sc_arguments_need(hooks, "start", NULL, start))) return status;
    if ((status = sc_arguments_need(hooks, "end", NULL, end))) return status;
    status = sc_question_check_workspace(model, workspace, SC_WORKSPACE_STEP);
    if (!status) status = sc_step_question_read_options(hooks, from, o);
    if (!status) status = sc_step_question_choose(model, o);
    if (!status) status = sc_question_read_tasks(workspace, &o->tasks, &asked->tasks);
    if (!status)
        status =
            sc_question_read_pose(hooks, "start", model, start, &asked->pose[0], &asked->stride[0]);
    if (!status)
        status =
            sc_question_read_pose(hooks, "end", model, end, &asked->pose[1], &asked->stride[1]);
    if (!status) status = sc_step_question_read_filters(hooks, model, asked, question);
    if (!status && o->output == SC_OUTPUT_PAIRS && result->vertex_face_capacity)
        status = sc_arguments_need(hooks, "result", "vertex_faces", result->vertex_faces);
    if (!status && o->output == SC_OUTPUT_PAIRS && result->edge_edge_capacity)
        status = sc_arguments_need(hooks, "result", "edge_edges", result->edge_edges);
    if (!status && result->stats)
        status = sc_arguments_check(hooks, "result.stats", result->stats, sizeof(sc_stats),
                                    SC_ARGUMENTS_DEFAULTS);
    if (!status) sc_step_question_fill(result, question);
    return status;
}
