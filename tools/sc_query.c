/*
 * sc-query: finds the self-collisions of mesh files.
 *
 * SPDX-License-Identifier: MIT
 *
 * Each file is a mesh of its own, or a pose of one mesh that is built once (--rest) or was built
 * before (--model). A file that cannot be done is reported and the others are still done. See
 * query_options.c for the options, and sc_query in starcontour.h for what a pair is.
 */
#include "batch.h"
#include "model_file.h"
#include "near_query.h"
#include "near_report.h"
#include "page_output.h"
#include "query_checks.h"
#include "query_options.h"
#include "query_pose.h"
#include "query_report.h"
#include "query_summary.h"
#include "query_text.h"
#include "query_threads.h"
#include "record_file.h"
#include "trace_query.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

/* Room for so many pairs at first. */
enum { LIST_ROOM = 65536 };

/* What to ask for one kind of pair. With list the pairs are wanted, else only their number. */
static sc_query_options make_options(const query_settings *set, uint32_t kind, bool list)
{
    sc_query_options options;
    memset(&options, 0, sizeof options);
    options.struct_size = sizeof options;
    options.output = set->any ? SC_OUTPUT_ANY : list ? SC_OUTPUT_PAIRS : SC_OUTPUT_COUNT;
    options.pairs = kind;
    options.contact = set->proper ? SC_CONTACT_PROPER : SC_CONTACT_TOUCHING;
    options.method = set->method;
    options.contour = set->method == SC_METHOD_SCTT ? set->contour : SC_CONTOUR_DEFAULT;
    options.rest_cache = set->no_rest_cache ? SC_REST_CACHE_OFF : SC_REST_CACHE_ON;
    options.simd = set->simd;
    options.budget = set->budget;
    options.tasks = query_threads_tasks();
    return options;
}

/* One query of one kind of pair. With list the pairs are kept, else only counted. */
static sc_status run_query(const query_subject *subject, const sc_pose *pose,
                           const query_settings *set, const sc_filter *filter, uint32_t kind,
                           query_list *list, query_answer *answer)
{
    sc_query_options options = make_options(set, kind, list != NULL);
    options.filter = filter;
    sc_result result;
    memset(&result, 0, sizeof result);
    result.struct_size = sizeof result;
    if (set->stats && kind == query_chosen_pairs(set)) {
        memset(&answer->stats, 0, sizeof answer->stats);
        answer->stats.struct_size = sizeof answer->stats;
        result.stats = &answer->stats;
    }
    if (list && !list->pairs) { /* so that one query does for a mesh with few of them */
        list->pairs = (sc_pair *)malloc(LIST_ROOM * sizeof *list->pairs);
        if (!list->pairs) return SC_ERROR_MEMORY;
        list->capacity = LIST_ROOM;
    }
    for (;;) {
        if (list) {
            result.pairs = list->pairs;
            result.capacity = list->capacity;
        }
        const double start = tool_clock();
        const sc_status status =
            sc_query(subject->model, subject->workspace, pose, &options, &result);
        answer->query_ms[kind] = tool_clock() - start;
        answer->counts[kind] = result.count;
        answer->known[kind] = status == SC_OK || status == SC_ERROR_INCOMPLETE;
        if (!list || result.count <= list->capacity) {
            if (answer->known[kind] && list) list->count = result.count;
            return status;
        }
        if (result.count > SIZE_MAX / sizeof(sc_pair)) return SC_ERROR_MEMORY;
        sc_pair *pairs = (sc_pair *)realloc(list->pairs, (size_t)result.count * sizeof *pairs);
        if (!pairs) return SC_ERROR_MEMORY;
        list->pairs = pairs;
        list->capacity = result.count;
    }
}

/* The filter for a model with this info; its arrays last until the next call. */
static bool make_filter(const sc_model_info *info, const query_settings *set, sc_filter *filter,
                        char error[MESH_FILE_ERROR_SIZE])
{
    if (set->given) {
        *filter = *set->given;
        return true;
    }
    if (!filter_file_apply(set->filters, info->vertex_count, info->triangle_count, filter, error))
        return false;
    filter->ignore_rings = set->ignore_rings;
    return true;
}

/* Writes the query that decides to a file. */
static bool write_record(const query_subject *subject, const sc_pose *pose,
                         const query_settings *set)
{
    sc_query_options options = make_options(set, query_chosen_pairs(set), query_wants_list(set));
    const record_question question = {.model = subject->model, .pose = pose, .query = &options};
    char error[MESH_FILE_ERROR_SIZE];
    sc_model_info info;
    sc_filter filter;
    memset(&info, 0, sizeof info);
    info.struct_size = sizeof info;
    const sc_status status = sc_model_get_info(subject->model, &info);
    if (status != SC_OK || !make_filter(&info, set, &filter, error)) {
        tool_error("%s", status == SC_OK ? error : sc_status_string(status));
        return false;
    }
    if (set->ignore_rings || set->ignore_path || set->groups_path) options.filter = &filter;
    return record_file_write(set->record_path, &question);
}

/* Where the pairs of a list meet. */
static sc_status find_contacts(const query_subject *subject, const sc_pose *pose,
                               const query_settings *set, query_list *list)
{
    free(list->contacts);
    list->contacts = list->count > SIZE_MAX / sizeof(sc_contact)
                         ? NULL
                         : (sc_contact *)malloc((size_t)list->count * sizeof(sc_contact) + 1);
    if (!list->contacts) return SC_ERROR_MEMORY;
    return sc_contacts(subject->model, pose, query_chosen_pairs(set), list->pairs, list->count,
                       list->contacts);
}

/* All queries of one pose, and what is listed besides; checks may be NULL. */
static bool run_pose(const query_subject *subject, const char *path, const sc_pose *pose,
                     const query_settings *set, query_list *list, query_checks *checks,
                     query_answer *answer, char error[MESH_FILE_ERROR_SIZE])
{
    const uint32_t chosen = query_chosen_pairs(set);
    answer->build_ms = subject->build_ms;
    answer->position_type = pose->position_type;
    answer->info.struct_size = sizeof answer->info;
    sc_status status = sc_model_get_info(subject->model, &answer->info);
    sc_filter filter;
    if (status == SC_OK && !make_filter(&answer->info, set, &filter, error)) return false;
    list->count = 0;
    for (uint32_t kind = 0; kind < 2 && status == SC_OK; kind++) {
        /* pairs to ignore are of one kind */
        if ((set->any || set->ignore_path || filter.ignore_count) && kind != chosen) continue;
        query_list *const kept =
            kind == chosen && (query_wants_list(set) || query_names_objects(set, answer->mesh) ||
                               query_wants_places(set, answer->mesh))
                ? list
                : NULL;
        status = run_query(subject, pose, set, &filter, kind, kept, answer);
        if (status != SC_ERROR_INCOMPLETE) continue;
        answer->incomplete = true;
        status = SC_OK;
    }
    if (status == SC_OK && set->contacts) status = find_contacts(subject, pose, set, list);
    if (status == SC_OK && checks && query_wants_checks(set, answer->mesh)) {
        status = query_checks_mesh(checks, answer->mesh, subject, set);
        if (status == SC_OK)
            status = query_checks_pose(checks, answer->mesh, subject->model, pose, set, list);
        if (!set->only_collisions) answer->checks = checks;
    }
    answer->collides = answer->counts[chosen] > 0;
    if (status != SC_OK) {
        snprintf(error, MESH_FILE_ERROR_SIZE, "%s: %s", path, tool_why(status));
    }
    return status == SC_OK;
}

/* Only the star test uses marks. */
static uint32_t rest_marks(const query_settings *set)
{
    return set->method == SC_METHOD_SCTT && set->contour == SC_CONTOUR_STAR && !set->no_rest_cache
               ? SC_REST_MARKED
               : SC_REST_UNMARKED;
}

/* What --method auto is on a model that was saved, or in a record that names none. */
static void follow_model(query_settings *set, const sc_model *model)
{
    sc_model_info info;
    memset(&info, 0, sizeof info);
    info.struct_size = sizeof info;
    if (set->method != SC_METHOD_DEFAULT || sc_model_get_info(model, &info) != SC_OK) return;
    set->method = info.node_count ? SC_METHOD_SCTT : SC_METHOD_AABB;
}

/* Prints what came of a pose, and adds it to the summary. */
static int report(const query_answer *answer, const query_settings *set, bool done,
                  const char *error, FILE *out, const query_list *list, query_summary *summary)
{
    const int status = done ? query_report(answer, set, list, out)
                            : query_report_failure(answer->path, set, error);
    query_summary_add(summary, status, answer->collides, answer->path, NULL,
                      set->any ? 0 : answer->counts[query_chosen_pairs(set)]);
    return status;
}

/* What all files of a run share. */
typedef struct query_run {
    const query_subject *rest; /* the common subject of --rest or --model, or NULL */
    FILE *out;
    query_list list;
    query_checks checks; /* of that subject's mesh, or of the last one */
    query_summary summary;
    page_output output; /* of --html or --png */
} query_run;

static bool add_to_page(query_run *run, const query_settings *set, const sc_pose *pose,
                        const query_answer *answer)
{
    const uint32_t kind = query_chosen_pairs(set);
    const page_frame frame = {answer->path,         answer->mesh,
                              &run->checks.mesh,    pose,
                              &run->checks.places,  run->checks.degenerate_faces,
                              answer->counts[kind], answer->query_ms[kind],
                              answer->incomplete};
    if (!run->output.page || page_add(run->output.page, &frame)) return true;
    tool_error("%s: out of memory for the page", answer->path);
    return false;
}

/* Does one file. Returns an exit status. */
static int do_file(const char *path, const query_settings *set, query_run *run)
{
    char error[MESH_FILE_ERROR_SIZE];
    query_pose pose;
    query_answer answer;
    memset(&answer, 0, sizeof answer);
    answer.path = path;

    const query_subject_how how = {set->weld, set->partition, rest_marks(set), set->content,
                                   0,         false};
    bool done = query_pose_read(&pose, path, run->rest, &how, error);
    answer.mesh = pose.mesh;
    answer.rounded = pose.rounded;
    answer.has_animation = pose.has_animation;
    const bool recorded = !done || !set->record_path || write_record(pose.subject, &pose.pose, set);
    if (!set->rest_path) query_checks_free(&run->checks); /* they are of one mesh */
    if (done)
        done =
            run_pose(pose.subject, path, &pose.pose, set, &run->list, &run->checks, &answer, error);
    int status = report(&answer, set, done, error, run->out, &run->list, &run->summary);
    if (!recorded) status = TOOL_FAILED;
    if (done && set->ply_path && !query_report_ply(pose.mesh, &pose.pose, set, &run->checks.places))
        status = TOOL_FAILED;
    if (done && !add_to_page(run, set, &pose.pose, &answer)) status = TOOL_FAILED;
    query_pose_free(&pose);
    return status;
}

/* Sets what a record asks for. */
static bool use_options(query_settings *set, const sc_query_options *options)
{
    set->pairs = options->pairs;
    set->proper = options->contact == SC_CONTACT_PROPER;
    set->any = options->output == SC_OUTPUT_ANY;
    if (options->method != SC_METHOD_DEFAULT) set->method = options->method;
    if (options->contour != SC_CONTOUR_DEFAULT) set->contour = options->contour;
    set->no_rest_cache = options->rest_cache == SC_REST_CACHE_OFF;
    set->simd = options->simd;
    set->budget = options->budget;
    if (options->filter) {
        set->given = options->filter;
        set->ignore_rings = options->filter->ignore_rings;
    }
    return options->output <= SC_OUTPUT_ANY && options->pairs <= SC_PAIRS_EDGE &&
           options->contact <= SC_CONTACT_PROPER && options->rest_cache <= SC_REST_CACHE_OFF;
}

/* Asks the query of --replay again. */
static int do_replay(query_settings *set, FILE *out, query_list *list)
{
    record_file *file = set->replayed;
    query_answer answer;
    query_subject subject;
    memset(&answer, 0, sizeof answer);
    memset(&subject, 0, sizeof subject);
    answer.path = set->replay_path;
    bool done = !file->error[0];
    if (done && !use_options(set, &file->query)) {
        record_file_refuse(file, SC_ERROR_OPTION, NULL);
        done = false;
    }
    if (done && query_wants_list(set) && set->any) {
        record_file_refuse(file, SC_ERROR_OPTION, "the record asks for no list");
        done = false;
    }
    if (done) done = record_file_open(file, 0, &subject);
    if (done) follow_model(set, subject.model);
    if (done && out) query_report_pairs_head(out, set);
    if (done)
        done = run_pose(&subject, set->replay_path, &file->pose, set, list, NULL, &answer,
                        file->error);
    const int status = done ? query_report(&answer, set, list, out)
                            : query_report_failure(set->replay_path, set, file->error);
    set->given = NULL;
    query_subject_free(&subject);
    return status;
}

/* What a process that does one mesh of many needs. */
typedef struct batch_context {
    const query_settings *set;
    const query_subject *rest; /* as of do_file */
} batch_context;

static int do_batch_file(void *user, const char *path)
{
    const batch_context *context = (const batch_context *)user;
    query_run run;
    memset(&run, 0, sizeof run);
    run.rest = context->rest;
    const int status = do_file(path, context->set, &run);
    free(run.list.pairs);
    free(run.list.contacts);
    query_checks_free(&run.checks);
    return status;
}

/* Many meshes, each by a process of its own. */
static int do_batch(const query_settings *set, const query_subject *rest)
{
    static const char *const optional[] = {"rest",   "model", "ignore_rings", "ignore", "groups",
                                           "budget", NULL};
    static const char *const members[] = {"build_ms", "stats", "contacts", NULL};
    const bool wants[] = {set->timings, set->stats, set->contacts};
    const bool is_edge = query_chosen_pairs(set) == SC_PAIRS_EDGE;
    query_settings own = *set;
    own.json = true;
    batch_context context = {&own, rest};
    batch_lines lines = {"mesh",
                         "collides",
                         {is_edge ? "edge_triangle_pairs" : "triangle_pairs", NULL},
                         cJSON_CreateObject(),
                         members,
                         wants,
                         optional};
    query_report_add_settings(lines.settings, set);
    const int status = batch_run(set, &lines, do_batch_file, &context);
    cJSON_Delete(lines.settings);
    return status;
}

static int do_files(query_settings *set)
{
    query_subject rest;
    query_run run;
    memset(&run, 0, sizeof run);
    int status = TOOL_CLEAN;

    const query_subject_how how = {set->weld, set->partition, rest_marks(set), set->content, 0,
                                   true};
    char error[MESH_FILE_ERROR_SIZE];
    if (!query_subject_begin(&rest, set->rest_path, set->model_path, &how, error))
        return query_report_failure(set->rest_path ? set->rest_path : set->model_path, set, error);
    if (set->model_path) follow_model(set, rest.model);
    if (status == TOOL_CLEAN && set->out_path) {
        run.out = fopen(set->out_path, "w");
        if (!run.out) {
            tool_error("%s: cannot be written: %s", set->out_path, strerror(errno));
            status = TOOL_FAILED;
        } else if (!set->replay_path) {
            query_report_pairs_head(run.out, set);
        }
    }
    run.rest = set->rest_path || set->model_path ? &rest : NULL;
    if (status == TOOL_CLEAN && !page_output_begin(&run.output, set->html_path, set->png_path))
        status = TOOL_FAILED;
    if (status == TOOL_CLEAN && set->jsonl_path) {
        status = do_batch(set, run.rest);
    } else if (status == TOOL_CLEAN) {
        query_report_head(set);
        if (set->replay_path) status = do_replay(set, run.out, &run.list);
        for (int i = 0; i < set->path_count; i++) {
            const int done = do_file(set->paths[i], set, &run);
            status = query_text_worse(status, done);
        }
        if (!query_summary_print(&run.summary, false, set->json)) status = TOOL_FAILED;
    }
    if (!page_output_end(&run.output)) status = TOOL_FAILED;
    if (!tool_close(run.out, set->out_path)) status = TOOL_FAILED;
    free(run.list.pairs);
    free(run.list.contacts);
    query_checks_free(&run.checks);
    query_subject_free(&rest);
    return status;
}

/* Between frames, in place of do_files. */
static int do_steps(query_settings *set)
{
    step_settings *step = &set->step;
    step->weld = set->weld;
    step->partition = set->partition;
    step->contour = set->contour;
    step->rest_path = set->rest_path;
    step->model_path = set->model_path;
    step->out_path = set->out_path;
    step->budget = set->budget;
    step->ignore_rings = set->ignore_rings;
    step->ignore_path = set->ignore_path;
    step->groups_path = set->groups_path;
    step->filters = set->filters;
    step->stencils = set->near.stencils;
    step->any = set->any;
    step->json = set->json;
    step->stats = set->stats;
    step->record_path = set->record_path;
    step->replayed = set->replayed;
    return step->replayed ? step_query_replay(step)
                          : step_query_frames(set->paths, set->path_count, step);
}

/* What is near, in place of do_files. */
static int do_near(query_settings *set)
{
    near_settings *near = &set->near;
    near->weld = set->weld;
    near->partition = set->partition;
    near->rest_path = set->rest_path;
    near->model_path = set->model_path;
    near->out_path = set->out_path;
    near->ply_path = set->ply_path;
    near->ignore_path = set->ignore_path;
    near->groups_path = set->groups_path;
    near->ignores_rest = set->step.ignores_rest;
    near->ignore_rest = set->step.ignore_rest;
    near->filters = set->filters;
    near->ignore_rings = set->ignore_rings;
    near->budget = set->budget;
    near->any = set->any;
    near->json = set->json;
    near->stats = set->stats;
    near->timings = !set->jsonl_path || set->timings;
    near->is_line = set->jsonl_path != NULL;
    if (near->is_line) return near_query_batch(set);
    near->record_path = set->record_path;
    near->replayed = set->replayed;
    return near->replayed ? near_query_replay(near)
                          : near_query_files(set->paths, set->path_count, near);
}

/* Contours, in place of do_files. */
static int do_trace(const query_settings *set)
{
    trace_settings trace;
    memset(&trace, 0, sizeof trace);
    trace.weld = set->weld;
    trace.partition = set->partition;
    trace.rest_path = set->rest_path;
    trace.model_path = set->model_path;
    trace.ply_path = set->ply_path;
    trace.html_path = set->html_path;
    trace.png_path = set->png_path;
    trace.list = set->near.list;
    trace.json = set->json;
    return trace_query_files(set->paths, set->path_count, &trace);
}

/* Asks what a record of any kind asks. */
static int do_record(query_settings *set)
{
    record_file file;
    int status = TOOL_FAILED;
    set->replayed = &file;
    if (record_file_read(&file, set->replay_path)) {
        set->is_step = file.record.kind == SC_RECORD_STEP;
        set->is_near = file.record.kind == SC_RECORD_NEAR;
    }
    if (set->contacts && (set->is_step || set->is_near))
        tool_error("%s: the record asks for no pairs of triangles, of which there are --contacts",
                   set->replay_path);
    else
        status = set->is_step ? do_steps(set) : set->is_near ? do_near(set) : do_files(set);
    record_file_free(&file);
    return status;
}

int main(int argc, char **argv)
{
    static char name[] = "sc-query";
    query_settings set;
    filter_file filters;
    char error[MESH_FILE_ERROR_SIZE];
    argv[0] = name; /* in messages of getopt_long, too */
    tool_set_name(name);
    int status = query_options_read(argc, argv, &set);
    if (status != QUERY_OPTIONS_READ) return tool_finish(status);
    if (!query_threads_start(set.threads)) {
        tool_error("--threads: they cannot be started");
        return tool_finish(TOOL_FAILED);
    }
    status = TOOL_FAILED;
    memset(&filters, 0, sizeof filters);
    set.filters = &filters;
    const bool is_plain = !set.is_step && !set.is_near;
    if (filter_file_read(&filters, set.ignore_path, set.groups_path,
                         is_plain ? query_chosen_pairs(&set) : FILTER_FILE_STEP, error))
        status = set.replay_path ? do_record(&set)
                 : set.is_step   ? do_steps(&set)
                 : set.is_near   ? do_near(&set)
                 : set.is_trace  ? do_trace(&set)
                                 : do_files(&set);
    else { /* one of the two files, with which the message begins */
        const char *path = set.ignore_path;
        if (!path || (set.groups_path && !strncmp(error, set.groups_path, strlen(set.groups_path))))
            path = set.groups_path;
        set.near.json = set.json;
        if (set.is_near)
            near_report_failure(path, &set.near, error);
        else
            query_report_failure(path, &set, error);
    }
    filter_file_free(&filters);
    query_threads_stop();
    return tool_finish(status);
}
