/*
 * The oracle of contours. See trace_oracle.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "trace_oracle.h"

#include <float.h>
#include <gmp.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "harness.h"

enum { EXPONENTS = 1 << 12 };

/* A polynomial: coefficients of those powers that have one. Made when first needed, and kept. */
static mpz_t coefficient[EXPONENTS];
static int is_used[EXPONENTS], used[EXPONENTS], used_count;

static mpz_t *coefficient_of(int exponent)
{
    if (!is_used[exponent]) {
        is_used[exponent] = 1;
        used[used_count++] = exponent;
        mpz_init(coefficient[exponent]);
    }
    return &coefficient[exponent];
}

/* The coordinates of four points, and 1 before those of each: as multiples of the same power of
   two, but for the ones. So all products of a coefficient are multiples of the same power. The
   numbers, and one for products, are made when first needed, and kept. */
static mpz_t rows[4][4], product;

static void make_rows(const double *const points[4])
{
    static int is_made;
    int least = INT_MAX;
    if (!is_made) {
        for (int i = 0; i < 16; ++i) mpz_init_set_si(rows[i / 4][i % 4], 1);
        mpz_init(product);
        is_made = 1;
    }
    for (int i = 0; i < 12; ++i) {
        int exponent;
        if (frexp(points[i / 3][i % 3], &exponent) != 0 && exponent < least) least = exponent;
    }
    for (int i = 0; i < 12; ++i) {
        mpz_t *row = &rows[i / 3][1 + i % 3];
        int exponent;
        const double part = frexp(points[i / 3][i % 3], &exponent);
        mpz_set_d(*row, ldexp(part, DBL_MANT_DIG));
        if (part != 0) mpz_mul_2exp(*row, *row, (unsigned)(exponent - least));
    }
}

/* The rank of each point among the four: exponents of higher powers, in the same order. */
static void rank_points(const uint32_t numbers[4], int rank[4])
{
    for (int i = 0; i < 4; ++i) {
        rank[i] = 0;
        for (int j = 0; j < 4; ++j) rank[i] += numbers[j] < numbers[i];
    }
}

/* Adds the product of a permutation: of each chosen row its power, of the others the coordinate. */
static void add_product(const int rank[4], const int column[4], int sign, int chosen)
{
    int exponent = 0;
    for (int row = 0; row < 4; ++row)
        if (chosen >> row & 1) {
            if (!column[row]) return; /* ones have not moved */
            exponent |= 1 << (3 * rank[row] + column[row] - 1);
        }
    mpz_set_si(product, sign);
    for (int row = 0; row < 4; ++row)
        if (!(chosen >> row & 1)) mpz_mul(product, product, rows[row][column[row]]);
    mpz_add(*coefficient_of(exponent), *coefficient_of(exponent), product);
}

static int sign_of_permutation(const int column[4])
{
    int inversions = 0;
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < i; ++j) inversions += column[j] > column[i];
    return inversions % 2 ? -1 : 1;
}

enum { PERMUTATIONS = 24 };

/* All permutations of four columns. Made when first needed, and kept. */
static const int (*all_permutations(void))[4]
{
    static int columns[PERMUTATIONS][4];
    int count = 0;
    if (columns[0][0] != 0) return (const int(*)[4])columns;
    for (int code = 0; code < 256; ++code) {
        int seen = 0;
        for (int i = 0; i < 4; ++i) seen |= 1 << (code >> 2 * i & 3);
        if (seen != 15) continue;
        for (int i = 0; i < 4; ++i) columns[count][i] = code >> 2 * i & 3;
        ++count;
    }
    return (const int(*)[4])columns;
}

/* The determinant of the differences of three points from the first. */
static void find_volume(mpq_t sum, const double *p, const double *a, const double *b,
                        const double *c)
{
    const double *to[3] = {a, b, c};
    mpq_t u[3][3], t;
    mpq_init(t);
    mpq_set_si(sum, 0, 1);
    for (int i = 0; i < 9; ++i) {
        mpq_init(u[i / 3][i % 3]);
        mpq_set_d(u[i / 3][i % 3], to[i / 3][i % 3]);
        mpq_set_d(t, p[i % 3]);
        mpq_sub(u[i / 3][i % 3], u[i / 3][i % 3], t);
    }
    for (int i = 0; i < 3; ++i)
        for (int turned = 0; turned < 2; ++turned) {
            const int j = (i + 1 + turned) % 3, k = (i + 2 - turned) % 3;
            mpq_mul(t, u[0][i], u[1][j]);
            mpq_mul(t, t, u[2][k]);
            if (turned) mpq_neg(t, t);
            mpq_add(sum, sum, t);
        }
    for (int i = 0; i < 9; ++i) mpq_clear(u[i / 3][i % 3]);
    mpq_clear(t);
}

/* Whether a number is off by no more than 2^-bits of a size, or 2^-1070. */
static int is_close(double number, const mpq_t truth, const mpq_t size, unsigned bits)
{
    mpq_t off, most;
    int close;
    mpq_inits(off, most, NULL);
    mpq_set_d(off, number);
    mpq_sub(off, off, truth);
    mpq_abs(off, off);
    mpq_abs(most, size);
    mpq_div_2exp(most, most, bits);
    close = mpq_cmp(off, most) <= 0;
    mpq_set_d(most, 0x1p-1070);
    close |= mpq_cmp(off, most) <= 0;
    mpq_clears(off, most, NULL);
    return close;
}

/* The largest absolute value of a coordinate of the five. */
static void find_size(mpq_t size, const double *const points[5], int k)
{
    double largest = 0;
    for (int i = 0; i < 5; ++i)
        if (largest < (points[i][k] < 0 ? -points[i][k] : points[i][k]))
            largest = points[i][k] < 0 ? -points[i][k] : points[i][k];
    mpq_set_d(size, largest);
}

/* The sum of positions times weights. */
static void find_mean(mpq_t mean, const double *const *points, const mpq_t *weights, int count,
                      int k)
{
    mpq_t t;
    mpq_init(t);
    mpq_set_si(mean, 0, 1);
    for (int i = 0; i < count; ++i) {
        mpq_set_d(t, points[i][k]);
        mpq_mul(t, t, weights[i]);
        mpq_add(mean, mean, t);
    }
    mpq_clear(t);
}

/* Whether the points of both that have the weights are the point. */
static int has_weights(const double *const points[5], double along, const double weights[3],
                       const double point[3])
{
    mpq_t w[5], mean, size;
    int has = along >= 0 && along <= 1;
    mpq_inits(mean, size, NULL);
    for (int i = 0; i < 5; ++i) {
        mpq_init(w[i]);
        mpq_set_d(w[i], i < 2 ? along : weights[i - 2]);
        has &= mpq_sgn(w[i]) >= 0;
    }
    mpq_set_si(mean, 1, 1);
    mpq_sub(w[0], mean, w[0]);
    for (int k = 0; k < 3 && has; ++k) {
        find_size(size, points, k);
        find_mean(mean, points, (const mpq_t *)w, 2, k);
        has = is_close(point[k], mean, size, 46);
        find_mean(mean, points + 2, (const mpq_t *)(w + 2), 3, k);
        has = has && is_close(point[k], mean, size, 46);
    }
    for (int i = 0; i < 5; ++i) mpq_clear(w[i]);
    mpq_clears(mean, size, NULL);
    return has;
}

int trace_oracle_is_placed(const double *const points[5], double along, const double weights[3],
                           const double point[3])
{
    const double *const *p = points;
    mpq_t w[5], sum, size; /* w[0], w[1]: of the ends */
    int placed = 1, is_flat;
    mpq_inits(sum, size, NULL);
    for (int i = 0; i < 5; ++i) mpq_init(w[i]);
    find_volume(w[1], p[0], p[2], p[3], p[4]);
    for (int k = 0; k < 3; ++k) {
        find_volume(w[2 + k], p[0], p[1], p[2 + (k + 1) % 3], p[2 + (k + 2) % 3]);
        mpq_add(sum, sum, w[2 + k]);
    }
    is_flat = mpq_sgn(sum) == 0;
    if (!is_flat) {
        for (int i = 1; i < 5; ++i) mpq_div(w[i], w[i], sum);
        mpq_set_si(w[0], 1, 1);
        mpq_sub(w[0], w[0], w[1]);
        placed = is_close(along, w[1], w[1], 49);
        for (int k = 0; k < 3; ++k) placed &= is_close(weights[k], w[2 + k], w[2 + k], 49);
        for (int k = 0; k < 3 && placed; ++k) {
            find_mean(sum, p, (const mpq_t *)w, 2, k);
            find_size(size, p, k);
            placed = is_close(point[k], sum, size, 49);
        }
    }
    for (int i = 0; i < 5; ++i) mpq_clear(w[i]);
    mpq_clears(sum, size, NULL);
    return is_flat ? has_weights(points, along, weights, point) : placed;
}

/* Adds the products of all permutations in which these rows are chosen. */
static void add_products(const int rank[4], int chosen)
{
    const int(*columns)[4] = all_permutations();
    for (int i = 0; i < PERMUTATIONS; ++i)
        add_product(rank, columns[i], sign_of_permutation(columns[i]), chosen);
}

int trace_oracle_sign(const double *const points[4], const uint32_t numbers[4])
{
    int rank[4], sign;
    for (int i = 0; i < used_count; ++i) mpz_set_si(coefficient[used[i]], 0);
    rank_points(numbers, rank);
    make_rows(points);
    add_products(rank, 0);
    sign = mpz_sgn(*coefficient_of(0));
    for (int chosen = 1; chosen < 16 && !sign; ++chosen) add_products(rank, chosen);
    for (int i = 1; i < EXPONENTS && !sign; ++i)
        if (is_used[i]) sign = mpz_sgn(coefficient[i]);
    return sign;
}

int trace_oracle_crosses(const double *const points[5], const uint32_t numbers[5])
{
    int side[2], turn = 0;
    for (int end = 0; end < 2; ++end) {
        const double *const p[4] = {points[2], points[3], points[4], points[end]};
        const uint32_t n[4] = {numbers[2], numbers[3], numbers[4], numbers[end]};
        side[end] = trace_oracle_sign(p, n);
    }
    if (side[0] == side[1]) return 0;
    for (int k = 0; k < 3; ++k) {
        const int i = 2 + k, j = 2 + (k + 1) % 3;
        const double *const p[4] = {points[0], points[1], points[i], points[j]};
        const uint32_t n[4] = {numbers[0], numbers[1], numbers[i], numbers[j]};
        const int sign = trace_oracle_sign(p, n);
        if (k == 0) turn = sign;
        if (sign != turn) return 0;
    }
    return 1;
}

static int is_collapsed(const uint32_t *t)
{
    return t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
}

static int has_corner(const uint32_t *t, uint32_t v)
{
    return t[0] == v || t[1] == v || t[2] == v;
}

/* A side of a triangle: its ends, the lower number first, and its name, 3 t + k. */
typedef struct side {
    uint32_t low, high, name;
} side;

static int compare_sides(const void *a, const void *b)
{
    const side *p = (const side *)a, *q = (const side *)b;
    if (p->low != q->low) return p->low < q->low ? -1 : 1;
    if (p->high != q->high) return p->high < q->high ? -1 : 1;
    return (p->name > q->name) - (p->name < q->name);
}

static int compare_edges(const void *a, const void *b)
{
    const trace_oracle_edge *p = (const trace_oracle_edge *)a, *q = (const trace_oracle_edge *)b;
    return (p->name > q->name) - (p->name < q->name);
}

/* Makes an edge of each run of sides with the same ends; the first of them names it. */
static void find_edges(trace_oracle_answer *a, const uint32_t *triangles, uint32_t triangle_count)
{
    side *sides = (side *)test_allocate(3 * (size_t)triangle_count * sizeof *sides);
    trace_oracle_edge *edge = NULL;
    uint32_t count = 0;
    a->edges = (trace_oracle_edge *)test_allocate(3 * (size_t)triangle_count * sizeof *a->edges);
    for (uint32_t name = 0; name < 3 * triangle_count; ++name) {
        const uint32_t u = triangles[name], v = triangles[name % 3 == 2 ? name - 2 : name + 1];
        if (u == v) continue;
        sides[count].low = u < v ? u : v;
        sides[count].high = u < v ? v : u;
        sides[count++].name = name;
    }
    qsort(sides, count, sizeof *sides, compare_sides);
    for (uint32_t i = 0; i < count; ++i) {
        const uint32_t name = sides[i].name, t = name / 3, k = name % 3;
        const uint32_t *corner = triangles + 3 * (size_t)t;
        if (i == 0 || sides[i].low != sides[i - 1].low || sides[i].high != sides[i - 1].high) {
            edge = &a->edges[a->edge_count++];
            memset(edge, 0, sizeof *edge);
            edge->name = name;
            edge->ends[0] = corner[k];
            edge->ends[1] = corner[(k + 1) % 3];
        }
        if (is_collapsed(corner)) continue;
        edge->triangles =
            (uint32_t *)realloc(edge->triangles, (edge->count + 1) * sizeof *edge->triangles);
        if (!edge->triangles) abort();
        edge->triangles[edge->count++] = t;
    }
    free(sides);
    qsort(a->edges, a->edge_count, sizeof *a->edges, compare_edges);
}

/* Whether the boxes of two lists of points have a common point: else nothing crosses. */
static int boxes_meet(const double *const *p, int count, const double *const *q, int other)
{
    for (int k = 0; k < 3; ++k) {
        double low = p[0][k], high = p[0][k], other_low = q[0][k], other_high = q[0][k];
        for (int i = 1; i < count; ++i) {
            if (p[i][k] < low) low = p[i][k];
            if (p[i][k] > high) high = p[i][k];
        }
        for (int i = 1; i < other; ++i) {
            if (q[i][k] < other_low) other_low = q[i][k];
            if (q[i][k] > other_high) other_high = q[i][k];
        }
        if (low > other_high || other_low > high) return 0;
    }
    return 1;
}

/* A triangle from its lowest to its highest x, and the highest of all until here. */
typedef struct stretch {
    double low, high, highest;
    uint32_t triangle;
} stretch;

static int compare_stretches(const void *a, const void *b)
{
    const stretch *p = (const stretch *)a, *q = (const stretch *)b;
    if (p->low != q->low) return p->low < q->low ? -1 : 1;
    return (p->triangle > q->triangle) - (p->triangle < q->triangle);
}

/* All triangles that have three corners, in the order of their lowest x. */
static stretch *sort_triangles(const uint32_t *triangles, uint32_t triangle_count,
                               const double *positions, uint32_t *count)
{
    stretch *list = (stretch *)test_allocate(triangle_count * sizeof *list);
    *count = 0;
    for (uint32_t t = 0; t < triangle_count; ++t) {
        const uint32_t *corner = triangles + 3 * (size_t)t;
        stretch *s = &list[*count];
        if (is_collapsed(corner)) continue;
        s->triangle = t;
        s->low = s->high = positions[3 * (size_t)corner[0]];
        for (int i = 1; i < 3; ++i) {
            const double x = positions[3 * (size_t)corner[i]];
            if (s->low > x) s->low = x;
            if (s->high < x) s->high = x;
        }
        ++*count;
    }
    qsort(list, *count, sizeof *list, compare_stretches);
    for (uint32_t i = 0; i < *count; ++i) {
        list[i].highest = list[i].high;
        if (i && list[i - 1].highest > list[i].highest) list[i].highest = list[i - 1].highest;
    }
    return list;
}

/* The first of the list that may reach to x. */
static uint32_t find_first(const stretch *list, uint32_t count, double x)
{
    uint32_t low = 0, high = count;
    while (low < high) {
        const uint32_t middle = (low + high) / 2;
        if (list[middle].highest < x)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

static int compare_crossings(const void *a, const void *b)
{
    const trace_oracle_crossing *p = (const trace_oracle_crossing *)a;
    const trace_oracle_crossing *q = (const trace_oracle_crossing *)b;
    if (p->edge != q->edge) return p->edge < q->edge ? -1 : 1;
    return (p->triangle > q->triangle) - (p->triangle < q->triangle);
}

static void add_crossing(trace_oracle_answer *a, uint32_t *capacity, uint32_t edge, uint32_t t)
{
    if (a->crossing_count == *capacity) {
        *capacity = 2 * *capacity + 16;
        a->crossings =
            (trace_oracle_crossing *)realloc(a->crossings, *capacity * sizeof *a->crossings);
        if (!a->crossings) abort();
    }
    a->crossings[a->crossing_count].edge = edge;
    a->crossings[a->crossing_count++].triangle = t;
}

trace_oracle_answer trace_oracle_find(const uint32_t *triangles, uint32_t triangle_count,
                                      const double *positions)
{
    trace_oracle_answer a = {0, 0, NULL, NULL};
    uint32_t capacity = 0, count;
    stretch *list = sort_triangles(triangles, triangle_count, positions, &count);
    find_edges(&a, triangles, triangle_count);
    for (uint32_t e = 0; e < a.edge_count; ++e) {
        const uint32_t *ends = a.edges[e].ends;
        const double x = positions[3 * (size_t)ends[0]], other = positions[3 * (size_t)ends[1]];
        const double low = x < other ? x : other, high = x < other ? other : x;
        for (uint32_t i = find_first(list, count, low); i < count && list[i].low <= high; ++i) {
            const uint32_t *corner = triangles + 3 * (size_t)list[i].triangle;
            const uint32_t numbers[5] = {ends[0], ends[1], corner[0], corner[1], corner[2]};
            const double *p[5];
            for (int k = 0; k < 5; ++k) p[k] = positions + 3 * (size_t)numbers[k];
            if (has_corner(corner, ends[0]) || has_corner(corner, ends[1])) continue;
            if (boxes_meet(p, 2, p + 2, 3) && trace_oracle_crosses(p, numbers))
                add_crossing(&a, &capacity, e, list[i].triangle);
        }
    }
    free(list);
    if (a.crossing_count)
        qsort(a.crossings, a.crossing_count, sizeof *a.crossings, compare_crossings);
    return a;
}

void trace_oracle_free(trace_oracle_answer *answer)
{
    for (uint32_t e = 0; e < answer->edge_count; ++e) free(answer->edges[e].triangles);
    free(answer->edges);
    free(answer->crossings);
}
