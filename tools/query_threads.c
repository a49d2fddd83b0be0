/*
 * The threads that a program's queries use; see query_threads.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "query_threads.h"

#include "thread_pool.h"
#include "tool.h"

#include <string.h>

static thread_pool *pool; /* NULL: one worker */

bool query_threads_start(uint32_t workers)
{
    if (workers < 2) return true;
    pool = thread_pool_create(workers);
    return pool != NULL;
}

void query_threads_stop(void)
{
    thread_pool_free(pool);
    pool = NULL;
}

const sc_tasks *query_threads_tasks(void)
{
    return thread_pool_tasks(pool);
}

sc_status query_threads_workspace(const sc_model *model, uint32_t flags, sc_workspace **workspace)
{
    sc_workspace_options options;
    memset(&options, 0, sizeof options);
    options.struct_size = sizeof options;
    options.flags = flags;
    options.workers = pool ? thread_pool_tasks(pool)->workers : 1;
    const sc_status status = sc_workspace_create_for(model, &options, workspace);
    return status ? status : sc_workspace_set_hooks(*workspace, tool_hooks());
}
