/*
 * A pose that sc-query asks about; see query_pose.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "query_pose.h"

#include "tool.h"

#include <string.h>

/* Of a rest mesh, whose faces it has. */
static bool read_moved(query_pose *pose, const char *path, char error[MESH_FILE_ERROR_SIZE])
{
    const mesh_file *rest = &pose->subject->mesh;
    mesh_pose *moved = &pose->moved;
    const bool read = mesh_file_read_pose(rest, path, moved, error);
    pose->mesh = rest;
    pose->pose = tool_pose(moved->positions, moved->position_type, rest->vertex_count);
    pose->rounded = moved->rounded;
    pose->has_animation = moved->has_animation;
    return read;
}

/* With faces of its own: of a saved model, or as the rest mesh itself. */
static bool read_mesh(query_pose *pose, const char *path, const query_subject_how *how,
                      char error[MESH_FILE_ERROR_SIZE])
{
    mesh_file *mesh = &pose->own.mesh;
    const bool read = pose->subject == &pose->own
                          ? query_subject_load(&pose->own, path, how, error)
                          : mesh_file_read(mesh, path, error) &&
                                query_subject_fits(pose->subject, path, mesh, error);
    pose->mesh = mesh;
    pose->pose = tool_pose(mesh->positions, mesh->position_type, mesh->vertex_count);
    pose->rounded = mesh->rounded;
    pose->has_animation = mesh->has_animation;
    return read;
}

bool query_pose_read(query_pose *pose, const char *path, const query_subject *shared,
                     const query_subject_how *how, char error[MESH_FILE_ERROR_SIZE])
{
    memset(pose, 0, sizeof *pose);
    const bool is_shared = shared && shared->model;
    pose->subject = is_shared ? shared : &pose->own;
    const bool read = is_shared && !shared->file.model ? read_moved(pose, path, error)
                                                       : read_mesh(pose, path, how, error);
    if (!read || !is_shared) return read;
    return query_subject_keeps_welds(shared, pose->mesh, path, pose->pose.positions,
                                     pose->pose.position_type, error);
}

void query_pose_free(query_pose *pose)
{
    mesh_pose_free(&pose->moved);
    query_subject_free(&pose->own);
}
