/*
 * Gradients of contours' lengths: against central differences of lengths computed with 384 bits;
 * that they neither push nor turn what they are the gradient of; where there is no derivative; and
 * arguments that cannot be.
 *
 * SPDX-License-Identifier: MIT
 */
#include <gmp.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "adversaries.h"
#include "harness.h"
#include "inputs.h"
#include "soups.h"
#include "starcontour.h"

enum { BITS = 384, STEP = 100 }; /* of numbers; differences are over 2^-STEP of the scene's size */

/* ---- scenes ---- */

/* A mesh in a pose, what the library says of it, and the gradients. */
typedef struct scene {
    uint32_t vertex_count, triangle_count;
    uint32_t *triangles;     /* after welding */
    const double *positions; /* 3 a vertex */
    sc_pose pose;
    sc_model *model;
    sc_trace_result traced;
    sc_trace_gradient *gradients;
} scene;

static int trace_pose(const sc_model *model, const sc_pose *pose, sc_trace_result *traced)
{
    sc_query_options options = input_query(SC_PAIRS_EDGE, SC_CONTACT_TOUCHING, SC_METHOD_DEFAULT);
    sc_workspace *workspace = NULL;
    sc_result r;
    int is_right = 0;
    memset(&r, 0, sizeof r);
    memset(traced, 0, sizeof *traced);
    r.struct_size = sizeof r;
    traced->struct_size = sizeof *traced;
    if (!CHECK(sc_workspace_create(model, NULL, &workspace) == SC_OK)) return 0;
    sc_query(model, workspace, pose, &options, &r);
    r.pairs = (sc_pair *)test_allocate((size_t)r.count * sizeof *r.pairs);
    r.capacity = r.count;
    if (CHECK(sc_query(model, workspace, pose, &options, &r) == SC_OK)) {
        sc_trace(model, pose, r.pairs, r.count, NULL, traced);
        traced->node_capacity = traced->node_count;
        traced->contour_capacity = traced->contour_count;
        traced->nodes =
            (sc_trace_node *)test_allocate((size_t)traced->node_count * sizeof *traced->nodes);
        traced->contours = (sc_trace_contour *)test_allocate((size_t)traced->contour_count *
                                                             sizeof *traced->contours);
        is_right = CHECK(sc_trace(model, pose, r.pairs, r.count, NULL, traced) == SC_OK);
    }
    free(r.pairs);
    sc_workspace_free(workspace);
    return is_right;
}

/* Of a mesh, its vertices welded in some way, in a pose that has one position for welded ones. */
static int open_scene(scene *s, const soup *mesh, double *pose, uint32_t weld)
{
    input_choices choices = input_choose(mesh, weld, SC_PARTITION_FAST);
    const sc_mesh m = input_plain_mesh(mesh);
    uint32_t *map = input_weld_of(&choices, mesh);
    int is_right = 0;
    memset(s, 0, sizeof *s);
    s->vertex_count = mesh->vertex_count;
    s->triangle_count = mesh->triangle_count;
    s->positions = pose;
    s->pose = input_plain_pose(pose, mesh->vertex_count);
    s->triangles = (uint32_t *)test_allocate(3 * (size_t)s->triangle_count * sizeof(uint32_t));
    for (uint32_t i = 0; i < 3 * s->triangle_count; ++i) s->triangles[i] = map[mesh->triangles[i]];
    if (CHECK(sc_build(&m, &choices.options, &s->model) == SC_OK) &&
        trace_pose(s->model, &s->pose, &s->traced)) {
        const size_t bytes = (size_t)s->traced.node_count * sizeof *s->gradients;
        s->gradients = (sc_trace_gradient *)test_allocate(bytes);
        memset(s->gradients, 255, bytes);
        is_right = CHECK(sc_trace_gradients(s->model, &s->pose, &s->traced, s->gradients) == SC_OK);
    }
    free(map);
    input_free_choices(&choices);
    return is_right;
}

static void close_scene(scene *s)
{
    free(s->gradients);
    free(s->traced.nodes);
    free(s->traced.contours);
    free(s->triangles);
    sc_model_free(s->model);
}

static soup crossing_cloths(uint32_t across)
{
    soup one = soup_cloth(across, across), two = soup_cloth(across, across), both;
    soup_smooth(one.positions, one.vertex_count, 0.1);
    soup_smooth(two.positions, two.vertex_count, 0.1);
    soup_noise(one.positions, one.vertex_count, 0.3 / across);
    soup_noise(two.positions, two.vertex_count, 0.3 / across);
    both = soup_join(&one, &two);
    soup_free(&one);
    soup_free(&two);
    return both;
}

/* The five vertices of a node; of one at a vertex, that five times. */
static void name_vertices(const scene *s, const sc_trace_node *node, uint32_t v[5])
{
    for (uint32_t i = 0; i < 5; ++i) v[i] = node->triangle;
    if (node->edge == SC_TRACE_NO_EDGE) return;
    v[0] = s->triangles[node->edge];
    v[1] = s->triangles[node->edge / 3 * 3 + (node->edge % 3 + 1) % 3];
    for (uint32_t i = 0; i < 3; ++i) v[2 + i] = s->triangles[3 * node->triangle + i];
}

static const double *position(const scene *s, uint32_t v)
{
    return s->positions + 3 * (size_t)v;
}

static const sc_trace_node *neighbor(const scene *s, const sc_trace_contour *c, uint64_t k, int by)
{
    const sc_trace_node *node = s->traced.nodes + c->first;
    if (by < 0 && k == 0) return c->begin == SC_TRACE_CLOSED ? &node[c->count - 1] : NULL;
    if (by > 0 && k + 1 == c->count) return c->begin == SC_TRACE_CLOSED ? &node[0] : NULL;
    return &node[(int64_t)k + by];
}

/* ---- what the error may be ---- */

static void cross(const double a[3], const double b[3], double n[3])
{
    for (int i = 0; i < 3; ++i)
        n[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
}

static double norm(const double a[3])
{
    return sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
}

static double largest_of(const scene *s, const sc_trace_node *node, double largest)
{
    uint32_t v[5];
    name_vertices(s, node, v);
    for (int i = 0; i < 15; ++i) largest = fmax(largest, fabs(position(s, v[i / 3])[i % 3]));
    return largest;
}

/* By how much each component of a node's vectors may be off, as starcontour.h says. */
static double error_of(const scene *s, const sc_trace_contour *c, uint64_t k)
{
    const sc_trace_node *node = &s->traced.nodes[c->first + k];
    double largest = largest_of(s, node, 0), shorter = (double)INFINITY, a = 1, b = 1;
    for (int by = -1; by < 2; by += 2) {
        const sc_trace_node *other = neighbor(s, c, k, by);
        double v[3];
        if (!other) continue;
        largest = largest_of(s, other, largest);
        for (int i = 0; i < 3; ++i) v[i] = other->point[i] - node->point[i];
        shorter = fmin(shorter, norm(v));
    }
    if (node->edge != SC_TRACE_NO_EDGE) {
        uint32_t v[5];
        double d[3], side[2][3], n[3];
        name_vertices(s, node, v);
        for (int i = 0; i < 3; ++i) {
            d[i] = position(s, v[1])[i] - position(s, v[0])[i];
            side[0][i] = position(s, v[3])[i] - position(s, v[2])[i];
            side[1][i] = position(s, v[4])[i] - position(s, v[2])[i];
        }
        cross(side[0], side[1], n);
        a = fabs(n[0] * d[0] + n[1] * d[1] + n[2] * d[2]) / (norm(n) * norm(d));
        b = norm(n) / (norm(side[0]) * norm(side[1]));
    }
    return 0x1p-45 * (largest / shorter + 1 / (a * b)) / a;
}

/* ---- lengths ---- */

static mpf_t here[5][3], last[3], begin[3], normal[3], by[3], sum, product, way;

static void init_numbers(void)
{
    mpf_set_default_prec(BITS);
    for (int i = 0; i < 3; ++i) {
        for (int k = 0; k < 5; ++k) mpf_init(here[k][i]);
        mpf_inits(last[i], begin[i], normal[i], by[i], NULL);
    }
    mpf_inits(sum, product, way, NULL);
}

static void clear_numbers(void)
{
    for (int i = 0; i < 3; ++i) {
        for (int k = 0; k < 5; ++k) mpf_clear(here[k][i]);
        mpf_clears(last[i], begin[i], normal[i], by[i], NULL);
    }
    mpf_clears(sum, product, way, NULL);
}

/* result = normal . (to - from) */
static void measure_height(mpf_t result, mpf_t *from, mpf_t *to)
{
    mpf_set_ui(sum, 0);
    for (int i = 0; i < 3; ++i) {
        mpf_sub(product, to[i], from[i]);
        mpf_mul(product, product, normal[i]);
        mpf_add(sum, sum, product);
    }
    mpf_set(result, sum);
}

/* Where a node is, if coordinate c of vertex moved is moved by `step`: in here[0]. */
static void place_node(const scene *s, const sc_trace_node *node, uint32_t moved, int c,
                       const mpf_t step)
{
    uint32_t v[5];
    name_vertices(s, node, v);
    for (int k = 0; k < 5; ++k) {
        for (int i = 0; i < 3; ++i) mpf_set_d(here[k][i], position(s, v[k])[i]);
        if (v[k] == moved) mpf_add(here[k][c], here[k][c], step);
    }
    if (node->edge == SC_TRACE_NO_EDGE) return;
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, l = (i + 2) % 3;
        mpf_sub(product, here[3][j], here[2][j]);
        mpf_sub(way, here[4][l], here[2][l]);
        mpf_mul(normal[i], product, way);
        mpf_sub(product, here[3][l], here[2][l]);
        mpf_sub(way, here[4][j], here[2][j]);
        mpf_mul(product, product, way);
        mpf_sub(normal[i], normal[i], product);
    }
    measure_height(way, here[0], here[2]);
    measure_height(by[0], here[0], here[1]);
    mpf_div(way, way, by[0]);
    for (int i = 0; i < 3; ++i) {
        mpf_sub(product, here[1][i], here[0][i]);
        mpf_mul(product, product, way);
        mpf_add(here[0][i], here[0][i], product);
    }
}

static void add_distance(mpf_t length, mpf_t *from, mpf_t *to)
{
    mpf_set_ui(sum, 0);
    for (int i = 0; i < 3; ++i) {
        mpf_sub(product, to[i], from[i]);
        mpf_mul(product, product, product);
        mpf_add(sum, sum, product);
    }
    mpf_sqrt(sum, sum);
    mpf_add(length, length, sum);
}

static void measure_contour(mpf_t length, const scene *s, const sc_trace_contour *contour,
                            uint32_t moved, int c, const mpf_t step)
{
    mpf_set_ui(length, 0);
    for (uint64_t k = 0; k < contour->count; ++k) {
        place_node(s, &s->traced.nodes[contour->first + k], moved, c, step);
        if (k) add_distance(length, last, here[0]);
        for (int i = 0; i < 3; ++i) mpf_set(last[i], here[0][i]);
        if (!k)
            for (int i = 0; i < 3; ++i) mpf_set(begin[i], here[0][i]);
    }
    if (contour->begin == SC_TRACE_CLOSED) add_distance(length, last, begin);
}

/* The derivative of a contour's length by a coordinate of a vertex. The scene's size:
   2^exponent. */
static double difference(const scene *s, const sc_trace_contour *contour, uint32_t moved, int c,
                         int exponent)
{
    mpf_t step, length[2];
    double result;
    mpf_inits(step, length[0], length[1], NULL);
    mpf_set_d(step, ldexp(1, exponent));
    mpf_div_2exp(step, step, STEP);
    measure_contour(length[0], s, contour, moved, c, step);
    mpf_neg(step, step);
    measure_contour(length[1], s, contour, moved, c, step);
    mpf_sub(length[0], length[0], length[1]);
    mpf_div(length[0], length[0], step);
    result = -mpf_get_d(length[0]) / 2;
    mpf_clears(step, length[0], length[1], NULL);
    return result;
}

/* ---- what stencils are ---- */

/* Whether the vertices and weights of all nodes are right, numbers are finite, and flags are set
   where they must be: FLAT where is_flat says so. */
static int check_stencils(const scene *s, int (*is_flat)(const scene *s, const uint32_t v[5]))
{
    for (uint64_t n = 0; n < s->traced.contour_count; ++n) {
        const sc_trace_contour *c = &s->traced.contours[n];
        for (uint64_t k = 0; k < c->count; ++k) {
            const sc_trace_node *node = &s->traced.nodes[c->first + k];
            const sc_trace_gradient *g = &s->gradients[c->first + k];
            uint32_t v[5], flags = 0;
            int is_zero = 1;
            name_vertices(s, node, v);
            if (!CHECK(memcmp(v, g->vertices, sizeof v) == 0)) return 0;
            for (int i = 0; i < 6; ++i) {
                const double number = g->vectors[i / 3][i % 3];
                if (!CHECK(isfinite(number))) return 0;
                is_zero &= number == 0;
            }
            if (node->edge == SC_TRACE_NO_EDGE) {
                if (!CHECK(g->weights[0] == 1 && g->weights[1] == 0 && g->weights[2] == 0 &&
                           g->weights[3] == 0 && g->weights[4] == 0))
                    return 0;
            } else {
                if (!CHECK(g->weights[0] == 1 - node->along && g->weights[1] == node->along &&
                           memcmp(g->weights + 2, node->weights, sizeof node->weights) == 0))
                    return 0;
                flags |= is_flat(s, v) ? SC_GRADIENT_FLAT : 0u;
            }
            for (int to = -1; to < 2; to += 2) {
                const sc_trace_node *other = neighbor(s, c, k, to);
                if (other && other->point[0] == node->point[0] &&
                    other->point[1] == node->point[1] && other->point[2] == node->point[2])
                    flags |= SC_GRADIENT_SHORT;
            }
            if (!CHECK_MSG(g->flags == flags, "flags %u, not %u", g->flags, flags)) return 0;
            if (flags & SC_GRADIENT_FLAT && !CHECK(is_zero)) return 0;
        }
    }
    return 1;
}

static int never_flat(const scene *s, const uint32_t v[5])
{
    (void)s;
    (void)v;
    return 0;
}

/* Small whole coordinates: the determinant is exact. */
static int is_flat_on_grid(const scene *s, const uint32_t v[5])
{
    double d[3], side[2][3], n[3];
    for (int i = 0; i < 3; ++i) {
        d[i] = position(s, v[1])[i] - position(s, v[0])[i];
        side[0][i] = position(s, v[3])[i] - position(s, v[2])[i];
        side[1][i] = position(s, v[4])[i] - position(s, v[2])[i];
    }
    cross(side[0], side[1], n);
    return n[0] * d[0] + n[1] * d[1] + n[2] * d[2] == 0;
}

/* The gradient of a contour and its errors: 3 numbers and one a vertex. */
static void sum_contour(const scene *s, const sc_trace_contour *c, double *gradient, double *error)
{
    memset(gradient, 0, 3 * (size_t)s->vertex_count * sizeof *gradient);
    memset(error, 0, (size_t)s->vertex_count * sizeof *error);
    for (uint64_t k = 0; k < c->count; ++k) {
        const sc_trace_gradient *g = &s->gradients[c->first + k];
        const double off = error_of(s, c, k);
        for (int i = 0; i < 5; ++i) {
            const double *vector = g->vectors[i >= 2];
            if (g->weights[i] == 0) continue;
            for (int x = 0; x < 3; ++x)
                gradient[3 * (size_t)g->vertices[i] + (size_t)x] += g->weights[i] * vector[x];
            error[g->vertices[i]] +=
                g->weights[i] * off + 0x1p-48 * norm(vector); /* weights, and this sum */
        }
    }
}

/* Whether a gradient pushes and turns nothing. */
static int is_balanced(const scene *s, const double *gradient, const double *error)
{
    double push[3] = {0, 0, 0}, turn[3] = {0, 0, 0}, off = 0, off_turn = 0;
    for (uint32_t v = 0; v < s->vertex_count; ++v) {
        const double *g = gradient + 3 * (size_t)v, *p = position(s, v);
        double n[3];
        cross(p, g, n);
        for (int i = 0; i < 3; ++i) {
            push[i] += g[i];
            turn[i] += n[i];
        }
        off += error[v] + 0x1p-50 * norm(g);
        off_turn += 2 * norm(p) * (error[v] + 0x1p-50 * norm(g));
    }
    return CHECK_MSG(norm(push) <= 2 * off, "pushes by %g, error %g", norm(push), off) &&
           CHECK_MSG(norm(turn) <= 2 * off_turn, "turns by %g, error %g", norm(turn), off_turn);
}

static int has_flags(const scene *s, const sc_trace_contour *c)
{
    for (uint64_t k = 0; k < c->count; ++k)
        if (s->gradients[c->first + k].flags) return 1;
    return 0;
}

/* Compares the gradients of contours without flags with differences, of some vertices. Adds up how
   many components these were. */
static int check_differences(const scene *s, int exponent, uint64_t *compared)
{
    double *gradient = (double *)test_allocate(3 * (size_t)s->vertex_count * sizeof *gradient);
    double *error = (double *)test_allocate((size_t)s->vertex_count * sizeof *error);
    int is_right = 1;
    for (uint64_t n = 0; n < s->traced.contour_count && is_right; ++n) {
        const sc_trace_contour *c = &s->traced.contours[n];
        if (has_flags(s, c)) continue;
        sum_contour(s, c, gradient, error);
        is_right = is_balanced(s, gradient, error);
        for (uint32_t times = 0; times < 6 && is_right; ++times) {
            const uint64_t k = c->first + test_random_below((uint32_t)c->count);
            const uint32_t v = s->gradients[k].vertices[test_random_below(5)];
            const int x = (int)test_random_below(3);
            const double expected = difference(s, c, v, x, exponent);
            const double found = gradient[3 * (size_t)v + (size_t)x];
            ++*compared;
            is_right = CHECK_MSG(fabs(found - expected) <= error[v],
                                 "vertex %u: %.17g, not %.17g; error %g, may be %g", v, found,
                                 expected, fabs(found - expected), error[v]);
        }
    }
    free(gradient);
    free(error);
    return is_right;
}

/* Meshes in general position, all kinds of ends, welded and not. */
static void generic_scenes(void)
{
    uint64_t compared = 0;
    init_numbers();
    for (uint32_t n = test_iterations(40); n > 0; --n) {
        const char *name = "cloths";
        soup mesh = test_random_below(2) ? crossing_cloths(3 + test_random_below(5))
                                         : soup_any_mesh(60, &name);
        double *pose = soup_copy_positions(&mesh);
        scene s;
        int is_right;
        if (strcmp(name, "cloths") != 0) soup_smooth(pose, mesh.vertex_count, 1);
        soup_noise(pose, mesh.vertex_count, 0.05);
        is_right = open_scene(&s, &mesh, pose, test_random_below(3)) &&
                   check_stencils(&s, never_flat) && check_differences(&s, 0, &compared);
        close_scene(&s);
        free(pose);
        soup_free(&mesh);
        if (!CHECK_MSG(is_right, "%s", name)) break;
    }
    clear_numbers();
    test_note("%" PRIu64 " derivatives", compared);
    CHECK(compared > 0);
}

/* Everything in a plane with everything, but where it is not. */
static void soups_on_grids(void)
{
    uint64_t compared = 0, flat = 0, is_short = 0, nodes = 0;
    init_numbers();
    for (uint32_t n = test_iterations(300); n > 0; --n) {
        soup mesh = soup_on_grid(1 + test_random_below(6));
        scene s;
        const int is_right = open_scene(&s, &mesh, mesh.positions, test_random_below(3)) &&
                             check_stencils(&s, is_flat_on_grid) &&
                             check_differences(&s, 0, &compared);
        for (uint64_t i = 0; i < s.traced.node_count && is_right; ++i, ++nodes) {
            flat += s.gradients[i].flags & SC_GRADIENT_FLAT;
            is_short += s.gradients[i].flags / SC_GRADIENT_SHORT;
        }
        close_scene(&s);
        soup_free(&mesh);
        if (!is_right) break;
    }
    clear_numbers();
    test_note("%" PRIu64 " nodes: %" PRIu64 " flat, %" PRIu64 " at short segments; %" PRIu64
              " derivatives",
              nodes, flat, is_short, compared);
    CHECK(!test_is_full() || (flat && is_short && compared));
}

static void adversaries(void)
{
    adversary (*const makers[])(void) = {adversary_slit,    adversary_strip,      adversary_petals,
                                         adversary_doubled, adversary_degenerate, adversary_moebius,
                                         adversary_klein,   adversary_book};
    uint64_t nodes = 0;
    for (uint32_t n = test_iterations(60); n > 0; --n) {
        adversary a = makers[n % (sizeof makers / sizeof *makers)]();
        scene s;
        int is_right;
        for (uint32_t v = 0; v < a.mesh.vertex_count; ++v)
            if (a.twin[v] < a.mesh.vertex_count)
                memcpy(a.mesh.positions + 3 * (size_t)v, a.mesh.positions + 3 * (size_t)a.twin[v],
                       3 * sizeof(double));
        is_right = open_scene(&s, &a.mesh, a.mesh.positions, SC_WELD_NONE);
        for (uint64_t i = 0; i < s.traced.node_count && is_right; ++i, ++nodes)
            for (int k = 0; k < 6; ++k)
                is_right &= CHECK(isfinite(s.gradients[i].vectors[k / 3][k % 3]));
        close_scene(&s);
        adversary_free(&a);
        if (!is_right) return;
    }
    test_note("%" PRIu64 " nodes", nodes);
}

/* ---- scales ---- */

/* Lengths near the ends of the range of doubles. */
static void all_sizes(void)
{
    uint64_t compared = 0;
    init_numbers();
    for (uint32_t n = test_iterations(20); n > 0; --n) {
        soup mesh = crossing_cloths(3 + test_random_below(3));
        const int exponent = (int)test_random_below(1900) - 950;
        scene s;
        int is_right;
        for (uint32_t i = 0; i < 3 * mesh.vertex_count; ++i)
            mesh.positions[i] = ldexp(mesh.positions[i], exponent);
        is_right =
            open_scene(&s, &mesh, mesh.positions, SC_WELD_NONE) && check_stencils(&s, never_flat);
        /* tolerances are computed where squares are doubles */
        if (is_right && abs(exponent) < 150) is_right = check_differences(&s, exponent, &compared);
        for (uint64_t i = 0; i < s.traced.contour_count && is_right; ++i) {
            const sc_trace_contour *c = &s.traced.contours[i];
            double push[3] = {0, 0, 0}, size = 0;
            for (uint64_t k = c->first; k < c->first + c->count; ++k)
                for (int x = 0; x < 3; ++x) {
                    const sc_trace_gradient *g = &s.gradients[k];
                    push[x] += g->vectors[0][x] + g->vectors[1][x];
                    size += fabs(g->vectors[0][x]) + fabs(g->vectors[1][x]);
                }
            is_right = CHECK_MSG(norm(push) <= 1e-9 * size, "2^%d: %g of %g", exponent, norm(push),
                                 size) &&
                       CHECK(size > 1e-3);
        }
        close_scene(&s);
        soup_free(&mesh);
        if (!is_right) break;
    }
    clear_numbers();
    CHECK(compared > 0 || !test_is_full());
}

/* Floats and doubles of the same values. */
static void floats_are_doubles(void)
{
    for (uint32_t n = test_iterations(10); n > 0; --n) {
        soup mesh = crossing_cloths(4 + test_random_below(5));
        float *floats = (float *)test_allocate(3 * (size_t)mesh.vertex_count * sizeof *floats);
        scene s;
        soup_round_to_float(mesh.positions, mesh.vertex_count);
        for (uint32_t i = 0; i < 3 * mesh.vertex_count; ++i) floats[i] = (float)mesh.positions[i];
        if (open_scene(&s, &mesh, mesh.positions, SC_WELD_NONE) && CHECK(s.traced.node_count > 0)) {
            const size_t bytes = (size_t)s.traced.node_count * sizeof *s.gradients;
            sc_trace_gradient *others = (sc_trace_gradient *)test_allocate(bytes);
            sc_pose pose = s.pose;
            pose.position_type = SC_FLOAT;
            pose.position_stride = 0;
            pose.positions = floats;
            CHECK(sc_trace_gradients(s.model, &pose, &s.traced, others) == SC_OK &&
                  memcmp(s.gradients, others, bytes) == 0);
            free(others);
        }
        close_scene(&s);
        free(floats);
        soup_free(&mesh);
    }
}

/* ---- what cannot be ---- */

/* Two triangles, and a contour from a crossing of the second's first side with the first to its
   first vertex. */
typedef struct small_scene {
    double positions[18];
    sc_pose pose;
    sc_model *model;
    sc_trace_node nodes[2];
    sc_trace_contour contour;
    sc_trace_result traced;
    sc_trace_gradient gradients[2];
} small_scene;

static int open_small(small_scene *s, const double positions[18])
{
    uint32_t indices[6] = {0, 1, 2, 3, 4, 5};
    sc_build_options options;
    sc_mesh mesh;
    memset(s, 0, sizeof *s);
    memcpy(s->positions, positions, sizeof s->positions);
    memset(&options, 0, sizeof options);
    options.struct_size = sizeof options;
    options.weld = SC_WELD_NONE;
    memset(&mesh, 0, sizeof mesh);
    mesh.struct_size = sizeof mesh;
    mesh.vertex_count = 6;
    mesh.triangle_count = 2;
    mesh.position_type = SC_DOUBLE;
    mesh.index_type = SC_UINT32;
    mesh.positions = s->positions;
    mesh.indices = indices;
    s->pose = input_plain_pose(s->positions, 6);
    s->nodes[0].edge = 3;
    s->nodes[0].along = 0.5;
    s->nodes[0].weights[0] = s->nodes[0].weights[1] = 0.25;
    s->nodes[0].weights[2] = 0.5;
    for (int i = 0; i < 3; ++i) s->nodes[0].point[i] = (positions[9 + i] + positions[12 + i]) / 2;
    s->nodes[1].edge = SC_TRACE_NO_EDGE;
    memcpy(s->nodes[1].point, positions, sizeof s->nodes[1].point);
    s->contour.count = 2;
    s->contour.begin = s->contour.end = SC_TRACE_VERTEX;
    s->traced.struct_size = sizeof s->traced;
    s->traced.node_count = s->traced.node_capacity = 2;
    s->traced.contour_count = s->traced.contour_capacity = 1;
    s->traced.nodes = s->nodes;
    s->traced.contours = &s->contour;
    return CHECK(sc_build(&mesh, &options, &s->model) == SC_OK);
}

/* Edges in the plane of a triangle with coordinates of so many bits that determinants are rounded,
   and edges just out of it. */
static void edges_in_planes(void)
{
    for (uint32_t n = test_iterations(300); n > 0; --n) {
        const int is_in_plane = test_random_below(2) != 0;
        double p[18], e[2][3];
        small_scene s;
        for (int i = 0; i < 6; ++i)
            e[i / 3][i % 3] = (double)(test_random() >> 33) - 0x1p30; /* 31 bits */
        for (int v = 0; v < 6; ++v) {
            const double a = v < 3 ? v == 1 : (double)test_random_below(17) - 8;
            const double b = v < 3 ? v == 2 : (double)test_random_below(17) - 8;
            for (int i = 0; i < 3; ++i) p[3 * v + i] = a * e[0][i] + b * e[1][i];
        }
        if (memcmp(p + 9, p + 12, 3 * sizeof *p) == 0)
            for (int i = 0; i < 3; ++i) p[12 + i] += e[0][i];
        if (!is_in_plane)
            for (int i = 0; i < 3; ++i) {
                double normal_of[3];
                cross(e[0], e[1], normal_of);
                p[12 + i] += normal_of[i] * 0x1p-30 * 0x1p-8;
            }
        if (open_small(&s, p)) {
            CHECK(sc_trace_gradients(s.model, &s.pose, &s.traced, s.gradients) == SC_OK);
            CHECK_MSG((s.gradients[0].flags & SC_GRADIENT_FLAT) == (uint32_t)is_in_plane,
                      "flags %u", s.gradients[0].flags);
            CHECK(!is_in_plane || norm(s.gradients[0].vectors[1]) == 0);
        }
        sc_model_free(s.model);
    }
}

static const double crossing[18] = {0, 0, 0, 4, 0, 0, 0, 4, 0, 1, 1, -1, 1, 1, 1, 9, 9, 9};

static sc_status ask(small_scene *s)
{
    return sc_trace_gradients(s->model, &s->pose, &s->traced, s->gradients);
}

/* An edge so close to a line of a triangle that is all but a line that the product of all
   underflows, though nothing is rounded. */
static void products_underflow(void)
{
    static const double p[18] = {0,       0, 0, 1,      0, 0,        1, 0x1p-500, 0,
                                 -0x1p-1, 0, 0, 0x1p-1, 0, 0x1p-450, 9, 9,        9};
    small_scene s;
    if (open_small(&s, p) && CHECK(ask(&s) == SC_OK)) {
        CHECK(s.gradients[0].flags & SC_GRADIENT_FLAT);
        CHECK(norm(s.gradients[0].vectors[0]) == 0 && norm(s.gradients[0].vectors[1]) == 0);
    }
    sc_model_free(s.model);
}

/* Lengths that are no doubles, of an edge and of a segment. */
static void lengths_overflow(void)
{
    small_scene s;
    double p[18];
    memcpy(p, crossing, sizeof p);
    p[11] = -0x1.8p1023;
    p[14] = 0x1.8p1023;
    if (open_small(&s, p) && CHECK(ask(&s) == SC_OK)) {
        CHECK(s.gradients[0].flags == SC_GRADIENT_FLAT);
        CHECK(norm(s.gradients[0].vectors[0]) == 0 && norm(s.gradients[0].vectors[1]) == 0);
        CHECK(s.gradients[1].flags == 0 && norm(s.gradients[1].vectors[0]) > 0.99);
    }
    sc_model_free(s.model);
    if (open_small(&s, crossing)) {
        s.nodes[0].point[2] = -0x1.8p1023;
        s.nodes[1].point[2] = 0x1.8p1023;
        CHECK(ask(&s) == SC_OK);
        for (int i = 0; i < 2; ++i)
            CHECK(s.gradients[i].flags == SC_GRADIENT_SHORT &&
                  norm(s.gradients[i].vectors[0]) == 0 && norm(s.gradients[i].vectors[1]) == 0);
    }
    sc_model_free(s.model);
}

static void wrong_arguments(void)
{
    small_scene s;
    if (open_small(&s, crossing)) {
        const sc_trace_result traced = s.traced;
        CHECK(ask(&s) == SC_OK);
        CHECK(sc_trace_gradients(NULL, &s.pose, &s.traced, s.gradients) == SC_ERROR_NULL);
        CHECK(sc_trace_gradients(s.model, NULL, &s.traced, s.gradients) == SC_ERROR_NULL);
        CHECK(sc_trace_gradients(s.model, &s.pose, NULL, s.gradients) == SC_ERROR_NULL);
        CHECK(sc_trace_gradients(s.model, &s.pose, &s.traced, NULL) == SC_ERROR_NULL);
        s.traced.nodes = NULL;
        CHECK(ask(&s) == SC_ERROR_NULL);
        s.traced = traced;
        s.traced.contours = NULL;
        CHECK(ask(&s) == SC_ERROR_NULL);
        s.traced = traced;
        s.traced.struct_size = 8;
        CHECK(ask(&s) == SC_ERROR_STRUCT_SIZE);
        s.traced = traced;
        s.traced.node_capacity = 1;
        CHECK(ask(&s) == SC_ERROR_SHORT_BUFFER);
        s.traced = traced;
        s.traced.contour_capacity = 0;
        CHECK(ask(&s) == SC_ERROR_SHORT_BUFFER);
        s.traced = traced;
        s.pose.vertex_count = 5;
        CHECK(ask(&s) == SC_ERROR_VERTEX_COUNT);
        s.pose.vertex_count = 6;
        s.traced.node_count = s.traced.contour_count = 0;
        s.traced.nodes = NULL;
        s.traced.contours = NULL;
        CHECK(sc_trace_gradients(s.model, &s.pose, &s.traced, NULL) == SC_OK);
        s.traced.contours = traced.contours; /* one that has no nodes */
        s.traced.contour_count = 1;
        s.contour.count = 0;
        CHECK(sc_trace_gradients(s.model, &s.pose, &s.traced, NULL) == SC_OK);
    }
    sc_model_free(s.model);
}

static void wrong_nodes(void)
{
    small_scene s;
    if (open_small(&s, crossing)) {
        const small_scene right = s;
        s.contour.first = 1;
        CHECK(ask(&s) == SC_ERROR_PAIRS);
        s.contour.first = UINT64_MAX;
        CHECK(ask(&s) == SC_ERROR_PAIRS);
        s.contour.first = 0;
        s.contour.count = 1; /* the other is of no contour */
        memset(s.gradients, 255, sizeof s.gradients);
        CHECK(ask(&s) == SC_OK && s.gradients[1].weights[0] == 0 && s.gradients[1].flags == 0);
        s.contour.count = 2;
        s.nodes[0].edge = 6;
        CHECK(ask(&s) == SC_ERROR_PAIRS);
        s.nodes[0].edge = 3;
        s.nodes[0].triangle = 2;
        CHECK(ask(&s) == SC_ERROR_PAIRS);
        s.nodes[0].triangle = 0;
        s.nodes[1].triangle = 6;
        CHECK(ask(&s) == SC_ERROR_PAIRS);
        s.nodes[1].triangle = 0;
        s.nodes[0].along = (double)NAN;
        CHECK(ask(&s) == SC_ERROR_NOT_FINITE);
        s.nodes[0] = right.nodes[0];
        s.nodes[0].point[2] = (double)INFINITY;
        CHECK(ask(&s) == SC_ERROR_NOT_FINITE);
        s.nodes[0] = right.nodes[0];
        s.positions[8] = (double)NAN;
        CHECK(ask(&s) == SC_ERROR_NOT_FINITE);
    }
    sc_model_free(s.model);
}

/* By hand: an edge that stands upright in a triangle, and a contour from there to the corner at the
   origin, which is sqrt(2) long. Vertices of the triangle move it not at all along its plane. */
static void by_hand(void)
{
    small_scene s;
    if (open_small(&s, crossing) && CHECK(ask(&s) == SC_OK)) {
        const double half = sqrt(0.5);
        const sc_trace_gradient *g = s.gradients;
        CHECK(fabs(g[0].vectors[0][0] - half) < 1e-15 && fabs(g[0].vectors[0][1] - half) < 1e-15);
        CHECK(g[0].vectors[0][2] == 0 && g[0].vectors[1][0] == 0 && g[0].vectors[1][2] == 0);
        CHECK(fabs(g[1].vectors[0][0] + half) < 1e-15 && fabs(g[1].vectors[0][1] + half) < 1e-15);
    }
    sc_model_free(s.model);
}

SC_TEST_MAIN(SC_TEST(by_hand), SC_TEST(generic_scenes), SC_TEST(soups_on_grids),
             SC_TEST(adversaries), SC_TEST(all_sizes), SC_TEST(floats_are_doubles),
             SC_TEST(edges_in_planes), SC_TEST(products_underflow), SC_TEST(lengths_overflow),
             SC_TEST(wrong_arguments), SC_TEST(wrong_nodes))
