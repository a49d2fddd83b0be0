/*
 * sc-partition: shows the patch hierarchy that the library makes of a mesh.
 *
 * SPDX-License-Identifier: MIT
 *
 * The shape of patches is computed here, from sc_model_get_patches and the mesh; what passes the
 * culling tests is what the library found in the rest pose. Cost: a pass over the edges a level.
 */
#include "mesh_edges.h"
#include "mesh_file.h"
#include "model_file.h"
#include "ply_write.h"
#include "shape.h"
#include "tool.h"
#include "tool_json.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <getopt.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char usage[] =
    "Usage: sc-partition [options] MESH\n"
    "       sc-partition [options] --grid N\n"
    "       sc-partition [options] --scaling\n"
    "Shows the hierarchy of patches that culling works on.\n"
    "\n"
    "A line for each level, 0 being the whole mesh:\n"
    "  patches, and how many of them are connected through edges\n"
    "  length of a patch's contour over the square root of its area, mean and worst; patches "
    "without\n"
    "    area are left out. A disc has 3.54, a square 4, a closed mesh 0; a part of a mesh alone "
    "can\n"
    "    have any value\n"
    "  test-tree nodes of a patch against itself (self) and of two adjacent patches (pair): how "
    "many\n"
    "    pass the orientation test and the contour test in the rest pose, in percent\n"
    "  contour segments\n"
    "\n"
    "  --partition fast|metis  where the patches come from\n"
    "  -o, --output FILE       write the model, for sc-query and sc_model_load: with it no mesh "
    "has to\n"
    "                          be built, nor METIS be there, where queries run\n"
    "  --ply FILE --level L    write the mesh with one colour for each patch of level L\n"
    "  --json                  one JSON object in place of the tables\n"
    "  --grid N                in place of a file: a flat cloth of N x N cells, 2 N^2 triangles\n"
    "  --scaling               cloths of 10 thousand, 100 thousand and 1 million triangles: build\n"
    "                          time and size, which should grow linearly. With --json an object a "
    "line\n"
    "  --format obj|off|ply|stl  the format of a MESH whose name tells none, or of -, standard "
    "input\n"
    "  -V, --version, -h, --help\n"
    "\n"
    "Exit status: 0, or 2 if something could not be done; the reason is on standard error.\n";

typedef struct partition_settings {
    uint32_t partition;
    uint32_t grid;  /* 0: read a file */
    uint32_t level; /* for the picture */
    bool has_level, json, scaling;
    const char *ply_path, *output_path;
} partition_settings;

/* The shape of a level's patches. */
typedef struct level_shape {
    double mean, worst; /* contour length over the square root of area */
    uint32_t flat;      /* patches without area, which are left out */
} level_shape;

/* A mesh with its model and what shapes are computed from. */
typedef struct partition_view {
    const mesh_file *mesh;
    sc_model *model;
    sc_model_info info;
    double build_ms;
    mesh_side *sides;
    uint32_t *patches; /* of each triangle, at the level looked at */
    double *lengths;   /* of each patch's contour; triangle_count entries */
    double *areas;     /* the same */
} partition_view;

static double side_length(const mesh_file *mesh, const mesh_side *side)
{
    double a[3], b[3], sum = 0.0;
    mesh_file_position(mesh->positions, mesh->position_type, side->low, a);
    mesh_file_position(mesh->positions, mesh->position_type, side->high, b);
    for (int k = 0; k < 3; k++) sum += (b[k] - a[k]) * (b[k] - a[k]);
    return sqrt(sum);
}

static double triangle_area(const mesh_file *mesh, uint32_t triangle)
{
    const uint32_t *v = mesh->indices + 3 * (size_t)triangle;
    double p[3][3], u[3], w[3], sum = 0.0;
    for (int k = 0; k < 3; k++)
        mesh_file_position(mesh->positions, mesh->position_type, v[k], p[k]);
    for (int k = 0; k < 3; k++) {
        u[k] = p[1][k] - p[0][k];
        w[k] = p[2][k] - p[0][k];
    }
    for (int k = 0; k < 3; k++) {
        const double n = u[(k + 1) % 3] * w[(k + 2) % 3] - u[(k + 2) % 3] * w[(k + 1) % 3];
        sum += n * n;
    }
    return 0.5 * sqrt(sum);
}

/*
 * Adds one edge to the contours of the patches on it. Within a patch, sides that run in opposite
 * ways cancel; what is left is contour.
 */
static void add_edge(partition_view *view, const mesh_side *sides, size_t count)
{
    const double length = side_length(view->mesh, sides);
    for (size_t i = 0; i < count; i++) {
        const uint32_t patch = view->patches[sides[i].corner / 3];
        int balance = 0;
        bool first = true;
        for (size_t j = 0; j < count; j++) {
            if (view->patches[sides[j].corner / 3] != patch) continue;
            if (j < i) first = false;
            balance += mesh_edges_is_forward(view->mesh, &sides[j]) ? 1 : -1;
        }
        if (first) view->lengths[patch] += length * abs(balance);
    }
}

/* Measures the patches that view->patches holds. */
static level_shape measure_level(partition_view *view, uint32_t patch_count)
{
    const size_t side_count = 3 * (size_t)view->mesh->triangle_count;
    for (uint32_t p = 0; p < patch_count; p++) view->lengths[p] = view->areas[p] = 0.0;
    for (uint32_t t = 0; t < view->mesh->triangle_count; t++) {
        view->areas[view->patches[t]] += triangle_area(view->mesh, t);
    }
    for (size_t begin = 0; begin < side_count;) {
        const size_t run = mesh_edges_run(view->sides, begin, side_count);
        if (view->sides[begin].low != view->sides[begin].high) {
            add_edge(view, view->sides + begin, run);
        }
        begin += run;
    }
    level_shape shape = {0.0, 0.0, 0};
    for (uint32_t p = 0; p < patch_count; p++) {
        if (!(view->areas[p] > 0.0)) {
            shape.flat++;
            continue;
        }
        const double ratio = view->lengths[p] / sqrt(view->areas[p]);
        shape.mean += ratio;
        if (ratio > shape.worst) shape.worst = ratio;
    }
    if (patch_count > shape.flat) shape.mean /= patch_count - shape.flat;
    return shape;
}

/* Builds the model; says why if it cannot. */
static bool view_open(partition_view *view, const mesh_file *mesh, uint32_t partition,
                      uint32_t rest, const char *name)
{
    memset(view, 0, sizeof *view);
    view->mesh = mesh;
    view->info.struct_size = sizeof view->info;
    sc_status status = tool_build(mesh, SC_WELD_REST, partition, rest, SC_MODEL_FULL, NULL,
                                  &view->model, &view->build_ms);
    if (status == SC_OK) status = sc_model_get_info(view->model, &view->info);
    if (status != SC_OK) tool_error("%s: %s", name, tool_why(status));
    return status == SC_OK;
}

/* Gets ready to look at levels. */
static bool view_prepare(partition_view *view)
{
    const size_t count = view->mesh->triangle_count;
    view->sides = mesh_edges_sort(view->mesh);
    view->patches = (uint32_t *)malloc(count * sizeof *view->patches);
    view->lengths = (double *)malloc(count * sizeof *view->lengths);
    view->areas = (double *)malloc(count * sizeof *view->areas);
    if (view->sides && view->patches && view->lengths && view->areas) return true;
    tool_error("out of memory");
    return false;
}

static void view_close(partition_view *view)
{
    sc_model_free(view->model);
    free(view->sides);
    free(view->patches);
    free(view->lengths);
    free(view->areas);
    memset(view, 0, sizeof *view);
}

static double rounded(double value)
{
    return floor(value * 1e4 + 0.5) / 1e4;
}

static cJSON *json_totals(const partition_view *view, const char *name,
                          const partition_settings *set)
{
    const sc_model_info *info = &view->info;
    const double triangles = info->triangle_count;
    cJSON *object = tool_json_object("partition");
    cJSON_AddStringToObject(object, "file", name);
    cJSON_AddStringToObject(object, "partition", tool_choice_name(tool_partitions, set->partition));
    cJSON_AddStringToObject(object, "coordinates",
                            tool_coordinates(view->mesh->rounded, view->mesh->position_type));
    if (view->mesh->has_animation) cJSON_AddStringToObject(object, "animation", "not played");
    cJSON_AddNumberToObject(object, "vertices", info->point_count);
    cJSON_AddNumberToObject(object, "triangles", triangles);
    cJSON_AddNumberToObject(object, "edges", info->edge_count);
    cJSON_AddNumberToObject(object, "boundary_edges", info->boundary_edges);
    cJSON_AddNumberToObject(object, "irregular_edges", info->irregular_edges);
    cJSON_AddNumberToObject(object, "components", info->component_count);
    cJSON_AddNumberToObject(object, "leaves", info->leaf_count);
    cJSON_AddNumberToObject(object, "levels", info->level_count);
    cJSON_AddNumberToObject(object, "nodes", info->node_count);
    cJSON_AddNumberToObject(object, "segments", info->segment_count);
    cJSON_AddNumberToObject(object, "model_bytes", (double)info->model_bytes);
    cJSON_AddNumberToObject(object, "workspace_bytes", (double)info->workspace_bytes);
    cJSON_AddNumberToObject(object, "model_bytes_per_triangle",
                            rounded((double)info->model_bytes / triangles));
    cJSON_AddNumberToObject(object, "workspace_bytes_per_triangle",
                            rounded((double)info->workspace_bytes / triangles));
    cJSON_AddNumberToObject(object, "build_ms", rounded(view->build_ms));
    return object;
}

static void json_level(cJSON *array, uint32_t level, const sc_level_info *info,
                       const level_shape *shape)
{
    cJSON *object = cJSON_CreateObject();
    cJSON_AddNumberToObject(object, "level", level);
    cJSON_AddNumberToObject(object, "patches", info->patch_count);
    cJSON_AddNumberToObject(object, "connected_patches", info->connected_patches);
    cJSON_AddNumberToObject(object, "flat_patches", shape->flat);
    cJSON_AddNumberToObject(object, "contour_mean", rounded(shape->mean));
    cJSON_AddNumberToObject(object, "contour_worst", rounded(shape->worst));
    cJSON_AddNumberToObject(object, "segments", info->segment_count);
    cJSON_AddNumberToObject(object, "self_nodes", info->self_nodes);
    cJSON_AddNumberToObject(object, "self_oriented", info->self_oriented);
    cJSON_AddNumberToObject(object, "self_culled", info->self_culled);
    cJSON_AddNumberToObject(object, "pair_nodes", info->pair_nodes);
    cJSON_AddNumberToObject(object, "pair_oriented", info->pair_oriented);
    cJSON_AddNumberToObject(object, "pair_culled", info->pair_culled);
    cJSON_AddItemToArray(array, object);
}

/* A share in percent, or a dash where there is nothing to share. */
static void print_share(uint32_t part, uint32_t whole)
{
    if (whole)
        printf(" %6.1f", 100.0 * part / whole);
    else
        printf(" %6s", "-");
}

static void print_level(uint32_t level, const sc_level_info *info, const level_shape *shape)
{
    printf("%5lu %8lu %9lu  %7.2f %7.2f  %8lu", (unsigned long)level,
           (unsigned long)info->patch_count, (unsigned long)info->connected_patches, shape->mean,
           shape->worst, (unsigned long)info->self_nodes);
    print_share(info->self_oriented, info->self_nodes);
    print_share(info->self_culled, info->self_nodes);
    printf("  %8lu", (unsigned long)info->pair_nodes);
    print_share(info->pair_oriented, info->pair_nodes);
    print_share(info->pair_culled, info->pair_nodes);
    printf("  %9lu\n", (unsigned long)info->segment_count);
}

/* Measures and prints all levels. array is where JSON goes, or NULL for the table. */
static bool show_levels(partition_view *view, cJSON *array)
{
    if (!array) {
        printf("%5s %8s %9s  %15s  %22s  %22s  %9s\n", "", "", "", "contour/sqrt(A)",
               "self nodes, culled by", "pair nodes, culled by", "");
        printf("%5s %8s %9s  %7s %7s  %8s %6s %6s  %8s %6s %6s  %9s\n", "level", "patches",
               "connected", "mean", "worst", "count", "orient", "+cont.", "count", "orient",
               "+cont.", "segments");
    }
    for (uint32_t level = 0; level < view->info.level_count; level++) {
        sc_level_info info;
        memset(&info, 0, sizeof info);
        info.struct_size = sizeof info;
        sc_status status = sc_model_get_level(view->model, level, &info);
        if (status == SC_OK) {
            status =
                sc_model_get_patches(view->model, level, view->patches, view->mesh->triangle_count);
        }
        if (status != SC_OK) {
            tool_error("level %lu: %s", (unsigned long)level, sc_status_string(status));
            return false;
        }
        const level_shape shape = measure_level(view, info.patch_count);
        if (array)
            json_level(array, level, &info, &shape);
        else
            print_level(level, &info, &shape);
    }
    return true;
}

static void print_totals(const partition_view *view, const char *name)
{
    const sc_model_info *info = &view->info;
    const double triangles = info->triangle_count;
    printf(
        "%s: %lu vertices, %lu triangles, %lu components, %lu boundary and %lu irregular edges%s\n",
        name, (unsigned long)info->point_count, (unsigned long)info->triangle_count,
        (unsigned long)info->component_count, (unsigned long)info->boundary_edges,
        (unsigned long)info->irregular_edges,
        tool_reading_note(view->mesh->rounded, view->mesh->has_animation));
    printf("%lu leaves, %lu test-tree nodes, %lu contour segments\n",
           (unsigned long)info->leaf_count, (unsigned long)info->node_count,
           (unsigned long)info->segment_count);
    printf("bytes a triangle: model %.1f, workspace %.1f; built in %.1f ms\n\n",
           (double)info->model_bytes / triangles, (double)info->workspace_bytes / triangles,
           view->build_ms);
}

/*
 * A colour for a patch. Hues step by the golden ratio, so that any few consecutive numbers are far
 * apart; three brightnesses tell apart what comes near again.
 */
static void patch_color(uint32_t patch, uint8_t color[3])
{
    static const double brightness[3] = {1.0, 0.72, 0.5};
    const double hue = 6.0 * fmod(0.618033988749895 * patch, 1.0);
    for (int k = 0; k < 3; k++) {
        /* Distance round the circle of hues from where this colour is strongest, 0 to 3. */
        const double distance = fabs(fmod(hue - 2.0 * k + 9.0, 6.0) - 3.0);
        const double strength = distance < 1.0 ? 1.0 : distance > 2.0 ? 0.0 : 2.0 - distance;
        color[k] = (uint8_t)(255.0 * brightness[patch % 3] * (0.15 + 0.85 * strength));
    }
}

static bool write_picture(partition_view *view, const partition_settings *set)
{
    if (set->level >= view->info.level_count) {
        tool_error("--level: there are only levels 0 to %lu",
                   (unsigned long)(view->info.level_count - 1));
        return false;
    }
    const mesh_file *mesh = view->mesh;
    const sc_status status =
        sc_model_get_patches(view->model, set->level, view->patches, mesh->triangle_count);
    uint8_t *colors = (uint8_t *)malloc(3 * (size_t)mesh->triangle_count);
    if (status != SC_OK || !colors) {
        tool_error("%s: %s", set->ply_path,
                   sc_status_string(status != SC_OK ? status : SC_ERROR_MEMORY));
        free(colors);
        return false;
    }
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        patch_color(view->patches[t], colors + 3 * (size_t)t);
    }
    errno = 0;
    const bool written = ply_write(set->ply_path, mesh->positions, mesh->position_type,
                                   mesh->vertex_count, mesh->indices, mesh->triangle_count, colors);
    if (!written) tool_error("%s: cannot be written: %s", set->ply_path, strerror(errno));
    free(colors);
    return written;
}

static bool write_model(const partition_view *view, const char *path)
{
    char error[MESH_FILE_ERROR_SIZE];
    const bool written = model_file_write(path, view->model, view->mesh, error);
    if (!written) tool_error("%s", error);
    return written;
}

/* The whole job for one mesh. It is built and saved as it was read, so that poses fit; then its
   vertices are joined, so that its edges are those of the model. */
static bool show_mesh(mesh_file *mesh, const char *name, const partition_settings *set)
{
    partition_view view;
    bool done = view_open(&view, mesh, set->partition, SC_REST_MARKED, name);
    if (done && set->output_path) done = write_model(&view, set->output_path);
    if (done && !mesh_file_join(mesh)) {
        tool_error("%s: out of memory", name);
        done = false;
    }
    if (done) done = view_prepare(&view);
    if (done && set->json) {
        cJSON *object = json_totals(&view, name, set);
        done = show_levels(&view, cJSON_AddArrayToObject(object, "hierarchy"));
        if (done)
            done = tool_json_print(object);
        else
            cJSON_Delete(object);
    } else if (done) {
        print_totals(&view, name);
        done = show_levels(&view, NULL);
    }
    if (done && set->ply_path) done = write_picture(&view, set);
    view_close(&view);
    return done;
}

/* A line for each of three sizes. */
static bool show_scaling(const partition_settings *set)
{
    static const uint32_t cells[3] = {71, 224, 708};
    if (!set->json) {
        printf("%10s %9s %9s %10s %10s %14s %14s %12s\n", "triangles", "leaves", "nodes",
               "segments", "build ms", "ns a triangle", "model B/tri", "work B/tri");
    }
    bool done = true;
    for (int i = 0; i < 3 && done; i++) {
        mesh_file mesh;
        partition_view view;
        char name[64];
        snprintf(name, sizeof name, "grid %lu", (unsigned long)cells[i]);
        if (!shape_make_grid(&mesh, cells[i])) {
            tool_error("%s: out of memory", name);
            return false;
        }
        done = view_open(&view, &mesh, set->partition, SC_REST_UNMARKED, name);
        if (done && set->json) {
            done = tool_json_print(json_totals(&view, name, set));
        } else if (done) {
            const sc_model_info *info = &view.info;
            const double triangles = info->triangle_count;
            printf("%10lu %9lu %9lu %10lu %10.1f %14.0f %14.1f %12.1f\n",
                   (unsigned long)info->triangle_count, (unsigned long)info->leaf_count,
                   (unsigned long)info->node_count, (unsigned long)info->segment_count,
                   view.build_ms, 1e6 * view.build_ms / triangles,
                   (double)info->model_bytes / triangles,
                   (double)info->workspace_bytes / triangles);
        }
        fflush(stdout);
        view_close(&view);
        mesh_file_free(&mesh);
    }
    return done;
}

static bool run(const partition_settings *set, char **paths, int path_count)
{
    const char *reason = NULL;
    const int sources = path_count + (set->grid > 0) + set->scaling;
    if (sources == 0)
        reason = "no mesh given";
    else if (sources > 1)
        reason = "one MESH, --grid or --scaling at a time";
    else if (set->has_level != (set->ply_path != NULL))
        reason = "--ply and --level go together";
    else if ((set->ply_path || set->output_path) && set->scaling)
        reason = "--scaling writes no file";
    if (reason) {
        tool_error("%s; see sc-partition --help", reason);
        return false;
    }
    if (set->scaling) return show_scaling(set);
    if (path_count > 0 &&
        (!tool_spares(set->output_path, paths[0]) || !tool_spares(set->ply_path, paths[0])))
        return false;

    char error[MESH_FILE_ERROR_SIZE];
    char name[32];
    mesh_file mesh;
    bool done;
    if (set->grid) {
        snprintf(name, sizeof name, "grid %lu", (unsigned long)set->grid);
        done = shape_make_grid(&mesh, set->grid);
        if (!done) tool_error("%s: out of memory", name);
    } else {
        done = mesh_file_read(&mesh, paths[0], error);
        if (!done) tool_error("%s", error);
    }
    if (done) done = show_mesh(&mesh, set->grid ? name : paths[0], set);
    mesh_file_free(&mesh);
    return done;
}

int main(int argc, char **argv)
{
    enum {
        OPTION_PARTITION = 256,
        OPTION_PLY,
        OPTION_LEVEL,
        OPTION_OUTPUT = 'o',
        OPTION_JSON = OPTION_LEVEL + 1,
        OPTION_GRID,
        OPTION_SCALING,
        OPTION_FORMAT,
        OPTION_VERSION = 'V',
        OPTION_HELP = 'h'
    };
    static const struct option options[] = {
        {"partition", required_argument, NULL, OPTION_PARTITION},
        {"ply", required_argument, NULL, OPTION_PLY},
        {"level", required_argument, NULL, OPTION_LEVEL},
        {"output", required_argument, NULL, OPTION_OUTPUT},
        {"json", no_argument, NULL, OPTION_JSON},
        {"grid", required_argument, NULL, OPTION_GRID},
        {"scaling", no_argument, NULL, OPTION_SCALING},
        {"format", required_argument, NULL, OPTION_FORMAT},
        {"version", no_argument, NULL, OPTION_VERSION},
        {"help", no_argument, NULL, OPTION_HELP},
        {NULL, 0, NULL, 0}};

    static char name[] = "sc-partition";
    argv[0] = name; /* in messages of getopt_long, too */
    tool_set_name(name);
    partition_settings set;
    memset(&set, 0, sizeof set);
    bool valid = true;
    uint32_t format = MESH_FORMAT_UNKNOWN;
    int option;
    while ((option = getopt_long(argc, argv, "o:hV", options, NULL)) != -1) {
        switch (option) {
        case OPTION_PARTITION:
            valid &= tool_choose("--partition", optarg, tool_partitions, &set.partition);
            break;
        case OPTION_PLY:
            set.ply_path = optarg;
            break;
        case OPTION_LEVEL:
            valid &= tool_parse_number("--level", optarg, 0, 64, &set.level);
            set.has_level = true;
            break;
        case OPTION_OUTPUT:
            set.output_path = optarg;
            break;
        case OPTION_JSON:
            set.json = true;
            break;
        case OPTION_GRID:
            valid &= tool_parse_number("--grid", optarg, 1, 10000, &set.grid);
            break;
        case OPTION_SCALING:
            set.scaling = true;
            break;
        case OPTION_FORMAT:
            valid &= tool_choose("--format", optarg, tool_formats, &format);
            mesh_file_assume(format);
            break;
        case OPTION_VERSION:
            printf("sc-partition (starcontour) %s\n", sc_version_string());
            return tool_finish(TOOL_CLEAN);
        case OPTION_HELP:
            fputs(usage, stdout);
            return tool_finish(TOOL_CLEAN);
        default:
            tool_error("see sc-partition --help");
            valid = false;
            break;
        }
    }
    const bool done = valid && run(&set, argv + optind, argc - optind);
    return tool_finish(done ? TOOL_CLEAN : TOOL_FAILED);
}
