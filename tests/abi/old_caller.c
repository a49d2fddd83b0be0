/*
 * A program of version 0.1: compiled with the structures of tests/abi/starcontour_0_1.h, linked
 * with the library of today, whose structures may have grown at their ends. tests/test_abi.sh runs
 * it.
 *
 * SPDX-License-Identifier: MIT
 *
 * What lies behind each structure is not the library's: it is neither read (the bytes there are no
 * zeros, pointers or sizes that make sense) nor written (they are compared afterwards).
 */
#include "starcontour_0_1.h"

#include <stdlib.h>
#include <string.h>

#include "harness.h"

enum { BEHIND = 128, GARBAGE = 0xa5 };

/* A structure with garbage behind it. */
#define GUARDED(type)                                                                              \
  struct {                                                                                         \
    type s;                                                                                        \
    unsigned char behind[BEHIND];                                                                  \
  }
#define SET_UP(guarded)                                                                            \
  do {                                                                                             \
    memset(&(guarded), 0, sizeof(guarded));                                                        \
    memset((guarded).behind, GARBAGE, BEHIND);                                                     \
    (guarded).s.struct_size = (uint32_t)sizeof((guarded).s);                                       \
  } while (0)
#define CHECK_BEHIND(guarded) CHECK_MSG(untouched((guarded).behind), "written behind " #guarded)

static int untouched(const unsigned char *behind)
{
    int i;
    for (i = 0; i < BEHIND; i++)
        if (behind[i] != GARBAGE) return 0;
    return 1;
}

/* A strip of squares, flat at rest; in the pose it is wound so tightly that it meets itself. */
enum { SQUARES = 32, VERTICES = 2 * (SQUARES + 1), TRIANGLES = 2 * SQUARES };

static float rest[VERTICES][3], wound[VERTICES][3];
static uint32_t triangles[TRIANGLES][3];

static void make_strip(void)
{
    static const float corners[4][2] = {{0, 0}, {2, 0}, {2, 2}, {0, 2}};
    uint32_t i, k;
    memset(rest, 0, sizeof rest);
    for (i = 0; i <= SQUARES; i++) {
        for (k = 0; k < 2; k++) {
            uint32_t v = 2 * i + k;
            rest[v][0] = (float)i;
            rest[v][1] = (float)k;
            /* round and round a square, each corner twisted a little against the one before */
            wound[v][0] = corners[i % 4][0];
            wound[v][1] = (float)k + 0.05f * (float)(i % 3);
            wound[v][2] = corners[i % 4][1];
        }
    }
    for (i = 0; i < SQUARES; i++) {
        const uint32_t v = 2 * i;
        const uint32_t t[6] = {v, v + 1, v + 2, v + 2, v + 1, v + 3};
        memcpy(triangles[2 * i], t, sizeof t);
    }
}

typedef struct counter {
    int64_t blocks;
    uint64_t allocations, bisections;
} counter;

static void *counted_allocate(void *user, uint64_t size, uint64_t alignment)
{
    /* room to align by hand; the pointer to give back lies just before */
    counter *c = (counter *)user;
    unsigned char *memory = (unsigned char *)malloc((size_t)(size + alignment + sizeof(void *)));
    uintptr_t at;
    if (memory == NULL) return NULL;
    at = (uintptr_t)(memory + sizeof(void *));
    at += (uintptr_t)((alignment - at % alignment) % alignment);
    memcpy((unsigned char *)at - sizeof(void *), &memory, sizeof(void *));
    c->blocks++;
    c->allocations++;
    return (void *)at;
}

static void counted_release(void *user, void *memory, uint64_t size)
{
    void *block;
    (void)size;
    memcpy(&block, (unsigned char *)memory - sizeof(void *), sizeof(void *));
    ((counter *)user)->blocks--;
    free(block);
}

/* The lower half of the node numbers on one side. */
static sc_status halve(void *user, const sc_dual_graph *graph, uint32_t left_target, uint8_t *side)
{
    uint32_t i;
    ((counter *)user)->bisections++;
    if (!CHECK(graph->struct_size >= sizeof(sc_dual_graph)) || !CHECK(graph->node_count >= 2))
        return SC_ERROR_PARTITION;
    CHECK(graph->offsets[0] == 0 && graph->offsets[graph->node_count] >= 0);
    for (i = 0; i < graph->node_count; i++) side[i] = i >= left_target;
    return SC_OK;
}

static sc_model *build(counter *count, const sc_allocator *allocator)
{
    GUARDED(sc_mesh) mesh;
    GUARDED(sc_build_options) options;
    sc_model *model = NULL;
    make_strip();
    SET_UP(mesh);
    SET_UP(options);
    mesh.s.vertex_count = VERTICES;
    mesh.s.triangle_count = TRIANGLES;
    mesh.s.positions = rest;
    mesh.s.indices = triangles;
    options.s.weld = SC_WELD_NONE;
    options.s.partition = SC_PARTITION_BISECT;
    options.s.bisect = halve;
    options.s.bisect_user = count;
    options.s.allocator = allocator;
    CHECK(sc_build(&mesh.s, &options.s, &model) == SC_OK);
    CHECK_BEHIND(mesh);
    CHECK_BEHIND(options);
    return model;
}

static void builds_and_describes(void)
{
    counter count = {0, 0, 0};
    sc_allocator allocator;
    GUARDED(sc_model_info) info;
    GUARDED(sc_level_info) level;
    uint64_t workspace_bytes = 0;
    sc_model *model;
    allocator.allocate = counted_allocate;
    allocator.release = counted_release;
    allocator.user = &count;
    model = build(&count, &allocator);
    if (!CHECK(model != NULL)) return;
    CHECK(count.allocations > 0 && count.bisections > 0);

    SET_UP(info);
    CHECK(sc_model_get_info(model, &info.s) == SC_OK);
    CHECK_BEHIND(info);
    CHECK(info.s.struct_size == sizeof(info.s));
    CHECK(info.s.vertex_count == VERTICES && info.s.point_count == VERTICES);
    CHECK(info.s.triangle_count == TRIANGLES && info.s.component_count == 1);
    CHECK(info.s.edge_count == 2 * TRIANGLES + 1 && info.s.boundary_edges == 2 * SQUARES + 2);
    CHECK(info.s.irregular_edges == 0 && info.s.level_count > 1 && info.s.leaf_count > 1);
    CHECK(sc_workspace_size(model, &workspace_bytes) == SC_OK);
    CHECK(info.s.workspace_bytes == workspace_bytes && info.s.model_bytes > 0);

    SET_UP(level);
    CHECK(sc_model_get_level(model, 1, &level.s) == SC_OK);
    CHECK_BEHIND(level);
    CHECK(level.s.struct_size == sizeof(level.s));
    CHECK(level.s.patch_count == 2 && level.s.connected_patches == 2);
    CHECK(sc_model_get_level(model, info.s.level_count, &level.s) == SC_ERROR_LEVEL);

    sc_model_free(model);
    CHECK(count.blocks == 0);
}

static void queries(void)
{
    enum { CAPACITY = TRIANGLES * TRIANGLES };
    static sc_pair pairs[2][CAPACITY];
    counter count = {0, 0, 0};
    GUARDED(sc_pose) pose;
    GUARDED(sc_query_options) options;
    GUARDED(sc_stats) stats;
    GUARDED(sc_result) result;
    sc_model *model = build(&count, NULL);
    sc_workspace *workspace = NULL;
    uint64_t found[2] = {0, 0};
    int turn;
    if (!CHECK(model != NULL)) return;
    CHECK(sc_workspace_create(model, NULL, &workspace) == SC_OK);

    SET_UP(pose);
    pose.s.vertex_count = VERTICES;
    for (turn = 0; turn < 3; turn++) { /* flat, then wound with either method */
        SET_UP(options);
        SET_UP(stats);
        SET_UP(result);
        pose.s.positions = turn == 0 ? rest : wound;
        options.s.method = turn == 2 ? SC_METHOD_AABB : SC_METHOD_SCTT;
        result.s.capacity = CAPACITY;
        result.s.pairs = pairs[turn == 2];
        result.s.stats = &stats.s;
        CHECK(sc_query(model, workspace, &pose.s, &options.s, &result.s) == SC_OK);
        CHECK_BEHIND(pose);
        CHECK_BEHIND(options);
        CHECK_BEHIND(stats);
        CHECK_BEHIND(result);
        CHECK(result.s.struct_size == sizeof(result.s) && result.s.capacity == CAPACITY);
        CHECK(stats.s.struct_size == sizeof(stats.s));
        CHECK(stats.s.nodes_visited > 0 || options.s.method == SC_METHOD_AABB);
        if (turn == 0) CHECK(result.s.count == 0 && result.s.collides == 0);
        if (turn > 0) {
            CHECK(result.s.collides == 1 && stats.s.leaf_pairs > 0);
            found[turn - 1] = result.s.count;
        }
    }
    CHECK_MSG(found[0] > 100 && found[0] == found[1], "%u and %u pairs", (unsigned)found[0],
              (unsigned)found[1]);
    CHECK(memcmp(pairs[0], pairs[1], (size_t)found[0] * sizeof(sc_pair)) == 0);

    /* errors come as they came */
    result.s.capacity = 1;
    CHECK(sc_query(model, workspace, &pose.s, NULL, &result.s) == SC_ERROR_SHORT_BUFFER);
    CHECK(result.s.count == found[0]);
    options.s.method = 99;
    CHECK(sc_query(model, workspace, &pose.s, &options.s, &result.s) == SC_ERROR_OPTION);
    options.s.struct_size = 4;
    CHECK(sc_query(model, workspace, &pose.s, &options.s, &result.s) == SC_ERROR_STRUCT_SIZE);
    CHECK_BEHIND(result);

    sc_workspace_free(workspace);
    sc_model_free(model);
}

SC_TEST_MAIN(SC_TEST(builds_and_describes), SC_TEST(queries))
