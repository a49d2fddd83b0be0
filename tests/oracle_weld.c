/*
 * Which vertices are one: the part of the oracle that needs no big integers. See oracle.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "oracle.h"

#include <stdlib.h>
#include <string.h>

#include "harness.h"

typedef struct place {
    double position[3];
    uint32_t vertex;
} place;

static int compare_positions(const place *a, const place *b)
{
    for (int i = 0; i < 3; ++i) {
        if (a->position[i] < b->position[i]) return -1;
        if (a->position[i] > b->position[i]) return 1;
    }
    return 0;
}

static int compare_places(const void *left, const void *right)
{
    const place *a = (const place *)left, *b = (const place *)right;
    int order = compare_positions(a, b);
    return order != 0 ? order : a->vertex < b->vertex ? -1 : a->vertex > b->vertex;
}

void oracle_weld(const double *rest, uint32_t vertex_count, const uint32_t *triangles,
                 uint32_t triangle_count, uint32_t *weld)
{
    place *places = (place *)test_allocate(3 * (size_t)triangle_count * sizeof(place));
    uint32_t count = 3 * triangle_count, first = 0;
    for (uint32_t v = 0; v < vertex_count; ++v) weld[v] = v;
    for (uint32_t c = 0; c < count; ++c) {
        memcpy(places[c].position, rest + 3 * (size_t)triangles[c], sizeof(places[c].position));
        places[c].vertex = triangles[c];
    }
    qsort(places, count, sizeof(place), compare_places);
    for (uint32_t i = 0; i < count; ++i) {
        if (compare_positions(&places[first], &places[i]) != 0) first = i;
        weld[places[i].vertex] = places[first].vertex;
    }
    free(places);
}
