/*
 * One query as bytes: what sc_record_write writes and sc_record_read reads.
 *
 * SPDX-License-Identifier: MIT
 *
 *     | sc_saved_header | question | saved model | positions |
 *
 * The saved model (build/saved_model.h) starts at a multiple of SC_ALIGNMENT and can be loaded where it
 * is. Positions are packed, in the type in which the caller gave them, and not looked at.
 */
#ifndef SC_QUERY_RECORDING_H
#define SC_QUERY_RECORDING_H

#include "build/model.h"

/* Bytes of a record. pose is checked. */
uint64_t sc_recording_bytes(const sc_model *model, const sc_pose *pose);

/* Writes that many bytes, at any alignment. stride is that of the pose in bytes. */
void sc_recording_write(const sc_model *model, const sc_pose *pose, uint64_t stride,
                        const sc_query_options *options, void *memory);

/* Finds the parts of size bytes at data; *model and pose->positions point into them. The model is still
   to be checked, by loading it, and the pose and options by asking. */
sc_status sc_recording_read(const void *data, uint64_t size, const void **model,
                            uint64_t *model_size, sc_pose *pose, sc_query_options *options);

#endif
