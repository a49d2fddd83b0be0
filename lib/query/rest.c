/*
 * Rest-shape caching. See rest.h.
 *
 * SPDX-License-Identifier: MIT
 *
 * The test tree is walked as by a query (paper, section 7) that culls nothing: once a node passes
 * the orientation test, its projection is that of all below. A query in another pose may have
 * another projection there; the cache is a heuristic for culling and decides no answer.
 */
#include "query/rest.h"

#include <string.h>

#include "pose/dnc.h"
#include "pose/positions.h"
#include "query/star.h"

typedef struct rest_walk {
    sc_query_state state;
    sc_node *node;
    sc_level *levels;
} rest_walk;

/* projection NULL: none is known yet. */
static void mark(rest_walk *walk, uint32_t node, uint32_t level, const sc_projection *projection)
{
    const sc_model *model = walk->state.model;
    sc_workspace *w = walk->state.workspace;
    sc_node *n = walk->node + node;
    const sc_pair *patches = &n->patches;
    uint32_t mask = (uint32_t)w->mask[patches->a] & w->mask[patches->b], c, end = sc_node_end(n);
    sc_level *l = &walk->levels[level];
    sc_projection own;
    int culled = 0;
    if (!mask) {
        n->kind |= SC_NODE_REST_TURNED;
    } else {
        if (!projection) {
            sc_dnc_projection(w, mask, &own);
            sc_workspace_new_projection(model, w);
            projection = &own;
        }
        culled = sc_star_test(&walk->state, projection, node);
        if (!culled) n->kind |= SC_NODE_REST_CROSSED;
    }
    if (patches->a == patches->b) {
        l->self_oriented += mask != 0;
        l->self_culled += (uint32_t)culled;
    } else {
        l->pair_oriented += mask != 0;
        l->pair_culled += (uint32_t)culled;
    }
    for (c = n->child; c < end; c++) mark(walk, c, level + 1, projection);
}

sc_status sc_rest_mark(sc_model *model, const sc_pose *rest, uint64_t stride, sc_scratch *scratch,
                       const sc_hooks *hooks)
{
    rest_walk walk;
    void *memory;
    sc_status status;
    memory = sc_scratch_take(scratch, sc_workspace_bytes(model, NULL), 1);
    if (!memory) return SC_ERROR_MEMORY;
    memset(&walk, 0, sizeof walk);
    walk.node = sc_model_nodes_of_new(model);
    walk.levels = sc_model_levels_of_new(model);
    walk.state.model = model;
    walk.state.workspace = sc_workspace_place(model, NULL, memory);
    walk.state.workspace->hooks = *hooks;
    sc_workspace_new_pose(model, walk.state.workspace);
    status = sc_positions_read(model, rest, stride, walk.state.workspace);
    if (status) return status; /* a caller's bisection may have spoiled what was checked */
    sc_dnc_update(model, walk.state.workspace);
    mark(&walk, 0, 0, NULL);
    sc_scratch_give(scratch, memory);
    return SC_OK;
}
