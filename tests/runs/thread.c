/*
 * Threads: many at once query one model, each on a workspace of its own, and build models of their
 * own; the answers must be those of one thread alone. Meant for ThreadSanitizer (`make
 * test-thread`), which reports any write to what is shared. Exit status 1 if an answer differs.
 *
 * SPDX-License-Identifier: MIT
 */
#include <inttypes.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "harness.h"
#include "inputs.h"
#include "starcontour.h"

enum { THREADS = 8, POSES = 12, ROUNDS = 3, CAPACITY = 1 << 14 };

typedef struct answer {
    sc_status status;
    sc_pair *pairs;
    uint64_t count;
} answer;

static soup rest;
static sc_model *model; /* shared */
static uint32_t cancel; /* shared: all queries read it, all threads write it; stays 0 */
static double *poses[POSES];
static answer answers[POSES][4];

/* One query: pairs and contact by kind, the method by round. */
static answer ask(const sc_model *m, sc_workspace *workspace, uint32_t pose, uint32_t kind,
                  uint32_t round, sc_pair *pairs)
{
    sc_pose p = input_plain_pose(poses[pose], rest.vertex_count);
    sc_query_options o;
    sc_result r;
    answer a;
    memset(&o, 0, sizeof(o));
    o.struct_size = sizeof(o);
    o.pairs = kind / 2;
    o.contact = kind % 2;
    o.method = round % 4;
    o.cancel = &cancel;
    __atomic_store_n(&cancel, 0, __ATOMIC_RELAXED);
    memset(&r, 0, sizeof(r));
    r.struct_size = sizeof(r);
    r.capacity = CAPACITY;
    r.pairs = pairs;
    a.status = sc_query(m, workspace, &p, &o, &r);
    a.pairs = pairs;
    a.count = r.count;
    return a;
}

/* Returns NULL, or what went wrong. */
static void *work(void *argument)
{
    uint32_t thread = *(const uint32_t *)argument;
    sc_pair *pairs = (sc_pair *)malloc(CAPACITY * sizeof(sc_pair));
    sc_mesh mesh = input_plain_mesh(&rest);
    sc_workspace *workspace, *own_workspace;
    sc_model *own;
    char *wrong = NULL;
    static char no_workspace[] = "no workspace", different[] = "a different answer";
    if (pairs == NULL || sc_workspace_create(model, NULL, &workspace) != SC_OK ||
        sc_build(&mesh, NULL, &own) != SC_OK ||
        sc_workspace_create(own, NULL, &own_workspace) != SC_OK)
        return no_workspace;
    for (uint32_t i = 0; i < ROUNDS * POSES * 4; ++i) {
        uint32_t pose = (i + thread) % POSES, kind = i / POSES % 4, is_own = i % 5 == 0;
        const answer *expected = &answers[pose][kind];
        answer a = ask(is_own ? own : model, is_own ? own_workspace : workspace, pose, kind,
                       thread + i, pairs);
        if (a.status != expected->status || a.count != expected->count ||
            memcmp(pairs, expected->pairs, (size_t)a.count * sizeof(sc_pair)) != 0)
            wrong = different;
    }
    sc_workspace_free(own_workspace);
    sc_model_free(own);
    sc_workspace_free(workspace);
    free(pairs);
    return wrong;
}

int main(void)
{
    pthread_t threads[THREADS];
    uint32_t numbers[THREADS];
    uint64_t pairs = 0;
    int failed = 0;
    sc_workspace *workspace;
    sc_mesh mesh;
    rest = soup_cloth(16, 16);
    mesh = input_plain_mesh(&rest);
    if (sc_build(&mesh, NULL, &model) != SC_OK ||
        sc_workspace_create(model, NULL, &workspace) != SC_OK)
        return 2;
    for (uint32_t p = 0; p < POSES; ++p) {
        size_t size = 3 * (size_t)rest.vertex_count * sizeof(double);
        poses[p] = (double *)test_allocate(size);
        memcpy(poses[p], rest.positions, size);
        test_random_reset(p);
        soup_smooth(poses[p], rest.vertex_count, 0.03 * p);
        if (p % 3 == 0) soup_fold(poses[p], rest.vertex_count);
        for (uint32_t kind = 0; kind < 4; ++kind) {
            sc_pair *list = (sc_pair *)test_allocate(CAPACITY * sizeof(sc_pair));
            answers[p][kind] = ask(model, workspace, p, kind, 0, list);
            pairs += answers[p][kind].count;
            if (answers[p][kind].status != SC_OK) {
                printf("thread: %s\n", sc_status_string(answers[p][kind].status));
                return 2;
            }
        }
    }
    sc_workspace_free(workspace);
    for (uint32_t t = 0; t < THREADS; ++t) {
        numbers[t] = t;
        if (pthread_create(&threads[t], NULL, work, &numbers[t]) != 0) return 2;
    }
    for (uint32_t t = 0; t < THREADS; ++t) {
        void *wrong;
        pthread_join(threads[t], &wrong);
        if (wrong == NULL) continue;
        printf("thread: %" PRIu32 " found %s\n", t, (const char *)wrong);
        failed = 1;
    }
    for (uint32_t p = 0; p < POSES; ++p) {
        for (uint32_t kind = 0; kind < 4; ++kind) free(answers[p][kind].pairs);
        free(poses[p]);
    }
    sc_model_free(model);
    soup_free(&rest);
    printf("thread: %d threads, %d queries each, %" PRIu64 " pairs in all poses: %s\n",
           (int)THREADS, ROUNDS * POSES * 4, pairs, failed ? "answers differ" : "the same answers");
    return failed;
}
