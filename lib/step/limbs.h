/*
 * Integers of a fixed number of limbs of 64 bits, as exact signs need them.
 *
 * SPDX-License-Identifier: MIT
 *
 * A number of n limbs is the sum of limb[i] 2^(64 i), modulo 2^(64 n), in two's complement: the top
 * bit of the last limb is its sign. The caller sees to it that results fit. Results are never
 * operands, unless said otherwise. The number of limbs is an argument: where it is a constant,
 * loops unroll; where it is not, the same text does for numbers of any length.
 */
#ifndef SC_STEP_LIMBS_H
#define SC_STEP_LIMBS_H

#include <stdint.h>

/* Low half of a b + c + d, which is below 2^128; the high half goes to *high. By halves of 32 bits,
   for compilers that have no larger integers. */
static inline uint64_t sc_limbs_multiply_halves(uint64_t a, uint64_t b, uint64_t c, uint64_t d,
                                                uint64_t *high)
{
    uint64_t a_low = a & UINT32_MAX, a_high = a >> 32, b_low = b & UINT32_MAX, b_high = b >> 32;
    uint64_t low = a_low * b_low + (c & UINT32_MAX) + (d & UINT32_MAX);
    uint64_t left = a_high * b_low + (c >> 32) + (low >> 32);
    uint64_t right = a_low * b_high + (d >> 32) + (left & UINT32_MAX);
    *high = a_high * b_high + (left >> 32) + (right >> 32);
    return (right << 32) | (low & UINT32_MAX);
}

/* The same as the compiler does it best. */
static inline uint64_t sc_limbs_multiply_add(uint64_t a, uint64_t b, uint64_t c, uint64_t d,
                                             uint64_t *high)
{
#if defined(__SIZEOF_INT128__) && defined(__GNUC__)
    __extension__ typedef unsigned __int128 double_limb;
    double_limb product = (double_limb)a * b + c + d;
    *high = (uint64_t)(product >> 64);
    return (uint64_t)product;
#else
    return sc_limbs_multiply_halves(a, b, c, d, high);
#endif
}

/* All bits of the sign. */
static inline uint64_t sc_limbs_mask(const uint64_t *a, int n)
{
    return (uint64_t)0 - (a[n - 1] >> 63);
}

/* 1, 0 or -1. */
static inline int sc_limbs_sign(const uint64_t *a, int n)
{
    uint64_t any = 0;
    for (int i = 0; i < n; ++i) any |= a[i];
    return a[n - 1] >> 63 ? -1 : any != 0;
}

/* Adds b to a. */
static inline void sc_limbs_add(uint64_t *a, const uint64_t *b, int n)
{
    uint64_t carry = 0;
    for (int i = 0; i < n; ++i) {
        uint64_t sum = a[i] + carry;
        carry = sum < carry;
        sum += b[i];
        carry += sum < b[i];
        a[i] = sum;
    }
}

/* result = a - b; result may be a or b. */
static inline void sc_limbs_subtract(uint64_t *result, const uint64_t *a, const uint64_t *b, int n)
{
    uint64_t borrow = 0;
    for (int i = 0; i < n; ++i) {
        uint64_t left = a[i], right = b[i], rest = left - right;
        uint64_t lost = left < right;
        result[i] = rest - borrow;
        borrow = lost | (rest < borrow);
    }
}

/* Subtracts from the limbs of a from the one numbered `from` on as many bits of b as mask has: all
   or none. a has n limbs, b n - from or more. */
static inline void sc_limbs_take_masked(uint64_t *a, int n, int from, const uint64_t *b,
                                        uint64_t mask)
{
    uint64_t borrow = 0;
    for (int i = from; i < n; ++i) {
        uint64_t left = a[i], right = b[i - from] & mask, rest = left - right;
        uint64_t lost = left < right;
        a[i] = rest - borrow;
        borrow = lost | (rest < borrow);
    }
}

/*
 * result = a b, of an + bn limbs; both are below 2^(64 n - 1) in magnitude, as their signs fit. The
 * product of the limbs taken for numbers without a sign is (a + A 2^(64 an)) (b + B 2^(64 bn)),
 * where A and B are 1 for what is negative: modulo 2^(64 (an + bn)), A b 2^(64 an) + B a 2^(64 bn)
 * too much.
 */
static inline void sc_limbs_multiply(uint64_t *result, const uint64_t *a, int an, const uint64_t *b,
                                     int bn)
{
    for (int j = 0; j < bn; ++j) result[j] = 0;
    for (int i = 0; i < an; ++i) {
        uint64_t carry = 0;
        for (int j = 0; j < bn; ++j)
            result[i + j] = sc_limbs_multiply_add(a[i], b[j], result[i + j], carry, &carry);
        result[i + bn] = carry;
    }
    sc_limbs_take_masked(result, an + bn, an, b, sc_limbs_mask(a, an));
    sc_limbs_take_masked(result, an + bn, bn, a, sc_limbs_mask(b, bn));
}

#endif /* SC_STEP_LIMBS_H */
