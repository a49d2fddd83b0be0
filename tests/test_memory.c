/*
 * Memory: every allocation may fail, once each, and nothing leaks; sizes given back are those that
 * were asked for; alignment is kept; sc_query allocates nothing; the caller's memory will do for a
 * workspace.
 *
 * SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "harness.h"
#include "inputs.h"
#include "oracle.h"
#include "soups.h"
#include "starcontour.h"

enum { MAXIMUM_BLOCKS = 4096 };

typedef struct block {
    unsigned char *memory; /* as malloc gave it */
    unsigned char *given;  /* as the library got it */
    uint64_t size;
} block;

/* An allocator that counts, checks, and fails when told to. */
typedef struct counter {
    block blocks[MAXIMUM_BLOCKS];
    uint32_t live;
    uint64_t calls, releases, live_bytes, peak_bytes;
    uint64_t fail_at; /* the number of the call that fails, from 1; 0: none */
    int fails_after;  /* all later ones fail too */
    int is_forbidden; /* any call is an error */
    int mistakes;
} counter;

static void *allocate(void *user, uint64_t size, uint64_t alignment)
{
    counter *c = (counter *)user;
    block *b = &c->blocks[c->live];
    ++c->calls;
    if (size == 0 || alignment == 0 || alignment > SC_ALIGNMENT ||
        (alignment & (alignment - 1)) != 0 || c->is_forbidden || c->live == MAXIMUM_BLOCKS) {
        ++c->mistakes;
        return NULL;
    }
    if (c->fail_at != 0 && (c->calls == c->fail_at || (c->fails_after && c->calls > c->fail_at)))
        return NULL;
    /* Aligned to what was asked for and to no more, full of noise, with noise around. */
    b->memory = (unsigned char *)test_allocate((size_t)(size + 4 * alignment));
    memset(b->memory, 0xa5, (size_t)(size + 4 * alignment));
    b->given = b->memory + 3 * alignment - (uintptr_t)b->memory % (2 * alignment);
    b->size = size;
    ++c->live;
    c->live_bytes += size;
    if (c->live_bytes > c->peak_bytes) c->peak_bytes = c->live_bytes;
    return b->given;
}

static void release(void *user, void *memory, uint64_t size)
{
    counter *c = (counter *)user;
    ++c->releases;
    for (uint32_t i = 0; i < c->live; ++i) {
        block *b = &c->blocks[i];
        if (b->given != memory) continue;
        if (b->size != size) ++c->mistakes;
        /* Nothing was written just before or behind. */
        if (b->given[-1] != 0xa5 || b->given[b->size] != 0xa5) ++c->mistakes;
        memset(b->given, 0x5a, (size_t)b->size);
        free(b->memory);
        c->live_bytes -= b->size;
        *b = c->blocks[--c->live];
        return;
    }
    ++c->mistakes; /* NULL, or never given */
}

static sc_allocator make_allocator(counter *c)
{
    sc_allocator allocator;
    memset(c, 0, sizeof(*c));
    allocator.allocate = allocate;
    allocator.release = release;
    allocator.user = c;
    return allocator;
}

static counter build_counter, workspace_counter;

/* Whether a model answers as the oracle does; the query must not allocate. */
static void check_answer(const soup *s, const double *posed, const uint32_t *map, sc_model *model,
                         sc_workspace *workspace)
{
    oracle_answer answer;
    sc_pose pose = input_plain_pose(posed, s->vertex_count);
    oracle_solve(posed, s->vertex_count, s->triangles, s->triangle_count, map, &answer);
    build_counter.is_forbidden = workspace_counter.is_forbidden = 1;
    for (uint32_t method = 0; method <= SC_METHOD_AABB; ++method) {
        for (uint32_t kind = 0; kind < 4; ++kind) {
            const oracle_list *expected = &answer.lists[kind / 2][kind % 2];
            sc_pair *pairs = (sc_pair *)test_allocate(expected->count * sizeof(sc_pair));
            sc_stats stats;
            sc_result result;
            sc_query_options options;
            memset(&options, 0, sizeof(options));
            options.struct_size = sizeof(options);
            options.pairs = kind / 2;
            options.contact = kind % 2;
            options.method = method;
            memset(&stats, 0, sizeof(stats));
            stats.struct_size = sizeof(stats);
            memset(&result, 0, sizeof(result));
            result.struct_size = sizeof(result);
            result.capacity = expected->count;
            result.pairs = pairs;
            result.stats = &stats;
            CHECK(sc_query(model, workspace, &pose, &options, &result) == SC_OK &&
                  result.count == expected->count &&
                  (expected->count == 0 ||
                   memcmp(pairs, expected->pairs, expected->count * sizeof(sc_pair)) == 0));
            free(pairs);
        }
    }
    build_counter.is_forbidden = workspace_counter.is_forbidden = 0;
    CHECK(build_counter.mistakes == 0 && workspace_counter.mistakes == 0);
    oracle_free(&answer);
}

/* Fails call after call of one kind of build until none is left, in two ways. posed may be NULL:
   answers are not looked at. */
static void check_failing_build(const char *name, const soup *s, const double *posed, uint32_t weld,
                                uint32_t partition, uint32_t content)
{
    sc_mesh mesh = input_plain_mesh(s);
    input_choices choices = input_choose(s, weld, partition);
    uint32_t *map = input_weld_of(&choices, s);
    choices.options.content = content;
    if (content == SC_MODEL_BOXES) choices.options.rest = SC_REST_UNMARKED;
    for (int fails_after = 0; fails_after < 2; ++fails_after) {
        sc_status status = SC_ERROR_MEMORY;
        uint64_t n = 0;
        while (status == SC_ERROR_MEMORY && n < 10000) {
            sc_allocator allocator = make_allocator(&build_counter);
            sc_model *model = (sc_model *)&mesh; /* anything but NULL */
            build_counter.fail_at = ++n;
            build_counter.fails_after = fails_after;
            choices.options.allocator = &allocator;
            status = sc_build(&mesh, &choices.options, &model);
            memset(&allocator, 0, sizeof(allocator)); /* it was copied */
            if (status != SC_OK) {
                CHECK_MSG(status == SC_ERROR_MEMORY && model == NULL, "%s: call %u: %s", name,
                          (unsigned)n, sc_status_string(status));
                CHECK_MSG(build_counter.live == 0, "%s: call %u: %u blocks left", name, (unsigned)n,
                          (unsigned)build_counter.live);
            } else {
                sc_allocator other = make_allocator(&workspace_counter);
                sc_workspace *workspace = NULL;
                sc_model_info info;
                build_counter.fail_at = 0;
                memset(&info, 0, sizeof(info));
                info.struct_size = sizeof(info);
                CHECK(sc_model_get_info(model, &info) == SC_OK);
                CHECK_MSG(build_counter.live == 1, "%s: a model is one block", name);
                CHECK_MSG(build_counter.live_bytes == info.model_bytes,
                          "%s: %u instead of %u bytes", name, (unsigned)build_counter.live_bytes,
                          (unsigned)info.model_bytes);
                CHECK_MSG(info.peak_bytes == build_counter.peak_bytes &&
                              info.allocations == build_counter.calls,
                          "%s: %u bytes in %u calls", name, (unsigned)build_counter.peak_bytes,
                          (unsigned)build_counter.calls);
                CHECK(sc_workspace_create(model, &other, &workspace) == SC_OK);
                if (fails_after == 0 && posed) check_answer(s, posed, map, model, workspace);
                sc_workspace_free(workspace);
                sc_model_free(model);
                CHECK(build_counter.live == 0 && workspace_counter.live == 0);
                CHECK(build_counter.calls == build_counter.releases);
            }
            CHECK_MSG(build_counter.mistakes == 0, "%s: call %u: %d wrong uses of the allocator",
                      name, (unsigned)n, build_counter.mistakes);
        }
        CHECK_MSG(status == SC_OK && n > 1, "%s: %s after %u calls", name, sc_status_string(status),
                  (unsigned)n);
    }
    free(map);
    input_free_choices(&choices);
}

static void build_fails_at_every_allocation(void)
{
    for (uint32_t i = 0; i < 8; ++i) {
        const char *const names[] = {"cloth", "sphere", "fins",       "pinched",
                                     "seams", "many",   "no contour", "large cloth"};
        soup s = i == 0   ? soup_cloth(5, 12)
                 : i == 1 ? soup_sphere(9, 8)
                 : i == 2 ? soup_fins(9)
                 : i == 3 ? soup_pinched(5)
                 : i == 4 ? soup_seams(6)
                 : i == 5 ? soup_many(8)
                 : i == 6 ? soup_sphere(3, 1)
                          : soup_cloth(11, 12);
        double *posed = (double *)test_allocate(3 * (size_t)s.vertex_count * sizeof(double));
        memcpy(posed, s.positions, 3 * (size_t)s.vertex_count * sizeof(double));
        soup_fold(posed, s.vertex_count);
        for (uint32_t partition = 0; partition < 4; ++partition)
            for (uint32_t content = SC_MODEL_FULL; content <= SC_MODEL_BOXES; ++content)
                check_failing_build(names[i], &s, content == SC_MODEL_FULL ? posed : NULL,
                                    i % 2 == 0 ? SC_WELD_REST : SC_WELD_MAP, partition, content);
        free(posed);
        soup_free(&s);
    }
}

/* Triangles of any three vertices: those of a patch are far from each other, so that most pairs of
   patches share some. */
static soup tangle(uint32_t count)
{
    soup s = soup_make(count, count);
    for (uint32_t i = 0; i < 3 * count; ++i) s.positions[i] = test_random_unit();
    for (uint32_t i = 0; i < 3 * count; ++i) s.triangles[i] = test_random_below(count);
    return s;
}

/* Meshes large enough for levels to be taken away, and for lists to grow. */
static void large_builds_fail_as_well(void)
{
    for (uint32_t i = 0; i < 4; ++i) {
        soup s = i == 0   ? soup_cloth(30, 40)
                 : i == 1 ? soup_sphere(40, 30)
                 : i == 2 ? soup_many(60)
                          : tangle(400);
        check_failing_build("large", &s, NULL, SC_WELD_REST, SC_PARTITION_FAST, SC_MODEL_FULL);
        soup_free(&s);
    }
}

/* Small soups take paths that meshes do not; and errors in the middle of a build leak nothing. */
static void small_builds_fail_as_well(void)
{
    uint32_t rounds = test_iterations(60);
    for (uint32_t i = 0; i < rounds; ++i) {
        soup s = soup_on_grid(3);
        check_failing_build("soup", &s, s.positions, i % 3, test_random_below(4), SC_MODEL_FULL);
        soup_free(&s);
    }
}

static void bad_input_leaks_nothing(void)
{
    soup s = soup_cloth(8, 8);
    sc_mesh mesh = input_plain_mesh(&s);
    uint32_t *order = (uint32_t *)test_allocate(s.triangle_count * sizeof(uint32_t));
    for (int i = 0; i < 4; ++i) {
        sc_allocator allocator = make_allocator(&build_counter);
        sc_build_options options;
        sc_model *model = NULL;
        memset(&options, 0, sizeof(options));
        options.struct_size = sizeof(options);
        options.allocator = &allocator;
        memset(order, 0, s.triangle_count * sizeof(uint32_t));
        if (i == 0) s.triangles[3 * s.triangle_count - 1] = s.vertex_count;
        if (i == 1) s.triangles[3 * s.triangle_count - 1] = 0;
        if (i == 1) s.positions[3 * s.vertex_count - 4] = HUGE_VAL;
        if (i == 2) options.partition = SC_PARTITION_ORDER;
        if (i == 2) s.positions[3 * s.vertex_count - 4] = 0.5;
        if (i == 3) options.partition = SC_PARTITION_TREE + 7;
        options.order = order;
        CHECK(sc_build(&mesh, &options, &model) != SC_OK);
        CHECK(build_counter.live == 0 && build_counter.mistakes == 0);
    }
    free(order);
    soup_free(&s);
}

static void workspace_fails_at_every_allocation(void)
{
    soup s = soup_cloth(6, 6);
    sc_mesh mesh = input_plain_mesh(&s);
    sc_build_options options;
    sc_allocator allocator = make_allocator(&build_counter);
    sc_model *model = NULL;
    memset(&options, 0, sizeof(options));
    options.struct_size = sizeof(options);
    options.allocator = &allocator;
    if (CHECK(sc_build(&mesh, &options, &model) == SC_OK)) {
        uint64_t build_calls = build_counter.calls, size = 0;
        sc_status status = SC_ERROR_MEMORY;
        for (uint64_t n = 1; status != SC_OK && n < 100; ++n) {
            sc_allocator other = make_allocator(&workspace_counter);
            sc_workspace *workspace = (sc_workspace *)&mesh; /* anything but NULL */
            workspace_counter.fail_at = n;
            status = sc_workspace_create(model, &other, &workspace);
            if (status != SC_OK) {
                CHECK(status == SC_ERROR_MEMORY && workspace == NULL);
                CHECK(workspace_counter.live == 0);
                continue;
            }
            CHECK(workspace_counter.live == 1); /* one block */
            CHECK(sc_workspace_size(model, &size) == SC_OK);
            CHECK(workspace_counter.live_bytes == size);
            memset(&other, 0, sizeof(other)); /* it was copied */
            check_answer(&s, s.positions, NULL, model, workspace);
            sc_workspace_free(workspace);
            CHECK(workspace_counter.live == 0 && workspace_counter.mistakes == 0);
        }
        CHECK(status == SC_OK);
        CHECK(build_counter.calls == build_calls); /* the model's allocator is the model's */
    }
    sc_model_free(model);
    CHECK(build_counter.live == 0 && build_counter.mistakes == 0);
    soup_free(&s);
}

/* Two workspaces in the caller's memory, of which nothing is written beyond their size. */
static void workspaces_in_own_memory(void)
{
    soup s = soup_tube(10, 12);
    sc_mesh mesh = input_plain_mesh(&s);
    sc_model *model = NULL;
    if (CHECK(sc_build(&mesh, NULL, &model) == SC_OK)) {
        sc_workspace *workspaces[2] = {NULL, NULL};
        unsigned char *memory[2], *aligned[2];
        uint64_t size = 0;
        double *posed = (double *)test_allocate(3 * (size_t)s.vertex_count * sizeof(double));
        memcpy(posed, s.positions, 3 * (size_t)s.vertex_count * sizeof(double));
        soup_fold(posed, s.vertex_count);
        CHECK(sc_workspace_size(model, &size) == SC_OK && size > 0);
        for (int i = 0; i < 2; ++i) {
            memory[i] = (unsigned char *)test_allocate((size_t)size + 2 * SC_ALIGNMENT);
            memset(memory[i], i == 0 ? 0xff : 0x77, (size_t)size + 2 * SC_ALIGNMENT);
            aligned[i] = memory[i] + SC_ALIGNMENT - (uintptr_t)memory[i] % SC_ALIGNMENT;
            aligned[i][size] = 0xcc;
            CHECK(sc_workspace_init(model, aligned[i], i == 0 ? size : size + SC_ALIGNMENT - 1,
                                    &workspaces[i]) == SC_OK);
        }
        for (int i = 0; i < 4; ++i) {
            check_answer(&s, i < 2 ? posed : s.positions, NULL, model, workspaces[i % 2]);
            CHECK(aligned[0][size] == 0xcc);
            CHECK(aligned[0][-1] == 0xff && aligned[1][-1] == 0x77);
        }
        for (int i = 0; i < 2; ++i) {
            sc_workspace_free(workspaces[i]);
            free(memory[i]);
        }
        free(posed);
    }
    sc_model_free(model);
    soup_free(&s);
}

SC_TEST_MAIN(SC_TEST(build_fails_at_every_allocation), SC_TEST(large_builds_fail_as_well),
             SC_TEST(small_builds_fail_as_well), SC_TEST(bad_input_leaks_nothing),
             SC_TEST(workspace_fails_at_every_allocation), SC_TEST(workspaces_in_own_memory))
