/*
 * Polygons as a file has them; see polygon_mesh.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "polygon_mesh.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Grows an array to hold more than count entries. */
static bool reserve(void **array, size_t *room, size_t count, size_t size)
{
    if (count < *room) return true;
    const size_t wanted = *room < 1024 ? 1024 : 2 * *room;
    void *grown = wanted > SIZE_MAX / size ? NULL : realloc(*array, wanted * size);
    if (!grown) return false;
    *array = grown;
    *room = wanted;
    return true;
}

size_t polygon_mesh_corners(const polygon_mesh *mesh)
{
    return mesh->offsets ? mesh->offsets[mesh->face_count] : 0;
}

bool polygon_mesh_add_vertex(polygon_mesh *mesh, const float position[3])
{
    void *array = mesh->positions;
    if (!reserve(&array, &mesh->vertex_room, mesh->vertex_count, 3 * sizeof(float))) return false;
    mesh->positions = (float *)array;
    memcpy(mesh->positions + 3 * mesh->vertex_count, position, 3 * sizeof(float));
    mesh->vertex_count++;
    return true;
}

bool polygon_mesh_add_corner(polygon_mesh *mesh, size_t index, uint32_t vertex)
{
    void *array = mesh->corners;
    const size_t at = polygon_mesh_corners(mesh) + index;
    if (!reserve(&array, &mesh->corner_room, at, sizeof(uint32_t))) return false;
    mesh->corners = (uint32_t *)array;
    mesh->corners[at] = vertex;
    return true;
}

bool polygon_mesh_end_face(polygon_mesh *mesh, size_t corner_count)
{
    if (corner_count < 3) return true;
    void *array = mesh->offsets;
    if (!reserve(&array, &mesh->face_room, mesh->face_count + 1, sizeof(size_t))) return false;
    if (!mesh->offsets) *(size_t *)array = 0;
    mesh->offsets = (size_t *)array;
    mesh->offsets[mesh->face_count + 1] = mesh->offsets[mesh->face_count] + corner_count;
    mesh->face_count++;
    return true;
}

bool polygon_mesh_check(const polygon_mesh *mesh, const char *path, char *error, size_t error_size)
{
    const size_t count = polygon_mesh_corners(mesh);
    for (size_t c = 0; c < count; c++) {
        if (mesh->corners[c] < mesh->vertex_count) continue;
        snprintf(error, error_size, "%s: a face names vertex %lu, the file has %lu", path,
                 (unsigned long)mesh->corners[c] + 1, (unsigned long)mesh->vertex_count);
        return false;
    }
    return true;
}

void polygon_mesh_free(polygon_mesh *mesh)
{
    free(mesh->positions);
    free(mesh->corners);
    free(mesh->offsets);
    memset(mesh, 0, sizeof *mesh);
}

char *polygon_mesh_load(const char *path, size_t *size, char *error, size_t error_size)
{
    errno = 0;
    FILE *file = fopen(path, "rb");
    void *text = NULL;
    size_t used = 0, room = 0;
    bool good = file != NULL;
    while (good) {
        good = reserve(&text, &room, used + 65536, 1);
        if (!good) continue;
        const size_t got = fread((char *)text + used, 1, room - used - 1, file);
        used += got;
        if (got == 0) break;
    }
    good = good && !ferror(file);
    if (!good) {
        snprintf(error, error_size, "%s: %s", path, errno ? strerror(errno) : "out of memory");
        free(text);
        text = NULL;
    } else {
        ((char *)text)[used] = 0;
        *size = used;
    }
    if (file) fclose(file);
    return (char *)text;
}

/* A corner of a polygon in the plane that it is cut in. */
typedef struct plane_point {
    double x, y;
} plane_point;

/* The two axes to keep, so that the polygon turns to the left: Newell's normal decides. */
static void choose_plane(const float *positions, const uint32_t *corners, uint32_t count, int *x,
                         int *y)
{
    double normal[3] = {0.0, 0.0, 0.0};
    for (uint32_t i = 0; i < count; i++) {
        const float *a = positions + 3 * (size_t)corners[i];
        const float *b = positions + 3 * (size_t)corners[(i + 1) % count];
        for (int k = 0; k < 3; k++) {
            const int u = (k + 1) % 3, v = (k + 2) % 3;
            normal[k] += ((double)a[u] - (double)b[u]) * ((double)a[v] + (double)b[v]);
        }
    }
    int axis = 0;
    for (int k = 1; k < 3; k++) axis = fabs(normal[k]) > fabs(normal[axis]) ? k : axis;
    *x = normal[axis] < 0.0 ? (axis + 2) % 3 : (axis + 1) % 3;
    *y = normal[axis] < 0.0 ? (axis + 1) % 3 : (axis + 2) % 3;
}

static plane_point project(const float *positions, uint32_t vertex, int x, int y)
{
    const float *p = positions + 3 * (size_t)vertex;
    const plane_point point = {(double)p[x], (double)p[y]};
    return point;
}

static double turn(plane_point a, plane_point b, plane_point c)
{
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

static bool same_point(plane_point a, plane_point b)
{
    return a.x == b.x && a.y == b.y;
}

/* Whether the corner in the middle can be cut off: it turns left and no other corner is inside. */
static bool is_ear(const float *positions, const uint32_t *ring, uint32_t count, uint32_t middle,
                   int x, int y)
{
    const plane_point a = project(positions, ring[(middle + count - 1) % count], x, y);
    const plane_point b = project(positions, ring[middle], x, y);
    const plane_point c = project(positions, ring[(middle + 1) % count], x, y);
    if (!(turn(a, b, c) > 0.0)) return false;
    for (uint32_t i = 0; i < count; i++) {
        const plane_point p = project(positions, ring[i], x, y);
        if (same_point(p, a) || same_point(p, b) || same_point(p, c)) continue;
        if (turn(a, b, p) >= 0.0 && turn(b, c, p) >= 0.0 && turn(c, a, p) >= 0.0) return false;
    }
    return true;
}

void polygon_mesh_triangulate(const float *positions, const uint32_t *corners, uint32_t count,
                              uint32_t *triangles)
{
    /* The ring of corners that are left is kept in the end of the output, which it never outgrows:
       of count - 2 triangles, count - left are written when left corners remain. */
    int x, y;
    choose_plane(positions, corners, count, &x, &y);
    uint32_t *out = triangles;
    if (count == 3) {
        memcpy(out, corners, 3 * sizeof *out);
        return;
    }
    uint32_t *ring = triangles + 3 * ((size_t)count - 2) - count;
    memcpy(ring, corners, count * sizeof *ring);
    for (uint32_t left = count; left > 3; left--) {
        uint32_t middle = 1;
        while (middle < left && !is_ear(positions, ring, left, middle, x, y)) middle++;
        if (middle == left) middle = is_ear(positions, ring, left, 0, x, y) ? 0 : 1;
        const uint32_t triangle[3] = {ring[(middle + left - 1) % left], ring[middle],
                                      ring[(middle + 1) % left]};
        /* Close the gap towards the end, so that the front of the ring becomes free. */
        memmove(ring + 1, ring, middle * sizeof *ring);
        ring++;
        memcpy(out, triangle, sizeof triangle);
        out += 3;
    }
    memmove(out, ring, 3 * sizeof *out);
}
