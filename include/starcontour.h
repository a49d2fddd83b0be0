/*
 * starcontour: every self-collision of a deforming triangle mesh, exactly and fast.
 *
 * SPDX-License-Identifier: MIT
 *
 * In six lines:
 *
 *     sc_build           once per topology: a mesh in its rest pose becomes an immutable sc_model
 *     sc_workspace_*     once per instance or thread: everything that a query writes to
 *     sc_query           once per pose: new vertex positions in, all intersecting pairs out
 *     sc_contacts        where these meet, if wanted
 *     sc_workspace_free, sc_model_free
 *
 * What is promised. A query reports the pairs that exact arithmetic on the given coordinates
 * reports: none is missed and none is added, for every finite float or double, touching, coplanar,
 * degenerate and duplicate triangles included. The one exception is asked for by name:
 * SC_CONTOUR_NONE, which is there for measuring and can miss pairs.
 *
 * Any triangle soup is a mesh: boundaries, several components (collisions between components are
 * self-collisions of the mesh), non-manifold edges, inconsistent orientation, duplicate and
 * degenerate triangles. What is irregular is only culled less.
 *
 * Threads. The library has no global state and starts no threads. An sc_model is never written to
 * after sc_build and may be shared by any number of threads. An sc_workspace belongs to one call
 * at a time. Calls on different workspaces may run concurrently.
 *
 * Memory. sc_build and sc_workspace_create allocate through the caller's sc_allocator, if there is
 * one. sc_query allocates nothing. 32 kilobytes of stack are enough for any call.
 *
 * Errors. Calls return an sc_status. On an error nothing is leaked, outputs are as each call says,
 * and the model and workspace remain usable. The library never prints, exits, aborts or raises, and
 * installs no signal handlers.
 *
 * Structures. The first member of each structure that may grow is struct_size: set it to
 * sizeof(the structure) and every member you do not use to zero, which is its default. A library
 * newer than the caller accepts the caller's smaller size and takes the missing members as zero; an
 * older one accepts a larger size if what it does not know is zero. Structures that the library
 * fills are filled as far as their struct_size reaches. A size is a multiple of the size of a
 * pointer and reaches at least to the end of the members of version 0.1 that have no default.
 *
 * Versions. Before 1.0 a change of the minor number may break the binary interface, afterwards only
 * a change of the major number. The shared library's soname ends in that number: major.minor before
 * 1.0 (libstarcontour.so.0.1), then major. Under one soname, calls, enumerators and members at the
 * ends of structures with a struct_size are added; nothing else changes. So a program runs with
 * every library of the soname it was linked with that is not older. Enumerators keep their values
 * and are never reused.
 *
 * Source: S. C. Schvartzman, A. G. Perez, M. A. Otaduy, "Star-Contours for Efficient Hierarchical
 * Self-Collision Detection", ACM Transactions on Graphics 29(4) (SIGGRAPH 2010).
 */
#ifndef STARCONTOUR_H
#define STARCONTOUR_H

#include <stdint.h>

/* The version of this header; sc_version is that of the library that runs. */
#define SC_VERSION_MAJOR 0
#define SC_VERSION_MINOR 1
#define SC_VERSION_PATCH 0
#define SC_VERSION_NUMBER (SC_VERSION_MAJOR * 10000 + SC_VERSION_MINOR * 100 + SC_VERSION_PATCH)

/* Define SC_SHARED where the shared library is used on Windows, and SC_BUILDING to build it. */
#if defined(_WIN32) && defined(SC_SHARED)
#  if defined(SC_BUILDING)
#    define SC_API __declspec(dllexport)
#  else
#    define SC_API __declspec(dllimport)
#  endif
#elif defined(__GNUC__) && !defined(_WIN32)
#  define SC_API __attribute__((visibility("default")))
#else
#  define SC_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* ------------------------------------------------------------------------------------------------
 * Status
 */

/* One of the values below. */
typedef int32_t sc_status;

enum {
    SC_OK = 0,
    SC_ERROR_NULL = 1,          /* a pointer that the call needs is NULL */
    SC_ERROR_STRUCT_SIZE = 2,   /* a struct_size this library cannot read */
    SC_ERROR_OPTION = 3,        /* a member has a value that it cannot have */
    SC_ERROR_EMPTY = 4,         /* a mesh without triangles or without vertices */
    SC_ERROR_COUNT = 5,         /* more vertices or triangles than can be indexed or addressed */
    SC_ERROR_STRIDE = 6,        /* a stride smaller than what it steps over */
    SC_ERROR_INDEX = 7,         /* a triangle names a vertex that does not exist */
    SC_ERROR_NOT_FINITE = 8,    /* NaN or infinity at a vertex that a triangle uses */
    SC_ERROR_VERTEX_COUNT = 9,  /* the pose's number of vertices is not the model's */
    SC_ERROR_MEMORY = 10,       /* an allocation failed */
    SC_ERROR_SHORT_BUFFER = 11, /* the caller's array is too short; the count needed is reported */
    SC_ERROR_WORKSPACE = 12,    /* the workspace was made for another model or fewer workers, or is
                                   too small */
    SC_ERROR_WELD_MAP = 13,     /* a weld map entry out of range or not a representative */
    SC_ERROR_TREE = 14,         /* the caller's leaf order or tree is not one, or is too deep */
    SC_ERROR_PARTITION = 15,    /* the caller's bisection function failed or broke its contract */
    SC_ERROR_UNSUPPORTED = 16,  /* not part of this build of the library */
    SC_ERROR_ALIGNMENT = 17,    /* memory that must be aligned to SC_ALIGNMENT is not */
    SC_ERROR_LEVEL = 18,        /* the model has no such level */
    SC_ERROR_NOT_SAVED = 19,    /* the data are no saved model, or no record */
    SC_ERROR_TRUNCATED = 20,    /* saved data that end too early */
    SC_ERROR_BYTE_ORDER = 21,   /* saved data of a machine with the other byte order */
    SC_ERROR_TOO_NEW = 22,      /* saved data in a later format than this library reads */
    SC_ERROR_TOO_OLD = 23,      /* saved data in an earlier format than this library reads */
    SC_ERROR_CHECKSUM = 24,     /* saved data that were changed since */
    SC_ERROR_INCONSISTENT = 25, /* saved data that nobody saved: whole, but contradictory */
    SC_ERROR_TOPOLOGY = 26,     /* the saved model is not the one that was asked for */
    SC_ERROR_PAIRS = 27,        /* a list of pairs is not sorted or names what does not exist */
    SC_ERROR_INCOMPLETE = 28,   /* a query was cancelled or ran out of budget: SC_VERDICT_... */
    SC_ERROR_BOXES_ONLY = 29 /* asks for culling on a model without what it needs: SC_MODEL_BOXES */
};

/* A short English text for a status, never NULL, owned by the library. */
SC_API const char *sc_status_string(sc_status status);

/* SC_VERSION_NUMBER and "major.minor.patch" of the library that runs. */
SC_API uint32_t sc_version(void);
SC_API const char *sc_version_string(void);

/* ------------------------------------------------------------------------------------------------
 * Memory
 */

/* Alignment, in bytes, of all memory the library asks for or is given to keep. */
#define SC_ALIGNMENT 64

/*
 * The caller's memory functions. Calls come from the thread that called the library.
 *   allocate  size > 0 bytes aligned to alignment (a power of two, at most SC_ALIGNMENT), or NULL
 *   release   memory got from allocate with this size; never NULL
 *   user      passed through
 * Where a pointer to an sc_allocator is NULL, malloc and free are used.
 */
typedef struct sc_allocator {
    void *(*allocate)(void *user, uint64_t size, uint64_t alignment);
    void (*release)(void *user, void *memory, uint64_t size);
    void *user;
} sc_allocator;

/* ------------------------------------------------------------------------------------------------
 * Hooks
 */

/* How much a message matters. */
enum {
    SC_LOG_NOTE = 0,    /* good to know, such as how many vertices were welded */
    SC_LOG_WARNING = 1, /* works, but perhaps not as meant or as fast as it could */
    SC_LOG_ERROR = 2    /* why a call fails, in more detail than its status */
};

/*
 * Functions that the library calls, each of which may be NULL, in the thread that called the
 * library. They must not call it back with what that call was given, nor leave by longjmp or an
 * exception.
 *   log     gets messages in English, without a line end, that last as long as the call. Of what is
 *           wrong with an argument it hears which member it is, and why, as in
 *           "options.tasks.workers is 4, but the workspace is for 2"; calls without hooks, such as
 *           those that make a workspace, tell nobody
 *   failed  gets each internal invariant that does not hold: a bug in the library, please report
 *           it. Invariants are looked at only if the library was compiled with SC_VALIDATE (make
 *           config=debug or sanitize); such a library goes on when failed returns, and ends the
 *           program by assert if it is NULL
 *   user    passed through
 */
typedef struct sc_hooks {
    uint32_t struct_size;
    uint32_t reserved; /* 0 */
    void (*log)(void *user, uint32_t level, const char *message);
    void (*failed)(void *user, const char *condition, const char *file, uint32_t line);
    void *user;
} sc_hooks;

/* ------------------------------------------------------------------------------------------------
 * Meshes and poses
 */

/* Scalar types of position arrays. */
enum { SC_FLOAT = 0, SC_DOUBLE = 1 };

/* Integer types of index arrays. */
enum { SC_UINT32 = 0, SC_UINT16 = 1 };

/* "None" wherever an index is expected. */
#define SC_NONE 0xffffffffu

/*
 * A triangle mesh in its rest pose. The arrays are the caller's and are only read, during the call.
 * They need no alignment. The rest pose decides welding and partition, and what counts as
 * "unlikely to be culled" (rest-shape caching); it has no influence on which pairs a query reports.
 */
typedef struct sc_mesh {
    uint32_t struct_size;
    uint32_t vertex_count;    /* 1 or more */
    uint32_t triangle_count;  /* 1 to 0x55555554, so that a corner number 3 t + k fits 32 bits */
    uint32_t position_type;   /* SC_FLOAT or SC_DOUBLE */
    uint32_t position_stride; /* bytes to the next vertex, 0: packed, else at least 3 scalars */
    uint32_t index_type;      /* SC_UINT32 or SC_UINT16 */
    uint32_t index_stride;    /* bytes to the next triangle, 0: packed, else at least 3 indices */
    uint32_t reserved;        /* 0 */
    const void *positions;    /* vertex_count times x, y, z */
    const void *indices;      /* triangle_count times three vertex numbers below vertex_count */
} sc_mesh;

/*
 * New positions for a model's vertices, in the order of the mesh it was built from. Type and stride
 * may differ from the mesh's. The array is only read, during the call.
 */
typedef struct sc_pose {
    uint32_t struct_size;
    uint32_t vertex_count;    /* as in the mesh */
    uint32_t position_type;   /* SC_FLOAT or SC_DOUBLE */
    uint32_t position_stride; /* bytes to the next vertex, 0: packed, else at least 3 scalars */
    const void *positions;    /* vertex_count times x, y, z */
} sc_pose;

/* ------------------------------------------------------------------------------------------------
 * Tasks
 */

/*
 * The host's threads, for one query, or for building a model, to use several of: a job system, or a
 * pool of threads. Without, a call runs in the thread that makes it. It cuts its work into jobs one
 * after the other, and each job into parts that may run in any order and at once.
 *
 *   workers  how many parts may run at once; 0 and 1: one. For a query at most what the workspace
 *            was made for (sc_workspace_options.workers), else SC_ERROR_WORKSPACE; for building at
 *            most SC_WORKERS_MAX, else SC_ERROR_OPTION
 *   enqueue  runs the count parts of a job, 1 or more: run(context, part, worker) once for each
 *            part from 0 to count - 1, in any threads, worker being a number below workers that no
 *            other running part of the job has. May return before they are done, or run them all
 *            itself. What it returns is passed to finish and may be NULL
 *   finish   returns when all parts of that job are done. What they wrote must be visible to the
 *            caller then, as what the caller wrote before enqueue must be to the parts: so it is
 *            with any locks, joins or queues of threads
 *   user     passed through
 *
 * enqueue and finish are called in the thread that called the library, in turn: there is one job of
 * a call at a time. run takes 32 kilobytes of stack, does not block and calls neither of them.
 * They must not fail: without a free thread, run the parts in the caller's:
 *
 *     void *enqueue(void *user, void (*run)(void *context, uint32_t part, uint32_t worker),
 *                   void *context, uint32_t count)
 *     {
 *         for (uint32_t part = 0; part < count; ++part) run(context, part, 0);
 *         return NULL;
 *     }
 */
typedef struct sc_tasks {
    uint32_t struct_size;
    uint32_t workers;
    void *(*enqueue)(void *user, void (*run)(void *context, uint32_t part, uint32_t worker),
                     void *context, uint32_t count);
    void (*finish)(void *user, void *task);
    void *user;
} sc_tasks;

/* ------------------------------------------------------------------------------------------------
 * Building
 */

/* Which vertices are one. Welded vertices have the position of their representative in every
   pose. */
enum {
    SC_WELD_REST = 0, /* those with equal rest positions (-0 equals 0); the lowest number that a
                         triangle uses represents them */
    SC_WELD_MAP = 1,  /* those with the same weld_map entry */
    SC_WELD_NONE = 2  /* none */
};

/* Where the hierarchy of patches comes from. */
enum {
    SC_PARTITION_FAST = 0,  /* the built-in recursive bisection */
    SC_PARTITION_ORDER = 1, /* the caller's order: consecutive triangles form patches */
    SC_PARTITION_TREE = 2,  /* the caller's binary tree, balanced or not */
    SC_PARTITION_BISECT = 3 /* recursive bisection by the caller's function, such as sc_metis_bisect
                               of starcontour_metis.h */
};

/*
 * A node of a caller's tree. An inner node names its two children. A leaf has left == right ==
 * SC_NONE and owns order[first] to order[first + count - 1]; its count is 1 or more. Leaves with
 * more triangles than the library's clusters hold are split on, in order. From 2^28 clusters on,
 * whatever the partition, sc_build returns SC_ERROR_COUNT.
 */
typedef struct sc_tree_node {
    uint32_t left, right;
    uint32_t first, count; /* read in leaves only */
} sc_tree_node;

/*
 * The dual graph of a patch that is to be cut in two: one node per triangle, an arc each way
 * between triangles that share an edge.
 */
typedef struct sc_dual_graph {
    uint32_t struct_size;
    uint32_t node_count;      /* 2 or more */
    const int32_t *offsets;   /* node_count + 1: node i has arcs offsets[i] to offsets[i + 1] - 1 */
    const int32_t *neighbors; /* offsets[node_count] node numbers */
    const int32_t *weights;   /* offsets[node_count] weights from 1 to 1000: rest length of the
                                 edge, less where the mesh bends there: a half at right angles, a
                                 third where it folds back */
} sc_dual_graph;

/*
 * Cuts a patch in two: writes 0 or 1 to side[0 .. node_count - 1] so that about left_target nodes
 * get 0. Returns SC_OK, or any other status to give up, which ends sc_build with that status. The
 * library evens out sizes and mends what is not connected afterwards. It is not asked about tubes
 * and strands so thin that a leaf cluster goes round them: these are cut into rings.
 */
typedef sc_status (*sc_bisect)(void *user, const sc_dual_graph *graph, uint32_t left_target,
                               uint8_t *side);

/*
 * Whether sc_build tries the orientation and the star-contour test on the rest pose, which takes
 * 0.2 to 0.5 microseconds a triangle more. What fails is marked in the model, for rest-shape
 * caching by queries with SC_CONTOUR_STAR, and counted for sc_level_info. Other queries have no use
 * for it.
 */
enum { SC_REST_UNMARKED = 0, SC_REST_MARKED = 1 };

/*
 * What a model is for.
 *   SC_MODEL_FULL   many poses, by any method
 *   SC_MODEL_BOXES  few poses, by boxes alone: SC_METHOD_AABB, or SC_STEP_METHOD_TWO_BOXES and
 *                   _SWEPT. All that only culling needs is left out, and with SC_PARTITION_FAST
 *                   patches are cut from a space-filling curve. Building takes 0.25 to 0.4 of the
 *                   time (of thin tubes 0.8), model and workspace less than half of the memory, and
 *                   a query 1.2 to 2.9 times as long as by SC_METHOD_AABB on a full model (where
 *                   many thin tubes lie close together 4.4 times): the faster way for a mesh that
 *                   is asked about once, or up to some ten times. Pairs are the same. The default
 *                   methods are those by boxes on such a model; what asks for another one, for a
 *                   contour test, or for SC_REST_MARKED, ends with SC_ERROR_BOXES_ONLY
 */
enum { SC_MODEL_FULL = 0, SC_MODEL_BOXES = 1 };

typedef struct sc_build_options {
    uint32_t struct_size;
    uint32_t weld;            /* SC_WELD_... */
    uint32_t partition;       /* SC_PARTITION_... */
    uint32_t tree_count;      /* nodes of tree */
    const uint32_t *weld_map; /* SC_WELD_MAP: vertex_count entries r with weld_map[r] == r */
    const uint32_t *order;    /* SC_PARTITION_ORDER, _TREE: triangle_count, a permutation */
    const sc_tree_node *tree; /* SC_PARTITION_TREE: tree_count nodes, node 0 the root, at most 60
                                 nodes from the root to a leaf */
    sc_bisect bisect;         /* SC_PARTITION_BISECT */
    void *bisect_user;        /* passed to bisect */
    const sc_allocator *allocator; /* copied; its functions must outlive the model */
    const sc_hooks *hooks;         /* for this call */
    uint32_t rest;                 /* SC_REST_... */
    uint32_t content;              /* SC_MODEL_... */
    const sc_tasks *tasks;         /* threads to build with, at most SC_WORKERS_MAX; NULL: one */
} sc_build_options;

/* A mesh made ready for queries: one block of flat arrays, immutable. */
typedef struct sc_model sc_model;

/*
 * Builds a model of a mesh. options may be NULL. On success *model is the new model, to be freed
 * with sc_model_free; otherwise *model is NULL. With the built-in partition, 0.4 to 1.4
 * microseconds a triangle (regular grids and thin tubes least, irregular meshes of a million
 * triangles most) and, while it runs, up to 300 bytes a triangle; with METIS 5 to 7 microseconds a
 * triangle; with SC_MODEL_BOXES 0.2 to 0.5 microseconds and 130 bytes a triangle.
 *
 * With options.tasks several of the host's threads build. The model is the same, bit for bit,
 * whatever their number, and nearly all steps are shared out; not a cut by the caller (bisect) or
 * by METIS, nor SC_REST_MARKED. The allocator, the hooks and bisect are called in the thread that
 * called sc_build alone.
 */
SC_API sc_status sc_build(const sc_mesh *mesh, const sc_build_options *options, sc_model **model);

/* Frees a model, which no call may be using. NULL is allowed. */
SC_API void sc_model_free(sc_model *model);

/* What there is to know about a model. */
typedef struct sc_model_info {
    uint32_t struct_size;
    uint32_t vertex_count;    /* as in the mesh */
    uint32_t point_count;     /* distinct vertices that triangles use, after welding */
    uint32_t triangle_count;  /* as in the mesh */
    uint32_t edge_count;      /* distinct edges, after welding */
    uint32_t component_count; /* parts that share no vertex, after welding */
    uint32_t boundary_edges;  /* edges of one triangle */
    uint32_t irregular_edges; /* edges of three or more triangles, or of two running the same way */
    uint32_t leaf_count;      /* leaf clusters */
    uint32_t level_count;     /* levels of the patch hierarchy; level 0 is the whole mesh */
    uint32_t node_count;    /* nodes of the self-collision test tree; 0 with SC_MODEL_BOXES only */
    uint32_t segment_count; /* nodes of the contour segment forest */
    uint64_t topology_hash; /* equal for equal triangles, welding, partition and SC_MODEL_... */
    uint64_t model_bytes;   /* size of the model */
    uint64_t workspace_bytes; /* size of a workspace for it */
    uint64_t peak_bytes;      /* most that sc_build or sc_model_load held at once, model included */
    uint64_t allocations;     /* how often they allocated; both 0 for a model loaded in place */
} sc_model_info;

/* Fills *info, as far as info->struct_size reaches. */
SC_API sc_status sc_model_get_info(const sc_model *model, sc_model_info *info);

/* One level of the patch hierarchy, as the rest pose saw it. */
typedef struct sc_level_info {
    uint32_t struct_size;
    uint32_t patch_count;       /* patches at this level */
    uint32_t connected_patches; /* those that are connected through edges; 0 as all that follows
                                   with SC_MODEL_BOXES */
    uint32_t segment_count;     /* contour segments at this level */
    uint32_t self_nodes;        /* test-tree nodes of one patch against itself */
    /* how many of them passed the orientation test in the rest pose, and the star-contour test as
       well: 0 unless the model was built with SC_REST_MARKED */
    uint32_t self_oriented;
    uint32_t self_culled;
    uint32_t pair_nodes; /* the same for nodes of two adjacent patches */
    uint32_t pair_oriented;
    uint32_t pair_culled;
} sc_level_info;

/* Fills *info for a level from 0 to level_count - 1; SC_ERROR_LEVEL for any other. */
SC_API sc_status sc_model_get_level(const sc_model *model, uint32_t level, sc_level_info *info);

/*
 * Writes to patch_of_triangle[t], for every triangle t of the mesh, the number of its patch at a
 * level. The array has capacity entries; fewer than triangle_count: SC_ERROR_SHORT_BUFFER, and
 * nothing is written.
 */
SC_API sc_status sc_model_get_patches(const sc_model *model, uint32_t level,
                                      uint32_t *patch_of_triangle, uint64_t capacity);

/* ------------------------------------------------------------------------------------------------
 * Saved models
 *
 * Build once, with the slowest partition there is time for, and ship the result: loading needs
 * neither the mesh nor METIS. The bytes are those of the model in memory behind a header with a
 * format version, the byte order and a checksum. They serve all machines of that byte order, 32 or
 * 64 bits. The format may change with each minor version before 1.0: keep the mesh.
 */

/* Writes the number of bytes that sc_model_save writes: model_bytes of sc_model_info. */
SC_API sc_status sc_model_save_size(const sc_model *model, uint64_t *size);

/*
 * Saves a model: writes *written bytes to memory, of which there are size, at any alignment. Equal
 * models give equal bytes. SC_ERROR_SHORT_BUFFER if they do not fit: nothing is written, and
 * *written is what is needed. written may be NULL.
 */
SC_API sc_status sc_model_save(const sc_model *model, void *memory, uint64_t size,
                               uint64_t *written);

/* Where a loaded model is. */
enum {
    SC_LOAD_COPY = 0,    /* in memory of its own, as one that was built */
    SC_LOAD_IN_PLACE = 1 /* in the data: nothing is copied, and sc_model_free does nothing. The
                            data are aligned to SC_ALIGNMENT, are never written to, and stay as
                            they are as long as the model is used: so they may be a file mapped
                            read-only */
};

typedef struct sc_load_options {
    uint32_t struct_size;
    uint32_t mode;                 /* SC_LOAD_... */
    uint64_t topology_hash;        /* 0, or SC_ERROR_TOPOLOGY for a model with any other */
    const sc_allocator *allocator; /* copied; its functions must outlive the model */
    const sc_hooks *hooks;         /* for this call; the log hears more of SC_ERROR_TOPOLOGY and
                                      _INCONSISTENT, too */
} sc_load_options;

/*
 * Makes a model of what sc_model_save wrote: data, of which there are size bytes; those behind the
 * model are ignored. options may be NULL. On success *model is the model, to be freed with
 * sc_model_free; otherwise it is NULL.
 *
 * Any bytes may be given. Data that are cut off, changed, foreign, of another version or impossible
 * are refused, each with a status of its own (SC_ERROR_NOT_SAVED to SC_ERROR_TOPOLOGY). Everything
 * that a query will rely on is checked first: a model that was made up by someone who knows the
 * format may be loaded and give wrong answers, but no query on it reads or writes where it must
 * not, or fails to end.
 *
 * 0.06 to 0.1 microseconds a triangle in place, 0.1 to 0.16 with the copy. Either mode takes some
 * 1.1 bytes a triangle from the allocator while it checks, and SC_LOAD_IN_PLACE nothing that stays.
 */
SC_API sc_status sc_model_load(const void *data, uint64_t size, const sc_load_options *options,
                               sc_model **model);

/* ------------------------------------------------------------------------------------------------
 * Workspaces
 */

/* All that a query writes to. It fits the model it was made for and belongs to one call at a
   time. */
typedef struct sc_workspace sc_workspace;

/* Writes the number of bytes that a workspace for this model takes. */
SC_API sc_status sc_workspace_size(const sc_model *model, uint64_t *size);

/*
 * Makes a workspace in the caller's memory: size bytes, at least sc_workspace_size, aligned to
 * SC_ALIGNMENT. It needs no freeing and must not be moved.
 */
SC_API sc_status sc_workspace_init(const sc_model *model, void *memory, uint64_t size,
                                   sc_workspace **workspace);

/* Allocates a workspace. allocator may be NULL. On an error *workspace is NULL. */
SC_API sc_status sc_workspace_create(const sc_model *model, const sc_allocator *allocator,
                                     sc_workspace **workspace);

/* What a workspace is for besides plain queries; a sum. */
enum {
    SC_WORKSPACE_STEP = 1, /* sc_query_step: about 34 bytes a triangle more, and 80 kilobytes a
                              worker */
    SC_WORKSPACE_NEAR = 2, /* sc_query_near, and sc_query_step: 90 kilobytes a worker more than for
                              that alone */
    SC_WORKSPACE_ROOM = 4  /* other workspaces may use its room, see sc_workspace_options.room:
                              each worker takes twice as much */
};

/* The largest number of workers. */
#define SC_WORKERS_MAX 256

typedef struct sc_workspace_options {
    uint32_t struct_size;
    uint32_t flags;    /* sum of SC_WORKSPACE_... */
    uint32_t workers;  /* threads that a query may use at once, see sc_tasks; 0 and 1: one, at
                          most SC_WORKERS_MAX */
    uint32_t reserved; /* 0 */
    const sc_allocator *allocator; /* for sc_workspace_create_for: copied */
    /*
     * NULL, or a workspace of the same model, for as many workers and with the same flags and
     * SC_WORKSPACE_ROOM. Then this one is small: it keeps what is of a pose, and uses the rest of
     * the other one, which must stay where it is as long as this one is asked. One call at a time
     * may use a room, about one of its workspaces, or about several as objects: many characters of
     * one model.
     */
    sc_workspace *room;
} sc_workspace_options;

/*
 * The same three for a workspace of any kind; options may be NULL, then they are the same. Such a
 * workspace also serves plain queries. Each worker but the first takes about 12 bytes a vertex and
 * 130 kilobytes more, the second some 100 kilobytes besides. SC_ERROR_OPTION: unknown flags, too
 * many workers, reserved is not 0, or flags or workers are not those of the room;
 * SC_ERROR_WORKSPACE: the room is of another model.
 */
SC_API sc_status sc_workspace_size_for(const sc_model *model, const sc_workspace_options *options,
                                       uint64_t *size);
SC_API sc_status sc_workspace_init_for(const sc_model *model, const sc_workspace_options *options,
                                       void *memory, uint64_t size, sc_workspace **workspace);
SC_API sc_status sc_workspace_create_for(const sc_model *model, const sc_workspace_options *options,
                                         sc_workspace **workspace);

/* Hooks for the queries on a workspace, copied; NULL for none, as at first. The log hears what
   is wrong with a query that is refused, and which vertex is NaN or infinite. */
SC_API sc_status sc_workspace_set_hooks(sc_workspace *workspace, const sc_hooks *hooks);

/* Frees what sc_workspace_create(_for) made; does nothing to what sc_workspace_init(_for) made.
   NULL is allowed. */
SC_API void sc_workspace_free(sc_workspace *workspace);

/* ------------------------------------------------------------------------------------------------
 * Queries
 */

/* What a query answers. */
enum {
    SC_OUTPUT_PAIRS = 0, /* all pairs, and their number */
    SC_OUTPUT_COUNT = 1, /* the number of pairs */
    SC_OUTPUT_ANY = 2    /* whether there is a pair; stops at the first */
};

/*
 * What a pair is. Triangles and edges are closed sets: with their boundaries.
 *
 * SC_PAIRS_TRIANGLE: two triangles, a < b, that meet elsewhere than in what they share:
 *   - sharing no vertex: they have a common point;
 *   - sharing one vertex: the edge opposite to it in one of them meets the other triangle;
 *   - sharing two vertices: they have a common point off the common edge, that is, they are folded
 *     flat onto each other;
 *   - sharing three vertices: always.
 * SC_PAIRS_EDGE: an edge a and a triangle b that have a common point and share no vertex. The edge
 * is given by a corner of a triangle: a = 3 t + k is the edge from vertex k to vertex (k + 1) % 3
 * of triangle t. An edge of several triangles is named by the one with the lowest number and then
 * the lowest k. A side from a vertex to itself is no edge.
 *
 * "Share" is said of vertex numbers after welding.
 */
enum { SC_PAIRS_TRIANGLE = 0, SC_PAIRS_EDGE = 1 };

/* What contact is enough. */
enum {
    SC_CONTACT_TOUCHING = 0, /* any common point */
    SC_CONTACT_PROPER = 1 /* a proper crossing: the interior of an edge passes through the interior
                             of a triangle from one side to the other, none of its vertices shared.
                             Triangle pairs: an edge of one does so with the other */
};

/* How pairs are sought. The answer is the same for all, but for contour SC_CONTOUR_NONE. The
   default is SC_METHOD_SCTT, on a model with SC_MODEL_BOXES SC_METHOD_AABB. */
enum {
    SC_METHOD_DEFAULT = 0,
    SC_METHOD_SCTT = 1,      /* self-collision test tree with orientation and contour tests */
    SC_METHOD_AABB_SCTT = 2, /* box recursion from the non-adjacent children of the test tree's
                                nodes: the paper's optimised tree of axis-aligned bounding boxes
                                (AABB) */
    SC_METHOD_AABB = 3       /* the plain tree of boxes, all that a model with SC_MODEL_BOXES needs;
                                on a full one the choice for strands and thin tubes alone, whose
                                patches face all directions: it looks at contours, too, but only at
                                those of two leaf clusters */
};

/* The contour test of SC_METHOD_SCTT. */
enum {
    SC_CONTOUR_DEFAULT = 0,
    SC_CONTOUR_STAR = 1, /* the paper's star-contour test */
    SC_CONTOUR_NONE = 2, /* no contour test: MISSES PAIRS; a floor to measure against */
    SC_CONTOUR_EXACT = 3 /* the default: is the contour simple? Passes nearly everywhere on a smooth
                            mesh. Keeps nothing from the rest pose */
};

/* Rest-shape caching (paper, section 8): tests that failed in the rest pose are taken as failed.
   Only with SC_CONTOUR_STAR and SC_CONTOUR_NONE, on models that were built with SC_REST_MARKED. */
enum { SC_REST_CACHE_ON = 0, SC_REST_CACHE_OFF = 1 };

/* Which instructions inner loops use. The answer is the same bit for bit. */
enum {
    SC_SIMD_BEST = 0,  /* the best that the machine has */
    SC_SIMD_BASE = 1,  /* what the library was compiled for: SSE2 on x86-64 */
    SC_SIMD_AVX2 = 2,  /* SC_ERROR_UNSUPPORTED where there is none, as for what follows */
    SC_SIMD_AVX512 = 3 /* with F, BW, DQ and VL */
};

/* A pair, as sc_query_options.pairs says. */
typedef struct sc_pair {
    uint32_t a, b;
} sc_pair;

/*
 * What something is and what it collides with, a bit for each of 32 categories of the caller's. Two
 * things collide if each has a category that is in the other's mask:
 * (x.category & y.mask) && (y.category & x.mask). Category 0 collides with nothing.
 */
typedef struct sc_group {
    uint32_t category;
    uint32_t mask;
} sc_group;

/* The largest ignore_rings. */
#define SC_RINGS_MAX 32

/*
 * Which pairs are not wanted. A pair is reported, counted, or ends a query for SC_OUTPUT_ANY only
 * if nothing here says no; culling is as without a filter, and so no wanted pair is missed. Arrays
 * are the caller's and are only read, during the call; they need the alignment of uint32_t. All
 * members but struct_size may be zero: nothing is left out. What members mean is said here of the
 * pairs of sc_query, and under "Filters of pairs of features" at sc_query_step of its pairs.
 *
 *   ignore_rings    1: leaves out pairs that share a vertex. n: pairs less than n edges of the mesh
 *                   apart, counted from the vertices of one to those of the other, after welding;
 *                   so for triangles, those within n rings of each other. At most SC_RINGS_MAX. An
 *                   edge and a triangle never share a vertex, and 1 is without effect on them
 *   vertex_groups   vertex_count groups. A triangle or edge is in all categories of its vertices,
 *                   and its mask is the union of theirs: at a border between groups it belongs to
 *                   both. For vertices welded together, the group of the one that represents them
 *                   is read
 *   triangle_groups triangle_count groups. An edge has the group of the triangle that names it,
 *                   a / 3. Where there are vertex groups as well, both must collide
 *   ignore          ignore_count pairs that are left out, in the numbers of this kind of pair,
 *                   sorted by a, then b, as a query reports them; repeats are allowed. With the
 *                   pairs of the rest pose here, only new contacts are reported:
 *                       sc_query(model, workspace, &rest_pose, &options, &result);
 *                       filter.ignore = result.pairs, filter.ignore_count = result.count;
 *   accept          called for each pair that nothing else leaves out, once, in any order, from
 *                   within sc_query, in the thread that called it; 0 leaves it out. It must not use
 *                   the workspace of the query. After SC_OUTPUT_ANY found a pair it is called no
 *                   more
 *
 * Cost: groups and the first ring are asked before triangles are tested. Each query reads
 * ignore once to see that it is sorted (about 1 ns a pair), and looks it up for each pair found.
 * More rings walk the mesh round pairs found: about 3 ignore_rings^2 vertices each.
 */
typedef struct sc_filter {
    uint32_t struct_size;
    uint32_t ignore_rings;
    const sc_group *vertex_groups;
    const sc_group *triangle_groups;
    const sc_pair *ignore;
    uint64_t ignore_count;
    int32_t (*accept)(void *user, uint32_t a, uint32_t b);
    void *accept_user; /* passed to accept */
} sc_filter;

typedef struct sc_query_options {
    uint32_t struct_size;
    uint32_t output;                 /* SC_OUTPUT_... */
    uint32_t pairs;                  /* SC_PAIRS_... */
    uint32_t contact;                /* SC_CONTACT_... */
    uint32_t method;                 /* SC_METHOD_... */
    uint32_t contour;                /* SC_CONTOUR_... */
    uint32_t rest_cache;             /* SC_REST_CACHE_... */
    uint32_t simd;                   /* SC_SIMD_... */
    const sc_filter *filter;         /* which pairs are not wanted, or NULL */
    const volatile uint32_t *cancel; /* not 0: stop; or NULL. See "Stopping early" at sc_query */
    uint64_t budget;                 /* units of work after which to stop; 0: no limit */
    const sc_tasks *tasks;           /* the host's threads, or NULL. See "Several threads" there */
} sc_query_options;

/* The nine tasks of a query (paper, table 1). */
enum {
    SC_TASK_UPDATE_BOXES = 0,      /* reading the pose and refitting boxes; counts boxes */
    SC_TASK_UPDATE_NORMALS = 1,    /* discrete normal cones; counts patches */
    SC_TASK_ORIENTATION = 2,       /* orientation tests; counts nodes */
    SC_TASK_BOXES_ORIENTATION = 3, /* box tests after failed orientation; counts pairs of boxes */
    SC_TASK_PRIMITIVES_ORIENTATION = 4, /* primitive tests after that; counts pairs of triangles */
    SC_TASK_UPDATE_CONTOURS = 5,        /* bounds of contour segments; counts segments */
    SC_TASK_CONTOUR = 6,                /* contour tests; counts nodes */
    SC_TASK_BOXES_CONTOUR = 7,          /* box tests after a failed contour test */
    SC_TASK_PRIMITIVES_CONTOUR = 8,     /* primitive tests after that */
    SC_TASK_COUNT = 9
};

/* Statistics of one query. SC_METHOD_AABB and _AABB_SCTT file their work under ..._ORIENTATION, and
   on a full model that on normal cones as the other methods do. Tests after failed contour tests
   are done together with others: they are counted each by itself, and the time of both is divided
   as these counts are. */
typedef struct sc_stats {
    uint32_t struct_size;
    uint32_t reserved;
    uint64_t total_nanoseconds;
    uint64_t nanoseconds[SC_TASK_COUNT];
    uint64_t counts[SC_TASK_COUNT];
    uint64_t nodes_visited;   /* nodes of the self-collision test tree that were reached */
    uint64_t nodes_oriented;  /* orientation tests passed */
    uint64_t nodes_culled;    /* contour tests passed */
    uint64_t leaf_pairs;      /* pairs of leaf clusters whose triangles were compared */
    uint64_t exact_fallbacks; /* orientation signs that floating point could not decide */
} sc_stats;

/* How much is known after a query. */
enum {
    SC_VERDICT_NONE = 0,      /* nothing: the query ended with an error */
    SC_VERDICT_CLEAN = 1,     /* there is no pair; with SC_CONTOUR_NONE: none was found */
    SC_VERDICT_FOUND = 2,     /* there is a pair, and all that was asked for is known */
    SC_VERDICT_INCOMPLETE = 3 /* stopped early: pairs that were found are pairs, others may be
                                 missing */
};

/*
 * The answer of a query. The caller sets struct_size and, for SC_OUTPUT_PAIRS, pairs and capacity,
 * and may set stats; the library sets the rest. pairs may be NULL when capacity is 0.
 */
typedef struct sc_result {
    uint32_t struct_size;
    uint32_t collides; /* out: 1 if there is a pair, else 0 */
    uint64_t count;    /* out: the number of pairs; 0 or 1 for SC_OUTPUT_ANY */
    uint64_t capacity; /* in: entries of pairs */
    sc_pair *pairs;    /* in: the caller's array. Each pair is written once, sorted by a, then b;
                          entries behind them may have been written to */
    sc_stats *stats;  /* in: where to put statistics (its struct_size set), or NULL. Clocks are read
                         only if it is not NULL */
    uint32_t verdict; /* out: SC_VERDICT_... */
    uint32_t reserved; /* out: 0 */
} sc_result;

/*
 * Finds the self-collisions of a model in a pose. options may be NULL: triangle pairs, touching,
 * the default method.
 *
 * Returns SC_OK, or SC_ERROR_SHORT_BUFFER when there are more pairs than fit: result->count is then
 * the number needed, and the array holds the first capacity pairs of the sorted list; or
 * SC_ERROR_INCOMPLETE, see below. On any other error count, collides and verdict are 0 and the
 * array is as it was.
 *
 * Stopping early. With options->cancel, any thread may end the query by storing a number other than
 * 0 there: an aligned store of 32 bits, in C11 and C++11 an atomic one, relaxed. With
 * options->budget it ends after so many units of work: the sum of sc_stats.counts but for
 * SC_TASK_UPDATE_BOXES and SC_TASK_UPDATE_NORMALS. Then it returns SC_ERROR_INCOMPLETE, the verdict
 * is SC_VERDICT_INCOMPLETE, and what was found so far is delivered as usual: count is the number of
 * pairs found so far, collides says whether there is one, and the array holds those, or the first
 * capacity of them, sorted. A query that a first pair ends, by SC_OUTPUT_ANY, is complete.
 *   A budget ends a query of the same model, pose and options after the same pairs each time, on
 * every machine; another version of the library may work in another order. It is overrun by one
 * contour test or five thousand units at most.
 *   The flag is looked at before each exact test and every few dozen boxes, most often within 20
 * microseconds, but not during the passes over the whole mesh with which a query begins (reading
 * positions, normals, boxes; about 1, 2 and 2 ns a triangle with AVX-512) and the sorting of pairs
 * found, with which it ends.
 *
 * A filter that cannot be read ends the query: SC_ERROR_STRUCT_SIZE, SC_ERROR_OPTION
 * (ignore_rings), SC_ERROR_NULL (ignore), or SC_ERROR_PAIRS where ignore is not sorted, names a
 * triangle or edge that does not exist, or has a >= b for triangles.
 *
 * Several threads. With options->tasks the passes over the pose, the walk through the tree and the
 * tests of triangles are done by all workers. The answer is the same. It pays from about 20,000
 * triangles. By the calling thread alone are done:
 *   - the first pass over the positions, about 0.2 ns a vertex where they are in the cache;
 *   - the sorting, about 4 ns a pair, unless there are more than about six pairs a triangle;
 *   - queries on models of fewer than 128 leaf clusters;
 *   - all but the passes with a budget, SC_CONTOUR_STAR or _NONE, and a filter's accept unless
 *     there is an array for the pairs, and where the library was compiled by other compilers than
 *     gcc or clang;
 *   - all but the passes once more, where the array turns out to be too short.
 * Counts in statistics do not depend on the number of workers if that is 2 or more, but for
 * SC_OUTPUT_ANY. Times of walk and tests are added up over the workers. Which pairs a query has
 * found when a flag ends it depends on the threads; where the array is too short it may be none.
 *
 * Pairs and their order depend on the mesh, the welding, the pose, the kind of pair asked for and
 * the filter, and on nothing else: not on partition, method, threads, compiler or machine.
 */
SC_API sc_status sc_query(const sc_model *model, sc_workspace *workspace, const sc_pose *pose,
                          const sc_query_options *options, sc_result *result);

/* ------------------------------------------------------------------------------------------------
 * Contacts
 */

/* What the two of a pair have in common. */
enum {
    SC_MEET_NONE = 0,    /* nothing */
    SC_MEET_POINT = 1,   /* a point */
    SC_MEET_SEGMENT = 2, /* a segment */
    SC_MEET_AREA = 3     /* two triangles of a plane: an area */
};

/*
 * Where the two of a pair meet: all that they have in common as closed sets, so with the vertex or
 * edge that two triangles share. points are the two ends of a segment; twice the same point; or of
 * an area two of its corners that are far apart. Each is given three times: by its coordinates, and
 * by weights of the vertices of a and of b (barycentric coordinates) in the order of the mesh's
 * triangle. For an edge the first two weights are those of its two ends, the third is 0.
 *
 * kind is exact. A weight is from 0 to 1 and off by at most 2^-49 times its value, however thin the
 * triangles and however small the angle; weights 0 are exactly so unless they are below 2^-1000. A
 * coordinate is off by at most 2^-49 times the largest absolute value of that coordinate among the
 * vertices of the pair, or by 2^-1070. Which end comes first means nothing, but is always the same.
 */
typedef struct sc_contact {
    uint32_t kind;     /* SC_MEET_... */
    uint32_t reserved; /* 0 */
    double points[2][3];
    double weights_a[2][3];
    double weights_b[2][3];
} sc_contact;

/*
 * Finds where pairs meet: contacts[i] is that of pairs[i]. kind is SC_PAIRS_..., pairs and contacts
 * have count entries. The pairs may be any of the model's triangles or edges, in any order, such as
 * those that sc_query found, in the numbers it reports:
 *
 *     sc_query(model, workspace, &pose, &options, &result);
 *     sc_contacts(model, &pose, options.pairs, result.pairs, result.count, contacts);
 *
 * What has nothing in common in this pose is SC_MEET_NONE, with zeros. No memory is taken and no
 * workspace, so threads may share a list of pairs. 1 to 3 us a pair; 100 us and more where
 * exponents differ widely.
 *
 * SC_ERROR_PAIRS: a pair names a triangle or edge that does not exist, or a triangle twice.
 * SC_ERROR_NOT_FINITE: a vertex of a pair is NaN or infinite. On these and other errors contacts
 * may have been written to in part.
 */
SC_API sc_status sc_contacts(const sc_model *model, const sc_pose *pose, uint32_t kind,
                             const sc_pair *pairs, uint64_t count, sc_contact *contacts);

/* ------------------------------------------------------------------------------------------------
 * Contours of intersections
 *
 * Where two sheets of a mesh intersect, they do so along a curve: its contour (Baraff, Witkin, Kass
 * 2003; Volino, Magnenat-Thalmann 2006). sc_trace puts the edges that meet triangles, as sc_query
 * finds them, into the order in which contours pass through them.
 *
 * Ties are decided as if each vertex had moved a little, by amounts too small to be written down
 * that depend on vertex numbers alone (after welding; Simulation of Simplicity, Edelsbrunner and
 * Muecke 1990). No four vertices are in a plane then. Two triangles without a common vertex have a
 * segment in common or nothing; two with one common vertex nothing else or a segment from there;
 * two with a common edge nothing else. So sheets that touch may have contours of their own, or
 * none, and which they have depends on the order of the vertices; but all contours fit together, on
 * coplanar and equal sheets, edges in edges and vertices on faces too. Where nothing is in a plane
 * with anything, the order of vertices means nothing.
 */

/* Where a contour begins and ends. */
enum {
    SC_TRACE_CLOSED = 0, /* nowhere: behind its last node comes its first */
    SC_TRACE_BORDER = 1, /* at an edge of one triangle */
    SC_TRACE_BRANCH = 2, /* at an edge of three or more triangles: of each of them a contour begins
                            or ends in a node with this edge and triangle */
    SC_TRACE_VERTEX = 3  /* at a vertex that the two triangles share */
};

/* Instead of an edge: the node is a vertex. */
#define SC_TRACE_NO_EDGE 0xffffffffu

/*
 * A node of a contour: where an edge of one sheet passes through a triangle of the other. From one
 * node to the next the contour is a straight segment that two triangles have in common, one of each
 * sheet.
 *
 * along and weights are as accurate as those of an sc_contact, and so is point. Where ties were
 * decided and edge and triangle have a segment in common they are those of its middle.
 */
typedef struct sc_trace_node {
    uint32_t edge;      /* as SC_PAIRS_EDGE names it, or SC_TRACE_NO_EDGE */
    uint32_t triangle;  /* that it passes through; where there is no edge, the vertex, which stands
                           for all that are welded to it */
    uint32_t sheet;     /* on which of the two sheets, 0 or 1, the edge is; the triangle is on the
                           other. 0 at a vertex, which is on both */
    uint32_t sheets[2]; /* the triangles in which the contour goes on to the next node, one of each
                           sheet; SC_TRACE_NO_EDGE at the end of one that is not closed */
    uint32_t reserved;  /* 0 */
    double along;       /* where on the edge: from 0 at its first vertex to 1 */
    double weights[3];  /* where in the triangle: weights of its corners in the order of the mesh; 0
                           at a vertex */
    double point[3];
} sc_trace_node;

/* The two sheets of a contour are one, and going round it once leads from one side to the other:
   sheets of its last node and of its first are exchanged. */
enum { SC_TRACE_ONE_SHEET = 1 };

/*
 * A contour: nodes first to first + count - 1. On the surface it is two curves that are each
 * other's partner: through the triangles sheets[0] of its nodes, and through sheets[1].
 */
typedef struct sc_trace_contour {
    uint64_t first, count;
    uint32_t begin, end; /* SC_TRACE_...; both are SC_TRACE_CLOSED or none is */
    uint32_t flags;      /* SC_TRACE_ONE_SHEET or 0 */
    uint32_t reserved;   /* 0 */
    double length;       /* the sum of that of its segments, in the order of nodes; infinite beyond
                            the range of doubles */
} sc_trace_contour;

/* Options; all may be zero. */
typedef struct sc_trace_options {
    uint32_t struct_size;
    uint32_t simd;                   /* SC_SIMD_... */
    const sc_allocator *allocator;   /* for memory until the call returns, or NULL: malloc */
    const sc_hooks *hooks;           /* for this call, or NULL */
    const sc_tasks *tasks;           /* the host's threads, or NULL */
    const volatile uint32_t *cancel; /* not 0: stop; or NULL */
} sc_trace_options;

/* Contours, and the caller's arrays for them. */
typedef struct sc_trace_result {
    uint32_t struct_size;
    uint32_t reserved;         /* out: 0 */
    uint64_t node_count;       /* out: nodes of all contours; one with a branch counts in each */
    uint64_t node_capacity;    /* in: entries of nodes */
    sc_trace_node *nodes;      /* in: the caller's array */
    uint64_t contour_count;    /* out */
    uint64_t contour_capacity; /* in: entries of contours */
    sc_trace_contour *contours; /* in: the caller's array */
} sc_trace_result;

/*
 * Traces the contours of a pose. pairs are its pairs of edges and triangles, all of them and
 * sorted, as sc_query finds them with SC_PAIRS_EDGE, SC_CONTACT_TOUCHING and no filter; others that
 * do not meet change nothing. options may be NULL.
 *
 * Contours that are not closed come first: from borders and branches on in the order of edges, then
 * triangles, and of a branch of the triangles that have the edge; then those from vertex to vertex;
 * then closed ones, from their lowest node on. So the answer depends on the mesh, the welding and
 * the pose alone.
 *
 * Triangles of which welding has made two corners one are no part of any sheet: pairs with them are
 * looked at for vertices that are not finite, and for nothing else.
 *
 * Returns SC_OK, or SC_ERROR_SHORT_BUFFER if an array is too short: counts are then what is needed,
 * and arrays may have been written to in part. SC_ERROR_PAIRS: pairs are not sorted, name what does
 * not exist, or some are missing, which is noticed where a contour does not go on. SC_ERROR_COUNT:
 * more than 2^30 pairs, or their edges have 2^31 triangles, counted for each pair.
 * SC_ERROR_NOT_FINITE: a vertex of a pair is NaN or infinite. SC_ERROR_MEMORY.
 * SC_ERROR_INCOMPLETE: cancelled. On these and other errors counts are 0.
 *
 * Cost (Zen 4, AVX-512): 0.2 to 0.3 us a pair on generic meshes; pairs with four points in a
 * plane take longer, as in sc_contacts. Memory: about 125 bytes a pair and 13 a vertex, given back
 * before it returns. With options->tasks pairs and triangles are shared out; the answer is the
 * same.
 */
SC_API sc_status sc_trace(const sc_model *model, const sc_pose *pose, const sc_pair *pairs,
                          uint64_t count, const sc_trace_options *options, sc_trace_result *result);

/* A point that three triangles have in common: where three sheets meet, and the three contours of
   each two of them cross. */
typedef struct sc_trace_triple {
    uint32_t triangles[3]; /* ascending */
    uint32_t reserved;     /* 0 */
    uint64_t nodes[3];     /* of the trace: what is between nodes[i] and the next of its contour is
                              what the two triangles other than triangles[i] have in common, */
    double along[3];       /* and so far on it, from 0 to 1, triangles[i] passes through it */
    double point[3];
} sc_trace_triple;

/* Points where three sheets meet, and the caller's array for them. */
typedef struct sc_triples_result {
    uint32_t struct_size;
    uint32_t reserved;        /* out: 0 */
    uint64_t count;           /* out */
    uint64_t capacity;        /* in: entries of triples */
    sc_trace_triple *triples; /* in: the caller's array, or NULL if the capacity is 0 */
} sc_triples_result;

/*
 * Finds the points in which three sheets meet, in the order of their triangles. trace is what
 * sc_trace filled for this model and pose with SC_OK; options as there, may be NULL. Four sheets
 * through one point are four such points, of each three.
 *
 * Ties are decided as those of contours are, and what is found fits these: a closed contour passes
 * an even number of times through a closed component that it is not on. Equal or coplanar sheets
 * may have such points or none. Three triangles that share a vertex have none there.
 *
 * along is off by at most 2^-38, but where ties were decided it is somewhere on the segment: in its
 * middle if all of it is in the third triangle's plane. point is the mean of the ends of the
 * segment of the first two triangles, as accurate as these are.
 *
 * Returns SC_OK, or SC_ERROR_SHORT_BUFFER if there are more than fit: count is then what is needed,
 * and nothing was written to triples. The same error, and a count of 0, if trace itself was short.
 * SC_ERROR_PAIRS: trace names what does not exist, or contours are such as no mesh has.
 * SC_ERROR_COUNT: more than 2^30 nodes or contours. SC_ERROR_NOT_FINITE: a node, or a corner of a
 * triangle that has one, is NaN or infinite. SC_ERROR_MEMORY, SC_ERROR_INCOMPLETE.
 *
 * Cost (Intel Xeon): up to 1.5 us a node, of a cloth crumpled into itself, and as much a point, by
 * the calling thread; more where points are in planes. Memory: 24 bytes a node, 8 a triangle and 32
 * to 56 a point, given back before it returns.
 */
SC_API sc_status sc_trace_triples(const sc_model *model, const sc_pose *pose,
                                  const sc_trace_result *trace, const sc_trace_options *options,
                                  sc_triples_result *result);

/* A part of the surface that no contour divides. */
typedef struct sc_region {
    uint32_t component;    /* the lowest vertex of the connected part of the mesh that it is in */
    uint32_t vertex_count; /* vertices in it; 0 for a strip or a disc between vertices */
    double area;           /* of all that is in it. A triangle whose own area is beyond the range of
                              doubles counts as DBL_MAX; a sum beyond that range is infinite */
    int32_t inside;        /* on request: how often closed components go round it, on the side to
                              which its normals point: 0 outside of all. SC_REGION_UNKNOWN if that
                              was not asked for, or contours pass through all of its triangles */
    uint32_t reserved;     /* 0 */
} sc_region;

#define SC_REGION_UNKNOWN (-0x7fffffff - 1)

/* What is asked of regions; a sum. */
enum {
    SC_REGIONS_INSIDE = 1 /* fill sc_region.inside: 20 to 30 ns a triangle of the mesh for each
                             region */
};

/* What is on both sides of a contour, on each of its sheets: regions. Equal ones: the contour does
   not divide the sheet. */
typedef struct sc_contour_sides {
    uint32_t sides[2][2]; /* sides[s][0]: on sheet s, at the first node whose edge is on it, where
                             the edge begins (along 0); sides[s][1]: where it goes on. Of a contour
                             without such a node, which is within one triangle: within the contour,
                             and round it; if it is not closed, the region it is in, twice */
} sc_contour_sides;

/* Regions, and the caller's arrays for them. */
typedef struct sc_regions_result {
    uint32_t struct_size;
    uint32_t flags;            /* in: SC_REGIONS_... */
    uint64_t region_count;     /* out */
    uint64_t region_capacity;  /* in: entries of regions */
    sc_region *regions;        /* in: the caller's array, or NULL if the capacity is 0 */
    uint32_t *vertex_regions;  /* in: vertex_count entries, or NULL: the region of each vertex.
                                  SC_TRACE_NO_EDGE for those of no triangle, or of none but such as
                                  welding has collapsed, and for those that are welded to
                                  another one, which has their region */
    sc_contour_sides *sides;   /* in: trace->contour_count entries, or NULL */
} sc_regions_result;

/*
 * Finds the regions into which the contours of a pose divide the surface: what can be reached from
 * each other without crossing a contour (global intersection analysis: Baraff, Witkin, Kass 2003,
 * section 4). All contours count, closed or not; those that end inside a sheet divide nothing there
 * by themselves. trace is what sc_trace filled for this model and pose; options as there, may be
 * NULL.
 *
 * Regions are in the order of their lowest vertices; those without a vertex come last. Together
 * they have the area of the mesh (but for triangles that welding has collapsed). Nothing is chosen:
 * which side of a contour is the wrong one the library cannot know. sc_region_hint names the
 * smaller. A component is closed if each of its edges is passed as often one way as the other.
 * Where all of a mesh is closed and is to be intersection-free, what has inside above 0 is in it.
 *
 * Limits. Along an edge crossings are ordered by sc_trace_node.along: two that are the same in
 * double precision may be exchanged, which leaves a region of next to no area, or joins two that
 * have one between them. Regions that touch in nothing but a vertex at which contours end are one.
 * Where contours cross in a triangle, as three sheets meet, its area is shared out by the length of
 * its sides in each region, and what touches no side is not counted. Where ties were decided, nodes
 * are not where those of the moved vertices are: areas may be off there, even below 0.
 *
 * Returns SC_OK, or SC_ERROR_SHORT_BUFFER if there are more regions than fit, whose number is then
 * told; vertex_regions and sides are written all the same. The same error, and no regions, if trace
 * itself was short. SC_ERROR_PAIRS: trace names what does not exist, or contours are such as no
 * mesh has. SC_ERROR_COUNT: more than 2^30 nodes or contours. SC_ERROR_NOT_FINITE: a vertex of a
 * triangle, after welding, is NaN or infinite. SC_ERROR_MEMORY, SC_ERROR_INCOMPLETE.
 *
 * Cost (Zen 4): 30 ns a triangle and 0.5 us a node, by the calling thread. Memory: about 34 bytes a
 * vertex and 100 a node, given back before it returns.
 */
SC_API sc_status sc_trace_regions(const sc_model *model, const sc_pose *pose,
                                  const sc_trace_result *trace, const sc_trace_options *options,
                                  sc_regions_result *result);

/* Which side of a contour on sheet 0 or 1 has the smaller area: 0 or 1; SC_TRACE_NO_EDGE if both
   are one region, or as large, or there is no such sheet. */
SC_API uint32_t sc_region_hint(const sc_region *regions, const sc_contour_sides *contour,
                               uint32_t sheet);
/* A sum. */
enum {
    SC_GRADIENT_FLAT = 1, /* the edge is parallel to the triangle or nearly so, or the triangle is
                             nearly a line (a b < 2^-39, see below), or the edge or a side of the
                             triangle has a length that is no double. Vectors are 0 */
    SC_GRADIENT_SHORT = 2 /* a segment at the node has no length, or one that is no double. It is as
                             if it were not there */
};

/*
 * How the length of a contour changes as the vertices of a node move: its derivative by the
 * position of vertices[i] is weights[i] times vectors[0] for the ends of the edge, i = 0 and 1, and
 * weights[i] times vectors[1] for the corners of the triangle, i = 2, 3 and 4. The sums over all
 * nodes of a contour are the gradient of its length, a vector for each vertex:
 *
 *     for (i = 0; i < 5; i++)
 *         for (k = 0; k < 3; k++)
 *             gradient[g->vertices[i]][k] += g->weights[i] * g->vectors[i >= 2][k];
 *
 * A node at a shared vertex has that five times in vertices, with the weights 1, 0, 0, 0 and 0.
 */
typedef struct sc_trace_gradient {
    uint32_t vertices[5]; /* the ends of the edge and the corners of the triangle, in the order of
                             the mesh. Of welded vertices, those that represent the others */
    uint32_t flags;       /* SC_GRADIENT_... */
    double weights[5];    /* where the node is on the edge, and in the triangle: 1 for each */
    double vectors[2][3]; /* the derivative as edge and as triangle move as a whole; no units */
} sc_trace_gradient;

/*
 * Finds the gradients of the lengths of contours: gradients[i] is the stencil of traced->nodes[i],
 * an array of traced->node_count entries. traced is what sc_trace answered for this pose with
 * SC_OK. Steps against the gradients shorten contours until they vanish, which takes sheets out of
 * each other without a word of which side is the right one; that does not do where a contour can be
 * short and the intersection deep, such as a thin limb's that goes straight through a sheet. The
 * gradient of each contour is that of its own nodes, so contours can have weights of their own.
 *
 * This is the scheme of Volino and Magnenat-Thalmann ("Resolving surface collisions through
 * intersection contour minimization", 2006). They move an edge as a whole against a triangle, and
 * ask how the contour's two segments at their crossing change: vectors[0]. Here it is divided among
 * the five vertices such that the sums are the derivative of the polyline's length, exactly. A
 * contour whose nodes are not SC_GRADIENT_FLAT has no force and no torque on the mesh as a whole.
 *
 * vectors become large where edges are nearly parallel to triangles, by 1 / a for an angle with the
 * sine a: limit steps. Length has no derivative where a contour branches, appears, or goes through
 * a vertex or an edge of both sheets; what is found there is that of the contours as they were
 * traced.
 *
 * Each component of vectors is off by at most 2^-45 (C / l + 1 / (a b)) / a, with C the largest
 * coordinate of the node's vertices and its neighbours', l the length of the shorter segment at the
 * node, and b the sine of the angle at the triangle's first corner. All numbers are finite. No
 * memory is taken, and any number of threads may ask about one model. 0.2 us a node (Zen 4).
 *
 * SC_ERROR_NULL; SC_ERROR_STRUCT_SIZE; SC_ERROR_VERTEX_COUNT and what else a pose may lack.
 * SC_ERROR_SHORT_BUFFER: traced has less room than there are nodes or contours. SC_ERROR_PAIRS: a
 * contour has nodes that there are not, or a node names what does not exist. SC_ERROR_NOT_FINITE: a
 * vertex of a node, or a number of it, is NaN or infinite. On errors gradients may have been
 * written to in part.
 */
SC_API sc_status sc_trace_gradients(const sc_model *model, const sc_pose *pose,
                                    const sc_trace_result *traced, sc_trace_gradient *gradients);

/* ------------------------------------------------------------------------------------------------
 * Steps
 *
 * Continuous collision: what happens while the mesh moves from one pose to another, as solvers for
 * cloth and soft bodies need it. Each vertex moves on a straight line at constant speed: at time t,
 * from 0 to 1, its coordinates are the real numbers (1 - t) start + t end.
 *
 *     a step workspace: sc_workspace_create_for with SC_WORKSPACE_STEP
 *     sc_query_step(model, workspace, &start, &end, &options, &result)
 */

/* Which way the pairs of a step are sought. The collisions are the same for all, bit for bit. The
   default is SC_STEP_METHOD_SCTT, on a model with SC_MODEL_BOXES SC_STEP_METHOD_TWO_BOXES. */
enum {
    SC_STEP_METHOD_DEFAULT = 0,
    SC_STEP_METHOD_SCTT = 1,      /* self-collision test tree, with normal cones and contours that
                                     move; with a large separation the plain tree, as
                                     SC_NEAR_METHOD_SCTT says */
    SC_STEP_METHOD_TWO_BOXES = 2, /* the plain tree, with a box at the start and one at the end:
                                     a pair whose boxes are apart on the same side at both times
                                     is so at all times; likewise slabs of triangles */
    SC_STEP_METHOD_SWEPT = 3      /* the plain tree, with one box round the whole motion, and no
                                     slabs; for comparison */
};

/* What is reported. */
enum {
    SC_STEP_COLLISIONS = 0, /* the pairs that collide */
    SC_STEP_CANDIDATES = 1  /* the pairs that boxes, slabs and culling leave, for a narrow phase of
                               the caller's: every collision and others. They depend on the
                               method, not on the machine */
};

/* Which times of impact are wanted. */
enum {
    SC_STEP_TIMES_NONE = 0,
    SC_STEP_TIMES_EARLIEST = 1, /* result->earliest */
    SC_STEP_TIMES_EACH = 2      /* and that of each pair reported */
};

/*
 * Of pairs that begin within the separation, or nearly: are those reported that come no nearer?
 *
 * With SC_STEP_BEGUN_NEARER each pair collides at a separation of its own: its distance at the
 * start less twice its tolerance, but at least 0, and at most options->separation. The distance at
 * the start enters with an error of at most 9/16 of the tolerance, the same on all machines. So
 *   - a pair that comes nearer than it began by 2 1/16 tolerances or more, and to separation or
 *     less, is reported, and so is each that comes to touch or touches at the start;
 *   - one that begins more than 2 1/16 tolerances apart is not reported if it only moves apart,
 *     stays as it is, or comes nearer by less than a quarter of its tolerance;
 *   - a pair's time is not after the first at which it comes within its own separation, and
 *     earliest is the least of the times of what is reported.
 * What comes nearer by less than that in each of many steps is never reported until it is within
 * the tolerance: so choose one that is small beside the separation. Pairs smaller than 2^-900 are
 * reported only if they come within their tolerance. Candidates are the same as without. Cost:
 * about one more narrow phase for each pair that collides at options->separation.
 */
enum {
    SC_STEP_BEGUN_ALL = 0,   /* yes */
    SC_STEP_BEGUN_NEARER = 1 /* no */
};

typedef struct sc_step_options {
    uint32_t struct_size;
    uint32_t output;   /* SC_OUTPUT_PAIRS, _COUNT or _ANY; see there */
    uint32_t pairs;    /* SC_STEP_COLLISIONS or _CANDIDATES */
    uint32_t times;    /* SC_STEP_TIMES_... */
    uint32_t method;   /* SC_STEP_METHOD_... */
    uint32_t contour;  /* SC_CONTOUR_DEFAULT, _EXACT: is the moving contour simple throughout?
                          _STAR: does a point see it throughout (the paper's test, extended to
                          motion)? _NONE: MISSES PAIRS, to measure against. For
                          SC_STEP_METHOD_SCTT */
    uint32_t simd;     /* SC_SIMD_... */
    uint32_t reserved; /* 0 */
    double separation; /* distance at which pairs collide, in units of the coordinates: 0 or more */
    double tolerance;  /* how exactly distances are told, the same units: positive, or 0 for a
                          millionth of the longest side of the box that holds the mesh in both
                          poses */
    const sc_tasks *tasks;               /* the host's threads, or NULL. See "Several threads" at
                                        sc_query_step */
    const volatile uint32_t *cancel;     /* as in sc_query_options */
    uint64_t budget;                     /* as in sc_query_options */
    const sc_filter *vertex_face_filter; /* which pairs of a kind are not wanted, or NULL; see
                                            "Filters of pairs of features" at sc_query_step */
    const sc_filter *edge_edge_filter;
    const sc_pose *rest;  /* a pose, or NULL: pairs that are within rest_distance of each other in
                             it are left out */
    double rest_distance; /* 0 or more, finite, the same units; 0: those that touch in it. 0 where
                             there is no such pose */
    uint32_t begun;       /* SC_STEP_BEGUN_... */
    uint32_t reserved2;   /* 0 */
} sc_step_options;

/*
 * The answer of a step. The caller sets struct_size and, for SC_OUTPUT_PAIRS, the arrays and
 * capacities, and may set stats; the library sets the rest. An array may be NULL when its capacity
 * is 0, an array of times always.
 *
 *   vertex_faces   a vertex a and a triangle b of which it is no corner. Of welded vertices, a is
 *                  the one that represents the others; a vertex of no triangle takes no part
 *   edge_edges     two edges without a common vertex, a < b, named as SC_PAIRS_EDGE names them
 *
 * "Corner" and "common" are said of vertices after welding. Each pair comes once, sorted by a, then
 * b.
 */
typedef struct sc_step_result {
    uint32_t struct_size;
    uint32_t collides; /* out: 1 if there is a pair (a candidate, if these were asked for) */
    uint32_t verdict;  /* out: SC_VERDICT_... */
    uint32_t reserved; /* out: 0 */
    uint64_t vertex_face_count; /* out: the number of such pairs; of both kinds together 0 or 1 for
                                   SC_OUTPUT_ANY */
    uint64_t vertex_face_capacity; /* in: entries of vertex_faces */
    sc_pair *vertex_faces;         /* in: the caller's array */
    double *vertex_face_times;     /* in: NULL, or for SC_STEP_TIMES_EACH as many entries */
    uint64_t edge_edge_count;      /* the same for pairs of edges */
    uint64_t edge_edge_capacity;
    sc_pair *edge_edges;
    double *edge_edge_times;
    double earliest; /* out, with SC_STEP_TIMES_...: nothing collides before this time; from 0
                        to 1, and 1 as well if nothing collides at all. So (1 - t) start + t end
                        with this t is the largest step that is known to be free */
    sc_stats *stats; /* in: where to put statistics, or NULL; see sc_stats */
} sc_step_result;

/*
 * Finds what collides while a model moves from one pose to another. options may be NULL. The
 * workspace was made with SC_WORKSPACE_STEP; SC_ERROR_WORKSPACE if not. The poses may differ in
 * type and stride.
 *
 * A pair collides if at some time in [0, 1] the distance of its two closed sets is separation or
 * less. Every pair that does so is reported. What is reported beyond these came within separation +
 * tolerance at some time; a smaller tolerance costs time where much is that near. Rounding sets a
 * limit to it: the tolerance of a pair is at least 2^-32 times the largest difference of a
 * coordinate in it. The list depends on mesh, welding, poses, separation, tolerance, filters and
 * rest pose and on nothing else: not on method, partition, number of threads, compiler or machine,
 * for what is near the limit is decided pair by pair and culling keeps clear of it. An edge that is
 * through the inside of a triangle from start to end collides with nothing by that: sc_query tells
 * whether the start is free.
 *
 * A pair's time is not after the first time at which it comes within separation, and at the time
 * itself it is within separation + tolerance. earliest is the least of all times. Candidates have
 * no times: earliest is 0 if there is one, and times of pairs are 0.
 *
 * With SC_OUTPUT_ANY the query ends at the first pair found, whose time says nothing of others:
 * earliest is then 0, and with SC_STEP_TIMES_EARLIEST the query goes on until it is known.
 *
 * Returns SC_OK; SC_ERROR_SHORT_BUFFER if one of the arrays is too short: both counts are then what
 * is needed, and each array holds the first capacity pairs of its sorted list; or
 * SC_ERROR_INCOMPLETE, if it was cancelled or ran out of budget, see sc_query: earliest is 0 then.
 * On any other error counts, collides and verdict are 0, and the arrays as they were: those of
 * sc_query, SC_ERROR_OPTION also for a separation, tolerance or rest_distance that is negative or
 * not finite, and SC_ERROR_NULL for a capacity without its array or a rest_distance above 0 without
 * a rest pose. Of filters and of the rest pose the errors are those of a query's filter and pose.
 *
 * Filters of pairs of features. A thickness above the size of a cell brings each feature together
 * with its own neighbourhood. vertex_face_filter, edge_edge_filter and rest say which pairs are not
 * wanted: these are not reported, neither as collisions nor as candidates, not counted, end no
 * query, and earliest does not see them. Culling is as without, and so no wanted pair is missed. A
 * filter is an sc_filter, one for each kind, and its members mean, in the order in which pairs are
 * asked about them:
 *
 *   triangle_groups  a triangle has its group. An edge has that of the triangle that names it, e /
 *                    3. A vertex is in all categories of the triangles that have it as a corner,
 *                    and its mask is the union of theirs: at a border between groups it belongs to
 *                    all of them
 *   vertex_groups    a vertex has its group; an edge or triangle is in all categories of its
 *                    vertices, and its mask is the union of theirs. For vertices welded together,
 *                    the group of the one that represents them is read. Where there are groups of
 *                    both kinds, both must collide
 *   ignore           pairs as this kind of list has them, sorted likewise: of vertex_faces a vertex
 *                    a and a triangle b, of edge_edges two edges a < b. What is no pair, such as a
 *                    vertex that another one represents, or a corner that names no edge, does no
 *                    harm; a number that is too large is SC_ERROR_PAIRS
 *   ignore_rings     n: leaves out a vertex and a face from one of whose corners fewer than n edges
 *                    of the mesh lead to the vertex; and two edges from an end of one of which
 *                    fewer than n lead to an end of the other, after welding. As the two share no
 *                    vertex, 1 is without effect; 2 leaves out those that one edge joins
 *   rest             not a member of a filter but an option for both kinds: leaves out pairs whose
 *                    Euclidean distance in that pose is rest_distance or less, compared exactly. It
 *                    is a pose as start and end are, of any type and stride. With the rest shape
 *                    of a cloth and its thickness there, what is as near as that by the shape of
 *                    the mesh is let go, and all else is kept
 *   accept           called last, once for each pair that nothing else leaves out, with a and b as
 *                    reported, in any order, in the thread that called sc_query_step; 0 leaves it
 *                    out. It must not use the workspace. After SC_OUTPUT_ANY found a pair it is
 *                    called no more, unless the earliest time is sought
 *
 * All but accept is asked before a step decides a pair; sc_query_near asks only of pairs that are
 * near. ignore_rings of both filters helps, besides, to cull what is smooth, with distances above
 * the size of triangles, too; nothing else here does. Cost: with a rest pose a pass over its
 * vertices, and about 0.1 microseconds for each pair that is asked about; with triangle_groups for
 * vertices a pass over the triangles; rings walk the mesh round each feature until they reach the
 * other, or as far as they go; a list is read once, and looked up for each of these pairs.
 *
 * Several threads. With options->tasks the passes over both poses, the walk through the tree,
 * boxes, the narrow phase and the sorting are done by all workers. Answer and counts in statistics
 * are the same as of one thread, but for SC_OUTPUT_ANY: which pair is found first, and so which of
 * the two counts is 1, depends on the threads, as does what a step has found when a flag ends it.
 * By the calling thread alone are done:
 *   - steps of models of fewer than 128 leaf clusters;
 *   - all but the passes with a budget, and where the library was compiled by other compilers than
 *     gcc or clang;
 *   - all but the passes with accept in a filter, unless both arrays have room and, where times
 *     are wanted, there are arrays for those of both; then it is called at the end, in the order of
 *     the lists;
 *   - all but the passes once more, where one of the arrays turns out to be too short.
 *
 * No memory is allocated. Cost, on one thread: reading the poses, 10 ns a triangle for normal
 * cones, then what they do not clear.
 */
SC_API sc_status sc_query_step(const sc_model *model, sc_workspace *workspace, const sc_pose *start,
                               const sc_pose *end, const sc_step_options *options,
                               sc_step_result *result);

/* ------------------------------------------------------------------------------------------------
 * Proximity
 *
 * What comes within a distance in one pose, as contact solvers need it, and as checks of wall
 * thickness and gaps do.
 *
 *     a workspace for it: sc_workspace_create_for with SC_WORKSPACE_NEAR
 *     sc_query_near(model, workspace, &pose, &options, &result)
 *     sc_near_stencils   closest points of the pairs that were found, if wanted
 */

/* Which kinds of pairs are sought. */
enum { SC_NEAR_BOTH = 0, SC_NEAR_VERTEX_FACE = 1, SC_NEAR_EDGE_EDGE = 2 };

/* Which way pairs are sought. The answer is the same. The default is SC_NEAR_METHOD_SCTT, on a
   model with SC_MODEL_BOXES SC_NEAR_METHOD_BOXES. */
enum {
    SC_NEAR_METHOD_DEFAULT = 0,
    SC_NEAR_METHOD_SCTT = 1, /* self-collision test tree: contours that are simple with a clearance
                                of the distance cull what is smooth, where the distance is below the
                                altitudes of triangles, or below n - 1 of them (7 at most), where
                                masks or filters leave out n rings of all kinds that are asked for.
                                If it is so in less than about a quarter of the mesh, as a sample
                                tells, the plain tree is taken */
    SC_NEAR_METHOD_BOXES = 2 /* the plain tree of boxes */
};

/*
 * What is near on the mesh, whatever the pose, for searches with a distance as large as triangles
 * or larger: there, most of what is near is the neighborhood of each feature, and a filter's
 * ignore_rings is asked about each pair. Masks leave the same pairs out, but before distances are
 * computed.
 *
 * sc_near_masks_create makes them for a model and a number of rings, 1 to SC_RINGS_MAX, as
 * sc_filter.ignore_rings has them (see "Filters of pairs of features"); SC_ERROR_OPTION for others.
 * They refer to the model, which must live as long, and never change: any number of threads and
 * workspaces may use them at once. sc_near_masks_free frees them, with the allocator, which may be
 * NULL for malloc; NULL is allowed. SC_ERROR_MEMORY: an allocation failed, and nothing is left.
 *
 * Cost: a walk of the mesh round each vertex, 0.1 seconds and 4 megabytes for 65,000 triangles and
 * four rings; memory grows with the square of rings. To count what is within an edge of a cloth of
 * 65,000 triangles takes 7 milliseconds with them, 26 where nothing is left out, and 36 with
 * ignore_rings (one thread, AVX-512; the mean over an animation; at rest, 0.5, 38 and 0.5).
 */
typedef struct sc_near_masks sc_near_masks;

SC_API sc_status sc_near_masks_create(const sc_model *model, uint32_t rings,
                                      const sc_allocator *allocator, sc_near_masks **masks);
SC_API void sc_near_masks_free(sc_near_masks *masks);

typedef struct sc_near_options {
    uint32_t struct_size;
    uint32_t output;   /* SC_OUTPUT_PAIRS, _COUNT or _ANY; see there */
    uint32_t kinds;    /* SC_NEAR_BOTH, _VERTEX_FACE or _EDGE_EDGE */
    uint32_t method;   /* SC_NEAR_METHOD_... */
    uint32_t simd;     /* SC_SIMD_... */
    uint32_t reserved; /* 0 */
    double distance; /* pairs that are this near or nearer are reported; 0 or more, finite, in units
                          of the coordinates. 0: those that touch */
    const sc_filter
        *vertex_face_filter; /* which pairs of a kind are not wanted, or NULL; see "Filters
                                            of pairs of features" at sc_query_step */
    const sc_filter *edge_edge_filter;
    const sc_pose *rest; /* a pose, or NULL; pairs that are within rest_distance of each other in it
                            are left out */
    double rest_distance;            /* 0 or more, finite; 0: those that touch in it */
    const sc_tasks *tasks;           /* the host's threads, or NULL */
    const volatile uint32_t *cancel; /* as in sc_query_options */
    uint64_t budget;                 /* as in sc_query_options */
    const sc_near_masks *masks; /* what is left out besides, or NULL: as by ignore_rings of both
                                   filters. SC_ERROR_OPTION: of another model */
} sc_near_options;

/*
 * The answer of a query. The caller sets struct_size and, for SC_OUTPUT_PAIRS, the arrays and
 * capacities, and may set stats; the library sets the rest. An array may be NULL when its capacity
 * is 0. Pairs are those of sc_step_result: a vertex and a triangle of which it is no corner; two
 * edges without a common vertex, a < b. Each comes once, sorted by a, then b.
 */
typedef struct sc_near_result {
    uint32_t struct_size;
    uint32_t found;             /* out: 1 if there is a pair, else 0 */
    uint32_t verdict;           /* out: SC_VERDICT_... */
    uint32_t reserved;          /* out: 0 */
    uint64_t vertex_face_count; /* out: the number of such pairs; of both kinds together 0 or 1 for
                                      SC_OUTPUT_ANY */
    uint64_t vertex_face_capacity; /* in: entries of vertex_faces */
    sc_pair *vertex_faces;         /* in: the caller's array */
    uint64_t edge_edge_count;      /* the same for pairs of edges */
    uint64_t edge_edge_capacity;
    sc_pair *edge_edges;
    sc_stats *stats; /* in: where to put statistics, or NULL; see sc_stats */
    double *vertex_bounds; /* in: NULL, or the caller's array, an entry for each vertex of the mesh:
                              see "Bounds of vertices" at sc_query_near */
} sc_near_result;

/*
 * Finds what is within a distance in a pose: of each pair the Euclidean distance of the two closed
 * sets, of a point from a triangle or of two segments, compared exactly with options->distance.
 * There is no tolerance: a pair is reported if and only if its distance is that or less. So the
 * list grows with the distance, and depends on mesh, welding, pose, distance, filters and rest pose
 * alone: not on method, partition, number of threads, compiler or machine. options may be NULL:
 * pairs of both kinds that touch. The workspace was made with SC_WORKSPACE_NEAR; SC_ERROR_WORKSPACE
 * if not.
 *
 * Returns SC_OK; SC_ERROR_SHORT_BUFFER if one of the arrays is too short: both counts are then what
 * is needed, and each array holds the first capacity pairs of its sorted list; or
 * SC_ERROR_INCOMPLETE, if it was cancelled or ran out of budget, see sc_query. On any other error
 * counts, found and verdict are 0, and the arrays as they were: those of sc_query_step,
 * SC_ERROR_OPTION for a distance or rest_distance that is negative or not finite.
 *
 * Bounds of vertices. vertex_bounds[v] becomes a number that is at most the distance of everything
 * at v, itself, its edges and its faces, from everything that this shares no vertex with and that
 * is not left out, and at most options->distance: the least of that and of the distances of all
 * reported pairs of which v is the vertex, a corner of the face or an end of an edge, rounded down.
 * So if a pose has no intersections, nothing is left out and every vertex moves by less than half
 * its bound, wherever it goes, there are none after: step sizes for solvers without a continuous
 * test (Offset Geometric Contact: Chen et al. 2025). Bounds are below these distances by at most
 * 5e-7 times the longest side of the box of the mesh, plus 3e-5 times the distance and the longest
 * extent of an edge, plus 2^-1020; never above; and the same for every method, number of threads
 * and machine. kinds other than both know less. A vertex that another one represents, and one of no
 * triangle, has options->distance: let the former move as the one that represents it, or the seam
 * opens. With SC_OUTPUT_ANY they are refused (SC_ERROR_OPTION); after SC_ERROR_INCOMPLETE they are
 * 0; after SC_ERROR_SHORT_BUFFER complete. 30 ns a pair more.
 *
 * Several threads: as for sc_query_step. No memory is allocated.
 */
SC_API sc_status sc_query_near(const sc_model *model, sc_workspace *workspace, const sc_pose *pose,
                               const sc_near_options *options, sc_near_result *result);

/* Where the closest points of a pair are: those of a vertex, or inside an edge or a face. */
enum {
    SC_FEATURE_VERTEX_VERTEX = 1,
    SC_FEATURE_VERTEX_EDGE = 2,
    SC_FEATURE_EDGE_EDGE = 3,
    SC_FEATURE_VERTEX_FACE = 4
};

/* A sum. */
enum {
    SC_STENCIL_PARALLEL = 1 /* the two edges are exactly parallel, an edge without length being so
                               with any other; or the face has no area. Set whatever the feature
                               is. Of parallel edges there may be other points as close */
};

/*
 * The closest points of a pair, as weights of its vertices: the vector from the point of a to that
 * of b is the sum of weights[i] times the position of vertices[i].
 *
 * Which feature is exact. If several hold closest points, it is one with the fewest vertices: so it
 * does not depend on rounding, and a vertex that is right above an edge is a vertex and an edge.
 * The weights of the feature's vertices are not 0, all others are. Among several features of as few
 * vertices it is
 *   - of parallel edges that lie side by side for a part: an end of this part; the one where two
 *     vertices face each other, if only one is so, else the lower one, that is where x is less
 *     along the edges, or y if x is constant, or z;
 *   - of a face without area: the edge from its lowest to its highest corner, in the same order;
 *   - of vertices at one place, the one that stands first in vertices.
 * So it does not depend on the order of edges, ends and corners, but for vertices at one place.
 *
 * With u = 2^-53, however thin the triangles and however small the angle: a weight is off by at
 * most 8 u = 2^-50 times its value, or by 2^-1022; likewise each coordinate of vector, and
 * distance. 0 is exact. Where differences are too large for a double they are infinite. The sum of
 * rounded weights times positions has a larger error than vector.
 */
typedef struct sc_near_stencil {
    uint32_t feature;     /* SC_FEATURE_... */
    uint32_t flags;       /* SC_STENCIL_... */
    uint32_t vertices[4]; /* the vertex, then the corners of the face in the order of the mesh; or
                             the ends of a, then those of b, as the triangles that name them have
                             them. Of welded vertices, those that represent the others */
    double weights[4];    /* of a: negative, and -1 together; of b: positive, and 1 together */
    double vector[3];     /* from the closest point of a to that of b */
    double distance;      /* its length */
} sc_near_stencil;

/*
 * Finds the closest points of pairs: stencils[i] is that of pairs[i]. kind is SC_NEAR_VERTEX_FACE
 * or SC_NEAR_EDGE_EDGE, pairs and stencils have count entries. The pairs may be any of the model's,
 * in any order, near or not, such as those that sc_query_near or sc_query_step found:
 *
 *     sc_near_stencils(model, &pose, SC_NEAR_EDGE_EDGE, result.edge_edges, result.edge_edge_count,
 *                      stencils);
 *
 * No memory is taken and no workspace, so threads may share a list of pairs. 0.3 us a pair (Zen 4:
 * 0.1 us of two vertices, 0.4 us of two edges); 3 us where coordinates of many bits make ties; up
 * to 1.5 ms where exponents are spread over the whole range of doubles.
 *
 * SC_ERROR_OPTION: kind is another. SC_ERROR_PAIRS: a pair names a vertex, triangle or edge that
 * does not exist; a vertex that no triangle uses, that another one represents, or that is a corner
 * of the face; or two edges with a common vertex. An edge may be named by any of its triangles; it
 * is then as that has it. A side from a vertex to itself is an edge without length here.
 * SC_ERROR_NOT_FINITE: a vertex of a pair is NaN or infinite. On these and other errors stencils
 * may have been written to in part.
 */
SC_API sc_status sc_near_stencils(const sc_model *model, const sc_pose *pose, uint32_t kind,
                                  const sc_pair *pairs, uint64_t count, sc_near_stencil *stencils);

/*
 * Makes one of all stencils of the same two vertices, whichever is of a, and of all of the same
 * vertex and edge, as barrier methods (incremental potential contact, IPC) want them. The
 * stencils may be those of both kinds of pairs, one list behind the other. Of each group the first
 * stencil stays, as it is; what stays keeps its order, and edge-edge and vertex-face stencils all
 * stay. *merged_count becomes the number of stencils that are left, at the beginning of the array;
 * multiplicities, which has count entries, gets for each of them how many it stands for. What is
 * behind them in both arrays means nothing.
 *
 * No memory is taken. By hashing: 0.04 us a stencil of 25,000, 0.3 us of a million; vertex numbers
 * that somebody chose for it can make the time grow with the square of count. SC_ERROR_COUNT: count
 * is 2^32 or more; *merged_count is 0 on errors.
 */
SC_API sc_status sc_near_merge(sc_near_stencil *stencils, uint64_t count, uint64_t *merged_count,
                               uint32_t *multiplicities);

/*
 * Asks the same of many poses of one model, several at a time: for datasets, and for a thousand
 * characters. results[i] is what sc_query says of poses[i] with these options, whatever is wrong
 * with others, and statuses[i] what it returns. Each result has an array of its own, or none. The
 * structures of an array are as far apart as the first one's struct_size says.
 *
 * options->tasks: the host's threads, each of which asks about one pose at a time, with a workspace
 * of its own: workspaces has tasks->workers of them, 1 without tasks, each for one worker at least.
 * Without pairs in common there is nothing to wait for: two threads take half the time of one,
 * where memory is fast enough. A function in the filter is called in several threads at once. The
 * flag of cancel ends all: what was not asked about is SC_ERROR_INCOMPLETE, with no pairs.
 *
 * Returns SC_OK if all queries do; else what the first one in order returned that does not, or,
 * with no result touched, SC_ERROR_NULL, SC_ERROR_STRUCT_SIZE, or SC_ERROR_WORKSPACE for two
 * workspaces that are one or more workers than there may be. No memory is allocated.
 */
SC_API sc_status sc_query_batch(const sc_model *model, sc_workspace *const *workspaces,
                                const sc_pose *poses, uint32_t count,
                                const sc_query_options *options, sc_result *results,
                                sc_status *statuses);

/* Sums. */
enum {
    SC_STEP_APPROACHES = 1, /* at the start the two come nearer, or touch */
    SC_STEP_NO_NORMAL = 2   /* they touch, and nothing tells from which side; normal is 0 */
};

/*
 * A pair of a step at two times.
 *
 * normal is a unit vector from the point of a to that of b at the time; where they touch then, that
 * of the start; and where they touch at both times, of vertex and face the face's normal at the
 * start, of edges the cross product of the two, away from the side on which a began.
 */
typedef struct sc_step_stencil {
    sc_near_stencil start;  /* the closest points at the start of the step */
    sc_near_stencil impact; /* and at the time */
    double time;
    double normal[3];
    int32_t side;   /* 1: the vertex began where the corners of the face are seen counter-clockwise,
                       -1: where clockwise, 0: in its plane. Of edges the sign of
                       (b0 - a0) . ((a1 - a0) x (b1 - b0)) at the start. Exact */
    uint32_t flags; /* SC_STEP_APPROACHES, SC_STEP_NO_NORMAL */
} sc_step_stencil;

/*
 * Finds the closest points of pairs of a step, at its start and at a time of each: stencils[i] is
 * that of pairs[i] at times[i], such as sc_query_step found:
 *
 *     sc_step_stencils(model, &start, &end, SC_NEAR_VERTEX_FACE, result.vertex_faces,
 *                      result.vertex_face_times, result.vertex_face_count, stencils);
 *
 * times are from 0 to 1; NULL: all are 0, and both stencils the same. A coordinate at a time t is
 * (1 - t) start + t end, in doubles: two products and a sum, each rounded, the start itself at 0
 * and the end at 1. For these coordinates stencils are what sc_near_stencil promises. Whether two
 * approach is told by the sum of weights times motions along the vector between the closest points,
 * in doubles: within rounding of 0 it may be either, and where other points are as near, as between
 * parallel edges, nothing is said of those.
 *
 * Errors, memory and threads are as for sc_near_stencils; SC_ERROR_OPTION: a time is NaN or not
 * from 0 to 1. Twice the cost of that.
 */
SC_API sc_status sc_step_stencils(const sc_model *model, const sc_pose *start, const sc_pose *end,
                                  uint32_t kind, const sc_pair *pairs, const double *times,
                                  uint64_t count, sc_step_stencil *stencils);

/* ------------------------------------------------------------------------------------------------
 * Several objects
 *
 * A scene of objects, each with a model of its own or one that it shares with others: cloth and a
 * body, layers of clothes, many characters, a static level. One call finds what objects have with
 * each other and with themselves; what did not move since the last call is not read again.
 *
 *     a workspace for each object: sc_workspace_create or _create_for
 *     sc_query_objects(&objects, &options, &result)            what intersects
 *     sc_query_objects_near(&objects, &options, &lists)        what is near
 *     sc_query_objects_step(&objects, &options, &lists)        what collides in a step
 */

/*
 * One object. The workspace was made for the model and is in no other object; what a call leaves in
 * it is for the next call with the same object. Workspaces of many objects of one model may use one
 * room, see sc_workspace_options.
 */
typedef struct sc_object {
    const sc_model *model;
    sc_workspace *workspace;
    const sc_pose *pose;   /* of a step that at its start */
    const sc_pose *end;    /* of a step that at its end, or NULL: it stays where it is; else NULL */
    uint64_t pose_version; /* 0, or a number that changes whenever a coordinate does. If it is what
                              the last call of the same function with this workspace was given, the
                              positions are those of then, wherever they are now; and what was made
                              of them is kept, unless the box of all objects has grown or shrunk
                              much, or a query of another kind has been made */
    sc_group group;        /* what it collides with; 0 and 0: with everything */
    uint32_t itself;       /* 1: its pairs with itself are sought, too */
    uint32_t reserved;     /* 0 */
    /* Which pairs with itself are not wanted, or NULL. Of sc_query_objects: */
    const sc_filter *filter;
    /* Of what is near and of steps, as in sc_near_options and sc_step_options: */
    const sc_filter *vertex_face_filter, *edge_edge_filter;
    const sc_pose *rest;
    double rest_distance;
    const sc_near_masks *masks; /* of what is near */
} sc_object;

/* The objects of a scene. */
typedef struct sc_objects {
    uint32_t struct_size;
    uint32_t count;           /* how many there are */
    const sc_object *objects; /* them */
    uint64_t stride;          /* bytes from one to the next; 0: sizeof(sc_object) */
    /* Of pairs of two objects, which are wanted; or NULL: all. Called for each pair that is found,
       in any order, in the thread that called, with numbers of objects, triangles and edges as they
       would be reported; 0 leaves it out. It must not use the workspaces. */
    int (*accept)(void *user, uint32_t object_a, uint32_t object_b, uint32_t a, uint32_t b);
    void *accept_user;
    /* The same of what is near and of steps; kind: SC_NEAR_VERTEX_FACE or SC_NEAR_EDGE_EDGE. */
    int (*accept_near)(void *user, uint32_t kind, uint32_t object_a, uint32_t object_b, uint32_t a,
                       uint32_t b);
} sc_objects;

/* Which pairs are of which two objects: pairs[first] to pairs[first + count - 1]. */
typedef struct sc_object_pairs {
    uint32_t object_a, object_b;
    uint64_t first, count;
} sc_object_pairs;

/*
 * The answer. The caller sets struct_size and, for SC_OUTPUT_PAIRS, pairs and capacity, may give an
 * array of ranges, and may set stats; the library sets the rest. Arrays may be NULL when their
 * capacity is 0.
 *
 * Of two objects that have pairs, or of one that has some with itself, there is one range; sorted
 * by the lower of both numbers, then by the other, and ranges of pairs follow each other.
 * Triangles: object_a <= object_b, and of two objects a is a triangle of object_a and b one of
 * object_b. Edges with triangles (SC_PAIRS_EDGE): a is an edge of object_a, b a triangle of
 * object_b, and there is a range for either order, first that in which object_a < object_b. Within
 * a range pairs are sorted by a, then b; those of an object with itself are sc_query's.
 */
typedef struct sc_objects_result {
    uint32_t struct_size;
    uint32_t collides;       /* out: 1 if there is a pair, else 0 */
    uint64_t count;          /* out: the number of pairs; 0 or 1 for SC_OUTPUT_ANY */
    uint64_t capacity;       /* in: entries of pairs */
    sc_pair *pairs;          /* in: the caller's array */
    uint64_t range_count;    /* out: the number of ranges */
    uint64_t range_capacity; /* in: entries of ranges; 0 where these are not wanted */
    sc_object_pairs *ranges; /* in: the caller's array */
    sc_stats *stats;         /* in: where to put statistics of all together, or NULL */
    uint32_t verdict;        /* out: SC_VERDICT_... */
    uint32_t reserved;       /* out: 0 */
} sc_objects_result;

/*
 * Finds which pairs of objects have in common what, and with themselves: the same pairs, exactly,
 * as one mesh of all objects would have in which no vertex of one is welded to one of another.
 * options are those of sc_query, and may be NULL; their filter must be NULL and their budget 0
 * (SC_ERROR_OPTION). Pairs of two objects are sought only if groups let them collide:
 * (a.group.category & b.group.mask) && (b.group.category & a.group.mask), where a group of zeros
 * collides with every other. Filters of objects are for their pairs with themselves.
 *
 * An object without the other's neighborhood costs little: of an object with a pose_version that is
 * as before, and itself 0, only what is near others is looked at. Of two objects no more than boxes
 * of both trees are culled, from the roots down. All objects are seen in one box, of which single
 * precision sees 2^-24: objects far apart from each other take more time where they are near
 * something, and have the same pairs.
 *
 * Returns SC_OK; SC_ERROR_SHORT_BUFFER if pairs or ranges do not fit: count and range_count are
 * then what is needed, pairs holds all ranges that fit and ranges the first ones;
 * SC_ERROR_INCOMPLETE if it was cancelled. Errors are those of sc_query, of the first object that
 * has one, and the log of its workspace says what is wrong. Moreover SC_ERROR_WORKSPACE: a
 * workspace is in two objects; SC_ERROR_STRIDE. On such errors count, collides and verdict are 0,
 * and the arrays as they were.
 *
 * Tasks share in what is asked of objects, or of two, whose workspaces have as many workers; else
 * the calling thread does it. Objects up to about 14,000 triangles, by themselves or with any
 * other, are asked many at a time, each by one worker, and larger ones one after the other by all
 * workers; but where a function is to be asked, all are. Which pair is found of SC_OUTPUT_ANY is up
 * to chance with the latter alone; all else is the same whoever did what. No memory is allocated.
 * Workspaces of one call must not be used by another at the same time. Cost: reading what moved,
 * sc_query for each object with itself = 1, and what is near between others; sorting boxes along
 * one side, and 6 ns for two objects whose boxes overlap along it.
 */
SC_API sc_status sc_query_objects(const sc_objects *objects, const sc_query_options *options,
                                  sc_objects_result *result);

/*
 * One of the two lists of what is near, or of what collides in a step. The caller sets capacities
 * and, where these are not 0, arrays; the library sets the rest.
 *
 * Vertices with faces: a is a vertex of object_a, b a triangle of object_b, and there is a range
 * for either order. Two edges: object_a <= object_b, and of two objects a is an edge of object_a
 * and b one of object_b. Ranges are sorted by the lower of both numbers, then by the other, then by
 * object_a, and within one pairs by a, then b.
 */
typedef struct sc_object_list {
    uint64_t count;          /* out: the number of pairs */
    uint64_t capacity;       /* in: entries of pairs, and of times */
    sc_pair *pairs;          /* in: the caller's array */
    double *times;           /* in: of a step with SC_STEP_TIMES_EACH, those of pairs; or NULL */
    uint64_t range_count;    /* out: the number of ranges */
    uint64_t range_capacity; /* in: entries of ranges; 0 where these are not wanted */
    sc_object_pairs *ranges; /* in: the caller's array */
} sc_object_list;

/* The answer of sc_query_objects_near and sc_query_objects_step. The caller sets struct_size and
   the lists, and may set stats; the library sets the rest. */
typedef struct sc_objects_lists {
    uint32_t struct_size;
    uint32_t collides; /* out: 1 if there is a pair, else 0 */
    sc_object_list vertex_faces, edge_edges;
    sc_stats *stats;   /* in: where to put statistics of all together, or NULL */
    double earliest;   /* out: of a step: as in sc_step_result; else 0 */
    uint32_t verdict;  /* out: SC_VERDICT_... */
    uint32_t reserved; /* out: 0 */
} sc_objects_lists;

/*
 * Finds which vertices are within a distance of which faces, and which edges of which edges, of two
 * objects and of one: the same pairs, exactly, as sc_query_near finds in one mesh of all objects in
 * which no vertex of one is welded to one of another. options are those of sc_query_near, and may
 * be NULL; filters, rest pose and masks are those of objects, so that theirs must be NULL and 0,
 * and so must their budget (SC_ERROR_OPTION). Workspaces were made with SC_WORKSPACE_NEAR.
 *
 * All else is as for sc_query_objects: groups, what is returned, what is kept. On
 * SC_ERROR_SHORT_BUFFER each list has all ranges that fit, and the counts that are needed. Bounds
 * of vertices are asked for by sc_query_near, of one mesh. SC_ERROR_COUNT: an object has more than
 * 2^31 vertices.
 *
 * Cost: reading what moved, about 6 ns a vertex; boxes; sc_query_near for each object with
 * itself = 1; what is near between others; and comparing boxes, as for sc_query_objects.
 */
SC_API sc_status sc_query_objects_near(const sc_objects *objects, const sc_near_options *options,
                                       sc_objects_lists *lists);

/*
 * Finds what collides while objects move from pose to end: the same pairs with the same times as
 * sc_query_step finds in one mesh of all objects in which no vertex of one is welded to one of
 * another. options are those of sc_query_step, and may be NULL; what objects have, and their
 * budget, is to be left out as above. A tolerance of 0 stands for 1e-6 times the longest side of
 * the box of all objects. Workspaces were made with SC_WORKSPACE_STEP or SC_WORKSPACE_NEAR.
 *
 * A pose_version that is as before says that both poses are; of what stays where it is, that it
 * still does. Candidates (SC_STEP_CANDIDATES) of two objects are what the boxes of both leave, and
 * not those of one mesh. Else as sc_query_objects_near.
 */
SC_API sc_status sc_query_objects_step(const sc_objects *objects, const sc_step_options *options,
                                       sc_objects_lists *lists);

/* ------------------------------------------------------------------------------------------------
 * Records
 *
 * One question in one block of bytes: the model, the pose or both poses, and the options of a
 * query, a step or a search for what is near; as a bug report, or to look into later with
 * `sc-query --replay FILE`. The bytes are for machines of one byte order, as saved models. Of a
 * filter everything is recorded but the caller's function, and of a flag to cancel nothing. What
 * was left out is written down in the record. Tasks, which change no answer, are not recorded.
 */

/* Writes the number of bytes that sc_record_write writes. Errors are as for sc_query. */
SC_API sc_status sc_record_size(const sc_model *model, const sc_pose *pose,
                                const sc_query_options *options, uint64_t *size);

/*
 * Records the query that sc_query would run: writes *written bytes to memory, of which there are
 * size, at any alignment. Coordinates may be anything, also NaN. Where options->filter->accept or
 * options->cancel is not NULL, the record says so (SC_LEFT_OUT_...) and asks without: it finds what
 * accept refuses, too. Errors are as for sc_query, and SC_ERROR_SHORT_BUFFER if the bytes do not
 * fit: nothing is written, and *written is what is needed. written may be NULL. Cost: a copy of the
 * model, the pose and the filter's arrays, and a checksum.
 */
SC_API sc_status sc_record_write(const sc_model *model, const sc_pose *pose,
                                 const sc_query_options *options, void *memory, uint64_t size,
                                 uint64_t *written);

/*
 * The same of the step that sc_query_step would run: with both poses, filters of both kinds and the
 * rest pose. Errors are those of sc_query_step.
 */
SC_API sc_status sc_record_step_size(const sc_model *model, const sc_pose *start,
                                     const sc_pose *end, const sc_step_options *options,
                                     uint64_t *size);
SC_API sc_status sc_record_step_write(const sc_model *model, const sc_pose *start,
                                      const sc_pose *end, const sc_step_options *options,
                                      void *memory, uint64_t size, uint64_t *written);

/*
 * The same of the search that sc_query_near would run. Of masks the number of rings is recorded:
 * sc_near_masks_create makes the same ones from it and the model, and so nothing is left out.
 * Bounds of vertices are asked for in the result, which is not recorded. Errors are those of
 * sc_query_near.
 */
SC_API sc_status sc_record_near_size(const sc_model *model, const sc_pose *pose,
                                     const sc_near_options *options, uint64_t *size);
SC_API sc_status sc_record_near_write(const sc_model *model, const sc_pose *pose,
                                      const sc_near_options *options, void *memory, uint64_t size,
                                      uint64_t *written);

/* What the recorded question had and the record has not; a sum. */
enum {
    SC_LEFT_OUT_ACCEPT = 1, /* sc_filter.accept; of two filters that of either or both */
    SC_LEFT_OUT_CANCEL = 2  /* the options' cancel */
};

/* What a record is of. */
enum {
    SC_RECORD_QUERY = 0, /* sc_query */
    SC_RECORD_STEP = 1,  /* sc_query_step */
    SC_RECORD_NEAR = 2   /* sc_query_near */
};

/*
 * What a record holds. Arrays are in the record. Of the structures to fill, those may be NULL that
 * only other kinds of records have, and those for what the record has not: so kinds are read that
 * the caller knows what to do with, and others refused. Of a structure that is given, but of which
 * the record has nothing, all members but struct_size become 0.
 */
typedef struct sc_record {
    uint32_t struct_size;
    uint32_t left_out;         /* out: SC_LEFT_OUT_..., 0 if the record is the whole question */
    sc_pose *pose;             /* in: what to fill, its struct_size set; of a step its start. Never
                                  NULL */
    sc_query_options *options; /* in: the same, of a query. options->filter becomes filter, or
                                  NULL */
    const void *model;   /* out: for sc_model_load; aligned to SC_ALIGNMENT if the record is */
    uint64_t model_size; /* out */
    sc_filter *filter;   /* in: the filter of a query, or of vertices and faces; NULL, if records
                            with one are to be refused */
    uint32_t kind;       /* out: SC_RECORD_... */
    uint32_t mask_rings; /* out: of a search with masks, for sc_near_masks_create; near_options->
                            masks is NULL, to be set to what that makes. Else 0 */
    sc_step_options *step_options; /* in: those of a step. Filters and rest become those below, or
                                      NULL, where there is none */
    sc_near_options *near_options; /* in: those of a search. The same */
    sc_pose *end;                  /* in: the end of a step */
    sc_pose *rest;                 /* in: the rest pose of a step or a search */
    sc_filter *edge_edge_filter;   /* in: the filter of two edges */
} sc_record;

/*
 * Finds the parts of a record: data, of which there are size bytes; those behind it are ignored.
 * Data that are no record are refused as by sc_model_load. On an error nothing is filled. The model
 * is checked by sc_model_load, and the rest by sc_query, sc_query_step or sc_query_near; a filter
 * is good for questions on that model only.
 *
 * SC_ERROR_NULL: there is no structure for something that the record has. SC_ERROR_STRUCT_SIZE: the
 * record has what a structure of the caller's is too small for. SC_ERROR_ALIGNMENT, of records with
 * a filter: data are not aligned as uint32_t.
 */
SC_API sc_status sc_record_read(const void *data, uint64_t size, sc_record *record);

#ifdef __cplusplus
}
#endif

#endif /* STARCONTOUR_H */
