/*
 * Closed fans that project one to one. See fan.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "pose/fan.h"

#include <math.h>

#include "pose/positions.h"

/*
 * Let r_i be the ring relative to the point, d the sum of the computed normals r_i x r_(i+1), taken
 * as an exact vector, and c = d with its smallest component dropped and the others swapped and one
 * negated, so that c . d = 0 exactly. Under a projection along d the sectors have areas d . (r_i x
 * r_(i+1)) / 2 (scaled); all positive, they are angles below a half turn, and the fan turns k times
 * round, where k is the number of i with y_i <= 0 < y_(i+1), y = c . r.
 *
 * The computed y_i is that of a ring moved along c by its error, at most 3 * 2^-53 |d|1 |r_i|1 (a
 * difference, a product, a subtraction, and c . r has two terms). Moving the ring there changes no
 * sign of an area, and hence not k, if the areas are larger than the change: with w = d x c, (c .
 * a)(w . b) - (w . a)(c . b) = |c|^2 d . (a x b), so the change is at most |d| / |c| <= 1.23 times
 * the sum of the errors times (|r_i| + |r_(i+1)|). That and the rounding of the area itself, 8 *
 * 2^-53 |d|1 |r_i|1
 * |r_(i+1)|1, are below 32 * 2^-53 |d|1 (|r_i|1 + |r_(i+1)|1)^2. No product or sum of an area is larger than
 * |d|1 (|r_i|1 + |r_(i+1)|1)^2 / 2, so none overflows to infinity, where sums have a wrong sign, unless that does.
 */
static const double FAN_ERROR_RELATIVE = 32 * 1.1102230246251565e-16;
static const double FAN_ERROR_ABSOLUTE = 1e-290;

int sc_fan_test(const sc_model *model, const sc_workspace *w, uint32_t point)
{
    const uint32_t *ring = sc_model_ring(model) + sc_model_ring_first(model)[point];
    uint32_t count = sc_model_ring_first(model)[point + 1] - sc_model_ring_first(model)[point], i;
    uint32_t turns = 0;
    double center[3], r[SC_RING_MAX][3], n[SC_RING_MAX][3], size[SC_RING_MAX], d[3] = {0, 0, 0},
                                                                               d_size, c0, c1, last;
    int k, axis = 0, first_axis, second_axis;
    if (count < 3 || count > SC_RING_MAX) return 0; /* longer: of a forged model */
    sc_positions_get(w, point, center);
    for (i = 0; i < count; i++) {
        double p[3];
        sc_positions_get(w, ring[i], p);
        for (k = 0; k < 3; k++) r[i][k] = p[k] - center[k];
        size[i] = fabs(r[i][0]) + fabs(r[i][1]) + fabs(r[i][2]);
    }
    for (i = 0; i < count; i++) {
        const double *a = r[i], *b = r[i + 1 < count ? i + 1 : 0];
        for (k = 0; k < 3; k++) {
            n[i][k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
            d[k] += n[i][k];
        }
    }
    d_size = fabs(d[0]) + fabs(d[1]) + fabs(d[2]);
    for (i = 0; i < count; i++) {
        double sum = size[i] + size[i + 1 < count ? i + 1 : 0];
        double area = d[0] * n[i][0] + d[1] * n[i][1] + d[2] * n[i][2];
        double bound = FAN_ERROR_RELATIVE * (d_size * (sum * sum));
        if (!(area > bound + FAN_ERROR_ABSOLUTE * (1 + d_size))) return 0;
    }
    for (k = 1; k < 3; k++)
        if (fabs(d[k]) < fabs(d[axis])) axis = k;
    first_axis = (axis + 1) % 3;
    second_axis = (axis + 2) % 3;
    c0 = -d[second_axis];
    c1 = d[first_axis];
    last = c0 * r[count - 1][first_axis] + c1 * r[count - 1][second_axis];
    for (i = 0; i < count; i++) {
        double y = c0 * r[i][first_axis] + c1 * r[i][second_axis];
        turns += last <= 0 && y > 0;
        last = y;
    }
    return turns == 1;
}

int sc_fan_is_plain(const sc_model *model, sc_workspace *w, uint32_t point)
{
    uint32_t at = point % SC_FANS_KEPT;
    if (w->fan_point[at] != point) {
        w->fan_plain[at] = (uint8_t)sc_fan_test(model, w, point);
        w->fan_point[at] = point;
    }
    return w->fan_plain[at];
}
