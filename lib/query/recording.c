/*
 * One query as bytes. See recording.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "query/recording.h"

#include <string.h>

#include "base/saved.h"
#include "build/saved_model.h"

static const char RECORD_MAGIC[8] = {'\x93', 'S', 'C', 'R', '\r', '\n', '\x1a', '\n'};

/* Raised whenever what follows the header changes, but for the model, which has a version of its
   own. */
enum { RECORD_VERSION = 1 };

/* What of a filter there is. */
enum { HAS_FILTER = 1, HAS_VERTEX_GROUPS = 2, HAS_TRIANGLE_GROUPS = 4, HAS_ALL = 7 };

/* Alignment units, so that the model behind them is aligned. */
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

static uint64_t vertex_bytes(uint32_t position_type)
{
    return 3 * (position_type == SC_DOUBLE ? sizeof(double) : sizeof(float));
}

/* ignore_count and model_bytes are at most those of something in memory: no overflow. */
static uint64_t bytes_of(const question *q)
{
    return sizeof(sc_saved_header) + sizeof *q + q->model_bytes +
           (q->parts & HAS_VERTEX_GROUPS ? q->vertex_count * (uint64_t)sizeof(sc_group) : 0) +
           (q->parts & HAS_TRIANGLE_GROUPS ? q->triangle_count * (uint64_t)sizeof(sc_group) : 0) +
           q->ignore_count * sizeof(sc_pair) + q->vertex_count * vertex_bytes(q->position_type);
}

static question question_of(const sc_model *model, const sc_pose *pose, const sc_filter *filter)
{
    question q;
    memset(&q, 0, sizeof q);
    q.model_bytes = sc_saved_model_bytes(model);
    q.vertex_count = pose->vertex_count;
    q.triangle_count = model->triangle_count;
    q.position_type = pose->position_type;
    if (!filter) return q;
    q.parts = HAS_FILTER;
    if (filter->vertex_groups) q.parts |= HAS_VERTEX_GROUPS;
    if (filter->triangle_groups) q.parts |= HAS_TRIANGLE_GROUPS;
    q.ignore_rings = filter->ignore_rings;
    q.ignore_count = filter->ignore_count;
    if (filter->accept) q.left_out = SC_LEFT_OUT_ACCEPT;
    return q;
}

uint64_t sc_recording_bytes(const sc_model *model, const sc_pose *pose, const sc_filter *filter)
{
    question q = question_of(model, pose, filter);
    return bytes_of(&q);
}

/* Copies an array and returns where the next one goes. */
static unsigned char *put_array(unsigned char *at, const void *from, uint64_t count, uint64_t size)
{
    if (count) memcpy(at, from, (size_t)(count * size));
    return at + count * size;
}

void sc_recording_write(const sc_model *model, const sc_pose *pose, uint64_t stride,
                        const sc_query_options *options, void *memory)
{
    const unsigned char *from = (const unsigned char *)pose->positions;
    unsigned char *content = (unsigned char *)memory + sizeof(sc_saved_header), *at = content;
    const uint64_t step = vertex_bytes(pose->position_type);
    const sc_filter *filter = options->filter;
    question q = question_of(model, pose, filter);
    sc_saved_header header;
    uint32_t v;
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
    at += q.model_bytes;
    if (q.parts & HAS_VERTEX_GROUPS)
        at = put_array(at, filter->vertex_groups, q.vertex_count, sizeof(sc_group));
    if (q.parts & HAS_TRIANGLE_GROUPS)
        at = put_array(at, filter->triangle_groups, q.triangle_count, sizeof(sc_group));
    if (filter) at = put_array(at, filter->ignore, q.ignore_count, sizeof(sc_pair));
    for (v = 0; v < q.vertex_count; v++, from += stride) at = put_array(at, from, 1, step);
    sc_saved_seal(&header, RECORD_MAGIC, RECORD_VERSION, bytes_of(&q), content);
    memcpy(memory, &header, sizeof header);
}

/* Whether the parts are those of a record of so many bytes. */
static sc_status check_question(const question *q, uint64_t bytes, const unsigned char *data)
{
    uint32_t triangles;
    sc_status status;
    if (q->position_type > SC_DOUBLE || q->parts > HAS_ALL ||
        q->left_out > (SC_LEFT_OUT_ACCEPT | SC_LEFT_OUT_CANCEL) || q->model_bytes > bytes ||
        q->ignore_count > bytes / sizeof(sc_pair) || bytes_of(q) != bytes)
        return SC_ERROR_INCONSISTENT;
    if (!(q->parts & HAS_FILTER))
        return q->parts || q->ignore_count ? SC_ERROR_INCONSISTENT : SC_OK;
    if ((uintptr_t)data % sizeof(uint32_t)) return SC_ERROR_ALIGNMENT;
    if (q->model_bytes % sizeof(uint32_t)) return SC_ERROR_INCONSISTENT;
    status = sc_saved_model_triangles(data + sizeof(sc_saved_header) + sizeof *q, q->model_bytes,
                                      &triangles);
    if (status) return status;
    return q->triangle_count == triangles ? SC_OK : SC_ERROR_INCONSISTENT;
}

/* Takes an array and moves behind it. */
static const void *take_array(const unsigned char **at, uint64_t count, uint64_t size)
{
    const void *array = *at;
    *at += count * size;
    return array;
}

static void find_filter(const question *q, const unsigned char **at, sc_filter *filter)
{
    filter->ignore_rings = q->ignore_rings;
    filter->ignore_count = q->ignore_count;
    if (q->parts & HAS_VERTEX_GROUPS)
        filter->vertex_groups = (const sc_group *)take_array(at, q->vertex_count, sizeof(sc_group));
    if (q->parts & HAS_TRIANGLE_GROUPS)
        filter->triangle_groups =
            (const sc_group *)take_array(at, q->triangle_count, sizeof(sc_group));
    if (q->ignore_count)
        filter->ignore = (const sc_pair *)take_array(at, q->ignore_count, sizeof(sc_pair));
}

sc_status sc_recording_read(const void *data, uint64_t size, sc_recording *found)
{
    const unsigned char *at = (const unsigned char *)data + sizeof(sc_saved_header);
    sc_saved_header header;
    question q;
    sc_status status = sc_saved_open(data, size, RECORD_MAGIC, RECORD_VERSION, &header);
    if (!status) status = sc_saved_verify(&header, at);
    if (status) return status;
    if (header.bytes < sizeof header + sizeof q) return SC_ERROR_INCONSISTENT;
    memcpy(&q, at, sizeof q);
    status = check_question(&q, header.bytes, (const unsigned char *)data);
    if (status) return status;
    at += sizeof q;
    memset(found, 0, sizeof *found);
    found->model_size = q.model_bytes;
    found->model = take_array(&at, q.model_bytes, 1);
    if (q.parts & HAS_FILTER) {
        found->options.filter = &found->filter;
        find_filter(&q, &at, &found->filter);
    }
    found->pose.vertex_count = q.vertex_count;
    found->pose.position_type = q.position_type;
    found->pose.positions = at;
    found->options.output = q.output;
    found->options.pairs = q.pairs;
    found->options.contact = q.contact;
    found->options.method = q.method;
    found->options.contour = q.contour;
    found->options.rest_cache = q.rest_cache;
    found->options.simd = q.simd;
    found->options.budget = q.budget;
    found->left_out = q.left_out;
    return SC_OK;
}
