/*
 * Threads for the library's tasks; see thread_pool.h.
 *
 * SPDX-License-Identifier: MIT
 *
 * `ticket` says how many parts of the job at hand nobody has taken; a part is taken by counting it
 * down by one, which fails if it is no longer what it was. It holds the number of the job as well:
 * so a thread that is late neither takes what is not there nor holds up anybody, as the calling
 * thread takes parts until none is left, and then waits only for those that others are at. What the
 * job is, is read once a part is taken: until that is done, it does not change. All this is atomic
 * (of gcc and clang, as C99 has nothing of the kind), so that there are locks only for threads that
 * sleep.
 */
#define _POSIX_C_SOURCE 200809L

#include "thread_pool.h"

#include <pthread.h>
#include <stdbool.h>
#include <stdlib.h>

/* How often a thread looks for a job, or for the end of one, before it sleeps: about 100
   microseconds, in which a query goes from one job to the next. To wake a thread costs the calling
   one 11 to 16, and takes 30. */
enum { LOOKS = 10000 };

typedef struct pool_member {
    thread_pool *pool;
    uint32_t worker;
    pthread_t thread;
} pool_member;

struct thread_pool {
    sc_tasks tasks;
    void (*run)(void *context, uint32_t part, uint32_t worker);
    void *context;
    uint32_t count;    /* parts */
    uint64_t ticket;   /* number of the job << 32 | parts that are not taken */
    uint32_t done;     /* parts that are */
    uint32_t sleeping; /* threads that wait for a job in their sleep */
    uint32_t waiting;  /* 1 if the calling thread waits for the end of one in its */
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

static uint32_t parts_left(const thread_pool *pool)
{
    return (uint32_t)__atomic_load_n(&pool->ticket, __ATOMIC_SEQ_CST);
}

static bool is_done(const thread_pool *pool)
{
    return __atomic_load_n(&pool->done, __ATOMIC_SEQ_CST) == pool->count;
}

/* Does parts until none is left. */
static void take_parts(thread_pool *pool, uint32_t worker)
{
    uint64_t ticket = __atomic_load_n(&pool->ticket, __ATOMIC_ACQUIRE);
    uint32_t taken = 0;
    while ((uint32_t)ticket != 0) {
        if (!__atomic_compare_exchange_n(&pool->ticket, &ticket, ticket - 1, false,
                                         __ATOMIC_ACQ_REL, __ATOMIC_ACQUIRE))
            continue;
        pool->run(pool->context, pool->count - (uint32_t)ticket, worker);
        taken++;
        ticket--;
    }
    if (taken == 0) return;
    __atomic_add_fetch(&pool->done, taken, __ATOMIC_SEQ_CST);
    if (worker != 0 && __atomic_load_n(&pool->waiting, __ATOMIC_SEQ_CST) != 0) {
        pthread_mutex_lock(&pool->mutex);
        pthread_cond_signal(&pool->end);
        pthread_mutex_unlock(&pool->mutex);
    }
}

/* Waits for a job, or less: if it was done while the thread woke up, the next one follows soon.
   False: the pool ends. */
static bool wait_for_job(thread_pool *pool)
{
    for (int i = 0; i < LOOKS; i++) {
        if (parts_left(pool) != 0) return true;
        pause_briefly();
    }
    pthread_mutex_lock(&pool->mutex);
    __atomic_add_fetch(&pool->sleeping, 1, __ATOMIC_SEQ_CST);
    if (parts_left(pool) == 0 && !pool->quit) pthread_cond_wait(&pool->begin, &pool->mutex);
    __atomic_sub_fetch(&pool->sleeping, 1, __ATOMIC_SEQ_CST);
    const bool goes_on = !pool->quit;
    pthread_mutex_unlock(&pool->mutex);
    return goes_on;
}

static void *member_main(void *argument)
{
    const pool_member *self = (const pool_member *)argument;
    while (wait_for_job(self->pool)) take_parts(self->pool, self->worker);
    return NULL;
}

static void *enqueue(void *user, void (*run)(void *context, uint32_t part, uint32_t worker),
                     void *context, uint32_t count)
{
    thread_pool *pool = (thread_pool *)user;
    const uint64_t job = (pool->ticket >> 32) + 1;
    pool->run = run;
    pool->context = context;
    pool->count = count;
    __atomic_store_n(&pool->done, 0, __ATOMIC_RELAXED);
    __atomic_store_n(&pool->ticket, job << 32 | count, __ATOMIC_SEQ_CST);
    if (__atomic_load_n(&pool->sleeping, __ATOMIC_SEQ_CST) != 0) {
        pthread_mutex_lock(&pool->mutex); /* who counts as sleeping does, or will see the job */
        pthread_mutex_unlock(&pool->mutex);
        pthread_cond_broadcast(&pool->begin);
    }
    return NULL;
}

static void finish(void *user, void *task)
{
    thread_pool *pool = (thread_pool *)user;
    (void)task;
    take_parts(pool, 0);
    for (int i = 0; i < LOOKS; i++) {
        if (is_done(pool)) return;
        pause_briefly();
    }
    pthread_mutex_lock(&pool->mutex);
    __atomic_store_n(&pool->waiting, 1, __ATOMIC_SEQ_CST);
    while (!is_done(pool)) pthread_cond_wait(&pool->end, &pool->mutex);
    __atomic_store_n(&pool->waiting, 0, __ATOMIC_SEQ_CST);
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
    pthread_mutex_lock(&pool->mutex);
    pool->quit = true;
    pthread_cond_broadcast(&pool->begin);
    pthread_mutex_unlock(&pool->mutex);
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
