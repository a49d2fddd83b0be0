/*
 * The test of pairs of triangles by their planes, in double precision. See candidates.c.
 *
 * SPDX-License-Identifier: MIT
 *
 * A computed distance n . (p - a), n = e x f, is a sum of six products of components of e, f and
 * p - a. Each collects the rounding of three differences, two products, one subtraction and two
 * additions, 8.01 * 2^-53 of its absolute value; the absolute values sum to at most |p - a|max |e|1
 * |f|1, computed to within 8 * 2^-53. Hence 9 * 2^-53 |p - a|max |e|1 |f|1; the absolute term is for
 * products that underflow.
 */
static sc_plane_test SC_KERNEL(test_planes)(const sc_pair_lanes *x)
{
    const double relative = 9 * 1.1102230246251565e-16, absolute = 1e-290;
    sc_plane_test result = {0, 0};
    int lane, s, k;
    for (s = 0; s < 2; s++) {
        const double(*t)[3][SC_PAIR_LANES] = x->corner[s],
              (*o)[3][SC_PAIR_LANES] = x->corner[1 - s];
        double apart[SC_PAIR_LANES], flat[SC_PAIR_LANES]; /* positive if so */
        for (lane = 0; lane < SC_PAIR_LANES; lane++) {
            double a0 = t[0][0][lane], a1 = t[0][1][lane], a2 = t[0][2][lane];
            double e0 = t[1][0][lane] - a0, e1 = t[1][1][lane] - a1, e2 = t[1][2][lane] - a2;
            double f0 = t[2][0][lane] - a0, f1 = t[2][1][lane] - a1, f2 = t[2][2][lane] - a2;
            double n0 = e1 * f2 - e2 * f1, n1 = e2 * f0 - e0 * f2, n2 = e0 * f1 - e1 * f0;
            double low = HUGE_VAL, high = -HUGE_VAL, reach = 0, not_finite = 0, bound;
            for (k = 0; k < 3; k++) {
                double p0 = o[k][0][lane] - a0, p1 = o[k][1][lane] - a1, p2 = o[k][2][lane] - a2;
                double d = n0 * p0 + n1 * p1 + n2 * p2;
                p0 = fabs(p0) > fabs(p1) ? fabs(p0) : fabs(p1);
                p0 = p0 > fabs(p2) ? p0 : fabs(p2);
                reach = reach > p0 ? reach : p0;
                low = d < low ? d : low;
                high = d > high ? d : high;
                not_finite +=
                    0 * d; /* NaN if d is, or is infinite; a comparison would pass over it */
            }
            bound = relative * (reach * ((fabs(e0) + fabs(e1) + fabs(e2)) *
                                         (fabs(f0) + fabs(f1) + fabs(f2)))) +
                    absolute * (1 + reach) + not_finite;
            apart[lane] = (low > -high ? low : -high) - bound;
            flat[lane] = (low < -high ? low : -high) + bound;
        }
        for (lane = 0; lane < SC_PAIR_LANES; lane++) {
            result.apart |= (unsigned)(apart[lane] > 0) << lane;
            result.flat |= (unsigned)(flat[lane] >= 0) << lane;
        }
    }
    return result;
}
