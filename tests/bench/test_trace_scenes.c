/*
 * Contours of every scene of bench/, and of the scenes in folders that the environment variable
 * SC_SCENES names, with colons between: every frame that is looked at is checked by the oracle's
 * crossings. --scale 1000 takes ten times the triangles and frames.
 *
 * SPDX-License-Identifier: MIT
 */
#include "bench_model.h"
#include "harness.h"
#include "scene_folder.h"
#include "scenes/scene.h"
#include "scratch.h"
#include "trace_scene.h"
#include "traced_pose.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static char error[512];

typedef struct tally {
    uint64_t frames, nodes, contours, closed, border, vertex;
} tally;

static int check_frame(const scene_folder *scene, const sc_model *model, const double *positions,
                       tally *sum)
{
    const sc_pose pose = input_plain_pose(positions, scene->vertex_count);
    traced_pose t;
    sc_pair *pairs;
    uint64_t count;
    int is_right;
    memset(&t, 0, sizeof t);
    t.triangle_count = scene->triangle_count;
    t.triangles = scene->triangles;
    t.positions = positions;
    t.truth = trace_oracle_find(t.triangles, t.triangle_count, positions);
    pairs = trace_scene_find_pairs(model, &pose, &count);
    is_right = pairs && trace_scene_trace(model, &pose, pairs, count, NULL, &t.result) &&
               traced_pose_check(&t);
    ++sum->frames;
    sum->nodes += t.result.node_count;
    sum->contours += t.result.contour_count;
    for (uint64_t i = 0; i < t.result.contour_count && is_right; ++i) {
        sum->closed += t.result.contours[i].begin == SC_TRACE_CLOSED;
        sum->border += t.result.contours[i].begin == SC_TRACE_BORDER;
        sum->vertex += t.result.contours[i].end == SC_TRACE_VERTEX;
    }
    trace_scene_free_result(&t.result);
    trace_oracle_free(&t.truth);
    free(pairs);
    return is_right;
}

/* Checks so many frames of a folder, the last among them. */
static int check_folder(const char *path, const char *name, uint32_t frames, tally *all)
{
    sc_build_options options;
    scene_folder scene;
    sc_model *model = NULL;
    double *positions, milliseconds;
    tally sum;
    int is_right;
    memset(&sum, 0, sizeof sum);
    memset(&options, 0, sizeof options);
    options.weld = SC_WELD_NONE;
    if (!CHECK_MSG(scene_folder_open(path, &scene, error, sizeof error) == 0, "%s: %s", path,
                   error))
        return 0;
    positions = (double *)test_allocate(3 * (size_t)scene.vertex_count * sizeof *positions);
    is_right = CHECK_MSG(scene_folder_frame(&scene, 0, positions, error, sizeof error) == 0, "%s",
                         error) &&
               CHECK(bench_model_build(&scene, positions, BENCH_FAST, &options, &model,
                                       &milliseconds) == SC_OK);
    if (frames > scene.frame_count) frames = scene.frame_count;
    for (uint32_t i = 1; i <= frames && is_right; ++i) {
        const uint32_t frame = (uint32_t)((uint64_t)scene.frame_count * i / frames) - 1;
        is_right = CHECK_MSG(scene_folder_frame(&scene, frame, positions, error, sizeof error) == 0,
                             "%s", error) &&
                   CHECK_MSG(check_frame(&scene, model, positions, &sum), "%s, frame %u", name,
                             (unsigned)frame);
    }
    test_note("%s: %u triangles, %" PRIu64 " frames; %" PRIu64 " contours of %" PRIu64
              " nodes, %" PRIu64 " closed, %" PRIu64 " from borders, %" PRIu64 " to vertices",
              name, (unsigned)scene.triangle_count, sum.frames, sum.contours, sum.nodes, sum.closed,
              sum.border, sum.vertex);
    all->closed += sum.closed;
    all->border += sum.border;
    sc_model_free(model);
    free(positions);
    scene_folder_close(&scene);
    return is_right;
}

/* Every scene of bench/, of about so many triangles. */
static void check_bench(uint32_t triangles, uint32_t frames, tally *all)
{
    size_t count;
    const scene_kind *kinds = scene_kinds(&count);
    scratch_begin();
    for (size_t k = 0; k < count; ++k) {
        const char *name = kinds[k].name;
        error[0] = '\0';
        if (scene_make(name, triangles, 61, scratch_at("scene"), NULL, NULL, error, sizeof error)) {
            if (CHECK_MSG(strstr(error, "make meshes") != NULL, "%s: %s", name, error))
                test_skip("%s: %s", name, error);
            continue;
        }
        check_folder(scratch_at("scene"), name, frames, all);
    }
    scratch_end();
}

/* Folders with colons between. */
static void check_folders(const char *at, uint32_t frames, tally *all)
{
    while (*at) {
        char path[400];
        const size_t length = strcspn(at, ":");
        if (!CHECK(length < sizeof path)) return;
        memcpy(path, at, length);
        path[length] = '\0';
        check_folder(path, path, frames, all);
        at += length + (at[length] == ':');
    }
}

static void contours_of_scenes(void)
{
    const uint32_t frames = test_iterations_at_least(200, 200) / 100;
    const char *folders = getenv("SC_SCENES");
    tally all;
    memset(&all, 0, sizeof all);
    check_bench(test_iterations_at_least(800, 600), frames, &all);
    if (folders) check_folders(folders, frames, &all);
    CHECK(!test_is_full() || (all.closed > 0 && all.border > 0));
}

SC_TEST_MAIN(SC_TEST(contours_of_scenes))
