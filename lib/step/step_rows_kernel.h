/*
 * Two leaf clusters in a step, or one: which of their vertices, edges and triangles may come
 * together. See step/leaf_motion_kernel.h.
 *
 * SPDX-License-Identifier: MIT
 *
 * Only points are looked at. A triangle or an edge is separated from a slab or a box that moves if
 * all its points are beyond the same side, at both ends: these are sets of points of a leaf
 * cluster, and which of its triangles and edges are within such a set is asked of sixteen at once.
 * That is tried from the cheapest to the dearest, and each step only looks at what the one before
 * has left:
 *
 *   - the slab of each of the two leaf clusters, and its box, against the points of the other;
 *   - rows: the slab of each triangle of the one against the points of the other, then of those
 *     triangles of the other that are left against the points of the first;
 *   - the boxes of triangles and edges.
 *
 * A vertex belongs to the first leaf cluster that has it, an edge to the triangle that names it: so
 * each vertex meets each triangle, and each edge each other edge, in one pair of leaf clusters, or
 * in one with itself. What shares a point is left out.
 */

/* What is left: triangles of one with points of the other, and edges with edges. */
typedef struct step_rows {
    unsigned faces, edges;         /* rows of these */
    uint8_t of[2 * SC_LEAF_MAX];   /* 0: a triangle of the first and points of the second, or 1 */
    uint8_t face[2 * SC_LEAF_MAX]; /* the triangle */
    uint16_t points[2 * SC_LEAF_MAX];    /* a bit for each */
    uint8_t edge[3 * SC_LEAF_MAX];       /* side k of triangle i of the first, as 16 k + i */
    uint16_t others[3 * SC_LEAF_MAX][3]; /* bit j of k: side k of triangle j of the second */
} step_rows;

/* Points that are before a slab at both ends of a step; and in the upper half those behind it. The
   ends of the slab are so many floats apart. */
static inline unsigned beyond_slab(const sc_leaf_motion *p, const lanes n[3], const float *ends,
                                   uint32_t stride)
{
    lanes at[2][3], place[2];
    int end, k;
    SC_UNROLL
    for (end = 0; end < 2; end++) {
        SC_UNROLL
        for (k = 0; k < 3; k++) at[end][k] = lanes_load(p->at[end][k]);
        place[end] = places_along(n, (const lanes *)at[end]);
    }
    return lanes_bits(lanes_both(lanes_below(place[0], lanes_all(ends[0])),
                                 lanes_below(place[1], lanes_all(ends[2 * stride])))) |
           lanes_bits(lanes_both(lanes_below(lanes_all(ends[stride]), place[0]),
                                 lanes_below(lanes_all(ends[3 * stride]), place[1])))
               << 16;
}

/* The same of the slab of a leaf cluster, and of that of triangle i. */
static inline unsigned beyond_leaf(const sc_leaf_motion *p, const sc_leaf_motion *a)
{
    lanes n[3];
    int k;
    SC_UNROLL
    for (k = 0; k < 3; k++) n[k] = lanes_all(a->direction[k]);
    return beyond_slab(p, (const lanes *)n, a->ends, 1);
}

static inline unsigned beyond_face(const sc_leaf_motion *p, const sc_leaf_motion *a, uint32_t i)
{
    lanes n[3];
    int k;
    SC_UNROLL
    for (k = 0; k < 3; k++) n[k] = lanes_all(a->normal[k][i]);
    return beyond_slab(p, (const lanes *)n, a->slab[0] + i, SC_LEAF_MAX);
}

/* Whether it is all of them, before or behind. */
static inline unsigned all_beyond(unsigned beyond)
{
    return (unsigned)((beyond & 0xffffu) == 0xffffu) | (unsigned)(beyond >> 16 == 0xffffu);
}

/* The same for the three pairs of sides of a box. */
static inline void beyond_box(const sc_leaf_motion *p, const sc_moving_box *box, unsigned beyond[3])
{
    int k;
    SC_UNROLL
    for (k = 0; k < 3; k++) {
        const lanes start = lanes_load(p->at[0][k]), end = lanes_load(p->at[1][k]);
        beyond[k] = lanes_bits(lanes_both(lanes_below(start, lanes_all(box->low[k])),
                                          lanes_below(end, lanes_all(box->low[4 + k])))) |
                    lanes_bits(lanes_both(lanes_below(lanes_all(box->high[k]), start),
                                          lanes_below(lanes_all(box->high[4 + k]), end)))
                        << 16;
    }
}

/* Those of sixteen sets of points that are neither all before one of so many slabs nor all behind
   it. */
static inline unsigned left_of(lanes_sets sets, const unsigned *beyond, int count)
{
    unsigned apart = 0;
    int k;
    SC_UNROLL
    for (k = 0; k < count; k++)
        apart |= lanes_within(sets, beyond[k] & 0xffffu) | lanes_within(sets, beyond[k] >> 16);
    return ~apart & 0xffffu;
}

/* Points that are on neither side of so many. */
static inline unsigned points_left(const unsigned *beyond, int count)
{
    unsigned apart = 0;
    int k;
    SC_UNROLL
    for (k = 0; k < count; k++) apart |= beyond[k] | beyond[k] >> 16;
    return ~apart & 0xffffu;
}

/* What is left of a leaf cluster. */
typedef struct leaf_left {
    const sc_motion *motion; /* of all of its mesh */
    const sc_leaf_motion *moving;
    const uint32_t *point;                /* its points, */
    const uint8_t *where;                 /* and which of these are the corners of triangles */
    lanes_sets corners, ends[3];          /* of triangles, of their sides k */
    unsigned triangles, points, edges[3]; /* bits of those that are left */
    uint16_t shared[SC_LEAF_POINTS];      /* which points of the other each point is */
} leaf_left;

static inline void begin_left(const sc_worker *w, const sc_leaf_motion *moving, leaf_left *a)
{
    const sc_model *model = w->model;
    lanes_sets corner[3];
    int k;
    a->motion = &w->frame->motion;
    a->moving = moving;
    a->point = sc_model_leaf_point(model) + SC_LEAF_POINTS * (uint64_t)moving->leaf;
    a->where = sc_model_leaf_corner(model) + 3 * SC_LEAF_MAX * (uint64_t)moving->leaf;
    SC_UNROLL
    for (k = 0; k < 3; k++) corner[k] = lanes_sets_of(a->where + SC_LEAF_MAX * k);
    SC_UNROLL
    for (k = 0; k < 3; k++) a->ends[k] = lanes_sets_join(corner[k], corner[(k + 1) % 3]);
    a->corners = lanes_sets_join(a->ends[0], corner[2]);
}

/* Leaves what the box of the other one does not tell apart from it, and its slab, by what is beyond
   that. */
static inline void leave_near(leaf_left *a, const sc_leaf_motion *other, unsigned slab)
{
    unsigned beyond[4];
    int k;
    beyond_box(a->moving, &other->box, beyond);
    beyond[3] = slab;
    a->triangles = left_of(a->corners, beyond, 4) & a->moving->triangles;
    a->points = points_left(beyond, 4) & a->moving->own;
    SC_UNROLL
    for (k = 0; k < 3; k++) a->edges[k] = left_of(a->ends[k], beyond, 4) & a->moving->owned[k];
}

/* Finds which points of two leaf clusters are the same. */
static inline void find_shared(leaf_left *a, leaf_left *b)
{
    const lanes_bytes name = lanes_names(a->point, b->point);
    unsigned some = ~lanes_bytes_bits(lanes_bytes_same(name, lanes_bytes_all(255))) & 0xffffu;
    uint8_t number[SC_LANES_COUNT];
    lanes_bytes_store(number, name);
    memset(a->shared, 0, sizeof a->shared);
    memset(b->shared, 0, sizeof b->shared);
    for (; some; some &= some - 1) {
        const uint32_t j = sc_bits_lowest(some), i = number[j];
        a->shared[i] = (uint16_t)(a->shared[i] | 1u << j);
        b->shared[j] = (uint16_t)(1u << i);
    }
}

/* Adds a triangle of one of two leaf clusters with those points of the other one b that its box
   does not tell apart from it. */
static inline void add_face(const leaf_left *a, uint32_t i, const leaf_left *b, unsigned points,
                            unsigned of, step_rows *rows)
{
    uint32_t point[3];
    unsigned beyond[3];
    sc_moving_box box;
    int k;
    for (k = 0; k < 3; k++) {
        const uint32_t corner = a->where[SC_LEAF_MAX * k + (int)i];
        points &= ~(unsigned)a->shared[corner];
        point[k] = a->point[corner];
    }
    if (!points) return;
    make_moving_box(a->motion, point, 3, &box);
    beyond_box(b->moving, &box, beyond);
    points &= points_left(beyond, 3);
    rows->of[rows->faces] = (uint8_t)of;
    rows->face[rows->faces] = (uint8_t)i;
    rows->points[rows->faces] = (uint16_t)points;
    rows->faces += points != 0;
}

/* The same for side k of triangle i, and edges. */
static inline void add_edge(const leaf_left *a, uint32_t i, int k, const leaf_left *b,
                            const unsigned edges[3], step_rows *rows)
{
    const uint32_t first = a->where[SC_LEAF_MAX * k + (int)i];
    const uint32_t second = a->where[SC_LEAF_MAX * ((k + 1) % 3) + (int)i];
    const unsigned apart = ~((unsigned)a->shared[first] | a->shared[second]);
    const uint32_t point[2] = {a->point[first], a->point[second]};
    unsigned beyond[3], left[3];
    sc_moving_box box;
    int l;
    SC_UNROLL
    for (l = 0; l < 3; l++) left[l] = edges[l] & lanes_within(b->ends[l], apart & 0xffffu);
    if (!(left[0] | left[1] | left[2])) return;
    make_moving_box(a->motion, point, 2, &box);
    beyond_box(b->moving, &box, beyond);
    SC_UNROLL
    for (l = 0; l < 3; l++) {
        left[l] &= left_of(b->ends[l], beyond, 3);
        rows->others[rows->edges][l] = (uint16_t)left[l];
    }
    rows->edge[rows->edges] = (uint8_t)(SC_LEAF_MAX * k + (int)i);
    rows->edges += (left[0] | left[1] | left[2]) != 0;
}

/* Rows of two leaf clusters, of what is left of each; of one mesh, or of two, which share no point.
   Returns how many slabs were compared with points. */
static uint32_t compare_faces(leaf_left *a, leaf_left *b, step_rows *rows)
{
    unsigned faces_a = 0, faces_b = 0, some; /* that are not apart from all of the other */
    unsigned beyond_a[SC_LEAF_MAX], near_a[SC_LEAF_MAX]; /* of faces_a: points, triangles of b */
    uint16_t sides[3][SC_LEAF_MAX]; /* edges of a that each triangle of b leaves */
    lanes_sets left_by[3];
    uint32_t count = sc_bits_count(a->triangles);
    int k, l;
    for (some = a->triangles; some; some &= some - 1) {
        const uint32_t i = sc_bits_lowest(some);
        beyond_a[i] = beyond_face(b->moving, a->moving, i);
        near_a[i] = left_of(b->corners, &beyond_a[i], 1) & b->triangles;
        faces_a |= (unsigned)(near_a[i] != 0) << i;
        faces_b |= near_a[i];
    }
    if (!faces_a) return count;
    count += sc_bits_count(faces_b);
    if (a->motion == b->motion) {
        find_shared(a, b);
    } else {
        memset(a->shared, 0, sizeof a->shared);
        memset(b->shared, 0, sizeof b->shared);
    }
    memset(sides, 0, sizeof sides);
    for (some = faces_b; some; some &= some - 1) {
        const uint32_t j = sc_bits_lowest(some);
        const unsigned beyond = beyond_face(a->moving, b->moving, j);
        if (!(left_of(a->corners, &beyond, 1) & faces_a)) {
            faces_b &= ~(1u << j);
            continue;
        }
        add_face(b, j, a, points_left(&beyond, 1) & a->points, 1, rows);
        SC_UNROLL
        for (k = 0; k < 3; k++)
            sides[k][j] = (uint16_t)(left_of(a->ends[k], &beyond, 1) & a->edges[k]);
    }
    SC_UNROLL
    for (k = 0; k < 3; k++) left_by[k] = lanes_sets_load(sides[k]);
    for (some = faces_a; some; some &= some - 1) {
        const uint32_t i = sc_bits_lowest(some);
        const unsigned *beyond = &beyond_a[i];
        unsigned edges[3];
        if (!(near_a[i] & faces_b)) continue;
        add_face(a, i, b, points_left(beyond, 1) & b->points, 0, rows);
        SC_UNROLL
        for (l = 0; l < 3; l++) edges[l] = left_of(b->ends[l], beyond, 1) & b->edges[l];
        SC_UNROLL
        for (k = 0; k < 3; k++) {
            const unsigned faces = ~lanes_within(left_by[k], ~(1u << i) & 0xffffu) & 0xffffu;
            const unsigned left[3] = {edges[0] & faces, edges[1] & faces, edges[2] & faces};
            if (faces) add_edge(a, i, k, b, left, rows);
        }
    }
    return count;
}

/* Finds what is left of two leaf clusters. Returns how many slabs and boxes were compared with
   points. */
static uint32_t find_rows(const sc_worker *w, const sc_leaf_motion *moving_a,
                          const sc_leaf_motion *moving_b, step_rows *rows)
{
    const unsigned slab_b = beyond_leaf(moving_b, moving_a);
    const unsigned slab_a = beyond_leaf(moving_a, moving_b);
    leaf_left a, b;
    rows->faces = rows->edges = 0;
    if (all_beyond(slab_a) | all_beyond(slab_b)) return 2;
    begin_left(w, moving_a, &a);
    leave_near(&a, moving_b, slab_a);
    if (!a.triangles) return 3;
    begin_left(w->second, moving_b, &b);
    leave_near(&b, moving_a, slab_b);
    if (!b.triangles) return 4;
    return 4 + compare_faces(&a, &b, rows);
}

/* The same for one: its triangles with its points, and its edges with those of triangles that come
   later. */
static uint32_t find_own_rows(const sc_worker *w, const sc_leaf_motion *moving, step_rows *rows)
{
    uint16_t sides[3][SC_LEAF_MAX];
    lanes_sets left_by[3];
    leaf_left a;
    unsigned some;
    int i, k;
    rows->faces = rows->edges = 0;
    memset(sides, 0, sizeof sides);
    begin_left(w, moving, &a);
    for (i = 0; i < SC_LEAF_POINTS; i++) a.shared[i] = (uint16_t)(1u << i);
    for (some = moving->triangles; some; some &= some - 1) {
        const uint32_t j = sc_bits_lowest(some);
        const unsigned beyond = beyond_face(moving, moving, j);
        add_face(&a, j, &a, points_left(&beyond, 1) & moving->own, 0, rows);
        SC_UNROLL
        for (k = 0; k < 3; k++)
            sides[k][j] = (uint16_t)(left_of(a.ends[k], &beyond, 1) & moving->owned[k]);
    }
    SC_UNROLL
    for (k = 0; k < 3; k++) left_by[k] = lanes_sets_load(sides[k]);
    for (some = moving->triangles; some; some &= some - 1) {
        const uint32_t j = sc_bits_lowest(some);
        const unsigned later = ~((2u << j) - 1u) & 0xffffu;
        SC_UNROLL
        for (k = 0; k < 3; k++) {
            const unsigned faces = ~lanes_within(left_by[k], ~(1u << j) & 0xffffu) & later;
            const unsigned left[3] = {sides[0][j] & faces, sides[1][j] & faces,
                                      sides[2][j] & faces};
            if (faces) add_edge(&a, j, k, &a, left, rows);
        }
    }
    return sc_bits_count(moving->triangles);
}
