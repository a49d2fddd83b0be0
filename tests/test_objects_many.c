/*
 * Many objects, or several small ones, in one query: swept, and answered by several workers, each
 * of which does whole questions: the same answers bit for bit as by one, in the same order.
 *
 * SPDX-License-Identifier: MIT
 */
#include <inttypes.h>
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "harness.h"
#include "object_ask.h"
#include "object_scenes.h"
#include "soups.h"
#include "starcontour.h"
#include "tasks.h"

/* The caller's functions, and how often they are called. */
typedef struct functions {
    pthread_t thread;
    uint64_t between, alone, elsewhere; /* elsewhere: by another thread */
} functions;

/* ---- functions ---- */

static int is_wanted_between(uint32_t object_a, uint32_t object_b, uint32_t a, uint32_t b)
{
    return (object_a + object_b + a + b) % 3 != 0;
}

static int is_wanted_alone(uint32_t a, uint32_t b)
{
    return (a + b) % 2 != 0;
}

static int accept_between(void *user, uint32_t object_a, uint32_t object_b, uint32_t a, uint32_t b)
{
    functions *f = (functions *)user;
    f->elsewhere += !pthread_equal(pthread_self(), f->thread);
    ++f->between;
    return is_wanted_between(object_a, object_b, a, b);
}

static int accept_near_between(void *user, uint32_t kind, uint32_t object_a, uint32_t object_b,
                               uint32_t a, uint32_t b)
{
    (void)kind;
    return accept_between(user, object_a, object_b, a, b);
}

static int32_t accept_alone(void *user, uint32_t a, uint32_t b)
{
    functions *f = (functions *)user;
    f->elsewhere += !pthread_equal(pthread_self(), f->thread);
    ++f->alone;
    return is_wanted_alone(a, b);
}

/* ---- workers ---- */

/* Asks by so many workers, in new workspaces or in those of before. */
static int ask_workers(scene *s, const object_question *q, int way, uint32_t workers, int is_new,
                       const uint64_t capacity[2], object_answer *a)
{
    sc_objects objects;
    host h;
    memset(&objects, 0, sizeof objects);
    objects.struct_size = sizeof objects;
    objects.count = s->count;
    objects.objects = s->objects;
    if (q->asks) {
        if (q->about == OBJECTS_QUERY) objects.accept = accept_between;
        if (q->about != OBJECTS_QUERY) objects.accept_near = accept_near_between;
        objects.accept_user = q->asks;
    }
    for (uint32_t i = 0; i < s->count; ++i)
        s->objects[i].end = q->about == OBJECTS_STEP ? &s->things[i].pose[1] : NULL;
    if (is_new && !scene_renew_work(s)) return 0;
    if (workers == 1) {
        object_ask(&objects, q, NULL, capacity, a);
        return 1;
    }
    host_start(&h, way, workers);
    object_ask(&objects, q, &h.tasks, capacity, a);
    CHECK(h.mistakes == 0);
    host_stop(&h);
    return 1;
}

/* One worker, two and five, with arrays that fit exactly, or are too short; and for counts
   alone. */
static void workers_say_the_same(scene *s, const object_question *asked_for, int way, int is_large)
{
    static const uint32_t outputs[] = {SC_OUTPUT_PAIRS, SC_OUTPUT_COUNT, SC_OUTPUT_ANY};
    object_question q = *asked_for;
    uint64_t capacity[2] = {0, 0};
    object_answer one, some, others;
    object_question_set_output(&q, SC_OUTPUT_COUNT);
    if (!ask_workers(s, &q, way, 1, 1, capacity, &one)) return;
    for (int kind = 0; kind < 2; ++kind) capacity[kind] = one.list[kind].count;
    object_answer_forget(&one);
    for (int round = 0; round < 5; ++round) {
        const int is_short = round == 3;
        object_question_set_output(&q, outputs[round % 3]);
        for (int kind = 0; is_short && kind < 2; ++kind)
            if (capacity[kind]) capacity[kind] = test_random_below((uint32_t)capacity[kind]);
        if (!ask_workers(s, &q, way, 1, 1, capacity, &one)) return;
        if (!ask_workers(s, &q, way, 2, round < 4, capacity, &some)) return;
        if (!ask_workers(s, &q, way, 5, round < 4, capacity, &others)) return;
        if (is_large && q.query.output == SC_OUTPUT_ANY) /* of one object, any pair */
            CHECK(some.collides == one.collides && others.collides == one.collides);
        else
            CHECK_MSG(object_answers_are_same(&q, &one, &some) &&
                          object_answers_are_same(&q, &one, &others),
                      "about %d, round %d, %u objects, way %d, state %" PRIu64, q.about, round,
                      s->count, way, s->state);
        if (round < 2 && one.status == SC_OK)
            CHECK(object_counts_are_same(&some.stats, &others.stats));
        object_answer_forget(&one);
        object_answer_forget(&some);
        object_answer_forget(&others);
    }
}

static void small_objects_are_shared_out(void)
{
    for (uint32_t trial = test_iterations_at_least(200, 24); trial-- > 0 && !test_failures();) {
        scene s;
        const object_question q = object_question_any();
        const int way = HOST_FIRST + (int)(trial % (HOST_COUNT - HOST_FIRST));
        if (!scene_open(&s, trial % 4 ? 6 : OBJECTS_MAX, trial % 4 ? 100 : 40, 5,
                        SC_WORKSPACE_NEAR))
            return;
        workers_say_the_same(&s, &q, way, 0);
        scene_close(&s);
    }
}

/* How many pairs of a list the functions leave. */
static uint64_t count_wanted(const sc_object_list *list, int alone, int between)
{
    uint64_t count = 0;
    for (uint64_t i = 0; i < list->range_count; ++i) {
        const sc_object_pairs *r = &list->ranges[i];
        for (uint64_t k = r->first; k < r->first + r->count; ++k) {
            const sc_pair p = list->pairs[k];
            count +=
                (uint64_t)(r->object_a == r->object_b
                               ? !alone || is_wanted_alone(p.a, p.b)
                               : !between || is_wanted_between(r->object_a, r->object_b, p.a, p.b));
        }
    }
    return count;
}

/* What is left where a function is asked of objects by themselves (of vertices with faces, of edges
   with edges or of both), of two, or of all: by the calling thread, as often as by one worker. */
static void functions_are_asked_by_the_calling_thread(void)
{
    uint64_t alone = 0, between = 0;
    for (uint32_t trial = test_iterations_at_least(60, 24); trial-- > 0 && !test_failures();) {
        const int way = HOST_FIRST + (int)(trial % (HOST_COUNT - HOST_FIRST));
        const int kinds = 1 + (int)test_random_below(3), who = 1 + (int)test_random_below(3);
        uint64_t capacity[2] = {0, 0};
        object_question q = object_question_any();
        functions f;
        sc_filter filter;
        scene s;
        object_answer all, a[3];
        if (!scene_open(&s, 6, 60, 5, SC_WORKSPACE_NEAR)) return;
        object_question_set_output(&q, SC_OUTPUT_COUNT);
        if (!ask_workers(&s, &q, way, 1, 1, capacity, &all)) return;
        for (int kind = 0; kind < 2; ++kind) capacity[kind] = all.list[kind].count;
        object_answer_forget(&all);
        object_question_set_output(&q, SC_OUTPUT_PAIRS);
        if (!ask_workers(&s, &q, way, 1, 1, capacity, &all)) return;
        memset(&f, 0, sizeof f);
        f.thread = pthread_self();
        memset(&filter, 0, sizeof filter);
        filter.struct_size = sizeof filter;
        filter.accept = accept_alone;
        filter.accept_user = &f;
        for (uint32_t i = 0; (who & 1) && i < s.count; ++i) {
            if (q.about == OBJECTS_QUERY) s.objects[i].filter = &filter;
            if (q.about != OBJECTS_QUERY && (kinds & 1)) s.objects[i].vertex_face_filter = &filter;
            if (q.about != OBJECTS_QUERY && (kinds & 2)) s.objects[i].edge_edge_filter = &filter;
        }
        if (who & 2) q.asks = &f;
        for (int round = 0; round < 3; ++round) { /* arrays that fit, that are short, and none */
            static const uint32_t workers[3] = {1, 2, 5};
            functions asked_of[3];
            object_question_set_output(&q, round < 2 ? SC_OUTPUT_PAIRS : SC_OUTPUT_COUNT);
            for (int kind = 0; round == 1 && kind < 2; ++kind) capacity[kind] /= 3;
            for (int k = 0; k < 3; ++k) {
                f.alone = f.between = 0;
                if (!ask_workers(&s, &q, way, workers[k], 1, capacity, &a[k])) return;
                asked_of[k] = f;
                for (int kind = 0; kind < 2; ++kind)
                    CHECK(
                        a[k].list[kind].count ==
                        count_wanted(&all.list[kind],
                                     (who & 1) && (q.about == OBJECTS_QUERY || (kinds >> kind & 1)),
                                     who & 2));
                CHECK(f.alone == asked_of[0].alone && f.between == asked_of[0].between &&
                      f.elsewhere == 0);
            }
            CHECK_MSG(object_answers_are_same(&q, &a[0], &a[1]) &&
                          object_answers_are_same(&q, &a[0], &a[2]),
                      "about %d, round %d, who %d, kinds %d, way %d, state %" PRIu64, q.about,
                      round, who, kinds, way, s.state);
            alone += f.alone;
            between += f.between;
            for (int k = 0; k < 3; ++k) object_answer_forget(&a[k]);
        }
        object_answer_forget(&all);
        scene_close(&s);
    }
    CHECK(alone > 0 && between > 0);
}

/* A large object among small ones, which the list of units ends at; and one for a single worker. */
static void large_ones_are_among_small_ones(void)
{
    for (uint32_t trial = test_iterations_at_least(2, 1); trial-- > 0 && !test_failures();) {
        const soup sphere = soup_sphere(130, 60), small = soup_sphere(8, 6);
        scene s;
        object_question q = object_question_any();
        const int way = HOST_FIRST + (int)(trial % (HOST_COUNT - HOST_FIRST));
        memset(&s, 0, sizeof s);
        s.state = test_random_state();
        s.workers = 5;
        s.flags = SC_WORKSPACE_NEAR;
        for (; s.count < 5; ++s.count)
            if (s.count == 3 ? !scene_open_thing_of(&s, s.count, &sphere)
                             : !scene_open_thing(&s, s.count, 100))
                return;
        memcpy(s.things[3].posed[0], sphere.positions, sizeof(double) * 3 * sphere.vertex_count);
        memcpy(s.things[3].posed[1], sphere.positions, sizeof(double) * 3 * sphere.vertex_count);
        for (int end = 0; end < 2; ++end) {
            s.things[3].pose[end].position_type = SC_DOUBLE;
            s.things[3].pose[end].positions = s.things[3].posed[end];
        }
        if (!scene_open_thing_of(&s, s.count++, &small)) return;
        s.objects[3].group.category = s.objects[3].group.mask = 0;
        s.objects[5].group.category = s.objects[5].group.mask = 0;
        for (int end = 0; end < 2; ++end) { /* inside the large one, which it comes near */
            thing *t = &s.things[5];
            for (uint32_t i = 0; i < 3 * small.vertex_count; ++i)
                t->posed[end][i] = 0.2 * small.positions[i];
            t->pose[end].position_type = SC_DOUBLE;
            t->pose[end].positions = t->posed[end];
        }
        q.near.distance = q.step.separation = 0;
        workers_say_the_same(&s, &q, way, 1);
        scene_close(&s);
    }
}

/* A flag that is set on the way ends it, and what is not ended is right. */
static void a_flag_ends_units(void)
{
    uint64_t ended = 0;
    for (uint32_t trial = test_iterations_at_least(60, 12); trial-- > 0 && !test_failures();) {
        const uint64_t none[2] = {0, 0};
        scene s;
        object_question q = object_question_any();
        sc_objects objects;
        breaker b;
        object_answer all, some;
        if (!scene_open(&s, 6, 60, 4, SC_WORKSPACE_NEAR)) return;
        object_question_set_output(&q, SC_OUTPUT_COUNT);
        if (!ask_workers(&s, &q, 0, 1, 1, none, &all) || !scene_renew_work(&s)) return;
        memset(&objects, 0, sizeof objects);
        objects.struct_size = sizeof objects;
        objects.count = s.count;
        objects.objects = s.objects;
        breaker_start(&b, 4, test_random_below(12));
        q.query.cancel = q.near.cancel = q.step.cancel = &b.flag;
        object_ask(&objects, &q, &b.tasks, none, &some);
        if (some.status == SC_ERROR_INCOMPLETE) {
            CHECK(some.verdict == SC_VERDICT_INCOMPLETE && b.flag == 1 &&
                  some.list[0].count <= all.list[0].count);
            ++ended;
        } else {
            CHECK(object_answers_are_same(&q, &all, &some));
        }
        object_answer_forget(&all);
        object_answer_forget(&some);
        scene_close(&s);
    }
    CHECK(ended > 0);
}

/* ---- thousands ---- */

/* Objects of four triangles each, all of one model, and one mesh of them. */
typedef struct crowd {
    uint32_t count, workers;
    soup one, all;
    sc_model *model, *whole;
    sc_workspace *whole_workspace, **workspaces;
    sc_pose *poses;
    sc_object *objects;
} crowd;

enum { CORNERS = 4, FACES = 4 };

static sc_model *model_of(const soup *mesh)
{
    sc_build_options options;
    sc_model *model = NULL;
    sc_mesh m;
    memset(&m, 0, sizeof m);
    m.struct_size = sizeof m;
    m.vertex_count = mesh->vertex_count;
    m.triangle_count = mesh->triangle_count;
    m.position_type = SC_DOUBLE;
    m.positions = mesh->positions;
    m.indices = mesh->triangles;
    memset(&options, 0, sizeof options);
    options.struct_size = sizeof options;
    options.weld = SC_WELD_NONE;
    CHECK(sc_build(&m, &options, &model) == SC_OK);
    return model;
}

static double *corner_of(const crowd *c, uint32_t i, uint32_t v)
{
    return c->all.positions + 3 * ((size_t)CORNERS * i + v);
}

/* Tetrahedra in a cube, some on a grid, so that their boxes begin in the same place, and a few that
   reach far. */
static void place_crowd(crowd *c, double size)
{
    for (uint32_t i = 0; i < c->count; ++i) {
        const double scale = test_random_below(200) ? size * test_random_range(0.2, 1) : 20 * size;
        double at[3];
        for (int k = 0; k < 3; ++k) {
            at[k] = test_random_unit();
            if (i % 3 == 0) at[k] = (double)test_random_below(16) / 16;
        }
        for (uint32_t v = 0; v < CORNERS; ++v)
            for (int k = 0; k < 3; ++k)
                corner_of(c, i, v)[k] = at[k] + scale * c->one.positions[3 * v + (uint32_t)k];
    }
}

static int crowd_open(crowd *c, uint32_t count, uint32_t workers)
{
    static const double corners[3 * CORNERS] = {0, 0, 0, 1, 0, 0.1, 0.1, 1, 0, 0, 0.2, 1};
    static const uint32_t faces[3 * FACES] = {0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3};
    sc_workspace_options options = options_for_workers(workers);
    memset(c, 0, sizeof *c);
    c->count = count;
    c->one = soup_make(CORNERS, FACES);
    c->all = soup_make(CORNERS * count, FACES * count);
    memcpy(c->one.positions, corners, sizeof corners);
    memcpy(c->one.triangles, faces, sizeof faces);
    for (uint32_t i = 0; i < 3 * FACES * count; ++i)
        c->all.triangles[i] = i / (3 * FACES) * CORNERS + faces[i % (3 * FACES)];
    place_crowd(c, 0.05);
    c->workspaces = (sc_workspace **)test_allocate(sizeof(sc_workspace *) * count);
    c->poses = (sc_pose *)test_allocate(sizeof(sc_pose) * count);
    c->objects = (sc_object *)test_allocate(sizeof(sc_object) * count);
    memset(c->poses, 0, sizeof(sc_pose) * count);
    memset(c->objects, 0, sizeof(sc_object) * count);
    c->model = model_of(&c->one);
    c->whole = model_of(&c->all);
    if (!c->model || !c->whole ||
        !CHECK(sc_workspace_create(c->whole, NULL, &c->whole_workspace) == SC_OK))
        return 0;
    for (uint32_t i = 0; i < count; ++i) {
        sc_object *o = &c->objects[i];
        if (!CHECK(sc_workspace_create_for(c->model, &options, &c->workspaces[i]) == SC_OK))
            return 0;
        c->poses[i].struct_size = sizeof c->poses[i];
        c->poses[i].vertex_count = CORNERS;
        c->poses[i].position_type = SC_DOUBLE;
        c->poses[i].positions = corner_of(c, i, 0);
        o->model = c->model;
        o->workspace = c->workspaces[i];
        o->pose = &c->poses[i];
        o->itself = i % 2;
        if (i % 5 == 0) o->group.category = o->group.mask = 1 + i % 3;
    }
    return 1;
}

static void crowd_close(crowd *c)
{
    for (uint32_t i = 0; i < c->count; ++i) sc_workspace_free(c->workspaces[i]);
    sc_workspace_free(c->whole_workspace);
    sc_model_free(c->model);
    sc_model_free(c->whole);
    soup_free(&c->one);
    soup_free(&c->all);
    free(c->workspaces);
    free(c->poses);
    free(c->objects);
}

static int groups_collide(const sc_object *a, const sc_object *b)
{
    const sc_group all = {~0u, ~0u};
    const sc_group x = a->group.mask ? a->group : all, y = b->group.mask ? b->group : all;
    return (x.category & y.mask) && (y.category & x.mask);
}

/* The pairs of one mesh, which has a triangle of every two objects, in the order of objects. */
static found_list expect_crowd(const crowd *c, uint64_t *most)
{
    sc_pose pose;
    sc_result result;
    found_list list = {NULL, 0};
    uint32_t *partners = (uint32_t *)test_allocate(sizeof(uint32_t) * c->count);
    memset(partners, 0, sizeof(uint32_t) * c->count);
    memset(&pose, 0, sizeof pose);
    memset(&result, 0, sizeof result);
    pose.struct_size = sizeof pose;
    pose.vertex_count = c->all.vertex_count;
    pose.position_type = SC_DOUBLE;
    pose.positions = c->all.positions;
    result.struct_size = sizeof result;
    result.capacity = 100 * (uint64_t)c->count;
    result.pairs = (sc_pair *)test_allocate(sizeof(sc_pair) * result.capacity);
    CHECK(sc_query(c->whole, c->whole_workspace, &pose, NULL, &result) == SC_OK);
    list.at = (found *)test_allocate(sizeof(found) * (result.count + 1));
    for (uint64_t i = 0; i < result.count; ++i) {
        found *f = &list.at[list.count];
        f->object_a = result.pairs[i].a / FACES;
        f->object_b = result.pairs[i].b / FACES;
        f->a = result.pairs[i].a % FACES;
        f->b = result.pairs[i].b % FACES;
        list.count += (uint64_t)groups_collide(&c->objects[f->object_a], &c->objects[f->object_b]);
    }
    qsort(list.at, list.count, sizeof *list.at, found_compare);
    for (uint64_t i = 0; i < list.count; ++i)
        if (!i || found_compare(&list.at[i - 1], &list.at[i])) {
            const found *f = &list.at[i];
            partners[f->object_a] += !i || f->object_a != list.at[i - 1].object_a ||
                                     f->object_b != list.at[i - 1].object_b;
            if (partners[f->object_a] > *most) *most = partners[f->object_a];
        }
    free(result.pairs);
    free(partners);
    return list;
}

static void check_crowd(crowd *c, const sc_tasks *tasks, uint64_t *ranges, uint64_t *most)
{
    const found_list wanted = expect_crowd(c, most);
    const uint64_t capacity[2] = {wanted.count, 0};
    const object_question q = {OBJECTS_QUERY, NULL, no_options(), {0}, {0}};
    sc_objects objects;
    uint64_t at = 0;
    object_answer a;
    memset(&objects, 0, sizeof objects);
    objects.struct_size = sizeof objects;
    objects.count = c->count;
    objects.objects = c->objects;
    object_ask(&objects, &q, tasks, capacity, &a);
    CHECK_MSG(a.status == SC_OK && a.list[0].count == wanted.count &&
                  a.list[0].range_count == found_list_ranges(&wanted),
              "%s: %" PRIu64 " pairs of %" PRIu64, sc_status_string(a.status), a.list[0].count,
              wanted.count);
    for (uint64_t i = 0; i < a.list[0].range_count && !test_failures(); ++i) {
        const sc_object_pairs *r = &a.list[0].ranges[i];
        CHECK(r->first == at);
        for (uint64_t k = 0; k < r->count; ++k, ++at)
            CHECK(wanted.at[at].object_a == r->object_a && wanted.at[at].object_b == r->object_b &&
                  wanted.at[at].a == a.list[0].pairs[at].a &&
                  wanted.at[at].b == a.list[0].pairs[at].b);
    }
    *ranges += a.list[0].range_count;
    object_answer_forget(&a);
    free(wanted.at);
}

/* Some of which come near more others than an object takes down. Their poses are read by one
   worker, then, while the workspaces are for one, by two. */
static void thousands_are_swept(void)
{
    uint64_t ranges = 0, most = 0;
    crowd c;
    host h;
    host_start(&h, HOST_THREADS, 2);
    if (crowd_open(&c, 3000, 1)) {
        check_crowd(&c, NULL, &ranges, &most);
        check_crowd(&c, &h.tasks, &ranges, &most);
    }
    CHECK_MSG(ranges > 1024 && most > 20, "%" PRIu64 " ranges, at most %" PRIu64, ranges, most);
    CHECK(h.jobs == 2 && h.mistakes == 0);
    host_stop(&h);
    crowd_close(&c);
}

typedef struct heard {
    int count;
    char first[100];
} heard;

static void hear(void *user, uint32_t level, const char *message)
{
    heard *log = (heard *)user;
    (void)level;
    if (log->count++ == 0) (void)snprintf(log->first, sizeof log->first, "%s", message);
}

/* Of poses that are read by many, the first that is not finite is told, by the calling thread. The
   next one is not looked at by who finds the first; the last is read by others: before the first,
   after it, or at the same time. */
static void the_first_bad_pose_is_told(void)
{
    const uint32_t bad[3] = {1200, 1201, 2500};
    for (int way = HOST_FIRST; way < HOST_COUNT && !test_failures(); ++way) {
        const uint64_t none[2] = {0, 0};
        const object_question q = {OBJECTS_QUERY, NULL, no_options(), {0}, {0}};
        heard logs[3];
        sc_objects objects;
        crowd c;
        host h;
        object_answer a;
        if (!crowd_open(&c, 2600, 1)) return;
        memset(logs, 0, sizeof logs);
        for (uint32_t i = 0; i < 3; ++i) {
            sc_hooks hooks;
            memset(&hooks, 0, sizeof hooks);
            hooks.struct_size = sizeof hooks;
            hooks.log = hear;
            hooks.user = &logs[i];
            CHECK(sc_workspace_set_hooks(c.workspaces[bad[i]], &hooks) == SC_OK);
            corner_of(&c, bad[i], 2)[1] = (double)NAN;
        }
        memset(&objects, 0, sizeof objects);
        objects.struct_size = sizeof objects;
        objects.count = c.count;
        objects.objects = c.objects;
        host_start(&h, way, 2);
        object_ask(&objects, &q, &h.tasks, none, &a);
        CHECK(a.status == SC_ERROR_NOT_FINITE && a.verdict == SC_VERDICT_NONE && h.jobs == 1);
        CHECK_MSG(logs[0].count > 0 && logs[1].count == 0 && logs[2].count == 0 &&
                      strcmp(logs[0].first, "object 1200 has a vertex that is not finite") == 0,
                  "%s", logs[0].first);
        object_answer_forget(&a);
        host_stop(&h);
        crowd_close(&c);
    }
}

/* A host that sets the flag after so many jobs. */
typedef struct ender {
    sc_tasks tasks;
    volatile uint32_t flag;
    uint32_t left;
} ender;

static void *ender_enqueue(void *user, void (*run)(void *context, uint32_t part, uint32_t worker),
                           void *context, uint32_t count)
{
    ender *e = (ender *)user;
    for (uint32_t part = 0; part < count; ++part) run(context, part, part % e->tasks.workers);
    if (e->left && --e->left == 0) e->flag = 1;
    return NULL;
}

static void ender_finish(void *user, void *task)
{
    (void)user;
    (void)task;
}

/* Units find that an array is too short, in two jobs; and what is asked again by the calling thread
   ends with a flag. */
static void a_flag_ends_what_is_asked_again(void)
{
    const uint64_t one[2] = {1, 0};
    object_question q = {OBJECTS_QUERY, NULL, no_options(), {0}, {0}};
    sc_objects objects;
    crowd c;
    if (!crowd_open(&c, 20, 2)) return;
    place_crowd(&c, 1);
    memset(&objects, 0, sizeof objects);
    objects.struct_size = sizeof objects;
    objects.count = c.count;
    objects.objects = c.objects;
    for (uint32_t jobs = 0; jobs < 3; ++jobs) {
        ender e;
        object_answer a;
        memset(&e, 0, sizeof e);
        e.tasks.struct_size = sizeof e.tasks;
        e.tasks.workers = 2;
        e.tasks.enqueue = ender_enqueue;
        e.tasks.finish = ender_finish;
        e.tasks.user = &e;
        e.left = jobs;
        q.query.cancel = &e.flag;
        object_ask(&objects, &q, &e.tasks, one, &a);
        CHECK(a.status == (jobs ? SC_ERROR_INCOMPLETE : SC_ERROR_SHORT_BUFFER));
        CHECK(a.verdict == (jobs ? SC_VERDICT_INCOMPLETE : SC_VERDICT_FOUND));
        CHECK(jobs ? a.list[0].count == 0 : a.list[0].count > 20);
        object_answer_forget(&a);
    }
    crowd_close(&c);
}

/* More units than are listed at once. */
static void lists_of_units_follow_each_other(void)
{
    for (int way = HOST_FIRST; way < HOST_COUNT; ++way) {
        uint64_t ranges = 0, most = 0;
        crowd c;
        host h;
        host_start(&h, way, 2);
        if (crowd_open(&c, 400, 2)) {
            place_crowd(&c, 0.3);
            check_crowd(&c, &h.tasks, &ranges, &most);
        }
        CHECK_MSG(ranges > 512 && h.mistakes == 0, "%" PRIu64 " ranges", ranges);
        host_stop(&h);
        crowd_close(&c);
    }
}

SC_TEST_MAIN(SC_TEST(small_objects_are_shared_out),
             SC_TEST(functions_are_asked_by_the_calling_thread),
             SC_TEST(large_ones_are_among_small_ones), SC_TEST(a_flag_ends_units),
             SC_TEST(thousands_are_swept), SC_TEST(the_first_bad_pose_is_told),
             SC_TEST(a_flag_ends_what_is_asked_again), SC_TEST(lists_of_units_follow_each_other))
