/*
 * Gradients of contours' lengths. See gradients.h.
 *
 * SPDX-License-Identifier: MIT
 *
 * Node x is where the edge from p to q meets the plane of the triangle v_0 v_1 v_2. With t its way
 * along the edge, w_i its weights in the triangle, d = q - p and n the triangle's normal, a move of
 * the five vertices moves the point of the edge that is at t now by e = (1 - t) dp + t dq, and the
 * point of the triangle that has the weights w_i now by f = sum w_i dv_i. The new node is on the
 * moved edge, x + e + d dt, and in the moved plane, whose distance from x is n . f to first order:
 *     n . (e + d dt) = n . f,  hence  dx = e + d (n . (f - e)) / (n . d).
 * Other terms of first order, such as the plane's turning, are in the plane or vanish at x.
 *
 * The contour's length is the sum of |x_(k+1) - x_k|. Its derivative by x_k is
 *     g = (x_k - x_(k-1)) / |x_k - x_(k-1)| - (x_(k+1) - x_k) / |x_(k+1) - x_k|,
 * and g . dx = (g - s) . e + s . f with s = ((g . d) / (n . d)) n. So the derivative by an end of
 * the edge is 1 - t or t times g - s, and that by v_i is w_i s.
 *
 * Errors, with u = 2^-53: Let a be the sine of the angle of edge and plane, so that s is as long
 * as the part of g along the edge divided by a; b the sine of the angle at v_0; C the largest
 * coordinate and l the length of the shorter segment at x.
 *   - A coordinate of a node's point is off by 16 u C, the direction of a segment by 2 sqrt(3) 16 u
 *     C / l and 4 u more, and g by twice that: less than 112 u C / l + 8 u.
 *   - A component of n is off by 4 u of the sum m of its two absolute products, and n . d by 8 u of
 *     M, the sum of m times the components of d. The vector m is at most sqrt(2) times as long as
 *     the product of the two sides, hence M / |n . d| <= 1.5 / (a b), and |m| / |n| <= 1.5 / b.
 *   - So s is off by (112 u C / l + 16 u) / a + 2 (12 u / (a b) + 6 u / b) / a, and g - s by what
 *     g is off more: together less than 256 u (C / l + 1 / (a b)) / a.
 * Weights are off by 2^-50 of themselves and less. Nothing overflows or underflows, as the three
 * directions are scaled by powers of 2 first, of which s does not depend.
 */
#include "trace/gradients.h"

#include <math.h>

#include "base/bounds.h"
#include "trace/crossings.h"

static int are_finite(const double *numbers, int count)
{
    int k, finite = 1;
    for (k = 0; k < count; k++) finite &= numbers[k] - numbers[k] == 0;
    return finite;
}

/* The vector between two points, scaled so that its largest component is between 1/2 and 1. 0 if
   it has no length, or one that is no double; it is zero then. */
static int scaled_between(const double from[3], const double to[3], double v[3])
{
    double largest = 0;
    int k, exponent;
    for (k = 0; k < 3; k++) {
        v[k] = to[k] - from[k];
        if (fabs(v[k]) > largest) largest = fabs(v[k]);
    }
    if (!(largest > 0) || !are_finite(v, 3)) {
        memset(v, 0, 3 * sizeof *v);
        return 0;
    }
    frexp(largest, &exponent);
    for (k = 0; k < 3; k++) v[k] = ldexp(v[k], -exponent);
    return 1;
}

/* Adds sign times the unit vector between two points to g. 0 if they are at one place. */
static int add_direction(const double from[3], const double to[3], double sign, double g[3])
{
    double v[3], length;
    int k;
    if (!scaled_between(from, to, v)) return 0;
    length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    for (k = 0; k < 3; k++) g[k] += sign * (v[k] / length);
    return 1;
}

/* s: how the length changes as the triangle moves, for a derivative g by the node's point. 0 if
   edge and plane are parallel, or rounding hides that they are not. */
static int turn_to_normal(double at[5][3], const double g[3], double s[3])
{
    double d[3], side[2][3], n[3], height = 0, size = 0, along = 0;
    int k;
    if (!scaled_between(at[0], at[1], d) || !scaled_between(at[2], at[3], side[0]) ||
        !scaled_between(at[2], at[4], side[1]))
        return 0;
    for (k = 0; k < 3; k++) {
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        const double left = side[0][i] * side[1][j], right = side[0][j] * side[1][i];
        n[k] = left - right;
        height += n[k] * d[k];
        size += (fabs(left) + fabs(right)) * fabs(d[k]);
        along += g[k] * d[k];
    }
    if (!(fabs(height) > SC_BOUNDS_GRADIENT * size && fabs(height) > SC_BOUNDS_SIGN_TINY)) return 0;
    for (k = 0; k < 3; k++) s[k] = along / height * n[k];
    return 1;
}

/* The vertices and weights of a node, and where the vertices are. */
static sc_status name_stencil(const sc_model *model, const sc_positions *positions,
                              const sc_trace_node *node, sc_trace_gradient *of, double at[5][3])
{
    int k;
    memset(of, 0, sizeof *of);
    if (node->edge == SC_TRACE_NO_EDGE) {
        if (node->triangle >= model->vertex_count) return SC_ERROR_PAIRS;
        for (k = 0; k < 5; k++) of->vertices[k] = node->triangle;
        of->weights[0] = 1;
    } else {
        if (node->edge / 3 >= model->triangle_count || node->triangle >= model->triangle_count)
            return SC_ERROR_PAIRS;
        sc_trace_ends(model, node->edge, of->vertices);
        memcpy(of->vertices + 2, sc_trace_corners(model, node->triangle), 3 * sizeof(uint32_t));
        of->weights[0] = 1 - node->along;
        of->weights[1] = node->along;
        memcpy(of->weights + 2, node->weights, sizeof node->weights);
    }
    if (!are_finite(of->weights, 5) || !are_finite(node->point, 3)) return SC_ERROR_NOT_FINITE;
    for (k = 0; k < 5; k++) {
        sc_positions_get(positions, of->vertices[k], at[k]);
        if (!are_finite(at[k], 3)) return SC_ERROR_NOT_FINITE;
    }
    return SC_OK;
}

/* The stencil of a node between two others, which may be NULL. */
static sc_status find_gradient(const sc_model *model, const sc_positions *positions,
                               const sc_trace_node *before, const sc_trace_node *node,
                               const sc_trace_node *behind, sc_trace_gradient *of)
{
    double at[5][3], g[3] = {0, 0, 0}, s[3];
    int k, is_short = 0;
    const sc_status status = name_stencil(model, positions, node, of, at);
    if (status) return status;
    if (before) is_short |= !add_direction(before->point, node->point, 1, g);
    if (behind) is_short |= !add_direction(node->point, behind->point, -1, g);
    if (is_short) of->flags |= SC_GRADIENT_SHORT;
    if (node->edge == SC_TRACE_NO_EDGE) {
        memcpy(of->vectors[0], g, sizeof g);
    } else if (turn_to_normal(at, g, s)) {
        for (k = 0; k < 3; k++) of->vectors[0][k] = g[k] - s[k];
        memcpy(of->vectors[1], s, sizeof s);
    } else {
        of->flags |= SC_GRADIENT_FLAT;
    }
    return SC_OK;
}

sc_status sc_gradients_find(const sc_model *model, const sc_positions *positions,
                            const sc_trace_result *traced, sc_trace_gradient *gradients)
{
    uint64_t i, k;
    sc_status status = SC_OK;
    for (i = 0; i < traced->node_count; i++) memset(&gradients[i], 0, sizeof *gradients);
    for (i = 0; !status && i < traced->contour_count; i++) {
        const sc_trace_contour *c = &traced->contours[i];
        const int is_closed = c->begin == SC_TRACE_CLOSED;
        const sc_trace_node *node;
        if (c->first > traced->node_count || c->count > traced->node_count - c->first)
            return SC_ERROR_PAIRS;
        if (!c->count) continue; /* there may be no array of nodes */
        node = traced->nodes + c->first;
        for (k = 0; !status && k < c->count; k++) {
            const sc_trace_node *before = k > 0       ? &node[k - 1]
                                          : is_closed ? &node[c->count - 1]
                                                      : NULL;
            const sc_trace_node *behind = k + 1 < c->count ? &node[k + 1]
                                          : is_closed      ? &node[0]
                                                           : NULL;
            status =
                find_gradient(model, positions, before, &node[k], behind, &gradients[c->first + k]);
        }
    }
    return status;
}
