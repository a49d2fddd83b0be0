/*
 * Where a mesh collides: its colliding pairs, joined into places.
 *
 * SPDX-License-Identifier: MIT
 *
 * A place is a connected set of colliding triangles: two of them are in one place if they collide
 * with each other, or if they share a vertex. Vertices are joined as in mesh_check.h. A pair of an
 * edge and a triangle counts as one of the two triangles.
 */
#ifndef TOOLS_PLACES_H
#define TOOLS_PLACES_H

#include "mesh_check.h"
#include "mesh_file.h"

#include "starcontour.h"

/* One place. */
typedef struct place {
    uint64_t pairs;
    uint32_t triangle_count; /* in place_list.triangles from `begin` on, ascending */
    uint32_t face_count;     /* of the file's own faces that they are parts of */
    size_t begin;
    /* The objects of the file, if it names any, and the parts of the mesh that collide here: lists
       in place_list.owners, ascending. */
    size_t objects, parts;
    uint32_t object_count, part_count;
    double low[3], high[3]; /* the box round the points, segments and areas in which pairs meet */
    double depth;           /* set by place_depth.h; negative: not known */
} place;

/* All places of a pose, those with the most faces first; then those with the most pairs. */
typedef struct place_list {
    place *places; /* count */
    uint32_t count;
    uint32_t triangle_count; /* that collide */
    uint32_t *triangles;     /* by places */
    uint32_t *owners;
    /* Where pairs meet, of the first PLACES_SEGMENTS and in their order: two ends each, which are
       equal for a point; of an area, two of its corners. */
    double (*segments)[2][3];
    uint32_t segment_count;
} place_list;

enum { PLACES_SEGMENTS = 1000000 };

/* What places are made of. */
typedef struct place_source {
    const mesh_file *mesh;
    const uint32_t *weld_map; /* or NULL */
    const mesh_check *check;
    const sc_model *model;
    const sc_pose *pose;
    uint32_t kind; /* of pairs: SC_PAIRS_... */
    const sc_pair *pairs;
    uint64_t pair_count;
    const sc_tasks *tasks; /* threads, or NULL */
} place_source;

/* Finds all places. On failure *list is empty. */
sc_status places_make(place_list *list, const place_source *source);

/* Frees the arrays and empties the list. An all-zero one is allowed. */
void places_free(place_list *list);

/* The two triangles of a pair, of which the first may be an edge's. */
void places_triangles(uint32_t kind, sc_pair pair, uint32_t triangle[2]);

/* The middle and the sides of a place's box. */
void place_center(const place *one, double center[3]);
void place_size(const place *one, double size[3]);

/* Red, green and blue of the places that follow each other in a list; they begin again. The first
   one is red. */
void place_color(uint32_t number, uint8_t color[3]);

#endif /* TOOLS_PLACES_H */
