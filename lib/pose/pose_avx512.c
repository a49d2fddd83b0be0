/*
 * The inner loops over a pose, for machines with AVX-512. See pose_kernels.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "pose/pose_kernels.h"

#include <float.h>

#include "pose/positions.h"

#if SC_ISA_X86

#  include "base/avx512_begin.h"
#  define SC_KERNEL(name) name##_pose_avx512
#  define SC_LANES 3

#  include "base/lanes.h"
#  include "base/lanes_double.h"
#  include "base/lanes_pick.h"
#  include "base/lanes_rows.h"
#  include "pose/extent_kernel.h"
#  include "pose/points_kernel.h"
#  include "pose/cones_kernel.h"
#  include "pose/refit_kernel.h"

const sc_pose_kernels sc_pose_kernels_avx512 = {SC_KERNEL(extent_of_doubles),
                                                SC_KERNEL(extent_of_floats),
                                                SC_KERNEL(extent_of_apart_doubles),
                                                SC_KERNEL(extent_of_apart_floats),
                                                SC_KERNEL(load_leaves),
                                                SC_KERNEL(cone),
                                                SC_KERNEL(refit_leaves),
                                                SC_KERNEL(refit_patches)};

#  include "base/lanes_rows_end.h"
#  include "base/lanes_pick_end.h"
#  include "base/lanes_double_end.h"
#  include "base/lanes_end.h"
#  include "base/avx512_end.h"

#else

typedef int sc_pose_avx512_is_empty; /* C wants a declaration in every file */

#endif
