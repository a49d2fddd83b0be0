/*
 * Closest points in rational numbers. See stencil_oracle.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "stencil_oracle.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum { SETS_MAX = 16 };

void stencil_oracle_start(stencil_oracle *o)
{
    for (int i = 0; i < 12; ++i) mpq_init(o->x[i / 3][i % 3]);
    for (int i = 0; i < 4; ++i) mpq_inits(o->weights[i], o->trial[i], NULL);
    for (int k = 0; k < 3; ++k) mpq_inits(o->vector[k], o->offset[k], NULL);
    mpq_inits(o->square, o->least, NULL);
}

void stencil_oracle_stop(stencil_oracle *o)
{
    for (int i = 0; i < 12; ++i) mpq_clear(o->x[i / 3][i % 3]);
    for (int i = 0; i < 4; ++i) mpq_clears(o->weights[i], o->trial[i], NULL);
    for (int k = 0; k < 3; ++k) mpq_clears(o->vector[k], o->offset[k], NULL);
    mpq_clears(o->square, o->least, NULL);
}

/* result = u . v */
static void find_dot(mpq_t result, mpq_t u[3], mpq_t v[3])
{
    mpq_t t, sum;
    mpq_inits(t, sum, NULL);
    for (int k = 0; k < 3; ++k) {
        mpq_mul(t, u[k], v[k]);
        mpq_add(sum, sum, t);
    }
    mpq_set(result, sum);
    mpq_clears(t, sum, NULL);
}

static void find_vector(stencil_oracle *o, mpq_t weights[4], mpq_t vector[3])
{
    mpq_t t;
    mpq_init(t);
    for (int k = 0; k < 3; ++k) {
        mpq_set_ui(vector[k], 0, 1);
        for (int i = 0; i < 4; ++i) {
            mpq_mul(t, weights[i], o->x[i][k]);
            mpq_add(vector[k], vector[k], t);
        }
    }
    mpq_clear(t);
}

/*
 * The weights, in o->trial, of the closest points of the hulls of the chosen vertices without their
 * bounds, and in o->offset and o->least the vector and its square. 0 if there is no such point that
 * is unique and inside.
 */
static int try_set(stencil_oracle *o, unsigned chosen)
{
    mpq_t column[2][3], from[3], a, b, c, d, e, t, s;
    int first[2] = {-1, -1}, of_column[2] = {0, 0}, columns = 0, inside = 1;
    for (int i = 0; i < 4; ++i) {
        int side = i >= o->first_of_b;
        mpq_set_ui(o->trial[i], 0, 1);
        if (!(chosen >> i & 1)) continue;
        if (first[side] < 0)
            first[side] = i;
        else if (columns < 2)
            of_column[columns++] = i;
    }
    if (first[0] < 0 || first[1] < 0) return 0;
    for (int k = 0; k < 3; ++k) mpq_inits(column[0][k], column[1][k], from[k], NULL);
    mpq_inits(a, b, c, d, e, t, s, NULL);
    for (int k = 0; k < 3; ++k) {
        mpq_sub(from[k], o->x[first[1]][k], o->x[first[0]][k]);
        for (int i = 0; i < columns; ++i) {
            int of = of_column[i], start = first[of >= o->first_of_b];
            if (of < o->first_of_b)
                mpq_sub(column[i][k], o->x[start][k], o->x[of][k]);
            else
                mpq_sub(column[i][k], o->x[of][k], o->x[start][k]);
        }
    }
    /* |from + s column0 + t column1| is least */
    find_dot(a, column[0], column[0]);
    find_dot(b, column[0], column[1]);
    find_dot(c, column[1], column[1]);
    find_dot(d, column[0], from);
    find_dot(e, column[1], from);
    if (columns == 1) {
        inside = mpq_sgn(a) != 0;
        if (inside) {
            mpq_div(s, d, a);
            mpq_neg(s, s);
        }
    } else if (columns == 2) {
        mpq_t determinant, u;
        mpq_inits(determinant, u, NULL);
        mpq_mul(determinant, a, c);
        mpq_mul(u, b, b);
        mpq_sub(determinant, determinant, u);
        inside = mpq_sgn(determinant) != 0;
        if (inside) {
            mpq_mul(s, b, e);
            mpq_mul(u, c, d);
            mpq_sub(s, s, u);
            mpq_div(s, s, determinant);
            mpq_mul(t, b, d);
            mpq_mul(u, a, e);
            mpq_sub(t, t, u);
            mpq_div(t, t, determinant);
        }
        mpq_clears(determinant, u, NULL);
    }
    mpq_set_si(o->trial[first[0]], -1, 1);
    mpq_set_si(o->trial[first[1]], 1, 1);
    for (int i = 0; i < columns; ++i) {
        int of = of_column[i], side = of >= o->first_of_b;
        mpq_set(o->trial[of], i ? t : s);
        if (!side) mpq_neg(o->trial[of], o->trial[of]);
        mpq_sub(o->trial[first[side]], o->trial[first[side]], o->trial[of]);
    }
    for (int i = 0; i < 4; ++i)
        if (chosen >> i & 1) inside &= mpq_sgn(o->trial[i]) == (i < o->first_of_b ? -1 : 1);
    if (inside) {
        find_vector(o, o->trial, o->offset);
        find_dot(o->least, o->offset, o->offset);
    }
    for (int k = 0; k < 3; ++k) mpq_clears(column[0][k], column[1][k], from[k], NULL);
    mpq_clears(a, b, c, d, e, t, s, NULL);
    return inside;
}

static int count_of(unsigned set)
{
    int count = 0;
    for (; set; set >>= 1) count += (int)(set & 1);
    return count;
}

/* x first, then y, then z. */
static int compare_points(mpq_t p[3], mpq_t q[3])
{
    for (int k = 0; k < 3; ++k) {
        int order = mpq_cmp(p[k], q[k]);
        if (order) return order;
    }
    return 0;
}

/* u x v = 0 */
static int are_parallel(mpq_t u[3], mpq_t v[3])
{
    mpq_t s, t;
    int parallel = 1;
    mpq_inits(s, t, NULL);
    for (int k = 0; k < 3; ++k) {
        mpq_mul(s, u[k], v[(k + 1) % 3]);
        mpq_mul(t, u[(k + 1) % 3], v[k]);
        parallel &= mpq_equal(s, t) != 0;
    }
    mpq_clears(s, t, NULL);
    return parallel;
}

static uint32_t find_flags(stencil_oracle *o)
{
    mpq_t u[3], v[3];
    uint32_t flags;
    int from = o->first_of_b - 1; /* of the face: 1 to 2, 1 to 3 */
    for (int k = 0; k < 3; ++k) {
        mpq_inits(u[k], v[k], NULL);
        if (from == 0) {
            mpq_sub(u[k], o->x[2][k], o->x[1][k]);
            mpq_sub(v[k], o->x[3][k], o->x[1][k]);
        } else {
            mpq_sub(u[k], o->x[1][k], o->x[0][k]);
            mpq_sub(v[k], o->x[3][k], o->x[2][k]);
        }
    }
    flags = are_parallel(u, v) ? SC_STENCIL_PARALLEL : 0;
    for (int k = 0; k < 3; ++k) mpq_clears(u[k], v[k], NULL);
    return flags;
}

/* Which of two vertices is farther along an edge's direction, from its lower to its higher end:
   compares i - j with it. */
static int compare_along(stencil_oracle *o, int i, int j, unsigned edge)
{
    mpq_t u[3], v[3], dot;
    int low = -1, high = -1, sign;
    for (int e = 0; e < 4; ++e)
        if (edge >> e & 1) {
            if (low < 0)
                low = e;
            else
                high = e;
        }
    if (compare_points(o->x[low], o->x[high]) > 0) {
        int swap = low;
        low = high;
        high = swap;
    }
    mpq_init(dot);
    for (int k = 0; k < 3; ++k) {
        mpq_inits(u[k], v[k], NULL);
        mpq_sub(u[k], o->x[high][k], o->x[low][k]);
        mpq_sub(v[k], o->x[i][k], o->x[j][k]);
    }
    find_dot(dot, u, v);
    sign = mpq_sgn(dot);
    for (int k = 0; k < 3; ++k) mpq_clears(u[k], v[k], NULL);
    mpq_clear(dot);
    return sign;
}

static void find_square_of_edge(stencil_oracle *o, unsigned edge, mpq_t square)
{
    mpq_t v[3];
    int i = 0, j = 3;
    while (!(edge >> i & 1)) ++i;
    while (!(edge >> j & 1)) --j;
    for (int k = 0; k < 3; ++k) {
        mpq_init(v[k]);
        mpq_sub(v[k], o->x[j][k], o->x[i][k]);
    }
    find_dot(square, v, v);
    for (int k = 0; k < 3; ++k) mpq_clear(v[k]);
}

static int lowest_of(unsigned set)
{
    int i = 0;
    while (!(set >> i & 1)) ++i;
    return i;
}

/* Of two sets of as many vertices with points as close: whether the first is the one to take. Sets
   are tried in such an order that the first is the one that comes first in vertices. */
static int is_preferred(stencil_oracle *o, unsigned set, unsigned other)
{
    unsigned a = (1u << o->first_of_b) - 1;
    if (count_of(set) == 2) {
        int order = compare_points(o->x[lowest_of(set & a)], o->x[lowest_of(other & a)]);
        if (!order) order = compare_points(o->x[lowest_of(set & ~a)], o->x[lowest_of(other & ~a)]);
        return order < 0;
    }
    if (o->first_of_b == 1) { /* edges of a face without area: the longest */
        mpq_t square[2];
        int longer;
        mpq_inits(square[0], square[1], NULL);
        find_square_of_edge(o, set & ~a, square[0]);
        find_square_of_edge(o, other & ~a, square[1]);
        longer = mpq_cmp(square[0], square[1]) > 0;
        mpq_clears(square[0], square[1], NULL);
        return longer;
    }
    {
        int one = lowest_of(count_of(set & a) == 1 ? set & a : set & ~a);
        int two = lowest_of(count_of(other & a) == 1 ? other & a : other & ~a);
        unsigned edge = count_of(set & a) == 2 ? set & a : set & ~a;
        return compare_along(o, one, two, edge) < 0;
    }
}

void stencil_oracle_find(stencil_oracle *o, uint32_t kind, double points[4][3])
{
    static const unsigned sets[SETS_MAX] = {3, 5, 9, 6, 10, 7, 11, 13, 14, 15};
    unsigned best = 0;
    o->first_of_b = kind == SC_NEAR_VERTEX_FACE ? 1 : 2;
    for (int i = 0; i < 12; ++i) mpq_set_d(o->x[i / 3][i % 3], points[i / 3][i % 3]);
    for (int i = 0; i < SETS_MAX; ++i) { /* by their number of vertices; 0 ends the list */
        int order;
        if (!sets[i] || !try_set(o, sets[i])) continue;
        order = best ? mpq_cmp(o->least, o->square) : -1;
        if (order > 0 ||
            (order == 0 && (count_of(sets[i]) > count_of(best) || !is_preferred(o, sets[i], best))))
            continue;
        best = sets[i];
        mpq_set(o->square, o->least);
        for (int k = 0; k < 4; ++k) mpq_set(o->weights[k], o->trial[k]);
        for (int k = 0; k < 3; ++k) mpq_set(o->vector[k], o->offset[k]);
    }
    o->flags = find_flags(o);
    o->feature = count_of(best) == 2   ? SC_FEATURE_VERTEX_VERTEX
                 : count_of(best) == 3 ? SC_FEATURE_VERTEX_EDGE
                 : o->first_of_b == 1  ? SC_FEATURE_VERTEX_FACE
                                       : SC_FEATURE_EDGE_EDGE;
}

/* ---- comparing ---- */

/* Within 2^-50 relatively or 2^-1022, or infinite where the truth is too large. */
static int is_close_number(double value, mpq_t truth)
{
    mpq_t t, bound, least;
    int close;
    if (value != value) return 0;
    mpq_inits(t, bound, least, NULL);
    mpq_abs(bound, truth);
    mpq_div_2exp(bound, bound, 50);
    if (value - value != 0) {
        mpq_set_d(t, DBL_MAX);
        if (value < 0) mpq_neg(t, t);
        mpq_sub(t, truth, t);
        close = mpq_sgn(t) * (value < 0 ? -1 : 1) >= 0;
        mpq_abs(t, t);
        close |= mpq_cmp(t, bound) <= 0;
    } else {
        mpq_set_d(least, DBL_MIN);
        mpq_set_d(t, value);
        mpq_sub(t, t, truth);
        mpq_abs(t, t);
        close = mpq_cmp(t, bound) <= 0 || mpq_cmp(t, least) <= 0;
    }
    mpq_clears(t, bound, least, NULL);
    return close;
}

/* The same of a root: a value moved by its error is squared. */
static int is_close_root(double value, mpq_t square)
{
    mpq_t t, least, factor;
    int close = 1;
    if (!(value >= 0)) return 0;
    mpq_inits(t, least, factor, NULL);
    mpq_set_d(least, DBL_MIN);
    for (int above = 0; above < 2; ++above) {
        /* value <= (1 + 2^-50) root + 2^-1022 and value >= (1 - 2^-50) root - 2^-1022 */
        int infinite = value - value != 0;
        mpq_set_d(t, infinite ? DBL_MAX : value);
        if (above)
            mpq_add(t, t, least);
        else
            mpq_sub(t, t, least);
        if (infinite && above) continue;
        if (mpq_sgn(t) < 0) continue;
        mpq_mul(t, t, t);
        mpq_set_d(factor, above ? 1 - 0x1p-50 : 1 + 0x1p-50);
        mpq_mul(factor, factor, factor);
        mpq_mul(factor, factor, square);
        close &= above ? mpq_cmp(t, factor) >= 0 : mpq_cmp(t, factor) <= 0;
    }
    mpq_clears(t, least, factor, NULL);
    return close;
}

const char *stencil_oracle_compare(stencil_oracle *o, const sc_near_stencil *stencil)
{
    if (stencil->feature != o->feature) return "feature";
    if (stencil->flags != o->flags) return "flags";
    for (int i = 0; i < 4; ++i) {
        double w = stencil->weights[i];
        if ((w > 0) - (w < 0) != mpq_sgn(o->weights[i])) return "sign of a weight";
        if (!is_close_number(w, o->weights[i])) return "weight";
    }
    for (int k = 0; k < 3; ++k)
        if (!is_close_number(stencil->vector[k], o->vector[k])) return "vector";
    for (int k = 0; k < 3; ++k) {
        double v = stencil->vector[k];
        if (mpq_sgn(o->vector[k]) == 0 && (v > 0 || v < 0)) return "vector that should be 0";
    }
    if (!is_close_root(stencil->distance, o->square)) return "distance";
    if (mpq_sgn(o->square) == 0 && stencil->distance > 0) return "distance that should be 0";
    return NULL;
}
