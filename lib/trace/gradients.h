/*
 * Gradients: how the length of a contour changes as the vertices near each of its nodes move.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef SC_TRACE_GRADIENTS_H
#define SC_TRACE_GRADIENTS_H

#include "pose/positions.h"

/* Writes the stencil of each node of each contour that traced has room for; those of nodes of no
   contour become zero. Pointers were checked. SC_ERROR_PAIRS, SC_ERROR_NOT_FINITE. */
sc_status sc_gradients_find(const sc_model *model, const sc_positions *positions,
                            const sc_trace_result *traced, sc_trace_gradient *gradients);

#endif
