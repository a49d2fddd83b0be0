/*
 * A model with a pose in its workspace, as within a query: to look at cones, projections,
 * segments and single nodes of the test tree, in exact arithmetic.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef TESTS_POSED_MODEL_H
#define TESTS_POSED_MODEL_H

#include <gmp.h>
#include <stdint.h>

#include "inputs.h"
#include "pose/dnc.h"
#include "query/worker.h"
#include "run/workspace.h"
#include "soups.h"
#include "starcontour.h"

/* What is asked where nothing is. */
extern sc_question posed_model_nothing_asked;

/* A point under a projection. */
void posed_model_project(const sc_workspace *w, const sc_projection *projection, int line,
                         uint32_t point, double *x, double *y);

static const double posed_model_pi = 3.14159265358979323846;

/* A model with a pose in its workspace, as within a query. */
typedef struct posed_model {
    const char *name;
    soup mesh; /* its positions are the rest pose */
    double *pose;
    input_choices choices;
    sc_model *model;
    sc_workspace *workspace;
} posed_model;

/* Reads s->pose, packed doubles, and makes the cones. Returns 0 after a failed CHECK. */
int posed_model_load(posed_model *s);

/* A model of a mesh, which it takes, in its rest pose. Returns 0 after a failed CHECK. */
int posed_model_open(posed_model *s, const char *name, const soup *mesh, uint32_t weld,
                     uint32_t partition);

void posed_model_close(posed_model *s);

/* About a random axis, so that flat meshes look in any direction. */
void posed_model_rotate(double *positions, uint32_t count);

/* A pose that often leaves all normals within a half-space although it folds or overlaps. */
void posed_model_any_pose(double *positions, uint32_t count);

/* The same with a random mesh of so many triangles at most, welding and partition. */
void posed_model_open_any(posed_model *s, uint32_t maximum);

/* Where a point is, and one coordinate of it. */
const double *posed_model_place(const sc_workspace *w, uint32_t point);
double posed_model_part(const sc_workspace *w, uint32_t point, int k);

/* result = v . (p - q) */
void posed_model_exact_dot(mpq_t result, const double v[3], const double *p, const double *q);

/* The projection along one direction alone has it as u x w: which one each bit is. */
void posed_model_directions(const sc_workspace *w, double directions[SC_DNC_DIRECTIONS][3]);

/* What posed_model_check_nodes counted. */
typedef struct posed_model_tally {
    uint64_t oriented, passed, touching, touching_passed;
    uint64_t simple,
        pinched;        /* passed the exact contour test; of these, two patches at one point */
    uint64_t colliding; /* oriented nodes with a pair inside, which must not pass */
} posed_model_tally;

/* Whether a triangle, given as its place, is in a patch. */
int posed_model_is_in(const sc_model *m, uint32_t patch, uint32_t place);

/* Whether the oracle's pairs, in places, have one within a node: within its whole, or, if its
   patches share one point, at least between the two. */
int posed_model_has_pair(const sc_model *m, uint32_t node, int whole, const sc_pair *pairs,
                         uint64_t count);

/* Every oriented node, under projections of some parts of its cone. */
void posed_model_check_nodes(posed_model *s, posed_model_tally *tally);

#endif
