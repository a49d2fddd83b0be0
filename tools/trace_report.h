/*
 * What sc-query --trace prints and writes of a pose: a row of the table with its longest contours,
 * or an object of JSON, and contours as lines of a PLY file.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef TOOLS_TRACE_REPORT_H
#define TOOLS_TRACE_REPORT_H

#include "tool.h"
#include "trace_settings.h"

/* A contour and, if regions are asked for, what is on both sides of it. */
typedef struct trace_listed {
    sc_trace_contour contour;
    sc_contour_sides sides;
} trace_listed;

/* What there is to know about a pose. */
typedef struct trace_answer {
    const char *path;
    sc_model_info info;
    double build_ms, query_ms, trace_ms;
    uint64_t pair_count, node_count, contour_count;
    const sc_trace_node *nodes;
    trace_listed *contours;         /* the longest first: see trace_report_sort */
    uint64_t triple_count;          /* points where three sheets meet */
    const sc_trace_triple *triples; /* triple_count */
    uint64_t region_count;          /* 0 unless regions are asked for */
    const sc_region *regions;       /* region_count */
    const uint32_t *vertex_regions; /* of each vertex of the mesh as it was read */
    bool rounded, has_animation;    /* as in mesh_file */
    uint32_t position_type;         /* of the pose */
} trace_answer;

/* Puts the longest contours first; of equal length they stay as sc_trace has them. */
void trace_report_sort(trace_answer *answer);

/* How a contour begins and ends: SC_TRACE_... */
extern const tool_choice trace_ends[];

/* How many are closed, and how long all are together. */
uint64_t trace_report_closed(const trace_answer *answer);
double trace_report_length(const trace_answer *answer);

/* The head of the table. */
void trace_report_head(const trace_settings *set);

/* Prints what came of a trace. Returns the exit status. */
int trace_report(const trace_answer *answer, const trace_settings *set);

/* Says why a file could not be done: as a message, and as an object if there is JSON. Returns
   TOOL_FAILED. */
int trace_report_failure(const char *path, const trace_settings *set, const char *error);

/* Writes the file of --ply; otherwise says why not. */
bool trace_report_ply(const trace_answer *answer, const trace_settings *set);

#endif /* TOOLS_TRACE_REPORT_H */
