/*
 * What a worker has for steps: what a step is asked, where its answer goes, and room.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef SC_STEP_WORKER_H
#define SC_STEP_WORKER_H

#include "query/worker.h"
#include "step/impact.h"

/* A box that moves: its three lows at the start, from the fourth on at the end, and likewise its
   highs. */
typedef struct sc_moving_box {
    float low[8], high[8];
} sc_moving_box;

/* The derived data of a leaf cluster in a step, in the unit box; see step/leaf_motion_kernel.h.
   Rows are filled with the last point or triangle. */
typedef struct sc_leaf_motion {
    float at[2][3][SC_LEAF_POINTS]; /* points at the start and at the end */
    float normal[3][SC_LEAF_MAX];
    float slab[4][SC_LEAF_MAX]; /* of triangles along their normals: the lower and upper ends at the
                                   start, then at the end */
    sc_moving_box box;          /* of all points; it keeps the margin */
    float direction[3], ends[4]; /* the slab of all points, likewise */
    uint32_t leaf;
    uint16_t owned[3];   /* bit i of k: triangle i names its side k */
    uint16_t own;        /* bit i: the leaf cluster is the first to have point i */
    uint16_t triangles;  /* bit i: there is a triangle i */
    uint16_t unused[11]; /* so that rows begin where cache lines do */
} sc_leaf_motion;

/* Where there is no room for that of all leaf clusters, there is for so many: a power of two. */
enum { SC_MOTIONS_KEPT = 64 };

/* What a worker keeps of leaf clusters in a step. */
typedef struct sc_kept_motions {
    sc_leaf_motion *leaves; /* leaf cluster i is kept at i & mask, if it is there */
    uint8_t *made;          /* leaf_count + SC_MOTIONS_KEPT: 1 if there is one at that place */
    uint32_t mask;          /* SC_KEEPS_ALL if all leaf clusters have a place of their own */
    uint32_t some;          /* SC_MOTIONS_KEPT, fewer in small models: */
    sc_leaf_motion *own;    /* 1 + some, the worker's own; the first is for the second of two that
                               have one place */
} sc_kept_motions;

/* What an sc_contour_edges lacks for the end of a step. */
typedef struct sc_moving_edges {
    float *at[2], *run_side[4], *group_side[4];
} sc_moving_edges;

/* Which of the caller's two lists. */
enum { SC_STEP_VERTEX_FACE = 0, SC_STEP_EDGE_EDGE = 1 };

/* Between two objects: as a bit of a vertex's number, that it is of the second object and the face
   of the first. */
#define SC_STEP_TURNED 0x80000000u

/* How many of the four points of a pair are of its first: a vertex, or an edge. */
static inline uint32_t sc_step_points_of_first(int kind)
{
    return kind == SC_STEP_VERTEX_FACE ? 1 : 2;
}

/* One of the caller's lists. */
typedef struct sc_step_list {
    sc_pair *pairs;
    double *times; /* or NULL */
    uint64_t capacity;
} sc_step_list;

/* Which pairs are not wanted, by kind. */
typedef struct sc_pair_filters {
    sc_filter of[2];      /* the caller's, checked; all 0 where there is none */
    sc_positions rest;    /* the rest pose */
    double rest_distance; /* pairs that are this near in it are left out; < 0: there is none */
    const sc_group *vertex_groups; /* vertex_count: of all triangles at each vertex together; where
                                      triangles have groups */
    uint8_t sifts[2], asks[2];     /* there is something to ask: step/step_filter.h */
} sc_pair_filters;

/* What a step is asked, checked and complete. */
typedef struct sc_step_question {
    sc_question query; /* what all queries are asked; its step is this */
    sc_step_options options;
    sc_impact_limits limits; /* of the narrow phase */
    sc_step_list list[2];
    sc_pair_filters filters;
} sc_step_question;

/* What a worker has besides, for steps. */
typedef struct sc_step_worker {
    const sc_step_question *question;
    uint64_t count[2];     /* pairs found */
    uint64_t turned;       /* those of a vertex and a face that are */
    double earliest;       /* least time of one, else 1 */
    sc_pair *found[2];     /* SC_FOUND_MAX each: pairs that are not yet in the caller's lists */
    double *found_time[2]; /* theirs */
    uint32_t found_count[2];
    sc_moving_edges contour;
    sc_kept_motions kept;
} sc_step_worker;

#endif
