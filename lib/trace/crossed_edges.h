/*
 * The edges of crossings, found by their ends.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef SC_TRACE_CROSSED_EDGES_H
#define SC_TRACE_CROSSED_EDGES_H

#include "trace/crossings.h"

typedef struct sc_crossed_edges {
    uint32_t count;
    sc_pair *ends;   /* of each edge, the lower one first */
    uint32_t *first; /* vertex_count + 1: edges with lower end v are first[v] to first[v + 1] - 1 */
    sc_pair *by_end; /* of these, the upper end and the number */
    uint8_t *is_end; /* vertex_count: whether an edge ends there */
} sc_crossed_edges;

/* Lists the edges of crossings, which are sorted by them, in that order. Scratch memory. */
sc_status sc_crossed_edges_list(const sc_trace_subject *subject, const sc_pair *crossings,
                                uint32_t count, sc_scratch *scratch, sc_crossed_edges *edges);

void sc_crossed_edges_give(sc_scratch *scratch, const sc_crossed_edges *edges);

/* The number of the edge between two vertices, or SC_NONE. */
static inline uint32_t sc_crossed_edges_find(const sc_crossed_edges *e, uint32_t u, uint32_t v)
{
    const uint32_t low = u < v ? u : v, high = u < v ? v : u;
    uint32_t i;
    for (i = e->first[low]; i < e->first[low + 1]; i++)
        if (e->by_end[i].a == high) return e->by_end[i].b;
    return SC_NONE;
}

#endif
