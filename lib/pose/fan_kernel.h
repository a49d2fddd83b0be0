/*
 * The test of fans in single precision, for rings of up to sixteen points. See fan.c.
 *
 * SPDX-License-Identifier: MIT
 *
 * Points are in the unit box, each coordinate off by POINT = 3e-8 at most. With S = |r_i|1 + |r_(i+1)|1 and
 * v = 2^-24: a product of components of r_i and r_(i+1) is off by 2 POINT times each factor, 4 POINT^2, and by 4.1 v
 * of itself; d . n_i has two products for each component of d, and rounds three times: in all by
 * |d|1 (2 POINT S + 8 POINT^2 + 8.2 v S^2 / 4). The computed y_i are those of a ring moved by
 * |d|1 (2 POINT + 4 v |r_i|1), which changes an area by 1.23 |d|1 (4 POINT + 4 v S) S at most. All of it is below
 * |d|1 (8 POINT (S + POINT) + 8 v S^2), and FLT_MIN for products that underflow.
 */
static int SC_KERNEL(is_plain)(const sc_workspace *w, const uint32_t *ring, uint32_t count,
                               uint32_t point)
{
    const lanes point_error = lanes_all(3e-8f);
    const float *at[SC_LANES_COUNT], *center = w->unit + 4 * (uint64_t)point;
    lanes r[3], next[3], n[3], size, sum, area, bound, d_size_lanes;
    float d[3], d_size, c0, c1;
    unsigned all = (1u << count) - 1u, above, turned, i;
    int k, axis;
    for (i = 0; i < SC_LANES_COUNT; i++) /* the rest of the row makes empty sectors */
        at[i] = w->unit + 4 * (uint64_t)ring[i < count ? i : 0];
    lanes_points(at, &r[0], &r[1], &r[2]);
    for (k = 0; k < 3; k++) {
        r[k] = lanes_subtract(r[k], lanes_all(center[k]));
        next[k] = lanes_next(r[k], r[k]);
    }
    for (k = 0; k < 3; k++) {
        n[k] = lanes_subtract(lanes_multiply(r[(k + 1) % 3], next[(k + 2) % 3]),
                              lanes_multiply(r[(k + 2) % 3], next[(k + 1) % 3]));
        d[k] = lanes_sum(n[k]);
    }
    d_size = fabsf(d[0]) + fabsf(d[1]) + fabsf(d[2]);
    d_size_lanes = lanes_all(d_size);
    size = lanes_add(lanes_add(lanes_absolute(r[0]), lanes_absolute(r[1])), lanes_absolute(r[2]));
    sum = lanes_add(size, lanes_next(size, size));
    area = lanes_add(
        lanes_add(lanes_multiply(lanes_all(d[0]), n[0]), lanes_multiply(lanes_all(d[1]), n[1])),
        lanes_multiply(lanes_all(d[2]), n[2]));
    bound = lanes_multiply(lanes_multiply(lanes_all(8), point_error), lanes_add(sum, point_error));
    bound = lanes_add(
        bound, lanes_multiply(lanes_all(8 * 5.9604644775390625e-8f), lanes_multiply(sum, sum)));
    bound = lanes_add(lanes_multiply(d_size_lanes, bound), lanes_all(FLT_MIN));
    if ((lanes_bits(lanes_below(bound, area)) & all) != all) return 0;
    axis = fabsf(d[1]) < fabsf(d[0]);
    if (fabsf(d[2]) < fabsf(d[axis])) axis = 2;
    c0 = -d[(axis + 2) % 3];
    c1 = d[(axis + 1) % 3];
    above = lanes_bits(
        lanes_below(lanes_all(0), lanes_add(lanes_multiply(lanes_all(c0), r[(axis + 1) % 3]),
                                            lanes_multiply(lanes_all(c1), r[(axis + 2) % 3]))));
    above &= all;
    /* bit i: above, and the one before it round the ring is not */
    turned = above & ~(above << 1 | above >> (count - 1));
    return turned != 0 && (turned & (turned - 1)) == 0;
}
