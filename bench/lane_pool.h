/*
 * Threads that wait for work and do it all at the same moment.
 *
 * SPDX-License-Identifier: MIT
 *
 * For measuring throughput: starting threads would cost more than what they are to do.
 */
#ifndef BENCH_LANE_POOL_H
#define BENCH_LANE_POOL_H

#include <stdint.h>

typedef struct lane_pool lane_pool;

/* Starts count threads, 1 or more; NULL if that fails. */
lane_pool *lane_pool_create(uint32_t count);

/* Ends them. NULL is allowed. */
void lane_pool_free(lane_pool *pool);

/*
 * Calls work(user, 0) to work(user, count - 1), each on a thread of its own; count is at most that
 * of create. Returns how long it took until the last was done, in milliseconds.
 */
double lane_pool_run(lane_pool *pool, uint32_t count, void (*work)(void *user, uint32_t lane),
                     void *user);

#endif /* BENCH_LANE_POOL_H */
