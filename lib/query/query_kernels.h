/*
 * The inner loops of a query that are compiled for several instruction sets.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef SC_QUERY_KERNELS_H
#define SC_QUERY_KERNELS_H

#include "query/clusters.h"
#include "query/simple_contour.h"

/* Pairs are decided by so many at a time. */
enum { SC_PAIR_LANES = 8 };

/* Where the corners of triangles are. */
typedef struct sc_triangle_source {
    const uint32_t *triangle;       /* three points at each place */
    const unsigned char *positions; /* as in sc_positions */
    uint64_t stride;
    int floats; /* positions are floats */
} sc_triangle_source;

/* SC_PAIR_LANES pairs of triangles that share one point at most. Bit i of shared: in pair i the
   corner is one of the other triangle's. */
typedef struct sc_pair_lanes {
    const sc_pair *pairs;     /* places of triangles */
    sc_triangle_source of[2]; /* of the first and of the second of pairs */
    int proper;               /* contacts are proper ones only */
    int shares;               /* some points are shared */
    unsigned shared[2][3];
} sc_pair_lanes;

/* Which edges (k of the first triangle, 3 + k of the second) meet the other triangle, bit 8 k + i
   for pair i: certainly; or it cannot be told. None from a shared point. */
typedef struct sc_verdict {
    uint64_t meets, unsure;
} sc_verdict;

typedef struct sc_query_kernels {
    /* Whether triangles meet, as far as that is certain in doubles; SC_PAIR_LANES pairs. */
    void (*decide)(const sc_pair_lanes *pairs, sc_verdict *verdict);
    /* Projects the listed points of a contour, and sets its error. */
    void (*project)(sc_simple_contour *contour, const sc_frame *frame);
    /* Whether sc_simple_are_apart is true of all pairs of edges whose boxes overlap. */
    int (*look_at_edges)(sc_simple_contour *contour);
    /* Bits of contours that certainly are simple, of loops in one piece with so many sixteens of
       edges, SC_DNC_VECTORS nodes or fewer. See query/small_kernel.h. */
    unsigned (*find_simple)(sc_worker *w, const uint32_t *nodes, uint32_t count, uint32_t blocks,
                            const float *const axes[]);
} sc_query_kernels;

#endif
