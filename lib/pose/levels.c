/*
 * Passes over all patches, bottom up. See levels.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "pose/levels.h"

#include "base/jobs.h"
#include "build/hierarchy.h"

/* Fewer leaf clusters below a patch are not worth a part. */
enum { LEAVES_BELOW_MIN = 64 };

typedef struct climb {
    const sc_model *model;
    sc_levels_body body;
    void *context;
    uint32_t top; /* level whose patches are shared out */
} climb;

/* All that is below patches of that level, which are counted from its first, and they
   themselves. */
static void climb_part(void *context, uint32_t part, uint32_t first, uint32_t end)
{
    const climb *c = (const climb *)context;
    const uint32_t *child = sc_model_child(c->model);
    uint32_t from[SC_DEPTH_MAX + 1], to[SC_DEPTH_MAX + 1], level;
    (void)part;
    from[c->top] = sc_model_level_first(c->model)[c->top] + first;
    to[c->top] = sc_model_level_first(c->model)[c->top] + end;
    for (level = c->top + 1; level < c->model->level_count; level++) {
        from[level] = child[from[level - 1]];
        to[level] = child[to[level - 1]];
    }
    while (level-- > c->top) c->body(c->context, level, from[level], to[level]);
}

void sc_levels_up(const sc_model *model, const sc_tasks *tasks, sc_levels_body body, void *context)
{
    const uint32_t *first = sc_model_level_first(model);
    uint32_t level;
    climb c;
    c.model = model;
    c.body = body;
    c.context = context;
    c.top = 0;
    /* tasks are given with many leaf clusters: the last level, which has all of them, is none to go
       to */
    while (tasks && sc_model_patches(model, c.top) < 2 * SC_JOBS_PARTS &&
           sc_model_patches(model, c.top + 1) <= model->leaf_count / LEAVES_BELOW_MIN)
        c.top++;
    (void)sc_jobs_loop(tasks, sc_model_patches(model, c.top), 1, climb_part, &c);
    for (level = c.top; level-- > 0;)
        body(context, level, first[level], first[level] + sc_model_patches(model, level));
}
