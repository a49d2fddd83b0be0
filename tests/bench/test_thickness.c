/*
 * tools/thickness.h against the definition, pair by pair and path by path, on small random meshes:
 * soups with welded, repeated and degenerate triangles, and grids whose paths tie with the limit.
 * Then how values are spread, against counting.
 *
 * SPDX-License-Identifier: MIT
 */
#include "harness.h"
#include "mesh_file.h"
#include "thickness.h"

#include "starcontour.h"

#include <math.h>
#include <string.h>

enum { VERTICES = 48, TRIANGLES = 72, PAIRS = 30000 };

typedef struct scene {
    double positions[3 * VERTICES];
    uint32_t indices[3 * TRIANGLES];
    uint32_t vertices, triangles, welded[VERTICES];
    double distance;
} scene;

typedef struct found {
    sc_pair pairs[PAIRS];
    sc_near_stencil stencils[PAIRS];
    uint32_t kinds[PAIRS], count;
} found;

static found near;

/* ------------------------------------------------------------------------------------------------
 * The definition
 */

static double distance_of(const scene *s, uint32_t u, uint32_t v)
{
    double sum = 0;
    for (uint32_t i = 0; i < 3; i++) {
        const double d = s->positions[3 * u + i] - s->positions[3 * v + i];
        sum += d * d;
    }
    return sqrt(sum);
}

static uint32_t corner(const scene *s, uint32_t triangle, uint32_t k)
{
    return s->welded[s->indices[3 * triangle + k % 3]];
}

/* Shortest paths from one or two vertices: all edges are gone along until nothing changes. */
static void find_paths(const scene *s, const uint32_t *from, uint32_t count,
                       double lengths[VERTICES])
{
    for (uint32_t v = 0; v < s->vertices; v++) lengths[v] = HUGE_VAL;
    for (uint32_t i = 0; i < count; i++) lengths[from[i]] = 0;
    for (int changes = 1; changes;) {
        changes = 0;
        for (uint32_t c = 0; c < 6 * s->triangles; c++) { /* each side, both ways */
            const uint32_t t = c / 6, k = c / 2 % 3;
            const uint32_t u = corner(s, t, k + c % 2), v = corner(s, t, k + !(c % 2));
            const double length = lengths[u] + distance_of(s, u, v);
            if (!(length < lengths[v])) continue;
            lengths[v] = length;
            changes = 1;
        }
    }
}

static int is_at(const scene *s, uint32_t triangle, const uint32_t *feature, uint32_t count)
{
    for (uint32_t k = 0; k < 3; k++) {
        const uint32_t a = corner(s, triangle, k), b = corner(s, triangle, k + 1);
        if (count == 1 && a == feature[0]) return 1;
        if (count == 2 &&
            ((a == feature[0] && b == feature[1]) || (b == feature[0] && a == feature[1])))
            return 1;
    }
    return 0;
}

/* The thickness of each triangle; *joined: how many pairs do not count. */
static void define(const scene *s, double thick[TRIANGLES], uint64_t *joined)
{
    for (uint32_t t = 0; t < s->triangles; t++) thick[t] = HUGE_VAL;
    for (uint32_t i = 0; i < near.count; i++) {
        const uint32_t first = near.kinds[i] == SC_NEAR_EDGE_EDGE ? 2 : 1;
        uint32_t v[4];
        for (int k = 0; k < 4; k++) v[k] = s->welded[near.stencils[i].vertices[k]];
        double lengths[VERTICES], shortest = HUGE_VAL;
        find_paths(s, v, first, lengths);
        for (uint32_t k = first; k < 4; k++) shortest = fmin(shortest, lengths[v[k]]);
        *joined += shortest < 2 * s->distance;
        if (shortest < 2 * s->distance) continue;
        for (uint32_t t = 0; t < s->triangles; t++) {
            if (is_at(s, t, v, first) ||
                (first == 2 ? is_at(s, t, v + 2, 2) : t == near.pairs[i].b))
                thick[t] = fmin(thick[t], near.stencils[i].distance);
        }
    }
}

/* ------------------------------------------------------------------------------------------------
 * Meshes and pairs
 */

/* Random triangles on points of which some are at one place; of a grid, so that paths tie. */
static void make_soup(scene *s, int is_grid)
{
    s->vertices = 8 + test_random_below(VERTICES - 7);
    s->triangles = 4 + test_random_below(TRIANGLES - 3);
    for (uint32_t i = 0; i < 3 * s->vertices; i++)
        s->positions[i] = is_grid ? test_random_below(4) : test_random_unit();
    for (uint32_t i = 0; i < s->vertices / 8; i++) {
        const uint32_t to = test_random_below(s->vertices), from = test_random_below(s->vertices);
        for (uint32_t k = 0; k < 3; k++) s->positions[3 * to + k] = s->positions[3 * from + k];
    }
    for (uint32_t i = 0; i < 3 * s->triangles; i++) s->indices[i] = test_random_below(s->vertices);
    s->distance = is_grid ? 0.5 * (1 + test_random_below(4)) : test_random_range(0.05, 0.6);
}

/* A strip of squares, one row of vertices after the other, folded over at a random place: along it
   a path leads from each side of the fold to the other. */
static void make_fold(scene *s)
{
    const uint32_t rows = 12 + test_random_below(10), fold = 3 + test_random_below(rows - 6);
    const double gap = test_random_range(0.2, 1.5);
    s->vertices = 2 * rows;
    s->triangles = 2 * (rows - 1);
    for (uint32_t i = 0; i < rows; i++) {
        for (uint32_t j = 0; j < 2; j++) {
            double *p = &s->positions[3 * (2 * i + j)];
            p[0] = i <= fold ? i : 2.0 * fold - i + 0.25;
            p[1] = j;
            p[2] = i <= fold ? 0 : gap;
        }
    }
    for (uint32_t i = 0; i + 1 < rows; i++) {
        const uint32_t square[6] = {2 * i, 2 * i + 1, 2 * i + 2, 2 * i + 2, 2 * i + 1, 2 * i + 3};
        memcpy(&s->indices[6 * i], square, sizeof square);
    }
    s->distance = test_random_range(0.3, 3);
}

static void weld(scene *s)
{
    for (uint32_t v = 0; v < s->vertices; v++) {
        s->welded[v] = v;
        for (uint32_t u = v; u-- > 0;) {
            if (!memcmp(&s->positions[3 * u], &s->positions[3 * v], 3 * sizeof(double)))
                s->welded[v] = u;
        }
    }
}

/* Finds the pairs. False: a check failed. */
static int find_near(const scene *s)
{
    static sc_pair lists[2][PAIRS];
    sc_model *model = NULL;
    sc_workspace *workspace = NULL;
    sc_mesh mesh;
    sc_pose pose;
    sc_near_options options;
    sc_near_result result;
    sc_workspace_options how;
    memset(&mesh, 0, sizeof mesh);
    memset(&pose, 0, sizeof pose);
    memset(&options, 0, sizeof options);
    memset(&result, 0, sizeof result);
    memset(&how, 0, sizeof how);
    mesh.struct_size = sizeof mesh;
    mesh.vertex_count = s->vertices;
    mesh.triangle_count = s->triangles;
    mesh.positions = s->positions;
    mesh.position_type = SC_DOUBLE;
    mesh.indices = s->indices;
    pose.struct_size = sizeof pose;
    pose.vertex_count = s->vertices;
    pose.positions = s->positions;
    pose.position_type = SC_DOUBLE;
    options.struct_size = sizeof options;
    options.distance = s->distance;
    result.struct_size = sizeof result;
    result.vertex_faces = lists[0];
    result.edge_edges = lists[1];
    result.vertex_face_capacity = result.edge_edge_capacity = PAIRS / 2;
    how.struct_size = sizeof how;
    how.flags = SC_WORKSPACE_NEAR;
    near.count = 0;
    int done = CHECK(sc_build(&mesh, NULL, &model) == SC_OK) &&
               CHECK(sc_workspace_create_for(model, &how, &workspace) == SC_OK) &&
               CHECK(sc_query_near(model, workspace, &pose, &options, &result) == SC_OK);
    for (uint32_t kind = 0; done && kind < 2; kind++) {
        const uint32_t name = kind ? SC_NEAR_EDGE_EDGE : SC_NEAR_VERTEX_FACE;
        const uint32_t count = (uint32_t)(kind ? result.edge_edge_count : result.vertex_face_count);
        done = CHECK(sc_near_stencils(model, &pose, name, lists[kind], count,
                                      near.stencils + near.count) == SC_OK);
        for (uint32_t i = 0; i < count; i++, near.count++) {
            near.pairs[near.count] = lists[kind][i];
            near.kinds[near.count] = name;
        }
    }
    sc_workspace_free(workspace);
    sc_model_free(model);
    return done;
}

static void shuffle(void)
{
    for (uint32_t i = near.count; i > 1; i--) {
        const uint32_t j = test_random_below(i);
        const sc_pair pair = near.pairs[i - 1];
        const sc_near_stencil stencil = near.stencils[i - 1];
        const uint32_t kind = near.kinds[i - 1];
        near.pairs[i - 1] = near.pairs[j];
        near.stencils[i - 1] = near.stencils[j];
        near.kinds[i - 1] = near.kinds[j];
        near.pairs[j] = pair;
        near.stencils[j] = stencil;
        near.kinds[j] = kind;
    }
}

/* How much of what the tests are about was seen. */
typedef struct seen {
    uint64_t joined, pairs, thin, thick;
} seen;

static void add(thickness *self, uint32_t i)
{
    if (thickness_counts(self, near.kinds[i], near.pairs[i]))
        thickness_add(self, near.kinds[i], near.pairs[i], near.stencils[i].distance);
}

static void compare(const scene *s, seen *all)
{
    double expected[TRIANGLES];
    if (!find_near(s)) return;
    define(s, expected, &all->joined);
    all->pairs += near.count;
    const thickness_mesh mesh = {s->indices, s->triangles, s->vertices,
                                 s->welded,  s->positions, SC_DOUBLE};
    for (int order = 0; order < 2; order++) {
        thickness *self = thickness_new(&mesh, s->distance);
        if (!CHECK(self != NULL)) return;
        for (uint32_t i = 0; i < near.count; i++) add(self, i);
        for (uint32_t t = 0; t < s->triangles; t++) {
            const double value = thickness_of_triangles(self)[t];
            CHECK_MSG(value == expected[t], "triangle %u: %.17g in place of %.17g", (unsigned)t,
                      value, expected[t]);
            all->thin += value < HUGE_VAL;
            all->thick += value == HUGE_VAL;
        }
        thickness_free(self);
        shuffle();
    }
}

static void check_seen(const seen *all)
{
    CHECK_MSG(all->joined > 20 && all->pairs - all->joined > 20, "%lu joined of %lu",
              (unsigned long)all->joined, (unsigned long)all->pairs);
    CHECK(all->thin > 20 && all->thick > 20);
}

static void soups_are_as_defined(void)
{
    scene s;
    seen all = {0, 0, 0, 0};
    for (uint32_t i = 0; i < test_iterations_at_least(150, 20); i++) {
        make_soup(&s, 0);
        weld(&s);
        compare(&s, &all);
    }
    check_seen(&all);
}

static void grids_are_as_defined(void)
{
    scene s;
    seen all = {0, 0, 0, 0};
    for (uint32_t i = 0; i < test_iterations_at_least(150, 20); i++) {
        make_soup(&s, 1);
        weld(&s);
        compare(&s, &all);
    }
    check_seen(&all);
}

static void folds_are_as_defined(void)
{
    scene s;
    seen all = {0, 0, 0, 0};
    for (uint32_t i = 0; i < test_iterations_at_least(150, 20); i++) {
        make_fold(&s);
        weld(&s);
        compare(&s, &all);
    }
    check_seen(&all);
}

/* The same mesh by powers of two larger and smaller, beyond where squares are numbers. */
static void sizes_do_not_matter(void)
{
    static const int exponents[] = {-1000, -520, -300, 300, 520, 900};
    scene s;
    for (int i = 0; i < 6; i++) {
        make_fold(&s);
        weld(&s);
        if (!find_near(&s)) return;
        const thickness_mesh mesh = {s.indices, s.triangles, s.vertices,
                                     NULL,      s.positions, SC_DOUBLE};
        thickness *one = thickness_new(&mesh, s.distance);
        for (uint32_t k = 0; one && k < near.count; k++) add(one, k);
        for (uint32_t k = 0; k < 3 * s.vertices; k++)
            s.positions[k] = ldexp(s.positions[k], exponents[i]);
        thickness *other = thickness_new(&mesh, ldexp(s.distance, exponents[i]));
        for (uint32_t k = 0; other && k < near.count; k++) {
            near.stencils[k].distance = ldexp(near.stencils[k].distance, exponents[i]);
            add(other, k);
        }
        if (CHECK(one && other)) {
            for (uint32_t t = 0; t < s.triangles; t++) {
                CHECK(thickness_of_triangles(other)[t] ==
                      ldexp(thickness_of_triangles(one)[t], exponents[i]));
            }
        }
        thickness_free(one);
        thickness_free(other);
    }
}

static void spreads_are_counted(void)
{
    double values[300];
    thickness_spread spread;
    for (uint32_t trial = 0; trial < test_iterations_at_least(200, 20); trial++) {
        const size_t count = 1 + test_random_below(300);
        const double distance = test_random_range(0.1, 3);
        for (size_t i = 0; i < count; i++) {
            const uint32_t sixteenths = test_random_below(20);
            values[i] =
                trial % 2 ? distance * (sixteenths / 16.0) : distance * test_random_range(0, 1.2);
            if (values[i] > distance) values[i] = HUGE_VAL;
        }
        if (!CHECK(thickness_find_spread(values, count, distance, &spread))) return;
        CHECK(spread.limits[0] == 0 && spread.limits[THICKNESS_BINS] == distance);
        for (int bin = 0; bin < THICKNESS_BINS; bin++) {
            uint64_t inside = 0;
            for (size_t i = 0; i < count; i++) {
                inside += values[i] >= spread.limits[bin] && values[i] < HUGE_VAL &&
                          (values[i] < spread.limits[bin + 1] || bin == THICKNESS_BINS - 1);
            }
            CHECK(inside == spread.counts[bin]);
        }
        uint64_t more = 0;
        for (size_t i = 0; i < count; i++) more += values[i] == HUGE_VAL;
        CHECK(more == spread.more);
        for (int k = 0; k < THICKNESS_PERCENTILES; k++) {
            const double value = spread.percentiles[k];
            uint64_t below = 0, up_to = 0;
            for (size_t i = 0; i < count; i++) {
                below += values[i] < value;
                up_to += values[i] <= value;
            }
            CHECK(100 * up_to >= count * thickness_percents[k]);
            CHECK(100 * below < count * thickness_percents[k]);
        }
    }
}

SC_TEST_MAIN(SC_TEST(soups_are_as_defined), SC_TEST(grids_are_as_defined),
             SC_TEST(folds_are_as_defined), SC_TEST(sizes_do_not_matter),
             SC_TEST(spreads_are_counted))
