/*
 * Bit tricks with a portable form.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef SC_BASE_BITS_H
#define SC_BASE_BITS_H

/* The number of the lowest set bit of a mask that is not 0. */
static inline unsigned sc_bits_lowest(unsigned mask)
{
#if defined(__GNUC__)
    return (unsigned)__builtin_ctz(mask);
#else
    unsigned at = 0;
    while (!(mask & 1u)) {
        mask >>= 1;
        at++;
    }
    return at;
#endif
}

#endif
