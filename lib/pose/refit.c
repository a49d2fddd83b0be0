/*
 * Boxes of triangles and patches for a pose. See refit.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "pose/refit.h"

#include "pose/levels.h"
#include "pose/pose_kernels.h"

typedef struct refit_pass {
    const sc_model *model;
    sc_frame *frame;
} refit_pass;

static void refit(void *context, uint32_t level, uint32_t first, uint32_t end)
{
    const refit_pass *pass = (const refit_pass *)context;
    const sc_pose_kernels *kernels = pass->frame->kernels->pose;
    const uint32_t leaves = sc_model_first_leaf_patch(pass->model);
    if (level + 1 < pass->model->level_count) {
        kernels->refit_patches(pass->model, pass->frame, first, end);
        return;
    }
    if (!pass->frame->leaves_ready)
        kernels->load_leaves(pass->model, pass->frame, first - leaves, end - leaves, 0);
    kernels->refit_leaves(pass->model, pass->frame, first - leaves, end - leaves);
}

void sc_refit_boxes(const sc_model *model, sc_frame *frame)
{
    refit_pass pass;
    if (frame->boxes_ready) return;
    pass.model = model;
    pass.frame = frame;
    sc_levels_up(model, frame->tasks, refit, &pass);
    frame->leaves_ready = frame->boxes_ready = 1;
}
