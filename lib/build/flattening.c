/*
 * Flattening a hierarchy. See flattening.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "build/flattening.h"

/* A level goes if the patches that are cut anew for it have one in so many leaves at most. On
   meshes of 25,000 to 900,000 triangles they have one in 26 or fewer, or more than a third, the
   bunny two thirds: then large patches fall to pieces, and queries at rest take 15 % longer. */
enum { DISTURBED_PART = 16 };

typedef struct flattening {
    const sc_tree_node *tree; /* as it was */
    const uint32_t *leaves;   /* of each of its nodes */
    /* nodes of it side by side, the first on top, that are to become patches; room for
       leaf_count */
    uint32_t *row, top;
    sc_hierarchy *hierarchy;
} flattening;

/* Leaves that a tree of so many levels can have. */
static uint32_t room_of(uint32_t levels)
{
    return levels > 32 ? UINT32_MAX : (uint32_t)(UINT64_C(1) << levels >> 1);
}

/* Leaves of each node, and how many levels to keep. */
static uint32_t choose_levels(const sc_hierarchy *hierarchy, uint32_t *leaves, uint8_t *levels)
{
    const sc_tree_node *tree = hierarchy->nodes;
    uint32_t disturbed[SC_DEPTH_MAX + 1] = {0}, n, kept;
    uint8_t *depth = levels; /* counted from 1; then with the levels of a balanced tree below */
    depth[0] = 1;
    for (n = 0; n < hierarchy->node_count; n++)
        if (tree[n].left != SC_NONE)
            depth[tree[n].left] = depth[tree[n].right] = (uint8_t)(depth[n] + 1);
    while (n-- > 0) {
        uint32_t left = tree[n].left, right = tree[n].right, below, needed;
        leaves[n] = left == SC_NONE ? 1 : leaves[left] + leaves[right];
        for (below = 1; room_of(below) < leaves[n]; below++) levels[n]++;
        if (left == SC_NONE) continue;
        needed = levels[left] > levels[right] ? levels[left] : levels[right];
        for (kept = levels[n]; kept < needed; kept++) disturbed[kept] += leaves[n];
    }
    for (kept = hierarchy->depth; kept > levels[0]; kept--)
        if (disturbed[kept - 1] > hierarchy->leaf_count / DISTURBED_PART) break;
    return kept;
}

/* Puts the children of one of the nodes on top into its place; place 0 is the top. */
static void open_node(flattening *f, uint32_t place)
{
    uint32_t at = f->top - 1 - place, i;
    const sc_tree_node *node = &f->tree[f->row[at]];
    for (i = f->top++; i > at + 1; i--) f->row[i] = f->row[i - 1];
    f->row[at + 1] = node->left;
    f->row[at] = node->right;
}

/*
 * Where to cut the *count nodes on top, which may become more: as near to half of the leaves as can
 * be. While a part has more than room, the node in the middle is opened; a single leaf in the
 * middle is none of too much.
 */
static uint32_t find_cut(flattening *f, uint32_t *count, uint32_t total, uint32_t room)
{
    for (;;) {
        uint32_t left = 0, middle = 0, size, cut, larger;
        for (;; left += size, middle++) {
            size = f->leaves[f->row[f->top - 1 - middle]];
            if (2 * ((uint64_t)left + size) >= total) break;
        }
        if (middle > 0 && (middle + 1 == *count || total - left <= left + size)) {
            cut = middle;
            larger = total - left;
        } else {
            cut = middle + 1;
            larger = left + size;
        }
        if (cut < *count && larger <= room) return cut;
        open_node(f, middle);
        ++*count;
    }
}

/* Makes one patch of the count nodes on top, which are taken from there, with levels of its own at
   most. */
static uint32_t make_patch(flattening *f, uint32_t count, uint32_t levels, uint32_t depth)
{
    const sc_tree_node *first = &f->tree[f->row[f->top - 1]];
    uint32_t triangles = 0, total = 0, i, node, cut, child;
    for (i = 0; i < count; i++) {
        triangles += f->tree[f->row[f->top - 1 - i]].count;
        total += f->leaves[f->row[f->top - 1 - i]];
    }
    node = sc_hierarchy_add(f->hierarchy, first->first, triangles, depth);
    if (total == 1) {
        f->top--;
        return node;
    }
    cut = find_cut(f, &count, total, room_of(levels - 1));
    child = make_patch(f, cut, levels - 1, depth + 1);
    f->hierarchy->nodes[node].left = child;
    child = make_patch(f, count - cut, levels - 1, depth + 1);
    f->hierarchy->nodes[node].right = child;
    return node;
}

sc_status sc_flattening_run(sc_scratch *scratch, sc_hierarchy *hierarchy)
{
    uint32_t nodes = hierarchy->node_count, levels, *leaves;
    uint8_t *own;
    flattening f;
    leaves = (uint32_t *)sc_scratch_take(scratch, nodes, sizeof *leaves);
    own = (uint8_t *)sc_scratch_take(scratch, nodes, sizeof *own);
    if (!leaves || !own) return SC_ERROR_MEMORY;
    levels = choose_levels(hierarchy, leaves, own);
    sc_scratch_give(scratch, own);
    if (levels < hierarchy->depth) {
        sc_tree_node *tree = hierarchy->nodes;
        f.row = (uint32_t *)sc_scratch_take(scratch, hierarchy->leaf_count, sizeof *f.row);
        hierarchy->nodes = (sc_tree_node *)sc_scratch_take(scratch, nodes, sizeof *tree);
        if (!f.row || !hierarchy->nodes) return SC_ERROR_MEMORY;
        f.tree = tree;
        f.leaves = leaves;
        f.hierarchy = hierarchy;
        f.row[0] = 0;
        f.top = 1;
        hierarchy->node_count = hierarchy->depth = 0;
        (void)make_patch(&f, 1, levels, 1);
        sc_scratch_give(scratch, f.row);
        sc_scratch_give(scratch, tree);
    }
    sc_scratch_give(scratch, leaves);
    return SC_OK;
}
