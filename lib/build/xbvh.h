/*
 * The extended bounding-volume hierarchy (xBVH; paper, section 5): the patches of every level.
 *
 * SPDX-License-Identifier: MIT
 *
 * Level 0 is the whole mesh, the last level the leaf clusters. A leaf that the tree reaches early
 * is repeated at every deeper level, so that each level covers the mesh and, read left to right, is
 * a run of leaves cut into consecutive pieces. Patches are numbered level by level, and behind each
 * level comes one number that is no patch: so for every patch p
 *
 *     its children are the patches child[p] to child[p + 1] - 1, one or two, of the next level;
 *     its leaves   are         leaf[p]  to leaf[p + 1] - 1.
 *
 * At most (leaves + 1) * levels entries; about 2.3 per leaf for the built-in partition.
 */
#ifndef SC_BUILD_XBVH_H
#define SC_BUILD_XBVH_H

#include "build/hierarchy.h"

/* All arrays are scratch memory. */
typedef struct sc_xbvh {
    uint32_t level_count, leaf_count, patch_end; /* patch_end: all numbers are below it */
    uint32_t *level_first; /* level_count + 1: level l has the patches level_first[l] to
                              level_first[l + 1] - 2 */
    uint32_t *child;       /* patch_end; at the last level the patch's own number */
    uint32_t *leaf;        /* patch_end */
    uint32_t *leaf_first;  /* leaf_count + 1: where leaf k starts in the hierarchy's order */
} sc_xbvh;

sc_status sc_xbvh_build(const sc_hierarchy *hierarchy, sc_scratch *scratch, sc_xbvh *xbvh);

static inline uint32_t sc_xbvh_patches(const sc_xbvh *xbvh, uint32_t level)
{
    return xbvh->level_first[level + 1] - 1 - xbvh->level_first[level];
}

/* Whether a patch is a single leaf cluster. */
static inline int sc_xbvh_is_leaf(const sc_xbvh *xbvh, uint32_t patch)
{
    return xbvh->leaf[patch + 1] - xbvh->leaf[patch] == 1;
}

/* For debug builds and tests: 1 if the invariants hold. */
int sc_xbvh_validate(const sc_xbvh *xbvh);

#endif
