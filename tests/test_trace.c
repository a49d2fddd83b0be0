/*
 * Contours of intersections: signs of points that have moved a little, against the oracle's
 * polynomials; contours, against a checker that has the oracle's crossings and knows nothing of how
 * contours were followed, on soups, meshes of every kind and adversaries; and arguments that cannot
 * be.
 *
 * SPDX-License-Identifier: MIT
 */
#include <float.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "adversaries.h"
#include "base/perturbed.h"
#include "harness.h"
#include "inputs.h"
#include "soups.h"
#include "starcontour.h"
#include "tasks.h"
#include "trace_oracle.h"
#include "trace_scene.h"

/* ---- signs ---- */

/* Four points of a small grid, often the same or in a plane, or far out. */
static void draw_points(double p[4][3])
{
    const uint32_t range = 1 + test_random_below(4);
    const double size = test_random_below(4) ? 1 : ldexp(1, (int)test_random_below(600) - 300);
    for (int i = 0; i < 12; ++i) p[i / 3][i % 3] = size * test_random_below(range);
}

static void signs_are_those_of_polynomials(void)
{
    uint32_t zero = 0;
    for (uint32_t n = test_iterations(3000); n > 0; --n) {
        double p[4][3];
        const double *points[4];
        uint32_t numbers[4];
        uint64_t fallbacks = 0;
        int sign, expected;
        draw_points(p);
        for (int i = 0; i < 4; ++i) {
            int is_new = 0;
            points[i] = p[i];
            while (!is_new) {
                numbers[i] = test_random_below(2) ? test_random_below(9) : (uint32_t)test_random();
                is_new = 1;
                for (int j = 0; j < i; ++j) is_new &= numbers[j] != numbers[i];
            }
        }
        expected = trace_oracle_sign(points, numbers);
        sign = sc_perturbed_orient3d(points, numbers, &fallbacks);
        zero += fallbacks > 0;
        if (!CHECK_MSG(sign == expected, "%d, not %d", sign, expected)) return;
    }
    CHECK_MSG(zero > 0 || !test_is_full(), "none was in a plane");
}

/* ---- contours ---- */

/* A scene and what the library says of it. */
typedef struct traced {
    uint32_t triangle_count;
    uint32_t *triangles;     /* after welding */
    const double *positions; /* 3 a vertex */
    sc_pair *pairs;
    uint64_t pair_count;
    sc_trace_result result;
    trace_oracle_answer truth;
} traced;

static int is_same_result(const sc_trace_result *a, const sc_trace_result *b)
{
    return a->node_count == b->node_count && a->contour_count == b->contour_count &&
           (!a->node_count ||
            memcmp(a->nodes, b->nodes, (size_t)a->node_count * sizeof *a->nodes) == 0) &&
           (!a->contour_count ||
            memcmp(a->contours, b->contours, (size_t)a->contour_count * sizeof *a->contours) == 0);
}

static int has_vertex(const uint32_t *corner, uint32_t v)
{
    return corner[0] == v || corner[1] == v || corner[2] == v;
}

static const uint32_t *corners(const traced *t, uint32_t triangle)
{
    return t->triangles + 3 * (size_t)triangle;
}

/* The oracle's edge of this name, or NULL. */
static const trace_oracle_edge *edge_named(const traced *t, uint32_t name)
{
    uint32_t low = 0, high = t->truth.edge_count;
    while (low < high) {
        const uint32_t middle = (low + high) / 2;
        if (t->truth.edges[middle].name < name)
            low = middle + 1;
        else
            high = middle;
    }
    return low < t->truth.edge_count && t->truth.edges[low].name == name ? &t->truth.edges[low]
                                                                         : NULL;
}

static int edge_has(const trace_oracle_edge *edge, uint32_t triangle)
{
    for (uint32_t i = 0; i < edge->count; ++i)
        if (edge->triangles[i] == triangle) return 1;
    return 0;
}

/* Which of the oracle's crossings a node is; counts it in seen. */
static int is_crossing(const traced *t, const sc_trace_node *node, uint32_t *seen)
{
    for (uint32_t i = 0; i < t->truth.crossing_count; ++i)
        if (t->truth.edges[t->truth.crossings[i].edge].name == node->edge &&
            t->truth.crossings[i].triangle == node->triangle) {
            ++seen[i];
            return 1;
        }
    return 0;
}

/* Whether a node is on the segment of two triangles: its edge is of one, and it crosses the other,
   or it is their vertex. *sheet: on which the edge is. */
static int is_on_segment(const traced *t, const sc_trace_node *node, const uint32_t sheets[2],
                         int sheet)
{
    const trace_oracle_edge *edge;
    if (node->edge == SC_TRACE_NO_EDGE)
        return has_vertex(corners(t, sheets[0]), node->triangle) &&
               has_vertex(corners(t, sheets[1]), node->triangle);
    edge = edge_named(t, node->edge);
    return edge && edge_has(edge, sheets[sheet]) && sheets[1 - sheet] == node->triangle;
}

/* Where a node is: as accurate as is promised. */
static int is_placed(const traced *t, const sc_trace_node *node)
{
    const trace_oracle_edge *edge;
    const double *p[5];
    if (node->edge == SC_TRACE_NO_EDGE)
        return memcmp(node->point, t->positions + 3 * (size_t)node->triangle, sizeof node->point) ==
               0;
    edge = edge_named(t, node->edge);
    if (!edge) return 0;
    for (int i = 0; i < 5; ++i)
        p[i] =
            t->positions + 3 * (size_t)(i < 2 ? edge->ends[i] : corners(t, node->triangle)[i - 2]);
    return trace_oracle_is_placed(p, node->along, node->weights, node->point);
}

/* The first or the last node of a contour that is not closed. */
static int is_end(const traced *t, const sc_trace_node *node, uint32_t kind)
{
    const trace_oracle_edge *edge;
    if (kind == SC_TRACE_VERTEX) return node->edge == SC_TRACE_NO_EDGE;
    edge = node->edge == SC_TRACE_NO_EDGE ? NULL : edge_named(t, node->edge);
    return edge && (kind == SC_TRACE_BORDER ? edge->count == 1
                                            : kind == SC_TRACE_BRANCH && edge->count > 2);
}

/* Whether a contour goes on at a node as its edge says: the triangle that has it is another one,
   and the other sheet's the same. */
static int goes_on(const traced *t, const sc_trace_node *node, const uint32_t before[2],
                   const uint32_t behind[2])
{
    const trace_oracle_edge *edge = edge_named(t, node->edge);
    const int s = (int)node->sheet;
    return edge && edge->count == 2 && before[1 - s] == behind[1 - s] && before[s] != behind[s] &&
           edge_has(edge, before[s]) && edge_has(edge, behind[s]);
}

/* Segments that were met: no two of one pair of triangles. */
typedef struct segments {
    uint64_t count;
    sc_pair *list;
} segments;

static int compare_pairs(const void *a, const void *b)
{
    const sc_pair *p = (const sc_pair *)a, *q = (const sc_pair *)b;
    if (p->a != q->a) return p->a < q->a ? -1 : 1;
    return (p->b > q->b) - (p->b < q->b);
}

static void add_segment(segments *s, const uint32_t sheets[2])
{
    s->list[s->count].a = sheets[0] < sheets[1] ? sheets[0] : sheets[1];
    s->list[s->count++].b = sheets[0] < sheets[1] ? sheets[1] : sheets[0];
}

/* Lengths are the same bit for bit unless a square may leave the range of doubles. */
static int is_length(double found, double length, int is_plain)
{
    return CHECK_MSG(is_plain ? found == length : fabs(found - length) <= 1e-14 * length,
                     "%g, not %g", found, length);
}

static int check_contour(const traced *t, const sc_trace_contour *c, uint32_t *seen, segments *s)
{
    const sc_trace_node *node = t->result.nodes + c->first;
    const int is_closed = c->begin == SC_TRACE_CLOSED;
    const int is_one_sheet = c->flags == SC_TRACE_ONE_SHEET;
    double length = 0;
    int is_plain = 1;
    if (!CHECK(c->count >= 2 && c->first + c->count <= t->result.node_count) ||
        !CHECK((c->end == SC_TRACE_CLOSED) == is_closed && !c->reserved) ||
        !CHECK(c->flags == 0 || (is_closed && is_one_sheet)))
        return 0;
    if (!is_closed &&
        (!CHECK(is_end(t, node, c->begin)) || !CHECK(is_end(t, node + c->count - 1, c->end))))
        return 0;
    for (uint64_t i = 0; i < c->count; ++i) {
        const sc_trace_node *at = node + i, *next = node + (i + 1) % c->count;
        const int is_last = i + 1 == c->count, turned = is_last && is_one_sheet;
        const int sheet = turned ? 1 - (int)next->sheet : (int)next->sheet;
        if (!CHECK(at->sheet < 2 && next->sheet < 2 && !at->reserved) ||
            !CHECK_MSG(is_placed(t, at), "a node is not where it says"))
            return 0;
        if (at->edge != SC_TRACE_NO_EDGE && !CHECK(is_crossing(t, at, seen))) return 0;
        if (at->edge == SC_TRACE_NO_EDGE && !CHECK(!is_closed && (i == 0 || is_last))) return 0;
        if (is_last && !is_closed)
            return CHECK(at->sheets[0] == SC_TRACE_NO_EDGE && at->sheets[1] == SC_TRACE_NO_EDGE) &&
                   is_length(c->length, length, is_plain);
        if (!CHECK(at->sheets[0] < t->triangle_count && at->sheets[1] < t->triangle_count) ||
            !CHECK_MSG(is_on_segment(t, at, at->sheets, (int)at->sheet), "begins elsewhere") ||
            !CHECK_MSG(is_on_segment(t, next, at->sheets, sheet), "ends elsewhere"))
            return 0;
        add_segment(s, at->sheets);
        double square = 0, step = 0;
        for (int k = 0; k < 3; ++k) {
            square += pow(next->point[k] - at->point[k], 2);
            step = hypot(step, next->point[k] - at->point[k]);
        }
        if (step > 0 && !(square > 1e-250 && square < 1e250)) is_plain = 0;
        length += is_plain ? sqrt(square) : step;
        if (!is_last || is_closed) {
            const uint32_t behind[2] = {next->sheets[turned], next->sheets[!turned]};
            sc_trace_node n = *next;
            n.sheet = (uint32_t)sheet;
            if ((is_closed || i + 2 < c->count) && !CHECK(goes_on(t, &n, at->sheets, behind)))
                return 0;
        }
    }
    return is_length(c->length, length, is_plain);
}

/* Whether the contours are those of the oracle's crossings: each once, or once for each triangle of
   an edge where they branch; and each segment once. Not of vertices: these follow. */
static int check_contours(const traced *t)
{
    const sc_trace_result *r = &t->result;
    uint32_t *seen = (uint32_t *)calloc(t->truth.crossing_count + 1u, sizeof *seen);
    segments s;
    uint64_t ends = 0, branches = 0, at = 0;
    int is_right = 1;
    s.count = 0;
    s.list = (sc_pair *)test_allocate((size_t)r->node_count * sizeof *s.list);
    if (!seen) abort();
    for (uint64_t i = 0; i < r->contour_count && is_right; ++i) {
        const sc_trace_contour *c = &r->contours[i];
        is_right = CHECK(c->first == at) && check_contour(t, c, seen, &s);
        at += c->count;
        ends += (c->begin == SC_TRACE_VERTEX) + (uint64_t)(c->end == SC_TRACE_VERTEX);
    }
    for (uint32_t i = 0; i < t->truth.crossing_count && is_right; ++i) {
        const uint32_t count = t->truth.edges[t->truth.crossings[i].edge].count;
        branches += count;
        is_right =
            CHECK_MSG(seen[i] == (count == 2 ? 1 : count),
                      "crossing %u is in %u contours, edge of %u triangles", i, seen[i], count);
    }
    if (is_right) {
        is_right = CHECK(at == r->node_count) && CHECK(2 * s.count == branches + ends);
        qsort(s.list, (size_t)s.count, sizeof *s.list, compare_pairs);
        for (uint64_t i = 1; i < s.count && is_right; ++i)
            is_right = CHECK(compare_pairs(&s.list[i - 1], &s.list[i]) != 0);
    }
    free(s.list);
    free(seen);
    return is_right;
}

/* Whether all pairs of an edge and a triangle without a common vertex, most of which do not meet,
   give the same contours. */
static int check_all_pairs(const traced *t, const sc_model *model, const sc_pose *pose)
{
    const size_t room = (size_t)t->truth.edge_count * t->triangle_count;
    sc_pair *pairs = (sc_pair *)test_allocate(room * sizeof *pairs);
    sc_trace_result other;
    uint64_t count = 0;
    int is_right;
    for (uint32_t e = 0; e < t->truth.edge_count; ++e)
        for (uint32_t b = 0; b < t->triangle_count; ++b) {
            const trace_oracle_edge *edge = &t->truth.edges[e];
            if (has_vertex(corners(t, b), edge->ends[0]) ||
                has_vertex(corners(t, b), edge->ends[1]))
                continue;
            pairs[count].a = edge->name;
            pairs[count++].b = b;
        }
    is_right = trace_scene_trace(model, pose, pairs, count, NULL, &other);
    if (is_right) {
        is_right = CHECK_MSG(is_same_result(&t->result, &other), "other pairs change contours");
        trace_scene_free_result(&other);
    }
    free(pairs);
    return is_right;
}

/* Traces a mesh in a pose, in some way of building, and checks all. Adds up what was seen. */
typedef struct tally {
    uint64_t contours, closed, one_sheet, border, branch, vertex;
} tally;

static int check_mesh(const soup *mesh, const double *pose, uint32_t weld, uint32_t partition,
                      tally *sum)
{
    input_choices choices = input_choose(mesh, weld, partition);
    const sc_mesh m = input_plain_mesh(mesh);
    const sc_pose p = input_plain_pose(pose, mesh->vertex_count);
    uint32_t *map = input_weld_of(&choices, mesh);
    sc_model *model = NULL;
    traced t;
    int is_right = 0;
    memset(&t, 0, sizeof t);
    if (CHECK(sc_build(&m, &choices.options, &model) == SC_OK)) {
        t.triangle_count = mesh->triangle_count;
        t.triangles = (uint32_t *)test_allocate(3 * (size_t)t.triangle_count * sizeof(uint32_t));
        for (uint32_t i = 0; i < 3 * t.triangle_count; ++i)
            t.triangles[i] = map[mesh->triangles[i]];
        t.positions = pose;
        t.pairs = trace_scene_find_pairs(model, &p, &t.pair_count);
        t.truth = trace_oracle_find(t.triangles, t.triangle_count, pose);
        is_right = trace_scene_trace(model, &p, t.pairs, t.pair_count, NULL, &t.result) &&
                   check_contours(&t) && check_all_pairs(&t, model, &p);
        for (uint64_t i = 0; i < t.result.contour_count && is_right && sum; ++i) {
            const sc_trace_contour *c = &t.result.contours[i];
            ++sum->contours;
            sum->closed += c->begin == SC_TRACE_CLOSED;
            sum->one_sheet += c->flags == SC_TRACE_ONE_SHEET;
            sum->border += c->begin == SC_TRACE_BORDER;
            sum->branch += c->begin == SC_TRACE_BRANCH;
            sum->vertex += c->end == SC_TRACE_VERTEX;
        }
        trace_scene_free_result(&t.result);
        trace_oracle_free(&t.truth);
        free(t.pairs);
        free(t.triangles);
    }
    sc_model_free(model);
    free(map);
    input_free_choices(&choices);
    return is_right;
}

static void note_tally(const tally *sum)
{
    test_note("%" PRIu64 " contours: %" PRIu64 " closed, %" PRIu64 " from borders, %" PRIu64
              " from branches, %" PRIu64 " to vertices",
              sum->contours, sum->closed, sum->border, sum->branch, sum->vertex);
    CHECK(!test_is_full() || (sum->closed && sum->border && sum->branch && sum->vertex));
}

static uint32_t any_partition(void)
{
    return test_random_below(2) ? SC_PARTITION_FAST : SC_PARTITION_ORDER;
}

static void soups(void)
{
    tally sum;
    memset(&sum, 0, sizeof sum);
    for (uint32_t n = test_iterations(300); n > 0; --n) {
        const int is_grid = test_random_below(3) > 0;
        soup s = is_grid ? soup_on_grid(1 + test_random_below(6)) : soup_scattered();
        const int is_right =
            check_mesh(&s, s.positions, test_random_below(3), any_partition(), &sum);
        soup_free(&s);
        if (!is_right) return;
    }
    note_tally(&sum);
}

static void meshes(void)
{
    tally sum;
    memset(&sum, 0, sizeof sum);
    for (uint32_t n = test_iterations(60); n > 0; --n) {
        const char *name;
        soup s = soup_any_mesh(100, &name);
        double *pose = soup_copy_positions(&s);
        int is_right;
        soup_any_pose(pose, s.vertex_count);
        if (test_random_below(3) == 0) soup_snap(pose, s.vertex_count, 0.125);
        if (test_random_below(4) == 0)
            soup_scale(pose, s.vertex_count, ldexp(1, (int)test_random_below(1900) - 950));
        is_right = check_mesh(&s, pose, test_random_below(3), any_partition(), &sum);
        free(pose);
        soup_free(&s);
        if (!CHECK_MSG(is_right, "%s", name)) return;
    }
    note_tally(&sum);
}

/* Copies of a mesh, right on it: all is in a plane with all. */
static void equal_sheets(void)
{
    for (uint32_t n = test_iterations(20); n > 0; --n) {
        soup cloth = soup_cloth(1 + test_random_below(4), 1 + test_random_below(4));
        soup two = soup_join(&cloth, &cloth), three = soup_join(&two, &cloth);
        tally sum;
        int is_right;
        memset(&sum, 0, sizeof sum);
        is_right = check_mesh(&two, two.positions, SC_WELD_NONE, SC_PARTITION_FAST, &sum) &&
                   check_mesh(&three, three.positions, SC_WELD_NONE, SC_PARTITION_FAST, &sum);
        soup_free(&cloth);
        soup_free(&two);
        soup_free(&three);
        if (!is_right) return;
    }
}

static void adversaries(void)
{
    adversary (*const makers[])(void) = {adversary_slit,    adversary_strip,      adversary_petals,
                                         adversary_doubled, adversary_degenerate, adversary_moebius,
                                         adversary_klein,   adversary_book};
    tally sum;
    memset(&sum, 0, sizeof sum);
    for (uint32_t n = test_iterations(120); n > 0; --n) {
        adversary a = makers[n % (sizeof makers / sizeof *makers)]();
        double *pose;
        int is_right;
        for (uint32_t v = 0; v < a.mesh.vertex_count; ++v)
            if (a.twin[v] < a.mesh.vertex_count)
                memcpy(a.mesh.positions + 3 * (size_t)v, a.mesh.positions + 3 * (size_t)a.twin[v],
                       3 * sizeof(double));
        pose = soup_copy_positions(&a.mesh);
        is_right = check_mesh(&a.mesh, pose, SC_WELD_NONE, any_partition(), &sum);
        free(pose);
        adversary_free(&a);
        if (!is_right) return;
    }
    test_note("%" PRIu64 " contours", sum.contours);
}

static void strips_that_are_one(void)
{
    for (uint32_t turns = 0; turns < 6; ++turns)
        for (uint32_t n = test_iterations(5); n > 0; --n) {
            soup s = trace_scene_strips(20 + test_random_below(20), turns);
            tally sum;
            memset(&sum, 0, sizeof sum);
            if (check_mesh(&s, s.positions, SC_WELD_NONE, SC_PARTITION_FAST, &sum))
                CHECK_MSG(sum.contours == 1 && sum.closed == 1 && sum.one_sheet == turns % 2,
                          "%" PRIu64 " contours, %" PRIu64 " of one sheet after %u turns",
                          sum.contours, sum.one_sheet, turns);
            soup_free(&s);
        }
}

/* ---- what does not change contours ---- */

static void threads_change_nothing(void)
{
    soup mesh = trace_scene_cloths(80);
    trace_scene s;
    soup_snap(mesh.positions, mesh.vertex_count, 0x1p-8); /* some pairs that touch do not cross */
    if (trace_scene_open(&s, mesh, SC_MODEL_FULL)) {
        CHECK(s.count > s.result.node_count);
        CHECK_MSG(s.result.node_count > 500, "%" PRIu64 " nodes", s.result.node_count);
        for (int way = HOST_FIRST; way < HOST_COUNT; ++way)
            for (uint32_t workers = 1; workers <= 3; ++workers) {
                sc_trace_options options;
                sc_trace_result other;
                host h;
                memset(&options, 0, sizeof options);
                options.struct_size = sizeof options;
                host_start(&h, way, workers);
                options.tasks = &h.tasks;
                if (trace_scene_trace(s.model, &s.pose, s.pairs, s.count, &options, &other)) {
                    CHECK(is_same_result(&s.result, &other));
                    trace_scene_free_result(&other);
                }
                CHECK(!h.mistakes && (workers == 1 || h.parts > 0));
                host_stop(&h);
            }
    }
    trace_scene_close(&s);
}

/* Every instruction set, floats and doubles of the same values. */
static void instructions_change_nothing(void)
{
    for (uint32_t n = test_iterations(10); n > 0; --n) {
        soup mesh = trace_scene_cloths(5 + test_random_below(12));
        trace_scene s;
        soup_round_to_float(mesh.positions, mesh.vertex_count);
        if (test_random_below(2)) soup_snap(mesh.positions, mesh.vertex_count, 0x1p-5);
        if (trace_scene_open(&s, mesh, SC_MODEL_FULL))
            for (uint32_t simd = SC_SIMD_BASE; simd <= SC_SIMD_AVX512; ++simd)
                for (uint32_t floats = 0; floats < 2; ++floats) {
                    input_array positions =
                        input_positions(s.mesh.positions, s.mesh.vertex_count,
                                        floats ? SC_FLOAT : SC_DOUBLE, test_random_below(9));
                    const sc_pose pose = input_pose(s.mesh.vertex_count, &positions);
                    sc_trace_options options;
                    sc_trace_result other = trace_scene_no_room();
                    memset(&options, 0, sizeof options);
                    options.struct_size = sizeof options;
                    options.simd = simd;
                    if (sc_trace(s.model, &pose, s.pairs, s.count, &options, &other) ==
                        SC_ERROR_UNSUPPORTED) {
                        CHECK(simd != SC_SIMD_BASE);
                    } else if (trace_scene_trace(s.model, &pose, s.pairs, s.count, &options,
                                                 &other)) {
                        CHECK(is_same_result(&s.result, &other));
                        trace_scene_free_result(&other);
                    }
                    input_free(&positions);
                }
        trace_scene_close(&s);
    }
}

static void models_change_nothing(void)
{
    for (uint32_t n = test_iterations(10); n > 0; --n) {
        soup mesh = trace_scene_cloths(5 + test_random_below(10));
        trace_scene full, boxes;
        const int is_open = trace_scene_open(&full, soup_copy(&mesh), SC_MODEL_FULL);
        if (trace_scene_open(&boxes, mesh, SC_MODEL_BOXES) && is_open)
            CHECK(is_same_result(&full.result, &boxes.result));
        trace_scene_close(&full);
        trace_scene_close(&boxes);
    }
}

/* An order of things that sorts contours whatever their names: by length. */
static int compare_lengths(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Where nothing is in a plane, other numbers of vertices give the same contours. */
static void names_change_nothing(void)
{
    for (uint32_t n = test_iterations(10); n > 0; --n) {
        soup mesh = trace_scene_cloths(4 + test_random_below(8)), other = soup_copy(&mesh);
        const uint32_t count = mesh.vertex_count;
        uint32_t *name = (uint32_t *)test_allocate(count * sizeof *name);
        trace_scene a, b;
        int is_open;
        for (uint32_t v = 0; v < count; ++v) {
            const uint32_t w = test_random_below(v + 1);
            name[v] = name[w];
            name[w] = v;
        }
        for (uint32_t v = 0; v < count; ++v)
            memcpy(other.positions + 3 * (size_t)name[v], mesh.positions + 3 * (size_t)v,
                   3 * sizeof(double));
        for (uint32_t i = 0; i < 3 * mesh.triangle_count; ++i)
            other.triangles[i] = name[mesh.triangles[i]];
        free(name);
        is_open = trace_scene_open(&a, mesh, SC_MODEL_FULL);
        if (trace_scene_open(&b, other, SC_MODEL_FULL) && is_open &&
            CHECK(a.result.node_count == b.result.node_count &&
                  a.result.contour_count == b.result.contour_count)) {
            const uint64_t contours = a.result.contour_count;
            double *length = (double *)test_allocate((size_t)(2 * contours) * sizeof *length);
            for (uint64_t i = 0; i < contours; ++i) {
                length[i] = a.result.contours[i].length;
                length[contours + i] = b.result.contours[i].length;
            }
            qsort(length, (size_t)contours, sizeof *length, compare_lengths);
            qsort(length + contours, (size_t)contours, sizeof *length, compare_lengths);
            for (uint64_t i = 0; i < contours; ++i)
                if (!CHECK_MSG(fabs(length[i] - length[contours + i]) <= 1e-12 * length[i],
                               "%.17g and %.17g", length[i], length[contours + i]))
                    break;
            free(length);
        }
        trace_scene_close(&a);
        trace_scene_close(&b);
    }
}

/* ---- what cannot be ---- */

static void failing_memory(void)
{
    trace_scene s;
    int is_done = 0;
    if (trace_scene_open(&s, trace_scene_cloths(6), SC_MODEL_FULL))
        for (uint32_t times = 0; !is_done && times < 100; ++times) {
            sc_trace_options options;
            sc_trace_result r = s.result;
            scarce_memory memory;
            sc_status status;
            memset(&options, 0, sizeof options);
            options.struct_size = sizeof options;
            options.allocator = &memory.allocator;
            scarce_memory_start(&memory, times);
            status = sc_trace(s.model, &s.pose, s.pairs, s.count, &options, &r);
            is_done = status == SC_OK;
            CHECK(is_done ? r.node_count == s.result.node_count
                          : status == SC_ERROR_MEMORY && !r.node_count && !r.contour_count);
            CHECK(memory.live == 0);
        }
    CHECK(is_done);
    trace_scene_close(&s);
}

/* Cancelled by the allocator, each time it is called: so after each step. */
static void cancelling(void)
{
    trace_scene s;
    int is_done = 0;
    if (trace_scene_open(&s, trace_scene_cloths(6), SC_MODEL_FULL))
        for (uint32_t times = 0; !is_done && times < 100; ++times) {
            sc_trace_options options;
            sc_trace_result r = s.result;
            scarce_memory memory;
            sc_status status;
            memset(&options, 0, sizeof options);
            options.struct_size = sizeof options;
            scarce_memory_start(&memory, times);
            memory.cancels = 1;
            options.allocator = &memory.allocator;
            options.cancel = &memory.cancelled;
            status = sc_trace(s.model, &s.pose, s.pairs, s.count, &options, &r);
            is_done = !memory.cancelled;
            CHECK(is_done
                      ? status == SC_OK && is_same_result(&r, &s.result)
                      : status == SC_ERROR_INCOMPLETE && r.node_count == 0 && r.contour_count == 0);
            CHECK(memory.live == 0);
        }
    CHECK(is_done);
    trace_scene_close(&s);
}

/* The status of a trace of the first so many pairs. */
static sc_status try_pairs(const trace_scene *s, const sc_pair *pairs, uint64_t count)
{
    sc_trace_result r = s->result;
    const sc_status status = sc_trace(s->model, &s->pose, pairs, count, NULL, &r);
    CHECK(status == SC_OK || status == SC_ERROR_SHORT_BUFFER ||
          (!r.node_count && !r.contour_count));
    return status;
}

static void wrong_pairs(void)
{
    trace_scene s;
    if (trace_scene_open(&s, trace_scene_cloths(8), SC_MODEL_FULL) && CHECK(s.count > 8)) {
        sc_pair *pairs = (sc_pair *)test_allocate((size_t)(s.count + 1) * sizeof *pairs);
        for (uint64_t left_out = 0; left_out < s.count; ++left_out) {
            memcpy(pairs, s.pairs, (size_t)left_out * sizeof *pairs);
            memcpy(pairs + left_out, s.pairs + left_out + 1,
                   (size_t)(s.count - left_out - 1) * sizeof *pairs);
            CHECK(try_pairs(&s, pairs, s.count - 1) == SC_ERROR_PAIRS);
        }
        memcpy(pairs, s.pairs, (size_t)s.count * sizeof *pairs);
        pairs[3] = s.pairs[4];
        pairs[4] = s.pairs[3];
        CHECK(try_pairs(&s, pairs, s.count) == SC_ERROR_PAIRS);
        pairs[3] = s.pairs[4];
        pairs[4] = s.pairs[4];
        CHECK(try_pairs(&s, pairs, s.count) == SC_ERROR_PAIRS);
        memcpy(pairs, s.pairs, (size_t)s.count * sizeof *pairs);
        pairs[s.count - 1].b = s.mesh.triangle_count;
        CHECK(try_pairs(&s, pairs, s.count) == SC_ERROR_PAIRS);
        pairs[s.count - 1].a = 3 * s.mesh.triangle_count;
        pairs[s.count - 1].b = 0;
        CHECK(try_pairs(&s, pairs, s.count) == SC_ERROR_PAIRS);
        CHECK(try_pairs(&s, NULL, 0) == SC_OK);
        free(pairs);
    }
    trace_scene_close(&s);
}

/* Triangles with corners on a moment curve: none in a plane with another. */
static soup triangles_of(const uint32_t *corners, uint32_t count, uint32_t vertices)
{
    soup s = soup_make(vertices, count);
    memcpy(s.triangles, corners, 3 * (size_t)count * sizeof *corners);
    for (uint32_t v = 0; v < vertices; ++v)
        for (int k = 0; k < 3; ++k) s.positions[3 * (size_t)v + (size_t)k] = pow(v + 1, k + 1);
    return s;
}

/* Edges that end at a corner of the triangle, which sc_query does not pair with it. */
static void pairs_that_share_vertices(void)
{
    static const uint32_t corners[9] = {0, 1, 2, 0, 3, 4, 5, 1, 6};
    static const sc_pair pairs[] = {{0, 0}, {0, 1}, {0, 2}, {1, 0}, {2, 1}, {3, 0}, {7, 0}};
    static const sc_pair apart[] = {{0, 3}, {1, 1}};
    trace_scene s;
    if (trace_scene_open(&s, triangles_of(corners, 3, 7), SC_MODEL_FULL)) {
        for (size_t i = 0; i < sizeof pairs / sizeof *pairs; ++i)
            CHECK(try_pairs(&s, pairs + i, 1) == SC_ERROR_PAIRS);
        CHECK(try_pairs(&s, apart, 1) == SC_ERROR_PAIRS); /* there is no triangle 3 */
        CHECK(try_pairs(&s, apart + 1, 1) == SC_OK);
    }
    trace_scene_close(&s);
}

/* An upright triangle through a lying one: two crossings. Of a third welding makes a line from one
   point of the first to another: its edges, and what passes through it, change nothing. */
static void collapsed_triangles(void)
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
        static const sc_pair right[] = {{4, 0}, {5, 0}};
        static const sc_pair more[] = {{0, 2}, {1, 2}, {4, 0}, {5, 0}, {6, 0}};
        sc_trace_result a, b;
        if (trace_scene_trace(model, &pose, right, 2, NULL, &a)) {
            CHECK(a.node_count == 2 && a.contour_count == 1);
            if (trace_scene_trace(model, &pose, more, 5, NULL, &b)) {
                CHECK(is_same_result(&a, &b));
                trace_scene_free_result(&b);
            }
            trace_scene_free_result(&a);
        }
    }
    sc_model_free(model);
    soup_free(&mesh);
}

/* An edge of 2^16 triangles and another triangle 2^15 times, each of which it crosses. */
static void too_many_branches(void)
{
    const uint32_t fan = 1u << 16, crossed = 1u << 15;
    static const double positions[18] = {1, 1, -1, 1, 1, 1, 9, 9, 0, 0, 0, 0, 4, 0, 0, 0, 4, 0};
    soup mesh = soup_make(6, fan + crossed);
    sc_pair *pairs = (sc_pair *)test_allocate(crossed * sizeof *pairs);
    sc_build_options options;
    sc_model *model = NULL;
    sc_mesh m;
    sc_pose pose;
    memcpy(mesh.positions, positions, sizeof positions);
    for (uint32_t i = 0; i < 3 * mesh.triangle_count; ++i)
        mesh.triangles[i] = i % 3 + (i < 3 * fan ? 0 : 3);
    for (uint32_t i = 0; i < crossed; ++i) {
        pairs[i].a = 0;
        pairs[i].b = fan + i;
    }
    memset(&options, 0, sizeof options);
    options.struct_size = sizeof options;
    options.weld = SC_WELD_NONE;
    options.content = SC_MODEL_BOXES;
    m = input_plain_mesh(&mesh);
    pose = input_plain_pose(mesh.positions, mesh.vertex_count);
    if (CHECK(sc_build(&m, &options, &model) == SC_OK)) {
        sc_trace_result r = trace_scene_no_room();
        CHECK(sc_trace(model, &pose, pairs, crossed, NULL, &r) == SC_ERROR_COUNT);
        CHECK(r.node_count == 0 && r.contour_count == 0);
        /* two of them are not too many, but other ends are missing */
        CHECK(sc_trace(model, &pose, pairs, 2, NULL, &r) == SC_ERROR_PAIRS);
    }
    sc_model_free(model);
    free(pairs);
    soup_free(&mesh);
}

static void wrong_arguments(void)
{
    trace_scene s;
    if (trace_scene_open(&s, trace_scene_cloths(8), SC_MODEL_FULL)) {
        sc_trace_result r = s.result;
        sc_trace_options options;
        sc_pose pose = s.pose;
        volatile uint32_t flag = 1;
        sc_allocator allocator;
        sc_tasks tasks;
        double *bad;
        memset(&options, 0, sizeof options);
        options.struct_size = sizeof options;
        CHECK(sc_trace(NULL, &s.pose, s.pairs, s.count, NULL, &r) == SC_ERROR_NULL &&
              !r.node_count && !r.contour_count);
        CHECK(sc_trace(s.model, NULL, s.pairs, s.count, NULL, &r) == SC_ERROR_NULL);
        CHECK(sc_trace(s.model, &s.pose, NULL, s.count, NULL, &r) == SC_ERROR_NULL);
        CHECK(sc_trace(s.model, &s.pose, s.pairs, s.count, NULL, NULL) == SC_ERROR_NULL);
        CHECK(sc_trace(s.model, &s.pose, s.pairs, UINT64_C(1) << 31, NULL, &r) == SC_ERROR_COUNT);
        r.nodes = NULL;
        CHECK(sc_trace(s.model, &s.pose, s.pairs, s.count, NULL, &r) == SC_ERROR_NULL);
        r = s.result;
        r.contours = NULL;
        CHECK(sc_trace(s.model, &s.pose, s.pairs, s.count, NULL, &r) == SC_ERROR_NULL);
        r = s.result;
        r.struct_size = 8;
        CHECK(sc_trace(s.model, &s.pose, s.pairs, s.count, NULL, &r) == SC_ERROR_STRUCT_SIZE);
        r = s.result;
        --r.node_capacity;
        CHECK(sc_trace(s.model, &s.pose, s.pairs, s.count, NULL, &r) == SC_ERROR_SHORT_BUFFER &&
              r.node_count == s.result.node_count && r.contour_count == s.result.contour_count);
        r = s.result;
        --r.contour_capacity;
        CHECK(sc_trace(s.model, &s.pose, s.pairs, s.count, NULL, &r) == SC_ERROR_SHORT_BUFFER &&
              r.node_count == s.result.node_count && r.contour_count == s.result.contour_count);
        r = s.result;
        options.simd = SC_SIMD_AVX512 + 1;
        CHECK(sc_trace(s.model, &s.pose, s.pairs, s.count, &options, &r) == SC_ERROR_OPTION);
        options.simd = SC_SIMD_BEST;
        options.struct_size = 4;
        CHECK(sc_trace(s.model, &s.pose, s.pairs, s.count, &options, &r) == SC_ERROR_STRUCT_SIZE);
        options.struct_size = sizeof options;
        options.cancel = &flag;
        CHECK(sc_trace(s.model, &s.pose, s.pairs, s.count, &options, &r) == SC_ERROR_INCOMPLETE &&
              r.node_count == 0);
        options.cancel = NULL;
        memset(&allocator, 0, sizeof allocator);
        options.allocator = &allocator;
        CHECK(sc_trace(s.model, &s.pose, s.pairs, s.count, &options, &r) == SC_ERROR_NULL);
        options.allocator = NULL;
        memset(&tasks, 0, sizeof tasks);
        tasks.struct_size = 4;
        options.tasks = &tasks;
        CHECK(sc_trace(s.model, &s.pose, s.pairs, s.count, &options, &r) == SC_ERROR_STRUCT_SIZE);
        --pose.vertex_count;
        CHECK(sc_trace(s.model, &pose, s.pairs, s.count, NULL, &r) == SC_ERROR_VERTEX_COUNT);
        bad = soup_copy_positions(&s.mesh);
        for (uint32_t i = 0; i < 3 * s.mesh.vertex_count; ++i) bad[i] = (double)NAN;
        pose = input_plain_pose(bad, s.mesh.vertex_count);
        CHECK(sc_trace(s.model, &pose, s.pairs, s.count, NULL, &r) == SC_ERROR_NOT_FINITE);
        CHECK(sc_trace(s.model, &pose, s.pairs, 3, NULL, &r) == SC_ERROR_NOT_FINITE);
        free(bad);
    }
    trace_scene_close(&s);
}

SC_TEST_MAIN(SC_TEST(signs_are_those_of_polynomials), SC_TEST(soups), SC_TEST(meshes),
             SC_TEST(equal_sheets), SC_TEST(adversaries), SC_TEST(strips_that_are_one),
             SC_TEST(threads_change_nothing), SC_TEST(instructions_change_nothing),
             SC_TEST(models_change_nothing), SC_TEST(names_change_nothing), SC_TEST(failing_memory),
             SC_TEST(cancelling), SC_TEST(wrong_pairs), SC_TEST(pairs_that_share_vertices),
             SC_TEST(collapsed_triangles), SC_TEST(too_many_branches), SC_TEST(wrong_arguments))
