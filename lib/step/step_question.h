/*
 * What a step is asked: poses, options and tasks as the caller passed them, checked and copied.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef SC_STEP_QUESTION_H
#define SC_STEP_QUESTION_H

#include "step/step_state.h"

/* All of a question that is not in the state of its step. */
typedef struct sc_step_question {
    sc_pose pose[2];    /* at the start and at the end */
    uint64_t stride[2]; /* of these, in bytes */
    sc_tasks tasks;
} sc_step_question;

/* Everything about a step but which result it goes to. What is wrong is told the log. */
sc_status sc_step_question_read(const sc_model *model, sc_workspace *workspace,
                                const sc_pose *start, const sc_pose *end,
                                const sc_step_options *from, const sc_step_result *result,
                                sc_step_options *options, sc_step_question *question);

#endif
