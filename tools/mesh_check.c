/*
 * Defects of a mesh, and its parts; see mesh_check.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "mesh_check.h"

#include "task_loop.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ------------------------------------------------------------------------------------------------
 * Sets
 */

uint32_t mesh_sets_find(uint32_t *parents, uint32_t item)
{
    while (parents[item] != item) {
        parents[item] = parents[parents[item]];
        item = parents[item];
    }
    return item;
}

void mesh_sets_join(uint32_t *parents, uint32_t one, uint32_t other)
{
    one = mesh_sets_find(parents, one);
    other = mesh_sets_find(parents, other);
    if (one < other)
        parents[other] = one;
    else
        parents[one] = other;
}

/* ------------------------------------------------------------------------------------------------
 * Parts
 */

static uint32_t vertex_of(const mesh_file *mesh, const uint32_t *weld_map, size_t corner)
{
    const uint32_t vertex = mesh->indices[corner];
    return weld_map ? weld_map[vertex] : vertex;
}

/* Numbers the parts in the order of their first triangles. parents has an entry for each vertex. */
static bool find_parts(mesh_check *check, const mesh_file *mesh, const uint32_t *weld_map,
                       uint32_t *parents)
{
    const size_t triangles = mesh->triangle_count;
    for (uint32_t v = 0; v < mesh->vertex_count; v++) parents[v] = v;
    for (size_t t = 0; t < triangles; t++) {
        const uint32_t first = vertex_of(mesh, weld_map, 3 * t);
        mesh_sets_join(parents, first, vertex_of(mesh, weld_map, 3 * t + 1));
        mesh_sets_join(parents, first, vertex_of(mesh, weld_map, 3 * t + 2));
    }
    /* by the set's vertex at first; a vertex is marked when its part has a number */
    for (size_t t = 0; t < triangles; t++)
        check->part_of_triangle[t] = mesh_sets_find(parents, vertex_of(mesh, weld_map, 3 * t));
    for (uint32_t v = 0; v < mesh->vertex_count; v++) parents[v] = UINT32_MAX;
    for (size_t t = 0; t < triangles; t++) {
        uint32_t *number = &parents[check->part_of_triangle[t]];
        if (*number == UINT32_MAX) *number = check->part_count++;
        check->part_of_triangle[t] = *number;
    }
    check->parts = (mesh_part *)calloc((size_t)check->part_count + 1, sizeof *check->parts);
    if (!check->parts) return false;
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        mesh_part *part = &check->parts[check->part_of_triangle[t]];
        if (part->triangle_count++ == 0) part->first = t;
    }
    return true;
}

bool mesh_part_is_closed(const mesh_part *part)
{
    return part->sides > 0 && part->open_edges == 0 && part->non_manifold_edges == 0;
}

void mesh_check_free(mesh_check *check)
{
    free(check->parts);
    free(check->part_of_triangle);
    memset(check, 0, sizeof *check);
}

/* ------------------------------------------------------------------------------------------------
 * Edges and faces, from lists of the sides at their lower vertices
 */

/* A side of a triangle with three different vertices, without its lower vertex. */
typedef struct entry {
    uint32_t high;  /* its higher vertex */
    uint32_t other; /* the triangle's third one */
    uint32_t side;  /* 2 t of triangle t, or 2 t + 1 if it runs from the higher vertex */
} entry;

/* Each thread makes the lists of a range of vertices, for which it reads all triangles. */
typedef struct list_maker {
    mesh_check *check;
    const mesh_file *mesh;
    const uint32_t *weld_map;
    uint32_t *ends; /* of each vertex: the number of its entries, then where they end */
    entry *entries; /* by vertices; before they are there, the room that find_parts needs */
    bool has_parts; /* whether find_parts had memory enough */
    uint32_t ranges;
    uint32_t begins[SC_WORKERS_MAX + 1]; /* where the entries of each range begin */
} list_maker;

/* The first vertex of a range. */
static uint32_t first_of(const list_maker *make, uint32_t range)
{
    return (uint32_t)((uint64_t)make->mesh->vertex_count * range / make->ranges);
}

/* The three vertices of a triangle; false if two are equal. */
static bool read_triangle(const list_maker *make, size_t triangle, uint32_t v[3])
{
    for (size_t k = 0; k < 3; k++) v[k] = vertex_of(make->mesh, make->weld_map, 3 * triangle + k);
    return v[0] != v[1] && v[1] != v[2] && v[2] != v[0];
}

static uint32_t lower(uint32_t a, uint32_t b)
{
    return a < b ? a : b;
}

/* Counts the entries of each vertex of a range. */
static void count_entries(list_maker *make, uint32_t range)
{
    const uint32_t first = first_of(make, range), vertices = first_of(make, range + 1) - first;
    uint32_t *counts = make->ends + first;
    uint32_t v[3], total = 0;
    memset(counts, 0, vertices * sizeof *counts);
    for (size_t t = 0; t < make->mesh->triangle_count; t++) {
        if (!read_triangle(make, t, v)) continue;
        for (size_t k = 0; k < 3; k++) {
            const uint32_t low = lower(v[k], v[(k + 1) % 3]) - first;
            if (low < vertices) counts[low]++;
        }
    }
    for (size_t i = 0; i < vertices; i++) total += counts[i];
    make->begins[range + 1] = total;
}

/* Puts the entries of a range where they belong. */
static void fill_entries(list_maker *make, uint32_t range)
{
    const uint32_t first = first_of(make, range), vertices = first_of(make, range + 1) - first;
    uint32_t *ends = make->ends + first;
    uint32_t v[3], begin = make->begins[range];
    for (size_t i = 0; i < vertices; i++) {
        const uint32_t count = ends[i];
        ends[i] = begin;
        begin += count;
    }
    for (size_t t = 0; t < make->mesh->triangle_count; t++) {
        if (!read_triangle(make, t, v)) continue;
        for (size_t k = 0; k < 3; k++) {
            const uint32_t from = v[k], to = v[(k + 1) % 3], other = v[(k + 2) % 3];
            const uint32_t low = lower(from, to) - first;
            if (low >= vertices) continue;
            const entry made = {from < to ? to : from, other, (uint32_t)(2 * t + (from > to))};
            make->entries[ends[low]++] = made;
        }
    }
}

static int compare_entries(const void *left, const void *right)
{
    const entry *a = (const entry *)left;
    const entry *b = (const entry *)right;
    if (a->high != b->high) return a->high < b->high ? -1 : 1;
    if (a->other != b->other) return a->other < b->other ? -1 : 1;
    return a->side < b->side ? -1 : a->side > b->side;
}

/* Few entries, as nearly all lists have, are sorted faster without calls. */
static void sort_entries(entry *entries, size_t count)
{
    if (count > 24) {
        qsort(entries, count, sizeof *entries, compare_entries);
        return;
    }
    for (size_t i = 1; i < count; i++) {
        const entry moved = entries[i];
        size_t at = i;
        for (; at > 0 && compare_entries(&moved, &entries[at - 1]) < 0; at--)
            entries[at] = entries[at - 1];
        entries[at] = moved;
    }
}

/* Adds counts of edges to those of their part, to which other threads may add theirs. */
static void add_counts(mesh_part *part, const mesh_part *counts)
{
    __atomic_fetch_add(&part->sides, counts->sides, __ATOMIC_RELAXED);
    __atomic_fetch_add(&part->open_edges, counts->open_edges, __ATOMIC_RELAXED);
    __atomic_fetch_add(&part->non_manifold_edges, counts->non_manifold_edges, __ATOMIC_RELAXED);
    __atomic_fetch_add(&part->misoriented_edges, counts->misoriented_edges, __ATOMIC_RELAXED);
}

/* Counts an edge with its sides. */
static void count_edge(mesh_part *counts, const entry *sides, size_t count)
{
    counts->sides += (uint32_t)count;
    if (count == 1)
        counts->open_edges++;
    else if (count > 2)
        counts->non_manifold_edges++;
    else
        counts->misoriented_edges += ((sides[0].side ^ sides[1].side) & 1) == 0;
}

/* How many of the triangles at an edge have the vertices of another one before it. A triangle is
   counted at the edge of its two lower vertices. */
static uint32_t count_equal(const entry *sides, size_t count)
{
    uint32_t equal = 0;
    for (size_t i = 1; i < count; i++)
        equal += sides[i].other == sides[i - 1].other && sides[i].other > sides[i].high;
    return equal;
}

/* Counts the edges and the equal triangles of a range, whose entries are filled in. Edges that
   follow each other are nearly always of one part. */
static void count_edges(list_maker *make, uint32_t range)
{
    const uint32_t last = first_of(make, range + 1);
    mesh_check *check = make->check;
    mesh_part counts;
    uint32_t part = 0, equal = 0;
    memset(&counts, 0, sizeof counts);
    for (uint32_t low = first_of(make, range), begin = make->begins[range]; low < last; low++) {
        const uint32_t end = make->ends[low];
        entry *entries = make->entries;
        if (begin == end) continue;
        sort_entries(entries + begin, end - begin);
        /* all triangles at a vertex are of one part */
        const uint32_t of_these = check->part_of_triangle[entries[begin].side / 2];
        if (of_these != part) {
            add_counts(&check->parts[part], &counts);
            memset(&counts, 0, sizeof counts);
            part = of_these;
        }
        for (uint32_t next; begin < end; begin = next) {
            for (next = begin + 1; next < end && entries[next].high == entries[begin].high;) next++;
            count_edge(&counts, entries + begin, next - begin);
            equal += count_equal(entries + begin, next - begin);
        }
    }
    if (counts.sides) add_counts(&check->parts[part], &counts);
    __atomic_fetch_add(&check->duplicate_faces, equal, __ATOMIC_RELAXED);
}

static void run_first(void *context, uint32_t part, uint32_t worker)
{
    list_maker *make = (list_maker *)context;
    (void)worker;
    if (part == 0)
        make->has_parts =
            find_parts(make->check, make->mesh, make->weld_map, (uint32_t *)make->entries);
    else
        count_entries(make, part - 1);
}

static void run_second(void *context, uint32_t part, uint32_t worker)
{
    list_maker *make = (list_maker *)context;
    (void)worker;
    fill_entries(make, part);
    count_edges(make, part);
}

/* Fills in the check; false if there is no memory. */
static bool make_check(list_maker *make, const sc_tasks *tasks)
{
    mesh_check *check = make->check;
    const size_t triangles = make->mesh->triangle_count;
    const size_t of_vertices = ((size_t)make->mesh->vertex_count + 1) * sizeof(uint32_t);
    const size_t of_entries = (3 * triangles + 1) * sizeof(entry);
    check->part_of_triangle = (uint32_t *)malloc((triangles + 1) * sizeof(uint32_t));
    make->ends = (uint32_t *)malloc(of_vertices);
    make->entries = (entry *)malloc(of_entries > of_vertices ? of_entries : of_vertices);
    if (!check->part_of_triangle || !make->ends || !make->entries) return false;
    task_parts(tasks, 1 + make->ranges, run_first, make);
    if (!make->has_parts) return false;
    for (uint32_t i = 0; i < make->ranges; i++) make->begins[i + 1] += make->begins[i];
    task_parts(tasks, make->ranges, run_second, make);
    for (uint32_t i = 0; i < check->part_count; i++) {
        check->open_edges += check->parts[i].open_edges;
        check->non_manifold_edges += check->parts[i].non_manifold_edges;
        check->misoriented_edges += check->parts[i].misoriented_edges;
        check->closed_parts += mesh_part_is_closed(&check->parts[i]);
    }
    return true;
}

bool mesh_check_make(mesh_check *check, const mesh_file *mesh, const uint32_t *weld_map,
                     const sc_tasks *tasks)
{
    list_maker make;
    memset(check, 0, sizeof *check);
    memset(&make, 0, sizeof make);
    make.check = check;
    make.mesh = mesh;
    make.weld_map = weld_map;
    make.ranges = task_workers(tasks);
    const bool made = make_check(&make, tasks);
    free(make.ends);
    free(make.entries);
    if (!made) mesh_check_free(check);
    return made;
}

/* ------------------------------------------------------------------------------------------------
 * Area
 */

/* Adds a double to a sum of doubles that do not overlap, smallest first, without any rounding:
   Shewchuk, Adaptive Precision Floating-Point Arithmetic, 1997, Grow-Expansion. */
static void add_exactly(double *sum, int *count, double value)
{
    for (int i = 0; i < *count; i++) {
        const double total = value + sum[i], part = total - value;
        const double error = (value - (total - part)) + (sum[i] - part);
        sum[i] = error;
        value = total;
    }
    sum[(*count)++] = value;
}

/* Adds x y; fma gives what rounding takes from the product. */
static void add_product(double *sum, int *count, double x, double y)
{
    const double product = x * y;
    add_exactly(sum, count, fma(x, y, -product));
    add_exactly(sum, count, product);
}

/* Whether three points of the plane are on a line. */
static bool on_a_line(double ax, double ay, double bx, double by, double cx, double cy)
{
    const double left = (ax - cx) * (by - cy), right = (ay - cy) * (bx - cx);
    /* Each factor is off by half an epsilon of itself, each product and the difference by another
       one: 4 epsilon of |left| + |right| is more than all of it. */
    if (fabs(left - right) > 4 * DBL_EPSILON * (fabs(left) + fabs(right))) return false;
    double sum[12];
    int count = 0;
    add_product(sum, &count, ax, by);
    add_product(sum, &count, -ax, cy);
    add_product(sum, &count, -cx, by);
    add_product(sum, &count, -ay, bx);
    add_product(sum, &count, ay, cx);
    add_product(sum, &count, cy, bx);
    for (int i = 0; i < count; i++) {
        if (sum[i] != 0) return false; /* they do not overlap, so they cannot cancel out */
    }
    return true;
}

/* Triangles without area are counted by several threads. */
typedef struct area_counter {
    const mesh_file *mesh;
    const void *positions;
    uint32_t position_type;
    uint32_t count;
} area_counter;

static void count_degenerate(void *context, size_t begin, size_t end)
{
    area_counter *all = (area_counter *)context;
    uint32_t count = 0;
    for (size_t t = begin; t < end; t++) {
        double p[3][3];
        for (size_t k = 0; k < 3; k++)
            mesh_file_position(all->positions, all->position_type, all->mesh->indices[3 * t + k],
                               p[k]);
        bool flat = true;
        for (size_t x = 0, y = 1; x < 3 && flat; x++, y = (x + 1) % 3)
            flat = on_a_line(p[0][x], p[0][y], p[1][x], p[1][y], p[2][x], p[2][y]);
        count += flat;
    }
    __atomic_fetch_add(&all->count, count, __ATOMIC_RELAXED);
}

uint32_t mesh_check_degenerate(const mesh_file *mesh, const void *positions, uint32_t position_type,
                               const sc_tasks *tasks)
{
    area_counter all = {mesh, positions, position_type, 0};
    task_loop(tasks, mesh->triangle_count, count_degenerate, &all);
    return all.count;
}
