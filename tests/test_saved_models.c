/*
 * Saved models: what is loaded is what was saved, byte by byte and pair by pair; whatever else is
 * offered is refused with a status that says why, or does no harm; and hooks, counters and
 * workspaces of the models concerned.
 *
 * Forged data have a right checksum: tests seal them with the library's own function, as anyone
 * could.
 *
 * SPDX-License-Identifier: MIT
 */
#define _POSIX_C_SOURCE 200809L

#include <inttypes.h>
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "base/saved.h"
#include "build/model.h"
#include "harness.h"
#include "inputs.h"
#include "shapes.h"
#include "starcontour.h"

/* The bytes of a save, in memory that has some room round them. */
typedef struct save {
    unsigned char *data;
    uint64_t size;
    void *memory;
} save;

/* With offset 0 aligned, else that much off. */
static save make_save(uint64_t size, uint32_t offset)
{
    save s;
    s.size = size;
    s.memory = test_allocate((size_t)size + 2 * SC_ALIGNMENT);
    s.data = (unsigned char *)s.memory + SC_ALIGNMENT - (uintptr_t)s.memory % SC_ALIGNMENT + offset;
    return s;
}

static save copy_save(const save *from, uint64_t size)
{
    save s = make_save(size, 0);
    memcpy(s.data, from->data, (size_t)size);
    return s;
}

static save save_model(const sc_model *model)
{
    uint64_t size = 0, written = 0;
    save s;
    CHECK(sc_model_save_size(model, &size) == SC_OK);
    s = make_save(size, 0);
    s.data[size] = 0x77;
    CHECK(sc_model_save(model, s.data, size, &written) == SC_OK && written == size);
    CHECK(s.data[size] == 0x77);
    return s;
}

static sc_model *build(const soup *mesh, uint32_t weld, uint32_t partition, uint32_t content)
{
    sc_mesh m = input_plain_mesh(mesh);
    input_choices choices = input_choose(mesh, weld, partition);
    sc_model *model = NULL;
    choices.options.content = content;
    if (content == SC_MODEL_BOXES) choices.options.rest = SC_REST_UNMARKED;
    CHECK(sc_build(&m, &choices.options, &model) == SC_OK);
    input_free_choices(&choices);
    return model;
}

static sc_status load(const save *s, uint32_t mode, sc_model **model)
{
    sc_load_options options;
    memset(&options, 0, sizeof(options));
    options.struct_size = sizeof(options);
    options.mode = mode;
    return sc_model_load(s->data, s->size, &options, model);
}

/* ---- answers ---- */

typedef struct pair_list {
    sc_pair *pairs;
    uint64_t count;
} pair_list;

static pair_list ask(const sc_model *model, sc_workspace *workspace, const soup *mesh,
                     const double *positions, uint32_t method, uint32_t kind)
{
    sc_pose pose = input_plain_pose(positions, mesh->vertex_count);
    sc_query_options options;
    sc_result result;
    pair_list list = {NULL, 0};
    memset(&options, 0, sizeof(options));
    options.struct_size = sizeof(options);
    options.method = model->node_count ? method : SC_METHOD_DEFAULT; /* for boxes: one method */
    options.pairs = kind / 2;
    options.contact = kind % 2;
    memset(&result, 0, sizeof(result));
    result.struct_size = sizeof(result);
    sc_query(model, workspace, &pose, &options, &result);
    list.pairs = (sc_pair *)test_allocate((size_t)result.count * sizeof(sc_pair));
    list.count = result.capacity = result.count;
    result.pairs = list.pairs;
    CHECK(sc_query(model, workspace, &pose, &options, &result) == SC_OK);
    CHECK(result.count == list.count);
    return list;
}

static uint64_t compare_pairs(const sc_model *a, sc_workspace *of_a, const sc_model *b,
                              sc_workspace *of_b, const soup *mesh, const double *positions)
{
    uint64_t found = 0;
    for (uint32_t method = 1; method <= SC_METHOD_AABB; ++method)
        for (uint32_t kind = 0; kind < 4; ++kind) {
            pair_list p = ask(a, of_a, mesh, positions, method, kind);
            pair_list q = ask(b, of_b, mesh, positions, method, kind);
            CHECK_MSG(p.count == q.count &&
                          (p.count == 0 ||
                           memcmp(p.pairs, q.pairs, (size_t)p.count * sizeof(sc_pair)) == 0),
                      "method %" PRIu32 ", kind %" PRIu32 ": %" PRIu64 " and %" PRIu64 " pairs",
                      method, kind, p.count, q.count);
            found += p.count;
            free(p.pairs);
            free(q.pairs);
        }
    return found;
}

static void compare_infos(const sc_model *a, const sc_model *b, int in_place)
{
    sc_model_info p, q;
    uint32_t *patches[2];
    memset(&p, 0, sizeof(p));
    memset(&q, 0, sizeof(q));
    p.struct_size = q.struct_size = sizeof(p);
    CHECK(sc_model_get_info(a, &p) == SC_OK && sc_model_get_info(b, &q) == SC_OK);
    CHECK(p.peak_bytes > p.model_bytes && p.allocations > 10);
    if (in_place)
        CHECK(q.peak_bytes == 0 && q.allocations == 0);
    else
        CHECK(q.peak_bytes > q.model_bytes && q.allocations == 2);
    p.peak_bytes = q.peak_bytes = p.allocations = q.allocations = 0;
    CHECK(memcmp(&p, &q, sizeof(p)) == 0);
    for (int i = 0; i < 2; ++i)
        patches[i] = (uint32_t *)test_allocate(p.triangle_count * sizeof(uint32_t));
    for (uint32_t level = 0; level < p.level_count; ++level) {
        sc_level_info l, k;
        memset(&l, 0, sizeof(l));
        memset(&k, 0, sizeof(k));
        l.struct_size = k.struct_size = sizeof(l);
        CHECK(sc_model_get_level(a, level, &l) == SC_OK &&
              sc_model_get_level(b, level, &k) == SC_OK);
        CHECK(memcmp(&l, &k, sizeof(l)) == 0);
        CHECK(sc_model_get_patches(a, level, patches[0], p.triangle_count) == SC_OK);
        CHECK(sc_model_get_patches(b, level, patches[1], p.triangle_count) == SC_OK);
        CHECK(memcmp(patches[0], patches[1], p.triangle_count * sizeof(uint32_t)) == 0);
    }
    for (int i = 0; i < 2; ++i) free(patches[i]);
}

/* Both modes: equal infos, equal pairs, equal when saved again; the data are not touched. */
static uint64_t check_round_trip(const soup *mesh, sc_model *model)
{
    save first = save_model(model), kept = copy_save(&first, first.size);
    double *posed = (double *)test_allocate(3 * (size_t)mesh->vertex_count * sizeof(double));
    uint64_t found = 0;
    memcpy(posed, mesh->positions, 3 * (size_t)mesh->vertex_count * sizeof(double));
    soup_fold(posed, mesh->vertex_count);
    for (uint32_t mode = SC_LOAD_COPY; mode <= SC_LOAD_IN_PLACE; ++mode) {
        sc_model *loaded = NULL;
        sc_workspace *workspaces[2] = {NULL, NULL};
        save second;
        if (!CHECK(load(&first, mode, &loaded) == SC_OK)) continue;
        second = save_model(loaded);
        CHECK(second.size == first.size && memcmp(second.data, first.data, first.size) == 0);
        compare_infos(model, loaded, mode == SC_LOAD_IN_PLACE);
        CHECK(sc_workspace_create(model, NULL, &workspaces[0]) == SC_OK);
        CHECK(sc_workspace_create(loaded, NULL, &workspaces[1]) == SC_OK);
        found += compare_pairs(model, workspaces[0], loaded, workspaces[1], mesh, mesh->positions);
        found += compare_pairs(model, workspaces[0], loaded, workspaces[1], mesh, posed);
        /* the workspace of one serves the other */
        compare_pairs(model, workspaces[1], loaded, workspaces[0], mesh, posed);
        for (int i = 0; i < 2; ++i) sc_workspace_free(workspaces[i]);
        sc_model_free(loaded);
        free(second.memory);
    }
    CHECK(memcmp(first.data, kept.data, first.size) == 0);
    free(first.memory);
    free(kept.memory);
    free(posed);
    return found;
}

static void round_trips(void)
{
    uint64_t found = 0;
    for (uint32_t i = 0; i < test_iterations_at_least(24, 6); ++i) {
        const char *name;
        soup mesh = shape_any(200, &name);
        sc_model *model = build(&mesh, i % 3, i % 4, i % 5 == 0 ? SC_MODEL_BOXES : SC_MODEL_FULL);
        if (model) found += check_round_trip(&mesh, model);
        sc_model_free(model);
        soup_free(&mesh);
    }
    CHECK(found > 100);
}

static void round_trips_of_mesh_files(void)
{
    static const char *const names[] = {"annulus",
                                        "corner_on_face",
                                        "crossing_cloths",
                                        "crossing_tetrahedra",
                                        "degenerate_soup",
                                        "duplicates",
                                        "fan",
                                        "figure_eight_tube",
                                        "folded_sheet",
                                        "hourglass",
                                        "moebius",
                                        "roll",
                                        "seam_cloth",
                                        "sphere",
                                        "touching_cubes",
                                        "twisted_strip"};
    for (size_t i = 0; i < sizeof(names) / sizeof(names[0]); ++i) {
        char path[64];
        soup mesh;
        sc_model *model;
        snprintf(path, sizeof(path), "meshes/%s.obj", names[i]);
        if (!CHECK_MSG(input_read_obj(path, &mesh), "%s", path)) continue;
        model = build(&mesh, SC_WELD_REST, SC_PARTITION_FAST, SC_MODEL_FULL);
        if (model) check_round_trip(&mesh, model);
        sc_model_free(model);
        soup_free(&mesh);
    }
}

/* ---- what is refused ---- */

/* The smallest model there is, two that have every array, and one for boxes. */
static sc_model *build_small(int which, soup *mesh)
{
    if (which == 0) {
        *mesh = soup_make(3, 1);
        for (uint32_t i = 0; i < 9; ++i) mesh->positions[i] = i % 4 == 0;
        for (uint32_t i = 0; i < 3; ++i) mesh->triangles[i] = i;
    } else {
        *mesh = which == 2   ? soup_pinched(3)
                : which == 4 ? soup_annulus(4, 1) /* contours in pieces */
                             : soup_cloth(8, 7);
    }
    return build(mesh, SC_WELD_REST, SC_PARTITION_FAST,
                 which == 3 ? SC_MODEL_BOXES : SC_MODEL_FULL);
}

enum { SMALL = 5 };

static void refuse(const save *s, sc_status expected, const char *what, uint64_t at)
{
    for (uint32_t mode = SC_LOAD_COPY; mode <= SC_LOAD_IN_PLACE; ++mode) {
        sc_model *model = (sc_model *)s->memory; /* anything but NULL */
        sc_status status = load(s, mode, &model);
        CHECK_MSG(status == expected && model == NULL, "%s %" PRIu64 ": %s", what, at,
                  sc_status_string(status));
    }
}

static void truncated(void)
{
    for (int which = 0; which < 2; ++which) {
        soup mesh;
        sc_model *model = build_small(which, &mesh), *loaded;
        save whole = save_model(model), longer = make_save(whole.size + 100, 0);
        for (uint64_t size = 0; size < whole.size; size += size < 300 ? 1 : 17) {
            /* a block of its own that ends there, so that reading on would show */
            unsigned char *bytes = (unsigned char *)test_allocate((size_t)size + 1);
            memcpy(bytes, whole.data, (size_t)size);
            bytes = (unsigned char *)realloc(bytes, size ? (size_t)size : 1);
            CHECK(bytes && sc_model_load(bytes, size, NULL, &loaded) == SC_ERROR_TRUNCATED);
            CHECK(loaded == NULL);
            free(bytes);
        }
        for (uint64_t size = 0; size < whole.size; size += 64) {
            save part = copy_save(&whole, size);
            refuse(&part, SC_ERROR_TRUNCATED, "size", size);
            free(part.memory);
        }
        /* more than a model is fine */
        memset(longer.data, 0xee, (size_t)longer.size);
        memcpy(longer.data, whole.data, (size_t)whole.size);
        CHECK(load(&longer, SC_LOAD_IN_PLACE, &loaded) == SC_OK);
        sc_model_free(loaded);
        free(longer.memory);
        free(whole.memory);
        sc_model_free(model);
        soup_free(&mesh);
    }
}

/* Every bit: all of the file is covered. */
static void changed(void)
{
    for (int which = 0; which < SMALL; ++which) {
        soup mesh;
        sc_model *model = build_small(which, &mesh);
        save s = save_model(model);
        for (uint64_t at = 0; at < s.size; ++at)
            for (uint32_t bit = 0; bit < 8; bit += which == 0 ? 1 : 7) {
                sc_model *loaded;
                sc_status status, expected = SC_ERROR_CHECKSUM;
                s.data[at] = (unsigned char)(s.data[at] ^ (1u << bit));
                status = load(&s, SC_LOAD_IN_PLACE, &loaded);
                if (at < offsetof(sc_saved_header, version)) expected = SC_ERROR_NOT_SAVED;
                /* version 2 with a bit changed is 0 or more; a larger size is not there */
                if (at >= offsetof(sc_saved_header, version) &&
                    at < offsetof(sc_saved_header, checksum))
                    expected = SC_ERROR_TOO_NEW;
                if (status == SC_ERROR_TOO_OLD && expected == SC_ERROR_TOO_NEW) expected = status;
                if (at >= offsetof(sc_saved_header, bytes) &&
                    at < offsetof(sc_saved_header, library) && status == SC_ERROR_TRUNCATED)
                    expected = status;
                CHECK_MSG(status == expected && loaded == NULL, "byte %" PRIu64 ": %s", at,
                          sc_status_string(status));
                s.data[at] = (unsigned char)(s.data[at] ^ (1u << bit));
            }
        free(s.memory);
        sc_model_free(model);
        soup_free(&mesh);
    }
}

static void foreign(void)
{
    soup mesh;
    sc_model *model = build_small(1, &mesh);
    save s = save_model(model);
    static const unsigned char text[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    sc_saved_header *header = (sc_saved_header *)(void *)s.data;
    uint32_t version = header->version;
    unsigned char mark[4];
    save other = make_save(sizeof(text), 0);
    memcpy(other.data, text, sizeof(text));
    refuse(&other, SC_ERROR_NOT_SAVED, "text", 0);
    free(other.memory);
    memcpy(mark, &header->byte_order, 4);
    for (int k = 0; k < 4; ++k) s.data[8 + k] = mark[3 - k];
    refuse(&s, SC_ERROR_BYTE_ORDER, "byte order", 0);
    memset(s.data + 8, 9, 4);
    refuse(&s, SC_ERROR_NOT_SAVED, "byte order", 1);
    memcpy(s.data + 8, mark, 4);
    header->version = version + 1;
    refuse(&s, SC_ERROR_TOO_NEW, "version", version + 1);
    header->version = UINT32_MAX;
    refuse(&s, SC_ERROR_TOO_NEW, "version", UINT32_MAX);
    header->version = version - 1;
    refuse(&s, SC_ERROR_TOO_OLD, "version", version - 1);
    header->version = version;
    header->checksum ^= 1;
    refuse(&s, SC_ERROR_CHECKSUM, "checksum", 0);
    free(s.memory);
    sc_model_free(model);
    soup_free(&mesh);
}

/* ---- forged models ---- */

static void seal(save *s)
{
    sc_saved_header *header = (sc_saved_header *)(void *)s->data;
    char magic[8];
    memcpy(magic, header->magic, sizeof(magic));
    sc_saved_seal(header, magic, header->version, s->size, s->data + sizeof(*header));
}

/* Whether each model is used for steps as well; else one in sixteen, as that takes longer than all
   else. */
static int always_steps;

/* A step by either contour test, on a workspace of its own. */
static void use_for_step(const sc_model *model, const sc_pose *pose)
{
    sc_workspace_options own;
    sc_workspace *workspace = NULL;
    memset(&own, 0, sizeof(own));
    own.struct_size = sizeof(own);
    own.flags = SC_WORKSPACE_STEP;
    if (!CHECK(sc_workspace_create_for(model, &own, &workspace) == SC_OK)) return;
    for (uint32_t contour = SC_CONTOUR_STAR; contour <= SC_CONTOUR_EXACT; ++contour) {
        sc_step_options options;
        sc_step_result result;
        sc_status status;
        memset(&options, 0, sizeof(options));
        options.struct_size = sizeof(options);
        options.output = SC_OUTPUT_COUNT;
        options.contour = contour;
        memset(&result, 0, sizeof(result));
        result.struct_size = sizeof(result);
        status = sc_query_step(model, workspace, pose, pose, &options, &result);
        CHECK(status == SC_OK || status == SC_ERROR_BOXES_ONLY);
    }
    sc_workspace_free(workspace);
}

/* All queries on a forged model: whatever they say, they end, and sanitizers see nothing. */
static void use(sc_model *model, const soup *mesh)
{
    static uint32_t uses;
    sc_workspace *workspace = NULL;
    sc_model_info info;
    uint32_t *patches;
    memset(&info, 0, sizeof(info));
    info.struct_size = sizeof(info);
    CHECK(sc_model_get_info(model, &info) == SC_OK);
    patches = (uint32_t *)test_allocate(info.triangle_count * sizeof(uint32_t));
    for (uint32_t level = 0; level < info.level_count; ++level)
        CHECK(sc_model_get_patches(model, level, patches, info.triangle_count) == SC_OK);
    free(patches);
    if (!CHECK(sc_workspace_create(model, NULL, &workspace) == SC_OK)) return;
    for (uint32_t i = 0; i < 12 && info.vertex_count == mesh->vertex_count; ++i) {
        pair_list list = ask(model, workspace, mesh, mesh->positions, 1 + i % 3, i / 3);
        free(list.pairs);
    }
    if (info.vertex_count == mesh->vertex_count) { /* filters walk where culling does not */
        sc_pose pose = input_plain_pose(mesh->positions, mesh->vertex_count);
        sc_group *groups = (sc_group *)test_allocate((size_t)mesh->vertex_count * sizeof(sc_group));
        sc_query_options options;
        sc_filter filter;
        sc_result result;
        memset(groups, 0xff, (size_t)mesh->vertex_count * sizeof(sc_group));
        memset(&filter, 0, sizeof(filter));
        filter.struct_size = sizeof(filter);
        filter.ignore_rings = 4;
        filter.vertex_groups = groups;
        memset(&options, 0, sizeof(options));
        options.struct_size = sizeof(options);
        options.output = SC_OUTPUT_COUNT;
        options.filter = &filter;
        memset(&result, 0, sizeof(result));
        result.struct_size = sizeof(result);
        CHECK(sc_query(model, workspace, &pose, &options, &result) == SC_OK);
        free(groups);
        if (always_steps || uses++ % 16 == 0) use_for_step(model, &pose);
        for (uint32_t t = 1; t < mesh->triangle_count; ++t) {
            sc_pair pair = {t - 1, t};
            sc_contact contact;
            CHECK(sc_contacts(model, &pose, SC_PAIRS_TRIANGLE, &pair, 1, &contact) == SC_OK);
        }
    }
    sc_workspace_free(workspace);
}

typedef struct model_array {
    const char *name;
    uint64_t offset, count;
    uint32_t words; /* uint32_t an element; 0: bytes, of which count says how many */
} model_array;

static uint32_t list_arrays(const sc_model *m, model_array *arrays)
{
    uint32_t n = 0;
    uint32_t vertex_count = m->vertex_count, triangle_count = m->triangle_count;
    uint32_t leaf_count = m->leaf_count, level_count = m->level_count;
    uint32_t patch_end = m->patch_end, around_total = m->around_total, node_count = m->node_count;
    uint32_t contour_total = m->contour_total;
    uint32_t segment_count = m->segment_count, leaf_segment_count = m->leaf_segment_count;
    uint32_t segment_point_total = m->segment_point_total;
    uint32_t segment_child_total = m->segment_child_total, share_count = m->share_count;
    uint32_t share_total = m->share_total;
    uint32_t loop_total = m->loop_total;
#define LIST(array, type, length)                                                                  \
  arrays[n].name = #array;                                                                         \
  arrays[n].offset = m->offset[n];                                                                 \
  arrays[n].words = sizeof(type) / 4;                                                              \
  arrays[n++].count = (length) * (sizeof(type) == 2 ? 2 : 1);
    SC_MODEL_ARRAYS(LIST)
#undef LIST
    return n;
}

/* What a forged save may do: be refused as such, or be loaded and used. Returns whether it was
   refused. */
static int try_forged(save *s, const soup *mesh)
{
    sc_model *loaded = NULL;
    sc_status status;
    seal(s);
    status = load(s, SC_LOAD_IN_PLACE, &loaded);
    if (status == SC_OK) use(loaded, mesh);
    CHECK_MSG(status == SC_OK || status == SC_ERROR_INCONSISTENT, "%s", sc_status_string(status));
    sc_model_free(loaded);
    return status != SC_OK;
}

/* Whether any value of an array's elements will do: masks of which only some bits are read. */
static int is_mask(const model_array *array)
{
    return strcmp(array->name, "share_own_rows") == 0 || strcmp(array->name, "leaf_fan") == 0 ||
           strcmp(array->name, "share_touch") == 0;
}

static unsigned is_little_endian(void)
{
    const uint16_t one = 1;
    return *(const unsigned char *)&one;
}

/* Each number of each array replaced by others. What no array may hold is always refused. */
static void forged_arrays(void)
{
    for (int which = 0; which < SMALL; ++which) {
        soup mesh;
        sc_model *model = build_small(which, &mesh);
        save s = save_model(model);
        model_array arrays[SC_ARRAY_COUNT];
        uint32_t count = list_arrays(model, arrays);
        for (uint32_t a = 0; a < count; ++a) {
            /* what is told of levels; of those without nodes it is known */
            int is_info = which != 3 && strcmp(arrays[a].name, "level_info") == 0;
            unsigned char *base = s.data + sizeof(sc_saved_header) + arrays[a].offset;
            for (uint64_t i = 0; arrays[a].words == 0 && i < arrays[a].count; ++i) {
                unsigned char old = base[i];
                if (strcmp(arrays[a].name, "loop") == 0 && (i ^ is_little_endian()) % 2 == 0)
                    continue; /* the places of points, of which any may be meant */
                base[i] = 0xff;
                CHECK_MSG(old == 0xff || try_forged(&s, &mesh) || is_mask(&arrays[a]),
                          "%s[%" PRIu64 "] = 255", arrays[a].name, i);
                base[i] = (unsigned char)(old ^ 1u);
                try_forged(&s, &mesh);
                base[i] = old;
            }
            for (uint64_t i = 0; i < arrays[a].count * arrays[a].words; ++i) {
                uint32_t *number = (uint32_t *)(void *)base + i, old = *number;
                const uint32_t values[] = {0xfffffff0u, 0x80000000u,       old + 1, old - 1,
                                           0,           old ^ 0x80000000u, old + 2, UINT32_MAX};
                for (uint32_t k = 0; k < sizeof(values) / sizeof(values[0]); ++k) {
                    int refused;
                    *number = values[k];
                    if (values[k] == old) continue;
                    refused = try_forged(&s, &mesh);
                    CHECK_MSG(refused || k > 1 || is_info, "%s[%" PRIu64 "] = %" PRIu32,
                              arrays[a].name, i, values[k]);
                }
                *number = old;
            }
        }
        CHECK(!try_forged(&s, &mesh));
        free(s.memory);
        sc_model_free(model);
        soup_free(&mesh);
    }
}

/* The numbers before the arrays, and several changes at once. */
static void forged_counts(void)
{
    for (int which = 0; which < SMALL; ++which) {
        soup mesh;
        sc_model *model = build_small(which, &mesh), *counts;
        save s = save_model(model);
        uint32_t rounds = test_iterations(3000), refused = 0;
        uint64_t words = sizeof(sc_model) / 4;
        uint32_t *numbers = (uint32_t *)(void *)(s.data + sizeof(sc_saved_header));
        counts = (sc_model *)(void *)numbers;
        for (uint64_t i = 0; i < words; ++i) {
            uint32_t old = numbers[i];
            const uint32_t values[] = {0, 1, old + 1, old - 1, 2 * old, UINT32_MAX, 0xfffffff0u};
            for (uint32_t k = 0; k < sizeof(values) / sizeof(values[0]); ++k) {
                numbers[i] = values[k];
                if (values[k] != old) try_forged(&s, &mesh);
            }
            numbers[i] = old;
        }
        /* sizes that no longer fit, whatever the arrays say */
        counts->leaf_segment_count = counts->segment_count + 1;
        CHECK(try_forged(&s, &mesh));
        counts->leaf_segment_count = model->leaf_segment_count;
        counts->bytes += SC_ALIGNMENT;
        CHECK(try_forged(&s, &mesh));
        counts->bytes = model->bytes;
        for (uint32_t k = 0; k < SC_ARRAY_COUNT; ++k) {
            counts->offset[k] ^= SC_ALIGNMENT;
            CHECK(try_forged(&s, &mesh));
            counts->offset[k] ^= SC_ALIGNMENT;
        }
        for (uint32_t i = 0; i < rounds; ++i) {
            save forged = copy_save(&s, s.size);
            uint32_t changes = 1 + test_random_below(4);
            for (uint32_t k = 0; k < changes; ++k) {
                uint64_t at = sizeof(sc_saved_header) +
                              test_random_below((uint32_t)(s.size - sizeof(sc_saved_header)));
                forged.data[at] = (unsigned char)test_random_below(which ? 20 : 256);
            }
            refused += (uint32_t)try_forged(&forged, &mesh);
            free(forged.memory);
        }
        CHECK(refused > rounds / 10);
        free(s.memory);
        sc_model_free(model);
        soup_free(&mesh);
    }
}

static void *array_of(sc_model *model, uint32_t array)
{
    return (unsigned char *)model + model->offset[array];
}

/* A mesh, its model as saved, and what is made up: the model in there. */
typedef struct forgery {
    soup mesh;
    sc_model *model;
    save saved;
    sc_model *made_up;
} forgery;

static forgery forge(soup mesh)
{
    forgery f;
    f.mesh = mesh;
    f.model = build(&f.mesh, SC_WELD_REST, SC_PARTITION_FAST, SC_MODEL_FULL);
    f.saved = save_model(f.model);
    f.made_up = (sc_model *)(void *)(f.saved.data + sizeof(sc_saved_header));
    return f;
}

static void end_forgery(forgery *f)
{
    free(f->saved.memory);
    sc_model_free(f->model);
    soup_free(&f->mesh);
}

/* What stands for a point is a point, and there are so many. */
static void forged_uses(void)
{
    forgery f = forge(soup_cloth(8, 7));
    sc_model *m = f.made_up;
    uint8_t *use = (uint8_t *)array_of(m, SC_ARRAY_vertex_use);
    for (uint32_t v = 0; v < f.model->vertex_count; ++v) {
        for (uint8_t other = SC_VERTEX_WELDED; other <= SC_VERTEX_UNUSED; ++other) {
            use[v] = other;
            CHECK(try_forged(&f.saved, &f.mesh));
            --m->point_count;
            CHECK(try_forged(&f.saved, &f.mesh));
            ++m->point_count;
        }
        use[v] = SC_VERTEX_POINT;
    }
    ++m->point_count;
    CHECK(try_forged(&f.saved, &f.mesh));
    m->point_count -= 2;
    CHECK(try_forged(&f.saved, &f.mesh));
    ++m->point_count;
    CHECK(!try_forged(&f.saved, &f.mesh));
    end_forgery(&f);
}

/* The whole, which is flat and so oriented, has no contour, be it as a loop or in segments; the
   next node has that one, too. */
static void forged_contour(void)
{
    forgery f = forge(soup_cloth(6, 6));
    sc_model *m = f.made_up;
    sc_node *node = (sc_node *)array_of(m, SC_ARRAY_node);
    uint16_t *loop = (uint16_t *)array_of(m, SC_ARRAY_loop);
    CHECK(node[1].contour > 0 && node[0].loop_length > 0);
    node[1].contour = 0;
    memset(loop, 0, node[0].loop_length * sizeof(*loop)); /* points that the next node has */
    node[1].loop = 0;
    node[1].loop_length = (uint16_t)(node[1].loop_length + node[0].loop_length);
    node[0].loop_length = 0;
    always_steps = 1;
    while (try_forged(&f.saved, &f.mesh) && m->contour_max < 1000) /* it has to be what it is now */
        ++m->contour_max;
    always_steps = 0;
    CHECK(m->contour_max < 1000);
    end_forgery(&f);
}

/* What a node says of its children, of what it leaves to boxes and of where its loop begins follows
   from all else. */
static void forged_nodes(void)
{
    forgery f = forge(soup_cloth(8, 7));
    const sc_node *was = sc_model_node(f.model);
    sc_node *node = (sc_node *)array_of(f.made_up, SC_ARRAY_node);
    for (uint32_t n = 0; n < f.model->node_count; ++n, ++node, ++was) {
        uint32_t *numbers[] = {&node->patches.a, &node->patches.b, &node->child, &node->loop};
        for (size_t i = 0; i < sizeof(numbers) / sizeof(*numbers); ++i) {
            ++*numbers[i];
            CHECK_MSG(try_forged(&f.saved, &f.mesh), "node %u, %zu", (unsigned)n, i);
            *numbers[i] -= 2;
            CHECK_MSG(try_forged(&f.saved, &f.mesh), "node %u, %zu", (unsigned)n, i);
            ++*numbers[i];
        }
        for (uint32_t bit = 0; bit < 8; ++bit) {
            node->pairs = (uint8_t)(was->pairs ^ 1u << bit);
            CHECK_MSG(try_forged(&f.saved, &f.mesh), "node %u, bit %u", (unsigned)n, (unsigned)bit);
        }
        node->pairs = was->pairs;
        for (uint32_t bit = 4; bit < 8; ++bit) {
            node->kind = (uint8_t)(was->kind ^ 1u << bit);
            CHECK_MSG(try_forged(&f.saved, &f.mesh), "node %u, bit %u", (unsigned)n, (unsigned)bit);
        }
        node->kind = was->kind;
    }
    CHECK(!try_forged(&f.saved, &f.mesh));
    end_forgery(&f);
}

/* Nodes whose patches share one point begin their lists with two numbers of another kind. */
static void forged_touches(void)
{
    forgery f = forge(soup_cloth(8, 7));
    sc_model *m = f.made_up;
    sc_node *node = (sc_node *)array_of(m, SC_ARRAY_node);
    uint32_t touching = 0;
    for (uint32_t n = 0; n < f.model->node_count; ++n) {
        uint32_t old = node[n + 1].contour;
        if (!(node[n].kind & SC_NODE_TOUCHES)) continue;
        for (uint32_t left = 0; left < 2 && n + 1 < f.model->node_count; ++left) {
            node[n + 1].contour = node[n].contour + left; /* the rest becomes the next node's */
            CHECK(try_forged(&f.saved, &f.mesh));
        }
        node[n + 1].contour = old;
        ++touching;
    }
    CHECK(touching > 2);
    end_forgery(&f);
}

/* Leaf clusters that share points and are left to boxes; that is, others are said to share
   points. */
static void forged_sharing(void)
{
    forgery f = forge(soup_cloth(12, 12));
    sc_model *m = f.made_up;
    const uint32_t *first = sc_model_share_first(f.model);
    uint32_t *other = (uint32_t *)array_of(m, SC_ARRAY_share_leaf), tried = 0;
    for (uint32_t leaf = 0; leaf < m->leaf_count; ++leaf)
        for (uint32_t i = first[leaf]; i < first[leaf + 1]; ++i) {
            uint32_t was = other[i], end = i + 1 < first[leaf + 1] ? other[i + 1] : m->leaf_count;
            for (other[i] = was + 1; other[i] < end; ++other[i], ++tried)
                CHECK(try_forged(&f.saved, &f.mesh));
            other[i] = was;
        }
    CHECK(tried > 10 && !try_forged(&f.saved, &f.mesh));
    end_forgery(&f);
}

/* The node of two leaf clusters is another: of one that the tree reaches early, and of a patch of
   several. */
static void forged_nodes_of_sharing(void)
{
    uint32_t tried[2] = {0, 0};
    for (uint32_t across = 6; across < 14; ++across) {
        forgery f = forge(soup_cloth(across, 9));
        uint32_t *node = (uint32_t *)array_of(f.made_up, SC_ARRAY_share_node), was = node[0];
        for (uint32_t n = 0; n < f.model->node_count; ++n) {
            const sc_pair patches = sc_model_node(f.model)[n].patches;
            const int is_leaf = sc_model_is_leaf(f.model, patches.a);
            if (is_leaf == sc_model_is_leaf(f.model, patches.b)) continue;
            node[0] = n;
            CHECK(try_forged(&f.saved, &f.mesh));
            ++tried[is_leaf];
        }
        node[0] = was;
        CHECK(!try_forged(&f.saved, &f.mesh));
        end_forgery(&f);
    }
    CHECK_MSG(tried[0] > 0 && tried[1] > 0, "%u, %u", (unsigned)tried[0], (unsigned)tried[1]);
}

/* Lists of neighboring triangles with one that is none of its leaf cluster, rows and pairs
   alike. */
static void forged_lists(void)
{
    forgery f = forge(soup_cloth(12, 12));
    sc_model *m = f.made_up;
    const uint32_t *share = sc_model_share_first(f.model), *other = sc_model_share_leaf(f.model);
    const uint32_t *first = sc_model_leaf_first(f.model), *begin = sc_model_share_begin(f.model);
    uint16_t *lists = (uint16_t *)array_of(m, SC_ARRAY_share_list), kept[512];
    uint32_t tried[2] = {0, 0};
    for (uint32_t leaf = 0; leaf < m->leaf_count; ++leaf)
        for (uint32_t i = share[leaf]; i < share[leaf + 1]; ++i) {
            uint16_t *list = lists + begin[i], *pair = list + SC_SHARE_ROWS;
            uint32_t words = begin[i + 1] - begin[i], last = 15, u;
            while (!(list[SC_SHARE_TRIANGLES] >> last & 1)) --last;
            for (uint32_t t = 0; t <= last; ++t) pair += list[SC_SHARE_TRIANGLES] >> t & 1;
            if (words > 512) continue;
            memcpy(kept, list, words * sizeof(*list));
            if (first[leaf + 1] - first[leaf] < 16) { /* the last of the lower cluster's */
                list[SC_SHARE_TRIANGLES] ^= (uint16_t)(1u << last | 1u << 15);
                for (uint16_t *p = pair; p < list + words; ++p)
                    if ((*p & 15u) == last) *p = (uint16_t)(*p | 15u);
                CHECK(try_forged(&f.saved, &f.mesh));
                memcpy(list, kept, words * sizeof(*list));
                ++tried[0];
            }
            if (first[other[i] + 1] - first[other[i]] < 16) { /* the upper one of the last row's */
                for (u = 0; !(pair[-1] >> u & 1); ++u) continue;
                pair[-1] = (uint16_t)(pair[-1] ^ (1u << u | 1u << 15));
                for (uint16_t *p = pair; p < list + words; ++p)
                    if ((*p & 255u) == (last | u << 4)) *p = (uint16_t)(*p | 15u << 4);
                CHECK(try_forged(&f.saved, &f.mesh));
                memcpy(list, kept, words * sizeof(*list));
                ++tried[1];
            }
        }
    CHECK(tried[0] > 3 && tried[1] > 3 && !try_forged(&f.saved, &f.mesh));
    end_forgery(&f);
}

/* Loops in pieces of which one has no edges, and the next has those too; and numbers of pieces that
   none has, or not that. */
static void forge_pieces(soup mesh, uint32_t least)
{
    forgery f = forge(mesh);
    sc_model *m = f.made_up;
    const sc_node *node = sc_model_node(f.model);
    uint16_t *loop = (uint16_t *)array_of(m, SC_ARRAY_loop);
    uint32_t tried = 0;
    for (uint32_t n = 0; n < f.model->node_count; ++n, ++node) {
        uint16_t *edges = loop + node->loop + 1;
        const uint16_t pieces = edges[-1], others[] = {0, 1, 3, SC_LOOP_PIECES, SC_LOOP_PIECES + 1};
        if (!(node->kind & SC_NODE_PIECES) || !node->loop_length) continue;
        for (size_t k = 0; k < sizeof(others) / sizeof(*others); ++k) {
            edges[-1] = others[k];
            CHECK(others[k] == pieces || try_forged(&f.saved, &f.mesh));
        }
        edges[-1] = pieces;
        for (uint32_t i = 0; i < edges[-1]; ++i) {
            uint16_t *other = &edges[(i + 1) % edges[-1]], was = edges[i];
            edges[i] = 0;
            *other = (uint16_t)(*other + was);
            CHECK(try_forged(&f.saved, &f.mesh));
            edges[i] = was;
            *other = (uint16_t)(*other - was);
            ++tried;
        }
    }
    CHECK(tried >= least && !try_forged(&f.saved, &f.mesh));
    end_forgery(&f);
}

static void forged_pieces(void)
{
    forge_pieces(soup_annulus(16, 3), 4);
    forge_pieces(soup_annulus(4, 1), 2); /* with hardly more numbers than there may be pieces */
}

/* A node has the loops of those that follow as well: refused from where that is more than the sides
   of its triangles. */
static void forged_loops(void)
{
    forgery f = forge(soup_cloth(24, 24));
    sc_model *m = f.made_up;
    sc_node *forged = (sc_node *)array_of(m, SC_ARRAY_node);
    const sc_node *was = sc_model_node(f.model);
    const uint32_t *leaf = sc_model_leaf(f.model);
    uint32_t tried = 0, node = f.model->node_count / 2;
    for (; node < f.model->node_count && tried < 6; ++node) {
        sc_pair patches = was[node].patches;
        uint32_t triangles = sc_model_leaf_first(f.model)[leaf[patches.a] + 1] -
                             sc_model_leaf_first(f.model)[leaf[patches.a]];
        uint32_t end = node + 1, total, refused;
        if (patches.a != patches.b || !sc_model_is_leaf(f.model, patches.a) ||
            !was[node].loop_length || was[node].kind)
            continue;
        while (end + 1 < f.model->node_count && was[end].loop - was[node].loop <= 3 * triangles)
            ++end;
        total = was[end].loop - was[node].loop;
        if (total <= 3 * triangles || total > f.model->contour_max) continue;
        memset((uint16_t *)array_of(m, SC_ARRAY_loop) + was[node].loop, 0,
               total * sizeof(uint16_t));
        for (uint32_t last = end; last + 1 >= end; --last) { /* so many, and one node fewer */
            forged[node].loop_length = (uint16_t)(was[last].loop - was[node].loop);
            for (uint32_t n = node + 1; n < last; ++n) {
                forged[n].loop = was[last].loop;
                forged[n].loop_length = 0;
            }
            refused = (uint32_t)try_forged(&f.saved, &f.mesh);
            CHECK(refused == (forged[node].loop_length > 3 * triangles));
            memcpy(forged + node, was + node, (last - node) * sizeof(*was));
        }
        ++tried;
    }
    CHECK(tried == 6);
    end_forgery(&f);
}

/* Two leaf clusters that face one way have a loop of two points or fewer: the next two have the
   rest as well. They are in folds, of which two do not, so that large patches are left to boxes.
   What is read where nothing is, sanitizers see. */
static void forged_short_loops(void)
{
    enum { FOLDS = 6, ACROSS = 4 };
    soup mesh = soup_cloth(ACROSS, FOLDS * ACROSS);
    uint32_t tried = 0;
    forgery f;
    for (uint32_t v = 0; v < mesh.vertex_count; ++v) {
        double *p = mesh.positions + 3 * v, along = FOLDS * p[0];
        p[0] = (int)along % 2 ? 1 - (along - floor(along)) : along - floor(along);
        p[2] = 0.1 * sin(2 * along);
    }
    f = forge(mesh);
    for (uint32_t n = 0; n + 1 < f.model->node_count; ++n) {
        const sc_node *was = sc_model_node(f.model) + n;
        sc_node *node = (sc_node *)array_of(f.made_up, SC_ARRAY_node) + n;
        int fits = was[0].loop_length > 2 && was[1].loop_length > 0;
        for (int i = 0; i < 2; ++i)
            fits &=
                !was[i].kind && was[i].patches.a != was[i].patches.b && sc_node_is_leaf(&was[i]);
        for (uint16_t left = 0; fits && left < 3; ++left) {
            const uint16_t moved = (uint16_t)(was[0].loop_length - left);
            node[0].loop_length = left;
            node[1].loop = was[1].loop - moved;
            node[1].loop_length = (uint16_t)(was[1].loop_length + moved);
            tried += !try_forged(&f.saved, &f.mesh);
        }
        memcpy(node, was, 2 * sizeof(*was));
    }
    CHECK_MSG(tried > 5, "%u", (unsigned)tried);
    end_forgery(&f);
}

/* A header for less than any model, with the right checksum. */
static void forged_sizes(void)
{
    soup mesh;
    sc_model *model = build_small(0, &mesh);
    save s = save_model(model);
    char magic[8];
    sc_saved_header *header = (sc_saved_header *)(void *)s.data;
    memcpy(magic, header->magic, sizeof(magic));
    for (uint64_t size = sizeof(*header); size < s.size; size += 8) {
        sc_saved_seal(header, magic, header->version, size, s.data + sizeof(*header));
        refuse(&s, SC_ERROR_INCONSISTENT, "size", size);
    }
    header->bytes = 63;
    refuse(&s, SC_ERROR_CHECKSUM, "size", 63);
    free(s.memory);
    sc_model_free(model);
    soup_free(&mesh);
}

static void take_message(void *user, uint32_t level, const char *message)
{
    CHECK(level == SC_LOG_ERROR);
    snprintf((char *)user, 256, "%s", message);
}

static sc_hooks message_hooks(char *text)
{
    sc_hooks hooks;
    memset(&hooks, 0, sizeof(hooks));
    hooks.struct_size = sizeof(hooks);
    hooks.log = take_message;
    hooks.user = text;
    return hooks;
}

/*
 * A chain of segments that would be walked down as deep as it is long: each parent has the one
 * before it and a segment without children, the first several of these.
 */
static void forged_chain(void)
{
    forgery f = forge(soup_cloth(12, 12));
    sc_model *loaded;
    sc_model *m = f.made_up;
    uint32_t parents = m->segment_count - m->leaf_segment_count, leaf, i, at = 0;
    uint32_t extra = m->segment_child_total - 2 * parents;
    uint32_t *first = (uint32_t *)array_of(m, SC_ARRAY_segment_children);
    uint32_t *children = (uint32_t *)array_of(m, SC_ARRAY_children);
    uint32_t *begin = (uint32_t *)array_of(m, SC_ARRAY_segment_first);
    uint32_t *end = (uint32_t *)array_of(m, SC_ARRAY_segment_last);
    char text[256] = "";
    sc_hooks hooks = message_hooks(text);
    sc_load_options o;
    CHECK(parents > 2 * m->level_count && m->segment_child_total >= 2 * parents);
    for (leaf = 0; leaf < m->leaf_segment_count; ++leaf) {
        begin[leaf] = leaf;
        end[leaf] = leaf + 1;
    }
    for (i = leaf = 0; i < parents; ++i) {
        uint32_t number = m->leaf_segment_count + i, stop = at + (i ? 1 : 2 + extra);
        first[i] = at;
        if (i) children[at++] = number - 1, ++stop;
        while (at < stop) children[at++] = leaf++;
        begin[number] = 0;
        end[number] = leaf;
    }
    CHECK(at == m->segment_child_total && leaf <= m->leaf_segment_count &&
          leaf < m->segment_point_total);
    first[parents] = at;
    seal(&f.saved);
    memset(&o, 0, sizeof(o));
    o.struct_size = sizeof(o);
    o.hooks = &hooks;
    CHECK(sc_model_load(f.saved.data, f.saved.size, &o, &loaded) == SC_ERROR_INCONSISTENT);
    CHECK_MSG(strcmp(text, "saved model: array children is wrong") == 0, "%s", text);
    sc_model_free(loaded);
    end_forgery(&f);
}

/* The log says what is wrong. */
static void messages(void)
{
    soup mesh;
    sc_model *model = build_small(1, &mesh), *loaded;
    save s = save_model(model);
    model_array arrays[SC_ARRAY_COUNT];
    uint32_t count = list_arrays(model, arrays);
    char text[256], wanted[256];
    sc_hooks hooks = message_hooks(text);
    sc_load_options o;
    memset(&o, 0, sizeof(o));
    o.struct_size = sizeof(o);
    o.hooks = &hooks;
    o.topology_hash = 1;
    CHECK(sc_model_load(s.data, s.size, &o, &loaded) == SC_ERROR_TOPOLOGY);
    snprintf(wanted, sizeof(wanted),
             "saved model: topology hash %016" PRIx64 ", expected 0000000000000001",
             model->topology_hash);
    CHECK_MSG(strcmp(text, wanted) == 0, "%s", text);
    o.topology_hash = 0;
    for (uint32_t a = 0; a < count; ++a) {
        unsigned char *number = s.data + sizeof(sc_saved_header) + arrays[a].offset, old[4];
        if (is_mask(&arrays[a])) continue;
        memcpy(old, number, 4);
        memset(number, 0xee, 4);
        seal(&s);
        CHECK(sc_model_load(s.data, s.size, &o, &loaded) == SC_ERROR_INCONSISTENT);
        snprintf(wanted, sizeof(wanted), "saved model: array %s is wrong", arrays[a].name);
        /* those that are looked at together have one name */
        if (strcmp(arrays[a].name, "segment_last") == 0)
            snprintf(wanted, sizeof(wanted), "saved model: array segment_first is wrong");
        CHECK_MSG(strcmp(text, wanted) == 0, "%s: %s", arrays[a].name, text);
        memcpy(number, old, 4);
    }
    free(s.memory);
    sc_model_free(model);
    soup_free(&mesh);
}

/* ---- workspaces of other models ---- */

/* Nine triangles in one place, in leaves of 8 and 1, or 1 and 8. */
static sc_model *build_leaves(soup *mesh, uint32_t first)
{
    static const uint32_t order[9] = {0, 1, 2, 3, 4, 5, 6, 7, 8};
    sc_tree_node tree[3] = {{1, 2, 0, 0}, {SC_NONE, SC_NONE, 0, 0}, {SC_NONE, SC_NONE, 0, 0}};
    sc_build_options options;
    sc_mesh m;
    sc_model *model = NULL;
    test_random_reset(1);
    *mesh = soup_make(27, 9);
    for (uint32_t i = 0; i < 81; ++i) mesh->positions[i] = test_random_unit();
    for (uint32_t i = 0; i < 27; ++i) mesh->triangles[i] = i;
    tree[1].count = tree[2].first = first;
    tree[2].count = 9 - first;
    memset(&options, 0, sizeof(options));
    options.struct_size = sizeof(options);
    options.partition = SC_PARTITION_TREE;
    options.order = order;
    options.tree = tree;
    options.tree_count = 3;
    m = input_plain_mesh(mesh);
    CHECK(sc_build(&m, &options, &model) == SC_OK);
    return model;
}

static void workspaces_and_forged_hashes(void)
{
    soup a, b, large;
    sc_model *of_a = build_leaves(&a, 8), *of_b, *of_large, *forged = NULL;
    sc_workspace *workspace = NULL, *own = NULL;
    sc_result result;
    sc_pose pose;
    save s;
    of_b = build_leaves(&b, 1);
    large = soup_cloth(6, 6);
    of_large = build(&large, SC_WELD_REST, SC_PARTITION_FAST, SC_MODEL_FULL);
    memset(&result, 0, sizeof(result));
    result.struct_size = sizeof(result);
    CHECK(sc_workspace_create(of_a, NULL, &workspace) == SC_OK);
    /* another topology */
    pose = input_plain_pose(b.positions, b.vertex_count);
    CHECK(sc_query(of_b, workspace, &pose, NULL, &result) == SC_ERROR_WORKSPACE);
    /* one that claims to be the same: refused if the workspace does not fit, else usable */
    s = save_model(of_large);
    ((sc_model *)(void *)(s.data + sizeof(sc_saved_header)))->topology_hash = of_a->topology_hash;
    seal(&s);
    CHECK(load(&s, SC_LOAD_IN_PLACE, &forged) == SC_OK);
    pose = input_plain_pose(large.positions, large.vertex_count);
    CHECK(sc_query(forged, workspace, &pose, NULL, &result) == SC_ERROR_WORKSPACE);
    sc_model_free(forged);
    free(s.memory);
    s = save_model(of_b);
    ((sc_model *)(void *)(s.data + sizeof(sc_saved_header)))->topology_hash = of_a->topology_hash;
    seal(&s);
    CHECK(load(&s, SC_LOAD_COPY, &forged) == SC_OK);
    CHECK(sc_workspace_create(of_b, NULL, &own) == SC_OK);
    if (forged) {
        compare_pairs(of_a, workspace, of_a, workspace, &a, a.positions);
        CHECK(compare_pairs(forged, workspace, of_b, own, &b, b.positions) > 0);
        compare_pairs(of_a, workspace, of_a, workspace, &a, a.positions);
    }
    sc_model_free(forged);
    free(s.memory);
    sc_workspace_free(own);
    sc_workspace_free(workspace);
    sc_model_free(of_a);
    sc_model_free(of_b);
    sc_model_free(of_large);
    soup_free(&a);
    soup_free(&b);
    soup_free(&large);
}

/* ---- arguments ---- */

static void *no_memory(void *user, uint64_t size, uint64_t alignment)
{
    (void)user;
    (void)size;
    (void)alignment;
    return NULL;
}

static void arguments(void)
{
    soup mesh;
    sc_model *model = build_small(1, &mesh), *loaded;
    save s = save_model(model), off = make_save(s.size, 8);
    uint64_t size = 7, written = 7;
    sc_load_options o;
    sc_model_info info;
    sc_hooks hooks;
    sc_allocator half;
    memcpy(off.data, s.data, (size_t)s.size);
    CHECK(sc_model_save_size(NULL, &size) == SC_ERROR_NULL && size == 7);
    CHECK(sc_model_save_size(model, NULL) == SC_ERROR_NULL);
    CHECK(sc_model_save(NULL, s.data, s.size, &written) == SC_ERROR_NULL && written == 0);
    CHECK(sc_model_save(model, NULL, s.size, &written) == SC_ERROR_NULL);
    CHECK(sc_model_save(model, NULL, 0, &written) == SC_ERROR_SHORT_BUFFER && written == s.size);
    CHECK(sc_model_save(model, off.data, s.size - 1, NULL) == SC_ERROR_SHORT_BUFFER);
    CHECK(memcmp(off.data, s.data, (size_t)s.size) == 0);
    memset(off.data, 0xcc, (size_t)s.size);
    CHECK(sc_model_save(model, off.data, s.size, NULL) == SC_OK); /* at any alignment */
    CHECK(memcmp(off.data, s.data, (size_t)s.size) == 0);

    CHECK(sc_model_load(s.data, s.size, NULL, NULL) == SC_ERROR_NULL);
    loaded = model;
    CHECK(sc_model_load(NULL, s.size, NULL, &loaded) == SC_ERROR_NULL && loaded == NULL);
    CHECK(load(&off, SC_LOAD_IN_PLACE, &loaded) == SC_ERROR_ALIGNMENT && loaded == NULL);
    CHECK(load(&off, SC_LOAD_COPY, &loaded) == SC_OK);
    sc_model_free(loaded);
    free(off.memory);
    memset(&info, 0, sizeof(info));
    info.struct_size = sizeof(info);
    CHECK(sc_model_get_info(model, &info) == SC_OK && info.model_bytes == s.size);

    memset(&o, 0, sizeof(o));
    o.struct_size = 4;
    CHECK(sc_model_load(s.data, s.size, &o, &loaded) == SC_ERROR_STRUCT_SIZE);
    o.struct_size = 8; /* an older caller */
    CHECK(sc_model_load(s.data, s.size, &o, &loaded) == SC_OK);
    sc_model_free(loaded);
    o.struct_size = sizeof(o);
    o.mode = 2;
    CHECK(sc_model_load(s.data, s.size, &o, &loaded) == SC_ERROR_OPTION && loaded == NULL);
    o.mode = SC_LOAD_COPY;
    o.topology_hash = info.topology_hash;
    CHECK(sc_model_load(s.data, s.size, &o, &loaded) == SC_OK);
    sc_model_free(loaded);
    o.topology_hash ^= 1;
    CHECK(sc_model_load(s.data, s.size, &o, &loaded) == SC_ERROR_TOPOLOGY && loaded == NULL);
    o.topology_hash = 0;
    memset(&half, 0, sizeof(half));
    o.allocator = &half;
    CHECK(sc_model_load(s.data, s.size, &o, &loaded) == SC_ERROR_NULL);
    half.allocate = no_memory;
    CHECK(sc_model_load(s.data, s.size, &o, &loaded) == SC_ERROR_NULL);
    o.allocator = NULL;
    memset(&hooks, 0, sizeof(hooks));
    o.hooks = &hooks;
    CHECK(sc_model_load(s.data, s.size, &o, &loaded) == SC_ERROR_STRUCT_SIZE);
    hooks.struct_size = sizeof(hooks);
    hooks.reserved = 1;
    CHECK(sc_model_load(s.data, s.size, &o, &loaded) == SC_ERROR_OPTION);
    free(s.memory);
    sc_model_free(model);
    soup_free(&mesh);
}

/* ---- memory ---- */

typedef struct counter {
    uint64_t calls, live, fail_at;
} counter;

static void *count_allocate(void *user, uint64_t size, uint64_t alignment)
{
    counter *c = (counter *)user;
    void *memory = NULL;
    if (++c->calls == c->fail_at) return NULL;
    if (posix_memalign(&memory, (size_t)alignment, (size_t)size) != 0) return NULL;
    ++c->live;
    return memset(memory, 0xa5, (size_t)size);
}

static void count_release(void *user, void *memory, uint64_t size)
{
    (void)size;
    --((counter *)user)->live;
    free(memory);
}

static int dirt;

static void *dirty_allocate(void *user, uint64_t size, uint64_t alignment)
{
    void *memory = count_allocate(user, size, alignment);
    if (memory) memset(memory, dirt, (size_t)size);
    return memory;
}

/* Whatever stood in the memory that a build gets, no byte of the model comes of it. */
static void equal_bytes(void)
{
    for (int which = 0; which < 2 * SMALL; ++which) {
        static const int dirts[] = {0x5a, 0xff};
        save saves[2];
        const char *name;
        soup mesh = shape_any(300, &name);
        sc_mesh m = input_plain_mesh(&mesh);
        for (int k = 0; k < 2; ++k) {
            counter c;
            sc_allocator allocator = {dirty_allocate, count_release, NULL};
            sc_build_options options;
            sc_model *model = NULL;
            memset(&c, 0, sizeof(c));
            allocator.user = &c;
            dirt = dirts[k];
            memset(&options, 0, sizeof(options));
            options.struct_size = sizeof(options);
            options.allocator = &allocator;
            options.content = which % 2 ? SC_MODEL_BOXES : SC_MODEL_FULL;
            CHECK(sc_build(&m, &options, &model) == SC_OK);
            saves[k] = save_model(model);
            sc_model_free(model);
        }
        CHECK_MSG(saves[0].size == saves[1].size &&
                      memcmp(saves[0].data, saves[1].data, saves[0].size) == 0,
                  "%s", name);
        for (int k = 0; k < 2; ++k) free(saves[k].memory);
        soup_free(&mesh);
    }
}

static void every_allocation_fails(void)
{
    soup mesh;
    sc_model *model = build_small(1, &mesh);
    save s = save_model(model);
    for (uint32_t mode = SC_LOAD_COPY; mode <= SC_LOAD_IN_PLACE; ++mode) {
        uint64_t needed = mode == SC_LOAD_COPY ? 2 : 1;
        for (uint64_t n = 1; n <= needed + 1; ++n) {
            counter c = {0, 0, n};
            sc_allocator allocator;
            sc_load_options o;
            sc_model *loaded = model;
            sc_status status;
            allocator.allocate = count_allocate;
            allocator.release = count_release;
            allocator.user = &c;
            memset(&o, 0, sizeof(o));
            o.struct_size = sizeof(o);
            o.mode = mode;
            o.allocator = &allocator;
            status = sc_model_load(s.data, s.size, &o, &loaded);
            memset(&allocator, 0, sizeof(allocator)); /* it was copied */
            CHECK(status == (n <= needed ? SC_ERROR_MEMORY : SC_OK));
            CHECK(c.live == (status == SC_OK && mode == SC_LOAD_COPY) &&
                  (loaded != NULL) == (status == SC_OK));
            sc_model_free(loaded);
            CHECK(c.live == 0 && c.calls == (n <= needed ? n : needed));
        }
    }
    /* nor does refusing leave anything */
    s.data[s.size - 1] ^= 1;
    for (uint32_t round = 0; round < 2; ++round) {
        counter c = {0, 0, 0};
        sc_allocator allocator = {count_allocate, count_release, NULL};
        sc_load_options o;
        sc_model *loaded = model;
        allocator.user = &c;
        memset(&o, 0, sizeof(o));
        o.struct_size = sizeof(o);
        o.allocator = &allocator;
        CHECK(sc_model_load(s.data, s.size, &o, &loaded) ==
              (round ? SC_ERROR_INCONSISTENT : SC_ERROR_CHECKSUM));
        CHECK(c.live == 0 && c.calls > 0 && loaded == NULL);
        s.data[sizeof(sc_saved_header) + model->offset[SC_ARRAY_triangle] + 3] = 0xff;
        seal(&s);
    }
    free(s.memory);
    sc_model_free(model);
    soup_free(&mesh);
}

/* A model in memory that cannot be written, used by two threads. */
typedef struct thread_job {
    const sc_model *model, *original;
    const soup *mesh;
    pair_list list[4];
    int failed;
} thread_job;

static void *run_thread(void *argument)
{
    thread_job *job = (thread_job *)argument;
    sc_workspace *workspace = NULL;
    if (sc_workspace_create(job->model, NULL, &workspace) != SC_OK) return NULL;
    for (uint32_t i = 0; i < 40; ++i) {
        pair_list *wanted = &job->list[i % 4];
        sc_pair *pairs = (sc_pair *)test_allocate((size_t)wanted->count * sizeof(sc_pair));
        sc_pose pose = input_plain_pose(job->mesh->positions, job->mesh->vertex_count);
        sc_query_options options;
        sc_result result;
        memset(&options, 0, sizeof(options));
        options.struct_size = sizeof(options);
        options.pairs = i % 4 / 2;
        options.contact = i % 2;
        memset(&result, 0, sizeof(result));
        result.struct_size = sizeof(result);
        result.pairs = pairs;
        result.capacity = wanted->count;
        job->failed |= sc_query(job->model, workspace, &pose, &options, &result) != SC_OK ||
                       result.count != wanted->count ||
                       memcmp(pairs, wanted->pairs, (size_t)wanted->count * sizeof(sc_pair)) != 0;
        free(pairs);
    }
    sc_workspace_free(workspace);
    return NULL;
}

static void read_only_and_shared(void)
{
    soup cloth = soup_cloth(20, 20);
    sc_model *model, *loaded = NULL;
    save s;
    size_t page = (size_t)sysconf(_SC_PAGESIZE), pages;
    void *mapped;
    soup_fold(cloth.positions, cloth.vertex_count);
    model = build(&cloth, SC_WELD_NONE, SC_PARTITION_FAST, SC_MODEL_FULL);
    s = save_model(model);
    pages = ((size_t)s.size + page - 1) / page * page;
    if (CHECK(posix_memalign(&mapped, page, pages) == 0)) {
        sc_load_options o;
        memcpy(mapped, s.data, (size_t)s.size);
        CHECK(mprotect(mapped, pages, PROT_READ) == 0);
        memset(&o, 0, sizeof(o));
        o.struct_size = sizeof(o);
        o.mode = SC_LOAD_IN_PLACE;
        if (CHECK(sc_model_load(mapped, s.size, &o, &loaded) == SC_OK)) {
            thread_job jobs[2];
            pthread_t threads[2];
            sc_workspace *workspace = NULL;
            memset(jobs, 0, sizeof(jobs));
            CHECK(sc_workspace_create(model, NULL, &workspace) == SC_OK);
            for (uint32_t kind = 0; kind < 4; ++kind)
                jobs[0].list[kind] =
                    ask(model, workspace, &cloth, cloth.positions, SC_METHOD_AABB, kind);
            CHECK(jobs[0].list[0].count > 0);
            sc_workspace_free(workspace);
            jobs[0].model = loaded;
            jobs[0].mesh = &cloth;
            jobs[1] = jobs[0];
            for (int i = 0; i < 2; ++i)
                CHECK(pthread_create(&threads[i], NULL, run_thread, &jobs[i]) == 0);
            for (int i = 0; i < 2; ++i)
                CHECK(pthread_join(threads[i], NULL) == 0 && !jobs[i].failed);
            for (int kind = 0; kind < 4; ++kind) free(jobs[0].list[kind].pairs);
            sc_model_free(loaded);
        }
        CHECK(mprotect(mapped, pages, PROT_READ | PROT_WRITE) == 0);
        free(mapped);
    }
    free(s.memory);
    sc_model_free(model);
    soup_free(&cloth);
}

/* ---- the format ---- */

/*
 * The version of the format belongs to what is in the model. If this fails, the model's counts or
 * arrays changed: let lib/build/model_check.c check what is new, raise VERSION in
 * lib/build/saved_model.c if a version with the old ones was released, and write the new numbers
 * here.
 */
static void format(void)
{
    static const char arrays[] =
#define TEXT(name, type, count) #name " " #type " " #count ";"
        SC_MODEL_ARRAYS(TEXT)
#undef TEXT
        ;
    soup mesh;
    sc_model *model = build_small(0, &mesh);
    save s = save_model(model);
    const sc_saved_header *header = (const sc_saved_header *)(const void *)s.data;
    uint64_t hash = 0;
    for (size_t i = 0; i + 1 < sizeof(arrays); ++i)
        hash = (hash ^ (unsigned char)arrays[i]) * 0x100000001b3u;
    CHECK_MSG(hash == UINT64_C(0xdb51746fe1760df8), "0x%" PRIx64, hash);
    CHECK_MSG(sizeof(sc_model) == 368, "%zu", sizeof(sc_model));
    CHECK_MSG(sizeof(sc_node) == 24, "%zu", sizeof(sc_node));
    CHECK(header->version == 2);
    free(s.memory);
    sc_model_free(model);
    soup_free(&mesh);
}

SC_TEST_MAIN(SC_TEST(round_trips), SC_TEST(round_trips_of_mesh_files), SC_TEST(truncated),
             SC_TEST(changed), SC_TEST(foreign), SC_TEST(forged_arrays), SC_TEST(forged_counts),
             SC_TEST(forged_uses), SC_TEST(forged_contour), SC_TEST(forged_touches),
             SC_TEST(forged_nodes), SC_TEST(forged_sharing), SC_TEST(forged_nodes_of_sharing),
             SC_TEST(forged_lists), SC_TEST(forged_pieces), SC_TEST(forged_loops),
             SC_TEST(forged_short_loops), SC_TEST(forged_sizes), SC_TEST(forged_chain),
             SC_TEST(messages), SC_TEST(workspaces_and_forged_hashes), SC_TEST(arguments),
             SC_TEST(equal_bytes), SC_TEST(every_allocation_fails), SC_TEST(read_only_and_shared),
             SC_TEST(format))
