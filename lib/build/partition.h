/*
 * Where the hierarchy of patches comes from: the built-in bisection, or the caller's function,
 * order or tree.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef SC_BUILD_PARTITION_H
#define SC_BUILD_PARTITION_H

#include "build/adjacency.h"
#include "build/hierarchy.h"

sc_status sc_partition_build(const sc_points *points, const sc_adjacency *adjacency,
                             const sc_build_options *options, sc_scratch *scratch,
                             sc_hierarchy *hierarchy);

#endif
