/*
 * Whether two features are within a distance.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef SC_STEP_WITHIN_H
#define SC_STEP_WITHIN_H

/* Points 0: the vertex, 1 to 3: the face. Whether their distance is <= distance. */
int sc_within_vertex_face(const double p[4][3], double distance);

/* Points 0 and 1: an edge, 2 and 3: the other. */
int sc_within_edge_edge(const double p[4][3], double distance);

#endif
