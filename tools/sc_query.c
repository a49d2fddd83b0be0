/*
 * sc-query: finds the self-collisions of mesh files.
 *
 * SPDX-License-Identifier: MIT
 *
 * Each file is a mesh of its own, or a pose of one mesh that is built once (--rest) or was built
 * before (--model). A file that cannot be done is reported and the others are still done. See usage
 * below, and sc_query in starcontour.h for what a pair is.
 */
#include "filter_file.h"
#include "ply_write.h"
#include "query_subject.h"
#include "query_text.h"
#include "query_threads.h"
#include "step_query.h"
#include "tool.h"
#include "tool_json.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <getopt.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char usage[] =
    "Usage: sc-query [options] MESH...\n"
    "       sc-query --step [options] MESH MESH... | PATTERN\n"
    "Finds every self-collision of triangle meshes, exactly.\n"
    "\n"
    "Reads OBJ, OFF, PLY, STL and all other formats that assimp reads, packed by gzip or not; - "
    "is\n"
    "standard input. Vertices at equal positions are joined, polygons triangulated, points and "
    "lines\n"
    "left out. The answer is exact for the nearest doubles to the file's coordinates; what only "
    "assimp\n"
    "reads may be rounded to floats, and the table and --json say so. Vertices and triangles are\n"
    "numbered from 0 in the order of the file (assimp: of the scene's meshes).\n"
    "\n"
    "  --format obj|off|ply|stl    the format of -, and of files whose names tell none\n"
    "What is sought\n"
    "  --pairs triangle|edge|none  the pairs that --out and --ply show and that decide the exit\n"
    "                              status: of triangles (default), or of an edge and a triangle "
    "that\n"
    "                              share no vertex; none: only count, triangles decide\n"
    "  --proper                    only edges' interiors that pass through triangles' interiors;\n"
    "                              without it touching is enough\n"
    "  --any                       stop at the first pair: whether there is one, not how many\n"
    "  --weld rest|none            join vertices at equal positions (default), or take them as "
    "they\n"
    "                              are read, which for some formats (STL) is one a corner of a "
    "face\n"
    "  --rest MESH                 build once from MESH; the files are poses of it, with the same\n"
    "                              vertices and faces in the same order\n"
    "  --model FILE                the same, with the model that sc-partition -o wrote\n"
    "  --replay FILE               in place of meshes: the query that --record wrote, with its "
    "options\n"
    "What collides on the way from each MESH to the next\n"
    "  --step                      the files are frames, two or more, in which every vertex moves "
    "on "
    "a\n"
    "                              straight line: vertex-face and edge-edge pairs that meet, when "
    "the\n"
    "                              first does, and how many candidates there were, but not what\n"
    "                              is through itself from start to end. One pattern such as\n"
    "                              f%04d.obj is all files with numbers from 0 or 1\n"
    "  --separation D              that come as near as D, in units of the coordinates (0)\n"
    "  --tolerance T               of distances (a millionth of the size); pairs up to D + T apart "
    "may\n"
    "                              be among those reported, and none up to D is missing\n"
    "  --times                     each pair with its time, from 0 to 1\n";

/* In two: C99 has strings of up to 4095 characters. */
static const char usage_continued[] =
    "Which pairs are left out\n"
    "  --ignore-rings N            those less than N edges of the mesh apart; 1: that share a "
    "vertex\n"
    "  --ignore FILE               those in FILE, as --out writes them; only --pairs are sought "
    "then\n"
    "  --groups FILE               those whose groups do not collide. Lines: triangle|vertex\n"
    "                              FIRST[-LAST] CATEGORY MASK; a category has to be in the other's "
    "mask\n"
    "Output\n"
    "  --json                      a JSON object a line for each file, in place of the table\n"
    "  --out FILE                  write the pairs as comma-separated values. An edge is a number\n"
    "                              3 t + k: from vertex k to vertex k + 1 (mod 3) of triangle t\n"
    "  --ply FILE                  write the mesh with colliding triangles in red; one MESH only\n"
    "  --contacts                  where each pair meets, and how: a point, a segment, or an area\n"
    "  --stats                     time and count of the nine tasks of the query\n"
    "  --record FILE               write the query, with model, pose, options and filter, to "
    "report\n"
    "                              a bug; one MESH only\n"
    "How it is sought (the answer is the same, but for --contour none)\n"
    "  --method auto|sctt|aabb-sctt|aabb  self-collision test tree, boxes from that tree on, or "
    "the\n"
    "                              plain tree of boxes. auto (default): for a mesh asked about "
    "once\n"
    "                              the plain tree alone, which is built fastest; sctt with "
    "--rest,\n"
    "                              --model, --record, --stats, --budget or what follows\n"
    "                              With --step: sctt (default), two-boxes or swept, plain trees "
    "of\n"
    "                              boxes at both ends, or round the motion\n"
    "  --contour exact|star|none   contour test of method sctt: is the contour simple (default), "
    "the\n"
    "                              star test, or none, which MISSES PAIRS and is for measuring\n"
    "  --partition fast|metis      where the patches come from\n"
    "  --no-rest-cache             test again what failed in the rest pose\n"
    "  --budget N                  stop each query after N tests; what was found so far is "
    "shown\n"
    "  --threads K                 threads that a query uses (1)\n"
    "\n"
    "  -V, --version, -h, --help\n"
    "\n"
    "Exit status: 0 no self-collision, 1 at least one, 2 something could not be done; the reason "
    "is\n"
    "on standard error. 3: a --budget ended a query, whether it had found any or not.\n";

static const tool_choice pair_choices[] = {
    {"triangle", SC_PAIRS_TRIANGLE}, {"edge", SC_PAIRS_EDGE}, {"none", 2}, {NULL, 0}};
static const tool_choice method_choices[] = {{"auto", SC_METHOD_DEFAULT},
                                             {"sctt", SC_METHOD_SCTT},
                                             {"aabb-sctt", SC_METHOD_AABB_SCTT},
                                             {"aabb", SC_METHOD_AABB},
                                             {NULL, 0}};
typedef struct settings {
    step_settings step;          /* what --step alone asks */
    bool is_step, is_step_asked; /* --step; an option that only it takes */
    const char *method_name;     /* as given, or NULL */
    const char *not_of_steps;    /* an option that --step does not take, if one was given */
    uint32_t pairs;              /* a value of pair_choices */
    uint32_t method, contour, partition, weld;
    uint32_t content; /* of the models that are built: SC_MODEL_... */
    bool proper, any, json, stats, no_rest_cache;
    bool is_asked, is_built; /* some option said what to ask or how, or how to build */
    const char *rest_path, *out_path, *ply_path, *model_path, *record_path, *replay_path;
    uint32_t ignore_rings; /* 0: none */
    uint64_t budget;       /* 0: none */
    uint32_t simd;         /* SC_SIMD_... */
    const char *ignore_path, *groups_path;
    bool contacts;
    filter_file *filters;   /* what the two files say */
    const sc_filter *given; /* in place of these: what a record says */
} settings;

/* What there is to know about one file. Index SC_PAIRS_TRIANGLE and SC_PAIRS_EDGE. */
typedef struct file_answer {
    const char *path;
    sc_model_info info;
    double build_ms;
    double query_ms[2];
    uint64_t counts[2];
    bool known[2]; /* whether counts and query_ms are there */
    bool collides;
    bool incomplete;             /* a budget ended a query */
    bool rounded, has_animation; /* as in mesh_file */
    uint32_t position_type;      /* of the pose */
    sc_stats stats;
} file_answer;

/* Pairs of one query; grows and is kept. */
typedef struct pair_list {
    sc_pair *pairs;
    uint64_t count, capacity;
    sc_contact *contacts; /* count, with --contacts */
} pair_list;

/* The kind of pair that decides. */
static uint32_t chosen_pairs(const settings *set)
{
    return set->pairs == SC_PAIRS_EDGE ? SC_PAIRS_EDGE : SC_PAIRS_TRIANGLE;
}

static bool wants_list(const settings *set)
{
    return set->out_path || set->ply_path || set->contacts;
}

/* What to ask for one kind of pair. With list the pairs are wanted, else only their number. */
static sc_query_options make_options(const settings *set, uint32_t kind, bool list)
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
static sc_status run_query(const query_subject *subject, const sc_pose *pose, const settings *set,
                           const sc_filter *filter, uint32_t kind, pair_list *list,
                           file_answer *answer)
{
    sc_query_options options = make_options(set, kind, list != NULL);
    options.filter = filter;
    sc_result result;
    memset(&result, 0, sizeof result);
    result.struct_size = sizeof result;
    if (set->stats && kind == chosen_pairs(set)) {
        memset(&answer->stats, 0, sizeof answer->stats);
        answer->stats.struct_size = sizeof answer->stats;
        result.stats = &answer->stats;
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
static bool make_filter(const sc_model_info *info, const settings *set, sc_filter *filter,
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
static bool write_record(const query_subject *subject, const sc_pose *pose, const settings *set)
{
    sc_query_options options = make_options(set, chosen_pairs(set), wants_list(set));
    char error[MESH_FILE_ERROR_SIZE];
    uint64_t size = 0;
    void *bytes = NULL;
    sc_model_info info;
    sc_filter filter;
    memset(&info, 0, sizeof info);
    info.struct_size = sizeof info;
    sc_status status = sc_model_get_info(subject->model, &info);
    if (status == SC_OK && !make_filter(&info, set, &filter, error)) {
        tool_error("%s", error);
        return false;
    }
    if (set->ignore_rings || set->ignore_path || set->groups_path) options.filter = &filter;
    if (status == SC_OK) status = sc_record_size(subject->model, pose, &options, &size);
    if (status == SC_OK) {
        bytes = size <= SIZE_MAX ? malloc((size_t)size) : NULL;
        status = bytes ? sc_record_write(subject->model, pose, &options, bytes, size, NULL)
                       : SC_ERROR_MEMORY;
    }
    bool written = status == SC_OK;
    if (!written)
        tool_error("%s: %s", set->record_path, sc_status_string(status));
    else if (!model_file_dump(set->record_path, bytes, size, error)) {
        tool_error("%s", error);
        written = false;
    }
    free(bytes);
    return written;
}

/* Where the pairs of a list meet. */
static sc_status find_contacts(const query_subject *subject, const sc_pose *pose,
                               const settings *set, pair_list *list)
{
    free(list->contacts);
    list->contacts = list->count > SIZE_MAX / sizeof(sc_contact)
                         ? NULL
                         : (sc_contact *)malloc((size_t)list->count * sizeof(sc_contact) + 1);
    if (!list->contacts) return SC_ERROR_MEMORY;
    return sc_contacts(subject->model, pose, chosen_pairs(set), list->pairs, list->count,
                       list->contacts);
}

/* All queries of one pose. */
static bool run_pose(const query_subject *subject, const char *path, const sc_pose *pose,
                     const settings *set, pair_list *list, file_answer *answer,
                     char error[MESH_FILE_ERROR_SIZE])
{
    const uint32_t chosen = chosen_pairs(set);
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
        pair_list *const kept = kind == chosen && wants_list(set) ? list : NULL;
        status = run_query(subject, pose, set, &filter, kind, kept, answer);
        if (status != SC_ERROR_INCOMPLETE) continue;
        answer->incomplete = true;
        status = SC_OK;
    }
    if (status == SC_OK && set->contacts) status = find_contacts(subject, pose, set, list);
    answer->collides = answer->counts[chosen] > 0;
    if (status != SC_OK) {
        snprintf(error, MESH_FILE_ERROR_SIZE, "%s: %s", path, tool_why(status));
    }
    return status == SC_OK;
}

static bool write_ply(const mesh_file *mesh, const sc_pose *pose, const settings *set,
                      const pair_list *list)
{
    const uint32_t count = mesh->triangle_count;
    uint8_t *colors = (uint8_t *)malloc(3 * (size_t)count);
    if (!colors) {
        tool_error("%s: out of memory", set->ply_path);
        return false;
    }
    memset(colors, 200, 3 * (size_t)count);
    for (uint64_t i = 0; i < list->count; i++) {
        const sc_pair pair = list->pairs[i];
        const uint32_t first = chosen_pairs(set) == SC_PAIRS_EDGE ? pair.a / 3 : pair.a;
        const uint8_t red[3] = {220, 30, 30};
        memcpy(colors + 3 * (size_t)first, red, 3);
        memcpy(colors + 3 * (size_t)pair.b, red, 3);
    }
    errno = 0;
    const bool written = ply_write(set->ply_path, pose->positions, pose->position_type,
                                   mesh->vertex_count, mesh->indices, count, colors);
    if (!written) tool_error("%s: cannot be written: %s", set->ply_path, strerror(errno));
    free(colors);
    return written;
}

static void write_pairs_head(FILE *out, const settings *set)
{
    const bool edges = chosen_pairs(set) == SC_PAIRS_EDGE;
    fputs(edges ? "file,edge,triangle\n" : "file,triangle_a,triangle_b\n", out);
}

static void write_pairs(FILE *out, const char *path, const pair_list *list)
{
    for (uint64_t i = 0; i < list->count; i++) {
        query_text_field(out, path);
        fprintf(out, ",%lu,%lu\n", (unsigned long)list->pairs[i].a,
                (unsigned long)list->pairs[i].b);
    }
}

static void add_count(cJSON *object, const char *name, const file_answer *answer, uint32_t kind,
                      bool any)
{
    if (any || !answer->known[kind])
        cJSON_AddNullToObject(object, name);
    else
        cJSON_AddNumberToObject(object, name, (double)answer->counts[kind]);
}

static void add_time(cJSON *object, const char *name, const file_answer *answer, uint32_t kind)
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

static void add_contacts(cJSON *object, const pair_list *list)
{
    cJSON *contacts = cJSON_AddArrayToObject(object, "contacts");
    for (uint64_t i = 0; i < list->count; i++) {
        cJSON *contact = cJSON_CreateObject();
        cJSON_AddNumberToObject(contact, "a", list->pairs[i].a);
        cJSON_AddNumberToObject(contact, "b", list->pairs[i].b);
        cJSON_AddStringToObject(contact, "kind", meet_names[list->contacts[i].kind]);
        add_numbers(contact, "points", list->contacts[i].points);
        add_numbers(contact, "weights_a", list->contacts[i].weights_a);
        add_numbers(contact, "weights_b", list->contacts[i].weights_b);
        cJSON_AddItemToArray(contacts, contact);
    }
}

static bool print_json_answer(const file_answer *answer, const settings *set, const pair_list *list)
{
    cJSON *object = cJSON_CreateObject();
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
    add_count(object, "triangle_pairs", answer, SC_PAIRS_TRIANGLE, set->any);
    add_count(object, "edge_triangle_pairs", answer, SC_PAIRS_EDGE, set->any);
    cJSON_AddNumberToObject(object, "build_ms", query_text_rounded(answer->build_ms));
    add_time(object, "query_ms", answer, chosen_pairs(set));
    add_time(object, "triangle_query_ms", answer, SC_PAIRS_TRIANGLE);
    add_time(object, "edge_query_ms", answer, SC_PAIRS_EDGE);
    cJSON_AddStringToObject(object, "pairs", tool_choice_name(pair_choices, set->pairs));
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
    cJSON_AddStringToObject(object, "method", tool_choice_name(method_choices, set->method));
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
    if (set->stats) query_text_add_stats(object, &answer->stats);
    if (set->contacts) add_contacts(object, list);
    return tool_json_print(object);
}

static bool print_json_error(const char *path, const char *error)
{
    cJSON *object = cJSON_CreateObject();
    cJSON_AddStringToObject(object, "file", path);
    cJSON_AddStringToObject(object, "status", "error");
    cJSON_AddStringToObject(object, "error", error);
    return tool_json_print(object);
}

static void print_table_head(const settings *set)
{
    printf("%10s %10s %6s %14s %14s %9s %9s  %s\n", "vertices", "triangles", "parts",
           set->any ? "collides" : "triangle pairs", set->any ? "" : "edge-tri pairs", "build ms",
           "query ms", "file");
}

/* A number of pairs: with a + if there may be more, a - if they were not sought. */
static void print_count(const file_answer *answer, uint32_t kind)
{
    if (answer->known[kind])
        printf("%13.0f%s", (double)answer->counts[kind], answer->incomplete ? "+" : " ");
    else
        printf("%13s ", "-");
}

/* Digits enough for what the coordinates are; those of doubles may be far from the origin. */
static void print_contacts(const pair_list *list, uint32_t position_type)
{
    const int digits = position_type == SC_DOUBLE ? 17 : 9;
    for (uint64_t i = 0; i < list->count; i++) {
        const sc_contact *c = &list->contacts[i];
        printf("    %lu %lu %s", (unsigned long)list->pairs[i].a, (unsigned long)list->pairs[i].b,
               meet_names[c->kind]);
        for (int k = 0; k < (c->kind == SC_MEET_POINT ? 3 : 6); k++)
            printf(" %.*g", digits, c->points[k / 3][k % 3]);
        puts("");
    }
}

static void print_table_row(const file_answer *answer, const settings *set)
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
    printf(" %9.2f %9.3f  %s%s\n", answer->build_ms, answer->query_ms[chosen_pairs(set)],
           answer->path, tool_reading_note(answer->rounded, answer->has_animation));
    if (set->stats) query_text_stats(&answer->stats);
}

/* Prints what came of a query, to be followed by the exit status. */
static int report(const file_answer *answer, const settings *set, bool done, const char *error,
                  FILE *out, const pair_list *list)
{
    bool written = true;
    if (!done) {
        tool_error("%s", error);
        if (set->json) print_json_error(answer->path, error);
    } else {
        if (set->json)
            written = print_json_answer(answer, set, list);
        else
            print_table_row(answer, set);
        if (set->contacts && !set->json) print_contacts(list, answer->position_type);
        if (out) write_pairs(out, answer->path, list);
    }
    fflush(stdout);
    if (!done || !written) return TOOL_FAILED;
    if (answer->incomplete) return TOOL_INCOMPLETE;
    return answer->collides ? TOOL_COLLIDES : TOOL_CLEAN;
}

/* Only the star test uses marks. */
static uint32_t rest_marks(const settings *set)
{
    return set->method == SC_METHOD_SCTT && set->contour == SC_CONTOUR_STAR && !set->no_rest_cache
               ? SC_REST_MARKED
               : SC_REST_UNMARKED;
}

/* What --method auto is on a model that was saved, or in a record that names none. */
static void follow_model(settings *set, const sc_model *model)
{
    sc_model_info info;
    memset(&info, 0, sizeof info);
    info.struct_size = sizeof info;
    if (set->method != SC_METHOD_DEFAULT || sc_model_get_info(model, &info) != SC_OK) return;
    set->method = info.node_count ? SC_METHOD_SCTT : SC_METHOD_AABB;
}

/* Does one file. rest is the common subject of --rest or --model, or NULL. Returns an exit
   status. */
static int do_file(const char *path, const settings *set, const query_subject *rest, FILE *out,
                   pair_list *list)
{
    char error[MESH_FILE_ERROR_SIZE];
    query_subject own;
    memset(&own, 0, sizeof own);
    mesh_pose moved; /* of --rest */
    memset(&moved, 0, sizeof moved);
    file_answer answer;
    memset(&answer, 0, sizeof answer);
    answer.path = path;

    const query_subject_how how = {set->weld, set->partition, rest_marks(set), set->content,
                                   0,         false};
    const query_subject *subject = rest ? rest : &own;
    const mesh_file *mesh = set->rest_path ? &rest->mesh : &own.mesh;
    bool done;
    if (set->rest_path) {
        done = mesh_file_read_pose(&rest->mesh, path, &moved, error) &&
               query_subject_keeps_welds(rest, mesh, path, moved.positions, moved.position_type,
                                         error);
    } else if (rest) {
        done = mesh_file_read(&own.mesh, path, error) &&
               query_subject_fits(rest, path, mesh, error) &&
               query_subject_keeps_welds(rest, mesh, path, mesh->positions, mesh->position_type,
                                         error);
    } else {
        done = query_subject_load(&own, path, &how, error);
    }
    const sc_pose pose = set->rest_path
                             ? tool_pose(moved.positions, moved.position_type, mesh->vertex_count)
                             : tool_pose(mesh->positions, mesh->position_type, mesh->vertex_count);
    answer.rounded = set->rest_path ? moved.rounded : mesh->rounded;
    answer.has_animation = set->rest_path ? moved.has_animation : mesh->has_animation;
    const bool recorded = !done || !set->record_path || write_record(subject, &pose, set);
    if (done) done = run_pose(subject, path, &pose, set, list, &answer, error);
    int status = report(&answer, set, done, error, out, list);
    if (!recorded) status = TOOL_FAILED;
    if (done && set->ply_path && !write_ply(mesh, &pose, set, list)) status = TOOL_FAILED;
    mesh_pose_free(&moved);
    query_subject_free(&own);
    return status;
}

/* Sets what a record asks for. */
static bool use_options(settings *set, const sc_query_options *options)
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
static int do_replay(settings *set, FILE *out, pair_list *list)
{
    char error[MESH_FILE_ERROR_SIZE], reason[256] = "";
    uint64_t size;
    file_answer answer;
    query_subject subject;
    sc_query_options options;
    sc_filter filter;
    sc_record record;
    sc_pose pose;
    memset(&answer, 0, sizeof answer);
    memset(&subject, 0, sizeof subject);
    memset(&pose, 0, sizeof pose);
    memset(&options, 0, sizeof options);
    memset(&filter, 0, sizeof filter);
    memset(&record, 0, sizeof record);
    pose.struct_size = sizeof pose;
    options.struct_size = sizeof options;
    record.struct_size = sizeof record;
    record.pose = &pose;
    record.options = &options;
    filter.struct_size = sizeof filter;
    record.filter = &filter;
    answer.path = set->replay_path;
    void *bytes = model_file_bytes(set->replay_path, &size, error);
    bool done = bytes != NULL;
    if (done) {
        sc_status status = sc_record_read(bytes, size, &record);
        if (status == SC_OK && !use_options(set, &options)) status = SC_ERROR_OPTION;
        if (status == SC_OK && wants_list(set) && set->any) {
            status = SC_ERROR_OPTION;
            snprintf(reason, sizeof reason, "the record asks for no list");
        }
        if (status == SC_OK && record.left_out & SC_LEFT_OUT_ACCEPT)
            tool_error(
                "%s: note: the query had a function to refuse pairs (accept), which is not in "
                "the record: there may be more pairs here",
                set->replay_path);
        if (status == SC_OK && record.left_out & SC_LEFT_OUT_CANCEL)
            tool_error(
                "%s: note: the query could be cancelled by a flag, which is not in the record",
                set->replay_path);
        const double start = tool_clock();
        if (status == SC_OK)
            status = model_file_load(record.model, record.model_size, &subject.model, reason);
        subject.build_ms = tool_clock() - start;
        if (status == SC_OK) status = query_threads_workspace(subject.model, 0, &subject.workspace);
        done = status == SC_OK;
        if (!done) {
            snprintf(error, sizeof error, "%s: %s%s%s", set->replay_path, sc_status_string(status),
                     reason[0] ? ": " : "", reason);
        }
    }
    if (done) follow_model(set, subject.model);
    if (done && out) write_pairs_head(out, set);
    if (done) done = run_pose(&subject, set->replay_path, &pose, set, list, &answer, error);
    const int status = report(&answer, set, done, error, out, list);
    set->given = NULL;
    query_subject_free(&subject);
    free(bytes);
    return status;
}

static int do_files(char **paths, int path_count, settings *set)
{
    query_subject rest;
    memset(&rest, 0, sizeof rest);
    pair_list list = {NULL, 0, 0, NULL};
    FILE *out = NULL;
    int status = TOOL_CLEAN;

    if (set->rest_path) {
        const query_subject_how how = {set->weld, set->partition, rest_marks(set), set->content, 0,
                                       true};
        char error[MESH_FILE_ERROR_SIZE];
        if (!query_subject_load(&rest, set->rest_path, &how, error)) {
            tool_error("%s", error);
            return TOOL_FAILED;
        }
    } else if (set->model_path) {
        char error[MESH_FILE_ERROR_SIZE];
        if (!query_subject_open(&rest, set->model_path, 0, error)) {
            tool_error("%s", error);
            return TOOL_FAILED;
        }
        follow_model(set, rest.model);
    }
    if (status == TOOL_CLEAN && set->out_path) {
        out = fopen(set->out_path, "w");
        if (!out) {
            tool_error("%s: cannot be written: %s", set->out_path, strerror(errno));
            status = TOOL_FAILED;
        } else if (!set->replay_path) {
            write_pairs_head(out, set);
        }
    }
    if (status == TOOL_CLEAN) {
        const query_subject *common = set->rest_path || set->model_path ? &rest : NULL;
        if (!set->json) print_table_head(set);
        if (set->replay_path) status = do_replay(set, out, &list);
        for (int i = 0; i < path_count; i++) {
            const int done = do_file(paths[i], set, common, out, &list);
            status = query_text_worse(status, done);
        }
    }
    if (out) {
        const bool written = !ferror(out);
        if (fclose(out) != 0 || !written) {
            tool_error("%s: could not be written to the end", set->out_path);
            status = TOOL_FAILED;
        }
    }
    free(list.pairs);
    free(list.contacts);
    query_subject_free(&rest);
    return status;
}

/* Between frames, in place of do_files. */
static int do_steps(char **paths, int path_count, settings *set)
{
    step_settings *step = &set->step;
    step->weld = set->weld;
    step->partition = set->partition;
    step->contour = set->contour;
    step->rest_path = set->rest_path;
    step->model_path = set->model_path;
    step->out_path = set->out_path;
    step->budget = set->budget;
    step->any = set->any;
    step->json = set->json;
    step->stats = set->stats;
    return step_query_frames(paths, path_count, step);
}

/* What --method auto is, where models are built: boxes alone pay for one query. */
static void choose_method(settings *set)
{
    const bool is_once = !set->rest_path && !set->model_path && !set->replay_path;
    const bool is_plain = set->contour == SC_CONTOUR_DEFAULT && !set->no_rest_cache &&
                          set->partition == TOOL_PARTITION_FAST && !set->record_path &&
                          !set->stats && !set->budget;
    if (set->method == SC_METHOD_DEFAULT && is_once && is_plain) {
        set->content = SC_MODEL_BOXES;
        set->method = SC_METHOD_AABB;
    } else if (set->method == SC_METHOD_DEFAULT && (is_once || set->rest_path)) {
        set->method = SC_METHOD_SCTT;
    }
    if (set->contour != SC_CONTOUR_DEFAULT && set->method == SC_METHOD_DEFAULT)
        set->method = SC_METHOD_SCTT;
    if (set->contour == SC_CONTOUR_DEFAULT) set->contour = SC_CONTOUR_EXACT;
}

/* What cannot be asked for together. */
static bool check_settings(const settings *set, int path_count)
{
    const char *reason = NULL;
    if (set->is_step && set->not_of_steps) {
        tool_error("--step does not go with --%s; see sc-query --help", set->not_of_steps);
        return false;
    }
    if (set->replay_path &&
        (path_count > 0 || set->rest_path || set->model_path || set->record_path))
        reason = "--replay takes no mesh, rest mesh or model, and makes no record";
    else if (set->replay_path && set->is_asked)
        reason = "--replay asks what the record asks, and as it does";
    else if (set->replay_path && set->ply_path)
        reason = "--replay has no faces for --ply";
    else if (set->is_step_asked && !set->is_step)
        reason = "--separation, --tolerance and --times are of --step";
    else if (set->step.times && set->any)
        reason = "--any finds no times";
    else if (path_count == 0 && !set->replay_path)
        reason = "no mesh given";
    else if (set->model_path && (set->rest_path || set->is_built))
        reason = "--model is in place of --rest, --weld and --partition";
    else if (set->record_path && path_count > 1)
        reason = "--record takes one mesh only";
    else if (wants_list(set) && set->any)
        reason = "--any finds no list for --out, --ply or --contacts";
    else if (wants_list(set) && set->pairs == 2)
        reason = "--pairs none leaves no list for --out, --ply or --contacts";
    else if (set->ply_path && path_count > 1)
        reason = "--ply takes one mesh only";
    if (!reason) return true;
    tool_error("%s; see sc-query --help", reason);
    return false;
}

/* No file that is to be read is written over. */
static bool spares_files(const settings *set, char *const *paths, int count)
{
    const char *const out[] = {set->out_path, set->ply_path, set->record_path};
    for (int i = 0; i < 3; i++) {
        if (!tool_spares(out[i], set->rest_path) || !tool_spares(out[i], set->model_path) ||
            !tool_spares(out[i], set->replay_path) || !tool_spares(out[i], set->groups_path))
            return false;
        for (int path = 0; path < count; path++) {
            if (!tool_spares(out[i], paths[path])) return false;
        }
    }
    return true;
}

int main(int argc, char **argv)
{
    enum {
        OPTION_PAIRS = 256,
        OPTION_PROPER,
        OPTION_STEP,
        OPTION_SEPARATION,
        OPTION_TOLERANCE,
        OPTION_TIMES,
        OPTION_ANY,
        OPTION_WELD,
        OPTION_REST,
        OPTION_JSON,
        OPTION_OUT,
        OPTION_PLY,
        OPTION_MODEL,
        OPTION_RECORD,
        OPTION_REPLAY,
        OPTION_STATS,
        OPTION_METHOD,
        OPTION_CONTOUR,
        OPTION_PARTITION,
        OPTION_NO_REST_CACHE,
        OPTION_IGNORE_RINGS,
        OPTION_IGNORE,
        OPTION_GROUPS,
        OPTION_CONTACTS,
        OPTION_BUDGET,
        OPTION_THREADS,
        OPTION_FORMAT,
        OPTION_VERSION = 'V',
        OPTION_HELP = 'h'
    };
    static const struct option options[] = {
        {"pairs", required_argument, NULL, OPTION_PAIRS},
        {"proper", no_argument, NULL, OPTION_PROPER},
        {"any", no_argument, NULL, OPTION_ANY},
        {"step", no_argument, NULL, OPTION_STEP},
        {"separation", required_argument, NULL, OPTION_SEPARATION},
        {"tolerance", required_argument, NULL, OPTION_TOLERANCE},
        {"times", no_argument, NULL, OPTION_TIMES},
        {"weld", required_argument, NULL, OPTION_WELD},
        {"rest", required_argument, NULL, OPTION_REST},
        {"json", no_argument, NULL, OPTION_JSON},
        {"out", required_argument, NULL, OPTION_OUT},
        {"ply", required_argument, NULL, OPTION_PLY},
        {"model", required_argument, NULL, OPTION_MODEL},
        {"record", required_argument, NULL, OPTION_RECORD},
        {"replay", required_argument, NULL, OPTION_REPLAY},
        {"stats", no_argument, NULL, OPTION_STATS},
        {"method", required_argument, NULL, OPTION_METHOD},
        {"contour", required_argument, NULL, OPTION_CONTOUR},
        {"partition", required_argument, NULL, OPTION_PARTITION},
        {"no-rest-cache", no_argument, NULL, OPTION_NO_REST_CACHE},
        {"ignore-rings", required_argument, NULL, OPTION_IGNORE_RINGS},
        {"ignore", required_argument, NULL, OPTION_IGNORE},
        {"groups", required_argument, NULL, OPTION_GROUPS},
        {"contacts", no_argument, NULL, OPTION_CONTACTS},
        {"budget", required_argument, NULL, OPTION_BUDGET},
        {"threads", required_argument, NULL, OPTION_THREADS},
        {"format", required_argument, NULL, OPTION_FORMAT},
        {"version", no_argument, NULL, OPTION_VERSION},
        {"help", no_argument, NULL, OPTION_HELP},
        {NULL, 0, NULL, 0}};

    static char name[] = "sc-query";
    argv[0] = name; /* in messages of getopt_long, too */
    tool_set_name(name);
    settings set;
    memset(&set, 0, sizeof set);
    set.step.method = SC_STEP_METHOD_SCTT;
    bool valid = true;
    uint32_t budget = 0, threads = 1, format = MESH_FORMAT_UNKNOWN;
    int option, which = 0;
    while ((option = getopt_long(argc, argv, "hV", options, &which)) != -1) {
        if (option == OPTION_PAIRS || option == OPTION_PROPER || option == OPTION_PLY ||
            option == OPTION_RECORD || option == OPTION_REPLAY || option == OPTION_NO_REST_CACHE ||
            option == OPTION_IGNORE_RINGS || option == OPTION_IGNORE || option == OPTION_GROUPS ||
            option == OPTION_CONTACTS)
            set.not_of_steps = options[which].name;
        set.is_built |= option == OPTION_WELD || option == OPTION_PARTITION;
        set.is_asked |= option == OPTION_PAIRS || option == OPTION_PROPER || option == OPTION_ANY ||
                        option == OPTION_WELD || option == OPTION_METHOD ||
                        option == OPTION_CONTOUR || option == OPTION_PARTITION ||
                        option == OPTION_NO_REST_CACHE || option == OPTION_BUDGET ||
                        option == OPTION_IGNORE_RINGS || option == OPTION_IGNORE ||
                        option == OPTION_GROUPS;
        switch (option) {
        case OPTION_PAIRS:
            valid &= tool_choose("--pairs", optarg, pair_choices, &set.pairs);
            break;
        case OPTION_PROPER:
            set.proper = true;
            break;
        case OPTION_STEP:
            set.is_step = true;
            break;
        case OPTION_SEPARATION:
            valid &= tool_parse_real("--separation", optarg, &set.step.separation);
            set.is_step_asked = true;
            break;
        case OPTION_TOLERANCE:
            valid &= tool_parse_real("--tolerance", optarg, &set.step.tolerance);
            if (set.step.tolerance == 0) {
                tool_error("--tolerance: '%s' is not more than 0", optarg);
                valid = false;
            }
            set.is_step_asked = true;
            break;
        case OPTION_TIMES:
            set.step.times = set.is_step_asked = true;
            break;
        case OPTION_ANY:
            set.any = true;
            break;
        case OPTION_WELD:
            valid &= tool_choose("--weld", optarg, tool_welds, &set.weld);
            break;
        case OPTION_REST:
            set.rest_path = optarg;
            break;
        case OPTION_JSON:
            set.json = true;
            break;
        case OPTION_OUT:
            set.out_path = optarg;
            break;
        case OPTION_PLY:
            set.ply_path = optarg;
            break;
        case OPTION_MODEL:
            set.model_path = optarg;
            break;
        case OPTION_RECORD:
            set.record_path = optarg;
            break;
        case OPTION_REPLAY:
            set.replay_path = optarg;
            break;
        case OPTION_STATS:
            set.stats = true;
            break;
        case OPTION_METHOD:
            set.method_name = optarg;
            break;
        case OPTION_CONTOUR:
            valid &= tool_choose("--contour", optarg, query_text_contours, &set.contour);
            break;
        case OPTION_PARTITION:
            valid &= tool_choose("--partition", optarg, tool_partitions, &set.partition);
            break;
        case OPTION_NO_REST_CACHE:
            set.no_rest_cache = true;
            break;
        case OPTION_IGNORE_RINGS:
            valid &=
                tool_parse_number("--ignore-rings", optarg, 0, SC_RINGS_MAX, &set.ignore_rings);
            break;
        case OPTION_IGNORE:
            set.ignore_path = optarg;
            break;
        case OPTION_GROUPS:
            set.groups_path = optarg;
            break;
        case OPTION_CONTACTS:
            set.contacts = true;
            break;
        case OPTION_BUDGET:
            valid &= tool_parse_number("--budget", optarg, 1, UINT32_MAX, &budget);
            set.budget = budget;
            break;
        case OPTION_THREADS:
            valid &= tool_parse_number("--threads", optarg, 1, SC_WORKERS_MAX, &threads);
            break;
        case OPTION_FORMAT:
            valid &= tool_choose("--format", optarg, tool_formats, &format);
            mesh_file_assume(format);
            break;
        case OPTION_VERSION:
            printf("sc-query (starcontour) %s\n", sc_version_string());
            return tool_finish(TOOL_CLEAN);
        case OPTION_HELP:
            fputs(usage, stdout);
            fputs(usage_continued, stdout);
            return tool_finish(TOOL_CLEAN);
        default:
            tool_error("see sc-query --help");
            valid = false;
            break;
        }
    }
    if (set.method_name)
        valid &=
            tool_choose("--method", set.method_name, set.is_step ? step_methods : method_choices,
                        set.is_step ? &set.step.method : &set.method);
    if (!valid || !check_settings(&set, argc - optind) ||
        !spares_files(&set, argv + optind, argc - optind))
        return tool_finish(TOOL_FAILED);
    choose_method(&set);
    if (set.contour == SC_CONTOUR_NONE &&
        (set.is_step ? set.step.method == SC_STEP_METHOD_SCTT : set.method == SC_METHOD_SCTT)) {
        tool_error("note: --contour none can miss pairs");
    }
    if (!query_threads_start(threads)) {
        tool_error("--threads: they cannot be started");
        return tool_finish(TOOL_FAILED);
    }
    filter_file filters;
    char error[MESH_FILE_ERROR_SIZE];
    int status = TOOL_FAILED;
    memset(&filters, 0, sizeof filters);
    set.filters = &filters;
    if (set.is_step)
        status = do_steps(argv + optind, argc - optind, &set);
    else if (filter_file_read(&filters, set.ignore_path, set.groups_path, chosen_pairs(&set),
                              error))
        status = do_files(argv + optind, argc - optind, &set);
    else
        tool_error("%s", error);
    filter_file_free(&filters);
    query_threads_stop();
    return tool_finish(status);
}
