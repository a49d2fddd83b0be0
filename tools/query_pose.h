/*
 * A pose that sc-query asks about, as a mesh file gives it.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef TOOLS_QUERY_POSE_H
#define TOOLS_QUERY_POSE_H

#include "query_subject.h"

/* Points into itself: it is not to be copied. */
typedef struct query_pose {
    const query_subject *subject; /* the one that is shared, or one of the file's own */
    const mesh_file *mesh;        /* with the faces */
    sc_pose pose;
    bool rounded, has_animation; /* of the file, as in mesh_file */
    query_subject own;
    mesh_pose moved;
} query_pose;

/*
 * Reads a file as a pose of what query_subject_begin made; if that is NULL or empty, builds from
 * the file as how says. On failure false, and error says why, beginning with the path. To be freed
 * in either case.
 */
bool query_pose_read(query_pose *pose, const char *path, const query_subject *shared,
                     const query_subject_how *how, char error[MESH_FILE_ERROR_SIZE]);

void query_pose_free(query_pose *pose);

#endif /* TOOLS_QUERY_POSE_H */
