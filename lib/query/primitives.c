/*
 * Primitive tests, built on nothing but orientation signs and comparisons of coordinates.
 *
 * SPDX-License-Identifier: MIT
 *
 * In general position an edge p q meets a triangle t if p and q are on different sides of its plane
 * and the three signs orient3d(p, q, t_k, t_k+1), which say on which side of the line p q the sides
 * of t pass, do not contradict each other. The signs of a pair of triangles are shared by its six
 * edges: six of points against planes and nine of edges against edges, the latter found when
 * needed.
 *
 * What is coplanar is decided in a projection along an axis along which it does not collapse, what
 * is collinear by comparing points in lexicographic order, which is their order along the line.
 */
#include "base/bounds.h"
#include "query/primitives.h"
#include "base/predicates.h"

/* ------------------------------------------------------------------------------------------------
 * Points in a plane or on a line
 */

static int next(int k)
{
    return k == 2 ? 0 : k + 1;
}

static int previous(int k)
{
    return k == 0 ? 2 : k - 1;
}

/* The sign of a, b, c, projected along an axis. */
static int projected_sign(const double *a, const double *b, const double *c, int axis,
                          uint64_t *fallbacks)
{
    int i = next(axis), j = previous(axis);
    double a2[2] = {a[i], a[j]}, b2[2] = {b[i], b[j]}, c2[2] = {c[i], c[j]};
    return sc_predicates_orient2d(a2, b2, c2, fallbacks);
}

/* An axis along which a, b, c can be projected without becoming collinear; -1 if they are. */
static int find_axis(const double *a, const double *b, const double *c, uint64_t *fallbacks)
{
    /* The axis closest to the normal is probably one; the signs have the last word. */
    sc_predicates_plane plane = sc_predicates_make_plane(a, b, c);
    int axis = 0;
    for (int i = 1; i < 3; ++i) {
        if (fabs(plane.normal[i]) > fabs(plane.normal[axis])) axis = i;
    }
    for (int i = 0; i < 3; ++i) {
        if (projected_sign(a, b, c, axis, fallbacks) != 0) return axis;
        axis = next(axis);
    }
    return -1;
}

/* Lexicographic order: negative, 0 or positive. */
static int compare(const double *a, const double *b)
{
    for (int i = 0; i < 3; ++i) {
        if (a[i] != b[i]) return a[i] < b[i] ? -1 : 1;
    }
    return 0;
}

static const double *lower(const double *a, const double *b)
{
    return compare(a, b) <= 0 ? a : b;
}

static const double *upper(const double *a, const double *b)
{
    return compare(a, b) <= 0 ? b : a;
}

/* Four points on a line. */
static int collinear_segments_meet(const double *p, const double *q, const double *u,
                                   const double *v)
{
    return compare(lower(p, q), upper(u, v)) <= 0 && compare(lower(u, v), upper(p, q)) <= 0;
}

/* Any two segments. */
static int segments_meet(const double *p, const double *q, const double *u, const double *v,
                         uint64_t *fallbacks)
{
    if (sc_predicates_orient3d(p, q, u, v, fallbacks) != 0) return 0;

    int axis = find_axis(p, q, u, fallbacks);
    if (axis < 0) axis = find_axis(p, q, v, fallbacks);
    if (axis < 0) axis = find_axis(u, v, p, fallbacks); /* matters if p is q */
    if (axis < 0) return collinear_segments_meet(p, q, u, v);

    /* They do not meet if one is strictly on one side of the line of the other, and else they do,
     * unless they are on one line. A point has no line, and signs 0. */
    int pq_u = projected_sign(p, q, u, axis, fallbacks);
    int pq_v = projected_sign(p, q, v, axis, fallbacks);
    if (pq_u * pq_v > 0) return 0;
    int uv_p = projected_sign(u, v, p, axis, fallbacks);
    int uv_q = projected_sign(u, v, q, axis, fallbacks);
    return uv_p * uv_q <= 0;
}

/*
 * A segment or point p q against a triangle whose plane it is in, or which has no area.
 *
 * Two convex sets in a plane do not meet if and only if a line between them is parallel to a side
 * of their difference, a polygon that has no sides but those of the triangle and the segment. So it
 * is enough to look at the lines of these, pushed outwards.
 */
static int flat_segment_meets(const double *p, const double *q, const double *const triangle[3],
                              uint64_t *fallbacks)
{
    const double *t0 = triangle[0], *t1 = triangle[1], *t2 = triangle[2];
    int axis = find_axis(t0, t1, t2, fallbacks);
    if (axis < 0) {
        const double *u = lower(lower(t0, t1), t2), *v = upper(upper(t0, t1), t2);
        return segments_meet(p, q, u, v, fallbacks);
    }
    int inside = projected_sign(t0, t1, t2, axis, fallbacks);
    for (int k = 0; k < 3; ++k) {
        const double *from = triangle[k], *to = triangle[next(k)];
        if (projected_sign(from, to, p, axis, fallbacks) == -inside &&
            projected_sign(from, to, q, axis, fallbacks) == -inside) {
            return 0;
        }
    }
    int side = projected_sign(p, q, t0, axis, fallbacks);
    return side == 0 || projected_sign(p, q, t1, axis, fallbacks) != side ||
           projected_sign(p, q, t2, axis, fallbacks) != side;
}

/* ------------------------------------------------------------------------------------------------
 * Segment against triangle
 */

/*
 * Whether a segment's line passes through a triangle, from the signs of the line against its sides;
 * the segment's ends are not both on its plane. Proper: not through its boundary.
 */
static int line_passes(const int side_signs[3], int proper)
{
    int x = side_signs[0], y = side_signs[1], z = side_signs[2];
    if (proper) return x != 0 && x == y && x == z;
    return x * y >= 0 && y * z >= 0 && z * x >= 0;
}

int sc_primitives_segment_meets(const double p[3], const double q[3],
                                const double *const triangle[3], int proper, uint64_t *fallbacks)
{
    sc_predicates_plane plane = sc_predicates_make_plane(triangle[0], triangle[1], triangle[2]);
    int p_side = sc_predicates_side_of_plane(&plane, p, fallbacks);
    int q_side = sc_predicates_side_of_plane(&plane, q, fallbacks);
    if (p_side * q_side > 0) return 0;
    if (proper && p_side * q_side == 0) return 0;
    if (p_side == 0 && q_side == 0) return flat_segment_meets(p, q, triangle, fallbacks);
    int signs[3];
    for (int k = 0; k < 3; ++k) {
        signs[k] = sc_predicates_orient3d(p, q, triangle[k], triangle[next(k)], fallbacks);
    }
    return line_passes(signs, proper);
}

/* ------------------------------------------------------------------------------------------------
 * Pairs of triangles that share at most one vertex and repeat none
 */

enum { UNKNOWN = 2, UNKNOWN_AXIS = 3 };

/* The signs of a pair. Those in a projection are found only if the triangles are in one plane. */
typedef struct pair_signs {
    const sc_triangle_pair *pair;
    uint64_t *fallbacks;
    int a_side[3];     /* of the vertices of a against the plane of b, seen from its normal */
    int b_side[3];     /* of the vertices of b against the plane of a */
    int cross[3][3];   /* orient3d of edge i of a and edge j of b, or UNKNOWN */
    int axis[2];       /* as find_axis has it for a and b, or UNKNOWN_AXIS */
    int inside[2];     /* along that axis, the sign of their own corners */
    int flat_axis;     /* along which the following are, or UNKNOWN_AXIS */
    int flat[2][3][3]; /* edge i of a against vertex j of b, then the other way round; or UNKNOWN */
} pair_signs;

static int find_cross(pair_signs *signs, int i, int j)
{
    if (signs->cross[i][j] == UNKNOWN) {
        const double *const *a = signs->pair->a, *const *b = signs->pair->b;
        signs->cross[i][j] =
            sc_predicates_orient3d(a[i], a[next(i)], b[j], b[next(j)], signs->fallbacks);
    }
    return signs->cross[i][j];
}

static void find_sides(int side[3], const double *const points[3], const sc_predicates_plane *plane,
                       int shared, uint64_t *fallbacks)
{
    for (int k = 0; k < 3; ++k) {
        side[k] = k == shared ? 0 : sc_predicates_side_of_plane(plane, points[k], fallbacks);
    }
}

/* Whether the points of a plane are certainly not on one line: a component of the normal is not
   zero. */
static int has_area(const sc_predicates_plane *plane)
{
    int certain = 0;
    for (int i = 0; i < 3; ++i) {
        double bound = SC_BOUNDS_SIGN_2D * plane->magnitude[i] + SC_BOUNDS_SIGN_TINY;
        certain |= fabs(plane->normal[i]) > bound;
    }
    return certain;
}

/*
 * Whether the vertices that are not shared are strictly on one side of the other triangle's plane;
 * shared may be -1: none. If so, no edge without the shared vertex meets the other triangle: the
 * triangle has only the shared vertex in common with the plane, and in the plane the edge opposite
 * to that vertex does not contain it, for a triangle with points off its plane has an area.
 */
static int is_on_one_side(const int side[3], int shared)
{
    int k = shared == 0 ? 1 : 0;
    int l = shared == 2 ? 1 : 2;
    if (side[k] == 0 || side[k] != side[l]) return 0;
    return shared >= 0 || side[1] == side[k];
}

/*
 * Finds the sides. m and n are the places of the shared vertex in a and b, or both -1. Returns 0 if
 * already the sides exclude that edges meet triangles.
 */
static int start_signs(pair_signs *signs, const sc_triangle_pair *pair, int m, int n,
                       uint64_t *fallbacks)
{
    sc_predicates_plane plane = sc_predicates_make_plane(pair->b[0], pair->b[1], pair->b[2]);
    const int *side = signs->a_side;
    signs->pair = pair;
    signs->fallbacks = fallbacks;
    find_sides(signs->a_side, pair->a, &plane, m, fallbacks);
    if (is_on_one_side(side, m)) return 0;
    if (side[0] == 0 && side[1] == 0 && side[2] == 0 && has_area(&plane)) {
        for (int k = 0; k < 3; ++k) signs->b_side[k] = 0; /* all six are in its plane */
    } else {
        plane = sc_predicates_make_plane(pair->a[0], pair->a[1], pair->a[2]);
        find_sides(signs->b_side, pair->b, &plane, n, fallbacks);
        if (is_on_one_side(signs->b_side, n)) return 0;
    }

    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) signs->cross[i][j] = UNKNOWN;
    }
    signs->axis[0] = signs->axis[1] = signs->flat_axis = UNKNOWN_AXIS;
    if (m >= 0) {
        /* An edge through the shared vertex and the opposite edge of the other triangle make up
           that triangle and a point: the same four points as those of a side, differently
           ordered. */
        int opposite_m = next(m), opposite_n = next(n);
        signs->cross[opposite_m][n] = signs->b_side[next(n)];
        signs->cross[opposite_m][previous(n)] = -signs->b_side[previous(n)];
        signs->cross[m][opposite_n] = signs->a_side[next(m)];
        signs->cross[previous(m)][opposite_n] = -signs->a_side[previous(m)];
    }
    return 1;
}

/* The sign of edge i of a triangle (0: a, 1: b) against vertex j of the other, along an axis. */
static int find_flat(pair_signs *signs, int of, int i, int j, int axis)
{
    if (signs->flat_axis != axis) {
        for (int k = 0; k < 18; ++k) signs->flat[k / 9][k / 3 % 3][k % 3] = UNKNOWN;
        signs->flat_axis = axis;
    }
    int *sign = &signs->flat[of][i][j];
    if (*sign == UNKNOWN) {
        const double *const *mine = of ? signs->pair->b : signs->pair->a;
        const double *const *other = of ? signs->pair->a : signs->pair->b;
        *sign = projected_sign(mine[i], mine[next(i)], other[j], axis, signs->fallbacks);
    }
    return *sign;
}

/* As flat_segment_meets, of edge k of a triangle, with signs that are found once. */
static int flat_edge_meets(pair_signs *signs, int of, int k)
{
    const double *const *mine = of ? signs->pair->b : signs->pair->a;
    const double *const *t = of ? signs->pair->a : signs->pair->b;
    int *axis = &signs->axis[1 - of], inside;
    if (*axis == UNKNOWN_AXIS) {
        *axis = find_axis(t[0], t[1], t[2], signs->fallbacks);
        if (*axis >= 0)
            signs->inside[1 - of] = projected_sign(t[0], t[1], t[2], *axis, signs->fallbacks);
    }
    if (*axis < 0) return flat_segment_meets(mine[k], mine[next(k)], t, signs->fallbacks);
    inside = signs->inside[1 - of];
    for (int i = 0; i < 3; ++i) {
        if (find_flat(signs, 1 - of, i, k, *axis) == -inside &&
            find_flat(signs, 1 - of, i, next(k), *axis) == -inside) {
            return 0;
        }
    }
    int side = find_flat(signs, of, k, 0, *axis);
    return side == 0 || find_flat(signs, of, k, 1, *axis) != side ||
           find_flat(signs, of, k, 2, *axis) != side;
}

/* Whether an edge (bit number 0 to 5) meets the other triangle. */
static int edge_meets(pair_signs *signs, int edge, int proper)
{
    int of_a = edge < 3, k = of_a ? edge : edge - 3;
    const int *side = of_a ? signs->a_side : signs->b_side;
    int from = side[k], to = side[next(k)];
    if (from * to > 0) return 0;
    if (proper && from * to == 0) return 0;
    if (from == 0 && to == 0) return flat_edge_meets(signs, !of_a, k);
    int crosses[3];
    for (int l = 0; l < 3; ++l) {
        crosses[l] = of_a ? find_cross(signs, k, l) : find_cross(signs, l, k);
    }
    return line_passes(crosses, proper);
}

/* ------------------------------------------------------------------------------------------------
 * All pairs of triangles
 */

static int repeats_number(const uint32_t v[3])
{
    return v[0] == v[1] || v[1] == v[2] || v[2] == v[0];
}

static int has_number(const uint32_t v[3], uint32_t number)
{
    return v[0] == number || v[1] == number || v[2] == number;
}

/* Which vertices of one triangle are vertices of the other, as three bits. */
static unsigned shared_bits(const uint32_t v[3], const uint32_t other[3])
{
    unsigned bits = 0;
    for (int k = 0; k < 3; ++k) {
        if (has_number(other, v[k])) bits |= 1u << k;
    }
    return bits;
}

/* Whether two vertices of these have different numbers. */
static int are_several(const uint32_t v[3], unsigned bits)
{
    for (int k = 0; k < 3; ++k) {
        unsigned both = 1u << k | 1u << next(k);
        if ((bits & both) == both && v[k] != v[next(k)]) return 1;
    }
    return 0;
}

/* The number of the only bit among three, -1 if there is none. */
static int only_bit(unsigned bits)
{
    return bits == 0 ? -1 : bits == 1 ? 0 : bits == 2 ? 1 : 2;
}

/* The edges of one triangle that share no vertex with the other and are no loops. */
static unsigned free_edges(const uint32_t v[3], unsigned shared)
{
    unsigned edges = 0;
    for (int k = 0; k < 3; ++k) {
        unsigned ends = 1u << k | 1u << next(k);
        if ((shared & ends) == 0 && v[k] != v[next(k)]) edges |= 1u << k;
    }
    return edges;
}

unsigned sc_primitives_edge_hits(const sc_triangle_pair *pair, int proper, unsigned edges,
                                 uint64_t *fallbacks)
{
    unsigned a_shared = shared_bits(pair->va, pair->vb), b_shared = shared_bits(pair->vb, pair->va);
    unsigned hits = 0;
    edges &= free_edges(pair->va, a_shared) | free_edges(pair->vb, b_shared) << 3;
    if (edges == 0) return 0;

    if (repeats_number(pair->va) || repeats_number(pair->vb)) {
        for (int edge = 0; edge < 6; ++edge) {
            if ((edges >> edge & 1u) == 0) continue;
            int of_a = edge < 3, k = of_a ? edge : edge - 3;
            const double *const *mine = of_a ? pair->a : pair->b;
            if (sc_primitives_segment_meets(mine[k], mine[next(k)], of_a ? pair->b : pair->a,
                                            proper, fallbacks)) {
                hits |= 1u << edge;
            }
        }
        return hits;
    }
    /* An edge shares nothing, so that the triangles share at most one vertex. */
    pair_signs signs;
    if (!start_signs(&signs, pair, only_bit(a_shared), only_bit(b_shared), fallbacks)) return 0;
    for (int edge = 0; edge < 6; ++edge) {
        if ((edges >> edge & 1u) != 0 && edge_meets(&signs, edge, proper)) hits |= 1u << edge;
    }
    return hits;
}

/* Touching, one triangle or both repeating a number. */
static int repeating_triangles_meet(const sc_triangle_pair *pair, unsigned a_shared,
                                    unsigned b_shared, uint64_t *fallbacks)
{
    if (a_shared == 0) {
        /* Hulls that meet do so at the boundary of one, and a hull without area is its boundary. */
        for (int k = 0; k < 3; ++k) {
            if (sc_primitives_segment_meets(pair->a[k], pair->a[next(k)], pair->b, 0, fallbacks) ||
                sc_primitives_segment_meets(pair->b[k], pair->b[next(k)], pair->a, 0, fallbacks)) {
                return 1;
            }
        }
        return 0;
    }
    /* Sharing two, the one that repeats a number is the segment between them. */
    if (are_several(pair->va, a_shared)) return 0;

    for (int of_a = 0; of_a < 2; ++of_a) {
        const double *const *mine = of_a ? pair->a : pair->b;
        unsigned shared = of_a ? a_shared : b_shared;
        const double *first = 0, *last = 0;
        for (int k = 0; k < 3; ++k) {
            if (shared >> k & 1u) continue;
            if (!first) first = mine[k];
            last = mine[k];
        }
        if (first &&
            sc_primitives_segment_meets(first, last, of_a ? pair->b : pair->a, 0, fallbacks)) {
            return 1;
        }
    }
    return 0;
}

/*
 * Triangles s t x and s t y: do they have a common point off the segment s t?
 *
 * If both have an area and s t is a proper segment, only by being folded onto each other. If one of
 * them has none, its points on the plane of the other are on the line s t, where the other has only
 * s t. What remains is on one line, or is two segments that start at one point s = t.
 */
static int folded_triangles_meet(const double *s, const double *t, const double *x, const double *y,
                                 uint64_t *fallbacks)
{
    if (sc_predicates_orient3d(s, t, x, y, fallbacks) != 0) return 0;

    int axis = find_axis(s, t, x, fallbacks);
    if (axis >= 0) {
        return projected_sign(s, t, x, axis, fallbacks) == projected_sign(s, t, y, axis, fallbacks);
    }
    if (find_axis(s, t, y, fallbacks) >= 0) return 0;
    if (compare(s, t) == 0 && find_axis(s, x, y, fallbacks) >= 0) return 0;
    const double *low = lower(s, t), *high = upper(s, t);
    return (compare(x, high) > 0 && compare(y, high) > 0) ||
           (compare(x, low) < 0 && compare(y, low) < 0);
}

int sc_primitives_triangles_meet(const sc_triangle_pair *pair, int proper, uint64_t *fallbacks)
{
    if (proper) return sc_primitives_edge_hits(pair, 1, SC_PRIMITIVES_ALL_EDGES, fallbacks) != 0;

    unsigned a_shared = shared_bits(pair->va, pair->vb), b_shared = shared_bits(pair->vb, pair->va);
    if (repeats_number(pair->va) || repeats_number(pair->vb)) {
        return repeating_triangles_meet(pair, a_shared, b_shared, fallbacks);
    }
    if (a_shared == 7) return 1;

    int m = only_bit(a_shared), n = only_bit(b_shared);
    if (are_several(pair->va, a_shared)) {
        int x = only_bit(~a_shared & 7u), y = only_bit(~b_shared & 7u);
        return folded_triangles_meet(pair->a[next(x)], pair->a[previous(x)], pair->a[x], pair->b[y],
                                     fallbacks);
    }
    pair_signs signs;
    if (!start_signs(&signs, pair, m, n, fallbacks)) return 0;
    if (m >= 0) return edge_meets(&signs, next(m), 0) || edge_meets(&signs, 3 + next(n), 0);
    for (int edge = 0; edge < 6; ++edge) {
        if (edge_meets(&signs, edge, 0)) return 1;
    }
    return 0;
}
