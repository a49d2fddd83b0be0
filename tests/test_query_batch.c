/*
 * Many poses of one model in one call: each answer is that of a query by itself, whoever asks it
 * and whatever is wrong with others.
 *
 * SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "harness.h"
#include "soups.h"
#include "starcontour.h"
#include "tasks.h"

enum { POSES = 12, WORKERS = 3 };

/* Poses of one mesh, and room for what is found. */
typedef struct batch {
    fixture f;
    double *positions[POSES];
    sc_pose poses[POSES];
    sc_result results[POSES];
    sc_pair *pairs[POSES];
    sc_status statuses[POSES];
    sc_workspace *workspaces[WORKERS];
} batch;

static int open_batch(batch *b)
{
    const sc_workspace_options one = options_for_workers(1);
    soup mesh = soup_cloth(14, 14);
    memset(b, 0, sizeof *b);
    if (!fixture_start_plain(&b->f, mesh)) return 0;
    for (int i = 0; i < WORKERS; ++i)
        if (!CHECK(sc_workspace_create_for(b->f.model, &one, &b->workspaces[i]) == SC_OK)) return 0;
    for (int i = 0; i < POSES; ++i) {
        b->positions[i] = soup_copy_positions(&b->f.mesh);
        soup_any_pose(b->positions[i], b->f.mesh.vertex_count);
        b->poses[i] = b->f.pose;
        b->poses[i].position_type = SC_DOUBLE;
        b->poses[i].position_stride = 0;
        b->poses[i].positions = b->positions[i];
    }
    return 1;
}

/* Arrays of any length, often too short. */
static void make_room(batch *b)
{
    for (int i = 0; i < POSES; ++i) {
        sc_result *r = &b->results[i];
        memset(r, 0, sizeof *r);
        r->struct_size = sizeof *r;
        r->capacity = test_random_below(4) ? 20000 : test_random_below(30);
        free(b->pairs[i]);
        r->pairs = b->pairs[i] = (sc_pair *)test_allocate(sizeof(sc_pair) * r->capacity);
    }
}

static void close_batch(batch *b)
{
    for (int i = 0; i < POSES; ++i) {
        free(b->positions[i]);
        free(b->pairs[i]);
    }
    for (int i = 0; i < WORKERS; ++i) sc_workspace_free(b->workspaces[i]);
    fixture_stop(&b->f);
}

/* Each answer beside that of sc_query. Returns the first status that is not SC_OK. */
static sc_status check_each(batch *b, const sc_query_options *options)
{
    sc_query_options o = *options;
    sc_status first = SC_OK;
    o.tasks = NULL;
    for (int i = 0; i < POSES; ++i) {
        const sc_result *r = &b->results[i];
        sc_result alone = *r;
        sc_status status;
        alone.pairs = (sc_pair *)test_allocate(sizeof(sc_pair) * r->capacity);
        status = sc_query(b->f.model, b->f.workspace, &b->poses[i], &o, &alone);
        CHECK_MSG(status == b->statuses[i] && alone.count == r->count &&
                      alone.verdict == r->verdict && alone.collides == r->collides,
                  "pose %d: %s, %llu pairs", i, sc_status_string(b->statuses[i]),
                  (unsigned long long)r->count);
        if (status == SC_OK || status == SC_ERROR_SHORT_BUFFER)
            CHECK(!memcmp(alone.pairs, r->pairs,
                          sizeof(sc_pair) * (r->count < r->capacity ? r->count : r->capacity)));
        free(alone.pairs);
        if (!first) first = status;
    }
    return first;
}

static void each_is_a_query(void)
{
    batch b;
    if (!open_batch(&b)) return;
    for (int way = HOST_FIRST; way < HOST_COUNT; ++way)
        for (uint32_t workers = 1; workers <= WORKERS; ++workers) {
            sc_query_options o = no_options();
            sc_status status;
            host h;
            if (workers == WORKERS) b.positions[7][100] = (double)NAN;
            make_room(&b);
            host_start(&h, way, workers);
            if (workers > 1) o.tasks = &h.tasks;
            status =
                sc_query_batch(b.f.model, b.workspaces, b.poses, POSES, &o, b.results, b.statuses);
            CHECK(status == check_each(&b, &o));
            if (workers == WORKERS) CHECK(b.statuses[7] == SC_ERROR_NOT_FINITE);
            CHECK(h.mistakes == 0 && (workers == 1 || (h.jobs == 1 && h.parts == POSES)));
            host_stop(&h);
            b.positions[7][100] = 0.25;
        }
    close_batch(&b);
}

/* With room for all pairs each query does, and so does the batch; a batch of the first ones says
   nothing of what is behind them. */
static void all_are_answered(void)
{
    sc_query_options o = no_options();
    uint64_t all;
    batch b;
    if (!open_batch(&b)) return;
    all = (uint64_t)b.f.mesh.triangle_count * b.f.mesh.triangle_count / 2;
    make_room(&b);
    for (int i = 0; i < POSES; ++i) {
        free(b.pairs[i]);
        b.results[i].capacity = all;
        b.results[i].pairs = b.pairs[i] = (sc_pair *)test_allocate(sizeof(sc_pair) * all);
    }
    CHECK(sc_query_batch(b.f.model, b.workspaces, b.poses, POSES, &o, b.results, b.statuses) ==
          SC_OK);
    CHECK(check_each(&b, &o) == SC_OK);
    b.positions[POSES - 1][0] = (double)NAN;
    CHECK(sc_query_batch(b.f.model, b.workspaces, b.poses, POSES - 1, &o, b.results, b.statuses) ==
          SC_OK);
    CHECK(b.statuses[POSES - 1] == SC_OK);
    CHECK(sc_query_batch(b.f.model, b.workspaces, b.poses, POSES, &o, b.results, b.statuses) ==
          SC_ERROR_NOT_FINITE);
    CHECK(check_each(&b, &o) == SC_ERROR_NOT_FINITE);
    close_batch(&b);
}

/* The flag ends all of it. */
static void a_flag_ends_it(void)
{
    static const volatile uint32_t set = 1;
    sc_query_options o = no_options();
    batch b;
    if (!open_batch(&b)) return;
    make_room(&b);
    o.cancel = &set;
    CHECK(sc_query_batch(b.f.model, b.workspaces, b.poses, POSES, &o, b.results, b.statuses) ==
          SC_ERROR_INCOMPLETE);
    for (int i = 0; i < POSES; ++i)
        CHECK(b.statuses[i] == SC_ERROR_INCOMPLETE && b.results[i].count == 0);
    close_batch(&b);
}

static void wrong_arguments(void)
{
    sc_query_options o = no_options();
    sc_workspace *same[2];
    sc_tasks tasks;
    batch b;
    if (!open_batch(&b)) return;
    make_room(&b);
    CHECK(sc_query_batch(NULL, b.workspaces, b.poses, 1, &o, b.results, b.statuses) ==
          SC_ERROR_NULL);
    CHECK(sc_query_batch(b.f.model, NULL, b.poses, 1, &o, b.results, b.statuses) == SC_ERROR_NULL);
    CHECK(sc_query_batch(b.f.model, b.workspaces, NULL, 1, &o, b.results, b.statuses) ==
          SC_ERROR_NULL);
    CHECK(sc_query_batch(b.f.model, b.workspaces, b.poses, 1, &o, NULL, b.statuses) ==
          SC_ERROR_NULL);
    CHECK(sc_query_batch(b.f.model, b.workspaces, b.poses, 1, &o, b.results, NULL) ==
          SC_ERROR_NULL);
    CHECK(sc_query_batch(b.f.model, b.workspaces, NULL, 0, NULL, NULL, NULL) == SC_OK);
    memset(&tasks, 0, sizeof tasks);
    tasks.struct_size = sizeof tasks;
    tasks.workers = 2;
    o.tasks = &tasks;
    CHECK(sc_query_batch(b.f.model, b.workspaces, b.poses, 1, &o, b.results, b.statuses) ==
          SC_ERROR_NULL);
    o.tasks = NULL;
    {
        host h;
        same[0] = same[1] = b.workspaces[0];
        host_start(&h, HOST_AT_ONCE, 2);
        o.tasks = &h.tasks;
        CHECK(sc_query_batch(b.f.model, same, b.poses, 1, &o, b.results, b.statuses) ==
              SC_ERROR_WORKSPACE);
        same[1] = NULL;
        CHECK(sc_query_batch(b.f.model, same, b.poses, 1, &o, b.results, b.statuses) ==
              SC_ERROR_NULL);
        h.tasks.workers = SC_WORKERS_MAX + 1;
        CHECK(sc_query_batch(b.f.model, same, b.poses, 1, &o, b.results, b.statuses) ==
              SC_ERROR_WORKSPACE);
        CHECK(h.jobs == 0);
        host_stop(&h);
    }
    o = no_options();
    o.output = 77;
    CHECK(sc_query_batch(b.f.model, b.workspaces, b.poses, 1, &o, b.results, b.statuses) ==
          SC_ERROR_OPTION);
    o.output = 0;
    b.poses[0].struct_size = 12;
    CHECK(sc_query_batch(b.f.model, b.workspaces, b.poses, 1, &o, b.results, b.statuses) ==
          SC_ERROR_STRUCT_SIZE);
    b.poses[0].struct_size = sizeof(sc_pose) + 4; /* the next one's pointers would lie between */
    CHECK(sc_query_batch(b.f.model, b.workspaces, b.poses, 1, &o, b.results, b.statuses) ==
          SC_ERROR_STRUCT_SIZE);
    b.poses[0].struct_size = sizeof(sc_pose);
    b.results[0].struct_size = 4;
    CHECK(sc_query_batch(b.f.model, b.workspaces, b.poses, 1, &o, b.results, b.statuses) ==
          SC_ERROR_STRUCT_SIZE);
    b.results[0].struct_size = sizeof(sc_result) + 4;
    CHECK(sc_query_batch(b.f.model, b.workspaces, b.poses, 1, &o, b.results, b.statuses) ==
          SC_ERROR_STRUCT_SIZE);
    close_batch(&b);
}

SC_TEST_MAIN(SC_TEST(each_is_a_query), SC_TEST(all_are_answered), SC_TEST(a_flag_ends_it),
             SC_TEST(wrong_arguments))
