/*
 * Poses on the edge of a culling step: see adversaries.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "adversaries.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "harness.h"
#include "starcontour.h"

static const double pi = 3.14159265358979323846;

/* Under the projection of a flat mesh with normals along z, vertical lines run along (115, 46, 0)
   and horizontal ones across them. */
static const double upright[2] = {115, 46};

static uint32_t between(uint32_t low, uint32_t high)
{
    return low + test_random_below(high - low + 1);
}

static adversary start(uint32_t vertices, uint32_t triangles)
{
    adversary a;
    memset(&a, 0, sizeof(a));
    a.mesh = soup_make(vertices, 0);
    free(a.mesh.triangles);
    a.mesh.triangles = (uint32_t *)test_allocate(3 * (size_t)triangles * sizeof(uint32_t));
    a.twin = (uint32_t *)test_allocate(vertices * sizeof(uint32_t));
    for (uint32_t v = 0; v < vertices; ++v) a.twin[v] = SC_NONE;
    memset(a.mesh.positions, 0, 3 * (size_t)vertices * sizeof(double));
    a.ulps = test_random_below(3);
    return a;
}

void adversary_free(adversary *a)
{
    soup_free(&a->mesh);
    free(a->twin);
}

static double *point(adversary *a, uint32_t v)
{
    return a->mesh.positions + 3 * (size_t)v;
}

static void put(adversary *a, uint32_t v, double x, double y, double z)
{
    double *p = point(a, v);
    p[0] = x;
    p[1] = y;
    p[2] = z;
}

static void add(adversary *a, uint32_t p, uint32_t q, uint32_t r)
{
    uint32_t *t = a->mesh.triangles + 3 * (size_t)a->mesh.triangle_count++;
    t[0] = p;
    t[1] = q;
    t[2] = r;
}

/* Two triangles, normal along z if p, q, r, s run counter-clockwise. */
static void add_cell(adversary *a, uint32_t p, uint32_t q, uint32_t r, uint32_t s)
{
    if (test_random_below(2)) {
        add(a, p, q, r);
        add(a, p, r, s);
    } else {
        add(a, p, q, s);
        add(a, q, r, s);
    }
}

/* A grid of columns by rows vertices from first on, in z = 0. */
static void add_cloth(adversary *a, uint32_t first, uint32_t columns, uint32_t rows)
{
    for (uint32_t j = 0; j < rows; ++j)
        for (uint32_t i = 0; i < columns; ++i) put(a, first + j * columns + i, i, j, 0);
    for (uint32_t j = 0; j + 1 < rows; ++j)
        for (uint32_t i = 0; i + 1 < columns; ++i) {
            uint32_t v = first + j * columns + i;
            add_cell(a, v, v + 1, v + columns + 1, v + columns);
        }
}

/* Nothing, or a hair: 10 to a random power. */
static double hair(double low, double high)
{
    double h = pow(10, test_random_range(low, high));
    return test_random_below(2) ? h : -h;
}

/* An angle at which to begin: any, or one that the projection has upright or level, but for a
   hair. */
static double start_angle(adversary *a)
{
    if (test_random_below(2)) return test_random_range(0, 2 * pi);
    a->is_aligned = 1;
    return atan2(upright[1], upright[0]) + pi / 2 * test_random_below(4) +
           (test_random_below(4) ? hair(-13, -5) : 0);
}

/* Sectors of rings rings from first on: column i of vertices at angle from + i width / sectors.
   With center SC_NONE the innermost ring has no triangles inside. */
static void add_sectors(adversary *a, uint32_t center, uint32_t first, uint32_t sectors,
                        uint32_t rings, double from, double width)
{
    uint32_t columns = sectors + 1;
    for (uint32_t j = 0; j < rings; ++j)
        for (uint32_t i = 0; i < columns; ++i) {
            double angle = from + width * i / sectors;
            put(a, first + j * columns + i, (j + 1) * cos(angle), (j + 1) * sin(angle), 0);
        }
    for (uint32_t i = 0; center != SC_NONE && i < sectors; ++i)
        add(a, center, first + i, first + i + 1);
    for (uint32_t j = 0; j + 1 < rings; ++j)
        for (uint32_t i = 0; i < sectors; ++i) {
            uint32_t v = first + j * columns + i;
            add_cell(a, v, v + columns, v + columns + 1, v + 1);
        }
}

/* A little height, none at all in half of all cases. */
static void raise(adversary *a)
{
    uint32_t kind = test_random_below(6);
    double height = test_random_range(-0.3, 0.3);
    for (uint32_t v = 0; v < a->mesh.vertex_count; ++v) {
        double *p = point(a, v);
        if (kind == 0) p[2] += height * sin(p[0] + 0.3 * p[1]);
        if (kind == 1) p[2] += test_random_range(-0.02, 0.02);
        if (kind == 2) p[2] += height * (p[0] + 0.4 * p[1]);
    }
    if (kind < 3) a->is_aligned = 0;
}

adversary adversary_slit(void)
{
    uint32_t sectors = between(5, 9), rings = between(1, 2);
    uint32_t vertices = 1 + (sectors + 1) * rings;
    adversary a = start(vertices, sectors * (2 * rings - 1));
    uint32_t kind = test_random_below(4);
    double open = kind == 0 ? 0 : kind == 1 ? hair(-17, -6) : hair(-6, -0.3);
    if (kind > 1) open = fabs(open);
    add_sectors(&a, 0, 1, sectors, rings, start_angle(&a), 2 * pi - open);
    for (uint32_t j = 0; kind == 0 && j < rings; ++j)
        a.twin[1 + j * (sectors + 1) + sectors] = 1 + j * (sectors + 1);
    a.split = sectors;
    raise(&a);
    return a;
}

adversary adversary_strip(void)
{
    uint32_t sectors = between(6, 11), columns = sectors + 1, kind = test_random_below(4);
    adversary a = start(2 * columns, 2 * sectors);
    double from = start_angle(&a), open = kind < 2 ? 0 : kind == 2 ? hair(-16, -1) : hair(-2, 0.3);
    double inwards = kind == 1 ? 1 : test_random_below(2) ? 0 : test_random_range(-1, 1.2);
    add_sectors(&a, SC_NONE, 0, sectors, 2, 0, 1);
    for (uint32_t i = 0; i < columns; ++i)
        for (uint32_t j = 0; j < 2; ++j) {
            double angle = from + (2 * pi - open) * i / sectors;
            double radius = 1.5 + j - inwards * i / sectors;
            put(&a, j * columns + i, radius * cos(angle), radius * sin(angle), 0);
        }
    if (kind == 0) a.twin[sectors] = 0;
    if (kind == 0) a.twin[columns + sectors] = columns;
    if (kind == 1) a.twin[columns + sectors] = 0; /* its outer end at the inner beginning */
    a.split = test_random_below(2) ? 0 : between(1, 2 * sectors - 1);
    raise(&a);
    return a;
}

adversary adversary_petals(void)
{
    uint32_t petals = between(2, 4), sectors = between(2, 4), rings = between(1, 2);
    uint32_t each = (sectors + 1) * rings, halves = test_random_below(2);
    adversary a = start(1 + petals * each, petals * sectors * (2 * rings - 1));
    double angle = start_angle(&a), left = 2 * pi;
    for (uint32_t k = 0; k < petals; ++k) {
        uint32_t first = 1 + k * each;
        double width = petals == 2 && halves ? pi : fmin(left, test_random_range(0.5, 3));
        double gap = test_random_below(2) ? 0 : hair(-17, -1);
        add_sectors(&a, 0, first, sectors, rings, angle, width);
        if (k == 0) a.split = a.mesh.triangle_count;
        for (uint32_t j = 0; j < rings && gap == 0 && k > 0; ++j)
            a.twin[first + j * (sectors + 1)] = first - each + j * (sectors + 1) + sectors;
        angle += width + gap;
        left -= width;
        if (left < 0.1) left = 0.5; /* the rest lies on what is there */
    }
    for (uint32_t j = 0; j < rings && petals == 2 && halves; ++j)
        a.twin[1 + each + j * (sectors + 1) + sectors] = 1 + j * (sectors + 1);
    raise(&a);
    return a;
}

adversary adversary_doubled(void)
{
    uint32_t columns = between(3, 4), rows = between(2, 3), count = columns * rows;
    uint32_t cells = (columns - 1) * (rows - 1), share = between(1, 4), own = test_random_below(2);
    uint32_t turned = test_random_below(3);
    adversary a = start(2 * count, 4 * cells);
    add_cloth(&a, 0, columns, rows);
    a.split = test_random_below(2) ? 2 * cells : 0;
    for (uint32_t v = 0; v < count; ++v) {
        a.twin[count + v] = v;
        memcpy(point(&a, count + v), point(&a, v), 3 * sizeof(double));
    }
    for (uint32_t t = 0; t < 2 * cells; ++t) {
        const uint32_t *v = a.mesh.triangles + 3 * (size_t)t;
        uint32_t base = own ? count : 0, k = test_random_below(3);
        if (test_random_below(share)) continue;
        if (own == 1 && test_random_below(8) == 0) base = 0;
        if (turned == 0 || (turned == 1 && test_random_below(2)))
            add(&a, base + v[k], base + v[(k + 1) % 3], base + v[(k + 2) % 3]);
        else
            add(&a, base + v[k], base + v[(k + 2) % 3], base + v[(k + 1) % 3]);
    }
    raise(&a);
    return a;
}

adversary adversary_edge_on(const double direction[3])
{
    uint32_t columns = between(3, 4), rows = between(3, 4);
    adversary a = start(columns * rows, 2 * (columns - 1) * (rows - 1));
    double e[3], f[3], n[3], off = test_random_below(2) ? 0 : hair(-17, -6);
    uint32_t whole = test_random_below(2), rough = test_random_below(3);
    add_cloth(&a, 0, columns, rows);
    for (int k = 0; k < 3; ++k)
        e[k] = whole ? (double)test_random_below(9) - 4 : test_random_range(-1, 1);
    if (e[0] * direction[1] == e[1] * direction[0] && e[1] * direction[2] == e[2] * direction[1])
        e[0] += direction[1] != 0 || direction[2] != 0 ? 1 : 0, e[1] += direction[1] != 0 ? 0 : 1;
    for (int k = 0; k < 3; ++k) f[k] = direction[k] + (whole ? 0 : test_random_range(-2, 2)) * e[k];
    for (int k = 0; k < 3; ++k)
        n[k] = e[(k + 1) % 3] * f[(k + 2) % 3] - e[(k + 2) % 3] * f[(k + 1) % 3];
    for (uint32_t v = 0; v < a.mesh.vertex_count; ++v) {
        double *p = point(&a, v), x = p[0], y = p[1];
        double bump = rough ? 0 : hair(-18, -3);
        if (!whole) x += test_random_range(-0.2, 0.2);
        for (int k = 0; k < 3; ++k) p[k] = x * e[k] + y * f[k] + (off * x + off * y + bump) * n[k];
    }
    a.is_aligned = 1;
    return a;
}

adversary adversary_degenerate(void)
{
    uint32_t columns = between(3, 4), rows = between(3, 4), share = between(3, 9);
    adversary a = start(columns * rows, 2 * (columns - 1) * (rows - 1));
    add_cloth(&a, 0, columns, rows);
    raise(&a);
    for (uint32_t v = 0; v < a.mesh.vertex_count; ++v) {
        uint32_t u = test_random_below(a.mesh.vertex_count);
        double *p = point(&a, v);
        if (test_random_below(share)) continue;
        if (v % columns != 0) u = v - 1;
        if (test_random_below(2) && u < v) a.twin[v] = u;
        if (v + columns < a.mesh.vertex_count && test_random_below(2))
            for (int k = 0; k < 3; ++k) p[k] = point(&a, u)[k] / 2 + point(&a, v + columns)[k] / 2;
    }
    if (test_random_below(3) == 0) {
        double squeeze = fabs(hair(-18, -4));
        for (uint32_t v = 0; v < a.mesh.vertex_count; ++v) point(&a, v)[1] *= squeeze;
    }
    return a;
}

adversary adversary_moebius(void)
{
    uint32_t around = between(6, 14);
    soup s = soup_moebius(around, 1);
    adversary a = start(s.vertex_count, s.triangle_count);
    soup_free(&a.mesh);
    a.mesh = s;
    if (test_random_below(3) == 0) soup_snap(s.positions, s.vertex_count, 0.125);
    if (test_random_below(3) == 0) soup_crush(s.positions, s.vertex_count);
    return a;
}

adversary adversary_klein(void)
{
    enum { AROUND = 7, ACROSS = 6 };
    adversary a = start(AROUND * ACROSS, 2 * AROUND * ACROSS);
    double phase = test_random_below(2) ? 0 : test_random_range(0, 1); /* 0: along vertices */
    for (uint32_t i = 0; i < AROUND; ++i)
        for (uint32_t j = 0; j < ACROSS; ++j) {
            double u = 2 * pi * i / AROUND, v = 2 * pi * j / ACROSS;
            double r, s = sin(v), t = sin(2 * v);
            if (phase != 0) { /* crossing off the vertices; odd in v, as the gluing asks */
                s += 0.2 * phase * sin(3 * v);
                t += 0.3 * phase * sin(v);
            }
            r = 2 + cos(u / 2) * s - sin(u / 2) * t;
            put(&a, i * ACROSS + j, r * cos(u), r * sin(u), sin(u / 2) * s + cos(u / 2) * t);
        }
    for (uint32_t i = 0; i < AROUND; ++i)
        for (uint32_t j = 0; j < ACROSS; ++j) {
            uint32_t k = (j + 1) % ACROSS, last = i + 1 == AROUND;
            uint32_t p = i * ACROSS + j, q = i * ACROSS + k;
            uint32_t r = last ? (ACROSS - j) % ACROSS : p + ACROSS;
            uint32_t s = last ? (ACROSS - k) % ACROSS : q + ACROSS;
            add_cell(&a, p, r, s, q);
        }
    return a;
}

adversary adversary_book(void)
{
    uint32_t pages = between(3, 20), turned = test_random_below(2);
    adversary a = start(2 + 2 * pages, 2 * pages);
    double spread = test_random_below(2) ? 2 * pi / pages : test_random_range(0, 0.3);
    put(&a, 1, 0, 0, 1);
    for (uint32_t i = 0; i < pages; ++i) {
        double angle = spread * i, c = cos(angle), s = sin(angle), far = test_random_range(1, 2);
        uint32_t v = 2 + i, u = 2 + pages + i;
        put(&a, v, far * c, far * s, test_random_unit());
        put(&a, u, (far + 1) * c, (far + 1) * s, test_random_unit());
        if (i > 0 && test_random_below(6) == 0) a.twin[v] = v - 1;
        if (i > 0 && test_random_below(6) == 0) a.twin[u] = test_random_below(2) ? u - 1 : v - 1;
        if (turned && test_random_below(2)) {
            add(&a, 1, 0, v);
            add(&a, v, 0, u);
        } else {
            add(&a, 0, 1, v);
            add(&a, v, u, 0);
        }
    }
    return a;
}

adversary adversary_sheets(void)
{
    enum { COLUMNS = 4, ROWS = 3, EACH = COLUMNS * ROWS };
    adversary a = start(2 * EACH, 4 * (COLUMNS - 1) * (ROWS - 1));
    uint32_t kind = test_random_below(3), turned = test_random_below(2), one;
    double up = test_random_below(3) ? hair(-17, -3) : 0, slope = test_random_range(-1, 1);
    double aside = kind == 0 ? 0 : test_random_below(2) ? 0.25 : test_random_range(-1, 1);
    add_cloth(&a, 0, COLUMNS, ROWS);
    a.split = a.mesh.triangle_count;
    add_cloth(&a, EACH, COLUMNS, ROWS);
    for (uint32_t v = 0; v < EACH; ++v) {
        double *p = point(&a, v), *q = point(&a, EACH + v);
        p[2] = 1 + slope * p[0];
        q[0] = p[0] + aside;
        q[1] = p[1] + aside;
        q[2] = 1 + slope * q[0] + up;
        if (kind == 0) a.twin[EACH + v] = v;
    }
    for (uint32_t t = a.split; turned && t < a.mesh.triangle_count; ++t) {
        uint32_t *c = a.mesh.triangles + 3 * (size_t)t, first = c[0];
        c[0] = c[1];
        c[1] = first;
    }
    one = EACH + test_random_below(EACH);
    if (kind == 2) point(&a, one)[2] -= 2 * up; /* one vertex through */
    return a;
}

adversary adversary_upright(void)
{
    uint32_t columns = between(3, 5), rows = 3, level = test_random_below(2);
    adversary a = start(columns * rows, 2 * (columns - 1) * (rows - 1));
    double lean = test_random_below(8) ? hair(-13, -6) : 0, along[2], across[2];
    double length = sqrt(upright[0] * upright[0] + upright[1] * upright[1]);
    double side = test_random_below(2) ? 1 : -1, shear = test_random_range(-1, 1);
    along[0] = upright[0] / length - lean * upright[1] / length;
    along[1] = upright[1] / length + lean * upright[0] / length;
    if (level) {
        double x = along[0];
        along[0] = -along[1];
        along[1] = x;
    }
    across[0] = -side * along[1] + shear * along[0];
    across[1] = side * along[0] + shear * along[1];
    add_cloth(&a, 0, columns, rows);
    for (uint32_t v = 0; v < a.mesh.vertex_count; ++v) {
        double *p = point(&a, v), x = p[0] - 1, y = p[1] - 1;
        if (side < 0) y = -y;
        /* a bend inwards or outwards of one long side */
        p[0] = x * along[0] + side * y * across[0];
        p[1] = x * along[1] + side * y * across[1];
    }
    if (test_random_below(3) == 0) { /* one end of the mesh lies on the other */
        uint32_t v = columns * test_random_below(rows);
        a.twin[v + columns - 1] = v;
    }
    a.is_aligned = 1;
    return a;
}

adversary adversary_shallow(void)
{
    uint32_t columns = between(3, 5), rows = between(3, 5);
    adversary a = start(columns * rows, 2 * (columns - 1) * (rows - 1));
    double step = ldexp(1, -25 - (int)test_random_below(39));
    add_cloth(&a, 0, columns, rows);
    for (uint32_t v = 0; v < a.mesh.vertex_count; ++v) {
        double *p = point(&a, v);
        p[0] = (p[0] - (columns - 1) / 2.0) * step;
        p[1] = (p[1] - (rows - 1) / 2.0) * step;
        p[2] = ((double)test_random_below(64) - 31.5) * 0x1p-152;
    }
    a.is_aligned = 1;
    return a;
}

adversary adversary_ring(void)
{
    uint32_t n = between(3, 11), turns = test_random_below(5) == 0 ? 2 : 1;
    adversary a = start(1 + 2 * n, 3 * n);
    double tall = test_random_below(2) ? test_random_range(-1, 1) : 0;
    double at = test_random_below(2) ? test_random_range(-1, 1) : 0;
    uint32_t uneven = test_random_below(3);
    a.is_small = test_random_below(4) == 0;
    put(&a, 0, at, at / 3, tall);
    for (uint32_t i = 0; i < n; ++i) {
        double angle = 2 * pi * turns * i / n + (uneven ? test_random_range(-1, 1) / n : 0);
        double r = test_random_range(0.7, 1.5);
        uint32_t v = 1 + i, from = 1 + test_random_below(i + 1);
        put(&a, v, at + r * cos(angle), at / 3 + r * sin(angle), 0);
        if (from < v && test_random_below(3) == 0) { /* on a ray with another, or opposite */
            double stretch = test_random_below(3) ? -r : r;
            const double *p = point(&a, from);
            put(&a, v, at + stretch * (p[0] - at), at / 3 + stretch * (p[1] - at / 3), 0);
            if (test_random_below(4) == 0) a.twin[v] = from;
        }
        put(&a, n + v, at + (r + 1) * cos(angle), at / 3 + (r + 1) * sin(angle), 0);
    }
    for (uint32_t i = 0; i < n; ++i) {
        uint32_t v = 1 + i, u = 1 + (i + 1) % n;
        add(&a, 0, v, u);
    }
    for (uint32_t i = 0; i < n; ++i) {
        uint32_t v = 1 + i, u = 1 + (i + 1) % n;
        add_cell(&a, v, n + v, n + u, u);
    }
    a.split = n;
    return a;
}

/* A double that is no float, between 2^low and 2^high. */
static double unrounded(int low, int high)
{
    double f = (double)(float)(1 + test_random_unit());
    static const double parts[] = {0.5, 0.25, 0.75, 0x1p-29, 1 - 0x1p-29, 0};
    f += 0x1p-23 * parts[test_random_below(6)];
    if (test_random_below(3) == 0) f = 1 + 0x1p-23 * (parts[test_random_below(6)] - 0.5);
    f = ldexp(f, low + (int)test_random_below((uint32_t)(high - low + 1)));
    return test_random_below(2) ? f : -f;
}

adversary adversary_corners(void)
{
    enum { PAIRS = 6 };
    adversary a = start(6 * PAIRS, 2 * PAIRS);
    uint32_t range = test_random_below(4);
    for (uint32_t i = 0; i < PAIRS; ++i) {
        uint32_t axis = test_random_below(3), v = 6 * i;
        int low = range == 0 ? -1060 : range == 1 ? -155 : range == 2 ? -6 : 100;
        int high = range == 0 ? -1040 : range == 1 ? -140 : range == 2 ? 6 : 126;
        double *p = point(&a, v), size;
        for (int k = 0; k < 3; ++k) p[k] = unrounded(low, high);
        size = fabs(p[0]);
        for (uint32_t c = 1; c < 6; ++c) { /* a on the lower side of the plane, b above */
            double *q = point(&a, v + c);
            for (int k = 0; k < 3; ++k) q[k] = p[k] + size * test_random_range(-1, 1);
            q[axis] = p[axis] + (c < 3 ? -1 : 1) * size * test_random_unit();
        }
        a.twin[v + 3] = v;
        add(&a, v, v + 1, v + 2);
        add(&a, v + 3, v + 4, v + 5);
    }
    a.is_aligned = 1;
    return a;
}

adversary adversary_faces(void)
{
    enum { PAIRS = 6 };
    adversary a = start(6 * PAIRS, 2 * PAIRS);
    a.is_small = (int)test_random_below(2);
    for (uint32_t i = 0; i < PAIRS; ++i) {
        uint32_t v = 6 * i, kind = test_random_below(4);
        double s = test_random_unit(), t = test_random_range(0, 1 - s), n[3], e[3], f[3], side = 1;
        double x[3] = {8.0 * i, 0, 0}, r[4];
        for (uint32_t c = 0; c < 3; ++c)
            put(&a, v + c, x[0] + test_random_range(-1, 1), test_random_range(-1, 1),
                test_random_range(-1, 1));
        if (kind > 1) t = test_random_below(2) ? 0 : 1 - s; /* on an edge */
        for (int k = 0; k < 4; ++k) r[k] = test_random_range(-2, 2);
        for (int k = 0; k < 3; ++k) {
            e[k] = point(&a, v + 1)[k] - point(&a, v)[k];
            f[k] = point(&a, v + 2)[k] - point(&a, v)[k];
        }
        for (int k = 0; k < 3; ++k)
            n[k] = e[(k + 1) % 3] * f[(k + 2) % 3] - e[(k + 2) % 3] * f[(k + 1) % 3];
        if (kind % 2) side = hair(-17, -12); /* nearly in the plane */
        for (int k = 0; k < 3; ++k) {
            double base = point(&a, v)[k];
            point(&a, v + 3)[k] = base + s * e[k] + t * f[k];
            point(&a, v + 4)[k] = base + r[0] * e[k] + r[1] * f[k] + side * n[k];
            point(&a, v + 5)[k] = base + r[2] * e[k] + r[3] * f[k] + side * n[k];
        }
        if (kind == 3) /* coplanar, away from an edge or over it */
            for (int k = 0; k < 3; ++k) {
                double away = t == 0 ? -1 : 1, base = point(&a, v)[k];
                double g = t == 0 ? f[k] : f[k] + e[k];
                point(&a, v + 4)[k] = base + r[0] * e[k] + away * fabs(r[1]) * g;
                point(&a, v + 5)[k] = base + r[2] * e[k] + away * fabs(r[3]) * g;
            }
        add(&a, v, v + 1, v + 2);
        add(&a, v + 3, v + 4, v + 5);
    }
    return a;
}

static void turn(double *positions, uint32_t count)
{
    double m[3][3], size = 0, angle = test_random_range(0, 2 * pi), axis[3];
    for (int k = 0; k < 3; ++k) axis[k] = test_random_range(-1, 1);
    for (int k = 0; k < 3; ++k) size += axis[k] * axis[k];
    for (int i = 0; i < 3; ++i)
        for (int k = 0; k < 3; ++k)
            m[i][k] = (1 - cos(angle)) * axis[i] * axis[k] / size + (i == k ? cos(angle) : 0);
    for (int k = 0; k < 3; ++k) {
        double s = sin(angle) * axis[k] / sqrt(size);
        m[(k + 2) % 3][(k + 1) % 3] += s;
        m[(k + 1) % 3][(k + 2) % 3] -= s;
    }
    for (uint32_t v = 0; v < count; ++v) {
        double *p = positions + 3 * (size_t)v, q[3];
        for (int k = 0; k < 3; ++k) q[k] = m[k][0] * p[0] + m[k][1] * p[1] + m[k][2] * p[2];
        memcpy(p, q, sizeof(q));
    }
}

void adversary_dress(adversary *a)
{
    double *x = a->mesh.positions;
    uint32_t count = a->mesh.vertex_count, flat = test_random_below(2);
    /* where floats, and products of two, three and four coordinates, begin to underflow */
    static const int small[] = {-130, -150, -256, -340, -348, -530};
    double largest = 0;
    a->size = 1;
    a->move = 0;
    a->type = SC_DOUBLE;
    if (!a->is_aligned && test_random_below(3)) turn(x, count);
    switch (a->is_small ? 3 : test_random_below(10)) {
    case 0:
        a->size = pow(10, test_random_range(-30, 30));
        break;
    case 1:
        a->size = ldexp(1, -1070 + (int)test_random_below(60));
        break;
    case 2:
        a->size = ldexp(1, 100 + (int)test_random_below(50));
        break;
    case 3:
        a->size = ldexp(1, small[test_random_below(6)] - (int)test_random_below(16));
        break;
    default:
        break;
    }
    if (!a->is_small && test_random_below(6) == 0) a->move = 1e6 * a->size;
    if (test_random_below(8) == 0) soup_snap(x, count, 0x1p-4);
    soup_scale(x, count, a->size);
    soup_move(x, count, a->move);
    for (uint32_t i = 0; i < 3 * count; ++i) largest = fmax(largest, fabs(x[i]));
    if (test_random_below(3) == 0 && largest < 1e38) {
        a->type = SC_FLOAT;
        soup_round_to_float(x, count);
    }
    for (uint32_t v = 0; v < count; ++v) {
        if (a->twin[v] == SC_NONE) continue;
        for (int k = 0; k < 3; ++k) {
            double *p = point(a, v) + k;
            uint32_t steps = test_random_below(a->ulps + 1);
            int up = (int)test_random_below(2);
            *p = point(a, a->twin[v])[k];
            if (flat && k == 2) continue; /* flat stays flat */
            while (steps-- > 0)
                *p = a->type == SC_FLOAT ? (double)nextafterf((float)*p, up ? FLT_MAX : -FLT_MAX)
                                         : nextafter(*p, up ? DBL_MAX : -DBL_MAX);
        }
    }
}
