/*
 * The star-contour test. See star.h.
 *
 * SPDX-License-Identifier: MIT
 *
 * Why it is sound. Let q be a point on the search line, below every top edge's line and above every
 * bottom edge's: strictly to the left of every contour edge. Seen from q, each contour edge turns
 * counter-clockwise, so each closed loop of the contour goes round q at least once, and the loops
 * together as often as top edges pass over q. If at most one does, there is one loop, once round,
 * and the angle at q tells its points apart: the contour is strictly simple. With all triangles of
 * positive area, the number of triangles over any point is the winding number of the contour, at
 * most 1; so triangles overlap nowhere and touch only where they share vertices. Neither
 * connectivity nor a manifold is needed: what does not cancel is in the contour.
 */
#include "query/star.h"

#include <math.h>

#include "base/hooks.h"
#include "pose/contour_bounds.h"

static void update(sc_worker *w, int line, const uint32_t *segments, uint32_t count)
{
    uint32_t i, previous = sc_worker_switch(w, SC_TASK_UPDATE_CONTOURS);
    for (i = 0; i < count; i++)
        w->stats.counts[SC_TASK_UPDATE_CONTOURS] +=
            sc_contour_bounds_update(w->model, w->bounds, line, segments[i]);
#ifdef SC_VALIDATE
    for (i = 0; i < count; i++)
        SC_HOOKS_ASSERT(w->hooks,
                        sc_contour_bounds_validate(w->model, w->bounds, line, segments[i]));
#endif
    sc_worker_switch(w, previous);
}

/* Steps 1 to 7 of section 6.2 for one line. */
static int is_star(const sc_segment_bounds *bounds, const uint32_t *segments, uint32_t count)
{
    double low = HUGE_VAL, high = -HUGE_VAL, x, top = HUGE_VAL, bottom = HUGE_VAL;
    uint32_t i, crossings = 0;
    int side;
    for (i = 0; i < count; i++)
        for (side = 0; side < 2; side++) {
            const sc_ray_bound *b = &bounds[segments[i]].side[side];
            if ((double)b->ax < low) low = (double)b->ax;
            if ((double)b->bx > high) high = (double)b->bx;
        }
    x = low / 2 + high / 2;
    for (i = 0; i < count; i++) {
        double t = sc_contour_bounds_lowest(&bounds[segments[i]].side[SC_SIDE_TOP], x);
        double b = sc_contour_bounds_lowest(&bounds[segments[i]].side[SC_SIDE_BOTTOM], x);
        if (t < top) top = t;
        if (b < bottom) bottom = b;
    }
    /* bottom bounds are upside down: highest bottom line = -bottom < top. A sum has the exact
       sign. */
    if (!(top + bottom > 0)) return 0;
    for (i = 0; i < count; i++) {
        const sc_segment_bounds *s = &bounds[segments[i]];
        if ((double)s->side[SC_SIDE_TOP].ax > x || (double)s->side[SC_SIDE_TOP].bx < x) continue;
        /* with bottom edges as well, the segment may come back and cross again */
        if (!sc_contour_bounds_empty(&s->side[SC_SIDE_BOTTOM])) return 0;
        if (++crossings > 1) return 0;
    }
    return crossings == 1;
}

static uint32_t end_point(const sc_model *model, uint32_t segment, int last)
{
    const uint32_t *at = last ? sc_model_segment_last(model) : sc_model_segment_first(model);
    return sc_model_points(model)[at[segment]];
}

/*
 * Whether all points of a segment but the shared one are strictly on one side of the line through
 * it: sign -1 to its left, 1 to its right; x is where the line is, computed, and error how far off.
 * Segments that end at the shared point may touch the line there: if all their edges run the same
 * way, they leave it for good.
 */
static int is_beside(const sc_model *model, const sc_segment_bounds *bounds, uint32_t segment,
                     uint32_t point, double x, double error, int sign)
{
    const sc_ray_bound *top = &bounds->side[SC_SIDE_TOP], *bottom = &bounds->side[SC_SIDE_BOTTOM];
    int starts = end_point(model, segment, 0) == point,
        ends = end_point(model, segment, 1) == point;
    if (top->ay == -INFINITY) return 0; /* what is not known is not on both sides */
    if (!starts && !ends) {
        double low = (double)(top->ax < bottom->ax ? top->ax : bottom->ax);
        double high = (double)(top->bx > bottom->bx ? top->bx : bottom->bx);
        return sign < 0 ? high < x - 2 * error : low > x + 2 * error;
    }
    if (starts && ends) return 0;
    /* top edges run left, bottom edges right */
    if (starts == (sign < 0)) return sc_contour_bounds_empty(bottom);
    return sc_contour_bounds_empty(top);
}

/* Appendix: a line through the shared point that has the two patches on different sides. */
static int is_separated(const sc_worker *w, int line, uint32_t point, const uint32_t *segments,
                        uint32_t first_count, uint32_t count)
{
    const sc_contour_bounds *b = w->bounds;
    double x, y, error = line == SC_LINE_VERTICAL ? b->projection.x_error : b->projection.y_error;
    uint32_t i;
    int sign;
    sc_contour_bounds_project(b, line, point, &x, &y);
    for (sign = -1; sign <= 1; sign += 2) {
        for (i = 0; i < count; i++)
            if (!is_beside(w->model, &b->of[line][segments[i]], segments[i], point, x, error,
                           i < first_count ? sign : -sign))
                break;
        if (i == count) return 1;
    }
    return 0;
}

int sc_star_test(sc_worker *w, uint32_t node)
{
    const sc_model *model = w->model;
    const sc_node *n = sc_model_node(model) + node;
    const uint32_t *segments = sc_model_contours(model) + n->contour;
    uint32_t count = n[1].contour - n->contour;
    uint32_t previous = sc_worker_switch(w, SC_TASK_CONTOUR), point = 0, first_count = 0;
    int touches = n->kind & SC_NODE_TOUCHES, line, passed = 0;
    w->stats.counts[SC_TASK_CONTOUR]++;
    if (touches) {
        point = segments[0];
        first_count = segments[1];
        segments += 2;
        count -= 2;
    }
    for (line = 0; line < 2 && !passed; line++) {
        update(w, line, segments, count);
        passed = touches ? is_separated(w, line, point, segments, first_count, count)
                         : is_star(w->bounds->of[line], segments, count);
    }
    sc_worker_switch(w, previous);
    return passed;
}
