/*
 * The segments of a contour, one after the other as each leads into the next.
 *
 * SPDX-License-Identifier: MIT
 *
 * The half-edges of a contour leave each point as often as they reach it. So segments that hang
 * together at their ends can be walked in one closed chain (Hierholzer 1873: walk until there is no
 * way on, which is where the walk began; where a segment is left that starts on the way, insert a
 * walk from there). Linear in the number of segments.
 */
#ifndef SC_BUILD_CHAINS_H
#define SC_BUILD_CHAINS_H

#include "base/memory.h"

/* The ends of segments, and scratch memory. */
typedef struct sc_chains {
    const uint32_t *points; /* point numbers */
    const uint32_t *first,
        *last;             /* of each segment: places of its first and last point in points */
    uint32_t *starting_at; /* of each point: a list of segments, empty before and after */
    uint32_t *next, *old, *start, *end; /* as many as the most segments of a contour; the last two:
                                           points */
} sc_chains;

/* Takes scratch memory for points with numbers below point_count and up to `most` segments at
   once. */
sc_status sc_chains_take(sc_scratch *scratch, uint64_t point_count, uint64_t most,
                         sc_chains *chains);
void sc_chains_give(sc_scratch *scratch, sc_chains *chains);

/* Puts the segments of a contour in order and returns the number of closed chains. */
uint32_t sc_chains_order(const sc_chains *chains, uint32_t *segments, uint32_t count);

#endif
