/*
 * Records as files; see record_file.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "record_file.h"

#include "query_threads.h"
#include "tool.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ------------------------------------------------------------------------------------------------
 * Writing
 */

static sc_status find_size(const record_question *q, uint64_t *size)
{
    if (q->query) return sc_record_size(q->model, q->pose, q->query, size);
    if (q->step) return sc_record_step_size(q->model, q->pose, q->end, q->step, size);
    return sc_record_near_size(q->model, q->pose, q->search, size);
}

static sc_status write_bytes(const record_question *q, void *bytes, uint64_t size)
{
    if (q->query) return sc_record_write(q->model, q->pose, q->query, bytes, size, NULL);
    if (q->step) return sc_record_step_write(q->model, q->pose, q->end, q->step, bytes, size, NULL);
    return sc_record_near_write(q->model, q->pose, q->search, bytes, size, NULL);
}

bool record_file_write(const char *path, const record_question *question)
{
    char error[MESH_FILE_ERROR_SIZE];
    uint64_t size = 0;
    void *bytes = NULL;
    sc_status status = find_size(question, &size);
    if (status == SC_OK) {
        bytes = size <= SIZE_MAX ? malloc((size_t)size) : NULL;
        status = bytes ? write_bytes(question, bytes, size) : SC_ERROR_MEMORY;
    }
    bool written = status == SC_OK;
    if (!written)
        tool_error("%s: %s", path, sc_status_string(status));
    else if (!model_file_dump(path, bytes, size, error)) {
        tool_error("%s", error);
        written = false;
    }
    free(bytes);
    return written;
}

/* ------------------------------------------------------------------------------------------------
 * Reading
 */

/* Makes room for everything that a record can have. */
static void make_room(record_file *file)
{
    file->pose.struct_size = sizeof file->pose;
    file->end.struct_size = sizeof file->end;
    file->rest.struct_size = sizeof file->rest;
    file->query.struct_size = sizeof file->query;
    file->step.struct_size = sizeof file->step;
    file->search.struct_size = sizeof file->search;
    file->filter.struct_size = sizeof file->filter;
    file->edge_edge_filter.struct_size = sizeof file->edge_edge_filter;
    file->record.struct_size = sizeof file->record;
    file->record.pose = &file->pose;
    file->record.end = &file->end;
    file->record.rest = &file->rest;
    file->record.options = &file->query;
    file->record.step_options = &file->step;
    file->record.near_options = &file->search;
    file->record.filter = &file->filter;
    file->record.edge_edge_filter = &file->edge_edge_filter;
}

void record_file_refuse(record_file *file, sc_status status, const char *reason)
{
    snprintf(file->error, sizeof file->error, "%s: %s%s%s", file->path, sc_status_string(status),
             reason && reason[0] ? ": " : "", reason ? reason : "");
}

bool record_file_read(record_file *file, const char *path)
{
    uint64_t size;
    memset(file, 0, sizeof *file);
    make_room(file);
    file->path = path;
    file->bytes = model_file_bytes(path, &size, file->error);
    if (!file->bytes) return false;
    const sc_status status = sc_record_read(file->bytes, size, &file->record);
    if (status != SC_OK) {
        record_file_refuse(file, status, NULL);
        return false;
    }
    if (file->record.left_out & SC_LEFT_OUT_ACCEPT)
        tool_error("%s: note: the query had a function to refuse pairs (accept), which is not in "
                   "the record: there may be more pairs here",
                   path);
    if (file->record.left_out & SC_LEFT_OUT_CANCEL)
        tool_error("%s: note: the query could be cancelled by a flag, which is not in the record",
                   path);
    return true;
}

bool record_file_open(record_file *file, uint32_t flags, query_subject *subject)
{
    char reason[256] = "";
    sc_model_info info;
    memset(subject, 0, sizeof *subject);
    memset(&info, 0, sizeof info);
    info.struct_size = sizeof info;
    const double start = tool_clock();
    sc_status status =
        model_file_load(file->record.model, file->record.model_size, &subject->model, reason);
    subject->build_ms = tool_clock() - start;
    if (status == SC_OK)
        status = query_threads_workspace(subject->model, flags, &subject->workspace);
    if (status == SC_OK && file->record.mask_rings) {
        status = sc_near_masks_create(subject->model, file->record.mask_rings, NULL, &file->masks);
        file->search.masks = file->masks;
    }
    if (status == SC_OK) status = sc_model_get_info(subject->model, &info);
    if (status != SC_OK) {
        record_file_refuse(file, status, reason);
        return false;
    }
    subject->mesh.vertex_count = info.vertex_count;
    subject->mesh.triangle_count = subject->mesh.face_count = info.triangle_count;
    return true;
}

uint32_t *record_file_vertex_objects(const query_subject *subject)
{
    const size_t size = subject->mesh.vertex_count * sizeof(uint32_t);
    uint32_t *objects = (uint32_t *)malloc(size);
    if (objects) memset(objects, 0xff, size); /* MESH_NO_OBJECT */
    return objects;
}

void record_file_free(record_file *file)
{
    sc_near_masks_free(file->masks);
    free(file->bytes);
    memset(file, 0, sizeof *file);
}
