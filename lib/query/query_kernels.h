/*
 * The inner loops of a query that are compiled for several instruction sets.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef SC_QUERY_KERNELS_H
#define SC_QUERY_KERNELS_H

#include "query/clusters.h"
#include "query/decide.h"
#include "query/simple_contour.h"

typedef struct sc_query_kernels {
    /* Whether triangles meet, as far as that is certain in doubles; SC_PAIR_LANES pairs. */
    void (*decide)(const sc_pair_lanes *pairs, sc_verdict *verdict);
    /* Projects the listed points of a contour, and sets its error. */
    void (*project)(sc_simple_contour *contour, const sc_frame *frame);
    /* Whether sc_simple_are_apart is true of all pairs of edges whose boxes overlap, in three
       steps: the first of one contour, the second of another, all that is left of a third; each may
       be NULL. */
    void (*look_at_edges)(sc_simple_contour *first, sc_simple_contour *second,
                          sc_simple_contour *last);
    /* Bits of contours that certainly are simple, of loops in one piece with so many sixteens of
       edges, SC_DNC_VECTORS nodes or fewer. See query/small_kernel.h. */
    unsigned (*find_simple)(sc_worker *w, const uint32_t *nodes, uint32_t count, uint32_t blocks,
                            const float *const axes[]);
} sc_query_kernels;

#endif
