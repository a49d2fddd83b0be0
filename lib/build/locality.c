/*
 * Renumbering along a space-filling curve. See locality.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "build/locality.h"

#include <math.h>
#include <string.h>

#include "base/atomic.h"
#include "base/jobs.h"
#include "base/sort.h"

/* Triangles and points of the shortest part of a loop. */
enum { ALONG_TRIANGLES_MIN = 5000, ALONG_POINTS_MIN = 5000 };

/* Cells along each axis: 2 to the power of this. */
enum { CELL_BITS = 10 };

/* The bits of a cell number, two zeros between each two. */
static uint32_t spread(uint32_t cell)
{
    cell = (cell | cell << 16) & 0x030000ffu;
    cell = (cell | cell << 8) & 0x0300f00fu;
    cell = (cell | cell << 4) & 0x030c30c3u;
    return (cell | cell << 2) & 0x09249249u;
}

/*
 * Turns a cell into the one in whose place along the Z-shaped curve it comes along Hilbert's. J.
 * Skilling, "Programming the Hilbert curve", 2004: from the halves of the box down, what lies in
 * the upper half of an axis is mirrored along the first axis, and what lies in the lower half has
 * that axis exchanged with the first; then the bits of each level, as a Gray code, are its place
 * among eight. Without branches, which no processor could foresee.
 */
static void turn_to_hilbert(uint32_t cell[3])
{
    uint32_t half, k, x = cell[0], flip;
    for (half = 1u << (CELL_BITS - 1); half > 1; half >>= 1) {
        uint32_t below = half - 1;
        x ^= below & (0u - ((x & half) != 0));
        for (k = 1; k < 3; k++) {
            uint32_t upper = 0u - ((cell[k] & half) != 0); /* all ones in the upper half */
            flip = (x ^ cell[k]) & below & ~upper;
            x ^= flip | (below & upper);
            cell[k] ^= flip;
        }
    }
    cell[1] ^= x;
    cell[2] ^= cell[1];
    for (flip = 0, half = 1u << (CELL_BITS - 1); half > 1; half >>= 1)
        flip ^= (half - 1) & (0u - ((cell[2] & half) != 0));
    cell[0] = cell[2] ^ flip; /* the first axis weighs most */
    cell[2] = x ^ flip;
    cell[1] ^= flip;
}

/* What is done to the points, in parts. */
typedef struct renumbering {
    sc_points *points;
    int curve;
    double low[SC_JOBS_PARTS][3], high[SC_JOBS_PARTS][3]; /* of each part: eighths of coordinates */
    double factor;                                        /* see measure_box */
    sc_pair *keys;
    uint32_t *triangles;            /* in the order of the keys */
    double *rest;                   /* of points in their new order */
    uint8_t *owner;                 /* the first part that uses a point; 0 if there is one */
    uint32_t *number;               /* of each point among its owner's, or SC_NONE */
    uint32_t before[SC_JOBS_PARTS]; /* how many points each part owns; then all before it */
} renumbering;

static void measure_some(void *context, uint32_t part, uint32_t first, uint32_t end)
{
    renumbering *n = (renumbering *)context;
    double low[3], high[3];
    uint64_t i;
    int k;
    for (k = 0; k < 3; k++) low[k] = HUGE_VAL, high[k] = -HUGE_VAL;
    for (i = first; i < end; i++)
        for (k = 0; k < 3; k++) {
            double x = n->points->rest[3 * i + (uint64_t)k] / 8;
            if (x < low[k]) low[k] = x;
            if (x > high[k]) high[k] = x;
        }
    memcpy(n->low[part], low, sizeof low);
    memcpy(n->high[part], high, sizeof high);
}

/* low[0] and factor of each axis: a center c is in cell (c - low) * factor. Eighths of coordinates,
   so that nothing overflows. */
static void measure_box(renumbering *n, const sc_tasks *tasks)
{
    uint32_t parts = sc_jobs_loop(tasks, n->points->point_count, ALONG_POINTS_MIN, measure_some, n),
             part;
    double *low = n->low[0], *high = n->high[0], size = 0;
    int k;
    for (part = 1; part < parts; part++)
        for (k = 0; k < 3; k++) {
            if (n->low[part][k] < low[k]) low[k] = n->low[part][k];
            if (n->high[part][k] > high[k]) high[k] = n->high[part][k];
        }
    for (k = 0; k < 3; k++) {
        if (high[k] - low[k] > size) size = high[k] - low[k];
        low[k] *= 3;
    }
    n->factor = (1 << CELL_BITS) / (3 * size);
}

static void list_keys(void *context, uint32_t part, uint32_t first, uint32_t end)
{
    const renumbering *n = (const renumbering *)context;
    const sc_points *points = n->points;
    const double factor = n->factor;
    uint32_t t, k;
    (void)part;
    for (t = first; t < end; t++) {
        const uint32_t *corner = points->triangles + 3 * (uint64_t)t;
        const double *p = points->rest + 3 * (uint64_t)corner[0];
        const double *q = points->rest + 3 * (uint64_t)corner[1];
        const double *r = points->rest + 3 * (uint64_t)corner[2];
        uint32_t cell[3];
        for (k = 0; k < 3; k++) {
            double at = (p[k] / 8 + q[k] / 8 + r[k] / 8 - n->low[0][k]) * factor;
            cell[k] = 0; /* as well if at is NaN: a mesh as small as rounding */
            if (at > 0) cell[k] = at < (1 << CELL_BITS) - 1 ? (uint32_t)at : (1 << CELL_BITS) - 1;
        }
        if (n->curve == SC_LOCALITY_HILBERT) turn_to_hilbert(cell);
        n->keys[t].a = spread(cell[0]) | spread(cell[1]) << 1 | spread(cell[2]) << 2;
        n->keys[t].b = t;
    }
}

/* Puts triangles in the order of the keys, and marks whose their points are. */
static void gather_triangles(void *context, uint32_t part, uint32_t first, uint32_t end)
{
    const renumbering *n = (const renumbering *)context;
    uint32_t *corner = n->triangles + 3 * (uint64_t)first, t, k;
    for (t = first; t < end; t++, corner += 3) {
        const uint32_t *from = n->points->triangles + 3 * (uint64_t)n->keys[t].b;
        for (k = 0; k < 3; k++) {
            corner[k] = from[k];
            sc_atomic_lessen_byte(&n->owner[from[k]], (uint8_t)part);
        }
        n->points->id[t] = n->keys[t].b;
    }
}

/* Numbers the points that a part owns, in the order in which it uses them. */
static void number_own(void *context, uint32_t part, uint32_t first, uint32_t end)
{
    renumbering *n = (renumbering *)context;
    const uint32_t *p = n->triangles + 3 * (uint64_t)first;
    const uint32_t *last = n->triangles + 3 * (uint64_t)end;
    uint32_t next = 0;
    for (; p < last; p++)
        if (n->owner[*p] == part && n->number[*p] == SC_NONE) n->number[*p] = next++;
    n->before[part] = next;
}

static uint32_t new_number(const renumbering *n, uint32_t point)
{
    return n->before[n->owner[point]] + n->number[point];
}

static void name_anew(void *context, uint32_t part, uint32_t first, uint32_t end)
{
    const renumbering *n = (const renumbering *)context;
    uint32_t *p = n->triangles + 3 * (uint64_t)first;
    const uint32_t *last = n->triangles + 3 * (uint64_t)end;
    (void)part;
    for (; p < last; p++) *p = new_number(n, *p);
}

static void move_points(void *context, uint32_t part, uint32_t first, uint32_t end)
{
    const renumbering *n = (const renumbering *)context;
    uint32_t p;
    (void)part;
    for (p = first; p < end; p++) {
        const double *from = n->points->rest + 3 * (uint64_t)p;
        double *to = n->rest + 3 * (uint64_t)new_number(n, p);
        to[0] = from[0];
        to[1] = from[1];
        to[2] = from[2];
    }
}

static void renumber_slots(void *context, uint32_t part, uint32_t first, uint32_t end)
{
    const renumbering *n = (const renumbering *)context;
    uint32_t *slot = n->points->slot, v;
    (void)part;
    for (v = first; v < end; v++)
        if (slot[v] < SC_SLOT_WELDED) slot[v] = new_number(n, slot[v]);
}

/* Numbers points in the order in which triangles first use them: those of which a part is the first
   to use them come after those of all parts before it. */
static void renumber_along(renumbering *n, const sc_tasks *tasks)
{
    sc_points *points = n->points;
    uint32_t part, parts, sum = 0;
    parts = sc_jobs_loop(tasks, points->triangle_count, ALONG_TRIANGLES_MIN, gather_triangles, n);
    n->number = points->triangles; /* which have been read; each point is in one */
    memset(n->number, 0xff, points->point_count * sizeof *n->number);
    sc_jobs_loop(tasks, points->triangle_count, ALONG_TRIANGLES_MIN, number_own, n);
    for (part = 0; part < parts; part++) {
        uint32_t own = n->before[part];
        n->before[part] = sum;
        sum += own;
    }
    sc_jobs_loop(tasks, points->triangle_count, ALONG_TRIANGLES_MIN, name_anew, n);
    sc_jobs_loop(tasks, points->point_count, ALONG_POINTS_MIN, move_points, n);
    sc_jobs_loop(tasks, points->vertex_count, ALONG_POINTS_MIN, renumber_slots, n);
}

sc_status sc_locality_sort(sc_points *points, int curve, sc_scratch *scratch)
{
    const sc_tasks *tasks = scratch->tasks;
    uint32_t count = points->triangle_count, *room = NULL;
    sc_pair *keys, *spare;
    renumbering n;
    n.points = points;
    n.curve = curve;
    n.triangles = (uint32_t *)sc_scratch_take(scratch, 3 * (uint64_t)count, sizeof(uint32_t));
    keys = (sc_pair *)sc_scratch_take(scratch, count, sizeof *keys);
    if (tasks)
        room = (uint32_t *)sc_scratch_take(scratch, sc_sort_digits_room(count), sizeof *room);
    if (!keys || !n.triangles || (tasks && !room)) return SC_ERROR_MEMORY;
    spare = (sc_pair *)(void *)n.triangles; /* until keys are sorted: by three passes, into keys */
    n.keys = spare;
    measure_box(&n, tasks);
    sc_jobs_loop(tasks, count, ALONG_TRIANGLES_MIN, list_keys, &n);
    n.keys = sc_sort_by_digits(spare, keys, count, 3 * CELL_BITS, tasks, room);
    sc_scratch_give(scratch, room);
    n.rest = (double *)sc_scratch_take(scratch, 3 * (uint64_t)points->point_count, sizeof(double));
    n.owner = (uint8_t *)sc_scratch_take_filled(scratch, points->point_count, 1,
                                                tasks ? SC_JOBS_PARTS : 0);
    if (!n.rest || !n.owner) return SC_ERROR_MEMORY;
    renumber_along(&n, tasks);
    sc_scratch_give(scratch, keys);
    sc_scratch_give(scratch, n.owner);
    sc_scratch_give(scratch, points->triangles);
    sc_scratch_give(scratch, points->rest);
    points->triangles = n.triangles;
    points->rest = n.rest;
    return SC_OK;
}
