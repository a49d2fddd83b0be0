/*
 * Many meshes, or poses of one: a line of JSON for each, appended to a file in their order
 * (--jsonl).
 *
 * SPDX-License-Identifier: MIT
 *
 * Each mesh is read and asked about by a process of its own (apart.h). One that is refused, crashes
 * its reader or exceeds a limit has a line that says why. Up to --jobs of them run at a time, some
 * ahead of the line that is written next; lines wait in memory for those before them.
 *
 * The bytes of the file depend on the meshes, the options and the version of the library only, but
 * for what limits of time and memory refuse. So a run can be ended at any time, and --resume goes
 * on: the lines that are there are compared with what this run would write as far as that is known
 * beforehand (version, file, options), not done again. A process that is killed by SIGKILL from
 * outside is started again once: what ends the whole run may end its readers first.
 */
#ifndef TOOLS_BATCH_H
#define TOOLS_BATCH_H

#include "query_settings.h"

#include <cjson/cJSON.h>

/* Prints the object of a file, or why there is none, to standard output; returns TOOL_.... */
typedef int (*batch_work)(void *user, const char *path);

/* What lines are about: what is asked is known by them when a run goes on. */
typedef struct batch_lines {
    const char *type;      /* of the objects: "mesh", "near" */
    const char *found;     /* the status of a mesh that has pairs, and a member that says so */
    const char *counts[2]; /* members whose sum is the number of pairs; the second may be NULL */
    cJSON *settings;       /* members that all lines of this run have, and their values */
    const char *const *members;  /* those that settings do not have and lines have on request */
    const bool *wants;           /* for each of them whether it is asked for */
    const char *const *optional; /* those of settings that lines of other runs may not have */
} batch_lines;                   /* lists of names end with NULL */

/* Does all meshes that set names. Returns an exit status. */
int batch_run(const query_settings *set, const batch_lines *lines, batch_work work, void *user);

#endif /* TOOLS_BATCH_H */
