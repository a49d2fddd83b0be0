/*
 * The star-contour test over a step. See moving_star.h.
 *
 * SPDX-License-Identifier: MIT
 *
 * Let an edge of the contour run from v, with e to its end, and let q be a point that does not
 * move. That q is to the left of the edge is e x (q - v) > 0, a polynomial of degree 2 in time; its
 * coefficients in Bernstein form are
 *     e0 x (q - v0), (e0 x (q - v1) + e1 x (q - v0)) / 2, e1 x (q - v1),
 * each of them linear in q, as if there were three edges that do not move: three rays of the paper.
 * If all are positive for all edges, the contour turns round q without a stop at all times, as
 * often as edges pass over q at the start. If that is once, it is strictly simple (query/star.c).
 *
 * Clearance. If all coefficients are more than d r, r being at least the distance of any point of
 * the contour from q, then every point of the contour is more than d away from the edges it is not
 * on: between them, seen from q, is at least one edge of that point, v to b say; and from v to what
 * is beyond b it is at least the distance of v from the ray from q to b, or from q; at least e x (q
 * - v) / |b - q|.
 *
 * Where q is found does not matter for what is proved.
 */
#include "step/moving_star.h"

#include <float.h>
#include <math.h>

#include "base/assume.h"

typedef struct star_edge {
    double v[2][2], e[2][2]; /* at the start and at the end */
} star_edge;

/* Edge i, or 0 if there is none. */
static int star_edge_at(const sc_moving_contour *c, uint32_t i, star_edge *edge)
{
    const sc_contour_edges *at = c->start.edges;
    int end, k;
    if (!(at->is_edge[i / SC_CONTOUR_BLOCK] >> i % SC_CONTOUR_BLOCK & 1)) return 0;
    for (end = 0; end < 2; end++)
        for (k = 0; k < 2; k++) {
            const float *x = end ? c->end->at[k] : at->at[k];
            edge->v[end][k] = (double)x[i];
            edge->e[end][k] = (double)x[i + 1] - (double)x[i];
        }
    return 1;
}

static double star_cross(const double e[2], const double q[2], const double v[2])
{
    return e[0] * (q[1] - v[1]) - e[1] * (q[0] - v[0]);
}

static void star_coefficients(const star_edge *edge, const double q[2], double coefficient[3])
{
    coefficient[0] = star_cross(edge->e[0], q, edge->v[0]);
    coefficient[1] =
        (star_cross(edge->e[0], q, edge->v[1]) + star_cross(edge->e[1], q, edge->v[0])) / 2;
    coefficient[2] = star_cross(edge->e[1], q, edge->v[1]);
}

/* Sets q to the middle of what of a line, vertical (0) or horizontal (1), is left of all rays, if
   anything is. */
static int find_star_point(const sc_moving_contour *c, int line, double q[2])
{
    double low = HUGE_VAL, high = -HUGE_VAL, below = -HUGE_VAL, above = HUGE_VAL;
    star_edge edge;
    uint32_t i;
    int end, k;
    for (i = 0; i < c->start.count; i++) {
        if (!star_edge_at(c, i, &edge)) continue;
        for (end = 0; end < 2; end++) {
            if (edge.v[end][line] < low) low = edge.v[end][line];
            if (edge.v[end][line] > high) high = edge.v[end][line];
        }
    }
    q[line] = low / 2 + high / 2;
    for (i = 0; i < c->start.count; i++) {
        double at[3], next[3];
        if (!star_edge_at(c, i, &edge)) continue;
        q[1 - line] = 0;
        star_coefficients(&edge, q, at);
        q[1 - line] = 1;
        star_coefficients(&edge, q, next);
        for (k = 0; k < 3; k++) {
            double slope = next[k] - at[k];
            if (slope > 0 && -at[k] / slope > below) below = -at[k] / slope;
            if (slope < 0 && -at[k] / slope < above) above = -at[k] / slope;
        }
    }
    q[1 - line] = below / 2 + above / 2;
    /* a closed contour around triangles that face one way has edges on all sides */
    return below < above && !SC_HARDLY(above - below == HUGE_VAL);
}

/*
 * The proof for a point. A coefficient is off by 2 error |q - v|1 + error |e|1 + 4 error^2; r in
 * the plane of unit vectors, times the lengths of both axes, is at most |x| length.y + |y|
 * length.x, see step/moving_contour.c.
 */
static int is_star_point(const sc_moving_contour *c, const double q[2])
{
    double error = (double)c->start.error, reach[2] = {0, 0}, least;
    uint32_t i, crossings = 0;
    star_edge edge;
    int end, k;
    for (i = 0; i < c->start.count; i++) {
        if (!star_edge_at(c, i, &edge)) continue;
        for (end = 0; end < 2; end++)
            for (k = 0; k < 2; k++) reach[k] = fmax(reach[k], fabs(edge.v[end][k] - q[k]) + error);
    }
    least = 1.00001 * (reach[0] * ((double)c->clear[1] - 5 * error) +
                       reach[1] * ((double)c->clear[0] - 5 * error));
    for (i = 0; i < c->start.count; i++) {
        double coefficient[3], size = 0, bound;
        if (!star_edge_at(c, i, &edge)) continue;
        for (end = 0; end < 2; end++)
            size = fmax(size, fabs(edge.e[end][0]) + fabs(edge.e[end][1]));
        bound =
            least + error * (2.0001 * (reach[0] + reach[1]) + 1.0001 * size + 4 * error) + DBL_MIN;
        star_coefficients(&edge, q, coefficient);
        for (k = 0; k < 3; k++)
            if (!(coefficient[k] > bound)) return 0;
        crossings +=
            (double)c->start.edges->at[0][i] > q[0] && (double)c->start.edges->at[0][i + 1] <= q[0];
    }
    return crossings == 1;
}

int sc_moving_star_passes(const sc_moving_contour *c)
{
    double q[2];
    int line;
    for (line = 0; line < 2; line++)
        if (find_star_point(c, line, q) && is_star_point(c, q)) return 1;
    return 0;
}
