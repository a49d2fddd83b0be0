/*
 * What is kept of a leaf cluster for tests of its triangles: their boxes, their planes, and a slab
 * that it is in. See query_kernels.h and pose/workspace.h.
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
static inline lanes points_along(const sc_query_state *state, uint32_t leaf,
                                 const float direction[3])
{
    lanes at[3], n[3];
    int k;
    lanes_turned(state->workspace->point_at + 4 * SC_LEAF_POINTS * (uint64_t)leaf, at);
    SC_UNROLL
    for (k = 0; k < 3; k++) n[k] = lanes_all(direction[k]);
    return places_along((const lanes *)n, (const lanes *)at);
}

/* The corners of a leaf cluster's triangles. */
static inline void leaf_corners(const sc_query_state *state, uint32_t leaf, lanes x[3][3])
{
    lanes_corners_at(state->workspace->point_at + 4 * SC_LEAF_POINTS * (uint64_t)leaf,
                     sc_model_leaf_corner(state->model) + 3 * SC_LEAF_MAX * (uint64_t)leaf, x);
}

/* Boxes of the triangles of a leaf cluster, by their corners; what is no triangle is NaN and
   overlaps nothing. */
static inline void make_boxes(lanes x[3][3], uint32_t triangles, sc_leaf_ready *ready)
{
    const lanes ulp = lanes_all(1.1920929e-7f), least = lanes_all(SC_BOXES_LEAST);
    const lanes nothing = lanes_all((float)NAN);
    const lanes_mask is_none = lanes_from(triangles);
    int c;
    SC_UNROLL
    for (c = 0; c < 3; c++) {
        lanes low = lanes_smaller(x[0][c], lanes_smaller(x[1][c], x[2][c]));
        lanes high = lanes_larger(x[0][c], lanes_larger(x[1][c], x[2][c]));
        low = lanes_subtract(low, lanes_add(lanes_multiply(lanes_absolute(low), ulp), least));
        high = lanes_add(high, lanes_add(lanes_multiply(lanes_absolute(high), ulp), least));
        lanes_store(ready->side[c], lanes_choose(is_none, nothing, low));
        lanes_store(ready->side[c + 3], lanes_choose(is_none, nothing, high));
    }
}

/* Their planes. */
static inline void make_normals(lanes x[3][3], sc_leaf_ready *ready)
{
    lanes e[3], f[3], n[3], size, offset;
    int c;
    sides_and_normals(x, e, f, n);
    size = lanes_add(lanes_absolute(e[0]), lanes_absolute(f[0]));
    SC_UNROLL
    for (c = 1; c < 3; c++)
        size = lanes_add(size, lanes_add(lanes_absolute(e[c]), lanes_absolute(f[c])));
    lanes_store(ready->size, size);
    SC_UNROLL
    for (c = 0; c < 3; c++) lanes_store(ready->normal[c], n[c]);
    offset = places_along((const lanes *)n, (const lanes *)x[0]);
    lanes_store(ready->offset, offset);
}

/* Makes a leaf cluster ready, at some place. */
static void make_ready(const sc_query_state *state, uint32_t leaf, uint32_t at)
{
    const uint32_t *first = sc_model_leaf_first(state->model) + leaf;
    sc_workspace *w = state->workspace;
    const sc_boxes *boxes = &w->patch_boxes;
    const uint64_t box = (uint64_t)sc_model_first_leaf_patch(state->model) + leaf;
    float extent = 0;
    lanes x[3][3];
    int c;
    leaf_corners(state, leaf, x);
    make_boxes(x, first[1] - first[0], w->ready + at);
    make_normals(x, w->ready + at);
    SC_UNROLL
    for (c = 0; c < 3; c++) {
        const float length = boxes->side[c + 3][box] - boxes->side[c][box];
        extent = length > extent ? length : extent;
    }
    w->known[at].extent = extent;
    w->known[at].leaf = leaf;
    w->known[at].tick = w->pose_tick;
}

/* Where a leaf cluster is kept; is_upper: it is the upper of the two of a pair. */
static inline uint32_t ready_place(const sc_query_state *state, uint32_t leaf, int is_upper)
{
    const sc_workspace *w = state->workspace;
    return (leaf & w->ready_mask) + (is_upper ? w->ready_upper : 0);
}

/* Whether a leaf cluster is ready; and a leaf cluster that is. */
static inline unsigned is_ready(const sc_query_state *state, uint32_t leaf, int is_upper)
{
    const sc_workspace *w = state->workspace;
    const sc_leaf_known *known = w->known + ready_place(state, leaf, is_upper);
    return (unsigned)(known->leaf == leaf) & (unsigned)(known->tick == w->pose_tick);
}

static inline const sc_leaf_ready *ready_leaf(const sc_query_state *state, uint32_t leaf,
                                              int is_upper)
{
    uint32_t at = ready_place(state, leaf, is_upper);
    if (!is_ready(state, leaf, is_upper)) make_ready(state, leaf, at);
    return state->workspace->ready + at;
}

/* Makes the slab of a leaf cluster that is ready. */
static inline void make_slab(const sc_query_state *state, uint32_t leaf, const sc_leaf_ready *ready)
{
    sc_leaf_slab *slab = state->workspace->slab + leaf;
    float reach;
    lanes along;
    int c;
    for (c = 0; c < 3; c++) slab->direction[c] = lanes_sum(lanes_load(ready->normal[c]));
    reach = slab_reach(slab->direction);
    along = points_along(state, leaf, slab->direction);
    slab->ends[0] = lanes_least(along) - reach;
    slab->ends[1] = lanes_most(along) + reach;
    slab->tick = state->workspace->pose_tick;
}

/* That slab; is_upper as above. */
static inline const sc_leaf_slab *slab_of(const sc_query_state *state, uint32_t leaf, int is_upper)
{
    const sc_leaf_slab *slab = state->workspace->slab + leaf;
    if (slab->tick != state->workspace->pose_tick)
        make_slab(state, leaf, ready_leaf(state, leaf, is_upper));
    return slab;
}

/* Asks for what a leaf cluster is made ready of, and where. */
static inline void fetch_to_make(const sc_query_state *state, uint32_t leaf)
{
    const sc_workspace *w = state->workspace;
    const float *at = w->point_at + 4 * SC_LEAF_POINTS * (uint64_t)leaf;
    const uint8_t *corner = sc_model_leaf_corner(state->model) + 3 * SC_LEAF_MAX * (uint64_t)leaf;
    const float *to = w->ready[leaf].side[0];
    int k;
    SC_UNROLL
    for (k = 0; k < 4; k++) sc_fetch(at + SC_LEAF_POINTS * k);
    sc_fetch(corner);
    SC_UNROLL
    for (k = 0; k < SC_READY_ROWS; k++) sc_fetch(to + SC_LEAF_MAX * k);
}

/* Where all leaf clusters are kept, makes the slabs of so many that have none yet. These are listed
   first, and those of them that are not ready, so that no branch depends on which they are, and
   many are made at the same time. */
static SC_NOINLINE void make_slabs(const sc_query_state *state, const uint32_t *leaf,
                                   uint32_t count)
{
    enum { AHEAD = 4 };
    const sc_workspace *w = state->workspace;
    const uint32_t tick = w->pose_tick;
    uint32_t bare[SC_MADE_LEAVES], unready[SC_MADE_LEAVES], bare_count = 0, unready_count = 0, i;
    for (i = 0; i < count; i++) {
        bare[bare_count] = leaf[i];
        bare_count += w->slab[leaf[i]].tick != tick;
        w->slab[leaf[i]].tick = tick; /* from now on: it may be listed again */
    }
    for (i = 0; i < bare_count; i++) {
        unready[unready_count] = bare[i];
        unready_count += !is_ready(state, bare[i], 0);
    }
    for (i = 0; i < unready_count && i < AHEAD; i++) fetch_to_make(state, unready[i]);
    for (i = 0; i < unready_count; i++) {
        if (i + AHEAD < unready_count) fetch_to_make(state, unready[i + AHEAD]);
        make_ready(state, unready[i], unready[i]);
    }
    for (i = 0; i < bare_count; i++) make_slab(state, bare[i], w->ready + bare[i]);
}

/* Not 0 if all points of a leaf cluster are certainly before a slab, or behind. Without branches,
   as either may be. */
static inline unsigned is_beside(const sc_query_state *state, uint32_t leaf,
                                 const sc_leaf_slab *slab)
{
    lanes along = points_along(state, leaf, slab->direction);
    return (unsigned)(lanes_every(lanes_below(along, lanes_all(slab->ends[0])))) |
           (unsigned)(lanes_every(lanes_below(lanes_all(slab->ends[1]), along)));
}

/* Whether the slab of one of two leaf clusters, a < b, certainly has the other on one side. If they
   share a point, it is in both, to the last bit. */
static inline unsigned slabs_part(const sc_query_state *state, uint32_t a, uint32_t b)
{
    const sc_leaf_slab *of_a = slab_of(state, a, 0), *of_b = slab_of(state, b, 1);
    return is_beside(state, b, of_a) | is_beside(state, a, of_b);
}

/* Bounds the largest extent of two leaf clusters together, or of one, that are ready and whose
   boxes overlap. */
static inline float pair_extent(const sc_query_state *state, uint32_t a, uint32_t b)
{
    const sc_leaf_known *known = state->workspace->known;
    const float extent = known[ready_place(state, a, a > b)].extent;
    return a == b ? extent : extent + known[ready_place(state, b, b > a)].extent;
}
