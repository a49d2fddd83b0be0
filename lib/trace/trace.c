/*
 * Follows contours from crossing to crossing. See trace.h.
 *
 * SPDX-License-Identifier: MIT
 *
 * A crossing whose edge has two triangles has two branches: a contour comes by one and goes on by
 * the other. Where the edge has one, or three or more, each branch is an end. So contours are
 * followed from ends first; what is left then is closed.
 */
#include "trace/trace.h"

#include <float.h>
#include <math.h>

#include "trace/sheets.h"

/* A walk along all contours. */
typedef struct trace_walk {
    const sc_trace_subject *subject;
    const sc_crossings *crossings;
    const sc_sheets *sheets;
    uint8_t *is_done; /* of each branch */
    sc_trace_result *result;
    uint32_t now[2]; /* the triangles of the segment at hand, one of each sheet */
} trace_walk;

static uint32_t branch_count(const sc_sheets *s, uint32_t crossing)
{
    return s->first[crossing + 1] - s->first[crossing];
}

/* The kind of end that a crossing is, or SC_TRACE_CLOSED if contours go on there. */
static uint32_t end_kind(const sc_sheets *s, uint32_t crossing)
{
    const uint32_t count = branch_count(s, crossing);
    return count == 2 ? SC_TRACE_CLOSED : count == 1 ? SC_TRACE_BORDER : SC_TRACE_BRANCH;
}

/* Adds a node, if there is room for it, behind which comes the segment at hand if there is one. */
static sc_trace_node *add_trace_node(trace_walk *w, int goes_on)
{
    sc_trace_result *r = w->result;
    sc_trace_node *node = NULL;
    if (r->node_count < r->node_capacity) {
        node = &r->nodes[r->node_count];
        memset(node, 0, sizeof *node);
        node->sheets[0] = goes_on ? w->now[0] : SC_TRACE_NO_EDGE;
        node->sheets[1] = goes_on ? w->now[1] : SC_TRACE_NO_EDGE;
    }
    r->node_count++;
    return node;
}

static void add_crossing(trace_walk *w, uint32_t crossing, uint32_t sheet, int goes_on)
{
    const sc_crossing_place *place = &w->crossings->places[crossing];
    sc_trace_node *node = add_trace_node(w, goes_on);
    if (!node) return;
    node->edge = w->crossings->pairs[crossing].a;
    node->triangle = w->crossings->pairs[crossing].b;
    node->sheet = sheet;
    node->along = place->along;
    memcpy(node->weights, place->weights, sizeof node->weights);
    memcpy(node->point, place->point, sizeof node->point);
}

/* Adds the vertex that the triangles of the segment at hand share. */
static void add_vertex(trace_walk *w, int goes_on)
{
    const sc_trace_subject *s = w->subject;
    sc_trace_node *node = add_trace_node(w, goes_on);
    if (!node) return;
    node->edge = SC_TRACE_NO_EDGE;
    node->triangle = sc_sheets_shared_vertex(s->model, w->now[0], w->now[1]);
    sc_positions_get(&s->positions, node->triangle, node->point);
}

static void begin_segment(trace_walk *w, uint32_t branch)
{
    w->now[0] = w->sheets->triangle[branch];
    w->now[1] = w->sheets->crossings[w->sheets->crossing[branch]].b;
}

/*
 * Follows a contour along the segment at hand, which a branch is the begin of, through crossings to
 * its end. Closed ones end before the branch they began with. Returns what is there: SC_TRACE_...,
 * and for closed contours in *is_one_sheet whether the sheets are exchanged.
 */
static uint32_t follow(trace_walk *w, uint32_t branch, int *is_one_sheet)
{
    const sc_sheets *s = w->sheets;
    const uint32_t first = s->crossing[branch];
    *is_one_sheet = 0;
    for (;;) {
        uint32_t next = s->other[branch], crossing, kind, sheet;
        w->is_done[branch] = 1;
        if (next == SC_NONE) {
            add_vertex(w, 0);
            return SC_TRACE_VERTEX;
        }
        w->is_done[next] = 1;
        crossing = s->crossing[next];
        kind = end_kind(s, crossing);
        sheet = w->now[0] != s->triangle[next]; /* that of the edge, which has this triangle */
        if (kind != SC_TRACE_CLOSED) {
            add_crossing(w, crossing, sheet, 0);
            return kind;
        }
        if (crossing == first) {
            *is_one_sheet = sheet != 0; /* at first it was 0 */
            return SC_TRACE_CLOSED;
        }
        branch = next == s->first[crossing] ? next + 1 : next - 1;
        w->now[sheet] = s->triangle[branch];
        add_crossing(w, crossing, sheet, 1);
    }
}

/* A contour whose first node was the node_count'th. */
static void add_contour(trace_walk *w, uint64_t first, uint32_t begin, uint32_t end,
                        int is_one_sheet)
{
    sc_trace_result *r = w->result;
    if (r->contour_count < r->contour_capacity) {
        sc_trace_contour *contour = &r->contours[r->contour_count];
        memset(contour, 0, sizeof *contour);
        contour->first = first;
        contour->count = r->node_count - first;
        contour->begin = begin;
        contour->end = end;
        contour->flags = is_one_sheet ? SC_TRACE_ONE_SHEET : 0;
    }
    r->contour_count++;
}

/* The contour that begins at a crossing with a branch. */
static void follow_from(trace_walk *w, uint32_t branch)
{
    const uint64_t first = w->result->node_count;
    const uint32_t crossing = w->sheets->crossing[branch], begin = end_kind(w->sheets, crossing);
    uint32_t end;
    int is_one_sheet;
    begin_segment(w, branch);
    add_crossing(w, crossing, 0, 1);
    end = follow(w, branch, &is_one_sheet);
    add_contour(w, first, begin, end, is_one_sheet);
}

/* The contour that begins at the vertex to which a branch leads. */
static void follow_from_vertex(trace_walk *w, uint32_t branch)
{
    const sc_sheets *s = w->sheets;
    const uint64_t first = w->result->node_count;
    const uint32_t crossing = s->crossing[branch];
    const uint32_t further = branch == s->first[crossing] ? branch + 1 : branch - 1;
    uint32_t end;
    int is_one_sheet;
    w->is_done[branch] = 1;
    begin_segment(w, branch);
    add_vertex(w, 1);
    w->now[0] = s->triangle[further];
    add_crossing(w, crossing, 0, 1);
    end = follow(w, further, &is_one_sheet);
    add_contour(w, first, SC_TRACE_VERTEX, end, is_one_sheet);
}

static void follow_all(trace_walk *w)
{
    const sc_sheets *s = w->sheets;
    const uint32_t branches = s->first[s->count];
    uint32_t i;
    for (i = 0; i < branches; i++)
        if (!w->is_done[i] && end_kind(s, s->crossing[i]) != SC_TRACE_CLOSED) follow_from(w, i);
    for (i = 0; i < branches; i++)
        if (!w->is_done[i] && s->other[i] == SC_NONE) follow_from_vertex(w, i);
    for (i = 0; i < branches; i++)
        if (!w->is_done[i]) follow_from(w, i);
}

static double distance_between(const double p[3], const double q[3])
{
    const double x = q[0] - p[0], y = q[1] - p[1], z = q[2] - p[2];
    const double square = x * x + y * y + z * z;
    double largest = fabs(x) > fabs(y) ? fabs(x) : fabs(y), u, v, w;
    int exponent;
    if (square > 1e-250 && square < 1e250) return sqrt(square);
    /* Squares may be beyond the range of doubles: the same in units of the largest's size. */
    if (fabs(z) > largest) largest = fabs(z);
    if (!(largest > 0 && largest <= DBL_MAX)) return largest;
    (void)frexp(largest, &exponent);
    u = ldexp(x, -exponent);
    v = ldexp(y, -exponent);
    w = ldexp(z, -exponent);
    return ldexp(sqrt(u * u + v * v + w * w), exponent);
}

static void measure_traces(const sc_trace_result *r)
{
    uint64_t i, k;
    for (i = 0; i < r->contour_count; i++) {
        sc_trace_contour *c = &r->contours[i];
        const sc_trace_node *node = r->nodes + c->first;
        for (k = 0; k + 1 < c->count; k++)
            c->length += distance_between(node[k].point, node[k + 1].point);
        if (c->begin == SC_TRACE_CLOSED)
            c->length += distance_between(node[k].point, node[0].point);
    }
}

sc_status sc_trace_run(const sc_trace_subject *subject, sc_scratch *scratch,
                       sc_trace_result *result)
{
    sc_crossings crossings;
    sc_sheets sheets;
    trace_walk walk;
    sc_status status = sc_crossings_find(subject, scratch, &crossings);
    if (!status)
        status = sc_sheets_find(subject, crossings.pairs, crossings.count, scratch, &sheets);
    if (status) return status;
    walk.subject = subject;
    walk.crossings = &crossings;
    walk.sheets = &sheets;
    walk.result = result;
    walk.is_done = (uint8_t *)sc_scratch_take_filled(scratch, sheets.first[crossings.count], 1, 0);
    if (!walk.is_done) return SC_ERROR_MEMORY;
    follow_all(&walk);
    if (sc_trace_is_cancelled(subject)) return SC_ERROR_INCOMPLETE;
    if (result->node_count > result->node_capacity ||
        result->contour_count > result->contour_capacity)
        return SC_ERROR_SHORT_BUFFER;
    measure_traces(result);
    return SC_OK;
}
