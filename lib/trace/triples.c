/*
 * Points where three sheets meet. See triples.h.
 *
 * SPDX-License-Identifier: MIT
 *
 * Of the graph, each segment is listed with that of its two triangles which has fewer segments (or
 * the lower number): then none has more than the square root of twice their number, and looking for
 * triangles takes no more than that for each segment, even if one triangle meets all others
 * (Chiba and Nishizeki, Arboricity and subgraph listing algorithms, 1985).
 */
#include "trace/triples.h"

#include <math.h>
#include <string.h>

#include "base/assume.h"
#include "base/perturbed.h"
#include "base/predicates.h"
#include "base/sort.h"
#include "base/wide.h"

/* Segments between looks at the caller's flag. */
enum { SEGMENTS_BETWEEN_LOOKS = 1000 };

/* What two triangles have in common: the way from a node to the next. */
typedef struct trace_segment {
    uint32_t triangles[2];
    uint32_t nodes[2];
} trace_segment;

typedef struct triple_search {
    const sc_trace_subject *subject;
    const sc_trace_result *trace;
    sc_scratch *scratch;
    trace_segment *segments;
    uint32_t count;
    uint32_t *degree;   /* of each triangle: how many segments are in it */
    uint32_t *first;    /* triangle_count + 1: where those listed with it begin */
    sc_pair *neighbors; /* of each triangle: the other one and the segment, sorted */
    sc_list found;      /* six numbers each, as look_at_three has them */
} triple_search;

/* ---- segments ---- */

static int has_corner(const uint32_t corner[3], uint32_t vertex)
{
    return corner[0] == vertex || corner[1] == vertex || corner[2] == vertex;
}

/* Whether a node can be an end of the segment of two triangles: an edge of one that passes through
   the other, or a vertex of both. */
static int is_end_of(const sc_model *model, const sc_trace_node *node, const uint32_t triangles[2])
{
    const uint32_t *corner[2];
    uint32_t ends[2];
    int i;
    for (i = 0; i < 2; i++) corner[i] = sc_trace_corners(model, triangles[i]);
    if (node->edge == SC_TRACE_NO_EDGE)
        return has_corner(corner[0], node->triangle) && has_corner(corner[1], node->triangle);
    if (node->edge / 3 >= model->triangle_count) return 0;
    sc_trace_ends(model, node->edge, ends);
    i = triangles[0] == node->triangle;
    return triangles[!i] == node->triangle && ends[0] != ends[1] &&
           has_corner(corner[i], ends[0]) && has_corner(corner[i], ends[1]) &&
           !has_corner(corner[!i], ends[0]) && !has_corner(corner[!i], ends[1]);
}

static int is_finite_point(const double p[3])
{
    return p[0] - p[0] == 0 && p[1] - p[1] == 0 && p[2] - p[2] == 0;
}

/* Adds the segment behind a node. */
static sc_status add_segment(triple_search *s, uint64_t from, uint64_t to)
{
    const sc_model *model = s->subject->model;
    const sc_trace_node *nodes = s->trace->nodes;
    trace_segment *segment = &s->segments[s->count++];
    int i;
    memcpy(segment->triangles, nodes[from].sheets, sizeof segment->triangles);
    segment->nodes[0] = (uint32_t)from;
    segment->nodes[1] = (uint32_t)to;
    for (i = 0; i < 2; i++)
        if (segment->triangles[i] >= model->triangle_count ||
            sc_trace_is_collapsed(sc_trace_corners(model, segment->triangles[i])))
            return SC_ERROR_PAIRS;
    if (segment->triangles[0] == segment->triangles[1] ||
        (nodes[from].edge == SC_TRACE_NO_EDGE && nodes[to].edge == SC_TRACE_NO_EDGE))
        return SC_ERROR_PAIRS;
    for (i = 0; i < 2; i++) {
        const sc_trace_node *node = &nodes[segment->nodes[i]];
        if (!is_end_of(model, node, segment->triangles)) return SC_ERROR_PAIRS;
        if (!is_finite_point(node->point)) return SC_ERROR_NOT_FINITE;
    }
    return SC_OK;
}

static sc_status list_segments(triple_search *s)
{
    const sc_trace_result *t = s->trace;
    sc_status status = SC_OK;
    uint64_t i, k, total = 0;
    for (i = 0; i < t->contour_count; i++) {
        const sc_trace_contour *c = &t->contours[i];
        if (c->first > t->node_count || c->count > t->node_count - c->first) return SC_ERROR_PAIRS;
        total += c->count;
    }
    if (total > t->node_count) return SC_ERROR_PAIRS;
    s->segments = (trace_segment *)sc_scratch_take(s->scratch, total, sizeof *s->segments);
    if (!s->segments) return SC_ERROR_MEMORY;
    for (i = 0; !status && i < t->contour_count; i++) {
        const sc_trace_contour *c = &t->contours[i];
        const uint64_t end = c->first + c->count;
        for (k = c->first; !status && k + 1 < end; k++) status = add_segment(s, k, k + 1);
        if (!status && c->count && c->begin == SC_TRACE_CLOSED)
            status = add_segment(s, end - 1, c->first);
    }
    return status;
}

/* ---- the graph ---- */

/* With which of its triangles a segment is listed. */
static int lister_of(const triple_search *s, const trace_segment *segment)
{
    const uint32_t *t = segment->triangles;
    const uint32_t degree[2] = {s->degree[t[0]], s->degree[t[1]]};
    return degree[0] != degree[1] ? degree[1] < degree[0] : t[1] < t[0];
}

static int has_finite_corners(const triple_search *s, uint32_t triangle)
{
    const uint32_t *corner = sc_trace_corners(s->subject->model, triangle);
    double p[3];
    int k, finite = 1;
    for (k = 0; k < 3; k++) {
        sc_positions_get(&s->subject->positions, corner[k], p);
        finite &= is_finite_point(p);
    }
    return finite;
}

static sc_status list_neighbors(triple_search *s)
{
    const uint32_t triangles = s->subject->model->triangle_count;
    uint32_t i, k;
    s->degree = (uint32_t *)sc_scratch_take_filled(s->scratch, triangles, sizeof *s->degree, 0);
    s->first = (uint32_t *)sc_scratch_take_filled(s->scratch, (uint64_t)triangles + 1,
                                                  sizeof *s->first, 0);
    s->neighbors = (sc_pair *)sc_scratch_take(s->scratch, s->count, sizeof *s->neighbors);
    if (!s->degree || !s->first || !s->neighbors) return SC_ERROR_MEMORY;
    for (i = 0; i < s->count; i++)
        for (k = 0; k < 2; k++) s->degree[s->segments[i].triangles[k]]++;
    for (i = 0; i < s->count; i++) {
        const trace_segment *segment = &s->segments[i];
        s->first[segment->triangles[lister_of(s, segment)] + 1]++;
    }
    for (i = 0; i < triangles; i++) s->first[i + 1] += s->first[i];
    for (i = s->count; i-- > 0;) {
        const trace_segment *segment = &s->segments[i];
        const int owner = lister_of(s, segment);
        const uint32_t at = --s->first[segment->triangles[owner] + 1];
        s->neighbors[at].a = segment->triangles[!owner];
        s->neighbors[at].b = i;
    }
    /* first[t + 1] is where those of t begin now */
    for (i = 0; i < triangles; i++) s->first[i] = s->first[i + 1];
    s->first[triangles] = s->count;
    for (i = 0; i < triangles; i++) {
        sc_pair *list = s->neighbors + s->first[i];
        const uint32_t count = s->first[i + 1] - s->first[i];
        if (s->degree[i] && !has_finite_corners(s, i)) return SC_ERROR_NOT_FINITE;
        sc_sort_pairs(list, count);
        for (k = 1; k < count; k++)
            if (list[k - 1].a == list[k].a) return SC_ERROR_PAIRS; /* they have one at most */
    }
    return SC_OK;
}

/* ---- three triangles ---- */

/* The end of a segment and a plane: an edge and a triangle, or a vertex, and three points. */
typedef struct seen_end {
    int is_vertex;
    uint32_t number[8];
    double position[8][3];
    const double *p[8]; /* these */
} seen_end;

static void set_seen(const triple_search *s, seen_end *end, int i, const uint32_t *vertices,
                     int count)
{
    for (; count > 0; count--, i++, vertices++) {
        end->number[i] = *vertices;
        sc_positions_get(&s->subject->positions, *vertices, end->position[i]);
        end->p[i] = end->position[i];
    }
}

/* Sets points 5 to 7 to those of a plane, and the others to those of an end of a segment: 0 and 1
   to an edge, 2 to 4 to a triangle; or just 0 to a vertex. */
static void see_end(const triple_search *s, const trace_segment *segment, int i, uint32_t plane,
                    seen_end *end)
{
    const sc_model *model = s->subject->model;
    const sc_trace_node *node = &s->trace->nodes[segment->nodes[i]];
    uint32_t ends[2];
    end->is_vertex = node->edge == SC_TRACE_NO_EDGE;
    set_seen(s, end, 5, sc_trace_corners(model, plane), 3);
    if (end->is_vertex) {
        set_seen(s, end, 0, &node->triangle, 1);
        return;
    }
    sc_trace_ends(model, node->edge, ends);
    set_seen(s, end, 0, ends, 2);
    set_seen(s, end, 2, sc_trace_corners(model, node->triangle), 3);
}

/* On which side of the plane the end is; 0 if it is one of its vertices. */
static int side_of_seen(const seen_end *end)
{
    const double *const p[4] = {end->p[5], end->p[6], end->p[7], end->p[0]};
    const uint32_t n[4] = {end->number[5], end->number[6], end->number[7], end->number[0]};
    uint64_t fallbacks = 0;
    if (!end->is_vertex) return sc_perturbed_crossing_side(end->p, end->number);
    return has_corner(n, n[3]) ? 0 : sc_perturbed_orient3d(p, n, &fallbacks);
}

/* Whether a segment passes through the plane of a triangle. Three that share a vertex have nothing
   else in common. */
static int passes(const triple_search *s, const trace_segment *segment, uint32_t plane)
{
    seen_end end;
    int side[2], i;
    for (i = 0; i < 2; i++) {
        see_end(s, segment, i, plane, &end);
        side[i] = side_of_seen(&end);
    }
    return side[0] * side[1] < 0;
}

/* ---- where they meet ---- */

/* number times 2^exponent; the number is 0 or from 1/2 to 1. */
typedef struct scaled {
    double number;
    int exponent;
} scaled;

static scaled scaled_of(double number, int exponent)
{
    scaled result;
    int more;
    result.number = frexp(number, &more);
    result.exponent = exponent + more;
    return result;
}

/* a + sign b, and in *size the larger of the two. */
static scaled add_scaled(scaled a, scaled b, int sign, scaled *size)
{
    const int is_a = b.number == 0 || (a.number != 0 && a.exponent >= b.exponent);
    *size = is_a ? a : b;
    return scaled_of(ldexp(a.number, a.exponent - size->exponent) +
                         sign * ldexp(b.number, b.exponent - size->exponent),
                     size->exponent);
}

/* The determinant of the plane of three of the points with another one, to within 2^-51 of it. */
static scaled height_of(const seen_end *end, int plane, int point)
{
    const sc_predicates_value v = sc_predicates_orient3d_value(end->p[plane], end->p[plane + 1],
                                                               end->p[plane + 2], end->p[point]);
    return scaled_of(v.number, v.exponent);
}

/* The height of a crossing over the plane, times the difference of those of the edge's ends over
   the triangle: by integers. */
static scaled exact_height(const seen_end *end)
{
    const double *const *p = end->p;
    const int signs[2] = {1, -1};
    sc_wide_minor factors[2][2];
    double value;
    int i, k, exponent;
    for (i = 0; i < 2; i++)
        for (k = 0; k < 2; k++) {
            sc_wide_minor *m = &factors[i][k];
            m->count = 4;
            memcpy(m->rows, p + 2 + 3 * k, 3 * sizeof *p);
            m->rows[3] = p[i != k];
            m->columns[0] = 0;
            m->columns[1] = 1;
            m->columns[2] = 2;
        }
    value = sc_wide_minors_value((const sc_wide_minor(*)[2])factors, signs, 2, &exponent);
    return scaled_of(value, exponent);
}

/* The height of an end of a segment over a plane in units of the plane, to within 2^-40 of it. */
static scaled height_of_end(const triple_search *s, const trace_segment *segment, int i,
                            uint32_t plane)
{
    scaled low[2], high[2], product[2], sum, size;
    seen_end end;
    int k;
    see_end(s, segment, i, plane, &end);
    if (end.is_vertex) return height_of(&end, 5, 0);
    for (k = 0; k < 2; k++) {
        low[k] = height_of(&end, 2, k);
        high[k] = height_of(&end, 5, k);
    }
    for (k = 0; k < 2; k++)
        product[k] =
            scaled_of(low[k].number * high[!k].number, low[k].exponent + high[!k].exponent);
    sum = add_scaled(product[0], product[1], -1, &size);
    if (!(ldexp(fabs(sum.number), sum.exponent - size.exponent) > 0x1p-9)) sum = exact_height(&end);
    product[0] = add_scaled(low[0], low[1], -1, &size);
    return scaled_of(product[0].number != 0 ? sum.number / product[0].number : 0,
                     sum.exponent - product[0].exponent);
}

/* Where a segment passes through a plane: from 0 at its first node to 1. In the middle if all of it
   is in the plane. */
static double share_of(const triple_search *s, const trace_segment *segment, uint32_t plane)
{
    scaled height[2], sum, size;
    int i;
    for (i = 0; i < 2; i++) {
        height[i] = height_of_end(s, segment, i, plane);
        height[i].number = fabs(height[i].number);
    }
    sum = add_scaled(height[0], height[1], 1, &size);
    if (sum.number == 0) return 0.5;
    return ldexp(height[0].number / sum.number, height[0].exponent - sum.exponent);
}

static void place_triple(const triple_search *s, const uint32_t found[6], sc_trace_triple *triple)
{
    const trace_segment *segment = &s->segments[found[5]];
    const double *from = s->trace->nodes[segment->nodes[0]].point;
    const double *to = s->trace->nodes[segment->nodes[1]].point;
    int i;
    memset(triple, 0, sizeof *triple);
    for (i = 0; i < 3; i++) {
        const trace_segment *opposite = &s->segments[found[3 + i]];
        triple->triangles[i] = found[i];
        triple->nodes[i] = opposite->nodes[0];
        triple->along[i] = share_of(s, opposite, found[i]);
    }
    for (i = 0; i < 3; i++) {
        const double mean = (1 - triple->along[2]) * from[i] + triple->along[2] * to[i];
        const double low = from[i] < to[i] ? from[i] : to[i];
        const double high = from[i] < to[i] ? to[i] : from[i];
        triple->point[i] = mean < low ? low : mean > high ? high : mean;
    }
}

/* ---- all of them ---- */

/* Looks at three triangles that have segments two by two: three[3 + i] is that of the two others of
   triangle three[i]. Lists them, ascending, if they have a point in common. */
static sc_status look_at_three(triple_search *s, uint32_t three[6])
{
    uint32_t i, k, n;
    for (i = 1; i < 3; i++)
        for (k = i; k > 0 && three[k] < three[k - 1]; k--)
            for (n = 0; n < 6; n += 3) {
                const uint32_t last = three[n + k];
                three[n + k] = three[n + k - 1];
                three[n + k - 1] = last;
            }
    if (!passes(s, &s->segments[three[5]], three[2]) ||
        !passes(s, &s->segments[three[4]], three[1]))
        return SC_OK;
    if (!sc_list_reserve(s->scratch, &s->found, 6)) return SC_ERROR_MEMORY;
    for (i = 0; i < 6; i++) sc_list_add(&s->found, three[i]);
    return SC_OK;
}

/* Looks at all triangles of the graph that have a segment: those that have one with both of its
   triangles. */
static sc_status look_at_segment(triple_search *s, uint32_t owner, sc_pair neighbor)
{
    const uint32_t other = neighbor.a;
    uint32_t i = s->first[owner], k = s->first[other];
    sc_status status = SC_OK;
    while (!status && i < s->first[owner + 1] && k < s->first[other + 1]) {
        const sc_pair a = s->neighbors[i], b = s->neighbors[k];
        if (a.a == b.a) {
            uint32_t three[6];
            three[0] = owner;
            three[1] = other;
            three[2] = a.a;
            three[3] = b.b;
            three[4] = a.b;
            three[5] = neighbor.b;
            status = look_at_three(s, three);
        }
        i += a.a <= b.a;
        k += b.a <= a.a;
    }
    return status;
}

static sc_status look_at_segments(triple_search *s)
{
    uint32_t triangle, i, looks = 0;
    sc_status status = SC_OK;
    for (triangle = 0; triangle < s->subject->model->triangle_count; triangle++)
        for (i = s->first[triangle]; !status && i < s->first[triangle + 1]; i++) {
            if (looks++ % SEGMENTS_BETWEEN_LOOKS == 0 && sc_trace_is_cancelled(s->subject))
                return SC_ERROR_INCOMPLETE;
            status = look_at_segment(s, triangle, s->neighbors[i]);
        }
    return status;
}

static int are_equal(const uint32_t *a, const uint32_t *b, uint32_t count)
{
    return !count || (a[0] == b[0] && (count < 2 || a[1] == b[1]));
}

/* Sorts what was found by the first triangle, then what has that in common by the second, then by
   the third: order[i].b is the i'th. */
static sc_pair *sort_triples(const triple_search *s, uint32_t count)
{
    sc_pair *order = (sc_pair *)sc_scratch_take(s->scratch, count, sizeof *order);
    uint32_t i, end, by;
    if (!order) return NULL;
    for (i = 0; i < count; i++) order[i].b = i;
    for (by = 0; by < 3; by++)
        for (i = 0; i < count; i = end) {
            const uint32_t *first = s->found.items + 6 * (uint64_t)order[i].b;
            for (end = i; end < count; end++) {
                const uint32_t *next = s->found.items + 6 * (uint64_t)order[end].b;
                if (!are_equal(first, next, by)) break;
                order[end].a = next[by];
            }
            sc_sort_pairs(order + i, end - i);
        }
    return order;
}

sc_status sc_triples_find(const sc_trace_subject *subject, const sc_trace_result *trace,
                          sc_scratch *scratch, sc_triples_result *result)
{
    triple_search s;
    sc_status status;
    const sc_pair *order;
    uint64_t i;
    memset(&s, 0, sizeof s);
    s.subject = subject;
    s.trace = trace;
    s.scratch = scratch;
    status = list_segments(&s);
    if (status || !s.count) return status;
    status = list_neighbors(&s);
    if (!status) status = look_at_segments(&s);
    if (status) return status;
    result->count = s.found.count / 6;
    if (result->count > result->capacity) return SC_ERROR_SHORT_BUFFER;
    if (SC_HARDLY(result->count > UINT32_MAX)) return SC_ERROR_COUNT;
    order = sort_triples(&s, (uint32_t)result->count);
    if (!order) return SC_ERROR_MEMORY;
    for (i = 0; i < result->count; i++)
        place_triple(&s, s.found.items + 6 * (uint64_t)order[i].b, &result->triples[i]);
    return SC_OK;
}
