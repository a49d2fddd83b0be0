/*
 * sc-bench: measures methods on animated scenes.
 *
 * SPDX-License-Identifier: MIT
 *
 * Reads the command line, gets the scene, and hands it to measure.h and report.h, or writes it out.
 */
#define _POSIX_C_SOURCE 200809L

#include "bench_model.h"
#include "measure.h"
#include "one_shot.h"
#include "progress.h"
#include "report.h"
#include "scenes/scene.h"
#include "scene_folder.h"
#include "query_threads.h"
#include "tool.h"

#include <getopt.h>
#include <stdlib.h>
#include <string.h>

static const char usage[] =
    "Usage: sc-bench --scene NAME [--triangles N] [--frames F] [OPTION...]\n"
    "       sc-bench --scene-dir DIR [OPTION...]\n"
    "       sc-bench [OPTION...] FILE... | PATTERN\n"
    "Measures how long methods take to find the self-collisions of a deforming mesh, frame by "
    "frame,\n"
    "and checks that they find the same.\n"
    "\n"
    "What is measured:\n"
    "  --scene NAME       a generated scene (--list); kept in the cache once it is made\n"
    "  --triangles N      its size; the nearest there is (the smallest that --list shows)\n"
    "  --frames F         its number of frames (as --list shows); of other sources the first F\n"
    "  --scene-dir DIR    a folder with meta.txt, tris.u32 and frames.f64 or frames.f32\n"
    "  FILE...            mesh files, one a frame, in this order, or a pattern such as "
    "'f%04d.obj'\n"
    "The model is built from the first frame.\n"
    "\n"
    "How:\n"
    "  --methods A,B,...  exact, star, none, aabb-sctt, aabb, hash (all; --list explains);\n"
    "                     of steps: step, step-star, step-none, step-two-boxes, step-swept (all);\n"
    "                     of what is near: near, near-count, near-boxes, near-still,\n"
    "                     near-inflated (all).\n"
    "                     exact@avx2: with these instructions; likewise @base and @avx512.\n"
    "                     exact@serial: on one thread, whatever --workers says\n"
    "  --pairs KIND       triangle or edge: pairs of triangles, or of an edge and a triangle;\n"
    "                     step: vertex-face and edge-edge pairs between each frame and the next;\n"
    "                     near: those within a distance in each frame\n"
    "                     (triangle)\n"
    "  --distance D       of --pairs near: in median edges of the first frame (1)\n"
    "  --ignore-rings K   of --pairs near: without pairs within K rings on the surface;\n"
    "                     near and near-count by masks, made before, others by filters (0)\n"
    "  --proper           only proper crossings, not every common point\n"
    "  --partition HOW    fast, metis, or structure: the scene's own order (fast)\n"
    "  --once             one query a frame in sequence, as a simulation runs; with --repeats, so\n"
    "                     many passes over the animation. Without: all repeats of a frame in a "
    "row\n"
    "  --repeats K        queries a frame and method, from 1 to 1000 (5; with --once 1)\n"
    "  --threads K        K frames at once, on K threads with a workspace each; times are then "
    "wall\n"
    "                     time divided by K, that is, throughput: a query runs on one thread (1)\n"
    "  --workers K        each query on K threads; not with --threads (1)\n"
    "  --near             count the pairs of triangles whose boxes overlap, in each frame\n"
    "  --one-shot         one query of the first frame from nothing: build, workspace, query and\n"
    "                     freeing them, by methods of the library (exact, aabb, which gets a "
    "model\n"
    "                     for boxes alone)\n"
    "\n"
    "Output:\n"
    "  --json             JSON Lines: a description of the run, then an object a frame and method\n"
    "  --csv              the same as comma-separated values\n"
    "  --list             names scenes and methods\n"
    "  --export DIR       writes the scene as a folder that --scene-dir reads, and measures "
    "nothing\n"
    "  --export-obj DIR   writes the frames as OBJ files, and measures nothing\n"
    "  --frame K          of --export-obj: frame K alone; the first is 0\n"
    "  --cache DIR        where generated scenes are kept (build/scenes)\n"
    "  -V, --version, -h, --help\n"
    "\n"
    "Exit status: 0, or 1 if a method that must agree with the others does not, or 2 if the job "
    "could\n"
    "not be done.\n";

static const tool_choice pairs_choices[] = {{"triangle", SC_PAIRS_TRIANGLE},
                                            {"edge", SC_PAIRS_EDGE},
                                            {"step", METHOD_STEPS},
                                            {"near", METHOD_NEAR},
                                            {NULL, 0}};

static const tool_choice partition_choices[] = {
    {"fast", BENCH_FAST}, {"metis", BENCH_METIS}, {"structure", BENCH_STRUCTURE}, {NULL, 0}};

typedef struct bench_settings {
    const char *scene, *scene_dir, *methods, *export_dir, *export_obj, *cache;
    uint32_t triangles, frames; /* 0: as the scene has it */
    uint32_t frame, format;
    bool list, one_shot, distance, one_frame; /* distance, one_frame: it was given, a frame was */
    measure_options measure;
} bench_settings;

/* ------------------------------------------------------------------------------------------------
 * The scene
 */

static void show_making(void *user, uint32_t frame, uint32_t frames)
{
    char what[64];
    snprintf(what, sizeof what, "making %.40s", (const char *)user);
    progress_show(what, frame, frames);
}

static const scene_kind *find_scene(const char *name)
{
    size_t count;
    const scene_kind *kinds = scene_kinds(&count);
    for (size_t i = 0; i < count; i++) {
        if (strcmp(kinds[i].name, name) == 0) return &kinds[i];
    }
    tool_error("--scene: there is no scene '%s'; see --list", name);
    return NULL;
}

static bool open_generated(const bench_settings *set, scene_folder *scene)
{
    char folder[1024], error[MESH_FILE_ERROR_SIZE];
    const scene_kind *kind = find_scene(set->scene);
    if (!kind) return false;
    const uint32_t triangles = set->triangles ? set->triangles : kind->sizes[0];
    const uint32_t frames = set->frames ? set->frames : kind->frames;
    char name[64];
    snprintf(name, sizeof name, "%s", set->scene);
    int result = scene_cached(set->scene, triangles, frames, set->cache, show_making, name, folder,
                              sizeof folder, error, sizeof error);
    progress_end();
    if (result == 0) result = scene_folder_open(folder, scene, error, sizeof error);
    if (result != 0) tool_error("%s", error);
    return result == 0;
}

static bool open_given(const bench_settings *set, char **paths, int path_count, scene_folder *scene)
{
    char error[MESH_FILE_ERROR_SIZE];
    int result;
    if (set->scene_dir)
        result = scene_folder_open(set->scene_dir, scene, error, sizeof error);
    else if (path_count == 1 && strchr(paths[0], '%'))
        result = scene_folder_open_pattern(paths[0], scene, error, sizeof error);
    else
        result = scene_folder_open_files((const char *const *)paths, (uint32_t)path_count, scene,
                                         error, sizeof error);
    if (result != 0) {
        tool_error("%s", error);
        return false;
    }
    if (set->triangles) {
        tool_error("--triangles: only generated scenes (--scene) come in sizes");
        scene_folder_close(scene);
        return false;
    }
    if (set->frames && set->frames < scene->frame_count) scene->frame_count = set->frames;
    return true;
}

/* The last part of a path, without trailing slashes. */
static void name_of_path(const char *path, char *name, size_t size)
{
    size_t end = strlen(path);
    while (end > 1 && path[end - 1] == '/') end--;
    size_t begin = end;
    while (begin > 0 && path[begin - 1] != '/') begin--;
    snprintf(name, size, "%.*s", (int)(end - begin), path + begin);
}

/* ------------------------------------------------------------------------------------------------
 * Measuring
 */

/* The methods of a run. */
typedef struct method_choice {
    method_variant variants[16];
    const method_kind *kinds[16];
    size_t count;
} method_choice;

static bool add_method(method_choice *choice, const char *name, uint32_t asked)
{
    method_variant *variant = &choice->variants[choice->count];
    const char *reason;
    if (choice->count == sizeof choice->kinds / sizeof *choice->kinds) {
        tool_error("--methods: too many");
        return false;
    }
    if (!method_read(name, variant, &reason)) {
        tool_error("--methods: %s: %s; see --list", name, reason);
        return false;
    }
    if (method_asks(&variant->kind) != asked) {
        const uint32_t own = method_asks(&variant->kind);
        tool_error("--methods: %s %s", name,
                   own == METHOD_STEPS     ? "is of steps: --pairs step"
                   : own == METHOD_NEAR    ? "is of what is near: --pairs near"
                   : asked == METHOD_STEPS ? "knows no steps (--pairs step)"
                                           : "knows no distance (--pairs near)");
        return false;
    }
    for (size_t i = 0; i < choice->count; i++) {
        if (strcmp(choice->kinds[i]->name, name) != 0) continue;
        tool_error("--methods: %s is there twice", name);
        return false;
    }
    choice->kinds[choice->count++] = &variant->kind;
    return true;
}

/* Those that text names, or all. */
static bool choose_methods(const char *text, uint32_t asked, method_choice *choice)
{
    choice->count = 0;
    for (size_t i = 0; !text && i < method_count; i++) {
        if (!method_kinds[i].missing && method_asks(&method_kinds[i]) == asked)
            add_method(choice, method_kinds[i].name, asked);
    }
    while (text && *text) {
        char name[32];
        const size_t length = strcspn(text, ",");
        snprintf(name, sizeof name, "%.*s", (int)(length < 31 ? length : 31), text);
        text += length;
        if (*text == ',') text++;
        if (!add_method(choice, name, asked)) return false;
    }
    if (choice->count == 0) tool_error("--methods: names no method; see --list");
    return choice->count > 0;
}

/* Says which methods disagree, where and by how much. */
static void show_disagreement(const measurement *m)
{
    for (size_t i = 0; i < m->method_count; i++) {
        for (uint32_t frame = 0; frame < m->frame_count; frame++) {
            const measure_record *record = &m->records[frame * m->method_count + i];
            const bool loose = m->methods[i]->near == NEAR_STILL;
            if ((!record->extra || loose) && (!record->missed || m->methods[i]->unsound)) continue;
            tool_error("frame %lu: %s misses %.0f pairs and has %.0f that are none: this is a bug, "
                       "please report it",
                       (unsigned long)frame, m->methods[i]->name, (double)record->missed,
                       (double)record->extra);
            break;
        }
    }
}

static int measure_scene(const bench_settings *set, scene_folder *scene, const char *name)
{
    method_choice choice;
    char error[MESH_FILE_ERROR_SIZE];
    measurement m;
    const uint32_t pairs = set->measure.question.pairs;
    const uint32_t asked = pairs == SC_PAIRS_EDGE ? SC_PAIRS_TRIANGLE : pairs;
    if (!choose_methods(set->methods, asked, &choice)) return TOOL_FAILED;
    memset(&m, 0, sizeof m);
    m.methods = choice.kinds;
    m.method_count = choice.count;
    const bool done = measure_run(&m, scene, &set->measure, progress_show, error, sizeof error);
    progress_end();
    if (!done) {
        tool_error("%s", error);
        return TOOL_FAILED;
    }
    const measure_options *options = &set->measure;
    const report_context context = {
        name,
        tool_choice_name(partition_choices, options->partition),
        options->mode == MEASURE_ONCE ? "once" : "warm",
        tool_choice_name(pairs_choices, options->question.pairs),
        options->question.contact == SC_CONTACT_PROPER ? "proper" : "touching",
        scene->triangle_count,
        scene->vertex_count,
        options,
    };
    int status = TOOL_CLEAN;
    if (!report_print(&m, &context, set->format)) {
        tool_error("out of memory");
        status = TOOL_FAILED;
    } else if (m.disagrees) {
        show_disagreement(&m);
        status = TOOL_COLLIDES;
    }
    measure_free(&m);
    return status;
}

static int measure_one_shot(const bench_settings *set, scene_folder *scene, const char *name)
{
    method_choice choice;
    char error[MESH_FILE_ERROR_SIZE];
    if (!choose_methods(set->methods ? set->methods : "exact,aabb", SC_PAIRS_TRIANGLE, &choice))
        return TOOL_FAILED;
    for (size_t i = 0; i < choice.count; i++) {
        if (!choice.kinds[i]->is_hash) continue;
        tool_error("--one-shot: by methods of the library only");
        return TOOL_FAILED;
    }
    const one_shot_options options = {set->measure.question, set->measure.partition,
                                      set->measure.repeats};
    if (one_shot_run(scene, name, choice.kinds, choice.count, &options, set->format == REPORT_JSON,
                     error, sizeof error))
        return TOOL_CLEAN;
    tool_error("%s", error);
    return TOOL_FAILED;
}

/* ------------------------------------------------------------------------------------------------
 * Listing, exporting, the command line
 */

static void list_all(void)
{
    size_t count;
    const scene_kind *kinds = scene_kinds(&count);
    puts("Scenes (usual frames; usual numbers of triangles):");
    for (size_t i = 0; i < count; i++) {
        printf("  %-14s %s\n  %-14s %lu frames;", kinds[i].name, kinds[i].about, "",
               (unsigned long)kinds[i].frames);
        for (const uint32_t *size = kinds[i].sizes; *size; size++) {
            printf(" %lu", (unsigned long)*size);
        }
        putchar('\n');
    }
    puts("Methods:");
    for (size_t i = 0; i < method_count; i++) {
        printf("  %-14s %s%s%s%s\n", method_kinds[i].name, method_kinds[i].about,
               method_kinds[i].missing ? " (" : "",
               method_kinds[i].missing ? method_kinds[i].missing : "",
               method_kinds[i].missing ? ")" : "");
    }
}

static int export_scene(const bench_settings *set, scene_folder *scene)
{
    char error[MESH_FILE_ERROR_SIZE];
    int result = 0;
    if (set->one_frame && set->frame >= scene->frame_count) {
        tool_error("--frame: the frames are 0 to %lu", (unsigned long)scene->frame_count - 1);
        return TOOL_FAILED;
    }
    const uint32_t count = set->one_frame ? 1 : scene->frame_count;
    if (set->export_dir)
        result = scene_folder_export(scene, set->export_dir, false, error, sizeof error);
    if (result == 0 && set->export_obj)
        result =
            scene_folder_export_obj(scene, set->frame, count, set->export_obj, error, sizeof error);
    if (result != 0) tool_error("%s", error);
    return result == 0 ? TOOL_CLEAN : TOOL_FAILED;
}

static int run(const bench_settings *set, char **paths, int path_count)
{
    const bool near = set->measure.question.pairs == METHOD_NEAR;
    const bool steps = set->measure.question.pairs == METHOD_STEPS;
    if ((steps || near) && set->measure.question.contact == SC_CONTACT_PROPER) {
        tool_error("--proper: %s",
                   steps ? "a step has no proper crossings" : "what is near need not cross");
        return TOOL_FAILED;
    }
    if (set->one_shot && (steps || near)) {
        tool_error("--one-shot: %s", steps ? "a step is none" : "only of pairs that meet");
        return TOOL_FAILED;
    }
    if (!near && (set->distance || set->measure.question.ignore_rings)) {
        tool_error("%s: of --pairs near only", set->distance ? "--distance" : "--ignore-rings");
        return TOOL_FAILED;
    }
    if (set->one_frame && !set->export_obj) {
        tool_error("--frame: of --export-obj only");
        return TOOL_FAILED;
    }
    const int sources = (set->scene != NULL) + (set->scene_dir != NULL) + (path_count > 0);
    if (set->list) {
        list_all();
        return TOOL_CLEAN;
    }
    if (sources != 1) {
        tool_error("%s; see sc-bench --help",
                   sources ? "one of --scene, --scene-dir and files at a time" : "no scene given");
        return TOOL_FAILED;
    }
    scene_folder scene;
    char name[256];
    name_of_path(set->scene       ? set->scene
                 : set->scene_dir ? set->scene_dir
                                  : paths[0],
                 name, sizeof name);
    if (!(set->scene ? open_generated(set, &scene) : open_given(set, paths, path_count, &scene)))
        return TOOL_FAILED;
    const int status = set->export_dir || set->export_obj ? export_scene(set, &scene)
                       : set->one_shot                    ? measure_one_shot(set, &scene, name)
                                                          : measure_scene(set, &scene, name);
    scene_folder_close(&scene);
    return status;
}

/* A positive, finite number of edges. */
static bool parse_distance(const char *text, double *edges)
{
    if (!tool_parse_real("--distance", text, edges)) return false;
    if (*edges > 0.0) return true;
    tool_error("--distance: a number of edges above 0");
    return false;
}

int main(int argc, char **argv)
{
    enum {
        OPTION_SCENE = 256,
        OPTION_TRIANGLES,
        OPTION_FRAMES,
        OPTION_SCENE_DIR,
        OPTION_METHODS,
        OPTION_PAIRS,
        OPTION_DISTANCE,
        OPTION_IGNORE_RINGS,
        OPTION_PROPER,
        OPTION_PARTITION,
        OPTION_ONCE,
        OPTION_REPEATS,
        OPTION_THREADS,
        OPTION_WORKERS,
        OPTION_NEAR,
        OPTION_ONE_SHOT,
        OPTION_JSON,
        OPTION_CSV,
        OPTION_LIST,
        OPTION_EXPORT,
        OPTION_EXPORT_OBJ,
        OPTION_FRAME,
        OPTION_CACHE,
        OPTION_VERSION = 'V',
        OPTION_HELP = 'h'
    };
    static const struct option options[] = {
        {"scene", required_argument, NULL, OPTION_SCENE},
        {"triangles", required_argument, NULL, OPTION_TRIANGLES},
        {"frames", required_argument, NULL, OPTION_FRAMES},
        {"scene-dir", required_argument, NULL, OPTION_SCENE_DIR},
        {"methods", required_argument, NULL, OPTION_METHODS},
        {"pairs", required_argument, NULL, OPTION_PAIRS},
        {"distance", required_argument, NULL, OPTION_DISTANCE},
        {"ignore-rings", required_argument, NULL, OPTION_IGNORE_RINGS},
        {"proper", no_argument, NULL, OPTION_PROPER},
        {"partition", required_argument, NULL, OPTION_PARTITION},
        {"once", no_argument, NULL, OPTION_ONCE},
        {"repeats", required_argument, NULL, OPTION_REPEATS},
        {"threads", required_argument, NULL, OPTION_THREADS},
        {"workers", required_argument, NULL, OPTION_WORKERS},
        {"near", no_argument, NULL, OPTION_NEAR},
        {"one-shot", no_argument, NULL, OPTION_ONE_SHOT},
        {"json", no_argument, NULL, OPTION_JSON},
        {"csv", no_argument, NULL, OPTION_CSV},
        {"list", no_argument, NULL, OPTION_LIST},
        {"export", required_argument, NULL, OPTION_EXPORT},
        {"export-obj", required_argument, NULL, OPTION_EXPORT_OBJ},
        {"frame", required_argument, NULL, OPTION_FRAME},
        {"cache", required_argument, NULL, OPTION_CACHE},
        {"version", no_argument, NULL, OPTION_VERSION},
        {"help", no_argument, NULL, OPTION_HELP},
        {NULL, 0, NULL, 0}};

    static char name[] = "sc-bench";
    argv[0] = name; /* in messages of getopt_long, too */
    tool_set_name(name);
    bench_settings set;
    memset(&set, 0, sizeof set);
    set.cache = "build/scenes";
    set.measure.mode = MEASURE_WARM;
    set.measure.edges = 1.0;
    set.measure.threads = set.measure.workers = 1;
    bool valid = true;
    int option;
    while ((option = getopt_long(argc, argv, "hV", options, NULL)) != -1) {
        switch (option) {
        case OPTION_SCENE:
            set.scene = optarg;
            break;
        case OPTION_TRIANGLES:
            valid &= tool_parse_number("--triangles", optarg, 1, 100000000, &set.triangles);
            break;
        case OPTION_FRAMES:
            valid &= tool_parse_number("--frames", optarg, 1, 1000000, &set.frames);
            break;
        case OPTION_SCENE_DIR:
            set.scene_dir = optarg;
            break;
        case OPTION_METHODS:
            set.methods = optarg;
            break;
        case OPTION_PAIRS:
            valid &= tool_choose("--pairs", optarg, pairs_choices, &set.measure.question.pairs);
            break;
        case OPTION_DISTANCE:
            set.distance = true;
            valid &= parse_distance(optarg, &set.measure.edges);
            break;
        case OPTION_IGNORE_RINGS:
            valid &= tool_parse_number("--ignore-rings", optarg, 1, 1000,
                                       &set.measure.question.ignore_rings);
            break;
        case OPTION_PROPER:
            set.measure.question.contact = SC_CONTACT_PROPER;
            break;
        case OPTION_PARTITION:
            valid &= tool_choose("--partition", optarg, partition_choices, &set.measure.partition);
            break;
        case OPTION_ONCE:
            set.measure.mode = MEASURE_ONCE;
            break;
        case OPTION_REPEATS:
            valid &= tool_parse_number("--repeats", optarg, 1, 1000, &set.measure.repeats);
            break;
        case OPTION_THREADS:
            valid &= tool_parse_number("--threads", optarg, 1, 1024, &set.measure.threads);
            break;
        case OPTION_WORKERS:
            valid &=
                tool_parse_number("--workers", optarg, 1, SC_WORKERS_MAX, &set.measure.workers);
            break;
        case OPTION_NEAR:
            set.measure.count_near = true;
            break;
        case OPTION_ONE_SHOT:
            set.one_shot = true;
            break;
        case OPTION_JSON:
            set.format = REPORT_JSON;
            break;
        case OPTION_CSV:
            set.format = REPORT_CSV;
            break;
        case OPTION_LIST:
            set.list = true;
            break;
        case OPTION_EXPORT:
            set.export_dir = optarg;
            break;
        case OPTION_EXPORT_OBJ:
            set.export_obj = optarg;
            break;
        case OPTION_FRAME:
            set.one_frame = true;
            valid &= tool_parse_number("--frame", optarg, 0, 999999, &set.frame);
            break;
        case OPTION_CACHE:
            set.cache = optarg;
            break;
        case OPTION_VERSION:
            printf("sc-bench (starcontour) %s\n", sc_version_string());
            return tool_finish(TOOL_CLEAN);
        case OPTION_HELP:
            fputs(usage, stdout);
            return tool_finish(TOOL_CLEAN);
        default:
            tool_error("see sc-bench --help");
            valid = false;
            break;
        }
    }
    if (set.measure.repeats == 0) set.measure.repeats = set.measure.mode == MEASURE_ONCE ? 1 : 5;
    if (set.measure.threads > 1 && set.measure.workers > 1) {
        tool_error("--threads and --workers: one of them at a time");
        valid = false;
    }
    if (valid && !query_threads_start(set.measure.workers)) {
        tool_error("--workers: they cannot be started");
        valid = false;
    }
    const int status = valid ? run(&set, argv + optind, argc - optind) : TOOL_FAILED;
    query_threads_stop();
    return tool_finish(status);
}
