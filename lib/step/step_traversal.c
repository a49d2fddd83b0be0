/*
 * The ways to find the pairs of leaf clusters in a step. See step_traversal.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "step/step_traversal.h"

#include <string.h>

#include "pose/dnc.h"
#include "step/leaf_step.h"
#include "step/step_motion.h"
#include "step/step_candidates.h"
#include "step/step_kernels.h"

/* Makes boxes unless they are there. */
static void refit_step(sc_step_state *state)
{
    const sc_model *model = state->query.model;
    uint32_t previous;
    if (state->query.workspace->boxes_ready) return;
    previous = sc_state_switch(&state->query, SC_TASK_UPDATE_BOXES);
    sc_motion_refit(model, state->query.workspace);
    state->query.stats.counts[SC_TASK_UPDATE_BOXES] += model->patch_end;
    sc_state_switch(&state->query, previous);
}

/* What a node that is not culled leaves to boxes. */
static void query_rest_of_step_node(sc_step_state *state, uint32_t node)
{
    const sc_model *model = state->query.model;
    const sc_motion *motion = &state->query.workspace->motion;
    const sc_pair *patches = &sc_model_node_patches(model)[node];
    const sc_step_kernels *kernels = sc_step_kernels_of(state->query.workspace);
    const uint32_t *leaf = sc_model_leaf(model);
    uint32_t i, end = sc_model_node_boxes(model)[node + 1], previous;
    if (sc_state_stops(&state->query)) return;
    refit_step(state);
    previous = sc_state_switch(&state->query, sc_state_box_task(&state->query));
    for (i = sc_model_node_boxes(model)[node]; i < end && !state->query.stop; i++) {
        const sc_pair *pair = &sc_model_boxes(model)[i];
        state->query.stats.counts[sc_state_box_task(&state->query)]++;
        if (!sc_motion_boxes_apart(motion, pair->a, pair->b))
            kernels->patch_pair(state, pair->a, pair->b);
    }
    if (sc_model_node_child(model)[node] == sc_model_node_child(model)[node + 1] &&
        sc_model_is_leaf(model, patches->a) && sc_model_is_leaf(model, patches->b)) {
        if (patches->a == patches->b)
            kernels->leaf_itself(state, leaf[patches->a]);
        else
            kernels->leaf_pair(state, leaf[patches->a], leaf[patches->b]);
    }
    sc_state_switch(&state->query, previous);
}

/* Normal cones that hold throughout the step. */
static void update_cones(sc_step_state *state)
{
    const sc_model *model = state->query.model;
    const uint32_t *level_first = sc_model_level_first(model), *child = sc_model_child(model);
    const uint32_t *leaf_first = sc_model_leaf_first(model), *corner = sc_model_triangle(model);
    const sc_step_kernels *kernels = sc_step_kernels_of(state->query.workspace);
    uint16_t *mask = state->query.workspace->mask;
    uint32_t level, p, leaf, last = sc_model_first_leaf_patch(model);
    sc_state_switch(&state->query, SC_TASK_UPDATE_NORMALS);
    for (leaf = 0; leaf < model->leaf_count; leaf++)
        mask[last + leaf] = (uint16_t)kernels->cone(&state->query.workspace->motion,
                                                    corner + 3 * (uint64_t)leaf_first[leaf],
                                                    leaf_first[leaf + 1] - leaf_first[leaf]);
    for (level = model->level_count - 1; level-- > 0;)
        for (p = level_first[level]; p + 1 < level_first[level + 1]; p++)
            mask[p] = mask[child[p]] & mask[child[p + 1] - 1];
    state->query.stats.counts[SC_TASK_UPDATE_NORMALS] += model->patch_end;
}

/* What is collected is decided before it would count as following another kind of test, as in query/traversal.c. */
static void follow_moving_contour(sc_step_state *state, int after_contour)
{
    if (state->query.after_contour == after_contour) return;
    if (state->query.timed || state->query.options.budget) sc_step_candidates_decide(state);
    state->query.after_contour = after_contour;
}

/* Whether the contour test says that nothing in a node collides. */
static int is_clear(sc_step_state *state, uint32_t node, uint32_t mask)
{
    sc_projection projection;
    if (state->options.contour == SC_CONTOUR_NONE) return 1;
    sc_dnc_projection(state->query.workspace, mask, &projection);
    return sc_moving_contour_test(state, &projection, node);
}

/*
 * A node, and what is below it if it is not culled. Nodes of two patches come first, since a patch that is in one that is
 * culled is culled with it. failed: the node has a contour that failed.
 */
static void query_step_node(sc_step_state *state, uint32_t node, int failed)
{
    const sc_model *model = state->query.model;
    const uint32_t *child = sc_model_node_child(model);
    const sc_pair *patches = sc_model_node_patches(model);
    uint32_t a = patches[node].a, b = patches[node].b, c;
    uint8_t *culled = state->query.workspace->walk.culled;
    uint32_t mask = (uint32_t)state->query.workspace->mask[a] & state->query.workspace->mask[b];
    int is_self = a == b, selfs;
    if (is_self && culled[a]) return;
    state->query.stats.nodes_visited++;
    if (!failed) {
        state->query.stats.counts[SC_TASK_ORIENTATION]++;
        if (mask) {
            state->query.stats.nodes_oriented++;
            if (is_clear(state, node, mask)) {
                state->query.stats.nodes_culled++;
                culled[a] = culled[b] = 1;
                return;
            }
        }
    }
    for (selfs = 0; selfs < 2; selfs++)
        for (c = child[node]; c < child[node + 1] && !state->query.stop; c++)
            if ((patches[c].a == patches[c].b) == selfs)
                query_step_node(state, c, mask && is_self && !selfs);
    follow_moving_contour(state, mask != 0);
    query_rest_of_step_node(state, node);
}

void sc_step_traversal_run(sc_step_state *state)
{
    sc_workspace *w = state->query.workspace;
    sc_leaf_step_reset(&w->motion);
    w->motion.swept = state->options.method == SC_STEP_METHOD_SWEPT;
    if (state->options.method == SC_STEP_METHOD_SCTT) {
        update_cones(state);
        memset(w->walk.culled, 0, state->query.model->patch_end);
        sc_state_switch(&state->query, SC_TASK_ORIENTATION);
        query_step_node(state, 0, 0);
    } else {
        sc_state_switch(&state->query, SC_TASK_BOXES_ORIENTATION);
        refit_step(state);
        sc_step_kernels_of(w)->patch_itself(state, 0);
    }
    sc_step_candidates_decide(state);
}
