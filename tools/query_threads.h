/*
 * The threads that building and queries of a program use (--threads): one pool for all of them.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef TOOLS_QUERY_THREADS_H
#define TOOLS_QUERY_THREADS_H

#include "starcontour.h"

#include <stdbool.h>

/* Starts as many as are needed for so many workers, 1 to SC_WORKERS_MAX; before any workspace is
   made. False if they cannot be started. */
bool query_threads_start(uint32_t workers);

/* Ends them. Queries are done by one thread then, as before the start. */
void query_threads_stop(void);

/* For sc_build_options.tasks and sc_query_options.tasks: NULL if there is one worker. */
const sc_tasks *query_threads_tasks(void);

/* A workspace for queries by these workers. flags: SC_WORKSPACE_... */
sc_status query_threads_workspace(const sc_model *model, uint32_t flags, sc_workspace **workspace);

#endif /* TOOLS_QUERY_THREADS_H */
