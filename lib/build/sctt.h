/*
 * The self-collision test tree (SCTT; paper, section 5): every test of a patch against itself and
 * of two adjacent patches of one level.
 *
 * SPDX-License-Identifier: MIT
 *
 * self(P) tests a patch against itself, pair(A, B) two adjacent patches. Node 0 is self(the mesh).
 * The children of self(P) are self(C) for the children C of P, and pair(C, D) for those that are
 * adjacent; of pair(A, B), those pair(C, D) of a child of A and a child of B that are adjacent. The
 * other pairs of children are the node's children in the bounding-volume test tree (BVTT). A node
 * whose patches are single leaf clusters has no children: so each adjacent pair is in the tree
 * once, although the xBVH repeats leaves. (The paper's root is the pair of the root's children, and
 * its self tests are those of sibling pairs; the nodes are the same.)
 *
 * Nodes are numbered level by level, so that the children of node n are nodes child[n] to
 * child[n + 1] - 1, those of one patch first. Which of the pairs of children are nodes, and which
 * BVTT children, stands in pairs[n]: bit 2 i + j for child i of the first patch and child j of the
 * second, and that of a BVTT child SC_PAIR_BOXES higher. A patch has two children at most.
 * About one node per triangle.
 */
#ifndef SC_BUILD_SCTT_H
#define SC_BUILD_SCTT_H

#include "build/neighbors.h"

enum { SC_PAIR_BOXES = 4 };

/* Scratch memory. Patches are numbers of the xBVH, a <= b. */
typedef struct sc_sctt {
    uint32_t node_count;
    sc_pair *patches;      /* node_count; a == b in self nodes */
    uint32_t *child;       /* node_count + 1 */
    uint32_t *pairs;       /* node_count; 0: of single leaf clusters */
    uint32_t *touch;       /* node_count: the one point that a pair shares, else SC_NONE */
    uint32_t *level_first; /* level_count + 1 */
} sc_sctt;

sc_status sc_sctt_build(const sc_xbvh *xbvh, const sc_neighbors *neighbors, sc_scratch *scratch,
                        sc_sctt *sctt);

/* For debug builds and tests: 1 if every adjacent pair of patches whose parents are tested against
   each other is a child node of those, every other pair of children a BVTT child, and each once. */
int sc_sctt_validate(const sc_xbvh *xbvh, const sc_neighbors *neighbors, const sc_sctt *sctt);

#endif
