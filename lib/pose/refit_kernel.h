/*
 * Boxes of the triangles of a leaf cluster and of the cluster. See refit.h.
 *
 * SPDX-License-Identifier: MIT
 */

/* Moves bounds outwards by one step of rounding, see base/boxes.h. */
static inline lanes SC_KERNEL(step)(lanes bound)
{
    return lanes_add(lanes_multiply(lanes_absolute(bound), lanes_all(1.1920929e-7f)),
                     lanes_all(FLT_MIN));
}

static void SC_KERNEL(refit_leaf)(const sc_model *model, sc_workspace *w, uint32_t leaf)
{
    const uint32_t *first = sc_model_leaf_first(model);
    const uint32_t *corner = sc_model_triangle(model) + 3 * (uint64_t)first[leaf];
    uint32_t count = first[leaf + 1] - first[leaf], i;
    uint32_t patch = sc_model_first_leaf_patch(model) + leaf;
    uint64_t at = (uint64_t)leaf * SC_LEAF_MAX;
    const float *point[3][SC_LANES_COUNT];
    lanes a[3], b[3], c[3];
    int k;
    for (i = 0; i < SC_LANES_COUNT; i++) { /* the last triangle fills the row */
        const uint32_t *t = corner + 3 * (i < count ? i : count - 1);
        for (k = 0; k < 3; k++) point[k][i] = w->unit + 4 * (uint64_t)t[k];
    }
    lanes_points(point[0], &a[0], &a[1], &a[2]);
    lanes_points(point[1], &b[0], &b[1], &b[2]);
    lanes_points(point[2], &c[0], &c[1], &c[2]);
    for (k = 0; k < 3; k++) {
        lanes low = lanes_smaller(a[k], lanes_smaller(b[k], c[k]));
        lanes high = lanes_larger(a[k], lanes_larger(b[k], c[k]));
        low = lanes_subtract(low, SC_KERNEL(step)(low));
        high = lanes_add(high, SC_KERNEL(step)(high));
        w->patch_boxes.side[k][patch] = lanes_least(low);
        w->patch_boxes.side[k + 3][patch] = lanes_most(high);
        lanes_store(w->triangle_boxes.side[k] + at, low);
        lanes_store(w->triangle_boxes.side[k + 3] + at, high);
        for (i = count; i < SC_LEAF_MAX; i++) /* no triangle: overlaps nothing */
            w->triangle_boxes.side[k][at + i] = w->triangle_boxes.side[k + 3][at + i] = (float)NAN;
    }
}
