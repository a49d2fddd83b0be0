/*
 * What sc-query asks about; see query_subject.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "query_subject.h"

#include "query_threads.h"

#include "tool.h"

#include <stdlib.h>
#include <string.h>

void query_subject_free(query_subject *subject)
{
    sc_workspace_free(subject->workspace);
    if (!subject->file.model) {
        sc_model_free(subject->model);
        free(subject->weld_map);
    }
    model_file_free(&subject->file);
    mesh_file_free(&subject->mesh);
    memset(subject, 0, sizeof *subject);
}

/* Whether a model has a point of its own for each vertex. */
static bool has_all_points(const sc_model *model)
{
    sc_model_info info;
    memset(&info, 0, sizeof info);
    info.struct_size = sizeof info;
    return sc_model_get_info(model, &info) == SC_OK && info.point_count == info.vertex_count;
}

bool query_subject_load(query_subject *subject, const char *path, const query_subject_how *how,
                        char error[MESH_FILE_ERROR_SIZE])
{
    memset(subject, 0, sizeof *subject);
    if (!mesh_file_read(&subject->mesh, path, error)) return false;
    if (how->poses_follow) subject->mesh.face_hash = mesh_file_hash(&subject->mesh);
    sc_status status = tool_build(&subject->mesh, how->weld, how->partition, how->rest,
                                  how->content, query_threads_tasks(), &subject->model,
                                  &subject->build_ms);
    if (status == SC_OK)
        status = query_threads_workspace(subject->model, how->flags, &subject->workspace);
    if (status == SC_OK && how->poses_follow && how->weld == SC_WELD_REST) {
        subject->weld_map = mesh_file_weld_map(&subject->mesh);
        if (!subject->weld_map) status = SC_ERROR_MEMORY;
    }
    subject->is_apart = status == SC_OK && has_all_points(subject->model);
    if (status == SC_OK) return true;
    snprintf(error, MESH_FILE_ERROR_SIZE, "%s: %s", path, tool_why(status));
    query_subject_free(subject);
    return false;
}

bool query_subject_open(query_subject *subject, const char *path, uint32_t flags,
                        char error[MESH_FILE_ERROR_SIZE])
{
    memset(subject, 0, sizeof *subject);
    const double start = tool_clock();
    if (!model_file_read(&subject->file, path, error)) return false;
    subject->build_ms = tool_clock() - start;
    subject->model = subject->file.model;
    subject->weld_map = subject->file.weld_map;
    const sc_status status = query_threads_workspace(subject->model, flags, &subject->workspace);
    if (status == SC_OK) return true;
    snprintf(error, MESH_FILE_ERROR_SIZE, "%s: %s", path, tool_why(status));
    query_subject_free(subject);
    return false;
}

bool query_subject_begin(query_subject *subject, const char *rest_path, const char *model_path,
                         const query_subject_how *how, char error[MESH_FILE_ERROR_SIZE])
{
    if (rest_path) return query_subject_load(subject, rest_path, how, error);
    if (model_path) return query_subject_open(subject, model_path, how->flags, error);
    memset(subject, 0, sizeof *subject);
    return true;
}

bool query_subject_fits(const query_subject *subject, const char *path, const mesh_file *mesh,
                        char error[MESH_FILE_ERROR_SIZE])
{
    sc_model_info info;
    memset(&info, 0, sizeof info);
    info.struct_size = sizeof info;
    if (sc_model_get_info(subject->model, &info) != SC_OK) return false;
    if (mesh->vertex_count != info.vertex_count || mesh->triangle_count != info.triangle_count) {
        snprintf(error, MESH_FILE_ERROR_SIZE,
                 "%s: has %lu vertices and %lu triangles, the model %lu and %lu", path,
                 (unsigned long)mesh->vertex_count, (unsigned long)mesh->triangle_count,
                 (unsigned long)info.vertex_count, (unsigned long)info.triangle_count);
        return false;
    }
    if (subject->file.face_hash && mesh_file_hash(mesh) != subject->file.face_hash) {
        snprintf(error, MESH_FILE_ERROR_SIZE,
                 "%s: faces differ from those of the mesh that the model was built from", path);
        return false;
    }
    return true;
}

bool query_subject_keeps_welds(const query_subject *subject, const mesh_file *mesh,
                               const char *path, const void *positions, uint32_t position_type,
                               char error[MESH_FILE_ERROR_SIZE])
{
    if (!subject->weld_map) return true;
    for (size_t c = 0; c < 3 * (size_t)mesh->triangle_count; c++) {
        const uint32_t vertex = mesh->indices[c], joined = subject->weld_map[vertex];
        if (vertex == joined) continue;
        double a[3], b[3];
        mesh_file_position(positions, position_type, vertex, a);
        mesh_file_position(positions, position_type, joined, b);
        if (a[0] == b[0] && a[1] == b[1] && a[2] == b[2]) continue;
        snprintf(error, MESH_FILE_ERROR_SIZE,
                 "%s: vertices %lu and %lu are at one place in the rest mesh but not in this pose; "
                 "is it another mesh? If they are to move apart, use --weld none",
                 path, (unsigned long)joined, (unsigned long)vertex);
        return false;
    }
    return true;
}
