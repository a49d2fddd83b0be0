/*
 * Reads PLY files; see ply_read.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "ply_read.h"

#include "file_bytes.h"

#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Bytes of a header at most, and characters of a line that are looked at; comments may be longer */
enum { HEADER_MAX = 1 << 20, LINE_SEEN = 128 };

typedef enum ply_format { PLY_NO_FORMAT, PLY_TEXT, PLY_LITTLE, PLY_BIG } ply_format;

typedef enum ply_type {
    PLY_INT8,
    PLY_UINT8,
    PLY_INT16,
    PLY_UINT16,
    PLY_INT32,
    PLY_UINT32,
    PLY_FLOAT,
    PLY_DOUBLE,
    PLY_TYPES
} ply_type;

static const char *const type_names[2][PLY_TYPES] = {
    {"char", "uchar", "short", "ushort", "int", "uint", "float", "double"},
    {"int8", "uint8", "int16", "uint16", "int32", "uint32", "float32", "float64"}};

static const size_t type_sizes[PLY_TYPES] = {1, 1, 2, 2, 4, 4, 4, 8};

/* What a property is for: one of the three coordinates from 0 on, or one of these. */
typedef enum ply_role { PLY_CORNERS = 3, PLY_STRIPS, PLY_SKIPPED } ply_role;

typedef struct ply_property {
    bool is_list;
    ply_type count_type; /* of a list */
    ply_type type;
    int role;
} ply_property;

typedef enum ply_kind { PLY_OTHER, PLY_VERTICES, PLY_FACES, PLY_TRISTRIPS } ply_kind;

typedef struct ply_element {
    ply_kind kind;
    uint64_t count;
    size_t first_property, property_count;
} ply_element;

typedef struct ply_reader {
    const char *path, *begin, *at, *end;
    char *error;
    size_t error_size;
    ply_format format;
    ply_element *elements;
    ply_property *properties;
    size_t element_count, property_count, element_room, property_room;
    uint64_t vertex_count;
    polygon_mesh *mesh;
} ply_reader;

static bool fail(ply_reader *reader, const char *format, ...)
#if defined(__GNUC__)
    __attribute__((format(printf, 2, 3)))
#endif
    ;

static bool fail(ply_reader *reader, const char *format, ...)
{
    char reason[512];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(reason, sizeof reason, format, arguments);
    va_end(arguments);
    snprintf(reader->error, reader->error_size, "%s: %s", reader->path, reason);
    return false;
}

static bool fail_memory(ply_reader *reader)
{
    return fail(reader, "out of memory");
}

/* ------------------------------------------------------------------------------------------------
 * The header
 */

/* How lines of the header end, as the first one shows. */
static bool ends_in_two(const ply_reader *reader)
{
    const char *at = reader->begin;
    while (at < reader->end && *at != '\n' && *at != '\r') at++;
    return at + 1 < reader->end && at[0] == '\r' && at[1] == '\n';
}

static bool ends_in_cr(const ply_reader *reader)
{
    const char *at = reader->begin;
    while (at < reader->end && *at != '\n' && *at != '\r') at++;
    return at < reader->end && *at == '\r' && !ends_in_two(reader);
}

/* Takes a line and keeps its beginning; false where the header does not end. */
static bool take_line(ply_reader *reader, char line[LINE_SEEN])
{
    const char *begin = reader->at;
    const char *limit = reader->end;
    if ((size_t)(limit - reader->begin) > HEADER_MAX) limit = reader->begin + HEADER_MAX;
    const char *at = begin;
    while (at < limit && *at != '\n' && *at != '\r') at++;
    if (at >= limit) {
        return fail(reader, "the header does not end within a megabyte; is the file truncated?");
    }
    const size_t length = (size_t)(at - begin);
    const size_t kept = length < LINE_SEEN ? length : LINE_SEEN - 1;
    memcpy(line, begin, kept);
    line[kept] = '\0';
    /* Where lines end in CR alone, an LF behind the last one is data. */
    reader->at = at + 1;
    if (*at == '\r' && reader->at < reader->end && *reader->at == '\n' && !ends_in_cr(reader))
        reader->at++;
    return true;
}

static bool find_type(const char *word, ply_type *type)
{
    for (int t = 0; t < PLY_TYPES; t++) {
        if (strcmp(word, type_names[0][t]) != 0 && strcmp(word, type_names[1][t]) != 0) continue;
        *type = (ply_type)t;
        return true;
    }
    return false;
}

/* A whole number that is at most the size of the file: an element takes a byte at least. */
static bool find_count(const ply_reader *reader, const char *word, uint64_t *count)
{
    char *end;
    errno = 0;
    *count = strtoull(word, &end, 10);
    return *word >= '0' && *word <= '9' && *end == '\0' && errno == 0 &&
           *count <= (uint64_t)(reader->end - reader->begin);
}

static bool add_element(ply_reader *reader, const char *name, const char *number)
{
    static const char *const names[] = {"", "vertex", "face", "tristrips"};
    ply_element element;
    memset(&element, 0, sizeof element);
    element.first_property = reader->property_count;
    for (int kind = PLY_VERTICES; kind <= PLY_TRISTRIPS; kind++) {
        if (strcmp(name, names[kind]) == 0) element.kind = (ply_kind)kind;
    }
    if (!find_count(reader, number, &element.count)) {
        return fail(reader, "its header has an element without a number that the file can hold; "
                            "is it truncated?");
    }
    for (size_t i = 0; i < reader->element_count && element.kind != PLY_OTHER; i++) {
        if (reader->elements[i].kind == element.kind)
            return fail(reader, "its header has vertices or faces twice");
    }
    if (element.kind == PLY_VERTICES) reader->vertex_count = element.count;
    if (reader->element_count == reader->element_room) {
        const size_t room = reader->element_room ? 2 * reader->element_room : 8;
        ply_element *grown = (ply_element *)realloc(reader->elements, room * sizeof *grown);
        if (!grown) return fail_memory(reader);
        reader->elements = grown;
        reader->element_room = room;
    }
    reader->elements[reader->element_count++] = element;
    return true;
}

/* What a property of that name is for. */
static int find_role(ply_kind kind, const char *name, bool is_list)
{
    if (kind == PLY_VERTICES && name[0] >= 'x' && name[0] <= 'z' && !name[1] && !is_list)
        return name[0] - 'x';
    const bool is_corners =
        is_list && (strcmp(name, "vertex_indices") == 0 || strcmp(name, "vertex_index") == 0);
    if (kind == PLY_FACES && is_corners) return PLY_CORNERS;
    if (kind == PLY_TRISTRIPS && is_corners) return PLY_STRIPS;
    return PLY_SKIPPED;
}

static bool add_property(ply_reader *reader, char words[5][LINE_SEEN])
{
    ply_property property;
    memset(&property, 0, sizeof property);
    property.is_list = strcmp(words[1], "list") == 0;
    const bool known = property.is_list ? find_type(words[2], &property.count_type) &&
                                              find_type(words[3], &property.type)
                                        : find_type(words[1], &property.type);
    if (!known) return fail(reader, "its header has a property of an unknown type");
    if (reader->element_count == 0)
        return fail(reader, "its header has a property before any element");
    ply_element *element = &reader->elements[reader->element_count - 1];
    property.role = find_role(element->kind, words[property.is_list ? 4 : 2], property.is_list);
    for (size_t i = 0; i < element->property_count && property.role != PLY_SKIPPED; i++) {
        if (reader->properties[element->first_property + i].role == property.role)
            return fail(reader, "its header has a property twice");
    }
    if (reader->property_count == reader->property_room) {
        const size_t room = reader->property_room ? 2 * reader->property_room : 16;
        ply_property *grown = (ply_property *)realloc(reader->properties, room * sizeof *grown);
        if (!grown) return fail_memory(reader);
        reader->properties = grown;
        reader->property_room = room;
    }
    reader->properties[reader->property_count++] = property;
    element->property_count++;
    return true;
}

static bool set_format(ply_reader *reader, const char *word, const char *version)
{
    static const char *const names[] = {"", "ascii", "binary_little_endian", "binary_big_endian"};
    for (int format = PLY_TEXT; format <= PLY_BIG; format++) {
        if (strcmp(word, names[format]) == 0) reader->format = (ply_format)format;
    }
    if (reader->format == PLY_NO_FORMAT || strcmp(version, "1.0") != 0)
        return fail(reader, "its header has an unknown format, '%.60s %.60s'", word, version);
    return true;
}

/* Whether an element has all of the roles first to last. */
static bool has_roles(const ply_reader *reader, const ply_element *element, int first, int last)
{
    int found = 0;
    for (size_t i = 0; i < element->property_count; i++) {
        const int role = reader->properties[element->first_property + i].role;
        found += role >= first && role <= last;
    }
    return found == last - first + 1;
}

static bool check_elements(ply_reader *reader)
{
    bool has_faces = false;
    if (reader->format == PLY_NO_FORMAT) return fail(reader, "its header has no format");
    for (size_t i = 0; i < reader->element_count; i++) {
        const ply_element *element = &reader->elements[i];
        has_faces |= element->kind >= PLY_FACES && element->count > 0;
        if (element->kind == PLY_VERTICES && !has_roles(reader, element, 0, 2))
            return fail(reader, "its vertices have no x, y and z");
        if ((element->kind == PLY_FACES && !has_roles(reader, element, PLY_CORNERS, PLY_CORNERS)) ||
            (element->kind == PLY_TRISTRIPS && !has_roles(reader, element, PLY_STRIPS, PLY_STRIPS)))
            return fail(reader, "its faces have no list vertex_indices or vertex_index");
    }
    if (reader->vertex_count > UINT32_MAX - 2) return fail(reader, "too many vertices");
    if (!has_faces) return fail(reader, "no triangles in it");
    return true;
}

static bool read_header(ply_reader *reader)
{
    char line[LINE_SEEN], words[5][LINE_SEEN];
    if (!take_line(reader, line)) return false;
    if (strncmp(line, "ply", 3) != 0 || line[3 + strspn(line + 3, " \t")])
        return fail(reader, "a PLY file begins with a line ply and nothing else");
    while (take_line(reader, line)) {
        for (int w = 0; w < 5; w++) words[w][0] = '\0';
        sscanf(line, "%127s %127s %127s %127s %127s", words[0], words[1], words[2], words[3],
               words[4]);
        bool done = true;
        if (strcmp(words[0], "end_header") == 0) return check_elements(reader);
        if (strcmp(words[0], "format") == 0) done = set_format(reader, words[1], words[2]);
        if (strcmp(words[0], "element") == 0) done = add_element(reader, words[1], words[2]);
        if (strcmp(words[0], "property") == 0) done = add_property(reader, words);
        if (!done) return false;
    }
    return false;
}

/* ------------------------------------------------------------------------------------------------
 * Data
 */

static bool fail_end(ply_reader *reader)
{
    return fail(reader, "the file ends before all vertices and faces are there; is it truncated?");
}

static bool is_blank(char c)
{
    return c == ' ' || (c >= '\t' && c <= '\r');
}

static bool fail_text(ply_reader *reader, const char *what)
{
    unsigned long line = 1;
    int length = 0;
    for (const char *c = reader->begin; c < reader->at; c++) {
        line += *c == '\n' || (*c == '\r' && c[1] != '\n');
    }
    while (reader->at[length] && !is_blank(reader->at[length])) length++;
    return fail(reader, "line %lu: %.*s %s", line, length > 40 ? 40 : length, reader->at, what);
}

/* The next number of a text file. */
static bool take_text(ply_reader *reader, double *value)
{
    while (is_blank(*reader->at)) reader->at++;
    if (reader->at >= reader->end) return fail_end(reader);
    /* A short row of digits is the most frequent. */
    const char *at = reader->at;
    uint32_t digits = 0;
    while (*at >= '0' && *at <= '9' && at - reader->at < 9)
        digits = 10 * digits + (uint32_t)(*at++ - '0');
    if (at > reader->at && (is_blank(*at) || at == reader->end)) {
        *value = digits;
        reader->at = at;
        return true;
    }
    char *end;
    errno = 0;
    *value = strtod(reader->at, &end);
    if (end == reader->at || (!is_blank(*end) && end != reader->end))
        return fail_text(reader, "is not a number; it cannot be read");
    if (errno == ERANGE && fabs(*value) > 1.0)
        return fail_text(reader, "is too large for a double");
    reader->at = end;
    return true;
}

/* The number that size bytes are, the highest byte first or last. */
static uint64_t take_bits(ply_reader *reader, size_t size)
{
    const unsigned char *bytes = (const unsigned char *)reader->at;
    uint64_t bits = 0;
    for (size_t i = 0; i < size; i++) {
        const size_t byte = reader->format == PLY_BIG ? i : size - 1 - i;
        bits = bits << 8 | bytes[byte];
    }
    reader->at += size;
    return bits;
}

/* The next number. */
static bool take(ply_reader *reader, ply_type type, double *value)
{
    if (reader->format == PLY_TEXT) return take_text(reader, value);
    const size_t size = type_sizes[type];
    if ((size_t)(reader->end - reader->at) < size) return fail_end(reader);
    const uint64_t bits = take_bits(reader, size);
    if (type == PLY_FLOAT) {
        const uint32_t low = (uint32_t)bits;
        float single;
        memcpy(&single, &low, sizeof single);
        *value = (double)single;
    } else if (type == PLY_DOUBLE) {
        memcpy(value, &bits, sizeof *value);
    } else {
        /* negative ones are those with the highest bit, and as much less than their bits say */
        const bool negative =
            (type == PLY_INT8 || type == PLY_INT16 || type == PLY_INT32) && bits >> (8 * size - 1);
        *value = (double)bits - (negative ? ldexp(1.0, 8 * (int)size) : 0.0);
    }
    return true;
}

/* How many numbers a list has, which the rest of the file can hold. */
static bool take_length(ply_reader *reader, const ply_property *property, uint64_t *length)
{
    double value;
    if (!take(reader, property->count_type, &value)) return false;
    const size_t size = reader->format == PLY_TEXT ? 2 : type_sizes[property->type];
    const double most = (double)(reader->end - reader->at + 1) / (double)size;
    if (!(value >= 0.0 && value <= most && value == floor(value)))
        return fail(
            reader,
            "a list of %.10g numbers cannot be read: the file has no such; is it truncated?",
            value);
    *length = (uint64_t)value;
    return true;
}

/* One of a list of vertices. */
static bool take_vertex(ply_reader *reader, ply_type type, double *vertex)
{
    if (!take(reader, type, vertex)) return false;
    if (*vertex >= 0.0 && *vertex < (double)reader->vertex_count && *vertex == floor(*vertex))
        return true;
    return fail(reader, "face %lu names vertex %.10g, the file has %lu",
                (unsigned long)reader->mesh->face_count, *vertex,
                (unsigned long)reader->vertex_count);
}

static bool read_face(ply_reader *reader, const ply_property *property)
{
    uint64_t length;
    if (!take_length(reader, property, &length)) return false;
    for (uint64_t k = 0; k < length; k++) {
        double vertex;
        if (!take_vertex(reader, property->type, &vertex)) return false;
        if (!polygon_mesh_add_corner(reader->mesh, (size_t)k, (uint32_t)vertex))
            return fail_memory(reader);
    }
    return polygon_mesh_end_face(reader->mesh, (size_t)length) || fail_memory(reader);
}

/* A strip of triangles, each a face; every other is turned round. -1 begins another strip. */
static bool read_strip(ply_reader *reader, const ply_property *property)
{
    uint64_t length;
    uint32_t last[3] = {0, 0, 0};
    if (!take_length(reader, property, &length)) return false;
    for (uint64_t k = 0, run = 0; k < length; k++) {
        const char *const before = reader->at;
        double vertex;
        if (!take(reader, property->type, &vertex)) return false;
        if (vertex == -1.0) {
            run = 0;
            continue;
        }
        reader->at = before;
        if (!take_vertex(reader, property->type, &vertex)) return false;
        last[0] = last[1];
        last[1] = last[2];
        last[2] = (uint32_t)vertex;
        if (++run < 3) continue;
        const uint32_t corners[3] = {last[run % 2 ? 0 : 1], last[run % 2 ? 1 : 0], last[2]};
        if (!polygon_mesh_add_face(reader->mesh, corners, 3)) return fail_memory(reader);
    }
    return true;
}

static bool skip_list(ply_reader *reader, const ply_property *property)
{
    uint64_t length;
    double ignored;
    if (!take_length(reader, property, &length)) return false;
    for (uint64_t k = 0; k < length; k++) {
        if (!take(reader, property->type, &ignored)) return false;
    }
    return true;
}

static bool read_element(ply_reader *reader, const ply_element *element)
{
    const ply_property *properties = reader->properties + element->first_property;
    double position[3];
    for (size_t i = 0; i < element->property_count; i++) {
        const ply_property *property = &properties[i];
        double ignored;
        bool done;
        if (property->role == PLY_CORNERS)
            done = read_face(reader, property);
        else if (property->role == PLY_STRIPS)
            done = read_strip(reader, property);
        else if (property->is_list)
            done = skip_list(reader, property);
        else
            done = take(reader, property->type,
                        property->role < 3 ? &position[property->role] : &ignored);
        if (!done) return false;
    }
    return element->kind != PLY_VERTICES || polygon_mesh_add_vertex(reader->mesh, position) ||
           fail_memory(reader);
}

/* The 32 bits at a place of a binary file. */
static uint32_t word_at(const ply_reader *reader, const char *at)
{
    const unsigned char *b = (const unsigned char *)at;
    return reader->format == PLY_BIG
               ? (uint32_t)b[0] << 24 | (uint32_t)b[1] << 16 | (uint32_t)b[2] << 8 | b[3]
               : (uint32_t)b[3] << 24 | (uint32_t)b[2] << 16 | (uint32_t)b[1] << 8 | b[0];
}

/* The same as read_element for the first vertices of a binary file, as far as they are there, if x,
   y and z are floats and nothing is a list. Adds to *count how many were read. */
static bool read_float_vertices(ply_reader *reader, const ply_element *element, uint64_t *count)
{
    const ply_property *properties = reader->properties + element->first_property;
    size_t offsets[3] = {0, 0, 0}, size = 0;
    if (reader->format == PLY_TEXT || element->kind != PLY_VERTICES) return true;
    for (size_t i = 0; i < element->property_count; i++) {
        const ply_property *property = &properties[i];
        if (property->is_list || (property->role < 3 && property->type != PLY_FLOAT)) return true;
        if (property->role < 3) offsets[property->role] = size;
        size += type_sizes[property->type];
    }
    polygon_mesh *mesh = reader->mesh; /* has room for all */
    for (; *count < element->count && (size_t)(reader->end - reader->at) >= size; ++*count) {
        double *position = mesh->positions + 3 * mesh->vertex_count++;
        for (size_t k = 0; k < 3; k++) {
            const uint32_t bits = word_at(reader, reader->at + offsets[k]);
            float single;
            memcpy(&single, &bits, sizeof single);
            position[k] = (double)single;
        }
        reader->at += size;
    }
    return true;
}

/* The same as read_element for the first faces of a binary file, up to the first one that is no
   triangle or is not as it should be, if they are lists of 32-bit numbers with a byte for their
   length and nothing else. Adds to *count how many were read. */
static bool read_triangles(ply_reader *reader, const ply_element *element, uint64_t *count)
{
    const ply_property *property = reader->properties + element->first_property;
    const size_t size = 1 + 3 * 4;
    if (reader->format == PLY_TEXT || property->role != PLY_CORNERS ||
        element->property_count != 1 || type_sizes[property->count_type] != 1 ||
        (property->type != PLY_INT32 && property->type != PLY_UINT32) ||
        reader->vertex_count > INT32_MAX)
        return true;
    const size_t room = (size_t)(reader->end - reader->at) / size;
    const size_t wanted = element->count < room ? (size_t)element->count : room;
    polygon_mesh *mesh = reader->mesh;
    if (!polygon_mesh_reserve_faces(mesh, wanted) ||
        !polygon_mesh_reserve_corners(mesh, 3 * wanted))
        return fail_memory(reader);
    for (; *count < wanted && *reader->at == 3; ++*count) {
        const size_t used = mesh->offsets[mesh->face_count];
        uint32_t *corners = mesh->corners + used;
        bool known = true; /* negative numbers are larger than that of any vertex */
        for (size_t k = 0; k < 3; k++) {
            corners[k] = word_at(reader, reader->at + 1 + 4 * k);
            known &= corners[k] < reader->vertex_count;
        }
        if (!known) break;
        mesh->offsets[++mesh->face_count] = used + 3;
        reader->at += size;
    }
    return true;
}

static bool read_data(ply_reader *reader)
{
    for (size_t i = 0; i < reader->element_count; i++) {
        const ply_element *element = &reader->elements[i];
        if (element->property_count == 0) continue;
        /* An element takes a byte at least, so the size of the file limits this. */
        if (element->kind == PLY_VERTICES &&
            !polygon_mesh_reserve_vertices(reader->mesh, (size_t)element->count))
            return fail_memory(reader);
        uint64_t done = 0;
        if (!read_float_vertices(reader, element, &done) || !read_triangles(reader, element, &done))
            return false;
        for (; done < element->count; done++) {
            if (!read_element(reader, element)) return false;
        }
    }
    if (reader->format != PLY_TEXT) return true;
    while (is_blank(*reader->at)) reader->at++;
    return reader->at >= reader->end ||
           fail_text(reader, "stands behind all that the header says is there");
}

bool ply_read_knows(const char *data, size_t size)
{
    const size_t mark = file_bytes_mark(data, size);
    data += mark, size -= mark;
    return size > 3 && memcmp(data, "ply", 3) == 0 && (data[3] == '\n' || data[3] == '\r');
}

bool ply_read(polygon_mesh *mesh, const char *path, const char *data, size_t size, char *error,
              size_t error_size)
{
    ply_reader reader;
    memset(&reader, 0, sizeof reader);
    reader.path = path;
    reader.begin = reader.at = data + file_bytes_mark(data, size);
    reader.end = data + size;
    reader.error = error;
    reader.error_size = error_size;
    reader.mesh = mesh;
    const bool done = (polygon_mesh_init(mesh) || fail_memory(&reader)) && read_header(&reader) &&
                      read_data(&reader);
    free(reader.elements);
    free(reader.properties);
    if (!done) polygon_mesh_free(mesh);
    return done;
}
