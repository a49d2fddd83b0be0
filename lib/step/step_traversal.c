/*
 * The ways to find the pairs of leaf clusters in a step. See step_traversal.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "step/step_traversal.h"

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

static void query_step_node(sc_step_state *state, uint32_t node)
{
    const uint32_t *child = sc_model_node_child(state->query.model);
    uint32_t c;
    state->query.stats.nodes_visited++;
    for (c = child[node]; c < child[node + 1] && !state->query.stop; c++) query_step_node(state, c);
    query_rest_of_step_node(state, node);
}

void sc_step_traversal_run(sc_step_state *state)
{
    sc_workspace *w = state->query.workspace;
    sc_leaf_step_reset(&w->motion);
    w->motion.swept = state->options.method == SC_STEP_METHOD_SWEPT;
    sc_state_switch(&state->query, SC_TASK_BOXES_ORIENTATION);
    if (state->options.method == SC_STEP_METHOD_SCTT) {
        query_step_node(state, 0);
    } else {
        refit_step(state);
        sc_step_kernels_of(w)->patch_itself(state, 0);
    }
    sc_step_candidates_decide(state);
}
