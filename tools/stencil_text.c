/*
 * Closest points as text; see stencil_text.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "stencil_text.h"

#include <stdio.h>

const char *stencil_text_feature(uint32_t feature)
{
    static const char *const names[] = {"", "vertex-vertex", "vertex-edge", "edge-edge",
                                        "vertex-face"};
    return names[feature];
}

void stencil_text_print(const sc_near_stencil *stencil)
{
    printf(" %s", stencil_text_feature(stencil->feature));
    for (int i = 0; i < 4; i++) {
        if (stencil->weights[i] != 0)
            printf(" %lu:%.17g", (unsigned long)stencil->vertices[i], stencil->weights[i]);
    }
    fputs(" vector", stdout);
    for (int i = 0; i < 3; i++) printf(" %.17g", stencil->vector[i] + 0.0); /* no -0 */
    if (stencil->flags & SC_STENCIL_PARALLEL) fputs(" parallel", stdout);
}

void stencil_text_add_vector(cJSON *object, const char *name, const double vector[3])
{
    const double plain[3] = {vector[0] + 0.0, vector[1] + 0.0, vector[2] + 0.0}; /* no -0 */
    cJSON_AddItemToObject(object, name, cJSON_CreateDoubleArray(plain, 3));
}

void stencil_text_add(cJSON *object, const sc_near_stencil *stencil)
{
    cJSON_AddStringToObject(object, "feature", stencil_text_feature(stencil->feature));
    cJSON_AddBoolToObject(object, "parallel", (stencil->flags & SC_STENCIL_PARALLEL) != 0);
    cJSON *vertices = cJSON_AddArrayToObject(object, "vertices");
    for (int i = 0; i < 4; i++)
        cJSON_AddItemToArray(vertices, cJSON_CreateNumber(stencil->vertices[i]));
    cJSON_AddItemToObject(object, "weights", cJSON_CreateDoubleArray(stencil->weights, 4));
    stencil_text_add_vector(object, "vector", stencil->vector);
}
