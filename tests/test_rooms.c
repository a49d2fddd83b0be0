/*
 * Workspaces that use the room of another one: how small they are, what is refused, and that all
 * say the same as workspaces that have their own, whatever was asked of the others in between.
 *
 * SPDX-License-Identifier: MIT
 */
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "harness.h"
#include "object_ask.h"
#include "object_scenes.h"
#include "run/workspace.h"
#include "soups.h"
#include "starcontour.h"
#include "tasks.h"

/* ---- making them ---- */

static sc_status create(const sc_model *model, uint32_t workers, uint32_t flags, sc_workspace *room,
                        sc_workspace **workspace)
{
    sc_workspace_options options = options_for_workers(workers);
    options.flags = flags;
    options.room = room;
    return sc_workspace_create_for(model, &options, workspace);
}

static uint64_t size_of(const sc_model *model, uint32_t workers, uint32_t flags, sc_workspace *room)
{
    sc_workspace_options options = options_for_workers(workers);
    uint64_t size = 0;
    options.flags = flags;
    options.room = room;
    CHECK(sc_workspace_size_for(model, &options, &size) == SC_OK);
    return size;
}

/* A quarter of what a workspace with a room of its own takes, however many workers there are. */
static void they_are_small(void)
{
    fixture f;
    if (fixture_start(&f, soup_sphere(100, 50), 0.3, 0)) {
        for (uint32_t flags = 0; flags <= SC_WORKSPACE_NEAR; ++flags) {
            uint64_t small[2];
            for (uint32_t k = 0; k < 2; ++k) {
                const uint32_t workers = k ? 8 : 1;
                const uint64_t own = size_of(f.model, workers, flags, NULL);
                sc_workspace *room = NULL;
                if (!CHECK(create(f.model, workers, flags | SC_WORKSPACE_ROOM, NULL, &room) ==
                           SC_OK))
                    continue;
                small[k] = size_of(f.model, workers, flags, room);
                CHECK_MSG(small[k] < own / (flags ? 2 : 3) && (!k || small[k] < own / 4),
                          "%" PRIu64 " of %" PRIu64 " bytes, flags %u, %u workers", small[k], own,
                          flags, workers);
                CHECK(size_of(f.model, workers, flags | SC_WORKSPACE_ROOM, NULL) < 2 * own);
                sc_workspace_free(room);
            }
            CHECK(small[0] == small[1]);
        }
    }
    fixture_stop(&f);
}

static void others_are_refused(void)
{
    fixture f, other;
    sc_workspace *room = NULL, *plain = NULL, *small = NULL, *wrong = NULL;
    const int started = fixture_start(&f, soup_cloth(8, 8), 0, 0);
    if (fixture_start(&other, soup_cloth(8, 7), 0, 0) && started &&
        CHECK(create(f.model, 2, SC_WORKSPACE_STEP | SC_WORKSPACE_ROOM, NULL, &room) == SC_OK) &&
        CHECK(create(f.model, 2, SC_WORKSPACE_STEP, NULL, &plain) == SC_OK) &&
        CHECK(create(f.model, 2, SC_WORKSPACE_STEP, room, &small) == SC_OK)) {
        unsigned char *memory = (unsigned char *)test_allocate(4096);
        sc_workspace_options o = options_for_workers(2);
        sc_workspace *const two[] = {room, small};
        sc_query_options options = no_options();
        sc_result result;
        sc_status status;
        host h;
        CHECK(create(other.model, 2, SC_WORKSPACE_STEP, room, &wrong) == SC_ERROR_WORKSPACE);
        CHECK(create(f.model, 1, SC_WORKSPACE_STEP, room, &wrong) == SC_ERROR_OPTION);
        CHECK(create(f.model, 2, 0, room, &wrong) == SC_ERROR_OPTION);
        CHECK(create(f.model, 2, SC_WORKSPACE_NEAR, room, &wrong) == SC_ERROR_OPTION);
        CHECK(create(f.model, 2, SC_WORKSPACE_STEP, plain, &wrong) == SC_ERROR_OPTION);
        CHECK(create(f.model, 2, SC_WORKSPACE_STEP, small, &wrong) == SC_ERROR_OPTION);
        CHECK(create(f.model, 2, SC_WORKSPACE_STEP | SC_WORKSPACE_ROOM, room, &wrong) ==
              SC_ERROR_OPTION);
        CHECK(create(f.model, 2, 8, NULL, &wrong) == SC_ERROR_OPTION);
        CHECK(wrong == NULL);
        o.flags = SC_WORKSPACE_STEP;
        o.room = room;
        CHECK(sc_workspace_init_for(f.model, &o,
                                    memory + SC_ALIGNMENT - (uintptr_t)memory % SC_ALIGNMENT, 1000,
                                    &wrong) == SC_ERROR_WORKSPACE);
        /* two that have one room do not serve two workers of a batch */
        memset(&result, 0, sizeof result);
        result.struct_size = sizeof result;
        host_start(&h, HOST_FIRST, 2);
        options.tasks = &h.tasks;
        CHECK(sc_query_batch(f.model, two, &f.pose, 1, &options, &result, &status) ==
              SC_ERROR_WORKSPACE);
        host_stop(&h);
        free(memory);
    }
    sc_workspace_free(small);
    sc_workspace_free(plain);
    sc_workspace_free(room);
    fixture_stop(&f);
    fixture_stop(&other);
}

/* ---- the same answers ---- */

/* Objects of a scene, all of which have rooms of their own. */
typedef struct separate {
    sc_object objects[OBJECTS_MAX];
} separate;

static int separate_open(separate *own, const scene *s)
{
    for (uint32_t i = 0; i < s->count; ++i) {
        own->objects[i] = s->objects[i];
        own->objects[i].pose_version = 0;
        if (!CHECK(create(s->things[i].model, s->workers, s->flags, NULL,
                          &own->objects[i].workspace) == SC_OK))
            return 0;
    }
    return 1;
}

static void separate_close(const separate *own, const scene *s)
{
    for (uint32_t i = 0; i < s->count; ++i) sc_workspace_free(own->objects[i].workspace);
}

static sc_objects all_of(const scene *s, const sc_object *objects)
{
    sc_objects all;
    memset(&all, 0, sizeof all);
    all.struct_size = sizeof all;
    all.count = s->count;
    all.objects = objects;
    return all;
}

/* A scene in which most objects are copies of one that lends its room. */
static int open_crowd(scene *s, uint32_t count, const soup *mesh, uint32_t workers)
{
    memset(s, 0, sizeof *s);
    s->state = test_random_state();
    s->workers = workers;
    s->flags = SC_WORKSPACE_NEAR;
    for (; s->count < count; ++s->count)
        if (!scene_open_thing_of(s, s->count, s->count ? NULL : mesh)) return 0;
    for (uint32_t i = 0; i < count; ++i) {
        s->things[i].lender = i % 5 < 4; /* the first; or nobody's */
        s->objects[i].pose_version = 1 + i % 3;
        s->objects[i].group.category = s->objects[i].group.mask = 0;
    }
    if (!scene_renew_work(s)) return 0;
    if (test_random_below(2)) { /* the last one lends */
        thing *const first = &s->things[0], *const last = &s->things[count - 1];
        sc_workspace *const work = first->workspace;
        first->workspace = s->objects[0].workspace = last->workspace;
        last->workspace = s->objects[count - 1].workspace = work;
    }
    return 1;
}

/* Asks both about all objects, by several workers or by one (tasks: HOST_..., or -1). */
static void ask_both(scene *s, separate *own, object_question q, int way)
{
    const sc_objects objects = all_of(s, s->objects), others = all_of(s, own->objects);
    uint64_t capacity[2] = {0, 0};
    object_answer x, y;
    host h;
    for (uint32_t i = 0; i < s->count; ++i)
        s->objects[i].end = own->objects[i].end =
            q.about == OBJECTS_STEP ? &s->things[i].pose[1] : NULL;
    host_start(&h, way < 0 ? HOST_FIRST : way, s->workers);
    object_question_set_output(&q, SC_OUTPUT_COUNT);
    object_ask(&others, &q, NULL, capacity, &y);
    for (int kind = 0; kind < 2; ++kind) capacity[kind] = y.list[kind].count;
    object_answer_forget(&y);
    object_question_set_output(&q, SC_OUTPUT_PAIRS);
    object_ask(&others, &q, NULL, capacity, &y);
    object_ask(&objects, &q, way < 0 ? NULL : &h.tasks, capacity, &x);
    CHECK_MSG(x.status == SC_OK && object_answers_are_same(&q, &x, &y),
              "%s, about %d, way %d, state %" PRIu64, sc_status_string(x.status), q.about, way,
              s->state);
    CHECK(h.mistakes == 0);
    host_stop(&h);
    object_answer_forget(&x);
    object_answer_forget(&y);
}

/* Asks both about one object, whose workspace forgets what it knew of it as an object. */
static void ask_one(const scene *s, const separate *own, uint32_t i, uint64_t *pairs)
{
    static const uint32_t contours[] = {SC_CONTOUR_EXACT, SC_CONTOUR_STAR};
    const sc_model *model = s->things[i].model;
    const sc_pose *pose = &s->things[i].pose[0];
    sc_workspace *const work[2] = {s->objects[i].workspace, own->objects[i].workspace};
    sc_query_options options = no_options();
    sc_near_options near;
    sc_result result[2];
    sc_near_result lists[2];
    memset(&near, 0, sizeof near);
    near.struct_size = sizeof near;
    near.output = SC_OUTPUT_COUNT;
    near.distance = 0.1;
    options.contour = contours[test_random_below(2)];
    if (test_random_below(2)) options.method = SC_METHOD_SCTT;
    memset(result, 0, sizeof result);
    memset(lists, 0, sizeof lists);
    for (int k = 0; k < 2; ++k) {
        result[k].struct_size = sizeof result[k];
        result[k].capacity = 500000;
        result[k].pairs = (sc_pair *)test_allocate(sizeof(sc_pair) * result[k].capacity);
        lists[k].struct_size = sizeof lists[k];
        CHECK(sc_query(model, work[k], pose, &options, &result[k]) == SC_OK);
        CHECK(sc_query_near(model, work[k], pose, &near, &lists[k]) == SC_OK);
    }
    CHECK(result[0].count == result[1].count &&
          memcmp(result[0].pairs, result[1].pairs, result[0].count * sizeof(sc_pair)) == 0);
    CHECK(lists[0].vertex_face_count == lists[1].vertex_face_count &&
          lists[0].edge_edge_count == lists[1].edge_edge_count);
    *pairs += result[0].count;
    for (int k = 0; k < 2; ++k) free(result[k].pairs);
}

/* Poses some objects anew; the others keep what is known of them. */
static void move_some(scene *s)
{
    for (uint32_t i = 0; i < s->count; ++i)
        if (test_random_below(3) == 0) {
            scene_pose_thing(s, i);
            s->objects[i].pose_version += 3;
        }
}

static int any_way(const scene *s)
{
    if (s->workers == 1 || test_random_below(2)) return -1;
    return HOST_FIRST + (int)test_random_below(HOST_COUNT - HOST_FIRST);
}

/* Whatever is asked between, and when epochs begin anew. */
static void they_answer_as_others_do(void)
{
    uint64_t pairs = 0, rounds = 0;
    for (uint32_t trial = test_iterations_at_least(8, 8); trial-- > 0 && !test_failures();) {
        const uint32_t count = 2 + test_random_below(4);
        const soup mesh = trial % 2 ? soup_sphere(12, 8 + test_random_below(8))
                                    : soup_cloth(12, 8 + test_random_below(8));
        separate own;
        scene s;
        if (!open_crowd(&s, count, &mesh, trial % 4 ? 3 : 1) || !separate_open(&own, &s)) return;
        for (int call = 0; call < 10; ++call) {
            sc_workspace *room = s.things[0].workspace->room;
            if (call == 4) room->epochs = 0x7fffffff - test_random_below(2);
            if (test_random_below(3)) ask_both(&s, &own, object_question_any(), any_way(&s));
            if (test_random_below(3) == 0) ask_one(&s, &own, test_random_below(count), &pairs);
            move_some(&s);
            rounds += room->rounds;
        }
        separate_close(&own, &s);
        scene_close(&s);
    }
    CHECK_MSG(pairs > 100 && rounds > 10, "%" PRIu64 " pairs, %" PRIu64, pairs, rounds);
}

/* Many of one room, each by a thread. */
static void threads_have_parts_of_it(void)
{
    for (uint32_t trial = test_iterations_at_least(5, 5); trial-- > 0 && !test_failures();) {
        const soup mesh = soup_sphere(16, 12);
        object_question q = object_question_any();
        separate own;
        scene s;
        q.about = OBJECTS_QUERY; /* the quickest */
        if (!open_crowd(&s, OBJECTS_MAX, &mesh, 4) || !separate_open(&own, &s)) return;
        for (uint32_t i = 0; i < s.count; ++i) { /* none with another */
            s.objects[i].itself = own.objects[i].itself = 1;
            s.objects[i].group.category = own.objects[i].group.category = 1;
            s.objects[i].group.mask = own.objects[i].group.mask = 2;
        }
        for (int call = 0; call < 2; ++call) ask_both(&s, &own, q, HOST_THREADS);
        separate_close(&own, &s);
        scene_close(&s);
    }
}

/* What is asked between two calls about an object that stays. */
enum { STAR, SORTED, STEP_ALONE, NEAR_OBJECTS, EPOCHS, BETWEEN_COUNT };

static void ask_between(scene *s, int what)
{
    const sc_model *model = s->things[0].model;
    sc_workspace *const work = s->things[0].workspace;
    const sc_pose *pose = s->things[0].pose;
    const uint64_t most[2] = {100000, 100000};
    sc_objects objects = all_of(s, s->objects);
    sc_query_options options = no_options();
    object_question q = object_question_any();
    sc_step_options step;
    sc_step_result collisions;
    sc_result result;
    object_answer a;
    memset(&step, 0, sizeof step);
    memset(&collisions, 0, sizeof collisions);
    memset(&result, 0, sizeof result);
    step.struct_size = sizeof step;
    collisions.struct_size = sizeof collisions;
    result.struct_size = sizeof result;
    result.capacity = 500000;
    result.pairs = (sc_pair *)test_allocate(sizeof(sc_pair) * result.capacity);
    options.method = SC_METHOD_SCTT;
    options.contour = what == STAR ? SC_CONTOUR_STAR : SC_CONTOUR_EXACT;
    step.output = SC_OUTPUT_COUNT;
    objects.count = 1;
    q.about = what == NEAR_OBJECTS ? OBJECTS_NEAR : OBJECTS_QUERY;
    q.near.distance = 0.1;
    s->objects[0].pose_version = 0;
    if (what == EPOCHS) work->room->epochs = 0x7fffffff;
    if (what == STAR || what == SORTED)
        CHECK(sc_query(model, work, pose, &options, &result) == SC_OK);
    else if (what == STEP_ALONE)
        CHECK(sc_query_step(model, work, pose, pose + 1, &step, &collisions) == SC_OK);
    else {
        object_ask(&objects, &q, NULL, most, &a);
        CHECK(a.status == SC_OK || a.status == SC_ERROR_SHORT_BUFFER);
        object_answer_forget(&a);
    }
    free(result.pairs);
}

/* An object that stays is asked about again, and in between one that has the same room: what is in
   that is the other's then, or something else; and where epochs begin anew, of the same epoch. */
static void what_others_leave_is_not_taken(void)
{
    uint64_t pairs = 0;
    for (uint32_t trial = test_iterations_at_least(60, 30); trial-- > 0 && !test_failures();) {
        const soup mesh = soup_cloth(12, 8 + test_random_below(12));
        const uint64_t most[2] = {500000, 0};
        object_question q = object_question_any();
        sc_objects objects;
        object_answer before, after;
        scene s;
        if (!open_crowd(&s, 2, &mesh, 1)) return;
        objects = all_of(&s, &s.objects[1]);
        objects.count = 1;
        q.about = OBJECTS_QUERY;
        q.query.method = SC_METHOD_SCTT;
        s.objects[1].itself = s.objects[0].itself = 1;
        object_ask(&objects, &q, NULL, most, &before);
        ask_between(&s, (int)(trial % BETWEEN_COUNT));
        object_ask(&objects, &q, NULL, most, &after);
        CHECK_MSG(before.status == SC_OK && object_answers_are_same(&q, &before, &after),
                  "%" PRIu64 " and %" PRIu64 " pairs, between %d, state %" PRIu64,
                  before.list[0].count, after.list[0].count, (int)(trial % BETWEEN_COUNT), s.state);
        pairs += before.list[0].count;
        object_answer_forget(&before);
        object_answer_forget(&after);
        scene_close(&s);
    }
    CHECK_MSG(pairs > 1000, "%" PRIu64 " pairs", pairs);
}

/* Two of one room that are large enough to be shared out, to each other and to themselves. */
static void large_ones_share_a_room(void)
{
    for (uint32_t trial = test_iterations_at_least(20, 5); trial-- > 0 && !test_failures();) {
        const soup mesh = soup_sphere(130, 60 + test_random_below(20));
        separate own;
        scene s;
        if (!open_crowd(&s, 2, &mesh, 3)) return;
        for (uint32_t i = 0; i < 2; ++i) {
            thing *t = &s.things[i];
            const size_t bytes = sizeof(double) * 3 * mesh.vertex_count;
            for (int end = 0; end < 2; ++end) {
                memcpy(t->posed[end], mesh.positions, bytes);
                for (uint32_t v = 0; v < mesh.vertex_count; ++v)
                    t->posed[end][3 * (size_t)v] += 0.6 * i + 0.1 * end;
                t->pose[end].position_type = SC_DOUBLE;
                t->pose[end].positions = t->posed[end];
            }
            s.objects[i].itself = 1;
            s.objects[i].pose_version = 0;
        }
        if (!separate_open(&own, &s)) return;
        for (int call = 0; call < 4; ++call) {
            object_question q = object_question_any();
            const int way = HOST_FIRST + (int)test_random_below(HOST_COUNT - HOST_FIRST);
            q.near.distance *= 0.1; /* triangles are small */
            q.step.separation *= 0.1;
            ask_both(&s, &own, q, call % 2 ? way : -1);
        }
        separate_close(&own, &s);
        scene_close(&s);
    }
}

SC_TEST_MAIN(SC_TEST(they_are_small), SC_TEST(others_are_refused),
             SC_TEST(they_answer_as_others_do), SC_TEST(what_others_leave_is_not_taken),
             SC_TEST(threads_have_parts_of_it), SC_TEST(large_ones_share_a_room))
