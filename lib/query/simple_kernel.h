/*
 * The inner loops of the exact contour test. See simple.h.
 *
 * SPDX-License-Identifier: MIT
 *
 * The edges of a contour, as they are listed, are taken as a cycle. They are compared sixteen at a
 * time with those two and three further on; then boxes of spans of two edges with those of the
 * spans two and three further on; boxes of spans of four, and so on, until there are at most
 * sixteen spans, of which all are compared. Where the boxes of two spans overlap, the spans within
 * are compared, down to edges. All pairs of edges are covered but those that follow each other:
 * take the longest spans that do not follow each other and have one edge each; those of twice the
 * length do, or are the same, and so hold the spans taken, no more than three apart. A last span
 * may be shorter, and brings its ends nearer.
 *
 * Those need not be compared: if an edge folded back on the next, one of the two would have the
 * other's far end on it, where a third ends or begins. That one is not apart from it, so they share
 * a point. Beyond a gap they overlap there (is_open in simple.c). Else the contour passes that
 * point twice, where two of its edges have one direction (is_pinch_fine); or it is of three edges,
 * and has no area, as all triangles have, or its piece has none (are_pieces_fine).
 *
 * Pairs of edges that cannot be separated here are few and go to sc_simple_are_apart.
 */

/* The bits of the first lanes. */
static inline unsigned first_lanes(uint32_t count)
{
    return count < SC_LANES_COUNT ? (1u << count) - 1u : 0xffffu;
}

/* Which of sixteen edges are edges, from any one on; those that follow the last are the first
   again. */
static inline unsigned edges_from(const sc_simple_contour *c, uint32_t i)
{
    const uint16_t *is_edge = c->edges->is_edge + i / SC_CONTOUR_BLOCK;
    if (!c->has_gaps) return 0xffffu;
    return (is_edge[0] | (unsigned)is_edge[1] << 16) >> i % SC_CONTOUR_BLOCK & 0xffffu;
}

/* The transposed places of a loop's points, and beyond its end the first again. */
static void place_loop(sc_simple_contour *c)
{
    uint32_t *place = c->edges->point, i;
    const uint32_t count = c->looped;
    for (i = 0; i + SC_CONTOUR_BLOCK <= count; i += SC_CONTOUR_BLOCK)
        lanes_numbers(place + i, c->loop + i, c->split, c->first, c->second);
    if (count > SC_CONTOUR_BLOCK) {
        i = count - SC_CONTOUR_BLOCK;
        lanes_numbers(place + i, c->loop + i, c->split, c->first, c->second);
    } else {
        for (; i < count; i++) place[i] = sc_simple_place(c, c->loop[i]);
    }
    if (c->in_pieces) {
        sc_simple_spread(c);
        sc_simple_close_bits(c);
    }
    for (i = 0; i < SC_CONTOUR_BLOCK; i++) place[c->count + i] = place[0];
}

/* Sixteen points in the unit box. */
static inline void load_contour(const sc_simple_contour *c, const sc_frame *frame, uint32_t i,
                                lanes unit[3])
{
    float row[3 * SC_CONTOUR_BLOCK];
    int k;
    if (c->loop) {
        lanes_rows(frame->point_at, c->edges->point + i, &unit[0], &unit[1], &unit[2]);
        return;
    }
    load_points(frame, c->edges->point + i, row);
    SC_UNROLL
    for (k = 0; k < 3; k++) unit[k] = lanes_load(row + SC_CONTOUR_BLOCK * k);
}

/* Places of the points, and the error of their coordinates, see sc_simple_axes. The last is
   followed by the first. */
static void project(sc_simple_contour *c, const sc_frame *frame)
{
    const sc_contour_edges *e = c->edges;
    lanes size = lanes_all(0), d[3], at, from[3], axis[2][3];
    uint32_t i;
    int k, m;
    SC_UNROLL
    for (k = 0; k < 3; k++) {
        from[k] = lanes_all(c->from[k]);
        SC_UNROLL
        for (m = 0; m < 2; m++) axis[m][k] = lanes_all(c->axis[m][k]);
    }
    if (c->loop) place_loop(c);
    for (i = 0; i < c->count; i += SC_CONTOUR_BLOCK) {
        load_contour(c, frame, i, d);
        SC_UNROLL
        for (k = 0; k < 3; k++) {
            d[k] = lanes_subtract(d[k], from[k]);
            size = lanes_larger(size, lanes_absolute(d[k]));
        }
        SC_UNROLL
        for (k = 0; k < 2; k++) {
            at = lanes_add(
                lanes_add(lanes_multiply(axis[k][0], d[0]), lanes_multiply(axis[k][1], d[1])),
                lanes_multiply(axis[k][2], d[2]));
            lanes_store(e->at[k] + i, at);
        }
    }
    SC_UNROLL
    for (k = 0; k < 2; k++) lanes_store(e->at[k] + c->count, lanes_load(e->at[k]));
    c->error = sc_bounds_contour(lanes_most(size));
}

/* Sixteen edges, from p to q. */
typedef struct edge_lanes {
    lanes p[2], q[2];
} edge_lanes;

static inline lanes cross_in_plane(const lanes a[2], const lanes b[2])
{
    return lanes_subtract(lanes_multiply(a[0], b[1]), lanes_multiply(a[1], b[0]));
}

static inline lanes size_in_plane(const lanes a[2])
{
    return lanes_add(lanes_absolute(a[0]), lanes_absolute(a[1]));
}

/* What a cross product of vectors with this sum of sizes is off by, see bound_of in simple.c. */
static inline lanes bound_in_plane(float error, lanes size)
{
    return lanes_add(
        lanes_multiply(lanes_all(SC_BOUNDS_TURN * error), lanes_add(size, lanes_all(4 * error))),
        lanes_all(FLT_MIN));
}

/* Bits of lanes in which both a and b are above bound, or both below -bound. */
static inline unsigned one_side(lanes a, lanes b, lanes bound)
{
    return lanes_bits(lanes_below(bound, lanes_smaller(a, b))) |
           lanes_bits(lanes_below(lanes_larger(a, b), lanes_subtract(lanes_all(0), bound)));
}

/*
 * Bits of the edges e that are certainly apart from f, as one is on one side of the other's line.
 * The sizes of an edge and of a vector from its line to an end of the other edge, of which bound_of
 * wants the sum, are at most those of both edges and of the vector from p to p, but for a rounding
 * that is in the bound's slack. Edges that share a point are not apart: then one of each two
 * products is 0.
 */
static inline unsigned lie_apart(float error, const edge_lanes *e, const edge_lanes *f)
{
    lanes along[2], other[2], pp[2], pq[2], qp[2], bound;
    int k;
    for (k = 0; k < 2; k++) {
        along[k] = lanes_subtract(e->q[k], e->p[k]);
        other[k] = lanes_subtract(f->q[k], f->p[k]);
        pp[k] = lanes_subtract(f->p[k], e->p[k]);
        pq[k] = lanes_subtract(f->q[k], e->p[k]);
        qp[k] = lanes_subtract(f->p[k], e->q[k]);
    }
    bound = bound_in_plane(
        error, lanes_add(lanes_add(size_in_plane(along), size_in_plane(other)), size_in_plane(pp)));
    return one_side(cross_in_plane(along, pp), cross_in_plane(along, pq), bound) |
           one_side(cross_in_plane(other, pp), cross_in_plane(other, qp), bound);
}

static inline void load_edges(const sc_simple_contour *c, uint32_t i, edge_lanes *e)
{
    int k;
    for (k = 0; k < 2; k++) {
        e->p[k] = lanes_load(c->edges->at[k] + i);
        e->q[k] = lanes_load(c->edges->at[k] + i + 1);
    }
}

/* Bits of lanes in which boxes overlap: low x, high x, low y, high y of each. */
static inline unsigned overlap_in_plane(const lanes a[4], const lanes b[4])
{
    return lanes_bits(lanes_both(lanes_both(lanes_not_above(a[SC_LOW_X], b[SC_HIGH_X]),
                                            lanes_not_above(b[SC_LOW_X], a[SC_HIGH_X])),
                                 lanes_both(lanes_not_above(a[SC_LOW_Y], b[SC_HIGH_Y]),
                                            lanes_not_above(b[SC_LOW_Y], a[SC_HIGH_Y]))));
}

/* Some of sixteen edges and those `on` places further on. */
static int are_pairs_fine(sc_simple_contour *c, uint32_t i, uint32_t on, unsigned some)
{
    edge_lanes own, other;
    if (!some) return 1;
    load_edges(c, i, &own);
    load_edges(c, i + on, &other);
    for (some &= ~lie_apart(c->error, &own, &other); some; some &= some - 1) {
        uint32_t edge = i + sc_bits_lowest(some);
        if (!sc_simple_are_apart(c, edge, (edge + on) % c->count)) return 0;
    }
    return 1;
}

/*
 * Sixteen edges and those two and three further on, by their boxes. Two
 * boxes are to be four errors apart: two for the places of points, and two, 2^-23 of a coordinate
 * or more, for the rounding here. So are those of spans, which are two errors larger each; this
 * writes the boxes of spans of two edges, without the end of a second that is none. What else is no
 * edge is in boxes, which does no harm.
 */
static inline int are_near_fine(sc_simple_contour *c, uint32_t i, float first[4][SC_LANES_COUNT])
{
    const sc_contour_edges *e = c->edges;
    const lanes margin = lanes_all(4 * c->error), half = lanes_all(2 * c->error);
    const lanes none = lanes_all(0);
    const unsigned edges = first_lanes(c->count - i) & edges_from(c, i);
    edge_lanes own, other;
    lanes box[4], next[4], low, high;
    unsigned near[2], s;
    int k;
    load_edges(c, i, &own);
    load_edges(c, i + 1, &other);
    SC_UNROLL
    for (k = 0; k < 2; k++) {
        low = lanes_smaller(own.p[k], own.q[k]);
        high = lanes_larger(own.p[k], own.q[k]);
        box[2 * k] = lanes_subtract(low, margin);
        box[2 * k + 1] = lanes_add(high, margin);
        if (c->has_gaps) {
            lanes wall = lanes_load(e->wall + i + 1);
            low = lanes_smaller(low, lanes_larger(other.q[k], wall));
            high = lanes_larger(high, lanes_smaller(other.q[k], lanes_subtract(none, wall)));
        } else {
            low = lanes_smaller(low, other.q[k]);
            high = lanes_larger(high, other.q[k]);
        }
        low = lanes_subtract(low, half);
        high = lanes_add(high, half);
        low = lanes_evens(low, low);
        high = lanes_evens(high, high);
        lanes_store_half(e->span_side[2 * k] + i / 2, low);
        lanes_store_half(e->span_side[2 * k + 1] + i / 2, high);
        if (!i) {
            lanes_store_half(first[2 * k], low);
            lanes_store_half(first[2 * k + 1], high);
        }
    }
    SC_UNROLL
    for (s = 0; s < 2; s++) {
        SC_UNROLL
        for (k = 0; k < 2; k++) {
            lanes q = lanes_load(e->at[k] + i + s + 3);
            next[2 * k] = lanes_smaller(other.q[k], q);
            next[2 * k + 1] = lanes_larger(other.q[k], q);
            other.q[k] = q;
        }
        near[s] = overlap_in_plane(box, next);
    }
    near[0] &= c->count > 3 ? edges & edges_from(c, i + 2) : 0;
    near[1] &= c->count > 4 ? edges & edges_from(c, i + 3) : 0;
    return !(near[0] | near[1]) ||
           (are_pairs_fine(c, i, 2, near[0]) && are_pairs_fine(c, i, 3, near[1]));
}

/* All edges with those next to them; and the spans of two edges, of which the first follow the last
   again, as many as are read beyond it. */
static int are_all_near_fine(sc_simple_contour *c)
{
    float first[4][SC_LANES_COUNT];
    uint32_t i;
    int k;
    c->spans = 0;
    for (i = 0; i < c->count; i += SC_CONTOUR_BLOCK)
        if (!are_near_fine(c, i, first)) return 0;
    c->spans = (c->count + 1) / 2;
    c->level = 1;
    c->span_first[1] = 0;
    for (k = 0; k < 4; k++)
        memcpy(c->edges->span_side[k] + c->spans, first[k], SC_LANES_COUNT / 2 * sizeof(float));
    return 1;
}

/* Bits of lanes in which the boxes of edges are not certainly apart. */
static inline unsigned boxes_meet(const sc_simple_contour *c, const edge_lanes *e,
                                  const edge_lanes *f)
{
    const lanes margin = lanes_all(4 * c->error);
    lanes a[4], b[4];
    int k;
    SC_UNROLL
    for (k = 0; k < 2; k++) {
        a[2 * k] = lanes_subtract(lanes_smaller(e->p[k], e->q[k]), margin);
        a[2 * k + 1] = lanes_add(lanes_larger(e->p[k], e->q[k]), margin);
        b[2 * k] = lanes_smaller(f->p[k], f->q[k]);
        b[2 * k + 1] = lanes_larger(f->p[k], f->q[k]);
    }
    return overlap_in_plane(a, b);
}

/* The edges of two spans, four each or less, that do not follow each other. */
static int are_few_fine(sc_simple_contour *c, uint32_t i, uint32_t j, uint32_t most)
{
    static const uint16_t four_times[16] = {0x0000, 0x000f, 0x00f0, 0x00ff, 0x0f00, 0x0f0f,
                                            0x0ff0, 0x0fff, 0xf000, 0xf00f, 0xf0f0, 0xf0ff,
                                            0xff00, 0xff0f, 0xfff0, 0xffff};
    const sc_contour_edges *e = c->edges;
    unsigned own_edges = first_lanes(c->count - i < most ? c->count - i : most);
    unsigned other_edges = first_lanes(c->count - j < most ? c->count - j : most), near;
    edge_lanes own, other;
    int k;
    own_edges &= edges_from(c, i);
    other_edges &= edges_from(c, j);
    near = four_times[own_edges] & other_edges * 0x1111u;
    for (k = 0; k < 2; k++) {
        own.p[k] = lanes_each_four(e->at[k] + i);
        own.q[k] = lanes_each_four(e->at[k] + i + 1);
        other.p[k] = lanes_four(e->at[k] + j);
        other.q[k] = lanes_four(e->at[k] + j + 1);
    }
    near &= boxes_meet(c, &own, &other);
    if (!near) return 1;
    for (near &= ~lie_apart(c->error, &own, &other); near; near &= near - 1) {
        unsigned pair = sc_bits_lowest(near);
        if (!sc_simple_are_apart(c, i + pair / 4, j + pair % 4)) return 0;
    }
    return 1;
}

/* Two spans of 2^level edges that overlap and do not follow each other. */
static int are_spans_fine(sc_simple_contour *c, uint32_t level, uint32_t a, uint32_t b)
{
    float *const *side = c->edges->span_side;
    uint32_t first, count, i, j;
    if (level <= 2) return are_few_fine(c, a << level, b << level, 1u << level);
    level--;
    first = c->span_first[level];
    count = ((c->count - 1) >> level) + 1;
    for (i = 2 * a; i < 2 * a + 2 && i < count; i++)
        for (j = 2 * b; j < 2 * b + 2 && j < count; j++) {
            uint32_t p = first + i, q = first + j;
            if (side[SC_LOW_X][p] <= side[SC_HIGH_X][q] &&
                side[SC_LOW_X][q] <= side[SC_HIGH_X][p] &&
                side[SC_LOW_Y][p] <= side[SC_HIGH_Y][q] &&
                side[SC_LOW_Y][q] <= side[SC_HIGH_Y][p] && !are_spans_fine(c, level, i, j))
                return 0;
        }
    return 1;
}

/* Some of sixteen spans of 2^level edges, of so many, and those `on` places further on. */
static int are_some_fine(sc_simple_contour *c, uint32_t level, uint32_t count, uint32_t i,
                         uint32_t on, unsigned some)
{
    for (; some; some &= some - 1) {
        uint32_t a = i + sc_bits_lowest(some);
        if (!are_spans_fine(c, level, a, (a + on) % count)) return 0;
    }
    return 1;
}

/* Bits of sixteen spans that overlap those `on` places further on. */
static inline unsigned overlap_on(float *const *side, const lanes own[4], uint32_t at)
{
    lanes other[4];
    int k;
    SC_UNROLL
    for (k = 0; k < 4; k++) other[k] = lanes_load(side[k] + at);
    return overlap_in_plane(own, other);
}

/* All spans of 2^level edges, more than SC_LANES_COUNT, with those two and three places on; and the
   spans of the next level, of two each, followed by the first again. One that is left over is
   joined with the first, which does no harm. Three places on, only spans of even number have to be
   compared: 2m + 1 and 2m + 4 lie in spans m and m + 2 of the next level, which are compared there;
   to leave the odd ones out would save nothing where no boxes overlap. */
static int is_level_fine(sc_simple_contour *c)
{
    const uint32_t level = c->level++;
    float *const *side = c->edges->span_side;
    float start[4][SC_LANES_COUNT];
    const uint32_t first = c->span_first[level], count = c->spans;
    const uint32_t next = first + SC_CONTOUR_SPANS(count);
    uint32_t i, k;
    for (i = 0; i < count; i += SC_LANES_COUNT) {
        const unsigned spans = first_lanes(count - i);
        lanes own[4];
        unsigned near[2];
        SC_UNROLL
        for (k = 0; k < 4; k++) {
            lanes even, odd;
            own[k] = lanes_load(side[k] + first + i);
            even = lanes_evens(own[k], own[k]);
            odd = lanes_odds(own[k], own[k]);
            even = k % 2 ? lanes_larger(even, odd) : lanes_smaller(even, odd);
            lanes_store_half(side[k] + next + i / 2, even);
            if (!i) lanes_store_half(start[k], even);
        }
        near[0] = spans & overlap_on(side, own, first + i + 2);
        near[1] = spans & overlap_on(side, own, first + i + 3);
        if ((near[0] | near[1]) && !(are_some_fine(c, level, count, i, 2, near[0]) &&
                                     are_some_fine(c, level, count, i, 3, near[1])))
            return 0;
    }
    c->span_first[level + 1] = next;
    c->spans = (count + 1) / 2;
    for (k = 0; k < 4; k++)
        memcpy(side[k] + next + c->spans, start[k], SC_LANES_COUNT / 2 * sizeof(float));
    return 1;
}

/* The spans of the last level, all pairs. */
static int is_last_level_fine(sc_simple_contour *c, uint32_t level, uint32_t count)
{
    float *const *side = c->edges->span_side;
    const uint32_t first = c->span_first[level];
    const unsigned spans = first_lanes(count);
    unsigned near[SC_LANES_COUNT / 2 + 1], any = 0;
    lanes own[4];
    uint32_t s, k;
    SC_UNROLL
    for (k = 0; k < 4; k++) own[k] = lanes_load(side[k] + first);
    SC_UNROLL
    for (s = 2; s <= SC_LANES_COUNT / 2; s++) {
        unsigned some = 2 * s <= count ? spans : 0;
        near[s] = some & overlap_on(side, own, first + s);
        any |= near[s];
    }
    for (s = 2; any && s <= SC_LANES_COUNT / 2; s++)
        if (!are_some_fine(c, level, count, 0, s, near[s])) return 0;
    return 1;
}

/* Whether sc_simple_are_apart is true of all pairs of edges. */
static int look_at_edges(sc_simple_contour *c)
{
    if (!are_all_near_fine(c)) return 0;
    while (c->spans > SC_LANES_COUNT)
        if (!is_level_fine(c)) return 0;
    return !c->spans || is_last_level_fine(c, c->level, c->spans);
}
