/*
 * What is near of several objects, and what collides in a step of them: the same pairs with the
 * same times as in one mesh of all of them; whatever was kept from one call to the next, with tasks
 * and without. And what is refused.
 *
 * SPDX-License-Identifier: MIT
 */
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "harness.h"
#include "inputs.h"
#include "object_scenes.h"
#include "starcontour.h"
#include "tasks.h"

/* What is asked: of what is near, or of a step. */
typedef struct question {
    int is_step;
    sc_near_options near;
    sc_step_options step;
} question;

/* What one mesh says. */
typedef struct expected {
    found_list list[2];
    double earliest;
} expected;

/* ---- one mesh of all ---- */

/* Asks the whole, by one worker; counts alone, or with arrays. */
static sc_status ask_whole(const whole_scene *whole, const question *q, sc_step_result *r)
{
    sc_near_options near = q->near;
    sc_step_options step = q->step;
    sc_near_result n;
    sc_status status;
    step.method = SC_STEP_METHOD_DEFAULT;
    near.method = SC_NEAR_METHOD_DEFAULT;
    step.tasks = near.tasks = NULL;
    step.output = near.output = r->vertex_faces ? SC_OUTPUT_PAIRS : SC_OUTPUT_COUNT;
    if (q->is_step)
        return sc_query_step(whole->model, whole->workspace, &whole->pose[0], &whole->pose[1],
                             &step, r);
    memset(&n, 0, sizeof n);
    n.struct_size = sizeof n;
    n.vertex_faces = r->vertex_faces;
    n.vertex_face_capacity = r->vertex_face_capacity;
    n.edge_edges = r->edge_edges;
    n.edge_edge_capacity = r->edge_edge_capacity;
    status = sc_query_near(whole->model, whole->workspace, &whole->pose[0], &near, &n);
    r->vertex_face_count = n.vertex_face_count;
    r->edge_edge_count = n.edge_edge_count;
    return status;
}

/* Pairs of the whole in numbers of objects, but those that nobody asks for. */
static found_list divide(const whole_scene *whole, const scene *s, int kind, const sc_pair *pairs,
                         const double *times, uint64_t count)
{
    found_list list = {(found *)test_allocate(sizeof(found) * count), 0};
    for (uint64_t i = 0; i < count; ++i) {
        found *f = &list.at[list.count];
        uint32_t a = kind ? pairs[i].a / 3 : pairs[i].a, b = kind ? pairs[i].b / 3 : pairs[i].b;
        const uint32_t *first = kind ? whole->first_triangle : whole->first_vertex;
        f->object_a = whole_scene_split(whole, first, &a);
        f->object_b = whole_scene_split(whole, whole->first_triangle, &b);
        f->a = kind ? 3 * a + pairs[i].a % 3 : a;
        f->b = kind ? 3 * b + pairs[i].b % 3 : b;
        f->time = times ? times[i] : 0;
        list.count += (uint64_t)scene_asks_for(s, f->object_a, f->object_b);
    }
    qsort(list.at, list.count, sizeof *list.at, found_compare);
    return list;
}

static expected expect(const scene *s, const question *q)
{
    whole_scene whole;
    sc_step_result r;
    expected e;
    memset(&e, 0, sizeof e);
    memset(&r, 0, sizeof r);
    r.struct_size = sizeof r;
    e.earliest = 1;
    if (whole_scene_open(&whole, s) && CHECK(ask_whole(&whole, q, &r) == SC_OK)) {
        r.vertex_face_capacity = r.vertex_face_count;
        r.edge_edge_capacity = r.edge_edge_count;
        r.vertex_faces = (sc_pair *)test_allocate(sizeof(sc_pair) * (r.vertex_face_count + 1));
        r.edge_edges = (sc_pair *)test_allocate(sizeof(sc_pair) * r.edge_edge_count);
        r.vertex_face_times = (double *)test_allocate(sizeof(double) * r.vertex_face_count);
        r.edge_edge_times = (double *)test_allocate(sizeof(double) * r.edge_edge_count);
        memset(r.vertex_face_times, 0, sizeof(double) * r.vertex_face_count);
        memset(r.edge_edge_times, 0, sizeof(double) * r.edge_edge_count);
        CHECK(ask_whole(&whole, q, &r) == SC_OK);
        e.list[0] = divide(&whole, s, 0, r.vertex_faces, r.vertex_face_times, r.vertex_face_count);
        e.list[1] = divide(&whole, s, 1, r.edge_edges, r.edge_edge_times, r.edge_edge_count);
        for (int kind = 0; kind < 2; ++kind)
            for (uint64_t i = 0; i < e.list[kind].count; ++i)
                e.earliest = fmin(e.earliest, e.list[kind].at[i].time);
        free(r.vertex_faces);
        free(r.edge_edges);
        free(r.vertex_face_times);
        free(r.edge_edge_times);
    }
    whole_scene_close(&whole);
    return e;
}

static void expected_free(expected *e)
{
    free(e->list[0].at);
    free(e->list[1].at);
}

/* ---- asking ---- */

typedef struct asked {
    sc_status status;
    sc_objects_lists lists; /* with arrays of the caller */
    sc_stats stats;
} asked;

static sc_objects objects_of(const scene *s)
{
    sc_objects objects;
    memset(&objects, 0, sizeof objects);
    objects.struct_size = sizeof objects;
    objects.count = s->count;
    objects.objects = s->objects;
    return objects;
}

static sc_status ask_objects(const sc_objects *objects, const question *q, sc_objects_lists *lists)
{
    return q->is_step ? sc_query_objects_step(objects, &q->step, lists)
                      : sc_query_objects_near(objects, &q->near, lists);
}

static void give_list(sc_object_list *list, uint64_t capacity, uint64_t ranges)
{
    list->capacity = capacity;
    list->range_capacity = ranges;
    list->pairs = (sc_pair *)test_allocate(sizeof(sc_pair) * capacity);
    list->times = (double *)test_allocate(sizeof(double) * capacity);
    list->ranges = (sc_object_pairs *)test_allocate(sizeof(sc_object_pairs) * ranges);
}

/* Only steps move. */
static void ask(scene *s, const question *q, const uint64_t capacity[2], const uint64_t ranges[2],
                asked *a)
{
    sc_objects objects = objects_of(s);
    for (uint32_t i = 0; i < s->count; ++i)
        s->objects[i].end = q->is_step ? &s->things[i].pose[1] : NULL;
    memset(a, 0, sizeof *a);
    a->stats.struct_size = sizeof a->stats;
    a->lists.struct_size = sizeof a->lists;
    give_list(&a->lists.vertex_faces, capacity[0], ranges[0]);
    give_list(&a->lists.edge_edges, capacity[1], ranges[1]);
    a->lists.stats = test_random_below(2) ? &a->stats : NULL;
    a->status = ask_objects(&objects, q, &a->lists);
}

static const sc_object_list *list_of(const asked *a, int kind)
{
    return kind ? &a->lists.edge_edges : &a->lists.vertex_faces;
}

static void forget(asked *a)
{
    for (int kind = 0; kind < 2; ++kind) {
        free(list_of(a, kind)->pairs);
        free(list_of(a, kind)->times);
        free(list_of(a, kind)->ranges);
    }
}

/* Whether the ranges that fit are what is wanted, pair by pair. */
static int are_pairs_wanted(const found_list *wanted, const sc_object_list *list, int timed)
{
    uint64_t i, k, at = 0;
    for (i = 0; i < list->range_count && i < list->range_capacity; ++i) {
        const sc_object_pairs *range = &list->ranges[i];
        if (range->first != at || range->count == 0 || at + range->count > wanted->count) return 0;
        if (at + range->count > list->capacity) return 1;
        for (k = 0; k < range->count; ++k, ++at) {
            const found *f = &wanted->at[at];
            if (f->object_a != range->object_a || f->object_b != range->object_b ||
                f->a != list->pairs[at].a || f->b != list->pairs[at].b)
                return 0;
            if (timed && f->time != list->times[at]) return 0;
        }
    }
    return 1;
}

/* Whether ranges are what is wanted, where pairs are counted alone or do not all fit. */
static int are_ranges_wanted(const found_list *wanted, const sc_object_list *list)
{
    uint64_t i, at = 0;
    for (i = 0; i < list->range_count && i < list->range_capacity; ++i) {
        const sc_object_pairs *range = &list->ranges[i];
        if (range->first != at || range->count == 0 || range->count > wanted->count - at) return 0;
        for (uint64_t k = 0; k < range->count; ++k, ++at)
            if (wanted->at[at].object_a != range->object_a ||
                wanted->at[at].object_b != range->object_b)
                return 0;
    }
    return at == wanted->count;
}

/* Asks for counts alone: of all pairs, and of each two objects. */
static void check_counts(scene *s, const question *question_of, const expected *e)
{
    question q = *question_of;
    const uint64_t count[2] = {e->list[0].count, e->list[1].count}, none[2] = {0, 0};
    const uint64_t ranges[2] = {found_list_ranges(&e->list[0]), found_list_ranges(&e->list[1])};
    asked a;
    q.near.output = q.step.output = SC_OUTPUT_COUNT;
    ask(s, &q, none, ranges, &a);
    CHECK(a.status == SC_OK && a.lists.collides == (uint32_t)(count[0] + count[1] > 0));
    CHECK(a.lists.vertex_faces.count == count[0] && a.lists.edge_edges.count == count[1] &&
          are_ranges_wanted(&e->list[0], &a.lists.vertex_faces) &&
          are_ranges_wanted(&e->list[1], &a.lists.edge_edges));
    forget(&a);
}

/* Asks for pairs, for their number, for any, and with arrays that are too short. */
static void check_answers(scene *s, const question *question_of, const expected *e)
{
    question q = *question_of;
    const uint64_t count[2] = {e->list[0].count, e->list[1].count}, none[2] = {0, 0};
    const uint64_t ranges[2] = {found_list_ranges(&e->list[0]), found_list_ranges(&e->list[1])};
    const int timed = q.is_step && q.step.times == SC_STEP_TIMES_EACH;
    const int found_any = count[0] + count[1] > 0;
    uint64_t some[2];
    asked a;
    int kind;
    ask(s, &q, count, ranges, &a);
    for (kind = 0; kind < 2; ++kind) {
        const sc_object_list *l = list_of(&a, kind);
        CHECK_MSG(a.status == SC_OK && l->count == count[kind] && l->range_count == ranges[kind] &&
                      are_pairs_wanted(&e->list[kind], l, timed),
                  "%s, step %d, kind %d, %u objects: %" PRIu64 " pairs in %" PRIu64
                  " ranges of %" PRIu64 " in %" PRIu64 ", state %" PRIu64,
                  sc_status_string(a.status), q.is_step, kind, s->count, l->count, l->range_count,
                  count[kind], ranges[kind], s->state);
    }
    CHECK(a.lists.collides == (uint32_t)found_any);
    CHECK(a.lists.verdict == (found_any ? SC_VERDICT_FOUND : SC_VERDICT_CLEAN));
    if (q.is_step)
        CHECK(a.lists.earliest == (timed                                ? e->earliest
                                   : !found_any                         ? 1
                                   : q.step.times == SC_STEP_TIMES_NONE ? 0
                                                                        : a.lists.earliest));
    else
        CHECK(a.lists.earliest == 0);
    forget(&a);
    if (test_random_below(2)) {
        check_counts(s, &q, e);
    } else {
        q.near.output = q.step.output = SC_OUTPUT_ANY;
        ask(s, &q, none, ranges, &a);
        CHECK(a.status == SC_OK && a.lists.collides == (uint32_t)found_any &&
              a.lists.vertex_faces.count + a.lists.edge_edges.count == (uint64_t)found_any);
        forget(&a);
    }
    if (!count[0] && !count[1]) return;
    q.near.output = q.step.output = SC_OUTPUT_PAIRS;
    for (kind = 0; kind < 2; ++kind)
        some[kind] = count[kind] ? test_random_below((uint32_t)count[kind]) : 0;
    ask(s, &q, some, ranges, &a);
    CHECK(a.status == SC_ERROR_SHORT_BUFFER);
    for (kind = 0; kind < 2; ++kind)
        CHECK(list_of(&a, kind)->count == count[kind] &&
              list_of(&a, kind)->range_count == ranges[kind] &&
              are_pairs_wanted(&e->list[kind], list_of(&a, kind), timed) &&
              are_ranges_wanted(&e->list[kind], list_of(&a, kind)));
    forget(&a);
}

/* A distance that leaves something out, or 0. */
static double any_distance(void)
{
    static const double distances[] = {0, 0.001, 0.02, 0.1};
    return distances[test_random_below(4)] * test_random_range(0.5, 1);
}

static question any_question(void)
{
    static const uint32_t methods[] = {SC_STEP_METHOD_DEFAULT, SC_STEP_METHOD_SCTT,
                                       SC_STEP_METHOD_TWO_BOXES, SC_STEP_METHOD_SWEPT};
    question q;
    memset(&q, 0, sizeof q);
    q.near.struct_size = sizeof q.near;
    q.step.struct_size = sizeof q.step;
    q.is_step = test_random_below(2) == 0;
    q.near.distance = q.step.separation = any_distance();
    q.near.kinds = test_random_below(3) ? SC_NEAR_BOTH : SC_NEAR_VERTEX_FACE + test_random_below(2);
    q.near.method = test_random_below(3) * (uint32_t)(test_random_below(2) == 0);
    q.step.method = methods[test_random_below(4)];
    q.step.times = test_random_below(2) ? SC_STEP_TIMES_EACH : SC_STEP_TIMES_NONE;
    q.step.begun = test_random_below(4) == 0 ? SC_STEP_BEGUN_NEARER : SC_STEP_BEGUN_ALL;
    q.near.simd = q.step.simd = test_random_below(4) == 0 ? SC_SIMD_BASE : SC_SIMD_BEST;
    return q;
}

/* ---- tests ---- */

/* Random scenes; then some objects move, and the others keep what is known of them, for questions
   of all kinds in turn. */
static void scenes_are_one_mesh(void)
{
    uint64_t pairs = 0, between = 0, kept = 0;
    for (uint32_t trial = test_iterations_at_least(200, 40); trial-- > 0 && !test_failures();) {
        scene s;
        question q = any_question();
        if (!scene_open(&s, trial % 8 ? 5 : OBJECTS_MAX, trial % 16 ? 40 : 200, 1,
                        SC_WORKSPACE_NEAR))
            return;
        for (int call = 0; call < 3; ++call) {
            expected e;
            if (test_random_below(2)) q = any_question();
            e = expect(&s, &q);
            for (int kind = 0; kind < 2; ++kind)
                for (uint64_t i = 0; i < e.list[kind].count; ++i, ++pairs)
                    between += e.list[kind].at[i].object_a != e.list[kind].at[i].object_b;
            check_answers(&s, &q, &e);
            expected_free(&e);
            for (uint32_t i = 0; i < s.count; ++i)
                if (test_random_below(2)) {
                    scene_pose_thing(&s, i);
                    if (s.objects[i].pose_version) s.objects[i].pose_version++;
                } else {
                    kept += s.objects[i].pose_version != 0;
                }
            if (test_random_below(3) == 0) { /* another kind of question in between */
                sc_objects objects = objects_of(&s);
                sc_query_options o = no_options();
                sc_objects_result r;
                memset(&r, 0, sizeof r);
                r.struct_size = sizeof r;
                o.output = SC_OUTPUT_COUNT;
                for (uint32_t i = 0; i < s.count; ++i) s.objects[i].end = NULL;
                CHECK(sc_query_objects(&objects, &o, &r) == SC_OK);
            }
        }
        scene_close(&s);
    }
    CHECK_MSG(pairs > 1000 && between > 500 && kept > 50,
              "%" PRIu64 " pairs, %" PRIu64 " between, %" PRIu64 " kept", pairs, between, kept);
}

/* Objects that stay, asked for one distance after the other, in steps that stay as well, of either
   form of boxes. */
static void what_stays_is_asked_for_other_distances(void)
{
    for (uint32_t trial = test_iterations_at_least(100, 20); trial-- > 0 && !test_failures();) {
        scene s;
        question q = any_question();
        if (!scene_open(&s, 3, 60, 1, SC_WORKSPACE_NEAR)) return;
        for (uint32_t i = 0; i < s.count; ++i) {
            s.objects[i].itself = 1;
            s.objects[i].pose_version = 1;
            s.objects[i].group.category = s.objects[i].group.mask = 0;
        }
        for (int call = 0; call < 4; ++call) {
            expected e;
            if (call % 3) /* else for the same distance as before, maybe by other boxes */
                q.near.distance = q.step.separation =
                    0.01 * test_random_range(0.5, 1) * (1 << 2 * call);
            q.step.method = test_random_below(2) ? SC_STEP_METHOD_SWEPT : SC_STEP_METHOD_SCTT;
            e = expect(&s, &q);
            check_answers(&s, &q, &e);
            expected_free(&e);
        }
        scene_close(&s);
    }
}

/* A cloth in small waves, that falls some way during a step, or a sphere below it. */
static int open_large_thing(scene *s, uint32_t i, int is_cloth, uint32_t side)
{
    const soup mesh = is_cloth ? soup_cloth(side, side) : soup_sphere(side, side);
    thing *t = &s->things[i];
    if (!scene_open_thing_of(s, i, &mesh)) return 0;
    s->objects[i].group.category = s->objects[i].group.mask = 0;
    t->is_float = 0;
    for (uint32_t v = 0; v < 3 * t->mesh.vertex_count; ++v) {
        const double p = t->mesh.positions[v];
        t->posed[0][v] = is_cloth && v % 3 == 2 ? 0.42 + 0.01 * test_random_range(0, 1) : p;
        t->posed[1][v] = t->posed[0][v] - (is_cloth && v % 3 == 2 ? 0.05 : 0);
    }
    for (int end = 0; end < 2; ++end) {
        t->pose[end].position_type = SC_DOUBLE;
        t->pose[end].positions = t->posed[end];
    }
    return 1;
}

/* Two objects of which each is worth a job, in workspaces that were never asked before; of which
   one may be for fewer workers. */
static void large_objects_share_work(void)
{
    uint64_t between = 0;
    for (uint32_t trial = test_iterations_at_least(8, 2); trial-- > 0 && !test_failures();) {
        scene s;
        host h;
        int way = HOST_FIRST + (int)(trial % (HOST_COUNT - HOST_FIRST));
        question q = any_question();
        expected e;
        memset(&s, 0, sizeof s);
        s.state = test_random_state();
        s.workers = THREADS_MAX;
        s.flags = SC_WORKSPACE_NEAR;
        s.count = 2;
        if (!open_large_thing(&s, 0, trial % 2 == 0, 45)) return;
        if (trial % 4 == 0) s.workers = 1;
        if (!open_large_thing(&s, 1, trial % 2 != 0, 45)) return;
        e = expect(&s, &q);
        for (uint64_t i = 0; i < e.list[0].count; ++i)
            between += e.list[0].at[i].object_a != e.list[0].at[i].object_b;
        host_start(&h, way, 2 + trial % 3);
        q.near.tasks = q.step.tasks = &h.tasks;
        check_answers(&s, &q, &e);
        CHECK(h.mistakes == 0);
        host_stop(&h);
        expected_free(&e);
        scene_close(&s);
    }
    CHECK(between > 0);
}

/* Two objects so large that workers share what they have with each other: of vertices of the second
   and faces of the first each counts its own. */
static void large_objects_are_counted(void)
{
    for (uint32_t trial = 0; trial < 4 && !test_failures(); ++trial) {
        scene s;
        host h;
        question q;
        expected e;
        memset(&q, 0, sizeof q);
        q.near.struct_size = sizeof q.near;
        q.step.struct_size = sizeof q.step;
        q.is_step = (int)(trial / 2);
        q.near.distance = q.step.separation = 0.02;
        memset(&s, 0, sizeof s);
        s.state = test_random_state();
        s.workers = THREADS_MAX;
        s.flags = SC_WORKSPACE_NEAR;
        s.count = 2;
        if (!open_large_thing(&s, 0, 0, 100) || !open_large_thing(&s, 1, 1, 100)) return;
        e = expect(&s, &q);
        host_start(&h, trial % 2 ? HOST_BACKWARDS : HOST_FORWARDS, 3);
        q.near.tasks = q.step.tasks = &h.tasks;
        check_counts(&s, &q, &e);
        CHECK(h.mistakes == 0 && h.parts > 1 && e.list[0].count > 100);
        host_stop(&h);
        expected_free(&e);
        scene_close(&s);
    }
}

static int accept_some(void *user, uint32_t kind, uint32_t object_a, uint32_t object_b, uint32_t a,
                       uint32_t b)
{
    ++*(uint64_t *)user;
    return (kind + 2 * object_a + object_b + a + b) % 3 != 0;
}

static void the_function_leaves_pairs_out(void)
{
    uint64_t calls = 0, between = 0;
    for (uint32_t trial = test_iterations_at_least(60, 10); trial-- > 0 && !test_failures();) {
        scene s;
        sc_objects objects;
        sc_objects_lists lists;
        question q = any_question();
        expected e;
        uint64_t kept[2] = {0, 0};
        if (!scene_open(&s, 5, 40, 1, SC_WORKSPACE_NEAR)) return;
        e = expect(&s, &q);
        for (int kind = 0; kind < 2; ++kind)
            for (uint64_t i = 0; i < e.list[kind].count; ++i) {
                const found *f = &e.list[kind].at[i];
                const uint32_t number = kind ? SC_NEAR_EDGE_EDGE : SC_NEAR_VERTEX_FACE;
                between += f->object_a != f->object_b;
                kept[kind] += f->object_a == f->object_b ||
                              (number + 2 * f->object_a + f->object_b + f->a + f->b) % 3 != 0;
            }
        for (uint32_t i = 0; i < s.count; ++i)
            s.objects[i].end = q.is_step ? &s.things[i].pose[1] : NULL;
        objects = objects_of(&s);
        objects.accept_near = accept_some;
        objects.accept_user = &calls;
        memset(&lists, 0, sizeof lists);
        lists.struct_size = sizeof lists;
        q.near.output = q.step.output = SC_OUTPUT_COUNT;
        CHECK(ask_objects(&objects, &q, &lists) == SC_OK && lists.vertex_faces.count == kept[0] &&
              lists.edge_edges.count == kept[1]);
        expected_free(&e);
        scene_close(&s);
    }
    CHECK(calls == between && calls > 0);
}

/* Filters, rest pose and masks of an object are those of a query of it alone. */
static void objects_have_filters(void)
{
    uint64_t left_out = 0;
    for (uint32_t trial = test_iterations_at_least(40, 8); trial-- > 0 && !test_failures();) {
        scene s;
        question q = any_question();
        sc_near_masks *masks = NULL;
        sc_filter filter;
        sc_pose rest;
        sc_workspace_options options = options_for_workers(1);
        sc_workspace *alone = NULL;
        sc_object *o = &s.objects[0];
        uint64_t free_count = 0;
        asked a;
        sc_near_result r;
        const uint64_t none[2] = {0, 0};
        if (!scene_open(&s, 1, 80, 1, SC_WORKSPACE_NEAR)) return;
        q.is_step = 0;
        q.near.kinds = SC_NEAR_BOTH;
        q.near.method = SC_NEAR_METHOD_DEFAULT;
        q.near.output = SC_OUTPUT_COUNT;
        q.near.distance = 0.1;
        o->itself = 1;
        options.flags = SC_WORKSPACE_NEAR;
        CHECK(sc_workspace_create_for(o->model, &options, &alone) == SC_OK);
        memset(&filter, 0, sizeof filter);
        filter.struct_size = sizeof filter;
        filter.ignore_rings = 2 + test_random_below(2);
        ask(&s, &q, none, none, &a);
        free_count = a.lists.vertex_faces.count + a.lists.edge_edges.count;
        forget(&a);
        if (trial % 3 == 0) o->vertex_face_filter = o->edge_edge_filter = &filter;
        if (trial % 3 == 1) {
            rest = s.things[0].pose[0];
            rest.position_type = SC_DOUBLE;
            rest.positions = s.things[0].mesh.positions;
            o->rest = &rest;
            o->rest_distance = 0.05;
        }
        if (trial % 3 == 2) {
            CHECK(sc_near_masks_create(o->model, 2, NULL, &masks) == SC_OK);
            o->masks = masks;
        }
        ask(&s, &q, none, none, &a);
        q.near.vertex_face_filter = o->vertex_face_filter;
        q.near.edge_edge_filter = o->edge_edge_filter;
        q.near.rest = o->rest;
        q.near.rest_distance = o->rest_distance;
        q.near.masks = masks;
        memset(&r, 0, sizeof r);
        r.struct_size = sizeof r;
        CHECK(sc_query_near(o->model, alone, o->pose, &q.near, &r) == SC_OK);
        CHECK_MSG(a.status == SC_OK && a.lists.vertex_faces.count == r.vertex_face_count &&
                      a.lists.edge_edges.count == r.edge_edge_count,
                  "filter %u, state %" PRIu64, trial % 3, s.state);
        left_out += free_count - r.vertex_face_count - r.edge_edge_count;
        forget(&a);
        sc_near_masks_free(masks);
        sc_workspace_free(alone);
        scene_close(&s);
    }
    CHECK(left_out > 0);
}

/* A rest pose with NaN, masks of another mesh, and culling by a model for boxes: refused of what is
   asked about itself, and not looked at where nothing is. */
static void an_object_by_itself_is_refused(void)
{
    const soup cloth = soup_cloth(4, 3), sphere = soup_sphere(6, 5);
    const uint64_t none[2] = {0, 0};
    sc_mesh mesh = input_plain_mesh(&cloth);
    sc_workspace_options options = options_for_workers(1);
    sc_build_options build;
    sc_near_masks *masks = NULL;
    sc_model *boxes = NULL;
    sc_workspace *for_boxes = NULL;
    double *positions = (double *)test_allocate(sizeof(double) * 3 * cloth.vertex_count);
    sc_pose rest;
    scene s;
    question q = any_question();
    asked a;
    memset(&s, 0, sizeof s);
    s.workers = 1;
    s.flags = options.flags = SC_WORKSPACE_NEAR;
    s.count = 2;
    q.near.output = q.step.output = SC_OUTPUT_COUNT;
    memset(&build, 0, sizeof build);
    build.struct_size = sizeof build;
    build.content = SC_MODEL_BOXES;
    build.rest = SC_REST_UNMARKED;
    if (!scene_open_thing_of(&s, 0, &cloth) || !scene_open_thing_of(&s, 1, &sphere)) return;
    CHECK(sc_near_masks_create(s.objects[1].model, 2, NULL, &masks) == SC_OK);
    if (!CHECK(sc_build(&mesh, &build, &boxes) == SC_OK) ||
        !CHECK(sc_workspace_create_for(boxes, &options, &for_boxes) == SC_OK))
        return;
    memcpy(positions, cloth.positions, sizeof(double) * 3 * cloth.vertex_count);
    positions[4] = (double)NAN;
    rest = s.things[0].pose[0];
    rest.position_type = SC_DOUBLE;
    rest.positions = positions;
    for (int trial = 0; trial < 2; ++trial) {
        sc_object *o = &s.objects[0];
        for (q.is_step = 0; q.is_step < 2; ++q.is_step) {
            const sc_object kept = *o;
            o->itself = (uint32_t)trial;
            q.near.method = SC_NEAR_METHOD_SCTT;
            q.step.method = SC_STEP_METHOD_SCTT;
            o->rest = &rest;
            o->rest_distance = 0.1;
            ask(&s, &q, none, none, &a);
            CHECK(a.status == (trial ? SC_ERROR_NOT_FINITE : SC_OK));
            CHECK((a.lists.verdict == SC_VERDICT_NONE) == trial);
            forget(&a);
            o->rest = NULL;
            o->rest_distance = 0;
            if (!q.is_step) {
                o->masks = masks;
                ask(&s, &q, none, none, &a);
                CHECK(a.status == (trial ? SC_ERROR_OPTION : SC_OK));
                CHECK((a.lists.verdict == SC_VERDICT_NONE) == trial);
                forget(&a);
                o->masks = NULL;
            }
            o->model = boxes;
            o->workspace = for_boxes;
            ask(&s, &q, none, none, &a);
            CHECK(a.status == (trial ? SC_ERROR_BOXES_ONLY : SC_OK));
            CHECK((a.lists.verdict == SC_VERDICT_NONE) == trial);
            forget(&a);
            *o = kept;
        }
    }
    free(positions);
    sc_near_masks_free(masks);
    sc_workspace_free(for_boxes);
    sc_model_free(boxes);
    scene_close(&s);
}

static void bad_scenes_are_refused(void)
{
    scene s;
    sc_objects objects;
    sc_objects_lists r;
    sc_near_options near;
    sc_step_options step;
    sc_filter filter;
    sc_near_masks *masks = NULL;
    if (!scene_open(&s, 1, 40, 1, SC_WORKSPACE_STEP)) return;
    while (s.count < 2)
        if (!scene_open_thing(&s, s.count++, 40)) return;
    s.flags = 0;
    if (!scene_open_thing(&s, s.count++, 40)) return;
    memset(&near, 0, sizeof near);
    memset(&step, 0, sizeof step);
    near.struct_size = sizeof near;
    step.struct_size = sizeof step;
    near.output = step.output = SC_OUTPUT_COUNT;
    memset(&objects, 0, sizeof objects);
    objects.struct_size = sizeof objects;
    memset(&r, 0, sizeof r);
    r.struct_size = sizeof r;
    CHECK(sc_query_objects_near(&objects, NULL, &r) == SC_OK && r.verdict == SC_VERDICT_CLEAN);
    CHECK(sc_query_objects_step(&objects, NULL, &r) == SC_OK && r.earliest == 1);
    CHECK(sc_query_objects_near(NULL, NULL, &r) == SC_ERROR_NULL);
    CHECK(sc_query_objects_near(&objects, NULL, NULL) == SC_ERROR_NULL);
    CHECK(sc_query_objects_step(&objects, NULL, NULL) == SC_ERROR_NULL);
    r.struct_size = 8;
    CHECK(sc_query_objects_step(&objects, NULL, &r) == SC_ERROR_STRUCT_SIZE);
    r.struct_size = sizeof r;
    objects = objects_of(&s);
    /* workspaces for less */
    CHECK(sc_query_objects_near(&objects, &near, &r) == SC_ERROR_WORKSPACE);
    CHECK(sc_query_objects_step(&objects, &step, &r) == SC_ERROR_WORKSPACE);
    objects.count = s.count = 2;
    CHECK(sc_query_objects_near(&objects, &near, &r) == SC_ERROR_WORKSPACE);
    CHECK(sc_query_objects_step(&objects, &step, &r) == SC_OK);
    /* options that objects have, or that are not for several */
    memset(&filter, 0, sizeof filter);
    filter.struct_size = sizeof filter;
    step.vertex_face_filter = &filter;
    CHECK(sc_query_objects_step(&objects, &step, &r) == SC_ERROR_OPTION);
    step.vertex_face_filter = NULL;
    step.budget = 1;
    CHECK(sc_query_objects_step(&objects, &step, &r) == SC_ERROR_OPTION);
    step.budget = 0;
    step.contour = SC_CONTOUR_NONE;
    CHECK(sc_query_objects_step(&objects, &step, &r) == SC_ERROR_OPTION);
    step.contour = SC_CONTOUR_DEFAULT;
    step.separation = -1;
    CHECK(sc_query_objects_step(&objects, &step, &r) == SC_ERROR_OPTION);
    step.separation = 0;
    near.distance = (double)NAN;
    CHECK(sc_query_objects_near(&objects, &near, &r) == SC_ERROR_OPTION);
    near.distance = 0;
    /* objects */
    s.objects[0].filter = &filter;
    CHECK(sc_query_objects_step(&objects, &step, &r) == SC_ERROR_OPTION);
    s.objects[0].filter = NULL;
    s.objects[0].itself = 1;
    s.objects[0].edge_edge_filter = &filter;
    filter.ignore_rings = SC_RINGS_MAX + 1;
    CHECK(sc_query_objects_step(&objects, &step, &r) == SC_ERROR_OPTION);
    s.objects[0].edge_edge_filter = NULL;
    s.objects[0].rest_distance = -1;
    CHECK(sc_query_objects_step(&objects, &step, &r) == SC_ERROR_OPTION);
    s.objects[0].rest_distance = 1;
    CHECK(sc_query_objects_step(&objects, &step, &r) == SC_ERROR_NULL); /* without a rest pose */
    s.objects[0].rest_distance = 0;
    CHECK(sc_near_masks_create(s.objects[0].model, 2, NULL, &masks) == SC_OK);
    s.objects[0].masks = masks;
    CHECK(sc_query_objects_step(&objects, &step, &r) == SC_ERROR_OPTION);
    s.objects[0].masks = NULL;
    sc_near_masks_free(masks);
    s.objects[1].end = &s.things[1].pose[1];
    s.things[1].posed[1][1] = (double)NAN;
    s.things[1].pose[1].positions = s.things[1].posed[1];
    s.things[1].pose[1].position_type = SC_DOUBLE;
    s.objects[1].pose_version = 77;
    CHECK(sc_query_objects_step(&objects, &step, &r) == SC_ERROR_NOT_FINITE &&
          r.verdict == SC_VERDICT_NONE && r.vertex_faces.count == 0 && r.earliest == 0);
    s.objects[1].end = NULL;
    /* arrays */
    step.output = SC_OUTPUT_PAIRS;
    r.edge_edges.capacity = 1;
    CHECK(sc_query_objects_step(&objects, &step, &r) == SC_ERROR_NULL);
    r.edge_edges.capacity = 0;
    r.vertex_faces.range_capacity = 1;
    CHECK(sc_query_objects_step(&objects, &step, &r) == SC_ERROR_NULL);
    s.count = 3;
    scene_close(&s);
}

/* A flag ends it, and says so. */
static void a_flag_ends_it(void)
{
    scene s;
    question q = any_question();
    const volatile uint32_t flag = 1;
    const uint64_t none[2] = {0, 0};
    if (!scene_open(&s, 3, 100, 1, SC_WORKSPACE_NEAR)) return;
    for (uint32_t i = 0; i < s.count; ++i) s.objects[i].itself = 1;
    q.near.cancel = q.step.cancel = &flag;
    for (q.is_step = 0; q.is_step < 2; ++q.is_step) {
        asked a;
        ask(&s, &q, none, none, &a);
        CHECK(a.status == SC_ERROR_INCOMPLETE && a.lists.verdict == SC_VERDICT_INCOMPLETE &&
              a.lists.earliest == 0);
        forget(&a);
    }
    scene_close(&s);
}

SC_TEST_MAIN(SC_TEST(scenes_are_one_mesh), SC_TEST(what_stays_is_asked_for_other_distances),
             SC_TEST(large_objects_share_work), SC_TEST(large_objects_are_counted),
             SC_TEST(the_function_leaves_pairs_out), SC_TEST(objects_have_filters),
             SC_TEST(an_object_by_itself_is_refused), SC_TEST(bad_scenes_are_refused),
             SC_TEST(a_flag_ends_it))
