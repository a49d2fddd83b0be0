/*
 * sc-against: two builds of the library on the same frames, in turns, in one process.
 *
 * SPDX-License-Identifier: MIT
 *
 *     sc-against [options] OLD.so NEW.so SCENE-FOLDER...
 *
 * For each scene and way of asking (method, instruction set, workers) both libraries build a model
 * of the first frame. They take turns in each frame that is asked about, in every other round the
 * other way round, and the least time of each frame counts. A ratio is new / old: below 1 the new
 * one is faster. That of a scene is the ratio of the sums over its frames; *worst* is the greatest
 * of single frames of more than 0.05 milliseconds. The last lines are geometric means over the
 * scenes.
 *
 * Both must count the same pairs in every frame, or the exit status is 1. 2: something could not be
 * done.
 */
#define _POSIX_C_SOURCE 200809L

#include "scene_folder.h"
#include "thread_pool.h"
#include "tool.h"

#include <dlfcn.h>
#include <getopt.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char usage[] =
    "Usage: sc-against [options] OLD.so NEW.so SCENE-FOLDER...\n"
    "Times two builds of the library on the same frames, in turns, and compares how many\n"
    "pairs they find.\n"
    "\n"
    "  --ways WAY,...    METHOD[@SET][*WORKERS] each, METHOD one of exact, star, none, aabb-sctt,\n"
    "                    aabb, boxes (model for boxes), step, swept; SET\n"
    "                    avx512, avx2 or base; by default\n"
    "                    exact,aabb,exact@avx2,aabb@avx2,exact@base,exact*2,step,step*2\n"
    "  --frames N        frames of each scene, evenly spread, with the first and the last (6)\n"
    "  --rounds N        rounds in each frame at least (5); more while they take less than 20 ms\n"
    "  --step F          a step goes this part of the way to the next frame (0.1)\n"
    "  -h, --help\n"
    "\n"
    "Exit status: 0, 1 where numbers of pairs differ, 2 if something could not be done.\n";

/* The calls of one library. */
typedef struct library {
    const char *path;
    void *handle;
    sc_status (*build)(const sc_mesh *, const sc_build_options *, sc_model **);
    void (*model_free)(sc_model *);
    sc_status (*workspace_create)(const sc_model *, const sc_workspace_options *, sc_workspace **);
    void (*workspace_free)(sc_workspace *);
    sc_status (*query)(const sc_model *, sc_workspace *, const sc_pose *, const sc_query_options *,
                       sc_result *);
    sc_status (*query_step)(const sc_model *, sc_workspace *, const sc_pose *, const sc_pose *,
                            const sc_step_options *, sc_step_result *);
    sc_model *model;
    sc_workspace *workspace;
} library;

typedef struct way {
    char name[48];
    bool is_step;
    uint32_t method, contour, content, simd, workers;
    double log_sum; /* of the ratios of scenes */
    uint32_t scenes;
} way;

typedef struct run {
    library both[2];
    way *ways;
    size_t way_count;
    uint32_t frames, rounds;
    double step;
    bool differs;
} run;

static const struct {
    const char *name;
    bool is_step;
    uint32_t method, contour, content;
} methods[] = {{"exact", false, SC_METHOD_SCTT, SC_CONTOUR_EXACT, SC_MODEL_FULL},
               {"star", false, SC_METHOD_SCTT, SC_CONTOUR_STAR, SC_MODEL_FULL},
               {"none", false, SC_METHOD_SCTT, SC_CONTOUR_NONE, SC_MODEL_FULL},
               {"aabb-sctt", false, SC_METHOD_AABB_SCTT, 0, SC_MODEL_FULL},
               {"aabb", false, SC_METHOD_AABB, 0, SC_MODEL_FULL},
               {"boxes", false, SC_METHOD_AABB, 0, SC_MODEL_BOXES},
               {"step", true, SC_STEP_METHOD_SCTT, SC_CONTOUR_EXACT, SC_MODEL_FULL},
               {"swept", true, SC_STEP_METHOD_SWEPT, 0, SC_MODEL_FULL}};

/* ISO C does not let a pointer to data become one to a function, POSIX does. */
static bool find(library *l, const char *name, void *function)
{
    void *found = dlsym(l->handle, name);
    if (!found) {
        tool_error("%s: there is no %s", l->path, name);
        return false;
    }
    memcpy(function, &found, sizeof found);
    return true;
}

static bool open_library(library *l, const char *path)
{
    l->path = path;
    l->handle = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    if (!l->handle) {
        tool_error("%s", dlerror());
        return false;
    }
    return find(l, "sc_build", &l->build) && find(l, "sc_model_free", &l->model_free) &&
           find(l, "sc_workspace_create_for", &l->workspace_create) &&
           find(l, "sc_workspace_free", &l->workspace_free) && find(l, "sc_query", &l->query) &&
           find(l, "sc_query_step", &l->query_step);
}

static void close_model(library *l)
{
    if (l->workspace) l->workspace_free(l->workspace);
    if (l->model) l->model_free(l->model);
    l->workspace = NULL;
    l->model = NULL;
}

static bool open_model(library *l, const scene_folder *scene, const float *positions,
                       const way *how)
{
    sc_mesh mesh;
    sc_build_options build;
    sc_workspace_options options;
    memset(&mesh, 0, sizeof mesh);
    memset(&build, 0, sizeof build);
    memset(&options, 0, sizeof options);
    mesh.struct_size = sizeof mesh;
    mesh.vertex_count = scene->vertex_count;
    mesh.triangle_count = scene->triangle_count;
    mesh.positions = positions;
    mesh.indices = scene->triangles;
    build.struct_size = sizeof build;
    build.partition = SC_PARTITION_FAST;
    build.content = how->content;
    build.rest = how->contour == SC_CONTOUR_STAR ? SC_REST_MARKED : SC_REST_UNMARKED;
    options.struct_size = sizeof options;
    options.workers = how->workers;
    options.flags = how->is_step ? SC_WORKSPACE_STEP : 0;
    sc_status status = l->build(&mesh, &build, &l->model);
    if (status == SC_OK) status = l->workspace_create(l->model, &options, &l->workspace);
    if (status == SC_OK) return true;
    tool_error("%s: %s", l->path, sc_status_string(status));
    return false;
}

/* Asks about a pose, or about the step between two. Returns milliseconds, or less than 0. */
static double ask(library *l, const sc_pose poses[2], const way *how, const sc_tasks *tasks,
                  uint64_t *pairs)
{
    sc_status status;
    double begin = tool_clock(), took;
    if (how->is_step) {
        sc_step_options options;
        sc_step_result result;
        memset(&options, 0, sizeof options);
        memset(&result, 0, sizeof result);
        options.struct_size = sizeof options;
        options.output = SC_OUTPUT_COUNT;
        options.times = SC_STEP_TIMES_EARLIEST;
        options.method = how->method;
        options.contour = how->contour;
        options.simd = how->simd;
        options.tasks = tasks;
        result.struct_size = sizeof result;
        status = l->query_step(l->model, l->workspace, &poses[0], &poses[1], &options, &result);
        *pairs = result.vertex_face_count + result.edge_edge_count;
    } else {
        sc_query_options options;
        sc_result result;
        memset(&options, 0, sizeof options);
        memset(&result, 0, sizeof result);
        options.struct_size = sizeof options;
        options.output = SC_OUTPUT_COUNT;
        options.method = how->method;
        options.contour = how->contour;
        options.simd = how->simd;
        options.tasks = tasks;
        result.struct_size = sizeof result;
        status = l->query(l->model, l->workspace, &poses[0], &options, &result);
        *pairs = result.count;
    }
    took = tool_clock() - begin;
    if (status == SC_OK) return took;
    tool_error("%s: %s: %s", l->path, how->name, sc_status_string(status));
    return -1;
}

/* Both libraries on one frame: the least time of each. */
static bool time_frame(run *r, const sc_pose poses[2], const way *how, const sc_tasks *tasks,
                       const char *where, double least[2])
{
    const double begin = tool_clock();
    uint64_t pairs[2] = {0, 0};
    least[0] = least[1] = HUGE_VAL;
    for (uint32_t round = 0; round <= r->rounds || tool_clock() - begin < 20; round++) {
        for (uint32_t turn = 0; turn < 2; turn++) {
            const uint32_t which = (turn + round) % 2;
            const double took = ask(&r->both[which], poses, how, tasks, &pairs[which]);
            if (took < 0) return false;
            if (round && took < least[which]) least[which] = took; /* the first one warms up */
        }
        if (round > 200) break;
    }
    if (pairs[0] != pairs[1]) {
        tool_error("%s, %s: %.0f pairs, and %.0f", where, how->name, (double)pairs[0],
                   (double)pairs[1]);
        r->differs = true;
    }
    return true;
}

/* A frame, or for the end of a step the place between it and the next, as floats. */
static bool read_frame(scene_folder *scene, uint32_t frame, double part, double *room,
                       float *positions)
{
    const size_t count = 3 * (size_t)scene->vertex_count;
    const uint32_t next = frame + 1 < scene->frame_count ? frame + 1 : frame - 1;
    char error[MESH_FILE_ERROR_SIZE];
    if (scene_folder_frame(scene, frame, room, error, sizeof error) != 0 ||
        (part > 0 && scene_folder_frame(scene, next, room + count, error, sizeof error) != 0)) {
        tool_error("%s", error);
        return false;
    }
    for (size_t i = 0; i < count; i++)
        positions[i] = (float)(part > 0 ? room[i] + part * (room[count + i] - room[i]) : room[i]);
    return true;
}

static bool time_way(run *r, scene_folder *scene, const char *name, way *how, float *const at[3],
                     double *room)
{
    const uint32_t count = r->frames < scene->frame_count ? r->frames : scene->frame_count;
    double sum[2] = {0, 0}, worst = 0;
    thread_pool *pool = how->workers > 1 ? thread_pool_create(how->workers) : NULL;
    bool good = how->workers < 2 || pool;
    for (int k = 0; k < 2 && good; k++) good = open_model(&r->both[k], scene, at[0], how);
    for (uint32_t i = 0; i < count && good; i++) {
        const uint32_t frame =
            count > 1 ? (uint32_t)((uint64_t)i * (scene->frame_count - 1) / (count - 1)) : 0;
        const sc_pose poses[2] = {tool_pose(at[1], SC_FLOAT, scene->vertex_count),
                                  tool_pose(at[2], SC_FLOAT, scene->vertex_count)};
        char where[256];
        double least[2];
        snprintf(where, sizeof where, "%s, frame %lu", name, (unsigned long)frame);
        good = read_frame(scene, frame, 0, room, at[1]) &&
               (!how->is_step || read_frame(scene, frame, r->step, room, at[2])) &&
               time_frame(r, poses, how, thread_pool_tasks(pool), where, least);
        if (!good) break;
        for (int k = 0; k < 2; k++) sum[k] += least[k];
        if (least[0] > 0.05) worst = fmax(worst, least[1] / least[0]);
    }
    for (int k = 0; k < 2; k++) close_model(&r->both[k]);
    thread_pool_free(pool);
    if (!good) return false;
    printf("%-24s %-14s %10.3f %10.3f %7.3f %7.3f\n", name, how->name, sum[0] / count,
           sum[1] / count, sum[1] / sum[0], worst);
    fflush(stdout);
    how->log_sum += log(sum[1] / sum[0]);
    how->scenes++;
    return true;
}

static bool time_scene(run *r, const char *path)
{
    scene_folder scene;
    char error[MESH_FILE_ERROR_SIZE];
    const char *name = path + strlen(path);
    while (name > path && name[-1] == '/') name--;
    while (name > path && name[-1] != '/') name--;
    if (scene_folder_open(path, &scene, error, sizeof error) != 0) {
        tool_error("%s", error);
        return false;
    }
    const size_t count = 3 * (size_t)scene.vertex_count;
    double *room = (double *)malloc(2 * count * sizeof(double));
    float *floats = (float *)malloc(3 * count * sizeof(float));
    bool good = room && floats;
    if (!good) tool_error("%s: out of memory", path);
    if (good) {
        float *const at[3] = {floats, floats + count, floats + 2 * count};
        good = read_frame(&scene, 0, 0, room, at[0]);
        for (size_t i = 0; i < r->way_count && good; i++) {
            if (r->ways[i].is_step && scene.frame_count < 2) continue;
            good = time_way(r, &scene, name, &r->ways[i], at, room);
        }
    }
    free(room);
    free(floats);
    scene_folder_close(&scene);
    return good;
}

/* METHOD[@SET][*WORKERS] */
static bool parse_way(const char *text, size_t length, way *how)
{
    static const tool_choice sets[] = {
        {"avx512", SC_SIMD_AVX512}, {"avx2", SC_SIMD_AVX2}, {"base", SC_SIMD_BASE}, {NULL, 0}};
    char *set, *workers;
    memset(how, 0, sizeof *how);
    if (length >= sizeof how->name) length = sizeof how->name - 1;
    memcpy(how->name, text, length);
    char part[sizeof how->name];
    memcpy(part, how->name, sizeof part);
    how->workers = 1;
    workers = strchr(part, '*');
    if (workers) *workers++ = '\0';
    set = strchr(part, '@');
    if (set) *set++ = '\0';
    if (workers && !tool_parse_number("--ways", workers, 1, SC_WORKERS_MAX, &how->workers))
        return false;
    if (set && !tool_choose("--ways", set, sets, &how->simd)) return false;
    for (size_t i = 0; i < sizeof methods / sizeof *methods; i++) {
        if (strcmp(part, methods[i].name) != 0) continue;
        how->is_step = methods[i].is_step;
        how->method = methods[i].method;
        how->contour = methods[i].contour;
        how->content = methods[i].content;
        return true;
    }
    tool_error("--ways: there is no method '%s'; see sc-against --help", part);
    return false;
}

static bool parse_ways(run *r, const char *text)
{
    free(r->ways);
    r->ways = (way *)calloc(strlen(text) + 1, sizeof(way));
    r->way_count = 0;
    if (!r->ways) return false;
    for (;;) {
        const size_t length = strcspn(text, ",");
        if (!parse_way(text, length, &r->ways[r->way_count++])) return false;
        if (!text[length]) return true;
        text += length + 1;
    }
}

int main(int argc, char **argv)
{
    enum { OPTION_WAYS = 256, OPTION_FRAMES, OPTION_ROUNDS, OPTION_STEP };
    static const struct option options[] = {{"ways", required_argument, NULL, OPTION_WAYS},
                                            {"frames", required_argument, NULL, OPTION_FRAMES},
                                            {"rounds", required_argument, NULL, OPTION_ROUNDS},
                                            {"step", required_argument, NULL, OPTION_STEP},
                                            {"help", no_argument, NULL, 'h'},
                                            {NULL, 0, NULL, 0}};
    run r;
    bool good;
    int option;
    tool_set_name("sc-against");
    memset(&r, 0, sizeof r);
    r.frames = 6;
    r.rounds = 5;
    r.step = 0.1;
    good = parse_ways(&r, "exact,aabb,exact@avx2,aabb@avx2,exact@base,exact*2,step,step*2");
    while (good && (option = getopt_long(argc, argv, "h", options, NULL)) != -1) {
        if (option == OPTION_WAYS)
            good = parse_ways(&r, optarg);
        else if (option == OPTION_FRAMES)
            good = tool_parse_number("--frames", optarg, 1, 100000, &r.frames);
        else if (option == OPTION_ROUNDS)
            good = tool_parse_number("--rounds", optarg, 1, 1000, &r.rounds);
        else if (option == OPTION_STEP)
            good = tool_parse_real("--step", optarg, &r.step);
        else if (option == 'h') {
            fputs(usage, stdout);
            free(r.ways);
            return tool_finish(0);
        } else
            good = false;
    }
    if (good && argc - optind < 3) {
        tool_error("two libraries and a scene are wanted; see sc-against --help");
        good = false;
    }
    for (int k = 0; k < 2 && good; k++) good = open_library(&r.both[k], argv[optind + k]);
    if (good)
        printf("%-24s %-14s %10s %10s %7s %7s\n", "scene", "way", "old, ms", "new, ms", "ratio",
               "worst");
    for (int i = optind + 2; i < argc && good; i++) good = time_scene(&r, argv[i]);
    for (size_t i = 0; i < r.way_count && good; i++) {
        const way *w = &r.ways[i];
        if (w->scenes)
            printf("%-24s %-14s %29.3f\n", "geometric mean", w->name, exp(w->log_sum / w->scenes));
    }
    for (int k = 0; k < 2; k++)
        if (r.both[k].handle) dlclose(r.both[k].handle);
    free(r.ways);
    return tool_finish(!good ? 2 : r.differs ? 1 : 0);
}
