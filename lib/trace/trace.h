/*
 * Contours of intersections, from the pairs of edges and triangles of a pose.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef SC_TRACE_TRACE_H
#define SC_TRACE_TRACE_H

#include "trace/crossings.h"

/* Writes contours and their nodes as far as there is room, and how many there are. result was
   checked; its counts are 0. */
sc_status sc_trace_run(const sc_trace_subject *subject, sc_scratch *scratch,
                       sc_trace_result *result);

#endif
