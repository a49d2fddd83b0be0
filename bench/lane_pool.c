/*
 * Threads that wait for work; see lane_pool.h.
 *
 * SPDX-License-Identifier: MIT
 */
#define _POSIX_C_SOURCE 200809L

#include "lane_pool.h"

#include "tool.h"

#include <pthread.h>
#include <stdlib.h>

typedef struct pool_thread {
    lane_pool *pool;
    uint32_t lane;
    pthread_t thread;
} pool_thread;

struct lane_pool {
    pthread_mutex_t mutex;
    pthread_cond_t begin, end;
    uint64_t round;   /* number of the present work */
    uint32_t waiting; /* threads that are not done with it */
    uint32_t active;  /* lanes that have work */
    bool quit;
    void (*work)(void *user, uint32_t lane);
    void *user;
    uint32_t count;
    pool_thread *threads; /* count */
};

static void *run_thread(void *argument)
{
    const pool_thread *self = (const pool_thread *)argument;
    lane_pool *pool = self->pool;
    uint64_t seen = 0;
    pthread_mutex_lock(&pool->mutex);
    for (;;) {
        while (pool->round == seen && !pool->quit) pthread_cond_wait(&pool->begin, &pool->mutex);
        if (pool->quit) break;
        seen = pool->round;
        const bool has_work = self->lane < pool->active;
        pthread_mutex_unlock(&pool->mutex);
        if (has_work) pool->work(pool->user, self->lane);
        pthread_mutex_lock(&pool->mutex);
        if (--pool->waiting == 0) pthread_cond_signal(&pool->end);
    }
    pthread_mutex_unlock(&pool->mutex);
    return NULL;
}

lane_pool *lane_pool_create(uint32_t count)
{
    lane_pool *pool = (lane_pool *)calloc(1, sizeof *pool);
    if (!pool) return NULL;
    pthread_mutex_init(&pool->mutex, NULL);
    pthread_cond_init(&pool->begin, NULL);
    pthread_cond_init(&pool->end, NULL);
    pool->threads = (pool_thread *)calloc(count, sizeof *pool->threads);
    while (pool->threads && pool->count < count) {
        pool_thread *thread = &pool->threads[pool->count];
        thread->pool = pool;
        thread->lane = pool->count;
        if (pthread_create(&thread->thread, NULL, run_thread, thread) != 0) break;
        pool->count++;
    }
    if (pool->count == count) return pool;
    lane_pool_free(pool);
    return NULL;
}

void lane_pool_free(lane_pool *pool)
{
    if (!pool) return;
    pthread_mutex_lock(&pool->mutex);
    pool->quit = true;
    pthread_cond_broadcast(&pool->begin);
    pthread_mutex_unlock(&pool->mutex);
    for (uint32_t i = 0; i < pool->count; i++) pthread_join(pool->threads[i].thread, NULL);
    pthread_cond_destroy(&pool->begin);
    pthread_cond_destroy(&pool->end);
    pthread_mutex_destroy(&pool->mutex);
    free(pool->threads);
    free(pool);
}

double lane_pool_run(lane_pool *pool, uint32_t count, void (*work)(void *user, uint32_t lane),
                     void *user)
{
    pthread_mutex_lock(&pool->mutex);
    pool->work = work;
    pool->user = user;
    pool->active = count;
    pool->waiting = pool->count;
    pool->round++;
    const double start = tool_clock();
    pthread_cond_broadcast(&pool->begin);
    while (pool->waiting > 0) pthread_cond_wait(&pool->end, &pool->mutex);
    const double milliseconds = tool_clock() - start;
    pthread_mutex_unlock(&pool->mutex);
    return milliseconds;
}
