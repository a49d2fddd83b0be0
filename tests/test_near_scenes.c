/*
 * What is near in real animations, beside a brute force in exact arithmetic: from folders of scenes
 * as sc-bench --scene-dir reads them, all that are in SCENE_DIRS of the environment, by default
 * ../shared/scenes. Skipped where there are none.
 *
 * Of some vertices and edges, half of them about one place and half anywhere, all partners are
 * sought: every face and edge of the mesh whose box is no farther than the distance along each axis
 * goes to the oracle. What the library says of the whole mesh must be the same for these.
 *
 * SPDX-License-Identifier: MIT
 */
#define _POSIX_C_SOURCE 200809L

#include <dirent.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "harness.h"
#include "near_oracle.h"
#include "starcontour.h"

/* Features looked at, of each kind, in a frame at a distance, at a scale of 100. */
enum { LOOKED_AT = 30, FRAMES = 3 };

static const double distances[] = {0.05, 0.2, 1.0}; /* in median edges */

typedef struct scene {
    char name[256];
    unsigned long triangle_count, vertex_count, frame_count;
    uint32_t *triangles;
    float *positions;     /* of all frames */
    const float *pose;    /* of one of them */
    uint32_t (*edges)[2]; /* each once, the lower vertex first, sorted */
    size_t edge_count;
    double edge; /* the median length, at first */
} scene;

static void scene_free(scene *s)
{
    free(s->triangles);
    free(s->positions);
    free(s->edges);
    memset(s, 0, sizeof *s);
}

/* So many bytes from a file of a folder, or NULL. */
static void *read_file(const char *folder, const char *name, size_t bytes)
{
    char path[4096];
    FILE *file;
    void *data = malloc(bytes + 1);
    snprintf(path, sizeof path, "%s/%s", folder, name);
    file = fopen(path, "rb");
    if (!data || !file || fread(data, 1, bytes, file) != bytes) {
        free(data);
        data = NULL;
    }
    if (file) fclose(file);
    return data;
}

static int compare_edges(const void *left, const void *right)
{
    const uint32_t *a = (const uint32_t *)left, *b = (const uint32_t *)right;
    if (a[0] != b[0]) return a[0] < b[0] ? -1 : 1;
    return a[1] < b[1] ? -1 : a[1] > b[1];
}

static int compare_doubles(const void *left, const void *right)
{
    const double a = *(const double *)left, b = *(const double *)right;
    return a < b ? -1 : a > b;
}

static void set_edge(uint32_t edge[2], uint32_t a, uint32_t b)
{
    edge[0] = a < b ? a : b;
    edge[1] = a < b ? b : a;
}

static int find_edges(scene *s)
{
    const size_t sides = 3 * (size_t)s->triangle_count;
    double *lengths = (double *)malloc(sides * sizeof *lengths);
    s->edges = (uint32_t(*)[2])malloc(sides * sizeof *s->edges);
    if (!lengths || !s->edges) {
        free(lengths);
        return 0;
    }
    for (size_t i = 0; i < sides; i++)
        set_edge(s->edges[i], s->triangles[i], s->triangles[i % 3 == 2 ? i - 2 : i + 1]);
    qsort(s->edges, sides, sizeof *s->edges, compare_edges);
    for (size_t i = 0; i < sides; i++) {
        double square = 0;
        if (s->edge_count > 0 && compare_edges(s->edges[i], s->edges[s->edge_count - 1]) == 0)
            continue;
        memmove(s->edges[s->edge_count], s->edges[i], sizeof *s->edges);
        for (size_t k = 0; k < 3; k++) {
            const double difference = (double)s->positions[3 * (size_t)s->edges[i][0] + k] -
                                      (double)s->positions[3 * (size_t)s->edges[i][1] + k];
            square += difference * difference;
        }
        lengths[s->edge_count++] = sqrt(square);
    }
    qsort(lengths, s->edge_count, sizeof *lengths, compare_doubles);
    s->edge = lengths[s->edge_count / 2];
    free(lengths);
    return 1;
}

/* Whether the folder holds a scene of floats. */
static int scene_open(scene *s, const char *folder, const char *name)
{
    char *meta = (char *)read_file(folder, "meta.txt", 5);
    char path[4096];
    FILE *file;
    int there = 0;
    free(meta);
    memset(s, 0, sizeof *s);
    if (!meta) return 0;
    snprintf(s->name, sizeof s->name, "%s", name);
    snprintf(path, sizeof path, "%s/meta.txt", folder);
    file = fopen(path, "r");
    if (file) {
        there = fscanf(file, "%lu %lu %lu", &s->triangle_count, &s->vertex_count,
                       &s->frame_count) == 3 &&
                s->triangle_count > 0 && s->vertex_count > 0 && s->frame_count > 0 &&
                s->triangle_count < 1000000 && s->vertex_count < 1000000;
        fclose(file);
    }
    if (there) {
        s->triangles = (uint32_t *)read_file(folder, "tris.u32", 12 * s->triangle_count);
        s->positions =
            (float *)read_file(folder, "frames.f32", 12 * s->vertex_count * s->frame_count);
    }
    if (s->triangles && s->positions && find_edges(s)) return 1;
    scene_free(s);
    return 0;
}

static const float *place(const scene *s, uint32_t vertex)
{
    return s->pose + 3 * (size_t)vertex;
}

/* Whether boxes of vertices are no farther apart than d along any axis. Differences of floats are
   exact in double where it matters: what is rounded is far from d. */
static int boxes_are_near(const scene *s, const uint32_t *a, int a_count, const uint32_t *b,
                          int b_count, double d)
{
    for (int k = 0; k < 3; k++) {
        float low[2] = {HUGE_VALF, HUGE_VALF}, high[2] = {-HUGE_VALF, -HUGE_VALF};
        for (int i = 0; i < a_count; i++) {
            low[0] = fminf(low[0], place(s, a[i])[k]);
            high[0] = fmaxf(high[0], place(s, a[i])[k]);
        }
        for (int i = 0; i < b_count; i++) {
            low[1] = fminf(low[1], place(s, b[i])[k]);
            high[1] = fmaxf(high[1], place(s, b[i])[k]);
        }
        if ((double)low[1] - (double)high[0] > d * 1.000001 ||
            (double)low[0] - (double)high[1] > d * 1.000001)
            return 0;
    }
    return 1;
}

static void corners_of(const scene *s, const uint32_t *a, int a_count, const uint32_t *b,
                       double p[4][3])
{
    for (int i = 0; i < 4; i++) {
        const float *from = place(s, i < a_count ? a[i] : b[i - a_count]);
        for (int k = 0; k < 3; k++) p[i][k] = (double)from[k];
    }
}

/* The library's answer, of which rows are found by what stands first. */
typedef struct answer {
    sc_pair *faces, *edges; /* a vertex and a face; two numbers of scene.edges, both ways round */
    size_t face_count, edge_count;
} answer;

static int compare_pairs(const void *left, const void *right)
{
    const sc_pair *a = (const sc_pair *)left, *b = (const sc_pair *)right;
    if (a->a != b->a) return a->a < b->a ? -1 : 1;
    return a->b < b->b ? -1 : a->b > b->b;
}

static uint32_t edge_of_corner(const scene *s, uint32_t corner)
{
    uint32_t edge[2];
    const uint32_t(*found)[2];
    set_edge(edge, s->triangles[corner], s->triangles[corner % 3 == 2 ? corner - 2 : corner + 1]);
    found = (const uint32_t(*)[2])bsearch(edge, s->edges, s->edge_count, sizeof *s->edges,
                                          compare_edges);
    return found ? (uint32_t)(found - (const uint32_t(*)[2])s->edges) : 0;
}

static int ask(const scene *s, const sc_model *model, sc_workspace *workspace, double d,
               answer *found)
{
    sc_pose pose;
    sc_near_options options;
    sc_near_result result;
    memset(found, 0, sizeof *found);
    memset(&pose, 0, sizeof pose);
    memset(&options, 0, sizeof options);
    memset(&result, 0, sizeof result);
    pose.struct_size = sizeof pose;
    pose.vertex_count = (uint32_t)s->vertex_count;
    pose.position_type = SC_FLOAT;
    pose.positions = s->pose;
    options.struct_size = sizeof options;
    options.distance = d;
    result.struct_size = sizeof result;
    const sc_status first = sc_query_near(model, workspace, &pose, &options, &result);
    if (!CHECK(first == SC_OK || first == SC_ERROR_SHORT_BUFFER)) return 0;
    result.vertex_face_capacity = result.vertex_face_count;
    result.edge_edge_capacity = result.edge_edge_count;
    found->faces = (sc_pair *)malloc((size_t)(result.vertex_face_count + 1) * sizeof(sc_pair));
    found->edges = (sc_pair *)malloc((size_t)(2 * result.edge_edge_count + 1) * sizeof(sc_pair));
    result.vertex_faces = found->faces;
    result.edge_edges = found->edges;
    if (!CHECK(found->faces && found->edges) ||
        !CHECK(sc_query_near(model, workspace, &pose, &options, &result) == SC_OK))
        return 0;
    found->face_count = (size_t)result.vertex_face_count;
    found->edge_count = 2 * (size_t)result.edge_edge_count;
    for (size_t i = 0; i < found->edge_count / 2; i++) {
        sc_pair *one = &found->edges[i], *other = &found->edges[found->edge_count / 2 + i];
        one->a = edge_of_corner(s, one->a);
        one->b = edge_of_corner(s, one->b);
        other->a = one->b;
        other->b = one->a;
    }
    qsort(found->edges, found->edge_count, sizeof(sc_pair), compare_pairs);
    return 1;
}

/* How many pairs begin with a. */
static size_t count_of(const sc_pair *pairs, size_t count, uint32_t a)
{
    size_t low = 0, high = count, end;
    while (low < high) {
        const size_t middle = low + (high - low) / 2;
        if (pairs[middle].a < a)
            low = middle + 1;
        else
            high = middle;
    }
    for (end = low; end < count && pairs[end].a == a; end++) continue;
    return end - low;
}

static int has(const sc_pair *pairs, size_t count, uint32_t a, uint32_t b)
{
    sc_pair pair;
    pair.a = a;
    pair.b = b;
    return bsearch(&pair, pairs, count, sizeof pair, compare_pairs) != NULL;
}

static int is_in(const uint32_t *vertices, int count, uint32_t vertex)
{
    for (int i = 0; i < count; i++)
        if (vertices[i] == vertex) return 1;
    return 0;
}

/* All faces that are near a vertex. Returns how many. */
static uint64_t check_vertex(const scene *s, const answer *found, uint32_t vertex, double d)
{
    uint64_t near = 0, lost = 0;
    for (uint32_t t = 0; t < s->triangle_count; t++) {
        const uint32_t *corners = s->triangles + 3 * (size_t)t;
        double p[4][3];
        if (is_in(corners, 3, vertex) || !boxes_are_near(s, &vertex, 1, corners, 3, d)) continue;
        corners_of(s, &vertex, 1, corners, p);
        if (!near_oracle_vertex_face((const double(*)[3])p, d)) continue;
        near++;
        lost += !has(found->faces, found->face_count, vertex, t);
    }
    CHECK_MSG(lost == 0 && near == count_of(found->faces, found->face_count, vertex),
              "%s: vertex %" PRIu32 " within %.17g: %" PRIu64 " faces, %" PRIu64 " of them lost",
              s->name, vertex, d, near, lost);
    return near;
}

/* The same for edges. */
static uint64_t check_edge(const scene *s, const answer *found, uint32_t edge, double d)
{
    const uint32_t *ends = s->edges[edge];
    uint64_t near = 0, lost = 0;
    for (uint32_t e = 0; e < s->edge_count; e++) {
        const uint32_t *others = s->edges[e];
        double p[4][3];
        if (is_in(others, 2, ends[0]) || is_in(others, 2, ends[1]) ||
            !boxes_are_near(s, ends, 2, others, 2, d))
            continue;
        corners_of(s, ends, 2, others, p);
        if (!near_oracle_edge_edge((const double(*)[3])p, d)) continue;
        near++;
        lost += !has(found->edges, found->edge_count, edge, e);
    }
    CHECK_MSG(lost == 0 && near == count_of(found->edges, found->edge_count, edge),
              "%s: edge %" PRIu32 " within %.17g: %" PRIu64 " edges, %" PRIu64 " of them lost",
              s->name, edge, d, near, lost);
    return near;
}

/* Returns the number of pairs that were found by brute force. */
static uint64_t check_pose(const scene *s, const answer *found, double d)
{
    const uint32_t count = test_iterations(LOOKED_AT);
    const uint32_t about = test_random_below((uint32_t)s->edge_count);
    uint64_t near = 0;
    for (uint32_t i = 0; i < count; i++) {
        /* edges are sorted by vertices, of which neighbours have numbers alike */
        const uint32_t edge = i % 2 ? test_random_below((uint32_t)s->edge_count)
                                    : (uint32_t)((about + i / 2) % s->edge_count);
        if (s->edges[edge][0] == s->edges[edge][1]) continue;
        near += check_vertex(s, found, s->edges[edge][i / 2 % 2], d);
        near += check_edge(s, found, edge, d);
    }
    return near;
}

static void check_scene(scene *s)
{
    sc_mesh mesh;
    sc_build_options build;
    sc_workspace_options options;
    sc_model *model = NULL;
    sc_workspace *workspace = NULL;
    uint64_t near = 0;
    memset(&mesh, 0, sizeof mesh);
    memset(&build, 0, sizeof build);
    memset(&options, 0, sizeof options);
    mesh.struct_size = sizeof mesh;
    mesh.vertex_count = (uint32_t)s->vertex_count;
    mesh.triangle_count = (uint32_t)s->triangle_count;
    mesh.position_type = SC_FLOAT;
    mesh.positions = s->positions;
    mesh.indices = s->triangles;
    build.struct_size = sizeof build;
    build.weld = SC_WELD_NONE;
    options.struct_size = sizeof options;
    options.flags = SC_WORKSPACE_NEAR;
    if (CHECK(sc_build(&mesh, &build, &model) == SC_OK) &&
        CHECK(sc_workspace_create_for(model, &options, &workspace) == SC_OK)) {
        for (unsigned long i = 0; i < FRAMES; i++) {
            const unsigned long frame = i * (s->frame_count - 1) / (FRAMES - 1);
            s->pose = s->positions + 3 * s->vertex_count * frame;
            for (size_t k = 0; k < sizeof distances / sizeof *distances; k++) {
                answer found;
                const double d = distances[k] * s->edge;
                if (ask(s, model, workspace, d, &found)) near += check_pose(s, &found, d);
                free(found.faces);
                free(found.edges);
            }
        }
        CHECK_MSG(near > 0, "%s: nothing is near what was looked at", s->name);
    }
    sc_workspace_free(workspace);
    sc_model_free(model);
}

/* Goes through the folders of a folder; returns how many scenes there are. */
static int check_folder(const char *path)
{
    DIR *folder = opendir(path);
    const struct dirent *entry;
    int count = 0;
    while (folder && (entry = readdir(folder)) != NULL) {
        char name[2048];
        scene s;
        if (entry->d_name[0] == '.') continue;
        snprintf(name, sizeof name, "%s/%s", path, entry->d_name);
        if (!scene_open(&s, name, entry->d_name)) continue;
        check_scene(&s);
        scene_free(&s);
        count++;
    }
    if (folder) closedir(folder);
    return count;
}

static void real_animations(void)
{
    const char *given = getenv("SCENE_DIRS");
    char *list, *path;
    int count = 0;
    if (!given || !*given) given = "../shared/scenes";
    list = (char *)malloc(strlen(given) + 1);
    if (!CHECK(list != NULL)) return;
    strcpy(list, given);
    for (path = strtok(list, " "); path; path = strtok(NULL, " ")) count += check_folder(path);
    free(list);
    if (count == 0) test_skip("no scenes in %s", given);
}

SC_TEST_MAIN(SC_TEST(real_animations))
