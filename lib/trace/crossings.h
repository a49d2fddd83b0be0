/*
 * Crossings: which of the caller's pairs of an edge and a triangle cross when ties are decided, and
 * where they do.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef SC_TRACE_CROSSINGS_H
#define SC_TRACE_CROSSINGS_H

#include "base/memory.h"
#include "pose/positions.h"
#include "trace/trace_kernels.h"

/* What is traced: the caller's arguments, checked. */
typedef struct sc_trace_subject {
    const sc_model *model;
    sc_positions positions;
    const sc_trace_kernels *kernels;
    const sc_pair *pairs;
    uint32_t count;
    const sc_hooks *hooks;
    const volatile uint32_t *cancel; /* or NULL */
} sc_trace_subject;

int sc_trace_is_cancelled(const sc_trace_subject *subject);

/* The corners of the caller's triangle, as points, in the order of the mesh. */
static inline const uint32_t *sc_trace_corners(const sc_model *model, uint32_t triangle)
{
    return sc_model_triangle(model) + 3 * (uint64_t)sc_model_place(model)[triangle];
}

/* The two ends of an edge as pairs name it, as points. */
static inline void sc_trace_ends(const sc_model *model, uint32_t edge, uint32_t ends[2])
{
    const uint32_t *corner = sc_trace_corners(model, edge / 3);
    ends[0] = corner[edge % 3];
    ends[1] = corner[(edge + 1) % 3];
}

/* Whether welding has made two corners one. */
static inline int sc_trace_is_collapsed(const uint32_t corner[3])
{
    return corner[0] == corner[1] || corner[1] == corner[2] || corner[2] == corner[0];
}

/* Where an edge crosses a triangle, as in sc_trace_node. */
typedef struct sc_crossing_place {
    double along, weights[3], point[3];
} sc_crossing_place;

/* The pairs that cross, in their order. Scratch memory. */
typedef struct sc_crossings {
    uint32_t count;
    sc_pair *pairs;
    sc_crossing_place *places;
} sc_crossings;

/* Checks all pairs, and finds those. */
sc_status sc_crossings_find(const sc_trace_subject *subject, sc_scratch *scratch,
                            sc_crossings *crossings);

#endif
