/*
 * Filters leave out of steps what they are to leave out and nothing else: the answer without a
 * filter, filtered here by the definitions in starcontour.h, on distances along the mesh found by
 * brute force and distances in the rest pose found in exact arithmetic.
 *
 * SPDX-License-Identifier: MIT
 */
#include <inttypes.h>
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "filter_rules.h"
#include "harness.h"
#include "inputs.h"
#include "run/workspace.h"
#include "shapes.h"
#include "starcontour.h"
#include "step_oracle.h"
#include "tasks.h"

enum { VERTEX_FACE, EDGE_EDGE, KINDS };

/* One of the two lists of a step. */
typedef struct step_list {
    sc_pair *pairs;
    double *times;
    signed char *is_near; /* in the rest pose; -1: not yet known */
    uint64_t count;
} step_list;

/* A mesh in motion, ready to be asked, and what there is to know of it by brute force. */
typedef struct subject {
    soup mesh;
    const char *name;
    double *start, *end, *rest; /* packed */
    input_array rest_array;
    sc_pose from, to, rest_pose;
    double rest_distance, separation;
    input_choices choices;
    uint32_t *weld;
    uint8_t *apart; /* see filter_rules.h; not of large meshes */
    sc_model *model;
    sc_workspace *workspace; /* of two workers */
    host tasks;
    int has_tasks;
    uint64_t state;
} subject;

/* What is asked: the caller's, and what accept says. */
typedef struct wish {
    sc_filter filters[KINDS];
    int has_filter[KINDS], has_rest;
    uint32_t salt;
} wish;

/* What accept was told, by kind. */
typedef struct accept_log {
    sc_pair *pairs;
    uint64_t count, capacity;
    uint32_t salt;
    pthread_t thread;
    int strangers;           /* calls by other threads */
    volatile uint32_t *flag; /* set after so many calls, if not NULL */
    uint64_t until;
} accept_log;

/* ---- subjects ---- */

static double *copy_positions(const soup *mesh)
{
    double *copy = (double *)test_allocate(3 * (size_t)mesh->vertex_count * sizeof(double));
    memcpy(copy, mesh->positions, 3 * (size_t)mesh->vertex_count * sizeof(double));
    return copy;
}

static void set_rest(subject *s, uint32_t type, uint32_t gap)
{
    if (type == SC_FLOAT) soup_round_to_float(s->rest, s->mesh.vertex_count);
    s->rest_array = input_positions(s->rest, s->mesh.vertex_count, type, gap);
    s->rest_pose = input_pose(s->mesh.vertex_count, &s->rest_array);
}

/* What takes a mesh and poses that are set. */
static int finish_subject(subject *s)
{
    sc_workspace_options o = options_for_workers(2);
    sc_mesh input = input_plain_mesh(&s->mesh);
    s->weld = input_weld_of(&s->choices, &s->mesh);
    if (s->mesh.vertex_count < 2000) s->apart = filter_rules_measure(&s->mesh, s->weld);
    s->from = input_plain_pose(s->start, s->mesh.vertex_count);
    s->to = input_plain_pose(s->end, s->mesh.vertex_count);
    o.flags = SC_WORKSPACE_STEP;
    return CHECK(sc_build(&input, &s->choices.options, &s->model) == SC_OK) &&
           CHECK(sc_workspace_create_for(s->model, &o, &s->workspace) == SC_OK);
}

/* Any mesh that goes from one pose to another, and has a third, or its own, as rest pose. */
static int open_subject(subject *s, uint32_t maximum)
{
    static const double separations[] = {0, 1e-3, 0.03, 0.15};
    memset(s, 0, sizeof(*s));
    s->state = test_random_state();
    s->mesh = shape_any(maximum, &s->name);
    s->start = copy_positions(&s->mesh);
    soup_any_pose(s->start, s->mesh.vertex_count);
    s->end = copy_positions(&s->mesh);
    soup_any_pose(s->end, s->mesh.vertex_count);
    s->rest = copy_positions(&s->mesh);
    if (test_random_below(2)) soup_any_pose(s->rest, s->mesh.vertex_count);
    set_rest(s, test_random_below(2) ? SC_FLOAT : SC_DOUBLE, test_random_below(3) * 4);
    s->separation = separations[test_random_below(4)];
    s->rest_distance = 0.01 + 0.3 * test_random_unit();
    s->choices = input_choose(&s->mesh, test_random_below(3), test_random_below(4));
    return finish_subject(s);
}

static void close_subject(subject *s)
{
    if (s->has_tasks) host_stop(&s->tasks);
    sc_workspace_free(s->workspace);
    sc_model_free(s->model);
    free(s->apart);
    free(s->weld);
    free(s->start);
    free(s->end);
    free(s->rest);
    input_free(&s->rest_array);
    input_free_choices(&s->choices);
    soup_free(&s->mesh);
}

static sc_step_options plain_options(const subject *s)
{
    sc_step_options o;
    memset(&o, 0, sizeof(o));
    o.struct_size = sizeof(o);
    o.separation = s->separation;
    o.times = SC_STEP_TIMES_EACH;
    if (s->has_tasks) o.tasks = &s->tasks.tasks;
    return o;
}

/* ---- lists ---- */

static step_list make_list(uint64_t count)
{
    step_list list;
    list.pairs = (sc_pair *)test_allocate((size_t)(count + 1) * sizeof(sc_pair));
    list.times = (double *)test_allocate((size_t)(count + 1) * sizeof(double));
    list.is_near = (signed char *)test_allocate((size_t)count + 1);
    memset(list.is_near, -1, (size_t)count + 1);
    list.count = count;
    return list;
}

static void free_lists(step_list lists[KINDS])
{
    for (int k = 0; k < KINDS; ++k) {
        free(lists[k].pairs);
        free(lists[k].times);
        free(lists[k].is_near);
    }
}

static sc_step_result result_for(step_list lists[KINDS])
{
    sc_step_result r;
    memset(&r, 0, sizeof(r));
    r.struct_size = sizeof(r);
    r.vertex_face_capacity = lists[VERTEX_FACE].count;
    r.vertex_faces = lists[VERTEX_FACE].pairs;
    r.vertex_face_times = lists[VERTEX_FACE].times;
    r.edge_edge_capacity = lists[EDGE_EDGE].count;
    r.edge_edges = lists[EDGE_EDGE].pairs;
    r.edge_edge_times = lists[EDGE_EDGE].times;
    return r;
}

static sc_status ask(const subject *s, const sc_step_options *o, sc_step_result *r)
{
    return sc_query_step(s->model, s->workspace, &s->from, &s->to, o, r);
}

/* All pairs without a filter. */
static void find_all(const subject *s, uint32_t method, uint32_t pairs, step_list all[KINDS])
{
    sc_step_options o = plain_options(s);
    sc_step_result r;
    memset(&r, 0, sizeof(r));
    r.struct_size = sizeof(r);
    o.method = method;
    o.pairs = pairs;
    o.output = SC_OUTPUT_COUNT;
    o.tasks = NULL;
    CHECK(ask(s, &o, &r) == SC_OK);
    all[VERTEX_FACE] = make_list(r.vertex_face_count);
    all[EDGE_EDGE] = make_list(r.edge_edge_count);
    r = result_for(all);
    o.output = SC_OUTPUT_PAIRS;
    CHECK(ask(s, &o, &r) == SC_OK);
}

/* ---- the definitions ---- */

/* The vertices of a pair; returns how many are of the first. */
static uint32_t vertices_of(const subject *s, int kind, sc_pair pair, uint32_t v[4])
{
    const uint32_t *t = s->mesh.triangles;
    if (kind == VERTEX_FACE) {
        v[0] = pair.a;
        for (uint32_t k = 0; k < 3; ++k) v[k + 1] = s->weld[t[3 * pair.b + k]];
        return 1;
    }
    v[0] = s->weld[t[pair.a]];
    v[1] = s->weld[t[pair.a - pair.a % 3 + (pair.a + 1) % 3]];
    v[2] = s->weld[t[pair.b]];
    v[3] = s->weld[t[pair.b - pair.b % 3 + (pair.b + 1) % 3]];
    return 2;
}

/* The group that the triangles at a vertex have together. */
static sc_group group_at(const subject *s, const sc_group *of_triangles, uint32_t v)
{
    sc_group g = {0, 0};
    for (uint32_t i = 0; i < 3 * s->mesh.triangle_count; ++i) {
        if (s->weld[s->mesh.triangles[i]] != v) continue;
        g.category |= of_triangles[i / 3].category;
        g.mask |= of_triangles[i / 3].mask;
    }
    return g;
}

static int is_near_at_rest(const subject *s, int kind, const uint32_t v[4])
{
    double p[4][3];
    const double(*at)[3] = (const double(*)[3])p;
    for (uint32_t k = 0; k < 4; ++k) memcpy(p[k], s->rest + 3 * (size_t)v[k], sizeof(p[k]));
    return step_oracle_is_within(kind == VERTEX_FACE ? STEP_ORACLE_VERTEX_FACE
                                                     : STEP_ORACLE_EDGE_EDGE,
                                 at, at, 0, s->rest_distance, 0);
}

/* Everything but accept. */
static int is_wanted(const subject *s, const wish *w, int kind, step_list *all, uint64_t i)
{
    const sc_filter *f = &w->filters[kind];
    const sc_pair pair = all->pairs[i];
    uint32_t v[4], n = s->mesh.vertex_count, first = vertices_of(s, kind, pair, v);
    if (w->has_rest) {
        if (all->is_near[i] < 0) all->is_near[i] = (signed char)is_near_at_rest(s, kind, v);
        if (all->is_near[i]) return 0;
    }
    if (!w->has_filter[kind]) return 1;
    for (uint32_t j = 0; j < first; ++j)
        for (uint32_t k = first; k < 4; ++k)
            if (s->apart[(size_t)v[j] * n + v[k]] < f->ignore_rings) return 0;
    if (f->triangle_groups) {
        const sc_group *g = f->triangle_groups;
        if (!filter_rules_collide(kind == VERTEX_FACE ? group_at(s, g, pair.a) : g[pair.a / 3],
                                  g[kind == VERTEX_FACE ? pair.b : pair.b / 3]))
            return 0;
    }
    if (f->vertex_groups &&
        !filter_rules_collide(filter_rules_group_of(f->vertex_groups, v, first),
                              filter_rules_group_of(f->vertex_groups, v + first, 4 - first)))
        return 0;
    return f->ignore_count == 0 || bsearch(&pair, f->ignore, (size_t)f->ignore_count,
                                           sizeof(sc_pair), filter_rules_compare) == NULL;
}

/* ---- wishes ---- */

static int32_t log_call(void *user, uint32_t a, uint32_t b)
{
    accept_log *log = (accept_log *)user;
    if (log->count < log->capacity) {
        log->pairs[log->count].a = a;
        log->pairs[log->count].b = b;
    }
    log->count++;
    log->strangers += !pthread_equal(pthread_self(), log->thread);
    if (log->flag && log->count == log->until) *log->flag = 1;
    return filter_rules_is_liked(log->salt, a, b);
}

static accept_log make_log(uint64_t capacity, uint32_t salt)
{
    accept_log log;
    memset(&log, 0, sizeof(log));
    log.pairs = (sc_pair *)test_allocate((size_t)(capacity + 1) * sizeof(sc_pair));
    log.capacity = capacity;
    log.salt = salt;
    log.thread = pthread_self();
    return log;
}

static wish no_wish(void)
{
    wish w;
    memset(&w, 0, sizeof(w));
    for (int k = 0; k < KINDS; ++k) w.filters[k].struct_size = sizeof(sc_filter);
    return w;
}

/* Some of the pairs there are, some twice, and some that are none. */
static step_list random_ignore(const subject *s, int kind, const step_list *all)
{
    uint32_t n = s->mesh.triangle_count;
    step_list list = make_list(2 * all->count + 40);
    list.count = 0;
    for (uint64_t i = 0; i < all->count; ++i)
        for (uint32_t repeats = test_random_below(3); repeats > 0; --repeats)
            list.pairs[list.count++] = all->pairs[i];
    for (uint32_t i = 0; i < 40; ++i) {
        sc_pair p;
        p.a = test_random_below(kind == VERTEX_FACE ? s->mesh.vertex_count : 3 * n);
        p.b = test_random_below(kind == VERTEX_FACE ? n : 3 * n);
        if (kind == VERTEX_FACE || p.a < p.b) list.pairs[list.count++] = p;
    }
    qsort(list.pairs, (size_t)list.count, sizeof(sc_pair), filter_rules_compare);
    return list;
}

/* Bits of a wish: of each kind's filter, and the rest pose. */
enum { RINGS = 1, VERTEX_GROUPS = 2, TRIANGLE_GROUPS = 4, IGNORE = 8, ACCEPT = 16, PARTS = 5 };

static sc_filter make_filter(uint32_t parts, const sc_group *groups[2], const step_list *ignore)
{
    sc_filter f = no_wish().filters[0];
    if (parts & RINGS) f.ignore_rings = 1 + test_random_below(5);
    if (parts & VERTEX_GROUPS) f.vertex_groups = groups[0];
    if (parts & TRIANGLE_GROUPS) f.triangle_groups = groups[1];
    if (parts & IGNORE) {
        f.ignore = ignore->pairs;
        f.ignore_count = ignore->count;
    }
    if (parts & ACCEPT) f.accept = log_call;
    return f;
}

/* ---- comparing ---- */

static int is_head(const step_list *expected, const sc_pair *pairs, const double *times,
                   uint64_t count, int has_times)
{
    for (uint64_t i = 0; i < count; ++i) {
        if (filter_rules_compare(&pairs[i], &expected->pairs[i]) != 0) return 0;
        if (has_times && times[i] != expected->times[i]) return 0;
    }
    return 1;
}

/* What a wish leaves of all pairs, without and with accept, and the least time of the latter. */
static double expect(const subject *s, const wish *w, step_list all[KINDS], step_list asked[KINDS],
                     step_list left[KINDS])
{
    double earliest = 1;
    for (int k = 0; k < KINDS; ++k) {
        asked[k] = make_list(all[k].count);
        left[k] = make_list(all[k].count);
        asked[k].count = left[k].count = 0;
        for (uint64_t i = 0; i < all[k].count; ++i) {
            const sc_pair pair = all[k].pairs[i];
            if (!is_wanted(s, w, k, &all[k], i)) continue;
            asked[k].pairs[asked[k].count++] = pair;
            if (w->has_filter[k] && w->filters[k].accept &&
                !filter_rules_is_liked(w->salt, pair.a, pair.b))
                continue;
            left[k].times[left[k].count] = all[k].times[i];
            left[k].pairs[left[k].count++] = pair;
            if (all[k].times[i] < earliest) earliest = all[k].times[i];
        }
    }
    return earliest;
}

/* Whether accept was asked of all pairs that are to be asked about, once each, by this thread. */
static int was_asked(const accept_log *log, const step_list *asked)
{
    qsort(log->pairs, (size_t)(log->count < log->capacity ? log->count : log->capacity),
          sizeof(sc_pair), filter_rules_compare);
    return log->strangers == 0 && log->count == asked->count &&
           is_head(asked, log->pairs, NULL, asked->count, 0);
}

/* Ways to ask. */
enum { FULL, SHORT, NO_TIMES, NO_ROOM, COUNTED, ANY, ANY_TIMED, WAYS };

/* A step asked in one way. */
static void check_way(const subject *s, const wish *w, sc_step_options o, int way,
                      const step_list asked[KINDS], const step_list left[KINDS], double earliest)
{
    const uint64_t v = left[VERTEX_FACE].count, e = left[EDGE_EDGE].count;
    step_list got[KINDS];
    accept_log logs[KINDS];
    sc_filter filters[KINDS];
    sc_step_result r;
    sc_status status;
    int is_short = way == NO_ROOM && v > 0, finds_all = way < ANY;
    for (int k = 0; k < KINDS; ++k) {
        uint64_t room = asked[k].count; /* with room for what accept refuses */
        if (way == SHORT && left[k].count > 0 && test_random_below(3))
            room = test_random_below((uint32_t)left[k].count);
        is_short |= way == SHORT && room < left[k].count;
        got[k] = make_list(room);
        logs[k] = make_log(asked[k].count, w->salt);
        filters[k] = w->filters[k];
        filters[k].accept_user = &logs[k];
    }
    if (w->has_filter[0]) o.vertex_face_filter = &filters[0];
    if (w->has_filter[1]) o.edge_edge_filter = &filters[1];
    if (w->has_rest) {
        o.rest = &s->rest_pose;
        o.rest_distance = s->rest_distance;
    }
    r = result_for(got);
    if (way == NO_ROOM) r.vertex_face_capacity = 0;
    if (way == NO_TIMES) r.edge_edge_times = NULL;
    o.output = way == COUNTED ? SC_OUTPUT_COUNT : way >= ANY ? SC_OUTPUT_ANY : SC_OUTPUT_PAIRS;
    o.times = way == ANY       ? SC_STEP_TIMES_NONE
              : way == SHORT   ? test_random_below(3)
              : way >= COUNTED ? SC_STEP_TIMES_EARLIEST
                               : SC_STEP_TIMES_EACH;
    status = ask(s, &o, &r);
    if (o.times == SC_STEP_TIMES_NONE) earliest = v + e > 0 ? 0 : 1;
    CHECK_MSG(status == (is_short ? SC_ERROR_SHORT_BUFFER : SC_OK) && r.collides == (v + e > 0) &&
                  r.earliest == earliest &&
                  r.verdict == (v + e > 0 ? SC_VERDICT_FOUND : SC_VERDICT_CLEAN),
              "%s, way %d, method %u: status %d, collides %u, earliest %g instead of %g; state "
              "%" PRIu64,
              s->name, way, o.method, (int)status, r.collides, r.earliest, earliest, s->state);
    if (way >= ANY)
        CHECK(r.vertex_face_count + r.edge_edge_count == (v + e > 0) && r.vertex_face_count <= v &&
              r.edge_edge_count <= e);
    else
        CHECK_MSG(r.vertex_face_count == v && r.edge_edge_count == e,
                  "%s, way %d, method %u, pairs %u: %" PRIu64 ", %" PRIu64 " instead of %" PRIu64
                  ", %" PRIu64 "; state %" PRIu64,
                  s->name, way, o.method, o.pairs, r.vertex_face_count, r.edge_edge_count, v, e,
                  s->state);
    for (int k = 0; k < KINDS; ++k) {
        uint64_t room = k ? r.edge_edge_capacity : r.vertex_face_capacity;
        if (o.output == SC_OUTPUT_PAIRS)
            CHECK(is_head(&left[k], got[k].pairs, got[k].times,
                          room < left[k].count ? room : left[k].count,
                          o.times == SC_STEP_TIMES_EACH && !(way == NO_TIMES && k)));
        if (w->has_filter[k] && w->filters[k].accept && finds_all)
            CHECK_MSG(was_asked(&logs[k], &asked[k]),
                      "%s, way %d: accept was asked %" PRIu64 " times instead of %" PRIu64, s->name,
                      way, logs[k].count, asked[k].count);
        if (way == ANY) { /* asked no more after one that it took */
            uint64_t liked = 0;
            for (uint64_t i = 0; i < logs[k].count && i < logs[k].capacity; ++i) {
                const sc_pair pair = logs[k].pairs[i];
                liked += filter_rules_is_liked(w->salt, pair.a, pair.b) != 0;
            }
            CHECK(liked <= 1);
        }
        free(logs[k].pairs);
    }
    free_lists(got);
}

static const uint32_t methods[] = {SC_STEP_METHOD_SCTT, SC_STEP_METHOD_TWO_BOXES,
                                   SC_STEP_METHOD_SWEPT};

/* A wish in all ways by all methods. Adds to *kept and *dropped. */
static void check_wish(const subject *s, const wish *w, step_list all[KINDS], uint64_t *kept,
                       uint64_t *dropped)
{
    step_list asked[KINDS], left[KINDS];
    double earliest = expect(s, w, all, asked, left);
    for (uint32_t m = 0; m < 3; ++m)
        for (int way = 0; way < WAYS; ++way) {
            sc_step_options o = plain_options(s);
            o.method = methods[m];
            check_way(s, w, o, way, asked, left, earliest);
        }
    for (int k = 0; k < KINDS; ++k) {
        *kept += left[k].count;
        *dropped += all[k].count - left[k].count;
    }
    free_lists(asked);
    free_lists(left);
}

/* The same of candidates, of which each method has its own. */
static void check_candidates(const subject *s, const wish *w)
{
    for (uint32_t m = 0; m < 3; ++m) {
        step_list all[KINDS], asked[KINDS], left[KINDS];
        sc_step_options o = plain_options(s);
        double earliest;
        find_all(s, methods[m], SC_STEP_CANDIDATES, all);
        earliest = expect(s, w, all, asked, left);
        o.method = methods[m];
        o.pairs = SC_STEP_CANDIDATES;
        check_way(s, w, o, FULL, asked, left, earliest);
        free_lists(all);
        free_lists(asked);
        free_lists(left);
    }
}

/* From a salt on, one with which accept leaves out the pair that collides first. */
static uint32_t salt_against_first(const step_list all[KINDS], uint32_t salt)
{
    const sc_pair *first = NULL;
    double earliest = 2;
    for (int k = 0; k < KINDS; ++k)
        for (uint64_t i = 0; i < all[k].count; ++i)
            if (all[k].times[i] < earliest) {
                earliest = all[k].times[i];
                first = &all[k].pairs[i];
            }
    while (first && filter_rules_is_liked(salt, first->a, first->b)) ++salt;
    return salt;
}

/* Each part of a filter alone, then several together; the rest pose in half of them. */
static void check_parts(const subject *s, step_list all[KINDS], uint32_t salt, uint64_t *kept,
                        uint64_t *dropped)
{
    sc_group *vertex_groups = filter_rules_groups(s->mesh.vertex_count);
    sc_group *triangle_groups = filter_rules_groups(s->mesh.triangle_count);
    const sc_group *groups[2];
    step_list ignore[KINDS];
    groups[0] = vertex_groups;
    groups[1] = triangle_groups;
    for (int k = 0; k < KINDS; ++k) ignore[k] = random_ignore(s, k, &all[k]);
    for (uint32_t part = 0; part < PARTS + 4; ++part) {
        wish w = no_wish();
        for (int k = 0; k < KINDS; ++k) {
            uint32_t parts = part < PARTS ? 1u << part : test_random_below(1u << PARTS);
            w.has_filter[k] = part < PARTS || test_random_below(4) > 0;
            w.filters[k] = make_filter(parts, groups, &ignore[k]);
        }
        w.has_rest = part == PARTS || (part > PARTS && test_random_below(2));
        if (part == PARTS) w.has_filter[0] = w.has_filter[1] = 0;
        w.salt = salt_against_first(all, salt);
        check_wish(s, &w, all, kept, dropped);
        if (part >= PARTS && !s->has_tasks && part < PARTS + 2) check_candidates(s, &w);
    }
    free(vertex_groups);
    free(triangle_groups);
    free_lists(ignore);
}

/* Meshes, steps and filters of all kinds. */
static void every_filter(void)
{
    uint64_t kept = 0, dropped = 0;
    for (uint32_t round = 0; round < test_iterations_at_least(16, 6); ++round) {
        subject s;
        if (open_subject(&s, 90)) {
            step_list all[KINDS];
            find_all(&s, SC_STEP_METHOD_SWEPT, SC_STEP_COLLISIONS, all);
            check_parts(&s, all, 1 + round, &kept, &dropped);
            free_lists(all);
        }
        close_subject(&s);
    }
    CHECK_MSG(kept > 1000 && dropped > 1000, "%" PRIu64 " kept, %" PRIu64 " dropped", kept,
              dropped);
}

/* A cloth of one triangle a leaf cluster that waves and folds, with a host of threads. */
static int open_shared(subject *s, uint32_t side, int is_thick)
{
    fixture f;
    memset(s, 0, sizeof(*s));
    if (!fixture_start_tree(&f, soup_cloth(side, side), 1, 0, 0)) return 0;
    s->state = test_random_state();
    s->name = "cloth";
    s->mesh = soup_copy(&f.mesh);
    s->start = copy_positions(&s->mesh);
    soup_smooth(s->start, s->mesh.vertex_count, 0.05);
    s->end = copy_positions(&s->mesh);
    soup_smooth(s->end, s->mesh.vertex_count, 0.1);
    soup_fold(s->end, s->mesh.vertex_count);
    s->rest = copy_positions(&s->mesh);
    set_rest(s, SC_DOUBLE, 0);
    s->separation = is_thick ? 0.3 / side : 0;
    s->rest_distance = 1.3 / side;
    s->choices = input_choose(&s->mesh, SC_WELD_NONE, SC_PARTITION_FAST);
    host_start(&s->tasks, HOST_THREADS, 2);
    s->has_tasks = 1;
    if (!finish_subject(s)) return 0;
    sc_workspace_free(s->workspace);
    sc_model_free(s->model);
    s->model = f.model;
    f.model = NULL;
    fixture_stop(&f);
    {
        sc_workspace_options o = options_for_workers(2);
        o.flags = SC_WORKSPACE_STEP;
        return CHECK(sc_workspace_create_for(s->model, &o, &s->workspace) == SC_OK);
    }
}

/* Of two workers. */
static void several_workers(void)
{
    uint64_t kept = 0, dropped = 0;
    for (uint32_t round = 0; round < test_iterations_at_least(4, 2); ++round) {
        subject s;
        if (open_shared(&s, 14, round % 2)) {
            step_list all[KINDS];
            find_all(&s, SC_STEP_METHOD_SCTT, SC_STEP_COLLISIONS, all);
            check_parts(&s, all, 1 + round, &kept, &dropped);
            CHECK(s.tasks.jobs > 0 && s.tasks.mistakes == 0);
            free_lists(all);
        }
        close_subject(&s);
    }
    CHECK_MSG(kept > 1000 && dropped > 1000, "%" PRIu64 " kept, %" PRIu64 " dropped", kept,
              dropped);
}

/* Every number of rings, on meshes with closed fans, boundaries and hubs, flattened. */
static void every_ring(void)
{
    uint64_t kept = 0, dropped = 0;
    for (uint32_t round = 0; round < test_iterations_at_least(12, 6); ++round) {
        subject s;
        if (open_subject(&s, 90)) {
            step_list all[KINDS];
            soup_crush(s.start, s.mesh.vertex_count);
            s.separation = 0.03;
            find_all(&s, SC_STEP_METHOD_SWEPT, SC_STEP_COLLISIONS, all);
            for (uint32_t rings = 0; rings <= 6; ++rings) {
                wish w = no_wish();
                w.has_filter[0] = w.has_filter[1] = 1;
                w.filters[VERTEX_FACE].ignore_rings = rings;
                w.filters[EDGE_EDGE].ignore_rings = (rings + round) % 7;
                if (rings == 5) s.workspace->worker->ball.epoch = 0xfffd; /* about to wrap */
                check_wish(&s, &w, all, &kept, &dropped);
            }
            free_lists(all);
        }
        close_subject(&s);
    }
    CHECK_MSG(kept > 1000 && dropped > 1000, "%" PRIu64 " kept, %" PRIu64 " dropped", kept,
              dropped);
}

/* ---- rest poses ---- */

/* On integer points many distances are exactly that of the rest pose: they are within it. */
static void rest_ties(void)
{
    uint64_t kept = 0, dropped = 0;
    for (uint32_t round = 0; round < test_iterations_at_least(24, 16); ++round) {
        subject s;
        memset(&s, 0, sizeof(s));
        s.state = test_random_state();
        s.name = "grid";
        s.mesh = soup_on_grid(2 + round % 3);
        s.start = copy_positions(&s.mesh);
        s.end = copy_positions(&s.mesh);
        s.rest = copy_positions(&s.mesh);
        s.separation = 2;
        s.rest_distance = round % 3;
        set_rest(&s, round % 2 ? SC_FLOAT : SC_DOUBLE, 4 * (round % 3));
        s.choices = input_choose(&s.mesh, SC_WELD_REST, SC_PARTITION_FAST);
        if (finish_subject(&s)) {
            step_list all[KINDS];
            wish w = no_wish();
            w.has_rest = 1;
            find_all(&s, SC_STEP_METHOD_SWEPT, SC_STEP_COLLISIONS, all);
            check_wish(&s, &w, all, &kept, &dropped);
            free_lists(all);
        }
        close_subject(&s);
    }
    CHECK_MSG(kept > 10 && dropped > 10, "%" PRIu64 " kept, %" PRIu64 " dropped", kept, dropped);
}

/* A flat cloth with a thickness of two cells lets itself go, and not what falls onto it. */
static void cloth_at_rest(void)
{
    enum { SIDE = 20 };
    soup cloth = soup_cloth(SIDE, SIDE), piece = soup_cloth(1, 1);
    subject s;
    memset(&s, 0, sizeof(s));
    for (uint32_t v = 0; v < piece.vertex_count; ++v) { /* smaller, above the middle */
        for (uint32_t k = 0; k < 2; ++k)
            piece.positions[3 * v + k] = 0.5 + (piece.positions[3 * v + k] - 0.5) * 0.01;
        piece.positions[3 * v + 2] = 0.5;
    }
    s.mesh = soup_join(&cloth, &piece);
    s.name = "cloth at rest";
    s.start = copy_positions(&s.mesh);
    s.end = copy_positions(&s.mesh);
    s.rest = copy_positions(&s.mesh);
    s.separation = s.rest_distance = 2.0 / SIDE;
    set_rest(&s, SC_FLOAT, 0);
    s.choices = input_choose(&s.mesh, SC_WELD_NONE, SC_PARTITION_FAST);
    if (finish_subject(&s)) {
        sc_step_options o = plain_options(&s);
        step_list all[KINDS];
        sc_step_result r;
        find_all(&s, SC_STEP_METHOD_SCTT, SC_STEP_COLLISIONS, all);
        CHECK(all[0].count > 5000 && all[1].count > 5000);
        o.rest = &s.rest_pose;
        o.rest_distance = 1.0001 * s.rest_distance; /* with the tolerance */
        for (int falls = 0; falls < 2; ++falls) {
            for (uint32_t v = cloth.vertex_count; falls && v < s.mesh.vertex_count; ++v)
                s.end[3 * v + 2] = 0;
            r = result_for(all);
            CHECK(ask(&s, &o, &r) == SC_OK);
            CHECK(r.collides == (uint32_t)falls &&
                  (falls ? fabs(r.earliest - 0.8) < 1e-4 : r.earliest == 1));
            CHECK((r.vertex_face_count > 0) == falls && (r.edge_edge_count > 0) == falls);
        }
        free_lists(all);
    }
    close_subject(&s);
    soup_free(&cloth);
    soup_free(&piece);
}

static void note_message(void *user, uint32_t level, const char *message)
{
    (void)level;
    snprintf((char *)user, 200, "%s", message);
}

/* NaN and infinity in a rest pose are found, but in vertices that no triangle has. */
static void rest_not_finite(void)
{
    static const double bad[] = {(double)NAN, HUGE_VAL, -HUGE_VAL};
    soup mesh = soup_cloth(70, 70);
    subject s;
    memset(&s, 0, sizeof(s));
    s.name = "cloth";
    s.mesh = soup_make(mesh.vertex_count + 1, mesh.triangle_count);
    memcpy(s.mesh.positions, mesh.positions, 3 * (size_t)mesh.vertex_count * sizeof(double));
    memset(s.mesh.positions + 3 * (size_t)mesh.vertex_count, 0, 3 * sizeof(double));
    memcpy(s.mesh.triangles, mesh.triangles, 3 * (size_t)mesh.triangle_count * sizeof(uint32_t));
    s.start = copy_positions(&s.mesh);
    s.end = copy_positions(&s.mesh);
    s.rest = copy_positions(&s.mesh);
    set_rest(&s, SC_DOUBLE, 0);
    s.choices = input_choose(&s.mesh, SC_WELD_NONE, SC_PARTITION_FAST);
    host_start(&s.tasks, HOST_THREADS, 2);
    s.has_tasks = 1;
    if (finish_subject(&s)) {
        char message[200] = "", expected[200];
        sc_step_options o = plain_options(&s);
        sc_hooks hooks;
        memset(&hooks, 0, sizeof(hooks));
        hooks.struct_size = sizeof(hooks);
        hooks.log = note_message;
        hooks.user = message;
        CHECK(sc_workspace_set_hooks(s.workspace, &hooks) == SC_OK);
        s.rest_pose = input_plain_pose(s.rest, s.mesh.vertex_count);
        o.rest = &s.rest_pose;
        o.output = SC_OUTPUT_COUNT;
        for (uint32_t i = 0; i < 30; ++i) {
            uint32_t at = test_random_below(3 * mesh.vertex_count);
            double before = s.rest[at];
            sc_step_result r;
            memset(&r, 0xab, sizeof(r));
            r.struct_size = sizeof(r);
            r.stats = NULL;
            if (i == 0) at = 3 * mesh.vertex_count - 1;
            before = s.rest[at];
            s.rest[at] = bad[i % 3];
            CHECK(ask(&s, &o, &r) == SC_ERROR_NOT_FINITE && r.collides == 0 &&
                  r.vertex_face_count == 0 && r.edge_edge_count == 0 &&
                  r.verdict == SC_VERDICT_NONE);
            snprintf(expected, sizeof(expected), "vertex %u is NaN or infinite in the rest pose",
                     at / 3);
            CHECK_MSG(!strcmp(message, expected), "%s", message);
            s.rest[at] = before;
            s.rest[3 * mesh.vertex_count] = bad[i % 3];
            CHECK(ask(&s, &o, &r) == SC_OK);
            s.rest[3 * mesh.vertex_count] = 0;
        }
    }
    close_subject(&s);
    soup_free(&mesh);
}

/* ---- stopping ---- */

/* accept may ask the query to stop: what was found until then is reported. */
static void stopped_by_accept(void)
{
    uint32_t stopped = 0;
    for (uint32_t round = 0; round < test_iterations_at_least(20, 8); ++round) {
        subject s;
        if (open_shared(&s, 14, 1)) {
            volatile uint32_t flag = 0;
            step_list all[KINDS], got[KINDS];
            sc_step_options o = plain_options(&s);
            sc_filter f = no_wish().filters[0];
            accept_log log = make_log(0, 1 + round);
            sc_step_result r;
            sc_status status;
            find_all(&s, SC_STEP_METHOD_SCTT, SC_STEP_COLLISIONS, all);
            for (int k = 0; k < KINDS; ++k) got[k] = make_list(all[k].count);
            log.flag = &flag;
            log.until = 1 + test_random_below(20);
            f.accept = log_call;
            f.accept_user = &log;
            o.vertex_face_filter = o.edge_edge_filter = &f;
            o.cancel = &flag;
            o.tasks = NULL;
            r = result_for(got);
            status = ask(&s, &o, &r);
            if (all[0].count + all[1].count <= log.until) { /* it may end before */
                log.until = log.count;
            } else {
                stopped++;
                CHECK_MSG(status == SC_ERROR_INCOMPLETE && r.verdict == SC_VERDICT_INCOMPLETE &&
                              r.earliest == 0,
                          "status %d after %" PRIu64 " of %" PRIu64 " calls", (int)status,
                          log.count, all[0].count + all[1].count);
            }
            CHECK(log.count == log.until);
            for (uint64_t i = 0; i < r.vertex_face_count; ++i)
                CHECK(pair_is_among(got[0].pairs[i], all[0].pairs, all[0].count) &&
                      filter_rules_is_liked(log.salt, got[0].pairs[i].a, got[0].pairs[i].b));
            for (uint64_t i = 0; i < r.edge_edge_count; ++i)
                CHECK(pair_is_among(got[1].pairs[i], all[1].pairs, all[1].count) &&
                      filter_rules_is_liked(log.salt, got[1].pairs[i].a, got[1].pairs[i].b));
            free(log.pairs);
            free_lists(all);
            free_lists(got);
        }
        close_subject(&s);
    }
    CHECK(stopped > 0);
}

SC_TEST_MAIN(SC_TEST(every_filter), SC_TEST(several_workers), SC_TEST(every_ring),
             SC_TEST(rest_ties), SC_TEST(cloth_at_rest), SC_TEST(rest_not_finite),
             SC_TEST(stopped_by_accept))
