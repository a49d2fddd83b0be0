/*
 * What is true of contours, of where they cross, of their gradients and of regions, whatever the
 * mesh and the pose. For the fuzz target of traces: each function ends the program at what is not.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef SC_TESTS_TRACE_CHECKS_H
#define SC_TESTS_TRACE_CHECKS_H

#include "starcontour.h"
#include "trace_oracle.h"

/* A mesh in a pose, and the contours that the library found. */
typedef struct trace_facts {
    uint32_t vertex_count, triangle_count;
    const uint32_t *triangles; /* 3 corners each, after welding */
    const double *positions;   /* 3 a vertex */
    sc_trace_result trace;
} trace_facts;

/* Contours are made of the oracle's crossings: each is in one contour, or, where its edge has not
   two triangles, in one for each of these. They go on where the edge has two triangles, through
   both of them, and end elsewhere. No segment is there twice. Nodes are where they say. */
void trace_check_contours(const trace_facts *facts, const trace_oracle_answer *truth);

/* Vertices, weights and flags are those of the nodes; numbers are finite; and contours without flat
   nodes push nothing, up to the errors that starcontour.h allows. */
void trace_check_gradients(const trace_facts *facts, const sc_trace_gradient *gradients);

/* Triples come in the order of their triangles, each two of which have the segment behind a node,
   between whose ends the point is. The ends of segments of the first few are on different sides of
   the third triangle's plane, as the oracle has them. */
void trace_check_triples(const trace_facts *facts, const sc_triples_result *triples);

/* What no contour crosses is in one region. Regions are in order, and know their components; areas
   add up to that of the mesh; hints name the smaller side. The result has all arrays. */
void trace_check_regions(const trace_facts *facts, const sc_regions_result *regions);

#endif
