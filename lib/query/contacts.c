/*
 * Where the two of a pair meet. See contacts.h.
 *
 * SPDX-License-Identifier: MIT
 *
 * The intersection of two triangles is the hull of its corners, and these are of three kinds:
 *   - a corner of one that is in the other;
 *   - where an edge of one passes from one side of the other's plane to the other side, through the
 *     other;
 *   - if all is in one plane, or one of the two has no area: where two edges cross.
 * A triangle without an area is a segment or a point, and has the corners and edges of that.
 *
 * Unless it is an area, every one of these is an end of the intersection, which lies on a line:
 * there the intersection is that of two intervals, whose ends these are, cut out by the edges of a
 * and by those of b. Hence two that differ are the two ends, and whether they differ is decided
 * exactly.
 */
#include "query/contacts.h"

#include <math.h>
#include <string.h>

#include "base/predicates.h"
#include "query/primitives.h"

/* A triangle, segment or point. Corners and edges are numbers of positions. */
typedef struct hull {
    const double *const *p; /* three positions */
    int corner_count, corner[3];
    int edge_count, edge[3][2];
    int side[3]; /* of the positions, against the other's plane; 0 if it has none */
} hull;

/* A corner of the intersection. */
enum { CORNER, EDGE, CROSSING };
typedef struct event {
    int kind;
    int of;   /* CORNER, EDGE: of which hull */
    int i, j; /* CORNER: position; EDGE: edge; CROSSING: edges of both */
} event;

enum { EVENTS_MAX = 21 };

typedef struct events {
    hull hulls[2];
    event list[EVENTS_MAX];
    int count;
    uint64_t fallbacks; /* asked for by the predicates, not looked at */
} events;

/* ---- points of a plane ---- */

static int corner_after(int k)
{
    return k == 2 ? 0 : k + 1;
}

static void project(const double *p, int axis, double q[2])
{
    q[0] = p[corner_after(axis)];
    q[1] = p[corner_after(corner_after(axis))];
}

static int sign_along(const double *a, const double *b, const double *c, int axis,
                      uint64_t *fallbacks)
{
    double a2[2], b2[2], c2[2];
    project(a, axis, a2);
    project(b, axis, b2);
    project(c, axis, c2);
    return sc_predicates_orient2d(a2, b2, c2, fallbacks);
}

static sc_predicates_value value_along(const double *a, const double *b, const double *c, int axis)
{
    double a2[2], b2[2], c2[2];
    project(a, axis, a2);
    project(b, axis, b2);
    project(c, axis, c2);
    return sc_predicates_orient2d_value(a2, b2, c2);
}

/* An axis along which a, b, c are not on a line; -1 if they are on one. */
static int find_hull_axis(const double *a, const double *b, const double *c, uint64_t *fallbacks)
{
    int axis;
    for (axis = 0; axis < 3; axis++)
        if (sign_along(a, b, c, axis, fallbacks)) return axis;
    return -1;
}

/* Lexicographic order. */
static int is_below(const double *a, const double *b)
{
    int k;
    for (k = 0; k < 3; k++)
        if (a[k] != b[k]) return a[k] < b[k];
    return 0;
}

static int is_equal(const double *a, const double *b)
{
    return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

/* ---- corners of the intersection ---- */

static void make_hull(hull *h, const double *const p[3], uint64_t *fallbacks)
{
    int k, low = 0, high = 0;
    memset(h, 0, sizeof *h);
    h->p = p;
    if (find_hull_axis(p[0], p[1], p[2], fallbacks) >= 0) {
        h->corner_count = h->edge_count = 3;
        for (k = 0; k < 3; k++) {
            h->corner[k] = h->edge[k][0] = k;
            h->edge[k][1] = corner_after(k);
        }
        return;
    }
    for (k = 1; k < 3; k++) {
        if (is_below(p[k], p[low])) low = k;
        if (is_below(p[high], p[k])) high = k;
    }
    h->corner[0] = h->edge[0][0] = low;
    h->corner[1] = h->edge[0][1] = high;
    h->corner_count = low == high ? 1 : 2;
    h->edge_count = low == high ? 0 : 1;
}

static void find_hull_sides(hull *h, const hull *other, uint64_t *fallbacks)
{
    sc_predicates_plane plane = sc_predicates_make_plane(other->p[0], other->p[1], other->p[2]);
    int k;
    if (other->corner_count < 3) return;
    for (k = 0; k < 3; k++) h->side[k] = sc_predicates_side_of_plane(&plane, h->p[k], fallbacks);
}

static int is_flat(const hull *h)
{
    return !h->side[0] && !h->side[1] && !h->side[2];
}

static void add_event(events *e, int kind, int of, int i, int j)
{
    event *v = &e->list[e->count++];
    v->kind = kind;
    v->of = of;
    v->i = i;
    v->j = j;
}

/* Corners of one in the other, and its edges that pass through the other's plane and the other. */
static void find_events_of(events *e, int of)
{
    const hull *h = &e->hulls[of], *other = &e->hulls[1 - of];
    int k;
    for (k = 0; k < h->corner_count; k++) {
        const double *p = h->p[h->corner[k]];
        if (!h->side[h->corner[k]] && sc_primitives_segment_meets(p, p, other->p, 0, &e->fallbacks))
            add_event(e, CORNER, of, h->corner[k], 0);
    }
    for (k = 0; k < h->edge_count; k++) {
        int i = h->edge[k][0], j = h->edge[k][1];
        if (h->side[i] * h->side[j] < 0 &&
            sc_primitives_segment_meets(h->p[i], h->p[j], other->p, 0, &e->fallbacks))
            add_event(e, EDGE, of, k, 0);
    }
}

/* Whether two segments cross in a point that is no end of either. */
static int segments_cross(const double *p, const double *q, const double *u, const double *v,
                          uint64_t *fallbacks)
{
    int axis = find_hull_axis(p, q, u, fallbacks);
    if (axis < 0 || sc_predicates_orient3d(p, q, u, v, fallbacks)) return 0;
    return sign_along(p, q, u, axis, fallbacks) * sign_along(p, q, v, axis, fallbacks) < 0 &&
           sign_along(u, v, p, axis, fallbacks) * sign_along(u, v, q, axis, fallbacks) < 0;
}

static void find_crossings(events *e)
{
    const hull *a = &e->hulls[0], *b = &e->hulls[1];
    int i, j;
    for (i = 0; i < a->edge_count; i++)
        for (j = 0; j < b->edge_count; j++)
            if (segments_cross(a->p[a->edge[i][0]], a->p[a->edge[i][1]], b->p[b->edge[j][0]],
                               b->p[b->edge[j][1]], &e->fallbacks))
                add_event(e, CROSSING, 0, i, j);
}

/* Whether the interiors of two triangles of a plane meet: no line of a side has the two on
   different sides. */
static int interiors_meet(events *e)
{
    int axis = find_hull_axis(e->hulls[0].p[0], e->hulls[0].p[1], e->hulls[0].p[2], &e->fallbacks);
    int of, k, i;
    for (of = 0; of < 2; of++) {
        const double *const *p = e->hulls[of].p, *const *o = e->hulls[1 - of].p;
        int inside = sign_along(p[0], p[1], p[2], axis, &e->fallbacks);
        for (k = 0; k < 3; k++) {
            for (i = 0; i < 3; i++)
                if (sign_along(p[k], p[corner_after(k)], o[i], axis, &e->fallbacks) == inside)
                    break;
            if (i == 3) return 0;
        }
    }
    return 1;
}

/* Whether two events of an intersection that is no area are one point. */
static int is_same(events *e, const event *v, const event *w)
{
    const hull *vh = &e->hulls[v->of], *wh = &e->hulls[w->of];
    if (v->kind == CROSSING || w->kind == CROSSING) return 0; /* strictly inside two edges */
    if (v->kind == CORNER && w->kind == CORNER) return is_equal(vh->p[v->i], wh->p[w->i]);
    if (v->of == w->of) return 0; /* strictly inside an edge, and a corner or inside another edge */
    if (v->kind == CORNER)
        return find_hull_axis(wh->p[wh->edge[w->i][0]], wh->p[wh->edge[w->i][1]], vh->p[v->i],
                              &e->fallbacks) < 0;
    if (w->kind == CORNER)
        return find_hull_axis(vh->p[vh->edge[v->i][0]], vh->p[vh->edge[v->i][1]], wh->p[w->i],
                              &e->fallbacks) < 0;
    return sc_predicates_orient3d(vh->p[vh->edge[v->i][0]], vh->p[vh->edge[v->i][1]],
                                  wh->p[wh->edge[w->i][0]], wh->p[wh->edge[w->i][1]],
                                  &e->fallbacks) == 0;
}

/* ---- coordinates ---- */

/*
 * What part of the sum of the absolute values each is. With u = 2^-53: values are off by 4 u at
 * most, their sum by 4 u and two roundings, the quotient by one more, together 11 u; a mean of two
 * ends has two roundings more, 13 u of the larger end. 2^-49, which starcontour.h promises, is 16
 * u.
 */
static void find_shares(const sc_predicates_value *values, int count, double *shares)
{
    int exponent[3] = {0, 0, 0}, largest = 0, any = 0, i;
    double sum = 0;
    for (i = 0; i < count; i++) {
        shares[i] = fabs(frexp(values[i].number, &exponent[i]));
        exponent[i] += values[i].exponent;
        if (shares[i] > 0 && (!any || exponent[i] > largest)) largest = exponent[i];
        any |= shares[i] > 0;
    }
    for (i = 0; i < count; i++) {
        shares[i] = shares[i] > 0 ? ldexp(shares[i], exponent[i] - largest) : 0;
        sum += shares[i];
    }
    for (i = 0; i < count; i++) shares[i] /= sum; /* one is not 0: they are those of a point */
}

/* The weights of a point of a segment, by the coordinate in which the ends differ most. */
static void weigh_on_segment(const double *p, const hull *h, double weights[3])
{
    const double *low = h->p[h->corner[0]], *high = h->p[h->corner[1]];
    double before = 0, after = 0, factor = 1;
    int k;
    for (k = 0; k < 3; k++)
        if (fabs(low[k]) > 1e300 || fabs(high[k]) > 1e300) factor = 0.25; /* against overflow */
    for (k = 0; k < 3; k++) {
        double first = fabs(factor * p[k] - factor * low[k]);
        double second = fabs(factor * high[k] - factor * p[k]);
        if (first + second <= before + after) continue;
        before = first;
        after = second;
    }
    weights[h->corner[0]] = after / (before + after);
    weights[h->corner[1]] = before / (before + after);
}

/* The weights of a point that is known to be in a hull and its plane. */
static void weigh_in_plane(events *e, const double *p, const hull *h, double weights[3])
{
    sc_predicates_value values[3];
    double shares[3];
    int k, axis;
    if (h->corner_count == 1) {
        weights[h->corner[0]] = 1;
        return;
    }
    if (h->corner_count == 2) {
        weigh_on_segment(p, h, weights);
        return;
    }
    axis = find_hull_axis(h->p[0], h->p[1], h->p[2], &e->fallbacks);
    for (k = 0; k < 3; k++)
        values[k] =
            value_along(p, h->p[corner_after(k)], h->p[corner_after(corner_after(k))], axis);
    find_shares(values, 3, shares);
    memcpy(weights, shares, sizeof shares);
}

/* The weights of where an edge passes through the other's plane: on the edge, and in the other. */
static void weigh_passage(const hull *h, const int edge[2], const hull *other, double on_edge[3],
                          double in_other[3])
{
    const double *p = h->p[edge[0]], *q = h->p[edge[1]], *const *t = other->p;
    sc_predicates_value values[3];
    double shares[3];
    int k;
    values[0] = sc_predicates_orient3d_value(t[0], t[1], t[2], q);
    values[1] = sc_predicates_orient3d_value(t[0], t[1], t[2], p);
    find_shares(values, 2, shares);
    on_edge[edge[0]] = shares[0];
    on_edge[edge[1]] = shares[1];
    for (k = 0; k < 3; k++)
        values[k] = sc_predicates_orient3d_value(p, q, t[corner_after(k)],
                                                 t[corner_after(corner_after(k))]);
    find_shares(values, 3, shares);
    memcpy(in_other, shares, sizeof shares);
}

/* The weights of where an edge crosses another, u v, in their plane. */
static void weigh_crossing(events *e, const hull *h, const int edge[2], const double *u,
                           const double *v, double on_edge[3])
{
    const double *p = h->p[edge[0]], *q = h->p[edge[1]];
    int axis = find_hull_axis(u, v, p, &e->fallbacks);
    sc_predicates_value values[2];
    double shares[2];
    values[0] = value_along(u, v, q, axis);
    values[1] = value_along(u, v, p, axis);
    find_shares(values, 2, shares);
    on_edge[edge[0]] = shares[0];
    on_edge[edge[1]] = shares[1];
}

/* The mean of two ends, which it does not leave. */
static void find_mean(const hull *h, const int edge[2], const double weights[3], double point[3])
{
    int k;
    for (k = 0; k < 3; k++) {
        double p = h->p[edge[0]][k], q = h->p[edge[1]][k];
        double mean = weights[edge[0]] * p + weights[edge[1]] * q;
        double low = p < q ? p : q, high = p < q ? q : p;
        point[k] = mean < low ? low : mean > high ? high : mean;
    }
}

/* Point and weights of an event, at end 0 or 1 of a contact. */
static void write_end(events *e, const event *v, sc_contact *contact, int end)
{
    const hull *h = &e->hulls[v->of], *other = &e->hulls[1 - v->of];
    double *own = v->of ? contact->weights_b[end] : contact->weights_a[end];
    double *others = v->of ? contact->weights_a[end] : contact->weights_b[end];
    const int *edge = h->edge[v->i], *other_edge = other->edge[v->j];
    memset(own, 0, 3 * sizeof *own);
    memset(others, 0, 3 * sizeof *others);
    if (v->kind == CORNER) {
        own[v->i] = 1;
        weigh_in_plane(e, h->p[v->i], other, others);
        memcpy(contact->points[end], h->p[v->i], sizeof contact->points[end]);
        return;
    }
    if (v->kind == EDGE) {
        weigh_passage(h, edge, other, own, others);
    } else {
        weigh_crossing(e, h, edge, other->p[other_edge[0]], other->p[other_edge[1]], own);
        weigh_crossing(e, other, other_edge, h->p[edge[0]], h->p[edge[1]], others);
    }
    find_mean(h, edge, own, contact->points[end]);
}

/* ---- contacts ---- */

/* An eighth of the sum of the distances in each coordinate. */
static double distance(const double p[3], const double q[3])
{
    return fabs(p[0] / 8 - q[0] / 8) + fabs(p[1] / 8 - q[1] / 8) + fabs(p[2] / 8 - q[2] / 8);
}

/* Of the corners of an area the two that are farthest apart. */
static void write_area(events *e, sc_contact *contact)
{
    double points[EVENTS_MAX][3], largest = -1;
    int i, j, first = 0, last = 0;
    for (i = 0; i < e->count; i++) {
        write_end(e, &e->list[i], contact, 0);
        memcpy(points[i], contact->points[0], sizeof points[i]);
        for (j = 0; j < i; j++) {
            double d = distance(points[j], points[i]);
            if (d <= largest) continue;
            largest = d;
            first = j;
            last = i;
        }
    }
    write_end(e, &e->list[first], contact, 0);
    write_end(e, &e->list[last], contact, 1);
    contact->kind = SC_MEET_AREA;
}

void sc_contacts_find(const double *const a[3], const double *const b[3], sc_contact *contact)
{
    events e;
    int flat, i = 1;
    memset(contact, 0, sizeof *contact);
    e.count = 0;
    e.fallbacks = 0;
    make_hull(&e.hulls[0], a, &e.fallbacks);
    make_hull(&e.hulls[1], b, &e.fallbacks);
    find_hull_sides(&e.hulls[0], &e.hulls[1], &e.fallbacks);
    find_hull_sides(&e.hulls[1], &e.hulls[0], &e.fallbacks);
    flat = is_flat(&e.hulls[0]) && is_flat(&e.hulls[1]);
    find_events_of(&e, 0);
    find_events_of(&e, 1);
    if (flat) find_crossings(&e);
    if (!e.count) return;
    if (flat && e.hulls[0].corner_count == 3 && e.hulls[1].corner_count == 3 &&
        interiors_meet(&e)) {
        write_area(&e, contact);
        return;
    }
    write_end(&e, &e.list[0], contact, 0);
    while (i < e.count && is_same(&e, &e.list[0], &e.list[i])) i++;
    contact->kind = i < e.count ? SC_MEET_SEGMENT : SC_MEET_POINT;
    write_end(&e, &e.list[i < e.count ? i : 0], contact, 1);
}

double sc_contacts_pass(const double *const edge[2], const double *const triangle[3],
                        double weights[3], double point[3])
{
    const double *const ends[3] = {edge[0], edge[1], edge[1]};
    const int whole[2] = {0, 1};
    double on_edge[3];
    hull own, other;
    memset(&own, 0, sizeof own);
    memset(&other, 0, sizeof other);
    own.p = ends;
    other.p = triangle;
    weigh_passage(&own, whole, &other, on_edge, weights);
    find_mean(&own, whole, on_edge, point);
    return on_edge[1];
}
