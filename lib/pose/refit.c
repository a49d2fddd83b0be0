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
    sc_workspace *w;
} refit_pass;

static void refit(void *context, uint32_t level, uint32_t first, uint32_t end)
{
    const refit_pass *pass = (const refit_pass *)context;
    const sc_pose_kernels *kernels = pass->w->kernels->pose;
    const uint32_t leaves = sc_model_first_leaf_patch(pass->model);
    if (level + 1 < pass->model->level_count) {
        kernels->refit_patches(pass->model, pass->w, first, end);
        return;
    }
    if (!pass->w->leaves_ready)
        kernels->load_leaves(pass->model, pass->w, first - leaves, end - leaves, 0);
    kernels->refit_leaves(pass->model, pass->w, first - leaves, end - leaves);
}

void sc_refit_boxes(const sc_model *model, sc_workspace *w)
{
    refit_pass pass;
    if (w->boxes_ready) return;
    pass.model = model;
    pass.w = w;
    sc_levels_up(model, w->tasks, refit, &pass);
    w->leaves_ready = w->boxes_ready = 1;
}
