/*
 * Loops: the contour of each node as one closed list of points, ready to be fetched.
 *
 * SPDX-License-Identifier: MIT
 *
 * A query tests the contours of nodes as a whole (query/simple.h), and following segments from
 * place to place would cost it more than the test itself. So each contour is stored point by point,
 * in 16 bits: 16 times the number of a leaf cluster that has the point, plus its place there. Leaf
 * clusters are numbered within the node, those of its first patch before those of its second. About
 * 12 points a triangle in all. Before the points of a contour in pieces (SC_NODE_PIECES), closed
 * chains, stand their number and the number of edges of each.
 *
 * Places in leaf clusters are not as in leaf_point but transposed: its sixteen are taken as a table
 * of four by four, of which rows and columns are exchanged. So are the points of a pose kept
 * (sc_frame.point_at), for that is how vector units have them at hand.
 *
 * Contours in more than SC_LOOP_PIECES pieces or of more than SC_LOOP_PIECES_EDGES edges in pieces,
 * and of more than SC_LOOP_LEAVES leaf clusters or SC_LOOP_MAX edges, which are few, have an empty
 * loop; and so have nodes of two patches that share one point, of which queries do not ask for the
 * contour.
 */
#ifndef SC_BUILD_LOOPS_H
#define SC_BUILD_LOOPS_H

#include "build/csf.h"

/* From a place in leaf_point to a transposed one, and back. */
static inline uint32_t sc_loops_turn(uint32_t place)
{
    return (place & ~15u) | (place & 3u) << 2 | (place >> 2 & 3u);
}

/*
 * Writes the loops, csf->loop_first[node_count] numbers. leaf_corner is as in the model
 * (build/model.h), order the hierarchy's.
 */
sc_status sc_loops_write(const sc_csf *csf, const sc_sctt *sctt, const sc_xbvh *xbvh,
                         const uint32_t *order, const uint8_t *leaf_corner, sc_scratch *scratch,
                         uint16_t *loop);

#endif
