/*
 * How sc-query tells the thickness of a file's faces, which count alike, whatever their size.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef TOOLS_THICKNESS_TEXT_H
#define TOOLS_THICKNESS_TEXT_H

#include "thickness.h"

#include <cjson/cJSON.h>

/* Prints a histogram and percentiles. */
void thickness_text_print(const thickness_spread *spread);

/* Adds them as "thickness", with the values of all faces unless values is NULL. */
void thickness_text_add(cJSON *object, const thickness_spread *spread, const double *values,
                        size_t count);

#endif /* TOOLS_THICKNESS_TEXT_H */
