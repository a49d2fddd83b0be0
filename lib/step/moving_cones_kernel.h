/*
 * Normal cones of leaf clusters that hold throughout a step, sixteen triangles at a time. See
 * step_motion.h.
 *
 * SPDX-License-Identifier: MIT
 *
 * With e and f the sides of a triangle from its first corner, the normal e x f is a polynomial of
 * degree 2 in time; its coefficients in Bernstein form are e0 x f0, (e0 x f1 + e1 x f0) / 2 and e1
 * x f1, with 0 at the start and 1 at the end. A direction s for which all three have a dot product
 * above c has that for the normal at all times. The altitudes of the triangle, projected along s,
 * are twice its projected area n . s / |s| over the projected sides, and so more than d if n . s >
 * |s| d L, where L is as long as any side at any time: and that is longest at the start or at the
 * end. If this holds for some directions it does for their sums, of which |s| is at most the sum of
 * the lengths.
 *
 * Rounding is as in pose/cones_kernel.h: a dot product is a sum of six products of components, each
 * component being off by 2 POINT and in two of them, and rounds six times. With |e|1 and |f|1 the
 * larger of both ends, that of the first or last coefficient is off by 8 u |e|1 |f|1 + 4.1 POINT
 * (|e|1 + |f|1 + 6 POINT), that of the middle one, an average of two, by as much and another
 * rounding: 10 u covers all. L is off by 2 sqrt(3) POINT on each side; with 1616 POINT^2, (L + 4
 * POINT)^2 <= 1.01 L^2 + 1616 POINT^2. Squares are compared, which takes no root: those round by a
 * few u.
 */
/* What the coefficients of n . s may be off by, |e|1 and |f|1 being so large. */
static inline lanes moving_normal_error(lanes e_size, lanes f_size)
{
    const lanes relative = lanes_all(10 * SC_BOUNDS_V);
    const lanes moved = lanes_all(4.1f * SC_BOUNDS_POINT), least = lanes_all(6 * SC_BOUNDS_POINT);
    return lanes_add(lanes_add(lanes_multiply(relative, lanes_multiply(e_size, f_size)),
                               lanes_multiply(moved, lanes_add(lanes_add(e_size, f_size), least))),
                     lanes_all(32 * FLT_MIN));
}

/* The square of the length that a side may have, by the computed one. */
static inline lanes longest_square(lanes square)
{
    return lanes_add(lanes_multiply(lanes_all(1.01f), square),
                     lanes_all(1.0001f * 1616 * SC_BOUNDS_POINT * SC_BOUNDS_POINT));
}

static inline uint32_t mask_over(const sc_motion *m, const uint32_t *corner, uint32_t count,
                                 const int ends)
{
    const int normals = ends == 1 ? 1 : 3;
    const lanes half = lanes_all(0.5f), none = lanes_all(0);
    lanes e[2][3], f[2][3], n[3][3], error, e_size = none, f_size = none, longest = none, clear[2];
    float d = m->altitude;
    uint32_t mask = 0, i;
    int k, s, end;
    for (end = 0; end < ends; end++) {
        const float *point[3][SC_LANES_COUNT];
        lanes a[3], square[3], size[2];
        for (i = 0; i < SC_LANES_COUNT; i++) { /* the last triangle fills the row */
            const uint32_t *t = corner + 3 * (i < count ? i : count - 1);
            for (k = 0; k < 3; k++) point[k][i] = m->unit + 8 * (uint64_t)t[k] + 4 * end;
        }
        lanes_points(point[0], &a[0], &a[1], &a[2]);
        lanes_points(point[1], &e[end][0], &e[end][1], &e[end][2]);
        lanes_points(point[2], &f[end][0], &f[end][1], &f[end][2]);
        for (k = 0; k < 3; k++) square[k] = none;
        size[0] = size[1] = none;
        for (k = 0; k < 3; k++) {
            lanes g = lanes_subtract(f[end][k], e[end][k]);
            e[end][k] = lanes_subtract(e[end][k], a[k]);
            f[end][k] = lanes_subtract(f[end][k], a[k]);
            size[0] = lanes_add(size[0], lanes_absolute(e[end][k]));
            size[1] = lanes_add(size[1], lanes_absolute(f[end][k]));
            square[0] = lanes_add(square[0], lanes_multiply(e[end][k], e[end][k]));
            square[1] = lanes_add(square[1], lanes_multiply(f[end][k], f[end][k]));
            square[2] = lanes_add(square[2], lanes_multiply(g, g));
        }
        e_size = lanes_larger(e_size, size[0]);
        f_size = lanes_larger(f_size, size[1]);
        longest =
            lanes_larger(longest, lanes_larger(square[0], lanes_larger(square[1], square[2])));
    }
    for (k = 0; k < 3; k++) {
        int x = (k + 1) % 3, y = (k + 2) % 3;
        lanes one, two;
        n[0][k] =
            lanes_subtract(lanes_multiply(e[0][x], f[0][y]), lanes_multiply(e[0][y], f[0][x]));
        if (ends == 1) continue;
        n[2][k] =
            lanes_subtract(lanes_multiply(e[1][x], f[1][y]), lanes_multiply(e[1][y], f[1][x]));
        one = lanes_subtract(lanes_multiply(e[0][x], f[1][y]), lanes_multiply(e[0][y], f[1][x]));
        two = lanes_subtract(lanes_multiply(e[1][x], f[0][y]), lanes_multiply(e[1][y], f[0][x]));
        n[1][k] = lanes_multiply(half, lanes_add(one, two));
    }
    error = moving_normal_error(e_size, f_size);
    longest = longest_square(longest);
    clear[0] = lanes_add(lanes_multiply(lanes_all(1.0001f * d * d), longest), lanes_all(FLT_MIN));
    clear[1] = lanes_multiply(lanes_all(3), clear[0]); /* of corners; of faces */
    for (s = 0; s < 7; s++) {
        lanes low = none, high = none, up, down;
        lanes_mask good[2];
        for (k = 0; k < normals; k++) {
            lanes dot;
            if (s < 3)
                dot = n[k][s];
            else {
                dot = s < 5 ? lanes_add(n[k][0], n[k][1]) : lanes_subtract(n[k][0], n[k][1]);
                dot = s % 2 ? lanes_add(dot, n[k][2]) : lanes_subtract(dot, n[k][2]);
            }
            low = k ? lanes_smaller(low, dot) : dot;
            high = k ? lanes_larger(high, dot) : dot;
        }
        up = lanes_subtract(low, error);
        down = lanes_subtract(lanes_subtract(none, high), error);
        good[0] =
            lanes_both(lanes_below(none, up), lanes_below(clear[s >= 3], lanes_multiply(up, up)));
        good[1] = lanes_both(lanes_below(none, down),
                             lanes_below(clear[s >= 3], lanes_multiply(down, down)));
        mask |= (uint32_t)(lanes_bits(good[0]) == 0xffff) << s;
        mask |= (uint32_t)(lanes_bits(good[1]) == 0xffff) << (s + 7);
    }
    return mask;
}

static uint32_t moving_mask_of(const sc_motion *m, const uint32_t *corner, uint32_t count)
{
    return m->ends == 1 ? mask_over(m, corner, count, 1) : mask_over(m, corner, count, 2);
}
