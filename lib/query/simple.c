/*
 * The exact contour test. See simple.h.
 *
 * SPDX-License-Identifier: MIT
 *
 * All tests are in single precision on projected points, relative to a point of the contour and scaled
 * to a size of about one, and hold for every place that the true points can be at, up to a distance of
 * error in each coordinate: they say something about the contour that is, not about the one computed. Edges that
 * share no point must be apart by their boxes, or one on one side of the other's line. Blocks of
 * edges are compared by their boxes first, so that the cost is about linear.
 */
#include "query/simple.h"

#include <float.h>
#include <math.h>

#include "query/query_kernels.h"

/* Half a unit in the last place, relative: of float and of double. */
#define HALF_ULP_FLOAT 5.9604644775390625e-8f
#define HALF_ULP 1.1102230246251565e-16

/*
 * Projects the edges of a node's contour. x = U . (p - q) with U = u / (2 |u|1 radius), so that |x| <= 1,
 * and y likewise, q being a point of the contour. A computed coordinate collects the rounding of U (2), one
 * difference, one product and two additions: at most 6.01 * 2^-53 |U|1 |p - q|max, and that of the
 * conversion to float, 2^-24 |x|, or less than FLT_MIN if it underflows.
 */
static void project(sc_simple_contour *c, const sc_query_state *state,
                    const sc_projection *projection, const uint32_t *segments,
                    uint32_t segment_count)
{
    const sc_model *model = state->model;
    const sc_contour_edges *e = c->edges;
    const double *position = state->workspace->position;
    const uint32_t *points = sc_model_points(model);
    const uint32_t *first = sc_model_segment_first(model), *last = sc_model_segment_last(model);
    const double *q = position + 3 * (uint64_t)points[first[segments[0]]];
    double u[3], w[3], u_size = 0, w_size = 0, size = 0, extent = 0, error;
    double not_finite = 0; /* stays 0 unless something is NaN or infinite */
    uint32_t i, j, n = 0;
    int k;
    for (k = 0; k < 3; k++) {
        u_size += fabs(projection->u[k]);
        w_size += fabs(projection->w[k]);
    }
    for (k = 0; k < 3; k++) {
        u[k] = projection->u[k] / (2 * u_size * state->workspace->radius);
        w[k] = projection->w[k] / (2 * w_size * state->workspace->radius);
    }
    for (i = 0; i < segment_count; i++) {
        uint32_t begin = first[segments[i]], end = last[segments[i]], start = n;
        float x0 = 0, y0 = 0;
        for (j = begin; j <= end; j++) {
            const double *p = position + 3 * (uint64_t)points[j];
            double d0 = p[0] - q[0], d1 = p[1] - q[1], d2 = p[2] - q[2];
            float x = (float)(u[0] * d0 + u[1] * d1 + u[2] * d2);
            float y = (float)(w[0] * d0 + w[1] * d1 + w[2] * d2);
            double reach;
            not_finite += 0 * (double)x + 0 * (double)y;
            reach = fabs(d0) > fabs(d1) ? fabs(d0) : fabs(d1);
            reach = reach > fabs(d2) ? reach : fabs(d2);
            size = size > reach ? size : reach;
            extent = extent > fabs((double)x) ? extent : fabs((double)x);
            extent = extent > fabs((double)y) ? extent : fabs((double)y);
            if (j > begin) {
                e->from[0][n] = x0;
                e->from[1][n] = y0;
                e->to[0][n] = x;
                e->to[1][n] = y;
                e->point[0][n] = points[j - 1];
                e->point[1][n] = points[j];
                if (c->in_pieces) e->piece[n] = start;
                n++;
            }
            x0 = x;
            y0 = y;
        }
    }
    c->count = n;
    /* |U|1 and |W|1 are 1 / (2 radius) */
    error = 1.001 * (double)HALF_ULP_FLOAT * extent +
            7 * HALF_ULP * (size / (2 * state->workspace->radius)) + 2 * (double)FLT_MIN +
            not_finite;
    c->error = (float)(1.001 * error);
}

/* Boxes of edges and blocks, two errors larger than computed: one for the places of points, and one,
   2^-24 of the coordinate or more, for the rounding here. */
static void enclose(sc_simple_contour *c)
{
    const sc_contour_edges *e = c->edges;
    float margin = 2 * c->error;
    uint32_t i, b, k;
    c->blocks = (c->count + SC_CONTOUR_BLOCK - 1) / SC_CONTOUR_BLOCK;
    for (k = 0; k < 2; k++) {
        const float *from = e->from[k], *to = e->to[k];
        float *low = e->side[2 * k], *high = e->side[2 * k + 1];
        for (i = 0; i < c->count; i++) {
            low[i] = (from[i] < to[i] ? from[i] : to[i]) - margin;
            high[i] = (from[i] < to[i] ? to[i] : from[i]) + margin;
        }
        for (; i < c->blocks * SC_CONTOUR_BLOCK; i++) { /* nothing overlaps these */
            low[i] = HUGE_VALF;
            high[i] = -HUGE_VALF;
        }
        for (b = 0; b < c->blocks; b++) {
            float l = HUGE_VALF, h = -HUGE_VALF;
            for (i = b * SC_CONTOUR_BLOCK; i < (b + 1) * SC_CONTOUR_BLOCK; i++) {
                l = low[i] < l ? low[i] : l;
                h = high[i] > h ? high[i] : h;
            }
            e->block_side[2 * k][b] = l;
            e->block_side[2 * k + 1][b] = h;
        }
        for (; b < c->blocks + SC_CONTOUR_BLOCK; b++) {
            e->block_side[2 * k][b] = HUGE_VALF;
            e->block_side[2 * k + 1][b] = -HUGE_VALF;
        }
    }
}

typedef struct vector2 {
    float x, y;
} vector2;

/*
 * Vectors between computed points are off by 2 error, and by the rounding of a difference, at most
 * 2^-23 of the largest coordinate, another 2 error: 4 error in all. A cross or dot product of a and b is then off
 * by 4 error (|a|1 + |b|1) + 32 error^2, and by its own rounding, 2.1 * 2^-24 |a|1 |b|max or less, which is below
 * 4.2 error |a|1 as b is at most two coordinates long.
 */
static inline float bound_of(vector2 a, vector2 b, float error)
{
    return 12 * error * (fabsf(a.x) + fabsf(a.y) + fabsf(b.x) + fabsf(b.y) + 4 * error) + FLT_MIN;
}

/* The certain sign of a x b, 0 if there is none. */
static inline int turn(vector2 a, vector2 b, float error)
{
    float cross = a.x * b.y - a.y * b.x, bound = bound_of(a, b, error);
    return (cross > bound) - (cross < -bound);
}

static inline vector2 edge_end(const sc_simple_contour *c, uint32_t i, int end)
{
    vector2 v;
    v.x = end ? c->edges->to[0][i] : c->edges->from[0][i];
    v.y = end ? c->edges->to[1][i] : c->edges->from[1][i];
    return v;
}

static inline vector2 minus(vector2 a, vector2 b)
{
    a.x -= b.x;
    a.y -= b.y;
    return a;
}

/* Whether edge j is certainly on one side of the line of edge i. */
static int is_beside(const sc_simple_contour *c, uint32_t i, uint32_t j)
{
    vector2 from = edge_end(c, i, 0), along = minus(edge_end(c, i, 1), from);
    return turn(along, minus(edge_end(c, j, 0), from), c->error) *
               turn(along, minus(edge_end(c, j, 1), from), c->error) >
           0;
}

/* Whether two edges that share a point, the given end of each, certainly do not overlap beyond it. */
static int is_open(const sc_simple_contour *c, uint32_t i, int end_i, uint32_t j, int end_j)
{
    vector2 at = edge_end(c, i, end_i);
    vector2 a = minus(edge_end(c, i, 1 - end_i), at), b = minus(edge_end(c, j, 1 - end_j), at);
    return turn(a, b, c->error) != 0 || a.x * b.x + a.y * b.y < -bound_of(a, b, c->error);
}

static uint32_t piece_of(const sc_simple_contour *c, uint32_t i)
{
    uint32_t *piece = c->edges->piece;
    while (piece[i] != i) i = piece[i] = piece[piece[i]];
    return i;
}

int sc_simple_are_apart(sc_simple_contour *c, uint32_t i, uint32_t j)
{
    uint32_t a = c->edges->point[0][i], b = c->edges->point[1][i], k;
    uint32_t p = c->edges->point[0][j], q = c->edges->point[1][j];
    int shared = (a == p) + (a == q) + (b == p) + (b == q);
    if (!shared) return is_beside(c, i, j) || is_beside(c, j, i);
    if (shared > 1 || !is_open(c, i, b == p || b == q, j, a == q || b == q)) return 0;
    if (c->in_pieces) c->edges->piece[piece_of(c, i)] = piece_of(c, j);
    if (a == p) { /* the contour leaves the point twice */
        for (k = 0; k < c->pinch_count && c->pinch[k] != a; k++) {
        }
        if (k == SC_PINCHES_MAX) return 0;
        c->pinch[k] = a;
        if (k == c->pinch_count) c->pinch_count++;
    }
    return 1;
}

/*
 * Where the contour passes a point twice, its four edges must alternate round the point, one in, one
 * out: else it crosses itself there. That is so if just one of those that come in is between the two
 * that go out. More than four are not looked at.
 */
static int is_pinch_fine(const sc_simple_contour *c, uint32_t point)
{
    vector2 direction[2][2]; /* out, in */
    uint32_t i, count[2] = {0, 0}, between = 0;
    int end, out, one, other;
    for (i = 0; i < c->count; i++)
        for (end = 0; end < 2; end++) {
            if (c->edges->point[end][i] != point) continue;
            if (count[end] == 2) return 0;
            direction[end][count[end]++] = minus(edge_end(c, i, 1 - end), edge_end(c, i, end));
        }
    out = turn(direction[0][0], direction[0][1], c->error);
    if (count[1] != 2 || !out) return 0;
    for (i = 0; i < 2; i++) { /* between, on the side where they make less than a half turn */
        one = turn(direction[0][0], direction[1][i], c->error);
        other = turn(direction[1][i], direction[0][1], c->error);
        if (one * other == 0 && one != -out && other != -out) return 0;
        between += one == out && other == out;
    }
    return between == 1;
}

/* How often the edges of other pieces go round a point of one; a number that cannot be if that is not
   certain. They pass it at a distance. */
static int winding(const sc_simple_contour *c, uint32_t piece, vector2 at)
{
    uint32_t i;
    int sum = 0;
    for (i = 0; i < c->count; i++) {
        vector2 from = edge_end(c, i, 0), to = edge_end(c, i, 1);
        int side;
        if ((from.y <= at.y) == (to.y <= at.y) || piece_of(c, i) == piece) continue;
        side = turn(minus(to, from), minus(at, from), c->error);
        if (!side) return 1 << 20;
        if (from.y <= at.y)
            sum += side > 0;
        else
            sum -= side < 0;
    }
    return sum;
}

/*
 * The contour winds round the points beside a piece once more on its left than on its right; as the
 * other pieces wind round it n times, those are n + 1 and n if it runs counter-clockwise, else n and n - 1. That
 * must be 1 and 0.
 */
static int are_pieces_fine(const sc_simple_contour *c)
{
    uint32_t piece, i;
    for (piece = 0; piece < c->count; piece++) {
        double area = 0, bound = 0;
        vector2 at = edge_end(c, piece, 0);
        if (piece_of(c, piece) != piece) continue;
        for (i = 0; i < c->count; i++) {
            vector2 a, b;
            if (piece_of(c, i) != piece) continue;
            a = minus(edge_end(c, i, 0), at);
            b = minus(edge_end(c, i, 1), at);
            area += (double)a.x * (double)b.y - (double)a.y * (double)b.x;
            bound += (double)bound_of(a, b, c->error);
        }
        if (!(fabs(area) > 1.001 * bound)) return 0;
        if (winding(c, piece, at) != (area < 0)) return 0;
    }
    return 1;
}

int sc_simple_test(sc_query_state *state, const sc_projection *projection, uint32_t node)
{
    const sc_model *model = state->model;
    const uint32_t *segments = sc_model_contours(model) + sc_model_node_contour(model)[node];
    uint32_t count = sc_model_node_contour(model)[node + 1] - sc_model_node_contour(model)[node];
    uint32_t previous = sc_state_switch(state, SC_TASK_UPDATE_CONTOURS), i;
    int kind = sc_model_node_kind(model)[node], passed;
    sc_simple_contour c;
    if (kind & SC_NODE_TOUCHES) {
        segments += 2;
        count -= 2;
    }
    c.edges = &state->workspace->contour;
    c.in_pieces = kind & SC_NODE_PIECES;
    c.pinch_count = 0;
    if (count) {
        project(&c, state, projection, segments, count);
        enclose(&c);
        state->stats.counts[SC_TASK_UPDATE_CONTOURS] += c.count;
    }
    sc_state_switch(state, SC_TASK_CONTOUR);
    state->stats.counts[SC_TASK_CONTOUR]++;
    /* of an error that large, and of NaN, nothing below holds */
    passed = count && c.error < 1e-3f && sc_query_kernels_of(state->workspace)->are_edges_fine(&c);
    for (i = 0; passed && i < c.pinch_count; i++) passed = is_pinch_fine(&c, c.pinch[i]);
    passed = passed && (!c.in_pieces || are_pieces_fine(&c));
    sc_state_switch(state, previous);
    return passed;
}
