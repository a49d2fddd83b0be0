/*
 * One query, step or search for what is near as bytes. See recording.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "query/recording.h"

#include <string.h>

#include "base/saved.h"
#include "build/saved_model.h"

static const char RECORD_MAGIC[8] = {'\x93', 'S', 'C', 'R', '\r', '\n', '\x1a', '\n'};

/* Of queries; and of steps and searches. Raised, both by 2, whenever what follows the header
   changes, but for the model, which has a version of its own. */
enum { RECORD_VERSION = 1, FEATURES_VERSION = 2 };

/* What of a filter there is. */
enum { HAS_FILTER = 1, HAS_VERTEX_GROUPS = 2, HAS_TRIANGLE_GROUPS = 4, HAS_ALL = 7 };

typedef struct filter_parts {
    uint64_t ignore_count;
    uint32_t parts, ignore_rings; /* HAS_... */
} filter_parts;

/* Of a query. Alignment units, so that the model behind them is aligned. */
typedef struct question {
    uint64_t model_bytes;
    uint64_t budget;
    uint64_t ignore_count;
    uint32_t vertex_count, triangle_count, position_type;
    uint32_t output, pairs, contact, method, contour, rest_cache, simd;
    uint32_t parts, ignore_rings; /* HAS_..., of the filter */
    uint32_t left_out;            /* SC_LEFT_OUT_... */
    uint32_t unused[13];          /* 0 */
} question;

typedef char question_is_two_units[sizeof(question) == 2 * SC_ALIGNMENT ? 1 : -1];

/* Of a step or a search; the latter as sc_recorded has it. */
typedef struct features_question {
    uint64_t model_bytes;
    uint64_t budget;
    filter_parts filter[2]; /* of vertices and faces, of two edges */
    double separation, tolerance, rest_distance;
    uint32_t kind; /* SC_RECORD_... */
    uint32_t vertex_count, triangle_count;
    uint32_t position_type[SC_RECORDED_POSES]; /* SC_NONE: there is no such pose */
    uint32_t output, pairs, times, method, contour, simd, begun;
    uint32_t mask_rings;
    uint32_t left_out;   /* SC_LEFT_OUT_... */
    uint32_t unused[15]; /* 0 */
} features_question;

typedef char features_are_three_units[sizeof(features_question) == 3 * SC_ALIGNMENT ? 1 : -1];

/* ---- sizes ---- */

static uint64_t vertex_bytes(uint32_t position_type)
{
    return 3 * (position_type == SC_DOUBLE ? sizeof(double) : sizeof(float));
}

static filter_parts parts_of(const sc_filter *filter)
{
    filter_parts f;
    memset(&f, 0, sizeof f);
    if (!filter) return f;
    f.parts = HAS_FILTER;
    if (filter->vertex_groups) f.parts |= HAS_VERTEX_GROUPS;
    if (filter->triangle_groups) f.parts |= HAS_TRIANGLE_GROUPS;
    f.ignore_rings = filter->ignore_rings;
    f.ignore_count = filter->ignore_count;
    return f;
}

static filter_parts parts_asked(const question *q)
{
    filter_parts f;
    f.ignore_count = q->ignore_count;
    f.parts = q->parts;
    f.ignore_rings = q->ignore_rings;
    return f;
}

static uint64_t filter_bytes(const filter_parts *f, uint64_t vertex_count, uint64_t triangle_count)
{
    return (f->parts & HAS_VERTEX_GROUPS ? vertex_count * sizeof(sc_group) : 0) +
           (f->parts & HAS_TRIANGLE_GROUPS ? triangle_count * sizeof(sc_group) : 0) +
           f->ignore_count * sizeof(sc_pair);
}

/* Counts of pairs and model_bytes are at most those of something in memory: no overflow. */
static uint64_t bytes_of(const question *q)
{
    const filter_parts f = parts_asked(q);
    return sizeof(sc_saved_header) + sizeof *q + q->model_bytes +
           filter_bytes(&f, q->vertex_count, q->triangle_count) +
           q->vertex_count * vertex_bytes(q->position_type);
}

/* The same. */
static uint64_t features_bytes_of(const features_question *q)
{
    uint64_t bytes = sizeof(sc_saved_header) + sizeof *q + q->model_bytes;
    int k;
    for (k = 0; k < 2; k++)
        bytes += filter_bytes(&q->filter[k], q->vertex_count, q->triangle_count);
    for (k = 0; k < SC_RECORDED_POSES; k++)
        if (q->position_type[k] != SC_NONE)
            bytes += q->vertex_count * vertex_bytes(q->position_type[k]);
    return bytes;
}

/* ---- writing ---- */

static question question_of(const sc_model *model, const sc_pose *pose, const sc_filter *filter)
{
    const filter_parts f = parts_of(filter);
    question q;
    memset(&q, 0, sizeof q);
    q.model_bytes = sc_saved_model_bytes(model);
    q.vertex_count = pose->vertex_count;
    q.triangle_count = model->triangle_count;
    q.position_type = pose->position_type;
    q.parts = f.parts;
    q.ignore_rings = f.ignore_rings;
    q.ignore_count = f.ignore_count;
    if (filter && filter->accept) q.left_out = SC_LEFT_OUT_ACCEPT;
    return q;
}

uint64_t sc_recording_bytes(const sc_model *model, const sc_pose *pose, const sc_filter *filter)
{
    question q = question_of(model, pose, filter);
    return bytes_of(&q);
}

static features_question features_of(const sc_model *model, const sc_recorded *r)
{
    const sc_step_options *o = &r->options;
    features_question q;
    int k;
    memset(&q, 0, sizeof q);
    q.model_bytes = sc_saved_model_bytes(model);
    q.budget = o->budget;
    q.filter[0] = parts_of(o->vertex_face_filter);
    q.filter[1] = parts_of(o->edge_edge_filter);
    q.separation = o->separation;
    q.tolerance = o->tolerance;
    q.rest_distance = o->rest_distance;
    q.kind = r->kind;
    q.vertex_count = model->vertex_count;
    q.triangle_count = model->triangle_count;
    for (k = 0; k < SC_RECORDED_POSES; k++)
        q.position_type[k] = r->pose[k].positions ? r->pose[k].position_type : SC_NONE;
    q.output = o->output;
    q.pairs = o->pairs;
    q.times = o->times;
    q.method = o->method;
    q.contour = o->contour;
    q.simd = o->simd;
    q.begun = o->begun;
    q.mask_rings = r->mask_rings;
    if (r->filter[0].accept || r->filter[1].accept) q.left_out |= SC_LEFT_OUT_ACCEPT;
    if (o->cancel) q.left_out |= SC_LEFT_OUT_CANCEL;
    return q;
}

uint64_t sc_recording_features_bytes(const sc_model *model, const sc_recorded *recorded)
{
    features_question q = features_of(model, recorded);
    return features_bytes_of(&q);
}

/* Copies an array and returns where the next one goes. */
static unsigned char *put_array(unsigned char *at, const void *from, uint64_t count, uint64_t size)
{
    if (count) memcpy(at, from, (size_t)(count * size));
    return at + count * size;
}

/* The arrays of a filter, which may be NULL. */
static unsigned char *put_filter(unsigned char *at, const sc_filter *filter, uint32_t vertex_count,
                                 uint32_t triangle_count)
{
    if (!filter) return at;
    if (filter->vertex_groups)
        at = put_array(at, filter->vertex_groups, vertex_count, sizeof(sc_group));
    if (filter->triangle_groups)
        at = put_array(at, filter->triangle_groups, triangle_count, sizeof(sc_group));
    return put_array(at, filter->ignore, filter->ignore_count, sizeof(sc_pair));
}

static unsigned char *put_positions(unsigned char *at, const sc_pose *pose, uint64_t stride)
{
    const unsigned char *from = (const unsigned char *)pose->positions;
    const uint64_t step = vertex_bytes(pose->position_type);
    uint32_t v;
    for (v = 0; v < pose->vertex_count; v++, from += stride) at = put_array(at, from, 1, step);
    return at;
}

static void seal(void *memory, uint32_t version, uint64_t bytes)
{
    sc_saved_header header;
    sc_saved_seal(&header, RECORD_MAGIC, version, bytes, (unsigned char *)memory + sizeof header);
    memcpy(memory, &header, sizeof header);
}

void sc_recording_write(const sc_model *model, const sc_pose *pose, uint64_t stride,
                        const sc_query_options *options, void *memory)
{
    unsigned char *at = (unsigned char *)memory + sizeof(sc_saved_header);
    question q = question_of(model, pose, options->filter);
    q.output = options->output;
    q.pairs = options->pairs;
    q.contact = options->contact;
    q.method = options->method;
    q.contour = options->contour;
    q.rest_cache = options->rest_cache;
    q.simd = options->simd;
    q.budget = options->budget;
    if (options->cancel) q.left_out |= SC_LEFT_OUT_CANCEL;
    at = put_array(at, &q, 1, sizeof q);
    sc_saved_model_write(model, at);
    at = put_filter(at + q.model_bytes, options->filter, q.vertex_count, q.triangle_count);
    put_positions(at, pose, stride);
    seal(memory, RECORD_VERSION, bytes_of(&q));
}

void sc_recording_features_write(const sc_model *model, const sc_recorded *recorded, void *memory)
{
    const sc_step_options *o = &recorded->options;
    unsigned char *at = (unsigned char *)memory + sizeof(sc_saved_header);
    features_question q = features_of(model, recorded);
    int k;
    at = put_array(at, &q, 1, sizeof q);
    sc_saved_model_write(model, at);
    at += q.model_bytes;
    at = put_filter(at, o->vertex_face_filter, q.vertex_count, q.triangle_count);
    at = put_filter(at, o->edge_edge_filter, q.vertex_count, q.triangle_count);
    for (k = 0; k < SC_RECORDED_POSES; k++)
        if (recorded->pose[k].positions)
            at = put_positions(at, &recorded->pose[k], recorded->stride[k]);
    seal(memory, FEATURES_VERSION, features_bytes_of(&q));
}

/* ---- reading ---- */

/* Whether a filter of a record of so many bytes can have these parts. */
static int is_filter(const filter_parts *f, uint64_t bytes)
{
    if (f->parts > HAS_ALL || f->ignore_count > bytes / sizeof(sc_pair)) return 0;
    return f->parts & HAS_FILTER || (!f->parts && !f->ignore_count);
}

/* Of a record with a filter: whether its arrays can be read, and whether there are as many groups
   as the model at `model` has triangles. */
static sc_status check_filter_arrays(const void *data, const unsigned char *model,
                                     uint64_t model_bytes, uint32_t triangle_count)
{
    uint32_t triangles;
    sc_status status;
    if ((uintptr_t)data % sizeof(uint32_t)) return SC_ERROR_ALIGNMENT;
    if (model_bytes % sizeof(uint32_t)) return SC_ERROR_INCONSISTENT;
    status = sc_saved_model_triangles(model, model_bytes, &triangles);
    if (status) return status;
    return triangle_count == triangles ? SC_OK : SC_ERROR_INCONSISTENT;
}

/* Whether the parts are those of a record of so many bytes, with the model there. */
static sc_status check_question(const question *q, uint64_t bytes, const void *data,
                                const unsigned char *model)
{
    const filter_parts f = parts_asked(q);
    if (q->position_type > SC_DOUBLE || q->left_out > (SC_LEFT_OUT_ACCEPT | SC_LEFT_OUT_CANCEL) ||
        q->model_bytes > bytes || !is_filter(&f, bytes) || bytes_of(q) != bytes)
        return SC_ERROR_INCONSISTENT;
    return f.parts ? check_filter_arrays(data, model, q->model_bytes, q->triangle_count) : SC_OK;
}

/* The same. */
static sc_status check_features(const features_question *q, uint64_t bytes, const void *data,
                                const unsigned char *model)
{
    const uint32_t *type = q->position_type;
    const int is_step = q->kind == SC_RECORD_STEP;
    if ((!is_step && q->kind != SC_RECORD_NEAR) || type[SC_RECORDED_START] > SC_DOUBLE ||
        (is_step ? type[SC_RECORDED_END] > SC_DOUBLE : type[SC_RECORDED_END] != SC_NONE) ||
        (type[SC_RECORDED_REST] > SC_DOUBLE && type[SC_RECORDED_REST] != SC_NONE) ||
        q->mask_rings > (is_step ? 0 : SC_RINGS_MAX) ||
        q->left_out > (SC_LEFT_OUT_ACCEPT | SC_LEFT_OUT_CANCEL) || q->model_bytes > bytes ||
        !is_filter(&q->filter[0], bytes) || !is_filter(&q->filter[1], bytes) ||
        features_bytes_of(q) != bytes)
        return SC_ERROR_INCONSISTENT;
    return q->filter[0].parts || q->filter[1].parts
               ? check_filter_arrays(data, model, q->model_bytes, q->triangle_count)
               : SC_OK;
}

/* Takes an array and moves behind it. */
static const void *take_array(const unsigned char **at, uint64_t count, uint64_t size)
{
    const void *array = *at;
    *at += count * size;
    return array;
}

/* Returns the filter, or NULL if there is none. */
static const sc_filter *find_filter(const filter_parts *f, uint32_t vertex_count,
                                    uint32_t triangle_count, const unsigned char **at,
                                    sc_filter *filter)
{
    if (!f->parts) return NULL;
    filter->ignore_rings = f->ignore_rings;
    filter->ignore_count = f->ignore_count;
    if (f->parts & HAS_VERTEX_GROUPS)
        filter->vertex_groups = (const sc_group *)take_array(at, vertex_count, sizeof(sc_group));
    if (f->parts & HAS_TRIANGLE_GROUPS)
        filter->triangle_groups =
            (const sc_group *)take_array(at, triangle_count, sizeof(sc_group));
    if (f->ignore_count)
        filter->ignore = (const sc_pair *)take_array(at, f->ignore_count, sizeof(sc_pair));
    return filter;
}

static void find_pose(uint32_t vertex_count, uint32_t type, const unsigned char **at, sc_pose *pose)
{
    pose->vertex_count = vertex_count;
    pose->position_type = type;
    pose->positions = take_array(at, vertex_count, vertex_bytes(type));
}

/* A query: what begins behind the header, and ends with the record. */
static sc_status read_query(const void *data, const unsigned char *at, uint64_t bytes,
                            sc_recording *found)
{
    sc_query_options *o = &found->options;
    filter_parts f;
    question q;
    sc_status status;
    if (bytes < sizeof(sc_saved_header) + sizeof q) return SC_ERROR_INCONSISTENT;
    memcpy(&q, at, sizeof q);
    at += sizeof q;
    status = check_question(&q, bytes, data, at);
    if (status) return status;
    f = parts_asked(&q);
    found->kind = SC_RECORD_QUERY;
    found->left_out = q.left_out;
    found->model_size = q.model_bytes;
    found->model = take_array(&at, q.model_bytes, 1);
    o->filter = find_filter(&f, q.vertex_count, q.triangle_count, &at, &found->filter[0]);
    find_pose(q.vertex_count, q.position_type, &at, &found->pose[SC_RECORDED_START]);
    o->output = q.output;
    o->pairs = q.pairs;
    o->contact = q.contact;
    o->method = q.method;
    o->contour = q.contour;
    o->rest_cache = q.rest_cache;
    o->simd = q.simd;
    o->budget = q.budget;
    return SC_OK;
}

/* The options of a step, or of a search that were made those of one. */
static void find_step_options(const features_question *q, sc_step_options *o)
{
    o->output = q->output;
    o->pairs = q->pairs;
    o->times = q->times;
    o->method = q->method;
    o->contour = q->contour;
    o->simd = q->simd;
    o->separation = q->separation;
    o->tolerance = q->tolerance;
    o->budget = q->budget;
    o->rest_distance = q->rest_distance;
    o->begun = q->begun;
}

/* Makes them those of a search. */
static void find_near_options(const sc_step_options *from, sc_near_options *o)
{
    o->output = from->output;
    o->kinds = from->pairs;
    o->method = from->method;
    o->simd = from->simd;
    o->distance = from->separation;
    o->vertex_face_filter = from->vertex_face_filter;
    o->edge_edge_filter = from->edge_edge_filter;
    o->rest = from->rest;
    o->rest_distance = from->rest_distance;
    o->budget = from->budget;
}

/* The same as read_query, of a step or a search. */
static sc_status read_features(const void *data, const unsigned char *at, uint64_t bytes,
                               sc_recording *found)
{
    sc_step_options *o = &found->step_options;
    features_question q;
    sc_status status;
    int k;
    if (bytes < sizeof(sc_saved_header) + sizeof q) return SC_ERROR_INCONSISTENT;
    memcpy(&q, at, sizeof q);
    at += sizeof q;
    status = check_features(&q, bytes, data, at);
    if (status) return status;
    found->kind = q.kind;
    found->left_out = q.left_out;
    found->mask_rings = q.mask_rings;
    found->model_size = q.model_bytes;
    found->model = take_array(&at, q.model_bytes, 1);
    find_step_options(&q, o);
    o->vertex_face_filter =
        find_filter(&q.filter[0], q.vertex_count, q.triangle_count, &at, &found->filter[0]);
    o->edge_edge_filter =
        find_filter(&q.filter[1], q.vertex_count, q.triangle_count, &at, &found->filter[1]);
    for (k = 0; k < SC_RECORDED_POSES; k++)
        if (q.position_type[k] != SC_NONE)
            find_pose(q.vertex_count, q.position_type[k], &at, &found->pose[k]);
    if (q.position_type[SC_RECORDED_REST] != SC_NONE) o->rest = &found->pose[SC_RECORDED_REST];
    if (q.kind == SC_RECORD_STEP) return SC_OK;
    find_near_options(o, &found->near_options);
    memset(o, 0, sizeof *o);
    return SC_OK;
}

sc_status sc_recording_read(const void *data, uint64_t size, sc_recording *found)
{
    const unsigned char *at = (const unsigned char *)data + sizeof(sc_saved_header);
    sc_saved_header header;
    sc_status status = sc_saved_open(data, size, RECORD_MAGIC, FEATURES_VERSION, &header);
    if (status == SC_ERROR_TOO_OLD)
        status = sc_saved_open(data, size, RECORD_MAGIC, RECORD_VERSION, &header);
    if (!status) status = sc_saved_verify(&header, at);
    if (status) return status;
    memset(found, 0, sizeof *found);
    return header.version == RECORD_VERSION ? read_query(data, at, header.bytes, found)
                                            : read_features(data, at, header.bytes, found);
}
