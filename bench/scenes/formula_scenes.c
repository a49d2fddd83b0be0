/*
 * Scenes that are formulas of time: a sphere at rest, cloth crushed into tight layers, tight and
 * squeezed rods.
 *
 * SPDX-License-Identifier: MIT
 */
#include "scenes/motion.h"

#include "scenes/cloth_mesh.h"
#include "shape.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

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
 * The sphere: radii change by a few percent in long waves, so it stays the boundary of a
 * star-shaped body and never touches itself.
 */

typedef struct sphere_scene {
    mesh_file rest;
} sphere_scene;

static void pose_sphere(void *state, double time, double *positions)
{
    const sphere_scene *scene = (const sphere_scene *)state;
    const double size = 0.06 * scene_ease(0.0, 0.2, time);
    for (size_t v = 0; v < scene->rest.vertex_count; v++) {
        const float *p = (const float *)scene->rest.positions + 3 * v;
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

/* ------------------------------------------------------------------------------------------------
 * Crushed cloth: rolled up along rows to a spiral whose turns are closer than cells are wide, then
 * dented at random by a part of that distance. While it rolls up, the curvature of each row changes
 * monotonically along it, and such a curve never meets itself (Tait and Kneser): all contacts come
 * from the dents.
 */

static const double roll_gap = 0.18; /* of turns, in cells */
static const double roll_hole = 2.0; /* radius of the innermost turn, in cells */
static const double roll_dent = 0.1; /* the largest, in cells */

enum { ROLL_STEPS = 64 }; /* of integration, a cell */

typedef struct crushed_scene {
    cloth_mesh mesh;
    double *places; /* 3 * vertex_count: u and v, 0 to cells, and 0 */
    double *curve;  /* 2 (2 cells + 1): points of a row at every half cell, in cells */
    size_t vertex_count;
} crushed_scene;

/*
 * The angle of the rolled row's direction at a distance from its inner end: on the spiral of
 * Archimedes, r = hole + gap angle / (2 pi), whose length is about hole angle + gap angle^2 / (4
 * pi).
 */
static double roll_angle(double length)
{
    const double a = roll_gap / (4.0 * pi);
    return (sqrt(roll_hole * roll_hole + 4.0 * a * length) - roll_hole) / (2.0 * a);
}

static void integrate_roll(crushed_scene *scene, double time)
{
    const uint32_t halves = 2 * scene->mesh.cells;
    const double h = 0.5 / ROLL_STEPS;
    double x = 0.0, z = 0.0;
    for (uint32_t i = 0; i <= halves; i++) {
        scene->curve[2 * i] = x;
        scene->curve[2 * i + 1] = z;
        for (int k = 0; k < ROLL_STEPS; k++) {
            const double angle = time * roll_angle(0.5 * i + (k + 0.5) * h);
            x += h * cos(angle);
            z += h * sin(angle);
        }
    }
}

/* Turned about two axes, so that boxes along the axes do not fit the layers too well. */
static void turn_askew(double x, double y, double z, double *out)
{
    const double a = 0.6, b = 0.5;
    const double t = cos(a) * x - sin(a) * y;
    out[1] = sin(a) * x + cos(a) * y;
    out[0] = cos(b) * t - sin(b) * z;
    out[2] = sin(b) * t + cos(b) * z;
}

static void pose_crushed(void *state, double time, double *positions)
{
    crushed_scene *scene = (crushed_scene *)state;
    const double cells = (double)scene->mesh.cells;
    const double dent = roll_dent * scene_ease(0.5, 1.0, time);
    integrate_roll(scene, scene_ease(0.0, 0.8, time));
    for (size_t v = 0; v < scene->vertex_count; v++) {
        const double *place = scene->places + 3 * v;
        const double *point = scene->curve + 2 * (size_t)(2.0 * place[0] + 0.5);
        double offset[3] = {0.0, 0.0, 0.0};
        for (uint32_t k = 0; k < 3 && dent > 0.0; k++) {
            offset[k] = dent * scene_noise(place[0] / 6.0, place[1] / 6.0, 0.0, 20 + k);
        }
        turn_askew((point[0] + offset[0]) / cells, (place[1] + offset[1]) / cells,
                   (point[1] + offset[2]) / cells, positions + 3 * v);
    }
}

static void free_crushed(void *state)
{
    crushed_scene *scene = (crushed_scene *)state;
    if (scene) {
        free(scene->places);
        free(scene->curve);
    }
    free(scene);
}

int scene_start_crushed_cloth(scene_motion *motion, uint32_t triangles, char *error,
                              size_t error_size)
{
    crushed_scene *scene = (crushed_scene *)calloc(1, sizeof *scene);
    motion->state = scene;
    motion->pose = pose_crushed;
    motion->free_state = free_crushed;
    if (!scene) return scene_fail(error, error_size, "cloth: out of memory");
    scene->mesh = cloth_mesh_choose(triangles, 1);
    if (cloth_mesh_fill(&scene->mesh, motion, error, error_size) != 0) return -1;
    scene->vertex_count = motion->vertex_count;
    scene->places = (double *)malloc(3 * scene->vertex_count * sizeof(double));
    scene->curve = (double *)malloc(2 * (2 * (size_t)scene->mesh.cells + 1) * sizeof(double));
    if (!scene->places || !scene->curve)
        return scene_fail(error, error_size, "cloth: out of memory");
    const double n = (double)scene->mesh.cells;
    const double nodes[12] = {0, 0, 0, n, 0, 0, 0, n, 0, n, n, 0};
    cloth_mesh_evaluate(&scene->mesh, nodes, 1, scene->places);
    return 0;
}

/* ------------------------------------------------------------------------------------------------
 * Tight rods: a square bundle of open tubes with little space between them, wrung about its axis,
 * and pinched in the middle, where their neighbours get into them. Squeezed rods: the same bundle
 * pressed together along its whole length, so that walls of many tubes lie side by side everywhere.
 */

enum { ROD_SIDE = 8, RODS = ROD_SIDE * ROD_SIDE, ROD_AROUND = 8 };

static const double rod_radius = 0.48; /* the distance of rods is 1 */

typedef struct rods_scene {
    uint32_t rings;
    double turns; /* half the angle between the two ends, in the end */
    double pinch; /* by what part rods come closer */
    double waist; /* how fast that fades away from the middle; 0: not at all */
} rods_scene;

/* A bundle's rods are numbered along a Z-shaped curve, so that consecutive ones are close. */
static void rod_center(uint32_t rod, double *x, double *y)
{
    uint32_t column = 0, row = 0;
    for (int bit = 0; bit < 3; bit++) {
        column |= (rod >> (2 * bit) & 1) << bit;
        row |= (rod >> (2 * bit + 1) & 1) << bit;
    }
    *x = (double)column - 0.5 * (ROD_SIDE - 1);
    *y = (double)row - 0.5 * (ROD_SIDE - 1);
}

static void pose_rods(void *state, double time, double *positions)
{
    const rods_scene *scene = (const rods_scene *)state;
    const double length = (double)(scene->rings - 1) * 2.0 * pi * rod_radius / ROD_AROUND;
    const double wring = scene->turns * scene_ease(0.0, 1.0, time);
    const double pinch = scene->pinch * scene_ease(0.3, 1.0, time);
    double *out = positions;
    for (uint32_t rod = 0; rod < RODS; rod++) {
        double x, y;
        rod_center(rod, &x, &y);
        for (uint32_t ring = 0; ring < scene->rings; ring++) {
            const double along = 2.0 * ring / (double)(scene->rings - 1) - 1.0;
            const double narrow = 1.0 - pinch * exp(-scene->waist * along * along);
            const double c = cos(wring * along), s = sin(wring * along);
            for (uint32_t k = 0; k < ROD_AROUND; k++, out += 3) {
                const double angle = 2.0 * pi * (k + 0.5 * (ring % 2)) / ROD_AROUND;
                const double px = narrow * x + rod_radius * cos(angle);
                const double py = narrow * y + rod_radius * sin(angle);
                out[0] = c * px - s * py;
                out[1] = s * px + c * py;
                out[2] = 0.5 * length * along;
            }
        }
    }
}

static int start_rods(scene_motion *motion, uint32_t triangles, double turns, double pinch,
                      double waist, char *error, size_t error_size)
{
    rods_scene *scene = (rods_scene *)calloc(1, sizeof *scene);
    motion->state = scene;
    motion->pose = pose_rods;
    const uint32_t each_ring = 2 * ROD_AROUND * RODS;
    const uint32_t bands = triangles < each_ring ? 1 : (triangles + each_ring / 2) / each_ring;
    motion->triangle_count = bands * each_ring;
    motion->vertex_count = (bands + 1) * ROD_AROUND * RODS;
    motion->triangles = (uint32_t *)malloc(3 * (size_t)motion->triangle_count * sizeof(uint32_t));
    motion->order = (uint32_t *)malloc((size_t)motion->triangle_count * sizeof(uint32_t));
    if (!scene || !motion->triangles || !motion->order) {
        return scene_fail(error, error_size, "rods: out of memory");
    }
    scene->rings = bands + 1;
    scene->turns = turns;
    scene->pinch = pinch;
    scene->waist = waist;
    uint32_t *out = motion->triangles;
    for (uint32_t rod = 0; rod < RODS; rod++) {
        for (uint32_t band = 0; band < bands; band++) {
            const uint32_t low = (rod * scene->rings + band) * ROD_AROUND, high = low + ROD_AROUND;
            for (uint32_t k = 0; k < ROD_AROUND; k++, out += 6) {
                /* Rings are turned by half a side against each other. */
                const uint32_t next = (k + 1) % ROD_AROUND;
                const uint32_t left = band % 2 ? next : k, right = (left + 1) % ROD_AROUND;
                const uint32_t corners[6] = {low + k,    low + next,   high + left,
                                             low + next, high + right, high + left};
                memcpy(out, corners, sizeof corners);
            }
        }
    }
    for (uint32_t t = 0; t < motion->triangle_count; t++) motion->order[t] = t;
    return 0;
}

int scene_start_tight_rods(scene_motion *motion, uint32_t triangles, char *error, size_t error_size)
{
    return start_rods(motion, triangles, 2.0, 0.25, 16.0, error, error_size);
}

int scene_start_squeezed_rods(scene_motion *motion, uint32_t triangles, char *error,
                              size_t error_size)
{
    return start_rods(motion, triangles, 0.5, 0.38, 0.0, error, error_size);
}
