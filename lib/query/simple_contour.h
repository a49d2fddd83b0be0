/*
 * A projected contour while the exact contour test looks at it: what query/simple.c and its inner loop
 * share.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef SC_QUERY_SIMPLE_CONTOUR_H
#define SC_QUERY_SIMPLE_CONTOUR_H

#include "pose/workspace.h"

/* Points that a contour passes more than once, at most; more are not looked at. */
enum { SC_PINCHES_MAX = 24 };

typedef struct sc_simple_contour {
    const sc_contour_edges *edges;
    uint32_t count;            /* points */
    uint32_t blocks;           /* of SC_CONTOUR_BLOCK edges */
    float axis[2][3], from[3]; /* the projection: x = axis[0] . (unit - from), likewise y */
    float error;               /* |computed - true| of each coordinate, at most */
    int in_pieces;             /* pieces have to be told apart */
    uint32_t pinch_count;
    uint32_t pinch[SC_PINCHES_MAX]; /* points */
} sc_simple_contour;

/* The error of a cross or dot product of vectors with these sums of absolute components, see simple.c. */
#define SC_SIMPLE_BOUND 12

/* 1 if two edges are certainly as edges of a simple contour are: apart, or sharing one point and nothing else.
   Notes pinches, and pieces that hang together. */
int sc_simple_are_apart(sc_simple_contour *contour, uint32_t i, uint32_t j);

#endif
