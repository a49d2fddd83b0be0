/*
 * Whether two features are within a distance. See within.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "step/within.h"

#include <math.h>

static void subtract_of_within(double *d, const double *a, const double *b)
{
    int k;
    for (k = 0; k < 3; k++) d[k] = a[k] - b[k];
}

static double dot_of_within(const double *a, const double *b)
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static double to_segment(const double *p, const double *a, const double *b)
{
    double e[3], v[3], s, length;
    int k;
    subtract_of_within(e, b, a);
    subtract_of_within(v, p, a);
    length = dot_of_within(e, e);
    s = dot_of_within(v, e);
    s = !(s > 0) ? 0 : s >= length ? 1 : s / length;
    for (k = 0; k < 3; k++) v[k] -= s * e[k];
    return dot_of_within(v, v);
}

int sc_within_vertex_face(const double p[4][3], double distance)
{
    double least = to_segment(p[0], p[1], p[2]), d = to_segment(p[0], p[2], p[3]);
    double e[3], f[3], v[3], n[3], ee, ef, ff, ev, fv, det, s, t;
    if (d < least) least = d;
    d = to_segment(p[0], p[3], p[1]);
    if (d < least) least = d;
    subtract_of_within(e, p[2], p[1]);
    subtract_of_within(f, p[3], p[1]);
    subtract_of_within(v, p[0], p[1]);
    n[0] = e[1] * f[2] - e[2] * f[1];
    n[1] = e[2] * f[0] - e[0] * f[2];
    n[2] = e[0] * f[1] - e[1] * f[0];
    ee = dot_of_within(e, e), ef = dot_of_within(e, f), ff = dot_of_within(f, f);
    ev = dot_of_within(e, v), fv = dot_of_within(f, v), det = ee * ff - ef * ef;
    s = ff * ev - ef * fv, t = ee * fv - ef * ev;
    if (det > 1e-12 * ee * ff && s >= 0 && t >= 0 && s + t <= det) {
        d = dot_of_within(v, n);
        d = d * d / dot_of_within(n, n);
        if (d < least) least = d;
    }
    return sqrt(least) <= distance;
}

int sc_within_edge_edge(const double p[4][3], double distance)
{
    double least = to_segment(p[0], p[2], p[3]), d = to_segment(p[1], p[2], p[3]);
    double e[3], f[3], v[3], n[3], ee, ef, ff, ev, fv, det, s, t;
    if (d < least) least = d;
    d = to_segment(p[2], p[0], p[1]);
    if (d < least) least = d;
    d = to_segment(p[3], p[0], p[1]);
    if (d < least) least = d;
    subtract_of_within(e, p[1], p[0]);
    subtract_of_within(f, p[3], p[2]);
    subtract_of_within(v, p[2], p[0]);
    n[0] = e[1] * f[2] - e[2] * f[1];
    n[1] = e[2] * f[0] - e[0] * f[2];
    n[2] = e[0] * f[1] - e[1] * f[0];
    ee = dot_of_within(e, e), ef = dot_of_within(e, f), ff = dot_of_within(f, f);
    ev = dot_of_within(e, v), fv = dot_of_within(f, v), det = ee * ff - ef * ef;
    s = ff * ev - ef * fv, t = ef * ev - ee * fv;
    if (det > 1e-12 * ee * ff && s >= 0 && s <= det && t >= 0 && t <= det) {
        d = dot_of_within(v, n);
        d = d * d / dot_of_within(n, n);
        if (d < least) least = d;
    }
    return sqrt(least) <= distance;
}
