/*
 * make-meshes: writes the small meshes of this folder as OBJ files. README.md says what is known of
 * each, expected.csv how many pairs each has.
 *
 * SPDX-License-Identifier: MIT
 *
 * Usage: make-meshes FOLDER
 *
 * All coordinates are multiples of 1/1024 and are written in full, so that a reader gets the same
 * numbers in float, double or whole 1024ths, and the files do not depend on the machine's sine.
 */
#include "starcontour.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_VERTICES = 2000, MAX_TRIANGLES = 3000 };

/* The mesh that is being made. */
typedef struct drawing {
    double points[MAX_VERTICES][3];
    int triangles[MAX_TRIANGLES][3];
    int point_count, triangle_count;
} drawing;

static const double pi = 3.14159265358979323846;

static int point(drawing *d, double x, double y, double z)
{
    const double given[3] = {x, y, z};
    if (d->point_count == MAX_VERTICES) abort();
    for (int k = 0; k < 3; k++) d->points[d->point_count][k] = floor(given[k] * 1024 + 0.5) / 1024;
    return d->point_count++;
}

static void triangle(drawing *d, int a, int b, int c)
{
    if (d->triangle_count == MAX_TRIANGLES) abort();
    d->triangles[d->triangle_count][0] = a;
    d->triangles[d->triangle_count][1] = b;
    d->triangles[d->triangle_count++][2] = c;
}

static void quad(drawing *d, int a, int b, int c, int e)
{
    triangle(d, a, b, c);
    triangle(d, a, c, e);
}

/*
 * Triangles between columns + 1 by rows + 1 points that were put row by row from first on. A closed
 * direction has no last column or row of points: it goes on with the first.
 */
static void net(drawing *d, int first, int columns, int rows, bool close_columns, bool close_rows)
{
    const int width = close_columns ? columns : columns + 1;
    const int height = close_rows ? rows : rows + 1;
    for (int j = 0; j < rows; j++) {
        for (int i = 0; i < columns; i++) {
            const int i1 = (i + 1) % width, j1 = (j + 1) % height;
            quad(d, first + j * width + i, first + j * width + i1, first + j1 * width + i1,
                 first + j1 * width + i);
        }
    }
}

static int middle(drawing *d, int (*known)[3], int *known_count, int a, int b)
{
    const int low = a < b ? a : b, high = a < b ? b : a;
    for (int i = 0; i < *known_count; i++) {
        if (known[i][0] == low && known[i][1] == high) return known[i][2];
    }
    double m[3], length = 0;
    for (int k = 0; k < 3; k++) {
        m[k] = d->points[a][k] + d->points[b][k];
        length += m[k] * m[k];
    }
    length = sqrt(length);
    known[*known_count][0] = low;
    known[*known_count][1] = high;
    known[*known_count][2] = point(d, m[0] / length, m[1] / length, m[2] / length);
    return known[(*known_count)++][2];
}

/* An octahedron whose triangles were cut in four three times: 512 triangles. */
static void make_sphere(drawing *d)
{
    static int known[MAX_TRIANGLES][3];
    for (int k = 0; k < 6; k++) {
        const double s = k < 3 ? 1 : -1;
        point(d, k % 3 == 0 ? s : 0, k % 3 == 1 ? s : 0, k % 3 == 2 ? s : 0);
    }
    for (int k = 0; k < 8; k++) {
        const int x = k & 1 ? 3 : 0, y = k & 2 ? 4 : 1, z = k & 4 ? 5 : 2;
        const bool even = ((k & 1) + (k >> 1 & 1) + (k >> 2 & 1)) % 2 == 0;
        triangle(d, x, even ? y : z, even ? z : y);
    }
    for (int level = 0; level < 3; level++) {
        const int count = d->triangle_count;
        int known_count = 0;
        for (int t = 0; t < count; t++) {
            const int a = d->triangles[t][0], b = d->triangles[t][1], c = d->triangles[t][2];
            const int ab = middle(d, known, &known_count, a, b);
            const int bc = middle(d, known, &known_count, b, c);
            const int ca = middle(d, known, &known_count, c, a);
            const int inner[3] = {ab, bc, ca};
            memcpy(d->triangles[t], inner, sizeof inner);
            triangle(d, a, ab, ca);
            triangle(d, b, bc, ab);
            triangle(d, c, ca, bc);
        }
    }
}

static void tetrahedron(drawing *d, double x, double y, double z, double size)
{
    const int a = point(d, x, y, z), b = point(d, x + size, y, z);
    const int c = point(d, x, y + size, z), e = point(d, x, y, z + size);
    triangle(d, a, c, b);
    triangle(d, a, b, e);
    triangle(d, a, e, c);
    triangle(d, b, c, e);
}

static void make_crossing_tetrahedra(drawing *d)
{
    tetrahedron(d, 0, 0, 0, 4);
    tetrahedron(d, 0.5, 0.625, 0.75, 4);
}

/* The two halves of the strip roll up, one to each side, the more the farther from the middle. */
static void make_twisted_strip(drawing *d)
{
    for (int j = 0; j <= 12; j++) {
        for (int i = 0; i <= 40; i++) {
            const double u = i / 20.0 - 1, v = j / 6.0 - 0.9375;
            const double angle = 2.5 * u * v + 0.3;
            point(d, 2 * u, v * cos(angle), v * sin(angle));
        }
    }
    net(d, 0, 40, 12, false, false);
}

/* Columns after the fifth lie back on the others, stretched and sheared so that no points meet. */
static void make_folded_sheet(drawing *d)
{
    for (int j = 0; j <= 4; j++) {
        for (int i = 0; i <= 8; i++) {
            const double over = i > 5 ? i - 5 : 0;
            point(d, i > 5 ? 5 - 0.75 * over : i, j + 0.25 * over, 0);
        }
    }
    net(d, 0, 8, 4, false, false);
}

static void cube(drawing *d, double x, double y, double z)
{
    const int first = d->point_count;
    for (int k = 0; k < 8; k++) point(d, x + (k & 1), y + (k >> 1 & 1), z + (k >> 2));
    static const int sides[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                    {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    for (int s = 0; s < 6; s++) {
        quad(d, first + sides[s][0], first + sides[s][1], first + sides[s][2], first + sides[s][3]);
    }
}

static void make_touching_cubes(drawing *d)
{
    cube(d, 0, 0, 0);
    cube(d, 1, 0.25, 0.5);
}

/* Five pages on one spine. */
static void make_fan(drawing *d)
{
    const int a = point(d, 0, 0, 0), b = point(d, 0, 0, 1);
    for (int k = 0; k < 5; k++) {
        const double angle = 2 * pi * k / 5;
        const int c = point(d, cos(angle), sin(angle), 0.5);
        if (k % 2)
            triangle(d, a, b, c);
        else
            triangle(d, b, a, c);
    }
}

static void make_moebius(drawing *d)
{
    const int length = 60, width = 4;
    for (int i = 0; i < length; i++) {
        const double t = 2 * pi * i / length;
        for (int j = 0; j <= width; j++) {
            const double s = 0.5 * (2.0 * j / width - 1);
            const double r = 2 + s * cos(t / 2);
            point(d, r * cos(t), r * sin(t), s * sin(t / 2));
        }
    }
    for (int i = 0; i < length; i++) {
        for (int j = 0; j < width; j++) {
            const int a = i * (width + 1) + j;
            const bool last = i == length - 1;
            quad(d, a, last ? width - j : a + width + 1, last ? width - j - 1 : a + width + 2,
                 a + 1);
        }
    }
}

/* A tetrahedron whose faces are there three times: as they are, turned round, and reversed. */
static void make_duplicates(drawing *d)
{
    tetrahedron(d, 0, 0, 0, 1);
    for (int t = 0; t < 4; t++) {
        const int a = d->triangles[t][0], b = d->triangles[t][1], c = d->triangles[t][2];
        triangle(d, b, c, a);
        triangle(d, c, b, a);
    }
}

static void loose_triangle(drawing *d, const double corners[9])
{
    int v[3];
    for (int k = 0; k < 3; k++)
        v[k] = point(d, corners[3 * k], corners[3 * k + 1], corners[3 * k + 2]);
    triangle(d, v[0], v[1], v[2]);
}

/* One good triangle and what has no area: points, needles and doubled corners, on it and off it. */
static void make_degenerate_soup(drawing *d)
{
    static const double soup[][9] = {
        {0, 0, 0, 8, 0, 0, 0, 8, 0},                   /* the good one, in the plane z = 0 */
        {2, 2, 0, 2, 2, 0, 2, 2, 0},                   /* a point inside it */
        {4, 0, 0, 4, 0, 0, 4, 0, 0},                   /* a point on its side */
        {2, 2, 1, 2, 2, 1, 2, 2, 1},                   /* a point above */
        {1, 3, -1, 1, 3, 1, 1, 3, 2},                  /* a needle through it */
        {3, 1, 0, 3, 1, 2, 3, 1, 4},                   /* a needle that stands on it */
        {-1, 1, 0, 3, 3, 0, 5, 4, 0},                  /* a needle in its plane, across it */
        {9, 9, 0, 10, 10, 0, 12, 12, 0},               /* a needle in its plane, beside it */
        {5, 1, -2, 5, 1, 2, 5, 1, 2},                  /* a doubled corner: a segment through it */
        {5, 1, 3, 5, 1, 5, 5, 1, 5},                   /* the same line, above */
        {11, 11, 0, 13, 13, 0, 14, 14, 0},             /* overlaps the needle beside */
        {9, 12, 0, 11, 10.5, 0, 12.5, 9.375, 0},       /* a needle across the two beside */
        {11.5, 11.5, 0, 11.5, 11.5, 0, 11.5, 11.5, 0}, /* a point on those two */
    };
    for (size_t t = 0; t < sizeof soup / sizeof soup[0]; t++) loose_triangle(d, soup[t]);
}

/* A tube whose middle line is a flat figure of eight: its two arms go through each other. */
static void make_figure_eight_tube(drawing *d)
{
    const int length = 60, round = 10;
    for (int i = 0; i < length; i++) {
        const double t = 2 * pi * (i + 0.3) / length;
        const double dx = 3 * cos(t), dy = 3 * cos(2 * t), speed = sqrt(dx * dx + dy * dy);
        for (int j = 0; j < round; j++) {
            const double angle = 2 * pi * (j + 0.2) / round, side = 0.4 * cos(angle);
            point(d, 3 * sin(t) - side * dy / speed, 1.5 * sin(2 * t) + side * dx / speed,
                  0.4 * sin(angle));
        }
    }
    net(d, 0, round, length, true, true);
}

static double wave(double x, double y)
{
    return 0.25 * sin(2 * x) + 0.125 * cos(3 * y + x);
}

/* Two pieces of cloth that meet along a seam where each has points of its own. */
static void make_seam_cloth(drawing *d)
{
    for (int piece = 0; piece < 2; piece++) {
        const int first = d->point_count;
        for (int j = 0; j <= 12; j++) {
            for (int i = 0; i <= 8; i++) {
                const double x = (8 * piece + i) / 4.0, y = j / 4.0;
                point(d, x, y, wave(x, y));
            }
        }
        net(d, first, 8, 12, false, false);
    }
}

static void make_crossing_cloths(drawing *d)
{
    for (int piece = 0; piece < 2; piece++) {
        const int first = d->point_count;
        for (int j = 0; j <= 12; j++) {
            for (int i = 0; i <= 12; i++) {
                const double x = i / 4.0, y = j / 4.0;
                if (piece == 0)
                    point(d, x, y, wave(x, y));
                else
                    point(d, x + 0.1, 1.6 + 0.5 * wave(y, x), y - 1.4);
            }
        }
        net(d, first, 12, 12, false, false);
    }
}

/* Two cones with one apex. */
static void make_hourglass(drawing *d)
{
    const int apex = point(d, 0, 0, 0);
    for (int end = 0; end < 2; end++) {
        const int first = d->point_count;
        for (int k = 0; k < 12; k++) {
            point(d, cos(2 * pi * k / 12), sin(2 * pi * k / 12), end ? -1.5 : 1.5);
        }
        for (int k = 0; k < 12; k++) {
            const int a = first + k, b = first + (k + 1) % 12;
            triangle(d, apex, end ? b : a, end ? a : b);
        }
    }
}

/* A tetrahedron that stands with one corner inside a triangle. */
static void make_corner_on_face(drawing *d)
{
    tetrahedron(d, 0, 0, 0, 2);
    static const double floor_corners[9] = {-3, -3, 3, 4, -3, -0.5, -3, 4, -0.5};
    loose_triangle(d, floor_corners);
}

static void make_annulus(drawing *d)
{
    for (int j = 0; j <= 4; j++) {
        for (int i = 0; i < 48; i++) {
            const double angle = 2 * pi * i / 48, r = 1 + 0.25 * j;
            point(d, r * cos(angle), r * sin(angle), 0.125 * cos(3 * angle));
        }
    }
    net(d, 0, 48, 4, true, false);
}

/* A sheet rolled up in layers a sixteenth apart. */
static void make_roll(drawing *d)
{
    for (int j = 0; j <= 6; j++) {
        for (int i = 0; i <= 90; i++) {
            const double angle = 2 * pi * i / 30, r = 1 + 0.0625 * i / 30;
            point(d, r * cos(angle), r * sin(angle), j / 4.0);
        }
    }
    net(d, 0, 90, 6, false, false);
}

static bool write_obj(const drawing *d, const char *folder, const char *name)
{
    char path[1024];
    snprintf(path, sizeof path, "%s/%s.obj", folder, name);
    FILE *file = fopen(path, "w");
    if (!file) {
        perror(path);
        return false;
    }
    fprintf(file, "# %s, written by make-meshes\n", name);
    for (int i = 0; i < d->point_count; i++) {
        const double *p = d->points[i];
        fprintf(file, "v %.15g %.15g %.15g\n", p[0] + 0.0, p[1] + 0.0, p[2] + 0.0);
    }
    for (int i = 0; i < d->triangle_count; i++) {
        const int *v = d->triangles[i];
        fprintf(file, "f %d %d %d\n", v[0] + 1, v[1] + 1, v[2] + 1);
    }
    const bool written = !ferror(file);
    if (fclose(file) == 0 && written) return true;
    perror(path);
    return false;
}

int main(int argc, char **argv)
{
    static const struct {
        const char *name;
        void (*make)(drawing *);
    } meshes[] = {{"sphere", make_sphere},
                  {"crossing_tetrahedra", make_crossing_tetrahedra},
                  {"twisted_strip", make_twisted_strip},
                  {"folded_sheet", make_folded_sheet},
                  {"touching_cubes", make_touching_cubes},
                  {"fan", make_fan},
                  {"moebius", make_moebius},
                  {"duplicates", make_duplicates},
                  {"degenerate_soup", make_degenerate_soup},
                  {"figure_eight_tube", make_figure_eight_tube},
                  {"seam_cloth", make_seam_cloth},
                  {"crossing_cloths", make_crossing_cloths},
                  {"hourglass", make_hourglass},
                  {"corner_on_face", make_corner_on_face},
                  {"annulus", make_annulus},
                  {"roll", make_roll}};
    static drawing d;
    const char *folder = argc == 2 ? argv[1] : "-";
    if (strcmp(folder, "-V") == 0 || strcmp(folder, "--version") == 0) {
        printf("make-meshes (starcontour) %d.%d.%d\n", SC_VERSION_MAJOR, SC_VERSION_MINOR,
               SC_VERSION_PATCH);
        return 0;
    }
    if (folder[0] == '-') {
        const int is_asked = strcmp(folder, "-h") == 0 || strcmp(folder, "--help") == 0;
        fputs("Usage: make-meshes FOLDER\n", is_asked ? stdout : stderr);
        return is_asked ? 0 : 2;
    }
    for (size_t i = 0; i < sizeof meshes / sizeof meshes[0]; i++) {
        d.point_count = d.triangle_count = 0;
        meshes[i].make(&d);
        if (!write_obj(&d, folder, meshes[i].name)) return 2;
        printf("%s: %d vertices, %d triangles\n", meshes[i].name, d.point_count, d.triangle_count);
    }
    return 0;
}
