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

static inline void SC_KERNEL(load_edges)(const sc_simple_contour *c, uint32_t i,
                                         SC_KERNEL(sc_edge_lanes) * e)
{
    int k;
    for (k = 0; k < 2; k++) {
        e->p[k] = lanes_load(c->edges->at[k] + i);
        e->q[k] = lanes_load(c->edges->at[k] + i + 1);
    }
}

/*
 * Bits of those of sixteen edges whose boxes overlap that of the edge s places on, in near[s]. Writes the boxes of their
 * runs, two errors larger than computed: one for the places of points, and one, 2^-24 of a coordinate or
 * more, for the rounding here. What is no edge is in the boxes, which does no harm.
 */
static inline void SC_KERNEL(find_near)(const sc_simple_contour *c, uint32_t i,
                                        unsigned near[SC_CONTOUR_NEAR + 1])
{
    const sc_contour_edges *e = c->edges;
    const float *at_x = e->at[0] + i, *at_y = e->at[1] + i;
    const lanes margin = lanes_all(2 * c->error);
    lanes x = lanes_load(at_x), x2 = lanes_load(at_x + 1);
    lanes y = lanes_load(at_y), y2 = lanes_load(at_y + 1);
    lanes low_x = lanes_subtract(lanes_smaller(x, x2), margin);
    lanes low_y = lanes_subtract(lanes_smaller(y, y2), margin);
    lanes high_x = lanes_add(lanes_larger(x, x2), margin);
    lanes high_y = lanes_add(lanes_larger(y, y2), margin);
    uint32_t s;
    lanes_store_least(e->run_side[SC_LOW_X] + i / SC_CONTOUR_RUN, low_x);
    lanes_store_least(e->run_side[SC_LOW_Y] + i / SC_CONTOUR_RUN, low_y);
    lanes_store_most(e->run_side[SC_HIGH_X] + i / SC_CONTOUR_RUN, high_x);
    lanes_store_most(e->run_side[SC_HIGH_Y] + i / SC_CONTOUR_RUN, high_y);
    low_x = lanes_subtract(low_x, margin); /* for the other edge's errors */
    low_y = lanes_subtract(low_y, margin);
    high_x = lanes_add(high_x, margin);
    high_y = lanes_add(high_y, margin);
    x2 = lanes_load(at_x + 2);
    y2 = lanes_load(at_y + 2);
    for (s = 2; s <= SC_CONTOUR_NEAR; s++) {
        x = x2;
        y = y2;
        x2 = lanes_load(at_x + s + 1);
        y2 = lanes_load(at_y + s + 1);
        near[s] = lanes_bits(lanes_both(lanes_both(lanes_not_above(lanes_smaller(x, x2), high_x),
                                                   lanes_not_above(low_x, lanes_larger(x, x2))),
                                        lanes_both(lanes_not_above(lanes_smaller(y, y2), high_y),
                                                   lanes_not_above(low_y, lanes_larger(y, y2)))));
    }
}

/* Sixteen edges and those that follow, at a distance of up to SC_CONTOUR_NEAR. */
static int SC_KERNEL(are_near_fine)(sc_simple_contour *c, uint32_t block)
{
    const sc_contour_edges *e = c->edges;
    uint32_t i = block * SC_CONTOUR_BLOCK, s;
    unsigned edges = e->is_edge[block], following = edges | (unsigned)e->is_edge[block + 1] << 16;
    unsigned near[SC_CONTOUR_NEAR + 1];
    SC_KERNEL(sc_edge_lanes) own, other;
    SC_KERNEL(find_near)(c, i, near);
    SC_KERNEL(load_edges)(c, i, &own);
    SC_KERNEL(load_edges)(c, i + 1, &other);
    if (SC_KERNEL(folds)(c, &own, other.q, edges & following >> 1)) return 0;
    for (s = 2; s <= SC_CONTOUR_NEAR; s++) {
        near[s] &= edges & following >> s;
        if (!near[s]) continue;
        SC_KERNEL(load_edges)(c, i + s, &other);
        near[s] &= ~SC_KERNEL(lie_apart)(c, &own, &other);
        for (; near[s]; near[s] &= near[s] - 1) {
            uint32_t edge = i + sc_bits_lowest(near[s]);
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

/* Some of the sixteen runs of a group and all of another, or of the same: but for those that follow each other, which
   are near, and each pair once. */
static int SC_KERNEL(are_far_fine)(sc_simple_contour *c, uint32_t group, uint32_t other,
                                   unsigned some)
{
    float *const *side = c->edges->run_side;
    const lanes low_x = lanes_load(side[SC_LOW_X] + 16 * other);
    const lanes low_y = lanes_load(side[SC_LOW_Y] + 16 * other);
    const lanes high_x = lanes_load(side[SC_HIGH_X] + 16 * other);
    const lanes high_y = lanes_load(side[SC_HIGH_Y] + 16 * other);
    unsigned far[16], rest, r;
    for (rest = some; rest; rest &= rest - 1) {
        uint32_t run = 16 * group + (r = sc_bits_lowest(rest));
        far[r] = lanes_bits(
            lanes_both(lanes_both(lanes_not_above(lanes_all(side[SC_LOW_X][run]), high_x),
                                  lanes_not_above(low_x, lanes_all(side[SC_HIGH_X][run]))),
                       lanes_both(lanes_not_above(lanes_all(side[SC_LOW_Y][run]), high_y),
                                  lanes_not_above(low_y, lanes_all(side[SC_HIGH_Y][run])))));
    }
    for (rest = some; rest; rest &= rest - 1) {
        r = sc_bits_lowest(rest);
        if (group == other)
            far[r] &= 0xfffcu << r;
        else if (other == group + 1 && r == 15)
            far[r] &= 0xfffeu;
        for (; far[r]; far[r] &= far[r] - 1)
            if (!SC_KERNEL(are_runs_fine)(c, 16 * group + r, 16 * other + sc_bits_lowest(far[r])))
                return 0;
    }
    return 1;
}

/* Runs that do not follow each other, in groups of sixteen, first by the boxes of groups. */
static int SC_KERNEL(are_groups_fine)(sc_simple_contour *c)
{
    const sc_contour_edges *e = c->edges;
    uint32_t runs = (c->count + SC_CONTOUR_RUN - 1) / SC_CONTOUR_RUN, groups = (runs + 15) / 16;
    uint32_t a, b, k;
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
        if (end > 2 && !SC_KERNEL(are_far_fine)(c, a, a, (1u << (end - 2)) - 1u)) return 0;
        for (b = a + 1; b < groups; b += 16) {
            unsigned others = SC_KERNEL(overlap_in_plane)(e->group_side, a, e->group_side, b);
            for (; others; others &= others - 1) {
                uint32_t other = b + sc_bits_lowest(others);
                if (!SC_KERNEL(are_far_fine)(
                        c, a, other,
                        SC_KERNEL(overlap_in_plane)(e->group_side, other, e->run_side, 16 * a)))
                    return 0;
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
