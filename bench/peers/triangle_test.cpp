/*
 * The triangle test: see triangle_test.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "triangle_test.h"

#include <cmath>
#include <limits>

namespace peers
{
namespace
{

const double unit =
    0.5 * std::numeric_limits<double>::epsilon(); /* one rounding's relative error */
const double bound_3d = (7.0 + 56.0 * unit) * unit;
const double bound_2d = (3.0 + 16.0 * unit) * unit;
const double tiny = 1e-200; /* below it products may have lost bits to underflow */

/*
 * An exact sum of doubles: parts that do not overlap, in ascending order of magnitude, none zero
 * (Shewchuk, section 2.4). No determinant here has more terms than MOST.
 */
struct exact_sum {
    enum { MOST = 96 };
    double parts[MOST];
    int count = 0;

    void add(double term)
    {
        int kept = 0;
        for (int i = 0; i < count; ++i) {
            const double sum = term + parts[i], rest = sum - term;
            const double error = (term - (sum - rest)) + (parts[i] - rest);
            if (error != 0.0) parts[kept++] = error;
            term = sum;
        }
        if (term != 0.0) parts[kept++] = term;
        count = kept;
    }
    void add_product(double x, double y)
    {
        const double product = x * y;
        add(std::fma(x, y, -product));
        add(product);
    }
    void add_product(double x, double y, double z)
    {
        const double product = x * y;
        add_product(std::fma(x, y, -product), z);
        add_product(product, z);
    }
    int sign() const
    {
        return count == 0 ? 0 : parts[count - 1] > 0.0 ? 1 : -1;
    }
};

int sign_of(double value)
{
    return (value > 0.0) - (value < 0.0);
}

/* Adds the determinant of three points, times 1 or -1. */
void add_determinant(exact_sum &sum, double factor, const double *a, const double *b,
                     const double *c)
{
    for (int k = 0; k < 3; ++k) {
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        sum.add_product(factor * a[k], b[i], c[j]);
        sum.add_product(-factor * a[k], b[j], c[i]);
    }
}

int exact_side(const double *a, const double *b, const double *c, const double *d)
{
    exact_sum sum;
    add_determinant(sum, 1.0, a, b, c);
    add_determinant(sum, -1.0, d, b, c);
    add_determinant(sum, -1.0, a, d, c);
    add_determinant(sum, -1.0, a, b, d);
    return sum.sign();
}

/* The side of the plane through a, b and c on which d lies: -1, 0 (in it) or 1. */
int side(const double *a, const double *b, const double *c, const double *d)
{
    const double ax = a[0] - d[0], ay = a[1] - d[1], az = a[2] - d[2];
    const double bx = b[0] - d[0], by = b[1] - d[1], bz = b[2] - d[2];
    const double cx = c[0] - d[0], cy = c[1] - d[1], cz = c[2] - d[2];
    const double bxcy = bx * cy, cxby = cx * by, cxay = cx * ay, axcy = ax * cy;
    const double axby = ax * by, bxay = bx * ay;
    const double determinant = az * (bxcy - cxby) + bz * (cxay - axcy) + cz * (axby - bxay);
    const double sum = (std::fabs(bxcy) + std::fabs(cxby)) * std::fabs(az) +
                       (std::fabs(cxay) + std::fabs(axcy)) * std::fabs(bz) +
                       (std::fabs(axby) + std::fabs(bxay)) * std::fabs(cz);
    if (std::fabs(determinant) > bound_3d * sum + tiny) return sign_of(determinant);
    /* Flat parts of a mesh often lie in a coordinate plane. */
    if ((ax == 0.0 && bx == 0.0 && cx == 0.0) || (ay == 0.0 && by == 0.0 && cy == 0.0) ||
        (az == 0.0 && bz == 0.0 && cz == 0.0)) {
        return 0;
    }
    return exact_side(a, b, c, d);
}

/* The turn from a over b to c in the coordinate plane of axes x and y. */
int turn(const double *a, const double *b, const double *c, int x, int y)
{
    const double left = (a[x] - c[x]) * (b[y] - c[y]), right = (a[y] - c[y]) * (b[x] - c[x]);
    const double determinant = left - right;
    if (std::fabs(determinant) > bound_2d * (std::fabs(left) + std::fabs(right)) + tiny)
        return sign_of(determinant);
    exact_sum sum;
    sum.add_product(a[x], b[y]);
    sum.add_product(-a[y], b[x]);
    sum.add_product(b[x], c[y]);
    sum.add_product(-b[y], c[x]);
    sum.add_product(c[x], a[y]);
    sum.add_product(-c[y], a[x]);
    return sum.sign();
}

/* Two coordinate axes in whose plane the triangle keeps an area. */
void choose_axes(const double *const t[3], int &x, int &y)
{
    for (x = 0; x < 2; ++x) {
        y = (x + 1) % 3;
        if (turn(t[0], t[1], t[2], x, y) != 0) return;
    }
    y = 0;
}

/* Whether the line of an edge of t has t on one side and all the points on the other, off the
   line. */
bool edge_separates(const double *const t[3], const double *const *points, int count, int x, int y)
{
    const int inner = turn(t[0], t[1], t[2], x, y);
    for (int k = 0; k < 3; ++k) {
        int i = 0;
        while (i < count && turn(t[k], t[(k + 1) % 3], points[i], x, y) == -inner) ++i;
        if (i == count) return true;
    }
    return false;
}

/*
 * What lies in one plane. Convex polygons are apart if and only if the line of an edge separates
 * them, and a segment is one.
 */
bool coplanar_meet(const double *const a[3], const double *const b[3])
{
    int x, y;
    choose_axes(a, x, y);
    return !edge_separates(a, b, 3, x, y) && !edge_separates(b, a, 3, x, y);
}

bool coplanar_segment_meets(const double *p, const double *q, const double *const t[3])
{
    int x, y;
    choose_axes(t, x, y);
    const double *const segment[2] = {p, q};
    if (edge_separates(t, segment, 2, x, y)) return false;
    const int first = turn(p, q, t[0], x, y);
    return first == 0 || turn(p, q, t[1], x, y) != first || turn(p, q, t[2], x, y) != first;
}

/* at_p, at_q: the sides of the triangle's plane on which p and q lie. */
bool segment_meets(const double *p, int at_p, const double *q, int at_q, const double *const t[3])
{
    if (at_p * at_q > 0) return false;
    if (at_p == 0 && at_q == 0) return coplanar_segment_meets(p, q, t);
    bool positive = false, negative = false;
    for (int k = 0; k < 3; ++k) {
        const int s = side(p, q, t[k], t[(k + 1) % 3]);
        positive |= s > 0;
        negative |= s < 0;
    }
    return !(positive && negative);
}

/* The sides on which the corners of t lie; whether all are on the same side, off the plane. */
bool one_side(const double *const plane[3], const double *const t[3], int sides[3])
{
    for (int k = 0; k < 3; ++k) sides[k] = side(plane[0], plane[1], plane[2], t[k]);
    return sides[0] != 0 && sides[0] == sides[1] && sides[1] == sides[2];
}

} // namespace

/* If triangles meet, so does an edge of one the other. */
bool triangles_meet(const double *const a[3], const double *const b[3])
{
    int sides_a[3], sides_b[3];
    if (one_side(a, b, sides_b) || one_side(b, a, sides_a)) return false;
    if (sides_b[0] == 0 && sides_b[1] == 0 && sides_b[2] == 0) return coplanar_meet(a, b);
    for (int k = 0; k < 3; ++k) {
        const int next = (k + 1) % 3;
        if (segment_meets(b[k], sides_b[k], b[next], sides_b[next], a)) return true;
        if (segment_meets(a[k], sides_a[k], a[next], sides_a[next], b)) return true;
    }
    return false;
}

} // namespace peers
