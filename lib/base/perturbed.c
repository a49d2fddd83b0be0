/*
 * Orientation signs of points in general position. See perturbed.h.
 *
 * SPDX-License-Identifier: MIT
 *
 * The sign is that of the determinant of the rows 1, x, y, z of the four points. Moved by powers of
 * e it is a polynomial in e: for each choice of some rows and as many columns of x, y and z, each
 * row with a column of its own, the powers in these places times the minor of what is left of rows
 * and columns, with the sign that this place in the determinant has. No two choices have the same
 * power of e, since its exponent, a sum of powers of two, tells the places. The sign is that of the
 * term of the lowest exponent that is not 0. Three rows and all three columns leave the column of
 * ones, a minor of 1: so the search ends, at the latest with the lowest such choice.
 *
 * Only the order of the numbers counts, so rows are sorted, and bit 3 r + c of an exponent stands
 * for column c of row r.
 */
#include "base/perturbed.h"

#include "base/predicates.h"

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

/* The sign of the minor of the rows without a column and of the columns of no row, with that of
   ones: of three rows and two columns, of two and one, or of one and none. */
static int minor_sign(const double *const rows[4], const int column[4], uint64_t *fallbacks)
{
    const double *left[4];
    int free_columns[3], is_free[4] = {1, 1, 1, 1}, count = 0, columns = 0, i;
    for (i = 0; i < 4; i++) {
        if (column[i] == 3)
            left[count++] = rows[i];
        else
            is_free[column[i]] = 0;
    }
    for (i = 0; i < 3; i++)
        if (is_free[i]) free_columns[columns++] = i;
    if (columns == 2) {
        double p[3][2];
        for (i = 0; i < 3; i++) {
            p[i][0] = left[i][free_columns[0]];
            p[i][1] = left[i][free_columns[1]];
        }
        return sc_predicates_orient2d(p[0], p[1], p[2], fallbacks);
    }
    if (columns == 1) {
        double p = left[0][free_columns[0]], q = left[1][free_columns[0]];
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
    for (exponent = 1; exponent <= LAST_EXPONENT && !sign; exponent++)
        if (read_exponent(exponent, column))
            sign = place_sign(column) * minor_sign(rows, column, fallbacks);
    return order * sign;
}
