/*
 * Places, defects and parts, as sc-query lists them; see query_checks.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "query_checks.h"

#include "mesh_faces.h"
#include "place_depth.h"
#include "query_text.h"
#include "query_threads.h"

#include <stdlib.h>
#include <string.h>

enum {
    PLACES_PRINTED = 5,
    NAMES_PRINTED = 3, /* of objects or parts of a place */
    PARTS_LISTED = 1000
};

void query_checks_free(query_checks *checks)
{
    free(checks->weld_map);
    mesh_check_free(&checks->mesh);
    places_free(&checks->places);
    memset(checks, 0, sizeof *checks);
}

sc_status query_checks_mesh(query_checks *checks, const mesh_file *mesh,
                            const query_subject *subject, const query_settings *set)
{
    if (checks->is_made) return SC_OK;
    if (subject->weld_map) {
        const size_t size = (size_t)mesh->vertex_count * sizeof *checks->weld_map;
        checks->weld_map = (uint32_t *)malloc(size + 1);
        if (!checks->weld_map) return SC_ERROR_MEMORY;
        memcpy(checks->weld_map, subject->weld_map, size);
    } else if (set->weld == SC_WELD_REST && !subject->is_apart) {
        checks->weld_map = mesh_file_weld_map(mesh);
        if (!checks->weld_map) return SC_ERROR_MEMORY;
    }
    checks->is_made = mesh_check_make(&checks->mesh, mesh, checks->weld_map, query_threads_tasks());
    return checks->is_made ? SC_OK : SC_ERROR_MEMORY;
}

sc_status query_checks_pose(query_checks *checks, const mesh_file *mesh, const sc_model *model,
                            const sc_pose *pose, const query_settings *set, const query_list *list)
{
    places_free(&checks->places);
    checks->degenerate_faces =
        mesh_check_degenerate(mesh, pose->positions, pose->position_type, query_threads_tasks());
    checks->has_places = query_wants_places(set, mesh);
    if (!checks->has_places) return SC_OK;
    const place_source source = {
        mesh,        checks->weld_map, &checks->mesh,        model, pose, query_chosen_pairs(set),
        list->pairs, list->count,      query_threads_tasks()};
    const sc_status status = places_make(&checks->places, &source);
    if (status != SC_OK) return status;
    return place_depths(&checks->places, &source) ? SC_OK : SC_ERROR_MEMORY;
}

/* ------------------------------------------------------------------------------------------------
 * As text
 */

/* The names of the objects of a place, or, where the file names none, the numbers of its parts, if
   there are several. */
static void print_owners(const query_checks *checks, const mesh_file *mesh, const place *one)
{
    const uint32_t *owners = checks->places.owners;
    const bool named = one->object_count > 0;
    const uint32_t count = named ? one->object_count : one->part_count;
    if (!named && checks->mesh.part_count < 2) return;
    for (uint32_t i = 0; i < count && i < NAMES_PRINTED; i++) {
        fputs(i == 0 ? ", " : " / ", stdout);
        if (named)
            mesh_print_name(mesh_object_name(mesh, owners[one->objects + i]));
        else
            printf("part %lu", (unsigned long)owners[one->parts + i]);
    }
    if (count > NAMES_PRINTED) printf(" and %lu more", (unsigned long)(count - NAMES_PRINTED));
}

static void print_place(const query_checks *checks, const mesh_file *mesh, uint32_t number)
{
    const place *one = &checks->places.places[number];
    double center[3], size[3];
    place_center(one, center);
    place_size(one, size);
    printf("    place %lu: %lu faces, %.0f pairs", (unsigned long)number + 1,
           (unsigned long)one->face_count, (double)one->pairs);
    print_owners(checks, mesh, one);
    printf(", %.3g x %.3g x %.3g at %.6g %.6g %.6g", size[0], size[1], size[2], center[0],
           center[1], center[2]);
    if (one->depth >= 0) printf(", about %.2g deep", one->depth);
    puts("");
}

/* A number of something, if it is not 0, behind others. */
static void print_defect(const char *name, uint32_t count, bool *any)
{
    if (count == 0) return;
    printf("%s%s %lu", *any ? ", " : "    ", name, (unsigned long)count);
    *any = true;
}

void query_checks_print(const query_checks *checks, const mesh_file *mesh)
{
    const mesh_check *check = &checks->mesh;
    if (!checks->is_made) return;
    for (uint32_t i = 0; i < checks->places.count && i < PLACES_PRINTED; i++)
        print_place(checks, mesh, i);
    if (checks->places.count > PLACES_PRINTED)
        printf("    and %lu smaller places\n",
               (unsigned long)(checks->places.count - PLACES_PRINTED));
    bool any = false;
    print_defect("open edges", check->open_edges, &any);
    print_defect("non-manifold edges", check->non_manifold_edges, &any);
    print_defect("misoriented edges", check->misoriented_edges, &any);
    print_defect("degenerate faces", checks->degenerate_faces, &any);
    print_defect("duplicate faces", check->duplicate_faces, &any);
    if (any)
        printf("; %lu of %lu parts closed\n", (unsigned long)check->closed_parts,
               (unsigned long)check->part_count);
}

/* ------------------------------------------------------------------------------------------------
 * As JSON
 */

static void add_point(cJSON *object, const char *name, const double point[3])
{
    cJSON_AddItemToObject(object, name, cJSON_CreateDoubleArray(point, 3));
}

static void add_number(cJSON *array, uint32_t number)
{
    cJSON_AddItemToArray(array, cJSON_CreateNumber(number));
}

static cJSON *make_place(const place_list *list, const mesh_check *check, const mesh_file *mesh,
                         const place *one, bool has_triangles)
{
    cJSON *object = cJSON_CreateObject();
    double point[3];
    cJSON_AddNumberToObject(object, "faces", one->face_count);
    cJSON_AddNumberToObject(object, "triangles", one->triangle_count);
    cJSON_AddNumberToObject(object, "pairs", (double)one->pairs);
    place_center(one, point);
    add_point(object, "center", point);
    place_size(one, point);
    add_point(object, "size", point);
    if (one->depth >= 0)
        cJSON_AddNumberToObject(object, "depth", one->depth);
    else
        cJSON_AddNullToObject(object, "depth");
    cJSON *objects = cJSON_AddArrayToObject(object, "objects");
    for (uint32_t i = 0; i < one->object_count; i++) {
        const uint32_t owner = list->owners[one->objects + i];
        cJSON_AddItemToArray(objects, owner == MESH_NO_OBJECT
                                          ? cJSON_CreateNull()
                                          : cJSON_CreateString(mesh_object_name(mesh, owner)));
    }
    cJSON *parts = cJSON_AddArrayToObject(object, "parts");
    bool is_closed = true;
    for (uint32_t i = 0; i < one->part_count; i++) {
        const uint32_t part = list->owners[one->parts + i];
        add_number(parts, part);
        is_closed &= mesh_part_is_closed(&check->parts[part]);
    }
    cJSON_AddBoolToObject(object, "closed", is_closed);
    if (!has_triangles) return object;
    cJSON *triangles = cJSON_AddArrayToObject(object, "triangle_numbers");
    for (uint32_t i = 0; i < one->triangle_count; i++)
        add_number(triangles, list->triangles[one->begin + i]);
    return object;
}

cJSON *query_checks_places(const place_list *list, const mesh_check *check, const mesh_file *mesh,
                           uint32_t count, bool has_triangles)
{
    cJSON *array = cJSON_CreateArray();
    for (uint32_t i = 0; i < list->count && i < count; i++)
        cJSON_AddItemToArray(array, make_place(list, check, mesh, &list->places[i], has_triangles));
    return array;
}

static cJSON *make_part(const mesh_part *part, const mesh_file *mesh)
{
    cJSON *object = cJSON_CreateObject();
    const uint32_t owner = mesh_object_of(mesh, part->first);
    cJSON_AddNumberToObject(object, "first_triangle", part->first);
    cJSON_AddNumberToObject(object, "triangles", part->triangle_count);
    if (owner == MESH_NO_OBJECT)
        cJSON_AddNullToObject(object, "object");
    else
        cJSON_AddStringToObject(object, "object", mesh_object_name(mesh, owner));
    cJSON_AddBoolToObject(object, "closed", mesh_part_is_closed(part));
    cJSON_AddNumberToObject(object, "open_edges", part->open_edges);
    cJSON_AddNumberToObject(object, "non_manifold_edges", part->non_manifold_edges);
    cJSON_AddNumberToObject(object, "misoriented_edges", part->misoriented_edges);
    return object;
}

void query_checks_add_defects(cJSON *object, const mesh_check *check, uint32_t degenerate_faces)
{
    cJSON *defects = cJSON_AddObjectToObject(object, "defects");
    cJSON_AddNumberToObject(defects, "open_edges", check->open_edges);
    cJSON_AddNumberToObject(defects, "non_manifold_edges", check->non_manifold_edges);
    cJSON_AddNumberToObject(defects, "misoriented_edges", check->misoriented_edges);
    cJSON_AddNumberToObject(defects, "degenerate_faces", degenerate_faces);
    cJSON_AddNumberToObject(defects, "duplicate_faces", check->duplicate_faces);
}

void query_checks_add(cJSON *object, const query_checks *checks, const mesh_file *mesh)
{
    const mesh_check *check = &checks->mesh;
    if (!checks->is_made) return;
    if (checks->has_places)
        cJSON_AddItemToObject(
            object, "places",
            query_checks_places(&checks->places, check, mesh, checks->places.count, true));
    query_checks_add_defects(object, check, checks->degenerate_faces);
    cJSON_AddNumberToObject(object, "closed_parts", check->closed_parts);
    cJSON *parts = cJSON_AddArrayToObject(object, "parts");
    for (uint32_t i = 0; i < check->part_count && i < PARTS_LISTED; i++)
        cJSON_AddItemToArray(parts, make_part(&check->parts[i], mesh));
}
