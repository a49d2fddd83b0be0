/*
 * What sc-query prints and writes of a pose; see query_report.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "query_report.h"

#include "mesh_faces.h"
#include "ply_write.h"
#include "query_checks.h"
#include "query_options.h"
#include "query_text.h"
#include "tool_json.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

bool query_report_ply(const mesh_file *mesh, const sc_pose *pose, const query_settings *set,
                      const place_list *places)
{
    const uint32_t count = mesh->triangle_count;
    uint8_t *colors = (uint8_t *)malloc(3 * (size_t)count);
    if (!colors) {
        tool_error("%s: out of memory", set->ply_path);
        return false;
    }
    memset(colors, 200, 3 * (size_t)count);
    for (uint32_t i = 0; i < places->count; i++) {
        const place *one = &places->places[i];
        for (size_t j = one->begin; j < one->begin + one->triangle_count; j++)
            place_color(i, colors + 3 * (size_t)places->triangles[j]);
    }
    errno = 0;
    const bool written = ply_write(set->ply_path, pose->positions, pose->position_type,
                                   mesh->vertex_count, mesh->indices, count, colors);
    if (!written) tool_error("%s: cannot be written: %s", set->ply_path, strerror(errno));
    free(colors);
    return written;
}

void query_report_head(const query_settings *set)
{
    if (set->json) return;
    printf("%10s %10s %6s %14s %14s %9s %9s  %s\n", "vertices", "triangles", "parts",
           set->any ? "collides" : "triangle pairs", set->any ? "" : "edge-tri pairs", "build ms",
           "query ms", "file");
}

void query_report_pairs_head(FILE *out, const query_settings *set)
{
    fputs("file,object_a,face_a,object_b,face_b", out);
    fputs(query_chosen_pairs(set) == SC_PAIRS_EDGE ? ",edge,triangle\n"
                                                   : ",triangle_a,triangle_b\n",
          out);
}

/* The two triangles of a pair of the kind that decides. */
static void find_triangles(const query_settings *set, sc_pair pair, uint32_t triangle[2])
{
    places_triangles(query_chosen_pairs(set), pair, triangle);
}

static void write_pairs(FILE *out, const query_answer *answer, const query_settings *set,
                        const query_list *list)
{
    for (uint64_t i = 0; i < list->count; i++) {
        uint32_t triangle[2];
        find_triangles(set, list->pairs[i], triangle);
        query_text_field(out, answer->path);
        for (int k = 0; k < 2; k++) {
            fputc(',', out);
            if (answer->mesh)
                query_text_owner(out, answer->mesh, triangle[k],
                                 mesh_object_of(answer->mesh, triangle[k]));
            else
                fputc(',', out);
        }
        fprintf(out, ",%lu,%lu\n", (unsigned long)list->pairs[i].a,
                (unsigned long)list->pairs[i].b);
    }
}

static void add_count(cJSON *object, const char *name, const query_answer *answer, uint32_t kind,
                      bool any)
{
    if (any || !answer->known[kind])
        cJSON_AddNullToObject(object, name);
    else
        cJSON_AddNumberToObject(object, name, (double)answer->counts[kind]);
}

static void add_time(cJSON *object, const char *name, const query_answer *answer, uint32_t kind)
{
    if (!answer->known[kind])
        cJSON_AddNullToObject(object, name);
    else
        cJSON_AddNumberToObject(object, name, query_text_rounded(answer->query_ms[kind]));
}

static void add_numbers(cJSON *object, const char *name, double numbers[2][3])
{
    cJSON *both = cJSON_AddArrayToObject(object, name);
    for (int end = 0; end < 2; end++)
        cJSON_AddItemToArray(both, cJSON_CreateDoubleArray(numbers[end], 3));
}

static const char *const meet_names[] = {"none", "point", "segment", "area"};

static void add_contacts(cJSON *object, const query_answer *answer, const query_settings *set,
                         const query_list *list)
{
    cJSON *contacts = cJSON_AddArrayToObject(object, "contacts");
    for (uint64_t i = 0; i < list->count; i++) {
        cJSON *contact = cJSON_CreateObject();
        cJSON_AddNumberToObject(contact, "a", list->pairs[i].a);
        cJSON_AddNumberToObject(contact, "b", list->pairs[i].b);
        if (answer->mesh) {
            uint32_t triangle[2];
            find_triangles(set, list->pairs[i], triangle);
            query_text_add_owner(contact, 'a', answer->mesh, triangle[0],
                                 mesh_object_of(answer->mesh, triangle[0]));
            query_text_add_owner(contact, 'b', answer->mesh, triangle[1],
                                 mesh_object_of(answer->mesh, triangle[1]));
        }
        cJSON_AddStringToObject(contact, "kind", meet_names[list->contacts[i].kind]);
        add_numbers(contact, "points", list->contacts[i].points);
        add_numbers(contact, "weights_a", list->contacts[i].weights_a);
        add_numbers(contact, "weights_b", list->contacts[i].weights_b);
        cJSON_AddItemToArray(contacts, contact);
    }
}

/* Lines of --jsonl are the same bytes in every run, so they have times on request only. */
static void add_times(cJSON *object, const query_answer *answer, const query_settings *set)
{
    if (set->jsonl_path && !set->timings) return;
    cJSON_AddNumberToObject(object, "build_ms", query_text_rounded(answer->build_ms));
    add_time(object, "query_ms", answer, query_chosen_pairs(set));
    add_time(object, "triangle_query_ms", answer, SC_PAIRS_TRIANGLE);
    add_time(object, "edge_query_ms", answer, SC_PAIRS_EDGE);
}

void query_report_add_settings(cJSON *object, const query_settings *set)
{
    cJSON_AddStringToObject(object, "pairs", tool_choice_name(query_pair_choices, set->pairs));
    cJSON_AddBoolToObject(object, "proper", set->proper);
    cJSON_AddBoolToObject(object, "any", set->any);
    if (set->model_path || set->replay_path) { /* they are the model's */
        cJSON_AddNullToObject(object, "weld");
        cJSON_AddNullToObject(object, "partition");
    } else {
        cJSON_AddStringToObject(object, "weld", tool_choice_name(tool_welds, set->weld));
        cJSON_AddStringToObject(object, "partition",
                                tool_choice_name(tool_partitions, set->partition));
    }
    cJSON_AddStringToObject(object, "method", tool_choice_name(query_method_choices, set->method));
    if (set->method == SC_METHOD_SCTT) {
        cJSON_AddStringToObject(object, "contour",
                                tool_choice_name(query_text_contours, set->contour));
    } else {
        cJSON_AddNullToObject(object, "contour");
    }
    cJSON_AddBoolToObject(object, "rest_cache", !set->no_rest_cache);
    if (set->rest_path) cJSON_AddStringToObject(object, "rest", set->rest_path);
    if (set->model_path) cJSON_AddStringToObject(object, "model", set->model_path);
    if (set->ignore_rings) cJSON_AddNumberToObject(object, "ignore_rings", set->ignore_rings);
    if (set->ignore_path) cJSON_AddStringToObject(object, "ignore", set->ignore_path);
    if (set->groups_path) cJSON_AddStringToObject(object, "groups", set->groups_path);
    if (set->budget) cJSON_AddNumberToObject(object, "budget", (double)set->budget);
}

static bool print_json_answer(const query_answer *answer, const query_settings *set,
                              const query_list *list, const mesh_tally *tally)
{
    cJSON *object = tool_json_object("mesh");
    cJSON_AddStringToObject(object, "file", answer->path);
    cJSON_AddStringToObject(object, "status",
                            answer->incomplete ? "incomplete"
                            : answer->collides ? "collides"
                                               : "clean");
    cJSON_AddBoolToObject(object, "collides", answer->collides);
    cJSON_AddStringToObject(object, "coordinates",
                            tool_coordinates(answer->rounded, answer->position_type));
    if (answer->has_animation) cJSON_AddStringToObject(object, "animation", "not played");
    cJSON_AddNumberToObject(object, "vertices", answer->info.point_count);
    cJSON_AddNumberToObject(object, "vertices_read", answer->info.vertex_count);
    cJSON_AddNumberToObject(object, "triangles", answer->info.triangle_count);
    cJSON_AddNumberToObject(object, "components", answer->info.component_count);
    if (answer->mesh) {
        cJSON_AddNumberToObject(object, "faces", answer->mesh->face_count);
        cJSON_AddNumberToObject(object, "objects", answer->mesh->object_count);
    }
    if (query_names_objects(set, answer->mesh)) query_text_add_tally(object, tally, answer->mesh);
    add_count(object, "triangle_pairs", answer, SC_PAIRS_TRIANGLE, set->any);
    add_count(object, "edge_triangle_pairs", answer, SC_PAIRS_EDGE, set->any);
    add_times(object, answer, set);
    query_report_add_settings(object, set);
    if (set->stats) query_text_add_stats(object, &answer->stats);
    if (set->contacts) add_contacts(object, answer, set, list);
    if (answer->checks) query_checks_add(object, answer->checks, answer->mesh);
    return tool_json_print(object);
}

/* A number of pairs: with a + if there may be more, a - if they were not sought. */
static void print_count(const query_answer *answer, uint32_t kind)
{
    if (answer->known[kind])
        printf("%13.0f%s", (double)answer->counts[kind], answer->incomplete ? "+" : " ");
    else
        printf("%13s ", "-");
}

/* Digits enough for what the coordinates are; those of doubles may be far from the origin. */
static void print_contacts(const query_answer *answer, const query_settings *set,
                           const query_list *list)
{
    const int digits = answer->position_type == SC_DOUBLE ? 17 : 9;
    for (uint64_t i = 0; i < list->count; i++) {
        const sc_contact *c = &list->contacts[i];
        printf("    %lu %lu %s", (unsigned long)list->pairs[i].a, (unsigned long)list->pairs[i].b,
               meet_names[c->kind]);
        for (int k = 0; k < (c->kind == SC_MEET_POINT ? 3 : 6); k++)
            printf(" %.*g", digits, c->points[k / 3][k % 3]);
        if (answer->mesh) {
            uint32_t triangle[2];
            find_triangles(set, list->pairs[i], triangle);
            query_text_owners(answer->mesh, triangle[0], triangle[1]);
        }
        puts("");
    }
}

static void print_table_row(const query_answer *answer, const query_settings *set)
{
    printf("%10lu %10lu %6lu ", (unsigned long)answer->info.point_count,
           (unsigned long)answer->info.triangle_count, (unsigned long)answer->info.component_count);
    if (set->any) {
        printf("%14s %14s", answer->collides ? "yes" : answer->incomplete ? "unknown" : "no", "");
    } else {
        print_count(answer, SC_PAIRS_TRIANGLE);
        printf(" ");
        print_count(answer, SC_PAIRS_EDGE);
    }
    printf(" %9.2f %9.3f  %s%s\n", answer->build_ms, answer->query_ms[query_chosen_pairs(set)],
           answer->path, tool_reading_note(answer->rounded, answer->has_animation));
    if (set->stats) query_text_stats(&answer->stats);
}

/* How many pairs there are between each two objects; false if there is no memory. */
static bool count_objects(const query_answer *answer, const query_settings *set,
                          const query_list *list, mesh_tally *tally)
{
    if (!query_names_objects(set, answer->mesh)) return true;
    for (uint64_t i = 0; i < list->count; i++) {
        uint32_t triangle[2];
        find_triangles(set, list->pairs[i], triangle);
        if (!mesh_tally_add(tally, mesh_object_of(answer->mesh, triangle[0]),
                            mesh_object_of(answer->mesh, triangle[1])))
            return false;
    }
    mesh_tally_sort(tally);
    return true;
}

int query_report_failure(const char *path, const query_settings *set, const char *error)
{
    tool_error("%s", error);
    if (set->json) tool_json_print(tool_json_refusal("mesh", path, error));
    fflush(stdout);
    return TOOL_FAILED;
}

int query_report(const query_answer *answer, const query_settings *set, const query_list *list,
                 FILE *out)
{
    mesh_tally tally = {NULL, 0, 0};
    bool written = count_objects(answer, set, list, &tally);
    if (!written) {
        tool_error("%s: out of memory", answer->path);
    } else if (set->json) {
        written = print_json_answer(answer, set, list, &tally);
    } else {
        print_table_row(answer, set);
        if (answer->mesh) mesh_tally_print(&tally, answer->mesh);
        if (answer->checks) query_checks_print(answer->checks, answer->mesh);
        if (set->contacts) print_contacts(answer, set, list);
    }
    if (written && out) write_pairs(out, answer, set, list);
    mesh_tally_free(&tally);
    fflush(stdout);
    if (!written) return TOOL_FAILED;
    if (answer->incomplete) return TOOL_INCOMPLETE;
    return answer->collides ? TOOL_COLLIDES : TOOL_CLEAN;
}
