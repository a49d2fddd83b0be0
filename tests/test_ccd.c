/*
 * A cross-check by libccd, a library of other people: its GJK (the algorithm of Gilbert, Johnson
 * and Keerthi) tells whether a segment and a triangle meet, and sc_query must say the same of the
 * edges of two triangles.
 *
 * GJK works in floating point and can fail on contact, so it is asked only outside a band around
 * touching. The band is measured in yet another way: the differences of points of the triangle and
 * points of the segment form a prism, and the greatest of its five faces' signed distances to the
 * origin is negative, as deep as they penetrate, or positive, a lower bound of how far they are
 * apart. libccd's tolerances are absolute, so that both measure at unit size what sc_query sees at
 * three sizes. Where the distance is beyond BAND that sign, libccd and sc_query must all agree;
 * within it only sc_query's two kinds of contact are compared with each other.
 *
 * SPDX-License-Identifier: MIT
 */
#include <ccd/ccd.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "harness.h"
#include "inputs.h"
#include "starcontour.h"

#define BAND 1e-7

typedef struct hull {
    const double *points[3];
    uint32_t count;
} hull;

static void support(const void *object, const ccd_vec3_t *direction, ccd_vec3_t *point)
{
    const hull *h = (const hull *)object;
    const double *best = h->points[0];
    double most = -HUGE_VAL;
    for (uint32_t i = 0; i < h->count; ++i) {
        const double *p = h->points[i];
        double along = p[0] * (double)direction->v[0] + p[1] * (double)direction->v[1] +
                       p[2] * (double)direction->v[2];
        if (along <= most) continue;
        most = along;
        best = p;
    }
    for (int i = 0; i < 3; ++i) point->v[i] = (ccd_real_t)best[i];
}

static int ask_ccd(const hull *segment, const hull *triangle)
{
    ccd_t ccd;
    CCD_INIT(&ccd);
    ccd.support1 = support;
    ccd.support2 = support;
    ccd.max_iterations = 200;
    return ccdGJKIntersect(segment, triangle, &ccd);
}

static void subtract(double *d, const double *p, const double *q)
{
    for (int i = 0; i < 3; ++i) d[i] = p[i] - q[i];
}

static void cross(double *n, const double *u, const double *v)
{
    for (int i = 0; i < 3; ++i)
        n[i] = u[(i + 1) % 3] * v[(i + 2) % 3] - u[(i + 2) % 3] * v[(i + 1) % 3];
}

static double dot(const double *u, const double *v)
{
    return u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
}

/* How far two hulls are apart along n, either way round; 0 if n is too short to be a direction. */
static double gap_along(const double *n, const hull *a, const hull *b)
{
    double low_a = HUGE_VAL, high_a = -HUGE_VAL, low_b = HUGE_VAL, high_b = -HUGE_VAL;
    double length = sqrt(dot(n, n));
    if (length < 1e-6) return 0;
    for (uint32_t i = 0; i < a->count; ++i) {
        double x = dot(n, a->points[i]);
        low_a = fmin(low_a, x);
        high_a = fmax(high_a, x);
    }
    for (uint32_t i = 0; i < b->count; ++i) {
        double x = dot(n, b->points[i]);
        low_b = fmin(low_b, x);
        high_b = fmax(high_b, x);
    }
    return fmax(low_a - high_b, low_b - high_a) / length;
}

/* The greatest gap along the normals of the prism's faces. */
static double signed_distance(const hull *segment, const hull *triangle)
{
    double along[3], side[3], n[3], edges[3][3], most;
    subtract(along, segment->points[1], segment->points[0]);
    for (int k = 0; k < 3; ++k)
        subtract(edges[k], triangle->points[(k + 1) % 3], triangle->points[k]);
    cross(n, edges[0], edges[1]);
    most = gap_along(n, segment, triangle);
    for (int k = 0; k < 3; ++k) {
        cross(side, along, edges[k]);
        most = fmax(most, gap_along(side, segment, triangle));
    }
    return most;
}

/* Two triangles about 1 in size: anywhere, one long and thin, or with a corner near the other. */
static void make_triangles(double *p)
{
    uint32_t shape = test_random_below(4);
    for (int i = 0; i < 18; ++i) p[i] = test_random_range(-1, 1);
    if (shape == 1) {
        for (int i = 0; i < 3; ++i) p[6 + i] = p[i] + 0.01 * p[6 + i];
    }
    if (shape >= 2) { /* corner 3, or a point of the side from 3 to 4, near a point of the other */
        double u = test_random_unit(), v = test_random_unit() * (1 - u);
        double near = exp2(-(double)test_random_below(30)), t = shape == 2 ? 0 : test_random_unit();
        for (int i = 0; i < 3; ++i) {
            double target = p[i] + u * (p[3 + i] - p[i]) + v * (p[6 + i] - p[i]);
            double point = p[9 + i] + t * (p[12 + i] - p[9 + i]);
            double offset = target - point + near * test_random_range(-1, 1);
            for (int k = 9; k < 18; k += 3) p[k + i] += offset;
        }
    }
}

static uint64_t find_edges(const sc_model *model, sc_workspace *workspace, const double *p,
                           uint32_t contact, sc_pair *pairs)
{
    sc_pose pose = input_plain_pose(p, 6);
    sc_query_options options;
    sc_result result;
    memset(&options, 0, sizeof(options));
    options.struct_size = sizeof(options);
    options.pairs = SC_PAIRS_EDGE;
    options.contact = contact;
    memset(&result, 0, sizeof(result));
    result.struct_size = sizeof(result);
    result.capacity = 6;
    result.pairs = pairs;
    CHECK(sc_query(model, workspace, &pose, &options, &result) == SC_OK && result.count <= 6);
    return result.count;
}

static int is_listed(const sc_pair *pairs, uint64_t count, uint32_t corner)
{
    for (uint64_t i = 0; i < count; ++i)
        if (pairs[i].a == corner && pairs[i].b == 1 - corner / 3) return 1;
    return 0;
}

static void edges_agree_with_gjk(void)
{
    static const double sizes[] = {1, 1000, 0.001};
    double rest[18] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 5, 0, 0, 6, 0, 0, 5, 1, 0};
    uint32_t triangles[6] = {0, 1, 2, 3, 4, 5}, rounds = test_iterations(100000);
    uint64_t asked = 0, meeting = 0, in_band = 0;
    soup s;
    sc_mesh mesh;
    sc_model *model = NULL;
    sc_workspace *workspace = NULL;
    s.vertex_count = 6;
    s.triangle_count = 2;
    s.positions = rest;
    s.triangles = triangles;
    mesh = input_plain_mesh(&s);
    if (!CHECK(sc_build(&mesh, NULL, &model) == SC_OK)) return;
    if (!CHECK(sc_workspace_create(model, NULL, &workspace) == SC_OK)) rounds = 0;
    for (uint32_t round = 0; round < rounds; ++round) {
        double unit[18], p[18], size = sizes[test_random_below(3)];
        sc_pair touching[6], proper[6];
        uint64_t touching_count, proper_count;
        make_triangles(unit);
        for (int i = 0; i < 18; ++i) p[i] = size * unit[i];
        touching_count = find_edges(model, workspace, p, SC_CONTACT_TOUCHING, touching);
        proper_count = find_edges(model, workspace, p, SC_CONTACT_PROPER, proper);
        for (uint32_t corner = 0; corner < 6; ++corner) {
            uint32_t own = corner / 3 * 3, other = 3 - own;
            int touches = is_listed(touching, touching_count, corner);
            int crosses = is_listed(proper, proper_count, corner), says;
            double distance;
            hull segment = {{NULL, NULL, NULL}, 2}, triangle = {{NULL, NULL, NULL}, 3};
            segment.points[0] = unit + 3 * corner;
            segment.points[1] = unit + 3 * (own + (corner + 1) % 3);
            for (uint32_t k = 0; k < 3; ++k) triangle.points[k] = unit + 3 * (other + k);
            CHECK(touches >= crosses);
            distance = signed_distance(&segment, &triangle);
            if (fabs(distance) <= BAND) {
                ++in_band;
                continue;
            }
            says = ask_ccd(&segment, &triangle);
            ++asked;
            meeting += says != 0;
            CHECK_MSG(says == (distance < 0), "libccd says %d at distance %g, size %g", says,
                      distance, size);
            CHECK_MSG(touches == (distance < 0) && crosses == (distance < 0),
                      "touching %d, proper %d, libccd %d, distance %g, size %g, corner %u", touches,
                      crosses, says, distance, size, corner);
        }
    }
    /* Both answers and the band must really have come up. */
    CHECK(meeting > asked / 20 && meeting < asked / 2 && in_band > 0);
    sc_workspace_free(workspace);
    sc_model_free(model);
}

SC_TEST_MAIN(SC_TEST(edges_agree_with_gjk))
