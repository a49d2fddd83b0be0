/*
 * What a search for what is near is asked: pose, options and tasks as the caller passed them,
 * checked and copied.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef SC_RUN_NEAR_QUESTION_H
#define SC_RUN_NEAR_QUESTION_H

#include "near/near_worker.h"
#include "run/question.h"

/* Everything about it; *question is zero before. What is wrong is told the log. */
sc_status sc_near_question_read(const sc_model *model, const sc_workspace *workspace,
                                const sc_pose *pose, const sc_near_options *from,
                                const sc_near_result *result, sc_asked *asked,
                                sc_near_question *question);

/* Options of it, which may be NULL, checked; *options is zero before. */
sc_status sc_near_question_read_options(const sc_hooks *hooks, const sc_near_options *from,
                                        sc_near_options *options);

/* Puts in place of defaults what they stand for on this model and machine. */
sc_status sc_near_question_choose(const sc_model *model, sc_near_options *options);

/* What a step that stays where it is is asked, and where the answer goes, from options that are
   complete. */
void sc_near_question_fill(const sc_near_result *result, sc_near_question *question);

#endif
