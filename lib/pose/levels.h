/*
 * Passes over all patches, bottom up, shared out among the host's tasks.
 *
 * SPDX-License-Identifier: MIT
 *
 * One job, however many levels there are: a part is what lies below some patches of a level near
 * the top. Only the few patches above that level are left to the calling thread.
 */
#ifndef SC_POSE_LEVELS_H
#define SC_POSE_LEVELS_H

#include "build/model.h"

/* Does patches first to end - 1 of a level, at least one; their children are done. */
typedef void (*sc_levels_body)(void *context, uint32_t level, uint32_t first, uint32_t end);

/* Does all patches of all levels. tasks: NULL for one thread, which takes each level as a whole. */
void sc_levels_up(const sc_model *model, const sc_tasks *tasks, sc_levels_body body, void *context);

#endif
