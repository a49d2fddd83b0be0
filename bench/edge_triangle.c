/*
 * Exact tests of an edge and a triangle; see edge_triangle.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "edge_triangle.h"

#include <math.h>
#include <string.h>

/*
 * Relative errors of the two determinants below, as parts of the sum of their terms' sizes:
 * (7 + 56 e) e and (3 + 16 e) e with e = 2^-53, rounded up. They do not count underflow, which can
 * matter only if the sum is tiny: such a sign is left open, as is one whose terms overflow.
 */
static const double volume_error = 7.8e-16, area_error = 3.4e-16;
static const double least_volume = 1e-150, least_area = 1e-290;

static int sign_of(double value, double size, double error, double least)
{
    if (!(size >= least) || !isfinite(size)) return 0;
    return value > error * size ? 1 : value < -error * size ? -1 : 0;
}

/* The sign of the volume of a tetrahedron; 0 if open. */
static int volume_sign(const double *a, const double *b, const double *c, const double *d)
{
    const double u[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
    const double v[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
    const double w[3] = {d[0] - a[0], d[1] - a[1], d[2] - a[2]};
    double sum = 0.0, size = 0.0;
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        const double first = v[j] * w[k], second = v[k] * w[j];
        sum += u[i] * (first - second);
        size += fabs(u[i]) * (fabs(first) + fabs(second));
    }
    return sign_of(sum, size, volume_error, least_volume);
}

/* The sign of the area of a triangle in the plane of coordinates i and j; 0 if open. */
static int area_sign(const double *a, const double *b, const double *c, int i, int j)
{
    const double first = (a[i] - c[i]) * (b[j] - c[j]), second = (a[j] - c[j]) * (b[i] - c[i]);
    return sign_of(first - second, fabs(first) + fabs(second), area_error, least_area);
}

/* Whether in some coordinate plane a line through two of the five points separates edge and
   triangle. */
static bool is_separated(const double *p, const double *q, const double *const corner[3])
{
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3;
        const int side = area_sign(p, q, corner[0], i, j);
        if (side && side == area_sign(p, q, corner[1], i, j) &&
            side == area_sign(p, q, corner[2], i, j))
            return true;
        for (int k = 0; k < 3; k++) {
            const double *from = corner[k], *to = corner[(k + 1) % 3];
            const int inside = area_sign(from, to, corner[(k + 2) % 3], i, j);
            if (inside && area_sign(from, to, p, i, j) == -inside &&
                area_sign(from, to, q, i, j) == -inside)
                return true;
        }
    }
    return false;
}

/* Asks the library whether a model's first two triangles, in this pose, make a pair. */
static bool ask(edge_triangle *tests, const sc_model *model, sc_workspace *workspace,
                const double *points, uint32_t count, uint32_t kind, uint32_t contact)
{
    sc_pose pose;
    memset(&pose, 0, sizeof pose);
    pose.struct_size = sizeof pose;
    pose.vertex_count = count;
    pose.position_type = SC_DOUBLE;
    pose.positions = points;
    sc_query_options options;
    memset(&options, 0, sizeof options);
    options.struct_size = sizeof options;
    options.pairs = kind;
    options.contact = contact;
    options.method = SC_METHOD_AABB;
    sc_pair pairs[16];
    sc_result result;
    memset(&result, 0, sizeof result);
    result.struct_size = sizeof result;
    result.capacity = sizeof pairs / sizeof *pairs;
    result.pairs = pairs;
    tests->asked++;
    /* It cannot fail: positions are finite, and two triangles have no more than 12 pairs. */
    if (sc_query(model, workspace, &pose, &options, &result) != SC_OK) return false;
    if (kind == SC_PAIRS_TRIANGLE) return result.count > 0;
    for (uint64_t i = 0; i < result.count; i++) {
        if (pairs[i].b == 0) return true; /* the edge, which is triangle 1, meets triangle 0 */
    }
    return false;
}

bool edge_triangle_meet(edge_triangle *tests, const double *p, const double *q, const double *a,
                        const double *b, const double *c, uint32_t contact)
{
    const int over = volume_sign(a, b, c, p), under = volume_sign(a, b, c, q);
    if (over && over == under) return false;
    /* Where the line through p and q passes the plane, these are the signs of that point's
       barycentric coordinates; where it does not, the line misses the triangle or all three are
       zero. */
    const int ab = volume_sign(p, q, a, b), bc = volume_sign(p, q, b, c);
    if (ab && bc && ab != bc) return false;
    const int ca = volume_sign(p, q, c, a);
    if (ca && ((ab && ab != ca) || (bc && bc != ca))) return false;
    if (over && under && ab && bc && ca) return true;

    const double *const corner[3] = {a, b, c};
    if (is_separated(p, q, corner)) return false;
    double points[15];
    memcpy(points, a, 3 * sizeof *points);
    memcpy(points + 3, b, 3 * sizeof *points);
    memcpy(points + 6, c, 3 * sizeof *points);
    memcpy(points + 9, p, 3 * sizeof *points);
    memcpy(points + 12, q, 3 * sizeof *points);
    return ask(tests, tests->edge_model, tests->edge_workspace, points, 5, SC_PAIRS_EDGE, contact);
}

bool edge_triangle_folded(edge_triangle *tests, const double *a, const double *b, const double *c,
                          const double *d)
{
    if (volume_sign(a, b, c, d)) return false;
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3;
        const int side = area_sign(a, b, c, i, j);
        if (side && area_sign(a, b, d, i, j) == -side) return false;
    }
    double points[12];
    memcpy(points, a, 3 * sizeof *points);
    memcpy(points + 3, b, 3 * sizeof *points);
    memcpy(points + 6, c, 3 * sizeof *points);
    memcpy(points + 9, d, 3 * sizeof *points);
    return ask(tests, tests->fold_model, tests->fold_workspace, points, 4, SC_PAIRS_TRIANGLE,
               SC_CONTACT_TOUCHING);
}

static bool make_model(const uint32_t indices[6], uint32_t vertex_count, sc_model **model,
                       sc_workspace **workspace)
{
    static const float rest[15] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 2, 2, 2, 3, 2, 2};
    sc_mesh mesh;
    memset(&mesh, 0, sizeof mesh);
    mesh.struct_size = sizeof mesh;
    mesh.vertex_count = vertex_count;
    mesh.triangle_count = 2;
    mesh.positions = rest;
    mesh.indices = indices;
    sc_build_options options;
    memset(&options, 0, sizeof options);
    options.struct_size = sizeof options;
    options.weld = SC_WELD_NONE;
    return sc_build(&mesh, &options, model) == SC_OK &&
           sc_workspace_create(*model, NULL, workspace) == SC_OK;
}

bool edge_triangle_open(edge_triangle *tests)
{
    static const uint32_t edge_and_triangle[6] = {0, 1, 2, 3, 4, 4};
    static const uint32_t two_on_an_edge[6] = {0, 1, 2, 0, 1, 3};
    memset(tests, 0, sizeof *tests);
    if (make_model(edge_and_triangle, 5, &tests->edge_model, &tests->edge_workspace) &&
        make_model(two_on_an_edge, 4, &tests->fold_model, &tests->fold_workspace))
        return true;
    edge_triangle_close(tests);
    return false;
}

void edge_triangle_close(edge_triangle *tests)
{
    sc_workspace_free(tests->edge_workspace);
    sc_workspace_free(tests->fold_workspace);
    sc_model_free(tests->edge_model);
    sc_model_free(tests->fold_model);
    memset(tests, 0, sizeof *tests);
}
