/*
 * Checks of contours, triples, gradients and regions. See trace_checks.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "trace_checks.h"

#include <float.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "fuzz_support.h"
#include "harness.h"
#include "triple_oracle.h"

static const uint32_t *corners_of(const trace_facts *f, uint32_t triangle)
{
    return f->triangles + 3 * (size_t)triangle;
}

static const double *position_of(const trace_facts *f, uint32_t vertex)
{
    return f->positions + 3 * (size_t)vertex;
}

static int has_corner(const trace_facts *f, uint32_t triangle, uint32_t vertex)
{
    const uint32_t *v = corners_of(f, triangle);
    return v[0] == vertex || v[1] == vertex || v[2] == vertex;
}

static int is_collapsed(const trace_facts *f, uint32_t triangle)
{
    const uint32_t *v = corners_of(f, triangle);
    return v[0] == v[1] || v[1] == v[2] || v[2] == v[0];
}

/* The vertices of a node: the ends of its edge and the corners of its triangle; of one at a vertex,
   that five times. */
static void name_vertices(const trace_facts *f, const sc_trace_node *node, uint32_t v[5])
{
    for (int i = 0; i < 5; ++i) v[i] = node->triangle;
    if (node->edge == SC_TRACE_NO_EDGE) return;
    v[0] = f->triangles[node->edge];
    v[1] = f->triangles[node->edge / 3 * 3 + (node->edge + 1) % 3];
    memcpy(v + 2, corners_of(f, node->triangle), 3 * sizeof *v);
}

static double distance(const double *p, const double *q)
{
    return sqrt((q[0] - p[0]) * (q[0] - p[0]) + (q[1] - p[1]) * (q[1] - p[1]) +
                (q[2] - p[2]) * (q[2] - p[2]));
}

/* ---- contours ---- */

/* Walks through contours, counting how often each of the oracle's crossings is met. */
typedef struct contour_walk {
    const trace_facts *facts;
    const trace_oracle_answer *truth;
    uint32_t *met;
    sc_pair *segments;
    uint64_t segment_count;
} contour_walk;

/* The crossing that a node is; NULL where it is none. */
static const trace_oracle_crossing *find_crossing(const contour_walk *w, const sc_trace_node *node)
{
    for (uint32_t i = 0; i < w->truth->crossing_count; ++i) {
        const trace_oracle_crossing *c = &w->truth->crossings[i];
        if (c->triangle == node->triangle && w->truth->edges[c->edge].name == node->edge) return c;
    }
    return NULL;
}

static int edge_has(const trace_oracle_edge *edge, uint32_t triangle)
{
    for (uint32_t i = 0; i < edge->count; ++i)
        if (edge->triangles[i] == triangle) return 1;
    return 0;
}

/* The oracle's edge at a node, which has to be one of its crossings, where it says. */
static const trace_oracle_edge *meet_node(contour_walk *w, const sc_trace_node *node)
{
    const trace_oracle_crossing *crossing = find_crossing(w, node);
    const double *p[5];
    uint32_t v[5];
    FUZZ_CHECK(crossing != NULL, "edge %" PRIu32 " does not cross triangle %" PRIu32, node->edge,
               node->triangle);
    ++w->met[crossing - w->truth->crossings];
    name_vertices(w->facts, node, v);
    for (int i = 0; i < 5; ++i) p[i] = position_of(w->facts, v[i]);
    FUZZ_CHECK(trace_oracle_is_placed(p, node->along, node->weights, node->point),
               "edge %" PRIu32 ", triangle %" PRIu32 ": not at %a of the edge", node->edge,
               node->triangle, node->along);
    return &w->truth->edges[crossing->edge];
}

/* What a contour does at its first or last node, where the segment of two triangles begins or ends;
   and at others, where it comes from one segment and goes on to the next. */
static void check_node(contour_walk *w, const sc_trace_node *node, uint32_t sheet,
                       const uint32_t *before, const uint32_t *behind, uint32_t kind)
{
    const uint32_t *at = before ? before : behind;
    const trace_oracle_edge *edge;
    FUZZ_CHECK(!node->reserved && node->sheet < 2, "sheet %" PRIu32, node->sheet);
    if (node->edge == SC_TRACE_NO_EDGE) {
        FUZZ_CHECK(kind == SC_TRACE_VERTEX && (!before || !behind), "a vertex amid a contour");
        FUZZ_CHECK(has_corner(w->facts, at[0], node->triangle) &&
                       has_corner(w->facts, at[1], node->triangle),
                   "vertex %" PRIu32 " is not shared", node->triangle);
        FUZZ_CHECK(memcmp(node->point, position_of(w->facts, node->triangle), sizeof node->point) ==
                           0 &&
                       node->along == 0 && node->weights[0] == 0,
                   "vertex %" PRIu32, node->triangle);
        return;
    }
    edge = meet_node(w, node);
    FUZZ_CHECK((edge->count == 2) == (before && behind), "an edge of %" PRIu32 " triangles",
               edge->count);
    FUZZ_CHECK(before && behind ? kind == SC_TRACE_CLOSED
                                : kind == (edge->count == 1 ? SC_TRACE_BORDER : SC_TRACE_BRANCH),
               "an end of kind %" PRIu32 " at an edge of %" PRIu32 " triangles", kind, edge->count);
    for (int i = 0; i < 2; ++i) {
        const uint32_t *segment = i ? behind : before;
        FUZZ_CHECK(!segment ||
                       (edge_has(edge, segment[sheet]) && segment[1 - sheet] == node->triangle),
                   "edge %" PRIu32 " is not on the segment's border", node->edge);
    }
    FUZZ_CHECK(!before || !behind || before[sheet] != behind[sheet], "turns back at edge %" PRIu32,
               node->edge);
}

static void add_segment(contour_walk *w, const uint32_t sheets[2])
{
    const trace_facts *f = w->facts;
    const uint32_t a = sheets[0], b = sheets[1];
    sc_pair *segment = &w->segments[w->segment_count++];
    FUZZ_CHECK(a < f->triangle_count && b < f->triangle_count && a != b && !is_collapsed(f, a) &&
                   !is_collapsed(f, b),
               "a segment of triangles %" PRIu32 " and %" PRIu32, a, b);
    segment->a = a < b ? a : b;
    segment->b = a < b ? b : a;
}

static void check_contour(contour_walk *w, const sc_trace_contour *c)
{
    const sc_trace_node *node = w->facts->trace.nodes + c->first;
    const int is_closed = c->begin == SC_TRACE_CLOSED;
    const uint64_t last = c->count - 1;
    const uint32_t *before = NULL;
    uint32_t turned[2];
    double length = 0;
    FUZZ_CHECK(c->count >= 2 && c->begin <= SC_TRACE_VERTEX && c->end <= SC_TRACE_VERTEX &&
                   (c->end == SC_TRACE_CLOSED) == is_closed && !c->reserved &&
                   (c->flags == 0 || (c->flags == SC_TRACE_ONE_SHEET && is_closed)),
               "%" PRIu64 " nodes, begin %" PRIu32 ", end %" PRIu32, c->count, c->begin, c->end);
    if (is_closed) { /* the segment that ends at the first node, as the sheets are there */
        turned[0] = node[last].sheets[c->flags == SC_TRACE_ONE_SHEET];
        turned[1] = node[last].sheets[c->flags != SC_TRACE_ONE_SHEET];
        before = turned;
    }
    for (uint64_t i = 0; i < c->count; ++i) {
        const int is_end = !is_closed && i == last;
        const uint32_t *behind = is_end ? NULL : node[i].sheets;
        if (behind)
            add_segment(w, behind);
        else
            FUZZ_CHECK(node[i].sheets[0] == SC_TRACE_NO_EDGE &&
                           node[i].sheets[1] == SC_TRACE_NO_EDGE,
                       "a segment behind the end");
        check_node(w, &node[i], node[i].sheet, before, behind,
                   is_end   ? c->end
                   : before ? SC_TRACE_CLOSED
                            : c->begin);
        before = behind;
        if (i < last) length += distance(node[i].point, node[i + 1].point);
    }
    if (is_closed) length += distance(node[last].point, node[0].point);
    FUZZ_CHECK(c->length == length, "length %a instead of %a", c->length, length);
}

static int compare_segments(const void *a, const void *b)
{
    const sc_pair *p = (const sc_pair *)a, *q = (const sc_pair *)b;
    if (p->a != q->a) return p->a < q->a ? -1 : 1;
    return (p->b > q->b) - (p->b < q->b);
}

void trace_check_contours(const trace_facts *facts, const trace_oracle_answer *truth)
{
    const sc_trace_result *r = &facts->trace;
    contour_walk w = {facts, truth, NULL, NULL, 0};
    uint64_t nodes = 0;
    w.met = (uint32_t *)calloc(truth->crossing_count + 1u, sizeof *w.met);
    w.segments = (sc_pair *)test_allocate((size_t)r->node_count * sizeof *w.segments);
    if (!w.met) abort();
    for (uint64_t i = 0; i < r->contour_count; ++i) {
        FUZZ_CHECK(r->contours[i].first == nodes, "contour %" PRIu64, i);
        nodes += r->contours[i].count;
        FUZZ_CHECK(nodes <= r->node_count, "%" PRIu64 " nodes", nodes);
        check_contour(&w, &r->contours[i]);
    }
    FUZZ_CHECK(nodes == r->node_count, "%" PRIu64 " nodes in contours", nodes);
    for (uint32_t i = 0; i < truth->crossing_count; ++i) {
        const trace_oracle_edge *edge = &truth->edges[truth->crossings[i].edge];
        FUZZ_CHECK(w.met[i] == (edge->count == 2 ? 1 : edge->count),
                   "edge %" PRIu32 " of %" PRIu32 " triangles, triangle %" PRIu32 ": in %" PRIu32
                   " contours",
                   edge->name, edge->count, truth->crossings[i].triangle, w.met[i]);
    }
    qsort(w.segments, (size_t)w.segment_count, sizeof *w.segments, compare_segments);
    for (uint64_t i = 1; i < w.segment_count; ++i)
        FUZZ_CHECK(compare_segments(&w.segments[i - 1], &w.segments[i]) != 0,
                   "triangles %" PRIu32 " and %" PRIu32 " twice", w.segments[i].a, w.segments[i].b);
    free(w.segments);
    free(w.met);
}

/* ---- triples ---- */

enum { TRIPLES_LOOKED_AT = 4 };

/* The node behind a node of a contour that is not its end. */
static const sc_trace_node *node_behind(const trace_facts *f, uint64_t node)
{
    const sc_trace_result *r = &f->trace;
    for (uint64_t i = 0; i < r->contour_count; ++i)
        if (node - r->contours[i].first < r->contours[i].count)
            return &r->nodes[r->contours[i].first +
                             (node + 1 - r->contours[i].first) % r->contours[i].count];
    FUZZ_CHECK(0, "node %" PRIu64 " is in no contour", node);
    return NULL;
}

/* On which side of a triangle's plane a node is. */
static int side_of_node(const trace_facts *f, const sc_trace_node *node, uint32_t triangle)
{
    const double *p[8];
    uint32_t v[8];
    if (node->edge == SC_TRACE_NO_EDGE) {
        memcpy(v, corners_of(f, triangle), 3 * sizeof *v);
        v[3] = node->triangle;
        for (int i = 0; i < 4; ++i) p[i] = position_of(f, v[i]);
        return has_corner(f, triangle, node->triangle) ? 0 : trace_oracle_sign(p, v);
    }
    name_vertices(f, node, v);
    memcpy(v + 5, corners_of(f, triangle), 3 * sizeof *v);
    for (int i = 0; i < 8; ++i) p[i] = position_of(f, v[i]);
    return triple_oracle_side(p, v);
}

static void check_triple(const trace_facts *f, const sc_trace_triple *t, int is_looked_at)
{
    for (int i = 0; i < 3; ++i) {
        const uint32_t a = t->triangles[(i + 1) % 3], b = t->triangles[(i + 2) % 3];
        const sc_trace_node *node, *next;
        FUZZ_CHECK(t->nodes[i] < f->trace.node_count && t->along[i] >= 0 && t->along[i] <= 1,
                   "node %" PRIu64 ", %a behind it", t->nodes[i], t->along[i]);
        node = &f->trace.nodes[t->nodes[i]];
        next = node_behind(f, t->nodes[i]);
        FUZZ_CHECK((node->sheets[0] == a && node->sheets[1] == b) ||
                       (node->sheets[0] == b && node->sheets[1] == a),
                   "behind node %" PRIu64 " is another segment", t->nodes[i]);
        for (int k = 0; k < 3 && i == 2; ++k)
            FUZZ_CHECK(t->point[k] >= fmin(node->point[k], next->point[k]) &&
                           t->point[k] <= fmax(node->point[k], next->point[k]),
                       "%a is beside the segment", t->point[k]);
        FUZZ_CHECK(
            !is_looked_at ||
                side_of_node(f, node, t->triangles[i]) * side_of_node(f, next, t->triangles[i]) < 0,
            "triangle %" PRIu32 " is not passed through", t->triangles[i]);
    }
}

void trace_check_triples(const trace_facts *facts, const sc_triples_result *triples)
{
    for (uint64_t i = 0; i < triples->count; ++i) {
        const sc_trace_triple *t = &triples->triples[i], *last = i ? t - 1 : NULL;
        const uint32_t *now = t->triangles;
        FUZZ_CHECK(now[0] < now[1] && now[1] < now[2] && !t->reserved, "triple %" PRIu64, i);
        FUZZ_CHECK(!last || last->triangles[0] < now[0] ||
                       (last->triangles[0] == now[0] &&
                        (last->triangles[1] < now[1] ||
                         (last->triangles[1] == now[1] && last->triangles[2] < now[2]))),
                   "triple %" PRIu64 " comes too late", i);
        check_triple(facts, t, i < TRIPLES_LOOKED_AT);
    }
}

/* ---- gradients ---- */

static void subtract(const double *p, const double *q, double v[3])
{
    for (int i = 0; i < 3; ++i) v[i] = p[i] - q[i];
}

static double norm(const double v[3])
{
    return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

/* The node before (by < 0) or behind another one of a contour, or NULL. */
static const sc_trace_node *neighbor(const trace_facts *f, const sc_trace_contour *c, uint64_t i,
                                     int by)
{
    const sc_trace_node *node = f->trace.nodes + c->first;
    if (by < 0 && i == 0) return c->begin == SC_TRACE_CLOSED ? &node[c->count - 1] : NULL;
    if (by > 0 && i + 1 == c->count) return c->begin == SC_TRACE_CLOSED ? node : NULL;
    return by < 0 ? &node[i - 1] : &node[i + 1];
}

/* By how much components of a node's vectors may be off, as starcontour.h says: coordinates are at
   most `largest`. Where that cannot be told in doubles it is no finite number. */
static double error_of(const trace_facts *f, const sc_trace_contour *c, uint64_t i, double largest)
{
    const sc_trace_node *node = f->trace.nodes + c->first + i;
    double shorter = DBL_MAX, a = 1, b = 1;
    for (int by = -1; by < 2; by += 2) {
        const sc_trace_node *other = neighbor(f, c, i, by);
        if (other) shorter = fmin(shorter, distance(node->point, other->point));
    }
    if (node->edge != SC_TRACE_NO_EDGE) {
        uint32_t v[5];
        double d[3], u[2][3], n[3], volume = 0;
        name_vertices(f, node, v);
        subtract(position_of(f, v[1]), position_of(f, v[0]), d);
        for (int k = 0; k < 2; ++k) subtract(position_of(f, v[3 + k]), position_of(f, v[2]), u[k]);
        for (int k = 0; k < 3; ++k) {
            n[k] = u[0][(k + 1) % 3] * u[1][(k + 2) % 3] - u[0][(k + 2) % 3] * u[1][(k + 1) % 3];
            volume += n[k] * d[k];
        }
        a = fabs(volume) / (norm(n) * norm(d));
        b = norm(n) / (norm(u[0]) * norm(u[1]));
    }
    return 0x1p-45 * (largest / shorter + 1 / (a * b)) / a;
}

/* What a contour's gradient pushes the whole mesh by. Not where a node is flat, which has nothing
   of it, or where a segment counts as none at one of its ends alone. */
static void check_push(const trace_facts *f, const sc_trace_contour *c,
                       const sc_trace_gradient *gradients, double largest)
{
    double push[3] = {0, 0, 0}, off = 0;
    for (uint64_t i = 0; i < c->count; ++i) {
        const sc_trace_gradient *g = &gradients[c->first + i];
        if (g->flags) return;
        off += 2 * error_of(f, c, i, largest);
        for (int k = 0; k < 3; ++k) {
            push[k] += g->vectors[0][k] + g->vectors[1][k];
            off +=
                (double)c->count * DBL_EPSILON * (fabs(g->vectors[0][k]) + fabs(g->vectors[1][k]));
        }
    }
    for (int k = 0; k < 3 && isfinite(off); ++k)
        FUZZ_CHECK(fabs(push[k]) <= 2 * off, "pushes by %g, error %g", push[k], off);
}

static void check_stencil(const trace_facts *f, const sc_trace_contour *c, uint64_t i,
                          const sc_trace_gradient *g)
{
    const sc_trace_node *node = f->trace.nodes + c->first + i;
    const int is_vertex = node->edge == SC_TRACE_NO_EDGE;
    int is_short = 0, may_be_short = 0;
    uint32_t v[5];
    name_vertices(f, node, v);
    FUZZ_CHECK(memcmp(v, g->vertices, sizeof v) == 0, "vertices of node %" PRIu64, c->first + i);
    for (int k = 0; k < 6; ++k)
        FUZZ_CHECK(isfinite(g->vectors[k / 3][k % 3]) &&
                       (!(g->flags & SC_GRADIENT_FLAT) || g->vectors[k / 3][k % 3] == 0),
                   "vector %g, flags %" PRIu32, g->vectors[k / 3][k % 3], g->flags);
    FUZZ_CHECK(g->weights[0] == (is_vertex ? 1 : 1 - node->along) && g->weights[1] == node->along &&
                   memcmp(g->weights + 2, node->weights, sizeof node->weights) == 0,
               "weights of node %" PRIu64, c->first + i);
    for (int by = -1; by < 2; by += 2) {
        const sc_trace_node *other = neighbor(f, c, i, by);
        if (!other) continue;
        is_short |= memcmp(other->point, node->point, sizeof node->point) == 0;
        for (int k = 0; k < 3; ++k)
            may_be_short |= fabs(other->point[k] - node->point[k]) > DBL_MAX / 2;
        may_be_short |= distance(other->point, node->point) < 0x1p-500;
    }
    FUZZ_CHECK(g->flags <= (SC_GRADIENT_FLAT | SC_GRADIENT_SHORT) &&
                   (!is_vertex || !(g->flags & SC_GRADIENT_FLAT)) &&
                   (!is_short || g->flags & SC_GRADIENT_SHORT) &&
                   (is_short || may_be_short || !(g->flags & SC_GRADIENT_SHORT)),
               "flags %" PRIu32, g->flags);
}

/* The largest coordinate; *is_mild tells whether products of some of them are all in the range of
   doubles. */
static double largest_of(const trace_facts *f, int *is_mild)
{
    double largest = 0;
    *is_mild = 1;
    for (uint32_t i = 0; i < 3 * f->triangle_count; ++i)
        for (int k = 0; k < 3; ++k) {
            const double x = fabs(position_of(f, f->triangles[i])[k]);
            largest = fmax(largest, x);
            *is_mild &= x == 0 || (x > 1e-40 && x < 1e40);
        }
    return largest;
}

void trace_check_gradients(const trace_facts *facts, const sc_trace_gradient *gradients)
{
    int is_mild;
    const double largest = largest_of(facts, &is_mild);
    for (uint64_t n = 0; n < facts->trace.contour_count; ++n) {
        const sc_trace_contour *c = &facts->trace.contours[n];
        for (uint64_t i = 0; i < c->count; ++i)
            check_stencil(facts, c, i, &gradients[c->first + i]);
        if (is_mild) check_push(facts, c, gradients, largest);
    }
}

/* ---- regions ---- */

static uint32_t root_of(uint32_t *parent, uint32_t i)
{
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
}

/* Joins two; the lower one stands for both. */
static void join(uint32_t *parent, uint32_t a, uint32_t b)
{
    a = root_of(parent, a);
    b = root_of(parent, b);
    parent[a < b ? b : a] = a < b ? a : b;
}

/* Whether a contour passes through side k of a triangle. */
static int is_crossed(const trace_facts *f, uint32_t a, uint32_t b)
{
    for (uint64_t i = 0; i < f->trace.node_count; ++i) {
        const sc_trace_node *node = &f->trace.nodes[i];
        uint32_t v[5];
        if (node->edge == SC_TRACE_NO_EDGE) continue;
        name_vertices(f, node, v);
        if ((v[0] == a && v[1] == b) || (v[0] == b && v[1] == a)) return 1;
    }
    return 0;
}

/* Vertices: who is in which region, and in which component. */
static void check_vertices(const trace_facts *f, const sc_regions_result *r)
{
    uint32_t *parent = (uint32_t *)test_allocate(f->vertex_count * sizeof *parent);
    uint32_t *count = (uint32_t *)calloc((size_t)r->region_count + 1, sizeof *count);
    uint8_t *is_used = (uint8_t *)calloc(f->vertex_count, 1);
    uint32_t reached = 0;
    if (!count || !is_used) abort();
    for (uint32_t v = 0; v < f->vertex_count; ++v) parent[v] = v;
    for (uint32_t t = 0; t < f->triangle_count; ++t)
        for (int k = 0; k < 3; ++k) {
            const uint32_t a = corners_of(f, t)[k], b = corners_of(f, t)[(k + 1) % 3];
            if (is_collapsed(f, t)) continue;
            is_used[a] = 1;
            join(parent, a, b);
            FUZZ_CHECK(r->vertex_regions[a] == r->vertex_regions[b] || is_crossed(f, a, b),
                       "an edge from vertex %" PRIu32 " to %" PRIu32 " that nothing crosses", a, b);
        }
    for (uint32_t v = 0; v < f->vertex_count; ++v) {
        const uint32_t region = r->vertex_regions[v];
        FUZZ_CHECK((region != SC_TRACE_NO_EDGE) == is_used[v], "vertex %" PRIu32, v);
        if (region == SC_TRACE_NO_EDGE) continue;
        FUZZ_CHECK(region < r->region_count && region <= reached,
                   "region %" PRIu32 " of vertex %" PRIu32, region, v);
        reached += region == reached; /* regions come in the order of their lowest vertices */
        ++count[region];
        FUZZ_CHECK(r->regions[region].component == root_of(parent, v),
                   "component %" PRIu32 " of vertex %" PRIu32, r->regions[region].component, v);
    }
    for (uint64_t i = 0; i < r->region_count; ++i)
        FUZZ_CHECK(r->regions[i].vertex_count == count[i] && !r->regions[i].reserved,
                   "%" PRIu32 " vertices instead of %" PRIu32, r->regions[i].vertex_count,
                   count[i]);
    free(is_used);
    free(count);
    free(parent);
}

/* Areas, in units in which the largest coordinate is 1; not where they may be no doubles. */
static void check_areas(const trace_facts *f, const sc_regions_result *r)
{
    int is_mild;
    const double size = largest_of(f, &is_mild);
    double whole = 0, off = 0, sum = 0;
    if (!(size > 1e-140 && size < 1e140)) return;
    for (uint32_t t = 0; t < f->triangle_count; ++t) {
        double u[2][3], n[3];
        if (is_collapsed(f, t)) continue;
        for (int k = 0; k < 2; ++k) {
            subtract(position_of(f, corners_of(f, t)[k + 1]), position_of(f, corners_of(f, t)[0]),
                     u[k]);
            for (int i = 0; i < 3; ++i) u[k][i] /= size;
        }
        for (int k = 0; k < 3; ++k)
            n[k] = u[0][(k + 1) % 3] * u[1][(k + 2) % 3] - u[0][(k + 2) % 3] * u[1][(k + 1) % 3];
        whole += norm(n) / 2;
        off += norm(u[0]) * norm(u[1]);
    }
    for (uint64_t i = 0; i < r->region_count; ++i) sum += r->regions[i].area / size / size;
    FUZZ_CHECK(fabs(sum - whole) <= 1e-9 * whole + 1e-12 * off, "areas: %g, not %g", sum, whole);
}

void trace_check_regions(const trace_facts *facts, const sc_regions_result *regions)
{
    check_vertices(facts, regions);
    check_areas(facts, regions);
    for (uint64_t i = 0; i < regions->region_count; ++i) {
        FUZZ_CHECK(!isnan(regions->regions[i].area), "the area of region %" PRIu64, i);
        FUZZ_CHECK(regions->flags & SC_REGIONS_INSIDE ||
                       regions->regions[i].inside == SC_REGION_UNKNOWN,
                   "inside %" PRId32 ", which nobody asked for", regions->regions[i].inside);
    }
    for (uint64_t i = 0; i < facts->trace.contour_count; ++i)
        for (uint32_t sheet = 0; sheet < 2; ++sheet) {
            const sc_contour_sides *c = &regions->sides[i];
            const uint32_t a = c->sides[sheet][0], b = c->sides[sheet][1];
            uint32_t hint;
            FUZZ_CHECK(a < regions->region_count && b < regions->region_count,
                       "sides of contour %" PRIu64, i);
            FUZZ_CHECK(regions->regions[a].component == regions->regions[b].component,
                       "sides of contour %" PRIu64 " in two components", i);
            hint = sc_region_hint(regions->regions, c, sheet);
            FUZZ_CHECK(hint == SC_TRACE_NO_EDGE
                           ? a == b || regions->regions[a].area == regions->regions[b].area
                           : hint < 2 && a != b &&
                                 regions->regions[c->sides[sheet][hint]].area <
                                     regions->regions[c->sides[sheet][1 - hint]].area,
                       "hint %" PRIu32, hint);
        }
}
