/*
 * What is near of two leaf clusters, or of one: the stages of proximity before the exact one.
 *
 * SPDX-License-Identifier: MIT
 *
 * First, the points, triangles and edges of each cluster are kept that the other's box, and the
 * slab of all its points, do not separate from it. Then come rows: a triangle of one with those
 * points of the other, and an edge with those edges of the other, whose boxes are near. Where the
 * distance is small beside triangles, slabs of triangles strike out most of these: points beyond
 * the slab of the triangle, and edges of which both ends are beyond the slab of the triangle that
 * names the other edge. What rows leave is listed, and its distances are computed sixteen at a time
 * (near/distance_kernel.h).
 *
 * A vertex belongs to the first leaf cluster that has it, an edge to the triangle that names it: so
 * each vertex meets each triangle, and each edge each other edge, in one pair of leaf clusters, or
 * in one with itself. What shares a point is left out. Masks leave out more, and where there are
 * some they are looked at before rows: they and the boxes of what is left strike out most pairs of
 * leaf clusters that are neighbors on the mesh.
 */

/* Slabs of triangles pay where the distance is below this times the extents of triangles. */
#define NEAR_SLABS_PAY 0.16f

/* Pairs that are listed before their distances are computed, and what one row adds. */
enum { NEAR_LISTED = 256, NEAR_ROW = SC_NEAR_EDGES };

/* So many pairs of leaf clusters are fetched before they are looked at, with masks 0.9 of the time:
   of each cluster so many bytes, up to where its slab is. */
enum { NEAR_AHEAD = 16, NEAR_LEAF_FIRST = 448 };

/* Of two leaf clusters: point a and triangle b; or edges a and b, with their ends. */
typedef struct near_list {
    uint32_t count;
    uint8_t a[NEAR_LISTED + NEAR_ROW], b[NEAR_LISTED + NEAR_ROW];
    uint8_t end[4][NEAR_LISTED + NEAR_ROW];
} near_list;

/* One of two leaf clusters. */
typedef struct near_side {
    const sc_near_leaf *leaf;
    unsigned points, triangles;      /* bits of those that are left */
    uint64_t edges;
    unsigned faces, among;           /* what masks leave: triangles with points of the other; and
                                        points that all that is left has its points among */
    unsigned beyond[SC_LEAF_MAX];    /* of slabs of these triangles: points of the other */
    uint16_t shared[SC_LEAF_POINTS]; /* which points of the other each point is, or is so near to on
                                        the mesh that it is not wanted */
} near_side;

/* The boxes of edges, moved outwards by the margin or not. */
typedef struct near_boxes {
    float side[6][SC_NEAR_EDGES];
} near_boxes;

/* What looking at two leaf clusters goes on with. */
typedef struct near_search {
    sc_worker *w;
    near_limits limits;
    near_side a, b;
    float margin;
    uint32_t follows;
    int kinds, names; /* which are wanted, and whether they are wanted by name */
    int asked[2];     /* filters are, of vertices with faces and of edges; or bounds are wanted */
    int between;      /* side a is of one object, side b of another */
    near_measured room, *measured; /* that, if bounds of distances are wanted, or NULL */
    double scale; /* a power of two: of lengths in the unit box to those of the pose, whose inverse
                     may be too large for a double */
} near_search;

/* Points before the low sides of a box, and in the upper half those behind the high ones. */
static inline void beyond_near_box(const sc_near_leaf *p, const float box[6], unsigned beyond[3])
{
    int k;
    SC_UNROLL
    for (k = 0; k < 3; k++) {
        const lanes at = lanes_load(p->at[k]);
        beyond[k] = lanes_bits(lanes_below(at, lanes_all(box[k]))) |
                    lanes_bits(lanes_below(lanes_all(box[3 + k]), at)) << 16;
    }
}

/* The same of a slab. */
static inline unsigned beyond_near_slab(const sc_near_leaf *p, const lanes n[3], float low,
                                        float high)
{
    lanes at[3], place;
    int k;
    SC_UNROLL
    for (k = 0; k < 3; k++) at[k] = lanes_load(p->at[k]);
    place = places_along(n, (const lanes *)at);
    return lanes_bits(lanes_below(place, lanes_all(low))) |
           lanes_bits(lanes_below(lanes_all(high), place)) << 16;
}

static inline unsigned beyond_near_leaf(const sc_near_leaf *p, const sc_near_leaf *a)
{
    lanes n[3];
    int k;
    SC_UNROLL
    for (k = 0; k < 3; k++) n[k] = lanes_all(a->direction[k]);
    return beyond_near_slab(p, (const lanes *)n, a->leaf_slab[0], a->leaf_slab[1]);
}

static inline unsigned beyond_near_face(const sc_near_leaf *p, const sc_near_leaf *a, uint32_t i)
{
    lanes n[3];
    int k;
    SC_UNROLL
    for (k = 0; k < 3; k++) n[k] = lanes_all(a->normal[k][i]);
    return beyond_near_slab(p, (const lanes *)n, a->slab[0][i], a->slab[1][i]);
}

/* Those of some edges that are neither all before one of so many sides nor all behind it. */
static inline uint64_t near_edges_left(const sc_near_leaf *a, uint64_t edges,
                                       const unsigned *beyond, int count)
{
    uint64_t left = 0;
    uint32_t first;
    for (first = 0; edges >> first; first += SC_LEAF_MAX)
        left |= (uint64_t)left_of(lanes_sets_load(a->ends + first), beyond, count) << first;
    return left & edges;
}

/* Those that have both ends among some points. */
static inline uint64_t near_edges_within(const sc_near_leaf *a, uint64_t edges, unsigned points)
{
    uint64_t within = 0;
    uint32_t first;
    for (first = 0; edges >> first; first += SC_LEAF_MAX)
        within |= (uint64_t)lanes_within(lanes_sets_load(a->ends + first), points) << first;
    return within & edges;
}

static inline uint64_t all_near_edges(const sc_near_leaf *a)
{
    return ((uint64_t)1 << a->edges) - 1;
}

/* Leaves of one what the box and the slab of the other do not tell apart from it; 0: nothing. */
static inline int leave_of_near(near_side *a, const sc_near_leaf *other)
{
    unsigned beyond[4];
    beyond_near_box(a->leaf, other->box, beyond);
    beyond[3] = beyond_near_leaf(a->leaf, other);
    a->triangles = left_of(lanes_sets_load(a->leaf->corners), beyond, 4) & a->leaf->triangles;
    if (!a->triangles) return 0;
    a->points = points_left(beyond, 4) & a->leaf->own;
    a->edges = near_edges_left(a->leaf, all_near_edges(a->leaf), beyond, 4);
    return 1;
}

/* The same by masks of points that are near on the mesh; NULL: none is. */
static inline void take_near_masks(const sc_leaf_mask *mask, near_side *a, near_side *b)
{
    if (mask) {
        memcpy(a->shared, mask->near[0], sizeof a->shared);
        memcpy(b->shared, mask->near[1], sizeof b->shared);
    } else {
        memset(a->shared, 0, sizeof a->shared);
        memset(b->shared, 0, sizeof b->shared);
    }
}

/* The points of triangles that are left. */
static inline unsigned corners_of_near(const near_side *a)
{
    return lanes_sets_all(lanes_sets_load(a->leaf->corners), a->triangles);
}

/* Leaves of one only what has all its points among some; triangles stay, as sides of theirs may. */
static inline void leave_within(near_side *a, unsigned points)
{
    a->among = points;
    a->points &= points;
    a->faces &= lanes_within(lanes_sets_load(a->leaf->corners), points);
    a->edges = near_edges_within(a->leaf, a->edges, points);
}

/* Leaves of two leaf clusters what masks leave some of the other of; 0: nothing. A pair is wanted
   only if no point of the one is near on the mesh to one of the other. So a point goes that is near
   to all that the other may still have, and with it what has that point. */
static inline int leave_by_masks(near_side *a, near_side *b)
{
    const lanes_sets shared = lanes_sets_load(a->shared), other = lanes_sets_load(b->shared);
    const unsigned first = a->among & ~lanes_holding(shared, b->among);
    leave_within(b, b->among & ~lanes_holding(other, first));
    leave_within(a, first & ~lanes_holding(shared, b->among));
    return (a->points && b->faces) || (b->points && a->faces) || (a->edges && b->edges);
}

/* The box of some points, moved outwards by a margin. */
static inline void box_of_near(const sc_near_leaf *a, unsigned points, float margin, float box[6])
{
    uint8_t number[2 * SC_LANES_COUNT];
    const uint32_t count = lanes_list(points, number);
    lanes_index some;
    int k;
    lanes_bytes_store(number + count, lanes_bytes_all(number[0]));
    some = lanes_index_load(number);
    SC_UNROLL
    for (k = 0; k < 3; k++) {
        const lanes at = lanes_pick(a->at[k], some);
        box[k] = lanes_least(at) - margin;
        box[3 + k] = lanes_most(at) + margin;
    }
}

/* Leaves of what is left of one what a box does not tell apart from it. */
static inline void leave_by_box(near_side *a, const float box[6])
{
    unsigned beyond[3];
    beyond_near_box(a->leaf, box, beyond);
    a->triangles &= left_of(lanes_sets_load(a->leaf->corners), beyond, 3);
    a->faces &= a->triangles;
    a->among &= corners_of_near(a);
    a->points &= points_left(beyond, 3);
    a->edges = near_edges_left(a->leaf, a->edges, beyond, 3);
}

/* Leaves what masks leave; then what the boxes of the rest leave, and of that what masks leave. */
static inline int leave_by_masks_and_boxes(near_side *a, near_side *b, float margin)
{
    float box[2][6];
    a->among = corners_of_near(a);
    b->among = corners_of_near(b);
    if (!leave_by_masks(a, b)) return 0;
    box_of_near(a->leaf, a->among, margin, box[0]);
    box_of_near(b->leaf, b->among, margin, box[1]);
    leave_by_box(a, box[1]);
    leave_by_box(b, box[0]);
    return leave_by_masks(a, b);
}

/* Finds which points of two leaf clusters are the same. */
static inline void find_near_shared(near_side *a, near_side *b)
{
    const lanes_bytes name = lanes_names(a->leaf->point, b->leaf->point);
    unsigned some = ~lanes_bytes_bits(lanes_bytes_same(name, lanes_bytes_all(255))) & 0xffffu;
    uint8_t number[SC_LANES_COUNT];
    memset(a->shared, 0, sizeof a->shared);
    memset(b->shared, 0, sizeof b->shared);
    if (!some) return;
    lanes_bytes_store(number, name);
    for (; some; some &= some - 1) {
        const uint32_t j = sc_bits_lowest(some), i = number[j];
        a->shared[i] = (uint16_t)(a->shared[i] | 1u << j);
        b->shared[j] = (uint16_t)(1u << i);
    }
}

/* ---- what is found ---- */

/* At most the distance of the pair in lane i of what was measured last, if bounds are wanted. */
static inline double bound_of_near(const near_search *s, uint32_t i)
{
    return s->measured ? near_bound(s->measured, i, &s->limits) / s->scale : 0;
}

/* Pairs that are near or, in the upper half, far; the rest is left to exact signs. */
static inline void take_near_faces(near_search *s, const near_side *p, const near_side *f,
                                   const near_list *list, uint32_t at, unsigned judged,
                                   unsigned wanted)
{
    sc_lists *l = &s->w->lists;
    const uint32_t turned = s->between && p == &s->b ? SC_STEP_TURNED : 0;
    unsigned near = judged & wanted, open = ~(judged | judged >> 16) & wanted;
    sc_pair some[SC_LANES_COUNT];
    if (!s->names) {
        s->w->step->count[SC_STEP_VERTEX_FACE] += sc_bits_count(near);
        s->w->step->turned += turned ? sc_bits_count(near) : 0;
        near = 0;
    }
    for (; near && s->asked[0]; near &= near - 1) {
        const uint32_t lane = sc_bits_lowest(near), i = at + lane;
        sc_pair inner;
        inner.a = p->leaf->point[list->a[i]] | turned;
        inner.b = f->leaf->first + list->b[i];
        sc_near_candidates_take(s->w, SC_STEP_VERTEX_FACE, inner, bound_of_near(s, lane));
    }
    if (near) {
        const uint32_t count = sc_bits_count(near);
        sc_pair *const to = sc_step_pairs_place(s->w, SC_STEP_VERTEX_FACE, count, some), *pair = to;
        for (; near; near &= near - 1, pair++) {
            const uint32_t i = at + sc_bits_lowest(near);
            pair->a = p->leaf->point[list->a[i]] | turned;
            pair->b = f->leaf->face[list->b[i]];
        }
        sc_step_pairs_take_all(s->w, SC_STEP_VERTEX_FACE, to, count, some);
    }
    for (; open; open &= open - 1) {
        const uint32_t i = at + sc_bits_lowest(open);
        sc_pair *to = &l->moving[0][l->count[SC_LIST_FACES]++];
        to->a = p->leaf->point[list->a[i]] | turned;
        to->b = f->leaf->first + list->b[i];
    }
}

/* An edge by its place, and in the caller's numbers. */
static inline uint32_t inner_near_edge(const sc_near_leaf *a, uint32_t edge)
{
    const uint32_t of = a->of[edge];
    return 3 * (a->first + of % SC_LEAF_MAX) + of / SC_LEAF_MAX;
}

static inline uint32_t name_near_edge(const sc_near_leaf *a, uint32_t edge)
{
    const uint32_t of = a->of[edge];
    return 3 * a->face[of % SC_LEAF_MAX] + of / SC_LEAF_MAX;
}

static inline void take_near_edges(near_search *s, const near_list *list, uint32_t at,
                                   unsigned judged, unsigned wanted)
{
    const sc_near_leaf *a = s->a.leaf, *b = s->b.leaf;
    sc_lists *l = &s->w->lists;
    unsigned near = judged & wanted, open = ~(judged | judged >> 16) & wanted;
    sc_pair some[SC_LANES_COUNT];
    if (!s->names) {
        s->w->step->count[SC_STEP_EDGE_EDGE] += sc_bits_count(near);
        near = 0;
    }
    for (; near && s->asked[1]; near &= near - 1) {
        const uint32_t lane = sc_bits_lowest(near), i = at + lane;
        sc_pair inner;
        inner.a = inner_near_edge(a, list->a[i]);
        inner.b = inner_near_edge(b, list->b[i]);
        sc_near_candidates_take(s->w, SC_STEP_EDGE_EDGE, inner, bound_of_near(s, lane));
    }
    if (near) {
        const uint32_t count = sc_bits_count(near);
        sc_pair *const to = sc_step_pairs_place(s->w, SC_STEP_EDGE_EDGE, count, some), *pair = to;
        for (; near; near &= near - 1, pair++) {
            const uint32_t i = at + sc_bits_lowest(near);
            const uint32_t one = name_near_edge(a, list->a[i]);
            const uint32_t other = name_near_edge(b, list->b[i]);
            pair->a = one < other || s->between ? one : other;
            pair->b = one < other || s->between ? other : one;
        }
        sc_step_pairs_take_all(s->w, SC_STEP_EDGE_EDGE, to, count, some);
    }
    for (; open; open &= open - 1) {
        const uint32_t i = at + sc_bits_lowest(open);
        sc_pair *to = &l->moving[1][l->count[SC_LIST_EDGES]++];
        to->a = inner_near_edge(a, list->a[i]);
        to->b = inner_near_edge(b, list->b[i]);
    }
}

/* ---- distances ---- */

static inline void decide_near_faces(near_search *s, const near_side *p, const near_side *f,
                                     near_list *list)
{
    const uint32_t count = list->count;
    uint32_t i;
    int k;
    sc_worker_count_primitives(s->w, s->follows, count);
    memset(list->a + count, 0, SC_LANES_COUNT);
    memset(list->b + count, 0, SC_LANES_COUNT);
    for (i = 0; i < count; i += SC_LANES_COUNT) {
        const unsigned wanted = count - i < SC_LANES_COUNT ? (1u << (count - i)) - 1u : 0xffffu;
        const lanes_index point = lanes_index_load(list->a + i);
        const lanes_index a = lanes_index_through(f->leaf->corner, list->b + i);
        const lanes_index b = lanes_index_through(f->leaf->corner + SC_LEAF_MAX, list->b + i);
        const lanes_index c = lanes_index_through(f->leaf->corner + 2 * SC_LEAF_MAX, list->b + i);
        lanes v[3], e[3], g[3];
        SC_UNROLL
        for (k = 0; k < 3; k++) {
            const lanes from = lanes_pick(f->leaf->at[k], a);
            v[k] = lanes_subtract(lanes_pick(p->leaf->at[k], point), from);
            e[k] = lanes_subtract(lanes_pick(f->leaf->at[k], b), from);
            g[k] = lanes_subtract(lanes_pick(f->leaf->at[k], c), from);
        }
        take_near_faces(s, p, f, list, i,
                        judge_faces((const lanes *)v, (const lanes *)e, (const lanes *)g,
                                    &s->limits, s->measured),
                        wanted);
    }
    list->count = 0;
}

/* Those of whole sixteens, or all; what is left moves to the front. */
static inline void decide_near_edges(near_search *s, near_list *list, int all)
{
    const uint32_t count = all ? list->count : list->count & ~(uint32_t)(SC_LANES_COUNT - 1);
    const float(*at)[SC_LEAF_POINTS] = s->a.leaf->at, (*other)[SC_LEAF_POINTS] = s->b.leaf->at;
    uint32_t i;
    int k;
    sc_worker_count_primitives(s->w, s->follows, count);
    if (all)
        for (k = 0; k < 4; k++) memset(list->end[k] + count, 0, SC_LANES_COUNT);
    for (i = 0; i < count; i += SC_LANES_COUNT) {
        const unsigned wanted = count - i < SC_LANES_COUNT ? (1u << (count - i)) - 1u : 0xffffu;
        lanes_index end[4];
        lanes v[3], e[3], f[3];
        for (k = 0; k < 4; k++) end[k] = lanes_index_load(list->end[k] + i);
        SC_UNROLL
        for (k = 0; k < 3; k++) {
            const lanes from = lanes_pick(at[k], end[0]), to = lanes_pick(other[k], end[2]);
            v[k] = lanes_subtract(from, to);
            e[k] = lanes_subtract(lanes_pick(at[k], end[1]), from);
            f[k] = lanes_subtract(lanes_pick(other[k], end[3]), to);
        }
        take_near_edges(s, list, i,
                        judge_edges((const lanes *)v, (const lanes *)e, (const lanes *)f,
                                    &s->limits, s->measured),
                        wanted);
    }
    list->count -= count;
    if (all) return;
    lanes_bytes_store(list->a, lanes_bytes_load(list->a + count));
    lanes_bytes_store(list->b, lanes_bytes_load(list->b + count));
    for (k = 0; k < 4; k++)
        lanes_bytes_store(list->end[k], lanes_bytes_load(list->end[k] + count));
}

/* ---- rows ---- */

/* Triangles of f with points of p. */
static inline uint32_t compare_near_faces(near_search *s, const near_side *p, const near_side *f,
                                          int slabs)
{
    near_list list;
    const lanes margin = lanes_all(s->margin);
    unsigned some = f->triangles & f->faces;
    uint32_t rows = sc_bits_count(some);
    int k;
    list.count = 0;
    if (!p->points) return 0;
    for (; some; some &= some - 1) {
        const uint32_t i = sc_bits_lowest(some);
        unsigned points = p->points;
        lanes_mask near[3];
        for (k = 0; k < 3; k++)
            points &= ~(unsigned)f->shared[f->leaf->corner[SC_LEAF_MAX * k + (int)i]];
        if (slabs) points &= ~(f->beyond[i] | f->beyond[i] >> 16);
        if (!points) continue;
        SC_UNROLL
        for (k = 0; k < 3; k++)
            near[k] = lanes_both(
                lanes_not_above(lanes_subtract(lanes_all(f->leaf->side[k][i]), margin),
                                lanes_load(p->leaf->at[k])),
                lanes_not_above(lanes_load(p->leaf->at[k]),
                                lanes_add(lanes_all(f->leaf->side[3 + k][i]), margin)));
        points &= lanes_bits(lanes_both(lanes_both(near[0], near[1]), near[2]));
        if (!points) continue;
        lanes_bytes_store(list.b + list.count, lanes_bytes_all((uint8_t)i));
        list.count += lanes_list(points, list.a + list.count);
    }
    if (list.count) decide_near_faces(s, p, f, &list);
    return rows;
}

/* Boxes of edges, moved outwards by a margin. */
static inline void make_near_boxes(const sc_near_leaf *a, float margin, near_boxes *to)
{
    const lanes out = lanes_all(margin);
    uint32_t i;
    int k;
    for (i = 0; i < a->edges; i += SC_LEAF_MAX) {
        const lanes_index first = lanes_index_load(a->end[0] + i);
        const lanes_index second = lanes_index_load(a->end[1] + i);
        SC_UNROLL
        for (k = 0; k < 3; k++) {
            const lanes p = lanes_pick(a->at[k], first), q = lanes_pick(a->at[k], second);
            lanes_store(to->side[k] + i, lanes_subtract(lanes_smaller(p, q), out));
            lanes_store(to->side[3 + k] + i, lanes_add(lanes_larger(p, q), out));
        }
    }
}

/* Leaves those triangles of two leaf clusters of which slabs do not tell all of the other's apart,
   and notes what is beyond slabs; 0: nothing. */
static inline int leave_by_slabs(near_side *a, near_side *b)
{
    const lanes_sets corners = lanes_sets_load(b->leaf->corners);
    const lanes_sets others = lanes_sets_load(a->leaf->corners);
    unsigned faces_a = 0, faces_b = 0, some;
    for (some = a->triangles; some; some &= some - 1) {
        const uint32_t i = sc_bits_lowest(some);
        unsigned left;
        a->beyond[i] = beyond_near_face(b->leaf, a->leaf, i);
        left = left_of(corners, &a->beyond[i], 1) & b->triangles;
        faces_a |= (unsigned)(left != 0) << i;
        faces_b |= left;
    }
    a->triangles = faces_a;
    b->triangles = 0;
    for (some = faces_b; some; some &= some - 1) {
        const uint32_t i = sc_bits_lowest(some);
        b->beyond[i] = beyond_near_face(a->leaf, b->leaf, i);
        b->triangles |= (unsigned)((left_of(others, &b->beyond[i], 1) & faces_a) != 0) << i;
    }
    return b->triangles != 0;
}

/* The edges that a triangle names. */
static inline uint64_t near_edges_of(const sc_near_leaf *a, uint32_t i)
{
    uint64_t edges = 0;
    uint32_t first = 0;
    int k;
    SC_UNROLL
    for (k = 0; k < 3; k++) {
        const unsigned owned = a->owned[k];
        edges |= (uint64_t)(owned >> i & 1) << (first + sc_bits_count(owned & ((1u << i) - 1)));
        first += sc_bits_count(owned);
    }
    return edges;
}

/* Of each edge of a those of b that slabs of triangles leave; returns those of a that have some. */
static inline uint64_t compare_near_slabs(const near_side *a, const near_side *b,
                                          uint64_t allowed[SC_NEAR_EDGES])
{
    uint64_t by_slab[SC_LEAF_MAX], edges, left = 0;
    unsigned some;
    for (edges = a->edges; edges; edges &= edges - 1) {
        const uint32_t e = sc_bits_lowest64(edges);
        by_slab[a->leaf->of[e] % SC_LEAF_MAX] = allowed[e] = 0;
    }
    for (some = a->triangles; some; some &= some - 1) {
        const uint32_t i = sc_bits_lowest(some);
        by_slab[i] = near_edges_left(b->leaf, b->edges, &a->beyond[i], 1);
    }
    for (some = b->triangles; some; some &= some - 1) {
        const uint32_t j = sc_bits_lowest(some);
        const uint64_t own = near_edges_of(b->leaf, j) & b->edges;
        if (!own) continue;
        edges = near_edges_left(a->leaf, a->edges, &b->beyond[j], 1);
        for (; edges; edges &= edges - 1) {
            const uint32_t e = sc_bits_lowest64(edges);
            allowed[e] |= own & by_slab[a->leaf->of[e] % SC_LEAF_MAX];
            left |= (uint64_t)(allowed[e] != 0) << e;
        }
    }
    return left;
}

/* Lists edge e of a with those of b in a mask. */
static inline void list_near_edges(const near_search *s, uint32_t e, uint64_t mask, near_list *list)
{
    const sc_near_leaf *a = s->a.leaf, *b = s->b.leaf;
    uint32_t first;
    for (first = 0; mask >> first; first += SC_LEAF_MAX) {
        const unsigned some = (unsigned)(mask >> first) & 0xffffu;
        const uint32_t at = list->count;
        lanes_bytes numbers;
        uint8_t number[SC_LANES_COUNT] = {0};
        if (!some) continue;
        list->count += lanes_list(some, number);
        numbers = lanes_bytes_load(number);
        lanes_bytes_store(list->end[0] + at, lanes_bytes_all(a->end[0][e]));
        lanes_bytes_store(list->end[1] + at, lanes_bytes_all(a->end[1][e]));
        lanes_bytes_store(list->end[2] + at,
                          lanes_bytes_through(lanes_bytes_load(b->end[0] + first), numbers));
        lanes_bytes_store(list->end[3] + at,
                          lanes_bytes_through(lanes_bytes_load(b->end[1] + first), numbers));
        lanes_bytes_store(list->a + at, lanes_bytes_all((uint8_t)e));
        lanes_bytes_store(list->b + at,
                          lanes_bytes_either(numbers, lanes_bytes_all((uint8_t)first)));
    }
}

/* Edges with edges; of one leaf cluster with itself, with those behind. */
static inline uint32_t compare_near_edges(near_search *s, int itself, int slabs)
{
    const near_side *a = &s->a, *b = &s->b;
    near_boxes around, boxes;
    near_list list;
    uint64_t allowed[SC_NEAR_EDGES], some = b->edges ? a->edges : 0;
    uint32_t rows = 0, i;
    int k;
    list.count = 0;
    if (slabs) some = compare_near_slabs(a, b, allowed);
    if (!some) return 0;
    make_near_boxes(a->leaf, s->margin, &around);
    make_near_boxes(b->leaf, 0, &boxes);
    for (; some; some &= some - 1) {
        const uint32_t e = sc_bits_lowest64(some);
        const unsigned shared =
            a->shared[a->leaf->end[0][e]] | (unsigned)a->shared[a->leaf->end[1][e]];
        uint64_t others = slabs ? allowed[e] : b->edges, near = 0;
        if (itself) others &= ~(uint64_t)0 << e << 1;
        for (i = 0; shared && others >> i; i += SC_LEAF_MAX) {
            const unsigned apart =
                lanes_within(lanes_sets_load(b->leaf->ends + i), ~shared & 0xffffu);
            others &= ~((uint64_t)(~apart & 0xffffu) << i);
        }
        if (!others) continue;
        rows++;
        for (i = 0; others >> i; i += SC_LEAF_MAX) {
            lanes_mask apart[3];
            unsigned mask;
            SC_UNROLL
            for (k = 0; k < 3; k++)
                apart[k] = lanes_both(
                    lanes_not_above(lanes_load(boxes.side[k] + i),
                                    lanes_all(around.side[3 + k][e])),
                    lanes_not_above(lanes_all(around.side[k][e]),
                                    lanes_load(boxes.side[3 + k] + i)));
            mask = lanes_bits(lanes_both(lanes_both(apart[0], apart[1]), apart[2]));
            near |= (uint64_t)mask << i;
        }
        near &= others;
        if (!near) continue;
        list_near_edges(s, e, near, &list);
        if (list.count >= NEAR_LISTED - SC_LANES_COUNT) decide_near_edges(s, &list, 0);
    }
    if (list.count) decide_near_edges(s, &list, 1);
    return rows;
}

/* ---- stages ---- */

static inline void begin_near_search(near_search *s, sc_worker *w)
{
    const sc_near_options *o = &w->question->near->options;
    s->w = w;
    s->margin = w->frame->motion.margin;
    s->kinds = o->kinds == SC_NEAR_BOTH ? SC_NEAR_VERTEX_FACE | SC_NEAR_EDGE_EDGE : (int)o->kinds;
    s->asked[0] = sc_near_candidates_are_asked(w, SC_STEP_VERTEX_FACE);
    s->asked[1] = sc_near_candidates_are_asked(w, SC_STEP_EDGE_EDGE);
    s->between = sc_worker_is_between(w);
    s->names = sc_near_candidates_want_names(w->question);
    s->measured = w->question->near->bounds ? &s->room : NULL;
    s->scale = w->frame->scale;
}

static inline void begin_near_pair(near_search *s, uint32_t item, const sc_near_leaf *a,
                                   const sc_near_leaf *b)
{
    const double distance = s->w->question->near->options.distance * s->w->frame->scale;
    s->follows = sc_item_follows(item);
    s->a.leaf = a;
    s->b.leaf = b;
    /* nothing in the unit box is farther apart than 4 */
    s->limits = near_limits_for(distance < 8 ? distance : 8, (double)a->extent + (double)b->extent);
}

/* Whether there is room for all of two leaf clusters that may be left open. */
static inline int have_room_for_near(const sc_worker *w)
{
    return w->lists.count[SC_LIST_FACES] < SC_MOVING_ENOUGH &&
           w->lists.count[SC_LIST_EDGES] < SC_MOVING_ENOUGH && !w->stop;
}

/* What is near of two leaf clusters; masks: of points that are near on the mesh, or NULL: these are
   the points that they share, of which two objects have none. */
static inline uint32_t compare_near_pair(near_search *s, const sc_near_leaf *a,
                                         const sc_near_leaf *b, const sc_near_masks *masks,
                                         const sc_leaf_mask *mask)
{
    uint32_t rows = 2;
    int slabs;
    if (!leave_of_near(&s->a, b) || !leave_of_near(&s->b, a)) return rows;
    if (masks || s->between)
        take_near_masks(mask, &s->a, &s->b);
    else
        find_near_shared(&s->a, &s->b);
    s->a.faces = s->b.faces = 0xffffu;
    if (mask && !leave_by_masks_and_boxes(&s->a, &s->b, s->margin)) return rows;
    slabs = s->w->frame->motion.distance < NEAR_SLABS_PAY * (a->extent + b->extent);
    if (slabs && !leave_by_slabs(&s->a, &s->b)) return rows;
    if (s->kinds & SC_NEAR_VERTEX_FACE) {
        rows += compare_near_faces(s, &s->a, &s->b, slabs);
        rows += compare_near_faces(s, &s->b, &s->a, slabs);
    }
    if (s->kinds & SC_NEAR_EDGE_EDGE) rows += compare_near_edges(s, 0, slabs);
    return rows;
}

/* Two leaf clusters that are looked at soon, and their mask. */
typedef struct near_coming {
    uint32_t one, other, known;
    int leaves;
    const sc_leaf_mask *mask;
} near_coming;

/* Fetches what of a leaf cluster is looked at first. */
static inline void fetch_near_leaf(const sc_worker *w, uint32_t leaf)
{
    const sc_near_leaf *a = w->near->leaves + (leaf & w->near->mask);
    const char *from = (const char *)a;
    uint32_t at;
    for (at = 0; at < NEAR_LEAF_FIRST; at += 64) sc_fetch(from + at);
}

/* The next leaf clusters of the list, in their order, so that bounds of distances do not depend on
   who listed them. */
static inline void look_ahead_of_near(const sc_worker *w, uint32_t count, near_coming *coming)
{
    const sc_near_masks *masks = w->question->near->options.masks;
    const sc_cluster_pair *p = w->lists.clusters + w->lists.count[SC_LIST_CLUSTERS];
    uint32_t i;
    for (i = 0; i < count; i++) {
        near_coming *c = &coming[i];
        --p;
        c->one = p->a < p->b ? p->a : p->b;
        c->other = p->a < p->b ? p->b : p->a;
        c->known = p->known;
        c->leaves = 1;
        c->mask = masks ? sc_masks_find(masks, c->one, c->other, &c->leaves) : NULL;
        if (c->mask) sc_fetch(c->mask);
        fetch_near_leaf(w, c->one);
        fetch_near_leaf(w, c->other);
    }
}

static void decide_near_clusters(sc_worker *w, uint32_t most)
{
    const sc_near_masks *masks = w->question->near->options.masks;
    uint32_t *left = &w->lists.count[SC_LIST_CLUSTERS], coming = 0, at = 0;
    near_coming next[NEAR_AHEAD];
    near_search s;
    begin_near_search(&s, w);
    for (; most && *left && have_room_for_near(w); most--) {
        const near_coming *p;
        const sc_near_leaf *a, *b;
        if (at == coming) {
            coming = *left < NEAR_AHEAD ? *left : NEAR_AHEAD;
            look_ahead_of_near(w, coming, next);
            at = 0;
        }
        p = &next[at++];
        --*left;
        if (!p->leaves) continue;
        a = near_leaf(w, p->one);
        b = other_near_leaf(w, p->one, p->other);
        begin_near_pair(&s, p->known, a, b);
        sc_worker_count_boxes(w, s.follows, compare_near_pair(&s, a, b, masks, p->mask));
    }
}

/* The same of leaf clusters of two objects. */
static void decide_near_between(sc_worker *w, uint32_t most)
{
    uint32_t *left = &w->lists.count[SC_LIST_CLUSTERS];
    near_search s;
    begin_near_search(&s, w);
    for (; most && *left && have_room_for_near(w); most--) {
        const sc_cluster_pair p = w->lists.clusters[--*left];
        const sc_near_leaf *a = near_leaf(w, p.a), *b = near_leaf(w->second, p.b);
        begin_near_pair(&s, p.known, a, b);
        sc_worker_count_boxes(w, s.follows, compare_near_pair(&s, a, b, NULL, NULL));
    }
}

static void decide_near_alone(sc_worker *w, uint32_t most)
{
    const sc_near_masks *masks = w->question->near->options.masks;
    uint32_t *left = &w->lists.count[SC_LIST_NEAR];
    near_search s;
    begin_near_search(&s, w);
    for (; most && *left && have_room_for_near(w); most--) {
        const uint32_t item = w->lists.near[0][--*left];
        const uint32_t leaf = item & SC_ITEM;
        const sc_leaf_mask *mask = NULL;
        const sc_near_leaf *a;
        uint32_t rows = 0, i;
        int leaves = 1;
        if (masks) mask = sc_masks_find(masks, leaf, leaf, &leaves);
        if (!leaves) continue;
        a = near_leaf(w, leaf);
        begin_near_pair(&s, item, a, a);
        s.a.points = a->own;
        s.a.triangles = a->triangles;
        s.a.faces = 0xffffu;
        s.a.edges = all_near_edges(a);
        for (i = 0; i < SC_LEAF_POINTS; i++)
            s.a.shared[i] = (uint16_t)(mask ? mask->near[0][i] : 1u << i);
        s.b = s.a;
        if (s.kinds & SC_NEAR_VERTEX_FACE) rows += compare_near_faces(&s, &s.a, &s.b, 0);
        if (s.kinds & SC_NEAR_EDGE_EDGE) rows += compare_near_edges(&s, 1, 0);
        sc_worker_count_boxes(w, s.follows, rows);
    }
}
