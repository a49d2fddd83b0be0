/*
 * sc-query --step: what collides between the frames of an animation.
 *
 * SPDX-License-Identifier: MIT
 *
 * Each file is a frame of one mesh, and each two that follow each other are a step: every vertex
 * moves on a straight line from one to the next. See sc_query_step in starcontour.h for what a
 * collision is.
 */
#ifndef TOOLS_STEP_QUERY_H
#define TOOLS_STEP_QUERY_H

#include "filter_file.h"
#include "tool.h"

typedef struct step_settings {
    uint32_t weld, partition;
    uint32_t method, contour; /* SC_STEP_METHOD_..., SC_CONTOUR_... */
    double separation, tolerance;
    const char *rest_path;  /* the mesh to build from, or NULL: the first frame */
    const char *model_path; /* a saved model in its place, or NULL */
    const char *out_path;   /* where to write pairs, or NULL */
    uint64_t budget;        /* 0: none */
    uint32_t ignore_rings;  /* 0: none */
    const char *ignore_path, *groups_path;
    filter_file *filters; /* what these two say */
    double ignore_rest;   /* the distance, where ignores_rest */
    bool ignores_rest, any, times, stencils, json, stats;
    const char *record_path;      /* where to write the one step, or NULL */
    struct record_file *replayed; /* what is asked in place of all this, or NULL */
} step_settings;

/* Names of the methods, and of the contour tests. */
extern const tool_choice step_methods[];

/* Does all steps of count frames, or of those that one pattern with a number names. Returns an exit
   status; what is wrong is on standard error. */
int step_query_frames(char **paths, int count, const step_settings *set);

/* Asks what set->replayed asks, in the same way; changes *set to what that says. */
int step_query_replay(step_settings *set);

#endif /* TOOLS_STEP_QUERY_H */
