/*
 * Whether edges cross triangles, and where, eight at a time: determinants as sums of two doubles.
 * See trace_kernels.h. The scalar form, which is exact and does the rest, is trace/crossings.c.
 *
 * SPDX-License-Identifier: MIT
 *
 * Seen from the first end of the edge, let q be its other end and a, b, c the corners. With
 *   D = det(a, b, c),  W_a = det(q, b, c),  W_b = det(q, c, a),  W_c = det(q, a, b),
 * and W the sum of these three, the line of the edge meets the plane of the triangle at D / W of
 * the way to q, at the point whose weights are W_a / W, W_b / W and W_c / W. So the edge crosses
 * the triangle if all four have one sign and D is less than W.
 *
 * Each is computed as base/predicates.c (sum_of_two) has it, and off by 2^-98 M at most before its
 * two doubles are added, M being the sum of the absolute values of its products. It is taken for
 * certain if it is larger than 2^-44 M: then it is off by 2^-54 of itself, and with the addition by
 * 1.5 u, u = 2^-53. W is off by 3.5 u then, a weight and D / W by 6 u with the division. The point
 * p + (D / W)(q - p), as a mean of p and q with weights 1 - D / W and D / W, is off by 12 u of the
 * larger of the two coordinates, and by 3 u more for the difference, the products and the sum: less
 * than the 16 u of a contact. Whether D is less than W is certain unless they are equal up to
 * 2^-50.
 *
 * A product that underflows is off by 2^-1022 at most, however subnormal numbers are treated; then
 * it is multiplied by two components of at most 2^250, and there are fewer than 2^10 of them. That
 * is below 2^-510, less than 2^-54 of what is larger than 2^-450.
 */

/* A component of a cross product: high + low, what tails add to it, and the sum of its absolute
   products. */
typedef struct crossing_minor {
    exact_doubles high;
    doubles low, tails, magnitude;
} crossing_minor;

static SC_INLINE crossing_minor crossing_minor_of(const exact_doubles u[3],
                                                  const exact_doubles v[3], int i)
{
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    crossing_minor m;
    doubles left_error, right_error, error;
    const doubles left = exact_product(&u[j], &v[k], &left_error);
    const doubles right = exact_product(&u[k], &v[j], &right_error);
    const doubles high = exact_sum(left, doubles_subtract(doubles_all(0), right), &error);
    m.high = exact_halves(high, doubles_all(0));
    m.low = doubles_add(error, doubles_subtract(left_error, right_error));
    m.tails = doubles_subtract(doubles_add(doubles_multiply(u[j].tail, v[k].value),
                                           doubles_multiply(u[j].value, v[k].tail)),
                               doubles_add(doubles_multiply(u[k].tail, v[j].value),
                                           doubles_multiply(u[k].value, v[j].tail)));
    m.magnitude = doubles_add(doubles_absolute(left), doubles_absolute(right));
    return m;
}

/* The determinant, and the lanes in which it is certain. */
static SC_INLINE doubles crossing_determinant(const crossing_minor m[3], const exact_doubles w[3],
                                              unsigned *certain)
{
    doubles first = doubles_all(0), second = doubles_all(0), magnitude = doubles_all(0);
    doubles size, bound;
    int i;
    SC_UNROLL
    for (i = 0; i < 3; i++) {
        doubles product_error, sum_error;
        const doubles product = exact_product(&m[i].high, &w[i], &product_error);
        first = exact_sum(first, product, &sum_error);
        second = doubles_add(second, doubles_add(sum_error, product_error));
        second = doubles_add(second, doubles_multiply(m[i].low, w[i].value));
        second = doubles_add(second, doubles_multiply(m[i].high.value, w[i].tail));
        second = doubles_add(second, doubles_multiply(m[i].tails, w[i].value));
        magnitude =
            doubles_add(magnitude, doubles_multiply(m[i].magnitude, doubles_absolute(w[i].value)));
    }
    first = doubles_add(first, second);
    size = doubles_absolute(first);
    bound = doubles_larger(doubles_all(SC_BOUNDS_CROSSING_LEAST),
                           doubles_multiply(doubles_all(SC_BOUNDS_CROSSING), magnitude));
    *certain = doubles_bits(doubles_below(bound, size));
    return first;
}

static void look_at_crossings(const sc_crossing_lanes *of, sc_crossing_values *values)
{
    doubles at[5][3], reach = doubles_all(0), w[3], d = reach, sum, share;
    exact_doubles to[4][3]; /* q, a, b, c */
    crossing_minor m[3];
    unsigned certain[4], known, one_sign, inside, outside, reached;
    int k, c;
    SC_UNROLL
    for (k = 0; k < 5; k++) doubles_points(of->point[k], of->floats, at[k]);
    SC_UNROLL
    for (k = 0; k < 4; k++) {
        SC_UNROLL
        for (c = 0; c < 3; c++) {
            to[k][c] = exact_difference(at[k + 1][c], at[0][c]);
            reach = doubles_larger_size(reach, to[k][c].value);
        }
    }
    reached = doubles_bits(doubles_below(reach, doubles_all(SC_BOUNDS_CROSSING_MOST)));
    for (k = 0; k < 3; k++) {
        const exact_doubles *u = to[1 + (k + 1) % 3], *v = to[1 + (k + 2) % 3];
        SC_UNROLL
        for (c = 0; c < 3; c++) m[c] = crossing_minor_of(u, v, c);
        w[k] = crossing_determinant(m, to[0], &certain[k]);
        if (k == 0) d = crossing_determinant(m, to[1], &certain[3]);
    }
    sum = doubles_add(doubles_add(w[0], w[1]), w[2]);
    known = reached & certain[0] & certain[1] & certain[2];
    one_sign = known & ~doubles_differ3(w[0], w[1], w[2]);
    share = doubles_multiply(doubles_all(SC_BOUNDS_CROSSING_SHARE), doubles_absolute(sum));
    inside = doubles_bits(
        doubles_below(doubles_absolute(d), doubles_subtract(doubles_absolute(sum), share)));
    outside =
        doubles_bits(doubles_below(doubles_add(doubles_absolute(sum), share), doubles_absolute(d)));
    values->cross = one_sign & certain[3] & ~doubles_differ(d, sum) & inside;
    values->apart =
        (known & ~one_sign) | (one_sign & certain[3] & (doubles_differ(d, sum) | outside));
    doubles_store(values->along, d);
    for (k = 0; k < 3; k++) doubles_store(values->weights[k], w[k]);
}
