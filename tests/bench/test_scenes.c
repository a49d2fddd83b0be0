/*
 * The scenes of bench/: folders read back as written, damaged ones are refused; every scene is
 * repeatable, has the counts that were asked for, one topology and finite coordinates; contacts
 * build up where they should; decimation keeps a surface a surface.
 *
 * SPDX-License-Identifier: MIT
 */
#define _XOPEN_SOURCE 700

#include "harness.h"
#include "mesh_edges.h"
#include "scene_folder.h"
#include "scenes/decimate.h"
#include "scenes/scene.h"
#include "scratch.h"
#include "shape.h"

#include "starcontour.h"

#include <ftw.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static char error[512];

/* ------------------------------------------------------------------------------------------------
 * Files.
 */

static void write_file(const char *path, const void *bytes, size_t size)
{
    FILE *file = fopen(path, "wb");
    if (!CHECK(file != NULL)) return;
    CHECK(fwrite(bytes, 1, size, file) == size);
    CHECK(fclose(file) == 0);
}

/* The bytes of a file as a new array. */
static char *read_bytes(const char *path, size_t *size)
{
    FILE *file = fopen(path, "rb");
    *size = 0;
    if (!file) return NULL;
    fseek(file, 0, SEEK_END);
    const size_t length = (size_t)ftell(file);
    rewind(file);
    char *bytes = (char *)test_allocate(length + 1);
    *size = fread(bytes, 1, length, file);
    fclose(file);
    return bytes;
}

static bool same_files(const char *first, const char *second)
{
    size_t first_size, second_size;
    char *a = read_bytes(first, &first_size), *b = read_bytes(second, &second_size);
    const bool same =
        a && b && first_size == second_size && memcmp(a, b, first_size) == 0 && first_size > 0;
    free(a);
    free(b);
    return same;
}

/* ------------------------------------------------------------------------------------------------
 * Folders.
 */

enum { TRIANGLES = 2, VERTICES = 4, FRAMES = 3, NUMBERS = 3 * VERTICES };

static const uint32_t two_triangles[6] = {0, 1, 2, 2, 1, 3};
static const uint32_t swapped[2] = {1, 0};

static double number_at(uint32_t frame, uint32_t i)
{
    return 0.1 * (double)frame - (double)i / 3.0;
}

static void write_example(const char *path, bool single)
{
    double positions[NUMBERS];
    scene_writer *writer = scene_writer_begin(path, TRIANGLES, VERTICES, two_triangles, swapped,
                                              single, error, sizeof error);
    if (!CHECK_MSG(writer != NULL, "%s", error)) return;
    for (uint32_t frame = 0; frame < FRAMES; frame++) {
        for (uint32_t i = 0; i < NUMBERS; i++) positions[i] = number_at(frame, i);
        CHECK(scene_writer_frame(writer, positions, error, sizeof error) == 0);
    }
    CHECK(scene_writer_end(writer, true, error, sizeof error) == 0);
}

/* The scene is the example, with doubles, or with floats. */
static void check_example(scene_folder *scene, bool single, bool with_order)
{
    double positions[NUMBERS];
    CHECK(scene->triangle_count == TRIANGLES && scene->vertex_count == VERTICES);
    CHECK(scene->frame_count == FRAMES && scene->single == single);
    CHECK(memcmp(scene->triangles, two_triangles, sizeof two_triangles) == 0);
    CHECK(with_order ? memcmp(scene->order, swapped, sizeof swapped) == 0 : scene->order == NULL);
    for (uint32_t k = FRAMES; k-- > 0;) {
        if (!CHECK_MSG(scene_folder_frame(scene, k, positions, error, sizeof error) == 0, "%s",
                       error))
            return;
        for (uint32_t i = 0; i < NUMBERS; i++) {
            const double exact = number_at(k, i);
            CHECK(positions[i] == (single ? (double)(float)exact : exact));
        }
    }
    CHECK(scene_folder_frame(scene, FRAMES, positions, error, sizeof error) == -1);
}

static void folders_read_back(void)
{
    scratch_begin();
    for (int single = 0; single < 2; single++) {
        scene_folder scene;
        write_example(scratch_at("one"), single != 0);
        if (!CHECK_MSG(scene_folder_open(scratch_at("one"), &scene, error, sizeof error) == 0, "%s",
                       error))
            continue;
        check_example(&scene, single != 0, true);
        CHECK(scene_folder_export(&scene, scratch_at("two"), single != 0, error, sizeof error) ==
              0);
        scene_folder_close(&scene);
        CHECK(scene.triangles == NULL && scene.source == NULL);
        CHECK(scene_folder_open(scratch_at("two"), &scene, error, sizeof error) == 0);
        check_example(&scene, single != 0, true);
        scene_folder_close(&scene);
    }
    scratch_end();
}

/* Opening the folder, or else reading its last frame, fails with a message that has these words. */
static void check_refused(const char *path, const char *words)
{
    scene_folder scene;
    double positions[NUMBERS];
    error[0] = '\0';
    const int opened = scene_folder_open(path, &scene, error, sizeof error);
    if (opened == 0) {
        CHECK_MSG(scene_folder_frame(&scene, FRAMES - 1, positions, error, sizeof error) == -1,
                  "not refused: %s", words);
        scene_folder_close(&scene);
    } else {
        CHECK(scene.triangles == NULL && scene.order == NULL && scene.source == NULL);
    }
    CHECK_MSG(strstr(error, words) != NULL, "'%s' is not in '%s'", words, error);
}

static void damaged_folders_are_refused(void)
{
    static const struct {
        const char *file, *bytes;
        size_t size;
        const char *words;
    } damages[] = {
        {"meta.txt", "", 0, "must begin with"},
        {"meta.txt", "2 4", 3, "must begin with"},
        {"meta.txt", "two four three", 14, "must begin with"},
        {"meta.txt", "-2 4 3", 6, "must begin with"},
        {"meta.txt", "0 4 3", 5, "0 or too large"},
        {"meta.txt", "99999999999999999999 4 3", 24, "0 or too large"},
        {"meta.txt", "2 4294967295 3", 14, "0 or too large"},
        {"meta.txt", "2 4 3 5", 7, "more than three"},
        {"meta.txt", "3 4 3\n", 6, "tris.u32: has 24 bytes"},
        {"meta.txt", "2 5 3\n", 6, "frames.f64: has 288 bytes"},
        {"meta.txt", "2 4 4\n", 6, "frames.f64: has 288 bytes"},
        {"meta.txt", "2 1000000000 1000000000", 23, "frames.f64: has 288 bytes"},
        {"tris.u32", "\0\0\0", 3, "tris.u32: has 3 bytes"},
        {"tris.u32", "\0\0\0\0\1\0\0\0\2\0\0\0\2\0\0\0\1\0\0\0\4\0\0\0", 24, "entry 5 is 4"},
        {"order.u32", "\0\0\0\0\2\0\0\0", 8, "entry 1 is 2"},
        {"order.u32", "\1\0\0\0\1\0\0\0", 8, "triangle 1 is there twice"},
        {"order.u32", "", 0, "order.u32: has 0 bytes"},
        {"frames.f64", "", 0, "frames.f64: has 0 bytes"},
    };
    char path[100];
    scratch_begin();
    for (size_t i = 0; i < sizeof damages / sizeof damages[0]; i++) {
        write_example(scratch_at("one"), false);
        snprintf(path, sizeof path, "one/%s", damages[i].file);
        write_file(scratch_at(path), damages[i].bytes, damages[i].size);
        check_refused(scratch_at("one"), damages[i].words);
    }
    check_refused(scratch_at("nowhere"), "meta.txt: No such file");
    static const char *const needed[] = {"meta.txt", "tris.u32", "frames.f64"};
    for (size_t i = 0; i < 3; i++) {
        write_example(scratch_at("one"), false);
        snprintf(path, sizeof path, "one/%s", needed[i]);
        CHECK(remove(scratch_at(path)) == 0);
        check_refused(scratch_at("one"), needed[i]);
    }
    write_example(scratch_at("one"), false);
    CHECK(remove(scratch_at("one/tris.u32")) == 0 && mkdir(scratch_at("one/tris.u32"), 0777) == 0);
    check_refused(scratch_at("one"), "tris.u32");
    scratch_end();
}

static void numbers_that_are_not_finite_are_refused(void)
{
    const double bad[3] = {(double)NAN, (double)INFINITY, -(double)INFINITY};
    double frames[FRAMES * NUMBERS];
    double positions[NUMBERS] = {0.0};
    scratch_begin();
    for (int k = 0; k < 3; k++) {
        for (int single = 0; single < 2; single++) {
            write_example(scratch_at("one"), single != 0);
            for (int i = 0; i < FRAMES * NUMBERS; i++) frames[i] = 1.0;
            frames[FRAMES * NUMBERS - 2] = bad[k];
            float floats[FRAMES * NUMBERS];
            for (int i = 0; i < FRAMES * NUMBERS; i++) floats[i] = (float)frames[i];
            if (single)
                write_file(scratch_at("one/frames.f32"), floats, sizeof floats);
            else
                write_file(scratch_at("one/frames.f64"), frames, sizeof frames);
            check_refused(scratch_at("one"), "frame 2: vertex 3 is not finite");
        }
        positions[4] = bad[k];
        scene_writer *writer = scene_writer_begin(scratch_at("two"), TRIANGLES, VERTICES,
                                                  two_triangles, NULL, false, error, sizeof error);
        CHECK(scene_writer_frame(writer, positions, error, sizeof error) == -1);
        CHECK(scene_writer_end(writer, false, error, sizeof error) == 0);
        check_refused(scratch_at("two"), "meta.txt");
    }
    positions[4] = 1e39;
    scene_writer *writer = scene_writer_begin(scratch_at("two"), TRIANGLES, VERTICES, two_triangles,
                                              NULL, true, error, sizeof error);
    CHECK(scene_writer_frame(writer, positions, error, sizeof error) == -1);
    CHECK(scene_writer_end(writer, false, error, sizeof error) == 0);
    scratch_end();
}

static void sequences_of_meshes_are_scenes(void)
{
    scene_folder scene;
    scratch_begin();
    write_example(scratch_at("one"), true);
    CHECK(scene_folder_open(scratch_at("one"), &scene, error, sizeof error) == 0);
    const uint32_t count = scene.frame_count;
    CHECK(scene_folder_export_obj(&scene, 0, count, scratch_at("obj"), error, sizeof error) == 0);
    CHECK(scene_folder_export_obj(&scene, 0, count, scratch_at("one/tris.u32"), error,
                                  sizeof error) == -1);
    scene_folder_close(&scene);
    if (CHECK_MSG(scene_folder_open_pattern(scratch_at("obj/frame_%04d.obj"), &scene, error,
                                            sizeof error) == 0,
                  "%s", error)) {
        check_example(&scene, true, false);
        scene_folder_close(&scene);
    }
    /* From 1, without leading zeros, with a percent sign; the third is not the same mesh. */
    for (int k = 0; k < 3; k++) {
        char from[40], to[40];
        snprintf(from, sizeof from, "obj/frame_%04d.obj", k);
        snprintf(to, sizeof to, "%%%d.obj", k + 1);
        CHECK(rename(scratch_at(from), scratch_at(to)) == 0);
    }
    write_file(scratch_at("%3.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3\n", 40);
    char pattern[100];
    snprintf(pattern, sizeof pattern, "%s/%%%%%%d.obj", scratch_at("."));
    if (CHECK_MSG(scene_folder_open_pattern(pattern, &scene, error, sizeof error) == 0, "%s",
                  error)) {
        double positions[NUMBERS];
        CHECK(scene.frame_count == 3);
        CHECK(scene_folder_frame(&scene, 1, positions, error, sizeof error) == 0);
        CHECK(positions[5] == (double)(float)number_at(1, 5));
        CHECK(scene_folder_frame(&scene, 2, positions, error, sizeof error) == -1);
        CHECK(strstr(error, "not a pose of the rest mesh") != NULL);
        scene_folder_close(&scene);
    }
    static const char *const bad[] = {"a.obj", "%s.obj", "%d%d.obj", "%4d.obj", "%", "%04", "%n%d"};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        CHECK_MSG(scene_folder_open_pattern(bad[i], &scene, error, sizeof error) == -1, "%s",
                  bad[i]);
        CHECK(strstr(error, "not a pattern") != NULL && scene.source == NULL);
    }
    CHECK(scene_folder_open_pattern(scratch_at("no%d.obj"), &scene, error, sizeof error) == -1);
    CHECK(strstr(error, "number 0 or 1") != NULL);
    CHECK(scene_folder_open_files(NULL, 0, &scene, error, sizeof error) == -1);
    scratch_end();
}

/* ------------------------------------------------------------------------------------------------
 * Scenes.
 */

/* glmark2's models may not have been fetched. */
static bool is_missing(const char *name)
{
    const bool missing = strstr(error, "make meshes") != NULL;
    if (missing) test_skip("%s: %s", name, error);
    return missing;
}

static void check_connectivity(const char *name, const scene_folder *scene)
{
    uint8_t *used = (uint8_t *)calloc(scene->vertex_count, 1);
    bool apart = true, all = true;
    for (size_t t = 0; t < scene->triangle_count; t++) {
        const uint32_t *v = scene->triangles + 3 * t;
        for (int k = 0; k < 3; k++) used[v[k]] = 1;
        apart = apart && v[0] != v[1] && v[1] != v[2] && v[2] != v[0];
    }
    for (uint32_t v = 0; v < scene->vertex_count; v++) all = all && used[v];
    CHECK_MSG(apart, "%s: a triangle has a corner twice", name);
    CHECK_MSG(all, "%s: a vertex is in no triangle", name);
    free(used);
}

/* Cloth has an order. */
static bool has_order(const char *name)
{
    return strstr(name, "cloth") || strstr(name, "rods");
}

static void scenes_are_sound_and_repeatable(void)
{
    size_t count;
    const scene_kind *kinds = scene_kinds(&count);
    scratch_begin();
    CHECK(count == 12);
    for (size_t k = 0; k < count; k++) {
        const char *name = kinds[k].name;
        scene_folder scene;
        error[0] = '\0';
        CHECK(kinds[k].frames >= 60 && kinds[k].about[0] && kinds[k].sizes[0] > 0);
        if (scene_make(name, 600, 5, scratch_at("one"), NULL, NULL, error, sizeof error) != 0) {
            CHECK_MSG(is_missing(name), "%s: %s", name, error);
            continue;
        }
        CHECK(scene_make(name, 600, 5, scratch_at("two"), NULL, NULL, error, sizeof error) == 0);
        CHECK_MSG(same_files(scratch_at("one/frames.f32"), scratch_at("two/frames.f32")),
                  "%s: differs", name);
        CHECK_MSG(same_files(scratch_at("one/tris.u32"), scratch_at("two/tris.u32")), "%s: differs",
                  name);
        if (!CHECK_MSG(scene_folder_open(scratch_at("one"), &scene, error, sizeof error) == 0,
                       "%s: %s", name, error))
            continue;
        CHECK_MSG(scene.triangle_count >= 300 && scene.triangle_count <= 1280, "%s: %lu triangles",
                  name, (unsigned long)scene.triangle_count);
        CHECK(scene.frame_count == 5 && scene.single);
        CHECK((scene.order != NULL) == has_order(name));
        check_connectivity(name, &scene);
        const size_t size = 3 * scene.vertex_count * sizeof(double);
        double *before = (double *)test_allocate(size), *now = (double *)test_allocate(size);
        memset(before, 0, size);
        for (uint32_t frame = 0; frame < 5; frame++) {
            CHECK_MSG(scene_folder_frame(&scene, frame, now, error, sizeof error) == 0, "%s: %s",
                      name, error);
            CHECK_MSG(memcmp(before, now, size) != 0, "%s: frame %lu is as the one before", name,
                      (unsigned long)frame);
            memcpy(before, now, size);
        }
        free(before);
        free(now);
        scene_folder_close(&scene);
    }
    scratch_end();
}

/* Fewer frames are the same motion in longer steps. */
static void animations_are_whole(void)
{
    static const char *const names[] = {"twisted-cloth", "cloth-sphere", "crushed-cloth", "horse"};
    scratch_begin();
    for (size_t k = 0; k < 4; k++) {
        scene_folder coarse, fine;
        double difference = 0.0;
        error[0] = '\0';
        if (scene_make(names[k], 300, 3, scratch_at("one"), NULL, NULL, error, sizeof error) != 0) {
            CHECK_MSG(is_missing(names[k]), "%s", error);
            continue;
        }
        CHECK(scene_make(names[k], 300, 5, scratch_at("two"), NULL, NULL, error, sizeof error) ==
              0);
        CHECK(scene_folder_open(scratch_at("one"), &coarse, error, sizeof error) == 0);
        CHECK(scene_folder_open(scratch_at("two"), &fine, error, sizeof error) == 0);
        const size_t size = 3 * coarse.vertex_count * sizeof(double);
        double *a = (double *)test_allocate(size), *b = (double *)test_allocate(size);
        for (uint32_t frame = 0; frame < 3; frame++) {
            CHECK(scene_folder_frame(&coarse, frame, a, error, sizeof error) == 0);
            CHECK(scene_folder_frame(&fine, 2 * frame, b, error, sizeof error) == 0);
            for (size_t i = 0; i < 3 * (size_t)coarse.vertex_count; i++) {
                difference = fmax(difference, fabs(a[i] - b[i]));
            }
        }
        CHECK_MSG(difference == 0.0, "%s: differs by %g", names[k], difference);
        free(a);
        free(b);
        scene_folder_close(&coarse);
        scene_folder_close(&fine);
    }
    scratch_end();
}

static void usual_sizes_are_met(void)
{
    size_t count;
    const scene_kind *kinds = scene_kinds(&count);
    scratch_begin();
    for (size_t k = 0; k < count; k++) {
        for (const uint32_t *size = kinds[k].sizes; *size > 0 && *size <= 20000; size++) {
            scene_folder scene;
            error[0] = '\0';
            if (scene_make(kinds[k].name, *size, 1, scratch_at("one"), NULL, NULL, error,
                           sizeof error)) {
                CHECK_MSG(is_missing(kinds[k].name), "%s", error);
                break;
            }
            CHECK(scene_folder_open(scratch_at("one"), &scene, error, sizeof error) == 0);
            CHECK_MSG(abs((int)scene.triangle_count - (int)*size) <= (int)(*size / 100),
                      "%s: %lu triangles in place of %lu", kinds[k].name,
                      (unsigned long)scene.triangle_count, (unsigned long)*size);
            CHECK(scene.frame_count == 1);
            scene_folder_close(&scene);
        }
    }
    scratch_end();
}

/* The number of pairs of triangles in a frame, or UINT64_MAX. */
static uint64_t count_pairs(scene_folder *scene, uint32_t frame)
{
    double *positions = (double *)test_allocate(3 * scene->vertex_count * sizeof(double));
    sc_mesh mesh = {0};
    sc_pose pose = {0};
    sc_build_options build = {0};
    sc_query_options options = {0};
    sc_result result = {0};
    sc_model *model = NULL;
    sc_workspace *workspace = NULL;
    mesh.struct_size = sizeof mesh;
    mesh.positions = positions;
    mesh.position_type = SC_DOUBLE;
    mesh.vertex_count = scene->vertex_count;
    mesh.indices = scene->triangles;
    mesh.triangle_count = scene->triangle_count;
    build.struct_size = sizeof build;
    build.partition = scene->order ? SC_PARTITION_ORDER : SC_PARTITION_FAST;
    build.order = scene->order;
    pose.struct_size = sizeof pose;
    pose.positions = positions;
    pose.position_type = SC_DOUBLE;
    pose.vertex_count = scene->vertex_count;
    options.struct_size = sizeof options;
    options.output = SC_OUTPUT_COUNT;
    result.struct_size = sizeof result;
    const bool counted = scene_folder_frame(scene, 0, positions, error, sizeof error) == 0 &&
                         sc_build(&mesh, &build, &model) == SC_OK &&
                         sc_workspace_create(model, NULL, &workspace) == SC_OK &&
                         scene_folder_frame(scene, frame, positions, error, sizeof error) == 0 &&
                         sc_query(model, workspace, &pose, &options, &result) == SC_OK;
    sc_workspace_free(workspace);
    sc_model_free(model);
    free(positions);
    return counted ? result.count : UINT64_MAX;
}

static void contacts_build_up(void)
{
    static const struct {
        const char *name;
        uint32_t triangles;
        uint64_t least; /* pairs in one of the frames; 0: none in all of them */
    } cases[] = {
        {"twisted-cloth", 4096, 300}, {"cloth-sphere", 5000, 300}, {"wrinkled-cloth", 5000, 500},
        {"crushed-cloth", 5000, 20},  {"tight-rods", 20480, 300},  {"squeezed-rods", 20480, 5000},
        {"sphere", 5120, 0},          {"bunny", 3400, 100},        {"horse", 1600, 100}};
    scratch_begin();
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        scene_folder scene;
        uint64_t most = 0;
        error[0] = '\0';
        if (scene_make(cases[k].name, cases[k].triangles, 7, scratch_at("one"), NULL, NULL, error,
                       sizeof error) != 0) {
            CHECK_MSG(is_missing(cases[k].name), "%s", error);
            continue;
        }
        CHECK(scene_folder_open(scratch_at("one"), &scene, error, sizeof error) == 0);
        const uint64_t first = count_pairs(&scene, 0);
        CHECK_MSG(first < 10, "%s: %lu pairs at rest", cases[k].name, (unsigned long)first);
        for (uint32_t frame = 1; frame < 7; frame++) {
            const uint64_t pairs = count_pairs(&scene, frame);
            if (pairs > most) most = pairs;
        }
        CHECK_MSG(most >= cases[k].least && (cases[k].least > 0 || most == 0) && most != UINT64_MAX,
                  "%s: %lu pairs", cases[k].name, (unsigned long)most);
        scene_folder_close(&scene);
    }
    scratch_end();
}

static void wrong_requests_are_refused(void)
{
    char folder[200];
    const char *kept = getenv("SC_MESHES");
    char *meshes = kept ? strcpy((char *)test_allocate(strlen(kept) + 1), kept) : NULL;
    scratch_begin();
    CHECK(scene_make("tiger", 100, 2, scratch_at("one"), NULL, NULL, error, sizeof error) == -1);
    CHECK(strstr(error, "no such scene") != NULL);
    CHECK(scene_make("sphere", 100, 0, scratch_at("one"), NULL, NULL, error, sizeof error) == -1);
    CHECK(strstr(error, "frame") != NULL);
    CHECK(scene_make("sphere", 0, 2, scratch_at("one"), NULL, NULL, error, sizeof error) == -1);
    CHECK(scene_make("sphere", UINT32_MAX, 2, scratch_at("one"), NULL, NULL, error, sizeof error) ==
          -1);
    CHECK(scene_make("sphere", 100, 2, scratch_at("no/where"), NULL, NULL, error, sizeof error) ==
          -1);
    CHECK(strstr(error, "cannot be made") != NULL);
    CHECK(scene_cached("tiger", 100, 2, scratch_at("cache"), NULL, NULL, folder, sizeof folder,
                       error, sizeof error) == -1);
    CHECK(scene_cached("sphere", 100, 2, scratch_at("cache"), NULL, NULL, folder, 10, error,
                       sizeof error) == -1);
    setenv("SC_MESHES", scratch_at("."), 1);
    static const char *const models[] = {"cat", "bunny", "bunny-bumpy", "bunny-spiky", "horse"};
    for (size_t k = 0; k < 5; k++) {
        CHECK(scene_make(models[k], 100, 2, scratch_at("one"), NULL, NULL, error, sizeof error) ==
              -1);
        CHECK_MSG(strstr(error, "make meshes") != NULL, "%s", error);
    }
    if (meshes)
        setenv("SC_MESHES", meshes, 1);
    else
        unsetenv("SC_MESHES");
    free(meshes);
    scratch_end();
}

static void count_frames(void *user, uint32_t frame, uint32_t frames)
{
    uint32_t *counted = (uint32_t *)user;
    CHECK(frame == *counted % frames + 1);
    (*counted)++;
}

/* Opens the cached scene; the number of frames that had to be made for it. */
static uint32_t open_cached(char *folder, size_t folder_size)
{
    uint32_t made = 0;
    scene_folder scene;
    CHECK_MSG(scene_cached("tight-rods", 2048, 4, scratch_at("a/cache"), count_frames, &made,
                           folder, folder_size, error, sizeof error) == 0,
              "%s", error);
    CHECK_MSG(scene_folder_open(folder, &scene, error, sizeof error) == 0, "%s", error);
    CHECK(scene.frame_count == 4);
    scene_folder_close(&scene);
    return made;
}

static void scenes_are_kept(void)
{
    char folder[200];
    scratch_begin();
    CHECK(open_cached(folder, sizeof folder) == 4);
    CHECK(strcmp(folder, scratch_at("a/cache/tight-rods-2048-4")) == 0);
    CHECK(open_cached(folder, sizeof folder) == 0);
    CHECK(truncate(scratch_at("a/cache/tight-rods-2048-4/frames.f32"), 100) == 0);
    CHECK(open_cached(folder, sizeof folder) == 4);
    write_file(scratch_at("a/cache/tight-rods-2048-4/version.txt"), "0\n", 2);
    CHECK(open_cached(folder, sizeof folder) == 4);
    CHECK(open_cached(folder, sizeof folder) == 0);
    /* Nothing is left beside the scene. */
    CHECK(rename(folder, scratch_at("moved")) == 0);
    CHECK(rmdir(scratch_at("a/cache")) == 0);
    scratch_end();
}

/* ------------------------------------------------------------------------------------------------
 * Decimation.
 */

static void decimation_keeps_surfaces(void)
{
    for (int closed = 0; closed < 2; closed++) {
        mesh_file mesh;
        CHECK(closed ? shape_make_sphere(&mesh, 4) : shape_make_grid(&mesh, 40));
        const uint32_t wanted = mesh.triangle_count / 6;
        CHECK(decimate_mesh(&mesh, wanted));
        CHECK_MSG(mesh.triangle_count <= wanted && mesh.triangle_count + 2 >= wanted,
                  "%lu triangles", (unsigned long)mesh.triangle_count);
        const size_t count = 3 * (size_t)mesh.triangle_count;
        mesh_side *sides = mesh_edges_sort(&mesh);
        uint32_t edges = 0;
        bool sound = true;
        double farthest = 0.0;
        for (size_t i = 0; i < count; edges++) {
            const size_t run = mesh_edges_run(sides, i, count);
            sound = sound && sides[i].low != sides[i].high && (run == 2 || (run == 1 && !closed));
            i += run;
        }
        free(sides);
        CHECK_MSG(sound, "an edge of %s has more or fewer triangles than it should",
                  closed ? "a sphere" : "a grid");
        /* Euler: a sphere, or a disc. */
        CHECK(mesh.vertex_count + mesh.triangle_count == edges + (closed ? 2 : 1));
        for (size_t v = 0; v < mesh.vertex_count; v++) {
            const float *p = (const float *)mesh.positions + 3 * v;
            const double x = (double)p[0], y = (double)p[1], z = (double)p[2];
            const double off = closed ? fabs(sqrt(x * x + y * y + z * z) - 1.0) : fabs(z);
            farthest = fmax(farthest, off);
        }
        CHECK_MSG(farthest < 0.03, "a vertex is %g off the surface", farthest);
        mesh_file_free(&mesh);
    }
}

SC_TEST_MAIN(SC_TEST(folders_read_back), SC_TEST(damaged_folders_are_refused),
             SC_TEST(numbers_that_are_not_finite_are_refused),
             SC_TEST(sequences_of_meshes_are_scenes), SC_TEST(scenes_are_sound_and_repeatable),
             SC_TEST(animations_are_whole), SC_TEST(usual_sizes_are_met),
             SC_TEST(contacts_build_up), SC_TEST(wrong_requests_are_refused),
             SC_TEST(scenes_are_kept), SC_TEST(decimation_keeps_surfaces))
