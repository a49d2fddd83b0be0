/*
 * The three ways to find the pairs of leaf clusters. See traversal.h.
 *
 * SPDX-License-Identifier: MIT
 *
 * Recursion is as deep as the hierarchy, SC_DEPTH_MAX at most, but for box recursion, which is a
 * quarter as deep.
 */
#include "query/traversal.h"

#include <string.h>

#include "base/bits.h"
#include "base/hooks.h"
#include "pose/dnc.h"
#include "pose/refit.h"
#include "query/query_kernels.h"
#include "query/simple.h"
#include "query/star.h"

void sc_traversal_update_boxes(sc_query_state *state)
{
    const sc_model *model = state->model;
    uint32_t previous;
    if (state->workspace->boxes_ready) return;
    previous = sc_state_switch(state, SC_TASK_UPDATE_BOXES);
    sc_refit_boxes(model, state->workspace);
    state->stats.counts[SC_TASK_UPDATE_BOXES] += model->triangle_count + (uint64_t)model->patch_end;
    sc_state_switch(state, previous);
}

void sc_traversal_update_normals(sc_query_state *state)
{
    sc_state_switch(state, SC_TASK_UPDATE_NORMALS);
    sc_dnc_update(state->model, state->workspace);
    SC_HOOKS_ASSERT(&state->workspace->hooks, sc_dnc_validate(state->model, state->workspace));
    state->stats.counts[SC_TASK_UPDATE_NORMALS] += state->model->patch_end;
    sc_state_switch(state, SC_TASK_ORIENTATION);
}

/* What a node that is not culled leaves to boxes and primitives: its BVTT children, and the
   triangles of leaf clusters. */
static void query_rest_of_node(sc_query_state *state, uint32_t node)
{
    const sc_model *model = state->model;
    const sc_boxes *boxes = &state->workspace->patch_boxes;
    const sc_node *n = sc_model_node(model) + node;
    const sc_query_kernels *kernels = state->workspace->kernels->query;
    uint32_t bits, previous;
    if (sc_state_stops(state)) return;
    sc_traversal_update_boxes(state);
    previous = sc_state_switch(state, sc_state_box_task(state));
    for (bits = sc_node_boxes(n); bits && !state->stop; bits &= bits - 1) {
        const sc_pair pair = sc_model_pair(model, n, sc_bits_lowest(bits));
        state->stats.counts[sc_state_box_task(state)]++;
        if (sc_boxes_overlap(boxes, pair.a, boxes, pair.b)) {
            const sc_pair turned = {pair.b, pair.a};
            kernels->patch_pairs(state, &turned, 1);
        }
    }
    if (sc_node_is_leaf(n)) {
        const uint32_t *leaf = sc_model_leaf(model);
        if (n->patches.a == n->patches.b)
            kernels->leaf_itself(state, leaf[n->patches.a]);
        else
            kernels->leaf_pair(state, leaf[n->patches.a], leaf[n->patches.b]);
    }
    sc_state_switch(state, previous);
}

/* The paper's optimised tree of boxes: all nodes are taken as colliding. */
void sc_traversal_take_nodes(sc_query_state *state, uint32_t node, uint32_t end)
{
    for (; node < end && !state->stop; node++) {
        state->stats.nodes_visited++;
        query_rest_of_node(state, node);
    }
}

/* What was collected before is decided first, if somebody reads the statistics; and with a budget,
   which is to end a query at the same place whether they are read or not. */
void sc_traversal_follow_contour(sc_query_state *state, int after_contour)
{
    if (state->after_contour == after_contour) return;
    if (state->timed || state->options.budget) sc_candidates_decide(state);
    state->after_contour = after_contour;
}

/* The paper's QueryContour: the projection is valid for all that is below. */
static void query_contour(sc_query_state *state, uint32_t node, const sc_projection *projection)
{
    const sc_node *n = sc_model_node(state->model) + node;
    const uint32_t end = sc_node_end(n);
    uint32_t c;
    int cached =
        state->options.rest_cache == SC_REST_CACHE_ON && (n->kind & SC_NODE_REST_CROSSED) != 0;
    state->stats.nodes_visited++;
    if (!cached && sc_star_test(state, projection, node)) {
        state->stats.nodes_culled++;
        return;
    }
    for (c = n->child; c < end && !state->stop; c++) query_contour(state, c, projection);
    sc_traversal_follow_contour(state, 1);
    query_rest_of_node(state, node);
}

/*
 * The walk with the exact contour test. The test keeps nothing from node to node, so that each node
 * has its own projection, and nodes can be tested in any order: those that pass the orientation
 * test wait in a short queue, so that the memory for some is fetched while others are tested. Nodes
 * of one patch wait until all else is done, since a patch that is in a node of two that was culled
 * is culled with it; and so do leaf clusters that are to be looked at by themselves, for which the
 * same is true of two that share points and are dropped. A node of two patches with one parent has
 * the contour of that parent, which failed. Pairs of patches that are left to boxes wait as well:
 * tests of boxes that do not depend on each other wait for memory at the same time. Two patches
 * that share one point, as diagonally in a grid, are left to boxes, too: few overlap there, and a
 * contour costs most that passes a point twice.
 */

/*
 * Where little can be culled, the test tree is a waste: its nodes are many, and boxes are faster by
 * themselves. A patch of more than PROSPECT_MIN leaf clusters that passes the orientation test has
 * a prospect; for fewer, a contour test and the nodes on the way to it cost as much as the pairs of
 * leaf clusters that are saved. The prospect of another patch is the number of seams between leaf
 * clusters in such patches below it, m - 1 for one of m, which must be one for PROSPECT_PART leaf
 * clusters. A node that fails the orientation test is left to boxes unless both its patches have a
 * prospect. (Tuned on single frames of scenes from smooth to crumpled.)
 */
enum { PROSPECT_MIN = 2, PROSPECT_PART = 8 };

static uint32_t leaves_of(const sc_model *model, uint32_t patch)
{
    return sc_model_leaf(model)[patch + 1] - sc_model_leaf(model)[patch];
}

/* The prospect of a patch. It is written down for those of more than PROSPECT_MIN leaf clusters
   without a cone, above which all are such. */
static uint32_t find_prospect(const sc_query_state *state, uint32_t patch)
{
    const uint32_t *child = sc_model_child(state->model) + patch;
    uint32_t leaves = leaves_of(state->model, patch), sum, c;
    if (leaves <= PROSPECT_MIN) return 0;
    if (state->workspace->mask[patch]) return leaves - 1;
    for (sum = 0, c = child[0]; c < child[1]; c++) sum += find_prospect(state, c);
    return state->workspace->prospect[patch] = sum;
}

void sc_traversal_find_prospects(const sc_query_state *state)
{
    find_prospect(state, 0);
}

static int has_prospect(const sc_query_state *state, uint32_t patch)
{
    uint32_t leaves = leaves_of(state->model, patch);
    if (leaves <= PROSPECT_MIN) return 0;
    return state->workspace->mask[patch] ||
           PROSPECT_PART * (uint64_t)state->workspace->prospect[patch] >= leaves;
}

/* Whether a node that failed the orientation test is left to boxes, all of it. */
static int is_left(const sc_query_state *state, const sc_node *node)
{
    return !has_prospect(state, node->patches.a) || !has_prospect(state, node->patches.b);
}

/* Two patches, as sc_query_kernels.patch_pairs has them, or one twice, are left to boxes, after a
   contour test or not. */
static void leave_to_boxes(sc_query_state *state, uint32_t a, uint32_t b, int after_contour)
{
    sc_walk *walk = &state->workspace->walk;
    sc_pair *pair;
    if (walk->pair_count[after_contour] == SC_WALK_PAIRS) sc_traversal_take_boxes(state);
    pair = &walk->pairs[after_contour][walk->pair_count[after_contour]++];
    pair->a = a;
    pair->b = b;
    sc_fetch(sc_model_hop(state->model) + a);
    sc_fetch((a == b ? sc_model_leaf(state->model) : sc_model_hop(state->model)) + b);
}

void sc_traversal_take_boxes(sc_query_state *state)
{
    sc_walk *walk = &state->workspace->walk;
    const sc_query_kernels *kernels = state->workspace->kernels->query;
    const sc_boxes *boxes = &state->workspace->patch_boxes;
    int after_contour;
    for (after_contour = 0; after_contour < 2; after_contour++) {
        sc_pair *pairs = walk->pairs[after_contour];
        uint32_t i, count = 0, end = walk->pair_count[after_contour], previous;
        walk->pair_count[after_contour] = 0;
        if (!end || sc_state_stops(state)) continue;
        sc_traversal_follow_contour(state, after_contour);
        sc_traversal_update_boxes(state);
        previous = sc_state_switch(state, sc_state_box_task(state));
        state->stats.counts[sc_state_box_task(state)] += end;
        for (i = 0; i < end; i++) {
            pairs[count] = pairs[i];
            count += (uint32_t)sc_boxes_overlap(boxes, pairs[i].a, boxes, pairs[i].b);
        }
        kernels->patch_pairs(state, pairs, count);
        sc_state_switch(state, previous);
    }
}

/* A node that failed a test, or has a contour that did, mask being what its patches' cones have in
   common. */
static void put_back(sc_query_state *state, uint32_t node, uint32_t mask)
{
    const sc_node *n = sc_model_node(state->model) + node;
    sc_walk *walk = &state->workspace->walk;
    if (!mask && is_left(state, n)) {
        leave_to_boxes(state, n->patches.a, n->patches.b, 0);
        return;
    }
    walk->stack[walk->stack_count++] = node;
    sc_fetch(sc_model_node(state->model) + n->child);
    sc_fetch(sc_model_node(state->model) + n->child + 2);
}

void sc_traversal_orient(sc_query_state *state, uint32_t node)
{
    const sc_node *n = sc_model_node(state->model) + node;
    sc_workspace *w = state->workspace;
    uint32_t mask = (uint32_t)w->mask[n->patches.a] & w->mask[n->patches.b];
    state->stats.nodes_visited++;
    if (n->kind & SC_NODE_TOUCHES) {
        leave_to_boxes(state, n->patches.a, n->patches.b, 0);
        return;
    }
    state->stats.counts[SC_TASK_ORIENTATION]++;
    if (!mask) {
        put_back(state, node, mask);
        return;
    }
    state->stats.nodes_oriented++;
    if (n->patches.a == n->patches.b && w->walk.selfs_wait)
        w->walk.self[w->walk.self_count++] = node;
    else
        w->walk.queue[w->walk.queue_count++] = node;
}

void sc_traversal_test(sc_query_state *state, const uint32_t *nodes, uint32_t count,
                       uint8_t *passed)
{
    uint32_t i;
    sc_simple_tests(state, nodes, count, passed);
    for (i = 0; i < count; i++) state->stats.nodes_culled += passed[i];
}

/* The contour tests of all nodes in the queue. */
static void test_queue(sc_query_state *state)
{
    sc_walk *walk = &state->workspace->walk;
    uint8_t passed[SC_WALK_QUEUE + SC_WALK_CHILDREN];
    uint32_t i;
    if (!walk->queue_count) return;
    sc_traversal_test(state, walk->queue, walk->queue_count, passed);
    for (i = 0; i < walk->queue_count; i++) {
        const sc_pair *patches = &sc_model_node(state->model)[walk->queue[i]].patches;
        if (passed[i])
            walk->marks[patches->a] = walk->marks[patches->b] = 1;
        else
            put_back(state, walk->queue[i], 1);
    }
    walk->queue_count = 0;
}

/* What a node that is not culled leaves to boxes: its BVTT children, and leaf clusters. */
static void leave_rest_of_node(sc_query_state *state, const sc_node *node)
{
    const sc_model *model = state->model;
    const uint16_t *mask = state->workspace->mask;
    const int after_contour = (mask[node->patches.a] & mask[node->patches.b]) != 0;
    uint32_t bits;
    for (bits = sc_node_boxes(node); bits; bits &= bits - 1) {
        const sc_pair pair = sc_model_pair(model, node, sc_bits_lowest(bits));
        leave_to_boxes(state, pair.b, pair.a, after_contour);
    }
    if (sc_node_is_leaf(node)) {
        const uint32_t *leaf = sc_model_leaf(model), first = sc_model_first_leaf_patch(model);
        leave_to_boxes(state, first + leaf[node->patches.a], first + leaf[node->patches.b],
                       after_contour);
    }
}

void sc_traversal_open(sc_query_state *state, uint32_t node)
{
    const sc_node *nodes = sc_model_node(state->model), *n = nodes + node;
    const uint32_t end = sc_node_end(n);
    sc_workspace *w = state->workspace;
    uint32_t c;
    for (c = n->child; c < end; c++) {
        const sc_pair patches = nodes[c].patches;
        int is_self = patches.a == patches.b;
        if (is_self != (n->patches.a == n->patches.b)) {
            state->stats.nodes_visited++;
            put_back(state, c, (uint32_t)w->mask[patches.a] & w->mask[patches.b]);
        } else if (!is_self || w->walk.selfs_wait || !w->walk.culled[patches.a]) {
            sc_traversal_orient(state, c);
        }
    }
    leave_rest_of_node(state, n);
}

void sc_traversal_walk(sc_query_state *state)
{
    sc_walk *walk = &state->workspace->walk;
    while ((walk->queue_count || walk->stack_count) && !state->stop) {
        test_queue(state);
        while (walk->stack_count && walk->queue_count < SC_WALK_QUEUE && !state->stop)
            sc_traversal_open(state, walk->stack[--walk->stack_count]);
    }
    sc_traversal_take_boxes(state);
}

void sc_traversal_take_alone(sc_query_state *state, const uint32_t *alone, uint32_t count)
{
    const sc_query_kernels *kernels = state->workspace->kernels->query;
    const uint32_t most = sc_state_may_end_early(state) ? 16 : SC_LEAF_QUEUE - SC_LEAF_MAX - 1;
    sc_workspace *w = state->workspace;
    const uint8_t *culled = w->walk.culled + sc_model_first_leaf_patch(state->model);
    uint32_t after_contour, previous, i;
    for (after_contour = 0; after_contour < 2; after_contour++) {
        sc_traversal_follow_contour(state, (int)after_contour);
        previous = sc_state_switch(state, sc_state_box_task(state));
        for (i = 0; i < count && !sc_state_stops(state); i++) {
            if ((alone[i] & 1) != after_contour || culled[alone[i] / 2]) continue;
            w->near_list[0][w->near_count] = alone[i] / 2;
            w->near_list[1][w->near_count] = SC_NONE;
            if (++w->near_count > most) kernels->leaf_pairs(state);
        }
        sc_state_switch(state, previous);
    }
}

static void query_exact(sc_query_state *state)
{
    const sc_node *node = sc_model_node(state->model);
    sc_walk *walk = &state->workspace->walk;
    uint32_t i;
    walk->stack_count = walk->queue_count = walk->self_count = walk->alone_count = 0;
    walk->pair_count[0] = walk->pair_count[1] = 0;
    walk->selfs_wait = 1;
    sc_traversal_find_prospects(state);
    sc_traversal_orient(state, 0);
    sc_traversal_walk(state);
    walk->selfs_wait = 0;
    for (i = 0; i < walk->self_count && !state->stop; i++) {
        if (walk->culled[node[walk->self[i]].patches.a]) continue;
        walk->queue[walk->queue_count++] = walk->self[i];
        if (walk->queue_count == SC_WALK_QUEUE) sc_traversal_walk(state);
    }
    sc_traversal_walk(state);
    sc_candidates_decide(state); /* marks more that are culled */
    sc_traversal_take_alone(state, walk->alone, walk->alone_count);
}

/* The paper's QueryOrientation. */
static void query_orientation(sc_query_state *state, uint32_t node)
{
    const sc_model *model = state->model;
    const sc_node *n = sc_model_node(model) + node;
    const uint16_t *masks = state->workspace->mask;
    const uint32_t end = sc_node_end(n);
    uint32_t c, mask = 0;
    if (state->options.rest_cache == SC_REST_CACHE_OFF || (n->kind & SC_NODE_REST_TURNED) == 0) {
        state->stats.counts[SC_TASK_ORIENTATION]++;
        mask = (uint32_t)masks[n->patches.a] & masks[n->patches.b];
    }
    if (mask) {
        sc_projection projection;
        state->stats.nodes_oriented++;
        if (state->options.contour == SC_CONTOUR_NONE) {
            state->stats.nodes_visited++;
            return;
        }
        sc_dnc_projection(state->workspace, mask, &projection);
        sc_workspace_new_projection(model, state->workspace);
        query_contour(state, node, &projection);
        return;
    }
    state->stats.nodes_visited++;
    for (c = n->child; c < end && !state->stop; c++) query_orientation(state, c);
    sc_traversal_follow_contour(state, 0);
    query_rest_of_node(state, node);
}

void sc_traversal_run(sc_query_state *state)
{
    memset(state->workspace->walk.marks, 0, state->model->patch_end);
    if (state->options.method == SC_METHOD_SCTT) {
        sc_traversal_update_normals(state);
        if (state->options.contour == SC_CONTOUR_EXACT)
            query_exact(state);
        else
            query_orientation(state, 0);
    } else if (state->options.method == SC_METHOD_AABB_SCTT) {
        sc_state_switch(state, SC_TASK_BOXES_ORIENTATION);
        sc_traversal_take_nodes(state, 0, state->model->node_count);
    } else {
        const sc_pair whole = {0, 0};
        sc_traversal_update_boxes(state);
        sc_state_switch(state, SC_TASK_BOXES_ORIENTATION);
        state->workspace->kernels->query->patch_pairs(state, &whole, 1);
    }
    sc_candidates_decide(state);
}
