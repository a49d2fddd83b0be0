/*
 * The edges of crossings. See crossed_edges.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "trace/crossed_edges.h"

/* Sorts edges by their lower ends. */
static void sort_crossed_edges(sc_crossed_edges *e, uint32_t vertices)
{
    uint32_t i, v;
    for (i = 0; i < e->count; i++) e->first[e->ends[i].a + 1]++;
    for (v = 0; v < vertices; v++) e->first[v + 1] += e->first[v];
    for (i = e->count; i-- > 0;) { /* fills each list from its end, which moves to its begin */
        const uint32_t at = --e->first[e->ends[i].a + 1];
        e->by_end[at].a = e->ends[i].b;
        e->by_end[at].b = i;
    }
    for (v = 0; v < vertices; v++) e->first[v] = e->first[v + 1];
    e->first[vertices] = e->count;
}

sc_status sc_crossed_edges_list(const sc_trace_subject *subject, const sc_pair *crossings,
                                uint32_t count, sc_scratch *scratch, sc_crossed_edges *e)
{
    const uint32_t vertices = subject->model->vertex_count;
    uint32_t i, low, ends[2];
    e->ends = (sc_pair *)sc_scratch_take(scratch, count, sizeof *e->ends);
    e->by_end = (sc_pair *)sc_scratch_take(scratch, count, sizeof *e->by_end);
    e->first =
        (uint32_t *)sc_scratch_take_filled(scratch, (uint64_t)vertices + 1, sizeof *e->first, 0);
    e->is_end = (uint8_t *)sc_scratch_take_filled(scratch, vertices, 1, 0);
    if (!e->ends || !e->by_end || !e->first || !e->is_end) return SC_ERROR_MEMORY;
    for (e->count = i = 0; i < count; i++) {
        if (i > 0 && crossings[i].a == crossings[i - 1].a) continue;
        sc_trace_ends(subject->model, crossings[i].a, ends);
        low = ends[0] < ends[1] ? 0 : 1;
        e->ends[e->count].a = ends[low];
        e->ends[e->count++].b = ends[1 - low];
        e->is_end[ends[0]] = e->is_end[ends[1]] = 1;
    }
    sort_crossed_edges(e, vertices);
    return SC_OK;
}

void sc_crossed_edges_give(sc_scratch *scratch, const sc_crossed_edges *e)
{
    sc_scratch_give(scratch, e->is_end);
    sc_scratch_give(scratch, e->first);
    sc_scratch_give(scratch, e->by_end);
    sc_scratch_give(scratch, e->ends);
}
