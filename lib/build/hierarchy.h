/*
 * The binary tree of patches over the triangles, as partitioning makes it.
 *
 * SPDX-License-Identifier: MIT
 *
 * Invariants: node 0 is the root; a node comes before its children; the leaves, left to right, own
 * consecutive runs of order that cover it, each of at least one triangle, and at most SC_LEAF_MAX
 * of at most SC_LEAF_POINTS points.
 */
#ifndef SC_BUILD_HIERARCHY_H
#define SC_BUILD_HIERARCHY_H

#include "build/mesh.h"

/* Triangles in a leaf cluster at most, and points: one row of sixteen-wide tests each. */
enum { SC_LEAF_MAX = 16, SC_LEAF_POINTS = 16 };

/* Leaf clusters at most: 32 bits hold the place of a triangle or a point in all of them, which is
   SC_LEAF_MAX or SC_LEAF_POINTS times the number of its cluster, and its place in that. */
enum { SC_LEAVES_MAX = 0x0fffffff };

/* Nodes from the root to a leaf are fewer: see build/partition.c and build/bisection.c. */
enum { SC_DEPTH_MAX = 96 };

/* Room for so many nodes more than there can be, while subtrees are made apart: see
   build/bisection.c. */
enum { SC_HIERARCHY_SPARE = 64 };

/* All arrays are scratch memory. */
typedef struct sc_hierarchy {
    uint32_t *order;     /* triangle_count triangles, in leaf order */
    sc_tree_node *nodes; /* node_count; while it is made, room for 2 * triangle_count and spare */
    uint32_t triangle_count, node_count, leaf_count, depth;
    const uint32_t *corner; /* 3 * triangle_count: point numbers, see build/mesh.h */
    /* while it is made: */
    uint32_t *starts; /* room for where the leaves of a range start */
} sc_hierarchy;

/* Takes the memory; order is left unset. */
sc_status sc_hierarchy_init(sc_hierarchy *hierarchy, const sc_points *points, sc_scratch *scratch);

/* Gives back what only making it took, and room for nodes that there are not. */
sc_status sc_hierarchy_finish(sc_hierarchy *hierarchy, sc_scratch *scratch);

/* Appends a node without children for order[first .. first + count). depth counts from 1. */
uint32_t sc_hierarchy_add(sc_hierarchy *hierarchy, uint32_t first, uint32_t count, uint32_t depth);

/* Appends a balanced subtree for order[first .. first + count): leaves as full as the order lets
   them be. */
uint32_t sc_hierarchy_add_balanced(sc_hierarchy *hierarchy, uint32_t first, uint32_t count,
                                   uint32_t depth);

/* The same for all of order: faster, with four bytes a point of scratch memory. */
sc_status sc_hierarchy_cut_order(sc_hierarchy *hierarchy, uint32_t point_count,
                                 sc_scratch *scratch);

/* The end of the longest run of order[first .. end) that fits into a leaf cluster. */
uint32_t sc_hierarchy_leaf_end(const sc_hierarchy *hierarchy, uint32_t first, uint32_t end);

/* Appends a balanced subtree over count leaves, which start at starts[0] to starts[count - 1]; the
   last ends at starts[count]. */
uint32_t sc_hierarchy_add_leaves(sc_hierarchy *hierarchy, uint32_t count, uint32_t depth);

/* For debug builds and tests: 1 if the invariants hold. */
int sc_hierarchy_validate(const sc_hierarchy *hierarchy, sc_scratch *scratch);

#endif
