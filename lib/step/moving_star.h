/*
 * The star-contour test over a step: the paper's test, extended to motion; for comparison.
 *
 * SPDX-License-Identifier: MIT
 *
 * It looks at every edge of the contour instead of at bounds of segments, and passes less often
 * than the exact test (step/moving_contour.h).
 */
#ifndef SC_STEP_MOVING_STAR_H
#define SC_STEP_MOVING_STAR_H

#include "step/moving_projection.h"

/* Whether some point, in the frame that moves with the middle of a projected contour, certainly
   sees all of it at all times, far enough from its edges. */
int sc_moving_star_passes(const sc_moving_contour *contour);

#endif
