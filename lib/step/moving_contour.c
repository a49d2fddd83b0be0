/*
 * The exact contour test over a step. See moving_contour.h.
 *
 * SPDX-License-Identifier: MIT
 *
 * Two moving edges are clear of each other if along some fixed direction m, at both ends of the
 * step, all of one is farther than the clearance from all of the other: both ends of each edge move
 * on straight lines, so the same holds in between, and for all points of the edges. Two edges that
 * share a point, seen from there as a and b, are clear if that is so of -a and b, for then neither
 * end comes near the line on which the other edge is going on; or if a x b, a polynomial of degree
 * 2 in time, stays of one sign and large enough, as the three coefficients of its Bernstein form
 * say. Which direction is tried does not matter for what is proved. Where none is found, the step
 * is halved.
 *
 * Rounding and clearance. A computed coordinate is off by error (sc_simple_contour.error, as
 * query/simple.c has it, for the start and the end). Along m a point is off by |m|1 error, two of
 * them by 2 |m|1 error; where sums are computed in single precision (the inner loops), m . p rounds
 * by 2.1 * 2^-24 |m|1 |p|max, which is below 0.6 |m|1 error, and the difference of two by another
 * 0.6: 3.8 |m|1 error in all. Clearance is a distance d in space, and so at least d between
 * projections along unit vectors at right angles. The axes here are such vectors times their
 * lengths, so that x and y that are d apart along m in that plane are |(m.x length.x, m.y
 * length.y)| d apart here. Hence (|m.x| + |m.y|) known + |(m.x reach.x, m.y reach.y)|, with known =
 * 5 error and reach = length d, a little more for its own rounding. The inner loops take the larger
 * component of such a vector and 0.41422 times the smaller, which is at least its length.
 *
 * Along the contour, where pairs are left out that are near on the mesh, it is (n - 1) h for ends
 * of edges with n edges between them: what is wanted is a linear function of where the points are
 * on both edges, and the distance along m is another, so that the four pairs of ends are enough.
 * The inner loops add h to what is along m, twice at most, and round once more for each, and for
 * what both are compared with: by less than one more error, and 2^-18 of h.
 */
#include "base/bounds.h"
#include "step/moving_contour.h"

#include <float.h>
#include <math.h>

#include "pose/dnc.h"
#include "step/moving_star.h"
#include "step/step_kernels.h"

/* How often a step is halved for a pair of edges. */
enum { HALVINGS = 2 };

typedef struct moving_vector {
    double x[2], y[2]; /* at the start and at the end */
} moving_vector;

/* What vectors between points of edges are tested with, in double precision. */
typedef struct clearance {
    double known, x, y; /* of a direction m: (|m.x| + |m.y|) known + |(m.x x, m.y y)| */
} clearance;

/* Has 5 errors; 2 are enough here, and nothing else rounds to speak of. */
static clearance clearance_of(const sc_moving_contour *c, const float reach[2])
{
    clearance k;
    k.known = (double)c->known;
    k.x = (double)reach[0];
    k.y = (double)reach[1];
    return k;
}

/* The same for points with so many edges between them along the contour. */
static clearance clearance_along(const sc_moving_contour *c, uint32_t edges)
{
    clearance k = clearance_of(c, c->altitude);
    k.x *= (double)edges - 1;
    k.y *= (double)edges - 1;
    return k;
}

/* The length of a vector, no less. */
static double plane_length(double x, double y)
{
    return sqrt(x * x + y * y) * (1 + 8 * DBL_EPSILON) + DBL_MIN;
}

static moving_vector contour_point(const sc_moving_contour *c, uint32_t i)
{
    moving_vector v;
    v.x[0] = (double)c->start.edges->at[0][i];
    v.y[0] = (double)c->start.edges->at[1][i];
    v.x[1] = c->ends == 1 ? v.x[0] : (double)c->end->at[0][i];
    v.y[1] = c->ends == 1 ? v.y[0] : (double)c->end->at[1][i];
    return v;
}

static moving_vector moving_difference(moving_vector a, const moving_vector *b)
{
    int s;
    for (s = 0; s < 2; s++) {
        a.x[s] -= b->x[s];
        a.y[s] -= b->y[s];
    }
    return a;
}

/* The same motion over the first or second half of the time. */
static moving_vector half_motion(moving_vector v, int second)
{
    v.x[1 - second] = (v.x[0] + v.x[1]) / 2;
    v.y[1 - second] = (v.y[0] + v.y[1]) / 2;
    return v;
}

/* Whether all vectors, v[i] by k[i], are clear along a direction. */
static int are_clear_along(const moving_vector *v, int count, double x, double y,
                           const clearance *k)
{
    int i, s;
    for (i = 0; i < count; i++) {
        const double least =
            (fabs(x) + fabs(y)) * k[i].known + plane_length(x * k[i].x, y * k[i].y) + DBL_MIN;
        for (s = 0; s < 2; s++)
            if (!(v[i].x[s] * x + v[i].y[s] * y > least)) return 0;
    }
    return 1;
}

/* Whether some direction is found along which all vectors are clear: their sum, or the middle of
   those that the two outermost allow. */
static int are_on_one_side(const moving_vector *v, int count, const clearance *k)
{
    double x = 0, y = 0, rx = v[0].x[0], ry = v[0].y[0], lx = rx, ly = ry, r, l;
    int i, s;
    for (i = 0; i < count; i++) {
        x += v[i].x[0] + v[i].x[1];
        y += v[i].y[0] + v[i].y[1];
    }
    if (are_clear_along(v, count, x, y, k)) return 1;
    for (i = 0; i < count; i++)
        for (s = 0; s < 2; s++) {
            double px = v[i].x[s], py = v[i].y[s];
            if (rx * py - ry * px < 0) {
                rx = px;
                ry = py;
            }
            if (lx * py - ly * px > 0) {
                lx = px;
                ly = py;
            }
        }
    r = sqrt(rx * rx + ry * ry);
    l = sqrt(lx * lx + ly * ly);
    /* if the first vector is 0, none replaced it: then these are NaN, and nothing is clear */
    return are_clear_along(v, count, ly / l - ry / r, rx / r - lx / l, k);
}

/* The four vectors from an edge to another. */
static int are_edges_clear(const moving_vector v[4], const clearance k[4], int halvings)
{
    moving_vector half[4];
    int i, second;
    if (are_on_one_side(v, 4, k)) return 1;
    if (!halvings) return 0;
    for (second = 0; second < 2; second++) {
        for (i = 0; i < 4; i++) half[i] = half_motion(v[i], second);
        if (!are_edges_clear(half, k, halvings - 1)) return 0;
    }
    return 1;
}

/*
 * Two edges from a shared point: v[0] is the opposite of one, v[1] the other. Their cross product
 * is off by 2 error (|a|1 + |b|1) + 8 error^2, and to be larger than d times the longer edge, in
 * the plane of unit vectors; lengths of edges there are |(x / length.x, y / length.y)|,
 * and areas smaller by length.x length.y.
 *
 * If the two fold onto each other between the ends, the far end of the shorter one lies on the
 * other edge then, and a third edge begins there. That one and the other edge are a pair, too, and
 * not clear, unless they share a point: then the three are a loop. One that turns to the right goes
 * round a hole, which can turn inside out and back: only cross[1] tells (holes_of_three_corners in
 * tests/test_steps.c). One that turns to the left is the outside of a piece, with the area of its
 * triangles and holes; those of the triangles stay positive, and a hole that turned inside out is
 * found by its own edges. So where corners turn to the left, cross[1] is asked for nothing but
 * symmetry, and no test can fail without it.
 */
static int are_open(const sc_moving_contour *c, const moving_vector v[2], const clearance k[2],
                    int halvings)
{
    const double error = (double)c->start.error;
    double cross[3], size = 0, longest = 0, least;
    moving_vector half[2];
    int i, s, second;
    if (are_on_one_side(v, 2, k)) return 1;
    for (i = 0; i < 2; i++) {
        double one = 0;
        for (s = 0; s < 2; s++) {
            double x = fabs(v[i].x[s]), y = fabs(v[i].y[s]);
            one = one > x + y ? one : x + y;
            /* d u w |(x / u, y / w)|, and the errors of x and y */
            longest = fmax(longest, plane_length((x + 2 * error) * k->y, (y + 2 * error) * k->x));
        }
        size += one;
    }
    least = 1.00001 * longest + 2 * error * size + 8 * error * error + DBL_MIN;
    cross[0] = v[0].x[0] * v[1].y[0] - v[0].y[0] * v[1].x[0];
    cross[1] = (v[0].x[0] * v[1].y[1] - v[0].y[0] * v[1].x[1] + v[0].x[1] * v[1].y[0] -
                v[0].y[1] * v[1].x[0]) /
               2;
    cross[2] = v[0].x[1] * v[1].y[1] - v[0].y[1] * v[1].x[1];
    if (cross[0] > least && cross[1] > least && cross[2] > least) return 1;
    if (cross[0] < -least && cross[1] < -least && cross[2] < -least) return 1;
    if (!halvings) return 0;
    for (second = 0; second < 2; second++) {
        for (i = 0; i < 2; i++) half[i] = half_motion(v[i], second);
        if (!are_open(c, half, k, halvings - 1)) return 0;
    }
    return 1;
}

static int is_listed_edge(const sc_moving_contour *c, uint32_t i)
{
    return c->start.edges->is_edge[i / SC_CONTOUR_BLOCK] >> i % SC_CONTOUR_BLOCK & 1;
}

/* How many edges on from edge i edge j comes, if in the same chain and fewer than there are rings;
   else 0. Chains are closed: after the last of one comes the first. */
static uint32_t edges_on(const sc_moving_contour *c, uint32_t i, uint32_t j)
{
    uint32_t s;
    for (s = 1; s < c->rings; s++) {
        if (is_listed_edge(c, i + 1))
            i++;
        else
            while (i && is_listed_edge(c, i - 1)) i--;
        if (i == j) return s;
    }
    return 0;
}

/* Whether edge j, so many edges on from edge i, is as far from it as points so near along the
   contour must be. */
static int are_clear_on_mesh(const sc_moving_contour *c, uint32_t i, uint32_t j, uint32_t edges)
{
    moving_vector v[4], own, other;
    clearance k[4];
    uint32_t s;
    for (s = 0; s < 4; s++) {
        own = contour_point(c, i + s % 2);
        other = contour_point(c, j + s / 2);
        v[s] = moving_difference(other, &own);
        k[s] = clearance_along(c, edges + s / 2 - s % 2);
    }
    return are_edges_clear(v, k, HALVINGS);
}

int sc_moving_contour_are_clear(sc_moving_contour *c, uint32_t i, uint32_t j)
{
    const uint32_t *point = c->start.edges->point;
    uint32_t a = point[i], b = point[i + 1], p = point[j], q = point[j + 1];
    int shared = (a == p) + (a == q) + (b == p) + (b == q);
    const clearance one = clearance_of(c, shared ? c->altitude : c->reach);
    const clearance k[4] = {one, one, one, one};
    moving_vector own[2], other[2], v[4];
    int s;
    if (shared > 1) return 0;
    if (!shared && c->rings) {
        uint32_t edges = edges_on(c, i, j);
        if (edges) return are_clear_on_mesh(c, i, j, edges);
        edges = edges_on(c, j, i);
        if (edges) return are_clear_on_mesh(c, j, i, edges);
    }
    for (s = 0; s < 2; s++) {
        own[s] = contour_point(c, i + (uint32_t)s);
        other[s] = contour_point(c, j + (uint32_t)s);
    }
    if (!shared) {
        for (s = 0; s < 4; s++) v[s] = moving_difference(other[s / 2], &own[s % 2]);
        return are_edges_clear(v, k, HALVINGS);
    }
    s = b == p || b == q;
    v[0] = moving_difference(own[s], &own[1 - s]);
    s = a == q || b == q;
    v[1] = moving_difference(other[1 - s], &other[s]);
    return are_open(c, v, k, HALVINGS) && sc_simple_note_shared(&c->start, i, j);
}

/* Sets what the axes and the error leave to be known. The square root of a sum of squares in double
   precision, rounded to float, is off by less than the factor; so is the sum. */
static void set_clearance(sc_moving_contour *c, const sc_motion *m)
{
    int k;
    c->rings = m->rings > 1 ? m->rings : 0;
    c->known = SC_BOUNDS_MOVING_TURN * c->start.error * 1.000001f;
    c->open = (SC_BOUNDS_MOVING_TURN + 1) * c->start.error * 1.000001f;
    for (k = 0; k < 2; k++) {
        double x = (double)c->start.axis[k][0], y = (double)c->start.axis[k][1],
               z = (double)c->start.axis[k][2];
        c->length[k] = (float)sqrt(x * x + y * y + z * z) * 1.000001f;
        c->reach[k] = c->length[k] * m->distance * 1.000001f;
        c->clear[k] = (c->known + c->reach[k]) * 1.000001f;
        c->altitude[k] = c->length[k] * m->altitude * 1.000004f;
    }
}

/* Whether the contour of a node stays simple. */
static int stays_simple(sc_worker *w, const sc_projection *projection, uint32_t node)
{
    int star = w->step->question->options.contour == SC_CONTOUR_STAR;
    const sc_step_kernels *kernels = w->frame->kernels->step;
    uint32_t previous = sc_worker_switch(w, SC_TASK_UPDATE_CONTOURS);
    sc_moving_contour c;
    int passed = sc_simple_list(&c.start, w->model, &w->contour, node);
    if (passed) {
        c.end = &w->step->contour;
        c.ends = star ? 2 : (int)w->frame->motion.ends;
        sc_simple_axes(&c.start, projection);
        sc_simple_middle(&c.start, w->frame->motion.unit, 8, c.start.from);
        sc_simple_middle(&c.start, w->frame->motion.unit + 4, 8, c.from);
        kernels->project(&c, w->frame->motion.unit);
        set_clearance(&c, &w->frame->motion);
        w->stats.counts[SC_TASK_UPDATE_CONTOURS] += c.start.count;
        sc_worker_switch(w, SC_TASK_CONTOUR);
        w->stats.counts[SC_TASK_CONTOUR]++;
        passed = star ? sc_moving_star_passes(&c)
                      : kernels->are_edges_clear(&c) && sc_simple_is_wound_well(&c.start);
    }
    sc_worker_switch(w, previous);
    return passed;
}

void sc_moving_contour_tests(sc_worker *w, const uint32_t *nodes, uint32_t count, uint8_t *passed)
{
    const uint16_t *mask = w->frame->mask;
    sc_projection projection;
    uint32_t i;
    for (i = 0; i < count; i++) {
        const sc_pair *patches = &sc_model_node(w->model)[nodes[i]].patches;
        passed[i] = 1;
        if (w->step->question->options.contour == SC_CONTOUR_NONE) continue;
        sc_dnc_projection(w->frame, (uint32_t)mask[patches->a] & mask[patches->b], &projection);
        passed[i] = (uint8_t)stays_simple(w, &projection, nodes[i]);
    }
}
