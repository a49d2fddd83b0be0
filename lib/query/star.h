/*
 * The star-contour test on the contour segments of a node (paper, section 6.2), and its special
 * case of two patches that share a single point (appendix).
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef SC_QUERY_STAR_H
#define SC_QUERY_STAR_H

#include "query/worker.h"

/*
 * 1 if no two triangles of the node (of its two patches, one from each, if they share a single
 * point) meet elsewhere than in what they share. Every triangle must have a positive area under the
 * projection of w->bounds. Tries the vertical line, then the horizontal. Updates the bounds of
 * segments that it needs; counts updates and tests.
 */
int sc_star_test(sc_worker *w, uint32_t node);

#endif
