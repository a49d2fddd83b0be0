/*
 * Scenes of several objects with random meshes and poses, and one mesh of all of them. For tests of
 * queries about objects.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef TESTS_OBJECT_SCENES_H
#define TESTS_OBJECT_SCENES_H

#include <stdint.h>

#include "soups.h"
#include "starcontour.h"

enum { OBJECTS_MAX = 20 };

/* An object with what it is made of. */
typedef struct thing {
    soup mesh;   /* its positions are the rest pose */
    int is_copy; /* mesh and model are those of another one */
    uint32_t weld;
    sc_model *model;
    sc_workspace *workspace;
    uint32_t workers; /* that it is for */
    uint32_t lender; /* whose room it has, counted from 1: its own, where others may use it, or that
                         of an object before it; 0: its own */
    double *posed[2]; /* 3 * vertex_count, at the start and at the end of a step */
    float *floats[2]; /* the same, if the poses are of floats */
    int is_float;
    sc_pose pose[2];
} thing;

typedef struct scene {
    uint32_t count, workers;
    uint32_t flags; /* of workspaces */
    thing things[OBJECTS_MAX];
    sc_object objects[OBJECTS_MAX];
    uint64_t state; /* of random numbers, to make it again */
} scene;

/* Up to so many objects of up to so many triangles; 0: a model or workspace is not there, and a
   check has failed. */
int scene_open(scene *s, uint32_t most, uint32_t maximum, uint32_t workers, uint32_t flags);
void scene_close(scene *s);

/* Object i, the next one: of a random mesh, of a mesh that it takes over, or (NULL) of the mesh and
   the model of the one before it. */
int scene_open_thing(scene *s, uint32_t i, uint32_t maximum);
int scene_open_thing_of(scene *s, uint32_t i, const soup *mesh);

/* Has all asked in new workspaces. 0: one is not there, and a check has failed. */
int scene_renew_work(scene *s);

/* Poses an object near the others, often on a grid or in the place of another one; and for the end
   of a step some way from there. */
void scene_pose_thing(scene *s, uint32_t i);

/* Whether groups let two collide, or each object `itself`. */
int scene_asks_for(const scene *s, uint32_t a, uint32_t b);

/* One mesh of all objects, in which nothing of one is welded to anything of another. */
typedef struct whole_scene {
    uint32_t count, first_vertex[OBJECTS_MAX], first_triangle[OBJECTS_MAX];
    soup mesh;
    double *posed[2];
    sc_pose pose[2];
    sc_model *model;
    sc_workspace *workspace; /* for one worker */
} whole_scene;

int whole_scene_open(whole_scene *whole, const scene *s);
void whole_scene_close(whole_scene *whole);

/* The object of a number of the whole, and its number there: first is one of the arrays above. */
uint32_t whole_scene_split(const whole_scene *whole, const uint32_t *first, uint32_t *number);

/* What is to be found: pairs with their objects, and times if there are any. */
typedef struct found {
    uint32_t object_a, object_b, a, b;
    double time;
} found;

typedef struct found_list {
    found *at;
    uint64_t count;
} found_list;

/* For qsort: the order in which the library reports pairs of objects. */
int found_compare(const void *x, const void *y);

/* How many ranges a list in this order has. */
uint64_t found_list_ranges(const found_list *wanted);

#endif
