/*
 * Records of steps and of searches for what is near: what is read is what was written, and gives
 * the same answer; whatever else is offered is refused, or asks what is refused, or does no harm.
 * Records of queries are test_records.c's.
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
#include "record_ask.h"
#include "shapes.h"
#include "starcontour.h"

/* ---- subjects ---- */

/* A mesh in motion, and any question about it. */
typedef struct subject {
    soup mesh;
    input_choices choices;
    input_array positions[POSES];
    sc_pose pose[POSES];
    sc_model *model;
    sc_model_info info;
    sc_near_masks *masks;
    sc_group *groups;
    sc_filter filter[KINDS];
    record_answer all; /* without filters: what there is to be ignored */
    sc_step_options step;
    sc_near_options near_options;
    record_question q;
} subject;

static void random_groups(sc_group *groups, uint32_t count)
{
    for (uint32_t i = 0; i < count; ++i) {
        groups[i].category = 1u << test_random_below(3);
        groups[i].mask = test_random_below(8) | test_random_below(8);
    }
}

static void random_options(subject *s, uint32_t i)
{
    static const double distances[] = {0, 1e-3, 0.03, 0.15};
    const double distance = distances[test_random_below(4)];
    memset(&s->step, 0, sizeof(s->step));
    s->step.struct_size = sizeof(s->step);
    s->step.output = test_random_below(5) % 3;
    s->step.pairs = test_random_below(4) == 0;
    s->step.times = test_random_below(3);
    s->step.method = test_random_below(4);
    s->step.contour = test_random_below(4);
    s->step.simd = test_random_below(2);
    s->step.separation = distance;
    s->step.tolerance = test_random_below(2) ? 1e-5 : 0;
    s->step.begun = test_random_below(2);
    s->step.budget = i % 7 == 0 ? 500 : 0;
    memset(&s->near_options, 0, sizeof(s->near_options));
    s->near_options.struct_size = sizeof(s->near_options);
    s->near_options.output = s->step.output;
    s->near_options.kinds = test_random_below(3);
    s->near_options.method = test_random_below(3);
    s->near_options.simd = s->step.simd;
    s->near_options.distance = distance;
    s->near_options.budget = s->step.budget;
}

/* Any parts of a filter of one kind, at random. */
static void random_filter(subject *s, int kind)
{
    sc_filter *f = &s->filter[kind];
    const uint32_t parts = test_random_below(16);
    memset(f, 0, sizeof(*f));
    f->struct_size = sizeof(*f);
    if (parts & 1) f->vertex_groups = s->groups + kind;
    if (parts & 2) f->triangle_groups = s->groups + s->mesh.vertex_count + 1 + kind;
    if (parts & 4) f->ignore_rings = test_random_below(4);
    if ((parts & 8) && s->all.count[kind]) {
        f->ignore = s->all.pairs[kind];
        f->ignore_count = s->all.count[kind] / 2;
    }
    if (f->ignore_count == 0) f->ignore = NULL;
    if (test_random_below(4) == 0) return;
    *(kind == VERTEX_FACE ? &s->step.vertex_face_filter : &s->step.edge_edge_filter) = f;
    *(kind == VERTEX_FACE ? &s->near_options.vertex_face_filter
                          : &s->near_options.edge_edge_filter) = f;
}

/* Any mesh, question i of a kind, any options. */
static int open_subject(subject *s, uint32_t kind, uint32_t i)
{
    const char *name;
    sc_mesh m;
    memset(s, 0, sizeof(*s));
    s->mesh = shape_any(100, &name);
    s->choices = input_choose(&s->mesh, i % 3, i % 4);
    m = input_plain_mesh(&s->mesh);
    if (!CHECK(sc_build(&m, &s->choices.options, &s->model) == SC_OK)) return 0;
    s->info.struct_size = sizeof(s->info);
    CHECK(sc_model_get_info(s->model, &s->info) == SC_OK);
    for (int k = POSES - 1; k >= 0; --k) {
        if (k != REST) soup_any_pose(s->mesh.positions, s->mesh.vertex_count);
        s->positions[k] =
            input_positions(s->mesh.positions, s->mesh.vertex_count,
                            test_random_below(2) ? SC_FLOAT : SC_DOUBLE, test_random_below(6));
        s->pose[k] = input_pose(s->mesh.vertex_count, &s->positions[k]);
    }
    s->q.kind = kind;
    s->q.model = s->model;
    s->q.start = &s->pose[START];
    s->q.end = &s->pose[END];
    s->q.step = &s->step;
    s->q.near_options = &s->near_options;
    random_options(s, i);
    s->step.output = s->near_options.output = SC_OUTPUT_PAIRS;
    s->all = record_ask(&s->q);
    random_options(s, i);
    const uint32_t groups = s->mesh.vertex_count + s->mesh.triangle_count + 4;
    s->groups = (sc_group *)test_allocate(groups * sizeof(*s->groups));
    random_groups(s->groups, groups);
    for (int k = 0; k < KINDS; ++k) random_filter(s, k);
    if (test_random_below(2)) {
        s->step.rest = s->near_options.rest = &s->pose[REST];
        s->step.rest_distance = s->near_options.rest_distance = 0.2 * test_random_unit();
    }
    if (kind == SC_RECORD_NEAR && test_random_below(2)) {
        CHECK(sc_near_masks_create(s->model, 1 + test_random_below(4), NULL, &s->masks) == SC_OK);
        s->near_options.masks = s->masks;
    }
    return 1;
}

static void close_subject(subject *s)
{
    for (int k = 0; k < POSES; ++k) input_free(&s->positions[k]);
    record_answer_free(&s->all);
    free(s->groups);
    sc_near_masks_free(s->masks);
    sc_model_free(s->model);
    input_free_choices(&s->choices);
    soup_free(&s->mesh);
}

/* ---- what comes back ---- */

static int is_same_array(const void *x, const void *y, uint64_t bytes)
{
    return !x || bytes == 0 ? !y : y && memcmp(x, y, (size_t)bytes) == 0;
}

static int is_all_zero(const void *structure, size_t size) /* but for struct_size */
{
    for (size_t i = sizeof(uint32_t); i < size; ++i)
        if (((const unsigned char *)structure)[i]) return 0;
    return 1;
}

/* Whether a filter came back, without its function. asked: NULL, if there was none. */
static int is_same_filter(const sc_filter *asked, const sc_filter *got, const subject *s)
{
    if (!asked) return is_all_zero(got, sizeof(*got));
    return got->ignore_rings == asked->ignore_rings && got->ignore_count == asked->ignore_count &&
           is_same_array(asked->ignore, got->ignore, asked->ignore_count * sizeof(sc_pair)) &&
           is_same_array(asked->vertex_groups, got->vertex_groups,
                         s->info.vertex_count * sizeof(sc_group)) &&
           is_same_array(asked->triangle_groups, got->triangle_groups,
                         s->info.triangle_count * sizeof(sc_group)) &&
           !got->accept && !got->accept_user;
}

/* Whether a pose came back, packed. asked: NULL, if there was none. */
static int is_same_pose(const sc_pose *asked, const sc_pose *got)
{
    if (!asked) return is_all_zero(got, sizeof(*got));
    const uint32_t bytes = asked->position_type == SC_DOUBLE ? 24 : 12;
    const uint32_t stride = asked->position_stride ? asked->position_stride : bytes;
    int same = got->vertex_count == asked->vertex_count && got->position_stride == 0 &&
               got->position_type == asked->position_type;
    for (uint32_t v = 0; v < asked->vertex_count && same; ++v) {
        same = memcmp((const char *)asked->positions + (size_t)v * stride,
                      (const char *)got->positions + (size_t)v * bytes, bytes) == 0;
    }
    return same;
}

/* Whether the record has everything that was asked, and nothing else. */
static void check_parts(const subject *s, const record_opened *o)
{
    const int is_step = s->q.kind == SC_RECORD_STEP;
    sc_step_options step = s->step;
    sc_near_options near_options = s->near_options;
    CHECK(o->record.kind == s->q.kind && o->record.left_out == 0);
    CHECK(is_same_pose(&s->pose[START], &o->pose[START]));
    CHECK(is_same_pose(is_step ? &s->pose[END] : NULL, &o->pose[END]));
    CHECK(is_same_pose(s->step.rest, &o->pose[REST]));
    CHECK(is_same_filter(s->step.vertex_face_filter, &o->filter[VERTEX_FACE], s));
    CHECK(is_same_filter(s->step.edge_edge_filter, &o->filter[EDGE_EDGE], s));
    CHECK(is_all_zero(&o->query, sizeof(o->query)));
    if (step.vertex_face_filter) step.vertex_face_filter = &o->filter[VERTEX_FACE];
    if (step.edge_edge_filter) step.edge_edge_filter = &o->filter[EDGE_EDGE];
    if (step.rest) step.rest = &o->pose[REST];
    near_options.vertex_face_filter = step.vertex_face_filter;
    near_options.edge_edge_filter = step.edge_edge_filter;
    near_options.rest = step.rest;
    near_options.masks = NULL;
    if (is_step) {
        CHECK(memcmp(&o->step, &step, sizeof(step)) == 0);
        CHECK(is_all_zero(&o->near_options, sizeof(o->near_options)) && !o->record.mask_rings);
    } else {
        CHECK(memcmp(&o->near_options, &near_options, sizeof(near_options)) == 0);
        CHECK(is_all_zero(&o->step, sizeof(o->step)));
        CHECK((o->record.mask_rings > 0) == (s->near_options.masks != NULL));
    }
}

/* Returns the number of pairs found. */
static uint64_t check_round_trip(const subject *s)
{
    const int is_filtered = s->step.vertex_face_filter || s->step.edge_edge_filter;
    uint64_t size = 0, written = 0;
    record_answer first = record_ask(&s->q);
    CHECK(record_size_of(&s->q, &size) == SC_OK);
    unsigned char *memory = (unsigned char *)test_allocate((size_t)size + 2 * SC_ALIGNMENT);
    for (uint32_t k = 0; k < 3; ++k) { /* aligned, and not */
        static const uint32_t offs[] = {0, 1, 4};
        unsigned char *data = memory + SC_ALIGNMENT - (uintptr_t)memory % SC_ALIGNMENT + offs[k];
        record_opened o;
        data[-1] = data[size] = 0x77;
        CHECK(record_write_to(&s->q, data, size, &written) == SC_OK);
        CHECK(written == size && data[-1] == 0x77 && data[size] == 0x77);
        if (is_filtered && offs[k] == 1) {
            CHECK(record_open(data, size + 1, &o) == SC_ERROR_ALIGNMENT);
            continue;
        }
        if (!CHECK(record_open(data, size + 1, &o) == SC_OK)) continue;
        CHECK(((uintptr_t)o.record.model % SC_ALIGNMENT == 0) == !offs[k]);
        check_parts(s, &o);
        record_answer again = record_replay(&o);
        CHECK(record_answers_are_same(&first, &again));
        record_answer_free(&again);
    }
    /* a short buffer is not written to */
    memset(memory, 0x33, (size_t)size);
    CHECK(record_write_to(&s->q, memory, size - 1, &written) == SC_ERROR_SHORT_BUFFER &&
          written == size);
    CHECK(record_write_to(&s->q, NULL, 0, &written) == SC_ERROR_SHORT_BUFFER && written == size);
    for (uint64_t at = 0; at < size; ++at)
        if (!CHECK(memory[at] == 0x33)) break;
    free(memory);
    written = first.count[VERTEX_FACE] + first.count[EDGE_EDGE];
    record_answer_free(&first);
    return written;
}

static void check_round_trips(uint32_t kind)
{
    uint64_t found = 0, without = 0;
    for (uint32_t i = 0; i < test_iterations_at_least(150, 60); ++i) {
        subject s;
        if (open_subject(&s, kind, i)) {
            found += check_round_trip(&s);
            without += s.all.count[VERTEX_FACE] + s.all.count[EDGE_EDGE];
        }
        close_subject(&s);
    }
    CHECK(found > 100 && without > found + 100);
}

static void steps(void)
{
    check_round_trips(SC_RECORD_STEP);
}

static void searches(void)
{
    check_round_trips(SC_RECORD_NEAR);
}

/* ---- what is no record ---- */

/* A small record, with everything or with nothing that may be left out. */
typedef struct small_record {
    subject s;
    sc_group room[128];
    sc_pair ignore[3];
    unsigned char *memory, *data;
    uint64_t size, model_size;
} small_record;

static void rewrite(small_record *r)
{
    free(r->memory);
    CHECK(record_size_of(&r->s.q, &r->size) == SC_OK);
    r->memory = (unsigned char *)test_allocate((size_t)r->size + SC_ALIGNMENT);
    r->data = r->memory + SC_ALIGNMENT - (uintptr_t)r->memory % SC_ALIGNMENT;
    CHECK(record_write_to(&r->s.q, r->data, r->size, NULL) == SC_OK);
}

static void open_small(small_record *r, uint32_t kind, int is_full)
{
    subject *s = &r->s;
    sc_mesh m;
    memset(r, 0, sizeof(*r));
    s->mesh = soup_cloth(3, 4);
    CHECK(s->mesh.vertex_count <= 64 && s->mesh.triangle_count <= 64);
    m = input_plain_mesh(&s->mesh);
    CHECK(sc_build(&m, NULL, &s->model) == SC_OK);
    CHECK(sc_model_save_size(s->model, &r->model_size) == SC_OK);
    for (int k = POSES - 1; k >= 0; --k) {
        if (k == END) soup_fold(s->mesh.positions, s->mesh.vertex_count);
        s->positions[k] = input_positions(s->mesh.positions, s->mesh.vertex_count,
                                          k == START ? SC_DOUBLE : SC_FLOAT, 0);
        s->pose[k] = input_pose(s->mesh.vertex_count, &s->positions[k]);
    }
    s->step.struct_size = sizeof(s->step);
    s->step.separation = 0.6;
    s->near_options.struct_size = sizeof(s->near_options);
    s->near_options.distance = 0.6;
    s->q = (record_question){kind,          s->model, &s->pose[START],
                             &s->pose[END], &s->step, &s->near_options};
    memset(r->room, 0xff, sizeof(r->room));
    for (int k = 0; k < 3; ++k) r->ignore[k] = (sc_pair){0, 1 + (uint32_t)k};
    for (int k = 0; k < KINDS; ++k) {
        sc_filter *f = &s->filter[k];
        f->struct_size = sizeof(*f);
        f->vertex_groups = f->triangle_groups = r->room;
        f->ignore = r->ignore;
        f->ignore_count = 3 - (uint32_t)k;
    }
    if (is_full) {
        s->step.vertex_face_filter = s->near_options.vertex_face_filter = &s->filter[VERTEX_FACE];
        s->step.edge_edge_filter = s->near_options.edge_edge_filter = &s->filter[EDGE_EDGE];
        s->step.rest = s->near_options.rest = &s->pose[REST];
        s->step.rest_distance = s->near_options.rest_distance = 0.01;
        if (kind == SC_RECORD_NEAR) {
            CHECK(sc_near_masks_create(s->model, 2, NULL, &s->masks) == SC_OK);
            s->near_options.masks = s->masks;
        }
    }
    rewrite(r);
}

static void close_small(small_record *r)
{
    close_subject(&r->s);
    free(r->memory);
}

static void seal(unsigned char *data, uint64_t size)
{
    sc_saved_header *header = (sc_saved_header *)(void *)data;
    char magic[8];
    memcpy(magic, header->magic, sizeof(magic));
    sc_saved_seal(header, magic, header->version, size, data + sizeof(*header));
}

/* The four small records. */
enum { SMALL_RECORDS = 4 };

static void open_small_of(small_record *r, int which)
{
    open_small(r, which & 1 ? SC_RECORD_STEP : SC_RECORD_NEAR, which & 2);
}

static void cut_off_and_changed(void)
{
    for (int which = 0; which < SMALL_RECORDS; ++which) {
        small_record r;
        record_opened o;
        sc_model *model = NULL;
        open_small_of(&r, which);
        for (uint64_t size = 0; size < r.size; size += size < 400 ? 1 : 13) {
            unsigned char *bytes = (unsigned char *)test_allocate(size ? (size_t)size : 1);
            memcpy(bytes, r.data, (size_t)size);
            CHECK(record_open(bytes, size, &o) == SC_ERROR_TRUNCATED);
            free(bytes);
        }
        for (uint64_t at = 0; at < r.size; ++at) {
            r.data[at] ^= 4;
            CHECK_MSG(record_open(r.data, r.size, &o) != SC_OK, "byte %" PRIu64, at);
            r.data[at] ^= 4;
        }
        CHECK(sc_model_load(r.data, r.size, NULL, &model) == SC_ERROR_NOT_SAVED);
        CHECK(record_open(r.data, r.size, &o) == SC_OK);
        close_small(&r);
    }
}

/* Any byte changed and the checksum made right, alone and by tens: refused somewhere, or
   answered. */
static void forged(void)
{
    for (int which = 0; which < SMALL_RECORDS; ++which) {
        small_record r;
        uint32_t refused = 0, rounds = test_iterations(2000);
        open_small_of(&r, which);
        const uint32_t span = (uint32_t)(r.size - sizeof(sc_saved_header));
        unsigned char *kept = (unsigned char *)test_allocate((size_t)r.size);
        memcpy(kept, r.data, (size_t)r.size);
        for (uint32_t i = 0; i < rounds; ++i) {
            const uint32_t changes = i < span ? 1 : 1 + test_random_below(10);
            record_opened o;
            sc_status status;
            for (uint32_t k = 0; k < changes; ++k) {
                const uint32_t at = i < span ? i : test_random_below(span);
                r.data[sizeof(sc_saved_header) + at] = (unsigned char)test_random_below(256);
            }
            seal(r.data, r.size);
            status = record_open(r.data, r.size, &o);
            if (!status) {
                record_answer a = record_replay(&o);
                status = a.status;
                record_answer_free(&a);
            }
            refused += status != SC_OK;
            memcpy(r.data, kept, (size_t)r.size);
        }
        CHECK(refused > rounds / 4);
        free(kept);
        close_small(&r);
    }
}

/* The record with a number of so many bytes made another. */
static sc_status forge(small_record *r, uint64_t at, uint32_t bytes, uint64_t number)
{
    unsigned char *place = r->data + sizeof(sc_saved_header) + at, kept[8];
    const uint32_t narrow = (uint32_t)number;
    sc_status status;
    record_opened o;
    memcpy(kept, place, bytes);
    memcpy(place, bytes == 4 ? (const void *)&narrow : (const void *)&number, bytes);
    seal(r->data, r->size);
    status = record_open(r->data, r->size, &o);
    memcpy(place, kept, bytes);
    return status;
}

/* Where the question of a record has its numbers. */
enum {
    MODEL_BYTES = 0,
    FILTER = 16, /* of each: how many pairs to ignore, HAS_..., rings */
    FILTER_PARTS = 8,
    FILTER_BYTES = 16,
    KIND = 72,
    VERTICES = 76,
    TRIANGLES = 80,
    TYPES = 84,
    MASK_RINGS = 124,
    LEFT_OUT = 128,
    QUESTION_BYTES = 192,
    HAS_ALL = 7
};

/* Sizes and counts that would reach beyond the record, or beyond one of its arrays. */
static void check_forged_counts(small_record *r, int is_full)
{
    const uint32_t vertices = r->s.mesh.vertex_count, triangles = r->s.mesh.triangle_count;
    for (uint32_t k = 0; k < 4; ++k) {
        const uint64_t off = k == 0 ? 8 : k == 1 ? 64 : k == 2 ? UINT64_MAX / 8 + 1 : 1ull << 63;
        CHECK(forge(r, MODEL_BYTES, 8, r->model_size + off) == SC_ERROR_INCONSISTENT);
        CHECK(forge(r, FILTER, 8, off) == SC_ERROR_INCONSISTENT);
        CHECK(forge(r, FILTER + FILTER_BYTES, 8, off) == SC_ERROR_INCONSISTENT);
        CHECK(forge(r, VERTICES, 4, vertices + off + 1) == SC_ERROR_INCONSISTENT);
    }
    for (uint64_t at = FILTER; at <= FILTER + FILTER_BYTES; at += FILTER_BYTES) {
        unsigned char *count = r->data + sizeof(sc_saved_header) + at;
        uint64_t kept, more;
        memcpy(&kept, count, sizeof(kept));
        CHECK(forge(r, at, 8, kept + (UINT64_MAX / 8 + 1)) == SC_ERROR_INCONSISTENT);
        more = kept + r->model_size / 8 + 1; /* room for more than the model has */
        memcpy(count, &more, sizeof(more));
        CHECK(forge(r, MODEL_BYTES, 8, r->model_size - 8 * (more - kept)) == SC_ERROR_INCONSISTENT);
        memcpy(count, &kept, sizeof(kept));
        CHECK(forge(r, at + FILTER_PARTS, 4, HAS_ALL + 1) == SC_ERROR_INCONSISTENT);
        CHECK(forge(r, at + FILTER_PARTS, 4, HAS_ALL - 1) == SC_ERROR_INCONSISTENT);
        if (is_full) { /* what one array loses another gains */
            more = kept + 2 * (uint64_t)triangles - 2;
            memcpy(count, &more, sizeof(more));
            CHECK(forge(r, TRIANGLES, 4, 1) == SC_ERROR_INCONSISTENT);
            more = kept + triangles;
            memcpy(count, &more, sizeof(more));
            CHECK(forge(r, at + FILTER_PARTS, 4, 1 | 2) == SC_OK);
            more = kept + triangles + vertices;
            memcpy(count, &more, sizeof(more));
            CHECK(forge(r, at + FILTER_PARTS, 4, 1) == SC_OK);
            CHECK(forge(r, at + FILTER_PARTS, 4, 0) == SC_ERROR_INCONSISTENT);
        } else {
            more = 1; /* a pair to ignore, and no filter */
            memcpy(count, &more, sizeof(more));
            CHECK(forge(r, MODEL_BYTES, 8, r->model_size - 8) == SC_ERROR_INCONSISTENT);
        }
        memcpy(count, &kept, sizeof(kept));
    }
    if (!is_full) {
        CHECK(forge(r, FILTER + FILTER_PARTS, 4, 1) == SC_OK); /* filters that leave out nothing */
        CHECK(forge(r, FILTER + FILTER_BYTES + FILTER_PARTS, 4, 1) == SC_OK);
        return;
    }
    --r->size; /* so that the arrays behind the model are not aligned */
    CHECK(forge(r, MODEL_BYTES, 8, r->model_size - 1) == SC_ERROR_INCONSISTENT);
    ++r->size;
    CHECK(forge(r, QUESTION_BYTES + offsetof(sc_saved_header, bytes), 8,
                sizeof(sc_saved_header) + 8) == SC_ERROR_INCONSISTENT);
}

/* Which kind it is, and which poses there are. */
static void check_forged_kinds(small_record *r, int is_full)
{
    const int is_step = r->s.q.kind == SC_RECORD_STEP;
    const uint32_t other = is_step ? SC_RECORD_NEAR : SC_RECORD_STEP;
    CHECK(forge(r, KIND, 4, SC_RECORD_QUERY) == SC_ERROR_INCONSISTENT);
    CHECK(forge(r, KIND, 4, 3) == SC_ERROR_INCONSISTENT);
    CHECK(forge(r, KIND, 4, other) == SC_ERROR_INCONSISTENT);
    for (uint32_t k = 0; k < POSES; ++k) {
        const int is_there = k == START || (k == END ? is_step : is_full);
        const uint64_t at = TYPES + 4 * (uint64_t)k;
        CHECK(forge(r, at, 4, 2) == SC_ERROR_INCONSISTENT);
        CHECK(forge(r, at, 4, k == START ? SC_FLOAT : SC_DOUBLE) == SC_ERROR_INCONSISTENT);
        CHECK(forge(r, at, 4, SC_NONE) == (is_there ? SC_ERROR_INCONSISTENT : SC_OK));
    }
    CHECK(forge(r, MASK_RINGS, 4, SC_RINGS_MAX) == (is_step ? SC_ERROR_INCONSISTENT : SC_OK));
    CHECK(forge(r, MASK_RINGS, 4, SC_RINGS_MAX + 1) == SC_ERROR_INCONSISTENT);
    CHECK(forge(r, LEFT_OUT, 4, 4) == SC_ERROR_INCONSISTENT);
    CHECK(forge(r, LEFT_OUT, 4, 3) == SC_OK);
}

/* A pose that is there and must not be, or the other way round, in a record of the right size. */
static void check_forged_poses(small_record *r)
{
    const uint32_t vertices = r->s.mesh.vertex_count;
    unsigned char *at = r->data + sizeof(sc_saved_header);
    uint32_t types[POSES], kept[POSES];
    memcpy(kept, at + TYPES, sizeof(kept));
    memcpy(types, kept, sizeof(types));
    const uint64_t size = r->size;
    if (r->s.q.kind == SC_RECORD_STEP) {
        r->size -= 12 * (uint64_t)vertices;
        types[END] = SC_NONE;
    } else { /* the rest pose is the end */
        types[END] = types[REST];
        types[REST] = SC_NONE;
    }
    memcpy(at + TYPES, types, sizeof(types));
    CHECK(forge(r, KIND, 4, r->s.q.kind) == SC_ERROR_INCONSISTENT);
    r->size = size - 24 * (uint64_t)vertices; /* no start */
    memcpy(types, kept, sizeof(types));
    types[START] = SC_NONE;
    memcpy(at + TYPES, types, sizeof(types));
    CHECK(forge(r, KIND, 4, r->s.q.kind) == SC_ERROR_INCONSISTENT);
    memcpy(at + TYPES, kept, sizeof(kept));
    r->size = size;
}

static void forged_numbers(void)
{
    for (int which = 0; which < SMALL_RECORDS; ++which) {
        small_record r;
        record_opened o;
        const int is_full = (which & 2) != 0;
        open_small_of(&r, which);
        check_forged_counts(&r, is_full);
        check_forged_kinds(&r, is_full);
        if (is_full) check_forged_poses(&r);
        seal(r.data, r.size);
        CHECK(record_open(r.data, r.size, &o) == SC_OK);
        seal(r.data, sizeof(sc_saved_header) + QUESTION_BYTES - 4);
        CHECK(record_open(r.data, r.size, &o) == SC_ERROR_INCONSISTENT);
        close_small(&r);
    }
}

/* ---- what is left out ---- */

static int32_t refuse(void *user, uint32_t a, uint32_t b)
{
    (void)a;
    (void)b;
    ++*(uint32_t *)user;
    return 0;
}

static void left_out(void)
{
    for (int which = 2; which < SMALL_RECORDS; ++which) {
        for (uint32_t k = 0; k < 8; ++k) {
            small_record r;
            record_opened o;
            uint32_t asked = 0;
            volatile uint32_t cancel = 1;
            open_small_of(&r, which);
            for (uint32_t f = 0; f < KINDS; ++f) {
                r.s.filter[f].accept = k >> f & 1 ? refuse : NULL;
                r.s.filter[f].accept_user = k >> f & 1 ? &asked : NULL;
            }
            r.s.step.cancel = r.s.near_options.cancel = k & 4 ? &cancel : NULL;
            rewrite(&r);
            CHECK(record_open(r.data, r.size, &o) == SC_OK);
            CHECK(o.record.left_out ==
                  ((k & 3 ? SC_LEFT_OUT_ACCEPT : 0u) | (k & 4 ? SC_LEFT_OUT_CANCEL : 0u)));
            CHECK(!o.step.cancel && !o.near_options.cancel);
            CHECK(!o.filter[0].accept && !o.filter[1].accept);
            record_answer a = record_replay(&o);
            CHECK(a.status == SC_OK && asked == 0 && a.found);
            record_answer_free(&a);
            close_small(&r);
        }
    }
}

/* Where a structure and the pointer to it are in a record_opened. */
typedef struct place {
    size_t structure, pointer;
} place;

static const place places[] = {
    {offsetof(record_opened, pose[START]), offsetof(record_opened, record.pose)},
    {offsetof(record_opened, pose[END]), offsetof(record_opened, record.end)},
    {offsetof(record_opened, pose[REST]), offsetof(record_opened, record.rest)},
    {offsetof(record_opened, query), offsetof(record_opened, record.options)},
    {offsetof(record_opened, step), offsetof(record_opened, record.step_options)},
    {offsetof(record_opened, near_options), offsetof(record_opened, record.near_options)},
    {offsetof(record_opened, filter[VERTEX_FACE]), offsetof(record_opened, record.filter)},
    {offsetof(record_opened, filter[EDGE_EDGE]), offsetof(record_opened, record.edge_edge_filter)}};

/* What may be NULL or small is so where the record has nothing of it, and refused elsewhere. */
static void places_of_parts(void)
{
    for (int which = 0; which < SMALL_RECORDS; ++which) {
        const int is_step = which & 1, is_full = (which & 2) != 0;
        const int needed[] = {1, is_step, is_full, 0, is_step, !is_step, is_full, is_full};
        small_record r;
        record_opened o, kept;
        open_small_of(&r, which);
        for (int k = 0; k < 8; ++k) {
            const uint32_t none = 4; /* a struct_size that is none */
            record_make_room(&o);
            memset((char *)&o + places[k].pointer, 0, sizeof(void *));
            kept = o;
            const sc_status status = sc_record_read(r.data, r.size, &o.record);
            CHECK_MSG(status == (needed[k] ? SC_ERROR_NULL : SC_OK), "record %d, part %d: %d",
                      which, k, (int)status);
            if (status) CHECK(memcmp(&o, &kept, sizeof(o)) == 0);
            record_make_room(&o);
            memcpy((char *)&o + places[k].structure, &none, sizeof(none));
            kept = o;
            CHECK(sc_record_read(r.data, r.size, &o.record) == SC_ERROR_STRUCT_SIZE);
            CHECK(memcmp(&o, &kept, sizeof(o)) == 0);
        }
        /* of before there was a filter, or a rest pose, in options; and a caller of before */
        record_make_room(&o);
        o.step.struct_size = (uint32_t)offsetof(sc_step_options, vertex_face_filter);
        o.near_options.struct_size = (uint32_t)offsetof(sc_near_options, vertex_face_filter);
        CHECK(sc_record_read(r.data, r.size, &o.record) ==
              (is_full ? SC_ERROR_STRUCT_SIZE : SC_OK));
        record_make_room(&o);
        o.filter[1].struct_size = (uint32_t)offsetof(sc_filter, ignore);
        CHECK(sc_record_read(r.data, r.size, &o.record) ==
              (is_full ? SC_ERROR_STRUCT_SIZE : SC_OK));
        record_make_room(&o);
        o.record.struct_size = (uint32_t)offsetof(sc_record, kind);
        CHECK(sc_record_read(r.data, r.size, &o.record) == SC_ERROR_NULL && !o.record.model);
        close_small(&r);
    }
}

/* A record of a query, read by who knows all kinds. */
static void queries(void)
{
    small_record r;
    record_opened o;
    uint64_t size = 0;
    sc_query_options options;
    open_small(&r, SC_RECORD_STEP, 1);
    memset(&options, 0, sizeof(options));
    options.struct_size = sizeof(options);
    options.filter = &r.s.filter[VERTEX_FACE];
    options.pairs = SC_PAIRS_EDGE;
    CHECK(sc_record_size(r.s.model, &r.s.pose[START], &options, &size) == SC_OK && size <= r.size);
    CHECK(sc_record_write(r.s.model, &r.s.pose[START], &options, r.data, size, NULL) == SC_OK);
    CHECK(record_open(r.data, size, &o) == SC_OK);
    CHECK(o.record.kind == SC_RECORD_QUERY && o.record.mask_rings == 0);
    CHECK(o.query.pairs == SC_PAIRS_EDGE && o.query.filter == &o.filter[VERTEX_FACE]);
    CHECK(is_same_pose(&r.s.pose[START], &o.pose[START]));
    CHECK(is_all_zero(&o.pose[END], sizeof(sc_pose)) &&
          is_all_zero(&o.pose[REST], sizeof(sc_pose)));
    CHECK(is_all_zero(&o.step, sizeof(o.step)) &&
          is_all_zero(&o.near_options, sizeof(o.near_options)) &&
          is_all_zero(&o.filter[EDGE_EDGE], sizeof(sc_filter)));
    record_make_room(&o);
    o.record.options = NULL;
    CHECK(sc_record_read(r.data, size, &o.record) == SC_ERROR_NULL && !o.record.model);
    close_small(&r);
}

/* ---- arguments ---- */

/* What is refused of a question, whatever the kind, when it is sized and when it is written. */
static int is_refused(small_record *r, sc_status expected)
{
    uint64_t size = 7, written = 7;
    return record_size_of(&r->s.q, &size) == expected && size == 7 &&
           record_write_to(&r->s.q, r->data, r->size, &written) == expected && written == 0;
}

static void questions(void)
{
    for (int which = 0; which < SMALL_RECORDS; ++which) {
        small_record r;
        const int is_step = which & 1;
        open_small_of(&r, which);
        subject *s = &r.s;
        const subject kept = *s;
        CHECK(record_size_of(&s->q, NULL) == SC_ERROR_NULL);
        CHECK(record_write_to(&s->q, NULL, r.size, NULL) == SC_ERROR_NULL);
        s->q.model = NULL;
        CHECK(is_refused(&r, SC_ERROR_NULL));
        s->q.model = kept.model;
        for (int k = 0; k < POSES; ++k) {
            if (k == END && !is_step) continue;
            if (k == REST && !(which & 2)) continue;
            ++s->pose[k].vertex_count;
            CHECK(is_refused(&r, SC_ERROR_VERTEX_COUNT));
            --s->pose[k].vertex_count;
            s->pose[k].position_type = 2;
            CHECK(is_refused(&r, SC_ERROR_OPTION));
            s->pose[k].position_type = SC_DOUBLE;
            s->pose[k].position_stride = 23;
            CHECK(is_refused(&r, SC_ERROR_STRIDE));
            s->pose[k].position_stride = 0;
            s->pose[k].positions = NULL;
            CHECK(is_refused(&r, SC_ERROR_NULL));
            s->pose[k].struct_size = 8;
            CHECK(is_refused(&r, SC_ERROR_STRUCT_SIZE));
            s->pose[k] = kept.pose[k];
        }
        s->q.start = NULL;
        CHECK(is_refused(&r, SC_ERROR_NULL));
        s->q.start = &s->pose[START];
        s->q.end = NULL;
        CHECK(!is_step || is_refused(&r, SC_ERROR_NULL));
        s->q.end = &s->pose[END];
        s->step.method = s->near_options.method = 77;
        CHECK(is_refused(&r, SC_ERROR_OPTION));
        s->step.method = s->near_options.method = 0;
        s->step.separation = s->near_options.distance = (double)NAN;
        CHECK(is_refused(&r, SC_ERROR_OPTION));
        s->step.separation = s->near_options.distance = 0.5;
        s->step.rest = s->near_options.rest = NULL;
        s->step.rest_distance = s->near_options.rest_distance = 0.5;
        CHECK(is_refused(&r, SC_ERROR_NULL));
        s->step.rest_distance = s->near_options.rest_distance = -1;
        CHECK(is_refused(&r, SC_ERROR_OPTION));
        s->step.rest_distance = s->near_options.rest_distance = 0;
        s->step.struct_size = s->near_options.struct_size = 4;
        CHECK(is_refused(&r, SC_ERROR_STRUCT_SIZE));
        s->step = kept.step;
        s->near_options = kept.near_options;
        s->q.step = NULL; /* all defaults */
        s->q.near_options = NULL;
        rewrite(&r);
        record_opened o;
        CHECK(record_open(r.data, r.size, &o) == SC_OK);
        CHECK(is_all_zero(&o.step, sizeof(o.step)));
        CHECK(is_all_zero(&o.near_options, sizeof(o.near_options)));
        close_small(&r);
    }
}

/* Filters that nothing takes, of either kind; masks of another model; a model without culling. */
static void bad_filters(void)
{
    for (int which = 2; which < SMALL_RECORDS; ++which) {
        small_record r, other;
        open_small_of(&r, which);
        open_small_of(&other, which);
        for (int k = 0; k < KINDS; ++k) {
            sc_filter *f = &r.s.filter[k];
            const sc_filter kept = *f;
            f->ignore_rings = SC_RINGS_MAX + 1;
            CHECK(is_refused(&r, SC_ERROR_OPTION));
            f->ignore_rings = SC_RINGS_MAX;
            r.ignore[0].b = 1000;
            CHECK(is_refused(&r, SC_ERROR_PAIRS));
            r.ignore[0].b = 1;
            f->ignore = NULL;
            CHECK(is_refused(&r, SC_ERROR_NULL));
            f->struct_size = sizeof(void *) / 2;
            CHECK(is_refused(&r, SC_ERROR_STRUCT_SIZE));
            *f = kept;
        }
        if (r.s.q.kind == SC_RECORD_NEAR) {
            r.s.near_options.masks = other.s.masks;
            CHECK(is_refused(&r, SC_ERROR_OPTION));
            r.s.near_options.masks = NULL;
        }
        const sc_build_options build = {.struct_size = sizeof(build), .content = SC_MODEL_BOXES};
        sc_mesh m = input_plain_mesh(&r.s.mesh);
        sc_model *boxes = NULL;
        CHECK(sc_build(&m, &build, &boxes) == SC_OK);
        r.s.q.model = boxes;
        r.s.step.method = r.s.near_options.method = 1; /* by the test tree */
        CHECK(is_refused(&r, SC_ERROR_BOXES_ONLY));
        r.s.step.method = r.s.near_options.method = 2;
        uint64_t size = 0;
        CHECK(record_size_of(&r.s.q, &size) == SC_OK && size < r.size);
        sc_model_free(boxes);
        close_small(&other);
        close_small(&r);
    }
}

/* What would be refused for its poses is recorded all the same. */
static void not_finite(void)
{
    for (int k = 0; k < POSES; ++k) {
        small_record r;
        record_opened o;
        const double nan = (double)NAN;
        const float nan_float = (float)NAN;
        open_small(&r, SC_RECORD_STEP, 1);
        if (k == START)
            memcpy(r.s.positions[k].data + 56, &nan, sizeof(nan));
        else
            memcpy(r.s.positions[k].data + 28, &nan_float, sizeof(nan_float));
        rewrite(&r);
        CHECK(record_open(r.data, r.size, &o) == SC_OK);
        record_answer a = record_replay(&o);
        CHECK(a.status == SC_ERROR_NOT_FINITE);
        record_answer_free(&a);
        close_small(&r);
    }
}

SC_TEST_MAIN(SC_TEST(steps), SC_TEST(searches), SC_TEST(cut_off_and_changed), SC_TEST(forged),
             SC_TEST(forged_numbers), SC_TEST(left_out), SC_TEST(places_of_parts), SC_TEST(queries),
             SC_TEST(questions), SC_TEST(bad_filters), SC_TEST(not_finite))
