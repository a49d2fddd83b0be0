/*
 * All kernels for one instruction set, and SC_KERNELS, their table. Included by kernels_base.c,
 * kernels_avx2.c and kernels_avx512.c, which say by SC_LANES for which (see simd/lanes.h).
 *
 * SPDX-License-Identifier: MIT
 *
 * Unlike the rest of this folder, this file and those three see all others, as lib/starcontour.c
 * does; nothing in the library includes them. So whatever kernels define has a name of one meaning
 * here. tools/amalgamate.awk, which puts all three into one file, makes three names of it.
 */
#include <float.h>
#include <math.h>
#include <string.h>

#include "base/bounds.h"
#include "base/predicates.h"
#include "near/near_candidates.h"
#include "pose/pose_kernels.h"
#include "pose/positions.h"
#include "query/culling.h"
#include "query/decide.h"
#include "query/query_kernels.h"
#include "query/simple.h"
#include "step/moving_contour.h"
#include "step/step_candidates.h"
#include "step/step_kernels.h"
#include "step/step_motion.h"
#include "step/step_pairs.h"
#include "trace/trace_kernels.h"

#include "simd/target_begin.h"

#include "simd/lanes.h"
#include "simd/exact_doubles.h"

#include "pose/extent_kernel.h"
#include "pose/points_kernel.h"
#include "pose/cones_kernel.h"
#include "pose/refit_kernel.h"

#include "query/slab_kernel.h"
#include "query/derived_kernel.h"
#include "query/neighbor_kernel.h"
#include "query/fan_kernel.h"
#include "query/touch_kernel.h"
#include "query/short_kernel.h"
#include "query/tube_kernel.h"
#include "query/sixteen_kernel.h"
#include "query/cluster_kernel.h"
#include "query/broad_kernel.h"
#include "query/decide_kernel.h"
#include "query/simple_kernel.h"
#include "query/small_kernel.h"

#include "step/apart_kernel.h"
#include "step/moving_cones_kernel.h"
#include "step/moving_contour_kernel.h"
#include "step/leaf_motion_kernel.h"
#include "step/step_rows_kernel.h"
#include "step/step_cluster_kernel.h"

#include "near/distance_kernel.h"
#include "near/near_leaf_kernel.h"
#include "near/near_kernel.h"
#include "near/corner_kernel.h"

#include "trace/crossing_kernel.h"

#include "simd/target_end.h"

static const sc_pose_kernels pose_kernels = {
    .extent_of_doubles = extent_of_doubles,
    .extent_of_floats = extent_of_floats,
    .extent_of_apart_doubles = extent_of_apart_doubles,
    .extent_of_apart_floats = extent_of_apart_floats,
    .load_leaves = load_leaves,
    .cone = cone,
    .refit_leaves = refit_leaves,
    .refit_patches = refit_patches,
};

static const sc_query_kernels query_kernels = {
    .decide = decide,
    .project = project,
    .look_at_edges = look_at_edges,
    .find_simple = find_simple,
};

static const sc_step_kernels step_kernels = {
    .cone = moving_mask_of,
    .project = project_motion,
    .are_edges_clear = are_edges_clear,
};

static const sc_trace_kernels trace_kernels = {
    .look = look_at_crossings,
};

#include "run/stages.h"

const sc_kernels SC_KERNELS = {&pose_kernels,
                               &query_kernels,
                               &step_kernels,
                               &trace_kernels,
                               {{query_stages, between_stages},
                                {step_stages, step_between_stages},
                                {near_stages, near_between_stages}}};
