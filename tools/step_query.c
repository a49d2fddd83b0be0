/*
 * sc-query --step; see step_query.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "step_query.h"

#include "feature_pairs.h"
#include "frame_paths.h"
#include "query_subject.h"
#include "query_summary.h"
#include "query_text.h"
#include "query_threads.h"
#include "record_file.h"
#include "stencil_text.h"
#include "tool_json.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

const tool_choice step_methods[] = {{"sctt", SC_STEP_METHOD_SCTT},
                                    {"two-boxes", SC_STEP_METHOD_TWO_BOXES},
                                    {"swept", SC_STEP_METHOD_SWEPT},
                                    {NULL, 0}};

/* A frame's positions. */
typedef struct frame {
    mesh_pose pose;
    char error[MESH_FILE_ERROR_SIZE]; /* why it could not be read, or empty */
} frame;

/* Pairs of one kind; grows and is kept. */
typedef struct step_list {
    sc_pair *pairs;
    double *times;
    uint64_t capacity;
} step_list;

/* What there is to know about a step. */
typedef struct step_answer {
    const char *start, *end;
    sc_model_info info;
    double build_ms, query_ms, candidates_ms;
    uint64_t counts[KINDS], candidates[KINDS];
    bool candidates_known, collides, incomplete;
    bool unrecorded; /* --record failed, which was told */
    double earliest;
    sc_stats stats;
    mesh_tally tally;            /* pairs by their objects, if there are several */
    bool rounded, has_animation; /* either frame, as in mesh_file */
    uint32_t position_type;      /* SC_DOUBLE if either frame has doubles */
} step_answer;

typedef struct step_run {
    const step_settings *set;
    query_subject subject;
    const mesh_file *mesh; /* the subject's, or of the first frame with a saved model */
    mesh_file first;
    frame frames[2];
    step_list lists[KINDS];
    uint32_t *vertex_objects; /* where they are told */
    query_summary summary;
    FILE *out;
    sc_filter filters[KINDS];
    sc_pose rest;     /* the mesh as it was read */
    sc_pose poses[2]; /* of the step that is asked about */
} step_run;

/* Whether the pairs between each two objects are counted. */
static bool names_objects(const step_run *run)
{
    return run->mesh->object_count > 1 && !run->set->any;
}

static bool wants_list(const step_run *run)
{
    return run->set->out_path || run->set->times || run->set->stencils || names_objects(run);
}

/* ------------------------------------------------------------------------------------------------
 * Asking
 */

static bool grow(step_list *list, uint64_t count)
{
    if (count <= list->capacity) return true;
    if (count > SIZE_MAX / sizeof(sc_pair)) return false;
    free(list->pairs);
    free(list->times);
    list->pairs = (sc_pair *)malloc((size_t)count * sizeof(sc_pair));
    list->times = (double *)malloc((size_t)count * sizeof(double));
    list->capacity = list->pairs && list->times ? count : 0;
    return list->capacity == count;
}

static sc_step_options make_options(const step_run *run)
{
    const step_settings *set = run->set;
    sc_step_options options;
    memset(&options, 0, sizeof options);
    options.struct_size = sizeof options;
    options.method = set->method;
    options.contour = set->method == SC_STEP_METHOD_SCTT ? set->contour : SC_CONTOUR_DEFAULT;
    options.separation = set->separation;
    options.tolerance = set->tolerance;
    options.budget = set->budget;
    if (set->ignore_rings || set->ignore_path || set->groups_path) {
        options.vertex_face_filter = &run->filters[VERTEX_FACE];
        options.edge_edge_filter = &run->filters[EDGE_EDGE];
    }
    if (set->ignores_rest) {
        options.rest = &run->rest;
        options.rest_distance = set->ignore_rest;
    }
    if (set->replayed) options = set->replayed->step;
    options.output = set->any ? SC_OUTPUT_ANY : wants_list(run) ? SC_OUTPUT_PAIRS : SC_OUTPUT_COUNT;
    options.times = set->any ? SC_STEP_TIMES_NONE : SC_STEP_TIMES_EARLIEST;
    if (options.output == SC_OUTPUT_PAIRS) options.times = SC_STEP_TIMES_EACH;
    options.tasks = query_threads_tasks();
    return options;
}

static sc_status find_collisions(step_run *run, step_answer *answer)
{
    const sc_pose *poses = run->poses;
    const sc_step_options options = make_options(run);
    sc_step_result result;
    memset(&result, 0, sizeof result);
    result.struct_size = sizeof result;
    if (run->set->record_path) {
        const record_question question = {
            .model = run->subject.model, .pose = &poses[0], .end = &poses[1], .step = &options};
        answer->unrecorded = !record_file_write(run->set->record_path, &question);
    }
    if (run->set->stats) {
        answer->stats.struct_size = sizeof answer->stats;
        result.stats = &answer->stats;
    }
    sc_status status;
    do {
        if (options.output == SC_OUTPUT_PAIRS) {
            if (!grow(&run->lists[VERTEX_FACE], result.vertex_face_count) ||
                !grow(&run->lists[EDGE_EDGE], result.edge_edge_count))
                return SC_ERROR_MEMORY;
            result.vertex_faces = run->lists[VERTEX_FACE].pairs;
            result.vertex_face_times = run->lists[VERTEX_FACE].times;
            result.vertex_face_capacity = run->lists[VERTEX_FACE].capacity;
            result.edge_edges = run->lists[EDGE_EDGE].pairs;
            result.edge_edge_times = run->lists[EDGE_EDGE].times;
            result.edge_edge_capacity = run->lists[EDGE_EDGE].capacity;
        }
        const double start = tool_clock();
        status = sc_query_step(run->subject.model, run->subject.workspace, &poses[0], &poses[1],
                               &options, &result);
        answer->query_ms = tool_clock() - start;
    } while (options.output == SC_OUTPUT_PAIRS && status != SC_OK &&
             (result.vertex_face_count > result.vertex_face_capacity ||
              result.edge_edge_count > result.edge_edge_capacity));
    answer->counts[VERTEX_FACE] = result.vertex_face_count;
    answer->counts[EDGE_EDGE] = result.edge_edge_count;
    answer->collides = result.collides != 0;
    answer->earliest = result.earliest;
    answer->incomplete = status == SC_ERROR_INCOMPLETE;
    return answer->incomplete ? SC_OK : status;
}

/* How many pairs boxes and culling leave; not with a budget, which is the collisions'. */
static sc_status count_candidates(step_run *run, step_answer *answer)
{
    sc_step_options options = make_options(run);
    options.output = SC_OUTPUT_COUNT;
    options.pairs = SC_STEP_CANDIDATES;
    options.times = SC_STEP_TIMES_NONE;
    sc_step_result result;
    memset(&result, 0, sizeof result);
    result.struct_size = sizeof result;
    const double start = tool_clock();
    const sc_status status = sc_query_step(run->subject.model, run->subject.workspace,
                                           &run->poses[0], &run->poses[1], &options, &result);
    answer->candidates_ms = tool_clock() - start;
    answer->candidates[VERTEX_FACE] = result.vertex_face_count;
    answer->candidates[EDGE_EDGE] = result.edge_edge_count;
    answer->candidates_known = status == SC_OK;
    return status;
}

/* How many pairs there are between each two objects; false if there is no memory. */
static bool count_objects(step_run *run, step_answer *answer)
{
    if (!names_objects(run)) return true;
    for (int kind = 0; kind < KINDS; kind++) {
        if (!feature_pairs_tally(&answer->tally, run->mesh, run->vertex_objects, kind,
                                 run->lists[kind].pairs, answer->counts[kind]))
            return false;
    }
    mesh_tally_sort(&answer->tally);
    return true;
}

static bool ask(step_run *run, const sc_pose poses[2], step_answer *answer,
                char error[MESH_FILE_ERROR_SIZE])
{
    memcpy(run->poses, poses, sizeof run->poses);
    answer->build_ms = run->subject.build_ms;
    answer->position_type =
        poses[0].position_type == SC_DOUBLE ? SC_DOUBLE : poses[1].position_type;
    answer->info.struct_size = sizeof answer->info;
    sc_status status = sc_model_get_info(run->subject.model, &answer->info);
    if (status == SC_OK) status = find_collisions(run, answer);
    if (status == SC_OK && !run->set->any && !run->set->budget)
        status = count_candidates(run, answer);
    if (status == SC_OK && !count_objects(run, answer)) status = SC_ERROR_MEMORY;
    if (status != SC_OK)
        snprintf(error, MESH_FILE_ERROR_SIZE, "%s to %s: %s", answer->start, answer->end,
                 tool_why(status));
    return status == SC_OK;
}

static bool ask_frames(step_run *run, const frame *from, const frame *to, step_answer *answer,
                       char error[MESH_FILE_ERROR_SIZE])
{
    const uint32_t count = run->mesh->vertex_count;
    const sc_pose poses[2] = {tool_pose(from->pose.positions, from->pose.position_type, count),
                              tool_pose(to->pose.positions, to->pose.position_type, count)};
    answer->rounded = from->pose.rounded || to->pose.rounded;
    answer->has_animation = from->pose.has_animation || to->pose.has_animation;
    return ask(run, poses, answer, error);
}

/* ------------------------------------------------------------------------------------------------
 * Telling
 */

static void print_table_head(const step_settings *set)
{
    printf("%10s %10s %14s %14s %12s %10s %9s %9s  %s\n", "vertices", "triangles",
           set->any ? "collides" : "vertex-face", set->any ? "" : "edge-edge", "candidates",
           "earliest", "build ms", "query ms", "step");
}

/* Of the table and of the file of pairs. */
static void print_heads(const step_run *run)
{
    if (!run->set->json) print_table_head(run->set);
    if (run->out) fputs("start,end,kind,object_a,face_a,object_b,face_b,a,b,time\n", run->out);
}

/* What is done with a pair of a list; stencil: its closest points, or NULL where they are not asked
   for. */
typedef void step_visit(void *context, const step_run *run, int kind, uint64_t i,
                        const sc_step_stencil *stencil);

/* Visits all pairs in the order of the lists. Closest points are found for some at a time, as those
   of all together would be thirty times as long as the lists. */
static sc_status visit_pairs(const step_answer *answer, const step_run *run, step_visit *visit,
                             void *context)
{
    enum { SOME = 256 };
    static const uint32_t kinds[KINDS] = {SC_NEAR_VERTEX_FACE, SC_NEAR_EDGE_EDGE};
    const bool wanted = run->set->stencils;
    sc_step_stencil *stencils = wanted ? (sc_step_stencil *)malloc(SOME * sizeof *stencils) : NULL;
    sc_status status = stencils || !wanted ? SC_OK : SC_ERROR_MEMORY;
    for (int kind = 0; kind < KINDS; kind++) {
        const step_list *list = &run->lists[kind];
        const uint64_t count = answer->counts[kind];
        for (uint64_t first = 0; status == SC_OK && first < count; first += SOME) {
            const uint64_t some = count - first < SOME ? count - first : SOME;
            if (wanted)
                status = sc_step_stencils(run->subject.model, &run->poses[0], &run->poses[1],
                                          kinds[kind], list->pairs + first, list->times + first,
                                          some, stencils);
            for (uint64_t i = 0; status == SC_OK && i < some; i++)
                visit(context, run, kind, first + i, wanted ? &stencils[i] : NULL);
        }
    }
    free(stencils);
    return status;
}

static void print_pair(void *context, const step_run *run, int kind, uint64_t i,
                       const sc_step_stencil *stencil)
{
    const step_list *list = &run->lists[kind];
    (void)context;
    printf("    %s %lu %lu %.17g", feature_pairs_names[kind], (unsigned long)list->pairs[i].a,
           (unsigned long)list->pairs[i].b, list->times[i]);
    if (stencil) {
        printf(" start %.17g", stencil->start.distance);
        stencil_text_print(&stencil->start);
        printf(" impact %.17g", stencil->impact.distance);
        stencil_text_print(&stencil->impact);
        if (stencil->flags & SC_STEP_NO_NORMAL) {
            fputs(" normal none", stdout);
        } else {
            fputs(" normal", stdout);
            for (int k = 0; k < 3; k++) printf(" %.17g", stencil->normal[k] + 0.0); /* no -0 */
        }
        printf(" side %d", (int)stencil->side);
        if (stencil->flags & SC_STEP_APPROACHES) fputs(" approaches", stdout);
    }
    puts("");
}

static bool print_table_row(const step_answer *answer, const step_run *run)
{
    const char *const more = answer->incomplete ? "+" : " ";
    printf("%10lu %10lu ", (unsigned long)answer->info.point_count,
           (unsigned long)answer->info.triangle_count);
    if (run->set->any) {
        printf("%14s %14s ", answer->collides ? "yes" : answer->incomplete ? "unknown" : "no", "");
    } else {
        printf("%13.0f%s %13.0f%s ", (double)answer->counts[VERTEX_FACE], more,
               (double)answer->counts[EDGE_EDGE], more);
    }
    if (answer->candidates_known)
        printf("%12.0f ", (double)answer->candidates[0] + (double)answer->candidates[1]);
    else
        printf("%12s ", "-");
    if (run->set->any || answer->incomplete)
        printf("%10s ", "-");
    else
        printf("%10.7f ", answer->earliest);
    printf("%9.2f %9.3f  %s", answer->build_ms, answer->query_ms, answer->start);
    if (!run->set->replayed) printf(" to %s", answer->end);
    printf("%s\n", tool_reading_note(answer->rounded, answer->has_animation));
    mesh_tally_print(&answer->tally, run->mesh);
    if (run->set->stats) query_text_stats(&answer->stats);
    if (!run->set->times && !run->set->stencils) return true;
    return visit_pairs(answer, run, print_pair, NULL) == SC_OK;
}

static void add_closest(cJSON *pair, const char *name, const sc_near_stencil *stencil)
{
    cJSON *object = cJSON_AddObjectToObject(pair, name);
    cJSON_AddNumberToObject(object, "distance", stencil->distance);
    stencil_text_add(object, stencil);
}

static void add_pair(void *context, const step_run *run, int kind, uint64_t i,
                     const sc_step_stencil *stencil)
{
    cJSON *pairs = (cJSON *)context;
    const step_list *list = &run->lists[kind];
    cJSON *pair = cJSON_CreateObject();
    cJSON_AddStringToObject(pair, "kind", feature_pairs_names[kind]);
    cJSON_AddNumberToObject(pair, "a", list->pairs[i].a);
    cJSON_AddNumberToObject(pair, "b", list->pairs[i].b);
    cJSON_AddNumberToObject(pair, "time", list->times[i]);
    feature_pairs_add_owners(pair, run->mesh, run->vertex_objects, kind, list->pairs[i]);
    if (stencil) {
        add_closest(pair, "start", &stencil->start);
        add_closest(pair, "impact", &stencil->impact);
        if (stencil->flags & SC_STEP_NO_NORMAL)
            cJSON_AddNullToObject(pair, "normal");
        else
            stencil_text_add_vector(pair, "normal", stencil->normal);
        cJSON_AddNumberToObject(pair, "side", stencil->side);
        cJSON_AddBoolToObject(pair, "approaches", (stencil->flags & SC_STEP_APPROACHES) != 0);
    }
    cJSON_AddItemToArray(pairs, pair);
}

static void add_count(cJSON *object, const char *name, uint64_t count, bool known)
{
    if (known)
        cJSON_AddNumberToObject(object, name, (double)count);
    else
        cJSON_AddNullToObject(object, name);
}

static bool print_json_answer(const step_answer *answer, const step_run *run)
{
    const step_settings *set = run->set;
    const bool known = answer->candidates_known;
    cJSON *object = tool_json_object("step");
    cJSON_AddStringToObject(object, "start", answer->start);
    cJSON_AddStringToObject(object, "end", answer->end);
    cJSON_AddStringToObject(object, "status",
                            answer->incomplete ? "incomplete"
                            : answer->collides ? "collides"
                                               : "clean");
    cJSON_AddBoolToObject(object, "collides", answer->collides);
    cJSON_AddStringToObject(object, "coordinates",
                            tool_coordinates(answer->rounded, answer->position_type));
    if (answer->has_animation) cJSON_AddStringToObject(object, "animation", "not played");
    cJSON_AddNumberToObject(object, "vertices", answer->info.point_count);
    cJSON_AddNumberToObject(object, "triangles", answer->info.triangle_count);
    cJSON_AddNumberToObject(object, "faces", run->mesh->face_count);
    cJSON_AddNumberToObject(object, "objects", run->mesh->object_count);
    if (names_objects(run)) query_text_add_tally(object, &answer->tally, run->mesh);
    add_count(object, "vertex_face_pairs", answer->counts[VERTEX_FACE], !set->any);
    add_count(object, "edge_edge_pairs", answer->counts[EDGE_EDGE], !set->any);
    add_count(object, "collisions", answer->counts[0] + answer->counts[1], !set->any);
    add_count(object, "candidates", answer->candidates[0] + answer->candidates[1], known);
    add_count(object, "vertex_face_candidates", answer->candidates[VERTEX_FACE], known);
    add_count(object, "edge_edge_candidates", answer->candidates[EDGE_EDGE], known);
    if (set->any || answer->incomplete)
        cJSON_AddNullToObject(object, "earliest");
    else
        cJSON_AddNumberToObject(object, "earliest", answer->earliest);
    cJSON_AddNumberToObject(object, "separation", set->separation);
    if (set->tolerance > 0)
        cJSON_AddNumberToObject(object, "tolerance", set->tolerance);
    else
        cJSON_AddNullToObject(object, "tolerance");
    cJSON_AddNumberToObject(object, "build_ms", query_text_rounded(answer->build_ms));
    cJSON_AddNumberToObject(object, "query_ms", query_text_rounded(answer->query_ms));
    if (known)
        cJSON_AddNumberToObject(object, "candidates_ms", query_text_rounded(answer->candidates_ms));
    else
        cJSON_AddNullToObject(object, "candidates_ms");
    cJSON_AddStringToObject(object, "method", tool_choice_name(step_methods, set->method));
    if (set->method == SC_STEP_METHOD_SCTT)
        cJSON_AddStringToObject(object, "contour",
                                tool_choice_name(query_text_contours, set->contour));
    else
        cJSON_AddNullToObject(object, "contour");
    if (set->rest_path) cJSON_AddStringToObject(object, "rest", set->rest_path);
    if (set->model_path) cJSON_AddStringToObject(object, "model", set->model_path);
    if (set->ignore_rings) cJSON_AddNumberToObject(object, "ignore_rings", set->ignore_rings);
    if (set->ignore_path) cJSON_AddStringToObject(object, "ignore", set->ignore_path);
    if (set->groups_path) cJSON_AddStringToObject(object, "groups", set->groups_path);
    if (set->ignores_rest) cJSON_AddNumberToObject(object, "ignore_rest", set->ignore_rest);
    if (set->budget) cJSON_AddNumberToObject(object, "budget", (double)set->budget);
    if (set->stats) query_text_add_stats(object, &answer->stats);
    if ((set->times || set->stencils) &&
        visit_pairs(answer, run, add_pair, cJSON_AddArrayToObject(object, "pairs")) != SC_OK) {
        cJSON_Delete(object);
        return false;
    }
    return tool_json_print(object);
}

static void write_pairs(const step_answer *answer, const step_run *run)
{
    for (int kind = 0; kind < KINDS; kind++) {
        const step_list *list = &run->lists[kind];
        for (uint64_t i = 0; i < answer->counts[kind]; i++) {
            query_text_field(run->out, answer->start);
            fputc(',', run->out);
            query_text_field(run->out, answer->end);
            fprintf(run->out, ",%s", feature_pairs_names[kind]);
            feature_pairs_write_owners(run->out, run->mesh, run->vertex_objects, kind,
                                       list->pairs[i]);
            fprintf(run->out, ",%lu,%lu,%.17g\n", (unsigned long)list->pairs[i].a,
                    (unsigned long)list->pairs[i].b, list->times[i]);
        }
    }
}

static int report_failure(const step_answer *answer, const step_run *run, const char *error)
{
    tool_error("%s", error);
    if (run->set->json) {
        cJSON *object = tool_json_object("step");
        cJSON_AddStringToObject(object, "start", answer->start);
        cJSON_AddStringToObject(object, "end", answer->end);
        cJSON_AddStringToObject(object, "status", "error");
        cJSON_AddStringToObject(object, "error", error);
        tool_json_print(object);
    }
    fflush(stdout);
    return TOOL_FAILED;
}

static int report(const step_answer *answer, const step_run *run)
{
    const bool written =
        run->set->json ? print_json_answer(answer, run) : print_table_row(answer, run);
    if (run->out) write_pairs(answer, run);
    fflush(stdout);
    if (!written) {
        tool_error("%s to %s: out of memory", answer->start, answer->end);
        return TOOL_FAILED;
    }
    if (answer->incomplete) return TOOL_INCOMPLETE;
    return answer->collides ? TOOL_COLLIDES : TOOL_CLEAN;
}

/* ------------------------------------------------------------------------------------------------
 * Frames
 */

/* Makes what all steps share. first: the path of the first frame. */
static bool open_run(step_run *run, const char *first, char error[MESH_FILE_ERROR_SIZE])
{
    const step_settings *set = run->set;
    const query_subject_how how = {set->weld,     set->partition,    0,
                                   SC_MODEL_FULL, SC_WORKSPACE_STEP, true};
    if (set->model_path) {
        if (!query_subject_open(&run->subject, set->model_path, SC_WORKSPACE_STEP, error) ||
            !mesh_file_read(&run->first, first, error) ||
            !query_subject_fits(&run->subject, first, &run->first, error))
            return false;
        run->first.face_hash = mesh_file_hash(&run->first);
        run->mesh = &run->first;
    } else {
        if (!query_subject_load(&run->subject, set->rest_path ? set->rest_path : first, &how,
                                error))
            return false;
        run->mesh = &run->subject.mesh;
    }
    if (!filter_file_apply_step(set->filters, run->mesh->vertex_count, run->mesh->triangle_count,
                                run->filters, error))
        return false;
    for (int kind = 0; kind < KINDS; kind++) run->filters[kind].ignore_rings = set->ignore_rings;
    run->rest = tool_pose(run->mesh->positions, run->mesh->position_type, run->mesh->vertex_count);
    if (wants_list(run)) {
        run->vertex_objects = mesh_vertex_objects(run->mesh);
        if (!run->vertex_objects) snprintf(error, MESH_FILE_ERROR_SIZE, "%s: out of memory", first);
        return run->vertex_objects != NULL;
    }
    return true;
}

static void read_frame(const step_run *run, const char *path, frame *to)
{
    mesh_pose_free(&to->pose);
    if (mesh_file_read_pose(run->mesh, path, &to->pose, to->error) &&
        query_subject_keeps_welds(&run->subject, run->mesh, path, to->pose.positions,
                                  to->pose.position_type, to->error))
        to->error[0] = '\0';
}

/* The first frame, which unless there is a rest mesh was read already, and a pipe cannot be read
   twice. */
static void take_first(const step_run *run, const char *path, frame *to)
{
    const mesh_file *mesh = run->mesh;
    if (run->set->rest_path) {
        read_frame(run, path, to);
        return;
    }
    const size_t number = mesh->position_type == SC_DOUBLE ? sizeof(double) : sizeof(float);
    const size_t size = 3 * (size_t)mesh->vertex_count * number;
    to->pose.positions = malloc(size);
    if (!to->pose.positions) {
        snprintf(to->error, sizeof to->error, "%s: out of memory", path);
        return;
    }
    memcpy(to->pose.positions, mesh->positions, size);
    to->pose.position_type = mesh->position_type;
    to->pose.rounded = mesh->rounded;
    to->pose.has_animation = mesh->has_animation;
    if (query_subject_keeps_welds(&run->subject, mesh, path, to->pose.positions,
                                  to->pose.position_type, to->error))
        to->error[0] = '\0';
}

static int do_steps(step_run *run, char **paths, uint32_t count)
{
    char error[MESH_FILE_ERROR_SIZE];
    int status = TOOL_CLEAN;
    if (!open_run(run, paths[0], error)) {
        step_answer none;
        memset(&none, 0, sizeof none);
        none.start = paths[0];
        none.end = paths[1];
        return report_failure(&none, run, error);
    }
    print_heads(run);
    frame *from = &run->frames[0], *to = &run->frames[1];
    take_first(run, paths[0], from);
    for (uint32_t i = 1; i < count; i++) {
        step_answer answer;
        memset(&answer, 0, sizeof answer);
        answer.start = paths[i - 1];
        answer.end = paths[i];
        read_frame(run, paths[i], to);
        const char *reason = from->error[0] ? from->error : to->error[0] ? to->error : NULL;
        if (!reason && !ask_frames(run, from, to, &answer, error)) reason = error;
        int done = reason ? report_failure(&answer, run, reason) : report(&answer, run);
        if (answer.unrecorded) done = TOOL_FAILED;
        query_summary_add(&run->summary, done, answer.collides, answer.start, answer.end,
                          run->set->any ? 0 : answer.counts[0] + answer.counts[1]);
        mesh_tally_free(&answer.tally);
        status = query_text_worse(status, done);
        frame *const last = from;
        from = to;
        to = last;
    }
    if (!query_summary_print(&run->summary, true, run->set->json)) status = TOOL_FAILED;
    return status;
}

/* Also those of a pattern. */
static bool spares_frames(char *const *paths, int count, const step_settings *set)
{
    for (int i = 0; i < count; i++) {
        if (!tool_spares(set->out_path, paths[i]) || !tool_spares(set->record_path, paths[i]))
            return false;
    }
    return true;
}

/* Ends what a run has begun; returns the exit status. */
static int close_run(step_run *run, int status)
{
    if (!tool_close(run->out, run->set->out_path)) status = TOOL_FAILED;
    for (int i = 0; i < KINDS; i++) {
        free(run->lists[i].pairs);
        free(run->lists[i].times);
        mesh_pose_free(&run->frames[i].pose);
    }
    free(run->vertex_objects);
    mesh_file_free(&run->first);
    query_subject_free(&run->subject);
    return status;
}

int step_query_frames(char **paths, int count, const step_settings *set)
{
    char error[MESH_FILE_ERROR_SIZE];
    frame_paths found = {NULL, 0};
    int status = TOOL_FAILED;
    if (!frame_paths_expand(&found, &paths, &count, error)) {
        tool_error("%s", error);
        return TOOL_FAILED;
    }
    step_run run;
    memset(&run, 0, sizeof run);
    run.set = set;
    if (count < 2) {
        tool_error("--step takes two frames or more");
    } else if (set->record_path && count > 2) {
        tool_error("--record takes the two frames of a step; see sc-query --help");
    } else if (!spares_frames(paths, count, set)) {
        status = TOOL_FAILED;
    } else if (set->out_path && !(run.out = fopen(set->out_path, "w"))) {
        tool_error("%s: cannot be written: %s", set->out_path, strerror(errno));
    } else {
        status = do_steps(&run, paths, (uint32_t)count);
    }
    status = close_run(&run, status);
    frame_paths_free(&found);
    return status;
}

/* ------------------------------------------------------------------------------------------------
 * Records
 */

/* Sets what the record asks for; file->error says if it cannot be asked here. */
static bool use_record(step_settings *set, record_file *file)
{
    const sc_step_options *o = &file->step;
    set->method = o->method;
    set->contour = o->contour;
    set->separation = o->separation;
    set->tolerance = o->tolerance;
    set->any = o->output == SC_OUTPUT_ANY;
    set->budget = o->budget;
    set->ignores_rest = o->rest != NULL;
    set->ignore_rest = o->rest_distance;
    if (o->output > SC_OUTPUT_ANY || o->method > SC_STEP_METHOD_SWEPT ||
        o->contour > SC_CONTOUR_EXACT)
        record_file_refuse(file, SC_ERROR_OPTION, NULL);
    else if (o->pairs != SC_STEP_COLLISIONS)
        record_file_refuse(file, SC_ERROR_OPTION, "the record asks for candidates alone");
    else if (set->any && set->out_path)
        record_file_refuse(file, SC_ERROR_OPTION, "the record asks for no list");
    return !file->error[0];
}

/* In place of defaults, what they stand for on a model. */
static bool choose_defaults(step_settings *set, const sc_model *model)
{
    sc_model_info info;
    memset(&info, 0, sizeof info);
    info.struct_size = sizeof info;
    if (sc_model_get_info(model, &info) != SC_OK) return false;
    if (set->method == SC_STEP_METHOD_DEFAULT)
        set->method = info.node_count ? SC_STEP_METHOD_SCTT : SC_STEP_METHOD_TWO_BOXES;
    if (set->contour == SC_CONTOUR_DEFAULT) set->contour = SC_CONTOUR_EXACT;
    return true;
}

int step_query_replay(step_settings *set)
{
    record_file *file = set->replayed;
    const sc_pose poses[2] = {file->pose, file->end};
    step_answer answer;
    step_run run;
    memset(&answer, 0, sizeof answer);
    memset(&run, 0, sizeof run);
    run.set = set;
    run.mesh = &run.subject.mesh;
    answer.start = answer.end = file->path;
    bool done = use_record(set, file) && record_file_open(file, SC_WORKSPACE_STEP, &run.subject) &&
                choose_defaults(set, run.subject.model);
    if (done && set->out_path && !(run.out = fopen(set->out_path, "w"))) {
        snprintf(file->error, sizeof file->error, "%s: cannot be written: %s", set->out_path,
                 strerror(errno));
        done = false;
    }
    print_heads(&run);
    if (done) {
        run.vertex_objects = record_file_vertex_objects(&run.subject);
        if (!run.vertex_objects) record_file_refuse(file, SC_ERROR_MEMORY, NULL);
        done = run.vertex_objects && ask(&run, poses, &answer, file->error);
    }
    const int status = done ? report(&answer, &run) : report_failure(&answer, &run, file->error);
    mesh_tally_free(&answer.tally);
    return close_run(&run, status);
}
