/*
 * Half-edges, edges and fans. See adjacency.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "build/adjacency.h"

#include <string.h>

#include "base/jobs.h"

/* An edge from the point at hand to one with a higher number: one half-edge each that runs along it
   there and back, how many do, which of all names it, and its slot. */
typedef struct edge {
    uint32_t end, there, back, count_there, count_back, owner, slot;
} edge;

/*
 * The edges from a point, to be found by the point at their other end. Its number times a factor,
 * without the lowest bits, is the slot where a search begins; it goes on to the next while the slot
 * is another edge's. Slots are four times as many as edges at most. Where many meet at a point each
 * point has a slot of its own, so that no numbers make searches long.
 */
typedef struct edge_table {
    edge *edges;     /* and one more */
    uint32_t *slots; /* the number of an edge, or SC_NONE */
    uint32_t factor, shift, mask;
} edge_table;

/* Corners at a point up to which slots are shared. */
enum { CORNERS_SHARED = 256 };

static uint32_t find_slot(const edge_table *table, uint32_t end)
{
    uint32_t slot = (end * table->factor) >> table->shift;
    while (table->slots[slot] != SC_NONE && table->edges[table->slots[slot]].end != end)
        slot = (slot + 1) & table->mask;
    return slot;
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

/* Of two half-edges of an edge the one with the lower number for the caller. */
static uint32_t owner_of(const sc_points *points, uint32_t h, uint32_t g)
{
    uint64_t a = 3 * (uint64_t)points->id[h / 3] + h % 3;
    uint64_t b = 3 * (uint64_t)points->id[g / 3] + g % 3;
    return a < b ? h : g;
}

/*
 * Lists the edges from a point to those with higher numbers; returns how many. First come the
 * half-edges that start at the point, nearly all with an edge of their own, then those that end
 * there, nearly all with one that is known. An edge to a lower number, or of no length, is written
 * behind the list, and written over, since no processor could foresee which these are.
 */
static uint32_t list_edges(const sc_points *points, const sc_adjacency *adjacency, uint32_t p,
                           const edge_table *table)
{
    uint32_t begin = adjacency->corner_first[p], end = adjacency->corner_first[p + 1], n = 0, i;
    for (i = begin; i < end; i++) {
        uint32_t h = adjacency->corners[i], q = points->triangles[sc_adjacency_next(h)];
        uint32_t slot = find_slot(table, q), known = table->slots[slot];
        edge *e = &table->edges[n];
        if (known != SC_NONE) {
            e = &table->edges[known];
            e->count_there++;
            e->owner = owner_of(points, e->owner, h);
            continue;
        }
        e->end = q;
        e->there = e->owner = h;
        e->count_there = 1;
        e->count_back = 0;
        e->slot = slot;
        table->slots[slot] = q > p ? n : SC_NONE;
        n += q > p;
    }
    for (i = begin; i < end; i++) {
        uint32_t h = sc_adjacency_previous(adjacency->corners[i]), q = points->triangles[h];
        uint32_t slot = find_slot(table, q), at = table->slots[slot], is_known = at != SC_NONE;
        edge *e;
        at = is_known ? at : n;
        e = &table->edges[at];
        e->end = q;
        e->back = h;
        e->count_there = is_known ? e->count_there : 0;
        e->count_back = is_known ? e->count_back + 1 : 1;
        e->owner = is_known ? owner_of(points, e->owner, h) : h;
        e->slot = slot;
        table->slots[slot] = q > p ? at : SC_NONE;
        n += !is_known & (q > p);
    }
    for (i = 0; i < n; i++) table->slots[table->edges[i].slot] = SC_NONE;
    return n;
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

/* The pairing of half-edges by ranges of points. */
typedef struct pairing {
    const sc_points *points;
    sc_adjacency *adjacency;
    edge_table table; /* of the first part; the others' follow it */
    uint32_t edges_room, parts;
    uint8_t *names; /* 3 * triangle_count: whether a half-edge names its edge */
    uint32_t edge_count[SC_JOBS_PARTS], boundary[SC_JOBS_PARTS], irregular[SC_JOBS_PARTS];
} pairing;

static void pair_range(void *context, uint32_t part, uint32_t worker)
{
    pairing *all = (pairing *)context;
    const sc_points *points = all->points;
    const uint64_t count = points->point_count;
    uint32_t *opposite = all->adjacency->opposite, p, i;
    uint32_t edges = 0, boundary = 0, irregular = 0; /* others' are in the same lines of cache */
    const uint32_t end = (uint32_t)(count * (part + 1) / all->parts);
    edge_table table = all->table;
    (void)worker;
    table.edges += (uint64_t)all->edges_room * part;
    table.slots += ((uint64_t)table.mask + 1) * part;
    for (p = (uint32_t)(count * part / all->parts); p < end; p++) {
        const uint32_t n = list_edges(points, all->adjacency, p, &table);
        edges += n;
        for (i = 0; i < n; i++) {
            const edge *e = &table.edges[i];
            all->names[e->owner] = 1;
            if (e->count_there == 1 && e->count_back == 1) {
                opposite[e->there] = e->back;
                opposite[e->back] = e->there;
            } else if (e->count_there + e->count_back == 1) {
                boundary++;
            } else {
                irregular++;
            }
        }
    }
    all->edge_count[part] = edges;
    all->boundary[part] = boundary;
    all->irregular[part] = irregular;
}

static void count_components(const sc_points *points, uint32_t *lowest, sc_adjacency *adjacency)
{
    uint32_t p;
    sc_adjacency_find_components(points, lowest);
    for (p = 0; p < points->point_count; p++) adjacency->component_count += lowest[p] == p;
}

static void write_owned(void *context, uint32_t part, uint32_t first, uint32_t end)
{
    pairing *all = (pairing *)context;
    uint32_t t;
    (void)part;
    for (t = first; t < end; t++) {
        const uint8_t *names = all->names + 3 * (uint64_t)t;
        all->adjacency->owned[t] = (uint8_t)(names[0] | names[1] << 1 | names[2] << 2);
    }
}

/* Fewer points or triangles a part are not worth it. */
enum { POINTS_A_PART = 4096, TRIANGLES_A_PART = 16384 };

/* How the pairing is cut, and the shape of its tables. */
static void shape_tables(const sc_points *points, const uint32_t *first, const sc_tasks *tasks,
                         pairing *all)
{
    uint32_t p, longest = 0, bits = 3;
    for (p = 0; p < points->point_count; p++)
        longest = first[p + 1] - first[p] > longest ? first[p + 1] - first[p] : longest;
    all->edges_room = 2 * longest + 1;
    all->parts = 1;
    if (longest > CORNERS_SHARED) { /* a slot a point */
        all->table.factor = 1;
        all->table.shift = 0;
        all->table.mask = points->point_count - 1;
        return;
    }
    while (1u << bits < 8 * longest) bits++;
    all->table.factor = 0x9e3779b1u; /* 2^32 over the golden ratio */
    all->table.shift = 32 - bits;
    all->table.mask = (1u << bits) - 1;
    if (tasks) all->parts += points->point_count / POINTS_A_PART;
    if (all->parts > SC_JOBS_PARTS) all->parts = SC_JOBS_PARTS;
}

static sc_status pair_half_edges(const sc_points *points, sc_scratch *scratch,
                                 sc_adjacency *adjacency)
{
    pairing all;
    uint32_t part;
    memset(&all, 0, sizeof all);
    all.points = points;
    all.adjacency = adjacency;
    shape_tables(points, adjacency->corner_first, scratch->tasks, &all);
    all.table.slots = (uint32_t *)sc_scratch_take_filled(
        scratch, all.parts * ((uint64_t)all.table.mask + 1), sizeof(uint32_t), 0xff);
    all.table.edges = (edge *)sc_scratch_take_filled(scratch, all.parts * (uint64_t)all.edges_room,
                                                     sizeof(edge), 0);
    all.names =
        (uint8_t *)sc_scratch_take_filled(scratch, 3 * (uint64_t)points->triangle_count, 1, 0);
    if (!all.table.slots || !all.table.edges || !all.names) return SC_ERROR_MEMORY;
    sc_jobs_run(scratch->tasks, all.parts, pair_range, &all);
    (void)sc_jobs_loop(scratch->tasks, points->triangle_count, TRIANGLES_A_PART, write_owned, &all);
    for (part = 0; part < all.parts; part++) {
        adjacency->edge_count += all.edge_count[part];
        adjacency->boundary_edges += all.boundary[part];
        adjacency->irregular_edges += all.irregular[part];
    }
    sc_scratch_give(scratch, all.names);
    sc_scratch_give(scratch, all.table.edges);
    sc_scratch_give(scratch, all.table.slots);
    return SC_OK;
}

/* Steps before that, which need not wait for each other. */
typedef struct listing {
    const sc_points *points;
    sc_adjacency *adjacency;
    uint32_t *lowest; /* point_count: see sc_adjacency_find_components */
} listing;

static void before_pairing(void *context, uint32_t part, uint32_t worker)
{
    const listing *all = (const listing *)context;
    const size_t half_edges = 3 * (size_t)all->points->triangle_count;
    (void)worker;
    if (part == 0)
        list_corners(all->points, all->adjacency);
    else if (part == 1)
        count_components(all->points, all->lowest, all->adjacency);
    else
        memset(all->adjacency->opposite, 0xff, half_edges * sizeof(uint32_t));
}

sc_status sc_adjacency_build(const sc_points *points, sc_scratch *scratch, sc_adjacency *adjacency)
{
    const uint64_t corners = 3 * (uint64_t)points->triangle_count;
    listing all;
    adjacency->edge_count = adjacency->boundary_edges = adjacency->irregular_edges = 0;
    adjacency->component_count = 0;
    adjacency->opposite = (uint32_t *)sc_scratch_take(scratch, corners, sizeof(uint32_t));
    adjacency->owned = (uint8_t *)sc_scratch_take(scratch, points->triangle_count, 1);
    adjacency->corner_first = (uint32_t *)sc_scratch_take_filled(
        scratch, (uint64_t)points->point_count + 1, sizeof(uint32_t), 0);
    adjacency->corners = (uint32_t *)sc_scratch_take(scratch, corners, sizeof(uint32_t));
    all.points = points;
    all.adjacency = adjacency;
    all.lowest = (uint32_t *)sc_scratch_take(scratch, points->point_count, sizeof *all.lowest);
    if (!adjacency->opposite || !adjacency->owned || !adjacency->corner_first ||
        !adjacency->corners || !all.lowest)
        return SC_ERROR_MEMORY;
    sc_jobs_run(points->triangle_count < TRIANGLES_A_PART ? NULL : scratch->tasks, 3,
                before_pairing, &all);
    sc_scratch_give(scratch, all.lowest);
    return pair_half_edges(points, scratch, adjacency);
}

void sc_adjacency_give_walks(sc_adjacency *adjacency, sc_scratch *scratch)
{
    sc_scratch_give(scratch, adjacency->opposite);
    sc_scratch_give(scratch, adjacency->corner_first);
    sc_scratch_give(scratch, adjacency->corners);
    adjacency->opposite = adjacency->corner_first = adjacency->corners = NULL;
}
