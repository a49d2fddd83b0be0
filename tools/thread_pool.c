/*
 * Threads for the library's tasks; see thread_pool.h.
 *
 * SPDX-License-Identifier: MIT
 *
 * A job is published by raising `round`; parts are taken by counting `next` up. Both are atomic (of gcc and clang,
 * as C99 has nothing of the kind), so that neither a new job nor a part takes a lock while threads are awake. A
 * thread has looked at every round before the next one begins: so none ever sees half a job.
 */
#define _POSIX_C_SOURCE 200809L

#include "thread_pool.h"

#include <pthread.h>
#include <stdbool.h>
#include <stdlib.h>

/* How often a thread looks for a job before it sleeps: about 20 microseconds. */
enum { LOOKS = 2000 };

typedef struct pool_member {
    thread_pool *pool;
    uint32_t worker;
    pthread_t thread;
} pool_member;

struct thread_pool {
    sc_tasks tasks;
    void (*run)(void *context, uint32_t part, uint32_t worker);
    void *context;
    uint32_t count; /* parts */
    uint32_t next;  /* the part to be taken next */
    uint32_t round; /* number of the job */
    uint32_t busy;  /* threads that are not done with it */
    bool quit;
    pthread_mutex_t mutex; /* of those that sleep */
    pthread_cond_t begin, end;
    uint32_t member_count;
    pool_member *members;
};

static void pause_briefly(void)
{
#if defined(__x86_64__) || defined(__i386__)
    __builtin_ia32_pause();
#endif
}

static void take_parts(thread_pool *pool, uint32_t worker)
{
    for (;;) {
        const uint32_t part = __atomic_fetch_add(&pool->next, 1, __ATOMIC_RELAXED);
        if (part >= pool->count) return;
        pool->run(pool->context, part, worker);
    }
}

/* Waits for a round that was not seen. */
static uint32_t wait_for_round(thread_pool *pool, uint32_t seen)
{
    for (int i = 0; i < LOOKS; i++) {
        const uint32_t round = __atomic_load_n(&pool->round, __ATOMIC_ACQUIRE);
        if (round != seen) return round;
        pause_briefly();
    }
    pthread_mutex_lock(&pool->mutex);
    while (__atomic_load_n(&pool->round, __ATOMIC_ACQUIRE) == seen)
        pthread_cond_wait(&pool->begin, &pool->mutex);
    pthread_mutex_unlock(&pool->mutex);
    return seen + 1;
}

static void *member_main(void *argument)
{
    const pool_member *self = (const pool_member *)argument;
    thread_pool *pool = self->pool;
    uint32_t seen = 0;
    for (;;) {
        seen = wait_for_round(pool, seen);
        if (pool->quit) return NULL;
        take_parts(pool, self->worker);
        if (__atomic_sub_fetch(&pool->busy, 1, __ATOMIC_ACQ_REL) == 0) {
            pthread_mutex_lock(&pool->mutex);
            pthread_cond_signal(&pool->end);
            pthread_mutex_unlock(&pool->mutex);
        }
    }
}

static void begin_round(thread_pool *pool)
{
    __atomic_store_n(&pool->busy, pool->member_count, __ATOMIC_RELAXED);
    pthread_mutex_lock(&pool->mutex);
    __atomic_store_n(&pool->round, pool->round + 1, __ATOMIC_RELEASE);
    pthread_cond_broadcast(&pool->begin);
    pthread_mutex_unlock(&pool->mutex);
}

static void *enqueue(void *user, void (*run)(void *context, uint32_t part, uint32_t worker),
                     void *context, uint32_t count)
{
    thread_pool *pool = (thread_pool *)user;
    pool->run = run;
    pool->context = context;
    pool->count = count;
    __atomic_store_n(&pool->next, 0, __ATOMIC_RELAXED);
    begin_round(pool);
    return NULL;
}

static void finish(void *user, void *task)
{
    thread_pool *pool = (thread_pool *)user;
    (void)task;
    take_parts(pool, 0);
    for (int i = 0; i < LOOKS; i++) {
        if (__atomic_load_n(&pool->busy, __ATOMIC_ACQUIRE) == 0) return;
        pause_briefly();
    }
    pthread_mutex_lock(&pool->mutex);
    while (__atomic_load_n(&pool->busy, __ATOMIC_ACQUIRE) != 0)
        pthread_cond_wait(&pool->end, &pool->mutex);
    pthread_mutex_unlock(&pool->mutex);
}

thread_pool *thread_pool_create(uint32_t workers)
{
    thread_pool *pool = (thread_pool *)calloc(1, sizeof *pool);
    if (!pool) return NULL;
    pool->tasks.struct_size = sizeof pool->tasks;
    pool->tasks.workers = workers;
    pool->tasks.enqueue = enqueue;
    pool->tasks.finish = finish;
    pool->tasks.user = pool;
    pthread_mutex_init(&pool->mutex, NULL);
    pthread_cond_init(&pool->begin, NULL);
    pthread_cond_init(&pool->end, NULL);
    pool->members = (pool_member *)calloc(workers, sizeof *pool->members);
    while (pool->members && pool->member_count + 1 < workers) {
        pool_member *member = &pool->members[pool->member_count];
        member->pool = pool;
        member->worker = pool->member_count + 1;
        if (pthread_create(&member->thread, NULL, member_main, member) != 0) break;
        pool->member_count++;
    }
    if (pool->members && pool->member_count + 1 == workers) return pool;
    thread_pool_free(pool);
    return NULL;
}

void thread_pool_free(thread_pool *pool)
{
    if (!pool) return;
    pool->quit = true;
    begin_round(pool);
    for (uint32_t i = 0; i < pool->member_count; i++) pthread_join(pool->members[i].thread, NULL);
    pthread_cond_destroy(&pool->begin);
    pthread_cond_destroy(&pool->end);
    pthread_mutex_destroy(&pool->mutex);
    free(pool->members);
    free(pool);
}

const sc_tasks *thread_pool_tasks(const thread_pool *pool)
{
    return pool ? &pool->tasks : NULL;
}
