/*
 * The ways to find the pairs of leaf clusters in a step. See step_traversal.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "step/step_traversal.h"

#include <string.h>

#include "base/bits.h"
#include "pose/dnc.h"
#include "step/step_motion.h"
#include "step/step_candidates.h"
#include "step/step_kernels.h"

void sc_step_traversal_refit(sc_step_state *state)
{
    const sc_model *model = state->query.model;
    uint32_t previous;
    if (state->query.workspace->boxes_ready) return;
    previous = sc_state_switch(&state->query, SC_TASK_UPDATE_BOXES);
    sc_motion_refit(model, state->query.workspace);
    state->query.stats.counts[SC_TASK_UPDATE_BOXES] += model->patch_end;
    sc_state_switch(&state->query, previous);
}

void sc_step_traversal_update_cones(sc_step_state *state)
{
    sc_state_switch(&state->query, SC_TASK_UPDATE_NORMALS);
    sc_motion_update_cones(state->query.model, state->query.workspace);
    state->query.stats.counts[SC_TASK_UPDATE_NORMALS] += state->query.model->patch_end;
    sc_state_switch(&state->query, SC_TASK_ORIENTATION);
}

/* What is collected is decided before it would count as following another kind of test, as in
   query/traversal.c. */
void sc_step_traversal_follow_contour(sc_step_state *state, int after_contour)
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

uint32_t sc_step_traversal_mask(const sc_step_state *state, uint32_t node)
{
    const sc_pair *patches = &sc_model_node(state->query.model)[node].patches;
    const uint16_t *mask = state->query.workspace->mask;
    return (uint32_t)mask[patches->a] & mask[patches->b];
}

int sc_step_traversal_culls(sc_step_state *state, uint32_t node, int failed)
{
    uint32_t mask = sc_step_traversal_mask(state, node);
    state->query.stats.nodes_visited++;
    if (failed) return 0;
    state->query.stats.counts[SC_TASK_ORIENTATION]++;
    if (!mask) return 0;
    state->query.stats.nodes_oriented++;
    if (!is_clear(state, node, mask)) return 0;
    state->query.stats.nodes_culled++;
    return 1;
}

void sc_step_traversal_query_rest(sc_step_state *state, uint32_t node)
{
    const sc_model *model = state->query.model;
    const sc_motion *motion = &state->query.workspace->motion;
    const sc_node *n = sc_model_node(model) + node;
    const sc_step_kernels *kernels = state->query.workspace->kernels->step;
    uint32_t bits, previous;
    if (sc_state_stops(&state->query)) return;
    sc_step_traversal_follow_contour(state, sc_step_traversal_mask(state, node) != 0);
    sc_step_traversal_refit(state);
    previous = sc_state_switch(&state->query, sc_state_box_task(&state->query));
    for (bits = sc_node_boxes(n); bits && !state->query.stop; bits &= bits - 1) {
        const sc_pair pair = sc_model_pair(model, n, sc_bits_lowest(bits));
        state->query.stats.counts[sc_state_box_task(&state->query)]++;
        if (!sc_motion_boxes_apart(motion, pair.a, pair.b))
            kernels->patch_pair(state, pair.a, pair.b);
    }
    if (sc_node_is_leaf(n)) {
        const uint32_t *leaf = sc_model_leaf(model);
        if (n->patches.a == n->patches.b)
            kernels->leaf_itself(state, leaf[n->patches.a]);
        else
            kernels->leaf_pair(state, leaf[n->patches.a], leaf[n->patches.b]);
    }
    sc_state_switch(&state->query, previous);
}

/*
 * A node, and what is below it if it is not culled. Nodes of two patches come first, since a patch
 * that is in one that is culled is culled with it. failed: the node has a contour that failed.
 */
static void query_step_node(sc_step_state *state, uint32_t node, int failed)
{
    const sc_node *nodes = sc_model_node(state->query.model), *n = nodes + node;
    uint32_t a = n->patches.a, b = n->patches.b, end = sc_node_end(n), c;
    uint8_t *culled = state->query.workspace->walk.culled;
    int is_self = a == b, selfs;
    if (is_self && culled[a]) return;
    if (sc_step_traversal_culls(state, node, failed)) {
        culled[a] = culled[b] = 1;
        return;
    }
    failed = is_self && sc_step_traversal_mask(state, node);
    for (selfs = 0; selfs < 2; selfs++)
        for (c = n->child; c < end && !state->query.stop; c++)
            if ((nodes[c].patches.a == nodes[c].patches.b) == selfs)
                query_step_node(state, c, failed && !selfs);
    sc_step_traversal_query_rest(state, node);
}

void sc_step_traversal_run(sc_step_state *state)
{
    sc_workspace *w = state->query.workspace;
    sc_workspace_keep_motions(state->query.model, w, 1);
    w->motion.swept = state->options.method == SC_STEP_METHOD_SWEPT;
    if (state->options.method == SC_STEP_METHOD_SCTT) {
        sc_step_traversal_update_cones(state);
        memset(w->walk.culled, 0, state->query.model->patch_end);
        query_step_node(state, 0, 0);
    } else {
        sc_state_switch(&state->query, SC_TASK_BOXES_ORIENTATION);
        sc_step_traversal_refit(state);
        w->kernels->step->patch_itself(state, 0);
    }
    sc_step_candidates_decide(state);
}
