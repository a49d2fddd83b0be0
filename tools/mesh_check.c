/*
 * Defects of a mesh, and its parts; see mesh_check.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "mesh_check.h"

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
 * Edges and faces, in lists of their lowest vertices
 */

/* A side of a triangle, or a triangle, without its lowest vertex. */
typedef struct entry {
    uint32_t middle, high;
    uint32_t corner; /* 3 t + k of a side as in mesh_edges.h; of a triangle its number */
} entry;

/* Entries by their lowest vertices: those of v are from starts[v] up to starts[v + 1]. */
typedef struct entry_lists {
    uint32_t *starts;
    entry *entries;
} entry_lists;

static uint32_t vertex_of(const mesh_file *mesh, const uint32_t *weld_map, size_t corner)
{
    const uint32_t vertex = mesh->indices[corner];
    return weld_map ? weld_map[vertex] : vertex;
}

/* The three vertices of a triangle in ascending order; false if two are equal. */
static bool sorted_vertices(const mesh_file *mesh, const uint32_t *weld_map, size_t triangle,
                            uint32_t v[3])
{
    for (size_t k = 0; k < 3; k++) {
        uint32_t vertex = vertex_of(mesh, weld_map, 3 * triangle + k);
        for (size_t i = 0; i < k; i++) {
            if (vertex >= v[i]) continue;
            const uint32_t larger = v[i];
            v[i] = vertex;
            vertex = larger;
        }
        v[k] = vertex;
    }
    return v[0] != v[1] && v[1] != v[2];
}

/* An entry of a triangle, of those that it has: its sides, or itself. Returns its lowest vertex. */
static uint32_t make_entry(const mesh_file *mesh, const uint32_t *weld_map, size_t triangle,
                           size_t side, bool of_sides, entry *made)
{
    if (!of_sides) {
        uint32_t v[3];
        sorted_vertices(mesh, weld_map, triangle, v);
        *made = (entry){v[1], v[2], (uint32_t)triangle};
        return v[0];
    }
    const size_t corner = 3 * triangle + side;
    const uint32_t from = vertex_of(mesh, weld_map, corner);
    const uint32_t to = vertex_of(mesh, weld_map, 3 * triangle + (side + 1) % 3);
    *made = (entry){0, from < to ? to : from, (uint32_t)corner};
    return from < to ? from : to;
}

static int compare_entries(const void *left, const void *right)
{
    const entry *a = (const entry *)left;
    const entry *b = (const entry *)right;
    if (a->middle != b->middle) return a->middle < b->middle ? -1 : 1;
    if (a->high != b->high) return a->high < b->high ? -1 : 1;
    return a->corner < b->corner ? -1 : a->corner > b->corner;
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

/* Fills the lists with all sides, or all triangles, of triangles with three different vertices. */
static void fill_lists(entry_lists *lists, const mesh_file *mesh, const uint32_t *weld_map,
                       bool of_sides)
{
    const size_t vertices = mesh->vertex_count, each = of_sides ? 3 : 1;
    uint32_t v[3];
    entry made;
    memset(lists->starts, 0, (vertices + 2) * sizeof *lists->starts);
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        if (!sorted_vertices(mesh, weld_map, t, v)) continue;
        for (size_t k = 0; k < each; k++)
            lists->starts[make_entry(mesh, weld_map, t, k, of_sides, &made) + 2]++;
    }
    /* shifted by one, so that filling moves each start to where it belongs */
    for (size_t i = 2; i < vertices + 2; i++) lists->starts[i] += lists->starts[i - 1];
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        if (!sorted_vertices(mesh, weld_map, t, v)) continue;
        for (size_t k = 0; k < each; k++) {
            const uint32_t low = make_entry(mesh, weld_map, t, k, of_sides, &made);
            lists->entries[lists->starts[low + 1]++] = made;
        }
    }
    for (size_t i = 0; i < vertices; i++)
        sort_entries(lists->entries + lists->starts[i], lists->starts[i + 1] - lists->starts[i]);
}

/* Counts an edge with its sides: entries of one list. */
static void count_edge(mesh_check *check, const mesh_file *mesh, const uint32_t *weld_map,
                       uint32_t low, const entry *sides, size_t count)
{
    mesh_part *part = &check->parts[check->part_of_triangle[sides->corner / 3]];
    part->sides += (uint32_t)count;
    if (count == 1) {
        part->open_edges++;
        check->open_edges++;
    } else if (count > 2) {
        part->non_manifold_edges++;
        check->non_manifold_edges++;
    } else if ((vertex_of(mesh, weld_map, sides[0].corner) == low) ==
               (vertex_of(mesh, weld_map, sides[1].corner) == low)) {
        part->misoriented_edges++;
        check->misoriented_edges++;
    }
}

static void count_edges(mesh_check *check, const mesh_file *mesh, const uint32_t *weld_map,
                        const entry_lists *lists)
{
    for (uint32_t low = 0; low < mesh->vertex_count; low++) {
        const size_t end = lists->starts[low + 1];
        for (size_t i = lists->starts[low], next; i < end; i = next) {
            for (next = i + 1; next < end && lists->entries[next].high == lists->entries[i].high;)
                next++;
            count_edge(check, mesh, weld_map, low, lists->entries + i, next - i);
        }
    }
}

static void count_duplicates(mesh_check *check, const mesh_file *mesh, const entry_lists *lists)
{
    for (size_t low = 0; low < mesh->vertex_count; low++) {
        for (size_t i = lists->starts[low] + (size_t)1; i < lists->starts[low + 1]; i++) {
            const entry *one = &lists->entries[i];
            check->duplicate_faces += one->middle == one[-1].middle && one->high == one[-1].high;
        }
    }
}

/* ------------------------------------------------------------------------------------------------
 * Parts
 */

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

bool mesh_check_make(mesh_check *check, const mesh_file *mesh, const uint32_t *weld_map)
{
    const size_t triangles = mesh->triangle_count;
    memset(check, 0, sizeof *check);
    entry_lists lists;
    lists.starts = (uint32_t *)malloc(((size_t)mesh->vertex_count + 2) * sizeof *lists.starts);
    lists.entries = (entry *)malloc((3 * triangles + 1) * sizeof *lists.entries);
    check->part_of_triangle = (uint32_t *)malloc((triangles + 1) * sizeof(uint32_t));
    const bool made = lists.starts && lists.entries && check->part_of_triangle &&
                      find_parts(check, mesh, weld_map, lists.starts);
    if (made) {
        fill_lists(&lists, mesh, weld_map, true);
        count_edges(check, mesh, weld_map, &lists);
        fill_lists(&lists, mesh, weld_map, false);
        count_duplicates(check, mesh, &lists);
        for (uint32_t i = 0; i < check->part_count; i++)
            check->closed_parts += mesh_part_is_closed(&check->parts[i]);
    }
    free(lists.starts);
    free(lists.entries);
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

uint32_t mesh_check_degenerate(const mesh_file *mesh, const void *positions, uint32_t position_type)
{
    uint32_t count = 0;
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        double p[3][3];
        for (size_t k = 0; k < 3; k++)
            mesh_file_position(positions, position_type, mesh->indices[3 * t + k], p[k]);
        bool flat = true;
        for (size_t x = 0, y = 1; x < 3 && flat; x++, y = (x + 1) % 3)
            flat = on_a_line(p[0][x], p[0][y], p[1][x], p[1][y], p[2][x], p[2][y]);
        count += flat;
    }
    return count;
}
