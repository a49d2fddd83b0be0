/*
 * The inner loops over a pose, for machines with AVX2. See pose_kernels.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "pose/pose_kernels.h"

#include <float.h>

#if SC_ISA_X86

#  include "base/avx2_begin.h"
#  define SC_KERNEL(name) name##_avx2
#  define SC_LANES 2

#  include "base/lanes.h"
#  include "pose/cones_kernel.h"
#  include "pose/fan_kernel.h"
#  include "pose/refit_kernel.h"

const sc_pose_kernels sc_pose_kernels_avx2 = {mask_of_avx2, refit_leaf_avx2, is_plain_avx2};

#  undef SC_KERNEL
#  undef SC_LANES
#  include "base/avx2_end.h"

#else

typedef int sc_pose_avx2_is_empty; /* C wants a declaration in every file */

#endif
