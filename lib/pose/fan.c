/*
 * Closed fans that project one to one. See fan.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "pose/fan.h"

#include <math.h>

#include "pose/pose_kernels.h"
#include "pose/positions.h"

/*
 * Let r_i be the ring relative to the point, d the sum of the computed normals r_i x r_(i+1), taken as
 * an exact vector, and c = d with its smallest component dropped and the others swapped and one
 * negated, so that c . d = 0 exactly. Under a projection along d the sectors have areas d . (r_i x
 * r_(i+1)) / 2 (scaled); all positive, they are angles below a half turn, and the fan turns k times
 * round, where k is the number of i with y_i <= 0 < y_(i+1), y = c . r.
 *
 * The computed y_i is that of a ring moved along c by its error, at most 3 * 2^-53 |d|1 |r_i|1 (a
 * difference, a product, a subtraction, and c . r has two terms). Moving the ring there changes no sign
 * of an area, and hence not k, if the areas are larger than the change: with w = d x c, (c . a)(w . b) -
 * (w . a)(c . b) = |c|^2 d . (a x b), so the change is at most |d| / |c| <= 1.23 times the sum of the
 * errors times (|r_i| + |r_(i+1)|). That and the rounding of the area itself, 8 * 2^-53 |d|1 |r_i|1
 * |r_(i+1)|1, are below 32 * 2^-53 |d|1 (|r_i|1 + |r_(i+1)|1)^2.
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
        if (!(area > FAN_ERROR_RELATIVE * d_size * (sum * sum) + FAN_ERROR_ABSOLUTE * (1 + d_size)))
            return 0;
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

/* The points of which nothing is known yet, to be tested together. */
typedef struct waiting_fans {
    sc_fans fans;
    uint32_t count;
} waiting_fans;

static void note_fan(sc_workspace *w, uint32_t point, int plain)
{
    w->fan[point] = 2 * w->pose_tick + (uint32_t)plain;
}

/* Adds a point, or notes that its fan is not plain. */
static void await_fan(const sc_model *model, sc_workspace *w, uint32_t point, waiting_fans *waiting)
{
    const uint32_t *first = sc_model_ring_first(model) + point;
    uint32_t count = first[1] - first[0];
    note_fan(w, point, 0); /* so that it is not added again */
    if (count >= 3 && count <= SC_FAN_MOST) {
        waiting->fans.point[waiting->count] = point;
        waiting->fans.count[waiting->count] = count;
        waiting->fans.ring[waiting->count++] = sc_model_ring(model) + first[0];
    } else if (count > SC_FAN_MOST) {
        note_fan(w, point, sc_fan_test(model, w, point));
    }
}

/* Tests them in single precision, and in double what that leaves open. */
static void test_waiting(const sc_model *model, sc_workspace *w, waiting_fans *waiting)
{
    sc_fans *fans = &waiting->fans;
    uint32_t i;
    unsigned plain;
    if (!waiting->count) return;
    for (i = waiting->count; i < SC_FANS; i++) { /* the first fills the row */
        fans->point[i] = fans->point[0];
        fans->count[i] = fans->count[0];
        fans->ring[i] = fans->ring[0];
    }
    plain = sc_pose_kernels_of(w)->are_plain(w, fans);
    for (i = 0; i < waiting->count; i++)
        note_fan(w, fans->point[i], (plain >> i & 1u) || sc_fan_test(model, w, fans->point[i]));
}

void sc_fan_test_of_pose(const sc_model *model, sc_workspace *w, uint32_t point)
{
    waiting_fans waiting;
    waiting.count = 0;
    await_fan(model, w, point, &waiting);
    test_waiting(model, w, &waiting);
}

/* Tests what is not known of a leaf cluster's points, and as much of those of the next clusters as there is room for. */
static void test_points(const sc_model *model, sc_workspace *w, uint32_t leaf)
{
    const uint32_t *point = sc_model_leaf_point(model) + SC_LEAF_POINTS * (uint64_t)leaf;
    uint32_t leaves = model->leaf_count - leaf < 4 ? model->leaf_count - leaf : 4, i;
    waiting_fans waiting;
    waiting.count = 0;
    for (i = 0; i < leaves * SC_LEAF_POINTS && waiting.count < SC_FANS; i++)
        if (w->fan[point[i]] >> 1 != w->pose_tick) await_fan(model, w, point[i], &waiting);
    test_waiting(model, w, &waiting);
}

unsigned sc_fan_plain_of_leaf(const sc_model *model, sc_workspace *w, uint32_t leaf)
{
    const uint32_t *first = sc_model_leaf_first(model);
    const uint32_t *point = sc_model_leaf_point(model) + SC_LEAF_POINTS * (uint64_t)leaf;
    const uint8_t *corner = sc_model_leaf_corner(model) + 3 * SC_LEAF_MAX * (uint64_t)leaf;
    uint32_t i, count = first[leaf + 1] - first[leaf];
    unsigned points = 0, plain = 0, unknown = 0;
    if (w->plain_tick[leaf] == w->pose_tick) return w->plain[leaf];
    for (i = 0; i < SC_LEAF_POINTS; i++) unknown |= w->fan[point[i]] >> 1 ^ w->pose_tick;
    if (unknown) test_points(model, w, leaf);
    for (i = 0; i < SC_LEAF_POINTS; i++) points |= (w->fan[point[i]] & 1u) << i;
    for (i = 0; i < count; i++)
        plain |= (points >> corner[i] & points >> corner[SC_LEAF_MAX + i] &
                  points >> corner[2 * SC_LEAF_MAX + i] & 1u)
                 << i;
    w->plain_tick[leaf] = w->pose_tick;
    w->plain[leaf] = (uint16_t)plain;
    return plain;
}
