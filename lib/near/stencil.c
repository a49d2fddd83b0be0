/*
 * The closest points of a pair. See stencil.h.
 *
 * SPDX-License-Identifier: MIT
 *
 * Which feature. The point of a closed triangle that is closest to a point is
 *   - a corner, if no edge from it turns towards the point: both dot products are <= 0;
 *   - inside an edge, if both of its ends look along it at the point, and the point is above the
 *     outer side of the edge in the plane, or above the edge itself;
 *   - else inside the triangle.
 * Exactly one corner, edge or the inside is so, as the closest point is unique. Of two segments a0
 * + s d and b0 + t e that are not parallel, the squared distance is a strictly convex function of s
 * and t. It has one minimum in the square, which is where it does not fall towards the inside:
 *   - in a corner, if it does not fall along either side from there. Its derivatives are dot
 *     products of the difference of the two ends with d and e;
 *   - inside a side, say s = 0, if both ends of b look along it at a0, and the s where the function
 *     is least without any bounds is <= 0: for each s let t be the best; what is left is a
 *     quadratic function of s alone with its minimum there;
 *   - else inside.
 * With n = d x e, r from ai to bj, that s is ((r x e) . n) / n^2, and so on. All that is decided by
 * exact signs. The order "corners, sides, inside" gives ties to the feature of fewest vertices.
 *
 * Values. Weights are shares of polynomials that are all known to within 1.51 u, u = 2^-53. Their
 * sum is off by 2 u more, the quotient by 1 u: 6.1 u. Of the vector in space, n (r . n) / n^2,
 * three polynomials and two operations: 6.6 u; from a vertex to an edge e with v from one to the
 * other, (e x (v x e)) / e^2: 4.1 u. Distances, |r . n| / |n|: 1.51 u, half of that, and two
 * operations, 4.3 u; |e x (v x e)| / e^2: 3.1 u, half of three operations, a root and a quotient,
 * 6.6 u; of two vertices less. Each is below 8 u, the 2^-50 that starcontour.h promises.
 */
#include "near/stencil.h"

#include <float.h>
#include <string.h>

#include "near/differences.h"

typedef struct seeker {
    sc_quad quad;
    int first_of_b; /* points before it are of a */
    sc_near_stencil *out;
} seeker;

/* ---- numbers with exponents ---- */

static double to_double(double number, int exponent)
{
    return exponent ? ldexp(number, exponent) : number;
}

/* number times 2^exponent, exponent made even. */
static double root_of(double number, int exponent, int *half)
{
    int odd = exponent & 1;
    *half = (exponent - odd) / 2;
    return sqrt(odd ? 2 * number : number);
}

/* The length of a vector: the number returned times 2^*exponent. */
static double length_of(const sc_predicates_value v[3], int *exponent)
{
    double sum = 0;
    int k, any = 0;
    *exponent = 0;
    for (k = 0; k < 3; k++) {
        if (v[k].number == 0) continue;
        if (!any || v[k].exponent > *exponent) *exponent = v[k].exponent;
        any = 1;
    }
    for (k = 0; k < 3; k++) {
        double part = to_double(v[k].number, v[k].number == 0 ? 0 : v[k].exponent - *exponent);
        sum += part * part;
    }
    return sqrt(sum);
}

/* What parts of their sum some positive values are. None is 0: a vertex of the feature is known by
   its weight. */
static void share_out(const sc_predicates_value *values, int count, double *shares)
{
    int i, largest = values[0].exponent;
    double sum = 0;
    for (i = 1; i < count; i++)
        if (values[i].exponent > largest) largest = values[i].exponent;
    for (i = 0; i < count; i++) {
        shares[i] = to_double(fabs(values[i].number), values[i].exponent - largest);
        sum += shares[i];
    }
    for (i = 0; i < count; i++) {
        shares[i] /= sum;
        if (shares[i] < DBL_MIN) shares[i] = DBL_MIN;
    }
}

/* ---- features ---- */

static double side_of(const seeker *s, int point)
{
    return point < s->first_of_b ? -1 : 1;
}

static void write_vertices(seeker *s, int i, int j)
{
    sc_predicates_value v[3];
    double length;
    int k, exponent, own = 0;
    s->out->feature = SC_FEATURE_VERTEX_VERTEX;
    s->out->weights[i] = -1;
    s->out->weights[j] = 1;
    for (k = 0; k < 3; k++) {
        double difference = s->quad.point[j][k] - s->quad.point[i][k];
        s->out->vector[k] = difference;
        v[k].number = frexp(difference, &own);
        v[k].exponent = own;
    }
    length = length_of(v, &exponent);
    s->out->distance = to_double(length, exponent);
}

/* A vertex of one and the inside of an edge of the other. */
static void write_vertex_edge(seeker *s, int vertex, int first, int last)
{
    sc_span e, v, from_first, to_last;
    sc_cross n;
    sc_predicates_value values[2], turned[3], square;
    double shares[2], length;
    int k, exponent;
    s->out->feature = SC_FEATURE_VERTEX_EDGE;
    sc_quad_span(&s->quad, first, last, &e);
    sc_quad_span(&s->quad, first, vertex, &from_first);
    sc_quad_span(&s->quad, vertex, last, &to_last);
    values[0] = sc_quad_dot(&s->quad, &to_last, &e);
    values[1] = sc_quad_dot(&s->quad, &from_first, &e);
    share_out(values, 2, shares);
    s->out->weights[vertex] = side_of(s, vertex);
    s->out->weights[first] = side_of(s, first) * shares[0];
    s->out->weights[last] = side_of(s, last) * shares[1];
    square = sc_quad_dot(&s->quad, &e, &e);
    if (vertex < s->first_of_b)
        sc_quad_span(&s->quad, vertex, first, &v);
    else
        v = from_first;
    sc_quad_cross(&v, &e, &n);
    for (k = 0; k < 3; k++) {
        turned[k] = sc_quad_turned(&s->quad, &e, &n, k);
        s->out->vector[k] =
            to_double(turned[k].number / square.number, turned[k].exponent - square.exponent);
    }
    length = length_of(turned, &exponent);
    s->out->distance = to_double(length / square.number, exponent - square.exponent);
}

/* The vector from a to b along n, r being from any point of a to any of b. */
static void write_along(seeker *s, const sc_span *r, const sc_cross *n)
{
    sc_predicates_value along = sc_quad_volume(&s->quad, r, n);
    sc_predicates_value square = sc_quad_cross_dot(&s->quad, n, n);
    double root, quotient = along.number / square.number;
    int k, half, exponent = along.exponent - square.exponent;
    for (k = 0; k < 3; k++) {
        sc_predicates_value part = sc_quad_part(&s->quad, n, k);
        s->out->vector[k] = to_double(quotient * part.number, exponent + part.exponent);
    }
    root = root_of(square.number, square.exponent, &half);
    s->out->distance = to_double(fabs(along.number) / root, along.exponent - half);
}

/* ---- a vertex and a face ---- */

static int is_below_point(const double *p, const double *q)
{
    int k;
    for (k = 0; k < 3; k++)
        if (p[k] != q[k]) return p[k] < q[k];
    return 0;
}

/* The face has no area: it is the segment from its lowest to its highest corner. */
static void seek_on_line(seeker *s)
{
    int k, low = 1, high = 1;
    sc_span e, v;
    for (k = 2; k < 4; k++) {
        if (is_below_point(s->quad.point[k], s->quad.point[low])) low = k;
        if (is_below_point(s->quad.point[high], s->quad.point[k])) high = k;
    }
    sc_quad_span(&s->quad, low, high, &e);
    for (k = 1; k < 4; k++) {
        int sign;
        sc_quad_span(&s->quad, k, 0, &v);
        sign = sc_quad_dot_sign(&s->quad, &v, &e);
        if (sign == 0 || (k == low && sign < 0) || (k == high && sign > 0)) {
            write_vertices(s, 0, k);
            return;
        }
    }
    write_vertex_edge(s, 0, low, high);
}

static void seek_in_face(seeker *s)
{
    sc_span edge[3], to_vertex[3]; /* edge k is opposite to corner k */
    sc_cross n;
    int ahead[3], behind[3]; /* the vertex is so, seen from the start and from the end of an edge */
    int k;
    for (k = 0; k < 3; k++) sc_quad_span(&s->quad, 1 + (k + 1) % 3, 1 + (k + 2) % 3, &edge[k]);
    for (k = 0; k < 3; k++) sc_quad_span(&s->quad, 1 + k, 0, &to_vertex[k]);
    sc_quad_cross(&edge[0], &edge[1], &n);
    if (sc_quad_is_zero(&s->quad, &n)) {
        s->out->flags = SC_STENCIL_PARALLEL;
        seek_on_line(s);
        return;
    }
    for (k = 0; k < 3; k++) {
        ahead[k] = sc_quad_dot_sign(&s->quad, &to_vertex[(k + 1) % 3], &edge[k]) > 0;
        behind[k] = sc_quad_dot_sign(&s->quad, &to_vertex[(k + 2) % 3], &edge[k]) < 0;
    }
    for (k = 0; k < 3; k++)
        if (!ahead[(k + 2) % 3] && !behind[(k + 1) % 3]) {
            write_vertices(s, 0, 1 + k);
            return;
        }
    for (k = 0; k < 3; k++)
        if (ahead[k] && behind[k] &&
            sc_quad_cross_dot_sign(&s->quad, &edge[k], &to_vertex[(k + 1) % 3], &n) <= 0) {
            write_vertex_edge(s, 0, 1 + (k + 1) % 3, 1 + (k + 2) % 3);
            return;
        }
    {
        sc_predicates_value values[3];
        sc_span r;
        for (k = 0; k < 3; k++) {
            sc_cross m;
            sc_quad_cross(&edge[k], &to_vertex[(k + 1) % 3], &m);
            values[k] = sc_quad_cross_dot(&s->quad, &m, &n);
        }
        s->out->feature = SC_FEATURE_VERTEX_FACE;
        s->out->weights[0] = -1;
        share_out(values, 3, &s->out->weights[1]);
        sc_quad_span(&s->quad, 0, 1, &r);
        write_along(s, &r, &n);
    }
}

/* ---- two edges ---- */

/*
 * They are parallel, or one has no length. Along the line, from low to high ends: either one is
 * ahead of the other or touches it there, or they lie side by side for a part, which begins with a
 * low end and ends with a high end.
 */
static void seek_parallel(seeker *s)
{
    const double *const *p = s->quad.point;
    int a_low = is_below_point(p[1], p[0]), a_high = is_below_point(p[0], p[1]);
    int b_low = 2 + is_below_point(p[3], p[2]), b_high = 2 + is_below_point(p[2], p[3]);
    int has_length = a_low != a_high, low, high;
    sc_span e, between;
    sc_quad_span(&s->quad, has_length ? a_low : b_low, has_length ? a_high : b_high, &e);
    sc_quad_span(&s->quad, a_high, b_low, &between);
    if (sc_quad_dot_sign(&s->quad, &between, &e) >= 0) {
        write_vertices(s, a_high, b_low);
        return;
    }
    sc_quad_span(&s->quad, b_high, a_low, &between);
    if (sc_quad_dot_sign(&s->quad, &between, &e) >= 0) {
        write_vertices(s, a_low, b_high);
        return;
    }
    sc_quad_span(&s->quad, a_low, b_low, &between);
    low = sc_quad_dot_sign(&s->quad, &between, &e);
    if (low == 0) {
        write_vertices(s, a_low, b_low);
        return;
    }
    sc_quad_span(&s->quad, a_high, b_high, &between);
    high = sc_quad_dot_sign(&s->quad, &between, &e);
    if (high == 0)
        write_vertices(s, a_high, b_high);
    else if (low > 0)
        write_vertex_edge(s, b_low, a_low, a_high);
    else
        write_vertex_edge(s, a_low, b_low, b_high);
}

/* The two shares of an edge: m . n of its start, and of its end, which has the other sign. */
static void share_edge(seeker *s, int first, const sc_span *r[2], const sc_span *other,
                       const sc_cross *n)
{
    sc_predicates_value values[2];
    sc_cross m;
    double shares[2];
    int i;
    for (i = 0; i < 2; i++) {
        sc_quad_cross(r[1 - i], other, &m);
        values[i] = sc_quad_cross_dot(&s->quad, &m, n);
    }
    share_out(values, 2, shares);
    for (i = 0; i < 2; i++) s->out->weights[first + i] = side_of(s, first) * shares[i];
}

static void seek_between_edges(seeker *s)
{
    sc_span d, e, r[2][2]; /* r[i][j]: from end i of a to end j of b */
    sc_cross n;
    int along_a[2][2], along_b[2][2]; /* signs of r . d and r . e */
    int i, j;
    sc_quad_span(&s->quad, 0, 1, &d);
    sc_quad_span(&s->quad, 2, 3, &e);
    sc_quad_cross(&d, &e, &n);
    if (sc_quad_is_zero(&s->quad, &n)) {
        s->out->flags = SC_STENCIL_PARALLEL;
        seek_parallel(s);
        return;
    }
    for (i = 0; i < 2; i++)
        for (j = 0; j < 2; j++) {
            sc_quad_span(&s->quad, i, 2 + j, &r[i][j]);
            along_a[i][j] = sc_quad_dot_sign(&s->quad, &r[i][j], &d);
            along_b[i][j] = sc_quad_dot_sign(&s->quad, &r[i][j], &e);
        }
    for (i = 0; i < 2; i++)
        for (j = 0; j < 2; j++)
            if ((i ? along_a[i][j] >= 0 : along_a[i][j] <= 0) &&
                (j ? along_b[i][j] <= 0 : along_b[i][j] >= 0)) {
                write_vertices(s, i, 2 + j);
                return;
            }
    for (i = 0; i < 2; i++) /* end i of a and the inside of b */
        if (along_b[i][0] < 0 && along_b[i][1] > 0) {
            int sign = sc_quad_cross_dot_sign(&s->quad, &r[i][0], &e, &n);
            if (i ? sign >= 0 : sign <= 0) {
                write_vertex_edge(s, i, 2, 3);
                return;
            }
        }
    for (j = 0; j < 2; j++)
        if (along_a[0][j] > 0 && along_a[1][j] < 0) {
            int sign = sc_quad_cross_dot_sign(&s->quad, &r[0][j], &d, &n);
            if (j ? sign >= 0 : sign <= 0) {
                write_vertex_edge(s, 2 + j, 0, 1);
                return;
            }
        }
    {
        const sc_span *of_a[2] = {&r[0][0], &r[1][0]}, *of_b[2] = {&r[0][0], &r[0][1]};
        s->out->feature = SC_FEATURE_EDGE_EDGE;
        share_edge(s, 0, of_a, &e, &n);
        share_edge(s, 2, of_b, &d, &n);
        write_along(s, &r[0][0], &n);
    }
}

void sc_stencil_find(uint32_t kind, const double *const points[4], sc_near_stencil *stencil)
{
    seeker s;
    sc_quad_set(&s.quad, points);
    s.first_of_b = kind == SC_NEAR_VERTEX_FACE ? 1 : 2;
    s.out = stencil;
    stencil->flags = 0;
    memset(stencil->weights, 0, sizeof stencil->weights);
    if (kind == SC_NEAR_VERTEX_FACE)
        seek_in_face(&s);
    else
        seek_between_edges(&s);
}
