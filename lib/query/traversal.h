/*
 * The three ways to find the pairs of leaf clusters whose triangles must be compared.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef SC_QUERY_TRAVERSAL_H
#define SC_QUERY_TRAVERSAL_H

#include "query/state.h"

/* Runs the method of state->options on the pose in the workspace. */
void sc_traversal_run(sc_query_state *state);

/*
 * The steps that this is made of, for several workers to share (query/parallel.c). Each worker
 * walks by itself, on the sc_walk of its workspace.
 */

/* Normal cones; and boxes, unless they are ready. */
void sc_traversal_update_normals(sc_query_state *state);
void sc_traversal_update_boxes(sc_query_state *state);

/* Box and primitive tests to come follow a failed contour test, or do not. */
void sc_traversal_follow_contour(sc_query_state *state, int after_contour);

/* Boxes and triangles of nodes first to end - 1, all of which are taken as colliding. */
void sc_traversal_take_nodes(sc_query_state *state, uint32_t first, uint32_t end);

/* The orientation test: the node is put on the stack or waits in one of the walk's queues. */
void sc_traversal_orient(sc_query_state *state, uint32_t node);

/* The contour tests of nodes that passed it: whether they pass, too. */
void sc_traversal_test(sc_query_state *state, const uint32_t *nodes, uint32_t count,
                       uint8_t *passed);

/* Finds out where culling has prospects. */
void sc_traversal_find_prospects(const sc_query_state *state);

/* Box and primitive tests of all pairs of patches that wait for them in the walk. */
void sc_traversal_take_boxes(sc_query_state *state);

/* Orientation tests of the children of a node that failed a test; its pairs of patches wait. */
void sc_traversal_open(sc_query_state *state, uint32_t node);

/* Leaf clusters to be looked at by themselves, as sc_walk.alone has them, but those that are culled
   with others. */
void sc_traversal_take_alone(sc_query_state *state, const uint32_t *alone, uint32_t count);

/* Goes on until neither queue nor stack has anything left. */
void sc_traversal_walk(sc_query_state *state);

#endif
