/*
 * Hard meshes: see shapes.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "shapes.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "harness.h"

static const double pi = 3.14159265358979323846;

soup shape_spiral(uint32_t along, uint32_t across, double turns, double tilt)
{
    soup s = soup_cloth(across, along);
    for (uint32_t v = 0; v < s.vertex_count; ++v) {
        double *p = s.positions + 3 * (size_t)v;
        double turn = turns * p[0], radius = 0.8 - 0.4 * p[1]; /* the inside is to the left */
        p[0] = radius * cos(2 * pi * turn);
        p[1] = radius * sin(2 * pi * turn);
        p[2] = tilt * (radius - 0.6) * turn;
    }
    return s;
}

soup shape_hub(uint32_t valence)
{
    soup s = soup_make(2 * valence + 1, 3 * valence);
    uint32_t *t = s.triangles;
    memset(s.positions, 0, 3 * sizeof(double));
    for (uint32_t i = 0; i < valence; ++i) {
        double angle = 2 * pi * i / valence;
        uint32_t a = 1 + i, b = 1 + (i + 1) % valence;
        uint32_t corners[9] = {0, a, b, a, a + valence, b, b, a + valence, b + valence};
        for (uint32_t ring = 0; ring < 2; ++ring) {
            double *p = s.positions + 3 * (size_t)(a + ring * valence);
            p[0] = (0.5 + 0.5 * ring) * cos(angle);
            p[1] = (0.5 + 0.5 * ring) * sin(angle);
            p[2] = 0;
        }
        memcpy(t + 9 * (size_t)i, corners, sizeof(corners));
    }
    return s;
}

soup shape_copies(uint32_t shared)
{
    static const double positions[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 1, 2, 0, 1};
    soup s = soup_make(6 - shared, 32);
    memcpy(s.positions, positions, 3 * s.vertex_count * sizeof(double));
    for (uint32_t i = 0; i < 96; ++i)
        s.triangles[i] = i < 48 ? i % 3 : i % 3 < shared ? (i % 3 + 1) % 3 : i % 3 + 3 - shared;
    return s;
}

soup shape_fan_of_sheets(uint32_t along)
{
    soup fins = soup_fins(along);
    for (uint32_t t = 6 * along; t < 8 * along; ++t) { /* the fourth becomes the first, reversed */
        const uint32_t *from = fins.triangles + 3 * (size_t)(t - 6 * along);
        uint32_t *to = fins.triangles + 3 * (size_t)t;
        to[0] = from[0];
        to[1] = from[2];
        to[2] = from[1];
    }
    return fins;
}

soup shape_body(uint32_t around, uint32_t rings)
{
    soup s = soup_sphere(around, rings);
    for (uint32_t v = 0; v < s.vertex_count; ++v) {
        double *p = s.positions + 3 * (size_t)v;
        double x = p[2] + 0.5, lumps = 0.25 + 0.06 * sin(17 * x) + 0.02 * sin(9 * p[0] + 30 * x);
        p[2] = lumps * p[1];
        p[1] = lumps * p[0];
        p[0] = x;
    }
    return s;
}

soup shape_broken_cloth(uint32_t side)
{
    soup s = soup_cloth(side, side);
    for (uint32_t t = 1; t < s.triangle_count; ++t) {
        uint32_t *v = s.triangles + 3 * (size_t)t, a = v[0];
        const uint32_t *u = s.triangles + 3 * (size_t)test_random_below(t);
        switch (test_random_below(24)) {
        case 0:
            v[1] = a;
            break;
        case 1:
            v[1] = v[2] = a;
            break;
        case 2:
            memcpy(v, u, 3 * sizeof(uint32_t));
            break;
        case 3:
            v[0] = v[1];
            v[1] = a;
            break;
        default:
            break;
        }
    }
    return s;
}

soup shape_any(uint32_t maximum, const char **name)
{
    uint32_t side = (uint32_t)sqrt(maximum / 2.0);
    switch (test_random_below(16)) {
    case 0:
        *name = "spiral";
        return shape_spiral(2 * side, side / 2 + 1, test_random_range(0.5, 2), 0.3);
    case 1:
        *name = "hub";
        return shape_hub(maximum / 3 + 1);
    case 2:
        *name = "fan of sheets";
        return shape_fan_of_sheets(maximum / 8 + 1);
    case 3:
        *name = "body";
        return shape_body(side < 3 ? 3 : side, side);
    case 4:
        *name = "broken cloth";
        return shape_broken_cloth(side);
    default:
        return soup_any_mesh(maximum, name);
    }
}

void shape_bend(double *positions, uint32_t count, double turns)
{
    for (uint32_t v = 0; v < count; ++v) {
        double *p = positions + 3 * (size_t)v;
        double angle = 2 * pi * turns * p[0], radius = 1 / (2 * pi * turns) - p[1];
        p[0] = radius * sin(angle);
        p[1] = 1 / (2 * pi * turns) - radius * cos(angle);
    }
}

int shape_read_ply(const char *path, soup *s)
{
    char line[256];
    unsigned vertices = 0, faces = 0;
    int ok = 1;
    FILE *file = fopen(path, "rb");
    memset(s, 0, sizeof(*s));
    if (file == NULL) return 0;
    while (fgets(line, sizeof(line), file) != NULL && strncmp(line, "end_header", 10) != 0) {
        if (sscanf(line, "element vertex %u", &vertices) == 1) continue;
        if (sscanf(line, "element face %u", &faces) == 1) continue;
    }
    *s = soup_make(vertices, faces);
    for (uint32_t v = 0; v < vertices && ok; ++v) {
        float p[3];
        ok = fread(p, sizeof(p), 1, file) == 1;
        for (int k = 0; k < 3 && ok; ++k) s->positions[3 * (size_t)v + (size_t)k] = (double)p[k];
    }
    for (uint32_t t = 0; t < faces && ok; ++t)
        ok = fgetc(file) == 3 && fread(s->triangles + 3 * (size_t)t, 12, 1, file) == 1;
    fclose(file);
    if (ok && faces != 0) return 1;
    soup_free(s);
    return 0;
}
