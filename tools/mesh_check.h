/*
 * What a checker of assets lists besides self-collisions: open and non-manifold edges, inconsistent
 * orientation, degenerate and duplicate faces, and the parts of a mesh with whether each is closed.
 *
 * SPDX-License-Identifier: MIT
 *
 * Vertices are joined as the library joins them: by a map that gives for each vertex the number of
 * the one that stands for it (mesh_file_weld_map), or NULL, where none are joined. Parts are sets
 * of triangles that share vertices then. All is exact, and linear in the number of triangles.
 */
#ifndef TOOLS_MESH_CHECK_H
#define TOOLS_MESH_CHECK_H

#include "mesh_file.h"

#include "starcontour.h"

/* A part. Triangles with two equal vertices have no edges here. */
typedef struct mesh_part {
    uint32_t first;              /* its lowest triangle */
    uint32_t triangle_count;     /* with degenerate ones */
    uint32_t sides;              /* of triangles with three different vertices */
    uint32_t open_edges;         /* of one triangle */
    uint32_t non_manifold_edges; /* of three or more */
    uint32_t misoriented_edges;  /* of two that run the same way along it */
} mesh_part;

/* What depends on the triangles alone. */
typedef struct mesh_check {
    mesh_part *parts;           /* part_count, in the order of their first triangles */
    uint32_t *part_of_triangle; /* one for each triangle */
    uint32_t part_count, closed_parts;
    uint32_t open_edges, non_manifold_edges, misoriented_edges; /* of all parts */
    uint32_t duplicate_faces; /* triangles with the vertices of an earlier one, in any order */
} mesh_check;

/* Looks at a mesh, by the threads of tasks, or by one if that is NULL: with the same result. False,
   and *check is empty, if there is no memory. */
bool mesh_check_make(mesh_check *check, const mesh_file *mesh, const uint32_t *weld_map,
                     const sc_tasks *tasks);

/* Frees the arrays and empties the check. An all-zero one is allowed. */
void mesh_check_free(mesh_check *check);

/* Whether a part is closed: each edge is one of exactly two triangles. */
bool mesh_part_is_closed(const mesh_part *part);

/*
 * How many triangles have no area in a pose: their vertices are on a line or in a point. Exact as
 * long as products of two coordinates neither overflow nor underflow: from about 1e-140 to 1e140.
 * tasks: threads, or NULL.
 */
uint32_t mesh_check_degenerate(const mesh_file *mesh, const void *positions, uint32_t position_type,
                               const sc_tasks *tasks);

/* Sets of numbers from 0, as a forest: each begins as its own set. The set of an item is told by
   its lowest number. */
uint32_t mesh_sets_find(uint32_t *parents, uint32_t item);
void mesh_sets_join(uint32_t *parents, uint32_t one, uint32_t other);

#endif /* TOOLS_MESH_CHECK_H */
