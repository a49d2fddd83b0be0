/*
 * Prints a measurement; see report.h.
 *
 * SPDX-License-Identifier: MIT
 */
#define _POSIX_C_SOURCE 200809L

#include "report.h"

#include <build_info.h>

#include <cjson/cJSON.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* A named value: a text, or else a number, or neither. */
typedef struct report_field {
    const char *name;
    const char *text;
    double number;
    bool is_number;
} report_field;

enum { MAX_FIELDS = 40 };

typedef struct report_fields {
    report_field at[MAX_FIELDS];
    size_t count;
} report_fields;

static const char *const task_names[SC_TASK_COUNT] = {
    "update_boxes_ms",      "update_normals_ms",         "orientation_ms",
    "boxes_orientation_ms", "primitives_orientation_ms", "update_contours_ms",
    "contour_ms",           "boxes_contour_ms",          "primitives_contour_ms",
};

static void add_text(report_fields *fields, const char *name, const char *text)
{
    const report_field field = {name, text, 0.0, false};
    fields->at[fields->count++] = field;
}

/* Milliseconds and the like are kept to the sixth decimal: nanoseconds. */
static double rounded(double number)
{
    return floor(1e6 * number + 0.5) / 1e6;
}

static void add_number(report_fields *fields, const char *name, double number)
{
    const report_field field = {name, NULL, rounded(number), true};
    fields->at[fields->count++] = field;
}

/* A number that only some methods have. */
static void add_some(report_fields *fields, const char *name, bool has, double number)
{
    const report_field field = {name, NULL, rounded(number), has};
    fields->at[fields->count++] = field;
}

/* The processor's name as the system gives it. */
static const char *cpu_name(char *name, size_t size)
{
    char line[256];
    FILE *file = fopen("/proc/cpuinfo", "r");
    snprintf(name, size, "unknown");
    while (file && fgets(line, sizeof line, file)) {
        const char *colon = strchr(line, ':');
        if (strncmp(line, "model name", 10) != 0 || !colon) continue;
        snprintf(name, size, "%.*s", (int)strcspn(colon + 2, "\n"), colon + 2);
        break;
    }
    if (file) fclose(file);
    return name;
}

static double floor_ns(const measurement *m, const report_context *context)
{
    return 1e6 * m->floor_ms / context->triangle_count;
}

static void describe(report_fields *fields, const measurement *m, const report_context *context,
                     const char *cpu)
{
    add_text(fields, "program", "sc-bench");
    add_text(fields, "version", sc_version_string());
    add_text(fields, "commit", BUILD_COMMIT);
    add_text(fields, "compiler", BUILD_COMPILER);
    add_text(fields, "flags", BUILD_FLAGS);
    add_text(fields, "cpu", cpu);
    add_number(fields, "cores", (double)sysconf(_SC_NPROCESSORS_ONLN));
    add_text(fields, "scene", context->scene);
    add_number(fields, "triangles", context->triangle_count);
    add_number(fields, "vertices", context->vertex_count);
    add_number(fields, "frames", m->frame_count);
    add_text(fields, "partition", context->partition);
    add_text(fields, "pairs_kind", context->pairs_kind);
    add_text(fields, "contact", context->contact);
    add_text(fields, "mode", context->mode);
    add_number(fields, "repeats", context->options->repeats);
    add_number(fields, "threads", context->options->threads);
    add_number(fields, "workers", context->options->workers);
    add_number(fields, "build_ms", m->build_ms);
    add_number(fields, "model_bytes", (double)m->info.model_bytes);
    add_number(fields, "workspace_bytes", (double)m->info.workspace_bytes);
    add_some(fields, "hash_bytes", m->hash_bytes > 0, (double)m->hash_bytes);
    add_some(fields, "distance_edges", m->distance > 0.0, context->options->edges);
    add_some(fields, "distance", m->distance > 0.0, m->distance);
    add_some(fields, "ignore_rings", m->distance > 0.0, context->options->question.ignore_rings);
    add_number(fields, "floor_ns_per_triangle", floor_ns(m, context));
    add_number(fields, "cpu_share", m->cpu_share);
}

static void list_record(report_fields *fields, const measurement *m, const report_context *context,
                        uint32_t frame, size_t method)
{
    const measure_record *record = &m->records[frame * m->method_count + method];
    const sc_stats *stats = &record->stats;
    const bool library = !m->methods[method]->is_hash;
    const double boxes =
        (double)(stats->counts[SC_TASK_BOXES_ORIENTATION] + stats->counts[SC_TASK_BOXES_CONTOUR]);
    const double primitives = (double)(stats->counts[SC_TASK_PRIMITIVES_ORIENTATION] +
                                       stats->counts[SC_TASK_PRIMITIVES_CONTOUR]);
    add_text(fields, "scene", context->scene);
    add_number(fields, "triangles", context->triangle_count);
    add_number(fields, "frame", frame);
    add_text(fields, "method", m->methods[method]->name);
    add_text(fields, "pairs_kind", context->pairs_kind);
    add_number(fields, "threads", context->options->threads);
    add_number(fields, "ms", record->ms);
    add_number(fields, "ms_min", record->ms_min);
    add_number(fields, "pairs", (double)record->pairs);
    add_number(fields, "missed", (double)record->missed);
    add_number(fields, "extra", (double)record->extra);
    add_some(fields, "candidates", m->methods[method]->is_step, (double)record->candidates);
    add_some(fields, "candidates_ms", m->methods[method]->is_step, record->candidates_ms);
    add_number(fields, "times_floor", record->ms / m->floor_ms);
    for (size_t task = 0; task < SC_TASK_COUNT; task++) {
        add_some(fields, task_names[task], library, 1e-6 * (double)stats->nanoseconds[task]);
    }
    add_some(fields, "nodes", library, (double)stats->nodes_visited);
    add_some(fields, "nodes_oriented", library, (double)stats->nodes_oriented);
    add_some(fields, "nodes_culled", library, (double)stats->nodes_culled);
    add_number(fields, "boxes", boxes);
    add_number(fields, "primitives", primitives);
    add_some(fields, "leaf_pairs", library, (double)stats->leaf_pairs);
    add_number(fields, "exact_fallbacks", (double)stats->exact_fallbacks);
    add_some(fields, "contour_edges", library, (double)stats->counts[SC_TASK_UPDATE_CONTOURS]);
    add_some(fields, "near_pairs", context->options->count_near, (double)record->near);
    add_number(fields, "ms_max", record->ms_max);
}

static bool print_json(const report_fields *fields)
{
    cJSON *object = cJSON_CreateObject();
    for (size_t i = 0; i < fields->count; i++) {
        const report_field *field = &fields->at[i];
        if (field->text)
            cJSON_AddStringToObject(object, field->name, field->text);
        else if (field->is_number)
            cJSON_AddNumberToObject(object, field->name, field->number);
        else
            cJSON_AddNullToObject(object, field->name);
    }
    char *text = cJSON_PrintUnformatted(object);
    if (text) puts(text);
    cJSON_free(text);
    cJSON_Delete(object);
    return text != NULL;
}

/* Whole numbers with all digits, others with six. */
static void print_number(double number)
{
    printf(number == (double)(int64_t)number ? "%.0f" : "%.6g", number);
}

/* A text between quotes where it needs them. */
static void print_quoted(const char *text)
{
    if (!strpbrk(text, ",\"\n")) {
        fputs(text, stdout);
        return;
    }
    putchar('"');
    for (; *text; text++) {
        if (*text == '"') putchar('"');
        putchar(*text);
    }
    putchar('"');
}

static void print_csv(const report_fields *fields)
{
    for (size_t i = 0; i < fields->count; i++) {
        const report_field *field = &fields->at[i];
        if (i > 0) putchar(',');
        if (field->text)
            print_quoted(field->text);
        else if (field->is_number)
            print_number(field->number);
    }
    putchar('\n');
}

static void print_csv_opening(const report_fields *description, const report_fields *columns)
{
    for (size_t i = 0; i < description->count; i++) {
        const report_field *field = &description->at[i];
        if (!field->text && !field->is_number) continue;
        printf("# %s: ", field->name);
        if (field->text)
            fputs(field->text, stdout);
        else
            print_number(field->number);
        putchar('\n');
    }
    for (size_t i = 0; i < columns->count; i++) {
        printf("%s%s", i > 0 ? "," : "", columns->at[i].name);
    }
    putchar('\n');
}

/* What is left after culling, and how long that takes alone: means over the steps. */
static void print_candidates(const measurement *m)
{
    printf("\n%-14s %14s %14s\n", "method", "candidates", "ms of these");
    for (size_t i = 0; i < m->method_count; i++) {
        double candidates = 0.0, milliseconds = 0.0;
        for (uint32_t frame = 0; frame < m->frame_count; frame++) {
            const measure_record *record = &m->records[frame * m->method_count + i];
            candidates += (double)record->candidates;
            milliseconds += record->candidates_ms;
        }
        printf("%-14s %14.0f %14.3f\n", m->methods[i]->name, candidates / m->frame_count,
               milliseconds / m->frame_count);
    }
}

/* What a pair costs where there are some: means over the frames. */
static void print_near(const measurement *m)
{
    printf("\n%-14s %14s %14s\n", "method", "pairs", "ns a pair");
    for (size_t i = 0; i < m->method_count; i++) {
        double pairs = 0.0, milliseconds = 0.0;
        for (uint32_t frame = 0; frame < m->frame_count; frame++) {
            const measure_record *record = &m->records[frame * m->method_count + i];
            pairs += (double)record->pairs;
            milliseconds += record->ms;
        }
        printf("%-14s %14.0f", m->methods[i]->name, pairs / m->frame_count);
        if (pairs > 0.0)
            printf(" %14.1f\n", 1e6 * milliseconds / pairs);
        else
            printf(" %14s\n", "-");
    }
}

static void print_table(const measurement *m, const report_context *context)
{
    printf("%s: %lu triangles, %lu frames; %s pairs, %s; %s partition, %s, %lu thread%s\n",
           context->scene, (unsigned long)context->triangle_count, (unsigned long)m->frame_count,
           context->pairs_kind, context->contact, context->partition,
           context->options->mode == MEASURE_ONCE ? "one query a frame" : "repeated queries",
           (unsigned long)context->options->threads, context->options->threads > 1 ? "s" : "");
    if (m->methods[0]->near) {
        printf("within %.6g median edges of the first frame, that is %.6g", context->options->edges,
               m->distance);
        if (context->options->question.ignore_rings)
            printf("; %lu rings left out", (unsigned long)context->options->question.ignore_rings);
        putchar('\n');
    }
    if (m->cpu_share < 0.95) {
        printf("DISTURBED: the timed queries had only %.0f %% of a processor\n",
               100.0 * m->cpu_share);
    }
    printf("model built in %.1f ms; physical floor %.2f ns a triangle, %.3f ms a frame\n\n",
           m->build_ms, floor_ns(m, context), m->floor_ms);
    printf("milliseconds\n%5s %9s", m->methods[0]->is_step ? "step" : "frame", "pairs");
    for (size_t i = 0; i < m->method_count; i++) printf(" %14s", m->methods[i]->name);
    printf("\n");
    for (uint32_t frame = 0; frame < m->frame_count; frame++) {
        const measure_record *records = &m->records[frame * m->method_count];
        printf("%5lu %9.0f", (unsigned long)frame,
               (double)(records[0].pairs + records[0].missed - records[0].extra));
        for (size_t i = 0; i < m->method_count; i++) printf(" %14.3f", records[i].ms);
        printf("\n");
    }
    if (m->methods[0]->is_step) print_candidates(m);
    if (m->methods[0]->near) print_near(m);
    printf("\n%-14s %10s %10s %10s %12s %10s %9s %7s\n", "method", "at rest", "mean", "worst",
           "ns/triangle", "x floor", "missed", "extra");
    for (size_t i = 0; i < m->method_count; i++) {
        double sum = 0.0, worst = 0.0, missed = 0.0, extra = 0.0;
        for (uint32_t frame = 0; frame < m->frame_count; frame++) {
            const measure_record *record = &m->records[frame * m->method_count + i];
            sum += record->ms;
            worst = record->ms > worst ? record->ms : worst;
            missed += (double)record->missed;
            extra += (double)record->extra;
        }
        const double mean = sum / m->frame_count;
        printf("%-14s %10.3f %10.3f %10.3f %12.1f %10.1f %9.0f %7.0f\n", m->methods[i]->name,
               m->records[i].ms, mean, worst, 1e6 * mean / context->triangle_count,
               mean / m->floor_ms, missed, extra);
    }
}

bool report_print(const measurement *m, const report_context *context, uint32_t format)
{
    char cpu[128];
    report_fields description, fields;
    memset(&description, 0, sizeof description);
    describe(&description, m, context, cpu_name(cpu, sizeof cpu));
    if (format == REPORT_TEXT) {
        print_table(m, context);
        return true;
    }
    if (format == REPORT_JSON && !print_json(&description)) return false;
    for (uint32_t frame = 0; frame < m->frame_count; frame++) {
        for (size_t method = 0; method < m->method_count; method++) {
            memset(&fields, 0, sizeof fields);
            list_record(&fields, m, context, frame, method);
            if (format == REPORT_JSON) {
                if (!print_json(&fields)) return false;
                continue;
            }
            if (frame == 0 && method == 0) print_csv_opening(&description, &fields);
            print_csv(&fields);
        }
    }
    return true;
}
