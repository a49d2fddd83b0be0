/*
 * What sc-query prints and writes of contours; see trace_report.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "trace_report.h"

#include "query_text.h"
#include "tool_json.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>

enum { CONTOURS_PRINTED = 5 }; /* without --list */

const tool_choice trace_ends[] = {{"closed", SC_TRACE_CLOSED},
                                  {"border", SC_TRACE_BORDER},
                                  {"branch", SC_TRACE_BRANCH},
                                  {"vertex", SC_TRACE_VERTEX},
                                  {NULL, 0}};

static int compare_lengths(const void *left, const void *right)
{
    const sc_trace_contour *a = &((const trace_listed *)left)->contour;
    const sc_trace_contour *b = &((const trace_listed *)right)->contour;
    if (a->length != b->length) return a->length > b->length ? -1 : 1;
    return a->first < b->first ? -1 : a->first > b->first;
}

void trace_report_sort(trace_answer *answer)
{
    if (answer->contour_count)
        qsort(answer->contours, (size_t)answer->contour_count, sizeof *answer->contours,
              compare_lengths);
}

uint64_t trace_report_closed(const trace_answer *answer)
{
    uint64_t closed = 0;
    for (uint64_t i = 0; i < answer->contour_count; i++)
        closed += answer->contours[i].contour.begin == SC_TRACE_CLOSED;
    return closed;
}

double trace_report_length(const trace_answer *answer)
{
    double sum = 0;
    for (uint64_t i = 0; i < answer->contour_count; i++) sum += answer->contours[i].contour.length;
    return sum;
}

/* ------------------------------------------------------------------------------------------------
 * The table
 */

void trace_report_head(const trace_settings *set)
{
    if (set->json) return;
    printf("%10s %10s %14s %9s %9s %12s %9s %9s %9s  %s\n", "vertices", "triangles",
           "edge-tri pairs", "contours", "closed", "length", "build ms", "query ms", "trace ms",
           "file");
}

static void print_contour(const sc_trace_contour *contour, uint64_t number)
{
    printf("    contour %.0f: length %.6g, %.0f nodes, ", (double)number, contour->length,
           (double)contour->count);
    if (contour->begin == SC_TRACE_CLOSED)
        fputs("closed", stdout);
    else
        printf("%s to %s", tool_choice_name(trace_ends, contour->begin),
               tool_choice_name(trace_ends, contour->end));
    puts(contour->flags & SC_TRACE_ONE_SHEET ? ", one sheet" : "");
}

static void print_table_row(const trace_answer *answer, const trace_settings *set)
{
    printf("%10lu %10lu %14.0f %9.0f %9.0f %12.6g %9.2f %9.3f %9.3f  %s%s\n",
           (unsigned long)answer->info.point_count, (unsigned long)answer->info.triangle_count,
           (double)answer->pair_count, (double)answer->contour_count,
           (double)trace_report_closed(answer), trace_report_length(answer), answer->build_ms,
           answer->query_ms, answer->trace_ms, answer->path,
           tool_reading_note(answer->rounded, answer->has_animation));
    uint64_t count = answer->contour_count;
    if (!set->list && count > CONTOURS_PRINTED) count = CONTOURS_PRINTED;
    for (uint64_t i = 0; i < count; i++) print_contour(&answer->contours[i].contour, i + 1);
    if (count < answer->contour_count)
        printf("    and %.0f shorter contours\n", (double)(answer->contour_count - count));
    if (answer->triple_count)
        printf("    three sheets meet in %.0f point%s\n", (double)answer->triple_count,
               answer->triple_count == 1 ? "" : "s");
}

/* ------------------------------------------------------------------------------------------------
 * JSON
 */

static void add_numbers(cJSON *object, const char *name, const double *numbers, int count)
{
    cJSON_AddItemToObject(object, name, cJSON_CreateDoubleArray(numbers, count));
}

static cJSON *make_node(const sc_trace_node *node)
{
    cJSON *object = cJSON_CreateObject();
    add_numbers(object, "point", node->point, 3);
    if (node->edge == SC_TRACE_NO_EDGE) {
        cJSON_AddNumberToObject(object, "vertex", node->triangle);
    } else {
        cJSON_AddNumberToObject(object, "edge", node->edge);
        cJSON_AddNumberToObject(object, "triangle", node->triangle);
        cJSON_AddNumberToObject(object, "sheet", node->sheet);
        cJSON_AddNumberToObject(object, "along", node->along);
        add_numbers(object, "weights", node->weights, 3);
    }
    if (node->sheets[0] == SC_TRACE_NO_EDGE) {
        cJSON_AddNullToObject(object, "sheets");
    } else {
        const double sheets[2] = {node->sheets[0], node->sheets[1]};
        add_numbers(object, "sheets", sheets, 2);
    }
    return object;
}

static cJSON *make_contour(const trace_answer *answer, const sc_trace_contour *contour)
{
    cJSON *object = cJSON_CreateObject();
    cJSON_AddNumberToObject(object, "length", contour->length);
    cJSON_AddStringToObject(object, "begin", tool_choice_name(trace_ends, contour->begin));
    cJSON_AddStringToObject(object, "end", tool_choice_name(trace_ends, contour->end));
    cJSON_AddBoolToObject(object, "one_sheet", (contour->flags & SC_TRACE_ONE_SHEET) != 0);
    cJSON *nodes = cJSON_AddArrayToObject(object, "nodes");
    for (uint64_t i = 0; i < contour->count; i++)
        cJSON_AddItemToArray(nodes, make_node(&answer->nodes[contour->first + i]));
    return object;
}

static cJSON *make_triple(const sc_trace_triple *triple)
{
    cJSON *object = cJSON_CreateObject();
    const double triangles[3] = {triple->triangles[0], triple->triangles[1], triple->triangles[2]};
    add_numbers(object, "point", triple->point, 3);
    add_numbers(object, "triangles", triangles, 3);
    return object;
}

static bool print_json_answer(const trace_answer *answer, const trace_settings *set)
{
    cJSON *object = tool_json_object("trace");
    cJSON_AddStringToObject(object, "file", answer->path);
    cJSON_AddStringToObject(object, "status", answer->contour_count ? "contours" : "clean");
    cJSON_AddStringToObject(object, "coordinates",
                            tool_coordinates(answer->rounded, answer->position_type));
    if (answer->has_animation) cJSON_AddStringToObject(object, "animation", "not played");
    cJSON_AddNumberToObject(object, "vertices", answer->info.point_count);
    cJSON_AddNumberToObject(object, "vertices_read", answer->info.vertex_count);
    cJSON_AddNumberToObject(object, "triangles", answer->info.triangle_count);
    cJSON_AddNumberToObject(object, "edge_pairs", (double)answer->pair_count);
    cJSON_AddNumberToObject(object, "closed", (double)trace_report_closed(answer));
    cJSON_AddNumberToObject(object, "length", trace_report_length(answer));
    cJSON_AddNumberToObject(object, "build_ms", query_text_rounded(answer->build_ms));
    cJSON_AddNumberToObject(object, "query_ms", query_text_rounded(answer->query_ms));
    cJSON_AddNumberToObject(object, "trace_ms", query_text_rounded(answer->trace_ms));
    if (set->model_path) { /* they are the model's */
        cJSON_AddNullToObject(object, "weld");
        cJSON_AddNullToObject(object, "partition");
    } else {
        cJSON_AddStringToObject(object, "weld", tool_choice_name(tool_welds, set->weld));
        cJSON_AddStringToObject(object, "partition",
                                tool_choice_name(tool_partitions, set->partition));
    }
    if (set->rest_path) cJSON_AddStringToObject(object, "rest", set->rest_path);
    if (set->model_path) cJSON_AddStringToObject(object, "model", set->model_path);
    cJSON *contours = cJSON_AddArrayToObject(object, "contours");
    for (uint64_t i = 0; i < answer->contour_count; i++)
        cJSON_AddItemToArray(contours, make_contour(answer, &answer->contours[i].contour));
    cJSON *triples = cJSON_AddArrayToObject(object, "triples");
    for (uint64_t i = 0; i < answer->triple_count; i++)
        cJSON_AddItemToArray(triples, make_triple(&answer->triples[i]));
    return tool_json_print(object);
}

/* ------------------------------------------------------------------------------------------------
 * A file
 */

int trace_report_failure(const char *path, const trace_settings *set, const char *error)
{
    tool_error("%s", error);
    if (set->json) tool_json_print(tool_json_refusal("trace", path, error));
    fflush(stdout);
    return TOOL_FAILED;
}

int trace_report(const trace_answer *answer, const trace_settings *set)
{
    bool printed = true;
    if (set->json)
        printed = print_json_answer(answer, set);
    else
        print_table_row(answer, set);
    fflush(stdout);
    if (!printed) return TOOL_FAILED;
    return answer->contour_count ? TOOL_COLLIDES : TOOL_CLEAN;
}

/* Vertices are the nodes, contour after contour; edges the segments between them. */
static void write_lines(const trace_answer *answer, FILE *file)
{
    uint64_t nodes = 0, segments = 0;
    for (uint64_t i = 0; i < answer->contour_count; i++) {
        nodes += answer->contours[i].contour.count;
        segments += answer->contours[i].contour.count -
                    (answer->contours[i].contour.begin != SC_TRACE_CLOSED);
    }
    fprintf(file,
            "ply\nformat ascii 1.0\ncomment written by starcontour: contours, the longest first\n"
            "element vertex %.0f\nproperty double x\nproperty double y\nproperty double z\n"
            "element edge %.0f\nproperty int vertex1\nproperty int vertex2\nproperty int contour\n"
            "end_header\n",
            (double)nodes, (double)segments);
    for (uint64_t i = 0; i < answer->contour_count; i++) {
        const sc_trace_node *node = answer->nodes + answer->contours[i].contour.first;
        for (uint64_t k = 0; k < answer->contours[i].contour.count; k++, node++)
            fprintf(file, "%.17g %.17g %.17g\n", node->point[0], node->point[1], node->point[2]);
    }
    uint64_t first = 0;
    for (uint64_t i = 0; i < answer->contour_count; i++) {
        const uint64_t count = answer->contours[i].contour.count;
        const bool is_closed = answer->contours[i].contour.begin == SC_TRACE_CLOSED;
        for (uint64_t k = 0; k + !is_closed < count; k++)
            fprintf(file, "%.0f %.0f %.0f\n", (double)(first + k),
                    (double)(first + (k + 1) % count), (double)i);
        first += count;
    }
}

bool trace_report_ply(const trace_answer *answer, const trace_settings *set)
{
    FILE *file = fopen(set->ply_path, "w");
    bool written = file != NULL;
    if (written) {
        write_lines(answer, file);
        written = !ferror(file);
        if (fclose(file) != 0) written = false;
    }
    if (!written) tool_error("%s: cannot be written: %s", set->ply_path, strerror(errno));
    return written;
}
