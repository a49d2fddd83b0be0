/*
 * Which of sixteen pairs are near and which are far: distances in floats, with two certificates.
 *
 * SPDX-License-Identifier: MIT
 *
 * Of a vertex and a face v is the vector from a corner to the vertex, e and f those to the other
 * corners; of two edges v leads from the begin of the second to that of the first, e along the
 * first, f along the second. A guess of the points that are next to each other, by regions and with
 * few divisions, gives the vector w between them. It is right nearly always, and need not be:
 *   - near, if |w| is less than the distance: w leads from a point of the one to a point of the
 *     other, wherever these are, as weights are clamped;
 *   - far, if w separates: if all differences of points of the two are farther along w than the
 *     distance. The least of them is at corners.
 * Both with the bound of sc_bounds_near, where this is derived. What is neither, by rounding or by
 * a bad guess for thin triangles and parallel edges, is left open; so is what is NaN.
 */

/* Thresholds for squares of lengths, and the bound that they keep. */
typedef struct near_limits {
    lanes near, far;
    double error;
} near_limits;

/* What was measured of sixteen pairs: squares of lengths of w, and g, the least places along w,
   times |w|. */
typedef struct near_measured {
    float square[SC_LANES_COUNT], g[SC_LANES_COUNT];
} near_measured;

static inline near_limits near_limits_for(double distance, double size)
{
    const double error = sc_bounds_near(distance, size);
    const double low = distance - error, high = distance + error;
    near_limits limits;
    limits.error = error;
    limits.near = lanes_all(low > 0 ? (float)(low * low * (1 - SC_BOUNDS_NEAR_SQUARE)) : -1.0f);
    limits.far = lanes_all((float)(high * high * (1 + 2 * SC_BOUNDS_NEAR_SQUARE)));
    return limits;
}

static inline lanes near_inner(const lanes a[3], const lanes b[3])
{
    return lanes_add(lanes_add(lanes_multiply(a[0], b[0]), lanes_multiply(a[1], b[1])),
                     lanes_multiply(a[2], b[2]));
}

/* From 0 to 1; 0 if it is NaN. */
static inline lanes near_clamp(lanes x)
{
    return lanes_smaller(lanes_larger(x, lanes_all(0)), lanes_all(1));
}

/* At most the distance of one of them, in the unit box; less than 0 if what was guessed tells too
   little: its distance is at most |w| + error. Where |w| is more than twice the error, its square
   is far above SC_BOUNDS_NEAR_LEAST. */
static inline double near_bound(const near_measured *m, uint32_t i, const near_limits *limits)
{
    const double g = (double)m->g[i], length = sqrt((double)m->square[i]);
    double bound;
    if (length <= 2 * limits->error) return 0;
    if (!(g > length * (length - 2 * limits->error))) /* or NaN */
        return -1;
    bound = g / length * (1 - SC_BOUNDS_NEAR_BELOW) - limits->error;
    return bound > 0 ? bound : 0;
}

/* Near ones, and in the upper half far ones: g is the least place along w, times |w|. What is
   measured is kept, unless that is NULL. */
static inline unsigned near_or_far(const lanes w[3], lanes g, const near_limits *limits,
                                   near_measured *measured)
{
    const lanes square = near_inner(w, w);
    const lanes_mask far =
        lanes_both(lanes_both(lanes_below(lanes_all(0), g),
                              lanes_below(lanes_all(SC_BOUNDS_NEAR_LEAST), square)),
                   lanes_below(lanes_multiply(square, limits->far), lanes_multiply(g, g)));
    if (measured) {
        lanes_store(measured->square, square);
        lanes_store(measured->g, g);
    }
    return lanes_bits(lanes_not_above(square, limits->near)) | lanes_bits(far) << 16;
}

/* The square of the distance from v to s e + t f is |v|^2 plus this, where the products are those
   of e and f with themselves and v. */
static inline lanes near_along(lanes s, lanes ee, lanes ev)
{
    return lanes_multiply(s, lanes_subtract(lanes_multiply(s, ee), lanes_add(ev, ev)));
}

static inline unsigned judge_faces(const lanes v[3], const lanes e[3], const lanes f[3],
                                   const near_limits *limits, near_measured *measured)
{
    const lanes zero = lanes_all(0), one = lanes_all(1);
    const lanes ee = near_inner(e, e), ef = near_inner(e, f), ff = near_inner(f, f);
    const lanes ev = near_inner(e, v), fv = near_inner(f, v);
    /* inside: by Cramer's rule */
    const lanes det = lanes_subtract(lanes_multiply(ee, ff), lanes_multiply(ef, ef));
    const lanes p = lanes_subtract(lanes_multiply(ff, ev), lanes_multiply(ef, fv));
    const lanes q = lanes_subtract(lanes_multiply(ee, fv), lanes_multiply(ef, ev));
    const lanes_mask inside =
        lanes_both(lanes_both(lanes_not_above(zero, p), lanes_not_above(zero, q)),
                   lanes_both(lanes_not_above(lanes_add(p, q), det), lanes_below(zero, det)));
    /* on each side */
    const lanes s1 = near_clamp(lanes_divide(ev, ee)), t2 = near_clamp(lanes_divide(fv, ff));
    const lanes back = lanes_subtract(ef, ee);
    const lanes t3 = near_clamp(lanes_divide(lanes_subtract(lanes_subtract(fv, ev), back),
                                             lanes_subtract(lanes_subtract(ff, ef), back)));
    const lanes s3 = lanes_subtract(one, t3);
    const lanes d1 = near_along(s1, ee, ev), d2 = near_along(t2, ff, fv);
    const lanes d3 = lanes_add(lanes_add(near_along(s3, ee, ev), near_along(t3, ff, fv)),
                               lanes_multiply(lanes_multiply(s3, t3), lanes_add(ef, ef)));
    const lanes_mask second = lanes_below(d2, d1);
    const lanes_mask third = lanes_below(d3, lanes_smaller(d1, d2));
    const lanes scale = lanes_divide(one, det);
    lanes s = lanes_choose(second, zero, s1), t = lanes_choose(second, t2, zero), w[3];
    int k;
    s = lanes_choose(third, s3, s);
    t = lanes_choose(third, t3, t);
    s = lanes_choose(inside, lanes_multiply(p, scale), s);
    t = lanes_choose(inside, lanes_multiply(q, scale), t);
    SC_UNROLL
    for (k = 0; k < 3; k++)
        w[k] =
            lanes_subtract(lanes_subtract(v[k], lanes_multiply(s, e[k])), lanes_multiply(t, f[k]));
    return near_or_far(
        (const lanes *)w,
        lanes_subtract(near_inner((const lanes *)w, v),
                       lanes_larger(zero, lanes_larger(near_inner((const lanes *)w, e),
                                                       near_inner((const lanes *)w, f)))),
        limits, measured);
}

static inline unsigned judge_edges(const lanes v[3], const lanes e[3], const lanes f[3],
                                   const near_limits *limits, near_measured *measured)
{
    const lanes zero = lanes_all(0);
    const lanes ee = near_inner(e, e), ef = near_inner(e, f), ff = near_inner(f, f);
    const lanes ev = near_inner(e, v), fv = near_inner(f, v);
    const lanes det = lanes_subtract(lanes_multiply(ee, ff), lanes_multiply(ef, ef));
    lanes s = near_clamp(
        lanes_divide(lanes_subtract(lanes_multiply(ef, fv), lanes_multiply(ff, ev)), det));
    const lanes t = near_clamp(lanes_divide(lanes_add(lanes_multiply(ef, s), fv), ff));
    lanes w[3];
    int k;
    s = near_clamp(lanes_divide(lanes_subtract(lanes_multiply(ef, t), ev), ee));
    SC_UNROLL
    for (k = 0; k < 3; k++)
        w[k] = lanes_subtract(lanes_add(v[k], lanes_multiply(s, e[k])), lanes_multiply(t, f[k]));
    return near_or_far(
        (const lanes *)w,
        lanes_subtract(lanes_add(near_inner((const lanes *)w, v),
                                 lanes_smaller(zero, near_inner((const lanes *)w, e))),
                       lanes_larger(zero, near_inner((const lanes *)w, f))),
        limits, measured);
}
