/*
 * Hosts that run the parts of a query in several ways and look at how they are called, and the
 * queries that they are asked. For test_tasks.c and test_task_steps.c.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef TESTS_TASKS_H
#define TESTS_TASKS_H

#include <pthread.h>
#include <stdint.h>

#include "soups.h"
#include "starcontour.h"

/* ---- hosts ---- */

/*
 * At once: each part when it is handed over, by worker 0. Forwards and backwards: when the query
 * waits for them, from the first to the last or the other way round, each by a random worker.
 * Threads: each worker is a thread, THREADS_MAX at most, and takes the next part as soon as it
 * can.
 */
enum { HOST_AT_ONCE, HOST_FORWARDS, HOST_BACKWARDS, HOST_THREADS, HOST_COUNT };

/* Under ThreadSanitizer all have threads: it can find nothing where one does all. */
#ifdef __SANITIZE_THREAD__
enum { HOST_FIRST = HOST_THREADS };
#else
enum { HOST_FIRST = HOST_AT_ONCE };
#endif

enum { THREADS_MAX = 8 };

typedef struct host_worker host_worker;

typedef struct host {
    sc_tasks tasks;
    int way;
    void (*run)(void *context, uint32_t part, uint32_t worker);
    void *context;
    uint32_t count, next;
    uint64_t jobs, parts;
    int is_busy; /* between enqueue and finish */
    int mistakes;
    pthread_mutex_t mutex; /* of next */
    pthread_t threads[THREADS_MAX];
    host_worker *workers; /* THREADS_MAX */
} host;

void host_start(host *h, int way, uint32_t workers);
void host_stop(host *h);

/* A host that sets the flag before some part, and hands parts to all workers in turn. */
typedef struct breaker {
    sc_tasks tasks;
    volatile uint32_t flag;
    uint32_t left; /* parts until then */
} breaker;

void breaker_start(breaker *b, uint32_t workers, uint32_t left);

/* Whether a trial with this number is left out, as --scale asks for fewer: each scene has others,
   so that a tenth of them has every method. */
int trial_is_left_out(int scene, uint32_t number);

/* ---- what is asked ---- */

/* A mesh, its model, and a pose that is made of its positions. */
typedef struct fixture {
    soup mesh;
    double *posed;
    sc_model *model;
    sc_workspace *workspace; /* for one worker */
    sc_pose pose;
} fixture;

/* Takes the mesh over. The pose is the mesh as it is, or smoothed, folded if it turns more than
   once, twisted and with noise. Returns 0 and counts a failure if there is no model. */
int fixture_start_plain(fixture *f, soup mesh);
int fixture_start(fixture *f, soup mesh, double turns, double noise);

/* By a tree: leaves of one triangle, balanced; but of the first triangles of each part, if so many
   are chained, each of so many nodes loses one. */
int fixture_start_tree(fixture *f, soup mesh, uint32_t parts, uint32_t chained, uint32_t length);

void fixture_stop(fixture *f);

sc_workspace_options options_for_workers(uint32_t workers);
sc_query_options no_options(void);

/* What a query says. */
typedef struct answer {
    sc_status status;
    sc_result result;
    sc_stats stats;
    sc_pair *pairs; /* the caller frees them */
} answer;

answer fixture_ask(const fixture *f, sc_workspace *workspace, const sc_query_options *options,
                   uint64_t capacity);
answer fixture_ask_with(const fixture *f, sc_workspace *workspace, const sc_query_options *options,
                        uint64_t capacity, int has_stats);

/* Whether two queries counted the same; the second one leaves out box tests, as how large patches
   are divided is another matter with several threads. */
int answer_counts_same(const answer *a, const answer *b);
int answer_other_counts_same(const answer *a, const answer *b);

/* Whether two answers are the same; frees b's pairs. */
int answer_is_same(const answer *a, answer b);

/* Whether a pair is in a sorted list. */
int pair_is_among(sc_pair pair, const sc_pair *pairs, uint64_t count);

#endif
