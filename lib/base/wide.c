/*
 * Orientation signs by big integers: schoolbook arithmetic on sign and magnitude.
 *
 * SPDX-License-Identifier: MIT
 *
 * A finite double is an integer times a power of two. Dividing all coordinates by the least of
 * these powers leaves integers and does not change the sign. Their length is that of the span of
 * the exponents: from 2^-1074 to below 2^1024 at most, 2098 bits. A difference has one bit more, a
 * product of two differences 4198, a difference of such products 4199, a product with a third
 * difference 6298, a sum of three 6300 bits; a product of two differences of products 8398, a sum
 * of three 8400 bits; a product of two determinants 12600, a sum of four 12602 bits.
 */
#include "base/wide.h"

#include <stdint.h>
#include <string.h>

/* limbs of 32 bits */
enum {
    SMALL_LIMBS = 66,
    MIDDLE_LIMBS = 132,
    LARGE_LIMBS = 198,
    HUGE_LIMBS = 264,
    MOST_LIMBS = 396
};

/* sign times the sum of limb[i] 2^(32 i). Zero has sign 0 and count 0; the last limb is not 0. */
typedef struct number {
    int sign;
    int count;
    uint32_t *limb; /* the caller says where */
} number;

/* A finite double: sign times mantissa times 2^(exponent - 1074). */
typedef struct parts {
    int sign; /* 1 or -1, also of 0 */
    int exponent;
    uint64_t mantissa; /* below 2^53 */
} parts;

static parts decode(double value)
{
    const uint64_t leading_one = UINT64_C(1) << 52;
    parts result;
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    result.sign = bits >> 63 ? -1 : 1;
    result.exponent = (int)(bits >> 52 & 0x7ff);
    result.mantissa = bits & (leading_one - 1);
    if (result.exponent != 0) { /* else subnormal */
        result.mantissa |= leading_one;
        --result.exponent;
    }
    return result;
}

/* The least exponent of the coordinates that are not zero, lowered to the given one. */
static int least_exponent(const double *coordinates, int count, int least)
{
    for (int i = 0; i < count; ++i) {
        parts p = decode(coordinates[i]);
        if (p.mantissa != 0 && p.exponent < least) least = p.exponent;
    }
    return least;
}

static void trim(number *n)
{
    while (n->count > 0 && n->limb[n->count - 1] == 0) --n->count;
    if (n->count == 0) n->sign = 0;
}

/* The integer value / 2^(least - 1074). Touches three limbs from that of the lowest bit on. */
static void set_double(number *n, double value, int least)
{
    parts p = decode(value);
    n->sign = 0;
    n->count = 0;
    if (p.mantissa == 0) return;

    int shift = p.exponent - least, first = shift / 32;
    uint64_t low = (p.mantissa & UINT32_MAX) << shift % 32;
    uint64_t middle = ((p.mantissa >> 32) << shift % 32) + (low >> 32);
    memset(n->limb, 0, (size_t)first * sizeof *n->limb);
    n->limb[first] = (uint32_t)(low & UINT32_MAX);
    n->limb[first + 1] = (uint32_t)(middle & UINT32_MAX);
    n->limb[first + 2] = (uint32_t)(middle >> 32);
    n->count = first + 3;
    n->sign = p.sign;
    trim(n);
}

static int compare_magnitudes(const number *a, const number *b)
{
    if (a->count != b->count) return a->count < b->count ? -1 : 1;
    for (int i = a->count - 1; i >= 0; --i) {
        if (a->limb[i] != b->limb[i]) return a->limb[i] < b->limb[i] ? -1 : 1;
    }
    return 0;
}

static void copy_number(number *result, const number *a, int factor)
{
    memcpy(result->limb, a->limb, (size_t)a->count * sizeof *a->limb);
    result->count = a->count;
    result->sign = factor * a->sign;
}

/* result = a + factor b, factor 1 or -1; result is neither. */
static void add(number *result, const number *a, const number *b, int factor)
{
    if (b->sign == 0) {
        copy_number(result, a, 1);
        return;
    }
    if (a->sign == 0) {
        copy_number(result, b, factor);
        return;
    }
    int a_is_larger = compare_magnitudes(a, b) >= 0;
    const number *large = a_is_larger ? a : b, *small = a_is_larger ? b : a;
    int carry = 0, same_sign = a->sign == factor * b->sign;
    result->sign = a_is_larger ? a->sign : factor * b->sign;
    for (int i = 0; i < large->count; ++i) {
        int64_t limb = i < small->count ? (int64_t)small->limb[i] : 0;
        int64_t sum = (int64_t)large->limb[i] + (same_sign ? limb : -limb) + carry;
        carry = sum > (int64_t)UINT32_MAX ? 1 : sum < 0 ? -1 : 0;
        result->limb[i] = (uint32_t)((uint64_t)sum & UINT32_MAX);
    }
    result->count = large->count;
    if (carry > 0) result->limb[result->count++] = 1;
    trim(result);
}

/* result = a b; result is neither. */
static void multiply(number *result, const number *a, const number *b)
{
    result->sign = a->sign * b->sign;
    result->count = a->count + b->count;
    memset(result->limb, 0, (size_t)result->count * sizeof *result->limb);
    for (int i = 0; i < a->count; ++i) {
        uint64_t carry = 0;
        for (int j = 0; j < b->count; ++j) {
            carry += (uint64_t)a->limb[i] * b->limb[j] + result->limb[i + j];
            result->limb[i + j] = (uint32_t)(carry & UINT32_MAX);
            carry >>= 32;
        }
        result->limb[i + b->count] = (uint32_t)carry;
    }
    trim(result);
}

/* A difference of two coordinates. */
typedef struct wide_difference {
    number value;
    uint32_t limb[SMALL_LIMBS];
} wide_difference;

static void subtract_doubles(wide_difference *result, double a, double b, int least)
{
    uint32_t a_limb[SMALL_LIMBS], b_limb[SMALL_LIMBS];
    number a_number = {0, 0, a_limb}, b_number = {0, 0, b_limb};
    set_double(&a_number, a, least);
    set_double(&b_number, b, least);
    result->value.limb = result->limb;
    add(&result->value, &a_number, &b_number, -1);
}

/* result = ax by - ay bx, of at most MIDDLE_LIMBS */
static void minor(number *result, const wide_difference *ax, const wide_difference *by,
                  const wide_difference *ay, const wide_difference *bx)
{
    uint32_t left_limb[MIDDLE_LIMBS], right_limb[MIDDLE_LIMBS];
    number left = {0, 0, left_limb}, right = {0, 0, right_limb};
    multiply(&left, &ax->value, &by->value);
    multiply(&right, &ay->value, &bx->value);
    add(result, &left, &right, -1);
}

/* Sets *result, of MIDDLE_LIMBS, to the determinant divided by 2^(2 (least - 1074)). */
static void find_2d(number *result, const double a[2], const double b[2], const double c[2],
                    int least)
{
    wide_difference u[2], v[2];
    for (int i = 0; i < 2; ++i) {
        subtract_doubles(&u[i], b[i], a[i], least);
        subtract_doubles(&v[i], c[i], a[i], least);
    }
    minor(result, &u[0], &v[1], &u[1], &v[0]);
}

/* Sets *result, of LARGE_LIMBS, to the determinant divided by 2^(3 (least - 1074)). */
static void find_3d(number *result, const double a[3], const double b[3], const double c[3],
                    const double d[3], int least)
{
    wide_difference u[3], v[3], w[3];
    for (int i = 0; i < 3; ++i) {
        subtract_doubles(&u[i], b[i], a[i], least);
        subtract_doubles(&v[i], c[i], a[i], least);
        subtract_doubles(&w[i], d[i], a[i], least);
    }
    uint32_t limbs[2][LARGE_LIMBS], product_limb[LARGE_LIMBS], minor_limb[MIDDLE_LIMBS];
    number sum = {0, 0, limbs[0]}, next = {0, 0, limbs[1]};
    number product = {0, 0, product_limb}, cross = {0, 0, minor_limb};
    for (int i = 0; i < 3; ++i) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        minor(&cross, &u[j], &v[k], &u[k], &v[j]);
        multiply(&product, &cross, &w[i].value);
        add(&next, &sum, &product, 1);
        number swap = sum;
        sum = next;
        next = swap;
    }
    copy_number(result, &sum, 1);
}

static int least_exponent_2d(const double a[2], const double b[2], const double c[2])
{
    return least_exponent(a, 2, least_exponent(b, 2, least_exponent(c, 2, 2047)));
}

static int least_exponent_3d(const double a[3], const double b[3], const double c[3],
                             const double d[3])
{
    return least_exponent(a, 3,
                          least_exponent(b, 3, least_exponent(c, 3, least_exponent(d, 3, 2047))));
}

int sc_wide_orient2d(const double a[2], const double b[2], const double c[2])
{
    uint32_t limb[MIDDLE_LIMBS];
    number result = {0, 0, limb};
    find_2d(&result, a, b, c, least_exponent_2d(a, b, c));
    return result.sign;
}

int sc_wide_orient3d(const double a[3], const double b[3], const double c[3], const double d[3])
{
    uint32_t limb[LARGE_LIMBS];
    number result = {0, 0, limb};
    find_3d(&result, a, b, c, d, least_exponent_3d(a, b, c, d));
    return result.sign;
}

/* The last four limbs: 97 bits or more, rounded four times. */
static double round_number(const number *n, int *exponent)
{
    double value = 0;
    int low = n->count > 4 ? n->count - 4 : 0;
    for (int i = n->count - 1; i >= low; --i) value = value * 4294967296.0 + (double)n->limb[i];
    *exponent = 32 * low;
    return n->sign < 0 ? -value : value;
}

double sc_wide_orient2d_value(const double a[2], const double b[2], const double c[2],
                              int *exponent)
{
    uint32_t limb[MIDDLE_LIMBS];
    number result = {0, 0, limb};
    int least = least_exponent_2d(a, b, c);
    double value;
    find_2d(&result, a, b, c, least);
    value = round_number(&result, exponent);
    *exponent += 2 * (least - 1074);
    return value;
}

double sc_wide_orient3d_value(const double a[3], const double b[3], const double c[3],
                              const double d[3], int *exponent)
{
    uint32_t limb[LARGE_LIMBS];
    number result = {0, 0, limb};
    int least = least_exponent_3d(a, b, c, d);
    double value;
    find_3d(&result, a, b, c, d, least);
    value = round_number(&result, exponent);
    *exponent += 3 * (least - 1074);
    return value;
}

/* A factor of a product divided by 2^(least - 1074) or its square, of at most MIDDLE_LIMBS. Returns
   of how many differences it is made. */
static int find_factor(number *result, const double *const points[4], const sc_wide_factor *factor,
                       int least)
{
    wide_difference u[2], v[2];
    int i, of_two = factor->from2 != factor->to2;
    for (i = 0; i < 1 + of_two; ++i) {
        int k = (factor->axis + of_two + i) % 3;
        subtract_doubles(&u[i], points[factor->to][k], points[factor->from][k], least);
        if (of_two)
            subtract_doubles(&v[i], points[factor->to2][k], points[factor->from2][k], least);
    }
    if (of_two)
        minor(result, &u[0], &v[1], &u[1], &v[0]);
    else
        copy_number(result, &u[0].value, 1);
    return 1 + of_two;
}

/* The first 64 bits as an integer, which becomes the nearest double. */
static double round_once(const number *n, int *exponent)
{
    uint64_t bits = 0;
    int last = n->count - 1, free_bits = 0;
    *exponent = 0;
    if (n->count == 0) return 0;
    while (!(n->limb[last] << free_bits & UINT32_C(0x80000000))) ++free_bits;
    for (int i = last; i > last - 3; --i) {
        uint64_t limb = i >= 0 ? n->limb[i] : 0;
        int shift = 32 * (i - last + 1) + free_bits;
        bits |= shift >= 0 ? limb << shift : limb >> -shift;
    }
    *exponent = 32 * (last - 1) - free_bits;
    return n->sign * (double)bits;
}

double sc_wide_products_value(const double *const points[4], const sc_wide_factor (*factors)[2],
                              int count, int *exponent)
{
    uint32_t limbs[2][HUGE_LIMBS], product_limb[HUGE_LIMBS], factor_limb[2][MIDDLE_LIMBS];
    number sum = {0, 0, limbs[0]}, next = {0, 0, limbs[1]}, product = {0, 0, product_limb};
    number factor[2] = {{0, 0, factor_limb[0]}, {0, 0, factor_limb[1]}};
    int least = 2047, degree = 0;
    double value;
    for (int i = 0; i < 4; ++i) least = least_exponent(points[i], 3, least);
    for (int i = 0; i < count; ++i) {
        degree = find_factor(&factor[0], points, &factors[i][0], least);
        degree += find_factor(&factor[1], points, &factors[i][1], least);
        multiply(&product, &factor[0], &factor[1]);
        add(&next, &sum, &product, 1);
        number swap = sum;
        sum = next;
        next = swap;
    }
    value = round_once(&sum, exponent);
    *exponent += degree * (least - 1074);
    return value;
}

/* A minor, of at most LARGE_LIMBS, divided by 2^(least - 1074) to the power of count - 1. */
static void find_minor(number *result, const sc_wide_minor *m, int least)
{
    const int *column = m->columns;
    double p[3][2];
    wide_difference difference;
    if (m->count == 4) {
        find_3d(result, m->rows[0], m->rows[1], m->rows[2], m->rows[3], least);
    } else if (m->count == 3) {
        for (int i = 0; i < 6; ++i) p[i / 2][i % 2] = m->rows[i / 2][column[i % 2]];
        find_2d(result, p[0], p[1], p[2], least);
    } else if (m->count == 2) {
        subtract_doubles(&difference, m->rows[1][column[0]], m->rows[0][column[0]], least);
        copy_number(result, &difference.value, 1);
    } else {
        result->sign = result->count = 1;
        result->limb[0] = 1;
    }
}

double sc_wide_minors_value(const sc_wide_minor (*factors)[2], const int *signs, int count,
                            int *exponent)
{
    uint32_t limbs[2][MOST_LIMBS], product_limb[MOST_LIMBS], factor_limb[2][LARGE_LIMBS];
    number sum = {0, 0, limbs[0]}, next = {0, 0, limbs[1]}, product = {0, 0, product_limb};
    number factor[2] = {{0, 0, factor_limb[0]}, {0, 0, factor_limb[1]}};
    int least = 2047;
    double value;
    for (int i = 0; i < 2 * count; ++i) {
        const sc_wide_minor *m = &factors[i / 2][i % 2];
        for (int k = 0; k < m->count; ++k) least = least_exponent(m->rows[k], 3, least);
    }
    for (int i = 0; i < count; ++i) {
        for (int k = 0; k < 2; ++k) find_minor(&factor[k], &factors[i][k], least);
        multiply(&product, &factor[0], &factor[1]);
        add(&next, &sum, &product, signs[i]);
        number swap = sum;
        sum = next;
        next = swap;
    }
    value = round_once(&sum, exponent);
    *exponent += (factors[0][0].count + factors[0][1].count - 2) * (least - 1074);
    return value;
}
