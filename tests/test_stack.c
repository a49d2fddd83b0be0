/*
 * How much stack the calls take: engines run them on fibers with small ones. What
 * include/EMBEDDING.md promises, 32 kilobytes, is enough, also where signs need the widest numbers.
 *
 * SPDX-License-Identifier: MIT
 */
#define _XOPEN_SOURCE 700

#include <pthread.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "harness.h"
#include "starcontour.h"

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#  define SANITIZED 1
#elif defined(__has_feature)
#  if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer) ||                       \
      __has_feature(memory_sanitizer)
#    define SANITIZED 1
#  endif
#endif
#ifndef SANITIZED
#  define SANITIZED 0
#endif

enum {
    SIDE = 60,
    VERTICES = SIDE * SIDE,
    TRIANGLES = 2 * (SIDE - 1) * (SIDE - 1),
    STACK = 1 << 20,
    PAINT = 0xa5,
    PAIRS = 1000,
    PROMISED = 32 * 1024
};

/* One call, on a stack of its own. */
typedef struct call {
    const sc_mesh *mesh;
    const sc_pose *pose, *start;
    const sc_tasks *tasks;
    double separation;
    uint32_t pairs;
    sc_model *model;
    sc_workspace *workspace;
    sc_result result;
    sc_step_result stepped;
    sc_near_result near;
    sc_contact *contacts;
    sc_pair apart; /* two edges */
    sc_near_stencil stencil;
    void *saved;
    uint64_t saved_size;
    sc_status status;
} call;

/* Tasks that run all parts at once in the thread that asks, so that theirs counts as well. */
static void *run_here(void *user, void (*run)(void *context, uint32_t part, uint32_t worker),
                      void *context, uint32_t count)
{
    (void)user;
    for (uint32_t part = 0; part < count; ++part) run(context, part, part % 2);
    return NULL;
}

static void finish(void *user, void *task)
{
    (void)user;
    (void)task;
}

static void *nothing(void *argument)
{
    return argument;
}

static void *build(void *argument)
{
    call *c = (call *)argument;
    c->status = sc_build(c->mesh, NULL, &c->model);
    return NULL;
}

static void *query(void *argument)
{
    call *c = (call *)argument;
    const sc_query_options options = {
        .struct_size = sizeof(options), .pairs = c->pairs, .tasks = c->tasks};
    c->status = sc_query(c->model, c->workspace, c->pose, &options, &c->result);
    return NULL;
}

static void *meet(void *argument)
{
    call *c = (call *)argument;
    c->status = sc_contacts(c->model, c->pose, c->pairs, c->result.pairs, PAIRS, c->contacts);
    return NULL;
}

static void *find_closest(void *argument)
{
    call *c = (call *)argument;
    c->status = sc_near_stencils(c->model, c->pose, SC_NEAR_EDGE_EDGE, &c->apart, 1, &c->stencil);
    return NULL;
}

static void *step(void *argument)
{
    call *c = (call *)argument;
    const sc_step_options options = {.struct_size = sizeof(options),
                                     .times = SC_STEP_TIMES_EACH,
                                     .separation = c->separation,
                                     .tasks = c->tasks};
    c->status = sc_query_step(c->model, c->workspace, c->start, c->pose, &options, &c->stepped);
    return NULL;
}

static void *near(void *argument)
{
    call *c = (call *)argument;
    const sc_near_options options = {
        .struct_size = sizeof(options), .distance = c->separation, .tasks = c->tasks};
    c->status = sc_query_near(c->model, c->workspace, c->pose, &options, &c->near);
    return NULL;
}

static void *load(void *argument)
{
    call *c = (call *)argument;
    sc_model *model;
    c->status = sc_model_load(c->saved, c->saved_size, NULL, &model);
    sc_model_free(model);
    return NULL;
}

/* A step with a rest pose, and back. */
static void *record(void *argument)
{
    call *c = (call *)argument;
    const sc_step_options options = {.struct_size = sizeof(options), .rest = c->start};
    sc_step_options found = {.struct_size = sizeof(found)};
    sc_pose poses[3] = {*c->pose, *c->pose, *c->pose};
    sc_record read = {.struct_size = sizeof(read),
                      .pose = &poses[0],
                      .end = &poses[1],
                      .rest = &poses[2],
                      .step_options = &found};
    c->status =
        sc_record_step_write(c->model, c->start, c->pose, &options, c->saved, c->saved_size, NULL);
    if (c->status == SC_OK) c->status = sc_record_read(c->saved, c->saved_size, &read);
    return NULL;
}

/* Bytes of stack that a thread with this body has written to, 0 if there was no thread. */
static size_t stack_of(void *(*body)(void *), call *c)
{
    unsigned char *stack = NULL;
    pthread_attr_t attributes;
    pthread_t thread;
    size_t untouched = 0;
    void *memory = NULL;
    if (posix_memalign(&memory, 4096, STACK)) return 0;
    stack = (unsigned char *)memory;
    memset(stack, PAINT, STACK);
    pthread_attr_init(&attributes);
    if (pthread_attr_setstack(&attributes, stack, STACK) ||
        pthread_create(&thread, &attributes, body, c)) {
        free(stack);
        return 0;
    }
    pthread_join(thread, NULL);
    pthread_attr_destroy(&attributes);
    while (untouched < STACK && stack[untouched] == PAINT) ++untouched;
    free(stack);
    return STACK - untouched;
}

/* A cloth folded flat onto itself three times: all contacts are degenerate. */
static void folded(double *positions, double unit)
{
    for (int i = 0; i < VERTICES; ++i) {
        const int x = i % SIDE, y = i / SIDE, fold = x % 30;
        positions[3 * i] = unit / 3 * (fold < 15 ? fold : 30 - fold);
        positions[3 * i + 1] = unit / 7 * (y + 0.25 * (x / 15));
        positions[3 * i + 2] = unit / 11 * (positions[3 * i] / unit + positions[3 * i + 1] / unit);
    }
}

static void calls_take_little_stack(void)
{
    static uint32_t triangles[3 * TRIANGLES];
    static double rest[3 * VERTICES], first[3 * VERTICES], moved[3 * VERTICES];
    const double units[] = {1, 1e-107, 1e150};
    uint32_t *next = triangles;
    if (SANITIZED) {
        test_skip("sanitizers take stack of their own");
        return;
    }
    for (uint32_t y = 0; y + 1 < SIDE; ++y) {
        for (uint32_t x = 0; x + 1 < SIDE; ++x) {
            const uint32_t a = y * SIDE + x;
            const uint32_t corners[] = {a, a + 1, a + SIDE, a + 1, a + SIDE + 1, a + SIDE};
            memcpy(next, corners, sizeof(corners));
            next += 6;
        }
    }
    for (int i = 0; i < VERTICES; ++i) rest[3 * i] = i % SIDE, rest[3 * i + 1] = i / SIDE;

    const sc_mesh mesh = {.struct_size = sizeof(mesh),
                          .vertex_count = VERTICES,
                          .triangle_count = TRIANGLES,
                          .position_type = SC_DOUBLE,
                          .positions = rest,
                          .indices = triangles};
    const sc_pose pose = {.struct_size = sizeof(pose),
                          .vertex_count = VERTICES,
                          .position_type = SC_DOUBLE,
                          .positions = moved};
    const sc_pose start = {.struct_size = sizeof(start),
                           .vertex_count = VERTICES,
                           .position_type = SC_DOUBLE,
                           .positions = first};
    const sc_tasks tasks = {
        .struct_size = sizeof(tasks), .workers = 2, .enqueue = run_here, .finish = finish};
    sc_stats stats = {.struct_size = sizeof(stats)};
    call c = {.mesh = &mesh, .pose = &pose, .start = &start};
    const size_t empty = stack_of(nothing, &c);
    const size_t building = stack_of(build, &c);
    if (!CHECK(empty > 0 && building > empty) || !CHECK(c.status == SC_OK)) return;
    CHECK_MSG(building - empty <= PROMISED, "%zu bytes", building - empty);
    test_note("sc_build: %zu bytes", building - empty);
    const sc_workspace_options how = {
        .struct_size = sizeof(how), .flags = SC_WORKSPACE_NEAR, .workers = 2};
    if (!CHECK(sc_workspace_create_for(c.model, &how, &c.workspace) == SC_OK)) return;

    if (!CHECK(sc_model_save_size(c.model, &c.saved_size) == SC_OK)) return;
    c.saved = malloc(c.saved_size);
    if (!CHECK(c.saved && !sc_model_save(c.model, c.saved, c.saved_size, NULL))) return;
    const size_t loading = stack_of(load, &c);
    CHECK(loading > empty && c.status == SC_OK);
    CHECK_MSG(loading - empty <= PROMISED, "%zu bytes", loading - empty);
    test_note("sc_model_load: %zu bytes", loading - empty);
    free(c.saved);

    c.saved_size *= 2; /* the model and three poses */
    c.saved = malloc(c.saved_size);
    if (!CHECK(c.saved)) return;
    const size_t recording = stack_of(record, &c);
    CHECK(recording > empty && c.status == SC_OK);
    CHECK_MSG(recording - empty <= PROMISED, "%zu bytes", recording - empty);
    test_note("sc_record_step_write, sc_record_read: %zu bytes", recording - empty);
    free(c.saved);

    static sc_pair pairs[PAIRS];
    static sc_contact contacts[PAIRS];
    static sc_pair edges[PAIRS];
    size_t most = 0, most_meeting = 0, most_stepping = 0, most_near = 0;
    uint64_t fallbacks = 0;
    for (size_t u = 0; u < sizeof(units) / sizeof(units[0]); ++u) {
        folded(moved, units[u]);
        for (int i = 0; i < 3 * VERTICES; ++i) first[i] = units[u] * rest[i];
        for (int k = 0; k < 4; ++k) { /* kind of pair, and with or without tasks */
            c.pairs = k % 2 ? SC_PAIRS_EDGE : SC_PAIRS_TRIANGLE;
            c.tasks = k < 2 ? NULL : &tasks;
            c.result = (sc_result){.struct_size = sizeof(c.result),
                                   .capacity = PAIRS,
                                   .pairs = pairs,
                                   .stats = &stats};
            c.contacts = contacts;
            const size_t querying = stack_of(query, &c);
            CHECK_MSG(c.status == SC_ERROR_SHORT_BUFFER, "status %d", (int)c.status);
            CHECK(querying > empty);
            if (querying - empty > most) most = querying - empty;
            fallbacks += stats.exact_fallbacks;
            const size_t meeting = stack_of(meet, &c);
            CHECK_MSG(meeting > empty && c.status == SC_OK, "status %d", (int)c.status);
            if (meeting - empty > most_meeting) most_meeting = meeting - empty;
            c.apart = (sc_pair){0, 3 * 40 + (uint32_t)k % 3};
            const size_t closest = stack_of(find_closest, &c);
            CHECK_MSG(closest > empty && c.status == SC_OK, "status %d", (int)c.status);
            if (closest - empty > most_near) most_near = closest - empty;
            c.separation = k % 2 ? 0.01 * units[u] : 0;
            c.stepped = (sc_step_result){.struct_size = sizeof(c.stepped),
                                         .vertex_face_capacity = PAIRS,
                                         .vertex_faces = pairs,
                                         .edge_edge_capacity = PAIRS,
                                         .edge_edges = edges};
            const size_t stepping = stack_of(step, &c);
            CHECK_MSG(stepping > empty && c.status == SC_ERROR_SHORT_BUFFER, "status %d",
                      (int)c.status);
            if (stepping - empty > most_stepping) most_stepping = stepping - empty;
            c.near = (sc_near_result){.struct_size = sizeof(c.near),
                                      .vertex_face_capacity = PAIRS,
                                      .vertex_faces = pairs,
                                      .edge_edge_capacity = PAIRS,
                                      .edge_edges = edges};
            const size_t looking = stack_of(near, &c);
            CHECK_MSG(looking > empty && c.status == SC_ERROR_SHORT_BUFFER, "status %d",
                      (int)c.status);
            if (looking - empty > most_near) most_near = looking - empty;
        }
    }
    CHECK_MSG(most <= PROMISED, "%zu bytes", most);
    CHECK(fallbacks > 0);
    test_note("sc_query: %zu bytes", most);
    CHECK_MSG(most_meeting <= PROMISED, "%zu bytes", most_meeting);
    test_note("sc_contacts: %zu bytes", most_meeting);
    CHECK_MSG(most_stepping <= PROMISED, "%zu bytes", most_stepping);
    test_note("sc_query_step: %zu bytes", most_stepping);
    CHECK_MSG(most_near <= PROMISED, "%zu bytes", most_near);
    test_note("sc_query_near, sc_near_stencils: %zu bytes", most_near);
    sc_workspace_free(c.workspace);
    sc_model_free(c.model);
}

SC_TEST_MAIN(SC_TEST(calls_take_little_stack))
