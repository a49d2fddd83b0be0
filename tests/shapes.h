/*
 * Meshes and deformations that are hard on culling: spirals over themselves, hubs, bent bodies; and
 * a reader of the binary PLY files that `make meshes` writes.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef SC_TESTS_SHAPES_H
#define SC_TESTS_SHAPES_H

#include "soups.h"

/* A strip round the z axis, of any number of turns, with all normals up. tilt 0: flat; otherwise
   its slope across changes with the angle, so that turns cross properly where they overlap. */
soup shape_spiral(uint32_t along, uint32_t across, double turns, double tilt);

/* A disc: one point in the middle of valence triangles, and a second ring of triangles round
   them. */
soup shape_hub(uint32_t valence);

/* Three sheets that share a line of edges, and a copy of one of them upside down. */
soup shape_fan_of_sheets(uint32_t along);

/* A closed, lumpy body along the x axis, from 0 to 1. */
soup shape_body(uint32_t around, uint32_t rings);

/* A cloth some of whose triangles are replaced: repeated corners, copies of others, turned over. */
soup shape_broken_cloth(uint32_t side);

/* Two triangles that share one or two points, each sixteen times. */
soup shape_copies(uint32_t shared);

/* One of the meshes of soups.h and of those above, of about maximum triangles; *name says which. */
soup shape_any(uint32_t maximum, const char **name);

/* Bends what lies along the x axis from 0 to 1 into an arc of this many turns in the x y plane. */
void shape_bend(double *positions, uint32_t count, double turns);

/* Reads the binary little-endian PLY files of meshes/: float x, y, z and faces of three int. 0 if
   there is no such file. */
int shape_read_ply(const char *path, soup *s);

#endif /* SC_TESTS_SHAPES_H */
