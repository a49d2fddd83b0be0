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

void sc_step_traversal_refit(sc_worker *w)
{
    const sc_model *model = w->model;
    uint32_t previous;
    if (w->frame->boxes_ready) return;
    previous = sc_worker_switch(w, SC_TASK_UPDATE_BOXES);
    sc_motion_refit(model, w->frame);
    w->stats.counts[SC_TASK_UPDATE_BOXES] += model->patch_end;
    sc_worker_switch(w, previous);
}

void sc_step_traversal_update_cones(sc_worker *w)
{
    sc_worker_switch(w, SC_TASK_UPDATE_NORMALS);
    sc_motion_update_cones(w->model, w->frame);
    w->stats.counts[SC_TASK_UPDATE_NORMALS] += w->model->patch_end;
    sc_worker_switch(w, SC_TASK_ORIENTATION);
}

/* What is collected is decided before it would count as following another kind of test, as in
   query/traversal.c. */
void sc_step_traversal_follow_contour(sc_worker *w, int after_contour)
{
    if (w->step->after_contour == after_contour) return;
    if (w->question->timed || w->question->options.budget) sc_step_candidates_decide(w);
    w->step->after_contour = after_contour;
}

/* Whether the contour test says that nothing in a node collides. */
static int is_clear(sc_worker *w, uint32_t node, uint32_t mask)
{
    sc_projection projection;
    if (w->step->question->options.contour == SC_CONTOUR_NONE) return 1;
    sc_dnc_projection(w->frame, mask, &projection);
    return sc_moving_contour_test(w, &projection, node);
}

uint32_t sc_step_traversal_mask(const sc_worker *w, uint32_t node)
{
    const sc_pair *patches = &sc_model_node(w->model)[node].patches;
    const uint16_t *mask = w->frame->mask;
    return (uint32_t)mask[patches->a] & mask[patches->b];
}

int sc_step_traversal_culls(sc_worker *w, uint32_t node, int failed)
{
    uint32_t mask = sc_step_traversal_mask(w, node);
    w->stats.nodes_visited++;
    if (failed) return 0;
    w->stats.counts[SC_TASK_ORIENTATION]++;
    if (!mask) return 0;
    w->stats.nodes_oriented++;
    if (!is_clear(w, node, mask)) return 0;
    w->stats.nodes_culled++;
    return 1;
}

void sc_step_traversal_query_rest(sc_worker *w, uint32_t node)
{
    const sc_model *model = w->model;
    const sc_motion *motion = &w->frame->motion;
    const sc_node *n = sc_model_node(model) + node;
    const sc_step_kernels *kernels = w->frame->kernels->step;
    uint32_t bits, previous;
    if (sc_worker_stops(w)) return;
    sc_step_traversal_follow_contour(w, sc_step_traversal_mask(w, node) != 0);
    sc_step_traversal_refit(w);
    previous = sc_worker_switch(w, sc_step_box_task(w));
    for (bits = sc_node_boxes(n); bits && !w->stop; bits &= bits - 1) {
        const sc_pair pair = sc_model_pair(model, n, sc_bits_lowest(bits));
        w->stats.counts[sc_step_box_task(w)]++;
        if (!sc_motion_boxes_apart(motion, pair.a, pair.b)) kernels->patch_pair(w, pair.a, pair.b);
    }
    if (sc_node_is_leaf(n)) {
        const uint32_t *leaf = sc_model_leaf(model);
        if (n->patches.a == n->patches.b)
            kernels->leaf_itself(w, leaf[n->patches.a]);
        else
            kernels->leaf_pair(w, leaf[n->patches.a], leaf[n->patches.b]);
    }
    sc_worker_switch(w, previous);
}

/*
 * A node, and what is below it if it is not culled. Nodes of two patches come first, since a patch
 * that is in one that is culled is culled with it. failed: the node has a contour that failed.
 */
static void query_step_node(sc_worker *w, uint32_t node, int failed)
{
    const sc_node *nodes = sc_model_node(w->model), *n = nodes + node;
    uint32_t a = n->patches.a, b = n->patches.b, end = sc_node_end(n), c;
    uint8_t *culled = w->last.culled;
    int is_self = a == b, selfs;
    if (is_self && culled[a]) return;
    if (sc_step_traversal_culls(w, node, failed)) {
        culled[a] = culled[b] = 1;
        return;
    }
    failed = is_self && sc_step_traversal_mask(w, node);
    for (selfs = 0; selfs < 2; selfs++)
        for (c = n->child; c < end && !w->stop; c++)
            if ((nodes[c].patches.a == nodes[c].patches.b) == selfs)
                query_step_node(w, c, failed && !selfs);
    sc_step_traversal_query_rest(w, node);
}

void sc_step_traversal_run(sc_worker *w)
{
    w->frame->motion.swept = w->step->question->options.method == SC_STEP_METHOD_SWEPT;
    if (w->step->question->options.method == SC_STEP_METHOD_SCTT) {
        sc_step_traversal_update_cones(w);
        memset(w->last.culled, 0, w->model->patch_end);
        query_step_node(w, 0, 0);
    } else {
        sc_worker_switch(w, SC_TASK_BOXES_ORIENTATION);
        sc_step_traversal_refit(w);
        w->frame->kernels->step->patch_itself(w, 0);
    }
    sc_step_candidates_decide(w);
}
