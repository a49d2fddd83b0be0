/*
 * Bad input: every mistake gets the status that the header names, leaks nothing, leaves outputs as
 * it says, and leaves model and workspace able to answer right.
 *
 * SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "harness.h"
#include "input_fixture.h"
#include "inputs.h"
#include "soups.h"
#include "starcontour.h"

static void null_everywhere(void)
{
    input_fixture f;
    if (input_fixture_start(&f)) {
        sc_mesh mesh;
        sc_pose pose;
        sc_result result;
        sc_build_options options;
        sc_model_info info;
        sc_level_info level;
        sc_workspace *workspace;
        uint64_t size;
        uint32_t patches[200];

        CHECK(sc_build(&f.input, NULL, NULL) == SC_ERROR_NULL);
        input_fixture_check_build(&f, NULL, NULL, SC_ERROR_NULL, "mesh NULL");
        mesh = f.input;
        mesh.positions = NULL;
        input_fixture_check_build(&f, &mesh, NULL, SC_ERROR_NULL, "positions NULL");
        mesh = f.input;
        mesh.indices = NULL;
        input_fixture_check_build(&f, &mesh, NULL, SC_ERROR_NULL, "indices NULL");
        options = input_fixture_no_build_options();
        options.weld = SC_WELD_MAP;
        input_fixture_check_build(&f, &f.input, &options, SC_ERROR_NULL, "weld_map NULL");
        options = input_fixture_no_build_options();
        options.partition = SC_PARTITION_ORDER;
        input_fixture_check_build(&f, &f.input, &options, SC_ERROR_NULL, "order NULL");
        options.partition = SC_PARTITION_BISECT;
        input_fixture_check_build(&f, &f.input, &options, SC_ERROR_NULL, "bisect NULL");
        options.partition = SC_PARTITION_TREE;
        options.tree_count = 1;
        input_fixture_check_build(&f, &f.input, &options, SC_ERROR_NULL, "order and tree NULL");

        CHECK(sc_model_get_info(f.model, NULL) == SC_ERROR_NULL);
        memset(&info, 0, sizeof(info));
        info.struct_size = sizeof(info);
        CHECK(sc_model_get_info(NULL, &info) == SC_ERROR_NULL);
        CHECK(sc_model_get_level(f.model, 0, NULL) == SC_ERROR_NULL);
        memset(&level, 0, sizeof(level));
        level.struct_size = sizeof(level);
        CHECK(sc_model_get_level(NULL, 0, &level) == SC_ERROR_NULL);
        CHECK(sc_model_get_patches(NULL, 0, patches, 200) == SC_ERROR_NULL);
        CHECK(sc_model_get_patches(f.model, 0, NULL, 200) == SC_ERROR_NULL);

        CHECK(sc_workspace_size(NULL, &size) == SC_ERROR_NULL);
        CHECK(sc_workspace_size(f.model, NULL) == SC_ERROR_NULL);
        CHECK(sc_workspace_create(f.model, NULL, NULL) == SC_ERROR_NULL);
        workspace = f.workspace;
        CHECK(sc_workspace_create(NULL, NULL, &workspace) == SC_ERROR_NULL);
        CHECK(workspace == NULL);
        CHECK(sc_workspace_init(NULL, patches, sizeof(patches), &workspace) == SC_ERROR_NULL);
        CHECK(sc_workspace_init(f.model, NULL, UINT64_C(1) << 30, &workspace) == SC_ERROR_NULL);
        CHECK(sc_workspace_init(f.model, patches, sizeof(patches), NULL) == SC_ERROR_NULL);

        CHECK(sc_query(f.model, f.workspace, &f.pose, NULL, NULL) == SC_ERROR_NULL);
        input_fixture_check_query(&f, NULL, f.workspace, &f.pose, NULL, SC_ERROR_NULL,
                                  "model NULL");
        input_fixture_check_query(&f, f.model, NULL, &f.pose, NULL, SC_ERROR_NULL,
                                  "workspace NULL");
        input_fixture_check_query(&f, f.model, f.workspace, NULL, NULL, SC_ERROR_NULL, "pose NULL");
        pose = f.pose;
        pose.positions = NULL;
        input_fixture_check_query(&f, f.model, f.workspace, &pose, NULL, SC_ERROR_NULL,
                                  "pose positions NULL");
        memset(&result, 0, sizeof(result));
        result.struct_size = sizeof(result);
        result.capacity = 3;
        result.count = 9;
        CHECK(sc_query(f.model, f.workspace, &f.pose, NULL, &result) == SC_ERROR_NULL);
        CHECK(result.count == 0 && result.collides == 0);
        result.capacity = 0; /* this is allowed */
        CHECK(sc_query(f.model, f.workspace, &f.pose, NULL, &result) == SC_ERROR_SHORT_BUFFER);
        CHECK(result.count == f.answer.lists[0][0].count && result.collides == 1);
        sc_model_free(NULL);
        sc_workspace_free(NULL);
        CHECK(input_fixture_is_still_right(&f));
    }
    input_fixture_stop(&f);
}

static void allocators_without_functions(void)
{
    input_fixture f;
    if (input_fixture_start(&f)) {
        sc_allocator allocator;
        sc_build_options options = input_fixture_no_build_options();
        sc_workspace *workspace = f.workspace;
        memset(&allocator, 0, sizeof(allocator));
        options.allocator = &allocator;
        input_fixture_check_build(&f, &f.input, &options, SC_ERROR_NULL,
                                  "allocator without functions");
        CHECK(sc_workspace_create(f.model, &allocator, &workspace) == SC_ERROR_NULL);
        CHECK(workspace == NULL);
        CHECK(input_fixture_is_still_right(&f));
    }
    input_fixture_stop(&f);
}

static void counts_and_strides(void)
{
    input_fixture f;
    if (input_fixture_start(&f)) {
        sc_mesh mesh = f.input;
        sc_pose pose = f.pose;
        mesh.triangle_count = 0;
        input_fixture_check_build(&f, &mesh, NULL, SC_ERROR_EMPTY, "no triangles");
        mesh = f.input;
        mesh.vertex_count = 0;
        input_fixture_check_build(&f, &mesh, NULL, SC_ERROR_EMPTY, "no vertices");
        mesh = f.input;
        mesh.triangle_count = 0x55555555u;
        input_fixture_check_build(&f, &mesh, NULL, SC_ERROR_COUNT, "one triangle too many");
        mesh.triangle_count = 0xffffffffu;
        input_fixture_check_build(&f, &mesh, NULL, SC_ERROR_COUNT, "2^32 - 1 triangles");
        mesh = f.input;
        mesh.vertex_count = 0xffffffffu;
        mesh.position_stride = 0xffffffffu;
        input_fixture_check_build(&f, &mesh, NULL, SC_ERROR_COUNT, "2^32 - 1 vertices");

        for (uint32_t stride = 1; stride < 24; ++stride) {
            mesh = f.input;
            mesh.position_stride = stride;
            input_fixture_check_build(&f, &mesh, NULL, SC_ERROR_STRIDE, "double stride");
            pose.position_stride = stride;
            input_fixture_check_query(&f, f.model, f.workspace, &pose, NULL, SC_ERROR_STRIDE,
                                      "double stride");
            mesh = f.input;
            mesh.index_stride = stride;
            if (stride < 12)
                input_fixture_check_build(&f, &mesh, NULL, SC_ERROR_STRIDE, "uint32 stride");
            mesh.index_type = SC_UINT16;
            if (stride < 6)
                input_fixture_check_build(&f, &mesh, NULL, SC_ERROR_STRIDE, "uint16 stride");
            mesh = f.input;
            mesh.position_type = pose.position_type = SC_FLOAT;
            mesh.position_stride = stride;
            if (stride < 12) {
                input_fixture_check_build(&f, &mesh, NULL, SC_ERROR_STRIDE, "float stride");
                input_fixture_check_query(&f, f.model, f.workspace, &pose, NULL, SC_ERROR_STRIDE,
                                          "float stride");
            }
            pose.position_type = SC_DOUBLE;
        }

        pose = f.pose;
        pose.vertex_count = f.mesh.vertex_count - 1;
        input_fixture_check_query(&f, f.model, f.workspace, &pose, NULL, SC_ERROR_VERTEX_COUNT,
                                  "too few");
        pose.vertex_count = f.mesh.vertex_count + 1;
        input_fixture_check_query(&f, f.model, f.workspace, &pose, NULL, SC_ERROR_VERTEX_COUNT,
                                  "too many");
        pose.vertex_count = 0;
        input_fixture_check_query(&f, f.model, f.workspace, &pose, NULL, SC_ERROR_VERTEX_COUNT,
                                  "none");
    }
    input_fixture_stop(&f);
}

static void indices_out_of_range(void)
{
    input_fixture f;
    if (input_fixture_start(&f)) {
        uint32_t corners = 3 * f.mesh.triangle_count;
        static const uint32_t wrong[] = {0, 1, 0xffffffffu - 121, 0x80000000u};
        for (uint32_t i = 0; i < corners; i = i == 0 || i + 2 > corners ? i + 1 : i * 2) {
            uint32_t kept = f.mesh.triangles[i];
            for (int w = 0; w < 4; ++w) {
                input_array narrow;
                sc_mesh mesh;
                f.mesh.triangles[i] = f.mesh.vertex_count + wrong[w];
                input_fixture_check_build(&f, &f.input, NULL, SC_ERROR_INDEX, "uint32");
                if (w == 3) f.mesh.triangles[i] = 0xffff;
                narrow = input_indices(f.mesh.triangles, f.mesh.triangle_count, SC_UINT16,
                                       w % 2 != 0 ? 3 : 0);
                mesh = f.input;
                mesh.indices = narrow.data;
                mesh.index_type = SC_UINT16;
                mesh.index_stride = narrow.stride;
                if (f.mesh.triangles[i] <= 0xffff)
                    input_fixture_check_build(&f, &mesh, NULL, SC_ERROR_INDEX, "uint16");
                input_free(&narrow);
            }
            f.mesh.triangles[i] = kept;
        }
        CHECK(input_fixture_is_still_right(&f));
    }
    input_fixture_stop(&f);
}

static void not_finite(void)
{
    input_fixture f;
    if (input_fixture_start(&f)) {
        size_t count = 3 * (size_t)f.mesh.vertex_count;
        double wrong[3];
        wrong[0] = (double)NAN;
        wrong[1] = HUGE_VAL;
        wrong[2] = -HUGE_VAL;
        for (size_t i = 0; i < count; i += 1 + i / 8) {
            for (int w = 0; w < 3; ++w) {
                double kept[2];
                input_array narrow;
                sc_mesh mesh = f.input;
                sc_pose pose;
                kept[0] = f.mesh.positions[i];
                kept[1] = f.posed[i];
                f.mesh.positions[i] = f.posed[i] = wrong[w];
                input_fixture_check_build(&f, &mesh, NULL, SC_ERROR_NOT_FINITE, "double mesh");
                narrow = input_positions(f.mesh.positions, f.mesh.vertex_count, SC_FLOAT, 0);
                mesh.positions = narrow.data;
                mesh.position_type = SC_FLOAT;
                input_fixture_check_build(&f, &mesh, NULL, SC_ERROR_NOT_FINITE, "float mesh");
                input_free(&narrow);

                narrow =
                    input_positions(f.posed, f.mesh.vertex_count, w == 0 ? SC_FLOAT : SC_DOUBLE, 5);
                f.mesh.positions[i] = kept[0];
                f.posed[i] = kept[1]; /* is what check_query compares with */
                pose = input_pose(f.mesh.vertex_count, &narrow);
                for (uint32_t method = 0; method <= SC_METHOD_AABB; ++method) {
                    sc_query_options options = input_fixture_no_options();
                    options.method = method;
                    options.output = (uint32_t)w;
                    input_fixture_check_query(&f, f.model, f.workspace, &pose, &options,
                                              SC_ERROR_NOT_FINITE, "pose");
                }
                input_free(&narrow);
            }
        }
    }
    input_fixture_stop(&f);
}

static void enumerators(void)
{
    static const uint32_t wrong[] = {4, 5, 0x7fffffffu, 0xffffffffu};
    input_fixture f;
    if (input_fixture_start(&f)) {
        for (int w = 0; w < 4; ++w) {
            uint32_t value = wrong[w];
            sc_mesh mesh = f.input;
            sc_pose pose = f.pose;
            sc_build_options build = input_fixture_no_build_options();
            sc_query_options query;
            mesh.position_type = value;
            input_fixture_check_build(&f, &mesh, NULL, SC_ERROR_OPTION, "mesh position_type");
            mesh = f.input;
            mesh.index_type = value;
            input_fixture_check_build(&f, &mesh, NULL, SC_ERROR_OPTION, "index_type");
            mesh = f.input;
            mesh.reserved = value;
            input_fixture_check_build(&f, &mesh, NULL, SC_ERROR_OPTION, "mesh reserved");
            build.weld = value;
            input_fixture_check_build(&f, &f.input, &build, SC_ERROR_OPTION, "weld");
            build.weld = 0;
            build.partition = value;
            input_fixture_check_build(&f, &f.input, &build, SC_ERROR_OPTION, "partition");
            build = input_fixture_no_build_options();
            build.rest = value;
            input_fixture_check_build(&f, &f.input, &build, SC_ERROR_OPTION, "rest");
            build = input_fixture_no_build_options();
            build.content = value;
            input_fixture_check_build(&f, &f.input, &build, SC_ERROR_OPTION, "build content");
            pose.position_type = value;
            input_fixture_check_query(&f, f.model, f.workspace, &pose, NULL, SC_ERROR_OPTION,
                                      "pose position_type");
            query = input_fixture_no_options();
            query.output = value;
            input_fixture_check_query(&f, f.model, f.workspace, &f.pose, &query, SC_ERROR_OPTION,
                                      "output");
            query = input_fixture_no_options();
            query.pairs = value;
            input_fixture_check_query(&f, f.model, f.workspace, &f.pose, &query, SC_ERROR_OPTION,
                                      "pairs");
            query = input_fixture_no_options();
            query.contact = value;
            input_fixture_check_query(&f, f.model, f.workspace, &f.pose, &query, SC_ERROR_OPTION,
                                      "contact");
            query = input_fixture_no_options();
            query.method = value;
            input_fixture_check_query(&f, f.model, f.workspace, &f.pose, &query, SC_ERROR_OPTION,
                                      "method");
            query = input_fixture_no_options();
            query.contour = value;
            input_fixture_check_query(&f, f.model, f.workspace, &f.pose, &query, SC_ERROR_OPTION,
                                      "contour");
            query = input_fixture_no_options();
            query.rest_cache = value;
            input_fixture_check_query(&f, f.model, f.workspace, &f.pose, &query, SC_ERROR_OPTION,
                                      "rest_cache");
            query = input_fixture_no_options();
            query.simd = value;
            input_fixture_check_query(&f, f.model, f.workspace, &f.pose, &query, SC_ERROR_OPTION,
                                      "simd");
        }
    }
    input_fixture_stop(&f);
}

static void workspaces(void)
{
    input_fixture f;
    if (input_fixture_start(&f)) {
        soup other = soup_cloth(3, 3);
        sc_mesh mesh = input_plain_mesh(&other);
        sc_model *model = NULL;
        sc_workspace *workspace = NULL;
        uint64_t size = 0;
        unsigned char *memory, *aligned;
        if (CHECK(sc_build(&mesh, NULL, &model) == SC_OK) &&
            CHECK(sc_workspace_create(model, NULL, &workspace) == SC_OK)) {
            input_fixture_check_query(&f, f.model, workspace, &f.pose, NULL, SC_ERROR_WORKSPACE,
                                      "too small a model");
            mesh.vertex_count = f.pose.vertex_count;
            input_fixture_check_query(&f, model, f.workspace, &f.pose, NULL, SC_ERROR_WORKSPACE,
                                      "workspace of a larger model");
        }
        sc_workspace_free(workspace);
        sc_model_free(model);
        soup_free(&other);

        CHECK(sc_workspace_size(f.model, &size) == SC_OK && size > 0);
        memory = (unsigned char *)test_allocate(size + 2 * SC_ALIGNMENT);
        aligned = memory + (SC_ALIGNMENT - (uintptr_t)memory % SC_ALIGNMENT);
        memset(memory, 0x5a, size + 2 * SC_ALIGNMENT);
        for (uint32_t offset = 1; offset < SC_ALIGNMENT; offset += offset) {
            workspace = f.workspace;
            CHECK(sc_workspace_init(f.model, aligned + offset, size, &workspace) ==
                  SC_ERROR_ALIGNMENT);
            CHECK(workspace == NULL);
        }
        workspace = f.workspace;
        CHECK(sc_workspace_init(f.model, aligned, size - 1, &workspace) == SC_ERROR_WORKSPACE);
        CHECK(sc_workspace_init(f.model, aligned, 1, &workspace) == SC_ERROR_WORKSPACE);
        CHECK(sc_workspace_init(f.model, aligned, 0, &workspace) == SC_ERROR_WORKSPACE);
        CHECK(sc_workspace_init(f.model, aligned, size, &workspace) == SC_OK);
        CHECK(input_fixture_is_right(&f, f.model, workspace));
        sc_workspace_free(workspace); /* does nothing */
        CHECK(input_fixture_is_right(&f, f.model, workspace));
        CHECK(input_fixture_is_still_right(&f));
        for (uint64_t i = 0; i < SC_ALIGNMENT; ++i) {
            if (memory + i < aligned) CHECK(memory[i] == 0x5a);
            if (aligned + size + i < memory + size + 2 * SC_ALIGNMENT)
                CHECK(aligned[size + i] == 0x5a);
        }
        free(memory);
    }
    input_fixture_stop(&f);
}

static void levels_and_patches(void)
{
    input_fixture f;
    if (input_fixture_start(&f)) {
        sc_model_info info;
        sc_level_info level;
        uint32_t patches[200], count = f.mesh.triangle_count;
        memset(&info, 0, sizeof(info));
        info.struct_size = sizeof(info);
        memset(&level, 0, sizeof(level));
        level.struct_size = sizeof(level);
        if (CHECK(sc_model_get_info(f.model, &info) == SC_OK)) {
            uint64_t size;
            uint32_t previous = 0;
            CHECK(info.vertex_count == 121 && info.point_count == 121);
            CHECK(info.triangle_count == 200 && info.edge_count == 320);
            CHECK(info.component_count == 1 && info.boundary_edges == 40);
            CHECK(info.irregular_edges == 0);
            CHECK(info.level_count >= 1 && info.leaf_count >= 200 / 64);
            CHECK(sc_workspace_size(f.model, &size) == SC_OK && size == info.workspace_bytes);
            CHECK(info.model_bytes > 0);
            for (uint32_t l = 0; l < info.level_count; ++l) {
                uint32_t highest = 0;
                CHECK(sc_model_get_level(f.model, l, &level) == SC_OK);
                CHECK(sc_model_get_patches(f.model, l, patches, count) == SC_OK);
                for (uint32_t t = 0; t < count; ++t)
                    if (patches[t] > highest) highest = patches[t];
                CHECK(level.patch_count == highest + 1 && level.patch_count >= previous);
                CHECK(l != 0 || level.patch_count == 1);
                CHECK(level.connected_patches <= level.patch_count);
                previous = level.patch_count;
            }
            CHECK(sc_model_get_level(f.model, info.level_count, &level) == SC_ERROR_LEVEL);
            CHECK(sc_model_get_level(f.model, SC_NONE, &level) == SC_ERROR_LEVEL);
            CHECK(sc_model_get_patches(f.model, info.level_count, patches, count) ==
                  SC_ERROR_LEVEL);
            memset(patches, 0xee, sizeof(patches));
            CHECK(sc_model_get_patches(f.model, 0, patches, count - 1) == SC_ERROR_SHORT_BUFFER);
            CHECK(sc_model_get_patches(f.model, 0, patches, 0) == SC_ERROR_SHORT_BUFFER);
            for (uint32_t t = 0; t < count; ++t) CHECK(patches[t] == 0xeeeeeeeeu);
        }
        CHECK(input_fixture_is_still_right(&f));
    }
    input_fixture_stop(&f);
}

/* What a model says of itself, on meshes whose counts are known. */
static void information(void)
{
    enum { MESHES = 5 };
    static const uint32_t expected[MESHES][6] = {
        /* points, edges, components, edges of one triangle, irregular edges, triangles */
        {122, 360, 1, 0, 0, 240}, /* closed */
        {25, 56, 1, 16, 0, 32},   /* single triangles, welded */
        {30, 69, 1, 28, 5, 40},   /* five edges have four triangles */
        {17, 32, 1, 16, 0, 16},   /* two squares that share a corner */
        {30, 70, 1, 20, 0, 40},   /* two open ends */
    };
    soup meshes[MESHES];
    meshes[0] = soup_sphere(12, 10);
    meshes[1] = soup_seams(4);
    meshes[2] = soup_fins(5);
    meshes[3] = soup_pinched(2);
    meshes[4] = soup_tube(10, 2);
    for (int i = 0; i < MESHES; ++i) {
        sc_mesh mesh = input_plain_mesh(&meshes[i]);
        sc_model *model = NULL;
        sc_model_info info;
        memset(&info, 0, sizeof(info));
        info.struct_size = sizeof(info);
        if (CHECK(sc_build(&mesh, NULL, &model) == SC_OK) &&
            CHECK(sc_model_get_info(model, &info) == SC_OK)) {
            CHECK_MSG(info.point_count == expected[i][0], "%d: %u", i, info.point_count);
            CHECK_MSG(info.edge_count == expected[i][1], "%d: %u", i, info.edge_count);
            CHECK_MSG(info.component_count == expected[i][2], "%d: %u", i, info.component_count);
            CHECK_MSG(info.boundary_edges == expected[i][3], "%d: %u", i, info.boundary_edges);
            CHECK_MSG(info.irregular_edges == expected[i][4], "%d: %u", i, info.irregular_edges);
            CHECK_MSG(info.triangle_count == expected[i][5], "%d: %u", i, info.triangle_count);
        }
        sc_model_free(model);
    }
    for (int i = 0; i < MESHES; ++i) soup_free(&meshes[i]);
}

static void statuses_and_version(void)
{
    char version[32];
    for (sc_status status = 0; status <= SC_ERROR_BOXES_ONLY; ++status) {
        const char *text = sc_status_string(status);
        if (!CHECK(text != NULL && text[0] != '\0')) continue;
        for (sc_status other = 0; other < status; ++other)
            CHECK_MSG(strcmp(text, sc_status_string(other)) != 0, "%d and %d", (int)status,
                      (int)other);
    }
    CHECK(sc_status_string(-1) != NULL && sc_status_string(SC_ERROR_BOXES_ONLY + 1) != NULL);
    CHECK(sc_status_string(INT32_MIN) != NULL && sc_status_string(INT32_MAX) != NULL);
    CHECK(sc_version() == SC_VERSION_NUMBER);
    snprintf(version, sizeof(version), "%d.%d.%d", SC_VERSION_MAJOR, SC_VERSION_MINOR,
             SC_VERSION_PATCH);
    CHECK(strcmp(sc_version_string(), version) == 0);
}

SC_TEST_MAIN(SC_TEST(null_everywhere), SC_TEST(allocators_without_functions),
             SC_TEST(counts_and_strides), SC_TEST(indices_out_of_range), SC_TEST(not_finite),
             SC_TEST(enumerators), SC_TEST(workspaces), SC_TEST(levels_and_patches),
             SC_TEST(information), SC_TEST(statuses_and_version))
