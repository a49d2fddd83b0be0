/*
 * Makers of steps, a start and an end pose of one mesh, that are hard on one part of the continuous
 * query: each sits on a case that some culling step would lose if it were less careful, and its
 * harmless neighbour.
 *
 * Nothing here knows what a step's collisions are. Meshes have about 10 to 150 triangles, so that
 * all pairs can be compared and patches of several levels are still culled.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef SC_TESTS_STEPS_H
#define SC_TESTS_STEPS_H

#include "soups.h"

typedef struct step {
    const char *name;
    soup mesh;          /* positions: the rest pose */
    double *start;      /* 3 * vertex_count, */
    double *end;        /* the same */
    double separation;  /* 0, or of about the size that matters here */
    uint32_t type;      /* SC_FLOAT: all three poses hold floats */
    double size, shift; /* what step_dress multiplied by, and added to the end */
} step;

void step_free(step *s);

/* ---- contours ---- */

/* A small sheet over a large one, its contour within the other's; or over its hole. It falls
   through, or past. */
step step_nested(void);

/* Cloths and petals that share one vertex; one turns about it, past or over its neighbours. */
step step_pinch(void);

/* A disc cut from the middle outwards; the lips of the cut close, open, or cross between the
   ends. */
step step_lips(void);

/* A strip some of whose rows fold onto their neighbours and back, or over. */
step step_fold(void);

/* A sheet whose hole closes to a slit or to a point, or turns inside out. */
step step_hole(void);

/* Two discs, or the two ends of one ring, in one plane or nearly: apart at both ends, through each
   other between them. */
step step_pass(void);

/* A strip that runs into itself: its end moves over its beginning, with all normals one way. */
step step_sweep(void);

/* ---- normals ---- */

/* A sheet, part of which turns by half with different scales along and across: its normals are the
   same at both ends and opposite between them. */
step step_flip(void);

/* A disc whose outline stays, while its middle turns by half with different scales along and
   across, or its central vertex moves over the first ring. */
step step_whirl(void);

/* A closed body that is turned inside out, or pressed flat and beyond. */
step step_invert(void);

/* ---- separation ---- */

/* Smooth sheets, thin triangles, and outlines side by side, about as narrow as the separation. */
step step_thick(void);

/* ---- vertices and motions ---- */

step step_teleport(void); /* a few vertices change places or go far off */
step step_rotate(void);   /* rigid, by up to a turn: along the chords */
step step_shrink(void);   /* everything, or a part, to a point or a line, or out of it */
step step_still(void);    /* the end is the start, or off by a unit in the last place */
step step_shift(void);    /* a far common translation, and little else */
step step_sheets(void);   /* two sheets, parallel or nearly, that approach, touch or pass */
step step_graze(void);    /* small integer coordinates at both ends: exact touching is common */
step step_needle(void);   /* slivers and triangles of no area in motion */
step step_book(void);     /* many triangles on one edge, some turned onto each other */
step step_any(void);      /* any mesh of soups.h and shapes.h, any two poses */

typedef step (*step_maker)(void);

/* Turns, scales, moves and rounds both poses alike; sets the type; draws a separation. */
void step_dress(step *s);

#endif /* SC_TESTS_STEPS_H */
