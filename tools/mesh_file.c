/*
 * Meshes for the programs; see mesh_file.h.
 *
 * SPDX-License-Identifier: MIT
 */
#define _POSIX_C_SOURCE 200809L

#include "mesh_file.h"

#include "ply_header.h"
#include "text_mesh.h"

#include <assimp/cimport.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* An affine map: rows of x, y, z; the last column is the translation. */
typedef struct affine {
    double m[3][4];
} affine;

/* A walk over the meshes that the nodes of a scene show. */
typedef struct scene_walk {
    const struct aiScene *scene;
    float *positions; /* NULL: only count */
    uint32_t *indices;
    uint64_t vertex_count;
    uint64_t triangle_count;
    uint64_t face_hash; /* FNV-1a (Fowler, Noll, Vo) over corner counts and indices */
    bool has_polygons;
    bool bad_index;
    bool bad_node; /* assimp's reader of RAW files leaves out nodes: NULL */
} scene_walk;

static const uint64_t face_hash_start = UINT64_C(0xcbf29ce484222325);

static affine affine_from_node(const struct aiNode *node)
{
    const struct aiMatrix4x4 *t = &node->mTransformation;
    const affine result = {{{(double)t->a1, (double)t->a2, (double)t->a3, (double)t->a4},
                            {(double)t->b1, (double)t->b2, (double)t->b3, (double)t->b4},
                            {(double)t->c1, (double)t->c2, (double)t->c3, (double)t->c4}}};
    return result;
}

/* first after second */
static affine affine_multiply(const affine *first, const affine *second)
{
    affine result;
    for (int row = 0; row < 3; row++) {
        for (int column = 0; column < 4; column++) {
            double sum = column == 3 ? first->m[row][3] : 0.0;
            for (int k = 0; k < 3; k++) sum += first->m[row][k] * second->m[k][column];
            result.m[row][column] = sum;
        }
    }
    return result;
}

static bool affine_is_identity(const affine *map)
{
    for (int row = 0; row < 3; row++) {
        for (int column = 0; column < 4; column++) {
            if (map->m[row][column] != (row == column ? 1.0 : 0.0)) return false;
        }
    }
    return true;
}

static void add_to_hash(uint64_t *hash, uint32_t value)
{
    for (int byte = 0; byte < 4; byte++) {
        *hash = (*hash ^ ((value >> (8 * byte)) & 0xffu)) * UINT64_C(0x100000001b3);
    }
}

static void copy_positions(const struct aiMesh *mesh, const affine *map, float *positions)
{
    const bool identity = affine_is_identity(map);
    for (uint32_t i = 0; i < mesh->mNumVertices; i++) {
        const struct aiVector3D *v = &mesh->mVertices[i];
        float *out = positions + 3 * (size_t)i;
        if (identity) {
            out[0] = v->x;
            out[1] = v->y;
            out[2] = v->z;
            continue;
        }
        for (int row = 0; row < 3; row++) {
            const double *m = map->m[row];
            out[row] =
                (float)(m[0] * (double)v->x + m[1] * (double)v->y + m[2] * (double)v->z + m[3]);
        }
    }
}

static void walk_mesh(scene_walk *walk, const struct aiMesh *mesh, const affine *map)
{
    const uint32_t base = (uint32_t)walk->vertex_count;
    if (walk->positions) copy_positions(mesh, map, walk->positions + 3 * walk->vertex_count);
    for (uint32_t f = 0; f < mesh->mNumFaces; f++) {
        const struct aiFace *face = &mesh->mFaces[f];
        add_to_hash(&walk->face_hash, face->mNumIndices);
        for (uint32_t k = 0; k < face->mNumIndices; k++) {
            add_to_hash(&walk->face_hash, base + face->mIndices[k]);
            if (face->mIndices[k] >= mesh->mNumVertices) walk->bad_index = true;
        }
        if (face->mNumIndices > 3) walk->has_polygons = true;
        if (face->mNumIndices != 3) continue;
        if (walk->indices) {
            for (int k = 0; k < 3; k++) {
                walk->indices[3 * walk->triangle_count + (uint64_t)k] = base + face->mIndices[k];
            }
        }
        walk->triangle_count++;
    }
    walk->vertex_count += mesh->mNumVertices;
}

static void walk_node(scene_walk *walk, const struct aiNode *node, const affine *parent)
{
    if (!node) {
        walk->bad_node = true;
        return;
    }
    const affine own = affine_from_node(node);
    const affine map = affine_multiply(parent, &own);
    for (uint32_t i = 0; i < node->mNumMeshes; i++) {
        walk_mesh(walk, walk->scene->mMeshes[node->mMeshes[i]], &map);
    }
    for (uint32_t i = 0; i < node->mNumChildren; i++) walk_node(walk, node->mChildren[i], &map);
}

/* Counts, and copies if there are arrays to copy to. */
static scene_walk walk_scene(const struct aiScene *scene, float *positions, uint32_t *indices)
{
    const affine identity = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
    scene_walk walk;
    memset(&walk, 0, sizeof walk);
    walk.scene = scene;
    walk.positions = positions;
    walk.indices = indices;
    walk.face_hash = face_hash_start;
    if (scene->mRootNode) walk_node(&walk, scene->mRootNode, &identity);
    return walk;
}

/*
 * Tells apart what assimp calls by one name: no file, no permission, a folder, nothing in it. And
 * refuses what it does not come back from: a pipe, which it would open once more, and PLY files
 * with headers that it believes too much of.
 */
static bool check_file(const char *path, char error[MESH_FILE_ERROR_SIZE])
{
    struct stat what;
    FILE *file = NULL;
    char magic[3];
    const char *reason = NULL;
    errno = 0;
    if (stat(path, &what) != 0) {
        reason = strerror(errno);
    } else if (S_ISFIFO(what.st_mode) || S_ISSOCK(what.st_mode) || S_ISCHR(what.st_mode)) {
        reason = "a pipe or device; meshes are read from files, whose names tell the format";
    } else if (!(file = fopen(path, "rb"))) {
        reason = strerror(errno);
    } else {
        const size_t size = fread(magic, 1, sizeof magic, file);
        if (size == 0)
            reason = ferror(file) ? strerror(errno) : "the file is empty";
        else if (size == 3 && memcmp(magic, "ply", 3) == 0)
            reason = ply_header_check(file, (uint64_t)what.st_size);
    }
    if (reason) snprintf(error, MESH_FILE_ERROR_SIZE, "%s: %s", path, reason);
    if (file) fclose(file);
    return reason == NULL;
}

/* Imports a file as it is, without post-processing, and counts what is in it. */
static const struct aiScene *import_scene(const char *path, scene_walk *walk,
                                          char error[MESH_FILE_ERROR_SIZE])
{
    if (!check_file(path, error)) return NULL;
    const struct aiScene *scene = aiImportFile(path, 0);
    if (!scene) {
        snprintf(error, MESH_FILE_ERROR_SIZE, "%s: cannot be read as a mesh: %s", path,
                 aiGetErrorString());
        return NULL;
    }
    *walk = walk_scene(scene, NULL, NULL);
    const char *reason = NULL;
    if (walk->bad_node)
        reason = "cannot be read as a mesh: assimp gives a scene with missing nodes";
    else if (walk->bad_index)
        reason = "a face names a vertex that does not exist; is the file truncated?";
    else if (walk->vertex_count >= UINT32_MAX)
        reason = "too many vertices";
    else if (walk->triangle_count == 0 && !walk->has_polygons)
        reason = "no triangles in it";
    if (reason) {
        snprintf(error, MESH_FILE_ERROR_SIZE, "%s: %s", path, reason);
        aiReleaseImport(scene);
        return NULL;
    }
    return scene;
}

static bool read_scene(mesh_file *mesh, const char *path, char error[MESH_FILE_ERROR_SIZE])
{
    scene_walk counted;
    const struct aiScene *scene = import_scene(path, &counted, error);
    if (!scene) return false;
    const uint64_t face_hash = counted.face_hash;
    const uint64_t vertex_count = counted.vertex_count;
    if (counted.has_polygons) {
        scene = aiApplyPostProcessing(scene, aiProcess_Triangulate);
        if (!scene) {
            snprintf(error, MESH_FILE_ERROR_SIZE, "%s: its polygons cannot be triangulated: %s",
                     path, aiGetErrorString());
            return false;
        }
        counted = walk_scene(scene, NULL, NULL);
    }
    const char *reason = NULL;
    if (counted.has_polygons || counted.bad_index || counted.vertex_count != vertex_count) {
        reason = "its polygons cannot be triangulated";
    } else if (counted.triangle_count == 0) {
        reason = "no triangles in it";
    } else if (counted.triangle_count > UINT32_MAX / 3) {
        reason = "too many triangles";
    } else if (!mesh_file_allocate(mesh, (uint32_t)vertex_count,
                                   (uint32_t)counted.triangle_count)) {
        reason = "out of memory";
    }
    if (reason) {
        snprintf(error, MESH_FILE_ERROR_SIZE, "%s: %s", path, reason);
    } else {
        walk_scene(scene, mesh->positions, mesh->indices);
        mesh->face_hash = face_hash;
    }
    aiReleaseImport(scene);
    return reason == NULL;
}

/* Reads an OBJ or OFF file's polygons and hashes them as walk_mesh does. */
static bool open_text(text_mesh *text, const char *path, uint64_t *face_hash,
                      char error[MESH_FILE_ERROR_SIZE])
{
    if (!check_file(path, error)) return false;
    if (!text_mesh_read(text, path, error, MESH_FILE_ERROR_SIZE)) return false;
    if (text->face_count == 0) {
        snprintf(error, MESH_FILE_ERROR_SIZE, "%s: no triangles in it", path);
        text_mesh_free(text);
        return false;
    }
    *face_hash = face_hash_start;
    for (size_t f = 0; f < text->face_count; f++) {
        add_to_hash(face_hash, (uint32_t)(text->offsets[f + 1] - text->offsets[f]));
        for (size_t c = text->offsets[f]; c < text->offsets[f + 1]; c++) {
            add_to_hash(face_hash, text->corners[c]);
        }
    }
    return true;
}

static bool read_text(mesh_file *mesh, const char *path, char error[MESH_FILE_ERROR_SIZE])
{
    text_mesh text;
    uint64_t face_hash;
    if (!open_text(&text, path, &face_hash, error)) return false;
    const size_t triangle_count = text.offsets[text.face_count] - 2 * text.face_count;
    const char *reason = NULL;
    if (triangle_count > UINT32_MAX / 3) {
        reason = "too many triangles";
    } else if (!mesh_file_allocate(mesh, (uint32_t)text.vertex_count, (uint32_t)triangle_count)) {
        reason = "out of memory";
    } else {
        memcpy(mesh->positions, text.positions, 3 * text.vertex_count * sizeof(float));
        mesh->face_hash = face_hash;
        uint32_t *out = mesh->indices;
        for (size_t f = 0; f < text.face_count; f++) {
            const uint32_t count = (uint32_t)(text.offsets[f + 1] - text.offsets[f]);
            text_mesh_triangulate(mesh->positions, text.corners + text.offsets[f], count, out);
            out += 3 * ((size_t)count - 2);
        }
    }
    if (reason) snprintf(error, MESH_FILE_ERROR_SIZE, "%s: %s", path, reason);
    text_mesh_free(&text);
    return reason == NULL;
}

bool mesh_file_read(mesh_file *mesh, const char *path, char error[MESH_FILE_ERROR_SIZE])
{
    memset(mesh, 0, sizeof *mesh);
    return text_mesh_knows(path) ? read_text(mesh, path, error) : read_scene(mesh, path, error);
}

/* Says why a file is not a pose of rest, if it is not. */
static bool check_pose(const mesh_file *rest, const char *path, uint64_t vertex_count,
                       uint64_t face_hash, char error[MESH_FILE_ERROR_SIZE])
{
    if (vertex_count != rest->vertex_count) {
        snprintf(error, MESH_FILE_ERROR_SIZE,
                 "%s: not a pose of the rest mesh: %lu vertices, the rest mesh has %lu", path,
                 (unsigned long)vertex_count, (unsigned long)rest->vertex_count);
    } else if (face_hash != rest->face_hash) {
        snprintf(error, MESH_FILE_ERROR_SIZE,
                 "%s: not a pose of the rest mesh: its faces differ in number, order or vertices",
                 path);
    }
    return vertex_count == rest->vertex_count && face_hash == rest->face_hash;
}

bool mesh_file_read_pose(const mesh_file *rest, const char *path, float *positions,
                         char error[MESH_FILE_ERROR_SIZE])
{
    bool good;
    if (text_mesh_knows(path)) {
        text_mesh text;
        uint64_t face_hash;
        if (!open_text(&text, path, &face_hash, error)) return false;
        good = check_pose(rest, path, text.vertex_count, face_hash, error);
        if (good) memcpy(positions, text.positions, 3 * text.vertex_count * sizeof(float));
        text_mesh_free(&text);
    } else {
        scene_walk counted;
        const struct aiScene *scene = import_scene(path, &counted, error);
        if (!scene) return false;
        good = check_pose(rest, path, counted.vertex_count, counted.face_hash, error);
        if (good) walk_scene(scene, positions, NULL);
        aiReleaseImport(scene);
    }
    return good;
}

bool mesh_file_allocate(mesh_file *mesh, uint32_t vertex_count, uint32_t triangle_count)
{
    memset(mesh, 0, sizeof *mesh);
    mesh->positions = (float *)malloc(3 * (size_t)vertex_count * sizeof(float));
    mesh->indices = (uint32_t *)malloc(3 * (size_t)triangle_count * sizeof(uint32_t));
    if (!mesh->positions || !mesh->indices) {
        mesh_file_free(mesh);
        return false;
    }
    mesh->vertex_count = vertex_count;
    mesh->triangle_count = triangle_count;
    return true;
}

void mesh_file_free(mesh_file *mesh)
{
    free(mesh->positions);
    free(mesh->indices);
    memset(mesh, 0, sizeof *mesh);
}

/* The bits of a position, those of -0 taken as those of 0. */
static void position_key(const float *position, uint32_t key[3])
{
    for (int k = 0; k < 3; k++) {
        const float value = position[k] == 0.0f ? 0.0f : position[k];
        memcpy(&key[k], &value, sizeof value);
    }
}

uint32_t *mesh_file_weld_map(const mesh_file *mesh)
{
    /* An open hash table, at most half full, of the vertices that represent a position. */
    uint64_t slots = 16;
    while (slots < 2 * (uint64_t)mesh->vertex_count) slots *= 2;
    uint32_t *table = (uint32_t *)malloc((size_t)slots * sizeof *table);
    uint32_t *map = (uint32_t *)malloc((size_t)mesh->vertex_count * sizeof *map);
    if (!table || !map) {
        free(table);
        free(map);
        return NULL;
    }
    memset(table, 0xff, (size_t)slots * sizeof *table);
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        uint32_t key[3], other[3];
        position_key(mesh->positions + 3 * (size_t)v, key);
        uint64_t hash = UINT64_C(0x9e3779b97f4a7c15);
        for (int k = 0; k < 3; k++) {
            hash = (hash ^ key[k]) * UINT64_C(0xff51afd7ed558ccd);
            hash ^= hash >> 32;
        }
        uint64_t slot = hash & (slots - 1);
        for (; table[slot] != UINT32_MAX; slot = (slot + 1) & (slots - 1)) {
            position_key(mesh->positions + 3 * (size_t)table[slot], other);
            if (memcmp(key, other, sizeof key) == 0) break;
        }
        if (table[slot] == UINT32_MAX) table[slot] = v;
        map[v] = table[slot];
    }
    free(table);
    return map;
}

bool mesh_file_join(mesh_file *mesh)
{
    uint32_t *map = mesh_file_weld_map(mesh);
    if (!map) return false;
    uint32_t count = 0;
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        if (map[v] != v) {
            map[v] = map[map[v]]; /* lower, hence renumbered already */
            continue;
        }
        memmove(mesh->positions + 3 * (size_t)count, mesh->positions + 3 * (size_t)v,
                3 * sizeof(float));
        map[v] = count++;
    }
    for (size_t c = 0; c < 3 * (size_t)mesh->triangle_count; c++) {
        mesh->indices[c] = map[mesh->indices[c]];
    }
    mesh->vertex_count = count;
    free(map);
    return true;
}
