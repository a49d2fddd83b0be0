/*
 * Which candidates stay apart along a direction throughout a step, sixteen at a time. See
 * step_candidates.h.
 *
 * SPDX-License-Identifier: MIT
 *
 * If the differences from each point of one to each point of the other all have a scalar product
 * with a fixed direction m above c |m|, at the start and at the end, the two are farther apart than
 * c at all times. Points are off by POINT in each coordinate, differences by 2 POINT + u |r|, and
 * scalar products by |m|1 times that and 3.01 u |m|1 |r|, u = 2^-24 and |r| the largest coordinate
 * of a difference; |m| is at most |m|1. So products above |m|1 (c + 2.1 POINT + 5 u |r|) are
 * enough; the last term is for those that underflow. Which m are tried does not matter: the sum of
 * the differences; the common normal of the face or the two edges in the middle of the step; and
 * those of their sides and the way by which one moves past the other.
 */

/* The points of sixteen candidates of a kind, as the narrow phase takes them: where they are in the
   unit box, at the start and at the end. */
typedef struct sc_candidate_points {
    const float *unit[4][SC_LANES_COUNT];
} sc_candidate_points;

/* The points of sixteen candidates at the start or at the end, three coordinates each. */
typedef struct candidate_lanes {
    lanes at[4][3];
} candidate_lanes;

static inline void read_candidates(const sc_candidate_points *points, int end, candidate_lanes *c)
{
    const float *at[SC_LANES_COUNT];
    int i, j;
    for (i = 0; i < 4; i++) {
        for (j = 0; j < SC_LANES_COUNT; j++) at[j] = points->unit[i][j] + 4 * end;
        lanes_points(at, &c->at[i][0], &c->at[i][1], &c->at[i][2]);
    }
}

static inline lanes dot_in_space(const lanes a[3], const lanes b[3])
{
    return lanes_add(lanes_add(lanes_multiply(a[0], b[0]), lanes_multiply(a[1], b[1])),
                     lanes_multiply(a[2], b[2]));
}

/* Bits of those that are apart along m, on either side; count differences. */
static inline unsigned apart_in_space(const lanes m[3], lanes (*difference)[3], int count,
                                      lanes clear)
{
    lanes size =
        lanes_add(lanes_add(lanes_absolute(m[0]), lanes_absolute(m[1])), lanes_absolute(m[2]));
    lanes bound = lanes_add(lanes_multiply(size, clear), lanes_all(16 * FLT_MIN));
    lanes least = dot_in_space(m, (const lanes *)difference[0]), most = least;
    int i;
    for (i = 1; i < count; i++) {
        lanes dot = dot_in_space(m, (const lanes *)difference[i]);
        least = lanes_smaller(least, dot);
        most = lanes_larger(most, dot);
    }
    return lanes_bits(lanes_below(bound, least)) |
           lanes_bits(lanes_below(most, lanes_subtract(lanes_all(0), bound)));
}

static inline void cross_in_space(const lanes a[3], const lanes b[3], lanes to[3])
{
    int k;
    for (k = 0; k < 3; k++)
        to[k] = lanes_subtract(lanes_multiply(a[(k + 1) % 3], b[(k + 2) % 3]),
                               lanes_multiply(a[(k + 2) % 3], b[(k + 1) % 3]));
}

/* From point i to point j, both ends of the step together. */
static inline void side_in_space(const candidate_lanes c[2], int i, int j, lanes to[3])
{
    int k;
    for (k = 0; k < 3; k++)
        to[k] = lanes_subtract(lanes_add(c[0].at[j][k], c[1].at[j][k]),
                               lanes_add(c[0].at[i][k], c[1].at[i][k]));
}

/* How far apart the computed points must be along a direction, over its |m|1; reach is the largest
   coordinate of a difference. */
static inline lanes clear_in_space(float distance, lanes reach)
{
    return lanes_add(lanes_all(distance * 1.00001f + 2.1f * SC_BOUNDS_POINT),
                     lanes_multiply(reach, lanes_all(5 * SC_BOUNDS_V)));
}

static unsigned stay_apart(float distance, const sc_candidate_points *points, int split)
{
    candidate_lanes c[2];
    lanes difference[8][3], sum[2][3], side[3][3], m[3], reach = lanes_all(0), clear;
    int i, j, k, end, count = 0;
    unsigned apart;
    for (end = 0; end < 2; end++) {
        read_candidates(points, end, &c[end]);
        for (k = 0; k < 3; k++) sum[end][k] = lanes_all(0);
        for (i = 0; i < split; i++)
            for (j = split; j < 4; j++, count++)
                for (k = 0; k < 3; k++) {
                    lanes r = lanes_subtract(c[end].at[j][k], c[end].at[i][k]);
                    difference[count][k] = r;
                    reach = lanes_larger(reach, lanes_absolute(r));
                    sum[end][k] = lanes_add(sum[end][k], r);
                }
    }
    clear = clear_in_space(distance, reach);
    for (k = 0; k < 3; k++) m[k] = lanes_add(sum[0][k], sum[1][k]);
    apart = apart_in_space(m, difference, count, clear);
    side_in_space(c, split == 1 ? 1 : 0, split == 1 ? 2 : 1, side[0]);
    side_in_space(c, split == 1 ? 1 : 2, 3, side[1]);
    side_in_space(c, 2, 3, side[2]);
    cross_in_space((const lanes *)side[0], (const lanes *)side[1], m);
    apart |= apart_in_space(m, difference, count, clear);
    for (k = 0; k < 3; k++) sum[1][k] = lanes_subtract(sum[1][k], sum[0][k]); /* the way */
    for (i = 0; i < (split == 1 ? 3 : 2) && apart != 0xffffu; i++) {
        cross_in_space((const lanes *)sum[1], (const lanes *)side[i], m);
        apart |= apart_in_space(m, difference, count, clear);
    }
    return apart;
}
