/*
 * A spatial hash for self-collision; see spatial_hash.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "spatial_hash.h"

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
    int32_t cell[3];
    uint32_t edge;
} cell_entry;

struct spatial_hash {
    const mesh_file *mesh;
    uint32_t (*edges)[2]; /* edge_count */
    cell_range *ranges;   /* edge_count, of the present pose */
    uint32_t edge_count;
    uint32_t
        *starts; /* bucket_count + 1: bucket b holds entries[starts[b]] to [starts[b + 1] - 1] */
    uint32_t bucket_count; /* a power of two */
    cell_entry *entries;
    size_t entry_room;
    double cells_per_unit;
};

/* Keeps the distinct edges and returns their average length. */
static double keep_edges(spatial_hash *hash, const mesh_side *sides)
{
    const mesh_file *mesh = hash->mesh;
    const size_t count = 3 * (size_t)mesh->triangle_count;
    double sum = 0.0;
    for (size_t begin = 0; begin < count; begin += mesh_edges_run(sides, begin, count)) {
        const mesh_side *side = &sides[begin];
        if (side->low == side->high) continue;
        double square = 0.0;
        for (size_t k = 0; k < 3; k++) {
            const double d = (double)mesh->positions[3 * (size_t)side->low + k] -
                             (double)mesh->positions[3 * (size_t)side->high + k];
            square += d * d;
        }
        sum += sqrt(square);
        hash->edges[hash->edge_count][0] = side->low;
        hash->edges[hash->edge_count++][1] = side->high;
    }
    return hash->edge_count ? sum / hash->edge_count : 1.0;
}

spatial_hash *spatial_hash_create(const mesh_file *mesh)
{
    const size_t count = 3 * (size_t)mesh->triangle_count;
    spatial_hash *hash = (spatial_hash *)calloc(1, sizeof *hash);
    mesh_side *sides = mesh_edges_sort(mesh);
    if (hash && sides) {
        hash->mesh = mesh;
        hash->bucket_count = 1024;
        while (hash->bucket_count < count) hash->bucket_count *= 2;
        hash->edges = (uint32_t(*)[2])malloc(count * sizeof *hash->edges);
        hash->ranges = (cell_range *)malloc(count * sizeof *hash->ranges);
        hash->starts = (uint32_t *)malloc(((size_t)hash->bucket_count + 1) * sizeof *hash->starts);
    }
    if (!hash || !sides || !hash->edges || !hash->ranges || !hash->starts) {
        spatial_hash_free(hash);
        hash = NULL;
    } else {
        hash->cells_per_unit = 1.0 / keep_edges(hash, sides);
    }
    free(sides);
    return hash;
}

void spatial_hash_free(spatial_hash *hash)
{
    if (!hash) return;
    free(hash->edges);
    free(hash->ranges);
    free(hash->starts);
    free(hash->entries);
    free(hash);
}

/* Teschner et al., section 3.1: multiply by large primes and combine. */
static uint32_t bucket_of(const spatial_hash *hash, const int32_t cell[3])
{
    const uint32_t h = ((uint32_t)cell[0] * 73856093u) ^ ((uint32_t)cell[1] * 19349663u) ^
                       ((uint32_t)cell[2] * 83492791u);
    return h & (hash->bucket_count - 1);
}

static cell_range range_of(const spatial_hash *hash, const float *positions,
                           const uint32_t *vertices, int count)
{
    cell_range range;
    for (int k = 0; k < 3; k++) {
        float low = positions[3 * (size_t)vertices[0] + (size_t)k], high = low;
        for (int i = 1; i < count; i++) {
            const float x = positions[3 * (size_t)vertices[i] + (size_t)k];
            low = x < low ? x : low;
            high = x > high ? x : high;
        }
        range.low[k] = (int32_t)floor((double)low * hash->cells_per_unit);
        range.high[k] = (int32_t)floor((double)high * hash->cells_per_unit);
    }
    return range;
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

/* Sorts edges into buckets: count, sum up, fill in. */
static bool fill_buckets(spatial_hash *hash, const float *positions)
{
    int32_t cell[3];
    memset(hash->starts, 0, ((size_t)hash->bucket_count + 1) * sizeof *hash->starts);
    for (uint32_t e = 0; e < hash->edge_count; e++) {
        hash->ranges[e] = range_of(hash, positions, hash->edges[e], 2);
        memcpy(cell, hash->ranges[e].low, sizeof cell);
        do hash->starts[bucket_of(hash, cell)]++;
        while (next_cell(&hash->ranges[e], cell));
    }
    uint64_t sum = 0;
    for (uint32_t b = 0; b <= hash->bucket_count; b++) {
        sum += hash->starts[b];
        if (sum > UINT32_MAX) return false;
        hash->starts[b] = (uint32_t)sum;
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
        memcpy(cell, hash->ranges[e].low, sizeof cell);
        do {
            cell_entry *entry = &hash->entries[--hash->starts[bucket_of(hash, cell)]];
            memcpy(entry->cell, cell, sizeof cell);
            entry->edge = e;
        } while (next_cell(&hash->ranges[e], cell));
    }
    return true;
}

/* Six times the signed volume of a tetrahedron. */
static double volume(const double a[3], const double b[3], const double c[3], const double d[3])
{
    const double u[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
    const double v[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
    const double w[3] = {d[0] - a[0], d[1] - a[1], d[2] - a[2]};
    return u[0] * (v[1] * w[2] - v[2] * w[1]) + u[1] * (v[2] * w[0] - v[0] * w[2]) +
           u[2] * (v[0] * w[1] - v[1] * w[0]);
}

static void get_point(const float *positions, uint32_t vertex, double point[3])
{
    for (size_t k = 0; k < 3; k++) point[k] = (double)positions[3 * (size_t)vertex + k];
}

/* p and q are on different sides of the triangle's plane and the line between them goes through it. */
static bool edge_meets_triangle(const float *positions, const uint32_t edge[2],
                                const uint32_t triangle[3])
{
    double p[3], q[3], a[3], b[3], c[3];
    get_point(positions, edge[0], p);
    get_point(positions, edge[1], q);
    get_point(positions, triangle[0], a);
    get_point(positions, triangle[1], b);
    get_point(positions, triangle[2], c);
    const double over = volume(a, b, c, p), under = volume(a, b, c, q);
    if ((over > 0.0 && under > 0.0) || (over < 0.0 && under < 0.0)) return false;
    if (over == 0.0 && under == 0.0) return false;
    const double ab = volume(p, q, a, b), bc = volume(p, q, b, c), ca = volume(p, q, c, a);
    return (ab >= 0.0 && bc >= 0.0 && ca >= 0.0) || (ab <= 0.0 && bc <= 0.0 && ca <= 0.0);
}

/* Whether a pair that also meets in other cells is to be tested in this one: the lowest of them. */
static bool is_first_common(const int32_t cell[3], const cell_range *a, const cell_range *b)
{
    for (int k = 0; k < 3; k++) {
        if (cell[k] != (a->low[k] > b->low[k] ? a->low[k] : b->low[k])) return false;
    }
    return true;
}

/* Whether the boxes of an edge and a triangle meet. */
static bool boxes_meet(const float *positions, const uint32_t edge[2], const uint32_t triangle[3])
{
    for (size_t k = 0; k < 3; k++) {
        const float p = positions[3 * (size_t)edge[0] + k], q = positions[3 * (size_t)edge[1] + k];
        const float a = positions[3 * (size_t)triangle[0] + k];
        const float b = positions[3 * (size_t)triangle[1] + k];
        const float c = positions[3 * (size_t)triangle[2] + k];
        const float edge_low = p < q ? p : q, edge_high = p < q ? q : p;
        if (a < edge_low && b < edge_low && c < edge_low) return false;
        if (a > edge_high && b > edge_high && c > edge_high) return false;
    }
    return true;
}

static bool share_vertex(const uint32_t edge[2], const uint32_t triangle[3])
{
    for (int k = 0; k < 3; k++) {
        if (edge[0] == triangle[k] || edge[1] == triangle[k]) return true;
    }
    return false;
}

bool spatial_hash_query(spatial_hash *hash, const float *positions, uint64_t *count)
{
    *count = 0;
    if (!fill_buckets(hash, positions)) return false;
    for (uint32_t t = 0; t < hash->mesh->triangle_count; t++) {
        const uint32_t *triangle = hash->mesh->indices + 3 * (size_t)t;
        const cell_range range = range_of(hash, positions, triangle, 3);
        int32_t cell[3];
        memcpy(cell, range.low, sizeof cell);
        do {
            const uint32_t bucket = bucket_of(hash, cell);
            for (uint32_t i = hash->starts[bucket]; i < hash->starts[bucket + 1]; i++) {
                const cell_entry *entry = &hash->entries[i];
                if (memcmp(entry->cell, cell, sizeof cell) != 0) continue;
                const uint32_t *edge = hash->edges[entry->edge];
                if (share_vertex(edge, triangle)) continue;
                if (!is_first_common(cell, &range, &hash->ranges[entry->edge])) continue;
                if (!boxes_meet(positions, edge, triangle)) continue;
                if (edge_meets_triangle(positions, edge, triangle)) (*count)++;
            }
        } while (next_cell(&range, cell));
    }
    return true;
}
