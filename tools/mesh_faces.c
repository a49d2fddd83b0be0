/*
 * The file's own faces and objects; see mesh_faces.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "mesh_faces.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

uint32_t mesh_face_of(const mesh_file *mesh, uint32_t triangle)
{
    return mesh->face_of_triangle ? mesh->face_of_triangle[triangle] : triangle;
}

uint32_t mesh_object_of(const mesh_file *mesh, uint32_t triangle)
{
    if (mesh->object_of_face) return mesh->object_of_face[mesh_face_of(mesh, triangle)];
    return mesh->object_count ? 0 : MESH_NO_OBJECT;
}

const char *mesh_object_name(const mesh_file *mesh, uint32_t object)
{
    return object < mesh->object_count ? mesh->object_names[object] : "";
}

uint32_t *mesh_vertex_objects(const mesh_file *mesh)
{
    const size_t count = mesh->vertex_count;
    uint32_t *objects = (uint32_t *)malloc((count + 1) * sizeof(uint32_t));
    if (!objects) return NULL;
    for (size_t v = 0; v < count; v++) objects[v] = MESH_NO_OBJECT;
    for (uint32_t t = mesh->triangle_count; t-- > 0;) { /* the first one is written last */
        for (size_t k = 0; k < 3; k++)
            objects[mesh->indices[3 * (size_t)t + k]] = mesh_object_of(mesh, t);
    }
    return objects;
}

bool mesh_tally_add(mesh_tally *tally, uint32_t a, uint32_t b)
{
    const uint32_t low = a < b ? a : b, high = a < b ? b : a;
    /* pairs come sorted, so that many in a row are between the same two */
    if (tally->count > 0) {
        mesh_object_pairs *last = &tally->entries[tally->count - 1];
        if (last->a == low && last->b == high) {
            last->pairs++;
            return true;
        }
    }
    if (tally->count == tally->capacity) {
        const size_t capacity = tally->capacity ? 2 * tally->capacity : 64;
        mesh_object_pairs *entries =
            capacity > SIZE_MAX / sizeof *entries
                ? NULL
                : (mesh_object_pairs *)realloc(tally->entries, capacity * sizeof *entries);
        if (!entries) return false;
        tally->entries = entries;
        tally->capacity = capacity;
    }
    const mesh_object_pairs entry = {low, high, 1};
    tally->entries[tally->count++] = entry;
    return true;
}

static int by_objects(const void *one, const void *other)
{
    const mesh_object_pairs *p = (const mesh_object_pairs *)one;
    const mesh_object_pairs *q = (const mesh_object_pairs *)other;
    if (p->a != q->a) return p->a < q->a ? -1 : 1;
    return p->b < q->b ? -1 : p->b > q->b;
}

static int by_pairs(const void *one, const void *other)
{
    const mesh_object_pairs *p = (const mesh_object_pairs *)one;
    const mesh_object_pairs *q = (const mesh_object_pairs *)other;
    if (p->pairs != q->pairs) return p->pairs > q->pairs ? -1 : 1;
    return by_objects(one, other);
}

void mesh_tally_sort(mesh_tally *tally)
{
    size_t kept = 0;
    if (!tally->count) return;
    qsort(tally->entries, tally->count, sizeof *tally->entries, by_objects);
    for (size_t i = 1; i < tally->count; i++) {
        if (by_objects(&tally->entries[kept], &tally->entries[i]) == 0)
            tally->entries[kept].pairs += tally->entries[i].pairs;
        else
            tally->entries[++kept] = tally->entries[i];
    }
    tally->count = kept + 1;
    qsort(tally->entries, tally->count, sizeof *tally->entries, by_pairs);
}

void mesh_print_name(const char *name)
{
    if (!*name) fputs("(unnamed)", stdout);
    for (; *name; name++) putchar((unsigned char)*name < 32 || *name == 127 ? '?' : *name);
}

void mesh_tally_print(const mesh_tally *tally, const mesh_file *mesh)
{
    enum { MOST = 12 };
    if (!tally->count) return;
    fputs("    ", stdout);
    for (size_t i = 0; i < tally->count && i < MOST; i++) {
        if (i) fputs(", ", stdout);
        mesh_print_name(mesh_object_name(mesh, tally->entries[i].a));
        fputs(" / ", stdout);
        mesh_print_name(mesh_object_name(mesh, tally->entries[i].b));
        printf(" %.0f", (double)tally->entries[i].pairs);
    }
    if (tally->count > MOST)
        printf(", and %lu more (--json has all)", (unsigned long)(tally->count - MOST));
    puts("");
}

void mesh_tally_free(mesh_tally *tally)
{
    free(tally->entries);
    memset(tally, 0, sizeof *tally);
}
