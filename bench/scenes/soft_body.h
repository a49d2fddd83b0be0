/*
 * A small simulator of elastic surfaces: particles at vertices, held together by distances.
 *
 * SPDX-License-Identifier: MIT
 *
 * As in cloth_simulation.h: many short steps with one sweep over distances, along edges and,
 * against bending, across them. Each particle is also drawn towards its place in the rest shape,
 * moved and turned as the whole is (Müller et al., "Meshless deformations based on shape matching",
 * 2005), and may be pushed along its normal. The surface does not collide with itself. Sweeps go in
 * a fixed order, so results are repeatable.
 *
 * Cost: about 15 ns a distance and step, 3 distances a triangle.
 */
#ifndef BENCH_SOFT_BODY_H
#define BENCH_SOFT_BODY_H

#include "mesh_file.h"

typedef struct soft_body soft_body;

/* Called in each step before and after distances are restored: moves what is inside of something.
   time is from 0 to 1. */
typedef void (*soft_body_hold)(soft_body *body, double time);

typedef struct soft_spring {
    uint32_t a, b;
    double length, compliance; /* at rest; 0 is rigid */
} soft_spring;

struct soft_body {
    uint32_t vertex_count, triangle_count;
    const uint32_t *triangles; /* the caller's */
    double *rest;              /* 3 * vertex_count, about their mean */
    double *positions;         /* 3 * vertex_count */
    double *before;            /* 3 * vertex_count: at the beginning of the step */
    double *normals;           /* 3 * vertex_count */
    double *shown;             /* 3 * vertex_count: at a moment between two steps */
    double *keep;              /* vertex_count: part of the way to its place that goes in a step */
    soft_spring *springs;
    size_t spring_count;
    double turn[4]; /* of the whole: a unit quaternion, w last */
    double gravity; /* along -z */
    double push;    /* acceleration along normals at time 1, from 0 at time 0 */
    double drag;    /* part of the speed that is lost in a unit of time */
    double duration;
    uint32_t steps, done;
    soft_body_hold hold;
};

/* Starts at a mesh at rest. stretch and bend: compliances. Returns 0, or -1 if there is no
   memory. */
int soft_body_init(soft_body *body, const mesh_file *mesh, const uint32_t *triangles,
                   double stretch, double bend);
void soft_body_free(soft_body *body);

/* Gives the body a speed: of the whole, and of turning about the y axis, per unit of time. To be
   called before the first run, when duration and steps are set. */
void soft_body_throw(soft_body *body, const double speed[3], double turn);

/* As cloth_simulation_run. */
const double *soft_body_run(soft_body *body, double time);

#endif /* BENCH_SOFT_BODY_H */
