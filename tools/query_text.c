/*
 * What sc-query prints of any question; see query_text.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "query_text.h"

#include <math.h>
#include <string.h>

const tool_choice query_text_contours[] = {
    {"exact", SC_CONTOUR_EXACT}, {"star", SC_CONTOUR_STAR}, {"none", SC_CONTOUR_NONE}, {NULL, 0}};

static const char *const task_names[SC_TASK_COUNT] = {"update_boxes",
                                                      "update_normals",
                                                      "orientation_tests",
                                                      "box_tests_after_orientation",
                                                      "primitive_tests_after_orientation",
                                                      "update_contours",
                                                      "contour_tests",
                                                      "box_tests_after_contour",
                                                      "primitive_tests_after_contour"};

static int severity(int status)
{
    return status == TOOL_FAILED ? 4 : status;
}

int query_text_worse(int a, int b)
{
    return severity(b) > severity(a) ? b : a;
}

double query_text_rounded(double milliseconds)
{
    return floor(milliseconds * 1e4 + 0.5) / 1e4;
}

void query_text_field(FILE *out, const char *text)
{
    if (!text[strcspn(text, ",\"\r\n")]) {
        fputs(text, out);
        return;
    }
    fputc('"', out);
    for (; *text; text++) {
        if (*text == '"') fputc('"', out);
        fputc(*text, out);
    }
    fputc('"', out);
}

void query_text_owner(FILE *out, const mesh_file *mesh, uint32_t triangle, uint32_t object)
{
    query_text_field(out, mesh_object_name(mesh, object));
    fputc(',', out);
    if (triangle != SC_NONE) fprintf(out, "%lu", (unsigned long)mesh_face_of(mesh, triangle));
}

void query_text_owners(const mesh_file *mesh, uint32_t one, uint32_t other)
{
    printf(" faces %lu %lu", (unsigned long)mesh_face_of(mesh, one),
           (unsigned long)mesh_face_of(mesh, other));
    if (mesh->object_count) {
        fputs(" of ", stdout);
        mesh_print_name(mesh_object_name(mesh, mesh_object_of(mesh, one)));
        fputs(" / ", stdout);
        mesh_print_name(mesh_object_name(mesh, mesh_object_of(mesh, other)));
    }
}

/* null: the file names no objects. */
static void add_object(cJSON *object, const char *name, const mesh_file *mesh, uint32_t number)
{
    if (number == MESH_NO_OBJECT)
        cJSON_AddNullToObject(object, name);
    else
        cJSON_AddStringToObject(object, name, mesh_object_name(mesh, number));
}

void query_text_add_owner(cJSON *to, char which, const mesh_file *mesh, uint32_t triangle,
                          uint32_t object)
{
    const char *const face = which == 'a' ? "face_a" : "face_b";
    if (triangle == SC_NONE)
        cJSON_AddNullToObject(to, face);
    else
        cJSON_AddNumberToObject(to, face, mesh_face_of(mesh, triangle));
    add_object(to, which == 'a' ? "object_a" : "object_b", mesh, object);
}

void query_text_add_tally(cJSON *object, const mesh_tally *tally, const mesh_file *mesh)
{
    cJSON *list = cJSON_AddArrayToObject(object, "object_pairs");
    for (size_t i = 0; i < tally->count; i++) {
        cJSON *entry = cJSON_CreateObject();
        add_object(entry, "a", mesh, tally->entries[i].a);
        add_object(entry, "b", mesh, tally->entries[i].b);
        cJSON_AddNumberToObject(entry, "pairs", (double)tally->entries[i].pairs);
        cJSON_AddItemToArray(list, entry);
    }
}

void query_text_stats(const sc_stats *stats)
{
    printf("    %-34s %10s %12s\n", "task", "ms", "count");
    for (int i = 0; i < SC_TASK_COUNT; i++) {
        char name[64];
        snprintf(name, sizeof name, "%s", task_names[i]);
        for (char *c = name; *c; c++) *c = *c == '_' ? ' ' : *c;
        printf("    %-34s %10.4f %12.0f\n", name, 1e-6 * (double)stats->nanoseconds[i],
               (double)stats->counts[i]);
    }
    printf("    %-34s %10.4f\n", "total", 1e-6 * (double)stats->total_nanoseconds);
    printf("    test tree: %.0f nodes visited, %.0f oriented, %.0f culled; %.0f leaf pairs; "
           "%.0f signs decided exactly\n",
           (double)stats->nodes_visited, (double)stats->nodes_oriented, (double)stats->nodes_culled,
           (double)stats->leaf_pairs, (double)stats->exact_fallbacks);
}

void query_text_add_stats(cJSON *object, const sc_stats *stats)
{
    object = cJSON_AddObjectToObject(object, "stats");
    cJSON *tasks = cJSON_AddArrayToObject(object, "tasks");
    for (int i = 0; i < SC_TASK_COUNT; i++) {
        cJSON *task = cJSON_CreateObject();
        cJSON_AddStringToObject(task, "task", task_names[i]);
        cJSON_AddNumberToObject(task, "ms",
                                query_text_rounded(1e-6 * (double)stats->nanoseconds[i]));
        cJSON_AddNumberToObject(task, "count", (double)stats->counts[i]);
        cJSON_AddItemToArray(tasks, task);
    }
    cJSON_AddNumberToObject(object, "total_ms",
                            query_text_rounded(1e-6 * (double)stats->total_nanoseconds));
    cJSON_AddNumberToObject(object, "nodes_visited", (double)stats->nodes_visited);
    cJSON_AddNumberToObject(object, "nodes_oriented", (double)stats->nodes_oriented);
    cJSON_AddNumberToObject(object, "nodes_culled", (double)stats->nodes_culled);
    cJSON_AddNumberToObject(object, "leaf_pairs", (double)stats->leaf_pairs);
    cJSON_AddNumberToObject(object, "exact_fallbacks", (double)stats->exact_fallbacks);
}
