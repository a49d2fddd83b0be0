/*
 * A file's bytes; see file_bytes.h.
 *
 * SPDX-License-Identifier: MIT
 */
#define _POSIX_C_SOURCE 200809L

#include "file_bytes.h"

#include <errno.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* Room for at least `wanted` bytes; false if there is no memory. */
static bool make_room(char **data, size_t *room, size_t wanted)
{
    size_t more = *room ? *room : 1 << 16;
    while (more < wanted) {
        if (more > SIZE_MAX / 2) return false;
        more *= 2;
    }
    if (more == *room) return true;
    char *grown = (char *)realloc(*data, more);
    if (!grown) return false;
    *data = grown;
    *room = more;
    return true;
}

/* Why a file could not be read, or NULL. */
static const char *read_all(FILE *file, file_bytes *bytes)
{
    struct stat what;
    size_t room = 0;
    if (fstat(fileno(file), &what) == 0) {
        if (S_ISCHR(what.st_mode) || S_ISBLK(what.st_mode)) return "a device, not a mesh";
        /* the size of what is no regular file is not known beforehand */
        if (S_ISREG(what.st_mode) && what.st_size > 0 && (uintmax_t)what.st_size < SIZE_MAX / 2 &&
            !make_room(&bytes->data, &room, (size_t)what.st_size + 2))
            return "out of memory";
    }
    for (;;) {
        if (!make_room(&bytes->data, &room, bytes->size + 2)) return "out of memory";
        errno = 0;
        const size_t got = fread(bytes->data + bytes->size, 1, room - bytes->size - 1, file);
        bytes->size += got;
        if (got == 0) break;
    }
    if (ferror(file)) return errno ? strerror(errno) : "input error";
    return bytes->size ? NULL : "the file is empty";
}

bool file_bytes_read(file_bytes *bytes, const char *path, char *error, size_t error_size)
{
    bytes->data = NULL;
    bytes->size = 0;
    errno = 0;
    FILE *file = fopen(path, "rb");
    const char *reason = file ? read_all(file, bytes) : strerror(errno);
    if (file) fclose(file);
    if (!reason) {
        bytes->data[bytes->size] = '\0';
        return true;
    }
    snprintf(error, error_size, "%s: %s", path, reason);
    free(bytes->data);
    bytes->data = NULL;
    bytes->size = 0;
    return false;
}
