/*
 * The binary interface as it was committed: sizes and offsets of the public structures on 64-bit
 * machines, the values of the enumerators, and the symbols that the shared library exports. A change
 * here breaks callers that were compiled before: see "Versions" in starcontour.h.
 *
 * The shared library is $SC_SHARED_LIBRARY, else libstarcontour.so in $SC_LIB or build/lib.
 *
 * SPDX-License-Identifier: MIT
 */
#define _POSIX_C_SOURCE 200809L

#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "harness.h"
#include "starcontour.h"

#if defined(__SANITIZE_ADDRESS__)
#  define SC_NO_SHARED
#elif defined(__has_feature)
#  if __has_feature(address_sanitizer)
#    define SC_NO_SHARED
#  endif
#endif

#define SIZE(type, bytes) CHECK_MSG(sizeof(type) == (bytes), "%zu", sizeof(type))
#define MEMBER(type, member, offset)                                                               \
  CHECK_MSG(offsetof(type, member) == (offset), "%zu", offsetof(type, member))
#define VALUE(name, value) CHECK_MSG((name) == (value), "%ld", (long)(name))

static void structures(void)
{
    if (sizeof(void *) != 8) {
        test_note("skipped: written for pointers of 8 bytes");
        return;
    }
    SIZE(sc_status, 4);

    SIZE(sc_allocator, 24);
    MEMBER(sc_allocator, allocate, 0);
    MEMBER(sc_allocator, release, 8);
    MEMBER(sc_allocator, user, 16);

    SIZE(sc_mesh, 48);
    MEMBER(sc_mesh, struct_size, 0);
    MEMBER(sc_mesh, vertex_count, 4);
    MEMBER(sc_mesh, triangle_count, 8);
    MEMBER(sc_mesh, position_type, 12);
    MEMBER(sc_mesh, position_stride, 16);
    MEMBER(sc_mesh, index_type, 20);
    MEMBER(sc_mesh, index_stride, 24);
    MEMBER(sc_mesh, reserved, 28);
    MEMBER(sc_mesh, positions, 32);
    MEMBER(sc_mesh, indices, 40);

    SIZE(sc_pose, 24);
    MEMBER(sc_pose, struct_size, 0);
    MEMBER(sc_pose, vertex_count, 4);
    MEMBER(sc_pose, position_type, 8);
    MEMBER(sc_pose, position_stride, 12);
    MEMBER(sc_pose, positions, 16);

    SIZE(sc_tree_node, 16);
    MEMBER(sc_tree_node, left, 0);
    MEMBER(sc_tree_node, right, 4);
    MEMBER(sc_tree_node, first, 8);
    MEMBER(sc_tree_node, count, 12);

    SIZE(sc_dual_graph, 32);
    MEMBER(sc_dual_graph, struct_size, 0);
    MEMBER(sc_dual_graph, node_count, 4);
    MEMBER(sc_dual_graph, offsets, 8);
    MEMBER(sc_dual_graph, neighbors, 16);
    MEMBER(sc_dual_graph, weights, 24);

    SIZE(sc_build_options, 72);
    MEMBER(sc_build_options, struct_size, 0);
    MEMBER(sc_build_options, weld, 4);
    MEMBER(sc_build_options, partition, 8);
    MEMBER(sc_build_options, tree_count, 12);
    MEMBER(sc_build_options, weld_map, 16);
    MEMBER(sc_build_options, order, 24);
    MEMBER(sc_build_options, tree, 32);
    MEMBER(sc_build_options, bisect, 40);
    MEMBER(sc_build_options, bisect_user, 48);
    MEMBER(sc_build_options, allocator, 56);
    MEMBER(sc_build_options, hooks, 64);

    SIZE(sc_hooks, 32);
    MEMBER(sc_hooks, struct_size, 0);
    MEMBER(sc_hooks, reserved, 4);
    MEMBER(sc_hooks, log, 8);
    MEMBER(sc_hooks, failed, 16);
    MEMBER(sc_hooks, user, 24);

    SIZE(sc_record, 40);
    MEMBER(sc_record, struct_size, 0);
    MEMBER(sc_record, reserved, 4);
    MEMBER(sc_record, pose, 8);
    MEMBER(sc_record, options, 16);
    MEMBER(sc_record, model, 24);
    MEMBER(sc_record, model_size, 32);

    SIZE(sc_load_options, 32);
    MEMBER(sc_load_options, struct_size, 0);
    MEMBER(sc_load_options, mode, 4);
    MEMBER(sc_load_options, topology_hash, 8);
    MEMBER(sc_load_options, allocator, 16);
    MEMBER(sc_load_options, hooks, 24);

    SIZE(sc_model_info, 88);
    MEMBER(sc_model_info, struct_size, 0);
    MEMBER(sc_model_info, vertex_count, 4);
    MEMBER(sc_model_info, point_count, 8);
    MEMBER(sc_model_info, triangle_count, 12);
    MEMBER(sc_model_info, edge_count, 16);
    MEMBER(sc_model_info, component_count, 20);
    MEMBER(sc_model_info, boundary_edges, 24);
    MEMBER(sc_model_info, irregular_edges, 28);
    MEMBER(sc_model_info, leaf_count, 32);
    MEMBER(sc_model_info, level_count, 36);
    MEMBER(sc_model_info, node_count, 40);
    MEMBER(sc_model_info, segment_count, 44);
    MEMBER(sc_model_info, topology_hash, 48);
    MEMBER(sc_model_info, model_bytes, 56);
    MEMBER(sc_model_info, workspace_bytes, 64);
    MEMBER(sc_model_info, peak_bytes, 72);
    MEMBER(sc_model_info, allocations, 80);

    SIZE(sc_level_info, 40);
    MEMBER(sc_level_info, struct_size, 0);
    MEMBER(sc_level_info, patch_count, 4);
    MEMBER(sc_level_info, connected_patches, 8);
    MEMBER(sc_level_info, segment_count, 12);
    MEMBER(sc_level_info, self_nodes, 16);
    MEMBER(sc_level_info, self_oriented, 20);
    MEMBER(sc_level_info, self_culled, 24);
    MEMBER(sc_level_info, pair_nodes, 28);
    MEMBER(sc_level_info, pair_oriented, 32);
    MEMBER(sc_level_info, pair_culled, 36);

    SIZE(sc_group, 8);
    MEMBER(sc_group, category, 0);
    MEMBER(sc_group, mask, 4);

    SIZE(sc_filter, 56);
    MEMBER(sc_filter, struct_size, 0);
    MEMBER(sc_filter, ignore_rings, 4);
    MEMBER(sc_filter, vertex_groups, 8);
    MEMBER(sc_filter, triangle_groups, 16);
    MEMBER(sc_filter, ignore, 24);
    MEMBER(sc_filter, ignore_count, 32);
    MEMBER(sc_filter, accept, 40);
    MEMBER(sc_filter, accept_user, 48);

    SIZE(sc_query_options, 56);
    MEMBER(sc_query_options, struct_size, 0);
    MEMBER(sc_query_options, output, 4);
    MEMBER(sc_query_options, pairs, 8);
    MEMBER(sc_query_options, contact, 12);
    MEMBER(sc_query_options, method, 16);
    MEMBER(sc_query_options, contour, 20);
    MEMBER(sc_query_options, rest_cache, 24);
    MEMBER(sc_query_options, simd, 28);
    MEMBER(sc_query_options, filter, 32);
    MEMBER(sc_query_options, cancel, 40);
    MEMBER(sc_query_options, budget, 48);

    SIZE(sc_pair, 8);
    MEMBER(sc_pair, a, 0);
    MEMBER(sc_pair, b, 4);

    SIZE(sc_stats, 200);
    MEMBER(sc_stats, struct_size, 0);
    MEMBER(sc_stats, reserved, 4);
    MEMBER(sc_stats, total_nanoseconds, 8);
    MEMBER(sc_stats, nanoseconds, 16);
    MEMBER(sc_stats, counts, 88);
    MEMBER(sc_stats, nodes_visited, 160);
    MEMBER(sc_stats, nodes_oriented, 168);
    MEMBER(sc_stats, nodes_culled, 176);
    MEMBER(sc_stats, leaf_pairs, 184);
    MEMBER(sc_stats, exact_fallbacks, 192);

    SIZE(sc_result, 48);
    MEMBER(sc_result, struct_size, 0);
    MEMBER(sc_result, collides, 4);
    MEMBER(sc_result, count, 8);
    MEMBER(sc_result, capacity, 16);
    MEMBER(sc_result, pairs, 24);
    MEMBER(sc_result, stats, 32);
    MEMBER(sc_result, verdict, 40);
    MEMBER(sc_result, reserved, 44);

    SIZE(sc_contact, 152);
    MEMBER(sc_contact, kind, 0);
    MEMBER(sc_contact, reserved, 4);
    MEMBER(sc_contact, points, 8);
    MEMBER(sc_contact, weights_a, 56);
    MEMBER(sc_contact, weights_b, 104);
}

static void enumerators(void)
{
    VALUE(SC_OK, 0);
    VALUE(SC_ERROR_NULL, 1);
    VALUE(SC_ERROR_STRUCT_SIZE, 2);
    VALUE(SC_ERROR_OPTION, 3);
    VALUE(SC_ERROR_EMPTY, 4);
    VALUE(SC_ERROR_COUNT, 5);
    VALUE(SC_ERROR_STRIDE, 6);
    VALUE(SC_ERROR_INDEX, 7);
    VALUE(SC_ERROR_NOT_FINITE, 8);
    VALUE(SC_ERROR_VERTEX_COUNT, 9);
    VALUE(SC_ERROR_MEMORY, 10);
    VALUE(SC_ERROR_SHORT_BUFFER, 11);
    VALUE(SC_ERROR_WORKSPACE, 12);
    VALUE(SC_ERROR_WELD_MAP, 13);
    VALUE(SC_ERROR_TREE, 14);
    VALUE(SC_ERROR_PARTITION, 15);
    VALUE(SC_ERROR_UNSUPPORTED, 16);
    VALUE(SC_ERROR_ALIGNMENT, 17);
    VALUE(SC_ERROR_LEVEL, 18);
    VALUE(SC_ERROR_NOT_SAVED, 19);
    VALUE(SC_ERROR_TRUNCATED, 20);
    VALUE(SC_ERROR_BYTE_ORDER, 21);
    VALUE(SC_ERROR_TOO_NEW, 22);
    VALUE(SC_ERROR_TOO_OLD, 23);
    VALUE(SC_ERROR_CHECKSUM, 24);
    VALUE(SC_ERROR_INCONSISTENT, 25);
    VALUE(SC_ERROR_TOPOLOGY, 26);
    VALUE(SC_ERROR_PAIRS, 27);
    VALUE(SC_ERROR_INCOMPLETE, 28);
    VALUE(SC_LOG_NOTE, 0);
    VALUE(SC_LOG_WARNING, 1);
    VALUE(SC_LOG_ERROR, 2);
    VALUE(SC_LOAD_COPY, 0);
    VALUE(SC_LOAD_IN_PLACE, 1);
    VALUE(SC_ALIGNMENT, 64);
    VALUE(SC_FLOAT, 0);
    VALUE(SC_DOUBLE, 1);
    VALUE(SC_UINT32, 0);
    VALUE(SC_UINT16, 1);
    CHECK(SC_NONE == UINT32_MAX);
    VALUE(SC_WELD_REST, 0);
    VALUE(SC_WELD_MAP, 1);
    VALUE(SC_WELD_NONE, 2);
    VALUE(SC_PARTITION_FAST, 0);
    VALUE(SC_PARTITION_ORDER, 1);
    VALUE(SC_PARTITION_TREE, 2);
    VALUE(SC_PARTITION_BISECT, 3);
    VALUE(SC_OUTPUT_PAIRS, 0);
    VALUE(SC_OUTPUT_COUNT, 1);
    VALUE(SC_OUTPUT_ANY, 2);
    VALUE(SC_PAIRS_TRIANGLE, 0);
    VALUE(SC_PAIRS_EDGE, 1);
    VALUE(SC_CONTACT_TOUCHING, 0);
    VALUE(SC_CONTACT_PROPER, 1);
    VALUE(SC_METHOD_DEFAULT, 0);
    VALUE(SC_METHOD_SCTT, 1);
    VALUE(SC_METHOD_AABB_SCTT, 2);
    VALUE(SC_METHOD_AABB, 3);
    VALUE(SC_CONTOUR_DEFAULT, 0);
    VALUE(SC_CONTOUR_STAR, 1);
    VALUE(SC_CONTOUR_NONE, 2);
    VALUE(SC_CONTOUR_EXACT, 3);
    VALUE(SC_REST_CACHE_ON, 0);
    VALUE(SC_REST_CACHE_OFF, 1);
    VALUE(SC_RINGS_MAX, 32);
    VALUE(SC_VERDICT_NONE, 0);
    VALUE(SC_VERDICT_CLEAN, 1);
    VALUE(SC_VERDICT_FOUND, 2);
    VALUE(SC_VERDICT_INCOMPLETE, 3);
    VALUE(SC_MEET_NONE, 0);
    VALUE(SC_MEET_POINT, 1);
    VALUE(SC_MEET_SEGMENT, 2);
    VALUE(SC_MEET_AREA, 3);
    VALUE(SC_TASK_UPDATE_BOXES, 0);
    VALUE(SC_TASK_UPDATE_NORMALS, 1);
    VALUE(SC_TASK_ORIENTATION, 2);
    VALUE(SC_TASK_BOXES_ORIENTATION, 3);
    VALUE(SC_TASK_PRIMITIVES_ORIENTATION, 4);
    VALUE(SC_TASK_UPDATE_CONTOURS, 5);
    VALUE(SC_TASK_CONTOUR, 6);
    VALUE(SC_TASK_BOXES_CONTOUR, 7);
    VALUE(SC_TASK_PRIMITIVES_CONTOUR, 8);
    VALUE(SC_TASK_COUNT, 9);
}

#if !defined(SC_NO_SHARED)

enum { MAXIMUM_SYMBOLS = 256 };

typedef struct symbols {
    char names[MAXIMUM_SYMBOLS][128];
    size_t count;
} symbols;

/* Adds the last word of each line, without the version that nm may append. */
static void read_symbols(FILE *file, symbols *s)
{
    char line[512];
    while (fgets(line, sizeof(line), file) != NULL && s->count < MAXIMUM_SYMBOLS) {
        const char *space;
        line[strcspn(line, "\r\n@")] = '\0';
        space = strrchr(line, ' ');
        if (line[0] != '\0')
            snprintf(s->names[s->count++], sizeof(s->names[0]), "%.100s",
                     space != NULL ? space + 1 : line);
    }
}

static int has_symbol(const symbols *s, const char *name)
{
    for (size_t i = 0; i < s->count; ++i)
        if (strcmp(s->names[i], name) == 0) return 1;
    return 0;
}

static void exported_symbols(void)
{
    static symbols wanted, exported;
    const char *library = getenv("SC_SHARED_LIBRARY"), *folder = getenv("SC_LIB");
    const char *slash = strrchr(__FILE__, '/');
    char path[1024], command[1200];
    FILE *file;

    snprintf(path, sizeof(path), "%.*sabi_symbols.txt",
             slash == NULL ? 0 : (int)(slash + 1 - __FILE__), __FILE__);
    file = fopen(path, "r");
    if (!CHECK_MSG(file != NULL, "cannot read %s", path)) return;
    read_symbols(file, &wanted);
    fclose(file);
    CHECK(wanted.count > 0);

    if (library != NULL) {
        snprintf(path, sizeof(path), "%s", library);
    } else {
        snprintf(path, sizeof(path), "%s/libstarcontour.so", folder != NULL ? folder : "build/lib");
    }
    file = fopen(path, "rb");
    if (!CHECK_MSG(file != NULL, "cannot read %s", path)) return;
    fclose(file);
    snprintf(command, sizeof(command), "nm -D --defined-only '%s'", path);
    file = popen(command, "r");
    if (!CHECK(file != NULL)) return;
    read_symbols(file, &exported);
    CHECK_MSG(pclose(file) == 0, "%s", command);

    for (size_t i = 0; i < wanted.count; ++i)
        CHECK_MSG(has_symbol(&exported, wanted.names[i]), "%s is not exported", wanted.names[i]);
    for (size_t i = 0; i < exported.count; ++i)
        CHECK_MSG(has_symbol(&wanted, exported.names[i]), "%s is exported", exported.names[i]);
}

#else

static void exported_symbols(void)
{
    test_note("skipped: no shared library under sanitizers");
}

#endif

SC_TEST_MAIN(SC_TEST(structures), SC_TEST(enumerators), SC_TEST(exported_symbols))
