/*
 * What sc-query prints and writes of what is near; see near_report.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "near_report.h"

#include "ply_write.h"
#include "query_text.h"
#include "stencil_text.h"
#include "thickness_text.h"
#include "tool_json.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

const tool_choice near_kinds[] = {{"both", SC_NEAR_BOTH},
                                  {"vertex-face", SC_NEAR_VERTEX_FACE},
                                  {"edge-edge", SC_NEAR_EDGE_EDGE},
                                  {NULL, 0}};
const tool_choice near_methods[] = {{"auto", SC_NEAR_METHOD_DEFAULT},
                                    {"sctt", SC_NEAR_METHOD_SCTT},
                                    {"boxes", SC_NEAR_METHOD_BOXES},
                                    {NULL, 0}};

/* ------------------------------------------------------------------------------------------------
 * Closest points
 */

/* What is done with a pair and its closest points. */
typedef void near_visit(void *context, int kind, sc_pair pair, const sc_near_stencil *stencil);

/* Visits all pairs in the order of the lists. Closest points are found for some at a time: those of
   all together would be ten times as long as the lists. */
static sc_status visit_pairs(const near_answer *answer, near_visit *visit, void *context)
{
    enum { SOME = 1024 };
    static const uint32_t kinds[KINDS] = {SC_NEAR_VERTEX_FACE, SC_NEAR_EDGE_EDGE};
    sc_near_stencil *stencils = (sc_near_stencil *)malloc(SOME * sizeof *stencils);
    sc_status status = stencils ? SC_OK : SC_ERROR_MEMORY;
    for (int kind = 0; kind < KINDS; kind++) {
        const uint64_t count = answer->counts[kind];
        for (uint64_t first = 0; status == SC_OK && first < count; first += SOME) {
            const sc_pair *pairs = answer->pairs[kind] + first;
            const uint64_t some = count - first < SOME ? count - first : SOME;
            status =
                sc_near_stencils(answer->model, answer->pose, kinds[kind], pairs, some, stencils);
            for (uint64_t i = 0; status == SC_OK && i < some; i++)
                visit(context, kind, pairs[i], &stencils[i]);
        }
    }
    free(stencils);
    return status;
}

static void keep_nearest(void *context, int kind, sc_pair pair, const sc_near_stencil *stencil)
{
    double *nearest = (double *)context;
    (void)kind;
    (void)pair;
    if (stencil->distance < *nearest) *nearest = stencil->distance;
}

sc_status near_report_nearest(near_answer *answer)
{
    return visit_pairs(answer, keep_nearest, &answer->nearest);
}

/* ------------------------------------------------------------------------------------------------
 * The mesh in colours
 */

/* The smallest distance of each triangle and vertex, HUGE_VAL: none. */
typedef struct paint {
    double *of_triangles, *of_vertices;
    const uint32_t *weld_map; /* pairs may name another vertex of those at one place */
} paint;

static void lower(double *to, double distance)
{
    if (distance < *to) *to = distance;
}

static void lay_on(void *context, int kind, sc_pair pair, const sc_near_stencil *stencil)
{
    const paint *p = (const paint *)context;
    if (kind == VERTEX_FACE)
        lower(&p->of_vertices[p->weld_map ? p->weld_map[pair.a] : pair.a], stencil->distance);
    else
        lower(&p->of_triangles[pair.a / 3], stencil->distance);
    lower(&p->of_triangles[kind == VERTEX_FACE ? pair.b : pair.b / 3], stencil->distance);
}

/* Red where it touches, by way of orange to light yellow at the distance that was asked for. */
static void choose_color(double distance, double widest, uint8_t color[3])
{
    static const uint8_t touching[3] = {200, 0, 0}, widely[3] = {255, 255, 150};
    const double part = widest > 0 && distance < widest ? distance / widest : distance > 0;
    for (int i = 0; i < 3; i++)
        color[i] = (uint8_t)(touching[i] + part * (widely[i] - touching[i]) + 0.5);
}

bool near_report_ply(const near_answer *answer, const near_settings *set)
{
    const mesh_file *mesh = answer->mesh;
    const size_t triangles = mesh->triangle_count, vertices = mesh->vertex_count;
    uint8_t *colors = (uint8_t *)malloc(3 * triangles + 1);
    double *distances = (double *)malloc((triangles + vertices + 1) * sizeof *distances);
    const uint32_t *const weld_map = answer->weld_map;
    const paint p = {distances, distances + triangles, weld_map};
    sc_status status = colors && distances ? SC_OK : SC_ERROR_MEMORY;
    if (status == SC_OK) {
        for (size_t i = 0; i < triangles + vertices; i++) distances[i] = HUGE_VAL;
        if (!set->thickness) status = visit_pairs(answer, lay_on, (void *)(uintptr_t)&p);
    }
    bool written = status == SC_OK;
    if (written) {
        for (size_t c = 0; c < 3 * triangles; c++) {
            const uint32_t v = mesh->indices[c];
            lower(&p.of_triangles[c / 3], p.of_vertices[weld_map ? weld_map[v] : v]);
        }
        for (size_t t = 0; set->thickness && t < triangles; t++)
            p.of_triangles[t] = answer->thickness[mesh_face_of(mesh, (uint32_t)t)];
        memset(colors, 200, 3 * triangles);
        for (size_t t = 0; t < triangles; t++) {
            if (p.of_triangles[t] < HUGE_VAL)
                choose_color(p.of_triangles[t], set->distance, colors + 3 * t);
        }
        errno = 0;
        written = ply_write(set->ply_path, answer->pose->positions, answer->pose->position_type,
                            mesh->vertex_count, mesh->indices, mesh->triangle_count, colors);
        if (!written) tool_error("%s: cannot be written: %s", set->ply_path, strerror(errno));
    } else {
        tool_error("%s: %s", set->ply_path, sc_status_string(status));
    }
    free(colors);
    free(distances);
    return written;
}

/* ------------------------------------------------------------------------------------------------
 * The table
 */

void near_report_head(const near_settings *set)
{
    if (set->json) return;
    printf("%10s %10s %14s %14s %12s %9s %9s  %s\n", "vertices", "triangles",
           set->any ? "near" : "vertex-face", set->any ? "" : "edge-edge", "nearest", "build ms",
           "query ms", "file");
}

/* A number of pairs: with a + if there may be more, a - if they were not sought. */
static void print_count(const near_answer *answer, const near_settings *set, int kind)
{
    if (set->kinds == SC_NEAR_BOTH ||
        set->kinds == (kind == VERTEX_FACE ? SC_NEAR_VERTEX_FACE : SC_NEAR_EDGE_EDGE))
        printf("%13.0f%s ", (double)answer->counts[kind], answer->incomplete ? "+" : " ");
    else
        printf("%13s  ", "-");
}

static void print_pair(void *context, int kind, sc_pair pair, const sc_near_stencil *stencil)
{
    const near_settings *set = (const near_settings *)context;
    printf("    %s %lu %lu %.17g", feature_pairs_names[kind], (unsigned long)pair.a,
           (unsigned long)pair.b, stencil->distance);
    if (set->stencils) stencil_text_print(stencil);
    puts("");
}

static bool print_table_row(const near_answer *answer, const near_settings *set)
{
    printf("%10lu %10lu ", (unsigned long)answer->info.point_count,
           (unsigned long)answer->info.triangle_count);
    if (set->any) {
        printf("%14s %14s ", answer->near ? "yes" : answer->incomplete ? "unknown" : "no", "");
    } else {
        print_count(answer, set, VERTEX_FACE);
        print_count(answer, set, EDGE_EDGE);
    }
    if (answer->nearest < HUGE_VAL && !answer->incomplete)
        printf("%12.6g ", answer->nearest);
    else
        printf("%12s ", "-");
    printf("%9.2f %9.3f  %s%s\n", answer->build_ms, answer->query_ms, answer->path,
           tool_reading_note(answer->rounded, answer->has_animation));
    mesh_tally_print(&answer->tally, answer->mesh);
    if (set->stats) query_text_stats(&answer->stats);
    if (set->thickness) thickness_text_print(&answer->spread);
    if (!set->list && !set->stencils) return true;
    return visit_pairs(answer, print_pair, (void *)(uintptr_t)set) == SC_OK;
}

/* ------------------------------------------------------------------------------------------------
 * Pairs to a file
 */

void near_report_pairs_head(FILE *out, const near_settings *set)
{
    fputs("file,kind,object_a,face_a,object_b,face_b,a,b,distance", out);
    if (set->stencils)
        fputs(",feature,parallel,vertex_0,vertex_1,vertex_2,vertex_3,weight_0,weight_1,weight_2,"
              "weight_3,x,y,z",
              out);
    fputc('\n', out);
}

typedef struct pair_writer {
    FILE *out;
    const near_answer *answer;
    const near_settings *set;
} pair_writer;

static void write_pair(void *context, int kind, sc_pair pair, const sc_near_stencil *stencil)
{
    const pair_writer *w = (const pair_writer *)context;
    query_text_field(w->out, w->answer->path);
    fprintf(w->out, ",%s", feature_pairs_names[kind]);
    feature_pairs_write_owners(w->out, w->answer->mesh, w->answer->vertex_objects, kind, pair);
    fprintf(w->out, ",%lu,%lu,%.17g", (unsigned long)pair.a, (unsigned long)pair.b,
            stencil->distance);
    if (w->set->stencils) {
        fprintf(w->out, ",%s,%d", stencil_text_feature(stencil->feature),
                (stencil->flags & SC_STENCIL_PARALLEL) != 0);
        for (int i = 0; i < 4; i++) fprintf(w->out, ",%lu", (unsigned long)stencil->vertices[i]);
        for (int i = 0; i < 4; i++) fprintf(w->out, ",%.17g", stencil->weights[i]);
        for (int i = 0; i < 3; i++) fprintf(w->out, ",%.17g", stencil->vector[i] + 0.0);
    }
    fputc('\n', w->out);
}

/* ------------------------------------------------------------------------------------------------
 * JSON
 */

typedef struct pair_adder {
    cJSON *pairs;
    const near_answer *answer;
    const near_settings *set;
} pair_adder;

static void add_pair(void *context, int kind, sc_pair pair, const sc_near_stencil *stencil)
{
    const pair_adder *adder = (const pair_adder *)context;
    cJSON *object = cJSON_CreateObject();
    cJSON_AddStringToObject(object, "kind", feature_pairs_names[kind]);
    cJSON_AddNumberToObject(object, "a", pair.a);
    cJSON_AddNumberToObject(object, "b", pair.b);
    cJSON_AddNumberToObject(object, "distance", stencil->distance);
    feature_pairs_add_owners(object, adder->answer->mesh, adder->answer->vertex_objects, kind,
                             pair);
    if (adder->set->stencils) stencil_text_add(object, stencil);
    cJSON_AddItemToArray(adder->pairs, object);
}

static void add_count(cJSON *object, const char *name, uint64_t count, bool known)
{
    if (known)
        cJSON_AddNumberToObject(object, name, (double)count);
    else
        cJSON_AddNullToObject(object, name);
}

void near_report_add_settings(cJSON *object, const near_settings *set)
{
    cJSON_AddNumberToObject(object, "distance", set->distance);
    cJSON_AddStringToObject(object, "kinds", tool_choice_name(near_kinds, set->kinds));
    cJSON_AddBoolToObject(object, "any", set->any);
    if (set->model_path || set->replayed) { /* they are the model's */
        cJSON_AddNullToObject(object, "weld");
        cJSON_AddNullToObject(object, "partition");
    } else {
        cJSON_AddStringToObject(object, "weld", tool_choice_name(tool_welds, set->weld));
        cJSON_AddStringToObject(object, "partition",
                                tool_choice_name(tool_partitions, set->partition));
    }
    cJSON_AddStringToObject(object, "method", tool_choice_name(near_methods, set->method));
    if (set->rest_path) cJSON_AddStringToObject(object, "rest", set->rest_path);
    if (set->model_path) cJSON_AddStringToObject(object, "model", set->model_path);
    if (set->ignore_rings) cJSON_AddNumberToObject(object, "ignore_rings", set->ignore_rings);
    if (set->ignore_path) cJSON_AddStringToObject(object, "ignore", set->ignore_path);
    if (set->ignores_rest) cJSON_AddNumberToObject(object, "ignore_rest", set->ignore_rest);
    if (set->groups_path) cJSON_AddStringToObject(object, "groups", set->groups_path);
    if (set->budget) cJSON_AddNumberToObject(object, "budget", (double)set->budget);
}

static bool print_json_answer(const near_answer *answer, const near_settings *set)
{
    cJSON *object = tool_json_object("near");
    cJSON_AddStringToObject(object, "file", answer->path);
    cJSON_AddStringToObject(object, "status",
                            answer->incomplete ? "incomplete"
                            : answer->near     ? "near"
                                               : "clean");
    cJSON_AddBoolToObject(object, "near", answer->near);
    cJSON_AddStringToObject(object, "coordinates",
                            tool_coordinates(answer->rounded, answer->position_type));
    if (answer->has_animation) cJSON_AddStringToObject(object, "animation", "not played");
    cJSON_AddNumberToObject(object, "vertices", answer->info.point_count);
    cJSON_AddNumberToObject(object, "vertices_read", answer->info.vertex_count);
    cJSON_AddNumberToObject(object, "triangles", answer->info.triangle_count);
    cJSON_AddNumberToObject(object, "faces", answer->mesh->face_count);
    cJSON_AddNumberToObject(object, "objects", answer->mesh->object_count);
    if (near_names_objects(set, answer->mesh))
        query_text_add_tally(object, &answer->tally, answer->mesh);
    add_count(object, "vertex_face_pairs", answer->counts[VERTEX_FACE],
              !set->any && set->kinds != SC_NEAR_EDGE_EDGE);
    add_count(object, "edge_edge_pairs", answer->counts[EDGE_EDGE],
              !set->any && set->kinds != SC_NEAR_VERTEX_FACE);
    if (answer->nearest < HUGE_VAL && !answer->incomplete)
        cJSON_AddNumberToObject(object, "nearest", answer->nearest);
    else
        cJSON_AddNullToObject(object, "nearest");
    if (set->timings) {
        cJSON_AddNumberToObject(object, "build_ms", query_text_rounded(answer->build_ms));
        cJSON_AddNumberToObject(object, "query_ms", query_text_rounded(answer->query_ms));
    }
    near_report_add_settings(object, set);
    if (set->stats) query_text_add_stats(object, &answer->stats);
    if (set->thickness)
        thickness_text_add(object, &answer->spread, set->is_line ? NULL : answer->thickness,
                           answer->mesh->face_count);
    if (set->list || set->stencils) {
        pair_adder adder = {cJSON_AddArrayToObject(object, "pairs"), answer, set};
        if (visit_pairs(answer, add_pair, &adder) != SC_OK) {
            cJSON_Delete(object);
            return false;
        }
    }
    return tool_json_print(object);
}

/* ------------------------------------------------------------------------------------------------
 * A file
 */

int near_report_failure(const char *path, const near_settings *set, const char *error)
{
    tool_error("%s", error);
    if (set->json) tool_json_print(tool_json_refusal("near", path, error));
    fflush(stdout);
    return TOOL_FAILED;
}

int near_report(const near_answer *answer, const near_settings *set, FILE *out)
{
    bool written = set->json ? print_json_answer(answer, set) : print_table_row(answer, set);
    if (written && out) {
        pair_writer writer = {out, answer, set};
        written = visit_pairs(answer, write_pair, &writer) == SC_OK;
    }
    fflush(stdout);
    if (!written) {
        tool_error("%s: out of memory", answer->path);
        return TOOL_FAILED;
    }
    if (answer->incomplete) return TOOL_INCOMPLETE;
    return answer->near ? TOOL_COLLIDES : TOOL_CLEAN;
}
