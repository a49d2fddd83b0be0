/*
 * Where the hierarchy of patches comes from. See partition.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "build/partition.h"

#include <inttypes.h>
#include <string.h>

#include "base/arguments.h"
#include "build/bisection.h"
#include "build/flattening.h"

/* Nodes from the root to a leaf of a caller's tree at most; splitting large leaves adds up to
   29. */
enum { CALLER_DEPTH_MAX = 60 };

static sc_status check_order(const sc_hooks *hooks, const uint32_t *order, uint32_t count,
                             sc_scratch *scratch)
{
    uint8_t *seen;
    uint32_t i;
    sc_status status = sc_arguments_need(hooks, "options", "order", order);
    if (status) return status;
    seen = (uint8_t *)sc_scratch_take_filled(scratch, count, 1, 0);
    if (!seen) return SC_ERROR_MEMORY;
    for (i = 0; i < count; i++) {
        if (order[i] >= count || seen[order[i]]) {
            sc_hooks_log(hooks, SC_LOG_ERROR, "options.order[%" PRIu32 "] is %" PRIu32 ", which %s",
                         i, order[i], order[i] >= count ? "is no triangle" : "came before");
            return SC_ERROR_TREE;
        }
        seen[order[i]] = 1;
    }
    sc_scratch_give(scratch, seen);
    return SC_OK;
}

typedef struct caller_tree {
    const sc_build_options *options;
    sc_hierarchy *hierarchy;
    uint8_t *node_seen, *place_seen; /* tree_count; triangle_count places of order */
    uint32_t taken;                  /* triangles put into the hierarchy's order */
} caller_tree;

/* What is wrong with a node by itself, or NULL. */
static const char *check_node(const caller_tree *tree, uint32_t at, uint32_t depth)
{
    const uint32_t triangles = tree->hierarchy->triangle_count;
    const sc_tree_node *given;
    uint32_t i;
    if (at >= tree->options->tree_count) return "does not exist";
    if (tree->node_seen[at]) return "has two parents, or is the root";
    if (depth > CALLER_DEPTH_MAX) return "is too deep";
    given = &tree->options->tree[at];
    if (given->left != SC_NONE || given->right != SC_NONE) return NULL;
    if (given->count < 1 || given->count > triangles || given->first > triangles - given->count)
        return "is a leaf of entries of options.order that do not exist";
    for (i = 0; i < given->count; i++)
        if (tree->place_seen[given->first + i])
            return "is a leaf of entries of options.order that another leaf has";
    return NULL;
}

static sc_status copy_node(caller_tree *tree, uint32_t at, uint32_t depth, uint32_t *node)
{
    const sc_build_options *options = tree->options;
    sc_hierarchy *hierarchy = tree->hierarchy;
    const sc_tree_node *given;
    const char *wrong = check_node(tree, at, depth);
    uint32_t i, child, first = tree->taken;
    sc_status status;
    if (wrong) {
        sc_hooks_log(options->hooks, SC_LOG_ERROR, "options.tree: node %" PRIu32 " %s", at, wrong);
        return SC_ERROR_TREE;
    }
    tree->node_seen[at] = 1;
    given = &options->tree[at];
    if (given->left == SC_NONE && given->right == SC_NONE) {
        for (i = 0; i < given->count; i++) {
            tree->place_seen[given->first + i] = 1;
            hierarchy->order[tree->taken++] = options->order[given->first + i];
        }
        *node = sc_hierarchy_add_balanced(hierarchy, first, given->count, depth);
        return SC_OK;
    }
    *node = sc_hierarchy_add(hierarchy, first, 0, depth);
    status = copy_node(tree, given->left, depth + 1, &child);
    if (status) return status;
    hierarchy->nodes[*node].left = child;
    status = copy_node(tree, given->right, depth + 1, &child);
    if (status) return status;
    hierarchy->nodes[*node].right = child;
    hierarchy->nodes[*node].count = tree->taken - first;
    return SC_OK;
}

static sc_status copy_tree(const sc_build_options *options, sc_scratch *scratch,
                           sc_hierarchy *hierarchy)
{
    caller_tree tree;
    uint32_t root;
    sc_status status;
    status = sc_arguments_need(options->hooks, "options", "tree", options->tree);
    if (status) return status;
    if (!options->tree_count) {
        sc_hooks_log(options->hooks, SC_LOG_ERROR, "options.tree_count is 0");
        return SC_ERROR_TREE;
    }
    tree.options = options;
    tree.hierarchy = hierarchy;
    tree.taken = 0;
    tree.node_seen = (uint8_t *)sc_scratch_take_filled(scratch, options->tree_count, 1, 0);
    tree.place_seen = (uint8_t *)sc_scratch_take_filled(scratch, hierarchy->triangle_count, 1, 0);
    if (!tree.node_seen || !tree.place_seen) return SC_ERROR_MEMORY;
    status = copy_node(&tree, 0, 1, &root);
    if (!status && tree.taken != hierarchy->triangle_count) {
        sc_hooks_log(options->hooks, SC_LOG_ERROR,
                     "options.tree: its leaves have %" PRIu32 " of %" PRIu32 " triangles",
                     tree.taken, hierarchy->triangle_count);
        status = SC_ERROR_TREE;
    }
    sc_scratch_give(scratch, tree.place_seen);
    sc_scratch_give(scratch, tree.node_seen);
    return status;
}

/* As build/locality.h left the triangles, but one component after the other: where several lie
   close together, the curve goes from each to the others all the time. */
static sc_status follow_curve(const sc_points *points, const sc_adjacency *adjacency,
                              sc_scratch *scratch, uint32_t *order)
{
    uint32_t count = points->triangle_count, *lowest, *first, t, p;
    for (t = 0; t < count; t++) order[t] = t;
    if (adjacency->component_count == 1) return SC_OK;
    lowest = (uint32_t *)sc_scratch_take(scratch, points->point_count, sizeof *lowest);
    first = (uint32_t *)sc_scratch_take_filled(scratch, (uint64_t)points->point_count + 1,
                                               sizeof *first, 0);
    if (!lowest || !first) return SC_ERROR_MEMORY;
    sc_adjacency_find_components(points, lowest);
    for (t = 0; t < count; t++) first[lowest[points->triangles[3 * (uint64_t)t]] + 1]++;
    for (p = 0; p < points->point_count; p++) first[p + 1] += first[p];
    for (t = 0; t < count; t++) order[first[lowest[points->triangles[3 * (uint64_t)t]]]++] = t;
    sc_scratch_give(scratch, first);
    sc_scratch_give(scratch, lowest);
    return SC_OK;
}

static sc_status make_hierarchy(const sc_points *points, const sc_adjacency *adjacency,
                                const sc_build_options *options, sc_scratch *scratch,
                                sc_hierarchy *hierarchy)
{
    uint32_t count = points->triangle_count;
    sc_status status;
    if (options->partition == SC_PARTITION_FAST && options->content == SC_MODEL_FULL)
        return sc_bisection_build(points, adjacency, NULL, NULL, scratch, hierarchy);
    if (options->partition == SC_PARTITION_BISECT) {
        if (!options->bisect) {
            sc_hooks_log(options->hooks, SC_LOG_ERROR, "options.bisect is NULL");
            return SC_ERROR_NULL;
        }
        return sc_bisection_build(points, adjacency, options->bisect, options->bisect_user, scratch,
                                  hierarchy);
    }
    if (options->partition != SC_PARTITION_FAST) {
        status = check_order(options->hooks, options->order, count, scratch);
        if (status) return status;
    }
    status = sc_hierarchy_init(hierarchy, points, scratch);
    if (status) return status;
    if (options->partition == SC_PARTITION_TREE) return copy_tree(options, scratch, hierarchy);
    if (options->partition == SC_PARTITION_FAST) {
        status = follow_curve(points, adjacency, scratch, hierarchy->order);
        if (status) return status;
    } else {
        memcpy(hierarchy->order, options->order, count * sizeof *hierarchy->order);
    }
    return sc_hierarchy_cut_order(hierarchy, points->point_count, scratch);
}

sc_status sc_partition_build(const sc_points *points, const sc_adjacency *adjacency,
                             const sc_build_options *options, sc_scratch *scratch,
                             sc_hierarchy *hierarchy)
{
    sc_status status = make_hierarchy(points, adjacency, options, scratch, hierarchy);
    if (!status) status = sc_hierarchy_finish(hierarchy, scratch);
    if (!status && options->partition != SC_PARTITION_TREE)
        status = sc_flattening_run(scratch, hierarchy);
    return status;
}
