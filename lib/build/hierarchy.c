/*
 * The binary tree of patches. See hierarchy.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "build/hierarchy.h"

#include <string.h>

/* Places for the points of a run of triangles, four times as many as a leaf cluster has: a power of
   two, and the bits of that. */
enum { PLACE_BITS = 6, PLACES = 1 << PLACE_BITS };

sc_status sc_hierarchy_init(sc_hierarchy *hierarchy, const sc_points *points, sc_scratch *scratch)
{
    uint32_t triangle_count = points->triangle_count;
    hierarchy->triangle_count = triangle_count;
    hierarchy->node_count = hierarchy->leaf_count = hierarchy->depth = 0;
    hierarchy->order = (uint32_t *)sc_scratch_take(scratch, triangle_count, sizeof(uint32_t));
    hierarchy->nodes = (sc_tree_node *)sc_scratch_take(
        scratch, 2 * (uint64_t)triangle_count + SC_HIERARCHY_SPARE, sizeof(sc_tree_node));
    hierarchy->corner = points->triangles;
    /* five triangles always fit into a leaf */
    hierarchy->starts =
        (uint32_t *)sc_scratch_take(scratch, (uint64_t)triangle_count / 5 + 2, sizeof(uint32_t));
    return hierarchy->order && hierarchy->nodes && hierarchy->starts ? SC_OK : SC_ERROR_MEMORY;
}

sc_status sc_hierarchy_finish(sc_hierarchy *hierarchy, sc_scratch *scratch)
{
    sc_tree_node *nodes;
    sc_scratch_give(scratch, hierarchy->starts);
    hierarchy->starts = NULL;
    nodes = (sc_tree_node *)sc_scratch_take(scratch, hierarchy->node_count, sizeof *nodes);
    if (!nodes) return SC_ERROR_MEMORY;
    memcpy(nodes, hierarchy->nodes, hierarchy->node_count * sizeof *nodes);
    sc_scratch_give(scratch, hierarchy->nodes);
    hierarchy->nodes = nodes;
    return SC_OK;
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

/* Whether a point is not in the table yet, to which it is added: from the place that its number
   hashes to, the next that is free. */
static uint32_t is_new(uint32_t table[PLACES], uint32_t point)
{
    uint32_t at = (point * 0x9e3779b1u) >> (32 - PLACE_BITS);
    while (table[at] != SC_NONE && table[at] != point) at = (at + 1) % PLACES;
    if (table[at] == point) return 0;
    table[at] = point;
    return 1;
}

uint32_t sc_hierarchy_leaf_end(const sc_hierarchy *hierarchy, uint32_t first, uint32_t end)
{
    uint32_t table[PLACES], points = 0, k;
    memset(table, 0xff, sizeof table);
    if (end - first > SC_LEAF_MAX) end = first + SC_LEAF_MAX;
    for (; first < end; first++) {
        const uint32_t *corner = hierarchy->corner + 3 * (uint64_t)hierarchy->order[first];
        for (k = 0; k < 3; k++) points += is_new(table, corner[k]);
        if (points > SC_LEAF_POINTS) break;
    }
    return first;
}

/* A balanced subtree over count leaves, which start at start[0] to start[count - 1]; the last ends
   at start[count]. */
static uint32_t add_leaves(sc_hierarchy *hierarchy, const uint32_t *start, uint32_t count,
                           uint32_t depth)
{
    uint32_t node = sc_hierarchy_add(hierarchy, start[0], start[count] - start[0], depth);
    if (count == 1) {
        hierarchy->leaf_count++;
    } else {
        uint32_t left = (count + 1) / 2, child;
        child = add_leaves(hierarchy, start, left, depth + 1);
        hierarchy->nodes[node].left = child;
        child = add_leaves(hierarchy, start + left, count - left, depth + 1);
        hierarchy->nodes[node].right = child;
    }
    return node;
}

uint32_t sc_hierarchy_add_leaves(sc_hierarchy *hierarchy, uint32_t count, uint32_t depth)
{
    return add_leaves(hierarchy, hierarchy->starts, count, depth);
}

sc_status sc_hierarchy_cut_order(sc_hierarchy *hierarchy, uint32_t point_count, sc_scratch *scratch)
{
    const uint32_t count = hierarchy->triangle_count;
    uint32_t leaves = 0, at = 0, end, points, k;
    uint32_t *last = (uint32_t *)sc_scratch_take_filled(scratch, point_count, sizeof *last, 0xff);
    if (!last) return SC_ERROR_MEMORY;
    for (; at < count; leaves++) {
        hierarchy->starts[leaves] = at;
        end = count - at > SC_LEAF_MAX ? at + SC_LEAF_MAX : count;
        for (points = 0; at < end; at++) {
            const uint32_t *corner = hierarchy->corner + 3 * (uint64_t)hierarchy->order[at];
            for (k = 0; k < 3; k++) {
                points += last[corner[k]] != leaves;
                last[corner[k]] = leaves;
            }
            if (points > SC_LEAF_POINTS) break;
        }
    }
    hierarchy->starts[leaves] = at;
    (void)sc_hierarchy_add_leaves(hierarchy, leaves, 1);
    sc_scratch_give(scratch, last);
    return SC_OK;
}

uint32_t sc_hierarchy_add_balanced(sc_hierarchy *hierarchy, uint32_t first, uint32_t count,
                                   uint32_t depth)
{
    uint32_t leaves = 0, at, end = first + count;
    for (at = first; at < end; at = sc_hierarchy_leaf_end(hierarchy, at, end))
        hierarchy->starts[leaves++] = at;
    hierarchy->starts[leaves] = end;
    return sc_hierarchy_add_leaves(hierarchy, leaves, depth);
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
            if (node->first != at || node->count < 1 || node->count > SC_LEAF_MAX ||
                node->count > hierarchy->triangle_count - at)
                return 0;
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
    for (i = 0; i < hierarchy->node_count; i++) {
        const sc_tree_node *node = &hierarchy->nodes[i];
        if (node->left == SC_NONE &&
            sc_hierarchy_leaf_end(hierarchy, node->first, node->first + node->count) !=
                node->first + node->count)
            return 0;
    }
    sc_scratch_give(scratch, seen);
    return at == hierarchy->triangle_count && leaves == hierarchy->leaf_count;
}
