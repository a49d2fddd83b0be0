/*
 * What sc-query prints and writes of a pose: a row of the table or an object of JSON, pairs as
 * comma-separated values, and the mesh with its places coloured.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef TOOLS_QUERY_REPORT_H
#define TOOLS_QUERY_REPORT_H

#include "places.h"
#include "query_settings.h"

#include <cjson/cJSON.h>

/* The head of the table, and of the file of pairs. */
void query_report_head(const query_settings *set);
void query_report_pairs_head(FILE *out, const query_settings *set);

/* Prints what came of a query, and writes its pairs to out unless that is NULL. Returns the exit
   status. */
int query_report(const query_answer *answer, const query_settings *set, const query_list *list,
                 FILE *out);

/* Says why a file could not be done: as a message, and as an object if there is JSON. Returns
   TOOL_FAILED. */
int query_report_failure(const char *path, const query_settings *set, const char *error);

/* Adds what was asked, as the objects of files have it. */
void query_report_add_settings(cJSON *object, const query_settings *set);

/* Writes the file of --ply; otherwise says why not. */
bool query_report_ply(const mesh_file *mesh, const sc_pose *pose, const query_settings *set,
                      const place_list *places);

#endif /* TOOLS_QUERY_REPORT_H */
