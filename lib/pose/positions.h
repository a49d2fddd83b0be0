/*
 * Reads the caller's pose: the one pass over its memory.
 *
 * SPDX-License-Identifier: MIT
 *
 * The positions of all points are copied in the order in which the leaf clusters use them, as doubles,
 * whatever their type and stride: what follows reads them several times, close together.
 */
#ifndef SC_POSE_POSITIONS_H
#define SC_POSE_POSITIONS_H

#include "pose/workspace.h"

/* Fills position, unit, center, radius and scale. The pose was checked but for what this reports:
   SC_ERROR_NOT_FINITE. About 3 ns a vertex. */
sc_status sc_positions_read(const sc_model *model, const sc_pose *pose, uint64_t stride,
                            sc_workspace *workspace);

#endif
