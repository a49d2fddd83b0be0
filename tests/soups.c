/*
 * Makers of triangle soups: see soups.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "soups.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "harness.h"

static const double pi = 3.14159265358979323846;

soup soup_make(uint32_t vertex_count, uint32_t triangle_count)
{
    soup s;
    s.vertex_count = vertex_count;
    s.triangle_count = triangle_count;
    s.positions = (double *)test_allocate(3 * (size_t)vertex_count * sizeof(double));
    s.triangles = (uint32_t *)test_allocate(3 * (size_t)triangle_count * sizeof(uint32_t));
    return s;
}

soup soup_copy(const soup *source)
{
    soup s = soup_make(source->vertex_count, source->triangle_count);
    memcpy(s.positions, source->positions, 3 * (size_t)s.vertex_count * sizeof(double));
    memcpy(s.triangles, source->triangles, 3 * (size_t)s.triangle_count * sizeof(uint32_t));
    return s;
}

double *soup_copy_positions(const soup *source)
{
    size_t bytes = 3 * (size_t)source->vertex_count * sizeof(double);
    double *copy = (double *)test_allocate(bytes);
    memcpy(copy, source->positions, bytes);
    return copy;
}

void soup_free(soup *s)
{
    free(s->positions);
    free(s->triangles);
    memset(s, 0, sizeof(*s));
}

static void set_point(soup *s, uint32_t vertex, double x, double y, double z)
{
    double *p = s->positions + 3 * (size_t)vertex;
    p[0] = x;
    p[1] = y;
    p[2] = z;
}

static void set_triangle(soup *s, uint32_t triangle, uint32_t a, uint32_t b, uint32_t c)
{
    uint32_t *v = s->triangles + 3 * (size_t)triangle;
    v[0] = a;
    v[1] = b;
    v[2] = c;
}

/* Makes triangle a copy of an earlier one, turned or flipped. */
static void duplicate_triangle(soup *s, uint32_t triangle)
{
    const uint32_t *v = s->triangles + 3 * (size_t)test_random_below(triangle);
    uint32_t turn = test_random_below(3);
    uint32_t a = v[turn], b = v[(turn + 1) % 3], c = v[(turn + 2) % 3];
    if (test_random_below(2) != 0) {
        set_triangle(s, triangle, a, b, c);
    } else {
        set_triangle(s, triangle, a, c, b);
    }
}

static void random_triangles(soup *s)
{
    uint32_t fan = test_random_below(5), duplicates = test_random_below(4);
    for (uint32_t t = 0; t < s->triangle_count; ++t) {
        uint32_t a = test_random_below(s->vertex_count), b = test_random_below(s->vertex_count);
        uint32_t c = test_random_below(s->vertex_count);
        if (t > 0 && duplicates == 0 && test_random_below(4) == 0) {
            duplicate_triangle(s, t);
            continue;
        }
        if (test_random_below(16) != 0) { /* mostly three different vertices, if there are three */
            for (int tries = 0; tries < 8 && b == a; ++tries)
                b = test_random_below(s->vertex_count);
            for (int tries = 0; tries < 8 && (c == a || c == b); ++tries)
                c = test_random_below(s->vertex_count);
        }
        if (fan == 0 && s->vertex_count > 2) { /* all around one edge, both ways */
            a = t & 1;
            b = 1 - a;
            if (test_random_below(8) != 0) c = 2 + test_random_below(s->vertex_count - 2);
        }
        set_triangle(s, t, a, b, c);
    }
}

soup soup_on_grid(uint32_t range)
{
    uint32_t limit = test_random_below(3) == 0 ? 39 : 11;
    uint32_t triangle_count = 2 + test_random_below(limit);
    uint32_t vertex_count = 3 + test_random_below(3 * triangle_count);
    uint32_t shape = test_random_below(8);
    soup s = soup_make(vertex_count, triangle_count);
    for (uint32_t v = 0; v < vertex_count; ++v) {
        double x = test_random_below(range + 1), y = test_random_below(range + 1);
        double z = test_random_below(range + 1);
        if (shape == 0) z = 0;
        if (shape == 1) z = x + y; /* an oblique plane */
        if (shape == 2) y = z = x; /* a line */
        if (shape == 3) y = z = 0;
        set_point(&s, v, x, y, z);
    }
    random_triangles(&s);
    return s;
}

soup soup_scattered(void)
{
    uint32_t triangle_count = 2 + test_random_below(39);
    uint32_t vertex_count = 3 + test_random_below(3 * triangle_count);
    uint32_t shape = test_random_below(4);
    soup s = soup_make(vertex_count, triangle_count);
    for (uint32_t v = 0; v < vertex_count; ++v) {
        double x = test_random_unit(), y = test_random_unit(), z = test_random_unit();
        if (shape == 1) z *= 1e-9; /* nearly flat */
        if (shape == 2) {          /* very unequal */
            double size = exp2(-(double)test_random_below(40));
            x *= size;
            y *= size;
            z *= size;
        }
        set_point(&s, v, x, y, z);
    }
    random_triangles(&s);
    return s;
}

/*
 * Two triangles for each cell of a grid of vertices, row by row; wrap joins the last column to the
 * first. Diagonals alternate if asked to. Returns the next free triangle.
 */
static uint32_t add_cells(soup *s, uint32_t triangle, uint32_t first, uint32_t columns,
                          uint32_t rows, int wrap)
{
    uint32_t cells = wrap ? columns : columns - 1;
    for (uint32_t j = 0; j + 1 < rows; ++j) {
        for (uint32_t i = 0; i < cells; ++i) {
            uint32_t right = (i + 1) % columns;
            uint32_t a = first + j * columns + i, b = first + j * columns + right;
            uint32_t c = a + columns, d = b + columns;
            if ((i + j) % 2 == 0) {
                set_triangle(s, triangle++, a, b, d);
                set_triangle(s, triangle++, a, d, c);
            } else {
                set_triangle(s, triangle++, a, b, c);
                set_triangle(s, triangle++, b, d, c);
            }
        }
    }
    return triangle;
}

soup soup_cloth(uint32_t across, uint32_t along)
{
    uint32_t columns = along + 1, rows = across + 1;
    soup s = soup_make(columns * rows, 2 * along * across);
    for (uint32_t j = 0; j < rows; ++j) {
        for (uint32_t i = 0; i < columns; ++i)
            set_point(&s, j * columns + i, (double)i / along, (double)j / across, 0);
    }
    add_cells(&s, 0, 0, columns, rows, 0);
    return s;
}

soup soup_tube(uint32_t around, uint32_t along)
{
    soup s = soup_make(around * (along + 1), 2 * around * along);
    for (uint32_t j = 0; j <= along; ++j) {
        for (uint32_t i = 0; i < around; ++i) {
            double angle = 2 * pi * i / around;
            set_point(&s, j * around + i, (double)j / along, 0.25 * cos(angle), 0.25 * sin(angle));
        }
    }
    add_cells(&s, 0, 0, around, along + 1, 1);
    return s;
}

soup soup_sphere(uint32_t around, uint32_t rings)
{
    uint32_t south = around * rings, north = south + 1, triangle;
    soup s = soup_make(around * rings + 2, 2 * around * rings);
    for (uint32_t j = 0; j < rings; ++j) {
        double height = pi * (j + 1) / (rings + 1);
        for (uint32_t i = 0; i < around; ++i) {
            double angle = 2 * pi * i / around;
            set_point(&s, j * around + i, 0.5 * sin(height) * cos(angle),
                      0.5 * sin(height) * sin(angle), -0.5 * cos(height));
        }
    }
    set_point(&s, south, 0, 0, -0.5);
    set_point(&s, north, 0, 0, 0.5);
    triangle = add_cells(&s, 0, 0, around, rings, 1);
    for (uint32_t i = 0; i < around; ++i) {
        uint32_t next = (i + 1) % around, top = around * (rings - 1);
        set_triangle(&s, triangle++, south, next, i);
        set_triangle(&s, triangle++, north, top + i, top + next);
    }
    return s;
}

soup soup_annulus(uint32_t around, uint32_t rings)
{
    soup s = soup_make(around * (rings + 1), 2 * around * rings);
    for (uint32_t j = 0; j <= rings; ++j) {
        double radius = 0.2 + 0.3 * j / rings;
        for (uint32_t i = 0; i < around; ++i) {
            double angle = 2 * pi * i / around;
            set_point(&s, j * around + i, radius * cos(angle), radius * sin(angle), 0);
        }
    }
    add_cells(&s, 0, 0, around, rings + 1, 1);
    return s;
}

soup soup_moebius(uint32_t around, uint32_t across)
{
    uint32_t rows = across + 1, triangle = 0;
    soup s = soup_make(around * rows, 2 * around * across);
    for (uint32_t i = 0; i < around; ++i) {
        double angle = 2 * pi * i / around;
        for (uint32_t j = 0; j < rows; ++j) {
            double w = 0.2 * ((double)j / across - 0.5), radius = 0.5 + w * cos(angle / 2);
            set_point(&s, i * rows + j, radius * cos(angle), radius * sin(angle),
                      w * sin(angle / 2));
        }
    }
    for (uint32_t i = 0; i < around; ++i) {
        for (uint32_t j = 0; j < across; ++j) {
            uint32_t last = i + 1 == around;
            uint32_t a = i * rows + j, b = a + 1;
            uint32_t c = last ? across - j : a + rows, d = last ? across - j - 1 : b + rows;
            set_triangle(&s, triangle++, a, c, b);
            set_triangle(&s, triangle++, b, c, d);
        }
    }
    return s;
}

soup soup_pinched(uint32_t across)
{
    soup a = soup_cloth(across, across), b = soup_cloth(across, across), s;
    uint32_t corner = a.vertex_count - 1; /* (1, 1, 0) of a is (0, 0, 0) of b */
    for (uint32_t v = 0; v < b.vertex_count; ++v)
        set_point(&b, v, b.positions[3 * v] + 1, b.positions[3 * v + 1] + 1, 0);
    s = soup_join(&a, &b);
    for (uint32_t c = 0; c < 3 * s.triangle_count; ++c) {
        if (s.triangles[c] == a.vertex_count) s.triangles[c] = corner;
    }
    soup_free(&a);
    soup_free(&b);
    return s;
}

soup soup_fins(uint32_t along)
{
    static const double directions[4][2] = {{1, 0}, {0, 1}, {-1, 0}, {0.6, 0.8}};
    uint32_t columns = along + 1, triangle = 0;
    soup s = soup_make(5 * columns, 8 * along);
    for (uint32_t i = 0; i < columns; ++i) {
        double x = (double)i / along;
        set_point(&s, i, x, 0, 0);
        for (uint32_t fin = 0; fin < 4; ++fin)
            set_point(&s, (fin + 1) * columns + i, x, 0.5 * directions[fin][0],
                      0.5 * directions[fin][1]);
    }
    for (uint32_t fin = 0; fin < 4; ++fin) {
        for (uint32_t i = 0; i < along; ++i) {
            uint32_t a = i, b = i + 1, c = (fin + 1) * columns + i, d = c + 1;
            set_triangle(&s, triangle++, a, b, d);
            set_triangle(&s, triangle++, a, d, c);
        }
    }
    return s;
}

soup soup_join(const soup *a, const soup *b)
{
    soup s = soup_make(a->vertex_count + b->vertex_count, a->triangle_count + b->triangle_count);
    memcpy(s.positions, a->positions, 3 * (size_t)a->vertex_count * sizeof(double));
    memcpy(s.positions + 3 * (size_t)a->vertex_count, b->positions,
           3 * (size_t)b->vertex_count * sizeof(double));
    memcpy(s.triangles, a->triangles, 3 * (size_t)a->triangle_count * sizeof(uint32_t));
    for (uint32_t c = 0; c < 3 * b->triangle_count; ++c)
        s.triangles[3 * a->triangle_count + c] = b->triangles[c] + a->vertex_count;
    return s;
}

soup soup_many(uint32_t components)
{
    soup s = soup_make(0, 0);
    for (uint32_t i = 0; i < components; ++i) {
        uint32_t kind = test_random_below(3);
        soup part = kind == 0 ? soup_cloth(2, 3) : kind == 1 ? soup_sphere(5, 2) : soup_make(3, 1);
        soup joined;
        if (kind == 2) {
            memset(part.positions, 0, 9 * sizeof(double));
            soup_noise(part.positions, 3, 0.5);
            set_triangle(&part, 0, 0, 1, 2);
        }
        soup_scale(part.positions, part.vertex_count, test_random_range(0.1, 0.6));
        for (uint32_t k = 0; k < 3; ++k) {
            double offset = test_random_unit();
            for (uint32_t v = 0; v < part.vertex_count; ++v) part.positions[3 * v + k] += offset;
        }
        joined = soup_join(&s, &part);
        soup_free(&s);
        soup_free(&part);
        s = joined;
    }
    return s;
}

soup soup_slivers(uint32_t count)
{
    soup s = soup_make(count + 2, count);
    set_point(&s, 0, 0, 0, 0);
    for (uint32_t i = 0; i <= count; ++i) {
        double angle = 1e-6 * i;
        set_point(&s, i + 1, cos(angle), sin(angle), 1e-7 * (i % 2));
    }
    for (uint32_t i = 0; i < count; ++i) set_triangle(&s, i, 0, i + 1, i + 2);
    return s;
}

soup soup_spiral(uint32_t along, uint32_t across, double turns)
{
    uint32_t columns = along + 1, rows = across + 1;
    double pitch = test_random_range(0, 0.3);
    soup s = soup_make(columns * rows, 2 * along * across);
    for (uint32_t j = 0; j < rows; ++j) {
        for (uint32_t i = 0; i < columns; ++i) {
            double angle = 2 * pi * turns * i / along;
            double radius = 0.6 - 0.2 * j / across - pitch * i / along;
            set_point(&s, j * columns + i, radius * cos(angle), radius * sin(angle), 0);
        }
    }
    add_cells(&s, 0, 0, columns, rows, 0);
    return s;
}

soup soup_flower(uint32_t petals, uint32_t across)
{
    uint32_t columns = across + 1, each = columns * across, triangle = 0;
    soup s = soup_make(1 + petals * each, petals * across * (2 * across - 1));
    set_point(&s, 0, 0, 0, 0);
    for (uint32_t petal = 0; petal < petals; ++petal) {
        double start = test_random_range(0, 2 * pi), width = test_random_range(0.2, 2.8);
        uint32_t first = 1 + petal * each;
        for (uint32_t j = 0; j < across; ++j) {
            double radius = (double)(j + 1) / across;
            for (uint32_t i = 0; i < columns; ++i) {
                double angle = start + width * i / across;
                set_point(&s, first + j * columns + i, radius * cos(angle), radius * sin(angle), 0);
            }
        }
        for (uint32_t i = 0; i < across; ++i)
            set_triangle(&s, triangle++, 0, first + i, first + i + 1);
        for (uint32_t j = 0; j + 1 < across; ++j) {
            for (uint32_t i = 0; i < across; ++i) {
                uint32_t a = first + j * columns + i;
                set_triangle(&s, triangle++, a, a + columns, a + columns + 1);
                set_triangle(&s, triangle++, a, a + columns + 1, a + 1);
            }
        }
    }
    return s;
}

soup soup_branched(uint32_t around, uint32_t rings)
{
    uint32_t triangle = 0;
    soup s = soup_make(1 + around * rings, around * (2 * rings - 1));
    set_point(&s, 0, 0, 0, 0);
    for (uint32_t j = 0; j < rings; ++j) {
        double radius = 0.5 * (j + 1) / rings;
        for (uint32_t i = 0; i < around; ++i) {
            double angle = 4 * pi * i / around;
            set_point(&s, 1 + j * around + i, radius * cos(angle), radius * sin(angle), 0);
        }
    }
    for (uint32_t i = 0; i < around; ++i)
        set_triangle(&s, triangle++, 0, 1 + i, 1 + (i + 1) % around);
    for (uint32_t j = 0; j + 1 < rings; ++j) {
        for (uint32_t i = 0; i < around; ++i) {
            uint32_t a = 1 + j * around + i, b = 1 + j * around + (i + 1) % around;
            set_triangle(&s, triangle++, a, a + around, b + around);
            set_triangle(&s, triangle++, a, b + around, b);
        }
    }
    return s;
}

soup soup_seams(uint32_t across)
{
    soup cloth = soup_cloth(across, across);
    soup s = soup_make(3 * cloth.triangle_count, cloth.triangle_count);
    for (uint32_t c = 0; c < 3 * s.triangle_count; ++c) {
        const double *p = cloth.positions + 3 * cloth.triangles[c];
        set_point(&s, c, p[0], p[1], p[2]);
        s.triangles[c] = c;
    }
    soup_free(&cloth);
    return s;
}

soup soup_any_mesh(uint32_t maximum, const char **name)
{
    uint32_t side = (uint32_t)sqrt(maximum / 2.0);
    uint32_t a = 3 + test_random_below(side < 4 ? 1 : side - 2);
    uint32_t b = 2 + test_random_below(side < 3 ? 1 : side - 1);
    switch (test_random_below(12)) {
    case 0:
        *name = "cloth";
        return soup_cloth(a, b);
    case 1:
        *name = "tube";
        return soup_tube(a, b);
    case 2:
        *name = "sphere";
        return soup_sphere(a, b);
    case 3:
        *name = "annulus";
        return soup_annulus(a, b);
    case 4:
        *name = "moebius";
        return soup_moebius(a, b);
    case 5:
        *name = "pinched";
        return soup_pinched(2 + test_random_below(side * 2 / 3));
    case 6:
        *name = "fins";
        return soup_fins(1 + test_random_below(maximum / 8));
    case 7:
        *name = "many";
        return soup_many(2 + test_random_below(maximum / 12));
    case 8:
        *name = "slivers";
        return soup_slivers(2 + test_random_below(maximum));
    default:
        *name = "seams";
        return soup_seams(a);
    }
}

void soup_smooth(double *positions, uint32_t count, double amplitude)
{
    for (int wave = 0; wave < 3; ++wave) {
        double k[3], push[3], phase = test_random_range(0, 2 * pi);
        for (int i = 0; i < 3; ++i) {
            k[i] = test_random_range(-6, 6);
            push[i] = test_random_range(-amplitude, amplitude);
        }
        for (uint32_t v = 0; v < count; ++v) {
            double *p = positions + 3 * (size_t)v;
            double height = sin(k[0] * p[0] + k[1] * p[1] + k[2] * p[2] + phase);
            for (int i = 0; i < 3; ++i) p[i] += push[i] * height;
        }
    }
}

void soup_noise(double *positions, uint32_t count, double amplitude)
{
    for (size_t i = 0; i < 3 * (size_t)count; ++i)
        positions[i] += test_random_range(-amplitude, amplitude);
}

void soup_twist(double *positions, uint32_t count, double turns)
{
    for (uint32_t v = 0; v < count; ++v) {
        double *p = positions + 3 * (size_t)v;
        double angle = 2 * pi * turns * p[0], y = p[1] - 0.4, z = p[2];
        p[1] = 0.4 + cos(angle) * y - sin(angle) * z;
        p[2] = sin(angle) * y + cos(angle) * z;
    }
}

void soup_fold(double *positions, uint32_t count)
{
    double x = positions[3 * (size_t)test_random_below(count)];
    for (uint32_t v = 0; v < count; ++v) {
        double *p = positions + 3 * (size_t)v;
        if (p[0] > x) p[0] = x - (p[0] - x);
    }
}

void soup_crush(double *positions, uint32_t count)
{
    uint32_t axis = test_random_below(3);
    for (uint32_t v = 0; v < count; ++v) positions[3 * (size_t)v + axis] = 0;
}

void soup_shuffle(double *positions, uint32_t count)
{
    for (uint32_t v = count; v > 1; --v) {
        double *p = positions + 3 * (size_t)(v - 1);
        double *q = positions + 3 * (size_t)test_random_below(v);
        for (int i = 0; i < 3; ++i) {
            double swap = p[i];
            p[i] = q[i];
            q[i] = swap;
        }
    }
}

void soup_snap(double *positions, uint32_t count, double step)
{
    for (size_t i = 0; i < 3 * (size_t)count; ++i)
        positions[i] = step * floor(positions[i] / step + 0.5);
}

void soup_scale(double *positions, uint32_t count, double factor)
{
    for (size_t i = 0; i < 3 * (size_t)count; ++i) positions[i] *= factor;
}

void soup_move(double *positions, uint32_t count, double offset)
{
    for (size_t i = 0; i < 3 * (size_t)count; ++i) positions[i] += offset;
}

void soup_nudge(double *positions, uint32_t count)
{
    for (size_t i = 0; i < 3 * (size_t)count; ++i) {
        uint32_t steps = test_random_below(3);
        double to = test_random_below(2) != 0 ? HUGE_VAL : -HUGE_VAL;
        while (steps-- > 0) positions[i] = nextafter(positions[i], to);
    }
}

void soup_round_to_float(double *positions, uint32_t count)
{
    for (size_t i = 0; i < 3 * (size_t)count; ++i) positions[i] = (double)(float)positions[i];
}

void soup_any_pose(double *positions, uint32_t count)
{
    switch (test_random_below(12)) {
    case 0:
        break;
    case 1:
        soup_smooth(positions, count, 0.05);
        break;
    case 2:
        soup_smooth(positions, count, 0.5);
        break;
    case 3:
        soup_noise(positions, count, 0.01);
        break;
    case 4:
        soup_noise(positions, count, 0.3);
        break;
    case 5:
        soup_twist(positions, count, test_random_range(0.2, 3));
        break;
    case 6:
        soup_fold(positions, count);
        break;
    case 7:
        soup_crush(positions, count);
        break;
    case 8:
        soup_shuffle(positions, count);
        break;
    case 9:
        soup_smooth(positions, count, 0.3);
        soup_snap(positions, count, 0.125);
        break;
    case 10:
        soup_fold(positions, count);
        soup_twist(positions, count, 0.5);
        soup_smooth(positions, count, 0.1);
        break;
    default:
        soup_twist(positions, count, 1);
        soup_crush(positions, count);
        break;
    }
    switch (test_random_below(8)) {
    case 0:
        soup_nudge(positions, count);
        break;
    case 1:
        soup_move(positions, count, 1e6);
        break;
    case 2:
        soup_scale(positions, count, test_random_below(2) != 0 ? 1e30 : 1e-30);
        break;
    case 3:
        soup_snap(positions, count, 0x1p-12);
        break;
    default:
        break;
    }
}
