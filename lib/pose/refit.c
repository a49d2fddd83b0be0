/*
 * Boxes of triangles and patches for a pose. See refit.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "pose/refit.h"

#include "pose/pose_kernels.h"

static inline float smaller(float a, float b)
{
    return a < b ? a : b;
}

static inline float larger(float a, float b)
{
    return a > b ? a : b;
}

void sc_refit_boxes(const sc_model *model, sc_workspace *w)
{
    const uint32_t *level_first = sc_model_level_first(model), *child = sc_model_child(model);
    const sc_pose_kernels *kernels = sc_pose_kernels_of(w);
    uint32_t level, p, leaf, k;
    if (w->boxes_ready) return;
    for (leaf = 0; leaf < model->leaf_count; leaf++) kernels->refit_leaf(model, w, leaf);
    for (level = model->level_count - 1; level-- > 0;)
        for (k = 0; k < 3; k++) {
            float *low = w->patch_boxes.side[k], *high = w->patch_boxes.side[k + 3];
            for (p = level_first[level]; p + 1 < level_first[level + 1]; p++) {
                uint32_t first = child[p], last = child[p + 1] - 1; /* one child, or two */
                low[p] = smaller(low[first], low[last]);
                high[p] = larger(high[first], high[last]);
            }
        }
    w->boxes_ready = 1;
}
