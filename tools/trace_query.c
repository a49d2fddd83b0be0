/*
 * sc-query --trace; see trace_query.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "trace_query.h"

#include "frame_paths.h"
#include "page_output.h"
#include "query_pose.h"
#include "query_summary.h"
#include "query_text.h"
#include "query_threads.h"
#include "trace_report.h"

#include <stdlib.h>
#include <string.h>

typedef struct trace_run {
    const trace_settings *set;
    const char *rest_path; /* --rest, or the first frame of a pattern, or NULL */
    query_subject rest;    /* of that, or the saved model */
    query_summary summary;
    page_output output; /* of --html or --png */
    /* Arrays of one pose; they grow and are kept. */
    sc_pair *pairs;
    sc_trace_node *nodes;
    sc_trace_contour *contours;
    trace_listed *listed; /* of contours */
    sc_trace_triple *triples;
    uint64_t pair_capacity, node_capacity, contour_capacity, listed_capacity, triple_capacity;
    /* With a page. */
    sc_region *regions;
    sc_contour_sides *sides;  /* of contours */
    uint32_t *vertex_regions; /* of each vertex */
    uint64_t region_capacity, sides_capacity, vertex_capacity;
} trace_run;

/* ------------------------------------------------------------------------------------------------
 * Asking
 */

/* Makes room for count elements of some bytes each, if there is less; what was in *array is lost.
   False if there is no memory. */
static bool make_room(void **array, uint64_t *capacity, uint64_t count, size_t size)
{
    if (count <= *capacity) return true;
    free(*array);
    *array = count > SIZE_MAX / size ? NULL : malloc((size_t)count * size);
    *capacity = *array ? count : 0;
    return *array != NULL;
}

static bool make_room_for_pairs(trace_run *run, uint64_t count)
{
    void *array = run->pairs;
    const bool made = make_room(&array, &run->pair_capacity, count, sizeof *run->pairs);
    run->pairs = (sc_pair *)array;
    return made;
}

static bool make_room_for_trace(trace_run *run, uint64_t nodes, uint64_t contours)
{
    void *array = run->nodes;
    bool made = make_room(&array, &run->node_capacity, nodes, sizeof *run->nodes);
    run->nodes = (sc_trace_node *)array;
    array = run->contours;
    made &= make_room(&array, &run->contour_capacity, contours, sizeof *run->contours);
    run->contours = (sc_trace_contour *)array;
    return made;
}

static bool make_room_for_list(trace_run *run, uint64_t contours)
{
    void *array = run->listed;
    const bool made = make_room(&array, &run->listed_capacity, contours, sizeof *run->listed);
    run->listed = (trace_listed *)array;
    return made;
}

static bool make_room_for_triples(trace_run *run, uint64_t count)
{
    void *array = run->triples;
    const bool made = make_room(&array, &run->triple_capacity, count, sizeof *run->triples);
    run->triples = (sc_trace_triple *)array;
    return made;
}

static bool make_room_for_regions(trace_run *run, uint64_t regions, uint64_t contours,
                                  uint64_t vertices)
{
    void *array = run->regions;
    bool made = make_room(&array, &run->region_capacity, regions, sizeof *run->regions);
    run->regions = (sc_region *)array;
    array = run->sides;
    made &= make_room(&array, &run->sides_capacity, contours, sizeof *run->sides);
    run->sides = (sc_contour_sides *)array;
    array = run->vertex_regions;
    made &= make_room(&array, &run->vertex_capacity, vertices, sizeof *run->vertex_regions);
    run->vertex_regions = (uint32_t *)array;
    return made;
}

/* All pairs of edges and triangles. */
static sc_status find_pairs(trace_run *run, const query_subject *subject, const sc_pose *pose,
                            trace_answer *answer)
{
    sc_query_options options;
    sc_result result;
    sc_status status;
    memset(&options, 0, sizeof options);
    memset(&result, 0, sizeof result);
    options.struct_size = sizeof options;
    options.output = SC_OUTPUT_PAIRS;
    options.pairs = SC_PAIRS_EDGE;
    options.contact = SC_CONTACT_TOUCHING;
    options.tasks = query_threads_tasks();
    result.struct_size = sizeof result;
    do {
        if (!make_room_for_pairs(run, result.count)) return SC_ERROR_MEMORY;
        result.pairs = run->pairs;
        result.capacity = run->pair_capacity;
        const double start = tool_clock();
        status = sc_query(subject->model, subject->workspace, pose, &options, &result);
        answer->query_ms = tool_clock() - start;
    } while (status == SC_ERROR_SHORT_BUFFER);
    answer->pair_count = result.count;
    return status;
}

/* Where contours cross, of a pose of which they are known. */
static sc_status find_triples(trace_run *run, const query_subject *subject, const sc_pose *pose,
                              const sc_trace_result *trace, const sc_trace_options *options,
                              trace_answer *answer)
{
    sc_triples_result result;
    sc_status status;
    memset(&result, 0, sizeof result);
    result.struct_size = sizeof result;
    do {
        if (!make_room_for_triples(run, result.count)) return SC_ERROR_MEMORY;
        result.triples = run->triples;
        result.capacity = run->triple_capacity;
        status = sc_trace_triples(subject->model, pose, trace, options, &result);
    } while (status == SC_ERROR_SHORT_BUFFER);
    answer->triples = run->triples;
    answer->triple_count = result.count;
    return status;
}

/* The regions of a pose, of which contours are known. */
static sc_status find_regions(trace_run *run, const query_subject *subject, const sc_pose *pose,
                              const sc_trace_result *trace, const sc_trace_options *options,
                              trace_answer *answer)
{
    sc_regions_result result;
    sc_status status;
    memset(&result, 0, sizeof result);
    result.struct_size = sizeof result;
    do {
        if (!make_room_for_regions(run, result.region_count, trace->contour_count,
                                   answer->info.vertex_count))
            return SC_ERROR_MEMORY;
        result.regions = run->regions;
        result.region_capacity = run->region_capacity;
        result.vertex_regions = run->vertex_regions;
        result.sides = run->sides;
        status = sc_trace_regions(subject->model, pose, trace, options, &result);
    } while (status == SC_ERROR_SHORT_BUFFER);
    answer->regions = run->regions;
    answer->region_count = result.region_count;
    answer->vertex_regions = run->vertex_regions;
    return status;
}

static sc_status trace_pairs(trace_run *run, const query_subject *subject, const sc_pose *pose,
                             trace_answer *answer)
{
    sc_trace_options options;
    sc_trace_result result;
    sc_status status;
    memset(&options, 0, sizeof options);
    memset(&result, 0, sizeof result);
    options.struct_size = sizeof options;
    options.hooks = tool_hooks();
    options.tasks = query_threads_tasks();
    result.struct_size = sizeof result;
    do {
        if (!make_room_for_trace(run, result.node_count, result.contour_count))
            return SC_ERROR_MEMORY;
        result.nodes = run->nodes;
        result.node_capacity = run->node_capacity;
        result.contours = run->contours;
        result.contour_capacity = run->contour_capacity;
        const double start = tool_clock();
        status = sc_trace(subject->model, pose, run->pairs, answer->pair_count, &options, &result);
        answer->trace_ms = tool_clock() - start;
    } while (status == SC_ERROR_SHORT_BUFFER);
    if (status == SC_OK) status = find_triples(run, subject, pose, &result, &options, answer);
    if (status == SC_OK && run->output.page)
        status = find_regions(run, subject, pose, &result, &options, answer);
    if (status != SC_OK) return status;
    if (!make_room_for_list(run, result.contour_count)) return SC_ERROR_MEMORY;
    for (uint64_t i = 0; i < result.contour_count; i++) {
        memset(&run->listed[i], 0, sizeof run->listed[i]);
        run->listed[i].contour = run->contours[i];
        if (run->output.page) run->listed[i].sides = run->sides[i];
    }
    answer->nodes = run->nodes;
    answer->node_count = result.node_count;
    answer->contours = run->listed;
    answer->contour_count = result.contour_count;
    return SC_OK;
}

/* All about one pose. */
static bool ask(trace_run *run, const query_subject *subject, const sc_pose *pose,
                trace_answer *answer, char error[MESH_FILE_ERROR_SIZE])
{
    answer->build_ms = subject->build_ms;
    answer->position_type = pose->position_type;
    answer->info.struct_size = sizeof answer->info;
    sc_status status = sc_model_get_info(subject->model, &answer->info);
    if (status == SC_OK) status = find_pairs(run, subject, pose, answer);
    if (status == SC_OK) status = trace_pairs(run, subject, pose, answer);
    if (status != SC_OK)
        snprintf(error, MESH_FILE_ERROR_SIZE, "%s: %s", answer->path, tool_why(status));
    else
        trace_report_sort(answer);
    return status == SC_OK;
}

static bool add_to_page(const trace_run *run, const query_pose *pose, const trace_answer *answer)
{
    const page_trace frame = {answer->path, pose->mesh, &pose->pose, answer,
                              answer->query_ms + answer->trace_ms};
    if (!run->output.page || page_add_trace(run->output.page, &frame)) return true;
    tool_error("%s: out of memory for the page", answer->path);
    return false;
}

/* ------------------------------------------------------------------------------------------------
 * Files
 */

/* How to build. For one query the plain tree alone pays, which is built fastest. */
static query_subject_how how_to_build(const trace_run *run)
{
    const trace_settings *set = run->set;
    const bool is_plain = !run->rest_path && set->partition == TOOL_PARTITION_FAST;
    const query_subject_how how = {set->weld, set->partition,
                                   0,         is_plain ? SC_MODEL_BOXES : SC_MODEL_FULL,
                                   0,         run->rest_path != NULL};
    return how;
}

static int do_file(trace_run *run, const char *path)
{
    const trace_settings *set = run->set;
    char error[MESH_FILE_ERROR_SIZE];
    query_pose pose;
    trace_answer answer;
    memset(&answer, 0, sizeof answer);
    answer.path = path;
    const query_subject_how how = how_to_build(run);
    bool done = query_pose_read(&pose, path, &run->rest, &how, error);
    answer.rounded = pose.rounded;
    answer.has_animation = pose.has_animation;
    if (done) done = ask(run, pose.subject, &pose.pose, &answer, error);
    int status = done ? trace_report(&answer, set) : trace_report_failure(path, set, error);
    if (done && set->ply_path && !trace_report_ply(&answer, set)) status = TOOL_FAILED;
    if (done && !add_to_page(run, &pose, &answer)) status = TOOL_FAILED;
    query_summary_add(&run->summary, status, answer.contour_count > 0, path, NULL,
                      answer.pair_count);
    query_pose_free(&pose);
    return status;
}

static int do_files(trace_run *run, char *const *paths, int count)
{
    const trace_settings *set = run->set;
    char error[MESH_FILE_ERROR_SIZE];
    int status = TOOL_CLEAN;
    const query_subject_how how = how_to_build(run);
    if (!query_subject_begin(&run->rest, run->rest_path, set->model_path, &how, error))
        return trace_report_failure(run->rest_path ? run->rest_path : set->model_path, set, error);
    if (!page_output_begin(&run->output, set->html_path, set->png_path)) return TOOL_FAILED;
    trace_report_head(set);
    for (int i = 0; i < count; i++) status = query_text_worse(status, do_file(run, paths[i]));
    if (!query_summary_print(&run->summary, false, set->json)) status = TOOL_FAILED;
    if (!page_output_end(&run->output)) status = TOOL_FAILED;
    return status;
}

/* Also those of a pattern. */
static bool spares_files(char *const *paths, int count, const trace_settings *set)
{
    for (int i = 0; i < count; i++) {
        if (!tool_spares(set->ply_path, paths[i]) || !tool_spares(set->html_path, paths[i]) ||
            !tool_spares(set->png_path, paths[i]))
            return false;
    }
    return true;
}

int trace_query_files(char **paths, int count, const trace_settings *set)
{
    char error[MESH_FILE_ERROR_SIZE];
    frame_paths found = {NULL, 0};
    int status = TOOL_FAILED;
    trace_run run;
    memset(&run, 0, sizeof run);
    run.set = set;
    run.rest_path = set->rest_path;
    if (!frame_paths_expand(&found, &paths, &count, error)) {
        tool_error("%s", error);
        return TOOL_FAILED;
    }
    if (found.count && !set->rest_path && !set->model_path) run.rest_path = paths[0];
    if ((set->ply_path || set->png_path) && count > 1)
        tool_error("--%s takes one mesh only; see sc-query --help", set->ply_path ? "ply" : "png");
    else if (spares_files(paths, count, set))
        status = do_files(&run, paths, count);
    free(run.pairs);
    free(run.nodes);
    free(run.contours);
    free(run.listed);
    free(run.triples);
    free(run.regions);
    free(run.sides);
    free(run.vertex_regions);
    query_subject_free(&run.rest);
    frame_paths_free(&found);
    return status;
}
