/*
 * Reads the caller's pose: the one pass over its memory.
 *
 * SPDX-License-Identifier: MIT
 *
 * What is exact reads positions where the caller has them, which stay there until the query ends;
 * all else is computed from points moved into the unit box and rounded to float.
 */
#ifndef SC_POSE_POSITIONS_H
#define SC_POSE_POSITIONS_H

#include <string.h>

#include "pose/frame.h"

/* Notes where positions are, and sets center, radius and scale. The pose was checked but for what
   this reports: SC_ERROR_NOT_FINITE. With AVX-512 about 0.2 ns a vertex if positions are packed,
   0.5 if not, 3 if not aligned. One thread does it: what several read here, each a part, would go
   from core to core again when each makes its points. The center of floats is of floats, too. */
sc_status sc_positions_read(const sc_model *model, const sc_pose *pose, uint64_t stride,
                            sc_frame *frame);

/* Moves the unit box of a frame, of which the box of all points is known: gives it a center, with
   the radius and scale for that; or the scale for a radius below 2^exponent. */
void sc_positions_move(sc_frame *frame, const double center[3]);
void sc_positions_scale(sc_frame *frame, int exponent);

/* Notes where the positions of a pose are. */
void sc_positions_note(const sc_model *model, const sc_pose *pose, uint64_t stride,
                       sc_positions *positions);

/* The nearest float. By way of memory: gcc 12 at -O3 takes two numbers that are rounded to floats
   next to each other for ones that need not be. */
static inline double sc_positions_rounded(double number)
{
    volatile float rounded = (float)number;
    return (double)rounded;
}

/* Where that of a point is. */
static inline const unsigned char *sc_positions_place(const sc_positions *positions, uint32_t point)
{
    return positions->at + point * positions->stride;
}

/* The position of a point. */
static inline void sc_positions_get(const sc_positions *positions, uint32_t point,
                                    double position[3])
{
    const unsigned char *at = sc_positions_place(positions, point);
    if (positions->type == SC_DOUBLE) {
        memcpy(position, at, 3 * sizeof *position);
    } else {
        float f[3];
        memcpy(f, at, sizeof f);
        position[0] = (double)f[0];
        position[1] = (double)f[1];
        position[2] = (double)f[2];
    }
}

/* The position as four readable doubles, of which the last means nothing: where they are, or in
   *copy. */
static inline const double *sc_positions_at(const sc_positions *positions, uint32_t point,
                                            double copy[4])
{
    if (point < positions->in_place)
        return (const double *)(const void *)(positions->at + point * positions->stride);
    sc_positions_get(positions, point, copy);
    copy[3] = 0;
    return copy;
}

/* A point of a pose in the unit box: moved by the center, rounded to float and scaled, or scaled
   first where that is beyond floats. */
static inline void sc_positions_unit(const sc_frame *frame, uint32_t point, float unit[3])
{
    const double scale = frame->scale;
    double p[3];
    int k;
    sc_positions_get(&frame->positions[0], point, p);
    for (k = 0; k < 3; k++) {
        double moved = p[k] - frame->center[k];
        unit[k] = frame->fits_float ? (float)moved * (float)scale : (float)(moved * scale);
    }
}

#endif
