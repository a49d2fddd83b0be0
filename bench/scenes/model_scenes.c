/*
 * Scenes of glmark2's models: a cat that walks, a bunny that rolls down a hill, a horse that is
 * sucked empty.
 *
 * SPDX-License-Identifier: MIT
 */
#include "scenes/motion.h"

#include "scenes/scene_model.h"
#include "scenes/soft_body.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

/* Gives the triangles of a mesh to a motion. */
static void take_triangles(scene_motion *motion, mesh_file *mesh)
{
    motion->vertex_count = mesh->vertex_count;
    motion->triangle_count = mesh->triangle_count;
    motion->triangles = mesh->indices;
    mesh->indices = NULL;
}

/* ------------------------------------------------------------------------------------------------
 * The cat, by skinning: each bone turns about a joint and takes the vertices near to it along, by
 * weights that fall off smoothly with the distance to the bone. The cat crouches, so it walks like
 * one that creeps up on a mouse: paws and haunches go forward in turn, the back sways, the head
 * turns, the tail beats.
 */

/* A bone from one point to another turns about its first point. */
typedef struct cat_bone {
    double from[3], to[3];
    double inner, outer; /* distances where it has full weight and none */
    double axis[3];      /* unit */
    double swing;        /* the largest angle */
    double cycles;       /* swings in the whole animation */
    double phase;        /* of a swing, 0 to 1 */
} cat_bone;

enum { CAT_BONES = 9 };

static const cat_bone cat_bones[CAT_BONES] = {
    /* head: turned, nodding */
    {{0.42, -0.1, 0.0}, {0.62, -0.15, 0.35}, 0.22, 0.5, {0, 0, 1}, 0.8, 2.0, 0.0},
    {{0.42, -0.1, 0.0}, {0.62, -0.15, 0.35}, 0.22, 0.5, {0, 1, 0}, 0.8, 3.0, 0.3},
    /* front paws: forward, and crossing each other */
    {{0.35, -0.4, -0.3}, {0.85, -0.45, -0.55}, 0.15, 0.4, {0, 1, 0}, 0.6, 4.0, 0.0},
    {{0.45, 0.1, -0.3}, {0.98, 0.08, -0.55}, 0.15, 0.4, {0, 1, 0}, 0.6, 4.0, 0.5},
    {{0.35, -0.4, -0.3}, {0.85, -0.45, -0.55}, 0.15, 0.4, {0, 0, 1}, 0.6, 3.0, 0.0},
    {{0.45, 0.1, -0.3}, {0.98, 0.08, -0.55}, 0.15, 0.4, {0, 0, -1}, 0.6, 3.0, 0.0},
    /* haunches */
    {{-0.5, 0.3, 0.0}, {-0.3, 0.4, -0.5}, 0.2, 0.5, {0, 1, 0}, 0.35, 4.0, 0.25},
    {{-0.5, -0.3, 0.0}, {-0.3, -0.4, -0.5}, 0.2, 0.5, {0, 1, 0}, 0.35, 4.0, 0.75},
    /* tail */
    {{-0.7, -0.3, -0.5}, {-0.3, -0.55, -0.5}, 0.08, 0.3, {0, 0, 1}, 0.9, 3.0, 0.0},
};

typedef struct cat_scene {
    mesh_file rest;
    float *weights; /* CAT_BONES * vertex_count */
} cat_scene;

static double distance_to_bone(const cat_bone *bone, const double p[3])
{
    double along = 0.0, length = 0.0, sum = 0.0;
    for (int k = 0; k < 3; k++) {
        along += (p[k] - bone->from[k]) * (bone->to[k] - bone->from[k]);
        length += (bone->to[k] - bone->from[k]) * (bone->to[k] - bone->from[k]);
    }
    along = fmin(fmax(along / length, 0.0), 1.0);
    for (int k = 0; k < 3; k++) {
        const double x = p[k] - bone->from[k] - along * (bone->to[k] - bone->from[k]);
        sum += x * x;
    }
    return sqrt(sum);
}

/* Adds to out what the bone's turn by this angle moves p. */
static void add_turn(const cat_bone *bone, double angle, double weight, const double p[3],
                     double out[3])
{
    const double c = cos(angle), s = sin(angle), *u = bone->axis;
    double r[3], along = 0.0;
    for (int k = 0; k < 3; k++) {
        r[k] = p[k] - bone->from[k];
        along += u[k] * r[k];
    }
    for (int k = 0; k < 3; k++) {
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        const double turned = c * r[k] + s * (u[i] * r[j] - u[j] * r[i]) + (1.0 - c) * along * u[k];
        out[k] += weight * (turned - r[k]);
    }
}

static void pose_cat(void *state, double time, double *positions)
{
    const cat_scene *scene = (const cat_scene *)state;
    const double strength = scene_ease(0.0, 0.15, time);
    double angles[CAT_BONES];
    for (int b = 0; b < CAT_BONES; b++) {
        const cat_bone *bone = &cat_bones[b];
        angles[b] = strength * bone->swing * sin(2.0 * pi * (bone->cycles * time + bone->phase));
    }
    for (size_t v = 0; v < scene->rest.vertex_count; v++) {
        double p[3], moved[3];
        for (size_t k = 0; k < 3; k++) {
            p[k] = moved[k] = (double)((const float *)scene->rest.positions)[3 * v + k];
        }
        for (size_t b = 0; b < CAT_BONES; b++) {
            const double weight = (double)scene->weights[CAT_BONES * v + b];
            if (weight > 0.0) add_turn(&cat_bones[b], angles[b], weight, p, moved);
        }
        /* The back sways: a wave goes along it. */
        const double sway = strength * 0.12 * sin(2.0 * pi * (2.0 * time - 0.4 * p[0]));
        positions[3 * v] = moved[0];
        positions[3 * v + 1] = moved[1] + sway;
        positions[3 * v + 2] = moved[2];
    }
}

static void free_cat(void *state)
{
    cat_scene *scene = (cat_scene *)state;
    if (scene) {
        mesh_file_free(&scene->rest);
        free(scene->weights);
    }
    free(scene);
}

int scene_start_cat(scene_motion *motion, uint32_t triangles, char *error, size_t error_size)
{
    cat_scene *scene = (cat_scene *)calloc(1, sizeof *scene);
    motion->state = scene;
    motion->pose = pose_cat;
    motion->free_state = free_cat;
    if (!scene) return scene_fail(error, error_size, "cat: out of memory");
    if (scene_model_read(&scene->rest, "cat.3ds", -2, triangles, error, error_size) != 0) return -1;
    const size_t n = scene->rest.vertex_count;
    scene->weights = (float *)malloc(CAT_BONES * n * sizeof(float));
    if (!scene->weights) return scene_fail(error, error_size, "cat: out of memory");
    for (size_t v = 0; v < n; v++) {
        double p[3];
        for (size_t k = 0; k < 3; k++)
            p[k] = (double)((const float *)scene->rest.positions)[3 * v + k];
        for (size_t b = 0; b < CAT_BONES; b++) {
            const cat_bone *bone = &cat_bones[b];
            scene->weights[CAT_BONES * v + b] =
                (float)(1.0 - scene_ease(bone->inner, bone->outer, distance_to_bone(bone, p)));
        }
    }
    take_triangles(motion, &scene->rest);
    return 0;
}

/* ------------------------------------------------------------------------------------------------
 * Soft bodies.
 */

typedef struct soft_scene {
    soft_body body;
    mesh_file rest;
} soft_scene;

static void pose_soft(void *state, double time, double *positions)
{
    soft_scene *scene = (soft_scene *)state;
    const double *shown = soft_body_run(&scene->body, time);
    memcpy(positions, shown, 3 * (size_t)scene->body.vertex_count * sizeof *positions);
}

static void free_soft(void *state)
{
    soft_scene *scene = (soft_scene *)state;
    if (scene) {
        soft_body_free(&scene->body);
        mesh_file_free(&scene->rest);
    }
    free(scene);
}

/* A motion with nothing but the mesh. */
static soft_scene *start_soft(scene_motion *motion, const char *file, int up, uint32_t triangles,
                              char *error, size_t error_size)
{
    soft_scene *scene = (soft_scene *)calloc(1, sizeof *scene);
    motion->state = scene;
    motion->pose = pose_soft;
    motion->free_state = free_soft;
    if (!scene) {
        scene_fail(error, error_size, "%s: out of memory", file);
        return NULL;
    }
    return scene_model_read(&scene->rest, file, up, triangles, error, error_size) == 0 ? scene
                                                                                       : NULL;
}

static int start_body(soft_scene *scene, scene_motion *motion, double stretch, double bend,
                      char *error, size_t error_size)
{
    if (soft_body_init(&scene->body, &scene->rest, scene->rest.indices, stretch, bend) != 0) {
        return scene_fail(error, error_size, "out of memory");
    }
    take_triangles(motion, &scene->rest);
    return 0;
}

/* ------------------------------------------------------------------------------------------------
 * The bunny rolls and bounces down a wavy slope, soft enough to be dented; ears and tail are limp
 * and get into the body.
 */

static double hill_height(double x)
{
    return -1.05 - 0.5 * x + 0.12 * (cos(1.7 * x) - 1.0);
}

static void hold_above_hill(soft_body *body, double time)
{
    (void)time;
    for (size_t v = 0; v < body->vertex_count; v++) {
        double *p = body->positions + 3 * v, *before = body->before + 3 * v;
        const double ground = hill_height(p[0]);
        if (p[2] >= ground) continue;
        p[2] = ground;
        /* Rough: what touches the ground hardly slides. */
        for (int k = 0; k < 2; k++) p[k] -= 0.3 * (p[k] - before[k]);
    }
}

/*
 * Moves the vertices along their normals: bumps of a smooth noise, or spikes on its peaks. Where
 * the surface does not look away from the middle, as between the ears, there is less, as bumps
 * would meet.
 */
static int roughen(mesh_file *mesh, bool spikes, char *error, size_t error_size)
{
    const size_t n = mesh->vertex_count;
    double *positions = (double *)malloc(6 * n * sizeof *positions);
    if (!positions) return scene_fail(error, error_size, "bunny: out of memory");
    double *normals = positions + 3 * n;
    float *rough = (float *)mesh->positions;
    for (size_t i = 0; i < 3 * n; i++) positions[i] = (double)rough[i];
    scene_model_normals(mesh->indices, mesh->triangle_count, positions, mesh->vertex_count,
                        normals);
    for (size_t v = 0; v < n; v++) {
        const double *p = positions + 3 * v;
        const double noise = scene_noise(4.0 * p[0], 4.0 * p[1], 4.0 * p[2], 7);
        const double peak = fmax(noise, 0.0);
        const double length = sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
        const double *normal = normals + 3 * v;
        const double outward = (p[0] * normal[0] + p[1] * normal[1] + p[2] * normal[2]) / length;
        const double height = scene_ease(0.3, 0.8, length > 0.0 ? outward : 0.0) *
                              (spikes ? 0.4 * peak * peak * peak : 0.05 * noise);
        for (size_t k = 0; k < 3; k++) {
            rough[3 * v + k] = (float)(p[k] + height * normals[3 * v + k]);
        }
    }
    free(positions);
    return 0;
}

enum { BUNNY_PLAIN, BUNNY_BUMPY, BUNNY_SPIKY };

static int start_bunny(scene_motion *motion, uint32_t triangles, int surface, char *error,
                       size_t error_size)
{
    soft_scene *scene = start_soft(motion, "bunny.obj", 1, triangles, error, error_size);
    if (!scene) return -1;
    if (surface != BUNNY_PLAIN &&
        roughen(&scene->rest, surface == BUNNY_SPIKY, error, error_size) != 0)
        return -1;
    if (start_body(scene, motion, 1e-4, 1e-3, error, error_size) != 0) return -1;
    soft_body *body = &scene->body;
    body->hold = hold_above_hill;
    body->gravity = 9.81;
    body->drag = 0.3;
    body->duration = 3.0;
    body->steps = 590;
    for (size_t v = 0; v < body->vertex_count; v++) {
        /* The ears rise above the head. */
        const double ear =
            scene_ease(0.25, 0.5, (double)((const float *)scene->rest.positions)[3 * v + 2]);
        body->keep[v] = 0.03 - 0.027 * ear;
    }
    const double speed[3] = {2.0, 0.0, 0.0};
    soft_body_throw(body, speed, 3.0);
    return 0;
}

int scene_start_bunny(scene_motion *motion, uint32_t triangles, char *error, size_t error_size)
{
    return start_bunny(motion, triangles, BUNNY_PLAIN, error, error_size);
}

int scene_start_bunny_bumpy(scene_motion *motion, uint32_t triangles, char *error,
                            size_t error_size)
{
    return start_bunny(motion, triangles, BUNNY_BUMPY, error, error_size);
}

int scene_start_bunny_spiky(scene_motion *motion, uint32_t triangles, char *error,
                            size_t error_size)
{
    return start_bunny(motion, triangles, BUNNY_SPIKY, error, error_size);
}

/* ------------------------------------------------------------------------------------------------
 * The horse is hollow and sucked empty: its skin hardly stretches, so it buckles, and opposite
 * sides get into each other.
 */

int scene_start_horse(scene_motion *motion, uint32_t triangles, char *error, size_t error_size)
{
    soft_scene *scene = start_soft(motion, "horse.3ds", -2, triangles, error, error_size);
    if (!scene || start_body(scene, motion, 1e-5, 1e-3, error, error_size) != 0) return -1;
    soft_body *body = &scene->body;
    body->push = -40.0;
    body->drag = 3.0;
    body->duration = 2.0;
    body->steps = 590;
    for (size_t v = 0; v < body->vertex_count; v++) body->keep[v] = 0.002;
    return 0;
}
