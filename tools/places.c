/*
 * Colliding pairs, joined into places; see places.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "places.h"

#include "mesh_faces.h"

#include <stdlib.h>
#include <string.h>

void places_triangles(uint32_t kind, sc_pair pair, uint32_t triangle[2])
{
    triangle[0] = kind == SC_PAIRS_EDGE ? pair.a / 3 : pair.a;
    triangle[1] = pair.b;
}

void place_center(const place *one, double center[3])
{
    for (int k = 0; k < 3; k++) center[k] = 0.5 * one->low[k] + 0.5 * one->high[k];
}

void place_size(const place *one, double size[3])
{
    for (int k = 0; k < 3; k++) size[k] = one->high[k] - one->low[k];
}

void place_color(uint32_t number, uint8_t color[3])
{
    static const uint8_t colors[8][3] = {{220, 30, 30},  {30, 110, 220}, {240, 150, 20},
                                         {20, 150, 80},  {160, 60, 190}, {230, 90, 150},
                                         {20, 160, 180}, {150, 120, 30}};
    memcpy(color, colors[number % 8], 3);
}

void places_free(place_list *list)
{
    free(list->places);
    free(list->triangles);
    free(list->owners);
    free(list->segments);
    memset(list, 0, sizeof *list);
}

static int compare_places(const void *left, const void *right)
{
    const place *a = (const place *)left;
    const place *b = (const place *)right;
    if (a->face_count != b->face_count) return a->face_count > b->face_count ? -1 : 1;
    if (a->pairs != b->pairs) return a->pairs > b->pairs ? -1 : 1;
    return a->begin < b->begin ? -1 : a->begin > b->begin; /* the lower first triangle */
}

static int compare_numbers(const void *left, const void *right)
{
    const uint32_t a = *(const uint32_t *)left, b = *(const uint32_t *)right;
    return a < b ? -1 : a > b;
}

/* What is needed while places are made. Of arrays as large as the mesh only what belongs to
   colliding triangles is read or written, so that where few collide, little memory is used. */
typedef struct maker {
    const place_source *from;
    uint32_t *colliding; /* these triangles, in order */
    uint32_t colliding_count;
    uint32_t *parents;  /* sets of triangles */
    uint32_t *vertices; /* for each 1 + the first colliding triangle that has it, or 0 */
    uint32_t *place_of; /* for each triangle */
} maker;

/* Lists the colliding triangles. */
static bool list_colliding(maker *make)
{
    const place_source *from = make->from;
    const uint32_t triangles = from->mesh->triangle_count;
    uint8_t *collides = (uint8_t *)calloc((size_t)triangles + 1, 1);
    uint32_t pair[2], count = 0;
    if (!collides) return false;
    for (uint64_t i = 0; i < from->pair_count; i++) {
        places_triangles(from->kind, from->pairs[i], pair);
        collides[pair[0]] = collides[pair[1]] = 1;
    }
    for (uint32_t t = 0; t < triangles; t++) count += collides[t];
    make->colliding = (uint32_t *)malloc(((size_t)count + 1) * sizeof(uint32_t));
    for (uint32_t t = 0; make->colliding && t < triangles; t++) {
        if (collides[t]) make->colliding[make->colliding_count++] = t;
    }
    free(collides);
    return make->colliding != NULL;
}

/* Joins triangles that collide with each other, and those of them that share a vertex. */
static void join_triangles(maker *make)
{
    const place_source *from = make->from;
    uint32_t pair[2];
    for (uint32_t i = 0; i < make->colliding_count; i++)
        make->parents[make->colliding[i]] = make->colliding[i];
    for (uint64_t i = 0; i < from->pair_count; i++) {
        places_triangles(from->kind, from->pairs[i], pair);
        mesh_sets_join(make->parents, pair[0], pair[1]);
    }
    for (uint32_t i = 0; i < make->colliding_count; i++) {
        const uint32_t t = make->colliding[i];
        for (size_t k = 0; k < 3; k++) {
            uint32_t v = from->mesh->indices[3 * (size_t)t + k];
            if (from->weld_map) v = from->weld_map[v];
            if (make->vertices[v] == 0) make->vertices[v] = t + 1;
            mesh_sets_join(make->parents, make->vertices[v] - 1, t);
        }
    }
}

/* Makes the places with their triangles, in the order of their first triangles: the set of a
   triangle is told by its lowest one. */
static bool make_places(place_list *list, maker *make)
{
    const uint32_t *own = make->colliding;
    list->triangle_count = make->colliding_count;
    for (uint32_t i = 0; i < list->triangle_count; i++) {
        const uint32_t set = mesh_sets_find(make->parents, own[i]);
        make->place_of[own[i]] = set == own[i] ? list->count++ : make->place_of[set];
    }
    list->places = (place *)calloc((size_t)list->count + 1, sizeof *list->places);
    list->triangles = (uint32_t *)malloc(((size_t)list->triangle_count + 1) * sizeof(uint32_t));
    if (!list->places || !list->triangles) return false;
    for (uint32_t i = 0; i < list->triangle_count; i++)
        list->places[make->place_of[own[i]]].triangle_count++;
    size_t begin = 0;
    for (uint32_t i = 0; i < list->count; i++) {
        list->places[i].begin = begin;
        begin += list->places[i].triangle_count;
        list->places[i].triangle_count = 0;
        list->places[i].depth = -1;
    }
    for (uint32_t i = 0; i < list->triangle_count; i++) {
        place *one = &list->places[make->place_of[own[i]]];
        list->triangles[one->begin + one->triangle_count++] = own[i];
    }
    return true;
}

/* Sorts numbers and keeps one of each; returns how many. */
static uint32_t sort_numbers(uint32_t *numbers, uint32_t count)
{
    uint32_t kept = 0;
    qsort(numbers, count, sizeof *numbers, compare_numbers);
    for (uint32_t i = 0; i < count; i++) {
        if (kept == 0 || numbers[kept - 1] != numbers[i]) numbers[kept++] = numbers[i];
    }
    return kept;
}

/* Faces, objects and parts of each place. owners has room for two numbers a triangle. */
static bool find_owners(place_list *list, const place_source *from)
{
    size_t end = 0;
    list->owners = (uint32_t *)malloc((2 * (size_t)list->triangle_count + 1) * sizeof(uint32_t));
    if (!list->owners) return false;
    for (uint32_t i = 0; i < list->count; i++) {
        place *one = &list->places[i];
        const uint32_t *triangles = list->triangles + one->begin;
        for (uint32_t j = 0; j < one->triangle_count; j++) { /* faces ascend with triangles */
            one->face_count += j == 0 || mesh_face_of(from->mesh, triangles[j]) !=
                                             mesh_face_of(from->mesh, triangles[j - 1]);
        }
        one->objects = end;
        for (uint32_t j = 0; j < one->triangle_count; j++)
            list->owners[end + j] = mesh_object_of(from->mesh, triangles[j]);
        one->object_count = sort_numbers(list->owners + end, one->triangle_count);
        if (from->mesh->object_count == 0) one->object_count = 0;
        end += one->object_count;
        one->parts = end;
        for (uint32_t j = 0; j < one->triangle_count; j++)
            list->owners[end + j] = from->check->part_of_triangle[triangles[j]];
        one->part_count = sort_numbers(list->owners + end, one->triangle_count);
        end += one->part_count;
    }
    return true;
}

static void grow_box(place *one, const sc_contact *contact)
{
    const int ends = contact->kind == SC_MEET_POINT ? 1 : 2;
    for (int end = 0; end < ends; end++) {
        for (int k = 0; k < 3; k++) {
            const double x = contact->points[end][k];
            const bool first = one->pairs == 0 && end == 0;
            if (first || x < one->low[k]) one->low[k] = x;
            if (first || x > one->high[k]) one->high[k] = x;
        }
    }
}

/* Pairs and box of each place, from where its pairs meet. */
static sc_status measure_places(place_list *list, const maker *make)
{
    enum { BATCH = 256 };
    const place_source *from = make->from;
    sc_contact contacts[BATCH];
    list->segment_count =
        from->pair_count < PLACES_SEGMENTS ? (uint32_t)from->pair_count : PLACES_SEGMENTS;
    list->segments =
        (double(*)[2][3])malloc((size_t)list->segment_count * sizeof *list->segments + 1);
    if (!list->segments) return SC_ERROR_MEMORY;
    for (uint64_t begin = 0; begin < from->pair_count; begin += BATCH) {
        const uint64_t rest = from->pair_count - begin, count = rest < BATCH ? rest : BATCH;
        const sc_status status =
            sc_contacts(from->model, from->pose, from->kind, from->pairs + begin, count, contacts);
        if (status != SC_OK) return status;
        for (uint64_t i = 0; i < count; i++) {
            uint32_t triangle[2];
            places_triangles(from->kind, from->pairs[begin + i], triangle);
            place *one = &list->places[make->place_of[triangle[0]]];
            grow_box(one, &contacts[i]);
            one->pairs++;
            if (begin + i >= list->segment_count) continue;
            double(*segment)[3] = list->segments[begin + i];
            memcpy(segment, contacts[i].points, sizeof contacts[i].points);
            if (contacts[i].kind == SC_MEET_POINT)
                memcpy(segment[1], segment[0], sizeof segment[0]);
        }
    }
    return SC_OK;
}

sc_status places_make(place_list *list, const place_source *from)
{
    const size_t triangles = (size_t)from->mesh->triangle_count + 1;
    memset(list, 0, sizeof *list);
    if (from->pair_count == 0) return SC_OK;
    maker make;
    memset(&make, 0, sizeof make);
    make.from = from;
    make.parents = (uint32_t *)malloc(triangles * sizeof(uint32_t));
    make.vertices = (uint32_t *)calloc((size_t)from->mesh->vertex_count + 1, sizeof(uint32_t));
    make.place_of = (uint32_t *)malloc(triangles * sizeof(uint32_t));
    sc_status status = SC_ERROR_MEMORY;
    if (make.parents && make.vertices && make.place_of && list_colliding(&make)) {
        join_triangles(&make);
        if (make_places(list, &make) && find_owners(list, from))
            status = measure_places(list, &make);
        if (status == SC_OK) qsort(list->places, list->count, sizeof *list->places, compare_places);
    }
    free(make.colliding);
    free(make.parents);
    free(make.vertices);
    free(make.place_of);
    if (status != SC_OK) places_free(list);
    return status;
}
