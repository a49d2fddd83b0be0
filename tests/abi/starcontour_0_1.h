/*
 * The declarations of starcontour.h as version 0.1 had them first, without comments: what a program
 * was compiled with that now meets a newer library. See tests/abi/old_caller.c.
 *
 * SPDX-License-Identifier: MIT
 *
 * Frozen: it changes only where the binary interface is broken on purpose and a new snapshot, named
 * by its version, takes its place.
 */
#ifndef STARCONTOUR_H
#define STARCONTOUR_H

#include <stdint.h>

#define SC_VERSION_MAJOR 0
#define SC_VERSION_MINOR 1
#define SC_VERSION_PATCH 0
#define SC_VERSION_NUMBER (SC_VERSION_MAJOR * 10000 + SC_VERSION_MINOR * 100 + SC_VERSION_PATCH)

#if defined(_WIN32) && defined(SC_SHARED)
#  if defined(SC_BUILDING)
#    define SC_API __declspec(dllexport)
#  else
#    define SC_API __declspec(dllimport)
#  endif
#elif defined(__GNUC__)
#  define SC_API __attribute__((visibility("default")))
#else
#  define SC_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

typedef int32_t sc_status;

enum {
    SC_OK = 0,
    SC_ERROR_NULL = 1,
    SC_ERROR_STRUCT_SIZE = 2,
    SC_ERROR_OPTION = 3,
    SC_ERROR_EMPTY = 4,
    SC_ERROR_COUNT = 5,
    SC_ERROR_STRIDE = 6,
    SC_ERROR_INDEX = 7,
    SC_ERROR_NOT_FINITE = 8,
    SC_ERROR_VERTEX_COUNT = 9,
    SC_ERROR_MEMORY = 10,
    SC_ERROR_SHORT_BUFFER = 11,
    SC_ERROR_WORKSPACE = 12,
    SC_ERROR_WELD_MAP = 13,
    SC_ERROR_TREE = 14,
    SC_ERROR_PARTITION = 15,
    SC_ERROR_UNSUPPORTED = 16,
    SC_ERROR_ALIGNMENT = 17,
    SC_ERROR_LEVEL = 18
};

SC_API const char *sc_status_string(sc_status status);

SC_API uint32_t sc_version(void);
SC_API const char *sc_version_string(void);

#define SC_ALIGNMENT 64

typedef struct sc_allocator {
    void *(*allocate)(void *user, uint64_t size, uint64_t alignment);
    void (*release)(void *user, void *memory, uint64_t size);
    void *user;
} sc_allocator;

enum { SC_FLOAT = 0, SC_DOUBLE = 1 };

enum { SC_UINT32 = 0, SC_UINT16 = 1 };

#define SC_NONE 0xffffffffu

typedef struct sc_mesh {
    uint32_t struct_size;
    uint32_t vertex_count;
    uint32_t triangle_count;
    uint32_t position_type;
    uint32_t position_stride;
    uint32_t index_type;
    uint32_t index_stride;
    uint32_t reserved;
    const void *positions;
    const void *indices;
} sc_mesh;

typedef struct sc_pose {
    uint32_t struct_size;
    uint32_t vertex_count;
    uint32_t position_type;
    uint32_t position_stride;
    const void *positions;
} sc_pose;

enum { SC_WELD_REST = 0, SC_WELD_MAP = 1, SC_WELD_NONE = 2 };

enum {
    SC_PARTITION_FAST = 0,
    SC_PARTITION_ORDER = 1,
    SC_PARTITION_TREE = 2,
    SC_PARTITION_BISECT = 3
};

typedef struct sc_tree_node {
    uint32_t left, right;
    uint32_t first, count;
} sc_tree_node;

typedef struct sc_dual_graph {
    uint32_t struct_size;
    uint32_t node_count;
    const int32_t *offsets;
    const int32_t *neighbors;
    const int32_t *weights;
} sc_dual_graph;

typedef sc_status (*sc_bisect)(void *user, const sc_dual_graph *graph, uint32_t left_target,
                               uint8_t *side);

typedef struct sc_build_options {
    uint32_t struct_size;
    uint32_t weld;
    uint32_t partition;
    uint32_t tree_count;
    const uint32_t *weld_map;
    const uint32_t *order;
    const sc_tree_node *tree;
    sc_bisect bisect;
    void *bisect_user;
    const sc_allocator *allocator;
} sc_build_options;

typedef struct sc_model sc_model;

SC_API sc_status sc_build(const sc_mesh *mesh, const sc_build_options *options, sc_model **model);

SC_API void sc_model_free(sc_model *model);

typedef struct sc_model_info {
    uint32_t struct_size;
    uint32_t vertex_count;
    uint32_t point_count;
    uint32_t triangle_count;
    uint32_t edge_count;
    uint32_t component_count;
    uint32_t boundary_edges;
    uint32_t irregular_edges;
    uint32_t leaf_count;
    uint32_t level_count;
    uint32_t node_count;
    uint32_t segment_count;
    uint64_t topology_hash;
    uint64_t model_bytes;
    uint64_t workspace_bytes;
} sc_model_info;

SC_API sc_status sc_model_get_info(const sc_model *model, sc_model_info *info);

typedef struct sc_level_info {
    uint32_t struct_size;
    uint32_t patch_count;
    uint32_t connected_patches;
    uint32_t segment_count;
    uint32_t self_nodes;
    uint32_t self_oriented;
    uint32_t self_culled;
    uint32_t pair_nodes;
    uint32_t pair_oriented;
    uint32_t pair_culled;
} sc_level_info;

SC_API sc_status sc_model_get_level(const sc_model *model, uint32_t level, sc_level_info *info);

SC_API sc_status sc_model_get_patches(const sc_model *model, uint32_t level,
                                      uint32_t *patch_of_triangle, uint64_t capacity);

typedef struct sc_workspace sc_workspace;

SC_API sc_status sc_workspace_size(const sc_model *model, uint64_t *size);

SC_API sc_status sc_workspace_init(const sc_model *model, void *memory, uint64_t size,
                                   sc_workspace **workspace);

SC_API sc_status sc_workspace_create(const sc_model *model, const sc_allocator *allocator,
                                     sc_workspace **workspace);

SC_API void sc_workspace_free(sc_workspace *workspace);

enum { SC_OUTPUT_PAIRS = 0, SC_OUTPUT_COUNT = 1, SC_OUTPUT_ANY = 2 };

enum { SC_PAIRS_TRIANGLE = 0, SC_PAIRS_EDGE = 1 };

enum { SC_CONTACT_TOUCHING = 0, SC_CONTACT_PROPER = 1 };

enum { SC_METHOD_DEFAULT = 0, SC_METHOD_SCTT = 1, SC_METHOD_AABB_SCTT = 2, SC_METHOD_AABB = 3 };

enum { SC_CONTOUR_DEFAULT = 0, SC_CONTOUR_STAR = 1, SC_CONTOUR_NONE = 2 };

enum { SC_REST_CACHE_ON = 0, SC_REST_CACHE_OFF = 1 };

typedef struct sc_query_options {
    uint32_t struct_size;
    uint32_t output;
    uint32_t pairs;
    uint32_t contact;
    uint32_t method;
    uint32_t contour;
    uint32_t rest_cache;
    uint32_t reserved;
} sc_query_options;

typedef struct sc_pair {
    uint32_t a, b;
} sc_pair;

enum {
    SC_TASK_UPDATE_BOXES = 0,
    SC_TASK_UPDATE_NORMALS = 1,
    SC_TASK_ORIENTATION = 2,
    SC_TASK_BOXES_ORIENTATION = 3,
    SC_TASK_PRIMITIVES_ORIENTATION = 4,
    SC_TASK_UPDATE_CONTOURS = 5,
    SC_TASK_CONTOUR = 6,
    SC_TASK_BOXES_CONTOUR = 7,
    SC_TASK_PRIMITIVES_CONTOUR = 8,
    SC_TASK_COUNT = 9
};

typedef struct sc_stats {
    uint32_t struct_size;
    uint32_t reserved;
    uint64_t total_nanoseconds;
    uint64_t nanoseconds[SC_TASK_COUNT];
    uint64_t counts[SC_TASK_COUNT];
    uint64_t nodes_visited;
    uint64_t nodes_oriented;
    uint64_t nodes_culled;
    uint64_t leaf_pairs;
    uint64_t exact_fallbacks;
} sc_stats;

typedef struct sc_result {
    uint32_t struct_size;
    uint32_t collides;
    uint64_t count;
    uint64_t capacity;
    sc_pair *pairs;
    sc_stats *stats;
} sc_result;

SC_API sc_status sc_query(const sc_model *model, sc_workspace *workspace, const sc_pose *pose,
                          const sc_query_options *options, sc_result *result);

#ifdef __cplusplus
}
#endif

#endif
