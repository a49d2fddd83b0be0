/*
 * The closest points of a vertex and a face, or of two edges: which features they are on, their
 * weights, and the vector between them.
 *
 * SPDX-License-Identifier: MIT
 *
 * What is promised stands at sc_near_stencil in starcontour.h.
 */
#ifndef SC_NEAR_STENCIL_H
#define SC_NEAR_STENCIL_H

#include "starcontour.h"

/* kind: SC_NEAR_VERTEX_FACE, points being the vertex and the corners of the face, or
   SC_NEAR_EDGE_EDGE, the ends of a and those of b. All but stencil->vertices is written. */
void sc_stencil_find(uint32_t kind, const double *const points[4], sc_near_stencil *stencil);

#endif
