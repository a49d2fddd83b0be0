/*
 * Makers of poses that sit on the edge of a culling step: contours that close on themselves to
 * within a unit in the last place, normals at right angles to a direction of the cones, doubled and
 * pinched patches, triangles that touch where boxes and filters are rounded.
 *
 * A maker draws a mesh of about 10 to 40 triangles, the smallest that culls at all, and names its
 * twins: vertices that belong where another one is. adversary_dress turns, scales and moves the
 * pose, and only then puts each twin on the other, off by a few units in the last place, so that
 * rounding before does not matter.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef SC_TESTS_ADVERSARIES_H
#define SC_TESTS_ADVERSARIES_H

#include <stdint.h>

#include "soups.h"

typedef struct adversary {
    soup mesh;
    uint32_t *twin;    /* vertex_count: the vertex it takes the position of, or SC_NONE */
    uint32_t ulps;     /* how far off in each coordinate at most: 0 to 2 units in the last place */
    uint32_t split;    /* the first triangles, this many, make a patch of their own; 0: none do */
    int is_aligned;    /* the directions of its edges matter: not to be turned */
    int is_small;      /* to be scaled to where products underflow */
    uint32_t type;     /* SC_FLOAT: adversary_dress has rounded all coordinates to float */
    double size, move; /* what adversary_dress has multiplied by, then added */
} adversary;

void adversary_free(adversary *a);

/* Discs of fans of triangles, cut from the middle outwards; the lips of the cut are twins, or open
   by an angle from 0.5 down to nothing, or overlap by one. The fan in the middle is the split. */
adversary adversary_slit(void);

/* Strips, once round: the end lies where it began, or beside it with a corner touching. */
adversary adversary_strip(void);

/* Two to four petals round a vertex, each up to half a turn, their lips twins. The first is the
   split. */
adversary adversary_petals(void);

/* A cloth and copies of its triangles, as they are or turned over, on the same vertices or
   twins. */
adversary adversary_doubled(void);

/* A cloth in a plane through direction number bit of the cones (see pose/dnc.c), or off by 1e-17
   up. */
adversary adversary_edge_on(const double direction[3]);

/* A cloth with slivers, vertices on others and on edges between others. */
adversary adversary_degenerate(void);

adversary adversary_moebius(void);
adversary adversary_klein(void); /* the figure-eight immersion: it always meets itself */

/* 3 to 20 triangles on one edge, and as many behind them. */
adversary adversary_book(void);

/* Two sheets on each other, nothing to 1e-3 apart; the first is the split. */
adversary adversary_sheets(void);

/* A parallelogram with two sides that are vertical or horizontal under the projection of a flat
   mesh, but for an angle from 1e-13 to 1e-6; cut or whole. */
adversary adversary_upright(void);

/* A cloth of 1e-7 to 1e-19 in length, and of a height at which floats underflow. */
adversary adversary_shallow(void);

/* A fan with corners on one ray from the middle, or on opposite ones, and a ring round it; once or
   twice round. */
adversary adversary_ring(void);

/* Pairs of triangles, far from each other in size, that touch at coordinates between two floats. */
adversary adversary_corners(void);

/* Pairs of triangles, a corner of one in the other's face or edge but for rounding; some
   coplanar. */
adversary adversary_faces(void);

/* Turns, scales from denormal to near overflow, moves, rounds to float; then places the twins. */
void adversary_dress(adversary *a);

#endif /* SC_TESTS_ADVERSARIES_H */
