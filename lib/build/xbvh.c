/*
 * The patches of every level. See xbvh.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "build/xbvh.h"

#include "base/assume.h"

sc_status sc_xbvh_build(const sc_hierarchy *hierarchy, sc_scratch *scratch, sc_xbvh *xbvh)
{
    uint32_t count = 1, level, i, end = 0, *nodes, *next;
    uint64_t total = 0;
    const sc_tree_node *tree = hierarchy->nodes;
    /* tens of gigabytes */
    if (hierarchy->leaf_count > SC_LEAVES_MAX) return SC_ERROR_COUNT;
    nodes = (uint32_t *)sc_scratch_take(scratch, hierarchy->leaf_count, sizeof *nodes);
    next = (uint32_t *)sc_scratch_take(scratch, hierarchy->leaf_count, sizeof *next);
    xbvh->level_count = hierarchy->depth;
    xbvh->leaf_count = hierarchy->leaf_count;
    xbvh->level_first =
        (uint32_t *)sc_scratch_take(scratch, (uint64_t)hierarchy->depth + 1, sizeof(uint32_t));
    xbvh->leaf_first =
        (uint32_t *)sc_scratch_take(scratch, (uint64_t)hierarchy->leaf_count + 1, sizeof(uint32_t));
    if (!nodes || !next || !xbvh->level_first || !xbvh->leaf_first) return SC_ERROR_MEMORY;

    /* once to count, then once to write: the nodes of a level, left to right */
    for (nodes[0] = 0, level = 0; level < hierarchy->depth; level++) {
        uint32_t *swapped = nodes, n = 0;
        total += (uint64_t)count + 1;
        for (i = 0; i < count; i++) {
            const sc_tree_node *node = &tree[nodes[i]];
            if (node->left == SC_NONE) {
                next[n++] = nodes[i];
            } else {
                next[n++] = node->left;
                next[n++] = node->right;
            }
            if (level + 1 == hierarchy->depth) n--; /* no deeper level: next is not used */
        }
        nodes = next;
        next = swapped;
        count = n;
    }
    if (SC_HARDLY(total > 0xfffffff0u)) return SC_ERROR_COUNT; /* 32 gigabytes */
    xbvh->patch_end = (uint32_t)total;
    xbvh->child = (uint32_t *)sc_scratch_take(scratch, total, sizeof(uint32_t));
    xbvh->leaf = (uint32_t *)sc_scratch_take(scratch, total, sizeof(uint32_t));
    if (!xbvh->child || !xbvh->leaf) return SC_ERROR_MEMORY;
    for (nodes[0] = 0, count = 1, level = 0; level < hierarchy->depth; level++) {
        uint32_t *swapped = nodes, n = 0, last = level + 1 == hierarchy->depth;
        uint32_t below = end + count + 1;
        xbvh->level_first[level] = end;
        for (i = 0; i < count; i++, end++) {
            const sc_tree_node *node = &tree[nodes[i]];
            xbvh->leaf[end] = node->first; /* a place in order; made a leaf number below */
            xbvh->child[end] = last ? end : below + n;
            if (last) {
                xbvh->leaf_first[i] = node->first;
            } else if (node->left == SC_NONE) {
                next[n++] = nodes[i];
            } else {
                next[n++] = node->left;
                next[n++] = node->right;
            }
        }
        xbvh->leaf[end] = hierarchy->triangle_count;
        xbvh->child[end] = last ? end : below + n;
        end++;
        nodes = next;
        next = swapped;
        count = n;
    }
    xbvh->level_first[hierarchy->depth] = end;
    xbvh->leaf_first[hierarchy->leaf_count] = hierarchy->triangle_count;
    for (level = 0; level < hierarchy->depth; level++) {
        uint32_t leaf = 0;
        for (i = xbvh->level_first[level]; i < xbvh->level_first[level + 1]; i++) {
            while (xbvh->leaf_first[leaf] < xbvh->leaf[i]) leaf++;
            xbvh->leaf[i] = leaf;
        }
    }
    sc_scratch_give(scratch, nodes);
    sc_scratch_give(scratch, next);
    return SC_OK;
}

int sc_xbvh_validate(const sc_xbvh *xbvh)
{
    uint32_t level, p, last = xbvh->level_count - 1;
    if (xbvh->level_first[0] != 0 || xbvh->level_first[xbvh->level_count] != xbvh->patch_end)
        return 0;
    if (sc_xbvh_patches(xbvh, 0) != 1 || sc_xbvh_patches(xbvh, last) != xbvh->leaf_count) return 0;
    for (level = 0; level <= last; level++) {
        uint32_t first = xbvh->level_first[level], end = xbvh->level_first[level + 1] - 1;
        if (xbvh->leaf[first] != 0 || xbvh->leaf[end] != xbvh->leaf_count) return 0;
        for (p = first; p < end; p++) {
            if (xbvh->leaf[p] >= xbvh->leaf[p + 1]) return 0;
            if (level == last) continue;
            if (xbvh->child[p + 1] - xbvh->child[p] - 1u > 1u) return 0;
            if (xbvh->child[p + 1] >= xbvh->level_first[level + 2]) return 0;
            if (xbvh->leaf[xbvh->child[p]] != xbvh->leaf[p]) return 0;
            if (xbvh->leaf[xbvh->child[p + 1]] != xbvh->leaf[p + 1]) return 0;
        }
        if (level != last && (xbvh->child[first] != xbvh->level_first[level + 1] ||
                              xbvh->child[end] != xbvh->level_first[level + 2] - 1))
            return 0;
    }
    return 1;
}
