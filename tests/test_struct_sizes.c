/*
 * struct_size of all structures that are read and of all that are filled: older and newer
 * callers than the library, and sizes that none had.
 *
 * SPDX-License-Identifier: MIT
 */
#include <stdlib.h>
#include <string.h>

#include "harness.h"
#include "input_fixture.h"
#include "starcontour.h"

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
    input_fixture f;
    if (input_fixture_start(&f)) {
        sc_mesh mesh = f.input;
        sc_pose pose = f.pose;
        sc_build_options options = input_fixture_no_build_options();
        sc_query_options query = input_fixture_no_options();
        for (uint32_t size = 0; size < sizeof(sc_mesh) + 8; ++size) {
            if (size == sizeof(sc_mesh)) continue;
            mesh.struct_size = size;
            input_fixture_check_build(&f, &mesh, NULL, SC_ERROR_STRUCT_SIZE, "mesh");
        }
        for (uint32_t size = 0; size < sizeof(sc_pose) + 8; ++size) {
            if (size == sizeof(sc_pose)) continue;
            pose.struct_size = size;
            input_fixture_check_query(&f, f.model, f.workspace, &pose, NULL, SC_ERROR_STRUCT_SIZE,
                                      "pose");
        }
        /* Options have defaults throughout, so any size that holds their first members will do. */
        for (uint32_t size = 0; size < sizeof(options) + 8; ++size) {
            int fits = size >= sizeof(void *) && size % sizeof(void *) == 0;
            sc_build_options *exact;
            if (size > sizeof(options)) fits = 0;
            options = input_fixture_no_build_options();
            options.struct_size = size;
            if (fits) options.tree_count = 7; /* not read with SC_PARTITION_FAST */
            exact = (sc_build_options *)test_allocate(sizeof(options) + 8);
            memset(exact, 0, sizeof(options) + 8);
            memcpy(exact, &options, size < 8 ? 8 : size > sizeof(options) ? sizeof(options) : size);
            if (fits && size < sizeof(options)) /* behind an older structure is anything */
                memset((unsigned char *)exact + size, 0xee, sizeof(options) - size);
            input_fixture_check_build(&f, &f.input, exact, fits ? SC_OK : SC_ERROR_STRUCT_SIZE,
                                      "build options");
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
                input_fixture_check_query(&f, f.model, f.workspace, &f.pose, exact,
                                          SC_ERROR_STRUCT_SIZE, "query options");
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
            input_fixture_check_build(&f, (const sc_mesh *)larger, NULL, expected, "larger mesh");
            free(larger);
            options = input_fixture_no_build_options();
            larger = enlarge(&options, sizeof(options), byte);
            input_fixture_check_build(&f, &f.input, (const sc_build_options *)larger, expected,
                                      "larger options");
            free(larger);
            larger = enlarge(&f.pose, sizeof(f.pose), byte);
            if (tail != 0) {
                input_fixture_check_query(&f, f.model, f.workspace, (const sc_pose *)larger, NULL,
                                          expected, "larger pose");
            } else {
                input_fixture g = f;
                memcpy(&g.pose, larger, sizeof(g.pose));
                g.pose.struct_size = sizeof(g.pose);
                CHECK(input_fixture_is_still_right(&g));
            }
            free(larger);
            query = input_fixture_no_options();
            larger = enlarge(&query, sizeof(query), byte);
            if (tail != 0)
                input_fixture_check_query(&f, f.model, f.workspace, &f.pose,
                                          (const sc_query_options *)larger, expected,
                                          "larger query options");
            free(larger);
        }
        /* Larger structures with nothing in what the library does not know do work in a query. */
        {
            sc_result result;
            void *larger_pose = enlarge(&f.pose, sizeof(f.pose), 0);
            void *larger_query, *larger_result;
            query = input_fixture_no_options();
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
        CHECK(input_fixture_is_still_right(&f));
    }
    input_fixture_stop(&f);
}

/* Options of a step of any size that some version had or will have: what is behind is not read. */
static void struct_sizes_of_steps(void)
{
    input_fixture f;
    if (input_fixture_start(&f)) {
        sc_workspace *workspace = NULL;
        sc_workspace_options w;
        sc_step_options options;
        sc_step_result wanted, result;
        memset(&w, 0, sizeof(w));
        w.struct_size = sizeof(w);
        w.flags = SC_WORKSPACE_STEP;
        CHECK(sc_workspace_create_for(f.model, &w, &workspace) == SC_OK);
        memset(&options, 0, sizeof(options));
        options.struct_size = sizeof(options);
        options.output = SC_OUTPUT_COUNT;
        memset(&wanted, 0, sizeof(wanted));
        wanted.struct_size = sizeof(wanted);
        CHECK(sc_query_step(f.model, workspace, &f.pose, &f.pose, &options, &wanted) == SC_OK);
        CHECK(wanted.vertex_face_count + wanted.edge_edge_count > 0);
        for (uint32_t size = 8; size <= sizeof(options); size += (uint32_t)sizeof(void *)) {
            sc_step_options *exact = (sc_step_options *)test_allocate(sizeof(options));
            memset(exact, 0xee, sizeof(options));
            memcpy(exact, &options, size);
            exact->struct_size = size;
            result = wanted;
            result.vertex_face_count = result.edge_edge_count = 0;
            CHECK_MSG(sc_query_step(f.model, workspace, &f.pose, &f.pose, exact, &result) ==
                              SC_OK &&
                          result.vertex_face_count == wanted.vertex_face_count &&
                          result.edge_edge_count == wanted.edge_edge_count,
                      "step options of size %u", (unsigned)size);
            free(exact);
        }
        sc_workspace_free(workspace);
    }
    input_fixture_stop(&f);
}

/* Structures that the library fills: it writes as far as their size reaches and no further. */
static void struct_sizes_of_outputs(void)
{
    input_fixture f;
    if (input_fixture_start(&f)) {
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
                    sc_query_options options = input_fixture_no_options();
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
            sc_query_options options = input_fixture_no_options();
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
        CHECK(input_fixture_is_still_right(&f));
    }
    input_fixture_stop(&f);
}

SC_TEST_MAIN(SC_TEST(struct_sizes_of_inputs), SC_TEST(struct_sizes_of_steps),
             SC_TEST(struct_sizes_of_outputs))
