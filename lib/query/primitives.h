/*
 * Primitive tests: does an edge meet a triangle, do two triangles meet. Exact for finite doubles.
 *
 * SPDX-License-Identifier: MIT
 *
 * Edges and triangles are closed sets: the convex hulls of their two or three points, whatever
 * these hulls are. Zero-area triangles are segments or points. Every answer is that of exact
 * arithmetic on the coordinates, and follows the definitions of SC_PAIRS_... and SC_CONTACT_... in
 * starcontour.h.
 *
 * "proper" asks for less than touching: the ends of the edge are strictly on opposite sides of the
 * triangle's plane, and the edge passes strictly inside all three sides of the triangle.
 *
 * *fallbacks is as in base/predicates.h. Cost: 10 to 20 ns for a pair of triangles one of which is
 * on one side of the other's plane, up to about 100 ns else; coplanar and degenerate ones up to a
 * few us. The caller is expected to have compared boxes.
 */
#ifndef SC_QUERY_PRIMITIVES_H
#define SC_QUERY_PRIMITIVES_H

#include <stdint.h>

/*
 * Two triangles: three positions each, and the numbers of the vertices after welding. Equal numbers
 * have equal positions. Unequal numbers may have, and a triangle may repeat a number.
 */
typedef struct sc_triangle_pair {
    const double *a[3];
    const double *b[3];
    uint32_t va[3];
    uint32_t vb[3];
} sc_triangle_pair;

/* Bits of edges: 0 to 2 for the edges of a, 3 to 5 for those of b; k runs from vertex k to k +
   1. */
enum { SC_PRIMITIVES_ALL_EDGES = 63 };

/* Whether the segment from p to q meets a triangle. */
int sc_primitives_segment_meets(const double p[3], const double q[3],
                                const double *const triangle[3], int proper, uint64_t *fallbacks);

/*
 * Those of the edges given that meet the triangle they are not of. Sides that share a vertex number
 * with that triangle, or go from a vertex to itself, are none of them.
 */
unsigned sc_primitives_edge_hits(const sc_triangle_pair *pair, int proper, unsigned edges,
                                 uint64_t *fallbacks);

/*
 * Whether the two are a triangle pair. In full, with S the set of the vertex numbers that they
 * share:
 *   none    their hulls have a common point;
 *   one     the hull of the vertices of one that are not in S, if any, meets the hull of the other;
 *   two     their hulls have a common point off the segment between the two shared vertices;
 *   three   yes.
 * If proper: whether an edge of one, sharing no vertex with the other, crosses it properly.
 */
int sc_primitives_triangles_meet(const sc_triangle_pair *pair, int proper, uint64_t *fallbacks);

#endif /* SC_QUERY_PRIMITIVES_H */
