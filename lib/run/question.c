/*
 * What a query is asked. See question.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "run/question.h"

#include <inttypes.h>
#include <math.h>

#include "base/arguments.h"
#include "base/assume.h"
#include "build/mesh.h"
#include "query/filter.h"
#include "query/simple.h"

sc_status sc_question_read_pose(const sc_hooks *hooks, const char *name, const sc_model *model,
                                const sc_pose *from, sc_pose *pose, uint64_t *stride)
{
    sc_status status = sc_arguments_read(hooks, name, pose, sizeof *pose, from,
                                         SC_ARGUMENTS_UP_TO(sc_pose, positions));
    if (status) return status;
    if (pose->vertex_count != model->vertex_count) {
        sc_hooks_log(hooks, SC_LOG_ERROR,
                     "%s.vertex_count is %" PRIu32 ", but the model has %" PRIu32, name,
                     pose->vertex_count, model->vertex_count);
        return SC_ERROR_VERTEX_COUNT;
    }
    status = sc_arguments_need(hooks, name, "positions", pose->positions);
    if (!status)
        status = sc_mesh_position_stride(hooks, name, pose->position_type, pose->position_stride,
                                         stride);
    if (status) return status;
    /* where addresses have 32 bits: */
    return SC_HARDLY(*stride > SIZE_MAX / pose->vertex_count) ? SC_ERROR_COUNT : SC_OK;
}

void sc_question_log_not_finite(const sc_hooks *hooks, const sc_model *model, const sc_pose *pose,
                                uint64_t stride, const char *where)
{
    const uint8_t *use = sc_model_vertex_use(model);
    double p[3];
    uint32_t v;
    for (v = 0; hooks->log && v < model->vertex_count; v++) {
        if (use[v] == SC_VERTEX_UNUSED) continue;
        sc_mesh_read_position(pose->positions, pose->position_type, stride, v, p);
        if (isfinite(p[0]) && isfinite(p[1]) && isfinite(p[2])) continue;
        sc_hooks_log(hooks, SC_LOG_ERROR, "vertex %" PRIu32 " is NaN or infinite%s", v, where);
        return;
    }
}

static sc_status check_choices(const sc_hooks *hooks, const sc_query_options *o)
{
    const sc_choice choices[] = {
        {"output", o->output, SC_OUTPUT_ANY},
        {"pairs", o->pairs, SC_PAIRS_EDGE},
        {"contact", o->contact, SC_CONTACT_PROPER},
        {"method", o->method, SC_METHOD_AABB},
        {"contour", o->contour, SC_CONTOUR_EXACT},
        {"rest_cache", o->rest_cache, SC_REST_CACHE_OFF},
        {"simd", o->simd, SC_SIMD_AVX512},
    };
    return sc_arguments_choose(hooks, "options", choices, sizeof choices / sizeof *choices);
}

sc_status sc_question_read_options(const sc_hooks *hooks, const sc_query_options *from,
                                   sc_query_options *options)
{
    sc_status status = sc_arguments_read_options(hooks, "options", options, sizeof *options, from);
    return status ? status : check_choices(hooks, options);
}

/* On a model for boxes, what asks for no method and no contour test gets boxes. */
static sc_status choose_method(const sc_model *model, uint32_t contour, uint32_t *method)
{
    if (!sc_model_is_for_boxes(model)) return SC_OK;
    if (*method == SC_METHOD_DEFAULT && contour == SC_CONTOUR_DEFAULT) *method = SC_METHOD_AABB;
    return *method == SC_METHOD_AABB ? SC_OK : SC_ERROR_BOXES_ONLY;
}

sc_status sc_question_choose(const sc_model *model, sc_query_options *o)
{
    sc_status status = choose_method(model, o->contour, &o->method);
    if (status) return status;
    if (o->simd == SC_SIMD_BEST) o->simd = (uint32_t)sc_isa_best();
    if (SC_HARDLY(o->simd > (uint32_t)sc_isa_best())) return SC_ERROR_UNSUPPORTED;
    if (o->method == SC_METHOD_DEFAULT) o->method = SC_METHOD_SCTT;
    if (o->contour == SC_CONTOUR_DEFAULT) o->contour = SC_CONTOUR_EXACT;
    return SC_OK;
}

sc_status sc_question_read_tasks(const sc_workspace *workspace, const sc_tasks **given,
                                 sc_tasks *tasks)
{
    const sc_hooks *hooks = &workspace->hooks;
    sc_status status;
    if (!*given) return SC_OK;
    status = sc_arguments_read_tasks(hooks, *given, tasks);
    if (status) return status;
    if (tasks->workers > workspace->sizes.workers) {
        sc_hooks_log(hooks, SC_LOG_ERROR,
                     "options.tasks.workers is %" PRIu32 ", but the workspace is for %" PRIu32,
                     tasks->workers, workspace->sizes.workers);
        return SC_ERROR_WORKSPACE;
    }
    *given = tasks;
    return SC_OK;
}

sc_status sc_question_check_workspace(const sc_model *model, const sc_workspace *workspace,
                                      uint32_t flags)
{
    const char *wrong = NULL;
    if (!sc_workspace_fits(workspace, model))
        wrong = "the workspace is for another model";
    else if ((workspace->sizes.flags & flags) != flags)
        wrong = flags & SC_WORKSPACE_NEAR
                    ? "the workspace is not for what is near: SC_WORKSPACE_NEAR"
                    : "the workspace is not for steps: SC_WORKSPACE_STEP";
    if (wrong) sc_hooks_log(&workspace->hooks, SC_LOG_ERROR, "%s", wrong);
    return wrong ? SC_ERROR_WORKSPACE : SC_OK;
}

sc_status sc_question_read(const sc_model *model, const sc_workspace *workspace,
                           const sc_pose *pose, const sc_query_options *options,
                           const sc_result *result, sc_asked *asked, sc_question *question)
{
    sc_query_options *o = &question->options;
    const sc_hooks *hooks;
    sc_status status;
    if (!workspace) return SC_ERROR_NULL;
    hooks = &workspace->hooks;
    if ((status = sc_arguments_need(hooks, "model", NULL, model))) return status;
    if ((status = sc_arguments_need(hooks, "pose", NULL, pose))) return status;
    if ((status = sc_question_check_workspace(model, workspace, 0))) return status;
    if ((status = sc_question_read_options(hooks, options, o))) return status;
    if ((status = sc_question_choose(model, o))) return status;
    question->pairs = result->pairs;
    question->capacity = result->capacity;
    question->timed = result->stats != NULL;
    question->ends_early = o->output == SC_OUTPUT_ANY || o->budget != 0;
    question->test = sc_simple_tests;
    question->has_last = !sc_model_is_for_boxes(model);
    status = sc_question_read_tasks(workspace, &o->tasks, &asked->tasks);
    if (!status && o->filter)
        status = sc_filter_begin(question, hooks, model, o->filter, &asked->filter);
    if (!status)
        status =
            sc_question_read_pose(hooks, "pose", model, pose, &asked->pose[0], &asked->stride[0]);
    if (!status && o->output == SC_OUTPUT_PAIRS && result->capacity)
        status = sc_arguments_need(hooks, "result", "pairs", result->pairs);
    if (!status && result->stats)
        status = sc_arguments_check(hooks, "result.stats", result->stats, sizeof(sc_stats),
                                    SC_ARGUMENTS_DEFAULTS);
    return status;
}
