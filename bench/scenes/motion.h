/*
 * A scene while it is made: what each kind of scene gives to scene.c, and what they share.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef BENCH_MOTION_H
#define BENCH_MOTION_H

#include <stddef.h>
#include <stdint.h>

/* A mesh that moves. pose is called with times that never go back, from 0 (rest) to 1 (the end). */
typedef struct scene_motion {
    uint32_t vertex_count, triangle_count;
    uint32_t *triangles; /* 3 * triangle_count */
    uint32_t *order;     /* as in scene_folder.h, or NULL */
    void *state;
    void (*pose)(void *state, double time, double *positions); /* 3 * vertex_count */
    void (*free_state)(void *state);                           /* NULL: free */
} scene_motion;

/* Starts a motion of about this many triangles. *motion is all zero; what was put there is freed by
   the caller, on failure too. Returns 0, or -1 with a message in error. */
typedef int (*scene_start)(scene_motion *motion, uint32_t triangles, char *error,
                           size_t error_size);

int scene_start_twisted_cloth(scene_motion *, uint32_t, char *, size_t);
int scene_start_cloth_sphere(scene_motion *, uint32_t, char *, size_t);
int scene_start_wrinkled_cloth(scene_motion *, uint32_t, char *, size_t);
int scene_start_cat(scene_motion *, uint32_t, char *, size_t);
int scene_start_bunny(scene_motion *, uint32_t, char *, size_t);
int scene_start_bunny_bumpy(scene_motion *, uint32_t, char *, size_t);
int scene_start_bunny_spiky(scene_motion *, uint32_t, char *, size_t);
int scene_start_horse(scene_motion *, uint32_t, char *, size_t);
int scene_start_sphere(scene_motion *, uint32_t, char *, size_t);
int scene_start_crushed_cloth(scene_motion *, uint32_t, char *, size_t);
int scene_start_tight_rods(scene_motion *, uint32_t, char *, size_t);
int scene_start_squeezed_rods(scene_motion *, uint32_t, char *, size_t);

/* Writes a printf-like message and returns -1. */
#if defined(__GNUC__)
__attribute__((format(printf, 3, 4)))
#endif
int scene_fail(char *error, size_t error_size, const char *format, ...);

/* From 0 to 1 with level ends as x goes from low to high; 0 before and 1 after. */
double scene_ease(double low, double high, double x);

/* A smooth, repeatable field of values from -1 to 1 with a wave length of about 1, different for
   each seed. */
double scene_noise(double x, double y, double z, uint32_t seed);

#endif /* BENCH_MOTION_H */
