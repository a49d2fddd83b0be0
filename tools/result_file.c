/*
 * Files of results; see result_file.h.
 *
 * SPDX-License-Identifier: MIT
 */
#define _POSIX_C_SOURCE 200809L

#include "result_file.h"

#include "tool.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* Always false. */
static bool fail(const char *path, const char *what, char error[MESH_FILE_ERROR_SIZE])
{
    snprintf(error, MESH_FILE_ERROR_SIZE, "%s: %s: %s", path, what, strerror(errno));
    return false;
}

static bool truncate_to_lines(const result_file *file)
{
    return ftruncate(file->descriptor, (off_t)file->size) == 0 &&
           lseek(file->descriptor, (off_t)file->size, SEEK_SET) >= 0;
}

/* Whether bytes can be the beginning of a line with that start, cut anywhere, or followed by zeros
   from anywhere. */
static bool is_torn_line(const char *bytes, size_t size, const char *start)
{
    if (!start) return bytes[0] == '\0';
    for (size_t i = 0; i < size && start[i] && bytes[i]; i++) {
        if (bytes[i] != start[i]) return false;
    }
    return true;
}

/* Looks at what is there. The room grows to the longest line. */
static bool read_lines(result_file *file, result_file_start start, result_file_look look,
                       void *user, char error[MESH_FILE_ERROR_SIZE])
{
    size_t capacity = (size_t)1 << 16, held = 0;
    uint64_t index = 0;
    char *room = (char *)malloc(capacity);
    bool is_good = room != NULL;
    if (!is_good) snprintf(error, MESH_FILE_ERROR_SIZE, "%s: out of memory", file->path);
    while (is_good) {
        if (held == capacity) {
            char *larger = capacity > SIZE_MAX / 2 ? NULL : (char *)realloc(room, 2 * capacity);
            if (!larger) {
                snprintf(error, MESH_FILE_ERROR_SIZE, "%s: out of memory", file->path);
                is_good = false;
                break;
            }
            room = larger;
            capacity *= 2;
        }
        const ssize_t got = read(file->descriptor, room + held, capacity - held);
        if (got < 0 && errno == EINTR) continue;
        if (got < 0) is_good = fail(file->path, "cannot be read", error);
        if (got <= 0) break;
        held += (size_t)got;
        size_t done = 0;
        for (;;) {
            char *end = (char *)memchr(room + done, '\n', held - done);
            if (!end) break;
            *end = '\0';
            is_good = look(user, index++, room + done, error);
            if (!is_good) break;
            file->size += (uint64_t)(end + 1 - (room + done));
            done = (size_t)(end + 1 - room);
        }
        memmove(room, room + done, held - done);
        held -= done;
    }
    if (is_good && held && !is_torn_line(room, held, start(user, index))) {
        snprintf(error, MESH_FILE_ERROR_SIZE,
                 "%s: does not end as the results of this list do; it is left as it is",
                 file->path);
        is_good = false;
    }
    free(room);
    return is_good;
}

bool result_file_open(result_file *file, const char *path, bool resume, result_file_start start,
                      result_file_look look, void *user, char error[MESH_FILE_ERROR_SIZE])
{
    memset(file, 0, sizeof *file);
    file->path = path;
    file->synced = tool_clock();
    file->descriptor = open(path, O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    if (file->descriptor < 0) return fail(path, "cannot be written", error);
    struct stat status;
    struct flock lock;
    memset(&lock, 0, sizeof lock);
    lock.l_type = F_WRLCK;
    lock.l_whence = SEEK_SET;
    bool is_good = true;
    if (fstat(file->descriptor, &status) != 0 || !S_ISREG(status.st_mode)) {
        snprintf(error, MESH_FILE_ERROR_SIZE, "%s: not a file that can be gone on with", path);
        is_good = false;
    } else if (fcntl(file->descriptor, F_SETLK, &lock) != 0 &&
               (errno == EACCES || errno == EAGAIN)) {
        /* a file system without locks does without */
        snprintf(error, MESH_FILE_ERROR_SIZE, "%s: another run is writing it", path);
        is_good = false;
    } else if (status.st_size > 0 && !resume) {
        snprintf(error, MESH_FILE_ERROR_SIZE,
                 "%s: is there already; --resume goes on with it, or remove it to begin again",
                 path);
        is_good = false;
    }
    is_good = is_good && read_lines(file, start, look, user, error);
    if (is_good && !truncate_to_lines(file)) is_good = fail(path, "cannot be written", error);
    if (!is_good) close(file->descriptor);
    return is_good;
}

/* Once a second, so that a crash of the machine costs no more than that. */
static bool sync_lines(result_file *file, char error[MESH_FILE_ERROR_SIZE])
{
    file->synced = tool_clock();
    /* what cannot be synchronised says EINVAL */
    if (fsync(file->descriptor) == 0 || errno == EINVAL) return true;
    return fail(file->path, "cannot be written", error);
}

bool result_file_append(result_file *file, const char *line, size_t size,
                        char error[MESH_FILE_ERROR_SIZE])
{
    for (size_t done = 0; done < size;) {
        const ssize_t written = write(file->descriptor, line + done, size - done);
        if (written >= 0) {
            done += (size_t)written;
        } else if (errno != EINTR) {
            fail(file->path, "cannot be written", error);
            (void)truncate_to_lines(file);
            return false;
        }
    }
    file->size += size;
    return tool_clock() - file->synced < 1000 || sync_lines(file, error);
}

bool result_file_close(result_file *file, char error[MESH_FILE_ERROR_SIZE])
{
    const bool is_synced = sync_lines(file, error);
    if (close(file->descriptor) == 0 || !is_synced) return is_synced;
    return fail(file->path, "cannot be written", error);
}
