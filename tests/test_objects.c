/*
 * Several objects in one query: the same pairs as one mesh of all of them in which nothing of one
 * is welded to anything of another; whatever was kept from one call to the next, with tasks and
 * without. And what is refused.
 *
 * SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "harness.h"
#include "inputs.h"
#include "object_scenes.h"
#include "soups.h"
#include "starcontour.h"
#include "tasks.h"

/* What one mesh of all objects says. */
static found_list expect(const scene *s, const sc_query_options *options)
{
    const int edges = options->pairs == SC_PAIRS_EDGE;
    sc_query_options o = *options;
    whole_scene whole;
    sc_result result;
    found_list list = {NULL, 0};
    memset(&result, 0, sizeof result);
    result.struct_size = sizeof result;
    o.tasks = NULL;
    o.output = SC_OUTPUT_COUNT;
    o.method = SC_METHOD_DEFAULT;
    if (whole_scene_open(&whole, s) &&
        CHECK(sc_query(whole.model, whole.workspace, &whole.pose[0], &o, &result) == SC_OK)) {
        result.capacity = result.count;
        result.pairs = (sc_pair *)test_allocate(sizeof(sc_pair) * result.count);
        list.at = (found *)test_allocate(sizeof(found) * result.count);
        o.output = SC_OUTPUT_PAIRS;
        CHECK(sc_query(whole.model, whole.workspace, &whole.pose[0], &o, &result) == SC_OK);
        for (uint64_t i = 0; i < result.count; ++i) {
            found *f = &list.at[list.count];
            uint32_t a = edges ? result.pairs[i].a / 3 : result.pairs[i].a;
            f->b = result.pairs[i].b;
            f->object_a = whole_scene_split(&whole, whole.first_triangle, &a);
            f->a = edges ? 3 * a + result.pairs[i].a % 3 : a;
            f->object_b = whole_scene_split(&whole, whole.first_triangle, &f->b);
            list.count += (uint64_t)scene_asks_for(s, f->object_a, f->object_b);
        }
        qsort(list.at, list.count, sizeof *list.at, found_compare);
        free(result.pairs);
    }
    whole_scene_close(&whole);
    return list;
}

/* ---- asking ---- */

typedef struct asked {
    sc_status status;
    sc_objects_result result; /* with arrays of the caller */
    sc_stats stats;
} asked;

static void ask(const scene *s, const sc_query_options *options, uint64_t capacity, uint64_t ranges,
                asked *a)
{
    sc_objects objects;
    memset(&objects, 0, sizeof objects);
    objects.struct_size = sizeof objects;
    objects.count = s->count;
    objects.objects = s->objects;
    memset(a, 0, sizeof *a);
    a->stats.struct_size = sizeof a->stats;
    a->result.struct_size = sizeof a->result;
    a->result.capacity = capacity;
    a->result.range_capacity = ranges;
    a->result.pairs = (sc_pair *)test_allocate(sizeof(sc_pair) * capacity);
    a->result.ranges = (sc_object_pairs *)test_allocate(sizeof(sc_object_pairs) * ranges);
    a->result.stats = test_random_below(2) ? &a->stats : NULL;
    a->status = sc_query_objects(&objects, options, &a->result);
}

static void forget(asked *a)
{
    free(a->result.pairs);
    free(a->result.ranges);
}

/* Whether an answer is what is wanted, pair by pair. */
static int is_wanted(const found_list *wanted, const asked *a)
{
    uint64_t i, k, at = 0;
    if (a->result.count != wanted->count || a->result.range_count != found_list_ranges(wanted))
        return 0;
    for (i = 0; i < a->result.range_count; ++i) {
        const sc_object_pairs *range = &a->result.ranges[i];
        if (range->first != at || range->count == 0) return 0;
        for (k = 0; k < range->count; ++k, ++at) {
            const sc_pair *pair = &a->result.pairs[at];
            const found *f = &wanted->at[at];
            if (f->object_a != range->object_a || f->object_b != range->object_b ||
                f->a != pair->a || f->b != pair->b)
                return 0;
        }
    }
    return at == wanted->count;
}

static sc_query_options any_options(void)
{
    static const uint32_t methods[] = {SC_METHOD_DEFAULT, SC_METHOD_SCTT, SC_METHOD_AABB_SCTT,
                                       SC_METHOD_AABB};
    sc_query_options o = no_options();
    o.pairs = test_random_below(3) == 0 ? SC_PAIRS_EDGE : SC_PAIRS_TRIANGLE;
    o.contact = test_random_below(4) == 0 ? SC_CONTACT_PROPER : SC_CONTACT_TOUCHING;
    o.method = methods[test_random_below(4)];
    o.simd = test_random_below(4) == 0 ? SC_SIMD_BASE : SC_SIMD_BEST;
    return o;
}

/* Asks for pairs, for their number, for any, and with arrays that are too short. */
static void check_answers(const scene *s, const sc_query_options *options, const found_list *wanted)
{
    const uint64_t ranges = found_list_ranges(wanted);
    sc_query_options o = *options;
    asked a;
    ask(s, &o, wanted->count, ranges, &a);
    CHECK_MSG(a.status == SC_OK && is_wanted(wanted, &a),
              "%s, %u objects: %llu pairs in %llu ranges of %llu in %llu, state %llu",
              sc_status_string(a.status), s->count, (unsigned long long)a.result.count,
              (unsigned long long)a.result.range_count, (unsigned long long)wanted->count,
              (unsigned long long)ranges, (unsigned long long)s->state);
    CHECK(a.result.collides == (wanted->count > 0));
    CHECK(a.result.verdict == (wanted->count ? SC_VERDICT_FOUND : SC_VERDICT_CLEAN));
    forget(&a);
    o.output = test_random_below(2) ? SC_OUTPUT_COUNT : SC_OUTPUT_ANY;
    ask(s, &o, 0, ranges, &a);
    CHECK(a.status == SC_OK && a.result.collides == (wanted->count > 0));
    CHECK(a.result.count == (o.output == SC_OUTPUT_ANY ? wanted->count > 0 : wanted->count));
    forget(&a);
    if (!wanted->count) return;
    o.output = SC_OUTPUT_PAIRS;
    ask(s, &o, test_random_below((uint32_t)wanted->count), ranges, &a);
    CHECK(a.status == SC_ERROR_SHORT_BUFFER && a.result.count == wanted->count &&
          a.result.range_count == ranges);
    for (uint64_t i = 0; i < a.result.range_count; ++i) { /* whole ranges that fit are there */
        const sc_object_pairs *r = &a.result.ranges[i];
        if (r->first + r->count > a.result.capacity) break;
        for (uint64_t k = r->first; k < r->first + r->count; ++k)
            CHECK(a.result.pairs[k].a == wanted->at[k].a && a.result.pairs[k].b == wanted->at[k].b);
    }
    forget(&a);
}

/* ---- tests ---- */

/* Random scenes; then some objects move, and the others keep what is known of them. */
static void scenes_are_one_mesh(void)
{
    uint64_t pairs = 0, between = 0, kept = 0;
    for (uint32_t trial = test_iterations_at_least(300, 60); trial-- > 0 && !test_failures();) {
        scene s;
        if (!scene_open(&s, trial % 8 ? 6 : OBJECTS_MAX, trial % 16 ? 60 : 400, 1, 0)) return;
        for (int call = 0; call < 3; ++call) {
            const sc_query_options o = any_options();
            found_list wanted = expect(&s, &o);
            for (uint64_t i = 0; i < wanted.count; ++i)
                between += wanted.at[i].object_a != wanted.at[i].object_b;
            pairs += wanted.count;
            check_answers(&s, &o, &wanted);
            free(wanted.at);
            for (uint32_t i = 0; i < s.count; ++i)
                if (test_random_below(2)) {
                    scene_pose_thing(&s, i);
                    if (s.objects[i].pose_version) s.objects[i].pose_version++;
                } else {
                    kept += s.objects[i].pose_version != 0;
                }
        }
        scene_close(&s);
    }
    CHECK_MSG(pairs > 1000 && between > 500 && kept > 50, "%llu pairs, %llu between, %llu kept",
              (unsigned long long)pairs, (unsigned long long)between, (unsigned long long)kept);
}

/* An object whose version stays is not looked at again: its positions may be gone. */
static void what_stays_is_not_read(void)
{
    scene s;
    asked first, second;
    sc_query_options o = no_options();
    float *kept;
    if (!scene_open(&s, 1, 10, 1, 0)) return;
    while (s.count < 3)
        if (!scene_open_thing(&s, s.count++, 200)) return;
    for (uint32_t i = 0; i < s.count; ++i) s.objects[i].pose_version = 1;
    ask(&s, &o, 100000, 100, &first);
    CHECK(first.status == SC_OK);
    o.output = SC_OUTPUT_COUNT;
    ask(&s, &o, 0, 0, &second);
    CHECK(second.result.count == first.result.count);
    forget(&second);
    /* a new version with NaN is read */
    kept = s.things[1].floats[0];
    for (uint32_t v = 0; v < 3 * s.things[1].mesh.vertex_count; ++v) kept[v] = (float)NAN;
    s.things[1].pose[0].position_type = SC_FLOAT;
    s.things[1].pose[0].positions = kept;
    s.objects[1].pose_version = 2;
    ask(&s, &o, 0, 0, &second);
    CHECK(second.status == SC_ERROR_NOT_FINITE && second.result.count == 0 &&
          second.result.verdict == SC_VERDICT_NONE);
    forget(&second);
    forget(&first);
    scene_close(&s);
}

/* The host's tasks change nothing, nor does a workspace for fewer workers. */
static void tasks_change_nothing(void)
{
    for (uint32_t trial = test_iterations_at_least(24, 6); trial-- > 0 && !test_failures();) {
        scene s;
        host h;
        int way = HOST_FIRST + (int)(trial % (HOST_COUNT - HOST_FIRST));
        sc_query_options o = any_options();
        found_list wanted;
        if (!scene_open(&s, 2, 6000, THREADS_MAX, 0)) return;
        if (trial % 3 == 0 && s.count < OBJECTS_MAX) {
            s.workers = 1;
            if (!scene_open_thing(&s, s.count++, 2000)) return;
        }
        wanted = expect(&s, &o);
        host_start(&h, way, 2 + trial % 3);
        o.tasks = &h.tasks;
        check_answers(&s, &o, &wanted);
        CHECK(h.mistakes == 0);
        host_stop(&h);
        free(wanted.at);
        scene_close(&s);
    }
}

/* Its rest pose, moved a little: no pose of large meshes in which most pairs need exact signs. */
static void pose_large_thing(thing *t)
{
    for (uint32_t i = 0; i < 3 * t->mesh.vertex_count; ++i) {
        t->posed[0][i] = t->mesh.positions[i] + 0.01 * (double)(i % 3);
        t->floats[0][i] = (float)t->posed[0][i];
        if (t->is_float) t->posed[0][i] = (double)t->floats[0][i];
    }
}

/* Two objects of which each is worth a job, in workspaces that were never asked before. */
static void large_objects_share_work(void)
{
    for (uint32_t trial = test_iterations_at_least(8, 2); trial-- > 0 && !test_failures();) {
        const soup sphere = soup_sphere(60, 40 + test_random_below(40)), cloth = soup_cloth(60, 50);
        scene s;
        host h;
        int way = HOST_FIRST + (int)(trial % (HOST_COUNT - HOST_FIRST));
        sc_query_options o = any_options();
        found_list wanted;
        memset(&s, 0, sizeof s);
        s.state = test_random_state();
        s.workers = THREADS_MAX;
        s.count = 2;
        if (!scene_open_thing_of(&s, trial % 2, &sphere) ||
            !scene_open_thing_of(&s, 1 - trial % 2, &cloth))
            return;
        for (uint32_t i = 0; i < 2; ++i) {
            s.objects[i].group.category = s.objects[i].group.mask = 0;
            s.objects[i].itself = test_random_below(2);
            pose_large_thing(&s.things[i]);
        }
        wanted = expect(&s, &o);
        host_start(&h, way, 2 + trial % 3);
        o.tasks = &h.tasks;
        check_answers(&s, &o, &wanted);
        CHECK(h.mistakes == 0 && h.jobs > 0);
        host_stop(&h);
        free(wanted.at);
        scene_close(&s);
    }
}

static int accept_some(void *user, uint32_t object_a, uint32_t object_b, uint32_t a, uint32_t b)
{
    ++*(uint64_t *)user;
    return (object_a + object_b + a + b) % 3 != 0;
}

static void the_function_leaves_pairs_out(void)
{
    uint64_t calls = 0, between = 0;
    for (uint32_t trial = test_iterations_at_least(60, 10); trial-- > 0 && !test_failures();) {
        scene s;
        sc_objects objects;
        sc_objects_result r;
        sc_query_options o = any_options();
        found_list wanted;
        uint64_t kept = 0;
        if (!scene_open(&s, 5, 60, 1, 0)) return;
        wanted = expect(&s, &o);
        for (uint64_t i = 0; i < wanted.count; ++i) {
            const found *f = &wanted.at[i];
            between += f->object_a != f->object_b;
            kept +=
                f->object_a == f->object_b || (f->object_a + f->object_b + f->a + f->b) % 3 != 0;
        }
        memset(&objects, 0, sizeof objects);
        objects.struct_size = sizeof objects;
        objects.count = s.count;
        objects.objects = s.objects;
        objects.accept = accept_some;
        objects.accept_user = &calls;
        memset(&r, 0, sizeof r);
        r.struct_size = sizeof r;
        o.output = SC_OUTPUT_COUNT;
        CHECK(sc_query_objects(&objects, &o, &r) == SC_OK && r.count == kept);
        free(wanted.at);
        scene_close(&s);
    }
    CHECK(calls == between && calls > 0);
}

/* A group that is of nothing, or collides with nothing, and is not both. */
static void half_a_group_collides_with_nothing(void)
{
    static const sc_group half[] = {{0, 0xffffffffu}, {0xffffffffu, 0}};
    const sc_query_options o = no_options();
    const soup mesh = soup_cloth(4, 4);
    scene s;
    asked a;
    memset(&s, 0, sizeof s);
    s.workers = 1;
    s.count = 2;
    if (!scene_open_thing_of(&s, 0, &mesh) || !scene_open_thing_of(&s, 1, NULL)) return;
    for (uint32_t i = 0; i < 2; ++i) {
        pose_large_thing(&s.things[i]);
        s.objects[i].itself = 0;
        s.objects[i].group.category = s.objects[i].group.mask = 0;
        s.objects[i].pose = &s.things[0].pose[0]; /* in one place */
    }
    ask(&s, &o, 1000, 10, &a);
    CHECK(a.status == SC_OK && a.result.count > 0 && a.result.range_count == 1);
    forget(&a);
    for (uint32_t i = 0; i < 4; ++i) {
        const sc_group all = {0, 0};
        s.objects[i % 2].group = half[i / 2];
        s.objects[1 - i % 2].group = all;
        ask(&s, &o, 1000, 10, &a);
        CHECK(a.status == SC_OK && a.result.verdict == SC_VERDICT_CLEAN && a.result.count == 0);
        forget(&a);
    }
    scene_close(&s);
}

/* Whole numbers times a power of two, down to the smallest doubles and up to where no float is as
   large as the middle of the box: the same pairs. */
static void scenes_are_of_any_size(void)
{
    static const int exponents[] = {-1074, -1040, -149, 130, 1000};
    uint64_t pairs = 0;
    for (uint32_t trial = test_iterations_at_least(40, 8); trial-- > 0 && !test_failures();) {
        const sc_query_options o = any_options();
        scene s;
        found_list wanted;
        if (!scene_open(&s, 5, 60, 1, 0)) return;
        for (uint32_t i = 0; i < s.count; ++i) {
            thing *t = &s.things[i];
            s.objects[i].pose_version = 0;
            t->pose[0].position_type = SC_DOUBLE;
            t->pose[0].positions = t->posed[0];
            for (uint32_t v = 0; v < 3 * t->mesh.vertex_count; ++v)
                t->posed[0][v] = floor(8 * fmod(t->posed[0][v], 64)) + 100;
        }
        wanted = expect(&s, &o);
        pairs += wanted.count;
        for (uint32_t k = 0; k < sizeof exponents / sizeof exponents[0]; ++k) {
            for (uint32_t i = 0; i < s.count; ++i)
                for (uint32_t v = 0; v < 3 * s.things[i].mesh.vertex_count; ++v)
                    s.things[i].posed[0][v] =
                        ldexp(s.things[i].posed[0][v], exponents[k] - (k ? exponents[k - 1] : 0));
            check_answers(&s, &o, &wanted);
        }
        free(wanted.at);
        scene_close(&s);
    }
    CHECK(pairs > 100);
}

/* Of a model for boxes that is asked about itself, no culling. */
static void boxes_alone_are_not_culled(void)
{
    scene s;
    sc_mesh mesh;
    sc_build_options options;
    sc_model *full, *boxes = NULL;
    sc_query_options o = no_options();
    asked a;
    if (!scene_open(&s, 1, 40, 1, 0)) return;
    mesh = input_plain_mesh(&s.things[0].mesh);
    memset(&options, 0, sizeof options);
    options.struct_size = sizeof options;
    options.rest = SC_REST_UNMARKED;
    options.content = SC_MODEL_BOXES;
    full = s.things[0].model;
    sc_workspace_free(s.things[0].workspace);
    s.things[0].workspace = NULL;
    if (CHECK(sc_build(&mesh, &options, &boxes) == SC_OK) &&
        CHECK(sc_workspace_create(boxes, NULL, &s.things[0].workspace) == SC_OK)) {
        s.objects[0].model = boxes;
        s.objects[0].workspace = s.things[0].workspace;
        o.output = SC_OUTPUT_COUNT;
        for (uint32_t itself = 0; itself < 2; ++itself) {
            s.objects[0].itself = itself;
            o.method = SC_METHOD_SCTT;
            ask(&s, &o, 0, 0, &a);
            CHECK(a.status == (itself ? SC_ERROR_BOXES_ONLY : SC_OK));
            CHECK(a.result.verdict == (itself ? SC_VERDICT_NONE : SC_VERDICT_CLEAN));
            forget(&a);
            o.method = SC_METHOD_DEFAULT;
            ask(&s, &o, 0, 0, &a);
            CHECK(a.status == SC_OK);
            forget(&a);
        }
    }
    sc_workspace_free(s.things[0].workspace);
    s.things[0].workspace = NULL;
    sc_model_free(boxes);
    s.things[0].model = full;
    scene_close(&s);
}

static void bad_scenes_are_refused(void)
{
    scene s;
    sc_objects objects;
    sc_objects_result r;
    sc_query_options o = no_options();
    sc_filter filter;
    sc_stats stats;
    if (!scene_open(&s, 1, 40, 1, 0)) return;
    while (s.count < 3)
        if (!scene_open_thing(&s, s.count++, 40)) return;
    memset(&objects, 0, sizeof objects);
    objects.struct_size = sizeof objects;
    memset(&r, 0, sizeof r);
    r.struct_size = sizeof r;
    CHECK(sc_query_objects(&objects, NULL, &r) == SC_OK && r.verdict == SC_VERDICT_CLEAN);
    objects.count = s.count;
    CHECK(sc_query_objects(&objects, NULL, &r) == SC_ERROR_NULL);
    objects.objects = s.objects;
    CHECK(sc_query_objects(NULL, NULL, &r) == SC_ERROR_NULL);
    CHECK(sc_query_objects(&objects, NULL, NULL) == SC_ERROR_NULL);
    objects.stride = sizeof(sc_object) - 8;
    CHECK(sc_query_objects(&objects, NULL, &r) == SC_ERROR_STRIDE);
    objects.stride = 0;
    objects.struct_size = 4;
    CHECK(sc_query_objects(&objects, NULL, &r) == SC_ERROR_STRUCT_SIZE);
    objects.struct_size = sizeof objects;
    s.objects[1].workspace = s.objects[0].workspace;
    s.objects[1].model = s.objects[0].model;
    s.objects[1].pose = s.objects[0].pose;
    CHECK(sc_query_objects(&objects, NULL, &r) == SC_ERROR_WORKSPACE);
    s.objects[1].workspace = s.things[1].workspace;
    s.objects[1].model = s.things[1].model;
    s.objects[1].pose = NULL;
    CHECK(sc_query_objects(&objects, NULL, &r) == SC_ERROR_NULL);
    s.objects[1].pose = &s.things[1].pose[0];
    s.things[1].pose[0].vertex_count++;
    CHECK(sc_query_objects(&objects, NULL, &r) == SC_ERROR_VERTEX_COUNT);
    s.things[1].pose[0].vertex_count--;
    s.objects[2].end = &s.things[2].pose[0];
    CHECK(sc_query_objects(&objects, NULL, &r) == SC_ERROR_OPTION);
    s.objects[2].end = NULL;
    s.objects[2].itself = 2;
    CHECK(sc_query_objects(&objects, NULL, &r) == SC_ERROR_OPTION);
    s.objects[2].itself = 1;
    memset(&filter, 0, sizeof filter);
    filter.struct_size = sizeof filter;
    o.filter = &filter;
    CHECK(sc_query_objects(&objects, &o, &r) == SC_ERROR_OPTION);
    s.objects[2].filter = &filter;
    filter.ignore_rings = SC_RINGS_MAX + 1;
    CHECK(sc_query_objects(&objects, NULL, &r) == SC_ERROR_OPTION);
    s.objects[2].filter = NULL;
    o.filter = NULL;
    o.budget = 1;
    CHECK(sc_query_objects(&objects, &o, &r) == SC_ERROR_OPTION);
    o.budget = 0;
    o.contour = SC_CONTOUR_STAR;
    CHECK(sc_query_objects(&objects, &o, &r) == SC_ERROR_OPTION);
    o.contour = SC_CONTOUR_DEFAULT;
    r.capacity = 1;
    CHECK(sc_query_objects(&objects, &o, &r) == SC_ERROR_NULL);
    r.capacity = 0;
    r.range_capacity = 1;
    CHECK(sc_query_objects(&objects, &o, &r) == SC_ERROR_NULL);
    r.range_capacity = 0;
    memset(&stats, 0, sizeof stats);
    stats.struct_size = sizeof stats + 4;
    r.stats = &stats;
    r.count = 7;
    CHECK(sc_query_objects(&objects, &o, &r) == SC_ERROR_STRUCT_SIZE && r.count == 0 &&
          r.verdict == SC_VERDICT_NONE);
    scene_close(&s);
}

SC_TEST_MAIN(SC_TEST(scenes_are_one_mesh), SC_TEST(what_stays_is_not_read),
             SC_TEST(tasks_change_nothing), SC_TEST(large_objects_share_work),
             SC_TEST(the_function_leaves_pairs_out), SC_TEST(half_a_group_collides_with_nothing),
             SC_TEST(scenes_are_of_any_size), SC_TEST(boxes_alone_are_not_culled),
             SC_TEST(bad_scenes_are_refused))
