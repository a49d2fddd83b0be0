/*
 * The list of scenes, and writing them to folders; see scene.h.
 *
 * SPDX-License-Identifier: MIT
 */
#define _POSIX_C_SOURCE 200809L

#include "scenes/scene.h"

#include "scene_folder.h"
#include "scenes/motion.h"

#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* Raised whenever a scene changes, so that what is cached is made anew. */
enum { SCENE_VERSION = 1 };

enum { FRAMES = 60, KINDS = 12 };

static const uint32_t sizes_twisted[] = {4096, 16384, 65536, 262144, 1048576, 0};
static const uint32_t sizes_draped[] = {20000, 80000, 320000, 0};
static const uint32_t sizes_cat[] = {41000, 165000, 0};
static const uint32_t sizes_bunny[] = {3400, 13600, 54500, 0};
static const uint32_t sizes_horse[] = {1600, 6300, 25000, 0};
static const uint32_t sizes_wrinkled[] = {100352, 0};
static const uint32_t sizes_sphere[] = {81920, 327680, 0};

static const uint32_t sizes_crushed[] = {92416, 0};
static const uint32_t sizes_rods[] = {98304, 0};

static const scene_kind kinds[KINDS] = {
    {"twisted-cloth", "square cloth, two ends twisted against each other", sizes_twisted, FRAMES},
    {"cloth-sphere", "cloth that falls on a sphere and wraps round it", sizes_draped, FRAMES},
    {"cat", "cat that walks, by skinning", sizes_cat, FRAMES},
    {"bunny", "soft bunny that rolls down a hill", sizes_bunny, FRAMES},
    {"bunny-bumpy", "the same with smooth bumps", sizes_bunny, FRAMES},
    {"bunny-spiky", "the same with sharp spikes", sizes_bunny, FRAMES},
    {"horse", "hollow horse that is sucked empty", sizes_horse, FRAMES},
    {"wrinkled-cloth", "cloth that falls into a heap of many layers", sizes_wrinkled, FRAMES},
    {"sphere", "closed sphere that wobbles, never touching itself", sizes_sphere, FRAMES},
    {"crushed-cloth", "cloth rolled up and dented: tight layers", sizes_crushed, FRAMES},
    {"tight-rods", "bundle of rods close to each other, wrung and pinched", sizes_rods, FRAMES},
    {"squeezed-rods", "the same bundle, pressed together along its whole length", sizes_rods,
     FRAMES},
};

/* In the same order. */
static const scene_start starts[KINDS] = {
    scene_start_twisted_cloth, scene_start_cloth_sphere,   scene_start_cat,
    scene_start_bunny,         scene_start_bunny_bumpy,    scene_start_bunny_spiky,
    scene_start_horse,         scene_start_wrinkled_cloth, scene_start_sphere,
    scene_start_crushed_cloth, scene_start_tight_rods,     scene_start_squeezed_rods,
};

const scene_kind *scene_kinds(size_t *count)
{
    *count = KINDS;
    return kinds;
}

int scene_fail(char *error, size_t error_size, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    if (error_size > 0) vsnprintf(error, error_size, format, arguments);
    va_end(arguments);
    return -1;
}

double scene_ease(double low, double high, double x)
{
    const double t = fmin(fmax((x - low) / (high - low), 0.0), 1.0);
    return t * t * (3.0 - 2.0 * t);
}

/* A value from -1 to 1 for each point of the integer grid. */
static double grid_value(int64_t x, int64_t y, int64_t z, uint32_t seed)
{
    uint64_t h = (uint64_t)seed * UINT64_C(0x9e3779b97f4a7c15);
    const uint64_t coordinates[3] = {(uint64_t)x, (uint64_t)y, (uint64_t)z};
    for (int k = 0; k < 3; k++) {
        h = (h ^ coordinates[k]) * UINT64_C(0xbf58476d1ce4e5b9);
        h ^= h >> 29;
    }
    h *= UINT64_C(0x94d049bb133111eb);
    return (double)(h >> 11) / 4503599627370496.0 - 1.0; /* 53 bits over 2^52 */
}

double scene_noise(double x, double y, double z, uint32_t seed)
{
    const double at[3] = {2.0 * x, 2.0 * y, 2.0 * z};
    int64_t cell[3];
    double weight[3][2], sum = 0.0;
    for (int k = 0; k < 3; k++) {
        cell[k] = (int64_t)floor(at[k]);
        weight[k][1] = scene_ease(0.0, 1.0, at[k] - floor(at[k]));
        weight[k][0] = 1.0 - weight[k][1];
    }
    for (int corner = 0; corner < 8; corner++) {
        const int i = corner & 1, j = corner >> 1 & 1, k = corner >> 2;
        sum += weight[0][i] * weight[1][j] * weight[2][k] *
               grid_value(cell[0] + i, cell[1] + j, cell[2] + k, seed);
    }
    return sum;
}

/* ------------------------------------------------------------------------------------------------
 * Making.
 */

static void free_motion(scene_motion *motion)
{
    free(motion->triangles);
    free(motion->order);
    if (motion->free_state)
        motion->free_state(motion->state);
    else
        free(motion->state);
}

static int write_frames(const scene_motion *motion, scene_writer *writer, uint32_t frames,
                        double *positions, scene_progress progress, void *user, char *error,
                        size_t error_size)
{
    const size_t count = 3 * (size_t)motion->vertex_count;
    for (uint32_t frame = 0; frame < frames; frame++) {
        const double time = frames > 1 ? (double)frame / (double)(frames - 1) : 0.0;
        motion->pose(motion->state, time, positions);
        for (size_t i = 0; i < count; i++) positions[i] = (double)(float)positions[i];
        if (scene_writer_frame(writer, positions, error, error_size) != 0) return -1;
        if (progress) progress(user, frame + 1, frames);
    }
    return 0;
}

static int find_kind(const char *name, char *error, size_t error_size)
{
    for (int k = 0; k < KINDS; k++) {
        if (strcmp(name, kinds[k].name) == 0) return k;
    }
    return scene_fail(error, error_size, "%s: there is no such scene", name);
}

int scene_make(const char *name, uint32_t triangles, uint32_t frames, const char *folder,
               scene_progress progress, void *user, char *error, size_t error_size)
{
    const int kind = find_kind(name, error, error_size);
    if (kind < 0) return -1;
    if (triangles == 0 || frames == 0 || triangles > UINT32_MAX / 64) {
        return scene_fail(error, error_size, "%s: %s", name,
                          frames == 0 ? "at least one frame is needed"
                                      : "the number of triangles is 0 or too large");
    }
    scene_motion motion;
    memset(&motion, 0, sizeof motion);
    int result = starts[kind](&motion, triangles, error, error_size);
    double *positions = NULL;
    if (result == 0) {
        positions = (double *)malloc(3 * (size_t)motion.vertex_count * sizeof *positions);
        if (!positions) result = scene_fail(error, error_size, "%s: out of memory", name);
    }
    if (result == 0) {
        scene_writer *writer =
            scene_writer_begin(folder, motion.triangle_count, motion.vertex_count, motion.triangles,
                               motion.order, true, error, error_size);
        result = writer ? 0 : -1;
        if (writer) {
            result =
                write_frames(&motion, writer, frames, positions, progress, user, error, error_size);
            const int ended = scene_writer_end(writer, result == 0, error, error_size);
            if (result == 0) result = ended;
        }
    }
    free(positions);
    free_motion(&motion);
    return result;
}

/* ------------------------------------------------------------------------------------------------
 * Keeping.
 */

static const char *const parts[] = {"version.txt", "meta.txt",   "tris.u32",
                                    "order.u32",   "frames.f64", "frames.f32"};

/* Removes a folder and what a scene puts there. */
static void remove_scene(const char *folder)
{
    char path[4200];
    for (size_t k = 0; k < sizeof parts / sizeof parts[0]; k++) {
        if (snprintf(path, sizeof path, "%s/%s", folder, parts[k]) < (int)sizeof path) remove(path);
    }
    rmdir(folder);
}

/* Makes a folder and those above it. */
static bool make_folders(const char *path)
{
    char part[4200];
    const size_t length = strlen(path);
    if (length >= sizeof part) return false;
    for (size_t i = 1; i <= length; i++) {
        if (path[i] != '/' && path[i] != '\0') continue;
        memcpy(part, path, i);
        part[i] = '\0';
        mkdir(part, 0777);
    }
    struct stat info;
    return stat(path, &info) == 0 && S_ISDIR(info.st_mode);
}

static bool write_version(const char *folder)
{
    char path[4200];
    snprintf(path, sizeof path, "%s/version.txt", folder);
    FILE *file = fopen(path, "w");
    if (!file) return false;
    const bool written = fprintf(file, "%d\n", SCENE_VERSION) > 0;
    return fclose(file) == 0 && written;
}

/* Whether a folder holds a whole scene of this version. */
static bool is_current(const char *folder)
{
    char path[4200], error[256];
    snprintf(path, sizeof path, "%s/version.txt", folder);
    FILE *file = fopen(path, "r");
    if (!file) return false;
    int version = 0;
    const bool same = fscanf(file, "%d", &version) == 1 && version == SCENE_VERSION;
    fclose(file);
    if (!same) return false;
    scene_folder scene;
    if (scene_folder_open(folder, &scene, error, sizeof error) != 0) return false;
    scene_folder_close(&scene);
    return true;
}

int scene_cached(const char *name, uint32_t triangles, uint32_t frames, const char *cache_root,
                 scene_progress progress, void *user, char *folder, size_t folder_size, char *error,
                 size_t error_size)
{
    if (find_kind(name, error, error_size) < 0) return -1;
    const int length = snprintf(folder, folder_size, "%s/%s-%lu-%lu", cache_root, name,
                                (unsigned long)triangles, (unsigned long)frames);
    if (length < 0 || (size_t)length >= folder_size || length > 4000) {
        return scene_fail(error, error_size, "%s: the path is too long", cache_root);
    }
    if (is_current(folder)) return 0;
    if (!make_folders(cache_root)) {
        return scene_fail(error, error_size, "%s: the folder cannot be made: %s", cache_root,
                          strerror(errno));
    }
    /* Others may be making it as well: each under a name of its own. */
    char work[4100];
    snprintf(work, sizeof work, "%s.%ld.new", folder, (long)getpid());
    int result = scene_make(name, triangles, frames, work, progress, user, error, error_size);
    if (result == 0 && !write_version(work)) {
        result = scene_fail(error, error_size, "%s: cannot be written: %s", work, strerror(errno));
    }
    if (result == 0 && rename(work, folder) != 0) {
        /* Something is there: an old scene, or the one that another process has just made. */
        if (!is_current(folder)) {
            remove_scene(folder);
            errno = 0;
            if (rename(work, folder) != 0 && !is_current(folder)) {
                result = scene_fail(error, error_size, "%s: cannot be replaced: %s", folder,
                                    strerror(errno));
            }
        }
    }
    remove_scene(work);
    return result;
}
