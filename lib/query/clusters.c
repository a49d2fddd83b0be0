/*
 * Pairs of leaf clusters. See clusters.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "query/clusters.h"

/* Whether two triangles share a vertex, without branches. */
static inline unsigned share_any(const uint32_t *a, const uint32_t *b)
{
    return (unsigned)((a[0] == b[0]) | (a[0] == b[1]) | (a[0] == b[2]) | (a[1] == b[0]) |
                      (a[1] == b[1]) | (a[1] == b[2]) | (a[2] == b[0]) | (a[2] == b[1]) |
                      (a[2] == b[2]));
}

/* The masks of two clusters that have points of so many triangles that the model has none. */
static void find_shared(const sc_model *model, sc_leaf_pair *p)
{
    const uint32_t *triangle = sc_model_triangle(model), *first = sc_model_leaf_first(model);
    uint32_t i, j;
    for (i = first[p->a]; i < first[p->a + 1]; i++) {
        uint16_t *row = &p->found[i - first[p->a]];
        for (j = first[p->b], *row = 0; j < first[p->b + 1]; j++)
            *row |= (uint16_t)(share_any(triangle + 3 * (uint64_t)i, triangle + 3 * (uint64_t)j)
                               << (j - first[p->b]));
    }
    p->shared = p->found;
}

void sc_clusters_enter(const sc_worker *w, const sc_cluster_pair *clusters, sc_leaf_pair *p)
{
    static const uint16_t nothing[SC_LEAF_MAX] = {0};
    const sc_model *model = w->model;
    p->a = clusters->a;
    p->b = clusters->b;
    p->bit = clusters->known & SC_AFTER_CONTOUR;
    p->shared = nothing;
    p->wanted = !w->question->drops_neighbors;
    p->list = NULL;
    if (sc_worker_is_between(w)) {
        p->shares = 0;
        return;
    }
    if (sc_model_share_crowded(model)[p->a] & sc_model_share_crowded(model)[p->b]) {
        find_shared(model, p);
    } else if (p->a == p->b) {
        sc_sharing_unfold(sc_model_share_own_rows(model) + SC_OWN_WORDS * (uint64_t)p->a, p->found);
        p->shared = p->found;
    } else if (clusters->shared != SC_NONE) {
        const uint32_t *begin = sc_model_share_begin(model) + clusters->shared;
        p->list = sc_model_share_list(model) + begin[0];
        p->list_end = sc_model_share_list(model) + begin[1];
    }
    p->shares = p->list || p->shared != nothing;
}
