/*
 * Orientation signs of points in general position. See perturbed.h.
 *
 * SPDX-License-Identifier: MIT
 *
 * The sign is that of the determinant of the rows 1, x, y, z of the four points. Moved, it is a
 * polynomial in the numbers e: for each choice of some rows and as many columns of x, y and z, each
 * row with a column of its own, the e of these places times the minor of what is left of rows and
 * columns, with the sign that this place in the determinant has. The sign is that of the largest of
 * these terms that is not 0. Of two products of different e that one is larger in which the
 * smallest e that they do not have in common is not. So they come in the order of numbers in which
 * bit 3 r + c says whether e of column c of row r is in the product. Three rows and all three
 * columns leave the column of ones, a minor of 1: so the search ends, at the latest with the lowest
 * such choice.
 *
 * Only the order of the numbers of points counts, so rows are sorted.
 */
#include "base/perturbed.h"

#include "base/predicates.h"
#include "base/wide.h"

enum { LAST_EXPONENT = 1 << 6 | 1 << 4 | 1 << 2 }; /* rows 2, 1 and 0 in columns 0, 1 and 2 */

/* Sorts rows by their numbers; returns the sign of the permutation. */
static int sort_rows(const double *rows[4], const uint32_t numbers[4])
{
    uint32_t number[4];
    int i, j, sign = 1;
    for (i = 0; i < 4; i++) number[i] = numbers[i];
    for (i = 1; i < 4; i++)
        for (j = i; j > 0 && number[j - 1] > number[j]; j--) {
            const double *row = rows[j];
            uint32_t n = number[j];
            rows[j] = rows[j - 1];
            number[j] = number[j - 1];
            rows[j - 1] = row;
            number[j - 1] = n;
            sign = -sign;
        }
    return sign;
}

/* The places that an exponent tells: the column of each row, 3 for none. 0 if two are in one row or
   one column. */
static int read_exponent(int exponent, int column[4])
{
    int row, c, taken = 0;
    for (row = 0; row < 4; row++, exponent >>= 3) {
        column[row] = 3;
        for (c = 0; c < 3; c++) {
            if (!(exponent >> c & 1)) continue;
            if (column[row] < 3 || (taken >> c & 1)) return 0;
            column[row] = c;
            taken |= 1 << c;
        }
    }
    return 1;
}

/* The minor of the rows without a column and of the columns of no row, with that of ones. */
static void take_minor(const double *const rows[4], const int column[4], sc_wide_minor *minor)
{
    int is_free[4] = {1, 1, 1, 1}, columns = 0, i;
    minor->count = 0;
    for (i = 0; i < 4; i++) {
        if (column[i] == 3)
            minor->rows[minor->count++] = rows[i];
        else
            is_free[column[i]] = 0;
    }
    for (i = 0; i < 3; i++)
        if (is_free[i]) minor->columns[columns++] = i;
}

static int minor_sign(const sc_wide_minor *m, uint64_t *fallbacks)
{
    const double *const *rows = m->rows;
    const int *column = m->columns;
    if (m->count == 4) return sc_predicates_orient3d(rows[0], rows[1], rows[2], rows[3], fallbacks);
    if (m->count == 3) {
        double p[3][2];
        int i;
        for (i = 0; i < 6; i++) p[i / 2][i % 2] = rows[i / 2][column[i % 2]];
        return sc_predicates_orient2d(p[0], p[1], p[2], fallbacks);
    }
    if (m->count == 2) {
        double p = rows[0][column[0]], q = rows[1][column[0]];
        return (q > p) - (q < p);
    }
    return 1;
}

/* The sign of the places of a choice in the determinant, whose column of ones comes before the
   others: -1 to the number of inversions, of rows with a column among each other and against rows
   and columns that are left. */
static int place_sign(const int column[4])
{
    int sum = 0, row, other;
    for (row = 0; row < 4; row++) {
        if (column[row] == 3) continue;
        sum += row + column[row] + 1;
        for (other = 0; other < row; other++)
            sum += column[other] != 3 && column[other] > column[row];
    }
    return sum % 2 ? -1 : 1;
}

int sc_perturbed_orient3d(const double *const points[4], const uint32_t numbers[4],
                          uint64_t *fallbacks)
{
    const double *rows[4] = {points[0], points[1], points[2], points[3]};
    int sign = sc_predicates_orient3d(points[0], points[1], points[2], points[3], fallbacks);
    int order, exponent, column[4];
    if (sign) return sign;
    order = sort_rows(rows, numbers);
    for (exponent = 1; exponent <= LAST_EXPONENT && !sign; exponent++) {
        sc_wide_minor minor;
        if (!read_exponent(exponent, column)) continue;
        take_minor(rows, column, &minor);
        sign = place_sign(column) * minor_sign(&minor, fallbacks);
    }
    return order * sign;
}

/* ---- crossings ---- */

/*
 * With s(p) the determinant of the plane of points 2, 3 and 4 with p, and t(p) that of points 5, 6
 * and 7, the crossing of p and q is (s(p) q - s(q) p) / (s(p) - s(q)), since s is 0 there. So t of
 * it is (s(p) t(q) - s(q) t(p)) / (s(p) - s(q)), and s(p) - s(q) has the sign of s(p).
 *
 * Moved, s(p) t(q) - s(q) t(p) is a polynomial again. Of each point it has at most the first power,
 * except of one that is in both planes. Its terms are looked at from the largest on: what is chosen
 * of each point, nothing or x, y or z, are the digits of a number of which that of the first point
 * is the lowest. A term is what the determinants are with the rows of chosen points replaced by 1
 * in the chosen column and 0 elsewhere. A point of both planes may be chosen in each of them, the
 * product of two e being one whichever of them has which.
 */

/* What is chosen in both planes, in the order of the products' sizes: the larger e first. */
static const int two_choices[][2] = {{3, 3}, {3, 0}, {0, 0}, {3, 1}, {0, 1},
                                     {1, 1}, {3, 2}, {0, 2}, {1, 2}, {2, 2}};

/* A point and the places, one or two of the eight, where it is. */
typedef struct placed_point {
    uint32_t number;
    int places[2], count;
    int choice; /* a digit */
} placed_point;

/* Products of two minors, of which a term is the sum. */
typedef struct minor_products {
    int count, signs[4];
    sc_wide_minor factors[4][2];
} minor_products;

/* Adds the product of the determinants of end and the first plane, and of the other end and the
   second one. column: that of each point, 3 for none. */
static void add_minors(minor_products *sum, const double *const points[8], const int column[8],
                       int end)
{
    int sign = end ? -1 : 1, k;
    for (k = 0; k < 2; k++) {
        const int plane = 2 + 3 * k, other = k ? !end : end;
        const double *const rows[4] = {points[plane], points[plane + 1], points[plane + 2],
                                       points[other]};
        const int chosen[4] = {column[plane], column[plane + 1], column[plane + 2], column[other]};
        int i, taken = 0;
        for (i = 0; i < 4; i++) {
            if (chosen[i] == 3) continue;
            if (taken >> chosen[i] & 1) return; /* two rows are equal */
            taken |= 1 << chosen[i];
        }
        sign *= place_sign(chosen);
        take_minor(rows, chosen, &sum->factors[sum->count][k]);
    }
    sum->signs[sum->count++] = sign;
}

/* The sign of a sum of two products of four points each, as far as that is certain: else 0. Each
   value is off by 2^-51 of itself. */
static int sign_by_values(const minor_products *sum)
{
    double difference;
    sc_predicates_value product[2];
    int i, k;
    if (sum->count != 2) return 0;
    for (i = 0; i < 2; i++) {
        product[i].number = sum->signs[i];
        product[i].exponent = 0;
        for (k = 0; k < 2; k++) {
            const double *const *p = sum->factors[i][k].rows;
            sc_predicates_value v;
            int exponent;
            if (sum->factors[i][k].count != 4) return 0;
            v = sc_predicates_orient3d_value(p[0], p[1], p[2], p[3]);
            product[i].number *= frexp(v.number, &exponent);
            product[i].exponent += v.exponent + exponent;
        }
    }
    i = product[1].exponent - product[0].exponent;
    difference = product[0].number + ldexp(product[1].number, i);
    return fabs(difference) <= 0x1p-48 * fabs(product[0].number) ? 0 : difference > 0 ? 1 : -1;
}

static int sign_of_sum(const minor_products *sum)
{
    uint64_t fallbacks = 0;
    int above = 0, below = 0, exponent, i, sign;
    double value;
    for (i = 0; i < sum->count; i++) {
        sign = sum->signs[i] * minor_sign(&sum->factors[i][0], &fallbacks);
        if (sign) sign *= minor_sign(&sum->factors[i][1], &fallbacks);
        above |= sign > 0;
        below |= sign < 0;
    }
    if (!above || !below) return above - below;
    sign = sign_by_values(sum);
    if (sign) return sign;
    value = sc_wide_minors_value((const sc_wide_minor(*)[2])sum->factors, sum->signs, sum->count,
                                 &exponent);
    return (value > 0) - (value < 0);
}

/* The sign of the term that is chosen. */
static int sign_of_term(const double *const points[8], const placed_point *placed, int count)
{
    minor_products sum;
    int column[8], both = -1, i;
    sum.count = 0;
    for (i = 0; i < count; i++) {
        const placed_point *p = &placed[i];
        const int *two = two_choices[p->choice];
        if (p->count == 1) {
            column[p->places[0]] = p->choice ? p->choice - 1 : 3;
            continue;
        }
        column[p->places[0]] = two[0];
        column[p->places[1]] = two[1];
        if (two[0] != two[1]) both = i;
    }
    add_minors(&sum, points, column, 0);
    add_minors(&sum, points, column, 1);
    if (both >= 0) {
        const int *place = placed[both].places, first = column[place[0]];
        column[place[0]] = column[place[1]];
        column[place[1]] = first;
        add_minors(&sum, points, column, 0);
        add_minors(&sum, points, column, 1);
    }
    return sign_of_sum(&sum);
}

/* Lists the points, sorted by numbers; returns how many these are. */
static int place_points(const uint32_t numbers[8], placed_point placed[8])
{
    int count = 0, i, k;
    for (i = 0; i < 8; i++) {
        for (k = 0; k < count && placed[k].number != numbers[i];) k++;
        if (k < count) {
            placed[k].places[placed[k].count++] = i;
            continue;
        }
        for (k = count++; k > 0 && placed[k - 1].number > numbers[i]; k--)
            placed[k] = placed[k - 1];
        placed[k].number = numbers[i];
        placed[k].places[0] = i;
        placed[k].count = 1;
        placed[k].choice = 0;
    }
    return count;
}

/* Chooses the next term. There is one that is not 0 before the last: with points in two planes free
   to move, one determinant is no multiple of the other. */
static void choose_next(placed_point *placed)
{
    while (++placed->choice == (placed->count == 1 ? 4 : 10)) {
        placed->choice = 0;
        placed++;
    }
}

/* The sign of a point and the plane of points plane to plane + 2. */
static int sign_of_end(const double *const points[8], const uint32_t numbers[8], int plane, int end)
{
    const double *const p[4] = {points[plane], points[plane + 1], points[plane + 2], points[end]};
    const uint32_t n[4] = {numbers[plane], numbers[plane + 1], numbers[plane + 2], numbers[end]};
    uint64_t fallbacks = 0;
    return sc_perturbed_orient3d(p, n, &fallbacks);
}

int sc_perturbed_crossing_side(const double *const points[8], const uint32_t numbers[8])
{
    placed_point placed[8];
    int side[2] = {0, 0}, end, i, count, sign;
    for (end = 0; end < 2; end++) {
        int is_in_plane = 0;
        for (i = 5; i < 8; i++) is_in_plane |= numbers[i] == numbers[end];
        if (!is_in_plane) side[end] = sign_of_end(points, numbers, 5, end);
    }
    if (side[0] == side[1]) return side[0];
    if (!side[0] || !side[1]) return side[0] + side[1];
    count = place_points(numbers, placed);
    while (!(sign = sign_of_term(points, placed, count))) choose_next(placed);
    return sign * sign_of_end(points, numbers, 2, 0);
}
