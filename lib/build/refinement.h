/*
 * Shortens the border between two sides of a patch.
 *
 * SPDX-License-Identifier: MIT
 *
 * C. M. Fiduccia, R. M. Mattheyses, "A linear-time heuristic for improving network partitions",
 * 1982: triangles change sides one at a time, each once, always the one that shortens the border
 * most or lengthens it least; then the moves after the shortest border are taken back. Going
 * through longer borders is what turns the zigzag of a straight cut into a line along edges. A heap
 * stands for the paper's buckets, since gains are lengths. One pass over the patch finds the
 * border; further work grows with the border, times a logarithm.
 */
#ifndef SC_BUILD_REFINEMENT_H
#define SC_BUILD_REFINEMENT_H

#include "build/adjacency.h"

typedef struct sc_refinement {
    const uint32_t *neighbor; /* 3 per triangle: across its sides; without one, triangle_count */
    const float *lengths;     /* 3 per triangle: of its sides, as build/bisection.h counts them */
    uint32_t
        *label;  /* per triangle: 2 * patch + side, 0 or 1; at triangle_count what no patch has */
    float *gain; /* per triangle, scratch */
    uint8_t *state;        /* per triangle and one more, scratch; 0 before and after */
    uint32_t *moves;       /* as many as triangles, scratch */
    sc_pair *heap;         /* four times as many, scratch */
    uint32_t *border;      /* as many as triangles: those with a neighbor on the other side, */
    uint32_t border_count; /* as many, when a run is done */
} sc_refinement;

/* size and capacity of the two sides; no side becomes empty or grows beyond its capacity, which
   must be less than count. */
void sc_refinement_run(sc_refinement *refinement, const uint32_t *triangles, uint32_t count,
                       uint32_t size[2], const uint32_t capacity[2]);

#endif
