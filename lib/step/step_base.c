/*
 * The inner loops of a query of a step, for every machine: by SSE2 on x86-64, else as the compiler
 * can. See step_kernels.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "step/step_kernels.h"

#include <float.h>

#include "step/leaf_step.h"
#include "step/step_candidates.h"
#include "step/step_motion.h"

#define SC_KERNEL(name) name##_step_base
#define SC_LANES SC_QUADS

#include "base/lanes.h"
#include "step/apart_kernel.h"
#include "step/moving_cones_kernel.h"
#include "step/moving_contour_kernel.h"
#include "step/step_walk_kernel.h"

const sc_step_kernels sc_step_kernels_base = {
    SC_KERNEL(patch_pair),     SC_KERNEL(patch_itself),   SC_KERNEL(leaf_pair),
    SC_KERNEL(leaf_itself),    SC_KERNEL(stay_apart),     SC_KERNEL(moving_mask_of),
    SC_KERNEL(project_motion), SC_KERNEL(are_edges_clear)};

#include "base/lanes_end.h"
