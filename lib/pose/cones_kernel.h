/*
 * The pass over leaf clusters: their points, and their normal cones, sixteen triangles at a time. See dnc.h.
 *
 * SPDX-License-Identifier: MIT
 *
 * All of it is in single precision on the points in the unit box, each coordinate being off by
 * POINT at most: 2^-25 for the rounding to float and a little for that to double before.
 *
 * The error of a dot product of a computed normal e x f with a direction, whose components are 0 or
 * +-1. Written out, it is a sum of at most six products of a component of e and one of f, each component
 * at most twice. A component of e or f is off by 2 POINT and the rounding of a difference, so that the products are
 * off by 2 (2 POINT) (|e|1 + |f|1) + 6 (2 POINT)^2 in all, and by rounding: two differences, one multiplication, one
 * subtraction and two additions each, ((1 + u)^6 - 1) < 6.01 u times its absolute value, u = 2^-24; the
 * sum of the absolute values is at most |e|1 |f|1, computed to within 8 u. Hence 8 u |e|1 |f|1 +
 * 4.1 POINT (|e|1 + |f|1 + 6 POINT); the last term is for products that underflow.
 */
static inline uint32_t SC_KERNEL(mask_of)(const float *at, const uint8_t *where)
{
    const lanes relative = lanes_all(8 * 5.9604644775390625e-8f),
                absolute = lanes_all(16 * FLT_MIN);
    const lanes moved = lanes_all(4.1f * 3e-8f), least = lanes_all(6 * 3e-8f);
    lanes corner[3][3], e[3], f[3], n[3], e_size, f_size, sum, difference, error, minus_error,
        dot[7];
    uint32_t mask = 0;
    int k, d;
    lanes_corners(at, where, corner);
    SC_UNROLL
    for (k = 0; k < 3; k++) {
        e[k] = lanes_subtract(corner[1][k], corner[0][k]);
        f[k] = lanes_subtract(corner[2][k], corner[0][k]);
    }
    SC_UNROLL
    for (k = 0; k < 3; k++)
        n[k] = lanes_subtract(lanes_multiply(e[(k + 1) % 3], f[(k + 2) % 3]),
                              lanes_multiply(e[(k + 2) % 3], f[(k + 1) % 3]));
    e_size = lanes_add(lanes_add(lanes_absolute(e[0]), lanes_absolute(e[1])), lanes_absolute(e[2]));
    f_size = lanes_add(lanes_add(lanes_absolute(f[0]), lanes_absolute(f[1])), lanes_absolute(f[2]));
    error = lanes_add(lanes_add(lanes_multiply(relative, lanes_multiply(e_size, f_size)),
                                lanes_multiply(moved, lanes_add(lanes_add(e_size, f_size), least))),
                      absolute);
    minus_error = lanes_subtract(lanes_all(0), error);
    sum = lanes_add(n[0], n[1]);
    difference = lanes_subtract(n[0], n[1]);
    dot[0] = n[0];
    dot[1] = n[1];
    dot[2] = n[2];
    dot[3] = lanes_add(sum, n[2]);
    dot[4] = lanes_subtract(sum, n[2]);
    dot[5] = lanes_add(difference, n[2]);
    dot[6] = lanes_subtract(difference, n[2]);
    SC_UNROLL
    for (d = 0; d < 7; d++) {
        mask |= (uint32_t)lanes_every(lanes_below(error, dot[d])) << d;
        mask |= (uint32_t)lanes_every(lanes_below(dot[d], minus_error)) << (d + 7);
    }
    return mask;
}

static uint32_t SC_KERNEL(cone)(const float *at, const uint8_t *where)
{
    return SC_KERNEL(mask_of)(at, where);
}

static void SC_KERNEL(load_leaves)(const sc_model *model, sc_workspace *w, uint32_t first,
                                   uint32_t end, int cones)
{
    const uint32_t *point = sc_model_leaf_point(model);
    const uint8_t *where = sc_model_leaf_corner(model);
    uint16_t *mask = w->mask + sc_model_first_leaf_patch(model);
    uint32_t leaf;
    for (leaf = first; leaf < end; leaf++) {
        float *at = w->leaf_at + 3 * SC_LEAF_POINTS * (uint64_t)leaf;
        SC_KERNEL(load_points)(w, point + SC_LEAF_POINTS * (uint64_t)leaf, at);
        if (cones)
            mask[leaf] = (uint16_t)SC_KERNEL(mask_of)(at, where + 3 * SC_LEAF_MAX * (uint64_t)leaf);
    }
}
