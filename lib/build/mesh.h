/*
 * Reads the caller's mesh: checks it, welds it and numbers what is used.
 *
 * SPDX-License-Identifier: MIT
 *
 * A point is a vertex that represents itself and those welded to it, and that a triangle uses.
 */
#ifndef SC_BUILD_MESH_H
#define SC_BUILD_MESH_H

#include "base/memory.h"

/* What a vertex of the caller's is: the number of its point, or one of these. */
#define SC_SLOT_UNUSED 0xffffffffu /* no triangle uses it */
#define SC_SLOT_WELDED 0xfffffffeu /* another vertex stands for it */

/* All arrays are scratch memory. */
typedef struct sc_points {
    uint32_t vertex_count, triangle_count, point_count;
    uint32_t *slot;      /* vertex_count */
    uint32_t *triangles; /* 3 * triangle_count point numbers */
    uint32_t *id;        /* triangle_count: the caller's number of each triangle */
    double *rest;        /* 3 * point_count */
} sc_points;

/* Element e (of three scalars) of a strided position array of either type. */
void sc_mesh_read_position(const void *positions, uint32_t type, uint64_t stride, uint64_t e,
                           double position[3]);

/* Checks type and stride of a position array, which the log hears of as of's, and gives the stride
   in bytes. */
sc_status sc_mesh_position_stride(const sc_hooks *hooks, const char *of, uint32_t type,
                                  uint32_t given, uint64_t *stride);

/* Linear time but for unlucky hashing. */
sc_status sc_mesh_read(const sc_mesh *mesh, const sc_build_options *options, sc_scratch *scratch,
                       sc_points *points);

#endif
