/*
 * The thickness of a file's faces, of the near pairs of a pose: sc-query --near --thickness.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef TOOLS_NEAR_THICKNESS_H
#define TOOLS_NEAR_THICKNESS_H

#include "near_report.h"

/* Finds it of all faces, that of a face of several triangles being the least of theirs, and how it
   is spread. The array is the caller's to free. On failure false, and error says why. */
bool near_thickness_find(near_answer *answer, double distance, char error[MESH_FILE_ERROR_SIZE]);

#endif /* TOOLS_NEAR_THICKNESS_H */
