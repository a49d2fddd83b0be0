/*
 * Saved models as files; see model_file.h.
 *
 * SPDX-License-Identifier: MIT
 */
#define _POSIX_C_SOURCE 200809L

#include "model_file.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Stands behind the model, and vertex_count entries of the weld map behind it. */
typedef struct face_part {
    char magic[8];
    uint64_t face_hash;
    uint64_t checksum; /* of the weld map */
    uint64_t vertex_count;
} face_part;

static const char face_magic[8] = {'S', 'C', 'F', 'A', 'C', 'E', 'S', '\n'};

/* Fowler, Noll and Vo's hash (FNV-1a), a word at a time. */
static uint64_t map_checksum(uint64_t face_hash, const uint32_t *map, uint64_t count)
{
    uint64_t hash = 0xcbf29ce484222325u ^ face_hash;
    for (uint64_t i = 0; i < count; i++) hash = (hash ^ map[i]) * 0x100000001b3u;
    return hash;
}

static void *allocate_aligned(uint64_t size)
{
    void *memory = NULL;
    if (size > SIZE_MAX / 2) return NULL;
    return posix_memalign(&memory, SC_ALIGNMENT, size ? (size_t)size : 1) == 0 ? memory : NULL;
}

void *model_file_bytes(const char *path, uint64_t *size, char error[MESH_FILE_ERROR_SIZE])
{
    unsigned char *bytes = NULL;
    uint64_t used = 0, room = 0;
    errno = 0;
    FILE *file = fopen(path, "rb");
    bool good = file != NULL;
    /* the size of what is no regular file is not known beforehand */
    while (good) {
        if (used == room) {
            const uint64_t more = room ? 2 * room : 1 << 16;
            unsigned char *larger = (unsigned char *)allocate_aligned(more);
            if (!larger) {
                errno = ENOMEM;
                good = false;
                break;
            }
            if (used) memcpy(larger, bytes, (size_t)used);
            free(bytes);
            bytes = larger;
            room = more;
        }
        const size_t got = fread(bytes + used, 1, (size_t)(room - used), file);
        used += got;
        if (got == 0) break;
    }
    if (good && ferror(file)) good = false;
    if (!good) {
        snprintf(error, MESH_FILE_ERROR_SIZE, "%s: cannot be read: %s", path,
                 errno ? strerror(errno) : "input error");
        free(bytes);
        bytes = NULL;
    }
    if (file) fclose(file);
    *size = used;
    return bytes;
}

bool model_file_dump(const char *path, const void *bytes, uint64_t size,
                     char error[MESH_FILE_ERROR_SIZE])
{
    errno = 0;
    FILE *file = fopen(path, "wb");
    bool written = file && fwrite(bytes, 1, (size_t)size, file) == size;
    if (file && fclose(file) != 0) written = false;
    if (!written) {
        snprintf(error, MESH_FILE_ERROR_SIZE, "%s: cannot be written: %s", path,
                 errno ? strerror(errno) : "output error");
    }
    return written;
}

bool model_file_write(const char *path, const sc_model *model, const mesh_file *mesh,
                      char error[MESH_FILE_ERROR_SIZE])
{
    uint64_t model_size = 0;
    uint32_t *map = mesh_file_weld_map(mesh);
    sc_status status = sc_model_save_size(model, &model_size);
    const uint64_t map_size = mesh->vertex_count * (uint64_t)sizeof *map;
    const uint64_t size = model_size + sizeof(face_part) + map_size;
    unsigned char *bytes = (unsigned char *)allocate_aligned(size);
    bool written = false;
    if (status == SC_OK && (!map || !bytes)) status = SC_ERROR_MEMORY;
    if (status == SC_OK) status = sc_model_save(model, bytes, size, NULL);
    if (status == SC_OK) {
        face_part part;
        memset(&part, 0, sizeof part);
        memcpy(part.magic, face_magic, sizeof part.magic);
        part.face_hash = mesh_file_hash(mesh);
        part.vertex_count = mesh->vertex_count;
        part.checksum = map_checksum(part.face_hash, map, part.vertex_count);
        memcpy(bytes + model_size, &part, sizeof part);
        memcpy(bytes + model_size + sizeof part, map, (size_t)map_size);
        written = model_file_dump(path, bytes, size, error);
    } else {
        snprintf(error, MESH_FILE_ERROR_SIZE, "%s: %s", path, sc_status_string(status));
    }
    free(bytes);
    free(map);
    return written;
}

static void take_reason(void *user, uint32_t level, const char *message)
{
    (void)level;
    snprintf((char *)user, 256, "%s", message);
}

sc_status model_file_load(const void *data, uint64_t size, sc_model **model, char *reason)
{
    sc_hooks hooks;
    sc_load_options options;
    memset(&hooks, 0, sizeof hooks);
    hooks.struct_size = sizeof hooks;
    hooks.log = take_reason;
    hooks.user = reason;
    memset(&options, 0, sizeof options);
    options.struct_size = sizeof options;
    options.mode = SC_LOAD_IN_PLACE;
    options.hooks = &hooks;
    reason[0] = '\0';
    return sc_model_load(data, size, &options, model);
}

/* What stands behind the model, if it is all there: otherwise it is not ours. */
static bool read_faces(model_file *file, uint64_t size, const sc_model_info *info)
{
    face_part part;
    const unsigned char *at = (const unsigned char *)file->bytes + info->model_bytes;
    uint64_t left = size - info->model_bytes;
    if (left < sizeof part) return left == 0;
    memcpy(&part, at, sizeof part);
    left -= sizeof part;
    if (memcmp(part.magic, face_magic, sizeof part.magic) != 0) return true;
    if (part.vertex_count != info->vertex_count || left != 4 * part.vertex_count) return false;
    file->weld_map = (uint32_t *)malloc((size_t)left);
    if (!file->weld_map) return false;
    memcpy(file->weld_map, at + sizeof part, (size_t)left);
    file->face_hash = part.face_hash;
    for (uint32_t v = 0; v < info->vertex_count; v++) {
        if (file->weld_map[v] >= info->vertex_count) return false;
    }
    return map_checksum(part.face_hash, file->weld_map, part.vertex_count) == part.checksum;
}

bool model_file_read(model_file *file, const char *path, char error[MESH_FILE_ERROR_SIZE])
{
    uint64_t size;
    char reason[256];
    memset(file, 0, sizeof *file);
    file->bytes = model_file_bytes(path, &size, error);
    if (!file->bytes) return false;
    sc_model_info info;
    memset(&info, 0, sizeof info);
    info.struct_size = sizeof info;
    sc_status status = model_file_load(file->bytes, size, &file->model, reason);
    if (status == SC_OK) status = sc_model_get_info(file->model, &info);
    if (status != SC_OK) {
        snprintf(error, MESH_FILE_ERROR_SIZE, "%s: %s%s%s", path, sc_status_string(status),
                 reason[0] ? ": " : "", reason);
    } else if (!read_faces(file, size, &info)) {
        snprintf(error, MESH_FILE_ERROR_SIZE, "%s: what follows the model is damaged", path);
        status = SC_ERROR_CHECKSUM;
    }
    if (status == SC_OK) return true;
    model_file_free(file);
    return false;
}

void model_file_free(model_file *file)
{
    sc_model_free(file->model);
    free(file->bytes);
    free(file->weld_map);
    memset(file, 0, sizeof *file);
}
