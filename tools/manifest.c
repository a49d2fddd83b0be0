/*
 * Lists of files; see manifest.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "manifest.h"

#include "file_bytes.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

bool manifest_read(manifest *list, const char *path, char error[MESH_FILE_ERROR_SIZE])
{
    file_bytes bytes;
    memset(list, 0, sizeof *list);
    if (!file_bytes_read(&bytes, path, error, MESH_FILE_ERROR_SIZE)) return false;
    if (memchr(bytes.data, '\0', bytes.size)) {
        snprintf(error, MESH_FILE_ERROR_SIZE, "%s: not a list of files: it has bytes that are 0",
                 path);
        free(bytes.data);
        return false;
    }
    size_t lines = 1;
    for (size_t i = 0; i < bytes.size; i++) lines += bytes.data[i] == '\n';
    list->paths =
        lines > SIZE_MAX / sizeof(char *) ? NULL : (char **)malloc(lines * sizeof(char *));
    if (!list->paths) {
        snprintf(error, MESH_FILE_ERROR_SIZE, "%s: out of memory", path);
        free(bytes.data);
        return false;
    }
    list->text = bytes.data;
    char *line = bytes.data + file_bytes_mark(bytes.data, bytes.size);
    while (line) {
        char *next = strchr(line, '\n');
        if (next) *next++ = '\0';
        const size_t length = strlen(line);
        if (length && line[length - 1] == '\r') line[length - 1] = '\0';
        if (line[0]) list->paths[list->count++] = line;
        line = next;
    }
    return true;
}

void manifest_free(manifest *list)
{
    if (list->text) free(list->paths);
    free(list->text);
    memset(list, 0, sizeof *list);
}

/* count * i / n, which would not fit for a large count. */
static uint64_t share(uint64_t count, uint32_t i, uint32_t n)
{
    return count / n * i + count % n * i / n;
}

void manifest_part(uint64_t count, uint32_t i, uint32_t n, uint64_t *first, uint64_t *end)
{
    *first = share(count, i - 1, n);
    *end = share(count, i, n);
}
