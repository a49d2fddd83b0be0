/*
 * A file of results, one a line, that a run appends to and a later run goes on with.
 *
 * SPDX-License-Identifier: MIT
 *
 * A line is written by one call, whole, so a run that is killed leaves whole lines, and at most one
 * that the system cut short; after a crash of the machine, lines of the last second can be missing
 * and bytes at the end can be 0. Going on drops what is after the last line end. One process at a
 * time has the file: it is locked.
 */
#ifndef TOOLS_RESULT_FILE_H
#define TOOLS_RESULT_FILE_H

#include "mesh_file.h"

typedef struct result_file {
    const char *path;
    int descriptor;
    double synced; /* tool_clock() when the lines so far were last sent to the disk */
    uint64_t size; /* of its whole lines, in bytes */
} result_file;

/* Looks at line number index, whose end is a 0 in place of the line end. False if it is not what
   this run would have written there: error says so. */
typedef bool (*result_file_look)(void *user, uint64_t index, const char *line,
                                 char error[MESH_FILE_ERROR_SIZE]);

/* What line number index has to begin with; NULL: there is no such line. Valid until the next
   call. */
typedef const char *(*result_file_start)(void *user, uint64_t index);

/*
 * Opens the file, or makes it. What is in it already is looked at, line by line; without resume a
 * file that is not empty is refused, as is one that something else seems to have written: then it
 * is left as it is. On failure false, error says why, beginning with the path.
 */
bool result_file_open(result_file *file, const char *path, bool resume, result_file_start start,
                      result_file_look look, void *user, char error[MESH_FILE_ERROR_SIZE]);

/* Appends a line, with its line end. On failure nothing of it stays, and error says why. */
bool result_file_append(result_file *file, const char *line, size_t size,
                        char error[MESH_FILE_ERROR_SIZE]);

/* Sends all lines to the disk and closes the file. */
bool result_file_close(result_file *file, char error[MESH_FILE_ERROR_SIZE]);

#endif /* TOOLS_RESULT_FILE_H */
