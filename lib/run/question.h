/*
 * What a query is asked: poses, options and tasks as the caller passed them, checked and copied.
 *
 * SPDX-License-Identifier: MIT
 *
 * What is wrong is told the log, whose hooks may be NULL.
 */
#ifndef SC_RUN_QUESTION_H
#define SC_RUN_QUESTION_H

#include "run/workspace.h"

/* What the caller passed, copied: a question refers to it. */
typedef struct sc_asked {
    sc_pose pose[2];    /* of a query the first; of a step those at the start and at the end */
    uint64_t stride[2]; /* of these, in bytes */
    sc_pose rest;       /* of a step whose options have one */
    uint64_t rest_stride;
    sc_filter filter;
    sc_tasks tasks;
} sc_asked;

/* A pose, which the header calls `name`, of a model; what may be wrong afterwards are its
   positions. */
sc_status sc_question_read_pose(const sc_hooks *hooks, const char *name, const sc_model *model,
                                const sc_pose *from, sc_pose *pose, uint64_t *stride);

/* Tells the log which vertex makes a pose not finite; where: the end of the message. */
void sc_question_log_not_finite(const sc_hooks *hooks, const sc_model *model, const sc_pose *pose,
                                uint64_t stride, const char *where);

/* Options of a query, which may be NULL. */
sc_status sc_question_read_options(const sc_hooks *hooks, const sc_query_options *from,
                                   sc_query_options *options);

/* Puts in place of defaults what they stand for on this model and machine. */
sc_status sc_question_choose(const sc_model *model, sc_query_options *options);

/* Copies the caller's tasks, if any, and checks them; *given refers to the copy then. */
sc_status sc_question_read_tasks(const sc_workspace *workspace, const sc_tasks **given,
                                 sc_tasks *tasks);

/* SC_ERROR_WORKSPACE if a workspace is for another model, or has not all of some flags. */
sc_status sc_question_check_workspace(const sc_model *model, const sc_workspace *workspace,
                                      uint32_t flags);

/* Everything about a query; *question is zero before. */
sc_status sc_question_read(const sc_model *model, const sc_workspace *workspace,
                           const sc_pose *pose, const sc_query_options *options,
                           const sc_result *result, sc_asked *asked, sc_question *question);

#endif
