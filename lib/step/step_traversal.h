/*
 * The ways to find the pairs of leaf clusters in a step: the test tree, or the plain tree of boxes.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef SC_STEP_TRAVERSAL_H
#define SC_STEP_TRAVERSAL_H

#include "step/step_state.h"

/* Finds the pairs of a step that was read. */
void sc_step_traversal_run(sc_step_state *state);

#endif
