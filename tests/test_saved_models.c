/*
 * Saved models: what is loaded is what was saved, byte by byte and pair by pair; whatever else is
 * offered is refused with a status that says why, or does no harm; and hooks, counters and
 * workspaces of the models concerned.
 *
 * Forged data have a right checksum: tests seal them with the library's own function, as anyone
 * could.
 *
 * SPDX-License-Identifier: MIT
 */
#define _POSIX_C_SOURCE 200809L

#include <inttypes.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <sys/mman.h>

#include "base/saved.h"
#include "build/model.h"
#include "harness.h"
#include "inputs.h"
#include "saved_models.h"
#include "shapes.h"
#include "soups.h"
#include "starcontour.h"

static void compare_infos(const sc_model *a, const sc_model *b, int in_place)
{
    sc_model_info p, q;
    uint32_t *patches[2];
    memset(&p, 0, sizeof(p));
    memset(&q, 0, sizeof(q));
    p.struct_size = q.struct_size = sizeof(p);
    CHECK(sc_model_get_info(a, &p) == SC_OK && sc_model_get_info(b, &q) == SC_OK);
    CHECK(p.peak_bytes > p.model_bytes && p.allocations > 10);
    if (in_place)
        CHECK(q.peak_bytes == 0 && q.allocations == 0);
    else
        CHECK(q.peak_bytes > q.model_bytes && q.allocations == 2);
    p.peak_bytes = q.peak_bytes = p.allocations = q.allocations = 0;
    CHECK(memcmp(&p, &q, sizeof(p)) == 0);
    for (int i = 0; i < 2; ++i)
        patches[i] = (uint32_t *)test_allocate(p.triangle_count * sizeof(uint32_t));
    for (uint32_t level = 0; level < p.level_count; ++level) {
        sc_level_info l, k;
        memset(&l, 0, sizeof(l));
        memset(&k, 0, sizeof(k));
        l.struct_size = k.struct_size = sizeof(l);
        CHECK(sc_model_get_level(a, level, &l) == SC_OK &&
              sc_model_get_level(b, level, &k) == SC_OK);
        CHECK(memcmp(&l, &k, sizeof(l)) == 0);
        CHECK(sc_model_get_patches(a, level, patches[0], p.triangle_count) == SC_OK);
        CHECK(sc_model_get_patches(b, level, patches[1], p.triangle_count) == SC_OK);
        CHECK(memcmp(patches[0], patches[1], p.triangle_count * sizeof(uint32_t)) == 0);
    }
    for (int i = 0; i < 2; ++i) free(patches[i]);
}

/* Both modes: equal infos, equal pairs, equal when saved again; the data are not touched. */
static uint64_t check_round_trip(const soup *mesh, sc_model *model)
{
    saved_model first = saved_model_of(model), kept = saved_model_copy(&first, first.size);
    double *posed = (double *)test_allocate(3 * (size_t)mesh->vertex_count * sizeof(double));
    uint64_t found = 0;
    memcpy(posed, mesh->positions, 3 * (size_t)mesh->vertex_count * sizeof(double));
    soup_fold(posed, mesh->vertex_count);
    for (uint32_t mode = SC_LOAD_COPY; mode <= SC_LOAD_IN_PLACE; ++mode) {
        sc_model *loaded = NULL;
        sc_workspace *workspaces[2] = {NULL, NULL};
        saved_model second;
        if (!CHECK(saved_model_load(&first, mode, &loaded) == SC_OK)) continue;
        second = saved_model_of(loaded);
        CHECK(second.size == first.size && memcmp(second.data, first.data, first.size) == 0);
        compare_infos(model, loaded, mode == SC_LOAD_IN_PLACE);
        CHECK(sc_workspace_create(model, NULL, &workspaces[0]) == SC_OK);
        CHECK(sc_workspace_create(loaded, NULL, &workspaces[1]) == SC_OK);
        found += saved_model_compare_pairs(model, workspaces[0], loaded, workspaces[1], mesh,
                                           mesh->positions);
        found +=
            saved_model_compare_pairs(model, workspaces[0], loaded, workspaces[1], mesh, posed);
        /* the workspace of one serves the other */
        saved_model_compare_pairs(model, workspaces[1], loaded, workspaces[0], mesh, posed);
        for (int i = 0; i < 2; ++i) sc_workspace_free(workspaces[i]);
        sc_model_free(loaded);
        free(second.memory);
    }
    CHECK(memcmp(first.data, kept.data, first.size) == 0);
    free(first.memory);
    free(kept.memory);
    free(posed);
    return found;
}

static void round_trips(void)
{
    uint64_t found = 0;
    for (uint32_t i = 0; i < test_iterations_at_least(24, 6); ++i) {
        const char *name;
        soup mesh = shape_any(200, &name);
        sc_model *model =
            saved_model_build(&mesh, i % 3, i % 4, i % 5 == 0 ? SC_MODEL_BOXES : SC_MODEL_FULL);
        if (model) found += check_round_trip(&mesh, model);
        sc_model_free(model);
        soup_free(&mesh);
    }
    CHECK(found > 100);
}

static void round_trips_of_mesh_files(void)
{
    static const char *const names[] = {"annulus",
                                        "corner_on_face",
                                        "crossing_cloths",
                                        "crossing_tetrahedra",
                                        "degenerate_soup",
                                        "duplicates",
                                        "fan",
                                        "figure_eight_tube",
                                        "folded_sheet",
                                        "hourglass",
                                        "moebius",
                                        "roll",
                                        "seam_cloth",
                                        "sphere",
                                        "touching_cubes",
                                        "twisted_strip"};
    for (size_t i = 0; i < sizeof(names) / sizeof(names[0]); ++i) {
        char path[64];
        soup mesh;
        sc_model *model;
        snprintf(path, sizeof(path), "meshes/%s.obj", names[i]);
        if (!CHECK_MSG(input_read_obj(path, &mesh), "%s", path)) continue;
        model = saved_model_build(&mesh, SC_WELD_REST, SC_PARTITION_FAST, SC_MODEL_FULL);
        if (model) check_round_trip(&mesh, model);
        sc_model_free(model);
        soup_free(&mesh);
    }
}

static void truncated(void)
{
    for (int which = 0; which < 2; ++which) {
        soup mesh;
        sc_model *model = saved_model_build_small(which, &mesh), *loaded;
        saved_model whole = saved_model_of(model), longer = saved_model_make(whole.size + 100, 0);
        for (uint64_t size = 0; size < whole.size; size += size < 300 ? 1 : 17) {
            /* a block of its own that ends there, so that reading on would show */
            unsigned char *bytes = (unsigned char *)test_allocate((size_t)size + 1);
            memcpy(bytes, whole.data, (size_t)size);
            bytes = (unsigned char *)realloc(bytes, size ? (size_t)size : 1);
            CHECK(bytes && sc_model_load(bytes, size, NULL, &loaded) == SC_ERROR_TRUNCATED);
            CHECK(loaded == NULL);
            free(bytes);
        }
        for (uint64_t size = 0; size < whole.size; size += 64) {
            saved_model part = saved_model_copy(&whole, size);
            saved_model_refuse(&part, SC_ERROR_TRUNCATED, "size", size);
            free(part.memory);
        }
        /* more than a model is fine */
        memset(longer.data, 0xee, (size_t)longer.size);
        memcpy(longer.data, whole.data, (size_t)whole.size);
        CHECK(saved_model_load(&longer, SC_LOAD_IN_PLACE, &loaded) == SC_OK);
        sc_model_free(loaded);
        free(longer.memory);
        free(whole.memory);
        sc_model_free(model);
        soup_free(&mesh);
    }
}

/* Every bit: all of the file is covered. */
static void changed(void)
{
    for (int which = 0; which < SAVED_MODEL_SMALL; ++which) {
        soup mesh;
        sc_model *model = saved_model_build_small(which, &mesh);
        saved_model s = saved_model_of(model);
        for (uint64_t at = 0; at < s.size; ++at)
            for (uint32_t bit = 0; bit < 8; bit += which == 0 ? 1 : 7) {
                sc_model *loaded;
                sc_status status, expected = SC_ERROR_CHECKSUM;
                s.data[at] = (unsigned char)(s.data[at] ^ (1u << bit));
                status = saved_model_load(&s, SC_LOAD_IN_PLACE, &loaded);
                if (at < offsetof(sc_saved_header, version)) expected = SC_ERROR_NOT_SAVED;
                /* version 2 with a bit changed is 0 or more; a larger size is not there */
                if (at >= offsetof(sc_saved_header, version) &&
                    at < offsetof(sc_saved_header, checksum))
                    expected = SC_ERROR_TOO_NEW;
                if (status == SC_ERROR_TOO_OLD && expected == SC_ERROR_TOO_NEW) expected = status;
                if (at >= offsetof(sc_saved_header, bytes) &&
                    at < offsetof(sc_saved_header, library) && status == SC_ERROR_TRUNCATED)
                    expected = status;
                CHECK_MSG(status == expected && loaded == NULL, "byte %" PRIu64 ": %s", at,
                          sc_status_string(status));
                s.data[at] = (unsigned char)(s.data[at] ^ (1u << bit));
            }
        free(s.memory);
        sc_model_free(model);
        soup_free(&mesh);
    }
}

static void foreign(void)
{
    soup mesh;
    sc_model *model = saved_model_build_small(1, &mesh);
    saved_model s = saved_model_of(model);
    static const unsigned char text[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    sc_saved_header *header = (sc_saved_header *)(void *)s.data;
    uint32_t version = header->version;
    unsigned char mark[4];
    saved_model other = saved_model_make(sizeof(text), 0);
    memcpy(other.data, text, sizeof(text));
    saved_model_refuse(&other, SC_ERROR_NOT_SAVED, "text", 0);
    free(other.memory);
    memcpy(mark, &header->byte_order, 4);
    for (int k = 0; k < 4; ++k) s.data[8 + k] = mark[3 - k];
    saved_model_refuse(&s, SC_ERROR_BYTE_ORDER, "byte order", 0);
    memset(s.data + 8, 9, 4);
    saved_model_refuse(&s, SC_ERROR_NOT_SAVED, "byte order", 1);
    memcpy(s.data + 8, mark, 4);
    header->version = version + 1;
    saved_model_refuse(&s, SC_ERROR_TOO_NEW, "version", version + 1);
    header->version = UINT32_MAX;
    saved_model_refuse(&s, SC_ERROR_TOO_NEW, "version", UINT32_MAX);
    header->version = version - 1;
    saved_model_refuse(&s, SC_ERROR_TOO_OLD, "version", version - 1);
    header->version = version;
    header->checksum ^= 1;
    saved_model_refuse(&s, SC_ERROR_CHECKSUM, "checksum", 0);
    free(s.memory);
    sc_model_free(model);
    soup_free(&mesh);
}

/* ---- arguments ---- */

static void *no_memory(void *user, uint64_t size, uint64_t alignment)
{
    (void)user;
    (void)size;
    (void)alignment;
    return NULL;
}

static void arguments(void)
{
    soup mesh;
    sc_model *model = saved_model_build_small(1, &mesh), *loaded;
    saved_model s = saved_model_of(model), off = saved_model_make(s.size, 8);
    uint64_t size = 7, written = 7;
    sc_load_options o;
    sc_model_info info;
    sc_hooks hooks;
    sc_allocator half;
    memcpy(off.data, s.data, (size_t)s.size);
    CHECK(sc_model_save_size(NULL, &size) == SC_ERROR_NULL && size == 7);
    CHECK(sc_model_save_size(model, NULL) == SC_ERROR_NULL);
    CHECK(sc_model_save(NULL, s.data, s.size, &written) == SC_ERROR_NULL && written == 0);
    CHECK(sc_model_save(model, NULL, s.size, &written) == SC_ERROR_NULL);
    CHECK(sc_model_save(model, NULL, 0, &written) == SC_ERROR_SHORT_BUFFER && written == s.size);
    CHECK(sc_model_save(model, off.data, s.size - 1, NULL) == SC_ERROR_SHORT_BUFFER);
    CHECK(memcmp(off.data, s.data, (size_t)s.size) == 0);
    memset(off.data, 0xcc, (size_t)s.size);
    CHECK(sc_model_save(model, off.data, s.size, NULL) == SC_OK); /* at any alignment */
    CHECK(memcmp(off.data, s.data, (size_t)s.size) == 0);

    CHECK(sc_model_load(s.data, s.size, NULL, NULL) == SC_ERROR_NULL);
    loaded = model;
    CHECK(sc_model_load(NULL, s.size, NULL, &loaded) == SC_ERROR_NULL && loaded == NULL);
    CHECK(saved_model_load(&off, SC_LOAD_IN_PLACE, &loaded) == SC_ERROR_ALIGNMENT &&
          loaded == NULL);
    CHECK(saved_model_load(&off, SC_LOAD_COPY, &loaded) == SC_OK);
    sc_model_free(loaded);
    free(off.memory);
    memset(&info, 0, sizeof(info));
    info.struct_size = sizeof(info);
    CHECK(sc_model_get_info(model, &info) == SC_OK && info.model_bytes == s.size);

    memset(&o, 0, sizeof(o));
    o.struct_size = 4;
    CHECK(sc_model_load(s.data, s.size, &o, &loaded) == SC_ERROR_STRUCT_SIZE);
    o.struct_size = 8; /* an older caller */
    CHECK(sc_model_load(s.data, s.size, &o, &loaded) == SC_OK);
    sc_model_free(loaded);
    o.struct_size = sizeof(o);
    o.mode = 2;
    CHECK(sc_model_load(s.data, s.size, &o, &loaded) == SC_ERROR_OPTION && loaded == NULL);
    o.mode = SC_LOAD_COPY;
    o.topology_hash = info.topology_hash;
    CHECK(sc_model_load(s.data, s.size, &o, &loaded) == SC_OK);
    sc_model_free(loaded);
    o.topology_hash ^= 1;
    CHECK(sc_model_load(s.data, s.size, &o, &loaded) == SC_ERROR_TOPOLOGY && loaded == NULL);
    o.topology_hash = 0;
    memset(&half, 0, sizeof(half));
    o.allocator = &half;
    CHECK(sc_model_load(s.data, s.size, &o, &loaded) == SC_ERROR_NULL);
    half.allocate = no_memory;
    CHECK(sc_model_load(s.data, s.size, &o, &loaded) == SC_ERROR_NULL);
    o.allocator = NULL;
    memset(&hooks, 0, sizeof(hooks));
    o.hooks = &hooks;
    CHECK(sc_model_load(s.data, s.size, &o, &loaded) == SC_ERROR_STRUCT_SIZE);
    hooks.struct_size = sizeof(hooks);
    hooks.reserved = 1;
    CHECK(sc_model_load(s.data, s.size, &o, &loaded) == SC_ERROR_OPTION);
    free(s.memory);
    sc_model_free(model);
    soup_free(&mesh);
}

/* ---- memory ---- */

typedef struct counter {
    uint64_t calls, live, fail_at;
} counter;

static void *count_allocate(void *user, uint64_t size, uint64_t alignment)
{
    counter *c = (counter *)user;
    void *memory = NULL;
    if (++c->calls == c->fail_at) return NULL;
    if (posix_memalign(&memory, (size_t)alignment, (size_t)size) != 0) return NULL;
    ++c->live;
    return memset(memory, 0xa5, (size_t)size);
}

static void count_release(void *user, void *memory, uint64_t size)
{
    (void)size;
    --((counter *)user)->live;
    free(memory);
}

static int dirt;

static void *dirty_allocate(void *user, uint64_t size, uint64_t alignment)
{
    void *memory = count_allocate(user, size, alignment);
    if (memory) memset(memory, dirt, (size_t)size);
    return memory;
}

/* Whatever stood in the memory that a build gets, no byte of the model comes of it. */
static void equal_bytes(void)
{
    for (int which = 0; which < 2 * SAVED_MODEL_SMALL; ++which) {
        static const int dirts[] = {0x5a, 0xff};
        saved_model saves[2];
        const char *name;
        soup mesh = shape_any(300, &name);
        sc_mesh m = input_plain_mesh(&mesh);
        for (int k = 0; k < 2; ++k) {
            counter c;
            sc_allocator allocator = {dirty_allocate, count_release, NULL};
            sc_build_options options;
            sc_model *model = NULL;
            memset(&c, 0, sizeof(c));
            allocator.user = &c;
            dirt = dirts[k];
            memset(&options, 0, sizeof(options));
            options.struct_size = sizeof(options);
            options.allocator = &allocator;
            options.content = which % 2 ? SC_MODEL_BOXES : SC_MODEL_FULL;
            CHECK(sc_build(&m, &options, &model) == SC_OK);
            saves[k] = saved_model_of(model);
            sc_model_free(model);
        }
        CHECK_MSG(saves[0].size == saves[1].size &&
                      memcmp(saves[0].data, saves[1].data, saves[0].size) == 0,
                  "%s", name);
        for (int k = 0; k < 2; ++k) free(saves[k].memory);
        soup_free(&mesh);
    }
}

static void every_allocation_fails(void)
{
    soup mesh;
    sc_model *model = saved_model_build_small(1, &mesh);
    saved_model s = saved_model_of(model);
    for (uint32_t mode = SC_LOAD_COPY; mode <= SC_LOAD_IN_PLACE; ++mode) {
        uint64_t needed = mode == SC_LOAD_COPY ? 2 : 1;
        for (uint64_t n = 1; n <= needed + 1; ++n) {
            counter c = {0, 0, n};
            sc_allocator allocator;
            sc_load_options o;
            sc_model *loaded = model;
            sc_status status;
            allocator.allocate = count_allocate;
            allocator.release = count_release;
            allocator.user = &c;
            memset(&o, 0, sizeof(o));
            o.struct_size = sizeof(o);
            o.mode = mode;
            o.allocator = &allocator;
            status = sc_model_load(s.data, s.size, &o, &loaded);
            memset(&allocator, 0, sizeof(allocator)); /* it was copied */
            CHECK(status == (n <= needed ? SC_ERROR_MEMORY : SC_OK));
            CHECK(c.live == (status == SC_OK && mode == SC_LOAD_COPY) &&
                  (loaded != NULL) == (status == SC_OK));
            sc_model_free(loaded);
            CHECK(c.live == 0 && c.calls == (n <= needed ? n : needed));
        }
    }
    /* nor does refusing leave anything */
    s.data[s.size - 1] ^= 1;
    for (uint32_t round = 0; round < 2; ++round) {
        counter c = {0, 0, 0};
        sc_allocator allocator = {count_allocate, count_release, NULL};
        sc_load_options o;
        sc_model *loaded = model;
        allocator.user = &c;
        memset(&o, 0, sizeof(o));
        o.struct_size = sizeof(o);
        o.allocator = &allocator;
        CHECK(sc_model_load(s.data, s.size, &o, &loaded) ==
              (round ? SC_ERROR_INCONSISTENT : SC_ERROR_CHECKSUM));
        CHECK(c.live == 0 && c.calls > 0 && loaded == NULL);
        s.data[sizeof(sc_saved_header) + model->offset[SC_ARRAY_triangle] + 3] = 0xff;
        saved_model_seal(&s);
    }
    free(s.memory);
    sc_model_free(model);
    soup_free(&mesh);
}

/* A model in memory that cannot be written, used by two threads. */
typedef struct thread_job {
    const sc_model *model, *original;
    const soup *mesh;
    saved_model_pairs list[4];
    int failed;
} thread_job;

static void *run_thread(void *argument)
{
    thread_job *job = (thread_job *)argument;
    sc_workspace *workspace = NULL;
    if (sc_workspace_create(job->model, NULL, &workspace) != SC_OK) return NULL;
    for (uint32_t i = 0; i < 40; ++i) {
        saved_model_pairs *wanted = &job->list[i % 4];
        sc_pair *pairs = (sc_pair *)test_allocate((size_t)wanted->count * sizeof(sc_pair));
        sc_pose pose = input_plain_pose(job->mesh->positions, job->mesh->vertex_count);
        sc_query_options options;
        sc_result result;
        memset(&options, 0, sizeof(options));
        options.struct_size = sizeof(options);
        options.pairs = i % 4 / 2;
        options.contact = i % 2;
        memset(&result, 0, sizeof(result));
        result.struct_size = sizeof(result);
        result.pairs = pairs;
        result.capacity = wanted->count;
        job->failed |= sc_query(job->model, workspace, &pose, &options, &result) != SC_OK ||
                       result.count != wanted->count ||
                       memcmp(pairs, wanted->pairs, (size_t)wanted->count * sizeof(sc_pair)) != 0;
        free(pairs);
    }
    sc_workspace_free(workspace);
    return NULL;
}

static void read_only_and_shared(void)
{
    soup cloth = soup_cloth(20, 20);
    sc_model *model, *loaded = NULL;
    saved_model s;
    size_t page = (size_t)sysconf(_SC_PAGESIZE), pages;
    void *mapped;
    soup_fold(cloth.positions, cloth.vertex_count);
    model = saved_model_build(&cloth, SC_WELD_NONE, SC_PARTITION_FAST, SC_MODEL_FULL);
    s = saved_model_of(model);
    pages = ((size_t)s.size + page - 1) / page * page;
    if (CHECK(posix_memalign(&mapped, page, pages) == 0)) {
        sc_load_options o;
        memcpy(mapped, s.data, (size_t)s.size);
        CHECK(mprotect(mapped, pages, PROT_READ) == 0);
        memset(&o, 0, sizeof(o));
        o.struct_size = sizeof(o);
        o.mode = SC_LOAD_IN_PLACE;
        if (CHECK(sc_model_load(mapped, s.size, &o, &loaded) == SC_OK)) {
            thread_job jobs[2];
            pthread_t threads[2];
            sc_workspace *workspace = NULL;
            memset(jobs, 0, sizeof(jobs));
            CHECK(sc_workspace_create(model, NULL, &workspace) == SC_OK);
            for (uint32_t kind = 0; kind < 4; ++kind)
                jobs[0].list[kind] = saved_model_ask(model, workspace, &cloth, cloth.positions,
                                                     SC_METHOD_AABB, kind);
            CHECK(jobs[0].list[0].count > 0);
            sc_workspace_free(workspace);
            jobs[0].model = loaded;
            jobs[0].mesh = &cloth;
            jobs[1] = jobs[0];
            for (int i = 0; i < 2; ++i)
                CHECK(pthread_create(&threads[i], NULL, run_thread, &jobs[i]) == 0);
            for (int i = 0; i < 2; ++i)
                CHECK(pthread_join(threads[i], NULL) == 0 && !jobs[i].failed);
            for (int kind = 0; kind < 4; ++kind) free(jobs[0].list[kind].pairs);
            sc_model_free(loaded);
        }
        CHECK(mprotect(mapped, pages, PROT_READ | PROT_WRITE) == 0);
        free(mapped);
    }
    free(s.memory);
    sc_model_free(model);
    soup_free(&cloth);
}

/* ---- the format ---- */

/*
 * The version of the format belongs to what is in the model. If this fails, the model's counts or
 * arrays changed: let lib/build/model_check.c check what is new, raise VERSION in
 * lib/build/saved_model.c if a version with the old ones was released, and write the new numbers
 * here.
 */
static void format(void)
{
    static const char arrays[] =
#define TEXT(name, type, count) #name " " #type " " #count ";"
        SC_MODEL_ARRAYS(TEXT)
#undef TEXT
        ;
    soup mesh;
    sc_model *model = saved_model_build_small(0, &mesh);
    saved_model s = saved_model_of(model);
    const sc_saved_header *header = (const sc_saved_header *)(const void *)s.data;
    uint64_t hash = 0;
    for (size_t i = 0; i + 1 < sizeof(arrays); ++i)
        hash = (hash ^ (unsigned char)arrays[i]) * 0x100000001b3u;
    CHECK_MSG(hash == UINT64_C(0xdd27f4e261b249d9), "0x%" PRIx64, hash);
    CHECK_MSG(sizeof(sc_model) == 368, "%zu", sizeof(sc_model));
    CHECK_MSG(sizeof(sc_node) == 24, "%zu", sizeof(sc_node));
    CHECK(header->version == 2);
    free(s.memory);
    sc_model_free(model);
    soup_free(&mesh);
}

SC_TEST_MAIN(SC_TEST(round_trips), SC_TEST(round_trips_of_mesh_files), SC_TEST(truncated),
             SC_TEST(changed), SC_TEST(foreign), SC_TEST(arguments), SC_TEST(equal_bytes),
             SC_TEST(every_allocation_fails), SC_TEST(read_only_and_shared), SC_TEST(format))
