/*
 * Animated scenes; see scene_folder.h.
 *
 * SPDX-License-Identifier: MIT
 */
#define _POSIX_C_SOURCE 200809L
#define _FILE_OFFSET_BITS 64

#include "scene_folder.h"

#include "frame_paths.h"
#include "mesh_file.h"

#include <errno.h>
#include <float.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/types.h>

/* Where frames come from: a file of numbers, or mesh files. */
typedef struct scene_source {
    FILE *file;            /* NULL: mesh files */
    char *path;            /* of file */
    uint8_t *bytes;        /* one frame as it stands in file */
    size_t number_size;    /* 8 or 4 */
    mesh_file rest;        /* of mesh files */
    char **paths;          /* frame_count */
    uint32_t paths_length; /* how many of them there are so far */
} scene_source;

struct scene_writer {
    char *folder;
    FILE *file;
    char *path; /* of file */
    uint8_t *bytes;
    size_t number_size;
    uint32_t triangle_count, vertex_count, frame_count;
};

#if defined(__GNUC__)
__attribute__((format(printf, 3, 4)))
#endif
static int
fail(char *error, size_t error_size, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    if (error_size > 0) vsnprintf(error, error_size, format, arguments);
    va_end(arguments);
    return -1;
}

static char *copy_text(const char *text)
{
    char *copy = (char *)malloc(strlen(text) + 1);
    if (copy) strcpy(copy, text);
    return copy;
}

/* FOLDER/NAME as a new string, or NULL. */
static char *join_path(const char *folder, const char *name)
{
    const size_t size = strlen(folder) + strlen(name) + 2;
    char *path = (char *)malloc(size);
    if (path) snprintf(path, size, "%s/%s", folder, name);
    return path;
}

/* ------------------------------------------------------------------------------------------------
 * Little-endian numbers, whatever the machine's order is.
 */

static uint32_t get_uint32(const uint8_t *bytes)
{
    return (uint32_t)bytes[0] | (uint32_t)bytes[1] << 8 | (uint32_t)bytes[2] << 16 |
           (uint32_t)bytes[3] << 24;
}

static void put_uint32(uint8_t *bytes, uint32_t value)
{
    for (int k = 0; k < 4; k++) bytes[k] = (uint8_t)(value >> (8 * k));
}

static double get_number(const uint8_t *bytes, size_t size)
{
    if (size == sizeof(float)) {
        const uint32_t bits = get_uint32(bytes);
        float value;
        memcpy(&value, &bits, sizeof value);
        return (double)value;
    }
    const uint64_t bits = (uint64_t)get_uint32(bytes) | (uint64_t)get_uint32(bytes + 4) << 32;
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static void put_number(uint8_t *bytes, size_t size, double value)
{
    if (size == sizeof(float)) {
        const float single = (float)value;
        uint32_t bits;
        memcpy(&bits, &single, sizeof bits);
        put_uint32(bytes, bits);
        return;
    }
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    put_uint32(bytes, (uint32_t)bits);
    put_uint32(bytes + 4, (uint32_t)(bits >> 32));
}

/* ------------------------------------------------------------------------------------------------
 * Opening a folder.
 */

static int64_t file_size(FILE *file)
{
    struct stat info;
    return fstat(fileno(file), &info) == 0 && S_ISREG(info.st_mode) ? (int64_t)info.st_size : -1;
}

static int read_meta(const char *path, scene_folder *scene, char *error, size_t error_size)
{
    errno = 0;
    FILE *file = fopen(path, "rb");
    if (!file) return fail(error, error_size, "%s: %s", path, strerror(errno));
    char line[128];
    const bool read = fgets(line, sizeof line, file) != NULL;
    fclose(file);
    uint32_t counts[3];
    char *at = line;
    for (int k = 0; k < 3; k++) {
        while (read && (*at == ' ' || *at == '\t')) at++;
        if (!read || *at < '0' || *at > '9') {
            return fail(error, error_size,
                        "%s: must begin with the numbers of triangles, vertices and frames", path);
        }
        errno = 0;
        const unsigned long long value = strtoull(at, &at, 10);
        if (errno || value == 0 || value > UINT32_MAX / 3) {
            return fail(error, error_size, "%s: a number is 0 or too large", path);
        }
        counts[k] = (uint32_t)value;
    }
    if (strspn(at, " \t\r\n") != strlen(at)) {
        return fail(error, error_size, "%s: more than three numbers in its first line", path);
    }
    scene->triangle_count = counts[0];
    scene->vertex_count = counts[1];
    scene->frame_count = counts[2];
    return 0;
}

/* Reads a file of exactly count uint32 below limit as a new array. A missing file is no error if
   optional: *numbers is NULL then. */
static int read_numbers(const char *path, uint64_t count, uint32_t limit, bool optional,
                        uint32_t **numbers, char *error, size_t error_size)
{
    *numbers = NULL;
    errno = 0;
    FILE *file = fopen(path, "rb");
    if (!file) {
        if (optional && errno == ENOENT) return 0;
        return fail(error, error_size, "%s: %s", path, strerror(errno));
    }
    int result = -1;
    const int64_t size = file_size(file);
    if (size < 0 || (uint64_t)size != 4 * count) {
        fail(error, error_size, "%s: has %lld bytes, but meta.txt asks for %llu", path,
             (long long)size, (unsigned long long)(4 * count));
    } else if (!(*numbers = (uint32_t *)malloc((size_t)(4 * count)))) {
        fail(error, error_size, "%s: out of memory", path);
    } else if (fread(*numbers, 4, (size_t)count, file) != count) {
        fail(error, error_size, "%s: cannot be read", path);
    } else {
        result = 0;
        for (uint64_t i = 0; i < count && result == 0; i++) {
            uint8_t bytes[4];
            memcpy(bytes, *numbers + i, 4);
            (*numbers)[i] = get_uint32(bytes);
            if ((*numbers)[i] < limit) continue;
            result =
                fail(error, error_size, "%s: entry %llu is %lu, but must be below %lu", path,
                     (unsigned long long)i, (unsigned long)(*numbers)[i], (unsigned long)limit);
        }
    }
    fclose(file);
    if (result != 0) {
        free(*numbers);
        *numbers = NULL;
    }
    return result;
}

static int check_permutation(const char *path, const uint32_t *order, uint32_t count, char *error,
                             size_t error_size)
{
    uint8_t *seen = (uint8_t *)calloc(count, 1);
    if (!seen) return fail(error, error_size, "%s: out of memory", path);
    int result = 0;
    for (uint32_t i = 0; i < count && result == 0; i++) {
        if (seen[order[i]]++) {
            result = fail(error, error_size, "%s: triangle %lu is there twice", path,
                          (unsigned long)order[i]);
        }
    }
    free(seen);
    return result;
}

/* Opens frames.f64, or else frames.f32, and checks its size. */
static int open_frames(const char *folder, scene_folder *scene, char *error, size_t error_size)
{
    scene_source *source = scene->source;
    static const char *const names[2] = {"frames.f64", "frames.f32"};
    for (int k = 0; k < 2 && !source->file; k++) {
        free(source->path);
        source->path = join_path(folder, names[k]);
        if (!source->path) return fail(error, error_size, "%s: out of memory", folder);
        source->number_size = k == 0 ? sizeof(double) : sizeof(float);
        errno = 0;
        source->file = fopen(source->path, "rb");
        if (!source->file && errno != ENOENT) {
            return fail(error, error_size, "%s: %s", source->path, strerror(errno));
        }
    }
    if (!source->file) {
        return fail(error, error_size, "%s: neither frames.f64 nor frames.f32 is there", folder);
    }
    scene->single = source->number_size == sizeof(float);
    const uint64_t frame_size = 3 * (uint64_t)scene->vertex_count * source->number_size;
    const int64_t size = file_size(source->file);
    /* Products of three 32-bit numbers may not fit: compare quotients. */
    if (size < 0 || (uint64_t)size % frame_size != 0 ||
        (uint64_t)size / frame_size != scene->frame_count) {
        return fail(error, error_size,
                    "%s: has %lld bytes, but meta.txt asks for %lu frames of %llu bytes",
                    source->path, (long long)size, (unsigned long)scene->frame_count,
                    (unsigned long long)frame_size);
    }
    source->bytes = (uint8_t *)malloc((size_t)frame_size);
    if (!source->bytes) return fail(error, error_size, "%s: out of memory", source->path);
    return 0;
}

static int open_parts(const char *folder, scene_folder *scene, char *paths[3], char *error,
                      size_t error_size)
{
    static const char *const names[3] = {"meta.txt", "tris.u32", "order.u32"};
    for (int k = 0; k < 3; k++) paths[k] = join_path(folder, names[k]);
    scene->source = (scene_source *)calloc(1, sizeof *scene->source);
    if (!scene->source || !paths[0] || !paths[1] || !paths[2]) {
        return fail(error, error_size, "%s: out of memory", folder);
    }
    if (read_meta(paths[0], scene, error, error_size) != 0 ||
        read_numbers(paths[1], 3 * (uint64_t)scene->triangle_count, scene->vertex_count, false,
                     &scene->triangles, error, error_size) != 0 ||
        read_numbers(paths[2], scene->triangle_count, scene->triangle_count, true, &scene->order,
                     error, error_size) != 0) {
        return -1;
    }
    if (scene->order &&
        check_permutation(paths[2], scene->order, scene->triangle_count, error, error_size) != 0) {
        return -1;
    }
    return open_frames(folder, scene, error, error_size);
}

int scene_folder_open(const char *path, scene_folder *scene, char *error, size_t error_size)
{
    char *paths[3] = {NULL, NULL, NULL};
    memset(scene, 0, sizeof *scene);
    const int result = open_parts(path, scene, paths, error, error_size);
    for (int k = 0; k < 3; k++) free(paths[k]);
    if (result != 0) scene_folder_close(scene);
    return result;
}

/* ------------------------------------------------------------------------------------------------
 * Opening mesh files.
 */

static int add_path(scene_source *source, const char *path)
{
    const size_t count = (size_t)source->paths_length + 1;
    char **paths = (char **)realloc(source->paths, count * sizeof *paths);
    if (!paths) return -1;
    source->paths = paths;
    paths[source->paths_length] = copy_text(path);
    if (!paths[source->paths_length]) return -1;
    source->paths_length++;
    return 0;
}

/* Whether the first file, which is read, and all others have nothing but floats. Those that cannot
   be read are told of when their turn comes. */
static bool are_floats(const scene_source *source)
{
    bool single = source->rest.position_type == SC_FLOAT;
    for (uint32_t i = 1; single && i < source->paths_length; i++) {
        char message[MESH_FILE_ERROR_SIZE];
        mesh_pose pose;
        if (!mesh_file_read_pose(&source->rest, source->paths[i], &pose, message)) continue;
        single = pose.position_type == SC_FLOAT;
        mesh_pose_free(&pose);
    }
    return single;
}

/* The paths are in source: reads the first of them. */
static int open_rest(scene_folder *scene, char *error, size_t error_size)
{
    scene_source *source = scene->source;
    char message[MESH_FILE_ERROR_SIZE];
    struct stat info;
    for (uint32_t i = 0; i < source->paths_length; i++) {
        if (stat(source->paths[i], &info) == 0 && S_ISFIFO(info.st_mode))
            return fail(error, error_size, "%s: a pipe, but frames are read more than once",
                        source->paths[i]);
    }
    if (!mesh_file_read(&source->rest, source->paths[0], message)) {
        return fail(error, error_size, "%s", message);
    }
    source->rest.face_hash = mesh_file_hash(&source->rest);
    const size_t corners = 3 * (size_t)source->rest.triangle_count;
    scene->triangle_count = source->rest.triangle_count;
    scene->vertex_count = source->rest.vertex_count;
    scene->frame_count = source->paths_length;
    scene->single = are_floats(source);
    scene->triangles = (uint32_t *)malloc(corners * sizeof(uint32_t));
    if (!scene->triangles) {
        return fail(error, error_size, "%s: out of memory", source->paths[0]);
    }
    memcpy(scene->triangles, source->rest.indices, corners * sizeof(uint32_t));
    for (size_t c = 0; c < corners; c++) {
        if (scene->triangles[c] >= scene->vertex_count) {
            return fail(error, error_size, "%s: a face names a vertex that does not exist",
                        source->paths[0]);
        }
    }
    return 0;
}

int scene_folder_open_files(const char *const *paths, uint32_t count, scene_folder *scene,
                            char *error, size_t error_size)
{
    memset(scene, 0, sizeof *scene);
    if (count == 0) return fail(error, error_size, "a sequence needs at least one file");
    int result = -1;
    scene->source = (scene_source *)calloc(1, sizeof *scene->source);
    for (uint32_t i = 0; scene->source && i < count; i++) {
        if (add_path(scene->source, paths[i]) != 0) break;
    }
    if (!scene->source || scene->source->paths_length < count) {
        fail(error, error_size, "out of memory");
    } else {
        result = open_rest(scene, error, error_size);
    }
    if (result != 0) scene_folder_close(scene);
    return result;
}

int scene_folder_open_pattern(const char *pattern, scene_folder *scene, char *error,
                              size_t error_size)
{
    char message[MESH_FILE_ERROR_SIZE];
    frame_paths found;
    memset(scene, 0, sizeof *scene);
    if (!frame_paths_find(&found, pattern, message)) return fail(error, error_size, "%s", message);
    const int result = scene_folder_open_files((const char *const *)found.paths, found.count, scene,
                                               error, error_size);
    frame_paths_free(&found);
    return result;
}

/* ------------------------------------------------------------------------------------------------
 * Frames.
 */

/* Reads a frame's numbers; *name is the file, for messages. */
static int read_frame(scene_folder *scene, uint32_t frame, double *positions, const char **name,
                      char *error, size_t error_size)
{
    scene_source *source = scene->source;
    const size_t count = 3 * (size_t)scene->vertex_count;
    if (!source->file) {
        char message[MESH_FILE_ERROR_SIZE];
        *name = source->paths[frame];
        mesh_pose pose;
        if (!mesh_file_read_pose(&source->rest, *name, &pose, message)) {
            return fail(error, error_size, "%s", message);
        }
        for (size_t v = 0; v < scene->vertex_count; v++) {
            mesh_file_position(pose.positions, pose.position_type, v, positions + 3 * v);
        }
        mesh_pose_free(&pose);
        return 0;
    }
    *name = source->path;
    const uint64_t start = (uint64_t)frame * count * source->number_size;
    if (fseeko(source->file, (off_t)start, SEEK_SET) != 0 ||
        fread(source->bytes, source->number_size, count, source->file) != count) {
        return fail(error, error_size, "%s: frame %lu cannot be read", *name, (unsigned long)frame);
    }
    for (size_t i = 0; i < count; i++) {
        positions[i] = get_number(source->bytes + i * source->number_size, source->number_size);
    }
    return 0;
}

int scene_folder_frame(scene_folder *scene, uint32_t frame, double *positions, char *error,
                       size_t error_size)
{
    const char *name;
    if (frame >= scene->frame_count) {
        return fail(error, error_size, "frame %lu: there are only %lu", (unsigned long)frame,
                    (unsigned long)scene->frame_count);
    }
    if (read_frame(scene, frame, positions, &name, error, error_size) != 0) return -1;
    for (size_t i = 0; i < 3 * (size_t)scene->vertex_count; i++) {
        if (isfinite(positions[i])) continue;
        return fail(error, error_size, "%s: frame %lu: vertex %lu is not finite", name,
                    (unsigned long)frame, (unsigned long)(i / 3));
    }
    return 0;
}

void scene_folder_close(scene_folder *scene)
{
    scene_source *source = scene->source;
    if (source) {
        if (source->file) fclose(source->file);
        for (uint32_t i = 0; i < source->paths_length; i++) free(source->paths[i]);
        free(source->paths);
        free(source->path);
        free(source->bytes);
        mesh_file_free(&source->rest);
        free(source);
    }
    free(scene->triangles);
    free(scene->order);
    memset(scene, 0, sizeof *scene);
}

/* ------------------------------------------------------------------------------------------------
 * Writing.
 */

/* Makes a folder; one that is there is fine. */
static int make_folder(const char *path, char *error, size_t error_size)
{
    struct stat info;
    errno = 0;
    if (mkdir(path, 0777) == 0) return 0;
    if (errno == EEXIST && stat(path, &info) == 0 && S_ISDIR(info.st_mode)) return 0;
    return fail(error, error_size, "%s: the folder cannot be made: %s", path, strerror(errno));
}

static int write_numbers(const char *folder, const char *name, const uint32_t *numbers,
                         size_t count, char *error, size_t error_size)
{
    char *path = join_path(folder, name);
    if (!path) return fail(error, error_size, "%s: out of memory", folder);
    errno = 0;
    FILE *file = fopen(path, "wb");
    bool written = file != NULL;
    for (size_t i = 0; i < count && written; i++) {
        uint8_t bytes[4];
        put_uint32(bytes, numbers[i]);
        written = fwrite(bytes, 4, 1, file) == 1;
    }
    if (file && fclose(file) != 0) written = false;
    if (!written) fail(error, error_size, "%s: cannot be written: %s", path, strerror(errno));
    free(path);
    return written ? 0 : -1;
}

/* Removes what an earlier scene may have left in the folder. */
static void remove_parts(const char *folder)
{
    static const char *const names[] = {"meta.txt", "order.u32", "frames.f64", "frames.f32"};
    for (size_t k = 0; k < sizeof names / sizeof names[0]; k++) {
        char *path = join_path(folder, names[k]);
        if (path) remove(path);
        free(path);
    }
}

static void free_writer(scene_writer *writer)
{
    if (writer->file) fclose(writer->file);
    free(writer->folder);
    free(writer->path);
    free(writer->bytes);
    free(writer);
}

scene_writer *scene_writer_begin(const char *path, uint32_t triangle_count, uint32_t vertex_count,
                                 const uint32_t *triangles, const uint32_t *order, bool single,
                                 char *error, size_t error_size)
{
    if (make_folder(path, error, error_size) != 0) return NULL;
    remove_parts(path);
    scene_writer *writer = (scene_writer *)calloc(1, sizeof *writer);
    if (!writer) {
        fail(error, error_size, "%s: out of memory", path);
        return NULL;
    }
    writer->triangle_count = triangle_count;
    writer->vertex_count = vertex_count;
    writer->number_size = single ? sizeof(float) : sizeof(double);
    writer->folder = copy_text(path);
    writer->path = join_path(path, single ? "frames.f32" : "frames.f64");
    writer->bytes = (uint8_t *)malloc(3 * (size_t)vertex_count * writer->number_size);
    if (!writer->folder || !writer->path || !writer->bytes) {
        fail(error, error_size, "%s: out of memory", path);
    } else if (write_numbers(path, "tris.u32", triangles, 3 * (size_t)triangle_count, error,
                             error_size) == 0 &&
               (!order ||
                write_numbers(path, "order.u32", order, triangle_count, error, error_size) == 0)) {
        errno = 0;
        writer->file = fopen(writer->path, "wb");
        if (writer->file) return writer;
        fail(error, error_size, "%s: cannot be written: %s", writer->path, strerror(errno));
    }
    free_writer(writer);
    return NULL;
}

int scene_writer_frame(scene_writer *writer, const double *positions, char *error,
                       size_t error_size)
{
    const size_t count = 3 * (size_t)writer->vertex_count;
    const double limit = writer->number_size == sizeof(float) ? (double)FLT_MAX : DBL_MAX;
    for (size_t i = 0; i < count; i++) {
        if (!(fabs(positions[i]) <= limit)) {
            return fail(error, error_size, "%s: frame %lu: vertex %lu is too large or not finite",
                        writer->path, (unsigned long)writer->frame_count, (unsigned long)(i / 3));
        }
        put_number(writer->bytes + i * writer->number_size, writer->number_size, positions[i]);
    }
    errno = 0;
    if (fwrite(writer->bytes, writer->number_size, count, writer->file) != count) {
        return fail(error, error_size, "%s: cannot be written: %s", writer->path, strerror(errno));
    }
    writer->frame_count++;
    return 0;
}

int scene_writer_end(scene_writer *writer, bool complete, char *error, size_t error_size)
{
    int result = 0;
    errno = 0;
    const bool closed = fclose(writer->file) == 0;
    writer->file = NULL;
    char *path = join_path(writer->folder, "meta.txt");
    if (complete && !closed) {
        result =
            fail(error, error_size, "%s: cannot be written: %s", writer->path, strerror(errno));
    } else if (complete && !path) {
        result = fail(error, error_size, "%s: out of memory", writer->folder);
    } else if (complete) {
        FILE *file = fopen(path, "w");
        bool written = file != NULL;
        if (file) {
            written = fprintf(file, "%lu %lu %lu\n", (unsigned long)writer->triangle_count,
                              (unsigned long)writer->vertex_count,
                              (unsigned long)writer->frame_count) > 0;
            if (fclose(file) != 0) written = false;
        }
        if (!written) {
            result = fail(error, error_size, "%s: cannot be written: %s", path, strerror(errno));
        }
    }
    free(path);
    free_writer(writer);
    return result;
}

int scene_folder_export(scene_folder *scene, const char *path, bool single, char *error,
                        size_t error_size)
{
    double *positions = (double *)malloc(3 * (size_t)scene->vertex_count * sizeof *positions);
    if (!positions) return fail(error, error_size, "%s: out of memory", path);
    scene_writer *writer =
        scene_writer_begin(path, scene->triangle_count, scene->vertex_count, scene->triangles,
                           scene->order, single, error, error_size);
    int result = writer ? 0 : -1;
    for (uint32_t frame = 0; frame < scene->frame_count && result == 0; frame++) {
        result = scene_folder_frame(scene, frame, positions, error, error_size);
        if (result == 0) result = scene_writer_frame(writer, positions, error, error_size);
    }
    if (writer) {
        const int ended = scene_writer_end(writer, result == 0, error, error_size);
        if (result == 0) result = ended;
    }
    free(positions);
    return result;
}

static bool write_obj(FILE *file, const scene_folder *scene, const double *positions)
{
    for (size_t v = 0; v < scene->vertex_count; v++) {
        const double *p = positions + 3 * v;
        fprintf(file, "v %.17g %.17g %.17g\n", p[0], p[1], p[2]);
    }
    for (size_t t = 0; t < scene->triangle_count; t++) {
        const uint32_t *v = scene->triangles + 3 * t;
        fprintf(file, "f %lu %lu %lu\n", v[0] + 1ul, v[1] + 1ul, v[2] + 1ul);
    }
    return !ferror(file);
}

int scene_folder_export_obj(scene_folder *scene, uint32_t first, uint32_t count, const char *path,
                            char *error, size_t error_size)
{
    if (make_folder(path, error, error_size) != 0) return -1;
    double *positions = (double *)malloc(3 * (size_t)scene->vertex_count * sizeof *positions);
    if (!positions) return fail(error, error_size, "%s: out of memory", path);
    int result = 0;
    for (uint32_t frame = first; frame < first + count && result == 0; frame++) {
        result = scene_folder_frame(scene, frame, positions, error, error_size);
        if (result != 0) break;
        char name[40];
        snprintf(name, sizeof name, "frame_%04lu.obj", (unsigned long)frame);
        char *file_path = join_path(path, name);
        if (!file_path) {
            result = fail(error, error_size, "%s: out of memory", path);
            break;
        }
        errno = 0;
        FILE *file = fopen(file_path, "w");
        bool written = file && write_obj(file, scene, positions);
        if (file && fclose(file) != 0) written = false;
        if (!written) {
            result =
                fail(error, error_size, "%s: cannot be written: %s", file_path, strerror(errno));
        }
        free(file_path);
    }
    free(positions);
    return result;
}
