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
