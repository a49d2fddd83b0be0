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
#include "inputs.h"
#include "oracle.h"
#include "soups.h"
#include "starcontour.h"

/* A cloth of 200 triangles, folded, with what the oracle says of it. */
typedef struct fixture {
    soup mesh;
    double *posed;
    sc_mesh input;
    sc_pose pose;
    sc_model *model;
    sc_workspace *workspace;
    oracle_answer answer;
} fixture;

static int start(fixture *f)
{
    memset(f, 0, sizeof(*f));
    f->mesh = soup_cloth(10, 10);
    f->posed = (double *)test_allocate(3 * (size_t)f->mesh.vertex_count * sizeof(double));
    memcpy(f->posed, f->mesh.positions, 3 * (size_t)f->mesh.vertex_count * sizeof(double));
    for (uint32_t v = 0; v < f->mesh.vertex_count; ++v) /* fold it to a slope that crosses it */
        if (f->posed[3 * v] > 0.55) {
            f->posed[3 * v] = 1.1 - f->posed[3 * v];
            f->posed[3 * v + 2] = 0.1 * f->posed[3 * v + 1] - 0.03;
        }
    f->input = input_plain_mesh(&f->mesh);
    f->pose = input_plain_pose(f->posed, f->mesh.vertex_count);
    oracle_solve(f->posed, f->mesh.vertex_count, f->mesh.triangles, f->mesh.triangle_count, NULL,
                 &f->answer);
    return CHECK(f->answer.lists[0][0].count > 10) &&
           CHECK(sc_build(&f->input, NULL, &f->model) == SC_OK) &&
           CHECK(sc_workspace_create(f->model, NULL, &f->workspace) == SC_OK);
}

static void stop(fixture *f)
{
    sc_workspace_free(f->workspace);
    sc_model_free(f->model);
    oracle_free(&f->answer);
    soup_free(&f->mesh);
    free(f->posed);
}

/* Whether the fixture's model and a workspace still give the oracle's answer. */
static int is_right(const fixture *f, const sc_model *model, sc_workspace *workspace)
{
    const oracle_list *expected = &f->answer.lists[SC_PAIRS_TRIANGLE][SC_CONTACT_TOUCHING];
    sc_pair *pairs = (sc_pair *)test_allocate(expected->count * sizeof(sc_pair));
    sc_result result;
    int ok;
    memset(&result, 0, sizeof(result));
    result.struct_size = sizeof(result);
    result.capacity = expected->count;
    result.pairs = pairs;
    ok = sc_query(model, workspace, &f->pose, NULL, &result) == SC_OK &&
         result.count == expected->count && result.collides == 1 &&
         memcmp(pairs, expected->pairs, expected->count * sizeof(sc_pair)) == 0;
    free(pairs);
    return ok;
}

static int is_still_right(const fixture *f)
{
    return is_right(f, f->model, f->workspace);
}

/* A build that must end with a status: no model then; with SC_OK, the right one. */
static void check_build(const fixture *f, const sc_mesh *mesh, const sc_build_options *options,
                        sc_status expected, const char *what)
{
    sc_model *model = f->model; /* anything but NULL */
    sc_status status = sc_build(mesh, options, &model);
    CHECK_MSG(status == expected, "%s: %s instead of %s", what, sc_status_string(status),
              sc_status_string(expected));
    if (status != SC_OK) {
        CHECK_MSG(model == NULL, "%s", what);
    } else {
        sc_workspace *workspace = NULL;
        CHECK(sc_workspace_create(model, NULL, &workspace) == SC_OK);
        CHECK_MSG(expected != SC_OK || is_right(f, model, workspace), "%s", what);
        sc_workspace_free(workspace);
        sc_model_free(model);
    }
}

/* A query that must end with an error: counts 0, nothing written, and all still works. */
static void check_query(const fixture *f, const sc_model *model, sc_workspace *workspace,
                        const sc_pose *pose, const sc_query_options *options, sc_status expected,
                        const char *what)
{
    static const sc_pair guard = {123, 456};
    sc_pair pairs[4];
    sc_result result;
    sc_status status;
    for (int i = 0; i < 4; ++i) pairs[i] = guard;
    memset(&result, 0, sizeof(result));
    result.struct_size = sizeof(result);
    result.collides = 5;
    result.count = 55;
    result.capacity = 4;
    result.pairs = pairs;
    status = sc_query(model, workspace, pose, options, &result);
    CHECK_MSG(status == expected, "%s: %s instead of %s", what, sc_status_string(status),
              sc_status_string(expected));
    CHECK_MSG(result.count == 0 && result.collides == 0, "%s: count %u, collides %u", what,
              (unsigned)result.count, (unsigned)result.collides);
    for (int i = 0; i < 4; ++i)
        CHECK_MSG(pairs[i].a == guard.a && pairs[i].b == guard.b, "%s: pair %d written", what, i);
    CHECK(result.capacity == 4 && result.pairs == pairs && result.stats == NULL);
    CHECK_MSG(is_still_right(f), "%s", what);
}

static sc_query_options no_options(void)
{
    sc_query_options options;
    memset(&options, 0, sizeof(options));
    options.struct_size = sizeof(options);
    return options;
}

static sc_build_options no_build_options(void)
{
    sc_build_options options;
    memset(&options, 0, sizeof(options));
    options.struct_size = sizeof(options);
    return options;
}

static void null_everywhere(void)
{
    fixture f;
    if (start(&f)) {
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
        check_build(&f, NULL, NULL, SC_ERROR_NULL, "mesh NULL");
        mesh = f.input;
        mesh.positions = NULL;
        check_build(&f, &mesh, NULL, SC_ERROR_NULL, "positions NULL");
        mesh = f.input;
        mesh.indices = NULL;
        check_build(&f, &mesh, NULL, SC_ERROR_NULL, "indices NULL");
        options = no_build_options();
        options.weld = SC_WELD_MAP;
        check_build(&f, &f.input, &options, SC_ERROR_NULL, "weld_map NULL");
        options = no_build_options();
        options.partition = SC_PARTITION_ORDER;
        check_build(&f, &f.input, &options, SC_ERROR_NULL, "order NULL");
        options.partition = SC_PARTITION_BISECT;
        check_build(&f, &f.input, &options, SC_ERROR_NULL, "bisect NULL");
        options.partition = SC_PARTITION_TREE;
        options.tree_count = 1;
        check_build(&f, &f.input, &options, SC_ERROR_NULL, "order and tree NULL");

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
        check_query(&f, NULL, f.workspace, &f.pose, NULL, SC_ERROR_NULL, "model NULL");
        check_query(&f, f.model, NULL, &f.pose, NULL, SC_ERROR_NULL, "workspace NULL");
        check_query(&f, f.model, f.workspace, NULL, NULL, SC_ERROR_NULL, "pose NULL");
        pose = f.pose;
        pose.positions = NULL;
        check_query(&f, f.model, f.workspace, &pose, NULL, SC_ERROR_NULL, "pose positions NULL");
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
        CHECK(is_still_right(&f));
    }
    stop(&f);
}

static void allocators_without_functions(void)
{
    fixture f;
    if (start(&f)) {
        sc_allocator allocator;
        sc_build_options options = no_build_options();
        sc_workspace *workspace = f.workspace;
        memset(&allocator, 0, sizeof(allocator));
        options.allocator = &allocator;
        check_build(&f, &f.input, &options, SC_ERROR_NULL, "allocator without functions");
        CHECK(sc_workspace_create(f.model, &allocator, &workspace) == SC_ERROR_NULL);
        CHECK(workspace == NULL);
        CHECK(is_still_right(&f));
    }
    stop(&f);
}

static void counts_and_strides(void)
{
    fixture f;
    if (start(&f)) {
        sc_mesh mesh = f.input;
        sc_pose pose = f.pose;
        mesh.triangle_count = 0;
        check_build(&f, &mesh, NULL, SC_ERROR_EMPTY, "no triangles");
        mesh = f.input;
        mesh.vertex_count = 0;
        check_build(&f, &mesh, NULL, SC_ERROR_EMPTY, "no vertices");
        mesh = f.input;
        mesh.triangle_count = 0x55555555u;
        check_build(&f, &mesh, NULL, SC_ERROR_COUNT, "one triangle too many");
        mesh.triangle_count = 0xffffffffu;
        check_build(&f, &mesh, NULL, SC_ERROR_COUNT, "2^32 - 1 triangles");
        mesh = f.input;
        mesh.vertex_count = 0xffffffffu;
        mesh.position_stride = 0xffffffffu;
        check_build(&f, &mesh, NULL, SC_ERROR_COUNT, "2^32 - 1 vertices");

        for (uint32_t stride = 1; stride < 24; ++stride) {
            mesh = f.input;
            mesh.position_stride = stride;
            check_build(&f, &mesh, NULL, SC_ERROR_STRIDE, "double stride");
            pose.position_stride = stride;
            check_query(&f, f.model, f.workspace, &pose, NULL, SC_ERROR_STRIDE, "double stride");
            mesh = f.input;
            mesh.index_stride = stride;
            if (stride < 12) check_build(&f, &mesh, NULL, SC_ERROR_STRIDE, "uint32 stride");
            mesh.index_type = SC_UINT16;
            if (stride < 6) check_build(&f, &mesh, NULL, SC_ERROR_STRIDE, "uint16 stride");
            mesh = f.input;
            mesh.position_type = pose.position_type = SC_FLOAT;
            mesh.position_stride = stride;
            if (stride < 12) {
                check_build(&f, &mesh, NULL, SC_ERROR_STRIDE, "float stride");
                check_query(&f, f.model, f.workspace, &pose, NULL, SC_ERROR_STRIDE, "float stride");
            }
            pose.position_type = SC_DOUBLE;
        }

        pose = f.pose;
        pose.vertex_count = f.mesh.vertex_count - 1;
        check_query(&f, f.model, f.workspace, &pose, NULL, SC_ERROR_VERTEX_COUNT, "too few");
        pose.vertex_count = f.mesh.vertex_count + 1;
        check_query(&f, f.model, f.workspace, &pose, NULL, SC_ERROR_VERTEX_COUNT, "too many");
        pose.vertex_count = 0;
        check_query(&f, f.model, f.workspace, &pose, NULL, SC_ERROR_VERTEX_COUNT, "none");
    }
    stop(&f);
}

static void indices_out_of_range(void)
{
    fixture f;
    if (start(&f)) {
        uint32_t corners = 3 * f.mesh.triangle_count;
        static const uint32_t wrong[] = {0, 1, 0xffffffffu - 121, 0x80000000u};
        for (uint32_t i = 0; i < corners; i = i == 0 || i + 2 > corners ? i + 1 : i * 2) {
            uint32_t kept = f.mesh.triangles[i];
            for (int w = 0; w < 4; ++w) {
                input_array narrow;
                sc_mesh mesh;
                f.mesh.triangles[i] = f.mesh.vertex_count + wrong[w];
                check_build(&f, &f.input, NULL, SC_ERROR_INDEX, "uint32");
                if (w == 3) f.mesh.triangles[i] = 0xffff;
                narrow = input_indices(f.mesh.triangles, f.mesh.triangle_count, SC_UINT16,
                                       w % 2 != 0 ? 3 : 0);
                mesh = f.input;
                mesh.indices = narrow.data;
                mesh.index_type = SC_UINT16;
                mesh.index_stride = narrow.stride;
                if (f.mesh.triangles[i] <= 0xffff)
                    check_build(&f, &mesh, NULL, SC_ERROR_INDEX, "uint16");
                input_free(&narrow);
            }
            f.mesh.triangles[i] = kept;
        }
        CHECK(is_still_right(&f));
    }
    stop(&f);
}

static void not_finite(void)
{
    fixture f;
    if (start(&f)) {
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
                check_build(&f, &mesh, NULL, SC_ERROR_NOT_FINITE, "double mesh");
                narrow = input_positions(f.mesh.positions, f.mesh.vertex_count, SC_FLOAT, 0);
                mesh.positions = narrow.data;
                mesh.position_type = SC_FLOAT;
                check_build(&f, &mesh, NULL, SC_ERROR_NOT_FINITE, "float mesh");
                input_free(&narrow);

                narrow =
                    input_positions(f.posed, f.mesh.vertex_count, w == 0 ? SC_FLOAT : SC_DOUBLE, 5);
                f.mesh.positions[i] = kept[0];
                f.posed[i] = kept[1]; /* is what check_query compares with */
                pose = input_pose(f.mesh.vertex_count, &narrow);
                for (uint32_t method = 0; method <= SC_METHOD_AABB; ++method) {
                    sc_query_options options = no_options();
                    options.method = method;
                    options.output = (uint32_t)w;
                    check_query(&f, f.model, f.workspace, &pose, &options, SC_ERROR_NOT_FINITE,
                                "pose");
                }
                input_free(&narrow);
            }
        }
    }
    stop(&f);
}

/* A copy of a structure with 16 more bytes, the last of which is tail. */
static void *enlarge(const void *structure, size_t size, unsigned char tail)
{
    unsigned char *copy = (unsigned char *)test_allocate(size + 16);
    uint32_t struct_size = (uint32_t)size + 16;
    memcpy(copy, structure, size);
    memset(copy + size, 0, 16);
    copy[size + 15] = tail;
    memcpy(copy, &struct_size, sizeof(struct_size));
    return copy;
}

static void struct_sizes_of_inputs(void)
{
    fixture f;
    if (start(&f)) {
        sc_mesh mesh = f.input;
        sc_pose pose = f.pose;
        sc_build_options options = no_build_options();
        sc_query_options query = no_options();
        for (uint32_t size = 0; size < sizeof(sc_mesh) + 8; ++size) {
            if (size == sizeof(sc_mesh)) continue;
            mesh.struct_size = size;
            check_build(&f, &mesh, NULL, SC_ERROR_STRUCT_SIZE, "mesh");
        }
        for (uint32_t size = 0; size < sizeof(sc_pose) + 8; ++size) {
            if (size == sizeof(sc_pose)) continue;
            pose.struct_size = size;
            check_query(&f, f.model, f.workspace, &pose, NULL, SC_ERROR_STRUCT_SIZE, "pose");
        }
        /* Options have defaults throughout, so any size that holds their first members will do. */
        for (uint32_t size = 0; size < sizeof(options) + 8; ++size) {
            int fits = size >= sizeof(void *) && size % sizeof(void *) == 0;
            sc_build_options *exact;
            if (size > sizeof(options)) fits = 0;
            options = no_build_options();
            options.struct_size = size;
            if (fits) options.tree_count = 7; /* not read with SC_PARTITION_FAST */
            exact = (sc_build_options *)test_allocate(sizeof(options) + 8);
            memset(exact, 0, sizeof(options) + 8);
            memcpy(exact, &options, size < 8 ? 8 : size > sizeof(options) ? sizeof(options) : size);
            if (fits && size < sizeof(options)) /* behind an older structure is anything */
                memset((unsigned char *)exact + size, 0xee, sizeof(options) - size);
            check_build(&f, &f.input, exact, fits ? SC_OK : SC_ERROR_STRUCT_SIZE, "build options");
            free(exact);
        }
        for (uint32_t size = 0; size < sizeof(query) + 8; ++size) {
            int fits =
                size >= sizeof(void *) && size % sizeof(void *) == 0 && size <= sizeof(query);
            sc_query_options *exact = (sc_query_options *)test_allocate(sizeof(query) + 8);
            memset(exact, 0, sizeof(query) + 8);
            if (fits) memset((unsigned char *)exact + size, 0xee, sizeof(query) + 8 - size);
            exact->struct_size = size;
            if (!fits) {
                check_query(&f, f.model, f.workspace, &f.pose, exact, SC_ERROR_STRUCT_SIZE,
                            "query options");
            } else {
                sc_result result;
                memset(&result, 0, sizeof(result));
                result.struct_size = sizeof(result);
                exact->output = SC_OUTPUT_COUNT;
                CHECK_MSG(sc_query(f.model, f.workspace, &f.pose, exact, &result) == SC_OK,
                          "query options of size %u", (unsigned)size);
                CHECK(result.count == f.answer.lists[0][0].count);
            }
            free(exact);
        }
        for (int tail = 0; tail < 2; ++tail) {
            unsigned char byte = tail == 0 ? 0 : 1;
            sc_status expected = tail == 0 ? SC_OK : SC_ERROR_STRUCT_SIZE;
            void *larger = enlarge(&f.input, sizeof(f.input), byte);
            check_build(&f, (const sc_mesh *)larger, NULL, expected, "larger mesh");
            free(larger);
            options = no_build_options();
            larger = enlarge(&options, sizeof(options), byte);
            check_build(&f, &f.input, (const sc_build_options *)larger, expected, "larger options");
            free(larger);
            larger = enlarge(&f.pose, sizeof(f.pose), byte);
            if (tail != 0) {
                check_query(&f, f.model, f.workspace, (const sc_pose *)larger, NULL, expected,
                            "larger pose");
            } else {
                fixture g = f;
                memcpy(&g.pose, larger, sizeof(g.pose));
                g.pose.struct_size = sizeof(g.pose);
                CHECK(is_still_right(&g));
            }
            free(larger);
            query = no_options();
            larger = enlarge(&query, sizeof(query), byte);
            if (tail != 0)
                check_query(&f, f.model, f.workspace, &f.pose, (const sc_query_options *)larger,
                            expected, "larger query options");
            free(larger);
        }
        /* Larger structures with nothing in what the library does not know do work in a query. */
        {
            sc_result result;
            void *larger_pose = enlarge(&f.pose, sizeof(f.pose), 0);
            void *larger_query, *larger_result;
            query = no_options();
            query.output = SC_OUTPUT_COUNT;
            larger_query = enlarge(&query, sizeof(query), 0);
            memset(&result, 0, sizeof(result));
            larger_result = enlarge(&result, sizeof(result), 0);
            CHECK(sc_query(f.model, f.workspace, (const sc_pose *)larger_pose,
                           (const sc_query_options *)larger_query,
                           (sc_result *)larger_result) == SC_OK);
            memcpy(&result, larger_result, sizeof(result));
            CHECK(result.count == f.answer.lists[0][0].count);
            free(larger_pose);
            free(larger_query);
            free(larger_result);
            larger_result = enlarge(&result, sizeof(result), 1);
            CHECK(sc_query(f.model, f.workspace, &f.pose, &query, (sc_result *)larger_result) ==
                  SC_ERROR_STRUCT_SIZE);
            free(larger_result);
        }
        CHECK(is_still_right(&f));
    }
    stop(&f);
}

/* Structures that the library fills: it writes as far as their size reaches and no further. */
static void struct_sizes_of_outputs(void)
{
    fixture f;
    if (start(&f)) {
        unsigned char whole[2][512], buffer[512];
        size_t sizes[3];
        sizes[0] = sizeof(sc_model_info);
        sizes[1] = sizeof(sc_level_info);
        sizes[2] = sizeof(sc_stats);
        for (int kind = 0; kind < 3; ++kind) {
            for (uint32_t size = 0; size <= sizes[kind] + 16; ++size) {
                union {
                    uint64_t aligned[64];
                    unsigned char bytes[512];
                    uint32_t struct_size;
                    sc_model_info info;
                    sc_level_info level;
                    sc_stats stats;
                } out;
                int multiple = size % sizeof(void *) == 0 && size >= sizeof(void *);
                sc_status status, expected = multiple ? SC_OK : SC_ERROR_STRUCT_SIZE;
                uint32_t end = size < sizes[kind] ? size : (uint32_t)sizes[kind];
                memset(&out, 0xab, sizeof(out));
                if (size > sizes[kind]) memset(out.bytes + sizes[kind], 0, size - sizes[kind]);
                out.struct_size = size;
                memcpy(buffer, &out, sizeof(buffer));
                if (kind == 0) {
                    status = sc_model_get_info(f.model, &out.info);
                } else if (kind == 1) {
                    status = sc_model_get_level(f.model, 0, &out.level);
                } else {
                    sc_result result;
                    sc_query_options options = no_options();
                    options.output = SC_OUTPUT_COUNT;
                    memset(&result, 0, sizeof(result));
                    result.struct_size = sizeof(result);
                    result.stats = &out.stats;
                    status = sc_query(f.model, f.workspace, &f.pose, &options, &result);
                    CHECK(result.count == (status == SC_OK ? f.answer.lists[0][0].count : 0));
                }
                CHECK_MSG(status == expected, "structure %d of size %u: %s", kind, (unsigned)size,
                          sc_status_string(status));
                CHECK_MSG(memcmp(out.bytes + size, buffer + size, sizeof(buffer) - size) == 0,
                          "structure %d of size %u: written behind", kind, (unsigned)size);
                if (!multiple)
                    CHECK_MSG(memcmp(out.bytes, buffer, sizeof(buffer)) == 0,
                              "structure %d of size %u: written", kind, (unsigned)size);
                CHECK(out.struct_size == size);
                if (kind < 2 && size == sizes[kind]) memcpy(whole[kind], &out, sizeof(out));
                if (kind < 2 && size > sizes[kind] && multiple)
                    CHECK(memcmp(whole[kind] + 4, out.bytes + 4, end - 4) == 0);
            }
        }
        for (uint32_t size = 8; size < sizes[0]; size += 8) { /* the same members in an older one */
            union {
                unsigned char bytes[512];
                sc_model_info info;
            } out;
            out.info.struct_size = size;
            CHECK(sc_model_get_info(f.model, &out.info) == SC_OK);
            CHECK(memcmp(out.bytes + 4, whole[0] + 4, size - 4) == 0);
        }
        /* A result too short for the count, of an odd size, or without room for stats. */
        for (uint32_t size = 0; size <= sizeof(sc_result) + 8; ++size) {
            union {
                unsigned char bytes[128];
                sc_result result;
            } out, before;
            sc_status status;
            sc_query_options options = no_options();
            int is_odd = size % sizeof(void *) != 0;
            options.output = SC_OUTPUT_COUNT;
            memset(&out, 0, sizeof(out));
            if (size < sizeof(sc_result)) memset(out.bytes + size, 0xcd, sizeof(out) - size);
            out.result.struct_size = size;
            memcpy(&before, &out, sizeof(before));
            status = sc_query(f.model, f.workspace, &f.pose, &options, &out.result);
            if (size < 16 || is_odd) {
                CHECK_MSG(status == SC_ERROR_STRUCT_SIZE, "result of size %u", (unsigned)size);
                CHECK(memcmp(&before, &out, sizeof(out)) == 0);
            } else if (size >= 32) {
                CHECK_MSG(status == SC_OK, "result of size %u: %s", (unsigned)size,
                          sc_status_string(status));
                CHECK(out.result.count == f.answer.lists[0][0].count);
                CHECK(memcmp(out.bytes + size, before.bytes + size, sizeof(out) - size) == 0);
            }
        }
        CHECK(is_still_right(&f));
    }
    stop(&f);
}

static void enumerators(void)
{
    static const uint32_t wrong[] = {4, 5, 0x7fffffffu, 0xffffffffu};
    fixture f;
    if (start(&f)) {
        for (int w = 0; w < 4; ++w) {
            uint32_t value = wrong[w];
            sc_mesh mesh = f.input;
            sc_pose pose = f.pose;
            sc_build_options build = no_build_options();
            sc_query_options query;
            mesh.position_type = value;
            check_build(&f, &mesh, NULL, SC_ERROR_OPTION, "mesh position_type");
            mesh = f.input;
            mesh.index_type = value;
            check_build(&f, &mesh, NULL, SC_ERROR_OPTION, "index_type");
            mesh = f.input;
            mesh.reserved = value;
            check_build(&f, &mesh, NULL, SC_ERROR_OPTION, "mesh reserved");
            build.weld = value;
            check_build(&f, &f.input, &build, SC_ERROR_OPTION, "weld");
            build.weld = 0;
            build.partition = value;
            check_build(&f, &f.input, &build, SC_ERROR_OPTION, "partition");
            build = no_build_options();
            build.rest = value;
            check_build(&f, &f.input, &build, SC_ERROR_OPTION, "rest");
            build = no_build_options();
            build.content = value;
            check_build(&f, &f.input, &build, SC_ERROR_OPTION, "build content");
            pose.position_type = value;
            check_query(&f, f.model, f.workspace, &pose, NULL, SC_ERROR_OPTION,
                        "pose position_type");
            query = no_options();
            query.output = value;
            check_query(&f, f.model, f.workspace, &f.pose, &query, SC_ERROR_OPTION, "output");
            query = no_options();
            query.pairs = value;
            check_query(&f, f.model, f.workspace, &f.pose, &query, SC_ERROR_OPTION, "pairs");
            query = no_options();
            query.contact = value;
            check_query(&f, f.model, f.workspace, &f.pose, &query, SC_ERROR_OPTION, "contact");
            query = no_options();
            query.method = value;
            check_query(&f, f.model, f.workspace, &f.pose, &query, SC_ERROR_OPTION, "method");
            query = no_options();
            query.contour = value;
            check_query(&f, f.model, f.workspace, &f.pose, &query, SC_ERROR_OPTION, "contour");
            query = no_options();
            query.rest_cache = value;
            check_query(&f, f.model, f.workspace, &f.pose, &query, SC_ERROR_OPTION, "rest_cache");
            query = no_options();
            query.simd = value;
            check_query(&f, f.model, f.workspace, &f.pose, &query, SC_ERROR_OPTION, "simd");
        }
    }
    stop(&f);
}

static void weld_maps(void)
{
    fixture f;
    if (start(&f)) {
        uint32_t count = f.mesh.vertex_count;
        uint32_t *map = (uint32_t *)test_allocate(count * sizeof(uint32_t));
        sc_build_options options = no_build_options();
        options.weld = SC_WELD_MAP;
        options.weld_map = map;
        for (uint32_t v = 0; v < count; ++v) map[v] = v;
        check_build(&f, &f.input, &options, SC_OK, "identity");
        map[3] = count;
        check_build(&f, &f.input, &options, SC_ERROR_WELD_MAP, "just out of range");
        map[3] = SC_NONE;
        check_build(&f, &f.input, &options, SC_ERROR_WELD_MAP, "far out of range");
        map[3] = 2;
        map[2] = 1;
        check_build(&f, &f.input, &options, SC_ERROR_WELD_MAP, "a chain");
        map[2] = 3;
        check_build(&f, &f.input, &options, SC_ERROR_WELD_MAP, "a circle");
        map[2] = 2;
        map[3] = 3;
        map[count - 1] = 0;
        map[0] = 1;
        check_build(&f, &f.input, &options, SC_ERROR_WELD_MAP, "a chain from the last");
        CHECK(is_still_right(&f));
        free(map);
    }
    stop(&f);
}

static void orders(void)
{
    fixture f;
    if (start(&f)) {
        uint32_t count = f.mesh.triangle_count;
        uint32_t *order = (uint32_t *)test_allocate(count * sizeof(uint32_t));
        sc_build_options options = no_build_options();
        options.partition = SC_PARTITION_ORDER;
        options.order = order;
        for (uint32_t t = 0; t < count; ++t) order[t] = count - 1 - t;
        check_build(&f, &f.input, &options, SC_OK, "backwards");
        order[5] = order[6];
        check_build(&f, &f.input, &options, SC_ERROR_TREE, "a triangle twice");
        order[5] = count;
        check_build(&f, &f.input, &options, SC_ERROR_TREE, "just out of range");
        order[5] = SC_NONE;
        check_build(&f, &f.input, &options, SC_ERROR_TREE, "far out of range");
        memset(order, 0, count * sizeof(uint32_t));
        check_build(&f, &f.input, &options, SC_ERROR_TREE, "nothing but one triangle");
        CHECK(is_still_right(&f));
        free(order);
    }
    stop(&f);
}

static sc_tree_node leaf(uint32_t first, uint32_t count)
{
    sc_tree_node n;
    n.left = n.right = SC_NONE;
    n.first = first;
    n.count = count;
    return n;
}

static sc_tree_node inner(uint32_t left, uint32_t right)
{
    sc_tree_node n;
    n.left = left;
    n.right = right;
    n.first = n.count = 0;
    return n;
}

/* A tree of leaves of one triangle that is depth nodes deep; the last leaf has the rest. */
static uint32_t make_ladder(sc_tree_node *tree, uint32_t depth, uint32_t count)
{
    uint32_t node = 0;
    for (uint32_t d = 1; d < depth; ++d) {
        tree[node] = inner(node + 1, node + 2);
        tree[node + 1] = leaf(d - 1, 1);
        node += 2;
    }
    tree[node] = leaf(depth - 1, count - depth + 1);
    return node + 1;
}

static void trees(void)
{
    fixture f;
    if (start(&f)) {
        uint32_t count = f.mesh.triangle_count;
        uint32_t *order = (uint32_t *)test_allocate(count * sizeof(uint32_t));
        sc_tree_node tree[300];
        sc_build_options options = no_build_options();
        for (uint32_t t = 0; t < count; ++t) order[t] = t;
        options.partition = SC_PARTITION_TREE;
        options.order = order;
        options.tree = tree;
        options.tree_count = 0;
        tree[0] = leaf(0, count);
        check_build(&f, &f.input, &options, SC_ERROR_TREE, "no nodes");
        options.tree_count = 1;
        check_build(&f, &f.input, &options, SC_OK, "one leaf");
        tree[0] = leaf(0, count - 1);
        check_build(&f, &f.input, &options, SC_ERROR_TREE, "a triangle in no leaf");
        tree[0] = leaf(1, count);
        check_build(&f, &f.input, &options, SC_ERROR_TREE, "a leaf beyond the end");
        tree[0] = leaf(0xffffff00u, 0x100u + count);
        check_build(&f, &f.input, &options, SC_ERROR_TREE, "a leaf that overflows");
        tree[0] = leaf(0, 0);
        check_build(&f, &f.input, &options, SC_ERROR_TREE, "an empty leaf");
        tree[0] = inner(0, 0);
        check_build(&f, &f.input, &options, SC_ERROR_TREE, "its own child");
        tree[0] = inner(1, 2);
        check_build(&f, &f.input, &options, SC_ERROR_TREE, "children that do not exist");

        options.tree_count = 3;
        tree[1] = leaf(0, 70);
        tree[2] = leaf(70, count - 70);
        check_build(&f, &f.input, &options, SC_OK, "two leaves");
        tree[0] = inner(2, 1);
        check_build(&f, &f.input, &options, SC_OK, "two leaves, the other way round");
        tree[0] = inner(1, 1);
        check_build(&f, &f.input, &options, SC_ERROR_TREE, "the same child twice");
        tree[0] = inner(1, SC_NONE);
        check_build(&f, &f.input, &options, SC_ERROR_TREE, "no right child");
        tree[0] = inner(SC_NONE, 2);
        check_build(&f, &f.input, &options, SC_ERROR_TREE, "no left child");
        tree[0] = inner(1, 3);
        check_build(&f, &f.input, &options, SC_ERROR_TREE, "a child out of range");
        tree[0] = inner(1, 2);
        tree[2] = leaf(69, count - 69);
        check_build(&f, &f.input, &options, SC_ERROR_TREE, "overlap");
        tree[2] = leaf(71, count - 71);
        check_build(&f, &f.input, &options, SC_ERROR_TREE, "a gap");
        tree[2] = leaf(0, 70);
        check_build(&f, &f.input, &options, SC_ERROR_TREE, "twice the same leaf");
        tree[2] = inner(0, 1);
        check_build(&f, &f.input, &options, SC_ERROR_TREE, "a circle");
        options.tree_count = 5;
        tree[1] = inner(3, 4);
        tree[2] = inner(3, 4);
        tree[3] = leaf(0, 70);
        tree[4] = leaf(70, count - 70);
        check_build(&f, &f.input, &options, SC_ERROR_TREE, "children with two parents");

        options.tree_count = make_ladder(tree, 60, count);
        check_build(&f, &f.input, &options, SC_OK, "as deep as allowed");
        options.tree_count = make_ladder(tree, 61, count);
        check_build(&f, &f.input, &options, SC_ERROR_TREE, "one node too deep");
        options.tree_count = make_ladder(tree, 140, count);
        check_build(&f, &f.input, &options, SC_ERROR_TREE, "much too deep");
        options.tree_count = make_ladder(tree, 20, count);
        order[7] = 8;
        check_build(&f, &f.input, &options, SC_ERROR_TREE, "an order that is none");
        CHECK(is_still_right(&f));
        free(order);
    }
    stop(&f);
}

/* How the function below fails, from which call on; and what it spoils meanwhile. */
typedef struct wrong {
    int how, calls_before;
    double *positions;
} wrong;

static sc_status wrong_bisect(void *user, const sc_dual_graph *graph, uint32_t left_target,
                              uint8_t *side)
{
    wrong *w = (wrong *)user;
    input_bisect(NULL, graph, left_target, side);
    if (w->calls_before-- > 0) return SC_OK;
    if (w->how == 0) return SC_ERROR_PARTITION;
    if (w->how == 1) return SC_ERROR_UNSUPPORTED;
    if (w->how == 2) return SC_ERROR_MEMORY;
    if (w->how == 3) side[graph->node_count - 1] = 2;
    if (w->how == 4) memset(side, 0, graph->node_count);
    if (w->how == 5) memset(side, 1, graph->node_count);
    if (w->how == 6) w->positions[1] = (double)NAN;
    if (w->how == 7) w->positions[1] = HUGE_VAL;
    return SC_OK;
}

static void bisections(void)
{
    static const sc_status expected[] = {
        SC_ERROR_PARTITION,  SC_ERROR_UNSUPPORTED, SC_ERROR_MEMORY,
        SC_ERROR_PARTITION,  SC_ERROR_PARTITION,   SC_ERROR_PARTITION,
        SC_ERROR_NOT_FINITE, SC_ERROR_NOT_FINITE,  SC_OK};
    fixture f;
    if (start(&f)) {
        sc_build_options options = no_build_options();
        double old = f.mesh.positions[1];
        wrong w;
        w.positions = f.mesh.positions;
        options.partition = SC_PARTITION_BISECT;
        options.rest = SC_REST_MARKED; /* reads positions again */
        options.bisect = wrong_bisect;
        options.bisect_user = &w;
        for (w.how = 0; w.how < 9; ++w.how)
            for (int before = 0; before < 4; ++before) {
                w.calls_before = before;
                check_build(&f, &f.input, &options, expected[w.how], "bisect");
                CHECK_MSG(w.calls_before < 0, "%d", before);
                f.mesh.positions[1] = old;
            }
        CHECK(is_still_right(&f));
    }
    stop(&f);
}

static void workspaces(void)
{
    fixture f;
    if (start(&f)) {
        soup other = soup_cloth(3, 3);
        sc_mesh mesh = input_plain_mesh(&other);
        sc_model *model = NULL;
        sc_workspace *workspace = NULL;
        uint64_t size = 0;
        unsigned char *memory, *aligned;
        if (CHECK(sc_build(&mesh, NULL, &model) == SC_OK) &&
            CHECK(sc_workspace_create(model, NULL, &workspace) == SC_OK)) {
            check_query(&f, f.model, workspace, &f.pose, NULL, SC_ERROR_WORKSPACE,
                        "too small a model");
            mesh.vertex_count = f.pose.vertex_count;
            check_query(&f, model, f.workspace, &f.pose, NULL, SC_ERROR_WORKSPACE,
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
        CHECK(is_right(&f, f.model, workspace));
        sc_workspace_free(workspace); /* does nothing */
        CHECK(is_right(&f, f.model, workspace));
        CHECK(is_still_right(&f));
        for (uint64_t i = 0; i < SC_ALIGNMENT; ++i) {
            if (memory + i < aligned) CHECK(memory[i] == 0x5a);
            if (aligned + size + i < memory + size + 2 * SC_ALIGNMENT)
                CHECK(aligned[size + i] == 0x5a);
        }
        free(memory);
    }
    stop(&f);
}

static void levels_and_patches(void)
{
    fixture f;
    if (start(&f)) {
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
        CHECK(is_still_right(&f));
    }
    stop(&f);
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
             SC_TEST(struct_sizes_of_inputs), SC_TEST(struct_sizes_of_outputs),
             SC_TEST(enumerators), SC_TEST(weld_maps), SC_TEST(orders), SC_TEST(trees),
             SC_TEST(bisections), SC_TEST(workspaces), SC_TEST(levels_and_patches),
             SC_TEST(information), SC_TEST(statuses_and_version))
