/*
 * sc-query --near: what comes within a distance in a mesh, or in the poses of one.
 *
 * SPDX-License-Identifier: MIT
 *
 * Each file is a mesh of its own, or a pose of one that is built once: of --rest or --model, or the
 * frames that a pattern names. See sc_query_near in starcontour.h for what is near.
 */
#ifndef TOOLS_NEAR_QUERY_H
#define TOOLS_NEAR_QUERY_H

#include "filter_file.h"
#include "tool.h"

typedef struct near_settings {
    double distance;
    uint32_t kinds, method; /* SC_NEAR_..., SC_NEAR_METHOD_... */
    uint32_t weld, partition;
    const char *rest_path;  /* the mesh to build from, or NULL: each file, or the first frame */
    const char *model_path; /* a saved model in its place, or NULL */
    const char *out_path;   /* where to write pairs, or NULL */
    const char *ply_path;   /* where to write the mesh in colours, or NULL */
    const char *groups_path;
    filter_file *filters;  /* what that says */
    uint32_t ignore_rings; /* 0: none */
    uint64_t budget;       /* 0: none */
    bool any, list, stencils, json, stats;
} near_settings;

/* Values of --kinds, and of --method with --near. */
extern const tool_choice near_kinds[], near_methods[];

/* Does count files, or those of one pattern with a number. Returns an exit status; what is wrong is
   on standard error. */
int near_query_files(char **paths, int count, const near_settings *set);

#endif /* TOOLS_NEAR_QUERY_H */
