/*
 * One query, step or search for what is near as bytes: what sc_record_write, _step_write and
 * _near_write write and sc_record_read reads.
 *
 * SPDX-License-Identifier: MIT
 *
 *     | sc_saved_header | question | saved model | arrays of the filters | positions |
 *
 * The saved model (build/saved_model.h) starts at a multiple of SC_ALIGNMENT and can be loaded
 * where it is. A filter's arrays are those that there are: groups of vertices, groups of triangles,
 * pairs to ignore; of two filters, those of vertices and faces come first. Positions are packed, in
 * the type in which the caller gave them, and not looked at: of the pose, or of both poses of a
 * step, then of the rest pose.
 *
 * Queries are one version of the format, steps and searches the next, with a longer question. So a
 * library that reads but queries says of the others that they are too new.
 */
#ifndef SC_QUERY_RECORDING_H
#define SC_QUERY_RECORDING_H

#include "build/model.h"

/* Bytes of a record. pose and filter are checked; filter may be NULL. */
uint64_t sc_recording_bytes(const sc_model *model, const sc_pose *pose, const sc_filter *filter);

/* Writes that many bytes, at any alignment. stride is that of the pose in bytes, and
   options->filter the filter. */
void sc_recording_write(const sc_model *model, const sc_pose *pose, uint64_t stride,
                        const sc_query_options *options, void *memory);

/* Which pose of a record is which. */
enum { SC_RECORDED_START = 0, SC_RECORDED_END = 1, SC_RECORDED_REST = 2, SC_RECORDED_POSES = 3 };

/*
 * What is to be recorded of a step, or of a search for what is near. The latter has its options as
 * a step would have them: its kinds are pairs, its distance is the separation.
 */
typedef struct sc_recorded {
    uint32_t kind;                   /* SC_RECORD_STEP or _NEAR */
    uint32_t mask_rings;             /* of masks; 0: there are none */
    sc_pose pose[SC_RECORDED_POSES]; /* positions is NULL where there is no such pose */
    uint64_t stride[SC_RECORDED_POSES];
    sc_step_options options; /* filters are those below, or NULL */
    sc_filter filter[2];
} sc_recorded;

/* The same of a step or a search, all of which is checked. */
uint64_t sc_recording_features_bytes(const sc_model *model, const sc_recorded *recorded);
void sc_recording_features_write(const sc_model *model, const sc_recorded *recorded, void *memory);

/* What a record holds; pointers into it. */
typedef struct sc_recording {
    uint32_t kind;     /* SC_RECORD_... */
    uint32_t left_out; /* SC_LEFT_OUT_... */
    const void *model;
    uint64_t model_size;
    sc_pose pose[SC_RECORDED_POSES]; /* all 0 where there is no such pose */
    sc_query_options options;        /* of a query; else all 0. Filters are those below, or NULL */
    sc_step_options step_options;    /* of a step; rest is one of the poses, or NULL */
    sc_near_options near_options;    /* of a search; the same */
    sc_filter filter[2];             /* of a query the first */
    uint32_t mask_rings;             /* of masks; 0: there were none */
} sc_recording;

/* Finds the parts of size bytes at data. The model is still to be checked, by loading it, and poses
   and options by asking; what asking does not check is: there are as many groups as vertices and
   triangles. */
sc_status sc_recording_read(const void *data, uint64_t size, sc_recording *found);

#endif
