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
 *
 * Where pairs are left out that are fewer than k >= 2 edges of the mesh apart, less is enough. Let
 * h = d / (k - 1), and let n(x, y) be the way along the contour between two of its points, each
 * edge having length 1 and being gone along evenly. If
 *   - all altitudes of projected triangles are more than h,
 *   - of two edges of the contour, one of which comes fewer than k after the other, all
 *     points x and y are more than (n(x, y) - 1) h apart, and
 *   - those of all other edges that share no point more than d,
 * then no pair that is not left out is within d. For a point of a triangle is a set of weights of
 * its corners. Let delta(p, q) be the least cost of moving the weights of p to where those of q
 * are, along edges of the mesh that cost 1 each. It is the most by which a function can change from
 * p to q that changes by at most 1 along each edge, and in a triangle none of these is steeper than
 * 1 over the least altitude. So along a straight line in the projected patch delta grows by at most
 * 1 / h for each unit of length, and if the line from p to q, of length d or less, stays inside,
 * delta(p, q) <= d / h < k. If not, let it leave the part that holds p at a point x of the contour,
 * and come to the part that holds q at y. They are no more than d apart, and so one of them comes
 * soon after the other: |xy| > (n(x, y) - 1) h, where n(x, y) >= delta(x, y). Then delta(p, q) <=
 * |px| / h + delta(x, y) + |yq| / h < (d - |xy|) / h + |xy| / h + 1 = k. As delta is a mean of
 * numbers of edges between corners of what p is in and corners of what q is in, one of these is
 * less than k: the pair is left out.
 *
 * Edges that share a point, wherever they are in the contour, are to be open with a clearance of h
 * (moving_contour.c): along some direction both lead away from each other by more than h, or the
 * end of each is more than h away from the other's line. Points of them that are t and u edges away
 * from the shared one are then more than (t + u) h / 2 apart, which is at least (t + u - 1) h.
 *
 * (A window along the contour without what is left of the way, the projection alone, or mean
 * altitudes would lose pairs.)
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
