/*
 * What a search for what is near is asked. See near_question.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "run/near_question.h"

#include <string.h>

#include "base/arguments.h"
#include "base/assume.h"
#include "run/step_question.h"

static sc_status check_near_choices(const sc_hooks *hooks, const sc_near_options *o)
{
    const sc_choice choices[] = {
        {"output", o->output, SC_OUTPUT_ANY},
        {"kinds", o->kinds, SC_NEAR_EDGE_EDGE},
        {"method", o->method, SC_NEAR_METHOD_BOXES},
        {"simd", o->simd, SC_SIMD_AVX512},
        {"reserved", o->reserved, 0},
    };
    sc_status status =
        sc_arguments_choose(hooks, "options", choices, sizeof choices / sizeof *choices);
    if (!status) status = sc_step_question_check_length(hooks, "distance", o->distance);
    return status ? status
                  : sc_step_question_check_length(hooks, "rest_distance", o->rest_distance);
}

sc_status sc_near_question_read_options(const sc_hooks *hooks, const sc_near_options *from,
                                        sc_near_options *options)
{
    const sc_status status =
        sc_arguments_read_options(hooks, "options", options, sizeof *options, from);
    return status ? status : check_near_choices(hooks, options);
}

sc_status sc_near_question_choose(const sc_model *model, sc_near_options *o)
{
    const uint32_t best = (uint32_t)sc_isa_best();
    const int boxes = sc_model_is_for_boxes(model);
    if (o->method == SC_NEAR_METHOD_DEFAULT)
        o->method = boxes ? SC_NEAR_METHOD_BOXES : SC_NEAR_METHOD_SCTT;
    if (boxes && o->method != SC_NEAR_METHOD_BOXES) return SC_ERROR_BOXES_ONLY;
    if (o->simd == SC_SIMD_BEST) o->simd = best;
    return SC_HARDLY(o->simd > best) ? SC_ERROR_UNSUPPORTED : SC_OK;
}

void sc_near_question_fill(const sc_near_result *result, sc_near_question *question)
{
    const sc_near_options *o = &question->options;
    sc_step_options *step = &question->step.options;
    sc_step_result lists;
    step->output = o->output;
    step->method =
        o->method == SC_NEAR_METHOD_SCTT ? SC_STEP_METHOD_SCTT : SC_STEP_METHOD_TWO_BOXES;
    step->contour = SC_CONTOUR_EXACT;
    step->simd = o->simd;
    step->separation = o->distance;
    step->tasks = o->tasks;
    step->cancel = o->cancel;
    step->budget = o->budget;
    memset(&lists, 0, sizeof lists);
    lists.vertex_faces = result->vertex_faces;
    lists.vertex_face_capacity = result->vertex_face_capacity;
    lists.edge_edges = result->edge_edges;
    lists.edge_edge_capacity = result->edge_edge_capacity;
    lists.stats = result->stats;
    sc_step_question_fill(&lists, &question->step);
    question->step.query.near = question;
    question->step.query.opens_all = !o->masks;
    question->bounds = result->vertex_bounds;
}

sc_status sc_near_question_read(const sc_model *model, const sc_workspace *workspace,
                                const sc_pose *pose, const sc_near_options *from,
                                const sc_near_result *result, sc_asked *asked,
                                sc_near_question *question)
{
    sc_near_options *o = &question->options;
    const sc_hooks *hooks;
    sc_status status;
    if (!workspace) return SC_ERROR_NULL;
    hooks = &workspace->hooks;
    if ((status = sc_arguments_need(hooks, "model", NULL, model))) return status;
    if ((status = sc_arguments_need(hooks, "pose", NULL, pose))) return status;
    status = sc_question_check_workspace(model, workspace, SC_WORKSPACE_NEAR);
    if (!status) status = sc_near_question_read_options(hooks, from, o);
    if (!status) status = sc_near_question_choose(model, o);
    if (!status) status = sc_question_read_tasks(workspace, &o->tasks, &asked->tasks);
    if (!status)
        status =
            sc_question_read_pose(hooks, "pose", model, pose, &asked->pose[0], &asked->stride[0]);
    if (!status && o->output == SC_OUTPUT_PAIRS && result->vertex_face_capacity)
        status = sc_arguments_need(hooks, "result", "vertex_faces", result->vertex_faces);
    if (!status && o->output == SC_OUTPUT_PAIRS && result->edge_edge_capacity)
        status = sc_arguments_need(hooks, "result", "edge_edges", result->edge_edges);
    if (!status && o->masks && !sc_masks_fit(o->masks, model)) {
        sc_hooks_log(hooks, SC_LOG_ERROR, "options.masks are of another model");
        status = SC_ERROR_OPTION;
    }
    if (!status && result->vertex_bounds && o->output == SC_OUTPUT_ANY) {
        sc_hooks_log(hooks, SC_LOG_ERROR, "result.vertex_bounds are not known from any pair");
        status = SC_ERROR_OPTION;
    }
    if (!status && result->stats)
        status = sc_arguments_check(hooks, "result.stats", result->stats, sizeof(sc_stats),
                                    SC_ARGUMENTS_DEFAULTS);
    if (status) return status;
    question->step.options.vertex_face_filter = o->vertex_face_filter;
    question->step.options.edge_edge_filter = o->edge_edge_filter;
    question->step.options.rest = o->rest;
    question->step.options.rest_distance = o->rest_distance;
    status = sc_step_question_read_filters(hooks, model, asked, &question->step);
    if (status) return status;
    asked->pose[1] = asked->pose[0];
    asked->stride[1] = asked->stride[0];
    sc_near_question_fill(result, question);
    return SC_OK;
}
