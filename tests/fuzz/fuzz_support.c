/*
 * What the fuzz targets share: see fuzz_support.h.
 *
 * SPDX-License-Identifier: MIT
 */
#define _POSIX_C_SOURCE 200112L /* posix_memalign: blocks that end where they end */

#include "fuzz_support.h"

#include <float.h>
#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "harness.h"
#include "shapes.h"

void fuzz_fail(const char *file, int line, const char *condition, const char *format, ...)
{
    va_list arguments;
    fprintf(stderr, "%s:%d: FUZZ_CHECK(%s) failed: ", file, line, condition);
    va_start(arguments, format);
    vfprintf(stderr, format, arguments);
    va_end(arguments);
    fprintf(stderr, "\n");
    abort();
}

/* ---- numbers ---- */

uint32_t fuzz_byte(fuzz_bytes *bytes)
{
    if (bytes->left == 0) return 0;
    --bytes->left;
    return *bytes->at++;
}

uint64_t fuzz_number(fuzz_bytes *bytes, uint32_t size)
{
    uint64_t number = 0;
    for (uint32_t i = 0; i < size; ++i) number |= (uint64_t)fuzz_byte(bytes) << 8 * i;
    return number;
}

static double extreme(uint32_t which)
{
    static const double values[] = {
        0,
        1,
        0.5,
        0.1,
        1.0 / 3,
        1 + DBL_EPSILON,
        1 - DBL_EPSILON / 2,
        1 + (double)FLT_EPSILON,
        DBL_MAX,
        DBL_MAX / 2,
        DBL_MIN,
        DBL_MIN / 2,
        4.9406564584124654e-324,
        1e-323,
        (double)FLT_MAX,
        (double)FLT_MAX * (1 + DBL_EPSILON),
        (double)FLT_MIN,
        (double)FLT_MIN / 2,
        1.40129846432481707e-45,
        1e30,
        1e-30,
        1e154,
        1e-154,
        1e100,
        1e-200,
        16777216,
        16777217,
        1e6,
        2,
        3,
        HUGE_VAL,
        (double)NAN,
    };
    double value = values[which % 32];
    return which & 32 ? -value : value;
}

double fuzz_coordinate(fuzz_bytes *bytes, uint32_t kind)
{
    uint32_t byte;
    uint64_t bits;
    float single;
    double value;
    switch (kind) {
    case 0:
        return (int)(fuzz_byte(bytes) % 9) - 4;
    case 1:
        return ((int)fuzz_byte(bytes) - 128) * 0.1;
    case FUZZ_KIND_FLOAT:
        byte = (uint32_t)fuzz_number(bytes, 4);
        memcpy(&single, &byte, sizeof(single));
        return (double)single;
    case FUZZ_KIND_DOUBLE:
        bits = fuzz_number(bytes, 8);
        memcpy(&value, &bits, sizeof(value));
        return value;
    case 4:
        return extreme(fuzz_byte(bytes));
    default:
        byte = fuzz_byte(bytes);
        value = (int)(byte % 8) - 4;
        for (byte /= 8; byte % 8 != 0; --byte) value = nextafter(value, byte & 8 ? 9 : -9);
        return value;
    }
}

/* ---- meshes ---- */

/* The first byte of a mesh: the kind of coordinates in the low bits, and these. */
enum { MESH_WILD = 8, MESH_MADE = 16, MESH_TRIANGLES = FUZZ_ORACLE };

soup fuzz_mesh(fuzz_bytes *bytes, int wild)
{
    uint32_t form = fuzz_byte(bytes), kind = form % 8 % FUZZ_KINDS;
    uint32_t vertices = 1 + fuzz_byte(bytes), triangles = 1 + fuzz_byte(bytes) % MESH_TRIANGLES;
    soup s;
    if (form & MESH_MADE) {
        const char *name;
        test_random_reset(vertices);
        s = shape_any(triangles < 8 ? 8 : triangles, &name);
        if (s.triangle_count <= 256 && s.vertex_count <= 256) return s;
        soup_free(&s);
    }
    s = soup_make(vertices, triangles);
    for (uint32_t i = 0; i < 3 * triangles; ++i) {
        s.triangles[i] = fuzz_byte(bytes);
        if (wild && form & MESH_WILD && s.triangles[i] > 250) {
            s.triangles[i] |= (uint32_t)fuzz_number(bytes, 3) << 8;
        } else {
            s.triangles[i] %= vertices;
        }
    }
    for (uint32_t i = 0; i < 3 * vertices; ++i) {
        double x = fuzz_coordinate(bytes, kind);
        s.positions[i] = !wild && !isfinite(x) ? 0 : x;
    }
    return s;
}

/* The start of a mesh as fuzz_mesh reads it, positions rounded to float; returns the number of
   bytes. */
static size_t write_mesh(const soup *s, uint8_t *bytes)
{
    uint32_t triangles = 0, vertices = 0;
    size_t used = 0;
    while (triangles < s->triangle_count && triangles < MESH_TRIANGLES) {
        const uint32_t *v = s->triangles + 3 * (size_t)triangles;
        uint32_t highest = v[0] > v[1] ? v[0] : v[1];
        if (v[2] > highest) highest = v[2];
        if (highest > 255) break;
        if (highest >= vertices) vertices = highest + 1;
        ++triangles;
    }
    if (triangles == 0) return 0;
    bytes[used++] = FUZZ_KIND_FLOAT;
    bytes[used++] = (uint8_t)(vertices - 1);
    bytes[used++] = (uint8_t)(triangles - 1);
    for (size_t i = 0; i < 3 * (size_t)triangles; ++i) bytes[used++] = (uint8_t)s->triangles[i];
    for (size_t i = 0; i < 3 * (size_t)vertices; ++i) {
        float single = (float)s->positions[i];
        uint32_t bits;
        memcpy(&bits, &single, sizeof(bits));
        for (int k = 0; k < 4; ++k) bytes[used++] = (uint8_t)(bits >> 8 * k);
    }
    return used;
}

size_t fuzz_seed(const char *path, uint32_t variant, uint8_t *bytes)
{
    /* What stands before the mesh. */
    static const uint8_t heads[FUZZ_SEED_VARIANTS][5] = {
        {0, 0, 0, 0, 0}, {4, 1, 1, 0, 0}, {9, 7, 9, 0, 0}, {14, 3, 98, 9, 0}};
    size_t used = sizeof(heads[0]), mesh;
    soup s;
    if (!input_read_obj(path, &s)) return 0;
    memcpy(bytes, heads[variant], used);
    mesh = write_mesh(&s, bytes + used);
    soup_free(&s);
    if (mesh == 0) return 0;
    for (used += mesh, mesh = 0; mesh < 64; ++mesh) /* poses and questions */
        bytes[used++] = (uint8_t)(variant == 0 ? 0 : mesh * (variant * 37 + 20));
    return used;
}

size_t fuzz_saved_seed(const char *path, uint32_t variant, uint8_t *bytes)
{
    size_t size = 0;
    uint64_t needed = 0;
    sc_model *model = NULL;
    sc_mesh mesh;
    sc_pose pose;
    sc_status status;
    soup s;
    if (!input_read_obj(path, &s)) return 0;
    if (s.triangle_count > MESH_TRIANGLES) s.triangle_count = MESH_TRIANGLES;
    mesh = input_plain_mesh(&s);
    pose = input_plain_pose(s.positions, s.vertex_count);
    bytes[0] = variant % 2 ? 0 : 16; /* as it is, or with the checksum made right */
    bytes[1] = (uint8_t)variant;
    status = sc_build(&mesh, NULL, &model);
    if (status == SC_OK)
        status = variant / 2
                     ? sc_record_write(model, &pose, NULL, bytes + 2, FUZZ_SAVED_ROOM - 2, &needed)
                     : sc_model_save(model, bytes + 2, FUZZ_SAVED_ROOM - 2, &needed);
    if (status == SC_OK) size = 2 + (size_t)needed;
    sc_model_free(model);
    soup_free(&s);
    return size;
}

static uint32_t index_at(const sc_mesh *mesh, uint32_t corner)
{
    uint32_t size = mesh->index_type == SC_UINT16 ? 2 : 4, v = 0;
    uint32_t stride = mesh->index_stride ? mesh->index_stride : 3 * size;
    uint16_t narrow;
    const unsigned char *at = (const unsigned char *)mesh->indices;
    at += (size_t)stride * (corner / 3) + (size_t)size * (corner % 3);
    if (size == 4) {
        memcpy(&v, at, sizeof(v));
        return v;
    }
    memcpy(&narrow, at, sizeof(narrow));
    return narrow;
}

static int is_finite_at(const sc_mesh *mesh, uint32_t vertex)
{
    uint32_t size = mesh->position_type == SC_DOUBLE ? 8 : 4;
    uint32_t stride = mesh->position_stride ? mesh->position_stride : 3 * size;
    const unsigned char *at = (const unsigned char *)mesh->positions + (size_t)stride * vertex;
    double wide[3];
    float narrow[3];
    if (size == 4) {
        memcpy(narrow, at, sizeof(narrow));
        for (int k = 0; k < 3; ++k) wide[k] = (double)narrow[k];
    } else {
        memcpy(wide, at, sizeof(wide));
    }
    return isfinite(wide[0]) && isfinite(wide[1]) && isfinite(wide[2]);
}

uint32_t fuzz_mesh_faults(const sc_mesh *mesh, const uint32_t *weld_map)
{
    uint32_t faults = 0, count = mesh->vertex_count;
    if (mesh->reserved || mesh->position_type > SC_DOUBLE || mesh->index_type > SC_UINT16)
        faults |= FUZZ_BIT(SC_ERROR_OPTION);
    if (!count || !mesh->triangle_count) faults |= FUZZ_BIT(SC_ERROR_EMPTY);
    if (count == UINT32_MAX || mesh->triangle_count > 0x55555554)
        faults |= FUZZ_BIT(SC_ERROR_COUNT);
    if (!mesh->positions || !mesh->indices) faults |= FUZZ_BIT(SC_ERROR_NULL);
    if ((mesh->position_stride &&
         mesh->position_stride < (mesh->position_type == SC_DOUBLE ? 24 : 12)) ||
        (mesh->index_stride && mesh->index_stride < (mesh->index_type == SC_UINT16 ? 6 : 12)))
        faults |= FUZZ_BIT(SC_ERROR_STRIDE);
    if (faults) return faults;
    for (uint32_t i = 0; i < 3 * mesh->triangle_count; ++i)
        if (index_at(mesh, i) >= count) return FUZZ_BIT(SC_ERROR_INDEX);
    for (uint32_t i = 0; i < 3 * mesh->triangle_count; ++i) {
        uint32_t v = index_at(mesh, i), to = weld_map && weld_map[v] < count ? weld_map[v] : v;
        if (!is_finite_at(mesh, v) || !is_finite_at(mesh, to)) return FUZZ_BIT(SC_ERROR_NOT_FINITE);
    }
    return 0;
}

/* ---- memory ---- */

void *fuzz_copy(const void *from, size_t size)
{
    void *memory = test_allocate(size);
    if (size > 0) memcpy(memory, from, size);
    return memory;
}

static void *allocate(void *user, uint64_t size, uint64_t alignment)
{
    fuzz_memory *m = (fuzz_memory *)user;
    void *memory;
    FUZZ_CHECK(size > 0 && alignment > 0 && SC_ALIGNMENT % alignment == 0,
               "%" PRIu64 " bytes aligned to %" PRIu64, size, alignment);
    if (m->countdown == 0) {
        ++m->refused;
        return NULL;
    }
    --m->countdown;
    ++m->live;
    if (alignment < sizeof(void *)) alignment = sizeof(void *);
    if (posix_memalign(&memory, (size_t)alignment, (size_t)size) != 0) abort();
    return memset(memory, 0xa5, (size_t)size);
}

static void release(void *user, void *memory, uint64_t size)
{
    fuzz_memory *m = (fuzz_memory *)user;
    FUZZ_CHECK(memory != NULL && size > 0 && m->live > 0, "%" PRIu64 " bytes", size);
    --m->live;
    memset(memory, 0x5a, (size_t)size);
    free(memory);
}

sc_allocator fuzz_allocator(fuzz_memory *memory, uint32_t countdown)
{
    sc_allocator allocator;
    memset(memory, 0, sizeof(*memory));
    memory->countdown = countdown;
    allocator.allocate = allocate;
    allocator.release = release;
    allocator.user = memory;
    return allocator;
}

/* ---- answers ---- */

oracle_answer fuzz_expect(const soup *s, const double *positions, const uint32_t *weld,
                          const sc_model *model, sc_workspace *workspace)
{
    oracle_answer answer;
    sc_pose pose = input_plain_pose(positions, s->vertex_count);
    if (s->triangle_count <= FUZZ_ORACLE) {
        oracle_solve(positions, s->vertex_count, s->triangles, s->triangle_count, weld, &answer);
        return answer;
    }
    memset(&answer, 0, sizeof(answer));
    for (uint32_t i = 0; i < 4; ++i) {
        oracle_list *list = &answer.lists[i / 2][i % 2];
        sc_query_options options;
        sc_result result;
        memset(&options, 0, sizeof(options));
        options.struct_size = sizeof(options);
        options.pairs = i / 2;
        options.contact = i % 2;
        options.method = SC_METHOD_AABB;
        memset(&result, 0, sizeof(result));
        result.struct_size = sizeof(result);
        if (sc_query(model, workspace, &pose, &options, &result) == SC_OK) continue;
        list->count = list->capacity = result.capacity = result.count;
        list->pairs = result.pairs =
            (sc_pair *)test_allocate((size_t)result.count * sizeof(sc_pair));
        FUZZ_CHECK(sc_query(model, workspace, &pose, &options, &result) == SC_OK &&
                       result.count == list->count,
                   "the same query twice: %" PRIu64 " and %" PRIu64 " pairs", list->count,
                   result.count);
    }
    return answer;
}

static int is_same(const sc_pair *p, const sc_pair *q)
{
    return p->a == q->a && p->b == q->b;
}

void fuzz_check_query(const sc_model *model, sc_workspace *workspace, const sc_pose *pose,
                      const sc_query_options *options, uint64_t capacity,
                      const oracle_answer *expected)
{
    const oracle_list *list = &expected->lists[options->pairs][options->contact];
    int may_miss = options->contour == SC_CONTOUR_NONE &&
                   (options->method == SC_METHOD_DEFAULT || options->method == SC_METHOD_SCTT);
    uint64_t count = list->count, i, k = 0;
    sc_pair *pairs = (sc_pair *)test_allocate((size_t)capacity * sizeof(sc_pair));
    sc_result result;
    sc_status status;
    memset(&result, 0, sizeof(result));
    result.struct_size = sizeof(result);
    result.collides = 2;
    result.count = 77;
    result.capacity = capacity;
    result.pairs = capacity == 0 ? NULL : pairs;
    status = sc_query(model, workspace, pose, options, &result);
    if (options->output == SC_OUTPUT_ANY && count > 1) count = 1;
    if (may_miss && result.count < count) count = result.count;
    FUZZ_CHECK(result.count == count && result.collides == (count > 0) &&
                   status == (options->output == SC_OUTPUT_PAIRS && count > capacity
                                  ? SC_ERROR_SHORT_BUFFER
                                  : SC_OK),
               "pairs %" PRIu32 ", contact %" PRIu32 ", method %" PRIu32 ", contour %" PRIu32
               ", rest cache %" PRIu32 ", output %" PRIu32 ", capacity %" PRIu64
               ": status %d, collides %" PRIu32 ", count %" PRIu64 " instead of %" PRIu64,
               options->pairs, options->contact, options->method, options->contour,
               options->rest_cache, options->output, capacity, (int)status, result.collides,
               result.count, count);
    for (i = 0; options->output == SC_OUTPUT_PAIRS && i < count && i < capacity; ++i, ++k) {
        while (may_miss && k < list->count && !is_same(&pairs[i], &list->pairs[k])) ++k;
        FUZZ_CHECK(k < list->count && is_same(&pairs[i], &list->pairs[k]),
                   "pairs %" PRIu32 ", contact %" PRIu32 ", method %" PRIu32 ": pair %" PRIu64
                   " is (%" PRIu32 ", %" PRIu32 ")",
                   options->pairs, options->contact, options->method, i, pairs[i].a, pairs[i].b);
    }
    free(pairs);
}
