/*
 * Points where three sheets meet: where contours cross each other on the surface.
 *
 * SPDX-License-Identifier: MIT
 *
 * Three triangles have a point in common if each two have a segment in common and two of these
 * segments cross the third triangle's plane. So the segments of all contours are a graph whose
 * nodes are triangles, and what is looked at are its triangles: three segments, of three triangles
 * two by two.
 */
#ifndef SC_TRACE_TRIPLES_H
#define SC_TRACE_TRIPLES_H

#include "trace/crossings.h"

/* trace and result were checked; numbers in trace were not. */
sc_status sc_triples_find(const sc_trace_subject *subject, const sc_trace_result *trace,
                          sc_scratch *scratch, sc_triples_result *result);

#endif
