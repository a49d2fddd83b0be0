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
 * stack. Before, determinants of three dimensions are tried in plain arithmetic, where differences
 * have so few bits that it is exact, and in sums of two doubles, which say the sign of nearly all
 * that is not zero: 10 and 50 ns instead of 250.
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

/* Rounded sum and, in *error, what the rounding lost: together exactly a + b, whatever their
   order. */
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

/* ------------------------------------------------------------------------------------------------
 * Signs of determinants of three differences each without expansions, as far as that is certain.
 */

enum { UNCERTAIN = 2 };

/* Differences of b, c and d from a: their values, and what rounding lost. */
typedef struct differences {
    double value[3][3], tail[3][3];
    int have_tails;
} differences;

static void find_differences(differences *x, const double a[3], const double b[3],
                             const double c[3], const double d[3])
{
    const double *const to[3] = {b, c, d};
    x->have_tails = 0;
    for (int k = 0; k < 3; ++k) {
        for (int i = 0; i < 3; ++i) {
            x->value[k][i] = add_exactly(to[k][i], -a[i], &x->tail[k][i]);
            x->have_tails |= x->tail[k][i] != 0.0;
        }
    }
}

/*
 * Whether all are multiples of one power of two and below 2^16 times that. Then minors are below
 * 2^33 times its square and the determinant below 2^51 times its cube, and all of them are exact in
 * plain arithmetic. What is added here, and taken away again, leaves of a number the multiple next
 * to it.
 */
static int have_few_bits(double value[3][3])
{
    double largest = 0.0, power;
    uint64_t bits;
    int few = 1;
    for (int i = 0; i < 3; ++i) {
        double u = fabs(value[0][i]), v = fabs(value[1][i]), w = fabs(value[2][i]);
        double larger = u > v ? u : v;
        larger = larger > w ? larger : w;
        largest = largest > larger ? largest : larger;
    }
    memcpy(&bits, &largest, sizeof bits);
    bits &= UINT64_C(0x7ff) << 52;
    memcpy(&power, &bits, sizeof power);
    power *= 0x1.8p+37;
    for (int k = 0; k < 3; ++k) {
        for (int i = 0; i < 3; ++i) few &= (value[k][i] + power) - power == value[k][i];
    }
    return few;
}

static int plain_sign(double value[3][3])
{
    double *u = value[0], *v = value[1], *w = value[2];
    double determinant = (u[1] * v[2] - u[2] * v[1]) * w[0] + (u[2] * v[0] - u[0] * v[2]) * w[1] +
                         (u[0] * v[1] - u[1] * v[0]) * w[2];
    return (determinant > 0.0) - (determinant < 0.0);
}

/* A factor of several products: a double and its halves. */
typedef struct factor {
    double value, high, low;
} factor;

static factor make_factor(double value)
{
    factor f;
    f.value = value;
    f.high = split(value, &f.low);
    return f;
}

static double multiply_factors(const factor *a, const factor *b, double *error)
{
    double product = a->value * b->value;
    double rest = a->high * b->high - product;
    rest += a->high * b->low;
    rest += a->low * b->high;
    *error = rest + a->low * b->low;
    return product;
}

/*
 * The determinant as a sum of two doubles, and how far these are off at most.
 *
 * Let u = 2^-53, P = |u_j v_k| + |u_k v_j| of a minor, M the sum of the three P |w_i|, and all to
 * first order. A minor is h + l, the difference of two products and what their roundings and that
 * of it lost, but for the roundings of the latter two sums: 3 u^2 P. With w_i it is a sum of h w_i,
 * of which the three together are made the first double, and of what the three products and the two
 * sums lost, u M and 2 u M, and the three l w_i, of which the |l| are 2 u P at most, each rounded:
 * 2 u^2 M. What the nine differences lost adds terms of 3 u M together, rounded six times at most,
 * and leaves out 3 u^2 M. The second double is the sum of nine terms, of at most 8 u M together,
 * rounded eight times each: 64 u^2 M. All that is below 100 u^2 M; the bound is 256 u^2 M, room for
 * what is not of first order and for the rounding of M included.
 */
static double sum_of_two(const differences *x, double *bound)
{
    factor u[3], v[3], w[3];
    double first = 0.0, second = 0.0, magnitude = 0.0;
    for (int i = 0; i < 3; ++i) {
        u[i] = make_factor(x->value[0][i]);
        v[i] = make_factor(x->value[1][i]);
        w[i] = make_factor(x->value[2][i]);
    }
    for (int i = 0; i < 3; ++i) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        double left_error, right_error, minor_error, product_error, sum_error;
        double left = multiply_factors(&u[j], &v[k], &left_error);
        double right = multiply_factors(&u[k], &v[j], &right_error);
        double high = add_exactly(left, -right, &minor_error);
        double low = minor_error + (left_error - right_error);
        factor minor = make_factor(high);
        double product = multiply_factors(&minor, &w[i], &product_error);
        first = add_exactly(first, product, &sum_error);
        second += sum_error + (product_error + low * w[i].value);
        magnitude += (fabs(left) + fabs(right)) * fabs(w[i].value);
        if (x->have_tails) {
            const double *ut = x->tail[0], *vt = x->tail[1], *wt = x->tail[2];
            second += high * wt[i] + ((ut[j] * v[k].value + u[j].value * vt[k]) -
                                      (ut[k] * v[j].value + u[k].value * vt[j])) *
                                         w[i].value;
        }
    }
    *bound = SC_BOUNDS_SIGN_SUMS * magnitude;
    return first + second;
}

static int sign_of_two(const differences *x)
{
    double bound, sum = sum_of_two(x, &bound);
    return sum > bound ? 1 : sum < -bound ? -1 : UNCERTAIN;
}

static int find_sign_3d(const double a[3], const double b[3], const double c[3], const double d[3])
{
    differences x;
    find_differences(&x, a, b, c, d);
    if (!x.have_tails && have_few_bits(x.value)) return plain_sign(x.value);
    return sign_of_two(&x);
}

/* ---------------------------------------------------------------------------------------------- */

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
    int moderate = 1;
    for (int i = 0; i < count; ++i) {
        uint64_t bits;
        memcpy(&bits, &coordinates[i], sizeof bits);
        bits &= UINT64_MAX >> 1;
        moderate &= (bits == 0) | ((bits >= low) & (bits < high));
    }
    return moderate;
}

/* The sum, to within 2^-51 of it: the terms before the last two add up to less than the lowest bit
   of the last but one. */
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
    int sign;
    if (!all_moderate_3d(a, b, c, d)) return sc_wide_orient3d(a, b, c, d);
    sign = find_sign_3d(a, b, c, d);
    if (sign != UNCERTAIN) return sign;
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
    double terms[DETERMINANT_TERMS], bound;
    sc_predicates_value value = {0.0, 0};
    differences x;
    if (!all_moderate_3d(a, b, c, d)) {
        value.number = sc_wide_orient3d_value(a, b, c, d, &value.exponent);
        return value;
    }
    /* off by 2^-52, and by half as much when the two are added */
    find_differences(&x, a, b, c, d);
    value.number = sum_of_two(&x, &bound);
    if (!(fabs(value.number) > 0x1p+52 * bound))
        value.number = sum_of_terms(terms, expand_3d(terms, a, b, c, d));
    return value;
}
