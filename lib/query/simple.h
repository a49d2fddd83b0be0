/*
 * The exact contour test: whether the projected contour of a node is simple.
 *
 * SPDX-License-Identifier: MIT
 *
 * The paper's star test asks for a point that sees the whole contour. This asks for what the
 * argument behind it needs and no more: that contour edges meet nowhere but in points that they
 * share, that where the contour passes through a point twice it does not cross itself there, and
 * that several pieces do not lie inside one another the wrong way (lib/GUARANTEE.md, section 1).
 * Nearly every patch of a smooth mesh passes that passes the orientation test.
 */
#ifndef SC_QUERY_SIMPLE_H
#define SC_QUERY_SIMPLE_H

#include "pose/dnc.h"
#include "query/simple_contour.h"
#include "query/worker.h"

/*
 * 1 if no two triangles of the node meet elsewhere than in what they share. Every triangle must
 * have a positive area under the projection. Cost: about 2.5 ns a contour edge with AVX-512; counts
 * edges and tests.
 */
int sc_simple_test(sc_worker *w, const sc_projection *projection, uint32_t node);

/* Tests nodes whose patches have normal cones with a direction in common, along the average of
   those: passed[i] says what of nodes[i]. The contours of some are looked at together, so that what
   one wrote down need not be read at once. Where the query is to end, the rest does not pass. */
void sc_simple_tests(sc_worker *w, const uint32_t *nodes, uint32_t count, uint8_t *passed);

/* Of those along the averages of the directions in some masks; 0 for a mask that is 0. */
void sc_simple_axes_of(const uint16_t mask[SC_DNC_VECTORS], sc_simple_some_axes *axes);

#endif
