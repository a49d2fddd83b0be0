/*
 * A file's bytes, read whole and once, so that pipes can be read as files are, and unpacked by zlib
 * if they are packed by gzip, whatever the name says.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef TOOLS_FILE_BYTES_H
#define TOOLS_FILE_BYTES_H

#include <stdbool.h>
#include <stddef.h>

typedef struct file_bytes {
    char *data; /* size bytes and a 0 behind them; to be freed by free */
    size_t size;
    bool is_plain; /* the bytes stand in a file as they are, which can be read again */
} file_bytes;

/*
 * Reads a file or pipe, or standard input if path is "-", which can be read only once. On failure
 * error, of error_size characters, says why, beginning with the path, and *bytes is empty. A file
 * without any byte, and a device, are failures.
 */
bool file_bytes_read(file_bytes *bytes, const char *path, char *error, size_t error_size);

/* The length of the mark that some programs put before text in UTF-8, if size bytes begin with it.
   */
size_t file_bytes_mark(const char *data, size_t size);

#endif /* TOOLS_FILE_BYTES_H */
