/*
 * The oracle: see oracle.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "oracle.h"

#include <gmp.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "harness.h"

enum {
    ROWS = 5,           /* x, y, z, and that the weights of each hull add up to 1 */
    OBJECTIVE = ROWS,   /* one more row: minus the sum of the others */
    MAXIMUM_COLUMNS = 6 /* a weight for each point of both hulls */
};

typedef struct solver {
    mpz_t *points;                              /* 3 for each vertex */
    mpz_t table[ROWS + 1][MAXIMUM_COLUMNS + 1]; /* the last column used is the right-hand side */
    mpz_t denominator;                          /* of the whole table */
    mpz_t product;
    mpz_t vectors[6][3]; /* scratch of folds_onto */
    uint32_t columns;    /* without the right-hand side */
} solver;

static void start_solver(solver *s)
{
    s->points = NULL;
    mpz_inits(s->denominator, s->product, NULL);
    for (int i = 0; i <= ROWS; ++i) {
        for (int j = 0; j <= MAXIMUM_COLUMNS; ++j) mpz_init(s->table[i][j]);
    }
    for (int i = 0; i < 6; ++i)
        mpz_inits(s->vectors[i][0], s->vectors[i][1], s->vectors[i][2], NULL);
}

static void stop_solver(solver *s, uint32_t vertex_count)
{
    for (size_t i = 0; i < 3 * (size_t)vertex_count; ++i) mpz_clear(s->points[i]);
    free(s->points);
    mpz_clears(s->denominator, s->product, NULL);
    for (int i = 0; i <= ROWS; ++i) {
        for (int j = 0; j <= MAXIMUM_COLUMNS; ++j) mpz_clear(s->table[i][j]);
    }
    for (int i = 0; i < 6; ++i)
        mpz_clears(s->vectors[i][0], s->vectors[i][1], s->vectors[i][2], NULL);
}

/* A finite double as mantissa * 2^exponent with an integer mantissa; 0 gives exponent 0. */
static int64_t split_double(double value, int *exponent)
{
    double mantissa = frexp(value, exponent);
    if (!(mantissa != 0)) {
        *exponent = 0;
        return 0;
    }
    *exponent -= 53;
    return (int64_t)ldexp(mantissa, 53);
}

/* Sets s->points to the positions times a power of two that makes them all integers. */
static void read_points(solver *s, const double *positions, uint32_t vertex_count,
                        const uint8_t *used)
{
    int least = 2000, exponent;
    size_t count = 3 * (size_t)vertex_count;
    s->points = (mpz_t *)test_allocate(count * sizeof(mpz_t));
    for (size_t i = 0; i < count; ++i) {
        if (!used[i / 3] || split_double(positions[i], &exponent) == 0) continue;
        if (exponent < least) least = exponent;
    }
    for (size_t i = 0; i < count; ++i) {
        int64_t mantissa;
        mpz_init(s->points[i]);
        if (!used[i / 3]) continue;
        mantissa = split_double(positions[i], &exponent);
        if (mantissa == 0) continue;
        mpz_set_si(s->points[i], (long)(mantissa / INT64_C(0x40000000)));
        mpz_mul_2exp(s->points[i], s->points[i], 30);
        mantissa %= INT64_C(0x40000000);
        if (mantissa >= 0) {
            mpz_add_ui(s->points[i], s->points[i], (unsigned long)mantissa);
        } else {
            mpz_sub_ui(s->points[i], s->points[i], (unsigned long)-mantissa);
        }
        mpz_mul_2exp(s->points[i], s->points[i], (mp_bitcnt_t)(exponent - least));
    }
}

/*
 * Writes down the equations of a common point of two hulls: sum l_i p_i = sum m_j q_j, sum l_i = 1,
 * sum m_j = 1, with the first q as the origin.
 */
static void write_equations(solver *s, const uint32_t *p, uint32_t p_count, const uint32_t *q,
                            uint32_t q_count)
{
    s->columns = p_count + q_count;
    mpz_set_ui(s->denominator, 1);
    for (uint32_t j = 0; j <= s->columns; ++j) {
        for (int i = 0; i < ROWS; ++i) mpz_set_ui(s->table[i][j], 0);
        if (j == s->columns) {
            mpz_set_ui(s->table[3][j], 1);
            mpz_set_ui(s->table[4][j], 1);
        } else if (j < p_count) {
            for (int i = 0; i < 3; ++i)
                mpz_sub(s->table[i][j], s->points[3 * p[j] + (uint32_t)i],
                        s->points[3 * q[0] + (uint32_t)i]);
            mpz_set_ui(s->table[3][j], 1);
        } else {
            for (int i = 0; i < 3; ++i)
                mpz_sub(s->table[i][j], s->points[3 * q[0] + (uint32_t)i],
                        s->points[3 * q[j - p_count] + (uint32_t)i]);
            mpz_set_ui(s->table[4][j], 1);
        }
        mpz_set_ui(s->table[OBJECTIVE][j], 0);
        for (int i = 0; i < ROWS; ++i)
            mpz_sub(s->table[OBJECTIVE][j], s->table[OBJECTIVE][j], s->table[i][j]);
    }
}

/* Solves row for column and eliminates the column elsewhere. All entries stay integers
   (Bareiss). */
static void pivot(solver *s, uint32_t row, uint32_t column)
{
    for (uint32_t i = 0; i <= ROWS; ++i) {
        if (i == row) continue;
        for (uint32_t j = 0; j <= s->columns; ++j) {
            mpz_ptr entry = s->table[i][j];
            int is_plain = mpz_sgn(s->table[i][column]) == 0 || mpz_sgn(s->table[row][j]) == 0;
            if (j == column || (is_plain && mpz_sgn(entry) == 0)) continue;
            mpz_mul(entry, entry, s->table[row][column]);
            if (!is_plain) mpz_submul(entry, s->table[i][column], s->table[row][j]);
            if (mpz_cmp_ui(s->denominator, 1) != 0) mpz_divexact(entry, entry, s->denominator);
        }
        mpz_set_ui(s->table[i][column], 0);
    }
    mpz_set(s->denominator, s->table[row][column]);
}

/* The sign of the difference of rows a and b in right-hand side over entry in column, which is >
   0. */
static int compare_ratios(solver *s, uint32_t a, uint32_t b, uint32_t column)
{
    mpz_mul(s->product, s->table[a][s->columns], s->table[b][column]);
    mpz_submul(s->product, s->table[b][s->columns], s->table[a][column]);
    return mpz_sgn(s->product);
}

/*
 * Whether the hulls of two lists of vertices have a common point: phase one of the simplex method.
 * It starts from an artificial variable in each row, which never comes back once it has left, and
 * the objective row tells how much of the artificial variables is left.
 */
static int hulls_meet(solver *s, const uint32_t *p, uint32_t p_count, const uint32_t *q,
                      uint32_t q_count)
{
    uint32_t basis[ROWS];
    if (p_count == 0 || q_count == 0) return 0;
    write_equations(s, p, p_count, q, q_count);
    for (uint32_t i = 0; i < ROWS; ++i) basis[i] = s->columns + i;
    for (;;) {
        uint32_t column = 0, row = ROWS;
        if (mpz_sgn(s->table[OBJECTIVE][s->columns]) == 0) return 1;
        while (column < s->columns && mpz_sgn(s->table[OBJECTIVE][column]) >= 0) ++column;
        if (column == s->columns) return 0;
        for (uint32_t i = 0; i < ROWS; ++i) {
            int order;
            if (mpz_sgn(s->table[i][column]) <= 0) continue;
            order = row == ROWS ? -1 : compare_ratios(s, i, row, column);
            if (order < 0 || (order == 0 && basis[i] < basis[row])) row = i;
        }
        pivot(s, row, column); /* there is a row: the objective is bounded */
        basis[row] = column;
    }
}

/* Whether the equations of edge and triangle have one solution and all five weights are
   positive. */
static int crosses_properly(solver *s, const uint32_t edge[2], const uint32_t triangle[3])
{
    uint32_t row_of[MAXIMUM_COLUMNS];
    unsigned taken = 0;
    write_equations(s, edge, 2, triangle, 3);
    for (uint32_t column = 0; column < s->columns; ++column) {
        uint32_t row = 0;
        while (row < ROWS && ((taken >> row & 1) != 0 || mpz_sgn(s->table[row][column]) == 0))
            ++row;
        if (row == ROWS) return 0;
        pivot(s, row, column);
        taken |= 1u << row;
        row_of[column] = row;
    }
    for (uint32_t column = 0; column < s->columns; ++column) {
        if (mpz_sgn(s->table[row_of[column]][s->columns]) * mpz_sgn(s->denominator) <= 0) return 0;
    }
    return 1;
}

static void cross(solver *s, mpz_t *product, mpz_t *u, mpz_t *v)
{
    for (int i = 0; i < 3; ++i) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        mpz_mul(product[i], u[j], v[k]);
        mpz_mul(s->product, u[k], v[j]);
        mpz_sub(product[i], product[i], s->product);
    }
}

static int is_zero(mpz_t *v)
{
    return mpz_sgn(v[0]) == 0 && mpz_sgn(v[1]) == 0 && mpz_sgn(v[2]) == 0;
}

/* Leaves u . v in s->product. */
static void dot(solver *s, mpz_t *u, mpz_t *v)
{
    mpz_mul(s->product, u[0], v[0]);
    mpz_addmul(s->product, u[1], v[1]);
    mpz_addmul(s->product, u[2], v[2]);
}

/* Whether v is u times a positive number; neither is zero. */
static int same_direction(solver *s, mpz_t *u, mpz_t *v, mpz_t *scratch)
{
    cross(s, scratch, u, v);
    dot(s, u, v);
    return is_zero(scratch) && mpz_sgn(s->product) > 0;
}

/*
 * Whether the triangles (s0, s1, p) and (s0, s1, q) have a common point off the segment s0 s1. With
 * s0 as the origin and d = s1 - s0:
 *   d = 0: p and q must lie on the same ray from it.
 *   p and q off the line of d: they must lie in the same half-plane of it, that is, d x q must be a
 *   positive multiple of d x p; near the middle of d both triangles then cover that half-plane.
 *   p and q on the line: both beyond the same end of d.
 *   one on the line, one off: the second triangle has nothing on the line but d.
 */
static int folds_onto(solver *s, uint32_t s0, uint32_t s1, uint32_t p, uint32_t q)
{
    mpz_t *d = s->vectors[0], *u = s->vectors[1], *v = s->vectors[2];
    mpz_t *m = s->vectors[3], *n = s->vectors[4], *scratch = s->vectors[5];
    int before[2], beyond[2];
    for (uint32_t i = 0; i < 3; ++i) {
        mpz_sub(d[i], s->points[3 * s1 + i], s->points[3 * s0 + i]);
        mpz_sub(u[i], s->points[3 * p + i], s->points[3 * s0 + i]);
        mpz_sub(v[i], s->points[3 * q + i], s->points[3 * s0 + i]);
    }
    if (is_zero(d)) return !is_zero(u) && !is_zero(v) && same_direction(s, u, v, scratch);
    cross(s, m, d, u);
    cross(s, n, d, v);
    if (is_zero(m) != is_zero(n)) return 0;
    if (!is_zero(m)) return same_direction(s, m, n, scratch);
    for (int i = 0; i < 2; ++i) {
        dot(s, d, i == 0 ? u : v);
        before[i] = mpz_sgn(s->product) < 0;
        mpz_set(scratch[0], s->product);
        dot(s, d, d);
        beyond[i] = mpz_cmp(scratch[0], s->product) > 0;
    }
    return (before[0] && before[1]) || (beyond[0] && beyond[1]);
}

/* The distinct members of three vertices that are not in shared. */
static uint32_t others(const uint32_t v[3], const uint32_t *shared, uint32_t shared_count,
                       uint32_t *list)
{
    uint32_t count = 0;
    for (uint32_t k = 0; k < 3; ++k) {
        uint32_t i = 0;
        while (i < shared_count && shared[i] != v[k]) ++i;
        if (i < shared_count) continue;
        i = 0;
        while (i < count && list[i] != v[k]) ++i;
        if (i == count) list[count++] = v[k];
    }
    return count;
}

static int has(const uint32_t v[3], uint32_t vertex)
{
    return v[0] == vertex || v[1] == vertex || v[2] == vertex;
}

static int triangles_touch(solver *s, const uint32_t a[3], const uint32_t b[3])
{
    uint32_t shared[3], rest_a[3], rest_b[3], count_a, count_b, shared_count = 0;
    uint32_t all[3];
    uint32_t all_count = others(a, NULL, 0, all);
    for (uint32_t i = 0; i < all_count; ++i) {
        if (has(b, all[i])) shared[shared_count++] = all[i];
    }
    count_a = others(a, shared, shared_count, rest_a);
    count_b = others(b, shared, shared_count, rest_b);
    switch (shared_count) {
    case 0:
        return hulls_meet(s, a, 3, b, 3);
    case 1:
        return hulls_meet(s, rest_a, count_a, b, 3) || hulls_meet(s, rest_b, count_b, a, 3);
    case 2:
        return count_a == 1 && count_b == 1 &&
               folds_onto(s, shared[0], shared[1], rest_a[0], rest_b[0]);
    default:
        return 1;
    }
}

/* The edge from vertex k to k + 1 of triangle a; 0 if it is none or shares a vertex with b. */
static int free_edge(const uint32_t a[3], uint32_t k, const uint32_t b[3], uint32_t edge[2])
{
    edge[0] = a[k];
    edge[1] = a[(k + 1) % 3];
    return edge[0] != edge[1] && !has(b, edge[0]) && !has(b, edge[1]);
}

typedef struct box {
    double low[3], high[3];
    uint32_t triangle;
} box;

static int boxes_meet(const box *a, const box *b)
{
    for (int i = 0; i < 3; ++i) {
        if (a->high[i] < b->low[i] || b->high[i] < a->low[i]) return 0;
    }
    return 1;
}

static int compare_boxes(const void *left, const void *right)
{
    const box *a = (const box *)left, *b = (const box *)right;
    return a->low[0] < b->low[0] ? -1 : a->low[0] > b->low[0];
}

static int compare_pairs(const void *left, const void *right)
{
    const sc_pair *x = (const sc_pair *)left, *y = (const sc_pair *)right;
    if (x->a != y->a) return x->a < y->a ? -1 : 1;
    return x->b < y->b ? -1 : x->b > y->b;
}

static void add_pair(oracle_list *list, uint32_t a, uint32_t b)
{
    if (list->count == list->capacity) {
        uint64_t capacity = 2 * list->capacity + 16;
        sc_pair *pairs = (sc_pair *)test_allocate(capacity * sizeof(sc_pair));
        if (list->count != 0) memcpy(pairs, list->pairs, list->count * sizeof(sc_pair));
        free(list->pairs);
        list->pairs = pairs;
        list->capacity = capacity;
    }
    list->pairs[list->count].a = a;
    list->pairs[list->count].b = b;
    ++list->count;
}

typedef struct side {
    uint32_t low, high; /* vertices */
    uint32_t corner;    /* 3 t + k */
} side;

static int compare_sides(const void *left, const void *right)
{
    const side *a = (const side *)left, *b = (const side *)right;
    if (a->low != b->low) return a->low < b->low ? -1 : 1;
    if (a->high != b->high) return a->high < b->high ? -1 : 1;
    return a->corner < b->corner ? -1 : a->corner > b->corner;
}

/* owners[3 t + k] = the corner that names the edge of that corner. */
static uint32_t *name_edges(const uint32_t *corners, uint32_t triangle_count)
{
    uint32_t corner_count = 3 * triangle_count, first = 0;
    side *sides = (side *)test_allocate(corner_count * sizeof(side));
    uint32_t *owners = (uint32_t *)test_allocate(corner_count * sizeof(uint32_t));
    for (uint32_t c = 0; c < corner_count; ++c) {
        uint32_t from = corners[c], to = corners[c - c % 3 + (c + 1) % 3];
        sides[c].low = from < to ? from : to;
        sides[c].high = from < to ? to : from;
        sides[c].corner = c;
    }
    qsort(sides, corner_count, sizeof(side), compare_sides);
    for (uint32_t i = 0; i < corner_count; ++i) {
        if (sides[i].low != sides[first].low || sides[i].high != sides[first].high) first = i;
        owners[sides[i].corner] = sides[first].corner;
    }
    free(sides);
    return owners;
}

/* Whether the box of an edge is apart from another box. */
static int is_outside(const double *positions, const uint32_t edge[2], const box *b)
{
    for (size_t i = 0; i < 3; ++i) {
        double x = positions[3 * (size_t)edge[0] + i], y = positions[3 * (size_t)edge[1] + i];
        if ((x < b->low[i] && y < b->low[i]) || (x > b->high[i] && y > b->high[i])) return 1;
    }
    return 0;
}

/*
 * Adds what the ordered pair (a, b) has of edges of a that meet b, whose box is given; each edge
 * once, by its owner. Returns whether one crosses properly.
 */
static int add_edges(solver *s, const double *positions, const uint32_t *corners,
                     const uint32_t *owners, uint32_t a, uint32_t b, const box *box_of_b,
                     oracle_answer *answer)
{
    const uint32_t *triangle = corners + 3 * b;
    uint32_t edge[2];
    int proper = 0;
    for (uint32_t k = 0; k < 3; ++k) {
        uint32_t corner = 3 * a + k;
        int crosses;
        if (!free_edge(corners + 3 * a, k, triangle, edge)) continue;
        if (is_outside(positions, edge, box_of_b) || !hulls_meet(s, edge, 2, triangle, 3)) continue;
        crosses = crosses_properly(s, edge, triangle);
        proper |= crosses;
        if (owners[corner] != corner) continue;
        add_pair(&answer->lists[SC_PAIRS_EDGE][SC_CONTACT_TOUCHING], corner, b);
        if (crosses) add_pair(&answer->lists[SC_PAIRS_EDGE][SC_CONTACT_PROPER], corner, b);
    }
    return proper;
}

void oracle_solve(const double *positions, uint32_t vertex_count, const uint32_t *triangles,
                  uint32_t triangle_count, const uint32_t *weld, oracle_answer *answer)
{
    uint32_t corner_count = 3 * triangle_count;
    uint32_t *corners = (uint32_t *)test_allocate(corner_count * sizeof(uint32_t));
    uint8_t *used = (uint8_t *)test_allocate(vertex_count);
    box *boxes = (box *)test_allocate(triangle_count * sizeof(box));
    uint32_t *owners;
    solver s;

    memset(answer, 0, sizeof(*answer));
    memset(used, 0, vertex_count);
    for (uint32_t c = 0; c < corner_count; ++c) {
        corners[c] = weld == NULL ? triangles[c] : weld[triangles[c]];
        used[corners[c]] = 1;
    }
    start_solver(&s);
    read_points(&s, positions, vertex_count, used);
    owners = name_edges(corners, triangle_count);

    for (uint32_t t = 0; t < triangle_count; ++t) {
        for (int i = 0; i < 3; ++i) {
            double first = positions[3 * (size_t)corners[3 * t] + (size_t)i];
            boxes[t].low[i] = boxes[t].high[i] = first;
            for (uint32_t k = 1; k < 3; ++k) {
                double x = positions[3 * (size_t)corners[3 * t + k] + (size_t)i];
                if (x < boxes[t].low[i]) boxes[t].low[i] = x;
                if (x > boxes[t].high[i]) boxes[t].high[i] = x;
            }
        }
        boxes[t].triangle = t;
    }
    qsort(boxes, triangle_count, sizeof(box), compare_boxes);

    for (uint32_t i = 0; i < triangle_count; ++i) {
        for (uint32_t j = i + 1; j < triangle_count && boxes[j].low[0] <= boxes[i].high[0]; ++j) {
            const box *low = boxes[i].triangle < boxes[j].triangle ? &boxes[i] : &boxes[j];
            const box *high = low == &boxes[i] ? &boxes[j] : &boxes[i];
            uint32_t a = low->triangle, b = high->triangle;
            int proper;
            if (!boxes_meet(low, high)) continue;
            /* An edge that meets the other triangle makes a pair of them: it is a part of its own
               if they share no vertex, and the opposite edge if one; if more, none is free. */
            if (!triangles_touch(&s, corners + 3 * a, corners + 3 * b)) continue;
            add_pair(&answer->lists[SC_PAIRS_TRIANGLE][SC_CONTACT_TOUCHING], a, b);
            proper = add_edges(&s, positions, corners, owners, a, b, high, answer);
            proper |= add_edges(&s, positions, corners, owners, b, a, low, answer);
            if (proper) add_pair(&answer->lists[SC_PAIRS_TRIANGLE][SC_CONTACT_PROPER], a, b);
        }
    }

    /* Every side of the owner's copy is met in some pair with b, so each edge came exactly once. */
    for (int kind = 0; kind < 2; ++kind) {
        for (int contact = 0; contact < 2; ++contact) {
            oracle_list *list = &answer->lists[kind][contact];
            if (list->count > 1) qsort(list->pairs, list->count, sizeof(sc_pair), compare_pairs);
        }
    }
    stop_solver(&s, vertex_count);
    free(owners);
    free(boxes);
    free(used);
    free(corners);
}

void oracle_free(oracle_answer *answer)
{
    for (int kind = 0; kind < 2; ++kind) {
        for (int contact = 0; contact < 2; ++contact) free(answer->lists[kind][contact].pairs);
    }
    memset(answer, 0, sizeof(*answer));
}

int oracle_hulls_meet(const double *p, uint32_t p_count, const double *q, uint32_t q_count)
{
    static const uint32_t first[3] = {0, 1, 2};
    double positions[18];
    uint8_t used[6] = {1, 1, 1, 1, 1, 1};
    uint32_t second[3] = {0, 0, 0};
    solver s;
    int meet;
    memcpy(positions, p, 3 * p_count * sizeof(double));
    memcpy(positions + 3 * p_count, q, 3 * q_count * sizeof(double));
    for (uint32_t j = 0; j < q_count; ++j) second[j] = p_count + j;
    start_solver(&s);
    read_points(&s, positions, p_count + q_count, used);
    meet = hulls_meet(&s, first, p_count, second, q_count);
    stop_solver(&s, p_count + q_count);
    return meet;
}
