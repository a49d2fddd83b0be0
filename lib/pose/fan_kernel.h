/*
 * The test of fans in single precision, sixteen at a time. See fan.c.
 *
 * SPDX-License-Identifier: MIT
 *
 * Points are in the unit box, each coordinate off by POINT = 3e-8 at most. With S = |r_i|1 + |r_(i+1)|1 and
 * v = 2^-24: a product of components of r_i and r_(i+1) is off by 2 POINT times each factor, 4 POINT^2, and by 4.1 v
 * of itself; d . n_i has two products for each component of d, and rounds three times: in all by
 * |d|1 (2 POINT S + 8 POINT^2 + 8.2 v S^2 / 4). c has a component 0 for the
 * one that is dropped, which changes no rounding. The computed y_i are those of a ring moved by
 * |d|1 (2 POINT + 4 v |r_i|1), which changes an area by 1.23 |d|1 (4 POINT + 4 v S) S at most. All of it is below
 * |d|1 (8 POINT (S + POINT) + 8 v S^2), and FLT_MIN for products that underflow.
 */
static inline lanes SC_KERNEL(along)(const lanes a[3], const lanes b[3])
{
    return lanes_add(lanes_add(lanes_multiply(a[0], b[0]), lanes_multiply(a[1], b[1])),
                     lanes_multiply(a[2], b[2]));
}

static inline lanes SC_KERNEL(sum_of_sizes)(const lanes r[3])
{
    return lanes_add(lanes_add(lanes_absolute(r[0]), lanes_absolute(r[1])), lanes_absolute(r[2]));
}

static unsigned SC_KERNEL(are_plain)(const sc_workspace *w, const sc_fans *fans)
{
    const lanes zero = lanes_all(0), point_error = lanes_all(3e-8f);
    uint32_t row[SC_LANES_COUNT];
    float at[3 * SC_LANES_COUNT];
    lanes r[SC_FAN_MOST + 1][3], center[3], d[3], c[3], size[3], d_size, last_size;
    lanes_mask first, second;
    unsigned most = 0, fails = 0, once = 0, twice = 0, above, last, i, j;
    int k;
    for (j = 0; j < SC_LANES_COUNT; j++)
        if (fans->count[j] > most) most = fans->count[j];
    SC_KERNEL(load_points)(w, fans->point, at);
    SC_UNROLL
    for (k = 0; k < 3; k++) center[k] = lanes_load(at + SC_LANES_COUNT * k);
    for (i = 0; i <= most;
         i++) { /* at the end of a ring its first point, again and again: empty sectors */
        for (j = 0; j < SC_LANES_COUNT; j++) row[j] = fans->ring[j][i < fans->count[j] ? i : 0];
        SC_KERNEL(load_points)(w, row, at);
        SC_UNROLL
        for (k = 0; k < 3; k++)
            r[i][k] = lanes_subtract(lanes_load(at + SC_LANES_COUNT * k), center[k]);
    }
    SC_UNROLL
    for (k = 0; k < 3; k++) d[k] = zero;
    for (i = 0; i < most; i++) {
        SC_UNROLL
        for (k = 0; k < 3; k++)
            d[k] = lanes_add(
                d[k], lanes_subtract(lanes_multiply(r[i][(k + 1) % 3], r[i + 1][(k + 2) % 3]),
                                     lanes_multiply(r[i][(k + 2) % 3], r[i + 1][(k + 1) % 3])));
    }
    SC_UNROLL
    for (k = 0; k < 3; k++) size[k] = lanes_absolute(d[k]);
    d_size = lanes_add(lanes_add(size[0], size[1]), size[2]);
    first = lanes_both(lanes_not_above(size[0], size[1]), lanes_not_above(size[0], size[2]));
    second = lanes_not_above(size[1], size[2]);
    c[0] = lanes_choose(first, zero, lanes_choose(second, d[2], lanes_subtract(zero, d[1])));
    c[1] = lanes_choose(first, lanes_subtract(zero, d[2]), lanes_choose(second, zero, d[0]));
    c[2] = lanes_choose(first, d[1], lanes_choose(second, lanes_subtract(zero, d[0]), zero));
    last_size = SC_KERNEL(sum_of_sizes)(r[0]);
    last = lanes_bits(lanes_below(zero, SC_KERNEL(along)(c, r[0])));
    for (i = 0; i < most; i++) {
        lanes n[3], next_size = SC_KERNEL(sum_of_sizes)(r[i + 1]), sum, bound;
        unsigned inside = 0;
        SC_UNROLL
        for (k = 0; k < 3; k++)
            n[k] = lanes_subtract(lanes_multiply(r[i][(k + 1) % 3], r[i + 1][(k + 2) % 3]),
                                  lanes_multiply(r[i][(k + 2) % 3], r[i + 1][(k + 1) % 3]));
        sum = lanes_add(last_size, next_size);
        last_size = next_size;
        bound = lanes_add(
            lanes_multiply(lanes_multiply(lanes_all(8), point_error), lanes_add(sum, point_error)),
            lanes_multiply(lanes_all(8 * 5.9604644775390625e-8f), lanes_multiply(sum, sum)));
        bound = lanes_add(lanes_multiply(d_size, bound), lanes_all(FLT_MIN));
        for (j = 0; j < SC_LANES_COUNT; j++) inside |= (unsigned)(i < fans->count[j]) << j;
        fails |= inside & ~lanes_bits(lanes_below(bound, SC_KERNEL(along)(d, n)));
        above = lanes_bits(lanes_below(zero, SC_KERNEL(along)(c, r[i + 1])));
        twice |= once & above & ~last;
        once |= above & ~last;
        last = above;
    }
    return once & ~twice & ~fails;
}
