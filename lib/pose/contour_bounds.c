/*
 * Bounds of contour segments under a projection. See contour_bounds.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "base/bounds.h"
#include "pose/contour_bounds.h"

#include <math.h>
#include <string.h>

#include "base/assume.h"
#include "pose/positions.h"

static const sc_ray_bound NO_LINES = {INFINITY, INFINITY, -INFINITY, INFINITY, INFINITY, -INFINITY};

void sc_contour_bounds_project(const sc_contour_bounds *bounds, int line, uint32_t point, double *x,
                               double *y)
{
    const sc_projection *projection = &bounds->projection;
    double p[3], d0, d1, d2, u, v;
    sc_positions_get(bounds->positions, point, p);
    d0 = p[0] - projection->origin[0];
    d1 = p[1] - projection->origin[1];
    d2 = p[2] - projection->origin[2];
    u = projection->u[0] * d0 + projection->u[1] * d1 + projection->u[2] * d2;
    v = projection->w[0] * d0 + projection->w[1] * d1 + projection->w[2] * d2;
    *x = line == SC_LINE_VERTICAL ? u : v;
    *y = line == SC_LINE_VERTICAL ? v : -u;
}

double sc_contour_bounds_lowest(const sc_ray_bound *bound, double x)
{
    double ax = (double)bound->ax, ay = (double)bound->ay, bx = (double)bound->bx;
    double by = (double)bound->by, base, rise;
    if (ax > bx) return HUGE_VAL;
    if (x <= ax) {
        base = ay;
        rise = x == ax ? 0 : (double)bound->most * (x - ax);
    } else if (x >= bx) {
        base = by;
        rise = x == bx ? 0 : (double)bound->least * (x - bx);
    } else {
        base = ay;
        rise = (by - ay) * ((x - ax) / (bx - ax));
    }
    base = base + rise - SC_BOUNDS_RAY_SUM * (fabs(ay) + fabs(by) + fabs(rise));
    return base == base ? base : -HUGE_VAL; /* infinities that met */
}

/* A segment whose lines are not known, or not numbers: anything, anywhere. */
static void make_unbounded(sc_segment_bounds *bounds)
{
    static const sc_ray_bound anything = {-FLT_MAX, -INFINITY, FLT_MAX, -INFINITY, 0, 0};
    bounds->side[SC_SIDE_TOP] = bounds->side[SC_SIDE_BOTTOM] = anything;
}

/* Edges of a segment without children at most: all sides of a leaf cluster. */
enum { EDGES_MAX = 3 * SC_LEAF_MAX };

/* Edges must be this many times longer than the error of a coordinate, along the axis, to have a
   slope; so that in what follows the errors of dx are below 2^-19 of it. */
static const double LEAST_RUN = 0x1p20;

/* The lines of the edges of one side, as they are collected. */
typedef struct edge_lines {
    double x[EDGES_MAX], y[EDGES_MAX], slope[EDGES_MAX];
    double low, high, least, most, steepness, slope_error, height;
    double not_finite; /* stays 0 unless a slope or a height is NaN or infinite */
    uint32_t count;
} edge_lines;

/*
 * The line of one edge from (x, y), whose run is along the axis from low to high. The true slope
 * (dy + 2 y_error) / (dx + 2 x_error) differs from the computed one by at most
 * 2 (y_error + |slope| x_error) / (|dx| - 2 x_error), and rounding.
 */
static inline void add_line(edge_lines *lines, double x, double y, double slope, double inverse_run,
                            double low, double high, double x_error, double y_error)
{
    double steepness = fabs(slope);
    double error = 2.0001 * (y_error + steepness * x_error) * fabs(inverse_run) +
                   SC_BOUNDS_RAY_SUM * steepness;
    uint32_t i = lines->count++;
    lines->x[i] = x;
    lines->y[i] = y;
    lines->slope[i] = slope;
    lines->not_finite += 0 * slope + 0 * y;
    if (i == 0) {
        lines->low = low;
        lines->high = high;
        lines->least = slope - error;
        lines->most = slope + error;
        lines->steepness = steepness;
        lines->slope_error = error;
        lines->height = fabs(y);
        return;
    }
    if (low < lines->low) lines->low = low;
    if (high > lines->high) lines->high = high;
    if (slope - error < lines->least) lines->least = slope - error;
    if (slope + error > lines->most) lines->most = slope + error;
    if (steepness > lines->steepness) lines->steepness = steepness;
    if (error > lines->slope_error) lines->slope_error = error;
    if (fabs(y) > lines->height) lines->height = fabs(y);
}

/*
 * The bound of collected lines. At x = a the true line is at
 * y + slope (a - x), off by at most y_error + |slope| x_error + slope_error (|a - x| + x_error) and
 * rounding; |a - x| is at most bx - ax.
 */
static int bound_lines(const edge_lines *lines, double x_error, double y_error, sc_ray_bound *b)
{
    double ax, bx, at_a = HUGE_VAL, at_b = HUGE_VAL, error, reach;
    uint32_t i;
    if (!lines->count) {
        *b = NO_LINES;
        return 1;
    }
    b->ax = sc_boxes_below(lines->low - x_error);
    b->bx = sc_boxes_above(lines->high + x_error);
    b->least = sc_boxes_below(lines->least);
    b->most = sc_boxes_above(lines->most);
    ax = (double)b->ax;
    bx = (double)b->bx;
    for (i = 0; i < lines->count; i++) {
        double at = lines->y[i] + lines->slope[i] * (ax - lines->x[i]);
        if (at < at_a) at_a = at;
        at = lines->y[i] + lines->slope[i] * (bx - lines->x[i]);
        if (at < at_b) at_b = at;
    }
    reach = bx - ax;
    error = y_error + (lines->steepness + lines->slope_error) * x_error +
            lines->slope_error * reach +
            SC_BOUNDS_RAY_SUM * (lines->height + lines->steepness * (fabs(ax) + fabs(bx)));
    b->ay = sc_boxes_below(at_a - error);
    b->by = sc_boxes_below(at_b - error);
    /* all of it finite: so no later sum or product is NaN. Slopes are, as runs are longer than
       LEAST_RUN errors, which are a fixed part of all that is projected. */
    return lines->not_finite == 0 && b->ax > -FLT_MAX && b->bx < FLT_MAX && b->ay > -FLT_MAX &&
           b->by > -FLT_MAX && SC_ALWAYS(b->least > -FLT_MAX && b->most < FLT_MAX);
}

/* From edges (paper, section 6.4); 0 if an edge's side or slope is not certain. */
static int bound_edges(const sc_contour_bounds *b, int line, const uint32_t *points, uint32_t edges,
                       sc_segment_bounds *bounds)
{
    const sc_projection *projection = &b->projection;
    double x_error = line == SC_LINE_VERTICAL ? projection->x_error : projection->y_error;
    double y_error = line == SC_LINE_VERTICAL ? projection->y_error : projection->x_error;
    edge_lines top, bottom;
    double x0, y0;
    uint32_t i;
    if (edges > EDGES_MAX) return 0;
    top.count = bottom.count = 0;
    top.not_finite = bottom.not_finite = 0;
    sc_contour_bounds_project(b, line, points[0], &x0, &y0);
    for (i = 1; i <= edges; i++) {
        double x1, y1, dx, inverse;
        sc_contour_bounds_project(b, line, points[i], &x1, &y1);
        dx = x1 - x0;
        inverse = 1 / dx;
        if (dx < -LEAST_RUN * x_error)
            add_line(&top, x0, y0, (y1 - y0) * inverse, inverse, x1, x0, x_error, y_error);
        else if (dx > LEAST_RUN * x_error)
            add_line(&bottom, x0, -y0, (y0 - y1) * inverse, inverse, x0, x1, x_error, y_error);
        else
            return 0;
        x0 = x1;
        y0 = y1;
    }
    return bound_lines(&top, x_error, y_error, &bounds->side[SC_SIDE_TOP]) &&
           bound_lines(&bottom, x_error, y_error, &bounds->side[SC_SIDE_BOTTOM]);
}

/* Widens a bound so that it holds for a child's lines too: slopes and extent. */
static inline void unite_extent(sc_ray_bound *b, const sc_ray_bound *child)
{
    if (child->ax < b->ax) b->ax = child->ax;
    if (child->bx > b->bx) b->bx = child->bx;
    if (child->least < b->least) b->least = child->least;
    if (child->most > b->most) b->most = child->most;
}

/* Then lowers its ends to the child's lines, which they are not inside of: left of a child, its
   greatest slope counts, right of it its least. */
static inline void unite_ends(sc_ray_bound *b, const sc_ray_bound *child)
{
    double ax, bx, at_a, at_b, rise_a, rise_b;
    if (child->ax > child->bx) return;
    ax = (double)b->ax;
    bx = (double)b->bx;
    rise_a = (double)child->most * (ax - (double)child->ax);
    rise_b = (double)child->least * (bx - (double)child->bx);
    at_a =
        (double)child->ay + rise_a - SC_BOUNDS_RAY_SUM * (fabs((double)child->ay) + fabs(rise_a));
    at_b =
        (double)child->by + rise_b - SC_BOUNDS_RAY_SUM * (fabs((double)child->by) + fabs(rise_b));
    if (at_a < (double)b->ay) b->ay = sc_boxes_below(at_a);
    if (at_b < (double)b->by) b->by = sc_boxes_below(at_b);
}

void sc_contour_bounds_begin(const sc_model *model, const sc_positions *positions,
                             const sc_projection *projection, sc_contour_bounds *bounds)
{
    int k;
    if (bounds->epoch == 0xffff) {
        for (k = 0; k < 2; k++)
            memset(bounds->epoch_of[k], 0, model->segment_count * sizeof *bounds->epoch_of[k]);
        bounds->epoch = 0;
    }
    bounds->epoch++;
    bounds->positions = positions;
    bounds->projection = *projection;
}

uint32_t sc_contour_bounds_update(const sc_model *model, sc_contour_bounds *b, int line,
                                  uint32_t segment)
{
    sc_segment_bounds *of = b->of[line], *bounds = &of[segment];
    const uint32_t *first, *children = sc_model_children(model);
    uint32_t i, updated = 1;
    int side;
    if (b->epoch_of[line][segment] == b->epoch) return 0;
    b->epoch_of[line][segment] = b->epoch;
    if (segment < model->leaf_segment_count) {
        uint32_t begin = sc_model_segment_first(model)[segment];
        if (!bound_edges(b, line, sc_model_points(model) + begin,
                         sc_model_segment_last(model)[segment] - begin, bounds))
            make_unbounded(bounds);
        return 1;
    }
    first = sc_model_segment_children(model) + (segment - model->leaf_segment_count);
    for (i = first[0]; i < first[1]; i++)
        updated += sc_contour_bounds_update(model, b, line, children[i]);
    for (side = 0; side < 2; side++) {
        sc_ray_bound all = NO_LINES;
        for (i = first[0]; i < first[1]; i++) unite_extent(&all, &of[children[i]].side[side]);
        for (i = first[0]; i < first[1]; i++) unite_ends(&all, &of[children[i]].side[side]);
        bounds->side[side] = all;
    }
    return updated;
}

static int is_edge_bounded(const sc_segment_bounds *bounds, double x0, double y0, double x1,
                           double y1)
{
    int side = x1 < x0 ? SC_SIDE_TOP : SC_SIDE_BOTTOM;
    const sc_ray_bound *b = &bounds->side[side];
    double flip = side == SC_SIDE_TOP ? 1 : -1, slope = flip * (y1 - y0) / (x1 - x0);
    if (b->ay == -INFINITY) return 1;
    return x0 >= (double)b->ax && x0 <= (double)b->bx && x1 >= (double)b->ax &&
           x1 <= (double)b->bx && slope >= (double)b->least && slope <= (double)b->most &&
           flip * y0 + slope * ((double)b->ax - x0) >= (double)b->ay &&
           flip * y0 + slope * ((double)b->bx - x0) >= (double)b->by;
}

int sc_contour_bounds_validate(const sc_model *model, const sc_contour_bounds *b, int line,
                               uint32_t segment)
{
    const uint32_t *points = sc_model_points(model);
    uint32_t i;
    double x0, y0, x1, y1;
    if (b->epoch_of[line][segment] != b->epoch) return 0;
    for (i = sc_model_segment_first(model)[segment]; i < sc_model_segment_last(model)[segment];
         i++) {
        sc_contour_bounds_project(b, line, points[i], &x0, &y0);
        sc_contour_bounds_project(b, line, points[i + 1], &x1, &y1);
        if (!is_edge_bounded(&b->of[line][segment], x0, y0, x1, y1)) return 0;
    }
    return 1;
}
