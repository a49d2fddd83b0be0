/*
 * Pairs of a step at two times: closest points as sc_near_stencils has them, where the vertex
 * began, whether the two approach, and the normal between them; and what is refused.
 *
 * SPDX-License-Identifier: MIT
 */
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "harness.h"
#include "soups.h"
#include "starcontour.h"

/* Two triangles without a common vertex that move: vertex 0 and face 1, edge 0 and edge 3. */
typedef struct pair {
    double ends[2][6][3];
    sc_pose poses[2];
    sc_model *model;
    sc_pair faces, edges;
} pair;

static int open_pair(pair *p)
{
    static const uint32_t triangles[6] = {0, 1, 2, 3, 4, 5};
    sc_build_options options;
    sc_mesh mesh;
    double rest[18];
    memset(p, 0, sizeof *p);
    for (int i = 0; i < 18; ++i) rest[i] = test_random_unit();
    memset(&mesh, 0, sizeof mesh);
    mesh.struct_size = sizeof mesh;
    mesh.vertex_count = 6;
    mesh.triangle_count = 2;
    mesh.position_type = SC_DOUBLE;
    mesh.index_type = SC_UINT32;
    mesh.positions = rest;
    mesh.indices = triangles;
    memset(&options, 0, sizeof options);
    options.struct_size = sizeof options;
    options.weld = SC_WELD_NONE;
    for (int end = 0; end < 2; ++end) {
        p->poses[end].struct_size = sizeof(sc_pose);
        p->poses[end].vertex_count = 6;
        p->poses[end].position_type = SC_DOUBLE;
        p->poses[end].positions = p->ends[end];
    }
    p->faces.b = 1;
    p->edges.b = 3;
    return CHECK(sc_build(&mesh, &options, &p->model) == SC_OK);
}

/* Anywhere; on a grid, where much touches and is parallel. */
static void draw_motion(pair *p, int on_grid)
{
    for (int end = 0; end < 2; ++end)
        for (int i = 0; i < 6; ++i)
            for (int k = 0; k < 3; ++k)
                p->ends[end][i][k] =
                    on_grid ? (double)test_random_below(3) : test_random_range(-1, 1);
}

static sc_step_stencil ask(const pair *p, uint32_t kind, double time)
{
    sc_step_stencil s;
    memset(&s, 0xff, sizeof s);
    CHECK(sc_step_stencils(p->model, &p->poses[0], &p->poses[1], kind,
                           kind == SC_NEAR_VERTEX_FACE ? &p->faces : &p->edges, &time, 1,
                           &s) == SC_OK);
    return s;
}

/* The stencil at a time of the step. */
static sc_near_stencil near_at(const pair *p, uint32_t kind, double t)
{
    double at[6][3];
    sc_near_stencil s;
    sc_pose pose = p->poses[0];
    for (int i = 0; i < 6; ++i)
        for (int k = 0; k < 3; ++k) at[i][k] = (1 - t) * p->ends[0][i][k] + t * p->ends[1][i][k];
    memset(&s, 0, sizeof s);
    pose.positions = at;
    CHECK(sc_near_stencils(p->model, &pose, kind,
                           kind == SC_NEAR_VERTEX_FACE ? &p->faces : &p->edges, 1, &s) == SC_OK);
    return s;
}

static int same(const sc_near_stencil *a, const sc_near_stencil *b)
{
    return a->feature == b->feature && a->flags == b->flags && a->distance == b->distance &&
           !memcmp(a->vertices, b->vertices, sizeof a->vertices) &&
           !memcmp(a->weights, b->weights, sizeof a->weights) &&
           !memcmp(a->vector, b->vector, sizeof a->vector);
}

/* (q - p) . ((b - a) x (d - c)), exact on a small grid. */
static double triple(const double *p, const double *q, const double *a, const double *b,
                     const double *c, const double *d)
{
    double sum = 0;
    for (int k = 0; k < 3; ++k) {
        const int x = (k + 1) % 3, y = (k + 2) % 3;
        sum += (q[k] - p[k]) * ((b[x] - a[x]) * (d[y] - c[y]) - (b[y] - a[y]) * (d[x] - c[x]));
    }
    return sum;
}

static int sign(double x)
{
    return (x > 0) - (x < 0);
}

/* The normal where both times have no vector: away from a, across what both span. */
static void check_normal(const pair *p, uint32_t kind, const sc_step_stencil *s)
{
    const double *v = s->impact.distance > 0 ? s->impact.vector : s->start.vector;
    const double(*at)[3] = p->ends[0];
    const double distance = s->impact.distance > 0 ? s->impact.distance : s->start.distance;
    double length = 0, along = 0;
    for (int k = 0; k < 3; ++k) length += s->normal[k] * s->normal[k];
    if (s->flags & SC_STEP_NO_NORMAL) {
        CHECK(length == 0 && distance == 0 && s->side == 0);
        return;
    }
    CHECK(fabs(length - 1) < 1e-14);
    for (int k = 0; k < 3; ++k) along += s->normal[k] * v[k];
    if (distance > 0) {
        CHECK(fabs(along - distance) <= 1e-14 * distance);
    } else if (kind == SC_NEAR_VERTEX_FACE) {
        const double side = triple(at[3], at[0], at[3], at[4], at[3], at[5]);
        double from = 0, across = 0;
        for (int k = 0; k < 3; ++k) {
            from += s->normal[k] * (at[3][k] - at[0][k]);
            across += s->normal[k] * (at[4][k] - at[3][k]);
        }
        CHECK(side != 0 && from > 0 && fabs(across) < 1e-14);
    } else {
        double from = 0;
        for (int k = 0; k < 3; ++k) from += s->normal[k] * (at[3][k] - at[0][k]);
        CHECK(from > 0);
    }
}

static void any_motion(void)
{
    uint64_t approaching = 0, leaving = 0, sides = 0, none = 0;
    pair p;
    if (!open_pair(&p)) return;
    for (uint32_t trial = test_iterations(20000); trial-- > 0 && !test_failures();) {
        const uint32_t kind = 1 + trial % 2;
        const int on_grid = trial % 3 == 0;
        const double time = trial % 5 == 0 ? 0 : trial % 5 == 1 ? 1 : test_random_unit();
        sc_near_stencil first, then, soon;
        sc_step_stencil s;
        double rate, side;
        draw_motion(&p, on_grid);
        s = ask(&p, kind, time);
        first = near_at(&p, kind, 0);
        then = near_at(&p, kind, time);
        CHECK(same(&s.start, &first) && same(&s.impact, &then) && s.time == time);
        side = kind == SC_NEAR_VERTEX_FACE ? triple(p.ends[0][3], p.ends[0][0], p.ends[0][3],
                                                    p.ends[0][4], p.ends[0][3], p.ends[0][5])
                                           : triple(p.ends[0][0], p.ends[0][3], p.ends[0][0],
                                                    p.ends[0][1], p.ends[0][3], p.ends[0][4]);
        if (on_grid || fabs(side) > 1e-10) CHECK(s.side == sign(side));
        sides += s.side != 0;
        check_normal(&p, kind, &s);
        none += (s.flags & SC_STEP_NO_NORMAL) != 0;
        /* by finite differences, where the closest feature stays; a grid has several as near */
        soon = near_at(&p, kind, 1e-6);
        rate = (soon.distance - first.distance) / 1e-6;
        if (!(first.distance > 0))
            CHECK(s.flags & SC_STEP_APPROACHES);
        else if (!on_grid && fabs(rate) > 1e-3 && soon.feature == first.feature &&
                 first.distance > 1e-3)
            CHECK(!(s.flags & SC_STEP_APPROACHES) == (rate > 0));
        approaching += (s.flags & SC_STEP_APPROACHES) != 0;
        leaving += !(s.flags & SC_STEP_APPROACHES);
    }
    CHECK(approaching > 100 && leaving > 100 && sides > 100 && none > 10);
    sc_model_free(p.model);
}

/* Two that touch at both times: the normal is across them, away from where a began. */
static void touching_at_both_times(void)
{
    static const double face[6][3] = {{1, 1, 0}, {9, 9, 9}, {8, 8, 8},
                                      {0, 0, 0}, {4, 0, 0}, {0, 4, 0}};
    pair p;
    sc_step_stencil s;
    if (!open_pair(&p)) return;
    memcpy(p.ends[0], face, sizeof face);
    memcpy(p.ends[1], face, sizeof face);
    s = ask(&p, SC_NEAR_VERTEX_FACE, 1);
    CHECK(s.side == 0 && s.flags == (SC_STEP_APPROACHES | SC_STEP_NO_NORMAL));
    p.ends[0][0][2] = 0.5; /* it began above, and its closest point is inside */
    s = ask(&p, SC_NEAR_VERTEX_FACE, 1);
    CHECK(s.side == 1 && s.flags == SC_STEP_APPROACHES && s.normal[2] == -1);
    CHECK(s.start.distance == 0.5 && s.impact.distance == 0);
    p.ends[0][0][2] = -0.5;
    s = ask(&p, SC_NEAR_VERTEX_FACE, 1);
    CHECK(s.side == -1 && s.normal[2] == 1);
    for (int side = -1; side < 2; side += 2) { /* by a quarter of the smallest double: none */
        memcpy(p.ends[0], face, sizeof face);
        p.ends[0][4][2] = side * -0x1p-1074;
        s = ask(&p, SC_NEAR_VERTEX_FACE, 1);
        CHECK(s.side == side && s.flags == SC_STEP_APPROACHES && s.start.distance == 0);
        CHECK(s.normal[2] == -side && fabs(s.normal[0]) + fabs(s.normal[1]) < 0x1p-900);
    }
    sc_model_free(p.model);
}

/* Two that are farther apart than a double can say: the vector has no direction, and the normal is
   across both, from a to b. */
static void distances_out_of_range(void)
{
    pair p;
    if (!open_pair(&p)) return;
    for (int i = 0; i < 4; ++i) {
        const double up = i < 2 ? 0x1p1023 : -0x1p1023;
        const double at[6][3] = {{0x1p1000, 0x1p1000, up}, {0x1p1002, 0x1p1000, up},  {0, 0, up},
                                 {0x1p1001, 0, -up},       {0x1p1001, 0x1p1003, -up}, {0, 0, -up}};
        sc_step_stencil s;
        memcpy(p.ends[0], at, sizeof at);
        memcpy(p.ends[1], at, sizeof at);
        s = ask(&p, i % 2 ? SC_NEAR_VERTEX_FACE : SC_NEAR_EDGE_EDGE, 0.5);
        CHECK(s.start.distance == HUGE_VAL && s.impact.distance == HUGE_VAL);
        CHECK(!(s.flags & SC_STEP_NO_NORMAL) && fabs(s.normal[0]) < 1e-14 &&
              fabs(s.normal[1]) < 1e-14 && s.normal[2] == (up > 0 ? -1 : 1));
    }
    sc_model_free(p.model);
}

/* A vertex far from a small face, as no double can say, both on a diagonal through the origin: the
   normal is along it, also where they are near at the start. They approach as they change places,
   and do not as they move on. */
static void points_out_of_range(void)
{
    const double far = 0x1.8p1023;
    pair p;
    sc_step_stencil s;
    if (!open_pair(&p)) return;
    memset(p.ends, 0, sizeof p.ends);
    for (int k = 0; k < 3; ++k) {
        p.ends[0][0][k] = far;
        p.ends[0][3 + k][k] = p.ends[1][3 + k][k] = 1; /* the face, */
        for (int i = 3; i < 6; ++i) {
            p.ends[0][i][k] -= far; /* which rounds to one point, */
            p.ends[1][i][k] += far;
        }
        p.ends[1][0][k] = -far;
    }
    for (int at_end = 0; at_end < 2; ++at_end) {
        const double wanted = at_end ? sqrt(1 / 3.0) : -sqrt(1 / 3.0);
        s = ask(&p, SC_NEAR_VERTEX_FACE, at_end);
        CHECK(s.start.distance == HUGE_VAL && s.impact.distance == HUGE_VAL && s.side == 0);
        CHECK(s.flags == SC_STEP_APPROACHES);
        for (int k = 0; k < 3; ++k) CHECK(fabs(s.normal[k] - wanted) < 1e-14);
    }
    for (int i = 0; i < 18; ++i) p.ends[0][i / 3][i % 3] = 0.75 * p.ends[1][i / 3][i % 3];
    s = ask(&p, SC_NEAR_VERTEX_FACE, 1);
    CHECK(s.flags == 0 && s.start.distance == HUGE_VAL);
    memset(p.ends[0], 0, sizeof p.ends[0]); /* near at the start, along z */
    p.ends[0][0][2] = 1;
    s = ask(&p, SC_NEAR_VERTEX_FACE, 1);
    CHECK(s.start.distance == 1);
    for (int k = 0; k < 3; ++k) CHECK(fabs(s.normal[k] - sqrt(1 / 3.0)) < 1e-14);
    sc_model_free(p.model);
}

/* Edges that cross at less than half of the smallest double, so that they touch: the normal is
   across both, though it would not be so by products of rounded differences, as the edges are
   almost parallel, or these are infinite. */
static void touching_edges_almost_parallel(void)
{
    const double tiny = 0x1p-1074, far = 0x1.8p1023, u = 0x1p-54;
    const double edges[2][4][3] = {
        /* across a at a third of b, and 3/2 2^-54 (1, 1, 0) times all but nothing along z */
        {{-0.5, -0.5, 0}, {1, 1 - 2 * u, 0}, {-0.5 + u, -0.5, 0}, {1, 1, tiny}},
        {{-far, 0, 0}, {far, 0, 0}, {0, -0.25, 0}, {0, 0.75, tiny}},
    };
    pair p;
    if (!open_pair(&p)) return;
    for (int i = 0; i < 8; ++i) {
        const double(*e)[3] = edges[i % 2];
        const int turn = i / 2 % 2, mirror = i / 4;
        sc_step_stencil s;
        memset(p.ends, 0, sizeof p.ends);
        memcpy(p.ends[0][0], e[turn], sizeof e[0]);
        memcpy(p.ends[0][1], e[!turn], sizeof e[0]);
        memcpy(p.ends[0][3], e[2], sizeof e[0]);
        memcpy(p.ends[0][4], e[3], sizeof e[0]);
        for (int k = 0; k < 6; ++k) p.ends[0][k][2] *= mirror ? -1 : 1;
        memcpy(p.ends[1], p.ends[0], sizeof p.ends[0]);
        s = ask(&p, SC_NEAR_EDGE_EDGE, 1);
        CHECK(s.start.distance == 0 && s.side != 0 && s.flags == SC_STEP_APPROACHES);
        CHECK_MSG(s.normal[2] == (mirror ? -1 : 1) && fabs(s.normal[0]) < 0x1p-900 &&
                      fabs(s.normal[1]) < 0x1p-900,
                  "%d: %g %g %g", i, s.normal[0], s.normal[1], s.normal[2]);
    }
    sc_model_free(p.model);
}

/* Edges of a few of the smallest doubles, less than half of one apart: so the distance is 0, and
   the normal that of both edges, of coordinates as whole numbers. */
static void edges_of_the_smallest_doubles(void)
{
    uint32_t found = 0;
    pair p;
    if (!open_pair(&p)) return;
    for (uint32_t trial = test_iterations_at_least(20000, 4000); trial-- > 0;) {
        double at[6][3], e[3], f[3], n[3], length = 0;
        sc_step_stencil s;
        for (int i = 0; i < 18; ++i) at[i / 3][i % 3] = (double)test_random_below(13) - 6;
        for (int i = 0; i < 18; ++i) {
            const double tiny = ldexp(at[i / 3][i % 3], -1074);
            p.ends[0][i / 3][i % 3] = p.ends[1][i / 3][i % 3] = tiny;
        }
        s = ask(&p, SC_NEAR_EDGE_EDGE, 0);
        if (s.start.distance > 0 || !s.side) continue;
        for (int k = 0; k < 3; ++k) {
            e[k] = at[1][k] - at[0][k];
            f[k] = at[4][k] - at[3][k];
        }
        for (int k = 0; k < 3; ++k) {
            const int x = (k + 1) % 3, y = (k + 2) % 3;
            n[k] = s.side * (e[x] * f[y] - e[y] * f[x]);
            length += n[k] * n[k];
        }
        for (int k = 0; k < 3; ++k)
            CHECK_MSG(fabs(s.normal[k] - n[k] / sqrt(length)) < 1e-14, "%g, not %g", s.normal[k],
                      n[k] / sqrt(length));
        ++found;
    }
    CHECK(found > 10);
    sc_model_free(p.model);
}

static void wrong_arguments(void)
{
    sc_step_stencil s;
    double time = 0.5;
    sc_pair wrong = {0, 0};
    pair p;
    const sc_pose *from = &p.poses[0], *to = &p.poses[1];
    if (!open_pair(&p)) return;
    draw_motion(&p, 0);
    CHECK(sc_step_stencils(NULL, from, to, 1, &p.faces, &time, 1, &s) == SC_ERROR_NULL);
    CHECK(sc_step_stencils(p.model, NULL, to, 1, &p.faces, &time, 1, &s) == SC_ERROR_NULL);
    CHECK(sc_step_stencils(p.model, from, NULL, 1, &p.faces, &time, 1, &s) == SC_ERROR_NULL);
    CHECK(sc_step_stencils(p.model, from, to, 1, NULL, &time, 1, &s) == SC_ERROR_NULL);
    CHECK(sc_step_stencils(p.model, from, to, 1, &p.faces, &time, 1, NULL) == SC_ERROR_NULL);
    CHECK(sc_step_stencils(p.model, from, to, 1, NULL, NULL, 0, NULL) == SC_OK);
    CHECK(sc_step_stencils(p.model, from, to, 0, &p.faces, &time, 1, &s) == SC_ERROR_OPTION);
    CHECK(sc_step_stencils(p.model, from, to, 3, &p.faces, &time, 1, &s) == SC_ERROR_OPTION);
    CHECK(sc_step_stencils(p.model, from, to, 1, &wrong, &time, 1, &s) == SC_ERROR_PAIRS);
    CHECK(sc_step_stencils(p.model, from, to, 1, &p.faces, NULL, 1, &s) == SC_OK && s.time == 0);
    time = 1.5;
    CHECK(sc_step_stencils(p.model, from, to, 1, &p.faces, &time, 1, &s) == SC_ERROR_OPTION);
    time = -DBL_MIN;
    CHECK(sc_step_stencils(p.model, from, to, 1, &p.faces, &time, 1, &s) == SC_ERROR_OPTION);
    time = (double)NAN;
    CHECK(sc_step_stencils(p.model, from, to, 1, &p.faces, &time, 1, &s) == SC_ERROR_OPTION);
    time = 0.5;
    p.poses[0].vertex_count = 5;
    CHECK(sc_step_stencils(p.model, from, to, 1, &p.faces, &time, 1, &s) == SC_ERROR_VERTEX_COUNT);
    p.poses[0].vertex_count = p.poses[1].vertex_count;
    p.ends[1][3][0] = (double)NAN;
    CHECK(sc_step_stencils(p.model, from, to, 1, &p.faces, &time, 1, &s) == SC_ERROR_NOT_FINITE);
    p.poses[1].vertex_count = 5;
    CHECK(sc_step_stencils(p.model, from, to, 1, &p.faces, &time, 1, &s) == SC_ERROR_VERTEX_COUNT);
    sc_model_free(p.model);
}

SC_TEST_MAIN(SC_TEST(any_motion), SC_TEST(touching_at_both_times), SC_TEST(distances_out_of_range),
             SC_TEST(points_out_of_range), SC_TEST(touching_edges_almost_parallel),
             SC_TEST(edges_of_the_smallest_doubles), SC_TEST(wrong_arguments))
