/*
 * One query as bytes: what sc_record_write writes and sc_record_read reads.
 *
 * SPDX-License-Identifier: MIT
 *
 *     | sc_saved_header | question | saved model | arrays of the filter | positions |
 *
 * The saved model (build/saved_model.h) starts at a multiple of SC_ALIGNMENT and can be loaded
 * where it is. The filter's arrays are those that there are: groups of vertices, groups of
 * triangles, pairs to ignore. Positions are packed, in the type in which the caller gave them, and
 * not looked at.
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

/* What a record holds; pointers into it. */
typedef struct sc_recording {
    const void *model;
    uint64_t model_size;
    sc_pose pose;
    sc_query_options options; /* filter is &filter, or NULL */
    sc_filter filter;
    uint32_t left_out; /* SC_LEFT_OUT_... */
} sc_recording;

/* Finds the parts of size bytes at data. The model is still to be checked, by loading it, and the
   pose and options by asking; what asking does not check is: there are as many groups as vertices
   and triangles. */
sc_status sc_recording_read(const void *data, uint64_t size, sc_recording *found);

#endif
