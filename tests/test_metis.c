/*
 * Partition by METIS: the same hierarchy every time, connected patches, and a process left as it was
 * found.
 *
 * SPDX-License-Identifier: MIT
 */
#define _XOPEN_SOURCE 700
#include <signal.h>
#include <stdlib.h>
#include <string.h>

#include "harness.h"
#include "soups.h"
#include "starcontour_metis.h"

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

static void refuses_null(void)
{
    uint8_t side[2];
    sc_dual_graph graph;
    memset(&graph, 0, sizeof graph);
    CHECK(sc_metis_bisect(NULL, NULL, 1, side) == SC_ERROR_NULL);
    CHECK(sc_metis_bisect(NULL, &graph, 1, NULL) == SC_ERROR_NULL);
}

SC_TEST_MAIN(SC_TEST(process_is_left_as_found), SC_TEST(same_every_time),
             SC_TEST(patches_are_connected), SC_TEST(refuses_null))

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
