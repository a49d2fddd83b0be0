/*
 * Several objects in one query: the same pairs as one mesh of all of them in which nothing of one is
 * welded to anything of another; whatever was kept from one call to the next, with tasks and
 * without. And what is refused.
 *
 * SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "harness.h"
#include "shapes.h"
#include "soups.h"
#include "starcontour.h"
#include "tasks.h"

enum { OBJECTS_MAX = 20 };

/* An object with what it is made of. */
typedef struct thing {
    soup mesh;   /* its positions are the rest pose */
    int is_copy; /* mesh and model are those of another one */
    uint32_t weld;
    sc_model *model;
    sc_workspace *workspace;
    double *posed; /* 3 * vertex_count */
    float *floats; /* the same, if the pose is of floats */
    int is_float;
    sc_pose pose;
} thing;

typedef struct scene {
    uint32_t count, workers;
    thing things[OBJECTS_MAX];
    sc_object objects[OBJECTS_MAX];
    uint64_t state; /* of random numbers, to make it again */
} scene;

/* What is to be found, or what was: pairs with their objects. */
typedef struct found {
    uint32_t object_a, object_b, a, b;
} found;

typedef struct found_list {
    found *at;
    uint64_t count;
} found_list;

/* ---- scenes ---- */

static sc_model *build(const soup *mesh, uint32_t weld, const uint32_t *map)
{
    sc_build_options options;
    sc_model *model = NULL;
    sc_mesh m;
    memset(&m, 0, sizeof m);
    m.struct_size = sizeof m;
    m.vertex_count = mesh->vertex_count;
    m.triangle_count = mesh->triangle_count;
    m.position_type = SC_DOUBLE;
    m.index_type = SC_UINT32;
    m.positions = mesh->positions;
    m.indices = mesh->triangles;
    memset(&options, 0, sizeof options);
    options.struct_size = sizeof options;
    options.weld = weld;
    options.weld_map = map;
    CHECK(sc_build(&m, &options, &model) == SC_OK);
    return model;
}

static sc_workspace *work_for(const sc_model *model, uint32_t workers)
{
    const sc_workspace_options options = options_for_workers(workers);
    sc_workspace *workspace = NULL;
    CHECK(sc_workspace_create_for(model, &options, &workspace) == SC_OK);
    return workspace;
}

/* Gives an object a pose near the others, often on a grid or in the place of another one. */
static void pose_thing(scene *s, uint32_t i)
{
    thing *t = &s->things[i];
    const uint32_t count = t->mesh.vertex_count;
    const int snaps = test_random_below(3) == 0;
    uint32_t v;
    double offset[3];
    memcpy(t->posed, t->mesh.positions, sizeof(double) * 3 * count);
    if (test_random_below(2)) soup_any_pose(t->posed, count);
    if (t->is_copy && test_random_below(4) == 0) { /* the same pose as the one it is a copy of */
        memcpy(t->posed, s->things[i - 1].posed, sizeof(double) * 3 * count);
    } else {
        for (int k = 0; k < 3; ++k) {
            offset[k] = test_random_range(-1, 1) * (test_random_below(3) ? 0.3 : 2);
            if (snaps) offset[k] = round(4 * offset[k]) / 4;
        }
        for (v = 0; v < count; ++v)
            for (uint32_t k = 0; k < 3; ++k) t->posed[3 * v + k] += offset[k];
        if (snaps) soup_snap(t->posed, count, 0.125);
    }
    t->is_float = test_random_below(3) == 0;
    if (t->is_float) soup_round_to_float(t->posed, count);
    for (v = 0; v < 3 * count; ++v) t->floats[v] = (float)t->posed[v];
    t->pose.position_type = t->is_float ? SC_FLOAT : SC_DOUBLE;
    t->pose.positions = t->is_float ? (const void *)t->floats : (const void *)t->posed;
}

/* An object of a mesh, which it takes over; NULL: of that of the one before it. */
static int open_thing_of(scene *s, uint32_t i, const soup *mesh)
{
    thing *t = &s->things[i];
    sc_object *o = &s->objects[i];
    t->is_copy = !mesh;
    if (!mesh) {
        t->mesh = s->things[i - 1].mesh;
        t->model = s->things[i - 1].model;
        t->weld = s->things[i - 1].weld;
    } else {
        t->mesh = *mesh;
        t->weld = test_random_below(2) ? SC_WELD_REST : SC_WELD_NONE;
        t->model = build(&t->mesh, t->weld, NULL);
        if (!t->model) return 0;
    }
    t->workspace = work_for(t->model, s->workers);
    if (!t->workspace) return 0;
    t->posed = (double *)test_allocate(sizeof(double) * 3 * t->mesh.vertex_count);
    t->floats = (float *)test_allocate(sizeof(float) * 3 * t->mesh.vertex_count);
    memset(&t->pose, 0, sizeof t->pose);
    t->pose.struct_size = sizeof t->pose;
    t->pose.vertex_count = t->mesh.vertex_count;
    memset(o, 0, sizeof *o);
    o->model = t->model;
    o->workspace = t->workspace;
    o->pose = &t->pose;
    o->itself = test_random_below(4) > 0;
    o->pose_version = test_random_below(2);
    if (test_random_below(4) == 0) {
        o->group.category = 1u + test_random_below(3);
        o->group.mask = 1u + test_random_below(3);
    }
    pose_thing(s, i);
    return 1;
}

static int open_thing(scene *s, uint32_t i, uint32_t maximum)
{
    const char *name;
    soup mesh;
    if (i > 0 && test_random_below(3) == 0) return open_thing_of(s, i, NULL);
    mesh = shape_any(2 + test_random_below(maximum), &name);
    return open_thing_of(s, i, &mesh);
}

static int open_scene(scene *s, uint32_t most, uint32_t maximum, uint32_t workers)
{
    memset(s, 0, sizeof *s);
    s->state = test_random_state();
    s->workers = workers;
    s->count = 1 + test_random_below(most);
    for (uint32_t i = 0; i < s->count; ++i)
        if (!open_thing(s, i, maximum)) return 0;
    return 1;
}

static void close_scene(scene *s)
{
    for (uint32_t i = 0; i < s->count; ++i) {
        thing *t = &s->things[i];
        sc_workspace_free(t->workspace);
        free(t->posed);
        free(t->floats);
        if (t->is_copy) continue;
        sc_model_free(t->model);
        soup_free(&t->mesh);
    }
}

/* ---- one mesh of all ---- */

static int groups_let(const sc_object *a, const sc_object *b)
{
    const int all_a = !a->group.category && !a->group.mask;
    const int all_b = !b->group.category && !b->group.mask;
    const uint32_t ca = all_a ? ~0u : a->group.category, ma = all_a ? ~0u : a->group.mask;
    const uint32_t cb = all_b ? ~0u : b->group.category, mb = all_b ? ~0u : b->group.mask;
    return (ca & mb) && (cb & ma);
}

static int compare_found(const void *x, const void *y)
{
    const found *p = (const found *)x, *q = (const found *)y;
    if (p->object_a != q->object_a) return p->object_a < q->object_a ? -1 : 1;
    if (p->object_b != q->object_b) return p->object_b < q->object_b ? -1 : 1;
    if (p->a != q->a) return p->a < q->a ? -1 : 1;
    return p->b == q->b ? 0 : p->b < q->b ? -1 : 1;
}

/* Which vertices of an object are one: the lowest of those that triangles use. */
static void weld_thing(const thing *t, uint32_t first, uint32_t *map)
{
    const uint32_t count = t->mesh.vertex_count;
    uint8_t *used = (uint8_t *)test_allocate(count);
    memset(used, 0, count);
    for (uint32_t i = 0; i < 3 * t->mesh.triangle_count; ++i) used[t->mesh.triangles[i]] = 1;
    for (uint32_t v = 0; v < count; ++v) {
        const double *p = t->mesh.positions + 3 * (size_t)v;
        map[v] = first + v;
        for (uint32_t u = 0; t->weld == SC_WELD_REST && used[v] && u < v; ++u) {
            const double *q = t->mesh.positions + 3 * (size_t)u;
            if (!used[u] || p[0] != q[0] || p[1] != q[1] || p[2] != q[2]) continue;
            map[v] = first + u;
            break;
        }
    }
    free(used);
}

/* The object of a triangle of the whole, and its number there. */
static uint32_t split(const uint32_t *first, uint32_t count, uint32_t *triangle)
{
    uint32_t i = count - 1;
    while (first[i] > *triangle) --i;
    *triangle -= first[i];
    return i;
}

/* What one mesh of all objects says. */
static found_list expect(const scene *s, const sc_query_options *options)
{
    uint32_t vertices = 0, triangles = 0, first[OBJECTS_MAX], *map, at = 0;
    const int edges = options->pairs == SC_PAIRS_EDGE;
    sc_query_options o = *options;
    sc_workspace *workspace;
    sc_model *model;
    sc_result result;
    sc_pose pose;
    found_list list = {NULL, 0};
    soup whole;
    double *posed;
    for (uint32_t i = 0; i < s->count; ++i) {
        first[i] = triangles;
        vertices += s->things[i].mesh.vertex_count;
        triangles += s->things[i].mesh.triangle_count;
    }
    whole = soup_make(vertices, triangles);
    map = (uint32_t *)test_allocate(sizeof *map * vertices);
    posed = (double *)test_allocate(sizeof *posed * 3 * vertices);
    for (uint32_t i = 0; i < s->count; ++i) {
        const thing *t = &s->things[i];
        const size_t count = 3 * (size_t)t->mesh.vertex_count;
        memcpy(whole.positions + 3 * (size_t)at, t->mesh.positions, count * sizeof(double));
        memcpy(posed + 3 * (size_t)at, t->posed, count * sizeof(double));
        for (uint32_t k = 0; k < 3 * t->mesh.triangle_count; ++k)
            whole.triangles[3 * (size_t)first[i] + k] = at + t->mesh.triangles[k];
        weld_thing(t, at, map + at);
        at += t->mesh.vertex_count;
    }
    model = build(&whole, SC_WELD_MAP, map);
    workspace = model ? work_for(model, 1) : NULL;
    memset(&pose, 0, sizeof pose);
    pose.struct_size = sizeof pose;
    pose.vertex_count = vertices;
    pose.position_type = SC_DOUBLE;
    pose.positions = posed;
    memset(&result, 0, sizeof result);
    result.struct_size = sizeof result;
    o.tasks = NULL;
    o.output = SC_OUTPUT_COUNT;
    o.method = SC_METHOD_DEFAULT;
    if (workspace && CHECK(sc_query(model, workspace, &pose, &o, &result) == SC_OK)) {
        result.capacity = result.count;
        result.pairs = (sc_pair *)test_allocate(sizeof(sc_pair) * result.count);
        list.at = (found *)test_allocate(sizeof(found) * result.count);
        o.output = SC_OUTPUT_PAIRS;
        CHECK(sc_query(model, workspace, &pose, &o, &result) == SC_OK);
        for (uint64_t i = 0; i < result.count; ++i) {
            found *f = &list.at[list.count];
            uint32_t a = edges ? result.pairs[i].a / 3 : result.pairs[i].a;
            f->b = result.pairs[i].b;
            f->object_a = split(first, s->count, &a);
            f->a = edges ? 3 * a + result.pairs[i].a % 3 : a;
            f->object_b = split(first, s->count, &f->b);
            if (f->object_a == f->object_b
                    ? s->objects[f->object_a].itself != 0
                    : groups_let(&s->objects[f->object_a], &s->objects[f->object_b]))
                list.count++;
        }
        qsort(list.at, list.count, sizeof *list.at, compare_found);
        free(result.pairs);
    }
    sc_workspace_free(workspace);
    sc_model_free(model);
    soup_free(&whole);
    free(map);
    free(posed);
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

static uint64_t count_ranges(const found_list *wanted)
{
    uint64_t count = 0, i;
    for (i = 0; i < wanted->count; ++i)
        count += i == 0 || wanted->at[i].object_a != wanted->at[i - 1].object_a ||
                 wanted->at[i].object_b != wanted->at[i - 1].object_b;
    return count;
}

/* Whether an answer is what is wanted, pair by pair. */
static int is_wanted(const found_list *wanted, const asked *a)
{
    uint64_t i, k, at = 0;
    if (a->result.count != wanted->count || a->result.range_count != count_ranges(wanted)) return 0;
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
    const uint64_t ranges = count_ranges(wanted);
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
        if (!open_scene(&s, trial % 8 ? 6 : OBJECTS_MAX, trial % 16 ? 60 : 400, 1)) return;
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
                    pose_thing(&s, i);
                    if (s.objects[i].pose_version) s.objects[i].pose_version++;
                } else {
                    kept += s.objects[i].pose_version != 0;
                }
        }
        close_scene(&s);
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
    if (!open_scene(&s, 1, 10, 1)) return;
    while (s.count < 3)
        if (!open_thing(&s, s.count++, 200)) return;
    for (uint32_t i = 0; i < s.count; ++i) s.objects[i].pose_version = 1;
    ask(&s, &o, 100000, 100, &first);
    CHECK(first.status == SC_OK);
    o.output = SC_OUTPUT_COUNT;
    ask(&s, &o, 0, 0, &second);
    CHECK(second.result.count == first.result.count);
    forget(&second);
    /* a new version with NaN is read */
    kept = s.things[1].floats;
    for (uint32_t v = 0; v < 3 * s.things[1].mesh.vertex_count; ++v) kept[v] = (float)NAN;
    s.things[1].pose.position_type = SC_FLOAT;
    s.things[1].pose.positions = kept;
    s.objects[1].pose_version = 2;
    ask(&s, &o, 0, 0, &second);
    CHECK(second.status == SC_ERROR_NOT_FINITE && second.result.count == 0 &&
          second.result.verdict == SC_VERDICT_NONE);
    forget(&second);
    forget(&first);
    close_scene(&s);
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
        if (!open_scene(&s, 2, 6000, THREADS_MAX)) return;
        if (trial % 3 == 0 && s.count < OBJECTS_MAX) {
            s.workers = 1;
            if (!open_thing(&s, s.count++, 2000)) return;
        }
        wanted = expect(&s, &o);
        host_start(&h, way, 2 + trial % 3);
        o.tasks = &h.tasks;
        check_answers(&s, &o, &wanted);
        CHECK(h.mistakes == 0);
        host_stop(&h);
        free(wanted.at);
        close_scene(&s);
    }
}

/* Its rest pose, moved a little: no pose of large meshes in which most pairs need exact signs. */
static void pose_large_thing(thing *t)
{
    for (uint32_t i = 0; i < 3 * t->mesh.vertex_count; ++i) {
        t->posed[i] = t->mesh.positions[i] + 0.01 * (double)(i % 3);
        t->floats[i] = (float)t->posed[i];
        if (t->is_float) t->posed[i] = (double)t->floats[i];
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
        if (!open_thing_of(&s, trial % 2, &sphere) || !open_thing_of(&s, 1 - trial % 2, &cloth))
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
        close_scene(&s);
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
        if (!open_scene(&s, 5, 60, 1)) return;
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
        close_scene(&s);
    }
    CHECK(calls == between && calls > 0);
}

static void bad_scenes_are_refused(void)
{
    scene s;
    sc_objects objects;
    sc_objects_result r;
    sc_query_options o = no_options();
    sc_filter filter;
    if (!open_scene(&s, 1, 40, 1)) return;
    while (s.count < 3)
        if (!open_thing(&s, s.count++, 40)) return;
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
    s.objects[1].pose = &s.things[1].pose;
    s.things[1].pose.vertex_count++;
    CHECK(sc_query_objects(&objects, NULL, &r) == SC_ERROR_VERTEX_COUNT);
    s.things[1].pose.vertex_count--;
    s.objects[2].end = &s.things[2].pose;
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
    close_scene(&s);
}

SC_TEST_MAIN(SC_TEST(scenes_are_one_mesh), SC_TEST(what_stays_is_not_read),
             SC_TEST(tasks_change_nothing), SC_TEST(large_objects_share_work),
             SC_TEST(the_function_leaves_pairs_out), SC_TEST(bad_scenes_are_refused))
