/*
 * Records of queries, steps and searches for what is near as files: what --record writes and
 * --replay reads.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef TOOLS_RECORD_FILE_H
#define TOOLS_RECORD_FILE_H

#include "mesh_file.h"
#include "query_subject.h"

#include "starcontour.h"

/* What is to be recorded: of the three kinds of options one is there, and says what. */
typedef struct record_question {
    const sc_model *model;
    const sc_pose *pose, *end; /* end: of a step */
    const sc_query_options *query;
    const sc_step_options *step;
    const sc_near_options *search;
} record_question;

/* Writes it; otherwise tells why not on standard error. */
bool record_file_write(const char *path, const record_question *question);

/* A record that was read, and what is in it. */
typedef struct record_file {
    const char *path; /* the caller's */
    void *bytes;
    sc_record record; /* refers to what follows */
    sc_pose pose, end, rest;
    sc_query_options query;
    sc_step_options step;
    sc_near_options search;
    sc_filter filter, edge_edge_filter;
    sc_near_masks *masks;             /* of record_file_open */
    char error[MESH_FILE_ERROR_SIZE]; /* why it could not be read, beginning with the path; or "" */
} record_file;

/* Reads a record of any kind. What was left out of it is told on standard error. */
bool record_file_read(record_file *file, const char *path);

/*
 * Loads the model, and makes a workspace with these flags, and the masks of a search, which are in
 * file->search then. In place of the mesh, which is not in a record, there is one of as many
 * triangles, each of them a face and of no object. file->error says why not.
 */
bool record_file_open(record_file *file, uint32_t flags, query_subject *subject);

/* A new array for that mesh, as of mesh_vertex_objects; NULL if there is no memory. */
uint32_t *record_file_vertex_objects(const query_subject *subject);

/* Says in file->error that a record cannot be replayed, and why: a status, or a text if that is not
   NULL. */
void record_file_refuse(record_file *file, sc_status status, const char *reason);

/* After the subject. All zero is allowed. */
void record_file_free(record_file *file);

#endif /* TOOLS_RECORD_FILE_H */
