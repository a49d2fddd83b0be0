/*
 * Models for boxes (SC_MODEL_BOXES): the same pairs as the oracle finds and as full models give, by
 * queries, steps, filters, records and several workers; what they have and what they refuse; and
 * builds that run out of memory.
 *
 * SPDX-License-Identifier: MIT
 */
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "harness.h"
#include "inputs.h"
#include "oracle.h"
#include "shapes.h"
#include "starcontour.h"

static sc_model *build(const soup *mesh, const sc_build_options *options, uint32_t content)
{
    sc_mesh m = input_plain_mesh(mesh);
    sc_build_options o;
    sc_model *model = NULL;
    memset(&o, 0, sizeof(o));
    if (options) o = *options;
    o.struct_size = sizeof(o);
    o.content = content;
    if (content == SC_MODEL_BOXES) o.rest = SC_REST_UNMARKED;
    CHECK(sc_build(&m, &o, &model) == SC_OK);
    return model;
}

static sc_query_options ask_for(uint32_t pairs, uint32_t contact)
{
    sc_query_options options;
    memset(&options, 0, sizeof(options));
    options.struct_size = sizeof(options);
    options.pairs = pairs;
    options.contact = contact;
    return options;
}

/* All pairs of a query, to be freed. */
static sc_pair *list(const sc_model *model, sc_workspace *workspace, const sc_pose *pose,
                     const sc_query_options *options, uint64_t *count)
{
    sc_result result;
    memset(&result, 0, sizeof(result));
    result.struct_size = sizeof(result);
    sc_query(model, workspace, pose, options, &result);
    result.capacity = *count = result.count;
    result.pairs = (sc_pair *)test_allocate((size_t)result.count * sizeof(sc_pair) + 1);
    CHECK(sc_query(model, workspace, pose, options, &result) == SC_OK && result.count == *count);
    return result.pairs;
}

/* ---- the same pairs ---- */

static int is_expected(const sc_pair *pairs, uint64_t count, const oracle_list *expected)
{
    return count == expected->count &&
           (count == 0 || memcmp(pairs, expected->pairs, (size_t)count * sizeof(sc_pair)) == 0);
}

static void pairs_are_those_of_the_oracle(void)
{
    uint64_t found = 0;
    for (uint32_t round = 0; round < test_iterations_at_least(240, 24); ++round) {
        const char *name = "soup";
        uint64_t state = test_random_state();
        soup mesh = round % 3 == 0 ? soup_on_grid(3) : soup_any_mesh(150, &name);
        input_choices choices = input_choose(&mesh, round % 3, test_random_below(4));
        uint32_t *map = input_weld_of(&choices, &mesh), n = mesh.vertex_count;
        sc_model *model = build(&mesh, &choices.options, SC_MODEL_BOXES);
        sc_workspace *workspace = NULL;
        sc_pose pose = input_plain_pose(mesh.positions, n);
        oracle_answer answer;
        if (round % 3) soup_any_pose(mesh.positions, n);
        oracle_solve(mesh.positions, n, mesh.triangles, mesh.triangle_count, map, &answer);
        if (CHECK(sc_workspace_create(model, NULL, &workspace) == SC_OK))
            for (uint32_t kind = 0; kind < 4; ++kind) {
                sc_query_options options = ask_for(kind / 2, kind % 2);
                for (uint32_t simd = SC_SIMD_BEST; simd <= SC_SIMD_BASE; ++simd) {
                    uint64_t count;
                    sc_pair *pairs;
                    options.simd = simd;
                    options.method = test_random_below(2) ? SC_METHOD_AABB : SC_METHOD_DEFAULT;
                    pairs = list(model, workspace, &pose, &options, &count);
                    CHECK_MSG(is_expected(pairs, count, &answer.lists[kind / 2][kind % 2]),
                              "%s, kind %" PRIu32 ": %" PRIu64 " pairs; started at %" PRIu64, name,
                              kind, count, state);
                    found += count;
                    free(pairs);
                }
            }
        oracle_free(&answer);
        sc_workspace_free(workspace);
        sc_model_free(model);
        free(map);
        input_free_choices(&choices);
        soup_free(&mesh);
    }
    CHECK(found > 1000);
}

/* Runs the parts of a job in the caller's thread, as if by two workers in turn. */
static void *enqueue(void *user, void (*run)(void *context, uint32_t part, uint32_t worker),
                     void *context, uint32_t count)
{
    ++*(uint64_t *)user;
    for (uint32_t part = 0; part < count; ++part) run(context, part, part % 2);
    return NULL;
}

static void finish(void *user, void *task)
{
    (void)user;
    (void)task;
}

/* Beside a full model of the same mesh, one large enough for several workers and for many
   levels. */
static void pairs_are_those_of_full_models(void)
{
    soup mesh = soup_sphere(60, 60);
    uint32_t n = mesh.vertex_count;
    uint64_t jobs = 0, found = 0;
    sc_tasks tasks = {sizeof(sc_tasks), 2, enqueue, finish, NULL};
    sc_model *full = build(&mesh, NULL, SC_MODEL_FULL), *boxes = build(&mesh, NULL, SC_MODEL_BOXES);
    sc_workspace_options how;
    sc_workspace *of_full = NULL, *of_boxes = NULL;
    sc_pose pose = input_plain_pose(mesh.positions, n);
    tasks.user = &jobs;
    memset(&how, 0, sizeof(how));
    how.struct_size = sizeof(how);
    how.workers = 2;
    CHECK(sc_workspace_create(full, NULL, &of_full) == SC_OK);
    CHECK(sc_workspace_create_for(boxes, &how, &of_boxes) == SC_OK);
    for (uint32_t round = 0; round < 4; ++round) {
        for (uint32_t i = 0; i < 16; ++i) {
            sc_filter filter;
            sc_query_options options = ask_for(i % 2, i / 2 % 2);
            uint64_t counts[2];
            sc_pair *pairs[2];
            memset(&filter, 0, sizeof(filter));
            filter.struct_size = sizeof(filter);
            filter.ignore_rings = 1 + i % 5;
            if (i & 4) options.filter = &filter;
            pairs[0] = list(full, of_full, &pose, &options, &counts[0]);
            if (i & 8) options.tasks = &tasks;
            pairs[1] = list(boxes, of_boxes, &pose, &options, &counts[1]);
            CHECK_MSG(counts[0] == counts[1] &&
                          memcmp(pairs[0], pairs[1], (size_t)counts[0] * sizeof(sc_pair)) == 0,
                      "%" PRIu64 " and %" PRIu64 " pairs", counts[0], counts[1]);
            found += counts[0];
            for (int k = 0; k < 2; ++k) free(pairs[k]);
        }
        soup_smooth(mesh.positions, n, 0.3);
        soup_noise(mesh.positions, n, 0.01);
    }
    CHECK(found > 1000 && jobs > 0);
    sc_workspace_free(of_full);
    sc_workspace_free(of_boxes);
    sc_model_free(full);
    sc_model_free(boxes);
    soup_free(&mesh);
}

/* ---- steps ---- */

enum { STEP_ROOM = 20000 };

typedef struct step_lists {
    sc_pair pairs[2][STEP_ROOM];
    double times[2][STEP_ROOM];
    sc_step_result result;
} step_lists;

static sc_status ask_step(const sc_model *model, sc_workspace *workspace, const double *start,
                          const double *end, uint32_t n, uint32_t method, step_lists *lists)
{
    sc_pose from = input_plain_pose(start, n), to = input_plain_pose(end, n);
    sc_step_options options;
    memset(&options, 0, sizeof(options));
    options.struct_size = sizeof(options);
    options.times = SC_STEP_TIMES_EACH;
    options.method = method;
    options.separation = 0.003;
    memset(lists, 0, sizeof(*lists));
    lists->result.struct_size = sizeof(lists->result);
    lists->result.vertex_face_capacity = lists->result.edge_edge_capacity = STEP_ROOM;
    lists->result.vertex_faces = lists->pairs[0];
    lists->result.edge_edges = lists->pairs[1];
    lists->result.vertex_face_times = lists->times[0];
    lists->result.edge_edge_times = lists->times[1];
    return sc_query_step(model, workspace, &from, &to, &options, &lists->result);
}

static void steps_are_those_of_full_models(void)
{
    static step_lists a, b;
    uint64_t found = 0;
    for (uint32_t round = 0; round < test_iterations(30); ++round) {
        static const uint32_t methods[] = {SC_STEP_METHOD_DEFAULT, SC_STEP_METHOD_TWO_BOXES,
                                           SC_STEP_METHOD_SWEPT};
        const char *name;
        soup mesh = soup_any_mesh(100, &name), moved = soup_copy(&mesh);
        uint32_t n = mesh.vertex_count;
        sc_model *models[2];
        sc_workspace *workspaces[2] = {NULL, NULL};
        soup_any_pose(moved.positions, n);
        for (uint32_t k = 0; k < 2; ++k) {
            sc_workspace_options how;
            memset(&how, 0, sizeof(how));
            how.struct_size = sizeof(how);
            how.flags = SC_WORKSPACE_STEP;
            models[k] = build(&mesh, NULL, k ? SC_MODEL_BOXES : SC_MODEL_FULL);
            CHECK(sc_workspace_create_for(models[k], &how, &workspaces[k]) == SC_OK);
        }
        CHECK(ask_step(models[0], workspaces[0], mesh.positions, moved.positions, n,
                       SC_STEP_METHOD_DEFAULT, &a) == SC_OK);
        CHECK(ask_step(models[1], workspaces[1], mesh.positions, moved.positions, n,
                       methods[round % 3], &b) == SC_OK);
        CHECK_MSG(a.result.vertex_face_count == b.result.vertex_face_count &&
                      a.result.edge_edge_count == b.result.edge_edge_count &&
                      a.result.earliest == b.result.earliest &&
                      memcmp(a.pairs, b.pairs, sizeof(a.pairs)) == 0 &&
                      memcmp(a.times, b.times, sizeof(a.times)) == 0,
                  "%s: %" PRIu64 " and %" PRIu64 " pairs", name, a.result.edge_edge_count,
                  b.result.edge_edge_count);
        found += a.result.edge_edge_count;
        for (int k = 0; k < 2; ++k) {
            sc_workspace_free(workspaces[k]);
            sc_model_free(models[k]);
        }
        soup_free(&mesh);
        soup_free(&moved);
    }
    CHECK(found > 100);
}

/* ---- what such models have ---- */

static sc_model_info info_of(const sc_model *model)
{
    sc_model_info info;
    memset(&info, 0, sizeof(info));
    info.struct_size = sizeof(info);
    CHECK(sc_model_get_info(model, &info) == SC_OK);
    return info;
}

static void they_are_small(void)
{
    soup mesh = soup_cloth(60, 60);
    sc_model *full = build(&mesh, NULL, SC_MODEL_FULL), *boxes = build(&mesh, NULL, SC_MODEL_BOXES);
    sc_model_info f = info_of(full), b = info_of(boxes);
    uint32_t *patches = (uint32_t *)test_allocate(mesh.triangle_count * sizeof(uint32_t));
    uint32_t *sizes = (uint32_t *)test_allocate(mesh.triangle_count * sizeof(uint32_t));
    CHECK(f.node_count > 0 && b.node_count == 0 && b.segment_count == 0);
    CHECK(b.triangle_count == f.triangle_count && b.point_count == f.point_count);
    CHECK(b.edge_count == f.edge_count && b.boundary_edges == f.boundary_edges);
    CHECK(b.component_count == 1 && b.irregular_edges == 0);
    CHECK_MSG(3 * b.model_bytes < 2 * f.model_bytes && b.workspace_bytes < f.workspace_bytes,
              "models of %" PRIu64 " and %" PRIu64 " bytes", b.model_bytes, f.model_bytes);
    CHECK(b.peak_bytes < f.peak_bytes);
    CHECK_MSG(5 * b.leaf_count < 6 * f.leaf_count, "%" PRIu32 " leaf clusters", b.leaf_count);
    for (uint32_t level = 0; level < b.level_count; ++level) {
        sc_level_info l;
        memset(&l, 0xff, sizeof(l));
        l.struct_size = sizeof(l);
        CHECK(sc_model_get_level(boxes, level, &l) == SC_OK && l.patch_count > 0);
        CHECK(level > 0 || l.patch_count == 1);
        CHECK(l.connected_patches == 0 && l.segment_count == 0 && l.self_nodes == 0);
        CHECK(l.pair_nodes == 0 && l.self_oriented == 0 && l.pair_culled == 0);
        CHECK(sc_model_get_patches(boxes, level, patches, mesh.triangle_count) == SC_OK);
        memset(sizes, 0, mesh.triangle_count * sizeof(uint32_t));
        for (uint32_t t = 0; t < mesh.triangle_count; ++t)
            if (CHECK(patches[t] < l.patch_count)) ++sizes[patches[t]];
        for (uint32_t p = 0; p < l.patch_count; ++p)
            CHECK(sizes[p] > 0 && (sizes[p] <= 16 || level + 1 < b.level_count));
    }
    CHECK(sc_model_get_level(boxes, b.level_count, NULL) == SC_ERROR_NULL);
    free(patches);
    free(sizes);
    sc_model_free(full);
    sc_model_free(boxes);
    soup_free(&mesh);
}

/* A model for boxes is another one than a full model of the same order. */
static void hashes_differ(void)
{
    soup mesh = soup_cloth(9, 9);
    input_choices choices = input_choose(&mesh, SC_WELD_REST, SC_PARTITION_ORDER);
    sc_model *full = build(&mesh, &choices.options, SC_MODEL_FULL);
    sc_model *boxes = build(&mesh, &choices.options, SC_MODEL_BOXES);
    sc_model *again = build(&mesh, &choices.options, SC_MODEL_BOXES);
    sc_pose pose = input_plain_pose(mesh.positions, mesh.vertex_count);
    sc_workspace *workspace = NULL;
    sc_result result;
    memset(&result, 0, sizeof(result));
    result.struct_size = sizeof(result);
    CHECK(info_of(full).topology_hash != info_of(boxes).topology_hash);
    CHECK(info_of(again).topology_hash == info_of(boxes).topology_hash);
    CHECK(sc_workspace_create(full, NULL, &workspace) == SC_OK);
    CHECK(sc_query(boxes, workspace, &pose, NULL, &result) == SC_ERROR_WORKSPACE);
    CHECK(sc_query(full, workspace, &pose, NULL, &result) == SC_OK);
    sc_workspace_free(workspace);
    CHECK(sc_workspace_create(boxes, NULL, &workspace) == SC_OK);
    CHECK(sc_query(full, workspace, &pose, NULL, &result) == SC_ERROR_WORKSPACE);
    CHECK(sc_query(again, workspace, &pose, NULL, &result) == SC_OK);
    sc_workspace_free(workspace);
    sc_model_free(full);
    sc_model_free(boxes);
    sc_model_free(again);
    input_free_choices(&choices);
    soup_free(&mesh);
}

/* ---- what they refuse ---- */

static void culling_is_refused(void)
{
    soup mesh = soup_cloth(12, 12);
    sc_model *model = build(&mesh, NULL, SC_MODEL_BOXES);
    sc_pose pose = input_plain_pose(mesh.positions, mesh.vertex_count);
    sc_workspace_options how;
    sc_workspace *workspace = NULL;
    memset(&how, 0, sizeof(how));
    how.struct_size = sizeof(how);
    how.flags = SC_WORKSPACE_STEP;
    CHECK(sc_workspace_create_for(model, &how, &workspace) == SC_OK);
    for (uint32_t method = 0; method <= SC_METHOD_AABB; ++method)
        for (uint32_t contour = 0; contour <= SC_CONTOUR_EXACT; ++contour) {
            sc_query_options options = ask_for(SC_PAIRS_TRIANGLE, SC_CONTACT_TOUCHING);
            sc_result result;
            sc_status status;
            uint64_t size = 0;
            int culls = method == SC_METHOD_SCTT || method == SC_METHOD_AABB_SCTT ||
                        (method == SC_METHOD_DEFAULT && contour != SC_CONTOUR_DEFAULT);
            options.method = method;
            options.contour = contour;
            memset(&result, 0, sizeof(result));
            result.struct_size = sizeof(result);
            result.count = result.verdict = 7;
            status = sc_query(model, workspace, &pose, &options, &result);
            CHECK_MSG(status == (culls ? SC_ERROR_BOXES_ONLY : SC_OK),
                      "method %" PRIu32 ", contour %" PRIu32 ": %s", method, contour,
                      sc_status_string(status));
            CHECK(result.count == 0);
            CHECK(result.verdict == (culls ? SC_VERDICT_NONE : SC_VERDICT_CLEAN));
            CHECK(sc_record_size(model, &pose, &options, &size) == status);
        }
    for (uint32_t method = 0; method <= SC_STEP_METHOD_SWEPT; ++method)
        for (uint32_t contour = 0; contour <= SC_CONTOUR_EXACT; ++contour) {
            sc_step_options options;
            sc_step_result result;
            sc_status status;
            int culls = method == SC_STEP_METHOD_SCTT ||
                        (method == SC_STEP_METHOD_DEFAULT && contour != SC_CONTOUR_DEFAULT);
            memset(&options, 0, sizeof(options));
            options.struct_size = sizeof(options);
            options.method = method;
            options.contour = contour;
            options.output = SC_OUTPUT_COUNT;
            memset(&result, 0, sizeof(result));
            result.struct_size = sizeof(result);
            status = sc_query_step(model, workspace, &pose, &pose, &options, &result);
            CHECK_MSG(status == (culls ? SC_ERROR_BOXES_ONLY : SC_OK),
                      "step method %" PRIu32 ", contour %" PRIu32 ": %s", method, contour,
                      sc_status_string(status));
        }
    sc_workspace_free(workspace);
    sc_model_free(model);
    soup_free(&mesh);
}

static void options_are_checked(void)
{
    soup mesh = soup_cloth(3, 3);
    sc_mesh m = input_plain_mesh(&mesh);
    sc_build_options options;
    sc_model *model = (sc_model *)&m; /* anything but NULL */
    memset(&options, 0, sizeof(options));
    options.struct_size = sizeof(options);
    options.content = SC_MODEL_BOXES + 1;
    CHECK(sc_build(&m, &options, &model) == SC_ERROR_OPTION && model == NULL);
    options.content = SC_MODEL_BOXES;
    options.rest = SC_REST_MARKED;
    CHECK(sc_build(&m, &options, &model) == SC_ERROR_BOXES_ONLY && model == NULL);
    options.rest = SC_REST_UNMARKED;
    options.partition = SC_PARTITION_ORDER;
    CHECK(sc_build(&m, &options, &model) == SC_ERROR_NULL && model == NULL);
    options.partition = SC_PARTITION_BISECT + 1;
    CHECK(sc_build(&m, &options, &model) == SC_ERROR_OPTION && model == NULL);
    options.partition = SC_PARTITION_FAST;
    CHECK(sc_build(&m, &options, &model) == SC_OK);
    CHECK(strstr(sc_status_string(SC_ERROR_BOXES_ONLY), "boxes") != NULL);
    sc_model_free(model);
    mesh.positions[4] /= 0.0;
    CHECK(sc_build(&m, &options, &model) == SC_ERROR_NOT_FINITE && model == NULL);
    soup_free(&mesh);
}

/* ---- records ---- */

static void records_keep_them(void)
{
    soup mesh = soup_cloth(12, 12);
    sc_model *model = build(&mesh, NULL, SC_MODEL_BOXES), *loaded = NULL;
    sc_pose pose = input_plain_pose(mesh.positions, mesh.vertex_count), posed;
    sc_query_options options = ask_for(SC_PAIRS_EDGE, SC_CONTACT_TOUCHING), asked;
    sc_workspace *workspaces[2] = {NULL, NULL};
    sc_record record;
    uint64_t size = 0, counts[2] = {0, 0};
    unsigned char *memory, *bytes;
    sc_pair *pairs[2];
    soup_fold(mesh.positions, mesh.vertex_count);
    soup_noise(mesh.positions, mesh.vertex_count, 0.05);
    CHECK(sc_record_size(model, &pose, &options, &size) == SC_OK);
    memory = (unsigned char *)test_allocate((size_t)size + SC_ALIGNMENT);
    bytes = memory + SC_ALIGNMENT - (uintptr_t)memory % SC_ALIGNMENT;
    CHECK(sc_record_write(model, &pose, &options, bytes, size, NULL) == SC_OK);
    memset(&record, 0, sizeof(record));
    memset(&posed, 0, sizeof(posed));
    memset(&asked, 0, sizeof(asked));
    record.struct_size = sizeof(record);
    posed.struct_size = sizeof(posed);
    asked.struct_size = sizeof(asked);
    record.pose = &posed;
    record.options = &asked;
    CHECK(sc_record_read(bytes, size, &record) == SC_OK);
    CHECK(asked.method == SC_METHOD_DEFAULT && asked.pairs == SC_PAIRS_EDGE);
    CHECK(sc_model_load(record.model, record.model_size, NULL, &loaded) == SC_OK);
    CHECK(sc_workspace_create(model, NULL, &workspaces[0]) == SC_OK);
    CHECK(sc_workspace_create(loaded, NULL, &workspaces[1]) == SC_OK);
    pairs[0] = list(model, workspaces[0], &pose, &options, &counts[0]);
    pairs[1] = list(loaded, workspaces[1], &posed, &asked, &counts[1]);
    CHECK(counts[0] > 10 && counts[0] == counts[1]);
    CHECK(memcmp(pairs[0], pairs[1], (size_t)counts[0] * sizeof(sc_pair)) == 0);
    for (int k = 0; k < 2; ++k) {
        free(pairs[k]);
        sc_workspace_free(workspaces[k]);
    }
    sc_model_free(model);
    sc_model_free(loaded);
    free(memory);
    soup_free(&mesh);
}

/* ---- memory ---- */

typedef struct failing {
    uint64_t left, live; /* allocations that succeed; those not given back */
} failing;

static void *allocate(void *user, uint64_t size, uint64_t alignment)
{
    failing *f = (failing *)user;
    unsigned char *raw, *aligned;
    if (f->left == 0) return NULL;
    --f->left;
    ++f->live;
    raw = (unsigned char *)test_allocate((size_t)size + 2 * (size_t)alignment);
    aligned = raw + 2 * alignment - (uintptr_t)raw % alignment;
    if (aligned - raw > (ptrdiff_t)alignment) aligned -= alignment;
    aligned[-1] = (unsigned char)(aligned - raw);
    return aligned;
}

static void release(void *user, void *memory, uint64_t size)
{
    unsigned char *aligned = (unsigned char *)memory;
    (void)size;
    --((failing *)user)->live;
    free(aligned - aligned[-1]);
}

static void every_allocation_fails(void)
{
    soup mesh = soup_cloth(9, 9);
    sc_mesh m = input_plain_mesh(&mesh);
    for (uint32_t partition = 0; partition < 4; ++partition) {
        input_choices choices = input_choose(&mesh, SC_WELD_REST, partition);
        sc_status status = SC_ERROR_MEMORY;
        uint64_t n;
        choices.options.rest = SC_REST_UNMARKED;
        choices.options.content = SC_MODEL_BOXES;
        for (n = 0; status == SC_ERROR_MEMORY && n < 1000; ++n) {
            failing f = {n, 0};
            sc_allocator allocator = {allocate, release, NULL};
            sc_model *model = NULL;
            allocator.user = &f;
            choices.options.allocator = &allocator;
            status = sc_build(&m, &choices.options, &model);
            CHECK(status == SC_OK ? f.live == 1 : f.live == 0 && model == NULL);
            sc_model_free(model);
            CHECK(f.live == 0);
        }
        CHECK_MSG(status == SC_OK && n > 20, "%s after %" PRIu64 " allocations",
                  sc_status_string(status), n);
        input_free_choices(&choices);
    }
    soup_free(&mesh);
}

SC_TEST_MAIN(SC_TEST(pairs_are_those_of_the_oracle), SC_TEST(pairs_are_those_of_full_models),
             SC_TEST(steps_are_those_of_full_models), SC_TEST(they_are_small),
             SC_TEST(hashes_differ), SC_TEST(culling_is_refused), SC_TEST(options_are_checked),
             SC_TEST(records_keep_them), SC_TEST(every_allocation_fails))
