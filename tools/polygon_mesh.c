/*
 * Polygons; see polygon_mesh.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "polygon_mesh.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Grows an array to hold `wanted` entries of a size. */
static bool reserve(void **array, size_t *room, size_t wanted, size_t size)
{
    if (wanted <= *room) return true;
    size_t more = *room < 1024 ? 1024 : *room > SIZE_MAX / 2 ? SIZE_MAX : 2 * *room;
    if (more < wanted) more = wanted;
    void *grown = more > SIZE_MAX / size ? NULL : realloc(*array, more * size);
    if (!grown) return false;
    *array = grown;
    *room = more;
    return true;
}

bool polygon_mesh_reserve_vertices(polygon_mesh *mesh, size_t count)
{
    if (count > UINT32_MAX - 1 - mesh->vertex_count) return false;
    void *array = mesh->positions;
    const bool done =
        reserve(&array, &mesh->vertex_room, mesh->vertex_count + count, 3 * sizeof(double));
    mesh->positions = (double *)array;
    return done;
}

bool polygon_mesh_reserve_corners(polygon_mesh *mesh, size_t count)
{
    const size_t used = mesh->offsets[mesh->face_count];
    void *array = mesh->corners;
    const bool done = count <= SIZE_MAX - used &&
                      reserve(&array, &mesh->corner_room, used + count, sizeof(uint32_t));
    mesh->corners = (uint32_t *)array;
    return done;
}

bool polygon_mesh_reserve_faces(polygon_mesh *mesh, size_t count)
{
    if (count > UINT32_MAX - 1 - mesh->face_count) return false;
    void *array = mesh->offsets;
    const bool done =
        reserve(&array, &mesh->face_room, mesh->face_count + count + 1, sizeof *mesh->offsets);
    mesh->offsets = (size_t *)array;
    return done;
}

bool polygon_mesh_init(polygon_mesh *mesh)
{
    memset(mesh, 0, sizeof *mesh);
    if (!polygon_mesh_reserve_faces(mesh, 1)) return false;
    mesh->offsets[0] = 0;
    return true;
}

void polygon_mesh_free(polygon_mesh *mesh)
{
    for (uint32_t i = 0; i < mesh->object_count; i++) free(mesh->object_names[i]);
    for (size_t i = 0; i < mesh->mark_count; i++) free(mesh->marks[i].name);
    free(mesh->positions);
    free(mesh->corners);
    free(mesh->offsets);
    free(mesh->object_names);
    free(mesh->object_of_face);
    free(mesh->marks);
    memset(mesh, 0, sizeof *mesh);
}

bool polygon_mesh_add_vertex(polygon_mesh *mesh, const double position[3])
{
    if (!polygon_mesh_reserve_vertices(mesh, 1)) return false;
    memcpy(mesh->positions + 3 * mesh->vertex_count, position, 3 * sizeof *position);
    mesh->vertex_count++;
    return true;
}

bool polygon_mesh_add_corner(polygon_mesh *mesh, size_t index, uint32_t corner)
{
    if (!polygon_mesh_reserve_corners(mesh, index + 1)) return false;
    mesh->corners[mesh->offsets[mesh->face_count] + index] = corner;
    return true;
}

bool polygon_mesh_end_face(polygon_mesh *mesh, size_t count)
{
    if (!polygon_mesh_reserve_faces(mesh, 1)) return false;
    mesh->offsets[mesh->face_count + 1] = mesh->offsets[mesh->face_count] + count;
    mesh->face_count++;
    return true;
}

bool polygon_mesh_add_face(polygon_mesh *mesh, const uint32_t *corners, size_t count)
{
    if (!polygon_mesh_reserve_corners(mesh, count)) return false;
    if (count)
        memcpy(mesh->corners + mesh->offsets[mesh->face_count], corners, count * sizeof *corners);
    return polygon_mesh_end_face(mesh, count);
}

/* ------------------------------------------------------------------------------------------------
 * Objects
 */

static char *copy_name(const char *name, size_t length)
{
    char *copy = (char *)malloc(length + 1);
    if (!copy) return NULL;
    memcpy(copy, name, length);
    copy[length] = '\0';
    return copy;
}

bool polygon_mesh_mark(polygon_mesh *mesh, char kind, const char *name, size_t length)
{
    void *array = mesh->marks;
    const bool roomy = reserve(&array, &mesh->mark_room, mesh->mark_count + 1, sizeof *mesh->marks);
    mesh->marks = (polygon_mark *)array;
    char *copy = roomy ? copy_name(name, length) : NULL;
    if (!copy) return false;
    polygon_mark *mark = &mesh->marks[mesh->mark_count++];
    mark->first_face = mesh->face_count;
    mark->name = copy;
    mark->kind = kind;
    return true;
}

/* The next mark of a kind from an index on, or mark_count. */
static size_t next_mark(const polygon_mesh *mesh, char kind, size_t index)
{
    while (index < mesh->mark_count && mesh->marks[index].kind != kind) index++;
    return index;
}

/* The first face that a mark, or the end of the file, takes over. */
static size_t mark_start(const polygon_mesh *mesh, size_t index)
{
    return index < mesh->mark_count ? mesh->marks[index].first_face : mesh->face_count;
}

size_t polygon_mesh_marked(const polygon_mesh *mesh, char kind)
{
    size_t count = 0;
    for (size_t i = next_mark(mesh, kind, 0), next; i < mesh->mark_count; i = next) {
        next = next_mark(mesh, kind, i + 1);
        count += mark_start(mesh, next) > mesh->marks[i].first_face;
    }
    return count;
}

/* Objects by name: an open hash table, at most half full. */
typedef struct object_table {
    uint32_t *slots; /* UINT32_MAX: empty */
    size_t size;     /* a power of two */
} object_table;

/* The object of a name, made anew if there is none or each is its own; UINT32_MAX: no memory. */
static uint32_t find_object(polygon_mesh *mesh, object_table *table, const char *name, bool same)
{
    size_t slot = 5381;
    for (const char *c = name; *c; c++) slot = 33 * slot + (unsigned char)*c;
    for (slot &= table->size - 1; table->slots[slot] != UINT32_MAX;
         slot = (slot + 1) & (table->size - 1)) {
        const uint32_t object = table->slots[slot];
        if (same && strcmp(mesh->object_names[object], name) == 0) return object;
    }
    char *copy = copy_name(name, strlen(name));
    if (!copy) return UINT32_MAX;
    mesh->object_names[mesh->object_count] = copy;
    table->slots[slot] = mesh->object_count;
    return mesh->object_count++;
}

/* Gives faces begin to end - 1 to the object of a name. */
static bool take_faces(polygon_mesh *mesh, object_table *table, size_t begin, size_t end,
                       const char *name, bool same)
{
    if (begin == end) return true;
    const uint32_t object = find_object(mesh, table, name, same);
    if (object == UINT32_MAX) return false;
    for (size_t f = begin; f < end; f++) mesh->object_of_face[f] = object;
    return true;
}

bool polygon_mesh_name_objects(polygon_mesh *mesh, char kind, bool same)
{
    object_table table = {NULL, 16};
    size_t at = next_mark(mesh, kind, 0);
    if (at == mesh->mark_count || mesh->face_count == 0) return true;
    while (table.size < 2 * (mesh->mark_count + 1)) table.size *= 2;
    table.slots = (uint32_t *)malloc(table.size * sizeof *table.slots);
    mesh->object_names = (char **)malloc((mesh->mark_count + 1) * sizeof *mesh->object_names);
    mesh->object_of_face = (uint32_t *)malloc(mesh->face_count * sizeof *mesh->object_of_face);
    bool done = table.slots && mesh->object_names && mesh->object_of_face;
    if (done) {
        memset(table.slots, 0xff, table.size * sizeof *table.slots);
        done = take_faces(mesh, &table, 0, mark_start(mesh, at), "", same);
    }
    while (done && at < mesh->mark_count) {
        const size_t next = next_mark(mesh, kind, at + 1);
        done = take_faces(mesh, &table, mark_start(mesh, at), mark_start(mesh, next),
                          mesh->marks[at].name, same);
        at = next;
    }
    free(table.slots);
    if (done && mesh->object_count == 1) {
        free(mesh->object_of_face);
        mesh->object_of_face = NULL;
        if (!mesh->object_names[0][0]) {
            free(mesh->object_names[0]);
            mesh->object_count = 0;
        }
    }
    return done;
}

/* ------------------------------------------------------------------------------------------------
 * Triangles
 */

size_t polygon_mesh_bad_face(const polygon_mesh *mesh)
{
    for (size_t f = 0; f < mesh->face_count; f++) {
        for (size_t c = mesh->offsets[f]; c < mesh->offsets[f + 1]; c++) {
            if (mesh->corners[c] >= mesh->vertex_count) return f;
        }
    }
    return mesh->face_count;
}

uint64_t polygon_mesh_triangle_count(const polygon_mesh *mesh)
{
    uint64_t count = 0;
    for (size_t f = 0; f < mesh->face_count; f++) {
        const size_t corners = mesh->offsets[f + 1] - mesh->offsets[f];
        if (corners > 2) count += corners - 2;
    }
    return count;
}

/* A corner of a polygon in the plane that it is cut in. */
typedef struct plane_point {
    double x, y;
} plane_point;

/* The two axes to keep, so that the polygon turns to the left: Newell's normal decides, taken from
   the first corner, so that far from the origin it is as exact. */
static void choose_plane(const double *positions, const uint32_t *corners, uint32_t count, int *x,
                         int *y)
{
    double normal[3] = {0.0, 0.0, 0.0};
    const double *o = positions + 3 * (size_t)corners[0];
    for (uint32_t i = 0; i < count; i++) {
        const double *a = positions + 3 * (size_t)corners[i];
        const double *b = positions + 3 * (size_t)corners[(i + 1) % count];
        for (int k = 0; k < 3; k++) {
            const int u = (k + 1) % 3, v = (k + 2) % 3;
            normal[k] += (a[u] - b[u]) * ((a[v] - o[v]) + (b[v] - o[v]));
        }
    }
    int axis = 0;
    for (int k = 1; k < 3; k++) axis = fabs(normal[k]) > fabs(normal[axis]) ? k : axis;
    *x = normal[axis] < 0.0 ? (axis + 2) % 3 : (axis + 1) % 3;
    *y = normal[axis] < 0.0 ? (axis + 1) % 3 : (axis + 2) % 3;
}

static plane_point project(const double *positions, uint32_t vertex, int x, int y)
{
    const double *p = positions + 3 * (size_t)vertex;
    const plane_point point = {p[x], p[y]};
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
static bool is_ear(const double *positions, const uint32_t *ring, uint32_t count, uint32_t middle,
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

void polygon_mesh_triangulate(const double *positions, const uint32_t *corners, uint32_t count,
                              uint32_t *triangles)
{
    /* The ring of corners that are left is kept in the end of the output, which it never outgrows:
       of count - 2 triangles, count - left are written when left corners remain. */
    int x, y;
    uint32_t *out = triangles;
    if (count == 3) {
        memcpy(out, corners, 3 * sizeof *out);
        return;
    }
    choose_plane(positions, corners, count, &x, &y);
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
