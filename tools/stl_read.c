/*
 * Reads STL files; see stl_read.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "stl_read.h"

#include "file_bytes.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A binary file: 80 bytes that say nothing, the number of triangles, and for each of them a normal
   and three vertices of floats and two bytes of attributes. */
enum { HEADER_SIZE = 84, FACET_SIZE = 50, NORMAL_SIZE = 12 };

typedef struct stl_reader {
    const char *path, *at;
    unsigned long line;
    char *error;
    size_t error_size;
    polygon_mesh *mesh;
    size_t corners; /* of the loop that is being read */
} stl_reader;

static bool is_blank(char c)
{
    return c == ' ' || (c >= '\t' && c <= '\r');
}

static uint32_t get_uint32(const char *data)
{
    const unsigned char *bytes = (const unsigned char *)data;
    return (uint32_t)bytes[0] | (uint32_t)bytes[1] << 8 | (uint32_t)bytes[2] << 16 |
           (uint32_t)bytes[3] << 24;
}

/* ------------------------------------------------------------------------------------------------
 * Text
 */

static bool fail(stl_reader *reader, const char *reason)
{
    snprintf(reader->error, reader->error_size, "%s: line %lu: %s", reader->path, reader->line,
             reason);
    return false;
}

static bool fail_memory(stl_reader *reader)
{
    return fail(reader, "out of memory");
}

/* Whether the word of so many characters is that keyword, in large or small letters. */
static bool is_word(const char *word, size_t length, const char *keyword)
{
    if (strlen(keyword) != length) return false;
    for (size_t i = 0; i < length; i++) {
        if ((word[i] | 0x20) != keyword[i]) return false;
    }
    return true;
}

/* The next word; its length is 0 at the end of the file. */
static const char *next_word(stl_reader *reader, size_t *length)
{
    for (; is_blank(*reader->at); reader->at++)
        reader->line += *reader->at == '\n' || (*reader->at == '\r' && reader->at[1] != '\n');
    const char *begin = reader->at;
    while (*reader->at && !is_blank(*reader->at)) reader->at++;
    *length = (size_t)(reader->at - begin);
    return begin;
}

static bool expect(stl_reader *reader, const char *keyword)
{
    size_t length;
    const char *word = next_word(reader, &length);
    if (is_word(word, length, keyword)) return true;
    snprintf(reader->error, reader->error_size, "%s: line %lu: %s is expected here%s", reader->path,
             reader->line, keyword, length ? "" : ", the file ends; is it truncated?");
    return false;
}

static bool ends_line(char c)
{
    return c == '\n' || c == '\r';
}

/* What stands behind a word on its line. */
static const char *rest_of_line(stl_reader *reader, size_t *length)
{
    while (is_blank(*reader->at) && !ends_line(*reader->at)) reader->at++;
    const char *begin = reader->at;
    while (*reader->at && !ends_line(*reader->at)) reader->at++;
    *length = (size_t)(reader->at - begin);
    while (*length && is_blank(begin[*length - 1])) --*length;
    return begin;
}

static bool read_vertex(stl_reader *reader)
{
    double position[3];
    for (int k = 0; k < 3; k++) {
        size_t length;
        char *end;
        const char *word = next_word(reader, &length);
        errno = 0;
        position[k] = length ? strtod(word, &end) : 0.0;
        if (length == 0 || end != word + length)
            return fail(reader, "a vertex needs three numbers");
        if (errno == ERANGE && fabs(position[k]) > 1.0) {
            snprintf(reader->error, reader->error_size,
                     "%s: line %lu: vertex %lu: %.*s is too large for a double", reader->path,
                     reader->line, (unsigned long)reader->mesh->vertex_count,
                     length > 40 ? 40 : (int)length, word);
            return false;
        }
    }
    const size_t vertex = reader->mesh->vertex_count;
    if (vertex >= UINT32_MAX - 1) return fail(reader, "too many vertices");
    return (polygon_mesh_add_vertex(reader->mesh, position) &&
            polygon_mesh_add_corner(reader->mesh, reader->corners++, (uint32_t)vertex)) ||
           fail_memory(reader);
}

/* From behind the word facet. */
static bool read_facet(stl_reader *reader)
{
    size_t length;
    if (!expect(reader, "normal")) return false;
    for (int k = 0; k < 3; k++) next_word(reader, &length);
    if (!expect(reader, "outer") || !expect(reader, "loop")) return false;
    for (reader->corners = 0;;) {
        const char *word = next_word(reader, &length);
        if (is_word(word, length, "endloop")) break;
        if (!is_word(word, length, "vertex"))
            return fail(reader, length ? "vertex or endloop is expected here"
                                       : "the file ends within a facet; is it truncated?");
        if (!read_vertex(reader)) return false;
    }
    if (reader->corners < 3) return fail(reader, "a facet needs three vertices");
    if (!polygon_mesh_end_face(reader->mesh, reader->corners)) return fail_memory(reader);
    return expect(reader, "endfacet");
}

static bool read_text(stl_reader *reader, const char *end)
{
    bool inside = false; /* between solid and endsolid */
    for (;;) {
        size_t length;
        const char *word = next_word(reader, &length);
        if (length == 0 && reader->at < end)
            return fail(reader, "a byte of value 0: this is no text");
        if (length == 0) break;
        if (!inside && is_word(word, length, "solid")) {
            const char *name = rest_of_line(reader, &length);
            inside = true;
            if (!polygon_mesh_mark(reader->mesh, 's', name, length)) return fail_memory(reader);
        } else if (inside && is_word(word, length, "endsolid")) {
            rest_of_line(reader, &length);
            inside = false;
        } else if (!inside || !is_word(word, length, "facet")) {
            return fail(reader,
                        inside ? "facet or endsolid is expected here" : "solid is expected here");
        } else if (!read_facet(reader)) {
            return false;
        }
    }
    if (inside) return fail(reader, "the file ends without endsolid; is it truncated?");
    return polygon_mesh_name_objects(reader->mesh, 's', false) || fail_memory(reader);
}

/* ------------------------------------------------------------------------------------------------
 * Binary
 */

static bool read_binary(stl_reader *reader, size_t size)
{
    polygon_mesh *const mesh = reader->mesh;
    const size_t room = size < HEADER_SIZE ? 0 : (size - HEADER_SIZE) / FACET_SIZE;
    const uint32_t count = size < HEADER_SIZE ? 0 : get_uint32(reader->at + HEADER_SIZE - 4);
    if (size < HEADER_SIZE) {
        snprintf(reader->error, reader->error_size,
                 "%s: neither a text STL file nor long enough for a binary one; is it truncated?",
                 reader->path);
        return false;
    }
    if (count != room) {
        snprintf(reader->error, reader->error_size,
                 "%s: a binary STL file of %lu triangles, %s %lu%s", reader->path,
                 (unsigned long)count, count > room ? "of which it has" : "but with room for",
                 (unsigned long)room, count > room ? "; is it truncated?" : "");
        return false;
    }
    if (count > UINT32_MAX / 3) return fail(reader, "too many triangles");
    const char *facet = reader->at + HEADER_SIZE;
    bool done = polygon_mesh_reserve_vertices(mesh, 3 * (size_t)count) &&
                polygon_mesh_reserve_corners(mesh, 3 * (size_t)count);
    for (uint32_t t = 0; done && t < count; t++, facet += FACET_SIZE) {
        const uint32_t corners[3] = {3 * t, 3 * t + 1, 3 * t + 2};
        for (size_t v = 0; v < 3; v++) {
            double position[3];
            for (size_t k = 0; k < 3; k++) {
                const uint32_t bits = get_uint32(facet + NORMAL_SIZE + 12 * v + 4 * k);
                float single;
                memcpy(&single, &bits, sizeof single);
                position[k] = (double)single;
            }
            done = done && polygon_mesh_add_vertex(mesh, position);
        }
        done = done && polygon_mesh_add_face(mesh, corners, 3);
    }
    return done || fail_memory(reader);
}

bool stl_read_knows(const char *data, size_t size)
{
    const size_t mark = file_bytes_mark(data, size);
    data += mark, size -= mark;
    while (is_blank(*data)) data++, size--;
    return size > 5 && is_word(data, 5, "solid") && is_blank(data[5]);
}

/* A binary file may begin with the word solid, too, but has zeros soon, or the size it says. */
static bool is_text(const char *data, size_t size)
{
    if (size >= HEADER_SIZE && (size - HEADER_SIZE) % FACET_SIZE == 0 &&
        (size - HEADER_SIZE) / FACET_SIZE == get_uint32(data + HEADER_SIZE - 4))
        return false;
    return stl_read_knows(data, size) && !memchr(data, '\0', size < 1024 ? size : 1024);
}

bool stl_read(polygon_mesh *mesh, const char *path, const char *data, size_t size, char *error,
              size_t error_size)
{
    stl_reader reader = {path, data, 1, error, error_size, mesh, 0};
    bool done = polygon_mesh_init(mesh) || fail_memory(&reader);
    if (done && is_text(data, size)) {
        reader.at += file_bytes_mark(data, size);
        done = read_text(&reader, data + size);
    } else {
        done = done && read_binary(&reader, size);
    }
    if (!done) polygon_mesh_free(mesh);
    return done;
}
