/*
 * Whether the triangles of a leaf cluster that lie round a point have only in common what they
 * share: for all its points at once, before pairs of neighbors are looked at one by one. See
 * query_kernels.h.
 *
 * SPDX-License-Identifier: MIT
 *
 * All is seen along the mean normal n of the cluster, in single precision on the points in the unit
 * box. A triangle that faces the viewer has at each corner a sector below a half turn. Where the
 * triangles round a point follow each other, one beginning where the one before ends
 * (sc_model.leaf_fan), so do their sectors:
 *
 * - of a fan that is not closed they turn by less than once if there is a ray from the point that
 *   none of them holds, since sectors that turn once or more hold each;
 * - of a closed fan they turn once if there is a ray that just one of them holds.
 *
 * Then two of the sectors meet in the point alone, or, if they follow each other, in the ray
 * between them; so the triangles, none of which has two points in the same place of the projection,
 * meet in no more than the point or the edge that they share. This is so of any triangles, whatever
 * else is at the point.
 *
 * With c at right angles to n, y = c . (x - p) is above 0 on one side of a line through p that the
 * rays r and -r make. A sector that holds r runs from y <= 0 to y >= 0, and one that holds -r from
 * y >= 0 to y <= 0. Two such c give four rays; a sector may hold a ray if these differences may
 * have these signs. So no ray that is held goes unnoticed, and if there are as many sectors that
 * may hold a ray as points where one does, no closed fan turns twice. Lanes behind the last
 * triangle have its corners, and so mark no other points.
 *
 * Each coordinate is off by POINT = 3e-8 at most, v = 2^-24. The difference of two c . x is off by
 * 2 POINT |c|1; by rounding 6.02 v |c|1 and 2.02 v |c|1; and by 2.01 v |c|1, as a component of c is
 * the sum of two: below 6.6e-7 |c|1 in all, and a few FLT_MIN. For an area, n . (e x f), let EDGE =
 * 2 POINT and S = |e|1 + |f|1: moving e and f changes e x f by 2 EDGE S + 6 EDGE^2 in all; it is
 * rounded by 4.01 v |e|1 |f|1 <= 1.01 v S^2, and the product with n by 3.01 v |n| |e x f|1 <= 0.77
 * v |n| S^2, where |n| is the largest component: below |n| (S (2 EDGE + 1.8 v S) + 6 EDGE^2), and a
 * few FLT_MIN.
 */

/* What the difference of two points along a direction across the normal may be off by. */
static inline float ray_bound(const float direction[3])
{
    const float size = fabsf(direction[0]) + fabsf(direction[1]) + fabsf(direction[2]);
    return SC_BOUNDS_RAYS * size + 16 * FLT_MIN;
}

/* Which sectors at the first, second and third corners of triangles may hold a ray, and the
   opposite one: those that the line at right angles to a direction makes. */
static SC_INLINE void find_rays(const float direction[3], const lanes at[3],
                                const lanes_index corner[3], lanes_mask ray[2][3])
{
    const lanes bound = lanes_all(ray_bound(direction));
    const lanes minus_bound = lanes_subtract(lanes_all(0), bound);
    lanes along = lanes_multiply(lanes_all(direction[0]), at[0]), y[3];
    lanes_mask falls[3], rises[3]; /* edges may */
    int k;
    SC_UNROLL
    for (k = 1; k < 3; k++)
        along = lanes_add(along, lanes_multiply(lanes_all(direction[k]), at[k]));
    SC_UNROLL
    for (k = 0; k < 3; k++) y[k] = lanes_pick_of(along, corner[k]);
    SC_UNROLL
    for (k = 0; k < 3; k++) {
        lanes step = lanes_subtract(y[(k + 1) % 3], y[k]);
        falls[k] = lanes_not_above(step, bound);
        rises[k] = lanes_not_above(minus_bound, step);
    }
    SC_UNROLL
    for (k = 0; k < 3; k++) {
        ray[0][k] = lanes_both(falls[k], falls[(k + 2) % 3]);
        ray[1][k] = lanes_both(rises[k], rises[(k + 2) % 3]);
    }
}

/* Two directions at right angles to n, the second counter-clockwise of the first where n points to
   the viewer. */
static inline void find_across(const float n[3], float across[2][3])
{
    int a = fabsf(n[1]) > fabsf(n[0]) ? 1 : 0, i, j;
    float side;
    a = fabsf(n[2]) > fabsf(n[a]) ? 2 : a;
    i = a == 2 ? 0 : a + 1;
    j = 3 - a - i;
    side = n[a] < 0 ? -1.0f : 1.0f;
    across[0][i] = 0.5f * n[a];
    across[0][j] = -n[a];
    across[0][a] = n[j] - 0.5f * n[i];
    across[1][i] = side * n[a];
    across[1][j] = side * (0.5f * n[a]);
    across[1][a] = side * (-n[i] - 0.5f * n[j]);
}

/* What an area may be off by, of triangles of these sizes; largest is the largest component of the
   normal that they are seen along. */
static inline lanes area_bound(lanes size, lanes largest)
{
    const float edge = SC_BOUNDS_EDGE, v = SC_BOUNDS_V;
    lanes bound = lanes_add(lanes_multiply(size, lanes_all(2 * v)), lanes_all(2.1f * edge));
    bound = lanes_add(lanes_multiply(size, bound), lanes_all(7 * edge * edge));
    return lanes_add(lanes_multiply(largest, bound), lanes_all(16 * FLT_MIN));
}

/* The triangles of a cluster that may not face the viewer. */
static inline lanes_mask find_turned(const sc_leaf_derived *derived, const float n[3])
{
    float largest = fabsf(n[0]) > fabsf(n[1]) ? fabsf(n[0]) : fabsf(n[1]);
    lanes area = lanes_multiply(lanes_all(n[0]), lanes_load(derived->normal[0]));
    int k;
    largest = fabsf(n[2]) > largest ? fabsf(n[2]) : largest;
    SC_UNROLL
    for (k = 1; k < 3; k++)
        area = lanes_add(area, lanes_multiply(lanes_all(n[k]), lanes_load(derived->normal[k])));
    return lanes_not_above(area, area_bound(lanes_load(derived->size), lanes_all(largest)));
}

/* The triangles of a cluster that may have more in common with others of it than what they share:
   two that share a point have not, if one of them is no such triangle. If half of them do not face
   the viewer, as of a tube, it is all at once. */
static unsigned doubtful(const sc_worker *w, uint32_t leaf)
{
    const sc_model *model = w->model;
    const uint32_t *first = sc_model_leaf_first(model) + leaf;
    const uint16_t *fan = sc_model_leaf_fan(model) + 2 * (uint64_t)leaf;
    const uint8_t *where = sc_model_leaf_corner(model) + 3 * SC_LEAF_MAX * (uint64_t)leaf;
    const float *n = slab_of(w, leaf, derived_place(w, leaf))->direction;
    const sc_leaf_derived *derived = derived_leaf(w, leaf, derived_place(w, leaf));
    const unsigned triangles = (1u << (first[1] - first[0])) - 1u;
    unsigned held_all = ~0u, turns_once = 0, classified, open, i;
    float across[2][3];
    lanes at[3];
    lanes_index corner[3];
    lanes_mask turned[3], ray[2][2][3];
    int k;
    lanes_coordinates(w->frame->point_at + 4 * SC_LEAF_POINTS * (uint64_t)leaf, at);
    SC_UNROLL
    for (k = 0; k < 3; k++) corner[k] = lanes_index_load(where + SC_LEAF_MAX * k);
    turned[0] = turned[1] = turned[2] = find_turned(derived, n);
    if (sc_bits_count(lanes_bits(turned[0])) >= SC_LEAF_MAX / 2) return triangles;
    find_across(n, across);
    SC_UNROLL
    for (k = 0; k < 2; k++) find_rays(across[k], at, corner, ray[k]);
    SC_UNROLL
    for (i = 0; i < 4; i++) {
        const lanes_mask *r = ray[i / 2][i % 2];
        unsigned held = lanes_marked(corner, r), sectors = 0;
        SC_UNROLL
        for (k = 0; k < 3; k++) sectors += sc_bits_count(lanes_bits(r[k]) & triangles);
        held_all &= held;
        turns_once |= sectors == sc_bits_count(held);
    }
    classified = (fan[1] & ~held_all) | (turns_once ? fan[0] : 0u);
    if (lanes_bits(turned[0])) classified &= ~lanes_marked(corner, turned);
    open = ~classified;
    return (lanes_among(corner[0], open) | lanes_among(corner[1], open) |
            lanes_among(corner[2], open)) &
           triangles;
}
