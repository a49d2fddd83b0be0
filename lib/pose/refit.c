/*
 * Boxes of triangles and patches for a pose. See refit.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "pose/refit.h"

#include "base/jobs.h"
#include "pose/pose_kernels.h"

/* A pass over the patches of a level, which are counted from its first. */
typedef struct refit_pass {
    const sc_model *model;
    sc_workspace *w;
    uint32_t first;
} refit_pass;

static void refit_leaves(void *context, uint32_t part, uint32_t first, uint32_t end)
{
    const refit_pass *pass = (const refit_pass *)context;
    const sc_pose_kernels *kernels = sc_pose_kernels_of(pass->w);
    (void)part;
    if (!pass->w->leaves_ready) kernels->load_leaves(pass->model, pass->w, first, end, 0);
    kernels->refit_leaves(pass->model, pass->w, first, end);
}

static void refit_patches(void *context, uint32_t part, uint32_t first, uint32_t end)
{
    const refit_pass *pass = (const refit_pass *)context;
    (void)part;
    sc_pose_kernels_of(pass->w)->refit_patches(pass->model, pass->w, pass->first + first,
                                               pass->first + end);
}

void sc_refit_boxes(const sc_model *model, sc_workspace *w)
{
    const uint32_t *first = sc_model_level_first(model);
    refit_pass pass;
    uint32_t level;
    if (w->boxes_ready) return;
    pass.model = model;
    pass.w = w;
    (void)sc_jobs_loop(w->tasks, model->leaf_count, SC_POSE_LEAVES_MIN, refit_leaves, &pass);
    w->leaves_ready = 1;
    for (level = model->level_count - 1; level-- > 0;) {
        pass.first = first[level];
        (void)sc_jobs_loop(w->tasks, sc_model_patches(model, level), SC_POSE_PATCHES_MIN,
                           refit_patches, &pass);
    }
    w->boxes_ready = 1;
}
