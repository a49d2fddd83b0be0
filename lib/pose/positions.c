/*
 * Reads the caller's pose. See positions.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "base/bounds.h"
#include "pose/positions.h"

#include <math.h>
#include <string.h>

#include "pose/pose_kernels.h"

void sc_positions_note(const sc_model *model, const sc_pose *pose, uint64_t stride,
                       sc_positions *positions)
{
    const uint32_t last = model->vertex_count - 1; /* which has no fourth double */
    positions->at = (const unsigned char *)pose->positions;
    positions->stride = stride;
    positions->type = pose->position_type;
    positions->last = last;
    positions->in_place = pose->position_type == SC_DOUBLE && stride % sizeof(double) == 0 &&
                                  (uintptr_t)pose->positions % sizeof(double) == 0
                              ? last
                              : 0;
}

/* Widens the box of all points. */
static inline void widen(const double p[3], double low[3], double high[3])
{
    int k;
    for (k = 0; k < 3; k++) {
        low[k] = p[k] < low[k] ? p[k] : low[k];
        high[k] = p[k] > high[k] ? p[k] : high[k];
    }
}

/* The box of vertices first to end - 1, all of which are used; 0 if one is not finite. */
static int find_extent_of_all(const sc_pose_kernels *kernels, const sc_positions *positions,
                              uint32_t first, uint32_t end, double low[3], double high[3])
{
    const uint64_t stride = positions->stride;
    const unsigned char *at = positions->at + first * stride;
    const double *doubles = (const double *)(const void *)at;
    const float *floats = (const float *)(const void *)at;
    const int is_double = positions->type == SC_DOUBLE;
    const uint64_t size = is_double ? sizeof *doubles : sizeof *floats;
    double p[3], not_finite = 0; /* stays 0 unless something is NaN or infinite */
    if (stride % size == 0 && (uintptr_t)at % size == 0) {
        if (stride == 3 * size)
            return is_double ? kernels->extent_of_doubles(doubles, end - first, low, high)
                             : kernels->extent_of_floats(floats, end - first, low, high);
        return is_double ? kernels->extent_of_apart_doubles(doubles, stride, end - first, low, high)
                         : kernels->extent_of_apart_floats(floats, stride, end - first, low, high);
    }
    for (; first < end; first++) {
        sc_positions_get(positions, first, p);
        not_finite += (p[0] - p[0]) + (p[1] - p[1]) + (p[2] - p[2]);
        widen(p, low, high);
    }
    return not_finite == 0; /* NaN is not 0 */
}

/* The same of those vertices that are used: of one run after the other, mostly all of them. */
static int find_extent(const sc_model *model, const sc_frame *frame, double low[3], double high[3])
{
    const uint8_t *use = sc_model_vertex_use(model);
    const uint32_t end = model->vertex_count;
    uint32_t first, stop;
    int finite = 1;
    for (first = 0; first < end; first = stop + 1) {
        const uint8_t *unused = (const uint8_t *)memchr(use + first, SC_VERTEX_UNUSED, end - first);
        stop = unused ? (uint32_t)(unused - use) : end;
        if (first < stop)
            finite &= find_extent_of_all(frame->kernels->pose, &frame->positions[0], first, stop,
                                         low, high);
    }
    return finite;
}

/*
 * Poses of a radius from 2^-FLOAT_RANGE to 2^FLOAT_RANGE can be moved in floats. What underflows is
 * a coordinate below 2^-126, off by 2^-150 at most before it is scaled: by 2^(FLOAT_RANGE - 150) in
 * the unit box, half of what boxes step outwards by at least, SC_BOUNDS_STEP_LEAST.
 */
enum { FLOAT_RANGE = 64 };

sc_status sc_positions_read(const sc_model *model, const sc_pose *pose, uint64_t stride,
                            sc_frame *frame)
{
    double center[3];
    int k;
    sc_positions_note(model, pose, stride, &frame->positions[0]);
    frame->leaves_ready = frame->boxes_ready = frame->cones_ready = 0;
    for (k = 0; k < 3; k++) {
        frame->low[k] = HUGE_VAL;
        frame->high[k] = -HUGE_VAL;
    }
    if (!find_extent(model, frame, frame->low, frame->high)) return SC_ERROR_NOT_FINITE;
    for (k = 0; k < 3; k++) {
        center[k] = frame->low[k] / 2 + frame->high[k] / 2;
        if (pose->position_type == SC_FLOAT) center[k] = sc_positions_rounded(center[k]);
    }
    sc_positions_move(frame, center);
    return SC_OK;
}

void sc_positions_move(sc_frame *frame, const double center[3])
{
    int k, exponent;
    frame->radius = 0;
    for (k = 0; k < 3; k++) {
        const double above = frame->high[k] - center[k], below = center[k] - frame->low[k];
        frame->center[k] = center[k];
        if (above > frame->radius) frame->radius = above;
        if (below > frame->radius) frame->radius = below;
    }
    /* the power of two above the radius, so that scaling is exact but where it underflows */
    (void)frexp(frame->radius, &exponent);
    sc_positions_scale(frame, exponent);
}

void sc_positions_scale(sc_frame *frame, int exponent)
{
    frame->scale = ldexp(1, exponent > -1022 ? -exponent : 1022);
    frame->fits_float = -FLOAT_RANGE <= exponent && exponent <= FLOAT_RANGE;
}
