/*
 * The closest points of a pair of a step at two times. See step_stencil.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "near/step_stencil.h"

#include <limits.h>
#include <math.h>
#include <string.h>

#include "base/predicates.h"
#include "near/differences.h"
#include "near/stencil.h"

static void find_at(uint32_t kind, const double at[4][3], sc_near_stencil *stencil)
{
    const double *const points[4] = {at[0], at[1], at[2], at[3]};
    sc_stencil_find(kind, points, stencil);
}

/* Makes a vector one of length 1; 0: it has none, and unit is 0. */
static int make_unit(const double v[3], double unit[3])
{
    const double most = fmax(fabs(v[0]), fmax(fabs(v[1]), fabs(v[2])));
    double length;
    int k;
    memset(unit, 0, 3 * sizeof *unit);
    if (!(most > 0)) return 0;
    for (k = 0; k < 3; k++) unit[k] = v[k] / most;
    length = sqrt(unit[0] * unit[0] + unit[1] * unit[1] + unit[2] * unit[2]);
    for (k = 0; k < 3; k++) unit[k] /= length;
    return 1;
}

/* The direction of the vector between the closest points; 0: it has no length, and direction is
   0. */
static int find_direction(uint32_t kind, const double at[4][3], const sc_near_stencil *s,
                          double direction[3])
{
    sc_near_stencil nearer;
    double quarter[4][3];
    int i, k;
    if (s->distance < 0x1p1023) return make_unit(s->vector, direction);
    /* Its coordinates may be infinite. Those with a quarter of the points' are not; what this loses
       of the smallest doubles is nothing at such a distance. */
    for (i = 0; i < 4; i++)
        for (k = 0; k < 3; k++) quarter[i][k] = at[i][k] / 4;
    find_at(kind, (const double(*)[3])quarter, &nearer);
    return make_unit(nearer.vector, direction);
}

/* The normal of a pair that touches at both times, by where a was seen; 0: in between. Products of
   differences in doubles would tell little of edges that are almost parallel. */
static int find_normal_by_side(uint32_t kind, const double at[4][3], int side, double normal[3])
{
    const double *const points[4] = {at[0], at[1], at[2], at[3]};
    const int is_face = kind == SC_NEAR_VERTEX_FACE;
    sc_predicates_value parts[3];
    sc_quad quad;
    sc_span e, f;
    sc_cross cross;
    double n[3];
    int k, most = INT_MIN;
    if (!side) return 0;
    sc_quad_set(&quad, points);
    sc_quad_span(&quad, is_face ? 1 : 0, is_face ? 2 : 1, &e);
    sc_quad_span(&quad, is_face ? 1 : 2, 3, &f);
    sc_quad_cross(&e, &f, &cross); /* not 0, or side were */
    for (k = 0; k < 3; k++) {
        parts[k] = sc_quad_part(&quad, &cross, k);
        if (parts[k].number != 0 && parts[k].exponent > most) most = parts[k].exponent;
    }
    /* a vertex on the side to which the face's normal points is left against it; of edges the side
       is that of b */
    for (k = 0; k < 3; k++)
        n[k] = (is_face ? -side : side) * ldexp(parts[k].number, parts[k].exponent - most);
    return make_unit(n, normal);
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

/* away: the direction of the vector s. */
static int approaches(const sc_near_stencil *s, const double away[3], const double start[4][3],
                      const double end[4][3])
{
    double sum = 0;
    int i, k;
    if (!(s->distance > 0)) return 1;
    for (k = 0; k < 3; k++) {
        double moved = 0; /* an eighth, lest a sum overflows */
        for (i = 0; i < 4; i++) moved += s->weights[i] * (end[i][k] / 8 - start[i][k] / 8);
        sum += away[k] * moved;
    }
    return sum < 0;
}

void sc_step_stencil_find(uint32_t kind, const double start[4][3], const double end[4][3],
                          sc_step_stencil *s)
{
    const double t = s->time;
    double at[4][3], away[3];
    int i, k, began_apart;
    for (i = 0; i < 4; i++)
        for (k = 0; k < 3; k++) at[i][k] = (1 - t) * start[i][k] + t * end[i][k];
    find_at(kind, start, &s->start);
    find_at(kind, (const double(*)[3])at, &s->impact);
    s->side = find_side(kind, start);
    began_apart = find_direction(kind, start, &s->start, away);
    s->flags = approaches(&s->start, away, start, end) ? SC_STEP_APPROACHES : 0;
    if (find_direction(kind, (const double(*)[3])at, &s->impact, s->normal)) return;
    memcpy(s->normal, away, sizeof away);
    if (!began_apart && !find_normal_by_side(kind, start, s->side, s->normal))
        s->flags |= SC_STEP_NO_NORMAL;
}
