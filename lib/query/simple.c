/*
 * What a contour must be for its node to be culled. See simple_contour.h and simple.h.
 *
 * SPDX-License-Identifier: MIT
 *
 * All tests are in single precision on projected points, relative to a point of the contour and
 * scaled to a size of about one, and hold for every place that the true points can be at, up to a
 * distance of error in each coordinate: they say something about the contour that is, not about the
 * one computed. Edges that share no point must be apart by their boxes, or one on one side of the
 * other's line. The inner loops (query/simple_kernel.h) classify nearly all pairs, sixteen at a
 * time; what they leave comes to sc_simple_are_apart.
 */
#include "base/bounds.h"
#include "query/simple.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "base/bits.h"
#include "pose/dnc.h"

/* Where there are gaps. */
static int is_edge(const sc_simple_contour *c, uint32_t i)
{
    return c->edges->is_edge[i / SC_CONTOUR_BLOCK] >> i % SC_CONTOUR_BLOCK & 1;
}

/* The point where edge i starts, or the one before it ends. */
static uint32_t point_of(const sc_simple_contour *c, uint32_t i)
{
    return c->loop ? c->leaf_point[sc_loops_turn(c->edges->point[i])] : c->edges->point[i];
}

/* Copies points, eight at a time where all may be read: most segments are short. */
static void copy_points(uint32_t *to, const uint32_t *from, uint32_t count, uint32_t readable)
{
    uint32_t i;
    if (readable < count + 8) {
        memcpy(to, from, count * sizeof *to);
        return;
    }
    for (i = 0; i < count; i += 8) memcpy(to + i, from + i, 8 * sizeof *to);
}

/* Lists the points of segments, one that follows where another ended going on with its chain. */
static void list_points(sc_simple_contour *c, const sc_model *model, const uint32_t *segments,
                        uint32_t segment_count)
{
    const sc_contour_edges *e = c->edges;
    const uint32_t *points = sc_model_points(model);
    const uint32_t *first = sc_model_segment_first(model), *last = sc_model_segment_last(model);
    uint32_t i, n = 0, blocks = 0;
    for (i = 0; i < segment_count; i++) {
        uint32_t begin = first[segments[i]], count = last[segments[i]] - begin + 1;
        if (n && e->point[n - 1] == points[begin])
            n--;
        else if (n) /* no edge */
            e->is_edge[(n - 1) / SC_CONTOUR_BLOCK] &=
                (uint16_t) ~(1u << (n - 1) % SC_CONTOUR_BLOCK);
        copy_points(e->point + n, points + begin, count, model->segment_point_total - begin);
        for (n += count; blocks * SC_CONTOUR_BLOCK < n; blocks++) e->is_edge[blocks] = 0xffff;
    }
    e->is_edge[blocks - 1] &= (uint16_t)((1u << (n - 1) % SC_CONTOUR_BLOCK) - 1u);
    e->is_edge[blocks] = 0;
    c->count = n;
    c->blocks = blocks;
    for (i = n; i < (blocks + 1) * SC_CONTOUR_BLOCK; i++) e->point[i] = e->point[n - 1];
}

void sc_simple_find_loop(sc_simple_contour *c, const sc_model *model, uint32_t node)
{
    const uint32_t *leaf = sc_model_leaf(model);
    const sc_node *n = sc_model_node(model) + node;
    c->count = n->loop_length;
    c->loop = sc_model_loop(model) + n->loop;
    c->pinch_count = 0;
    c->has_gaps = c->in_pieces = (n->kind & SC_NODE_PIECES) != 0;
    if (c->in_pieces) {
        c->pieces = c->loop[0];
        c->piece_edges = c->loop + 1;
        c->loop += 1 + c->pieces;
        c->count -= 1 + c->pieces;
    }
    c->looped = c->count;
    c->leaf_point = sc_model_leaf_point(model);
    c->first = SC_LEAF_POINTS * leaf[n->patches.a];
    c->split = SC_LEAF_POINTS * leaf[n->patches.a + 1] - c->first;
    c->second = SC_LEAF_POINTS * leaf[n->patches.b] - c->split;
}

/* How many places a piece of so many edges takes: its points, the first again, and what fills it
   up. */
static uint32_t places_of(uint32_t edges)
{
    return edges / SC_CONTOUR_GAP * SC_CONTOUR_GAP + SC_CONTOUR_GAP;
}

void sc_simple_close_bits(const sc_simple_contour *c)
{
    uint16_t *after = c->edges->is_edge + c->count / SC_CONTOUR_BLOCK;
    uint32_t bit = c->count % SC_CONTOUR_BLOCK, first = c->edges->is_edge[0];
    if (c->count < SC_CONTOUR_BLOCK) first &= (1u << c->count) - 1;
    after[0] = (uint16_t)((after[0] & ((1u << bit) - 1)) | first << bit);
    after[1] = (uint16_t)(first << bit >> SC_CONTOUR_BLOCK);
}

void sc_simple_spread(sc_simple_contour *c)
{
    const sc_contour_edges *e = c->edges;
    uint32_t p, i, from = c->looped, to = 0;
    for (p = 0; p < c->pieces; p++) to += places_of(c->piece_edges[p]);
    c->count = to;
    memset(e->is_edge, 0xff, (to / SC_CONTOUR_BLOCK + 1) * sizeof *e->is_edge);
    for (i = 0; i < to + SC_CONTOUR_BLOCK; i++) e->wall[i] = -INFINITY;
    for (p = c->pieces; p-- > 0;) {
        uint32_t edges = c->piece_edges[p], places = places_of(edges);
        from -= edges;
        to -= places;
        memmove(e->point + to, e->point + from, edges * sizeof *e->point);
        for (i = to + edges; i < to + places; i++) {
            e->point[i] = e->point[to];
            e->wall[i] = INFINITY;
            e->is_edge[i / SC_CONTOUR_BLOCK] &= (uint16_t) ~(1u << i % SC_CONTOUR_BLOCK);
        }
    }
}

/* Lists the points of a loop, and the first of each piece again. The last listed is no edge. */
static void list_loop(sc_simple_contour *c)
{
    const sc_contour_edges *e = c->edges;
    uint32_t i;
    for (i = 0; i < c->looped; i++) e->point[i] = sc_simple_point(c, c->loop[i]);
    if (c->in_pieces) {
        sc_simple_spread(c);
    } else {
        memset(e->is_edge, 0xff, (c->count / SC_CONTOUR_BLOCK + 1) * sizeof *e->is_edge);
        e->point[c->count++] = e->point[0];
    }
    i = c->count - 1;
    c->blocks = i / SC_CONTOUR_BLOCK + 1;
    e->is_edge[c->blocks - 1] &= (uint16_t)((1u << i % SC_CONTOUR_BLOCK) - 1u);
    e->is_edge[c->blocks] = 0;
    for (i = c->count; i < (c->blocks + 1) * SC_CONTOUR_BLOCK; i++) e->point[i] = e->point[0];
}

/* One over the power of two above a float from 1 to 2^125, exactly. */
static inline float below_one(float f)
{
    uint32_t bits;
    memcpy(&bits, &f, sizeof bits);
    bits = (253u << 23) - (bits & 0x7f800000u); /* exponents have a bias of 127 */
    memcpy(&f, &bits, sizeof f);
    return f;
}

/*
 * The projection x = U . (p - q) of points in the unit box, q being about the middle of the contour
 * and U the integer vector u over a power of two, exactly, so that |U|1 <= 1; and y likewise. A
 * computed coordinate is off by 3e-8 for the place of p, and by the rounding of one difference, one
 * product and two additions: at most 4.01 * 2^-24 |p - q|max, and what underflows.
 */
static inline void set_axis(float axis[3], const float u[3])
{
    const float size = below_one(fabsf(u[0]) + fabsf(u[1]) + fabsf(u[2]));
    int k;
    for (k = 0; k < 3; k++) axis[k] = u[k] * size;
}

void sc_simple_axes_of(const uint16_t mask[SC_DNC_VECTORS], sc_simple_some_axes *axes)
{
    float vector[2][3][SC_DNC_VECTORS];
    int i, k, m;
    sc_dnc_vectors(mask, vector[0], vector[1]);
    for (m = 0; m < 2; m++)
        for (i = 0; i < SC_DNC_VECTORS; i++) {
            float u[3], one[3];
            for (k = 0; k < 3; k++) u[k] = vector[m][k][i];
            set_axis(one, u);
            for (k = 0; k < 3; k++) axes->at[m][k][i] = one[k];
        }
}

void sc_simple_axes(sc_simple_contour *c, const sc_projection *projection)
{
    float u[3], w[3];
    int k;
    for (k = 0; k < 3; k++) {
        u[k] = (float)projection->u[k];
        w[k] = (float)projection->w[k];
    }
    set_axis(c->axis[0], u);
    set_axis(c->axis[1], w);
}

void sc_simple_middle(const sc_simple_contour *c, const float *unit, uint32_t stride, float from[3])
{
    const float *one = unit + stride * (uint64_t)c->edges->point[0];
    const float *other = unit + stride * (uint64_t)c->edges->point[c->count / 2];
    int k;
    for (k = 0; k < 3; k++) from[k] = one[k] / 2 + other[k] / 2;
}

typedef struct vector2 {
    float x, y;
} vector2;

/*
 * Vectors between computed points are off by 2 error, and by the rounding of a difference, at most
 * 2^-23 of the largest coordinate, another 2 error: 4 error in all. A cross or dot product of a and
 * b is then off by 4 error (|a|1 + |b|1) + 32 error^2, and by its own rounding, 2.1 * 2^-24 |a|1
 * |b|max or less, which is below 4.2 error |a|1 as b is at most two coordinates long.
 */
static inline float bound_of(vector2 a, vector2 b, float error)
{
    return SC_BOUNDS_TURN * error *
               (fabsf(a.x) + fabsf(a.y) + fabsf(b.x) + fabsf(b.y) + 4 * error) +
           FLT_MIN;
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
    v.x = c->edges->at[0][i + (uint32_t)end];
    v.y = c->edges->at[1][i + (uint32_t)end];
    return v;
}

static inline vector2 minus(vector2 a, vector2 b)
{
    a.x -= b.x;
    a.y -= b.y;
    return a;
}

/* Whether edge j is certainly on one side of the line of edge i. */
static int lies_beside(const sc_simple_contour *c, uint32_t i, uint32_t j)
{
    vector2 from = edge_end(c, i, 0), along = minus(edge_end(c, i, 1), from);
    return turn(along, minus(edge_end(c, j, 0), from), c->error) *
               turn(along, minus(edge_end(c, j, 1), from), c->error) >
           0;
}

/* Whether two edges that share a point, the given end of each, certainly do not overlap beyond
   it. */
static int is_open(const sc_simple_contour *c, uint32_t i, int end_i, uint32_t j, int end_j)
{
    vector2 at = edge_end(c, i, end_i);
    vector2 a = minus(edge_end(c, i, 1 - end_i), at), b = minus(edge_end(c, j, 1 - end_j), at);
    return turn(a, b, c->error) != 0 || a.x * b.x + a.y * b.y < -bound_of(a, b, c->error);
}

/*
 * Edges that share one point: the contour passes it twice, or one of them ends a chain and the
 * other begins it, beyond a gap; these must not fold back. Where it passes it twice, how its edges
 * lie round the point is asked once, of the two that start there, when all were looked at: if they
 * alternate (is_pinch_fine), no two of them have one direction.
 */
int sc_simple_are_apart(sc_simple_contour *c, uint32_t i, uint32_t j)
{
    const uint32_t a = point_of(c, i), b = point_of(c, i + 1);
    const uint32_t p = point_of(c, j), q = point_of(c, j + 1);
    const int shared = (a == p) + (a == q) + (b == p) + (b == q);
    if (!shared) return lies_beside(c, i, j) || lies_beside(c, j, i);
    if (shared > 1) return 0;
    if (c->has_gaps && !is_open(c, i, b == p || b == q, j, a == q || b == q)) return 0;
    return a != p || sc_simple_note_shared(c, i, j);
}

int sc_simple_note_shared(sc_simple_contour *c, uint32_t i, uint32_t j)
{
    uint32_t a = point_of(c, i), k;
    if (a == point_of(c, j)) { /* the contour leaves the point twice */
        for (k = 0; k < c->pinch_count && c->pinch[k].point != a; k++) {
        }
        if (k == SC_PINCHES_MAX) return 0;
        if (k < c->pinch_count) /* the same pair of edges again, or more than two */
            return c->pinch[k].edge[0] + c->pinch[k].edge[1] == i + j &&
                   (c->pinch[k].edge[0] == i || c->pinch[k].edge[1] == i);
        c->pinch[k].point = a;
        c->pinch[k].edge[0] = i;
        c->pinch[k].edge[1] = j;
        c->pinch_count++;
    }
    return 1;
}

/* The edge that leads to where edge i starts. Chains are closed: before the first of one comes the
   last. */
static uint32_t edge_before(const sc_simple_contour *c, uint32_t i)
{
    if (!c->has_gaps) return (i ? i : c->count) - 1;
    if (i && is_edge(c, i - 1)) return i - 1;
    while (is_edge(c, i)) i++;
    return i - 1;
}

/*
 * Where the contour passes a point twice, its four edges must alternate round the point, one in,
 * one out: else it crosses itself there. That is so if just one of those that come in is in the
 * sector that begins with the first that goes out, lies to its left, and ends with the second; and
 * then no two of the four have one direction. What is left of the first and right of the second is
 * in it, and what is right of the first and left of the second is not, whatever the sector's angle:
 * edges of flat grids go straight on through the point, and nobody knows whether that is less than
 * half a turn. If it is less for certain, what is right of the first or left of the second is
 * outside; if more, what is left of the first or right of the second is inside. More than four are
 * not looked at.
 */
static int is_pinch_fine(const sc_simple_contour *c, const sc_pinch *pinch)
{
    vector2 direction[2][2]; /* out, in */
    uint32_t i;
    int out, side[2];
    for (i = 0; i < 2; i++) {
        uint32_t in = edge_before(c, pinch->edge[i]);
        direction[0][i] = minus(edge_end(c, pinch->edge[i], 1), edge_end(c, pinch->edge[i], 0));
        direction[1][i] = minus(edge_end(c, in, 0), edge_end(c, in, 1));
    }
    out = turn(direction[0][0], direction[0][1], c->error);
    for (i = 0; i < 2; i++) { /* 1: in that sector, -1: outside */
        int one = turn(direction[0][0], direction[1][i], c->error);
        int other = turn(direction[1][i], direction[0][1], c->error);
        if (one && one == other)
            side[i] = one;
        else if (out && (one == -out || other == -out))
            side[i] = -out;
        else
            return 0;
    }
    return side[0] != side[1];
}

/* A piece of a contour: edges begin to end - 1. */
typedef struct piece {
    uint32_t begin, end;
} piece;

/* Sixteen bits: which of edges i to i + 15 are edges. */
static uint32_t edges_at(const sc_simple_contour *c, uint32_t i)
{
    const uint16_t *bits = c->edges->is_edge + i / SC_CONTOUR_BLOCK;
    return (bits[0] | (uint32_t)bits[1] << 16) >> i % SC_CONTOUR_BLOCK & 0xffff;
}

/* The piece that begins at i or later; 0: there is none. */
static int find_piece(const sc_simple_contour *c, uint32_t i, piece *p)
{
    uint32_t edges = 0;
    while (i < c->count && !(edges = edges_at(c, i))) i += SC_CONTOUR_BLOCK;
    if (i >= c->count) return 0;
    p->begin = i += sc_bits_lowest(edges);
    if (i >= c->count) return 0;
    while ((edges = edges_at(c, i)) == 0xffff) i += SC_CONTOUR_BLOCK;
    p->end = i + sc_bits_lowest(~edges);
    return 1;
}

/* 1 if a piece certainly runs counter-clockwise, -1 if clockwise, by twice its signed area; 0:
   neither is certain. Sums are of doubles, so that only errors of vectors count. */
static int turn_of_piece(const sc_simple_contour *c, piece p)
{
    const vector2 at = edge_end(c, p.begin, 0);
    vector2 a = {0, 0}, b;
    double area = 0, sizes = 0, bound;
    uint32_t i;
    for (i = p.begin; i < p.end; i++, a = b) {
        b = minus(edge_end(c, i, 1), at);
        area += (double)a.x * (double)b.y - (double)a.y * (double)b.x;
        sizes += (double)(fabsf(b.x) + fabsf(b.y));
    }
    /* the sum of bound_of each two vectors, in which each is twice */
    bound = SC_BOUNDS_TURN * (double)c->error *
                (2 * sizes + 4 * (double)c->error * (double)(p.end - p.begin)) +
            (double)FLT_MIN * (double)(p.end - p.begin);
    return (area > 1.001 * bound) - (area < -1.001 * bound);
}

/* How often the edges of other pieces go round a point of one; a number that cannot be if that is
   not certain, as where they have that point, too. */
static int winding(const sc_simple_contour *c, piece p)
{
    const vector2 at = edge_end(c, p.begin, 0);
    uint32_t i;
    int sum = 0;
    for (i = 0; i < c->count; i++) {
        vector2 from = edge_end(c, i, 0), to = edge_end(c, i, 1);
        int side;
        if (!is_edge(c, i) || (from.y <= at.y) == (to.y <= at.y) || (i >= p.begin && i < p.end))
            continue;
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
 * Each piece by itself is a closed polygon that crosses itself nowhere, so that it winds round no
 * point but once counter-clockwise, or round no point but once clockwise. The contour, the sum of
 * all, winds round no point less than 0 times. So if all pieces but one run clockwise, it winds
 * round no point more than once, wherever they lie, and all is well: the longest is not even looked
 * at.
 *
 * Else: the contour winds round the points beside a piece once more on its left than on its right;
 * as the other pieces wind round it n times, those are n + 1 and n if it runs counter-clockwise,
 * else n and n - 1. That must be 1 and 0.
 */
static int are_pieces_fine(const sc_simple_contour *c)
{
    piece p = {0, 0}, longest = {0, 0};
    int others = 1;
    while (find_piece(c, p.end, &p))
        if (p.end - p.begin > longest.end - longest.begin) longest = p;
    for (p.end = 0; others && find_piece(c, p.end, &p);)
        others = p.begin == longest.begin || turn_of_piece(c, p) < 0;
    if (others) return 1;
    for (p.end = 0; find_piece(c, p.end, &p);) {
        int side = turn_of_piece(c, p);
        if (!side || winding(c, p) != (side < 0)) return 0;
    }
    return 1;
}

int sc_simple_is_wound_well(const sc_simple_contour *c)
{
    uint32_t i;
    for (i = 0; i < c->pinch_count; i++)
        if (!is_pinch_fine(c, &c->pinch[i])) return 0;
    return !c->in_pieces || are_pieces_fine(c);
}

static int is_looped(const sc_model *model, uint32_t node)
{
    return sc_model_node(model)[node].loop_length > 0;
}

int sc_simple_list(sc_simple_contour *c, const sc_model *model, const sc_contour_edges *room,
                   uint32_t node)
{
    const sc_node *n = sc_model_node(model) + node;
    const uint32_t *segments = sc_model_contours(model) + n->contour;
    uint32_t count = n[1].contour - n->contour;
    memset(c, 0, sizeof *c);
    c->edges = room;
    c->has_gaps = 1;
    if (is_looped(model, node)) {
        sc_simple_find_loop(c, model, node);
        list_loop(c);
        c->loop = NULL;
        c->has_gaps = 1;
        return 1;
    }
    if (n->kind & SC_NODE_TOUCHES) {
        segments += 2;
        count -= 2;
    }
    c->in_pieces = n->kind & SC_NODE_PIECES;
    if (!count) return 0;
    list_points(c, model, segments, count);
    return 1;
}

/* Sets where boxes of spans are not to reach, from what is an edge; most are. */
static void raise_walls(const sc_simple_contour *c)
{
    const sc_contour_edges *e = c->edges;
    uint32_t i;
    for (i = 0; i < c->count + SC_CONTOUR_BLOCK; i++) e->wall[i] = -INFINITY;
    for (i = 0; i < c->count; i += SC_CONTOUR_BLOCK) {
        const uint32_t left = c->count - i,
                       here = left < SC_CONTOUR_BLOCK ? left : SC_CONTOUR_BLOCK;
        uint32_t gaps = ~(uint32_t)e->is_edge[i / SC_CONTOUR_BLOCK] & ((1u << here) - 1u);
        for (; gaps; gaps &= gaps - 1) e->wall[i + sc_bits_lowest(gaps)] = INFINITY;
    }
}

int sc_simple_start(sc_simple_contour *c, const sc_model *model, const sc_contour_edges *room,
                    uint32_t node)
{
    if (is_looped(model, node)) {
        c->edges = room;
        sc_simple_find_loop(c, model, node);
        return 1;
    }
    if (!sc_simple_list(c, model, room, node)) return 0;
    raise_walls(c);
    sc_simple_close_bits(c);
    return 1;
}
