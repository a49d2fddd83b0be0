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

/* Raised whenever what follows the header changes, but for the model, which has a version of its own. */
enum { RECORD_VERSION = 1 };

/* One alignment unit, so that the model behind it is aligned. */
typedef struct question {
    uint64_t model_bytes;
    uint32_t vertex_count, position_type;
    uint32_t output, pairs, contact, method, contour, rest_cache;
    uint64_t budget;
    uint64_t unused[2]; /* 0 */
} question;

typedef char question_is_one_unit[sizeof(question) == SC_ALIGNMENT ? 1 : -1];

static uint64_t vertex_bytes(uint32_t position_type)
{
    return 3 * (position_type == SC_DOUBLE ? sizeof(double) : sizeof(float));
}

static uint64_t bytes_of(const question *q)
{
    return sizeof(sc_saved_header) + sizeof *q + q->model_bytes +
           q->vertex_count * vertex_bytes(q->position_type);
}

static question question_of(const sc_model *model, const sc_pose *pose)
{
    question q;
    memset(&q, 0, sizeof q);
    q.model_bytes = sc_saved_model_bytes(model);
    q.vertex_count = pose->vertex_count;
    q.position_type = pose->position_type;
    return q;
}

uint64_t sc_recording_bytes(const sc_model *model, const sc_pose *pose)
{
    question q = question_of(model, pose);
    return bytes_of(&q);
}

void sc_recording_write(const sc_model *model, const sc_pose *pose, uint64_t stride,
                        const sc_query_options *options, void *memory)
{
    const unsigned char *from = (const unsigned char *)pose->positions;
    unsigned char *content = (unsigned char *)memory + sizeof(sc_saved_header), *at = content;
    const uint64_t step = vertex_bytes(pose->position_type);
    question q = question_of(model, pose);
    sc_saved_header header;
    uint32_t v;
    q.output = options->output;
    q.pairs = options->pairs;
    q.contact = options->contact;
    q.method = options->method;
    q.contour = options->contour;
    q.rest_cache = options->rest_cache;
    q.budget = options->budget;
    memcpy(at, &q, sizeof q);
    at += sizeof q;
    sc_saved_model_write(model, at);
    at += q.model_bytes;
    for (v = 0; v < q.vertex_count; v++, from += stride, at += step) memcpy(at, from, (size_t)step);
    sc_saved_seal(&header, RECORD_MAGIC, RECORD_VERSION, bytes_of(&q), content);
    memcpy(memory, &header, sizeof header);
}

sc_status sc_recording_read(const void *data, uint64_t size, const void **model,
                            uint64_t *model_size, sc_pose *pose, sc_query_options *options)
{
    const unsigned char *at = (const unsigned char *)data + sizeof(sc_saved_header);
    sc_saved_header header;
    question q;
    sc_status status = sc_saved_open(data, size, RECORD_MAGIC, RECORD_VERSION, &header);
    if (!status) status = sc_saved_verify(&header, at);
    if (status) return status;
    if (header.bytes < sizeof header + sizeof q) return SC_ERROR_INCONSISTENT;
    memcpy(&q, at, sizeof q);
    if (q.position_type > SC_DOUBLE || q.model_bytes > header.bytes || bytes_of(&q) != header.bytes)
        return SC_ERROR_INCONSISTENT;
    at += sizeof q;
    *model = at;
    *model_size = q.model_bytes;
    memset(pose, 0, sizeof *pose);
    pose->vertex_count = q.vertex_count;
    pose->position_type = q.position_type;
    pose->positions = at + q.model_bytes;
    memset(options, 0, sizeof *options);
    options->output = q.output;
    options->pairs = q.pairs;
    options->contact = q.contact;
    options->method = q.method;
    options->contour = q.contour;
    options->rest_cache = q.rest_cache;
    options->budget = q.budget;
    return SC_OK;
}
