/*
 * Reads PLY files; see ply_mesh.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "ply_mesh.h"

#include <ctype.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Types of numbers. */
enum { PLY_INTEGER, PLY_UNSIGNED, PLY_REAL };

typedef struct ply_type {
    const char *name;
    uint8_t kind;
    uint8_t size; /* bytes, in binary */
} ply_type;

static const ply_type ply_types[] = {
    {"char", PLY_INTEGER, 1},    {"int8", PLY_INTEGER, 1},    {"uchar", PLY_UNSIGNED, 1},
    {"uint8", PLY_UNSIGNED, 1},  {"short", PLY_INTEGER, 2},   {"int16", PLY_INTEGER, 2},
    {"ushort", PLY_UNSIGNED, 2}, {"uint16", PLY_UNSIGNED, 2}, {"int", PLY_INTEGER, 4},
    {"int32", PLY_INTEGER, 4},   {"uint", PLY_UNSIGNED, 4},   {"uint32", PLY_UNSIGNED, 4},
    {"float", PLY_REAL, 4},      {"float32", PLY_REAL, 4},    {"double", PLY_REAL, 8},
    {"float64", PLY_REAL, 8},
};

/* What a property is read for: the coordinate of this number, corners, or nothing. */
enum { ROLE_CORNERS = 3, ROLE_NONE = 4 };

typedef struct ply_property {
    const ply_type *count_type; /* of a list; NULL: a single number */
    const ply_type *type;
    int role;
} ply_property;

/* An element of the header. */
enum { ELEMENT_VERTEX, ELEMENT_FACE, ELEMENT_STRIP, ELEMENT_OTHER };

typedef struct ply_element {
    int what;
    bool has[ROLE_NONE]; /* roles that were given to a property */
    size_t count;
    size_t first, end; /* its properties */
} ply_element;

/* A file being read. */
typedef struct ply_reader {
    const char *path;
    char *at, *end; /* what is not yet read; a 0 stands at the end */
    unsigned long line;
    bool lone_cr; /* lines end in CR: an LF behind one is data */
    bool binary, swapped;
    bool has_vertices;
    ply_element *elements;
    ply_property *properties;
    size_t element_count, property_count;
    char *error;
    size_t error_size;
    polygon_mesh *mesh;
} ply_reader;

/* In the header and in text, with the number of the line. */
static bool fail(ply_reader *reader, const char *reason)
{
    snprintf(reader->error, reader->error_size, "%s: line %lu: %s", reader->path, reader->line,
             reason);
    return false;
}

static const char out_of_memory[] = "out of memory";
static const char cut_short[] = "a number is missing; is the file truncated?";

static bool is_space(char c)
{
    return c == ' ' || c == '\t' || c == '\v' || c == '\f';
}

/* The next line, ended by a 0; NULL at the end. Lines end in LF, CR or both. */
static char *next_line(ply_reader *reader)
{
    char *const line = reader->at;
    if (line == reader->end) return NULL;
    char *at = line;
    while (at != reader->end && *at != '\n' && *at != '\r') at++;
    reader->at = at;
    const bool pair = at[0] == '\r' && at[1] == '\n' && !reader->lone_cr;
    if (reader->line == 0) reader->lone_cr = at[0] == '\r' && !pair;
    if (at != reader->end) reader->at += pair ? 2 : 1;
    *at = 0;
    reader->line++;
    return line;
}

/* The next word of a line, which moves behind it, ended by a 0; empty at the end. */
static char *next_word(char **line)
{
    char *word = *line;
    while (is_space(*word)) word++;
    char *end = word;
    while (*end && !is_space(*end)) end++;
    *line = *end ? end + 1 : end;
    *end = 0;
    return word;
}

static const ply_type *find_type(const char *name)
{
    for (size_t i = 0; i < sizeof ply_types / sizeof *ply_types; i++) {
        if (strcmp(name, ply_types[i].name) == 0) return &ply_types[i];
    }
    return NULL;
}

/* ---- the header ---- */

/* Room for one more in an array, which is doubled when its length is a power of two. */
static void *one_more(void *array, size_t count, size_t size)
{
    if (count & (count - 1)) return array;
    return realloc(array, (count ? 2 * count : 1) * size);
}

static bool read_format(ply_reader *reader, char *line)
{
    const uint16_t one = 1;
    uint8_t low;
    memcpy(&low, &one, 1);
    const char *format = next_word(&line);
    if (strcmp(format, "ascii") == 0) return true;
    reader->binary = true;
    reader->swapped = strcmp(format, low ? "binary_big_endian" : "binary_little_endian") == 0;
    if (reader->swapped || strcmp(format, low ? "binary_little_endian" : "binary_big_endian") == 0)
        return true;
    return fail(reader, "the format is none of ascii, binary_little_endian, binary_big_endian");
}

static bool read_element(ply_reader *reader, char *line)
{
    ply_element element;
    memset(&element, 0, sizeof element);
    const char *name = next_word(&line);
    const char *number = next_word(&line);
    char *end;
    errno = 0;
    const unsigned long long count = strtoull(number, &end, 10);
    if (!isdigit((unsigned char)*number) || *end || errno || count >= UINT32_MAX) {
        return fail(reader, "an element needs a name and a number from 0 to 4294967294");
    }
    element.count = (size_t)count;
    element.what = strcmp(name, "vertex") == 0      ? ELEMENT_VERTEX
                   : strcmp(name, "face") == 0      ? ELEMENT_FACE
                   : strcmp(name, "tristrips") == 0 ? ELEMENT_STRIP
                                                    : ELEMENT_OTHER;
    if (element.what == ELEMENT_VERTEX && reader->has_vertices) {
        return fail(reader, "there are vertices already");
    }
    if (element.what == ELEMENT_VERTEX) reader->has_vertices = true;
    element.first = element.end = reader->property_count;
    void *array = one_more(reader->elements, reader->element_count, sizeof element);
    if (!array) return fail(reader, out_of_memory);
    reader->elements = (ply_element *)array;
    reader->elements[reader->element_count++] = element;
    return true;
}

/* What a property of an element is read for. */
static int find_role(const ply_element *element, const char *name, bool is_list)
{
    if (element->what == ELEMENT_VERTEX) {
        const bool is_coordinate = !is_list && *name >= 'x' && *name <= 'z' && !name[1];
        return is_coordinate ? *name - 'x' : ROLE_NONE;
    }
    const bool is_corners =
        element->what != ELEMENT_OTHER && is_list &&
        (strcmp(name, "vertex_indices") == 0 || strcmp(name, "vertex_index") == 0);
    return is_corners ? ROLE_CORNERS : ROLE_NONE;
}

static bool read_property(ply_reader *reader, char *line)
{
    if (reader->element_count == 0) return fail(reader, "a property before the first element");
    ply_element *element = &reader->elements[reader->element_count - 1];
    ply_property property = {NULL, NULL, ROLE_NONE};
    const char *type = next_word(&line);
    const bool is_list = strcmp(type, "list") == 0;
    if (is_list) {
        property.count_type = find_type(next_word(&line));
        type = next_word(&line);
    }
    property.type = find_type(type);
    if (!property.type || (is_list && !property.count_type)) {
        return fail(reader, "a property of a type that PLY does not have");
    }
    if (is_list && property.count_type->kind == PLY_REAL) {
        return fail(reader, "the length of a list is to be an integer");
    }
    property.role = find_role(element, next_word(&line), is_list);
    if (property.role != ROLE_NONE && element->has[property.role]) {
        return fail(reader, "the element has that property already");
    }
    if (property.role != ROLE_NONE) element->has[property.role] = true;
    void *array = one_more(reader->properties, reader->property_count, sizeof property);
    if (!array) return fail(reader, out_of_memory);
    reader->properties = (ply_property *)array;
    reader->properties[reader->property_count++] = property;
    element->end = reader->property_count;
    return true;
}

/* Reads all up to the line end_header. */
static bool read_header(ply_reader *reader)
{
    bool has_format = false;
    char *line = next_line(reader);
    const char *word = line ? next_word(&line) : "";
    if (strcmp(word, "ply") != 0 && strcmp(word, "PLY") != 0) {
        return fail(reader, "the word ply is expected here");
    }
    while ((line = next_line(reader)) != NULL) {
        bool good = true;
        word = next_word(&line);
        if (strcmp(word, "end_header") == 0) {
            return has_format ? true : fail(reader, "a header without a format");
        } else if (strcmp(word, "format") == 0) {
            good =
                has_format ? fail(reader, "there is a format already") : read_format(reader, line);
            has_format = true;
        } else if (strcmp(word, "element") == 0) {
            good = read_element(reader, line);
        } else if (strcmp(word, "property") == 0) {
            good = read_property(reader, line);
        } else if (*word && strcmp(word, "comment") != 0 && strcmp(word, "obj_info") != 0) {
            good = fail(reader, "not a line of a PLY header");
        }
        if (!good && reader->at != reader->end) return false;
        if (!good) break; /* cut within the line */
    }
    snprintf(reader->error, reader->error_size,
             "%s: the header does not end; is the file truncated?", reader->path);
    return false;
}

/* ---- the data ---- */

static bool read_binary_number(ply_reader *reader, const ply_type *type, double *value)
{
    uint8_t bytes[8];
    if ((size_t)(reader->end - reader->at) < type->size) return false;
    memcpy(bytes, reader->at, type->size);
    reader->at += type->size;
    for (int i = 0, k = type->size - 1; reader->swapped && i < k; i++, k--) {
        const uint8_t byte = bytes[i];
        bytes[i] = bytes[k];
        bytes[k] = byte;
    }
    if (type->kind == PLY_REAL && type->size == 8) {
        memcpy(value, bytes, 8);
    } else if (type->kind == PLY_REAL) {
        float number;
        memcpy(&number, bytes, 4);
        *value = (double)number;
    } else if (type->size == 4) {
        uint32_t number;
        memcpy(&number, bytes, 4);
        *value = type->kind == PLY_UNSIGNED ? (double)number : (double)(int32_t)number;
    } else if (type->size == 2) {
        uint16_t number;
        memcpy(&number, bytes, 2);
        *value = type->kind == PLY_UNSIGNED ? (double)number : (double)(int16_t)number;
    } else {
        *value = type->kind == PLY_UNSIGNED ? (double)bytes[0] : (double)(int8_t)bytes[0];
    }
    return true;
}

/* Reads a number, of line in text, which moves behind it; rounded to float if it becomes one. */
static bool read_number(ply_reader *reader, char **line, const ply_type *type, bool to_float,
                        double *value)
{
    char *end;
    if (reader->binary) return read_binary_number(reader, type, value);
    *value = to_float ? (double)strtof(*line, &end) : strtod(*line, &end);
    if (end == *line || (*end && !is_space(*end))) return false;
    *line = end;
    return true;
}

/* A strip of triangles: one for each corner from the third, every other one turned round. */
typedef struct ply_strip {
    uint32_t last[2];
    size_t length;
} ply_strip;

static bool add_to_strip(ply_reader *reader, ply_strip *strip, uint32_t vertex)
{
    const size_t odd = strip->length & 1;
    if (strip->length >= 2 && !(polygon_mesh_add_corner(reader->mesh, 0, strip->last[odd]) &&
                                polygon_mesh_add_corner(reader->mesh, 1, strip->last[1 - odd]) &&
                                polygon_mesh_add_corner(reader->mesh, 2, vertex) &&
                                polygon_mesh_end_face(reader->mesh, 3)))
        return false;
    strip->last[0] = strip->last[1];
    strip->last[1] = vertex;
    strip->length++;
    return true;
}

/* Reads the corners of a face or strip; NULL or what is wrong. */
static const char *read_corners(ply_reader *reader, char **line, const ply_element *element,
                                const ply_property *property, size_t count)
{
    const bool is_strip = element->what == ELEMENT_STRIP;
    ply_strip strip = {{0, 0}, 0};
    for (size_t k = 0; k < count; k++) {
        double value;
        if (!read_number(reader, line, property->type, false, &value)) return cut_short;
        if (is_strip && value == -1.0) {
            strip.length = 0;
            continue;
        }
        const uint32_t vertex =
            value >= 0.0 && value < (double)UINT32_MAX ? (uint32_t)value : UINT32_MAX;
        if ((double)vertex != value) return "a face names a vertex that does not exist";
        if (is_strip ? !add_to_strip(reader, &strip, vertex)
                     : !polygon_mesh_add_corner(reader->mesh, k, vertex))
            return out_of_memory;
    }
    return is_strip || polygon_mesh_end_face(reader->mesh, count) ? NULL : out_of_memory;
}

/* Reads a vertex, a face or whatever the element is; NULL or what is wrong. */
static const char *read_one(ply_reader *reader, const ply_element *element)
{
    float position[3] = {0.0f, 0.0f, 0.0f};
    char *line = NULL;
    while (!reader->binary && (!line || !*line)) {
        line = next_line(reader);
        if (!line) return cut_short;
        while (is_space(*line)) line++;
    }
    for (size_t p = element->first; p < element->end; p++) {
        const ply_property *property = &reader->properties[p];
        const bool is_position = property->role < ROLE_CORNERS;
        double count = 1.0, value;
        if (property->count_type &&
            !read_number(reader, &line, property->count_type, false, &count))
            return cut_short;
        if (!(count >= 0.0 && count < (double)UINT32_MAX) || count != (double)(size_t)count) {
            return "the length of a list is not a number that it can be";
        }
        if (property->role == ROLE_CORNERS) {
            const char *reason = read_corners(reader, &line, element, property, (size_t)count);
            if (reason) return reason;
            continue;
        }
        for (size_t k = 0; k < (size_t)count; k++) {
            if (!read_number(reader, &line, property->type, is_position, &value)) return cut_short;
            if (is_position) position[property->role] = (float)value;
        }
    }
    if (element->what != ELEMENT_VERTEX) return NULL;
    return polygon_mesh_add_vertex(reader->mesh, position) ? NULL : out_of_memory;
}

static bool read_data(ply_reader *reader)
{
    static const char *const names[] = {"vertex", "face", "triangle strip", "element"};
    for (size_t e = 0; e < reader->element_count; e++) {
        const ply_element *element = &reader->elements[e];
        if (element->what == ELEMENT_VERTEX &&
            !(element->has[0] && element->has[1] && element->has[2]))
            return fail(reader, "the header has vertices without x, y or z");
        if (element->first == element->end) continue; /* nothing of it is in the file */
        for (size_t i = 0; i < element->count; i++) {
            const char *reason = read_one(reader, element);
            if (reason && !reader->binary) return fail(reader, reason);
            if (!reason) continue;
            snprintf(reader->error, reader->error_size, "%s: %s %lu: %s", reader->path,
                     names[element->what], (unsigned long)i, reason);
            return false;
        }
    }
    return polygon_mesh_check(reader->mesh, reader->path, reader->error, reader->error_size);
}

bool ply_mesh_knows(const char *path)
{
    static const char word[3] = {'p', 'l', 'y'};
    const size_t length = strlen(path);
    char begin[4] = {0};
    bool is_named = length >= 4 && path[length - 4] == '.';
    for (size_t k = 0; is_named && k < 3; k++) {
        is_named = tolower((unsigned char)path[length - 3 + k]) == word[k];
    }
    if (is_named) return true;
    /* What assimp, too, would take for a PLY file, whatever its name. */
    FILE *file = fopen(path, "rb");
    if (!file) return false;
    int c = fgetc(file);
    while (c == '\n' || c == '\r' || c == '\f' || c == 0) c = fgetc(file);
    for (size_t k = 0; k < sizeof begin && c != EOF; k++, c = fgetc(file)) begin[k] = (char)c;
    fclose(file);
    for (size_t k = 0; k < 3; k++) {
        if (tolower((unsigned char)begin[k]) != word[k]) return false;
    }
    return begin[3] == 0 || is_space(begin[3]) || begin[3] == '\n' || begin[3] == '\r';
}

bool ply_mesh_read(polygon_mesh *mesh, const char *path, char *error, size_t error_size)
{
    ply_reader reader;
    size_t size;
    memset(mesh, 0, sizeof *mesh);
    memset(&reader, 0, sizeof reader);
    char *const text = polygon_mesh_load(path, &size, error, error_size);
    if (!text) return false;
    reader.path = path;
    reader.at = text;
    reader.end = text + size;
    reader.error = error;
    reader.error_size = error_size;
    reader.mesh = mesh;
    const bool done = read_header(&reader) && read_data(&reader);
    free(reader.elements);
    free(reader.properties);
    free(text);
    if (!done) polygon_mesh_free(mesh);
    return done;
}
