/*
 * A projected contour while the exact contour test looks at it: what query/simple.c, the tests that
 * are made of it and its inner loops share.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef SC_QUERY_SIMPLE_CONTOUR_H
#define SC_QUERY_SIMPLE_CONTOUR_H

#include "base/bounds.h"
#include "pose/dnc.h"

/* Points of a contour are projected in blocks of SC_CONTOUR_BLOCK. A step tests edges with the next
   SC_CONTOUR_NEAR: all of their own run of SC_CONTOUR_RUN and the next. */
enum { SC_CONTOUR_BLOCK = 16, SC_CONTOUR_RUN = 4, SC_CONTOUR_NEAR = 2 * SC_CONTOUR_RUN - 1 };

/* Room for the boxes of so many spans, with those that are read beyond: full blocks, and two
   more. */
#define SC_CONTOUR_SPANS(count)                                                                    \
  (((count) + SC_CONTOUR_BLOCK - 1) / SC_CONTOUR_BLOCK * SC_CONTOUR_BLOCK + 2 * SC_CONTOUR_BLOCK)

/* Pieces of a contour that is stored as a loop are listed in so many places each, or a multiple of
   that: then spans of as many edges are of one piece. */
enum { SC_CONTOUR_GAP = 4 };

/* Sides of boxes in the plane. */
enum { SC_LOW_X, SC_HIGH_X, SC_LOW_Y, SC_HIGH_Y };

/*
 * The projected contour of a node, see query/simple.c: a list of points, of which point i and the
 * next are edge i, but where a chain ends. Room for model.contour_max points, what gaps between
 * pieces of loops add, and two blocks more.
 */
typedef struct sc_contour_edges {
    uint32_t *point;      /* what points they are */
    float *at[2];         /* x and y */
    float *span_side[4];  /* boxes of spans of 2, 4, 8... edges, see query/simple_kernel.h */
    float *run_side[4];   /* of steps: boxes of runs, and 16 more */
    float *group_side[4]; /* of steps: boxes of 16 runs, and 16 more */
    uint16_t *is_edge;    /* bit i of block b: SC_CONTOUR_BLOCK b + i is an edge */
    float *wall;          /* if there are gaps: infinity for what is no edge, -infinity for edges */
} sc_contour_edges;

/* Points that a contour passes more than once, at most; more are not looked at. */
enum { SC_PINCHES_MAX = 24 };

/* Such a point, and the two edges that start there. */
typedef struct sc_pinch {
    uint32_t point, edge[2];
} sc_pinch;

typedef struct sc_simple_contour {
    const sc_contour_edges *edges;
    uint32_t count;              /* points, of which each is where an edge starts but for gaps */
    uint32_t blocks;             /* of SC_CONTOUR_BLOCK points; not of loops */
    int has_gaps;                /* edges.is_edge tells; 0: all are edges */
    const uint16_t *loop;        /* the points as the model has them, or NULL: they are listed */
    uint32_t looped;             /* how many of them: count, without what stands in gaps */
    const uint16_t *piece_edges; /* of a loop in pieces: how many edges each has */
    uint32_t pieces;             /* how many */
    const uint32_t *leaf_point;
    uint32_t split, first, second; /* what to add to a loop's number below split, and to others */
    uint32_t span_first[33];       /* where boxes of spans of 2^level edges start, by level */
    float axis[2][3], from[3];     /* the projection: x = axis[0] . (unit - from), likewise y */
    float error;                   /* |computed - true| of each coordinate, at most */
    int in_pieces;                 /* there may be several */
    uint32_t level, spans;         /* what is looked at next: so many spans; 0: nothing */
    uint32_t pinch_count;
    sc_pinch pinch[SC_PINCHES_MAX];
} sc_simple_contour;

/* The vectors of some projections, over powers of two, exactly, so that their absolute values sum
   to at most 1. */
typedef struct sc_simple_some_axes {
    float at[2][3][SC_DNC_VECTORS];
} sc_simple_some_axes;

/* Small contours, see query/small_kernel.h: sixteens of edges that one has at most, and edges at
   least: 8 b + 1 for one sixteen. */
enum { SC_SMALL_BLOCKS = 4, SC_SMALL_EDGES = 9 };

/* 1 if two edges, the boxes of which may meet, are certainly as edges of a simple contour are:
   apart, or sharing one point and nothing else. Notes pinches. */
int sc_simple_are_apart(sc_simple_contour *contour, uint32_t i, uint32_t j);

/* The transposed place of a number in a loop among those of all leaf clusters. */
static inline uint32_t sc_simple_place(const sc_simple_contour *c, uint32_t number)
{
    return number + (number < c->split ? c->first : c->second);
}

/* The point of that number. */
static inline uint32_t sc_simple_point(const sc_simple_contour *c, uint32_t number)
{
    return c->leaf_point[sc_loops_turn(sc_simple_place(c, number))];
}

/* The parts of which the test is made, for others like it (step/moving_contour.c). */

/* Lets bits of is_edge for the first edges follow those of the last. */
void sc_simple_close_bits(const sc_simple_contour *contour);

/* Makes room for gaps between the pieces of a loop, whose points or places are listed one after the
   other: each is followed by its first point, up to a multiple of SC_CONTOUR_GAP. */
void sc_simple_spread(sc_simple_contour *contour);

/* Starts a contour: lists its points, with a gap after each chain. 0: there is none (of
   a forged model: without a contour, areas are not all positive). */
int sc_simple_list(sc_simple_contour *contour, const sc_model *model, const sc_contour_edges *room,
                   uint32_t node);

/* Sets how the points of a node's loop, of one that has a loop, are read. */
void sc_simple_find_loop(sc_simple_contour *contour, const sc_model *model, uint32_t node);

/* Starts a contour for the inner loops: finds its loop, whose points are listed as they are
   projected; or lists all as a cycle: the last is followed by the first again, so that the inner
   loops may look beyond the end. 0: as above. */
int sc_simple_start(sc_simple_contour *contour, const sc_model *model, const sc_contour_edges *room,
                    uint32_t node);

/* Sets axis: the vectors of a projection over powers of two, exactly, so that their absolute values
   sum to at most 1; and more than 1/2. */
void sc_simple_axes(sc_simple_contour *contour, const sc_projection *projection);

/* About the middle of a contour, of points in the unit box with so many floats each. */
void sc_simple_middle(const sc_simple_contour *contour, const float *unit, uint32_t stride,
                      float from[3]);

/* Notes that edges i < j share one point, if it is a pinch. 0: too many pinches, or more than two
   edges that start at one. */
int sc_simple_note_shared(sc_simple_contour *contour, uint32_t i, uint32_t j);

/* Whether pinches and pieces are as those of a simple contour, after all edges were found to be
   so. */
int sc_simple_is_wound_well(const sc_simple_contour *contour);

#endif
