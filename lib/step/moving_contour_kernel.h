/*
 * The inner loops of the exact contour test over a step. See moving_contour.h.
 *
 * SPDX-License-Identifier: MIT
 *
 * Pairs of edges are gone through as query/simple_kernel.h does: sixteen edges with those that
 * follow at a distance of up to SC_CONTOUR_NEAR, then runs by their boxes at both ends of the step.
 * Where pairs are left out that are near on the mesh, edges of one chain that follow each other so
 * nearly may come nearer.
 *
 * ends is 2, or 1 where nothing moves, as in a search for what is near: then only the start is
 * written and read, which takes about half the time.
 */

/* Places of the listed points at both ends, and the error of their coordinates, see choose_axes in
   query/simple.c. */
static SC_INLINE void project_ends(sc_moving_contour *c, const float *unit, const int ends)
{
    const sc_contour_edges *e = c->start.edges;
    lanes size = lanes_all(0), d[3];
    uint32_t i, j;
    int k, end;
    for (i = 0; i < (c->start.blocks + 1) * SC_CONTOUR_BLOCK; i += SC_CONTOUR_BLOCK)
        for (end = 0; end < ends; end++) {
            float *const *to = end ? c->end->at : e->at;
            const float *from = end ? c->from : c->start.from, *point[SC_CONTOUR_BLOCK];
            for (j = 0; j < SC_CONTOUR_BLOCK; j++)
                point[j] = unit + 8 * (uint64_t)e->point[i + j] + 4 * end;
            lanes_points(point, &d[0], &d[1], &d[2]);
            for (k = 0; k < 3; k++) {
                d[k] = lanes_subtract(d[k], lanes_all(from[k]));
                size = lanes_larger(size, lanes_absolute(d[k]));
            }
            for (k = 0; k < 2; k++) {
                const float *axis = c->start.axis[k];
                lanes at = lanes_add(lanes_add(lanes_multiply(lanes_all(axis[0]), d[0]),
                                               lanes_multiply(lanes_all(axis[1]), d[1])),
                                     lanes_multiply(lanes_all(axis[2]), d[2]));
                lanes_store(to[k] + i, at);
            }
        }
    c->start.error = sc_bounds_contour(lanes_most(size));
}

/* Sixteen moving edges, from p to q, at the start and at the end. */
typedef struct moving_lanes {
    lanes p[2][2], q[2][2];
} moving_lanes;

/* m . p for both points of an edge at one end of the step: the least and the greatest. */
static inline void extent_along(const lanes m[2], const moving_lanes *e, int end, lanes *least,
                                lanes *most)
{
    lanes p = lanes_add(lanes_multiply(m[0], e->p[end][0]), lanes_multiply(m[1], e->p[end][1]));
    lanes q = lanes_add(lanes_multiply(m[0], e->q[end][0]), lanes_multiply(m[1], e->q[end][1]));
    *least = lanes_smaller(p, q);
    *most = lanes_larger(p, q);
}

/* At least the length of (m.x reach.x, m.y reach.y), see moving_contour.c. */
static inline lanes reach_along(const float reach[2], const lanes m[2])
{
    const lanes x = lanes_multiply(lanes_absolute(m[0]), lanes_all(reach[0]));
    const lanes y = lanes_multiply(lanes_absolute(m[1]), lanes_all(reach[1]));
    return lanes_add(lanes_larger(x, y), lanes_multiply(lanes_all(0.41422f), lanes_smaller(x, y)));
}

/* How far apart along m two computed points may be whose places are the same. */
static inline lanes known_along(float known, const lanes m[2])
{
    const lanes size = lanes_add(lanes_absolute(m[0]), lanes_absolute(m[1]));
    return lanes_add(lanes_multiply(size, lanes_all(known)), lanes_all(16 * FLT_MIN));
}

/* Bits of the edges e that are clear of f along m: beyond it, or on this side if that counts. */
static SC_INLINE unsigned are_apart_along(const sc_moving_contour *c, const lanes m[2],
                                          const moving_lanes *e, const moving_lanes *f,
                                          const int ends)
{
    const lanes clear = lanes_add(known_along(c->known, m), reach_along(c->reach, m));
    lanes e_least[2], e_most[2], f_least[2], f_most[2], above, below;
    int end;
    for (end = 0; end < ends; end++) {
        extent_along(m, e, end, &e_least[end], &e_most[end]);
        extent_along(m, f, end, &f_least[end], &f_most[end]);
    }
    above = lanes_subtract(f_least[0], e_most[0]);
    below = lanes_subtract(e_least[0], f_most[0]);
    if (ends > 1) {
        above = lanes_smaller(above, lanes_subtract(f_least[1], e_most[1]));
        below = lanes_smaller(below, lanes_subtract(e_least[1], f_most[1]));
    }
    return lanes_bits(lanes_below(clear, above)) | lanes_bits(lanes_below(clear, below));
}

/* A coordinate of a point at both ends together: directions are made of these, whose length does
   not matter. */
static inline lanes both_ends(const lanes at[2][2], int k, const int ends)
{
    return ends == 1 ? at[0][k] : lanes_add(at[0][k], at[1][k]);
}

/* Bits of the edges e that are clear of f for certain, along the way from middle to middle or
   across one of the two. */
static SC_INLINE unsigned are_apart(const sc_moving_contour *c, const moving_lanes *e,
                                    const moving_lanes *f, unsigned asked, const int ends)
{
    lanes m[2];
    unsigned left;
    int k;
    for (k = 0; k < 2; k++)
        m[k] = lanes_subtract(lanes_add(both_ends(f->p, k, ends), both_ends(f->q, k, ends)),
                              lanes_add(both_ends(e->p, k, ends), both_ends(e->q, k, ends)));
    left = asked & ~are_apart_along(c, m, e, f, ends);
    if (!left) return asked;
    m[0] = lanes_subtract(both_ends(e->q, 1, ends), both_ends(e->p, 1, ends));
    m[1] = lanes_subtract(both_ends(e->p, 0, ends), both_ends(e->q, 0, ends));
    left &= ~are_apart_along(c, m, e, f, ends);
    if (!left) return asked;
    m[0] = lanes_subtract(both_ends(f->q, 1, ends), both_ends(f->p, 1, ends));
    m[1] = lanes_subtract(both_ends(f->p, 0, ends), both_ends(f->q, 0, ends));
    return asked & ~(left & ~are_apart_along(c, m, e, f, ends));
}

/* Bits of the edges e that are clear along m of the edges f, which come so many edges after them,
   at least 2 and fewer than there are rings. Points with n edges between them are to be n - 1
   altitudes apart: for each edge of those between there is one in clear, and the far ends are moved
   nearer by one. */
static SC_INLINE unsigned are_apart_on_mesh_along(const sc_moving_contour *c, const lanes m[2],
                                                  const moving_lanes *e, const moving_lanes *f,
                                                  uint32_t edges, const int ends)
{
    const lanes altitude = reach_along(c->altitude, m);
    const lanes clear =
        lanes_add(known_along(c->open, m), lanes_multiply(lanes_all((float)edges - 2), altitude));
    lanes above = lanes_all(0), below = above;
    int end;
    for (end = 0; end < ends; end++) {
        const lanes far_e =
            lanes_add(lanes_multiply(m[0], e->p[end][0]), lanes_multiply(m[1], e->p[end][1]));
        const lanes near_e =
            lanes_add(lanes_multiply(m[0], e->q[end][0]), lanes_multiply(m[1], e->q[end][1]));
        const lanes near_f =
            lanes_add(lanes_multiply(m[0], f->p[end][0]), lanes_multiply(m[1], f->p[end][1]));
        const lanes far_f =
            lanes_add(lanes_multiply(m[0], f->q[end][0]), lanes_multiply(m[1], f->q[end][1]));
        const lanes up = lanes_subtract(lanes_smaller(near_f, lanes_subtract(far_f, altitude)),
                                        lanes_larger(near_e, lanes_add(far_e, altitude)));
        const lanes down = lanes_subtract(lanes_smaller(near_e, lanes_subtract(far_e, altitude)),
                                          lanes_larger(near_f, lanes_add(far_f, altitude)));
        above = end ? lanes_smaller(above, up) : up;
        below = end ? lanes_smaller(below, down) : down;
    }
    return lanes_bits(lanes_below(clear, lanes_larger(above, below)));
}

/* The same along the way from middle to middle, or across one of the two. */
static SC_INLINE unsigned are_apart_on_mesh(const sc_moving_contour *c, const moving_lanes *e,
                                            const moving_lanes *f, uint32_t edges, const int ends)
{
    lanes m[2];
    unsigned apart;
    int k;
    for (k = 0; k < 2; k++)
        m[k] = lanes_subtract(lanes_add(both_ends(f->p, k, ends), both_ends(f->q, k, ends)),
                              lanes_add(both_ends(e->p, k, ends), both_ends(e->q, k, ends)));
    apart = are_apart_on_mesh_along(c, m, e, f, edges, ends);
    m[0] = lanes_subtract(both_ends(e->q, 1, ends), both_ends(e->p, 1, ends));
    m[1] = lanes_subtract(both_ends(e->p, 0, ends), both_ends(e->q, 0, ends));
    apart |= are_apart_on_mesh_along(c, m, e, f, edges, ends);
    m[0] = lanes_subtract(both_ends(f->q, 1, ends), both_ends(f->p, 1, ends));
    m[1] = lanes_subtract(both_ends(f->p, 0, ends), both_ends(f->q, 0, ends));
    return apart | are_apart_on_mesh_along(c, m, e, f, edges, ends);
}

/* The lesser of m . v and m . w. */
static inline lanes along_both(const lanes m[2], const lanes v[2], const lanes w[2])
{
    return lanes_smaller(lanes_add(lanes_multiply(m[0], v[0]), lanes_multiply(m[1], v[1])),
                         lanes_add(lanes_multiply(m[0], w[0]), lanes_multiply(m[1], w[1])));
}

/* Bits of edges e that are open to the next, f, which starts where they end: both run on along the
   sum of the two. */
static SC_INLINE unsigned run_on(const sc_moving_contour *c, const moving_lanes *e,
                                 const lanes next[2][2], const int ends)
{
    lanes v[2][2], w[2][2], m[2], least;
    int k, end;
    for (end = 0; end < ends; end++)
        for (k = 0; k < 2; k++) {
            v[end][k] = lanes_subtract(e->q[end][k], e->p[end][k]);
            w[end][k] = lanes_subtract(next[end][k], e->q[end][k]);
        }
    for (k = 0; k < 2; k++)
        m[k] = lanes_add(both_ends((const lanes(*)[2])v, k, ends),
                         both_ends((const lanes(*)[2])w, k, ends));
    least = along_both(m, (const lanes *)v[0], (const lanes *)w[0]);
    if (ends > 1)
        least = lanes_smaller(least, along_both(m, (const lanes *)v[1], (const lanes *)w[1]));
    return lanes_bits(
        lanes_below(lanes_add(known_along(c->known, m), reach_along(c->altitude, m)), least));
}

/* Boxes of the runs of sixteen edges at one end of the step, each larger by half the clearance.
   What is no edge is in them, which does no harm. */
static inline void enclose_runs(const sc_moving_contour *c, uint32_t i, int end,
                                const moving_lanes *e)
{
    float *const *side = end ? c->end->run_side : c->start.edges->run_side;
    int k;
    for (k = 0; k < 2; k++) {
        lanes margin = lanes_all(0.5f * c->clear[k]);
        lanes_store_least(side[2 * k] + i / SC_CONTOUR_RUN,
                          lanes_subtract(lanes_smaller(e->p[end][k], e->q[end][k]), margin));
        lanes_store_most(side[2 * k + 1] + i / SC_CONTOUR_RUN,
                         lanes_add(lanes_larger(e->p[end][k], e->q[end][k]), margin));
    }
}

static SC_INLINE int are_near_clear(sc_moving_contour *c, uint32_t block, const int ends)
{
    const sc_contour_edges *e = c->start.edges;
    uint32_t i = block * SC_CONTOUR_BLOCK, s;
    unsigned edges = e->is_edge[block], following = edges | (unsigned)e->is_edge[block + 1] << 16;
    moving_lanes own, other;
    unsigned left, chained; /* the latter: edge s on is of the same chain */
    int k, end;
    for (end = 0; end < ends; end++)
        for (k = 0; k < 2; k++) {
            const float *at = (end ? c->end->at[k] : e->at[k]) + i;
            own.p[end][k] = lanes_load(at);
            own.q[end][k] = lanes_load(at + 1);
            other.q[end][k] = lanes_load(at + 2);
        }
    for (end = 0; end < ends; end++) enclose_runs(c, i, end, &own);
    left = chained = edges & following >> 1;
    for (left &= ~run_on(c, &own, (const lanes(*)[2])other.q, ends); left; left &= left - 1) {
        uint32_t edge = i + sc_bits_lowest(left);
        if (!sc_moving_contour_are_clear(c, edge, edge + 1)) return 0;
    }
    for (s = 2; s <= SC_CONTOUR_NEAR; s++) {
        for (end = 0; end < ends; end++)
            for (k = 0; k < 2; k++) {
                other.p[end][k] = other.q[end][k];
                other.q[end][k] = lanes_load((end ? c->end->at[k] : e->at[k]) + i + s + 1);
            }
        left = edges & following >> s;
        chained &= left;
        if (s < c->rings && chained)
            left &= ~(chained & are_apart_on_mesh(c, &own, &other, s, ends));
        if (!left) continue;
        for (left &= ~are_apart(c, &own, &other, left, ends); left; left &= left - 1) {
            uint32_t edge = i + sc_bits_lowest(left);
            if (!sc_moving_contour_are_clear(c, edge, edge + s)) return 0;
        }
    }
    return 1;
}

/* The edges of two runs. */
static SC_INLINE int are_runs_clear(sc_moving_contour *c, uint32_t run, uint32_t other_run,
                                    const int ends)
{
    static const uint16_t four_times[16] = {0x0000, 0x000f, 0x00f0, 0x00ff, 0x0f00, 0x0f0f,
                                            0x0ff0, 0x0fff, 0xf000, 0xf00f, 0xf0f0, 0xf0ff,
                                            0xff00, 0xff0f, 0xfff0, 0xffff};
    const sc_contour_edges *e = c->start.edges;
    uint32_t i = run * SC_CONTOUR_RUN, j = other_run * SC_CONTOUR_RUN;
    unsigned own_edges = (unsigned)e->is_edge[i / SC_CONTOUR_BLOCK] >> i % SC_CONTOUR_BLOCK & 15u;
    unsigned other_edges = (unsigned)e->is_edge[j / SC_CONTOUR_BLOCK] >> j % SC_CONTOUR_BLOCK & 15u;
    unsigned left = four_times[own_edges] & other_edges * 0x1111u;
    moving_lanes own, other;
    int k, end;
    if (!left) return 1;
    for (end = 0; end < ends; end++)
        for (k = 0; k < 2; k++) {
            const float *at = end ? c->end->at[k] : e->at[k];
            own.p[end][k] = lanes_each_four(at + i);
            own.q[end][k] = lanes_each_four(at + i + 1);
            other.p[end][k] = lanes_four(at + j);
            other.q[end][k] = lanes_four(at + j + 1);
        }
    for (left &= ~are_apart(c, &own, &other, left, ends); left; left &= left - 1) {
        unsigned pair = sc_bits_lowest(left);
        if (!sc_moving_contour_are_clear(c, i + pair / 4, j + pair % 4)) return 0;
    }
    return 1;
}

/* Bit k: box i of a is not apart on one side from box j + k of b at both ends, for k from 0 to
   15. */
static SC_INLINE unsigned near_in_plane(float *a[2][4], uint32_t i, float *b[2][4], uint32_t j,
                                        const int ends)
{
    lanes least = lanes_all(0);
    int k;
    for (k = 0; k < 4; k += 2) {
        lanes below = lanes_subtract(lanes_all(a[0][k + 1][i]), lanes_load(b[0][k] + j));
        lanes above = lanes_subtract(lanes_load(b[0][k + 1] + j), lanes_all(a[0][k][i]));
        if (ends > 1) {
            below = lanes_larger(
                below, lanes_subtract(lanes_all(a[1][k + 1][i]), lanes_load(b[1][k] + j)));
            above = lanes_larger(
                above, lanes_subtract(lanes_load(b[1][k + 1] + j), lanes_all(a[1][k][i])));
        }
        least = lanes_smaller(least, lanes_smaller(below, above));
    }
    return ~lanes_bits(lanes_below(least, lanes_all(0))) & 0xffffu;
}

/* A run and some of sixteen runs from another on. */
static SC_INLINE int are_far_clear(sc_moving_contour *c, float *side[2][4], uint32_t run,
                                   uint32_t first, unsigned some, const int ends)
{
    for (some &= near_in_plane(side, run, side, first, ends); some; some &= some - 1)
        if (!are_runs_clear(c, run, first + sc_bits_lowest(some), ends)) return 0;
    return 1;
}

/* Runs that do not follow each other, in groups of sixteen, first by the boxes of groups. */
static SC_INLINE int are_groups_clear(sc_moving_contour *c, const int ends)
{
    const sc_contour_edges *e = c->start.edges;
    uint32_t runs = (c->start.count + SC_CONTOUR_RUN - 1) / SC_CONTOUR_RUN;
    uint32_t groups = (runs + 15) / 16, a, b, r;
    float *side[2][4], *group_side[2][4];
    int k, end;
    for (end = 0; end < ends; end++)
        for (k = 0; k < 4; k++) {
            /* the last group is full, of boxes that are near nothing; and so is one of groups */
            const lanes nothing = lanes_all(k % 2 ? -FLT_MAX : FLT_MAX);
            side[end][k] = end ? c->end->run_side[k] : e->run_side[k];
            group_side[end][k] = end ? c->end->group_side[k] : e->group_side[k];
            lanes_store(side[end][k] + runs, nothing);
            for (a = 0; a < groups && groups > 1; a++) {
                lanes sides = lanes_load(side[end][k] + 16 * a);
                group_side[end][k][a] = k % 2 ? lanes_most(sides) : lanes_least(sides);
            }
            lanes_store(group_side[end][k] + groups, nothing);
        }
    for (a = 0; a < groups; a++) {
        uint32_t end_of = runs - 16 * a < 16 ? runs - 16 * a : 16;
        for (r = 0; r + 2 < end_of; r++)
            if (!are_far_clear(c, side, 16 * a + r, 16 * a, 0xfffcu << r & 0xffffu, ends)) return 0;
        for (b = a + 1; b < groups; b += 16) {
            unsigned others = near_in_plane(group_side, a, group_side, b, ends);
            for (; others; others &= others - 1) {
                uint32_t other = b + sc_bits_lowest(others);
                unsigned rows = near_in_plane(group_side, other, side, 16 * a, ends);
                for (; rows; rows &= rows - 1) {
                    r = sc_bits_lowest(rows);
                    if (!are_far_clear(c, side, 16 * a + r, 16 * other,
                                       r == 15 && other == a + 1 ? 0xfffeu : 0xffffu, ends))
                        return 0;
                }
            }
        }
    }
    return 1;
}

static SC_INLINE int are_all_clear(sc_moving_contour *c, const int ends)
{
    uint32_t a;
    for (a = 0; a < c->start.blocks; a++)
        if (!are_near_clear(c, a, ends)) return 0;
    return are_groups_clear(c, ends);
}

static void project_motion(sc_moving_contour *c, const float *unit)
{
    if (c->ends == 1)
        project_ends(c, unit, 1);
    else
        project_ends(c, unit, 2);
}

static int are_edges_clear(sc_moving_contour *c)
{
    return c->ends == 1 ? are_all_clear(c, 1) : are_all_clear(c, 2);
}
