/*
 * The checker of contours. See traced_pose.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "traced_pose.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "harness.h"

static int has_vertex(const uint32_t *corner, uint32_t v)
{
    return corner[0] == v || corner[1] == v || corner[2] == v;
}

static const uint32_t *corners(const traced_pose *t, uint32_t triangle)
{
    return t->triangles + 3 * (size_t)triangle;
}

/* The oracle's edge of this name, or NULL. */
static const trace_oracle_edge *edge_named(const traced_pose *t, uint32_t name)
{
    uint32_t low = 0, high = t->truth.edge_count;
    while (low < high) {
        const uint32_t middle = (low + high) / 2;
        if (t->truth.edges[middle].name < name)
            low = middle + 1;
        else
            high = middle;
    }
    return low < t->truth.edge_count && t->truth.edges[low].name == name ? &t->truth.edges[low]
                                                                         : NULL;
}

static int edge_has(const trace_oracle_edge *edge, uint32_t triangle)
{
    for (uint32_t i = 0; i < edge->count; ++i)
        if (edge->triangles[i] == triangle) return 1;
    return 0;
}

/* Which of the oracle's crossings a node is; counts it in seen. */
static int is_crossing(const traced_pose *t, const sc_trace_node *node, uint32_t *seen)
{
    uint32_t low = 0, high = t->truth.crossing_count;
    while (low < high) {
        const uint32_t middle = (low + high) / 2;
        const trace_oracle_crossing *c = &t->truth.crossings[middle];
        const uint32_t name = t->truth.edges[c->edge].name;
        if (name == node->edge && c->triangle == node->triangle) {
            ++seen[middle];
            return 1;
        }
        if (name < node->edge || (name == node->edge && c->triangle < node->triangle))
            low = middle + 1;
        else
            high = middle;
    }
    return 0;
}

/* Whether a node is on the segment of two triangles: its edge is of one, and it crosses the other,
   or it is their vertex. *sheet: on which the edge is. */
static int is_on_segment(const traced_pose *t, const sc_trace_node *node, const uint32_t sheets[2],
                         int sheet)
{
    const trace_oracle_edge *edge;
    if (node->edge == SC_TRACE_NO_EDGE)
        return has_vertex(corners(t, sheets[0]), node->triangle) &&
               has_vertex(corners(t, sheets[1]), node->triangle);
    edge = edge_named(t, node->edge);
    return edge && edge_has(edge, sheets[sheet]) && sheets[1 - sheet] == node->triangle;
}

/* Where a node is: as accurate as is promised. */
static int is_placed(const traced_pose *t, const sc_trace_node *node)
{
    const trace_oracle_edge *edge;
    const double *p[5];
    if (node->edge == SC_TRACE_NO_EDGE)
        return memcmp(node->point, t->positions + 3 * (size_t)node->triangle, sizeof node->point) ==
               0;
    edge = edge_named(t, node->edge);
    if (!edge) return 0;
    for (int i = 0; i < 5; ++i)
        p[i] =
            t->positions + 3 * (size_t)(i < 2 ? edge->ends[i] : corners(t, node->triangle)[i - 2]);
    return trace_oracle_is_placed(p, node->along, node->weights, node->point);
}

/* The first or the last node of a contour that is not closed. */
static int is_end(const traced_pose *t, const sc_trace_node *node, uint32_t kind)
{
    const trace_oracle_edge *edge;
    if (kind == SC_TRACE_VERTEX) return node->edge == SC_TRACE_NO_EDGE;
    edge = node->edge == SC_TRACE_NO_EDGE ? NULL : edge_named(t, node->edge);
    return edge && (kind == SC_TRACE_BORDER ? edge->count == 1
                                            : kind == SC_TRACE_BRANCH && edge->count > 2);
}

/* Whether a contour goes on at a node as its edge says: the triangle that has it is another one,
   and the other sheet's the same. */
static int goes_on(const traced_pose *t, const sc_trace_node *node, const uint32_t before[2],
                   const uint32_t behind[2])
{
    const trace_oracle_edge *edge = edge_named(t, node->edge);
    const int s = (int)node->sheet;
    return edge && edge->count == 2 && before[1 - s] == behind[1 - s] && before[s] != behind[s] &&
           edge_has(edge, before[s]) && edge_has(edge, behind[s]);
}

/* Segments that were met: no two of one pair of triangles. */
typedef struct segments {
    uint64_t count;
    sc_pair *list;
} segments;

static int compare_pairs(const void *a, const void *b)
{
    const sc_pair *p = (const sc_pair *)a, *q = (const sc_pair *)b;
    if (p->a != q->a) return p->a < q->a ? -1 : 1;
    return (p->b > q->b) - (p->b < q->b);
}

static void add_segment(segments *s, const uint32_t sheets[2])
{
    s->list[s->count].a = sheets[0] < sheets[1] ? sheets[0] : sheets[1];
    s->list[s->count++].b = sheets[0] < sheets[1] ? sheets[1] : sheets[0];
}

/* Lengths are the same bit for bit unless a square may leave the range of doubles. */
static int is_length(double found, double length, int is_plain)
{
    return CHECK_MSG(is_plain ? found == length : fabs(found - length) <= 1e-14 * length,
                     "%g, not %g", found, length);
}

static int check_contour(const traced_pose *t, const sc_trace_contour *c, uint32_t *seen,
                         segments *s)
{
    const sc_trace_node *node = t->result.nodes + c->first;
    const int is_closed = c->begin == SC_TRACE_CLOSED;
    const int is_one_sheet = c->flags == SC_TRACE_ONE_SHEET;
    double length = 0;
    int is_plain = 1;
    if (!CHECK(c->count >= 2 && c->first + c->count <= t->result.node_count) ||
        !CHECK((c->end == SC_TRACE_CLOSED) == is_closed && !c->reserved) ||
        !CHECK(c->flags == 0 || (is_closed && is_one_sheet)))
        return 0;
    if (!is_closed &&
        (!CHECK(is_end(t, node, c->begin)) || !CHECK(is_end(t, node + c->count - 1, c->end))))
        return 0;
    for (uint64_t i = 0; i < c->count; ++i) {
        const sc_trace_node *at = node + i, *next = node + (i + 1) % c->count;
        const int is_last = i + 1 == c->count, turned = is_last && is_one_sheet;
        const int sheet = turned ? 1 - (int)next->sheet : (int)next->sheet;
        if (!CHECK(at->sheet < 2 && next->sheet < 2 && !at->reserved) ||
            !CHECK_MSG(is_placed(t, at), "a node is not where it says"))
            return 0;
        if (at->edge != SC_TRACE_NO_EDGE && !CHECK(is_crossing(t, at, seen))) return 0;
        if (at->edge == SC_TRACE_NO_EDGE && !CHECK(!is_closed && (i == 0 || is_last))) return 0;
        if (is_last && !is_closed)
            return CHECK(at->sheets[0] == SC_TRACE_NO_EDGE && at->sheets[1] == SC_TRACE_NO_EDGE) &&
                   is_length(c->length, length, is_plain);
        if (!CHECK(at->sheets[0] < t->triangle_count && at->sheets[1] < t->triangle_count) ||
            !CHECK_MSG(is_on_segment(t, at, at->sheets, (int)at->sheet), "begins elsewhere") ||
            !CHECK_MSG(is_on_segment(t, next, at->sheets, sheet), "ends elsewhere"))
            return 0;
        add_segment(s, at->sheets);
        double square = 0, step = 0;
        for (int k = 0; k < 3; ++k) {
            square += pow(next->point[k] - at->point[k], 2);
            step = hypot(step, next->point[k] - at->point[k]);
        }
        if (step > 0 && !(square > 1e-250 && square < 1e250)) is_plain = 0;
        length += is_plain ? sqrt(square) : step;
        if (!is_last || is_closed) {
            const uint32_t behind[2] = {next->sheets[turned], next->sheets[!turned]};
            sc_trace_node n = *next;
            n.sheet = (uint32_t)sheet;
            if ((is_closed || i + 2 < c->count) && !CHECK(goes_on(t, &n, at->sheets, behind)))
                return 0;
        }
    }
    return is_length(c->length, length, is_plain);
}

/* Each of the oracle's crossings is there once, or once for each triangle of an edge where contours
   branch; and each segment once. */
int traced_pose_check(const traced_pose *t)
{
    const sc_trace_result *r = &t->result;
    uint32_t *seen = (uint32_t *)calloc(t->truth.crossing_count + 1u, sizeof *seen);
    segments s;
    uint64_t ends = 0, branches = 0, at = 0;
    int is_right = 1;
    s.count = 0;
    s.list = (sc_pair *)test_allocate((size_t)r->node_count * sizeof *s.list);
    if (!seen) abort();
    for (uint64_t i = 0; i < r->contour_count && is_right; ++i) {
        const sc_trace_contour *c = &r->contours[i];
        is_right = CHECK(c->first == at) && check_contour(t, c, seen, &s);
        at += c->count;
        ends += (c->begin == SC_TRACE_VERTEX) + (uint64_t)(c->end == SC_TRACE_VERTEX);
    }
    for (uint32_t i = 0; i < t->truth.crossing_count && is_right; ++i) {
        const uint32_t count = t->truth.edges[t->truth.crossings[i].edge].count;
        branches += count;
        is_right =
            CHECK_MSG(seen[i] == (count == 2 ? 1 : count),
                      "crossing %u is in %u contours, edge of %u triangles", i, seen[i], count);
    }
    if (is_right) {
        is_right = CHECK(at == r->node_count) && CHECK(2 * s.count == branches + ends);
        qsort(s.list, (size_t)s.count, sizeof *s.list, compare_pairs);
        for (uint64_t i = 1; i < s.count && is_right; ++i)
            is_right = CHECK(compare_pairs(&s.list[i - 1], &s.list[i]) != 0);
    }
    free(s.list);
    free(seen);
    return is_right;
}
