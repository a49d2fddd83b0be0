/*
 * How sc-query tells closest points, of --near and of --step.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef TOOLS_STENCIL_TEXT_H
#define TOOLS_STENCIL_TEXT_H

#include "starcontour.h"

#include <cjson/cJSON.h>

/* "vertex-vertex" and so on, of SC_FEATURE_.... */
const char *stencil_text_feature(uint32_t feature);

/* Prints feature, vertices with their weights, and vector, with a space before each. */
void stencil_text_print(const sc_near_stencil *stencil);

/* Adds the same as members; the distance is the caller's to add. */
void stencil_text_add(cJSON *object, const sc_near_stencil *stencil);

/* Adds three numbers, 0 without a sign. */
void stencil_text_add_vector(cJSON *object, const char *name, const double vector[3]);

#endif /* TOOLS_STENCIL_TEXT_H */
