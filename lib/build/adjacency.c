/*
 * Half-edges, edges and fans. See adjacency.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "build/adjacency.h"

#include "base/sort.h"

/* The caller's number of a half-edge. */
static uint64_t number_of(const sc_points *points, uint32_t h)
{
    return 3 * (uint64_t)points->id[h / 3] + h % 3;
}

/* Half-edges in a bucket by the lower end of their edge, sorted by the upper end, then by
   number. */
static sc_status pair_half_edges(const sc_points *points, sc_scratch *scratch,
                                 sc_adjacency *adjacency)
{
    uint64_t corners = 3 * (uint64_t)points->triangle_count, h;
    const uint32_t *from = points->triangles;
    uint32_t p, *first;
    sc_pair *sides; /* a: the edge's upper end, b: the half-edge */

    first = (uint32_t *)sc_scratch_take_filled(scratch, (uint64_t)points->point_count + 2,
                                               sizeof *first, 0);
    sides = (sc_pair *)sc_scratch_take(scratch, corners, sizeof *sides);
    if (!first || !sides) return SC_ERROR_MEMORY;
    for (h = 0; h < corners; h++) {
        uint32_t a = from[h], b = from[sc_adjacency_next((uint32_t)h)];
        if (a != b) first[(a < b ? a : b) + 2]++;
    }
    for (p = 1; p <= points->point_count; p++) first[p + 1] += first[p];
    for (h = 0; h < corners; h++) {
        uint32_t a = from[h], b = from[sc_adjacency_next((uint32_t)h)];
        adjacency->opposite[h] = SC_NONE;
        if (a != b) {
            sc_pair *side = &sides[first[(a < b ? a : b) + 1]++];
            side->a = a < b ? b : a;
            side->b = (uint32_t)h;
        }
    }
    for (p = 0; p < points->point_count; p++) {
        uint32_t i = first[p], end = first[p + 1], j;
        sc_sort_pairs(sides + i, end - i);
        for (; i < end; i = j) {
            uint32_t owner = sides[i].b, forward = 0, backward = 0;
            for (j = i; j < end && sides[j].a == sides[i].a; j++) {
                (from[sides[j].b] == p) ? forward++ : backward++;
                if (number_of(points, sides[j].b) < number_of(points, owner)) owner = sides[j].b;
            }
            adjacency->edge_count++;
            adjacency->owned[owner / 3] |= (uint8_t)(1u << (owner % 3));
            if (forward + backward == 1) {
                adjacency->boundary_edges++;
            } else if (forward == 1 && backward == 1) {
                adjacency->opposite[sides[i].b] = sides[i + 1].b;
                adjacency->opposite[sides[i + 1].b] = sides[i].b;
            } else {
                adjacency->irregular_edges++;
            }
        }
    }
    sc_scratch_give(scratch, sides);
    sc_scratch_give(scratch, first);
    return SC_OK;
}

static void list_corners(const sc_points *points, sc_adjacency *adjacency)
{
    uint64_t corners = 3 * (uint64_t)points->triangle_count, h;
    uint32_t *first = adjacency->corner_first, p;
    for (h = 0; h < corners; h++) first[points->triangles[h] + 1]++;
    for (p = 0; p < points->point_count; p++) first[p + 1] += first[p];
    for (h = corners; h-- > 0;) /* fills each list from its end, which moves to its start */
        adjacency->corners[--first[points->triangles[h] + 1]] = (uint32_t)h;
    for (p = 0; p < points->point_count; p++) first[p] = first[p + 1];
    first[points->point_count] = (uint32_t)corners;
}

static uint32_t find_root(uint32_t *parent, uint32_t p)
{
    while (parent[p] != p) {
        parent[p] = parent[parent[p]];
        p = parent[p];
    }
    return p;
}

void sc_adjacency_find_components(const sc_points *points, uint32_t *lowest)
{
    uint32_t p, t;
    for (p = 0; p < points->point_count; p++) lowest[p] = p;
    for (t = 0; t < points->triangle_count; t++) {
        const uint32_t *corner = points->triangles + 3 * (uint64_t)t;
        uint32_t a = find_root(lowest, corner[0]), b = find_root(lowest, corner[1]), c;
        if (b < a) {
            lowest[a] = b;
            a = b;
        } else {
            lowest[b] = a;
        }
        c = find_root(lowest, corner[2]);
        if (c < a)
            lowest[a] = c;
        else
            lowest[c] = a;
    }
    for (p = 0; p < points->point_count; p++)
        lowest[p] = lowest[lowest[p]]; /* lower numbers first */
}

static sc_status count_components(const sc_points *points, sc_scratch *scratch,
                                  sc_adjacency *adjacency)
{
    uint32_t *lowest, p;
    lowest = (uint32_t *)sc_scratch_take(scratch, points->point_count, sizeof *lowest);
    if (!lowest) return SC_ERROR_MEMORY;
    sc_adjacency_find_components(points, lowest);
    for (p = 0; p < points->point_count; p++) adjacency->component_count += lowest[p] == p;
    sc_scratch_give(scratch, lowest);
    return SC_OK;
}

sc_status sc_adjacency_build(const sc_points *points, sc_scratch *scratch, sc_adjacency *adjacency)
{
    uint64_t corners = 3 * (uint64_t)points->triangle_count;
    sc_status status;
    adjacency->edge_count = adjacency->boundary_edges = adjacency->irregular_edges = 0;
    adjacency->component_count = 0;
    adjacency->opposite = (uint32_t *)sc_scratch_take(scratch, corners, sizeof(uint32_t));
    adjacency->owned = (uint8_t *)sc_scratch_take_filled(scratch, points->triangle_count, 1, 0);
    adjacency->corner_first = (uint32_t *)sc_scratch_take_filled(
        scratch, (uint64_t)points->point_count + 1, sizeof(uint32_t), 0);
    adjacency->corners = (uint32_t *)sc_scratch_take(scratch, corners, sizeof(uint32_t));
    if (!adjacency->opposite || !adjacency->owned || !adjacency->corner_first ||
        !adjacency->corners)
        return SC_ERROR_MEMORY;
    status = pair_half_edges(points, scratch, adjacency);
    if (status) return status;
    list_corners(points, adjacency);
    return count_components(points, scratch, adjacency);
}

/* A half-edge that has an opposite is the only one between its points that runs its way. So a walk
   that goes from one triangle to the next across such edges meets no point twice before it is
   back. */
uint32_t sc_adjacency_ring(const sc_points *points, const sc_adjacency *adjacency, uint32_t p,
                           uint32_t *ring)
{
    uint32_t begin = adjacency->corner_first[p], count = adjacency->corner_first[p + 1] - begin;
    uint32_t start = adjacency->corners[begin], h = start, i;
    if (count < 3 || count > SC_RING_MAX) return 0;
    for (i = 0; i < count; i++) {
        ring[i] = points->triangles[sc_adjacency_next(h)];
        if (ring[i] == p) return 0;
        h = adjacency
                ->opposite[sc_adjacency_previous(h)]; /* the next triangle, counter-clockwise */
        if (h == SC_NONE || (h == start) != (i + 1 == count)) return 0;
    }
    return count;
}
