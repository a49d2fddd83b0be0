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
#include <zlib.h>

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
        const bool is_device = S_ISCHR(what.st_mode) || S_ISBLK(what.st_mode);
        if (is_device && file != stdin) return "a device, not a mesh";
        bytes->is_plain = S_ISREG(what.st_mode) && file != stdin;
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

/* Unpacks what gzip packed, one piece after the other. Why it cannot be done, or NULL. */
static const char *unpack(file_bytes *bytes)
{
    file_bytes out = {NULL, 0, false};
    size_t room = 0;
    z_stream stream;
    memset(&stream, 0, sizeof stream);
    if (inflateInit2(&stream, 16 + MAX_WBITS) != Z_OK) return "out of memory";
    stream.next_in = (Bytef *)bytes->data;
    size_t left = bytes->size;
    int state = Z_OK;
    const char *reason = NULL;
    while (!reason) {
        if (!make_room(&out.data, &room, out.size + 2)) {
            reason = "out of memory";
            break;
        }
        const size_t space = room - out.size - 1;
        const uInt given = left < (1u << 30) ? (uInt)left : 1u << 30;
        const uInt wanted = space < (1u << 30) ? (uInt)space : 1u << 30;
        stream.avail_in = given;
        stream.next_out = (Bytef *)out.data + out.size;
        stream.avail_out = wanted;
        state = inflate(&stream, Z_NO_FLUSH);
        left -= given - stream.avail_in;
        out.size += wanted - stream.avail_out;
        if (state == Z_STREAM_END) {
            /* what follows is another piece, or is no concern of ours, as with gzip itself */
            if (left < 2 || stream.next_in[0] != 0x1f || stream.next_in[1] != 0x8b) break;
            inflateReset(&stream);
        } else if (state == Z_MEM_ERROR) {
            reason = "out of memory";
        } else if (state == Z_BUF_ERROR && left == 0) {
            reason = "its gzip data are cut short; is the file truncated?";
        } else if (state != Z_OK && state != Z_BUF_ERROR) {
            reason = "its gzip data are damaged";
        }
    }
    inflateEnd(&stream);
    free(bytes->data);
    *bytes = out;
    return reason ? reason : out.size ? NULL : "the file is empty";
}

static bool is_packed(const file_bytes *bytes)
{
    return bytes->size > 2 && memcmp(bytes->data, "\x1f\x8b", 2) == 0;
}

size_t file_bytes_mark(const char *data, size_t size)
{
    return size >= 3 && memcmp(data, "\xef\xbb\xbf", 3) == 0 ? 3 : 0;
}

bool file_bytes_read(file_bytes *bytes, const char *path, char *error, size_t error_size)
{
    static bool has_read_input = false;
    const bool is_input = strcmp(path, "-") == 0;
    memset(bytes, 0, sizeof *bytes);
    errno = 0;
    FILE *file = is_input ? stdin : fopen(path, "rb");
    const char *reason = !file                        ? strerror(errno)
                         : is_input && has_read_input ? "standard input can be read only once"
                                                      : read_all(file, bytes);
    if (is_input)
        has_read_input = true;
    else if (file)
        fclose(file);
    if (!reason && is_packed(bytes)) reason = unpack(bytes);
    if (!reason) {
        bytes->data[bytes->size] = '\0';
        return true;
    }
    snprintf(error, error_size, "%s: %s", path, reason);
    free(bytes->data);
    memset(bytes, 0, sizeof *bytes);
    return false;
}
