/*
 * Measures a single query from nothing; see one_shot.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "one_shot.h"

#include "bench_model.h"
#include "tool.h"

#include <cjson/cJSON.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { BUILD = 0, WORKSPACE = 1, QUERY = 2, TOTAL = 3, PARTS = 4 };

static const char *const part_names[PARTS] = {"build_ms", "workspace_ms", "query_ms", "total_ms"};

typedef struct one_shot_state {
    const scene_folder *scene;
    const one_shot_options *options;
    double *rest;
    void *positions; /* the same, as the library reads it */
    sc_pair *pairs;
    uint64_t room;
} one_shot_state;

/* What one method took and found. */
typedef struct one_shot_record {
    double *times[PARTS]; /* repeats each */
    uint64_t pairs;
    sc_model_info info;
} one_shot_record;

static sc_status ask(one_shot_state *s, const method_kind *kind, const sc_model *model,
                     sc_workspace *workspace, uint64_t *count)
{
    sc_pose pose;
    sc_query_options options;
    sc_result result;
    memset(&pose, 0, sizeof pose);
    pose.struct_size = sizeof pose;
    pose.vertex_count = s->scene->vertex_count;
    pose.position_type = s->scene->single ? SC_FLOAT : SC_DOUBLE;
    pose.positions = s->positions;
    memset(&options, 0, sizeof options);
    options.struct_size = sizeof options;
    options.pairs = s->options->question.pairs;
    options.contact = s->options->question.contact;
    options.method = kind->method;
    options.contour = kind->contour;
    options.simd = kind->simd;
    memset(&result, 0, sizeof result);
    result.struct_size = sizeof result;
    result.pairs = s->pairs;
    result.capacity = s->room;
    const sc_status status = sc_query(model, workspace, &pose, &options, &result);
    *count = result.count;
    return status;
}

/* One method from nothing. Where there is too little room for the pairs, it is made and another
   query is to follow. */
static sc_status take_turn(one_shot_state *s, const method_kind *kind, uint32_t repeat,
                           one_shot_record *record)
{
    sc_build_options options;
    sc_model *model = NULL;
    sc_workspace *workspace = NULL;
    double build_ms;
    memset(&options, 0, sizeof options);
    if (kind->method == SC_METHOD_AABB) options.content = SC_MODEL_BOXES;
    sc_status status =
        bench_model_build(s->scene, s->rest, s->options->partition, &options, &model, &build_ms);
    const double built = tool_clock();
    if (status == SC_OK) status = sc_workspace_create(model, NULL, &workspace);
    const double made = tool_clock();
    if (status == SC_OK) status = ask(s, kind, model, workspace, &record->pairs);
    const double asked = tool_clock();
    record->info.struct_size = sizeof record->info;
    if (model) sc_model_get_info(model, &record->info);
    const double before = tool_clock();
    sc_workspace_free(workspace);
    sc_model_free(model);
    record->times[BUILD][repeat] = build_ms;
    record->times[WORKSPACE][repeat] = made - built;
    record->times[QUERY][repeat] = asked - made;
    record->times[TOTAL][repeat] = build_ms + (asked - built) + (tool_clock() - before);
    return status;
}

static sc_status measure_all(one_shot_state *s, const method_kind *const *methods, size_t count,
                             one_shot_record *records)
{
    for (uint32_t repeat = 0; repeat < s->options->repeats; repeat++) {
        for (size_t i = 0; i < count; i++) {
            sc_status status = take_turn(s, methods[i], repeat, &records[i]);
            if (status == SC_ERROR_SHORT_BUFFER) {
                free(s->pairs);
                s->room = records[i].pairs;
                s->pairs = (sc_pair *)malloc((size_t)s->room * sizeof *s->pairs);
                status = s->pairs ? take_turn(s, methods[i], repeat, &records[i]) : SC_ERROR_MEMORY;
            }
            if (status != SC_OK) return status;
        }
    }
    return SC_OK;
}

static int compare_times(const void *left, const void *right)
{
    const double a = *(const double *)left, b = *(const double *)right;
    return a < b ? -1 : a > b;
}

static double median(double *times, size_t count)
{
    qsort(times, count, sizeof *times, compare_times);
    return 0.5 * (times[(count - 1) / 2] + times[count / 2]);
}

static bool print_record(const one_shot_state *s, const char *name, const method_kind *kind,
                         const one_shot_record *record, bool json)
{
    static const char *const partitions[] = {"fast", "metis", "structure"};
    double medians[PARTS];
    for (int part = 0; part < PARTS; part++) {
        medians[part] = median(record->times[part], s->options->repeats);
    }
    if (!json) {
        printf("%-14s %10.3f %10.3f %10.3f %10.3f %10.0f\n", kind->name, medians[BUILD],
               medians[WORKSPACE], medians[QUERY], medians[TOTAL], (double)record->pairs);
        return true;
    }
    cJSON *const object = cJSON_CreateObject();
    cJSON_AddStringToObject(object, "scene", name);
    cJSON_AddNumberToObject(object, "triangles", s->scene->triangle_count);
    cJSON_AddStringToObject(object, "partition", partitions[s->options->partition]);
    cJSON_AddStringToObject(object, "method", kind->name);
    cJSON_AddNumberToObject(object, "repeats", s->options->repeats);
    for (int part = 0; part < PARTS; part++) {
        cJSON_AddNumberToObject(object, part_names[part], medians[part]);
    }
    cJSON_AddNumberToObject(object, "pairs", (double)record->pairs);
    cJSON_AddNumberToObject(object, "model_bytes", (double)record->info.model_bytes);
    cJSON_AddNumberToObject(object, "workspace_bytes", (double)record->info.workspace_bytes);
    cJSON_AddNumberToObject(object, "peak_bytes", (double)record->info.peak_bytes);
    char *const text = cJSON_PrintUnformatted(object);
    if (text) puts(text);
    cJSON_free(text);
    cJSON_Delete(object);
    return text != NULL;
}

static bool print_all(const one_shot_state *s, const char *name, const method_kind *const *methods,
                      size_t count, const one_shot_record *records, bool json)
{
    if (!json) {
        printf("%s: %lu triangles, one query from nothing, milliseconds\n%-14s %10s %10s %10s %10s "
               "%10s\n",
               name, (unsigned long)s->scene->triangle_count, "method", "build", "workspace",
               "query", "all", "pairs");
    }
    for (size_t i = 0; i < count; i++) {
        if (!print_record(s, name, methods[i], &records[i], json)) return false;
    }
    return true;
}

bool one_shot_run(scene_folder *scene, const char *name, const method_kind *const *methods,
                  size_t count, const one_shot_options *options, bool json, char *error,
                  size_t error_size)
{
    one_shot_state s;
    memset(&s, 0, sizeof s);
    s.scene = scene;
    s.options = options;
    s.rest = (double *)malloc(3 * (size_t)scene->vertex_count * sizeof *s.rest);
    one_shot_record *const records = (one_shot_record *)calloc(count, sizeof *records);
    double *const times = (double *)malloc(PARTS * count * options->repeats * sizeof *times);
    bool done = s.rest && records && times;
    if (!done) snprintf(error, error_size, "one shot: out of memory");
    if (done && options->partition == BENCH_STRUCTURE && !scene->order) {
        snprintf(error, error_size, "--partition structure: this scene comes without an order");
        done = false;
    }
    for (size_t i = 0; done && i < PARTS * count; i++) {
        records[i / PARTS].times[i % PARTS] = times + i * options->repeats;
    }
    done = done && scene_folder_frame(scene, 0, s.rest, error, error_size) == 0;
    if (done) {
        s.positions = bench_model_positions(scene, s.rest);
        const sc_status status =
            s.positions ? measure_all(&s, methods, count, records) : SC_ERROR_MEMORY;
        done = status == SC_OK && print_all(&s, name, methods, count, records, json);
        if (!done) snprintf(error, error_size, "one shot: %s", sc_status_string(status));
    }
    free(s.rest);
    free(s.positions);
    free(s.pairs);
    free(records);
    free(times);
    return done;
}
