/*
 * What sc-query --trace is asked.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef TOOLS_TRACE_SETTINGS_H
#define TOOLS_TRACE_SETTINGS_H

#include <stdbool.h>
#include <stdint.h>

typedef struct trace_settings {
    uint32_t weld, partition;
    const char *rest_path;  /* the mesh to build from, or NULL: each file, or the first frame */
    const char *model_path; /* a saved model in its place, or NULL */
    const char *ply_path;   /* where to write contours, or NULL */
    const char *html_path, *png_path; /* the page, and a picture of it, or NULL */
    bool list, json;
} trace_settings;

#endif /* TOOLS_TRACE_SETTINGS_H */
