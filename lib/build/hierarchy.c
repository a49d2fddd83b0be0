/*
 * The binary tree of patches. See hierarchy.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "build/hierarchy.h"

sc_status sc_hierarchy_init(sc_hierarchy *hierarchy, uint32_t triangle_count, sc_scratch *scratch)
{
    hierarchy->triangle_count = triangle_count;
    hierarchy->node_count = hierarchy->leaf_count = hierarchy->depth = 0;
    hierarchy->order = (uint32_t *)sc_scratch_take(scratch, triangle_count, sizeof(uint32_t));
    hierarchy->nodes = (sc_tree_node *)sc_scratch_take(scratch, 2 * (uint64_t)triangle_count,
                                                       sizeof(sc_tree_node));
    return hierarchy->order && hierarchy->nodes ? SC_OK : SC_ERROR_MEMORY;
}

uint32_t sc_hierarchy_add(sc_hierarchy *hierarchy, uint32_t first, uint32_t count, uint32_t depth)
{
    sc_tree_node *node = &hierarchy->nodes[hierarchy->node_count];
    node->left = node->right = SC_NONE;
    node->first = first;
    node->count = count;
    if (depth > hierarchy->depth) hierarchy->depth = depth;
    return hierarchy->node_count++;
}

uint32_t sc_hierarchy_add_balanced(sc_hierarchy *hierarchy, uint32_t first, uint32_t count,
                                   uint32_t depth)
{
    uint32_t node = sc_hierarchy_add(hierarchy, first, count, depth);
    if (count <= SC_LEAF_MAX) {
        hierarchy->leaf_count++;
    } else {
        uint32_t leaves = (count + SC_LEAF_MAX - 1) / SC_LEAF_MAX;
        uint32_t left = (uint32_t)((uint64_t)count * ((leaves + 1) / 2) / leaves), child;
        child = sc_hierarchy_add_balanced(hierarchy, first, left, depth + 1);
        hierarchy->nodes[node].left = child;
        child = sc_hierarchy_add_balanced(hierarchy, first + left, count - left, depth + 1);
        hierarchy->nodes[node].right = child;
    }
    return node;
}

int sc_hierarchy_validate(const sc_hierarchy *hierarchy, sc_scratch *scratch)
{
    uint32_t at = 0, leaves = 0, i, top = 0, stack[SC_DEPTH_MAX + 1];
    uint8_t *seen = (uint8_t *)sc_scratch_take_filled(scratch, hierarchy->triangle_count, 1, 0);
    if (!seen) return 0;
    stack[top++] = 0;
    while (top) {
        uint32_t n = stack[--top];
        const sc_tree_node *node = &hierarchy->nodes[n];
        if (node->left == SC_NONE) {
            if (node->first != at || node->count < 1 || node->count > SC_LEAF_MAX) return 0;
            at += node->count;
            leaves++;
        } else {
            if (node->left <= n || node->right <= n || node->left >= hierarchy->node_count ||
                node->right >= hierarchy->node_count || top + 2 > SC_DEPTH_MAX + 1)
                return 0;
            stack[top++] = node->right;
            stack[top++] = node->left;
        }
    }
    for (i = 0; i < hierarchy->triangle_count; i++) {
        if (hierarchy->order[i] >= hierarchy->triangle_count || seen[hierarchy->order[i]]) return 0;
        seen[hierarchy->order[i]] = 1;
    }
    sc_scratch_give(scratch, seen);
    return at == hierarchy->triangle_count && leaves == hierarchy->leaf_count;
}
