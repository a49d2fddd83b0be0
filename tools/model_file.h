/*
 * Saved models as files: what sc_model_save writes, followed by what the programs need to tell
 * whether a pose belongs to it.
 *
 * SPDX-License-Identifier: MIT
 *
 * A model knows how many vertices it has, not how the faces of its file ran, and of welded vertices
 * only that they are. sc-partition -o appends both, so that sc-query --model can refuse a mesh of
 * the same size that is another, and a pose that takes welded vertices apart, as it does with
 * --rest. A file without that part, such as a host saves, will do: then only the counts are
 * compared.
 */
#ifndef TOOLS_MODEL_FILE_H
#define TOOLS_MODEL_FILE_H

#include "mesh_file.h"

#include "starcontour.h"

/* All bytes of a file, at a multiple of SC_ALIGNMENT. On failure NULL, and error says why,
   beginning with the path. To be freed by free. */
void *model_file_bytes(const char *path, uint64_t *size, char error[MESH_FILE_ERROR_SIZE]);

/* Writes size bytes to a file; otherwise error says why not. */
bool model_file_dump(const char *path, const void *bytes, uint64_t size,
                     char error[MESH_FILE_ERROR_SIZE]);

/* Writes a model that was built from mesh with SC_WELD_REST, vertices not joined. */
bool model_file_write(const char *path, const sc_model *model, const mesh_file *mesh,
                      char error[MESH_FILE_ERROR_SIZE]);

typedef struct model_file {
    sc_model *model;
    void *bytes;        /* where the model is */
    uint64_t face_hash; /* of the mesh, 0 if not known */
    uint32_t *weld_map; /* per vertex, NULL if not known */
} model_file;

/* Reads what model_file_write wrote, or any saved model. On failure error says why and *file is
   empty. */
bool model_file_read(model_file *file, const char *path, char error[MESH_FILE_ERROR_SIZE]);

/* Frees everything; an all-zero file is allowed. */
void model_file_free(model_file *file);

/* Loads a model that stays where it is, if it is aligned; *reason, at least 256 bytes, gets what
   the library says of data that it refuses. */
sc_status model_file_load(const void *data, uint64_t size, sc_model **model, char *reason);

#endif /* TOOLS_MODEL_FILE_H */
