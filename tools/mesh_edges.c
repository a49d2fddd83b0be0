/*
 * Sorted sides of triangles; see mesh_edges.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "mesh_edges.h"

#include <stdlib.h>

static int compare_sides(const void *left, const void *right)
{
    const mesh_side *a = (const mesh_side *)left;
    const mesh_side *b = (const mesh_side *)right;
    if (a->low != b->low) return a->low < b->low ? -1 : 1;
    if (a->high != b->high) return a->high < b->high ? -1 : 1;
    return a->corner < b->corner ? -1 : a->corner > b->corner;
}

mesh_side *mesh_edges_sort(const mesh_file *mesh)
{
    const size_t count = 3 * (size_t)mesh->triangle_count;
    mesh_side *sides = (mesh_side *)malloc(count * sizeof *sides);
    if (!sides) return NULL;
    for (size_t c = 0; c < count; c++) {
        const uint32_t from = mesh->indices[c];
        const uint32_t to = mesh->indices[c % 3 == 2 ? c - 2 : c + 1];
        sides[c].low = from < to ? from : to;
        sides[c].high = from < to ? to : from;
        sides[c].corner = (uint32_t)c;
    }
    qsort(sides, count, sizeof *sides, compare_sides);
    return sides;
}

bool mesh_edges_is_forward(const mesh_file *mesh, const mesh_side *side)
{
    return mesh->indices[side->corner] == side->low;
}

size_t mesh_edges_run(const mesh_side *sides, size_t begin, size_t count)
{
    size_t end = begin + 1;
    while (end < count && sides[end].low == sides[begin].low &&
           sides[end].high == sides[begin].high) {
        end++;
    }
    return end - begin;
}
