/*
 * Threads for the library's tasks (sc_tasks): a pool that runs the parts of one job at a time.
 *
 * SPDX-License-Identifier: MIT
 *
 * The thread that calls the library works as well: a pool of n workers starts n - 1 threads. A
 * thread that has nothing to do looks out for the next job for about 100 microseconds, for jobs of
 * a query follow each other closely, and then sleeps. A job is done as soon as its parts are,
 * whether or not all threads woke up for it.
 */
#ifndef TOOLS_THREAD_POOL_H
#define TOOLS_THREAD_POOL_H

#include "starcontour.h"

typedef struct thread_pool thread_pool;

/* Starts a pool for so many workers, 1 to SC_WORKERS_MAX; NULL if that fails. */
thread_pool *thread_pool_create(uint32_t workers);

/* Ends its threads. NULL is allowed. */
void thread_pool_free(thread_pool *pool);

/* What to put into sc_query_options.tasks; NULL for no pool. */
const sc_tasks *thread_pool_tasks(const thread_pool *pool);

#endif /* TOOLS_THREAD_POOL_H */
