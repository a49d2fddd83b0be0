/*
 * Bounds of contour segments under a projection (paper, sections 6.2 to 6.4).
 *
 * SPDX-License-Identifier: MIT
 *
 * A search line is vertical (line 0) or horizontal (line 1). For the horizontal one the plane is
 * turned by a quarter, (x, y) -> (y, -x), which keeps orientation, so that it is vertical too.
 * Edges that run to the left have the patch below them: top edges. Edges that run to the right are
 * bottom edges, and are kept upside down, (x, y) -> (x, -y), so that both kinds need a lower bound.
 * A segment with an edge that floating point cannot tell to be either has unbounded bounds of both
 * kinds.
 *
 * Each bound holds for the exact lines: computed values are moved outwards by their error.
 */
#ifndef SC_POSE_CONTOUR_BOUNDS_H
#define SC_POSE_CONTOUR_BOUNDS_H

#include "pose/dnc.h"

/*
 * The lower bound of a bundle of lines (paper, section 6.4): none of the lines is below
 *   the line through (ax, ay) with slope most for x <= ax,
 *   the chord from (ax, ay) to (bx, by) between,
 *   the line through (bx, by) with slope least for x >= bx;
 * and the edges that the lines prolong lie within [ax, bx]. No edges: ax > bx. Nothing known, not
 * even the extent: ay is -infinity, and [ax, bx] all there is.
 */
typedef struct sc_ray_bound {
    float ax, ay, bx, by, least, most;
} sc_ray_bound;

/* Of a contour segment under one projection, for one search line: its top edges, and its bottom
   edges turned upside down. */
typedef struct sc_segment_bounds {
    sc_ray_bound side[2];
} sc_segment_bounds;

enum { SC_LINE_VERTICAL = 0, SC_LINE_HORIZONTAL = 1 };
enum { SC_SIDE_TOP = 0, SC_SIDE_BOTTOM = 1 };

/* Bounds of all segments under the projection at hand. */
typedef struct sc_contour_bounds {
    const sc_positions *positions;
    sc_projection projection;
    sc_segment_bounds *of[2]; /* segment_count, for the vertical and the horizontal line */
    uint16_t *epoch_of[2];    /* segment_count: the epoch in which they were computed */
    uint16_t epoch;           /* of the projection */
} sc_contour_bounds;

/* Starts a projection of a pose: bounds of any before are stale. */
void sc_contour_bounds_begin(const sc_model *model, const sc_positions *positions,
                             const sc_projection *projection, sc_contour_bounds *bounds);

/* Updates the bounds for a line of a segment and all it is made of, unless they are of this
   projection already. Returns the number of segments updated. */
uint32_t sc_contour_bounds_update(const sc_model *model, sc_contour_bounds *bounds, int line,
                                  uint32_t segment);

/* A value not above any line of the bundle at x; infinity for no lines. */
double sc_contour_bounds_lowest(const sc_ray_bound *bound, double x);

/* For debug builds and tests: 1 if the bounds of a segment are of this projection, hold its edges,
   and are above none of their lines at its ends. */
int sc_contour_bounds_validate(const sc_model *model, const sc_contour_bounds *bounds, int line,
                               uint32_t segment);

static inline int sc_contour_bounds_empty(const sc_ray_bound *bound)
{
    return bound->ax > bound->bx;
}

/* A point under a projection, with the plane turned for a line. */
void sc_contour_bounds_project(const sc_contour_bounds *bounds, int line, uint32_t point, double *x,
                               double *y);

#endif
