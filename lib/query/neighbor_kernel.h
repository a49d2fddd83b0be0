/*
 * Pairs of triangles of two leaf clusters, or of one, that share points: sixteen at a time, which
 * have nothing in common but what they share. See query_kernels.h.
 *
 * SPDX-License-Identifier: MIT
 *
 * Two triangles t and u that share one point p are looked at from there: a_0 and a_1 lead from p to
 * the other corners of t, b_0 and b_1 to those of u. They have p alone in common if
 *
 * - along some direction m, both a are strictly ahead of p and both b behind;
 * - both b are strictly on one side of the plane of t, or both a on one of that of u;
 * - in a projection, the line of one of the four has the other of its triangle strictly on one
 *   side, and both of the other triangle strictly on the other.
 *
 * Of two that share an edge, p is one end of it, a_0 the other, and a_1 leads to the third corner
 * of t; b_0 and b_1 are both set to what leads to that of u. They have nothing else in common if
 * both b are strictly on one side of the plane of t, or in a projection the line of a_0 has a_1
 * strictly on one side and both b on the other. All other tests fail of themselves, b_0 and b_1
 * being the same, but the first and that by the line of a_1, which do not count. (If both have p
 * twice, a_0 is zero, and all fail; each edge of either has a point of the other, as if they shared
 * an edge.)
 *
 * In single precision. A component of a_k or b_k is off by EDGE and its own rounding; the bounds of
 * planes and sides are derived in sixteen_kernel.h, in the terms of which the product of three
 * meets eight roundings here: 8.01 v |e|1 |f|1 D <= 12.1 v D^2 S; that of a plane is below S (4
 * EDGE (D + EDGE) + 13 v D^2) + 7 EDGE^2 (D + EDGE), however it is rounded. The direction m is any,
 * hence has no error: m . a is off by |m|1 (EDGE + 4.1 v D) and a few FLT_MIN if products
 * underflow.
 *
 * A direction tells most of them apart. The others, of whatever leaf clusters, wait until there are
 * sixteen.
 */

/* Sixteen pairs, as above; and which are of such that share just a point, or an edge. */
typedef struct neighbors {
    lanes at[2][2][3]; /* a and b, first and second, axis */
    unsigned point, edge;
} neighbors;

/* Numbers of these: of p, of both ends of a and of b among the points of their leaf cluster, and of
   t and u among its triangles. */
typedef struct neighbor_rows {
    lanes_bytes row[SC_OPEN_NUMBERS];
} neighbor_rows;

/* A leaf cluster: where its points are, which are the corners of its triangles, and what these are
   called: points of two clusters, or of one, are the same if they have the same name. */
typedef struct neighborhood {
    const float *at;
    lanes_triples corner, name;
} neighborhood;

/* Of clusters a and b. Points are called as they are numbered in a. */
static inline void find_points(const sc_worker *w, uint32_t a, uint32_t b, neighborhood *n)
{
    const uint32_t *point = sc_model_leaf_point(w->model);
    const uint8_t *corner = sc_model_leaf_corner(w->model) + 3 * SC_LEAF_MAX * (uint64_t)b;
    lanes_bytes row[3], name;
    int k;
    n->at = w->frame->point_at + 4 * SC_LEAF_POINTS * (uint64_t)b;
    SC_UNROLL
    for (k = 0; k < 3; k++) row[k] = lanes_bytes_load(corner + SC_LEAF_MAX * k);
    n->name = n->corner = lanes_triples_of(row);
    if (a == b) return;
    name = lanes_names(point + SC_LEAF_POINTS * (uint64_t)a, point + SC_LEAF_POINTS * (uint64_t)b);
    SC_UNROLL
    for (k = 0; k < 3; k++) row[k] = lanes_bytes_through(name, row[k]);
    n->name = lanes_triples_of(row);
}

/* The lanes in which just one of three is set, and just two. */
static inline unsigned just_one(const unsigned x[3])
{
    return (x[0] ^ x[1] ^ x[2]) & ~(x[0] & x[1]);
}
static inline unsigned just_two(const unsigned x[3])
{
    return (x[0] | x[1] | x[2]) & ~(x[0] ^ x[1] ^ x[2]);
}

/* Turns corners so that they begin with the first or the second where that is to be, else the
   last. */
static inline void turn(lanes_bytes first, lanes_bytes second, const lanes_bytes corner[3],
                        lanes_bytes turned[3])
{
    int k;
    SC_UNROLL
    for (k = 0; k < 3; k++)
        turned[k] = lanes_bytes_choose(
            first, corner[k], lanes_bytes_choose(second, corner[(k + 1) % 3], corner[(k + 2) % 3]));
}

/* So that the first is shared and not the last, if two are, or the others, if one is. */
static inline void turn_shared(const lanes_bytes shared[3], const lanes_bytes corner[3],
                               lanes_bytes turned[3])
{
    const lanes_bytes first = lanes_bytes_but(shared[0], shared[2]);
    const lanes_bytes second = lanes_bytes_but(shared[1], shared[0]);
    turn(first, second, corner, turned);
}

static inline void load_neighbors(const neighborhood *a, const neighborhood *b, const uint8_t *of_a,
                                  const uint8_t *of_b, neighbors *x, neighbor_rows *numbers)
{
    lanes_bytes p[3], q[3], name[3], same[3][3], shared[2][3], turned[2][3];
    unsigned bits[2][3];
    int k, c;
    lanes_triples_through(&a->corner, of_a, p);
    lanes_triples_through(&b->corner, of_b, q);
    lanes_triples_through(&b->name, of_b, name);
    SC_UNROLL
    for (k = 0; k < 3; k++) {
        SC_UNROLL
        for (c = 0; c < 3; c++) same[k][c] = lanes_bytes_same(p[k], name[c]);
    }
    SC_UNROLL
    for (k = 0; k < 3; k++) {
        shared[0][k] = lanes_bytes_either(lanes_bytes_either(same[k][0], same[k][1]), same[k][2]);
        shared[1][k] = lanes_bytes_either(lanes_bytes_either(same[0][k], same[1][k]), same[2][k]);
        bits[0][k] = lanes_bytes_bits(shared[0][k]);
        bits[1][k] = lanes_bytes_bits(shared[1][k]);
    }
    x->point = just_one(bits[0]) & just_one(bits[1]);
    x->edge = just_two(bits[0]) & just_two(bits[1]);
    turn_shared(shared[0], p, turned[0]);
    turn_shared(shared[1], q, turned[1]);
    /* the last of u twice if they share an edge: then the middle one is shared */
    turned[1][1] = lanes_bytes_choose(
        lanes_bytes_either(
            lanes_bytes_both(shared[1][0], shared[1][1]),
            lanes_bytes_both(shared[1][2], lanes_bytes_either(shared[1][0], shared[1][1]))),
        turned[1][2], turned[1][1]);
    lanes_edges_of(a->at, b->at, turned[0], turned[1] + 1, x->at);
    SC_UNROLL
    for (k = 0; k < 3; k++) numbers->row[k] = turned[0][k];
    SC_UNROLL
    for (k = 0; k < 2; k++) numbers->row[3 + k] = turned[1][1 + k];
    numbers->row[5] = lanes_bytes_load(of_a);
    numbers->row[6] = lanes_bytes_load(of_b);
}

/* Sixteen pairs of a list (see build/sharing_lists.h), as if they shared just a point. */
static SC_INLINE void load_listed(const neighborhood *a, const neighborhood *b,
                                  const uint16_t *list, neighbors *x, neighbor_rows *numbers)
{
    lanes_bytes quarter[4], corner[2][3], turned[2][3];
    uint8_t of[2][SC_LANES_COUNT];
    int k;
    lanes_bytes_quarters(list, quarter);
    SC_UNROLL
    for (k = 0; k < 2; k++) lanes_bytes_store(of[k], quarter[k]);
    lanes_triples_through(&a->corner, of[0], corner[0]);
    lanes_triples_through(&b->corner, of[1], corner[1]);
    SC_UNROLL
    for (k = 0; k < 2; k++) { /* seen from the corners of these numbers, 0, 1 or 2 */
        const lanes_bytes first = lanes_bytes_same(quarter[2 + k], lanes_bytes_all(0));
        const lanes_bytes second = lanes_bytes_same(quarter[2 + k], lanes_bytes_all(1));
        turn(first, second, corner[k], turned[k]);
    }
    lanes_edges_of(a->at, b->at, turned[0], turned[1] + 1, x->at);
    SC_UNROLL
    for (k = 0; k < 3; k++) numbers->row[k] = turned[0][k];
    SC_UNROLL
    for (k = 0; k < 2; k++) numbers->row[3 + k] = turned[1][1 + k];
    numbers->row[5] = quarter[0];
    numbers->row[6] = quarter[1];
}

static inline lanes dot_product(const lanes x[3], const lanes y[3])
{
    return lanes_add(lanes_add(lanes_multiply(x[0], y[0]), lanes_multiply(x[1], y[1])),
                     lanes_multiply(x[2], y[2]));
}

/* What a place along a direction may be off by; size is the direction's |m|1. */
static inline lanes direction_bound(lanes size, float extent)
{
    const float edge = SC_BOUNDS_EDGE, v = SC_BOUNDS_V;
    return lanes_add(lanes_multiply(size, lanes_all(1.1f * edge + 5 * v * extent)),
                     lanes_all(16 * FLT_MIN));
}

/* The lanes in which t is certainly ahead of p and u behind, along the direction from the middle of
   u to that of t. */
static inline unsigned direction_parts(const neighbors *x, float extent)
{
    lanes m[3], size, bound, ahead, behind;
    int c;
    SC_UNROLL
    for (c = 0; c < 3; c++)
        m[c] = lanes_subtract(lanes_add(x->at[0][0][c], x->at[0][1][c]),
                              lanes_add(x->at[1][0][c], x->at[1][1][c]));
    size = lanes_add(lanes_add(lanes_absolute(m[0]), lanes_absolute(m[1])), lanes_absolute(m[2]));
    bound = direction_bound(size, extent);
    ahead = lanes_smaller(dot_product(m, x->at[0][0]), dot_product(m, x->at[0][1]));
    behind = lanes_larger(dot_product(m, x->at[1][0]), dot_product(m, x->at[1][1]));
    return lanes_bits(lanes_both(lanes_below(bound, ahead),
                                 lanes_below(behind, lanes_subtract(lanes_all(0), bound))));
}

/* Of the plane of triangle s. */
static inline void find_normal(const neighbors *x, int s, lanes n[3])
{
    const lanes *e = x->at[s][0], *f = x->at[s][1];
    int c;
    SC_UNROLL
    for (c = 0; c < 3; c++)
        n[c] = lanes_subtract(lanes_multiply(e[(c + 1) % 3], f[(c + 2) % 3]),
                              lanes_multiply(e[(c + 2) % 3], f[(c + 1) % 3]));
}

/* What a distance from a plane, up to a factor, may be off by here: of a triangle of this size. */
static inline lanes neighbor_plane_bound(lanes size, lanes extent)
{
    const float edge = SC_BOUNDS_EDGE, v = SC_BOUNDS_V;
    const lanes more = lanes_add(extent, lanes_all(edge));
    lanes bound = lanes_add(lanes_multiply(lanes_all(4 * edge), more),
                            lanes_multiply(lanes_all(13 * v), lanes_multiply(extent, extent)));
    return lanes_add(lanes_multiply(size, bound), lanes_multiply(lanes_all(7 * edge * edge), more));
}

/* The lanes in which the plane of triangle s certainly has both of the other on one side. */
static inline unsigned plane_parts(const neighbors *x, int s, lanes extent)
{
    const lanes *e = x->at[s][0], *f = x->at[s][1];
    lanes n[3], size = lanes_all(0), bound, d[2];
    int c;
    find_normal(x, s, n);
    SC_UNROLL
    for (c = 0; c < 3; c++)
        size = lanes_add(size, lanes_add(lanes_absolute(e[c]), lanes_absolute(f[c])));
    bound = neighbor_plane_bound(size, extent);
    d[0] = dot_product(n, x->at[1 - s][0]);
    d[1] = dot_product(n, x->at[1 - s][1]);
    return lanes_bits(lanes_below(bound, lanes_smaller(d[0], d[1]))) |
           lanes_bits(lanes_below(lanes_larger(d[0], d[1]), lanes_subtract(lanes_all(0), bound)));
}

/* Corners as they are seen along the axis nearest to n. */
static SC_INLINE void see_along(const lanes n[3], const lanes corner[][3], int count,
                                lanes flat[][2])
{
    lanes size[3];
    lanes_mask first, second;
    int k, c;
    SC_UNROLL
    for (c = 0; c < 3; c++) size[c] = lanes_absolute(n[c]);
    first = lanes_below(lanes_larger(size[1], size[2]), size[0]);
    second = lanes_below(size[2], size[1]);
    SC_UNROLL
    for (k = 0; k < count; k++) {
        const lanes *p = corner[k];
        flat[k][0] = lanes_choose(first, p[1], p[0]);
        flat[k][1] = lanes_choose(first, p[2], lanes_choose(second, p[2], p[1]));
    }
}

/* What a side in a projection may be off by; see query/sixteen_kernel.h. */
static inline lanes side_bound(lanes extent)
{
    const float edge = SC_BOUNDS_EDGE, v = SC_BOUNDS_V;
    return lanes_add(lanes_multiply(lanes_all(5 * edge), lanes_add(extent, lanes_all(edge))),
                     lanes_multiply(lanes_all(9 * v), lanes_multiply(extent, extent)));
}

/* On which side of e f is, certainly. */
typedef struct side_bits {
    unsigned left, right;
} side_bits;

static inline side_bits side_of(const lanes e[2], const lanes f[2], lanes bound, lanes minus_bound)
{
    lanes d = lanes_subtract(lanes_multiply(e[0], f[1]), lanes_multiply(e[1], f[0]));
    side_bits r;
    r.left = lanes_bits(lanes_below(bound, d));
    r.right = lanes_bits(lanes_below(d, minus_bound));
    return r;
}

/* The lanes in which a line parts them, seen along the axis nearest to the normal of t. */
static inline unsigned side_parts(const neighbors *x, lanes extent)
{
    const lanes bound = side_bound(extent);
    const lanes minus_bound = lanes_subtract(lanes_all(0), bound);
    lanes n[3], flat[2][2][2];
    side_bits own[2], of[2][2]; /* a_0, a_1; b_0, b_1; a_i, b_k */
    unsigned apart = 0;
    int s, i, k;
    find_normal(x, 0, n);
    SC_UNROLL
    for (s = 0; s < 2; s++) {
        see_along(n, (const lanes(*)[3])x->at[s], 2, flat[s]);
        own[s] = side_of(flat[s][0], flat[s][1], bound, minus_bound);
    }
    SC_UNROLL
    for (i = 0; i < 2; i++) {
        SC_UNROLL
        for (k = 0; k < 2; k++) of[i][k] = side_of(flat[0][i], flat[1][k], bound, minus_bound);
    }
    /* a_0 has b_k on side of[0][k] and a_1 on its own; a_1 has a_0 on the other */
    apart |= (own[0].left & of[0][0].right & of[0][1].right) |
             (own[0].right & of[0][0].left & of[0][1].left);
    apart |= ((own[0].right & of[1][0].right & of[1][1].right) |
              (own[0].left & of[1][0].left & of[1][1].left)) &
             x->point;
    /* b_k has a_i on the side opposite to of[i][k] */
    apart |= (own[1].left & of[0][0].left & of[1][0].left) |
             (own[1].right & of[0][0].right & of[1][0].right);
    apart |= (own[1].right & of[0][1].left & of[1][1].left) |
             (own[1].left & of[0][1].right & of[1][1].right);
    return apart;
}

/* Of the last pairs that are open, up to sixteen, leaves those that may meet outside of what they
   share. */
static void classify_open(sc_worker *w, uint32_t most)
{
    sc_open_pairs *open = w->lists.open;
    uint32_t *left = &w->lists.count[SC_LIST_OPEN];
    const unsigned count = *left < most ? *left : most;
    const unsigned some = count < SC_LANES_COUNT ? count : SC_LANES_COUNT;
    const unsigned at = *left -= some;
    const lanes extent = lanes_load(open->extent + at);
    const uint32_t *triangle = sc_model_triangle(w->model);
    unsigned mask = (1u << some) - 1u, rest;
    neighbors x;
    lanes_mask same[3];
    lanes from[3], to[3];
    int i, k, c;
    SC_UNROLL
    for (k = 0; k < 5; k++) {
        uint32_t row[SC_LANES_COUNT];
        for (i = 0; i < SC_LANES_COUNT; i++) { /* in transposed places */
            uint32_t number = open->number[k][at + (unsigned)i];
            row[i] = (number & ~15u) | (number << 2 & 12u) | (number >> 2 & 3u);
        }
        lanes_rows(w->frame->point_at, row, &to[0], &to[1], &to[2]);
        SC_UNROLL
        for (c = 0; c < 3; c++) {
            if (k == 0)
                from[c] = to[c];
            else
                x.at[(k - 1) / 2][(k - 1) % 2][c] = lanes_subtract(to[c], from[c]);
        }
    }
    SC_UNROLL
    for (c = 0; c < 3; c++) same[c] = lanes_same(x.at[1][0][c], x.at[1][1][c]);
    x.edge = lanes_bits(lanes_both(same[0], lanes_both(same[1], same[2])));
    x.point = ~x.edge;
    mask &= ~side_parts(&x, extent);
    if (mask) {
        mask &= ~plane_parts(&x, 1, extent);
        mask &= ~plane_parts(&x, 0, extent);
    }
    for (rest = mask; rest; rest &= rest - 1) {
        const unsigned lane = at + sc_bits_lowest(rest);
        sc_fetch(triangle + 3 * (uint64_t)(open->number[5][lane] & SC_ITEM));
        sc_fetch(triangle + 3 * (uint64_t)open->number[6][lane]);
    }
    for (; mask; mask &= mask - 1) {
        unsigned lane = at + sc_bits_lowest(mask);
        sc_decide_add_neighbors(w, open->number[5][lane], open->number[6][lane]);
    }
}

/* Two leaf clusters, or one twice, of which pairs are taken. */
typedef struct neighborhoods {
    neighborhood a, b;
    uint32_t first[SC_OPEN_NUMBERS]; /* what is added to numbers to list pairs as open */
    float extent;                    /* of both */
    int take_edges;                  /* pairs that share an edge are wanted */
} neighborhoods;

/* Sets all but what the triangles' corners are. */
static inline void begin_neighbors(const sc_worker *w, const sc_leaf_pair *p, float extent,
                                   neighborhoods *n)
{
    const uint32_t *first = sc_model_leaf_first(w->model);
    n->first[0] = n->first[1] = n->first[2] = SC_LEAF_POINTS * p->a;
    n->first[3] = n->first[4] = SC_LEAF_POINTS * p->b;
    n->first[5] = first[p->a] | p->bit;
    n->first[6] = first[p->b];
    n->extent = extent;
    n->take_edges = w->question->options.pairs != SC_PAIRS_EDGE &&
                    w->question->options.contact != SC_CONTACT_PROPER;
}

/* Lists pairs as open. */
static inline void add_open(sc_worker *w, unsigned mask, const neighborhoods *n,
                            const neighbor_rows *numbers)
{
    sc_open_pairs *open = w->lists.open;
    uint32_t *count = &w->lists.count[SC_LIST_OPEN];
    lanes_store(open->extent + *count, lanes_all(n->extent));
    lanes_list_rows(mask, numbers->row, n->first, SC_OPEN_NUMBERS, &open->number[0][*count],
                    SC_OPEN_MAX + 16);
    *count += sc_bits_count(mask);
}

/* The lanes of those of sixteen from a number on that are below an end. */
static inline unsigned lanes_before(unsigned at, unsigned end)
{
    return end - at < SC_LANES_COUNT ? (1u << (end - at)) - 1u : 0xffffu;
}

/* Lists those of pairs of triangles with these numbers, of two leaf clusters or one, that may meet
   outside of what they share. */
static void take_neighbors(sc_worker *w, const sc_leaf_pair *p, float extent, uint8_t *of_a,
                           uint8_t *of_b, unsigned count)
{
    neighborhoods n;
    neighbors x;
    neighbor_rows numbers;
    unsigned at;
    begin_neighbors(w, p, extent, &n);
    find_points(w, p->a, p->a, &n.a);
    find_points(w, p->a, p->b, &n.b);
    memset(of_a + count, 0, SC_LANES_COUNT); /* fills the last row */
    memset(of_b + count, 0, SC_LANES_COUNT);
    for (at = 0; at < count; at += SC_LANES_COUNT) {
        unsigned mask = lanes_before(at, count), odd;
        load_neighbors(&n.a, &n.b, of_a + at, of_b + at, &x, &numbers);
        odd = mask & ~(x.point | x.edge);
        mask &= n.take_edges ? x.point | x.edge : x.point;
        mask &= ~(direction_parts(&x, n.extent) & x.point);
        if (mask) add_open(w, mask, &n, &numbers);
        for (; odd; odd &= odd - 1) {
            uint32_t lane = at + sc_bits_lowest(odd);
            sc_decide_add_neighbors(w, n.first[5] + of_a[lane], n.first[6] + of_b[lane]);
        }
    }
}

/* The same of pairs that the model lists. */
static void take_listed(sc_worker *w, const sc_leaf_pair *p, float extent)
{
    const uint16_t *list = p->list + SC_SHARE_ROWS + sc_bits_count(p->list[SC_SHARE_TRIANGLES]);
    const unsigned points = sc_share_points(p->list), edges = points + sc_share_edges(p->list);
    const unsigned count = (unsigned)(p->list_end - list);
    neighborhoods n;
    neighbors x;
    neighbor_rows numbers;
    unsigned at, mask;
    begin_neighbors(w, p, extent, &n);
    find_points(w, p->a, p->a, &n.a);
    find_points(w, p->b, p->b, &n.b);
    for (at = 0; at < points; at += SC_LANES_COUNT) {
        load_listed(&n.a, &n.b, list + at, &x, &numbers);
        mask = lanes_before(at, points) & ~direction_parts(&x, n.extent);
        if (mask) add_open(w, mask, &n, &numbers);
    }
    for (at = points; n.take_edges && at < edges; at += SC_LANES_COUNT) {
        load_listed(&n.a, &n.b, list + at, &x, &numbers);
        numbers.row[3] = numbers.row[4];
        add_open(w, lanes_before(at, edges), &n, &numbers);
    }
    for (at = edges; at < count; at++)
        sc_decide_add_neighbors(w, n.first[5] + (list[at] & 15u),
                                n.first[6] + (list[at] >> 4 & 15u));
}
