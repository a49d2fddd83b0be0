/*
 * The three ways to find the pairs of leaf clusters whose triangles must be compared.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef SC_QUERY_TRAVERSAL_H
#define SC_QUERY_TRAVERSAL_H

#include "query/state.h"

/* Runs the method of state->options on the pose in the workspace. */
void sc_traversal_run(sc_query_state *state);

#endif
