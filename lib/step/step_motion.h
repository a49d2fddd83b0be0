/*
 * The motion of a step: both poses read, normal cones and boxes that hold for all of it.
 *
 * SPDX-License-Identifier: MIT
 *
 * Points move on straight lines, and so a point of a patch stays inside the box that moves, side by
 * side, from the patch's box at the start to that at the end. Two such boxes are apart at all times
 * if on one axis one is below the other at both ends: what they have in common of their motion does
 * not matter.
 *
 * What is culled is farther apart than the narrow phase ever reports (sc_impact_thickness): so it
 * alone decides, whatever was culled, and all methods give the same list.
 *
 * All passes over vertices, leaf clusters and patches are shared out among the frame's tasks, if
 * there are any.
 */
#ifndef SC_STEP_MOTION_H
#define SC_STEP_MOTION_H

#include "base/bounds.h"
#include "pose/positions.h"
#include "step/impact.h"

/* By how much boxes of points are enlarged, for sets that are to be separated by a distance. */
static inline float sc_motion_margin(float distance)
{
    return distance * 1.000001f + SC_BOUNDS_MOVING_BOX;
}

/* Notes where positions are, and finds the box of both poses: low and high of the frame. The poses
   were checked but for what this reports: SC_ERROR_NOT_FINITE. */
sc_status sc_motion_bound(const sc_model *model, const sc_pose pose[2], const uint64_t stride[2],
                          sc_frame *frame);

/* Fills unit of the motion, by center and scale of the frame. Both together take about 6 ns a
   vertex. */
void sc_motion_scale(const sc_model *model, sc_frame *frame);

/* How far apart things must be, so that the narrow phase never reports them: half_side is half of
   the longest side of the box of all there is. A tolerance of 0 becomes the default. */
double sc_motion_clearance(sc_impact_limits *limits, double half_side);

/* Fills distance and margin of the motion for that. */
void sc_motion_keep_clear(double clearance, sc_frame *frame);

/* All of these, of one mesh: its box is the unit box. */
sc_status sc_motion_read(const sc_model *model, const sc_pose pose[2], const uint64_t stride[2],
                         sc_impact_limits *limits, sc_frame *frame);

/* Says that nothing is wanted that is fewer edges of the mesh apart: how high triangles must be, to
   be culled, and which cones are ready depends on it. After sc_motion_keep_clear. */
void sc_motion_leave_out_rings(uint32_t rings, sc_frame *frame);

/* Whether about three quarters of the leaf clusters, or more, have triangles at the start that are
   no higher than the altitude, as a sample tells. No contour of such a one is simple with enough
   clearance, and to look for contours takes a tenth of a search for what is near, and more where
   rings are left out. Decides no answer. */
int sc_motion_is_wide(const sc_model *model, const sc_frame *frame);

/* Fills the frame's mask with normal cones that hold throughout the step. About 10 ns a
   triangle. */
void sc_motion_update_cones(const sc_model *model, sc_frame *frame);

/* Fills the boxes of patches unless they are ready; where swept, with those of the whole motion,
   twice. About 10 ns a triangle. */
void sc_motion_refit(const sc_model *model, sc_frame *frame);

#endif
