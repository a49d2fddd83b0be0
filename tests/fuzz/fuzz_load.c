/*
 * Fuzz target: sc_model_load and sc_record_read. Bytes as they are; and saves of small models, and
 * records of all kinds, in which some bytes are replaced and the checksum is made right again, so
 * that the fuzzer gets behind it. What is loaded is asked everything there is to ask, and what the
 * record asks; it may answer anything.
 *
 * SPDX-License-Identifier: MIT
 */
#define _POSIX_C_SOURCE 200112L /* posix_memalign: data that end where they end */

#include "fuzz_support.h"

#include <stdlib.h>
#include <string.h>

#include "base/saved.h"
#include "harness.h"
#include "record_ask.h"

enum { MAXIMUM_EDITS = 24 };

/* A copy that is aligned, or off by some bytes. */
static unsigned char *place(const void *from, size_t size, size_t off, void **memory)
{
    unsigned char *data;
    if (posix_memalign(memory, SC_ALIGNMENT, size + off + 1) != 0) abort();
    data = (unsigned char *)*memory + off;
    if (size > 0) memcpy(data, from, size);
    return data;
}

/* What a record asks, whatever comes of it. */
static void ask_record(const sc_model *model, sc_workspace *workspace, const sc_record *record)
{
    sc_pair pairs[2][4];
    sc_result result;
    sc_step_result collisions;
    sc_near_result found;
    sc_near_masks *masks = NULL;
    memset(&result, 0, sizeof(result));
    memset(&collisions, 0, sizeof(collisions));
    memset(&found, 0, sizeof(found));
    result.struct_size = sizeof(result);
    collisions.struct_size = sizeof(collisions);
    found.struct_size = sizeof(found);
    result.pairs = collisions.vertex_faces = found.vertex_faces = pairs[0];
    collisions.edge_edges = found.edge_edges = pairs[1];
    result.capacity = collisions.vertex_face_capacity = collisions.edge_edge_capacity =
        found.vertex_face_capacity = found.edge_edge_capacity = 4;
    if (record->kind == SC_RECORD_QUERY) {
        sc_query(model, workspace, record->pose, record->options, &result);
    } else if (record->kind == SC_RECORD_STEP) {
        sc_query_step(model, workspace, record->pose, record->end, record->step_options,
                      &collisions);
    } else {
        if (record->mask_rings)
            FUZZ_CHECK(sc_near_masks_create(model, record->mask_rings, NULL, &masks) == SC_OK,
                       "%u rings", (unsigned)record->mask_rings);
        record->near_options->masks = masks;
        sc_query_near(model, workspace, record->pose, record->near_options, &found);
        sc_near_masks_free(masks);
    }
}

/* All methods and kinds, on a pose of small integers; and what a record asks, if there is one. */
static void ask_all(sc_model *model, const sc_record *record)
{
    const sc_workspace_options how = {.struct_size = sizeof(how),
                                      .flags = record ? SC_WORKSPACE_NEAR : 0};
    sc_workspace *workspace = NULL;
    sc_model_info info;
    double *positions;
    memset(&info, 0, sizeof(info));
    info.struct_size = sizeof(info);
    FUZZ_CHECK(sc_model_get_info(model, &info) == SC_OK, "a loaded model");
    FUZZ_CHECK(sc_workspace_create_for(model, &how, &workspace) == SC_OK, "a loaded model");
    positions = (double *)test_allocate(3 * (size_t)info.vertex_count * sizeof(double));
    for (size_t i = 0; i < 3 * (size_t)info.vertex_count; ++i) positions[i] = (double)(i * i % 7);
    for (uint32_t i = 0; i < 16; ++i) {
        enum { ROOM = 16 };
        sc_pair pairs[ROOM];
        sc_query_options o;
        sc_result result;
        sc_pose p = input_plain_pose(positions, info.vertex_count);
        sc_status status;
        memset(&o, 0, sizeof(o));
        o.struct_size = sizeof(o);
        o.method = i % 4;
        o.contour = i % 4 < 2 && i >= 8 ? SC_CONTOUR_STAR : SC_CONTOUR_DEFAULT;
        o.pairs = i / 4 % 2;
        o.contact = i / 8;
        memset(&result, 0, sizeof(result));
        result.struct_size = sizeof(result);
        result.pairs = pairs;
        result.capacity = ROOM;
        status = sc_query(model, workspace, &p, &o, &result);
        FUZZ_CHECK(status == SC_OK || status == SC_ERROR_SHORT_BUFFER, "status %d", (int)status);
        if (i == 0 && record) ask_record(model, workspace, record);
    }
    free(positions);
    for (uint32_t level = 0; level < info.level_count; ++level) {
        uint32_t *patches = (uint32_t *)test_allocate(info.triangle_count * sizeof(uint32_t));
        FUZZ_CHECK(sc_model_get_patches(model, level, patches, info.triangle_count) == SC_OK,
                   "level %u", (unsigned)level);
        for (uint32_t t = 0; t < info.triangle_count; ++t)
            FUZZ_CHECK(patches[t] < info.triangle_count, "patch %u", (unsigned)patches[t]);
        free(patches);
    }
    sc_workspace_free(workspace);
}

static int load(const void *data, size_t size, uint32_t mode, const sc_record *record)
{
    sc_load_options load_options;
    sc_model *model = NULL;
    sc_status status;
    memset(&load_options, 0, sizeof(load_options));
    load_options.struct_size = sizeof(load_options);
    load_options.mode = mode;
    status = sc_model_load(data, size, &load_options, &model);
    FUZZ_CHECK((status == SC_OK) == (model != NULL), "status %d", (int)status);
    if (model) ask_all(model, record);
    sc_model_free(model);
    return status == SC_OK;
}

/* Whatever the bytes are: a model, a record, neither. */
static void read_bytes(const void *data, size_t size, uint32_t how)
{
    void *memory;
    unsigned char *copy = place(data, size, how & 1 ? how % 64 : 0, &memory);
    record_opened o;
    load(copy, size, SC_LOAD_COPY, NULL);
    if (!(how & 1)) load(copy, size, SC_LOAD_IN_PLACE, NULL);
    record_make_room(&o);
    if (sc_record_read(copy, size, &o.record) == SC_OK)
        load(o.record.model, (size_t)o.record.model_size, SC_LOAD_COPY, &o.record);
    free(memory);
}

static void seal(unsigned char *data, size_t size)
{
    sc_saved_header header;
    char magic[8];
    memcpy(&header, data, sizeof(header));
    memcpy(magic, header.magic, sizeof(magic));
    sc_saved_seal(&header, magic, header.version, size, data + sizeof(header));
    memcpy(data, &header, sizeof(header));
}

/* Replaces numbers and makes the checksum right. */
static void edit(fuzz_bytes *bytes, unsigned char *data, size_t size, size_t from)
{
    for (uint32_t i = 0; i < MAXIMUM_EDITS && bytes->left > 0; ++i) {
        size_t at = from + (size_t)fuzz_number(bytes, 3) % (size - from);
        uint32_t how = fuzz_byte(bytes), number;
        if (how % 4 == 0) {
            data[at] = (unsigned char)fuzz_byte(bytes);
            continue;
        }
        at = at / 4 * 4;
        if (at < from || at + 4 > size) continue;
        memcpy(&number, data + at, 4);
        if (how % 4 == 1)
            number = fuzz_byte(bytes);
        else if (how % 4 == 2)
            number += (how & 4) ? 1u + how / 8 : (uint32_t)0 - 1u - how / 8;
        else
            number = (uint32_t)fuzz_number(bytes, 4);
        memcpy(data + at, &number, 4);
    }
    seal(data, size);
}

/* Some filter, or none, in options of every kind; of two filters both are the same. */
static void set_filter(const soup *s, uint32_t how, record_opened *o, sc_group *groups,
                       sc_pair ignore[2])
{
    sc_filter *filter = &o->filter[0];
    memset(groups, 0xff, (s->vertex_count + (size_t)s->triangle_count) * sizeof(*groups));
    memset(ignore, 0, 2 * sizeof(*ignore));
    ignore[0].b = ignore[1].b = 1;
    memset(filter, 0, sizeof(*filter));
    filter->struct_size = sizeof(*filter);
    if (how & 2) filter->vertex_groups = groups;
    if (how & 4) filter->triangle_groups = groups + s->vertex_count;
    if ((how & 8) && s->triangle_count > 1) {
        filter->ignore = ignore;
        filter->ignore_count = 2;
    }
    filter->ignore_rings = how >> 4 & 3;
    memset(&o->query, 0, sizeof(o->query));
    memset(&o->step, 0, sizeof(o->step));
    memset(&o->near_options, 0, sizeof(o->near_options));
    o->query.struct_size = sizeof(o->query);
    o->step.struct_size = sizeof(o->step);
    o->near_options.struct_size = sizeof(o->near_options);
    if (!(how & 1)) return;
    o->query.filter = o->step.vertex_face_filter = o->near_options.vertex_face_filter = filter;
    o->step.edge_edge_filter = o->near_options.edge_edge_filter = filter;
    o->step.rest = o->near_options.rest = &o->pose[REST];
}

/* A record of a kind of the pose, at which a step stays. To be freed. */
static unsigned char *write_record(const sc_model *model, const record_opened *o, uint32_t kind,
                                   uint64_t *size)
{
    const record_question q = {kind,          model,    &o->pose[START],
                               &o->pose[END], &o->step, &o->near_options};
    const int is_query = kind == SC_RECORD_QUERY;
    unsigned char *data;
    FUZZ_CHECK((is_query ? sc_record_size(model, q.start, &o->query, size)
                         : record_size_of(&q, size)) == SC_OK,
               "a good question");
    data = (unsigned char *)test_allocate((size_t)*size);
    FUZZ_CHECK((is_query ? sc_record_write(model, q.start, &o->query, data, *size, NULL)
                         : record_write_to(&q, data, *size, NULL)) == SC_OK,
               "a good question");
    return data;
}

/* A save or a record of a mesh made from the bytes, changed by what follows. */
static void read_edited(fuzz_bytes *bytes, uint32_t how)
{
    soup s = fuzz_mesh(bytes, 0);
    const uint32_t kind = s.triangle_count % 3;
    sc_mesh mesh = input_plain_mesh(&s);
    input_choices choices;
    sc_near_masks *masks = NULL;
    sc_model *model = NULL;
    uint64_t size = 0, model_size;
    unsigned char *data;
    record_opened o;
    sc_pair ignore[2];
    sc_group *groups =
        (sc_group *)test_allocate((s.vertex_count + (size_t)s.triangle_count) * sizeof(*groups));
    test_random_reset(how);
    choices = input_choose(&s, how % 3, how / 4 % 4);
    FUZZ_CHECK(sc_build(&mesh, &choices.options, &model) == SC_OK, "a good mesh");
    FUZZ_CHECK(sc_model_save_size(model, &model_size) == SC_OK, "a good model");
    for (int k = 0; k < POSES; ++k) o.pose[k] = input_plain_pose(s.positions, s.vertex_count);
    set_filter(&s, how, &o, groups, ignore);
    if (how & 2) {
        FUZZ_CHECK(sc_near_masks_create(model, 1 + how % 3, NULL, &masks) == SC_OK, "good rings");
        o.near_options.masks = masks;
    }
    if (how & 64) {
        data = write_record(model, &o, kind, &size);
        /* the model of a record has a checksum of its own */
        if (how & 128) {
            const size_t at = (kind == SC_RECORD_QUERY ? 3 : 4) * (size_t)SC_ALIGNMENT;
            edit(bytes, data + at, (size_t)model_size, sizeof(sc_saved_header));
            seal(data, (size_t)size);
        } else {
            edit(bytes, data, (size_t)size, sizeof(sc_saved_header));
        }
    } else {
        size = model_size;
        data = (unsigned char *)test_allocate((size_t)size);
        FUZZ_CHECK(sc_model_save(model, data, size, NULL) == SC_OK, "a good model");
        edit(bytes, data, (size_t)size, sizeof(sc_saved_header));
    }
    read_bytes(data, (size_t)size, how & 128 ? how : 0);
    free(data);
    free(groups);
    sc_near_masks_free(masks);
    sc_model_free(model);
    input_free_choices(&choices);
    soup_free(&s);
}

int fuzz_load(const uint8_t *data, size_t size)
{
    fuzz_bytes bytes = {data, size};
    uint32_t kind = fuzz_byte(&bytes), how = fuzz_byte(&bytes);
    if (kind == 0x93) { /* saved data begin like this */
        read_bytes(data, size, how);
    } else if (kind < 16) {
        read_bytes(bytes.at, bytes.left, how);
    } else if (kind < 32 && bytes.left >= sizeof(sc_saved_header)) {
        uint8_t *copy = (uint8_t *)fuzz_copy(bytes.at, bytes.left);
        seal(copy, bytes.left);
        read_bytes(copy, bytes.left, how);
        free(copy);
    } else {
        read_edited(&bytes, how);
    }
    return 0;
}
