/*
 * Sheets: which triangles have an edge that crosses, and in which two of them a contour goes from
 * one crossing to the next.
 *
 * SPDX-License-Identifier: MIT
 *
 * At a crossing of edge e and triangle t the contour goes into each triangle T of e: T and t have a
 * segment in common, which begins here. It ends at another crossing of the same two triangles, or
 * at a vertex that they share. So each crossing has a branch for each triangle of its edge, and
 * branches are joined two by two.
 */
#ifndef SC_TRACE_SHEETS_H
#define SC_TRACE_SHEETS_H

#include "trace/crossings.h"

typedef struct sc_sheets {
    const sc_pair *crossings;
    uint32_t count;
    uint32_t *first;    /* count + 1: the branches of crossing i are first[i] to first[i + 1] - 1 */
    uint32_t *triangle; /* of each branch: a triangle of the edge, ascending at a crossing */
    uint32_t *other;    /* of each branch: the one that it is joined with, or SC_NONE: a vertex */
    uint32_t *crossing; /* of each branch: whose it is */
} sc_sheets;

/* Scratch memory. SC_ERROR_PAIRS: some branch has no other, hence a pair is missing. */
sc_status sc_sheets_find(const sc_trace_subject *subject, const sc_pair *crossings, uint32_t count,
                         sc_scratch *scratch, sc_sheets *sheets);

/* The one vertex that two triangles share; SC_NONE if they share none or several. */
uint32_t sc_sheets_shared_vertex(const sc_model *model, uint32_t a, uint32_t b);

#endif
