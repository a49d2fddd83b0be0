/*
 * What a worker has for proximity: what is asked, and what is kept of leaf clusters.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef SC_NEAR_WORKER_H
#define SC_NEAR_WORKER_H

#include "near/masks.h"
#include "step/step_worker.h"

/* Edges that a leaf cluster names at most: the sides of its triangles. */
enum { SC_NEAR_EDGES = 3 * SC_LEAF_MAX };

/* The derived data of a leaf cluster, in the unit box; see near/near_leaf_kernel.h. Rows are filled
   with the last point or triangle; edges with the first. */
typedef struct sc_near_leaf {
    float at[3][SC_LEAF_POINTS];      /* points */
    uint16_t corners[SC_LEAF_MAX];    /* the corners of triangles, */
    uint16_t ends[SC_NEAR_EDGES];     /* and the ends of edges, as bits of points */
    float box[6];                     /* of all points, moved outwards by the margin: lows, highs */
    float direction[3], leaf_slab[2]; /* and the slab of all points, likewise */
    float extent;                     /* the largest extent of an edge along an axis */
    uint32_t leaf, first;             /* and the place of its first triangle */
    uint16_t own;                     /* bit i: the leaf cluster is the first to have point i */
    uint16_t triangles;               /* bit i: there is a triangle i */
    uint16_t edges;                   /* how many */
    uint16_t owned[3];                /* bit i of k: triangle i names its side k */
    const uint32_t *point;            /* SC_LEAF_POINTS: the caller's numbers of points */
    const uint32_t *face;             /* and of triangles */
    const uint8_t *corner;            /* 3 SC_LEAF_MAX: which points are corners of triangles */
    uint8_t end[2][SC_NEAR_EDGES];    /* and ends of edges: first sides 0, then 1, then 2 */
    uint8_t of[SC_NEAR_EDGES];        /* side k of triangle i as 16 k + i */
    float side[6][SC_LEAF_MAX];       /* boxes of triangles: lows, then highs */
    float normal[3][SC_LEAF_MAX]; /* of triangles, and the slabs that these are in along them: */
    float slab[2][SC_LEAF_MAX];   /* the ends, moved outwards by the distance and by what they
                                     are off by */
} sc_near_leaf;

/* A worker has room of its own for that of so many leaf clusters: a power of two. */
enum { SC_NEAR_KEPT = 64 };

/* What is asked, checked and complete. As a step that stays where it is, it has the culling, the
   broad phase and the lists of one. */
typedef struct sc_near_question {
    sc_step_question step; /* its query's near is this */
    sc_near_options options;
    double *bounds; /* of vertices, the caller's, or NULL */
} sc_near_question;

/* What a worker has besides. */
typedef struct sc_near_worker {
    sc_near_leaf *leaves; /* leaf cluster i is kept at i & mask, if it is there */
    uint8_t *made;        /* leaf_count + SC_NEAR_KEPT: 1 if there is one at that place */
    uint32_t mask;        /* how many have a place, a power of two, minus 1 */
    uint32_t some;        /* SC_NEAR_KEPT, fewer in small models: */
    sc_near_leaf *own; /* 1 + some, the worker's own; the first is for the second of two that have
                             one place */
} sc_near_worker;

#endif
