/*
 * What sc-query --near is asked.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef TOOLS_NEAR_SETTINGS_H
#define TOOLS_NEAR_SETTINGS_H

#include "filter_file.h"

#include <stdbool.h>

typedef struct near_settings {
    double distance;
    uint32_t kinds, method; /* SC_NEAR_..., SC_NEAR_METHOD_... */
    uint32_t weld, partition;
    const char *rest_path;  /* the mesh to build from, or NULL: each file, or the first frame */
    const char *model_path; /* a saved model in its place, or NULL */
    const char *out_path;   /* where to write pairs, or NULL */
    const char *ply_path;   /* where to write the mesh in colours, or NULL */
    const char *ignore_path, *groups_path;
    filter_file *filters;  /* what these two say */
    double ignore_rest;    /* the distance, where ignores_rest */
    uint32_t ignore_rings; /* 0: none */
    uint64_t budget;       /* 0: none */
    bool ignores_rest, any, list, stencils, thickness, json, stats, timings;
    bool is_line; /* of --jsonl: what grows with the mesh is left out */
    const char *record_path;      /* where to write the one search, or NULL */
    struct record_file *replayed; /* what is asked in place of all this, or NULL */
} near_settings;

#endif /* TOOLS_NEAR_SETTINGS_H */
