/*
 * What sc-query asks about: a model, built from a mesh file or saved before, and the poses that fit
 * it.
 *
 * SPDX-License-Identifier: MIT
 *
 * On failure a call returns false, error says why, beginning with the path, and the subject is
 * empty.
 */
#ifndef TOOLS_QUERY_SUBJECT_H
#define TOOLS_QUERY_SUBJECT_H

#include "mesh_file.h"
#include "model_file.h"

#include "starcontour.h"

/* A model with its workspace, and the mesh it was built from or for the pose of which it is
   asked. */
typedef struct query_subject {
    mesh_file mesh;
    model_file file;    /* of query_subject_open: owns the model */
    uint32_t *weld_map; /* where poses follow, unless nothing is welded or known */
    sc_model *model;
    sc_workspace *workspace;
    double build_ms;
    bool is_apart; /* the model was built from the mesh, no two vertices of which are one */
} query_subject;

/* How to build: weld and partition as in tool.h, rest and content as in sc_build_options. */
typedef struct query_subject_how {
    uint32_t weld, partition, rest, content;
    uint32_t flags;    /* of the workspace: SC_WORKSPACE_... */
    bool poses_follow; /* other poses of the mesh will be asked about */
} query_subject_how;

/* Reads and builds. */
bool query_subject_load(query_subject *subject, const char *path, const query_subject_how *how,
                        char error[MESH_FILE_ERROR_SIZE]);

/* Takes a model that was saved; the mesh stays empty. flags: of the workspace. */
bool query_subject_open(query_subject *subject, const char *path, uint32_t flags,
                        char error[MESH_FILE_ERROR_SIZE]);

/* What all poses of a run share: builds from a rest mesh, or takes a model that was saved, or
   leaves the subject empty if both paths are NULL. */
bool query_subject_begin(query_subject *subject, const char *rest_path, const char *model_path,
                         const query_subject_how *how, char error[MESH_FILE_ERROR_SIZE]);

/* Whether a mesh can be a pose of a saved model. */
bool query_subject_fits(const query_subject *subject, const char *path, const mesh_file *mesh,
                        char error[MESH_FILE_ERROR_SIZE]);

/* Welded vertices that a pose takes apart would be read from one of them only: refuse that. */
bool query_subject_keeps_welds(const query_subject *subject, const mesh_file *mesh,
                               const char *path, const void *positions, uint32_t position_type,
                               char error[MESH_FILE_ERROR_SIZE]);

/* Frees everything and empties the subject. */
void query_subject_free(query_subject *subject);

#endif /* TOOLS_QUERY_SUBJECT_H */
