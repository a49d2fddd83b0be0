/*
 * The derived data of a leaf cluster: boxes and planes of its triangles, and the slab that it is
 * in, which is the interval of its points along their mean normal. See query_kernels.h and
 * query/kept_leaves.h.
 *
 * SPDX-License-Identifier: MIT
 */
/* Bit k: box i of a overlaps box j + k of b, for k from 0 to 15. */
static inline unsigned overlap(const sc_boxes *a, uint64_t i, const sc_boxes *b, uint64_t j)
{
    lanes_mask m[3];
    int k;
    SC_UNROLL
    for (k = 0; k < 3; k++)
        m[k] =
            lanes_both(lanes_not_above(lanes_all(a->side[k][i]), lanes_load(b->side[k + 3] + j)),
                       lanes_not_above(lanes_load(b->side[k] + j), lanes_all(a->side[k + 3][i])));
    return lanes_bits(lanes_both(m[0], lanes_both(m[1], m[2])));
}

/* Where the points of a leaf cluster are along a direction. */
static inline lanes points_along(const sc_worker *w, uint32_t leaf, const float direction[3])
{
    lanes at[3], n[3];
    int k;
    lanes_coordinates(w->frame->point_at + 4 * SC_LEAF_POINTS * (uint64_t)leaf, at);
    SC_UNROLL
    for (k = 0; k < 3; k++) n[k] = lanes_all(direction[k]);
    return places_along((const lanes *)n, (const lanes *)at);
}

/* The corners of a leaf cluster's triangles. */
static inline void leaf_corners(const sc_worker *w, uint32_t leaf, lanes x[3][3])
{
    lanes_corners_at(w->frame->point_at + 4 * SC_LEAF_POINTS * (uint64_t)leaf,
                     sc_model_leaf_corner(w->model) + 3 * SC_LEAF_MAX * (uint64_t)leaf, x);
}

/* Boxes of the triangles of a leaf cluster, by their corners; what is no triangle is NaN and
   overlaps nothing. */
static inline void make_boxes(lanes x[3][3], uint32_t triangles, sc_leaf_derived *derived)
{
    const lanes ulp = lanes_all(SC_BOUNDS_STEP), least = lanes_all(SC_BOUNDS_STEP_LEAST);
    const lanes nothing = lanes_all((float)NAN);
    const lanes_mask is_none = lanes_from(triangles);
    int c;
    SC_UNROLL
    for (c = 0; c < 3; c++) {
        lanes low = lanes_smaller(x[0][c], lanes_smaller(x[1][c], x[2][c]));
        lanes high = lanes_larger(x[0][c], lanes_larger(x[1][c], x[2][c]));
        low = lanes_subtract(low, lanes_add(lanes_multiply(lanes_absolute(low), ulp), least));
        high = lanes_add(high, lanes_add(lanes_multiply(lanes_absolute(high), ulp), least));
        lanes_store(derived->side[c], lanes_choose(is_none, nothing, low));
        lanes_store(derived->side[c + 3], lanes_choose(is_none, nothing, high));
    }
}

/* Their planes. */
static inline void make_normals(lanes x[3][3], sc_leaf_derived *derived)
{
    lanes e[3], f[3], n[3], size, offset;
    int c;
    sides_and_normals(x, e, f, n);
    size = lanes_add(lanes_absolute(e[0]), lanes_absolute(f[0]));
    SC_UNROLL
    for (c = 1; c < 3; c++)
        size = lanes_add(size, lanes_add(lanes_absolute(e[c]), lanes_absolute(f[c])));
    lanes_store(derived->size, size);
    SC_UNROLL
    for (c = 0; c < 3; c++) lanes_store(derived->normal[c], n[c]);
    offset = places_along((const lanes *)n, (const lanes *)x[0]);
    lanes_store(derived->offset, offset);
}

/* Makes the derived data of a leaf cluster, at some place. */
static void make_derived(const sc_worker *w, uint32_t leaf, uint32_t at)
{
    const uint32_t *first = sc_model_leaf_first(w->model) + leaf;
    const sc_boxes *boxes = &w->frame->patch_boxes;
    const uint64_t box = (uint64_t)sc_model_first_leaf_patch(w->model) + leaf;
    float extent = 0;
    lanes x[3][3];
    int c;
    leaf_corners(w, leaf, x);
    make_boxes(x, first[1] - first[0], w->kept.derived + at);
    make_normals(x, w->kept.derived + at);
    SC_UNROLL
    for (c = 0; c < 3; c++) {
        const float length = boxes->side[c + 3][box] - boxes->side[c][box];
        extent = length > extent ? length : extent;
    }
    w->kept.known[at].extent = extent;
    w->kept.known[at].leaf = leaf;
    w->kept.known[at].epoch = w->frame->epoch;
}

/* Where a leaf cluster is kept, unless another one is looked at with it that is kept there. */
static inline uint32_t derived_place(const sc_worker *w, uint32_t leaf)
{
    return leaf & w->kept.mask;
}

/* Whether that data is at a place; and the data itself, made if it is not. */
static inline unsigned has_derived(const sc_worker *w, uint32_t leaf, uint32_t at)
{
    const sc_leaf_known *known = w->kept.known + at;
    return (unsigned)(known->leaf == leaf) & (unsigned)(known->epoch == w->frame->epoch);
}

static inline const sc_leaf_derived *derived_leaf(const sc_worker *w, uint32_t leaf, uint32_t at)
{
    if (!has_derived(w, leaf, at)) make_derived(w, leaf, at);
    return w->kept.derived + at;
}

/* Makes the slab of a leaf cluster from its derived data. */
static inline void make_slab(const sc_worker *w, uint32_t leaf, const sc_leaf_derived *derived)
{
    sc_leaf_slab *slab = w->kept.slab + leaf;
    float reach;
    lanes along;
    int c;
    for (c = 0; c < 3; c++) slab->direction[c] = lanes_sum(lanes_load(derived->normal[c]));
    reach = slab_reach(slab->direction);
    along = points_along(w, leaf, slab->direction);
    slab->ends[0] = lanes_least(along) - reach;
    slab->ends[1] = lanes_most(along) + reach;
    slab->epoch = w->frame->epoch;
}

/* That slab, made if there is none; the derived data has its place at `at`. */
static inline const sc_leaf_slab *slab_of(const sc_worker *w, uint32_t leaf, uint32_t at)
{
    const sc_leaf_slab *slab = w->kept.slab + leaf;
    if (slab->epoch != w->frame->epoch) make_slab(w, leaf, derived_leaf(w, leaf, at));
    return slab;
}

/* Prefetches what derived data is made of, and where it is written. */
static inline void fetch_to_make(const sc_worker *w, uint32_t leaf)
{
    const float *at = w->frame->point_at + 4 * SC_LEAF_POINTS * (uint64_t)leaf;
    const uint8_t *corner = sc_model_leaf_corner(w->model) + 3 * SC_LEAF_MAX * (uint64_t)leaf;
    const float *to = w->kept.derived[leaf].side[0];
    int k;
    SC_UNROLL
    for (k = 0; k < 4; k++) sc_fetch(at + SC_LEAF_POINTS * k);
    sc_fetch(corner);
    SC_UNROLL
    for (k = 0; k < SC_DERIVED_ROWS; k++) sc_fetch(to + SC_LEAF_MAX * k);
}

/* Where all leaf clusters are kept, makes the slabs of so many, items of lists, that have none yet.
   These are listed first, and those of them without derived data, so that no branch depends on
   which they are, and many are made at the same time. */
static SC_NOINLINE void make_slabs(const sc_worker *w, const uint32_t *items, uint32_t count)
{
    enum { AHEAD = 4 };
    const uint32_t epoch = w->frame->epoch;
    uint32_t bare[SC_MADE_LEAVES], missing[SC_MADE_LEAVES], bare_count = 0, missing_count = 0, i;
    for (i = 0; i < count; i++) {
        const uint32_t leaf = items[i] & SC_ITEM;
        bare[bare_count] = leaf;
        bare_count += w->kept.slab[leaf].epoch != epoch;
        w->kept.slab[leaf].epoch = epoch; /* from now on: it may be listed again */
    }
    for (i = 0; i < bare_count; i++) {
        missing[missing_count] = bare[i];
        missing_count += !has_derived(w, bare[i], bare[i]);
    }
    for (i = 0; i < missing_count && i < AHEAD; i++) fetch_to_make(w, missing[i]);
    for (i = 0; i < missing_count; i++) {
        if (i + AHEAD < missing_count) fetch_to_make(w, missing[i + AHEAD]);
        make_derived(w, missing[i], missing[i]);
    }
    for (i = 0; i < bare_count; i++) make_slab(w, bare[i], w->kept.derived + bare[i]);
}

/* Not 0 if all points of a leaf cluster are certainly before a slab, or behind. Without branches,
   as either may be. */
static inline unsigned is_beside(const sc_worker *w, uint32_t leaf, const sc_leaf_slab *slab)
{
    lanes along = points_along(w, leaf, slab->direction);
    return (unsigned)(lanes_every(lanes_below(along, lanes_all(slab->ends[0])))) |
           (unsigned)(lanes_every(lanes_below(lanes_all(slab->ends[1]), along)));
}

/* Whether the slab of one of two leaf clusters certainly has the other on one side; their derived
   data has its place at at_a and at_b. If they share a point, it is in both, to the last bit. */
static inline unsigned slabs_part(const sc_worker *w, uint32_t a, uint32_t at_a, uint32_t b,
                                  uint32_t at_b)
{
    const sc_worker *v = w->second;
    const sc_leaf_slab *of_a = slab_of(w, a, at_a), *of_b = slab_of(v, b, at_b);
    return is_beside(v, b, of_a) | is_beside(w, a, of_b);
}
