/*
 * Culling: from the nodes of the test tree to pairs of patches that are left to boxes.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef SC_QUERY_CULLING_H
#define SC_QUERY_CULLING_H

#include "query/worker.h"

/* Stages, see query/lists.h; each takes `most` items of its list or fewer.

   Opens nodes that failed a test: their children pass the orientation test or not, and what they
   leave to boxes. */
void sc_culling_open(sc_worker *w, uint32_t most);

/* The contour tests of nodes that passed the orientation test. */
void sc_culling_test(sc_worker *w, uint32_t most);

/* The paper's optimised tree of boxes: opens nodes all of which are taken as colliding. */
void sc_culling_take_spans(sc_worker *w, uint32_t most);

/* The paper's query, with the star test or none: the projection of a node is that of all below. */
void sc_culling_take_stars(sc_worker *w, uint32_t most);

/* Contour tests of such nodes: passed[i] says what of nodes[i]. */
void sc_culling_test_all(sc_worker *w, const uint32_t *nodes, uint32_t count, uint8_t *passed);

/* Puts a node where it belongs by its orientation test. */
void sc_culling_orient(sc_worker *w, uint32_t node);

/* Whether nodes are left to boxes where culling has no prospects. */
int sc_culling_weighs_prospects(const sc_worker *w);

/* Finds out where: writes to the frame. */
void sc_culling_find_prospects(const sc_worker *w);

#endif
