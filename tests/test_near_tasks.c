/*
 * What is near in larger meshes: culling loses nothing that boxes find, and the host's tasks change
 * nothing, whoever runs the parts and in whatever order. Small meshes, by brute force: test_near.c.
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

/* A fixture with workspaces for what is near. */
typedef struct near_fixture {
    fixture f;
    near_question serial, shared; /* for one worker, and for THREADS_MAX */
    double edge;                  /* the length of an edge in the pose, about */
} near_fixture;

enum { SCENES = 7 };

/* Takes the mesh over; amount, from 0 to 1, is how far it is deformed. */
static int start(near_fixture *s, int scene, double amount)
{
    static const char *const names[SCENES] = {"twisted cloth", "folding cloth", "pieces",
                                              "branched disc", "bent body",     "spiral",
                                              "seams"};
    soup mesh = scene == 0   ? soup_cloth(40, 40)
                : scene == 1 ? soup_cloth(70, 70)
                : scene == 2 ? soup_many(60)
                : scene == 3 ? soup_branched(64, 17)
                : scene == 4 ? shape_body(48, 40)
                : scene == 5 ? shape_spiral(200, 8, 3, 0)
                             : soup_seams(30);
    double sum = 0;
    memset(s, 0, sizeof(*s));
    if (!fixture_start_plain(&s->f, mesh)) return 0;
    if (scene == 0) soup_twist(s->f.posed, mesh.vertex_count, 3 * amount);
    if (scene == 1)
        for (uint32_t v = 0; v < mesh.vertex_count; ++v) { /* about a line in the middle */
            double *p = s->f.posed + 3 * (size_t)v, x = p[0] - 0.5, turn = 3.1 * amount;
            if (x < 0) continue;
            p[0] = 0.5 + x * cos(turn);
            p[2] += x * sin(turn);
        }
    if (scene == 4) shape_bend(s->f.posed, mesh.vertex_count, 1.1 * amount);
    if (scene != 3) soup_smooth(s->f.posed, mesh.vertex_count, 0.1 * amount);
    for (uint32_t t = 0; t < mesh.triangle_count; ++t) {
        const double *p = s->f.posed + 3 * (size_t)mesh.triangles[3 * t];
        const double *q = s->f.posed + 3 * (size_t)mesh.triangles[3 * t + 1];
        sum += hypot(hypot(p[0] - q[0], p[1] - q[1]), p[2] - q[2]);
    }
    s->edge = sum / mesh.triangle_count;
    s->serial.name = names[scene];
    s->serial.model = s->f.model;
    s->serial.pose = &s->f.pose;
    s->serial.state = test_random_state();
    s->serial.workspace = near_workspace(s->f.model, 1);
    s->shared = s->serial;
    s->shared.workspace = near_workspace(s->f.model, THREADS_MAX);
    return s->serial.workspace != NULL && s->shared.workspace != NULL;
}

static void stop(near_fixture *s)
{
    sc_workspace_free(s->serial.workspace);
    sc_workspace_free(s->shared.workspace);
    fixture_stop(&s->f);
}

static int is_listed(const near_answer *a, int kind, sc_pair pair)
{
    return pair_is_among(pair, a->pairs[kind], a->count[kind]);
}

/* Pairs drawn at random, and those found: each as the oracle says. */
static void check_sample(const near_fixture *s, const near_answer *a, double distance)
{
    uint32_t *weld = (uint32_t *)test_allocate(s->f.mesh.vertex_count * sizeof(uint32_t));
    soup few = s->f.mesh; /* a part, as all edges are compared for their names */
    step_motion m;
    oracle_weld(s->f.mesh.positions, few.vertex_count, few.triangles, few.triangle_count, weld);
    if (few.triangle_count > 300) few.triangle_count = 300;
    m = step_motion_make(&few, s->f.posed, s->f.posed, weld);
    for (uint32_t i = 0; i < 300; ++i) {
        const int kind = (int)(i % 2);
        sc_pair pair;
        if (!near_truth_draw(&m, kind, &pair)) break;
        CHECK_MSG(is_listed(a, kind, pair) == near_truth_is_within(&m, kind, pair, distance),
                  "%s: %s (%" PRIu32 ", %" PRIu32 ") at %a, state %" PRIu64, s->serial.name,
                  step_kind_names[kind], pair.a, pair.b, distance, s->serial.state);
    }
    m.triangle_count = s->f.mesh.triangle_count;
    step_motion_free(&m);
    free(weld);
}

/* By contours and by boxes, from where nearly all is culled to where nothing can be. */
static void culling_loses_nothing(void)
{
    static const double edges[] = {0.01, 0.05, 0.2, 0.5, 1, 3};
    uint64_t culled = 0, pairs = 0;
    for (uint32_t i = 0; i < test_iterations_at_least(3 * SCENES, SCENES); ++i) {
        near_fixture s;
        if (start(&s, (int)(i % SCENES), test_random_range(0, 1)))
            for (uint32_t d = 0; d < 6; ++d) {
                const double distance = edges[d] * s.edge;
                sc_near_options options = near_options_for(&near_ways[4], distance);
                near_answer boxes = near_ask_all(&s.serial, &options), sctt;
                options.method = SC_NEAR_METHOD_SCTT;
                options.simd = SC_SIMD_BEST;
                sctt = near_ask_all(&s.serial, &options);
                CHECK_MSG(near_answers_are_same(&boxes, &sctt),
                          "%s: %" PRIu64 " %" PRIu64 " instead of %" PRIu64 " %" PRIu64
                          " at %a, state %" PRIu64,
                          s.serial.name, sctt.count[0], sctt.count[1], boxes.count[0],
                          boxes.count[1], distance, s.serial.state);
                check_sample(&s, &sctt, distance);
                CHECK(boxes.stats.nodes_culled == 0);
                culled += sctt.stats.nodes_culled;
                pairs += sctt.count[0] + sctt.count[1];
                near_answer_free(&boxes);
                near_answer_free(&sctt);
            }
        stop(&s);
    }
    test_note("%" PRIu64 " nodes culled, %" PRIu64 " pairs", culled, pairs);
    CHECK(culled > 50 && pairs > 1000);
}

/* Lists, numbers and statistics are those of one worker. */
static void near_by_many_workers(void)
{
    uint64_t jobs = 0;
    for (uint32_t i = 0; i < test_iterations_at_least(8 * SCENES, SCENES); ++i) {
        near_fixture s;
        if (start(&s, (int)(i % SCENES), 0.7)) {
            sc_near_options options =
                near_options_for(&near_ways[i % 3 ? 0 : 4], s.edge * (i % 2 ? 0.1 : 1.5));
            near_answer all, short_list, other, two;
            host h;
            options.kinds = i % 5 ? SC_NEAR_BOTH : 1 + i % 2;
            all = near_ask_all(&s.serial, &options);
            host_start(&h, (int)(i % HOST_COUNT), 1 + test_random_below(THREADS_MAX));
            options.tasks = &h.tasks;
            other = near_ask(&s.shared, &options, all.count[0], all.count[1]);
            CHECK_MSG(near_answers_are_same(&all, &other), "%s, host %d, state %" PRIu64,
                      s.serial.name, h.way, s.serial.state);
            CHECK_MSG(memcmp(all.stats.counts, other.stats.counts, sizeof(all.stats.counts)) == 0 &&
                          all.stats.nodes_visited == other.stats.nodes_visited &&
                          all.stats.nodes_culled == other.stats.nodes_culled &&
                          all.stats.leaf_pairs == other.stats.leaf_pairs,
                      "%s, host %d: counts", s.serial.name, h.way);
            h.tasks.workers = 2;
            two = near_ask(&s.shared, &options, all.count[0], all.count[1]);
            CHECK(near_answers_are_same(&all, &two) &&
                  memcmp(two.stats.counts, other.stats.counts, sizeof(two.stats.counts)) == 0);
            near_answer_free(&two);
            options.tasks = NULL;
            short_list = near_ask(&s.serial, &options, all.count[0] / 2, all.count[1] / 3);
            near_answer_free(&other);
            options.tasks = &h.tasks;
            other = near_ask(&s.shared, &options, all.count[0] / 2, all.count[1] / 3);
            CHECK(near_answers_are_same(&short_list, &other));
            for (int kind = 0; kind < 2; ++kind)
                CHECK(memcmp(all.pairs[kind], other.pairs[kind],
                             (size_t)other.capacity[kind] * sizeof(sc_pair)) == 0);
            near_answer_free(&other);
            options.output = SC_OUTPUT_ANY;
            other = near_ask(&s.shared, &options, 0, 0);
            CHECK(other.status == SC_OK && other.result.found == all.result.found &&
                  other.count[0] + other.count[1] == all.result.found);
            near_answer_free(&other);
            options.output = SC_OUTPUT_COUNT;
            other = near_ask(&s.shared, &options, 0, 0);
            CHECK(other.status == SC_OK && other.count[0] == all.count[0] &&
                  other.count[1] == all.count[1]);
            CHECK(h.mistakes == 0 && !h.is_busy);
            jobs += h.jobs;
            near_answer_free(&other);
            near_answer_free(&short_list);
            near_answer_free(&all);
            host_stop(&h);
        }
        stop(&s);
    }
    CHECK_MSG(jobs > 10, "%" PRIu64 " jobs", jobs);
}

/* Models for boxes have room for some of what is made of leaf clusters: two may have one place, and
   the next search finds those of the last one. */
static void more_leaf_clusters_than_places(void)
{
    uint64_t pairs = 0;
    for (uint32_t i = 0; i < test_iterations_at_least(12, 4); ++i) {
        near_fixture s;
        if (start(&s, i % 4 == 3 ? 5 : (int)(i % 4), 0.3)) {
            sc_build_options build;
            sc_mesh mesh = input_plain_mesh(&s.f.mesh);
            sc_model *model = NULL;
            near_question few = s.serial, shared;
            host h;
            memset(&build, 0, sizeof(build));
            build.struct_size = sizeof(build);
            build.content = SC_MODEL_BOXES;
            if (!CHECK(sc_build(&mesh, &build, &model) == SC_OK)) return;
            host_start(&h, (int)(i % HOST_COUNT), THREADS_MAX);
            few.model = model;
            few.workspace = near_workspace(model, 1);
            shared = few;
            shared.workspace = near_workspace(model, THREADS_MAX);
            for (int round = 0; round < 3; ++round) { /* places are taken */
                sc_near_options options =
                    near_options_for(&near_ways[0], s.edge * (round == 2 ? 0.1 : 1.2));
                near_answer all = near_ask_all(&s.serial, &options), other;
                other = near_ask(&few, &options, all.count[0], all.count[1]);
                CHECK_MSG(near_answers_are_same(&all, &other), "%s, round %d, state %" PRIu64,
                          s.serial.name, round, s.serial.state);
                near_answer_free(&other);
                options.tasks = &h.tasks;
                other = near_ask(&shared, &options, all.count[0], all.count[1]);
                CHECK_MSG(near_answers_are_same(&all, &other),
                          "%s, round %d, host %d, state %" PRIu64, s.serial.name, round, h.way,
                          s.serial.state);
                near_answer_free(&other);
                pairs += all.count[0] + all.count[1];
                near_answer_free(&all);
                soup_fold(s.f.posed, s.f.mesh.vertex_count);
            }
            host_stop(&h);
            sc_workspace_free(few.workspace);
            sc_workspace_free(shared.workspace);
            sc_model_free(model);
        }
        stop(&s);
    }
    CHECK_MSG(pairs > 10000, "%" PRIu64 " pairs", pairs);
}

/* A flag and a budget: what was found is right, sorted, and incomplete. */
static void near_stopped_early(void)
{
    uint32_t stopped[2] = {0, 0}, some = 0; /* by the flag and by the budget */
    near_fixture s;
    if (start(&s, 0, 0.8))
        for (uint32_t i = 0; i < test_iterations_at_least(60, 20); ++i) {
            sc_near_options options = near_options_for(&near_ways[i % 2 ? 0 : 4], 1.2 * s.edge);
            near_answer all = near_ask_all(&s.serial, &options), part;
            breaker b;
            breaker_start(&b, 3, 1 + test_random_below(i % 4 == 3 ? 12 : 300));
            options.tasks = &b.tasks;
            options.cancel = &b.flag;
            if (i % 3 == 0) {
                options.cancel = NULL;
                options.tasks = NULL;
                options.budget = 1 + test_random_below(60000);
            }
            part = near_ask(&s.shared, &options, all.count[0], all.count[1]);
            if (part.status == SC_ERROR_INCOMPLETE) {
                ++stopped[i % 3 == 0];
                some += part.count[0] + part.count[1] > 0;
                CHECK(part.result.verdict == SC_VERDICT_INCOMPLETE &&
                      part.result.found == (part.count[0] + part.count[1] > 0));
                CHECK(near_answer_is_in(&part, &all));
                for (int kind = 0; kind < 2; ++kind)
                    for (uint64_t j = 1; j < part.count[kind]; ++j)
                        CHECK(part.pairs[kind][j - 1].a < part.pairs[kind][j].a ||
                              (part.pairs[kind][j - 1].a == part.pairs[kind][j].a &&
                               part.pairs[kind][j - 1].b < part.pairs[kind][j].b));
            } else {
                CHECK(near_answers_are_same(&all, &part));
            }
            near_answer_free(&part);
            options = near_options_for(&near_ways[0], 1.2 * s.edge);
            part = near_ask(&s.shared, &options, all.count[0], all.count[1]);
            CHECK(near_answers_are_same(&all, &part));
            near_answer_free(&part);
            near_answer_free(&all);
        }
    stop(&s);
    CHECK_MSG(stopped[0] > 2 && stopped[1] > 2 && some > 2,
              "%u stopped by the flag, %u by the budget, %u with pairs", stopped[0], stopped[1],
              some);
}

/* Lists so long that several workers sort them in parts; the second time most vertices of pairs have
   low numbers, and a few such high ones that nearly all is in one part. */
static void very_many_pairs(void)
{
    for (uint32_t i = 0; i < 2; ++i) {
        soup cloth = soup_cloth(60, 60), last = soup_make(i ? 1000000 : 3, 1), both;
        near_question q = {"many pairs", NULL, NULL, NULL, 0};
        sc_model *model = NULL;
        sc_mesh mesh;
        sc_pose pose;
        memset(last.positions, 0, 3 * (size_t)last.vertex_count * sizeof(double));
        for (uint32_t k = 0; k < 3; ++k) {
            const uint32_t v = last.vertex_count - 3 + k;
            last.triangles[k] = v;
            last.positions[3 * (size_t)v + k] = 0.3;
        }
        both = soup_join(&cloth, &last);
        soup_free(&cloth);
        soup_free(&last);
        mesh = input_plain_mesh(&both);
        pose = input_plain_pose(both.positions, both.vertex_count);
        q.pose = &pose;
        if (CHECK(sc_build(&mesh, NULL, &model) == SC_OK)) {
            sc_workspace *serial = near_workspace(model, 1), *shared = near_workspace(model, 3);
            for (uint32_t workers = 1; workers < 4; ++workers) {
                sc_near_options options = near_options_for(&near_ways[0], 0.05);
                near_answer one, several;
                host h;
                q.model = model;
                q.workspace = serial;
                one = near_ask_all(&q, &options);
                CHECK(one.count[0] > 100000 && one.count[1] > 100000);
                host_start(&h, HOST_THREADS, workers);
                options.tasks = &h.tasks;
                q.workspace = shared;
                several = near_ask_all(&q, &options);
                CHECK_MSG(near_answers_are_same(&one, &several), "%" PRIu32 " workers", workers);
                host_stop(&h);
                near_answer_free(&one);
                near_answer_free(&several);
            }
            sc_workspace_free(serial);
            sc_workspace_free(shared);
        }
        sc_model_free(model);
        soup_free(&both);
    }
}

SC_TEST_MAIN(SC_TEST(culling_loses_nothing), SC_TEST(near_by_many_workers),
             SC_TEST(more_leaf_clusters_than_places), SC_TEST(near_stopped_early),
             SC_TEST(very_many_pairs))
