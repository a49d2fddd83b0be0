/*
 * Discrete normal cones, and the projections made of them, against exact rational arithmetic.
 *
 * SPDX-License-Identifier: MIT
 */
#include <gmp.h>
#include <inttypes.h>
#include <math.h>
#include <string.h>

#include "harness.h"
#include "pose/contour_bounds.h"
#include "pose/dnc.h"
#include "pose/pose_kernels.h"
#include "posed_model.h"
#include "run/workspace.h"
#include "soups.h"
#include "starcontour.h"

/* The sign of ((b - a) x (c - a)) . (u x w), times a positive number: the area under u, w. */
static int exact_area_sign(const sc_workspace *w, const uint32_t *corner, const double u[3],
                           const double v[3])
{
    const double *a = posed_model_place(w, corner[0]);
    const double *b = posed_model_place(w, corner[1]), *c = posed_model_place(w, corner[2]);
    mpq_t ub, vb, uc, vc;
    int sign;
    mpq_inits(ub, vb, uc, vc, NULL);
    posed_model_exact_dot(ub, u, b, a);
    posed_model_exact_dot(vb, v, b, a);
    posed_model_exact_dot(uc, u, c, a);
    posed_model_exact_dot(vc, v, c, a);
    mpq_mul(ub, ub, vc);
    mpq_mul(vb, vb, uc);
    sign = mpq_cmp(ub, vb);
    mpq_clears(ub, vb, uc, vc, NULL);
    return (sign > 0) - (sign < 0);
}

static void directions_of_the_cone(void)
{
    soup mesh = soup_cloth(2, 2);
    posed_model s;
    double d[SC_DNC_DIRECTIONS][3];
    uint32_t faces = 0;
    if (!posed_model_open(&s, "cloth", &mesh, SC_WELD_REST, SC_PARTITION_FAST) ||
        !posed_model_load(&s))
        return;
    posed_model_directions(s.workspace, d);
    for (int i = 0; i < SC_DNC_DIRECTIONS; ++i) {
        int zeros = (d[i][0] == 0) + (d[i][1] == 0) + (d[i][2] == 0);
        CHECK(zeros == 0 || zeros == 2);
        faces += zeros == 2;
        for (int k = 0; k < i; ++k) CHECK(memcmp(d[i], d[k], sizeof(d[i])) != 0);
    }
    CHECK(faces == 6);
    posed_model_close(&s);
}

/* Whether the dot product is beyond doubt in single precision; 0 outside of moderate sizes. */
static int is_clear(const sc_workspace *w, const uint32_t *t, const double d[3])
{
    double e[3], f[3], e_size = 0, f_size = 0, dot = 0;
    for (int k = 0; k < 3; ++k) {
        e[k] = posed_model_part(w, t[1], k) - posed_model_part(w, t[0], k);
        f[k] = posed_model_part(w, t[2], k) - posed_model_part(w, t[0], k);
        e_size += fabs(e[k]);
        f_size += fabs(f[k]);
    }
    for (int k = 0; k < 3; ++k)
        dot += d[k] * (e[(k + 1) % 3] * f[(k + 2) % 3] - e[(k + 2) % 3] * f[(k + 1) % 3]);
    return dot > 1e-6 * (e_size * f_size +
                         w->frame.radius * (e_size + f_size + 1e-7 * w->frame.radius)) &&
           e_size > 1e-100 && f_size > 1e-100 && e_size < 1e100 && f_size < 1e100;
}

static void check_cones(posed_model *s)
{
    const sc_model *m = s->model;
    const sc_workspace *w = s->workspace;
    double d[SC_DNC_DIRECTIONS][3];
    uint32_t leaf, p, level, bit, i, wrong = 0, sample = 0;
    posed_model_directions(w, d);
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

/* Projections of random parts of cones leave all areas positive, and coordinates are as exact as
   said. Returns the number of projections. */
static uint32_t check_projections(posed_model *s)
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
        sc_dnc_projection(&w->frame, test_random_part(w->frame.mask[p]), &projection);
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
            const double *at = posed_model_place(w, point);
            double x, y;
            mpq_t exact, computed, error;
            posed_model_project(w, &projection, SC_LINE_VERTICAL, point, &x, &y);
            mpq_inits(exact, computed, error, NULL);
            for (k = 0; k < 2; ++k) {
                posed_model_exact_dot(exact, k ? projection.w : projection.u, at,
                                      projection.origin);
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
        posed_model s;
        posed_model_open_any(&s, 60);
        posed_model_any_pose(s.pose, s.mesh.vertex_count);
        if (i % 8 == 0) soup_scale(s.pose, s.mesh.vertex_count, i % 16 == 0 ? 1e-60 : 1e60);
        if (i % 8 == 1) soup_crush(s.pose, s.mesh.vertex_count);
        if (i % 8 == 2) { /* a plane of exactly zero dot products, moved by rounding errors */
            for (uint32_t v = 0; v < s.mesh.vertex_count; ++v) {
                double *p = s.pose + 3 * (size_t)v;
                p[2] = -(p[0] + p[1]);
            }
            soup_nudge(s.pose, s.mesh.vertex_count);
        }
        if (posed_model_load(&s)) {
            check_cones(&s);
            tried += check_projections(&s);
        }
        posed_model_close(&s);
    }
    CHECK_MSG(!test_is_full() || tried > 200, "only %" PRIu32 " projections", tried);
}

/* Triangles that contain a direction but for rounding: floating point cannot tell the sign. */
static void cones_at_zero(void)
{
    soup mesh = soup_cloth(1, 1);
    posed_model s;
    double d[SC_DNC_DIRECTIONS][3];
    uint32_t wrong = 0, set = 0;
    mesh.triangle_count = 1;
    if (!posed_model_open(&s, "a triangle", &mesh, SC_WELD_NONE, SC_PARTITION_FAST) ||
        !posed_model_load(&s))
        return;
    posed_model_directions(s.workspace, d);
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
        if (!posed_model_load(&s)) break;
        sc_dnc_projection(&s.workspace->frame, 1u << bit, &one);
        if (s.workspace->frame.mask[0] >> bit & 1) {
            ++set;
            wrong += exact_area_sign(s.workspace, sc_model_triangle(s.model), one.u, one.w) <= 0;
        }
    }
    CHECK_MSG(wrong == 0, "%" PRIu32 " of %" PRIu32 " signs wrong", wrong, set);
    posed_model_close(&s);
}

SC_TEST_MAIN(SC_TEST(directions_of_the_cone), SC_TEST(vectors_of_all_masks),
             SC_TEST(cones_and_projections), SC_TEST(cones_at_zero))
