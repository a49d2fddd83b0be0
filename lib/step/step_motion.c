/*
 * Both poses of a step. See step_motion.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "step/step_motion.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "base/jobs.h"
#include "pose/levels.h"
#include "query/simple_contour.h"
#include "step/step_kernels.h"

/* Fewer vertices are not worth a part of their own. */
enum { STEP_VERTICES_MIN = 1024 };

typedef struct bounds {
    double low[3], high[3];
    double not_finite; /* stays 0 unless something is NaN or infinite */
} bounds;

/* A pass over vertices or patches. */
typedef struct motion_pass {
    const sc_model *model;
    sc_frame *frame;
    bounds found[SC_JOBS_PARTS];
} motion_pass;

static void bound_pose(const sc_model *model, const sc_positions *positions, uint32_t first,
                       uint32_t last, bounds *b)
{
    const uint8_t *use = sc_model_vertex_use(model);
    uint32_t v;
    int k;
    for (v = first; v < last; v++) {
        double p[3];
        if (use[v] == SC_VERTEX_UNUSED) continue;
        sc_positions_get(positions, v, p);
        b->not_finite += (p[0] - p[0]) + (p[1] - p[1]) + (p[2] - p[2]);
        if (use[v] != SC_VERTEX_POINT) continue;
        for (k = 0; k < 3; k++) {
            b->low[k] = p[k] < b->low[k] ? p[k] : b->low[k];
            b->high[k] = p[k] > b->high[k] ? p[k] : b->high[k];
        }
    }
}

static void bound_poses(void *context, uint32_t part, uint32_t first, uint32_t last)
{
    motion_pass *pass = (motion_pass *)context;
    bounds *b = &pass->found[part];
    int k;
    for (k = 0; k < 3; k++) {
        b->low[k] = HUGE_VAL;
        b->high[k] = -HUGE_VAL;
    }
    b->not_finite = 0;
    for (k = 0; k < (int)pass->frame->motion.ends; k++)
        bound_pose(pass->model, &pass->frame->positions[k], first, last, b);
}

/* Points of both poses in the unit box, as pose/positions.c has them for one. */
static void scale_step(void *context, uint32_t part, uint32_t first, uint32_t last)
{
    const motion_pass *pass = (const motion_pass *)context;
    const sc_frame *frame = pass->frame;
    const uint8_t *use = sc_model_vertex_use(pass->model);
    float *unit = frame->motion.unit + 8 * (uint64_t)first;
    const int ends = (int)frame->motion.ends;
    uint32_t v;
    int k, end;
    (void)part;
    for (v = first; v < last; v++, unit += 8) {
        if (use[v] != SC_VERTEX_POINT) continue;
        for (end = 0; end < ends; end++) {
            double p[3];
            sc_positions_get(&frame->positions[end], v, p);
            for (k = 0; k < 3; k++)
                unit[4 * end + k] = (float)((p[k] - frame->center[k]) * frame->scale);
        }
        for (k = 0; k < 3 && ends == 1; k++) unit[4 + k] = unit[k];
    }
}

sc_status sc_motion_bound(const sc_model *model, const sc_pose pose[2], const uint64_t stride[2],
                          sc_frame *frame)
{
    motion_pass pass;
    uint32_t part, parts;
    int k;
    for (k = 0; k < 2; k++) sc_positions_note(model, &pose[k], stride[k], &frame->positions[k]);
    pass.model = model;
    pass.frame = frame;
    parts = sc_jobs_loop(frame->tasks, model->vertex_count, STEP_VERTICES_MIN, bound_poses, &pass);
    for (k = 0; k < 3; k++) {
        frame->low[k] = HUGE_VAL;
        frame->high[k] = -HUGE_VAL;
    }
    for (part = 0; part < parts; part++) {
        const bounds *found = &pass.found[part];
        if (found->not_finite != 0) return SC_ERROR_NOT_FINITE; /* NaN is not 0 */
        for (k = 0; k < 3; k++) {
            frame->low[k] = found->low[k] < frame->low[k] ? found->low[k] : frame->low[k];
            frame->high[k] = found->high[k] > frame->high[k] ? found->high[k] : frame->high[k];
        }
    }
    return SC_OK;
}

void sc_motion_scale(const sc_model *model, sc_frame *frame)
{
    motion_pass pass;
    pass.model = model;
    pass.frame = frame;
    (void)sc_jobs_loop(frame->tasks, model->vertex_count, STEP_VERTICES_MIN, scale_step, &pass);
}

double sc_motion_clearance(sc_impact_limits *limits, double half_side)
{
    if (limits->tolerance == 0) limits->tolerance = 2e-6 * half_side;
    return sc_impact_thickness(limits, 2 * half_side);
}

void sc_motion_keep_clear(double clearance, sc_frame *frame)
{
    /* Rounded up: what is lost to rounding in double is less than is added. Infinite if it is
       beyond float: then nothing is apart. */
    const double distance = clearance * frame->scale;
    frame->motion.distance =
        distance < (double)FLT_MAX / 2 ? (float)distance * 1.000001f + FLT_MIN : HUGE_VALF;
    frame->motion.margin = sc_motion_margin(frame->motion.distance);
}

void sc_motion_leave_out_rings(uint32_t rings, sc_frame *frame)
{
    sc_motion *m = &frame->motion;
    const float before = m->altitude;
    /* not more, so that the edges that may be nearer are all among those that the inner loops look
       at first */
    m->rings = rings <= SC_CONTOUR_NEAR ? rings : SC_CONTOUR_NEAR + 1u;
    m->altitude = m->rings > 1 ? m->distance / (float)(m->rings - 1) * 1.000001f : m->distance;
    if (m->altitude != before) frame->cones_ready = 0;
}

sc_status sc_motion_read(const sc_model *model, const sc_pose pose[2], const uint64_t stride[2],
                         sc_impact_limits *limits, sc_frame *frame)
{
    double half = 0, center[3];
    int k;
    const sc_status status = sc_motion_bound(model, pose, stride, frame);
    if (status) return status;
    for (k = 0; k < 3; k++) {
        half = fmax(half, frame->high[k] / 2 - frame->low[k] / 2);
        center[k] = frame->low[k] / 2 + frame->high[k] / 2;
    }
    sc_positions_move(frame, center);
    sc_motion_scale(model, frame);
    sc_motion_keep_clear(sc_motion_clearance(limits, half), frame);
    return SC_OK;
}

static void refit_leaf(const sc_model *model, sc_frame *frame, uint32_t leaf)
{
    const uint32_t *point = sc_model_leaf_point(model) + SC_LEAF_POINTS * (uint64_t)leaf;
    const uint32_t patch = sc_model_first_leaf_patch(model) + leaf;
    const float margin = frame->motion.margin / 2;
    float low[8], high[8];
    int s, k, i;
    memcpy(low, frame->motion.unit + 8 * (uint64_t)point[0], sizeof low);
    memcpy(high, low, sizeof high);
    for (i = 1; i < SC_LEAF_POINTS; i++) {
        const float *unit = frame->motion.unit + 8 * (uint64_t)point[i];
        for (k = 0; k < 8; k++) {
            low[k] = unit[k] < low[k] ? unit[k] : low[k];
            high[k] = unit[k] > high[k] ? unit[k] : high[k];
        }
    }
    for (s = 0; s < (int)frame->motion.ends; s++)
        for (k = 0; k < 3; k++) {
            const int one = 4 * s + k, other = frame->motion.swept ? 4 * (1 - s) + k : one;
            const float l = low[one] < low[other] ? low[one] : low[other];
            const float h = high[one] > high[other] ? high[one] : high[other];
            frame->motion.boxes[s].side[k][patch] = l - margin;
            frame->motion.boxes[s].side[k + 3][patch] = h + margin;
        }
}

/* The boxes of patches first to end - 1 of a level, which is not the last, by those of their
   children. */
static void join_boxes(const sc_model *model, sc_motion *m, uint32_t first, uint32_t end)
{
    const uint32_t *child = sc_model_child(model);
    uint32_t p, k;
    int s;
    for (s = 0; s < (int)m->ends; s++)
        for (k = 0; k < 3; k++) {
            float *low = m->boxes[s].side[k], *high = m->boxes[s].side[k + 3];
            for (p = first; p < end; p++) {
                uint32_t one = child[p], other = child[p + 1] - 1; /* one child, or two */
                low[p] = low[one] < low[other] ? low[one] : low[other];
                high[p] = high[one] > high[other] ? high[one] : high[other];
            }
        }
}

/* At most so many leaf clusters are looked at, all over the mesh; one in so many may have no low
   triangle. With one in sixteen a bunny within half an edge took 1.17 of the plain tree's time,
   with one in four 1.00. */
enum { LEAVES_SEEN = 128, LEAVES_HIGH = 4 };

/* Whether the least altitude of a triangle at the start is at most this; unit: the points of the
   motion. */
static int is_low(const uint32_t corner[3], const float *unit, float altitude)
{
    float e[3][3], n[3], longest = 0, square = 0;
    int i, k;
    for (i = 0; i < 3; i++) {
        const float *p = unit + 8 * (uint64_t)corner[i];
        const float *q = unit + 8 * (uint64_t)corner[(i + 1) % 3];
        for (k = 0; k < 3; k++) e[i][k] = q[k] - p[k];
        square = e[i][0] * e[i][0] + e[i][1] * e[i][1] + e[i][2] * e[i][2];
        longest = square > longest ? square : longest;
    }
    for (k = 0; k < 3; k++)
        n[k] = e[0][(k + 1) % 3] * e[1][(k + 2) % 3] - e[0][(k + 2) % 3] * e[1][(k + 1) % 3];
    square = n[0] * n[0] + n[1] * n[1] + n[2] * n[2];
    return square <= altitude * altitude * longest;
}

static int has_low(const sc_model *model, const sc_frame *frame, uint32_t leaf)
{
    const uint32_t *first = sc_model_leaf_first(model) + leaf;
    uint32_t i;
    for (i = first[0]; i < first[1]; i++)
        if (is_low(sc_model_triangle(model) + 3 * (uint64_t)i, frame->motion.unit,
                   frame->motion.altitude))
            return 1;
    return 0;
}

int sc_motion_is_wide(const sc_model *model, const sc_frame *frame)
{
    const uint32_t step = model->leaf_count / LEAVES_SEEN + 1;
    uint32_t left = model->leaf_count / step / LEAVES_HIGH, leaf;
    for (leaf = 0; leaf < model->leaf_count; leaf += step) {
        if (has_low(model, frame, leaf)) continue;
        if (left-- == 0) return 0;
    }
    return 1;
}

static void refit_step(void *context, uint32_t level, uint32_t first, uint32_t end)
{
    const motion_pass *pass = (const motion_pass *)context;
    const uint32_t leaves = sc_model_first_leaf_patch(pass->model);
    uint32_t p;
    if (level + 1 < pass->model->level_count) {
        join_boxes(pass->model, &pass->frame->motion, first, end);
        return;
    }
    for (p = first; p < end; p++) refit_leaf(pass->model, pass->frame, p - leaves);
}

void sc_motion_refit(const sc_model *model, sc_frame *frame)
{
    motion_pass pass;
    pass.model = model;
    pass.frame = frame;
    sc_levels_up(model, frame->tasks, refit_step, &pass);
    frame->boxes_ready = 1;
}

static void find_cones(void *context, uint32_t level, uint32_t first, uint32_t end)
{
    const motion_pass *pass = (const motion_pass *)context;
    const sc_model *model = pass->model;
    const uint32_t *child = sc_model_child(model);
    const uint32_t *triangle = sc_model_triangle(model), *leaf = sc_model_leaf_first(model);
    uint16_t *mask = pass->frame->mask;
    uint32_t p;
    if (level + 1 < model->level_count) {
        for (p = first; p < end; p++) mask[p] = mask[child[p]] & mask[child[p + 1] - 1];
        return;
    }
    leaf += first - sc_model_first_leaf_patch(model);
    for (p = first; p < end; p++, leaf++)
        mask[p] = (uint16_t)pass->frame->kernels->step->cone(
            &pass->frame->motion, triangle + 3 * (uint64_t)leaf[0], leaf[1] - leaf[0]);
}

void sc_motion_update_cones(const sc_model *model, sc_frame *frame)
{
    motion_pass pass;
    pass.model = model;
    pass.frame = frame;
    sc_levels_up(model, frame->tasks, find_cones, &pass);
}
