/*
 * Scenes that are formulas of time: a sphere at rest, cloth crushed into tight layers, tight rods.
 *
 * SPDX-License-Identifier: MIT
 */
#include "scenes/motion.h"

#include "shape.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Gives the triangles of a mesh to a motion and keeps the positions. */
static int take_mesh(scene_motion *motion, mesh_file *mesh)
{
    motion->vertex_count = mesh->vertex_count;
    motion->triangle_count = mesh->triangle_count;
    motion->triangles = mesh->indices;
    mesh->indices = NULL;
    return 0;
}

/* ------------------------------------------------------------------------------------------------
 * The sphere: radii change by a few percent in long waves, so it stays the boundary of a star-shaped
 * body and never touches itself.
 */

typedef struct sphere_scene {
    mesh_file rest;
} sphere_scene;

static void pose_sphere(void *state, double time, double *positions)
{
    const sphere_scene *scene = (const sphere_scene *)state;
    const double size = 0.06 * scene_ease(0.0, 0.2, time);
    for (size_t v = 0; v < scene->rest.vertex_count; v++) {
        const float *p = scene->rest.positions + 3 * v;
        const double x = (double)p[0], y = (double)p[1], z = (double)p[2];
        const double waves = sin(3.0 * x + 12.0 * time) + sin(3.0 * y - 17.0 * time) * cos(2.0 * z);
        for (size_t k = 0; k < 3; k++) positions[3 * v + k] = (double)p[k] * (1.0 + size * waves);
    }
}

static void free_sphere(void *state)
{
    sphere_scene *scene = (sphere_scene *)state;
    if (scene) mesh_file_free(&scene->rest);
    free(scene);
}

int scene_start_sphere(scene_motion *motion, uint32_t triangles, char *error, size_t error_size)
{
    const double level = log(fmax((double)triangles / 20.0, 1.0)) / log(4.0);
    sphere_scene *scene = (sphere_scene *)calloc(1, sizeof *scene);
    motion->state = scene;
    motion->pose = pose_sphere;
    motion->free_state = free_sphere;
    if (!scene || !shape_make_sphere(&scene->rest, (uint32_t)(level + 0.5))) {
        return scene_fail(error, error_size, "sphere: out of memory");
    }
    return take_mesh(motion, &scene->rest);
}
