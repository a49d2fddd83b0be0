/*
 * The inner loops over a pose, for every machine: by SSE2 on x86-64, else as the compiler can. See
 * pose_kernels.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "pose/pose_kernels.h"

#include <float.h>
#include <string.h>

#include "pose/positions.h"

#define SC_KERNEL(name) name##_pose_base
#define SC_LANES SC_QUADS

#include "base/lanes.h"
#include "base/lanes_double.h"
#include "base/lanes_pick.h"
#include "base/lanes_rows.h"
#include "pose/extent_kernel.h"
#include "pose/points_kernel.h"
#include "pose/cones_kernel.h"
#include "pose/refit_kernel.h"

const sc_pose_kernels sc_pose_kernels_base = {SC_KERNEL(extent_of_doubles),
                                              SC_KERNEL(extent_of_floats),
                                              SC_KERNEL(extent_of_apart_doubles),
                                              SC_KERNEL(extent_of_apart_floats),
                                              SC_KERNEL(load_leaves),
                                              SC_KERNEL(cone),
                                              SC_KERNEL(refit_leaves),
                                              SC_KERNEL(refit_patches)};

#include "base/lanes_rows_end.h"
#include "base/lanes_pick_end.h"
#include "base/lanes_double_end.h"
#include "base/lanes_end.h"
