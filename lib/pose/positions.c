/*
 * Reads the caller's pose. See positions.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "pose/positions.h"

#include <math.h>
#include <string.h>

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

/* The box of all vertices that are used; 0 if one is not finite. */
static int find_extent(const sc_model *model, const sc_workspace *w, double low[3], double high[3])
{
    const uint8_t *use = sc_model_vertex_use(model);
    double p[3], not_finite = 0; /* stays 0 unless something is NaN or infinite */
    uint32_t v;
    for (v = 0; v < model->vertex_count; v++) {
        if (use[v] == SC_VERTEX_UNUSED) continue;
        sc_positions_get(w, v, p);
        not_finite += (p[0] - p[0]) + (p[1] - p[1]) + (p[2] - p[2]);
        widen(p, low, high);
    }
    return not_finite == 0; /* NaN is not 0 */
}

/* The same of a packed array that is used as a whole, which most are. */
static int find_extent_of_all(const sc_model *model, const sc_workspace *w, double low[3],
                              double high[3])
{
    const sc_pose_kernels *kernels = sc_pose_kernels_of(w);
    const void *positions = w->positions;
    return w->position_type == SC_DOUBLE
               ? kernels->extent_of_doubles((const double *)positions, model->vertex_count, low,
                                            high)
               : kernels->extent_of_floats((const float *)positions, model->vertex_count, low,
                                           high);
}

static int is_packed(const sc_workspace *w)
{
    uint64_t size = w->position_type == SC_DOUBLE ? sizeof(double) : sizeof(float);
    return w->stride == 3 * size && (uintptr_t)w->positions % size == 0;
}

sc_status sc_positions_read(const sc_model *model, const sc_pose *pose, uint64_t stride,
                            sc_workspace *w)
{
    double low[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, high[3] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
    int k, finite, exponent;
    w->positions = (const unsigned char *)pose->positions;
    w->stride = stride;
    w->position_type = pose->position_type;
    w->leaves_ready = w->boxes_ready = 0;
    w->in_place = 0;
    if (pose->position_type == SC_DOUBLE && stride % sizeof(double) == 0 &&
        (uintptr_t)pose->positions % sizeof(double) == 0) /* the last one has no fourth */
        w->in_place = model->vertex_count - 1;
    if (is_packed(w) && !memchr(sc_model_vertex_use(model), SC_VERTEX_UNUSED, model->vertex_count))
        finite = find_extent_of_all(model, w, low, high);
    else
        finite = find_extent(model, w, low, high);
    if (!finite) return SC_ERROR_NOT_FINITE;
    w->radius = 0;
    for (k = 0; k < 3; k++) {
        w->center[k] = low[k] / 2 + high[k] / 2;
        if (high[k] - w->center[k] > w->radius) w->radius = high[k] - w->center[k];
        if (w->center[k] - low[k] > w->radius) w->radius = w->center[k] - low[k];
    }
    /* the power of two above the radius, so that scaling is exact but where it underflows */
    (void)frexp(w->radius, &exponent);
    w->scale = ldexp(1, exponent > -1022 ? -exponent : 1022);
    return SC_OK;
}
