/*
 * Reads OBJ and OFF files; see text_mesh.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "text_mesh.h"

#include "file_bytes.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A file being read, line by line. */
typedef struct text_reader {
    const char *path;
    char *next; /* the line after the present one */
    unsigned long line;
    char *error;
    size_t error_size;
    polygon_mesh *mesh;
} text_reader;

static bool fail(text_reader *reader, const char *reason)
{
    snprintf(reader->error, reader->error_size, "%s: line %lu: %s", reader->path, reader->line,
             reason);
    return false;
}

static bool is_space(char c)
{
    return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f';
}

static char *skip_space(char *at)
{
    while (is_space(*at)) at++;
    return at;
}

/* How many characters end a line here: LF, CR, or CR and LF. */
static size_t line_end(const char *at)
{
    return *at == '\n' ? 1 : *at != '\r' ? 0 : at[1] == '\n' ? 2 : 1;
}

/*
 * The next line with something on it, comments removed and ended by a 0; NULL at the end. A line of
 * an OBJ file that ends in a backslash goes on in the next.
 */
static char *next_line(text_reader *reader, bool continues)
{
    while (*reader->next) {
        char *const begin = reader->next;
        bool comment = false;
        char *at = begin;
        reader->line++;
        for (; *at && !line_end(at); at++) {
            if (*at == '#') comment = true;
            const size_t ending = continues && *at == '\\' ? line_end(at + 1) : 0;
            if (ending) {
                memset(at, ' ', ending + 1);
                reader->line++;
            }
            if (comment) *at = ' ';
        }
        reader->next = at + line_end(at);
        *at = 0;
        char *const content = skip_space(begin);
        if (*content) return content;
    }
    return NULL;
}

/* Says that a coordinate is larger than any double, with its text up to the next space. */
static bool fail_overflow(text_reader *reader, const char *at)
{
    at += strspn(at, " \t\r\v\f");
    snprintf(reader->error, reader->error_size,
             "%s: line %lu: vertex %lu: %.*s is too large for a double", reader->path, reader->line,
             (unsigned long)reader->mesh->vertex_count, (int)strcspn(at, " \t\r\v\f"), at);
    return false;
}

static bool add_vertex(text_reader *reader, char *at)
{
    double position[3];
    for (size_t k = 0; k < 3; k++) {
        char *end;
        errno = 0;
        position[k] = strtod(at, &end);
        if (end == at || (*end && !is_space(*end))) {
            return fail(reader, "a vertex needs three numbers");
        }
        if (errno == ERANGE && fabs(position[k]) > 1.0) return fail_overflow(reader, at);
        at = end;
    }
    if (reader->mesh->vertex_count >= UINT32_MAX - 1) return fail(reader, "too many vertices");
    if (!polygon_mesh_add_vertex(reader->mesh, position)) return fail(reader, "out of memory");
    return true;
}

static bool add_corner(text_reader *reader, size_t index, size_t vertex)
{
    if (!polygon_mesh_add_corner(reader->mesh, index, (uint32_t)vertex))
        return fail(reader, "out of memory");
    return true;
}

static bool end_face(text_reader *reader, size_t corner_count)
{
    if (reader->mesh->face_count >= UINT32_MAX - 1) return fail(reader, "too many faces");
    if (!polygon_mesh_end_face(reader->mesh, corner_count)) return fail(reader, "out of memory");
    return true;
}

/* The corners of an OBJ face: a, a/b, a//c or a/b/c each; negative counts back from the last. */
static bool read_obj_face(text_reader *reader, char *at)
{
    size_t count = 0;
    for (at = skip_space(at); *at; at = skip_space(at), count++) {
        char *end;
        const long long number = strtoll(at, &end, 10);
        const long long vertices = (long long)reader->mesh->vertex_count;
        if (end == at) return fail(reader, "a face's vertices must be numbers");
        if (number == 0 || number < -vertices) {
            return fail(reader, "a face names a vertex that does not exist");
        }
        const long long index = number > 0 ? number - 1 : vertices + number;
        if (index >= (long long)UINT32_MAX) {
            return fail(reader, "a face names a vertex that does not exist");
        }
        if (!add_corner(reader, count, (size_t)index)) return false;
        at = end;
        if (*at == '/') at += strspn(at, "/-0123456789");
        if (*at && !is_space(*at)) return fail(reader, "a face's vertices must be numbers");
    }
    if (count < 3) return fail(reader, "a face needs three vertices");
    return end_face(reader, count);
}

/* The name behind o or g, which may have spaces inside. */
static bool read_obj_name(text_reader *reader, char kind, char *at)
{
    at = skip_space(at);
    size_t length = strlen(at);
    while (length && is_space(at[length - 1])) length--;
    if (!polygon_mesh_mark(reader->mesh, kind, at, length)) return fail(reader, "out of memory");
    return true;
}

/* The objects, or the groups where they say more. */
static bool name_obj_parts(text_reader *reader)
{
    const size_t objects = polygon_mesh_marked(reader->mesh, 'o');
    const bool by_group = objects < 2 && polygon_mesh_marked(reader->mesh, 'g') > objects;
    if (!polygon_mesh_name_objects(reader->mesh, by_group ? 'g' : 'o', true))
        return fail(reader, "out of memory");
    return true;
}

static bool read_obj(text_reader *reader)
{
    for (char *at; (at = next_line(reader, true)) != NULL;) {
        const bool is_word = is_space(at[1]) || !at[1];
        if (at[0] == 'v' && is_space(at[1])) {
            if (!add_vertex(reader, at + 1)) return false;
        } else if (at[0] == 'f' && is_word) {
            if (!read_obj_face(reader, at + 1)) return false;
        } else if ((at[0] == 'o' || at[0] == 'g') && is_word) {
            if (!read_obj_name(reader, at[0], at + 1)) return false;
        }
    }
    /* A face may come before its vertices, so this is known only now. */
    const polygon_mesh *mesh = reader->mesh;
    const size_t bad = polygon_mesh_bad_face(mesh);
    if (bad < mesh->face_count) {
        size_t c = mesh->offsets[bad];
        while (mesh->corners[c] < mesh->vertex_count) c++;
        snprintf(reader->error, reader->error_size, "%s: a face names vertex %lu, the file has %lu",
                 reader->path, (unsigned long)mesh->corners[c] + 1,
                 (unsigned long)mesh->vertex_count);
        return false;
    }
    return name_obj_parts(reader);
}

/* A number without sign at the start of *at, which moves behind it. */
static bool read_count(char **at, size_t *count)
{
    char *const begin = skip_space(*at);
    if (*begin < '0' || *begin > '9') return false;
    errno = 0;
    const unsigned long long value = strtoull(begin, at, 10);
    if (errno || value >= UINT32_MAX || (**at && !is_space(**at))) return false;
    *count = (size_t)value;
    return true;
}

/* Skips the word OFF with its prefixes for colours, normals and texture coordinates. */
static bool skip_off_word(text_reader *reader, char **at)
{
    char *word = *at;
    if (*word >= '0' && *word <= '9' && strncmp(word, "4OFF", 4) != 0) return true; /* left out */
    if (strncmp(word, "ST", 2) == 0) word += 2;
    if (*word == 'C') word++;
    if (*word == 'N') word++;
    if (strncmp(word, "OFF", 3) != 0 || (word[3] && !is_space(word[3]))) {
        return fail(reader, "not an OFF file, or a kind of it that is not read");
    }
    *at = skip_space(word + 3);
    if (strncmp(*at, "BINARY", 6) == 0) return fail(reader, "binary OFF is not read");
    return true;
}

static bool read_off(text_reader *reader)
{
    static const char *const cut = "the file ends before all vertices and faces are there";
    size_t vertex_count, face_count;
    char *at = next_line(reader, false);
    if (!at) return fail(reader, "no OFF header");
    if (!skip_off_word(reader, &at)) return false;
    if (!*at) at = next_line(reader, false);
    if (!at || !read_count(&at, &vertex_count) || !read_count(&at, &face_count)) {
        return fail(reader, "the numbers of vertices and faces are expected here");
    }
    for (size_t v = 0; v < vertex_count; v++) {
        at = next_line(reader, false);
        if (!at) return fail(reader, cut);
        if (!add_vertex(reader, at)) return false;
    }
    for (size_t f = 0; f < face_count; f++) {
        size_t corner_count, index;
        at = next_line(reader, false);
        if (!at) return fail(reader, cut);
        if (!read_count(&at, &corner_count)) return fail(reader, "a number of corners is expected");
        for (size_t k = 0; k < corner_count; k++) {
            if (!read_count(&at, &index)) return fail(reader, "the face has too few vertices");
            if (index >= vertex_count) {
                return fail(reader, "a face names a vertex that does not exist");
            }
            if (!add_corner(reader, k, index)) return false;
        }
        if (!end_face(reader, corner_count)) return false;
    }
    if (next_line(reader, false)) return fail(reader, "the file goes on behind its last face");
    return true;
}

/* A 0 would end the text before the file does. */
static bool is_text(text_reader *reader, size_t size)
{
    const char *const zero = (const char *)memchr(reader->next, '\0', size);
    if (!zero) return true;
    reader->line = 1;
    for (const char *at = reader->next; at < zero; at++) {
        reader->line += *at == '\n' || (*at == '\r' && at[1] != '\n');
    }
    return fail(reader, "a byte of value 0: this is no text, or not in UTF-8");
}

bool text_mesh_read(polygon_mesh *mesh, const char *path, bool is_off, char *text, size_t size,
                    char *error, size_t error_size)
{
    const size_t mark = file_bytes_mark(text, size);
    text_reader reader = {path, text + mark, 0, error, error_size, mesh};
    if (!polygon_mesh_init(mesh)) {
        snprintf(error, error_size, "%s: out of memory", path);
        return false;
    }
    if (is_text(&reader, size - mark) && (is_off ? read_off(&reader) : read_obj(&reader)))
        return true;
    polygon_mesh_free(mesh);
    return false;
}
