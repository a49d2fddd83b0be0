/*
 * The scenes that are measured: animations of one mesh each, made by small simulators and formulas.
 *
 * SPDX-License-Identifier: MIT
 *
 * Scenes are deterministic: the same arguments give the same bytes on the same machine and build.
 * An animation is always whole: fewer frames show the same motion in longer steps. All coordinates
 * are floats, so that methods and formats that know no doubles see the very same scene.
 *
 * cat, bunny and horse are made from the models that `make meshes` fetches to build/meshes, or to
 * the folder named by the environment variable SC_MESHES.
 *
 * Cost: seconds; about a minute at most for the largest. Memory: some hundred bytes a triangle.
 */
#ifndef BENCH_SCENE_H
#define BENCH_SCENE_H

#include <stddef.h>
#include <stdint.h>

typedef struct scene_kind {
    const char *name;
    const char *about;     /* a short description */
    const uint32_t *sizes; /* usual numbers of triangles, ascending; 0 ends */
    uint32_t frames;       /* usual number of frames, 60 or more */
} scene_kind;

/* All scenes, in the order in which they are listed. */
const scene_kind *scene_kinds(size_t *count);

/* Called after each frame that was made: their number, and how many there will be. */
typedef void (*scene_progress)(void *user, uint32_t frame, uint32_t frames);

/*
 * Makes a scene and writes it to a folder (see scene_folder.h; frames.f32, and order.u32 for
 * cloth), which is made if it is not there. triangles: what is asked for; the nearest resolution
 * there is gets made. frames: 1 or more; the first frame is the rest pose. progress may be NULL.
 * Returns 0, or -1 with a message in error.
 */
int scene_make(const char *name, uint32_t triangles, uint32_t frames, const char *folder,
               scene_progress progress, void *user, char *error, size_t error_size);

/*
 * The same, kept: makes the scene in CACHE_ROOT/NAME-TRIANGLES-FRAMES (cache_root is usually
 * build/scenes) unless it is there, whole and made by the same version of the scenes, and puts the
 * path in folder. It is made under a temporary name and renamed at the end.
 */
int scene_cached(const char *name, uint32_t triangles, uint32_t frames, const char *cache_root,
                 scene_progress progress, void *user, char *folder, size_t folder_size, char *error,
                 size_t error_size);

#endif /* BENCH_SCENE_H */
