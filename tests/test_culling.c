/*
 * Culling loses nothing: on deformed meshes with thousands of pairs every method, partition and
 * kind of caching gives the pairs of the plain tree of boxes, and of the oracle where that is
 * feasible. Without the contour test pairs are lost: that is what it is for.
 *
 * Meshes that `make meshes` fetched are tested as well, if they are there: in build/meshes, or the
 * folder that the environment names as SC_LARGE_MESHES.
 *
 * SPDX-License-Identifier: MIT
 */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "harness.h"
#include "inputs.h"
#include "oracle.h"
#include "shapes.h"
#include "starcontour.h"
#include "starcontour_metis.h"

typedef struct way {
    const char *name;
    uint32_t method, contour, rest_cache;
} way;

static const way plain = {"aabb", SC_METHOD_AABB, 0, 0};
static const way no_contour = {"none", SC_METHOD_SCTT, SC_CONTOUR_NONE, SC_REST_CACHE_OFF};
static const way star = {"star, no cache", SC_METHOD_SCTT, SC_CONTOUR_STAR, SC_REST_CACHE_OFF};
static const way ways[] = {
    {"default", 0, 0, 0},
    {"default, no cache", 0, 0, SC_REST_CACHE_OFF},
    {"star", SC_METHOD_SCTT, SC_CONTOUR_STAR, SC_REST_CACHE_ON},
    {"star, no cache", SC_METHOD_SCTT, SC_CONTOUR_STAR, SC_REST_CACHE_OFF},
    {"aabb from the test tree", SC_METHOD_AABB_SCTT, 0, 0},
};

typedef struct answer {
    sc_pair *pairs;
    uint64_t count;
    sc_stats stats;
} answer;

/* How a model was built, and what it is asked. */
typedef struct subject {
    const char *mesh, *partition, *pose_name;
    sc_model *model;
    sc_workspace *workspace;
    sc_pose pose;
} subject;

static answer ask(const subject *s, const way *w, uint32_t kind, uint32_t contact)
{
    answer a;
    sc_query_options options;
    sc_result result;
    uint64_t capacity = 4096;
    sc_status status;
    memset(&options, 0, sizeof(options));
    options.struct_size = sizeof(options);
    options.pairs = kind;
    options.contact = contact;
    options.method = w->method;
    options.contour = w->contour;
    options.rest_cache = w->rest_cache;
    memset(&a, 0, sizeof(a));
    a.stats.struct_size = sizeof(a.stats);
    for (;;) {
        a.pairs = (sc_pair *)test_allocate(capacity * sizeof(sc_pair));
        memset(&result, 0, sizeof(result));
        result.struct_size = sizeof(result);
        result.capacity = capacity;
        result.pairs = a.pairs;
        result.stats = &a.stats;
        status = sc_query(s->model, s->workspace, &s->pose, &options, &result);
        if (status != SC_ERROR_SHORT_BUFFER) break;
        capacity = result.count;
        free(a.pairs);
    }
    CHECK_MSG(status == SC_OK, "%s, %s: status %d", s->mesh, w->name, (int)status);
    a.count = result.count;
    return a;
}

static int is_same(const answer *a, const sc_pair *pairs, uint64_t count)
{
    return a->count == count &&
           (count == 0 || memcmp(a->pairs, pairs, count * sizeof(sc_pair)) == 0);
}

/* All ways against the plain tree; returns how many pairs there are. */
static uint64_t check_ways(const subject *s, uint32_t kind, uint32_t contact)
{
    answer expected = ask(s, &plain, kind, contact);
    uint64_t count = expected.count;
    for (size_t i = 0; i < sizeof(ways) / sizeof(ways[0]); ++i) {
        answer a = ask(s, &ways[i], kind, contact);
        CHECK_MSG(is_same(&a, expected.pairs, count),
                  "%s, partition %s, pose %s, %s, pairs %" PRIu32 ", contact %" PRIu32 ": %" PRIu64
                  " pairs instead of %" PRIu64,
                  s->mesh, s->partition, s->pose_name, ways[i].name, kind, contact, a.count, count);
        free(a.pairs);
    }
    free(expected.pairs);
    return count;
}

/* The poses; those that crumple leave hardly a normal cone, those that bend leave most. */
enum { POSES = 7 };

static const char *pose_mesh(const soup *mesh, uint32_t number, double *p)
{
    uint32_t count = mesh->vertex_count;
    memcpy(p, mesh->positions, 3 * (size_t)count * sizeof(double));
    switch (number) {
    case 0:
        return "rest";
    case 1:
        shape_bend(p, count, 1.2);
        return "bent over itself";
    case 2:
        soup_twist(p, count, 2.5);
        return "twisted";
    case 3:
        soup_smooth(p, count, 0.15);
        return "waved";
    case 4:
        soup_smooth(p, count, 0.5);
        return "crumpled";
    case 5:
        soup_noise(p, count, 0.004);
        return "rough";
    default:
        for (uint32_t v = 0; v < count; ++v) { /* an elbow: half of it turns sharply */
            double *q = p + 3 * (size_t)v, x = q[0] - 0.5;
            if (x > 0) {
                q[0] = 0.5 - 0.6 * x + 0.8 * q[1];
                q[1] = 0.8 * x + 0.6 * q[1];
            }
        }
        return "elbow";
    }
}

/* Every step-th pose, as doubles and as floats, all on one workspace; returns the number of pairs
   met. */
static uint64_t check_poses(subject *s, const soup *mesh, uint32_t first, uint32_t step,
                            uint32_t every_kind)
{
    double *p = (double *)test_allocate(3 * (size_t)mesh->vertex_count * sizeof(double));
    uint64_t sum = 0;
    for (uint32_t i = first; i < POSES; i += step) {
        uint32_t type = i % 2 ? SC_FLOAT : SC_DOUBLE;
        input_array array;
        s->pose_name = pose_mesh(mesh, i, p);
        array = input_positions(p, mesh->vertex_count, type, 0);
        s->pose = input_pose(mesh->vertex_count, &array);
        sum += check_ways(s, i & 1 ? SC_PAIRS_EDGE : SC_PAIRS_TRIANGLE, i >> 1 & 1);
        for (uint32_t k = 0; k < 4 && every_kind; ++k) check_ways(s, k & 1, k >> 1);
        input_free(&array);
    }
    free(p);
    return sum;
}

static int build(subject *s, const soup *mesh, const sc_build_options *options,
                 const char *partition)
{
    sc_mesh m = input_plain_mesh(mesh);
    sc_build_options marked;
    sc_status status;
    memset(&marked, 0, sizeof(marked));
    if (options) marked = *options;
    marked.struct_size = sizeof(marked);
    marked.rest = SC_REST_MARKED;
    status = sc_build(&m, &marked, &s->model);
    s->partition = partition;
    s->workspace = NULL;
    return CHECK_MSG(status == SC_OK, "%s, partition %s: status %d", s->mesh, partition,
                     (int)status) &&
           CHECK(sc_workspace_create(s->model, NULL, &s->workspace) == SC_OK);
}

static void release(subject *s)
{
    sc_workspace_free(s->workspace);
    sc_model_free(s->model);
}

#ifdef SC_WITH_METIS
static const int has_metis = 1;
#else
static const int has_metis = 0;
#endif

/* Takes the mesh. */
static void check_large(const char *name, soup *mesh, uint64_t least)
{
    subject s;
    uint64_t pairs = 0;
    memset(&s, 0, sizeof(s));
    s.mesh = name;
    for (int metis = 0; metis <= has_metis; ++metis) {
        sc_build_options options;
        memset(&options, 0, sizeof(options));
        options.struct_size = sizeof(options);
        options.partition = metis ? SC_PARTITION_BISECT : SC_PARTITION_FAST;
        options.bisect = sc_metis_bisect;
        if (build(&s, mesh, &options, metis ? "metis" : "fast"))
            pairs += check_poses(&s, mesh, (uint32_t)metis, 1 + (uint32_t)metis, 0);
        release(&s);
    }
    CHECK_MSG(pairs >= least, "%s: only %" PRIu64 " pairs", name, pairs);
    soup_free(mesh);
}

static void generated_bodies(void)
{
    soup body = shape_body(60, 50), cloth = soup_cloth(50, 60), tube = soup_tube(40, 60), many;
    check_large("body", &body, 3000);
    check_large("cloth", &cloth, 5000);
    many = soup_copy(&tube);
    for (uint32_t v = 0; v < many.vertex_count; ++v) many.positions[3 * (size_t)v + 2] += 0.3;
    body = soup_join(&tube, &many);
    soup_free(&tube);
    soup_free(&many);
    check_large("two tubes", &body, 5000);
}

/* Every kind of partition and pair on a smaller mesh. */
static void every_partition(void)
{
    for (uint32_t partition = SC_PARTITION_FAST; partition <= SC_PARTITION_BISECT; ++partition)
        for (uint32_t i = 0; i < test_iterations(3); ++i) {
            soup mesh = i == 0 ? shape_body(16, 14) : i == 1 ? soup_moebius(60, 4) : shape_hub(120);
            input_choices c = input_choose(&mesh, SC_WELD_REST, partition);
            subject s;
            memset(&s, 0, sizeof(s));
            s.mesh = i == 0 ? "small body" : i == 1 ? "moebius" : "hub";
            if (build(&s, &mesh, &c.options, c.partition_name))
                CHECK(check_poses(&s, &mesh, 0, 1, 1) > 100);
            release(&s);
            input_free_choices(&c);
            soup_free(&mesh);
        }
}

/* The plain tree is right itself. */
static void against_the_oracle(void)
{
    uint64_t pairs = 0;
    uint32_t rounds = test_iterations_at_least(28, 7);
    for (uint32_t i = 0; i < rounds; ++i) {
        soup mesh = i % 4 == 0   ? shape_body(14, 12)
                    : i % 4 == 1 ? soup_cloth(12, 14)
                    : i % 4 == 2 ? shape_broken_cloth(12)
                                 : soup_sphere(14, 12);
        input_choices c = input_choose(&mesh, SC_WELD_REST, test_random_below(4));
        uint32_t *weld = input_weld_of(&c, &mesh);
        double *p = (double *)test_allocate(3 * (size_t)mesh.vertex_count * sizeof(double));
        subject s;
        memset(&s, 0, sizeof(s));
        s.mesh = "small mesh";
        if (build(&s, &mesh, &c.options, c.partition_name)) {
            oracle_answer right;
            s.pose_name = pose_mesh(&mesh, i % POSES, p);
            s.pose = input_plain_pose(p, mesh.vertex_count);
            oracle_solve(p, mesh.vertex_count, mesh.triangles, mesh.triangle_count, weld, &right);
            for (uint32_t k = 0; k < 4; ++k) {
                answer a = ask(&s, &plain, k & 1, k >> 1);
                CHECK_MSG(
                    is_same(&a, right.lists[k & 1][k >> 1].pairs, right.lists[k & 1][k >> 1].count),
                    "%s, %s: %" PRIu64 " instead of %" PRIu64, s.mesh, s.pose_name, a.count,
                    right.lists[k & 1][k >> 1].count);
                free(a.pairs);
                check_ways(&s, k & 1, k >> 1);
            }
            pairs += right.lists[0][0].count;
            oracle_free(&right);
        }
        release(&s);
        free(p);
        free(weld);
        input_free_choices(&c);
        soup_free(&mesh);
    }
    CHECK_MSG(pairs > 20 * rounds, "%" PRIu64 " pairs", pairs);
}

/* Pairs that `none` finds are pairs; returns how many it misses. */
static uint64_t count_missed(const subject *s, uint32_t contact)
{
    answer right = ask(s, &star, SC_PAIRS_TRIANGLE, contact), a = ask(s, &no_contour, 0, contact);
    answer all = ask(s, &plain, SC_PAIRS_TRIANGLE, contact);
    uint64_t missed = right.count - a.count, i, k = 0;
    CHECK_MSG(is_same(&right, all.pairs, all.count),
              "%s, %s: star has %" PRIu64 " pairs instead of %" PRIu64, s->mesh, s->partition,
              right.count, all.count);
    for (i = 0; i < a.count; ++i) {
        while (k < all.count && memcmp(&all.pairs[k], &a.pairs[i], sizeof(sc_pair)) != 0) ++k;
        if (!CHECK(k < all.count)) break;
    }
    free(right.pairs);
    free(a.pairs);
    free(all.pairs);
    return missed;
}

/* All normals up and more than one turn: the orientation test passes, and the strip meets
   itself. */
static void spirals_need_the_contour_test(void)
{
    for (uint32_t i = 0; i < 4; ++i) {
        soup mesh = shape_spiral(160, 5, 1.7, i % 2 ? 0.3 : 0);
        sc_build_options options;
        subject s;
        uint64_t missed;
        memset(&s, 0, sizeof(s));
        memset(&options, 0, sizeof(options));
        options.struct_size = sizeof(options);
        options.weld = SC_WELD_NONE;
        s.mesh = i % 2 ? "tilted spiral" : "flat spiral";
        s.pose_name = "rest";
        if (i >= 2) {
            options.partition = SC_PARTITION_BISECT;
            options.bisect = input_bisect;
        }
        if (build(&s, &mesh, &options, i < 2 ? "fast" : "bisect")) {
            s.pose = input_plain_pose(mesh.positions, mesh.vertex_count);
            missed = count_missed(&s, i % 2 ? SC_CONTACT_PROPER : SC_CONTACT_TOUCHING);
            CHECK_MSG(missed > 100, "none misses only %" PRIu64, missed);
        }
        release(&s);
        soup_free(&mesh);
    }
}

/* The method does cull: on smooth surfaces few leaf clusters are left to compare. */
static void culling_saves_work(void)
{
    soup mesh = soup_cloth(60, 60);
    subject s;
    memset(&s, 0, sizeof(s));
    s.mesh = "cloth";
    s.pose_name = "waved";
    if (build(&s, &mesh, NULL, "fast")) {
        double *p = soup_copy_positions(&mesh);
        answer flat, all, waved, all_waved;
        s.pose = input_plain_pose(p, mesh.vertex_count);
        flat = ask(&s, &star, 0, 0);
        all = ask(&s, &ways[4], 0, 0);
        CHECK_MSG(20 * flat.stats.leaf_pairs < all.stats.leaf_pairs, "%" PRIu64 " of %" PRIu64,
                  flat.stats.leaf_pairs, all.stats.leaf_pairs);
        CHECK(flat.stats.nodes_oriented == 1 && flat.stats.nodes_culled >= 1);
        shape_bend(p, mesh.vertex_count, 0.5);
        waved = ask(&s, &star, 0, 0);
        all_waved = ask(&s, &ways[4], 0, 0);
        CHECK_MSG(2 * waved.stats.leaf_pairs < all_waved.stats.leaf_pairs,
                  "%" PRIu64 " of %" PRIu64, waved.stats.leaf_pairs, all_waved.stats.leaf_pairs);
        free(flat.pairs);
        free(all.pairs);
        free(waved.pairs);
        free(all_waved.pairs);
        free(p);
    }
    release(&s);
    soup_free(&mesh);
}

/* ---- fetched meshes ---- */

/* Scales a mesh to lie along the x axis from 0 to 1, as the deformers expect. */
static int read_large(const char *file, soup *mesh)
{
    const char *folder =
        getenv("SC_LARGE_MESHES") != NULL ? getenv("SC_LARGE_MESHES") : "build/meshes";
    char path[512];
    double low[3], high[3];
    int longest = 0;
    snprintf(path, sizeof(path), "%s/%s", folder, file);
    if (!(strstr(file, ".ply") != NULL ? shape_read_ply(path, mesh) : input_read_obj(path, mesh))) {
        test_skip("no %s", path);
        return 0;
    }
    memcpy(low, mesh->positions, sizeof(low));
    memcpy(high, mesh->positions, sizeof(high));
    for (uint32_t i = 0; i < 3 * mesh->vertex_count; ++i) {
        if (mesh->positions[i] < low[i % 3]) low[i % 3] = mesh->positions[i];
        if (mesh->positions[i] > high[i % 3]) high[i % 3] = mesh->positions[i];
    }
    for (int k = 1; k < 3; ++k)
        if (high[k] - low[k] > high[longest] - low[longest]) longest = k;
    for (uint32_t v = 0; v < mesh->vertex_count; ++v) {
        double *p = mesh->positions + 3 * (size_t)v, q[3];
        for (int k = 0; k < 3; ++k) q[k] = (p[k] - low[k]) / (high[longest] - low[longest]);
        for (int k = 0; k < 3; ++k) p[k] = q[(k + longest) % 3];
    }
    return 1;
}

/* The cat as it is meets itself; bent, it does so where the orientation test passes. */
static void cat(void)
{
    soup mesh;
    subject s;
    memset(&s, 0, sizeof(s));
    s.mesh = "cat";
    if (!read_large("cat_x4.ply", &mesh)) return;
    if (build(&s, &mesh, NULL, "fast")) {
        double *p = soup_copy_positions(&mesh);
        uint64_t missed = 0;
        s.pose = input_plain_pose(p, mesh.vertex_count);
        /* bent and rough; what noise lets meet differs, so as often as it takes to see some */
        for (uint32_t i = 1; i < POSES || (missed <= 5 && i < 8 * POSES); i += 4) {
            s.pose_name = pose_mesh(&mesh, i < POSES ? i : 5, p);
            missed += count_missed(&s, SC_CONTACT_PROPER);
        }
        test_note("without the contour test the cat misses %" PRIu64 " pairs", missed);
        CHECK(missed > 5);
        free(p);
    }
    release(&s);
    check_large("cat", &mesh, 5000);
}

static void bunny(void)
{
    soup mesh;
    if (read_large("bunny.obj", &mesh)) check_large("bunny", &mesh, 5000);
}

static void horse(void)
{
    soup mesh;
    if (read_large("horse_x4.ply", &mesh)) check_large("horse", &mesh, 5000);
}

SC_TEST_MAIN(SC_TEST(generated_bodies), SC_TEST(every_partition), SC_TEST(against_the_oracle),
             SC_TEST(spirals_need_the_contour_test), SC_TEST(culling_saves_work), SC_TEST(cat),
             SC_TEST(bunny), SC_TEST(horse))
