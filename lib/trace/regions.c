/*
 * Divides the surface along contours. See regions.h.
 *
 * SPDX-License-Identifier: MIT
 *
 * Areas. In a triangle with corners 0, 1, 2 a point is given by its weights of corners 1 and 2; a
 * part of the triangle is that share of it which is the sum of x_i y_i+1 - x_i+1 y_i round the
 * part. So each interval on the border adds a term to the part that it is of, and each chain the
 * same terms to the parts on its two sides, with opposite signs. No polygon is put together for
 * that.
 */
#include "trace/regions.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "base/assume.h"
#include "base/sort.h"
#include "base/wide.h"
#include "trace/crossed_edges.h"

/* A part of a contour in one triangle: nodes of a contour, counted on from its first, round it if
   it is closed. */
typedef struct region_chain {
    uint32_t triangle;
    uint32_t contour;
    uint64_t begin, nodes; /* the first, and how many with it */
    uint32_t sheet;
    uint32_t kind; /* CHAIN_... */
} region_chain;

enum {
    CHAIN_ACROSS, /* from an edge of the triangle to an edge */
    CHAIN_LOOP,   /* all of a closed contour */
    CHAIN_LOOSE   /* begins or ends within the triangle, or at a corner */
};

/* Where something is on the border of a triangle: side, place among the crossings there. */
typedef struct border_mark {
    double x, y;      /* weights of corners 1 and 2 */
    uint32_t element; /* of the interval behind it */
    uint32_t side;    /* that interval's, from corner side on */
    uint32_t chain;   /* which chain begins or ends here, of those of the triangle, or SC_NONE */
} border_mark;

/* Everything that finding regions works with. */
typedef struct region_work {
    const sc_trace_subject *subject;
    const sc_trace_result *trace;
    sc_scratch *scratch;
    sc_crossed_edges edges;
    sc_pair *crossings; /* the trace's, each once, sorted */
    uint32_t crossing_count;
    uint32_t
        *edge_first; /* edges.count + 1: crossings of edge e, in the order along it, are in order
                             from edge_first[e] on */
    uint32_t *order,
        *rank;        /* crossing_count: crossings along edges; the place of each on its edge */
    double *along;    /* crossing_count */
    uint32_t *parent; /* of elements: vertices, intervals between crossings, loops */
    double *area;     /* of elements */
    uint32_t element_count, interval_first, loop_first, loop_count;
    uint32_t *anchor;        /* of elements that are no vertices: one of their triangle's */
    sc_contour_sides *sides; /* of each contour: elements */
    region_chain *chains;    /* sorted by triangles */
    uint32_t chain_count;
    uint32_t *component;  /* vertex_count: parents, without cuts */
    uint8_t *is_on_sheet; /* vertex_count: it is in a triangle that welding has not collapsed */
    double largest;       /* coordinate of those of triangles */
    double unit;          /* what makes that 1 at most */
    uint32_t *region;     /* of each element that is its own parent */
} region_work;

/* ---- elements ---- */

static uint32_t region_root(uint32_t *parent, uint32_t i)
{
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
}

/* Joins two; the lower one stands for both. */
static void join_elements(uint32_t *parent, uint32_t a, uint32_t b)
{
    a = region_root(parent, a);
    b = region_root(parent, b);
    if (a < b)
        parent[b] = a;
    else
        parent[a] = b;
}

/* The element of interval i of a crossed edge, counted from its lower end. */
static uint32_t element_of(const region_work *w, uint32_t edge, uint32_t i)
{
    const uint32_t count = w->edge_first[edge + 1] - w->edge_first[edge];
    if (i == 0) return w->edges.ends[edge].a;
    if (i == count) return w->edges.ends[edge].b;
    return w->interval_first + w->edge_first[edge] - edge + i - 1;
}

/* ---- crossings of the trace ---- */

/* The number of the crossing that a node is, or SC_NONE. */
static uint32_t crossing_of(const region_work *w, const sc_trace_node *node)
{
    uint32_t low = 0, high = w->crossing_count, middle;
    sc_pair pair;
    pair.a = node->edge;
    pair.b = node->triangle;
    while (low < high) {
        middle = low + (high - low) / 2;
        if (sc_sort_less(w->crossings[middle], pair))
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

/* Lists the crossings of all nodes once. SC_ERROR_PAIRS if one names what does not exist. */
static sc_status list_crossings(region_work *w)
{
    const sc_trace_result *t = w->trace;
    const uint32_t triangles = w->subject->model->triangle_count;
    uint64_t i, count = 0;
    uint32_t kept = 0;
    sc_pair *list = (sc_pair *)sc_scratch_take(w->scratch, t->node_count, sizeof *list);
    if (!list) return SC_ERROR_MEMORY;
    for (i = 0; i < t->node_count; i++) {
        const sc_trace_node *n = &t->nodes[i];
        if (n->edge == SC_TRACE_NO_EDGE) continue;
        if (n->edge / 3 >= triangles || n->triangle >= triangles || n->sheet > 1)
            return SC_ERROR_PAIRS;
        list[count].a = n->edge;
        list[count++].b = n->triangle;
    }
    sc_sort_pairs(list, count);
    for (i = 0; i < count; i++)
        if (!kept || sc_sort_less(list[kept - 1], list[i])) list[kept++] = list[i];
    w->crossings = list;
    w->crossing_count = kept;
    return SC_OK;
}

/* Sorts the crossings of an edge by where they are; ties by the triangle. */
static void sort_along(region_work *w, uint32_t edge)
{
    const uint32_t first = w->edge_first[edge], count = w->edge_first[edge + 1] - first;
    uint32_t *order = w->order + first, i, gap, j;
    for (i = 0; i < count; i++) order[i] = first + i;
    for (gap = 1; gap < count / 3;) gap = 3 * gap + 1;
    for (; gap > 0; gap /= 3)
        for (i = gap; i < count; i++) {
            const uint32_t moved = order[i];
            for (j = i; j >= gap; j -= gap) {
                const uint32_t other = order[j - gap];
                const double before = w->along[other], behind = w->along[moved];
                if (before < behind || (before == behind && other < moved)) break;
                order[j] = other;
            }
            order[j] = moved;
        }
    for (i = 0; i < count; i++) w->rank[order[i]] = i;
}

/* Whether no two edges have the same ends: one has one name. */
static int are_edges_named_once(const sc_crossed_edges *e)
{
    uint32_t i;
    for (i = 0; i < e->count; i++)
        if (sc_crossed_edges_find(e, e->ends[i].a, e->ends[i].b) != i) return 0;
    return 1;
}

/* Puts the crossings of each edge in order, from its lower end on. */
static sc_status order_crossings(region_work *w)
{
    const sc_model *model = w->subject->model;
    const uint32_t count = w->crossing_count;
    uint64_t i;
    uint32_t edge = 0, ends[2], k;
    sc_status status =
        sc_crossed_edges_list(w->subject, w->crossings, count, w->scratch, &w->edges);
    if (status) return status;
    if (!are_edges_named_once(&w->edges)) return SC_ERROR_PAIRS;
    w->edge_first = (uint32_t *)sc_scratch_take(w->scratch, (uint64_t)w->edges.count + 1,
                                                sizeof *w->edge_first);
    w->order = (uint32_t *)sc_scratch_take(w->scratch, count, sizeof *w->order);
    w->rank = (uint32_t *)sc_scratch_take(w->scratch, count, sizeof *w->rank);
    w->along = (double *)sc_scratch_take(w->scratch, count, sizeof *w->along);
    if (!w->edge_first || !w->order || !w->rank || !w->along) return SC_ERROR_MEMORY;
    for (k = 0; k < count; k++)
        if (k == 0 || w->crossings[k].a != w->crossings[k - 1].a) w->edge_first[edge++] = k;
    w->edge_first[edge] = count;
    for (i = 0; i < w->trace->node_count; i++) {
        const sc_trace_node *n = &w->trace->nodes[i];
        if (n->edge == SC_TRACE_NO_EDGE) continue;
        sc_trace_ends(model, n->edge, ends);
        w->along[crossing_of(w, n)] = ends[0] < ends[1] ? n->along : 1 - n->along;
    }
    for (k = 0; k < w->edges.count; k++) sort_along(w, k);
    return SC_OK;
}

/* ---- chains ---- */

static uint64_t node_at(const sc_trace_contour *c, uint64_t i)
{
    return c->first + i % c->count;
}

/* The number that a sheet has at node i, counted on round a contour whose sheets are one: there
   each round leads from one to the other. */
static uint32_t sheet_at(const sc_trace_contour *c, uint32_t sheet, uint64_t i)
{
    return c->flags == SC_TRACE_ONE_SHEET && i / c->count % 2 ? 1 - sheet : sheet;
}

/* Whether the edge of node i is on a sheet. */
static int is_on_edge(const region_work *w, const sc_trace_contour *c, uint32_t sheet, uint64_t i)
{
    const sc_trace_node *node = &w->trace->nodes[node_at(c, i)];
    return node->edge != SC_TRACE_NO_EDGE && node->sheet == sheet_at(c, sheet, i);
}

static void add_chain(region_work *w, const region_chain *chain)
{
    if (w->chains) w->chains[w->chain_count] = *chain;
    w->chain_count++;
}

/* Cuts a contour into chains on one sheet: at the nodes whose edges are on it. */
static void cut_into_chains(region_work *w, uint32_t contour, uint32_t sheet)
{
    const sc_trace_contour *c = &w->trace->contours[contour];
    const int is_closed = c->begin == SC_TRACE_CLOSED;
    const uint64_t count = c->flags == SC_TRACE_ONE_SHEET ? 2 * c->count : c->count;
    uint64_t i = 0, end;
    region_chain chain;
    chain.contour = contour;
    chain.sheet = sheet;
    while (is_closed && i < count && !is_on_edge(w, c, sheet, i)) i++;
    chain.begin = is_closed && i == count ? 0 : i;
    end = chain.begin + count - (is_closed ? 0 : 1);
    for (i = chain.begin; i < end; i++) { /* the segment behind node i */
        const int is_edge = is_on_edge(w, c, sheet, i + 1);
        chain.triangle = w->trace->nodes[node_at(c, i)].sheets[sheet_at(c, sheet, i)];
        if (!is_edge && i + 1 < end) continue;
        chain.nodes = i + 2 - chain.begin;
        chain.kind = is_edge && is_on_edge(w, c, sheet, chain.begin) ? CHAIN_ACROSS
                     : is_closed                                     ? CHAIN_LOOP
                                                                     : CHAIN_LOOSE;
        add_chain(w, &chain);
        chain.begin = i + 1;
    }
}

static void cut_all(region_work *w)
{
    uint32_t i, sheet;
    w->chain_count = 0;
    for (i = 0; i < w->trace->contour_count; i++) {
        const uint32_t sheets = w->trace->contours[i].flags == SC_TRACE_ONE_SHEET ? 1 : 2;
        for (sheet = 0; sheet < sheets; sheet++) cut_into_chains(w, i, sheet);
    }
}

/* Lists the chains of all contours, sorted by triangles. */
static sc_status list_chains(region_work *w)
{
    const uint32_t triangles = w->subject->model->triangle_count;
    region_chain *sorted;
    sc_pair *keys;
    uint32_t i;
    w->chains = NULL;
    cut_all(w); /* counts them */
    w->chains = (region_chain *)sc_scratch_take(w->scratch, w->chain_count, sizeof *w->chains);
    sorted = (region_chain *)sc_scratch_take(w->scratch, w->chain_count, sizeof *sorted);
    keys = (sc_pair *)sc_scratch_take(w->scratch, w->chain_count, sizeof *keys);
    if (!w->chains || !sorted || !keys) return SC_ERROR_MEMORY;
    cut_all(w);
    for (i = 0; i < w->chain_count; i++) {
        if (w->chains[i].triangle >= triangles) return SC_ERROR_PAIRS;
        keys[i].a = w->chains[i].triangle;
        keys[i].b = i;
    }
    sc_sort_pairs(keys, w->chain_count);
    for (i = 0; i < w->chain_count; i++) sorted[i] = w->chains[keys[i].b];
    sc_scratch_give(w->scratch, keys);
    sc_scratch_give(w->scratch, w->chains);
    w->chains = sorted;
    return SC_OK;
}

/* ---- one triangle ---- */

/* The border of a triangle, its chains and its parts. */
typedef struct divided {
    uint32_t triangle;
    double area;
    const region_chain *chains; /* of the triangle */
    uint32_t chain_count;
    border_mark *marks; /* corners and crossings, counter-clockwise from corner 0 */
    uint32_t mark_count;
    uint32_t *begin, *end; /* chain_count: marks where chains across begin and end */
    uint32_t *part;        /* mark_count: that of the interval behind a mark */
    uint32_t *stack;       /* chain_count: chains across that have begun */
    double *share;         /* of each part; mark_count at most */
    double *loop_share;    /* chain_count: of loops */
    uint32_t part_count;
    int crosses; /* chains do so */
} divided;

/* Where a node of a chain is: weights of corners 1 and 2. */
static void place_in(const region_work *w, uint32_t triangle, const sc_trace_node *node,
                     double at[2])
{
    const uint32_t *corner = sc_trace_corners(w->subject->model, triangle);
    uint32_t ends[2], i;
    at[0] = at[1] = 0;
    if (node->edge != SC_TRACE_NO_EDGE && node->triangle == triangle) {
        at[0] = node->weights[1];
        at[1] = node->weights[2];
        return;
    }
    if (node->edge == SC_TRACE_NO_EDGE) {
        for (i = 1; i < 3; i++) at[i - 1] = corner[i] == node->triangle;
        return;
    }
    sc_trace_ends(w->subject->model, node->edge, ends);
    for (i = 1; i < 3; i++) {
        if (corner[i] == ends[0]) at[i - 1] = 1 - node->along;
        if (corner[i] == ends[1]) at[i - 1] = node->along;
    }
}

static double turn_of(const double p[2], const double q[2])
{
    return p[0] * q[1] - q[0] * p[1];
}

/* The signed share of what a chain and corner 0 enclose; a loop ends with its first node. */
static double chain_turn(const region_work *w, const region_chain *chain)
{
    const sc_trace_contour *c = &w->trace->contours[chain->contour];
    double sum = 0, p[2], q[2];
    uint64_t i;
    place_in(w, chain->triangle, &w->trace->nodes[node_at(c, chain->begin)], p);
    for (i = 1; i < chain->nodes; i++) {
        place_in(w, chain->triangle, &w->trace->nodes[node_at(c, chain->begin + i)], q);
        sum += turn_of(p, q);
        memcpy(p, q, sizeof p);
    }
    return sum;
}

static void add_mark(divided *d, double x, double y, uint32_t side, uint32_t element)
{
    border_mark *m = &d->marks[d->mark_count++];
    m->x = x;
    m->y = y;
    m->side = side;
    m->element = element;
    m->chain = SC_NONE;
}

/* Lists corners and crossings round the triangle. */
static void list_marks(const region_work *w, divided *d)
{
    static const double corner_at[3][2] = {{0, 0}, {1, 0}, {0, 1}};
    const uint32_t *corner = sc_trace_corners(w->subject->model, d->triangle);
    uint32_t k, i;
    d->mark_count = 0;
    for (k = 0; k < 3; k++) {
        const uint32_t u = corner[k], v = corner[(k + 1) % 3];
        const uint32_t edge = sc_crossed_edges_find(&w->edges, u, v);
        const double *p = corner_at[k], *q = corner_at[(k + 1) % 3];
        add_mark(d, p[0], p[1], k, u);
        if (edge == SC_NONE) continue;
        const uint32_t first = w->edge_first[edge], count = w->edge_first[edge + 1] - first;
        for (i = 0; i < count; i++) {
            const uint32_t at = u < v ? i : count - 1 - i;
            const double t =
                u < v ? w->along[w->order[first + at]] : 1 - w->along[w->order[first + at]];
            add_mark(d, (1 - t) * p[0] + t * q[0], (1 - t) * p[1] + t * q[1], k,
                     element_of(w, edge, u < v ? at + 1 : at));
        }
    }
}

/* The mark of a crossing on the border, or SC_NONE if its edge is none of the triangle's. */
static uint32_t mark_of(const region_work *w, const divided *d, const sc_trace_node *node)
{
    const uint32_t *corner = sc_trace_corners(w->subject->model, d->triangle);
    uint32_t at = 0, k, ends[2];
    sc_trace_ends(w->subject->model, node->edge, ends);
    for (k = 0; k < 3; k++) {
        const uint32_t u = corner[k], v = corner[(k + 1) % 3];
        const uint32_t edge = sc_crossed_edges_find(&w->edges, u, v);
        const uint32_t count = edge == SC_NONE ? 0 : w->edge_first[edge + 1] - w->edge_first[edge];
        if ((u == ends[0] && v == ends[1]) || (u == ends[1] && v == ends[0])) {
            const uint32_t rank = w->rank[crossing_of(w, node)];
            return at + 1 + (u < v ? rank : count - 1 - rank);
        }
        at += 1 + count;
    }
    return SC_NONE;
}

/* Notes where chains across begin and end. 0 if they do so nowhere on the border, or at one place:
   where a contour crosses an edge it leaves the triangle. */
static int mark_chains(const region_work *w, divided *d)
{
    uint32_t i;
    for (i = 0; i < d->chain_count; i++) {
        const region_chain *chain = &d->chains[i];
        const sc_trace_contour *c = &w->trace->contours[chain->contour];
        if (chain->kind != CHAIN_ACROSS) continue;
        d->begin[i] = mark_of(w, d, &w->trace->nodes[node_at(c, chain->begin)]);
        d->end[i] = mark_of(w, d, &w->trace->nodes[node_at(c, chain->begin + chain->nodes - 1)]);
        if (d->begin[i] == SC_NONE || d->end[i] == SC_NONE || d->begin[i] == d->end[i]) return 0;
        d->marks[d->begin[i]].chain = d->marks[d->end[i]].chain = i;
    }
    return 1;
}

/* Finds the parts of the border: a chain that begins opens one, and when it ends the one before
   goes on, unless others have begun since that have not ended: then they cross. */
static void find_border_parts(divided *d)
{
    uint32_t i, open = 0, now = 0, *before = d->part; /* of open chains: where they begin */
    d->part_count = 1;
    d->crosses = 0;
    for (i = 0; i < d->mark_count; i++) {
        const uint32_t chain = d->marks[i].chain;
        if (chain != SC_NONE && open > 0 && d->stack[open - 1] == chain) {
            const uint32_t from = d->begin[chain] < d->end[chain] ? d->begin[chain] : d->end[chain];
            now = before[from - 1]; /* there is a corner before any crossing */
            open--;
        } else if (chain != SC_NONE) {
            d->crosses |= (d->begin[chain] == i ? d->end[chain] : d->begin[chain]) < i;
            d->stack[open++] = chain;
            now = d->part_count++;
        }
        d->part[i] = now;
    }
}

/* Whether two intervals are on one side of a chain. */
static int is_one_side(const divided *d, uint32_t chain, uint32_t i, uint32_t j)
{
    const uint32_t low = d->begin[chain] < d->end[chain] ? d->begin[chain] : d->end[chain];
    const uint32_t high = d->begin[chain] + d->end[chain] - low;
    return (low <= i && i < high) == (low <= j && j < high);
}

/* The same where chains cross: intervals are in one part that no chain has on two sides. */
static void find_crossed_parts(divided *d)
{
    uint32_t i, j, k;
    for (d->part_count = i = 0; i < d->mark_count; i++) {
        for (j = 0; j < i; j++) {
            for (k = 0; k < d->chain_count; k++)
                if (d->chains[k].kind == CHAIN_ACROSS && !is_one_side(d, k, i, j)) break;
            if (k == d->chain_count) break;
        }
        d->part[i] = j < i ? d->part[j] : d->part_count++;
    }
}

static uint32_t next_mark(const divided *d, uint32_t i)
{
    return i + 1 < d->mark_count ? i + 1 : 0;
}

/* Which share of the triangle each part is; where chains cross, by the length of its border. */
static void find_part_shares(const region_work *w, divided *d, const double side[3])
{
    const double whole = side[0] + side[1] + side[2];
    uint32_t i;
    for (i = 0; i < d->part_count; i++) d->share[i] = 0;
    for (i = 0; i < d->mark_count; i++) {
        const border_mark *m = &d->marks[i], *n = &d->marks[next_mark(d, i)];
        const double p[2] = {m->x, m->y}, q[2] = {n->x, n->y};
        if (!d->crosses)
            d->share[d->part[i]] += turn_of(p, q);
        else if (whole > 0)
            d->share[d->part[i]] +=
                (fabs(q[0] - p[0]) > fabs(q[1] - p[1]) ? fabs(q[0] - p[0]) : fabs(q[1] - p[1])) *
                side[m->side] / whole;
    }
    for (i = 0; i < d->chain_count && !d->crosses; i++) {
        const double turn = d->chains[i].kind == CHAIN_ACROSS ? chain_turn(w, &d->chains[i]) : 0;
        if (d->chains[i].kind != CHAIN_ACROSS) continue;
        d->share[d->part[d->begin[i]]] -= turn;
        d->share[d->part[d->begin[i] - 1]] += turn;
    }
}

/* Whether the ray from a point towards greater x crosses the segment from p to q. */
static int is_right_of(const double at[2], const double p[2], const double q[2])
{
    if ((p[1] > at[1]) == (q[1] > at[1])) return 0;
    return p[0] + (at[1] - p[1]) / (q[1] - p[1]) * (q[0] - p[0]) > at[0];
}

static int chain_is_right_of(const region_work *w, const region_chain *chain, const double at[2])
{
    const sc_trace_contour *c = &w->trace->contours[chain->contour];
    double p[2], q[2];
    uint64_t i;
    int odd = 0;
    place_in(w, chain->triangle, &w->trace->nodes[node_at(c, chain->begin)], p);
    for (i = 1; i < chain->nodes; i++) {
        place_in(w, chain->triangle, &w->trace->nodes[node_at(c, chain->begin + i)], q);
        odd ^= is_right_of(at, p, q);
        memcpy(p, q, sizeof p);
    }
    return odd;
}

/* The part that a point of the triangle is in. */
static uint32_t part_at(const region_work *w, const divided *d, const double at[2])
{
    uint32_t part, i;
    for (part = 0; part + 1 < d->part_count; part++) {
        int odd = 0;
        for (i = 0; i < d->mark_count; i++) {
            const border_mark *m = &d->marks[i], *n = &d->marks[next_mark(d, i)];
            const double p[2] = {m->x, m->y}, q[2] = {n->x, n->y};
            if (d->part[i] == part) odd ^= is_right_of(at, p, q);
        }
        for (i = 0; i < d->chain_count; i++)
            if (d->chains[i].kind == CHAIN_ACROSS &&
                (d->part[d->begin[i]] == part) != (d->part[d->begin[i] - 1] == part))
                odd ^= chain_is_right_of(w, &d->chains[i], at);
        if (odd) return part;
    }
    return part;
}

static uint32_t element_of_part(const divided *d, uint32_t part)
{
    uint32_t i = 0;
    while (SC_ALWAYS(i + 1 < d->mark_count) && d->part[i] != part) i++; /* each has an interval */
    return d->marks[i].element;
}

/* The element that chain i lies in: of a loop round it that is the smallest, or of a part; and
   takes from that the share of a loop. */
static uint32_t find_round(const region_work *w, divided *d, uint32_t i, const uint32_t *loops)
{
    const region_chain *chain = &d->chains[i];
    const sc_trace_contour *c = &w->trace->contours[chain->contour];
    uint32_t j, round = SC_NONE;
    double at[2];
    place_in(w, d->triangle, &w->trace->nodes[node_at(c, chain->begin)], at);
    for (j = 0; j < d->chain_count; j++)
        if (j != i && d->chains[j].kind == CHAIN_LOOP &&
            (chain->kind != CHAIN_LOOP || d->loop_share[j] > d->loop_share[i]) &&
            (round == SC_NONE || d->loop_share[j] < d->loop_share[round]) &&
            chain_is_right_of(w, &d->chains[j], at))
            round = j;
    if (round != SC_NONE) {
        if (chain->kind == CHAIN_LOOP) w->area[loops[round]] -= d->area * d->loop_share[i];
        return loops[round];
    }
    j = part_at(w, d, at);
    if (chain->kind == CHAIN_LOOP) d->share[j] -= d->loop_share[i];
    return element_of_part(d, j);
}

/* Notes both sides of a contour that has no node on an edge of a sheet. */
static void note_sides(region_work *w, const region_chain *chain, uint32_t within, uint32_t round)
{
    sc_contour_sides *sides = &w->sides[chain->contour];
    sides->sides[chain->sheet][0] = within;
    sides->sides[chain->sheet][1] = round;
}

/* Loops, and contours that begin and end in the triangle. loops: room for their elements. */
static void divide_inside(region_work *w, divided *d, uint32_t *loops)
{
    uint32_t i;
    for (i = 0; i < d->chain_count; i++) {
        if (d->chains[i].kind != CHAIN_LOOP) continue;
        loops[i] = w->loop_first + w->loop_count++;
        w->anchor[loops[i] - w->interval_first] =
            sc_trace_corners(w->subject->model, d->triangle)[0];
        d->loop_share[i] = fabs(chain_turn(w, &d->chains[i]));
        w->area[loops[i]] += d->area * d->loop_share[i];
    }
    for (i = 0; i < d->chain_count; i++) {
        const region_chain *chain = &d->chains[i];
        uint32_t round;
        if (chain->kind == CHAIN_ACROSS) continue;
        round = find_round(w, d, i, loops);
        if (chain->kind == CHAIN_LOOP)
            note_sides(w, chain, loops[i], round);
        else if (chain->nodes == w->trace->contours[chain->contour].count)
            note_sides(w, chain, round, round);
    }
}

/* The corners' positions, doubles that are all finite; and notes the largest coordinate. */
static sc_status get_finite_corners(region_work *w, const uint32_t *corner, double p[3][3])
{
    int k, i;
    for (k = 0; k < 3; k++) {
        sc_positions_get(&w->subject->positions, corner[k], p[k]);
        for (i = 0; i < 3; i++) {
            if (p[k][i] - p[k][i] != 0) return SC_ERROR_NOT_FINITE;
            if (w->largest < fabs(p[k][i])) w->largest = fabs(p[k][i]);
        }
    }
    return SC_OK;
}

static double square_of(const double v[3])
{
    return v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
}

/* A number of any size: part 2^exponent. part is 1/2 to 1 or -1/2 to -1, or 0, whose exponent is
   below that of any other. */
typedef struct sized_number {
    double part;
    int exponent;
} sized_number;

enum { EXPONENT_OF_ZERO = -100000 };

static sized_number take_size(double part, int exponent)
{
    sized_number x;
    int own;
    x.part = frexp(part, &own);
    x.exponent = x.part == 0 ? EXPONENT_OF_ZERO : exponent + own;
    return x;
}

static int largest_exponent(const sized_number *x, int count)
{
    int most = x[0].exponent, i;
    for (i = 1; i < count; i++)
        if (most < x[i].exponent) most = x[i].exponent;
    return most;
}

/* The length of a vector, in units of 2^exponent. */
static double sized_norm(const sized_number v[3], int exponent)
{
    double parts[3];
    int i;
    for (i = 0; i < 3; i++) parts[i] = ldexp(v[i].part, v[i].exponent - exponent);
    return sqrt(square_of(parts));
}

/* The area of a triangle of any size, DBL_MAX at most. */
static double area_by_parts(double p[3][3])
{
    sized_number n[3];
    double area;
    int i, k, most;
    for (i = 0; i < 3; i++) {
        double flat[3][2], part;
        int exponent;
        for (k = 0; k < 3; k++) {
            flat[k][0] = p[k][(i + 1) % 3];
            flat[k][1] = p[k][(i + 2) % 3];
        }
        part = sc_wide_orient2d_value(flat[0], flat[1], flat[2], &exponent);
        n[i] = take_size(part, exponent);
    }
    most = largest_exponent(n, 3);
    area = ldexp(sized_norm(n, most), most - 1);
    return area < DBL_MAX ? area : DBL_MAX;
}

/* Where squares are far from the ends of the range of doubles, the same by the plain formula. */
static double area_of_triangle(double p[3][3])
{
    double u[3], v[3], n[3], square;
    int i;
    for (i = 0; i < 3; i++) {
        u[i] = p[1][i] - p[0][i];
        v[i] = p[2][i] - p[0][i];
    }
    for (i = 0; i < 3; i++)
        n[i] = u[(i + 1) % 3] * v[(i + 2) % 3] - u[(i + 2) % 3] * v[(i + 1) % 3];
    square = square_of(n);
    return square > 1e-250 && square < 1e250 ? sqrt(square) / 2 : area_by_parts(p);
}

/* Area of a triangle, and, if a contour passes through it, lengths of its sides in some unit. */
static sc_status measure_triangle(region_work *w, divided *d, double side[3])
{
    sized_number v[9];
    double p[3][3];
    int k, i, most;
    if (get_finite_corners(w, sc_trace_corners(w->subject->model, d->triangle), p))
        return SC_ERROR_NOT_FINITE;
    d->area = area_of_triangle(p);
    if (!d->chain_count) return SC_OK;
    for (k = 0; k < 3; k++)
        for (i = 0; i < 3; i++) /* halves: no difference of them is infinite */
            v[3 * k + i] = take_size(p[(k + 1) % 3][i] / 2 - p[k][i] / 2, 0);
    most = largest_exponent(v, 9);
    for (k = 0; k < 3; k++) side[k] = sized_norm(v + 3 * k, most);
    return SC_OK;
}

/* Room for a triangle: marks, and chains. */
static sc_status take_divided(region_work *w, divided *d, uint32_t marks, uint32_t chains,
                              uint32_t **loops)
{
    d->marks = (border_mark *)sc_scratch_take(w->scratch, marks, sizeof *d->marks);
    d->part = (uint32_t *)sc_scratch_take(w->scratch, marks, sizeof *d->part);
    d->share = (double *)sc_scratch_take(w->scratch, marks, sizeof *d->share);
    d->begin = (uint32_t *)sc_scratch_take(w->scratch, chains, sizeof *d->begin);
    d->end = (uint32_t *)sc_scratch_take(w->scratch, chains, sizeof *d->end);
    d->stack = (uint32_t *)sc_scratch_take(w->scratch, marks, sizeof *d->stack);
    d->loop_share = (double *)sc_scratch_take(w->scratch, chains, sizeof *d->loop_share);
    *loops = (uint32_t *)sc_scratch_take(w->scratch, chains, sizeof **loops);
    return d->marks && d->part && d->share && d->begin && d->end && d->stack && d->loop_share &&
                   *loops
               ? SC_OK
               : SC_ERROR_MEMORY;
}

/* A triangle that contours pass through. */
static sc_status divide_triangle(region_work *w, divided *d, const double side[3], uint32_t *loops)
{
    uint32_t i;
    list_marks(w, d);
    if (!mark_chains(w, d)) return SC_ERROR_PAIRS;
    find_border_parts(d);
    if (d->crosses) find_crossed_parts(d);
    find_part_shares(w, d, side);
    divide_inside(w, d, loops);
    for (i = 0; i < d->mark_count; i++) {
        const uint32_t element = d->marks[i].element;
        join_elements(w->parent, element, element_of_part(d, d->part[i]));
        if (element >= w->interval_first)
            w->anchor[element - w->interval_first] =
                sc_trace_corners(w->subject->model, d->triangle)[0];
    }
    for (i = 0; i < d->part_count; i++) w->area[element_of_part(d, i)] += d->area * d->share[i];
    return SC_OK;
}

/* The most crossings on the border of a triangle, and the most chains in one: for room. */
static void find_room(const region_work *w, uint32_t *marks, uint32_t *chains)
{
    uint32_t edge, i, most = 0, run = 0;
    for (edge = 0; edge < w->edges.count; edge++)
        if (most < w->edge_first[edge + 1] - w->edge_first[edge])
            most = w->edge_first[edge + 1] - w->edge_first[edge];
    *marks = 3 + 3 * most;
    for (*chains = i = 0; i < w->chain_count; i++) {
        run = i > 0 && w->chains[i].triangle == w->chains[i - 1].triangle ? run + 1 : 1;
        if (*chains < run) *chains = run;
    }
}

static sc_status divide_all(region_work *w)
{
    const uint32_t triangles = w->subject->model->triangle_count;
    uint32_t t, chain = 0, marks, chains, k, *loops;
    divided d;
    sc_status status;
    find_room(w, &marks, &chains);
    status = take_divided(w, &d, marks, chains, &loops);
    for (t = 0; t < triangles && !status; t++) {
        const uint32_t *corner = sc_trace_corners(w->subject->model, t);
        double side[3];
        d.triangle = t;
        d.chains = w->chains + chain;
        for (d.chain_count = 0; chain < w->chain_count && w->chains[chain].triangle == t; chain++)
            d.chain_count++;
        status = measure_triangle(w, &d, side);
        if (status) break;
        if (sc_trace_is_collapsed(corner)) continue;
        for (k = 0; k < 3; k++) w->is_on_sheet[corner[k]] = 1;
        for (k = 0; k < 2; k++) join_elements(w->component, corner[k], corner[k + 1]);
        if (d.chain_count) {
            status = divide_triangle(w, &d, side, loops);
            continue;
        }
        for (k = 0; k < 2; k++) join_elements(w->parent, corner[k], corner[k + 1]);
        w->area[corner[0]] += d.area;
    }
    return status;
}

/* ---- what is inside ---- */

/* A number for each edge: its sum over the sides of a component, those passed backwards subtracted,
   is 0 if each edge is passed as often one way as the other, and hardly ever else. */
static uint64_t number_of_side(uint32_t u, uint32_t v)
{
    const uint64_t low = u < v ? u : v, high = u < v ? v : u;
    uint64_t n = (low << 32 | high) * 0x9e3779b97f4a7c15u;
    n = (n ^ n >> 30) * 0xbf58476d1ce4e5b9u;
    n = (n ^ n >> 27) * 0x94d049bb133111ebu;
    n ^= n >> 31;
    return u < v ? n : 0 - n;
}

/* For each component, by its lowest vertex, 0 if it is closed; or NULL. */
static uint64_t *find_open(region_work *w)
{
    const sc_model *model = w->subject->model;
    uint64_t *open =
        (uint64_t *)sc_scratch_take_filled(w->scratch, model->vertex_count, sizeof *open, 0);
    uint32_t t, k;
    for (t = 0; open && t < model->triangle_count; t++) {
        const uint32_t *corner = sc_trace_corners(model, t);
        if (sc_trace_is_collapsed(corner)) continue;
        for (k = 0; k < 3; k++)
            open[region_root(w->component, corner[0])] +=
                number_of_side(corner[k], corner[(k + 1) % 3]);
    }
    return open;
}

/* The solid angle of a triangle seen from a point, which is in units of w->unit, over 4 pi (van
   Oosterom, Strackee 1983). */
static double solid_angle(const region_work *w, uint32_t triangle, const double at[3])
{
    const uint32_t *corner = sc_trace_corners(w->subject->model, triangle);
    double v[3][3], length[3], dot[3], volume = 0, below;
    int i, k;
    for (i = 0; i < 3; i++) {
        sc_positions_get(&w->subject->positions, corner[i], v[i]);
        for (k = 0; k < 3; k++) v[i][k] = w->unit * v[i][k] - at[k];
        length[i] = sqrt(square_of(v[i]));
    }
    for (i = 0; i < 3; i++) {
        const double *p = v[i], *q = v[(i + 1) % 3];
        dot[i] = p[0] * q[0] + p[1] * q[1] + p[2] * q[2];
        volume += v[0][i] *
                  (v[1][(i + 1) % 3] * v[2][(i + 2) % 3] - v[1][(i + 2) % 3] * v[2][(i + 1) % 3]);
    }
    below = length[0] * length[1] * length[2] + dot[0] * length[2] + dot[1] * length[0] +
            dot[2] * length[1];
    return volume == 0 && below == 0 ? 0 : atan2(volume, below) / 6.283185307179586;
}

/* How often closed components go round the middle of a triangle, where its normal points: that of
   its own component is half of what it is on both sides. */
static int32_t count_round(const region_work *w, uint32_t triangle, const uint64_t *open)
{
    const sc_model *model = w->subject->model;
    const uint32_t *corner = sc_trace_corners(model, triangle);
    double at[3] = {0, 0, 0}, p[3], sum = 0;
    uint32_t t, k, i;
    for (k = 0; k < 3; k++) {
        sc_positions_get(&w->subject->positions, corner[k], p);
        for (i = 0; i < 3; i++) at[i] += w->unit * p[i] / 3;
    }
    for (t = 0; t < model->triangle_count; t++) {
        const uint32_t *other = sc_trace_corners(model, t);
        if (t != triangle && !sc_trace_is_collapsed(other) &&
            !open[region_root(w->component, other[0])])
            sum += solid_angle(w, t, at);
    }
    if (!open[region_root(w->component, corner[0])]) sum -= 0.5;
    return (int32_t)floor(sum + 0.5);
}

/* Fills in sc_region.inside, by each region's first triangle through which no contour passes. */
static sc_status find_inside(region_work *w, sc_regions_result *r)
{
    const sc_model *model = w->subject->model;
    const uint64_t *open = find_open(w);
    uint32_t t, chain = 0;
    int exponent;
    if (!open) return SC_ERROR_MEMORY;
    frexp(w->largest, &exponent);
    w->unit = ldexp(1, exponent < -1000 ? 1000 : -exponent);
    for (t = 0; t < model->triangle_count; t++) {
        const uint32_t *corner = sc_trace_corners(model, t);
        const uint32_t before = chain, region = w->region[region_root(w->parent, corner[0])];
        while (chain < w->chain_count && w->chains[chain].triangle == t) chain++;
        if (chain > before || sc_trace_is_collapsed(corner) || region >= r->region_capacity ||
            r->regions[region].inside != SC_REGION_UNKNOWN)
            continue;
        if (sc_trace_is_cancelled(w->subject)) return SC_ERROR_INCOMPLETE;
        r->regions[region].inside = count_round(w, t, open);
    }
    return SC_OK;
}

/* ---- the answer ---- */

/* Whether the ends of all crossed edges are on sheets. */
static int are_ends_on_sheets(const region_work *w)
{
    uint32_t i;
    for (i = 0; i < w->edges.count; i++)
        if (!(w->is_on_sheet[w->edges.ends[i].a] & w->is_on_sheet[w->edges.ends[i].b])) return 0;
    return 1;
}

/* Sides at the first node of a contour that is on an edge of a sheet. */
static void find_sides_of(region_work *w, uint32_t contour, uint32_t sheet)
{
    const sc_trace_contour *c = &w->trace->contours[contour];
    uint64_t i;
    for (i = 0; i < c->count; i++) {
        const sc_trace_node *node = &w->trace->nodes[c->first + i];
        uint32_t ends[2], edge, rank, forwards;
        if (node->edge == SC_TRACE_NO_EDGE || node->sheet != sheet) continue;
        sc_trace_ends(w->subject->model, node->edge, ends);
        edge = sc_crossed_edges_find(&w->edges, ends[0], ends[1]);
        rank = w->rank[crossing_of(w, node)];
        forwards = ends[0] < ends[1];
        w->sides[contour].sides[sheet][0] = element_of(w, edge, forwards ? rank : rank + 1);
        w->sides[contour].sides[sheet][1] = element_of(w, edge, forwards ? rank + 1 : rank);
        return;
    }
}

/* Numbers regions, and writes them and all else. */
static sc_status write_regions(region_work *w, sc_regions_result *r)
{
    const sc_model *model = w->subject->model;
    uint32_t i, count = 0, s, k;
    for (i = 0; i < w->element_count; i++) {
        sc_region *region;
        if (w->parent[i] != i || (i < model->vertex_count && !w->is_on_sheet[i]) ||
            i >= w->loop_first + w->loop_count)
            continue;
        w->region[i] = count++;
        if (w->region[i] >= r->region_capacity) continue;
        region = &r->regions[w->region[i]];
        memset(region, 0, sizeof *region);
        region->inside = SC_REGION_UNKNOWN;
        region->component = region_root(
            w->component, i < model->vertex_count ? i : w->anchor[i - w->interval_first]);
    }
    r->region_count = count;
    for (i = 0; i < w->loop_first + w->loop_count; i++) {
        uint32_t number;
        if (i < model->vertex_count && !w->is_on_sheet[i]) continue;
        number = w->region[region_root(w->parent, i)];
        if (number >= r->region_capacity) continue;
        r->regions[number].area += w->area[i];
        r->regions[number].vertex_count += i < model->vertex_count;
    }
    for (i = 0; r->vertex_regions && i < model->vertex_count; i++)
        r->vertex_regions[i] =
            w->is_on_sheet[i] ? w->region[region_root(w->parent, i)] : SC_TRACE_NO_EDGE;
    for (i = 0; r->sides && i < w->trace->contour_count; i++)
        for (s = 0; s < 2; s++)
            for (k = 0; k < 2; k++)
                r->sides[i].sides[s][k] =
                    w->region[region_root(w->parent, w->sides[i].sides[s][k])];
    if (r->flags & SC_REGIONS_INSIDE) {
        const sc_status status = find_inside(w, r);
        if (status) return status;
    }
    return count > r->region_capacity ? SC_ERROR_SHORT_BUFFER : SC_OK;
}

static sc_status take_elements(region_work *w)
{
    const uint32_t vertices = w->subject->model->vertex_count;
    const uint64_t inner = (uint64_t)w->crossing_count - w->edges.count;
    const uint64_t count = vertices + inner + w->chain_count;
    uint32_t i;
    if (SC_HARDLY(count > UINT32_MAX / 2)) return SC_ERROR_COUNT; /* 25 gigabytes */
    w->interval_first = vertices;
    w->loop_first = (uint32_t)(vertices + inner);
    w->element_count = (uint32_t)count;
    w->parent = (uint32_t *)sc_scratch_take(w->scratch, count, sizeof *w->parent);
    w->region = (uint32_t *)sc_scratch_take_filled(w->scratch, count, sizeof *w->region, 0xff);
    w->area = (double *)sc_scratch_take_filled(w->scratch, count, sizeof *w->area, 0);
    w->anchor =
        (uint32_t *)sc_scratch_take_filled(w->scratch, count - vertices, sizeof *w->anchor, 0);
    w->component = (uint32_t *)sc_scratch_take(w->scratch, vertices, sizeof *w->component);
    w->is_on_sheet = (uint8_t *)sc_scratch_take_filled(w->scratch, vertices, 1, 0);
    w->sides = (sc_contour_sides *)sc_scratch_take_filled(w->scratch, w->trace->contour_count,
                                                          sizeof *w->sides, 0);
    if (!w->parent || !w->region || !w->area || !w->anchor || !w->component || !w->is_on_sheet ||
        !w->sides)
        return SC_ERROR_MEMORY;
    for (i = 0; i < w->element_count; i++) w->parent[i] = i;
    for (i = 0; i < vertices; i++) w->component[i] = i;
    return SC_OK;
}

/* Whether contours have nodes that there are, two at least, and no more together: so many chains
   at most there are on each sheet. */
static int are_contours_there(const sc_trace_result *t)
{
    uint64_t i, left = t->node_count;
    for (i = 0; i < t->contour_count; i++) {
        const sc_trace_contour *c = &t->contours[i];
        if (c->count < 2 || c->first > t->node_count || c->count > t->node_count - c->first ||
            c->count > left)
            return 0;
        left -= c->count;
    }
    return 1;
}

sc_status sc_regions_find(const sc_trace_subject *subject, const sc_trace_result *trace,
                          sc_scratch *scratch, sc_regions_result *result)
{
    region_work w;
    uint32_t i, sheet;
    sc_status status;
    memset(&w, 0, sizeof w);
    w.subject = subject;
    w.trace = trace;
    w.scratch = scratch;
    status = are_contours_there(trace) ? list_crossings(&w) : SC_ERROR_PAIRS;
    if (!status) status = order_crossings(&w);
    if (!status) status = list_chains(&w);
    if (!status) status = take_elements(&w);
    if (!status) status = divide_all(&w);
    if (!status && !are_ends_on_sheets(&w)) status = SC_ERROR_PAIRS;
    if (!status && sc_trace_is_cancelled(subject)) status = SC_ERROR_INCOMPLETE;
    if (status) return status;
    for (i = 0; i < trace->contour_count; i++)
        for (sheet = 0; sheet < 2; sheet++) find_sides_of(&w, i, sheet);
    return write_regions(&w, result);
}
