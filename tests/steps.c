/*
 * Steps that are hard on continuous culling: see steps.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "steps.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "harness.h"
#include "shapes.h"
#include "starcontour.h"

static const double pi = 3.14159265358979323846;

static uint32_t between(uint32_t low, uint32_t high)
{
    return low + test_random_below(high - low + 1);
}

static int chance(uint32_t of)
{
    return test_random_below(of) == 0;
}

/* Nothing, or a hair: a random power of ten, up or down. */
static double hair(double low, double high)
{
    double h = pow(10, test_random_range(low, high));
    if (chance(4)) return 0;
    return chance(2) ? h : -h;
}

/* A step of a mesh that does not move yet. */
static step begin(const char *name, soup mesh)
{
    step s;
    memset(&s, 0, sizeof(s));
    s.name = name;
    s.mesh = mesh;
    s.start = soup_copy_positions(&mesh);
    s.end = soup_copy_positions(&mesh);
    s.type = SC_DOUBLE;
    s.size = 1;
    return s;
}

void step_free(step *s)
{
    free(s->start);
    free(s->end);
    soup_free(&s->mesh);
}

/* Takes the start, as it is now, for the rest pose. */
static void rest_at_start(step *s)
{
    memcpy(s->mesh.positions, s->start, 3 * (size_t)s->mesh.vertex_count * sizeof(double));
}

static void move(double *p, uint32_t first, uint32_t last, double x, double y, double z)
{
    for (uint32_t v = first; v < last; ++v) {
        p[3 * (size_t)v] += x;
        p[3 * (size_t)v + 1] += y;
        p[3 * (size_t)v + 2] += z;
    }
}

/* In the plane z = 0, about a point. */
static void turn(double *p, uint32_t first, uint32_t last, double x, double y, double angle)
{
    for (uint32_t v = first; v < last; ++v) {
        double *q = p + 3 * (size_t)v, u = q[0] - x, w = q[1] - y;
        q[0] = x + cos(angle) * u - sin(angle) * w;
        q[1] = y + sin(angle) * u + cos(angle) * w;
    }
}

static void scale(double *p, uint32_t first, uint32_t last, double x, double y, double z)
{
    for (uint32_t v = first; v < last; ++v) {
        p[3 * (size_t)v] *= x;
        p[3 * (size_t)v + 1] *= y;
        p[3 * (size_t)v + 2] *= z;
    }
}

/* A little relief in z, different at both ends, or none. */
static void ruffle(step *s)
{
    double *ends[2] = {s->start, s->end};
    double height = chance(2) ? 0.02 : 0.2;
    if (chance(2)) return;
    for (int e = 0; e < 2; ++e) {
        double u = test_random_range(-3, 3), w = test_random_range(-3, 3);
        for (uint32_t v = 0; v < s->mesh.vertex_count; ++v) {
            double *q = ends[e] + 3 * (size_t)v;
            q[2] += height * sin(u * q[0] + w * q[1]);
        }
    }
}

/* ------------------------------------------------------------------------------------------------
 * Contours
 */

step step_nested(void)
{
    int holed = chance(3);
    soup large = holed ? soup_annulus(between(8, 12), between(2, 3))
                       : soup_cloth(between(3, 5), between(3, 5));
    soup small = soup_cloth(between(1, 4), between(1, 4));
    uint32_t split = large.vertex_count;
    step s = begin("nested", soup_join(&large, &small));
    uint32_t all = s.mesh.vertex_count;
    double part = test_random_range(0.05, 0.6), x = test_random_range(-0.1, 0.9);
    double y = test_random_range(-0.1, 0.9), high = test_random_range(0.01, 0.5);
    double drift = chance(2) ? 0 : test_random_range(-0.5, 0.5);
    if (holed) x = y = -part / 2 + 0.1 * test_random_unit();
    for (int e = 0; e < 2; ++e) {
        double *p = e ? s.end : s.start;
        scale(p, split, all, part, part, 1);
        move(p, split, all, x + e * drift, y, e ? -high : high);
        if (chance(6)) move(p, split, all, 0, 0, e ? 2 * high : 0); /* harmless: it stays above */
    }
    soup_free(&large);
    soup_free(&small);
    rest_at_start(&s);
    ruffle(&s);
    return s;
}

step step_pinch(void)
{
    int flower = chance(2);
    uint32_t petals = between(2, 3), across = between(2, 3);
    step s = begin("pinch", flower ? soup_flower(petals, across) : soup_pinched(across));
    uint32_t all = s.mesh.vertex_count, first = flower ? 1 : (across + 1) * (across + 1);
    uint32_t count = flower ? (all - 1) / petals : all - first;
    /* The vertex of the pinch stays; the others of one part turn about it. */
    double x = flower ? 0 : 1, y = x, angle;
    angle = test_random_range(-0.95 * pi, 0.95 * pi);
    if (first + count > all) count = all - first;
    turn(s.end, first, first + count, x, y, angle);
    if (chance(3)) { /* a different length at the end: the two run at different speeds */
        for (uint32_t v = first; v < first + count; ++v) {
            double *q = s.end + 3 * (size_t)v, factor = test_random_range(2, 8);
            q[0] = x + factor * (q[0] - x);
            q[1] = y + factor * (q[1] - y);
        }
    }
    if (chance(3))
        for (uint32_t v = first; v < first + count; ++v)
            s.start[3 * (size_t)v + 2] +=
                0.2 * hypot(s.start[3 * (size_t)v] - x, s.start[3 * (size_t)v + 1] - y);
    ruffle(&s);
    return s;
}

/* A disc of sectors from angle low to high round vertex 0, rings deep, cut open; its two lips are
   the vertices first in each ring and last. */
static soup make_disc(uint32_t sectors, uint32_t rings)
{
    uint32_t columns = sectors + 1, t = 0;
    soup m = soup_make(1 + columns * rings, sectors * (2 * rings - 1));
    for (uint32_t i = 0; i < sectors; ++i) {
        uint32_t fan[3] = {0, 1 + i, 2 + i};
        memcpy(m.triangles + 3 * (size_t)t++, fan, sizeof(fan));
        for (uint32_t j = 0; j + 1 < rings; ++j) {
            uint32_t v = 1 + j * columns + i;
            uint32_t cell[6] = {v, v + columns, v + columns + 1, v, v + columns + 1, v + 1};
            memcpy(m.triangles + 3 * (size_t)t, cell, sizeof(cell));
            t += 2;
        }
    }
    return m;
}

static void place_disc(double *p, uint32_t sectors, uint32_t rings, double low, double high,
                       double low_length, double high_length)
{
    memset(p, 0, 3 * sizeof(double));
    for (uint32_t j = 0; j < rings; ++j)
        for (uint32_t i = 0; i <= sectors; ++i) {
            double part = (double)i / sectors, angle = low + (high - low) * part;
            double radius = (j + 1) * (low_length + (high_length - low_length) * part);
            double *q = p + 3 * (size_t)(1 + j * (sectors + 1) + i);
            q[0] = radius * cos(angle);
            q[1] = radius * sin(angle);
            q[2] = 0;
        }
}

step step_lips(void)
{
    uint32_t sectors = between(5, 9), rings = between(1, 4);
    step s = begin("lips", make_disc(sectors, rings));
    double gap[2], from = test_random_range(0, 2 * pi), swing = test_random_range(-2.5, 2.5);
    double length[4] = {1, 1, 1, 1};
    for (int e = 0; e < 2; ++e)
        gap[e] = chance(2) ? fabs(hair(-16, -0.5)) : test_random_range(0, 1);
    if (chance(2)) gap[1] = -gap[1]; /* over each other at the end */
    if (chance(2)) /* lips of different lengths: turning, one overtakes the other on the way */
        for (int i = 0; i < 4; ++i) length[i] = chance(2) ? 1 : test_random_range(1, 10);
    place_disc(s.start, sectors, rings, from, from + 2 * pi - gap[0], length[0], length[1]);
    place_disc(s.end, sectors, rings, from + swing, from + swing + 2 * pi - gap[1], length[2],
               length[3]);
    rest_at_start(&s);
    ruffle(&s);
    return s;
}

step step_fold(void)
{
    uint32_t across = between(1, 4), along = between(4, 10), columns = across + 1;
    step s = begin("fold", soup_cloth(along, across));
    uint32_t row = between(1, along), which = test_random_below(4), all = s.mesh.vertex_count;
    double line = (double)(row - 1) / along;
    double over = test_random_range(0.3, 3), high = chance(2) ? 0 : test_random_range(0.02, 0.6);
    for (uint32_t v = 0; v < all; ++v) {
        double *a = s.start + 3 * (size_t)v, *b = s.end + 3 * (size_t)v, beyond;
        beyond = a[1] - line;
        if (beyond <= 1e-9) continue;
        switch (which) {
        case 0: /* flat over its neighbours */
            b[1] = line - over * beyond;
            break;
        case 1: /* from above to below: folded flat onto them on the way */
            a[1] = b[1] = line - over * beyond;
            a[2] += high * beyond + 0.1;
            b[2] -= high * beyond + 0.1;
            break;
        case 2: /* a hinge that closes */
            b[1] = line + beyond * cos(0.98 * pi);
            b[2] = beyond * sin(0.98 * pi) + high * 0.01;
            break;
        default: /* corners of one row change sides */
            if (v / columns == row || chance(3)) b[1] = line - over * beyond * test_random_unit();
            break;
        }
    }
    if (chance(3)) ruffle(&s);
    if (chance(2)) rest_at_start(&s);
    return s;
}

step step_hole(void)
{
    uint32_t around = between(6, 14), rings = between(2, 3);
    step s = begin("hole", soup_annulus(around, rings));
    uint32_t which = test_random_below(5), all = s.mesh.vertex_count;
    double inner = HUGE_VAL, center[2] = {0, 0}, through = test_random_range(-1, 0.5);
    for (uint32_t v = 0; v < all; ++v)
        for (int k = 0; k < 2; ++k) center[k] += s.start[3 * (size_t)v + (size_t)k] / all;
    move(s.start, 0, all, -center[0], -center[1], 0);
    move(s.end, 0, all, -center[0], -center[1], 0);
    for (uint32_t v = 0; v < all; ++v)
        inner = fmin(inner, hypot(s.start[3 * (size_t)v], s.start[3 * (size_t)v + 1]));
    for (uint32_t v = 0; v < all; ++v) {
        double *a = s.start + 3 * (size_t)v, *b = s.end + 3 * (size_t)v;
        if (hypot(a[0], a[1]) > 1.01 * inner) continue;
        if (chance(2) && which < 3) a[0] = b[0] = 0.2 * a[0];
        switch (which) {
        case 0: /* to a slit, or through */
            b[1] *= through;
            break;
        case 1: /* to a point, or through */
            b[0] *= through;
            b[1] *= through;
            break;
        case 2: /* one side over the other */
            if (a[1] > 0) b[1] -= (1.5 + test_random_unit()) * inner;
            break;
        case 3: /* inside out, and taller: two at a time */
            b[0] = -a[0];
            b[1] = -a[1] * test_random_range(0.1, 2);
            break;
        default: /* one vertex to the other side */
            if (v == 0 || chance(around)) {
                b[0] = -1.2 * a[0];
                b[1] = -1.2 * a[1];
            }
            break;
        }
    }
    ruffle(&s);
    return s;
}

step step_pass(void)
{
    uint32_t split;
    double far_off = test_random_range(1.05, 3), aside = test_random_range(-1.2, 1.2);
    double height = chance(2) ? hair(-12, -0.5) : 0;
    step s;
    if (chance(3)) { /* a ring cut open: its two ends change places */
        uint32_t around = between(6, 10), rings = between(1, 3);
        s = begin("pass", make_disc(around, rings));
        place_disc(s.start, around, rings, 0, 1.2 * pi, 1, 1);
        place_disc(s.end, around, rings, 1.2 * pi, 2.4 * pi, 1, 1);
        move(s.start, 1 + rings * around, s.mesh.vertex_count, 0, 0, height);
    } else {
        soup a = chance(2) ? soup_cloth(between(1, 4), between(1, 4))
                           : soup_annulus(between(4, 9), between(1, 2));
        soup b = soup_cloth(between(1, 4), between(1, 4));
        split = a.vertex_count;
        s = begin("pass", soup_join(&a, &b));
        move(s.start, split, s.mesh.vertex_count, -far_off, aside, height);
        move(s.end, split, s.mesh.vertex_count, far_off, chance(2) ? aside : -aside,
             chance(2) ? height : -height);
        if (chance(3)) turn(s.end, split, s.mesh.vertex_count, far_off, aside, 1);
        if (chance(3)) scale(s.end, 0, split, 0.5, 0.5, 1);
        soup_free(&a);
        soup_free(&b);
    }
    rest_at_start(&s);
    if (chance(3)) ruffle(&s);
    return s;
}

step step_sweep(void)
{
    uint32_t along = between(12, 30), across = between(1, 2);
    double tilt = chance(2) ? 0 : test_random_range(0.01, 0.3);
    double turns[2] = {test_random_range(0.5, 1), test_random_range(0.8, 1.4)};
    soup a = shape_spiral(along, across, turns[0], tilt), b;
    step s = begin("sweep", a);
    b = shape_spiral(along, across, turns[1], chance(2) ? tilt : -tilt);
    memcpy(s.end, b.positions, 3 * (size_t)s.mesh.vertex_count * sizeof(double));
    soup_free(&b);
    return s;
}

/* ------------------------------------------------------------------------------------------------
 * Normals
 */

step step_flip(void)
{
    uint32_t side = between(3, 7);
    step s = begin("flip", soup_cloth(side, chance(2) ? side : between(2, 4)));
    double x = test_random_unit(), y = test_random_unit(), reach = test_random_range(0.1, 1.5);
    double along = test_random_range(0.3, 3), across = test_random_range(0.3, 3);
    double angle = pi * test_random_range(0.8, 1.2);
    for (uint32_t v = 0; v < s.mesh.vertex_count; ++v) {
        double *b = s.end + 3 * (size_t)v, u = b[0] - x, w = b[1] - y;
        if (hypot(u, w) > reach) continue;
        b[0] = x + along * (cos(angle) * u - sin(angle) * w);
        b[1] = y + across * (sin(angle) * u + cos(angle) * w);
    }
    if (chance(2)) ruffle(&s);
    return s;
}

step step_whirl(void)
{
    uint32_t around = between(7, 10), rings = between(4, 6), t = 0;
    soup m = soup_make(1 + around * rings, around * (2 * rings - 1));
    int hops = chance(2);
    double along = test_random_range(0.5, 2), across = test_random_range(0.5, 2), angle = 0;
    step s;
    for (uint32_t i = 0; i < around; ++i) {
        uint32_t next = (i + 1) % around, fan[3] = {0, 1 + i, 1 + next};
        memcpy(m.triangles + 3 * (size_t)t++, fan, sizeof(fan));
        for (uint32_t j = 0; j + 1 < rings; ++j) {
            uint32_t v = 1 + j * around + i, w = 1 + j * around + next;
            uint32_t cell[6] = {v, v + around, w + around, v, w + around, w};
            memcpy(m.triangles + 3 * (size_t)t, cell, sizeof(cell));
            t += 2;
        }
    }
    memset(m.positions, 0, 3 * (size_t)m.vertex_count * sizeof(double));
    for (uint32_t v = 1; v < m.vertex_count; ++v) {
        double turned = 2 * pi * ((v - 1) % around) / around;
        m.positions[3 * (size_t)v] = (1 + (v - 1) / around) * cos(turned);
        m.positions[3 * (size_t)v + 1] = (1 + (v - 1) / around) * sin(turned);
    }
    s = begin("whirl", m);
    if (hops) {
        double far_out = test_random_range(1.02, 1.6);
        angle = test_random_range(0, 2 * pi);
        move(s.end, 0, 1, far_out * cos(angle), far_out * sin(angle), 0);
    } else {
        scale(s.end, 1, 1 + around, along, across, 1);
        for (uint32_t j = 0; j + 1 < rings; ++j)
            turn(s.end, 1 + j * around, 1 + (j + 1) * around, 0, 0,
                 pi * (rings - 1 - j) / (rings - 1));
    }
    if (chance(3)) ruffle(&s);
    return s;
}

step step_invert(void)
{
    step s = begin("invert", chance(2) ? soup_sphere(between(4, 8), between(4, 7))
                                       : soup_tube(between(3, 8), between(3, 7)));
    uint32_t axis = test_random_below(3), all = s.mesh.vertex_count;
    double middle = test_random_range(-0.2, 0.6), factor = test_random_range(-1.2, 0.2);
    int part = chance(2);
    for (uint32_t v = 0; v < all; ++v) {
        double *b = s.end + 3 * (size_t)v + axis;
        if (part && *b > middle) continue;
        *b = middle + factor * (*b - middle);
    }
    soup_noise(s.end, all, chance(2) ? 0.01 : 0);
    return s;
}

/* ------------------------------------------------------------------------------------------------
 * Separation
 */

step step_thick(void)
{
    double thin = pow(10, test_random_range(-3, -0.5)), gap = thin * test_random_range(0.2, 3);
    step s;
    if (chance(2)) { /* one sheet of thin triangles */
        s = begin("thick", soup_cloth(between(3, 6), between(3, 6)));
        scale(s.start, 0, s.mesh.vertex_count, thin, 1, 1);
        scale(s.end, 0, s.mesh.vertex_count, thin * test_random_range(0.8, 1.2), 1, 1);
    } else { /* two in a plane, side by side, or sliding along each other */
        soup a = soup_cloth(between(2, 4), between(2, 4)), b = soup_cloth(2, between(2, 5));
        s = begin("thick", soup_join(&a, &b));
        move(s.start, a.vertex_count, s.mesh.vertex_count, 1 + thin, 0, 0);
        move(s.end, a.vertex_count, s.mesh.vertex_count, 1 + thin * (chance(2) ? 1 : 1.1),
             chance(2) ? 0 : test_random_range(-0.5, 0.5), 0);
        soup_free(&a);
        soup_free(&b);
    }
    s.separation = gap;
    rest_at_start(&s);
    if (chance(2)) ruffle(&s);
    return s;
}

/* ------------------------------------------------------------------------------------------------
 * Vertices and motions
 */

step step_teleport(void)
{
    const char *name;
    step s = begin("teleport", shape_any(between(20, 120), &name));
    uint32_t all = s.mesh.vertex_count, count = between(1, 3);
    soup_smooth(s.start, all, 0.1);
    memcpy(s.end, s.start, 3 * (size_t)all * sizeof(double));
    soup_smooth(s.end, all, 0.05);
    while (count-- > 0) {
        double *b = s.end + 3 * (size_t)test_random_below(all);
        const double *c = s.start + 3 * (size_t)test_random_below(all);
        for (int k = 0; k < 3; ++k)
            b[k] = chance(2) ? c[k] : test_random_range(-2, 2) * (chance(4) ? 100 : 1);
    }
    return s;
}

step step_rotate(void)
{
    const char *name;
    step s = begin("rotate", shape_any(between(20, 120), &name));
    uint32_t all = s.mesh.vertex_count;
    double angle = test_random_range(-pi, pi);
    if (chance(2)) soup_smooth(s.start, all, 0.2);
    if (chance(3)) soup_twist(s.start, all, test_random_range(0.1, 1));
    memcpy(s.end, s.start, 3 * (size_t)all * sizeof(double));
    if (chance(2)) {
        turn(s.end, 0, all, test_random_unit(), test_random_unit(), angle);
    } else {
        soup_twist(s.end, all, test_random_range(0.05, 0.5)); /* a twist within the step */
    }
    return s;
}

step step_shrink(void)
{
    const char *name;
    step s = begin("shrink", shape_any(between(20, 120), &name));
    uint32_t all = s.mesh.vertex_count, last = chance(2) ? all : between(1, all);
    double to = chance(2) ? 0 : hair(-18, -1);
    soup_smooth(s.start, all, 0.1);
    memcpy(s.end, s.start, 3 * (size_t)all * sizeof(double));
    scale(s.end, 0, last, to, chance(2) ? 1 : to, chance(3) ? 1 : to);
    if (chance(4)) { /* out of a point */
        double *swap = s.start;
        s.start = s.end;
        s.end = swap;
    }
    return s;
}

step step_still(void)
{
    const char *name;
    step s = begin("still", shape_any(between(20, 120), &name));
    uint32_t all = s.mesh.vertex_count;
    soup_any_pose(s.start, all);
    memcpy(s.end, s.start, 3 * (size_t)all * sizeof(double));
    if (chance(3)) soup_nudge(s.end, all);
    return s;
}

step step_shift(void)
{
    const char *name;
    step s = begin("shift", shape_any(between(20, 120), &name));
    uint32_t all = s.mesh.vertex_count;
    soup_smooth(s.start, all, chance(2) ? 0.1 : 0.5);
    memcpy(s.end, s.start, 3 * (size_t)all * sizeof(double));
    soup_smooth(s.end, all, chance(2) ? 0 : 0.1);
    move(s.end, 0, all, pow(10, test_random_range(-1, 5)), hair(-3, 4), hair(-3, 4));
    return s;
}

step step_sheets(void)
{
    soup a = soup_cloth(between(1, 5), between(1, 5)), b = soup_cloth(between(1, 5), between(1, 5));
    uint32_t split = a.vertex_count, all;
    step s = begin("sheets", soup_join(&a, &b));
    double from = pow(10, test_random_range(-6, 0)), to = chance(3) ? 0 : hair(-6, 0);
    double tilt = chance(2) ? 0 : test_random_range(-0.2, 0.2);
    all = s.mesh.vertex_count;
    for (uint32_t v = split; v < all; ++v) {
        double *p = s.start + 3 * (size_t)v, *q = s.end + 3 * (size_t)v;
        p[2] += from + tilt * p[0];
        q[2] += to;
        if (chance(40)) q[2] -= 2 * from;
    }
    if (chance(2)) { /* slide as they approach */
        move(s.end, split, all, test_random_range(-1, 1), test_random_range(-1, 1), 0);
    }
    s.separation = chance(2) ? from * test_random_range(0, 2) : 0;
    soup_free(&a);
    soup_free(&b);
    rest_at_start(&s);
    return s;
}

step step_graze(void)
{
    uint32_t range = between(1, 4);
    step s = begin("graze", soup_on_grid(range));
    for (size_t i = 0; i < 3 * (size_t)s.mesh.vertex_count; ++i)
        s.end[i] = chance(3) ? s.start[i] : (double)test_random_below(range + 1);
    return s;
}

step step_needle(void)
{
    step s = begin("needle",
                   chance(2) ? soup_slivers(between(8, 40)) : shape_broken_cloth(between(2, 5)));
    uint32_t all = s.mesh.vertex_count;
    soup_noise(s.end, all, chance(2) ? 0.01 : 0.4);
    if (chance(4)) soup_crush(s.end, all);
    if (chance(4)) soup_crush(s.start, all);
    return s;
}

step step_book(void)
{
    step s =
        begin("book", chance(2) ? shape_fan_of_sheets(between(2, 6)) : soup_fins(between(2, 6)));
    uint32_t all = s.mesh.vertex_count;
    soup_noise(s.start, all, chance(2) ? 0 : 0.1);
    soup_noise(s.end, all, 0.3);
    if (chance(3)) soup_crush(s.end, all);
    return s;
}

step step_any(void)
{
    const char *name;
    step s = begin("any", chance(3) ? soup_scattered() : shape_any(between(20, 150), &name));
    uint32_t all = s.mesh.vertex_count;
    soup_smooth(s.start, all, 0.3);
    if (chance(2)) memcpy(s.end, s.start, 3 * (size_t)all * sizeof(double));
    switch (test_random_below(8)) {
    case 0:
        soup_noise(s.end, all, 0.05);
        break;
    case 1:
        soup_twist(s.end, all, test_random_range(0.1, 1));
        break;
    case 2:
        soup_fold(s.end, all);
        break;
    case 3:
        soup_crush(s.end, all);
        break;
    case 4:
        soup_shuffle(s.end, all);
        break;
    case 5:
        shape_bend(s.end, all, test_random_range(0.1, 1));
        break;
    case 6:
        soup_smooth(s.end, all, 0.3);
        soup_snap(s.start, all, 0.125);
        soup_snap(s.end, all, 0.125);
        break;
    default:
        soup_smooth(s.end, all, test_random_range(0, 0.5));
        break;
    }
    return s;
}

/* ---------------------------------------------------------------------------------------------- */

/* A random rotation of all three poses. */
static void tumble(step *s)
{
    double *poses[3] = {s->mesh.positions, s->start, s->end}, q[4], length = 0, m[3][3];
    for (int k = 0; k < 4; ++k) {
        q[k] = test_random_range(-1, 1);
        length += q[k] * q[k];
    }
    if (length < 1e-3) return;
    for (int i = 0; i < 3; ++i)
        for (int k = 0; k < 3; ++k) {
            int other = 3 - i - k;
            double sign = (k - i + 3) % 3 == 1 ? -1 : 1;
            m[i][k] = 2 * q[i] * q[k] / length;
            m[i][k] += i == k ? 2 * q[3] * q[3] / length - 1 : sign * 2 * q[3] * q[other] / length;
        }
    for (int e = 0; e < 3; ++e)
        for (uint32_t v = 0; v < s->mesh.vertex_count; ++v) {
            double *p = poses[e] + 3 * (size_t)v, r[3];
            for (int k = 0; k < 3; ++k) r[k] = m[k][0] * p[0] + m[k][1] * p[1] + m[k][2] * p[2];
            memcpy(p, r, sizeof(r));
        }
}

void step_dress(step *s)
{
    double *poses[3] = {s->mesh.positions, s->start, s->end};
    uint32_t all = s->mesh.vertex_count;
    if (chance(2)) tumble(s);
    if (s->separation == 0 && chance(2))
        s->separation = pow(10, test_random_range(-9, chance(3) ? 1 : -1));
    if (chance(8)) s->size = pow(10, test_random_range(-30, 30));
    if (chance(12)) s->size = pow(10, test_random_range(-3, 3));
    if (chance(10)) s->shift = s->size * pow(10, test_random_range(0, 4));
    for (int e = 0; e < 3; ++e) {
        soup_scale(poses[e], all, s->size);
        if (e == 2) soup_move(poses[e], all, s->shift);
    }
    s->separation *= s->size;
    if (s->type == SC_DOUBLE && chance(3)) s->type = SC_FLOAT;
    if (s->type == SC_FLOAT)
        for (int e = 0; e < 3; ++e) soup_round_to_float(poses[e], all);
}
