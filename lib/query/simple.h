/*
 * The exact contour test: whether the projected contour of a node is simple.
 *
 * SPDX-License-Identifier: MIT
 *
 * The paper's star test asks for a point that sees the whole contour. This asks for what the argument
 * behind it needs and no more: that contour edges meet nowhere but in points that they share, that
 * where the contour passes through a point twice it does not cross itself there, and that several
 * pieces do not lie inside one another the wrong way (lib/GUARANTEE.md, section 1). Nearly every patch
 * of a smooth mesh passes that passes the orientation test.
 */
#ifndef SC_QUERY_SIMPLE_H
#define SC_QUERY_SIMPLE_H

#include "query/state.h"

/*
 * 1 if no two triangles of the node meet elsewhere than in what they share. Every triangle must have a
 * positive area under the projection. Cost: about 2.5 ns a contour edge with AVX-512; counts edges and tests.
 */
int sc_simple_test(sc_query_state *state, const sc_projection *projection, uint32_t node);

/* Asks for memory that the test of a node will read, in steps 0 to SC_SIMPLE_FETCHES - 1, of which each reads what the one
   before asked for. */
enum { SC_SIMPLE_FETCHES = 4 };
void sc_simple_fetch(const sc_model *model, uint32_t node, int step);

#endif
