/*
 * sc-query --near; see near_query.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "near_query.h"

#include "batch.h"
#include "frame_paths.h"
#include "near_report.h"
#include "near_thickness.h"
#include "query_pose.h"
#include "query_summary.h"
#include "query_text.h"
#include "query_threads.h"
#include "record_file.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Pairs of one kind; grows and is kept. */
typedef struct near_list {
    sc_pair *pairs;
    uint64_t capacity;
} near_list;

typedef struct near_run {
    const near_settings *set;
    const char *rest_path; /* --rest, or the first frame of a pattern, or NULL */
    query_subject rest;    /* of that, or the saved model */
    near_list lists[KINDS];
    query_summary summary;
    FILE *out;
    mesh_file first; /* of a saved model: the first file, where --ignore-rest asks for it */
} near_run;

/* ------------------------------------------------------------------------------------------------
 * Asking
 */

/* Makes room for so many pairs; what was there is lost. */
static bool make_room(near_list *list, uint64_t count)
{
    if (count <= list->capacity) return true;
    free(list->pairs);
    list->pairs = count > SIZE_MAX / sizeof(sc_pair)
                      ? NULL
                      : (sc_pair *)malloc((size_t)count * sizeof(sc_pair));
    list->capacity = list->pairs ? count : 0;
    return list->pairs != NULL;
}

/* What is asked. rest, and filters, are used where the settings say so. */
static sc_near_options make_options(const near_settings *set, const sc_filter filters[KINDS],
                                    const sc_pose *rest, bool listed)
{
    sc_near_options options;
    memset(&options, 0, sizeof options);
    options.struct_size = sizeof options;
    options.kinds = set->kinds;
    options.method = set->method;
    options.distance = set->distance;
    if (set->ignore_rings || set->ignore_path || set->groups_path) {
        options.vertex_face_filter = &filters[VERTEX_FACE];
        options.edge_edge_filter = &filters[EDGE_EDGE];
    }
    if (set->ignores_rest) {
        options.rest = rest;
        options.rest_distance = set->ignore_rest;
    }
    options.budget = set->budget;
    if (set->replayed) options = set->replayed->search;
    options.output = set->any ? SC_OUTPUT_ANY : listed ? SC_OUTPUT_PAIRS : SC_OUTPUT_COUNT;
    options.tasks = query_threads_tasks();
    return options;
}

static sc_status find_near(near_run *run, const query_subject *subject,
                           const sc_filter filters[KINDS], near_answer *answer)
{
    const near_settings *set = run->set;
    const bool listed = near_wants_list(set) || near_names_objects(set, answer->mesh);
    const mesh_file *mesh = run->first.positions ? &run->first : answer->mesh;
    const sc_pose rest = tool_pose(mesh->positions, mesh->position_type, mesh->vertex_count);
    const sc_near_options options = make_options(set, filters, &rest, listed);
    sc_near_result result;
    memset(&result, 0, sizeof result);
    if (set->record_path) {
        const record_question question = {
            .model = subject->model, .pose = answer->pose, .search = &options};
        answer->unrecorded = !record_file_write(set->record_path, &question);
    }
    result.struct_size = sizeof result;
    if (set->stats) {
        answer->stats.struct_size = sizeof answer->stats;
        result.stats = &answer->stats;
    }
    sc_status status;
    do {
        if (listed) {
            if (!make_room(&run->lists[VERTEX_FACE], result.vertex_face_count) ||
                !make_room(&run->lists[EDGE_EDGE], result.edge_edge_count))
                return SC_ERROR_MEMORY;
            result.vertex_faces = run->lists[VERTEX_FACE].pairs;
            result.vertex_face_capacity = run->lists[VERTEX_FACE].capacity;
            result.edge_edges = run->lists[EDGE_EDGE].pairs;
            result.edge_edge_capacity = run->lists[EDGE_EDGE].capacity;
        }
        const double start = tool_clock();
        status = sc_query_near(subject->model, subject->workspace, answer->pose, &options, &result);
        answer->query_ms = tool_clock() - start;
    } while (listed && status != SC_OK &&
             (result.vertex_face_count > result.vertex_face_capacity ||
              result.edge_edge_count > result.edge_edge_capacity));
    answer->counts[VERTEX_FACE] = result.vertex_face_count;
    answer->counts[EDGE_EDGE] = result.edge_edge_count;
    answer->pairs[VERTEX_FACE] = run->lists[VERTEX_FACE].pairs;
    answer->pairs[EDGE_EDGE] = run->lists[EDGE_EDGE].pairs;
    answer->near = result.found != 0;
    answer->incomplete = status == SC_ERROR_INCOMPLETE;
    return answer->incomplete ? SC_OK : status;
}

/* All about one pose. */
static bool ask(near_run *run, const query_subject *subject, near_answer *answer,
                char error[MESH_FILE_ERROR_SIZE])
{
    const near_settings *set = run->set;
    sc_filter filters[KINDS];
    answer->build_ms = subject->build_ms;
    answer->model = subject->model;
    answer->weld_map = subject->weld_map;
    answer->position_type = answer->pose->position_type;
    answer->nearest = HUGE_VAL;
    answer->info.struct_size = sizeof answer->info;
    sc_status status = sc_model_get_info(subject->model, &answer->info);
    if (status == SC_OK && !filter_file_apply_step(set->filters, answer->info.vertex_count,
                                                   answer->info.triangle_count, filters, error))
        return false;
    for (int kind = 0; kind < KINDS; kind++) filters[kind].ignore_rings = set->ignore_rings;
    if (status == SC_OK) status = find_near(run, subject, filters, answer);
    if (status == SC_OK && near_tells_distances(set)) status = near_report_nearest(answer);
    for (int kind = 0; kind < KINDS; kind++) {
        if (status == SC_OK && near_names_objects(set, answer->mesh) &&
            !feature_pairs_tally(&answer->tally, answer->mesh, answer->vertex_objects, kind,
                                 answer->pairs[kind], answer->counts[kind]))
            status = SC_ERROR_MEMORY;
    }
    mesh_tally_sort(&answer->tally);
    if (status == SC_OK)
        return !set->thickness || near_thickness_find(answer, set->distance, error);
    snprintf(error, MESH_FILE_ERROR_SIZE, "%s: %s", answer->path, tool_why(status));
    return false;
}

/* ------------------------------------------------------------------------------------------------
 * Files
 */

/* How to build. For one query the plain tree alone pays, which is built fastest. */
static query_subject_how how_to_build(const near_run *run)
{
    const near_settings *set = run->set;
    const bool is_plain = set->method != SC_NEAR_METHOD_SCTT && !run->rest_path && !set->stats &&
                          set->partition == TOOL_PARTITION_FAST && !set->budget &&
                          !set->record_path;
    const query_subject_how how = {
        set->weld, set->partition, 0, is_plain ? SC_MODEL_BOXES : SC_MODEL_FULL, SC_WORKSPACE_NEAR,
        true};
    return how;
}

static bool name_vertices(near_answer *answer, uint32_t **objects, char error[MESH_FILE_ERROR_SIZE])
{
    *objects = mesh_vertex_objects(answer->mesh);
    answer->vertex_objects = *objects;
    if (!*objects) snprintf(error, MESH_FILE_ERROR_SIZE, "%s: out of memory", answer->path);
    return *objects != NULL;
}

static int do_file(near_run *run, const char *path)
{
    const near_settings *set = run->set;
    char error[MESH_FILE_ERROR_SIZE];
    query_pose pose;
    near_answer answer;
    uint32_t *objects = NULL;
    memset(&answer, 0, sizeof answer);
    answer.path = path;
    const query_subject_how how = how_to_build(run);
    bool done = query_pose_read(&pose, path, &run->rest, &how, error);
    answer.mesh = pose.mesh;
    answer.pose = &pose.pose;
    answer.rounded = pose.rounded;
    answer.has_animation = pose.has_animation;
    if (done) done = name_vertices(&answer, &objects, error);
    if (done) done = ask(run, pose.subject, &answer, error);
    int status = done ? near_report(&answer, set, run->out) : near_report_failure(path, set, error);
    if (done && set->ply_path && !near_report_ply(&answer, set)) status = TOOL_FAILED;
    if (answer.unrecorded) status = TOOL_FAILED;
    query_summary_add(&run->summary, status, answer.near, path, NULL,
                      set->any ? 0 : answer.counts[VERTEX_FACE] + answer.counts[EDGE_EDGE]);
    mesh_tally_free(&answer.tally);
    free(answer.thickness);
    free(objects);
    query_pose_free(&pose);
    return status;
}

/* Makes what all files share: TOOL_CLEAN, or TOOL_FAILED, which has been reported. */
static int open_rest(near_run *run)
{
    const near_settings *set = run->set;
    char error[MESH_FILE_ERROR_SIZE];
    const query_subject_how how = how_to_build(run);
    if (query_subject_begin(&run->rest, run->rest_path, set->model_path, &how, error))
        return TOOL_CLEAN;
    return near_report_failure(run->rest_path ? run->rest_path : set->model_path, set, error);
}

static int do_files(near_run *run, char *const *paths, int count)
{
    const near_settings *set = run->set;
    char error[MESH_FILE_ERROR_SIZE];
    int status = open_rest(run);
    if (status != TOOL_CLEAN) return status;
    if (set->model_path && set->ignores_rest &&
        (!mesh_file_read(&run->first, paths[0], error) ||
         !query_subject_fits(&run->rest, paths[0], &run->first, error)))
        return near_report_failure(paths[0], set, error);
    near_report_head(set);
    if (run->out) near_report_pairs_head(run->out, set);
    for (int i = 0; i < count; i++) status = query_text_worse(status, do_file(run, paths[i]));
    if (!query_summary_print(&run->summary, false, set->json)) status = TOOL_FAILED;
    return status;
}

/* Also those of a pattern. */
static bool spares_files(char *const *paths, int count, const near_settings *set)
{
    for (int i = 0; i < count; i++) {
        if (!tool_spares(set->out_path, paths[i]) || !tool_spares(set->ply_path, paths[i]) ||
            !tool_spares(set->record_path, paths[i]))
            return false;
    }
    return true;
}

/* Ends what a run has begun; returns the exit status. */
static int close_run(near_run *run, int status)
{
    if (!tool_close(run->out, run->set->out_path)) status = TOOL_FAILED;
    for (int kind = 0; kind < KINDS; kind++) free(run->lists[kind].pairs);
    mesh_file_free(&run->first);
    query_subject_free(&run->rest);
    return status;
}

int near_query_files(char **paths, int count, const near_settings *set)
{
    char error[MESH_FILE_ERROR_SIZE];
    frame_paths found = {NULL, 0};
    int status = TOOL_FAILED;
    near_run run;
    memset(&run, 0, sizeof run);
    run.set = set;
    run.rest_path = set->rest_path;
    if (!frame_paths_expand(&found, &paths, &count, error)) {
        tool_error("%s", error);
        return TOOL_FAILED;
    }
    if (found.count && !set->rest_path && !set->model_path) run.rest_path = paths[0];
    if ((set->ply_path || set->record_path) && count > 1) {
        tool_error("--%s takes one mesh only; see sc-query --help",
                   set->ply_path ? "ply" : "record");
    } else if (!spares_files(paths, count, set)) {
        status = TOOL_FAILED;
    } else if (set->out_path && !(run.out = fopen(set->out_path, "w"))) {
        tool_error("%s: cannot be written: %s", set->out_path, strerror(errno));
    } else {
        status = do_files(&run, paths, count);
    }
    status = close_run(&run, status);
    frame_paths_free(&found);
    return status;
}

static int do_batch_file(void *user, const char *path)
{
    near_run *run = (near_run *)user;
    const int status = do_file(run, path);
    for (int kind = 0; kind < KINDS; kind++) {
        free(run->lists[kind].pairs);
        memset(&run->lists[kind], 0, sizeof run->lists[kind]);
    }
    return status;
}

int near_query_batch(const query_settings *set)
{
    static const char *const optional[] = {"rest",        "model",  "ignore_rings", "ignore",
                                           "ignore_rest", "groups", "budget",       NULL};
    static const char *const members[] = {"build_ms", "stats", "thickness", NULL};
    const bool wants[] = {set->timings, set->stats, set->near.thickness};
    batch_lines lines = {"near", "near",  {"vertex_face_pairs", "edge_edge_pairs"}, NULL, members,
                         wants,  optional};
    near_settings own = set->near;
    near_run run;
    memset(&run, 0, sizeof run);
    run.set = &own;
    run.rest_path = own.rest_path;
    int status = open_rest(&run);
    if (status == TOOL_CLEAN) {
        own.json = true;
        lines.settings = cJSON_CreateObject();
        near_report_add_settings(lines.settings, &set->near);
        status = batch_run(set, &lines, do_batch_file, &run);
        cJSON_Delete(lines.settings);
    }
    query_subject_free(&run.rest);
    return status;
}

/* ------------------------------------------------------------------------------------------------
 * Records
 */

/* Sets what the record asks for; file->error says if it cannot be asked here. */
static bool use_record(near_settings *set, record_file *file)
{
    const sc_near_options *o = &file->search;
    set->kinds = o->kinds;
    set->method = o->method;
    set->distance = o->distance;
    set->any = o->output == SC_OUTPUT_ANY;
    set->budget = o->budget;
    set->ignores_rest = o->rest != NULL;
    set->ignore_rest = o->rest_distance;
    if (o->output > SC_OUTPUT_ANY || o->kinds > SC_NEAR_EDGE_EDGE ||
        o->method > SC_NEAR_METHOD_BOXES)
        record_file_refuse(file, SC_ERROR_OPTION, NULL);
    else if (set->any && near_wants_list(set))
        record_file_refuse(file, SC_ERROR_OPTION, "the record asks for no list");
    return !file->error[0];
}

int near_query_replay(near_settings *set)
{
    record_file *file = set->replayed;
    near_answer answer;
    near_run run;
    uint32_t *objects = NULL;
    int status;
    memset(&answer, 0, sizeof answer);
    memset(&run, 0, sizeof run);
    run.set = set;
    answer.path = file->path;
    answer.mesh = &run.rest.mesh;
    answer.pose = &file->pose;
    bool done = use_record(set, file) && record_file_open(file, SC_WORKSPACE_NEAR, &run.rest);
    if (done && set->out_path && !(run.out = fopen(set->out_path, "w"))) {
        snprintf(file->error, sizeof file->error, "%s: cannot be written: %s", set->out_path,
                 strerror(errno));
        done = false;
    }
    near_report_head(set);
    if (run.out) near_report_pairs_head(run.out, set);
    if (done) {
        answer.vertex_objects = objects = record_file_vertex_objects(&run.rest);
        if (!objects) record_file_refuse(file, SC_ERROR_MEMORY, NULL);
        done = objects && ask(&run, &run.rest, &answer, file->error);
    }
    status = done ? near_report(&answer, set, run.out)
                  : near_report_failure(file->path, set, file->error);
    mesh_tally_free(&answer.tally);
    free(objects);
    return close_run(&run, status);
}
