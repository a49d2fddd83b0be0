/*
 * The inner loops over a pose, for every machine: by SSE2 on x86-64, else in plain C. See pose_kernels.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "pose/pose_kernels.h"

#include <float.h>

#define SC_KERNEL(name) name##_pose_base
#if SC_ISA_X86
#  include <emmintrin.h>
#  define SC_LANES 1
#else
#  define SC_LANES 0
#endif

#include "base/lanes.h"
#include "base/lanes_pick.h"
#include "pose/cones_kernel.h"
#include "pose/fan_kernel.h"
#include "pose/refit_kernel.h"

const sc_pose_kernels sc_pose_kernels_base = {SC_KERNEL(mask_of), SC_KERNEL(refit_leaf),
                                              SC_KERNEL(are_plain)};

#include "base/lanes_pick_end.h"
#include "base/lanes_end.h"
