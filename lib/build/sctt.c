/*
 * The self-collision test tree. See sctt.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "build/sctt.h"

#include <string.h>

#include "base/assume.h"

enum { NODES_A_LEAF = 9 };

/* The tree while it grows: pairs as two items each. */
typedef struct growth {
    const sc_xbvh *xbvh;
    const sc_neighbors *neighbors;
    sc_scratch *scratch;
    sc_list patches, child, pairs, touch;
} growth;

static int add_node(growth *g, uint32_t a, uint32_t b, uint32_t touch)
{
    if (!sc_list_reserve(g->scratch, &g->patches, 2) || !sc_list_reserve(g->scratch, &g->touch, 1))
        return 0;
    sc_list_add(&g->patches, a);
    sc_list_add(&g->patches, b);
    sc_list_add(&g->touch, touch);
    return 1;
}

/* A pair of children becomes a node or a BVTT child, of which bit is set. */
static int add_pair(growth *g, uint32_t a, uint32_t b, uint32_t bit, uint32_t *pairs)
{
    const sc_pair *entry = sc_neighbors_find(g->neighbors, a, b);
    *pairs |= entry ? bit : bit << SC_PAIR_BOXES;
    return !entry || add_node(g, a, b, entry->b);
}

/* All pairs of children of two patches. */
static int expand(growth *g, uint32_t a, uint32_t b, uint32_t *pairs)
{
    const uint32_t *child = g->xbvh->child;
    uint32_t c, d;
    *pairs = 0;
    if (sc_xbvh_is_leaf(g->xbvh, a) && sc_xbvh_is_leaf(g->xbvh, b)) return 1;
    for (c = child[a]; a == b && c < child[a + 1]; c++) {
        *pairs |= 1u << 3 * (c - child[a]);
        if (!add_node(g, c, c, SC_NONE)) return 0;
    }
    for (c = child[a]; c < child[a + 1]; c++)
        for (d = a == b ? c + 1 : child[b]; d < child[b + 1]; d++)
            if (!add_pair(g, c, d, 1u << (2 * (c - child[a]) + d - child[b]), pairs)) return 0;
    return 1;
}

/* Room for what meshes in which about six triangles meet at a point need, so that lists seldom have
   to grow. */
static int reserve(growth *g, uint64_t nodes)
{
    return sc_list_reserve(g->scratch, &g->patches, 2 * nodes) &&
           sc_list_reserve(g->scratch, &g->touch, nodes) &&
           sc_list_reserve(g->scratch, &g->child, nodes) &&
           sc_list_reserve(g->scratch, &g->pairs, nodes);
}

sc_status sc_sctt_build(const sc_xbvh *xbvh, const sc_neighbors *neighbors, sc_scratch *scratch,
                        sc_sctt *sctt)
{
    growth g;
    uint32_t level, pairs;
    uint64_t n, end;
    memset(&g, 0, sizeof g);
    g.xbvh = xbvh;
    g.neighbors = neighbors;
    g.scratch = scratch;
    sctt->level_first =
        (uint32_t *)sc_scratch_take(scratch, (uint64_t)xbvh->level_count + 1, sizeof(uint32_t));
    if (!sctt->level_first || !reserve(&g, NODES_A_LEAF * (uint64_t)xbvh->leaf_count))
        return SC_ERROR_MEMORY;
    (void)add_node(&g, 0, 0, SC_NONE); /* there is room */
    for (n = 0, level = 0; level < xbvh->level_count; level++) {
        sctt->level_first[level] = (uint32_t)n;
        for (end = g.touch.count; n < end; n++) {
            if (!sc_list_reserve(scratch, &g.child, 2) || !sc_list_reserve(scratch, &g.pairs, 1))
                return SC_ERROR_MEMORY;
            sc_list_add(&g.child, (uint32_t)g.touch.count);
            if (!expand(&g, g.patches.items[2 * n], g.patches.items[2 * n + 1], &pairs))
                return SC_ERROR_MEMORY;
            sc_list_add(&g.pairs, pairs);
            if (SC_HARDLY(g.touch.count > 0xfffffff0u))
                return SC_ERROR_COUNT; /* tens of gigabytes */
        }
    }
    sctt->level_first[xbvh->level_count] = (uint32_t)n;
    sc_list_add(&g.child, (uint32_t)n);
    sctt->node_count = (uint32_t)n;
    sctt->patches = (sc_pair *)(void *)g.patches.items;
    sctt->touch = g.touch.items;
    sctt->child = g.child.items;
    sctt->pairs = g.pairs.items;
    return SC_OK;
}

int sc_sctt_validate(const sc_xbvh *xbvh, const sc_neighbors *neighbors, const sc_sctt *sctt)
{
    uint32_t n;
    if (sctt->patches[0].a != 0 || sctt->patches[0].b != 0 || sctt->child[0] != 1) return 0;
    if (sctt->child[sctt->node_count] != sctt->node_count) return 0;
    for (n = 0; n < sctt->node_count; n++) {
        uint32_t a = sctt->patches[n].a, b = sctt->patches[n].b, c, d;
        uint32_t node = sctt->child[n], pairs = 0;
        if (!(sc_xbvh_is_leaf(xbvh, a) && sc_xbvh_is_leaf(xbvh, b))) {
            for (c = xbvh->child[a]; a == b && c < xbvh->child[a + 1]; c++, node++) {
                if (node >= sctt->node_count || sctt->patches[node].a != c ||
                    sctt->patches[node].b != c)
                    return 0;
                pairs |= 1u << 3 * (c - xbvh->child[a]);
            }
            for (c = xbvh->child[a]; c < xbvh->child[a + 1]; c++)
                for (d = a == b ? c + 1 : xbvh->child[b]; d < xbvh->child[b + 1]; d++) {
                    uint32_t bit = 1u << (2 * (c - xbvh->child[a]) + d - xbvh->child[b]);
                    if (sc_neighbors_find(neighbors, c, d)) {
                        if (node >= sctt->node_count) return 0;
                        if (sctt->patches[node].a != c || sctt->patches[node++].b != d) return 0;
                        pairs |= bit;
                    } else {
                        pairs |= bit << SC_PAIR_BOXES;
                    }
                }
        }
        if (node != sctt->child[n + 1] || pairs != sctt->pairs[n]) return 0;
    }
    return 1;
}
