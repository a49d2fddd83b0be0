/*
 * Which vertices and faces, edges and edges of a step collide, each pair by itself in exact
 * arithmetic, and when: slow and obvious. For test_step_oracle.c.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef TESTS_STEP_TRUTH_H
#define TESTS_STEP_TRUTH_H

#include <stdint.h>

#include "oracle.h"
#include "soups.h"
#include "starcontour.h"

/* Kinds of pairs. */
enum { STEP_VERTEX_FACE = 0, STEP_EDGE_EDGE = 1, STEP_KINDS = 2, STEP_DIRECTIONS = 13 };

extern const char *const step_kind_names[STEP_KINDS];

/* A mesh in motion, as the oracle sees it. */
typedef struct step_motion {
    const uint32_t *triangles;
    uint32_t vertex_count, triangle_count, edge_count;
    uint32_t *corner; /* 3 * triangle_count: vertices after welding */
    uint32_t *edge;   /* edge_count corners 3 t + k, ascending */
    uint8_t *used;    /* vertex_count: represents a vertex of a triangle */
    double *ends[2];  /* 3 * vertex_count */
    double *along[2]; /* STEP_DIRECTIONS * vertex_count */
    double size;      /* largest absolute value along a direction */
    double extent;    /* largest extent of the box round both poses */
} step_motion;

/* The vertices of the edge that begins at a corner 3 t + k. */
uint32_t step_edge_start(const step_motion *m, uint32_t corner);
uint32_t step_edge_end(const step_motion *m, uint32_t corner);

/* weld is NULL, or as in sc_mesh. The poses are packed doubles. */
step_motion step_motion_make(const soup *mesh, const double *start, const double *end,
                             const uint32_t *weld);

void step_motion_free(step_motion *m);

/* The four vertices of a pair: vertex and face, or edge and edge. Returns how many belong to the
   first. */
uint32_t step_pair_vertices(const step_motion *m, int kind, sc_pair pair, uint32_t v[4]);

/* Whether a pair is within separation + tolerance at a time, which is certain. The tolerance is at
   least 2^-32 of the largest difference of a coordinate between its two. */
int step_is_near(const step_motion *m, int kind, sc_pair pair, double time, double separation,
                 double tolerance);

/* Pairs, and for each a time that its first contact is not after. */
typedef struct step_truth {
    oracle_list list;
    double *when;
} step_truth;

/* All pairs of a kind that surely come as near as the separation, sorted; of flat meshes a part of
   them, drawn by lot. */
step_truth step_truth_find(const step_motion *m, int kind, double separation);

#endif
