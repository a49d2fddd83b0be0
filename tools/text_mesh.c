/*
 * Reads OBJ and OFF files; see text_mesh.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "text_mesh.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A file being read, line by line. */
typedef struct text_reader {
    const char *path;
    char *text; /* the whole file, with a 0 after it */
    char *next; /* the line after the present one */
    unsigned long line;
    char *error;
    size_t error_size;
    text_mesh *mesh;
    size_t vertex_room, corner_room, face_room; /* allocated entries */
} text_reader;

static bool fail(text_reader *reader, const char *reason)
{
    snprintf(reader->error, reader->error_size, "%s: line %lu: %s", reader->path, reader->line,
             reason);
    return false;
}

static bool ends_with(const char *path, const char *lower, const char *upper)
{
    const size_t length = strlen(path), tail = strlen(lower);
    if (length < tail) return false;
    const char *end = path + length - tail;
    return strcmp(end, lower) == 0 || strcmp(end, upper) == 0;
}

bool text_mesh_knows(const char *path)
{
    return ends_with(path, ".obj", ".OBJ") || ends_with(path, ".off", ".OFF");
}

/* Grows an array to hold more than count entries. */
static bool reserve(void **array, size_t *room, size_t count, size_t size)
{
    if (count < *room) return true;
    const size_t wanted = *room < 1024 ? 1024 : 2 * *room;
    void *grown = wanted > SIZE_MAX / size ? NULL : realloc(*array, wanted * size);
    if (!grown) return false;
    *array = grown;
    *room = wanted;
    return true;
}

static char *read_whole(const char *path, char *error, size_t error_size)
{
    errno = 0;
    FILE *file = fopen(path, "rb");
    void *text = NULL;
    size_t size = 0, room = 0;
    bool good = file != NULL;
    while (good) {
        good = reserve(&text, &room, size + 65536, 1);
        if (!good) continue;
        const size_t got = fread((char *)text + size, 1, room - size - 1, file);
        size += got;
        if (got == 0) break;
    }
    good = good && !ferror(file);
    if (!good) {
        snprintf(error, error_size, "%s: %s", path, errno ? strerror(errno) : "out of memory");
        free(text);
        text = NULL;
    } else {
        ((char *)text)[size] = 0;
    }
    if (file) fclose(file);
    return (char *)text;
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
        for (; *at && *at != '\n'; at++) {
            if (*at == '#') comment = true;
            const char *after = at + 1;
            if (*after == '\r') after++;
            if (continues && *at == '\\' && *after == '\n') {
                memset(at, ' ', (size_t)(after - at) + 1);
                reader->line++;
            }
            if (comment) *at = ' ';
        }
        reader->next = *at ? at + 1 : at;
        *at = 0;
        char *const content = skip_space(begin);
        if (*content) return content;
    }
    return NULL;
}

static bool add_vertex(text_reader *reader, char *at)
{
    text_mesh *const mesh = reader->mesh;
    void *array = mesh->positions;
    if (!reserve(&array, &reader->vertex_room, mesh->vertex_count, 3 * sizeof(float))) {
        return fail(reader, "out of memory");
    }
    mesh->positions = (float *)array;
    for (size_t k = 0; k < 3; k++) {
        char *end;
        mesh->positions[3 * mesh->vertex_count + k] = strtof(at, &end);
        if (end == at || (*end && !is_space(*end))) {
            return fail(reader, "a vertex needs three numbers");
        }
        at = end;
    }
    if (mesh->vertex_count >= UINT32_MAX - 1) return fail(reader, "too many vertices");
    mesh->vertex_count++;
    return true;
}

/* Puts a corner to the face that is being read, the one after the last. */
static bool add_corner(text_reader *reader, size_t index, size_t count)
{
    text_mesh *const mesh = reader->mesh;
    void *array = mesh->corners;
    const size_t at = mesh->offsets[mesh->face_count] + index;
    if (!reserve(&array, &reader->corner_room, at, sizeof(uint32_t))) {
        return fail(reader, "out of memory");
    }
    mesh->corners = (uint32_t *)array;
    mesh->corners[at] = (uint32_t)count;
    return true;
}

/* Ends the face that is being read; points and lines are dropped. */
static bool end_face(text_reader *reader, size_t corner_count)
{
    text_mesh *const mesh = reader->mesh;
    if (corner_count < 3) return true;
    void *array = mesh->offsets;
    if (!reserve(&array, &reader->face_room, mesh->face_count + 1, sizeof(size_t))) {
        return fail(reader, "out of memory");
    }
    mesh->offsets = (size_t *)array;
    mesh->offsets[mesh->face_count + 1] = mesh->offsets[mesh->face_count] + corner_count;
    mesh->face_count++;
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
        for (at = end; *at && !is_space(*at); at++) continue;
    }
    if (count < 3) return fail(reader, "a face needs three vertices");
    return end_face(reader, count);
}

static bool read_obj(text_reader *reader)
{
    for (char *at; (at = next_line(reader, true)) != NULL;) {
        if (at[0] == 'v' && is_space(at[1])) {
            if (!add_vertex(reader, at + 1)) return false;
        } else if (at[0] == 'f' && (is_space(at[1]) || !at[1])) {
            if (!read_obj_face(reader, at + 1)) return false;
        }
    }
    /* A face may come before its vertices, so this is known only now. */
    const text_mesh *mesh = reader->mesh;
    for (size_t c = 0; c < mesh->offsets[mesh->face_count]; c++) {
        if (mesh->corners[c] >= mesh->vertex_count) {
            snprintf(reader->error, reader->error_size,
                     "%s: a face names vertex %lu, the file has %lu", reader->path,
                     (unsigned long)mesh->corners[c] + 1, (unsigned long)mesh->vertex_count);
            return false;
        }
    }
    return true;
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
    return true;
}

bool text_mesh_read(text_mesh *mesh, const char *path, char *error, size_t error_size)
{
    memset(mesh, 0, sizeof *mesh);
    text_reader reader;
    memset(&reader, 0, sizeof reader);
    reader.path = path;
    reader.error = error;
    reader.error_size = error_size;
    reader.mesh = mesh;
    reader.text = read_whole(path, error, error_size);
    if (!reader.text) return false;
    reader.next = reader.text;
    void *offsets = NULL;
    bool done;
    if (!reserve(&offsets, &reader.face_room, 0, sizeof(size_t))) {
        done = fail(&reader, "out of memory");
    } else {
        mesh->offsets = (size_t *)offsets;
        mesh->offsets[0] = 0;
        done = ends_with(path, ".off", ".OFF") ? read_off(&reader) : read_obj(&reader);
    }
    free(reader.text);
    if (!done) text_mesh_free(mesh);
    return done;
}

void text_mesh_free(text_mesh *mesh)
{
    free(mesh->positions);
    free(mesh->corners);
    free(mesh->offsets);
    memset(mesh, 0, sizeof *mesh);
}

/* A corner of a polygon in the plane that it is cut in. */
typedef struct plane_point {
    double x, y;
} plane_point;

/* The two axes to keep, so that the polygon turns to the left: Newell's normal decides. */
static void choose_plane(const float *positions, const uint32_t *corners, uint32_t count, int *x,
                         int *y)
{
    double normal[3] = {0.0, 0.0, 0.0};
    for (uint32_t i = 0; i < count; i++) {
        const float *a = positions + 3 * (size_t)corners[i];
        const float *b = positions + 3 * (size_t)corners[(i + 1) % count];
        for (int k = 0; k < 3; k++) {
            const int u = (k + 1) % 3, v = (k + 2) % 3;
            normal[k] += ((double)a[u] - (double)b[u]) * ((double)a[v] + (double)b[v]);
        }
    }
    int axis = 0;
    for (int k = 1; k < 3; k++) axis = fabs(normal[k]) > fabs(normal[axis]) ? k : axis;
    *x = normal[axis] < 0.0 ? (axis + 2) % 3 : (axis + 1) % 3;
    *y = normal[axis] < 0.0 ? (axis + 1) % 3 : (axis + 2) % 3;
}

static plane_point project(const float *positions, uint32_t vertex, int x, int y)
{
    const float *p = positions + 3 * (size_t)vertex;
    const plane_point point = {(double)p[x], (double)p[y]};
    return point;
}

static double turn(plane_point a, plane_point b, plane_point c)
{
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

static bool same_point(plane_point a, plane_point b)
{
    return a.x == b.x && a.y == b.y;
}

/* Whether the corner in the middle can be cut off: it turns left and no other corner is inside. */
static bool is_ear(const float *positions, const uint32_t *ring, uint32_t count, uint32_t middle,
                   int x, int y)
{
    const plane_point a = project(positions, ring[(middle + count - 1) % count], x, y);
    const plane_point b = project(positions, ring[middle], x, y);
    const plane_point c = project(positions, ring[(middle + 1) % count], x, y);
    if (!(turn(a, b, c) > 0.0)) return false;
    for (uint32_t i = 0; i < count; i++) {
        const plane_point p = project(positions, ring[i], x, y);
        if (same_point(p, a) || same_point(p, b) || same_point(p, c)) continue;
        if (turn(a, b, p) >= 0.0 && turn(b, c, p) >= 0.0 && turn(c, a, p) >= 0.0) return false;
    }
    return true;
}

void text_mesh_triangulate(const float *positions, const uint32_t *corners, uint32_t count,
                           uint32_t *triangles)
{
    /* The ring of corners that are left is kept in the end of the output, which it never outgrows:
       of count - 2 triangles, count - left are written when left corners remain. */
    int x, y;
    choose_plane(positions, corners, count, &x, &y);
    uint32_t *out = triangles;
    if (count == 3) {
        memcpy(out, corners, 3 * sizeof *out);
        return;
    }
    uint32_t *ring = triangles + 3 * ((size_t)count - 2) - count;
    memcpy(ring, corners, count * sizeof *ring);
    for (uint32_t left = count; left > 3; left--) {
        uint32_t middle = 1;
        while (middle < left && !is_ear(positions, ring, left, middle, x, y)) middle++;
        if (middle == left) middle = is_ear(positions, ring, left, 0, x, y) ? 0 : 1;
        const uint32_t triangle[3] = {ring[(middle + left - 1) % left], ring[middle],
                                      ring[(middle + 1) % left]};
        /* Close the gap towards the end, so that the front of the ring becomes free. */
        memmove(ring + 1, ring, middle * sizeof *ring);
        ring++;
        memcpy(out, triangle, sizeof triangle);
        out += 3;
    }
    memmove(out, ring, 3 * sizeof *out);
}
