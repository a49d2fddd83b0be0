/*
 * Records of queries: what is read is what was written, and gives the answer that the query gave; whatever
 * else is offered is refused, or asks a query that is refused, or does no harm.
 *
 * SPDX-License-Identifier: MIT
 */
#include <inttypes.h>
#include <math.h>
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
    sc_record record;
} opened;

static sc_status open_record(const void *data, uint64_t size, opened *o)
{
    memset(o, 0, sizeof(*o));
    o->pose.struct_size = sizeof(o->pose);
    o->options.struct_size = sizeof(o->options);
    o->record.struct_size = sizeof(o->record);
    o->record.pose = &o->pose;
    o->record.options = &o->options;
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
    for (uint32_t off = 0; off < 2; ++off) { /* aligned, and not */
        data = memory + SC_ALIGNMENT - (uintptr_t)memory % SC_ALIGNMENT + off;
        data[-1] = data[size] = 0x77;
        CHECK(sc_record_write(model, pose, options, data, size, &written) == SC_OK);
        CHECK(written == size && data[-1] == 0x77 && data[size] == 0x77);
        if (!CHECK(open_record(data, size + 1, &o) == SC_OK)) continue;
        CHECK(memcmp(&o.options, options, sizeof(*options)) == 0);
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
    for (uint32_t i = 0; i < test_iterations(40); ++i) {
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

/* A small record, and what it is of. */
typedef struct subject {
    soup mesh;
    sc_model *model;
    sc_pose pose;
    sc_query_options options;
    unsigned char *memory, *data;
    uint64_t size;
} subject;

static void open_subject(subject *s)
{
    sc_mesh m;
    memset(s, 0, sizeof(*s));
    s->mesh = soup_cloth(3, 4);
    m = input_plain_mesh(&s->mesh);
    CHECK(sc_build(&m, NULL, &s->model) == SC_OK);
    soup_fold(s->mesh.positions, s->mesh.vertex_count);
    s->pose = input_plain_pose(s->mesh.positions, s->mesh.vertex_count);
    s->options.struct_size = sizeof(s->options);
    CHECK(sc_record_size(s->model, &s->pose, NULL, &s->size) == SC_OK);
    s->memory = (unsigned char *)test_allocate((size_t)s->size + SC_ALIGNMENT);
    s->data = s->memory + SC_ALIGNMENT - (uintptr_t)s->memory % SC_ALIGNMENT;
    CHECK(sc_record_write(s->model, &s->pose, NULL, s->data, s->size, NULL) == SC_OK);
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

static void cut_off_and_changed(void)
{
    subject s;
    opened o;
    sc_model *model = NULL;
    open_subject(&s);
    for (uint64_t size = 0; size < s.size; size += size < 200 ? 1 : 13) {
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

/* Any byte changed and the checksum made right, alone and by tens: refused somewhere, or answered. */
static void forged(void)
{
    subject s;
    uint32_t refused = 0, rounds = test_iterations(4000);
    open_subject(&s);
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
    /* sizes that would reach beyond the record */
    for (uint32_t k = 0; k < 4; ++k) {
        uint64_t old, *number = (uint64_t *)(void *)(s.data + sizeof(sc_saved_header)) + k / 2;
        opened o;
        old = *number;
        *number = k % 2 ? UINT64_MAX - 63 : *number + (k ? 1 : 64);
        seal(&s);
        CHECK(open_record(s.data, s.size, &o) == SC_ERROR_INCONSISTENT);
        *number = old;
    }
    seal(&s);
    s.size = sizeof(sc_saved_header) + 60;
    seal(&s);
    {
        opened o;
        CHECK(open_record(s.data, s.size, &o) == SC_ERROR_INCONSISTENT);
    }
    close_subject(&s);
}

/* What a query would refuse for its pose is recorded all the same. */
static void not_finite(void)
{
    subject s;
    opened o;
    sc_pair *pairs;
    sc_result result;
    open_subject(&s);
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
    open_subject(&s);
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
    record.reserved = 1;
    CHECK(sc_record_read(s.data, s.size, &record) == SC_ERROR_OPTION);
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

SC_TEST_MAIN(SC_TEST(round_trips), SC_TEST(cut_off_and_changed), SC_TEST(forged),
             SC_TEST(not_finite), SC_TEST(arguments))
