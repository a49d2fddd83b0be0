/*
 * The host's tasks: workspaces for several workers, what is refused, and that answers are those of
 * one thread, whoever runs the parts of a query and in whatever order. Steps: test_task_steps.c.
 *
 * SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "harness.h"
#include "inputs.h"
#include "run/workspace.h"
#include "shapes.h"
#include "soups.h"
#include "starcontour.h"
#include "tasks.h"

static void workspaces_for_workers(void)
{
    fixture f;
    if (fixture_start(&f, soup_cloth(12, 12), 0.5, 0.1)) {
        sc_query_options options = no_options();
        answer expected = fixture_ask(&f, f.workspace, &options, 5000);
        uint64_t plain = 0, size = 0, previous = 0;
        CHECK(sc_workspace_size(f.model, &plain) == SC_OK);
        CHECK(sc_workspace_size_for(f.model, NULL, &size) == SC_OK && size == plain);
        for (uint32_t flags = 0; flags <= SC_WORKSPACE_STEP; ++flags)
            for (uint32_t workers = 0; workers < 5; ++workers) {
                sc_workspace_options o = options_for_workers(workers);
                sc_workspace *workspace = f.workspace;
                unsigned char *memory, *aligned;
                o.flags = flags;
                CHECK(sc_workspace_size_for(f.model, &o, &size) == SC_OK);
                if (workers < 2 && !flags) CHECK(size == plain);
                if (workers == 1) CHECK(size == previous);
                if (workers > 1)
                    CHECK(size > previous && size < previous + plain + 200000 + 400000 * flags);
                previous = size;
                memory = (unsigned char *)test_allocate(size + 2 * SC_ALIGNMENT);
                memset(memory, 0x77, size + 2 * SC_ALIGNMENT);
                aligned = memory + (SC_ALIGNMENT - (uintptr_t)memory % SC_ALIGNMENT);
                CHECK(sc_workspace_init_for(f.model, &o, aligned, size - 1, &workspace) ==
                          SC_ERROR_WORKSPACE &&
                      workspace == NULL);
                CHECK(sc_workspace_init_for(f.model, &o, aligned + 8, size, &workspace) ==
                          SC_ERROR_ALIGNMENT &&
                      workspace == NULL);
                CHECK(sc_workspace_init_for(f.model, &o, aligned, size, &workspace) == SC_OK);
                CHECK(aligned[-1] == 0x77 && aligned[size] == 0x77);
                CHECK(answer_is_same(&expected, fixture_ask(&f, workspace, &options, 5000)));
                CHECK(aligned[-1] == 0x77 && aligned[size] == 0x77);
                sc_workspace_free(workspace); /* does nothing */
                free(memory);
                CHECK(sc_workspace_create_for(f.model, &o, &workspace) == SC_OK);
                CHECK(answer_is_same(&expected, fixture_ask(&f, workspace, &options, 5000)));
                sc_workspace_free(workspace);
            }
        free(expected.pairs);
    }
    fixture_stop(&f);
}

static void *allocate_nothing(void *user, uint64_t size, uint64_t alignment)
{
    (void)alignment;
    *(uint64_t *)user = size;
    return NULL;
}

static void release_nothing(void *user, void *memory, uint64_t size)
{
    (void)user;
    (void)memory;
    (void)size;
}

/* options that all three calls refuse */
static void check_refused(const fixture *f, const sc_workspace_options *options, sc_status expected,
                          const char *what)
{
    static uint64_t block[SC_ALIGNMENT]; /* too small, which is looked at last */
    unsigned char *memory = (unsigned char *)block;
    sc_workspace *workspace = f->workspace;
    uint64_t size = 77;
    memory += SC_ALIGNMENT - (uintptr_t)memory % SC_ALIGNMENT;
    CHECK_MSG(sc_workspace_size_for(f->model, options, &size) == expected && size == 77, "%s",
              what);
    CHECK_MSG(sc_workspace_init_for(f->model, options, memory, 64, &workspace) == expected &&
                  workspace == NULL,
              "%s", what);
    workspace = f->workspace;
    CHECK_MSG(sc_workspace_create_for(f->model, options, &workspace) == expected &&
                  workspace == NULL,
              "%s", what);
}

static void workspaces_refused(void)
{
    fixture f;
    if (fixture_start(&f, soup_cloth(4, 4), 0, 0)) {
        sc_workspace_options o = options_for_workers(2), none = options_for_workers(0);
        sc_workspace *workspace = f.workspace;
        sc_allocator allocator;
        uint64_t size = 0, asked = 0;
        CHECK(sc_workspace_size_for(NULL, &o, &size) == SC_ERROR_NULL);
        CHECK(sc_workspace_size_for(f.model, &o, NULL) == SC_ERROR_NULL);
        CHECK(sc_workspace_init_for(f.model, &o, &o, 8, NULL) == SC_ERROR_NULL);
        CHECK(sc_workspace_init_for(NULL, &o, &o, 8, &workspace) == SC_ERROR_NULL && !workspace);
        workspace = f.workspace;
        CHECK(sc_workspace_init_for(f.model, &o, NULL, 8, &workspace) == SC_ERROR_NULL &&
              !workspace);
        CHECK(sc_workspace_create_for(f.model, &o, NULL) == SC_ERROR_NULL);
        workspace = f.workspace;
        CHECK(sc_workspace_create_for(NULL, &o, &workspace) == SC_ERROR_NULL && !workspace);
        o.workers = SC_WORKERS_MAX;
        CHECK(sc_workspace_size_for(f.model, &o, &size) == SC_OK);
        o.workers = SC_WORKERS_MAX + 1;
        check_refused(&f, &o, SC_ERROR_OPTION, "too many workers");
        o.workers = 0xffffffffu;
        check_refused(&f, &o, SC_ERROR_OPTION, "far too many workers");
        for (uint32_t bit = 3; bit < 32; ++bit) {
            o = none;
            o.flags = 1u << bit;
            check_refused(&f, &o, SC_ERROR_OPTION, "an unknown flag");
        }
        o = none;
        o.reserved = 1;
        check_refused(&f, &o, SC_ERROR_OPTION, "reserved");
        for (uint32_t s = 0; s < sizeof(o); ++s) {
            o = none;
            o.struct_size = s;
            if (s < 8 || s % sizeof(void *) != 0)
                check_refused(&f, &o, SC_ERROR_STRUCT_SIZE, "struct_size");
            else
                CHECK(sc_workspace_size_for(f.model, &o, &size) == SC_OK);
        }
        memset(&allocator, 0, sizeof(allocator));
        o = options_for_workers(3);
        o.allocator = &allocator;
        workspace = f.workspace;
        CHECK(sc_workspace_create_for(f.model, &o, &workspace) == SC_ERROR_NULL && !workspace);
        allocator.allocate = allocate_nothing;
        allocator.release = release_nothing;
        allocator.user = &asked;
        workspace = f.workspace;
        CHECK(sc_workspace_create_for(f.model, &o, &workspace) == SC_ERROR_MEMORY && !workspace);
        CHECK(sc_workspace_size_for(f.model, &o, &size) == SC_OK && size == asked);
    }
    fixture_stop(&f);
}

static void tasks_refused(void)
{
    fixture f;
    if (fixture_start(&f, soup_cloth(8, 8), 1, 0.1)) {
        sc_workspace_options for_two = options_for_workers(2);
        sc_query_options options = no_options();
        answer expected = fixture_ask(&f, f.workspace, &options, 5000);
        sc_workspace *two = NULL;
        host h;
        host_start(&h, HOST_AT_ONCE, 2);
        options.tasks = &h.tasks;
        CHECK(sc_workspace_create_for(f.model, &for_two, &two) == SC_OK);
        for (uint32_t size = 0; size < sizeof(sc_tasks); ++size) {
            sc_status status =
                size < sizeof(sc_tasks) - sizeof(void *) || size % sizeof(void *) != 0
                    ? SC_ERROR_STRUCT_SIZE
                    : SC_OK;
            answer a;
            if (status == SC_OK) continue; /* user is needed here */
            h.tasks.struct_size = size;
            a = fixture_ask(&f, two, &options, 5000);
            CHECK_MSG(a.status == status && a.result.count == 0, "size %u", (unsigned)size);
            free(a.pairs);
        }
        h.tasks.struct_size = sizeof(h.tasks);
        for (int wrong = 0; wrong < 4; ++wrong) {
            const sc_status statuses[] = {SC_ERROR_NULL, SC_ERROR_NULL, SC_ERROR_WORKSPACE,
                                          SC_ERROR_WORKSPACE};
            const sc_tasks right = h.tasks;
            answer a;
            if (wrong == 0) h.tasks.enqueue = NULL;
            if (wrong == 1) h.tasks.finish = NULL;
            if (wrong == 2) h.tasks.workers = 3;
            a = fixture_ask(&f, wrong == 3 ? f.workspace : two, &options, 5000);
            CHECK_MSG(a.status == statuses[wrong] && a.result.count == 0 &&
                          a.result.verdict == SC_VERDICT_NONE && a.pairs[0].a == 0xabababab,
                      "%d: %s", wrong, sc_status_string(a.status));
            free(a.pairs);
            h.tasks = right;
        }
        CHECK(h.jobs == 0);
        for (uint32_t workers = 0; workers < 3; ++workers) {
            h.tasks.workers = workers;
            CHECK(answer_is_same(&expected, fixture_ask(&f, two, &options, 5000)));
            if (workers < 2)
                CHECK(answer_is_same(&expected, fixture_ask(&f, f.workspace, &options, 5000)));
        }
        CHECK(h.mistakes == 0);
        free(expected.pairs);
        host_stop(&h);
        sc_workspace_free(two);
    }
    fixture_stop(&f);
}

/* Scenes large enough to be shared out, but for the last one; most in heavy contact. */
enum { SCENES = 7 };

/* Discs that go twice around, side by side; some are crumpled, so that those that wait are no round
   number. */
static soup many_branched(uint32_t count)
{
    soup all = soup_branched(24, 4);
    for (uint32_t i = 1; i < count; ++i) {
        soup one = soup_branched(24, 4), before = all;
        if (i % 3 == 0) soup_noise(one.positions, one.vertex_count, 0.3);
        for (uint32_t v = 0; v < one.vertex_count; ++v) one.positions[3 * v] += 3.0 * i;
        all = soup_join(&before, &one);
        soup_free(&one);
        soup_free(&before);
    }
    return all;
}

static int start_scene(fixture *f, int scene)
{
    soup mesh = scene == 0   ? soup_cloth(40, 40)
                : scene == 1 ? soup_sphere(40, 40)
                : scene == 2 ? soup_many(100)
                : scene == 3 ? soup_branched(80, 20) /* contours cross, all else is fine */
                : scene == 4 ? many_branched(60)     /* the same of many small patches */
                : scene == 5 ? soup_sphere(40, 40)   /* smooth: large patches pass */
                             : soup_cloth(2, 1);
    if (scene == 3 || scene == 4) return fixture_start_plain(f, mesh);
    return fixture_start(f, mesh, scene == 0 ? 4 : 0.5, scene == 1 ? 0.06 : scene == 5 ? 0 : 0.001);
}

enum { METHODS = 5, KINDS = METHODS * 2 * 2 };

/* One of the kinds of questions. */
static sc_query_options question(uint32_t kind)
{
    static const uint32_t methods[METHODS][2] = {{SC_METHOD_SCTT, SC_CONTOUR_EXACT},
                                                 {SC_METHOD_SCTT, SC_CONTOUR_STAR},
                                                 {SC_METHOD_SCTT, SC_CONTOUR_NONE},
                                                 {SC_METHOD_AABB_SCTT, 0},
                                                 {SC_METHOD_AABB, 0}};
    sc_query_options options = no_options();
    options.method = methods[kind % METHODS][0];
    options.contour = methods[kind % METHODS][1];
    options.pairs = kind / METHODS % 2;
    options.contact = kind / METHODS / 2;
    return options;
}

/* Each method, kind of pair, output and length of the array, by each host. */
static void the_same_answers(void)
{
    uint64_t jobs = 0;
    for (int scene = 0; scene < SCENES; ++scene) {
        fixture f;
        if (start_scene(&f, scene)) {
            sc_workspace_options o = options_for_workers(THREADS_MAX);
            sc_workspace *workspace = NULL;
            CHECK(sc_workspace_create_for(f.model, &o, &workspace) == SC_OK);
            for (uint32_t kind = 0; kind < KINDS; ++kind) {
                if (trial_is_left_out(scene, kind)) continue;
                sc_query_options options = question(kind);
                answer all = fixture_ask(&f, f.workspace, &options, 100000), shared;
                uint64_t count = all.result.count, counts[] = {count, count + 1000, count / 2, 0};
                host h;
                CHECK(all.status == SC_OK);
                if (scene < 2 && options.contour != SC_CONTOUR_NONE && kind < 2 * METHODS)
                    CHECK_MSG(count > (scene == 0 ? 20 : 4000), "only %u", (unsigned)count);
                host_start(&h, HOST_AT_ONCE, 2);
                options.tasks = &h.tasks;
                shared = fixture_ask(&f, workspace, &options, count);
                host_stop(&h);
                for (int way = HOST_FIRST; way < HOST_COUNT; ++way) {
                    host_start(&h, way, 1 + test_random_below(THREADS_MAX));
                    for (int c = 0; c < (way == HOST_THREADS && kind % 3 ? 1 : 4); ++c) {
                        answer serial, other;
                        options.output = c == 1 ? SC_OUTPUT_COUNT : SC_OUTPUT_PAIRS;
                        options.tasks = NULL;
                        serial = fixture_ask(&f, f.workspace, &options, counts[c]);
                        options.tasks = &h.tasks;
                        other = fixture_ask(&f, workspace, &options, counts[c]);
                        if (c < 2 && h.tasks.workers > 1)
                            CHECK_MSG(answer_counts_same(&shared, &other),
                                      "scene %d, kind %u, host %d", scene, (unsigned)kind, way);
                        if (c < 2 && options.method != SC_METHOD_SCTT)
                            CHECK(answer_other_counts_same(&serial, &other));
                        CHECK_MSG(answer_is_same(&serial, other),
                                  "scene %d, kind %u, host %d, capacity %u", scene, (unsigned)kind,
                                  way, (unsigned)counts[c]);
                        free(serial.pairs);
                    }
                    CHECK(h.mistakes == 0 && !h.is_busy);
                    jobs += h.jobs;
                    host_stop(&h);
                }
                free(shared.pairs);
                free(all.pairs);
            }
            sc_workspace_free(workspace);
        }
        fixture_stop(&f);
    }
    CHECK(jobs > test_iterations(200));
}

/* Queries that read no clocks, with room and without. */
static void without_statistics(void)
{
    for (int scene = 0; scene < SCENES; ++scene) {
        fixture f;
        if (start_scene(&f, scene)) {
            sc_workspace_options o = options_for_workers(THREADS_MAX);
            sc_workspace *workspace = NULL;
            CHECK(sc_workspace_create_for(f.model, &o, &workspace) == SC_OK);
            for (uint32_t kind = 0; kind < METHODS; ++kind) {
                if (trial_is_left_out(scene, kind)) continue;
                sc_query_options options = question(kind);
                uint64_t room = 100000;
                for (int c = 0; c < 3; ++c) {
                    answer serial;
                    host h;
                    options.tasks = NULL;
                    serial = fixture_ask(&f, f.workspace, &options, room);
                    CHECK(answer_is_same(&serial,
                                         fixture_ask_with(&f, f.workspace, &options, room, 0)));
                    host_start(&h, c, 2 + test_random_below(THREADS_MAX - 1));
                    options.tasks = &h.tasks;
                    CHECK_MSG(
                        answer_is_same(&serial, fixture_ask_with(&f, workspace, &options, room, 0)),
                        "scene %d, kind %u, room for %u", scene, (unsigned)kind, (unsigned)room);
                    CHECK(h.mistakes == 0);
                    host_stop(&h);
                    room = c ? 0 : serial.result.count / 2;
                    free(serial.pairs);
                }
            }
            sc_workspace_free(workspace);
        }
        fixture_stop(&f);
    }
}

/* More pairs than the workspace has room for, when they are sorted. */
static void very_many_pairs(void)
{
    fixture f;
    if (fixture_start(&f, soup_cloth(32, 32), 0.5, 3)) {
        sc_workspace_options o = options_for_workers(2);
        sc_workspace *workspace = NULL;
        CHECK(sc_workspace_create_for(f.model, &o, &workspace) == SC_OK);
        for (uint32_t kind = 0; kind < 2 * METHODS; kind += METHODS) {
            sc_query_options options = question(kind);
            answer serial = fixture_ask(&f, f.workspace, &options, 1000000), shared;
            uint64_t i, wrong = 0;
            host h;
            CHECK(serial.status == SC_OK);
            CHECK_MSG(serial.result.count > 100000, "%u", (unsigned)serial.result.count);
            for (i = 1; i < serial.result.count; ++i)
                wrong += serial.pairs[i - 1].a > serial.pairs[i].a ||
                         (serial.pairs[i - 1].a == serial.pairs[i].a &&
                          serial.pairs[i - 1].b >= serial.pairs[i].b);
            CHECK_MSG(wrong == 0, "kind %u: %u not in order", (unsigned)kind, (unsigned)wrong);
            host_start(&h, HOST_THREADS, 2);
            options.tasks = &h.tasks;
            shared = fixture_ask(&f, workspace, &options, 1000000);
            host_stop(&h);
            CHECK(answer_is_same(&serial, shared));
            free(serial.pairs);
        }
        sc_workspace_free(workspace);
    }
    fixture_stop(&f);
}

/* Poses of any type and stride; one that is not finite is refused, wherever that is. */
static void any_array_of_positions(void)
{
    fixture f;
    if (fixture_start(&f, soup_cloth(80, 80), 4, 0.003)) {
        sc_workspace_options o = options_for_workers(THREADS_MAX);
        sc_workspace *workspace = NULL;
        sc_query_options options = no_options(), shared = no_options();
        CHECK(sc_workspace_create_for(f.model, &o, &workspace) == SC_OK);
        for (uint32_t i = 0; i < 24; ++i) {
            if (trial_is_left_out(0, i / 4)) continue;
            input_array array =
                input_positions(f.posed, f.mesh.vertex_count, i % 2 ? SC_FLOAT : SC_DOUBLE,
                                i % 4 < 2 ? 0 : 1 + test_random_below(20));
            sc_pose plain = f.pose;
            answer serial, refused;
            host h;
            host_start(&h, (int)i % HOST_COUNT, 2 + test_random_below(THREADS_MAX - 1));
            shared.tasks = &h.tasks;
            options.method = shared.method = i / 4 % 4;
            f.pose = input_pose(f.mesh.vertex_count, &array);
            serial = fixture_ask(&f, f.workspace, &options, 10000);
            CHECK(serial.status == SC_OK && serial.result.count > 10);
            CHECK(answer_is_same(&serial, fixture_ask(&f, workspace, &shared, 10000)));
            free(serial.pairs);
            if (i % 2 == 0) { /* the last coordinate, or any */
                uint32_t v =
                    i % 4 ? f.mesh.vertex_count - 1 : test_random_below(f.mesh.vertex_count);
                const double nan = (double)NAN;
                memcpy(array.data + (size_t)v * (array.stride ? array.stride : 24) + 16, &nan,
                       sizeof(nan));
                refused = fixture_ask(&f, workspace, &shared, 10000);
                CHECK(refused.status == SC_ERROR_NOT_FINITE && refused.result.count == 0);
                free(refused.pairs);
            }
            input_free(&array);
            f.pose = plain;
            host_stop(&h);
        }
        sc_workspace_free(workspace);
    }
    fixture_stop(&f);
}

/* Whether there is a pair: the answer is known, the pair is not. */
static void any_pair(void)
{
    for (int scene = 0; scene < SCENES; ++scene) {
        fixture f;
        if (start_scene(&f, scene)) {
            sc_workspace_options o = options_for_workers(THREADS_MAX);
            sc_workspace *workspace = NULL;
            CHECK(sc_workspace_create_for(f.model, &o, &workspace) == SC_OK);
            for (uint32_t i = 0; i < 2 * KINDS; ++i) {
                if (trial_is_left_out(scene, i)) continue;
                sc_query_options options = question(i % KINDS);
                answer serial;
                host h;
                if (i >= KINDS)
                    f.pose.positions = f.mesh.positions; /* without pairs, but in soups */
                options.output = SC_OUTPUT_ANY;
                serial = fixture_ask(&f, f.workspace, &options, 0);
                host_start(&h, (int)i % HOST_COUNT, 1 + test_random_below(THREADS_MAX));
                options.tasks = &h.tasks;
                CHECK(answer_is_same(&serial, fixture_ask(&f, workspace, &options, 0)));
                CHECK(serial.result.count == serial.result.collides && h.mistakes == 0);
                host_stop(&h);
                free(serial.pairs);
            }
            sc_workspace_free(workspace);
        }
        fixture_stop(&f);
    }
}

/* A function that refuses some pairs, counts calls, and notes calls from other threads. */
typedef struct judge {
    pthread_t thread;
    uint64_t calls;
    int mistakes;
} judge;

static int32_t judge_pair(void *user, uint32_t a, uint32_t b)
{
    judge *j = (judge *)user;
    j->calls++;
    if (!pthread_equal(j->thread, pthread_self())) j->mistakes++;
    return (a + b) % 3 != 0;
}

static void filters(void)
{
    for (int scene = 0; scene < 3; ++scene) {
        fixture f;
        if (start_scene(&f, scene)) {
            sc_workspace_options o = options_for_workers(THREADS_MAX);
            sc_workspace *workspace = NULL;
            sc_group *groups = (sc_group *)test_allocate(f.mesh.triangle_count * sizeof(sc_group));
            for (uint32_t t = 0; t < f.mesh.triangle_count; ++t) {
                groups[t].category = 1u << t % 3;
                groups[t].mask = t % 5 == 0 ? 1 : 7;
            }
            CHECK(sc_workspace_create_for(f.model, &o, &workspace) == SC_OK);
            for (uint32_t kind = (uint32_t)scene; kind < KINDS; kind += 3)
                for (int part = 0; part < 8; ++part) {
                    if (trial_is_left_out(scene, kind + (uint32_t)part)) continue;
                    sc_query_options options = question(kind);
                    answer serial;
                    uint64_t capacity;
                    sc_filter filter;
                    judge j;
                    host h;
                    memset(&filter, 0, sizeof(filter));
                    memset(&j, 0, sizeof(j));
                    j.thread = pthread_self();
                    filter.struct_size = sizeof(filter);
                    filter.accept_user = &j;
                    if (part % 2 == 1) filter.ignore_rings = 2 + test_random_below(4);
                    if (part / 2 % 2 == 1) filter.triangle_groups = groups;
                    if (part / 4 == 1) filter.accept = judge_pair;
                    options.filter = &filter;
                    serial = fixture_ask(&f, f.workspace, &options, 100000);
                    capacity = (uint64_t)test_random_below(2) * serial.result.count +
                               test_random_below(2000);
                    if (part == 5) capacity = 0;
                    free(serial.pairs);
                    options.output = kind % 4 == 3 ? SC_OUTPUT_COUNT : SC_OUTPUT_PAIRS;
                    j.calls = 0;
                    serial = fixture_ask(&f, f.workspace, &options, capacity);
                    host_start(&h, part % HOST_COUNT, 2 + test_random_below(THREADS_MAX - 1));
                    options.tasks = &h.tasks;
                    CHECK_MSG(
                        answer_is_same(&serial, fixture_ask(&f, workspace, &options, capacity)),
                        "scene %d, kind %u, filter %d", scene, (unsigned)kind, part);
                    if (filter.accept) CHECK(j.calls % 2 == 0 && j.mistakes == 0);
                    CHECK(h.mistakes == 0);
                    host_stop(&h);
                    free(serial.pairs);
                }
            sc_workspace_free(workspace);
            free(groups);
        }
        fixture_stop(&f);
    }
}

/* What workers that get no further part are left with in the end: pairs within leaf clusters, which
   are looked at last. */
static void what_waits_in_the_end(void)
{
    for (uint32_t trial = 0; trial < test_iterations(10); ++trial) {
        sc_workspace_options o = options_for_workers(THREADS_MAX);
        sc_query_options options = no_options();
        sc_workspace *workspace = NULL;
        fixture f;
        if (fixture_start(&f, soup_cloth(40, 40), 0, 0.004 * (1 + trial))) {
            CHECK(sc_workspace_create_for(f.model, &o, &workspace) == SC_OK);
            for (uint32_t workers = 2; workers <= THREADS_MAX; ++workers) {
                answer serial;
                host h;
                options.tasks = NULL;
                serial = fixture_ask_with(&f, f.workspace, &options, 100000, 0);
                host_start(&h, HOST_BACKWARDS, workers);
                options.tasks = &h.tasks;
                CHECK_MSG(
                    answer_is_same(&serial, fixture_ask_with(&f, workspace, &options, 100000, 0)),
                    "trial %u, %u workers", (unsigned)trial, (unsigned)workers);
                CHECK(h.mistakes == 0);
                host_stop(&h);
                free(serial.pairs);
            }
            sc_workspace_free(workspace);
        }
        fixture_stop(&f);
    }
}

/* A cloth of which one vertex is pulled away: a few triangles meet or none, so that hardly anything
   waits when no part is left. Hosts in both orders give parts to random workers. */
static void hardly_any_pairs(void)
{
    sc_workspace_options o = options_for_workers(THREADS_MAX);
    sc_query_options options = no_options();
    sc_workspace *workspace = NULL;
    uint64_t jobs = 0, with_few = 0;
    fixture f;
    if (fixture_start(&f, soup_cloth(32, 32), 0, 0)) {
        const uint32_t rounds = test_iterations(20000);
        CHECK(sc_workspace_create_for(f.model, &o, &workspace) == SC_OK);
        for (uint32_t i = 0; i < rounds; ++i) {
            const uint32_t pulled = test_random_below(f.mesh.vertex_count);
            double before[3];
            answer serial;
            host h;
            memcpy(before, &f.posed[3 * pulled], sizeof(before));
            for (uint32_t k = 0; k < 3; ++k)
                f.posed[3 * pulled + k] += test_random_range(-0.12, 0.12);
            options.method = i % 4 == 3 ? SC_METHOD_AABB : SC_METHOD_SCTT;
            options.tasks = NULL;
            serial = fixture_ask_with(&f, f.workspace, &options, 100, 0);
            with_few += serial.result.count > 0 && serial.result.count < 10;
            host_start(&h, i % 2 ? HOST_BACKWARDS : HOST_FORWARDS,
                       2 + test_random_below(THREADS_MAX - 1));
            options.tasks = &h.tasks;
            CHECK_MSG(answer_is_same(&serial, fixture_ask_with(&f, workspace, &options, 100, 0)),
                      "trial %u", (unsigned)i);
            CHECK(h.mistakes == 0);
            jobs += h.jobs;
            host_stop(&h);
            free(serial.pairs);
            memcpy(&f.posed[3 * pulled], before, sizeof(before));
        }
        CHECK_MSG(jobs > rounds && (with_few > 0 || rounds < 5000), "%u jobs, %u with a few pairs",
                  (unsigned)jobs, (unsigned)with_few);
        sc_workspace_free(workspace);
    }
    fixture_stop(&f);
}

/* Whether the workers of a workspace answer as one does, twice in a row. */
static void check_workers(const fixture *f, sc_workspace *workspace, sc_query_options *options)
{
    answer serial;
    options->tasks = NULL;
    serial = fixture_ask(f, f->workspace, options, 100000);
    for (int way = 0; way < 2; ++way) {
        host h;
        host_start(&h, HOST_BACKWARDS, workspace->sizes.workers);
        options->tasks = &h.tasks;
        CHECK(answer_is_same(&serial, fixture_ask(f, workspace, options, 100000)));
        CHECK(h.parts > 0 && h.mistakes == 0);
        host_stop(&h);
    }
    free(serial.pairs);
}

/* What a worker found in an early pose is not taken for new when ticks begin anew; on models that
   keep all leaf clusters ready, and on others. */
static void ticks_of_workers(void)
{
    for (uint32_t content = SC_MODEL_FULL; content <= SC_MODEL_BOXES; ++content) {
        sc_workspace_options o = options_for_workers(3);
        sc_query_options options = no_options();
        sc_workspace *workspace = NULL;
        fixture f;
        if (fixture_start(&f, soup_cloth(40, 40), 0.5, 0.03)) {
            sc_build_options build;
            sc_mesh mesh = input_plain_mesh(&f.mesh);
            sc_workspace_free(f.workspace);
            sc_model_free(f.model);
            memset(&build, 0, sizeof(build));
            build.struct_size = sizeof(build);
            build.content = content;
            CHECK(sc_build(&mesh, &build, &f.model) == SC_OK);
            CHECK(sc_workspace_create(f.model, NULL, &f.workspace) == SC_OK);
            CHECK(sc_workspace_create_for(f.model, &o, &workspace) == SC_OK);
            check_workers(&f, workspace, &options);
            CHECK(workspace->frame.epoch == 2);
            workspace->epochs = 0x7fffffff;
            soup_twist(f.posed, f.mesh.vertex_count, 2);
            soup_noise(f.posed, f.mesh.vertex_count, 0.1);
            check_workers(&f, workspace, &options);
            CHECK(workspace->frame.epoch == 2);
            sc_workspace_free(workspace);
        }
        fixture_stop(&f);
    }
}

/* A budget ends a query at the same place, and a flag that is set before ends it at once. */
static void stopped_early(void)
{
    static const uint32_t flag = 1;
    for (int scene = 0; scene < 2; ++scene) {
        fixture f;
        if (start_scene(&f, scene)) {
            sc_workspace_options o = options_for_workers(THREADS_MAX);
            sc_workspace *workspace = NULL;
            CHECK(sc_workspace_create_for(f.model, &o, &workspace) == SC_OK);
            for (uint32_t kind = 0; kind < KINDS; ++kind) {
                if (trial_is_left_out(scene, kind)) continue;
                sc_query_options options = question(kind);
                answer serial;
                host h;
                host_start(&h, (int)kind % HOST_COUNT, 2 + test_random_below(THREADS_MAX - 1));
                options.budget = 1 + test_random_below(30000);
                serial = fixture_ask(&f, f.workspace, &options, 10000);
                options.tasks = &h.tasks;
                CHECK(answer_is_same(&serial, fixture_ask(&f, workspace, &options, 10000)));
                free(serial.pairs);
                options.budget = 0;
                options.cancel = &flag;
                serial = fixture_ask(&f, workspace, &options, 10000);
                CHECK(serial.status == SC_ERROR_INCOMPLETE && serial.result.count == 0 &&
                      serial.result.verdict == SC_VERDICT_INCOMPLETE);
                free(serial.pairs);
                host_stop(&h);
            }
            sc_workspace_free(workspace);
        }
        fixture_stop(&f);
    }
}

/* What was found when the flag was set is delivered, sorted, and is right. */
static void stop_on_the_way(int scene, uint32_t rounds)
{
    fixture f;
    if (start_scene(&f, scene)) {
        sc_workspace_options o = options_for_workers(3);
        sc_workspace *workspace = NULL;
        uint32_t incomplete = 0, some = 0, parts;
        CHECK(sc_workspace_create_for(f.model, &o, &workspace) == SC_OK);
        for (uint32_t i = 0; i < rounds; ++i) {
            sc_query_options options = question(i % 3 * 2);
            answer all, part;
            breaker b;
            breaker_start(&b, 3, UINT32_MAX);
            all = fixture_ask(&f, f.workspace, &options, 100000);
            options.tasks = &b.tasks;
            CHECK(answer_is_same(&all, fixture_ask(&f, workspace, &options, 100000)));
            parts = UINT32_MAX - b.left;
            /* at any time, or late: what little there is, is found in the end */
            b.left = i % 2 ? 1 + test_random_below(parts) : parts - test_random_below(12);
            options.cancel = &b.flag;
            part = fixture_ask(&f, workspace, &options, 100000);
            if (b.flag && part.status == SC_ERROR_INCOMPLETE) {
                ++incomplete;
                some += part.result.count > 0;
                CHECK(part.result.verdict == SC_VERDICT_INCOMPLETE &&
                      part.result.count <= all.result.count);
                for (uint64_t k = 0; k < part.result.count; ++k)
                    CHECK(pair_is_among(part.pairs[k], all.pairs, all.result.count) &&
                          (!k || part.pairs[k - 1].a < part.pairs[k].a ||
                           (part.pairs[k - 1].a == part.pairs[k].a &&
                            part.pairs[k - 1].b < part.pairs[k].b)));
                free(part.pairs);
            } else {
                CHECK(answer_is_same(&all, part));
            }
            options.cancel = NULL;
            CHECK(answer_is_same(&all, fixture_ask(&f, workspace, &options, 100000)));
            free(all.pairs);
        }
        CHECK_MSG(incomplete > rounds / 6 && (some > 5 || scene > 1), "%u stopped, %u with pairs",
                  incomplete, some);
        sc_workspace_free(workspace);
    }
    fixture_stop(&f);
}

static void stopped_on_the_way(void)
{
    stop_on_the_way(1, 60);
    stop_on_the_way(4, 20); /* most waits until all else is done */
    stop_on_the_way(5, 60); /* and here contour tests are a job */
}

/* ---- trees that are not balanced ---- */

/* So many triangles, each with its own vertices, all about one place. */
static soup pile(uint32_t count)
{
    soup s = soup_make(3 * count, count);
    for (uint32_t i = 0; i < 9 * count; ++i) s.positions[i] = test_random_unit();
    for (uint32_t i = 0; i < 3 * count; ++i) s.triangles[i] = i;
    return s;
}

/* So many triangles round one vertex. */
static soup crumpled_fan(uint32_t count)
{
    soup s = soup_make(count + 1, count);
    for (uint32_t i = 0; i < 3 * count + 3; ++i) s.positions[i] = test_random_unit();
    for (uint32_t t = 0; t < count; ++t) {
        s.triangles[3 * t] = 0;
        s.triangles[3 * t + 1] = t + 1;
        s.triangles[3 * t + 2] = (t + 1) % count + 1;
    }
    return s;
}

/* Strips with flags: so many triangles that face down; then three rows of squares that face up, and
   on every other edge at a side of them triangles, which face up as well and get in each other's
   way. */
enum { STRIPS = 8, DOWN = 10, SQUARES = 114, FLAGS = 24, STRIP = DOWN + 6 * SQUARES };

static void set_corner(double *p, double x, double y, double z)
{
    p[0] = x;
    p[1] = y;
    p[2] = z;
}

static soup strips_with_flags(void)
{
    enum { COLUMNS = SQUARES + 1, POINTS = 3 * DOWN + 4 * COLUMNS + FLAGS * SQUARES / 2 };
    soup s = soup_make(STRIPS * POINTS, STRIPS * (STRIP + FLAGS * SQUARES / 2));
    uint32_t *t = s.triangles;
    for (uint32_t strip = 0; strip < STRIPS; ++strip) {
        const uint32_t down = strip * POINTS, square = down + 3 * DOWN, flag = square + 4 * COLUMNS;
        const double away = 10 * strip;
        double(*at)[3] = (double(*)[3])s.positions;
        for (uint32_t i = 0; i < 3 * DOWN; ++i, ++t) {
            set_corner(at[down + i], i / 3 + i % 3 % 2, away + 5 + i % 3 / 2, -1);
            *t = down + i / 3 * 3 + (3 - i % 3) % 3;
        }
        for (uint32_t i = 0; i < 4 * COLUMNS; ++i)
            set_corner(at[square + i], i % COLUMNS, away + i / COLUMNS,
                       test_random_range(-0.1, 0.1));
        for (uint32_t i = 0; i < 6 * SQUARES; ++i, t += 3) {
            uint32_t p = square + i / 2 / SQUARES * COLUMNS + i / 2 % SQUARES;
            t[0] = p + i % 2;
            t[1] = p + 1 + i % 2 * COLUMNS;
            t[2] = p + COLUMNS;
        }
        for (uint32_t i = 0; i < FLAGS * SQUARES / 2; ++i, t += 3) {
            uint32_t p = i / FLAGS * 2;
            set_corner(at[flag + i], p + test_random_range(-2, 3), away - 1,
                       test_random_range(-1, 1));
            t[0] = square + p + 1;
            t[1] = square + p;
            t[2] = flag + i;
        }
    }
    return s;
}

enum { TREES = 6 };

/* Trees that are not balanced, with more parts than the list has room for, since a large patch
   meets hundreds of small ones at each level; one of pairs of neighbors, of which many wait and of
   others none; one of very many leaf clusters; one of large patches that have more neighbors with
   which they wait for a contour test than the list has room for; and a spiral of which one half is
   flat, where contours cross, and the other one crumpled, again with more parts. */
static int start_tree_scene(fixture *f, int scene)
{
    if (scene == 5) {
        if (!fixture_start_tree(f, shape_spiral(90, 7, 3, 0), 1, 600, 30)) return 0;
        for (uint32_t v = 0; v < f->mesh.vertex_count; ++v)
            if (f->posed[3 * v] > 0) f->posed[3 * v + 2] += test_random_range(-0.1, 0.1);
        return 1;
    }
    if (scene == 4) return fixture_start_tree(f, strips_with_flags(), STRIPS, STRIP, DOWN);
    if (scene == 2) return fixture_start_tree(f, crumpled_fan(640), 1, 0, 0);
    if (scene == 3) {
        if (!fixture_start_tree(f, soup_cloth(47, 47), 1, 0, 0)) return 0;
        soup_smooth(f->posed, f->mesh.vertex_count, 0.1);
        soup_twist(f->posed, f->mesh.vertex_count, 2);
        return 1;
    }
    return fixture_start_tree(f, pile(scene ? 600 : 500), 1, 240, 40);
}

static void by_trees(void)
{
    for (int scene = 0; scene < TREES; ++scene) {
        fixture f;
        if (start_tree_scene(&f, scene)) {
            sc_workspace_options o = options_for_workers(THREADS_MAX);
            sc_workspace *workspace = NULL;
            CHECK(sc_workspace_create_for(f.model, &o, &workspace) == SC_OK);
            for (uint32_t kind = 0; kind < METHODS; ++kind) {
                if (trial_is_left_out(scene, kind)) continue;
                sc_query_options options = question(kind);
                answer serial = fixture_ask(&f, f.workspace, &options, 200000), shared, other;
                host h;
                CHECK(serial.status == SC_OK);
                if (scene != 3 && options.contour != SC_CONTOUR_NONE)
                    CHECK_MSG(serial.result.count > 1000, "%u", (unsigned)serial.result.count);
                host_start(&h, HOST_AT_ONCE, 2);
                options.tasks = &h.tasks;
                shared = fixture_ask(&f, workspace, &options, 200000);
                host_stop(&h);
                for (int round = 0; round < (scene == 5 && !kind ? 20 : 1); ++round) {
                    const uint32_t more = test_random_below(THREADS_MAX - 1);
                    host_start(&h, 1 + (int)kind % 3, 2 + (scene == 5 ? more % 3 : more));
                    other = fixture_ask(&f, workspace, &options, 200000);
                    CHECK(h.mistakes == 0 && h.jobs > 0);
                    host_stop(&h);
                    CHECK(answer_counts_same(&shared, &other));
                    CHECK_MSG(answer_is_same(&serial, other), "scene %d, kind %u", scene,
                              (unsigned)kind);
                }
                CHECK_MSG(answer_is_same(&serial, shared), "scene %d, kind %u", scene,
                          (unsigned)kind);
                free(serial.pairs);
            }
            sc_workspace_free(workspace);
        }
        fixture_stop(&f);
    }
}

/* What becomes of a pair of triangles, and is counted, does not depend on those that are tested
   with it, which are others with each number of workers. */
static void in_any_company(void)
{
    uint32_t rounds = test_iterations(150);
    for (uint32_t i = 0; i < rounds; ++i) {
        fixture f;
        uint32_t side = 20 + test_random_below(15);
        if (fixture_start_tree(&f, soup_cloth(side, side), 1, 0, 0)) {
            sc_workspace_options o = options_for_workers(THREADS_MAX);
            sc_workspace *workspace = NULL;
            sc_query_options options = question(i % 2 ? 0 : METHODS - 1);
            answer two;
            soup_smooth(f.posed, f.mesh.vertex_count, 0.1);
            soup_twist(f.posed, f.mesh.vertex_count, 2);
            CHECK(sc_workspace_create_for(f.model, &o, &workspace) == SC_OK);
            memset(&two, 0, sizeof(two));
            for (uint32_t workers = 2; workers <= 4; ++workers) {
                answer shared;
                host h;
                host_start(&h, workers == 2 ? HOST_AT_ONCE : HOST_BACKWARDS, workers);
                options.tasks = &h.tasks;
                shared = fixture_ask(&f, workspace, &options, 200000);
                host_stop(&h);
                free(shared.pairs);
                if (workers == 2) two = shared;
                CHECK_MSG(answer_counts_same(&two, &shared), "mesh %u, %u workers", (unsigned)i,
                          (unsigned)workers);
            }
            sc_workspace_free(workspace);
        }
        fixture_stop(&f);
    }
}
SC_TEST_MAIN(SC_TEST(workspaces_for_workers), SC_TEST(workspaces_refused), SC_TEST(tasks_refused),
             SC_TEST(the_same_answers), SC_TEST(without_statistics), SC_TEST(very_many_pairs),
             SC_TEST(any_array_of_positions), SC_TEST(any_pair), SC_TEST(filters),
             SC_TEST(what_waits_in_the_end), SC_TEST(hardly_any_pairs), SC_TEST(ticks_of_workers),
             SC_TEST(stopped_early), SC_TEST(stopped_on_the_way), SC_TEST(by_trees),
             SC_TEST(in_any_company))
