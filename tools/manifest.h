/*
 * A list of files to be done, one a line, and the part of it that one of several runs does.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef TOOLS_MANIFEST_H
#define TOOLS_MANIFEST_H

#include "mesh_file.h"

typedef struct manifest {
    char **paths; /* count */
    uint64_t count;
    char *text; /* in which the paths stand; NULL: they are somebody else's */
} manifest;

/*
 * Reads a list, "-" from standard input. A line is a path as it stands, but for a carriage return
 * at its end; lines without a character are left out. On failure false, error says why, beginning
 * with the path, and nothing is to be freed.
 */
bool manifest_read(manifest *list, const char *path, char error[MESH_FILE_ERROR_SIZE]);

void manifest_free(manifest *list);

/* Part i of n, both from 1 on, of count entries: those from *first up to, not including, *end. The
   parts follow each other, so their results, one after the other, are those of the whole. */
void manifest_part(uint64_t count, uint32_t i, uint32_t n, uint64_t *first, uint64_t *end);

#endif /* TOOLS_MANIFEST_H */
