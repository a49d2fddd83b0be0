/*
 * The files of an animation, found by a pattern with their number, such as frame_%04d.obj.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef TOOLS_FRAME_PATHS_H
#define TOOLS_FRAME_PATHS_H

#include "mesh_file.h"

typedef struct frame_paths {
    char **paths;
    uint32_t count;
} frame_paths;

/*
 * Finds the files whose number takes the place of the one %d, or %0Nd for N digits, in a pattern;
 * %% is a percent sign. They count from 0 or 1 up to the first that is not there. On failure false,
 * error says why and nothing is to be freed.
 */
bool frame_paths_find(frame_paths *found, const char *pattern, char error[MESH_FILE_ERROR_SIZE]);

/* If a pattern is all that is given, puts the files that it finds in place of it, which last as
   long as found; otherwise found is empty. */
bool frame_paths_expand(frame_paths *found, char ***paths, int *count,
                        char error[MESH_FILE_ERROR_SIZE]);

void frame_paths_free(frame_paths *found);

#endif /* TOOLS_FRAME_PATHS_H */
