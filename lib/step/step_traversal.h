/*
 * The ways to find the pairs of leaf clusters in a step: the test tree, or the plain tree of boxes.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef SC_STEP_TRAVERSAL_H
#define SC_STEP_TRAVERSAL_H

#include "step/step_worker.h"

/* Finds the pairs of a step that was read. */
void sc_step_traversal_run(sc_worker *w);

/* ---- its parts, for run/step_parallel.c ---- */

/* Makes normal cones; boxes, unless they are there. */
void sc_step_traversal_update_cones(sc_worker *w);
void sc_step_traversal_refit(sc_worker *w);

/* What follows counts as coming after a failed contour test, or not. */
void sc_step_traversal_follow_contour(sc_worker *w, int after_contour);

/* The normal cone of a node; 0 if there is none. */
uint32_t sc_step_traversal_mask(const sc_worker *w, uint32_t node);

/* Whether nothing in a node collides, as its cone and contour say. failed: it has a contour that
   failed. */
int sc_step_traversal_culls(sc_worker *w, uint32_t node, int failed);

/* What a node that is not culled leaves to boxes. */
void sc_step_traversal_query_rest(sc_worker *w, uint32_t node);

#endif
