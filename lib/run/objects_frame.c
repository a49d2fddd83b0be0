/*
 * The frames of several objects. See objects_frame.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "run/objects_frame.h"

#include <float.h>
#include <inttypes.h>
#include <math.h>
#include <string.h>

#include "base/atomic.h"
#include "base/clock.h"
#include "base/hooks.h"
#include "base/jobs.h"
#include "pose/positions.h"
#include "pose/refit.h"
#include "step/step_motion.h"

/* Fewer leaf clusters are not worth a job. */
enum { BOXES_MIN = 128 };

/* Nor are the poses of fewer vertices in all. */
enum { READ_MIN = 10000 };

/* The limits of the narrow phase of what is asked. */
static sc_impact_limits *limits_of(sc_objects_question *q)
{
    return &q->near.step.limits;
}

/* ---- one pose, or two of a step ---- */

/* How many poses there are of what is asked. */
static int count_poses(const sc_objects_question *q)
{
    return q->about == SC_QUESTION_STEP ? 2 : 1;
}

/* Notes where poses are, and finds the box of their points. */
static sc_status read_positions(const sc_objects_question *q, const sc_object *o,
                                const sc_pose pose[2], const uint64_t stride[2])
{
    sc_frame *frame = &o->workspace->frame;
    if (q->about == SC_QUESTION_QUERY)
        return sc_positions_read(o->model, &pose[0], stride[0], frame);
    frame->motion.ends = (uint32_t)count_poses(q);
    return sc_motion_bound(o->model, pose, stride, frame);
}

/* Tells the log which coordinates are not finite. */
static void log_not_finite(const sc_objects_question *q, const sc_object *o, const sc_pose pose[2],
                           const uint64_t stride[2])
{
    static const char *const where[] = {" at the start", " at the end"};
    const sc_workspace *w = o->workspace;
    int k;
    sc_hooks_log(&w->hooks, SC_LOG_ERROR, "object %" PRIu32 " has a vertex that is not finite",
                 w->scene.number - 1);
    for (k = 0; k < count_poses(q); k++)
        sc_question_log_not_finite(&w->hooks, o->model, &pose[k], stride[k],
                                   count_poses(q) > 1 ? where[k] : "");
}

/* Notes where the poses of an object are, and finds their box; unless they are those of the last
   call. Errors are logged unless hooks are NULL. */
static sc_status read_pose(const sc_objects_question *q, const sc_object *o, const sc_hooks *hooks)
{
    sc_workspace *w = o->workspace;
    const sc_pose *const from[2] = {o->pose, o->end ? o->end : o->pose};
    sc_pose pose[2];
    uint64_t stride[2];
    sc_status status;
    int k;
    for (k = 0; k < 2; k++) {
        status = sc_question_read_pose(hooks, k ? "object.end" : "object.pose", o->model, from[k],
                                       &pose[k], &stride[k]);
        if (status) return status;
    }
    w->frame.kernels = sc_kernels_for(q->simd);
    w->frame.tasks = NULL;
    if (o->pose_version && o->pose_version == w->pose_version && w->pose_about == q->about) {
        for (k = 0; k < count_poses(q); k++)
            sc_positions_note(o->model, &pose[k], stride[k], &w->frame.positions[k]);
        return SC_OK;
    }
    sc_workspace_forget(w);
    status = read_positions(q, o, (const sc_pose *)pose, (const uint64_t *)stride);
    if (status && hooks) log_not_finite(q, o, (const sc_pose *)pose, (const uint64_t *)stride);
    return status;
}

/* ---- the unit box ---- */

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

static double half_side_of(const double low[3], const double high[3])
{
    double half = 0;
    int k;
    for (k = 0; k < 3; k++) half = fmax(half, high[k] / 2 - low[k] / 2);
    return half;
}

/* Whether all is within a unit box that is not much too large for it. */
static int fits_box(const double low[3], const double high[3], const unit_box *box)
{
    const double reach = ldexp(1, box->exponent);
    return reach_of(low, high, box->center) * 1.000001 < reach &&
           8 * half_side_of(low, high) >= reach;
}

/* A box of all objects, with a center that is of floats, as some positions may be; that of the last
   call, *box, if it fits. */
static void choose_box(const double low[3], const double high[3], int has_last, unit_box *box)
{
    int k;
    if (has_last && fits_box(low, high, box)) return;
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

/* Has an object seen in that box. */
static void move_into(const sc_objects_question *q, const sc_object *o, const unit_box *box)
{
    sc_workspace *w = o->workspace;
    unit_box own;
    find_box(&w->frame, &own);
    if (w->pose_version && own.exponent == box->exponent &&
        memcmp(own.center, box->center, sizeof own.center) == 0)
        return;
    sc_workspace_forget(w);
    sc_positions_move(&w->frame, box->center);
    sc_positions_scale(&w->frame, box->exponent);
    if (q->about != SC_QUESTION_QUERY) sc_motion_scale(o->model, &w->frame);
    w->pose_version = o->pose_version;
    w->pose_about = q->about;
}

/* Of what is near and of steps: boxes of patches and normal cones are made for the clearance. */
static void keep_clear(const sc_objects_question *q, double clearance, sc_frame *frame)
{
    const float before = frame->motion.distance;
    const uint32_t swept =
        q->about == SC_QUESTION_STEP && q->near.step.options.method == SC_STEP_METHOD_SWEPT;
    sc_motion_keep_clear(clearance, frame);
    if (frame->motion.distance != before) frame->cones_ready = 0;
    if (frame->motion.distance != before || frame->motion.swept != swept) frame->boxes_ready = 0;
    frame->motion.swept = swept;
}

/* ---- all objects ---- */

typedef struct frames_pass {
    sc_objects_question *question;
    const unit_box *box;
    double clearance;
    size_t bad; /* the first object that cannot be read */
} frames_pass;

static void read_some(void *context, uint32_t part, uint32_t first, uint32_t end)
{
    frames_pass *pass = (frames_pass *)context;
    uint32_t i;
    (void)part;
    for (i = first; i < end; i++) {
        const sc_object *o = sc_objects_question_object(&pass->question->objects, i);
        if (!read_pose(pass->question, o, NULL)) continue;
        sc_atomic_least(&pass->bad, i);
        return;
    }
}

static void move_some(void *context, uint32_t part, uint32_t first, uint32_t end)
{
    const frames_pass *pass = (const frames_pass *)context;
    const sc_objects_question *q = pass->question;
    uint32_t i;
    (void)part;
    for (i = first; i < end; i++) {
        const sc_object *o = sc_objects_question_object(&q->objects, i);
        move_into(q, o, pass->box);
        if (q->about != SC_QUESTION_QUERY) keep_clear(q, pass->clearance, &o->workspace->frame);
    }
}

/* The tasks that share in reading, if it is worth it. */
static const sc_tasks *tasks_to_read(const sc_objects_question *q)
{
    uint64_t vertices = 0;
    uint32_t i;
    for (i = 0; SC_ATOMIC && q->given && i < q->objects.count && vertices < READ_MIN; i++)
        vertices += sc_objects_question_object(&q->objects, i)->model->vertex_count;
    return vertices < READ_MIN ? NULL : q->given;
}

sc_status sc_objects_frame_read(sc_objects_question *q, double *clearance)
{
    const sc_objects *objects = &q->objects;
    const sc_tasks *tasks = tasks_to_read(q);
    double low[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, high[3] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
    frames_pass pass;
    unit_box box;
    uint32_t i;
    int k, has_last = 0;
    *clearance = 0;
    if (!objects->count) return SC_OK;
    for (i = 0; i < objects->count; i++)
        sc_workspace_renew(sc_objects_question_object(objects, i)->workspace,
                           q->about == SC_QUESTION_QUERY);
    pass.question = q;
    pass.bad = objects->count;
    (void)sc_jobs_loop(tasks, objects->count, 1, read_some, &pass);
    if (pass.bad < objects->count) { /* again, so that the log says why */
        const sc_object *o = sc_objects_question_object(objects, (uint32_t)pass.bad);
        return read_pose(q, o, &o->workspace->hooks);
    }
    for (i = 0; i < objects->count; i++) {
        const sc_workspace *w = sc_objects_question_object(objects, i)->workspace;
        if (w->pose_version && !has_last) {
            find_box(&w->frame, &box);
            has_last = 1;
        }
        for (k = 0; k < 3; k++) {
            low[k] = fmin(low[k], w->frame.low[k]);
            high[k] = fmax(high[k], w->frame.high[k]);
        }
    }
    if (q->about != SC_QUESTION_QUERY)
        *clearance = sc_motion_clearance(limits_of(q), half_side_of(low, high));
    choose_box(low, high, has_last, &box);
    pass.box = &box;
    pass.clearance = *clearance;
    (void)sc_jobs_loop(tasks, objects->count, 1, move_some, &pass);
    return SC_OK;
}

/* ---- boxes ---- */

int sc_objects_frame_apart(const sc_frame *a, const sc_frame *b, int axis, double clearance)
{
    /* a difference is off by 2^-53 of it; one that is infinite is more than any clearance that is
       not */
    return b->low[axis] - a->high[axis] > clearance * 1.000001;
}

int sc_objects_frame_meet(const sc_frame *a, const sc_frame *b, double clearance)
{
    int k, apart = 0;
    for (k = 0; k < 3; k++)
        apart |=
            sc_objects_frame_apart(a, b, k, clearance) | sc_objects_frame_apart(b, a, k, clearance);
    return !apart;
}

void sc_objects_frame_make_boxes(const sc_object *o, const sc_tasks *tasks, uint32_t about,
                                 sc_stats *stats)
{
    sc_frame *frame = &o->workspace->frame;
    const uint64_t start = stats ? sc_clock_nanoseconds() : 0;
    if (frame->boxes_ready) return;
    frame->tasks = o->model->leaf_count < BOXES_MIN ? NULL : tasks;
    if (about == SC_QUESTION_QUERY)
        sc_refit_boxes(o->model, frame);
    else
        sc_motion_refit(o->model, frame);
    if (!stats) return;
    stats->counts[SC_TASK_UPDATE_BOXES] += o->model->patch_end;
    if (about == SC_QUESTION_QUERY) stats->counts[SC_TASK_UPDATE_BOXES] += o->model->triangle_count;
    stats->nanoseconds[SC_TASK_UPDATE_BOXES] += sc_clock_nanoseconds() - start;
}
