/*
 * Animated scenes: one mesh and its vertex positions frame by frame, from a folder or from a
 * sequence of mesh files.
 *
 * SPDX-License-Identifier: MIT
 *
 * A scene's folder holds
 *     meta.txt    its first line: "triangles vertices frames", three numbers
 *     tris.u32    three little-endian uint32 a triangle: its vertices, from 0
 *     frames.f64  or frames.f32: little-endian doubles or floats, frames x vertices x 3
 *     order.u32   may be missing: the triangles in an order whose consecutive parts are compact
 *                 patches, for SC_PARTITION_ORDER; a permutation of 0 to triangles - 1
 *
 * What does not fit together (sizes, numbers out of range, coordinates that are not finite) is
 * refused with a message that names the file. One frame at a time is in memory; reading it is
 * linear. Calls return 0, or -1 with a message in error, which is never NULL.
 */
#ifndef BENCH_SCENE_FOLDER_H
#define BENCH_SCENE_FOLDER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct scene_folder {
    uint32_t triangle_count, vertex_count, frame_count;
    uint32_t *triangles; /* 3 * triangle_count */
    uint32_t *order;     /* triangle_count, or NULL */
    bool single;         /* all coordinates are floats */
    struct scene_source *source;
} scene_folder;

/* Opens a folder. On failure *scene is all zero. */
int scene_folder_open(const char *path, scene_folder *scene, char *error, size_t error_size);

/*
 * Opens a sequence of mesh files of any format that mesh_file.h reads; the first gives the
 * triangles, and all must have the same faces in the same order. scene_folder_open_files takes a
 * list; scene_folder_open_pattern a printf pattern with one %d, such as "run/%04d.obj" (flags 0 and
 * width only; %% is a percent sign): the numbers from 0 or 1, whichever is there, until one is
 * missing.
 */
int scene_folder_open_files(const char *const *paths, uint32_t count, scene_folder *scene,
                            char *error, size_t error_size);
int scene_folder_open_pattern(const char *pattern, scene_folder *scene, char *error,
                              size_t error_size);

/* Reads a frame, 0 to frame_count - 1, in any order. positions has room for 3 * vertex_count. */
int scene_folder_frame(scene_folder *scene, uint32_t frame, double *positions, char *error,
                       size_t error_size);

/* Frees everything and makes *scene all zero; an all-zero scene is allowed. */
void scene_folder_close(scene_folder *scene);

/*
 * Writes count frames from `first` on as PATH/frame_0000.obj and so on, named by their numbers in
 * the scene, which has them all; the folder is made. Digits are enough to read back the same
 * doubles, and so the same floats.
 */
int scene_folder_export_obj(scene_folder *scene, uint32_t first, uint32_t count, const char *path,
                            char *error, size_t error_size);

/* Writes the scene to a folder as described above, as doubles or as floats (rounded to nearest). */
int scene_folder_export(scene_folder *scene, const char *path, bool single, char *error,
                        size_t error_size);

/*
 * Writing a folder frame by frame. Begin makes the folder; meta.txt is written by end, so that what
 * was broken off cannot be opened. End must be called once after a begin that succeeded; with
 * complete false it only frees.
 */
typedef struct scene_writer scene_writer;
scene_writer *scene_writer_begin(const char *path, uint32_t triangle_count, uint32_t vertex_count,
                                 const uint32_t *triangles, const uint32_t *order, bool single,
                                 char *error, size_t error_size);
int scene_writer_frame(scene_writer *writer, const double *positions, char *error,
                       size_t error_size);
int scene_writer_end(scene_writer *writer, bool complete, char *error, size_t error_size);

#endif /* BENCH_SCENE_FOLDER_H */
