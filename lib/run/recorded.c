/*
 * What is to be recorded. See recorded.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "run/recorded.h"

#include <string.h>

#include "run/near_question.h"
#include "run/step_question.h"

/* Filters and the rest pose of recorded->options, which are the caller's, become copies. */
static sc_status copy_filters(const sc_model *model, sc_recorded *r)
{
    sc_asked asked;
    sc_step_question question;
    sc_step_options *o = &r->options;
    sc_status status;
    int k;
    memset(&question, 0, sizeof question);
    question.options = *o;
    status = sc_step_question_read_filters(NULL, model, &asked, &question);
    if (status) return status;
    for (k = 0; k < 2; k++) r->filter[k] = question.filters.of[k];
    if (o->vertex_face_filter) o->vertex_face_filter = &r->filter[0];
    if (o->edge_edge_filter) o->edge_edge_filter = &r->filter[1];
    if (!o->rest) return SC_OK;
    r->pose[SC_RECORDED_REST] = asked.rest;
    r->stride[SC_RECORDED_REST] = asked.rest_stride;
    o->rest = &r->pose[SC_RECORDED_REST];
    return SC_OK;
}

sc_status sc_recorded_step(const sc_model *model, const sc_pose *start, const sc_pose *end,
                           const sc_step_options *options, sc_recorded *r)
{
    const sc_pose *const from[2] = {start, end};
    sc_step_options checked;
    sc_status status;
    int k;
    if (!model || !start || !end) return SC_ERROR_NULL;
    memset(r, 0, sizeof *r);
    r->kind = SC_RECORD_STEP;
    status = sc_step_question_read_options(NULL, options, &r->options);
    if (status) return status;
    checked = r->options; /* defaults stay defaults */
    status = sc_step_question_choose(model, &checked);
    for (k = 0; k < 2 && !status; k++)
        status = sc_question_read_pose(NULL, k ? "end" : "start", model, from[k], &r->pose[k],
                                       &r->stride[k]);
    return status ? status : copy_filters(model, r);
}

sc_status sc_recorded_near(const sc_model *model, const sc_pose *pose,
                           const sc_near_options *options, sc_recorded *r)
{
    sc_step_options *o = &r->options;
    sc_near_options near_options, checked;
    sc_status status;
    if (!model || !pose) return SC_ERROR_NULL;
    memset(r, 0, sizeof *r);
    r->kind = SC_RECORD_NEAR;
    status = sc_near_question_read_options(NULL, options, &near_options);
    if (status) return status;
    checked = near_options; /* defaults stay defaults */
    status = sc_near_question_choose(model, &checked);
    if (!status && near_options.masks && !sc_masks_fit(near_options.masks, model))
        status = SC_ERROR_OPTION;
    if (!status)
        status = sc_question_read_pose(NULL, "pose", model, pose, &r->pose[SC_RECORDED_START],
                                       &r->stride[SC_RECORDED_START]);
    if (status) return status;
    if (near_options.masks) r->mask_rings = near_options.masks->rings;
    o->output = near_options.output;
    o->pairs = near_options.kinds;
    o->method = near_options.method;
    o->simd = near_options.simd;
    o->separation = near_options.distance;
    o->vertex_face_filter = near_options.vertex_face_filter;
    o->edge_edge_filter = near_options.edge_edge_filter;
    o->rest = near_options.rest;
    o->rest_distance = near_options.rest_distance;
    o->cancel = near_options.cancel;
    o->budget = near_options.budget;
    return copy_filters(model, r);
}
