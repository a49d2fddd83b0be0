/*
 * Differences, sums and products of eight doubles without loss: what is rounded, and the rest. Part
 * of the kernels, behind simd/lanes.h.
 *
 * SPDX-License-Identifier: MIT
 *
 * Shewchuk 1997, section 2, and Dekker 1971, as in base/predicates.c: exact where nothing overflows
 * and no rest is subnormal.
 */

/* Doubles and what they are rounded from: value + tail; and the value cut in two halves. */
typedef struct exact_doubles {
    doubles value, high, low, tail;
} exact_doubles;

/* A value, whose halves have 26 bits each, and what it was rounded from. */
static inline exact_doubles exact_halves(doubles value, doubles tail)
{
    const doubles scaled = doubles_multiply(doubles_all(134217729.0), value); /* 2^27 + 1 */
    exact_doubles n;
    n.value = value;
    n.high = doubles_subtract(scaled, doubles_subtract(scaled, value));
    n.low = doubles_subtract(value, n.high);
    n.tail = tail;
    return n;
}

/* to - from */
static inline exact_doubles exact_difference(doubles to, doubles from)
{
    const doubles value = doubles_subtract(to, from);
    const doubles from_part = doubles_subtract(value, to); /* - from */
    const doubles to_part = doubles_subtract(value, from_part);
    return exact_halves(
        value, doubles_subtract(doubles_subtract(to, to_part), doubles_add(from, from_part)));
}

/* a + b, which is what is returned and *rest */
static inline doubles exact_sum(doubles a, doubles b, doubles *rest)
{
    const doubles sum = doubles_add(a, b), b_part = doubles_subtract(sum, a);
    const doubles a_part = doubles_subtract(sum, b_part);
    *rest = doubles_add(doubles_subtract(a, a_part), doubles_subtract(b, b_part));
    return sum;
}

/* The product of two values, likewise. */
static inline doubles exact_product(const exact_doubles *a, const exact_doubles *b, doubles *rest)
{
    const doubles product = doubles_multiply(a->value, b->value);
    doubles left = doubles_subtract(doubles_multiply(a->high, b->high), product);
    left = doubles_add(left, doubles_multiply(a->high, b->low));
    left = doubles_add(left, doubles_multiply(a->low, b->high));
    *rest = doubles_add(left, doubles_multiply(a->low, b->low));
    return product;
}
