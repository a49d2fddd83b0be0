/*
 * Verdicts: a query that is not stopped says clean or found; one that is stopped, by a budget or by
 * a flag, says so by status and verdict, delivers nothing but pairs, and with a budget the same
 * each time.
 *
 * SPDX-License-Identifier: MIT
 */
#include <inttypes.h>
#include <pthread.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "harness.h"
#include "inputs.h"
#include "shapes.h"
#include "starcontour.h"

typedef struct subject {
    soup mesh;
    double *posed;
    sc_model *model;
    sc_workspace *workspace;
    const char *name;
    uint64_t state;
} subject;

static int open_subject(subject *s, soup mesh, int moved)
{
    sc_mesh input;
    s->mesh = mesh;
    s->model = NULL;
    s->workspace = NULL;
    s->posed = (double *)test_allocate(3 * (size_t)mesh.vertex_count * sizeof(double));
    memcpy(s->posed, mesh.positions, 3 * (size_t)mesh.vertex_count * sizeof(double));
    if (moved) soup_any_pose(s->posed, mesh.vertex_count);
    input = input_plain_mesh(&s->mesh);
    return CHECK(sc_build(&input, NULL, &s->model) == SC_OK) &&
           CHECK(sc_workspace_create(s->model, NULL, &s->workspace) == SC_OK);
}

static void close_subject(subject *s)
{
    sc_workspace_free(s->workspace);
    sc_model_free(s->model);
    free(s->posed);
    soup_free(&s->mesh);
}

/* Lays one half of a cloth onto the other. */
static void fold_in_half(double *positions, uint32_t count)
{
    for (uint32_t v = 0; v < count; ++v)
        if (positions[3 * (size_t)v] > 0.5) positions[3 * (size_t)v] = 1 - positions[3 * (size_t)v];
}

/* stats may be NULL. */
static sc_status ask(const subject *s, const sc_query_options *options, sc_pair *pairs,
                     uint64_t capacity, sc_stats *stats, sc_result *result)
{
    sc_pose pose = input_plain_pose(s->posed, s->mesh.vertex_count);
    memset(result, 0, sizeof(*result));
    result->struct_size = sizeof(*result);
    result->pairs = pairs;
    result->capacity = capacity;
    result->stats = stats;
    result->verdict = 77;
    result->reserved = 77;
    if (stats) stats->struct_size = sizeof(*stats);
    return sc_query(s->model, s->workspace, &pose, options, result);
}

/* What a budget is compared with. */
static uint64_t work_of(const sc_stats *stats)
{
    uint64_t sum = 0;
    for (int i = 0; i < SC_TASK_COUNT; ++i)
        if (i != SC_TASK_UPDATE_BOXES && i != SC_TASK_UPDATE_NORMALS) sum += stats->counts[i];
    return sum;
}

static int is_less(const sc_pair *x, const sc_pair *y)
{
    return x->a != y->a ? x->a < y->a : x->b < y->b;
}

/* Whether a sorted list holds nothing but entries of another, each once. */
static int is_part(const sc_pair *part, uint64_t count, const sc_pair *all, uint64_t all_count)
{
    uint64_t k = 0;
    for (uint64_t i = 0; i < count; ++i, ++k) {
        while (k < all_count && is_less(&all[k], &part[i])) ++k;
        if (k == all_count || is_less(&part[i], &all[k])) return 0;
    }
    return 1;
}

static void complete_queries(void)
{
    uint64_t seen[2] = {0, 0};
    for (uint32_t round = 0; round < test_iterations_at_least(100, 20); ++round) {
        subject s;
        soup mesh = shape_any(100, &s.name);
        if (open_subject(&s, mesh, 1))
            for (uint32_t method = 0; method <= SC_METHOD_AABB; ++method)
                for (uint32_t output = 0; output <= SC_OUTPUT_ANY; ++output) {
                    sc_query_options o = input_query(round % 2, round / 2 % 2, method);
                    sc_result r;
                    sc_status status;
                    static const uint32_t never = 0;
                    o.output = output;
                    if (round % 3 == 0) o.cancel = &never;
                    if (round % 5 == 0) o.budget = UINT64_MAX;
                    status = ask(&s, &o, NULL, 0, NULL, &r);
                    CHECK(
                        status ==
                        (output == SC_OUTPUT_PAIRS && r.count > 0 ? SC_ERROR_SHORT_BUFFER : SC_OK));
                    CHECK(r.verdict == (r.collides ? SC_VERDICT_FOUND : SC_VERDICT_CLEAN));
                    CHECK(r.collides == (r.count > 0) && r.reserved == 0);
                    seen[r.collides]++;
                }
        close_subject(&s);
    }
    CHECK(seen[0] > 20 && seen[1] > 20);
}

/* Errors say nothing, and callers of an older version get nothing written behind their
   structure. */
static void errors_and_older_callers(void)
{
    subject s;
    if (open_subject(&s, soup_cloth(4, 4), 0)) {
        sc_query_options o = input_query(0, 0, SC_METHOD_AABB + 1);
        sc_pose pose = input_plain_pose(s.posed, s.mesh.vertex_count);
        sc_result r;
        const uint32_t stop = 1;
        CHECK(ask(&s, &o, NULL, 0, NULL, &r) == SC_ERROR_OPTION && r.verdict == SC_VERDICT_NONE);
        o = input_query(0, 0, 0);
        CHECK(ask(&s, &o, NULL, 1, NULL, &r) == SC_ERROR_NULL && r.verdict == SC_VERDICT_NONE);
        s.posed[0] = 1e300 * 1e300;
        CHECK(ask(&s, &o, NULL, 0, NULL, &r) == SC_ERROR_NOT_FINITE &&
              r.verdict == SC_VERDICT_NONE);
        s.posed[0] = 0;
        memset(&r, 0, sizeof(r));
        r.struct_size = (uint32_t)offsetof(sc_result, verdict);
        r.verdict = 55;
        r.reserved = 66;
        CHECK(sc_query(s.model, s.workspace, &pose, &o, &r) == SC_OK);
        CHECK(r.verdict == 55 && r.reserved == 66);
        o.struct_size = (uint32_t)offsetof(sc_query_options, cancel);
        o.cancel = &stop; /* behind the older structure: not read */
        o.budget = 1;
        CHECK(ask(&s, &o, NULL, 0, NULL, &r) == SC_OK && r.verdict == SC_VERDICT_CLEAN);
        o.struct_size = sizeof(o);
        CHECK(ask(&s, &o, NULL, 0, NULL, &r) == SC_ERROR_INCOMPLETE);
    }
    close_subject(&s);
}

/* A flag that is set from the start: not even the positions are read. */
static void cancelled_before(void)
{
    subject s;
    if (open_subject(&s, soup_cloth(6, 6), 0)) {
        const uint32_t stop = 0x80000000u;
        fold_in_half(s.posed, s.mesh.vertex_count);
        for (uint32_t method = 0; method <= SC_METHOD_AABB; ++method)
            for (uint32_t output = 0; output <= SC_OUTPUT_ANY; ++output) {
                sc_query_options o = input_query(0, 0, method);
                sc_pair pair = {7, 8};
                sc_result r;
                o.output = output;
                o.cancel = &stop;
                CHECK(ask(&s, &o, &pair, 1, NULL, &r) == SC_ERROR_INCOMPLETE);
                CHECK(r.verdict == SC_VERDICT_INCOMPLETE && r.count == 0 && r.collides == 0);
                CHECK(pair.a == 7 && pair.b == 8);
                o.cancel = NULL;
                o.output = SC_OUTPUT_COUNT;
                CHECK(ask(&s, &o, NULL, 0, NULL, &r) == SC_OK && r.verdict == SC_VERDICT_FOUND);
            }
    }
    close_subject(&s);
}

/* One budget: twice, with and without statistics. Returns the number of pairs found; *found, as
   long as all, gets them. */
static uint64_t check_budget(const subject *s, sc_query_options o, uint64_t budget, uint64_t total,
                             const sc_pair *all, uint64_t all_count, sc_pair *found)
{
    sc_pair *again = (sc_pair *)test_allocate(all_count * sizeof(sc_pair));
    sc_stats stats;
    sc_result r, q;
    sc_status status, repeated;
    uint64_t half, work;
    o.budget = budget;
    status = ask(s, &o, found, all_count, &stats, &r);
    work = work_of(&stats);
    repeated = ask(s, &o, again, all_count, NULL, &q);
    CHECK_MSG(
        status == repeated && r.count == q.count && r.verdict == q.verdict &&
            (r.count > all_count || memcmp(found, again, (size_t)r.count * sizeof(sc_pair)) == 0),
        "%s: budget %" PRIu64 " of %" PRIu64 " gives %" PRIu64 ", then %" PRIu64
        " pairs; state %" PRIu64,
        s->name, budget, total, r.count, q.count, s->state);
    CHECK(r.collides == (r.count > 0) && r.count <= all_count);
    CHECK(is_part(found, r.count, all, all_count));
    if (status == SC_OK) {
        CHECK(r.count == all_count && work == total);
        CHECK(r.verdict == (all_count > 0 ? SC_VERDICT_FOUND : SC_VERDICT_CLEAN));
    } else {
        CHECK(status == SC_ERROR_INCOMPLETE && r.verdict == SC_VERDICT_INCOMPLETE);
        CHECK_MSG(budget < total && work > budget && work < budget + 5000,
                  "%s: budget %" PRIu64 " of %" PRIu64 ", work %" PRIu64, s->name, budget, total,
                  work);
    }
    /* a short array has the first of those found */
    half = r.count / 2;
    if (half > 0) {
        CHECK(ask(s, &o, again, half, NULL, &q) ==
              (status == SC_OK ? SC_ERROR_SHORT_BUFFER : status));
        CHECK(q.count == r.count && memcmp(found, again, (size_t)half * sizeof(sc_pair)) == 0);
    }
    o.output = SC_OUTPUT_COUNT;
    CHECK(ask(s, &o, NULL, 0, NULL, &q) == status && q.count == r.count);
    free(again);
    return r.count;
}

static void budgets(void)
{
    const uint32_t rounds = test_iterations(30);
    uint64_t partial = 0;
    for (uint32_t round = 0; round < rounds; ++round) {
        subject s;
        uint64_t state = test_random_state();
        soup mesh = shape_any(round % 4 == 0 ? 500 : 120, &s.name);
        s.state = state;
        if (open_subject(&s, mesh, 1)) {
            sc_query_options o =
                input_query(round % 2, round / 2 % 2, 1 + test_random_below(SC_METHOD_AABB));
            uint64_t total, last = 0;
            sc_stats stats;
            sc_result r;
            sc_pair *all, *found;
            if (round % 3 == 2) { /* the star test is a stage of its own */
                o.method = SC_METHOD_SCTT;
                o.contour = SC_CONTOUR_STAR;
            }
            ask(&s, &o, NULL, 0, &stats, &r);
            all = (sc_pair *)test_allocate(r.count * sizeof(sc_pair));
            found = (sc_pair *)test_allocate(r.count * sizeof(sc_pair));
            CHECK(ask(&s, &o, all, r.count, &stats, &r) == SC_OK);
            total = work_of(&stats);
            for (uint64_t i = 0; i <= 8; ++i) {
                uint64_t budget = i == 0 ? 1 : total / 8 * i + (i == 8 ? total % 8 : 0);
                uint64_t count;
                if (budget == 0) continue;
                count = check_budget(&s, o, budget, total, all, r.count, found);
                CHECK_MSG(count >= last, "%s: less with more", s.name);
                CHECK(i < 8 || count == r.count);
                partial += count > 0 && count < r.count;
                last = count;
            }
            o.output = SC_OUTPUT_ANY; /* complete with the first pair, or stopped before it */
            for (uint64_t budget = 1; budget <= total; budget *= 4) {
                sc_status status;
                o.budget = budget;
                status = ask(&s, &o, NULL, 0, NULL, &r);
                CHECK(r.collides ? status == SC_OK && r.verdict == SC_VERDICT_FOUND && r.count == 1
                                 : r.count == 0);
                CHECK((status == SC_ERROR_INCOMPLETE) == (r.verdict == SC_VERDICT_INCOMPLETE));
            }
            free(all);
            free(found);
        }
        close_subject(&s);
    }
    CHECK_MSG(3 * partial > 2 * rounds, "%" PRIu64 " partial answers", partial);
}

/* What accept does in the tests below: sets the flag after some calls, or lets another thread do
   it. */
typedef struct stopper {
    uint32_t flag;
    uint64_t calls, at;
    uint32_t asked; /* atomic: the other thread is to set the flag */
} stopper;

static int32_t stop_after(void *user, uint32_t a, uint32_t b)
{
    stopper *s = (stopper *)user;
    (void)a;
    (void)b;
    if (++s->calls == s->at) __atomic_store_n(&s->flag, 1, __ATOMIC_RELAXED);
    return 1;
}

static void cancelled_on_the_way(void)
{
    for (uint32_t round = 0; round < test_iterations(60); ++round) {
        subject s;
        soup mesh = soup_cloth(14, 14);
        s.name = "cloth";
        if (open_subject(&s, mesh, 0)) {
            sc_query_options o = input_query(round % 2, 0, 1 + round % 3);
            sc_pair *all, *found;
            uint64_t count;
            sc_filter f;
            sc_result r;
            stopper stop;
            fold_in_half(s.posed, s.mesh.vertex_count);
            ask(&s, &o, NULL, 0, NULL, &r);
            count = r.count;
            all = (sc_pair *)test_allocate(count * sizeof(sc_pair));
            found = (sc_pair *)test_allocate(count * sizeof(sc_pair));
            CHECK(ask(&s, &o, all, count, NULL, &r) == SC_OK);
            memset(&stop, 0, sizeof(stop));
            memset(&f, 0, sizeof(f));
            f.struct_size = sizeof(f);
            f.accept = stop_after;
            f.accept_user = &stop;
            o.filter = &f;
            o.cancel = &stop.flag;
            if (CHECK(count > 100)) {
                stop.at = 1 + test_random_below((uint32_t)count - 20);
                CHECK(ask(&s, &o, found, count, NULL, &r) == SC_ERROR_INCOMPLETE);
                CHECK_MSG(r.count >= stop.at && r.count < stop.at + 6 && r.count == stop.calls,
                          "set after %" PRIu64 " pairs, but there are %" PRIu64, stop.at, r.count);
                CHECK(r.verdict == SC_VERDICT_INCOMPLETE && r.collides == 1);
                CHECK(is_part(found, r.count, all, count));
            }
            free(all);
            free(found);
        }
        close_subject(&s);
    }
}

static int32_t wait_for_flag(void *user, uint32_t a, uint32_t b)
{
    stopper *s = (stopper *)user;
    (void)a;
    (void)b;
    s->calls++;
    __atomic_store_n(&s->asked, 1, __ATOMIC_RELEASE);
    while (__atomic_load_n(&s->flag, __ATOMIC_RELAXED) == 0) continue;
    return 1;
}

static void *set_flag(void *argument)
{
    stopper *s = (stopper *)argument;
    while (__atomic_load_n(&s->asked, __ATOMIC_ACQUIRE) == 0) continue;
    __atomic_store_n(&s->flag, 1, __ATOMIC_RELAXED);
    return NULL;
}

/* Another thread sets the flag while the query runs. */
static void cancelled_by_a_thread(void)
{
    subject s;
    if (open_subject(&s, soup_cloth(14, 14), 0)) {
        fold_in_half(s.posed, s.mesh.vertex_count);
        for (uint32_t method = 0; method <= SC_METHOD_AABB; ++method) {
            sc_query_options o = input_query(0, 0, method);
            sc_filter f;
            sc_result r;
            stopper stop;
            pthread_t thread;
            memset(&stop, 0, sizeof(stop));
            memset(&f, 0, sizeof(f));
            f.struct_size = sizeof(f);
            f.accept = wait_for_flag;
            f.accept_user = &stop;
            o.filter = &f;
            o.cancel = &stop.flag;
            o.output = SC_OUTPUT_COUNT;
            if (!CHECK(pthread_create(&thread, NULL, set_flag, &stop) == 0)) break;
            CHECK(ask(&s, &o, NULL, 0, NULL, &r) == SC_ERROR_INCOMPLETE);
            CHECK(r.verdict == SC_VERDICT_INCOMPLETE && r.count == 1 && stop.calls == 1);
            pthread_join(thread, NULL);
        }
    }
    close_subject(&s);
}

SC_TEST_MAIN(SC_TEST(complete_queries), SC_TEST(errors_and_older_callers),
             SC_TEST(cancelled_before), SC_TEST(budgets), SC_TEST(cancelled_on_the_way),
             SC_TEST(cancelled_by_a_thread))
