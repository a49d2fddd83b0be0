/*
 * Boxes of triangles and patches for a pose. See refit.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "pose/refit.h"

#include "pose/pose_kernels.h"

void sc_refit_boxes(const sc_model *model, sc_workspace *w)
{
    const uint32_t *first = sc_model_level_first(model);
    const sc_pose_kernels *kernels = sc_pose_kernels_of(w);
    uint32_t level;
    if (w->boxes_ready) return;
    if (!w->leaves_ready) kernels->load_leaves(model, w, 0, model->leaf_count, 0);
    w->leaves_ready = 1;
    kernels->refit_leaves(model, w, 0, model->leaf_count);
    for (level = model->level_count - 1; level-- > 0;)
        kernels->refit_patches(model, w, first[level], first[level + 1] - 1);
    w->boxes_ready = 1;
}
