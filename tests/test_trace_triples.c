/*
 * Points where three sheets meet: sides of crossings, against the oracle's polynomials; triples,
 * against the oracle's of all triangles, and against planes that are intersected in rational
 * numbers; closed sheets, which each contour enters as often as it leaves them; and arguments that
 * cannot be.
 *
 * SPDX-License-Identifier: MIT
 */
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/perturbed.h"
#include "base/wide.h"
#include "harness.h"
#include "inputs.h"
#include "soups.h"
#include "starcontour.h"
#include "trace_oracle.h"
#include "trace_scene.h"
#include "triple_oracle.h"

/* ---- sides ---- */

/* Eight points of a small grid, often the same or in a plane, or far out. An end of the edge may be
   a corner of the plane, and so may a corner of the triangle. */
static void draw_points(double position[8][3], const double *points[8], uint32_t numbers[8])
{
    const uint32_t range = 1 + test_random_below(4), shared = test_random_below(4);
    const int is_real = test_random_below(4) == 0;
    const double size = test_random_below(4) ? 1 : ldexp(1, (int)test_random_below(300) - 150);
    for (int i = 0; i < 24; ++i)
        position[i / 3][i % 3] = size * (is_real ? test_random_unit() : test_random_below(range));
    for (int i = 0; i < 8; ++i) {
        int is_new = 0;
        points[i] = position[i];
        while (!is_new) {
            numbers[i] = test_random_below(2) ? test_random_below(12) : (uint32_t)test_random();
            is_new = 1;
            for (int j = 0; j < i; ++j) is_new &= numbers[j] != numbers[i];
        }
    }
    for (uint32_t i = 0; i < 2; ++i)
        if (shared >> i & 1) {
            const uint32_t from = i ? 2 + test_random_below(3) : test_random_below(2);
            const uint32_t to = 5 + test_random_below(3);
            if (numbers[to] == numbers[0] || numbers[to] == numbers[1]) continue; /* it is shared */
            numbers[to] = numbers[from];
            points[to] = points[from];
        }
}

static void sides_are_those_of_polynomials(void)
{
    uint32_t flat = 0, done = 0;
    for (uint32_t n = test_iterations(400); n > 0; --n) {
        double position[8][3];
        const double *points[8];
        uint32_t numbers[8];
        int sign, expected, side[2];
        draw_points(position, points, numbers);
        for (int end = 0; end < 2; ++end) {
            const double *const p[4] = {points[2], points[3], points[4], points[end]};
            const uint32_t m[4] = {numbers[2], numbers[3], numbers[4], numbers[end]};
            side[end] = trace_oracle_sign(p, m);
        }
        if (side[0] == side[1]) continue;
        expected = triple_oracle_side(points, numbers);
        sign = sc_perturbed_crossing_side(points, numbers);
        ++done;
        flat += !(fabs(triple_oracle_height(points)) > 0);
        if (!CHECK_MSG(sign == expected, "%d, not %d", sign, expected)) return;
    }
    CHECK_MSG((flat > 0 && flat < done) || !test_is_full(), "%u of %u in a plane", flat, done);
}

/* An edge and a triangle that cross right beside a plane, so that what tells the side is the last
   bits of two products, or nothing: the plane's corners are the crossing and others, rounded. */
static void sides_nearly_in_planes(void)
{
    uint32_t near = 0, done = 0;
    for (uint32_t n = test_iterations(2000); n > 0; --n) {
        double position[8][3], share[2] = {test_random_unit(), test_random_unit()};
        const double *points[8];
        uint32_t numbers[8];
        int sign, expected;
        for (int i = 0; i < 24; ++i) position[i / 3][i % 3] = test_random_unit();
        for (uint32_t i = 0; i < 8; ++i) {
            points[i] = position[i];
            numbers[i] = i;
        }
        for (int k = 0; k < 3; ++k) { /* through the middle of the edge, both of them */
            position[4][k] =
                position[0][k] + position[1][k] - (position[2][k] + position[3][k]) / 2;
            position[7][k] =
                (position[0][k] + position[1][k]) / 2 +
                (share[0] - 0.5) * (position[5][k] - position[6][k]) +
                (share[1] - 0.5) * (position[5][k] - position[0][k] / 2 - position[1][k] / 2);
        }
        expected = triple_oracle_side(points, numbers);
        sign = sc_perturbed_crossing_side(points, numbers);
        near += fabs(triple_oracle_height(points)) < 0x1p-48;
        ++done;
        if (!CHECK_MSG(sign == expected, "%d, not %d", sign, expected)) return;
    }
    CHECK_MSG(near > done / 2 || !test_is_full(), "%u of %u are near", near, done);
}

/* The determinant of so many rows of ones and of chosen columns, of whole numbers. */
static double minor_of(const sc_wide_minor *m, int rows, int column)
{
    double sum = 0;
    if (column == 0) return 1; /* the column of ones, of the only row that is left */
    for (int i = 0, place = 0; i < m->count; ++i) {
        if (rows >> i & 1) continue;
        sum += ((place++ + column) % 2 ? -1 : 1) * m->rows[i][m->columns[column - 1]] *
               minor_of(m, rows | 1 << i, column - 1);
    }
    return sum;
}

/* Sums of products of minors of all sizes, in numbers that doubles hold exactly. */
static void minors_are_added_up(void)
{
    for (uint32_t n = test_iterations(2000); n > 0; --n) {
        const int count = 1 + (int)test_random_below(4), rows = 2 + (int)test_random_below(7);
        const int power = (int)test_random_below(100) - 50;
        double position[8][3], truth = 0, value;
        sc_wide_minor factors[4][2];
        int signs[4], exponent;
        for (int i = 0; i < 24; ++i)
            position[i / 3][i % 3] = ldexp((double)test_random_below(7) - 3, power);
        for (int i = 0; i < count; ++i) {
            const int least = rows > 5 ? rows - 4 : 1, most = rows > 4 ? 4 : rows - 1;
            factors[i][0].count = least + (int)test_random_below((uint32_t)(most - least + 1));
            factors[i][1].count = rows - factors[i][0].count;
            signs[i] = test_random_below(2) ? 1 : -1;
            for (int k = 0; k < 2; ++k) {
                sc_wide_minor *m = &factors[i][k];
                const int left_out = (int)test_random_below(3);
                for (int c = 0; c < 3; ++c) m->columns[c] = c;
                if (m->count == 2) m->columns[0] = left_out;
                if (m->count == 3)
                    for (int c = 0; c < 2; ++c) m->columns[c] = c + (c >= left_out);
                for (int r = 0; r < m->count; ++r) m->rows[r] = position[test_random_below(8)];
            }
            truth += signs[i] * minor_of(&factors[i][0], 0, factors[i][0].count - 1) *
                     minor_of(&factors[i][1], 0, factors[i][1].count - 1);
        }
        value = sc_wide_minors_value((const sc_wide_minor(*)[2])factors, signs, count, &exponent);
        if (!CHECK_MSG(ldexp(value, exponent) == truth, "%g, not %g", ldexp(value, exponent),
                       truth))
            return;
    }
}

/* ---- triples ---- */

/* Asks for their number first, then for all. The caller frees the array. */
static int find_triples(const sc_model *model, const sc_pose *pose, const sc_trace_result *trace,
                        const sc_trace_options *options, sc_triples_result *r)
{
    sc_status status;
    memset(r, 0, sizeof *r);
    r->struct_size = sizeof *r;
    status = sc_trace_triples(model, pose, trace, options, r);
    if (!CHECK_MSG(status == (r->count ? SC_ERROR_SHORT_BUFFER : SC_OK), "%s",
                   sc_status_string(status)))
        return 0;
    r->capacity = r->count;
    r->triples = (sc_trace_triple *)test_allocate((size_t)r->count * sizeof *r->triples);
    return CHECK(sc_trace_triples(model, pose, trace, options, r) == SC_OK) &&
           CHECK(r->count == r->capacity);
}

/* A scene, and where segments begin: of each two triangles the number of the node and 1, or 0. */
typedef struct segment_table {
    const trace_scene *scene;
    uint64_t *node;
    uint64_t *next; /* of each node: the one behind it */
} segment_table;

static uint64_t *segment_of(const segment_table *t, uint32_t a, uint32_t b)
{
    return &t->node[(size_t)a * t->scene->mesh.triangle_count + b];
}

static segment_table open_table(const trace_scene *s)
{
    const sc_trace_result *r = &s->result;
    const size_t triangles = s->mesh.triangle_count;
    segment_table t = {s, (uint64_t *)calloc(triangles * triangles, sizeof *t.node),
                       (uint64_t *)test_allocate((size_t)r->node_count * sizeof *t.next)};
    if (!t.node) abort();
    for (uint64_t c = 0; c < r->contour_count; ++c)
        for (uint64_t i = 0; i < r->contours[c].count; ++i) {
            const uint64_t at = r->contours[c].first + i;
            const sc_trace_node *node = &r->nodes[at];
            t.next[at] = r->contours[c].first + (i + 1) % r->contours[c].count;
            if (node->sheets[0] == SC_TRACE_NO_EDGE) continue;
            *segment_of(&t, node->sheets[0], node->sheets[1]) = at + 1;
            *segment_of(&t, node->sheets[1], node->sheets[0]) = at + 1;
        }
    return t;
}

static void close_table(segment_table *t)
{
    free(t->node);
    free(t->next);
}

static const uint32_t *corners_of(const trace_scene *s, uint32_t triangle)
{
    return s->mesh.triangles + 3 * (size_t)triangle;
}

static int has_vertex(const uint32_t *corner, uint32_t v)
{
    return corner[0] == v || corner[1] == v || corner[2] == v;
}

/* The eight points of a node at an edge, and of a plane. */
static void name_eight(const trace_scene *s, const sc_trace_node *node, uint32_t plane,
                       const double *points[8], uint32_t numbers[8])
{
    const uint32_t *corner = corners_of(s, node->edge / 3);
    numbers[0] = corner[node->edge % 3];
    numbers[1] = corner[(node->edge + 1) % 3];
    memcpy(numbers + 2, corners_of(s, node->triangle), 3 * sizeof *numbers);
    memcpy(numbers + 5, corners_of(s, plane), 3 * sizeof *numbers);
    for (int i = 0; i < 8; ++i) points[i] = s->mesh.positions + 3 * (size_t)numbers[i];
}

/* On which side of a triangle's plane a node is; 0 if it is one of its vertices. */
static int side_of_node(const trace_scene *s, const sc_trace_node *node, uint32_t plane)
{
    const double *points[8];
    uint32_t numbers[8];
    if (node->edge == SC_TRACE_NO_EDGE) {
        if (has_vertex(corners_of(s, plane), node->triangle)) return 0;
        memcpy(numbers, corners_of(s, plane), 3 * sizeof *numbers);
        numbers[3] = node->triangle;
        for (int i = 0; i < 4; ++i) points[i] = s->mesh.positions + 3 * (size_t)numbers[i];
        return trace_oracle_sign(points, numbers);
    }
    name_eight(s, node, plane, points, numbers);
    return triple_oracle_side(points, numbers);
}

/* Its height; NaN if its edge is parallel to its triangle. A vertex is where an upright line meets
   a level plane. */
static double height_of_node(const trace_scene *s, const sc_trace_node *node, uint32_t plane)
{
    const double *points[8];
    uint32_t numbers[8];
    double by[4][3], size = 1;
    if (node->edge != SC_TRACE_NO_EDGE) {
        name_eight(s, node, plane, points, numbers);
        return triple_oracle_height(points);
    }
    for (int k = 0; k < 3; ++k) size += fabs(node->point[k]);
    for (int i = 0; i < 4; ++i) {
        memcpy(by[i], node->point, sizeof by[i]);
        if (i) by[i][i - 1] += size;
    }
    points[0] = by[3];
    points[1] = by[0];
    points[2] = by[0];
    points[3] = by[1];
    points[4] = by[2];
    for (int i = 0; i < 3; ++i)
        points[5 + i] = s->mesh.positions + 3 * (size_t)corners_of(s, plane)[i];
    return triple_oracle_height(points);
}

/* Whether the segment of two triangles passes through the plane of a third. */
static int does_pass(const segment_table *t, uint32_t a, uint32_t b, uint32_t plane)
{
    const sc_trace_node *nodes = t->scene->result.nodes;
    const uint64_t at = *segment_of(t, a, b) - 1;
    return side_of_node(t->scene, &nodes[at], plane) *
               side_of_node(t->scene, &nodes[t->next[at]], plane) <
           0;
}

/* Whether a triple is where it says it is. */
static int is_placed(const segment_table *t, const sc_trace_triple *triple)
{
    const sc_trace_node *nodes = t->scene->result.nodes;
    for (int i = 0; i < 3; ++i) {
        const uint32_t a = triple->triangles[(i + 1) % 3], b = triple->triangles[(i + 2) % 3];
        const uint64_t at = *segment_of(t, a, b) - 1;
        const double low = fabs(height_of_node(t->scene, &nodes[at], triple->triangles[i]));
        const double high =
            fabs(height_of_node(t->scene, &nodes[t->next[at]], triple->triangles[i]));
        const double along = triple->along[i];
        if (!CHECK(triple->nodes[i] == at) || !CHECK(along >= 0 && along <= 1)) return 0;
        if (low == 0 && high == 0 && !CHECK(along == 0.5)) return 0;
        if (low + high > 0 && !CHECK_MSG(fabs(along - low / (low + high)) <= 0x1.01p-38,
                                         "along %.17g, not %.17g", along, low / (low + high)))
            return 0;
        for (int k = 0; k < 3 && i == 2; ++k) {
            const double p = nodes[at].point[k], q = nodes[t->next[at]].point[k];
            const double size = fabs(p) > fabs(q) ? fabs(p) : fabs(q);
            if (!CHECK(fabs(triple->point[k] - ((1 - along) * p + along * q)) <= 0x1p-50 * size) ||
                !CHECK(triple->point[k] >= (p < q ? p : q) && triple->point[k] <= (p < q ? q : p)))
                return 0;
        }
    }
    return CHECK(triple->reserved == 0);
}

/* Whether a triple is where the planes of three triangles without a common vertex say. */
static int fits_planes(const trace_scene *s, const uint32_t three[3], int is_found, uint64_t *sure)
{
    const double *points[9];
    int meet;
    for (int i = 0; i < 9; ++i)
        points[i] = s->mesh.positions + 3 * (size_t)corners_of(s, three[i / 3])[i % 3];
    meet = triple_oracle_meet(points);
    if (meet < 0) return 1;
    *sure += meet == 1;
    return CHECK_MSG(meet == is_found, "planes: %d", meet);
}

/* What was seen. */
typedef struct triple_tally {
    uint64_t triples, sure;
} triple_tally;

/* Compares the triples of a scene with those of all triangles that have segments two by two. */
static int check_triples(const trace_scene *s, triple_tally *sum)
{
    const uint32_t triangles = s->mesh.triangle_count;
    segment_table t = open_table(s);
    sc_triples_result r;
    uint64_t at = 0;
    int is_right = find_triples(s->model, &s->pose, &s->result, NULL, &r);
    uint32_t three[3];
    for (three[0] = 0; is_right && three[0] < triangles; ++three[0])
        for (three[1] = three[0] + 1; is_right && three[1] < triangles; ++three[1]) {
            if (!*segment_of(&t, three[0], three[1])) continue;
            for (three[2] = three[1] + 1; is_right && three[2] < triangles; ++three[2]) {
                int pass[3], is_found = at < r.count;
                if (!*segment_of(&t, three[0], three[2]) || !*segment_of(&t, three[1], three[2]))
                    continue;
                for (int i = 0; i < 3; ++i)
                    pass[i] = does_pass(&t, three[(i + 1) % 3], three[(i + 2) % 3], three[i]);
                for (int i = 0; i < 3; ++i)
                    is_found &= is_found && r.triples[at].triangles[i] == three[i];
                /* two of them imply the third */
                is_right = CHECK_MSG(pass[0] + pass[1] + pass[2] != 2, "two of three pass") &&
                           CHECK_MSG(is_found == (pass[0] && pass[1] && pass[2]),
                                     "%u, %u and %u: %d", three[0], three[1], three[2], is_found) &&
                           fits_planes(s, three, is_found, &sum->sure);
                if (is_right && is_found) is_right = is_placed(&t, &r.triples[at++]);
            }
        }
    is_right = is_right && CHECK(at == r.count);
    sum->triples += r.count;
    free(r.triples);
    close_table(&t);
    return is_right;
}

static int check_soup(soup mesh, triple_tally *sum)
{
    trace_scene s;
    const int is_right = trace_scene_open(&s, mesh, SC_MODEL_FULL) && check_triples(&s, sum);
    trace_scene_close(&s);
    return is_right;
}

static void note_triples(const triple_tally *sum)
{
    test_note("%" PRIu64 " triples, %" PRIu64 " of them sure by planes", sum->triples, sum->sure);
    CHECK(!test_is_full() || (sum->sure > 0 && sum->triples > sum->sure));
}

static void soups(void)
{
    triple_tally sum = {0, 0};
    for (uint32_t n = test_iterations(100); n > 0; --n) {
        const int is_grid = test_random_below(3) > 0;
        if (!check_soup(is_grid ? soup_on_grid(1 + test_random_below(6)) : soup_scattered(), &sum))
            return;
    }
    note_triples(&sum);
}

static void meshes(void)
{
    triple_tally sum = {0, 0};
    for (uint32_t n = test_iterations(20); n > 0; --n) {
        const char *name;
        soup s = soup_any_mesh(80, &name);
        soup_any_pose(s.positions, s.vertex_count);
        if (test_random_below(2)) soup_crush(s.positions, s.vertex_count);
        soup_noise(s.positions, s.vertex_count, 0.2);
        if (test_random_below(3) == 0) soup_snap(s.positions, s.vertex_count, 0.125);
        if (!CHECK_MSG(check_soup(s, &sum), "%s", name)) return;
    }
    note_triples(&sum);
}

/* Three triangles whose planes have a line in common but for rounding: both ends of each segment
   are so near to the third plane that nothing is left of their heights in doubles. */
static void planes_through_a_line(void)
{
    triple_tally sum = {0, 0};
    for (uint32_t n = test_iterations(300); n > 0; --n) {
        soup s = soup_make(9, 3);
        double line[3], side[3];
        for (int k = 0; k < 3; ++k) line[k] = test_random_range(-1, 1);
        for (uint32_t v = 0; v < 9;
             ++v) { /* two corners on one side of the line, one on the other */
            const double along = test_random_range(0.5, 2) * (v % 3 == 2 ? 0.1 : v % 3 ? 1 : -1);
            const double across = test_random_range(0.5, 2) * (v % 3 == 2 ? -1 : 1);
            s.triangles[v] = v;
            for (int k = 0; k < 3; ++k) {
                if (v % 3 == 0) side[k] = test_random_range(-1, 1);
                s.positions[3 * v + (uint32_t)k] = along * line[k] + across * side[k];
            }
        }
        if (!check_soup(s, &sum)) return;
    }
    test_note("%" PRIu64 " triples", sum.triples);
    CHECK(sum.triples > 0 || !test_is_full());
}

/* Three copies of a mesh in one place. */
static void equal_sheets(void)
{
    triple_tally sum = {0, 0};
    for (uint32_t n = test_iterations(4); n > 0; --n) {
        soup cloth = soup_cloth(1 + test_random_below(3), 1 + test_random_below(3));
        soup two = soup_join(&cloth, &cloth);
        const int is_right = check_soup(soup_join(&two, &cloth), &sum);
        soup_free(&cloth);
        soup_free(&two);
        if (!is_right) return;
    }
    test_note("%" PRIu64 " triples", sum.triples);
}

/* ---- closed sheets ---- */

/* Joins three closed meshes, at places of a grid or all in one; first[i]: the first triangle of the
   i'th. */
static soup three_closed(uint32_t first[4])
{
    const int are_equal = test_random_below(3) == 0;
    soup all = soup_make(0, 0);
    const uint32_t around = 3 + test_random_below(3), rings = 2 + test_random_below(3);
    const double step = test_random_below(4) ? 0.25 : 0x1p-20;
    for (int i = 0; i < 3; ++i) {
        soup one = soup_sphere(are_equal ? around : 3 + test_random_below(3),
                               are_equal ? rings : 2 + test_random_below(3)),
             both;
        if (!are_equal) soup_noise(one.positions, one.vertex_count, 0.5);
        soup_snap(one.positions, one.vertex_count, step);
        first[i] = all.triangle_count;
        both = soup_join(&all, &one);
        soup_free(&one);
        soup_free(&all);
        all = both;
    }
    first[3] = all.triangle_count;
    return all;
}

static int component_of(const uint32_t first[4], uint32_t triangle)
{
    return (triangle >= first[1]) + (triangle >= first[2]);
}

/* A closed contour of two components enters a third one, which is closed, as often as it leaves it:
   it meets it an even number of times. All ties together must be decided as one. */
static void contours_leave_what_they_enter(void)
{
    uint64_t triples = 0;
    for (uint32_t n = test_iterations(60); n > 0; --n) {
        uint32_t first[4];
        trace_scene s;
        sc_triples_result r;
        int is_even = 1;
        if (trace_scene_open(&s, three_closed(first), SC_MODEL_FULL) &&
            find_triples(s.model, &s.pose, &s.result, NULL, &r)) {
            for (uint64_t c = 0; c < s.result.contour_count; ++c) {
                const sc_trace_contour *contour = &s.result.contours[c];
                uint32_t met[3] = {0, 0, 0};
                for (uint64_t i = 0; i < 3 * r.count; ++i) {
                    const sc_trace_triple *t = &r.triples[i / 3];
                    const uint64_t at = t->nodes[i % 3] - contour->first;
                    if (at < contour->count) ++met[component_of(first, t->triangles[i % 3])];
                }
                const uint32_t *sheets = s.result.nodes[contour->first].sheets;
                for (int k = 0; k < 3; ++k)
                    if (contour->begin == SC_TRACE_CLOSED && k != component_of(first, sheets[0]) &&
                        k != component_of(first, sheets[1]))
                        is_even &= CHECK_MSG(met[k] % 2 == 0, "met %u times", met[k]);
            }
            triples += r.count;
            free(r.triples);
        }
        trace_scene_close(&s);
        if (!is_even) return;
    }
    test_note("%" PRIu64 " triples", triples);
    CHECK(triples > 0 || !test_is_full());
}

/* ---- a scene of many ---- */

/* A cloth through two that cross: hundreds of triples. */
static soup three_cloths(uint32_t across)
{
    soup two = trace_scene_cloths(across), one = soup_cloth(across, across), all;
    for (uint32_t v = 0; v < one.vertex_count; ++v) {
        double *p = one.positions + 3 * (size_t)v;
        p[2] = p[0] - 0.5;
        p[0] = 0.5;
    }
    soup_noise(one.positions, one.vertex_count, 0.3);
    all = soup_join(&two, &one);
    soup_free(&two);
    soup_free(&one);
    return all;
}

/* Triangles with corners of their own that welding makes those of the mesh again. */
static void welding_changes_nothing(void)
{
    for (uint32_t n = test_iterations(5); n > 0; --n) {
        soup mesh = three_cloths(5),
             seams = soup_make(3 * mesh.triangle_count, mesh.triangle_count);
        trace_scene s;
        sc_build_options options;
        sc_model *model = NULL;
        sc_trace_result trace;
        sc_triples_result r, other;
        for (uint32_t i = 0; i < 3 * mesh.triangle_count; ++i) {
            seams.triangles[i] = i;
            memcpy(seams.positions + 3 * (size_t)i, mesh.positions + 3 * (size_t)mesh.triangles[i],
                   3 * sizeof(double));
        }
        memset(&options, 0, sizeof options);
        options.struct_size = sizeof options;
        if (trace_scene_open(&s, mesh, SC_MODEL_FULL) &&
            find_triples(s.model, &s.pose, &s.result, NULL, &r)) {
            const sc_mesh m = input_plain_mesh(&seams);
            const sc_pose pose = input_plain_pose(seams.positions, seams.vertex_count);
            if (CHECK(sc_build(&m, &options, &model) == SC_OK)) {
                uint64_t count;
                sc_pair *pairs = trace_scene_find_pairs(model, &pose, &count);
                if (trace_scene_trace(model, &pose, pairs, count, NULL, &trace)) {
                    if (find_triples(model, &pose, &trace, NULL, &other)) {
                        CHECK(r.count == other.count);
                        for (uint64_t i = 0; i < r.count && i < other.count; ++i)
                            if (!CHECK(memcmp(r.triples[i].triangles, other.triples[i].triangles,
                                              sizeof r.triples[i].triangles) == 0))
                                break;
                        free(other.triples);
                    }
                    trace_scene_free_result(&trace);
                }
                free(pairs);
            }
            free(r.triples);
        }
        sc_model_free(model);
        soup_free(&seams);
        trace_scene_close(&s);
    }
}

/* A floor that meets all other triangles, which are crosses and stand in it. Half of these are
   upright, all corners as far back as each other: so are their points of three sheets, which means
   of two nodes may miss by a rounding, to either side. */
static void one_that_meets_all(void)
{
    const uint32_t crosses = 100;
    const double back = 1.7;
    soup mesh = soup_make(3 + 6 * crosses, 1 + 2 * crosses);
    trace_scene s;
    const double floor[9] = {-1, -1, 0, 3.0 * crosses, -1, 0, -1, 9, 0};
    memcpy(mesh.positions, floor, sizeof floor);
    for (uint32_t i = 0; i < 3 * mesh.triangle_count; ++i) mesh.triangles[i] = i;
    for (uint32_t i = 0; i < crosses; ++i) {
        const double x = i, shift = 0.0025 * i - 0.1;
        const double corners[18] = {
            x + 0.3,          back,       -1,   x + 0.27,  back,       1,
            x - 0.3,          back,       0.03, x + shift, back - 0.3, -1,
            x + shift + 0.03, back - 0.3, 1,    x - shift, back + 0.3, 0.03};
        memcpy(mesh.positions + 9 + 18 * (size_t)i, corners, sizeof corners);
    }
    if (trace_scene_open(&s, mesh, SC_MODEL_FULL)) {
        triple_tally sum = {0, 0};
        CHECK(check_triples(&s, &sum));
        CHECK_MSG(sum.triples == crosses, "%" PRIu64 " triples", sum.triples);
    }
    trace_scene_close(&s);
}

/* ---- what cannot be ---- */

static void failing_memory(void)
{
    trace_scene s;
    sc_triples_result all;
    int is_done = 0;
    if (trace_scene_open(&s, three_cloths(8), SC_MODEL_FULL) &&
        find_triples(s.model, &s.pose, &s.result, NULL, &all) && CHECK(all.count > 100)) {
        for (uint32_t cancels = 0; cancels < 2; ++cancels) {
            is_done = 0;
            for (uint32_t times = 0; !is_done && times < 100; ++times) {
                sc_trace_options options;
                sc_triples_result r = all;
                scarce_memory memory;
                sc_status status;
                memset(&options, 0, sizeof options);
                options.struct_size = sizeof options;
                scarce_memory_start(&memory, times);
                memory.cancels = (int)cancels;
                options.allocator = &memory.allocator;
                if (cancels) options.cancel = &memory.cancelled;
                status = sc_trace_triples(s.model, &s.pose, &s.result, &options, &r);
                is_done = status == SC_OK;
                CHECK(is_done ? r.count == all.count
                              : status == (cancels ? SC_ERROR_INCOMPLETE : SC_ERROR_MEMORY) &&
                                    !r.count);
                CHECK(!is_done || times >= 4); /* before it looks at triangles */
                CHECK(memory.live == 0);
            }
            CHECK(is_done);
        }
        free(all.triples);
    }
    trace_scene_close(&s);
}

/* A copy of a trace, with one change made to it. */
typedef struct changed_trace {
    sc_trace_result result;
    sc_trace_node *nodes;
    sc_trace_contour *contours;
} changed_trace;

static changed_trace copy_trace(const sc_trace_result *r)
{
    changed_trace c;
    c.result = *r;
    c.nodes = (sc_trace_node *)test_allocate((size_t)r->node_count * sizeof *c.nodes);
    c.contours = (sc_trace_contour *)test_allocate((size_t)r->contour_count * sizeof *c.contours);
    memcpy(c.nodes, r->nodes, (size_t)r->node_count * sizeof *c.nodes);
    memcpy(c.contours, r->contours, (size_t)r->contour_count * sizeof *c.contours);
    c.result.nodes = c.nodes;
    c.result.contours = c.contours;
    return c;
}

static void free_changed(changed_trace *c)
{
    free(c->nodes);
    free(c->contours);
}

/* The status for a trace that was changed, which is none of a mesh. */
static void expect(const trace_scene *s, changed_trace *c, sc_status expected)
{
    sc_triples_result r;
    sc_status status;
    memset(&r, 0, sizeof r);
    r.struct_size = sizeof r;
    r.count = 7;
    status = sc_trace_triples(s->model, &s->pose, &c->result, NULL, &r);
    CHECK_MSG(status == expected && !r.count, "%s", sc_status_string(status));
    free_changed(c);
}

/* The first contour of so many nodes and more. */
static uint64_t contour_of(const trace_scene *s, uint64_t nodes)
{
    uint64_t i = 0;
    while (i + 1 < s->result.contour_count && s->result.contours[i].count < nodes) ++i;
    CHECK(s->result.contours[i].count >= nodes);
    return i;
}

/* A triangle that has one vertex with the first triangle in common. */
static uint32_t one_that_touches(const trace_scene *s)
{
    for (uint32_t t = 1; t < s->mesh.triangle_count; ++t) {
        uint32_t shared = 0;
        for (int k = 0; k < 3; ++k)
            shared += (uint32_t)has_vertex(corners_of(s, t), s->mesh.triangles[k]);
        if (shared == 1) return t;
    }
    return 0;
}

static void wrong_traces(void)
{
    trace_scene s;
    if (trace_scene_open(&s, three_cloths(8), SC_MODEL_FULL)) {
        const uint64_t which = contour_of(&s, 3);
        const uint64_t at = s.result.contours[which].first;
        const uint32_t triangles = s.mesh.triangle_count;
        const uint32_t *sheets = s.result.nodes[at].sheets;
        changed_trace c;
        for (int i = 0; i < 2; ++i) {
            c = copy_trace(&s.result);
            c.nodes[at].sheets[i] = triangles;
            expect(&s, &c, SC_ERROR_PAIRS);
            c = copy_trace(&s.result);
            c.nodes[at].sheets[i] = sheets[!i];
            expect(&s, &c, SC_ERROR_PAIRS);
            c = copy_trace(&s.result);
            c.nodes[at + (uint64_t)i].edge = 3 * triangles;
            expect(&s, &c, SC_ERROR_PAIRS);
            c = copy_trace(&s.result);
            c.nodes[at + (uint64_t)i].triangle = triangles;
            expect(&s, &c, SC_ERROR_PAIRS);
            c = copy_trace(&s.result);
            c.nodes[at + (uint64_t)i].edge = SC_TRACE_NO_EDGE;
            expect(&s, &c, SC_ERROR_PAIRS);
            for (int k = 0; k < 3; ++k) {
                c = copy_trace(&s.result);
                c.nodes[at + (uint64_t)i].point[k] = i ? (double)NAN : (double)INFINITY;
                expect(&s, &c, SC_ERROR_NOT_FINITE);
            }
        }
        for (uint32_t edge = 0; edge < 3; ++edge) { /* of a triangle with a vertex of the other */
            const uint32_t *corner = s.mesh.triangles, other = one_that_touches(&s);
            if (!has_vertex(corners_of(&s, other), corner[edge]) &&
                !has_vertex(corners_of(&s, other), corner[(edge + 1) % 3]))
                continue;
            c = copy_trace(&s.result);
            c.nodes[at].edge = c.nodes[at + 1].edge = edge;
            c.nodes[at].triangle = c.nodes[at + 1].triangle = other;
            c.nodes[at].sheets[0] = 0;
            c.nodes[at].sheets[1] = other;
            c.contours[0].first = at;
            c.contours[0].count = 2;
            c.contours[0].begin = c.contours[0].end = SC_TRACE_BORDER;
            c.result.contour_count = 1;
            expect(&s, &c, SC_ERROR_PAIRS);
        }
        c = copy_trace(&s.result);
        c.contours[which].first = s.result.node_count + 1;
        expect(&s, &c, SC_ERROR_PAIRS);
        c = copy_trace(&s.result);
        c.contours[which].count = s.result.node_count + 1;
        expect(&s, &c, SC_ERROR_PAIRS);
        c = copy_trace(&s.result); /* one twice */
        c.contours[0] = c.contours[1];
        expect(&s, &c, SC_ERROR_PAIRS);
        c = copy_trace(&s.result);
        c.result.node_capacity = c.result.node_count - 1;
        expect(&s, &c, SC_ERROR_SHORT_BUFFER);
        c = copy_trace(&s.result);
        c.result.contour_capacity = c.result.contour_count - 1;
        expect(&s, &c, SC_ERROR_SHORT_BUFFER);
        c = copy_trace(&s.result);
        c.result.node_count = c.result.node_capacity = UINT64_C(1) << 31;
        expect(&s, &c, SC_ERROR_COUNT);
        c = copy_trace(&s.result);
        c.result.contour_count = c.result.contour_capacity = UINT64_C(1) << 31;
        expect(&s, &c, SC_ERROR_COUNT);
    }
    trace_scene_close(&s);
}

/* An edge of a triangle that welding has made a line, whose two ends are one. */
static void edges_without_length(void)
{
    static const double positions[27] = {0,  0, 0, 8, 0, 0, 0,  8, 0, 1,  1, -2, 3, 1,
                                         -2, 2, 2, 2, 1, 1, -2, 1, 1, -2, 2, 2,  2};
    soup mesh = soup_make(9, 3);
    sc_build_options options;
    sc_model *model = NULL;
    sc_mesh m;
    sc_pose pose;
    memcpy(mesh.positions, positions, sizeof positions);
    for (uint32_t i = 0; i < 9; ++i) mesh.triangles[i] = i;
    memset(&options, 0, sizeof options);
    options.struct_size = sizeof options;
    options.weld = SC_WELD_REST;
    m = input_plain_mesh(&mesh);
    pose = input_plain_pose(mesh.positions, mesh.vertex_count);
    if (CHECK(sc_build(&m, &options, &model) == SC_OK)) {
        static const sc_pair pairs[] = {{4, 0}, {5, 0}};
        sc_trace_result trace;
        sc_triples_result r;
        memset(&r, 0, sizeof r);
        r.struct_size = sizeof r;
        if (trace_scene_trace(model, &pose, pairs, 2, NULL, &trace)) {
            sc_trace_node *node = &trace.nodes[0];
            CHECK(node->triangle == 0 && node->sheets[0] + node->sheets[1] == 1);
            CHECK(sc_trace_triples(model, &pose, &trace, NULL, &r) == SC_OK);
            node->edge = 6; /* from vertex 3 to itself */
            CHECK(sc_trace_triples(model, &pose, &trace, NULL, &r) == SC_ERROR_PAIRS);
            node->edge = 4;
            node->sheets[0] = 2;
            CHECK(sc_trace_triples(model, &pose, &trace, NULL, &r) == SC_ERROR_PAIRS);
            trace_scene_free_result(&trace);
        }
    }
    sc_model_free(model);
    soup_free(&mesh);
}

static void wrong_arguments(void)
{
    trace_scene s;
    sc_triples_result all;
    if (trace_scene_open(&s, three_cloths(6), SC_MODEL_FULL) &&
        find_triples(s.model, &s.pose, &s.result, NULL, &all) && CHECK(all.count > 1)) {
        sc_triples_result r = all;
        sc_trace_result trace = s.result;
        double *bad = soup_copy_positions(&s.mesh);
        sc_pose pose = input_plain_pose(bad, s.mesh.vertex_count);
        CHECK(sc_trace_triples(NULL, &s.pose, &trace, NULL, &r) == SC_ERROR_NULL && !r.count);
        CHECK(sc_trace_triples(s.model, NULL, &trace, NULL, &r) == SC_ERROR_NULL);
        CHECK(sc_trace_triples(s.model, &s.pose, NULL, NULL, &r) == SC_ERROR_NULL);
        CHECK(sc_trace_triples(s.model, &s.pose, &trace, NULL, NULL) == SC_ERROR_NULL);
        r.triples = NULL;
        CHECK(sc_trace_triples(s.model, &s.pose, &trace, NULL, &r) == SC_ERROR_NULL);
        r = all;
        r.struct_size = (uint32_t)sizeof(void *);
        CHECK(sc_trace_triples(s.model, &s.pose, &trace, NULL, &r) == SC_ERROR_STRUCT_SIZE);
        r = all;
        trace.struct_size = (uint32_t)sizeof(void *);
        CHECK(sc_trace_triples(s.model, &s.pose, &trace, NULL, &r) == SC_ERROR_STRUCT_SIZE);
        trace = s.result;
        trace.nodes = NULL;
        CHECK(sc_trace_triples(s.model, &s.pose, &trace, NULL, &r) == SC_ERROR_NULL);
        trace = s.result;
        r.reserved = 5;
        --r.capacity;
        memset(r.triples, 0xa5, (size_t)all.count * sizeof *r.triples);
        CHECK(sc_trace_triples(s.model, &s.pose, &trace, NULL, &r) == SC_ERROR_SHORT_BUFFER &&
              r.count == all.count && !r.reserved);
        for (size_t i = 0; i < (size_t)all.count * sizeof *r.triples; ++i)
            if (!CHECK(((const unsigned char *)r.triples)[i] == 0xa5)) break;
        --pose.vertex_count;
        CHECK(sc_trace_triples(s.model, &pose, &trace, NULL, &r) == SC_ERROR_VERTEX_COUNT);
        pose = input_plain_pose(bad, s.mesh.vertex_count);
        bad[3 * (size_t)corners_of(&s, trace.nodes[0].sheets[0])[1] + 2] = (double)NAN;
        CHECK(sc_trace_triples(s.model, &pose, &trace, NULL, &r) == SC_ERROR_NOT_FINITE &&
              !r.count);
        trace.node_count = trace.contour_count = 0;
        trace.nodes = NULL;
        trace.contours = NULL;
        CHECK(sc_trace_triples(s.model, &s.pose, &trace, NULL, &r) == SC_OK && !r.count);
        free(bad);
        free(all.triples);
    }
    trace_scene_close(&s);
}

SC_TEST_MAIN(SC_TEST(sides_are_those_of_polynomials), SC_TEST(sides_nearly_in_planes),
             SC_TEST(minors_are_added_up), SC_TEST(soups), SC_TEST(meshes),
             SC_TEST(planes_through_a_line), SC_TEST(equal_sheets),
             SC_TEST(contours_leave_what_they_enter), SC_TEST(welding_changes_nothing),
             SC_TEST(one_that_meets_all), SC_TEST(failing_memory), SC_TEST(wrong_traces),
             SC_TEST(edges_without_length), SC_TEST(wrong_arguments))
