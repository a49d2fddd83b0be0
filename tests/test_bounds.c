/*
 * Error bounds one by one, against exact rational arithmetic: edges of contours and rays,
 * projections, normals, floats that bound doubles, and signs, at numbers chosen so that rounding
 * does its worst.
 *
 * SPDX-License-Identifier: MIT
 */
#include <gmp.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#ifdef __SSE2__
#  include <xmmintrin.h>
#endif

#include "base/predicates.h"
#include "base/wide.h"
#include "harness.h"
#include "inputs.h"
#include "pose/contour_bounds.h"
#include "pose/dnc.h"
#include "pose/positions.h"
#include "posed_model.h"
#include "query/star.h"
#include "run/workspace.h"
#include "starcontour.h"

/* ================================================================================================
 * Single bounds, against rational numbers. A bound may be of any projection and any error of its
 * coordinates that holds: here it is the error itself, found exactly, so that no slack hides a
 * fault.
 */

/* A model whose contour is what a test wants: two segments of points, and one made of both. */
typedef struct bench {
    soup mesh;
    sc_model *real, *fake;
    sc_workspace *workspace;
    sc_projection projection;
    uint32_t *parts; /* the arrays of the fake model, behind it */
    double *pose;
} bench;

enum { LEFT_POINTS = 3, BENCH_POINTS = 6 }; /* points 0 1 2 and 2 3 4 of segments 0, 1; 5 */

static int open_bench(bench *b)
{
    static const uint32_t parts[] = {
        0, 2, 0,          /* segment_first */
        2, 4, 4,          /* segment_last */
        0, 1, 2, 3, 4, 3, /* points */
        0, 2,             /* segment_children */
        0, 1,             /* children */
        5, 1, 0, 1 /* contours: point, count of the first, segments */};
    sc_node *node;
    sc_mesh input;
    memset(b, 0, sizeof(*b));
    b->mesh = soup_cloth(5, 5);
    input = input_plain_mesh(&b->mesh);
    if (!CHECK(sc_build(&input, NULL, &b->real) == SC_OK) ||
        !CHECK(sc_workspace_create(b->real, NULL, &b->workspace) == SC_OK))
        return 0;
    if (!CHECK(b->real->segment_count >= 3 && b->mesh.vertex_count >= BENCH_POINTS)) return 0;
    b->fake = (sc_model *)test_allocate((size_t)b->real->bytes + sizeof(parts));
    memcpy(b->fake, b->real, (size_t)b->real->bytes);
    b->parts = (uint32_t *)(void *)((unsigned char *)b->fake + b->real->bytes);
    memcpy(b->parts, parts, sizeof(parts));
    b->fake->leaf_segment_count = 2;
    b->fake->segment_count = 3;
    b->fake->offset[SC_ARRAY_segment_first] = b->real->bytes;
    b->fake->offset[SC_ARRAY_segment_last] = b->real->bytes + 3 * sizeof(uint32_t);
    b->fake->offset[SC_ARRAY_points] = b->real->bytes + 6 * sizeof(uint32_t);
    b->fake->offset[SC_ARRAY_segment_children] = b->real->bytes + 12 * sizeof(uint32_t);
    b->fake->offset[SC_ARRAY_children] = b->real->bytes + 14 * sizeof(uint32_t);
    b->fake->offset[SC_ARRAY_contours] = b->real->bytes + 16 * sizeof(uint32_t);
    node = (sc_node *)(uintptr_t)sc_model_node(b->fake);
    node[0].contour = 0;
    node[0].kind = SC_NODE_TOUCHES;
    node[1].contour = 4;
    sc_workspace_begin(b->real, b->workspace, &posed_model_nothing_asked);
    b->pose = (double *)test_allocate(3 * b->mesh.vertex_count * sizeof(double));
    memcpy(b->pose, b->mesh.positions, 3 * b->mesh.vertex_count * sizeof(double));
    b->workspace->frame.positions[0].at = (const unsigned char *)b->pose;
    b->workspace->frame.positions[0].stride = 3 * sizeof(double);
    b->workspace->frame.positions[0].type = SC_DOUBLE;
    return 1;
}

static void close_bench(bench *b)
{
    sc_workspace_free(b->workspace);
    sc_model_free(b->real);
    free(b->fake);
    free(b->pose);
    soup_free(&b->mesh);
}

static double *bench_point(bench *b, uint32_t i)
{
    return b->pose + 3 * (size_t)i;
}

static double exact_error(const double v[3], const double *p, const double *origin, double computed)
{
    mpq_t exact, c;
    double error;
    mpq_inits(exact, c, NULL);
    posed_model_exact_dot(exact, v, p, origin);
    mpq_set_d(c, computed);
    mpq_sub(exact, exact, c);
    error = fabs(mpq_get_d(exact));
    mpq_clears(exact, c, NULL);
    return error == 0 ? 0 : nextafter(error, 1);
}

/* The errors of the projection are those of these points, not more. */
static void set_errors(bench *b, uint32_t count)
{
    sc_projection *p = &b->projection;
    p->x_error = p->y_error = 0;
    for (uint32_t i = 0; i < count; ++i) {
        double x, y;
        posed_model_project(b->workspace, p, SC_LINE_VERTICAL, i, &x, &y);
        p->x_error = fmax(p->x_error, exact_error(p->u, bench_point(b, i), p->origin, x));
        p->y_error = fmax(p->y_error, exact_error(p->w, bench_point(b, i), p->origin, y));
    }
}

/* What is wrong with the bounds of an edge, in exact arithmetic: 1: its extent, 2: its slope, 4:
   the ends, 8: its side. */
static unsigned check_edge(bench *b, const sc_segment_bounds *bounds, uint32_t from, uint32_t to)
{
    mpq_t x0, y0, x1, y1, at, d;
    unsigned wrong = 0;
    const sc_ray_bound *r = &bounds->side[SC_SIDE_TOP];
    if (r->ay == -INFINITY) return 0; /* nothing is said */
    mpq_inits(x0, y0, x1, y1, at, d, NULL);
    posed_model_exact_dot(x0, b->projection.u, bench_point(b, from), b->projection.origin);
    posed_model_exact_dot(y0, b->projection.w, bench_point(b, from), b->projection.origin);
    posed_model_exact_dot(x1, b->projection.u, bench_point(b, to), b->projection.origin);
    posed_model_exact_dot(y1, b->projection.w, bench_point(b, to), b->projection.origin);
    if (mpq_cmp(x1, x0) > 0) {
        r = &bounds->side[SC_SIDE_BOTTOM];
        mpq_neg(y0, y0);
        mpq_neg(y1, y1);
    }
    if (mpq_equal(x0, x1) || !(r->ax <= r->bx)) {
        wrong = 8;
    } else {
        mpq_sub(d, x1, x0);
        mpq_sub(y1, y1, y0);
        mpq_div(y1, y1, d); /* the slope */
        mpq_set_d(at, (double)r->least);
        wrong |= mpq_cmp(at, y1) > 0 ? 2 : 0;
        mpq_set_d(at, (double)r->most);
        wrong |= mpq_cmp(at, y1) < 0 ? 2 : 0;
        for (int end = 0; end < 2; ++end) {
            mpq_set_d(at, (double)(end ? r->bx : r->ax));
            wrong |= (end ? mpq_cmp(at, x0) < 0 || mpq_cmp(at, x1) < 0
                          : mpq_cmp(at, x0) > 0 || mpq_cmp(at, x1) > 0)
                         ? 1
                         : 0;
            mpq_sub(at, at, x0);
            mpq_mul(at, at, y1);
            mpq_add(at, at, y0);
            mpq_set_d(d, (double)(end ? r->by : r->ay));
            wrong |= mpq_cmp(d, at) > 0 ? 4 : 0;
        }
    }
    mpq_clears(x0, y0, x1, y1, at, d, NULL);
    return wrong;
}

static double either(double x)
{
    return test_random_below(2) ? x : -x;
}

/* A projection along the axes whose differences are rounded; x or y may be exact. */
static void choose_projection(bench *b, uint32_t kind)
{
    sc_projection *p = &b->projection;
    memset(p, 0, sizeof(*p));
    p->u[0] = p->w[1] = 1;
    if (kind % 4 != 1) p->origin[0] = -1 + test_random_unit() / 16;
    if (kind % 4 != 2) p->origin[1] = -1 + test_random_unit() / 16;
    if (kind % 4 == 3) { /* sums that cancel: errors about 0 */
        p->u[2] = p->w[2] = 1;
        p->origin[2] = 1 - test_random_unit() / 16;
    }
    if (kind == 4) p->origin[0] = p->origin[1] = 0; /* nothing is rounded */
}

static double tiny_part(void)
{
    return test_random_range(-1, 1) * 0x1p-52;
}

static void bounds_of_edges(void)
{
    static const char *const names[] = {"short edges", "edges about zero", "lines about zero"};
    bench b;
    uint32_t rounds = test_iterations(12000), wrong[4] = {0, 0, 0, 0}, bounded = 0, tried = 0;
    if (!open_bench(&b)) return;
    for (uint32_t i = 0; i < rounds; ++i) {
        uint32_t family = i % 3, kind = test_random_below(5);
        const sc_segment_bounds *bounds = &b.workspace->bounds.of[SC_LINE_VERTICAL][0];
        double x = test_random_range(0.01, 0.4), slope = test_random_range(-2, 2), run, to;
        double ax;
        if (family == 0 && test_random_below(2)) slope *= pow(2, test_random_range(-10, 10));
        choose_projection(&b, kind);
        to = either(1);
        run = to * (family == 0 ? exp2(test_random_range(-33, -20)) : test_random_range(0.1, 0.4));
        for (uint32_t k = 0; k < LEFT_POINTS; ++k) {
            double *p = bench_point(&b, k);
            p[0] = x + run * k * (k == 2 ? test_random_unit() + 0.5 : 1) + tiny_part();
            p[1] = 0.2 + slope * run * k + tiny_part();
            p[2] = kind == 3 ? -p[0] + either(1) * 1e-9 * test_random_unit() : test_random_unit();
        }
        if (family == 1) { /* a corner of the extent at 0 */
            double *p = bench_point(&b, test_random_below(2) ? 0 : 2);
            p[0] = b.projection.origin[0] - (kind == 3 ? p[2] - b.projection.origin[2] : 0);
            p[0] += test_random_below(4) * tiny_part();
        }
        if (family ==
            2) { /* the line of the first edge is about 0 at the end of the second's extent */
            double x0, x1, x2, y;
            uint32_t last = test_random_below(2) ? 0 : 2;
            double *p = bench_point(&b, 0), *q = bench_point(&b, 1), *r = bench_point(&b, 2);
            if (last == 0) r[0] = q[0] + 0.1 * run;
            posed_model_project(b.workspace, &b.projection, SC_LINE_VERTICAL, 0, &x0, &y);
            posed_model_project(b.workspace, &b.projection, SC_LINE_VERTICAL, 1, &x1, &y);
            posed_model_project(b.workspace, &b.projection, SC_LINE_VERTICAL, 2, &x2, &y);
            x2 = last == 0 ? x0 : x2;
            ax = x2 < x1 ? (double)sc_boxes_below(x2) : (double)sc_boxes_above(x2);
            p[1] = slope * (x0 - ax) + b.projection.origin[1];
            q[1] = slope * (x1 - ax) + b.projection.origin[1];
            if (kind == 3) p[1] -= p[2] - b.projection.origin[2];
            if (kind == 3) q[1] -= q[2] - b.projection.origin[2];
            p[1] += test_random_below(4) * tiny_part();
            q[1] += test_random_below(4) * tiny_part();
        }
        set_errors(&b, LEFT_POINTS);
        sc_contour_bounds_begin(b.real, &b.workspace->frame.positions[0], &b.projection,
                                &b.workspace->bounds);
        sc_contour_bounds_update(b.fake, &b.workspace->bounds, SC_LINE_VERTICAL, 0);
        ++tried;
        bounded += bounds->side[0].ay != -INFINITY;
        for (uint32_t k = 0; k + 1 < LEFT_POINTS; ++k) {
            unsigned what = check_edge(&b, bounds, k, k + 1);
            for (int bit = 0; bit < 4; ++bit) wrong[bit] += what >> bit & 1;
            if (what && test_failures() < 3)
                CHECK_MSG(0, "%s, kind %" PRIu32 ", fault %u", names[family], kind, what);
        }
    }
    CHECK_MSG(wrong[0] + wrong[1] + wrong[2] + wrong[3] == 0,
              "%" PRIu32 " extents, %" PRIu32 " slopes, %" PRIu32 " ends, %" PRIu32 " sides",
              wrong[0], wrong[1], wrong[2], wrong[3]);
    CHECK_MSG(!test_is_full() || 2 * bounded > tried, "%" PRIu32 " of %" PRIu32, bounded, tried);
    close_bench(&b);
}

/* Edges that are shorter than their errors, or not much longer: none has a side. */
static void edges_without_a_slope(void)
{
    bench b;
    uint32_t sides = 0, wrong = 0;
    if (!open_bench(&b)) return;
    for (uint32_t i = 0; i < test_iterations(4000); ++i) {
        const sc_segment_bounds *bounds = &b.workspace->bounds.of[SC_LINE_VERTICAL][0];
        double x = test_random_range(0.01, 0.4);
        choose_projection(&b, i % 4);
        for (uint32_t k = 0; k < LEFT_POINTS; ++k) {
            double *p = bench_point(&b, k);
            p[0] = k == 2 ? x + 0.3 : x + 4 * tiny_part();
            p[1] = test_random_unit();
            p[2] = 0.5 * x + tiny_part();
        }
        set_errors(&b, LEFT_POINTS);
        sc_contour_bounds_begin(b.real, &b.workspace->frame.positions[0], &b.projection,
                                &b.workspace->bounds);
        sc_contour_bounds_update(b.fake, &b.workspace->bounds, SC_LINE_VERTICAL, 0);
        for (uint32_t k = 0; k + 1 < LEFT_POINTS; ++k)
            wrong += check_edge(&b, bounds, k, k + 1) != 0;
        sides += bounds->side[0].ay != -INFINITY;
    }
    CHECK_MSG(wrong == 0, "%" PRIu32 " edges, %" PRIu32 " bounded", wrong, sides);
    /* where the limit is: 2^20 errors */
    for (int step = 0; step < 2; ++step)
        for (int sign = -1; sign <= 1; sign += 2) {
            memset(&b.projection, 0, sizeof(b.projection));
            b.projection.u[0] = b.projection.w[1] = 1;
            b.projection.x_error = 0x1p-40;
            for (uint32_t k = 0; k < LEFT_POINTS; ++k) {
                double *p = bench_point(&b, k);
                p[0] = sign * (k == 2 ? 1 : k * (step ? 0x1.1p-20 : 0x1.ep-21));
                p[1] = k;
                p[2] = 0;
            }
            sc_contour_bounds_begin(b.real, &b.workspace->frame.positions[0], &b.projection,
                                    &b.workspace->bounds);
            sc_contour_bounds_update(b.fake, &b.workspace->bounds, SC_LINE_VERTICAL, 0);
            CHECK((b.workspace->bounds.of[0][0].side[0].ay == -INFINITY) == (step == 0));
        }
    close_bench(&b);
}

/* The line value that a bound stands for at x, exactly. */
static void exact_bound(mpq_t result, const sc_ray_bound *r, double x)
{
    mpq_t at, d, e;
    mpq_inits(at, d, e, NULL);
    mpq_set_d(at, x);
    if (x < (double)r->ax || x > (double)r->bx) {
        int left = x < (double)r->ax;
        mpq_set_d(d, (double)(left ? r->ax : r->bx));
        mpq_sub(at, at, d);
        mpq_set_d(d, (double)(left ? r->most : r->least));
        mpq_mul(at, at, d);
        mpq_set_d(d, (double)(left ? r->ay : r->by));
        mpq_add(result, at, d);
    } else {
        mpq_set_d(d, (double)r->ax);
        mpq_sub(at, at, d);
        mpq_set_d(e, (double)r->bx);
        mpq_sub(e, e, d);
        if (mpq_sgn(e) != 0) mpq_div(at, at, e);
        mpq_set_d(d, (double)r->by);
        mpq_set_d(e, (double)r->ay);
        mpq_sub(d, d, e);
        mpq_mul(at, at, d);
        mpq_add(result, at, e);
    }
    mpq_clears(at, d, e, NULL);
}

static float random_float(void)
{
    return (float)(either(1) * (1 + test_random_unit()) * exp2((double)test_random_below(30) - 15));
}

/* A bound that is about 0 at x, so that its rounding is all there is. */
static void values_of_bounds(void)
{
    uint32_t wrong[3] = {0, 0, 0};
    double least = HUGE_VAL;
    sc_ray_bound one = {-1, 1, 1, 1, 0, 0};
    for (uint32_t i = 0; i < test_iterations(40000); ++i) {
        sc_ray_bound r;
        double x;
        mpq_t exact, computed;
        r.ax = random_float();
        r.bx = r.ax + fabsf(random_float());
        r.least = random_float();
        r.most = r.least + fabsf(random_float());
        r.ay = random_float();
        r.by = random_float();
        if (i % 3 == 0) { /* where it is 0 */
            x = (double)r.ax - fabs((double)r.ay / (double)r.most);
            if ((r.ay > 0) != (r.most > 0)) r.ay = -r.ay;
        } else if (i % 3 == 1) {
            x = (double)r.bx + fabs((double)r.by / (double)r.least);
            if ((r.by > 0) == (r.least > 0)) r.by = -r.by;
        } else {
            double ay = (double)r.ay, by = (double)r.by;
            if ((ay > 0) == (by > 0)) r.by = -r.by, by = -by;
            x = (double)r.ax + ((double)r.bx - (double)r.ax) * (ay / (ay - by));
        }
        mpq_inits(exact, computed, NULL);
        exact_bound(exact, &r, x);
        mpq_set_d(computed, sc_contour_bounds_lowest(&r, x));
        wrong[i % 3] += mpq_cmp(computed, exact) > 0;
        mpq_sub(exact, exact, computed);
        least = fmin(least, mpq_get_d(exact) / (fabs((double)r.ay) + fabs((double)r.by)));
        mpq_clears(exact, computed, NULL);
    }
    CHECK_MSG(wrong[0] + wrong[1] + wrong[2] == 0,
              "%" PRIu32 " left, %" PRIu32 " right, %" PRIu32 " between", wrong[0], wrong[1],
              wrong[2]);
    /* as said, 1e-15 of the terms and no more */
    CHECK(sc_contour_bounds_lowest(&one, -1) < 1 - 1.6e-15);
    CHECK(sc_contour_bounds_lowest(&one, -1) > 1 - 2.4e-15);
    CHECK(least > 0);
}

/* Parents of bounds, one of which is reached from afar and comes to about 0. */
static void bounds_of_parents(void)
{
    bench b;
    uint32_t wrong = 0;
    if (!open_bench(&b)) return;
    for (uint32_t i = 0; i < test_iterations(20000); ++i) {
        sc_ray_bound child[2], *far = &child[i & 1], *near = &child[1 - (i & 1)];
        const sc_ray_bound *parent;
        sc_workspace *w = b.workspace;
        int left = (int)(i >> 1 & 1);
        float slope = random_float(), height, gap_high, gap_low;
        double gap;
        /* slope times a gap of 53 bits that two floats make: the product is a float but for
           rounding */
        height = fabsf(random_float());
        if (slope < 0) slope = -slope;
        gap = (double)height / (double)slope;
        gap_high = (float)gap;
        gap_low = (float)(gap - (double)gap_high);
        if (test_random_below(2)) gap_low *= 1 + (float)either(0x1p-20);
        far->ax = far->bx = gap_high;
        near->ax = near->bx = -gap_low;
        if (!left) {
            far->ax = far->bx = -gap_high;
            near->ax = near->bx = gap_low;
        }
        far->least = far->most = left ? slope : -slope;
        far->ay = far->by = height;
        near->least = near->most = 0;
        near->ay = near->by = 3 * height;
        sc_contour_bounds_begin(b.real, &w->frame.positions[0], &b.projection, &w->bounds);
        for (int k = 0; k < 2; ++k) {
            w->bounds.epoch_of[0][k] = w->bounds.epoch;
            w->bounds.of[0][k].side[0] = w->bounds.of[0][k].side[1] = child[k];
        }
        sc_contour_bounds_update(b.fake, &w->bounds, SC_LINE_VERTICAL, 2);
        parent = &w->bounds.of[0][2].side[0];
        for (int k = 0; k < 4; ++k) {
            mpq_t exact, bound;
            mpq_inits(exact, bound, NULL);
            exact_bound(exact, &child[k & 1], (double)(k < 2 ? parent->ax : parent->bx));
            mpq_set_d(bound, (double)(k < 2 ? parent->ay : parent->by));
            wrong += mpq_cmp(bound, exact) > 0;
            mpq_clears(exact, bound, NULL);
        }
    }
    CHECK_MSG(wrong == 0, "%" PRIu32 " ends above a child's lines", wrong);
    close_bench(&b);
}

/* Two segments beside a point: the line through it may be where its computed place is, or off by
   the error, and so may they. */
static void beside_a_point(void)
{
    bench b;
    uint32_t passed = 0, failed = 0, wrong = 0;
    if (!open_bench(&b)) return;
    b.workspace->worker->model = b.fake;
    b.parts[1] = 3; /* segment 1 becomes 3 4 3: there and back, apart from the first */
    b.parts[4] = 5;
    for (uint32_t i = 0; i < test_iterations(30000); ++i) {
        sc_projection *p = &b.projection;
        double space = test_random_range(0, 4), side = either(1);
        memset(p, 0, sizeof(*p));
        /* sums that cancel, rounded in three places: x is about 0 */
        for (int k = 0; k < 3; ++k) p->u[k] = 1;
        p->w[1] = 1;
        p->w[2] = -1;
        p->origin[0] = -1 + test_random_unit() / 16;
        p->origin[1] = 0.5 + test_random_unit() / 16;
        p->origin[2] = 0.5 - test_random_unit() / 16;
        for (uint32_t k = 0; k < BENCH_POINTS; ++k) {
            double *at = bench_point(&b, k), x = k == 5 ? 0 : k < 3 ? -side : side, far[2];
            far[0] = test_random_range(-0.2, 0.2);
            far[1] = test_random_range(-0.2, 0.2);
            x *= k % 2 ? 0.01 * k : space * 0x1p-52;
            at[1] = p->origin[1] + far[0] - 1;
            at[2] = p->origin[2] + far[1] - 1;
            at[0] = p->origin[0] + 2 - far[0] - far[1] + x + tiny_part();
        }
        set_errors(&b, BENCH_POINTS);
        sc_contour_bounds_begin(b.real, &b.workspace->frame.positions[0], &b.projection,
                                &b.workspace->bounds);
        if (sc_star_test(b.workspace->worker, 0)) {
            mpq_t at, x;
            int signs[5], separated = 0;
            ++passed;
            mpq_inits(at, x, NULL);
            for (int line = 0; line < 2; ++line) {
                posed_model_exact_dot(at, line ? p->w : p->u, bench_point(&b, 5), p->origin);
                for (uint32_t k = 0; k < 5; ++k) {
                    int order;
                    posed_model_exact_dot(x, line ? p->w : p->u, bench_point(&b, k), p->origin);
                    order = mpq_cmp(x, at);
                    signs[k] = (order > 0) - (order < 0);
                }
                separated |= signs[0] != 0 && signs[0] == signs[1] && signs[0] == signs[2] &&
                             signs[3] == -signs[0] && signs[4] == -signs[0];
            }
            mpq_clears(at, x, NULL);
            wrong += !separated;
        } else {
            ++failed;
        }
    }
    CHECK_MSG(wrong == 0, "%" PRIu32 " of %" PRIu32 " not separated", wrong, passed);
    test_note("%" PRIu32 " separated, %" PRIu32 " not", passed, failed);
    CHECK(!test_is_full() || (passed > 1000 && failed > 1000));
    close_bench(&b);
}

static void floats_below_and_above(void)
{
    static const double near[] = {0, 0x1p-24, -0x1p-24, 0x1p-25, -0x1p-25, 0x1p-53, -0x1p-53};
    uint32_t wrong = 0;
    for (uint32_t i = 0; i < test_iterations(300000); ++i) {
        int exponent = (int)test_random_below(i % 4 ? 260 : 2000) - (i % 4 ? 150 : 1060);
        double d = 1 + near[test_random_below(7)] + test_random_below(3) * 0x1p-23;
        if (test_random_below(2)) d += test_random_unit();
        if (exponent > 1022) exponent = 1022;
        d = either(ldexp(d, exponent));
        wrong += !((double)sc_boxes_below(d) <= d) || !((double)sc_boxes_above(d) >= d);
    }
    CHECK_MSG(wrong == 0, "%" PRIu32 " wrong", wrong);
    CHECK(sc_boxes_below(0) < 0 && sc_boxes_above(0) > 0);
}

/* The same where subnormal numbers are flushed to zero: then a float is off by up to FLT_MIN, and
   half of that is no number to step by. */
static void floats_where_subnormals_are_flushed(void)
{
#ifdef __SSE2__
    const unsigned mode = _mm_getcsr();
    uint32_t wrong = 0;
    for (uint32_t i = 0; i < test_iterations(100000); ++i) {
        volatile double d =
            either(ldexp(1 + test_random_unit(), -(int)test_random_below(40) - 110));
        volatile float below, above;
        _mm_setcsr(mode | 0x8040); /* flush to zero, denormals are zero */
        below = sc_boxes_below(d);
        above = sc_boxes_above(d);
        _mm_setcsr(mode);
        wrong += !((double)below <= d) || !((double)above >= d);
    }
    CHECK_MSG(wrong == 0, "%" PRIu32 " wrong", wrong);
#endif
}

/* Normals that have an exactly known, tiny dot product with a direction, on either side of the
   margin. */
static void margins_are_as_documented(void)
{
    for (int step = 0; step < 2; ++step) {
        soup mesh = soup_cloth(1, 1);
        /* 37 u E F + 12.1 POINT (E + F), u of float */
        double tilt = (37 * 0x1p-24 + 12.1 * 3e-8 * 2) * (step ? 1.2 : 0.8);
        double corners[3][3] = {{0, 0, 0}, {1, 0, 0}, {0, 0, 1}};
        sc_mesh input;
        sc_model *model = NULL;
        sc_workspace *w = NULL;
        sc_pose pose;
        mesh.triangle_count = 1;
        for (uint32_t k = 0; k < 3; ++k)
            memcpy(mesh.positions + 3 * (size_t)mesh.triangles[k], corners[k], sizeof(corners[k]));
        mesh.positions[3 * (size_t)mesh.triangles[2] + 1] = tilt; /* n = (0, -1, tilt) */
        input = input_plain_mesh(&mesh);
        pose = input_plain_pose(mesh.positions, mesh.vertex_count);
        if (CHECK(sc_build(&input, NULL, &model) == SC_OK) &&
            CHECK(sc_workspace_create(model, NULL, &w) == SC_OK) &&
            CHECK(sc_positions_read(model, &pose, 24, &w->frame) == SC_OK)) {
            sc_dnc_update(model, &w->frame);
            CHECK((int)(w->frame.mask[0] >> 2 & 1) == step);
            CHECK((w->frame.mask[0] >> 8 & 1) == 1);
        }
        sc_workspace_free(w);
        sc_model_free(model);
        soup_free(&mesh);
    }
}

/* Single triangles whose normal is at right angles to a direction but for rounding, of ordinary
   size and of one at which products underflow. */
static void normals_at_right_angles(void)
{
    static const double half[7][3] = {{1, 0, 0},  {0, 1, 0},  {0, 0, 1},  {1, 1, 1},
                                      {1, 1, -1}, {1, -1, 1}, {1, -1, -1}};
    soup mesh = soup_cloth(1, 1);
    sc_mesh input;
    sc_pose pose;
    sc_model *model = NULL;
    sc_workspace *w = NULL;
    uint32_t wrong = 0, set = 0, unset = 0;
    mesh.triangle_count = 1;
    input = input_plain_mesh(&mesh);
    pose = input_plain_pose(mesh.positions, mesh.vertex_count);
    if (!CHECK(sc_build(&input, NULL, &model) == SC_OK) ||
        !CHECK(sc_workspace_create(model, NULL, &w) == SC_OK))
        return;
    for (uint32_t i = 0; i < test_iterations(20000); ++i) {
        const uint32_t *t = sc_model_triangle(model);
        uint32_t bit = test_random_below(7);
        double size = i % 3 ? 1 : exp2(-540 + (double)test_random_below(16));
        double x = test_random_range(-2, 2), y = test_random_range(-2, 2), p[3][3];
        double off = pow(10, test_random_range(-9, -4));
        mpq_t dot, product, e[3], f[3], n;
        int sign;
        for (int k = 0; k < 3; ++k) {
            double edge = test_random_range(-1, 1);
            p[0][k] = i % 2 ? test_random_range(-1, 1) : 0;
            p[1][k] = p[0][k] + edge;
            p[2][k] = p[0][k] + (x * edge + y * half[bit][k]);
            if (i % 4 == 0) p[2][k] += test_random_range(-1, 1) * off;
        }
        for (uint32_t c = 0; c < 9; ++c)
            mesh.positions[3 * mesh.triangles[c / 3] + c % 3] = p[c / 3][c % 3] * size;
        CHECK(sc_positions_read(model, &pose, 24, &w->frame) == SC_OK);
        sc_dnc_update(model, &w->frame);
        mpq_inits(dot, product, e[0], e[1], e[2], f[0], f[1], f[2], n, NULL);
        for (uint32_t k = 0; k < 3; ++k) {
            mpq_set_d(n, mesh.positions[3 * t[0] + k]);
            mpq_set_d(e[k], mesh.positions[3 * t[1] + k]);
            mpq_set_d(f[k], mesh.positions[3 * t[2] + k]);
            mpq_sub(e[k], e[k], n);
            mpq_sub(f[k], f[k], n);
        }
        for (int k = 0; k < 3; ++k) {
            mpq_mul(n, e[(k + 1) % 3], f[(k + 2) % 3]);
            mpq_mul(product, e[(k + 2) % 3], f[(k + 1) % 3]);
            mpq_sub(n, n, product);
            mpq_set_d(product, half[bit][k]);
            mpq_mul(n, n, product);
            mpq_add(dot, dot, n);
        }
        sign = mpq_sgn(dot);
        mpq_clears(dot, product, e[0], e[1], e[2], f[0], f[1], f[2], n, NULL);
        if (w->frame.mask[0] >> bit & 1) {
            ++set;
            wrong += sign <= 0;
        } else {
            ++unset;
        }
        wrong += (w->frame.mask[0] >> (bit + 7) & 1) && sign >= 0;
    }
    CHECK_MSG(wrong == 0, "%" PRIu32 " signs wrong", wrong);
    test_note("%" PRIu32 " certainly within the direction's half-space, %" PRIu32 " not", set,
              unset);
    CHECK(!test_is_full() || (set > 100 && unset > 100));
    sc_workspace_free(w);
    sc_model_free(model);
    soup_free(&mesh);
}

/* Projected coordinates where most of their roundings go the same way; more than half of the error
   that is allowed is reached, so that half of it would not do. */
static void errors_of_projections(void)
{
    bench b;
    uint32_t wrong = 0;
    double most[2] = {0, 0};
    if (!open_bench(&b)) return;
    for (uint32_t i = 0; i < test_iterations(60000); ++i) {
        sc_workspace *w = b.workspace;
        sc_projection *p = &b.projection;
        uint32_t mask = (uint32_t)test_random() & 0x3fff;
        double *at = bench_point(&b, 0), x, y;
        if (i % 2) mask = 1u << test_random_below(14);
        if (i % 8 == 0) mask = 0x0e82; /* u = (3, 130, -25), the worst found for x */
        if (i % 8 == 6) mask = 0x12c0; /* w = (30, -548, -14), the worst found for y */
        mask &= ~(mask >> 7 & 0x7f);   /* no direction and its negative */
        if (mask == 0) continue;
        w->frame.radius = 1;
        sc_dnc_projection(&w->frame, mask, p);
        for (int k = 0; k < 3; ++k) {
            const double *along = i % 4 < 2 ? p->u : p->w;
            double d = along[k] < 0 ? -1 : 1;
            w->frame.center[k] = -d * 0x1p-52 * test_random_unit();
            at[k] = d * (1 + (double)test_random_below(i % 16 > 8 ? 4 : 1 << 30) * 0x1p-52);
        }
        w->frame.radius = 0;
        for (int k = 0; k < 3; ++k)
            w->frame.radius = fmax(w->frame.radius, fabs(at[k] - w->frame.center[k]));
        sc_dnc_projection(&w->frame, mask, p);
        posed_model_project(w, p, SC_LINE_VERTICAL, 0, &x, &y);
        x = exact_error(p->u, at, p->origin, x) / p->x_error;
        y = exact_error(p->w, at, p->origin, y) / p->y_error;
        wrong += x > 1 || y > 1;
        most[0] = fmax(most[0], x);
        most[1] = fmax(most[1], y);
    }
    CHECK_MSG(wrong == 0, "%" PRIu32 " errors too large", wrong);
    test_note("up to %.2f and %.2f of the errors allowed", most[0], most[1]);
    CHECK(!test_is_full() || (most[0] > 0.5 && most[1] > 0.5));
    close_bench(&b);
}

/* Determinants whose differences and products are all rounded by half a unit, the way that
   hurts. */
static void signs_where_all_rounds_wrong(void)
{
    uint64_t fallbacks = 0;
    uint32_t wrong = 0, decided = 0, rounds = test_iterations(400000);
    for (uint32_t i = 0; i < rounds; ++i) {
        double a[2], b[2], c[2];
        int sign;
        uint64_t before = fallbacks;
        a[0] = -0x1p-53;
        a[1] = -0x1p-53;
        b[0] = 1.02 + 0.08 * test_random_unit();
        b[1] = 1.02 + 0.08 * test_random_unit();
        c[0] = 1.02 + 0.08 * test_random_unit();
        c[1] = b[1] * c[0] / b[0] + ((double)test_random_below(11) - 5) * 0x1p-52;
        sign = sc_predicates_orient2d(a, b, c, &fallbacks);
        if (fallbacks != before) continue;
        ++decided;
        wrong += sign != sc_predicates_orient2d_exact(a, b, c);
    }
    CHECK_MSG(wrong == 0, "%" PRIu32 " of %" PRIu32 " signs wrong", wrong, decided);
    CHECK(decided > 0 || rounds < 1000);
}

/* The same in space: the worst found among some hundred million, off by 4.6 to 4.9 u M, where the
   bound is 9 u M (base/predicates.h). The sum of the six products is computed on the wrong side of
   0. */
static void worst_signs_in_space(void)
{
    static const double worst[][12] = {
        {0x1p-53, 0x1p-53, 0x1p-53, 0x1.0f83c8bd2b6b5p+0, 0x1.0561c7e5809ecp+0,
         -0x1.6a9610782df74p-56, 0x1.c78c3f9538fc8p-58, 0x1.1e15f9ca766d7p+0, 0x1.1bf832b58b4bp+0,
         -0x1.1764f44c04e03p+0, 0x1.9df90b424d128p-56, 0x1.0afa4fb8df811p+0},
        {0x1p-53, 0x1p-53, 0x1p-53, 0x1.1869192081f25p+0, 0x1.119f84325f7b8p+0,
         -0x1.df739d6168b8p-58, 0x1.7c5796705f1cp-56, 0x1.12c8276defd89p+0, 0x1.0c5d654758e04p+0,
         -0x1.1ecc6d86aae29p+0, 0x1.fcad772411634p-53, 0x1.11522a6b406a3p+0},
        {0x1p-53, -0x1p-53, 0x1p-53, 0x1.127fb66f151cap+0, 0x1.0f6d3f084335ap+0,
         -0x1.02686f022ca98p-53, 0x1.3d206d80fddfp-59, 0x1.14fe72012b50fp+0, 0x1.0d6aee418d223p+0,
         -0x1.2793a0495e95ap+0, -0x1.6b55639835bd4p-56, 0x1.1c464d2cb6f04p+0},
        {0x1p-53, -0x1p-53, 0x1p-53, 0x1.0d392a5273e84p+0, 0x1.10c153de3faeep+0,
         0x1.30b70c38e0e18p-55, 0x1.a631319a132f8p-53, 0x1.1e9f58970214dp+0, 0x1.17b19ecd2fc7fp+0,
         -0x1.1d0f808d15104p+0, -0x1.f24b3e01a198p-55, 0x1.19d1a6611b612p+0},
    };
    for (size_t i = 0; i < sizeof(worst) / sizeof(worst[0]); ++i) {
        uint64_t fallbacks = 0;
        const double *p = worst[i];
        int exact = sc_predicates_orient3d_exact(p, p + 3, p + 6, p + 9);
        CHECK(exact != 0 && exact == sc_wide_orient3d(p, p + 3, p + 6, p + 9));
        CHECK_MSG(sc_predicates_orient3d(p, p + 3, p + 6, p + 9, &fallbacks) == exact &&
                      fallbacks == 1,
                  "number %u", (unsigned)i);
    }
}

SC_TEST_MAIN(SC_TEST(bounds_of_edges), SC_TEST(edges_without_a_slope), SC_TEST(values_of_bounds),
             SC_TEST(bounds_of_parents), SC_TEST(beside_a_point), SC_TEST(floats_below_and_above),
             SC_TEST(floats_where_subnormals_are_flushed), SC_TEST(margins_are_as_documented),
             SC_TEST(normals_at_right_angles), SC_TEST(errors_of_projections),
             SC_TEST(signs_where_all_rounds_wrong), SC_TEST(worst_signs_in_space))
