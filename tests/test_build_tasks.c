/*
 * Building by the host's threads: the model is the same, byte for byte, whoever runs the parts of
 * the work and in whatever order, in as much memory; and what is refused.
 *
 * SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "harness.h"
#include "inputs.h"
#include "saved_models.h"
#include "shapes.h"
#include "soups.h"
#include "starcontour.h"
#include "tasks.h"

/* Memory that a build may take more of with several threads, whatever the mesh: lists of their
   parts. */
enum { MORE_BYTES = 1 << 16 };

enum { MESSAGE = 200 };

static sc_model_info info_of(const sc_model *model)
{
    sc_model_info info;
    memset(&info, 0, sizeof(info));
    info.struct_size = sizeof(info);
    CHECK(sc_model_get_info(model, &info) == SC_OK);
    return info;
}

/* Builds by some kinds of hosts, first to last, by so many workers, and compares with one
   thread. */
static void check_hosts(const soup *mesh, uint32_t weld, uint32_t partition, uint32_t content,
                        uint32_t workers, int first, int last, const char *name)
{
    const sc_mesh input = input_plain_mesh(mesh);
    input_choices choices = input_choose(mesh, weld, partition);
    sc_model *model = NULL;
    choices.options.content = content;
    choices.options.bisect_user = NULL; /* no random cuts, so that all builds have the same */
    if (content == SC_MODEL_BOXES) choices.options.rest = SC_REST_UNMARKED;
    if (!CHECK(sc_build(&input, &choices.options, &model) == SC_OK)) return;
    saved_model expected = saved_model_of(model);
    const uint64_t peak = info_of(model).peak_bytes;
    sc_model_free(model);
    for (int way = first; way <= last; ++way) {
        host h;
        saved_model saved;
        host_start(&h, way, workers);
        choices.options.tasks = &h.tasks;
        if (!CHECK(sc_build(&input, &choices.options, &model) == SC_OK)) break;
        CHECK(h.mistakes == 0 && !h.is_busy);
        CHECK_MSG(info_of(model).peak_bytes <= peak + MORE_BYTES,
                  "%s: %llu bytes by %u workers, %llu by one thread", name,
                  (unsigned long long)info_of(model).peak_bytes, workers, (unsigned long long)peak);
        saved = saved_model_of(model);
        CHECK_MSG(saved.size == expected.size &&
                      memcmp(saved.data, expected.data, (size_t)saved.size) == 0,
                  "%s: weld %u, partition %u, content %u, %u workers, host %d", name, weld,
                  partition, content, workers, way);
        free(saved.memory);
        sc_model_free(model);
        host_stop(&h);
    }
    free(expected.memory);
    input_free_choices(&choices);
}

/* By every kind. */
static void check_build(const soup *mesh, uint32_t weld, uint32_t partition, uint32_t content,
                        uint32_t workers, const char *name)
{
    check_hosts(mesh, weld, partition, content, workers, HOST_FIRST, HOST_COUNT - 1, name);
}

static void any_mesh(void)
{
    const uint32_t trials = test_iterations(150);
    for (uint32_t i = 0; i < trials; ++i) {
        const char *name;
        soup s = shape_any(20 + test_random_below(3000), &name);
        check_build(&s, test_random_below(3), test_random_below(4), test_random_below(2),
                    2 + test_random_below(THREADS_MAX - 1), name);
        soup_free(&s);
    }
}

/* So large that all steps are shared out. Of scattered components, seams and irregular edges as
   well. */
static soup large_mesh(int which, const char **name)
{
    soup parts[2], joined;
    switch (which) {
    case 0:
        *name = "cloth";
        return soup_cloth(150, 150);
    case 1:
        *name = "sphere";
        return soup_sphere(200, 150);
    case 2:
        *name = "tube";
        return soup_tube(12, 2500);
    case 3:
        *name = "fins";
        return soup_fins(6000);
    case 4:
        *name = "seams";
        return soup_seams(130);
    case 5:
        *name = "moebius";
        return soup_moebius(800, 25);
    case 6:
        *name = "many";
        return soup_many(700);
    case 7:
        *name = "hub";
        return shape_hub(25000);
    default:
        *name = "two cloths and a spiral";
        parts[0] = soup_pinched(100);
        parts[1] = shape_spiral(3000, 5, 3, 0.1);
        joined = soup_join(&parts[0], &parts[1]);
        soup_free(&parts[0]);
        soup_free(&parts[1]);
        return joined;
    }
}

enum { LARGE = 9 };

static void large_meshes(void)
{
    for (int which = 0; which < LARGE; ++which) {
        const char *name;
        soup s;
        if (trial_is_left_out(0, (uint32_t)which)) continue;
        s = large_mesh(which, &name);
        soup_noise(s.positions, s.vertex_count, 1e-4);
        for (uint32_t content = SC_MODEL_FULL; content <= SC_MODEL_BOXES; ++content)
            check_build(&s, SC_WELD_REST, SC_PARTITION_FAST, content,
                        2 + test_random_below(THREADS_MAX - 1), name);
        soup_free(&s);
    }
}

/* Vertices in any order: what is near in the mesh is far in memory. */
static void shuffled_mesh(void)
{
    soup s = soup_cloth(110, 110);
    uint32_t *place = (uint32_t *)test_allocate(s.vertex_count * sizeof(uint32_t));
    double *at = soup_copy_positions(&s);
    for (uint32_t v = 0; v < s.vertex_count; ++v) place[v] = v;
    for (uint32_t v = s.vertex_count; v-- > 1;) {
        const uint32_t other = test_random_below(v + 1), kept = place[v];
        place[v] = place[other];
        place[other] = kept;
    }
    for (uint32_t v = 0; v < s.vertex_count; ++v)
        memcpy(s.positions + 3 * (size_t)place[v], at + 3 * (size_t)v, 3 * sizeof(double));
    for (uint32_t i = 0; i < 3 * s.triangle_count; ++i) s.triangles[i] = place[s.triangles[i]];
    for (uint32_t content = SC_MODEL_FULL; content <= SC_MODEL_BOXES; ++content)
        check_build(&s, SC_WELD_NONE, SC_PARTITION_FAST, content, 3, "shuffled cloth");
    free(at);
    free(place);
    soup_free(&s);
}

/* The caller's cut is asked in the thread that builds, and in the same order. */
static void cut_by_the_caller(void)
{
    soup s = soup_cloth(90, 90);
    check_build(&s, SC_WELD_NONE, SC_PARTITION_BISECT, SC_MODEL_FULL, 4, "cut by the caller");
    soup_free(&s);
}

/* More workers than a step has parts at most, and a mesh that is enough for all parts. */
static void many_workers(void)
{
    soup s = soup_cloth(375, 375);
    check_hosts(&s, SC_WELD_NONE, SC_PARTITION_FAST, SC_MODEL_FULL, 40, HOST_BACKWARDS,
                HOST_BACKWARDS, "large cloth");
    soup_free(&s);
}

/* Triangles that share nothing, all of whose edges are in the contours: a worker's room to chain
   these is such a part of the memory that only some workers get it. */
static void little_room(void)
{
    enum { SIDE = 300, COUNT = SIDE * SIDE };
    soup s = soup_make(3 * COUNT, COUNT);
    for (uint32_t v = 0; v < s.vertex_count; ++v) {
        const uint32_t t = v / 3;
        s.triangles[v] = v;
        s.positions[3 * v] = t % SIDE + (v % 3 == 1 ? 0.5 : 0);
        s.positions[3 * v + 1] = t / SIDE + (v % 3 == 2 ? 0.5 : 0);
        s.positions[3 * v + 2] = 0;
    }
    check_hosts(&s, SC_WELD_NONE, SC_PARTITION_FAST, SC_MODEL_FULL, 40, HOST_BACKWARDS,
                HOST_BACKWARDS, "triangles");
    soup_free(&s);
}

/* What a build said last. */
static void note_message(void *user, uint32_t level, const char *message)
{
    (void)level;
    snprintf((char *)user, MESSAGE, "%s", message);
}

/* The first of several wrong numbers is named, whichever part of the work sees it. */
static void wrong_meshes(void)
{
    for (uint32_t i = 0; i < test_iterations(20); ++i) {
        soup s = soup_cloth(120, 120);
        const sc_mesh input = input_plain_mesh(&s);
        const uint32_t is_index = i % 2;
        char expected_message[MESSAGE] = "", message[MESSAGE] = "";
        sc_hooks hooks;
        sc_build_options options;
        sc_model *model = NULL;
        sc_status expected;
        host h;
        for (uint32_t k = 0; k < 3; ++k) { /* one of them among the first */
            const uint32_t part = k ? 1 : 20;
            if (is_index)
                s.triangles[test_random_below(3 * s.triangle_count / part)] =
                    s.vertex_count + test_random_below(5);
            else
                s.positions[3 * (size_t)test_random_below(s.vertex_count / part)] = HUGE_VAL;
        }
        memset(&hooks, 0, sizeof(hooks));
        hooks.struct_size = sizeof(hooks);
        hooks.log = note_message;
        hooks.user = expected_message;
        memset(&options, 0, sizeof(options));
        options.struct_size = sizeof(options);
        options.hooks = &hooks;
        expected = sc_build(&input, &options, &model);
        CHECK(expected == (is_index ? SC_ERROR_INDEX : SC_ERROR_NOT_FINITE) && !model);
        host_start(&h, (int)(i % HOST_COUNT), 1 + test_random_below(THREADS_MAX));
        options.tasks = &h.tasks;
        hooks.user = message;
        CHECK(sc_build(&input, &options, &model) == expected && !model && !h.mistakes);
        CHECK_MSG(*message && strcmp(message, expected_message) == 0, "'%s', not '%s'", message,
                  expected_message);
        host_stop(&h);
        soup_free(&s);
    }
}

/* An allocator that fails at one call. */
typedef struct failing {
    sc_allocator standard;
    uint64_t left, live;
} failing;

static void *allocate_some(void *user, uint64_t size, uint64_t alignment)
{
    failing *f = (failing *)user;
    if (f->left == 1) return NULL;
    if (f->left) --f->left;
    ++f->live;
    return f->standard.allocate(f->standard.user, size, alignment);
}

static void release_one(void *user, void *memory, uint64_t size)
{
    failing *f = (failing *)user;
    --f->live;
    f->standard.release(f->standard.user, memory, size);
}

/* Memory that runs out ends a build by several threads as well, and nothing is lost: at each of the
   first allocations, where little has been done, then at every so many. */
static void memory_runs_out(void)
{
    soup s = soup_cloth(75, 75);
    const sc_mesh input = input_plain_mesh(&s);
    const uint64_t step = 1 + 2000 / (20 * (uint64_t)test_iterations(100));
    const uint64_t each = 60 + test_random_below((uint32_t)step);
    for (uint32_t content = SC_MODEL_FULL; content <= SC_MODEL_BOXES; ++content) {
        sc_status status = SC_ERROR_MEMORY;
        for (uint64_t n = 1; status == SC_ERROR_MEMORY; n += n < each ? 1 : step) {
            failing state = {sc_memory_allocator(NULL), n, 0};
            const sc_allocator allocator = {allocate_some, release_one, &state};
            sc_build_options options;
            sc_model *model = NULL;
            host h;
            host_start(&h, HOST_BACKWARDS, 3);
            memset(&options, 0, sizeof(options));
            options.struct_size = sizeof(options);
            options.content = content;
            options.tasks = &h.tasks;
            options.allocator = &allocator;
            status = sc_build(&input, &options, &model);
            CHECK((status == SC_OK) == (model != NULL) && state.live == (model != NULL));
            CHECK(!h.mistakes && !h.is_busy);
            sc_model_free(model);
            host_stop(&h);
            if (!CHECK(status == SC_OK || status == SC_ERROR_MEMORY)) break;
        }
    }
    soup_free(&s);
}

static void wrong_tasks(void)
{
    soup s = soup_cloth(10, 10);
    const sc_mesh input = input_plain_mesh(&s);
    sc_build_options options;
    sc_model *model = NULL;
    host h;
    host_start(&h, HOST_AT_ONCE, 2);
    memset(&options, 0, sizeof(options));
    options.struct_size = sizeof(options);
    options.tasks = &h.tasks;
    h.tasks.workers = SC_WORKERS_MAX + 1;
    CHECK(sc_build(&input, &options, &model) == SC_ERROR_OPTION && !model);
    h.tasks.workers = 2;
    h.tasks.struct_size = 4;
    CHECK(sc_build(&input, &options, &model) == SC_ERROR_STRUCT_SIZE && !model);
    h.tasks.struct_size = sizeof(h.tasks);
    h.tasks.enqueue = NULL;
    CHECK(sc_build(&input, &options, &model) == SC_ERROR_NULL && !model);
    CHECK(h.jobs == 0);
    host_stop(&h);
    host_start(&h, HOST_AT_ONCE, 2);
    options.tasks = &h.tasks;
    h.tasks.finish = NULL;
    CHECK(sc_build(&input, &options, &model) == SC_ERROR_NULL && !model);
    host_stop(&h);
    for (uint32_t workers = 0; workers < 2; ++workers) { /* one: nothing is handed out */
        host_start(&h, HOST_AT_ONCE, workers);
        options.tasks = &h.tasks;
        CHECK(sc_build(&input, &options, &model) == SC_OK && h.jobs == 0);
        sc_model_free(model);
        host_stop(&h);
    }
    soup_free(&s);
}

SC_TEST_MAIN(SC_TEST(any_mesh), SC_TEST(large_meshes), SC_TEST(shuffled_mesh),
             SC_TEST(cut_by_the_caller), SC_TEST(many_workers), SC_TEST(little_room),
             SC_TEST(wrong_meshes), SC_TEST(memory_runs_out), SC_TEST(wrong_tasks))
