/*
 * Partition by METIS: the same hierarchy every time, connected patches, two sides always, a process
 * left as it was found, and errors where METIS fails.
 *
 * SPDX-License-Identifier: MIT
 */
#define _XOPEN_SOURCE 700
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

#include "harness.h"
#include "soups.h"
#include "starcontour_metis.h"

/* Sanitizers need memory of their own. */
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#  define NO_LIMITS
#elif defined(__has_feature)
#  if __has_feature(address_sanitizer) || __has_feature(memory_sanitizer)
#    define NO_LIMITS
#  endif
#endif

#if defined(SC_WITH_METIS)

static sc_model *build(const soup *s)
{
    sc_mesh mesh;
    sc_build_options options;
    sc_model *model = NULL;
    memset(&mesh, 0, sizeof mesh);
    mesh.struct_size = (uint32_t)sizeof mesh;
    mesh.vertex_count = s->vertex_count;
    mesh.triangle_count = s->triangle_count;
    mesh.position_type = SC_DOUBLE;
    mesh.positions = s->positions;
    mesh.indices = s->triangles;
    memset(&options, 0, sizeof options);
    options.struct_size = (uint32_t)sizeof options;
    options.partition = SC_PARTITION_BISECT;
    options.bisect = sc_metis_bisect;
    CHECK(sc_build(&mesh, &options, &model) == SC_OK);
    return model;
}

static sc_model_info info_of(const sc_model *model)
{
    sc_model_info info;
    memset(&info, 0, sizeof info);
    info.struct_size = (uint32_t)sizeof info;
    CHECK(sc_model_get_info(model, &info) == SC_OK);
    return info;
}

static void handler(int number)
{
    (void)number;
}

static void process_is_left_as_found(void)
{
    soup s = soup_sphere(24, 20);
    struct sigaction set, abort_before, terminate_before, after;
    int drawn;
    memset(&set, 0, sizeof set);
    set.sa_handler = handler;
    sigemptyset(&set.sa_mask);
    CHECK(sigaction(SIGABRT, &set, &abort_before) == 0);
    CHECK(sigaction(SIGTERM, &set, &terminate_before) == 0);
    srand(77);
    drawn = rand();
    srand(77);
    sc_model_free(build(&s));
#  if defined(__GLIBC__)
    CHECK(rand() == drawn);
#  else
    (void)drawn;
#  endif
    CHECK(sigaction(SIGABRT, NULL, &after) == 0 && after.sa_handler == handler);
    CHECK(sigaction(SIGTERM, NULL, &after) == 0 && after.sa_handler == handler);
    sigaction(SIGABRT, &abort_before, NULL);
    sigaction(SIGTERM, &terminate_before, NULL);
    soup_free(&s);
}

static void same_every_time(void)
{
    soup s = soup_cloth(40, 40);
    sc_model *one, *other;
    srand(1);
    one = build(&s);
    srand(2);
    other = build(&s);
    CHECK(info_of(one).topology_hash == info_of(other).topology_hash);
    sc_model_free(one);
    sc_model_free(other);
    soup_free(&s);
}

/* Connectivity is repaired where sides have room: on a regular grid nearly everywhere. */
static void patches_are_connected(void)
{
    soup s = soup_cloth(48, 48);
    sc_model *model = build(&s);
    uint32_t level, patches = 0, connected = 0;
    for (level = 0; level < info_of(model).level_count; ++level) {
        sc_level_info l;
        memset(&l, 0, sizeof l);
        l.struct_size = (uint32_t)sizeof l;
        CHECK(sc_model_get_level(model, level, &l) == SC_OK);
        patches += l.patch_count;
        connected += l.connected_patches;
    }
    CHECK_MSG(100 * (uint64_t)connected >= 98 * (uint64_t)patches, "%u of %u", (unsigned)connected,
              (unsigned)patches);
    sc_model_free(model);
    soup_free(&s);
}

/* Nodes in a row. */
typedef struct row {
    sc_dual_graph graph;
    int32_t *offsets, *neighbors, *weights;
    uint8_t *side;
} row;

static row make_row(uint32_t count)
{
    row r;
    int32_t arcs = 0;
    r.offsets = (int32_t *)test_allocate((count + 1) * sizeof(int32_t));
    r.neighbors = (int32_t *)test_allocate(2 * (size_t)count * sizeof(int32_t));
    r.weights = (int32_t *)test_allocate(2 * (size_t)count * sizeof(int32_t));
    r.side = (uint8_t *)test_allocate(count);
    for (uint32_t i = 0; i < count; ++i) {
        r.offsets[i] = arcs;
        if (i > 0) r.neighbors[arcs++] = (int32_t)i - 1;
        if (i + 1 < count) r.neighbors[arcs++] = (int32_t)i + 1;
    }
    r.offsets[count] = arcs;
    for (int32_t i = 0; i < arcs; ++i) r.weights[i] = 1 + i % 7;
    memset(&r.graph, 0, sizeof r.graph);
    r.graph.struct_size = (uint32_t)sizeof r.graph;
    r.graph.node_count = count;
    r.graph.offsets = r.offsets;
    r.graph.neighbors = r.neighbors;
    r.graph.weights = r.weights;
    return r;
}

static void free_row(row *r)
{
    free(r->offsets);
    free(r->neighbors);
    free(r->weights);
    free(r->side);
}

/* METIS itself leaves a side empty now and then. */
static void both_sides_get_some(void)
{
    for (uint32_t count = 2; count <= 40; ++count) {
        row r = make_row(count);
        for (uint32_t left = 1; left < count; ++left) {
            uint32_t ones = 0, others = 0;
            memset(r.side, 7, count);
            CHECK(sc_metis_bisect(NULL, &r.graph, left, r.side) == SC_OK);
            for (uint32_t i = 0; i < count; ++i) {
                ones += r.side[i] == 1;
                others += r.side[i] > 1;
            }
            CHECK_MSG(others == 0 && ones > 0 && ones < count, "%u of %u", (unsigned)left,
                      (unsigned)count);
        }
        free_row(&r);
    }
}

/* Small graphs are cut by distance: a row in the middle, the target kept, connected or not. */
static void small_graphs_are_cut_by_distance(void)
{
    for (uint32_t count = 2; count <= 32; ++count) {
        row r = make_row(count);
        for (uint32_t left = 1; left < count; ++left) {
            uint32_t changes = 0;
            CHECK(sc_metis_bisect(NULL, &r.graph, left, r.side) == SC_OK);
            for (uint32_t i = 1; i < count; ++i) changes += r.side[i] != r.side[i - 1];
            CHECK_MSG(changes == 1, "%u of %u", (unsigned)left, (unsigned)count);
        }
        memset(r.offsets, 0, (count + 1) * sizeof(int32_t)); /* no arcs */
        for (uint32_t left = 1; left < count; ++left) {
            uint32_t zeros = 0;
            memset(r.side, 7, count);
            CHECK(sc_metis_bisect(NULL, &r.graph, left, r.side) == SC_OK);
            for (uint32_t i = 0; i < count; ++i) zeros += r.side[i] == 0;
            CHECK_MSG(zeros == left, "%u of %u", (unsigned)zeros, (unsigned)left);
        }
        free_row(&r);
    }
}

static void refuses_what_makes_no_sense(void)
{
    row r = make_row(9);
    CHECK(sc_metis_bisect(NULL, NULL, 1, r.side) == SC_ERROR_NULL);
    CHECK(sc_metis_bisect(NULL, &r.graph, 1, NULL) == SC_ERROR_NULL);
    CHECK(sc_metis_bisect(NULL, &r.graph, 0, r.side) == SC_ERROR_PARTITION);
    CHECK(sc_metis_bisect(NULL, &r.graph, 9, r.side) == SC_ERROR_PARTITION);
    CHECK(sc_metis_bisect(NULL, &r.graph, 10, r.side) == SC_ERROR_PARTITION);
    CHECK(sc_metis_bisect(NULL, &r.graph, 8, r.side) == SC_OK);
    free_row(&r);
}

#  if defined(__linux__) && !defined(NO_LIMITS)

/* With more and more memory, until it is enough: at first not even the graph fits, then METIS gives
   up, which says so on standard error. */
static void too_little_memory(void)
{
    row r = make_row(100000);
    struct rlimit old, limit;
    sc_status status = SC_ERROR_MEMORY;
    uint32_t failures = 0, megabytes;
    CHECK(getrlimit(RLIMIT_AS, &old) == 0);
    for (megabytes = 0; status == SC_ERROR_MEMORY && megabytes < 200; ++megabytes) {
        FILE *file = fopen("/proc/self/statm", "r");
        unsigned long pages = 0;
        if (!CHECK(file != NULL)) break;
        CHECK(fscanf(file, "%lu", &pages) == 1);
        fclose(file);
        limit = old;
        limit.rlim_cur = (rlim_t)pages * (rlim_t)sysconf(_SC_PAGESIZE) + ((rlim_t)megabytes << 20);
        CHECK(setrlimit(RLIMIT_AS, &limit) == 0);
        status = sc_metis_bisect(NULL, &r.graph, 50000, r.side);
        CHECK(setrlimit(RLIMIT_AS, &old) == 0);
        failures += status == SC_ERROR_MEMORY;
    }
    CHECK(status == SC_OK && failures > 2);
    free_row(&r);
}

#  else

static void too_little_memory(void)
{
    test_skip("memory cannot be limited here");
}

#  endif

SC_TEST_MAIN(SC_TEST(process_is_left_as_found), SC_TEST(same_every_time),
             SC_TEST(patches_are_connected), SC_TEST(both_sides_get_some),
             SC_TEST(small_graphs_are_cut_by_distance), SC_TEST(refuses_what_makes_no_sense),
             SC_TEST(too_little_memory))

#else

static void says_that_it_is_not_there(void)
{
    uint8_t side[2];
    sc_dual_graph graph;
    memset(&graph, 0, sizeof graph);
    CHECK(sc_metis_bisect(NULL, &graph, 1, side) == SC_ERROR_UNSUPPORTED);
}

SC_TEST_MAIN(SC_TEST(says_that_it_is_not_there))

#endif
