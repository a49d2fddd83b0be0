/*
 * The binary tree of patches over the triangles, as partitioning makes it.
 *
 * SPDX-License-Identifier: MIT
 *
 * Invariants: node 0 is the root; a node comes before its children; the leaves, left to right, own
 * consecutive runs of order, each of 1 to SC_LEAF_MAX triangles, that cover it.
 */
#ifndef SC_BUILD_HIERARCHY_H
#define SC_BUILD_HIERARCHY_H

#include "base/memory.h"

/* Triangles in a leaf cluster at most: one row of eight-wide tests. */
enum { SC_LEAF_MAX = 8 };

/* Nodes from the root to a leaf are fewer: see build/partition.c and build/bisection.c. */
enum { SC_DEPTH_MAX = 96 };

/* All arrays are scratch memory. */
typedef struct sc_hierarchy {
    uint32_t *order;     /* triangle_count triangles, in leaf order */
    sc_tree_node *nodes; /* node_count, room for 2 * triangle_count */
    uint32_t triangle_count, node_count, leaf_count, depth;
} sc_hierarchy;

/* Takes the memory; order is left unset. */
sc_status sc_hierarchy_init(sc_hierarchy *hierarchy, uint32_t triangle_count, sc_scratch *scratch);

/* Appends a node without children for order[first .. first + count). depth counts from 1. */
uint32_t sc_hierarchy_add(sc_hierarchy *hierarchy, uint32_t first, uint32_t count, uint32_t depth);

/* Appends a balanced subtree for order[first .. first + count), split at the middle down to leaves. */
uint32_t sc_hierarchy_add_balanced(sc_hierarchy *hierarchy, uint32_t first, uint32_t count,
                                   uint32_t depth);

/* How many leaves a patch of count triangles should get, and how many of them on its left. The slack
   of one in sixteen is what connecting and smoothing patches lives on. */
static inline uint32_t sc_hierarchy_leaves(uint32_t count)
{
    return (uint32_t)((2 * (uint64_t)count + 14) / 15);
}

/* For debug builds and tests: 1 if the invariants hold. */
int sc_hierarchy_validate(const sc_hierarchy *hierarchy, sc_scratch *scratch);

#endif
