/*
 * Filters leave out of what is near what they are to leave out and nothing else: all pairs of small
 * meshes that exact arithmetic says are near, filtered here by the definitions in starcontour.h, on
 * distances along the mesh found by brute force and distances in the rest pose found in exact
 * arithmetic. What is refused: test_near_input.c.
 *
 * SPDX-License-Identifier: MIT
 */
#include <inttypes.h>
#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "filter_rules.h"
#include "harness.h"
#include "inputs.h"
#include "near_ask.h"
#include "shapes.h"
#include "soups.h"
#include "starcontour.h"
#include "tasks.h"

/* A mesh in a pose, ready to be asked, and what there is to know of it by brute force. */
typedef struct subject {
    soup mesh;
    double *posed, *rest; /* packed */
    input_array positions, rest_positions;
    sc_pose pose, rest_pose;
    step_motion m, at_rest; /* each of them, standing still */
    input_choices choices;
    uint32_t *weld;
    uint8_t *apart; /* see filter_rules.h */
    sc_model *model;
    near_question alone, shared; /* by one worker, and by up to four */
    double distance, rest_distance;
    oracle_list all[STEP_KINDS]; /* what is near, whatever filters say */
    signed char
        *is_near[STEP_KINDS]; /* and of each pair whether it is at rest; -1: not yet known */
} subject;

/* What is asked: the caller's, and what accept says. */
typedef struct wish {
    sc_filter filters[STEP_KINDS];
    int has_filter[STEP_KINDS], has_rest;
    uint32_t mask_rings; /* 0: no masks */
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

enum { SHARED = 4 };

/* ---- subjects ---- */

static double longest_edge(const step_motion *m)
{
    double longest = 0;
    for (uint32_t i = 0; i < m->edge_count; ++i) {
        const double *p = m->ends[0] + 3 * (size_t)step_edge_start(m, m->edge[i]);
        const double *q = m->ends[0] + 3 * (size_t)step_edge_end(m, m->edge[i]);
        longest = fmax(longest, hypot(hypot(p[0] - q[0], p[1] - q[1]), p[2] - q[2]));
    }
    return longest;
}

static void find_all(subject *s, double distance)
{
    s->distance = distance;
    for (int k = 0; k < STEP_KINDS; ++k) {
        free(s->all[k].pairs);
        free(s->is_near[k]);
        s->all[k] = near_truth_find(&s->m, k, distance);
        s->is_near[k] = (signed char *)test_allocate((size_t)s->all[k].count + 1);
        memset(s->is_near[k], -1, (size_t)s->all[k].count + 1);
    }
}

static void set_rest_distance(subject *s, double distance)
{
    s->rest_distance = distance;
    for (int k = 0; k < STEP_KINDS; ++k) memset(s->is_near[k], -1, (size_t)s->all[k].count + 1);
}

/* Takes mesh and poses over; with a model it takes this one, too. */
static int open_subject(subject *s, const char *name, soup mesh, double *posed, double *rest,
                        sc_model *model)
{
    const uint32_t n = mesh.vertex_count, type = test_random_below(3) ? SC_DOUBLE : SC_FLOAT;
    const uint32_t rest_type = test_random_below(3) ? SC_DOUBLE : SC_FLOAT;
    sc_mesh input = input_plain_mesh(&mesh);
    memset(s, 0, sizeof(*s));
    s->mesh = mesh;
    s->posed = posed;
    s->rest = rest;
    s->model = model;
    s->choices = input_choose(&mesh, model ? SC_WELD_NONE : test_random_below(3),
                              model ? SC_PARTITION_FAST : test_random_below(4));
    if (type == SC_FLOAT) soup_round_to_float(posed, n);
    if (rest_type == SC_FLOAT) soup_round_to_float(rest, n);
    s->positions = input_positions(posed, n, type, test_random_below(3) * 4);
    s->rest_positions = input_positions(rest, n, rest_type, test_random_below(3) * 4);
    s->pose = input_pose(n, &s->positions);
    s->rest_pose = input_pose(n, &s->rest_positions);
    s->weld = input_weld_of(&s->choices, &mesh);
    s->apart = filter_rules_measure(&mesh, s->weld);
    s->m = step_motion_make(&mesh, posed, posed, s->weld);
    s->at_rest = step_motion_make(&mesh, rest, rest, s->weld);
    if (!model && !CHECK(sc_build(&input, &s->choices.options, &s->model) == SC_OK)) return 0;
    s->alone.name = name;
    s->alone.model = s->model;
    s->alone.pose = &s->pose;
    s->alone.workspace = near_workspace(s->model, 1);
    s->shared = s->alone;
    s->shared.workspace = near_workspace(s->model, SHARED);
    return s->alone.workspace != NULL && s->shared.workspace != NULL;
}

/* Any mesh in any pose, and a rest pose that is another, or the mesh as it was made. */
static int open_any(subject *s, uint32_t maximum)
{
    const uint64_t state = test_random_state();
    const char *name;
    soup mesh = shape_any(maximum, &name);
    double *posed = soup_copy_positions(&mesh), *rest = soup_copy_positions(&mesh), edge;
    if (test_random_below(4)) soup_any_pose(posed, mesh.vertex_count);
    if (test_random_below(2)) soup_any_pose(rest, mesh.vertex_count);
    if (!open_subject(s, name, mesh, posed, rest, NULL)) return 0;
    s->alone.state = s->shared.state = state;
    edge = fmin(longest_edge(&s->m), 1);
    find_all(s, edge * test_random_range(0.2, 1.5));
    set_rest_distance(s, edge * test_random_range(0.1, 1.2));
    return 1;
}

/* A cloth of one triangle a leaf cluster that waves and folds: of many leaf clusters. */
static int open_cloth(subject *s, uint32_t side)
{
    const uint64_t state = test_random_state();
    fixture f;
    sc_model *model;
    soup mesh;
    double *posed, *rest;
    memset(s, 0, sizeof(*s));
    if (!fixture_start_tree(&f, soup_cloth(side, side), 1, 0, 0)) return 0;
    mesh = soup_copy(&f.mesh);
    model = f.model;
    f.model = NULL;
    fixture_stop(&f);
    posed = soup_copy_positions(&mesh);
    rest = soup_copy_positions(&mesh);
    soup_smooth(posed, mesh.vertex_count, 0.1);
    soup_fold(posed, mesh.vertex_count);
    if (!open_subject(s, "cloth", mesh, posed, rest, model)) return 0;
    s->alone.state = s->shared.state = state;
    find_all(s, 0.9 / side);
    set_rest_distance(s, 1.3 / side);
    return 1;
}

static void close_subject(subject *s)
{
    for (int k = 0; k < STEP_KINDS; ++k) {
        free(s->all[k].pairs);
        free(s->is_near[k]);
    }
    sc_workspace_free(s->alone.workspace);
    sc_workspace_free(s->shared.workspace);
    sc_model_free(s->model);
    step_motion_free(&s->m);
    step_motion_free(&s->at_rest);
    free(s->apart);
    free(s->weld);
    free(s->posed);
    free(s->rest);
    input_free(&s->positions);
    input_free(&s->rest_positions);
    input_free_choices(&s->choices);
    soup_free(&s->mesh);
}

/* ---- the definitions ---- */

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

/* The fewest edges of the mesh from one of a pair to the other. */
static uint32_t edges_between(const subject *s, const uint32_t v[4], uint32_t first)
{
    uint32_t least = 255;
    for (uint32_t i = 0; i < first; ++i)
        for (uint32_t k = first; k < 4; ++k) {
            const uint32_t edges = s->apart[(size_t)v[i] * s->mesh.vertex_count + v[k]];
            if (edges < least) least = edges;
        }
    return least;
}

/* Everything but accept. */
static int is_wanted(const subject *s, const wish *w, int kind, uint64_t i)
{
    const sc_filter *f = &w->filters[kind];
    const sc_pair pair = s->all[kind].pairs[i];
    uint32_t v[4], first = step_pair_vertices(&s->m, kind, pair, v);
    const uint32_t edges = edges_between(s, v, first);
    if (w->has_rest) {
        signed char *is_near = &s->is_near[kind][i];
        if (*is_near < 0)
            *is_near = (signed char)near_truth_is_within(&s->at_rest, kind, pair, s->rest_distance);
        if (*is_near) return 0;
    }
    if (edges < w->mask_rings) return 0;
    if (!w->has_filter[kind]) return 1;
    if (edges < f->ignore_rings) return 0;
    if (f->triangle_groups) {
        const sc_group *g = f->triangle_groups;
        const int faces = kind == STEP_VERTEX_FACE;
        if (!filter_rules_collide(faces ? group_at(s, g, pair.a) : g[pair.a / 3],
                                  g[faces ? pair.b : pair.b / 3]))
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
    for (int k = 0; k < STEP_KINDS; ++k) w.filters[k].struct_size = sizeof(sc_filter);
    return w;
}

static oracle_list make_list(uint64_t capacity)
{
    oracle_list list;
    memset(&list, 0, sizeof(list));
    list.pairs = (sc_pair *)test_allocate((size_t)(capacity + 1) * sizeof(sc_pair));
    return list;
}

/* Some of the pairs there are, some twice, and some that are none. */
static oracle_list random_ignore(const subject *s, int kind)
{
    const uint32_t n = s->mesh.triangle_count;
    oracle_list list = make_list(2 * s->all[kind].count + 40);
    for (uint64_t i = 0; i < s->all[kind].count; ++i)
        for (uint32_t repeats = test_random_below(3); repeats > 0; --repeats)
            list.pairs[list.count++] = s->all[kind].pairs[i];
    for (uint32_t i = 0; i < 40; ++i) {
        const int faces = kind == STEP_VERTEX_FACE;
        sc_pair p;
        p.a = test_random_below(faces ? s->mesh.vertex_count : 3 * n);
        p.b = test_random_below(faces ? n : 3 * n);
        if (faces || p.a < p.b) list.pairs[list.count++] = p;
    }
    qsort(list.pairs, (size_t)list.count, sizeof(sc_pair), filter_rules_compare);
    return list;
}

/* Bits of a filter. */
enum { RINGS = 1, VERTEX_GROUPS = 2, TRIANGLE_GROUPS = 4, IGNORE = 8, ACCEPT = 16, PARTS = 5 };

static sc_filter make_filter(uint32_t parts, const sc_group *groups[2], const oracle_list *ignore)
{
    sc_filter f = no_wish().filters[0];
    if (parts & RINGS) f.ignore_rings = 1 + test_random_below(4);
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

/* What a wish leaves of all pairs, without and with accept. */
static void expect(const subject *s, const wish *w, oracle_list asked[STEP_KINDS],
                   oracle_list left[STEP_KINDS])
{
    for (int k = 0; k < STEP_KINDS; ++k) {
        asked[k] = make_list(s->all[k].count);
        left[k] = make_list(s->all[k].count);
        for (uint64_t i = 0; i < s->all[k].count; ++i) {
            const sc_pair pair = s->all[k].pairs[i];
            if (!is_wanted(s, w, k, i)) continue;
            asked[k].pairs[asked[k].count++] = pair;
            if (w->has_filter[k] && w->filters[k].accept &&
                !filter_rules_is_liked(w->salt, pair.a, pair.b))
                continue;
            left[k].pairs[left[k].count++] = pair;
        }
    }
}

static int is_head(const oracle_list *expected, const sc_pair *pairs, uint64_t count)
{
    return memcmp(expected->pairs, pairs, (size_t)count * sizeof(sc_pair)) == 0;
}

/* Whether accept was asked of all pairs that are to be asked about, once each, by this thread. */
static int was_asked(const accept_log *log, const oracle_list *asked)
{
    const uint64_t noted = log->count < log->capacity ? log->count : log->capacity;
    qsort(log->pairs, (size_t)noted, sizeof(sc_pair), filter_rules_compare);
    return log->strangers == 0 && log->count == asked->count &&
           is_head(asked, log->pairs, asked->count);
}

/* Of those asked about, how many accept took. */
static uint64_t taken(const accept_log *log)
{
    uint64_t count = 0;
    for (uint64_t i = 0; i < log->count && i < log->capacity; ++i)
        count += filter_rules_is_liked(log->salt, log->pairs[i].a, log->pairs[i].b) != 0;
    return count;
}

/* Ways to ask. */
enum { FULL, SHORT, NO_ROOM, COUNTED, ANY, OUTPUTS };

typedef struct asking {
    near_way way;
    int output;
    uint32_t kinds;
    host *tasks; /* or NULL */
    const sc_near_masks *masks;
} asking;

static sc_near_options options_for(const subject *s, const wish *w, const asking *by,
                                   sc_filter filters[STEP_KINDS], accept_log logs[STEP_KINDS])
{
    sc_near_options o = near_options_for(&by->way, s->distance);
    for (int k = 0; k < STEP_KINDS; ++k) {
        filters[k] = w->filters[k];
        filters[k].accept_user = &logs[k];
    }
    if (w->has_filter[0]) o.vertex_face_filter = &filters[0];
    if (w->has_filter[1]) o.edge_edge_filter = &filters[1];
    if (w->has_rest) {
        o.rest = &s->rest_pose;
        o.rest_distance = s->rest_distance;
    }
    o.masks = by->masks;
    o.kinds = by->kinds;
    o.output = by->output == COUNTED ? SC_OUTPUT_COUNT
               : by->output == ANY   ? SC_OUTPUT_ANY
                                     : SC_OUTPUT_PAIRS;
    if (by->tasks) o.tasks = &by->tasks->tasks;
    return o;
}

/* A wish asked in one way. */
static void check_asking(const subject *s, const wish *w, const asking *by,
                         const oracle_list asked[STEP_KINDS], const oracle_list left[STEP_KINDS])
{
    const near_question *q = by->tasks ? &s->shared : &s->alone;
    accept_log logs[STEP_KINDS];
    sc_filter filters[STEP_KINDS];
    uint64_t room[STEP_KINDS], expected[STEP_KINDS], sum = 0;
    sc_near_options o;
    near_answer a;
    int is_short = 0;
    for (int k = 0; k < STEP_KINDS; ++k) {
        const int has_kind = by->kinds != (k ? SC_NEAR_VERTEX_FACE : SC_NEAR_EDGE_EDGE);
        expected[k] = has_kind ? left[k].count : 0;
        sum += expected[k];
        room[k] = asked[k].count; /* with room for what accept refuses */
        if (by->output == SHORT && left[k].count > 0 && test_random_below(3))
            room[k] = test_random_below((uint32_t)left[k].count);
        if (by->output == NO_ROOM && k == 0) room[k] = 0;
        is_short |= by->output <= NO_ROOM && room[k] < expected[k];
        logs[k] = make_log(asked[k].count, w->salt);
    }
    o = options_for(s, w, by, filters, logs);
    a = near_ask(q, &o, room[0], room[1]);
    CHECK_MSG(a.status == (is_short ? SC_ERROR_SHORT_BUFFER : SC_OK) &&
                  a.result.found == (sum > 0) &&
                  a.result.verdict == (sum ? SC_VERDICT_FOUND : SC_VERDICT_CLEAN),
              "%s, %s, output %d: status %d, found %" PRIu32 "; state %" PRIu64, q->name,
              by->way.name, by->output, (int)a.status, a.result.found, q->state);
    if (by->output == ANY)
        CHECK(a.count[0] + a.count[1] == (sum > 0) && a.count[0] <= expected[0] &&
              a.count[1] <= expected[1]);
    else
        CHECK_MSG(a.count[0] == expected[0] && a.count[1] == expected[1],
                  "%s, %s, output %d, kinds %" PRIu32 ", %d tasks: %" PRIu64 ", %" PRIu64
                  " instead of %" PRIu64 ", %" PRIu64 "; distance %a, state %" PRIu64,
                  q->name, by->way.name, by->output, by->kinds, by->tasks ? by->tasks->way : -1,
                  a.count[0], a.count[1], expected[0], expected[1], s->distance, q->state);
    for (int k = 0; k < STEP_KINDS; ++k) {
        if (by->output <= NO_ROOM)
            CHECK_MSG(is_head(&left[k], a.pairs[k], room[k] < expected[k] ? room[k] : expected[k]),
                      "%s, %s, output %d: other pairs; state %" PRIu64, q->name, by->way.name,
                      by->output, q->state);
        if (!w->has_filter[k] || !w->filters[k].accept ||
            by->kinds == (k ? SC_NEAR_VERTEX_FACE : SC_NEAR_EDGE_EDGE))
            CHECK(logs[k].count == 0);
        else if (by->output != ANY)
            CHECK_MSG(was_asked(&logs[k], &asked[k]),
                      "%s, %s, output %d: accept was asked %" PRIu64 " times instead of %" PRIu64
                      "; state %" PRIu64,
                      q->name, by->way.name, by->output, logs[k].count, asked[k].count, q->state);
    }
    if (by->output == ANY) CHECK(taken(&logs[0]) + taken(&logs[1]) <= 1); /* and none after it */
    for (int k = 0; k < STEP_KINDS; ++k) free(logs[k].pairs);
    near_answer_free(&a);
}

/* A wish by all methods and instruction sets, in all ways, with tasks if there are any. Adds to
   *kept and *dropped. */
static void check_wish(const subject *s, const wish *w, host *tasks, uint64_t *kept,
                       uint64_t *dropped)
{
    oracle_list asked[STEP_KINDS], left[STEP_KINDS];
    sc_near_masks *masks = NULL;
    expect(s, w, asked, left);
    if (w->mask_rings) CHECK(sc_near_masks_create(s->model, w->mask_rings, NULL, &masks) == SC_OK);
    for (uint32_t i = 0; i < NEAR_WAYS; ++i) {
        asking by = {near_ways[i], 0, SC_NEAR_BOTH, NULL, masks};
        if (!near_way_is_there(&near_ways[i], s->model, s->alone.workspace, &s->pose)) continue;
        for (by.output = 0; by.output < OUTPUTS; ++by.output) {
            if (i > 0 && test_random_below(2)) continue;
            by.kinds = SC_NEAR_BOTH;
            check_asking(s, w, &by, asked, left);
            by.kinds = 1 + test_random_below(2);
            check_asking(s, w, &by, asked, left);
            if (tasks && i % 4 == 0) {
                by.tasks = tasks;
                by.kinds = test_random_below(3);
                check_asking(s, w, &by, asked, left);
                by.tasks = NULL;
            }
        }
    }
    for (int k = 0; k < STEP_KINDS; ++k) {
        *kept += left[k].count;
        *dropped += s->all[k].count - left[k].count;
        free(asked[k].pairs);
        free(left[k].pairs);
    }
    sc_near_masks_free(masks);
}

/* Each part of a filter alone, a rest pose alone, masks alone, then several together. */
static void check_parts(const subject *s, host *tasks, uint32_t salt, uint64_t *kept,
                        uint64_t *dropped)
{
    sc_group *vertex_groups = filter_rules_groups(s->mesh.vertex_count);
    sc_group *triangle_groups = filter_rules_groups(s->mesh.triangle_count);
    const sc_group *groups[2];
    oracle_list ignore[STEP_KINDS];
    groups[0] = vertex_groups;
    groups[1] = triangle_groups;
    for (int k = 0; k < STEP_KINDS; ++k) ignore[k] = random_ignore(s, k);
    for (uint32_t part = 0; part < PARTS + 6; ++part) {
        const int alone = part < PARTS + 2;
        wish w = no_wish();
        for (int k = 0; k < STEP_KINDS; ++k) {
            uint32_t parts = part < PARTS ? 1u << part : test_random_below(1u << PARTS);
            w.has_filter[k] = part < PARTS ? 1 : !alone && test_random_below(4) > 0;
            /* of one kind alone, too */
            if (part < PARTS && test_random_below(4) == 0) w.has_filter[k] = 0;
            w.filters[k] = make_filter(parts, groups, &ignore[k]);
        }
        w.has_rest = part == PARTS || (!alone && test_random_below(2));
        if (part == PARTS + 1 || (!alone && test_random_below(2)))
            w.mask_rings = 1 + test_random_below(4);
        w.salt = salt;
        check_wish(s, &w, tasks, kept, dropped);
    }
    for (int k = 0; k < STEP_KINDS; ++k) free(ignore[k].pairs);
    free(vertex_groups);
    free(triangle_groups);
}

static void check_sums(uint64_t kept, uint64_t dropped)
{
    test_note("%" PRIu64 " pairs kept, %" PRIu64 " left out", kept, dropped);
    CHECK(kept > 1000 && dropped > 1000);
}

/* ---- tests ---- */

/* Meshes, poses and filters of all kinds. */
static void every_filter(void)
{
    uint64_t kept = 0, dropped = 0;
    for (uint32_t round = 0; round < test_iterations_at_least(24, 8); ++round) {
        subject s;
        if (open_any(&s, 20 + test_random_below(100)))
            check_parts(&s, NULL, 1 + round, &kept, &dropped);
        close_subject(&s);
    }
    check_sums(kept, dropped);
}

/* Of several workers, in every order. */
static void several_workers(void)
{
    uint64_t kept = 0, dropped = 0;
    for (uint32_t round = 0; round < test_iterations_at_least(8, 2); ++round) {
        subject s;
        host h;
        host_start(&h, HOST_FIRST + (int)(round % (HOST_COUNT - HOST_FIRST)), SHARED);
        if (open_cloth(&s, 12)) check_parts(&s, &h, 1 + round, &kept, &dropped);
        CHECK(h.jobs > 0 && h.mistakes == 0);
        close_subject(&s);
        host_stop(&h);
    }
    check_sums(kept, dropped);
}

/* Every number of rings by filters, by masks and by both, on meshes pressed flat. */
static void every_ring(void)
{
    uint64_t kept = 0, dropped = 0;
    for (uint32_t round = 0; round < test_iterations_at_least(16, 6); ++round) {
        subject s;
        if (open_any(&s, 90))
            for (uint32_t rings = 0; rings <= 5; ++rings) {
                wish w = no_wish();
                w.has_filter[0] = w.has_filter[1] = rings % 3 > 0;
                w.filters[STEP_VERTEX_FACE].ignore_rings = rings;
                w.filters[STEP_EDGE_EDGE].ignore_rings = (rings + round) % 6;
                w.mask_rings = (rings + round) % 2 ? rings : 0;
                check_wish(&s, &w, NULL, &kept, &dropped);
            }
        close_subject(&s);
    }
    check_sums(kept, dropped);
}

/* On integer points, many distances are exactly that which is asked for, and many at rest exactly
   that of the rest pose: all of these are within it. */
static void ties(void)
{
    uint64_t kept = 0, dropped = 0;
    for (uint32_t round = 0; round < test_iterations_at_least(48, 16); ++round) {
        soup mesh = soup_on_grid(2 + round % 3);
        double *posed = soup_copy_positions(&mesh), *rest = soup_copy_positions(&mesh);
        subject s;
        if (round % 2) soup_shuffle(rest, mesh.vertex_count);
        if (open_subject(&s, "grid", mesh, posed, rest, NULL)) {
            wish w = no_wish();
            find_all(&s, 1 + round % 2);
            set_rest_distance(&s, round % 3);
            w.has_rest = 1;
            check_wish(&s, &w, NULL, &kept, &dropped);
            if (round % 4 == 0) check_parts(&s, NULL, 1 + round, &kept, &dropped);
        }
        close_subject(&s);
    }
    check_sums(kept, dropped);
}

/* accept may ask the search to stop: what was found until then is right. */
static void stopped_by_accept(void)
{
    uint32_t stopped = 0;
    for (uint32_t round = 0; round < test_iterations_at_least(20, 8); ++round) {
        subject s;
        if (open_cloth(&s, 9)) {
            volatile uint32_t flag = 0;
            const uint64_t sum = s.all[0].count + s.all[1].count;
            sc_near_options o = near_options_for(&near_ways[round % NEAR_WAYS], s.distance);
            sc_filter f = no_wish().filters[0];
            accept_log log = make_log(0, 1 + round);
            near_answer a;
            log.flag = &flag;
            log.until = 1 + test_random_below(20);
            f.accept = log_call;
            f.accept_user = &log;
            o.vertex_face_filter = o.edge_edge_filter = &f;
            o.cancel = &flag;
            if (!near_way_is_there(&near_ways[round % NEAR_WAYS], s.model, s.alone.workspace,
                                   &s.pose))
                o.simd = SC_SIMD_BEST;
            a = near_ask(&s.alone, &o, sum, sum);
            if (a.status == SC_ERROR_INCOMPLETE) {
                stopped++; /* the flag is looked at now and then */
                CHECK(log.count >= log.until && log.count < sum &&
                      a.result.verdict == SC_VERDICT_INCOMPLETE);
            } else { /* it was at its end */
                CHECK(a.status == SC_OK && log.count == sum);
            }
            for (int k = 0; k < STEP_KINDS; ++k)
                for (uint64_t i = 0; i < a.count[k]; ++i)
                    CHECK(pair_is_among(a.pairs[k][i], s.all[k].pairs, s.all[k].count) &&
                          filter_rules_is_liked(log.salt, a.pairs[k][i].a, a.pairs[k][i].b));
            near_answer_free(&a);
            free(log.pairs);
        }
        close_subject(&s);
    }
    CHECK_MSG(stopped > 0, "none was stopped");
}

SC_TEST_MAIN(SC_TEST(every_filter), SC_TEST(several_workers), SC_TEST(every_ring), SC_TEST(ties),
             SC_TEST(stopped_by_accept))
