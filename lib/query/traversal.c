/*
 * The three ways to find the pairs of leaf clusters. See traversal.h.
 *
 * SPDX-License-Identifier: MIT
 *
 * Recursion is as deep as the hierarchy, SC_DEPTH_MAX at most, but for box recursion, which is a third
 * as deep.
 */
#include "query/traversal.h"

#include "base/hooks.h"
#include "pose/dnc.h"
#include "pose/refit.h"
#include "query/query_kernels.h"
#include "query/simple.h"
#include "query/star.h"

/* The leaf cluster of a patch that is one. */
static uint32_t leaf_of(const sc_model *model, uint32_t patch)
{
    return sc_model_leaf(model)[patch];
}

/* What a node that is not culled leaves to boxes and primitives: its BVTT children, and the triangles
   of leaf clusters. */
static void query_rest_of_node(sc_query_state *state, uint32_t node)
{
    const sc_model *model = state->model;
    const sc_boxes *boxes = &state->workspace->patch_boxes;
    const sc_pair *patches = &sc_model_node_patches(model)[node];
    const sc_query_kernels *kernels = sc_query_kernels_of(state->workspace);
    uint32_t i, end = sc_model_node_boxes(model)[node + 1], previous;
    if (sc_state_stops(state)) return;
    if (!state->workspace->boxes_ready) {
        previous = sc_state_switch(state, SC_TASK_UPDATE_BOXES);
        sc_refit_boxes(model, state->workspace);
        state->stats.counts[SC_TASK_UPDATE_BOXES] +=
            model->triangle_count + (uint64_t)model->patch_end;
        sc_state_switch(state, previous);
    }
    previous = sc_state_switch(state, sc_state_box_task(state));
    for (i = sc_model_node_boxes(model)[node]; i < end && !state->stop; i++) {
        const sc_pair *pair = &sc_model_boxes(model)[i];
        state->stats.counts[sc_state_box_task(state)]++;
        if (sc_boxes_overlap(boxes, pair->a, boxes, pair->b))
            kernels->patch_pair(state, pair->a, pair->b);
    }
    if (sc_model_node_child(model)[node] == sc_model_node_child(model)[node + 1] &&
        sc_model_is_leaf(model, patches->a) && sc_model_is_leaf(model, patches->b)) {
        if (patches->a == patches->b)
            kernels->leaf_itself(state, leaf_of(model, patches->a));
        else
            kernels->leaf_pair(state, leaf_of(model, patches->a), leaf_of(model, patches->b));
    }
    sc_state_switch(state, previous);
}

/* The paper's optimised tree of boxes: all nodes are taken as colliding. */
static void query_all_nodes(sc_query_state *state)
{
    uint32_t node;
    for (node = 0; node < state->model->node_count && !state->stop; node++) {
        state->stats.nodes_visited++;
        query_rest_of_node(state, node);
    }
}

/* Whether the box and primitive tests to come follow a failed contour test. What was collected before
   is decided first, if somebody reads the statistics; and with a budget, which is to end a query at the
   same place whether they are read or not. */
static void follow_contour(sc_query_state *state, int after_contour)
{
    if (state->after_contour == after_contour) return;
    if (state->timed || state->options.budget) sc_candidates_decide(state);
    state->after_contour = after_contour;
}

/* The paper's QueryContour: the projection is valid for all that is below. */
static void query_contour(sc_query_state *state, uint32_t node, const sc_projection *projection)
{
    const sc_model *model = state->model;
    const uint32_t *child = sc_model_node_child(model);
    uint32_t c;
    int cached = state->options.rest_cache == SC_REST_CACHE_ON &&
                 (sc_model_node_flags(model)[node] & SC_NODE_REST_CROSSED) != 0;
    state->stats.nodes_visited++;
    if (!cached && sc_star_test(state, projection, node)) {
        state->stats.nodes_culled++;
        return;
    }
    for (c = child[node]; c < child[node + 1] && !state->stop; c++)
        query_contour(state, c, projection);
    follow_contour(state, 1);
    query_rest_of_node(state, node);
}

/* The exact contour test keeps nothing from node to node, so that each node has its own projection. */
static void query_exact(sc_query_state *state, uint32_t node)
{
    const sc_model *model = state->model;
    const uint32_t *child = sc_model_node_child(model);
    const sc_pair *patches = &sc_model_node_patches(model)[node];
    uint32_t c;
    uint32_t mask =
        (uint32_t)state->workspace->mask[patches->a] & state->workspace->mask[patches->b];
    state->stats.counts[SC_TASK_ORIENTATION]++;
    state->stats.nodes_visited++;
    if (mask) {
        sc_projection projection;
        state->stats.nodes_oriented++;
        sc_dnc_projection(state->workspace, mask, &projection);
        if (sc_simple_test(state, &projection, node)) {
            state->stats.nodes_culled++;
            return;
        }
    }
    for (c = child[node]; c < child[node + 1] && !state->stop; c++) query_exact(state, c);
    follow_contour(state, mask != 0);
    query_rest_of_node(state, node);
}

/* The paper's QueryOrientation. */
static void query_orientation(sc_query_state *state, uint32_t node)
{
    const sc_model *model = state->model;
    const uint32_t *child = sc_model_node_child(model);
    const sc_pair *patches = &sc_model_node_patches(model)[node];
    uint32_t c, mask = 0;
    if (state->options.rest_cache == SC_REST_CACHE_OFF ||
        (sc_model_node_flags(model)[node] & SC_NODE_REST_TURNED) == 0) {
        state->stats.counts[SC_TASK_ORIENTATION]++;
        mask = (uint32_t)state->workspace->mask[patches->a] & state->workspace->mask[patches->b];
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
    for (c = child[node]; c < child[node + 1] && !state->stop; c++) query_orientation(state, c);
    follow_contour(state, 0);
    query_rest_of_node(state, node);
}

void sc_traversal_run(sc_query_state *state)
{
    const sc_model *model = state->model;
    if (state->options.method == SC_METHOD_SCTT) {
        sc_state_switch(state, SC_TASK_UPDATE_NORMALS);
        sc_dnc_update(model, state->workspace);
        SC_HOOKS_ASSERT(&state->workspace->hooks, sc_dnc_validate(model, state->workspace));
        state->stats.counts[SC_TASK_UPDATE_NORMALS] += model->patch_end;
        sc_state_switch(state, SC_TASK_ORIENTATION);
        if (state->options.contour == SC_CONTOUR_EXACT)
            query_exact(state, 0);
        else
            query_orientation(state, 0);
    } else if (state->options.method == SC_METHOD_AABB_SCTT) {
        sc_state_switch(state, SC_TASK_BOXES_ORIENTATION);
        query_all_nodes(state);
    } else {
        sc_refit_boxes(model, state->workspace);
        state->stats.counts[SC_TASK_UPDATE_BOXES] +=
            model->triangle_count + (uint64_t)model->patch_end;
        sc_state_switch(state, SC_TASK_BOXES_ORIENTATION);
        sc_query_kernels_of(state->workspace)->patch_itself(state, 0);
    }
    sc_candidates_decide(state);
}
