/*
 * Regions: into which parts contours divide the surface.
 *
 * SPDX-License-Identifier: MIT
 *
 * A crossed edge is cut into intervals, of which the first and the last are its ends, vertices. In
 * a triangle contours run from edge to edge, as chains: two intervals on its border are in one
 * region there if each chain has both on one side. Edges that nothing crosses join their ends.
 */
#ifndef SC_TRACE_REGIONS_H
#define SC_TRACE_REGIONS_H

#include "trace/crossings.h"

/* trace and result were checked; numbers in trace were not. */
sc_status sc_regions_find(const sc_trace_subject *subject, const sc_trace_result *trace,
                          sc_scratch *scratch, sc_regions_result *result);

#endif
