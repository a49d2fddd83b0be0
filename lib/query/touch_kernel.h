/*
 * Whether two leaf clusters that touch in a point have only that in common: whether a plane through
 * it has all other points of one on one side and of the other on the other. See query_kernels.h.
 *
 * SPDX-License-Identifier: MIT
 *
 * Let p be the point and m a direction. If all points of one cluster but p are strictly ahead of p
 * along m, and of the other strictly behind, so is all of their triangles but p. Of three or so
 * clusters round a point two face each other there.
 *
 * The direction is any, hence has no error: with d = x - p, m . d is off by |m|1 EDGE and 4.1 v
 * (|m_0 d_0| + |m_1 d_1| + |m_2 d_2|), as in neighbor_kernel.h; to subtract a bound takes another v
 * of that. The way from the middle of one's points to that of the other's tells two of three pairs
 * apart (horse, spiky bunny and wrinkled cloth); sums of vectors from p over their squares would
 * tell four of five, but take three sums and a division more.
 */

/* From about the middle of the points of one cluster to that of another's, sixteen times. */
static inline void find_way(const float *from, const float *to, float way[3])
{
    lanes sum[2];
    float row[SC_LANES_COUNT];
    int k;
    SC_UNROLL
    for (k = 0; k < 2; k++) {
        const float *at = k ? to : from;
        sum[k] = lanes_add(
            lanes_add(lanes_load(at), lanes_load(at + SC_LANES_COUNT)),
            lanes_add(lanes_load(at + 2 * SC_LANES_COUNT), lanes_load(at + 3 * SC_LANES_COUNT)));
    }
    lanes_store(row, lanes_subtract(sum[1], sum[0]));
    SC_UNROLL
    for (k = 0; k < 3; k++) way[k] = (row[k] + row[4 + k]) + (row[8 + k] + row[12 + k]);
}

/* What a place along a direction m may be off by, where points are; and of what its products m_k
   d_k add up to, which part the rounding is. */
static inline float touch_reach(const float m[3])
{
    const float edge = SC_BOUNDS_EDGE;
    return (fabsf(m[0]) + fabsf(m[1]) + fabsf(m[2])) * (1.1f * edge) + 16 * FLT_MIN;
}
static inline lanes touch_rounding(lanes size)
{
    const float v = SC_BOUNDS_V;
    return lanes_multiply(size, lanes_all(6 * v));
}

/* The points of a cluster that are certainly ahead of p along a direction. */
static inline unsigned find_ahead(const float *at, const float m[3], const float p[3])
{
    const float reach = touch_reach(m);
    lanes x[3], along, size;
    int k;
    lanes_coordinates(at, x);
    SC_UNROLL
    for (k = 0; k < 3; k++)
        x[k] = lanes_multiply(lanes_all(m[k]), lanes_subtract(x[k], lanes_all(p[k])));
    along = lanes_add(lanes_add(x[0], x[1]), x[2]);
    size = lanes_add(lanes_add(lanes_absolute(x[0]), lanes_absolute(x[1])), lanes_absolute(x[2]));
    return lanes_bits(lanes_below(lanes_all(reach), lanes_subtract(along, touch_rounding(size))));
}

/* The lanes that a point at a place is in: if it is the last one, it fills the row. */
static inline unsigned lanes_of(unsigned place, unsigned is_last)
{
    return ((0u - is_last) | 1u) << place;
}

/* Whether two leaf clusters certainly have only the point in common that they touch in. */
static inline unsigned touch_only(const sc_worker *w, const sc_cluster_pair *pair)
{
    const unsigned touch = pair->known;
    const unsigned at_a = touch & 15u, at_b = touch >> 4 & 15u;
    const float *of_a = w->frame->point_at + 4 * SC_LEAF_POINTS * (uint64_t)pair->a;
    const float *of_b = w->frame->point_at + 4 * SC_LEAF_POINTS * (uint64_t)pair->b;
    const float *p = of_a + 4 * sc_loops_turn(at_a);
    unsigned ahead = lanes_of(at_a, touch >> SC_TOUCH_LAST & 1u);
    unsigned behind = lanes_of(at_b, touch >> SC_TOUCH_LAST_OF_OTHER & 1u);
    float m[3], back[3];
    int k;
    find_way(of_b, of_a, m);
    SC_UNROLL
    for (k = 0; k < 3; k++) back[k] = -m[k];
    ahead |= find_ahead(of_a, m, p);
    behind |= find_ahead(of_b, back, p);
    return (ahead & behind & 0xffffu) == 0xffffu;
}

/* Drops such pairs of some, of which so many touch. */
static SC_NOINLINE void drop_touching(const sc_worker *w, sc_cluster_pair *pairs,
                                      const uint32_t *touching, uint32_t count)
{
    uint32_t i;
    for (i = 0; i < count; i++) {
        sc_cluster_pair *p = pairs + touching[i];
        if (i + SC_FETCH_POINTS < count) {
            const sc_cluster_pair *next = pairs + touching[i + SC_FETCH_POINTS];
            int k;
            for (k = 0; k < 4; k++) {
                sc_fetch(w->frame->point_at +
                         SC_LEAF_POINTS * (4 * (uint64_t)next->a + (unsigned)k));
                sc_fetch(w->frame->point_at +
                         SC_LEAF_POINTS * (4 * (uint64_t)next->b + (unsigned)k));
            }
        }
        p->known |= touch_only(w, p) ? SC_CLUSTERS_DROPPED : 0u;
    }
}
