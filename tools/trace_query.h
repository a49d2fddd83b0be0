/*
 * sc-query --trace: the contours of the intersections of a mesh, or of poses of one.
 *
 * SPDX-License-Identifier: MIT
 *
 * Each file is a mesh of its own, or a pose of one that is built once: of --rest or --model, or the
 * frames that a pattern names. See sc_trace in starcontour.h for what a contour is.
 */
#ifndef TOOLS_TRACE_QUERY_H
#define TOOLS_TRACE_QUERY_H

#include "trace_settings.h"

/* Does count files, or those of one pattern with a number. Returns an exit status; what is wrong is
   on standard error. */
int trace_query_files(char **paths, int count, const trace_settings *set);

#endif /* TOOLS_TRACE_QUERY_H */
