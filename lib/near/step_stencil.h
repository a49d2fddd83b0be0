/*
 * The closest points of a pair of a step at its start and at a time, and how it gets there.
 *
 * SPDX-License-Identifier: MIT
 *
 * What is promised stands at sc_step_stencil in starcontour.h.
 */
#ifndef SC_NEAR_STEP_STENCIL_H
#define SC_NEAR_STEP_STENCIL_H

#include "starcontour.h"

/* kind: SC_NEAR_VERTEX_FACE, points being the vertex and the corners of the face, or
   SC_NEAR_EDGE_EDGE, the ends of a and those of b; at the start and at the end. stencil->time is
   from 0 to 1; all else but vertices is written. */
void sc_step_stencil_find(uint32_t kind, const double start[4][3], const double end[4][3],
                          sc_step_stencil *stencil);

#endif
