/*
 * The derived data of leaf clusters in a step: points, slabs and a box, at its start and end. See
 * step/step_worker.h.
 *
 * SPDX-License-Identifier: MIT
 *
 * Slabs that move. A triangle, or all points of a leaf cluster, are between two planes across a
 * direction n at the start of a step, and between two others across the same n at its end. A point
 * that is beyond the same one of the two at both ends, by more than the clearance d, is so at all
 * times, as its distance along n from each of their points is a linear function of time. Which n is
 * taken does not matter: for a triangle it is the normal in the middle of the step, by which its
 * slab is thinnest when it turns; for a leaf cluster the sum of these.
 *
 * Planes are moved outwards by what query/slab_kernel.h says that places are off by, and by d |n|:
 * so a point whose computed place is beyond one is more than d away. |n|, the square root of a sum
 * of squares, is bounded by a sum of two norms that is the same for (1, 0, 0) and (1, 1, 0), more
 * for (1, 1, 1), and linear in between, where |n| is convex: 0.5858 max |n_k| + 0.4143 |n|1.
 */

/* How far beyond its points the planes of slabs are. */
static inline lanes slab_margin(const lanes n[3], float distance)
{
    const lanes sum =
        lanes_add(lanes_add(lanes_absolute(n[0]), lanes_absolute(n[1])), lanes_absolute(n[2]));
    const lanes length =
        lanes_add(lanes_multiply(lanes_all(0.5858f), lanes_largest_size(n[0], n[1], n[2])),
                  lanes_multiply(lanes_all(0.4143f), sum));
    return lanes_add(lanes_add(lanes_multiply(lanes_all(SC_BOUNDS_PLACES), sum),
                               lanes_multiply(lanes_all(distance * 1.00001f), length)),
                     lanes_all(16 * FLT_MIN));
}

/* The corners of triangles at both ends, the slabs of these. */
static inline void make_moving_slabs(lanes corner[2][3][3], float distance, sc_leaf_motion *to)
{
    lanes middle[3][3], e[3], f[3], n[3], margin;
    int end, c, k;
    SC_UNROLL
    for (c = 0; c < 3; c++) {
        SC_UNROLL
        for (k = 0; k < 3; k++) middle[c][k] = lanes_add(corner[0][c][k], corner[1][c][k]);
    }
    sides_and_normals(middle, e, f, n);
    margin = slab_margin((const lanes *)n, distance);
    SC_UNROLL
    for (k = 0; k < 3; k++) {
        lanes_store(to->normal[k], n[k]);
        to->direction[k] = lanes_sum(n[k]);
    }
    SC_UNROLL
    for (end = 0; end < 2; end++) {
        lanes low, high;
        low = high = places_along((const lanes *)n, (const lanes *)corner[end][0]);
        SC_UNROLL
        for (c = 1; c < 3; c++) {
            const lanes place = places_along((const lanes *)n, (const lanes *)corner[end][c]);
            low = lanes_smaller(low, place);
            high = lanes_larger(high, place);
        }
        lanes_store(to->slab[2 * end], lanes_subtract(low, margin));
        lanes_store(to->slab[2 * end + 1], lanes_add(high, margin));
    }
}

/* The slab of all points, when its direction is known. */
static inline void make_moving_slab(lanes at[2][3], float distance, sc_leaf_motion *to)
{
    lanes n[3];
    float margin[SC_LANES_COUNT];
    int end, k;
    SC_UNROLL
    for (k = 0; k < 3; k++) n[k] = lanes_all(to->direction[k]);
    lanes_store(margin, slab_margin((const lanes *)n, distance));
    SC_UNROLL
    for (end = 0; end < 2; end++) {
        const lanes place = places_along((const lanes *)n, (const lanes *)at[end]);
        to->ends[2 * end] = lanes_least(place) - margin[0];
        to->ends[2 * end + 1] = lanes_most(place) + margin[0];
    }
}

/* Moves the sides of a box outwards by the margin; where swept, after it is made that of both
   ends. */
static inline void grow_moving_box(const sc_motion *m, sc_moving_box *box)
{
    int k;
    for (k = 0; k < 4 && m->swept; k++) {
        const float low = box->low[k + 4], high = box->high[k + 4];
        box->low[k] = box->low[k + 4] = low < box->low[k] ? low : box->low[k];
        box->high[k] = box->high[k + 4] = high > box->high[k] ? high : box->high[k];
    }
    for (k = 0; k < 8; k++) {
        box->low[k] -= m->margin;
        box->high[k] += m->margin;
    }
}

/* The box of some points, as it is compared with points. */
static inline void make_moving_box(const sc_motion *m, const uint32_t *point, int count,
                                   sc_moving_box *box)
{
    float low[8], high[8];
    int i, k;
    memcpy(low, m->unit + 8 * (uint64_t)point[0], sizeof low);
    memcpy(high, low, sizeof high);
    for (i = 1; i < count; i++) {
        const float *x = m->unit + 8 * (uint64_t)point[i];
        for (k = 0; k < 8; k++) {
            low[k] = x[k] < low[k] ? x[k] : low[k];
            high[k] = x[k] > high[k] ? x[k] : high[k];
        }
    }
    memcpy(box->low, low, sizeof low);
    memcpy(box->high, high, sizeof high);
    grow_moving_box(m, box);
}

/* Stores points and their box. Where swept, as a step from the least to the largest of both ends of
   each coordinate: a point is beyond a side of a box that stands still if both of these are. */
static inline void store_points(const sc_motion *m, lanes at[2][3], sc_leaf_motion *to)
{
    int end, k;
    SC_UNROLL
    for (k = 0; k < 3; k++) {
        const lanes start = at[0][k];
        if (m->swept) {
            at[0][k] = lanes_smaller(start, at[1][k]);
            at[1][k] = lanes_larger(start, at[1][k]);
        }
        SC_UNROLL
        for (end = 0; end < 2; end++) {
            lanes_store(to->at[end][k], at[end][k]);
            to->box.low[4 * end + k] = lanes_least(at[end][k]);
            to->box.high[4 * end + k] = lanes_most(at[end][k]);
        }
    }
    to->box.low[3] = to->box.low[7] = to->box.high[3] = to->box.high[7] = 0;
    grow_moving_box(m, &to->box);
}

/* Where swept, slabs are endless, so that nothing is beyond them. */
static SC_NOINLINE void make_leaf_motion(const sc_model *model, const sc_motion *m, uint32_t leaf,
                                         sc_leaf_motion *to)
{
    const uint32_t *point = sc_model_leaf_point(model) + SC_LEAF_POINTS * (uint64_t)leaf;
    const uint8_t *where = sc_model_leaf_corner(model) + 3 * SC_LEAF_MAX * (uint64_t)leaf;
    const uint32_t *first = sc_model_leaf_first(model) + leaf;
    const uint8_t *owned = sc_model_edge_owned(model) + first[0];
    const uint32_t count = first[1] - first[0];
    const float distance = m->swept ? HUGE_VALF : m->distance;
    const float *from[SC_LANES_COUNT];
    lanes at[2][3], corner[2][3][3];
    unsigned sides[3] = {0, 0, 0}; /* that are owned */
    uint32_t i;
    int end, k;
    for (end = 0; end < 2; end++) {
        for (i = 0; i < SC_LANES_COUNT; i++) from[i] = m->unit + 8 * (uint64_t)point[i] + 4 * end;
        lanes_points(from, &at[end][0], &at[end][1], &at[end][2]);
        lanes_corners(at[end], where, corner[end]);
    }
    make_moving_slabs(corner, distance, to);
    make_moving_slab(at, distance, to);
    store_points(m, at, to);
    for (i = 0; i < count; i++)
        for (k = 0; k < 3; k++) sides[k] |= (owned[i] >> k & 1u) << i;
    for (k = 0; k < 3; k++) to->owned[k] = (uint16_t)sides[k];
    to->own = m->own_points[leaf];
    to->triangles = (uint16_t)((1u << count) - 1u);
    to->leaf = leaf;
}

/* The place of a leaf cluster, in which it is when this returns. */
static inline const sc_leaf_motion *leaf_motion(const sc_worker *w, uint32_t leaf)
{
    const sc_kept_motions *kept = &w->step->kept;
    const uint32_t place = leaf & kept->mask;
    sc_leaf_motion *motion = kept->leaves + place;
    if (!kept->made[place] || motion->leaf != leaf) {
        make_leaf_motion(w->model, &w->frame->motion, leaf, motion);
        kept->made[place] = 1;
    }
    return motion;
}

/* That of the second of two, of which the first has been asked for: they may have one place. */
static inline const sc_leaf_motion *other_motion(const sc_worker *w, uint32_t first, uint32_t leaf)
{
    const sc_kept_motions *kept = &w->step->kept;
    if ((first & kept->mask) != (leaf & kept->mask)) return leaf_motion(w, leaf);
    make_leaf_motion(w->model, &w->frame->motion, leaf, kept->own);
    return kept->own;
}
