/*
 * The exact contour test over a step: whether the projected contour of a node stays simple while it
 * moves, with a clearance.
 *
 * SPDX-License-Identifier: MIT
 *
 * Why that is enough. At each time, a patch whose triangles have positive areas under a projection
 * and whose contour is simple is projected one to one (lib/GUARANTEE.md, section 1). If moreover
 * all altitudes of its projected triangles are more than d, and all points of its contour are more
 * than d away from the edges of the contour that they are not on, then in the projection, and hence
 * in space, each vertex is more than d away from each triangle that it is no corner of, and each
 * edge from each edge with which it shares no vertex. For the shortest way from a vertex to such a
 * triangle either crosses a triangle at the vertex to its far side, which is an altitude; or it
 * leaves the patch at the vertex, which is then on the contour, and enters it again across an edge
 * that it is not on. Two edges that do not cross are nearest at an end of one; and if that end is
 * the corner of all triangles at the other edge, their distance is an altitude.
 *
 * Altitudes are seen to with the normal cones (step/step_motion.h).
 */
#ifndef SC_STEP_MOVING_CONTOUR_H
#define SC_STEP_MOVING_CONTOUR_H

#include "step/moving_projection.h"

/* Whether nothing in the patches of nodes[i] comes as near as is reported: passed[i]. Under the
   projection for what their normal cones have in common, which is something, every triangle keeps a
   positive area and altitudes. About 10 ns a contour edge. With SC_CONTOUR_STAR asks for a point
   that sees the contour instead, see step/moving_star.h. */
void sc_moving_contour_tests(sc_worker *w, const uint32_t *nodes, uint32_t count, uint8_t *passed);

/* 1 if two edges are certainly clear of each other, or share one point and nothing else, at all
   times. Notes pinches and pieces. */
int sc_moving_contour_are_clear(sc_moving_contour *contour, uint32_t i, uint32_t j);

#endif
