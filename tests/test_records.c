/*
 * Records of queries: what is read is what was written, and gives the answer that the query gave;
 * whatever else is offered is refused, or asks a query that is refused, or does no harm.
 *
 * SPDX-License-Identifier: MIT
 */
#include <inttypes.h>
#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "base/saved.h"
#include "harness.h"
#include "inputs.h"
#include "shapes.h"
#include "starcontour.h"

typedef struct opened {
    sc_pose pose;
    sc_query_options options;
    sc_filter filter;
    sc_record record;
} opened;

static sc_status open_record(const void *data, uint64_t size, opened *o)
{
    memset(o, 0, sizeof(*o));
    o->pose.struct_size = sizeof(o->pose);
    o->options.struct_size = sizeof(o->options);
    o->record.struct_size = sizeof(o->record);
    o->record.pose = &o->pose;
    o->filter.struct_size = sizeof(o->filter);
    o->record.options = &o->options;
    o->record.filter = &o->filter;
    return sc_record_read(data, size, &o->record);
}

static sc_status answer(const sc_model *model, const sc_pose *pose, const sc_query_options *options,
                        sc_pair **pairs, sc_result *result)
{
    sc_workspace *workspace = NULL;
    sc_status status;
    memset(result, 0, sizeof(*result));
    result->struct_size = sizeof(*result);
    *pairs = NULL;
    if (!CHECK(sc_workspace_create(model, NULL, &workspace) == SC_OK)) return SC_ERROR_MEMORY;
    status = sc_query(model, workspace, pose, options, result);
    if (status == SC_ERROR_SHORT_BUFFER) {
        result->pairs = *pairs = (sc_pair *)test_allocate(result->count * sizeof(sc_pair));
        result->capacity = result->count;
        status = sc_query(model, workspace, pose, options, result);
    }
    sc_workspace_free(workspace);
    return status;
}

/* Loads the model of a record, as it may be anywhere, and answers. */
static sc_status replay(const opened *o, sc_pair **pairs, sc_result *result)
{
    sc_load_options load;
    sc_model *model = NULL;
    sc_status status;
    memset(&load, 0, sizeof(load));
    load.struct_size = sizeof(load);
    load.mode = (uintptr_t)o->record.model % SC_ALIGNMENT ? SC_LOAD_COPY : SC_LOAD_IN_PLACE;
    *pairs = NULL;
    memset(result, 0, sizeof(*result));
    status = sc_model_load(o->record.model, o->record.model_size, &load, &model);
    if (!status) status = answer(model, &o->pose, &o->options, pairs, result);
    sc_model_free(model);
    return status;
}

static int same_array(const void *x, const void *y, uint64_t bytes)
{
    return !x || bytes == 0 ? !y : y && memcmp(x, y, (size_t)bytes) == 0;
}

/* Whether a filter came back, without its function. */
static int same_filter(const sc_filter *asked, const sc_filter *got, const sc_model *model)
{
    sc_model_info info;
    memset(&info, 0, sizeof(info));
    info.struct_size = sizeof(info);
    CHECK(sc_model_get_info(model, &info) == SC_OK);
    return got->ignore_rings == asked->ignore_rings && got->ignore_count == asked->ignore_count &&
           same_array(asked->ignore, got->ignore, asked->ignore_count * sizeof(sc_pair)) &&
           same_array(asked->vertex_groups, got->vertex_groups,
                      info.vertex_count * sizeof(sc_group)) &&
           same_array(asked->triangle_groups, got->triangle_groups,
                      info.triangle_count * sizeof(sc_group)) &&
           !got->accept && !got->accept_user;
}

static uint64_t check_round_trip(const sc_model *model, const sc_pose *pose,
                                 const sc_query_options *options)
{
    uint64_t size = 0, written = 0;
    sc_pair *pairs[2];
    sc_result results[2];
    sc_status status = answer(model, pose, options, &pairs[0], &results[0]);
    unsigned char *memory, *data;
    opened o;
    CHECK(sc_record_size(model, pose, options, &size) == SC_OK);
    memory = (unsigned char *)test_allocate((size_t)size + 2 * SC_ALIGNMENT);
    for (uint32_t k = 0; k < 3; ++k) { /* aligned, and not */
        static const uint32_t offs[] = {0, 1, 4};
        const uint32_t off = offs[k];
        sc_query_options wanted = *options;
        data = memory + SC_ALIGNMENT - (uintptr_t)memory % SC_ALIGNMENT + off;
        data[-1] = data[size] = 0x77;
        CHECK(sc_record_write(model, pose, options, data, size, &written) == SC_OK);
        CHECK(written == size && data[-1] == 0x77 && data[size] == 0x77);
        if (options->filter && off == 1) {
            CHECK(open_record(data, size + 1, &o) == SC_ERROR_ALIGNMENT && !o.record.model);
            continue;
        }
        if (!CHECK(open_record(data, size + 1, &o) == SC_OK)) continue;
        if (wanted.filter) {
            CHECK(same_filter(options->filter, &o.filter, model));
            wanted.filter = &o.filter;
        }
        CHECK(memcmp(&o.options, &wanted, sizeof(wanted)) == 0);
        CHECK(o.record.left_out == 0 && o.record.filter == &o.filter);
        CHECK(o.pose.vertex_count == pose->vertex_count &&
              o.pose.position_type == pose->position_type && o.pose.position_stride == 0);
        CHECK(((uintptr_t)o.record.model % SC_ALIGNMENT == 0) == !off);
        CHECK(replay(&o, &pairs[1], &results[1]) == status);
        CHECK(results[0].count == results[1].count && results[0].collides == results[1].collides);
        CHECK(!pairs[0] == !pairs[1] &&
              (!pairs[0] || memcmp(pairs[0], pairs[1], results[0].count * sizeof(sc_pair)) == 0));
        free(pairs[1]);
    }
    free(memory);
    free(pairs[0]);
    return results[0].count;
}

static void round_trips(void)
{
    uint64_t found = 0;
    for (uint32_t i = 0; i < test_iterations_at_least(40, 8); ++i) {
        const char *name;
        soup mesh = shape_any(150, &name);
        sc_mesh m = input_plain_mesh(&mesh);
        input_choices choices = input_choose(&mesh, i % 3, i % 4);
        input_array positions;
        sc_query_options options;
        sc_pose pose;
        sc_model *model = NULL;
        if (CHECK(sc_build(&m, &choices.options, &model) == SC_OK)) {
            memset(&options, 0, sizeof(options));
            options.struct_size = sizeof(options);
            options.output = i / 3 % 3;
            options.pairs = i % 2;
            options.contact = i / 2 % 2;
            options.method = i % 4;
            options.rest_cache = i / 5 % 2;
            options.budget = i % 7 == 0 ? 100 : 0;
            if (i % 3) soup_any_pose(mesh.positions, mesh.vertex_count);
            positions = input_positions(mesh.positions, mesh.vertex_count,
                                        i % 2 ? SC_FLOAT : SC_DOUBLE, i % 5);
            pose = input_pose(mesh.vertex_count, &positions);
            found += check_round_trip(model, &pose, &options);
            input_free(&positions);
        }
        sc_model_free(model);
        input_free_choices(&choices);
        soup_free(&mesh);
    }
    CHECK(found > 100);
}

static void fill_groups(sc_group *groups, uint32_t count)
{
    for (uint32_t i = 0; i < count; ++i) {
        groups[i].category = 1u << test_random_below(3);
        groups[i].mask = test_random_below(8);
    }
}

/* Any parts of a filter, alone and together. */
static void filters(void)
{
    uint64_t found = 0, without = 0;
    for (uint32_t i = 0; i < test_iterations_at_least(64, 24); ++i) {
        const char *name;
        soup mesh = shape_any(120, &name);
        sc_mesh m = input_plain_mesh(&mesh);
        sc_group *vertex_groups =
            (sc_group *)test_allocate(mesh.vertex_count * sizeof(*vertex_groups));
        sc_group *triangle_groups =
            (sc_group *)test_allocate(mesh.triangle_count * sizeof(*triangle_groups));
        sc_pair *all = NULL;
        sc_result result;
        sc_query_options options;
        sc_filter filter;
        sc_pose pose;
        sc_model *model = NULL;
        if (CHECK(sc_build(&m, NULL, &model) == SC_OK)) {
            memset(&filter, 0, sizeof(filter));
            filter.struct_size = sizeof(filter);
            memset(&options, 0, sizeof(options));
            options.struct_size = sizeof(options);
            options.pairs = i / 16 % 2;
            soup_any_pose(mesh.positions, mesh.vertex_count);
            pose = input_plain_pose(mesh.positions, mesh.vertex_count);
            answer(model, &pose, &options, &all, &result);
            without += result.count;
            options.filter = &filter;
            options.simd = SC_SIMD_BASE;
            fill_groups(vertex_groups, mesh.vertex_count);
            fill_groups(triangle_groups, mesh.triangle_count);
            if (i & 1) filter.vertex_groups = vertex_groups;
            if (i & 2) filter.triangle_groups = triangle_groups;
            if (i & 4) filter.ignore_rings = i % 3;
            if (i & 8) {
                filter.ignore = all;
                filter.ignore_count = all ? result.count / 2 : 0;
            }
            found += check_round_trip(model, &pose, &options);
        }
        sc_model_free(model);
        free(all);
        free(vertex_groups);
        free(triangle_groups);
        soup_free(&mesh);
    }
    CHECK(found > 100 && without > found + 100);
}

/* A small record, and what it is of. */
typedef struct subject {
    soup mesh;
    sc_model *model;
    sc_pose pose;
    sc_query_options options;
    sc_filter filter;
    sc_group groups[64];
    sc_pair ignore[3];
    unsigned char *memory, *data;
    uint64_t size;
} subject;

/* With or without a filter that has everything. */
static void open_subject(subject *s, int filtered)
{
    sc_mesh m;
    memset(s, 0, sizeof(*s));
    s->mesh = soup_cloth(3, 4);
    CHECK(s->mesh.vertex_count <= 64 && s->mesh.triangle_count <= 64);
    m = input_plain_mesh(&s->mesh);
    CHECK(sc_build(&m, NULL, &s->model) == SC_OK);
    soup_fold(s->mesh.positions, s->mesh.vertex_count);
    s->pose = input_plain_pose(s->mesh.positions, s->mesh.vertex_count);
    s->options.struct_size = sizeof(s->options);
    if (filtered) {
        memset(s->groups, 0xff, sizeof(s->groups));
        s->ignore[0].b = s->ignore[1].b = 1;
        s->ignore[2].b = 2;
        s->filter.struct_size = sizeof(s->filter);
        s->filter.vertex_groups = s->filter.triangle_groups = s->groups;
        s->filter.ignore = s->ignore;
        s->filter.ignore_count = 3;
        s->options.filter = &s->filter;
    }
    CHECK(sc_record_size(s->model, &s->pose, &s->options, &s->size) == SC_OK);
    s->memory = (unsigned char *)test_allocate((size_t)s->size + SC_ALIGNMENT);
    s->data = s->memory + SC_ALIGNMENT - (uintptr_t)s->memory % SC_ALIGNMENT;
    CHECK(sc_record_write(s->model, &s->pose, &s->options, s->data, s->size, NULL) == SC_OK);
}

static void close_subject(subject *s)
{
    sc_model_free(s->model);
    free(s->memory);
    soup_free(&s->mesh);
}

static void seal(subject *s)
{
    sc_saved_header *header = (sc_saved_header *)(void *)s->data;
    char magic[8];
    memcpy(magic, header->magic, sizeof(magic));
    sc_saved_seal(header, magic, header->version, s->size, s->data + sizeof(*header));
}

static void check_damage(int filtered)
{
    subject s;
    opened o;
    sc_model *model = NULL;
    open_subject(&s, filtered);
    for (uint64_t size = 0; size < s.size; size += size < 300 ? 1 : 13) {
        unsigned char *bytes = (unsigned char *)test_allocate(size ? (size_t)size : 1);
        memcpy(bytes, s.data, (size_t)size);
        CHECK(open_record(bytes, size, &o) == SC_ERROR_TRUNCATED && !o.record.model);
        free(bytes);
    }
    for (uint64_t at = 0; at < s.size; ++at) {
        sc_status status;
        s.data[at] ^= 4;
        status = open_record(s.data, s.size, &o);
        CHECK_MSG(status != SC_OK && !o.record.model && !o.pose.positions, "byte %" PRIu64, at);
        s.data[at] ^= 4;
    }
    /* one is not the other */
    CHECK(sc_model_load(s.data, s.size, NULL, &model) == SC_ERROR_NOT_SAVED);
    CHECK(open_record(s.data, s.size, &o) == SC_OK);
    CHECK(open_record(o.record.model, o.record.model_size, &o) == SC_ERROR_NOT_SAVED);
    close_subject(&s);
}

static void cut_off_and_changed(void)
{
    check_damage(0);
    check_damage(1);
}

/* Any byte changed and the checksum made right, alone and by tens: refused somewhere, or
   answered. */
static void check_forgery(int filtered)
{
    subject s;
    uint32_t refused = 0, rounds = test_iterations(4000);
    open_subject(&s, filtered);
    for (uint32_t i = 0; i < rounds; ++i) {
        uint64_t span = s.size - sizeof(sc_saved_header);
        uint32_t changes = i < span ? 1 : 1 + test_random_below(10);
        unsigned char *kept = (unsigned char *)test_allocate((size_t)s.size);
        opened o;
        sc_pair *pairs;
        sc_result result;
        sc_status status;
        memcpy(kept, s.data, (size_t)s.size);
        for (uint32_t k = 0; k < changes; ++k) {
            uint64_t at = i < span ? i : test_random_below((uint32_t)span);
            s.data[sizeof(sc_saved_header) + at] = (unsigned char)test_random_below(256);
        }
        seal(&s);
        status = open_record(s.data, s.size, &o);
        if (!status) {
            status = replay(&o, &pairs, &result);
            free(pairs);
        }
        refused += status != SC_OK;
        memcpy(s.data, kept, (size_t)s.size);
        free(kept);
    }
    CHECK(refused > rounds / 2);
    close_subject(&s);
}

static void forged(void)
{
    check_forgery(0);
    check_forgery(1);
}

/* The record with a number of so many bytes made another. */
static sc_status forge(subject *s, uint64_t at, uint32_t bytes, uint64_t number)
{
    unsigned char *place = s->data + sizeof(sc_saved_header) + at, kept[8];
    uint32_t narrow = (uint32_t)number;
    sc_status status;
    opened o;
    memcpy(kept, place, bytes);
    memcpy(place, bytes == 4 ? (void *)&narrow : (void *)&number, bytes);
    seal(s);
    status = open_record(s->data, s->size, &o);
    CHECK((status == SC_OK) == (o.record.model != NULL));
    memcpy(place, kept, bytes);
    return status;
}

/* Sizes and counts that would reach beyond the record, or beyond one of its arrays. */
static void forged_counts(void)
{
    /* where the question of a record has them */
    enum { MODEL_BYTES = 0, IGNORE_COUNT = 16, VERTICES = 24, TRIANGLES = 28, TYPE = 32 };
    enum { PARTS = 64, LEFT_OUT = 72, TRIANGLES_OF_MODEL = 128 + sizeof(sc_saved_header) };
    subject s;
    opened o;
    for (int filtered = 0; filtered < 2; ++filtered) {
        open_subject(&s, filtered);
        uint64_t model_bytes, triangles = s.mesh.triangle_count;
        memcpy(&model_bytes, s.data + sizeof(sc_saved_header), sizeof(model_bytes));
        for (uint32_t k = 0; k < 4; ++k) {
            const uint64_t off = k == 0   ? 8
                                 : k == 1 ? 64
                                 : k == 2 ? UINT64_MAX / 8 + 1
                                          : 1ull << 63;
            CHECK(forge(&s, MODEL_BYTES, 8, model_bytes + off) == SC_ERROR_INCONSISTENT);
            CHECK(forge(&s, IGNORE_COUNT, 8, off) == SC_ERROR_INCONSISTENT);
            CHECK(forge(&s, VERTICES, 4, s.mesh.vertex_count + off + 1) == SC_ERROR_INCONSISTENT);
        }
        /* what one array loses another gains */
        if (filtered) {
            unsigned char *count = s.data + sizeof(sc_saved_header) + IGNORE_COUNT;
            uint64_t more = 3 + triangles - 1, kept = 3;
            memcpy(count, &more, sizeof(more));
            CHECK(forge(&s, TRIANGLES, 4, 1) == SC_ERROR_INCONSISTENT);
            memcpy(count, &kept, sizeof(kept));
            more = 3 + s.mesh.triangle_count;
            memcpy(count, &more, sizeof(more));
            CHECK(forge(&s, PARTS, 4, 1 | 2) == SC_OK);
            CHECK(forge(&s, PARTS, 4, 2 | 4) == SC_ERROR_INCONSISTENT);
            memcpy(count, &kept, sizeof(kept));
            CHECK(forge(&s, PARTS, 4, 2 | 4) == SC_ERROR_INCONSISTENT);
            CHECK(forge(&s, MODEL_BYTES, 8, 8) == SC_ERROR_INCONSISTENT);
            --s.size; /* so that the arrays behind the model are not aligned */
            CHECK(forge(&s, MODEL_BYTES, 8, model_bytes - 1) == SC_ERROR_INCONSISTENT);
            ++s.size;
            CHECK(forge(&s, 128 + offsetof(sc_saved_header, bytes), 8,
                        sizeof(sc_saved_header) + 8) == SC_ERROR_INCONSISTENT);
        } else {
            unsigned char *count = s.data + sizeof(sc_saved_header) + IGNORE_COUNT;
            const uint64_t one = 1, none = 0;
            memcpy(count, &one, sizeof(one)); /* a pair to ignore, and no filter */
            CHECK(forge(&s, MODEL_BYTES, 8, model_bytes - 8) == SC_ERROR_INCONSISTENT);
            memcpy(count, &none, sizeof(none));
            CHECK(forge(&s, PARTS, 4, 1) == SC_OK); /* a filter that leaves out nothing */
        }
        CHECK(forge(&s, PARTS, 4, 8) == SC_ERROR_INCONSISTENT);
        CHECK(forge(&s, LEFT_OUT, 4, 4) == SC_ERROR_INCONSISTENT);
        CHECK(forge(&s, LEFT_OUT, 4, 3) == SC_OK);
        CHECK(forge(&s, TYPE, 4, 2) == SC_ERROR_INCONSISTENT);
        seal(&s);
        CHECK(open_record(s.data, s.size, &o) == SC_OK);
        s.size = sizeof(sc_saved_header) + 124;
        seal(&s);
        CHECK(open_record(s.data, s.size, &o) == SC_ERROR_INCONSISTENT);
        close_subject(&s);
    }
}

static int32_t refuse(void *user, uint32_t a, uint32_t b)
{
    (void)a;
    (void)b;
    ++*(uint32_t *)user;
    return 0;
}

/* What cannot be recorded is said to be missing, and what cannot be taken is refused. */
static void left_out(void)
{
    subject s;
    opened o;
    uint32_t asked = 0;
    uint64_t found = 0;
    volatile uint32_t cancel = 1;
    sc_pair *pairs;
    sc_result result;
    for (uint32_t k = 0; k < 4; ++k) {
        open_subject(&s, 1);
        s.filter.accept = k & 1 ? refuse : NULL;
        s.filter.accept_user = k & 1 ? &asked : NULL;
        s.options.cancel = k & 2 ? &cancel : NULL;
        s.options.budget = 1u << 30;
        CHECK(sc_record_write(s.model, &s.pose, &s.options, s.data, s.size, NULL) == SC_OK);
        CHECK(open_record(s.data, s.size, &o) == SC_OK);
        CHECK(o.record.left_out == k && o.options.cancel == NULL && o.filter.accept == NULL);
        CHECK(o.options.budget == 1u << 30);
        CHECK(replay(&o, &pairs, &result) == SC_OK && asked == 0);
        found += result.count;
        free(pairs);
        close_subject(&s);
    }
    CHECK(found > 0);
    open_subject(&s, 1);
    CHECK(open_record(s.data, s.size, &o) == SC_OK);
    o.record.filter = NULL;
    CHECK(sc_record_read(s.data, s.size, &o.record) == SC_ERROR_NULL);
    o.record.filter = &o.filter;
    o.record.struct_size = (uint32_t)offsetof(sc_record, filter); /* of before there were filters */
    CHECK(sc_record_read(s.data, s.size, &o.record) == SC_ERROR_NULL);
    o.record.struct_size = sizeof(o.record);
    o.filter.struct_size = (uint32_t)offsetof(sc_filter, ignore);
    CHECK(sc_record_read(s.data, s.size, &o.record) == SC_ERROR_STRUCT_SIZE);
    o.filter.struct_size = 4;
    CHECK(sc_record_read(s.data, s.size, &o.record) == SC_ERROR_STRUCT_SIZE);
    o.filter.struct_size = (uint32_t)offsetof(sc_filter, accept);
    CHECK(sc_record_read(s.data, s.size, &o.record) == SC_OK);
    o.options.struct_size = (uint32_t)offsetof(sc_query_options, filter);
    CHECK(sc_record_read(s.data, s.size, &o.record) == SC_ERROR_STRUCT_SIZE);
    close_subject(&s);
    /* without a filter none is needed, and one that is there is emptied */
    open_subject(&s, 0);
    CHECK(open_record(s.data, s.size, &o) == SC_OK);
    o.filter.ignore_rings = 7;
    o.options.struct_size = (uint32_t)offsetof(sc_query_options, filter);
    CHECK(sc_record_read(s.data, s.size, &o.record) == SC_OK && o.filter.ignore_rings == 0);
    o.record.filter = NULL;
    CHECK(sc_record_read(s.data, s.size, &o.record) == SC_OK);
    close_subject(&s);
}

/* A filter that no query takes is not recorded. */
static void bad_filters(void)
{
    subject s;
    uint64_t size = 7;
    open_subject(&s, 1);
    s.filter.ignore_rings = SC_RINGS_MAX + 1;
    CHECK(sc_record_size(s.model, &s.pose, &s.options, &size) == SC_ERROR_OPTION && size == 7);
    s.filter.ignore_rings = SC_RINGS_MAX;
    s.ignore[0].b = 3;
    CHECK(sc_record_size(s.model, &s.pose, &s.options, &size) == SC_ERROR_PAIRS);
    CHECK(sc_record_write(s.model, &s.pose, &s.options, s.data, s.size, &size) == SC_ERROR_PAIRS &&
          size == 0);
    s.ignore[0].b = 1;
    s.filter.ignore = NULL;
    CHECK(sc_record_size(s.model, &s.pose, &s.options, &size) == SC_ERROR_NULL);
    s.filter.struct_size = sizeof(void *) / 2; /* less than a pointer's size */
    CHECK(sc_record_size(s.model, &s.pose, &s.options, &size) == SC_ERROR_STRUCT_SIZE);
    close_subject(&s);
}

/* What a query would refuse for its pose is recorded all the same. */
static void not_finite(void)
{
    subject s;
    opened o;
    sc_pair *pairs;
    sc_result result;
    open_subject(&s, 0);
    s.mesh.positions[7] = (double)NAN;
    CHECK(sc_record_write(s.model, &s.pose, NULL, s.data, s.size, NULL) == SC_OK);
    CHECK(open_record(s.data, s.size, &o) == SC_OK);
    CHECK(replay(&o, &pairs, &result) == SC_ERROR_NOT_FINITE && pairs == NULL);
    close_subject(&s);
}

static void arguments(void)
{
    subject s;
    opened o, kept;
    uint64_t size = 7;
    sc_pose pose;
    sc_query_options options;
    sc_record record;
    open_subject(&s, 0);
    pose = s.pose;
    CHECK(sc_record_size(NULL, &pose, NULL, &size) == SC_ERROR_NULL && size == 7);
    CHECK(sc_record_size(s.model, NULL, NULL, &size) == SC_ERROR_NULL);
    CHECK(sc_record_size(s.model, &pose, NULL, NULL) == SC_ERROR_NULL);
    CHECK(sc_record_write(s.model, &pose, NULL, NULL, s.size, &size) == SC_ERROR_NULL);
    CHECK(sc_record_write(s.model, &pose, NULL, NULL, 0, &size) == SC_ERROR_SHORT_BUFFER &&
          size == s.size);
    CHECK(sc_record_write(s.model, &pose, NULL, s.data, s.size - 1, &size) ==
          SC_ERROR_SHORT_BUFFER);
    pose.vertex_count++;
    CHECK(sc_record_size(s.model, &pose, NULL, &size) == SC_ERROR_VERTEX_COUNT);
    pose.vertex_count--;
    pose.position_type = 2;
    CHECK(sc_record_size(s.model, &pose, NULL, &size) == SC_ERROR_OPTION);
    pose.position_type = SC_DOUBLE;
    pose.position_stride = 23;
    CHECK(sc_record_size(s.model, &pose, NULL, &size) == SC_ERROR_STRIDE);
    pose.position_stride = 0;
    pose.positions = NULL;
    CHECK(sc_record_size(s.model, &pose, NULL, &size) == SC_ERROR_NULL);
    pose.struct_size = 8;
    CHECK(sc_record_size(s.model, &pose, NULL, &size) == SC_ERROR_STRUCT_SIZE);
    memset(&options, 0, sizeof(options));
    options.struct_size = 4;
    CHECK(sc_record_size(s.model, &s.pose, &options, &size) == SC_ERROR_STRUCT_SIZE);
    options.struct_size = sizeof(options);
    options.method = 77;
    CHECK(sc_record_size(s.model, &s.pose, &options, &size) == SC_ERROR_OPTION);
    CHECK(sc_record_write(s.model, &s.pose, &options, s.data, s.size, &size) == SC_ERROR_OPTION &&
          size == 0);

    CHECK(open_record(s.data, s.size, &o) == SC_OK);
    kept = o;
    record = o.record;
    CHECK(sc_record_read(NULL, s.size, &record) == SC_ERROR_NULL);
    CHECK(sc_record_read(s.data, s.size, NULL) == SC_ERROR_NULL);
    record.struct_size = 8;
    CHECK(sc_record_read(s.data, s.size, &record) == SC_ERROR_STRUCT_SIZE);
    record = o.record;
    record.pose = NULL;
    CHECK(sc_record_read(s.data, s.size, &record) == SC_ERROR_NULL);
    record = o.record;
    record.options = NULL;
    CHECK(sc_record_read(s.data, s.size, &record) == SC_ERROR_NULL);
    record = o.record;
    o.pose.struct_size = 8;
    CHECK(sc_record_read(s.data, s.size, &record) == SC_ERROR_STRUCT_SIZE);
    o.pose.struct_size = sizeof(o.pose);
    o.options.struct_size = 4;
    CHECK(sc_record_read(s.data, s.size, &record) == SC_ERROR_STRUCT_SIZE);
    o.options.struct_size = sizeof(o.options);
    CHECK(memcmp(&o, &kept, sizeof(o)) == 0);
    close_subject(&s);
}

SC_TEST_MAIN(SC_TEST(round_trips), SC_TEST(filters), SC_TEST(cut_off_and_changed), SC_TEST(forged),
             SC_TEST(forged_counts), SC_TEST(left_out), SC_TEST(bad_filters), SC_TEST(not_finite),
             SC_TEST(arguments))
