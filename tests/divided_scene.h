/*
 * A scene of tests of regions: a mesh, its contours, and the regions between them.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef SC_TESTS_DIVIDED_SCENE_H
#define SC_TESTS_DIVIDED_SCENE_H

#include "trace_scene.h"

/* A scene and its regions. */
typedef struct divided_scene {
    trace_scene s;
    sc_regions_result regions;
} divided_scene;

/* A result without arrays. */
sc_regions_result no_regions(void);

/* Takes the mesh. Asks for the count first. 0 if a check failed; undivide in any case. */
int divide(divided_scene *d, soup mesh);
void undivide(divided_scene *d);

/* Two spheres, one of them moved, a little uneven; and what the first one has. */
soup two_spheres(uint32_t around, double offset, double radius, uint32_t *vertices,
                 uint32_t *triangles);

/* An octahedron whose lower half z = 0 cuts in the middle: in a square of the area r^2 / 2. */
soup octahedron(double r);

/* Adds s to all, and frees it. */
void add_soup(soup *all, soup s);

#endif
