/*
 * Depths of places; see place_depth.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "place_depth.h"

#include "task_loop.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* How many triangles are looked at for distances, in all. */
#define DISTANCES_MAX 50000000u

/* How far outside of a vertex its surroundings are asked about, in lengths of edges round it. */
#define OFFSET 1e-4

/* A triangle in more cells than this is kept apart. */
enum { CELLS_MAX = 64 };

enum { REGION_UNKNOWN = 0, REGION_EXPOSED = 1, REGION_BURIED = 2 };

/* Items by the wanted cells of the grid that they reach over. Those of a cell are from starts[cell]
   up to starts[cell + 1]; those that reach over very many come behind the last cell. */
typedef struct cell_lists {
    uint32_t *starts, *items;
} cell_lists;

/* A grid of square cells in x and y. */
typedef struct grid {
    double low[2], cell; /* the lower corner; the side of a cell */
    size_t side[2];      /* how many cells */
    size_t large;        /* the cell behind the last */
    uint8_t *wanted;     /* of each cell: whether it will be looked at */
    cell_lists surface;  /* triangles that bound an inside */
    cell_lists segments; /* where pairs meet: numbers in place_list.segments */
} grid;

typedef struct depths {
    const place_source *from;
    const place_list *places;
    double *at;         /* 3 of each vertex */
    double *normals;    /* 3 of each vertex, outwards, if asked; twice the area round it long */
    int8_t *sign;       /* of each part: 1 outward, -1 inward, 0 it has no inside */
    uint32_t *regions;  /* of each vertex, as sets */
    uint32_t *chosen;   /* of each region, at the vertex that tells it: one to ask about */
    uint8_t *asked;     /* of each vertex: whether its normal is wanted */
    uint8_t *colliding; /* of each triangle */
    uint8_t *entered;   /* of each triangle: whether it is in a list of cells */
    uint8_t *state;     /* of each region: REGION_... */
    uint32_t *members, *starts; /* vertices by regions */
    double *depth;              /* of each region, negative: not looked at */
    grid cells;
    bool has_grid; /* whether there was memory for it, and its size is one */
    uint64_t looked_at;
} depths;

static uint32_t vertex_of(const depths *d, size_t triangle, size_t k)
{
    const uint32_t v = d->from->mesh->indices[3 * triangle + k];
    return d->from->weld_map ? d->from->weld_map[v] : v;
}

static int sign_of(const depths *d, size_t triangle)
{
    return d->sign[d->from->check->part_of_triangle[triangle]];
}

/* The region of a corner of a triangle of a place, by the number of the corner there. */
static uint32_t region_at(const depths *d, const place *one, uint32_t corner)
{
    return d->regions[vertex_of(d, d->places->triangles[one->begin + corner / 3], corner % 3)];
}

/* ------------------------------------------------------------------------------------------------
 * The surface
 */

static void cross_sides(const double *a, const double *b, const double *c, double out[3])
{
    double u[3], v[3];
    for (int k = 0; k < 3; k++) {
        u[k] = b[k] - a[k];
        v[k] = c[k] - a[k];
    }
    out[0] = u[1] * v[2] - u[2] * v[1];
    out[1] = u[2] * v[0] - u[0] * v[2];
    out[2] = u[0] * v[1] - u[1] * v[0];
}

/* Which parts have an inside, and on which side of their triangles: by their signed volumes. */
static bool find_signs(depths *d)
{
    const mesh_check *check = d->from->check;
    double *volumes = (double *)calloc((size_t)check->part_count + 1, sizeof *volumes);
    d->sign = (int8_t *)calloc((size_t)check->part_count + 1, 1);
    if (!volumes || !d->sign) {
        free(volumes);
        return false;
    }
    for (size_t t = 0; t < d->from->mesh->triangle_count; t++) {
        const uint32_t part = check->part_of_triangle[t];
        const double *origin = d->at + 3 * (size_t)vertex_of(d, check->parts[part].first, 0);
        const double *a = d->at + 3 * (size_t)vertex_of(d, t, 0);
        double normal[3];
        cross_sides(a, d->at + 3 * (size_t)vertex_of(d, t, 1),
                    d->at + 3 * (size_t)vertex_of(d, t, 2), normal);
        for (int k = 0; k < 3; k++) volumes[part] += normal[k] * (a[k] - origin[k]);
    }
    for (uint32_t i = 0; i < check->part_count; i++) {
        if (mesh_part_is_closed(&check->parts[i]) && check->parts[i].misoriented_edges == 0)
            d->sign[i] = (int8_t)(volumes[i] > 0 ? 1 : volumes[i] < 0 ? -1 : 0);
    }
    free(volumes);
    return true;
}

/* Those of the vertices that ask_regions asks about. */
static void find_normals(depths *d)
{
    for (uint32_t i = 0; i < d->places->count; i++) {
        const place *one = &d->places->places[i];
        for (uint32_t k = 0; k < 3 * one->triangle_count; k++)
            d->asked[d->chosen[region_at(d, one, k)]] = 1;
    }
    for (size_t t = 0; t < d->from->mesh->triangle_count; t++) {
        const double *p[3];
        double normal[3];
        bool asked = false;
        for (size_t k = 0; k < 3; k++) asked |= d->asked[vertex_of(d, t, k)];
        if (!asked) continue;
        for (size_t k = 0; k < 3; k++) p[k] = d->at + 3 * (size_t)vertex_of(d, t, k);
        cross_sides(p[0], p[1], p[2], normal);
        for (size_t k = 0; k < 3; k++) {
            double *sum = d->normals + 3 * (size_t)vertex_of(d, t, k);
            for (size_t i = 0; i < 3; i++) sum[i] += sign_of(d, t) * normal[i];
        }
    }
}

/* Regions, and a vertex of each to ask about: if there is one, a vertex none of whose triangles
   collide. */
static void find_regions(depths *d)
{
    const mesh_file *mesh = d->from->mesh;
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        d->regions[v] = v;
        d->chosen[v] = SC_NONE;
    }
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        if (d->colliding[t]) continue;
        mesh_sets_join(d->regions, vertex_of(d, t, 0), vertex_of(d, t, 1));
        mesh_sets_join(d->regions, vertex_of(d, t, 0), vertex_of(d, t, 2));
    }
    for (size_t t = 0; t < mesh->triangle_count; t++) { /* mark vertices of colliding triangles */
        for (size_t k = 0; k < 3 && d->colliding[t]; k++) d->depth[vertex_of(d, t, k)] = 1;
    }
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        uint32_t *chosen = &d->chosen[mesh_sets_find(d->regions, v)];
        if (*chosen == SC_NONE || (d->depth[*chosen] > 0 && d->depth[v] <= 0)) *chosen = v;
    }
    for (size_t v = 0; v < mesh->vertex_count; v++) d->depth[v] = -1;
}

/* Vertices by regions: those of the region told by r are from starts[r] up to starts[r + 1]. */
static void list_members(depths *d)
{
    const size_t count = d->from->mesh->vertex_count;
    memset(d->starts, 0, (count + 2) * sizeof *d->starts);
    for (uint32_t v = 0; v < count; v++) d->starts[mesh_sets_find(d->regions, v) + 2]++;
    for (size_t i = 2; i < count + 2; i++) d->starts[i] += d->starts[i - 1];
    for (uint32_t v = 0; v < count; v++)
        d->members[d->starts[mesh_sets_find(d->regions, v) + 1]++] = v;
}

/* ------------------------------------------------------------------------------------------------
 * The grid
 */

/* The cell along an axis, within the grid. */
static size_t cell_of(const grid *g, int axis, double x)
{
    const double at = (x - g->low[axis]) / g->cell;
    if (!(at > 0)) return 0;
    return at < (double)(g->side[axis] - 1) ? (size_t)at : g->side[axis] - 1;
}

/* A corner of a triangle, or an end of a segment. */
static const double *corner_of(const depths *d, bool is_segment, size_t item, size_t k)
{
    if (is_segment) return d->places->segments[item][k];
    return d->at + 3 * (size_t)vertex_of(d, item, k);
}

/* The cells that an item reaches over, from first to last; how many they are. */
static size_t reach_of(const depths *d, bool is_segment, size_t item, size_t first[2],
                       size_t last[2])
{
    const size_t corners = is_segment ? 2 : 3;
    const double *at[3];
    for (size_t k = 0; k < corners; k++) at[k] = corner_of(d, is_segment, item, k);
    for (int axis = 0; axis < 2; axis++) {
        double low = at[0][axis], high = low;
        for (size_t k = 1; k < corners; k++) { /* in this form without branches */
            const double x = at[k][axis];
            low = x < low ? x : low;
            high = x > high ? x : high;
        }
        first[axis] = cell_of(&d->cells, axis, low);
        last[axis] = cell_of(&d->cells, axis, high);
    }
    return (last[0] - first[0] + 1) * (last[1] - first[1] + 1);
}

/* Marks those of a range of triangles that are in any list: that bound an inside and reach over a
   wanted cell, or over very many. */
static void mark_entered(void *context, size_t begin, size_t end)
{
    depths *d = (depths *)context;
    const grid *g = &d->cells;
    for (size_t t = begin; t < end; t++) {
        size_t first[2], last[2];
        d->entered[t] = 0;
        if (!sign_of(d, t)) continue;
        if (reach_of(d, false, t, first, last) > CELLS_MAX) {
            d->entered[t] = 1;
            continue;
        }
        for (size_t y = first[1]; y <= last[1]; y++) {
            for (size_t x = first[0]; x <= last[0]; x++)
                d->entered[t] |= g->wanted[y * g->side[0] + x];
        }
    }
}

/* Enters an item: counts it, or, where there is room for items, puts it where it belongs. */
static void enter(depths *d, cell_lists *lists, bool is_segment, uint32_t item)
{
    const grid *g = &d->cells;
    size_t first[2], last[2];
    if (reach_of(d, is_segment, item, first, last) > CELLS_MAX) {
        if (lists->items)
            lists->items[lists->starts[g->large + 1]++] = item;
        else
            lists->starts[g->large + 2]++;
        return;
    }
    for (size_t y = first[1]; y <= last[1]; y++) {
        for (size_t x = first[0]; x <= last[0]; x++) {
            const size_t cell = y * g->side[0] + x;
            if (!g->wanted[cell]) continue;
            if (lists->items)
                lists->items[lists->starts[cell + 1]++] = item;
            else
                lists->starts[cell + 2]++;
        }
    }
}

static void free_cells(cell_lists *lists)
{
    free(lists->starts);
    free(lists->items);
    memset(lists, 0, sizeof *lists);
}

/* Makes lists of all segments, or of all triangles that bound an inside, in place of those that
   there are. */
static bool fill_cells(depths *d, cell_lists *lists, bool is_segment)
{
    const size_t cells = d->cells.large;
    const uint32_t count = is_segment ? d->places->segment_count : d->from->mesh->triangle_count;
    free_cells(lists);
    lists->starts = (uint32_t *)calloc(cells + 3, sizeof *lists->starts);
    if (!lists->starts) return false;
    if (!is_segment) task_loop(d->from->tasks, count, mark_entered, d);
    for (uint32_t i = 0; i < count; i++) {
        if (is_segment || d->entered[i]) enter(d, lists, is_segment, i);
    }
    for (size_t i = 2; i < cells + 3; i++) lists->starts[i] += lists->starts[i - 1];
    lists->items = (uint32_t *)malloc(((size_t)lists->starts[cells + 2] + 1) * sizeof(uint32_t));
    if (!lists->items) return false;
    for (uint32_t i = 0; i < count; i++) {
        if (is_segment || d->entered[i]) enter(d, lists, is_segment, i);
    }
    return true;
}

/* Makes the grid round all triangles that bound an inside: about as many cells as triangles. False
   if there is no memory, or its size is more than a double holds. */
static bool make_grid(depths *d)
{
    const mesh_file *mesh = d->from->mesh;
    grid *g = &d->cells;
    double high[2] = {0, 0};
    size_t count = 0;
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        if (!sign_of(d, t)) continue;
        for (size_t k = 0; k < 3; k++) {
            const double *p = d->at + 3 * (size_t)vertex_of(d, t, k);
            for (int axis = 0; axis < 2; axis++) {
                const bool none = count == 0 && k == 0;
                if (none || p[axis] < g->low[axis]) g->low[axis] = p[axis];
                if (none || p[axis] > high[axis]) high[axis] = p[axis];
            }
        }
        count++;
    }
    const double width = high[0] - g->low[0], height = high[1] - g->low[1];
    const double longest = width > height ? width : height;
    if (!(longest < DBL_MAX)) return false;
    g->cell = longest / (1 + sqrt((double)count));
    if (!(g->cell > 0)) g->cell = 1;
    g->side[0] = (size_t)(width / g->cell) + 1;
    g->side[1] = (size_t)(height / g->cell) + 1;
    g->large = g->side[0] * g->side[1];
    g->wanted = (uint8_t *)calloc(g->large + 1, 1);
    return g->wanted != NULL;
}

/* ------------------------------------------------------------------------------------------------
 * Inside or not
 */

/* How the line from p upwards in z passes through a triangle: 1 outwards, -1 inwards, 0 not. Sides
   are counted by their ends in y, from the lower one on, so that a line through a side that two
   triangles share passes through one of them. */
static int crossing(const depths *d, size_t triangle, const double p[3])
{
    const double *v[3];
    int turns = 0;
    for (size_t k = 0; k < 3; k++) v[k] = d->at + 3 * (size_t)vertex_of(d, triangle, k);
    for (size_t k = 0; k < 3; k++) {
        const double *low = v[k], *high = v[(k + 1) % 3];
        const bool up = low[1] <= high[1];
        if (!up) {
            low = v[(k + 1) % 3];
            high = v[k];
        }
        if (low[1] > p[1] || high[1] <= p[1]) continue;
        const double side =
            (high[0] - low[0]) * (p[1] - low[1]) - (high[1] - low[1]) * (p[0] - low[0]);
        if (side > 0) turns += up ? 1 : -1; /* it is to the right of p */
    }
    if (turns == 0) return 0;
    double normal[3];
    cross_sides(v[0], v[1], v[2], normal);
    double height = 0;
    for (int k = 0; k < 3; k++) height += normal[k] * (v[0][k] - p[k]);
    /* the plane is above p if the way to it along z is upwards */
    return height / normal[2] > 0 ? turns * sign_of(d, triangle) : 0;
}

/* How many insides a point is in: the winding number. */
static int insides(const depths *d, const double p[3])
{
    const grid *g = &d->cells;
    int count = 0;
    const cell_lists *lists = &g->surface;
    for (uint32_t i = lists->starts[g->large]; i < lists->starts[g->large + 1]; i++)
        count += crossing(d, lists->items[i], p);
    for (int axis = 0; axis < 2; axis++) {
        if (p[axis] < g->low[axis] || p[axis] > g->low[axis] + g->cell * (double)g->side[axis])
            return count;
    }
    const size_t cell = cell_of(g, 1, p[1]) * g->side[0] + cell_of(g, 0, p[0]);
    for (uint32_t i = lists->starts[cell]; i < lists->starts[cell + 1]; i++)
        count += crossing(d, lists->items[i], p);
    return count;
}

/* A point just outside of a vertex. */
static void point_outside(const depths *d, uint32_t vertex, double p[3])
{
    const double *normal = d->normals + 3 * (size_t)vertex;
    const double length =
        sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
    memcpy(p, d->at + 3 * (size_t)vertex, 3 * sizeof *p);
    /* twice an area, so its root is about the length of an edge; 0 where there is no inside */
    for (int k = 0; k < 3 && length > 0; k++) p[k] += OFFSET * normal[k] / sqrt(length);
}

/* Whether a vertex of a region is buried, which tells all of it. */
static uint8_t ask_region(const depths *d, uint32_t vertex)
{
    double p[3];
    point_outside(d, vertex, p);
    return insides(d, p) > 0 ? REGION_BURIED : REGION_EXPOSED;
}

/* ------------------------------------------------------------------------------------------------
 * How deep
 */

static double dot(const double *a, const double *b)
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* The squared distance of the origin to the segment from a to b. */
static double segment_distance(const double *a, const double *b)
{
    double along[3], nearest[3];
    for (int k = 0; k < 3; k++) along[k] = b[k] - a[k];
    const double length = dot(along, along);
    double part = length > 0 ? -dot(a, along) / length : 0;
    part = part < 0 ? 0 : part > 1 ? 1 : part;
    for (int k = 0; k < 3; k++) nearest[k] = a[k] + part * along[k];
    return dot(nearest, nearest);
}

/* The squared distance of a point to a triangle: to its plane, if the foot is inside of all sides,
   or to the nearest side. */
static double triangle_distance(const depths *d, size_t triangle, const double p[3])
{
    double v[3][3], normal[3], least = HUGE_VAL;
    bool inside = true;
    for (size_t k = 0; k < 3; k++) {
        for (size_t i = 0; i < 3; i++)
            v[k][i] = d->at[3 * (size_t)vertex_of(d, triangle, k) + i] - p[i];
    }
    cross_sides(v[0], v[1], v[2], normal);
    const double square = dot(normal, normal);
    for (size_t k = 0; k < 3; k++) {
        const double *a = v[k], *b = v[(k + 1) % 3];
        const double outward[3] = {(b[1] - a[1]) * normal[2] - (b[2] - a[2]) * normal[1],
                                   (b[2] - a[2]) * normal[0] - (b[0] - a[0]) * normal[2],
                                   (b[0] - a[0]) * normal[1] - (b[1] - a[1]) * normal[0]};
        inside &= dot(outward, a) >= 0;
    }
    if (inside && square > 0) return dot(normal, v[0]) * dot(normal, v[0]) / square;
    for (size_t k = 0; k < 3; k++) least = fmin(least, segment_distance(v[k], v[(k + 1) % 3]));
    return least;
}

static bool is_of_region(const depths *d, size_t triangle, uint32_t region)
{
    return d->regions[vertex_of(d, triangle, 0)] == region ||
           d->regions[vertex_of(d, triangle, 1)] == region ||
           d->regions[vertex_of(d, triangle, 2)] == region;
}

static double cell_distance(depths *d, size_t cell, uint32_t region, const double p[3],
                            double least)
{
    const cell_lists *surface = &d->cells.surface, *segments = &d->cells.segments;
    const uint32_t *starts = segments->starts;
    for (uint32_t i = starts[cell]; i < starts[cell + 1]; i++) {
        double ends[2][3];
        for (int k = 0; k < 6; k++)
            ends[k / 3][k % 3] = d->places->segments[segments->items[i]][k / 3][k % 3] - p[k % 3];
        least = fmin(least, segment_distance(ends[0], ends[1]));
    }
    d->looked_at += starts[cell + 1] - starts[cell];
    starts = surface->starts;
    for (uint32_t i = starts[cell]; i < starts[cell + 1]; i++) {
        if (!is_of_region(d, surface->items[i], region))
            least = fmin(least, triangle_distance(d, surface->items[i], p));
    }
    d->looked_at += starts[cell + 1] - starts[cell];
    return least;
}

/* The squared distance of a vertex to the surface without its region, or one of at most `enough`.
   Cells are looked at in rings round that of the point; all beyond ring n are n cells away. */
static double surface_distance(depths *d, uint32_t vertex, double enough)
{
    const double *p = d->at + 3 * (size_t)vertex;
    const uint32_t region = d->regions[vertex];
    const grid *g = &d->cells;
    const size_t x = cell_of(g, 0, p[0]), y = cell_of(g, 1, p[1]);
    const size_t rings = g->side[0] > g->side[1] ? g->side[0] : g->side[1];
    double least = cell_distance(d, g->large, region, p, HUGE_VAL);
    for (size_t ring = 0; ring < rings && least > enough; ring++) {
        const double near = ring > 0 ? g->cell * (double)(ring - 1) : 0;
        if (near * near > least || d->looked_at > DISTANCES_MAX) break;
        const size_t low = y > ring ? y - ring : 0;
        for (size_t row = low; row <= y + ring && row < g->side[1]; row++) {
            const bool whole = row + ring == y || row == y + ring;
            const size_t left = x > ring ? x - ring : 0;
            for (size_t column = left; column <= x + ring && column < g->side[0]; column++) {
                if (whole || column + ring == x || column == x + ring)
                    least = cell_distance(d, row * g->side[0] + column, region, p, least);
            }
        }
    }
    return least;
}

/* The depth of a buried region: that of its deepest vertex. */
static double region_depth(depths *d, uint32_t region)
{
    double deepest = -1;
    for (uint32_t i = d->starts[region]; i < d->starts[region + 1]; i++) {
        if (d->looked_at > DISTANCES_MAX) break;
        const double square = surface_distance(d, d->members[i], deepest);
        if (square > deepest && square < DBL_MAX && d->looked_at <= DISTANCES_MAX) deepest = square;
    }
    return deepest < 0 ? -1 : sqrt(deepest);
}

/* Wants the cells that ask_regions looks at. */
static void want_asked(depths *d, const place *one)
{
    grid *g = &d->cells;
    for (uint32_t i = 0; i < 3 * one->triangle_count; i++) {
        double p[3];
        point_outside(d, d->chosen[region_at(d, one, i)], p);
        g->wanted[cell_of(g, 1, p[1]) * g->side[0] + cell_of(g, 0, p[0])] = 1;
    }
}

/* Wants the cells that region_depth looks at, or more. What is in the box of a place, where some
   segment is, is as far away from a vertex as its farthest corner at most: rings further out than
   that are not looked at. */
static void want_region(depths *d, const place *one, uint32_t region)
{
    grid *g = &d->cells;
    const size_t longest = g->side[0] > g->side[1] ? g->side[0] : g->side[1];
    size_t first[2] = {g->side[0], g->side[1]}, last[2] = {0, 0};
    double far = 0;
    for (uint32_t i = d->starts[region]; i < d->starts[region + 1]; i++) {
        const double *p = d->at + 3 * (size_t)d->members[i];
        double sum = 0;
        for (int k = 0; k < 3; k++)
            sum += fmax(fabs(p[k] - one->low[k]), fabs(p[k] - one->high[k]));
        far = fmax(far, sum);
        for (int axis = 0; axis < 2; axis++) {
            const size_t cell = cell_of(g, axis, p[axis]);
            if (cell < first[axis]) first[axis] = cell;
            if (cell > last[axis]) last[axis] = cell;
        }
    }
    /* A cell more as the segment may be at the far end of its own, one as ring n is n - 1 cells
       away at least, one for the ring that ends it, and one for rounding. */
    const double rings = far / g->cell + 4;
    const size_t around = d->from->pair_count <= d->places->segment_count && rings < (double)longest
                              ? (size_t)rings
                              : longest;
    for (int axis = 0; axis < 2; axis++) {
        first[axis] = first[axis] > around ? first[axis] - around : 0;
        last[axis] = last[axis] + around < g->side[axis] ? last[axis] + around : g->side[axis] - 1;
    }
    for (size_t y = first[1]; y <= last[1]; y++)
        memset(g->wanted + y * g->side[0] + first[0], 1, last[0] - first[0] + 1);
}

/* Wants the cells that measure looks at. Uses depth to do each region once. */
static void want_buried(depths *d, const place *one)
{
    for (uint32_t i = 0; i < 3 * one->triangle_count; i++) {
        const uint32_t region = region_at(d, one, i);
        if (d->state[region] != REGION_BURIED || d->depth[region] < -1) continue;
        d->depth[region] = -2; /* as little known as with -1 */
        want_region(d, one, region);
    }
}

/* Asks about all regions that a place borders on; whether any is buried. */
static bool ask_regions(depths *d, const place *one)
{
    bool any = false;
    for (uint32_t i = 0; i < 3 * one->triangle_count; i++) {
        const uint32_t region = region_at(d, one, i);
        if (d->state[region] == REGION_UNKNOWN) d->state[region] = ask_region(d, d->chosen[region]);
        any |= d->state[region] == REGION_BURIED;
    }
    return any;
}

static void measure(depths *d, place *one)
{
    for (uint32_t i = 0; i < 3 * one->triangle_count; i++) {
        const uint32_t region = region_at(d, one, i);
        if (d->state[region] != REGION_BURIED) continue;
        if (d->depth[region] < 0) d->depth[region] = region_depth(d, region);
        if (d->depth[region] > one->depth) one->depth = d->depth[region];
    }
}

static bool allocate(depths *d)
{
    const size_t vertices = (size_t)d->from->mesh->vertex_count + 2;
    const size_t triangles = (size_t)d->from->mesh->triangle_count + 1;
    d->at = (double *)malloc(3 * vertices * sizeof *d->at);
    d->normals = (double *)calloc(3 * vertices, sizeof *d->normals);
    d->regions = (uint32_t *)malloc(vertices * sizeof *d->regions);
    d->chosen = (uint32_t *)malloc(vertices * sizeof *d->chosen);
    d->asked = (uint8_t *)calloc(vertices, 1);
    d->colliding = (uint8_t *)calloc(triangles, 1);
    d->entered = (uint8_t *)calloc(triangles, 1);
    d->state = (uint8_t *)calloc(vertices, 1);
    d->members = (uint32_t *)malloc(vertices * sizeof *d->members);
    d->starts = (uint32_t *)malloc(vertices * sizeof *d->starts);
    d->depth = (double *)calloc(vertices, sizeof *d->depth);
    return d->at && d->normals && d->regions && d->chosen && d->asked && d->colliding &&
           d->entered && d->state && d->members && d->starts && d->depth;
}

static void release(depths *d)
{
    free(d->at);
    free(d->normals);
    free(d->sign);
    free(d->regions);
    free(d->chosen);
    free(d->asked);
    free(d->colliding);
    free(d->entered);
    free(d->state);
    free(d->members);
    free(d->starts);
    free(d->depth);
    free(d->cells.wanted);
    free_cells(&d->cells.surface);
    free_cells(&d->cells.segments);
}

static void read_positions(void *context, size_t begin, size_t end)
{
    const depths *d = (const depths *)context;
    const sc_pose *pose = d->from->pose;
    for (size_t v = begin; v < end; v++)
        mesh_file_position(pose->positions, pose->position_type, v, d->at + 3 * v);
}

/* The grid, and the regions, which have nothing to do with it. */
static void run_grid_or_regions(void *context, uint32_t part, uint32_t worker)
{
    depths *d = (depths *)context;
    (void)worker;
    if (part == 0) {
        d->has_grid = find_signs(d) && make_grid(d);
        return;
    }
    find_regions(d);
    for (uint32_t v = 0; v < d->from->mesh->vertex_count; v++) /* no path is left to follow */
        d->regions[v] = mesh_sets_find(d->regions, v);
}

static bool find_depths(depths *d, place_list *list)
{
    const place_source *from = d->from;
    if (!allocate(d)) return false;
    task_loop(from->tasks, from->mesh->vertex_count, read_positions, d);
    for (uint32_t i = 0; i < list->triangle_count; i++) d->colliding[list->triangles[i]] = 1;
    task_parts(from->tasks, 2, run_grid_or_regions, d);
    if (!d->has_grid) return false;
    find_normals(d);
    for (uint32_t i = 0; i < list->count; i++) want_asked(d, &list->places[i]);
    if (!fill_cells(d, &d->cells.surface, false)) return false;
    bool any = false;
    for (uint32_t i = 0; i < list->count; i++) any |= ask_regions(d, &list->places[i]);
    if (!any) return true;

    list_members(d);
    memset(d->cells.wanted, 0, d->cells.large);
    for (uint32_t i = 0; i < list->count; i++) want_buried(d, &list->places[i]);
    if (!fill_cells(d, &d->cells.surface, false) || !fill_cells(d, &d->cells.segments, true))
        return false;
    for (uint32_t i = 0; i < list->count; i++) measure(d, &list->places[i]);
    return true;
}

bool place_depths(place_list *list, const place_source *source)
{
    depths d;
    if (source->check->closed_parts == 0 || list->count == 0) return true;
    memset(&d, 0, sizeof d);
    d.from = source;
    d.places = list;
    const bool found = find_depths(&d, list);
    release(&d);
    return found;
}
