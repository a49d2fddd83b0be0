/*
 * Filters leave out what they are to leave out and nothing else: every method and kind of pair
 * against the unfiltered answer, filtered here by the definitions in starcontour.h, on distances
 * found by brute force; and filters that cannot be read.
 *
 * SPDX-License-Identifier: MIT
 */
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "filter_rules.h"
#include "harness.h"
#include "inputs.h"
#include "run/workspace.h"
#include "shapes.h"
#include "starcontour.h"

/* A mesh ready to be asked, and all there is to know of it by brute force. */
typedef struct subject {
    soup mesh;
    const char *name;
    double *posed;
    input_choices choices;
    uint32_t *weld;
    uint8_t *apart; /* vertex_count^2: edges from one representative to another, 255: none */
    sc_model *model;
    sc_workspace *workspace;
    uint64_t state;
} subject;

/* The unfiltered answer, and with it what a filter is to leave. */
typedef struct pair_list {
    sc_pair *pairs;
    uint64_t count;
} pair_list;

/* What accept was told. */
typedef struct accept_log {
    const sc_filter *filter; /* everything but accept */
    const subject *s;
    pair_list called;
    uint64_t capacity;
    uint32_t salt; /* 0: accepts all */
} accept_log;

static int open_subject(subject *s, uint32_t maximum)
{
    sc_mesh input;
    memset(s, 0, sizeof(*s));
    s->state = test_random_state();
    s->mesh = shape_any(maximum, &s->name);
    s->posed = (double *)test_allocate(3 * (size_t)s->mesh.vertex_count * sizeof(double));
    memcpy(s->posed, s->mesh.positions, 3 * (size_t)s->mesh.vertex_count * sizeof(double));
    soup_any_pose(s->posed, s->mesh.vertex_count);
    if (test_random_below(2)) soup_fold(s->posed, s->mesh.vertex_count);
    s->choices = input_choose(&s->mesh, test_random_below(3), test_random_below(4));
    s->weld = input_weld_of(&s->choices, &s->mesh);
    s->apart = filter_rules_measure(&s->mesh, s->weld);
    input = input_plain_mesh(&s->mesh);
    return CHECK(sc_build(&input, &s->choices.options, &s->model) == SC_OK) &&
           CHECK(sc_workspace_create(s->model, NULL, &s->workspace) == SC_OK);
}

static void close_subject(subject *s)
{
    sc_workspace_free(s->workspace);
    sc_model_free(s->model);
    free(s->apart);
    free(s->weld);
    free(s->posed);
    input_free_choices(&s->choices);
    soup_free(&s->mesh);
}

static sc_status ask(const subject *s, const sc_query_options *options, sc_pair *pairs,
                     uint64_t capacity, sc_result *result)
{
    sc_pose pose = input_plain_pose(s->posed, s->mesh.vertex_count);
    memset(result, 0, sizeof(*result));
    result->struct_size = sizeof(*result);
    result->pairs = pairs;
    result->capacity = capacity;
    return sc_query(s->model, s->workspace, &pose, options, result);
}

/* All pairs, by plain boxes and without a filter. */
static pair_list find_all(const subject *s, uint32_t kind, uint32_t contact)
{
    sc_query_options options = input_query(kind, contact, SC_METHOD_AABB);
    pair_list list = {NULL, 0};
    sc_result result;
    ask(s, &options, NULL, 0, &result);
    list.pairs = (sc_pair *)test_allocate(result.count * sizeof(sc_pair));
    CHECK(ask(s, &options, list.pairs, result.count, &result) == SC_OK);
    list.count = result.count;
    return list;
}

/* ---- the definitions ---- */

/* The vertices of a thing: of a triangle, or of the edge 3 t + k. */
static uint32_t vertices_of(const subject *s, uint32_t number, int is_edge, uint32_t v[3])
{
    const uint32_t *t = s->mesh.triangles + 3 * (size_t)(is_edge ? number / 3 : number);
    uint32_t count = is_edge ? 2 : 3;
    for (uint32_t i = 0; i < count; ++i) v[i] = s->weld[t[is_edge ? (number + i) % 3 : i]];
    return count;
}

/* Everything but accept. */
static int is_wanted(const subject *s, const sc_filter *f, uint32_t kind, sc_pair pair)
{
    uint32_t a[3], b[3], n = s->mesh.vertex_count;
    uint32_t a_count = vertices_of(s, pair.a, kind == SC_PAIRS_EDGE, a);
    uint32_t b_count = vertices_of(s, pair.b, 0, b);
    for (uint32_t i = 0; i < a_count; ++i)
        for (uint32_t k = 0; k < b_count; ++k)
            if (s->apart[(size_t)a[i] * n + b[k]] < f->ignore_rings) return 0;
    if (f->triangle_groups &&
        !filter_rules_collide(f->triangle_groups[kind == SC_PAIRS_EDGE ? pair.a / 3 : pair.a],
                              f->triangle_groups[pair.b]))
        return 0;
    if (f->vertex_groups &&
        !filter_rules_collide(filter_rules_group_of(f->vertex_groups, a, a_count),
                              filter_rules_group_of(f->vertex_groups, b, b_count)))
        return 0;
    return f->ignore_count == 0 || bsearch(&pair, f->ignore, (size_t)f->ignore_count,
                                           sizeof(sc_pair), filter_rules_compare) == NULL;
}

static int log_likes(const accept_log *log, sc_pair pair)
{
    return filter_rules_is_liked(log->salt, pair.a, pair.b) != 0;
}

static int32_t log_call(void *user, uint32_t a, uint32_t b)
{
    accept_log *log = (accept_log *)user;
    if (log->called.count < log->capacity) {
        log->called.pairs[log->called.count].a = a;
        log->called.pairs[log->called.count].b = b;
    }
    log->called.count++;
    return filter_rules_is_liked(log->salt, a, b);
}

/* ---- random filters ---- */

/* Some of the pairs there are, some twice, and some that are none. */
static pair_list random_ignore(const subject *s, uint32_t kind, const pair_list *all)
{
    uint32_t n = s->mesh.triangle_count;
    pair_list list = {NULL, 0};
    list.pairs = (sc_pair *)test_allocate((2 * all->count + 40) * sizeof(sc_pair));
    for (uint64_t i = 0; i < all->count; ++i)
        for (uint32_t repeats = test_random_below(3); repeats > 0; --repeats)
            list.pairs[list.count++] = all->pairs[i];
    for (uint32_t i = 0; i < 40; ++i) {
        sc_pair p;
        p.a = test_random_below(kind == SC_PAIRS_EDGE ? 3 * n : n);
        p.b = test_random_below(n);
        if (kind == SC_PAIRS_EDGE || p.a < p.b) list.pairs[list.count++] = p;
    }
    qsort(list.pairs, (size_t)list.count, sizeof(sc_pair), filter_rules_compare);
    return list;
}

/* ---- comparing ---- */

static int is_head(const sc_pair *pairs, const pair_list *expected, uint64_t count)
{
    for (uint64_t i = 0; i < count; ++i)
        if (filter_rules_compare(&pairs[i], &expected->pairs[i]) != 0) return 0;
    return 1;
}

/* All outputs of one method. accept says yes to those in expected, and is asked of those in
   asked. */
static void check_method(const subject *s, sc_query_options options, const pair_list *expected,
                         const pair_list *asked, accept_log *log)
{
    uint64_t capacity = expected->count;
    sc_pair *pairs = (sc_pair *)test_allocate((capacity + 1) * sizeof(sc_pair));
    sc_result result;
    sc_status status;
    for (uint32_t round = 0; round < 4; ++round) {
        uint64_t room =
            round == 1 && capacity > 0 ? test_random_below((uint32_t)capacity) : capacity;
        int is_short = round == 1 && capacity > 0;
        options.output = round < 2 ? SC_OUTPUT_PAIRS : round == 2 ? SC_OUTPUT_COUNT : SC_OUTPUT_ANY;
        log->called.count = 0;
        status = ask(s, &options, pairs, room, &result);
        CHECK_MSG(status == (is_short ? SC_ERROR_SHORT_BUFFER : SC_OK) &&
                      result.collides == (capacity > 0) &&
                      result.count == (round == 3 ? capacity > 0 : capacity) &&
                      (round > 1 || is_head(pairs, expected, room)),
                  "%s, method %" PRIu32 ", pairs %" PRIu32 ", contact %" PRIu32 ", output %" PRIu32
                  ": status %d, %" PRIu64 " pairs instead of %" PRIu64 "; state %" PRIu64,
                  s->name, options.method, options.pairs, options.contact, options.output,
                  (int)status, result.count, capacity, s->state);
        if (!options.filter->accept || !CHECK(log->called.count <= log->capacity)) continue;
        qsort(log->called.pairs, (size_t)log->called.count, sizeof(sc_pair), filter_rules_compare);
        if (round < 3) {
            CHECK_MSG(log->called.count == asked->count &&
                          is_head(log->called.pairs, asked, asked->count),
                      "%s: accept was called %" PRIu64 " times instead of %" PRIu64, s->name,
                      log->called.count, asked->count);
        } else {
            uint64_t liked = 0;
            for (uint64_t i = 0; i < log->called.count; ++i)
                liked += (uint64_t)log_likes(log, log->called.pairs[i]);
            CHECK_MSG(liked == (capacity > 0), "accept took %" PRIu64, liked);
        }
    }
    free(pairs);
}

/* One filter with all methods. Adds to *kept and *dropped. */
static void check_filter(const subject *s, const sc_filter *filter, uint32_t kind, uint32_t contact,
                         const pair_list *all, uint32_t salt, uint64_t *kept, uint64_t *dropped)
{
    pair_list asked = {NULL, 0}, expected = {NULL, 0};
    sc_filter f = *filter;
    accept_log log;
    asked.pairs = (sc_pair *)test_allocate(all->count * sizeof(sc_pair));
    expected.pairs = (sc_pair *)test_allocate(all->count * sizeof(sc_pair));
    memset(&log, 0, sizeof(log));
    log.salt = salt;
    log.capacity = all->count;
    log.called.pairs = (sc_pair *)test_allocate(all->count * sizeof(sc_pair));
    for (uint64_t i = 0; i < all->count; ++i) {
        if (!is_wanted(s, &f, kind, all->pairs[i])) continue;
        asked.pairs[asked.count++] = all->pairs[i];
        if (f.accept && !filter_rules_is_liked(salt, all->pairs[i].a, all->pairs[i].b)) continue;
        expected.pairs[expected.count++] = all->pairs[i];
    }
    f.accept_user = &log;
    for (uint32_t method = SC_METHOD_SCTT; method <= SC_METHOD_AABB; ++method) {
        sc_query_options options = input_query(kind, contact, method);
        options.filter = &f;
        options.rest_cache = test_random_below(2);
        check_method(s, options, &expected, &asked, &log);
    }
    *kept += expected.count;
    *dropped += all->count - expected.count;
    free(log.called.pairs);
    free(asked.pairs);
    free(expected.pairs);
}

static sc_filter no_filter(void)
{
    sc_filter f;
    memset(&f, 0, sizeof(f));
    f.struct_size = sizeof(f);
    return f;
}

/* Meshes, poses and filters of all kinds, one part of the filter at a time or several together. */
static void every_filter(void)
{
    uint64_t kept = 0, dropped = 0;
    for (uint32_t round = 0; round < test_iterations_at_least(12, 8); ++round) {
        subject s;
        if (open_subject(&s, 140))
            for (uint32_t kind = 0; kind < 2; ++kind)
                for (uint32_t contact = 0; contact < 2; ++contact) {
                    pair_list all = find_all(&s, kind, contact);
                    pair_list ignore = random_ignore(&s, kind, &all);
                    sc_group *vertex_groups = filter_rules_groups(s.mesh.vertex_count);
                    sc_group *triangle_groups = filter_rules_groups(s.mesh.triangle_count);
                    for (uint32_t part = 0; part < 8; ++part) {
                        uint32_t parts = part < 5 ? 1u << part : 1 + test_random_below(31);
                        sc_filter f = no_filter();
                        if (parts & 1) f.ignore_rings = 1 + test_random_below(part == 0 ? 2 : 6);
                        if (parts & 2) f.vertex_groups = vertex_groups;
                        if (parts & 4) f.triangle_groups = triangle_groups;
                        if (parts & 8) {
                            f.ignore = ignore.pairs;
                            f.ignore_count = ignore.count;
                        }
                        if (parts & 16) f.accept = log_call;
                        check_filter(&s, &f, kind, contact, &all, 1 + round, &kept, &dropped);
                    }
                    free(vertex_groups);
                    free(triangle_groups);
                    free(ignore.pairs);
                    free(all.pairs);
                }
        close_subject(&s);
    }
    CHECK_MSG(kept > 1000 && dropped > 1000, "%" PRIu64 " kept, %" PRIu64 " dropped", kept,
              dropped);
}

/* Every number of rings, on meshes with closed fans, boundaries and hubs, flattened so that all
   near pairs are found. */
static void every_ring(void)
{
    uint64_t kept = 0, dropped = 0;
    for (uint32_t round = 0; round < test_iterations_at_least(24, 8); ++round) {
        subject s;
        if (open_subject(&s, 160)) {
            soup_crush(s.posed, s.mesh.vertex_count);
            soup_noise(s.posed, s.mesh.vertex_count, 1e-3);
            for (uint32_t kind = 0; kind < 2; ++kind) {
                pair_list all = find_all(&s, kind, 0);
                for (uint32_t rings = 0; rings <= 8; ++rings) {
                    sc_filter f = no_filter();
                    f.ignore_rings = rings;
                    if (rings == 5) s.workspace->worker->ball.epoch = 0xfffd; /* about to wrap */
                    check_filter(&s, &f, kind, 0, &all, 0, &kept, &dropped);
                }
                free(all.pairs);
            }
        }
        close_subject(&s);
    }
    CHECK_MSG(kept > 1000 && dropped > 1000, "%" PRIu64 " kept, %" PRIu64 " dropped", kept,
              dropped);
}

/* What starcontour.h says about contacts of the rest pose. */
static void rest_contacts(void)
{
    for (uint32_t round = 0; round < test_iterations(20); ++round) {
        subject s;
        uint64_t kept = 0, dropped = 0;
        if (open_subject(&s, 200))
            for (uint32_t kind = 0; kind < 2; ++kind) {
                sc_pose rest = input_plain_pose(s.mesh.positions, s.mesh.vertex_count);
                sc_query_options options = input_query(kind, 0, SC_METHOD_DEFAULT);
                pair_list now = find_all(&s, kind, 0);
                sc_filter f = no_filter();
                sc_result result;
                memset(&result, 0, sizeof(result));
                result.struct_size = sizeof(result);
                options.output = SC_OUTPUT_COUNT;
                CHECK(sc_query(s.model, s.workspace, &rest, &options, &result) == SC_OK);
                result.capacity = result.count;
                result.pairs = (sc_pair *)test_allocate(result.count * sizeof(sc_pair));
                options.output = SC_OUTPUT_PAIRS;
                CHECK(sc_query(s.model, s.workspace, &rest, &options, &result) == SC_OK);
                f.ignore = result.pairs;
                f.ignore_count = result.count;
                check_filter(&s, &f, kind, 0, &now, 0, &kept, &dropped);
                /* nothing is new in the rest pose itself */
                options.filter = &f;
                result.capacity = 0;
                CHECK(sc_query(s.model, s.workspace, &rest, &options, &result) == SC_OK &&
                      result.count == 0 && result.collides == 0);
                free((void *)(uintptr_t)f.ignore);
                free(now.pairs);
            }
        close_subject(&s);
    }
}

/* The first ring is decided before anything is tested. */
static void first_ring_is_cheap(void)
{
    subject s;
    if (open_subject(&s, 20)) {
        soup mesh = soup_cloth(20, 20);
        sc_mesh input = input_plain_mesh(&mesh);
        sc_filter f = no_filter();
        sc_query_options options = input_query(SC_PAIRS_TRIANGLE, 0, SC_METHOD_AABB);
        sc_stats stats[2];
        sc_result result;
        sc_pose pose = input_plain_pose(mesh.positions, mesh.vertex_count);
        sc_workspace_free(s.workspace);
        sc_model_free(s.model);
        s.model = NULL;
        s.workspace = NULL;
        soup_noise(mesh.positions, mesh.vertex_count, 0.04);
        f.ignore_rings = 1;
        if (CHECK(sc_build(&input, NULL, &s.model) == SC_OK) &&
            CHECK(sc_workspace_create(s.model, NULL, &s.workspace) == SC_OK))
            for (int i = 0; i < 2; ++i) {
                stats[i].struct_size = sizeof(stats[i]);
                memset(&result, 0, sizeof(result));
                result.struct_size = sizeof(result);
                result.stats = &stats[i];
                options.output = SC_OUTPUT_COUNT;
                options.filter = i ? &f : NULL;
                CHECK(sc_query(s.model, s.workspace, &pose, &options, &result) == SC_OK);
            }
        CHECK(stats[1].counts[SC_TASK_PRIMITIVES_ORIENTATION] <
              stats[0].counts[SC_TASK_PRIMITIVES_ORIENTATION]);
        soup_free(&mesh);
    }
    close_subject(&s);
}

static void check_refused(const subject *s, const sc_filter *filter, uint32_t kind,
                          sc_status expected, const char *what)
{
    sc_pair pair = {77, 78};
    sc_query_options options = input_query(kind, 0, 0);
    sc_result result;
    sc_status status;
    options.filter = filter;
    status = ask(s, &options, &pair, 1, &result);
    CHECK_MSG(status == expected && result.count == 0 && result.collides == 0 && pair.a == 77,
              "%s: status %d (%s)", what, (int)status, sc_status_string(status));
}

static void wrong_filters(void)
{
    subject s;
    if (open_subject(&s, 100)) {
        const uint32_t n = s.mesh.triangle_count;
        sc_pair list[3] = {{0, 1}, {0, 2}, {1, 2}};
        sc_query_options options = input_query(0, 0, 0);
        sc_result result;
        sc_filter f = no_filter();
        struct {
            sc_filter filter;
            uint64_t tail[2];
        } larger;
        for (uint32_t size = 0; size < sizeof(f) + 8; ++size) {
            int fits = size >= sizeof(void *) && size % sizeof(void *) == 0;
            if (fits) continue;
            f.struct_size = size;
            check_refused(&s, &f, 0, SC_ERROR_STRUCT_SIZE, "filter");
        }
        memset(&larger, 0, sizeof(larger));
        larger.filter.struct_size = sizeof(larger);
        larger.tail[1] = 1;
        check_refused(&s, &larger.filter, 0, SC_ERROR_STRUCT_SIZE, "larger filter");
        larger.tail[1] = 0;
        options.filter = &larger.filter;
        options.output = SC_OUTPUT_COUNT;
        CHECK(ask(&s, &options, NULL, 0, &result) == SC_OK);

        /* What lies behind an older, smaller structure is not read. */
        memset(&f, 0xee, sizeof(f));
        f.struct_size = 8;
        f.ignore_rings = 0;
        options.filter = &f;
        CHECK(ask(&s, &options, NULL, 0, &result) == SC_OK);
        options.struct_size = 32; /* that of version 0.1 without filters */
        f.struct_size = 1;
        CHECK(ask(&s, &options, NULL, 0, &result) == SC_OK);

        f = no_filter();
        f.ignore_rings = SC_RINGS_MAX + 1;
        check_refused(&s, &f, 0, SC_ERROR_OPTION, "rings");
        f = no_filter();
        f.ignore_count = 1;
        check_refused(&s, &f, 0, SC_ERROR_NULL, "ignore");
        for (uint32_t kind = 0; kind < 2; ++kind)
            for (uint32_t wrong = 0; wrong < 6; ++wrong) {
                sc_pair changed[3];
                memcpy(changed, list, sizeof(list));
                if (wrong == 0) changed[1].b = 0; /* not sorted by b; and a triangle with itself */
                if (wrong == 1) changed[2].a = n;
                if (wrong == 2) changed[2].b = n;
                if (wrong == 3) changed[2].a = 2;
                if (wrong == 4) changed[2].a = 3 * n;
                if (wrong == 5) changed[0].a = 1;
                f = no_filter();
                f.ignore = changed;
                f.ignore_count = 3;
                if (kind == SC_PAIRS_EDGE && (wrong == 1 || wrong == 3)) {
                    options = input_query(kind, 0, 0);
                    options.output = SC_OUTPUT_COUNT;
                    options.filter = &f;
                    CHECK(ask(&s, &options, NULL, 0, &result) == SC_OK);
                } else {
                    check_refused(&s, &f, kind, SC_ERROR_PAIRS, "ignore");
                }
            }
        f = no_filter();
        f.ignore = list;
        f.ignore_count = 3;
        f.ignore_rings = SC_RINGS_MAX;
        options = input_query(0, 0, 0);
        options.output = SC_OUTPUT_COUNT;
        options.filter = &f;
        CHECK(ask(&s, &options, NULL, 0, &result) == SC_OK);
        CHECK(strcmp(sc_status_string(SC_ERROR_PAIRS), sc_status_string(12345)) != 0);
    }
    close_subject(&s);
}

SC_TEST_MAIN(SC_TEST(every_filter), SC_TEST(every_ring), SC_TEST(rest_contacts),
             SC_TEST(first_ring_is_cheap), SC_TEST(wrong_filters))
