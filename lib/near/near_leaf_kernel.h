/*
 * The derived data of leaf clusters in a search for what is near: points, boxes and slabs of
 * triangles, and their edges. See near/near_worker.h.
 *
 * SPDX-License-Identifier: MIT
 *
 * Slabs are moved outwards by what query/slab_kernel.h says that places are off by, and by the
 * distance (slab_margin in step/leaf_motion_kernel.h): what is beyond one is farther than the
 * distance from all that is in it.
 */

/* The edges that the triangles of a leaf cluster name. */
static inline void list_own_edges(const uint8_t *owned, uint32_t count, sc_near_leaf *to)
{
    unsigned sides[3] = {0, 0, 0};
    uint32_t edges = 0, i;
    int k;
    memset(to->end, 0, sizeof to->end);
    memset(to->of, 0, sizeof to->of);
    for (i = 0; i < count; i++)
        for (k = 0; k < 3; k++) sides[k] |= (owned[i] >> k & 1u) << i;
    for (k = 0; k < 3; k++) {
        uint8_t number[SC_LANES_COUNT] = {0};
        const uint32_t some = lanes_list(sides[k], number);
        const lanes_bytes numbers = lanes_bytes_load(number);
        const uint8_t *from = to->corner + SC_LEAF_MAX * k;
        const uint8_t *on = to->corner + SC_LEAF_MAX * ((k + 1) % 3);
        lanes_bytes_store(to->end[0] + edges, lanes_bytes_through(lanes_bytes_load(from), numbers));
        lanes_bytes_store(to->end[1] + edges, lanes_bytes_through(lanes_bytes_load(on), numbers));
        lanes_bytes_store(to->of + edges,
                          lanes_bytes_either(numbers, lanes_bytes_all((uint8_t)(SC_LEAF_MAX * k))));
        to->owned[k] = (uint16_t)sides[k];
        edges += some;
    }
    to->edges = (uint16_t)edges;
    lanes_sets_store(to->corners,
                     lanes_sets_join(lanes_sets_join(lanes_sets_of(to->corner),
                                                     lanes_sets_of(to->corner + SC_LEAF_MAX)),
                                     lanes_sets_of(to->corner + 2 * SC_LEAF_MAX)));
    for (i = 0; i < edges; i += SC_LEAF_MAX)
        lanes_sets_store(to->ends + i, lanes_sets_join(lanes_sets_of(to->end[0] + i),
                                                       lanes_sets_of(to->end[1] + i)));
}

static inline void make_near_slabs(const sc_motion *m, lanes at[3], lanes corner[3][3],
                                   sc_near_leaf *to)
{
    lanes e[3], f[3], n[3], low, high, place;
    float margin[SC_LANES_COUNT];
    int c, k;
    sides_and_normals(corner, e, f, n);
    low = high = places_along((const lanes *)n, (const lanes *)corner[0]);
    SC_UNROLL
    for (c = 1; c < 3; c++) {
        place = places_along((const lanes *)n, (const lanes *)corner[c]);
        low = lanes_smaller(low, place);
        high = lanes_larger(high, place);
    }
    place = slab_margin((const lanes *)n, m->distance);
    lanes_store(to->slab[0], lanes_subtract(low, place));
    lanes_store(to->slab[1], lanes_add(high, place));
    SC_UNROLL
    for (k = 0; k < 3; k++) {
        lanes_store(to->normal[k], n[k]);
        to->direction[k] = lanes_sum(n[k]);
    }
    SC_UNROLL
    for (k = 0; k < 3; k++) n[k] = lanes_all(to->direction[k]);
    lanes_store(margin, slab_margin((const lanes *)n, m->distance));
    place = places_along((const lanes *)n, (const lanes *)at);
    to->leaf_slab[0] = lanes_least(place) - margin[0];
    to->leaf_slab[1] = lanes_most(place) + margin[0];
}

static SC_NOINLINE void make_near_leaf(const sc_model *model, const sc_motion *m, uint32_t leaf,
                                       sc_near_leaf *to)
{
    const uint32_t *first = sc_model_leaf_first(model) + leaf;
    const uint32_t count = first[1] - first[0];
    const float *from[SC_LANES_COUNT];
    lanes at[3], corner[3][3], longest = lanes_all(0);
    uint32_t i;
    int k;
    to->point = sc_model_leaf_point(model) + SC_LEAF_POINTS * (uint64_t)leaf;
    to->corner = sc_model_leaf_corner(model) + 3 * SC_LEAF_MAX * (uint64_t)leaf;
    to->face = sc_model_triangle_id(model) + first[0];
    for (i = 0; i < SC_LANES_COUNT; i++) from[i] = m->unit + 8 * (uint64_t)to->point[i];
    lanes_points(from, &at[0], &at[1], &at[2]);
    lanes_corners((const lanes *)at, to->corner, corner);
    SC_UNROLL
    for (k = 0; k < 3; k++) {
        const lanes low = lanes_smaller(lanes_smaller(corner[0][k], corner[1][k]), corner[2][k]);
        const lanes high = lanes_larger(lanes_larger(corner[0][k], corner[1][k]), corner[2][k]);
        longest = lanes_larger(longest, lanes_subtract(high, low));
        lanes_store(to->at[k], at[k]);
        lanes_store(to->side[k], low);
        lanes_store(to->side[3 + k], high);
        to->box[k] = lanes_least(at[k]) - m->margin;
        to->box[3 + k] = lanes_most(at[k]) + m->margin;
    }
    to->extent = lanes_most(longest);
    make_near_slabs(m, at, corner, to);
    to->first = first[0];
    list_own_edges(sc_model_edge_owned(model) + first[0], count, to);
    to->own = m->own_points[leaf];
    to->triangles = (uint16_t)((1u << count) - 1u);
    to->leaf = leaf;
}

/* That of a leaf cluster, which is where this returns. */
static inline const sc_near_leaf *near_leaf(const sc_worker *w, uint32_t leaf)
{
    const sc_near_worker *kept = w->near;
    const uint32_t place = leaf & kept->mask;
    sc_near_leaf *derived = kept->leaves + place;
    if (!kept->made[place] || derived->leaf != leaf) {
        make_near_leaf(w->model, &w->frame->motion, leaf, derived);
        kept->made[place] = 1;
    }
    return derived;
}

/* That of the second of two, of which the first has been asked for: they may have one place. */
static inline const sc_near_leaf *other_near_leaf(const sc_worker *w, uint32_t first, uint32_t leaf)
{
    const sc_near_worker *kept = w->near;
    if ((first & kept->mask) != (leaf & kept->mask)) return near_leaf(w, leaf);
    make_near_leaf(w->model, &w->frame->motion, leaf, kept->own);
    return kept->own;
}
