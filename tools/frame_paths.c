/*
 * The files of an animation; see frame_paths.h.
 *
 * SPDX-License-Identifier: MIT
 */
#define _POSIX_C_SOURCE 200809L

#include "frame_paths.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* Cuts a pattern at its %d: the text before, the text after, and the width of the number. The two
   have room for the pattern. */
static bool cut_pattern(const char *pattern, char *before, char *after, int *width)
{
    char *out = before;
    bool found = false;
    *width = 0;
    for (const char *at = pattern; *at; at++) {
        if (*at != '%') {
            *out++ = *at;
        } else if (at[1] == '%') {
            *out++ = *at++;
        } else {
            if (found) return false;
            found = true;
            const char *digits = ++at;
            while (*at >= '0' && *at <= '9') at++;
            /* Without the flag 0 the number would be padded by blanks. */
            if (*at != 'd' || at - digits > 3 || (at > digits && *digits != '0')) return false;
            if (at > digits) *width = (int)strtol(digits, NULL, 10);
            *out = '\0';
            out = after;
        }
    }
    *out = '\0';
    return found;
}

static bool file_is_there(const char *path)
{
    struct stat info;
    return stat(path, &info) == 0;
}

static bool add_path(frame_paths *found, const char *path)
{
    const size_t count = (size_t)found->count + 1;
    char **paths = (char **)realloc(found->paths, count * sizeof *paths);
    if (!paths) return false;
    found->paths = paths;
    paths[found->count] = (char *)malloc(strlen(path) + 1);
    if (!paths[found->count]) return false;
    strcpy(paths[found->count++], path);
    return true;
}

bool frame_paths_find(frame_paths *found, const char *pattern, char error[MESH_FILE_ERROR_SIZE])
{
    int width;
    const size_t length = strlen(pattern), path_size = 2 * length + 1100;
    char *before = (char *)malloc(length + 1), *after = (char *)malloc(length + 1);
    char *path = (char *)malloc(path_size);
    bool done = before && after && path;
    memset(found, 0, sizeof *found);
    if (!done) {
        snprintf(error, MESH_FILE_ERROR_SIZE, "%s: out of memory", pattern);
    } else if (!cut_pattern(pattern, before, after, &width)) {
        snprintf(error, MESH_FILE_ERROR_SIZE,
                 "%s: not a pattern with one number, such as frame_%%04d.obj", pattern);
        done = false;
    }
    for (uint32_t number = 0; done; number++) {
        snprintf(path, path_size, "%s%0*lu%s", before, width, (unsigned long)number, after);
        if (file_is_there(path)) {
            done = add_path(found, path);
            if (!done) snprintf(error, MESH_FILE_ERROR_SIZE, "%s: out of memory", path);
        } else if (number > 0) {
            break;
        }
    }
    if (done && found->count == 0) {
        snprintf(error, MESH_FILE_ERROR_SIZE, "%s: there is no file with number 0 or 1", pattern);
        done = false;
    }
    free(before);
    free(after);
    free(path);
    if (!done) frame_paths_free(found);
    return done;
}

bool frame_paths_expand(frame_paths *found, char ***paths, int *count,
                        char error[MESH_FILE_ERROR_SIZE])
{
    memset(found, 0, sizeof *found);
    if (*count != 1 || !strchr((*paths)[0], '%')) return true;
    if (!frame_paths_find(found, (*paths)[0], error)) return false;
    *paths = found->paths;
    *count = (int)found->count;
    return true;
}

void frame_paths_free(frame_paths *found)
{
    for (uint32_t i = 0; i < found->count; i++) free(found->paths[i]);
    free(found->paths);
    memset(found, 0, sizeof *found);
}
