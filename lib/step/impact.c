/*
 * The narrow phase: see impact.h for what it promises.
 *
 * SPDX-License-Identifier: MIT
 *
 * The differences between a point of one and a point of the other are, at any time, the points of a
 * flat polygon: the triangle of the three differences between face and vertex, or the parallelogram
 * of the four differences between the ends of two edges. The distance of the two is that of the
 * polygon from the origin. Its corners move on straight lines, and it is in their hull, so all that
 * is asked of barycentric coordinates is answered for all of them at once, and only time has to be
 * searched.
 *
 * What proves that nothing is closer than a level throughout an interval of time (an inclusion):
 *   - a fixed direction n, |n| = 1, with n . p > level for all corners p at both ends, hence in
 *     between;
 *   - a direction that moves from m to n, with the three Bernstein coefficients of n(t) . p(t) >
 *     level for all corners. They are m . p, (m . q + n . p) / 2 and n . q, where p is the corner
 *     at the start of the interval, and q at its end; and |n(t)| <= 1.
 * The directions are those of the polygon's point next to the origin at the ends of the interval.
 * How well that is found decides about speed only: a bad direction proves nothing.
 *
 * The search goes from time 0 to 1 and always stands at a time before which all is proved. There it
 * looks for a point of the polygon that is near enough to be reported, which ends the search, so
 * that time is the answer. Else its direction proves the way to a later time (a step like
 * Newton's). Where that converges slowly, it splits what is ahead in halves, and tries to pass one
 * or two of them at once by a moving direction, a linear or quadratic function of time. Where
 * nothing gets on, because the points are nearer than rounding lets see a direction, a short slab
 * of time is proved by splitting the polygon into small ones. Most pairs that stay apart are proved
 * so by an axis or by the direction to the mean of the corners, before any of this.
 *
 * Thresholds. d is the separation, T the tolerance, M the largest coordinate of a corner at time 0
 * or 1.
 *   reported             if a point is computed at a distance <= d + T / 2 (3 T / 4 in a slab)
 *   proved to be apart   by directions with level d + T / 4 (d + T / 8 in a slab)
 * u is 2^-53. A computed corner at a time is off by at most 4 u M a coordinate (the differences at
 * both ends 1 each, 1 - t, two products and a sum), 7 u M in all; a scalar product with a direction
 * by at most 6 u M more, the direction's length by 4 u, of d <= 2 M; a convex combination by less
 * than 16 u M. So no comparison is wrong by more than 64 u M = 2^-47 M, and T / 16 is at least
 * 2^-36 M. Hence what is proved is apart by more than d, and what is reported is within d + T.
 *
 * Progress. A slab is so short that no point moves by more than T / 16 in it. A cell (a part of the
 * polygon) of a diameter below T / 16 is either near enough to be reported, or the direction of its
 * nearest point proves the slab, as nothing in it is farther from that point; so splitting ends
 * after at most 40 levels.
 */
#include "step/impact.h"

#include <float.h>
#include <math.h>
#include <stddef.h>

#include "base/assume.h"
#include "step/within.h"

enum {
    MAXIMUM_CORNERS = 4,
    MAXIMUM_GUARDS = 32,
    CELL_LEVELS = 42,
    MAXIMUM_CELLS = 3 * CELL_LEVELS + 2
};

/* Sizes beyond which products of four coordinates are not relied upon. */
#define LARGE 0x1p100
#define SMALL 0x1p-100

/* Pairs that have to be multiplied by more than this are too small for tolerances in doubles. */
#define TINY_SCALE 0x1p900

/* The least square of a vector's length that is relied upon. */
#define LEAST_SQUARE 0x1p-500

/* The polygon's corners at times 0 and 1, and the thresholds. */
typedef struct motion {
    double start[MAXIMUM_CORNERS][3], end[MAXIMUM_CORNERS][3];
    double separation, tolerance;
    double level;         /* proved to be apart */
    double reach;         /* reported */
    double before, after; /* lengths here are those of the caller times both: powers of two */
} motion;

/* The polygon at a time, and its direction from the origin, if they are more than reach apart. */
typedef struct instant {
    double time;
    double corners[MAXIMUM_CORNERS][3];
    double direction[3];
    double distance;
    int is_apart;
} instant;

static inline double inner(const double *a, const double *b)
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline void outer(double *n, const double *a, const double *b)
{
    n[0] = a[1] * b[2] - a[2] * b[1];
    n[1] = a[2] * b[0] - a[0] * b[2];
    n[2] = a[0] * b[1] - a[1] * b[0];
}

static inline void take_off(double *d, const double *a, const double *b)
{
    for (int k = 0; k < 3; ++k) d[k] = a[k] - b[k];
}

/* a + s (b - a), a little more exact than that at s = 1. */
static inline void between(double *p, const double *a, const double *b, double s)
{
    for (int k = 0; k < 3; ++k) p[k] = (1 - s) * a[k] + s * b[k];
}

/*
 * The point of the polygon next to the origin, but for rounding, and a direction in which the
 * polygon is as far away, of any length. Returns the square of the point's distance. The point is a
 * convex combination of the corners.
 */
static inline double find_nearest(int count, double corners[][3], double *nearest,
                                  double *direction)
{
    double square = HUGE_VAL, n[3], u[3], v[3], areas[MAXIMUM_CORNERS];
    int is_inside = 1;
    for (int i = 0; i < count; ++i) {
        const double *a = corners[i], *b = corners[i + 1 < count ? i + 1 : 0];
        double edge[3], p[3], length, s, p_square;
        take_off(edge, b, a);
        length = inner(edge, edge);
        s = -inner(a, edge);
        s = !(s > 0) ? 0 : s >= length ? 1 : s / length;
        between(p, a, b, s);
        p_square = inner(p, p);
        if (p_square < square) {
            square = p_square;
            for (int k = 0; k < 3; ++k) nearest[k] = p[k];
        }
    }
    for (int k = 0; k < 3; ++k) direction[k] = nearest[k];
    take_off(u, corners[1], corners[0]);
    take_off(v, corners[count - 1], corners[0]);
    outer(n, u, v);
    for (int i = 0; i < count; ++i) {
        double c[3];
        outer(c, corners[i], corners[i + 1 < count ? i + 1 : 0]);
        areas[i] = inner(n, c);
        is_inside &= areas[i] > 0;
    }
    if (is_inside && inner(n, n) >= LEAST_SQUARE) {
        double p[3], p_square;
        if (count == 3) {
            double sum = areas[0] + areas[1] + areas[2];
            for (int k = 0; k < 3; ++k)
                p[k] = areas[1] / sum * corners[0][k] + areas[2] / sum * corners[1][k] +
                       areas[0] / sum * corners[2][k];
        } else {
            double s = areas[3] / (areas[3] + areas[1]), t = areas[0] / (areas[0] + areas[2]);
            double a[3], b[3];
            between(a, corners[0], corners[1], s);
            between(b, corners[3], corners[2], s);
            between(p, a, b, t);
        }
        p_square = inner(p, p);
        if (p_square < square) {
            double sign = inner(n, corners[0]) < 0 ? -1 : 1;
            square = p_square;
            for (int k = 0; k < 3; ++k) {
                nearest[k] = p[k];
                direction[k] = sign * n[k];
            }
        }
    }
    return square;
}

/* How far away the polygon is at least in a direction of length 1. */
static inline double least_along(int count, double corners[][3], const double *direction)
{
    double least = inner(corners[0], direction);
    for (int i = 1; i < count; ++i) {
        double d = inner(corners[i], direction);
        if (d < least) least = d;
    }
    return least;
}

/* Takes what direction has along a side away from it; direction and side are not 0 in length. */
static inline void turn_away(double *direction, const double *side)
{
    double s = inner(direction, side) / inner(side, side);
    for (int k = 0; k < 3; ++k) direction[k] -= s * side[k];
}

/*
 * Tries directions that are at right angles to a side, or to all of them, more exactly than that
 * from the nearest point is where that is near the origin: there this is known up to u M / distance
 * only, and moves corners at M by that much. Such a direction is the best one if the nearest point
 * is inside a side or inside the polygon, and nearly so if it is a corner and a side there is
 * nearly at right angles. Which side of the plane the origin is on is told by a corner: the nearest
 * point in a polygon almost without width may be wrong by that width.
 */
static void improve_direction(int count, instant *at, double *least)
{
    double sides[MAXIMUM_CORNERS][3] = {{0}}, longest = 0;
    int is_longest = 0;
    for (int i = 0; i < count; ++i) {
        double length;
        take_off(sides[i], at->corners[i + 1 < count ? i + 1 : 0], at->corners[i]);
        length = inner(sides[i], sides[i]);
        if (length > longest) {
            longest = length;
            is_longest = i;
        }
    }
    if (SC_NEVER(longest == 0)) return; /* to a point its direction is as good as any */
    for (int i = 0; i <= count; ++i) {
        double d[3], length, found;
        if (i < count) {
            if (inner(sides[i], sides[i]) == 0) continue;
            for (int k = 0; k < 3; ++k) d[k] = at->direction[k];
            turn_away(d, sides[i]);
            turn_away(d, sides[i]);
        } else {
            outer(d, sides[0], sides[count - 1]);
            turn_away(d, sides[is_longest]);
            if (inner(d, at->corners[0]) < 0)
                for (int k = 0; k < 3; ++k) d[k] = -d[k];
        }
        length = inner(d, d);
        if (!(length >= LEAST_SQUARE)) continue;
        length = sqrt(length);
        for (int k = 0; k < 3; ++k) d[k] /= length;
        found = least_along(count, at->corners, d);
        if (found > *least) {
            *least = found;
            for (int k = 0; k < 3; ++k) at->direction[k] = d[k];
        }
    }
}

static inline void look(int count, const motion *m, double time, instant *at)
{
    double nearest[3] = {0, 0, 0}, direction[3], length, least;
    at->time = time;
    for (int i = 0; i < count; ++i) between(at->corners[i], m->start[i], m->end[i], time);
    at->distance = sqrt(find_nearest(count, at->corners, nearest, direction));
    at->is_apart = at->distance > m->reach;
    if (!at->is_apart) return;
    length = sqrt(inner(direction, direction));
    for (int k = 0; k < 3; ++k) at->direction[k] = direction[k] / length;
    least = least_along(count, at->corners, at->direction);
    if (least < at->distance - 0.125 * (at->distance - m->separation))
        improve_direction(count, at, &least);
}

/* The time until which the direction at a proves what comes; to's time if it proves all until
   then. */
static inline double advance(int count, const motion *m, const instant *a, const instant *to)
{
    double part = 1;
    for (int i = 0; i < count; ++i) {
        double at_start = inner(a->direction, a->corners[i]),
               at_end = inner(a->direction, to->corners[i]);
        double s = at_start <= m->level ? 0
                   : at_end >= m->level ? 1
                                        : (at_start - m->level) / (at_start - at_end);
        if (s < part) part = s;
    }
    return part == 1 ? to->time : a->time + part * (to->time - a->time);
}

/* Whether a direction that moves from that at a to that at b, proves all between them. */
static inline int is_passed(int count, const motion *m, const instant *a, const instant *b)
{
    int passed = 1;
    for (int i = 0; i < count; ++i) {
        passed &= inner(a->direction, a->corners[i]) >= m->level;
        passed &= 0.5 * (inner(a->direction, b->corners[i]) + inner(b->direction, a->corners[i])) >=
                  m->level;
        passed &= inner(b->direction, b->corners[i]) >= m->level;
    }
    return passed;
}

/*
 * The same with a direction that is a quadratic function of time and is that at a, at middle
 * halfway, and at b. It follows a turning polygon by one order more. Its Bernstein coefficients are
 * those at the ends and c; its length is bounded by those of its square, and the products with
 * corners have four.
 */
static inline int is_passed_bent(int count, const motion *m, const instant *a,
                                 const instant *middle, const instant *b)
{
    double c[3], lengths[5], longest = 0;
    for (int k = 0; k < 3; ++k)
        c[k] = 2 * middle->direction[k] - 0.5 * (a->direction[k] + b->direction[k]);
    lengths[0] = inner(a->direction, a->direction);
    lengths[1] = inner(a->direction, c);
    lengths[2] = (2 * inner(c, c) + inner(a->direction, b->direction)) / 3;
    lengths[3] = inner(c, b->direction);
    lengths[4] = inner(b->direction, b->direction);
    for (int i = 0; i < 5; ++i) longest = lengths[i] > longest ? lengths[i] : longest;
    longest = m->level * sqrt(longest);
    for (int i = 0; i < count; ++i) {
        const double *p = a->corners[i], *q = b->corners[i];
        if (!(inner(a->direction, p) >= longest) ||
            !(2 * inner(c, p) + inner(a->direction, q) >= 3 * longest) ||
            !(2 * inner(c, q) + inner(b->direction, p) >= 3 * longest) ||
            !(inner(b->direction, q) >= longest))
            return 0;
    }
    return 1;
}

/* Whether the direction at b proves all from a time on. */
static inline int is_proved_from(int count, const motion *m, double time, const instant *b)
{
    for (int i = 0; i < count; ++i) {
        double p[3];
        between(p, m->start[i], m->end[i], time);
        if (!(inner(b->direction, p) >= m->level) ||
            !(inner(b->direction, b->corners[i]) >= m->level))
            return 0;
    }
    return 1;
}

/* A time in which no corner moves by more than a sixteenth of the tolerance. */
static double slab_length(int count, const motion *m)
{
    double most = 0;
    for (int i = 0; i < count; ++i) {
        for (int k = 0; k < 3; ++k) {
            double d = fabs(m->end[i][k] - m->start[i][k]);
            if (d > most) most = d;
        }
    }
    return most > m->tolerance ? m->tolerance / (32 * most) : 1.0 / 32;
}

/* A part of the polygon: three points first + x (second - first) + y (last - first). */
typedef struct cell {
    double x[3], y[3];
} cell;

static void place_in_polygon(double *p, double x, double y, int count, double corners[][3])
{
    for (int k = 0; k < 3; ++k)
        p[k] = corners[0][k] + x * (corners[1][k] - corners[0][k]) +
               y * (corners[count - 1][k] - corners[0][k]);
}

/*
 * Whether the polygon comes near enough to be reported at the start of a slab of time, by splitting
 * it into cells. If not, nothing is within the separation from the start to the end of the slab.
 * But it does: were it farther away than that, its direction would have proved the slab, unless all
 * that improve_direction tries were bad.
 */
static int is_near_in_slab(int count, const motion *m, double from, double to)
{
    double level = m->separation + m->tolerance / 8, reach = m->separation + m->tolerance * 3 / 4;
    double before[MAXIMUM_CORNERS][3] = {{0}}, after[MAXIMUM_CORNERS][3] = {{0}};
    cell cells[MAXIMUM_CELLS];
    int left = 0;
    for (int i = 0; i < count; ++i) {
        between(before[i], m->start[i], m->end[i], from);
        between(after[i], m->start[i], m->end[i], to);
    }
    cells[left++] = (cell){{0, 1, 0}, {0, 0, 1}};
    if (count == 4) cells[left++] = (cell){{1, 1, 0}, {1, 0, 1}};
    while (!SC_HARDLY(left == 0)) {
        cell c = cells[--left], mid;
        double p[3][3], nearest[3] = {0, 0, 0}, direction[3], distance;
        int is_apart = 1;
        for (int i = 0; i < 3; ++i) place_in_polygon(p[i], c.x[i], c.y[i], count, before);
        distance = sqrt(find_nearest(3, p, nearest, direction));
        if (distance <= reach) return 1;
        for (int i = 0; i < 3; ++i) {
            double q[3];
            place_in_polygon(q, c.x[i], c.y[i], count, after);
            is_apart &= inner(nearest, p[i]) >= level * distance;
            is_apart &= inner(nearest, q) >= level * distance;
        }
        if (is_apart) continue;
        if (SC_NEVER(left + 4 > MAXIMUM_CELLS)) return 1; /* see "Progress" */
        for (int i = 0; i < 3; ++i) {
            mid.x[i] = 0.5 * (c.x[(i + 1) % 3] + c.x[(i + 2) % 3]);
            mid.y[i] = 0.5 * (c.y[(i + 1) % 3] + c.y[(i + 2) % 3]);
        }
        cells[left++] = mid;
        for (int i = 0; i < 3; ++i) {
            cell corner = mid;
            corner.x[i] = c.x[i];
            corner.y[i] = c.y[i];
            cells[left++] = corner;
        }
    }
    return 0;
}

/* Whether the corners stay on one side along an axis. */
static inline int is_apart_on_an_axis(int count, const motion *m)
{
    for (int k = 0; k < 3; ++k) {
        double low = m->start[0][k], high = low;
        for (int i = 0; i < count; ++i) {
            double a = m->start[i][k], b = m->end[i][k];
            low = a < low ? a : low;
            low = b < low ? b : low;
            high = a > high ? a : high;
            high = b > high ? b : high;
        }
        if (low >= m->level || high <= -m->level) return 1;
    }
    return 0;
}

/* Whether the direction to the mean of all corners proves the whole step. */
static inline int is_apart_from_mean(int count, const motion *m)
{
    double mean[3] = {0, 0, 0}, least = HUGE_VAL, square;
    for (int i = 0; i < count; ++i) {
        for (int k = 0; k < 3; ++k) mean[k] += m->start[i][k] + m->end[i][k];
    }
    for (int i = 0; i < count; ++i) {
        double a = inner(mean, m->start[i]), b = inner(mean, m->end[i]);
        least = a < least ? a : least;
        least = b < least ? b : least;
    }
    square = inner(mean, mean);
    return least > 0 && square >= LEAST_SQUARE && least * least >= m->level * m->level * square;
}

/* The search: 1 and the time, or 0. */
static inline int search(int count, const motion *m, double latest, double *time)
{
    instant here, guards[MAXIMUM_GUARDS];
    double slab = 0;
    int top = 0, is_looked_at = 0, is_near;
    look(count, m, 0, &here);
    if (!here.is_apart) {
        *time = 0;
        return 1;
    }
    guards[0].time = 1;
    for (int i = 0; i < count; ++i) {
        for (int k = 0; k < 3; ++k) guards[0].corners[i][k] = m->end[i][k];
    }
    for (;;) {
        instant *ahead = &guards[top], next;
        double until = advance(count, m, &here, ahead);
        if (until == 1) return 0;
        if (!is_looked_at) {
            slab = slab_length(count, m);
            if (until > latest && until >= here.time + slab) return 0;
            look(count, m, 1, &guards[0]);
            is_looked_at = 1;
        }
        if (until == ahead->time || (ahead->is_apart && (is_proved_from(count, m, until, ahead) ||
                                                         is_passed(count, m, &here, ahead)))) {
            if (ahead->time == 1) return 0; /* where it is apart */
            here = *ahead;
            if (here.time > latest) return 0;
            if (!here.is_apart) {
                *time = here.time;
                return 1;
            }
            --top;
            continue;
        }
        if (until < here.time + slab) {
            until = here.time + slab < ahead->time ? here.time + slab : ahead->time;
            is_near = is_near_in_slab(count, m, here.time, until);
            if (!SC_HARDLY(!is_near)) {
                *time = here.time;
                return 1;
            }
            if (until == 1) return 0;
        }
        if (until > latest) return 0;
        look(count, m, until, &next);
        if (!next.is_apart) {
            *time = until;
            return 1;
        }
        if (next.distance - m->level > 0.5 * (here.distance - m->level) &&
            top + 1 < MAXIMUM_GUARDS && ahead->time - until > 4 * slab) {
            look(count, m, 0.5 * (until + ahead->time), &guards[++top]);
            if (ahead->is_apart && guards[top].is_apart &&
                is_passed_bent(count, m, &next, &guards[top], ahead)) {
                if (ahead->time == 1) return 0;
                next = *ahead;
                top -= 2;
                if (next.time > latest) return 0;
            }
        }
        here = next; /* before all guards, but if is_near_in_slab let it pass */
        while (top > 0 && SC_HARDLY(guards[top].time <= here.time)) --top;
    }
}

/* Writes the polygon down, (q before - p before) after for each pair of points; returns its largest
   coordinate. */
static inline double write_corners(int count, const double start[4][3], const double end[4][3],
                                   double before, double after, motion *m)
{
    static const unsigned char from[2][4] = {{0, 0, 0, 0}, {0, 1, 1, 0}};
    static const unsigned char to[2][4] = {{1, 2, 3, 0}, {2, 2, 3, 3}};
    double size = 0;
    for (int i = 0; i < count; ++i) {
        int p = from[count - 3][i], q = to[count - 3][i];
        for (int k = 0; k < 3; ++k) {
            double a = (before * start[q][k] - before * start[p][k]) * after;
            double b = (before * end[q][k] - before * end[p][k]) * after;
            m->start[i][k] = a;
            m->end[i][k] = b;
            a = fabs(a);
            b = fabs(b);
            size = a > size ? a : size;
            size = b > size ? b : size;
        }
    }
    return size;
}

/* 0: the two touch all the time, or the separation is more than any distance of theirs. */
static inline int read_motion(int count, const double start[4][3], const double end[4][3],
                              const sc_impact_limits *limits, motion *m)
{
    double before = 1, after = 1, size = write_corners(count, start, end, 1, 1, m);
    if (size == 0) return 0;
    if (!(size <= LARGE && size >= SMALL)) {
        int exponent;
        if (size > LARGE) before = 0x1p-4;
        size = write_corners(count, start, end, before, 1, m);
        frexp(size, &exponent);
        after = ldexp(1, exponent < -1000 ? 1000 : -exponent);
        size = write_corners(count, start, end, before, after, m);
    }
    m->before = before;
    m->after = after;
    m->separation = limits->separation * before * after;
    m->tolerance = limits->tolerance * before * after;
    if (m->separation > 2 * size) return 0;
    if (!(m->tolerance > SC_IMPACT_FLOOR * size)) m->tolerance = SC_IMPACT_FLOOR * size;
    m->level = m->separation + 0.25 * m->tolerance;
    m->reach = m->separation + 0.5 * m->tolerance;
    return 1;
}

int sc_impact_vertex_face(const double start[4][3], const double end[4][3],
                          const sc_impact_limits *limits, double *time)
{
    motion m;
    *time = 0;
    if (!read_motion(3, start, end, limits, &m)) return 1;
    *time = 1;
    return !is_apart_on_an_axis(3, &m) && !is_apart_from_mean(3, &m) &&
           search(3, &m, limits->latest, time);
}

int sc_impact_edge_edge(const double start[4][3], const double end[4][3],
                        const sc_impact_limits *limits, double *time)
{
    motion m;
    *time = 0;
    if (!read_motion(4, start, end, limits, &m)) return 1;
    *time = 1;
    return !is_apart_on_an_axis(4, &m) && !is_apart_from_mean(4, &m) &&
           search(4, &m, limits->latest, time);
}

/*
 * D, the distance at the start, is first that of the nearest point found. This is of the polygon,
 * so D is not below the distance by more than T / 16 (see "Thresholds"). But it may be far above it
 * where the polygon is almost without width. So halving by exact comparisons takes it down until
 * what is less by 9 T / 16 is proved to be less than the distance: T is at least 2^-32 of the size,
 * so about 35 of them are enough; nearly always one is.
 */
double sc_impact_nearer(int is_edges, const double start[4][3], const double end[4][3],
                        const sc_impact_limits *limits)
{
    const int count = is_edges ? 4 : 3;
    sc_impact_limits touching = *limits;
    double nearest[3] = {0, 0, 0}, direction[3], low = 0, high, next;
    motion m;
    touching.separation = 0;
    if (!read_motion(count, start, end, &touching, &m) || m.after > TINY_SCALE) return 0;
    high = sqrt(find_nearest(count, m.start, nearest, direction));
    next = high - 0.5 * m.tolerance;
    while (high > 2 * m.tolerance && high - low > 0.5625 * m.tolerance) {
        double length = next / m.after / m.before;
        if (length <= DBL_MAX &&
            (is_edges ? sc_within_edge_edge(start, length) : sc_within_vertex_face(start, length)))
            high = next;
        else
            low = next;
        next = 0.5 * (low + high);
    }
    high = (high - 2 * m.tolerance) / m.after / m.before;
    return !(high > 0) ? 0 : high < limits->separation ? high : limits->separation;
}

double sc_impact_thickness(const sc_impact_limits *limits, double extent)
{
    double least = SC_IMPACT_FLOOR * (extent < 0x1p1023 ? extent : 0x1p1023) * 2;
    double tolerance = limits->tolerance > least ? limits->tolerance : least;
    return (limits->separation + tolerance) * (1 + 0x1p-50);
}
