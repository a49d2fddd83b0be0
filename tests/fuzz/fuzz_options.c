/*
 * Fuzz target: structures. Every structure of the interface at every struct_size, with members of
 * any value, NULL wherever a pointer can be, in blocks of exactly the size that it claims; calls
 * with the wrong workspace, level, capacity or alignment.
 *
 * A size that the library must refuse unread (no multiple of a pointer's, or too small) stands in a
 * block of four bytes. What is wrong with a call is worked out here as well, from the structure as
 * an older caller would mean it: with members that the size does not reach taken as zero.
 *
 * SPDX-License-Identifier: MIT
 */
#define _POSIX_C_SOURCE 200112L /* posix_memalign: the workspace ends where it ends */

#include "fuzz_support.h"

#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "harness.h"

enum { MAXIMUM_CALLS = 16, NOISE = 0xa7 };

static const double places[3][9] = {
    {0, 0, 0, 4, 0, 0, 0, 4, 0}, {1, 1, -1, 2, 1, 1, 1, 2, 1}, {9, 9, 9, 8, 9, 9, 9, 8, 9}};

/* ---- structures ---- */

/* A structure in a block of its own. view: what the library must take it for; fault: if its size or
   what is behind the members known to us must be refused. */
typedef struct sized {
    unsigned char *block;
    uint32_t size;
    int is_refused;
} sized;

static sized make_sized(fuzz_bytes *bytes, void *view, uint32_t known, uint32_t least)
{
    sized s;
    uint32_t how = fuzz_byte(bytes);
    s.size = how < 128 ? known : fuzz_byte(bytes);
    if (how >= 240) s.size = (uint32_t)fuzz_number(bytes, 4);
    if (s.size > 512 && s.size % sizeof(void *) == 0) s.size %= 512;
    s.is_refused = s.size < least || s.size % sizeof(void *) != 0;
    if (s.is_refused) {
        s.block = (unsigned char *)fuzz_copy(&s.size, sizeof(s.size));
        return s;
    }
    s.block = (unsigned char *)test_allocate(s.size);
    memset(s.block, 0, s.size);
    memcpy(s.block, view, s.size < known ? s.size : known);
    memcpy(s.block, &s.size, sizeof(s.size));
    if (s.size < known) memset((unsigned char *)view + s.size, 0, known - s.size);
    if (s.size > known && how & 1) { /* something that this version does not know */
        s.block[known + fuzz_byte(bytes) % (s.size - known)] = 1;
        s.is_refused = 1;
    }
    return s;
}

/* After a call that fills a structure of which full is the whole: as far as it reaches. */
static void check_filled(const sized *s, sc_status status, const void *full, uint32_t known)
{
    uint32_t end = s->size < known ? s->size : known;
    FUZZ_CHECK(memcmp(s->block, &s->size, sizeof(s->size)) == 0, "struct_size has changed");
    for (uint32_t i = 4; status == SC_OK && i < end; ++i)
        FUZZ_CHECK(s->block[i] == ((const unsigned char *)full)[i], "byte %u", (unsigned)i);
    for (uint32_t i = 4; status != SC_OK && !s->is_refused && i < end; ++i)
        FUZZ_CHECK(s->block[i] == NOISE, "byte %u was written", (unsigned)i);
    for (uint32_t i = known; status == SC_OK && i < s->size; ++i)
        FUZZ_CHECK(s->block[i] == 0, "byte %u behind was written", (unsigned)i);
}

/* The status must be one of the causes there are, or SC_OK if there is none. */
static void check_status(sc_status status, uint32_t faults)
{
    FUZZ_CHECK(faults ? status > 0 && status < 32 && faults & FUZZ_BIT(status) : status == SC_OK,
               "status %d, faults %x", (int)status, (unsigned)faults);
}

static uint32_t small_or_wild(fuzz_bytes *bytes, uint32_t usual)
{
    uint32_t byte = fuzz_byte(bytes);
    return byte < 192 ? usual : byte < 248 ? byte % 8 : (uint32_t)fuzz_number(bytes, 4);
}

/* ---- building ---- */

static sc_status keep_order(void *user, const sc_dual_graph *graph, uint32_t left_target,
                            uint8_t *side)
{
    return input_bisect(user, graph, left_target, side);
}

/* Arrays of the size that the view of the mesh speaks of, and no more. */
static void make_arrays(fuzz_bytes *bytes, const sc_mesh *m, void **positions, void **indices)
{
    uint32_t vertices = m->vertex_count > 16 ? 0 : m->vertex_count;
    uint32_t triangles = m->triangle_count > 16 ? 0 : m->triangle_count;
    size_t point = m->position_type == SC_DOUBLE ? 24 : 12;
    size_t corner = m->index_type == SC_UINT16 ? 2 : 4;
    size_t step = m->position_stride ? m->position_stride : point;
    size_t index_step = m->index_stride ? m->index_stride : 3 * corner;
    size_t size = vertices ? (vertices - 1) * step + point : 0;
    size_t index_size = triangles ? (triangles - 1) * index_step + 3 * corner : 0;
    uint32_t fault = fuzz_byte(bytes);
    *positions = test_allocate(size);
    *indices = test_allocate(index_size);
    memset(*positions, 0, size);
    memset(*indices, 0, index_size);
    for (uint32_t i = 0; i < triangles && index_step >= 3 * corner; ++i)
        for (uint32_t k = 0; k < 3; ++k) /* the lowest byte; on other machines a wild index */
            ((unsigned char *)*indices)[i * index_step + k * corner] =
                (unsigned char)(fault >= 250 ? fault : (3 * i + k) % (vertices ? vertices : 1));
}

static void call_build(fuzz_bytes *bytes)
{
    static int user;
    uint32_t null = fuzz_byte(bytes), faults = 0;
    uint32_t identity[16];
    sc_tree_node tree[8];
    fuzz_memory memory;
    sc_allocator allocator = fuzz_allocator(&memory, UINT32_MAX);
    sc_mesh m;
    sc_build_options o;
    sc_model *model = (sc_model *)&user;
    void *positions, *indices;
    sized mesh, options;
    sc_status status;
    memset(&m, 0, sizeof(m));
    m.struct_size = sizeof(m);
    m.vertex_count = small_or_wild(bytes, 6);
    m.triangle_count = small_or_wild(bytes, 2);
    if (m.vertex_count > 16) m.vertex_count = UINT32_MAX;
    if (m.triangle_count > 16) m.triangle_count |= 0x55555555;
    m.position_type = small_or_wild(bytes, null & 1);
    m.position_stride = small_or_wild(bytes, 0);
    m.index_type = small_or_wild(bytes, null >> 1 & 1);
    m.index_stride = small_or_wild(bytes, 0);
    m.reserved = fuzz_byte(bytes) == 255;
    if (m.position_stride > 4096) m.position_stride %= 4096;
    if (m.index_stride > 4096) m.index_stride %= 4096;
    make_arrays(bytes, &m, &positions, &indices);
    m.positions = null >> 4 == 1 ? NULL : positions;
    m.indices = null >> 4 == 2 ? NULL : indices;
    mesh = make_sized(bytes, &m, sizeof(m), sizeof(m));

    memset(&o, 0, sizeof(o));
    for (uint32_t i = 0; i < 16; ++i) identity[i] = i;
    for (uint32_t i = 0; i < 8; ++i) {
        tree[i].left = tree[i].right = SC_NONE;
        tree[i].first = 0;
        tree[i].count = m.triangle_count;
    }
    if (allocator.allocate != NULL && null >> 4 == 3) allocator.allocate = NULL;
    if (null >> 4 == 4) allocator.release = NULL;
    o.struct_size = sizeof(o);
    o.weld = small_or_wild(bytes, fuzz_byte(bytes) % 3);
    o.partition = small_or_wild(bytes, fuzz_byte(bytes) % 4);
    o.tree_count = small_or_wild(bytes, 1) % 9;
    o.rest = small_or_wild(bytes, 1);
    o.content = small_or_wild(bytes, 0);
    o.weld_map = null >> 4 == 5 ? NULL : identity;
    o.order = null >> 4 == 6 ? NULL : identity;
    o.tree = null >> 4 == 7 ? NULL : tree;
    o.bisect = null >> 4 == 8 ? NULL : keep_order;
    o.allocator = null >> 4 == 9 ? NULL : &allocator;
    options = make_sized(bytes, &o, sizeof(o), 8);
    if (null >> 4 == 10) memset(&o, 0, sizeof(o));

    if (mesh.is_refused || (options.is_refused && null >> 4 != 10))
        faults = FUZZ_BIT(SC_ERROR_STRUCT_SIZE);
    if (null >> 4 == 11 || null >> 4 == 12) faults |= FUZZ_BIT(SC_ERROR_NULL);
    if (!faults) {
        faults = fuzz_mesh_faults(&m, NULL);
        if (o.weld > SC_WELD_NONE || o.partition > SC_PARTITION_BISECT || o.rest > SC_REST_MARKED ||
            o.content > SC_MODEL_BOXES)
            faults |= FUZZ_BIT(SC_ERROR_OPTION);
        if (o.content == SC_MODEL_BOXES && o.rest == SC_REST_MARKED)
            faults |= FUZZ_BIT(SC_ERROR_BOXES_ONLY);
        if ((o.weld == SC_WELD_MAP && !o.weld_map) ||
            ((o.partition == SC_PARTITION_ORDER || o.partition == SC_PARTITION_TREE) && !o.order) ||
            (o.partition == SC_PARTITION_TREE && !o.tree) ||
            (o.partition == SC_PARTITION_BISECT && !o.bisect) ||
            (o.allocator && (!o.allocator->allocate || !o.allocator->release)))
            faults |= FUZZ_BIT(SC_ERROR_NULL);
        if (o.partition == SC_PARTITION_TREE && !o.tree_count) faults |= FUZZ_BIT(SC_ERROR_TREE);
    }
    status = sc_build(null >> 4 == 11 ? NULL : (const sc_mesh *)(const void *)mesh.block,
                      null >> 4 == 10 ? NULL : (const sc_build_options *)(void *)options.block,
                      null >> 4 == 12 ? NULL : &model);
    check_status(status, faults);
    FUZZ_CHECK(null >> 4 == 12 || (model != NULL) == (status == SC_OK), "status %d", (int)status);
    if (status == SC_OK) sc_model_free(model);
    FUZZ_CHECK(memory.live == 0, "%u blocks", (unsigned)memory.live);
    free(mesh.block);
    free(options.block);
    free(positions);
    free(indices);
}

/* ---- asking about models, workspaces ---- */

static void call_info(fuzz_bytes *bytes, const sc_model *model)
{
    sc_model_info full, view;
    sc_level_info full_level, view_level;
    uint32_t how = fuzz_byte(bytes), level = small_or_wild(bytes, 0), levels;
    sized s;
    sc_status status;
    memset(&full, 0, sizeof(full));
    full.struct_size = sizeof(full);
    FUZZ_CHECK(sc_model_get_info(model, &full) == SC_OK, "whole");
    levels = full.level_count;
    if (how & 1) {
        memset(&view, NOISE, sizeof(view));
        s = make_sized(bytes, &view, sizeof(view), 8);
        status = sc_model_get_info(how == 255 ? NULL : model,
                                   how == 253 ? NULL : (sc_model_info *)(void *)s.block);
        check_status(status, how >= 253     ? FUZZ_BIT(SC_ERROR_NULL)
                             : s.is_refused ? FUZZ_BIT(SC_ERROR_STRUCT_SIZE)
                                            : 0);
        check_filled(&s, status, &full, sizeof(full));
    } else {
        memset(&full_level, 0, sizeof(full_level));
        full_level.struct_size = sizeof(full_level);
        status = sc_model_get_level(model, level, &full_level);
        check_status(status, level < levels ? 0 : FUZZ_BIT(SC_ERROR_LEVEL));
        memset(&view_level, NOISE, sizeof(view_level));
        s = make_sized(bytes, &view_level, sizeof(view_level), 8);
        status = sc_model_get_level(how == 254 ? NULL : model, level,
                                    how == 252 ? NULL : (sc_level_info *)(void *)s.block);
        check_status(status, how == 254 || how == 252
                                 ? FUZZ_BIT(SC_ERROR_NULL)
                                 : (level < levels ? 0 : FUZZ_BIT(SC_ERROR_LEVEL)) |
                                       (s.is_refused ? FUZZ_BIT(SC_ERROR_STRUCT_SIZE) : 0));
        check_filled(&s, status, &full_level, sizeof(full_level));
    }
    free(s.block);
}

static void call_workspace(fuzz_bytes *bytes, const sc_model *model)
{
    uint64_t size, given;
    uint32_t how = fuzz_byte(bytes), shift = fuzz_byte(bytes) % SC_ALIGNMENT, faults = 0;
    sc_workspace *workspace = NULL;
    void *memory;
    FUZZ_CHECK(sc_workspace_size(model, &size) == SC_OK, "good");
    FUZZ_CHECK(sc_workspace_size(NULL, &size) == SC_ERROR_NULL, "no model");
    FUZZ_CHECK(sc_workspace_size(model, NULL) == SC_ERROR_NULL, "nowhere");
    given = how & 1 ? size : size - 1 - fuzz_byte(bytes);
    if (how & 2) shift = 0;
    if (given < size) faults |= FUZZ_BIT(SC_ERROR_WORKSPACE);
    if (shift) faults |= FUZZ_BIT(SC_ERROR_ALIGNMENT);
    if (how / 16 >= 13) faults |= FUZZ_BIT(SC_ERROR_NULL);
    if (posix_memalign(&memory, SC_ALIGNMENT, (size_t)(shift + given)) != 0) abort();
    check_status(sc_workspace_init(how / 16 == 13 ? NULL : model,
                                   how / 16 == 14 ? NULL : (unsigned char *)memory + shift, given,
                                   how / 16 == 15 ? NULL : &workspace),
                 faults);
    FUZZ_CHECK((workspace != NULL) == (faults == 0), "faults %x", (unsigned)faults);
    sc_workspace_free(workspace); /* does nothing */
    free(memory);
}

static void call_patches(fuzz_bytes *bytes, const sc_model *model)
{
    uint32_t level = fuzz_byte(bytes) % 2, capacity = fuzz_byte(bytes) % 4, how = fuzz_byte(bytes);
    uint32_t *patches = (uint32_t *)test_allocate(capacity * sizeof(uint32_t));
    uint32_t faults = (level > 0 ? FUZZ_BIT(SC_ERROR_LEVEL) : 0) |
                      (capacity < 2 ? FUZZ_BIT(SC_ERROR_SHORT_BUFFER) : 0) |
                      (how >= 254 ? FUZZ_BIT(SC_ERROR_NULL) : 0);
    memset(patches, NOISE, capacity * sizeof(uint32_t));
    check_status(sc_model_get_patches(how == 254 ? NULL : model, level, how == 255 ? NULL : patches,
                                      capacity),
                 faults);
    for (uint32_t i = 0; i < capacity; ++i)
        FUZZ_CHECK(patches[i] == (faults || i > 1 ? NOISE * 0x01010101u : 0), "%u", (unsigned)i);
    free(patches);
}

/* ---- queries ---- */

/* workspaces[0] is the model's, workspaces[1] another's. The pose lets two triangles cross. */
static void call_query(fuzz_bytes *bytes, const sc_model *model, sc_workspace *const *workspaces)
{
    static const uint64_t counts[2] = {1, 2}; /* pairs of triangles; of edges and triangles */
    uint32_t null = fuzz_byte(bytes) >> 4, which = fuzz_byte(bytes) >= 240, faults = 0;
    sc_pose p;
    sc_query_options o;
    sc_result r;
    sc_stats t;
    sized pose, options, result, stats;
    sc_status status;
    sc_pair *pairs;
    uint64_t count = 0;
    int is_answered;
    memset(&p, 0, sizeof(p));
    p.vertex_count = small_or_wild(bytes, 6);
    p.position_type = small_or_wild(bytes, SC_DOUBLE);
    p.position_stride = small_or_wild(bytes, 0);
    if (p.position_stride >= 24) p.position_stride = 0;
    if (p.position_type == SC_FLOAT) p.position_type = SC_DOUBLE;
    p.positions = null == 1 ? NULL : places;
    pose = make_sized(bytes, &p, sizeof(p), sizeof(p));
    memset(&o, 0, sizeof(o));
    o.output = small_or_wild(bytes, 0);
    o.pairs = small_or_wild(bytes, 0);
    o.contact = small_or_wild(bytes, 0);
    o.method = small_or_wild(bytes, 0);
    o.contour = small_or_wild(bytes, 0);
    if (o.contour == SC_CONTOUR_NONE) o.contour = SC_CONTOUR_STAR; /* may miss the pair */
    o.rest_cache = small_or_wild(bytes, 0);
    o.simd = fuzz_byte(bytes) == 255 ? 4 : 0;
    options = make_sized(bytes, &o, sizeof(o), 8);
    if (null == 2) memset(&o, 0, sizeof(o));
    memset(&t, NOISE, sizeof(t));
    stats = make_sized(bytes, &t, sizeof(t), 8);
    memset(&r, NOISE, sizeof(r));
    r.capacity = fuzz_byte(bytes) % 5;
    pairs = (sc_pair *)test_allocate((size_t)r.capacity * sizeof(sc_pair));
    memset(pairs, NOISE, (size_t)r.capacity * sizeof(sc_pair));
    r.pairs = null == 3 ? NULL : pairs;
    r.stats = null == 4 ? NULL : (sc_stats *)(void *)stats.block;
    result = make_sized(bytes, &r, sizeof(r), (uint32_t)offsetof(sc_result, stats));

    if (pose.is_refused || result.is_refused || (options.is_refused && null != 2) ||
        (r.stats && stats.is_refused))
        faults |= FUZZ_BIT(SC_ERROR_STRUCT_SIZE);
    if (null == 1 || null >= 12) faults |= FUZZ_BIT(SC_ERROR_NULL);
    if (which) faults |= FUZZ_BIT(SC_ERROR_WORKSPACE);
    if (o.output > SC_OUTPUT_ANY || o.pairs > SC_PAIRS_EDGE || o.contact > SC_CONTACT_PROPER ||
        o.method > SC_METHOD_AABB || o.contour > SC_CONTOUR_EXACT ||
        o.rest_cache > SC_REST_CACHE_OFF || o.simd > SC_SIMD_AVX512 || p.position_type > SC_DOUBLE)
        faults |= FUZZ_BIT(SC_ERROR_OPTION);
    if (p.vertex_count != 6) faults |= FUZZ_BIT(SC_ERROR_VERTEX_COUNT);
    if (p.position_stride) faults |= FUZZ_BIT(SC_ERROR_STRIDE);
    if (null == 3 && o.output == SC_OUTPUT_PAIRS && r.capacity) faults |= FUZZ_BIT(SC_ERROR_NULL);
    if (!faults) {
        count = o.output == SC_OUTPUT_ANY ? 1 : counts[o.pairs];
        if (o.output == SC_OUTPUT_PAIRS && r.capacity < count)
            faults |= FUZZ_BIT(SC_ERROR_SHORT_BUFFER);
    }
    status = sc_query(null == 15 ? NULL : model, null == 14 ? NULL : workspaces[which],
                      null == 13 ? NULL : (const sc_pose *)(const void *)pose.block,
                      null == 2 ? NULL : (const sc_query_options *)(const void *)options.block,
                      null == 12 ? NULL : (sc_result *)(void *)result.block);
    check_status(status, faults);
    is_answered = status == SC_OK || status == SC_ERROR_SHORT_BUFFER;
    if (!result.is_refused && null != 12) {
        memcpy(&r, result.block, result.size < sizeof(r) ? result.size : sizeof(r));
        FUZZ_CHECK(r.count == count && r.collides == (count > 0) &&
                       r.pairs == (null == 3 ? NULL : pairs),
                   "status %d, count %u", (int)status, (unsigned)r.count);
    }
    for (uint64_t i = is_answered && o.output == SC_OUTPUT_PAIRS ? count : 0;
         !result.is_refused && i < r.capacity; ++i)
        FUZZ_CHECK(pairs[i].a == NOISE * 0x01010101u, "pair %u was written", (unsigned)i);
    free(pose.block);
    free(options.block);
    free(result.block);
    free(stats.block);
    free(pairs);
}

int fuzz_options(const uint8_t *data, size_t size)
{
    static const uint32_t triangles[9] = {0, 1, 2, 3, 4, 5, 6, 7, 8};
    fuzz_bytes bytes = {data, size};
    sc_model *models[2];
    sc_workspace *workspaces[2];
    for (uint32_t i = 0; i < 2; ++i) {
        sc_mesh mesh;
        memset(&mesh, 0, sizeof(mesh));
        mesh.struct_size = sizeof(mesh);
        mesh.vertex_count = 6 + 3 * i;
        mesh.triangle_count = 2 + i;
        mesh.position_type = SC_DOUBLE;
        mesh.positions = places;
        mesh.indices = triangles;
        FUZZ_CHECK(sc_build(&mesh, NULL, &models[i]) == SC_OK, "a good mesh");
        FUZZ_CHECK(sc_workspace_create(models[i], NULL, &workspaces[i]) == SC_OK, "good");
    }
    for (uint32_t calls = 0; calls < MAXIMUM_CALLS && bytes.left > 0; ++calls) {
        switch (fuzz_byte(&bytes) % 8) {
        case 0:
        case 1:
            call_build(&bytes);
            break;
        case 2:
            call_info(&bytes, models[0]);
            break;
        case 3:
            call_workspace(&bytes, models[0]);
            break;
        case 4:
            call_patches(&bytes, models[0]);
            break;
        default:
            call_query(&bytes, models[0], workspaces);
            break;
        }
    }
    for (uint32_t i = 0; i < 2; ++i) {
        sc_workspace_free(workspaces[i]);
        sc_model_free(models[i]);
    }
    return 0;
}
