/*
 * What came of all files of a run of sc-query, or of all steps between frames.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef TOOLS_QUERY_SUMMARY_H
#define TOOLS_QUERY_SUMMARY_H

#include "tool.h"

/* One file, or a step from one to another (end, else NULL): which one of the run, from 0. */
typedef struct query_moment {
    uint64_t index, pairs;
    const char *start, *end; /* the caller's; start is NULL: there is none */
} query_moment;

/* All zero: nothing yet. */
typedef struct query_summary {
    uint64_t all, clean, colliding, incomplete, refused;
    query_moment first, worst; /* that collides: the first, and the first with the most pairs */
} query_summary;

/* Adds a file, or a step if end is not NULL; status is TOOL_..., and what collides has so many
   pairs, or 0 if they were not counted. */
void query_summary_add(query_summary *summary, int status, bool collides, const char *start,
                       const char *end, uint64_t pairs);

/* Prints it as a line of text, or as an object of JSON, if there was more than one file or step;
   false if there is no memory. */
bool query_summary_print(const query_summary *summary, bool is_step, bool json);

#endif /* TOOLS_QUERY_SUMMARY_H */
