/*
 * A spatial hash for self-collision; see spatial_hash.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "spatial_hash.h"

#include "edge_triangle.h"
#include "mesh_edges.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Cells that a box meets, from low to high in x, y, z. */
typedef struct cell_range {
    int32_t low[3], high[3];
} cell_range;

/* An edge in a cell. */
typedef struct cell_entry {
    uint64_t key; /* of the cell */
    uint32_t low, high, edge;
    uint32_t is_lowest; /* bit k: the cell is the lowest of those of the edge, along coordinate k */
} cell_entry;

/* Pairs found so far. */
typedef struct pair_list {
    sc_pair *at;
    uint64_t count, room;
} pair_list;

struct spatial_hash {
    uint32_t *indices; /* 3 * triangle_count, vertices joined */
    uint32_t triangle_count;
    mesh_side *sides;      /* edge e has the sides edge_starts[e] to edge_starts[e + 1] - 1 */
    uint32_t *edge_starts; /* edge_count + 1 */
    cell_range *ranges;    /* edge_count, of the present pose */
    uint32_t edge_count;
    uint32_t
        *starts; /* bucket_count + 1: bucket b holds entries[starts[b]] to [starts[b + 1] - 1] */
    uint32_t bucket_count; /* a power of two */
    cell_entry *entries;
    size_t entry_room;
    double cells_per_unit;
    pair_list pairs;
    edge_triangle tests;
};

/* ------------------------------------------------------------------------------------------------
 * Once per mesh
 */

/* A used vertex and where it is, to be sorted. */
typedef struct placed_vertex {
    double point[3];
    uint32_t vertex;
} placed_vertex;

static int compare_places(const void *left, const void *right)
{
    const placed_vertex *a = (const placed_vertex *)left;
    const placed_vertex *b = (const placed_vertex *)right;
    for (int k = 0; k < 3; k++) {
        if (a->point[k] != b->point[k]) return a->point[k] < b->point[k] ? -1 : 1;
    }
    return a->vertex < b->vertex ? -1 : a->vertex > b->vertex;
}

/* Makes every index the lowest used one at its position. */
static bool join_vertices(const double *positions, uint32_t vertex_count, uint32_t *indices,
                          size_t index_count)
{
    uint32_t *representative = (uint32_t *)malloc(vertex_count * sizeof *representative);
    placed_vertex *places = (placed_vertex *)malloc(vertex_count * sizeof *places);
    if (representative && places) {
        memset(representative, 0xff, vertex_count * sizeof *representative);
        for (size_t i = 0; i < index_count; i++) representative[indices[i]] = indices[i];
        size_t count = 0;
        for (uint32_t v = 0; v < vertex_count; v++) {
            if (representative[v] == SC_NONE) continue;
            memcpy(places[count].point, positions + 3 * (size_t)v, sizeof places->point);
            places[count++].vertex = v;
        }
        qsort(places, count, sizeof *places, compare_places);
        for (size_t i = 1; i < count; i++) {
            const double *a = places[i - 1].point, *b = places[i].point;
            if (a[0] == b[0] && a[1] == b[1] && a[2] == b[2])
                representative[places[i].vertex] = representative[places[i - 1].vertex];
        }
        for (size_t i = 0; i < index_count; i++) indices[i] = representative[indices[i]];
    }
    const bool done = representative && places;
    free(representative);
    free(places);
    return done;
}

/* Finds where each edge's sides begin, and the average length. */
static double find_edges(spatial_hash *hash, const double *positions)
{
    const size_t count = 3 * (size_t)hash->triangle_count;
    double sum = 0.0;
    for (size_t begin = 0; begin < count; begin += mesh_edges_run(hash->sides, begin, count)) {
        const mesh_side *side = &hash->sides[begin];
        double square = 0.0;
        for (size_t k = 0; k < 3; k++) {
            const double d =
                positions[3 * (size_t)side->low + k] - positions[3 * (size_t)side->high + k];
            square += d * d;
        }
        sum += sqrt(square);
        hash->edge_starts[hash->edge_count++] = (uint32_t)begin;
    }
    hash->edge_starts[hash->edge_count] = (uint32_t)count;
    return sum / hash->edge_count;
}

static const char *prepare(spatial_hash *hash, const double *positions, uint32_t vertex_count,
                           const uint32_t *indices)
{
    const size_t count = 3 * (size_t)hash->triangle_count;
    hash->bucket_count = 1024;
    while (hash->bucket_count < count) hash->bucket_count *= 2;
    hash->indices = (uint32_t *)malloc(count * sizeof *hash->indices);
    hash->edge_starts = (uint32_t *)malloc((count + 1) * sizeof *hash->edge_starts);
    hash->ranges = (cell_range *)malloc(count * sizeof *hash->ranges);
    hash->starts = (uint32_t *)malloc(((size_t)hash->bucket_count + 1) * sizeof *hash->starts);
    if (!hash->indices || !hash->edge_starts || !hash->ranges || !hash->starts)
        return "out of memory";
    memcpy(hash->indices, indices, count * sizeof *indices);
    if (!join_vertices(positions, vertex_count, hash->indices, count)) return "out of memory";
    for (size_t i = 0; i < count; i += 3) {
        const uint32_t *corner = hash->indices + i;
        if (corner[0] == corner[1] || corner[1] == corner[2] || corner[2] == corner[0])
            return "a triangle names a vertex twice, which the hash cannot handle";
    }
    mesh_file view;
    memset(&view, 0, sizeof view);
    view.indices = hash->indices;
    view.vertex_count = vertex_count;
    view.triangle_count = hash->triangle_count;
    hash->sides = mesh_edges_sort(&view);
    if (!hash->sides || !edge_triangle_open(&hash->tests)) return "out of memory";
    const double length = find_edges(hash, positions);
    hash->cells_per_unit = length > 0.0 ? 1.0 / length : 1.0;
    if (!isfinite(hash->cells_per_unit)) return "its edges are too short or too long for cells";
    return NULL;
}

spatial_hash *spatial_hash_create(const double *positions, uint32_t vertex_count,
                                  const uint32_t *indices, uint32_t triangle_count,
                                  const char **reason)
{
    spatial_hash *hash = (spatial_hash *)calloc(1, sizeof *hash);
    *reason = "out of memory";
    if (!hash) return NULL;
    hash->triangle_count = triangle_count;
    *reason = prepare(hash, positions, vertex_count, indices);
    if (!*reason) return hash;
    spatial_hash_free(hash);
    return NULL;
}

void spatial_hash_free(spatial_hash *hash)
{
    if (!hash) return;
    edge_triangle_close(&hash->tests);
    free(hash->indices);
    free(hash->sides);
    free(hash->edge_starts);
    free(hash->ranges);
    free(hash->starts);
    free(hash->entries);
    free(hash->pairs.at);
    free(hash);
}

uint64_t spatial_hash_bytes(const spatial_hash *hash)
{
    const uint64_t count = 3 * (uint64_t)hash->triangle_count;
    return sizeof *hash +
           count * (sizeof *hash->indices + sizeof *hash->sides + sizeof *hash->edge_starts +
                    sizeof *hash->ranges) +
           hash->bucket_count * sizeof *hash->starts + hash->entry_room * sizeof *hash->entries +
           hash->pairs.room * sizeof *hash->pairs.at;
}

/* ------------------------------------------------------------------------------------------------
 * Once per pose: cells
 */

/* Teschner et al., section 3.1: multiply by large primes and combine. */
static uint32_t bucket_of(const spatial_hash *hash, const int32_t cell[3])
{
    const uint32_t h = ((uint32_t)cell[0] * 73856093u) ^ ((uint32_t)cell[1] * 19349663u) ^
                       ((uint32_t)cell[2] * 83492791u);
    return h & (hash->bucket_count - 1);
}

/* Tells cells in a bucket apart; a confusion, from 2^21 cells on, costs a needless test. */
static uint64_t key_of(const int32_t cell[3])
{
    uint64_t key = 0;
    for (int k = 0; k < 3; k++) key = key << 21 | ((uint32_t)cell[k] & 0x1fffffu);
    return key;
}

static uint32_t lowest_mask(const int32_t cell[3], const cell_range *range)
{
    uint32_t mask = 0;
    for (int k = 0; k < 3; k++) mask |= (uint32_t)(cell[k] == range->low[k]) << k;
    return mask;
}

/* The cell of a coordinate. What lies far out falls into the outermost cells: still the right
   order. */
static int32_t cell_of(double coordinate, double cells_per_unit)
{
    const double x = coordinate * cells_per_unit, limit = 1e9;
    if (!(x > -limit)) return -1000000000;
    if (x >= limit) return 1000000000;
    const int32_t whole = (int32_t)x;
    return whole - (x < (double)whole);
}

static cell_range range_of(const spatial_hash *hash, const double *positions,
                           const uint32_t *vertices, int count)
{
    cell_range range;
    for (int k = 0; k < 3; k++) {
        double low = positions[3 * (size_t)vertices[0] + (size_t)k], high = low;
        for (int i = 1; i < count; i++) {
            const double x = positions[3 * (size_t)vertices[i] + (size_t)k];
            low = x < low ? x : low;
            high = x > high ? x : high;
        }
        range.low[k] = cell_of(low, hash->cells_per_unit);
        range.high[k] = cell_of(high, hash->cells_per_unit);
    }
    return range;
}

static double cells_in(const cell_range *range)
{
    double count = 1.0;
    for (int k = 0; k < 3; k++) count *= (double)range->high[k] - (double)range->low[k] + 1.0;
    return count;
}

/* Goes to the next cell of a range, x first; false after the last. */
static bool next_cell(const cell_range *range, int32_t cell[3])
{
    for (int k = 0; k < 3; k++) {
        if (cell[k]++ < range->high[k]) return true;
        cell[k] = range->low[k];
    }
    return false;
}

/* Sorts edges into buckets: count, sum up, fill in. False if there is no memory for them. */
static bool fill_buckets(spatial_hash *hash, const double *positions)
{
    int32_t cell[3];
    double cells = 0.0;
    memset(hash->starts, 0, ((size_t)hash->bucket_count + 1) * sizeof *hash->starts);
    for (uint32_t e = 0; e < hash->edge_count; e++) {
        const mesh_side *side = &hash->sides[hash->edge_starts[e]];
        const uint32_t ends[2] = {side->low, side->high};
        hash->ranges[e] = range_of(hash, positions, ends, 2);
        cells += cells_in(&hash->ranges[e]);
        if (cells > 2e9) return false;
        memcpy(cell, hash->ranges[e].low, sizeof cell);
        do hash->starts[bucket_of(hash, cell)]++;
        while (next_cell(&hash->ranges[e], cell));
    }
    uint32_t sum = 0;
    for (uint32_t b = 0; b <= hash->bucket_count; b++) {
        sum += hash->starts[b];
        hash->starts[b] = sum;
    }
    if (sum > hash->entry_room) {
        free(hash->entries);
        hash->entry_room = (size_t)sum + (size_t)sum / 4;
        hash->entries = (cell_entry *)malloc(hash->entry_room * sizeof *hash->entries);
        if (!hash->entries) {
            hash->entry_room = 0;
            return false;
        }
    }
    for (uint32_t e = 0; e < hash->edge_count; e++) {
        const mesh_side *side = &hash->sides[hash->edge_starts[e]];
        memcpy(cell, hash->ranges[e].low, sizeof cell);
        do {
            cell_entry *entry = &hash->entries[--hash->starts[bucket_of(hash, cell)]];
            entry->key = key_of(cell);
            entry->low = side->low;
            entry->high = side->high;
            entry->edge = e;
            entry->is_lowest = lowest_mask(cell, &hash->ranges[e]);
        } while (next_cell(&hash->ranges[e], cell));
    }
    return true;
}

/* ------------------------------------------------------------------------------------------------
 * Once per pose: pairs
 */

static bool add_pair(pair_list *list, uint32_t a, uint32_t b)
{
    if (list->count == list->room) {
        const uint64_t room = 2 * list->room + 1024;
        sc_pair *larger = (sc_pair *)realloc(list->at, (size_t)room * sizeof *larger);
        if (!larger) return false;
        list->at = larger;
        list->room = room;
    }
    const sc_pair pair = {a, b};
    list->at[list->count++] = pair;
    return true;
}

static bool add_triangles(pair_list *list, uint32_t t, uint32_t u)
{
    return t < u ? add_pair(list, t, u) : add_pair(list, u, t);
}

/* An edge and a triangle meet: adds that pair, or those of the triangles on the edge with it. */
static bool add_meeting(spatial_hash *hash, uint32_t edge, uint32_t triangle, uint32_t pairs)
{
    const uint32_t begin = hash->edge_starts[edge], end = hash->edge_starts[edge + 1];
    if (pairs == SC_PAIRS_EDGE) return add_pair(&hash->pairs, hash->sides[begin].corner, triangle);
    for (uint32_t i = begin; i < end; i++) {
        if (!add_triangles(&hash->pairs, hash->sides[i].corner / 3, triangle)) return false;
    }
    return true;
}

/* Whether an edge meets the box of a triangle with its own. */
static bool boxes_meet(const double *p, const double *q, const double low[3], const double high[3])
{
    for (int k = 0; k < 3; k++) {
        if (p[k] < low[k] && q[k] < low[k]) return false;
        if (p[k] > high[k] && q[k] > high[k]) return false;
    }
    return true;
}

/* The edges that a triangle meets in the cells that its box meets. */
static bool look_up(spatial_hash *hash, const double *positions, uint32_t t, uint32_t pairs,
                    uint32_t contact, spatial_hash_answer *answer)
{
    const uint32_t *triangle = hash->indices + 3 * (size_t)t;
    const cell_range range = range_of(hash, positions, triangle, 3);
    if (cells_in(&range) > 2e9) return false;
    const double *const a = positions + 3 * (size_t)triangle[0];
    const double *const b = positions + 3 * (size_t)triangle[1];
    const double *const c = positions + 3 * (size_t)triangle[2];
    double low[3], high[3];
    for (int k = 0; k < 3; k++) {
        low[k] = a[k] < b[k] ? a[k] : b[k];
        low[k] = c[k] < low[k] ? c[k] : low[k];
        high[k] = a[k] > b[k] ? a[k] : b[k];
        high[k] = c[k] > high[k] ? c[k] : high[k];
    }
    int32_t cell[3];
    memcpy(cell, range.low, sizeof cell);
    do {
        const uint32_t bucket = bucket_of(hash, cell), is_lowest = lowest_mask(cell, &range);
        const uint64_t key = key_of(cell);
        for (uint32_t i = hash->starts[bucket]; i < hash->starts[bucket + 1]; i++) {
            const cell_entry *entry = &hash->entries[i];
            /* A pair that meets in several cells is tested in the lowest of them: where, along each
               coordinate, the range of the edge or that of the triangle begins. */
            if (entry->key != key || (entry->is_lowest | is_lowest) != 7) continue;
            if (entry->low == triangle[0] || entry->low == triangle[1] ||
                entry->low == triangle[2] || entry->high == triangle[0] ||
                entry->high == triangle[1] || entry->high == triangle[2])
                continue;
            answer->box_tests++;
            const double *const p = positions + 3 * (size_t)entry->low;
            const double *const q = positions + 3 * (size_t)entry->high;
            if (!boxes_meet(p, q, low, high)) continue;
            answer->primitive_tests++;
            if (!edge_triangle_meet(&hash->tests, p, q, a, b, c, contact)) continue;
            if (!add_meeting(hash, entry->edge, t, pairs)) return false;
        }
    } while (next_cell(&range, cell));
    return true;
}

/* Triangles on one edge that are folded flat onto each other, or are the same. */
static bool add_folded(spatial_hash *hash, const double *positions, spatial_hash_answer *answer)
{
    for (uint32_t e = 0; e < hash->edge_count; e++) {
        const uint32_t end = hash->edge_starts[e + 1];
        for (uint32_t i = hash->edge_starts[e]; i < end; i++) {
            for (uint32_t j = i + 1; j < end; j++) {
                const mesh_side *side = &hash->sides[i];
                const uint32_t t = side->corner / 3, u = hash->sides[j].corner / 3;
                const uint32_t c = hash->indices[3 * t + (side->corner + 2) % 3];
                const uint32_t d = hash->indices[3 * u + (hash->sides[j].corner + 2) % 3];
                answer->primitive_tests++;
                if (c != d &&
                    !edge_triangle_folded(&hash->tests, positions + 3 * (size_t)side->low,
                                          positions + 3 * (size_t)side->high,
                                          positions + 3 * (size_t)c, positions + 3 * (size_t)d))
                    continue;
                if (!add_triangles(&hash->pairs, t, u)) return false;
            }
        }
    }
    return true;
}

static int compare_pairs(const void *left, const void *right)
{
    const sc_pair *a = (const sc_pair *)left;
    const sc_pair *b = (const sc_pair *)right;
    if (a->a != b->a) return a->a < b->a ? -1 : 1;
    return a->b < b->b ? -1 : a->b > b->b;
}

/* Sorts pairs and leaves one of each. */
static void finish_pairs(pair_list *list)
{
    if (list->count == 0) return;
    qsort(list->at, (size_t)list->count, sizeof *list->at, compare_pairs);
    uint64_t kept = 1;
    for (uint64_t i = 1; i < list->count; i++) {
        if (compare_pairs(&list->at[i], &list->at[kept - 1]) != 0) list->at[kept++] = list->at[i];
    }
    list->count = kept;
}

bool spatial_hash_query(spatial_hash *hash, const double *positions, uint32_t pairs,
                        uint32_t contact, spatial_hash_answer *answer)
{
    memset(answer, 0, sizeof *answer);
    hash->pairs.count = 0;
    hash->tests.asked = 0;
    if (!fill_buckets(hash, positions)) return false;
    for (uint32_t t = 0; t < hash->triangle_count; t++) {
        if (!look_up(hash, positions, t, pairs, contact, answer)) return false;
    }
    if (pairs == SC_PAIRS_TRIANGLE && contact == SC_CONTACT_TOUCHING &&
        !add_folded(hash, positions, answer))
        return false;
    finish_pairs(&hash->pairs);
    answer->pairs = hash->pairs.at;
    answer->count = hash->pairs.count;
    answer->undecided = hash->tests.asked;
    return true;
}
