/*
 * The model: one block of flat arrays, without pointers, that every query of every thread reads.
 *
 * SPDX-License-Identifier: MIT
 *
 *     | sc_model_owner | sc_model (counts and offsets) | array | array | ... |
 *
 * Arrays start at multiples of SC_ALIGNMENT from the sc_model, which can be moved as a block of
 * sc_model.bytes bytes. What frees it stands before it; before a model that is used in place where
 * it was saved stands the header of the save (build/saved_model.h), and the caller frees it.
 *
 * A model with SC_MODEL_BOXES has an empty test tree: no nodes, segments or contours.
 *
 * The block is the format of saved models: whoever changes what is in it raises the version in
 * build/saved_model.c, and makes build/model_check.c check it.
 */
#ifndef SC_BUILD_MODEL_H
#define SC_BUILD_MODEL_H

#include "build/loops.h"
#include "build/sharing_lists.h"

/* One level of patches, and how its nodes fared in the rest pose. */
typedef struct sc_level {
    uint32_t patch_count, connected_patches, segment_count;
    uint32_t self_nodes, self_oriented, self_culled;
    uint32_t pair_nodes, pair_oriented, pair_culled;
} sc_level;

/* What a vertex is. */
enum {
    SC_VERTEX_POINT = 0,  /* a point, of a triangle or more */
    SC_VERTEX_WELDED = 1, /* another vertex stands for it: only checked to be finite */
    SC_VERTEX_UNUSED = 2  /* in no triangle: not even read */
};

/* What is known of nodes from the topology; and what the rest pose says of them. */
enum {
    SC_NODE_TOUCHES =
        1, /* its two patches share one point; the contour is listed as build/csf.h says */
    SC_NODE_PIECES = 2,      /* the contour may be in pieces that share no point */
    SC_NODE_REST_TURNED = 4, /* failed the orientation test in the rest pose */
    SC_NODE_REST_CROSSED = 8 /* passed it and failed the contour test */
};

/*
 * A node of the test tree (build/sctt.h), with all that a query needs to test or to open it. Behind
 * the last node comes one that has only child and contour: where those of a further one would
 * begin.
 */
typedef struct sc_node {
    sc_pair patches;      /* a == b: of one patch */
    uint32_t child;       /* its first child; see sc_node_end */
    uint32_t loop;        /* first number of its contour in loop: build/loops.h */
    uint32_t contour;     /* first number of the list of segments in contours: build/csf.h */
    uint16_t loop_length; /* 0: there is no loop */
    uint8_t pairs;        /* build/sctt.h */
    uint8_t kind;         /* SC_NODE_... */
} sc_node;

/* Behind the last child of a node. */
static inline uint32_t sc_node_end(const sc_node *node)
{
    const uint64_t counts = UINT64_C(0x4332322132212110); /* of the bits in 15, 14, ... 0 */
    return node->child + (uint32_t)(counts >> 4 * (node->pairs & 15u) & 15u);
}

/* The pairs of patches that a node leaves to boxes, as bits; see sc_model_pair. */
static inline uint32_t sc_node_boxes(const sc_node *node)
{
    return (uint32_t)node->pairs >> SC_PAIR_BOXES;
}

/* Whether a node is of single leaf clusters: then it leaves these. */
static inline int sc_node_is_leaf(const sc_node *node)
{
    return !node->pairs;
}

/* Where two leaf clusters have the point that they touch in, if they share just one: its place in
   the lower one's leaf_point, in four bits, and that in the other's; and whether it is the last
   point of each. Or SC_TOUCH_CHAIN: they share just a chain of points round a tube, see
   sc_outline_bit. */
enum {
    SC_TOUCH_LAST = 8,
    SC_TOUCH_LAST_OF_OTHER = 9,
    SC_TOUCH_CHAIN = 1 << 14,
    SC_TOUCHES = 1 << 15
};

/* Of the outline of a leaf cluster that is two chains: the point of a place is in the second; in
   none; and in the last place all the time that it is so. */
enum sc_outline_bit { SC_OUTLINE_SECOND = 16, SC_OUTLINE_TWO = 32, SC_OUTLINE_NOWHERE = 64 };

/*
 * All arrays: name, type, number of elements. "Places" are triangles in leaf order. A point has the
 * number of the caller's vertex that stands for it, where a query finds its position.
 *
 *   vertex_use      what each of the caller's vertices is: SC_VERTEX_...
 *   triangle        three points a place
 *   triangle_id     the caller's number of the triangle at a place
 *   place           the place of the caller's triangle
 *   edge_owned      bit k: side k of the triangle at a place names its edge
 *   leaf_first      first place of each leaf cluster
 *   leaf_point      SC_LEAF_POINTS a cluster: the points of its triangles, the last one again to
 *                   fill the row
 *   leaf_corner     3 SC_LEAF_MAX a cluster: where in leaf_point the first corners of its triangles
 *                   are, then the second, then the third; the last triangle again to fill the rows
 *   leaf_fan        two sets of places in leaf_point a cluster: points round which its triangles
 *                   follow each other, one beginning where the one before ends; first those where
 *                   all of them are a closed fan, then the others
 *   leaf_outline    SC_LEAF_POINTS a cluster: if its outline is two closed chains of edges that
 *                   come to no point twice, as of a tube, for each place in leaf_point the one that
 *                   follows it there, and what sc_outline_bit names; else zeros
 *   share_...       see build/sharing.h, share_own_rows are folded; share_begin, share_list:
 *                   build/sharing_lists.h
 *   share_touch     of two leaf clusters that share one point, SC_TOUCHES and where they have it;
 *                   of two that share a chain, SC_TOUCH_CHAIN; else 0
 *   share_node      the node of the test tree that is of the two leaf clusters; SC_NONE in models
 *                   for boxes
 *   level_first, child, leaf   see build/xbvh.h
 *   box_child       first child of a patch in box recursion, which visits every fourth level,
 *                   ending with the last
 *   around_first, around  the points that edges join each point with: all if every edge there has
 *                   an opposite one, else some perhaps twice
 *   node            the test tree, see above
 *   contours        the segments round each node, see build/csf.h
 *   loop            see build/loops.h
 *   segment_...     see build/csf.h
 *   level_info      see above
 */
#define SC_MODEL_ARRAYS(X)                                                                         \
  X(vertex_use, uint8_t, vertex_count)                                                             \
  X(triangle, uint32_t, 3 * (uint64_t)triangle_count)                                              \
  X(triangle_id, uint32_t, triangle_count)                                                         \
  X(place, uint32_t, triangle_count)                                                               \
  X(edge_owned, uint8_t, triangle_count)                                                           \
  X(leaf_first, uint32_t, (uint64_t)leaf_count + 1)                                                \
  X(leaf_point, uint32_t, SC_LEAF_POINTS *(uint64_t)leaf_count)                                    \
  X(leaf_corner, uint8_t, 3 * SC_LEAF_MAX * (uint64_t)leaf_count)                                  \
  X(leaf_fan, uint16_t, 2 * (uint64_t)leaf_count)                                                  \
  X(leaf_outline, uint8_t, SC_LEAF_POINTS *(uint64_t)leaf_count)                                   \
  X(share_first, uint32_t, (uint64_t)leaf_count + 1)                                               \
  X(share_leaf, uint32_t, share_count)                                                             \
  X(share_node, uint32_t, share_count)                                                             \
  X(share_touch, uint16_t, share_count)                                                            \
  X(share_begin, uint32_t, (uint64_t)share_count + 1)                                              \
  X(share_list, uint16_t, share_total)                                                             \
  X(share_own_rows, uint16_t, SC_OWN_WORDS *(uint64_t)leaf_count)                                  \
  X(share_crowded, uint8_t, leaf_count)                                                            \
  X(level_first, uint32_t, (uint64_t)level_count + 1)                                              \
  X(child, uint32_t, patch_end)                                                                    \
  X(leaf, uint32_t, patch_end)                                                                     \
  X(box_child, uint32_t, patch_end)                                                                \
  X(around_first, uint32_t, (uint64_t)vertex_count + 1)                                            \
  X(around, uint32_t, around_total)                                                                \
  X(node, sc_node, (uint64_t)node_count + 1)                                                       \
  X(contours, uint32_t, contour_total)                                                             \
  X(loop, uint16_t, loop_total)                                                                    \
  X(segment_first, uint32_t, segment_count)                                                        \
  X(segment_last, uint32_t, segment_count)                                                         \
  X(points, uint32_t, segment_point_total)                                                         \
  X(segment_children, uint32_t, (uint64_t)segment_count - leaf_segment_count + 1)                  \
  X(children, uint32_t, segment_child_total)                                                       \
  X(level_info, sc_level, level_count)

enum {
#define SC_MODEL_NUMBER(name, type, count) SC_ARRAY_##name,
    SC_MODEL_ARRAYS(SC_MODEL_NUMBER)
#undef SC_MODEL_NUMBER
        SC_ARRAY_COUNT
};

struct sc_model {
    uint64_t bytes; /* from here on, with all arrays */
    uint64_t topology_hash;
    uint64_t offset[SC_ARRAY_COUNT]; /* in bytes from the start of the sc_model */
    /* smaller members last, so that all machines have the same gaps: none */
    uint32_t vertex_count, point_count, triangle_count, edge_count;
    uint32_t component_count, boundary_edges, irregular_edges;
    uint32_t leaf_count, level_count, patch_end;
    uint32_t node_count, contour_total, loop_total;
    uint32_t segment_count, leaf_segment_count, segment_point_total, segment_child_total;
    uint32_t contour_max; /* points of the segments round a node, at most */
    uint32_t around_total, share_count, share_total;
    uint32_t reserved; /* 0: an even number of these */
};

/* Stands before the model and fills one alignment unit. */
typedef struct sc_model_owner {
    uint64_t kind; /* SC_MODEL_OWNED; the header of a save begins otherwise */
    sc_allocator allocator;
    uint64_t bytes;       /* with this */
    uint64_t peak_bytes;  /* most that was allocated at once to make the model, with it */
    uint64_t allocations; /* how often memory was asked for */
} sc_model_owner;

#define SC_MODEL_OWNED 1u

/* sc_model_<name>(model) is the array of that name. */
#define SC_MODEL_ACCESSOR(name, type, count)                                                       \
  static inline const type *sc_model_##name(const sc_model *model)                                 \
  {                                                                                                \
    return (const type *)(const void *)((const unsigned char *)model +                             \
                                        model->offset[SC_ARRAY_##name]);                           \
  }
SC_MODEL_ARRAYS(SC_MODEL_ACCESSOR)
#undef SC_MODEL_ACCESSOR

static inline uint32_t sc_model_patches(const sc_model *model, uint32_t level)
{
    const uint32_t *first = sc_model_level_first(model);
    return first[level + 1] - 1 - first[level];
}

/* The patch of the last level that is leaf cluster 0; leaf k is this plus k. */
static inline uint32_t sc_model_first_leaf_patch(const sc_model *model)
{
    return sc_model_level_first(model)[model->level_count - 1];
}

/* How many levels below a patch its children in box recursion are: at the last level, or at one of
   every fourth above. */
static inline uint32_t sc_model_box_steps(uint32_t level_count, uint32_t level)
{
    uint32_t steps = (level_count - 1 - level) % 4;
    return steps ? steps : 4;
}

/* How many leaf clusters a patch has. */
static inline uint32_t sc_model_leaves_of(const sc_model *model, uint32_t patch)
{
    return sc_model_leaf(model)[patch + 1] - sc_model_leaf(model)[patch];
}

static inline int sc_model_is_leaf(const sc_model *model, uint32_t patch)
{
    return sc_model_leaf(model)[patch + 1] - sc_model_leaf(model)[patch] == 1;
}

/* The pair of children of a node's patches that a bit stands for. */
static inline sc_pair sc_model_pair(const sc_model *model, const sc_node *node, uint32_t bit)
{
    const uint32_t *child = sc_model_child(model);
    sc_pair pair;
    pair.a = child[node->patches.a] + bit / 2;
    pair.b = child[node->patches.b] + bit % 2;
    return pair;
}

/* Whether it is a model with SC_MODEL_BOXES. */
static inline int sc_model_is_for_boxes(const sc_model *model)
{
    return model->node_count == 0;
}

/* Computes offsets and bytes from the counts. Counts must be at least 1, but for those that are 0
   in models for boxes; as many segments as leaf segments there at least. */
void sc_model_lay_out(sc_model *counts);

/* Memory for a model of so many bytes, behind its owner; the model's own is left unset. NULL if
   there is none. */
sc_model *sc_model_allocate(uint64_t bytes, sc_scratch *scratch);

/* Zeroes what is behind each array, so that equal models are equal bytes, and the array that is
   only added to. All else is written to later. */
void sc_model_clear_gaps(sc_model *model);

/* What frees a model, or NULL if the caller does. */
const sc_model_owner *sc_model_owner_of(const sc_model *model);

/* Notes in an owned model what its making took. */
void sc_model_note_memory(sc_model *model, const sc_scratch *scratch);

void sc_model_release(sc_model *model);

#endif
