/*
 * What a step is asked: poses, options and tasks as the caller passed them, checked and copied.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef SC_RUN_STEP_QUESTION_H
#define SC_RUN_STEP_QUESTION_H

#include "run/question.h"

/* Everything about a step; *question is zero before. What is wrong is told the log. */
sc_status sc_step_question_read(const sc_model *model, const sc_workspace *workspace,
                                const sc_pose *start, const sc_pose *end,
                                const sc_step_options *from, const sc_step_result *result,
                                sc_asked *asked, sc_step_question *question);

/* Options of a step, which may be NULL, checked; *options is zero before. */
sc_status sc_step_question_read_options(const sc_hooks *hooks, const sc_step_options *from,
                                        sc_step_options *options);

/* Puts in place of defaults what they stand for on this model and machine. */
sc_status sc_step_question_choose(const sc_model *model, sc_step_options *options);

/* SC_ERROR_OPTION if a length is negative, infinite or NaN. */
sc_status sc_step_question_check_length(const sc_hooks *hooks, const char *name, double length);

/* Which pairs are not wanted: the filters and the rest pose of the question's options. Of asked it
   fills the rest pose, to which the options refer then. */
sc_status sc_step_question_read_filters(const sc_hooks *hooks, const sc_model *model,
                                        sc_asked *asked, sc_step_question *question);

/* What all queries are asked, and where the answer goes, from options that are complete. */
void sc_step_question_fill(const sc_step_result *result, sc_step_question *question);

#endif
