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

#endif
