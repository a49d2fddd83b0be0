/*
 * What culls, against exact rational arithmetic and the oracle: discrete normal cones and the
 * projections made of them, bounds of contour segments, the star-contour test, closed fans.
 *
 * SPDX-License-Identifier: MIT
 */
#include <float.h>
#include <gmp.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "simd/isa.h"
#include "harness.h"
#include "inputs.h"
#include "oracle.h"
#include "pose/contour_bounds.h"
#include "pose/dnc.h"
#include "pose/pose_kernels.h"
#include "pose/positions.h"
#include "query/query_kernels.h"
#include "query/simple.h"
#include "query/simple_contour.h"
#include "query/star.h"
#include "shapes.h"
#include "run/workspace.h"
#include "starcontour.h"

/* What is asked where nothing is. */
static sc_question nothing_asked;

/* A point under a projection. */
static void project_point(const sc_workspace *w, const sc_projection *projection, int line,
                          uint32_t point, double *x, double *y)
{
    sc_contour_bounds bounds;
    memset(&bounds, 0, sizeof(bounds));
    bounds.positions = &w->frame.positions[0];
    bounds.projection = *projection;
    sc_contour_bounds_project(&bounds, line, point, x, y);
}

static const double pi = 3.14159265358979323846;

/* A model with a pose in its workspace, as within a query. */
typedef struct scene {
    const char *name;
    soup mesh; /* its positions are the rest pose */
    double *pose;
    input_choices choices;
    sc_model *model;
    sc_workspace *workspace;
} scene;

static int load_pose(scene *s)
{
    sc_pose pose = input_plain_pose(s->pose, s->mesh.vertex_count);
    sc_workspace_begin(s->model, s->workspace, &nothing_asked);
    if (!CHECK(sc_positions_read(s->model, &pose, 24, &s->workspace->frame) == SC_OK)) return 0;
    sc_dnc_update(s->model, &s->workspace->frame);
    return 1;
}

/* Shares and numbers of cases are asked for where there are cases enough. */
static int is_full(void)
{
    return test_iterations(100) >= 100;
}

static double *copy_positions(const soup *mesh)
{
    double *p = (double *)test_allocate(3 * (size_t)mesh->vertex_count * sizeof(double));
    memcpy(p, mesh->positions, 3 * (size_t)mesh->vertex_count * sizeof(double));
    return p;
}

/* Takes the mesh. */
static int open_scene(scene *s, const char *name, const soup *mesh, uint32_t weld,
                      uint32_t partition)
{
    sc_mesh m;
    memset(s, 0, sizeof(*s));
    s->name = name;
    s->mesh = *mesh;
    s->pose = copy_positions(mesh);
    s->choices = input_choose(mesh, weld, partition);
    m = input_plain_mesh(mesh);
    return CHECK(sc_build(&m, &s->choices.options, &s->model) == SC_OK) &&
           CHECK(sc_workspace_create(s->model, NULL, &s->workspace) == SC_OK);
}

static void close_scene(scene *s)
{
    sc_workspace_free(s->workspace);
    sc_model_free(s->model);
    input_free_choices(&s->choices);
    free(s->pose);
    soup_free(&s->mesh);
}

/* About a random axis, so that flat meshes look in any direction. */
static void rotate(double *positions, uint32_t count)
{
    double axis[3], size = 0, angle = test_random_range(0, 2 * pi), c = cos(angle), d = sin(angle);
    for (int k = 0; k < 3; ++k) axis[k] = test_random_range(-1, 1);
    for (int k = 0; k < 3; ++k) size += axis[k] * axis[k];
    for (int k = 0; k < 3; ++k) axis[k] /= sqrt(size);
    for (uint32_t v = 0; v < count; ++v) {
        double *p = positions + 3 * (size_t)v, q[3];
        double along = (1 - c) * (axis[0] * p[0] + axis[1] * p[1] + axis[2] * p[2]);
        for (int k = 0; k < 3; ++k)
            q[k] = c * p[k] + along * axis[k] +
                   d * (axis[(k + 1) % 3] * p[(k + 2) % 3] - axis[(k + 2) % 3] * p[(k + 1) % 3]);
        memcpy(p, q, sizeof(q));
    }
}

/* A pose that often leaves all normals within a half-space although it folds or overlaps. */
static void random_pose(double *positions, uint32_t count)
{
    switch (test_random_below(6)) {
    case 0:
        soup_any_pose(positions, count);
        break;
    case 1:
        soup_smooth(positions, count, 0.03);
        break;
    case 2: /* bent in its plane, up to twice round */
        for (uint32_t v = 0; v < count; ++v) positions[3 * (size_t)v + 1] *= 0.1;
        shape_bend(positions, count, test_random_range(0.3, 2));
        break;
    case 3: /* sheared and nearly flat */
        for (uint32_t v = 0; v < count; ++v) {
            double *p = positions + 3 * (size_t)v;
            p[0] += 2 * p[1];
            p[2] *= 0.1;
        }
        soup_smooth(positions, count, 0.05);
        break;
    case 4:
        soup_twist(positions, count, test_random_range(0.1, 1));
        break;
    default:
        break;
    }
    rotate(positions, count);
    if (test_random_below(6) == 0) soup_noise(positions, count, 0.02);
    if (test_random_below(6) == 0) soup_round_to_float(positions, count);
    if (test_random_below(8) == 0) soup_snap(positions, count, 0.0625);
    if (test_random_below(8) == 0) soup_move(positions, count, 1e5);
}

static void open_random_scene(scene *s, uint32_t maximum)
{
    const char *name = "soup";
    soup mesh = test_random_below(8) == 0 ? soup_on_grid(2) : shape_any(maximum, &name);
    open_scene(s, name, &mesh, test_random_below(3), test_random_below(4));
}

/* ---- exact arithmetic ---- */

/* Poses here are packed doubles. */
static const double *place_of(const sc_workspace *w, uint32_t point)
{
    return (const double *)(const void *)w->frame.positions[0].at + 3 * (size_t)point;
}

static double part(const sc_workspace *w, uint32_t point, int k)
{
    return place_of(w, point)[k];
}

/* result = v . (p - q); q NULL: the origin given. */
static void exact_dot(mpq_t result, const double v[3], const double *p, const double *q)
{
    mpq_t a, b;
    mpq_inits(a, b, NULL);
    mpq_set_ui(result, 0, 1);
    for (int k = 0; k < 3; ++k) {
        mpq_set_d(a, p[k]);
        mpq_set_d(b, q[k]);
        mpq_sub(a, a, b);
        mpq_set_d(b, v[k]);
        mpq_mul(a, a, b);
        mpq_add(result, result, a);
    }
    mpq_clears(a, b, NULL);
}

/* The sign of ((b - a) x (c - a)) . (u x w), times a positive number: the area under u, w. */
static int exact_area_sign(const sc_workspace *w, const uint32_t *corner, const double u[3],
                           const double v[3])
{
    const double *a = place_of(w, corner[0]);
    const double *b = place_of(w, corner[1]), *c = place_of(w, corner[2]);
    mpq_t ub, vb, uc, vc;
    int sign;
    mpq_inits(ub, vb, uc, vc, NULL);
    exact_dot(ub, u, b, a);
    exact_dot(vb, v, b, a);
    exact_dot(uc, u, c, a);
    exact_dot(vc, v, c, a);
    mpq_mul(ub, ub, vc);
    mpq_mul(vb, vb, uc);
    sign = mpq_cmp(ub, vb);
    mpq_clears(ub, vb, uc, vc, NULL);
    return (sign > 0) - (sign < 0);
}

/* ---- cones ---- */

/* The projection along one direction alone has it as u x w: which one each bit is. */
static void find_directions(const sc_workspace *w, double directions[SC_DNC_DIRECTIONS][3])
{
    for (int d = 0; d < SC_DNC_DIRECTIONS; ++d) {
        sc_projection p;
        sc_dnc_projection(&w->frame, 1u << d, &p);
        for (int k = 0; k < 3; ++k) {
            double c = p.u[(k + 1) % 3] * p.w[(k + 2) % 3] - p.u[(k + 2) % 3] * p.w[(k + 1) % 3];
            directions[d][k] = (c > 0) - (c < 0);
        }
    }
}

static void directions_of_the_cone(void)
{
    soup mesh = soup_cloth(2, 2);
    scene s;
    double d[SC_DNC_DIRECTIONS][3];
    uint32_t faces = 0;
    if (!open_scene(&s, "cloth", &mesh, SC_WELD_REST, SC_PARTITION_FAST) || !load_pose(&s)) return;
    find_directions(s.workspace, d);
    for (int i = 0; i < SC_DNC_DIRECTIONS; ++i) {
        int zeros = (d[i][0] == 0) + (d[i][1] == 0) + (d[i][2] == 0);
        CHECK(zeros == 0 || zeros == 2);
        faces += zeros == 2;
        for (int k = 0; k < i; ++k) CHECK(memcmp(d[i], d[k], sizeof(d[i])) != 0);
    }
    CHECK(faces == 6);
    close_scene(&s);
}

/* Whether the dot product is beyond doubt in single precision; 0 outside of moderate sizes. */
static int is_clear(const sc_workspace *w, const uint32_t *t, const double d[3])
{
    double e[3], f[3], e_size = 0, f_size = 0, dot = 0;
    for (int k = 0; k < 3; ++k) {
        e[k] = part(w, t[1], k) - part(w, t[0], k);
        f[k] = part(w, t[2], k) - part(w, t[0], k);
        e_size += fabs(e[k]);
        f_size += fabs(f[k]);
    }
    for (int k = 0; k < 3; ++k)
        dot += d[k] * (e[(k + 1) % 3] * f[(k + 2) % 3] - e[(k + 2) % 3] * f[(k + 1) % 3]);
    return dot > 1e-6 * (e_size * f_size +
                         w->frame.radius * (e_size + f_size + 1e-7 * w->frame.radius)) &&
           e_size > 1e-100 && f_size > 1e-100 && e_size < 1e100 && f_size < 1e100;
}

static void check_cones(scene *s)
{
    const sc_model *m = s->model;
    const sc_workspace *w = s->workspace;
    double d[SC_DNC_DIRECTIONS][3];
    uint32_t leaf, p, level, bit, i, wrong = 0, sample = 0;
    find_directions(w, d);
    for (leaf = 0; leaf < m->leaf_count; ++leaf) {
        uint32_t mask = w->frame.mask[sc_model_first_leaf_patch(m) + leaf];
        uint32_t in = leaf % SC_CONES_GROUP, is_made;
        if (!in) sample = 0;
        is_made = in < SC_CONES_SAMPLE || sample;
        if (in < SC_CONES_SAMPLE) sample |= mask;
        for (bit = 0; bit < SC_DNC_DIRECTIONS; ++bit) {
            uint32_t clear = 1, set = mask >> bit & 1;
            sc_projection one;
            sc_dnc_projection(&w->frame, 1u << bit, &one);
            for (i = sc_model_leaf_first(m)[leaf]; i < sc_model_leaf_first(m)[leaf + 1]; ++i) {
                const uint32_t *t = sc_model_triangle(m) + 3 * (size_t)i;
                clear &= (uint32_t)is_clear(w, t, d[bit]);
                if (set) wrong += exact_area_sign(w, t, one.u, one.w) <= 0;
            }
            wrong += clear && is_made && !set;
        }
    }
    CHECK_MSG(wrong == 0, "%s: %" PRIu32 " bits of leaves wrong", s->name, wrong);
    for (level = 0; level < m->level_count; ++level)
        for (p = sc_model_level_first(m)[level]; p + 1 < sc_model_level_first(m)[level + 1]; ++p) {
            uint32_t all = (1u << SC_DNC_DIRECTIONS) - 1;
            for (leaf = sc_model_leaf(m)[p]; leaf < sc_model_leaf(m)[p + 1]; ++leaf)
                all &= w->frame.mask[sc_model_first_leaf_patch(m) + leaf];
            wrong += w->frame.mask[p] != all;
        }
    CHECK_MSG(wrong == 0, "%s: %" PRIu32 " cones are not their leaves'", s->name, wrong);
}

static uint32_t random_part(uint32_t mask)
{
    uint32_t some = mask & (uint32_t)test_random();
    return some ? some : mask;
}

/* Projections of random parts of cones leave all areas positive, and coordinates are as exact as
   said. Returns the number of projections. */
static uint32_t check_projections(scene *s)
{
    const sc_model *m = s->model;
    const sc_workspace *w = s->workspace;
    uint32_t p, i, k, tried = 0, wrong = 0;
    for (p = 0; p < m->patch_end && tried < 40; ++p) {
        uint32_t from, to;
        sc_projection projection;
        if (w->frame.mask[p] == 0 || p + 1 == m->patch_end) continue;
        if (sc_model_leaf(m)[p] >= sc_model_leaf(m)[p + 1]) continue; /* no patch */
        ++tried;
        sc_dnc_projection(&w->frame, random_part(w->frame.mask[p]), &projection);
        for (k = 0; k < 3; ++k) /* what makes the projection exact */
            CHECK(projection.u[k] == floor(projection.u[k]) && fabs(projection.u[k]) <= 506 &&
                  projection.w[k] == floor(projection.w[k]) && fabs(projection.w[k]) <= 23276);
        from = sc_model_leaf_first(m)[sc_model_leaf(m)[p]];
        to = sc_model_leaf_first(m)[sc_model_leaf(m)[p + 1]];
        for (i = from; i < to; ++i)
            wrong += exact_area_sign(w, sc_model_triangle(m) + 3 * (size_t)i, projection.u,
                                     projection.w) <= 0;
        for (i = from; i < to && i < from + 8; ++i) {
            uint32_t point = sc_model_triangle(m)[3 * (size_t)i];
            const double *at = place_of(w, point);
            double x, y;
            mpq_t exact, computed, error;
            project_point(w, &projection, SC_LINE_VERTICAL, point, &x, &y);
            mpq_inits(exact, computed, error, NULL);
            for (k = 0; k < 2; ++k) {
                exact_dot(exact, k ? projection.w : projection.u, at, projection.origin);
                if (!isfinite(k ? y : x)) continue;
                mpq_set_d(computed, k ? y : x);
                mpq_sub(exact, exact, computed);
                mpq_abs(exact, exact);
                mpq_set_d(error, k ? projection.y_error : projection.x_error);
                wrong += mpq_cmp(exact, error) > 0;
            }
            mpq_clears(exact, computed, error, NULL);
        }
    }
    CHECK_MSG(wrong == 0, "%s: %" PRIu32 " areas or errors wrong", s->name, wrong);
    return tried;
}

/* The vectors of all masks: along no sum of directions but 0 are they 0. */
static void vectors_of_all_masks(void)
{
    static const int direction[7][3] = {{7, 0, 0},  {0, 7, 0},  {0, 0, 7},  {4, 4, 4},
                                        {4, 4, -4}, {4, -4, 4}, {4, -4, -4}};
    for (uint32_t first = 0; first < 1u << SC_DNC_DIRECTIONS; first += SC_DNC_VECTORS) {
        uint16_t mask[SC_DNC_VECTORS];
        float u[3][SC_DNC_VECTORS], w[3][SC_DNC_VECTORS];
        for (uint32_t i = 0; i < SC_DNC_VECTORS; ++i) mask[i] = (uint16_t)(first + i);
        sc_dnc_vectors(mask, u, w);
        for (uint32_t i = 0; i < SC_DNC_VECTORS; ++i) {
            const double a[3] = {(double)u[0][i], (double)u[1][i], (double)u[2][i]};
            const double b[3] = {(double)w[0][i], (double)w[1][i], (double)w[2][i]};
            const double square = a[0] * a[0] + a[1] * a[1] + a[2] * a[2];
            int sum[3] = {0, 0, 0}, any = 0, as_sum = 1;
            for (uint32_t d = 0; d < SC_DNC_DIRECTIONS; ++d)
                for (int k = 0; k < 3 && mask[i] >> d & 1; ++k)
                    sum[k] += d < 7 ? direction[d][k] : -direction[d - 7][k];
            for (int k = 0; k < 3; ++k) {
                int l = (k + 1) % 3, m = (k + 2) % 3;
                any |= sum[k] != 0;
                as_sum &= a[l] * b[m] - a[m] * b[l] == square * sum[k];
            }
            CHECK_MSG(as_sum && (square > 0) == any, "mask %" PRIu32, first + i);
        }
    }
}

static void cones_and_projections(void)
{
    uint32_t tried = 0;
    for (uint32_t i = 0; i < test_iterations(80); ++i) {
        scene s;
        open_random_scene(&s, 60);
        random_pose(s.pose, s.mesh.vertex_count);
        if (i % 8 == 0) soup_scale(s.pose, s.mesh.vertex_count, i % 16 == 0 ? 1e-60 : 1e60);
        if (i % 8 == 1) soup_crush(s.pose, s.mesh.vertex_count);
        if (i % 8 == 2) { /* a plane of exactly zero dot products, moved by rounding errors */
            for (uint32_t v = 0; v < s.mesh.vertex_count; ++v) {
                double *p = s.pose + 3 * (size_t)v;
                p[2] = -(p[0] + p[1]);
            }
            soup_nudge(s.pose, s.mesh.vertex_count);
        }
        if (load_pose(&s)) {
            check_cones(&s);
            tried += check_projections(&s);
        }
        close_scene(&s);
    }
    CHECK_MSG(!is_full() || tried > 200, "only %" PRIu32 " projections", tried);
}

/* Triangles that contain a direction but for rounding: floating point cannot tell the sign. */
static void cones_at_zero(void)
{
    soup mesh = soup_cloth(1, 1);
    scene s;
    double d[SC_DNC_DIRECTIONS][3];
    uint32_t wrong = 0, set = 0;
    mesh.triangle_count = 1;
    if (!open_scene(&s, "a triangle", &mesh, SC_WELD_NONE, SC_PARTITION_FAST) || !load_pose(&s))
        return;
    find_directions(s.workspace, d);
    for (uint32_t i = 0; i < test_iterations(6000); ++i) {
        const uint32_t *corner = s.mesh.triangles;
        double x = test_random_range(-2, 2), y = test_random_range(-2, 2);
        uint32_t bit = test_random_below(SC_DNC_DIRECTIONS);
        sc_projection one;
        for (int k = 0; k < 3; ++k) {
            double *p = s.pose, e = test_random_range(-1, 1);
            p[3 * corner[0] + (uint32_t)k] = i % 2 ? test_random_range(-1, 1) : 0;
            p[3 * corner[1] + (uint32_t)k] = p[3 * corner[0] + (uint32_t)k] + e;
            p[3 * corner[2] + (uint32_t)k] =
                p[3 * corner[0] + (uint32_t)k] + (x * e + y * d[bit][k]);
        }
        if (!load_pose(&s)) break;
        sc_dnc_projection(&s.workspace->frame, 1u << bit, &one);
        if (s.workspace->frame.mask[0] >> bit & 1) {
            ++set;
            wrong += exact_area_sign(s.workspace, sc_model_triangle(s.model), one.u, one.w) <= 0;
        }
    }
    CHECK_MSG(wrong == 0, "%" PRIu32 " of %" PRIu32 " signs wrong", wrong, set);
    close_scene(&s);
}

/* ---- bounds of segments ---- */

typedef struct bounds_check {
    scene *s;
    const sc_projection *projection;
    int line;
    const sc_segment_bounds *bounds;
    double samples[10];
    uint32_t wrong_extent, wrong_line, edges;
    double gap[2]; /* least distance of a line from the bound at the samples, by side */
} bounds_check;

static void exact_point(const bounds_check *c, uint32_t point, mpq_t x, mpq_t y)
{
    const double *at = place_of(c->s->workspace, point);
    const sc_projection *p = c->projection;
    exact_dot(c->line == SC_LINE_VERTICAL ? x : y, p->u, at, p->origin);
    exact_dot(c->line == SC_LINE_VERTICAL ? y : x, p->w, at, p->origin);
    if (c->line == SC_LINE_HORIZONTAL) mpq_neg(y, y);
}

/* Whether low <= x <= high, where the outermost floats stand for everything beyond. */
static int is_within(mpq_t x, float low, float high)
{
    int inside;
    mpq_t bound;
    if (!(low <= high)) return 0;
    mpq_init(bound);
    if (low > -FLT_MAX) mpq_set_d(bound, (double)low);
    inside = low <= -FLT_MAX || (low <= FLT_MAX && mpq_cmp(bound, x) <= 0);
    if (high < FLT_MAX) mpq_set_d(bound, (double)high);
    inside = inside && (high >= FLT_MAX || mpq_cmp(x, bound) <= 0);
    mpq_clear(bound);
    return inside;
}

static void check_edge(bounds_check *c, uint32_t from, uint32_t to)
{
    mpq_t x0, y0, x1, y1, slope, at, bound;
    int run, side;
    const sc_ray_bound *b;
    mpq_inits(x0, y0, x1, y1, slope, at, bound, NULL);
    exact_point(c, from, x0, y0);
    exact_point(c, to, x1, y1);
    run = mpq_cmp(x1, x0);
    side = run < 0 ? SC_SIDE_TOP : SC_SIDE_BOTTOM;
    b = &c->bounds->side[side];
    ++c->edges;
    if (run == 0) {
        const sc_ray_bound *o = &c->bounds->side[SC_SIDE_TOP];
        c->wrong_extent +=
            !is_within(x0, o->ax < b->ax ? o->ax : b->ax, o->bx > b->bx ? o->bx : b->bx);
        c->wrong_line += b->ay != -INFINITY || o->ay != -INFINITY;
    } else {
        c->wrong_extent += !is_within(x0, b->ax, b->bx) || !is_within(x1, b->ax, b->bx);
        if (side == SC_SIDE_BOTTOM) {
            mpq_neg(y0, y0);
            mpq_neg(y1, y1);
        }
        mpq_sub(y1, y1, y0);
        mpq_sub(x1, x1, x0);
        mpq_div(slope, y1, x1);
        for (int i = 0; i < 10; ++i) {
            double lowest = sc_contour_bounds_lowest(b, c->samples[i]);
            if (lowest == -HUGE_VAL) continue;
            if (!isfinite(lowest)) {
                ++c->wrong_line;
                continue;
            }
            mpq_set_d(at, c->samples[i]);
            mpq_sub(at, at, x0);
            mpq_mul(at, at, slope);
            mpq_add(at, at, y0);
            mpq_set_d(bound, lowest);
            c->wrong_line += mpq_cmp(bound, at) > 0;
            mpq_sub(at, at, bound);
            if (i < 3) c->gap[side] = fmin(c->gap[side], mpq_get_d(at));
        }
    }
    mpq_clears(x0, y0, x1, y1, slope, at, bound, NULL);
}

static void check_edges_of(bounds_check *c, uint32_t segment)
{
    const sc_model *m = c->s->model;
    for (uint32_t i = sc_model_segment_first(m)[segment]; i < sc_model_segment_last(m)[segment];
         ++i)
        check_edge(c, sc_model_points(m)[i], sc_model_points(m)[i + 1]);
}

/* Some places along a line: the ends of the bounds, between them, beside them, far away. */
static void choose_samples(bounds_check *c)
{
    const sc_ray_bound *b = &c->bounds->side[test_random_below(2)];
    double low = fmax((double)b->ax, -1e300), high = fmin((double)b->bx, 1e300), length;
    if (!(low <= high)) low = high = 0;
    length = high - low + c->s->workspace->frame.radius * 0x1p-20;
    c->samples[0] = low;
    c->samples[1] = high;
    c->samples[2] = low / 2 + high / 2;
    c->samples[3] = low + length * test_random_unit();
    c->samples[4] = low - length;
    c->samples[5] = high + length;
    c->samples[6] = low - 1e6 * length * test_random_unit();
    c->samples[7] = high + 1e6 * length * test_random_unit();
    c->samples[8] = 0;
    c->samples[9] = test_random_range(-1, 1) * c->s->workspace->frame.radius * 1e3;
    for (int i = 0; i < 10; ++i)
        if (!isfinite(c->samples[i])) c->samples[i] = 0;
}

typedef struct bounds_tally {
    uint32_t segments, bounded, leaves, tight;
} bounds_tally;

/* A random projection, of a node if any is oriented, else of nobody. */
static void random_projection(scene *s, sc_projection *projection)
{
    uint32_t p = test_random_below(s->model->patch_end), mask = s->workspace->frame.mask[p];
    if (mask == 0) { /* the normals of a random half-space */
        double d[SC_DNC_DIRECTIONS][3], n[3];
        for (int k = 0; k < 3; ++k) n[k] = test_random_range(-1, 1);
        find_directions(s->workspace, d);
        for (int i = 0; i < SC_DNC_DIRECTIONS; ++i)
            mask |= (uint32_t)(d[i][0] * n[0] + d[i][1] * n[1] + d[i][2] * n[2] > 0) << i;
    }
    sc_dnc_projection(&s->workspace->frame, random_part(mask), projection);
    sc_contour_bounds_begin(s->model, &s->workspace->frame.positions[0], projection,
                            &s->workspace->bounds);
}

static void check_bounds(scene *s, bounds_tally *tally)
{
    const sc_model *m = s->model;
    uint32_t stride = 1 + m->segment_count / 60;
    sc_projection projection;
    random_projection(s, &projection);
    for (int line = 0; line < 2; ++line)
        for (uint32_t i = test_random_below(stride); i < m->segment_count; i += stride) {
            /* the last ones have children; not in order, as in a query */
            uint32_t segment = i % 2 ? m->segment_count - 1 - i / 2 : i / 2;
            bounds_check c;
            memset(&c, 0, sizeof(c));
            c.s = s;
            c.projection = &projection;
            c.line = line;
            c.gap[0] = c.gap[1] = HUGE_VAL;
            sc_contour_bounds_update(m, &s->workspace->bounds, line, segment);
            CHECK(sc_contour_bounds_update(m, &s->workspace->bounds, line, segment) == 0);
            c.bounds = &s->workspace->bounds.of[line][segment];
            choose_samples(&c);
            check_edges_of(&c, segment);
            CHECK_MSG(c.wrong_extent == 0,
                      "%s: segment %" PRIu32 ", line %d: %" PRIu32 " of %" PRIu32 " edges outside",
                      s->name, segment, line, c.wrong_extent, c.edges);
            CHECK_MSG(c.wrong_line == 0,
                      "%s: segment %" PRIu32 ", line %d: %" PRIu32 " lines of %" PRIu32
                      " edges below",
                      s->name, segment, line, c.wrong_line, c.edges);
            ++tally->segments;
            if (c.bounds->side[0].ay == -INFINITY) continue;
            ++tally->bounded;
            for (int side = 0; side < 2; ++side) {
                if (segment >= m->leaf_segment_count || c.gap[side] == HUGE_VAL) continue;
                ++tally->leaves;
                tally->tight +=
                    c.gap[side] < 1e-4 * fabs(projection.w[0] + 1e3) * s->workspace->frame.radius;
            }
        }
}

static void bounds_of_segments(void)
{
    bounds_tally tally;
    memset(&tally, 0, sizeof(tally));
    for (uint32_t i = 0; i < test_iterations(60); ++i) {
        scene s;
        open_random_scene(&s, 60 + 2 * i);
        for (int k = 0; k < 2; ++k) {
            memcpy(s.pose, s.mesh.positions, 3 * (size_t)s.mesh.vertex_count * sizeof(double));
            random_pose(s.pose, s.mesh.vertex_count);
            if (i % 10 == 0) soup_scale(s.pose, s.mesh.vertex_count, k ? 1e-30 : 1e-45);
            if (i % 10 == 1) soup_scale(s.pose, s.mesh.vertex_count, k ? 1e30 : 1e38);
            if (load_pose(&s)) check_bounds(&s, &tally);
        }
        close_scene(&s);
    }
    CHECK_MSG(!is_full() || 3 * tally.bounded > tally.segments, "%" PRIu32 " of %" PRIu32,
              tally.bounded, tally.segments);
    CHECK_MSG(!is_full() || 10 * (uint64_t)tally.tight > 7 * (uint64_t)tally.leaves,
              "%" PRIu32 " of %" PRIu32 " bounds of leaves are tight", tally.tight, tally.leaves);
}

/* Segments longer than leaf clusters of today can have, put into a copy of a model. */
static void bounds_of_long_segments(void)
{
    enum { LONGEST = 300 };
    for (uint32_t i = 0; i < test_iterations(20); ++i) {
        soup mesh = soup_cloth(9, 9);
        scene s;
        bounds_tally tally;
        memset(&tally, 0, sizeof(tally));
        if (!open_scene(&s, "long", &mesh, SC_WELD_REST, SC_PARTITION_FAST)) continue;
        random_pose(s.pose, s.mesh.vertex_count);
        if (load_pose(&s)) {
            sc_model *model = s.model;
            size_t size = (size_t)model->bytes;
            uint32_t extra[LONGEST + 3], edges = 1 + test_random_below(i % 4 ? 28 : LONGEST - 1);
            sc_model *longer = (sc_model *)test_allocate(size + sizeof(extra));
            extra[0] = 0;
            extra[1] = edges;
            for (uint32_t k = 0; k <= edges; ++k)
                extra[2 + k] = test_random_below(model->vertex_count);
            for (uint32_t k = 3; k < edges + 3; ++k) /* no edge from a point to itself */
                while (extra[k] == extra[k - 1]) extra[k] = test_random_below(model->vertex_count);
            memcpy(longer, model, size);
            memcpy((unsigned char *)longer + size, extra, sizeof(extra));
            longer->segment_count = longer->leaf_segment_count = 1;
            longer->offset[SC_ARRAY_segment_first] = size;
            longer->offset[SC_ARRAY_segment_last] = size + sizeof(uint32_t);
            longer->offset[SC_ARRAY_points] = size + 2 * sizeof(uint32_t);
            s.model = longer;
            check_bounds(&s, &tally);
            CHECK(tally.segments == 2);
            free(longer);
            s.model = model;
        }
        close_scene(&s);
    }
}

/* Coordinates at the end of the range of doubles, where projected ones overflow. */
static void bounds_of_huge_coordinates(void)
{
    for (uint32_t i = 0; i < test_iterations(40); ++i) {
        scene s;
        bounds_tally tally;
        soup mesh = soup_cloth(3, 3);
        double size = exp2(test_random_range(960, 1023.9));
        memset(&tally, 0, sizeof(tally));
        if (!open_scene(&s, "huge", &mesh, SC_WELD_REST, SC_PARTITION_FAST)) continue;
        for (uint32_t v = 0; v < 1 + i % 4 || (i % 3 == 0 && v < s.mesh.vertex_count); ++v) {
            double *p = s.pose + 3 * (size_t)test_random_below(s.mesh.vertex_count);
            for (int k = 0; k < 3; ++k)
                if (test_random_below(3)) p[k] = size * test_random_range(-1, 1);
        }
        if (load_pose(&s)) check_bounds(&s, &tally);
        close_scene(&s);
    }
}

/* What was found for the last pose or projection is not taken for the next one's, even when ticks
   start anew: a workspace answers as a fresh one does. */
static void ticks(void)
{
    soup mesh = soup_cloth(6, 6);
    scene s;
    bounds_tally tally;
    memset(&tally, 0, sizeof(tally));
    if (!open_scene(&s, "cloth", &mesh, SC_WELD_REST, SC_PARTITION_FAST)) return;
    for (uint32_t i = 0; i < 12; ++i) {
        if (i == 4) s.workspace->bounds.epoch = 0xfffe;
        if (i == 8) s.workspace->frame.epoch = 0x7ffffffe;
        random_pose(s.pose, s.mesh.vertex_count);
        if (i % 2) soup_shuffle(s.pose, s.mesh.vertex_count);
        if (load_pose(&s)) check_bounds(&s, &tally);
        if (i % 4 == 3) memcpy(s.pose, s.mesh.positions, 49 * 3 * sizeof(double));
    }
    close_scene(&s);
}

/* What was found at the first tick, and never since, is not taken for new when that tick comes
   again. */
static void first_tick_again(void)
{
    soup mesh = soup_cloth(6, 6);
    scene s;
    sc_projection projection;
    if (!open_scene(&s, "cloth", &mesh, SC_WELD_REST, SC_PARTITION_FAST)) return;
    if (CHECK(load_pose(&s))) {
        sc_dnc_projection(&s.workspace->frame, 1u << 2, &projection);
        for (int round = 0; round < 2; ++round) {
            sc_contour_bounds_begin(s.model, &s.workspace->frame.positions[0], &projection,
                                    &s.workspace->bounds);
            CHECK(s.workspace->bounds.epoch == 1);
            for (int line = 0; line < 2; ++line)
                for (uint32_t i = 0; i < s.model->segment_count; ++i) {
                    CHECK(sc_contour_bounds_update(s.model, &s.workspace->bounds, line, i) > 0);
                    CHECK(sc_contour_bounds_update(s.model, &s.workspace->bounds, line, i) == 0);
                }
            s.workspace->bounds.epoch = 0xffff;
        }
    }
    for (int round = 0; round < 2; ++round) {
        s.workspace->frame.epoch = round == 0 ? 0 : 0x7fffffff;
        for (uint32_t i = 0; i < 3 * s.mesh.vertex_count && round == 1; ++i)
            s.pose[i] = test_random_unit();
        s.workspace->worker->kept.some_known[0].epoch = s.workspace->all_known[0].epoch = 1;
        s.workspace->worker->kept.slab[0].epoch = 1;
        if (!load_pose(&s)) break;
        CHECK(s.workspace->frame.epoch == 1);
        CHECK(s.workspace->worker->kept.some_known[0].epoch == (uint32_t)(round == 0));
        CHECK(s.workspace->all_known[0].epoch == (uint32_t)(round == 0));
        CHECK(s.workspace->worker->kept.slab[0].epoch == (uint32_t)(round == 0));
    }
    close_scene(&s);
}

/* ---- the star-contour test ---- */

typedef struct star_tally {
    uint64_t oriented, passed, touching, touching_passed;
    uint64_t simple,
        pinched;        /* passed the exact contour test; of these, two patches at one point */
    uint64_t colliding; /* oriented nodes with a pair inside, which must not pass */
} star_tally;

static int is_in(const sc_model *m, uint32_t patch, uint32_t place)
{
    return place >= sc_model_leaf_first(m)[sc_model_leaf(m)[patch]] &&
           place < sc_model_leaf_first(m)[sc_model_leaf(m)[patch + 1]];
}

/* Whether the oracle's pairs, in places, have one within a node: within its whole, or, if its
   patches share one point, at least between the two. */
static int has_pair(const sc_model *m, uint32_t node, int whole, const sc_pair *pairs,
                    uint64_t count)
{
    uint32_t a = sc_model_node(m)[node].patches.a, b = sc_model_node(m)[node].patches.b;
    int touches = !whole && sc_model_node(m)[node].kind & SC_NODE_TOUCHES;
    for (uint64_t i = 0; i < count; ++i) {
        int first_a = is_in(m, a, pairs[i].a), first_b = is_in(m, b, pairs[i].a);
        int second_a = is_in(m, a, pairs[i].b), second_b = is_in(m, b, pairs[i].b);
        if (touches ? (first_a && second_b) || (first_b && second_a)
                    : (first_a || first_b) && (second_a || second_b))
            return 1;
    }
    return 0;
}

/* The oracle's touching triangle pairs of the pose, as places. */
static oracle_answer solve_in_places(const scene *s)
{
    oracle_answer answer;
    uint32_t *weld = input_weld_of(&s->choices, &s->mesh), i;
    uint32_t *place = (uint32_t *)test_allocate(s->mesh.triangle_count * sizeof(uint32_t));
    oracle_list *list = &answer.lists[SC_PAIRS_TRIANGLE][SC_CONTACT_TOUCHING];
    oracle_solve(s->pose, s->mesh.vertex_count, s->mesh.triangles, s->mesh.triangle_count, weld,
                 &answer);
    for (i = 0; i < s->mesh.triangle_count; ++i) place[sc_model_triangle_id(s->model)[i]] = i;
    for (uint64_t k = 0; k < list->count; ++k) {
        list->pairs[k].a = place[list->pairs[k].a];
        list->pairs[k].b = place[list->pairs[k].b];
    }
    free(place);
    free(weld);
    return answer;
}

/* Every oriented node, under projections of some parts of its cone. */
static void check_stars(scene *s, star_tally *tally)
{
    const sc_model *m = s->model;
    oracle_answer answer = solve_in_places(s);
    const oracle_list *list = &answer.lists[SC_PAIRS_TRIANGLE][SC_CONTACT_TOUCHING];
    uint32_t wrong = 0, node;
    for (node = 0; node < m->node_count; ++node) {
        const sc_pair *patches = &sc_model_node(m)[node].patches;
        uint32_t mask =
            (uint32_t)s->workspace->frame.mask[patches->a] & s->workspace->frame.mask[patches->b];
        int bad, worse, tries, touches = sc_model_node(m)[node].kind & SC_NODE_TOUCHES;
        if (mask == 0) continue;
        bad = has_pair(m, node, 0, list->pairs, list->count);
        worse = has_pair(m, node, 1, list->pairs, list->count);
        for (tries = 0; tries < 3; ++tries) {
            sc_projection projection;
            int passed;
            sc_dnc_projection(&s->workspace->frame, tries == 0 ? mask : random_part(mask),
                              &projection);
            sc_contour_bounds_begin(m, &s->workspace->frame.positions[0], &projection,
                                    &s->workspace->bounds);
            passed = sc_star_test(s->workspace->worker, node);
            wrong += passed && bad;
            passed = sc_simple_test(s->workspace->worker, &projection, node);
            wrong += passed && worse;
            tally->simple += (uint64_t)passed;
            tally->pinched += (uint64_t)(passed && touches);
            passed = sc_star_test(s->workspace->worker, node);
            tally->oriented++;
            tally->passed += (uint64_t)passed;
            tally->touching += (uint64_t)touches;
            tally->touching_passed += (uint64_t)(touches && passed);
            tally->colliding += (uint64_t)bad;
        }
    }
    CHECK_MSG(wrong == 0,
              "%s, partition %s, weld %" PRIu32 ": %" PRIu32 " nodes passed in spite of %" PRIu64
              " pairs",
              s->name, s->choices.partition_name, s->choices.options.weld, wrong, list->count);
    oracle_free(&answer);
}

/* Projected coordinates beyond the range of float, in which bounds are kept. */
static void stars_beyond_float(void)
{
    star_tally tally;
    memset(&tally, 0, sizeof(tally));
    for (uint32_t i = 0; i < test_iterations(100); ++i) {
        scene s;
        open_random_scene(&s, 30 + i % 90);
        random_pose(s.pose, s.mesh.vertex_count);
        soup_scale(s.pose, s.mesh.vertex_count, exp2(test_random_range(105, 140)));
        if (load_pose(&s)) check_stars(&s, &tally);
        close_scene(&s);
    }
    CHECK(!is_full() || (tally.passed > 0 && tally.colliding > 100));
}

static void stars_have_no_pairs(void)
{
    star_tally tally;
    memset(&tally, 0, sizeof(tally));
    for (uint32_t i = 0; i < test_iterations(300); ++i) {
        scene s;
        open_random_scene(&s, 30 + i % 120);
        random_pose(s.pose, s.mesh.vertex_count);
        if (load_pose(&s)) check_stars(&s, &tally);
        close_scene(&s);
    }
    test_note("%" PRIu64 " of %" PRIu64 " passed, %" PRIu64 " of %" PRIu64
              " with one shared point; %" PRIu64 " had pairs inside",
              tally.passed, tally.oriented, tally.touching_passed, tally.touching, tally.colliding);
    CHECK(!is_full() ||
          (6 * tally.passed > tally.oriented && 8 * tally.touching_passed > tally.touching));
    test_note("%" PRIu64 " contours are simple, %" PRIu64 " of these have one shared point",
              tally.simple, tally.pinched);
    CHECK(!is_full() || (tally.simple > tally.passed && 4 * tally.pinched > tally.touching));
    CHECK(!is_full() || tally.colliding > 500);
}

/* Flat, all normals up, and more than once round: the contour alone can tell. */
static void spirals_overlap(void)
{
    star_tally tally;
    memset(&tally, 0, sizeof(tally));
    for (uint32_t i = 0; i < test_iterations(24); ++i) {
        scene s;
        soup mesh = shape_spiral(30 + i, 1 + i % 3, test_random_range(0.3, 2.2), i % 2 ? 0.1 : 0);
        if (!open_scene(&s, "spiral", &mesh, SC_WELD_NONE, i / 2 % 4)) continue;
        rotate(s.pose, s.mesh.vertex_count);
        if (load_pose(&s)) check_stars(&s, &tally);
        close_scene(&s);
    }
    CHECK(!is_full() || (tally.colliding > 500 && tally.passed > 1000));
}

/* A long ribbon that nearly closes to a ring, or goes on over its own start: only edges that are
   far from each other in the contour meet. */
static void long_contours(void)
{
    for (uint32_t i = 0; i < 8; ++i) {
        scene s;
        soup mesh = shape_spiral(1400 + 37 * i, 1, i % 2 ? 1.001 : 0.999, 0);
        sc_projection projection;
        if (open_scene(&s, "ribbon", &mesh, SC_WELD_NONE, SC_PARTITION_FAST) && load_pose(&s) &&
            CHECK(s.workspace->frame.mask[0] != 0)) {
            s.workspace->frame.kernels = sc_kernels_for(1 + i / 2 % (uint32_t)sc_isa_best());
            sc_dnc_projection(&s.workspace->frame, s.workspace->frame.mask[0], &projection);
            CHECK_MSG(sc_simple_test(s.workspace->worker, &projection, 0) == (i % 2 == 0),
                      "ribbon %u", i);
        }
        close_scene(&s);
    }
}

/* A disc that goes twice round its center, and so lies over itself, in a ring of which one patch
   borders on most of it: one segment that is crossed twice, and from the center everything looks
   like a star. */
static void branched_discs(void)
{
    enum { SECTORS = 16 };
    star_tally tally;
    memset(&tally, 0, sizeof(tally));
    for (uint32_t turn = 0; turn < 16; ++turn) {
        soup mesh = soup_make(1 + 2 * SECTORS, 3 * SECTORS);
        uint32_t order[3 * SECTORS], few = 2 + turn % 3 * 2, n = 0;
        sc_tree_node tree[5];
        scene s;
        sc_mesh m;
        memset(mesh.positions, 0, 3 * sizeof(double));
        for (uint32_t i = 0; i < SECTORS; ++i) {
            uint32_t a = 1 + i, b = 1 + (i + 1) % SECTORS;
            uint32_t corners[3][3] = {
                {0, a, b}, {a, a + SECTORS, b}, {b, a + SECTORS, b + SECTORS}};
            for (uint32_t ring = 0; ring < 2; ++ring) {
                double *p = mesh.positions + 3 * (size_t)(a + ring * SECTORS);
                double angle = 4 * pi * i / SECTORS + 0.1 + 0.4 * turn;
                p[0] = (1 + ring) * cos(angle);
                p[1] = (1 + ring) * sin(angle);
                p[2] = 0;
            }
            memcpy(mesh.triangles + 3 * (size_t)i, corners[0], sizeof(corners[0]));
            memcpy(mesh.triangles + 3 * (size_t)(SECTORS + 2 * i), corners[1],
                   2 * sizeof(corners[1]));
        }
        for (uint32_t i = 0; i < 3 * SECTORS; ++i) order[i] = i;
        memset(tree, 0, sizeof(tree)); /* the disc | most of the ring, the rest */
        tree[0].left = 1;
        tree[0].right = 2;
        tree[2].left = 3;
        tree[2].right = 4;
        for (uint32_t i = 1; i < 5; i = i == 1 ? 3 : i + 1) {
            tree[i].left = tree[i].right = SC_NONE;
            tree[i].first = n;
            tree[i].count = i == 1 ? SECTORS : i == 3 ? 2 * SECTORS - few : few;
            n += tree[i].count;
        }
        memset(&s, 0, sizeof(s));
        s.name = "branched disc";
        s.mesh = mesh;
        s.pose = copy_positions(&mesh);
        s.choices.options.struct_size = sizeof(s.choices.options);
        s.choices.options.weld = SC_WELD_NONE;
        s.choices.options.partition = SC_PARTITION_TREE;
        s.choices.options.order = order;
        s.choices.options.tree = tree;
        s.choices.options.tree_count = 5;
        s.choices.partition_name = "tree";
        m = input_plain_mesh(&mesh);
        if (turn % 2) rotate(s.pose, mesh.vertex_count);
        if (CHECK(sc_build(&m, &s.choices.options, &s.model) == SC_OK) &&
            CHECK(sc_workspace_create(s.model, NULL, &s.workspace) == SC_OK) && load_pose(&s))
            check_stars(&s, &tally);
        close_scene(&s);
    }
    CHECK(tally.colliding > 0);
}

/* ---- the exact contour test ---- */

/* A disc that goes twice round its center; its border crosses itself at one point, which both turns
   have. */
static soup crossing_at_a_point(void)
{
    uint32_t sectors = 2 * (3 + test_random_below(5)), twice = sectors / 2;
    double depth = test_random_range(0.05, 0.4), start = test_random_range(0, 2 * pi);
    soup s = soup_make(2 * sectors, 2 * sectors);
    for (uint32_t i = 0; i < 2 * sectors; ++i) {
        uint32_t a = i < twice + sectors ? 1 + i : i == twice + sectors ? 1 + twice : i;
        uint32_t next = (i + 1) % (2 * sectors);
        uint32_t b = next < twice + sectors ? 1 + next : next == twice + sectors ? 1 + twice : next;
        double angle = 2 * pi * i / sectors, radius = 1 + depth * cos(angle / 2);
        s.positions[3 * a] = radius * cos(angle + start);
        s.positions[3 * a + 1] = radius * sin(angle + start);
        s.positions[3 * a + 2] = 0;
        s.triangles[3 * i] = 0;
        s.triangles[3 * i + 1] = a;
        s.triangles[3 * i + 2] = b;
    }
    memset(s.positions, 0, 3 * sizeof(double));
    return s;
}

/* Two discs that share the two points where their borders cross: a part of each is over the
   other. */
static soup crossing_at_two_points(void)
{
    enum { INNER = 2, OUTER = 4, EACH = INNER + OUTER }; /* edges */
    double apart = test_random_range(0.1, 1.5), half = acos(apart / 2), crowded[2][2];
    soup s = soup_make(2 * EACH, 2 * EACH);
    for (uint32_t i = 0; i < 4; ++i) /* points close to one end of an arc */
        crowded[i / 2][i % 2] = test_random_below(3) * 7.0 * (test_random_below(2) ? 1 : -1);
    for (uint32_t i = 0; i < 4; ++i)
        if (crowded[i / 2][i % 2] == 0) crowded[i / 2][i % 2] = 1;
    for (uint32_t disc = 0; disc < 2; ++disc)
        for (uint32_t i = 0; i < EACH; ++i) { /* from the lower crossing over the inner border */
            uint32_t arc = i >= INNER;
            double f = arc ? (double)(i - INNER) / OUTER : (double)i / INNER;
            double g = crowded[disc][arc] < 0 ? 1 - pow(1 - f, -crowded[disc][arc])
                                              : pow(f, crowded[disc][arc]);
            double angle = arc ? half + (2 * pi - 2 * half) * g : half * (2 * g - 1);
            double sign = disc ? -1 : 1;
            uint32_t center = disc * (EACH + 1), p[EACH + 1];
            double *at;
            for (uint32_t k = 0; k <= EACH; ++k) p[k] = center + 1 + k % EACH;
            for (uint32_t k = 0; disc && k <= EACH; ++k) /* the first disc's crossings */
                p[k] = k % EACH == 0       ? 1 + INNER
                       : k % EACH == INNER ? 1
                                           : center + k % EACH - (k % EACH > INNER);
            at = s.positions + 3 * (size_t)p[i];
            at[0] = disc * apart + sign * cos(angle);
            at[1] = sign * sin(angle);
            at[2] = 0;
            at = s.positions + 3 * (size_t)center;
            at[0] = disc * apart;
            at[1] = at[2] = 0;
            s.triangles[3 * (disc * EACH + i)] = center;
            s.triangles[3 * (disc * EACH + i) + 1] = p[i];
            s.triangles[3 * (disc * EACH + i) + 2] = p[i + 1];
        }
    return s;
}

/* A triangle whose side two others share, cut at a point that is on it, or off by very little. */
static soup side_in_two(void)
{
    static const uint32_t triangles[] = {0, 2, 3, 2, 1, 3, 1, 0, 4};
    soup s = soup_make(5, 3);
    double off = test_random_below(3) == 0
                     ? 0
                     : test_random_range(-1, 1) * exp2(-10 - (double)test_random_below(50));
    double along = test_random_below(2) ? 0.5 : test_random_range(0.05, 0.95);
    double positions[] = {0, 0, 0, 1, 0, 0, along, off, 0, 0.5, 1, 0, 0.5, -1, 0};
    memcpy(s.positions, positions, sizeof(positions));
    memcpy(s.triangles, triangles, sizeof(triangles));
    return s;
}

/* Discs round each other, with or without a hole: each fan of them turns left. */
static soup nested_discs(void)
{
    uint32_t sides = 3 + test_random_below(4), rings = 2 + test_random_below(3), n = 0;
    soup s = soup_make(2 * rings * sides, 2 * rings * sides);
    for (uint32_t ring = 0; ring < rings; ++ring) {
        double outer = test_random_range(0.2, 1), inner = outer * test_random_range(0.3, 0.9);
        double x = test_random_range(-0.6, 0.6), y = test_random_range(-0.6, 0.6);
        for (uint32_t i = 0; i < sides; ++i) {
            uint32_t a = 2 * (ring * sides + i), b = 2 * (ring * sides + (i + 1) % sides);
            double angle = 2 * pi * i / sides;
            uint32_t corners[2][3] = {{a, a + 1, b}, {a + 1, b + 1, b}};
            for (uint32_t k = 0; k < 2; ++k) {
                double *p = s.positions + 3 * (size_t)(a + k);
                p[0] = x + (k ? outer : inner) * cos(angle);
                p[1] = y + (k ? outer : inner) * sin(angle);
                p[2] = 0;
            }
            memcpy(s.triangles + 6 * (size_t)n++, corners, sizeof(corners));
        }
    }
    return s;
}

/* Contours of several loops that lie in each other, beside each other, or across. */
static void contours_in_pieces(void)
{
    star_tally tally;
    memset(&tally, 0, sizeof(tally));
    for (uint32_t i = 0; i < test_iterations(300); ++i) {
        scene s;
        soup mesh = nested_discs();
        if (!open_scene(&s, "nested discs", &mesh, SC_WELD_NONE, i % 4)) continue;
        if (i / 4 % 2) rotate(s.pose, s.mesh.vertex_count);
        if (load_pose(&s)) check_stars(&s, &tally);
        close_scene(&s);
    }
    CHECK(!is_full() || (tally.colliding > 300 && tally.simple > 300));
}

/* A triangle whose corner is in the middle of the straight border of two others, and of one point
   with it. */
static soup corner_at_side(void)
{
    static const uint32_t triangles[] = {1, 0, 3, 0, 2, 3, 0, 4, 5, 1, 0, 3, 0, 2, 3};
    static const double positions[] = {0, 0, 0, -1,   0,  0, 1,   0,  0,
                                       0, 1, 0, -0.5, -1, 0, 0.5, -1, 0};
    soup s = soup_make(6, 3);
    memcpy(s.positions, positions, sizeof(positions));
    memcpy(s.triangles, triangles + 3 * test_random_below(3), 9 * sizeof(uint32_t));
    for (uint32_t i = 0; i < 4; ++i) /* not beyond the side; one of them may touch it */
        s.positions[12 + i % 2 + 3 * (i / 2)] *= test_random_range(0, 1);
    return s;
}

/* Contours that touch or cross themselves at points they share, and nowhere else. */
static void contours_at_shared_points(void)
{
    star_tally tally;
    memset(&tally, 0, sizeof(tally));
    for (uint32_t i = 0; i < test_iterations(300); ++i) {
        scene s;
        soup mesh = i % 4 == 0   ? crossing_at_a_point()
                    : i % 4 == 1 ? crossing_at_two_points()
                    : i % 4 == 2 ? side_in_two()
                                 : corner_at_side();
        if (!open_scene(&s, "shared points", &mesh, SC_WELD_NONE, i / 4 % 4)) continue;
        if (i / 16 % 2) rotate(s.pose, s.mesh.vertex_count);
        if (load_pose(&s)) check_stars(&s, &tally);
        close_scene(&s);
    }
    CHECK(!is_full() || (tally.colliding > 300 && tally.simple > 30));
}

/* x = axis . ((p - center) scale - from), exactly. */
static void exact_place(mpq_t result, const sc_workspace *w, uint32_t point, const float axis[3],
                        const float from[3])
{
    mpq_t a, b;
    mpq_inits(a, b, NULL);
    mpq_set_ui(result, 0, 1);
    for (int k = 0; k < 3; ++k) {
        mpq_set_d(a, part(w, point, k));
        mpq_set_d(b, w->frame.center[k]);
        mpq_sub(a, a, b);
        mpq_set_d(b, w->frame.scale);
        mpq_mul(a, a, b);
        mpq_set_d(b, (double)from[k]);
        mpq_sub(a, a, b);
        mpq_set_d(b, (double)axis[k]);
        mpq_mul(a, a, b);
        mpq_add(result, result, a);
    }
    mpq_clears(a, b, NULL);
}

/* The points that a contour has in its list, with those between which there is no edge. */
static uint32_t count_listed(const sc_model *m, uint32_t node)
{
    const sc_node *n = sc_model_node(m) + node;
    uint32_t listed = 0, i = n->contour + (n->kind & SC_NODE_TOUCHES ? 2 : 0);
    uint32_t before = SC_NONE;
    for (; i < n[1].contour; ++i) {
        uint32_t segment = sc_model_contours(m)[i];
        uint32_t first = sc_model_segment_first(m)[segment],
                 last = sc_model_segment_last(m)[segment];
        listed += last - first + (sc_model_points(m)[first] != before);
        before = sc_model_points(m)[last];
    }
    return listed;
}

/* Points in the unit box are in it, and off by what the bounds allow for, whatever the pose's
   size. */
static void points_in_the_unit_box(void)
{
    static const float axis[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, origin[3] = {0, 0, 0};
    double worst = 0, largest = 0;
    uint32_t differ = 0;
    mpq_t exact, place;
    mpq_inits(exact, place, NULL);
    for (uint32_t round = 0; round < test_iterations(200); ++round) {
        scene s;
        open_random_scene(&s, 40);
        random_pose(s.pose, s.mesh.vertex_count);
        soup_move(s.pose, s.mesh.vertex_count, test_random_range(-2, 2));
        if (round % 2)
            soup_scale(s.pose, s.mesh.vertex_count, exp2(test_random_range(-1074, 1000)));
        if (load_pose(&s))
            for (uint32_t i = 0; i < 3 * SC_LEAF_POINTS * s.model->leaf_count; ++i) {
                uint32_t leaf = i / 3 / SC_LEAF_POINTS, k = i % 3, at = i / 3 % SC_LEAF_POINTS;
                uint32_t point = sc_model_leaf_point(s.model)[SC_LEAF_POINTS * leaf + at];
                uint32_t turned = SC_LEAF_POINTS * leaf + sc_loops_turn(at);
                double off, unit = (double)s.workspace->frame.point_at[4 * turned + k];
                float one[3];
                sc_positions_unit(&s.workspace->frame, point, one);
                differ += one[k] != (float)unit;
                exact_place(exact, s.workspace, point, axis[k], origin);
                mpq_set_d(place, unit);
                mpq_sub(place, place, exact);
                off = fabs(mpq_get_d(place));
                if (off > worst) worst = off;
                if (fabs(unit) > largest) largest = fabs(unit);
            }
        close_scene(&s);
    }
    CHECK_MSG(worst <= 3e-8 && largest <= 1, "off by %g, up to %g", worst, largest);
    CHECK(differ == 0); /* from what one point alone gives */
    CHECK(!is_full() || (worst > 0x1.8p-26 && largest > 0.9));
    mpq_clears(exact, place, NULL);
}

/* Positions of any type, stride, alignment and size, with vertices that are used, welded or not
   used at all, are read as each alone is, by all instructions alike, and nothing behind the last
   one; points in the unit box are where they should. */
static void poses_of_any_layout(void)
{
    static const struct layout {
        uint32_t type, gap, shift; /* bytes after each vertex, and before the first */
    } layouts[] = {{SC_DOUBLE, 0, 0}, {SC_DOUBLE, 8, 0}, {SC_DOUBLE, 0, 1}, {SC_DOUBLE, 13, 3},
                   {SC_FLOAT, 0, 0},  {SC_FLOAT, 4, 0},  {SC_FLOAT, 0, 2},  {SC_FLOAT, 9, 5}};
    uint32_t wrong = 0;
    for (uint32_t round = 0; round < test_iterations(60); ++round) {
        scene s;
        open_random_scene(&s, round % 3 ? 60 : 300);
        random_pose(s.pose, s.mesh.vertex_count);
        if (round % 2) { /* where floats are hardly large or small enough, or sums too large */
            double largest = 1, size = exp2(test_random_range(-150, 120));
            if (round % 4 == 3) size = round % 8 == 3 ? 0x1.8p127 : 0x1.8p1023;
            for (uint32_t i = 0; i < 3 * s.mesh.vertex_count; ++i)
                largest = fmax(largest, fabs(s.pose[i]));
            soup_scale(s.pose, s.mesh.vertex_count, size / largest);
        }
        for (size_t l = 0; l < sizeof(layouts) / sizeof(layouts[0]); ++l) {
            const struct layout *layout = &layouts[l];
            const size_t size = layout->type == SC_DOUBLE ? sizeof(double) : sizeof(float);
            const size_t stride = 3 * size + layout->gap;
            const size_t bytes = layout->shift + s.mesh.vertex_count * stride - layout->gap;
            unsigned char *memory = (unsigned char *)test_allocate(bytes);
            double low[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL};
            double high[3] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
            int is_finite = 1;
            sc_pose pose = input_plain_pose(s.pose, s.mesh.vertex_count);
            for (uint32_t i = 0; i < 3 * s.mesh.vertex_count; ++i) {
                unsigned char *at = memory + layout->shift + i / 3 * stride + i % 3 * size;
                float f = (float)s.pose[i];
                double d = layout->type == SC_DOUBLE ? s.pose[i] : (double)f;
                memcpy(at, layout->type == SC_DOUBLE ? (void *)&s.pose[i] : (void *)&f, size);
                if (sc_model_vertex_use(s.model)[i / 3] == SC_VERTEX_UNUSED) continue;
                low[i % 3] = fmin(low[i % 3], d);
                high[i % 3] = fmax(high[i % 3], d);
                is_finite &= isfinite(d) != 0;
            }
            pose.positions = memory + layout->shift;
            pose.position_type = layout->type;
            for (uint32_t isa = SC_ISA_BASE; isa <= (uint32_t)sc_isa_best(); ++isa) {
                sc_workspace *w = s.workspace;
                w->frame.kernels = sc_kernels_for(isa);
                sc_workspace_begin(s.model, w, &nothing_asked);
                if (is_finite != (sc_positions_read(s.model, &pose, stride, &w->frame) == SC_OK))
                    ++wrong;
                if (!is_finite) continue; /* too large for floats */
                sc_dnc_update(s.model, &w->frame);
                for (uint32_t k = 0; k < 3; ++k) {
                    double middle = low[k] / 2 + high[k] / 2;
                    if (layout->type == SC_FLOAT) middle = (double)(float)middle;
                    wrong += w->frame.center[k] != middle;
                }
                for (uint32_t i = 0; i < SC_LEAF_POINTS * s.model->leaf_count; ++i) {
                    uint32_t point = sc_model_leaf_point(s.model)[i];
                    const float *at = w->frame.point_at + 4 * sc_loops_turn(i);
                    double p[3];
                    float one[3];
                    sc_positions_get(&w->frame.positions[0], point, p);
                    sc_positions_unit(&w->frame, point, one);
                    for (uint32_t k = 0; k < 3; ++k) {
                        double d = s.pose[3 * point + k];
                        wrong += p[k] != (layout->type == SC_DOUBLE ? d : (double)(float)d);
                        wrong += at[k] != one[k];
                        d = (p[k] - w->frame.center[k]) * w->frame.scale;
                        wrong += fabs((double)one[k] - d) > 3e-8;
                    }
                    wrong += at[3] != 0;
                }
            }
            free(memory);
        }
        close_scene(&s);
    }
    CHECK_MSG(wrong == 0, "%" PRIu32 " coordinates", wrong);
}

/* Point i of the contour of a node that was tested. */
static uint32_t tested_point(const scene *s, uint32_t node, uint32_t i)
{
    const sc_model *m = s->model;
    const uint32_t *leaf = sc_model_leaf(m);
    const sc_node *n = sc_model_node(m) + node;
    const sc_pair *patches = &n->patches;
    uint32_t split = leaf[patches->a + 1] - leaf[patches->a], number, cluster;
    if (!n->loop_length) return s->workspace->worker->contour.point[i];
    if (n->kind & SC_NODE_PIECES)
        return sc_model_leaf_point(m)[sc_loops_turn(s->workspace->worker->contour.point[i])];
    number = sc_model_loop(m)[n->loop + i % n->loop_length];
    cluster = number / SC_LEAF_POINTS;
    cluster = cluster < split ? leaf[patches->a] + cluster : leaf[patches->b] + cluster - split;
    return sc_model_leaf_point(
        m)[SC_LEAF_POINTS * cluster + sc_loops_turn(number % SC_LEAF_POINTS)];
}

/* How many places the pieces of a node's loop are listed in, and the place of what is about the
   middle of its points. */
static uint32_t list_pieces(const scene *s, uint32_t node, uint32_t *middle)
{
    const uint16_t *loop = sc_model_loop(s->model) + sc_model_node(s->model)[node].loop;
    uint32_t edges = 0, places = 0, before = 0;
    for (uint32_t p = 0; p < loop[0]; ++p) edges += loop[1 + p];
    for (uint32_t p = 0; p < loop[0]; ++p) {
        if (before <= edges / 2) *middle = places + edges / 2 - before;
        before += loop[1 + p];
        places += (loop[1 + p] / (uint32_t)SC_CONTOUR_GAP + 1) * SC_CONTOUR_GAP;
    }
    return places;
}

/* Whether the error that a contour carries when it is projected is less than that of a point as far
   from the middle as its points are, in any of the three axes. */
static uint32_t is_too_sure(const scene *s, const sc_projection *projection, uint32_t node,
                            const float from[3], uint32_t listed, int has_gaps)
{
    const sc_contour_edges *e = &s->workspace->worker->contour;
    sc_simple_contour c;
    float most = 0;
    memset(&c, 0, sizeof(c));
    if (!sc_simple_start(&c, s->model, &s->workspace->worker->contour, node)) return 0;
    sc_simple_axes(&c, projection);
    memcpy(c.from, from, sizeof(c.from));
    s->workspace->frame.kernels->query->project(&c, &s->workspace->frame);
    for (uint32_t i = 0; i < listed; ++i) {
        float unit[3];
        if (has_gaps && (e->is_edge[i / SC_CONTOUR_BLOCK] >> i % SC_CONTOUR_BLOCK & 1) == 0)
            continue;
        sc_positions_unit(&s->workspace->frame, tested_point(s, node, i), unit);
        for (int k = 0; k < 3; ++k) most = fmaxf(most, fabsf(unit[k] - from[k]));
    }
    return c.error < sc_bounds_contour(most);
}

/* The boxes of spans of two edges hold the true places of their ends, however the contour is seen:
   from above, or from one end, so that it is small for the size that it has; and whatever its
   size. */
static void places_of_contours(void)
{
    mpq_t exact, bound;
    mpq_inits(exact, bound, NULL);
    for (uint32_t round = 0; round < test_iterations(120); ++round) {
        soup mesh = soup_cloth(5, 5);
        double flat = exp2(-(double)test_random_below(40)), move = test_random_range(-9, 9);
        sc_projection projection;
        scene s;
        if (!open_scene(&s, "cloth", &mesh, SC_WELD_REST, SC_PARTITION_FAST)) break;
        sc_dnc_projection(&s.workspace->frame,
                          1 + test_random_below((1 << SC_DNC_DIRECTIONS / 2) - 1), &projection);
        for (uint32_t v = 0; v < mesh.vertex_count; ++v) {
            double along = test_random_range(-1, 1);
            const double *u = projection.u, *w = projection.w;
            for (int k = 0; k < 3; ++k) {
                double down = u[(k + 1) % 3] * w[(k + 2) % 3] - u[(k + 2) % 3] * w[(k + 1) % 3];
                s.pose[3 * v + (uint32_t)k] =
                    1e-5 * along * down + flat * test_random_range(-1, 1) + move;
            }
        }
        if (round % 3 == 2) { /* all but one corner far smaller than the pose's box */
            double shrink = exp2(-(double)test_random_below(24));
            for (uint32_t i = 3; i < 3 * mesh.vertex_count; ++i)
                s.pose[i] = s.pose[i % 3] + 7 * (i % 3 + 1) + shrink * (s.pose[i] - s.pose[i % 3]);
        }
        if (round % 5 > 1) /* long in one axis alone */
            for (uint32_t i = 0; i < 3 * mesh.vertex_count; ++i)
                if (i % 3 != round % 5 - 2) s.pose[i] *= 0x1p-12;
        if (round % 4 == 3)
            soup_scale(s.pose, mesh.vertex_count,
                       exp2(test_random_below(2) ? test_random_range(1008, 1012)
                                                 : test_random_range(-1060, 1012)));
        if (load_pose(&s)) {
            const sc_contour_edges *e = &s.workspace->worker->contour;
            uint32_t wrong = 0, edges = 0, too_sure = 0;
            for (uint32_t node = 0; node < s.model->node_count; ++node) {
                const uint32_t length = sc_model_node(s.model)[node].loop_length;
                int in_pieces = sc_model_node(s.model)[node].kind & SC_NODE_PIECES;
                int has_gaps = !length || in_pieces;
                uint32_t listed = length ? length : count_listed(s.model, node);
                uint32_t middle;
                float from[3], one[3], other[3];
                int passed;
                if (listed == 0) continue;
                middle = listed / 2;
                if (length && in_pieces) listed = list_pieces(&s, node, &middle);
                s.workspace->frame.kernels = sc_kernels_for(1 + node % (uint32_t)sc_isa_best());
                passed = sc_simple_test(s.workspace->worker, &projection, node);
                sc_positions_unit(&s.workspace->frame, tested_point(&s, node, 0), one);
                sc_positions_unit(&s.workspace->frame, tested_point(&s, node, middle), other);
                for (int k = 0; k < 3; ++k) from[k] = one[k] / 2 + other[k] / 2;
                too_sure += is_too_sure(&s, &projection, node, from, listed, has_gaps);
                if (!passed && listed > SC_CONTOUR_BLOCK) listed = SC_CONTOUR_BLOCK; /* at least */
                for (uint32_t i = 0; i < listed; ++i) {
                    if (has_gaps &&
                        (e->is_edge[i / SC_CONTOUR_BLOCK] >> i % SC_CONTOUR_BLOCK & 1) == 0)
                        continue;
                    ++edges;
                    for (uint32_t j = 0; j < 4; ++j) { /* x and y of both ends */
                        const double *v = j % 2 ? projection.w : projection.u;
                        float axis[3];
                        int exponent;
                        (void)frexp(fabs(v[0]) + fabs(v[1]) + fabs(v[2]), &exponent);
                        for (int k = 0; k < 3; ++k) axis[k] = (float)ldexp(v[k], -exponent);
                        exact_place(exact, s.workspace, tested_point(&s, node, i + j / 2), axis,
                                    from);
                        mpq_set_d(bound, (double)e->span_side[2 * (j % 2)][i / 2]);
                        wrong += mpq_cmp(exact, bound) < 0;
                        mpq_set_d(bound, (double)e->span_side[2 * (j % 2) + 1][i / 2]);
                        wrong += mpq_cmp(exact, bound) > 0;
                    }
                }
            }
            CHECK_MSG(!too_sure, "%" PRIu32 " errors are too small", too_sure);
            CHECK_MSG(wrong == 0 && edges > 100, "flat %g: %" PRIu32 " places of %" PRIu32 " edges",
                      flat, wrong, edges);
        }
        close_scene(&s);
    }
    mpq_clears(exact, bound, NULL);
}

static double cross(const double a[2], const double b[2])
{
    return a[0] * b[1] - a[1] * b[0];
}

/* Whether v is in the sector that begins with a, lies to its left, and ends with b. */
static int is_in_sector(const double a[2], const double b[2], const double v[2])
{
    if (cross(a, b) > 0) return cross(a, v) > 0 && cross(v, b) > 0;
    return cross(a, v) > 0 || cross(v, b) > 0;
}

/*
 * A point that a contour passes twice, its four edges in any directions, some nearly the same or
 * opposite: it is fine only if they alternate, and then always if no two of them are nearly on one
 * line.
 */
static void pinches_alone(void)
{
    uint32_t wrong = 0, missed = 0, fine = 0, doubtful = 0;
    for (uint32_t i = 0; i < test_iterations_at_least(40000, 8000); ++i) {
        enum { POINTS = 6, ROOM = 32 };
        /* the point, out, in, the point, out, in: where the second in precedes the first out */
        float at[2][ROOM] = {{0}};
        double v[4][2], angle = test_random_range(0, 2 * pi), least = HUGE_VAL, sizes = 0;
        int inside, result;
        sc_contour_edges edges;
        sc_simple_contour c;
        memset(&edges, 0, sizeof(edges));
        memset(&c, 0, sizeof(c));
        c.edges = &edges;
        c.count = POINTS;
        c.error = 1e-6f;
        c.pinch_count = 1;
        c.pinch[0].edge[1] = 3;
        for (int k = 0; k < 2; ++k) edges.at[k] = at[k];
        for (int n = 0; n < 4; ++n) { /* out, out, in, in */
            static const int place[4] = {1, 4, 2, 5};
            double turn = angle + (test_random_below(2) ? pi : 0), length = test_random_unit();
            turn +=
                test_random_below(4) ? test_random_range(-1e-4, 1e-4) : test_random_range(-2, 2);
            if (test_random_below(4) == 0) length *= 0.01;
            at[0][place[n]] = (float)(length * cos(turn));
            at[1][place[n]] = (float)(length * sin(turn));
            for (int k = 0; k < 2; ++k) {
                v[n][k] = (double)at[k][place[n]];
                sizes += fabs(v[n][k]);
            }
        }
        for (int k = 0; k < 2; ++k) at[k][POINTS] = at[k][0];
        for (int n = 0; n < 4; ++n)
            for (int m = 0; m < n; ++m) least = fmin(least, fabs(cross(v[n], v[m])));
        if (least == 0) continue;
        inside = is_in_sector(v[0], v[1], v[2]) + is_in_sector(v[0], v[1], v[3]);
        result = sc_simple_is_wound_well(&c);
        wrong += result && inside != 1;
        missed += !result && inside == 1 && least > 100e-6 * sizes;
        fine += result != 0;
        doubtful += !result && inside == 1;
    }
    CHECK_MSG(!wrong && !missed, "%" PRIu32 " wrong, %" PRIu32 " missed", wrong, missed);
    CHECK_MSG(fine > 500 && doubtful > 100, "%" PRIu32 " fine, %" PRIu32 " doubtful", fine,
              doubtful);
}

/* A node whose contour is a loop of at least so many points, in one piece, none of those twice;
   SC_NONE: there is none. */
static uint32_t long_loop(const sc_model *m, uint32_t least)
{
    for (uint32_t node = 0; node < m->node_count; ++node) {
        const sc_node *n = sc_model_node(m) + node;
        const uint16_t *loop = sc_model_loop(m) + n->loop;
        int twice = (n->kind & SC_NODE_PIECES) != 0;
        if (n->loop_length < least) continue;
        for (uint32_t i = 0; i < least; ++i)
            for (uint32_t j = 0; j < i; ++j) twice |= loop[i] == loop[j];
        if (!twice) return node;
    }
    return SC_NONE;
}

/* Moves the first points of a loop, as they are kept in the unit box; the second is higher by
   lift. */
static void move_loop(const scene *s, uint32_t node, float at[][2], uint32_t count, float lift)
{
    const uint32_t *leaf = sc_model_leaf(s->model);
    const sc_pair *patches = &sc_model_node(s->model)[node].patches;
    const uint16_t *loop = sc_model_loop(s->model) + sc_model_node(s->model)[node].loop;
    sc_simple_contour c;
    memset(&c, 0, sizeof(c));
    c.first = SC_LEAF_POINTS * leaf[patches->a];
    c.split = SC_LEAF_POINTS * leaf[patches->a + 1] - c.first;
    c.second = SC_LEAF_POINTS * leaf[patches->b] - c.split;
    for (uint32_t i = 0; i < count; ++i) {
        float *to = s->workspace->frame.point_at + 4 * (size_t)sc_simple_place(&c, loop[i]);
        to[0] = at[i][0];
        to[1] = at[i][1];
        to[2] = i == 1 ? 0.5f + lift : 0.5f;
    }
}

/* What the test of small contours says of a polygon, seen from above, as if it were the contour of
   a node with a longer one. */
static unsigned tell_small(scene *s, uint32_t node, float at[][2], uint32_t count, float lift)
{
    const uint32_t blocks = (count + SC_CONTOUR_BLOCK - 1) / SC_CONTOUR_BLOCK;
    float above[2 * 3 * SC_DNC_VECTORS] = {0};
    const float *axes = above;
    sc_node *n = (sc_node *)(uintptr_t)(sc_model_node(s->model) + node);
    const uint16_t length = n->loop_length;
    unsigned simple;
    above[0] = above[4 * SC_DNC_VECTORS] = 1;
    move_loop(s, node, at, count, lift);
    n->loop_length = (uint16_t)count;
    simple = s->workspace->frame.kernels->query->find_simple(s->workspace->worker, &node, 1, blocks,
                                                             &axes);
    n->loop_length = length;
    return simple;
}

/* A polygon of which edge i, from left to right, crosses the one that begins at point j, from above
   to below, and no others meet; or a convex one, if i is j. Between them it runs along a circle. */
static void crossed_polygon(float at[][2], uint32_t count, double size, uint32_t i, uint32_t j)
{
    const uint32_t on = j - i;
    for (uint32_t k = 0; k < count; ++k) {
        double angle = 2 * pi * k / count;
        float *to = at[(i + 1 + k) % count];
        if (on)
            angle =
                k < on ? pi / 2 * k / (on - 1) : pi * 1.5 - pi / 2 * (k - on) / (count - on - 1);
        to[0] = (float)(0.5 + size * cos(angle));
        to[1] = (float)(0.5 + size * sin(angle));
    }
}

/* A square with a slot from above; where it begins a number of a cell ends. */
static void slotted_square(float at[12][2], float size, uint32_t width)
{
    static const float shape[12][2] = {{-1, -1},  {0, -1},   {1, -1},   {1, -0.3f},
                                       {1, 0.2f}, {1, 0.6f}, {1, 1},    {0, 0.9f},
                                       {0, 0},    {0, 0},    {0, 0.9f}, {-1, 1}};
    float wall = (float)(0.5 + 10.5 * (double)size / 126);
    for (uint32_t i = 0; i < 12; ++i)
        for (uint32_t k = 0; k < 2; ++k) at[i][k] = 0.5f + size * shape[i][k];
    if ((double)wall > 0.5 + 10.5 * (double)size / 126) wall = nextafterf(wall, 0);
    at[9][0] = at[10][0] = wall;
    while (width-- > 0) wall = nextafterf(wall, 1);
    at[7][0] = at[8][0] = wall;
}

/* Small contours by themselves: convex ones are simple, and those of which any two edges cross are
   not, by any instruction set. Edges that may meet, as far as their places are known, are not
   apart, whatever cells they are in. */
static void small_contours(void)
{
    uint32_t told = 0, missed = 0, node;
    float at[64][2];
    scene s;
    soup mesh = soup_cloth(40, 40);
    if (!open_scene(&s, "small", &mesh, SC_WELD_NONE, SC_PARTITION_FAST) || !load_pose(&s)) return;
    node = long_loop(s.model, 64);
    if (!CHECK(node != SC_NONE)) return;
    for (uint32_t isa = 1; isa <= (uint32_t)sc_isa_best(); ++isa) {
        s.workspace->frame.kernels = sc_kernels_for(isa);
        for (uint32_t count = SC_SMALL_EDGES; count <= 64; ++count) {
            double size = test_random_below(2) ? 0.4 : 1e-4;
            crossed_polygon(at, count, size, 0, 0);
            told += tell_small(&s, node, at, count, 0);
            for (uint32_t i = 0; i < count; ++i)
                for (uint32_t j = i + 2; j < count && (i || j + 1 < count); ++j) {
                    crossed_polygon(at, count, size, i, j);
                    missed += tell_small(&s, node, at, count, 0);
                }
        }
        slotted_square(at, 0.25f, 100000);
        CHECK(tell_small(&s, node, at, 12, 0) == 1);
        for (uint32_t width = 0; width <= 2; ++width) {
            slotted_square(at, 0.25f, width);
            CHECK_MSG(!tell_small(&s, node, at, 12, 0), "a slot of %" PRIu32, width);
        }
        slotted_square(at, 1 / 32768.0f, 8); /* wide enough, but not for one so high */
        CHECK(tell_small(&s, node, at, 12, 0) == 1);
        CHECK(!tell_small(&s, node, at, 12, 0.45f));
        slotted_square(at, 1 / 1048576.0f, 1);
        CHECK(!tell_small(&s, node, at, 12, 0));
    }
    CHECK_MSG(told == 56 * (uint32_t)sc_isa_best(), "%" PRIu32 " are simple", told);
    CHECK_MSG(!missed, "%" PRIu32 " that are not", missed);
    close_scene(&s);
}

/* Contours of more edges than one row of spans: convex ones pass, and those of which any two edges
   cross, and no others meet, do not, by any instruction set. */
static void two_edges_that_cross(void)
{
    static const uint32_t counts[] = {33, 34, 40, 47, 48, 49, 64, 65, 66, 67, 97, 128, 129, 160};
    enum { MOST = 160 };
    const sc_projection above = {{1, 0, 0}, {0, 1, 0}, {0, 0, 0}, 0, 0};
    uint32_t told = 0, missed = 0, node;
    float at[MOST][2];
    scene s;
    soup mesh = soup_cloth(60, 60);
    if (!open_scene(&s, "crossing", &mesh, SC_WELD_NONE, SC_PARTITION_FAST) || !load_pose(&s))
        return;
    node = long_loop(s.model, MOST);
    if (!CHECK(node != SC_NONE)) return;
    for (uint32_t isa = 1; isa <= (uint32_t)sc_isa_best(); ++isa)
        for (uint32_t k = 0; k < sizeof(counts) / sizeof(*counts); ++k) {
            const uint32_t count = counts[k];
            sc_node *n = (sc_node *)(uintptr_t)(sc_model_node(s.model) + node);
            const uint16_t length = n->loop_length;
            s.workspace->frame.kernels = sc_kernels_for(isa);
            n->loop_length = (uint16_t)count;
            crossed_polygon(at, count, 0.4, 0, 0);
            move_loop(&s, node, at, count, 0);
            told += sc_simple_test(s.workspace->worker, &above, node) != 0;
            for (uint32_t i = 0; i < count; ++i)
                for (uint32_t j = i + 2; j < count && (i || j + 1 < count); ++j) {
                    crossed_polygon(at, count, 0.4, i, j);
                    move_loop(&s, node, at, count, 0);
                    missed += sc_simple_test(s.workspace->worker, &above, node) != 0;
                }
            n->loop_length = length;
        }
    CHECK_MSG(told == 14 * (uint32_t)sc_isa_best(), "%" PRIu32 " are simple", told);
    CHECK_MSG(!missed, "%" PRIu32 " that are not", missed);
    close_scene(&s);
}

/* Contours that are looked at together pass or fail as each does by itself. */
static void contours_together(void)
{
    enum { MOST = 60 };
    uint32_t wrong = 0, in_pieces = 0, count[2] = {0, 0};
    for (uint32_t round = 0; round < test_iterations(30); ++round) {
        scene s;
        soup mesh = round % 4 == 0   ? soup_cloth(30 + round, 20)
                    : round % 4 == 1 ? soup_sphere(20 + round, 16)
                    : round % 4 == 2 ? soup_branched(8 + round, 10)
                                     : nested_discs();
        uint32_t nodes[MOST], most = 1 + test_random_below(MOST), n = 0;
        uint8_t passed[MOST];
        if (!open_scene(&s, "together", &mesh, SC_WELD_NONE, SC_PARTITION_FAST)) continue;
        if (round % 4 < 2) soup_smooth(s.pose, s.mesh.vertex_count, 0.02 * round);
        if (!load_pose(&s)) continue;
        s.workspace->frame.kernels = sc_kernels_for(1 + round % (uint32_t)sc_isa_best());
        for (uint32_t p = 0; p < s.model->patch_end && round % 3 == 1; ++p) /* seen from anywhere */
            s.workspace->frame.mask[p] = (uint16_t)(1u << test_random_below(SC_DNC_DIRECTIONS) |
                                                    1u << test_random_below(SC_DNC_DIRECTIONS));
        for (uint32_t node = 0; node < s.model->node_count; ++node) {
            const sc_pair *patches = &sc_model_node(s.model)[node].patches;
            if (s.workspace->frame.mask[patches->a] & s.workspace->frame.mask[patches->b])
                nodes[n++] = node;
            if (n < most && node + 1 < s.model->node_count) continue;
            sc_simple_tests(s.workspace->worker, nodes, n, passed);
            for (uint32_t i = 0; i < n; ++i) {
                sc_projection projection;
                patches = &sc_model_node(s.model)[nodes[i]].patches;
                sc_dnc_projection(&s.workspace->frame,
                                  (uint32_t)s.workspace->frame.mask[patches->a] &
                                      s.workspace->frame.mask[patches->b],
                                  &projection);
                wrong += sc_simple_test(s.workspace->worker, &projection, nodes[i]) != passed[i];
                ++count[passed[i] != 0];
                in_pieces += (sc_model_node(s.model)[nodes[i]].kind & SC_NODE_PIECES) != 0;
            }
            n = 0;
        }
        close_scene(&s);
    }
    CHECK_MSG(!wrong, "%" PRIu32 " of %" PRIu32 " differ", wrong, count[0] + count[1]);
    CHECK(!is_full() || (count[0] > 50 && count[1] > 1000 && in_pieces > 10));
    printf("    contours_together: %" PRIu32 " pass, %" PRIu32 " do not\n", count[1], count[0]);
}

/* Whether a contour is one that may be left open though it is simple: if it passes a point three
   times, how its edges lie round that is not looked at; if pieces share a point, one of them may
   begin there, of which nobody can say then how often the others go round it. */
static int is_left_open(const sc_model *model, const sc_workspace *workspace, uint32_t node)
{
    uint32_t most = 0;
    sc_simple_contour c;
    if (!sc_simple_list(&c, model, &workspace->worker->contour, node)) return 0;
    for (uint32_t i = 0; i < c.count; ++i) {
        uint32_t begin = 0;
        for (uint32_t k = 0; k < c.count; ++k)
            begin += c.edges->point[k] == c.edges->point[i] &&
                     (c.edges->is_edge[k / SC_CONTOUR_BLOCK] >> k % SC_CONTOUR_BLOCK & 1);
        if (begin > most) most = begin;
    }
    return most > 2 || (most > 1 && c.in_pieces);
}

/* A flat square grid, in any direction: no contour crosses itself, and where two patches share one
   point the lines of the grid go straight on from one to the other. */
static void flat_cloths_pass(void)
{
    enum { ALL_PASS = 12 }; /* in the first of these cloths; none of --scale 100 is left open */
    uint32_t touching = 0, all = 0, open = 0;
    for (uint32_t i = 0; i < test_iterations(ALL_PASS); ++i) {
        scene s;
        soup mesh = soup_cloth(20 + i, 30);
        if (!open_scene(&s, "flat cloth", &mesh, SC_WELD_NONE, SC_PARTITION_FAST)) continue;
        if (i % 3) rotate(s.pose, s.mesh.vertex_count);
        if (load_pose(&s)) {
            uint32_t failed = 0, node;
            s.workspace->frame.kernels = sc_kernels_for(1 + i % (uint32_t)sc_isa_best());
            for (node = 0; node < s.model->node_count; ++node) {
                const sc_pair *patches = &sc_model_node(s.model)[node].patches;
                uint32_t mask = (uint32_t)s.workspace->frame.mask[patches->a] &
                                s.workspace->frame.mask[patches->b];
                sc_projection projection;
                sc_dnc_projection(&s.workspace->frame, mask, &projection);
                ++all;
                if (!CHECK(mask != 0) || !sc_simple_test(s.workspace->worker, &projection, node))
                    ++*(i >= ALL_PASS && is_left_open(s.model, s.workspace, node) ? &open
                                                                                  : &failed);
                touching += (sc_model_node(s.model)[node].kind & SC_NODE_TOUCHES) != 0;
            }
            CHECK_MSG(!failed, "%" PRIu32 " of %" PRIu32 " nodes failed", failed,
                      s.model->node_count);
        }
        close_scene(&s);
    }
    CHECK(!is_full() || touching > 100);
    CHECK_MSG(open <= all / 100, "%" PRIu32 " of %" PRIu32 " nodes are left open", open, all);
}

/* Two patches that share one point p and, round a loop, points h at which so many patches meet that
   these make nobody adjacent. The second patch folds over the first. */
static void patches_that_share_hubs(void)
{
    enum { FINS = 60, HUBS = 3, TRIANGLES = 6 + HUBS * FINS };
    static const double flat[9][2] = {{0, 0},   {10, -5}, {4, 0}, {10, 5}, {9, -6},
                                      {9, 4.4}, {9.5, 0}, {9, 6}, {0, 0}};
    static const uint32_t corners[6][3] = {{0, 1, 2}, {0, 2, 3}, {1, 0, 4},
                                           {2, 1, 5}, {3, 2, 6}, {0, 3, 7}};
    for (uint32_t turn = 0; turn < 12; ++turn) {
        soup mesh = soup_make(9 + 2 * HUBS * FINS, TRIANGLES);
        uint32_t order[TRIANGLES], v = 9, leaves = 2 + HUBS * FINS, count = 1, head;
        uint32_t first[512], number[512];
        sc_tree_node tree[512];
        sc_build_options options;
        double c = cos(pi * turn / 6 + 0.1), d = sin(pi * turn / 6 + 0.1);
        star_tally tally;
        scene s;
        sc_mesh m;
        memset(&tally, 0, sizeof(tally));
        memcpy(mesh.triangles, corners, sizeof(corners));
        for (uint32_t i = 0; i < 9; ++i) {
            double *p = mesh.positions + 3 * (size_t)i;
            p[0] = c * flat[i][0] - d * flat[i][1];
            p[1] = d * flat[i][0] + c * flat[i][1];
            p[2] = 0;
        }
        for (uint32_t i = 0; i < HUBS * FINS; ++i) {
            uint32_t *t = mesh.triangles + 3 * (size_t)(6 + i);
            t[0] = 1 + i % HUBS;
            t[1] = v++;
            t[2] = v++;
            for (uint32_t k = 3 * t[1]; k < 3 * v; ++k)
                mesh.positions[k] = test_random_range(20, 30);
        }
        /* leaves: the first two triangles, the next four, then each fin; halved at every node */
        for (uint32_t i = 0; i < TRIANGLES; ++i) order[i] = i;
        memset(tree, 0, sizeof(tree));
        first[0] = 0;
        number[0] = leaves;
        for (head = 0; head < count; ++head) {
            sc_tree_node *n = &tree[head];
            if (number[head] == 1) {
                n->left = n->right = SC_NONE;
                n->first = first[head] == 0 ? 0 : first[head] == 1 ? 2 : first[head] + 4;
                n->count = first[head] == 0 ? 2 : first[head] == 1 ? 4 : 1;
                continue;
            }
            n->left = count++;
            n->right = count++;
            first[n->left] = first[head];
            number[n->left] = number[head] / 2;
            first[n->right] = first[head] + number[n->left];
            number[n->right] = number[head] - number[n->left];
        }
        memset(&options, 0, sizeof(options));
        options.struct_size = sizeof(options);
        options.partition = SC_PARTITION_TREE;
        options.order = order;
        options.tree = tree;
        options.tree_count = count;
        memset(&s, 0, sizeof(s));
        s.name = "shared hubs";
        s.mesh = mesh;
        s.pose = copy_positions(&mesh);
        s.choices.partition_name = "tree";
        m = input_plain_mesh(&mesh);
        if (CHECK(sc_build(&m, &options, &s.model) == SC_OK) &&
            CHECK(sc_workspace_create(s.model, NULL, &s.workspace) == SC_OK) && load_pose(&s)) {
            check_stars(&s, &tally);
            CHECK(tally.colliding > 0);
        }
        close_scene(&s);
    }
}

SC_TEST_MAIN(SC_TEST(directions_of_the_cone), SC_TEST(vectors_of_all_masks),
             SC_TEST(cones_and_projections), SC_TEST(cones_at_zero), SC_TEST(bounds_of_segments),
             SC_TEST(bounds_of_long_segments), SC_TEST(bounds_of_huge_coordinates), SC_TEST(ticks),
             SC_TEST(first_tick_again), SC_TEST(stars_have_no_pairs), SC_TEST(stars_beyond_float),
             SC_TEST(spirals_overlap), SC_TEST(long_contours), SC_TEST(branched_discs),
             SC_TEST(contours_at_shared_points), SC_TEST(contours_in_pieces),
             SC_TEST(points_in_the_unit_box), SC_TEST(poses_of_any_layout),
             SC_TEST(places_of_contours), SC_TEST(small_contours), SC_TEST(two_edges_that_cross),
             SC_TEST(contours_together), SC_TEST(pinches_alone), SC_TEST(flat_cloths_pass),
             SC_TEST(patches_that_share_hubs))
