/*
 * What of a step, or of a search for what is near, is to be recorded: checked as it would be if it
 * were asked.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef SC_RUN_RECORDED_H
#define SC_RUN_RECORDED_H

#include "query/recording.h"

/* *recorded refers to the caller's arrays, and to itself. Tasks are not looked at. */
sc_status sc_recorded_step(const sc_model *model, const sc_pose *start, const sc_pose *end,
                           const sc_step_options *options, sc_recorded *recorded);
sc_status sc_recorded_near(const sc_model *model, const sc_pose *pose,
                           const sc_near_options *options, sc_recorded *recorded);

#endif
