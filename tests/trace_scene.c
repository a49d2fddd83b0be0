/*
 * Scenes for tests of contours. See trace_scene.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "trace_scene.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "harness.h"

sc_trace_result trace_scene_no_room(void)
{
    sc_trace_result r;
    memset(&r, 0, sizeof r);
    r.struct_size = sizeof r;
    return r;
}

sc_pair *trace_scene_find_pairs(const sc_model *model, const sc_pose *pose, uint64_t *count)
{
    sc_query_options options = input_query(SC_PAIRS_EDGE, SC_CONTACT_TOUCHING, SC_METHOD_DEFAULT);
    sc_workspace *workspace = NULL;
    sc_result r;
    sc_pair *pairs = NULL;
    memset(&r, 0, sizeof r);
    r.struct_size = sizeof r;
    *count = 0;
    if (!CHECK(sc_workspace_create(model, NULL, &workspace) == SC_OK)) return NULL;
    sc_query(model, workspace, pose, &options, &r);
    pairs = (sc_pair *)test_allocate(r.count * sizeof *pairs);
    r.pairs = pairs;
    r.capacity = r.count;
    CHECK(sc_query(model, workspace, pose, &options, &r) == SC_OK);
    *count = r.count;
    sc_workspace_free(workspace);
    return pairs;
}

int trace_scene_trace(const sc_model *model, const sc_pose *pose, const sc_pair *pairs,
                      uint64_t count, const sc_trace_options *options, sc_trace_result *result)
{
    sc_status status;
    *result = trace_scene_no_room();
    status = sc_trace(model, pose, pairs, count, options, result);
    if (!CHECK_MSG(status == (result->node_count ? SC_ERROR_SHORT_BUFFER : SC_OK), "%s",
                   sc_status_string(status)))
        return 0;
    result->nodes = (sc_trace_node *)test_allocate(result->node_count * sizeof *result->nodes);
    result->contours =
        (sc_trace_contour *)test_allocate(result->contour_count * sizeof *result->contours);
    result->node_capacity = result->node_count;
    result->contour_capacity = result->contour_count;
    status = sc_trace(model, pose, pairs, count, options, result);
    return CHECK_MSG(status == SC_OK, "%s", sc_status_string(status)) &&
           CHECK(result->node_count == result->node_capacity &&
                 result->contour_count == result->contour_capacity);
}

void trace_scene_free_result(sc_trace_result *result)
{
    free(result->nodes);
    free(result->contours);
}

int trace_scene_open(trace_scene *s, soup mesh, uint32_t content)
{
    sc_build_options options;
    memset(s, 0, sizeof *s);
    memset(&options, 0, sizeof options);
    options.struct_size = sizeof options;
    options.weld = SC_WELD_NONE;
    options.content = content;
    s->mesh = mesh;
    s->input = input_plain_mesh(&s->mesh);
    s->pose = input_plain_pose(s->mesh.positions, s->mesh.vertex_count);
    if (!CHECK(sc_build(&s->input, &options, &s->model) == SC_OK)) return 0;
    s->pairs = trace_scene_find_pairs(s->model, &s->pose, &s->count);
    return CHECK(s->pairs) &&
           trace_scene_trace(s->model, &s->pose, s->pairs, s->count, NULL, &s->result);
}

void trace_scene_close(trace_scene *s)
{
    trace_scene_free_result(&s->result);
    free(s->pairs);
    sc_model_free(s->model);
    soup_free(&s->mesh);
}

soup trace_scene_cloths(uint32_t across)
{
    soup one = soup_cloth(across, across), two = soup_cloth(across, across), both;
    soup_smooth(one.positions, one.vertex_count, 0.1);
    soup_smooth(two.positions, two.vertex_count, 0.1);
    soup_noise(one.positions, one.vertex_count, 0.3 / across);
    soup_noise(two.positions, two.vertex_count, 0.3 / across);
    both = soup_join(&one, &two);
    soup_free(&one);
    soup_free(&two);
    return both;
}

soup trace_scene_strips(uint32_t stations, uint32_t turns)
{
    soup s = soup_make(4 * stations, 4 * stations);
    uint32_t *t = s.triangles;
    for (uint32_t i = 0; i < stations; ++i)
        for (uint32_t k = 0; k < 4; ++k) {
            const double round = 6.283185307179586 * i / stations;
            const double angle = 1.5707963267948966 * (k + (double)turns * i / stations);
            const double out = 3 + cos(angle);
            double *p = s.positions + 3 * (size_t)(4 * i + k);
            p[0] = out * cos(round);
            p[1] = out * sin(round);
            p[2] = sin(angle);
        }
    soup_noise(s.positions, s.vertex_count, 0.01);
    for (uint32_t i = 0; i < stations; ++i)
        for (uint32_t strip = 0; strip < 2; ++strip) {
            const uint32_t next = (i + 1) % stations, shift = next ? 0 : turns;
            const uint32_t a = 4 * i + strip, b = a + 2, c = 4 * next + (strip + shift) % 4,
                           d = 4 * next + (strip + shift + 2) % 4;
            const uint32_t corner[6] = {a, b, c, b, d, c};
            memcpy(t, corner, sizeof corner);
            t += 6;
        }
    return s;
}

static void *allocate_scarce(void *user, uint64_t bytes, uint64_t alignment)
{
    scarce_memory *m = (scarce_memory *)user;
    unsigned char *block, *memory;
    if (m->left)
        --m->left;
    else if (m->cancels)
        m->cancelled = 1;
    else
        return NULL;
    ++m->live;
    /* Not every system has an aligned malloc: the block is kept in front of what is handed out. */
    block = (unsigned char *)test_allocate((size_t)(bytes + alignment + sizeof(void *)));
    memory = block + sizeof(void *);
    memory += (0u - (uintptr_t)memory) & (uintptr_t)(alignment - 1);
    memcpy(memory - sizeof(void *), &block, sizeof block);
    return memory;
}

static void release_scarce(void *user, void *memory, uint64_t bytes)
{
    (void)bytes;
    --((scarce_memory *)user)->live;
    memcpy(&memory, (unsigned char *)memory - sizeof(void *), sizeof memory);
    free(memory);
}

void scarce_memory_start(scarce_memory *memory, uint32_t left)
{
    memset(memory, 0, sizeof *memory);
    memory->allocator.user = memory;
    memory->allocator.allocate = allocate_scarce;
    memory->allocator.release = release_scarce;
    memory->left = left;
}
