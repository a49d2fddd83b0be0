/*
 * The exact stages of the orientation signs: expansions where they are safe, else big integers.
 *
 * SPDX-License-Identifier: MIT
 *
 * An expansion is a list of doubles, called terms, whose sum is the number meant. The terms are not
 * zero, and each is smaller in magnitude than the lowest bit set in the next. So all that come
 * before the last cannot outweigh its lowest bit, and the sign of the number is that of its last
 * term. Sums and products of expansions are exact as long as nothing overflows or underflows, which
 * is_moderate ensures beforehand.
 *
 * Cost: the longest expansion has 192 terms, in theory; in practice it has a handful. It is on the
 * stack.
 */
#include "base/predicates.h"
#include "base/wide.h"

#include <string.h>

/* A contracted product and sum would spoil the error terms. GCC does not contract with -std=c99. */
#if defined(__clang__)
#  pragma STDC FP_CONTRACT OFF
#elif defined(_MSC_VER)
#  pragma fp_contract(off)
#endif

enum {
    DIFFERENCE_TERMS = 2,
    MINOR_TERMS = 2 * 2 * DIFFERENCE_TERMS * DIFFERENCE_TERMS, /* two products of differences */
    DETERMINANT_TERMS = 3 * 2 * DIFFERENCE_TERMS * MINOR_TERMS /* three of a difference and that */
};

typedef struct difference {
    int count;
    double term[DIFFERENCE_TERMS];
} difference;

/* Rounded sum and, in *error, what the rounding lost: together exactly a + b, whatever their order. */
static double add_exactly(double a, double b, double *error)
{
    double sum = a + b;
    double b_part = sum - a;
    double a_part = sum - b_part;
    *error = (a - a_part) + (b - b_part);
    return sum;
}

/* Cuts a double into two of at most 26 bits each (the sign of the low one counting as a bit). */
static double split(double value, double *low)
{
    double scaled = 134217729.0 * value; /* 2^27 + 1 */
    double high = scaled - (scaled - value);
    *low = value - high;
    return high;
}

/* Rounded product and, in *error, what the rounding lost. Products of halves are exact. */
static double multiply_exactly(double a, double b, double *error)
{
    double a_low, b_low;
    double a_high = split(a, &a_low);
    double b_high = split(b, &b_low);
    double product = a * b;
    double rest = a_high * b_high - product;
    rest += a_high * b_low;
    rest += a_low * b_high;
    *error = rest + a_low * b_low;
    return product;
}

/*
 * Adds a double to an expansion of count terms and returns the new count, at most one more.
 *
 * The value is carried through the terms from the smallest on; errors become the new terms. They
 * keep the order that an expansion needs: an error is smaller than the lowest bit of the sum that
 * is carried on (that is what rounding means) and not larger than the term just met (the sum could
 * have been left without it), thus smaller than the lowest bit of all later terms. From such
 * multiples of a larger power of two all later errors and sums are made.
 */
static int add_double(double *terms, int count, double value)
{
    int kept = 0;
    for (int i = 0; i < count; ++i) {
        double error;
        value = add_exactly(value, terms[i], &error);
        if (error != 0.0) terms[kept++] = error;
    }
    if (value != 0.0) terms[kept++] = value;
    return kept;
}

/* Adds scale times the product of two expansions to a third; scale is 1 or -1. */
static int add_product(double *terms, int count, double scale, const double *left, int left_count,
                       const double *right, int right_count)
{
    for (int i = 0; i < left_count; ++i) {
        for (int j = 0; j < right_count; ++j) {
            double error;
            double product = multiply_exactly(scale * left[i], right[j], &error);
            if (error != 0.0) count = add_double(terms, count, error);
            count = add_double(terms, count, product);
        }
    }
    return count;
}

static difference subtract(double a, double b)
{
    difference result;
    double error, value = add_exactly(a, -b, &error);
    result.count = 0;
    if (error != 0.0) result.term[result.count++] = error;
    if (value != 0.0) result.term[result.count++] = value;
    return result;
}

/* ax by - ay bx */
static int expand_minor(double terms[MINOR_TERMS], const difference *ax, const difference *by,
                        const difference *ay, const difference *bx)
{
    int count = add_product(terms, 0, 1.0, ax->term, ax->count, by->term, by->count);
    return add_product(terms, count, -1.0, ay->term, ay->count, bx->term, bx->count);
}

static int sign_of_last(const double *terms, int count)
{
    return count == 0 ? 0 : terms[count - 1] > 0.0 ? 1 : -1;
}

/*
 * Whether a coordinate is 0 or has a magnitude from 2^-250 to below 2^251. Then it is a multiple of
 * 2^-302 (its last bit is 2^-52 of its first), and so are differences and their errors, which are
 * at most 2^252; what is made of products of three of them is a multiple of 2^-906 and below 2^800,
 * the 2^27 of split included: normal numbers all along. Looks at the bits, so that flushing
 * subnormals to zero makes no difference.
 */
static int is_moderate(const double *coordinates, int count)
{
    const uint64_t low = (uint64_t)(1023 - 250) << 52;
    const uint64_t high = (uint64_t)(1023 + 251) << 52;
    for (int i = 0; i < count; ++i) {
        uint64_t bits;
        memcpy(&bits, &coordinates[i], sizeof bits);
        bits &= UINT64_MAX >> 1;
        if (bits != 0 && (bits < low || bits >= high)) return 0;
    }
    return 1;
}

/* The sum, to within 2^-51 of it: the terms before the last two add up to less than the lowest bit of
   the last but one. */
static double sum_of_terms(const double *terms, int count)
{
    double sum = 0;
    for (int i = 0; i < count; ++i) sum += terms[i];
    return sum;
}

static int all_moderate_2d(const double a[2], const double b[2], const double c[2])
{
    return is_moderate(a, 2) && is_moderate(b, 2) && is_moderate(c, 2);
}

static int all_moderate_3d(const double a[3], const double b[3], const double c[3],
                           const double d[3])
{
    return is_moderate(a, 3) && is_moderate(b, 3) && is_moderate(c, 3) && is_moderate(d, 3);
}

static int expand_2d(double terms[MINOR_TERMS], const double a[2], const double b[2],
                     const double c[2])
{
    /* Points on a line along an axis: common, and quickly seen. */
    if ((a[0] == b[0] && a[0] == c[0]) || (a[1] == b[1] && a[1] == c[1])) return 0;

    difference ux = subtract(b[0], a[0]), uy = subtract(b[1], a[1]);
    difference vx = subtract(c[0], a[0]), vy = subtract(c[1], a[1]);
    return expand_minor(terms, &ux, &vy, &uy, &vx);
}

static int expand_3d(double terms[DETERMINANT_TERMS], const double a[3], const double b[3],
                     const double c[3], const double d[3])
{
    /* Points in a plane across an axis, as in flat meshes: common, and quickly seen. */
    for (int i = 0; i < 3; ++i) {
        if (a[i] == b[i] && a[i] == c[i] && a[i] == d[i]) return 0;
    }

    difference u[3], v[3], w[3];
    for (int i = 0; i < 3; ++i) {
        u[i] = subtract(b[i], a[i]);
        v[i] = subtract(c[i], a[i]);
        w[i] = subtract(d[i], a[i]);
    }
    int count = 0;
    for (int i = 0; i < 3; ++i) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        double minor[MINOR_TERMS];
        int minor_count = expand_minor(minor, &u[j], &v[k], &u[k], &v[j]);
        count = add_product(terms, count, 1.0, w[i].term, w[i].count, minor, minor_count);
    }
    return count;
}

int sc_predicates_orient2d_exact(const double a[2], const double b[2], const double c[2])
{
    double terms[MINOR_TERMS];
    if (!all_moderate_2d(a, b, c)) return sc_wide_orient2d(a, b, c);
    return sign_of_last(terms, expand_2d(terms, a, b, c));
}

int sc_predicates_orient3d_exact(const double a[3], const double b[3], const double c[3],
                                 const double d[3])
{
    double terms[DETERMINANT_TERMS];
    if (!all_moderate_3d(a, b, c, d)) return sc_wide_orient3d(a, b, c, d);
    return sign_of_last(terms, expand_3d(terms, a, b, c, d));
}

sc_predicates_value sc_predicates_orient2d_value(const double a[2], const double b[2],
                                                 const double c[2])
{
    double terms[MINOR_TERMS];
    sc_predicates_value value = {0.0, 0};
    if (all_moderate_2d(a, b, c))
        value.number = sum_of_terms(terms, expand_2d(terms, a, b, c));
    else
        value.number = sc_wide_orient2d_value(a, b, c, &value.exponent);
    return value;
}

sc_predicates_value sc_predicates_orient3d_value(const double a[3], const double b[3],
                                                 const double c[3], const double d[3])
{
    double terms[DETERMINANT_TERMS];
    sc_predicates_value value = {0.0, 0};
    if (all_moderate_3d(a, b, c, d))
        value.number = sum_of_terms(terms, expand_3d(terms, a, b, c, d));
    else
        value.number = sc_wide_orient3d_value(a, b, c, d, &value.exponent);
    return value;
}
