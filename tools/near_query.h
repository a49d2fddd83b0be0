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

#include "query_settings.h"

/* Does count files, or those of one pattern with a number. Returns an exit status; what is wrong is
   on standard error. */
int near_query_files(char **paths, int count, const near_settings *set);

/* Does many meshes, or poses of one, with a line of JSON each: see batch.h. set->near is what is
   asked. */
int near_query_batch(const query_settings *set);

/* Asks what set->replayed asks, in the same way; changes *set to what that says. */
int near_query_replay(near_settings *set);

#endif /* TOOLS_NEAR_QUERY_H */
