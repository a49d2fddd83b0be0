/*
 * The inner loops of a query, for every machine: by SSE2 on x86-64, else as the compiler can. See
 * query_kernels.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "query/query_kernels.h"

#include <float.h>
#include <string.h>

#include "base/predicates.h"
#include "pose/positions.h"
#include "query/simple.h"

#define SC_KERNEL(name) name##_query_base
#define SC_LANES SC_QUADS

#include "base/lanes.h"
#include "base/lanes_double.h"
#include "base/lanes_pick.h"
#include "base/lanes_bytes.h"
#include "base/lanes_cells.h"
#include "pose/points_kernel.h"
#include "query/ready_kernel.h"
#include "query/neighbor_kernel.h"
#include "query/fan_kernel.h"
#include "query/outline_kernel.h"
#include "query/touch_kernel.h"
#include "query/short_kernel.h"
#include "query/tube_kernel.h"
#include "query/sixteen_kernel.h"
#include "query/leaf_kernel.h"
#include "query/walk_kernel.h"
#include "query/decide_kernel.h"
#include "query/simple_kernel.h"
#include "query/small_kernel.h"

const sc_query_kernels sc_query_kernels_base = {
    SC_KERNEL(patch_pairs),   SC_KERNEL(leaf_pair_waits), SC_KERNEL(leaf_itself),
    SC_KERNEL(leaf_pairs),    SC_KERNEL(decide),          SC_KERNEL(project),
    SC_KERNEL(look_at_edges), SC_KERNEL(find_simple)};

#include "base/lanes_cells_end.h"
#include "base/lanes_bytes_end.h"
#include "base/lanes_pick_end.h"
#include "base/lanes_double_end.h"
#include "base/lanes_end.h"
