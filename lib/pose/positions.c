/*
 * Reads the caller's pose. See positions.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "pose/positions.h"

#include <math.h>
#include <string.h>

#include "base/jobs.h"
#include "pose/pose_kernels.h"

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
static int find_extent_of_all(const sc_workspace *w, uint32_t first, uint32_t end, double low[3],
                              double high[3])
{
    const sc_pose_kernels *kernels = sc_pose_kernels_of(w);
    const unsigned char *at = w->positions + first * w->stride;
    const double *doubles = (const double *)(const void *)at;
    const float *floats = (const float *)(const void *)at;
    const uint64_t size = w->position_type == SC_DOUBLE ? sizeof *doubles : sizeof *floats;
    double p[3], not_finite = 0; /* stays 0 unless something is NaN or infinite */
    if (w->stride % size == 0 && (uintptr_t)at % size == 0) {
        if (w->stride == 3 * size)
            return w->position_type == SC_DOUBLE
                       ? kernels->extent_of_doubles(doubles, end - first, low, high)
                       : kernels->extent_of_floats(floats, end - first, low, high);
        return w->position_type == SC_DOUBLE
                   ? kernels->extent_of_apart_doubles(doubles, w->stride, end - first, low, high)
                   : kernels->extent_of_apart_floats(floats, w->stride, end - first, low, high);
    }
    for (; first < end; first++) {
        sc_positions_get(w, first, p);
        not_finite += (p[0] - p[0]) + (p[1] - p[1]) + (p[2] - p[2]);
        widen(p, low, high);
    }
    return not_finite == 0; /* NaN is not 0 */
}

/* The same of those vertices that are used: of one run after the other, mostly all of them. */
static int find_extent(const sc_model *model, const sc_workspace *w, uint32_t first, uint32_t end,
                       double low[3], double high[3])
{
    const uint8_t *use = sc_model_vertex_use(model);
    uint32_t stop;
    int finite = 1;
    for (; first < end; first = stop + 1) {
        const uint8_t *unused = (const uint8_t *)memchr(use + first, SC_VERTEX_UNUSED, end - first);
        stop = unused ? (uint32_t)(unused - use) : end;
        if (first < stop) finite &= find_extent_of_all(w, first, stop, low, high);
    }
    return finite;
}

/* What is found in parts of the vertices. */
typedef struct extents {
    const sc_model *model;
    const sc_workspace *w;
    int finite[SC_JOBS_PARTS];
    double low[SC_JOBS_PARTS][3], high[SC_JOBS_PARTS][3];
} extents;

static void find_extents(void *context, uint32_t part, uint32_t first, uint32_t end)
{
    extents *e = (extents *)context;
    double *low = e->low[part], *high = e->high[part];
    int k;
    for (k = 0; k < 3; k++) {
        low[k] = HUGE_VAL;
        high[k] = -HUGE_VAL;
    }
    e->finite[part] = find_extent(e->model, e->w, first, end, low, high);
}

/*
 * Poses of a radius from 2^-FLOAT_RANGE to 2^FLOAT_RANGE can be moved in floats: what underflows is less than
 * 2^(FLOAT_RANGE - 149) in the unit box.
 */
enum { FLOAT_RANGE = 64 };

/* Fewer vertices are not worth a part of their own. */
enum { VERTICES_MIN = 2048 };

sc_status sc_positions_read(const sc_model *model, const sc_pose *pose, uint64_t stride,
                            sc_workspace *w)
{
    double low[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, high[3] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
    uint32_t part, parts;
    int k, exponent;
    extents e;
    w->positions = (const unsigned char *)pose->positions;
    w->stride = stride;
    w->position_type = pose->position_type;
    w->leaves_ready = w->boxes_ready = 0;
    w->in_place = 0;
    w->last_vertex = model->vertex_count - 1;
    if (pose->position_type == SC_DOUBLE && stride % sizeof(double) == 0 &&
        (uintptr_t)pose->positions % sizeof(double) == 0) /* the last one has no fourth */
        w->in_place = model->vertex_count - 1;
    e.model = model;
    e.w = w;
    parts = sc_jobs_loop(w->tasks, model->vertex_count, VERTICES_MIN, find_extents, &e);
    for (part = 0; part < parts; part++) {
        if (!e.finite[part]) return SC_ERROR_NOT_FINITE;
        widen(e.low[part], low, high);
        widen(e.high[part], low, high);
    }
    w->radius = 0;
    for (k = 0; k < 3; k++) {
        w->center[k] = low[k] / 2 + high[k] / 2;
        if (w->position_type == SC_FLOAT) w->center[k] = (double)(float)w->center[k];
        if (high[k] - w->center[k] > w->radius) w->radius = high[k] - w->center[k];
        if (w->center[k] - low[k] > w->radius) w->radius = w->center[k] - low[k];
    }
    /* the power of two above the radius, so that scaling is exact but where it underflows */
    (void)frexp(w->radius, &exponent);
    w->scale = ldexp(1, exponent > -1022 ? -exponent : 1022);
    w->fits_float = -FLOAT_RANGE <= exponent && exponent <= FLOAT_RANGE;
    return SC_OK;
}
