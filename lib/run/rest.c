/*
 * Rest-shape caching. See rest.h.
 *
 * SPDX-License-Identifier: MIT
 *
 * The test tree is walked as by a query (paper, section 7) that culls nothing: once a node passes
 * the orientation test, its projection is that of all below. A query in another pose may have
 * another projection there; the cache is a heuristic for culling and decides no answer.
 */
#include "run/rest.h"

#include <string.h>

#include "build/assembly.h"
#include "pose/dnc.h"
#include "pose/positions.h"
#include "query/star.h"
#include "run/workspace.h"

typedef struct rest_walk {
    sc_worker *w;
    sc_node *node;
    sc_level *levels;
} rest_walk;

/* projected: a projection is known already. */
static void mark(rest_walk *walk, uint32_t node, uint32_t level, int projected)
{
    const sc_model *model = walk->w->model;
    const sc_frame *frame = walk->w->frame;
    sc_node *n = walk->node + node;
    const sc_pair *patches = &n->patches;
    uint32_t mask = (uint32_t)frame->mask[patches->a] & frame->mask[patches->b], c;
    const uint32_t end = sc_node_end(n);
    sc_level *l = &walk->levels[level];
    int culled = 0;
    if (!mask) {
        n->kind |= SC_NODE_REST_TURNED;
    } else {
        if (!projected) {
            sc_projection projection;
            sc_dnc_projection(frame, mask, &projection);
            sc_contour_bounds_begin(model, &frame->positions[0], &projection, walk->w->bounds);
            projected = 1;
        }
        culled = sc_star_test(walk->w, node);
        if (!culled) n->kind |= SC_NODE_REST_CROSSED;
    }
    if (patches->a == patches->b) {
        l->self_oriented += mask != 0;
        l->self_culled += (uint32_t)culled;
    } else {
        l->pair_oriented += mask != 0;
        l->pair_culled += (uint32_t)culled;
    }
    for (c = n->child; c < end; c++) mark(walk, c, level + 1, projected);
}

sc_status sc_rest_mark(sc_model *model, const sc_pose *rest, uint64_t stride, sc_scratch *scratch,
                       const sc_hooks *hooks)
{
    sc_question question;
    sc_workspace *workspace;
    rest_walk walk;
    void *memory;
    sc_status status;
    memory = sc_scratch_take(scratch, sc_workspace_bytes(model, NULL), 1);
    if (!memory) return SC_ERROR_MEMORY;
    memset(&question, 0, sizeof question);
    workspace = sc_workspace_place(model, NULL, memory);
    workspace->hooks = *hooks;
    walk.w = sc_workspace_begin(model, workspace, &question);
    walk.node = sc_assembly_nodes(model);
    walk.levels = sc_assembly_levels(model);
    status = sc_positions_read(model, rest, stride, &workspace->frame);
    if (status) return status; /* a caller's bisection may have spoiled what was checked */
    sc_dnc_update(model, &workspace->frame);
    mark(&walk, 0, 0, 0);
    sc_scratch_give(scratch, memory);
    return SC_OK;
}
