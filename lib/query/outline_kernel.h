/*
 * Whether a leaf cluster's triangles have nothing in common but what they share, by its outline.
 * See query_kernels.h.
 *
 * SPDX-License-Identifier: MIT
 *
 * All is seen along the mean normal of the cluster, or nearly, in single precision on the points in
 * the unit box. If all triangles face the viewer, so many are over a place as the outline winds
 * round it; and if that is a star, it winds round no place twice and comes to none twice, so that
 * triangles meet in no more than points and edges that they share: see query/star.c, which argues
 * with any set of triangles. So some may be added that are not there: where the outline turns in at
 * a point, the triangle of that and of those before and behind it. Without the point, the outline
 * is that of both.
 *
 * Points at which the outline turns in are dropped, of two that follow each other the first; it is
 * a star if seen from the middle each edge runs counter-clockwise, and once round if one of them
 * comes from below or level with the middle to above. A star does not cease to be one thereby.
 *
 * The directions c that make the two coordinates are any, hence have no error, and so is the
 * middle. With v = 2^-24, let D bound the computed coordinates of points relative to the middle,
 * and C the larger |c|1. A coordinate of a point is off by 3e-8, which is there after the middle is
 * subtracted, and by v D; the one in the plane by 3e-8 C + 1.01 v C D of that, and by rounding 3.01
 * v C D: d <= 3e-8 C + 4.02 v C D in all. It is at most M = 1.01 C D. A product of vectors between
 * points has components up to 2 M, off by e = 2 d + 2.01 v M: moving them changes it by 8 M e + 2
 * e^2, and it is rounded by 16.1 v M^2. With E = d + 2.1 v M <= C (3e-8 + 6.2 v D) that is below 16
 * M E + 8 E^2; and so are products of vectors from the middle. What underflows is within a few
 * FLT_MIN.
 *
 * All signs hold for each place that the points can be at, up to these errors. If they are moved
 * from the computed places to the true ones, every edge goes on running counter-clockwise about the
 * middle, so that they are as often round.
 */

/* Of so many points in a circle, which one is next. */
static const uint8_t next_of[SC_LEAF_POINTS + 1][SC_LANES_COUNT] = {
    {0},
    {0},
    {1, 0},
    {1, 2, 0},
    {1, 2, 3, 0},
    {1, 2, 3, 4, 0},
    {1, 2, 3, 4, 5, 0},
    {1, 2, 3, 4, 5, 6, 0},
    {1, 2, 3, 4, 5, 6, 7, 0},
    {1, 2, 3, 4, 5, 6, 7, 8, 0},
    {1, 2, 3, 4, 5, 6, 7, 8, 9, 0},
    {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 0},
    {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 0},
    {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 0},
    {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 0},
    {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 0},
    {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 0}};

/* The points of a leaf cluster in the plane, relative to some middle. */
typedef struct plane_points {
    lanes at[2];
    float bound; /* what a product of vectors between them, or from the middle, may be off by */
} plane_points;

static inline void see_points(const sc_worker *w, uint32_t leaf, const float direction[3],
                              plane_points *p)
{
    float across[2][3], size[2], most, error;
    lanes at[3], far = lanes_all(0);
    int k;
    lanes_coordinates(w->frame->point_at + 4 * SC_LEAF_POINTS * (uint64_t)leaf, at);
    SC_UNROLL
    for (k = 0; k < 3; k++) {
        at[k] = lanes_subtract(at[k], lanes_all(lanes_sum(at[k]) * (1.0f / SC_LANES_COUNT)));
        far = lanes_larger(far, lanes_absolute(at[k]));
    }
    most = lanes_most(far);
    find_across(direction, across);
    SC_UNROLL
    for (k = 0; k < 2; k++) {
        const float *c = across[k];
        p->at[k] = lanes_add(lanes_add(lanes_multiply(lanes_all(c[0]), at[0]),
                                       lanes_multiply(lanes_all(c[1]), at[1])),
                             lanes_multiply(lanes_all(c[2]), at[2]));
        size[k] = fabsf(c[0]) + fabsf(c[1]) + fabsf(c[2]);
    }
    size[0] = size[0] > size[1] ? size[0] : size[1];
    error = size[0] * sc_bounds_outline(most);
    p->bound = 8 * error * (2.1f * size[0] * most + error) + 16 * FLT_MIN;
}

/* Those of them with these numbers. */
static inline void pick_points(const plane_points *p, lanes_index i, lanes at[2])
{
    at[0] = lanes_pick_of(p->at[0], i);
    at[1] = lanes_pick_of(p->at[1], i);
}

static inline lanes cross(const lanes a[2], const lanes b[2])
{
    return lanes_subtract(lanes_multiply(a[0], b[1]), lanes_multiply(a[1], b[0]));
}

/* Twice the area of triangles, negative if they run clockwise. */
static inline lanes area_of(const lanes a[2], const lanes b[2], const lanes c[2])
{
    lanes ab[2], ac[2];
    int k;
    SC_UNROLL
    for (k = 0; k < 2; k++) {
        ab[k] = lanes_subtract(b[k], a[k]);
        ac[k] = lanes_subtract(c[k], a[k]);
    }
    return cross(ab, ac);
}

/* Whether each of sixteen triangles certainly runs counter-clockwise. */
static inline int all_face(const plane_points *p, const uint8_t *corner)
{
    lanes x[3][2];
    int k;
    SC_UNROLL
    for (k = 0; k < 3; k++) pick_points(p, lanes_index_load(corner + SC_LEAF_MAX * k), x[k]);
    return lanes_every(lanes_below(lanes_all(p->bound), area_of(x[0], x[1], x[2])));
}

/* Whether so many points in a circle, listed from the second on, certainly make a star when some
   are dropped. */
static inline int is_star(const plane_points *p, lanes_bytes second, unsigned count)
{
    const lanes_bytes next = lanes_bytes_load(next_of[count]);
    const lanes_bytes third = lanes_bytes_through(second, next);
    const lanes bound = lanes_all(p->bound), minus_bound = lanes_subtract(lanes_all(0), bound);
    uint8_t number[SC_LANES_COUNT + 4] = {0};
    lanes_bytes kept;
    lanes x[3][2];
    unsigned in, ahead, up;
    pick_points(p, lanes_index_of(second), x[0]);
    pick_points(p, lanes_index_of(third), x[1]);
    pick_points(p, lanes_index_of(lanes_bytes_through(third, next)), x[2]);
    in = lanes_bits(lanes_below(area_of(x[0], x[1], x[2]), minus_bound));
    in &= (1u << count) - 1u;
    in &= ~(in << 1 | in >> (count - 1));
    count = lanes_list(((1u << count) - 1u) & ~in, number);
    kept = lanes_bytes_through(third, lanes_bytes_load(number));
    pick_points(p, lanes_index_of(kept), x[0]);
    pick_points(p, lanes_index_of(lanes_bytes_through(kept, lanes_bytes_load(next_of[count]))),
                x[1]);
    ahead = lanes_bits(lanes_below(bound, cross(x[0], x[1])));
    up = lanes_bits(
        lanes_both(lanes_not_above(x[0][1], lanes_all(0)), lanes_below(lanes_all(0), x[1][1])));
    return !(~ahead & ((1u << count) - 1u)) && sc_bits_count(up & ((1u << count) - 1u)) == 1;
}

/* Whether the triangles of a cluster certainly have nothing in common but what they share. */
static int is_certified(const sc_worker *w, uint32_t leaf)
{
    const sc_model *model = w->model;
    const uint8_t *outline = sc_model_leaf_outline(model) + SC_LEAF_POINTS * (uint64_t)leaf;
    const unsigned last = outline[SC_LEAF_POINTS - 1];
    const unsigned count = last < SC_LEAF_POINTS   ? SC_LEAF_POINTS
                           : last & SC_OUTLINE_TWO ? 0
                                                   : last - SC_LEAF_POINTS;
    plane_points p;
    if (!count) return 0;
    see_points(w, leaf, slab_of(w, leaf, derived_place(w, leaf))->direction, &p);
    return all_face(&p, sc_model_leaf_corner(model) + 3 * SC_LEAF_MAX * (uint64_t)leaf) &&
           is_star(&p,
                   lanes_bytes_through(lanes_bytes_load(outline), lanes_bytes_load(next_of[count])),
                   count);
}
