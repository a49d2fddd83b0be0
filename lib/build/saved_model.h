/*
 * Models as bytes: what sc_model_save writes and sc_model_load reads.
 *
 * SPDX-License-Identifier: MIT
 *
 *     | sc_saved_header | sc_model | array | array | ... |
 *
 * that is, the model's block as it is in memory, behind a header in place of what frees it
 * (build/model.h). All of it is numbers of fixed width in the saving machine's byte order, so files
 * of one byte order are good for all machines of that order. A save of equal models is equal.
 */
#ifndef SC_BUILD_SAVED_MODEL_H
#define SC_BUILD_SAVED_MODEL_H

#include "base/hooks.h"
#include "build/model.h"

/* Bytes of a model when saved. */
uint64_t sc_saved_model_bytes(const sc_model *model);

/* Writes that many bytes, at any alignment. */
void sc_saved_model_write(const sc_model *model, void *memory);

/* Finds how many triangles a model at data (any alignment) has, if sc_saved_model_read accepts
   it. */
sc_status sc_saved_model_triangles(const void *data, uint64_t size, uint32_t *count);

/*
 * Makes a model of size bytes at data: in a block of its own, or, with in_place, in data itself,
 * which has to be aligned then and is only read. What else is saved in data behind the model is
 * ignored. Everything is checked before it is used (build/model_check.h). topology_hash 0 stands
 * for any.
 */
sc_status sc_saved_model_read(const void *data, uint64_t size, int in_place, uint64_t topology_hash,
                              sc_scratch *scratch, const sc_hooks *hooks, sc_model **model);

#endif
