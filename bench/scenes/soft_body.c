/*
 * A small simulator of elastic surfaces; see soft_body.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "scenes/soft_body.h"

#include "mesh_edges.h"
#include "scenes/scene_model.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static double rest_distance(const soft_body *body, uint32_t a, uint32_t b)
{
    double sum = 0.0;
    for (size_t k = 0; k < 3; k++) {
        const double x = body->rest[3 * (size_t)a + k] - body->rest[3 * (size_t)b + k];
        sum += x * x;
    }
    return sqrt(sum);
}

static void add_spring(soft_body *body, uint32_t a, uint32_t b, double compliance)
{
    soft_spring *spring = &body->springs[body->spring_count];
    if (a == b) return;
    spring->a = a;
    spring->b = b;
    spring->length = rest_distance(body, a, b);
    spring->compliance = compliance;
    body->spring_count++;
}

/* The corner of a side's triangle that is not on the side. */
static uint32_t opposite(const mesh_file *mesh, const mesh_side *side)
{
    return mesh->indices[side->corner - side->corner % 3 + (side->corner + 2) % 3];
}

/* A spring along each edge, and one across each edge of two triangles. */
static bool add_springs(soft_body *body, const mesh_file *mesh, double stretch, double bend)
{
    const size_t count = 3 * (size_t)mesh->triangle_count;
    mesh_side *sides = mesh_edges_sort(mesh);
    body->springs = (soft_spring *)malloc(2 * count * sizeof *body->springs);
    if (sides && body->springs) {
        for (size_t begin = 0; begin < count;) {
            const size_t length = mesh_edges_run(sides, begin, count);
            add_spring(body, sides[begin].low, sides[begin].high, stretch);
            if (length == 2) {
                add_spring(body, opposite(mesh, &sides[begin]), opposite(mesh, &sides[begin + 1]),
                           bend);
            }
            begin += length;
        }
    }
    const bool done = sides && body->springs;
    free(sides);
    return done;
}

int soft_body_init(soft_body *body, const mesh_file *mesh, const uint32_t *triangles,
                   double stretch, double bend)
{
    const size_t n = mesh->vertex_count;
    memset(body, 0, sizeof *body);
    body->vertex_count = mesh->vertex_count;
    body->triangle_count = mesh->triangle_count;
    body->triangles = triangles;
    body->turn[3] = 1.0;
    body->duration = 1.0;
    body->rest = (double *)calloc(16 * n, sizeof(double));
    if (!body->rest) return -1;
    body->positions = body->rest + 3 * n;
    body->before = body->positions + 3 * n;
    body->normals = body->before + 3 * n;
    body->shown = body->normals + 3 * n;
    body->keep = body->shown + 3 * n;
    double mean[3] = {0.0, 0.0, 0.0};
    for (size_t i = 0; i < 3 * n; i++) {
        body->positions[i] = body->before[i] = (double)((const float *)mesh->positions)[i];
        mean[i % 3] += body->positions[i] / (double)n;
    }
    for (size_t i = 0; i < 3 * n; i++) body->rest[i] = body->positions[i] - mean[i % 3];
    return add_springs(body, mesh, stretch, bend) ? 0 : -1;
}

void soft_body_free(soft_body *body)
{
    free(body->rest);
    free(body->springs);
    memset(body, 0, sizeof *body);
}

void soft_body_throw(soft_body *body, const double speed[3], double turn)
{
    const double h = body->duration / (double)body->steps;
    for (size_t v = 0; v < body->vertex_count; v++) {
        const double *r = body->rest + 3 * v, *p = body->positions + 3 * v;
        const double turning[3] = {turn * r[2], 0.0, -turn * r[0]};
        for (size_t k = 0; k < 3; k++) body->before[3 * v + k] = p[k] - h * (speed[k] + turning[k]);
    }
}

/* ------------------------------------------------------------------------------------------------
 * The place of the whole.
 */

static void rotate(const double q[4], const double *p, double *out)
{
    const double x = 2.0 * (q[1] * p[2] - q[2] * p[1]), y = 2.0 * (q[2] * p[0] - q[0] * p[2]),
                 z = 2.0 * (q[0] * p[1] - q[1] * p[0]);
    out[0] = p[0] + q[3] * x + q[1] * z - q[2] * y;
    out[1] = p[1] + q[3] * y + q[2] * x - q[0] * z;
    out[2] = p[2] + q[3] * z + q[0] * y - q[1] * x;
}

static double dot(const double *a, const double *b)
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/*
 * Turns q towards the rotation nearest to a matrix, given by its columns (Müller et al., "A robust
 * method to extract the rotational part of deformations", 2016). Begun with the last step's
 * rotation, a few rounds are enough.
 */
static void follow_rotation(double columns[3][3], double q[4])
{
    for (int round = 0; round < 8; round++) {
        double turn[3] = {0.0, 0.0, 0.0}, scale = 1e-12;
        for (int k = 0; k < 3; k++) {
            double unit[3] = {0.0, 0.0, 0.0}, axis[3];
            unit[k] = 1.0;
            rotate(q, unit, axis);
            for (int i = 0; i < 3; i++) {
                const int j = (i + 1) % 3, m = (i + 2) % 3;
                turn[i] += axis[j] * columns[k][m] - axis[m] * columns[k][j];
            }
            scale += fabs(dot(axis, columns[k]));
        }
        /* By the small rotation with half this vector in its quaternion. */
        double d[4] = {0.5 * turn[0] / scale, 0.5 * turn[1] / scale, 0.5 * turn[2] / scale, 1.0};
        const double next[4] = {d[3] * q[0] + d[0] * q[3] + d[1] * q[2] - d[2] * q[1],
                                d[3] * q[1] + d[1] * q[3] + d[2] * q[0] - d[0] * q[2],
                                d[3] * q[2] + d[2] * q[3] + d[0] * q[1] - d[1] * q[0],
                                d[3] * q[3] - d[0] * q[0] - d[1] * q[1] - d[2] * q[2]};
        const double length = sqrt(dot(next, next) + next[3] * next[3]);
        for (int k = 0; k < 4; k++) q[k] = next[k] / length;
    }
}

/* Draws particles towards the rest shape at the place of the whole. */
static void keep_shape(soft_body *body)
{
    const size_t n = body->vertex_count;
    double mean[3] = {0.0, 0.0, 0.0}, columns[3][3] = {{0.0}};
    for (size_t v = 0; v < n; v++) {
        for (size_t k = 0; k < 3; k++) mean[k] += body->positions[3 * v + k] / (double)n;
    }
    for (size_t v = 0; v < n; v++) {
        for (size_t k = 0; k < 3; k++) {
            for (size_t i = 0; i < 3; i++) {
                columns[k][i] += (body->positions[3 * v + i] - mean[i]) * body->rest[3 * v + k];
            }
        }
    }
    follow_rotation(columns, body->turn);
    for (size_t v = 0; v < n; v++) {
        double place[3];
        rotate(body->turn, body->rest + 3 * v, place);
        for (size_t k = 0; k < 3; k++) {
            double *at = &body->positions[3 * v + k];
            *at += body->keep[v] * (place[k] + mean[k] - *at);
        }
    }
}

/* ------------------------------------------------------------------------------------------------
 * Steps.
 */

static void restore_distances(soft_body *body, double h)
{
    for (size_t i = 0; i < body->spring_count; i++) {
        const soft_spring *s = &body->springs[i];
        double *p = body->positions + 3 * (size_t)s->a, *q = body->positions + 3 * (size_t)s->b;
        const double x = q[0] - p[0], y = q[1] - p[1], z = q[2] - p[2];
        const double length = sqrt(x * x + y * y + z * z) + 1e-300;
        const double move = (length - s->length) / (length * (2.0 + s->compliance / (h * h)));
        p[0] += move * x;
        p[1] += move * y;
        p[2] += move * z;
        q[0] -= move * x;
        q[1] -= move * y;
        q[2] -= move * z;
    }
}

static void step(soft_body *body)
{
    const double h = body->duration / (double)body->steps;
    const double kept = exp(-body->drag * h);
    body->done++;
    const double time = (double)body->done / (double)body->steps;
    if (body->push != 0.0) {
        scene_model_normals(body->triangles, body->triangle_count, body->positions,
                            body->vertex_count, body->normals);
    }
    for (size_t i = 0; i < 3 * (size_t)body->vertex_count; i++) {
        const double pull =
            time * body->push * body->normals[i] - (i % 3 == 2 ? body->gravity : 0.0);
        double *at = &body->positions[i];
        const double next = *at + kept * (*at - body->before[i]) + h * h * pull;
        body->before[i] = *at;
        *at = next;
    }
    if (body->hold) body->hold(body, time);
    keep_shape(body);
    restore_distances(body, h);
    if (body->hold) body->hold(body, time);
}

const double *soft_body_run(soft_body *body, double time)
{
    if (body->done == 0 && time <= 0.0) return body->positions;
    const double wanted = time * (double)body->steps;
    while ((double)body->done < wanted && body->done < body->steps) step(body);
    /* The wanted moment lies in the last step. */
    const double back = fmax((double)body->done - wanted, 0.0);
    for (size_t i = 0; i < 3 * (size_t)body->vertex_count; i++) {
        body->shown[i] = body->positions[i] + back * (body->before[i] - body->positions[i]);
    }
    return body->shown;
}
