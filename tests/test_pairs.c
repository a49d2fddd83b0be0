/*
 * The heart of the promise: on every mesh, pose, type, stride, welding, partition and method,
 * sc_query reports the pairs that the oracle reports, sorted, each once, in all four kinds.
 *
 * SPDX-License-Identifier: MIT
 */
#include <float.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "harness.h"
#include "inputs.h"
#include "oracle.h"
#include "pair_trial.h"
#include "shapes.h"
#include "soups.h"
#include "starcontour.h"

/* A soup whose pose is another soup's points: far from rest. */
static double *other_positions(const soup *s, uint32_t range)
{
    double *pose = (double *)test_allocate(3 * (size_t)s->vertex_count * sizeof(double));
    for (size_t i = 0; i < 3 * (size_t)s->vertex_count; ++i)
        pose[i] = range == 0 ? test_random_unit() : test_random_below(range + 1);
    return pose;
}

static void small_soups_on_a_grid(void)
{
    uint32_t rounds = test_iterations(2000);
    for (uint32_t i = 0; i < rounds; ++i) {
        static const uint32_t ranges[] = {1, 2, 2, 4, 4, 9};
        uint64_t state = test_random_state();
        uint32_t range = ranges[test_random_below(6)];
        soup s = soup_on_grid(range);
        double *pose = other_positions(&s, range);
        trial_check_random_build("grid soup", state, &s, pose);
        free(pose);
        soup_free(&s);
    }
}

/* Two leaf clusters in which all triangles are the same, which share one point or two. */
static void copies_of_two_triangles(void)
{
    for (uint32_t shared = 1; shared <= 2; ++shared) {
        soup s = shape_copies(shared);
        double *pose = other_positions(&s, 3);
        trial_check("copies", 0, &s, pose, SC_WELD_REST, SC_PARTITION_FAST);
        for (uint32_t i = 0; i < 3 * s.vertex_count; ++i) pose[i] = i % 3 == 2 ? 0 : pose[i];
        trial_check("flat copies", 0, &s, pose, SC_WELD_REST, SC_PARTITION_FAST);
        free(pose);
        soup_free(&s);
    }
}

static void scattered_soups(void)
{
    uint32_t rounds = test_iterations(300);
    for (uint32_t i = 0; i < rounds; ++i) {
        uint64_t state = test_random_state();
        soup s = soup_scattered();
        double *pose = other_positions(&s, i % 2 == 0 ? 0 : 3);
        trial_check_random_build("scattered soup", state, &s, pose);
        free(pose);
        soup_free(&s);
    }
}

/*
 * The ends of the range of float and double: products overflow and underflow, sums lose all but one
 * bit, but the answer is that of exact arithmetic.
 */
static void extreme_coordinates(void)
{
    static const double factors[] = {
        1e-30, 1e30, 1e-150, 1e150, 1e-300, 1e300, 4.94065645841e-324, 1e-310, 1.4012984643e-45,
        1e-40, 3e37, 4e306};
    uint32_t rounds = test_iterations(200);
    for (uint32_t i = 0; i < rounds; ++i) {
        uint64_t state = test_random_state();
        soup s = i % 2 == 0 ? soup_on_grid(4) : soup_scattered();
        double *pose, factor = factors[test_random_below(12)];
        uint32_t kind = test_random_below(5);
        /* Positions that float cannot hold would become infinite. */
        double limit = factor > 1e38 ? DBL_MAX / 40 : (double)FLT_MAX / 40;
        if (kind == 1 && factor < 1e30) soup_move(s.positions, s.vertex_count, 0x1p20);
        if (kind == 2) soup_nudge(s.positions, s.vertex_count);
        soup_scale(s.positions, s.vertex_count, factor);
        if (kind == 3) soup_move(s.positions, s.vertex_count, 1 / 3.0 * factor);
        pose = other_positions(&s, i % 3 == 0 ? 0 : 2);
        soup_scale(pose, s.vertex_count, factor);
        if (kind == 4) { /* exponents from one end to the other in one mesh */
            for (size_t c = 0; c < 3 * (size_t)s.vertex_count; ++c) {
                double x = ldexp(pose[c] / factor, (int)test_random_below(200) - 100);
                pose[c] = x > limit ? limit : x;
            }
        }
        if (kind == 2) soup_nudge(pose, s.vertex_count);
        if (factor > 1e38) { /* too large for float */
            input_choices none = input_choose(&s, SC_WELD_REST, SC_PARTITION_FAST);
            uint32_t *map = input_weld_of(&none, &s);
            sc_mesh mesh = input_plain_mesh(&s);
            sc_pose input = input_plain_pose(pose, s.vertex_count);
            sc_model *model = NULL;
            sc_workspace *workspace = NULL;
            if (CHECK(sc_build(&mesh, NULL, &model) == SC_OK) &&
                CHECK(sc_workspace_create(model, NULL, &workspace) == SC_OK)) {
                oracle_answer answer;
                trial t = {"huge soup", &s, pose, state, model, workspace, &input, "fast", 0, NULL};
                oracle_solve(pose, s.vertex_count, s.triangles, s.triangle_count, map, &answer);
                t.answer = &answer;
                trial_check_pose(&t);
                oracle_free(&answer);
            }
            sc_workspace_free(workspace);
            sc_model_free(model);
            free(map);
            input_free_choices(&none);
        } else {
            trial_check_random_build("extreme soup", state, &s, pose);
        }
        free(pose);
        soup_free(&s);
    }
}

/* Points in a plane that is oblique and not quite one: every orientation is a matter of
   rounding. */
static void nearly_coplanar(void)
{
    uint32_t rounds = test_iterations(200);
    for (uint32_t i = 0; i < rounds; ++i) {
        uint64_t state = test_random_state();
        soup s = soup_on_grid(3);
        double *pose = (double *)test_allocate(3 * (size_t)s.vertex_count * sizeof(double));
        double u = test_random_unit(), v = test_random_unit();
        for (uint32_t k = 0; k < s.vertex_count; ++k) {
            double *p = pose + 3 * (size_t)k;
            p[0] = s.positions[3 * k] / 3 + 0.1;
            p[1] = s.positions[3 * k + 1] / 7 + 0.1;
            p[2] = u * p[0] + v * p[1];
        }
        if (i % 2 == 0) soup_nudge(pose, s.vertex_count);
        trial_check_random_build("nearly coplanar soup", state, &s, pose);
        free(pose);
        soup_free(&s);
    }
}

/* Pairs of triangles, each with points of its own; those of pair k begin at coordinate 18 k. */
static soup soup_of_pairs(uint32_t pairs)
{
    soup s = soup_make(6 * pairs, 2 * pairs);
    for (uint32_t k = 0; k < 3 * s.vertex_count; ++k) s.positions[k] = test_random_unit();
    for (uint32_t k = 0; k < 3 * s.triangle_count; ++k) s.triangles[k] = k;
    return s;
}

/* Moves the second end of an edge of the second triangle of a pair so that this edge comes as close
   as `off` to an edge of the first. Tells the ends of both. */
static void cross_edges(double *pair, double off, double *end[4])
{
    double along = test_random_range(0.1, 0.9), there = test_random_range(0.1, 0.9);
    uint32_t first = test_random_below(3), turn = test_random_below(3);
    end[0] = pair + 3 * first;
    end[1] = pair + 3 * ((first + 1) % 3);
    end[2] = pair + 9 + 3 * turn;
    end[3] = pair + 9 + 3 * ((turn + 1) % 3);
    for (uint32_t c = 0; c < 3; ++c) {
        double x = end[0][c] + along * (end[1][c] - end[0][c]) + off * test_random_range(-1, 1);
        end[3][c] = end[2][c] + (x - end[2][c]) / there;
    }
}

/* Pairs of triangles that cross each other's planes, of which an edge of one passes one of the
   other ever more closely. */
static void edges_that_nearly_meet(void)
{
    uint32_t rounds = test_iterations(150);
    for (uint32_t i = 0; i < rounds; ++i) {
        uint64_t state = test_random_state();
        uint32_t pairs = 1 + test_random_below(16);
        soup s = soup_of_pairs(pairs);
        for (uint32_t k = 0; k < pairs; ++k) {
            double *end[4];
            cross_edges(s.positions + 18 * k, exp2(-(double)test_random_below(60)), end);
        }
        trial_check_random_build("edges that nearly meet", state, &s, s.positions);
        soup_free(&s);
    }
}

/* Pairs of triangles of which an edge of one and an edge of the other cross in a plane across an
   axis; or, of one pair in three, nearly so, by less than single precision tells. */
static void edges_that_meet_across_an_axis(void)
{
    uint32_t rounds = test_iterations(150);
    for (uint32_t i = 0; i < rounds; ++i) {
        uint64_t state = test_random_state();
        uint32_t pairs = 4 + test_random_below(13);
        soup s = soup_of_pairs(pairs);
        for (uint32_t k = 0; k < pairs; ++k) {
            double *end[4];
            uint32_t axis = test_random_below(3);
            cross_edges(s.positions + 18 * k, 0, end);
            for (uint32_t e = 1; e < 4; ++e) end[e][axis] = end[0][axis];
            if (test_random_below(3) == 0)
                end[test_random_below(4)][axis] *= 1 + exp2(-30.0 - test_random_below(22));
        }
        trial_check_random_build("edges that meet across an axis", state, &s, s.positions);
        soup_free(&s);
    }
}

/* Pairs of triangles that share a point, and from there lie on one ray: the shorter edge ends on
   the longer one. What leads from the middle of one to that of the other is across the ray, but for
   rounding, and tells the rest of them apart. */
static void neighbors_on_a_ray(void)
{
    uint32_t rounds = test_iterations(60);
    for (uint32_t i = 0; i < rounds; ++i) {
        uint64_t state = test_random_state();
        uint32_t pairs = 1 + test_random_below(12);
        soup s = soup_make(5 * pairs, 2 * pairs);
        for (uint32_t k = 0; k < pairs; ++k) {
            double *p = s.positions + 15 * k, ray[3], other[3], across[3], more[3];
            uint32_t *t = s.triangles + 6 * k;
            for (uint32_t c = 0; c < 3; ++c) { /* whole numbers: the middle of the ray is exact */
                p[c] = floor(test_random_range(-1e9, 1e9));
                ray[c] = 2 * floor(test_random_range(-1e6, 1e6));
                other[c] = test_random_unit();
                more[c] = test_random_range(-3e5, 3e5);
            }
            for (uint32_t c = 0; c < 3; ++c)
                across[c] =
                    ray[(c + 1) % 3] * other[(c + 2) % 3] - ray[(c + 2) % 3] * other[(c + 1) % 3];
            for (uint32_t c = 0; c < 3; ++c) {
                p[3 + c] = p[c] + ray[c];
                p[6 + c] = p[c] + ray[c] / 2;
                p[9 + c] = p[c] + floor(across[c] / 2 + more[c]);
                p[12 + c] = p[9 + c] + ray[c] / 2 - floor(across[c]);
            }
            for (uint32_t c = 0; c < 6; ++c)
                t[c] = 5 * k + (c == 0 || c == 3 ? 0 : c == 1 ? 1 : c == 2 ? 3 : c == 4 ? 2 : 4);
        }
        trial_check_random_build("neighbors on a ray", state, &s, s.positions);
        soup_free(&s);
    }
}

static void deformed_meshes(void)
{
    uint32_t rounds = test_iterations(140);
    for (uint32_t i = 0; i < rounds; ++i) {
        uint64_t state = test_random_state();
        const char *name = NULL;
        soup s = soup_any_mesh(i % 4 == 0 ? 300 : 120, &name);
        double *pose = (double *)test_allocate(3 * (size_t)s.vertex_count * sizeof(double));
        memcpy(pose, s.positions, 3 * (size_t)s.vertex_count * sizeof(double));
        soup_any_pose(pose, s.vertex_count);
        if (test_random_below(6) == 0)
            soup_any_pose(s.positions, s.vertex_count); /* the rest too */
        trial_check_random_build(name, state, &s, pose);
        free(pose);
        soup_free(&s);
    }
}

/*
 * Sheets in which all normals agree and only the contour tells that they lie on themselves:
 * spirals, and petals around a shared vertex; flat, or with just enough height to cross.
 */
static void what_only_contours_tell(void)
{
    uint32_t rounds = test_iterations(80);
    for (uint32_t i = 0; i < rounds; ++i) {
        uint64_t state = test_random_state();
        uint32_t across = 1 + test_random_below(5);
        soup s = i % 3 == 0
                     ? soup_spiral(10 + test_random_below(50), across, test_random_range(0.7, 2.2))
                 : i % 3 == 1 ? soup_flower(1 + test_random_below(4), across)
                              : soup_moebius(12 + test_random_below(30), across);
        double *pose = (double *)test_allocate(3 * (size_t)s.vertex_count * sizeof(double));
        uint32_t heights = test_random_below(3);
        if (i % 3 == 2) { /* cut open: no longer one-sided, but overlapping when crushed */
            s.triangle_count -= 2 * across;
            for (uint32_t v = 0; v < s.vertex_count; ++v) s.positions[3 * v + 2] = 0;
        }
        memcpy(pose, s.positions, 3 * (size_t)s.vertex_count * sizeof(double));
        for (uint32_t v = 0; v < s.vertex_count && heights != 0; ++v)
            pose[3 * v + 2] +=
                heights == 1 ? test_random_range(0, 0.01) : 0.05 * sin(9 * pose[3 * v]);
        if (test_random_below(3) == 0) soup_smooth(pose, s.vertex_count, 0.1);
        if (test_random_below(3) == 0) /* turned: other projections */
            for (uint32_t v = 0; v < s.vertex_count; ++v) {
                double x = pose[3 * v], z = pose[3 * v + 2];
                pose[3 * v] = 0.8 * x - 0.6 * z;
                pose[3 * v + 2] = 0.6 * x + 0.8 * z;
            }
        trial_check_random_build("contour", state, &s, pose);
        free(pose);
        soup_free(&s);
    }
}

/*
 * Discs that go twice around their centre, all normals up: the contour of an inner disc, and of two
 * sectors that lie on each other, in partitions that leave them one neighbor, so that a contour
 * segment is as long and as winding as can be.
 */
static void branched_discs(void)
{
    uint32_t rounds = test_iterations(80);
    for (uint32_t i = 0; i < rounds; ++i) {
        uint64_t state = test_random_state();
        uint32_t around = 6 + 2 * test_random_below(8), rings = 1 + test_random_below(4);
        soup s = soup_branched(around, rings);
        double *pose = (double *)test_allocate(3 * (size_t)s.vertex_count * sizeof(double));
        uint32_t *order = (uint32_t *)test_allocate(s.triangle_count * sizeof(uint32_t));
        uint32_t count = s.triangle_count, a = 0, b = 0, place = 0;
        sc_tree_node tree[5];
        input_choices choices;
        memset(&choices, 0, sizeof(choices));
        choices.options.struct_size = sizeof(choices.options);
        choices.options.weld = SC_WELD_NONE;
        choices.options.partition = SC_PARTITION_TREE;
        choices.options.order = order;
        choices.options.tree = tree;
        choices.partition_name = "own tree";
        if (i % 2 == 0) { /* an inner disc and the rings around it */
            a = around + 2 * around * test_random_below(rings);
            for (uint32_t t = 0; t < count; ++t) order[t] = t;
            tree[0].left = 1;
            tree[0].right = 2;
            tree[1].first = 0;
            tree[1].count = a;
            tree[2].first = a;
            tree[2].count = count - a;
            choices.options.tree_count = 3;
            for (int n = 1; n < 3; ++n) tree[n].left = tree[n].right = SC_NONE;
            if (a == count) { /* nothing around it */
                tree[0] = tree[1];
                choices.options.tree_count = 1;
            }
        } else { /* two sectors opposite in angle, which lie on each other, and the rest */
            uint32_t first = test_random_below(around / 2);
            uint32_t width = 1 + test_random_below(around / 2 - first);
            for (uint32_t part = 0; part < 3; ++part) {
                for (uint32_t t = 0; t < count; ++t) {
                    uint32_t sector = t < around ? t : (t - around) / 2 % around;
                    uint32_t half = sector / (around / 2), within = sector % (around / 2);
                    uint32_t mine = within >= first && within < first + width ? half : 2;
                    if (mine == part) order[place++] = t;
                }
                if (part == 0) a = place;
                if (part == 1) b = place;
            }
            tree[0].left = 1;
            tree[0].right = 2;
            tree[1].left = 3;
            tree[1].right = 4;
            tree[3].first = 0;
            tree[3].count = a;
            tree[4].first = a;
            tree[4].count = b - a;
            tree[2].first = b;
            tree[2].count = count - b;
            choices.options.tree_count = 5;
            for (int n = 2; n < 5; ++n) tree[n].left = tree[n].right = SC_NONE;
            if (b == count) {
                tree[0] = tree[1];
                tree[1] = tree[3];
                tree[2] = tree[4];
                tree[0].left = 1;
                tree[0].right = 2;
                choices.options.tree_count = 3;
            }
        }
        memcpy(pose, s.positions, 3 * (size_t)s.vertex_count * sizeof(double));
        for (uint32_t v = 0; v < s.vertex_count; ++v)
            pose[3 * v + 2] = i % 4 < 2 ? test_random_range(0, 0.01) : 0.02 * pose[3 * v];
        trial_check_chosen("branched disc", state, &s, pose, SC_WELD_NONE, SC_PARTITION_TREE,
                           &choices);
        free(order);
        free(pose);
        soup_free(&s);
    }
}

/* Larger meshes with many pairs, each with every partition; all partitions report the same. */
static void every_partition(void)
{
    for (uint32_t shape = 0; shape < 4; ++shape) {
        soup s = shape == 0   ? soup_cloth(16, 40)
                 : shape == 1 ? soup_sphere(24, 20)
                 : shape == 2 ? soup_tube(16, 40)
                              : soup_moebius(60, 8);
        double *pose = (double *)test_allocate(3 * (size_t)s.vertex_count * sizeof(double));
        uint64_t state = test_random_state();
        memcpy(pose, s.positions, 3 * (size_t)s.vertex_count * sizeof(double));
        if (shape == 0) soup_twist(pose, s.vertex_count, 2.2);
        if (shape == 1) soup_smooth(pose, s.vertex_count, 0.6);
        if (shape >= 2) soup_fold(pose, s.vertex_count);
        soup_smooth(pose, s.vertex_count, 0.03);
        for (uint32_t partition = 0; partition < 4; ++partition)
            trial_check("large mesh", state, &s, pose, SC_WELD_REST, partition);
        free(pose);
        soup_free(&s);
    }
}

static void twist_back(const soup *s, double *pose, uint32_t frame, uint32_t frames)
{
    soup_twist(pose, s->vertex_count, 3.0 * (frames - frame) / frames);
}

static void one_workspace_many_poses(void)
{
    soup s = soup_cloth(8, 24);
    trial_check_motion("motion", &s, test_iterations(24), twist_back);
    soup_free(&s);
}

/* Every capacity from none to one more than needed. */
static void short_buffers(void)
{
    uint32_t rounds = test_iterations(40);
    for (uint32_t i = 0; i < rounds; ++i) {
        uint64_t state = test_random_state();
        const char *name = "grid soup";
        soup s = i % 4 == 0 ? soup_any_mesh(60, &name) : soup_on_grid(2);
        sc_mesh mesh = input_plain_mesh(&s);
        sc_pose pose;
        sc_model *model = NULL;
        sc_workspace *workspace = NULL;
        if (CHECK(sc_build(&mesh, NULL, &model) == SC_OK) &&
            CHECK(sc_workspace_create(model, NULL, &workspace) == SC_OK)) {
            oracle_answer answer;
            trial t = {name, &s, s.positions, state, model, workspace, &pose, "fast", 0, NULL};
            uint32_t *map = (uint32_t *)test_allocate(s.vertex_count * sizeof(uint32_t));
            oracle_weld(s.positions, s.vertex_count, s.triangles, s.triangle_count, map);
            if (i % 4 == 0) soup_fold(s.positions, s.vertex_count);
            pose = input_plain_pose(s.positions, s.vertex_count);
            oracle_solve(s.positions, s.vertex_count, s.triangles, s.triangle_count, map, &answer);
            t.answer = &answer;
            for (uint32_t kind = 0; kind < 4; ++kind) {
                uint64_t count = answer.lists[kind / 2][kind % 2].count;
                for (uint64_t capacity = 0; capacity <= count + 1; ++capacity)
                    trial_check_pairs(&t, &trial_ways[capacity % TRIAL_WAYS], kind / 2, kind % 2,
                                      capacity);
            }
            free(map);
            oracle_free(&answer);
        }
        sc_workspace_free(workspace);
        sc_model_free(model);
        soup_free(&s);
    }
}

/* A vertex that no triangle uses may be anything. */
static void unused_vertices(void)
{
    double rest[8 * 3] = {0, 0, 0, 4, 0, 0, 0, 4, 0, 0, 0, 0, 1, 1, -1, 1, 1, 1, 9, 9, 1, 0, 0, 0};
    uint32_t triangles[6] = {0, 1, 2, 4, 5, 6};
    double nothings[3];
    nothings[0] = (double)NAN;
    nothings[1] = HUGE_VAL;
    nothings[2] = -HUGE_VAL;
    for (int i = 0; i < 27; ++i) {
        soup s;
        sc_mesh mesh;
        sc_pose pose;
        sc_model *model = NULL;
        sc_workspace *workspace = NULL;
        oracle_answer answer;
        s.vertex_count = 8;
        s.triangle_count = 2;
        s.positions = rest;
        s.triangles = triangles;
        for (int k = 0; k < 2; ++k) {
            rest[3 * (3 + 4 * k)] = nothings[i % 3];
            rest[3 * (3 + 4 * k) + 1] = nothings[i / 3 % 3];
            rest[3 * (3 + 4 * k) + 2] = nothings[i / 9];
        }
        mesh = input_plain_mesh(&s);
        pose = input_plain_pose(rest, 8);
        oracle_solve(rest, 8, triangles, 2, NULL, &answer);
        CHECK(answer.lists[0][0].count == 1);
        if (CHECK(sc_build(&mesh, NULL, &model) == SC_OK) &&
            CHECK(sc_workspace_create(model, NULL, &workspace) == SC_OK)) {
            trial t = {"unused vertices", &s, rest, 0, model, workspace, &pose, "fast", 0, NULL};
            t.answer = &answer;
            trial_check_pose(&t);
        }
        sc_workspace_free(workspace);
        sc_model_free(model);
        oracle_free(&answer);
    }
}

/* The mesh folder, against the oracle and against the counts that its maker knows. */
static void meshes_of_the_folder(void)
{
    const char *folder = getenv("SC_MESHES") != NULL ? getenv("SC_MESHES") : "meshes";
    char path[512], line[512], name[256];
    uint32_t found = 0;
    FILE *file;
    snprintf(path, sizeof(path), "%s/expected.csv", folder);
    file = fopen(path, "r");
    if (!CHECK_MSG(file != NULL, "cannot read %s", path)) return;
    while (fgets(line, sizeof(line), file) != NULL) {
        unsigned vertices, triangles, counts[4];
        soup s;
        uint32_t *map;
        oracle_answer answer;
        size_t length;
        if (sscanf(line, "%255[^,],%u,%u,%u,%u,%u,%u", name, &vertices, &triangles, &counts[0],
                   &counts[1], &counts[2], &counts[3]) != 7)
            continue; /* the head line, a comment */
        length = strlen(name);
        snprintf(path, sizeof(path), "%s/%s%s", folder, name,
                 length > 4 && strcmp(name + length - 4, ".obj") == 0 ? "" : ".obj");
        if (!CHECK_MSG(input_read_obj(path, &s), "cannot read %s", path)) continue;
        ++found;
        CHECK_MSG(s.vertex_count == vertices && s.triangle_count == triangles,
                  "%s: %" PRIu32 " vertices, %" PRIu32 " triangles", name, s.vertex_count,
                  s.triangle_count);
        map = (uint32_t *)test_allocate(s.vertex_count * sizeof(uint32_t));
        oracle_weld(s.positions, s.vertex_count, s.triangles, s.triangle_count, map);
        oracle_solve(s.positions, s.vertex_count, s.triangles, s.triangle_count, map, &answer);
        for (int k = 0; k < 4; ++k) /* touching triangle, touching edge, proper triangle, edge */
            CHECK_MSG(answer.lists[k % 2][k / 2].count == counts[k],
                      "%s: the oracle finds %" PRIu64 ", expected.csv has %u in column %d", name,
                      answer.lists[k % 2][k / 2].count, counts[k], k + 4);
        trial_check(name, 0, &s, s.positions, SC_WELD_REST, test_random_below(4));
        oracle_free(&answer);
        free(map);
        soup_free(&s);
    }
    fclose(file);
    CHECK_MSG(found >= 1, "no mesh in %s", folder);
}

SC_TEST_MAIN(SC_TEST(small_soups_on_a_grid), SC_TEST(copies_of_two_triangles),
             SC_TEST(scattered_soups), SC_TEST(extreme_coordinates), SC_TEST(nearly_coplanar),
             SC_TEST(edges_that_nearly_meet), SC_TEST(edges_that_meet_across_an_axis),
             SC_TEST(neighbors_on_a_ray), SC_TEST(deformed_meshes),
             SC_TEST(what_only_contours_tell), SC_TEST(branched_discs), SC_TEST(every_partition),
             SC_TEST(one_workspace_many_poses), SC_TEST(short_buffers), SC_TEST(unused_vertices),
             SC_TEST(meshes_of_the_folder))
