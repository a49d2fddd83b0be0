/*
 * Rest-shape caching (paper, section 8): which nodes fail which test in the rest pose.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef SC_RUN_REST_H
#define SC_RUN_REST_H

#include "build/model.h"

/* Tests every node of a new model in its rest pose and marks them, and fills the counts per
   level. */
sc_status sc_rest_mark(sc_model *model, const sc_pose *rest, uint64_t stride, sc_scratch *scratch,
                       const sc_hooks *hooks);

#endif
