/*
 * What sc-query prints of any question: statistics and fields of tables; and how statuses add up.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef TOOLS_QUERY_TEXT_H
#define TOOLS_QUERY_TEXT_H

#include "tool.h"

#include <cjson/cJSON.h>

/* Names of SC_CONTOUR_... */
extern const tool_choice query_text_contours[];

/* The worse of two exit statuses: failures first, then what is not known, then collisions. */
int query_text_worse(int a, int b);

/* Milliseconds to a tenth of a microsecond. */
double query_text_rounded(double milliseconds);

/* Writes a field of comma-separated values (RFC 4180): quoted where it must be. */
void query_text_field(FILE *out, const char *text);

/* The tasks of a query and what became of the test tree, as lines of text, or as "stats" of an
   object. */
void query_text_stats(const sc_stats *stats);
void query_text_add_stats(cJSON *object, const sc_stats *stats);

#endif /* TOOLS_QUERY_TEXT_H */
