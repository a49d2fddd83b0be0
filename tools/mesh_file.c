/*
 * Meshes for the programs; see mesh_file.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "mesh_file.h"

#include "file_bytes.h"
#include "ply_read.h"
#include "polygon_mesh.h"
#include "scene_read.h"
#include "stl_read.h"
#include "text_mesh.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static size_t number_size(uint32_t position_type)
{
    return position_type == SC_DOUBLE ? sizeof(double) : sizeof(float);
}

/* ------------------------------------------------------------------------------------------------
 * Reading
 */

static void add_to_hash(uint64_t *hash, uint32_t value)
{
    for (int byte = 0; byte < 4; byte++) {
        *hash = (*hash ^ ((value >> (8 * byte)) & 0xffu)) * UINT64_C(0x100000001b3);
    }
}

/* The FNV-1a hash (Fowler, Noll, Vo) of nothing. */
#define EMPTY_HASH UINT64_C(0xcbf29ce484222325)

/* FNV-1a over corner counts and corners. */
static uint64_t hash_faces(const polygon_mesh *polygons)
{
    uint64_t hash = EMPTY_HASH;
    for (size_t f = 0; f < polygons->face_count; f++) {
        add_to_hash(&hash, (uint32_t)(polygons->offsets[f + 1] - polygons->offsets[f]));
        for (size_t c = polygons->offsets[f]; c < polygons->offsets[f + 1]; c++) {
            add_to_hash(&hash, polygons->corners[c]);
        }
    }
    return hash;
}

uint64_t mesh_file_hash(const mesh_file *mesh)
{
    if (mesh->face_hash || mesh->face_of_triangle) return mesh->face_hash;
    uint64_t hash = EMPTY_HASH; /* the same as of the polygons that the triangles were */
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        add_to_hash(&hash, 3);
        for (size_t k = 0; k < 3; k++) add_to_hash(&hash, mesh->indices[3 * t + k]);
    }
    return hash;
}

static uint32_t assumed = MESH_FORMAT_UNKNOWN;

void mesh_file_assume(uint32_t format)
{
    assumed = format;
}

/* Whether a name of so many characters ends in that, in large or small letters. */
static bool ends_in(const char *name, size_t length, const char *ending)
{
    const size_t tail = strlen(ending);
    if (length < tail) return false;
    for (size_t i = 0; i < tail; i++) {
        if ((name[length - tail + i] | 0x20) != (ending[i] | 0x20)) return false;
    }
    return true;
}

/* The format that a name tells, which may end in .gz. */
static uint32_t format_of_name(const char *path)
{
    static const char *const endings[] = {NULL, ".obj", ".off", ".ply", ".stl"};
    size_t length = strlen(path);
    if (ends_in(path, length, ".gz")) length -= 3;
    for (uint32_t format = MESH_FORMAT_OBJ; format <= MESH_FORMAT_STL; format++) {
        if (ends_in(path, length, endings[format])) return format;
    }
    return MESH_FORMAT_UNKNOWN;
}

/* The format of a file that its name does not tell; unknown: one that assimp is to find out. */
static uint32_t format_of_content(const char *path, const file_bytes *bytes)
{
    if (strcmp(path, "-") != 0 && scene_read_knows(path)) return MESH_FORMAT_UNKNOWN;
    if (assumed != MESH_FORMAT_UNKNOWN) return assumed;
    if (ply_read_knows(bytes->data, bytes->size)) return MESH_FORMAT_PLY;
    if (stl_read_knows(bytes->data, bytes->size)) return MESH_FORMAT_STL;
    return MESH_FORMAT_UNKNOWN;
}

static bool read_format(polygon_mesh *polygons, const char *path, uint32_t format,
                        file_bytes *bytes, char error[MESH_FILE_ERROR_SIZE])
{
    switch (format) {
    case MESH_FORMAT_OBJ:
    case MESH_FORMAT_OFF:
        return text_mesh_read(polygons, path, format == MESH_FORMAT_OFF, bytes->data, bytes->size,
                              error, MESH_FILE_ERROR_SIZE);
    case MESH_FORMAT_PLY:
        return ply_read(polygons, path, bytes->data, bytes->size, error, MESH_FILE_ERROR_SIZE);
    case MESH_FORMAT_STL:
        return stl_read(polygons, path, bytes->data, bytes->size, error, MESH_FILE_ERROR_SIZE);
    default:
        if (!bytes->is_plain && !scene_read_knows(path)) {
            snprintf(error, MESH_FILE_ERROR_SIZE,
                     "%s: neither the name nor the content tells the format: --format does", path);
            return false;
        }
        if (bytes->is_plain) {
            free(bytes->data); /* assimp takes its own copy */
            bytes->data = NULL;
        }
        return scene_read(polygons, path, bytes->data, bytes->size, error, MESH_FILE_ERROR_SIZE);
    }
}

/* Reads a file's polygons, of which at least one has three corners. */
static bool read_polygons(polygon_mesh *polygons, const char *path,
                          char error[MESH_FILE_ERROR_SIZE])
{
    file_bytes bytes;
    memset(polygons, 0, sizeof *polygons);
    if (!file_bytes_read(&bytes, path, error, MESH_FILE_ERROR_SIZE)) return false;
    uint32_t format = format_of_name(path);
    if (format == MESH_FORMAT_UNKNOWN) format = format_of_content(path, &bytes);
    const bool done = read_format(polygons, path, format, &bytes, error);
    free(bytes.data);
    if (!done) return false;
    if (polygon_mesh_triangle_count(polygons) > 0) return true;
    snprintf(error, MESH_FILE_ERROR_SIZE, "%s: no triangles in it", path);
    polygon_mesh_free(polygons);
    return false;
}

/* Whether a float is the same number; so are NaN and infinity, which the library will refuse. */
static bool is_float(double value)
{
    return !(fabs(value) <= (double)FLT_MAX) ? !isfinite(value) : (double)(float)value == value;
}

/* Makes doubles floats, in place. What is larger than any float becomes infinite. */
static void narrow(double *positions, size_t count)
{
    char *out = (char *)positions;
    for (size_t i = 0; i < count; i++) {
        const double value = positions[i];
        const float single = fabs(value) <= (double)FLT_MAX || isnan(value) ? (float)value
                             : value > 0.0                                  ? HUGE_VALF
                                                                            : -HUGE_VALF;
        memcpy(out + i * sizeof single, &single, sizeof single);
    }
}

/* Takes the positions out of the polygons, as floats if that is what they are. */
static void *take_positions(polygon_mesh *polygons, uint32_t *position_type)
{
    double *positions = polygons->positions;
    const size_t count = 3 * polygons->vertex_count;
    size_t floats = 0;
    while (floats < count && is_float(positions[floats])) floats++;
    *position_type = floats == count ? SC_FLOAT : SC_DOUBLE;
    if (floats == count) narrow(positions, count);
    polygons->positions = NULL;
    void *fitting = realloc(positions, count * number_size(*position_type));
    return fitting ? fitting : positions;
}

/* Takes the corners out of polygons that are triangles. */
static void take_triangles(mesh_file *mesh, polygon_mesh *polygons)
{
    uint32_t *corners = polygons->corners;
    polygons->corners = NULL;
    void *fitting = realloc(corners, 3 * (size_t)mesh->triangle_count * sizeof *corners);
    mesh->indices = fitting ? (uint32_t *)fitting : corners;
}

/* Cuts faces into triangles, and notes which are of which face if that is not plain. */
static bool make_triangles(mesh_file *mesh, polygon_mesh *polygons)
{
    mesh->face_count = (uint32_t)polygons->face_count;
    bool plain = mesh->face_count == mesh->triangle_count;
    for (size_t f = 0; plain && f < polygons->face_count; f++) {
        plain = polygons->offsets[f + 1] - polygons->offsets[f] == 3;
    }
    if (plain) {
        take_triangles(mesh, polygons);
        return true;
    }
    mesh->face_hash = hash_faces(polygons);
    mesh->indices = (uint32_t *)malloc(3 * (size_t)mesh->triangle_count * sizeof(uint32_t));
    mesh->face_of_triangle = (uint32_t *)malloc((size_t)mesh->triangle_count * sizeof(uint32_t));
    if (!mesh->indices || !mesh->face_of_triangle) return false;
    size_t triangle = 0;
    for (size_t f = 0; f < polygons->face_count; f++) {
        const uint32_t *corners = polygons->corners + polygons->offsets[f];
        const uint32_t count = (uint32_t)(polygons->offsets[f + 1] - polygons->offsets[f]);
        if (count < 3) continue;
        polygon_mesh_triangulate(polygons->positions, corners, count, mesh->indices + 3 * triangle);
        for (uint32_t t = 2; t < count; t++) mesh->face_of_triangle[triangle++] = (uint32_t)f;
    }
    return true;
}

bool mesh_file_read(mesh_file *mesh, const char *path, char error[MESH_FILE_ERROR_SIZE])
{
    polygon_mesh polygons;
    memset(mesh, 0, sizeof *mesh);
    if (!read_polygons(&polygons, path, error)) return false;
    const uint64_t triangle_count = polygon_mesh_triangle_count(&polygons);
    const char *reason = triangle_count > UINT32_MAX / 3 ? "too many triangles" : NULL;
    if (!reason) {
        mesh->vertex_count = (uint32_t)polygons.vertex_count;
        mesh->triangle_count = (uint32_t)triangle_count;
        if (!make_triangles(mesh, &polygons)) reason = "out of memory";
    }
    if (reason) {
        snprintf(error, MESH_FILE_ERROR_SIZE, "%s: %s", path, reason);
        mesh_file_free(mesh);
    } else {
        mesh->positions = take_positions(&polygons, &mesh->position_type);
        mesh->object_count = polygons.object_count;
        mesh->object_names = polygons.object_names;
        mesh->object_of_face = polygons.object_of_face;
        mesh->rounded = polygons.rounded;
        mesh->has_animation = polygons.has_animation;
        polygons.object_count = 0;
        polygons.object_names = NULL;
        polygons.object_of_face = NULL;
    }
    polygon_mesh_free(&polygons);
    return reason == NULL;
}

/* Says why a file is not a pose of rest, if it is not. */
static bool check_pose(const mesh_file *rest, const char *path, uint64_t vertex_count,
                       uint64_t face_hash, char error[MESH_FILE_ERROR_SIZE])
{
    const bool same_faces = face_hash == mesh_file_hash(rest);
    if (vertex_count != rest->vertex_count) {
        snprintf(error, MESH_FILE_ERROR_SIZE,
                 "%s: not a pose of the rest mesh: %lu vertices, the rest mesh has %lu", path,
                 (unsigned long)vertex_count, (unsigned long)rest->vertex_count);
    } else if (!same_faces) {
        snprintf(error, MESH_FILE_ERROR_SIZE,
                 "%s: not a pose of the rest mesh: its faces differ in number, order or vertices",
                 path);
    }
    return vertex_count == rest->vertex_count && same_faces;
}

bool mesh_file_read_pose(const mesh_file *rest, const char *path, mesh_pose *pose,
                         char error[MESH_FILE_ERROR_SIZE])
{
    polygon_mesh polygons;
    memset(pose, 0, sizeof *pose);
    if (!read_polygons(&polygons, path, error)) return false;
    const bool fits = check_pose(rest, path, polygons.vertex_count, hash_faces(&polygons), error);
    if (fits) {
        pose->positions = take_positions(&polygons, &pose->position_type);
        pose->rounded = polygons.rounded;
        pose->has_animation = polygons.has_animation;
    }
    polygon_mesh_free(&polygons);
    return fits;
}

void mesh_pose_free(mesh_pose *pose)
{
    free(pose->positions);
    memset(pose, 0, sizeof *pose);
}

/* ------------------------------------------------------------------------------------------------
 * Meshes
 */

bool mesh_file_allocate(mesh_file *mesh, uint32_t vertex_count, uint32_t triangle_count)
{
    memset(mesh, 0, sizeof *mesh);
    mesh->positions = malloc(3 * (size_t)vertex_count * sizeof(float));
    mesh->indices = (uint32_t *)malloc(3 * (size_t)triangle_count * sizeof(uint32_t));
    if (!mesh->positions || !mesh->indices) {
        mesh_file_free(mesh);
        return false;
    }
    mesh->position_type = SC_FLOAT;
    mesh->vertex_count = vertex_count;
    mesh->triangle_count = mesh->face_count = triangle_count;
    return true;
}

void mesh_file_free(mesh_file *mesh)
{
    for (uint32_t i = 0; i < mesh->object_count; i++) free(mesh->object_names[i]);
    free(mesh->object_names);
    free(mesh->object_of_face);
    free(mesh->face_of_triangle);
    free(mesh->positions);
    free(mesh->indices);
    memset(mesh, 0, sizeof *mesh);
}

void mesh_file_position(const void *positions, uint32_t position_type, size_t vertex,
                        double position[3])
{
    for (size_t k = 0; k < 3; k++) {
        position[k] = position_type == SC_DOUBLE
                          ? ((const double *)positions)[3 * vertex + k]
                          : (double)((const float *)positions)[3 * vertex + k];
    }
}

float *mesh_file_floats(mesh_file *mesh)
{
    if (mesh->position_type == SC_DOUBLE)
        narrow((double *)mesh->positions, 3 * (size_t)mesh->vertex_count);
    mesh->position_type = SC_FLOAT;
    return (float *)mesh->positions;
}

/* The bits of a position, those of -0 taken as those of 0. */
static void position_key(const mesh_file *mesh, size_t vertex, uint64_t key[3])
{
    double position[3];
    mesh_file_position(mesh->positions, mesh->position_type, vertex, position);
    for (int k = 0; k < 3; k++) {
        const double value = position[k] == 0.0 ? 0.0 : position[k];
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
        uint64_t key[3], other[3];
        position_key(mesh, v, key);
        uint64_t hash = UINT64_C(0x9e3779b97f4a7c15);
        for (int k = 0; k < 3; k++) {
            hash = (hash ^ key[k]) * UINT64_C(0xff51afd7ed558ccd);
            hash ^= hash >> 32;
        }
        uint64_t slot = hash & (slots - 1);
        for (; table[slot] != UINT32_MAX; slot = (slot + 1) & (slots - 1)) {
            position_key(mesh, table[slot], other);
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
    mesh->face_hash = mesh_file_hash(mesh); /* of the faces as read */
    const size_t size = 3 * number_size(mesh->position_type);
    char *positions = (char *)mesh->positions;
    uint32_t count = 0;
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        if (map[v] != v) {
            map[v] = map[map[v]]; /* lower, hence renumbered already */
            continue;
        }
        memmove(positions + size * count, positions + size * v, size);
        map[v] = count++;
    }
    for (size_t c = 0; c < 3 * (size_t)mesh->triangle_count; c++) {
        mesh->indices[c] = map[mesh->indices[c]];
    }
    mesh->vertex_count = count;
    free(map);
    return true;
}
