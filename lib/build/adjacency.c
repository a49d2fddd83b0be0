/*
 * Half-edges, edges and fans. See adjacency.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "build/adjacency.h"

/* An edge from the point at hand to one with a higher number: one half-edge each that runs along it
   there and back, how many do, and which of all names it. */
typedef struct edge {
    uint32_t end, there, back, count_there, count_back, owner;
} edge;

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

/* Of two half-edges of an edge the one with the lower number for the caller. */
static uint32_t owner_of(const sc_points *points, uint32_t h, uint32_t g)
{
    uint64_t a = 3 * (uint64_t)points->id[h / 3] + h % 3;
    uint64_t b = 3 * (uint64_t)points->id[g / 3] + g % 3;
    return a < b ? h : g;
}

/*
 * Lists the edges from a point to those with higher numbers; returns how many. place: a number for
 * each point, which may be any: the place of an edge that ends there, if it is listed. First come
 * the half-edges that start at the point, nearly all with an edge of their own, then those that end
 * there, nearly all with one that is known. An edge to a lower number, or of no length, is written
 * behind the list, and written over, since no processor could foresee which these are.
 */
static uint32_t list_edges(const sc_points *points, const sc_adjacency *adjacency, uint32_t p,
                           uint32_t *place, edge *edges)
{
    uint32_t begin = adjacency->corner_first[p], end = adjacency->corner_first[p + 1], n = 0, i;
    for (i = begin; i < end; i++) {
        uint32_t h = adjacency->corners[i], q = points->triangles[sc_adjacency_next(h)];
        uint32_t known = place[q];
        edge *e = &edges[n];
        if (known < n && edges[known].end == q) {
            e = &edges[known];
            e->count_there++;
            e->owner = owner_of(points, e->owner, h);
            continue;
        }
        e->end = q;
        e->there = e->owner = h;
        e->count_there = 1;
        e->count_back = 0;
        place[q] = n;
        n += q > p;
    }
    for (i = begin; i < end; i++) {
        uint32_t h = sc_adjacency_previous(adjacency->corners[i]), q = points->triangles[h];
        uint32_t at = place[q], is_known = at < n && edges[at].end == q;
        edge *e;
        at = is_known ? at : n;
        e = &edges[at];
        e->end = q;
        e->back = h;
        e->count_there = is_known ? e->count_there : 0;
        e->count_back = is_known ? e->count_back + 1 : 1;
        e->owner = is_known ? owner_of(points, e->owner, h) : h;
        place[q] = at;
        n += !is_known & (q > p);
    }
    return n;
}

static sc_status pair_half_edges(const sc_points *points, sc_scratch *scratch,
                                 sc_adjacency *adjacency)
{
    const uint32_t *first = adjacency->corner_first;
    uint32_t p, i, longest = 0, *place;
    edge *edges;
    for (p = 0; p < points->point_count; p++)
        longest = first[p + 1] - first[p] > longest ? first[p + 1] - first[p] : longest;
    place = (uint32_t *)sc_scratch_take_filled(scratch, points->point_count, sizeof *place, 0xff);
    edges = (edge *)sc_scratch_take_filled(scratch, 2 * (uint64_t)longest + 1, sizeof *edges, 0);
    if (!place || !edges) return SC_ERROR_MEMORY;
    for (p = 0; p < points->point_count; p++) {
        uint32_t count = list_edges(points, adjacency, p, place, edges);
        adjacency->edge_count += count;
        for (i = 0; i < count; i++) {
            const edge *e = &edges[i];
            adjacency->owned[e->owner / 3] |= (uint8_t)(1u << (e->owner % 3));
            if (e->count_there == 1 && e->count_back == 1) {
                adjacency->opposite[e->there] = e->back;
                adjacency->opposite[e->back] = e->there;
            } else if (e->count_there + e->count_back == 1) {
                adjacency->boundary_edges++;
            } else {
                adjacency->irregular_edges++;
            }
        }
    }
    sc_scratch_give(scratch, edges);
    sc_scratch_give(scratch, place);
    return SC_OK;
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
    adjacency->opposite =
        (uint32_t *)sc_scratch_take_filled(scratch, corners, sizeof(uint32_t), 0xff);
    adjacency->owned = (uint8_t *)sc_scratch_take_filled(scratch, points->triangle_count, 1, 0);
    adjacency->corner_first = (uint32_t *)sc_scratch_take_filled(
        scratch, (uint64_t)points->point_count + 1, sizeof(uint32_t), 0);
    adjacency->corners = (uint32_t *)sc_scratch_take(scratch, corners, sizeof(uint32_t));
    if (!adjacency->opposite || !adjacency->owned || !adjacency->corner_first ||
        !adjacency->corners)
        return SC_ERROR_MEMORY;
    list_corners(points, adjacency);
    status = pair_half_edges(points, scratch, adjacency);
    if (status) return status;
    return count_components(points, scratch, adjacency);
}
