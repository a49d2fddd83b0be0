/*
 * The inner loops of a query, for every machine: by SSE2 on x86-64, else in plain C. See query_kernels.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "query/query_kernels.h"

#include <float.h>

#define SC_KERNEL(name) name##_base
#if SC_ISA_X86
#  include <emmintrin.h>
#  define SC_LANES 1
#else
#  define SC_LANES 0
#endif

#include "base/lanes.h"
#include "query/walk_kernel.h"
#include "query/planes_kernel.h"
#include "query/simple_kernel.h"

const sc_query_kernels sc_query_kernels_base = {
    patch_pair_base,  patch_itself_base, leaf_pair_base,     leaf_itself_base,
    test_planes_base, project_base,      are_edges_fine_base};

#undef SC_KERNEL
#undef SC_LANES
