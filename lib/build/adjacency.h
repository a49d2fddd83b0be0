/*
 * Half-edges, edges, the triangles round each point, and the closed fans among them.
 *
 * SPDX-License-Identifier: MIT
 *
 * Half-edge h = 3 t + k runs from corner k of triangle t to the next corner. Two half-edges are
 * opposite if they are all there is of their edge and run against each other; whatever else meets
 * at an edge has no opposite, as at a boundary. So the walk round a point, next(opposite(h)), is a
 * permutation whatever the mesh.
 */
#ifndef SC_BUILD_ADJACENCY_H
#define SC_BUILD_ADJACENCY_H

#include "build/mesh.h"

/* All arrays are scratch memory. */
typedef struct sc_adjacency {
    uint32_t edge_count, boundary_edges, irregular_edges;
    uint32_t component_count; /* parts that share no point */
    uint32_t *opposite;       /* 3 * triangle_count half-edges or SC_NONE */
    uint8_t *owned; /* triangle_count: bit k if side k names its edge: the one of all its sides
                               whose triangle has the caller's lowest number */
    uint32_t *corner_first; /* point_count + 1: where the corners of each point start in corners */
    uint32_t *corners;      /* 3 * triangle_count half-edges that start at the point */
} sc_adjacency;

static inline uint32_t sc_adjacency_next(uint32_t h)
{
    return h % 3 == 2 ? h - 2 : h + 1;
}

static inline uint32_t sc_adjacency_previous(uint32_t h)
{
    return h % 3 == 0 ? h + 2 : h - 1;
}

/* O(n log n) at worst in the number of edges at a point, linear otherwise. */
sc_status sc_adjacency_build(const sc_points *points, sc_scratch *scratch, sc_adjacency *adjacency);

/* Gives back what only walks need: all but which sides name their edges. */
void sc_adjacency_give_walks(sc_adjacency *adjacency, sc_scratch *scratch);

/* lowest: point_count; becomes the lowest number of a point in the same component, for each
   point. */
void sc_adjacency_find_components(const sc_points *points, uint32_t *lowest);

#endif
