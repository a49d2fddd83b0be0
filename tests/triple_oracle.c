/*
 * The oracle of triple points. See triple_oracle.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "triple_oracle.h"

#include <gmp.h>
#include <math.h>
#include <stdlib.h>

#include "harness.h"

/* ---- polynomials ---- */

/* A product of unknowns, and its coefficient: bits 2 i and 2 i + 1 of powers are the power of
   unknown i. So the larger of two products is the one whose powers are the smaller number. */
typedef struct monomial {
    uint64_t powers;
    mpq_t coefficient;
} monomial;

typedef struct polynomial {
    uint32_t count;
    monomial *terms;
} polynomial;

static void add_monomial(polynomial *p, uint64_t powers, const mpq_t coefficient)
{
    monomial *term = &p->terms[p->count++];
    term->powers = powers;
    mpq_init(term->coefficient);
    mpq_set(term->coefficient, coefficient);
}

static void free_polynomial(polynomial *p)
{
    for (uint32_t i = 0; i < p->count; ++i) mpq_clear(p->terms[i].coefficient);
    free(p->terms);
}

static int compare_monomials(const void *a, const void *b)
{
    const uint64_t x = ((const monomial *)a)->powers, y = ((const monomial *)b)->powers;
    return (x > y) - (x < y);
}

/* Sorts terms, the largest product of unknowns first, and adds up those of one. */
static void collect_terms(polynomial *p)
{
    uint32_t kept = 0;
    qsort(p->terms, p->count, sizeof *p->terms, compare_monomials);
    for (uint32_t i = 0; i < p->count; ++i) {
        monomial *last = &p->terms[kept ? kept - 1 : 0], *term = &p->terms[i];
        if (kept && last->powers == term->powers) {
            mpq_add(last->coefficient, last->coefficient, term->coefficient);
            mpq_clear(term->coefficient);
        } else {
            p->terms[kept++] = *term;
        }
    }
    p->count = kept;
}

static int sign_of_columns(const int column[4])
{
    int inversions = 0;
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < i; ++j) inversions += column[j] > column[i];
    return inversions % 2 ? -1 : 1;
}

/* The determinant of the rows 1, x, y, z of four points, of which each coordinate is a number and
   an unknown: all products of one element of each row, in columns of their own. */
static polynomial expand_rows(const double *const points[4], const uint32_t ranks[4])
{
    polynomial p = {0, (monomial *)test_allocate(24 * 16 * sizeof *p.terms)};
    mpq_t product, factor;
    mpq_inits(product, factor, NULL);
    for (int code = 0; code < 256; ++code) {
        int column[4], seen = 0;
        for (int i = 0; i < 4; ++i) {
            column[i] = code >> 2 * i & 3;
            seen |= 1 << column[i];
        }
        if (seen != 15) continue;
        for (int chosen = 0; chosen < 16; ++chosen) {
            uint64_t powers = 0;
            int is_of_ones = 0;
            mpq_set_si(product, sign_of_columns(column), 1);
            for (int i = 0; i < 4; ++i) {
                if (!(chosen >> i & 1)) {
                    mpq_set_d(factor, column[i] ? points[i][column[i] - 1] : 1.0);
                    mpq_mul(product, product, factor);
                } else if (column[i] == 0) {
                    is_of_ones = 1; /* these have no unknown */
                } else {
                    powers += UINT64_C(1) << 2 * (3 * ranks[i] + (uint32_t)column[i] - 1);
                }
            }
            if (!is_of_ones) add_monomial(&p, powers, product);
        }
    }
    mpq_clears(product, factor, NULL);
    collect_terms(&p);
    return p;
}

/* Adds sign times the product of two. */
static void add_product_of(polynomial *sum, const polynomial *a, const polynomial *b, int sign)
{
    mpq_t product, factor;
    mpq_inits(product, factor, NULL);
    mpq_set_si(factor, sign, 1);
    for (uint32_t i = 0; i < a->count; ++i)
        for (uint32_t j = 0; j < b->count; ++j) {
            if (!mpq_sgn(a->terms[i].coefficient) || !mpq_sgn(b->terms[j].coefficient)) continue;
            mpq_mul(product, a->terms[i].coefficient, b->terms[j].coefficient);
            mpq_mul(product, product, factor);
            add_monomial(sum, a->terms[i].powers + b->terms[j].powers, product);
        }
    mpq_clears(product, factor, NULL);
}

/* The sign of the largest product of unknowns that the polynomial has. */
static int sign_of_largest(polynomial *p)
{
    collect_terms(p);
    for (uint32_t i = 0; i < p->count; ++i)
        if (mpq_sgn(p->terms[i].coefficient)) return mpq_sgn(p->terms[i].coefficient);
    return 0;
}

/* ---- sides ---- */

/* The plane from point plane on, and another point. */
static void name_four(const double *const points[8], int plane, int other, const double *p[4])
{
    for (int i = 0; i < 3; ++i) p[i] = points[plane + i];
    p[3] = points[other];
}

/* The polynomial of the plane with a point, as ranks have them. */
static polynomial expand_four(const double *const points[8], const uint32_t ranks[8], int plane,
                              int other)
{
    const double *p[4];
    const uint32_t r[4] = {ranks[plane], ranks[plane + 1], ranks[plane + 2], ranks[other]};
    name_four(points, plane, other, p);
    return expand_rows(p, r);
}

int triple_oracle_side(const double *const points[8], const uint32_t numbers[8])
{
    uint32_t ranks[8];
    polynomial of[2][2], height = {0, NULL}, below = {0, NULL};
    const double unmoved = triple_oracle_height(points);
    int sign;
    size_t room = 2;
    if (unmoved > 0) return 1;
    if (unmoved < 0) return -1;
    for (int i = 0; i < 8; ++i) {
        ranks[i] = 0;
        for (int j = 0; j < 8; ++j) {
            int is_first = 1;
            for (int k = 0; k < j; ++k) is_first &= numbers[k] != numbers[j];
            ranks[i] += is_first && numbers[j] < numbers[i];
        }
    }
    for (int end = 0; end < 2; ++end)
        for (int plane = 0; plane < 2; ++plane) {
            of[end][plane] = expand_four(points, ranks, 2 + 3 * plane, end);
            room += (size_t)of[end][plane].count * of[end][plane].count;
        }
    height.terms = (monomial *)test_allocate(room * sizeof *height.terms);
    below.terms = (monomial *)test_allocate(room * sizeof *below.terms);
    add_product_of(&height, &of[0][0], &of[1][1], 1);
    add_product_of(&height, &of[1][0], &of[0][1], -1);
    for (int end = 0; end < 2; ++end)
        for (uint32_t i = 0; i < of[end][0].count; ++i) {
            monomial *term = &of[end][0].terms[i];
            if (end) mpq_neg(term->coefficient, term->coefficient);
            add_monomial(&below, term->powers, term->coefficient);
        }
    sign = sign_of_largest(&height) * sign_of_largest(&below);
    for (int i = 0; i < 4; ++i) free_polynomial(&of[i / 2][i % 2]);
    free_polynomial(&height);
    free_polynomial(&below);
    return sign;
}

/* ---- numbers ---- */

static void set_point(mpq_t p[3], const double *from)
{
    for (int k = 0; k < 3; ++k) mpq_set_d(p[k], from[k]);
}

static void init_points(mpq_t *numbers, int count)
{
    for (int i = 0; i < count; ++i) mpq_init(numbers[i]);
}

static void clear_points(mpq_t *numbers, int count)
{
    for (int i = 0; i < count; ++i) mpq_clear(numbers[i]);
}

/* The determinant of the differences of three points, of which the first comes first, and a
   fourth. */
static void find_determinant(mpq_t sum, mpq_t a[3], mpq_t b[3], mpq_t c[3], mpq_t d[3])
{
    mpq_t u[3][3], t;
    mpq_init(t);
    mpq_set_si(sum, 0, 1);
    for (int i = 0; i < 3; ++i) {
        init_points(u[i], 3);
        for (int k = 0; k < 3; ++k) mpq_sub(u[i][k], i == 0 ? b[k] : i == 1 ? c[k] : d[k], a[k]);
    }
    for (int i = 0; i < 3; ++i)
        for (int turned = 0; turned < 2; ++turned) {
            mpq_mul(t, u[0][i], u[1][(i + 1 + turned) % 3]);
            mpq_mul(t, t, u[2][(i + 2 - turned) % 3]);
            if (turned) mpq_neg(t, t);
            mpq_add(sum, sum, t);
        }
    for (int i = 0; i < 3; ++i) clear_points(u[i], 3);
    mpq_clear(t);
}

double triple_oracle_height(const double *const points[8])
{
    mpq_t p[8][3], of[2][2], t;
    double height = (double)NAN;
    mpq_init(t);
    for (int i = 0; i < 8; ++i) {
        init_points(p[i], 3);
        set_point(p[i], points[i]);
    }
    for (int i = 0; i < 2; ++i)
        for (int k = 0; k < 2; ++k) {
            mpq_init(of[i][k]);
            find_determinant(of[i][k], p[2 + 3 * k], p[3 + 3 * k], p[4 + 3 * k], p[i]);
        }
    mpq_mul(of[0][1], of[0][1], of[1][0]);
    mpq_mul(of[1][1], of[1][1], of[0][0]);
    mpq_sub(of[1][1], of[1][1], of[0][1]);
    mpq_sub(t, of[0][0], of[1][0]);
    if (mpq_sgn(t)) {
        mpq_div(of[1][1], of[1][1], t);
        height = mpq_get_d(of[1][1]);
    }
    for (int i = 0; i < 8; ++i) clear_points(p[i], 3);
    clear_points(of[0], 4);
    mpq_clear(t);
    return height;
}

/* The normal of a triangle, and its product with a corner. */
static void find_plane(mpq_t plane[4], mpq_t a[3], mpq_t b[3], mpq_t c[3])
{
    mpq_t u[3], v[3], t;
    mpq_init(t);
    init_points(u, 3);
    init_points(v, 3);
    for (int k = 0; k < 3; ++k) {
        mpq_sub(u[k], b[k], a[k]);
        mpq_sub(v[k], c[k], a[k]);
    }
    mpq_set_si(plane[3], 0, 1);
    for (int k = 0; k < 3; ++k) {
        mpq_mul(plane[k], u[(k + 1) % 3], v[(k + 2) % 3]);
        mpq_mul(t, u[(k + 2) % 3], v[(k + 1) % 3]);
        mpq_sub(plane[k], plane[k], t);
        mpq_mul(t, plane[k], a[k]);
        mpq_add(plane[3], plane[3], t);
    }
    clear_points(u, 3);
    clear_points(v, 3);
    mpq_clear(t);
}

/* The determinant of the normals, with those of column in the place of products; -1: none. */
static void find_minor_of(mpq_t sum, mpq_t planes[3][4], int column)
{
    mpq_t p[4][3];
    for (int i = 0; i < 4; ++i) init_points(p[i], 3);
    for (int i = 0; i < 3; ++i)
        for (int k = 0; k < 3; ++k) mpq_set(p[1 + i][k], planes[i][k == column ? 3 : k]);
    find_determinant(sum, p[0], p[1], p[2], p[3]);
    for (int i = 0; i < 4; ++i) clear_points(p[i], 3);
}

/* Whether a point of the plane of a triangle is inside of it: 1 or 0; -1: on a line of an edge. */
static int is_inside(mpq_t corner[3][3], mpq_t plane[4], mpq_t point[3])
{
    mpq_t beside[3], sum;
    int sign[3];
    mpq_init(sum);
    init_points(beside, 3);
    for (int i = 0; i < 3; ++i) {
        for (int k = 0; k < 3; ++k) mpq_add(beside[k], corner[i][k], plane[k]);
        find_determinant(sum, corner[i], corner[(i + 1) % 3], point, beside);
        sign[i] = mpq_sgn(sum);
    }
    mpq_clear(sum);
    clear_points(beside, 3);
    if (!sign[0] || !sign[1] || !sign[2]) return -1;
    return sign[0] == sign[1] && sign[1] == sign[2];
}

int triple_oracle_meet(const double *const points[9])
{
    mpq_t corner[9][3], planes[3][4], point[3], det, t;
    int meet = 1, is_flat = 0;
    mpq_inits(det, t, NULL);
    init_points(point, 3);
    for (int i = 0; i < 9; ++i) {
        init_points(corner[i], 3);
        set_point(corner[i], points[i]);
    }
    for (int i = 0; i < 3; ++i) {
        init_points(planes[i], 4);
        find_plane(planes[i], corner[3 * i], corner[3 * i + 1], corner[3 * i + 2]);
    }
    for (int i = 0; i < 3 && !is_flat; ++i)
        for (int k = 0; k < 9 && !is_flat; ++k) {
            if (k / 3 == i) continue;
            find_determinant(t, corner[3 * i], corner[3 * i + 1], corner[3 * i + 2], corner[k]);
            is_flat = mpq_sgn(t) == 0;
        }
    find_minor_of(det, planes, -1);
    is_flat |= mpq_sgn(det) == 0;
    for (int k = 0; k < 3 && !is_flat; ++k) {
        find_minor_of(point[k], planes, k);
        mpq_div(point[k], point[k], det);
    }
    for (int i = 0; i < 3 && !is_flat && meet == 1; ++i)
        meet = is_inside(&corner[3 * i], planes[i], point);
    for (int i = 0; i < 9; ++i) clear_points(corner[i], 3);
    for (int i = 0; i < 3; ++i) clear_points(planes[i], 4);
    clear_points(point, 3);
    mpq_clears(det, t, NULL);
    return is_flat ? -1 : meet;
}
