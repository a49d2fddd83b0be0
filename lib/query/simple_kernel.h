/*
 * The inner loops of the exact contour test. See simple.h.
 *
 * SPDX-License-Identifier: MIT
 *
 * Edges are compared sixteen at a time with those that follow them at a distance of up to seven in the list. That
 * covers all pairs within a run of four edges and with the next run; further runs are compared by their boxes, and
 * where these overlap, edge by edge. Pairs that cannot be told apart here are few and go to sc_simple_are_apart.
 */

/* Places of the listed points, and the error of their coordinates, see choose_axes in simple.c. */
static void SC_KERNEL(project)(sc_simple_contour *c, const sc_workspace *w)
{
    const sc_contour_edges *e = c->edges;
    lanes size = lanes_all(0), d[3], at;
    uint32_t i;
    int k;
    /* one block more, for the ends of the last edges */
    for (i = 0; i < (c->blocks + 1) * SC_CONTOUR_BLOCK; i += SC_CONTOUR_BLOCK) {
        float unit[3 * SC_CONTOUR_BLOCK];
        SC_KERNEL(load_points)(w, e->point + i, unit);
        for (k = 0; k < 3; k++) {
            d[k] = lanes_subtract(lanes_load(unit + SC_CONTOUR_BLOCK * k), lanes_all(c->from[k]));
            size = lanes_larger(size, lanes_absolute(d[k]));
        }
        for (k = 0; k < 2; k++) {
            at = lanes_add(lanes_add(lanes_multiply(lanes_all(c->axis[k][0]), d[0]),
                                     lanes_multiply(lanes_all(c->axis[k][1]), d[1])),
                           lanes_multiply(lanes_all(c->axis[k][2]), d[2]));
            lanes_store(e->at[k] + i, at);
        }
    }
    c->error = 3.01e-8f + 4.1f * 5.9604644775390625e-8f * lanes_most(size);
}

/* Sixteen edges, from p to q. */
typedef struct SC_KERNEL(sc_edge_lanes) {
    lanes p[2], q[2];
} SC_KERNEL(sc_edge_lanes);

static inline lanes SC_KERNEL(cross_in_plane)(const lanes a[2], const lanes b[2])
{
    return lanes_subtract(lanes_multiply(a[0], b[1]), lanes_multiply(a[1], b[0]));
}

static inline lanes SC_KERNEL(size_in_plane)(const lanes a[2])
{
    return lanes_add(lanes_absolute(a[0]), lanes_absolute(a[1]));
}

/* What a cross product of vectors with this sum of sizes is off by, see bound_of in simple.c. */
static inline lanes SC_KERNEL(bound_in_plane)(const sc_simple_contour *c, lanes size)
{
    return lanes_add(lanes_multiply(lanes_all(SC_SIMPLE_BOUND * c->error),
                                    lanes_add(size, lanes_all(4 * c->error))),
                     lanes_all(FLT_MIN));
}

/* Bits of lanes in which both a and b are above bound, or both below -bound. */
static inline unsigned SC_KERNEL(one_side)(lanes a, lanes b, lanes bound)
{
    return lanes_bits(lanes_below(bound, lanes_smaller(a, b))) |
           lanes_bits(lanes_below(lanes_larger(a, b), lanes_subtract(lanes_all(0), bound)));
}

/*
 * Bits of the edges e that are certainly apart from f, as one is on one side of the other's line. The sizes of an edge and
 * of a vector from its line to an end of the other edge, of which bound_of wants the sum, are at most
 * those of both edges and of the vector from p to p, but for a rounding that is in the bound's slack. Edges that
 * share a point are not apart: then one of each two products is 0.
 */
static inline unsigned SC_KERNEL(lie_apart)(const sc_simple_contour *c,
                                            const SC_KERNEL(sc_edge_lanes) * e,
                                            const SC_KERNEL(sc_edge_lanes) * f)
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
    bound = SC_KERNEL(bound_in_plane)(
        c, lanes_add(lanes_add(SC_KERNEL(size_in_plane)(along), SC_KERNEL(size_in_plane)(other)),
                     SC_KERNEL(size_in_plane)(pp)));
    return SC_KERNEL(one_side)(SC_KERNEL(cross_in_plane)(along, pp),
                               SC_KERNEL(cross_in_plane)(along, pq), bound) |
           SC_KERNEL(one_side)(SC_KERNEL(cross_in_plane)(other, pp),
                               SC_KERNEL(cross_in_plane)(other, qp), bound);
}

/*
 * Bits of edges that may fold back on the next, of those for which that is asked. See is_open in simple.c: with
 * a = -v and b = w, a x b != 0 or a . b < 0 for certain.
 */
static inline unsigned SC_KERNEL(folds)(const sc_simple_contour *c,
                                        const SC_KERNEL(sc_edge_lanes) * e, const lanes next[2],
                                        unsigned asked)
{
    lanes v[2], w[2], bound, dot;
    int k;
    for (k = 0; k < 2; k++) {
        v[k] = lanes_subtract(e->q[k], e->p[k]);
        w[k] = lanes_subtract(next[k], e->q[k]);
    }
    bound = SC_KERNEL(bound_in_plane)(
        c, lanes_add(SC_KERNEL(size_in_plane)(v), SC_KERNEL(size_in_plane)(w)));
    dot = lanes_add(lanes_multiply(v[0], w[0]), lanes_multiply(v[1], w[1]));
    asked &= ~lanes_bits(lanes_below(bound, dot));
    return asked ? asked & ~lanes_bits(
                               lanes_below(bound, lanes_absolute(SC_KERNEL(cross_in_plane)(v, w))))
                 : 0;
}

/* Sixteen edges and those that follow, at a distance of up to SC_CONTOUR_NEAR; and the boxes of their runs,
   two errors larger than computed: one for the places of points, and one, 2^-24 of a coordinate or more, for
   the rounding here. What is no edge is in the boxes, which does no harm. */
static int SC_KERNEL(are_near_fine)(sc_simple_contour *c, uint32_t block)
{
    const sc_contour_edges *e = c->edges;
    const lanes margin = lanes_all(2 * c->error);
    uint32_t i = block * SC_CONTOUR_BLOCK, s;
    unsigned edges = e->is_edge[block], following = edges | (unsigned)e->is_edge[block + 1] << 16;
    SC_KERNEL(sc_edge_lanes) own, other;
    lanes low[2], high[2];
    int k;
    for (k = 0; k < 2; k++) {
        own.p[k] = lanes_load(e->at[k] + i);
        own.q[k] = lanes_load(e->at[k] + i + 1);
        other.q[k] = lanes_load(e->at[k] + i + 2);
        low[k] = lanes_subtract(lanes_smaller(own.p[k], own.q[k]), margin);
        high[k] = lanes_add(lanes_larger(own.p[k], own.q[k]), margin);
        lanes_store_least(e->run_side[2 * k] + i / SC_CONTOUR_RUN, low[k]);
        lanes_store_most(e->run_side[2 * k + 1] + i / SC_CONTOUR_RUN, high[k]);
        low[k] = lanes_subtract(low[k], margin); /* for the other edge's errors */
        high[k] = lanes_add(high[k], margin);
    }
    if (SC_KERNEL(folds)(c, &own, other.q, edges & following >> 1)) return 0;
    for (s = 2; s <= SC_CONTOUR_NEAR; s++) {
        lanes_mask overlap[2];
        unsigned near;
        for (k = 0; k < 2; k++) {
            other.p[k] = other.q[k];
            other.q[k] = lanes_load(e->at[k] + i + s + 1);
            overlap[k] = lanes_both(lanes_not_above(lanes_smaller(other.p[k], other.q[k]), high[k]),
                                    lanes_not_above(low[k], lanes_larger(other.p[k], other.q[k])));
        }
        near = lanes_bits(lanes_both(overlap[0], overlap[1])) & edges & following >> s;
        if (!near) continue;
        for (near &= ~SC_KERNEL(lie_apart)(c, &own, &other); near; near &= near - 1) {
            uint32_t edge = i + sc_bits_lowest(near);
            if (!sc_simple_are_apart(c, edge, edge + s)) return 0;
        }
    }
    return 1;
}

/* Bit k: box i of a overlaps box j + k of b, for k from 0 to 15. */
static inline unsigned SC_KERNEL(overlap_in_plane)(float *const a[4], uint32_t i, float *const b[4],
                                                   uint32_t j)
{
    lanes_mask x =
        lanes_both(lanes_not_above(lanes_all(a[SC_LOW_X][i]), lanes_load(b[SC_HIGH_X] + j)),
                   lanes_not_above(lanes_load(b[SC_LOW_X] + j), lanes_all(a[SC_HIGH_X][i])));
    lanes_mask y =
        lanes_both(lanes_not_above(lanes_all(a[SC_LOW_Y][i]), lanes_load(b[SC_HIGH_Y] + j)),
                   lanes_not_above(lanes_load(b[SC_LOW_Y] + j), lanes_all(a[SC_HIGH_Y][i])));
    return lanes_bits(lanes_both(x, y));
}

/* The edges of two runs. */
static int SC_KERNEL(are_runs_fine)(sc_simple_contour *c, uint32_t run, uint32_t other_run)
{
    static const uint16_t four_times[16] = {0x0000, 0x000f, 0x00f0, 0x00ff, 0x0f00, 0x0f0f,
                                            0x0ff0, 0x0fff, 0xf000, 0xf00f, 0xf0f0, 0xf0ff,
                                            0xff00, 0xff0f, 0xfff0, 0xffff};
    const sc_contour_edges *e = c->edges;
    uint32_t i = run * SC_CONTOUR_RUN, j = other_run * SC_CONTOUR_RUN;
    unsigned own_edges = (unsigned)e->is_edge[i / SC_CONTOUR_BLOCK] >> i % SC_CONTOUR_BLOCK & 15u;
    unsigned other_edges = (unsigned)e->is_edge[j / SC_CONTOUR_BLOCK] >> j % SC_CONTOUR_BLOCK & 15u;
    unsigned near = four_times[own_edges] & other_edges * 0x1111u;
    SC_KERNEL(sc_edge_lanes) own, other;
    int k;
    for (k = 0; k < 2; k++) {
        own.p[k] = lanes_each_four(e->at[k] + i);
        own.q[k] = lanes_each_four(e->at[k] + i + 1);
        other.p[k] = lanes_four(e->at[k] + j);
        other.q[k] = lanes_four(e->at[k] + j + 1);
    }
    for (near &= ~SC_KERNEL(lie_apart)(c, &own, &other); near; near &= near - 1) {
        unsigned pair = sc_bits_lowest(near);
        if (!sc_simple_are_apart(c, i + pair / 4, j + pair % 4)) return 0;
    }
    return 1;
}

/* A run and some of sixteen runs from another on. */
static int SC_KERNEL(are_far_fine)(sc_simple_contour *c, uint32_t run, uint32_t first,
                                   unsigned some)
{
    float *const *run_side = c->edges->run_side;
    for (some &= SC_KERNEL(overlap_in_plane)(run_side, run, run_side, first); some;
         some &= some - 1)
        if (!SC_KERNEL(are_runs_fine)(c, run, first + sc_bits_lowest(some))) return 0;
    return 1;
}

/* Runs that do not follow each other, in groups of sixteen, first by the boxes of groups. */
static int SC_KERNEL(are_groups_fine)(sc_simple_contour *c)
{
    const sc_contour_edges *e = c->edges;
    uint32_t runs = (c->count + SC_CONTOUR_RUN - 1) / SC_CONTOUR_RUN, groups = (runs + 15) / 16;
    uint32_t a, b, k, r;
    for (k = 0; k < 4; k++) {
        /* the last group is full, of boxes that overlap nothing; and so is one of groups */
        const lanes nothing = lanes_all(k % 2 ? -HUGE_VALF : HUGE_VALF);
        lanes_store(e->run_side[k] + runs, nothing);
        for (a = 0; a < groups && groups > 1; a++) {
            lanes sides = lanes_load(e->run_side[k] + 16 * a);
            e->group_side[k][a] = k % 2 ? lanes_most(sides) : lanes_least(sides);
        }
        lanes_store(e->group_side[k] + groups, nothing);
    }
    for (a = 0; a < groups; a++) {
        uint32_t end = runs - 16 * a < 16 ? runs - 16 * a : 16;
        for (r = 0; r + 2 < end; r++)
            if (!SC_KERNEL(are_far_fine)(c, 16 * a + r, 16 * a, 0xfffcu << r & 0xffffu)) return 0;
        for (b = a + 1; b < groups; b += 16) {
            unsigned others = SC_KERNEL(overlap_in_plane)(e->group_side, a, e->group_side, b);
            for (; others; others &= others - 1) {
                uint32_t other = b + sc_bits_lowest(others);
                unsigned rows =
                    SC_KERNEL(overlap_in_plane)(e->group_side, other, e->run_side, 16 * a);
                for (; rows; rows &= rows - 1) {
                    r = sc_bits_lowest(rows);
                    if (!SC_KERNEL(are_far_fine)(c, 16 * a + r, 16 * other,
                                                 r == 15 && other == a + 1 ? 0xfffeu : 0xffffu))
                        return 0;
                }
            }
        }
    }
    return 1;
}

static int SC_KERNEL(are_edges_fine)(sc_simple_contour *c)
{
    uint32_t a;
    for (a = 0; a < c->blocks; a++)
        if (!SC_KERNEL(are_near_fine)(c, a)) return 0;
    return SC_KERNEL(are_groups_fine)(c);
}
