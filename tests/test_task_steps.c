/*
 * The host's tasks in steps: answers are those of one thread, whoever runs the parts and in
 * whatever order. Queries, and what is refused: test_tasks.c.
 *
 * SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "harness.h"
#include "inputs.h"
#include "soups.h"
#include "starcontour.h"
#include "tasks.h"

/* A step of a fixture, whose posed is the start. */
typedef struct step_fixture {
    fixture f;
    double *ended;
    sc_pose end;
    sc_workspace *serial, *shared; /* for one worker, and for THREADS_MAX */
} step_fixture;

enum { STEP_SCENES = 8, STEP_METHODS = 5, STEP_KINDS = STEP_METHODS * 2 * 3 };

/* Layers that pass each other; a cloth that waves and folds; pieces; contours that cross; a
   crumpled sphere; two triangles; a cloth of a triangle in each leaf cluster, of which a level has
   many; another one by an uneven tree, in which such a level has a large patch besides. */
static int start_step(step_fixture *s, int scene)
{
    soup mesh = scene == 0   ? soup_cloth(33, 33)
                : scene == 1 ? soup_cloth(33, 33)
                : scene == 2 ? soup_many(60)
                : scene == 3 ? soup_branched(64, 17)
                : scene == 4 ? soup_sphere(36, 36)
                : scene == 5 ? soup_cloth(2, 1)
                : scene == 6 ? soup_cloth(18, 18)
                             : soup_cloth(25, 25);
    size_t bytes = 3 * (size_t)mesh.vertex_count * sizeof(double);
    sc_workspace_options o = options_for_workers(1);
    memset(s, 0, sizeof(*s));
    if (!(scene < 6    ? fixture_start_plain(&s->f, mesh)
          : scene == 6 ? fixture_start_tree(&s->f, mesh, 1, 0, 0)
                       : fixture_start_tree(&s->f, mesh, 1, 600, 20)))
        return 0;
    if (scene != 3) soup_smooth(s->f.posed, mesh.vertex_count, 0.05);
    if (scene == 0) soup_twist(s->f.posed, mesh.vertex_count, 3);
    s->ended = (double *)test_allocate(bytes);
    memcpy(s->ended, s->f.posed, bytes);
    soup_smooth(s->ended, mesh.vertex_count, scene == 0 ? 0.4 : scene == 3 ? 0.01 : 0.1);
    if (scene == 0) soup_twist(s->ended, mesh.vertex_count, 0.3);
    if (scene == 1 || scene > 5) soup_fold(s->ended, mesh.vertex_count);
    if (scene == 4) soup_noise(s->ended, mesh.vertex_count, 0.03);
    s->end = input_plain_pose(s->ended, mesh.vertex_count);
    o.flags = SC_WORKSPACE_STEP;
    if (!CHECK(sc_workspace_create_for(s->f.model, &o, &s->serial) == SC_OK)) return 0;
    o.workers = THREADS_MAX;
    return CHECK(sc_workspace_create_for(s->f.model, &o, &s->shared) == SC_OK);
}

static void stop_step(step_fixture *s)
{
    sc_workspace_free(s->serial);
    sc_workspace_free(s->shared);
    free(s->ended);
    fixture_stop(&s->f);
}

/* Methods by what is reported by times. */
static sc_step_options step_question(uint32_t kind)
{
    static const uint32_t methods[STEP_METHODS][2] = {{SC_STEP_METHOD_SCTT, SC_CONTOUR_EXACT},
                                                      {SC_STEP_METHOD_SCTT, SC_CONTOUR_STAR},
                                                      {SC_STEP_METHOD_SCTT, SC_CONTOUR_NONE},
                                                      {SC_STEP_METHOD_TWO_BOXES, 0},
                                                      {SC_STEP_METHOD_SWEPT, 0}};
    sc_step_options options;
    memset(&options, 0, sizeof(options));
    options.struct_size = sizeof(options);
    options.method = methods[kind % STEP_METHODS][0];
    options.contour = methods[kind % STEP_METHODS][1];
    options.pairs = kind / STEP_METHODS % 2;
    options.times = kind / STEP_METHODS / 2;
    options.separation = kind % 3 == 1 ? 0.001 : 0;
    return options;
}

/* What the query of a step says; lists of vertex-face and edge-edge pairs, with times. */
typedef struct step_answer {
    sc_status status;
    sc_step_result result;
    sc_stats stats;
    uint64_t capacity[2], count[2];
    sc_pair *pairs[2];
    double *times[2];
} step_answer;

static step_answer ask_step(const step_fixture *s, sc_workspace *workspace,
                            const sc_step_options *options, uint64_t vertex_faces,
                            uint64_t edge_edges)
{
    step_answer a;
    memset(&a, 0, sizeof(a));
    a.capacity[0] = vertex_faces;
    a.capacity[1] = edge_edges;
    for (int k = 0; k < 2; ++k) {
        a.pairs[k] = (sc_pair *)test_allocate((a.capacity[k] + 1) * sizeof(sc_pair));
        a.times[k] = (double *)test_allocate((a.capacity[k] + 1) * sizeof(double));
        memset(a.pairs[k], 0xab, (a.capacity[k] + 1) * sizeof(sc_pair));
        memset(a.times[k], 0xab, (a.capacity[k] + 1) * sizeof(double));
    }
    a.stats.struct_size = sizeof(a.stats);
    a.result.struct_size = sizeof(a.result);
    a.result.vertex_face_capacity = vertex_faces;
    a.result.vertex_faces = a.pairs[0];
    a.result.vertex_face_times = a.times[0];
    a.result.edge_edge_capacity = edge_edges;
    a.result.edge_edges = a.pairs[1];
    a.result.edge_edge_times = a.times[1];
    a.result.stats = &a.stats;
    a.status = sc_query_step(s->f.model, workspace, &s->f.pose, &s->end, options, &a.result);
    a.count[0] = a.result.vertex_face_count;
    a.count[1] = a.result.edge_edge_count;
    for (int k = 0; k < 2; ++k) {
        uint32_t last[2];
        memcpy(last, &a.times[k][a.capacity[k]], sizeof(last));
        CHECK(a.pairs[k][a.capacity[k]].a == 0xabababab && last[0] == 0xabababab &&
              last[1] == 0xabababab);
    }
    return a;
}

static void free_step_answer(step_answer *a)
{
    for (int k = 0; k < 2; ++k) {
        free(a->pairs[k]);
        free(a->times[k]);
    }
}

/* Whether two answers are the same, with all that was written; frees b. */
static int is_same_step(const step_answer *a, step_answer b)
{
    int same = a->status == b.status && a->count[0] == b.count[0] && a->count[1] == b.count[1] &&
               a->result.collides == b.result.collides && a->result.verdict == b.result.verdict &&
               memcmp(&a->result.earliest, &b.result.earliest, sizeof(double)) == 0;
    for (int k = 0; k < 2; ++k) {
        uint64_t filled = a->count[k] < a->capacity[k] ? a->count[k] : a->capacity[k];
        same &= memcmp(a->pairs[k], b.pairs[k], (size_t)filled * sizeof(sc_pair)) == 0 &&
                memcmp(a->times[k], b.times[k], (size_t)filled * sizeof(double)) == 0;
    }
    free_step_answer(&b);
    return same;
}

static int is_step_count_same(const step_answer *a, const step_answer *b)
{
    return memcmp(a->stats.counts, b->stats.counts, sizeof(a->stats.counts)) == 0 &&
           a->stats.nodes_visited == b->stats.nodes_visited &&
           a->stats.nodes_oriented == b->stats.nodes_oriented &&
           a->stats.nodes_culled == b->stats.nodes_culled &&
           a->stats.leaf_pairs == b->stats.leaf_pairs;
}

/* A scene drawn anew until it has pairs to compare; the two triangles have none. */
static int start_colliding_step(step_fixture *s, int scene)
{
    for (int tries = 0; tries < 40; ++tries) {
        step_answer all;
        sc_step_options options = step_question(0);
        uint64_t count;
        options.output = SC_OUTPUT_COUNT;
        if (!start_step(s, scene)) return 0;
        all = ask_step(s, s->serial, &options, 0, 0);
        count = all.count[0] + all.count[1];
        free_step_answer(&all);
        if (scene == 5 || count > 20) return 1;
        stop_step(s);
    }
    CHECK_MSG(0, "scene %d: hardly any pairs", scene);
    return 0;
}

/* Each method, kind of pair, output, kind of time and length of the lists, by each host: the same
   list, times and counts as by one thread. */
static void steps_the_same(void)
{
    uint64_t jobs = 0, culled = 0;
    for (int scene = 0; scene < STEP_SCENES; ++scene) {
        step_fixture s;
        if (start_colliding_step(&s, scene))
            for (uint32_t kind = 0; kind < STEP_KINDS;
                 kind += scene < 2 && kind >= STEP_METHODS ? 3 : 1) {
                if (trial_is_left_out(scene, kind)) continue;
                sc_step_options options = step_question(kind);
                step_answer all;
                uint64_t v, e;
                host h;
                options.output = SC_OUTPUT_COUNT;
                all = ask_step(&s, s.serial, &options, 0, 0);
                v = all.count[0];
                e = all.count[1];
                CHECK(all.status == SC_OK);
                culled += all.stats.nodes_culled;
                if (scene < 5 && options.contour != SC_CONTOUR_NONE && kind < STEP_METHODS)
                    CHECK_MSG(v + e > 20, "scene %d: %u pairs", scene, (unsigned)(v + e));
                host_start(&h, (int)(kind + (uint32_t)scene) % HOST_COUNT,
                           1 + test_random_below(THREADS_MAX));
                options.tasks = &h.tasks;
                CHECK(is_same_step(&all, ask_step(&s, s.shared, &options, 0, 0)));
                options.output = SC_OUTPUT_PAIRS;
                for (int c = 0; c < ((kind + (uint32_t)scene) % 3 ? 1 : 3); ++c) {
                    const uint64_t room[3][2] = {{v, e}, {v + 1000, e + 300}, {v / 2, e}};
                    step_answer serial, other;
                    options.tasks = NULL;
                    serial = ask_step(&s, s.serial, &options, room[c][0], room[c][1]);
                    options.tasks = &h.tasks;
                    other = ask_step(&s, s.shared, &options, room[c][0], room[c][1]);
                    CHECK_MSG(is_step_count_same(&serial, &other),
                              "scene %d, kind %u, host %d: counts", scene, (unsigned)kind, h.way);
                    CHECK_MSG(is_same_step(&serial, other), "scene %d, kind %u, host %d, room %d",
                              scene, (unsigned)kind, h.way, c);
                    free_step_answer(&serial);
                }
                CHECK(h.mistakes == 0 && !h.is_busy);
                jobs += h.jobs;
                host_stop(&h);
                free_step_answer(&all);
            }
        stop_step(&s);
    }
    CHECK_MSG(jobs > test_iterations(500) && culled > test_iterations(200),
              "%u jobs, %u nodes culled", (unsigned)jobs, (unsigned)culled);
}

/* Steps that read no clocks and have no arrays for times, by one thread and by several: the same
   lists. */
static void steps_without_statistics(void)
{
    for (int scene = 0; scene < STEP_SCENES; ++scene) {
        step_fixture s;
        if (start_step(&s, scene))
            for (uint32_t kind = (uint32_t)scene; kind < 4 * STEP_METHODS; kind += 3) {
                if (trial_is_left_out(scene, kind)) continue;
                sc_step_options options = step_question(kind);
                uint64_t room = kind % 3 ? 40000 : 10;
                step_answer all;
                if (kind % 7 == 6) options.budget = 3000;
                all = ask_step(&s, s.serial, &options, room, room);
                for (int way = -1; way < 1; ++way) {
                    step_answer plain = all;
                    host h;
                    host_start(&h, (int)kind % HOST_COUNT, 2 + test_random_below(THREADS_MAX - 1));
                    options.tasks = way < 0 ? NULL : &h.tasks;
                    plain.result.stats = NULL;
                    plain.result.vertex_face_times = plain.result.edge_edge_times = NULL;
                    for (int k = 0; k < 2; ++k)
                        plain.pairs[k] = (sc_pair *)test_allocate(room * sizeof(sc_pair));
                    plain.result.vertex_faces = plain.pairs[0];
                    plain.result.edge_edges = plain.pairs[1];
                    CHECK(sc_query_step(s.f.model, way < 0 ? s.serial : s.shared, &s.f.pose, &s.end,
                                        &options, &plain.result) == all.status);
                    CHECK(plain.result.earliest == all.result.earliest &&
                          plain.result.vertex_face_count == all.count[0] &&
                          plain.result.edge_edge_count == all.count[1]);
                    for (int k = 0; k < 2; ++k) {
                        uint64_t filled = all.count[k] < room ? all.count[k] : room;
                        CHECK_MSG(memcmp(plain.pairs[k], all.pairs[k], filled * sizeof(sc_pair)) ==
                                      0,
                                  "scene %d, kind %u, host %d", scene, (unsigned)kind, way);
                        free(plain.pairs[k]);
                    }
                    host_stop(&h);
                }
                free_step_answer(&all);
            }
        stop_step(&s);
    }
}

/* One list, or both, too short or left out. */
static void steps_in_short_lists(void)
{
    step_fixture s;
    if (start_step(&s, 3)) {
        sc_step_options options = step_question(2 * 2 * STEP_METHODS);
        step_answer all = ask_step(&s, s.serial, &options, 0, 0);
        CHECK(all.status == SC_ERROR_SHORT_BUFFER && all.count[0] > 600 && all.count[1] > 600);
        for (uint32_t i = 0; i < 24; ++i) {
            if (trial_is_left_out(0, i / 2)) continue;
            uint64_t room[2];
            step_answer serial;
            host h;
            for (uint32_t k = 0; k < 2; ++k)
                room[k] = i >> k & 1         ? test_random_below((uint32_t)all.count[k] + 600)
                          : i >> (k + 2) & 1 ? 0
                                             : all.count[k];
            host_start(&h, (int)i % HOST_COUNT, 2 + test_random_below(THREADS_MAX - 1));
            options.tasks = NULL;
            options.times = i % 3;
            serial = ask_step(&s, s.serial, &options, room[0], room[1]);
            options.tasks = &h.tasks;
            CHECK_MSG(is_same_step(&serial, ask_step(&s, s.shared, &options, room[0], room[1])),
                      "room for %u and %u", (unsigned)room[0], (unsigned)room[1]);
            CHECK(h.mistakes == 0 && h.jobs > 0);
            free_step_answer(&serial);
            host_stop(&h);
        }
        free_step_answer(&all);
    }
    stop_step(&s);
}

/* Whether there is a pair at all: which one is found first, and so of which kind it is, is left
   open. */
static void any_pair_of_a_step(void)
{
    for (int scene = 0; scene < STEP_SCENES; ++scene) {
        step_fixture s;
        if (start_step(&s, scene))
            for (uint32_t i = (uint32_t)scene % 2; i < 2 * STEP_KINDS; i += 2) {
                if (trial_is_left_out(scene, i)) continue;
                sc_step_options options = step_question(i % STEP_KINDS);
                step_answer serial, other;
                host h;
                if (i >= STEP_KINDS)
                    s.f.pose.positions = s.end.positions = s.f.mesh.positions; /* at rest */
                options.output = SC_OUTPUT_ANY;
                serial = ask_step(&s, s.serial, &options, 0, 0);
                host_start(&h, (int)i % HOST_COUNT, 1 + test_random_below(THREADS_MAX));
                options.tasks = &h.tasks;
                other = ask_step(&s, s.shared, &options, 0, 0);
                CHECK(serial.status == SC_OK && other.status == SC_OK && h.mistakes == 0);
                CHECK(other.count[0] + other.count[1] == other.result.collides);
                CHECK(serial.result.collides == other.result.collides &&
                      serial.result.verdict == other.result.verdict &&
                      serial.result.earliest == other.result.earliest);
                host_stop(&h);
                free_step_answer(&serial);
                free_step_answer(&other);
            }
        stop_step(&s);
    }
}

/* Poses of any type and stride; one that is not finite is refused, wherever that is. */
static void any_positions_of_a_step(void)
{
    step_fixture s;
    if (start_step(&s, 1)) {
        sc_pose plain[2] = {s.f.pose, s.end};
        for (uint32_t i = 0; i < 16; ++i) {
            if (trial_is_left_out(0, i / 2)) continue;
            uint32_t count = s.f.mesh.vertex_count;
            input_array array[2];
            sc_step_options options = step_question(i % (2 * STEP_METHODS));
            step_answer serial, refused;
            host h;
            host_start(&h, (int)i % HOST_COUNT, 2 + test_random_below(THREADS_MAX - 1));
            for (uint32_t k = 0; k < 2; ++k)
                array[k] = input_positions(k ? s.ended : s.f.posed, count,
                                           (i >> k & 1) != 0 ? SC_FLOAT : SC_DOUBLE,
                                           (i >> (k + 1) & 1) != 0 ? 0 : 1 + test_random_below(20));
            s.f.pose = input_pose(count, &array[0]);
            s.end = input_pose(count, &array[1]);
            serial = ask_step(&s, s.serial, &options, 3000, 9000);
            CHECK(serial.status == SC_OK || serial.status == SC_ERROR_SHORT_BUFFER);
            options.tasks = &h.tasks;
            CHECK(is_same_step(&serial, ask_step(&s, s.shared, &options, 3000, 9000)));
            free_step_answer(&serial);
            for (uint32_t k = 0; k < 2; ++k)
                if (!(i >> k & 1)) { /* the last coordinate, or any */
                    uint32_t v = i % 3 ? count - 1 : test_random_below(count);
                    const double nan = i % 5 ? (double)NAN : (double)INFINITY;
                    memcpy(array[k].data + (size_t)v * (array[k].stride ? array[k].stride : 24) +
                               16,
                           &nan, sizeof(nan));
                    refused = ask_step(&s, s.shared, &options, 3000, 9000);
                    CHECK(refused.status == SC_ERROR_NOT_FINITE && refused.count[0] == 0 &&
                          refused.count[1] == 0 && refused.pairs[0][0].a == 0xabababab);
                    free_step_answer(&refused);
                }
            for (uint32_t k = 0; k < 2; ++k) input_free(&array[k]);
            host_stop(&h);
        }
        s.f.pose = plain[0];
        s.end = plain[1];
    }
    stop_step(&s);
}

/* A budget ends a step at the same place, and a flag that is set before ends it at once. */
static void steps_stopped_early(void)
{
    static const uint32_t flag = 1;
    for (int scene = 0; scene < 5; scene += 4) {
        step_fixture s;
        if (start_step(&s, scene))
            for (uint32_t kind = 0; kind < STEP_KINDS; ++kind) {
                if (trial_is_left_out(scene, kind)) continue;
                sc_step_options options = step_question(kind);
                step_answer serial;
                host h;
                host_start(&h, (int)kind % HOST_COUNT, 2 + test_random_below(THREADS_MAX - 1));
                options.budget = 1 + test_random_below(20000);
                serial = ask_step(&s, s.serial, &options, 10000, 10000);
                options.tasks = &h.tasks;
                CHECK(is_same_step(&serial, ask_step(&s, s.shared, &options, 10000, 10000)));
                free_step_answer(&serial);
                options.budget = 0;
                options.cancel = &flag;
                serial = ask_step(&s, s.shared, &options, 10, 10);
                CHECK(serial.status == SC_ERROR_INCOMPLETE && serial.count[0] == 0 &&
                      serial.count[1] == 0 && serial.result.verdict == SC_VERDICT_INCOMPLETE);
                free_step_answer(&serial);
                host_stop(&h);
            }
        stop_step(&s);
    }
}

/* What was found when the flag was set is delivered, sorted, and is right. */
static void steps_stopped_on_the_way(void)
{
    step_fixture s;
    if (start_step(&s, 4)) {
        uint32_t incomplete = 0, some = 0;
        for (uint32_t i = 0; i < 40; ++i) {
            sc_step_options options = step_question(i % 4 * STEP_METHODS + i % 2 * 3);
            step_answer all = ask_step(&s, s.serial, &options, 40000, 40000), part;
            breaker b;
            /* early, before there are boxes, or later */
            breaker_start(&b, 3, 1 + test_random_below(i % 4 == 3 ? 12 : 300));
            options.tasks = &b.tasks;
            options.cancel = &b.flag;
            part = ask_step(&s, s.shared, &options, 40000, 40000);
            if (b.flag && part.status == SC_ERROR_INCOMPLETE) {
                ++incomplete;
                some += part.count[0] + part.count[1] > 0;
                CHECK(part.result.verdict == SC_VERDICT_INCOMPLETE && part.result.earliest == 0);
                for (int k = 0; k < 2 && all.status == SC_OK; ++k) {
                    CHECK(part.count[k] <= all.count[k]);
                    for (uint64_t j = 0; j < part.count[k]; ++j)
                        CHECK(pair_is_among(part.pairs[k][j], all.pairs[k], all.count[k]) &&
                              (!j || part.pairs[k][j - 1].a < part.pairs[k][j].a ||
                               (part.pairs[k][j - 1].a == part.pairs[k][j].a &&
                                part.pairs[k][j - 1].b < part.pairs[k][j].b)));
                }
                free_step_answer(&part);
            } else {
                CHECK(is_same_step(&all, part));
            }
            options.cancel = NULL;
            CHECK(is_same_step(&all, ask_step(&s, s.shared, &options, 40000, 40000)));
            free_step_answer(&all);
        }
        CHECK_MSG(incomplete > 10 && some > 5, "%u stopped, %u with pairs", incomplete, some);
    }
    stop_step(&s);
}
SC_TEST_MAIN(SC_TEST(steps_the_same), SC_TEST(steps_without_statistics),
             SC_TEST(steps_in_short_lists), SC_TEST(any_pair_of_a_step),
             SC_TEST(any_positions_of_a_step), SC_TEST(steps_stopped_early),
             SC_TEST(steps_stopped_on_the_way))
