/*
 * Reads the caller's pose. See positions.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "pose/positions.h"

#include <math.h>
#include <string.h>

/* Widens the box of all points. */
static inline void widen(const double p[3], double low[3], double high[3])
{
    int k;
    for (k = 0; k < 3; k++) {
        low[k] = p[k] < low[k] ? p[k] : low[k];
        high[k] = p[k] > high[k] ? p[k] : high[k];
    }
}

/*
 * The points in the unit box, rounded to float: divided by the power of two above the radius, which is
 * exact but where it underflows. What is rounded is the difference from the center and its conversion.
 */
static void scale(const sc_model *model, sc_workspace *w)
{
    const uint8_t *use = sc_model_vertex_use(model);
    double c0 = w->center[0], c1 = w->center[1], c2 = w->center[2], p[3];
    float *unit = w->unit;
    uint32_t i;
    int exponent;
    (void)frexp(w->radius, &exponent);
    w->scale = ldexp(1, exponent > -1022 ? -exponent : 1022);
    for (i = 0; i < model->vertex_count; i++, unit += 4) {
        if (use[i] != SC_VERTEX_POINT) continue;
        sc_positions_get(w, i, p);
        unit[0] = (float)((p[0] - c0) * w->scale);
        unit[1] = (float)((p[1] - c1) * w->scale);
        unit[2] = (float)((p[2] - c2) * w->scale);
    }
}

sc_status sc_positions_read(const sc_model *model, const sc_pose *pose, uint64_t stride,
                            sc_workspace *w)
{
    const uint8_t *use = sc_model_vertex_use(model);
    double low[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, high[3] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
    double p[3], not_finite = 0; /* stays 0 unless something is NaN or infinite */
    uint32_t v;
    int k;
    w->positions = (const unsigned char *)pose->positions;
    w->stride = stride;
    w->position_type = pose->position_type;
    w->in_place = 0;
    if (pose->position_type == SC_DOUBLE && stride % sizeof(double) == 0 &&
        (uintptr_t)pose->positions % sizeof(double) == 0) /* the last one has no fourth */
        w->in_place = model->vertex_count - 1;
    for (v = 0; v < model->vertex_count; v++) {
        if (use[v] == SC_VERTEX_UNUSED) continue;
        sc_positions_get(w, v, p);
        not_finite += (p[0] - p[0]) + (p[1] - p[1]) + (p[2] - p[2]);
        if (use[v] == SC_VERTEX_POINT) widen(p, low, high);
    }
    if (not_finite != 0) return SC_ERROR_NOT_FINITE; /* NaN is not 0 */
    w->radius = 0;
    for (k = 0; k < 3; k++) {
        w->center[k] = low[k] / 2 + high[k] / 2;
        if (high[k] - w->center[k] > w->radius) w->radius = high[k] - w->center[k];
        if (w->center[k] - low[k] > w->radius) w->radius = w->center[k] - low[k];
    }
    scale(model, w);
    return SC_OK;
}
