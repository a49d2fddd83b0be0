/*
 * What a query does beside finding pairs: it stops early if one is enough, writes what was asked
 * for and no more, and refuses what does not fit the model; and coordinates near the ends of what
 * floats hold.
 *
 * SPDX-License-Identifier: MIT
 */
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "build/hierarchy.h"
#include "harness.h"
#include "inputs.h"
#include "shapes.h"
#include "starcontour.h"

static const uint32_t methods[] = {SC_METHOD_SCTT, SC_METHOD_AABB_SCTT, SC_METHOD_AABB};
enum { METHODS = 3 };

typedef struct subject {
    sc_model *model;
    sc_workspace *workspace;
} subject;

static int open_subject(subject *s, const soup *mesh, const sc_build_options *options)
{
    sc_mesh m = input_plain_mesh(mesh);
    s->model = NULL;
    s->workspace = NULL;
    return CHECK(sc_build(&m, options, &s->model) == SC_OK) &&
           CHECK(sc_workspace_create(s->model, NULL, &s->workspace) == SC_OK);
}

static void close_subject(subject *s)
{
    sc_workspace_free(s->workspace);
    sc_model_free(s->model);
}

static sc_status ask(const subject *s, const double *positions, uint32_t vertex_count,
                     uint32_t method, uint32_t output, sc_result *result)
{
    sc_pose pose = input_plain_pose(positions, vertex_count);
    sc_query_options options;
    memset(&options, 0, sizeof(options));
    options.struct_size = sizeof(options);
    options.method = method;
    options.output = output;
    result->struct_size = sizeof(*result);
    return sc_query(s->model, s->workspace, &pose, &options, result);
}

/* Two cloths in one plane, askew: thousands of pairs. */
static soup make_layers(void)
{
    soup a = soup_cloth(30, 30), b = soup_cloth(30, 30), both;
    for (uint32_t v = 0; v < b.vertex_count; ++v) b.positions[3 * (size_t)v] += 0.013;
    both = soup_join(&a, &b);
    soup_free(&a);
    soup_free(&b);
    return both;
}

static void any_stops_early(void)
{
    soup mesh = make_layers();
    subject s;
    if (open_subject(&s, &mesh, NULL))
        for (uint32_t i = 0; i < METHODS; ++i) {
            sc_stats all, first;
            sc_result r;
            memset(&r, 0, sizeof(r));
            all.struct_size = first.struct_size = sizeof(all);
            r.stats = &all;
            CHECK(ask(&s, mesh.positions, mesh.vertex_count, methods[i], SC_OUTPUT_COUNT, &r) ==
                  SC_OK);
            CHECK(r.count > 2000 && r.collides == 1);
            r.stats = &first;
            CHECK(ask(&s, mesh.positions, mesh.vertex_count, methods[i], SC_OUTPUT_ANY, &r) ==
                  SC_OK);
            CHECK(r.count == 1 && r.collides == 1);
            CHECK_MSG(4 * first.leaf_pairs < all.leaf_pairs,
                      "method %" PRIu32 ": %" PRIu64 " of %" PRIu64 " pairs of leaves", methods[i],
                      first.leaf_pairs, all.leaf_pairs);
        }
    close_subject(&s);
    soup_free(&mesh);
}

/* The array is for SC_OUTPUT_PAIRS, and of that only as much as there are pairs. */
static void arrays_are_left_alone(void)
{
    soup mesh = make_layers();
    subject s;
    if (open_subject(&s, &mesh, NULL))
        for (uint32_t output = SC_OUTPUT_PAIRS; output <= SC_OUTPUT_ANY; ++output)
            for (uint32_t i = 0; i < METHODS; ++i) {
                enum { ROOM = 20000 };
                sc_pair *pairs = (sc_pair *)test_allocate(ROOM * sizeof(sc_pair));
                uint64_t k, written;
                sc_result r;
                memset(pairs, 0xff, ROOM * sizeof(sc_pair));
                memset(&r, 0, sizeof(r));
                r.pairs = pairs;
                r.capacity = ROOM;
                CHECK(ask(&s, mesh.positions, mesh.vertex_count, methods[i], output, &r) == SC_OK);
                written = output == SC_OUTPUT_PAIRS ? r.count : 0;
                for (k = written; k < ROOM; ++k)
                    if (pairs[k].a != 0xffffffff || pairs[k].b != 0xffffffff) break;
                CHECK_MSG(k == ROOM, "output %" PRIu32 " wrote entry %" PRIu64, output, k);
                free(pairs);
            }
    close_subject(&s);
    soup_free(&mesh);
}

/*
 * Where coordinates or their projections leave the range of float or double on one side only, or
 * just so: each method against the plain tree.
 */
static void largest_coordinates(void)
{
    uint64_t sum = 0;
    for (uint32_t round = 0; round < test_iterations(400); ++round) {
        uint32_t kind = test_random_below(4);
        soup mesh = kind == 0   ? soup_cloth(5, 6)
                    : kind == 1 ? shape_spiral(20, 2, 1.4, 0)
                    : kind == 2 ? soup_pinched(4)
                                : soup_sphere(6, 5);
        double size = 1,
               exponent = round % 2 ? test_random_range(33, 40) : test_random_range(300, 308);
        double shift = test_random_below(2) ? test_random_range(-1, 1) : 0;
        uint64_t state = test_random_state();
        subject s;
        for (; exponent >= 1; exponent -= 1) size *= 10;
        size *= 1 + 9 * exponent;
        if (!open_subject(&s, &mesh, NULL)) return;
        if (test_random_below(2)) soup_noise(mesh.positions, mesh.vertex_count, 0.02);
        for (uint32_t i = 0; i < 3 * mesh.vertex_count; ++i) {
            double x = (mesh.positions[i] + shift) * (test_random_below(40) ? 1 : 1.5) * size;
            mesh.positions[i] = x > 1.7e308 ? 1.7e308 : x < -1.7e308 ? -1.7e308 : x;
        }
        for (uint32_t contact = 0; contact < 1; ++contact) {
            enum { ROOM = 8000 };
            static sc_pair right[ROOM], pairs[ROOM];
            sc_result r, q;
            memset(&r, 0, sizeof(r));
            memset(&q, 0, sizeof(q));
            r.pairs = right;
            q.pairs = pairs;
            r.capacity = q.capacity = ROOM;
            CHECK(ask(&s, mesh.positions, mesh.vertex_count, SC_METHOD_AABB, 0, &r) == SC_OK);
            for (uint32_t i = 0; i < 2; ++i) {
                CHECK(ask(&s, mesh.positions, mesh.vertex_count, methods[i], 0, &q) == SC_OK);
                CHECK_MSG(
                    q.count == r.count &&
                        (r.count == 0 || memcmp(pairs, right, r.count * sizeof(sc_pair)) == 0),
                    "method %" PRIu32 ": %" PRIu64 " instead of %" PRIu64 "; started at %" PRIu64,
                    methods[i], q.count, r.count, state);
            }
            sum += r.count;
        }
        close_subject(&s);
        soup_free(&mesh);
    }
    CHECK(sum > 100);
}

/*
 * The rest shape decides where contours are cut, so that two models of one topology may need
 * workspaces of different sizes: a smaller one must be refused, although hash and model may be of
 * the same size.
 */
static void other_rest_shapes(void)
{
    uint32_t different = 0;
    for (uint32_t round = 0; round < 400; ++round) {
        uint32_t count = 1 + round % 8, triangles[24], order[8];
        double positions[2][30];
        sc_build_options options;
        sc_mesh mesh;
        sc_model_info info[2];
        subject s[2];
        soup strip;
        strip.vertex_count = count + 2;
        strip.triangle_count = count;
        strip.triangles = triangles;
        for (uint32_t i = 0; i < count; ++i) {
            triangles[3 * i] = i;
            triangles[3 * i + 1] = i % 2 ? i + 2 : i + 1;
            triangles[3 * i + 2] = i % 2 ? i + 1 : i + 2;
            order[i] = i;
        }
        memset(&options, 0, sizeof(options));
        options.struct_size = sizeof(options);
        options.weld = SC_WELD_NONE;
        options.partition = SC_PARTITION_ORDER;
        options.order = order;
        for (int k = 0; k < 2; ++k) {
            for (uint32_t i = 0; i < 3 * strip.vertex_count; ++i)
                positions[k][i] = test_random_range(0, 1);
            strip.positions = positions[k];
            mesh = input_plain_mesh(&strip);
            CHECK(sc_build(&mesh, &options, &s[k].model) == SC_OK);
            CHECK(sc_workspace_create(s[k].model, NULL, &s[k].workspace) == SC_OK);
            info[k].struct_size = sizeof(info[k]);
            CHECK(sc_model_get_info(s[k].model, &info[k]) == SC_OK);
        }
        CHECK(info[0].topology_hash == info[1].topology_hash);
        if (info[0].workspace_bytes != info[1].workspace_bytes) {
            int small = info[0].workspace_bytes < info[1].workspace_bytes ? 0 : 1;
            subject wrong;
            sc_result r;
            memset(&r, 0, sizeof(r));
            wrong.model = s[1 - small].model;
            wrong.workspace = s[small].workspace;
            CHECK_MSG(ask(&wrong, positions[0], strip.vertex_count, 0, SC_OUTPUT_COUNT, &r) ==
                          SC_ERROR_WORKSPACE,
                      "%" PRIu32 " triangles: %" PRIu64 " bytes instead of %" PRIu64, count,
                      info[small].workspace_bytes, info[1 - small].workspace_bytes);
            ++different;
        }
        for (int k = 0; k < 2; ++k) close_subject(&s[k]);
    }
    CHECK(different > 20);
}

/*
 * Multiplied by a power of two, integers answer as before, but products of their differences
 * underflow: of two, of three, or of what is small only.
 */
static void tiny_coordinates(void)
{
    uint64_t sum = 0;
    for (uint32_t round = 0; round < test_iterations(800); ++round) {
        enum { ROOM = 8000 };
        static sc_pair right[ROOM], pairs[ROOM];
        uint32_t kind = test_random_below(5);
        uint64_t state = test_random_state();
        soup mesh = kind == 0   ? soup_cloth(3 + test_random_below(3), 4)
                    : kind == 1 ? soup_on_grid(2)
                    : kind == 2 ? soup_pinched(3)
                    : kind == 3 ? soup_scattered()
                                : soup_sphere(6, 5);
        sc_build_options options;
        sc_result r;
        subject s;
        int range = 2 + (int)test_random_below(20), down = 250 + (int)test_random_below(824);
        memset(&options, 0, sizeof(options));
        options.struct_size = sizeof(options);
        options.weld = SC_WELD_NONE;
        if (open_subject(&s, &mesh, &options)) {
            soup_any_pose(mesh.positions, mesh.vertex_count);
            for (uint32_t i = 0; i < 3 * mesh.vertex_count; ++i)
                mesh.positions[i] = rint(fmod(ldexp(mesh.positions[i], range), 0x1p24));
            memset(&r, 0, sizeof(r));
            r.capacity = ROOM;
            r.pairs = right;
            CHECK(ask(&s, mesh.positions, mesh.vertex_count, SC_METHOD_AABB, 0, &r) == SC_OK);
            sum += r.count;
            for (uint32_t i = 0; i < 3 * mesh.vertex_count; ++i)
                mesh.positions[i] = ldexp(mesh.positions[i], -down);
            for (uint32_t i = 0; i < METHODS; ++i) {
                sc_result q = r;
                q.pairs = pairs;
                CHECK(ask(&s, mesh.positions, mesh.vertex_count, methods[i], 0, &q) == SC_OK);
                CHECK_MSG(
                    q.count == r.count &&
                        (r.count == 0 || memcmp(pairs, right, r.count * sizeof(sc_pair)) == 0),
                    "kind %" PRIu32 ", 2^%d to 2^-%d, method %" PRIu32 ": %" PRIu64
                    " instead of %" PRIu64 "; started at %" PRIu64,
                    kind, range, down, methods[i], q.count, r.count, state);
            }
        }
        close_subject(&s);
        soup_free(&mesh);
    }
    CHECK(sum > 300);
}

/*
 * Contours are cut where the rest shape turns. Where it is nothing like the pose, one segment may
 * go round a patch, or twice round where the pose does, with edges of both kinds.
 */
static void rest_shapes_unlike_poses(void)
{
    uint64_t sum = 0;
    for (uint32_t round = 0; round < test_iterations_at_least(60, 60); ++round) {
        enum { ROOM = 20000 };
        static sc_pair right[ROOM], pairs[ROOM];
        soup mesh = round % 3 == 0   ? soup_branched(5 + test_random_below(4), 1 + round / 3 % 4)
                    : round % 3 == 1 ? shape_spiral(20 + round, 1 + round / 3 % 2, 1.3, 0)
                                     : soup_flower(3, 2);
        double *pose = (double *)test_allocate(3 * (size_t)mesh.vertex_count * sizeof(double));
        sc_build_options options;
        sc_result r, q;
        subject s;
        memcpy(pose, mesh.positions, 3 * (size_t)mesh.vertex_count * sizeof(double));
        for (uint32_t i = 0; i < 3 * mesh.vertex_count; ++i)
            mesh.positions[i] = round % 4 == 0   ? 0 /* nothing turns */
                                : round % 4 == 1 ? i / 3 * (i % 3 == 0)
                                                 : test_random_unit();
        memset(&options, 0, sizeof(options));
        memset(&r, 0, sizeof(r));
        options.struct_size = sizeof(options);
        options.weld = SC_WELD_NONE;
        r.capacity = ROOM;
        q = r;
        r.pairs = right;
        q.pairs = pairs;
        if (open_subject(&s, &mesh, &options)) {
            CHECK(ask(&s, pose, mesh.vertex_count, SC_METHOD_AABB, 0, &r) == SC_OK);
            CHECK(ask(&s, pose, mesh.vertex_count, SC_METHOD_SCTT, 0, &q) == SC_OK);
            CHECK_MSG(q.count == r.count &&
                          (r.count == 0 || memcmp(pairs, right, r.count * sizeof(sc_pair)) == 0),
                      "round %" PRIu32 ": %" PRIu64 " instead of %" PRIu64, round, q.count,
                      r.count);
            sum += r.count;
        }
        close_subject(&s);
        soup_free(&mesh);
        free(pose);
    }
    CHECK(sum > 100);
}

/* Equal for equal triangles, welding and partition; another for another, whose workspace is
   refused. */
static void hashes_of_partitions(void)
{
    /* two halves, each of two leaves, as far as an order or sizes of leaves tell them apart */
    static const uint32_t sizes[3][4] = {{4, 5, 4, 5}, {4, 5, 4, 5}, {5, 4, 4, 5}};
    soup mesh = soup_cloth(3, 3);
    sc_build_options options;
    subject s[4];
    sc_model_info info[4];
    uint32_t order[18];
    sc_tree_node tree[7] = {{1, 2, 0, 0}, {3, 4, 0, 0}, {5, 6, 0, 0}};
    sc_result r;
    if (!CHECK(mesh.triangle_count == 18)) return;
    memset(&options, 0, sizeof(options));
    memset(&r, 0, sizeof(r));
    options.struct_size = sizeof(options);
    options.partition = SC_PARTITION_TREE;
    options.order = order;
    options.tree = tree;
    options.tree_count = 7;
    for (uint32_t k = 0; k < 4; ++k) {
        uint32_t first = 0;
        for (uint32_t i = 0; i < 18; ++i) order[i] = k == 3 ? 17 - i : i;
        for (uint32_t leaf = 0; leaf < 4; ++leaf) {
            tree[3 + leaf].left = tree[3 + leaf].right = SC_NONE;
            tree[3 + leaf].first = first;
            tree[3 + leaf].count = sizes[k % 3][leaf];
            first += sizes[k % 3][leaf];
        }
        if (!open_subject(&s[k], &mesh, &options)) return;
        info[k].struct_size = sizeof(info[k]);
        CHECK(sc_model_get_info(s[k].model, &info[k]) == SC_OK);
    }
    CHECK(info[0].topology_hash == info[1].topology_hash);
    CHECK(info[0].topology_hash != info[2].topology_hash);
    CHECK(info[0].topology_hash != info[3].topology_hash);
    for (int k = 1; k < 4; ++k) {
        subject mixed;
        mixed.model = s[0].model;
        mixed.workspace = s[k].workspace;
        CHECK(ask(&mixed, mesh.positions, mesh.vertex_count, 0, 0, &r) ==
              (k == 1 ? SC_OK : SC_ERROR_WORKSPACE));
    }
    for (int k = 0; k < 4; ++k) close_subject(&s[k]);
    soup_free(&mesh);
}

static void *allocate(void *user, uint64_t size, uint64_t alignment)
{
    (void)user;
    (void)size;
    (void)alignment;
    return NULL;
}

static void release(void *user, void *memory, uint64_t size)
{
    (void)user;
    (void)memory;
    (void)size;
}

static void missing_arguments(void)
{
    soup mesh = soup_cloth(3, 3);
    sc_mesh m = input_plain_mesh(&mesh);
    sc_build_options options;
    sc_allocator half;
    sc_model *model = NULL;
    subject s;
    uint32_t order[18];
    for (uint32_t i = 0; i < 18; ++i) order[i] = i;
    memset(&options, 0, sizeof(options));
    options.struct_size = sizeof(options);
    options.partition = SC_PARTITION_TREE;
    options.order = order;
    options.tree_count = 1;
    CHECK(mesh.triangle_count == 18 && sc_build(&m, &options, &model) == SC_ERROR_NULL);
    CHECK(model == NULL);
    if (open_subject(&s, &mesh, NULL)) {
        sc_workspace *workspace = s.workspace;
        memset(&half, 0, sizeof(half));
        half.allocate = allocate;
        CHECK(sc_workspace_create(s.model, &half, &workspace) == SC_ERROR_NULL && !workspace);
        half.release = release;
        CHECK(sc_workspace_create(s.model, &half, &workspace) == SC_ERROR_MEMORY && !workspace);
        half.allocate = NULL;
        CHECK(sc_workspace_create(s.model, &half, &workspace) == SC_ERROR_NULL && !workspace);
    }
    close_subject(&s);
    soup_free(&mesh);
}

/* Two leaves that own the same triangles, as many as there are in all; and two that do not. */
static void leaves_that_overlap(void)
{
    soup mesh = soup_cloth(4, 4);
    sc_mesh m = input_plain_mesh(&mesh);
    sc_build_options options;
    sc_model *model = NULL;
    uint32_t order[32], half = mesh.triangle_count / 2;
    sc_tree_node tree[3] = {{1, 2, 0, 0}, {SC_NONE, SC_NONE, 0, 0}, {SC_NONE, SC_NONE, 0, 0}};
    if (!CHECK(mesh.triangle_count == 32)) return;
    for (uint32_t i = 0; i < 32; ++i) order[i] = 31 - i;
    memset(&options, 0, sizeof(options));
    options.struct_size = sizeof(options);
    options.partition = SC_PARTITION_TREE;
    options.order = order;
    options.tree = tree;
    options.tree_count = 3;
    tree[1].count = tree[2].count = half;
    for (uint32_t first = 0; first <= half; ++first) {
        tree[2].first = first;
        CHECK_MSG(sc_build(&m, &options, &model) == (first < half ? SC_ERROR_TREE : SC_OK),
                  "the second leaf starts at %" PRIu32, first);
        sc_model_free(model);
    }
    soup_free(&mesh);
}

/* Folds it at some line, and again elsewhere if nothing comes to lie on anything. */
static void fold_onto_itself(const subject *s, soup *mesh)
{
    const size_t bytes = 3 * (size_t)mesh->vertex_count * sizeof(double);
    double *flat = soup_copy_positions(mesh);
    sc_result result;
    for (int tries = 0; tries < 20; ++tries) {
        memcpy(mesh->positions, flat, bytes);
        soup_fold(mesh->positions, mesh->vertex_count);
        soup_twist(mesh->positions, mesh->vertex_count, 0.1);
        memset(&result, 0, sizeof(result));
        CHECK(ask(s, mesh->positions, mesh->vertex_count, methods[0], SC_OUTPUT_ANY, &result) ==
              SC_OK);
        if (result.collides) break;
    }
    free(flat);
}

/* A flat mesh of so many leaf clusters is culled at once, and has the same pairs by all methods
   where it is twisted, and folded. */
static void check_flat_mesh(const subject *s, soup *mesh, uint32_t least_leaves,
                            uint32_t most_leaves)
{
    sc_model_info info;
    sc_stats stats;
    sc_result result[METHODS];
    memset(&info, 0, sizeof(info));
    memset(&stats, 0, sizeof(stats));
    memset(result, 0, sizeof(result));
    info.struct_size = sizeof(info);
    stats.struct_size = sizeof(stats);
    CHECK(sc_model_get_info(s->model, &info) == SC_OK);
    CHECK(info.leaf_count >= least_leaves && info.leaf_count <= most_leaves);
    for (uint32_t simd = SC_SIMD_BEST; simd <= SC_SIMD_AVX512; ++simd) {
        sc_pose pose = input_plain_pose(mesh->positions, mesh->vertex_count);
        sc_query_options options;
        memset(&options, 0, sizeof(options));
        options.struct_size = sizeof(options);
        options.simd = simd;
        result[0].struct_size = sizeof(result[0]);
        result[0].stats = &stats;
        if (sc_query(s->model, s->workspace, &pose, &options, &result[0]) != SC_OK) {
            CHECK(simd > SC_SIMD_BASE); /* the machine has none */
            continue;
        }
        CHECK(result[0].count == 0 && stats.nodes_visited == 1 && stats.nodes_culled == 1);
    }
    for (int pose = 0; pose < 2; ++pose) {
        if (pose == 1)
            fold_onto_itself(s, mesh);
        else
            soup_twist(mesh->positions, mesh->vertex_count, 0.1);
        for (int m = 0; m < METHODS; ++m) {
            memset(&result[m], 0, sizeof(result[m]));
            CHECK(ask(s, mesh->positions, mesh->vertex_count, methods[m], SC_OUTPUT_COUNT,
                      &result[m]) == SC_OK);
            CHECK(result[m].count == result[0].count && (result[m].count > 0) == (pose == 1));
        }
    }
}

/* More leaf clusters than the loop of a contour has places for (build/loops.h). */
static void contours_longer_than_loops(void)
{
    soup mesh = soup_cloth(190, 190);
    subject s;
    if (open_subject(&s, &mesh, NULL)) check_flat_mesh(&s, &mesh, 4097, 10000);
    close_subject(&s);
    soup_free(&mesh);
}

/* Halves a row of leaves of one triangle each; returns how many nodes there are. */
static uint32_t add_halves(sc_tree_node *tree, uint32_t nodes, uint32_t first, uint32_t count)
{
    uint32_t node = nodes++, half = count / 2;
    tree[node].left = tree[node].right = SC_NONE;
    tree[node].first = first;
    tree[node].count = count;
    if (count == 1) return nodes;
    tree[node].left = nodes;
    nodes = add_halves(tree, nodes, first, half);
    tree[node].right = nodes;
    return add_halves(tree, nodes, first + half, count - half);
}

/* As many as it has places for, and one fewer and more: in leaf clusters of one triangle. */
static void contours_as_long_as_loops(void)
{
    for (uint32_t less = 0; less < 3; ++less) {
        enum { LEAVES = 65536 / SC_LEAF_POINTS };
        static sc_tree_node tree[2 * LEAVES + 2];
        static uint32_t order[LEAVES + 1];
        soup mesh = soup_cloth(65, 32);
        sc_build_options options;
        subject s;
        mesh.triangle_count = LEAVES + 1 - less;
        for (uint32_t t = 0; t < mesh.triangle_count; ++t) order[t] = t;
        memset(&options, 0, sizeof(options));
        options.struct_size = sizeof(options);
        options.partition = SC_PARTITION_TREE;
        options.order = order;
        options.tree = tree;
        options.tree_count = add_halves(tree, 0, 0, mesh.triangle_count);
        if (open_subject(&s, &mesh, &options))
            check_flat_mesh(&s, &mesh, mesh.triangle_count, mesh.triangle_count);
        close_subject(&s);
        soup_free(&mesh);
    }
}

SC_TEST_MAIN(SC_TEST(any_stops_early), SC_TEST(arrays_are_left_alone), SC_TEST(largest_coordinates),
             SC_TEST(tiny_coordinates), SC_TEST(other_rest_shapes),
             SC_TEST(rest_shapes_unlike_poses), SC_TEST(hashes_of_partitions),
             SC_TEST(missing_arguments), SC_TEST(leaves_that_overlap),
             SC_TEST(contours_longer_than_loops), SC_TEST(contours_as_long_as_loops))
