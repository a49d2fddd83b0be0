/*
 * A character with a skeleton, and any number of poses of it: what datasets of people and animals
 * are like.
 *
 * SPDX-License-Identifier: MIT
 *
 * The surface is that of a body of fifteen rounded bones that blend into each other: one closed,
 * oriented manifold, standing with its arms stretched out, 1.85 high (z is up). It is made on a
 * grid (surface nets: one vertex a cell that the surface goes through, one quad an edge of the grid
 * that it cuts), of the size that gives the number of triangles that was asked for.
 *
 * Poses are made by linear blend skinning, as games and body models have it: each joint is turned
 * by angles that are even between the joint's limits, drawn by the pose's number, and vertices
 * follow the bones near them. Nothing keeps limbs apart: a hand may be in the hip, and skin folds
 * into itself where a joint is bent far. All coordinates are floats.
 *
 * The same number gives the same pose on the same machine and build. Cost: a second to make; 0.2 ms
 * a pose of 25,000 triangles.
 */
#ifndef BENCH_CHARACTER_H
#define BENCH_CHARACTER_H

#include <stdbool.h>
#include <stdint.h>

enum { CHARACTER_TRIANGLES_MIN = 2000, CHARACTER_TRIANGLES_MAX = 4000000 };

typedef struct character {
    uint32_t vertex_count, triangle_count;
    uint32_t *triangles;          /* 3 * triangle_count */
    float *rest;                  /* 3 * vertex_count */
    struct character_skin *skins; /* vertex_count */
} character;

/* Makes one of about so many triangles, CHARACTER_TRIANGLES_MIN to CHARACTER_TRIANGLES_MAX: within
   two in a hundred. False without memory; what was made is to be freed all the same. */
bool character_make(character *made, uint32_t triangles);

/* An all-zero character is allowed. */
void character_free(character *made);

/* Puts the vertices of a pose into positions, 3 * vertex_count. Threads may share a character. */
void character_pose(const character *of, uint64_t number, float *positions);

#endif /* BENCH_CHARACTER_H */
