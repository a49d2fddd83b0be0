/*
 * Bounds, as functions of trials, and the table of them. See rounding_search.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "rounding_search.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "base/boxes.h"
#include "rounding_signs.h"
#include "rounding_sums.h"
#include "simd/quads.h"
#include "step/moving_contour.h"

/* The kernels, as simd/kernels_base.c has them. */
#define SC_KERNELS rounding_kernels
#define SC_LANES SC_QUADS

#include "simd/all_kernels.h"

enum { N = ROUNDING_LANES };

static const double U = 0x1p-53;

/* ------------------------------------------------------------------------------------------------
 * Points, as numbers of a trial
 */

static lanes rounded(const double x[N])
{
    float f[N];
    for (int i = 0; i < N; ++i) f[i] = (float)x[i];
    return lanes_load(f);
}

static void read_point(const double (*x)[N], int first, lanes at[3])
{
    for (int k = 0; k < 3; ++k) at[k] = rounded(x[first + k]);
}

/* The exact way from a point to another, in double precision: what is lost is 2^-53 of it. */
static void way_of(const double (*x)[N], int lane, int from, int to, double way[3])
{
    for (int k = 0; k < 3; ++k) way[k] = x[to + k][lane] - x[from + k][lane];
}

static double dot_of(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross_of(const double a[3], const double b[3], double n[3])
{
    for (int k = 0; k < 3; ++k)
        n[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

/* The largest extent of the box of points: as small as that of clusters can be. */
static lanes extent_of(const double (*x)[N], int points, int axes)
{
    lanes extent = lanes_all(0);
    for (int k = 0; k < axes; ++k) {
        lanes low = rounded(x[k]), high = low;
        for (int i = 1; i < points; ++i) {
            low = lanes_smaller(low, rounded(x[axes * i + k]));
            high = lanes_larger(high, rounded(x[axes * i + k]));
        }
        extent = lanes_larger(extent, lanes_subtract(high, low));
    }
    return extent;
}

/* |computed - exact| / bound */
static void share_of(lanes computed, lanes bound, const double exact[N], double share[N])
{
    float c[N], b[N];
    lanes_store(c, computed);
    lanes_store(b, bound);
    for (int i = 0; i < N; ++i) share[i] = fabs((double)c[i] - exact[i]) / (double)b[i];
}

/* ------------------------------------------------------------------------------------------------
 * base/
 */

/* What a float is off by beyond 2^-23 of it, of FLT_MIN: numbers that are subnormal as floats. */
static void float_tiny(const double (*x)[N], double share[N])
{
    for (int i = 0; i < N; ++i) {
        double d = x[0][i] * 0x1p-124;
        float f = sc_boxes_clamp(d);
        double off = fabs(d - (double)f) - 0x1p-23 * fabs((double)f);
        share[i] = off > 0 ? off / (double)FLT_MIN : 0;
    }
}

/* Coordinates of poses of floats in the unit box: what underflows, of 2^-85. The pose is as small
   as it may be, so that it is scaled by 2^64; see pose/positions.c. */
static void unit_tiny(const double (*x)[N], double share[N])
{
    for (int i = 0; i < N; ++i) {
        double d = x[0][i] * 0x1p-124;
        float f = (float)d * 0x1p+64f; /* of doubles, moved and rounded */
        double off = fabs(d * 0x1p+64 - (double)f) - 0x1p-24 * fabs((double)f);
        share[i] = off > 0 ? off / (double)SC_BOUNDS_STEP_LEAST : 0;
    }
}

/* The boxes of two triangles that touch, by the corners at which they do: whether floats are
   ordered as what is rounded to them. The share is of the step as made. */
static void box_step(const double (*x)[N], double share[N])
{
    lanes at[3][3], low, high;
    sc_leaf_derived ready;
    float one[N], other[N], f[N];
    for (int k = 0; k < 9; ++k) at[k / 3][k % 3] = rounded(x[0]);
    make_boxes(at, N, &ready);
    low = lanes_load(ready.side[0]);
    high = lanes_load(ready.side[3]);
    lanes_store(one, low);
    lanes_store(other, high);
    lanes_store(f, at[0][0]);
    for (int i = 0; i < N; ++i) {
        double d = x[0][i], off = d - (double)f[i];
        double step = off > 0 ? (double)other[i] - (double)f[i] : (double)f[i] - (double)one[i];
        share[i] = fabs(off) / step;
    }
}

/* ------------------------------------------------------------------------------------------------
 * pose/
 */

/* A coordinate in the unit box is off by 2^-25, for which other bounds take 3e-8. */
static void unit_box(const double (*x)[N], double share[N])
{
    for (int i = 0; i < N; ++i)
        share[i] = fabs(x[0][i] - (double)(float)x[0][i]) / (double)SC_BOUNDS_POINT;
}

/* ------------------------------------------------------------------------------------------------
 * query/, floats
 */

/* A triangle, and a point seen from its plane. */
static void sixteen_planes(const double (*x)[N], double share[N])
{
    lanes at[3][3], p[3], d, bound;
    sc_leaf_derived ready;
    double exact[N];
    for (int k = 0; k < 3; ++k) read_point(x, 3 * k, at[k]);
    read_point(x, 9, p);
    make_normals(at, &ready);
    bound = plane_bound(lanes_load(ready.size), extent_of(x, 4, 3));
    d = lanes_multiply(lanes_load(ready.normal[0]), p[0]);
    for (int k = 1; k < 3; ++k) d = lanes_add(d, lanes_multiply(lanes_load(ready.normal[k]), p[k]));
    d = lanes_subtract(d, lanes_load(ready.offset));
    for (int i = 0; i < N; ++i) {
        double e[3], f[3], w[3], n[3];
        way_of(x, i, 0, 3, e);
        way_of(x, i, 0, 6, f);
        way_of(x, i, 0, 9, w);
        cross_of(e, f, n);
        exact[i] = dot_of(n, w);
    }
    share_of(d, bound, exact, share);
}

/* An edge of each of two triangles, from their tips. */
static void sixteen_edges(const double (*x)[N], double share[N])
{
    lanes tip[2][3], e[2][3], w[3], m[3], d, size = lanes_all(0);
    double exact[N];
    for (int s = 0; s < 2; ++s) {
        lanes to[3];
        read_point(x, 6 * s, tip[s]);
        read_point(x, 6 * s + 3, to);
        for (int k = 0; k < 3; ++k) {
            e[s][k] = lanes_subtract(to[k], tip[s][k]);
            size = lanes_add(size, lanes_absolute(e[s][k]));
        }
    }
    for (int k = 0; k < 3; ++k) w[k] = lanes_subtract(tip[1][k], tip[0][k]);
    for (int k = 0; k < 3; ++k)
        m[k] = lanes_subtract(lanes_multiply(e[1][(k + 1) % 3], w[(k + 2) % 3]),
                              lanes_multiply(e[1][(k + 2) % 3], w[(k + 1) % 3]));
    d = lanes_multiply(e[0][0], m[0]);
    for (int k = 1; k < 3; ++k) d = lanes_add(d, lanes_multiply(e[0][k], m[k]));
    for (int i = 0; i < N; ++i) {
        double a[3], b[3], c[3], n[3];
        way_of(x, i, 0, 3, a);
        way_of(x, i, 6, 9, b);
        way_of(x, i, 0, 6, c);
        cross_of(b, c, n);
        exact[i] = dot_of(a, n);
    }
    share_of(d, edges_bound(size, w), exact, share);
}

/* Three points in a projection: the third seen from the line of the others. */
static void sides(const double (*x)[N], double share[N])
{
    lanes p[3][2], d;
    double exact[N];
    for (int k = 0; k < 6; ++k) p[k / 2][k % 2] = rounded(x[k]);
    d = lanes_subtract(
        lanes_multiply(lanes_subtract(p[1][0], p[0][0]), lanes_subtract(p[2][1], p[0][1])),
        lanes_multiply(lanes_subtract(p[1][1], p[0][1]), lanes_subtract(p[2][0], p[0][0])));
    for (int i = 0; i < N; ++i)
        exact[i] =
            (x[2][i] - x[0][i]) * (x[5][i] - x[1][i]) - (x[3][i] - x[1][i]) * (x[4][i] - x[0][i]);
    share_of(d, side_bound(extent_of(x, 3, 2)), exact, share);
}

/* A direction, and two points along it. */
static void slabs(const double (*x)[N], double share[N])
{
    lanes n[3], p[3], q[3], from, to;
    float near[N], far[N], bound[N];
    for (int i = 0; i < N; ++i) {
        float one[3];
        for (int k = 0; k < 3; ++k) one[k] = (float)x[k][i];
        bound[i] = slab_reach(one);
    }
    read_point(x, 0, n);
    read_point(x, 3, p);
    read_point(x, 6, q);
    from = dot_product(n, p);
    to = lanes_subtract(dot_product(n, q), lanes_load(bound)); /* as make_slab has it */
    lanes_store(near, from);
    lanes_store(far, to);
    for (int i = 0; i < N; ++i) {
        double way = 0;
        for (int k = 0; k < 3; ++k) way += (double)(float)x[k][i] * (x[3 + k][i] - x[6 + k][i]);
        share[i] =
            fabs((double)near[i] - ((double)far[i] + (double)bound[i]) - way) / (double)bound[i];
    }
}

/* Two triangles that share a point: the plane of one, and a corner of the other. */
static void neighbor_planes(const double (*x)[N], double share[N])
{
    neighbors both;
    lanes p[3], q[3], n[3], size = lanes_all(0), bound;
    double exact[N];
    memset(&both, 0, sizeof both);
    read_point(x, 0, p);
    for (int s = 0; s < 3; ++s) {
        read_point(x, 3 + 3 * s, q);
        for (int k = 0; k < 3; ++k) both.at[s / 2][s % 2][k] = lanes_subtract(q[k], p[k]);
    }
    for (int k = 0; k < 3; ++k)
        size = lanes_add(
            size, lanes_add(lanes_absolute(both.at[0][0][k]), lanes_absolute(both.at[0][1][k])));
    bound = neighbor_plane_bound(size, extent_of(x, 4, 3));
    find_normal(&both, 0, n);
    for (int i = 0; i < N; ++i) {
        double e[3], f[3], w[3], m[3];
        way_of(x, i, 0, 3, e);
        way_of(x, i, 0, 6, f);
        way_of(x, i, 0, 9, w);
        cross_of(e, f, m);
        exact[i] = dot_of(m, w);
    }
    share_of(dot_product(n, both.at[1][0]), bound, exact, share);
}

/* A direction, and two points. */
static void neighbor_directions(const double (*x)[N], double share[N])
{
    lanes m[3], p[3], q[3], size, bound;
    float sizes[N], extents[N], bounds[N], one[N];
    double exact[N];
    read_point(x, 0, m);
    read_point(x, 3, p);
    read_point(x, 6, q);
    for (int k = 0; k < 3; ++k) q[k] = lanes_subtract(q[k], p[k]);
    size = lanes_add(lanes_add(lanes_absolute(m[0]), lanes_absolute(m[1])), lanes_absolute(m[2]));
    lanes_store(sizes, size);
    lanes_store(extents, extent_of(x + 3, 2, 3));
    for (int i = 0; i < N; ++i) {
        lanes_store(one, direction_bound(lanes_all(sizes[i]), extents[i]));
        bounds[i] = one[0];
    }
    bound = lanes_load(bounds);
    for (int i = 0; i < N; ++i) {
        double direction[3], way[3];
        for (int k = 0; k < 3; ++k) direction[k] = (double)(float)x[k][i];
        way_of(x, i, 3, 6, way);
        exact[i] = dot_of(direction, way);
    }
    share_of(dot_product(m, q), bound, exact, share);
}

/* The same as query/touch_kernel.h has it: the error of a difference, to which the part of the
   bound that was subtracted is added again. */
static void touching(const double (*x)[N], double share[N])
{
    lanes m[3], p[3], q[3], size, along;
    float a[N], s[N];
    read_point(x, 0, m);
    read_point(x, 3, p);
    read_point(x, 6, q);
    for (int k = 0; k < 3; ++k) q[k] = lanes_multiply(m[k], lanes_subtract(q[k], p[k]));
    along = lanes_add(lanes_add(q[0], q[1]), q[2]);
    size = lanes_add(lanes_add(lanes_absolute(q[0]), lanes_absolute(q[1])), lanes_absolute(q[2]));
    size = touch_rounding(size);
    lanes_store(a, lanes_subtract(along, size));
    lanes_store(s, size);
    for (int i = 0; i < N; ++i) {
        float one[3];
        double direction[3], way[3];
        for (int k = 0; k < 3; ++k) {
            one[k] = (float)x[k][i];
            direction[k] = (double)one[k];
        }
        way_of(x, i, 3, 6, way);
        share[i] = fabs((double)a[i] + (double)s[i] - dot_of(direction, way)) /
                   ((double)touch_reach(one) + (double)s[i]);
    }
}

/* A normal, and two points along a direction across it. */
static void fan_rays(const double (*x)[N], double share[N])
{
    for (int i = 0; i < N; ++i) {
        float n[3], across[2][3], y[2], bound;
        double c[3], way[3];
        int a, b, first;
        for (int k = 0; k < 3; ++k) n[k] = (float)x[k][i];
        find_across(n, across);
        first = x[0][i] * x[3][i] > 0;
        for (int k = 0; k < 3; ++k) c[k] = (double)across[first][k];
        /* the component that is a sum, unrounded */
        a = fabsf(n[1]) > fabsf(n[0]) ? 1 : 0;
        a = fabsf(n[2]) > fabsf(n[a]) ? 2 : a;
        b = (a + 1) % 3;
        c[a] = first ? (n[a] < 0 ? -1 : 1) * (-(double)n[b] - 0.5 * (double)n[3 - a - b])
                     : (double)n[3 - a - b] - 0.5 * (double)n[b];
        bound = ray_bound(across[first]);
        for (int s = 0; s < 2; ++s) {
            float along = across[first][0] * (float)x[3 + 3 * s][i];
            for (int k = 1; k < 3; ++k) along += across[first][k] * (float)x[3 + 3 * s + k][i];
            y[s] = along;
        }
        way_of(x, i, 3, 6, way);
        share[i] = fabs((double)(y[1] - y[0]) - dot_of(c, way)) / (double)bound;
    }
}

/* A normal and a triangle. */
static void fan_areas(const double (*x)[N], double share[N])
{
    lanes n[3], at[3][3], area, largest;
    sc_leaf_derived ready;
    double exact[N];
    read_point(x, 0, n);
    for (int k = 0; k < 3; ++k) read_point(x, 3 + 3 * k, at[k]);
    make_normals(at, &ready);
    largest = lanes_larger(lanes_larger(lanes_absolute(n[0]), lanes_absolute(n[1])),
                           lanes_absolute(n[2]));
    area = lanes_multiply(n[0], lanes_load(ready.normal[0]));
    for (int k = 1; k < 3; ++k)
        area = lanes_add(area, lanes_multiply(n[k], lanes_load(ready.normal[k])));
    for (int i = 0; i < N; ++i) {
        double e[3], f[3], m[3], direction[3];
        for (int k = 0; k < 3; ++k) direction[k] = (double)(float)x[k][i];
        way_of(x, i, 3, 6, e);
        way_of(x, i, 3, 9, f);
        cross_of(e, f, m);
        exact[i] = dot_of(direction, m);
    }
    share_of(area, area_bound(lanes_load(ready.size), largest), exact, share);
}

/* ------------------------------------------------------------------------------------------------
 * Contours: an axis, the middle and points; as project in query/simple_kernel.h
 */

typedef struct places {
    double axis[2][3];            /* exactly those that are used */
    float at[4][2], error, reach; /* computed; see sc_bounds_contour */
    double exact[4][2];
} places;

static void find_places(const double (*x)[N], int lane, int count, int first, places *p)
{
    float from[3], axis[2][3], size = 0;
    for (int m = 0; m < 2; ++m) {
        float sum = 0, least = 0.5f;
        for (int k = 0; k < 3; ++k) { /* whole numbers over a power of two, see sc_simple_axes */
            axis[m][k] = (float)(nearbyint(x[3 * m + k][lane] * 32768) / 32768);
            sum += fabsf(axis[m][k]);
        }
        for (; sum > 1; sum /= 2)
            for (int k = 0; k < 3; ++k) axis[m][k] /= 2;
        for (; sum > 0 && sum <= least; sum *= 2)
            for (int k = 0; k < 3; ++k) axis[m][k] *= 2;
        for (int k = 0; k < 3; ++k) p->axis[m][k] = (double)axis[m][k];
    }
    for (int k = 0; k < 3; ++k)
        from[k] = (float)x[first + k][lane] / 2 + (float)x[first + 3 + k][lane] / 2;
    for (int i = 0; i < count; ++i) {
        float d[3];
        double way[3];
        for (int k = 0; k < 3; ++k) {
            d[k] = (float)x[first + 3 * i + k][lane] - from[k];
            way[k] = x[first + 3 * i + k][lane] - (double)from[k];
            size = size > fabsf(d[k]) ? size : fabsf(d[k]);
        }
        for (int m = 0; m < 2; ++m) {
            p->at[i][m] = axis[m][0] * d[0] + axis[m][1] * d[1] + axis[m][2] * d[2];
            p->exact[i][m] = dot_of(p->axis[m], way);
        }
    }
    p->error = sc_bounds_contour(size);
    p->reach = size;
}

static void contour_places(const double (*x)[N], double share[N])
{
    for (int i = 0; i < N; ++i) {
        places p;
        find_places(x, i, 2, 6, &p);
        share[i] = 0;
        for (int k = 0; k < 4; ++k)
            share[i] = fmax(share[i], fabs((double)p.at[k / 2][k % 2] - p.exact[k / 2][k % 2]) /
                                          (double)p.error);
    }
}

/* What two points may be off by from each other, of what boxes of theirs are kept apart by: sides
   of the first moved by some errors and of the other by some, rounded. */
static void boxes_in_plane(const double (*x)[N], float own, float other, double share[N])
{
    for (int i = 0; i < N; ++i) {
        places p;
        find_places(x, i, 2, 6, &p);
        share[i] = 0;
        for (int k = 0; k < 2; ++k) {
            float high = p.at[0][k] + own * p.error, low = p.at[1][k] - other * p.error;
            double kept = (double)high - (double)low - ((double)p.at[0][k] - (double)p.at[1][k]);
            double off =
                (p.exact[0][k] - p.exact[1][k]) - ((double)p.at[0][k] - (double)p.at[1][k]);
            share[i] = fmax(share[i], off / kept);
        }
    }
}

static void contour_spans(const double (*x)[N], double share[N])
{
    boxes_in_plane(x, 2, 2, share);
}

static void contour_boxes(const double (*x)[N], double share[N])
{
    boxes_in_plane(x, 4, 0, share);
}

/* A free cell between two; cells are as large as they are least, 512 errors over 126. */
static void contour_cells(const double (*x)[N], double share[N])
{
    for (int i = 0; i < N; ++i) {
        places p;
        find_places(x, i, 2, 6, &p);
        share[i] = 0;
        for (int k = 0; k < 2; ++k) {
            double off =
                (p.exact[0][k] - p.exact[1][k]) - ((double)p.at[0][k] - (double)p.at[1][k]);
            share[i] = fmax(share[i], fabs(off) / (0.999 * 512 / 126 * (double)p.error));
        }
    }
}

/* The cross product of the ways between two points each. */
static void contour_turns(const double (*x)[N], double share[N])
{
    for (int i = 0; i < N; ++i) {
        places p;
        float a[2], b[2], d, bound[N];
        double e[2], f[2];
        find_places(x, i, 4, 6, &p);
        for (int k = 0; k < 2; ++k) {
            a[k] = p.at[1][k] - p.at[0][k];
            b[k] = p.at[3][k] - p.at[2][k];
            e[k] = p.exact[1][k] - p.exact[0][k];
            f[k] = p.exact[3][k] - p.exact[2][k];
        }
        d = a[0] * b[1] - a[1] * b[0];
        lanes_store(bound, bound_in_plane(p.error, lanes_all(fabsf(a[0]) + fabsf(a[1]) +
                                                             fabsf(b[0]) + fabsf(b[1]))));
        share[i] = fabs((double)d - (e[0] * f[1] - e[1] * f[0])) / (double)bound[0];
    }
}

/* ------------------------------------------------------------------------------------------------
 * query/, doubles
 */

/* Eight pairs of triangles, twice; made smaller by so many binary digits, all signs that there
   are. What is exact is so of the numbers before. */
static void eight_pairs(const double (*x)[N], int s, double share[N])
{
    double at[2 * SC_PAIR_LANES][3][3], bound[SC_PAIR_LANES], computed[15][SC_PAIR_LANES];
    uint32_t triangle[2 * SC_PAIR_LANES][3];
    sc_pair pair[SC_PAIR_LANES];
    sc_pair_lanes pairs;
    memset(&pairs, 0, sizeof pairs);
    pairs.pairs = pair;
    pairs.of[0].triangle = triangle[0];
    pairs.of[0].positions = (const unsigned char *)at;
    pairs.of[0].stride = 3 * sizeof(double);
    pairs.of[1] = pairs.of[0];
    for (int half = 0; half < N; half += SC_PAIR_LANES) {
        eight_triangle_pairs e;
        for (int i = 0; i < SC_PAIR_LANES; ++i) {
            pair[i].a = 2 * (uint32_t)i;
            pair[i].b = 2 * (uint32_t)i + 1;
            for (int k = 0; k < 18; ++k)
                at[2 * i + k / 9][k / 3 % 3][k % 3] = ldexp(x[k][half + i], -s);
            for (int k = 0; k < 6; ++k)
                triangle[2 * i + k / 3][k % 3] = 6 * (uint32_t)i + (uint32_t)k;
        }
        read_eight(&pairs, &e);
        doubles_store(bound, e.bound);
        for (int k = 0; k < 3; ++k) {
            doubles_store(computed[k], e.side[0][k]);
            doubles_store(computed[3 + k], e.side[1][k]);
            for (int m = 0; m < 3; ++m) doubles_store(computed[6 + 3 * k + m], e.line[k][m]);
        }
        for (int i = 0; i < SC_PAIR_LANES; ++i) {
            twice a[3][3], b[3][3], sum, n[3][3], of[3];
            double most = 0, up = ldexp(1, s > 330 ? 330 : s);
            for (int k = 0; k < 18; ++k) { /* seen from the first corner of the first */
                double p = ldexp(at[2 * i + k / 9][k / 3 % 3][k % 3], s);
                double from = ldexp(at[2 * i][0][k % 3], s);
                (k < 9 ? a : b)[k / 3 % 3][k % 3] = difference(p, from);
            }
            for (int k = 0; k < 15; ++k) {
                double c = computed[k][i] * up * up * up, off;
                if (k < 3) { /* corners a_k, seen from b_0 */
                    for (int m = 0; m < 3; ++m) {
                        n[0][m] = add(b[1][m], minus(b[0][m]));
                        n[1][m] = add(b[2][m], minus(b[0][m]));
                        n[2][m] = add(b[0][m], minus(a[k][m]));
                    }
                    sum = determinant_of(n[0], n[1], n[2]);
                } else if (k < 6) {
                    sum = determinant_of(a[1], a[2], b[k - 3]);
                } else { /* edges of the first from k, of the second from m */
                    int from = (k - 6) / 3, to = (from + 1) % 3, m = k % 3, next = (m + 1) % 3;
                    for (int c3 = 0; c3 < 3; ++c3) {
                        n[0][c3] = add(b[m][c3], minus(a[from][c3]));
                        n[1][c3] = add(b[next][c3], minus(a[from][c3]));
                        of[c3] = add(a[to][c3], minus(a[from][c3]));
                    }
                    sum = determinant_of(n[0], n[1], of);
                }
                off = off_by(c, sum) / (bound[i] * up * up * up);
                most = fmax(most, off);
            }
            share[half + i] = most;
        }
    }
}

static void decide_signs(const double (*x)[N], double share[N])
{
    eight_pairs(x, 0, share);
}

/* So small that 2^-300 takes the place of r. */
static void decide_tiny(const double (*x)[N], double share[N])
{
    eight_pairs(x, 325, share);
}

/* Sides in a projection; s as above. */
static void sides_of_eight(const double (*x)[N], int s, double share[N])
{
    for (int i = 0; i < N; ++i) {
        double p[3][2], r = 0x1p-300, reach, d, bound, bounds[SC_PAIR_LANES];
        twice exact, e[2][2];
        for (int k = 0; k < 6; ++k) p[k / 2][k % 2] = ldexp(x[k][i], -s);
        /* r is seen from one point; of a side from another, differences are up to 2 r */
        for (int k = 0; k < 4; ++k)
            r = fmax(r, fabs(p[1 + k / 2][k % 2] - ldexp(x[6 + k % 2][i], -s)));
        for (int k = 0; k < 2; ++k) r = fmax(r, fabs(p[0][k] - ldexp(x[6 + k][i], -s)));
        reach = 4 * r;
        doubles_store(bounds, beside_bound(doubles_all(reach)));
        bound = bounds[0];
        d = (p[1][0] - p[0][0]) * (p[2][1] - p[0][1]) - (p[1][1] - p[0][1]) * (p[2][0] - p[0][0]);
        for (int k = 0; k < 4; ++k)
            e[k / 2][k % 2] = difference(ldexp(p[1 + k / 2][k % 2], s), ldexp(p[0][k % 2], s));
        exact = minor_of(e[0][0], e[0][1], e[1][0], e[1][1]);
        d = ldexp(d, 2 * s); /* what the subtraction lost changes no sign */
        share[i] = fmax(0, off_by(d, exact) - U * fabs(d)) / ldexp(bound, 2 * s);
    }
}

static void decide_sides(const double (*x)[N], double share[N])
{
    sides_of_eight(x, 0, share);
}

static void decide_sides_tiny(const double (*x)[N], double share[N])
{
    sides_of_eight(x, 500, share);
}

/* A coordinate of a projection, of twice the error that the star test takes: query/star.c asks for
   2 x_error beside a shared point, and bounds of extents have one already. */
static void beside_a_point(const double (*x)[N], double share[N])
{
    for (int i = 0; i < N; ++i) {
        double u[3], d[3], radius = 0, computed, error;
        twice sum = {0, 0}, exact = {0, 0};
        for (int k = 0; k < 3; ++k) {
            u[k] = nearbyint(x[k][i] * 506);
            d[k] = x[3 + k][i] - x[6 + k][i];
            radius = fmax(radius, fabs(d[k]));
        }
        computed = u[0] * d[0] + u[1] * d[1] + u[2] * d[2];
        error = 5 * 1.1102230246251565e-16 * (fabs(u[0]) + fabs(u[1]) + fabs(u[2])) * radius;
        for (int k = 0; k < 3; ++k) {
            exact.high = u[k];
            sum = add(sum, product(exact, difference(x[3 + k][i], x[6 + k][i])));
        }
        share[i] = error > 0 ? off_by(computed, sum) / (2 * error) : 0;
    }
}

/* ------------------------------------------------------------------------------------------------
 * step/
 */

/* A corner of a difference at a time, along a direction: of T / 16, which is 2^-36 M at least. */
static void impacts(const double (*x)[N], double share[N])
{
    for (int i = 0; i < N; ++i) {
        double t = fabs(x[0][i]), most = 0, n[3], length, computed = 0, at[3];
        twice sum = {0, 0}, one = {1, 0}, time = {t, 0};
        t = t > 1 ? 1 : t;
        time.high = t;
        for (int k = 0; k < 3; ++k) n[k] = x[1 + k][i];
        length = sqrt(dot_of(n, n));
        for (int k = 0; k < 3; ++k) {
            double s = x[4 + k][i] - x[7 + k][i], e = x[10 + k][i] - x[13 + k][i];
            twice p = product(add(one, minus(time)), difference(x[4 + k][i], x[7 + k][i]));
            twice direction = {0, 0};
            p = add(p, product(time, difference(x[10 + k][i], x[13 + k][i])));
            most = fmax(most, fmax(fabs(s), fabs(e)));
            n[k] = length > 0 ? n[k] / length : 0;
            direction.high = n[k];
            sum = add(sum, product(direction, p));
            at[k] = (1 - t) * s + t * e;
        }
        computed = dot_of(at, n);
        share[i] = most > 0 ? off_by(computed, sum) / (0x1p-36 * most) : 0;
    }
}

/* Boxes at one end of a step, of two points: what they and the sides are off by, of the 3e-7 that
   is there for it beyond the distance; see sc_motion_read. */
static void step_boxes(const double (*x)[N], double share[N])
{
    for (int i = 0; i < N; ++i) {
        float distance = (float)fabs(x[2][i]) * 0.25f;
        float margin = sc_motion_margin(distance), half = margin / 2;
        float high = (float)x[0][i] + half, low = (float)x[1][i] - half;
        double off = (x[0][i] - x[1][i]) - ((double)high - (double)low) + (double)margin;
        share[i] = off / ((double)margin - (double)distance);
    }
}

/* The same where the box of one is compared with the other: that of leaf clusters, triangles and
   edges, moved by all of it. */
static void step_point_boxes(const double (*x)[N], double share[N])
{
    for (int i = 0; i < N; ++i) {
        float distance = (float)fabs(x[2][i]) * 0.25f, margin = sc_motion_margin(distance);
        float high = (float)x[0][i] + margin;
        double off = (x[0][i] - x[1][i]) - ((double)high - (double)(float)x[1][i]) + (double)margin;
        share[i] = off / ((double)margin - (double)distance);
    }
}

/* A direction, two points and a clearance: what the places of these and the plane of a slab, as
   make_moving_slabs has it, are off by, beyond that clearance. */
static void step_slabs(const double (*x)[N], double share[N])
{
    lanes n[3], p[3], q[3], other;
    float place[N];
    read_point(x, 0, n);
    read_point(x, 3, p);
    read_point(x, 6, q);
    lanes_store(place, places_along((const lanes *)n, (const lanes *)p));
    other = places_along((const lanes *)n, (const lanes *)q);
    for (int i = 0; i < N; ++i) {
        const float distance = (float)fabs(x[9][i]) * 0x1p-22f;
        const lanes margin = slab_margin((const lanes *)n, distance);
        float plane[N], kept[N];
        double direction[3], way[3], clear;
        lanes_store(kept, margin);
        lanes_store(plane, lanes_add(other, margin));
        for (int k = 0; k < 3; ++k) direction[k] = (double)(float)x[k][i];
        way_of(x, i, 6, 3, way);
        clear = (double)distance * sqrt(dot_of(direction, direction));
        share[i] =
            ((double)place[i] - (double)plane[i] + (double)kept[i] - dot_of(direction, way)) /
            ((double)kept[i] - clear);
    }
}

/* A direction, whose length is bounded. */
static void slab_lengths(const double (*x)[N], double share[N])
{
    lanes n[3];
    float kept[N], without[N];
    read_point(x, 0, n);
    lanes_store(kept, slab_margin((const lanes *)n, 1));
    lanes_store(without, slab_margin((const lanes *)n, 0));
    for (int i = 0; i < N; ++i) {
        double direction[3];
        for (int k = 0; k < 3; ++k) direction[k] = (double)(float)x[k][i];
        share[i] = sqrt(dot_of(direction, direction)) / ((double)kept[i] - (double)without[i]);
    }
}

/* Sides of a triangle at both ends, and a direction of the cone: the coefficients of n . s. */
static void moving_cones(const double (*x)[N], double share[N])
{
    static const double direction[7][3] = {{1, 0, 0},  {0, 1, 0},  {0, 0, 1},  {1, 1, 1},
                                           {1, 1, -1}, {1, -1, 1}, {1, -1, -1}};
    for (int i = 0; i < N; ++i) {
        float e[2][3], f[2][3], n[3][3], size[2] = {0, 0}, errors[N];
        double a[2][3], b[2][3], exact[3][3], most = 0;
        for (int end = 0; end < 2; ++end) {
            float sum[2] = {0, 0};
            for (int k = 0; k < 3; ++k) {
                e[end][k] = (float)x[9 * end + 3 + k][i] - (float)x[9 * end + k][i];
                f[end][k] = (float)x[9 * end + 6 + k][i] - (float)x[9 * end + k][i];
                a[end][k] = x[9 * end + 3 + k][i] - x[9 * end + k][i];
                b[end][k] = x[9 * end + 6 + k][i] - x[9 * end + k][i];
                sum[0] += fabsf(e[end][k]);
                sum[1] += fabsf(f[end][k]);
            }
            for (int k = 0; k < 2; ++k) size[k] = size[k] > sum[k] ? size[k] : sum[k];
        }
        for (int k = 0; k < 3; ++k) {
            int u = (k + 1) % 3, v = (k + 2) % 3;
            n[0][k] = e[0][u] * f[0][v] - e[0][v] * f[0][u];
            n[2][k] = e[1][u] * f[1][v] - e[1][v] * f[1][u];
            n[1][k] = 0.5f * ((e[0][u] * f[1][v] - e[0][v] * f[1][u]) +
                              (e[1][u] * f[0][v] - e[1][v] * f[0][u]));
            exact[0][k] = a[0][u] * b[0][v] - a[0][v] * b[0][u];
            exact[2][k] = a[1][u] * b[1][v] - a[1][v] * b[1][u];
            exact[1][k] = 0.5 * ((a[0][u] * b[1][v] - a[0][v] * b[1][u]) +
                                 (a[1][u] * b[0][v] - a[1][v] * b[0][u]));
        }
        lanes_store(errors, moving_normal_error(lanes_all(size[0]), lanes_all(size[1])));
        for (int s = 0; s < 7; ++s)
            for (int k = 0; k < 3; ++k) {
                float dot = n[k][0];
                if (s < 3) {
                    dot = n[k][s];
                } else {
                    dot = s < 5 ? n[k][0] + n[k][1] : n[k][0] - n[k][1];
                    dot = s % 2 ? dot + n[k][2] : dot - n[k][2];
                }
                most = fmax(most, fabs((double)dot - dot_of(exact[k], direction[s])));
            }
        share[i] = most / (double)errors[0];
    }
}

/* A side of a triangle: how long it may be, squared, of what it is taken for. */
static void moving_sides(const double (*x)[N], double share[N])
{
    for (int i = 0; i < N; ++i) {
        float square = 0, d[3], bound[N];
        double way[3];
        for (int k = 0; k < 3; ++k) {
            d[k] = (float)x[3 + k][i] - (float)x[k][i];
            square += d[k] * d[k];
        }
        way_of(x, i, 0, 3, way);
        lanes_store(bound, longest_square(lanes_all(square)));
        share[i] = dot_of(way, way) / (double)bound[0];
    }
}

/* A direction, and two points. */
static void moving_apart(const double (*x)[N], double share[N])
{
    lanes m[3], p[3], r[3], size, reach = lanes_all(0), clear;
    double exact[N];
    read_point(x, 0, m);
    read_point(x, 3, p);
    read_point(x, 6, r);
    for (int k = 0; k < 3; ++k) {
        r[k] = lanes_subtract(r[k], p[k]);
        reach = lanes_larger(reach, lanes_absolute(r[k]));
    }
    clear = clear_in_space(0, reach);
    size = lanes_add(lanes_add(lanes_absolute(m[0]), lanes_absolute(m[1])), lanes_absolute(m[2]));
    for (int i = 0; i < N; ++i) {
        double direction[3], way[3];
        for (int k = 0; k < 3; ++k) direction[k] = (double)(float)x[k][i];
        way_of(x, i, 3, 6, way);
        exact[i] = dot_of(direction, way);
    }
    share_of(dot_in_space((const lanes *)m, (const lanes *)r),
             lanes_add(lanes_multiply(size, clear), lanes_all(16 * FLT_MIN)), exact, share);
}

/* Two points in the plane of a contour along a direction of it, the way between two others. */
static void moving_contours(const double (*x)[N], double share[N])
{
    for (int i = 0; i < N; ++i) {
        places p;
        float m[2], along[2], clear;
        double exact = 0, bound;
        find_places(x, i, 4, 6, &p);
        for (int k = 0; k < 2; ++k) m[k] = p.at[3][k] - p.at[2][k];
        for (int s = 0; s < 2; ++s) along[s] = m[0] * p.at[s][0] + m[1] * p.at[s][1];
        clear = SC_BOUNDS_MOVING_TURN * p.error * 1.000001f;
        bound = (double)(fabsf(m[0]) * clear + fabsf(m[1]) * clear + 16 * FLT_MIN);
        for (int k = 0; k < 2; ++k) exact += (double)m[k] * (p.exact[1][k] - p.exact[0][k]);
        share[i] = fabs((double)(along[1] - along[0]) - exact) / bound;
    }
}

/* Found by longer searches. */
static const double known_ray[] = {
    -0x1.5c351286b0ba5p-3, 0x1.160178fff2e49p-2,  0x1.69ac99cf34fb6p-1,
    -0x1.edbb79000d1b7p-1, -0x1.fffeeb000d1b7p-1, 0x1.5cbdc6fff2e49p-1,
    0x1.edbb79000d1b7p-1,  0x1.fffeeb000d1b7p-1,  0x1.deaf59000d1b7p-1};
static const double known_area[] = {
    0x1.5aa834fff2e49p-1,  -0x1.5aa8338926941p-1, 0x1.5aa833000d1b7p-1, 0x1.52c5b0fff2e49p-1,
    0x1.a6c63efff2e49p-1,  -0x1.27a761000d1b7p-2, 0x1.52c5af000d1b7p-1, 0x1.a6c63d000d1b7p-1,
    -0x1.27a761000d1b7p-2, 0x1.52c5b0fff2e49p-1,  0x1.a6c63d000d1b7p-1, -0x1.280c9efff2e49p-2};
static const double known_float_side[] = {-0x1.9ea800fff2e49p-11, 0x1.ff8bff0132cp-10,
                                          0x1.fffc83000d1b7p-1,   -0x1.ff6744fff2e49p-1,
                                          0x1.fff1c8fff2e49p-1,   -0x1.ff5c37000d1b7p-1};
static const double known_side[] = {-0x1.ffffffa68e913p-2, -0x1p-13,
                                    -0x1.fffffffe97d83p-1, 0x1.fff337a6a4cb5p-2,
                                    -0x1.fffffff85edap-1,  0x1.fffffff475fc7p-2,
                                    -0x1.8000bc667286p-1,  0x1.ffdffff48dc65p-3};

static const double known_moving[] = {
    -0x1.ff1330fff2e49p-1, 0x1.000000282479p-15,  -0x1.45a738a925338p-11, 0x1.0da128fff2e49p-11,
    0x1.c4a17efff2e49p-1,  0x1.5cd4960fe4a01p-3,  0x1.23f1c7000d1b7p-4,   -0x1.171f24fff2e49p-1,
    0x1.1c1fff000d1b7p-15, -0x1.ffa003000d1b7p-1, 0x1.af8526ffd66f7p-3,   -0x1.ff885d000d1b7p-1,
    -0x1.e3c752fff2e49p-2, -0x1.6095b7000d1b7p-7, -0x1.ff89bcfff2e49p-1,  0x1.5bf2e8fff2e49p-11,
    -0x1.6095c6fff2e49p-7, -0x1.ffffff000d1b7p-1};

/* In the order of the table in lib/GUARANTEE.md. */
const rounding_bound rounding_bounds[] = {
    {"base/predicates.h, tiny term", "exact signs", ROUNDING_TINY, 12, 3, 1, rounding_space_tiny, 0,
     NULL},
    {"base/predicates.c, sums of two doubles", "exact signs", ROUNDING_DOUBLES, 12, 3, 1,
     rounding_two_doubles, 0, NULL},
    {"base/predicates.c, plain arithmetic", "exact signs", ROUNDING_WHOLE, 9, 3, 1,
     rounding_few_bits, 0, NULL},
    {"query/primitives.c, a triangle's area", "exact signs", ROUNDING_DOUBLES, 9, 3, 1,
     rounding_area, 0.55, NULL},
    {"base/boxes.h, tiny term", "boxes and points", ROUNDING_UNIT, 1, 1, 1, float_tiny, 0, NULL},
    {"base/boxes.h, tiny term in the unit box", "boxes and points", ROUNDING_UNIT, 1, 1, 1,
     unit_tiny, 0, NULL},
    {"query/derived_kernel.h, boxes of triangles", "boxes and points", ROUNDING_UNIT, 1, 1, 1,
     box_step, 0, NULL},
    {"pose/points_kernel.h, points", "boxes and points", ROUNDING_UNIT, 1, 1, 1, unit_box, 0.98,
     NULL},
    {"query/simple_kernel.h, places", "contours", ROUNDING_UNIT, 12, 3, 1, contour_places, 0.95,
     NULL},
    {"query/simple_kernel.h, boxes of runs", "contours", ROUNDING_UNIT, 12, 3, 1, contour_spans, 0,
     NULL},
    {"query/simple_kernel.h, boxes of edges", "contours", ROUNDING_UNIT, 12, 3, 1, contour_boxes, 0,
     NULL},
    {"query/simple_kernel.h, turns", "contours", ROUNDING_UNIT, 18, 3, 1, contour_turns, 0, NULL},
    {"query/small_kernel.h, boxes of cells", "contours", ROUNDING_UNIT, 12, 3, 1, contour_cells, 0,
     NULL},
    {"query/star.c, one shared point", "contours", ROUNDING_DOUBLES, 9, 3, 1, beside_a_point, 0,
     NULL},
    {"query/sixteen_kernel.h, planes", "triangles in the unit box", ROUNDING_UNIT, 12, 3, 1,
     sixteen_planes, 0, NULL},
    {"query/sixteen_kernel.h, order", "triangles in the unit box", ROUNDING_UNIT, 12, 3, 1,
     sixteen_edges, 0.9, NULL},
    {"query/sixteen_kernel.h, sides", "triangles in the unit box", ROUNDING_UNIT, 6, 2, 1, sides,
     0.56, known_float_side},
    {"query/slab_kernel.h, slabs", "triangles in the unit box", ROUNDING_UNIT, 9, 3, 1, slabs, 0.6,
     NULL},
    {"query/neighbor_kernel.h, planes", "triangles in the unit box", ROUNDING_UNIT, 12, 3, 1,
     neighbor_planes, 0, NULL},
    {"query/neighbor_kernel.h, directions", "triangles in the unit box", ROUNDING_UNIT, 9, 3, 1,
     neighbor_directions, 0.85, NULL},
    {"query/touch_kernel.h", "triangles in the unit box", ROUNDING_UNIT, 9, 3, 1, touching, 0.85,
     NULL},
    {"query/fan_kernel.h, rays", "triangles in the unit box", ROUNDING_UNIT, 9, 3, 1, fan_rays,
     0.66, known_ray},
    {"query/fan_kernel.h, areas", "triangles in the unit box", ROUNDING_UNIT, 12, 3, 1, fan_areas,
     0.6, known_area},
    {"step/impact.c", "steps", ROUNDING_DOUBLES, 16, 3, 1, impacts, 0, NULL},
    {"query/decide_kernel.h, signs", "triangles in doubles", ROUNDING_DOUBLES, 18, 3, 10,
     decide_signs, 0, NULL},
    {"query/decide_kernel.h, tiny term", "triangles in doubles", ROUNDING_TINY, 18, 3, 10,
     decide_tiny, 0, NULL},
    {"query/decide_kernel.h, sides", "triangles in doubles", ROUNDING_DOUBLES, 8, 2, 1,
     decide_sides, 0.59, known_side},
    {"query/decide_kernel.h, tiny term of sides", "triangles in doubles", ROUNDING_TINY, 8, 2, 1,
     decide_sides_tiny, 0, NULL},
    {"step/step_motion.c, boxes", "steps", ROUNDING_UNIT, 3, 1, 1, step_boxes, 0.57, NULL},
    {"step/leaf_motion_kernel.h, boxes", "steps", ROUNDING_UNIT, 3, 1, 1, step_point_boxes, 0,
     NULL},
    {"step/leaf_motion_kernel.h, slabs", "steps", ROUNDING_UNIT, 10, 3, 10, step_slabs, 0.6, NULL},
    {"step/leaf_motion_kernel.h, lengths", "steps", ROUNDING_UNIT, 3, 3, 1, slab_lengths, 0.99,
     NULL},
    {"step/moving_cones_kernel.h, n . s", "steps", ROUNDING_UNIT, 18, 3, 1, moving_cones, 0.9,
     NULL},
    {"step/moving_cones_kernel.h, longest side", "steps", ROUNDING_UNIT, 6, 3, 1, moving_sides,
     0.99, NULL},
    {"step/apart_kernel.h", "steps", ROUNDING_UNIT, 9, 3, 1, moving_apart, 0.9, NULL},
    {"step/moving_contour.c", "steps", ROUNDING_UNIT, 18, 3, 1, moving_contours, 0.52,
     known_moving},
};
const int rounding_bound_count = (int)(sizeof rounding_bounds / sizeof rounding_bounds[0]);
