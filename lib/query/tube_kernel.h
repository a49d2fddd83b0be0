/*
 * Whether the triangles of a leaf cluster that goes round a tube, or of two such that follow each
 * other, have nothing in common but what they share: they are a band round an axis. See
 * query_kernels.h.
 *
 * SPDX-License-Identifier: MIT
 *
 * Points are seen in coordinates u, v and h, along any three directions from any middle, and from
 * there by their angle round the h axis and by h: on a cylinder. The normal of a triangle in these
 * coordinates, times (u, v, 0) of a point on it, is linear along the triangle; where it is above 0
 * at all three corners, the triangle does not meet the axis and has an image on the cylinder that
 * keeps its orientation; where it is below 0 at all of them, one that turns it. So if this is the
 * same for all triangles, so many are over a place of the cylinder, all added with the same sign,
 * as crossing the outline on the way there from far up tells.
 *
 * Let the outline be two chains that run strictly round the axis, in different directions, and let
 * one go round once. So does the other, as there are as few triangles far down as far up: none.
 * Then each is over every angle once. On the way down the number of triangles grows by one at the
 * chain of one direction and falls by one at the other, and it is never below none: so the former
 * is above the latter, or they touch. They do not: near a place of the upper one, all below it is
 * covered, by the triangle of an edge, or by those round a point, which end at no edges but the two
 * of the outline there; and below the lower one nothing is. So one triangle is over each place
 * between them, and none elsewhere, and the outline comes to no place twice. So triangles meet in
 * no more than points and edges that they share: those over a place follow each other round it, as
 * in query/star.c, which looks at what is near one place alone. The middle and the directions are
 * any, hence have no error; where the directions are in one plane, nothing is above 0.
 *
 * Two clusters that share one chain of each, which runs in the other direction in the other cluster
 * (SC_TOUCH_CHAIN), have nothing else in common if both are such bands, round the same axis, and
 * turned to the same side: then chains that run in one direction are the lower ones of both, so
 * that the one they share is the upper one of one cluster and the lower one of the other, and one
 * band is above it and the other below.
 *
 * In single precision on the points in the unit box, v = 2^-24. Let D bound the components of
 * points relative to the middle; the sum of those of a direction is at most 3.01. A coordinate is
 * off by 3.01 times 3e-8 and v D, and by rounding 9.1 v D: d = 9.1e-8 + 12.2 v D; it is at most M =
 * 3.03 D, and so v M <= d / 4.02. A product z of (u, v) of two points is off by 4 M d + 2 d^2, and
 * by rounding 4.02 v M^2: at most Q = d (5.1 M + 2 d). The normal times (u, v, 0) is a difference
 * of two products of a step in h, at most 2.01 M and off by 2.5 d, and of such a z, at most 2.02
 * M^2: each product is off by 2.01 M Q + 5.05 M^2 d + 2.5 d Q and by rounding 1.02 M^2 d, and the
 * difference by 2.05 M^2 d more: less than Q (4.1 M + 5.1 d) + 14.4 M^2 d in all. What underflows
 * is within some FLT_MIN.
 *
 * All this holds for each place that the points can be at, up to these errors. If they are moved
 * from the computed places to the true ones, edges go on running in their direction, so that chains
 * go on running once round.
 */
typedef struct tube {
    float middle[3], direction[3][3]; /* of u, v and h */
    float error, most;                /* of a coordinate: d, M */
} tube;

/* Of points in a box, with an axis that leads along a vector. Returns 0 if that is zero. */
static inline int begin_tube(const float along[3], const float low[3], const float high[3], tube *t)
{
    float length = 0, reach = 0;
    int k;
    for (k = 0; k < 3; k++) {
        const float size = fabsf(along[k]), half = (high[k] - low[k]) / 2;
        t->middle[k] = low[k] + half;
        length = size > length ? size : length;
        reach = half > reach ? half : reach;
    }
    if (!(length > FLT_MIN)) return 0;
    for (k = 0; k < 3; k++) t->direction[2][k] = along[k] / length;
    find_across(t->direction[2], t->direction);
    reach = 1.001f * reach + 1e-6f; /* the middle is nearly that of the box */
    t->error = sc_bounds_tube(reach);
    t->most = 3.04f * reach;
    return 1;
}

static inline void see_tube(const sc_worker *w, uint32_t leaf, const tube *t, lanes at[3])
{
    lanes x[3];
    int k;
    lanes_coordinates(w->frame->point_at + 4 * SC_LEAF_POINTS * (uint64_t)leaf, x);
    SC_UNROLL
    for (k = 0; k < 3; k++) x[k] = lanes_subtract(x[k], lanes_all(t->middle[k]));
    SC_UNROLL
    for (k = 0; k < 3; k++) {
        const float *d = t->direction[k];
        at[k] = lanes_add(
            lanes_add(lanes_multiply(lanes_all(d[0]), x[0]), lanes_multiply(lanes_all(d[1]), x[1])),
            lanes_multiply(lanes_all(d[2]), x[2]));
    }
}

/* Of places of a cluster's outline, which is two chains, those that have some bit. */
static inline unsigned places_with(lanes_bytes outline, uint8_t bit)
{
    const lanes_bytes some = lanes_bytes_all(bit);
    return lanes_bytes_bits(lanes_bytes_same(lanes_bytes_both(outline, some), some));
}

/* Whether the two chains of a cluster's outline certainly run round the axis, the first once, in
   different directions. */
static inline int go_round(const tube *t, const lanes at[3], const uint8_t *row)
{
    const lanes_bytes outline = lanes_bytes_load(row);
    const lanes_index next =
        lanes_index_of(lanes_bytes_both(outline, lanes_bytes_all(SC_LEAF_POINTS - 1)));
    const unsigned second = places_with(outline, SC_OUTLINE_SECOND);
    const unsigned first = ~(second | places_with(outline, SC_OUTLINE_NOWHERE)) & 0xffffu;
    const float bound = t->error * (5.2f * t->most + 2.1f * t->error) + 16 * FLT_MIN;
    const lanes u = lanes_pick_of(at[0], next), v = lanes_pick_of(at[1], next);
    const lanes z = lanes_subtract(lanes_multiply(at[0], v), lanes_multiply(at[1], u));
    const unsigned ahead = lanes_bits(lanes_below(lanes_all(bound), z));
    const unsigned back = lanes_bits(lanes_below(z, lanes_all(-bound)));
    const unsigned up =
        lanes_bits(lanes_both(lanes_not_above(at[1], lanes_all(0)), lanes_below(lanes_all(0), v)));
    const int directed =
        !((first & ~ahead) | (second & ~back)) || !((first & ~back) | (second & ~ahead));
    return directed && sc_bits_count(up & first) == 1;
}

/* To which side the triangles of a cluster are certainly turned, all of them: 1 or 2, or 0 if that
   is not so. */
static inline int side_of_tube(const tube *t, const lanes at[3], const uint8_t *corner)
{
    const float m = t->most, e = t->error, q = e * (5.2f * m + 2.1f * e);
    const float bound = q * (4.2f * m + 5.2f * e) + 14.6f * m * m * e + 100 * FLT_MIN;
    lanes p[3][3], z[3], step[3], least = lanes_all(0), most = least;
    int k;
    lanes_corners(at, corner, p);
    SC_UNROLL
    for (k = 0; k < 3; k++) {
        const lanes *a = p[k], *b = p[(k + 1) % 3];
        z[k] = lanes_subtract(lanes_multiply(a[0], b[1]), lanes_multiply(a[1], b[0]));
        step[k] = lanes_subtract(b[2], a[2]);
    }
    SC_UNROLL
    for (k = 0; k < 3; k++) { /* at corner k */
        const int before = (k + 2) % 3;
        const lanes d =
            lanes_subtract(lanes_multiply(step[k], z[before]), lanes_multiply(step[before], z[k]));
        least = k ? lanes_smaller(least, d) : d;
        most = k ? lanes_larger(most, d) : d;
    }
    if (lanes_every(lanes_below(lanes_all(bound), least))) return 1;
    return lanes_every(lanes_below(most, lanes_all(-bound))) ? 2 : 0;
}

/* To which side a cluster is turned that is a band; 0 if it may be none. */
static inline int side_of_band(const sc_worker *w, uint32_t leaf, const tube *t)
{
    const sc_model *model = w->model;
    lanes at[3];
    see_tube(w, leaf, t, at);
    if (!go_round(t, at, sc_model_leaf_outline(model) + SC_LEAF_POINTS * (uint64_t)leaf)) return 0;
    return side_of_tube(t, at, sc_model_leaf_corner(model) + 3 * SC_LEAF_MAX * (uint64_t)leaf);
}

static inline void find_box(const sc_worker *w, uint32_t leaf, float low[3], float high[3])
{
    const sc_boxes *boxes = &w->frame->patch_boxes;
    const uint64_t i = (uint64_t)sc_model_first_leaf_patch(w->model) + leaf;
    int k;
    SC_UNROLL
    for (k = 0; k < 3; k++) {
        low[k] = boxes->side[k][i];
        high[k] = boxes->side[k + 3][i];
    }
}

/* Whether a leaf cluster goes round a tube, as the model tells. */
static inline int has_two_chains(const sc_model *model, uint32_t leaf)
{
    return sc_model_leaf_outline(model)[SC_LEAF_POINTS * ((uint64_t)leaf + 1) - 1] & SC_OUTLINE_TWO;
}

/* Whether such a cluster certainly is a band. The axis leads from the middle of one chain to that
   of the other, about. */
static int is_band(const sc_worker *w, uint32_t leaf)
{
    static const float weight[SC_LANES_COUNT] = {-1, 1, 0};
    const lanes_bytes outline =
        lanes_bytes_load(sc_model_leaf_outline(w->model) + SC_LEAF_POINTS * (uint64_t)leaf);
    const lanes_bytes second = lanes_bytes_all(SC_OUTLINE_SECOND);
    const lanes_bytes nowhere = lanes_bytes_all(SC_OUTLINE_NOWHERE);
    const lanes_bytes is_second = lanes_bytes_same(lanes_bytes_both(outline, second), second);
    const lanes_bytes is_nowhere = lanes_bytes_same(lanes_bytes_both(outline, nowhere), nowhere);
    const lanes side = lanes_pick(weight, lanes_index_of(lanes_bytes_either(
                                              lanes_bytes_both(is_second, lanes_bytes_all(1)),
                                              lanes_bytes_both(is_nowhere, lanes_bytes_all(2)))));
    float low[3], high[3], along[3];
    tube t;
    lanes x[3];
    int k;
    find_box(w, leaf, low, high);
    lanes_coordinates(w->frame->point_at + 4 * SC_LEAF_POINTS * (uint64_t)leaf, x);
    for (k = 0; k < 3; k++) {
        x[k] = lanes_subtract(x[k], lanes_all((low[k] + high[k]) / 2));
        along[k] = lanes_sum(lanes_multiply(side, x[k]));
    }
    return begin_tube(along, low, high, &t) && side_of_band(w, leaf, &t);
}

/* Whether two of them that share a chain certainly are bands, one above it and the other below. The
   axis leads from the middle of one to that of the other, about. */
static int are_bands(const sc_worker *w, uint32_t a, uint32_t b)
{
    float low[2][3], high[2][3], middle[2][3], along[3];
    tube t;
    int k, s, side;
    find_box(w, a, low[0], high[0]);
    find_box(w, b, low[1], high[1]);
    for (k = 0; k < 3; k++) {
        for (s = 0; s < 2; s++) middle[s][k] = (low[s][k] + high[s][k]) / 2;
        along[k] = middle[1][k] - middle[0][k];
        low[0][k] = low[1][k] < low[0][k] ? low[1][k] : low[0][k];
        high[0][k] = high[1][k] > high[0][k] ? high[1][k] : high[0][k];
    }
    if (!begin_tube(along, low[0], high[0], &t)) return 0;
    side = side_of_band(w, a, &t);
    return side && side_of_band(w, b, &t) == side;
}

/* Of so many pairs of leaf clusters, or one with itself, drops those that go round a tube
   and certainly have nothing in common but what they share; before those of one with itself, the
   others, which are marked as drop_certified does. */
static void drop_bands(sc_worker *w, sc_cluster_pair *pairs, uint32_t count)
{
    uint8_t *marks = w->last.marks + sc_model_first_leaf_patch(w->model);
    uint32_t i;
    int pass;
    for (pass = 0; pass < 2; pass++) {
        for (i = 0; i < count; i++) {
            sc_cluster_pair *p = pairs + i;
            if (!(p->known & SC_TOUCH_CHAIN) || (p->a == p->b) != pass) continue;
            if (pass ? is_band(w, p->a) : are_bands(w, p->a, p->b)) {
                marks[p->a] = marks[p->b] = 1;
                p->known |= SC_CLUSTERS_DROPPED;
            }
        }
    }
}
