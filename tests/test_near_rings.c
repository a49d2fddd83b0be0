/*
 * Contours where pairs are left out that are near on the mesh: nothing wanted is lost, in what is
 * near and in steps, on sheets with slits, hairpins, holes and low triangles, where contours come
 * as near to themselves as is allowed. The tree of boxes, which knows no contours, is what answers
 * are compared with.
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
#include "soups.h"
#include "starcontour.h"

enum { SIDE_MAX = 40 };

/* A sheet in which cells lie in rows, with what is torn open between them. */
typedef struct sheet {
    uint32_t across, along;
    uint32_t point[2][SIDE_MAX + 1][SIDE_MAX + 1]; /* as seen from the cells before and behind */
    soup mesh;                                     /* how far slits move a point is its z */
    double
        middle[2 * (SIDE_MAX + 1) * (SIDE_MAX + 1)]; /* 1: in the middle of a slit, 0: at an end */
} sheet;

/* A slit between columns of cells, from one row of points to another, open by so much. */
typedef struct slit {
    uint32_t column, from, to;
    double gap, reach;
} slit;

/* Points of a grid, each twice where a slit is: its ends, unless at the border, are not torn. */
static void make_sheet(sheet *s, uint32_t across, uint32_t along, const slit *slits, uint32_t count)
{
    const int mixed = test_random_below(4) == 0; /* diagonals go either way */
    uint32_t x, y, i, points = 0, triangles = 0;
    s->across = across;
    s->along = along;
    s->mesh = soup_make(2 * (across + 1) * (along + 1), 2 * across * along);
    for (y = 0; y <= along; ++y)
        for (x = 0; x <= across; ++x) {
            int torn = 0;
            double shift = 0, middle = 0;
            for (i = 0; i < count; ++i) {
                const slit *t = &slits[i];
                const double off = (double)x - t->column;
                const int inside = (y > t->from || t->from == 0) && (y < t->to || t->to == along);
                torn |= x == t->column && inside && t->from <= y && y <= t->to;
                if (off >= 0 && inside) {
                    shift += t->gap * exp(-off / t->reach);
                    middle = 1 - fabs(2.0 * (y - t->from) / (t->to - t->from) - 1);
                }
            }
            for (i = 0; i < 2; ++i) {
                double *p = s->mesh.positions + 3 * (size_t)points;
                if (i && !torn) {
                    s->point[1][x][y] = s->point[0][x][y];
                    continue;
                }
                p[0] = (double)x;
                p[1] = (double)y;
                p[2] = i || !torn ? shift : 0;
                s->middle[points] = middle;
                s->point[i][x][y] = points++;
            }
        }
    for (y = 0; y < along; ++y)
        for (x = 0; x < across; ++x) {
            const uint32_t a = s->point[1][x][y], b = s->point[0][x + 1][y];
            const uint32_t c = s->point[0][x + 1][y + 1], d = s->point[1][x][y + 1];
            const int other = mixed && test_random_below(2);
            const uint32_t corner[6] = {a, b, other ? d : c, other ? b : a, c, d};
            memcpy(s->mesh.triangles + 3 * (size_t)triangles, corner, sizeof corner);
            triangles += 2;
        }
    s->mesh.vertex_count = points;
}

/* Leaves some triangles out. */
static void make_holes(soup *mesh, uint32_t one_in)
{
    uint32_t t, kept = 0;
    for (t = 0; t < mesh->triangle_count; ++t) {
        if (test_random_below(one_in) == 0 && kept + mesh->triangle_count - t > 3) continue;
        memmove(mesh->triangles + 3 * (size_t)kept++, mesh->triangles + 3 * (size_t)t,
                3 * sizeof *mesh->triangles);
    }
    mesh->triangle_count = kept;
}

static void torn_sheet(sheet *s)
{
    const uint32_t across = 3 + test_random_below(9), along = 3 + test_random_below(9);
    const uint32_t count = test_random_below(4);
    slit slits[3];
    for (uint32_t i = 0; i < count; ++i) {
        slit *t = &slits[i];
        t->column = 1 + test_random_below(across - 1);
        t->from = test_random_below(3) ? test_random_below(along - 1) : 0;
        t->to = t->from + 1 + test_random_below(7);
        if (t->to > along) t->to = along;
        t->gap = test_random_range(0.05, 2);
        t->reach = test_random_below(2) ? 1e9 : test_random_range(2, 8);
    }
    make_sheet(s, across, along, slits, count);
    if (test_random_below(4) == 0) make_holes(&s->mesh, 10 + test_random_below(40));
}

/* With cells that are low across a short slit or two: so many rings that the lips of one are near
   along the contour, but what is behind them is not near on the mesh. */
static void slit_sheet(sheet *s, uint32_t *rings)
{
    const uint32_t across = 6 + test_random_below(8), along = 3 + test_random_below(8);
    slit slits[2];
    const uint32_t count = test_random_below(4) ? 1 : 2;
    for (uint32_t i = 0; i < count; ++i) {
        slit *t = &slits[i];
        t->column = 2 + test_random_below(across - 3);
        t->from = 1 + test_random_below(along - 2);
        t->to = t->from + 1 + test_random_below(along - 1 - t->from);
        *rings = t->to - t->from + 1 + test_random_below(3);
        t->gap = test_random_range(0.02, test_random_below(2) ? 2 : 5);
        t->reach = 1e9;
    }
    make_sheet(s, across, along, slits, count);
}

/* The same with one slit, which is widest near its ends: there the contour is open, while what is
   behind the lips between comes near. */
static void pinched_sheet(sheet *s, uint32_t *rings)
{
    const uint32_t length = test_random_below(2) ? 4 : 6;
    slit t;
    t.column = 4 + test_random_below(3);
    t.from = 1 + test_random_below(2);
    t.to = t.from + length;
    t.gap = test_random_range(1.5, 4);
    t.reach = 1e9;
    *rings = length + 1;
    make_sheet(s, 10, 9, &t, 1);
}

/* Triangles that share nothing, one in each cell of a row or two. */
static soup scattered_triangles(void)
{
    const uint32_t count = 2 + test_random_below(8);
    soup mesh = soup_make(3 * count, count);
    for (uint32_t i = 0; i < count; ++i) {
        double *p = mesh.positions + 9 * (size_t)i, area;
        for (uint32_t k = 0; k < 9; ++k) p[k] = k % 3 == 2 ? 0 : test_random_range(0, 1);
        area = (p[3] - p[0]) * (p[7] - p[1]) - (p[4] - p[1]) * (p[6] - p[0]);
        for (uint32_t k = 0; k < 3; ++k) {
            mesh.triangles[3 * i + k] = 3 * i + (area > 0 ? k : 2 - k);
            p[3 * k] += i / 2;
            p[3 * k + 1] += i % 2;
        }
    }
    return mesh;
}

/* A strip that is wound up, or goes to and fro; between its windings are gaps. */
static soup wound_strip(void)
{
    const uint32_t wide = 1 + test_random_below(3), along = 15 + test_random_below(35);
    const double gap = test_random_range(0.1, 1.5);
    const int hairpins = (int)test_random_below(2);
    const uint32_t leg = 2 + test_random_below(6);
    soup mesh = soup_make((wide + 1) * (along + 1), 2 * wide * along);
    double at[2] = {0, 0}, angle = 0;
    uint32_t i, k, n = 0;
    for (i = 0; i <= along; ++i) {
        const double radius = 0.7 + (double)wide / 2 + gap / 2;
        double turn = 1 / (2 + (double)wide + (wide + gap) * sqrt((double)i / 20));
        if (hairpins) turn = i % (leg + 4) < leg ? 0 : 1 / radius * (i / (leg + 4) % 2 ? 1 : -1);
        for (k = 0; k <= wide; ++k) {
            double *p = mesh.positions + 3 * (size_t)n++;
            p[0] = at[0] - sin(angle) * ((double)k - (double)wide / 2);
            p[1] = at[1] + cos(angle) * ((double)k - (double)wide / 2);
            p[2] = 0;
        }
        at[0] += cos(angle + turn / 2);
        at[1] += sin(angle + turn / 2);
        angle += turn;
    }
    for (n = i = 0; i < along; ++i)
        for (k = 0; k < wide; ++k) {
            const uint32_t a = i * (wide + 1) + k, b = a + wide + 1;
            const uint32_t corner[6] = {a, b, b + 1, a, b + 1, a + 1};
            memcpy(mesh.triangles + 3 * (size_t)n, corner, sizeof corner);
            n += 2;
        }
    return mesh;
}

/* A sheet in its plane, its slits open by a part of what they are to be, less in the middle. */
static void open_slits(double *positions, const sheet *s, double part, double pinch)
{
    for (uint32_t v = 0; v < s->mesh.vertex_count; ++v) {
        const double *p = s->mesh.positions + 3 * (size_t)v;
        positions[3 * (size_t)v] = p[0] + part * (1 - pinch * s->middle[v]) * p[2];
        positions[3 * (size_t)v + 1] = p[1];
        positions[3 * (size_t)v + 2] = 0;
    }
}

static void turn_about(double *positions, uint32_t count, int axis)
{
    const double angle = test_random_range(0, 6.3), c = cos(angle), d = sin(angle);
    for (uint32_t v = 0; v < count; ++v) {
        double *x = positions + 3 * (size_t)v + (axis + 1) % 3;
        double *y = positions + 3 * (size_t)v + (axis + 2) % 3;
        const double before = *x;
        *x = c * before - d * *y;
        *y = d * before + c * *y;
    }
}

/* Squeezes, shears, shakes, bends and turns. */
static void deform(double *positions, uint32_t count)
{
    const double squeeze = test_random_below(2) ? 1 : test_random_range(0.25, 1);
    const double shear = test_random_below(2) ? 0 : test_random_range(-0.7, 0.7);
    const double shake = test_random_below(2) ? 0 : test_random_range(0, 0.25);
    const double bend = test_random_below(2) ? 0 : test_random_range(0.01, 0.12);
    for (uint32_t v = 0; v < count; ++v) {
        double *p = positions + 3 * (size_t)v, angle;
        p[0] = p[0] * squeeze + test_random_range(-shake, shake);
        p[1] += shear * p[0] + test_random_range(-shake, shake);
        if (bend == 0) continue;
        angle = bend * p[1];
        p[2] = (1 - cos(angle)) / bend;
        p[1] = sin(angle) / bend;
    }
    if (test_random_below(2)) return; /* seen from where the tests of contours look, most often */
    for (int axis = 0; axis < 3; ++axis) turn_about(positions, count, axis);
}

/* Makes cells low, and says how low, less a part. */
static double squeeze(double *positions, uint32_t count)
{
    const double low =
        test_random_below(2) ? test_random_range(0.03, 0.1) : test_random_range(0.1, 0.4);
    for (uint32_t v = 0; v < count; ++v) positions[3 * (size_t)v] *= low;
    switch (test_random_below(4)) {
    case 0:
        return low * test_random_range(0.95, 1.6);
    case 1:
        return low * test_random_range(0.85, 0.99);
    default:
        return low * test_random_range(0.5, 0.9);
    }
}

/* What is asked of a mesh. */
typedef struct trial {
    soup mesh;
    double *start, *end;
    input_choices choices;
    sc_model *model;
    sc_workspace *workspace;
    sc_near_masks *masks;
    sc_filter filter[2];
    uint32_t rings; /* of masks */
    int filtered;
    uint32_t kinds;
    double distance;
    near_question q;
    sc_pose pose[2];
} trial;

typedef struct tally {
    uint64_t culled, wanted; /* of those where something was culled */
} tally;

/* So that contours begin anywhere. */
static void shuffle(soup *mesh)
{
    for (uint32_t i = mesh->triangle_count; i > 1; --i) {
        uint32_t *one = mesh->triangles + 3 * (size_t)(i - 1);
        uint32_t *other = mesh->triangles + 3 * (size_t)test_random_below(i);
        const uint32_t turn = test_random_below(3);
        uint32_t t[3];
        memcpy(t, one, sizeof t);
        memmove(one, other, sizeof t);
        for (uint32_t k = 0; k < 3; ++k) other[k] = t[(k + turn) % 3];
    }
}

static void open_trial(trial *t)
{
    sc_mesh input;
    const uint64_t state = test_random_state();
    static sheet s;
    memset(&s, 0, sizeof s);
    memset(t, 0, sizeof *t);
    t->rings = 1 + test_random_below(test_random_below(4) ? 5 : 12);
    switch (test_random_below(8)) {
    case 0:
        t->q.name = "wound strip";
        s.mesh = wound_strip();
        break;
    case 1:
    case 2:
        t->q.name = "triangles";
        s.mesh = scattered_triangles();
        t->rings = 5 + test_random_below(4);
        t->distance = test_random_range(0.01, 0.4);
        break;
    case 3:
        t->q.name = "torn sheet";
        torn_sheet(&s);
        break;
    case 4:
        t->q.name = "slit sheet";
        slit_sheet(&s, &t->rings);
        break;
    default:
        t->q.name = "slit sheet";
        pinched_sheet(&s, &t->rings);
        break;
    }
    t->mesh = s.mesh;
    if (test_random_below(2)) shuffle(&t->mesh);
    t->q.state = state;
    t->start = (double *)test_allocate(6 * (size_t)t->mesh.vertex_count * sizeof *t->start);
    t->end = t->start + 3 * (size_t)t->mesh.vertex_count;
    open_slits(t->start, &s, test_random_below(4) ? 1 : 0.01, test_random_below(2) ? 0.95 : 0);
    open_slits(t->end, &s, test_random_below(4) ? 1 : test_random_range(0, 0.3),
               test_random_below(2) ? 0.95 : 0);
    if (strcmp(t->q.name, "slit sheet") == 0)
        t->distance = squeeze(t->start, 2 * t->mesh.vertex_count) * (t->rings - 1);
    else
        deform(t->start, 2 * t->mesh.vertex_count);
    t->choices = input_choose(&t->mesh, 0, test_random_below(4));
    input = input_plain_mesh(&t->mesh);
    CHECK(sc_build(&input, &t->choices.options, &t->model) == SC_OK);
    t->workspace = near_workspace(t->model, 1);
    t->pose[0] = input_plain_pose(t->start, t->mesh.vertex_count);
    t->pose[1] = input_plain_pose(t->end, t->mesh.vertex_count);
    t->q.model = t->model;
    t->q.workspace = t->workspace;
    t->q.pose = &t->pose[0];
    t->filtered = (int)test_random_below(3);
    t->kinds = test_random_below(3) ? SC_NEAR_BOTH : 1 + test_random_below(2);
    if (t->distance == 0) t->distance = test_random_range(0.1, 0.3 + 0.5 * t->rings);
    for (int k = 0; k < 2; ++k) {
        t->filter[k].struct_size = sizeof t->filter[k];
        t->filter[k].ignore_rings = t->rings;
    }
    if (test_random_below(4) == 0)
        t->filter[test_random_below(2)].ignore_rings = test_random_below(t->rings + 1);
    CHECK(sc_near_masks_create(t->model, t->rings, NULL, &t->masks) == SC_OK);
}

static void close_trial(trial *t)
{
    sc_near_masks_free(t->masks);
    sc_workspace_free(t->workspace);
    sc_model_free(t->model);
    input_free_choices(&t->choices);
    soup_free(&t->mesh);
    free(t->start);
}

static sc_near_options options_of(const trial *t, const near_way *way)
{
    sc_near_options o = near_options_for(way, t->distance);
    o.kinds = t->kinds;
    if (t->filtered != 1) o.masks = t->masks;
    if (t->filtered) {
        o.vertex_face_filter = &t->filter[0];
        o.edge_edge_filter = &t->filter[1];
    }
    return o;
}

/* By the way that is taken if none is chosen, or by all. */
static void check_near(trial *t, int ways, tally *sum)
{
    sc_near_options o = options_of(t, &near_ways[0]);
    near_answer wanted;
    o.method = SC_NEAR_METHOD_BOXES;
    wanted = near_ask_all(&t->q, &o);
    for (int i = 0; i < ways; ++i) {
        near_answer found;
        if (!near_way_is_there(&near_ways[i], t->model, t->workspace, &t->pose[0])) continue;
        o = options_of(t, &near_ways[i]);
        found = near_ask_all(&t->q, &o);
        CHECK_MSG(near_answers_are_same(&wanted, &found),
                  "%s, %" PRIu32 " rings, %d, d %a: %" PRIu64 " and %" PRIu64
                  " pairs, by boxes %" PRIu64 " and %" PRIu64 "; state %" PRIu64,
                  near_ways[i].name, t->rings, t->filtered, t->distance, found.count[0],
                  found.count[1], wanted.count[0], wanted.count[1], t->q.state);
        if (i == 0 && found.stats.nodes_culled) {
            sum->culled += found.stats.nodes_culled;
            sum->wanted += wanted.count[0] + wanted.count[1];
        }
        near_answer_free(&found);
    }
    near_answer_free(&wanted);
}

static void contours_lose_nothing_near(void)
{
    tally sum = {0, 0};
    for (uint32_t i = test_iterations_at_least(2000, 300); i-- > 0 && !test_failures();) {
        trial t;
        open_trial(&t);
        check_near(&t, i % 8 ? 1 : NEAR_WAYS, &sum);
        close_trial(&t);
    }
    CHECK_MSG(sum.culled > 500 && sum.wanted > 1000, "%" PRIu64 " nodes culled, %" PRIu64 " pairs",
              sum.culled, sum.wanted);
}

/* Both lists of a step, by a method. */
typedef struct step_answer {
    sc_step_result result;
    sc_stats stats;
    sc_pair *pairs[2];
} step_answer;

static step_answer ask_step(const trial *t, uint32_t method)
{
    sc_step_options o;
    step_answer a;
    memset(&a, 0, sizeof a);
    memset(&o, 0, sizeof o);
    o.struct_size = sizeof o;
    o.method = method;
    o.separation = t->distance;
    o.vertex_face_filter = &t->filter[0];
    o.edge_edge_filter = &t->filter[1];
    a.stats.struct_size = sizeof a.stats;
    for (int round = 0; round < 2; ++round) {
        const sc_step_result known = a.result;
        memset(&a.result, 0, sizeof a.result);
        a.result.struct_size = sizeof a.result;
        a.result.stats = &a.stats;
        if (round) {
            a.pairs[0] = (sc_pair *)test_allocate((known.vertex_face_count + 1) * sizeof(sc_pair));
            a.pairs[1] = (sc_pair *)test_allocate((known.edge_edge_count + 1) * sizeof(sc_pair));
            a.result.vertex_faces = a.pairs[0];
            a.result.vertex_face_capacity = known.vertex_face_count;
            a.result.edge_edges = a.pairs[1];
            a.result.edge_edge_capacity = known.edge_edge_count;
        }
        const sc_status status =
            sc_query_step(t->model, t->workspace, &t->pose[0], &t->pose[1], &o, &a.result);
        CHECK(status == SC_OK || (!round && status == SC_ERROR_SHORT_BUFFER));
    }
    return a;
}

static int is_same_step(const step_answer *a, const step_answer *b)
{
    const sc_step_result *r = &a->result, *s = &b->result;
    return r->vertex_face_count == s->vertex_face_count &&
           r->edge_edge_count == s->edge_edge_count && r->earliest == s->earliest &&
           !memcmp(a->pairs[0], b->pairs[0], r->vertex_face_count * sizeof(sc_pair)) &&
           !memcmp(a->pairs[1], b->pairs[1], r->edge_edge_count * sizeof(sc_pair));
}

static void free_step(step_answer *a)
{
    free(a->pairs[0]);
    free(a->pairs[1]);
}

static void contours_lose_nothing_in_steps(void)
{
    tally sum = {0, 0};
    for (uint32_t i = test_iterations_at_least(1000, 100); i-- > 0 && !test_failures();) {
        step_answer boxes, found;
        trial t;
        open_trial(&t);
        boxes = ask_step(&t, SC_STEP_METHOD_TWO_BOXES);
        found = ask_step(&t, SC_STEP_METHOD_SCTT);
        CHECK_MSG(is_same_step(&boxes, &found),
                  "%" PRIu32 " and %" PRIu32 " rings, d %a: %" PRIu64 " and %" PRIu64
                  " pairs, by boxes %" PRIu64 " and %" PRIu64 "; state %" PRIu64,
                  t.filter[0].ignore_rings, t.filter[1].ignore_rings, t.distance,
                  found.result.vertex_face_count, found.result.edge_edge_count,
                  boxes.result.vertex_face_count, boxes.result.edge_edge_count, t.q.state);
        if (found.stats.nodes_culled) {
            sum.culled += found.stats.nodes_culled;
            sum.wanted += found.result.vertex_face_count + found.result.edge_edge_count;
        }
        free_step(&boxes);
        free_step(&found);
        close_trial(&t);
    }
    CHECK_MSG(sum.culled > 100 && sum.wanted > 100, "%" PRIu64 " nodes culled, %" PRIu64 " pairs",
              sum.culled, sum.wanted);
}

/* A flat sheet with a distance above the size of its cells is culled as a whole. */
static void flat_sheets_are_culled(void)
{
    static sheet s;
    sc_mesh input;
    trial t;
    make_sheet(&s, 40, 40, NULL, 0);
    input = input_plain_mesh(&s.mesh);
    memset(&t, 0, sizeof t);
    CHECK(sc_build(&input, NULL, &t.model) == SC_OK);
    t.workspace = near_workspace(t.model, 1);
    t.pose[0] = t.pose[1] = input_plain_pose(s.mesh.positions, s.mesh.vertex_count);
    t.q.name = "flat";
    t.q.model = t.model;
    t.q.workspace = t.workspace;
    t.q.pose = &t.pose[0];
    t.distance = 1.5;
    t.rings = 4;
    for (int k = 0; k < 2; ++k) {
        t.filter[k].struct_size = sizeof t.filter[k];
        t.filter[k].ignore_rings = t.rings;
    }
    CHECK(sc_near_masks_create(t.model, t.rings, NULL, &t.masks) == SC_OK);
    for (t.filtered = 0; t.filtered < 3; ++t.filtered) {
        const sc_near_options o = options_of(&t, &near_ways[0]);
        near_answer a = near_ask_all(&t.q, &o);
        CHECK(a.status == SC_OK && a.stats.nodes_culled == 1 && a.stats.leaf_pairs == 0);
        near_answer_free(&a);
    }
    step_answer a = ask_step(&t, SC_STEP_METHOD_SCTT);
    CHECK(a.stats.nodes_culled == 1 && a.stats.leaf_pairs == 0);
    free_step(&a);
    sc_near_masks_free(t.masks);
    sc_workspace_free(t.workspace);
    sc_model_free(t.model);
    soup_free(&s.mesh);
}

/* What was made of a pose for some rings is not taken for others, or for none. */
static void what_is_kept_is_for_its_rings(void)
{
    static const uint32_t rings[] = {8, 0, 8, 3, 0, 3};
    static sheet s;
    sc_mesh input;
    sc_model *model = NULL;
    sc_pose pose;
    sc_object object;
    sc_objects objects;
    make_sheet(&s, 20, 20, NULL, 0);
    input = input_plain_mesh(&s.mesh);
    s.mesh.positions[3 * (size_t)s.point[0][10][10]] += 0.9; /* low triangles, inside a patch */
    CHECK(sc_build(&input, NULL, &model) == SC_OK);
    pose = input_plain_pose(s.mesh.positions, s.mesh.vertex_count);
    memset(&object, 0, sizeof object);
    object.model = model;
    object.workspace = near_workspace(model, 1);
    object.pose = &pose;
    object.pose_version = 1;
    object.itself = 1;
    memset(&objects, 0, sizeof objects);
    objects.struct_size = sizeof objects;
    objects.count = 1;
    objects.objects = &object;
    for (size_t i = 0; i < sizeof rings / sizeof *rings; ++i) {
        sc_objects_lists found[2];
        sc_near_masks *masks = NULL;
        if (rings[i]) CHECK(sc_near_masks_create(model, rings[i], NULL, &masks) == SC_OK);
        object.masks = masks;
        for (uint32_t boxes = 0; boxes < 2; ++boxes) {
            sc_near_options o = near_options_for(&near_ways[0], 0.3);
            o.output = SC_OUTPUT_COUNT;
            if (boxes) o.method = SC_NEAR_METHOD_BOXES;
            memset(&found[boxes], 0, sizeof found[boxes]);
            found[boxes].struct_size = sizeof found[boxes];
            CHECK(sc_query_objects_near(&objects, &o, &found[boxes]) == SC_OK);
        }
        CHECK(found[0].vertex_faces.count == found[1].vertex_faces.count);
        CHECK(found[0].edge_edges.count == found[1].edge_edges.count);
        CHECK((found[0].edge_edges.count == 0) == (rings[i] > 0));
        sc_near_masks_free(masks);
    }
    sc_workspace_free(object.workspace);
    sc_model_free(model);
    soup_free(&s.mesh);
}

SC_TEST_MAIN(SC_TEST(contours_lose_nothing_near), SC_TEST(contours_lose_nothing_in_steps),
             SC_TEST(flat_sheets_are_culled), SC_TEST(what_is_kept_is_for_its_rings))
