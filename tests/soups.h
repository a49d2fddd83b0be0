/*
 * Deterministic makers of triangle soups and meshes, and deformers of poses.
 *
 * All randomness comes from the harness, so a seed gives the same soups everywhere. Positions are
 * doubles; a rest pose for float input goes through soup_round_to_float first. Sizes are small: the
 * oracle compares all pairs.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef SC_TESTS_SOUPS_H
#define SC_TESTS_SOUPS_H

#include <stdint.h>

typedef struct soup {
    uint32_t vertex_count, triangle_count;
    double *positions;   /* 3 * vertex_count */
    uint32_t *triangles; /* 3 * triangle_count */
} soup;

soup soup_make(uint32_t vertex_count, uint32_t triangle_count); /* contents unset */
soup soup_copy(const soup *source);
double *soup_copy_positions(const soup *source); /* 3 * vertex_count; the caller frees them */
void soup_free(soup *s);

/* 2 to 40 triangles on integer points 0 to range: sharing, repeats, duplicates, planes, lines,
   fans. */
soup soup_on_grid(uint32_t range);

/* 2 to 40 triangles with random coordinates, some of them slivers or of very unequal size. */
soup soup_scattered(void);

/* Meshes about 1 in size. Those that are flat lie in z = 0. */
soup soup_cloth(uint32_t across, uint32_t along);   /* a square grid in z = 0 */
soup soup_tube(uint32_t around, uint32_t along);    /* open at both ends */
soup soup_sphere(uint32_t around, uint32_t rings);  /* closed, two poles */
soup soup_annulus(uint32_t around, uint32_t rings); /* flat, one hole */
soup soup_moebius(uint32_t around, uint32_t across);
soup soup_pinched(uint32_t across);  /* two cloths, coplanar, that share one corner vertex */
soup soup_fins(uint32_t along);      /* strips of four sheets that share a line of edges */
soup soup_many(uint32_t components); /* single triangles, cloths and spheres in the unit cube */
soup soup_slivers(uint32_t count);   /* long thin triangles of one fan */
soup soup_spiral(uint32_t along, uint32_t across,
                 double turns);                      /* a ribbon, flat: lies on itself */
soup soup_flower(uint32_t petals, uint32_t across);  /* flat, at random angles around one vertex */
soup soup_branched(uint32_t around, uint32_t rings); /* a disc that goes twice around its centre */
soup soup_seams(uint32_t across); /* a cloth in which each triangle has its own vertices */
soup soup_join(const soup *a, const soup *b); /* both, with the vertices of b after those of a */

/* One of the meshes above at a random size of at most about maximum triangles; *name says which. */
soup soup_any_mesh(uint32_t maximum, const char **name);

/* Deformers. Each changes positions[0 .. 3 * count - 1]. */
void soup_smooth(double *positions, uint32_t count, double amplitude); /* random sine waves */
void soup_noise(double *positions, uint32_t count, double amplitude);
void soup_twist(double *positions, uint32_t count, double turns);  /* about the x axis */
void soup_fold(double *positions, uint32_t count);                 /* flat, at a random x */
void soup_crush(double *positions, uint32_t count);                /* one coordinate becomes 0 */
void soup_shuffle(double *positions, uint32_t count);              /* vertices change places */
void soup_snap(double *positions, uint32_t count, double step);    /* to multiples of step */
void soup_scale(double *positions, uint32_t count, double factor); /* about the origin */
void soup_move(double *positions, uint32_t count, double offset);  /* adds it to each coordinate */
void soup_nudge(double *positions, uint32_t count); /* by up to 2 units in the last place */
void soup_round_to_float(double *positions, uint32_t count); /* nearest float values */

/* A random sequence of deformers, mild or violent. */
void soup_any_pose(double *positions, uint32_t count);

#endif /* SC_TESTS_SOUPS_H */
