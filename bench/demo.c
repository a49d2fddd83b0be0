/*
 * sc-demo: the main job on two deforming meshes, frame by frame, methods side by side.
 *
 * SPDX-License-Identifier: MIT
 *
 * A cloth twists and rolls up until it passes through itself; the bunny of glmark2, or a closed
 * surface if it is not there, is bent until its ends do. Each frame is a new pose of one model. All
 * methods run on a frame in turn, several times, and the shortest time counts. All must find the
 * same number of pairs; the program fails if they do not. All frames of a scene end up in a page to
 * look at, with the places in which they collide.
 */
#define _POSIX_C_SOURCE 200809L

#include "mesh_check.h"
#include "mesh_file.h"
#include "page_write.h"
#include "place_depth.h"
#include "places.h"
#include "ply_write.h"
#include "shape.h"
#include "spatial_hash.h"
#include "tool.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

enum { FRAMES = 12, REPEATS = 3, HASH = 4, METHODS = 5, PATH_SIZE = 1024 };

static const char *const method_names[METHODS] = {"exact", "star", "aabb-sctt", "aabb", "hash"};
static const uint32_t method_values[HASH] = {SC_METHOD_SCTT, SC_METHOD_SCTT, SC_METHOD_AABB_SCTT,
                                             SC_METHOD_AABB};
static const uint32_t method_contours[HASH] = {SC_CONTOUR_EXACT, SC_CONTOUR_STAR};

/* Makes the pose of a moment from 0 (rest) to 1. */
typedef void (*deformation)(const mesh_file *rest, double time, float *positions);

/* What a scene needs from frame to frame. */
typedef struct demo_scene {
    const char *name;
    const mesh_file *mesh;
    sc_model *model;
    sc_workspace
        *workspaces[HASH]; /* of each method but the hash, for what it keeps between poses */
    spatial_hash *hash;
    double *doubles; /* the positions, for the hash */
    float *positions, *worst_positions;
    uint64_t worst_count;
    int worst_frame;
    double sums[METHODS]; /* of the shortest times, over all frames */
    uint32_t *weld_map;   /* for places on the page */
    mesh_check check;
    page_file *page;
    char page_path[PATH_SIZE];
} demo_scene;

/*
 * Cross sections turn, more towards the ends, and their two halves roll up towards each other: in
 * the section at x the point at distance y from the middle turns by an angle that grows with x and
 * y. The sheet has no self-collision until the halves meet, when the ends have rolled a quarter
 * turn each.
 */
static void twist_cloth(const mesh_file *rest, double time, float *positions)
{
    const float *from = (const float *)rest->positions;
    const double twist = 4.0 * time, roll = 4.5 * time;
    for (size_t v = 0; v < rest->vertex_count; v++) {
        const double x = (double)from[3 * v], y = (double)from[3 * v + 1];
        const double angle = twist * x + roll * x * y;
        positions[3 * v] = (float)(x * (1.0 - 0.25 * time));
        positions[3 * v + 1] = (float)(y * cos(angle));
        positions[3 * v + 2] = (float)(y * sin(angle));
    }
}

/* Bends the longest axis of the mesh's box to an arc, in the plane of that and the next axis. */
static void bend_solid(const mesh_file *rest, double time, float *positions)
{
    const float *from = (const float *)rest->positions;
    float low[3], high[3];
    for (size_t k = 0; k < 3; k++) low[k] = high[k] = from[k];
    for (size_t i = 3; i < 3 * (size_t)rest->vertex_count; i++) {
        const float x = from[i];
        if (x < low[i % 3]) low[i % 3] = x;
        if (x > high[i % 3]) high[i % 3] = x;
    }
    size_t along = 0;
    for (size_t k = 1; k < 3; k++) along = high[k] - low[k] > high[along] - low[along] ? k : along;
    const size_t across = (along + 1) % 3;
    const double middle = 0.5 * ((double)low[along] + (double)high[along]);
    const double length = (double)high[along] - (double)low[along];
    const double total = 9.0 * time; /* the angle between the ends */
    for (size_t v = 0; v < rest->vertex_count; v++) {
        const float *p = from + 3 * v;
        float *out = positions + 3 * v;
        memcpy(out, p, 3 * sizeof *out);
        if (total <= 0.0) continue;
        const double radius = length / total;
        const double height = (double)p[across] - (double)high[across]; /* 0 or less: outside */
        const double angle = ((double)p[along] - middle) / radius;
        out[along] = (float)(middle + (radius - height) * sin(angle));
        out[across] = (float)((double)high[across] + radius - (radius - height) * cos(angle));
    }
}

static bool report(sc_status status, const char *what)
{
    if (status != SC_OK) tool_error("%s: %s", what, tool_why(status));
    return status == SC_OK;
}

/* One timed query. method: an index of method_names. */
static bool run_method(demo_scene *scene, int method, uint64_t *count, double *milliseconds)
{
    if (method == HASH) {
        spatial_hash_answer answer;
        for (size_t i = 0; i < 3 * (size_t)scene->mesh->vertex_count; i++)
            scene->doubles[i] = (double)scene->positions[i];
        const double start = tool_clock();
        const bool done = spatial_hash_query(scene->hash, scene->doubles, SC_PAIRS_EDGE,
                                             SC_CONTACT_TOUCHING, &answer);
        *milliseconds = tool_clock() - start;
        *count = answer.count;
        if (!done) tool_error("spatial hash: out of memory");
        return done;
    }
    const double start = tool_clock();
    const sc_pose pose = tool_pose(scene->positions, SC_FLOAT, scene->mesh->vertex_count);
    sc_query_options options;
    memset(&options, 0, sizeof options);
    options.struct_size = sizeof options;
    options.output = SC_OUTPUT_COUNT;
    options.pairs = SC_PAIRS_EDGE;
    options.method = method_values[method];
    options.contour = method_contours[method];
    sc_result result;
    memset(&result, 0, sizeof result);
    result.struct_size = sizeof result;
    const sc_status status =
        sc_query(scene->model, scene->workspaces[method], &pose, &options, &result);
    *milliseconds = tool_clock() - start;
    *count = result.count;
    return report(status, method_names[method]);
}

/* Asks once more for the pairs of a frame, of triangles now. They are to be freed; NULL if there
   are none, or on failure. Returns the milliseconds of the query that listed them, or -1. */
static double list_pairs(demo_scene *scene, const sc_pose *pose, sc_result *result)
{
    memset(result, 0, sizeof *result);
    result->struct_size = sizeof *result;
    double start = tool_clock();
    sc_status status = sc_query(scene->model, scene->workspaces[0], pose, NULL, result);
    if (status == SC_ERROR_SHORT_BUFFER) {
        result->pairs = (sc_pair *)malloc((size_t)result->count * sizeof *result->pairs);
        result->capacity = result->pairs ? result->count : 0;
        start = tool_clock();
        status = result->pairs ? sc_query(scene->model, scene->workspaces[0], pose, NULL, result)
                               : SC_ERROR_MEMORY;
    }
    const double milliseconds = tool_clock() - start;
    if (report(status, "triangle pairs")) return milliseconds;
    free(result->pairs);
    result->pairs = NULL;
    return -1;
}

/* Adds a frame to the scene's page. name: what it is called there. */
static bool add_to_page(demo_scene *scene, const char *name)
{
    const sc_pose pose = tool_pose(scene->positions, SC_FLOAT, scene->mesh->vertex_count);
    sc_result result;
    const double milliseconds = list_pairs(scene, &pose, &result);
    if (milliseconds < 0) return false;
    place_list places;
    const place_source source = {scene->mesh,  scene->weld_map, &scene->check,
                                 scene->model, &pose,           SC_PAIRS_TRIANGLE,
                                 result.pairs, result.count,    NULL};
    sc_status status = places_make(&places, &source);
    if (status == SC_OK && !place_depths(&places, &source)) status = SC_ERROR_MEMORY;
    const uint32_t flat = mesh_check_degenerate(scene->mesh, scene->positions, SC_FLOAT, NULL);
    const page_frame frame = {name, scene->mesh,  &scene->check, &pose, &places,
                              flat, result.count, milliseconds,  false};
    if (status == SC_OK && !page_add(scene->page, &frame)) status = SC_ERROR_MEMORY;
    places_free(&places);
    free(result.pairs);
    return report(status, "page");
}

/* One frame: all methods in turn, several times. */
static bool run_frame(demo_scene *scene, int frame)
{
    uint64_t counts[METHODS];
    double shortest[METHODS];
    for (int repeat = 0; repeat < REPEATS; repeat++) {
        for (int method = 0; method < METHODS; method++) {
            double milliseconds;
            if (!run_method(scene, method, &counts[method], &milliseconds)) return false;
            if (repeat == 0 || milliseconds < shortest[method]) shortest[method] = milliseconds;
        }
    }
    printf("%5d %9.0f ", frame, (double)counts[0]);
    for (int method = 0; method < METHODS; method++) {
        printf(" %10.2f", shortest[method]);
        scene->sums[method] += shortest[method];
    }
    printf("\n");
    fflush(stdout);
    for (int method = 1; method < METHODS; method++) {
        if (counts[method] == counts[0]) continue;
        tool_error("%s finds %.0f pairs and %s %.0f: this is a bug, please report it",
                   method_names[0], (double)counts[0], method_names[method],
                   (double)counts[method]);
        return false;
    }
    char name[64];
    snprintf(name, sizeof name, "%s, frame %d", scene->name, frame);
    if (!add_to_page(scene, name)) return false;
    if (counts[0] >= scene->worst_count) {
        scene->worst_count = counts[0];
        scene->worst_frame = frame;
        memcpy(scene->worst_positions, scene->positions,
               3 * (size_t)scene->mesh->vertex_count * sizeof(float));
    }
    return true;
}

/* Draws the worst frame. */
static bool draw_worst(demo_scene *scene, const char *folder)
{
    const sc_pose pose = tool_pose(scene->worst_positions, SC_FLOAT, scene->mesh->vertex_count);
    const uint32_t triangles = scene->mesh->triangle_count;
    sc_result result;
    if (list_pairs(scene, &pose, &result) < 0) return false;
    uint8_t *colors = (uint8_t *)malloc(3 * (size_t)triangles);
    bool done = report(colors ? SC_OK : SC_ERROR_MEMORY, "worst frame");
    if (done) {
        static const uint8_t red[3] = {220, 30, 30};
        char path[1024];
        memset(colors, 200, 3 * (size_t)triangles);
        for (uint64_t i = 0; i < result.count; i++) {
            memcpy(colors + 3 * (size_t)result.pairs[i].a, red, 3);
            memcpy(colors + 3 * (size_t)result.pairs[i].b, red, 3);
        }
        snprintf(path, sizeof path, "%s/%s.ply", folder, scene->name);
        errno = 0;
        done = ply_write(path, scene->worst_positions, SC_FLOAT, scene->mesh->vertex_count,
                         scene->mesh->indices, triangles, colors);
        if (done)
            printf("Frame %d, colliding triangles in red: %s\n\n", scene->worst_frame, path);
        else
            tool_error("%s: cannot be written: %s", path, strerror(errno));
    }
    free(colors);
    free(result.pairs);
    return done;
}

static bool scene_open(demo_scene *scene, const mesh_file *mesh, const char *name, double *build_ms)
{
    memset(scene, 0, sizeof *scene);
    scene->name = name;
    scene->mesh = mesh;
    const size_t size = 3 * (size_t)mesh->vertex_count * sizeof(float);
    scene->positions = (float *)malloc(size);
    scene->worst_positions = (float *)malloc(size);
    scene->doubles = (double *)malloc(3 * (size_t)mesh->vertex_count * sizeof(double));
    for (size_t i = 0; scene->doubles && i < 3 * (size_t)mesh->vertex_count; i++)
        scene->doubles[i] = (double)((const float *)mesh->positions)[i];
    const char *reason = "out of memory";
    if (scene->doubles)
        scene->hash = spatial_hash_create(scene->doubles, mesh->vertex_count, mesh->indices,
                                          mesh->triangle_count, &reason);
    if (!scene->hash) {
        tool_error("spatial hash: %s", reason);
        return false;
    }
    sc_status status = tool_build(mesh, SC_WELD_REST, TOOL_PARTITION_FAST, SC_REST_MARKED,
                                  SC_MODEL_FULL, NULL, &scene->model, build_ms);
    for (int i = 0; i < HASH && status == SC_OK; i++) {
        status = sc_workspace_create(scene->model, NULL, &scene->workspaces[i]);
    }
    scene->weld_map = mesh_file_weld_map(mesh);
    if (!scene->positions || !scene->worst_positions || !scene->weld_map ||
        !mesh_check_make(&scene->check, mesh, scene->weld_map, NULL))
        status = SC_ERROR_MEMORY;
    return report(status, name);
}

static bool open_page(demo_scene *scene, const char *folder)
{
    snprintf(scene->page_path, sizeof scene->page_path, "%s/%s.html", folder, scene->name);
    errno = 0;
    scene->page = page_open(scene->page_path);
    if (!scene->page) tool_error("%s: cannot be written: %s", scene->page_path, strerror(errno));
    return scene->page != NULL;
}

/* Ends the page, if it was begun; false if not all could be written. */
static bool close_page(demo_scene *scene)
{
    const bool written = !scene->page || page_close(scene->page);
    scene->page = NULL;
    if (!written) tool_error("%s: could not be written to the end", scene->page_path);
    return written;
}

static void scene_close(demo_scene *scene)
{
    for (int i = 0; i < HASH; i++) sc_workspace_free(scene->workspaces[i]);
    sc_model_free(scene->model);
    spatial_hash_free(scene->hash);
    mesh_check_free(&scene->check);
    free(scene->weld_map);
    free(scene->doubles);
    free(scene->positions);
    free(scene->worst_positions);
}

/* All frames of a scene; page_path is where its page is then. */
static bool run_scene(const mesh_file *mesh, const char *name, deformation deform,
                      const char *folder, char page_path[PATH_SIZE])
{
    demo_scene scene;
    double build_ms;
    bool done = scene_open(&scene, mesh, name, &build_ms) && open_page(&scene, folder);
    if (done) {
        printf("%lu triangles; model built once in %.0f ms.\n\n",
               (unsigned long)mesh->triangle_count, build_ms);
        printf("%5s %9s  %54s\n", "", "", "------------ milliseconds for the frame -------------");
        printf("%5s %9s  %10s %10s %10s %10s %10s\n", "frame", "pairs", method_names[0],
               method_names[1], method_names[2], method_names[3], method_names[4]);
    }
    for (int frame = 0; frame < FRAMES && done; frame++) {
        deform(mesh, (double)frame / (FRAMES - 1), scene.positions);
        done = run_frame(&scene, frame);
    }
    if (done) {
        printf("\nAll frames:");
        for (int method = 0; method < METHODS; method++) {
            printf("  %s %.1f ms", method_names[method], scene.sums[method]);
        }
        printf("\nSpeed of exact: ");
        for (int method = 1; method < METHODS; method++) {
            printf("%s%.2f times that of %s", method > 1 ? ", " : "",
                   scene.sums[method] / scene.sums[0], method_names[method]);
        }
        printf(".\n");
        if (scene.worst_count > 0)
            done = draw_worst(&scene, folder);
        else
            printf("No frame collides.\n\n");
    }
    if (!close_page(&scene)) done = false;
    if (done) snprintf(page_path, PATH_SIZE, "%s", scene.page_path);
    scene_close(&scene);
    return done;
}

static bool run_cloth(const char *folder, char page_path[PATH_SIZE])
{
    mesh_file mesh;
    printf("A cloth twists and rolls up until it passes through itself.\n");
    if (!shape_make_grid(&mesh, 181)) {
        tool_error("cloth: out of memory");
        return false;
    }
    const bool done = run_scene(&mesh, "cloth", twist_cloth, folder, page_path);
    mesh_file_free(&mesh);
    return done;
}

/* The bunny, or, if its file is not there, a sphere drawn out to a loaf. */
static bool run_bunny(const char *meshes, const char *folder, char page_path[PATH_SIZE])
{
    char path[1024], error[MESH_FILE_ERROR_SIZE];
    struct stat found;
    mesh_file mesh;
    bool is_bunny = false, ready;
    snprintf(path, sizeof path, "%s/bunny.obj", meshes);
    if (stat(path, &found) == 0) {
        is_bunny = mesh_file_read(&mesh, path, error);
        if (!is_bunny) {
            tool_error("%s", error);
            return false;
        }
        printf("The bunny of glmark2 is bent until its ends meet.\n");
        mesh_file_floats(&mesh); /* frames are floats */
        ready = mesh_file_join(&mesh);
    } else {
        printf("%s is not there ('make meshes' gets it): a generated closed surface instead,\n"
               "bent until its ends meet.\n",
               path);
        ready = shape_make_sphere(&mesh, 6);
        for (size_t v = 0; ready && v < mesh.vertex_count; v++)
            ((float *)mesh.positions)[3 * v] *= 3.0f;
    }
    if (!ready)
        tool_error("out of memory");
    else
        ready = run_scene(&mesh, is_bunny ? "bunny" : "loaf", bend_solid, folder, page_path);
    mesh_file_free(&mesh);
    return ready;
}

/* Makes a folder and those above it. */
static bool make_folder(const char *path)
{
    char part[1024];
    if (snprintf(part, sizeof part, "%s", path) >= (int)sizeof part) return false;
    for (char *at = part + 1;; at++) {
        if (*at && *at != '/') continue;
        const char end = *at;
        *at = 0;
        if (mkdir(part, 0777) != 0 && errno != EEXIST) return false;
        if (!end) return true;
        *at = end;
    }
}

int main(int argc, char **argv)
{
    tool_set_name("sc-demo");
    const char *first = argc > 1 ? argv[1] : "";
    if (strcmp(first, "-V") == 0 || strcmp(first, "--version") == 0) {
        printf("sc-demo (starcontour) %s\n", sc_version_string());
        return tool_finish(TOOL_CLEAN);
    }
    if (argc > 3 || first[0] == '-') {
        const bool is_asked = strcmp(first, "-h") == 0 || strcmp(first, "--help") == 0;
        fputs("Usage: sc-demo [MESHES [OUTPUT]]\n"
              "MESHES: folder that may hold bunny.obj (build/meshes); OUTPUT: folder for pictures\n"
              "(build/demo)\n"
              "-V, --version, -h, --help: print the version, or this\n",
              is_asked ? stdout : stderr);
        return is_asked ? tool_finish(TOOL_CLEAN) : TOOL_FAILED;
    }
    const char *meshes = argc > 1 ? argv[1] : "build/meshes";
    const char *folder = argc > 2 ? argv[2] : "build/demo";
    if (!make_folder(folder)) {
        tool_error("%s: cannot be made: %s", folder, strerror(errno));
        return TOOL_FAILED;
    }
    printf(
        "starcontour %s: every self-collision of a deforming mesh, exactly\n\n"
        "Pairs are those of an edge and a triangle that touch and share no vertex. The methods:\n"
        "  exact      self-collision test tree with orientation and exact contour tests: the "
        "default\n"
        "  star       the same with the paper's star-contour tests\n"
        "  aabb-sctt  boxes only, started at the non-adjacent patches of that tree\n"
        "  aabb       a plain tree of boxes\n"
        "  hash       an optimised spatial hash\n"
        "All are exact and must agree. One thread; the shortest of %d runs.\n\n",
        sc_version_string(), REPEATS);
    char pages[2][PATH_SIZE];
    const bool done = run_cloth(folder, pages[0]) && run_bunny(meshes, folder, pages[1]);
    if (done)
        printf("Pages to look at in a browser, with all frames and where they collide:\n"
               "  %s\n  %s\n",
               pages[0], pages[1]);
    return tool_finish(done ? TOOL_CLEAN : TOOL_FAILED);
}
