/*
 * Scenes of simulated cloth: twisted, draped over a sphere, fallen into a heap.
 *
 * SPDX-License-Identifier: MIT
 *
 * Cloth of up to 256 cells along a side is simulated as it is. Finer cloth shows the motion of 256
 * cells as a smooth surface, so all finer resolutions of a scene show the same motion, with
 * wrinkles of the same size. None of them resists passing through itself.
 */
#include "scenes/motion.h"

#include "scenes/cloth_mesh.h"
#include "scenes/cloth_simulation.h"

#include <math.h>
#include <stdlib.h>

enum { SIMULATED_CELLS = 256 };

static const double pi = 3.14159265358979323846;

typedef struct cloth_scene {
    cloth_mesh mesh;
    cloth_simulation cloth;
} cloth_scene;

static void pose_cloth(void *state, double time, double *positions)
{
    cloth_scene *scene = (cloth_scene *)state;
    const double *nodes = cloth_simulation_run(&scene->cloth, time);
    cloth_mesh_evaluate(&scene->mesh, nodes, scene->cloth.cells, positions);
}

static void free_cloth(void *state)
{
    cloth_scene *scene = (cloth_scene *)state;
    if (scene) cloth_simulation_free(&scene->cloth);
    free(scene);
}

/* The mesh, and its simulation with nothing set but the particles' distance: a square of this
   size. */
static cloth_scene *start_cloth(scene_motion *motion, uint32_t triangles, uint32_t crossed,
                                double size, char *error, size_t error_size)
{
    cloth_scene *scene = (cloth_scene *)calloc(1, sizeof *scene);
    motion->state = scene;
    motion->pose = pose_cloth;
    motion->free_state = free_cloth;
    if (scene) {
        scene->mesh = cloth_mesh_choose(triangles, crossed);
        const uint32_t cells =
            scene->mesh.cells < SIMULATED_CELLS ? scene->mesh.cells : SIMULATED_CELLS;
        if (cloth_simulation_init(&scene->cloth, cells) == 0) {
            scene->cloth.spacing = size / (double)cells;
            /* A sweep carries forces from particle to particle, so finer cloth stretches as little
               only if steps are shorter. */
            scene->cloth.steps = 1180 * ((cells + 99) / 100);
            if (cloth_mesh_fill(&scene->mesh, motion, error, error_size) == 0) return scene;
            return NULL;
        }
    }
    scene_fail(error, error_size, "cloth: out of memory");
    return NULL;
}

/* The particle in a row and column, 3 doubles. */
static double *particle(cloth_simulation *cloth, uint32_t row, uint32_t column)
{
    return cloth->positions + 3 * ((size_t)row * (cloth->cells + 1) + column);
}

/* ------------------------------------------------------------------------------------------------
 * Twisted cloth: the first and the last column are bars on the x axis, which turn against each
 * other and come closer as the cloth gets shorter.
 */

static void hold_bars(cloth_simulation *cloth, double time)
{
    const double turn = scene_ease(0.0, 1.0, time) * 1.5 * pi;
    const double distance = 1.0 - 0.45 * scene_ease(0.0, 0.9, time);
    const double width = 1.0 - 0.35 * scene_ease(0.0, 0.8, time);
    for (uint32_t row = 0; row <= cloth->cells; row++) {
        const double y = width * ((double)row / (double)cloth->cells - 0.5);
        for (int end = 0; end < 2; end++) {
            double *p = particle(cloth, row, end ? cloth->cells : 0);
            const double sign = end ? 1.0 : -1.0;
            p[0] = sign * 0.5 * distance;
            p[1] = y * cos(sign * turn);
            p[2] = y * sin(sign * turn);
        }
    }
}

int scene_start_twisted_cloth(scene_motion *motion, uint32_t triangles, char *error,
                              size_t error_size)
{
    cloth_scene *scene = start_cloth(motion, triangles, 1, 1.0, error, error_size);
    if (!scene) return -1;
    cloth_simulation *cloth = &scene->cloth;
    cloth->hold = hold_bars;
    cloth->duration = 3.0;
    cloth->drag = 3.0;
    cloth->gravity = 1.0;
    cloth->shear = 1e-5;
    cloth->bending = 1e-4;
    const uint32_t side = cloth->cells + 1;
    for (uint32_t row = 0; row < side; row++) {
        for (uint32_t column = 0; column < side; column++) {
            const size_t i = (size_t)row * side + column;
            const double u = (double)column / (double)cloth->cells;
            const double v = (double)row / (double)cloth->cells;
            cloth->positions[3 * i] = u - 0.5;
            cloth->positions[3 * i + 1] = v - 0.5;
            /* Unequal draughts, without which the cloth would stay without wrinkles. */
            cloth->push[3 * i + 2] = 2.0 * scene_noise(6.0 * u, 6.0 * v, 0.0, 1);
            if (column == 0 || column == cloth->cells) cloth->inverse_mass[i] = 0.0;
        }
    }
    return 0;
}

/* ------------------------------------------------------------------------------------------------
 * Cloth and sphere: the cloth falls on a sphere and to the ground; then the sphere turns, drags the
 * cloth along and winds it round itself.
 */

static const double sphere_radius = 0.35, sphere_height = 0.75;

/* Takes away part of how far a particle has moved in this step, beside what its support moved. */
static void rub(double *p, const double *before, const double *support, double part)
{
    for (int k = 0; k < 3; k++) p[k] -= part * (p[k] - before[k] - support[k]);
}

static void hold_outside(cloth_simulation *cloth, double time)
{
    const double speed = 14.0 * scene_ease(0.4, 0.55, time); /* radians in a unit of time */
    const double turn = speed * cloth->duration / (double)cloth->steps;
    static const double still[3] = {0.0, 0.0, 0.0};
    for (size_t i = 0; i < cloth->count; i++) {
        double *p = cloth->positions + 3 * i, *before = cloth->before + 3 * i;
        const double x = p[0], y = p[1], z = p[2] - sphere_height;
        const double length = sqrt(x * x + y * y + z * z);
        if (length < sphere_radius && length > 0.0) {
            const double moved[3] = {-turn * y, turn * x, 0.0};
            rub(p, before, moved, 0.05);
            const double scale = sphere_radius / length;
            p[0] = scale * x;
            p[1] = scale * y;
            p[2] = scale * z + sphere_height;
        }
        /* The ground is a little uneven for each particle: layers on it do not coincide. */
        const double ground = 0.01 + 0.01 * cloth->lift[i];
        if (p[2] < ground) {
            p[2] = ground;
            rub(p, before, still, 0.1);
        }
    }
}

int scene_start_cloth_sphere(scene_motion *motion, uint32_t triangles, char *error,
                             size_t error_size)
{
    cloth_scene *scene = start_cloth(motion, triangles, 0, 2.0, error, error_size);
    if (!scene) return -1;
    cloth_simulation *cloth = &scene->cloth;
    cloth->hold = hold_outside;
    cloth->duration = 2.2;
    cloth->drag = 1.0;
    cloth->gravity = 9.81;
    cloth->shear = 1e-5;
    cloth->bending = 1e-4;
    const uint32_t side = cloth->cells + 1;
    for (uint32_t row = 0; row < side; row++) {
        for (uint32_t column = 0; column < side; column++) {
            const size_t i = (size_t)row * side + column;
            const double x = 2.0 * column / (double)cloth->cells - 1.0;
            const double y = 2.0 * row / (double)cloth->cells - 1.0;
            cloth->positions[3 * i] = x;
            cloth->positions[3 * i + 1] = y;
            cloth->positions[3 * i + 2] = sphere_height + sphere_radius + 0.02;
            cloth->push[3 * i + 2] = 0.5 * scene_noise(3.0 * x, 3.0 * y, 0.0, 2);
            cloth->lift[i] = scene_noise(5.0 * x, 5.0 * y, 0.0, 3);
        }
    }
    return 0;
}

/* ------------------------------------------------------------------------------------------------
 * Wrinkled cloth: upright cloth falls on the ground and folds into a heap. Its layers do not
 * collide; instead the ground is higher for what comes later: from 0 for the lower side of the
 * cloth to heap_height for the upper one, and uneven, so that layers lie one upon the other and
 * pass through their neighbours only where wrinkles do.
 */

static const double heap_height = 0.25;

static void hold_above_ground(cloth_simulation *cloth, double time)
{
    static const double still[3] = {0.0, 0.0, 0.0};
    (void)time;
    for (size_t i = 0; i < cloth->count; i++) {
        double *p = cloth->positions + 3 * i;
        if (p[2] < cloth->lift[i]) {
            p[2] = cloth->lift[i];
            rub(p, cloth->before + 3 * i, still, 0.2);
        }
    }
}

int scene_start_wrinkled_cloth(scene_motion *motion, uint32_t triangles, char *error,
                               size_t error_size)
{
    cloth_scene *scene = start_cloth(motion, triangles, 0, 2.0, error, error_size);
    if (!scene) return -1;
    cloth_simulation *cloth = &scene->cloth;
    cloth->hold = hold_above_ground;
    cloth->duration = 0.75;
    cloth->drag = 1.0;
    cloth->gravity = 9.81;
    cloth->shear = 1e-5;
    cloth->bending = 1e-4;
    const uint32_t side = cloth->cells + 1;
    for (uint32_t row = 0; row < side; row++) {
        for (uint32_t column = 0; column < side; column++) {
            const size_t i = (size_t)row * side + column;
            const double u = column / (double)cloth->cells, v = row / (double)cloth->cells;
            cloth->positions[3 * i] = 2.0 * u - 1.0;
            cloth->positions[3 * i + 2] = 2.0 * v + 0.05;
            cloth->push[3 * i + 1] = 20.0 * scene_noise(3.0 * u, 6.0 * v, 0.0, 4);
            cloth->push[3 * i] = 5.0 * scene_noise(4.0 * u, 4.0 * v, 0.0, 5);
            cloth->lift[i] = heap_height * v + 0.03 * scene_noise(6.0 * u, 6.0 * v, 0.0, 6);
        }
    }
    return 0;
}
