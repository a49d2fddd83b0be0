/*
 * See saved_models.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "saved_models.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "base/saved.h"
#include "harness.h"
#include "inputs.h"

saved_model saved_model_make(uint64_t size, uint32_t offset)
{
    saved_model s;
    s.size = size;
    s.memory = test_allocate((size_t)size + 2 * SC_ALIGNMENT);
    s.data = (unsigned char *)s.memory + SC_ALIGNMENT - (uintptr_t)s.memory % SC_ALIGNMENT + offset;
    return s;
}

saved_model saved_model_copy(const saved_model *from, uint64_t size)
{
    saved_model s = saved_model_make(size, 0);
    memcpy(s.data, from->data, (size_t)size);
    return s;
}

saved_model saved_model_of(const sc_model *model)
{
    uint64_t size = 0, written = 0;
    saved_model s;
    CHECK(sc_model_save_size(model, &size) == SC_OK);
    s = saved_model_make(size, 0);
    s.data[size] = 0x77;
    CHECK(sc_model_save(model, s.data, size, &written) == SC_OK && written == size);
    CHECK(s.data[size] == 0x77);
    return s;
}

sc_model *saved_model_build(const soup *mesh, uint32_t weld, uint32_t partition, uint32_t content)
{
    sc_mesh m = input_plain_mesh(mesh);
    input_choices choices = input_choose(mesh, weld, partition);
    sc_model *model = NULL;
    choices.options.content = content;
    if (content == SC_MODEL_BOXES) choices.options.rest = SC_REST_UNMARKED;
    CHECK(sc_build(&m, &choices.options, &model) == SC_OK);
    input_free_choices(&choices);
    return model;
}

sc_status saved_model_load(const saved_model *s, uint32_t mode, sc_model **model)
{
    sc_load_options options;
    memset(&options, 0, sizeof(options));
    options.struct_size = sizeof(options);
    options.mode = mode;
    return sc_model_load(s->data, s->size, &options, model);
}

saved_model_pairs saved_model_ask(const sc_model *model, sc_workspace *workspace, const soup *mesh,
                                  const double *positions, uint32_t method, uint32_t kind)
{
    sc_pose pose = input_plain_pose(positions, mesh->vertex_count);
    sc_query_options options;
    sc_result result;
    saved_model_pairs list = {NULL, 0};
    memset(&options, 0, sizeof(options));
    options.struct_size = sizeof(options);
    options.method = model->node_count ? method : SC_METHOD_DEFAULT; /* for boxes: one method */
    options.pairs = kind / 2;
    options.contact = kind % 2;
    memset(&result, 0, sizeof(result));
    result.struct_size = sizeof(result);
    sc_query(model, workspace, &pose, &options, &result);
    list.pairs = (sc_pair *)test_allocate((size_t)result.count * sizeof(sc_pair));
    list.count = result.capacity = result.count;
    result.pairs = list.pairs;
    CHECK(sc_query(model, workspace, &pose, &options, &result) == SC_OK);
    CHECK(result.count == list.count);
    return list;
}

uint64_t saved_model_compare_pairs(const sc_model *a, sc_workspace *of_a, const sc_model *b,
                                   sc_workspace *of_b, const soup *mesh, const double *positions)
{
    uint64_t found = 0;
    for (uint32_t method = 1; method <= SC_METHOD_AABB; ++method)
        for (uint32_t kind = 0; kind < 4; ++kind) {
            saved_model_pairs p = saved_model_ask(a, of_a, mesh, positions, method, kind);
            saved_model_pairs q = saved_model_ask(b, of_b, mesh, positions, method, kind);
            CHECK_MSG(p.count == q.count &&
                          (p.count == 0 ||
                           memcmp(p.pairs, q.pairs, (size_t)p.count * sizeof(sc_pair)) == 0),
                      "method %" PRIu32 ", kind %" PRIu32 ": %" PRIu64 " and %" PRIu64 " pairs",
                      method, kind, p.count, q.count);
            found += p.count;
            free(p.pairs);
            free(q.pairs);
        }
    return found;
}

sc_model *saved_model_build_small(int which, soup *mesh)
{
    if (which == 0) {
        *mesh = soup_make(3, 1);
        for (uint32_t i = 0; i < 9; ++i) mesh->positions[i] = i % 4 == 0;
        for (uint32_t i = 0; i < 3; ++i) mesh->triangles[i] = i;
    } else {
        *mesh = which == 2   ? soup_pinched(3)
                : which == 4 ? soup_annulus(4, 1) /* contours in pieces */
                             : soup_cloth(8, 7);
    }
    return saved_model_build(mesh, SC_WELD_REST, SC_PARTITION_FAST,
                             which == 3 ? SC_MODEL_BOXES : SC_MODEL_FULL);
}

void saved_model_refuse(const saved_model *s, sc_status expected, const char *what, uint64_t at)
{
    for (uint32_t mode = SC_LOAD_COPY; mode <= SC_LOAD_IN_PLACE; ++mode) {
        sc_model *model = (sc_model *)s->memory; /* anything but NULL */
        sc_status status = saved_model_load(s, mode, &model);
        CHECK_MSG(status == expected && model == NULL, "%s %" PRIu64 ": %s", what, at,
                  sc_status_string(status));
    }
}

void saved_model_seal(saved_model *s)
{
    sc_saved_header *header = (sc_saved_header *)(void *)s->data;
    char magic[8];
    memcpy(magic, header->magic, sizeof(magic));
    sc_saved_seal(header, magic, header->version, s->size, s->data + sizeof(*header));
}
