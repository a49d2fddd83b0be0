/*
 * The inner loops of a query, for machines with AVX2. See query_kernels.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "query/query_kernels.h"

#include <float.h>

#if SC_ISA_X86

#  include "base/avx2_begin.h"
#  define SC_KERNEL(name) name##_avx2
#  define SC_LANES 2

#  include "base/lanes.h"
#  include "query/walk_kernel.h"
#  include "query/planes_kernel.h"
#  include "query/simple_kernel.h"

const sc_query_kernels sc_query_kernels_avx2 = {
    patch_pair_avx2,  patch_itself_avx2, leaf_pair_avx2,     leaf_itself_avx2,
    test_planes_avx2, project_avx2,      are_edges_fine_avx2};

#  undef SC_KERNEL
#  undef SC_LANES
#  include "base/avx2_end.h"

#else

typedef int sc_query_avx2_is_empty; /* C wants a declaration in every file */

#endif
