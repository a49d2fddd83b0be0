/*
 * Boxes of leaf clusters, and of patches by those of their children. See refit.h.
 *
 * SPDX-License-Identifier: MIT
 */

/* How far a bound has to be moved outwards, see SC_BOUNDS_STEP. */
static inline lanes rounding_step(lanes bound)
{
    return lanes_add(lanes_multiply(lanes_absolute(bound), lanes_all(SC_BOUNDS_STEP)),
                     lanes_all(SC_BOUNDS_STEP_LEAST));
}

/* Boxes of sixteen leaf clusters, whose points are `stride` floats apart. */
static SC_INLINE void boxes_of(const float *at, uint64_t stride, lanes side[6])
{
    int k;
    lanes_rows_ends(at, stride, side, side + 3);
    SC_UNROLL
    for (k = 0; k < 3; k++) {
        side[k] = lanes_subtract(side[k], rounding_step(side[k]));
        side[k + 3] = lanes_add(side[k + 3], rounding_step(side[k + 3]));
    }
}

static void refit_leaves(const sc_model *model, sc_frame *frame, uint32_t first, uint32_t end)
{
    const uint32_t patch = sc_model_first_leaf_patch(model), length = 4 * SC_LEAF_POINTS;
    uint32_t leaf = first;
    lanes side[6];
    float one[SC_LANES_COUNT];
    int k;
    while (leaf < end && end - first >= SC_LANES_COUNT) {
        if (end - leaf < SC_LANES_COUNT) leaf = end - SC_LANES_COUNT; /* some once more */
        boxes_of(frame->point_at + length * (uint64_t)leaf, length, side);
        SC_UNROLL
        for (k = 0; k < 6; k++) lanes_store(frame->patch_boxes.side[k] + patch + leaf, side[k]);
        leaf += SC_LANES_COUNT;
    }
    for (; leaf < end; leaf++) { /* fewer than sixteen: each sixteen times */
        boxes_of(frame->point_at + length * (uint64_t)leaf, 0, side);
        for (k = 0; k < 6; k++) {
            lanes_store(one, side[k]);
            frame->patch_boxes.side[k][patch + leaf] = one[0];
        }
    }
}

/*
 * Patches first to end - 1 of a level, of which each has one child or two. Mostly sixteen that
 * follow each other have two each, or one each, and then so do their children.
 */
static void refit_patches(const sc_model *model, sc_frame *frame, uint32_t first, uint32_t end)
{
    const uint32_t *child = sc_model_child(model);
    uint32_t p, q;
    int k;
    for (p = first; p < end; p = q) {
        uint32_t from = child[p], children;
        q = p + SC_LANES_COUNT < end ? p + SC_LANES_COUNT : end;
        children = child[q] - from;
        SC_UNROLL
        for (k = 0; k < 3; k++) {
            float *low = frame->patch_boxes.side[k], *high = frame->patch_boxes.side[k + 3];
            if (children == 2 * SC_LANES_COUNT) {
                lanes a = lanes_load(low + from), b = lanes_load(low + from + SC_LANES_COUNT);
                lanes_store(low + p, lanes_smaller(lanes_evens(a, b), lanes_odds(a, b)));
                a = lanes_load(high + from), b = lanes_load(high + from + SC_LANES_COUNT);
                lanes_store(high + p, lanes_larger(lanes_evens(a, b), lanes_odds(a, b)));
            } else if (children == SC_LANES_COUNT && q - p == SC_LANES_COUNT) {
                lanes_store(low + p, lanes_load(low + from));
                lanes_store(high + p, lanes_load(high + from));
            } else {
                uint32_t i;
                for (i = p; i < q; i++) {
                    uint32_t one = child[i], other = child[i + 1] - 1;
                    low[i] = low[one] < low[other] ? low[one] : low[other];
                    high[i] = high[one] > high[other] ? high[one] : high[other];
                }
            }
        }
    }
}
