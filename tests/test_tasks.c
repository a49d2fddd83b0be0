/*
 * The host's tasks: workspaces for several workers, what is refused, and that answers are those of
 * one thread, whoever runs the parts of a query, or of a step, and in whatever order.
 *
 * SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "harness.h"
#include "inputs.h"
#include "pose/workspace.h"
#include "shapes.h"
#include "soups.h"
#include "starcontour.h"

/* ---- hosts ---- */

enum { HOST_AT_ONCE, HOST_BACKWARDS, HOST_THREADS, HOST_COUNT };

/* Under ThreadSanitizer all have threads: it can find nothing where one does all. */
#ifdef __SANITIZE_THREAD__
enum { HOST_FIRST = HOST_THREADS };
#else
enum { HOST_FIRST = HOST_AT_ONCE };
#endif

enum { THREADS_MAX = 8 };

typedef struct host_worker host_worker;

/* A host that runs parts in one of several ways and looks at how it is called. */
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

struct host_worker {
    host *its;
    uint32_t worker;
};

static void *host_work(void *argument)
{
    const host_worker *me = (const host_worker *)argument;
    host *h = me->its;
    for (;;) {
        uint32_t part;
        pthread_mutex_lock(&h->mutex);
        part = h->next++;
        pthread_mutex_unlock(&h->mutex);
        if (part >= h->count) return NULL;
        h->run(h->context, part, me->worker);
    }
}

static void *host_enqueue(void *user, void (*run)(void *context, uint32_t part, uint32_t worker),
                          void *context, uint32_t count)
{
    host *h = (host *)user;
    if (h->is_busy || !count) ++h->mistakes;
    h->is_busy = 1;
    ++h->jobs;
    h->parts += count;
    h->run = run;
    h->context = context;
    h->count = count;
    h->next = 0;
    if (h->way == HOST_AT_ONCE)
        for (uint32_t part = 0; part < count; ++part) run(context, part, 0);
    if (h->way == HOST_THREADS)
        for (uint32_t t = 0; t < h->tasks.workers; ++t)
            if (pthread_create(&h->threads[t], NULL, host_work, &h->workers[t]) != 0) abort();
    return h->way == HOST_AT_ONCE ? NULL : h;
}

static void host_finish(void *user, void *task)
{
    host *h = (host *)user;
    if (!h->is_busy || task != (h->way == HOST_AT_ONCE ? NULL : h)) ++h->mistakes;
    h->is_busy = 0;
    if (h->way == HOST_BACKWARDS)
        while (h->count > 0) h->run(h->context, --h->count, test_random_below(h->tasks.workers));
    if (h->way == HOST_THREADS)
        for (uint32_t t = 0; t < h->tasks.workers; ++t) pthread_join(h->threads[t], NULL);
}

static void host_start(host *h, int way, uint32_t workers)
{
    memset(h, 0, sizeof(*h));
    h->way = way < HOST_FIRST ? HOST_FIRST : way;
    h->tasks.struct_size = sizeof(h->tasks);
    h->tasks.workers = workers;
    h->tasks.enqueue = host_enqueue;
    h->tasks.finish = host_finish;
    h->tasks.user = h;
    pthread_mutex_init(&h->mutex, NULL);
    h->workers = (host_worker *)test_allocate(THREADS_MAX * sizeof(host_worker));
    for (uint32_t t = 0; t < THREADS_MAX; ++t) {
        h->workers[t].its = h;
        h->workers[t].worker = t;
    }
}

static void host_stop(host *h)
{
    pthread_mutex_destroy(&h->mutex);
    free(h->workers);
}

/* Whether a trial with this number is left out, as --scale asks for fewer: each scene has others,
   so that a tenth of them has every method. */
static int is_left_out(int scene, uint32_t number)
{
    const uint32_t percent = test_iterations(100), step = percent < 100 ? 100 / percent : 1;
    return (number + 3 * (uint32_t)scene) % step != 0;
}

/* ---- what queries are asked ---- */

typedef struct fixture {
    soup mesh;
    double *posed;
    sc_model *model;
    sc_workspace *workspace; /* for one worker */
    sc_pose pose;
} fixture;

static int start_as_it_is(fixture *f, soup mesh)
{
    sc_mesh input = input_plain_mesh(&mesh);
    memset(f, 0, sizeof(*f));
    f->mesh = mesh;
    f->posed = (double *)test_allocate(3 * (size_t)mesh.vertex_count * sizeof(double));
    memcpy(f->posed, mesh.positions, 3 * (size_t)mesh.vertex_count * sizeof(double));
    f->pose = input_plain_pose(f->posed, mesh.vertex_count);
    return CHECK(sc_build(&input, NULL, &f->model) == SC_OK) &&
           CHECK(sc_workspace_create(f->model, NULL, &f->workspace) == SC_OK);
}

static int start(fixture *f, soup mesh, double turns, double noise)
{
    if (!start_as_it_is(f, mesh)) return 0;
    soup_smooth(f->posed, mesh.vertex_count, 0.1);
    if (turns > 1) soup_fold(f->posed, mesh.vertex_count);
    soup_twist(f->posed, mesh.vertex_count, turns);
    soup_noise(f->posed, mesh.vertex_count, noise);
    return 1;
}

static void stop(fixture *f)
{
    sc_workspace_free(f->workspace);
    sc_model_free(f->model);
    soup_free(&f->mesh);
    free(f->posed);
}

static sc_workspace_options for_workers(uint32_t workers)
{
    sc_workspace_options options;
    memset(&options, 0, sizeof(options));
    options.struct_size = sizeof(options);
    options.workers = workers;
    return options;
}

static sc_query_options no_options(void)
{
    sc_query_options options;
    memset(&options, 0, sizeof(options));
    options.struct_size = sizeof(options);
    return options;
}

/* What a query says. */
typedef struct answer {
    sc_status status;
    sc_result result;
    sc_stats stats;
    sc_pair *pairs;
} answer;

static answer ask_with(const fixture *f, sc_workspace *workspace, const sc_query_options *options,
                       uint64_t capacity, int has_stats)
{
    answer a;
    memset(&a, 0, sizeof(a));
    a.pairs = (sc_pair *)test_allocate((capacity + 1) * sizeof(sc_pair));
    memset(a.pairs, 0xab, (capacity + 1) * sizeof(sc_pair));
    a.stats.struct_size = sizeof(a.stats);
    a.result.struct_size = sizeof(a.result);
    a.result.capacity = capacity;
    a.result.pairs = a.pairs;
    if (has_stats) a.result.stats = &a.stats;
    a.status = sc_query(f->model, workspace, &f->pose, options, &a.result);
    CHECK(a.pairs[capacity].a == 0xabababab && a.pairs[capacity].b == 0xabababab);
    return a;
}

static answer ask(const fixture *f, sc_workspace *workspace, const sc_query_options *options,
                  uint64_t capacity)
{
    return ask_with(f, workspace, options, capacity, 1);
}

/* Whether two queries counted the same. */
static int is_count_same(const answer *a, const answer *b)
{
    return memcmp(a->stats.counts, b->stats.counts, sizeof(a->stats.counts)) == 0 &&
           a->stats.nodes_visited == b->stats.nodes_visited &&
           a->stats.nodes_oriented == b->stats.nodes_oriented &&
           a->stats.nodes_culled == b->stats.nodes_culled &&
           a->stats.leaf_pairs == b->stats.leaf_pairs &&
           a->stats.exact_fallbacks == b->stats.exact_fallbacks;
}

/* The same of all but box tests: how large patches are divided is another matter with several
   threads. */
static int is_other_count_same(const answer *a, const answer *b)
{
    answer c = *b;
    c.stats.counts[SC_TASK_BOXES_ORIENTATION] = a->stats.counts[SC_TASK_BOXES_ORIENTATION];
    c.stats.counts[SC_TASK_BOXES_CONTOUR] = a->stats.counts[SC_TASK_BOXES_CONTOUR];
    return is_count_same(a, &c);
}

/* Whether two answers are the same; frees b. */
static int is_same(const answer *a, answer b)
{
    uint64_t filled = a->result.count < a->result.capacity ? a->result.count : a->result.capacity;
    int same = a->status == b.status && a->result.count == b.result.count &&
               a->result.collides == b.result.collides && a->result.verdict == b.result.verdict &&
               memcmp(a->pairs, b.pairs, (size_t)filled * sizeof(sc_pair)) == 0;
    free(b.pairs);
    return same;
}

/* ---- tests ---- */

static void workspaces_for_workers(void)
{
    fixture f;
    if (start(&f, soup_cloth(12, 12), 0.5, 0.1)) {
        sc_query_options options = no_options();
        answer expected = ask(&f, f.workspace, &options, 5000);
        uint64_t plain = 0, size = 0, previous = 0;
        CHECK(sc_workspace_size(f.model, &plain) == SC_OK);
        CHECK(sc_workspace_size_for(f.model, NULL, &size) == SC_OK && size == plain);
        for (uint32_t flags = 0; flags <= SC_WORKSPACE_STEP; ++flags)
            for (uint32_t workers = 0; workers < 5; ++workers) {
                sc_workspace_options o = for_workers(workers);
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
                CHECK(is_same(&expected, ask(&f, workspace, &options, 5000)));
                CHECK(aligned[-1] == 0x77 && aligned[size] == 0x77);
                sc_workspace_free(workspace); /* does nothing */
                free(memory);
                CHECK(sc_workspace_create_for(f.model, &o, &workspace) == SC_OK);
                CHECK(is_same(&expected, ask(&f, workspace, &options, 5000)));
                sc_workspace_free(workspace);
            }
        free(expected.pairs);
    }
    stop(&f);
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
    if (start(&f, soup_cloth(4, 4), 0, 0)) {
        sc_workspace_options o = for_workers(2), none = for_workers(0);
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
        for (uint32_t bit = 1; bit < 32; ++bit) {
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
        o = for_workers(3);
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
    stop(&f);
}

static void tasks_refused(void)
{
    fixture f;
    if (start(&f, soup_cloth(8, 8), 1, 0.1)) {
        sc_workspace_options for_two = for_workers(2);
        sc_query_options options = no_options();
        answer expected = ask(&f, f.workspace, &options, 5000);
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
            a = ask(&f, two, &options, 5000);
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
            a = ask(&f, wrong == 3 ? f.workspace : two, &options, 5000);
            CHECK_MSG(a.status == statuses[wrong] && a.result.count == 0 &&
                          a.result.verdict == SC_VERDICT_NONE && a.pairs[0].a == 0xabababab,
                      "%d: %s", wrong, sc_status_string(a.status));
            free(a.pairs);
            h.tasks = right;
        }
        CHECK(h.jobs == 0);
        for (uint32_t workers = 0; workers < 3; ++workers) {
            h.tasks.workers = workers;
            CHECK(is_same(&expected, ask(&f, two, &options, 5000)));
            if (workers < 2) CHECK(is_same(&expected, ask(&f, f.workspace, &options, 5000)));
        }
        CHECK(h.mistakes == 0);
        free(expected.pairs);
        host_stop(&h);
        sc_workspace_free(two);
    }
    stop(&f);
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
    if (scene == 3 || scene == 4) return start_as_it_is(f, mesh);
    return start(f, mesh, scene == 0 ? 4 : 0.5, scene == 1 ? 0.06 : scene == 5 ? 0 : 0.001);
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
            sc_workspace_options o = for_workers(THREADS_MAX);
            sc_workspace *workspace = NULL;
            CHECK(sc_workspace_create_for(f.model, &o, &workspace) == SC_OK);
            for (uint32_t kind = 0; kind < KINDS; ++kind) {
                if (is_left_out(scene, kind)) continue;
                sc_query_options options = question(kind);
                answer all = ask(&f, f.workspace, &options, 100000), shared;
                uint64_t count = all.result.count, counts[] = {count, count + 1000, count / 2, 0};
                host h;
                CHECK(all.status == SC_OK);
                if (scene < 2 && options.contour != SC_CONTOUR_NONE && kind < 2 * METHODS)
                    CHECK_MSG(count > (scene == 0 ? 20 : 4000), "only %u", (unsigned)count);
                host_start(&h, HOST_AT_ONCE, 2);
                options.tasks = &h.tasks;
                shared = ask(&f, workspace, &options, count);
                host_stop(&h);
                for (int way = HOST_FIRST; way < HOST_COUNT; ++way) {
                    host_start(&h, way, 1 + test_random_below(THREADS_MAX));
                    for (int c = 0; c < (way == HOST_THREADS && kind % 3 ? 1 : 4); ++c) {
                        answer serial, other;
                        options.output = c == 1 ? SC_OUTPUT_COUNT : SC_OUTPUT_PAIRS;
                        options.tasks = NULL;
                        serial = ask(&f, f.workspace, &options, counts[c]);
                        options.tasks = &h.tasks;
                        other = ask(&f, workspace, &options, counts[c]);
                        if (c < 2 && h.tasks.workers > 1)
                            CHECK_MSG(is_count_same(&shared, &other), "scene %d, kind %u, host %d",
                                      scene, (unsigned)kind, way);
                        if (c < 2 && options.method != SC_METHOD_SCTT)
                            CHECK(is_other_count_same(&serial, &other));
                        CHECK_MSG(is_same(&serial, other),
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
        stop(&f);
    }
    CHECK(jobs > test_iterations(200));
}

/* Queries that read no clocks, with room and without. */
static void without_statistics(void)
{
    for (int scene = 0; scene < SCENES; ++scene) {
        fixture f;
        if (start_scene(&f, scene)) {
            sc_workspace_options o = for_workers(THREADS_MAX);
            sc_workspace *workspace = NULL;
            CHECK(sc_workspace_create_for(f.model, &o, &workspace) == SC_OK);
            for (uint32_t kind = 0; kind < METHODS; ++kind) {
                if (is_left_out(scene, kind)) continue;
                sc_query_options options = question(kind);
                uint64_t room = 100000;
                for (int c = 0; c < 3; ++c) {
                    answer serial;
                    host h;
                    options.tasks = NULL;
                    serial = ask(&f, f.workspace, &options, room);
                    CHECK(is_same(&serial, ask_with(&f, f.workspace, &options, room, 0)));
                    host_start(&h, c, 2 + test_random_below(THREADS_MAX - 1));
                    options.tasks = &h.tasks;
                    CHECK_MSG(is_same(&serial, ask_with(&f, workspace, &options, room, 0)),
                              "scene %d, kind %u, room for %u", scene, (unsigned)kind,
                              (unsigned)room);
                    CHECK(h.mistakes == 0);
                    host_stop(&h);
                    room = c ? 0 : serial.result.count / 2;
                    free(serial.pairs);
                }
            }
            sc_workspace_free(workspace);
        }
        stop(&f);
    }
}

/* More pairs than the workspace has room for, when they are sorted. */
static void very_many_pairs(void)
{
    fixture f;
    if (start(&f, soup_cloth(32, 32), 0.5, 3)) {
        sc_workspace_options o = for_workers(2);
        sc_workspace *workspace = NULL;
        CHECK(sc_workspace_create_for(f.model, &o, &workspace) == SC_OK);
        for (uint32_t kind = 0; kind < 2 * METHODS; kind += METHODS) {
            sc_query_options options = question(kind);
            answer serial = ask(&f, f.workspace, &options, 1000000), shared;
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
            shared = ask(&f, workspace, &options, 1000000);
            host_stop(&h);
            CHECK(is_same(&serial, shared));
            free(serial.pairs);
        }
        sc_workspace_free(workspace);
    }
    stop(&f);
}

/* Poses of any type and stride; one that is not finite is refused, wherever that is. */
static void any_array_of_positions(void)
{
    fixture f;
    if (start(&f, soup_cloth(80, 80), 4, 0.003)) {
        sc_workspace_options o = for_workers(THREADS_MAX);
        sc_workspace *workspace = NULL;
        sc_query_options options = no_options(), shared = no_options();
        CHECK(sc_workspace_create_for(f.model, &o, &workspace) == SC_OK);
        for (uint32_t i = 0; i < 24; ++i) {
            if (is_left_out(0, i / 4)) continue;
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
            serial = ask(&f, f.workspace, &options, 10000);
            CHECK(serial.status == SC_OK && serial.result.count > 10);
            CHECK(is_same(&serial, ask(&f, workspace, &shared, 10000)));
            free(serial.pairs);
            if (i % 2 == 0) { /* the last coordinate, or any */
                uint32_t v =
                    i % 4 ? f.mesh.vertex_count - 1 : test_random_below(f.mesh.vertex_count);
                const double nan = (double)NAN;
                memcpy(array.data + (size_t)v * (array.stride ? array.stride : 24) + 16, &nan,
                       sizeof(nan));
                refused = ask(&f, workspace, &shared, 10000);
                CHECK(refused.status == SC_ERROR_NOT_FINITE && refused.result.count == 0);
                free(refused.pairs);
            }
            input_free(&array);
            f.pose = plain;
            host_stop(&h);
        }
        sc_workspace_free(workspace);
    }
    stop(&f);
}

/* Whether there is a pair: the answer is known, the pair is not. */
static void any_pair(void)
{
    for (int scene = 0; scene < SCENES; ++scene) {
        fixture f;
        if (start_scene(&f, scene)) {
            sc_workspace_options o = for_workers(THREADS_MAX);
            sc_workspace *workspace = NULL;
            CHECK(sc_workspace_create_for(f.model, &o, &workspace) == SC_OK);
            for (uint32_t i = 0; i < 2 * KINDS; ++i) {
                if (is_left_out(scene, i)) continue;
                sc_query_options options = question(i % KINDS);
                answer serial;
                host h;
                if (i >= KINDS)
                    f.pose.positions = f.mesh.positions; /* without pairs, but in soups */
                options.output = SC_OUTPUT_ANY;
                serial = ask(&f, f.workspace, &options, 0);
                host_start(&h, (int)i % HOST_COUNT, 1 + test_random_below(THREADS_MAX));
                options.tasks = &h.tasks;
                CHECK(is_same(&serial, ask(&f, workspace, &options, 0)));
                CHECK(serial.result.count == serial.result.collides && h.mistakes == 0);
                host_stop(&h);
                free(serial.pairs);
            }
            sc_workspace_free(workspace);
        }
        stop(&f);
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
            sc_workspace_options o = for_workers(THREADS_MAX);
            sc_workspace *workspace = NULL;
            sc_group *groups = (sc_group *)test_allocate(f.mesh.triangle_count * sizeof(sc_group));
            for (uint32_t t = 0; t < f.mesh.triangle_count; ++t) {
                groups[t].category = 1u << t % 3;
                groups[t].mask = t % 5 == 0 ? 1 : 7;
            }
            CHECK(sc_workspace_create_for(f.model, &o, &workspace) == SC_OK);
            for (uint32_t kind = (uint32_t)scene; kind < KINDS; kind += 3)
                for (int part = 0; part < 8; ++part) {
                    if (is_left_out(scene, kind + (uint32_t)part)) continue;
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
                    serial = ask(&f, f.workspace, &options, 100000);
                    capacity = (uint64_t)test_random_below(2) * serial.result.count +
                               test_random_below(2000);
                    if (part == 5) capacity = 0;
                    free(serial.pairs);
                    options.output = kind % 4 == 3 ? SC_OUTPUT_COUNT : SC_OUTPUT_PAIRS;
                    j.calls = 0;
                    serial = ask(&f, f.workspace, &options, capacity);
                    host_start(&h, part % HOST_COUNT, 2 + test_random_below(THREADS_MAX - 1));
                    options.tasks = &h.tasks;
                    CHECK_MSG(is_same(&serial, ask(&f, workspace, &options, capacity)),
                              "scene %d, kind %u, filter %d", scene, (unsigned)kind, part);
                    if (filter.accept) CHECK(j.calls % 2 == 0 && j.mistakes == 0);
                    CHECK(h.mistakes == 0);
                    host_stop(&h);
                    free(serial.pairs);
                }
            sc_workspace_free(workspace);
            free(groups);
        }
        stop(&f);
    }
}

/* What workers that get no further part are left with in the end: pairs within leaf clusters, which
   are looked at last. */
static void what_waits_in_the_end(void)
{
    for (uint32_t trial = 0; trial < test_iterations(10); ++trial) {
        sc_workspace_options o = for_workers(THREADS_MAX);
        sc_query_options options = no_options();
        sc_workspace *workspace = NULL;
        fixture f;
        if (start(&f, soup_cloth(40, 40), 0, 0.004 * (1 + trial))) {
            CHECK(sc_workspace_create_for(f.model, &o, &workspace) == SC_OK);
            for (uint32_t workers = 2; workers <= THREADS_MAX; ++workers) {
                answer serial;
                host h;
                options.tasks = NULL;
                serial = ask_with(&f, f.workspace, &options, 100000, 0);
                host_start(&h, HOST_BACKWARDS, workers);
                options.tasks = &h.tasks;
                CHECK_MSG(is_same(&serial, ask_with(&f, workspace, &options, 100000, 0)),
                          "trial %u, %u workers", (unsigned)trial, (unsigned)workers);
                CHECK(h.mistakes == 0);
                host_stop(&h);
                free(serial.pairs);
            }
            sc_workspace_free(workspace);
        }
        stop(&f);
    }
}

/* Whether the workers of a workspace answer as one does, twice in a row. */
static void check_workers(const fixture *f, sc_workspace *workspace, sc_query_options *options)
{
    answer serial;
    options->tasks = NULL;
    serial = ask(f, f->workspace, options, 100000);
    for (int way = 0; way < 2; ++way) {
        host h;
        host_start(&h, HOST_BACKWARDS, workspace->workers);
        options->tasks = &h.tasks;
        CHECK(is_same(&serial, ask(f, workspace, options, 100000)));
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
        sc_workspace_options o = for_workers(3);
        sc_query_options options = no_options();
        sc_workspace *workspace = NULL;
        fixture f;
        if (start(&f, soup_cloth(40, 40), 0.5, 0.03)) {
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
            CHECK(workspace->pose_tick == 2);
            workspace->pose_tick = 0x7fffffff;
            soup_twist(f.posed, f.mesh.vertex_count, 2);
            soup_noise(f.posed, f.mesh.vertex_count, 0.1);
            check_workers(&f, workspace, &options);
            CHECK(workspace->pose_tick == 2);
            sc_workspace_free(workspace);
        }
        stop(&f);
    }
}

/* A budget ends a query at the same place, and a flag that is set before ends it at once. */
static void stopped_early(void)
{
    static const uint32_t flag = 1;
    for (int scene = 0; scene < 2; ++scene) {
        fixture f;
        if (start_scene(&f, scene)) {
            sc_workspace_options o = for_workers(THREADS_MAX);
            sc_workspace *workspace = NULL;
            CHECK(sc_workspace_create_for(f.model, &o, &workspace) == SC_OK);
            for (uint32_t kind = 0; kind < KINDS; ++kind) {
                if (is_left_out(scene, kind)) continue;
                sc_query_options options = question(kind);
                answer serial;
                host h;
                host_start(&h, (int)kind % HOST_COUNT, 2 + test_random_below(THREADS_MAX - 1));
                options.budget = 1 + test_random_below(30000);
                serial = ask(&f, f.workspace, &options, 10000);
                options.tasks = &h.tasks;
                CHECK(is_same(&serial, ask(&f, workspace, &options, 10000)));
                free(serial.pairs);
                options.budget = 0;
                options.cancel = &flag;
                serial = ask(&f, workspace, &options, 10000);
                CHECK(serial.status == SC_ERROR_INCOMPLETE && serial.result.count == 0 &&
                      serial.result.verdict == SC_VERDICT_INCOMPLETE);
                free(serial.pairs);
                host_stop(&h);
            }
            sc_workspace_free(workspace);
        }
        stop(&f);
    }
}

/* A host that sets the flag after some parts. */
typedef struct breaker {
    sc_tasks tasks;
    volatile uint32_t flag;
    uint32_t left; /* parts */
} breaker;

static void *breaker_enqueue(void *user, void (*run)(void *context, uint32_t part, uint32_t worker),
                             void *context, uint32_t count)
{
    breaker *b = (breaker *)user;
    for (uint32_t part = 0; part < count; ++part) {
        if (b->left > 0 && --b->left == 0) b->flag = 1;
        run(context, part, part % b->tasks.workers);
    }
    return NULL;
}

static void breaker_finish(void *user, void *task)
{
    (void)user;
    (void)task;
}

/* Whether a pair is in a sorted list. */
static int is_among(sc_pair pair, const sc_pair *pairs, uint64_t count)
{
    uint64_t low = 0, high = count;
    while (low < high) {
        uint64_t middle = low + (high - low) / 2;
        if (pairs[middle].a < pair.a || (pairs[middle].a == pair.a && pairs[middle].b < pair.b))
            low = middle + 1;
        else
            high = middle;
    }
    return low < count && pairs[low].a == pair.a && pairs[low].b == pair.b;
}

/* What was found when the flag was set is delivered, sorted, and is right. */
static void stop_on_the_way(int scene, uint32_t rounds)
{
    fixture f;
    if (start_scene(&f, scene)) {
        sc_workspace_options o = for_workers(3);
        sc_workspace *workspace = NULL;
        uint32_t incomplete = 0, some = 0, parts;
        CHECK(sc_workspace_create_for(f.model, &o, &workspace) == SC_OK);
        for (uint32_t i = 0; i < rounds; ++i) {
            sc_query_options options = question(i % 3 * 2);
            answer all, part;
            breaker b;
            memset(&b, 0, sizeof(b));
            b.tasks.struct_size = sizeof(b.tasks);
            b.tasks.workers = 3;
            b.tasks.enqueue = breaker_enqueue;
            b.tasks.finish = breaker_finish;
            b.tasks.user = &b;
            all = ask(&f, f.workspace, &options, 100000);
            options.tasks = &b.tasks;
            b.left = UINT32_MAX;
            CHECK(is_same(&all, ask(&f, workspace, &options, 100000)));
            parts = UINT32_MAX - b.left;
            /* at any time, or late: what little there is, is found in the end */
            b.left = i % 2 ? 1 + test_random_below(parts) : parts - test_random_below(12);
            options.cancel = &b.flag;
            part = ask(&f, workspace, &options, 100000);
            if (b.flag && part.status == SC_ERROR_INCOMPLETE) {
                ++incomplete;
                some += part.result.count > 0;
                CHECK(part.result.verdict == SC_VERDICT_INCOMPLETE &&
                      part.result.count <= all.result.count);
                for (uint64_t k = 0; k < part.result.count; ++k)
                    CHECK(is_among(part.pairs[k], all.pairs, all.result.count) &&
                          (!k || part.pairs[k - 1].a < part.pairs[k].a ||
                           (part.pairs[k - 1].a == part.pairs[k].a &&
                            part.pairs[k - 1].b < part.pairs[k].b)));
                free(part.pairs);
            } else {
                CHECK(is_same(&all, part));
            }
            options.cancel = NULL;
            CHECK(is_same(&all, ask(&f, workspace, &options, 100000)));
            free(all.pairs);
        }
        CHECK_MSG(incomplete > rounds / 6 && (some > 5 || scene > 1), "%u stopped, %u with pairs",
                  incomplete, some);
        sc_workspace_free(workspace);
    }
    stop(&f);
}

static void stopped_on_the_way(void)
{
    stop_on_the_way(1, 60);
    stop_on_the_way(4, 20); /* most waits until all else is done */
    stop_on_the_way(5, 60); /* and here contour tests are a job */
}

/* ---- trees that are not balanced ---- */

/* A leaf for each triangle: halves of halves, whose nodes are added behind others. */
static uint32_t add_balanced(sc_tree_node *tree, uint32_t *count, uint32_t first, uint32_t end)
{
    const uint32_t node = (*count)++, middle = first + (end - first) / 2;
    const sc_tree_node leaf = {SC_NONE, SC_NONE, first, 1};
    tree[node] = leaf;
    if (end - first > 1) {
        tree[node].left = add_balanced(tree, count, first, middle);
        tree[node].right = add_balanced(tree, count, middle, end);
    }
    return node;
}

/* One that loses a leaf at each of so many nodes, and then is balanced. */
static uint32_t add_chain(sc_tree_node *tree, uint32_t *count, uint32_t first, uint32_t end,
                          uint32_t length)
{
    uint32_t node;
    if (!length) return add_balanced(tree, count, first, end);
    node = (*count)++;
    tree[node].left = add_balanced(tree, count, first, first + 1);
    tree[node].right = add_chain(tree, count, first + 1, end, length - 1);
    return node;
}

/* So many equal parts, each with its first triangles in a chain and the others balanced. */
static uint32_t add_parts(sc_tree_node *tree, uint32_t *count, uint32_t first, uint32_t end,
                          uint32_t parts, uint32_t chained, uint32_t length)
{
    const uint32_t node = (*count)++, middle = first + (end - first) / 2;
    if (parts == 1) {
        tree[node].left = add_chain(tree, count, first, first + chained, length);
        tree[node].right = add_balanced(tree, count, first + chained, end);
    } else {
        tree[node].left = add_parts(tree, count, first, middle, parts / 2, chained, length);
        tree[node].right = add_parts(tree, count, middle, end, parts / 2, chained, length);
    }
    return node;
}

/* The model of a mesh by a tree: leaves of one triangle, balanced; but of the first triangles of
   each part, if so many are chained, each of so many nodes loses one. */
static int start_tree(fixture *f, soup mesh, uint32_t parts, uint32_t chained, uint32_t length)
{
    const uint32_t count = mesh.triangle_count;
    sc_tree_node *tree = (sc_tree_node *)test_allocate(2 * count * sizeof(sc_tree_node));
    uint32_t *order = (uint32_t *)test_allocate(count * sizeof(uint32_t)), used = 0;
    sc_mesh input = input_plain_mesh(&mesh);
    sc_build_options options;
    sc_status status;
    for (uint32_t t = 0; t < count; ++t) order[t] = t;
    if (chained)
        add_parts(tree, &used, 0, count, parts, chained, length);
    else
        add_balanced(tree, &used, 0, count);
    memset(&options, 0, sizeof(options));
    options.struct_size = sizeof(options);
    options.partition = SC_PARTITION_TREE;
    options.order = order;
    options.tree = tree;
    options.tree_count = used;
    memset(f, 0, sizeof(*f));
    f->mesh = mesh;
    f->posed = (double *)test_allocate(3 * (size_t)mesh.vertex_count * sizeof(double));
    memcpy(f->posed, mesh.positions, 3 * (size_t)mesh.vertex_count * sizeof(double));
    f->pose = input_plain_pose(f->posed, mesh.vertex_count);
    status = sc_build(&input, &options, &f->model);
    free(tree);
    free(order);
    return CHECK(status == SC_OK) &&
           CHECK(sc_workspace_create(f->model, NULL, &f->workspace) == SC_OK);
}

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
   others none; one of very many leaf clusters; one of large patches that have more neighbors
   with which they wait for a contour test than the list has room for; and a spiral of which one half
   is flat, where contours cross, and the other one crumpled, again with more parts. */
static int start_tree_scene(fixture *f, int scene)
{
    if (scene == 5) {
        if (!start_tree(f, shape_spiral(90, 7, 3, 0), 1, 600, 30)) return 0;
        for (uint32_t v = 0; v < f->mesh.vertex_count; ++v)
            if (f->posed[3 * v] > 0) f->posed[3 * v + 2] += test_random_range(-0.1, 0.1);
        return 1;
    }
    if (scene == 4) return start_tree(f, strips_with_flags(), STRIPS, STRIP, DOWN);
    if (scene == 2) return start_tree(f, crumpled_fan(640), 1, 0, 0);
    if (scene == 3) {
        if (!start_tree(f, soup_cloth(47, 47), 1, 0, 0)) return 0;
        soup_smooth(f->posed, f->mesh.vertex_count, 0.1);
        soup_twist(f->posed, f->mesh.vertex_count, 2);
        return 1;
    }
    return start_tree(f, pile(scene ? 600 : 500), 1, 240, 40);
}

static void by_trees(void)
{
    for (int scene = 0; scene < TREES; ++scene) {
        fixture f;
        if (start_tree_scene(&f, scene)) {
            sc_workspace_options o = for_workers(THREADS_MAX);
            sc_workspace *workspace = NULL;
            CHECK(sc_workspace_create_for(f.model, &o, &workspace) == SC_OK);
            for (uint32_t kind = 0; kind < METHODS; ++kind) {
                if (is_left_out(scene, kind)) continue;
                sc_query_options options = question(kind);
                answer serial = ask(&f, f.workspace, &options, 200000), shared, other;
                host h;
                CHECK(serial.status == SC_OK);
                if (scene != 3 && options.contour != SC_CONTOUR_NONE)
                    CHECK_MSG(serial.result.count > 1000, "%u", (unsigned)serial.result.count);
                host_start(&h, HOST_AT_ONCE, 2);
                options.tasks = &h.tasks;
                shared = ask(&f, workspace, &options, 200000);
                host_stop(&h);
                for (int round = 0; round < (scene == 5 && !kind ? 20 : 1); ++round) {
                    const uint32_t more = test_random_below(THREADS_MAX - 1);
                    host_start(&h, 1 + (int)kind % 2, 2 + (scene == 5 ? more % 3 : more));
                    other = ask(&f, workspace, &options, 200000);
                    CHECK(h.mistakes == 0 && h.jobs > 0);
                    host_stop(&h);
                    CHECK(is_count_same(&shared, &other));
                    CHECK_MSG(is_same(&serial, other), "scene %d, kind %u", scene, (unsigned)kind);
                }
                CHECK_MSG(is_same(&serial, shared), "scene %d, kind %u", scene, (unsigned)kind);
                free(serial.pairs);
            }
            sc_workspace_free(workspace);
        }
        stop(&f);
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
        if (start_tree(&f, soup_cloth(side, side), 1, 0, 0)) {
            sc_workspace_options o = for_workers(THREADS_MAX);
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
                shared = ask(&f, workspace, &options, 200000);
                host_stop(&h);
                free(shared.pairs);
                if (workers == 2) two = shared;
                CHECK_MSG(is_count_same(&two, &shared), "mesh %u, %u workers", (unsigned)i,
                          (unsigned)workers);
            }
            sc_workspace_free(workspace);
        }
        stop(&f);
    }
}

/* ---- steps ---- */

/* A step of a fixture, whose posed is the start. */
typedef struct step_fixture {
    fixture f;
    double *ended;
    sc_pose end;
    sc_workspace *serial, *shared; /* for one worker, and for THREADS_MAX */
} step_fixture;

enum { STEP_SCENES = 8, STEP_METHODS = 5, STEP_KINDS = STEP_METHODS * 2 * 3 };

/* Layers that pass each other; a cloth that waves and folds; pieces; contours that cross; a
   crumpled sphere; two triangles; a cloth of a triangle in each leaf cluster, of which a level has
   many; another one by an uneven tree, in which such a level has a large patch besides. */
static int start_step(step_fixture *s, int scene)
{
    soup mesh = scene == 0   ? soup_cloth(33, 33)
                : scene == 1 ? soup_cloth(33, 33)
                : scene == 2 ? soup_many(60)
                : scene == 3 ? soup_branched(64, 17)
                : scene == 4 ? soup_sphere(36, 36)
                : scene == 5 ? soup_cloth(2, 1)
                : scene == 6 ? soup_cloth(18, 18)
                             : soup_cloth(25, 25);
    size_t bytes = 3 * (size_t)mesh.vertex_count * sizeof(double);
    sc_workspace_options o = for_workers(1);
    memset(s, 0, sizeof(*s));
    if (!(scene < 6    ? start_as_it_is(&s->f, mesh)
          : scene == 6 ? start_tree(&s->f, mesh, 1, 0, 0)
                       : start_tree(&s->f, mesh, 1, 600, 20)))
        return 0;
    if (scene != 3) soup_smooth(s->f.posed, mesh.vertex_count, 0.05);
    if (scene == 0) soup_twist(s->f.posed, mesh.vertex_count, 3);
    s->ended = (double *)test_allocate(bytes);
    memcpy(s->ended, s->f.posed, bytes);
    soup_smooth(s->ended, mesh.vertex_count, scene == 0 ? 0.4 : scene == 3 ? 0.01 : 0.1);
    if (scene == 0) soup_twist(s->ended, mesh.vertex_count, 0.3);
    if (scene == 1 || scene > 5) soup_fold(s->ended, mesh.vertex_count);
    if (scene == 4) soup_noise(s->ended, mesh.vertex_count, 0.03);
    s->end = input_plain_pose(s->ended, mesh.vertex_count);
    o.flags = SC_WORKSPACE_STEP;
    if (!CHECK(sc_workspace_create_for(s->f.model, &o, &s->serial) == SC_OK)) return 0;
    o.workers = THREADS_MAX;
    return CHECK(sc_workspace_create_for(s->f.model, &o, &s->shared) == SC_OK);
}

static void stop_step(step_fixture *s)
{
    sc_workspace_free(s->serial);
    sc_workspace_free(s->shared);
    free(s->ended);
    stop(&s->f);
}

/* Methods by what is reported by times. */
static sc_step_options step_question(uint32_t kind)
{
    static const uint32_t methods[STEP_METHODS][2] = {{SC_STEP_METHOD_SCTT, SC_CONTOUR_EXACT},
                                                      {SC_STEP_METHOD_SCTT, SC_CONTOUR_STAR},
                                                      {SC_STEP_METHOD_SCTT, SC_CONTOUR_NONE},
                                                      {SC_STEP_METHOD_TWO_BOXES, 0},
                                                      {SC_STEP_METHOD_SWEPT, 0}};
    sc_step_options options;
    memset(&options, 0, sizeof(options));
    options.struct_size = sizeof(options);
    options.method = methods[kind % STEP_METHODS][0];
    options.contour = methods[kind % STEP_METHODS][1];
    options.pairs = kind / STEP_METHODS % 2;
    options.times = kind / STEP_METHODS / 2;
    options.separation = kind % 3 == 1 ? 0.001 : 0;
    return options;
}

/* What the query of a step says; lists of vertex-face and edge-edge pairs, with times. */
typedef struct step_answer {
    sc_status status;
    sc_step_result result;
    sc_stats stats;
    uint64_t capacity[2], count[2];
    sc_pair *pairs[2];
    double *times[2];
} step_answer;

static step_answer ask_step(const step_fixture *s, sc_workspace *workspace,
                            const sc_step_options *options, uint64_t vertex_faces,
                            uint64_t edge_edges)
{
    step_answer a;
    memset(&a, 0, sizeof(a));
    a.capacity[0] = vertex_faces;
    a.capacity[1] = edge_edges;
    for (int k = 0; k < 2; ++k) {
        a.pairs[k] = (sc_pair *)test_allocate((a.capacity[k] + 1) * sizeof(sc_pair));
        a.times[k] = (double *)test_allocate((a.capacity[k] + 1) * sizeof(double));
        memset(a.pairs[k], 0xab, (a.capacity[k] + 1) * sizeof(sc_pair));
        memset(a.times[k], 0xab, (a.capacity[k] + 1) * sizeof(double));
    }
    a.stats.struct_size = sizeof(a.stats);
    a.result.struct_size = sizeof(a.result);
    a.result.vertex_face_capacity = vertex_faces;
    a.result.vertex_faces = a.pairs[0];
    a.result.vertex_face_times = a.times[0];
    a.result.edge_edge_capacity = edge_edges;
    a.result.edge_edges = a.pairs[1];
    a.result.edge_edge_times = a.times[1];
    a.result.stats = &a.stats;
    a.status = sc_query_step(s->f.model, workspace, &s->f.pose, &s->end, options, &a.result);
    a.count[0] = a.result.vertex_face_count;
    a.count[1] = a.result.edge_edge_count;
    for (int k = 0; k < 2; ++k) {
        uint32_t last[2];
        memcpy(last, &a.times[k][a.capacity[k]], sizeof(last));
        CHECK(a.pairs[k][a.capacity[k]].a == 0xabababab && last[0] == 0xabababab &&
              last[1] == 0xabababab);
    }
    return a;
}

static void free_step_answer(step_answer *a)
{
    for (int k = 0; k < 2; ++k) {
        free(a->pairs[k]);
        free(a->times[k]);
    }
}

/* Whether two answers are the same, with all that was written; frees b. */
static int is_same_step(const step_answer *a, step_answer b)
{
    int same = a->status == b.status && a->count[0] == b.count[0] && a->count[1] == b.count[1] &&
               a->result.collides == b.result.collides && a->result.verdict == b.result.verdict &&
               memcmp(&a->result.earliest, &b.result.earliest, sizeof(double)) == 0;
    for (int k = 0; k < 2; ++k) {
        uint64_t filled = a->count[k] < a->capacity[k] ? a->count[k] : a->capacity[k];
        same &= memcmp(a->pairs[k], b.pairs[k], (size_t)filled * sizeof(sc_pair)) == 0 &&
                memcmp(a->times[k], b.times[k], (size_t)filled * sizeof(double)) == 0;
    }
    free_step_answer(&b);
    return same;
}

static int is_step_count_same(const step_answer *a, const step_answer *b)
{
    return memcmp(a->stats.counts, b->stats.counts, sizeof(a->stats.counts)) == 0 &&
           a->stats.nodes_visited == b->stats.nodes_visited &&
           a->stats.nodes_oriented == b->stats.nodes_oriented &&
           a->stats.nodes_culled == b->stats.nodes_culled &&
           a->stats.leaf_pairs == b->stats.leaf_pairs;
}

/* A scene drawn anew until it has pairs to compare; the two triangles have none. */
static int start_colliding_step(step_fixture *s, int scene)
{
    for (int tries = 0; tries < 40; ++tries) {
        step_answer all;
        sc_step_options options = step_question(0);
        uint64_t count;
        options.output = SC_OUTPUT_COUNT;
        if (!start_step(s, scene)) return 0;
        all = ask_step(s, s->serial, &options, 0, 0);
        count = all.count[0] + all.count[1];
        free_step_answer(&all);
        if (scene == 5 || count > 20) return 1;
        stop_step(s);
    }
    CHECK_MSG(0, "scene %d: hardly any pairs", scene);
    return 0;
}

/* Each method, kind of pair, output, kind of time and length of the lists, by each host: the same
   list, times and counts as by one thread. */
static void steps_the_same(void)
{
    uint64_t jobs = 0, culled = 0;
    for (int scene = 0; scene < STEP_SCENES; ++scene) {
        step_fixture s;
        if (start_colliding_step(&s, scene))
            for (uint32_t kind = 0; kind < STEP_KINDS;
                 kind += scene < 2 && kind >= STEP_METHODS ? 3 : 1) {
                if (is_left_out(scene, kind)) continue;
                sc_step_options options = step_question(kind);
                step_answer all;
                uint64_t v, e;
                host h;
                options.output = SC_OUTPUT_COUNT;
                all = ask_step(&s, s.serial, &options, 0, 0);
                v = all.count[0];
                e = all.count[1];
                CHECK(all.status == SC_OK);
                culled += all.stats.nodes_culled;
                if (scene < 5 && options.contour != SC_CONTOUR_NONE && kind < STEP_METHODS)
                    CHECK_MSG(v + e > 20, "scene %d: %u pairs", scene, (unsigned)(v + e));
                host_start(&h, (int)(kind + (uint32_t)scene) % HOST_COUNT,
                           1 + test_random_below(THREADS_MAX));
                options.tasks = &h.tasks;
                CHECK(is_same_step(&all, ask_step(&s, s.shared, &options, 0, 0)));
                options.output = SC_OUTPUT_PAIRS;
                for (int c = 0; c < ((kind + (uint32_t)scene) % 3 ? 1 : 3); ++c) {
                    const uint64_t room[3][2] = {{v, e}, {v + 1000, e + 300}, {v / 2, e}};
                    step_answer serial, other;
                    options.tasks = NULL;
                    serial = ask_step(&s, s.serial, &options, room[c][0], room[c][1]);
                    options.tasks = &h.tasks;
                    other = ask_step(&s, s.shared, &options, room[c][0], room[c][1]);
                    CHECK_MSG(is_step_count_same(&serial, &other),
                              "scene %d, kind %u, host %d: counts", scene, (unsigned)kind, h.way);
                    CHECK_MSG(is_same_step(&serial, other), "scene %d, kind %u, host %d, room %d",
                              scene, (unsigned)kind, h.way, c);
                    free_step_answer(&serial);
                }
                CHECK(h.mistakes == 0 && !h.is_busy);
                jobs += h.jobs;
                host_stop(&h);
                free_step_answer(&all);
            }
        stop_step(&s);
    }
    CHECK_MSG(jobs > test_iterations(500) && culled > test_iterations(200),
              "%u jobs, %u nodes culled", (unsigned)jobs, (unsigned)culled);
}

/* Steps that read no clocks and have no arrays for times, by one thread and by several: the same
   lists. */
static void steps_without_statistics(void)
{
    for (int scene = 0; scene < STEP_SCENES; ++scene) {
        step_fixture s;
        if (start_step(&s, scene))
            for (uint32_t kind = (uint32_t)scene; kind < 4 * STEP_METHODS; kind += 3) {
                if (is_left_out(scene, kind)) continue;
                sc_step_options options = step_question(kind);
                uint64_t room = kind % 3 ? 40000 : 10;
                step_answer all;
                if (kind % 7 == 6) options.budget = 3000;
                all = ask_step(&s, s.serial, &options, room, room);
                for (int way = -1; way < 1; ++way) {
                    step_answer plain = all;
                    host h;
                    host_start(&h, (int)kind % HOST_COUNT, 2 + test_random_below(THREADS_MAX - 1));
                    options.tasks = way < 0 ? NULL : &h.tasks;
                    plain.result.stats = NULL;
                    plain.result.vertex_face_times = plain.result.edge_edge_times = NULL;
                    for (int k = 0; k < 2; ++k)
                        plain.pairs[k] = (sc_pair *)test_allocate(room * sizeof(sc_pair));
                    plain.result.vertex_faces = plain.pairs[0];
                    plain.result.edge_edges = plain.pairs[1];
                    CHECK(sc_query_step(s.f.model, way < 0 ? s.serial : s.shared, &s.f.pose, &s.end,
                                        &options, &plain.result) == all.status);
                    CHECK(plain.result.earliest == all.result.earliest &&
                          plain.result.vertex_face_count == all.count[0] &&
                          plain.result.edge_edge_count == all.count[1]);
                    for (int k = 0; k < 2; ++k) {
                        uint64_t filled = all.count[k] < room ? all.count[k] : room;
                        CHECK_MSG(memcmp(plain.pairs[k], all.pairs[k], filled * sizeof(sc_pair)) ==
                                      0,
                                  "scene %d, kind %u, host %d", scene, (unsigned)kind, way);
                        free(plain.pairs[k]);
                    }
                    host_stop(&h);
                }
                free_step_answer(&all);
            }
        stop_step(&s);
    }
}

/* One list, or both, too short or left out. */
static void steps_in_short_lists(void)
{
    step_fixture s;
    if (start_step(&s, 3)) {
        sc_step_options options = step_question(2 * 2 * STEP_METHODS);
        step_answer all = ask_step(&s, s.serial, &options, 0, 0);
        CHECK(all.status == SC_ERROR_SHORT_BUFFER && all.count[0] > 600 && all.count[1] > 600);
        for (uint32_t i = 0; i < 24; ++i) {
            if (is_left_out(0, i / 2)) continue;
            uint64_t room[2];
            step_answer serial;
            host h;
            for (uint32_t k = 0; k < 2; ++k)
                room[k] = i >> k & 1         ? test_random_below((uint32_t)all.count[k] + 600)
                          : i >> (k + 2) & 1 ? 0
                                             : all.count[k];
            host_start(&h, (int)i % HOST_COUNT, 2 + test_random_below(THREADS_MAX - 1));
            options.tasks = NULL;
            options.times = i % 3;
            serial = ask_step(&s, s.serial, &options, room[0], room[1]);
            options.tasks = &h.tasks;
            CHECK_MSG(is_same_step(&serial, ask_step(&s, s.shared, &options, room[0], room[1])),
                      "room for %u and %u", (unsigned)room[0], (unsigned)room[1]);
            CHECK(h.mistakes == 0 && h.jobs > 0);
            free_step_answer(&serial);
            host_stop(&h);
        }
        free_step_answer(&all);
    }
    stop_step(&s);
}

/* Whether there is a pair at all: which one is found first, and so of which kind it is, is left
   open. */
static void any_pair_of_a_step(void)
{
    for (int scene = 0; scene < STEP_SCENES; ++scene) {
        step_fixture s;
        if (start_step(&s, scene))
            for (uint32_t i = (uint32_t)scene % 2; i < 2 * STEP_KINDS; i += 2) {
                if (is_left_out(scene, i)) continue;
                sc_step_options options = step_question(i % STEP_KINDS);
                step_answer serial, other;
                host h;
                if (i >= STEP_KINDS)
                    s.f.pose.positions = s.end.positions = s.f.mesh.positions; /* at rest */
                options.output = SC_OUTPUT_ANY;
                serial = ask_step(&s, s.serial, &options, 0, 0);
                host_start(&h, (int)i % HOST_COUNT, 1 + test_random_below(THREADS_MAX));
                options.tasks = &h.tasks;
                other = ask_step(&s, s.shared, &options, 0, 0);
                CHECK(serial.status == SC_OK && other.status == SC_OK && h.mistakes == 0);
                CHECK(other.count[0] + other.count[1] == other.result.collides);
                CHECK(serial.result.collides == other.result.collides &&
                      serial.result.verdict == other.result.verdict &&
                      serial.result.earliest == other.result.earliest);
                host_stop(&h);
                free_step_answer(&serial);
                free_step_answer(&other);
            }
        stop_step(&s);
    }
}

/* Poses of any type and stride; one that is not finite is refused, wherever that is. */
static void any_positions_of_a_step(void)
{
    step_fixture s;
    if (start_step(&s, 1)) {
        sc_pose plain[2] = {s.f.pose, s.end};
        for (uint32_t i = 0; i < 16; ++i) {
            if (is_left_out(0, i / 2)) continue;
            uint32_t count = s.f.mesh.vertex_count;
            input_array array[2];
            sc_step_options options = step_question(i % (2 * STEP_METHODS));
            step_answer serial, refused;
            host h;
            host_start(&h, (int)i % HOST_COUNT, 2 + test_random_below(THREADS_MAX - 1));
            for (uint32_t k = 0; k < 2; ++k)
                array[k] = input_positions(k ? s.ended : s.f.posed, count,
                                           (i >> k & 1) != 0 ? SC_FLOAT : SC_DOUBLE,
                                           (i >> (k + 1) & 1) != 0 ? 0 : 1 + test_random_below(20));
            s.f.pose = input_pose(count, &array[0]);
            s.end = input_pose(count, &array[1]);
            serial = ask_step(&s, s.serial, &options, 3000, 9000);
            CHECK(serial.status == SC_OK || serial.status == SC_ERROR_SHORT_BUFFER);
            options.tasks = &h.tasks;
            CHECK(is_same_step(&serial, ask_step(&s, s.shared, &options, 3000, 9000)));
            free_step_answer(&serial);
            for (uint32_t k = 0; k < 2; ++k)
                if (!(i >> k & 1)) { /* the last coordinate, or any */
                    uint32_t v = i % 3 ? count - 1 : test_random_below(count);
                    const double nan = i % 5 ? (double)NAN : (double)INFINITY;
                    memcpy(array[k].data + (size_t)v * (array[k].stride ? array[k].stride : 24) +
                               16,
                           &nan, sizeof(nan));
                    refused = ask_step(&s, s.shared, &options, 3000, 9000);
                    CHECK(refused.status == SC_ERROR_NOT_FINITE && refused.count[0] == 0 &&
                          refused.count[1] == 0 && refused.pairs[0][0].a == 0xabababab);
                    free_step_answer(&refused);
                }
            for (uint32_t k = 0; k < 2; ++k) input_free(&array[k]);
            host_stop(&h);
        }
        s.f.pose = plain[0];
        s.end = plain[1];
    }
    stop_step(&s);
}

/* A budget ends a step at the same place, and a flag that is set before ends it at once. */
static void steps_stopped_early(void)
{
    static const uint32_t flag = 1;
    for (int scene = 0; scene < 5; scene += 4) {
        step_fixture s;
        if (start_step(&s, scene))
            for (uint32_t kind = 0; kind < STEP_KINDS; ++kind) {
                if (is_left_out(scene, kind)) continue;
                sc_step_options options = step_question(kind);
                step_answer serial;
                host h;
                host_start(&h, (int)kind % HOST_COUNT, 2 + test_random_below(THREADS_MAX - 1));
                options.budget = 1 + test_random_below(20000);
                serial = ask_step(&s, s.serial, &options, 10000, 10000);
                options.tasks = &h.tasks;
                CHECK(is_same_step(&serial, ask_step(&s, s.shared, &options, 10000, 10000)));
                free_step_answer(&serial);
                options.budget = 0;
                options.cancel = &flag;
                serial = ask_step(&s, s.shared, &options, 10, 10);
                CHECK(serial.status == SC_ERROR_INCOMPLETE && serial.count[0] == 0 &&
                      serial.count[1] == 0 && serial.result.verdict == SC_VERDICT_INCOMPLETE);
                free_step_answer(&serial);
                host_stop(&h);
            }
        stop_step(&s);
    }
}

/* What was found when the flag was set is delivered, sorted, and is right. */
static void steps_stopped_on_the_way(void)
{
    step_fixture s;
    if (start_step(&s, 4)) {
        uint32_t incomplete = 0, some = 0;
        for (uint32_t i = 0; i < 40; ++i) {
            sc_step_options options = step_question(i % 4 * STEP_METHODS + i % 2 * 3);
            step_answer all = ask_step(&s, s.serial, &options, 40000, 40000), part;
            breaker b;
            memset(&b, 0, sizeof(b));
            b.tasks.struct_size = sizeof(b.tasks);
            b.tasks.workers = 3;
            b.tasks.enqueue = breaker_enqueue;
            b.tasks.finish = breaker_finish;
            b.tasks.user = &b;
            b.left = 1 + test_random_below(i % 4 == 3 ? 12 : 300); /* or before there are boxes */
            options.tasks = &b.tasks;
            options.cancel = &b.flag;
            part = ask_step(&s, s.shared, &options, 40000, 40000);
            if (b.flag && part.status == SC_ERROR_INCOMPLETE) {
                ++incomplete;
                some += part.count[0] + part.count[1] > 0;
                CHECK(part.result.verdict == SC_VERDICT_INCOMPLETE && part.result.earliest == 0);
                for (int k = 0; k < 2 && all.status == SC_OK; ++k) {
                    CHECK(part.count[k] <= all.count[k]);
                    for (uint64_t j = 0; j < part.count[k]; ++j)
                        CHECK(is_among(part.pairs[k][j], all.pairs[k], all.count[k]) &&
                              (!j || part.pairs[k][j - 1].a < part.pairs[k][j].a ||
                               (part.pairs[k][j - 1].a == part.pairs[k][j].a &&
                                part.pairs[k][j - 1].b < part.pairs[k][j].b)));
                }
                free_step_answer(&part);
            } else {
                CHECK(is_same_step(&all, part));
            }
            options.cancel = NULL;
            CHECK(is_same_step(&all, ask_step(&s, s.shared, &options, 40000, 40000)));
            free_step_answer(&all);
        }
        CHECK_MSG(incomplete > 10 && some > 5, "%u stopped, %u with pairs", incomplete, some);
    }
    stop_step(&s);
}

SC_TEST_MAIN(SC_TEST(workspaces_for_workers), SC_TEST(workspaces_refused), SC_TEST(tasks_refused),
             SC_TEST(the_same_answers), SC_TEST(without_statistics), SC_TEST(very_many_pairs),
             SC_TEST(any_array_of_positions), SC_TEST(any_pair), SC_TEST(filters),
             SC_TEST(what_waits_in_the_end), SC_TEST(ticks_of_workers), SC_TEST(stopped_early),
             SC_TEST(stopped_on_the_way), SC_TEST(by_trees), SC_TEST(in_any_company),
             SC_TEST(steps_the_same), SC_TEST(steps_without_statistics),
             SC_TEST(steps_in_short_lists), SC_TEST(any_pair_of_a_step),
             SC_TEST(any_positions_of_a_step), SC_TEST(steps_stopped_early),
             SC_TEST(steps_stopped_on_the_way))
