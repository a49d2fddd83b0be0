/*
 * Masks of what is near on the mesh: they leave out what ignore_rings leaves out, on any mesh, for
 * any number of rings, by every method and whoever asks; and what is refused.
 *
 * SPDX-License-Identifier: MIT
 */
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "harness.h"
#include "inputs.h"
#include "near_ask.h"
#include "shapes.h"
#include "soups.h"
#include "starcontour.h"
#include "tasks.h"

/* A mesh in a pose. */
typedef struct scene {
    const char *name;
    soup mesh; /* the rest pose */
    double *posed;
    input_choices choices;
    sc_pose pose;
    sc_model *model;
    near_question q;
    sc_workspace *shared; /* for THREADS_MAX workers */
    double edge;
} scene;

/* Takes the mesh over. */
static int open_scene(scene *s, soup mesh, const char *name)
{
    sc_mesh input = input_plain_mesh(&mesh);
    memset(s, 0, sizeof *s);
    s->name = name;
    s->mesh = mesh;
    s->q.state = test_random_state();
    s->posed = soup_copy_positions(&mesh);
    if (test_random_below(3)) soup_any_pose(s->posed, mesh.vertex_count);
    s->choices = input_choose(&mesh, test_random_below(3), test_random_below(4));
    memset(&s->pose, 0, sizeof s->pose);
    s->pose.struct_size = sizeof s->pose;
    s->pose.vertex_count = mesh.vertex_count;
    s->pose.position_type = SC_DOUBLE;
    s->pose.positions = s->posed;
    if (!CHECK(sc_build(&input, &s->choices.options, &s->model) == SC_OK)) return 0;
    s->q.name = name;
    s->q.model = s->model;
    s->q.pose = &s->pose;
    s->q.workspace = near_workspace(s->model, 1);
    s->shared = near_workspace(s->model, THREADS_MAX);
    for (uint32_t t = 0; t < mesh.triangle_count; ++t) {
        const double *p = s->posed + 3 * (size_t)mesh.triangles[3 * t];
        const double *r = s->posed + 3 * (size_t)mesh.triangles[3 * t + 1];
        s->edge = fmax(s->edge, hypot(hypot(p[0] - r[0], p[1] - r[1]), p[2] - r[2]));
    }
    return s->q.workspace != NULL && s->shared != NULL;
}

static void close_scene(scene *s)
{
    sc_workspace_free(s->q.workspace);
    sc_workspace_free(s->shared);
    sc_model_free(s->model);
    input_free_choices(&s->choices);
    soup_free(&s->mesh);
    free(s->posed);
}

static sc_filter rings_filter(uint32_t rings)
{
    sc_filter filter;
    memset(&filter, 0, sizeof filter);
    filter.struct_size = sizeof filter;
    filter.ignore_rings = rings;
    return filter;
}

/* By masks and by a filter, and by both. */
static void check_rings(const scene *s, uint32_t rings, double distance, uint64_t *left_out)
{
    const sc_filter filter = rings_filter(rings), fewer = rings_filter(rings / 2);
    sc_near_options o = near_options_for(&near_ways[0], distance);
    sc_near_masks *masks = NULL;
    near_answer all, wanted;
    if (!CHECK(sc_near_masks_create(s->model, rings, NULL, &masks) == SC_OK)) return;
    all = near_ask_all(&s->q, &o);
    o.vertex_face_filter = o.edge_edge_filter = &filter;
    wanted = near_ask_all(&s->q, &o);
    *left_out += all.count[0] - wanted.count[0] + all.count[1] - wanted.count[1];
    near_answer_free(&all);
    for (int i = 0; i < NEAR_WAYS; ++i) {
        near_answer found;
        if (!near_way_is_there(&near_ways[i], s->model, s->q.workspace, &s->pose)) continue;
        o = near_options_for(&near_ways[i], distance);
        o.masks = masks;
        if (i % 3 == 1) o.edge_edge_filter = &fewer;
        if (i % 3 == 2) o.vertex_face_filter = &filter;
        found = near_ask_all(&s->q, &o);
        CHECK_MSG(near_answers_are_same(&wanted, &found),
                  "%s, %s, %" PRIu32 " rings, d %a: %" PRIu64 " and %" PRIu64
                  " pairs, by a filter %" PRIu64 " and %" PRIu64 "; state %" PRIu64,
                  s->name, near_ways[i].name, rings, distance, found.count[0], found.count[1],
                  wanted.count[0], wanted.count[1], s->q.state);
        near_answer_free(&found);
    }
    near_answer_free(&wanted);
    sc_near_masks_free(masks);
}

static void masks_are_rings(void)
{
    uint64_t left_out = 0;
    for (uint32_t trial = test_iterations_at_least(200, 40); trial-- > 0 && !test_failures();) {
        const uint32_t rings = trial % 10 ? 1 + test_random_below(8) : SC_RINGS_MAX;
        const char *name;
        soup mesh = trial % 5 == 0   ? shape_hub(3 + test_random_below(200))
                    : trial % 5 == 1 ? soup_cloth(3 + test_random_below(14), 12)
                                     : shape_any(2 + test_random_below(300), &name);
        scene s;
        if (open_scene(&s, mesh, trial % 5 == 0 ? "hub" : trial % 5 == 1 ? "cloth" : name))
            check_rings(&s, rings, s.edge * test_random_range(0.1, 2.5), &left_out);
        close_scene(&s);
    }
    CHECK_MSG(left_out > 1000, "%" PRIu64 " pairs left out", left_out);
}

static void many_workers(void)
{
    for (uint32_t trial = test_iterations_at_least(8, 4); trial-- > 0;) {
        sc_near_options o;
        sc_near_masks *masks = NULL;
        near_answer alone, together;
        near_question shared;
        scene s;
        host h;
        if (!open_scene(&s, soup_cloth(40, 40), "cloth")) return;
        CHECK(sc_near_masks_create(s.model, 1 + trial % SC_RINGS_MAX, NULL, &masks) == SC_OK);
        o = near_options_for(&near_ways[0], s.edge);
        o.masks = masks;
        alone = near_ask_all(&s.q, &o);
        host_start(&h, HOST_FIRST + (int)(trial % (HOST_COUNT - HOST_FIRST)), THREADS_MAX);
        shared = s.q;
        shared.workspace = s.shared;
        o.tasks = &h.tasks;
        together = near_ask_all(&shared, &o);
        CHECK(near_answers_are_same(&alone, &together));
        host_stop(&h);
        near_answer_free(&alone);
        near_answer_free(&together);
        sc_near_masks_free(masks);
        close_scene(&s);
    }
}

/* An allocator that fails after some calls, and counts. */
typedef struct counter {
    uint32_t left;
    int64_t blocks;
} counter;

static void *allocate_some(void *user, uint64_t bytes, uint64_t alignment)
{
    counter *c = (counter *)user;
    unsigned char *memory, *aligned;
    if (c->left == 0) return NULL;
    c->left--;
    memory = (unsigned char *)test_allocate((size_t)(bytes + 2 * alignment));
    aligned = memory + alignment - (uintptr_t)memory % alignment; /* 1 byte behind it at least */
    aligned[-1] = (unsigned char)(aligned - memory);
    c->blocks++;
    return aligned;
}

static void release_some(void *user, void *memory, uint64_t bytes)
{
    unsigned char *aligned = (unsigned char *)memory;
    (void)bytes;
    ((counter *)user)->blocks--;
    free(aligned - aligned[-1]);
}

static void what_is_refused(void)
{
    sc_near_masks *masks = NULL, *others = NULL;
    sc_model *twin = NULL; /* of the same mesh and partition */
    sc_near_options o;
    sc_mesh input;
    near_answer a;
    scene s;
    if (!open_scene(&s, soup_cloth(12, 12), "cloth")) return;
    input = input_plain_mesh(&s.mesh);
    if (!CHECK(sc_build(&input, &s.choices.options, &twin) == SC_OK)) return;
    CHECK(sc_near_masks_create(NULL, 2, NULL, &masks) == SC_ERROR_NULL && !masks);
    CHECK(sc_near_masks_create(s.model, 2, NULL, NULL) == SC_ERROR_NULL);
    CHECK(sc_near_masks_create(s.model, 0, NULL, &masks) == SC_ERROR_OPTION && !masks);
    CHECK(sc_near_masks_create(s.model, SC_RINGS_MAX + 1, NULL, &masks) == SC_ERROR_OPTION);
    {
        counter c = {1000, 0};
        sc_allocator half;
        memset(&half, 0, sizeof half);
        half.allocate = allocate_some;
        half.user = &c;
        CHECK(sc_near_masks_create(s.model, 2, &half, &masks) == SC_ERROR_NULL && !masks);
        CHECK(c.left == 1000 && c.blocks == 0); /* nothing is asked of it */
    }
    sc_near_masks_free(NULL);
    CHECK(sc_near_masks_create(twin, 2, NULL, &others) == SC_OK);
    o = near_options_for(&near_ways[0], s.edge);
    o.masks = others;
    a = near_ask(&s.q, &o, 10, 10);
    CHECK(a.status == SC_ERROR_OPTION);
    near_answer_free(&a);
    sc_near_masks_free(others);
    for (uint32_t calls = 0;; ++calls) {
        counter c = {calls, 0};
        sc_allocator allocator;
        sc_status status;
        memset(&allocator, 0, sizeof allocator);
        allocator.allocate = allocate_some;
        allocator.release = release_some;
        allocator.user = &c;
        status = sc_near_masks_create(s.model, 3, &allocator, &masks);
        CHECK(status == SC_OK || (status == SC_ERROR_MEMORY && !masks && c.blocks == 0));
        if (status) continue;
        CHECK(c.blocks == 1 && calls > 3);
        sc_near_masks_free(masks);
        CHECK(c.blocks == 0);
        break;
    }
    close_scene(&s);
    sc_model_free(twin);
}

SC_TEST_MAIN(SC_TEST(masks_are_rings), SC_TEST(many_workers), SC_TEST(what_is_refused))
