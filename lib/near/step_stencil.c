/*
 * The closest points of a pair of a step at two times. See step_stencil.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "near/step_stencil.h"

#include <math.h>
#include <string.h>

#include "base/predicates.h"
#include "near/stencil.h"

static void find_at(uint32_t kind, const double at[4][3], sc_near_stencil *stencil)
{
    const double *const points[4] = {at[0], at[1], at[2], at[3]};
    sc_stencil_find(kind, points, stencil);
}

/* Makes a vector one of length 1; 0: it has none. */
static int make_unit(const double v[3], double unit[3])
{
    double most = fmax(fabs(v[0]), fmax(fabs(v[1]), fabs(v[2]))), length;
    int k;
    if (!(most > 0) || most - most != 0) return 0;
    for (k = 0; k < 3; k++) unit[k] = v[k] / most;
    length = sqrt(unit[0] * unit[0] + unit[1] * unit[1] + unit[2] * unit[2]);
    for (k = 0; k < 3; k++) unit[k] /= length;
    return 1;
}

/* Vectors between points, over the largest of their coordinates, of which products neither overflow
   nor underflow to speak of. */
static int find_way(const double from[3], const double to[3], double v[3])
{
    double way[3];
    int k, fits = 1;
    for (k = 0; k < 3; k++) {
        way[k] = to[k] - from[k];
        fits &= way[k] - way[k] == 0;
    }
    /* halves only where they lose nothing: among the smallest doubles they would */
    for (k = 0; k < 3 && !fits; k++) way[k] = to[k] / 2 - from[k] / 2;
    return make_unit(way, v);
}

/* The direction of (p1 - p0) x (q1 - q0); 0: there is none. */
static int cross_sides(const double p0[3], const double p1[3], const double q0[3],
                       const double q1[3], double n[3])
{
    double e[3], f[3], c[3];
    int k;
    if (!find_way(p0, p1, e) || !find_way(q0, q1, f)) return 0;
    for (k = 0; k < 3; k++) {
        const int x = (k + 1) % 3, y = (k + 2) % 3;
        c[k] = e[x] * f[y] - e[y] * f[x];
    }
    return make_unit(c, n);
}

/* The normal of a pair that touches at both times, by where a was seen. */
static int find_normal_by_side(uint32_t kind, const double at[4][3], int side, double normal[3])
{
    const int is_face = kind == SC_NEAR_VERTEX_FACE;
    double n[3];
    int k;
    if (!side || !(is_face ? cross_sides(at[1], at[2], at[1], at[3], n)
                           : cross_sides(at[0], at[1], at[2], at[3], n)))
        return 0;
    /* a vertex on the side to which the face's normal points is left against it; of edges the side
       is that of b */
    for (k = 0; k < 3; k++) normal[k] = (is_face ? -side : side) * n[k];
    return 1;
}

/* Positive where p is on the side of a, b, c from which they are seen counter-clockwise. */
static int seen_from(const double a[3], const double b[3], const double c[3], const double p[3])
{
    uint64_t fallbacks = 0;
    return sc_predicates_orient3d(a, b, c, p, &fallbacks);
}

static int find_side(uint32_t kind, const double at[4][3])
{
    if (kind == SC_NEAR_VERTEX_FACE) return seen_from(at[1], at[2], at[3], at[0]);
    /* for e, f along the edges and d from a0 to b0: (e x d) . (d + f) = -d . (e x f) */
    return -seen_from(at[0], at[1], at[2], at[3]);
}

static int approaches(const sc_near_stencil *s, const double start[4][3], const double end[4][3])
{
    double sum = 0;
    int i, k;
    if (!(s->distance > 0)) return 1;
    for (k = 0; k < 3; k++) {
        double moved = 0;
        for (i = 0; i < 4; i++) moved += s->weights[i] * (end[i][k] / 2 - start[i][k] / 2);
        sum += s->vector[k] / s->distance * moved;
    }
    return sum < 0;
}

void sc_step_stencil_find(uint32_t kind, const double start[4][3], const double end[4][3],
                          sc_step_stencil *s)
{
    const double t = s->time;
    double at[4][3];
    int i, k;
    for (i = 0; i < 4; i++)
        for (k = 0; k < 3; k++) at[i][k] = (1 - t) * start[i][k] + t * end[i][k];
    find_at(kind, start, &s->start);
    find_at(kind, (const double(*)[3])at, &s->impact);
    s->side = find_side(kind, start);
    s->flags = approaches(&s->start, start, end) ? SC_STEP_APPROACHES : 0;
    if (make_unit(s->impact.vector, s->normal) || make_unit(s->start.vector, s->normal) ||
        find_normal_by_side(kind, start, s->side, s->normal))
        return;
    memset(s->normal, 0, sizeof s->normal);
    s->flags |= SC_STEP_NO_NORMAL;
}
