/*
 * How thick a mesh is at each triangle: the least distance to what is not near it on the surface.
 *
 * SPDX-License-Identifier: MIT
 *
 * Made of the pairs that sc_query_near finds within a distance D: of a vertex and a face, and of
 * two edges. The distance of a pair counts for all triangles at its two features, which are those
 * that have the vertex as a corner, those that have the edge as a side, and the face. It does not
 * count if a path of edges of the mesh that is shorter than 2 D leads from a vertex of one feature
 * to a vertex of the other: then the two are near each other because the surface leads from one to
 * the other. The thickness of a triangle is the least distance that counts, and more than D if none
 * does.
 *
 * Why 2 D: on a flat sheet the way over the surface is as long as the straight one, and across an
 * edge of 90 degrees at most 1.42 times as long; a path of edges is longer by what it turns aside.
 * With triangles of fair shapes neither counts as thin, but a wedge of less than about 60 degrees
 * does, near its edge.
 *
 * What is not seen: walls within a D or so of their rim, round which a path leads; and walls of so
 * large triangles that all of their vertices are at the rim. And long triangles can be taken for
 * thin: a vertex that is near the middle of an edge of more than 4 D has no short path of edges to
 * the triangle beyond. So edges should not be much longer than D; with a few that are, pairs less
 * than three edges apart are best left out of the search.
 *
 * It is not told whether material or air is between the two: a gap that is narrower than D counts
 * like a wall. Lengths are those of the pose, in doubles, added up from the first feature on.
 *
 * Cost: a search round the first feature of each pair, which ends where the second is reached; at
 * most the vertices within 2 D along edges, for each vertex and edge that has a pair.
 */
#ifndef TOOLS_THICKNESS_H
#define TOOLS_THICKNESS_H

#include "starcontour.h"

#include <stdbool.h>
#include <stddef.h>

typedef struct thickness thickness;

/* The mesh in a pose; arrays are read until thickness_free. */
typedef struct thickness_mesh {
    const uint32_t *indices; /* 3 * triangle_count */
    uint32_t triangle_count, vertex_count;
    const uint32_t *weld_map; /* the vertex that represents each, or NULL: itself */
    const void *positions;    /* 3 * vertex_count of position_type; those of triangles finite */
    uint32_t position_type;
} thickness_mesh;

/* No pairs yet. distance is D, above 0. NULL if there is no memory. */
thickness *thickness_new(const thickness_mesh *mesh, double distance);

/* Whether a pair of sc_query_near counts; kind: SC_NEAR_VERTEX_FACE or SC_NEAR_EDGE_EDGE. Fastest
   where pairs with the same a follow each other. */
bool thickness_counts(thickness *self, uint32_t kind, sc_pair pair);

/* Adds a pair that counts, and its distance. In any order. */
void thickness_add(thickness *self, uint32_t kind, sc_pair pair, double distance);

/* For each triangle the thickness so far; HUGE_VAL: more than D. */
const double *thickness_of_triangles(const thickness *self);

void thickness_free(thickness *self);

enum { THICKNESS_BINS = 16, THICKNESS_PERCENTILES = 7 };

/* Which parts of all values the percentiles are, in percent. */
extern const uint32_t thickness_percents[THICKNESS_PERCENTILES];

/* How values are spread. */
typedef struct thickness_spread {
    double limits[THICKNESS_BINS + 1]; /* of the bins: 0 to D */
    uint64_t counts[THICKNESS_BINS];   /* from a limit on, up to the next, the last with D */
    uint64_t more;                     /* how many are more than D */
    double percentiles[THICKNESS_PERCENTILES]; /* the least value that so many percent of all values
                                                  do not exceed; HUGE_VAL: more than D */
} thickness_spread;

/* Of count values, 1 or more; false if there is no memory. */
bool thickness_find_spread(const double *values, size_t count, double distance,
                           thickness_spread *spread);

#endif /* TOOLS_THICKNESS_H */
